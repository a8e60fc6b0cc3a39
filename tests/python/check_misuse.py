"""check_misuse.py - mistakes in Python, none of which ends or hangs a program.

Room:     tests/python. Needs PCCDD and PCCD_DAEMON, set by make check.
Does:     errors that cross processes; records, frames and batches that are used too late;
          several threads in one client; arrays, numbers and names that are none. What
          could end a program runs in one of its own; by a daemon and in this process.
"""

import copy
import enum
import gc
import multiprocessing
import os
import pickle
import signal
import subprocess
import sys
import textwrap
import threading
import time
import unittest
import unittest.mock

import numpy as np

import pccd
from check_client import Case
from pccd.library import lib
from support import TENT, TENT_TRIANGLES, Daemon, dropped

HEAD = """
import gc, os, signal, sys, threading, time
import numpy as np
import pccd
from support import TENT, TENT_TRIANGLES, Scene, dropped

client = pccd.connect(sys.argv[1], result_bytes=1 << 21)
scene, mesh = client.scene_create(), client.mesh_create(TENT, TENT_TRIANGLES)
tent = client.scene_add(scene, mesh)
"""


def fail(status):
    """A task of another process."""
    raise pccd.PccdError(status, "a task has failed")


class Programs(Case):
    """Mistakes that a program must survive."""

    def runs(self, text, *urls):
        """A program after HEAD, whatever computes: its output each time."""
        said = []
        for url in urls or (self.owner.url, "direct:"):
            with self.subTest(url=url):
                done = subprocess.run(
                    [sys.executable, "-c", HEAD + textwrap.dedent(text), url],
                    check=False, stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
                    timeout=100)
                self.assertEqual(done.returncode, 0, done.stdout.decode())
                said.append(done.stdout.decode())
        return said

    # If this failed, who looks at an answer after the client is closed would have no
    # program any more.
    def test_records__may_be_looked_at_first_when_all_is_closed(self):
        self.runs("""
            def make(client):
                answer = client.step_x0x1(scene, tent, TENT, dropped())
                return answer, client.near(scene, distance=9), \\
                    client.near(scene, pccd.NearWhat.VERTICES, 9)

            batch = client.batch([pccd.Part(scene, tent, 6)])
            worlds = batch.step(dropped()[None])
            old = make(client)
            with client.frame(scene, 1 << 22):  # the ring grows
                pass
            new = make(client)
            client.close()
            gc.collect()
            for answers in old, new:
                for answer in answers:
                    assert len(answer.records) == answer.count > 0
                    assert np.isfinite(answer.records.view("u1")).all()
                assert (answers[2].vertex_bounds > 0).all()
            assert np.allclose(old[0].contacts["toi"], [0.5])
            assert worlds.scenes["total"].tolist() == [1]
            assert worlds.contacts(0)["feature_a"].tolist() == [3]
            assert worlds.why(0) == "" and len(worlds.pairs(0)) == 0
            kept = worlds.contacts(0)
            for answer in (*old, *new, worlds):
                answer.release()
                answer.release()
            for look in (lambda: old[0].contacts, lambda: worlds.scenes,
                         lambda: worlds.contacts(0)):
                try:
                    look()
                except pccd.PccdError as error:
                    assert error.name == "E_STATE" and "is released" in error.text
                else:
                    raise AssertionError("records after release()")
            assert np.allclose(kept["toi"], [0.5])
            """)

    # If this failed, a crash of the daemon would take the program along.
    def test_records__may_be_looked_at_first_when_the_daemon_is_another(self):
        daemon = Daemon("--supervise")
        self.addCleanup(daemon.stop)
        self.runs("""
            answer = client.step_x1(scene, tent, dropped())
            batch = client.batch([pccd.Part(scene, tent, 6)])
            worlds = batch.step(TENT[None])
            for _ in range(2):
                os.kill(client.daemon_pid, signal.SIGKILL)
                client.step_x1(scene, tent, TENT).release()
            assert client.link_info.reconnects == 2
            assert np.allclose(answer.contacts["toi"], [0.5])
            answer.release()
            client.close()
            assert worlds.scenes["scene"].tolist() == [scene]
            """, daemon.url)

    # If this failed, a program that ends in the middle of its work would end by SIGABRT.
    def test_programs__may_end_with_a_batch_that_is_begun(self):
        for end in ("sys.exit()", "client.close()", "del client; gc.collect()",
                    "client.close(); batch.close()", "os.kill(os.getpid(), 2)"):
            said = self.runs(f"""
                batch = client.batch([pccd.Part(scene, tent, 6)])
                frame = client.frame(scene, 72)
                x = frame.x1(tent, 6)
                x1 = batch.begin()
                try:
                    {end}
                except KeyboardInterrupt:
                    pass
                x[:] = 7
                if x1.flags.writeable:
                    x1[:] = 7
                """)
            self.assertEqual(said, ["", ""], end)

    # If this failed, threads that share a client would end the program, hang, or have
    # each other's answers.
    def test_threads__in_one_client_are_told_so(self):
        self.runs("""
            from support import cloth
            world, done, busy, wrong = Scene(client, 30), [], [], []
            x = [cloth(30, k / 7) for k in range(7)]

            def ask(k):
                with client.step_x0x1(world.scene, world.cloth, x[0], x[k]) as answer:
                    return answer.hash

            want = [ask(k) for k in range(7)]

            def go():
                for k in range(400):
                    try:
                        done.append(ask(k % 7) == want[k % 7])
                        client.stats(), client.frame(scene, 72).abort()
                        client.batch([pccd.Part(scene, tent, 6)]).begin()
                    except pccd.PccdError as error:
                        (busy if error.name == "E_BUSY" else wrong).append(error)

            threads = [threading.Thread(target=go) for _ in range(4)]
            [thread.start() for thread in threads]
            [thread.join() for thread in threads]
            assert not wrong, wrong[:3]
            assert all("another thread" in error.text for error in busy), busy
            assert len(done) > 100 and all(done), (len(done), sum(done))
            gc.collect()
            client.step_x1(scene, tent, dropped()).release()
            """)

    # If this failed, a program would crash as it ends, or not end.
    def test_programs__may_end_while_a_thread_is_in_a_call(self):
        self.runs("""
            name = client.scene_create(name=f"end {os.getpid()}")
            threading.Thread(target=client.scene_wait, args=(name, 50),
                             daemon=True).start()
            time.sleep(0.3)
            """)


