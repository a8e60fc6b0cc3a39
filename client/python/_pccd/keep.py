"""keep.py - what another daemon would have to be told.

Room:     client/python. May import: ring, wire, numpy.
Does:     keep scenes, meshes and objects as they were registered, and where the vertices
          of each object were at the end of its last answered step; what they may meet.
Does not: talk to a daemon (restore).
Source:   client/lib/keep.h, client/lib/place.c.
"""

from __future__ import annotations

from typing import Any, Dict, Iterator, List, Optional, Set, Tuple

import numpy as np
from numpy.typing import NDArray

from .ring import Ring, Slot
from .wire import RIGID, RIGID_BYTES, Format


class KeptMesh:
    """Vertices and triangles as they were registered."""

    def __init__(self, handle: int, x: NDArray[Any], triangles: NDArray[Any]) -> None:
        self.handle = handle
        self.made = handle  # that a new daemon gave, while it is told
        self.x = x
        self.triangles = triangles
        self.objects = 0  # made of it
        self.is_destroyed = False  # but objects are left


class KeptObject:
    """x: where its vertices are; else m: its transform; else as registered. since: the
    step that moved all of it last; segments of earlier ones do not count."""

    __slots__ = ("mesh", "x", "m", "since", "filter")

    def __init__(self, mesh: KeptMesh, since: int) -> None:
        self.mesh = mesh
        self.since = since
        self.x: Optional[NDArray[Any]] = None
        self.m: Optional[NDArray[Any]] = None
        self.filter: Dict[str, Any] = {}  # that was ever set, of group, mask and self

    def positions(self, first: int, count: int,
                  m: Optional[NDArray[Any]]) -> NDArray[Any]:
        """Of registered vertices, transformed as the protocol says: each operation is
        rounded once."""
        x = self.mesh.x[first:first + count]
        if m is None:
            return x.copy()
        made = np.empty((count, 3))
        x, y, z = (x[:, axis].astype(np.float64) for axis in range(3))
        for row in range(3):
            made[:, row] = m[row, 0] * x + m[row, 1] * y + m[row, 2] * z + m[row, 3]
        return made

    def apply(self, segment: Tuple[int, ...], payload: NDArray[np.uint8]) -> None:
        """Take over the end of a segment out of its slot."""
        _, kind, format, first, count, _, offset = segment
        m: Optional[NDArray[Any]] = None
        whole = count == len(self.mesh.x)
        if kind == RIGID:
            m = payload[offset:offset + RIGID_BYTES].view(np.float64).reshape(3, 4)
            m = m.copy()
            if whole:
                self.m, self.x = m, None
                return
            end = self.positions(first, count, m)
        else:
            dtype = np.dtype(np.float64 if format == Format.F64 else np.float32)
            end = payload[offset:offset + 3 * count * dtype.itemsize].view(dtype)
            end = end.reshape(count, 3)
        if whole:
            self.x = end.copy()
            return
        if self.x is None:
            self.x = self.positions(0, len(self.mesh.x), self.m)
        if self.x.dtype != end.dtype and end.dtype == np.float64:
            self.x = self.x.astype(np.float64)  # nothing is rounded
        self.x[first:first + count] = end


class Kept:
    """Scenes, meshes and objects as the daemon has them. Positions are not copied when a
    step is answered: its slot is kept, and read only when it is needed for another step
    and still holds the last positions of some object."""

    def __init__(self) -> None:
        self.meshes: List[KeptMesh] = []  # in the order in which they were made
        self.scenes: Dict[int, Dict[str, Any]] = {}  # handle: settings
        self.objects: Dict[int, Dict[int, KeptObject]] = {}  # of each scene, by handle
        self.ignored: Dict[int, Set[Tuple[int, int]]] = {}  # pairs of each scene

    def mesh(self, handle: int) -> Optional[KeptMesh]:
        for mesh in self.meshes:
            if mesh.handle == handle and not mesh.is_destroyed:
                return mesh
        return None

    def add_mesh(self, handle: int, x: NDArray[Any], triangles: NDArray[Any],
                 step: int) -> None:
        mesh = self.mesh(handle)
        if mesh is None:
            self.meshes.append(KeptMesh(handle, x, triangles))
            return
        mesh.x, mesh.triangles = x, triangles
        for objects in self.objects.values():  # they stand where it was registered
            for kept in objects.values():
                if kept.mesh is mesh:
                    kept.x = kept.m = None
                    kept.since = step

    def remove_mesh(self, handle: int) -> None:
        mesh = self.mesh(handle)
        if mesh is not None:
            mesh.is_destroyed = True
            self._settle(mesh)

    def _settle(self, mesh: KeptMesh) -> None:
        if mesh.is_destroyed and mesh.objects == 0:
            self.meshes.remove(mesh)

    def add_scene(self, handle: int, settings: Dict[str, Any]) -> None:
        self.scenes[handle] = settings
        self.objects[handle] = {}
        self.ignored[handle] = set()

    def remove_scene(self, handle: int) -> None:
        self.scenes.pop(handle, None)
        self.ignored.pop(handle, None)
        for kept in self.objects.pop(handle, {}).values():
            kept.mesh.objects -= 1
            self._settle(kept.mesh)

    def add_object(self, scene: int, mesh: int, handle: int, step: int) -> None:
        kept = self.mesh(mesh)
        if kept is not None and scene in self.objects:
            kept.objects += 1
            self.objects[scene][handle] = KeptObject(kept, step)

    def remove_object(self, scene: int, handle: int) -> None:
        kept = self.objects.get(scene, {}).pop(handle, None)
        if kept is not None:
            kept.mesh.objects -= 1
            self._settle(kept.mesh)
            self.ignored[scene] = {pair for pair in self.ignored[scene]
                                   if handle not in pair}

    def filter_object(self, scene: int, handle: int, what: Dict[str, Any]) -> None:
        kept = self.objects.get(scene, {}).get(handle)
        if kept is not None:
            kept.filter.update(what)

    def ignore_pair(self, scene: int, a: int, b: int, ignored: bool) -> None:
        pair = (min(a, b), max(a, b))
        pairs = self.ignored.get(scene)
        if pairs is not None and ignored:
            pairs.add(pair)
        elif pairs is not None:
            pairs.discard(pair)

    def _current(self, slot: Slot) -> Iterator[Tuple[KeptObject, Tuple[int, ...]]]:
        """The segments of a slot that no later step has overwritten."""
        objects = self.objects.get(slot.scene, {})
        for segment in slot.segments:
            kept = objects.get(segment[0])
            if kept is not None and slot.step >= kept.since and \
                    segment[3] + segment[4] <= len(kept.mesh.x):
                yield kept, segment

    def answered(self, slot: Slot, step: int) -> None:
        """The step in a slot has been answered: its positions are the last."""
        slot.step = step
        slot.kept = True
        for kept, segment in self._current(slot):
            if segment[4] == len(kept.mesh.x):
                kept.since = step

    def holds(self, slot: Slot) -> bool:
        """Whether a slot is the only place where some positions are."""
        if slot.kept and next(self._current(slot), None) is None:
            slot.kept = False
        return slot.kept

    def fold(self, ring: Ring, slot: Slot) -> None:
        """Copy what only a slot holds. Slots are taken in the order of their steps."""
        if slot.kept:
            for kept, segment in self._current(slot):
                kept.apply(segment, ring.payload(slot))
        slot.kept = False

    def fold_all(self, ring: Ring) -> None:
        for slot in sorted(ring.slots, key=lambda slot: slot.step):
            self.fold(ring, slot)
