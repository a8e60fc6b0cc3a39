"""answer.py - what a step found, or what is near.

Room:     client/python. May import: abi, library, memory, values, numpy.
Does:     struct pccd_answer itself, so that nothing is copied which nobody looks at, and
          its records where they lie.
"""

from __future__ import annotations

import sys
import warnings
from ctypes import byref
from typing import Any, Optional

import numpy as np
from numpy.typing import NDArray

from . import abi
from .abi import Mode, NearWhat, Status
from .library import PccdError, quick
from .memory import Span
from .points import Stencils
from .values import CONTACT, NEAR, PAIR, StepCounters, StepTimes, hash_text, refusal

_contacts: Any = abi.pccd_answer.contacts
_pairs: Any = abi.pccd_answer.pairs
_near: Any = abi.pccd_answer.near
_bounds: Any = abi.pccd_answer.vertex_bounds
_hash: Any = abi.pccd_answer.hash
_tuning: Any = abi.pccd_answer.tuning
_times: Any = abi.pccd_answer.times
_counters: Any = abi.pccd_answer.counters
_release = quick["pccd_answer_release"]  # without types: quicker
_release.restype = None


def _address(answer: abi.pccd_answer) -> Any:
    """Of the records, whatever they are; None or 0: there are none."""
    return _contacts.__get__(answer) or _pairs.__get__(answer) or \
        _near.__get__(answer) or _bounds.__get__(answer)


class Held:
    """What answers have in common: from when one comes until it is released, the memory
    of its records stays, whatever is closed, lost or grown meanwhile."""

    _client: Any = None
    _span: Optional[Span] = None  # None: there are no records, or none any more
    _is_released = False

    def _come(self, client: Any) -> None:
        self._client, base = client, self._base()
        if base:
            self._span = client._memory.span(base)

    def _base(self) -> Any:
        """Where the records are; None or 0: there are none."""
        raise NotImplementedError

    def _refuse_released(self) -> None:
        if self._is_released:
            raise refusal(Status.E_STATE, "the answer is released, and its records with "
                          "it: copy before what is to stay")

    def _go(self) -> None:
        """Give the records back, now or, while another thread is in a call, later."""
        self._span = None
        if not self._client._turn.acquire(False):
            self._client._dropped.append(self._copy())
            return
        try:
            self._give_back(self._client._handle)
        finally:
            self._client._turn.release()

    def _forget(self, in_use: bool) -> None:
        """It is gone, and nobody has released it."""
        if self._span is None or not self._client._handle:
            return
        if in_use:
            warnings.warn("an answer is gone, but not released, and its records are in "
                          "use: their memory is lost to further answers",
                          ResourceWarning)
            return
        # Any thread may get here, in the middle of a call: the client does it later.
        self._client._dropped.append(self._copy())

    def _copy(self) -> Any:
        return type(self).from_buffer_copy(self)  # type: ignore

    def _give_back(self, handle: Any) -> None:
        raise NotImplementedError