class Threads(Case):
    """One thread at a time."""

    # If this failed, a thread would not learn that the client is another's, or disturb
    # it.
    def test_thread__is_refused_while_another_is_in_a_call(self):
        client = self.connect()
        scene, _, tent = self.tent(client)
        held = client.step_x1(scene, tent, dropped())
        frame, batch = client.frame(scene, 72), client.batch([pccd.Part(scene, tent, 6)])
        shared, got = client.scene_create(name="threads"), []
        # Between two parts of a wait the client is nobody's.
        whole = unittest.mock.patch("pccd.scenes.SLICE_MS", 10000)
        whole.start()
        self.addCleanup(whole.stop)
        thread = threading.Thread(
            target=lambda: got.append(client.scene_wait(shared, 1.5)))
        thread.start()
        time.sleep(0.2)
        busy = pccd.Status.E_BUSY
        for call in (client.ping, client.poll, client.close, batch.begin, frame.abort,
                     lambda: frame.x1(tent, 6), lambda: client.step_x1(scene, tent, TENT),
                     lambda: client.near(scene), lambda: client.abandon(7)):
            self.assertIn("another thread", self.fails(busy, call).text)
        # In C, too: an error, of which the other thread's text knows nothing.
        round_trip = np.zeros(1, np.uint64)
        self.assertEqual(lib.pccd_ping(client._handle, round_trip.ctypes.data), busy)
        self.assertIn(b"another thread", lib.pccd_error_text(client._handle))
        held.release()  # as soon as somebody calls
        self.assertIn("is released",
                      self.fails(pccd.Status.E_STATE, lambda: held.records).text)
        batch = None
        gc.collect()
        self.assertTrue(thread.is_alive())
        thread.join()
        self.assertEqual(got, [None])
        frame.abort()
        self.assertGreater(client.ping(), 0)
        for _ in range(300):  # pages come back
            client.step_x0x1(scene, tent, TENT, dropped()).release()

    # If this failed, a child of a program with threads could not even close its client.
    def test_fork__leaves_the_threads_behind(self):
        client = self.connect()
        shared = client.scene_create(name="forked")
        thread = threading.Thread(target=client.scene_wait, args=(shared, 1.0))
        thread.start()
        time.sleep(0.2)
        child = os.fork()
        if child == 0:
            signal.alarm(20)
            good = False
            try:
                client.ping()
            except pccd.PccdError as error:
                good = error.name == "E_DISCONNECTED"
            client.close()
            os._exit(0 if good else 1)
        self.assertEqual(os.waitpid(child, 0)[1], 0)
        thread.join()
        self.assertGreater(client.ping(), 0)

    # If this failed, batches that are forgotten would pile up, or end a call at work.
    def test_batches__that_are_forgotten_give_their_slot_back(self):
        scene, _, tent = self.tent()
        for _ in range(20):
            self.client.batch([pccd.Part(scene, tent, 6)]).begin()
            self.client.near(scene).release()
        with self.client.batch([pccd.Part(scene, tent, 6)]).step(TENT[None]) as answer:
            self.assertEqual(answer.failed, 0)
        for _ in range(300):  # more than the library has pages
            self.client.batch([pccd.Part(scene, tent, 6)]).step(TENT[None])


