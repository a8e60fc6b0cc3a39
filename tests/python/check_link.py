"""check_link.py - the Python module's ways to a daemon, and what it does when one dies.

Room:     tests/python. Needs PCCDD and PCCD_DAEMON, set by make check.
Does:     urls, daemons that are started, workers killed at every moment of a client's
          life, connections cut, daemons that lie.
"""

import contextlib
import fcntl
import gc
import os
import select
import signal
import socket
import tempfile
import threading
import time
import unittest
import warnings
from unittest import mock

import msgpack
import numpy as np

import pccd
import support
from support import (TENT, TENT_TRIANGLES, Case, Daemon, Scene, Supervised, cloth,
                     cloth_triangles, dropped, ends, is_running)

SMALL = {"result_bytes": 1 << 18}  # a region that is quickly made


class Patience(unittest.TestCase):
    """How these tests wait for the end of a process."""

    # If this failed, a machine that stands still for a while would look like a daemon
    # that outlives its SIGKILL.
    def test_ends__is_not_hasty_where_the_clock_jumps(self):
        clock = [0.0]

        def stand_still(_seconds):
            clock[0] += 60

        with mock.patch.object(support.time, "sleep", stand_still), \
                mock.patch.object(support.time, "monotonic", lambda: clock[0]), \
                mock.patch.object(support, "is_running",
                                  side_effect=[True, True, True, False]):
            self.assertTrue(ends(1))
        with mock.patch.object(support.time, "sleep", stand_still), \
                mock.patch.object(support, "is_running", return_value=True):
            self.assertFalse(ends(1, looks=3))


