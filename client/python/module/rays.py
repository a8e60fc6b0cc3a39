"""rays.py - rays, spheres and capsules that are cast, many at once.

Room:     client/python. May import: abi, client, library, values, numpy.
Does:     call pccd_rays.h.
"""

from __future__ import annotations

from ctypes import byref, c_void_p
from typing import Any, NamedTuple, Optional

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import abi
from .abi import Status
from .library import lib
from .values import StepSettings, pack_indices, pack_vertices, put, real_numbers, \
    refusal, u32, with_size

HIT = np.dtype(abi.pccd_ray_hit)


class Hits(NamedTuple):
    """Of each ray the first thing that it meets. t: where on its way, 0 .. 1, inf: none
    is met; object and feature: handle, and index of the face, edge or vertex in that
    object, which has 3, 2 or 1 points; normal: unit, from there to the ray; point: where
    the ray is then, the centre of a sphere; weights: of the feature's vertices."""

    t: NDArray[np.float64]
    object: NDArray[np.uint32]
    feature: NDArray[np.uint32]
    points: NDArray[np.uint32]
    normal: NDArray[np.float32]
    point: NDArray[np.float64]
    weights: NDArray[np.float64]


class Rays:
    """Points that are cast through a scene, with radii spheres, with rods capsules.

        rays = pccd.Rays(client, scene, 10000)
        hits = rays.cast(origins, ends)             # (10000, 3) each

    count: of vertices; radii: (count,) or a number; rods (m, 2): vertices that belong
    together, with the larger radius of both; then a hit is of a rod. pieces: of each way;
    8 where it passes over a tenth of the level or more, 1 where ways are no longer than
    triangles. group, mask: as of objects; 0: those of a new one. They are an object of
    the scene until close(), and steps of it may meet them where they stand: give casts a
    scene of their own, with objects of the same meshes."""

    def __init__(self, client: Any, scene: int, count: int,
                 radii: Optional[ArrayLike] = None, rods: Optional[ArrayLike] = None,
                 pieces: int = 8, group: int = 0, mask: int = 0) -> None:
        if count < 1 or pieces < 1:
            raise refusal(Status.E_INVAL, f"{count} rays in {pieces} pieces")
        self._client, self._count = client, count
        self._rods = None if rods is None else pack_indices("rods", rods, 2)
        if self._rods is not None and (self._rods >= count).any():
            raise refusal(Status.E_INDEX, f"rods have vertex {self._rods.max()} of "
                          f"{count}")
        settings = with_size(abi.pccd_rays_settings())
        ends, self._hits = (1, count) if self._rods is None else (2, len(self._rods))
        for name, value in (("count", self._hits), ("ends", ends), ("pieces", pieces),
                            ("group", group), ("mask", mask)):
            put(settings, name, value)
        if radii is not None:
            given = real_numbers("radii", radii).astype(np.float64)
            if given.shape not in ((), (1,), (count,)):
                raise refusal(Status.E_INVAL,
                              f"radii is {given.shape}, not ({count},) or a number")
            given = np.broadcast_to(given, count)
            given = given if self._rods is None else given[self._rods].max(1)
            given = np.ascontiguousarray(given)
            settings.radii = given.ctypes.data
        self._made = c_void_p()
        client._check(lib.pccd_rays_begin(client._handle, u32("scene", scene),
                                          byref(settings), byref(self._made)))

    def close(self) -> None:
        """Take them out of the scene."""
        made, self._made = self._made, c_void_p()
        lib.pccd_rays_end(self._client._handle, made)

    def __del__(self) -> None:
        made = getattr(self, "_made", None)
        if made:  # any thread may get here: memory alone
            lib.pccd_rays_end(None, made)

    def cast(self, begin: ArrayLike, end: ArrayLike,
             settings: StepSettings = StepSettings()) -> Hits:
        """From begin to end, (count, 3) each; all else stands where it is."""
        ways = [pack_vertices(name, x).astype(np.float64, copy=False)
                for name, x in (("begin", begin), ("end", end))]
        if any(len(x) != self._count for x in ways):
            raise refusal(Status.E_INVAL, f"{len(ways[0])} begins and {len(ways[1])} "
                          f"ends of {self._count} rays")
        if self._rods is not None:
            ways = [np.ascontiguousarray(x[self._rods]) for x in ways]
        hits = np.empty(self._hits, HIT)
        self._client._settle()
        self._client._check(lib.pccd_rays_cast(
            self._client._handle, self._made, ways[0].ctypes.data, ways[1].ctypes.data,
            settings._as_parameter_, hits.ctypes.data))
        return Hits(*(hits[name] for name in Hits._fields))
