"""client.py - a connection, and the steps that it asks for.

Room:     client/python. May import: everything beside it.
Does:     connect and close; submit, wait, poll, fetch, cancel.
Source:   client/lib/pccd.h says of each call what it does.
"""

from __future__ import annotations

import collections
import ctypes
import os
import sys
import weakref
from ctypes import byref
from types import TracebackType
from typing import (Any, Deque, Dict, Iterable, Iterator, Optional, Sequence, Tuple,
                    Type, Union)

from numpy.typing import ArrayLike, NDArray

from . import abi
from .abi import Format, NearWhat, Status
from .answer import Answer
from .batch import Batch, BatchAnswer, Part, new_answer
from .frame import DEFAULT, Frame, Motions
from .library import failure, lib, one_thread_at_a_time, quick
from .memory import Memory
from .observe import Observe
from .scenes import SLICE_MS
from .values import (LinkInfo, StepSettings, format_of, milliseconds, near_settings,
                     pack_vertices, put, refusal, truth, u32)

# Of every step: without types, which makes a call quicker by half. Whatever is passed is
# an int of 32 bits or an object of ctypes.
_submit = ctypes.CDLL(lib._name)["pccd_submit"]
_wait = ctypes.CDLL(lib._name)["pccd_wait"]
ANSWER_BYTES = ctypes.sizeof(Answer)


def _close(handle: ctypes.c_void_p, _memory: Memory, turn: Any) -> None:
    """Of a client that is closed or gone; its memory's function is called meanwhile."""
    if turn.acquire(timeout=1):  # else the program ends while a thread of it is in a call
        value, handle.value = handle.value, None
        lib.pccd_close(value)
        turn.release()


