"""rays.py - rays, spheres and capsules that are cast, many at once.

Room:     client/python. May import: abi, client, library, values, numpy.
Does:     a step in which points and rods move, each in pieces: the box of a long way is
          larger than those of its pieces, and fewer triangles are in these.
"""

from __future__ import annotations

from typing import Any, NamedTuple, Optional

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .abi import Kind, Status
from .frame import Motions
from .values import StepSettings, pack_vertices, refusal


class Hits(NamedTuple):
    """Of each ray the first thing that it meets. t: where on its way, 0 .. 1, inf: none
    is met; object and feature: handle, and index of the face, edge or vertex, by kind,
    in that object; normal: unit, from there to the ray at the begin of the piece."""

    t: NDArray[np.float64]
    object: NDArray[np.uint32]
    feature: NDArray[np.uint32]
    kind: NDArray[np.uint32]
    normal: NDArray[np.float32]


class Rays:
    """Points that are cast through a scene, with radii spheres, with rods capsules.

        rays = pccd.Rays(client, scene, 10000)
        hits = rays.cast(origins, ends)             # (10000, 3) each

    count: of vertices; radii: (count,) or a number; rods (m, 2): vertices that belong
    together; then a hit is of a rod. pieces: of each way; 8 where it passes over a tenth
    of the level or more, 1 where ways are no longer than triangles. They are an object of
    the scene until close(), and steps of it may meet them where they stand: give casts a
    scene of their own, with objects of the same meshes."""

    def __init__(self, client: Any, scene: int, count: int,
                 radii: Optional[ArrayLike] = None, rods: Optional[ArrayLike] = None,
                 pieces: int = 8) -> None:
        if count < 1 or pieces < 1:
            raise refusal(Status.E_INVAL, f"{count} rays in {pieces} pieces")
        self._client, self._scene, self._shape = client, scene, (pieces, count)
        all_of_them = np.arange(pieces * count, dtype=np.uint32)
        pairs = None if rods is None else np.asarray(rods, np.int64).reshape(-1, 2)
        self._count = count if pairs is None else len(pairs)
        self._ray = np.arange(count) if pairs is None else np.zeros(count, np.int64)
        if pairs is not None:
            self._ray[pairs] = np.arange(len(pairs))[:, None]
            first = count * np.arange(pieces)[:, None, None]
            pairs = (pairs[None] + first).reshape(-1, 2)
        if radii is not None:
            radii = np.tile(np.broadcast_to(np.asarray(radii, np.float64), count), pieces)
        self._made = {"radii": radii, "edges": pairs,
                      "points": all_of_them if pairs is None else None}
        self._mesh = self._object = 0
        self._x0, self._x1 = (np.zeros((pieces * count, 3)) for _ in range(2))
        self._motions = Motions()

    def _make(self) -> None:
        """By the first cast: what is registered near each other is searched together."""
        self._mesh = self._client.mesh_create(self._x0, **self._made)
        self._edges = self._client.mesh_edges(self._mesh)
        self._object = self._client.scene_add(self._scene, self._mesh)
        self._client.object_set(self._scene, self._object, self_collision=False)
        self._motions.x0x1(self._object, self._x0, self._x1)

    def close(self) -> None:
        """Take them out of the scene."""
        if self._object:
            self._client.scene_remove(self._scene, self._object)
            self._client.mesh_destroy(self._mesh)

    def cast(self, begin: ArrayLike, end: ArrayLike,
             settings: StepSettings = StepSettings()) -> Hits:
        """From begin to end, (count, 3) each; all else stands where it is."""
        pieces, count = self._shape
        at, to = pack_vertices("begin", begin), pack_vertices("end", end)
        if len(at) != count or len(to) != count:
            raise refusal(Status.E_INVAL, f"{len(at)} begins and {len(to)} ends of "
                          f"{count} rays")
        for k in range(pieces):
            self._x0[k * count:][:count] = at + (to - at) * (k / pieces)
        self._x1[:-count] = self._x0[count:]
        self._x1[-count:] = to
        if not self._object:
            self._make()
        with self._client.step(self._scene, self._motions, settings) as answer:
            if answer.incomplete:
                raise refusal(Status.E_LIMIT, f"cast: the answer has {answer.count} of "
                              f"{answer.total} records ({answer.incomplete!r})")
            return self._first(answer.contacts)

    def _first(self, contacts: NDArray[Any]) -> Hits:
        pieces, count = self._shape
        made = Hits(np.full(self._count, np.inf), np.zeros(self._count, np.uint32),
                    np.zeros(self._count, np.uint32), np.zeros(self._count, np.uint32),
                    np.zeros((self._count, 3), np.float32))
        is_a = contacts["object_a"] == self._object
        given = contacts[is_a | (contacts["object_b"] == self._object)]
        is_a = given["object_a"] == self._object
        own = np.where(is_a, given["feature_a"], given["feature_b"])
        has_edge = (given["kind"] == Kind.EE) | (given["kind"] == Kind.VE) & ~is_a
        own[has_edge] = self._edges[own[has_edge], 0]
        t = (own // count + given["toi"]) / pieces
        ray = self._ray[own % count]
        order = np.lexsort((np.arange(len(t)), t, ray))
        order = order[np.r_[True, ray[order][1:] != ray[order][:-1]]] if len(t) else order
        ray, first, is_a = ray[order], given[order], is_a[order]
        made.t[ray], made.kind[ray] = t[order], first["kind"]
        made.object[ray] = np.where(is_a, first["object_b"], first["object_a"])
        made.feature[ray] = np.where(is_a, first["feature_b"], first["feature_a"])
        made.normal[ray] = np.where(is_a[:, None], first["normal"], -first["normal"])
        return made
