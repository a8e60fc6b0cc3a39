"""pccd.py - the Python client of pccdd: continuous collision detection as a service.

Room:     client/python; installed. Needs Python 3.9, msgpack and numpy; nothing compiled.
Does:     what libpccd does, over the same protocol: connect to pccdd (or start one),
          register meshes, place them in scenes, write positions straight into shared
          memory, and read the contacts of a step as numpy arrays that lie in the daemon's
          memory. A connection that is lost is made again, to the same session or to the
          next daemon, which is told what there was; every step is answered once.
Does not: spin, start threads, or compute in this process (`direct:` is libpccd's).
Threads:  a client and everything made from it belong to one thread at a time.
Source:   proto/PROTOCOL.md; client/lib/pccd.h says the same of each call in C.

    import pccd

    with pccd.connect() as client:
        scene = client.scene_create()
        mesh = client.mesh_create(x0, triangles)     # (n, 3) float32 or float64, (m, 3)
        cloth = client.scene_add(scene, mesh)
        for x1 in frames:
            with client.step_x1(scene, cloth, x1) as answer:
                print(answer.count, answer.contacts["toi"].min(initial=2.0))

Every failure is a PccdError with the daemon's status, its name and a text for people.
Times are in seconds where they are given, in nanoseconds where their name ends in _ns.
"""

from __future__ import annotations

import os
import sys
import time
import weakref
from types import TracebackType
from typing import Any, Dict, Iterable, Iterator, List, Optional, Tuple, Type

import numpy as np
from numpy.typing import ArrayLike, NDArray

from _pccd.answer import Answer, Result
from _pccd.frame import Frame
from _pccd.keep import Kept
from _pccd.link import Call
from _pccd.observe import Histogram, Observe, Setting, StepEvent
from _pccd.ring import Ring, Slot
from _pccd.scenes import ObjectSettings, SceneNews
from _pccd.values import (SOCKET_BYTES, LinkInfo, MeshInfo, Options, PccdError,
                          StepCounters, StepSettings, StepTimes, default_socket_path,
                          failure, pack_vertices)
from _pccd.wire import (BOX, CONTACT, EDGE, FEATURE_HELD, FEATURE_RESUME, PAIR,
                        RESULT_BYTES_MIN, SEGMENT, SEGMENTS_MAX, SLOT_BYTES_MIN,
                        SLOTS_MAX, TRACE_EVENT, ContactFlag, Format, HighLevel,
                        HistogramKind, Incomplete, Kind, Method, Mode, ObjectWhat,
                        Quality, Refit, Scheduler, Share, Status, TraceKind, Tree,
                        Verdict)

__version__ = "0.1.0"

__all__ = [
    "Answer", "BOX", "Client", "connect", "CONTACT", "ContactFlag", "default_socket_path",
    "EDGE", "Format", "Frame", "HighLevel", "Histogram", "HistogramKind", "Incomplete",
    "Kind", "LinkInfo", "MeshInfo", "Method", "Mode", "ObjectSettings", "ObjectWhat",
    "PAIR", "PccdError", "Quality", "Refit", "Result", "SceneNews", "Scheduler",
    "Setting", "Share", "Status", "StepCounters", "StepEvent", "StepSettings",
    "StepTimes", "TRACE_EVENT", "TraceKind", "Tree", "Verdict",
]

STEPS = 32  # submitted, answers not taken
PAGES = 256  # of records, not released