class Ways(Case):
    """How a daemon is found, or started."""

    # If this failed, a mistyped url would lead to a daemon that nobody meant.
    def test_urls__are_checked(self):
        status = pccd.Status
        for url in ("", "tcp:host", "unix:", "unix:" + "x" * 108, "direct"):
            self.fails(status.E_INVAL, pccd.connect, url)
        for options in ({"timeout": 0}, {"slot_count": 17}, {"slot_bytes": 100},
                        {"result_bytes": 4096}, {"reconnect": -1}, {"daemons_max": 0},
                        {"private": True}):
            self.fails(status.E_INVAL, pccd.connect, "unix:a", **options)
        self.fails(status.E_INVAL, pccd.connect, private=True, autostart=False)
        error = self.fails(status.E_INVAL, pccd.connect, "direct:", timeout=0)
        self.assertEqual(error.text, "timeout is 0 seconds")
        error = self.fails(status.E_NODAEMON, pccd.connect, "unix:/nowhere/pccd.sock")
        self.assertIn("/nowhere/pccd.sock", error.text)
        with mock.patch.dict(os.environ, {"PCCD_URL": "unix:/nowhere/else"}):
            error = self.fails(status.E_NODAEMON, pccd.connect)
        self.assertIn("/nowhere/else", error.text)

    # If this failed, a private daemon would stay when its client is gone, or its folder;
    # or come back elsewhere, where nobody finds it whom its client has told of it.
    def test_private_daemons__go_with_their_client(self):
        with tempfile.TemporaryDirectory() as runtime, \
                mock.patch.dict(os.environ, {"XDG_RUNTIME_DIR": runtime}):
            with pccd.connect(private=True) as client:
                pid = client.daemon_pid
                self.assertTrue(is_running(pid))
                self.assertEqual(len(os.listdir(runtime)), 1)
            self.assertTrue(ends(pid))
            client = pccd.connect(private=True)
            pid = client.daemon_pid
            child = os.fork()
            if child == 0:  # a copy has no claim on the daemon
                client.close()
                os._exit(0)
            os.waitpid(child, 0)
            client.ping()
            self.assertTrue(is_running(pid))
            with pccd.connect(client.url) as other:
                os.kill(pid, signal.SIGKILL)
                client.ping()
                self.assertEqual((other.url, other.ping() > 0), (client.url, True))
                self.assertNotEqual(other.daemon_pid, pid)
            pid = client.daemon_pid
            with warnings.catch_warnings():
                warnings.simplefilter("ignore", ResourceWarning)
                del client
                gc.collect()
            self.assertTrue(ends(pid))
            self.assertEqual(os.listdir(runtime), [])

    # If this failed, the first client of a user would need somebody to start a daemon.
    def test_user_daemon__is_started_for_the_first_and_serves_the_second(self):
        with tempfile.TemporaryDirectory() as runtime, \
                mock.patch.dict(os.environ, {"XDG_RUNTIME_DIR": runtime}):
            self.fails(pccd.Status.E_NODAEMON, pccd.connect, autostart=False)
            with pccd.connect() as first, pccd.connect() as second:
                self.assertEqual(first.daemon_pid, second.daemon_pid)
                self.assertEqual(first.url, f"unix:{runtime}/pccd/pccd.sock")
                pid = first.daemon_pid
            self.assertTrue(is_running(pid))
            os.kill(pid, signal.SIGTERM)
            self.assertTrue(ends(pid))

    # If this failed, of clients that start together some would say that their daemon
    # ended at once where the one that has the lock takes seconds to listen.
    def test_user_daemon__that_has_the_lock_is_waited_for(self):
        with tempfile.TemporaryDirectory() as runtime, \
                mock.patch.dict(os.environ, {"XDG_RUNTIME_DIR": runtime}):
            os.mkdir(runtime + "/pccd", 0o700)
            lock = os.open(runtime + "/pccd/pccd.sock.lock",
                           os.O_RDWR | os.O_CREAT, 0o600)
            fcntl.flock(lock, fcntl.LOCK_EX)
            leaves = threading.Timer(1.5, os.close, (lock,))
            leaves.start()
            with pccd.connect() as client:
                pid = client.daemon_pid
            leaves.join()
            os.kill(pid, signal.SIGTERM)
            self.assertTrue(ends(pid))

    # If this failed, a daemon that cannot be started would not be told from a slow one.
    def test_programs__that_are_no_daemon_are_told(self):
        self.fails(pccd.Status.E_NODAEMON, pccd.connect, private=True,
                   daemon="/bin/false")
        error = self.fails(pccd.Status.E_NODAEMON, pccd.connect, private=True,
                           daemon="no-such-program")
        self.assertIn("no-such-program", error.text)

    # If this failed, a loop of one's own could not tell when an answer has come.
    def test_fileno__is_ready_when_an_answer_has_come(self):
        with pccd.connect(private=True, **SMALL) as client:
            scene = Scene(client)
            number = scene.submit(0.5)
            poll = select.poll()
            poll.register(client, select.POLLIN)
            self.assertTrue(poll.poll(10000))
            answer = client.poll()
            self.assertEqual(answer.step, number)
            answer.release()
        self.assertEqual(client.fileno(), -1)
        self.fails(pccd.Status.E_DISCONNECTED, client.ping)

    # If this failed, a program that forks would lose answers to its copy, or have it
    # write into the frame at hand, or give back records that are still read.
    def test_copies__of_the_process_touch_nothing(self):
        def in_the_copy(client, answer, frame):
            answer.release()
            for call in (client.ping, frame.commit, client.poll):
                with contextlib.suppress(AssertionError):
                    self.fails(pccd.Status.E_DISCONNECTED, call)
                    continue
                return 1
            client.close()
            return 0

        with pccd.connect(private=True, **SMALL) as client:
            scene = Scene(client)
            number = scene.submit(0.5)
            answer = client.wait(number)
            self.assertGreater(answer.count, 0)
            records = answer.records.tobytes()
            frame = client.frame(scene.scene, 400 * 12)
            frame.x1(scene.cloth, 400)[:] = cloth(20, 0)
            pid = os.fork()
            if pid == 0:
                code = 2
                try:
                    code = in_the_copy(client, answer, frame)
                finally:
                    os._exit(code)
            self.assertEqual(os.waitpid(pid, 0)[1], 0)
            client.wait(frame.commit()).release()
            scene.hash(0.5)
            self.assertEqual(answer.records.tobytes(), records)
            answer.release()
            self.assertGreater(client.ping(), 0)


