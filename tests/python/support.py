"""support.py - daemons and scenes for the tests of the Python client.

Room:     tests/python. Imports pccd.
Does:     real daemons in folders of their own; meshes whose contacts are known.
"""

import os
import shutil
import signal
import subprocess
import tempfile
import time
import unittest

import numpy as np

import pccd

#: Vertices 0, 1, 2 lie in the plane z = 0; a triangle above it has its lowest corner,
#: vertex 3, over the inside of the first.
TENT = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0.25, 0.25, 1], [0.25, 0.25, 4],
                 [0.375, 0.25, 4]], np.float32)
TENT_TRIANGLES = np.array([[0, 1, 2], [3, 4, 5]], np.uint32)


def dropped(by=2.0):
    """The tent with its upper triangle lowered; by 2: vertex 3 meets face 0 at 1/2."""
    x = TENT.copy()
    x[3:, 2] -= by
    return x


def cloth(side, step=0.0):
    """A wavy square that sinks through z = 0 while `step` goes from 0 to 1."""
    u, v = np.meshgrid(*2 * [np.linspace(0, 1, side)], indexing="ij")
    z = 0.3 - 0.6 * step + 0.2 * np.sin(9 * u + 5 * step) * np.cos(7 * v)
    return np.stack([u, v, z], axis=-1).reshape(-1, 3).astype(np.float32)


def cloth_triangles(side):
    """Two a cell."""
    at = (np.arange(side - 1)[:, None] * side + np.arange(side - 1)).reshape(-1)
    lower = np.stack([at, at + 1, at + side], axis=-1)
    upper = np.stack([at + 1, at + side + 1, at + side], axis=-1)
    return np.concatenate([lower, upper]).astype(np.uint32)


def floor(side=9):
    """A coarse grid in the plane z = 0 below the cloth."""
    u, v = np.meshgrid(*2 * [np.linspace(-0.31, 1.27, side)], indexing="ij")
    x = np.stack([u, v, np.zeros_like(u)], axis=-1).reshape(-1, 3).astype(np.float32)
    return x, cloth_triangles(side)


class Scene:
    """A cloth over a floor."""

    def __init__(self, client, side=20):
        self.client = client
        self.side = side
        self.scene = client.scene_create()
        self.floor_mesh = client.mesh_create(*floor())
        self.floor = client.scene_add(self.scene, self.floor_mesh)
        self.mesh = client.mesh_create(cloth(side), cloth_triangles(side))
        self.cloth = client.scene_add(self.scene, self.mesh)

    def submit(self, step, settings=pccd.StepSettings()):
        """Move the cloth through a slot; the number of the step."""
        x = cloth(self.side, step)
        with self.client.frame(self.scene, x.nbytes) as frame:
            frame.x1(self.cloth, len(x))[:] = x
            return frame.commit(settings)

    def hash(self, step, settings=pccd.StepSettings()):
        """The hash of the answer."""
        with self.client.step_x1(self.scene, self.cloth, cloth(self.side, step),
                                 settings) as answer:
            assert answer.incomplete == 0
            return answer.hash


class Daemon:
    """A daemon of its own, supervised: a worker that is killed has a successor."""

    def __init__(self, *options):
        self.folder = tempfile.mkdtemp(prefix="pccd-python-")
        self.url = f"unix:{self.folder}/pccd.sock"
        self.options = options
        self.start()

    def start(self):
        """At the same place, as often as needed."""
        ready, its_end = os.pipe()
        self.process = subprocess.Popen(
            [os.environ["PCCDD"], "--socket", self.url[5:], "--ready-fd", str(its_end),
             *self.options], pass_fds=(its_end,), stdin=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL)
        os.close(its_end)
        assert os.read(ready, 1), "the daemon did not start"
        os.close(ready)

    def stop(self):
        """End it in order."""
        self.process.send_signal(signal.SIGTERM)
        status = self.process.wait(20)
        shutil.rmtree(self.folder)
        return status


class Case(unittest.TestCase):
    """With calls that must fail."""

    def fails(self, status, call, *arguments, **named):
        """The error that a call must raise."""
        with self.assertRaises(pccd.PccdError) as caught:
            call(*arguments, **named)
        self.assertEqual(caught.exception.status, status, caught.exception)
        self.assertEqual(caught.exception.name, status.name)
        self.assertTrue(caught.exception.text)
        return caught.exception


class Supervised(Case):
    """With a supervised daemon for all cases of a class, and clients for each."""

    options = ()  # of the daemon
    result_bytes = 1 << 20  # of clients

    @classmethod
    def setUpClass(cls):
        cls.daemon = Daemon("--supervise", *cls.options)

    @classmethod
    def tearDownClass(cls):
        cls.daemon.stop()

    def connect(self, **options):
        """Closed when the case is over."""
        client = pccd.connect(self.daemon.url,
                              **{"result_bytes": self.result_bytes, **options})
        self.addCleanup(client.close)
        return client


def is_running(pid):
    """Whether a process exists and is no zombie."""
    try:
        with open(f"/proc/{pid}/stat", encoding="ascii") as file:
            return file.read().rsplit(")", 1)[1].split()[0] != "Z"
    except OSError:
        return False


def ends(pid, looks=1000):
    """Wait until a process is gone: 10 s, of a machine that does not stop meanwhile.

    Looks are counted, and not the clock read: where a machine stands still for seconds,
    the first look afterwards may come before the process has had its turn to end.
    """
    for _ in range(looks):
        if not is_running(pid):
            return True
        time.sleep(0.01)
    return not is_running(pid)
