"""library.py - libpccd: where it is found, and what its failures are called.

Room:     client/python. May import: abi.
Does:     load libpccd.so.0: the file that $PCCD_LIBRARY names, or else the first of:
          beside this module, in the build folder that it lies in, where the build
          installs it, where the system's loader finds it. Its release must be the
          module's.
          See to it that the methods of a client are called by one thread at a time.
Threads:  `lib` gives Python's lock back while a call runs, so that other threads go on;
          `quick` keeps it, for calls that never wait.
"""

from __future__ import annotations

import ctypes
import functools
import os
import sys
import threading
import weakref
from types import FunctionType
from typing import Any, Dict, List, Tuple, TypeVar

from . import abi

NAME = "libpccd.so.0"


def candidates() -> List[str]:
    """Where to look, in this order."""
    chosen = os.environ.get("PCCD_LIBRARY")
    if chosen:
        return [chosen]
    here = os.path.dirname(os.path.abspath(__file__))
    build = os.path.join(os.path.dirname(os.path.dirname(here)), ".libs")
    return [os.path.join(folder, NAME) for folder in (here, build, abi.LIBRARY_FOLDER)
            ] + [NAME]


def declare(library: Any) -> Any:
    """Give the functions their types."""
    for name, (result, parameters) in abi.PROTOTYPES.items():
        function = getattr(library, name)
        function.restype, function.argtypes = result, parameters
    return library


def load() -> Tuple[Any, Any]:
    """The library twice: without and with Python's lock held. ImportError says what was
    tried."""
    tried = []
    for path in candidates():
        try:
            library = ctypes.CDLL(path)
            library.pccd_version.restype = ctypes.c_char_p
            version = library.pccd_version().decode()
            if version == abi.VERSION:
                return declare(library), declare(ctypes.PyDLL(path))
            tried.append(f"{path}: is libpccd {version}")
        except (OSError, AttributeError) as problem:
            tried.append(str(problem))  # which begins with the path
    raise ImportError(f"pccd {abi.VERSION} needs libpccd {abi.VERSION}; PCCD_LIBRARY "
                      "names its file. Tried:\n  " + "\n  ".join(tried))


try:
    lib, quick = load()
except ImportError as problem:
    # While Python looks for python3 -m pccd. By itself it would end with 1, which says
    # that something meets.
    if sys.argv[:1] != ["-m"]:
        raise
    print(f"pccd: {problem}", file=sys.stderr)
    sys.exit(4)


class PccdError(Exception):
    """A call or a step failed.

    status  enum Status (an int that it does not know, from a newer daemon)
    name    "E_BUSY"
    text    what was wrong, with names and numbers
    """

    def __init__(self, status: int, text: str) -> None:
        known = status in abi.Status.__members__.values()
        self.status: int = abi.Status(status) if known else status
        self.name = quick.pccd_status_name(status).decode()
        self.text = text or quick.pccd_status_text(status).decode()
        super().__init__(f"{self.name}: {self.text}")

    def __reduce__(self) -> Any:
        return type(self), (self.status, self.text)  # of a task in another process


def failure(handle: Any, status: int) -> PccdError:
    """Why the last call with this client (None: the last connect) failed."""
    return PccdError(status, quick.pccd_error_text(handle).decode(errors="replace"))


# ---- one thread at a time ------------------------------------------------------------

_Class = TypeVar("_Class", bound=type)
_Function = TypeVar("_Function")


_turns: weakref.WeakSet[Any] = weakref.WeakSet()


def new_turn() -> Any:
    """Of the thread that is in a call."""
    turn = threading.RLock()
    _turns.add(turn)
    return turn


def _on_forked() -> None:
    """The threads that were in calls are not in this process."""
    for turn in _turns:
        turn._at_fork_reinit()


os.register_at_fork(after_in_child=_on_forked)


def _in_turn(method: Any) -> Any:
    @functools.wraps(method)
    def call(self: Any, *arguments: Any, **named: Any) -> Any:
        turn = self._turn
        if not turn.acquire(False):
            raise PccdError(abi.Status.E_BUSY, "another thread is in a call with this "
                            "client, which belongs to one thread at a time: connect one "
                            "for each")
        try:
            return method(self, *arguments, **named)
        finally:
            turn.release()

    return call


def any_thread(method: _Function) -> _Function:
    """Marks a method that one_thread_at_a_time leaves alone."""
    setattr(method, "_any_thread", True)
    return method


def one_thread_at_a_time(made: _Class) -> _Class:
    """Of a class whose objects have a `_turn`: while a thread is in one of its public
    methods, or of another object with the same turn, calls of other threads are E_BUSY,
    before they have done anything."""
    methods: Dict[str, Any] = {}
    for base in reversed(made.__mro__):
        methods.update(vars(base))
    for name, method in methods.items():
        if isinstance(method, FunctionType) and not name.startswith("_") and \
                not hasattr(method, "_any_thread"):
            setattr(made, name, _in_turn(method))
    return made
