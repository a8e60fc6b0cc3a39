"""memory.py - arrays in the library's memory, and what keeps it there.

Room:     client/python. May import: library, numpy.
Does:     libpccd hands over memory that it no longer needs (options.unmap) in the place
          of unmapping it. What no array lies in is unmapped at once; the rest with the
          last array in it. So an array that is used too late has old numbers in it, or
          those of another answer, and is never an access to memory that is not there.
"""

from __future__ import annotations

import ctypes
import sys
import weakref
from typing import Any, Optional

import numpy as np
from numpy.typing import DTypeLike, NDArray

from . import abi

_EVERYTHING = ctypes.c_char * (sys.maxsize >> 17)  # a length that no array goes beyond

_libc = ctypes.CDLL(None)
_libc.munmap.argtypes = [ctypes.c_void_p, ctypes.c_size_t]


class Orphan:
    """Memory that is the arrays' alone."""

    def __init__(self, base: int, size: int) -> None:
        self.base, self.size = base, size

    def __del__(self) -> None:
        _libc.munmap(self.base, self.size)


class Span(_EVERYTHING):  # type: ignore
    """Memory from some address on, which stays for as long as the span, and as the arrays
    in it, which refer to it."""

    __hash__ = object.__hash__
    orphan: Optional[Orphan] = None

    def array(self, dtype: DTypeLike, count: int, offset: int = 0,
              writable: bool = False) -> NDArray[Any]:
        """What lies `offset` bytes from its begin."""
        view = memoryview(self)
        return np.frombuffer(view if writable else view.toreadonly(), dtype, count,
                             offset)


class Memory:
    """The memory of one client."""

    def __init__(self) -> None:
        spans: weakref.WeakSet[Span] = weakref.WeakSet()

        def unmap(_context: Any, base: int, size: int) -> None:
            orphan = Orphan(base, size)
            for span in list(spans):
                if base <= ctypes.addressof(span) < base + size:
                    span.orphan = orphan

        self._spans = spans
        fields: Any = {name: kind for name, kind, *_ in abi.pccd_options._fields_}
        self.unmap = fields["unmap"](unmap)

    def span(self, address: int) -> Span:
        """What lies at an address, and behind it."""
        made: Span = Span.from_address(address)
        self._spans.add(made)
        return made
