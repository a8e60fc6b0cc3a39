"""check_turning.py - bodies that turn, by the Python module.

Room:     tests/python. Needs PCCD_DAEMON, set by make check.
Does:     tables of joints; a door that turns about its pin until it meets a post.
"""

import math
import unittest

import numpy as np

import pccd
from check_client import Case

DOOR = np.array([[.125, 0, -1], [1, 0, -1], [1, 0, 1], [.125, 0, 1]])
POST = np.array([[.25, .25, -2], [.25, .25, 2], [-1, 1, 0]])  # at 45 degrees
QUARTER = ([0, 0, 0], [0, 0, math.sqrt(.5), math.sqrt(.5)])


class Tables(unittest.TestCase):
    # If this failed, a table would have other joints than were asked for, or a mistake
    # would be told of late.
    def test_tables__are_made_of_motions(self):
        table = pccd.joints_screw([1, 0, 0], [0, 0, 1], math.pi, shift=2.)
        self.assertEqual(table["kind"].tolist(), [pccd.JointKind.SLIDE,
                                                  pccd.JointKind.TURN,
                                                  pccd.JointKind.FIXED])
        self.assertEqual(table["to"][:, 0].tolist(), [2, math.pi, 0])
        more = pccd.joints_rotation_vector([0, 0, 0], [1, 0, 0], [0, 0, 0], [0, 0, 7],
                                           joints=table, parent=2)
        self.assertEqual(more["parent"].tolist(), [pccd.NO_JOINT, 0, 1, 2, 3])
        poses = pccd.joints_poses(([0, 0, 0], [0, 0, 0, 1]), QUARTER, turns=-1)
        self.assertAlmostEqual(poses["to"][1, 0], math.pi / 2 - 2 * math.pi)
        turned = np.array([[0, -1, 0, 5], [1, 0, 0, 6], [0, 0, 1, 7]])
        for m in turned, turned[:, :3]:
            np.testing.assert_allclose(pccd.rotation_of_matrix(m), QUARTER[1])

    # If this failed, a mistake would be an error of another thing, or none.
    def test_mistakes__are_named(self):
        for call, text in (
                (lambda: pccd.joints_screw([0, 0, 0], [0, 0, 0], 1), "of its axis"),
                (lambda: pccd.joints_screw([0, 0], [0, 0, 1], 1), "centre has the shape"),
                (lambda: pccd.joints_screw([0, 0, 0], [0, 0, 1], 1, parent=0),
                 "parent is not in the table"),
                (lambda: pccd.joints_poses(([0, 0, 0], [0, 0, 0, 1]),
                                           ([0, 0, 0], [0, 0, 1, 0])), "half a turn"),
                (lambda: pccd.joints_poses(QUARTER, QUARTER, turns=1.5), "turns is 1.5"),
                (lambda: pccd.rotation_of_matrix(2 * np.eye(3, 4)), "by 3, more than"),
                (lambda: pccd.rotation_of_matrix(np.eye(3).ravel()),
                 r"m has the shape \(9,\), not \(3, 3\) or \(3, 4\)"),
                (lambda: pccd.Motions().turning(1, 4, 1.0), "joint is 1.0"),
                (lambda: pccd.joints_place(pccd.joints_screw([0] * 3, [1] * 3, 1), 9, 0),
                 "no such joint"),
                (lambda: pccd.Motions().joints(np.zeros(3)), "of JOINT")):
            with self.assertRaisesRegex(pccd.PccdError, text) as error:
                call()
            self.assertEqual(error.exception.status, pccd.Status.E_INVAL)