class Errors(Case):
    """In other processes."""

    # If this failed, an error would not come out of a process, or as another one.
    def test_errors__are_pickled_and_copied(self):
        for status in (pccd.Status.E_QUOTA, -12345):
            error = pccd.PccdError(status, "why")
            for other in (pickle.loads(pickle.dumps(error)), copy.copy(error),
                          copy.deepcopy(error)):
                self.assertEqual((other.status, other.name, other.text, str(other)),
                                 (error.status, error.name, error.text, str(error)))
        scene, mesh, tent = self.tent()
        answer = self.client.step_x1(scene, tent, TENT)
        for value in (self.client.mesh_info(mesh), self.client.daemon, answer.times,
                      answer.counters, self.client.object_get(scene, tent),
                      self.client.link_info, pccd.StepSettings(mode="first"),
                      pccd.Part(scene, tent, 6, way="rigid"),
                      self.client.config_list()[0]):
            self.assertEqual(pickle.loads(pickle.dumps(value)), value)

    # If this failed, the first error of a task would hang pool.map for ever.
    def test_pool__brings_the_error_of_a_task(self):
        for way in "fork", "spawn":
            with multiprocessing.get_context(way).Pool(1) as pool:
                with self.assertRaisesRegex(pccd.PccdError, "a task has failed"):
                    pool.map_async(fail, [pccd.Status.E_STATE]).get(60)


