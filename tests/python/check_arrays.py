"""check_arrays.py - what only a library under Python can do wrong: arrays, calls, memory.

Room:     tests/python. Needs PCCD_DAEMON and PCCDCTL, set by make check.
Does:     motions that are read at each step, in this process, too; recordings; arrays
          that outlive what they lie in; signals.
"""

import ctypes
import gc
import itertools
import os
import platform
import signal
import subprocess
import tempfile
import time
import unittest

import numpy as np

import pccd
from check_client import Case
from support import TENT, TENT_TRIANGLES, Scene, dropped


class Several(Case):
    """Many objects in one call, in this process, too; recordings."""

    # If this failed, bodies that are moved in one call would go elsewhere, or not be read
    # anew at each step.
    def test_motions__are_read_at_each_step(self):
        for client in (self.client, pccd.connect("direct:", result_bytes=1 << 21)):
            scene, _, tent = self.tent(client)
            want = client.step_x0x1(scene, tent, TENT, dropped()).hash
            x = np.array([TENT, dropped()])
            poses = np.tile(np.eye(4)[:3], (2, 2, 1, 1))
            ways = [pccd.Motions() for _ in range(3)]
            ways[0].x0x1(tent, x[0], x[1])
            ways[1].x1(tent, x[1])
            ways[2].rigid(tent, 3, poses[0, 0], poses[1, 0])
            ways[2].rigid(tent, 3, poses[0, 1], poses[1, 1], first=3)
            poses[1, 1, 2, 3] = -2
            for way, size in zip(ways, (1, 1, 2)):
                self.assertEqual(len(way), size)
                client.step_x1(scene, tent, TENT).release()
                with client.step(scene, way) as answer:
                    self.assertEqual(answer.hash, want)
                    self.assertIn("1 contacts, the first at 0.5", repr(answer))
            x[1] = TENT
            client.step_x1(scene, tent, TENT).release()
            for way in ways[:2]:
                self.assertEqual(client.wait(client.submit(scene, way)).total, 0)
            client.scene_destroy(scene)
        self.assertEqual(client.url, "direct:")
        self.assertEqual(client.daemon_pid, os.getpid())
        client.close()

    # If this failed, a program that rounds otherwise, or flushes subnormal numbers, would
    # get other contacts of `direct:`, or compute otherwise after it.
    def test_direct__is_the_same_however_the_program_rounds(self):
        libm = ctypes.CDLL("libm.so.6")
        unit = 0x400000 if platform.machine() == "aarch64" else 0x400
        flushes = [0, 0x8000, 0x40, 0x8040] if platform.machine() == "x86_64" else [0]
        random = np.random.default_rng(7)
        x = random.random((2, 3000, 3))
        triangles = np.arange(3000, dtype=np.uint32).reshape(-1, 3)
        x[:] = x[:, ::3].repeat(3, 1) + 0.1 * x
        small = x * 2.0**-1022
        before, mine, after = ((ctypes.c_uint32 * 8)() for _ in range(3))
        libm.fegetenv(before)
        told = set()
        for direction, flush in itertools.product(range(4), flushes):
            libm.fesetround(direction * unit)
            libm.fegetenv(mine)
            mine[7] |= flush  # MXCSR, of an x86
            try:
                self.assertEqual(libm.fesetenv(mine), 0)
                with pccd.connect("direct:") as client:
                    for positions in (x, small):
                        scene = client.scene_create()
                        mesh = client.mesh_create(positions[0], triangles)
                        body = client.scene_add(scene, mesh)
                        with client.step_x1(scene, body, positions[1]) as answer:
                            told.add((positions is x, answer.hash, answer.total))
                libm.fegetenv(after)
            finally:
                libm.fesetenv(before)
            self.assertEqual(after[7] & ~0x3f, mine[7] & ~0x3f)
            self.assertEqual(list(after)[:1], list(mine)[:1])
        self.assertEqual(len(told), 2)
        self.assertGreater(min(total for _, _, total in told), 1000)

    # If this failed, more motions than there was room for would be lost.
    def test_motions__may_be_any_number(self):
        scene = self.client.scene_create()
        mesh = self.client.mesh_create(TENT, TENT_TRIANGLES)
        apart = np.arange(50)[:, None, None] * np.float32([50, 0, 0])
        x = np.array([TENT + apart, dropped() + apart], np.float32)
        moves = pccd.Motions()
        for k in range(50):
            body = self.client.scene_add(scene, mesh)
            moves.x0x1(np.uint32(body), x[0, k], x[1, k])
        for _ in range(2):
            with self.client.step(scene, moves) as answer:
                self.assertEqual(answer.total, 50)

    # If this failed, an array that is not what a step reads would be copied in silence,
    # or
    # read beyond its end.
    def test_motions__refuse_what_cannot_be_read(self):
        moves, tent, m = pccd.Motions(), 7, np.eye(4)[:3].copy()
        invalid = pccd.Status.E_INVAL
        for x in (TENT.tolist(), TENT[::2], TENT[:, :2], TENT.astype(int), TENT[:0],
                  TENT.reshape(-1), np.asfortranarray(TENT), np.ma.array(TENT, mask=1)):
            self.fails(invalid, moves.x1, tent, x)
        self.fails(invalid, moves.x0x1, tent, TENT, TENT[1:])
        self.fails(invalid, moves.x0x1, tent, TENT, TENT.astype(float))
        for bad in (np.eye(3), np.eye(4), m.astype("f4"), m.T, m.tolist()):
            self.fails(invalid, moves.rigid, tent, 3, m, bad)
        self.fails(invalid, moves.x1, -1, TENT)
        self.fails(invalid, moves.x1, tent, TENT, first=1 << 32)
        self.fails(invalid, moves.rigid, "tent", 3, m, m)
        self.assertEqual(len(moves), 0)
        self.fails(pccd.Status.E_HANDLE, self.client.step, 1 << 30, moves)
        self.fails(invalid, self.client.step, 1 << 40, moves)

    # If this failed, a session could not be recorded from Python, or not repeated.
    def test_recordings__are_repeated_by_pccdctl(self):
        with tempfile.TemporaryDirectory() as folder:
            path = f"{folder}/python.rec"
            scene, _, tent = self.tent()
            self.fails(pccd.Status.E_STATE, self.client.record)
            self.client.record_start(path, contacts=True, level=3)
            self.fails(pccd.Status.E_STATE, self.client.record_start, path)
            self.client.step_x0x1(scene, tent, TENT, dropped()).release()
            self.client.step_x1(scene, tent, TENT).release()
            self.assertEqual(self.client.record().frames, 2)
            info = self.client.record_stop()
            self.assertEqual((info.frames, info.answers, info.status), (2, 2, 0))
            self.assertEqual(info.bytes, os.path.getsize(path))
            done = subprocess.run([os.environ["PCCDCTL"], "replay", "--private", path],
                                  check=False, stdout=subprocess.PIPE, timeout=60)
            self.assertEqual(done.returncode, 0, done.stdout)

    # If this failed, who repeats a session would get other handles.
    def test_handles__can_be_wished_for(self):
        scene = self.client.scene_create()
        self.client.scene_destroy(scene)
        self.client.request_handle(scene)
        self.assertEqual(self.client.scene_create(), scene)
        self.client.request_handle(scene)
        self.fails(pccd.Status.E_HANDLE, self.client.scene_create)


