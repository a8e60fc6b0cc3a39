"""recover.py - another connection when one is lost.

Room:     client/python. May import: reach, link, values, wire.
Does:     the states of a link:

    UP -- lost --> DOWN -- try --> RECOVERING -- hello, told anew, sent again --> UP
                    |  ^-- failed, pause --'
                    '-- the patience is over --> DEAD: every call fails

          Pauses double from 1 ms to 1 s, with a random part.
Does not: tell a new daemon what there is (restore).
Source:   PROTOCOL.md, "When the connection is lost"; client/lib/recover.c.
"""

from __future__ import annotations

import random
import time
from typing import List, NoReturn, Optional

from .link import Call
from .reach import Reach
from .values import Options, PccdError, failure
from .wire import Status

HELLO = 0.1  # seconds for an answer to hello at least, whatever the deadline
RETRIED = (Status.E_NODAEMON, Status.E_DISCONNECTED, Status.E_SHUTDOWN, Status.E_TIMEOUT,
           Status.E_QUOTA, Status.E_BUSY, Status.E_NOMEM, Status.E_SYSTEM,
           Status.E_AGAIN)


class Recover(Reach):
    """A connection that is made again."""

    def __init__(self, options: Options) -> None:
        super().__init__(options)
        self._told_anew = 0  # daemons that have been told of all that is kept
        self._uploads_ended = 0  # daemons, over the mesh that is being registered

    def _restore(self) -> None:
        """Tell another daemon what the last one knew."""
        raise NotImplementedError

    def _give_up(self, error: Optional[PccdError]) -> NoReturn:
        passed = time.monotonic() - self._lost_at
        last = error.text if error is not None else ""
        self._die(failure(Status.E_DISCONNECTED, f"the daemon at {self.url} is gone, "
                          f"after {self._tries} tries in {passed:.1f} s: {last}"))
        raise self._gone()

    def _recover(self, deadline: float) -> None:
        """Until there is another connection, or the deadline or all patience is over."""
        if self._is_recovering:  # whoever is at it starts over
            raise self._gone()
        end = self._lost_at + self._options.reconnect
        while not self._is_up:
            now = time.monotonic()
            if now >= end:
                self._give_up(self._words)
            if now >= self._retry_at:
                self._try_again(min(max(deadline, now + HELLO), end), end)
            elif now >= deadline:
                raise failure(Status.E_TIMEOUT,
                              f"{self._gone().text}, and not back yet")
            else:
                time.sleep(min(self._retry_at, deadline, end) - now)

    def _try_again(self, deadline: float, end: float) -> None:
        """Try once, now."""
        self._tries += 1
        self._is_recovering = True
        try:
            resumed = self._reopen(deadline)
        except PccdError as problem:
            self._fall_back(problem)
            pause = self._pause * (0.5 + random.random())  # so that not all come at once
            self._retry_at = time.monotonic() + pause
            self._pause = min(self._pause * 2, 1.0)
            if problem.status not in RETRIED or time.monotonic() >= end:
                self._give_up(problem)
        except BaseException:
            self._fall_back(failure(Status.E_DISCONNECTED, "interrupted"))
            raise
        else:
            self.link_info.reconnects += 1
            self.link_info.resumed += resumed
            self.link_info.gap_ns = int((time.monotonic() - self._lost_at) * 1e9)
        finally:
            self._is_recovering = False

    def _fall_back(self, error: PccdError) -> None:
        self._hang_up()  # one that was too slow may go on being so
        self._hold(error)
        self._is_up = False

    def _reopen(self, deadline: float) -> bool:
        resumed = self._open_again(deadline)
        if not resumed:
            self._tell_anew()
        for call in self._held():  # in the order in which they were sent
            call.held = False
            self._transmit(call, self._deadline())
            self.link_info.resent += 1
        return resumed

    def _held(self) -> List[Call]:
        return [call for call in self._calls.values() if call.held]

    def _tell_anew(self) -> None:
        held = self._held()
        try:
            self._restore()
        except BaseException:
            self._bye()  # or the next try would go on with half of all
            raise
        self._told_anew += 1
        # Requests are computed in their order, so that a daemon most likely ended over
        # the first one that it left without an answer.
        if held and held[0].is_upload():
            self._uploads_ended += 1  # its caller starts over, or gives up
        elif held:
            held[0].daemons_ended += 1
            if held[0].daemons_ended >= self._options.daemons_max:
                self._end(held[0], failure(
                    Status.E_DISCONNECTED, f"{held[0].method}: daemon after daemon has "
                    "ended before it answered"))
        for call in held:
            if call.is_upload():
                self._end(call, failure(Status.E_AGAIN, "the daemon is another one"))
