"""observe.py - what a daemon tells about itself and its clients, and recordings.

Room:     client/python. May import: abi, library, scenes, values, numpy.
Does:     counters, lists, histograms, settings, the steps that a client is told of,
          recordings of this session and of the daemon's threads.
Source:   client/lib/pccd.h says of each call what it does.
"""

from __future__ import annotations

import ctypes
import os
from ctypes import byref
from typing import Any, Callable, Dict, List, Optional, Union

import numpy as np
from numpy.typing import NDArray

from . import abi
from .abi import HistogramKind, Status
from .library import lib
from .scenes import Scenes
from .values import (TRACE_EVENT, DaemonInfo, Histogram, RecordInfo, Setting, StepEvent,
                     TraceInfo, as_dict, enumerator, put, u32, with_size)

BUCKET_FIRST = 10  # bucket 0 is of less than 2^10 ns


class Observe(Scenes):
    """A connection that looks at the daemon; Client is all of it."""

    # -- the daemon --

    @property
    def daemon(self) -> Any:
        """What was agreed on when connecting: DaemonInfo."""
        info = abi.pccd_daemon_info()
        self._check(lib.pccd_daemon(self._handle, byref(info)))
        return DaemonInfo.of(info)

    @property
    def daemon_pid(self) -> int:
        """Process id of the daemon; with direct: of this process."""
        return int(lib.pccd_daemon_pid(self._handle))

    @property
    def daemon_cpu(self) -> str:
        """The instruction set of its steps, such as sse2, avx2 or neon, or ""."""
        return str(lib.pccd_daemon_cpu(self._handle).decode())

    @property
    def features(self) -> int:
        """The daemon's feature bits, as in hello of PROTOCOL.md."""
        return int(self.daemon.features)

    def ping(self) -> int:
        """Round trip through the daemon's loop, nanoseconds."""
        took = ctypes.c_uint64()
        self._check(lib.pccd_ping(self._handle, byref(took)))
        return took.value

    def stats(self) -> Dict[str, int]:
        """The counters of the daemon."""
        return self._counters(lambda each: lib.pccd_stats(self._handle, each, None))

    def stats_thread(self, thread: int = 0, any: bool = False) -> Dict[str, int]:
        """What a thread of the last step did: of this client's, or of anybody's (only for
        the daemon's own user). `threads` 0: no step yet."""
        return self._counters(lambda each: lib.pccd_stats_thread(
            self._handle, any, u32("thread", thread), each, None, None))

    def _counters(self, ask: Callable[[Any], Any]) -> Dict[str, int]:
        made: Dict[str, int] = {}

        def each(_context: Any, name: bytes, value: int, _text: bytes) -> None:
            made[name.decode()] = value

        self._check(ask(abi.pccd_stat_fn(each)))
        return made

    # -- lists: entry by entry, while others work; no snapshot --

    def _list(self, callback: Any, ask: Callable[[Any], Any],
              entry_of: Callable[[Any], Any] = as_dict) -> List[Any]:
        made: List[Any] = []
        each = callback(lambda _context, info: made.append(entry_of(info.contents)))
        self._check(ask(each))
        return made

    def list_sessions(self) -> List[Dict[str, Any]]:
        """Sessions of this client's user, the newest first, or of everybody when that
        user is root or the daemon's own; fields of struct pccd_session_info."""
        return self._list(abi.pccd_session_fn, lambda each: lib.pccd_list_sessions(
            self._handle, each, None))

    def list_scenes(self, session: int = 0) -> List[Dict[str, Any]]:
        """The scenes of a session, 0: of this one; fields of struct pccd_scene_info."""
        return self._list(abi.pccd_scene_fn, lambda each: lib.pccd_list_scenes(
            self._handle, session, each, None))

    def list_objects(self, scene: int, session: int = 0) -> List[Dict[str, Any]]:
        """The objects of a scene; fields of struct pccd_object_info."""
        return self._list(abi.pccd_object_fn, lambda each: lib.pccd_list_objects(
            self._handle, session, u32("scene", scene), each, None))

    def list_pairs(self, scene: int, session: int = 0) -> List[Dict[str, Any]]:
        """Pairs of objects of a scene that ignore each other: object_a, object_b."""
        return self._list(abi.pccd_pair_fn, lambda each: lib.pccd_list_pairs(
            self._handle, session, u32("scene", scene), each, None))

    def list_meshes(self, session: int = 0) -> List[Dict[str, Any]]:
        """The meshes of a session; fields of struct pccd_registered_mesh."""
        return self._list(abi.pccd_mesh_fn, lambda each: lib.pccd_list_meshes(
            self._handle, session, each, None))

    def histogram(self, kind: Union[int, str]) -> Histogram:
        """How long all steps, or all requests, took: enum HistogramKind."""
        info = abi.pccd_histogram_info()
        self._check(lib.pccd_histogram(
            self._handle, enumerator(HistogramKind, "kind", kind), byref(info)))
        below = [2.0 ** (BUCKET_FIRST + i) for i in range(len(info.bucket) - 1)]
        return Histogram(info.count, info.ns_sum, np.array(below + [np.inf]),
                         np.array(info.bucket[:], np.uint64))

    # -- settings --

    def config_get(self, name: str) -> Any:
        """A Setting of the daemon. E_INVAL: there is none of that name."""
        return self._settings(name.encode())[0]

    def config_list(self) -> List[Any]:
        """All of them."""
        return self._settings(None)

    def _settings(self, name: Optional[bytes]) -> List[Any]:
        return self._list(abi.pccd_setting_fn, lambda each: lib.pccd_config_get(
            self._handle, name, each, None), Setting.of)

    def config_set(self, name: str, value: str) -> str:
        """Give a setting another value until the daemon ends; returns the one that it
        had. For root and the daemon's own user (E_ACCESS)."""
        before: str = self.config_get(name).value
        self._check(lib.pccd_config_set(self._handle, name.encode(), str(value).encode()))
        return before

    # -- steps that a client is told of --

    def watch_start(self, session: int = 0, scene: int = 0) -> None:
        """Be told of every step from now on: of a session (0: of everybody's, which is
        for root and the daemon's own user), and of one scene of it (0: of all). Nothing
        waits for a client that does not take them. Another daemon is asked again."""
        self._check(lib.pccd_watch_start(self._handle, session, u32("scene", scene)))

    def watch_next(self, timeout: Optional[float] = None) -> Any:
        """The next step, a StepEvent; None: none came within the timeout (seconds; None:
        the client's own, 0: without waiting)."""
        event = abi.pccd_step_event()
        status = self._in_slices(
            lambda ms: lib.pccd_watch_next(self._handle, ms, byref(event)), timeout)
        if status in (Status.E_AGAIN, Status.E_TIMEOUT):
            return None
        self._check(status)
        return StepEvent.of(event)

    def watch_stop(self) -> None:
        """No more of that."""
        self._check(lib.pccd_watch_stop(self._handle))

    # -- recordings of this session --

    def record_start(self, path: Any, *, max_bytes: int = 0, segments: int = 0,
                     contacts: bool = False, level: int = 0, up: str = "") -> None:
        """Write everything that this client asks and is answered to a file, which
        `pccdctl replay` runs again. max_bytes: of all files, 0: no bound. segments: 2 ..
        64: so many files, the oldest of which goes. contacts: the records of answers,
        too. level: of zstd, 1 .. 19; 0 = 1; negative: nothing is compressed. up: the
        axis that points up, "x", "y" or "z", for those who show the recording."""
        if up not in ("", "x", "y", "z"):
            raise ValueError(f"up is '', 'x', 'y' or 'z', not {up!r}")
        settings = with_size(abi.pccd_record_settings(contacts=bool(contacts)))
        for name, given in (("max_bytes", max_bytes), ("segments", segments),
                            ("level", level), ("up", "xyz".find(up) + 1 if up else 0)):
            put(settings, name, given)
        self._check(lib.pccd_record_start(self._handle, os.fsencode(path),
                                          byref(settings)))

    def record(self) -> Any:
        """How it goes: RecordInfo. Its status: 0, or why nothing is recorded any more."""
        info = abi.pccd_record_info()
        self._check(lib.pccd_record(self._handle, byref(info)))
        return RecordInfo.of(info)

    def record_stop(self) -> Any:
        """End it, as close() does."""
        info = self.record()
        if info.status == 0:
            last = abi.pccd_record_info()
            self._check(lib.pccd_record_stop(self._handle, byref(last)))
            return RecordInfo.of(last)
        lib.pccd_record_stop(self._handle, None)
        return info

    def request_handle(self, handle: int) -> None:
        """The next scene, mesh or object that is made gets this handle, if nothing has
        it; else E_HANDLE."""
        self._check(lib.pccd_request_handle(self._handle, u32("handle", handle)))

    # -- recordings of the daemon's threads --

    def trace_start(self, events: int = 0, min_ns: int = 0) -> Any:
        """Record what the daemon does: for its own user, one recording at a time. events:
        to keep of each thread; 0 = 65536 or what fits. TraceInfo: threads, events_max."""
        info = abi.pccd_trace_info()
        self._check(lib.pccd_trace_start(self._handle, u32("events", events), min_ns,
                                         byref(info)))
        return TraceInfo.of(info)

    def trace_stop(self) -> Any:
        """End it. TraceInfo: how many events can be read, and how many are lost."""
        info = abi.pccd_trace_info()
        self._check(lib.pccd_trace_stop(self._handle, byref(info)))
        return TraceInfo.of(info)

    def trace_dump(self) -> NDArray[Any]:
        """The events, (n,) of TRACE_EVENT: those of one thread after those of the other,
        then the loop's and the clients', each in the order of their ends. A copy."""
        parts: List[NDArray[Any]] = [np.empty(0, TRACE_EVENT)]

        def each(_context: Any, events: Any, count: int) -> None:
            data = ctypes.string_at(events, count * TRACE_EVENT.itemsize)
            parts.append(np.frombuffer(data, TRACE_EVENT))

        self._check(lib.pccd_trace_dump(self._handle, abi.pccd_trace_fn(each), None))
        return np.concatenate(parts)