class Losses(Supervised):
    """A daemon under a supervisor, whose workers are killed."""

    options = ("--threads", "1", "--crashes-max", "1000")
    result_bytes = SMALL["result_bytes"]

    @staticmethod
    def kill(client):
        """The worker that the client has last talked to; it is gone afterwards."""
        pid = client.daemon_pid
        with contextlib.suppress(ProcessLookupError):  # it is dead, and not known to be
            os.kill(pid, signal.SIGKILL)
        ends(pid)

    # If this failed, positions, or the order of steps, would be others after a crash.
    def test_steps__have_the_same_bytes_when_daemons_die(self):
        client, calm = self.connect(), pccd.connect(private=True, **SMALL)
        self.addCleanup(calm.close)
        scene, other = Scene(client), Scene(calm)
        for round_ in range(6):
            times = [(round_ + k / 3) / 7 for k in range(3)]
            want = [other.hash(step) for step in times]
            numbers = []
            for k, step in enumerate(times):
                if round_ % 4 == k:  # round 3: none; in flight, or answered and not read
                    self.kill(client)
                numbers.append(scene.submit(step))
            if round_ % 4 == 3:
                self.kill(client)
            self.assertEqual([client.wait(number).hash for number in numbers], want)
            client.ping()  # all answers may have been sent before the kill
        self.assertEqual(client.link_info.reconnects, 6)
        self.assertEqual(client.link_info.resumed, 0)
        self.assertGreater(client.link_info.restore_ns, 0)

    # If this failed, what was moved in part or rigidly would jump after a crash.
    def test_objects__come_back_where_they_were(self):
        client = self.connect(slot_count=2)
        scene = client.scene_create()
        mesh = client.mesh_create(TENT, TENT_TRIANGLES)
        wide = client.mesh_create(TENT.astype(float) + [9, 0, 0], TENT_TRIANGLES)
        parts, rigid, still, double = (client.scene_add(scene, which)
                                       for which in (mesh, mesh, mesh, wide))
        client.scene_remove(scene, still)
        client.mesh_destroy(mesh)
        up = np.eye(4)[:3]
        up[2, 3] = 8
        turn = np.array([[0, 1, 0, 20], [-1, 0, 0, 0], [0, 0, 1, 0.0]])
        with client.frame(scene, 10 * 72 + 192, segment_max=3) as frame:
            frame.x1(parts, 2, first=3)[:] = TENT[3:5] + [0, 0, 0.5]
            frame.rigid(rigid, 6, up, turn)
            frame.x1(double, 6, dtype=np.float64)[:] = TENT + [9.1, 0, 0.1]
            client.wait(frame.commit()).release()
        with client.frame(scene, 192) as frame:
            frame.rigid(parts, 1, up, up, first=5)
            client.wait(frame.commit()).release()
        client.wait(client.submit_still(scene)).release()
        want = None
        for kill in (False, False, True, True):
            if kill:
                self.kill(client)
            lowered = TENT[3:4] - [0, 0, 1.5]
            with client.frame(scene, 3 * 36, segment_max=3) as frame:
                frame.x1(parts, 1, first=3)[:] = lowered
                frame.x1(rigid, 1, first=3)[:] = (lowered @ turn[:, :3].T + turn[:, 3])
                frame.x1(double, 1, first=3)[:] = lowered + [9, 0, 0]
                with client.wait(frame.commit()) as answer:
                    self.assertEqual(sorted(answer.contacts["object_a"].tolist()),
                                     sorted([parts, rigid, double]))
                    got = answer.records.tobytes()
                    want = want or got
                    self.assertEqual(got, want)
            with client.frame(scene, 4 * 36, segment_max=3) as frame:
                frame.x1(parts, 1, first=3)[:] = TENT[3:4] + [0, 0, 0.5]
                frame.x1(rigid, 1, first=3)[:] = TENT[3:4] @ turn[:, :3].T + turn[:, 3]
                frame.x1(double, 1, 3, np.float64)[:] = TENT[3:4] + [9.1, 0, 0.1]
                client.wait(frame.commit()).release()
        self.assertEqual(client.link_info.reconnects, 2)

    # If this failed, arrays of a frame that is being written would lead nowhere.
    def test_frames__that_are_begun_outlive_the_daemon(self):
        client = self.connect()
        scene = client.scene_create()
        tent = client.scene_add(scene, client.mesh_create(TENT, TENT_TRIANGLES))
        held = client.step_x1(scene, tent, dropped())
        want = held.records.tobytes()
        client.step_x1(scene, tent, TENT).release()
        with client.frame(scene, 72) as frame:
            x1 = frame.x1(tent, 6)
            x1[:3] = dropped()[:3]
            self.kill(client)
            client.ping()
            self.assertEqual(client.link_info.reconnects, 1)
            x1[3:] = dropped()[3:]
            with client.wait(frame.commit()) as answer:
                self.assertEqual(answer.records.tobytes(), want)
        self.assertEqual(held.records.tobytes(), want)
        held.release()
        client.step_x1(scene, tent, TENT).release()
        self.fails(pccd.Status.E_STATE, client.fetch, scene, answer.step, 0)

    # If this failed, a mesh could be lost, or made twice, when a daemon dies meanwhile.
    def test_meshes__are_registered_while_daemons_die(self):
        client = self.connect(daemons_max=100)
        scene, other = Scene(client), Scene(self.connect())
        stop = threading.Event()

        def kills():
            for _ in range(12):
                if not stop.wait(0.03):
                    self.kill(client)

        killer = threading.Thread(target=kills)
        killer.start()
        try:
            mesh = client.mesh_create(cloth(300), cloth_triangles(300))
            info = client.mesh_replace(mesh, cloth(200), cloth_triangles(200))
            body = client.scene_add(scene.scene, mesh)
        finally:
            stop.set()
            killer.join()
        self.assertGreater(client.link_info.reconnects, 0)
        self.assertEqual(info.vertex_count, 40000)
        self.assertEqual(client.mesh_info(mesh).edge_count, len(client.mesh_edges(mesh)))
        client.scene_remove(scene.scene, body)
        client.mesh_destroy(mesh)
        self.assertEqual(scene.hash(0.5), other.hash(0.5))
        self.assertEqual(client.stats()["meshes_now"], 4)

    # If this failed, a cut connection would cost the session, or run a step twice.
    def test_sessions__are_resumed_when_a_connection_is_cut(self):
        client = self.connect()
        scene, other = Scene(client), Scene(self.connect())
        fileno = client.fileno()
        for round_ in range(10):
            numbers = [scene.submit((round_ + k / 3) / 10) for k in range(3)]
            with socket.socket(fileno=os.dup(client.fileno())) as own:
                own.shutdown(socket.SHUT_RDWR)
            got = [client.wait(number).hash for number in numbers]
            self.assertEqual(got, [other.hash((round_ + k / 3) / 10) for k in range(3)])
        client.ping()  # all answers may have been read before the last cut
        self.assertEqual(client.link_info.reconnects, 10)
        self.assertEqual(client.link_info.resumed, 10)
        self.assertEqual(client.fileno(), fileno)

    # If this failed, who watches would hear nothing more after a crash.
    def test_watch__goes_on_with_the_next_daemon(self):
        client, watcher = self.connect(), self.connect()
        scene = Scene(client)
        watcher.watch_start()
        for step in (0.3, 0.6):
            want = scene.hash(step)
            event = watcher.watch_next()
            while event.mode != pccd.Mode.ALL:  # by which the cloth was brought back
                event = watcher.watch_next()
            self.assertEqual((event.hash, event.scene), (want, scene.scene))
            self.kill(client)
            self.assertIsNone(watcher.watch_next(0.01))
            watcher.ping()
            self.assertIsNone(watcher.watch_next(0.01))  # asks the daemon that is there
        self.assertEqual(watcher.link_info.reconnects, 2)

    # If this failed, a loop that polls would block while there is no daemon.
    def test_poll__makes_the_connection_again(self):
        client = self.connect()
        scene = Scene(client)
        want = scene.hash(0.5)
        scene.hash(0)
        number = scene.submit(0.5)
        self.kill(client)
        answer, until = None, time.monotonic() + 20
        while answer is None and time.monotonic() < until:
            answer = client.poll()
        self.assertEqual((answer.step, answer.hash), (number, want))
        answer.release()

    # If this failed, who wants no other daemon, or kept nothing, would get wrong answers.
    def test_losses__are_errors_where_that_is_asked_for(self):
        for options in ({"reconnect": 0}, {"keep": False}):
            client = self.connect(**options)
            scene = Scene(client)
            number = scene.submit(0.5)
            client.wait(number).release()
            number = scene.submit(0.6)
            client.wait(number).release()
            self.kill(client)
            self.fails(pccd.Status.E_DISCONNECTED, scene.hash, 0.7)
            self.fails(pccd.Status.E_DISCONNECTED, client.stats)
            self.fails(pccd.Status.E_DISCONNECTED, client.poll)

    # If this failed, a daemon that ends in order would take its clients with it.
    def test_shutdown__is_survived_or_told(self):
        daemon = Daemon("--threads", "1")
        patient = pccd.connect(daemon.url, **SMALL)
        hasty = pccd.connect(daemon.url, reconnect=0, **SMALL)
        scene = Scene(patient)
        want = scene.hash(0.5)
        scene.hash(0)
        daemon.process.terminate()
        self.assertEqual(daemon.process.wait(20), 0)
        error = self.fails(pccd.Status.E_DISCONNECTED, hasty.ping)
        self.assertIn("says", error.text)
        daemon.start()
        self.assertEqual(scene.hash(0.5), want)
        self.assertEqual(patient.link_info.reconnects, 1)
        patient.close()
        hasty.close()
        self.assertEqual(daemon.stop(), 0)


