"""wire.py - what proto/*.h says, in Python.

Room:     client/python. May import: numpy.
Does:     the constants and records of pccd_types.h, pccd_trace.h, proto_limits.h and
          shm.h. tests/python compares each with the headers.
"""

import enum
import struct

import numpy as np


class Status(enum.IntEnum):
    """Every status of the wire and of the clients."""

    OK = 0
    E_NOMEM = -1
    E_INVAL = -2
    E_QUOTA = -3
    E_LIMIT = -4
    E_BADMSG = -5
    E_VERSION = -6
    E_NOHELLO = -7
    E_NOMETHOD = -8
    E_HANDLE = -9
    E_STATE = -10
    E_BUSY = -11
    E_SLOT_STALE = -12
    E_SLOT_TORN = -13
    E_SEGMENT = -14
    E_NOTFINITE = -15
    E_INDEX = -16
    E_DISCONNECTED = -17
    E_TIMEOUT = -18
    E_NODAEMON = -19
    E_SHUTDOWN = -20
    E_CANCELLED = -21
    E_SYSTEM = -22
    E_AGAIN = -23
    E_FORMAT = -24
    E_INTERNAL = -25
    E_ACCESS = -26


class Mode(enum.IntEnum):
    """What a step is asked for."""

    ALL = 0  # every contact
    FIRST = 1  # the contacts that may attain the scene's earliest time
    ANY = 2  # yes, no or possible; no records
    PAIRS = 3  # the pairs that no axis separates


class Method(enum.IntEnum):
    """Which engine computes; both give the same bytes."""

    DEFAULT = 0
    PAPER = 1
    WIDE = 2


class Scheduler(enum.IntEnum):
    """How the threads of a step share its work."""

    DEFAULT = 0
    STEAL = 1
    PAPER = 2


class HighLevel(enum.IntEnum):
    """How all threads perform one high-level node together."""

    DEFAULT = 0
    ROUND_ROBIN = 1
    DISJOINT = 2


class Refit(enum.IntEnum):
    """How the threads share the refit."""

    DEFAULT = 0
    EVEN = 1
    PAPER = 2


class Quality(enum.IntEnum):
    """How the hierarchies of a scene are built."""

    DEFAULT = 0
    MEDIAN = 1
    SAH = 2


class Share(enum.IntEnum):
    """Of a scene that clients share: make it, or take part."""

    CREATE = 0  # there must be none of that name
    OPEN = 1  # made unless there is one
    ATTACH = 2  # there must be one
    OTHER = 3  # there must be one of another user, who is named


class ObjectWhat(enum.IntFlag):
    """Which of an object's settings are set."""

    GROUP = 1
    MASK = 2
    SELF = 4
    ALL = 7


class Format(enum.IntEnum):
    """Of coordinates: float32 or float64."""

    F32 = 0
    F64 = 1


class Kind(enum.IntEnum):
    """Of a contact: a vertex of object a and a face of object b, or two edges."""

    VF = 0
    EE = 1


class ContactFlag(enum.IntFlag):
    """Flags of a contact."""

    PROVED = 1  # it exists, and its first time lies in [toi, toi_hi]
    INITIAL = 2  # the features touch at t = 0 already


class Incomplete(enum.IntEnum):
    """Why an answer is not complete."""

    COMPLETE = 0
    RESULT_FULL = 1  # the page ended; go on with the cursor
    DEADLINE = 2
    CANCELLED = 3
    CONTACT_LIMIT = 4  # more records than the daemon keeps of one step


class Verdict(enum.IntEnum):
    """The answer of mode ANY."""

    NO = 0
    POSSIBLE = 1
    YES = 2
    NONE = 3  # other modes, or incomplete before a decision


class Tree(enum.IntEnum):
    """Of a scene's hierarchies: three of the method wide, and that of paper."""

    VERTICES = 0
    EDGES = 1
    FACES = 2
    TRIANGLES = 3


class TraceKind(enum.IntEnum):
    """What an event of a recording was."""

    STEP = 0
    REFIT = 1
    UNIT = 2
    SUBTREE = 3
    PAIRS = 4
    HIGH = 5
    TESTS = 6
    REBUILD = 7
    ASIDE = 8
    WAIT = 9
    MERGE = 10
    REQUEST = 11
    RECEIVE = 12
    ANSWER = 13


class HistogramKind(enum.IntEnum):
    """Whose times a histogram has."""

    STEPS = 0  # steps, as computed
    REQUESTS = 1  # requests of every kind, from arrival to answer


#: struct pccd_contact. toi, toi_hi in 0 .. 1; param: barycentric weights of the face's
#: second and third vertex, or positions along edge a and edge b; normal: unit, from b
#: to a.
CONTACT = np.dtype([
    ("kind", "<u4"), ("flags", "<u4"), ("object_a", "<u4"), ("feature_a", "<u4"),
    ("object_b", "<u4"), ("feature_b", "<u4"), ("toi", "<f8"), ("toi_hi", "<f8"),
    ("param", "<f4", (2,)), ("normal", "<f4", (3,)), ("reserved", "<u4")])
#: struct pccd_pair: a candidate of mode PAIRS.
PAIR = np.dtype([("kind", "<u4"), ("object_a", "<u4"), ("feature_a", "<u4"),
                 ("object_b", "<u4"), ("feature_b", "<u4")])
#: struct pccd_edge: vertex indices, a < b.
EDGE = np.dtype([("a", "<u4"), ("b", "<u4")])
#: struct pccd_box: at both ends of a step.
BOX = np.dtype([("low0", "<f4", (3,)), ("high0", "<f4", (3,)), ("low1", "<f4", (3,)),
                ("high1", "<f4", (3,))])
#: struct pccd_trace_event. CLOCK_MONOTONIC, nanoseconds.
TRACE_EVENT = np.dtype([("begin_ns", "<u8"), ("end_ns", "<u8"), ("kind", "<u4"),
                        ("thread", "<u4"), ("a", "<u4"), ("b", "<u4")])

VERSION_MIN = 1
VERSION_MAX = 1
FEATURE_RESUME = 1
FEATURE_FILTERS = 2  # object.set, scene.ignore
FEATURE_OBSERVE = 4  # lists, histograms, settings, watching
FEATURE_SHARED = 8  # scenes that clients share
FEATURE_HELD = 32  # scene.held is told
HISTOGRAM_BUCKETS = 27
MESSAGE_BYTES_MAX = 65536
SLOTS_MAX = 16
INFLIGHT_MAX = 16
REPLIES_KEPT = 32  # requests without an answer
SEGMENTS_MAX = 65536
SLOT_BYTES_MIN = 4096
RESULT_BYTES_MIN = 65536

# Words of the upload ring, of 8 bytes each: indices, not offsets.
CLIENT_WAIT = 0x200 // 8
RESULT_HEAD = 0x280 // 8
HEAD = 0x080 // 8
SLOT_SEQ = 0x400 // 8
SLOT_WORDS = 64 // 8
PAYLOADS = 0x1000

X1, X0X1, RIGID = 0, 1, 2  # kinds of segment
SEGMENT = struct.Struct("<IHHIIQQ")  # struct proto_segment
RIGID_BYTES = 96
