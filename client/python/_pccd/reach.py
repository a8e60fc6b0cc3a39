"""reach.py - the way to a daemon.

Room:     client/python. May import: launch, link, values, wire.
Does:     connect a socket, check who listens, say hello and bye; have daemons started.
Does not: decide how often to try after the first time (recover).
Source:   client/lib/link.c.
"""

from __future__ import annotations

import errno
import os
import select
import socket
import struct
import time

import msgpack  # type: ignore

from .launch import HELD, READY, Daemon, launch_private, launch_user
from .link import Link
from .values import Options, PccdError, failure
from .wire import VERSION_MAX, VERSION_MIN, Status

STARTS = 3  # daemons started by one connect
START_PATIENCE = 2.0  # seconds from "listening" to a connection
RETRIED = (Status.E_NODAEMON, Status.E_DISCONNECTED, Status.E_SHUTDOWN)


class Reach(Link):
    """A connection that knows how it is made."""

    def __init__(self, options: Options) -> None:
        super().__init__(options)
        self._way = "url"  # or "user", "private"
        self._daemon = Daemon()  # a private one
        self._features = 0
        self._epoch = 0
        self._session = 0  # 0: none that could be resumed
        self._token = (0, 0)
        self._pid = 0
        self._cpu = ""

    def _open_socket(self, deadline: float) -> None:
        made = socket.socket(socket.AF_UNIX, socket.SOCK_SEQPACKET)
        try:
            made.setblocking(False)
            self._connect_socket(made, deadline)
            if self._way != "url":
                self._check_owner(made)
        except BaseException:
            made.close()
            raise
        if self._socket is None:
            self._socket = made
        else:  # under the same number, so that whoever watches it goes on
            os.dup2(made.fileno(), self._socket.fileno(), inheritable=False)
            made.close()
        self._poll.register(self._socket, select.POLLIN)
        self._attaching = 0
        self._words = None
        self._is_up = True

    def _connect_socket(self, made: socket.socket, deadline: float) -> None:
        pause = 0.001
        while True:
            try:
                made.connect(self._path)
                return
            except BlockingIOError:  # the daemon's queue of connections is full
                if time.monotonic() >= deadline:
                    raise failure(Status.E_TIMEOUT, f"the daemon at {self._path} "
                                  "accepts nobody") from None
            except OSError as problem:
                if problem.errno in (errno.ENOENT, errno.ECONNREFUSED, errno.ENOTDIR):
                    raise failure(Status.E_NODAEMON, "nobody listens at "
                                  f"{self._path}: {problem.strerror}") from None
                raise failure(Status.E_SYSTEM, f"connect to {self._path}: "
                              f"{problem.strerror}") from None
            time.sleep(pause)
            pause = min(pause * 2, 0.05)

    def _check_owner(self, made: socket.socket) -> None:
        """Who listens on a path that nobody chose must be this user or root: in /tmp
        anybody may have been there first."""
        peer = made.getsockopt(socket.SOL_SOCKET, socket.SO_PEERCRED, 12)
        uid = struct.unpack("iII", peer)[1]
        if uid not in (0, os.getuid(), os.geteuid()):
            raise failure(Status.E_SYSTEM, f"the daemon at {self.url} is user {uid}'s, "
                          f"not this user's ({os.geteuid()}); an url or PCCD_URL "
                          "chooses it nevertheless")

    def _hello(self, deadline: float) -> bool:
        """The first message. Returns whether the session goes on."""
        params = {"version_min": VERSION_MIN, "version_max": VERSION_MAX,
                  "client": self._options.name, "resumable": self._options.reconnect > 0,
                  "resume_epoch": self._epoch, "resume_session": self._session,
                  "token_hi": self._token[0], "token_lo": self._token[1]}
        recovering = self._is_recovering
        self._is_recovering = True  # so that a loss is an error at once
        try:
            call = self._send("hello", params, deadline=deadline)
            result = self._wait(call, max(0.0, deadline - time.monotonic()))
        except PccdError as problem:
            if problem.status == Status.E_DISCONNECTED and self._words is not None:
                problem = self._words  # a daemon that refuses the session says why
            raise PccdError(problem.status, problem.name, problem.text) from None
        finally:
            self._is_recovering = recovering
        version = result["version"]
        if not VERSION_MIN <= version <= VERSION_MAX:
            raise failure(Status.E_VERSION, f"the daemon chose version {version}, this "
                          f"client speaks {VERSION_MIN} .. {VERSION_MAX}")
        self._epoch = result["epoch"]
        self._token = (result.get("token_hi", 0), result.get("token_lo", 0))
        self._session = result["session"] if any(self._token) else 0
        self._features = result["features"]
        self._pid = result["pid"]
        self._cpu = result.get("cpu", "")
        return bool(result.get("resumed", False))

    def _open(self, deadline: float) -> bool:
        self._open_socket(deadline)
        return self._hello(deadline)

    def _open_first(self, deadline: float) -> None:
        """Nothing is left of a connection that failed."""
        try:
            self._open(deadline)
        except BaseException:
            self._close_socket()
            raise

    def _close_socket(self) -> None:
        if self._socket is not None:
            self._socket.close()
        self._socket = None
        self._poll = select.poll()
        self._calls.clear()
        self._dead = self._words = None
        self._is_up = False

    def _retry_first(self, deadline: float) -> None:
        """A daemon that ends while we connect, or has not yet begun to listen."""
        until = min(deadline, time.monotonic() + START_PATIENCE)
        pause = 0.001
        while True:
            try:
                self._open_first(deadline)
                return
            except PccdError as problem:
                if problem.status not in RETRIED or time.monotonic() >= until:
                    raise
            time.sleep(pause)
            pause = min(pause * 2, 0.05)

    def _connect_user(self, deadline: float) -> None:
        """Of two clients that start a daemon at the same time its lock lets one through;
        the other's ends, and both connect to the first, whenever that has come to listen;
        or it is about to end, and then the next one is started."""
        start, word = 0, READY
        while True:
            try:
                if start == 0 and word == READY:
                    self._open_first(deadline)
                else:
                    self._retry_first(deadline)
                return
            except PccdError as problem:
                if problem.status not in RETRIED or not self._options.autostart or \
                        start == STARTS:
                    raise
                if not word:
                    raise failure(Status.E_NODAEMON, "the daemon that was started for "
                                  f"{self._path} ended at once; PCCD_LOG=FILE shows "
                                  "what it says") from None
            word = launch_user(self._options.daemon, self._path, deadline)
            start += word != HELD or time.monotonic() >= deadline

    def _connect(self, way: str, path: str) -> None:
        deadline = self._deadline()
        self._way, self._path = way, path
        if way == "user":
            self._connect_user(deadline)
        else:
            if way == "private":
                self._path = launch_private(self._daemon, self._options.daemon, deadline)
            try:
                self._open_first(deadline)
            except PccdError as problem:
                # One that dies between accepting us and its answer has a successor.
                if problem.status != Status.E_DISCONNECTED or \
                        self._options.reconnect == 0:
                    raise
                self._retry_first(deadline)
        self._is_established = True

    def _open_again(self, deadline: float) -> bool:
        """A daemon is started in place of one that is gone, where this client may."""
        try:
            return self._open(deadline)
        except PccdError as problem:
            if problem.status != Status.E_NODAEMON or self._way == "url" or \
                    not self._options.autostart:
                raise
        if self._way == "private":
            self._daemon.stop()
            self._path = launch_private(self._daemon, self._options.daemon, deadline)
        else:
            launch_user(self._options.daemon, self._path, deadline)
        return self._open(deadline)

    def _bye(self) -> None:
        """Say that nobody comes back."""
        if self._session and self._is_up and self._socket and os.getpid() == self._owner:
            try:
                self._socket.send(msgpack.packb([0, self._next_id, "bye", {}]),
                                  socket.MSG_NOSIGNAL)
            except OSError:
                pass  # then the session ends when its time is up
        self._session = 0