@one_thread_at_a_time
class Client(Observe):
    """A connection to the daemon; made by connect(). As a context manager it closes
    itself. Handles (of scenes, meshes, objects) are integers and stay the same when
    another daemon takes over."""

    def __init__(self, options: abi.pccd_options) -> None:
        super().__init__(options.timeout_ms / 1000)
        self._memory = Memory()
        self._dropped: Deque[Any] = collections.deque()  # what nobody gave back
        self._slice_ms = min(SLICE_MS, options.timeout_ms)
        options.unmap = self._memory.unmap
        self._keeps = not options.no_keep
        status = lib.pccd_connect(byref(options), byref(self._handle))
        if status:
            raise failure(None, status)
        self._finalizer = weakref.finalize(self, _close, self._handle, self._memory,
                                           self._turn)

    def close(self) -> None:
        """End the session; what the daemon holds for it is freed. Arrays of answers that
        are still held, and their records, stay readable."""
        self._settle()
        self._finalizer()

    def __enter__(self) -> Client:
        return self

    def __exit__(self, kind: Optional[Type[BaseException]],
                 value: Optional[BaseException], trace: Optional[TracebackType]) -> None:
        self.close()

    def __repr__(self) -> str:
        return f"<Client of {self.url}>" if self._handle else "<Client, closed>"

    def fileno(self) -> int:
        """A descriptor to watch for readability in a loop of one's own; then poll()."""
        return int(quick.pccd_fd(self._handle))

    @property
    def url(self) -> str:
        """"unix:PATH" of the daemon, for other processes to connect to, or "direct:"."""
        return os.fsdecode(quick.pccd_url(self._handle))

    @property
    def link_info(self) -> Any:
        """What became of lost connections: LinkInfo."""
        info = abi.pccd_link_info()
        self._check(quick.pccd_link(self._handle, byref(info)))
        return LinkInfo.of(info)

    # -- answers --

    def _settle(self) -> None:
        """Give back what nobody holds any more."""
        while self._dropped:
            self._dropped.popleft()._give_back(self._handle)

    def _new_answer(self) -> Answer:
        """Room for one; what nobody holds any more is given back first."""
        self._settle()
        return Answer(ANSWER_BYTES)

    def _finish(self, step: ctypes.c_uint64) -> Answer:
        """The answer to a step, which nobody else can wait for."""
        answer = self._new_answer() if self._dropped else Answer(ANSWER_BYTES)
        try:
            status = _wait(self._handle, step, self._slice_ms, byref(answer))
            if status:
                if status == Status.E_TIMEOUT:
                    status = self._in_slices(lambda ms: lib.pccd_wait(
                        self._handle, step, ms, byref(answer)), None)
                self._check(status)
        except BaseException:
            lib.pccd_abandon(self._handle, step)
            raise
        answer._come(self)
        return answer

    # -- steps --

    def frame(self, scene: int, payload_bytes: int, segment_max: int = 1) -> Frame:
        """Take a free slot for a step of up to segment_max segments and payload_bytes of
        positions: 12 (float32) or 24 (float64) a vertex, twice that for both ends, 192
        for a rigid segment. Waits for a slot while all are in flight. E_BUSY: all are
        begun, 32 answers wait to be taken, or the ring must grow while frames are
        begun."""
        made = abi.pccd_frame()
        self._check(lib.pccd_frame_begin(self._handle, u32("scene", scene),
                                         u32("segment_max", segment_max),
                                         int(payload_bytes), byref(made)))
        return Frame(self, made)

    def submit(self, scene: int, motions: Motions,
               settings: StepSettings = DEFAULT) -> int:
        """A step in which several objects move; its number."""
        return self._submit(scene, motions._structs, motions._count,
                            motions._step_settings(settings)).value

    def _submit(self, scene: int, motions: Any, count: int,
                settings: Any) -> ctypes.c_uint64:
        step = ctypes.c_uint64()
        if scene.__class__ is not int or scene >> 32:
            scene = u32("scene", scene)
        status = _submit(self._handle, scene, motions, count, settings, byref(step))
        if status:
            raise self._failure(status)
        return step

    def submit_still(self, scene: int, settings: StepSettings = DEFAULT) -> int:
        """A step in which nothing moves; its number."""
        step = ctypes.c_uint64()
        self._check(lib.pccd_submit_still(self._handle, u32("scene", scene),
                                          settings._as_parameter_, byref(step)))
        return step.value

    def step(self, scene: int, motions: Motions,
             settings: StepSettings = DEFAULT) -> Answer:
        """The same as submit, and wait for the answer. On E_TIMEOUT the step is
        abandoned."""
        return self._finish(self._submit(scene, motions._structs, motions._count,
                                         motions._step_settings(settings)))

    def step_safe(self, scene: int, motions: Motions, x: Sequence[NDArray[Any]],
                  settings: StepSettings = DEFAULT) -> Tuple[float, Answer]:
        """Go as far as nothing meets: the part of the way, 0 .. 1, and the answer to the
        whole step. Each of the motions is an x0x1; its vertices come to the array of x at
        its place, of the same shape and type: x0 + part (x1 - x0), rounded. Or it is
        rigid, and x has an array (3, 4) of float64 for m0 + part (m1 - m0), which is no
        rotation where it turns; or it hangs on a joint, and x has such an array for its
        transform, while all joints have gone to begin + part (end - begin).
        The step from the begin to these, which is where the
        objects then are, was tested, too: nothing meets in it. part is 0 where something
        meets at once."""
        if len(x) != motions._count:
            raise refusal(Status.E_INVAL, f"{motions._count} motions and {len(x)} arrays")
        for k, array in enumerate(x):
            motion = motions._structs[k]
            is_rigid = not motion.x1  # or hangs on a joint
            Motions._check(f"x[{k}]", array, (3, 4) if is_rigid else (motion.count, 3))
            wanted = Format.F64 if is_rigid else motion.format
            if format_of(array.dtype) != wanted or not array.flags.writeable:
                raise refusal(Status.E_INVAL,
                              f"x[{k}] is {array.dtype}, or not writeable")
        to = (ctypes.c_void_p * max(len(x), 1))(*(array.ctypes.data for array in x))
        part, answer = ctypes.c_double(), self._new_answer()
        self._check(lib.pccd_step_safe(self._handle, u32("scene", scene),
                                       motions._structs, motions._count,
                                       motions._step_settings(settings), to, byref(part),
                                       byref(answer)))
        answer._come(self)
        return part.value, answer

    def step_x1(self, scene: int, object: int, x1: ArrayLike,
                settings: StepSettings = DEFAULT) -> Answer:
        """Move one object to x1 (n, 3), all its vertices, and wait for the answer. On
        E_TIMEOUT the step is abandoned. E_SEGMENT: it has fewer vertices, or more."""
        return self._step_one(scene, object, None, pack_vertices("x1", x1), settings)

    def step_x0x1(self, scene: int, object: int, x0: ArrayLike, x1: ArrayLike,
                  settings: StepSettings = DEFAULT) -> Answer:
        """The same from x0 to x1, of one shape."""
        begin, end = pack_vertices("x0", x0), pack_vertices("x1", x1)
        if begin.shape != end.shape:
            raise refusal(Status.E_INVAL, f"x0 is {begin.shape} and x1 {end.shape}")
        if begin.dtype != end.dtype:
            begin, end = begin.astype("f8"), end.astype("f8")
        return self._step_one(scene, object, begin, end, settings)

    def _step_one(self, scene: int, object: int, begin: Any, end: Any,
                  settings: StepSettings) -> Answer:
        object = u32("object", object)
        self._check_whole(u32("scene", scene), object, len(end))
        motion = abi.pccd_motion(object=object, count=len(end),
                                 format=format_of(end.dtype), x1=end.ctypes.data,
                                 x0=None if begin is None else begin.ctypes.data)
        return self._finish(self._submit(scene, byref(motion), 1,
                                         settings._as_parameter_))

    # -- what is near --

    def submit_near(self, scene: int, what: Union[int, str] = NearWhat.PAIRS,
                    distance: Optional[float] = None, at_begin: bool = False,
                    motions: Optional[Motions] = None, **settings: Any) -> int:
        """Ask what is near, after `motions` if there are any; its number, among those of
        steps. poll, wait, fetch, pages, cancel and abandon take it as a step's.

        what        enum NearWhat: PAIRS (each VF and EE within the distance), FEATURES
                    (merged to closest features), VERTICES (a bound each), NEAREST (for
                    each two objects; d_lo 0 if they cross or touch), CROSSINGS,
                    DEPTH
        distance    0 .. 1e18: exactly that is within it; of NEAREST also math.inf. None:
                    of NEAREST math.inf, of PAIRS and FEATURES 0, what touches; VERTICES
                    wants one
        at_begin    False: where the last step ended, or the motions; True: where it began
        tells_crossings    of PAIRS, FEATURES and VERTICES: count what crosses, too.
                    Pairs of an object with itself are left out, here and in steps, if
                    its self_collision is False (object_set)
        gap         of NEAREST: another pair may be nearer by that much; 0: none
        object_a, object_b    of NEAREST and DEPTH, object_a also of VERTICES; 0: any
        method, threads, tuning, deadline_ns    as of StepSettings
        """
        return self._submit_near(scene, what, distance, at_begin, motions, settings).value

    def _submit_near(self, scene: int, what: Union[int, str], distance: Optional[float],
                     at_begin: bool, motions: Optional[Motions],
                     settings: Dict[str, Any]) -> ctypes.c_uint64:
        asked, step = near_settings(what, distance, at_begin, **settings), \
            ctypes.c_uint64()
        structs, count = (None, 0) if motions is None else \
            (motions._structs, motions._count)
        if motions is not None:
            motions._with_joints(asked)
        self._check(lib.pccd_submit_near(self._handle, u32("scene", scene), structs,
                                         count, byref(asked), byref(step)))
        return step

    def near(self, scene: int, what: Union[int, str] = NearWhat.PAIRS,
             distance: Optional[float] = None, at_begin: bool = False,
             motions: Optional[Motions] = None, **settings: Any) -> Answer:
        """The same as submit_near, and wait for the answer. On E_TIMEOUT it is
        abandoned.

            with client.near(scene, distance=0.01) as answer:
                print(answer.total, answer.near["d_lo"].min(initial=1))
        """
        return self._finish(self._submit_near(scene, what, distance, at_begin, motions,
                                              settings))

    def poll(self) -> Optional[Answer]:
        """A finished answer, the oldest first, without waiting; None if there is none. A
        step that failed is an answer, too: `error` says why."""
        answer = self._new_answer()
        status = lib.pccd_poll(self._handle, byref(answer))
        if status == Status.E_AGAIN:
            return None
        self._check(status)
        if answer.status:
            answer.error = self._failure(answer.status)
        answer._come(self)
        return answer

    def wait(self, step: int, timeout: Optional[float] = None) -> Answer:
        """The answer to a step; None: within the client's timeout. E_TIMEOUT: not yet,
        and with timeout 0 E_AGAIN. Raises what the step failed with."""
        answer = self._new_answer()
        self._check(self._in_slices(lambda ms: lib.pccd_wait(
            self._handle, int(step), ms, byref(answer)), timeout))
        answer._come(self)
        return answer

    # -- batches --

    def batch(self, parts: Iterable[Part], joint_counts: Sequence[int] = ()) -> Batch:
        """Scenes that are stepped together, and what moves in each (batch.py)."""
        return Batch(self, parts, joint_counts)

    def batch_poll(self) -> Optional[BatchAnswer]:
        """A finished answer to a batch, the oldest first, or None. One of a batch that
        failed as a whole has its error in answer.error."""
        answer = new_answer()
        status = lib.pccd_batch_poll(self._handle, byref(answer))
        if status == Status.E_AGAIN:
            return None
        self._check(status)
        answer._come(self)
        if answer.status:
            answer.error = self._failure(answer.status)
        return answer

    def batch_wait(self, step: int, timeout: Optional[float] = None) -> BatchAnswer:
        """The answer to the batch whose first scene's step has that number; as wait().
        A scene that failed says so itself."""
        answer = new_answer()
        self._check(self._in_slices(lambda ms: lib.pccd_batch_wait(
            self._handle, int(step), ms, byref(answer)), timeout))
        answer._come(self)
        return answer

    def wait_held(self, step: int, timeout: Optional[float] = None) -> None:
        """Wait until a frame that was committed with hold=True waits for another client's
        step: the next step of the scene takes it along. Returns as well when it has been
        answered. E_TIMEOUT, E_AGAIN; E_INVAL: no such step, or not to hold."""
        self._check(self._in_slices(lambda ms: lib.pccd_wait_held(
            self._handle, int(step), ms), timeout))

    def fetch(self, scene: int, step: int, cursor: int) -> Answer:
        """The page that begins at `cursor`, of the answer to `step`, the last of `scene`.
        Release the page at hand first when the region is full. E_STATE: the answer is
        gone."""
        answer = self._new_answer()
        self._check(lib.pccd_fetch(self._handle, u32("scene", scene), int(step),
                                   int(cursor), byref(answer)))
        answer._come(self)
        return answer

    def pages(self, scene: int, answer: Answer) -> Iterator[Answer]:
        """An answer, then its further pages; each is released when the next is asked
        for."""
        page = answer
        while True:
            with page:
                yield page
            cursor = page.cursor
            if cursor >= answer.total:
                return
            page = self.fetch(scene, answer.step, cursor)
            if page.count == 0:
                raise refusal(Status.E_BUSY, "no room in the result region: release "
                              "answers first")

    def cancel(self, step: int) -> None:
        """Stop a submitted step: its answer comes with incomplete = CANCELLED, unless it
        was done."""
        self._check(lib.pccd_cancel(self._handle, int(step)))

    def abandon(self, step: int) -> None:
        """Nobody will ask for the answer: the step is stopped if that is still possible,
        and its answer is dropped. Does not wait."""
        lib.pccd_abandon(self._handle, int(step))


