"""launch.py - daemons that the client starts.

Room:     client/python. May import: values, wire.
Does:     find the program, start it, wait for the one byte on its --ready-fd, stop and
          reap the private one.
Source:   client/lib/launch.c.
"""

from __future__ import annotations

import math
import os
import select
import shutil
import subprocess
import tempfile
import time
from typing import List, Optional, Tuple

from .values import SOCKET_BYTES, failure
from .wire import Status

READY, HELD = b"1", b"0"  # what a daemon says on its --ready-fd


class Daemon:
    """A private daemon, and the folder of its socket."""

    def __init__(self) -> None:
        self.process: Optional[subprocess.Popen[bytes]] = None
        self.folder = ""
        self.owner = os.getpid()  # a forked copy must not stop it

    def stop(self) -> None:
        if os.getpid() != self.owner:
            return
        process, self.process = self.process, None
        folder, self.folder = self.folder, ""
        if process is not None:
            process.terminate()
            try:
                process.wait(2.0)
            except subprocess.TimeoutExpired:
                process.kill()
                process.wait()
        if folder:
            shutil.rmtree(folder, ignore_errors=True)


def find_program(asked: Optional[str]) -> str:
    """pccdd: what was asked for, beside this module's installation, or in $PATH."""
    name = asked if asked is not None else os.environ.get("PCCD_DAEMON", "")
    if name:
        found = shutil.which(name)
        if found is None:
            raise failure(Status.E_NODAEMON, f'cannot run "{name}"')
        return os.path.abspath(found)
    prefix = os.path.dirname(os.path.realpath(__file__)) + "/../../../.."
    for candidate in (prefix + "/bin/pccdd", "pccdd"):
        found = shutil.which(candidate)
        if found is not None:
            return os.path.abspath(found)
    raise failure(Status.E_NODAEMON, "no daemon to start: no pccdd installed with this "
                  "module or in $PATH; PCCD_DAEMON=PROGRAM names one")


def await_ready(fd: int, deadline: float) -> bytes:
    """Wait for the byte that says "listening" (READY), or that another daemon holds the
    path (HELD). Empty: the daemon ended without either."""
    watched = select.poll()
    watched.register(fd, select.POLLIN)
    left = max(0.0, deadline - time.monotonic())
    if not watched.poll(math.ceil(left * 1000)):
        raise failure(Status.E_TIMEOUT, "the daemon that was started does not get ready")
    return os.read(fd, 1)


def start_daemon(arguments: List[str],
                 deadline: float) -> Tuple[subprocess.Popen[bytes], bytes]:
    """Run a daemon and wait for its word. Its messages go to $PCCD_LOG."""
    log = os.environ.get("PCCD_LOG") or os.devnull
    ready_fd, its_fd = os.pipe()
    try:
        try:
            with open(log, "ab", opener=lambda path, flags: os.open(path, flags, 0o600)) \
                    as messages:
                process = subprocess.Popen(
                    arguments + ["--ready-fd", str(its_fd)], stdin=subprocess.DEVNULL,
                    stdout=messages, stderr=messages, cwd="/", pass_fds=(its_fd,),
                    start_new_session=True)
        except OSError as problem:
            raise failure(Status.E_SYSTEM,
                          f"start of {arguments[0]}: {problem}") from None
        finally:
            os.close(its_fd)  # so that the daemon's end is the last one
        try:
            return process, await_ready(ready_fd, deadline)
        except BaseException:
            process.kill()
            process.wait()
            raise
    finally:
        os.close(ready_fd)


def launch_private(daemon: Daemon, program: Optional[str], deadline: float) -> str:
    """A daemon of our own; the path of its socket."""
    found = find_program(program)
    runtime = os.environ.get("XDG_RUNTIME_DIR", "")
    for parent in (runtime, "/tmp"):
        if not parent.startswith("/") or len(os.fsencode(parent)) > SOCKET_BYTES - 24:
            continue
        try:
            daemon.folder = tempfile.mkdtemp(prefix="pccd-", dir=parent)
            break
        except OSError:
            continue
    else:
        raise failure(Status.E_SYSTEM, "no folder for a private daemon's socket")
    path = daemon.folder + "/pccd.sock"
    daemon.process, word = start_daemon([found, "--socket", path, "--private"], deadline)
    if word != READY:
        raise failure(Status.E_NODAEMON,
                      f"{found} ended at once; PCCD_LOG=FILE shows what it says")
    return path


def launch_user(program: Optional[str], path: str, deadline: float) -> bytes:
    """The user's own daemon, nobody's child. Its word: see await_ready."""
    process, word = start_daemon(["/bin/sh", "-c", '"$0" "$@" &', find_program(program),
                             "--socket", path, "--idle-exit", "30"], deadline)
    process.wait()
    return word
