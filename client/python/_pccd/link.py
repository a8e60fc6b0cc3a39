"""link.py - requests and their answers.

Room:     client/python. May import: ring, values, wire, msgpack.
Does:     the only place that reads and writes the socket. Answers come in any order and
          are matched by id; every wait has a deadline.
Does not: make connections (reach), or know what the methods mean but for the pages and
          descriptors that some answers bring.
Source:   client/lib/rpc.c, client/lib/receive.c.
"""

from __future__ import annotations

import array
import collections
import contextlib
import errno
import math
import os
import select
import socket
import time
import weakref
from typing import Any, Callable, Deque, Dict, List, Optional, Tuple

import msgpack  # type: ignore

from .answer import Result
from .ring import Ring, Slot
from .values import LinkInfo, Options, PccdError, failure, plain_number
from .wire import (CLIENT_WAIT, INFLIGHT_MAX, MESSAGE_BYTES_MAX, REPLIES_KEPT, Status)

NOTIFICATIONS = 256  # kept for the user, the newest


class Call:
    """A request and its answer. `held`: it was sent over a connection that is lost, and
    is sent again over the next one."""

    __slots__ = ("id", "method", "message", "slot", "step", "result", "error", "fds",
                 "is_done", "is_dropped", "held", "recovery", "daemons_ended", "then",
                 "is_to_hold")

    def __init__(self, id: int, method: str, message: bytes) -> None:
        self.id = id
        self.method = method
        self.message = message
        self.slot: Optional[Slot] = None
        self.step = 0
        self.result = Result()
        self.error: Optional[PccdError] = None
        self.fds: List[int] = []
        self.is_done = False
        self.is_dropped = False  # nobody waits for it any more
        self.held = False
        self.recovery = False  # sent while a connection is made again
        self.daemons_ended = 0  # that had it first of all
        self.is_to_hold = False  # a step that waits for another client's
        self.then: Optional[Callable[[Call], None]] = None  # when it has succeeded

    def is_upload(self) -> bool:
        """Part of a mesh, which another daemon must be sent from the beginning."""
        return self.method in ("mesh.create", "mesh.replace", "mesh.data", "mesh.commit")


# Every connection of this process, for its forked copies.
_links: "weakref.WeakSet[Link]" = weakref.WeakSet()


def _forked() -> None:
    """In the copy: the sockets and rings are those of the process that it is one of."""
    for link in _links:
        if link._dead is None:
            link._die(failure(Status.E_DISCONNECTED, "this process is a copy of the one "
                              f"that connected to the daemon at {link.url}: it must "
                              "connect itself"))
        if link._ring is not None:
            link._ring.let_go()


os.register_at_fork(after_in_child=_forked)