class Answer(abi.pccd_answer, Held):
    """The answer to one step. As a context manager it releases its records at the end.

    step        its number, as submit gave it
    error       None, or why the step failed: then nothing else is set, and positions are
                as before
    mode, method, incomplete (0: complete), verdict: enums
    tuning      how the threads shared the work; "": one thread alone
    count, first, cursor    records of this page, index of the first, and of the first
                of the next page
    total, possible, initial    records of the whole answer
    counts      of these, by kind: answer.counts[Kind.VF]
    toi_first   smallest toi; 2 without any record
    safe_step   from t = 0 to this t no pair meets; 0 .. 1, 1: none does
    inside, crowded    records that began within their distance; whether most did,
                or most are coincident
    coincident  records that touch at t = 0 in a vertex of both features
    entering, sliding, leaving    of a step with touching: pairs that touch at t = 0, by
                what becomes of them; of `records` flags tell (ContactFlag.ENTERS ..)
    crossings, start_inside    of a step with tells_start: edges that pass through faces
                at t = 0 (then safe_step is 0); with an approach, pairs within their
                distance then. If there are any, the verdict is not NO
    number      of the step among all of its scene, from 1
    hash        of all records: "2:", its version, and 32 hexadecimal digits
    records     (count,) of CONTACT or PAIR: read-only, in the daemon's memory, and
                meaningless after release(); contacts and pairs are the same by their kind

    Of Client.near and submit_near (is_near is True) not mode, possible, initial,
    toi_first and number, but

    what        enum NearWhat: what was asked
    records     (count,) of NEAR, or of float64 where VERTICES was asked; near and
                vertex_bounds are the same
    counts      by kind: answer.counts[Kind.VV], answer.counts[NearKind.EF]
    distance_min, distance_max    least d_lo and greatest d_hi of the records
    crossings   of CROSSINGS, DEPTH, and with tells_crossings: edges that pass through
                faces
    verdict     of CROSSINGS: NO: nothing crosses or touches
    hash        zeros behind "2:" for NEAREST with a gap: there is none
    """

    error: Optional[PccdError] = None
    _records: Optional[NDArray[Any]] = None

    @property
    def records(self) -> NDArray[Any]:
        """The records of this page. E_STATE: they are released."""
        self._refuse_released()
        if self._span is None:
            return np.empty(0, self._dtype())
        if self._records is None:
            self._records = self._span.array(self._dtype(), self.count)
        return self._records

    def _dtype(self) -> Any:
        if self.is_near:
            return np.dtype(np.float64) if self.what == NearWhat.VERTICES else NEAR
        return PAIR if self.mode == Mode.PAIRS else CONTACT

    def _records_of(self, dtype: Any) -> NDArray[Any]:
        return self.records if self._dtype() is dtype else np.empty(0, dtype)

    @property
    def contacts(self) -> NDArray[Any]:
        """The records of any mode but PAIRS."""
        return self._records_of(CONTACT)

    @property
    def pairs(self) -> NDArray[Any]:
        """The records of mode PAIRS."""
        return self._records_of(PAIR)

    @property
    def near(self) -> NDArray[Any]:
        """The records of what is near."""
        return self._records_of(NEAR)

    @property
    def vertex_bounds(self) -> NDArray[np.float64]:
        """Of VERTICES: for each vertex of all objects, by increasing handle, or of
        object_a, in the order of its mesh, its bound."""
        return self._records_of(np.dtype(np.float64))

    def stencils(self, scene: int) -> Stencils:
        """Vertices, weights, times or distances and normals of the records, which are of
        that scene: Client.bodies(scene) has points and manifolds of them, too."""
        made: Stencils = self._client.bodies(scene).stencils(self.records)
        return made

    @property
    def hash(self) -> str:
        """Of all records of the answer."""
        return hash_text(_hash.__get__(self))

    @property
    def tuning(self) -> str:
        """How the threads shared the work, as StepSettings.tuning."""
        return str(_tuning.__get__(self).decode())

    @property
    def times(self) -> Any:
        """Nanoseconds of the phases: StepTimes."""
        return StepTimes.of(_times.__get__(self))

    @property
    def counters(self) -> Any:
        """What the step did: StepCounters."""
        return StepCounters.of(_counters.__get__(self))

    def release(self) -> None:
        """Give the records back, in any order of answers. Copy before what is to stay."""
        self._is_released = True
        if self._span is not None:
            self._records = None
            self._go()

    def _base(self) -> Any:
        return _address(self)

    def _give_back(self, handle: Any) -> None:
        _release(handle, byref(self))

    def __enter__(self) -> Answer:
        return self

    def __exit__(self, *_: object) -> None:
        self.release()

    def __repr__(self) -> str:
        if self.error is not None:
            return f"<Answer to step {self.step}: {self.error}>"
        what = "pairs" if self.mode == Mode.PAIRS else "contacts"
        if self.is_near:
            what = "bounds" if self.what == NearWhat.VERTICES else "near"
        page = "" if self.count == self.total else f", {self.count} here"
        first = f", the first at {self.toi_first:.6f}" if self.toi_first <= 1 else ""
        return f"<Answer to step {self.step}: {self.total} {what}{page}{first}>"

    def __del__(self) -> None:
        if self._span is not None:
            self._forget(self._records is not None and
                         sys.getrefcount(self._records) > 2)
