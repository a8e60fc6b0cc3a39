"""values.py - what is told and asked besides arrays; arrays as the library wants them.

Room:     client/python. May import: abi, library, numpy.
Does:     the small types of the public interface. Their fields are those of the structs
          of pccd.h, which says what each means.
"""

from __future__ import annotations

import collections
import ctypes
import dataclasses
import enum
import math
from typing import Any, ClassVar, Dict, NamedTuple, Optional, Union

import numpy as np
from numpy.typing import ArrayLike, DTypeLike, NDArray

from . import abi
from .abi import Format, Method, Mode, NearWhat, Status, Touching
from .library import PccdError

CONTACT = np.dtype(abi.pccd_contact)
PAIR = np.dtype(abi.pccd_pair)
NEAR = np.dtype(abi.pccd_near)
EDGE = np.dtype(abi.pccd_edge)
BOX = np.dtype(abi.pccd_box)
TRACE_EVENT = np.dtype(abi.pccd_trace_event)


# ---- structs as tuples and dictionaries ----------------------------------------------

def hash_text(hash: Any) -> str:
    """Of the records of an answer, as `pccdctl check --json` writes it."""
    return f"2:{hash[0]:016x}{hash[1]:016x}"


def field(struct: Any, name: str) -> Any:
    """A field: a hash as text, strings decoded, arrays as tuples."""
    value = getattr(struct, name)
    if name == "hash":
        return hash_text(value)
    if isinstance(value, ctypes.Array):
        return tuple(value)
    return value.decode(errors="replace") if isinstance(value, bytes) else value


def as_dict(struct: Any) -> Dict[str, Any]:
    return {name: field(struct, name) for name, _ in struct._fields_}


def _tuple_of(name: str, struct: Any, doc: str) -> Any:
    """A named tuple with the fields of a struct; its `of` makes one of a struct."""
    fields = [key for key, _ in struct._fields_]
    make: Any = collections.namedtuple
    made = make(name, fields)
    made.__doc__, made.__module__ = doc, "pccd"
    made.of = staticmethod(lambda one: made._make(field(one, key) for key in fields))
    return made


DaemonInfo = _tuple_of("DaemonInfo", abi.pccd_daemon_info,
                       "What was agreed on when connecting.")
LinkInfo = _tuple_of("LinkInfo", abi.pccd_link_info, "What became of lost connections.")
MeshInfo = _tuple_of("MeshInfo", abi.pccd_mesh_info,
                     "What the daemon says of a mesh when it is made or replaced.")
RecordInfo = _tuple_of("RecordInfo", abi.pccd_record_info, "How a recording goes.")
SceneNews = _tuple_of("SceneNews", abi.pccd_scene_news,
                      "The last step that another client has made in a shared scene.")
Setting = _tuple_of("Setting", abi.pccd_setting,
                    "A setting of the daemon that may change while it runs.")
StepCounters = _tuple_of("StepCounters", abi.pccd_step_counters, "What a step did.")
StepEvent = _tuple_of("StepEvent", abi.pccd_step_event,
                      "A step of anybody's, as one who watches is told of it.")
StepTimes = _tuple_of("StepTimes", abi.pccd_step_times,
                      "Nanoseconds of a step's phases; rebuild: over all threads.")
TraceInfo = _tuple_of("TraceInfo", abi.pccd_trace_info,
                      "Of a recording of the daemon's threads.")


class ObjectSettings(NamedTuple):
    """The attributes of an object, in the order of ObjectWhat's bits. Two objects are
    tested against each other if a.group & b.mask and b.group & a.mask have a bit in
    common each, and the pair is not ignored; an object against itself if its
    self_collision is on. A pair meets at the distance r = radius of a + radius of b + the
    step's separation; within one object, pairs that are nearer than rest_distance as
    registered, or that rest_rings edges or fewer join, have no thickness."""

    group: int  # of 64 bits: the groups that it is in; at first 1
    mask: int  # the groups that it may meet; at first all
    self_collision: bool
    radius: float  # 0 .. 1e18; at first 0: the radii of the mesh's vertices, if any
    rest_distance: float  # 0 .. 1e18; at first 0
    rest_rings: int  # 0 .. 8; at first 0
    user_data: int = 0  # of 64 bits: what it means is the user's


class Histogram(NamedTuple):
    """How long steps or requests took since the daemon's start. counts[i] took less than
    below_ns[i] and are in no bucket before; the last one counts the rest (inf)."""

    total: int
    ns_sum: int
    below_ns: NDArray[np.float64]
    counts: NDArray[np.uint64]


