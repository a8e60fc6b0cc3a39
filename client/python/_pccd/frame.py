"""frame.py - a step being written into a slot.

Room:     client/python. May import: ring, wire, values, numpy.
Does:     lay out a slot's payload: the segment table at its start, then the positions,
          each range at a multiple of 8 bytes.
Does not: read anything back from the slot, or check what the daemon checks.
Source:   client/lib/frame.c.
"""

from __future__ import annotations

import struct
from typing import Any, Callable, List, Tuple

import numpy as np
from numpy.typing import ArrayLike, DTypeLike, NDArray

from .ring import Ring, Slot
from .values import StepSettings, format_of, failure
from .wire import RIGID, RIGID_BYTES, SEGMENT, X0X1, X1, Format, Status


#: What commits a frame: Client._commit; what gives its slot back: Client._abort.
Commit = Callable[[Ring, NDArray[np.uint8], Slot, StepSettings], int]
Abort = Callable[[Slot], None]


class Frame:
    """A slot of the upload ring that is being written. As a context manager it is given
    back at the end unless it was committed."""

    def __init__(self, ring: Ring, slot: Slot, segment_max: int, limit: int,
                 commit: Commit, abort: Abort) -> None:
        self._is_begun = True
        self._ring = ring
        self._slot = slot
        self._payload = ring.payload(slot)
        self._views: List[NDArray[Any]] = []
        self._segment_max = segment_max
        self._limit = limit
        self._commit = commit
        self._abort = abort

    def _check(self) -> None:
        if not self._is_begun:
            raise failure(Status.E_INVAL, "the frame is not begun")

    def _range(self, end: int, count: int, dtype: DTypeLike) -> NDArray[Any]:
        made = self._payload[end:end + count * 3 * np.dtype(dtype).itemsize]
        view = made.view(dtype).reshape(count, 3)
        self._views.append(view)
        return view

    def _add(self, kind: int, object: int, format: int, first: int, count: int,
             bytes0: int, bytes1: int) -> Tuple[int, int]:
        """Enter a segment whose ranges have so many bytes; where they begin."""
        self._check()
        slot = self._slot
        begin0 = slot.used
        begin1 = begin0 + (bytes0 + 7) // 8 * 8
        end = begin1 + (bytes1 + 7) // 8 * 8
        if count < 1:
            raise failure(Status.E_INVAL, f"a segment of {count} vertices")
        if len(slot.segments) >= self._segment_max:
            raise failure(Status.E_LIMIT,
                          f"more than the announced {self._segment_max} segments")
        if end > self._limit:
            raise failure(Status.E_LIMIT, f"segment {len(slot.segments)} ends at byte "
                          f"{end} of the announced {self._limit}")
        segment = (int(object), kind, int(format), int(first), int(count),
                   begin0 if bytes0 else 0, begin1)
        try:
            SEGMENT.pack_into(self._payload.data, len(slot.segments) * SEGMENT.size,
                              *segment)
        except struct.error as problem:
            raise failure(Status.E_INVAL, f"segment: {problem}") from None
        slot.segments.append(segment)
        slot.used = end
        return begin0, begin1

    def x1(self, object: int, count: int, first: int = 0,
           dtype: DTypeLike = np.float32) -> NDArray[Any]:
        """An array (count, 3) to write end positions to, before commit(). The start is
        the last step's end. Never read it. E_LIMIT: more than was announced."""
        format = format_of(dtype)
        size = count * 3 * np.dtype(dtype).itemsize
        _, begin1 = self._add(X1, object, format, first, count, 0, size)
        return self._range(begin1, count, dtype)

    def x0x1(self, object: int, count: int, first: int = 0,
             dtype: DTypeLike = np.float32) -> Tuple[NDArray[Any], NDArray[Any]]:
        """The same for start and end positions: two arrays."""
        format = format_of(dtype)
        size = count * 3 * np.dtype(dtype).itemsize
        begin0, begin1 = self._add(X0X1, object, format, first, count, size, size)
        return self._range(begin0, count, dtype), self._range(begin1, count, dtype)

    def rigid(self, object: int, count: int, m0: ArrayLike, m1: ArrayLike,
              first: int = 0) -> None:
        """Transforms (3, 4) for both ends, rows of [R | t], of registered positions. In
        between, vertices go straight: a turn needs several steps (pccd(7), MOTION)."""
        ends = [np.ascontiguousarray(m, np.float64).reshape(-1) for m in (m0, m1)]
        if ends[0].size != 12 or ends[1].size != 12:
            raise failure(Status.E_INVAL, "a transform has the shape (3, 4)")
        begins = self._add(RIGID, object, Format.F64, first, count, RIGID_BYTES,
                           RIGID_BYTES)
        for begin, m in zip(begins, ends):
            self._payload[begin:begin + RIGID_BYTES].view(np.float64)[:] = m

    def commit(self, settings: StepSettings = StepSettings()) -> int:
        """Publish and submit; the number of the step. The arrays cannot be written any
        more, and the slot belongs to the daemon, also on failure."""
        self._check()
        self._is_begun = False
        for view in self._views:
            view.flags.writeable = False
        return self._commit(self._ring, self._payload, self._slot, settings)

    def abort(self) -> None:
        """Give the slot back unsent."""
        if self._is_begun:
            self._is_begun = False
            self._abort(self._slot)

    def __enter__(self) -> Frame:
        return self

    def __exit__(self, *_: object) -> None:
        self.abort()