class Memory(Case):
    """Arrays that outlive what they lie in."""

    # If this failed, an array that is used too late would end the program.
    def test_arrays__can_be_read_when_all_is_closed(self):
        for url in (self.owner.url, "direct:"):
            client = pccd.connect(url, result_bytes=1 << 21)
            scene, _, tent = self.tent(client)
            held = client.step_x1(scene, tent, dropped())
            contacts, toi = held.contacts, held.contacts["toi"]
            want = contacts.tobytes()
            frame = client.frame(scene, 72)
            x1 = frame.x1(tent, 6)
            part = x1[2:4]
            frame.commit()
            frame = None
            with client.frame(scene, 1 << 22):  # the ring grows
                part[:] = 7
            self.assertEqual(contacts.tobytes(), want)
            client.close()
            client = held = None
            gc.collect()
            self.assertEqual(contacts.tobytes(), want)
            self.assertLessEqual(toi[0], 0.5)
            # The slot was free, so the daemon may have taken its memory back by now.
            self.assertIn(part.tolist(), ([[7, 7, 7]] * 2, [[0, 0, 0]] * 2))
            with self.assertRaises(ValueError):
                contacts.flags.writeable = True

    # If this failed, memory of rings that nobody looks at would pile up.
    def test_memory__goes_with_its_last_array(self):
        def mapped():
            with open("/proc/self/maps", encoding="ascii") as file:
                return sum("memfd:pccd" in line for line in file)

        before = mapped()
        client = pccd.connect(self.owner.url, result_bytes=1 << 21)
        scene, _, tent = self.tent(client)
        with client.step_x1(scene, tent, dropped()) as answer:
            contacts = answer.contacts
        self.assertGreater(mapped(), before)
        client.close()
        self.assertEqual(mapped(), before + 1)
        del answer
        self.assertEqual(contacts["feature_a"].tolist(), [3])
        del contacts
        gc.collect()
        self.assertEqual(mapped(), before)

    # If this failed, a mistake with a closed client would end the program.
    def test_clients__that_are_closed_say_so(self):
        client = self.connect()
        scene, _, tent = self.tent(client)
        answer = client.step_x1(scene, tent, dropped())
        frame = client.frame(scene, 72)
        client.close()
        client.close()
        answer.release()
        frame.abort()
        lost = pccd.Status.E_DISCONNECTED
        moves = pccd.Motions()
        for call in (client.ping, client.poll, client.stats, client.list_scenes,
                     lambda: client.step(scene, moves), lambda: client.wait(1),
                     lambda: client.step_x1(scene, tent, TENT), client.scene_create,
                     lambda: frame.x1(tent, 6), frame.commit,
                     lambda: client.frame(scene, 72), lambda: client.link_info):
            self.fails(lost, call)
        client.abandon(1)
        self.assertEqual((client.fileno(), client.url), (-1, ""))
        self.assertIn("closed", repr(client))

    # If this failed, Ctrl-C would do nothing until a step's timeout is over.
    def test_waits__end_at_a_signal(self):
        with pccd.connect(private=True, result_bytes=1 << 16) as client:
            scene = Scene(client)
            os.kill(client.daemon_pid, signal.SIGSTOP)
            try:
                before = signal.signal(signal.SIGALRM, signal.default_int_handler)
                for wait in (lambda: scene.hash(0.5), lambda: client.scene_wait(77),
                             lambda number=scene.submit(0.2): client.wait(number)):
                    signal.setitimer(signal.ITIMER_REAL, 0.3)
                    begin = time.monotonic()
                    with self.assertRaises(KeyboardInterrupt):
                        wait()
                    self.assertLess(time.monotonic() - begin, 10)
            finally:
                signal.signal(signal.SIGALRM, before)
                os.kill(client.daemon_pid, signal.SIGCONT)
            scene.hash(0.5)


if __name__ == "__main__":
    unittest.main()
