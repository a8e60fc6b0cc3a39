"""observe.py - what a daemon tells about itself and its clients.

Room:     client/python. May import: answer, scenes, values, wire, numpy.
Does:     lists, histograms, settings, and the steps that a client is told of.
Source:   client/lib/observe.c, client/lib/watch.c.
"""

from __future__ import annotations

import collections
from typing import Any, Deque, Dict, List, NamedTuple, Optional, Tuple

import numpy as np
from numpy.typing import NDArray

from .answer import hash_text
from .scenes import Scenes
from .values import Options, PccdError, failure
from .wire import FEATURE_OBSERVE, HISTOGRAM_BUCKETS, Status

EVENTS = 256  # steps that wait to be taken; more are lost, and counted
BUCKET_FIRST = 10  # bucket 0 is of less than 2^10 ns


class Histogram(NamedTuple):
    """How long steps or requests took since the daemon's start. counts[i] took less than
    below_ns[i] and are in no bucket before; the last one counts the rest (inf)."""

    total: int
    ns_sum: int
    below_ns: NDArray[np.float64]
    counts: NDArray[np.uint64]


class Setting(NamedTuple):
    """A setting of the daemon that may change while it runs."""

    name: str  # as pccdd's option, without the dashes
    value: str
    text: str  # what it is, and which values it takes
    changed: bool  # since the daemon's start


class StepEvent(NamedTuple):
    """A step of anybody's, as one who watches is told of it."""

    number: int  # of the step in this epoch; 0: it failed
    session: int  # whose
    scene: int  # handle there
    status: int  # 0, or why it failed
    step: int  # the client's number for it
    mode: int
    incomplete: int
    verdict: int
    threads: int
    total: int  # records
    hash: str
    ns_queue: int
    ns_step: int
    lost: int  # steps before this one that were not told, for want of room