class Arguments(Case):
    """What is not what was meant."""

    # If this failed, a part of a body would move, and the rest stand still, in silence.
    def test_step__moves_all_vertices_or_says_so(self):
        for client in (self.client, pccd.connect("direct:", result_bytes=1 << 21)):
            scene, mesh, tent = self.tent(client)
            segment = pccd.Status.E_SEGMENT
            for few in TENT[:3], np.concatenate([TENT, TENT]):
                error = self.fails(segment, client.step_x1, scene, tent, few)
                self.assertIn("which has 6", error.text)
                self.fails(segment, client.step_x0x1, np.uint32(scene), np.uint32(tent),
                           few, few)
            with client.step_x1(scene, tent, dropped()) as answer:
                self.assertEqual(answer.total, 1)
            client.mesh_replace(mesh, TENT[:3], TENT_TRIANGLES[:1])
            self.fails(segment, client.step_x1, scene, tent, TENT)
            client.mesh_destroy(mesh)
            self.fails(segment, client.step_x1, scene, tent, TENT)
            client.step_x1(scene, tent, TENT[:3]).release()
            client.scene_remove(scene, tent)
            self.fails(pccd.Status.E_HANDLE, client.step_x1, scene, tent, TENT[:3])
            client.scene_destroy(scene)
            self.fails(pccd.Status.E_HANDLE, client.step_x1, scene, tent, TENT)
        client.close()

    # If this failed, twelve numbers of any kind would be taken for a pose.
    def test_poses__have_a_shape_and_are_finite(self):
        scene, _, tent = self.tent()
        pose = np.eye(4)[:3]
        with self.client.frame(scene, 384, 2) as frame:
            for bad in (pose.T, pose.reshape(-1), np.arange(12), pose[None],
                        np.zeros((4, 3)), np.eye(4), 1.0):
                self.fails(pccd.Status.E_INVAL, frame.rigid, tent, 6, pose, bad)
                self.fails(pccd.Status.E_INVAL, frame.rigid, tent, 6, bad, pose)
            for number in np.nan, np.inf:
                bad = pose.copy()
                bad[1, 3] = number
                self.fails(pccd.Status.E_NOTFINITE, frame.rigid, tent, 6, pose, bad)
            frame.rigid(tent, 6, pose, pose.tolist())
            self.client.wait(frame.commit()).release()
        moves = pccd.Motions()
        moves.rigid(tent, 6, pose, bad)
        self.fails(pccd.Status.E_NOTFINITE, self.client.step, scene, moves)

    # If this failed, one vertex would be spread over all of a body, what an earlier
    # step wrote would be sent again, or other numbers than those that were given.
    def test_batch__takes_arrays_of_its_shape_alone(self):
        scene, _, tent = self.tent()
        other = self.client.scene_create()
        body = self.client.scene_add(other, self.client.mesh_create(TENT, TENT_TRIANGLES))
        invalid = pccd.Status.E_INVAL
        even = self.client.batch([pccd.Part(scene, tent, 6), pccd.Part(other, body, 6)])
        both = np.stack([TENT] * 2).astype(np.float64)
        for bad in (TENT, TENT[0], 0.0, TENT[None], both[:, :3], both + 0j,
                    both.astype(str), np.ma.masked_array(both, both > 0), both + 1e-12,
                    both + 1e300):
            self.fails(invalid, even.submit, bad)
        even.step(both).release()
        mixed = self.client.batch([pccd.Part(scene, tent, 6, way="x0x1"),
                                   pccd.Part(other, body, 6, way="rigid")])
        pose = np.eye(3, 4)
        for bad in ([(TENT,), (pose, pose)], [(TENT, TENT[0]), (pose, pose)],
                    [(TENT, TENT), (pose, 1.0)], [(TENT, TENT), (pose,)],
                    [(TENT, TENT, TENT), (pose, pose)]):
            self.fails(invalid, mixed.submit, bad)
        mixed.step([(TENT, dropped()), (pose, pose)]).release()
        mixed.close()
        self.fails(pccd.Status.E_STATE, mixed.begin)
        self.fails(pccd.Status.E_STATE, mixed.commit)
        even.begin()
        self.fails(pccd.Status.E_STATE, even.begin)
        even.commit()
        self.fails(pccd.Status.E_STATE, even.commit)
        even.abort()

    # If this failed, who writes "nearest" or "first" would have to look up a number.
    def test_enumerators__have_names(self):
        scene, _, tent = self.tent()
        ask = self.client.step_x0x1
        first = pccd.StepSettings(mode="first", method="PAPER")
        self.assertEqual(first, pccd.StepSettings(mode=pccd.Mode.FIRST, method=1))
        with ask(scene, tent, TENT, dropped(), first) as answer:
            self.assertEqual((answer.mode, answer.method),
                             (pccd.Mode.FIRST, pccd.Method.PAPER))
            self.assertEqual(len(self.client.scene_boxes(scene, "triangles", 0)),
                             len(self.client.scene_boxes(scene, pccd.Tree.TRIANGLES, 0)))
        self.client.scene_create(name="names", share="open")
        self.assertEqual(self.client.near(scene, "crossings").what,
                         pccd.NearWhat.CROSSINGS)
        self.client.histogram("steps")
        for call, names in (
                (lambda: self.client.near(scene, "closest"), "what is 'closest', not one "
                 "of pairs, features, vertices, nearest, crossings, depth"),
                (lambda: self.client.near(scene, pccd.Mode.FIRST), "what is <Mode.FIRST"),
                (lambda: self.client.near(scene, method="best"), "method is 'best'"),
                (lambda: pccd.StepSettings(mode="best"), "mode is 'best', not one of"),
                (lambda: pccd.StepSettings(mode=None), "mode is None"),
                (lambda: pccd.Part(1, 2, 3, way="bent"), "way is 'bent'"),
                (lambda: self.client.scene_create(share="best"), "share is 'best'"),
                (lambda: self.client.histogram("best"), "kind is 'best'"),
                (lambda: self.client.scene_boxes(scene, "oak", 0), "tree is 'oak'")):
            self.assertIn(names, self.fails(pccd.Status.E_INVAL, call).text)
        self.assertTrue(issubclass(pccd.Mode, enum.IntEnum))

    # If this failed, who asks for the nearest pair would be told that there is none.
    def test_nearest__looks_as_far_as_it_takes(self):
        for client in (self.client, pccd.connect("direct:", result_bytes=1 << 21)):
            scene, mesh, _ = self.tent(client)
            away = client.scene_add(scene, client.mesh_create(TENT + 50, TENT_TRIANGLES))
            with client.near(scene, pccd.NearWhat.NEAREST) as answer:
                self.assertEqual(answer.total, 1)
                self.assertEqual(answer.near["object_b"].tolist(), [away])
            with client.near(scene, "nearest", 9.0) as answer:
                self.assertEqual(answer.total, 0)
            with client.frame(scene, 192) as frame:
                pose = np.eye(3, 4)
                frame.rigid(away, 6, pose, pose)
                with client.wait(frame.commit_near(what="nearest")) as answer:
                    self.assertEqual(answer.total, 1)
            with client.near(scene, "pairs") as answer:
                self.assertEqual(answer.total, 0)
            error = self.fails(pccd.Status.E_INVAL, client.near, scene, "vertices")
            self.assertIn("distance", error.text)
        client.close()

    # If this failed, a number would be cut off to another one in silence.
    def test_numbers__are_taken_whole_or_not_at_all(self):
        scene, _, tent = self.tent()
        invalid = pccd.Status.E_INVAL
        for options in ({"slot_count": 1 << 32}, {"spin_us": -1}, {"timeout": 1e10},
                        {"timeout": float("nan")}, {"reconnect": float("inf")},
                        {"result_bytes": -1}, {"slot_bytes": "large"},
                        {"daemons_max": 1 << 31}, {"keep": "no"}, {"observes": "no"}):
            self.fails(invalid, pccd.connect, self.owner.url, **options)
        for options in ({"threads": 1.5}, {"threads": 1 << 32}, {"deadline_ns": -1},
                        {"deadline_ns": None}, {"tolerance": "small"}, {"tuning": 7}):
            self.fails(invalid, pccd.StepSettings, **options)
        self.assertEqual(pccd.StepSettings(deadline_ns=1e9).deadline_ns, 1e9)
        for options in ({"distance": "far"}, {"gap": None}, {"object_b": -1},
                        {"object_a": 1 << 32}, {"distance": float("nan")},
                        {"object_a": np.array([1])}, {"at_begin": "no"}):
            self.fails(invalid, self.client.near, scene, **options)
        for attributes in ({"radius": "thick"}, {"group": -1}, {"mask": 1 << 64},
                           {"rest_rings": 1.5}, {"radius": float("nan")},
                           {"self_collision": "off"}):
            self.fails(invalid, self.client.object_set, scene, tent, **attributes)
        self.fails(invalid, self.client.pair_ignore, scene, tent, 7, "no")
        for objects in ([-1], [tent + 0.5], [1 << 32]):
            self.fails(invalid, self.client.user_data, scene, objects)
        self.fails(invalid, self.client.record_start, "never", max_bytes=-1)
        self.fails(pccd.Status.E_HANDLE, self.client.mesh_replace, 99, TENT,
                   TENT_TRIANGLES)


if __name__ == "__main__":
    unittest.main()
