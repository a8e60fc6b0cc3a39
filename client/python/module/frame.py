"""frame.py - what moves in a step: a frame that is written, or arrays that are read.

Room:     client/python. May import: abi, library, values, numpy.
Does:     hand out arrays in the slot itself; keep addresses of arrays for many steps.
"""

from __future__ import annotations

import ctypes
from ctypes import byref
from typing import Any, List, Optional, Tuple

import numpy as np
from numpy.typing import ArrayLike, DTypeLike, NDArray

from . import abi
from .abi import Status
from .library import lib, one_thread_at_a_time, quick
from .turning import table_of
from .values import (StepSettings, format_of, near_settings, real_numbers, refusal,
                     u32)

DEFAULT = StepSettings()


@one_thread_at_a_time
class Frame:
    """A slot of the upload ring that is being written. As a context manager it is given
    back at the end unless it was committed."""

    def __init__(self, client: Any, struct: abi.pccd_frame) -> None:
        self._client = client
        self._turn = client._turn
        self._struct = struct
        self._views: List[NDArray[Any]] = []

    def _array(self, address: ctypes.c_void_p, count: int,
               dtype: DTypeLike) -> NDArray[Any]:
        span = self._client._memory.span(address.value)
        view: NDArray[Any] = span.array(dtype, 3 * count, writable=True).reshape(count, 3)
        self._views.append(view)
        return view

    def _place(self, call: Any, object: int, count: int, first: int,
               dtype: Optional[DTypeLike], places: int) -> List[NDArray[Any]]:
        self._client._check_open()
        if dtype is None:
            dtype = self._client._dtype_of(self._struct.scene, object)
        count = u32("count", count)
        if count < 1:
            raise refusal(Status.E_INVAL, f"a segment of {count} vertices")
        addresses = [ctypes.c_void_p() for _ in range(places)]
        status = call(byref(self._struct), u32("object", object), format_of(dtype),
                      u32("first", first), count, *map(byref, addresses))
        if status:
            raise self._client._failure(status)
        return [self._array(address, count, dtype) for address in addresses]

    def x1(self, object: int, count: int, first: int = 0,
           dtype: Optional[DTypeLike] = None) -> NDArray[Any]:
        """An array (count, 3) to write end positions to, before commit(). The start is
        the last step's end. dtype: float32 or float64; None: as the vertices of its mesh
        were given, so that numpy rounds nothing that they have. Never read it. E_LIMIT:
        more than was announced."""
        return self._place(quick.pccd_frame_x1, object, count, first, dtype, 1)[0]

    def x0x1(self, object: int, count: int, first: int = 0,
             dtype: Optional[DTypeLike] = None) -> Tuple[NDArray[Any], NDArray[Any]]:
        """The same for start and end positions: two arrays."""
        x0, x1 = self._place(quick.pccd_frame_x0x1, object, count, first, dtype, 2)
        return x0, x1

    def rigid(self, object: int, count: int, m0: ArrayLike, m1: ArrayLike,
              first: int = 0) -> None:
        """Transforms (3, 4) for both ends, rows of [R | t], of registered positions. In
        between, vertices go straight: a turn needs several steps (pccd(7), MOTION)."""
        self._client._check_open()
        ends = [np.ascontiguousarray(real_numbers(name, m), np.float64)
                for name, m in (("m0", m0), ("m1", m1))]
        for name, m in zip(("m0", "m1"), ends):
            if m.shape != (3, 4):
                raise refusal(Status.E_INVAL,
                              f"{name} has the shape {m.shape}, not (3, 4)")
            if not np.isfinite(m).all():
                raise refusal(Status.E_NOTFINITE,
                              f"{name} has a number that is not finite")
        status = quick.pccd_frame_rigid(byref(self._struct), u32("object", object),
                                        u32("first", first), u32("count", count),
                                        ends[0].ctypes.data, ends[1].ctypes.data)
        if status:
            raise self._client._failure(status)

    def joints(self, table: NDArray[Any]) -> None:
        """Copy a table of joints (JOINT) into the frame, once, before what hangs on it:
        8 + 136 * len(table) bytes. E_STATE: there is one."""
        self._client._check_open()
        status = quick.pccd_frame_joints(byref(self._struct), table_of(table).ctypes.data,
                                         len(table))
        if status:
            raise self._client._failure(status)

    def turning(self, object: int, count: int, joint: int) -> None:
        """All `count` vertices of an object hang on a joint of the table: they are as
        registered in the frame of its link, and go along the curve that it says."""
        self._client._check_open()
        status = quick.pccd_frame_turning(byref(self._struct), u32("object", object),
                                          u32("joint", joint), u32("count", count))
        if status:
            raise self._client._failure(status)

    def commit(self, settings: StepSettings = DEFAULT) -> int:
        """Publish and submit; the number of the step. The arrays cannot be written any
        more, and the slot belongs to the daemon, also on failure."""
        return self._send(lib.pccd_frame_commit, settings._as_parameter_)

    def _send(self, call: Any, settings: Any) -> int:
        self._client._check_open()
        for view in self._views:
            view.flags.writeable = False
        self._views.clear()
        step = ctypes.c_uint64()
        status = call(byref(self._struct), settings, byref(step))
        if status:
            raise self._client._failure(status)
        return step.value

    def commit_near(self, **settings: Any) -> int:
        """Publish, and ask what is near where it leads to: `what`, `distance` and so on
        as of Client.submit_near; the number of the question. The arrays cannot be written
        any more, and the slot belongs to the daemon, also on failure."""
        return self._send(lib.pccd_frame_commit_near, byref(near_settings(**settings)))

    def abort(self) -> None:
        """Give the slot back unsent."""
        if self._client._handle:
            quick.pccd_frame_abort(byref(self._struct))

    def __enter__(self) -> Frame:
        return self

    def __exit__(self, *_: object) -> None:
        self.abort()


