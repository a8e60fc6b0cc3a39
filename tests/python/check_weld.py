"""check_weld.py - vertices at one place, from Python and by pccdctl.

Room:     tests/python. Needs PCCDCTL, set by make check.
Does:     weld arrays, write the same as OBJ files, and compare.
"""

import json
import os
import subprocess
import tempfile
import unittest

import numpy as np

import pccd


def write_obj(path, x, triangles):
    with open(path, "w", encoding="ascii") as to:
        to.writelines(f"v {float(a)!r} {float(b)!r} {float(c)!r}\n" for a, b, c in x)
        to.writelines(f"f {a} {b} {c}\n" for a, b, c in np.asarray(triangles) + 1)


class Weld(unittest.TestCase):
    """Loose triangles with corners on a coarse grid, some of which move apart."""

    def told(self, frames, triangles, *options):
        with tempfile.TemporaryDirectory() as folder:
            paths = [os.path.join(folder, f"{i}.obj") for i in range(len(frames))]
            for path, x in zip(paths, frames):
                write_obj(path, x, triangles)
            command = [os.environ["PCCDCTL"], "check", "--json", *options, *paths]
            made = subprocess.run(command, stdout=subprocess.PIPE, check=False)
            return json.loads(made.stdout)

    # If this failed, the same mesh would be another one from Python than from its file.
    def test_weld__joins_as_pccdctl_does(self):
        random = np.random.default_rng(3)
        triangles = np.arange(150).reshape(-1, 3)
        for distance in (0.0, 0.5, 1e-9):
            x = random.integers(0, 4, (150, 3)) * 0.5
            x += random.integers(0, 2, (150, 3)) * 1e-10
            moved = x + (random.integers(0, 8, (150, 1)) == 0)
            welded = pccd.weld([x, moved], triangles, distance=distance)
            told = self.told([x, moved], triangles, "--weld", str(distance or "auto"))
            self.assertEqual((welded.joined, welded.apart),
                             (told["welded"], told["welded_apart"]))
            self.assertGreater(welded.joined, 0)
            self.assertTrue((welded.triangles == welded.to[triangles]).all())
            self.assertEqual(150 - welded.joined, len(np.unique(welded.triangles)))

    # If this failed, 0 and -0 would be two places, or unnamed vertices be used.
    def test_weld__takes_the_least_vertex_that_is_named(self):
        x = np.array([[0, 0, 0], [-0.0, 0, 0], [0, 0, -0.0], [1, 0, 0], [0, 1, 0]])
        welded = pccd.weld([x], [[2, 3, 4], [1, 4, 3]], points=[4])
        self.assertEqual(welded.triangles.tolist(), [[1, 3, 4], [1, 4, 3]])
        self.assertEqual((welded.joined, welded.points.tolist()), (1, [4]))

    # If this failed, who registers a split surface would not be told.
    def test_split__is_counted(self):
        x = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [1, 0, 0], [0, 1, 0], [1, 1, 0]])
        triangles = [[0, 1, 2], [3, 5, 4]]
        with pccd.connect(private=True) as client:
            for joined in (False, True):
                scene = client.scene_create()
                corners = pccd.weld([x], triangles).triangles if joined else triangles
                body = client.scene_add(scene, client.mesh_create(x, corners))
                with client.step_x1(scene, body, x) as answer:
                    self.assertEqual(answer.crowded, not joined)
                    self.assertEqual(answer.coincident, answer.total)

    # If this failed, what is no index would be cut to another vertex.
    def test_weld__refuses_what_is_no_mesh(self):
        x = np.zeros((3, 3))
        for frames, triangles, distance in (
                ([], [[0, 1, 2]], 0), ([x, x[1:]], [[0, 1, 2]], 0),
                ([x[0]], [[0, 1, 2]], 0),
                ([x], [[0, 1, 3]], 0), ([x], [[0, 1, -1]], 0), ([x], [[0, 1, 0.5]], 0),
                ([x], [[0, 1]], 0), ([x], [[0, 1, 2]], -1), ([x], [[0, 1, 2]], np.inf)):
            with self.assertRaises(pccd.PccdError):
                pccd.weld(frames, triangles, distance=distance)


if __name__ == "__main__":
    unittest.main()
