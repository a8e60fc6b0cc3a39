"""check_scenes.py - masks, ignored pairs and shared scenes of the Python client.

Room:     tests/python. Needs PCCD_DAEMON and PCCDD, set by make check.
Does:     several clients of a real daemon: who may meet whom, who moves what and hears of
          it, who may; and what another daemon is told.
"""

import os
import signal
import unittest

import numpy as np

import pccd
from support import TENT, TENT_TRIANGLES, Supervised, dropped, ends

FLOOR, FACE = TENT[:3], TENT_TRIANGLES[:1]
UPPER = TENT[3:] + np.float32([0, 0, 0])
HOLD = pccd.StepSettings(hold=True)


class Member:
    """A client in a shared scene, with a triangle of its own."""

    def __init__(self, client, x, name="both", **named):
        self.client, self.x = client, x
        self.scene = client.scene_create(name=name, **{"share": pccd.Share.OPEN, **named})
        self.mesh = client.mesh_create(x, FACE)
        self.object = client.scene_add(self.scene, self.mesh)

    def submit(self, up, settings=pccd.StepSettings()):
        """Its object's way to `up` above where it was registered."""
        x1 = self.x + np.float32([0, 0, up])
        with self.client.frame(self.scene, x1.nbytes) as frame:
            frame.x1(self.object, 3)[:] = x1
            return frame.commit(settings)

    def hold(self, up):
        """The same for another client's step; it has been taken in at the end."""
        step = self.submit(up, HOLD)
        self.client.wait_held(step)
        return step


class Filters(Supervised):
    """object_set, object_get, pair_ignore."""

    def setUp(self):
        self.client = self.connect()
        self.scene = self.client.scene_create()
        floor = self.client.mesh_create(FLOOR, FACE)
        tent = self.client.mesh_create(TENT, TENT_TRIANGLES)
        self.floor = self.client.scene_add(self.scene, floor)
        self.tent = self.client.scene_add(self.scene, tent)

    def total(self):
        """Contacts when the tent's upper triangle falls through its lower one, which lies
        on the floor."""
        with self.client.step_x0x1(self.scene, self.tent, TENT, dropped()) as answer:
            return answer.total

    # If this failed, what a client says of its objects would not be what is tested.
    def test_objects__meet_what_they_may(self):
        client, scene = self.client, self.scene
        self.assertEqual(client.object_get(scene, self.tent),
                         (1, 2**64 - 1, True, 0, 0, 0, 0))
        both = self.total()
        self.assertEqual(client.object_set(scene, self.tent, self_collision=False),
                         (1, 2**64 - 1, False, 0, 0, 0, 0))
        others = self.total()
        self.assertTrue(0 < others < both)
        client.pair_ignore(scene, self.floor, self.tent)
        self.assertEqual(self.total(), 0)
        pairs = [set(entry.values()) for entry in client.list_pairs(scene)]
        self.assertEqual(pairs, [{self.floor, self.tent}])
        client.object_set(scene, self.tent, user_data=2**64 - 1)
        self.assertEqual(client.object_get(scene, self.tent).user_data, 2**64 - 1)
        given = client.user_data(scene, [[self.tent, self.floor], [self.floor, 77]])
        self.assertEqual(given.tolist(), [[2**64 - 1, 0], [0, 0]])
        client.object_set(scene, self.tent, user_data=0)
        self.assertEqual(client.user_data(scene, self.tent).tolist(), 0)
        self.assertEqual([entry["self_collision"] for entry in client.list_objects(scene)
                          if entry["object"] == self.tent], [False])
        client.object_set(scene, self.tent, self_collision=True)
        alone = self.total()
        self.assertEqual(alone + others, both)
        client.pair_ignore(scene, self.tent, self.floor, False)
        self.assertEqual(client.list_pairs(scene), [])
        client.pair_clearance(scene, self.tent, self.floor, 1e9)
        self.assertTrue(self.total() > both)
        self.assertEqual(client.list_pairs(scene), [])
        client.pair_clearance(scene, self.tent, self.floor, 0)
        self.assertEqual(self.total(), both)
        self.fails(pccd.Status.E_INVAL, client.pair_clearance, scene, self.tent,
                   self.floor, float("nan"))
        client.pair_ignore(scene, self.tent, self.floor, False)
        self.assertEqual(client.object_set(scene, self.floor, group=2, mask=2**63),
                         (2, 2**63, True, 0, 0, 0, 0))
        self.assertEqual(self.total(), alone)
        client.object_set(scene, self.tent, group=2**63)
        self.assertEqual(self.total(), both)
        client.object_set(scene, self.tent, mask=1)
        self.assertEqual(self.total(), alone)

    # If this failed, a mistake would change something, or be told as something else.
    def test_filters__refuse_what_cannot_be(self):
        client, scene = self.client, self.scene
        self.fails(pccd.Status.E_INVAL, client.object_set, scene, self.tent, group=2**64)
        self.fails(pccd.Status.E_INVAL, client.object_set, scene, self.tent, mask=-1)
        self.fails(pccd.Status.E_HANDLE, client.object_get, scene, 77)
        self.fails(pccd.Status.E_HANDLE, client.object_name, scene, 77, "sleeve")
        self.fails(pccd.Status.E_INVAL, client.object_name, scene, self.tent, "é" * 128)
        client.object_name(scene, self.tent, "é" * 127)
        self.fails(pccd.Status.E_INVAL, client.pair_ignore, scene, self.tent, self.tent)

    # If this failed, another daemon would test what the last one was told to leave out.
    def test_filters__come_back_with_another_daemon(self):
        client, scene = self.client, self.scene
        client.object_set(scene, self.tent, self_collision=False, group=6)
        others = self.total()
        for ignored in (True, False):
            client.pair_ignore(scene, self.tent, self.floor, ignored)
            pid = client.daemon_pid
            os.kill(pid, signal.SIGKILL)
            self.assertTrue(ends(pid))
            self.assertEqual(self.total(), 0 if ignored else others)
            self.assertEqual(client.object_get(scene, self.tent),
                             (6, 2**64 - 1, False, 0, 0, 0, 0))


