"""points.py - where the features of records are: vertices, weights, points, manifolds.

Room:     client/python. May import: abi, library, values, numpy.
Does:     calls of libpccd each (pccd_points.h), which ask no daemon.
"""

from __future__ import annotations

from ctypes import byref, c_uint64
from typing import Any, Dict, List, Mapping, NamedTuple, Optional, Tuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import abi
from .abi import Status
from .library import failure, lib
from .values import CONTACT, NEAR, real_numbers, refusal

MANIFOLD = np.dtype(abi.pccd_manifold)
Poses = Mapping[int, Tuple[ArrayLike, ArrayLike]]


class Shape(NamedTuple):
    """What a body is made of: vertices by their number, triangles (m, 3), and edges as
    Client.mesh_edges has them, uint32."""

    vertex_count: int
    triangles: NDArray[np.uint32]
    edges: NDArray[np.uint32]


class Stencils(NamedTuple):
    """Of each record, the four vertices by their numbers among those of all bodies, one
    after the other by increasing handle: x[vertices] works on such an array of
    positions. weights: (x[vertices] * weights[..., None]).sum(1) is the vector from the
    point of b to that of a. Records of fewer vertices repeat the last with the weight 0.
    at: toi of contacts, the distance d_lo of what is near; normal: unit, from b to a."""

    vertices: NDArray[np.uint32]
    weights: NDArray[np.float64]
    at: NDArray[np.float64]
    normal: NDArray[np.float32]


def _check(status: int) -> None:
    if status != Status.OK:
        raise failure(None, status)


def _records(records: NDArray[Any]) -> NDArray[Any]:
    if records.dtype not in (CONTACT, NEAR):
        raise refusal(Status.E_INVAL, f"records are {records.dtype}, neither contacts "
                      "nor what is near")
    return np.ascontiguousarray(records)


class Bodies:
    """The objects of a scene by their handles (Client.bodies makes them). Records that
    name others are E_HANDLE."""

    def __init__(self, shapes: Mapping[int, Shape]) -> None:
        self._shapes = {handle: shapes[handle] for handle in sorted(shapes)}
        self.first: Dict[int, int] = {}  # number of the first vertex of each
        self.vertex_count = 0
        for handle, shape in self._shapes.items():
            self.first[handle] = self.vertex_count
            self.vertex_count += shape.vertex_count
        self._structs = self._of(self._shapes)

    def _of(self, handles: Any) -> Any:
        structs = (abi.pccd_body * len(handles))()
        for struct, handle in zip(structs, handles):
            shape = self._shapes[handle]
            struct.object, struct.first = handle, self.first[handle]
            struct.vertex_count = shape.vertex_count
            struct.triangle_count, struct.edge_count = len(shape.triangles), \
                len(shape.edges)
            struct.triangles = shape.triangles.ctypes.data
            struct.edges = shape.edges.ctypes.data
        return structs

    def _placed(self, x0: Mapping[int, ArrayLike], x1: Mapping[int, ArrayLike],
                poses: Poses) -> Tuple[Any, List[Any]]:
        """Those that have positions, and the arrays, which have to stay."""
        for name, given in (("x0", x0), ("x1", x1), ("poses", poses)):
            if not isinstance(given, Mapping):
                raise refusal(Status.E_INVAL, f"{name} is {type(given).__name__}, not a "
                              "dictionary of arrays by the handles of their objects")
        handles = [handle for handle in self._shapes if handle in x0]
        structs, kept = self._of(handles), []

        def pack(name: str, given: ArrayLike, shape: Any) -> int:
            made = np.ascontiguousarray(real_numbers(name, given), np.float64)
            if made.shape != shape:
                raise refusal(Status.E_INVAL, f"{name} has the shape {made.shape}, not "
                              f"{shape}")
            kept.append(made)
            return int(made.ctypes.data)

        for struct, handle in zip(structs, handles):
            for name, given in (("x0", x0), ("x1", x1)):
                if handle in given:
                    setattr(struct, name, pack(f"{name}[0x{handle:x}]", given[handle],
                                               (struct.vertex_count, 3)))
            if handle in poses:
                struct.m0, struct.m1 = (pack(f"a pose of 0x{handle:x}", pose, (3, 4))
                                        for pose in poses[handle])
        return structs, kept

    def stencils(self, records: NDArray[Any]) -> Stencils:
        """The Stencils of contacts or of what is near."""
        given = _records(records)
        vertices = np.empty((len(given), 4), np.uint32)
        weights = np.empty((len(given), 4))
        is_near = given.dtype == NEAR
        call = lib.pccd_near_stencils if is_near else lib.pccd_stencils
        _check(call(self._structs, len(self._structs), given.ctypes.data, len(given),
                    vertices.ctypes.data, weights.ctypes.data))
        return Stencils(vertices, weights, given["d_lo" if is_near else "toi"].copy(),
                        given["direction" if is_near else "normal"].copy())

    def points(self, records: NDArray[Any], x0: Mapping[int, ArrayLike],
               x1: Mapping[int, ArrayLike] = {}, poses: Poses = {},
               t: float = 1.0) -> NDArray[np.float64]:
        """Where each record is, (n, 2, 3): on a and on b. x0, x1: positions of objects by
        handle at both ends of the step; without x1 an object stands. poses: (m0, m1) of
        objects, rows of [R | t], which move x0, then as registered. Contacts are where
        they are at their toi, what is near at t."""
        given = _records(records)
        structs, _kept = self._placed(x0, x1, poses)
        points = np.empty((len(given), 2, 3))
        where = structs, len(structs), given.ctypes.data, len(given)
        if given.dtype == NEAR:
            _check(lib.pccd_near_points(*where, t, points.ctypes.data))
        else:
            _check(lib.pccd_points(*where, points.ctypes.data))
        return points

    def manifolds(self, records: NDArray[Any], x0: Mapping[int, ArrayLike],
                  x1: Mapping[int, ArrayLike] = {}, poses: Poses = {}, *,
                  within: Optional[float] = None,
                  t: float = 1.0) -> NDArray[Any]:
        """For each two objects at most four points that span the largest area, MANIFOLD:
        of the contacts whose toi is at most `within` later than their first (None: 1e-6,
        the default tolerance, within which what meets at once has its toi), of what is
        near and at most `within` apart (None: all)."""
        given = _records(records)
        structs, _kept = self._placed(x0, x1, poses)
        room, total = len(given), c_uint64()
        made = np.empty(room, MANIFOLD)
        if within is None:
            within = np.inf if given.dtype == NEAR else 1e-6
        where = structs, len(structs), given.ctypes.data, len(given), within
        if given.dtype == NEAR:
            _check(lib.pccd_near_manifolds(*where, t, made.ctypes.data, room,
                                           byref(total)))
        else:
            _check(lib.pccd_manifolds(*where, made.ctypes.data, room, byref(total)))
        return made[:total.value].copy()
