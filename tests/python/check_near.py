"""check_near.py - what is near, from Python, against a real daemon and in this process.

Room:     tests/python. Needs PCCD_DAEMON, set by make check.
Does:     distances that are known, bounds of vertices, pages beside those of steps.
"""

import struct
import tempfile
import unittest

import numpy as np

import pccd
from check_client import Case
from support import TENT, TENT_TRIANGLES, Scene, dropped


HEAD, CHUNK = struct.Struct("<8sII"), struct.Struct("<IHHQQQQQ")
FRAME, ANSWER, RECORDS, MOVE, NEAR = 7, 8, 9, 18, 20  # client/record/format.h
ASKED = struct.Struct("<Q12I6dQ64s")  # record_frame of client/record/payload.h


def chunks(path):
    """The chunks of a recording that is not compressed: (kind, step or first word,
    payload)."""
    with open(path, "rb") as file:
        data = file.read()
    at, found = HEAD.size, []
    while at < len(data):
        _, kind, encoding, size, stored, *_ = CHUNK.unpack_from(data, at)
        assert encoding == 0 and size == stored
        payload = data[at + CHUNK.size:at + CHUNK.size + size]
        found.append((kind, struct.unpack_from("<Q", payload)[0], payload))
        at += CHUNK.size + (stored + 7) // 8 * 8
    return found