def connect(url: Optional[str] = None, *, private: bool = False,
            daemon: Optional[str] = None, autostart: bool = True,
            name: Optional[str] = None, timeout: float = 30.0, slot_count: int = 0,
            slot_bytes: int = 0, result_bytes: int = 0, spin_us: Optional[int] = None,
            reconnect: float = 10.0, keep: bool = True, observes: bool = False,
            daemons_max: int = 4) -> Client:
    """Connect to the daemon, or compute in this process.

    url           "unix:PATH"; "direct:": no daemon, steps are computed in submit
                  (pccd.h); None: $PCCD_URL, else the user's own socket, where a daemon
                  is started when nobody listens
    private       start a daemon of our own on a socket of our own, gone with us, whatever
                  unix:PATH is in PCCD_URL
    daemon        program to start; None: $PCCD_DAEMON, else pccdd beside libpccd,
                  installed or in $PATH
    autostart     whether to start one at all
    name          of this client, for the daemon's log; None: the program's
    timeout       seconds, of every call that waits. With direct: it ends no step: the
                  deadline_ns of its settings does
    slot_count    of the upload ring, 1 .. 16; 0 = 4
    slot_bytes    payload of one slot; 0 = grown to what is needed
    result_bytes  result region; 0 = 64 MiB
    spin_us       spin before blocking, 0 .. 1000; None: 200, or 0 with one processor
    reconnect     seconds to look for a daemon that was lost; 0: its loss is an error
    keep          keep copies of meshes and positions for another daemon
    observes      it only lists, watches, reads counters and sets settings, all else is
                  E_STATE: the first eight such clients of a user take no place of its
                  clients
    daemons_max   a request over which so many daemons have ended fails
    """
    if timeout == 0:
        raise refusal(Status.E_INVAL, "timeout is 0 seconds")
    if daemons_max < 1:
        raise refusal(Status.E_INVAL, f"daemons_max is {daemons_max}")
    options = abi.pccd_options()
    lib.pccd_options_init(byref(options))
    options.url = None if url is None else os.fsencode(url)
    options.daemon = None if daemon is None else os.fsencode(daemon)
    options.name = os.fsencode(os.path.basename(sys.argv[0]) or "python"
                               if name is None else name)
    put(options, "timeout_ms", milliseconds("timeout", timeout))
    put(options, "reconnect_ms", milliseconds("reconnect", reconnect))
    put(options, "daemons_max", daemons_max)
    options.no_autostart = not truth("autostart", autostart)
    options.private_daemon = truth("private", private)
    options.no_keep = not truth("keep", keep)
    options.observes = truth("observes", observes)
    for what, value in (("slot_count", slot_count), ("slot_bytes", slot_bytes),
                        ("result_bytes", result_bytes), ("spin_us", spin_us)):
        if value is not None and (value or what == "spin_us"):
            put(options, what, value)
    return Client(options)