class Steps(Case):
    """A door that turns about its pin, and a post."""

    def setUp(self):
        super().setUp()
        self.scene = self.client.scene_create()
        door = self.client.mesh_create(DOOR, np.array([[0, 1, 2], [0, 2, 3]]))
        post = self.client.mesh_create(POST, np.array([[0, 1, 2]]))
        self.door = self.client.scene_add(self.scene, door)
        self.post = self.client.scene_add(self.scene, post)

    # If this failed, arrays of joint values would move a body elsewhere.
    def test_motions__turn_by_the_values_of_a_table(self):
        table = pccd.joints_screw([0, 0, 0], [0, 0, 1], 0)
        moves = pccd.Motions()
        moves.joints(table)
        moves.turning(self.door, len(DOOR), len(table) - 1)
        for begin, end, toi in ((0, math.pi / 2, .5), (0, .75, 2),
                                (-1, 1, (1 + math.pi / 4) / 2)):
            table["from"][0, 0], table["to"][0, 0] = begin, end
            with self.client.step(self.scene, moves) as answer:
                self.assertEqual(answer.count, 3 if toi < 2 else 0)
                self.assertAlmostEqual(answer.toi_first, toi, 5)
                for k, toi in enumerate(answer.contacts["toi"]):  # where they are then
                    m = pccd.joints_place(table, len(table) - 1, toi)
                    at = self.client.bodies(self.scene).points(
                        answer.contacts[k:k + 1], {self.door: DOOR, self.post: POST},
                        poses={self.door: (m, m)})
                    np.testing.assert_allclose(at[0, 0], at[0, 1], atol=1e-5)
                    self.assertAlmostEqual(math.atan2(at[0, 0, 1], at[0, 0, 0]),
                                           math.pi / 4, 5)
        with self.client.near(self.scene, "nearest", motions=moves) as answer:
            self.assertEqual(answer.count, 1)
        table["from"][0, 0], table["to"][0, 0] = 0, math.pi / 2
        place = np.empty((3, 4))
        part, answer = self.client.step_safe(self.scene, moves, [place])
        with answer:
            self.assertEqual(answer.count, 3)
        self.assertTrue(.4999 < part < .5)
        self.assertAlmostEqual(place[0, 0], math.cos(part * math.pi / 2), 12)

    # If this failed, many motions at once would be others than one by one.
    def test_batches__turn_as_motions_do(self):
        tables = [pccd.joints_screw([0, 0, 0], [0, 0, 1], angle) for angle in (.75, 1)]
        other = self.client.scene_create()
        door = self.client.scene_add(other, self.client.mesh_create(
            DOOR, np.array([[0, 1, 2], [0, 2, 3]])))
        parts = [pccd.Part(scene, body, len(DOOR), len(table) - 1, way="turning")
                 for scene, body, table in ((self.scene, self.door, tables[1]),
                                            (other, door, tables[0]))]
        batch = self.client.batch(parts, [len(tables[1]), len(tables[0])])
        with batch.step([tables[1], tables[0]]) as answer:
            self.assertEqual(answer.scenes["total"].tolist(), [3, 0])
        batch.close()
        parts.insert(1, pccd.Part(self.scene, self.post, len(POST), 0, way="turning"))
        batch = self.client.batch(parts, [len(tables[1]), len(tables[0])])
        with batch.step([tables[1], tables[1].copy(), tables[0]]) as answer:
            self.assertEqual(answer.failed, 0)
        for x1, text in (([tables[1], tables[0], tables[0]],
                          "part 1: its table of joints differs from that of part 0"),
                         ([tables[1], np.zeros(len(tables[1])), tables[0]],
                          r"part 1: a table of joints is an array of JOINT.*float64"),
                         ([tables[1], tables[1], np.zeros(len(tables[0]))],
                          "part 2: a table of joints .* as joints_screw")):
            with self.assertRaisesRegex(pccd.PccdError, text) as error:
                batch.step(x1)
            self.assertEqual(error.exception.status, pccd.Status.E_INVAL)
        batch.close()

    # If this failed, a frame would do something else than motions.
    def test_frames__turn_as_motions_do(self):
        table = pccd.joints_screw([0, 0, 0], [0, 0, 1], math.pi / 2)
        with self.client.frame(self.scene, 8 + 136 * len(table)) as frame:
            frame.joints(table)
            frame.turning(self.door, len(DOOR), len(table) - 1)
            with self.client.wait(frame.commit()) as answer:
                self.assertEqual(answer.count, 3)
        with self.client.frame(self.scene, 8) as frame:
            with self.assertRaisesRegex(pccd.PccdError, "E_STATE"):
                frame.turning(self.door, len(DOOR), 0)