class Client(Observe):
    """A connection to the daemon; made by connect(). As a context manager it closes
    itself. Handles (of scenes, meshes, objects) are integers and stay the same when
    another daemon takes over. `call` reaches every method of the protocol."""

    def __init__(self, options: Options) -> None:
        super().__init__(options)
        self._steps: Dict[int, Call] = {}  # submitted and not taken
        self._finalizer = weakref.finalize(self, self._daemon.stop)

    def close(self) -> None:
        """End the session; what the daemon holds for it is freed. Arrays of answers that
        are still held stay readable."""
        self._bye()
        self._close_socket()
        self._dead = failure(Status.E_DISCONNECTED, "the client is closed")
        self._steps.clear()
        self._ring = None
        self._kept = None
        self._finalizer()

    def __enter__(self) -> Client:
        return self

    def __exit__(self, kind: Optional[Type[BaseException]],
                 value: Optional[BaseException], trace: Optional[TracebackType]) -> None:
        self.close()

    def fileno(self) -> int:
        """The socket, to watch for readability in a loop of one's own; then poll()."""
        return -1 if self._socket is None else self._socket.fileno()

    @property
    def daemon_pid(self) -> int:
        """Process id of the daemon."""
        return self._pid

    @property
    def daemon_cpu(self) -> str:
        """The instruction set of its steps: scalar, sse4, avx2, avx512, neon, or ""."""
        return self._cpu

    @property
    def features(self) -> int:
        """The daemon's feature bits, as in hello of PROTOCOL.md."""
        return self._features

    def call(self, method: str, /, **params: Any) -> Result:
        """Any request of PROTOCOL.md, and its answer. A page of records that it brings is
        `result.records(dtype)` until `result.release()`. What is made so is not told to
        another daemon."""
        return self._wait(self._send(method, params))

    def ping(self) -> int:
        """Round trip through the daemon's loop, nanoseconds."""
        begin = time.perf_counter_ns()
        self._call("ping", token=begin & 0xFFFFFFFF)
        return time.perf_counter_ns() - begin

    def stats(self) -> Dict[str, Any]:
        """The counters of the daemon."""
        return self._call("stats")

    def stats_thread(self, thread: int = 0, any: bool = False) -> Dict[str, Any]:
        """What a thread of the last step did: of this client's, or of anybody's (only for
        the daemon's own user). `threads` 0: no step yet."""
        return self._call("stats.thread", thread=thread, any=any)

    # -- meshes; scenes and objects: _pccd/scenes.py --

    def mesh_create(self, x: ArrayLike, triangles: ArrayLike) -> int:
        """Register a mesh, x: (n, 3) float32 or float64, triangles: (m, 3) vertex
        indices. Copied. E_NOTFINITE, E_INDEX, E_QUOTA, E_LIMIT, E_INVAL."""
        return self._register(0, x, triangles)

    def mesh_replace(self, mesh: int, x: ArrayLike, triangles: ArrayLike) -> MeshInfo:
        """Give a mesh, and every object made of it, other vertices and triangles, at the
        positions given here; on failure they go on as they were."""
        if mesh == 0:
            raise failure(Status.E_HANDLE, "mesh.replace: there is no mesh 0")
        return self._infos[self._register(int(mesh), x, triangles)]

    def mesh_info(self, mesh: int) -> MeshInfo:
        """What the daemon said when the mesh was made or replaced last."""
        if mesh not in self._infos:
            raise failure(Status.E_HANDLE, f"no mesh 0x{mesh:x}")
        return self._infos[mesh]

    def mesh_edges(self, mesh: int) -> NDArray[np.uint32]:
        """The unique edges (edge_count, 2) in the order of the records' feature numbers:
        vertex indices, the lower one first."""
        self._reserve(SLOT_BYTES_MIN)
        edges = np.empty(self.mesh_info(mesh).edge_count, EDGE)
        first = 0
        while first < len(edges):
            with self.call("mesh.edges", mesh=mesh, first=first,
                           count=len(edges) - first) as page:
                if not 0 < page["count"] <= len(edges) - first:
                    raise failure(Status.E_BUSY, "mesh.edges: no room in the result "
                                  "region: release answers first")
                edges[first:first + page["count"]] = page.records(EDGE)
                first += page["count"]
        return edges.view(np.uint32).reshape(-1, 2)

    def mesh_destroy(self, mesh: int) -> None:
        """Drop a mesh; objects made of it stay."""
        kept = self._kept
        self._wait(self._send("mesh.destroy", {"mesh": mesh}, then=lambda call: (
            kept.remove_mesh(mesh) if kept is not None else None)))
        self._infos.pop(mesh, None)

    def scene_boxes(self, scene: int, tree: Tree, level: int) -> NDArray[np.void]:
        """The boxes (BOX) of a level of a scene's hierarchies, the root being level 0,
        as the last step that used the tree left them; none beyond the last level."""
        self._reserve(SLOT_BYTES_MIN)
        boxes = np.empty(0, BOX)
        count = 1
        while len(boxes) < count:
            with self.call("scene.boxes", scene=scene, tree=int(tree), level=level,
                           first=len(boxes), count=0xffffffff) as page:
                count = page["boxes"]
                if page["count"] == 0 and len(boxes) < count:
                    raise failure(Status.E_BUSY, "scene.boxes: no room in the result "
                                  "region: release answers first")
                boxes = np.concatenate([boxes, page.records(BOX)])
        return boxes

    # -- steps --

    def frame(self, scene: int, payload_bytes: int, segment_max: int = 1) -> Frame:
        """Take a free slot for a step of up to segment_max segments and payload_bytes of
        positions: 12 (float32) or 24 (float64) a vertex, twice that for both ends, 192
        for a rigid segment. Waits for a slot while all are in flight. E_BUSY: all are
        begun, 32 answers wait to be taken, or the ring must grow while frames are
        begun."""
        if not 0 <= segment_max <= SEGMENTS_MAX:
            raise failure(Status.E_LIMIT, f"a step has at most {SEGMENTS_MAX} segments, "
                          f"not {segment_max}")
        table = (segment_max * SEGMENT.size + 63) // 64 * 64
        limit = table + segment_max * 16 + (int(payload_bytes) + 7) // 8 * 8
        self._check_steps()
        self._reserve(limit)
        ring, slot = self._begin_slot()
        slot.scene = int(scene)
        slot.used = table
        return Frame(ring, slot, segment_max, limit, self._commit, self._abort)

    def submit_still(self, scene: int, settings: StepSettings = StepSettings()) -> int:
        """A step in which nothing moves; its number."""
        self._check_steps()
        self._reserve(SLOT_BYTES_MIN)
        return self._submit(int(scene), None, 0, settings)

    def poll(self) -> Optional[Answer]:
        """A finished answer, the oldest first, without waiting; None if there is none. A
        step that failed is an answer, too: `error` says why."""
        while self._receive():
            pass
        if not self._is_up and self._dead is None:
            self._poll_recovery()
        for step, call in self._steps.items():
            if call.is_done:
                return self._take_answer(step)
        if self._dead is not None:
            raise self._gone()
        return None

    def wait(self, step: int, timeout: Optional[float] = None) -> Answer:
        """The answer to a step; None: within the client's timeout. E_TIMEOUT: not yet.
        Raises what the step failed with."""
        call = self._find_step(step)
        deadline = self._deadline(timeout)
        while not call.is_done:
            self._progress(deadline)
        answer = self._take_answer(step)
        if answer.error is not None:
            raise answer.error
        return answer

    def wait_held(self, step: int, timeout: Optional[float] = None) -> None:
        """Wait until a frame that was committed with hold=True waits for another client's
        step: the next step of the scene takes it along. Returns as well when it has been
        answered. E_TIMEOUT; E_INVAL: no such step, or not to hold; E_VERSION: the daemon
        does not tell."""
        self._check_feature(FEATURE_HELD, "word of what it holds")
        call = self._find_step(step)
        if not call.is_to_hold:
            raise failure(Status.E_INVAL, f"step {step} is not to hold")
        deadline = self._deadline(timeout)
        while not call.is_done and step not in self._waiting:
            self._progress(deadline)

    def fetch(self, scene: int, step: int, cursor: int) -> Answer:
        """The page that begins at `cursor`, of the answer to `step`, the last of `scene`.
        Release the page at hand first when the region is full. E_STATE: the answer is
        gone."""
        self._check_steps()
        call = self._send("frame.fetch", {"scene": scene, "step": step, "cursor": cursor})
        return Answer(step, self._wait(call))

    def pages(self, scene: int, answer: Answer) -> Iterator[Answer]:
        """An answer, then its further pages; each is released when the next is asked
        for."""
        page = answer
        while True:
            with page:
                yield page
            cursor = page.cursor
            if page.incomplete != Incomplete.RESULT_FULL or cursor >= answer.total:
                return
            page = self.fetch(scene, answer.step, cursor)
            if page.count == 0:
                raise failure(Status.E_BUSY, "no room in the result region: release "
                              "answers first")

    def cancel(self, step: int) -> None:
        """Stop a submitted step: its answer comes with incomplete = CANCELLED, unless it
        was done."""
        call = self._find_step(step)
        if not call.is_done:
            self._call("cancel", id=call.id)

    def step_x1(self, scene: int, object: int, x1: ArrayLike,
                settings: StepSettings = StepSettings()) -> Answer:
        """Move one object to x1 (n, 3), all its vertices, and wait for the answer. On
        E_TIMEOUT the step is cancelled."""
        end = pack_vertices("x1", x1)
        with self.frame(scene, end.nbytes) as frame:
            frame.x1(object, len(end), dtype=end.dtype)[:] = end
            return self._finish_step(frame.commit(settings))

    def step_x0x1(self, scene: int, object: int, x0: ArrayLike, x1: ArrayLike,
                  settings: StepSettings = StepSettings()) -> Answer:
        """The same from x0 to x1, of one shape."""
        begin, end = pack_vertices("x0", x0), pack_vertices("x1", x1)
        if begin.shape != end.shape:
            raise failure(Status.E_INVAL, f"x0 is {begin.shape} and x1 {end.shape}")
        dtype = np.result_type(begin, end)
        with self.frame(scene, 2 * end.size * dtype.itemsize) as frame:
            to0, to1 = frame.x0x1(object, len(end), dtype=dtype)
            to0[:], to1[:] = begin, end
            return self._finish_step(frame.commit(settings))

    # -- recordings --

    def trace_start(self, events: int = 0, min_ns: int = 0) -> Dict[str, Any]:
        """Record what the daemon does: for its own user, one recording at a time. events:
        to keep of each thread; 0 = 65536 or what fits. Returns threads and events."""
        return self._call("trace.start", events=events, min_ns=min_ns)

    def trace_stop(self) -> Dict[str, Any]:
        """End it. Returns how many events can be read, and how many are lost."""
        return self._call("trace.stop")

    def trace_dump(self) -> NDArray[Any]:
        """The events, (n,) of TRACE_EVENT: those of one thread after those of the other,
        then the loop's and the clients', each in the order of their ends. A copy."""
        self._reserve(SLOT_BYTES_MIN)
        parts: List[NDArray[Any]] = [np.empty(0, TRACE_EVENT)]
        cursor, count = 0, 1
        while cursor < count:
            with self.call("trace.dump", cursor=cursor, count=1 << 14) as page:
                count = page["events"]
                if page["count"] == 0 and cursor < count:
                    raise failure(Status.E_BUSY, "trace.dump: no room in the result "
                                  "region: release answers first")
                parts.append(page.records(TRACE_EVENT).copy())
                cursor += page["count"]
        return np.concatenate(parts)

    # -- steps in flight --

    def _check_steps(self) -> None:
        if len(self._steps) >= STEPS:
            raise failure(Status.E_BUSY,
                          f"{len(self._steps)} steps wait to be taken: poll or wait")
        if self._ring is not None and len(self._ring.pages) >= PAGES:
            raise failure(Status.E_BUSY,
                          f"{len(self._ring.pages)} answers are not released")

    def _commit(self, ring: Ring, payload: NDArray[np.uint8], slot: Slot,
                settings: StepSettings) -> int:
        now = self._ring
        if now is None:
            raise failure(Status.E_STATE, "the frame's ring is gone")
        if now is not ring:  # a daemon that took over in between has another memory
            now.payload(slot)[:slot.used] = payload[:slot.used]
        return self._submit(slot.scene, slot, now.publish(slot), settings)

    def _submit(self, scene: int, slot: Optional[Slot], seq: int,
                settings: StepSettings) -> int:
        step = self._next_step
        self._next_step += 1
        params = {"scene": scene, "segments": 0, "step": step}
        params.update(settings.params())
        if slot is not None:
            params.update(slot=slot.index, seq=seq, segments=len(slot.segments))
        call = self._send("frame.submit", params, slot, self._step_answered, step=step)
        call.is_to_hold = settings.hold
        self._steps[step] = call
        return step

    def _abort(self, slot: Slot) -> None:
        if self._ring is not None:
            self._ring.abort(slot)

    def _step_answered(self, call: Call) -> None:
        if self._kept is not None and call.slot is not None:
            self._kept.answered(call.slot, call.step)

    def _find_step(self, step: int) -> Call:
        call = self._steps.get(step)
        if call is None and self._dead is not None:
            raise self._gone()
        if call is None:
            raise failure(Status.E_INVAL, f"step {step} is not pending")
        return call

    def _take_answer(self, step: int) -> Answer:
        call = self._steps.pop(step)
        self._waiting.discard(step)
        return Answer(step, call.result, call.error)

    def _finish_step(self, step: int) -> Answer:
        try:
            return self.wait(step)
        except BaseException:
            call = self._steps.pop(step, None)
            if call is not None:  # nobody will ask for it again
                self._drop(call)
                self._cancel_at_once(call)
            raise

    def _cancel_at_once(self, call: Call) -> None:
        """Without waiting; it saves work, and nothing depends on it."""
        try:
            if not call.is_done and self._is_up:
                self._drop(self._send("cancel", {"id": call.id}, deadline=0.0))
        except PccdError:
            pass

    def _poll_recovery(self) -> None:
        if time.monotonic() < self._retry_at:
            time.sleep(0.001)  # whoever watches the descriptor would spin
        try:
            self._recover(0.0)
        except PccdError as problem:
            if problem.status != Status.E_TIMEOUT:
                raise