class Observe(Scenes):
    """A connection that looks at the daemon."""

    def __init__(self, options: Options) -> None:
        super().__init__(options)
        self._watched: Optional[Tuple[int, int]] = None  # session and scene; None: not
        self._watched_epoch = 0  # of the daemon that was asked
        self._events: Deque[StepEvent] = collections.deque()
        self._events_lost = 0  # here, since the last that was queued

    def _list(self, method: str, key: str, **params: Any) -> List[Dict[str, Any]]:
        """Entry by entry, while others work: it is no snapshot."""
        self._check_feature(FEATURE_OBSERVE, "lists")
        entries: List[Dict[str, Any]] = []
        cursor = 0
        while True:
            entry = dict(self._call(method, cursor=cursor, **params))
            if not entry.get(key):
                return entries
            cursor = entry.pop("next", 0)
            if "hash_hi" in entry:
                entry["hash"] = hash_text(entry)
            entries.append(entry)

    def list_sessions(self) -> List[Dict[str, Any]]:
        """Sessions of this user, the newest first; of everybody for root and the daemon's
        own user. The fields are those of list.session in PROTOCOL.md."""
        self._check_feature(FEATURE_OBSERVE, "lists")
        entries: List[Dict[str, Any]] = []
        before = 0
        while True:
            entry = dict(self._call("list.session", before=before))
            if not entry.get("session"):
                return entries
            before = entry["session"]
            entries.append(entry)

    def list_scenes(self, session: int = 0) -> List[Dict[str, Any]]:
        """The scenes of a session, 0: of this one; fields of list.scene, and hash."""
        return self._list("list.scene", "scene", session=session)

    def list_objects(self, scene: int, session: int = 0) -> List[Dict[str, Any]]:
        """The objects of a scene; fields of list.object."""
        return self._list("list.object", "object", session=session, scene=scene)

    def list_pairs(self, scene: int, session: int = 0) -> List[Dict[str, Any]]:
        """Pairs of objects of a scene that ignore each other; fields of list.pair."""
        return self._list("list.pair", "a", session=session, scene=scene)

    def list_meshes(self, session: int = 0) -> List[Dict[str, Any]]:
        """The meshes of a session; fields of list.mesh."""
        return self._list("list.mesh", "mesh", session=session)

    def histogram(self, kind: int) -> Histogram:
        """How long all steps, or all requests, took: enum HistogramKind."""
        self._check_feature(FEATURE_OBSERVE, "histograms")
        result = self._call("stats.histogram", kind=kind)
        exponents = range(BUCKET_FIRST, BUCKET_FIRST + HISTOGRAM_BUCKETS - 1)
        counts = [result[f"b{n}"] for n in exponents] + [result["above"]]
        below = [float(1 << n) for n in exponents] + [float("inf")]
        return Histogram(result["count"], result["ns_sum"], np.array(below),
                         np.array(counts, np.uint64))

    def config_get(self, name: str) -> Setting:
        """A setting of the daemon. E_INVAL: there is none of that name."""
        self._check_feature(FEATURE_OBSERVE, "settings")
        return self._setting(name=name)[0]

    def config_list(self) -> List[Setting]:
        """All of them."""
        self._check_feature(FEATURE_OBSERVE, "settings")
        setting, count = self._setting(index=0)
        return [setting] + [self._setting(index=i)[0] for i in range(1, count)]

    def _setting(self, **params: Any) -> Tuple[Setting, int]:
        result = self._call("config.get", **params)
        return Setting(result["name"], result["value"], result["text"],
                       bool(result.get("changed", False))), result["count"]

    def config_set(self, name: str, value: str) -> str:
        """Give a setting another value until the daemon ends; returns the one that it
        had. For root and the daemon's own user (E_ACCESS)."""
        self._check_feature(FEATURE_OBSERVE, "settings")
        before: str = self._call("config.set", name=name, value=str(value))["before"]
        return before

    # -- steps that a client is told of --

    def watch_start(self, session: int = 0, scene: int = 0) -> None:
        """Be told of every step from now on: of a session (0: of everybody's, which is
        for root and the daemon's own user), and of one scene of it (0: of all). Nothing
        waits for a client that does not take them. Another daemon is asked again."""
        self._check_feature(FEATURE_OBSERVE, "steps to watch")
        self._watched = (int(session), int(scene))
        self._events.clear()
        self._events_lost = 0
        try:
            self._ask_for_steps()
        except PccdError:
            self._watched = None
            raise

    def watch_next(self, timeout: Optional[float] = None) -> Optional[StepEvent]:
        """The next step; None: none came within the timeout (seconds; None: the client's
        own, 0: without waiting)."""
        if self._watched is None:
            raise failure(Status.E_STATE, "watch_start comes first")
        deadline = self._deadline(timeout)
        while not self._events:
            if self._is_up and self._watched_epoch != self._epoch:
                self._ask_for_steps()  # the daemon that was asked is gone
            elif timeout == 0 and self._is_up:
                if not self._receive():
                    break
            else:
                try:
                    self._progress(deadline)
                except PccdError as problem:
                    if problem.status != Status.E_TIMEOUT:
                        raise
                    break
        return self._events.popleft() if self._events else None

    def watch_stop(self) -> int:
        """No more of that; how many steps the daemon had no room for."""
        lost: int = self._call("watch.stop")["lost"]
        self._watched = None
        self._events.clear()
        return lost

    def _ask_for_steps(self) -> None:
        assert self._watched is not None
        self._call("watch.start", session=self._watched[0], scene=self._watched[1])
        self._watched_epoch = self._epoch

    def _notified(self, method: str, params: Dict[str, Any]) -> None:
        if method != "step" or self._watched is None:
            super()._notified(method, params)
            return
        lost = params.get("lost", 0)
        if len(self._events) >= EVENTS:
            self._events_lost += lost + 1
            return
        self._events.append(StepEvent(
            params["number"], params["session"], params["scene"], -params.get("code", 0),
            params["step"], params.get("mode", 0), params.get("incomplete", 0),
            params.get("verdict", 0), params.get("threads", 0), params.get("total", 0),
            hash_text(params), params.get("ns_queue", 0), params.get("ns_step", 0),
            lost + self._events_lost))
        self._events_lost = 0
