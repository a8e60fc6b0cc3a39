"""check_thick.py - thickness, from Python, against a real daemon and in this process.

Room:     tests/python. Needs PCCD_DAEMON, set by make check.
Does:     radii, separation, approach and the safe step of two triangles.
"""

import math
import unittest

import numpy as np

import pccd
from check_client import Case

FACE = np.array([[0, 1, 2]], np.uint32)


def at(height):
    """A triangle at that height."""
    return np.array([[0, 0, height], [1, 0, height], [0, 1, height]])


class Thick(Case):
    """One triangle comes down to another one."""

    def pile(self, client):
        """A scene, the lower and the upper triangle."""
        scene = client.scene_create()
        mesh = client.mesh_create(at(0), FACE)
        return scene, client.scene_add(scene, mesh), client.scene_add(scene, mesh)

    def fall(self, client, scene, upper, settings=pccd.StepSettings()):
        """From a height of 1 to a half: total, inside, crowded, safe step."""
        with client.step_x0x1(scene, upper, at(1), at(0.5), settings) as answer:
            return answer.total, answer.inside, answer.crowded, answer.safe_step

    # If this failed, a Python program would have other distances than a C program.
    def test_thick__meets_at_its_distance(self):
        for client in (self.client, pccd.connect("direct:", result_bytes=1 << 21)):
            scene, lower, upper = self.pile(client)
            self.assertEqual(self.fall(client, scene, upper), (0, 0, False, 1))
            self.assertEqual(client.object_set(scene, lower, radius=0.5).radius, 0.5)
            client.object_set(scene, upper, radius=0.25)
            total, inside, crowded, safe = self.fall(client, scene, upper)
            self.assertEqual((total, inside, crowded), (15, 0, False))
            self.assertAlmostEqual(safe, 0.5, delta=1e-8)
            self.assertLess(safe, 0.5)
            settings = pccd.StepSettings(separation=1.0)
            self.assertEqual(self.fall(client, scene, upper, settings), (15, 0, True, 0))
            settings = pccd.StepSettings(separation=1.0, approach=0.75)
            total, inside, crowded, safe = self.fall(client, scene, upper, settings)
            self.assertEqual((total, inside, crowded), (15, 15, True))
            self.assertAlmostEqual(safe, 0.5, delta=1e-8)

    # If this failed, a Python program could not let go what leaves.
    def test_thin__is_let_go_where_it_leaves(self):
        for client in (self.client, pccd.connect("direct:", result_bytes=1 << 21)):
            scene = client.scene_create()
            client.scene_add(scene, client.mesh_create(at(0), FACE))
            upper = client.scene_add(scene, client.mesh_create(at(0), FACE[:, ::-1]))
            told = pccd.StepSettings(touching="told")
            left = pccd.StepSettings(touching=pccd.Touching.LEFT_OUT)
            for height, safe, flag in ((0.5, 1, pccd.ContactFlag.LEAVES),
                                       (-0.5, 0, pccd.ContactFlag.ENTERS),
                                       (0.0, 1, pccd.ContactFlag.SLIDES)):
                with client.step_x0x1(scene, upper, at(0), at(height), told) as answer:
                    self.assertTrue(np.all(answer.records["flags"] & flag != 0))
                    self.assertEqual(answer.total, answer.initial)
                    self.assertEqual(answer.safe_step, 0)
                    total = answer.total
                with client.step_x0x1(scene, upper, at(0), at(height), left) as answer:
                    self.assertEqual(answer.total, 0 if safe else total)
                    self.assertEqual((answer.entering, answer.sliding, answer.leaving),
                                     (total * (height < 0), total * (height == 0),
                                      total * (height > 0)))
                    self.assertEqual(answer.safe_step, safe)
            reached = np.empty((3, 3))
            for height, must in ((0.5, 1), (-0.5, 0)):
                motions = pccd.Motions()
                motions.x0x1(upper, at(0.0), at(height))
                part, answer = client.step_safe(scene, motions, [reached], left)
                answer.release()
                self.assertEqual((part, reached[0, 2]), (must, max(height, 0)))
            with client.step_x0x1(scene, upper, at(0), at(0.0), left):
                pass
            batch = client.batch([pccd.Part(scene, upper, 3)])
            for height, safe in ((0.5, 1), (0.0, None), (-0.5, 0)):
                with batch.step(at(height)[np.newaxis], left) as answer:
                    if safe is not None:  # it began at 0
                        self.assertEqual(answer.scenes[0]["total"], 0 if safe else total)
        with self.assertRaisesRegex(pccd.PccdError, "kept, told, left-out"):
            pccd.StepSettings(touching="left")

    # If this failed, Python would have no rods and clouds, or others than it says.
    def test_thick__meets_rods_and_points(self):
        scene = self.client.scene_create()
        x = np.array([[0, 0, 0], [1, 0, 0], [5, 0, 0]], float)
        mesh = self.client.mesh_create(x, edges=[[0, 1]], points=[2])
        info = self.client.mesh_info(mesh)
        self.assertEqual((info.triangle_count, info.edge_count, info.free_edge_count,
                          info.free_point_count), (0, 1, 1, 1))
        self.client.scene_add(scene, mesh)
        above = np.array([[0.5, 0, 1], [5, 0, 1]])
        cloud = self.client.scene_add(
            scene, self.client.mesh_create(above, points=np.arange(2)))
        settings = pccd.StepSettings(separation=0.25)
        with self.client.step_x0x1(scene, cloud, above, above - [0, 0, 2],
                                   settings) as answer:
            self.assertEqual(answer.counts[pccd.Kind.VE], 1)
            self.assertEqual(answer.counts[pccd.Kind.VV], 1)
            self.assertEqual(answer.total, 2)
        self.fails(pccd.Status.E_INVAL, self.client.mesh_create, x)
        self.fails(pccd.Status.E_INVAL, self.client.mesh_create, x, edges=[0, 1])
        self.fails(pccd.Status.E_INDEX, self.client.mesh_create, x, points=[3])

    # If this failed, Python could not make a hem thicker than the cloth.
    def test_thick__vertices_have_radii(self):
        scene = self.client.scene_create()
        thick = self.client.mesh_create(at(0), FACE, radii=[0.75, 0, 0])
        self.client.scene_add(scene, thick)
        upper = self.client.scene_add(scene, self.client.mesh_create(at(0), FACE))
        total, _, _, safe = self.fall(self.client, scene, upper)
        self.assertEqual(total, 10)  # all with the thick face, edges and vertex
        self.assertAlmostEqual(safe, 0.5, delta=1e-8)
        self.fails(pccd.Status.E_INVAL, self.client.mesh_create, at(0), FACE, [1.0])
        self.fails(pccd.Status.E_INVAL, self.client.mesh_create, at(0), FACE,
                   [0, -1.0, 0])

    # If this failed, who goes where he is told to would be in what he must not touch.
    def test_thick__goes_as_far_as_is_safe(self):
        for dtype in (np.float32, np.float64):
            scene, lower, upper = self.pile(self.client)
            self.client.object_set(scene, lower, radius=0.1)
            begin, end = at(1).astype(dtype), at(-1).astype(dtype)
            reached = np.empty_like(begin)
            motions = pccd.Motions()
            motions.x0x1(upper, begin, end)
            part, answer = self.client.step_safe(scene, motions, [reached])
            with answer:
                self.assertEqual(answer.total, 15)
            self.assertAlmostEqual(part, 0.45, delta=1e-6)
            heights = reached[:, 2].astype(float)
            self.assertTrue(np.all((heights > 0.1) & (heights < 0.1 + 1e-6)))
            begin[:] = reached  # from where it is, downwards and upwards
            part, answer = self.client.step_safe(scene, motions, [reached])
            answer.release()
            self.assertTrue(0 <= part < 1e-5)
            end[:] = at(2)
            part, answer = self.client.step_safe(scene, motions, [reached])
            answer.release()
            self.assertEqual(part, 1)
            self.assertTrue(np.array_equal(reached, end))
            begin[:] = at(0.0625)  # within its distance
            part, answer = self.client.step_safe(scene, motions, [reached])
            answer.release()
            self.assertEqual(part, 0)
            self.assertTrue(np.array_equal(reached, begin))
            self.fails(pccd.Status.E_INVAL, self.client.step_safe, scene, motions, [])
        rigid, pose = pccd.Motions(), np.empty((3, 4))
        begin, end = np.eye(3, 4), np.eye(3, 4)
        begin[2, 3], end[2, 3] = 1, -1
        rigid.rigid(upper, 3, begin, end)
        part, answer = self.client.step_safe(scene, rigid, [pose])
        answer.release()
        self.assertAlmostEqual(part, 0.45, delta=1e-6)
        self.assertTrue(np.array_equal(pose, begin + part * (end - begin)))
        self.fails(pccd.Status.E_INVAL, self.client.step_safe, scene, rigid,
                   [np.empty((3, 3))])

    # If this failed, a mistake would be taken for a length.
    def test_thick__refuses_what_is_no_length(self):
        client = self.client
        scene, lower, upper = self.pile(client)
        for radius in (-1.0, math.nan, math.inf):
            self.fails(pccd.Status.E_INVAL, client.object_set, scene, lower,
                       radius=radius)
        self.fails(pccd.Status.E_LIMIT, client.object_set, scene, lower, radius=2e18)
        self.fails(pccd.Status.E_LIMIT, client.object_set, scene, lower, rest_rings=9)
        client.object_set(scene, lower, rest_rings=8, rest_distance=0.125)
        self.assertEqual(client.object_get(scene, lower)[3:6], (0, 0.125, 8))
        self.fails(pccd.Status.E_INVAL, self.fall, client, scene, upper,
                   pccd.StepSettings(approach=1.0))


if __name__ == "__main__":
    unittest.main()
