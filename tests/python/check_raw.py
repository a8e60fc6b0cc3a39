"""check_raw.py - PROTOCOL.md is enough to write a client (raw_client.py).

Room:     tests/python. Needs PCCDD and PCCD_DAEMON, set by make check.
Does:     a whole session over the bare protocol: answers beside those of libpccd,
          requests that are refused, a connection that is cut, a daemon that dies.
"""

import os
import signal
import unittest

import pccd
from raw_client import CONTACT, RawClient, Refused
from support import (TENT, TENT_TRIANGLES, Scene, Supervised, cloth, cloth_triangles,
                     dropped, ends, floor)

STILL = [(1, 0, 0, 0), (0, 1, 0, 0), (0, 0, 1, 0)]
LOWERED = [(1, 0, 0, 0), (0, 1, 0, 0), (0, 0, 1, -2)]


def rows(x):
    """As plain numbers."""
    return [tuple(map(float, row)) for row in x]


def indices(triangles):
    return [tuple(map(int, row)) for row in triangles]


class Case(Supervised):
    """With a raw client for each case."""

    options = ("--threads", "1")

    def setUp(self):
        self.client = RawClient(self.daemon.url[5:])
        self.addCleanup(lambda: self.client.socket.close())
        self.client.attach()

    def tent(self, **want):
        """A scene with one tent: scene, mesh, object."""
        scene = self.client.call("scene.create", want=want.get("scene", 0))["scene"]
        mesh = self.client.make_mesh(rows(TENT), indices(TENT_TRIANGLES),
                                     want.get("mesh", 0))["mesh"]
        made = self.client.call("scene.add", scene=scene, mesh=mesh,
                                want=want.get("object", 0))["object"]
        return scene, mesh, made

    def refused(self, status, method, /, **params):
        """The error that a request must get."""
        with self.assertRaises(Refused) as caught:
            self.client.call(method, **params)
        self.assertEqual(caught.exception.name, status)
        return caught.exception