@dataclasses.dataclass(frozen=True)
class StepSettings:
    """How a step is computed; all zeros are the defaults. Make one and use it often."""

    mode: Union[int, str] = Mode.ALL  # a name, too: "first", as all enumerators have
    method: Union[int, str] = Method.DEFAULT
    threads: int = 0  # at most; 0 = the daemon decides. The answer never depends on it
    tuning: str = ""  # how the threads share the work, such as "scheduler=paper" (pccd.h)
    tolerance: float = 0.0  # bounds toi_hi - toi from above, 1e-12 .. 1; 0 = 1e-6
    deadline_ns: int = 0  # after it the answer is incomplete; 0 = none
    hold: bool = False  # in a shared scene: move with the next step of another client,
    # which it is answered with, without records (scene_read has them); or at its
    # deadline, or cancelled: then it goes along nevertheless
    separation: float = 0.0  # added to the radii of every pair, 0 .. 1e18
    approach: float = 0.0  # of pairs that begin within their distance: 0: they meet at
    # t = 0; above 0 and below 1: at this part of the distance that they begin with
    tells_start: bool = False  # say how it begins, too: Answer.crossings, start_inside
    touching: Union[int, str] = Touching.KEPT  # what touches at t = 0: "told": whether it
    # enters, slides or leaves; "left-out": what does not enter is no contact then
    resolution: float = 0.0  # of bodies that turn: what comes within so much more than
    # the distance at which it meets may be possible; 0 = 2^-20 of the size of the two

    _as_parameter_: ClassVar[Any]  # the struct, for ctypes
    _struct: ClassVar[Any]

    def __post_init__(self) -> None:
        made = with_size(abi.pccd_step_settings())
        for name, kind in (("mode", Mode), ("method", Method), ("touching", Touching)):
            number = enumerator(kind, name, getattr(self, name))
            object.__setattr__(self, name, number)
        for name, given in vars(self).items():
            put(made, name, given)
        object.__setattr__(self, "_struct", made)
        object.__setattr__(self, "_as_parameter_", ctypes.byref(made))

    def __reduce__(self) -> Any:
        return StepSettings, dataclasses.astuple(self)


def object_settings(attributes: Dict[str, Any]) -> abi.pccd_object_settings:
    """Those of ObjectSettings that are given and not None, for the library."""
    made: abi.pccd_object_settings = with_size(abi.pccd_object_settings())
    for name, value in attributes.items():
        if name not in ObjectSettings._fields:
            raise TypeError(f"an object has no attribute {name}")
        if value is None:
            continue
        put(made, name, value)
        made.what |= 1 << ObjectSettings._fields.index(name)
    return made


def near_settings(what: Union[int, str] = NearWhat.PAIRS,
                  distance: Optional[float] = None, at_begin: bool = False,
                  gap: float = 0.0, object_a: int = 0, object_b: int = 0,
                  method: Union[int, str] = Method.DEFAULT, threads: int = 0,
                  tuning: str = "", deadline_ns: int = 0,
                  tells_crossings: bool = False) -> abi.pccd_near_settings:
    """What is asked about what is near (Client.submit_near), for the library."""
    made: abi.pccd_near_settings = with_size(abi.pccd_near_settings())
    what = enumerator(NearWhat, "what", what)
    if distance is None and what == NearWhat.VERTICES:
        raise refusal(Status.E_INVAL, "what is VERTICES, whose bounds end at a distance, "
                      "and there is none")
    if distance is None:
        distance = math.inf if what == NearWhat.NEAREST else 0.0
    for name, given in (("what", what), ("distance", distance), ("at_begin", at_begin),
                        ("gap", gap), ("object_a", object_a), ("object_b", object_b),
                        ("method", enumerator(Method, "method", method)),
                        ("threads", threads), ("tuning", tuning),
                        ("deadline_ns", deadline_ns),
                        ("tells_crossings", tells_crossings)):
        put(made, name, given)
    return made


# ---- arguments -----------------------------------------------------------------------

def refusal(status: Status, text: str) -> PccdError:
    """What is wrong before the library is asked."""
    return PccdError(status, text)


def with_size(struct: Any) -> Any:
    """Say how large a struct is, where it wants to know."""
    if hasattr(struct, "struct_bytes"):
        struct.struct_bytes = ctypes.sizeof(struct)
    return struct


def put(struct: Any, name: str, value: Any) -> None:
    """Set a member, which has to hold the value as it is; ctypes would cut it off in
    silence."""
    now = getattr(struct, name)
    try:
        if now is None or isinstance(now, (bytes, str)):
            made: Any = value.encode()
        elif isinstance(now, bool):
            made = truth(name, value)
        elif isinstance(now, int):
            made = int(value) if value == int(value) else value
        else:
            made = value
        setattr(struct, name, made)
        is_kept = getattr(struct, name) == made
    except (AttributeError, TypeError, ValueError, OverflowError):
        is_kept = False
    if not is_kept:
        raise refusal(Status.E_INVAL, f"{name} is {value!r}")


