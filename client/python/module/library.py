"""library.py - libpccd: where it is found, and what its failures are called.

Room:     client/python. May import: abi.
Does:     load libpccd.so.0: the file that $PCCD_LIBRARY names, or else the first of:
          beside this module, in the build folder that it lies in, where the build
          installs it, where the system's loader finds it. Its release must be the
          module's.
Threads:  `lib` gives Python's lock back while a call runs, so that other threads go on;
          `quick` keeps it, for calls that never wait.
"""

from __future__ import annotations

import ctypes
import os
from typing import Any, List, Tuple

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


lib, quick = load()


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


def failure(handle: Any, status: int) -> PccdError:
    """Why the last call with this client (None: the last connect) failed."""
    return PccdError(status, quick.pccd_error_text(handle).decode(errors="replace"))