LAST = []  # in place of descriptors: the liar closes the connection


class Liar:
    """A daemon that answers as it is told: one function for each connection."""

    def __init__(self, *answers):
        self.folder = tempfile.TemporaryDirectory()
        self.url = f"unix:{self.folder.name}/socket"
        self.answers = answers
        self.listener = socket.socket(socket.AF_UNIX, socket.SOCK_SEQPACKET)
        self.listener.bind(self.url[5:])
        self.listener.listen()
        self.thread = threading.Thread(target=self.serve)
        self.thread.start()

    def serve(self):
        for answer in self.answers:
            connection, _ = self.listener.accept()
            with connection, contextlib.suppress(ConnectionError):
                while True:
                    data = connection.recv(1 << 16)
                    if not data:
                        break
                    _, id_, method, params = msgpack.unpackb(data)
                    reply = answer(id_, method, params)
                    if reply is None:
                        break
                    data, fds = reply if isinstance(reply, tuple) else (reply, ())
                    socket.send_fds(connection, [data], fds)
                    if fds is LAST:
                        break

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.listener.shutdown(socket.SHUT_RDWR)
        self.thread.join(10)
        self.listener.close()
        self.folder.cleanup()


def hello(**changed):
    """The result of hello, from a daemon of another epoch each time."""
    return {"version": 1, "features": 1, "epoch": time.monotonic_ns(), "session": 1,
            "pid": 1, "threads_max": 1, "daemon": "liar", "token_hi": 1, "token_lo": 2,
            **changed}


