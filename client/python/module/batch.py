"""batch.py - steps of many scenes by one request: for many small worlds.

Room:     client/python. May import: abi, answer, frame, library, values, numpy.
Does:     arrays in the slot itself, for the positions of all scenes at once; answers as
          one array, where the daemon wrote it.
"""

from __future__ import annotations

import ctypes
import sys
from ctypes import byref
from dataclasses import dataclass, replace
from typing import Any, Dict, Iterable, List, Optional, Sequence, Tuple, Union

import numpy as np
from numpy.typing import ArrayLike, DTypeLike, NDArray

from . import abi
from .abi import BatchWay, Mode, Status
from .answer import Held
from .frame import DEFAULT
from .library import PccdError, lib, one_thread_at_a_time, quick
from .turning import JOINT, joints_of
from .values import (CONTACT, PAIR, StepSettings, enumerator, format_of, real_numbers,
                     refusal, u32)

SCENE = np.dtype(abi.pccd_scene_answer)
_ANSWER_BYTES = ctypes.sizeof(abi.pccd_batch_answer)
_scenes: Any = abi.pccd_batch_answer.scenes


@dataclass(frozen=True)
class Part:
    """What moves in a scene: `count` vertices of an object, from `first` on, to positions
    of a dtype, float32 or float64; None: that of the vertices of its mesh, as they were
    given. object = 0: nothing moves in the scene."""

    scene: int
    object: int = 0
    count: int = 0
    first: int = 0
    dtype: Optional[DTypeLike] = None
    way: Union[int, str] = BatchWay.X1

    def __post_init__(self) -> None:
        object.__setattr__(self, "way", enumerator(BatchWay, "way", self.way))


class BatchAnswer(abi.pccd_batch_answer, Held):
    """What came of all scenes of a batch. As a context manager it releases itself.

    step        number of the first scene's step; scene i has step + i, also for fetch()
    error       None, or why no scene was stepped
    scenes      (count,) of SCENE: status, total, toi_first, hash and so on of each scene,
                read-only, in the daemon's memory, and meaningless after release()
    failed, incomplete    how many scenes are
    total       records of all scenes
    queue_ns, batch_ns, steps_ns    until its turn; from there; sum of the scenes' steps
    """

    error: Optional[PccdError] = None

    def _base(self) -> Any:
        """The begin of the region in which the records of scenes lie, too."""
        address = _scenes.__get__(self)
        return address and address - self.offset

    @property
    def scenes(self) -> NDArray[Any]:
        """An answer for each scene. E_STATE: they are released."""
        self._refuse_released()
        return np.empty(0, SCENE) if self._span is None else \
            self._span.array(SCENE, self.count, self.offset)

    def why(self, scene: int) -> str:
        """Why a scene failed; "": it did not."""
        return bytes(self.scenes[scene]["why"]).split(b"\0")[0].decode(errors="replace")

    def _records(self, dtype: Any, scene: int) -> NDArray[Any]:
        self._refuse_released()
        if self._span is None or (dtype is PAIR) != (self.mode == Mode.PAIRS):
            return np.empty(0, dtype)
        one = self.scenes[scene]
        return self._span.array(dtype, int(one["count"]), int(one["offset"]))

    def contacts(self, scene: int) -> NDArray[Any]:
        """The records of a scene that came with the answer: (scenes[i]["count"],) of
        CONTACT. Client.fetch has the others."""
        return self._records(CONTACT, scene)

    def pairs(self, scene: int) -> NDArray[Any]:
        """The same of mode PAIRS, of PAIR."""
        return self._records(PAIR, scene)

    def release(self) -> None:
        """Give the answers and their records back. Copy before what is to stay."""
        self._is_released = True
        if self._span is not None:
            self._go()

    def _give_back(self, handle: Any) -> None:
        quick.pccd_batch_release(handle, byref(self))

    def __del__(self) -> None:
        if self._span is not None:
            self._forget(sys.getrefcount(self._span) > 2)

    def __enter__(self) -> BatchAnswer:
        return self

    def __exit__(self, *_: object) -> None:
        self.release()

    def __repr__(self) -> str:
        if self.error is not None:
            return f"<BatchAnswer {self.step}: {self.error}>"
        what = "pairs" if self.mode == Mode.PAIRS else "contacts"
        return (f"<BatchAnswer {self.step}: {self.count} scenes, {self.failed} failed, "
                f"{self.total} {what}>")