def connect(url: Optional[str] = None, *, private: bool = False,
            daemon: Optional[str] = None, autostart: bool = True,
            name: Optional[str] = None, timeout: float = 30.0, slot_count: int = 0,
            slot_bytes: int = 0, result_bytes: int = 0, reconnect: float = 10.0,
            keep: bool = True, daemons_max: int = 4) -> Client:
    """Connect to the daemon.

    url           "unix:PATH"; None: $PCCD_URL, else the user's own socket, where a daemon
                  is started when nobody listens
    private       start a daemon of our own on a socket of our own, gone with us, whatever
                  PCCD_URL says
    daemon        program to start; None: $PCCD_DAEMON, else pccdd installed or in $PATH
    autostart     whether to start one at all
    name          of this client, for the daemon's log; None: the program's
    timeout       seconds, of every call that waits
    slot_count    of the upload ring, 1 .. 16; 0 = 4
    slot_bytes    payload of one slot; 0 = grown to what is needed
    result_bytes  result region; 0 = 64 MiB
    reconnect     seconds to look for a daemon that was lost; 0: its loss is an error
    keep          keep copies of meshes and positions for another daemon
    daemons_max   a request over which so many daemons have ended fails
    """
    if sys.byteorder != "little":
        raise failure(Status.E_LIMIT, "the protocol's memory is little-endian")
    _check_options(private, url, autostart, (
        ("timeout", timeout, 1e-3, 3600), ("reconnect", reconnect, 0, 3600),
        ("slot_count", slot_count, 0, SLOTS_MAX), ("daemons_max", daemons_max, 1, 1e9),
        ("slot_bytes", slot_bytes or SLOT_BYTES_MIN, SLOT_BYTES_MIN, 1 << 48),
        ("result_bytes", result_bytes or RESULT_BYTES_MIN, RESULT_BYTES_MIN, 1 << 48)))
    way, path = ("private", "") if private else _choose_way(url)
    title = name if name is not None else os.path.basename(sys.argv[0]) or "python"
    client = Client(Options(timeout, reconnect, keep, daemons_max, title[:63], daemon,
                            autostart, slot_count, slot_bytes, result_bytes))
    try:
        client._connect(way, path)
    except BaseException:
        client.close()
        raise
    # A daemon that cannot be told the old handles cannot be told anything.
    if reconnect > 0 and keep and client.features & FEATURE_RESUME:
        client._kept = Kept()
    return client


