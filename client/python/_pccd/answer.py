"""answer.py - what a step found, and what any other request brought.

Room:     client/python. May import: ring, wire, values, numpy.
Does:     the fields of an answer, and its records where they lie.
"""

from __future__ import annotations

import sys
import warnings
from typing import Any, Dict, Optional

import numpy as np
from numpy.typing import DTypeLike, NDArray

from .ring import Page
from .values import PccdError, StepCounters, StepTimes, failure
from .wire import CONTACT, PAIR, Mode, Status, Verdict


def hash_text(result: Dict[str, Any]) -> str:
    """Of the records of an answer, as `pccdctl check --json` writes it."""
    return f"{result.get('hash_hi', 0):016x}{result.get('hash_lo', 0):016x}"


class Result(Dict[str, Any]):
    """The fields of an answer, and the page of records that came with it, if any."""

    page: Optional[Page] = None

    def __missing__(self, key: str) -> Any:
        raise failure(Status.E_BADMSG, f"an answer without {key}")

    def records(self, dtype: DTypeLike) -> NDArray[Any]:
        """The records of the page, until release()."""
        if self.page is None or self.page.released:
            return np.empty(0, dtype)
        return self.page.ring.records(self, dtype)

    def release(self) -> None:
        """Give the page back. Nothing may look at its records afterwards."""
        if self.page is not None:
            self.page.release()

    def __enter__(self) -> Result:
        return self

    def __exit__(self, *_: object) -> None:
        self.release()


class Answer:
    """The answer to one step. As a context manager it releases its records at the end.

    step        its number, as submit gave it
    error       None, or why the step failed: then nothing else is set, and positions are
                as before
    mode, method, incomplete (0: complete), verdict, scheduler, high_level, refit: enums
    count, first, cursor    records of this page, index of the first, and of the first
                of the next page
    total, vf, ee, possible, initial    records of the whole answer
    toi_first   smallest toi; 2 without any record
    number      of the step among all of its scene, from 1
    hash        XXH3-128 over all records, 32 hexadecimal digits
    records     (count,) of CONTACT or PAIR: read-only, in the daemon's memory, and
                meaningless after release(); contacts and pairs are the same by their kind
    """

    def __init__(self, step: int, result: Result,
                 error: Optional[PccdError] = None) -> None:
        self._page = result.page
        self._result = result
        self.step: int = result.get("step", step)
        self.error = error
        self.mode: int = result.get("mode", 0)
        self.incomplete: int = result.get("incomplete", 0)
        self.verdict: int = result.get("verdict", Verdict.NONE)
        self.count: int = result.get("count", 0)
        self.first: int = result.get("first", 0)
        self.cursor: int = result.get("cursor", 0)
        self.total: int = result.get("total", 0)
        self.vf: int = result.get("vf", 0)
        self.ee: int = result.get("ee", 0)
        self.possible: int = result.get("possible", 0)
        self.initial: int = result.get("initial", 0)
        self.toi_first: float = result.get("toi_first", 2.0)
        self.number: int = result.get("number", 0)
        self.threads: int = result.get("threads", 0)
        self.method: int = result.get("method", 0)
        self.scheduler: int = result.get("scheduler", 0)
        self.high_level: int = result.get("high_level", 0)
        self.refit: int = result.get("refit", 0)
        dtype = PAIR if self.mode == Mode.PAIRS else CONTACT
        if result.page is None:
            self.records: NDArray[Any] = np.empty(0, dtype)
            return
        size = result.get("record_bytes")
        if size != dtype.itemsize:
            raise failure(Status.E_BADMSG, f"records of {size} bytes")
        self.records = result.records(dtype)

    @property
    def contacts(self) -> NDArray[Any]:
        """The records of any mode but PAIRS."""
        return self.records if self.mode != Mode.PAIRS else np.empty(0, CONTACT)

    @property
    def pairs(self) -> NDArray[Any]:
        """The records of mode PAIRS."""
        return self.records if self.mode == Mode.PAIRS else np.empty(0, PAIR)

    @property
    def hash(self) -> str:
        """Of all records of the answer."""
        return hash_text(self._result)

    @property
    def times(self) -> StepTimes:
        """Nanoseconds of the phases."""
        result = self._result
        return StepTimes(*(result.get("ns_" + name, 0) for name in StepTimes._fields))

    @property
    def counters(self) -> StepCounters:
        """What the step did."""
        return StepCounters(*(self._result.get(name, 0) for name in StepCounters._fields))

    def release(self) -> None:
        """Give the records back, in any order of answers. Copy before what is to stay."""
        if self._page is not None and not self._page.released:
            self.records = self.records[:0].copy()
            self._page.release()

    def __enter__(self) -> Answer:
        return self

    def __exit__(self, *_: object) -> None:
        self.release()

    def __del__(self) -> None:
        page: Optional[Page] = getattr(self, "_page", None)
        if page is None or page.released:
            return
        if sys.getrefcount(self.records) <= 2:  # ours and the argument: nobody reads them
            page.release()
        else:
            warnings.warn("an answer is gone, but not released, and its records are in "
                          "use: their memory is lost to further answers",
                          ResourceWarning)