def pack(*items):
    """A message."""
    return msgpack.packb(items)


class Liars(Case):
    """What a broken or newer daemon says."""

    # If this failed, a loop that watches the descriptor would sleep for ever where the
    # next daemon hangs: nothing would have it look for another one.
    def test_fileno__is_ready_until_the_loss_is_over(self):
        over = threading.Event()

        def end_over_a_ping(id_, method, _):
            return pack(1, id_, None, hello()) if method == "hello" else None

        def hang(*_):
            over.wait(20)

        with Liar(end_over_a_ping, hang) as liar:
            client = pccd.connect(liar.url, timeout=0.3)
            self.fails(pccd.Status.E_TIMEOUT, client.ping)
            self.assertTrue(select.select([client], [], [], 0)[0])
            over.set()
            client.close()

    # If this failed, a daemon of another protocol would be spoken to all the same.
    def test_hello__is_looked_at(self):
        status = pccd.Status
        for want, answer in (
                (status.E_VERSION, lambda i, *_: pack(1, i, None, hello(version=2))),
                (status.E_VERSION, lambda i, *_: pack(1, i, [-6, "E_VERSION", "no", True],
                                                      None)),
                (status.E_QUOTA, lambda *_: (pack(2, "goaway", {"code": 3}), LAST)),
                (status.E_BADMSG, lambda i, *_: pack(1, i, None, {"version": 1})),
                (status.E_DISCONNECTED, lambda i, *_: b"\xc1"),
                (status.E_DISCONNECTED, lambda i, *_: b"\x2a"),
                (status.E_DISCONNECTED, lambda i, *_: pack(1, i, [5], None)),
                (status.E_DISCONNECTED, lambda i, *_: pack(1, i, None, 7)),
                (status.E_DISCONNECTED, lambda i, *_: b"\xdd\xff\xff\xff\xff"),
                (status.E_DISCONNECTED, lambda i, *_: None)):
            def once(i, method, params, answer=answer, asked=[]):
                asked.append(method)
                return answer(i, method, params) if len(asked) == 1 else None
            with self.subTest(want.name), Liar(once) as liar:
                self.fails(want, pccd.connect, liar.url, reconnect=0, timeout=5)

    # If this failed, memory that can shrink would be mapped, and a read of it kill us.
    def test_memory__without_seals_is_refused(self):
        def answer(id_, method, _):
            if method == "hello":
                return pack(1, id_, None, hello())
            if method != "shm.attach":
                return None
            fds = [os.memfd_create("liar") for _ in range(2)]
            for fd in fds:
                os.ftruncate(fd, 1 << 17)
            return pack(1, id_, None, {"upload_bytes": 1 << 17, "result_bytes": 1 << 17,
                                       "slot_count": 1, "slot_stride": 1 << 12,
                                       "inflight_max": 1}), fds

        before = len(os.listdir("/proc/self/fd"))
        with Liar(answer) as liar, pccd.connect(liar.url) as client:
            self.fails(pccd.Status.E_BADMSG, client.mesh_create, TENT, TENT_TRIANGLES)
        after = len(os.listdir("/proc/self/fd"))
        self.assertLessEqual(after, before + 2)  # the liar's own

    # If this failed, a request that ends every daemon would be tried for ever.
    def test_requests__over_which_daemons_end_fail_alone(self):
        def answer(id_, method, params):
            if method == "ping":
                return pack(1, id_, None, {"token": params["token"], "uptime_ns": 1})
            return None if method == "scene.create" else pack(1, id_, None, hello())

        with Liar(*[answer] * 4) as liar, \
                pccd.connect(liar.url, daemons_max=3, reconnect=20) as client:
            error = self.fails(pccd.Status.E_DISCONNECTED, client.scene_create)
            self.assertIn("daemon after daemon", error.text)
            client.ping()
            self.assertEqual(client.link_info.reconnects, 3)

    # If this failed, what a newer daemon says besides would end the client.
    def test_notifications__that_are_unknown_are_left_alone(self):
        def answer(id_, method, _):
            if method == "hello":
                return pack(1, id_, None, hello(new=[1, {"a": 2}]))
            return pack(2, "news", {"number": 7})

        with Liar(answer) as liar, pccd.connect(liar.url, timeout=1) as client:
            self.fails(pccd.Status.E_TIMEOUT, client.ping)


if __name__ == "__main__":
    unittest.main()
