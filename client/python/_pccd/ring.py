"""ring.py - the upload ring and the result region.

Room:     client/python. May import: wire, values, numpy.
Does:     map the memory that the daemon made, and this side of the protocols of shm.h.
Source:   proto/shm.h, client/lib/attach.c, client/lib/page.c.

Order of stores. CPython does what the program says in its order, so that on x86, whose
processors keep the order of stores and of loads, an aligned store of 8 bytes through a
memoryview is enough. On AArch64 it is not, by itself: there, what the daemon must see
(payload, then even seq) is ordered by the message that names it, because the kernel
passes messages under a lock, and a slot or page is written again only after another
message has come the other way. Three words have no message beside them: the odd seq,
client_wait and result_head. They are stored behind Ring.fence().
"""

from __future__ import annotations

import collections
import fcntl
import mmap
import os
import threading
from typing import Any, Deque, Dict, List, Optional, Tuple

import numpy as np
from numpy.typing import DTypeLike, NDArray

from .values import failure
from .wire import HEAD, PAYLOADS, RESULT_HEAD, SLOT_SEQ, SLOT_WORDS, SLOTS_MAX, Status

F_GET_SEALS = 1034
SEALS = 0x0001 | 0x0002 | 0x0004  # SEAL, SHRINK, GROW
SEAL_FUTURE_WRITE = 0x0010
POPULATE_READ, POPULATE_WRITE = 22, 23  # of madvise, Linux 5.14


class Slot:
    """A slot of the upload ring. kept: segments of an answered step whose positions may
    be the last of some object, and stand nowhere else."""

    __slots__ = ("index", "seq", "begun", "sent", "used", "scene", "segments", "step",
                 "kept")

    def __init__(self, index: int) -> None:
        self.index = index
        self.seq = 0
        self.begun = False
        self.sent = False
        self.used = 0
        self.scene = 0
        self.step = 0
        self.segments: List[Tuple[int, ...]] = []
        self.kept = False


class Page:
    """A page of records in the result region; goes back when all before it have."""

    __slots__ = ("ring", "head", "released")

    def __init__(self, ring: Ring, head: int) -> None:
        self.ring = ring
        self.head = head
        self.released = False

    def release(self) -> None:
        pages, head = self.ring.pages, 0
        self.released = True
        while pages and pages[0].released:
            head = pages.popleft().head
        if head:
            self.ring.fence()  # every read of the page comes before the store
            self.ring.words[RESULT_HEAD] = head


def map_memory(fd: int, size: int, writable: bool) -> mmap.mmap:
    """Map a memory of the daemon; without these seals an access could end in SIGBUS."""
    seals = fcntl.fcntl(fd, F_GET_SEALS)
    wanted = SEALS if writable else SEALS | SEAL_FUTURE_WRITE
    if seals & (SEALS | SEAL_FUTURE_WRITE) != wanted or os.fstat(fd).st_size != size:
        raise failure(Status.E_BADMSG, "shm.attach: the memory has other seals or size")
    access = mmap.PROT_READ | mmap.PROT_WRITE if writable else mmap.PROT_READ
    memory = mmap.mmap(fd, size, mmap.MAP_SHARED, access)
    try:  # all pages now: a page fault costs more than a copy of the page
        memory.madvise(POPULATE_WRITE if writable else POPULATE_READ)
    except OSError:
        pass  # an older kernel
    return memory


class Ring:
    """The upload ring and the result region of one shm.attach. Both stay mapped as long
    as anybody holds an array in them."""

    def __init__(self, result: Dict[str, Any], fds: List[int]) -> None:
        if len(fds) != 2:
            raise failure(Status.E_BADMSG, "shm.attach: no two descriptors came")
        count, stride = result["slot_count"], result["slot_stride"]
        size = result["upload_bytes"]
        if not 1 <= count <= SLOTS_MAX or stride % 8 or \
                PAYLOADS + count * stride > size:
            raise failure(Status.E_BADMSG, "shm.attach: slots outside the memory")
        self.upload = map_memory(fds[0], size, True)
        self.result = map_memory(fds[1], result["result_bytes"], False)
        self.words = memoryview(self.upload)[:PAYLOADS].cast("Q")
        self.bytes = np.frombuffer(self.upload, np.uint8)
        self.slot_bytes: int = stride
        self.inflight_max: int = max(1, result["inflight_max"])
        self.slots = [Slot(i) for i in range(count)]
        self.pages: Deque[Page] = collections.deque()
        self._lock = threading.Lock()
        self._lock.acquire()

    def fence(self) -> None:
        """A full fence: a release and an acquire of the same lock, in this order."""
        self._lock.release()
        self._lock.acquire()

    def let_go(self) -> None:
        """From here on nothing that is stored is seen by the daemon: in a forked copy."""
        self.words = memoryview(bytearray(PAYLOADS)).cast("Q")

    def payload(self, slot: Slot) -> NDArray[np.uint8]:
        """The bytes of a slot."""
        first = PAYLOADS + slot.index * self.slot_bytes
        return self.bytes[first:first + self.slot_bytes]

    def store_seq(self, slot: Slot) -> None:
        self.words[SLOT_SEQ + slot.index * SLOT_WORDS] = slot.seq

    def begin(self, slot: Slot) -> None:
        """Odd: being written."""
        slot.begun = True
        slot.segments = []
        slot.used = 0
        slot.seq += 1
        self.store_seq(slot)
        self.fence()

    def publish(self, slot: Slot) -> int:
        """Even: whole. Returns what the request has to name."""
        slot.begun = False
        slot.sent = True
        slot.seq += 1
        self.store_seq(slot)
        self.words[HEAD] += 1
        return slot.seq

    def abort(self, slot: Slot) -> None:
        """Make the slot free, unsent."""
        if slot.begun:
            slot.seq += 1
            self.store_seq(slot)
        slot.begun = slot.sent = False

    def page(self, result: Dict[str, Any]) -> Optional[Page]:
        """Enter the page that an answer names; None when it has none."""
        if not result.get("count") or "release" not in result or "offset" not in result:
            return None
        if not PAYLOADS <= result["offset"] <= len(self.result):
            raise failure(Status.E_BADMSG, "a page outside the result region")
        made = Page(self, result["release"])
        self.pages.append(made)
        return made

    def records(self, result: Dict[str, Any], dtype: DTypeLike) -> NDArray[Any]:
        """The records of a page, where they lie; the array cannot be written."""
        try:
            return np.frombuffer(self.result, dtype, result["count"], result["offset"])
        except ValueError:
            raise failure(Status.E_BADMSG, "a page outside the result region") from None