class _Gone:
    """A batch that nobody has any more."""

    def __init__(self, handle: Any) -> None:
        self._handle = handle

    def _give_back(self, _client: Any) -> None:
        lib.pccd_batch_destroy(self._handle)


@one_thread_at_a_time
class Batch:
    """Scenes that are stepped together; made by Client.batch().

        batch = client.batch([pccd.Part(scene, body, n) for scene, body in worlds])
        x1 = np.zeros((len(worlds), n, 3), np.float32)
        ...
        with batch.step(x1) as answer:
            reward = -answer.scenes["total"]

    The parts of one scene stand one behind the other. joint_counts[i]: how many joints
    the table of scene i has, on which parts of way TURNING hang: `first` is the joint,
    and what they move to is the table, (joint_counts[i],) of JOINT, the same one for all
    such parts of the scene.
    """

    def __init__(self, client: Any, parts: Iterable[Union[Part, Sequence[Any]]],
                 joint_counts: Sequence[int] = ()) -> None:
        self._client = client
        self._turn = client._turn
        given = (part if isinstance(part, Part) else Part(*part) for part in parts)
        self._parts = [part if part.dtype is not None else replace(
            part, dtype=client._dtype_of(part.scene, part.object)) for part in given]
        self._handle = ctypes.c_void_p()
        structs = (abi.pccd_batch_part * max(1, len(self._parts)))()
        for struct, part in zip(structs, self._parts):
            struct.scene, struct.object = u32("scene", part.scene), u32("object",
                                                                        part.object)
            struct.first, struct.count = u32("first", part.first), u32("count",
                                                                       part.count)
            struct.format, struct.way = format_of(part.dtype), part.way
        if len(joint_counts):
            counts = (ctypes.c_uint32 * len(joint_counts))(
                *(u32("joint_counts", count) for count in joint_counts))
            client._check(lib.pccd_batch_create_turning(
                client._handle, structs, len(self._parts), counts, len(joint_counts),
                byref(self._handle)))
        else:
            client._check(lib.pccd_batch_create(client._handle, structs,
                                                len(self._parts), byref(self._handle)))
        self._joint_counts = joint_counts
        self._x0 = (ctypes.c_void_p * len(self._parts))()
        self._x1 = (ctypes.c_void_p * len(self._parts))()
        first = self._parts[0]
        self._is_even = first.object != 0 and all(
            (part.count, np.dtype(part.dtype), part.way, bool(part.object)) ==
            (first.count, np.dtype(first.dtype), BatchWay.X1, True)
            for part in self._parts)
        self._views: List[NDArray[Any]] = []

    def __len__(self) -> int:
        """How many scenes there are; answers have as many entries."""
        return int(quick.pccd_batch_scenes(self._handle))

    def _table(self, address: int, scene: int) -> NDArray[Any]:
        span = self._client._memory.span(address)
        flat: NDArray[Any] = span.array(JOINT, self._joint_counts[scene], writable=True)
        return flat

    def _view(self, address: int, part: Part) -> NDArray[Any]:
        is_rigid = part.way == BatchWay.RIGID
        shape = (3, 4) if is_rigid else (part.count, 3)
        flat: NDArray[Any] = self._client._memory.span(address).array(
            np.float64 if is_rigid else part.dtype, shape[0] * shape[1], writable=True)
        return flat.reshape(shape)

    def _all(self) -> NDArray[Any]:
        """Of parts that are alike: one array (parts, count, 3) over all of them."""
        part, base = self._parts[0], self._x1[0] or 0
        itemsize = np.dtype(part.dtype).itemsize
        apart = 3 * part.count * itemsize
        if len(self._parts) > 1:
            apart = (self._x1[1] or 0) - base
        flat = self._client._memory.span(base).array(
            part.dtype, apart * len(self._parts) // itemsize, writable=True)
        return np.lib.stride_tricks.as_strided(flat, (len(self._parts), part.count, 3),
                                               (apart, 3 * itemsize, itemsize))

    def begin(self) -> Union[NDArray[Any], List[Any]]:
        """Take a slot, and get where to write end positions, before commit(): one array
        (parts, count, 3) where all parts are alike, of way X1; else a list with an array
        (count, 3) a part, or two of them, start and end, or two transforms (3, 4), or the
        table of its scene, the same memory for all its parts that turn, or None of a part
        that stands still. Never read them."""
        self._check_open()
        self._client._settle()
        self._client._check(lib.pccd_batch_begin(self._handle, self._x0, self._x1))
        if self._is_even:
            self._views = [self._all()]
            return self._views[0]
        ends: List[Any] = []
        scene, last = -1, None
        for part, x0, x1 in zip(self._parts, self._x0, self._x1):
            scene, last = scene + (part.scene != last), part.scene
            views = [self._table(address, scene) if part.way == BatchWay.TURNING else
                     self._view(address, part) for address in (x0, x1) if address]
            self._views += views
            ends.append(None if not views else views[0] if len(views) == 1 else
                        tuple(views))
        return ends

    def _check_open(self) -> None:
        self._client._check_open()
        if not self._handle:
            raise refusal(Status.E_STATE, "the batch is closed")

    def _forget(self) -> None:
        for view in self._views:
            view.flags.writeable = False
        self._views = []

    def commit(self, settings: StepSettings = DEFAULT) -> int:
        """Submit what was written: the number of the first scene's step. The arrays
        cannot be written any more."""
        self._check_open()
        self._forget()
        step = ctypes.c_uint64()
        self._client._check(lib.pccd_batch_commit(self._handle, settings._as_parameter_,
                                                  byref(step)))
        return step.value

    def abort(self) -> None:
        """Give the slot back unsent."""
        self._forget()
        quick.pccd_batch_abort(self._handle)

    def _write(self, places: Any, x: Any) -> None:
        if isinstance(places, np.ndarray):
            self._copy("x1", places, x)
            return
        if len(x) != len(places):
            raise refusal(Status.E_INVAL, f"{len(x)} arrays for {len(places)} parts")
        tables: Dict[int, Tuple[int, Any]] = {}  # of scenes: the part that brought it
        for i, (place, given) in enumerate(zip(places, x)):
            if isinstance(place, tuple):
                if len(given) != len(place):
                    raise refusal(Status.E_INVAL,
                                  f"part {i}: {len(given)} arrays, not start and end")
                for end, values in zip(place, given):
                    self._copy(f"part {i}", end, values)
            elif place is not None and place.dtype != JOINT:
                self._copy(f"part {i}", place, given)
            elif place is not None:
                part, table = tables.setdefault(place.ctypes.data, (i, given))
                if part == i:
                    self._copy(f"part {i}", place, joints_of(f"part {i}", given))
                elif table is not given and joints_of(f"part {i}", given).tobytes() != \
                        np.asarray(table).tobytes():
                    raise refusal(Status.E_INVAL, f"part {i}: its table of joints "
                                  f"differs from that of part {part}; a scene has one "
                                  "table")

    @staticmethod
    def _copy(name: str, place: NDArray[Any], given: Any) -> None:
        """Of the same shape: numpy would spread one vertex over all."""
        array = given if place.dtype == JOINT else real_numbers(name, given)
        if array.shape != place.shape:
            raise refusal(Status.E_INVAL,
                          f"{name} has the shape {array.shape}, not {place.shape}")
        with np.errstate(over="ignore"):
            made = array.astype(place.dtype, copy=False)
        if made is not array and np.any((made != array) & (array == array)):
            raise refusal(Status.E_INVAL, f"{name}: {array.dtype} would be rounded to "
                          f"{place.dtype}; give the Part its dtype, or round it yourself")
        place[...] = made

    def submit(self, x1: Union[ArrayLike, Sequence[Any]],
               settings: StepSettings = DEFAULT) -> int:
        """Copy positions, shaped as begin() says, and submit them; the number of the
        first scene's step."""
        places = self.begin()
        try:
            self._write(places, x1)
        except BaseException:
            self.abort()
            raise
        return self.commit(settings)

    def step(self, x1: Union[ArrayLike, Sequence[Any]],
             settings: StepSettings = DEFAULT) -> BatchAnswer:
        """submit() and Client.batch_wait() in one."""
        step = self.submit(x1, settings)
        try:
            answer: BatchAnswer = self._client.batch_wait(step)
        except BaseException:
            lib.pccd_abandon(self._client._handle, step)
            raise
        return answer

    def close(self) -> None:
        """Forget the batch, not its scenes; the client does it, too."""
        self._forget()
        handle, self._handle = self._handle, ctypes.c_void_p()
        lib.pccd_batch_destroy(handle)

    def __del__(self) -> None:
        handle = getattr(self, "_handle", None)
        if handle and self._client._handle:  # any thread may get here: as of answers
            self._client._dropped.append(_Gone(handle))
        elif handle:
            lib.pccd_batch_destroy(handle)


def new_answer() -> BatchAnswer:
    """Room for one."""
    return BatchAnswer(_ANSWER_BYTES)