class Link:
    """A connection, and the requests in flight over it."""

    def __init__(self, options: Options) -> None:
        self._options = options
        self._path = ""  # of the daemon's socket
        self._owner = os.getpid()  # a forked copy has no claim on the session
        _links.add(self)
        self._socket: Optional[socket.socket] = None
        self._poll = select.poll()
        self._buffer = bytearray(MESSAGE_BYTES_MAX)
        self._calls: Dict[int, Call] = {}  # without an answer, in the order of sending
        self._next_id = 1
        self._has_sent = False  # and not looked for answers since
        self._attaching = 0  # answers to come that bring descriptors
        self._ring: Optional[Ring] = None
        self._is_established = False  # connect() has succeeded
        self._is_up = False
        self._is_recovering = False
        self._dead: Optional[PccdError] = None  # what every call fails with
        self._words: Optional[PccdError] = None  # the daemon's last
        self._lost_at = 0.0
        self._retry_at = 0.0  # not before
        self._pause = 0.0  # after the next failure
        self._tries = 0  # since the loss
        #: What became of lost connections.
        self.link_info = LinkInfo()
        #: Notifications that this client does not know: (method, params), newest last.
        self.notifications: Deque[Tuple[str, Dict[str, Any]]] = collections.deque(
            maxlen=NOTIFICATIONS)

    @property
    def url(self) -> str:
        """"unix:PATH" of the daemon, for other processes to connect to."""
        return "unix:" + self._path

    def _deadline(self, timeout: Optional[float] = None) -> float:
        return time.monotonic() + (self._options.timeout if timeout is None else timeout)

    def _recover(self, deadline: float) -> None:
        """Until there is another connection, or the deadline is over."""
        raise NotImplementedError

    # -- sending --

    def _is_inflight(self, call: Call) -> bool:
        return not (call.held and self._is_recovering)

    def _is_full(self, method: str) -> bool:
        if len(self._calls) < INFLIGHT_MAX and (
                self._ring is None or len(self._calls) < self._ring.inflight_max):
            return False
        flying = [call for call in self._calls.values() if self._is_inflight(call)]
        steps = sum(call.method == "frame.submit" for call in flying)
        steps_max = self._ring.inflight_max if self._ring is not None else INFLIGHT_MAX
        return len(flying) >= REPLIES_KEPT or (
            method == "frame.submit" and steps >= steps_max)

    def _send(self, method: str, params: Dict[str, Any], slot: Optional[Slot] = None,
              then: Optional[Callable[[Call], None]] = None,
              deadline: Optional[float] = None, step: int = 0) -> Call:
        """Send a request, as soon as there is room for it. An exception means that it was
        not sent, and the slot is free again, or that nobody waits for it."""
        until = self._deadline() if deadline is None else deadline
        try:
            while not self._is_up or self._is_full(method):
                self._progress(until)
            message = self._pack(method, params)
        except BaseException:
            if slot is not None:
                slot.sent = False
            raise
        call = Call(self._next_id, method, message)
        call.slot = slot
        call.then = then
        call.step = step
        call.recovery = self._is_recovering
        # The entry comes first: when the connection is lost, it is sent over the next.
        self._calls[call.id] = call
        self._next_id = self._next_id % 0xFFFFFFFF + 1
        try:
            self._transmit(call, until)
        except PccdError:
            if not call.held:
                self._calls.pop(call.id, None)
                if slot is not None:
                    slot.sent = False
                raise
        except BaseException:
            call.is_dropped = True
            raise
        return call

    def _pack(self, method: str, params: Dict[str, Any]) -> bytes:
        try:
            message: bytes = msgpack.packb([0, self._next_id, method, params],
                                           default=plain_number)
        except (TypeError, ValueError, OverflowError) as problem:
            raise failure(Status.E_INVAL, f"{method}: {problem}") from None
        if len(message) > MESSAGE_BYTES_MAX:
            raise failure(Status.E_LIMIT, f"{method} does not fit a message")
        return message

    def _transmit(self, call: Call, deadline: float) -> None:
        """While the socket takes nothing the answers must be read: the daemon does not
        read from a client that does not."""
        assert self._socket is not None
        self._attaching += call.method == "shm.attach"
        while True:
            try:
                self._socket.send(call.message, socket.MSG_NOSIGNAL)
                self._has_sent = True
                return
            except BlockingIOError:
                self._await(select.POLLIN | select.POLLOUT, deadline)
            except OSError as problem:
                while self._receive():  # what the daemon said before it went
                    pass
                if self._is_up:
                    self._lose(os.strerror(problem.errno or errno.EPIPE))
            if not self._is_up:
                raise self._gone()
            while time.monotonic() < deadline and self._receive():
                pass

    # -- receiving --

    def _await(self, events: int, deadline: float) -> None:
        poll = self._poll
        if events != select.POLLIN:
            assert self._socket is not None
            poll = select.poll()
            poll.register(self._socket, events)
        left = max(0.0, deadline - time.monotonic())
        if not poll.poll(math.ceil(left * 1000)):
            raise failure(Status.E_TIMEOUT,
                          f"the daemon at {self.url} does not answer")

    def _progress(self, deadline: float) -> None:
        """Take in one message, or make another connection. E_TIMEOUT: neither by then."""
        if self._dead is not None:
            raise self._gone()
        if not self._is_up:
            self._recover(deadline)
            return
        has_sent, self._has_sent = self._has_sent, False
        # What has just been asked is not answered yet: who will wait need not look.
        if not has_sent and self._receive() or not self._is_up:
            return
        # One that was sent before is seen by poll; one that the daemon leaves out because
        # nobody waits, it leaves out before it sees this.
        ring = self._ring
        if ring is not None:
            ring.words[CLIENT_WAIT] = 1
            ring.fence()
        try:
            self._await(select.POLLIN, deadline)
        finally:
            if ring is not None:
                ring.words[CLIENT_WAIT] = 0
        self._receive()

    def _receive(self) -> bool:
        """Take in a message if there is one. False: none, or the connection is lost."""
        if not self._is_up or self._socket is None:
            return False
        try:
            fds, size = self._read_message()
        except BlockingIOError:
            return False
        except OSError as problem:
            self._lose(os.strerror(problem.errno or errno.EPIPE))
            return False
        try:
            if size == 0:
                self._lose("the connection was closed")
                return False
            self._take(memoryview(self._buffer)[:size], fds)
        finally:
            for fd in fds:
                os.close(fd)
        return self._is_up

    def _read_message(self) -> Tuple[List[int], int]:
        assert self._socket is not None
        try:
            if self._attaching == 0:  # a descriptor would be closed by the kernel
                return [], self._socket.recv_into(self._buffer, 0, socket.MSG_DONTWAIT)
            return self._read_descriptors()
        except ConnectionResetError:
            # So it is when a peer closes with our messages unread; what it had said
            # before can still be read after it.
            return self._read_descriptors()

    def _read_descriptors(self) -> Tuple[List[int], int]:
        assert self._socket is not None
        fds = array.array("i")
        size, control, _, _ = self._socket.recvmsg_into(
            [self._buffer], socket.CMSG_SPACE(2 * fds.itemsize),
            socket.MSG_DONTWAIT | socket.MSG_CMSG_CLOEXEC)
        for level, kind, data in control:
            if level == socket.SOL_SOCKET and kind == socket.SCM_RIGHTS:
                fds.frombytes(data[:len(data) // fds.itemsize * fds.itemsize])
        return list(fds), size

    def _take(self, data: memoryview, fds: List[int]) -> None:
        error: Optional[PccdError] = None
        result = Result()
        try:
            message = msgpack.unpackb(data)
            kind = message[0]
            if kind == 1:
                id = int(message[1])
                if message[2] is not None:
                    code, name, text, fatal = message[2][:4]
                    error = PccdError(code if code < 0 else Status.E_INTERNAL, name, text)
                    if fatal:
                        self._last_words(error)
                else:
                    result = Result(message[3])
            elif kind == 2:
                self._notified(str(message[1]), dict(message[2]))
        except (ValueError, TypeError, LookupError, AttributeError) as problem:
            self._lose(f"a message that cannot be read: {problem}")
            return
        if kind == 1:
            self._answer(id, error, result, fds)

    def _notified(self, method: str, params: Dict[str, Any]) -> None:
        if method != "goaway":
            self.notifications.append((method, params))
            return
        code = -int(params.get("code", 0)) or int(Status.E_DISCONNECTED)
        known = code in Status.__members__.values()
        self._last_words(PccdError(code, Status(code).name if known else str(code),
                                   str(params.get("text", ""))))

    def _last_words(self, error: PccdError) -> None:
        self._words = PccdError(error.status, error.name,
                                f"the daemon at {self.url} says: {error.text}")

    def _answer(self, id: int, error: Optional[PccdError], result: Result,
                fds: List[int]) -> None:
        call = self._calls.get(id)
        if call is None or call.held:
            return
        if error is not None and error.status == Status.E_SHUTDOWN and \
                self._is_patient() and not call.recovery:
            return  # it has not been begun, and waits for the next daemon
        del self._calls[id]
        self._attaching -= call.method == "shm.attach"
        if call.slot is not None:
            call.slot.sent = False
        call.is_done = True
        call.result = result
        if error is not None:
            call.error = PccdError(error.status, error.name,
                                   f"{call.method}: {error.text}")
            return
        if call.method == "shm.attach" and not call.is_dropped:
            call.fds = [os.dup(fd) for fd in fds]
        elif self._ring is not None:
            try:
                result.page = self._ring.page(result)
            except PccdError as problem:
                call.error = problem
        if call.then is not None and call.error is None:
            call.then(call)
        if call.is_dropped:
            result.release()

    # -- waiting --

    def _wait(self, call: Call, timeout: Optional[float] = None) -> Result:
        """The result of a call. It is nobody's afterwards, whatever happens."""
        try:
            deadline = self._deadline(timeout)
            while not call.is_done:
                self._progress(deadline)
        except BaseException:
            self._drop(call)
            raise
        if call.error is not None:
            raise call.error
        return call.result

    def _drop(self, call: Call) -> None:
        if not call.is_done:
            call.is_dropped = True
        else:
            call.result.release()

    def _call(self, method: str, **params: Any) -> Result:
        return self._wait(self._send(method, params))

    # -- the loss of the connection --

    def _is_patient(self) -> bool:
        """Whether a connection that is lost is made again; never by a forked copy."""
        return self._is_established and self._options.reconnect > 0 and \
            os.getpid() == self._owner

    def _gone(self) -> PccdError:
        """Why there is no connection. Another one each time: to raise one twice would
        lengthen its trace for ever."""
        error = self._dead or self._words or failure(Status.E_DISCONNECTED, "lost")
        return PccdError(error.status, error.name, error.text)

    def _lose(self, why: str) -> None:
        if self._words is None:
            self._words = failure(Status.E_DISCONNECTED,
                                  f"the daemon at {self.url} is gone: {why}")
        self._is_up = False
        if not self._is_patient():
            self._die(self._words)
            return
        self._hang_up()
        self._hold(self._words)
        if not self._is_recovering:
            self._lost_at = self._retry_at = time.monotonic()
            self._pause = 0.001
            self._tries = 0

    def _hang_up(self) -> None:
        """Have the socket end, so that who watches it sees that there is something to do,
        whatever the daemon does with its own end. Not by a forked copy."""
        if self._socket is not None:
            with contextlib.suppress(OSError):  # it may be over already
                self._socket.shutdown(socket.SHUT_RDWR)

    def _hold(self, error: PccdError) -> None:
        """What has no answer waits for another connection; what was sent to make one,
        fails."""
        for call in list(self._calls.values()):
            if call.recovery:
                self._end(call, error)
            else:
                call.held = True

    def _end(self, call: Call, error: PccdError) -> None:
        """It gets no answer from any daemon."""
        self._calls.pop(call.id, None)
        if call.slot is not None:
            call.slot.sent = False
        call.is_done = True
        call.held = False
        call.error = error

    def _die(self, error: PccdError) -> None:
        self._dead = failure(Status.E_DISCONNECTED, error.text)
        self._is_up = False
        for call in list(self._calls.values()):
            self._end(call, self._dead)
