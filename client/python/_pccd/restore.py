"""restore.py - tell another daemon what the last one knew.

Room:     client/python. May import: keep, ring, upload, values, wire, numpy.
Does:     everything goes through the slots of a new ring, which are all free; then the
          slots of the old one that have no answer are copied over.
Does not: submit what has no answer (recover).
Source:   client/lib/restore.c.
"""

from __future__ import annotations

import time
from typing import Any, Dict, List, Tuple

import numpy as np
from numpy.typing import NDArray

from .keep import Kept, KeptObject
from .ring import Ring
from .upload import Upload
from .values import failure, format_of
from .wire import (FEATURE_FILTERS, RIGID, SEGMENT, SLOT_BYTES_MIN, X0X1, Format, Mode,
                   ObjectWhat, Status)

FILTERS = (("group", ObjectWhat.GROUP), ("mask", ObjectWhat.MASK),
           ("self", ObjectWhat.SELF))
SEGMENTS = 64  # of a step that brings positions back

#: Object, kind of segment, format, first vertex; positions or transform of both ends.
Move = Tuple[int, int, int, int, NDArray[Any]]


class Restore(Upload):
    """A connection that outlives its daemon."""

    def _restore(self) -> None:
        begin = time.monotonic()
        kept, old = self._kept, self._ring
        if kept is None:
            raise failure(Status.E_STATE,
                          "the session is over, and nothing was kept to begin another")
        self._fold_all()  # what only the old memory holds
        self._ring = None
        try:
            if old is not None:
                self._ring = self._attach(old.slot_bytes, len(old.slots))
            elif kept.meshes:
                self._reserve(SLOT_BYTES_MIN)
            self._restore_all(kept)
            if old is not None:
                self._carry_over(old)
        except BaseException:
            self._ring = old
            raise
        self.link_info.restore_ns = int((time.monotonic() - begin) * 1e9)

    def _restore_all(self, kept: Kept) -> None:
        for mesh in sorted(kept.meshes, key=lambda mesh: mesh.is_destroyed):
            want = 0 if mesh.is_destroyed else mesh.handle
            mesh.made = self._call("mesh.create", vertex_count=len(mesh.x), want=want,
                                   triangle_count=len(mesh.triangles))["mesh"]
            self._fill(mesh.made, mesh.x, mesh.triangles)
        for scene, settings in kept.scenes.items():
            self._call("scene.create", want=scene, **settings)
            for handle, item in sorted(kept.objects[scene].items()):
                self._call("scene.add", scene=scene, mesh=item.mesh.made, want=handle)
            self._restore_positions(scene, kept.objects[scene])
            self._restore_filters(kept, scene)
        for mesh in kept.meshes:
            if mesh.is_destroyed:
                self._call("mesh.destroy", mesh=mesh.made)

    def _restore_filters(self, kept: Kept, scene: int) -> None:
        """A daemon that tests everything would answer other bytes than the last one. Of a
        scene that is shared, others bring their objects back as they can."""
        objects = kept.objects[scene]
        if not self._features & FEATURE_FILTERS and (
                kept.ignored[scene] or any(item.filter for item in objects.values())):
            raise failure(Status.E_VERSION, f"the new daemon at {self.url} is older than "
                          "the last one: it cannot be told which objects may meet")
        for handle, item in objects.items():
            what = sum(bit for name, bit in FILTERS if name in item.filter)
            if what:
                self._wait(self._send("object.set", {"scene": scene, "object": handle,
                                                     "what": what, **item.filter}))
        for a, b in sorted(kept.ignored[scene]):
            if a in objects and b in objects:
                self._call("scene.ignore", scene=scene, a=a, b=b, ignored=True)

    def _restore_positions(self, scene: int, objects: Dict[int, KeptObject]) -> None:
        """By steps whose segments begin where they end, and that search nothing."""
        assert self._ring is not None
        table = SEGMENTS * SEGMENT.size
        room = self._ring.slot_bytes - table
        batch: List[Move] = []
        used = 0
        for handle, item in objects.items():
            moves: List[Move] = []
            if item.x is not None:
                rows = max(1, room // item.x[:1].nbytes)
                moves = [(handle, X0X1, format_of(item.x.dtype), first,
                          item.x[first:first + rows])
                         for first in range(0, len(item.x), rows)]
            elif item.m is not None:
                moves = [(handle, RIGID, Format.F64, 0, item.m)]
            for move in moves:
                size = (move[4].nbytes + 7) // 8 * 8
                if used + size > room or len(batch) == SEGMENTS:
                    self._bring_back(scene, batch, objects)
                    batch, used = [], 0
                batch.append(move)
                used += size
        if batch:
            self._bring_back(scene, batch, objects)

    def _bring_back(self, scene: int, batch: List[Move],
                    objects: Dict[int, KeptObject]) -> None:
        assert self._kept is not None
        ring, slot = self._begin_slot()
        payload = ring.payload(slot)
        end = SEGMENTS * SEGMENT.size
        for index, (handle, kind, format, first, data) in enumerate(batch):
            count = len(objects[handle].mesh.x) if kind == RIGID else len(data)
            SEGMENT.pack_into(payload.data, index * SEGMENT.size, handle, kind, format,
                              first, count, end, end)
            payload[end:end + data.nbytes] = data.reshape(-1).view(np.uint8)
            end += (data.nbytes + 7) // 8 * 8
        seq = ring.publish(slot)
        params: Dict[str, Any] = {"scene": scene, "slot": slot.index, "seq": seq,
                                  "segments": len(batch), "mode": Mode.ANY,
                                  "deadline_ns": 1}
        if "name" in self._kept.scenes[scene]:
            params["place"] = True  # nobody is told, and what is held waits
        self._wait(self._send("frame.submit", params, slot))

    def _carry_over(self, old: Ring) -> None:
        """Bring the slots of steps without an answer into the new memory. A frame that is
        begun has arrays in the old one: it is copied when it is committed."""
        ring = self._ring
        assert ring is not None
        if ring.slot_bytes != old.slot_bytes or len(ring.slots) != len(old.slots):
            raise failure(Status.E_BADMSG, "shm.attach: another ring than before")
        ring.slots = old.slots
        for slot in ring.slots:
            if slot.sent:
                ring.payload(slot)[:slot.used] = old.payload(slot)[:slot.used]
            ring.store_seq(slot)
        ring.fence()
