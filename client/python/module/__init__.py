"""__init__.py - pccd: collisions of moving meshes, by a daemon or within this process.

Room:     client/python; installed. Needs Python 3.9, numpy and libpccd; nothing compiled.
Does:     every call of libpccd, through ctypes, with arrays of numpy: register meshes,
          place them in scenes, write positions straight into shared memory, read the
          contacts of a step where they lie. pccd.h says the same of each call in C.
Threads:  a client and everything made from it (frames, batches) belong to one thread at a
          time: while a method runs, those that other threads call are E_BUSY. Different
          clients are independent: connect one for each thread. A call gives Python's lock
          back while it runs, so other threads go on. An answer may be released or
          forgotten in any thread. In a forked copy of the process every call with a
          client but close() is E_DISCONNECTED: it connects itself.

    import pccd

    with pccd.connect() as client:                   # connect("direct:"): no daemon
        scene = client.scene_create()
        mesh = client.mesh_create(x0, triangles)     # (n, 3) float32 or float64, (m, 3)
        cloth = client.scene_add(scene, mesh)
        for x1 in frames:
            with client.step_x1(scene, cloth, x1) as answer:
                print(answer.count, answer.contacts["toi"].min(initial=2.0))

Arrays. `answer.contacts` is a view of memory that the daemon writes: read-only, and right
until answer.release(), which `with` calls; copy what is to stay. Later it may show
another answer's records, or zeros. An array of a frame may be written until its commit.
Neither is ever memory that is not there, whatever is closed, lost or grown meanwhile, and
whenever it is looked at first.

Names. What wants an enumerator takes its name as well: StepSettings(mode="first"),
client.near(scene, "nearest").

Every failure is a PccdError with the library's status, its name and its text. Times are
in seconds where they are given, in nanoseconds where their name ends in _ns. Ctrl-C ends
a wait for a step within a fifth of a second; the step is abandoned if nobody else can
wait for it.
"""

from . import abi
from .abi import (BatchWay, ContactFlag, Format, HistogramKind, Incomplete, JointKind,
                  Kind, Method,
                  Mode, NearFlag, NearKind, NearWhat, ObjectWhat, Share, Touching,
                  Status, TraceKind, Tree, Verdict)
from .answer import Answer
from .batch import SCENE, Batch, BatchAnswer, Part
from .client import Client, connect
from .frame import Frame, Motions
from .library import PccdError
from .points import MANIFOLD, Bodies, Shape, Stencils
from .rays import Hits, Rays
from .turning import (JOINT, NO_JOINT, joints_place, joints_poses,
                      joints_rotation_vector, joints_screw, rotation_of_matrix)
from .values import (BOX, CONTACT, EDGE, NEAR, PAIR, TRACE_EVENT, DaemonInfo, Histogram,
                     LinkInfo, MeshInfo, ObjectSettings, RecordInfo, SceneNews, Setting,
                     StepCounters, StepEvent, StepSettings, StepTimes, TraceInfo)
from .weld import Welded, weld

__version__ = abi.VERSION

__all__ = [
    "Answer", "Batch", "BatchAnswer", "BatchWay", "Bodies", "BOX", "Client", "connect",
    "CONTACT", "ContactFlag", "DaemonInfo", "EDGE", "Format", "Frame", "Histogram",
    "HistogramKind", "Hits", "Incomplete", "JOINT", "JointKind", "joints_place",
    "joints_poses", "joints_rotation_vector", "joints_screw", "Kind", "LinkInfo",
    "MANIFOLD", "MeshInfo", "Method", "Mode", "Motions", "NEAR", "NearFlag", "NearKind",
    "NearWhat", "NO_JOINT", "ObjectSettings", "ObjectWhat", "PAIR", "Part", "PccdError",
    "Rays", "RecordInfo",
    "rotation_of_matrix", "SCENE", "SceneNews", "Setting", "Shape", "Share", "Status",
    "Stencils", "StepCounters", "StepEvent", "StepSettings", "StepTimes", "Touching",
    "TRACE_EVENT", "TraceInfo", "TraceKind", "Tree", "Verdict", "weld", "Welded",
]
