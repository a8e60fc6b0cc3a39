"""weld.py - vertices of arrays that are one, though they are apart.

Room:     client/python. May import: abi, library, numpy, values.
Does:     call pccd_weld.h, as pccdctl does for files.
"""

from __future__ import annotations

import ctypes
from typing import NamedTuple, Sequence

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import abi
from .abi import Status
from .library import failure, lib
from .values import format_of, pack_indices, pack_vertices, refusal, with_size


class Welded(NamedTuple):
    """Triangles, edges and points with the least vertex at each place, and what became of
    the others: to[v] is the vertex that stands for v, joined how many others stand for,
    apart how many stay because they move away from the same place."""
    triangles: NDArray[np.uint32]
    edges: NDArray[np.uint32]
    points: NDArray[np.uint32]
    to: NDArray[np.uint32]
    joined: int
    apart: int


def weld(frames: Sequence[ArrayLike], triangles: ArrayLike = (), edges: ArrayLike = (),
         points: ArrayLike = (), distance: float = 0.0) -> Welded:
    """Find the vertices that are at one place in every one of `frames`, each an array
    [vertices, 3]: equal to the last bit, or at most `distance` apart. Those count that
    triangles, edges and points name, or all where there is none. Vertices are not
    renumbered: the arrays of positions stay as they are, and what is joined is named no
    more. PccdError: E_INVAL for no frame or arrays of other shapes, E_INDEX for a vertex
    that is not there, E_NOTFINITE for a coordinate that is not, or is above 1e18."""
    places = [pack_vertices("a frame", x) for x in frames]
    if not places or any(x.shape != places[0].shape for x in places):
        raise refusal(Status.E_INVAL, "frames are not one array (n, 3) or several of "
                      "one n")
    three, two, one = (_indices(name, numbers, width) for name, numbers, width in
                       (("triangles", triangles, 3), ("edges", edges, 2),
                        ("points", points, 1)))
    mesh = with_size(abi.pccd_mesh_data(
        vertex_count=len(places[0]), triangle_count=len(three), edge_count=len(two),
        point_count=len(one), triangles=three.ctypes.data, edges=two.ctypes.data,
        points=one.ctypes.data))
    made, counts = ctypes.c_void_p(), abi.pccd_weld_counts()
    _check(lib.pccd_weld_begin(ctypes.byref(mesh), float(distance), False,
                               ctypes.byref(made)))
    try:
        for x in places:
            _check(lib.pccd_weld_frame(made, x.ctypes.data, format_of(x.dtype)))
        at = ctypes.cast(lib.pccd_weld_read(made, ctypes.byref(counts)),
                         ctypes.POINTER(ctypes.c_uint32))
        to = np.ctypeslib.as_array(at, (len(places[0]),)).copy()
    finally:
        lib.pccd_weld_end(made)
    return Welded(to[three], to[two], to[one], to, counts.joined, counts.apart)


def _indices(name: str, numbers: ArrayLike, width: int) -> NDArray[np.uint32]:
    """Of `width` vertices each; of a kind that is not there, none."""
    if np.size(numbers) == 0:
        return np.empty((0, width) if width > 1 else 0, np.uint32)
    return pack_indices(name, numbers, width)


def _check(status: int) -> None:
    if status != Status.OK:
        raise failure(None, status)