def truth(name: str, value: Any) -> bool:
    """True or False; to Python any text is true."""
    if value not in (False, True):
        raise refusal(Status.E_INVAL, f"{name} is {value!r}, not True or False")
    return bool(value)


def enumerator(kind: Any, name: str, value: Any) -> int:
    """One of an enum: itself, its name or its number, of which a daemon may know more."""
    names = kind.__members__
    if isinstance(value, str):
        value = names.get(value.upper().replace("-", "_"), value)
    if isinstance(value, (str, enum.Enum)) and not isinstance(value, kind):
        raise refusal(Status.E_INVAL, f"{name} is {value!r}, not one of "
                      f"{', '.join(names).lower().replace('_', '-')}")
    return u32(name, value)


def u32(name: str, value: Any) -> int:
    """A handle or a count, of numpy's too."""
    try:
        number = value.__index__()
    except (AttributeError, TypeError):
        raise refusal(Status.E_INVAL, f"{name} is {value!r}, not an integer") from None
    if not 0 <= number < 1 << 32:
        raise refusal(Status.E_INVAL, f"{name} is {number}, not of 32 bits")
    return int(number)


def milliseconds(name: str, seconds: float) -> int:
    """As the library takes a time for which 0 is the default: -1 is none."""
    if not 0 <= seconds < math.inf:
        raise refusal(Status.E_INVAL, f"{name} is {seconds} seconds")
    return math.ceil(1000 * seconds) or -1


def real_numbers(name: str, given: ArrayLike) -> NDArray[Any]:
    """An array of real numbers that are doubles, of whatever type: numpy would make some
    of texts, dates and complex numbers, too, and of what is masked; and round the others,
    as integers beyond 2^53, long doubles and fractions may be."""
    try:
        made = np.asarray(given)
        is_wide = made.dtype.kind in "iuO" or \
            made.dtype.kind == "f" and made.dtype.itemsize > 8
        with np.errstate(over="ignore"):
            doubles = made.astype(np.float64) if is_wide else made
    except (ValueError, TypeError, OverflowError) as why:
        raise refusal(Status.E_INVAL, f"{name}: {why}") from None
    refuse_masked(name, given)
    if made.dtype.kind not in "fiuO":
        raise refusal(Status.E_INVAL, f"{name} are {made.dtype}, not real numbers")
    rest: Any = ()  # those that may be no doubles; numpy compares integers as doubles
    if is_wide:
        rest = made[np.abs(doubles) >= 2.0 ** 53].tolist() if made.dtype.kind in "iu" \
            else made[made != doubles]
    for value in rest:
        if value == value and value != float(value):
            raise refusal(Status.E_INVAL, f"{name}, {made.dtype}, have {value}, which is "
                          "no double: round it yourself")
    return made


def refuse_masked(name: str, given: Any) -> None:
    """What is masked has numbers behind the mask, which nobody means."""
    if isinstance(given, np.ma.MaskedArray) and bool(np.any(getattr(given, "mask"))):
        raise refusal(Status.E_INVAL, f"{name} has values that are masked")


def pack_vertices(name: str, x: ArrayLike) -> NDArray[Any]:
    """(n, 3) float32 or float64, packed; anything else becomes float64."""
    made = real_numbers(name, x)
    dtype = np.float32 if made.dtype == np.float32 else np.float64
    made = np.ascontiguousarray(made, dtype)
    if made.ndim != 2 or made.shape[1] != 3 or len(made) == 0:
        raise refusal(Status.E_INVAL, f"{name} has the shape {made.shape}, not (n, 3)")
    return made


def pack_indices(name: str, indices: ArrayLike, points: int) -> NDArray[np.uint32]:
    """Triangles (points 3), edges (2) or points (1) as the library takes them."""
    refuse_masked(name, indices)
    made = np.asarray(indices)
    shape = made.shape[1:] if points > 1 else (1,) * made.ndim
    if shape != (points,) or len(made) == 0 or made.dtype.kind not in "iu":
        raise refusal(Status.E_INVAL, f"{name} are {made.dtype} {made.shape}, not "
                      f"integers {f'(m, {points})' if points > 1 else '(m,)'}")
    if made.dtype != np.uint32 and (made.min() < 0 or made.max() > 0xFFFFFFFF):
        raise refusal(Status.E_INDEX, "a vertex index is negative or beyond 32 bits")
    return np.ascontiguousarray(made, np.uint32)


def format_of(dtype: DTypeLike) -> int:
    wanted = np.dtype(dtype)
    if wanted == np.float32:
        return int(Format.F32)
    if wanted == np.float64:
        return int(Format.F64)
    raise refusal(Status.E_INVAL, f"coordinates are float32 or float64, not {wanted}")