class Shared(Supervised):
    """Scenes with names."""

    # If this failed, objects of two processes would be moved one after the other, or who
    # holds a frame would not hear what came of it.
    def test_held_frames__move_over_the_same_time(self):
        cloth = Member(self.connect(), UPPER)
        obstacle = Member(self.connect(), FLOOR)
        step = obstacle.hold(1.0)
        self.fails(pccd.Status.E_AGAIN, obstacle.client.wait, step, timeout=0)
        with cloth.client.wait(cloth.submit(-1.0)) as answer:
            self.assertEqual((answer.number, answer.incomplete), (1, 0))
            self.assertTrue(answer.total > 0)
            # From 0 to 1 and from 1 to 0: vertex 3 and the floor meet at 1/2.
            self.assertAlmostEqual(answer.contacts["toi"].min(), 0.5, delta=1e-6)
            held = obstacle.client.wait(step)
            self.assertEqual((held.hash, held.number, held.count, held.step),
                             (answer.hash, 1, 0, step))
            with obstacle.client.scene_read(obstacle.scene, held.number) as page:
                self.assertEqual(page.contacts.tobytes(), answer.contacts.tobytes())
                self.assertFalse(page.contacts.flags.writeable)

    # If this failed, a reader would not hear of a step, or hear of it twice.
    def test_readers__hear_of_the_last_step(self):
        cloth = Member(self.connect(), UPPER, "news")
        reader = self.connect()
        scene = reader.scene_create(name="news", share=pccd.Share.ATTACH)
        self.assertIsNone(reader.scene_wait(scene, timeout=0))
        self.assertIsNone(reader.scene_wait(scene, timeout=0.01))
        for up in (-1.0, -2.0, 0.0):
            with cloth.client.wait(cloth.submit(up)) as answer:
                news = reader.scene_wait(scene)
                self.assertEqual((news.number, news.hash, news.total, news.incomplete),
                                 (answer.number, answer.hash, answer.total, 0))
            with reader.scene_read(scene, news.number) as page:
                self.assertEqual(page.total, news.total)
        self.assertIsNone(reader.scene_wait(scene, timeout=0))
        self.assertIsNone(cloth.client.scene_wait(cloth.scene, timeout=0))  # its own
        self.fails(pccd.Status.E_STATE, reader.scene_read, scene, news.number - 1)
        self.fails(pccd.Status.E_INVAL, reader.scene_read, scene, 0)

    # If this failed, a name would not say whose scene is meant.
    def test_scenes__are_asked_for_by_their_owner(self):
        a, b = self.connect(), self.connect()
        cloth = Member(a, UPPER, "mine")
        scene = b.scene_create(name="mine", share=pccd.Share.ATTACH, owner=os.geteuid())
        listed, = b.list_scenes()
        self.assertEqual((listed["name"], listed.get("uid", 0), listed["members"]),
                         ("mine", os.geteuid(), 2))
        b.scene_destroy(scene)
        self.fails(pccd.Status.E_AGAIN, b.scene_create, name="mine",
                   share=pccd.Share.ATTACH, owner=os.geteuid() + 1)
        self.fails(pccd.Status.E_INVAL, b.scene_create, name="mine",
                   share=pccd.Share.OPEN, owner=os.geteuid())
        self.fails(pccd.Status.E_INVAL, b.scene_create, owner=os.geteuid())
        a.scene_destroy(cloth.scene)

    # If this failed, anybody could move anything, or take a scene for another one.
    def test_scenes__have_names_rights_and_writers(self):
        a, b = self.connect(), self.connect()
        self.fails(pccd.Status.E_AGAIN, a.scene_create, name="who",
                   share=pccd.Share.ATTACH)
        cloth = Member(a, UPPER, "who", share=pccd.Share.CREATE, rights=0o640)
        self.fails(pccd.Status.E_STATE, b.scene_create, name="who")
        self.fails(pccd.Status.E_INVAL, b.scene_create, name="else", rights=0o777)
        self.fails(pccd.Status.E_INVAL, b.scene_create, rights=0o600)
        self.fails(pccd.Status.E_INVAL, b.scene_create, name="")
        self.fails(pccd.Status.E_AGAIN, b.scene_create, name="else", share="attach")
        for share, why in ("attached", "not one of create"), (3, "OPEN or ATTACH, not"):
            with self.assertRaisesRegex(pccd.PccdError, why):
                b.scene_create(name="else", share=share)
        floor = Member(b, FLOOR, "who")
        floor.object, own = cloth.object, floor.object
        self.fails(pccd.Status.E_ACCESS, b.wait, floor.submit(1))
        self.fails(pccd.Status.E_ACCESS, b.scene_remove, floor.scene, cloth.object)
        self.fails(pccd.Status.E_ACCESS, b.object_set, floor.scene, cloth.object, group=2)
        self.fails(pccd.Status.E_ACCESS, b.object_name, floor.scene, cloth.object, "a")
        b.pair_ignore(floor.scene, cloth.object, own)
        with a.wait(cloth.submit(-2)) as answer:
            self.assertEqual(answer.total, 0)

    # If this failed, who waits for what is not held would be told that it is, or never.
    def test_wait_held__is_for_frames_that_are_held(self):
        cloth = Member(self.connect(), UPPER, "held")
        obstacle = Member(self.connect(), FLOOR, "held")
        step = cloth.submit(-0.5)
        self.fails(pccd.Status.E_INVAL, cloth.client.wait_held, step)
        cloth.client.wait(step).release()
        self.fails(pccd.Status.E_INVAL, cloth.client.wait_held, step)
        held = obstacle.hold(0.25)
        self.fails(pccd.Status.E_INVAL, obstacle.client.wait_held, held + 1)
        with cloth.client.wait(cloth.submit(0)):
            obstacle.client.wait_held(held)  # it has been taken along
        obstacle.client.wait(held).release()

    # If this failed, a held frame would be answered late or never.
    def test_held_frames__end_at_their_deadline_and_cancel(self):
        cloth = Member(self.connect(), UPPER, "late")
        obstacle = Member(self.connect(), FLOOR, "late")
        step = obstacle.submit(2, pccd.StepSettings(hold=True, deadline_ns=1000000))
        self.assertEqual(obstacle.client.wait(step).incomplete, pccd.Incomplete.DEADLINE)
        with cloth.client.wait(cloth.submit(0)) as answer:
            self.assertTrue(answer.total > 0)  # it went along
        step = obstacle.hold(0)
        obstacle.client.cancel(step)
        self.assertEqual(obstacle.client.wait(step).incomplete,
                         pccd.Incomplete.CANCELLED)

    # If this failed, a daemon that takes over would find a scene that is another one.
    def test_scenes__come_back_with_another_daemon(self):
        cloth = Member(self.connect(), UPPER, "again", share=pccd.Share.CREATE)
        obstacle = Member(self.connect(), FLOOR, "again")
        with cloth.client.wait(cloth.submit(-0.5)) as answer:
            self.assertEqual(answer.total, 0)
        obstacle.client.wait(obstacle.submit(0.25)).release()
        pid = cloth.client.daemon_pid
        os.kill(pid, signal.SIGKILL)
        self.assertTrue(ends(pid))
        for member in (obstacle, cloth):
            member.client.ping()
        with cloth.client.wait(cloth.submit(-1.0)) as answer:
            self.assertEqual(answer.number, 1)  # nothing else was a step
            self.assertTrue(answer.total > 0)  # from 0.5 to 0, through 0.25
        self.assertEqual(len(cloth.client.list_objects(cloth.scene)), 2)


if __name__ == "__main__":
    unittest.main()
