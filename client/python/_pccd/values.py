"""values.py - errors, settings, and what the daemon says of meshes and steps.

Room:     client/python. May import: wire, numpy.
Does:     the small types of the public interface; arrays as the wire wants them.
"""

from __future__ import annotations

import dataclasses
import os
from typing import Any, Dict, NamedTuple, Optional

import numpy as np
from numpy.typing import ArrayLike, DTypeLike, NDArray

from .wire import Format, HighLevel, Method, Mode, Refit, Scheduler, Status

SOCKET_BYTES = 107  # of a socket's path


class PccdError(Exception):
    """A request or a step failed.

    status  enum Status (an int that it does not know, from a newer daemon)
    name    "E_BUSY"
    text    what was wrong, with names and numbers
    """

    def __init__(self, status: int, name: str, text: str) -> None:
        super().__init__(f"{name}: {text}")
        known = status in Status.__members__.values()
        self.status: int = Status(status) if known else status
        self.name = name
        self.text = text


def failure(status: Status, text: str) -> PccdError:
    return PccdError(status, status.name, text)


class MeshInfo(NamedTuple):
    """What the daemon says of a mesh when it is committed."""

    vertex_count: int
    triangle_count: int
    edge_count: int
    duplicate_count: int  # triangles whose vertex set occurred before
    degenerate_count: int  # triangles of zero area as registered
    isolated_count: int  # vertices in no triangle; they are not tested
    generation: int  # 1, and one more with each mesh_replace
    build_ns: int


class StepTimes(NamedTuple):
    """Nanoseconds of a step's phases. rebuild is the sum over all threads."""

    queue: int
    ingest: int
    refit: int
    traversal: int
    tests: int
    merge: int
    step: int
    low: int
    high: int
    rebuild: int


class StepCounters(NamedTuple):
    """What a step did: see struct pccd_step_counters in pccd.h."""

    task_units: int
    box_tests: int
    leaf_pairs: int
    candidates_vf: int
    candidates_ee: int
    survivors: int
    exact: int
    builds: int
    allocs: int
    rebuilds: int
    rebuilt_triangles: int
    swaps: int
    swapped_triangles: int


@dataclasses.dataclass(frozen=True)
class StepSettings:
    """How a step is computed; all zeros are the defaults."""

    mode: int = Mode.ALL
    method: int = Method.DEFAULT
    threads: int = 0  # at most; 0 = the daemon decides. The answer never depends on it
    scheduler: int = Scheduler.DEFAULT
    high_level: int = HighLevel.DEFAULT
    refit: int = Refit.DEFAULT
    tolerance: float = 0.0  # bounds toi_hi - toi from above, 1e-12 .. 1; 0 = 1e-6
    deadline_ns: int = 0  # after it the answer is incomplete; 0 = none
    hold: bool = False  # in a shared scene: move with the next step of another client,
    # which it is answered with, without records (scene_read has them); or at its
    # deadline, or cancelled: then it goes along nevertheless

    def params(self) -> Dict[str, Any]:
        """The fields that are not 0, as frame.submit takes them."""
        return {name: value for name, value in vars(self).items() if value}


@dataclasses.dataclass(frozen=True)
class Options:
    """What connect() was asked for; it says what each is."""

    timeout: float
    reconnect: float
    keep: bool
    daemons_max: int
    name: str
    daemon: Optional[str]
    autostart: bool
    slot_count: int
    slot_bytes: int
    result_bytes: int


@dataclasses.dataclass
class LinkInfo:
    """What became of lost connections."""

    reconnects: int = 0  # connections made after one was lost
    resumed: int = 0  # of these, to the same session; the others were told anew
    resent: int = 0  # requests that were sent again
    gap_ns: int = 0  # the last time: from the loss to the end of all that
    restore_ns: int = 0  # of it, telling a new daemon anew


def plain_number(value: Any) -> Any:
    """Numbers of numpy, such as handles out of records, for msgpack."""
    if isinstance(value, np.generic):
        return value.item()
    raise TypeError(f"{type(value).__name__} does not go into a message")


def pack_vertices(name: str, x: ArrayLike) -> NDArray[Any]:
    """(n, 3) float32 or float64, packed; anything else becomes float64."""
    made = np.asarray(x)
    dtype = np.float32 if made.dtype == np.float32 else np.float64
    made = np.ascontiguousarray(made, dtype)
    if made.ndim != 2 or made.shape[1] != 3 or len(made) == 0:
        raise failure(Status.E_INVAL, f"{name} has the shape {made.shape}, not (n, 3)")
    return made


def pack_triangles(triangles: ArrayLike) -> NDArray[np.uint32]:
    made = np.asarray(triangles)
    if made.ndim != 2 or made.shape[1] != 3 or len(made) == 0 or \
            made.dtype.kind not in "iu":
        raise failure(Status.E_INVAL, f"triangles are {made.dtype} {made.shape}, not "
                      "integers (m, 3)")
    if made.min() < 0 or made.max() > 0xFFFFFFFF:
        raise failure(Status.E_INDEX, "a vertex index is negative or beyond 32 bits")
    return np.ascontiguousarray(made, np.uint32)


def format_of(dtype: DTypeLike) -> Format:
    wanted = np.dtype(dtype)
    if wanted == np.float32:
        return Format.F32
    if wanted == np.float64:
        return Format.F64
    raise failure(Status.E_INVAL, f"coordinates are float32 or float64, not {wanted}")


def default_socket_path() -> str:
    """The user's own socket, below $XDG_RUNTIME_DIR or else in /tmp."""
    runtime = os.environ.get("XDG_RUNTIME_DIR", "")
    folder = f"{runtime}/pccd" if runtime.startswith("/") else f"/tmp/pccd-{os.getuid()}"
    path = f"{folder}/pccd.sock"
    if len(os.fsencode(path)) > SOCKET_BYTES:
        raise failure(Status.E_LIMIT,
                      "$XDG_RUNTIME_DIR is too long for a socket's path")
    return path
