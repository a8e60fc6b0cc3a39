"""upload.py - the upload ring, and meshes through it.

Room:     client/python. May import: keep, link, recover, ring, values, wire, numpy.
Does:     attach a ring that is large enough, take slots, upload meshes in chunks.
Does not: write steps (frame) or map memory (ring).
Source:   client/lib/attach.c, client/lib/mesh.c.
"""

from __future__ import annotations

import collections
import os
from typing import Any, Deque, Dict, Optional, Tuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .answer import Result
from .keep import Kept
from .link import Call
from .recover import Recover
from .ring import Ring, Slot
from .values import (MeshInfo, Options, PccdError, format_of, failure, pack_triangles,
                     pack_vertices)
from .wire import SLOT_BYTES_MIN, Status

SLOT_COUNT = 4
SLOT_BYTES = 256 << 10  # of a slot at first, when the user did not choose
RESULT_BYTES = 64 << 20
CHUNK_BYTES = 1 << 20  # of a mesh in one slot: small enough to overlap copy and check
CHUNKS = 8  # of a mesh in flight


class Upload(Recover):
    """A connection with shared memory."""

    def __init__(self, options: Options) -> None:
        super().__init__(options)
        self._slot_count = options.slot_count or SLOT_COUNT
        self._slot_bytes = options.slot_bytes or SLOT_BYTES
        self._result_bytes = options.result_bytes or RESULT_BYTES
        self._kept: Optional[Kept] = None  # None: nothing is
        self._next_step = 1
        self._infos: Dict[int, MeshInfo] = {}  # of every mesh

    def _attach(self, slot_bytes: int, slot_count: int) -> Ring:
        call = self._send("shm.attach", {
            "slot_count": slot_count, "slot_bytes": slot_bytes,
            "result_bytes": self._result_bytes})
        try:
            result = self._wait(call)
            return Ring(result, call.fds)
        except PccdError as problem:
            if problem.status == Status.E_TIMEOUT:
                self._ring = None  # which one the daemon reads is not known any more
            raise
        finally:
            for fd in call.fds:
                os.close(fd)

    def _reserve(self, slot_bytes: int) -> None:
        """A ring whose slots have so many bytes, if need be a new one: then everything in
        flight is waited for first."""
        old = self._ring
        if old is not None and old.slot_bytes >= slot_bytes:
            return
        least = max(slot_bytes, self._slot_bytes)
        wanted, count = least, self._slot_count
        if old is not None:
            if any(slot.begun for slot in old.slots):
                raise failure(Status.E_BUSY, f"a slot of {slot_bytes} bytes needs a "
                              "larger ring: commit or abort the frames that are begun "
                              "first")
            deadline = self._deadline()
            while self._calls:
                self._progress(deadline)
            self._fold_all()
            # Half as much again, so that slow growth does not attach for each step.
            wanted = max(least, old.slot_bytes + old.slot_bytes // 2)
        while True:
            try:
                self._ring = self._attach(wanted, count)
                return
            except PccdError as problem:
                if problem.status != Status.E_QUOTA or (
                        wanted == least and (self._options.slot_count or count == 1)):
                    raise
            if wanted > least:
                wanted = least
            else:
                count //= 2

    def _fold_all(self) -> None:
        if self._kept is not None and self._ring is not None:
            self._kept.fold_all(self._ring)

    def _choose_slot(self, ring: Ring) -> Optional[Slot]:
        """The first slot that is free, or else the one of the oldest step whose positions
        must be copied first."""
        free = [slot for slot in ring.slots if not slot.begun and not slot.sent]
        if self._kept is None:
            return free[0] if free else None
        for slot in free:
            if not self._kept.holds(slot):
                return slot
        return min(free, key=lambda slot: slot.step) if free else None

    def _begin_slot(self) -> Tuple[Ring, Slot]:
        deadline = self._deadline()
        while True:
            ring = self._ring
            if ring is None:
                raise failure(Status.E_DISCONNECTED, "there is no upload ring")
            slot = self._choose_slot(ring)
            if slot is not None:
                break
            if not any(other.sent for other in ring.slots):
                raise failure(Status.E_BUSY, f"all {len(ring.slots)} slots are begun: "
                              "commit or abort one")
            self._progress(deadline)
        if self._kept is not None:
            self._kept.fold(ring, slot)
        ring.begin(slot)
        return ring, slot

    # -- meshes on their way --

    def _register(self, mesh: int, x: ArrayLike, triangles: ArrayLike) -> int:
        """Create a mesh (0) or replace one. When another daemon took over on the way, all
        is sent to that one from the beginning."""
        vertices, faces = pack_vertices("x", x), pack_triangles(triangles)
        self._reserve(SLOT_BYTES_MIN)
        self._uploads_ended = 0
        while True:
            before = self._told_anew
            try:
                handle, result = self._announce(mesh, vertices, faces)
                break
            except PccdError:
                if self._dead is not None or self._told_anew == before:
                    raise
            if self._uploads_ended >= self._options.daemons_max:
                raise failure(Status.E_DISCONNECTED, "mesh: daemon after daemon has "
                              "ended before it was registered")
        self._infos[handle] = MeshInfo(*(result.get(name, 0)
                                         for name in MeshInfo._fields))
        if self._kept is not None:
            self._kept.add_mesh(handle, vertices.copy(), faces.copy(), self._next_step)
        return handle

    def _announce(self, mesh: int, x: NDArray[Any],
                  triangles: NDArray[Any]) -> Tuple[int, Result]:
        counts = {"vertex_count": len(x), "triangle_count": len(triangles)}
        made = mesh
        if mesh == 0:
            made = self._call("mesh.create", **counts)["mesh"]
        else:
            self._call("mesh.replace", mesh=mesh, **counts)
        told = self._told_anew
        try:
            return made, self._fill(made, x, triangles)
        except PccdError as problem:
            # Nothing half-made stays in the daemon; what went wrong first is what counts.
            try:
                if self._dead is None and told == self._told_anew:
                    if mesh == 0:
                        self._call("mesh.destroy", mesh=made)
                    else:
                        self._call("mesh.replace", mesh=mesh, vertex_count=0,
                                   triangle_count=0)
            except PccdError:
                pass
            raise problem

    def _fill(self, mesh: int, x: NDArray[Any], triangles: NDArray[Any]) -> Result:
        """Upload both arrays, several chunks in flight, and commit."""
        calls: Deque[Call] = collections.deque()
        try:
            for part, items in enumerate((x, triangles)):
                assert self._ring is not None
                rows = min(self._ring.slot_bytes, CHUNK_BYTES) // items[:1].nbytes
                for first in range(0, len(items), rows):
                    calls.append(self._send_chunk(mesh, part, first,
                                                  items[first:first + rows]))
                    if len(calls) >= CHUNKS:
                        self._wait(calls.popleft())
            while calls:
                self._wait(calls.popleft())
        finally:
            for call in calls:
                self._drop(call)
        return self._call("mesh.commit", mesh=mesh)

    def _send_chunk(self, mesh: int, part: int, first: int, items: NDArray[Any]) -> Call:
        ring, slot = self._begin_slot()
        ring.payload(slot)[:items.nbytes] = items.reshape(-1).view(np.uint8)
        slot.used = items.nbytes
        return self._send("mesh.data", {
            "mesh": mesh, "slot": slot.index, "seq": ring.publish(slot), "part": part,
            "format": format_of(items.dtype) if part == 0 else 0, "first": first,
            "count": len(items)}, slot)
