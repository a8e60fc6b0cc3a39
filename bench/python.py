"""python.py - steps from Python beside the same steps from C.

Room:     bench. Imports pccd; starts bench/turns, which is the C side.
Does:     frames of 8 rigid bodies in one call, and steps of a cloth of 46 656 vertices,
          by a daemon and by direct:. Both sides take turns, each in a process of its
          own; a step that has contacts must have the same hash first. A row compares the
          times that a tenth of each side's steps are below: others on the machine only
          add. What is asked for is judged by direct:, where nothing but the caller is
          between two steps: bodies 3 us more than C, cloth 1.05 times C.

    make bench-python                     40 rounds
    make bench-python PYTHON_ROUNDS=200
"""

import os
import statistics
import subprocess
import sys
import time

import numpy as np

import pccd

BODIES, SIDE = 8, 216
ONE_THREAD = pccd.StepSettings(threads=1)


class FromC:
    """The program turns, at the same URL."""

    def __init__(self, program, url):
        self.process = subprocess.Popen([program, url], stdin=subprocess.PIPE,
                                        stdout=subprocess.PIPE, encoding="ascii")

    def ask(self, line):
        """One line of its answer."""
        self.process.stdin.write(line + "\n")
        self.process.stdin.flush()
        return self.process.stdout.readline().split()

    def turn(self, what, count):
        return [int(ns) for ns in self.ask(f"{what} {count}")]

    def check(self):
        return self.ask("check")[0]

    def close(self):
        self.process.stdin.close()
        self.process.wait()


class FromPython:
    """The same steps."""

    def __init__(self, url):
        self.client = pccd.connect(url)
        self.make_bodies()
        self.make_cloth()

    def make_bodies(self):
        x = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]], float)
        faces = [[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]]
        poses = np.zeros((3, BODIES, 3, 4))
        poses[..., :3] = np.eye(3)
        poses[:2, :, 0, 3] = 2 * np.arange(BODIES)
        poses[1, :, 2, 3] = 0.1
        self.bodies_scene = self.client.scene_create()
        mesh = self.client.mesh_create(x, faces)
        self.ways = [pccd.Motions() for _ in range(3)]  # up, down, all to one place
        for k in range(BODIES):
            body = self.client.scene_add(self.bodies_scene, mesh)
            for way, (start, end) in zip(self.ways, ((0, 1), (1, 0), (0, 2))):
                way.rigid(body, 4, poses[start, k], poses[end, k])

    def make_cloth(self):
        u, v = np.meshgrid(*2 * [np.linspace(0, 1, SIDE)], indexing="ij")
        at = (np.arange(SIDE - 1)[:, None] * SIDE + np.arange(SIDE - 1)).reshape(-1)
        faces = np.stack([at, at + 1, at + SIDE, at + 1, at + SIDE + 1, at + SIDE], -1)
        self.x = [np.stack([u, v, 0.05 * np.sin(6 * u + odd)], -1).reshape(-1, 3)
                  .astype(np.float32) for odd in (0.0, 0.01)]
        self.cloth_scene = self.client.scene_create()
        mesh = self.client.mesh_create(self.x[0], faces.reshape(-1, 3))
        self.cloth = self.client.scene_add(self.cloth_scene, mesh)

    def turn(self, what, count):
        client, ways, x, times = self.client, self.ways, self.x, []
        for i in range(count):
            begin = time.perf_counter_ns()
            if what == "bodies":
                with client.step(self.bodies_scene, ways[i % 2], ONE_THREAD):
                    pass
            else:
                with client.step_x1(self.cloth_scene, self.cloth, x[(i + 1) % 2],
                                    ONE_THREAD):
                    pass
            times.append(time.perf_counter_ns() - begin)
        return times

    def check(self):
        with self.client.step(self.bodies_scene, self.ways[2], ONE_THREAD) as answer:
            return answer.hash if answer.total else "none"

    def close(self):
        self.client.close()


def measure(where, what, sides, rounds, count):
    """Print a row. Returns the difference in microseconds, and the ratio."""
    for side in sides:
        side.turn(what, 2 * count)
    times = [[], []]
    for _ in range(rounds):
        for own, side in zip(times, sides):
            own += side.turn(what, count)
    tenths, medians = ([quantiles[k] / 1e3 for quantiles in
                        (statistics.quantiles(own, n=10) for own in times)]
                       for k in (0, 4))
    more, ratio = tenths[1] - tenths[0], tenths[1] / tenths[0]
    print(f"{where:8} {what:7} C {tenths[0]:8.1f} us (median {medians[0]:8.1f}), Python "
          f"{tenths[1]:8.1f} us (median {medians[1]:8.1f}): {more:6.1f} us more, ratio "
          f"{ratio:5.3f}", flush=True)
    return more, ratio


def main():
    rounds = int(os.environ.get("PYTHON_ROUNDS", "40"))
    with pccd.connect(private=True) as owner:
        for where, url in (("daemon", owner.url), ("direct:", "direct:")):
            sides = [FromC(sys.argv[1], url), FromPython(url)]
            hashes = {side.check() for side in sides}
            if len(hashes) != 1 or "none" in hashes:
                sys.exit(f"the two sides got different answers, or none: {hashes}")
            more, _ = measure(where, "bodies", sides, rounds, 200)
            _, ratio = measure(where, "cloth", sides, rounds, 4)
            for side in sides:
                side.close()
    return 0 if more <= 3 and ratio <= 1.05 else 1


if __name__ == "__main__":
    sys.exit(main())