class Near(Case):
    """What is near at one moment."""

    # If this failed, Python would show other distances than there are, or none.
    def test_near__has_the_distance_of_the_tent(self):
        for client in (self.client, pccd.connect("direct:", result_bytes=1 << 21)):
            scene, _, tent = self.tent(client)
            with client.near(scene, distance=1.0) as answer:
                self.assertTrue(answer.is_near)
                self.assertEqual(answer.what, pccd.NearWhat.PAIRS)
                self.assertEqual((answer.total, answer.counts[pccd.Kind.VF]), (1, 1))
                self.assertEqual((answer.distance_min, answer.distance_max), (1, 1))
                self.assertEqual(answer.verdict, pccd.Verdict.NONE)
                near = answer.near[0]
                self.assertEqual((near["kind"], near["flags"] >> 8, near["object_a"],
                                  near["feature_a"], near["object_b"],
                                  near["feature_b"]), (0, 0, tent, 3, tent, 0))
                self.assertEqual((near["d_lo"], near["d_hi"], near["count"]), (1, 1, 1))
                self.assertEqual(near["param"].tolist(), [0.25, 0.25])
                self.assertEqual(near["direction"].tolist(), [0, 0, 1])
                self.assertEqual(len(answer.contacts), 0)
                self.assertEqual(len(answer.vertex_bounds), 0)
                self.assertFalse(answer.near.flags.writeable)
                self.assertIn("1 near", repr(answer))
                want = answer.hash
            with client.near(scene, distance=np.nextafter(1, 0)) as answer:
                self.assertEqual((answer.total, answer.distance_min), (0, 2e18))
            down = pccd.Motions()
            down.x0x1(tent, TENT, dropped(0.5))
            with client.near(scene, distance=0.5, motions=down) as answer:
                self.assertEqual(answer.near["d_lo"].tolist(), [0.5])
            with client.near(scene, distance=1.0, at_begin=True) as answer:
                self.assertEqual(answer.hash, want)
            client.scene_destroy(scene)
        client.close()

    # If this failed, a solver that steps by bounds would step through a surface.
    def test_near__has_a_bound_for_each_vertex(self):
        scene, _, tent = self.tent()
        with self.client.near(scene, pccd.NearWhat.VERTICES, 1.25) as answer:
            self.assertEqual((answer.total, answer.records.dtype), (6, np.float64))
            self.assertEqual(answer.vertex_bounds[:4].tolist(), [1, 1, 1, 1])
            self.assertTrue(np.all(np.abs(answer.vertex_bounds[4:]
                                          - np.sqrt(1 + 0.25**2)) < 1e-9))
            self.assertEqual(len(answer.near), 0)
        self.fails(pccd.Status.E_HANDLE, self.client.near, scene,
                   pccd.NearWhat.VERTICES, 1.0, object_a=tent + 1)

    # If this failed, the pages of one answer would be taken for another's, or be lost.
    def test_near__and_steps_have_pages_of_their_own(self):
        client = self.connect(result_bytes=1 << 16)
        world = Scene(client)
        step = client.wait(world.submit(1.0))
        contacts = np.concatenate([page.contacts.copy() for page in
                                   client.pages(world.scene, step)])
        near = client.near(world.scene, distance=0.05)
        self.assertEqual(near.incomplete, pccd.Incomplete.RESULT_FULL)
        records = near.near.copy()
        near.release()
        with client.fetch(world.scene, step.step, 1) as page:
            self.assertTrue((page.contacts == contacts[1:1 + page.count]).all())
        while len(records) < near.total:
            with client.fetch(world.scene, near.step, len(records)) as page:
                self.assertTrue(page.is_near)
                self.assertEqual(page.hash, near.hash)
                records = np.concatenate([records, page.near.copy()])
        self.assertEqual(len(records), near.total)
        self.assertTrue(np.all(records["d_lo"] <= 0.05))
        order = records[["kind", "object_a", "feature_a", "object_b", "feature_b"]]
        self.assertTrue(np.array_equal(order, np.sort(order)))

    # If this failed, a recording would leave out what was asked and answered, or have it
    # at another time than the daemon.
    def test_near__is_recorded_in_its_turn(self):
        for name in (None, "recorded"):
            client, other = self.connect(), self.connect()
            with tempfile.TemporaryDirectory() as folder:
                shared = {"name": name, "share": pccd.Share.OPEN} if name else {}
                scene = client.scene_create(**shared)
                client.record_start(f"{folder}/near.rec", contacts=True, level=-1)
                tent = client.scene_add(scene, client.mesh_create(TENT, TENT_TRIANGLES))
                down = pccd.Motions()
                down.x1(tent, dropped(0.5))
                client.near(scene, distance=1.0).release()
                if name:
                    self.move_by_near(other, other.scene_create(**shared))
                client.near(scene, pccd.NearWhat.VERTICES, 0.5, True, down,
                            tuning="still=anew").release()
                client.step_x1(scene, tent, TENT).release()
                self.assertEqual(client.record_stop().status, 0)
                found = chunks(f"{folder}/near.rec")
            order = [(kind, step) for kind, step, _ in found
                     if kind in (FRAME, MOVE, NEAR)]
            moved = [(MOVE, 0)] if name else []
            self.assertEqual(order, [(NEAR, 1), *moved, (NEAR, 2), (FRAME, 3)])
            asked = {step: payload for kind, step, payload in found if kind == NEAR}
            for step, moved, what, end, distance, tuning in (
                    (1, 0, pccd.NearWhat.PAIRS, 1, 1.0, b""),
                    (2, 1, pccd.NearWhat.VERTICES, 0, 0.5, b"still=anew")):
                said = ASKED.unpack_from(asked[step])
                self.assertEqual((said[1:3], said[8:10], said[17]),
                                 ((scene, moved), (what, end), distance))
                self.assertEqual(said[20].rstrip(b"\0"), tuning)
            self.assertEqual(len(asked[1]), ASKED.size)
            self.assertGreater(len(asked[2]), ASKED.size + 32 + TENT.nbytes - 1)
            near = [(step, struct.unpack_from("<I", payload, 12)[0])
                    for kind, step, payload in found if kind == ANSWER]
            self.assertEqual(near, [(1, 1), (2, 1), (3, 0)])
            sizes = [len(payload) for kind, step, payload in found
                     if kind == RECORDS and step < 3]
            self.assertEqual(sizes, [32 + 64, 32 + (2 if name else 1) * 6 * 8])

    # If this failed, surfaces that pass through each other from the start would be taken
    # for free, or a recording would not ask for what was told.
    def test_near__tells_what_crosses(self):
        floor = np.array([[-30, -30, 0], [30, -30, 0], [0, 30, 0]], np.float64)
        spike = np.array([[0, 0, -2], [1, 0, 6], [0, 1, 6]], np.float64)
        told = pccd.StepSettings("any", tells_start=True)
        for name in (None, "crossed"):
            client = self.connect()
            with tempfile.TemporaryDirectory() as folder:
                shared = {"name": name, "share": pccd.Share.OPEN} if name else {}
                scene = client.scene_create(**shared)
                client.record_start(f"{folder}/told.rec", contacts=True, level=-1)
                for x in floor, spike:
                    body = client.scene_add(scene, client.mesh_create(x, [[0, 1, 2]]))
                with client.step_x1(scene, body, spike, told) as answer:
                    self.assertEqual((answer.verdict, answer.crossings, answer.total,
                                      answer.start_inside, answer.safe_step),
                                     (pccd.Verdict.YES, 2, 0, 0, 0))
                with client.step_x1(scene, body, spike) as answer:
                    self.assertEqual((answer.crossings, answer.safe_step), (0, 1))
                with client.near(scene, distance=1.0, tells_crossings=True) as answer:
                    self.assertEqual((answer.total, answer.crossings), (0, 2))
                with client.near(scene, "nearest") as answer:
                    self.assertEqual(answer.near["kind"].tolist(), [pccd.NearKind.EF])
                self.assertEqual(client.record_stop().status, 0)
                found = chunks(f"{folder}/told.rec")
            tells = [(kind, ASKED.unpack_from(payload)[5]) for kind, _, payload in found
                     if kind in (FRAME, NEAR)]
            self.assertEqual(tells, [(FRAME, 1), (FRAME, 0), (NEAR, 1), (NEAR, 0)])
            client.close()

    def move_by_near(self, client, scene):
        """Another member's question, which brings a tent of its own far away."""
        tent = client.scene_add(scene, client.mesh_create(TENT + 90, TENT_TRIANGLES))
        away = pccd.Motions()
        away.x1(tent, TENT + np.float32(95))
        client.near(scene, distance=0.5, motions=away).release()
        client.near(scene, distance=0.5).release()

    # If this failed, an answer would be waited for that has come, or a frame be lost.
    def test_near__is_asked_without_waiting(self):
        scene, _, tent = self.tent()
        first = self.client.submit_near(scene, distance=1.0)
        with self.client.frame(scene, TENT.nbytes) as frame:
            frame.x1(tent, len(TENT))[:] = dropped(0.5)
            second = frame.commit_near(distance=0.5)
        with self.client.wait(second) as answer:
            self.assertEqual(answer.near["d_hi"].tolist(), [0.5])
        with self.client.wait(first) as answer:
            self.assertEqual(answer.near["d_hi"].tolist(), [1.0])
        self.fails(pccd.Status.E_INVAL, self.client.near, scene, distance=-1.0)
        self.fails(pccd.Status.E_LIMIT, self.client.near, scene, distance=2e18)
        self.fails(pccd.Status.E_INVAL, self.client.near, scene, threads=-1)
        self.fails(pccd.Status.E_INVAL, self.client.near, scene, tuning="x" * 64)


if __name__ == "__main__":
    unittest.main()
