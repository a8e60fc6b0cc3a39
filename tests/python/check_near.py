"""check_near.py - what is near, from Python, against a real daemon and in this process.

Room:     tests/python. Needs PCCD_DAEMON, set by make check.
Does:     distances that are known, bounds of vertices, pages beside those of steps.
"""

import unittest

import numpy as np

import pccd
from check_client import Case
from support import TENT, Scene, dropped


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
            with client.near(scene, distance=1.0, end=0) as answer:
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
