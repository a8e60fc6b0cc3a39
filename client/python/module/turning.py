"""turning.py - bodies that turn: tables of joints, as arrays.

Room:     client/python. May import: abi, library, numpy, values.
Does:     call what pccd_turning.h makes joints by, and say what an array of joints is.

A table of joints is an array of JOINT, whose fields are those of struct pccd_joint in
pccd_types.h: table["from"][:, 0] = q0 sets where all values begin. Objects hang on its
joints by Motions.turning or Frame.turning.
"""

from __future__ import annotations

import ctypes
from typing import Any, Optional, Tuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import abi
from .abi import Status
from .library import failure, lib
from .values import real_numbers, refusal, u32

JOINT = np.dtype(abi.pccd_joint)
NO_JOINT = 0xFFFFFFFF  # the world, as a parent
MOST = 3  # that one call adds

Pose = Tuple[ArrayLike, ArrayLike]  # position (3,), quaternion x y z w (4,)


def joints_screw(centre: ArrayLike, axis: ArrayLike, angle: float, shift: float = 0.0,
                 joints: Optional[NDArray[Any]] = None,
                 parent: int = NO_JOINT) -> NDArray[Any]:
    """`joints` and a turn by `angle` (radians, right-handed, of any number of turns)
    about the axis through `centre`, and by `shift` along it meanwhile. A body hangs on
    the last joint of what is returned: len(...) - 1. E_INVAL: an axis of no length, a
    parent that is not in the table, numbers that are not finite or too large."""
    return _add(lib.pccd_joints_screw, joints, parent, _numbers("centre", centre, 3),
                _numbers("axis", axis, 3), float(angle), float(shift))


def joints_poses(begin: Pose, end: Pose, turns: int = 0,
                 axis: Optional[ArrayLike] = None,
                 joints: Optional[NDArray[Any]] = None,
                 parent: int = NO_JOINT) -> NDArray[Any]:
    """The same from one pose to another, each a position and a quaternion x y z w: the
    origin straight, the turn about one axis, the shortest way, or right-handed about the
    axis that lies nearer to `axis`, and `turns` whole turns more. Within 1e-6 radians of
    half a turn without an axis it is E_INVAL: rounding would choose the way."""
    if turns.__class__ is not int or not -2**31 <= turns < 2**31:
        raise refusal(Status.E_INVAL, f"turns is {turns!r}, not an integer of 32 bits")
    poses = [abi.pccd_pose(tuple(_numbers(f"the position of {name}", pose[0], 3)),
                           tuple(_numbers(f"the rotation of {name}", pose[1], 4)))
             for name, pose in (("begin", begin), ("end", end))]
    return _add(lib.pccd_joints_poses, joints, parent, ctypes.byref(poses[0]),
                ctypes.byref(poses[1]), turns,
                None if axis is None else _numbers("axis", axis, 3))


def joints_rotation_vector(origin0: ArrayLike, origin1: ArrayLike, w0: ArrayLike,
                           w1: ArrayLike, joints: Optional[NDArray[Any]] = None,
                           parent: int = NO_JOINT) -> NDArray[Any]:
    """The same with the rotation vector going straight from w0 to w1, and the origin from
    origin0 to origin1, as codes for rigid bodies interpolate poses."""
    return _add(lib.pccd_joints_rotation_vector, joints, parent,
                *(_numbers(name, given, 3) for name, given in (
                    ("origin0", origin0), ("origin1", origin1), ("w0", w0), ("w1", w1))))


def rotation_of_matrix(m: ArrayLike) -> NDArray[np.float64]:
    """The quaternion x y z w of a matrix (3, 3), or of a transform (3, 4), rows of
    [R | t]. E_INVAL: R is no rotation within 1e-6; the text says by how much."""
    given = real_numbers("m", m)
    if given.shape not in ((3, 3), (3, 4)):
        raise refusal(Status.E_INVAL,
                      f"m has the shape {given.shape}, not (3, 3) or (3, 4)")
    rows = np.zeros((3, 4))
    rows[:, :given.shape[1]] = given
    made = np.empty(4)
    _check(lib.pccd_rotation_of_matrix(rows.ctypes.data, made.ctypes.data))
    return made


def joints_place(joints: NDArray[Any], joint: int, t: float) -> NDArray[np.float64]:
    """The transform (3, 4) that takes the registered positions of what hangs on a joint
    to where they are at time t, 0 .. 1: at both ends of a step as the daemon has them. Of
    a contact's toi, Bodies.points takes it as both poses of the body."""
    table, m = table_of(joints), np.empty((3, 4))
    _check(lib.pccd_joints_place(table.ctypes.data, len(table), u32("joint", joint), t,
                                 m.ctypes.data))
    return m


def joints_of(name: str, given: Any) -> NDArray[Any]:
    """An array of JOINT: joint values alone do not say what turns, and how."""
    table = np.asarray(given)
    if table.dtype != JOINT:
        raise refusal(Status.E_INVAL, f"{name}: a table of joints is an array of JOINT, "
                      "as joints_screw, joints_poses and joints_rotation_vector return "
                      "it, or np.zeros(count, pccd.JOINT) whose fields you set; this is "
                      f"one of {table.dtype}")
    return table


def table_of(joints: Any) -> NDArray[Any]:
    """A table that the library may read: packed, of JOINT."""
    table = joints_of("joints", joints)
    if table is not joints or table.ndim != 1 or not table.flags.c_contiguous \
            or len(table) == 0:
        raise refusal(Status.E_INVAL, "joints: each step reads the array itself, so it "
                      "must be C-contiguous and of one dimension, with a joint at least")
    return table


def _numbers(name: str, given: ArrayLike, count: int) -> Any:
    numbers = real_numbers(name, given)
    if numbers.shape != (count,):
        raise refusal(Status.E_INVAL, f"{name} has the shape {numbers.shape}, not "
                      f"({count},)")
    return (ctypes.c_double * count)(*numbers)


def _add(call: Any, joints: Optional[NDArray[Any]], parent: int,
         *given: Any) -> NDArray[Any]:
    first = 0 if joints is None else len(table_of(joints))
    table = np.zeros(first + MOST, JOINT)
    if joints is not None:
        table[:first] = joints
    count = ctypes.c_uint32(first)
    _check(call(*given, u32("parent", parent), table.ctypes.data, len(table),
                ctypes.byref(count)))
    return table[:count.value]


def _check(status: int) -> None:
    if status:
        raise failure(None, status)