def _check_options(private: bool, url: Optional[str], autostart: bool,
                   ranges: Iterable[Tuple[str, float, float, float]]) -> None:
    if private and (url is not None or not autostart):
        raise failure(Status.E_INVAL, "private excludes url and autostart=False")
    for what, value, least, most in ranges:
        if not least <= value <= most:
            raise failure(Status.E_INVAL, f"{what} is {value}, not {least} .. {most}")


def _choose_way(url: Optional[str]) -> Tuple[str, str]:
    """What the url, or the environment, leads to: "url" or "user", and the path."""
    chosen = url if url is not None else os.environ.get("PCCD_URL") or None
    if chosen is None:
        return "user", default_socket_path()
    if chosen.startswith("direct:"):
        raise failure(Status.E_INVAL, "direct: is libpccd's, this client has no compiled "
                      "code; private=True starts a daemon of its own")
    if not chosen.startswith("unix:") or chosen == "unix:":
        raise failure(Status.E_INVAL, f'url "{chosen[:200]}" is not unix:PATH')
    if len(os.fsencode(chosen[5:])) > SOCKET_BYTES:
        raise failure(Status.E_INVAL, f'the path of "{chosen[:200]}" is longer than '
                      f"{SOCKET_BYTES}")
    return "url", chosen[5:]