class Sessions(Case):
    """What a client in another language does first."""

    # If this failed, who follows the document would get wrong contacts, or none.
    def test_steps__have_the_contact_of_the_tent_in_every_way(self):
        scene, _, tent = self.tent()
        down = {"object": tent, "x0": rows(TENT), "x1": rows(dropped())}
        answer = self.client.step(scene, [down])
        (kind, flags, a, feature_a, b, feature_b, toi, toi_hi, u, v, *normal, zero), = \
            answer["contacts"]
        self.assertEqual((kind, flags, a, feature_a, b, feature_b, zero),
                         (0, 1, tent, 3, tent, 0, 0))
        self.assertTrue(0.499 < toi <= 0.5 <= toi_hi < 0.501)
        self.assertEqual((round(u, 5), round(v, 5), normal), (0.25, 0.25, [0, 0, 1]))
        self.assertEqual(answer["toi_first"], toi)
        ways = [[{"object": tent, "first": 0, "x1": rows(TENT)[:3]},
                 {"object": tent, "first": 3, "x0": rows(TENT)[3:],
                  "x1": rows(dropped())[3:]}],
                [{"object": tent, "count": 3, "m0": STILL, "m1": STILL},
                 {"object": tent, "first": 3, "count": 3, "m0": STILL, "m1": LOWERED}]]
        for way in ways:
            again = self.client.step(scene, way)
            self.assertEqual(again["contacts"], answer["contacts"])
        self.assertEqual(self.client.step(scene, [down], mode=2)["verdict"], 2)

    # If this failed, who follows the document would get wrong distances, or none.
    def test_near__is_as_the_document_says(self):
        scene, _, tent = self.tent()
        answer = self.client.near(scene, distance=1.0)
        (kind, flags, a, feature_a, b, feature_b, low, high, u, v, *direction, count), = \
            answer["near"]
        self.assertEqual((kind, flags, a, feature_a, b, feature_b, count),
                         (0, 0, tent, 3, tent, 0, 1))
        self.assertEqual((low, high, u, v, direction), (1, 1, 0.25, 0.25, [0, 0, 1]))
        self.assertEqual((answer["vf"], answer["distance_min"]), (1, 1))
        moved = self.client.near(scene, [{"object": tent, "x1": rows(dropped(0.5))}],
                                 distance=0.5)
        self.assertEqual(moved["near"][0][6:8], (0.5, 0.5))
        self.assertEqual(self.client.near(scene, end=0, distance=1.0)["near"],
                         answer["near"])
        bounds = self.client.near(scene, what=2, distance=0.25)
        self.assertEqual(bounds["near"], 6 * [(0.25,)])
        self.refused("E_INVAL", "scene.near", scene=scene, what=6, end=1)
        self.refused("E_BADMSG", "scene.near", scene=scene, what=0)

    # If this failed, the protocol would say something else than libpccd does.
    def test_answers__are_those_of_libpccd(self):
        client = self.client
        scene = client.call("scene.create")["scene"]
        ground = floor()
        base = client.make_mesh(rows(ground[0]), indices(ground[1]))["mesh"]
        client.call("scene.add", scene=scene, mesh=base)
        told = client.make_mesh(rows(cloth(20)), indices(cloth_triangles(20)))
        body = client.call("scene.add", scene=scene, mesh=told["mesh"])["object"]
        with pccd.connect(self.daemon.url, result_bytes=1 << 20) as other:
            theirs = Scene(other)
            for step in (0.3, 0.5):
                way = {"object": body, "x1": rows(cloth(20, step))}
                answer = client.step(scene, [way])
                with other.step_x1(theirs.scene, theirs.cloth, cloth(20, step)) as want:
                    halves = answer["hash_hi"], answer["hash_lo"]
                    self.assertEqual("2:%016x%016x" % halves, want.hash)
                    got = b"".join(CONTACT.pack(*one) for one in answer["contacts"])
                    self.assertEqual(got, want.records.tobytes())
            edges = other.mesh_edges(theirs.mesh)
        self.assertEqual(client.edges(told["mesh"], told["edge_count"]),
                         [tuple(edge) for edge in edges.tolist()])

    # If this failed, an answer of several pages would lack records, or a page never be
    # free.
    def test_pages__make_up_the_whole_answer(self):
        client = self.client
        client.attach(result_bytes=1 << 16)
        scene = client.call("scene.create")["scene"]
        told = client.make_mesh(rows(cloth(60)), indices(cloth_triangles(60)))
        ground = client.make_mesh(rows(cloth(60) * [1, 1, 0]),
                                  indices(cloth_triangles(60)))
        client.call("scene.add", scene=scene, mesh=ground["mesh"])
        body = client.call("scene.add", scene=scene, mesh=told["mesh"])["object"]
        for step in (0.5, 0, 0.5):
            x1 = rows(cloth(60, step))
            half = [{"object": body, "first": first, "x1": x1[first:first + 1200]}
                    for first in range(0, 3600, 1200)]
            client.attach(slot_bytes=1 << 17, result_bytes=1 << 16)
            answer = client.step(scene, half)
            self.assertEqual(len(answer["contacts"]), answer["total"])
            self.assertEqual(answer["contacts"], sorted(
                answer["contacts"], key=lambda one: (one[0], *one[2:6])))
            self.assertGreater(answer["total"] * CONTACT.size, 1 << 16)
        done = client.words[0x180 // 8]
        still = client.submit(scene, [])
        self.assertEqual(client.wait_quietly(still)["number"], 4)
        self.assertEqual(client.words[0x180 // 8], done + 1)

    # If this failed, a request that is wrong would be taken, or end the session.
    def test_requests__that_are_wrong_are_refused(self):
        scene, mesh, _ = self.tent()
        token = 1 << 60
        self.assertEqual(self.client.call("ping", token=token)["token"], token)
        self.refused("E_NOMETHOD", "scene.dance", scene=scene)
        self.refused("E_BADMSG", "scene.destroy", scene="one")
        self.refused("E_BADMSG", "scene.destroy")
        self.refused("E_HANDLE", "scene.destroy", scene=77)
        self.refused("E_STATE", "hello", version_min=1, version_max=1)
        self.refused("E_SLOT_STALE", "frame.submit", scene=scene, slot=0, seq=1 << 20,
                     segments=1)
        found = self.client.edges(mesh, 3)
        self.assertEqual(found, [(0, 1), (0, 2), (1, 2)])
        error = self.refused("E_BADMSG", "config.get", name="x" * 256)
        self.assertIn("name", error.text)
        self.assertFalse(error.fatal)
        self.client.call("ping")

    # If this failed, a newer field or value would stop older clients.
    def test_fields__that_nobody_knows_are_left_out(self):
        self.client.call("ping", token=1, colour=[1, {"deep": None}])
        self.assertIn("epoch", self.client.session)
        self.assertEqual(self.client.session["features"], 0)
        self.client.close()


class Losses(Case):
    """Rules for connections and daemons that go."""

    # If this failed, a step would be run twice, or never, when a connection is cut.
    def test_sessions__go_on_over_another_connection(self):
        client = self.client
        scene, _, tent = self.tent()
        down = {"object": tent, "x1": rows(dropped())}
        up = {"object": tent, "x1": rows(TENT)}
        wanted = [self.client.step(scene, [way])["contacts"] for way in (down, up)]
        for _ in range(10):
            ids = [client.submit(scene, [way]) for way in (down, up)]
            client.cut()
            self.assertTrue(client.resume())
            got = [client.all_pages(scene, client.wait(id_))["contacts"] for id_ in ids]
            self.assertEqual(got, wanted)
        self.assertEqual(client.call("stats")["slots_torn"], 0)
        self.assertEqual(client.unanswered, {})

    # If this failed, a client could not bring its scene to the next daemon.
    def test_scenes__are_made_anew_with_another_daemon(self):
        client = self.client
        scene, mesh, tent = self.tent()
        raised = rows(TENT + [0, 0, 1])[3:]
        client.step(scene, [{"object": tent, "first": 3, "x1": raised}])
        pid = client.session["pid"]
        os.kill(pid, signal.SIGKILL)
        self.assertTrue(ends(pid))
        self.assertFalse(client.resume())
        self.assertNotEqual(client.session["pid"], pid)
        client.unanswered.clear()
        client.attach()
        self.assertEqual(self.tent(scene=scene, mesh=mesh, object=tent),
                         (scene, mesh, tent))
        client.step(scene, [{"object": tent, "first": 3, "x0": raised, "x1": raised}],
                    mode=2, deadline_ns=1)
        answer = client.step(scene, [{"object": tent, "first": 3,
                                      "x1": rows(TENT - [0, 0, 3])[3:]}])
        (toi,) = {round(one[6], 6) for one in answer["contacts"] if one[0] == 0 and
                  one[3] == 3}
        self.assertEqual(toi, 0.5)  # from 2 to -2

    # If this failed, a session would be handed to who does not know its token.
    def test_tokens__that_are_wrong_give_a_new_session(self):
        before = self.client.session["session"]
        self.client.cut()
        self.client.session = {**self.client.session, "token_lo": 1}
        self.assertFalse(self.client.resume())
        self.assertNotEqual(self.client.session["session"], before)


if __name__ == "__main__":
    unittest.main()