class Motions:
    """What moves in a step: any number of objects, in one call. It is made once and used
    for many steps: each step reads the arrays that were given here, as they are then.

        poses = np.zeros((2, len(bodies), 3, 4))
        moves = pccd.Motions()
        for k, body in enumerate(bodies):
            moves.rigid(body, vertex_count, poses[0, k], poses[1, k])
        ...
        poses[:] = ...
        with client.step(scene, moves) as answer:
    """

    def __init__(self) -> None:
        self._count = 0
        self._structs = (abi.pccd_motion * 8)()
        self._arrays: List[NDArray[Any]] = []  # so that they stay
        self._joints: Optional[NDArray[Any]] = None

    def __len__(self) -> int:
        return self._count

    def _add(self, object: int, first: int, count: int, format: int,
             **arrays: NDArray[Any]) -> None:
        handle, start = u32("object", object), u32("first", first)
        if self._count == len(self._structs):
            larger = (abi.pccd_motion * (2 * self._count))()
            ctypes.memmove(larger, self._structs, ctypes.sizeof(self._structs))
            self._structs = larger
        motion = self._structs[self._count]
        motion.object, motion.first, motion.count = handle, start, u32("count", count)
        motion.format = format
        for name, array in arrays.items():
            setattr(motion, name, array.ctypes.data)
        self._arrays += arrays.values()
        self._count += 1

    @staticmethod
    def _check(name: str, x: Any, shape: Tuple[int, ...]) -> NDArray[Any]:
        if not isinstance(x, np.ndarray) or not x.flags.c_contiguous or \
                isinstance(x, np.ma.MaskedArray) or \
                x.shape[1:] != shape[1:] or x.size == 0 or \
                len(shape) == 2 and x.ndim != 2 or shape[0] not in (-1, len(x)):
            raise refusal(Status.E_INVAL, f"{name}: each step reads the array itself, so "
                          f"it must be C-contiguous, of the shape {shape}, and without "
                          "a mask")
        return x

    def x1(self, object: int, x1: NDArray[Any], first: int = 0) -> None:
        """Vertices first .. of an object go to x1 (n, 3), of float32 or float64, from
        where the last step ended."""
        self._check("x1", x1, (-1, 3))
        self._add(object, first, len(x1), format_of(x1.dtype), x1=x1)

    def x0x1(self, object: int, x0: NDArray[Any], x1: NDArray[Any],
             first: int = 0) -> None:
        """The same from x0 to x1, of one shape and type."""
        self._check("x0", x0, (-1, 3))
        self._check("x1", x1, (-1, 3))
        if x0.shape != x1.shape or x0.dtype != x1.dtype:
            raise refusal(Status.E_INVAL, f"x0 is {x0.dtype} {x0.shape}, x1 {x1.dtype} "
                          f"{x1.shape}")
        self._add(object, first, len(x1), format_of(x1.dtype), x0=x0, x1=x1)

    def rigid(self, object: int, count: int, m0: NDArray[np.float64],
              m1: NDArray[np.float64], first: int = 0) -> None:
        """The same by transforms (3, 4) of float64 for both ends: see Frame.rigid."""
        for name, m in (("m0", m0), ("m1", m1)):
            if self._check(name, m, (3, 4)).dtype != np.float64:
                raise refusal(Status.E_INVAL, f"{name} is {m.dtype}, not float64")
        self._add(object, first, count, abi.Format.F64, m0=m0, m1=m1)

    def joints(self, table: NDArray[Any]) -> None:
        """The table of JOINT that `turning` speaks of; each step reads it as it is then:
        table["from"][:, 0] = table["to"][:, 0]; table["to"][:, 0] = q."""
        self._joints = table_of(table)

    def turning(self, object: int, count: int, joint: int) -> None:
        """All `count` vertices of an object hang on a joint of the table: see
        Frame.turning."""
        self._add(object, u32("joint", joint), count, abi.Format.F64)

    def _step_settings(self, settings: StepSettings) -> Any:
        """For the library, with the joints."""
        return settings._as_parameter_ if self._joints is None else \
            byref(self._with_joints(type(settings._struct).from_buffer_copy(
                settings._struct)))

    def _with_joints(self, struct: Any) -> Any:
        if self._joints is not None:
            struct.joints = self._joints.ctypes.data
            struct.joint_count = len(self._joints)
        return struct
