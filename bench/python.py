"""python.py - round trips of the Python client beside those of libpccd.

Room:     bench. Imports pccd; libpccd through ctypes, so that both take turns in one
          process and talk to one daemon.
Does:     ping, a step in which nothing moves, and a step of 46 656 vertices that go by
          without contacts, TURN calls of one side after TURN of the other. Answers are
          compared before a time is printed. The ratio is the median over the rounds of
          Python's median to that of libpccd without spinning.

    make bench-python                     40 rounds
    make bench-python PYTHON_ROUNDS=200
"""

import ctypes
import os
import statistics
import sys
import time

import numpy as np

import pccd

TURN = 50
SIDE = 216


class Options(ctypes.Structure):
    """The first fields of struct pccd_options, and room for more."""

    _fields_ = [("struct_bytes", ctypes.c_size_t), ("url", ctypes.c_char_p),
                ("daemon", ctypes.c_char_p), ("name", ctypes.c_char_p),
                ("timeout_ms", ctypes.c_int), ("no_autostart", ctypes.c_bool),
                ("private_daemon", ctypes.c_bool), ("slot_count", ctypes.c_uint32),
                ("slot_bytes", ctypes.c_uint64), ("result_bytes", ctypes.c_uint64),
                ("spin_us", ctypes.c_uint32), ("room", ctypes.c_char * 512)]


class Answer(ctypes.Structure):
    """The first fields of struct pccd_answer, and room for more."""

    _fields_ = [("step", ctypes.c_uint64), ("status", ctypes.c_int),
                ("enums", ctypes.c_int * 4), ("records", ctypes.c_void_p * 2),
                ("numbers", ctypes.c_uint64 * 8), ("toi_first", ctypes.c_double),
                ("hash", ctypes.c_uint64 * 2), ("room", ctypes.c_char * 2048)]


class Library:
    """A client of libpccd, with a scene of its own."""

    def __init__(self, path, url, spin_us):
        self.lib = ctypes.CDLL(path)
        options = Options()
        self.lib.pccd_options_init(ctypes.byref(options))
        options.url = url.encode()
        options.spin_us = spin_us
        self.client = ctypes.c_void_p()
        self.must(self.lib.pccd_connect(ctypes.byref(options), ctypes.byref(self.client)))
        self.answer = Answer()
        self.number = ctypes.c_uint64()

    def must(self, status):
        """Or end."""
        if status != 0:
            sys.exit(f"libpccd: status {status}")

    def scene(self, x, triangles):
        """A scene with one object; both handles."""
        scene, mesh, made = (ctypes.c_uint32() for _ in range(3))
        triangles = np.ascontiguousarray(triangles, np.uint32)
        self.must(self.lib.pccd_scene_create(self.client, None, ctypes.byref(scene)))
        self.must(self.lib.pccd_mesh_create(
            self.client, ctypes.c_void_p(x.ctypes.data), 0, len(x),
            ctypes.c_void_p(triangles.ctypes.data), len(triangles), ctypes.byref(mesh),
            None))
        self.must(self.lib.pccd_scene_add(self.client, scene, mesh, ctypes.byref(made)))
        return scene, made

    def ping(self):
        self.must(self.lib.pccd_ping(self.client, None))

    def still(self, scene):
        self.must(self.lib.pccd_submit_still(self.client, scene, None,
                                             ctypes.byref(self.number)))
        self.must(self.lib.pccd_wait(self.client, self.number, -1,
                                     ctypes.byref(self.answer)))
        self.lib.pccd_answer_release(self.client, ctypes.byref(self.answer))
        return self.hash()

    def step(self, scene, made, x):
        self.must(self.lib.pccd_step_x1(self.client, scene, made,
                                        ctypes.c_void_p(x.ctypes.data), 0, len(x), None,
                                        ctypes.byref(self.answer)))
        self.lib.pccd_answer_release(self.client, ctypes.byref(self.answer))
        return self.hash()

    def hash(self):
        return f"{self.answer.hash[0]:016x}{self.answer.hash[1]:016x}"


class Python:
    """The same by the Python client."""

    def __init__(self, url):
        self.client = pccd.connect(url)

    def scene(self, x, triangles):
        scene = self.client.scene_create()
        return scene, self.client.scene_add(scene, self.client.mesh_create(x, triangles))

    def ping(self):
        self.client.ping()

    def still(self, scene):
        with self.client.wait(self.client.submit_still(scene)) as answer:
            return answer.hash

    def step(self, scene, made, x):
        with self.client.step_x1(scene, made, x) as answer:
            return answer.hash


def cloth():
    """A grid without any contact, at two heights that differ by a wave."""
    u, v = np.meshgrid(*2 * [np.linspace(0, 1, SIDE)], indexing="ij")
    at = (np.arange(SIDE - 1)[:, None] * SIDE + np.arange(SIDE - 1)).reshape(-1)
    triangles = np.concatenate([np.stack([at, at + 1, at + SIDE], -1),
                                np.stack([at + 1, at + SIDE + 1, at + SIDE], -1)])
    frames = [np.stack([u, v, 0.05 * np.sin(6 * u + odd)], -1).reshape(-1, 3)
              .astype(np.float32) for odd in (0.0, 0.01)]
    return frames, triangles


def turns(calls, count):
    """Nanoseconds of each side's calls of a round; they must return the same."""
    times, seen = [], set()
    for call in calls:
        own = []
        for i in range(count):
            begin = time.perf_counter_ns()
            seen.add((i % 2, call(i)))
            own.append(time.perf_counter_ns() - begin)
        times.append(own)
    if len({answer for odd, answer in seen if odd == 0}) > 1:
        sys.exit("the clients got different answers")
    return times


def measure(what, names, calls, rounds, count):
    """Print a row for each side."""
    turns(calls, 2 * count)
    took = [turns(calls, count) for _ in range(rounds)]
    for side, name in enumerate(names):
        own = [ns for round_ in took for ns in round_[side]]
        ratio = statistics.median(statistics.median(round_[side]) /
                                  statistics.median(round_[0]) for round_ in took)
        print(f"{what:16} {name:22} median {statistics.median(own) / 1e3:8.1f} us, "
              f"minimum {min(own) / 1e3:8.1f} us, ratio {ratio:5.2f}", flush=True)


def main():
    rounds = int(os.environ.get("PYTHON_ROUNDS", "40"))
    library = sys.argv[1]
    with pccd.connect(private=True) as owner:
        sides = [Library(library, owner.url, 0), Library(library, owner.url, 50),
                 Python(owner.url)]
        names = ["libpccd, blocking", "libpccd, 50 us spin", "Python"]
        (x0, x1), triangles = cloth()
        tiny = [side.scene(x0[:3], [[0, 1, 2]])[0] for side in sides]
        large = [side.scene(x0, triangles) for side in sides]
        measure("ping", names, [lambda i, side=side: side.ping() for side in sides],
                rounds, TURN)
        measure("empty step", names, [lambda i, side=side, scene=scene: side.still(scene)
                                      for side, scene in zip(sides, tiny)], rounds, TURN)
        measure("46 656 vertices", names,
                [lambda i, side=side, at=at: side.step(*at, x0 if i % 2 else x1)
                 for side, at in zip(sides, large)], rounds, 4)


if __name__ == "__main__":
    main()
