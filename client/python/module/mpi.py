"""mpi.py - one scene over the ranks of an MPI program: libpccd-mpi.

Room:     client/python. May import: abi, answer, frame, library, values, numpy; mpi4py,
          which has to be of the MPI that libpccd-mpi was built for.
Does:     the calls of pccd_mpi.h, with numpy arrays.
Threads:  one, but for cancel, which is for any; every call but close, feature and cancel
          is collective.

    from mpi4py import MPI
    import pccd.mpi

    with pccd.mpi.World(MPI.COMM_WORLD) as world:      # each rank gives what it has
        mesh = world.mesh_create(x, triangles, vertex_total=9000, triangle_total=17000)
        cloth = world.add(mesh)
        motions = pccd.Motions()
        motions.x1(cloth, x1)                           # of this rank's vertices
        answer = world.step(motions)                    # contacts: this rank's share
"""

from __future__ import annotations

import ctypes
import os
from ctypes import POINTER, byref, c_char_p, c_double, c_int, c_size_t, c_uint32
from ctypes import c_uint64, c_void_p
from typing import Any, List, Optional, Union

import numpy as np
from mpi4py import MPI
from numpy.typing import ArrayLike, NDArray

from . import abi
from .answer import Answer as _Answer
from .answer import _address
from .abi import Status
from .frame import Motions
from .library import PccdError, any_thread, lib, new_turn, one_thread_at_a_time
from .values import (StepSettings, format_of, milliseconds, near_settings,
                     object_settings, pack_indices, pack_vertices, put, real_numbers,
                     refusal, u32, with_size)

NAME = "libpccd-mpi.so.0"
DEFAULT = StepSettings()


class _Options(ctypes.Structure):  # struct pccd_mpi_options
    _fields_ = [("struct_bytes", c_size_t), ("timeout_ms", c_int), ("threads", c_uint32),
                ("result_bytes", c_uint64), ("record_limit", c_uint64)]


class _Part(ctypes.Structure):  # struct pccd_mpi_part
    _fields_ = [("struct_bytes", c_size_t), ("vertex_total", c_uint32),
                ("triangle_total", c_uint32), ("vertex_count", c_uint32),
                ("vertices", c_void_p), ("format", c_int), ("x", c_void_p),
                ("radii", c_void_p), ("triangle_count", c_uint32),
                ("edge_count", c_uint32), ("point_count", c_uint32),
                ("triangles", c_void_p), ("triangle_numbers", c_void_p),
                ("edges", c_void_p), ("points", c_void_p)]


class RankShare(ctypes.Structure):
    """What the last step was spread over the ranks like: struct pccd_mpi_share."""

    _fields_ = [("struct_bytes", c_size_t), ("own", c_uint64), ("ghosts", c_uint64),
                ("own_vertices", c_uint64), ("ghost_vertices", c_uint64),
                ("sent_bytes", c_uint64), ("work", c_uint64), ("imbalance", c_double),
                ("cuts", c_uint64), ("searches", c_uint64)]


_comm: Any = c_void_p if MPI._sizeof(MPI.Comm) == ctypes.sizeof(c_void_p) else c_int
_each = ctypes.CFUNCTYPE(c_int, c_void_p, c_void_p, c_uint64)


def _load() -> Any:
    """The library that lies beside libpccd."""
    try:
        library = ctypes.CDLL(os.path.join(os.path.dirname(lib._name), NAME))
    except OSError as problem:
        raise ImportError("pccd.mpi needs libpccd-mpi, which is built if configure is "
                          f"told --with-mpi: {problem}") from None
    world, handle = c_void_p, c_uint32
    for name, parameters in {
            "open": [_comm, POINTER(_Options), POINTER(c_void_p)], "close": [world],
            "error_text": [world], "cancel": [world],
            "mesh_put": [world, POINTER(_Part), POINTER(handle), c_void_p],
            "mesh_destroy": [world, handle], "add": [world, handle, POINTER(handle)],
            "remove": [world, handle], "object_set": [world, handle, c_void_p],
            "pair_ignore": [world, handle, handle, ctypes.c_bool],
            "step": [world, c_void_p, c_uint32, c_void_p, c_void_p],
            "near": [world, c_void_p, c_uint32, c_void_p, c_void_p],
            "gather": [world, c_int, _each, c_void_p],
            "feature": [world, handle, c_uint32, c_uint32, c_void_p],
            "get_share": [world, POINTER(RankShare)]}.items():
        function = getattr(library, "pccd_mpi_" + name)
        function.argtypes, function.restype = parameters, c_int
    library.pccd_mpi_close.restype = library.pccd_mpi_cancel.restype = None
    library.pccd_mpi_error_text.restype = c_char_p
    return library


_mpi = _load()


class Answer(_Answer):
    """As pccd.Answer. Its records are this rank's, in canonical order, and a copy: the
    library frees its own at the next call. All numbers but count are those of the whole
    answer."""

    _copied: NDArray[Any]

    @property
    def records(self) -> NDArray[Any]:
        """(count,) of CONTACT, PAIR, NEAR or float64."""
        return self._copied

    def release(self) -> None:
        """Nothing is to be released."""


def _copy(address: Optional[int], dtype: Any, count: int) -> NDArray[Any]:
    if not address or not count:
        return np.empty(0, dtype)
    memory = (ctypes.c_char * (count * dtype.itemsize)).from_address(address)
    return np.frombuffer(memory, dtype).copy()


@one_thread_at_a_time
class World:
    """A scene of all ranks of `comm`. Arguments that a rank gives alone are its part of a
    mesh and the motions of its vertices; all others are the same on every rank, or the
    call fails on all of them (PccdError)."""

    def __init__(self, comm: Optional[MPI.Comm] = None, *, timeout: float = 60,
                 threads: int = 0, result_bytes: int = 0, record_limit: int = 0) -> None:
        comm = MPI.COMM_WORLD if comm is None else comm
        options = with_size(_Options())
        for name, value in (("timeout_ms", milliseconds("timeout", timeout)),
                            ("threads", threads), ("result_bytes", result_bytes),
                            ("record_limit", record_limit)):
            put(options, name, value)
        self._handle: Any = c_void_p()
        self._turn = new_turn()
        self._rank, self._of = comm.rank, np.dtype(np.uint8)
        self._check(_mpi.pccd_mpi_open(_comm.from_address(MPI._addressof(comm)),
                                       byref(options), byref(self._handle)))

    def _check(self, status: int) -> None:
        if status:
            text = _mpi.pccd_mpi_error_text(self._handle)
            raise PccdError(status, text.decode(errors="replace"))

    def _open(self) -> Any:
        if not self._handle:
            raise refusal(Status.E_STATE, "the world is closed")
        return self._handle

    def close(self) -> None:
        """Free it; before MPI ends."""
        handle, self._handle = self._handle, c_void_p()
        _mpi.pccd_mpi_close(handle)

    def __enter__(self) -> World:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def mesh_create(self, x: ArrayLike, triangles: Optional[ArrayLike] = None, *,
                    vertex_total: int, triangle_total: int,
                    vertices: Optional[ArrayLike] = None,
                    triangle_numbers: Optional[ArrayLike] = None,
                    radii: Optional[ArrayLike] = None,
                    edges: Optional[ArrayLike] = None,
                    points: Optional[ArrayLike] = None, mesh: int = 0) -> int:
        """This rank's part of a mesh, of which all ranks together have vertex_total
        vertices and triangle_total triangles: positions x (n, 3) of its vertices, whose
        numbers in the whole mesh are `vertices` (None: those after the ranks before), and
        triangles of any vertices, by these numbers. mesh: replace that one."""
        made = c_uint32(u32("mesh", mesh))
        try:
            part, _kept = self._part(x, triangles, vertex_total, triangle_total, vertices,
                                     triangle_numbers, radii, edges, points)
        except PccdError:  # the other ranks are to hear of it
            _mpi.pccd_mpi_mesh_put(self._open(), None, None, None)
            raise
        self._check(_mpi.pccd_mpi_mesh_put(self._open(), byref(part), byref(made), None))
        return made.value

    @staticmethod
    def _part(x: ArrayLike, triangles: Optional[ArrayLike], vertex_total: int,
              triangle_total: int, vertices: Optional[ArrayLike],
              triangle_numbers: Optional[ArrayLike], radii: Optional[ArrayLike],
              edges: Optional[ArrayLike], points: Optional[ArrayLike]) -> Any:
        """For the library, and the arrays that are to stay meanwhile."""
        placed = pack_vertices("x", x)
        part = with_size(_Part(vertex_total=u32("vertex_total", vertex_total),
                               triangle_total=u32("triangle_total", triangle_total)))
        part.x, part.format = placed.ctypes.data, format_of(placed.dtype)
        part.vertex_count, kept = len(placed), [placed]
        for name, given, width in (("triangles", triangles, 3), ("edges", edges, 2),
                                   ("points", points, 1), ("vertices", vertices, 1),
                                   ("triangle_numbers", triangle_numbers, 1)):
            if given is not None:
                kept.append(pack_indices(name, given, width))
                setattr(part, name, kept[-1].ctypes.data)
                if name in ("triangles", "edges", "points"):
                    setattr(part, name[:-1] + "_count", len(kept[-1]))
        if radii is not None:
            kept.append(np.ascontiguousarray(real_numbers("radii", radii), np.float64))
            part.radii = kept[-1].ctypes.data
        for name, given, count in (("vertices", vertices, part.vertex_count),
                                   ("radii", radii, part.vertex_count),
                                   ("triangle_numbers", triangle_numbers,
                                    part.triangle_count)):
            if given is not None and np.shape(given) != (count,):
                raise refusal(Status.E_INVAL, f"{name} has the shape {np.shape(given)}, "
                              f"not ({count},)")
        return part, kept

    def mesh_destroy(self, mesh: int) -> None:
        """No object may have it."""
        self._check(_mpi.pccd_mpi_mesh_destroy(self._open(), u32("mesh", mesh)))

    def add(self, mesh: int) -> int:
        """An object with that mesh: its handle."""
        made = c_uint32()
        self._check(_mpi.pccd_mpi_add(self._open(), u32("mesh", mesh), byref(made)))
        return made.value

    def remove(self, object: int) -> None:
        """Take an object out of the scene."""
        self._check(_mpi.pccd_mpi_remove(self._open(), u32("object", object)))

    def object_set(self, object: int, **attributes: Optional[float]) -> None:
        """Set those of ObjectSettings that are given."""
        settings = object_settings(attributes)
        self._check(_mpi.pccd_mpi_object_set(self._open(), u32("object", object),
                                             byref(settings)))

    def pair_ignore(self, object_a: int, object_b: int, ignored: bool = True) -> None:
        """Have two objects ignore each other, or not any more."""
        self._check(_mpi.pccd_mpi_pair_ignore(
            self._open(), u32("object_a", object_a), u32("object_b", object_b), ignored))

    def step(self, motions: Optional[Motions] = None,
             settings: StepSettings = DEFAULT) -> Answer:
        """A step of the whole scene; `motions` are of this rank's vertices."""
        return self._ask(_mpi.pccd_mpi_step, motions, settings)

    def near(self, what: Union[int, str] = abi.NearWhat.PAIRS,
             distance: Optional[float] = None, motions: Optional[Motions] = None,
             **settings: Any) -> Answer:
        """What is near in the whole scene; arguments as of Client.near."""
        return self._ask(_mpi.pccd_mpi_near, motions,
                         byref(near_settings(what, distance, **settings)))

    @any_thread
    def cancel(self) -> None:
        """From another thread: end the step or question that this rank is in, on all
        ranks; incomplete is CANCELLED if anything was left to do. While this rank is in
        none, nothing happens."""
        _mpi.pccd_mpi_cancel(self._handle)

    def _ask(self, call: Any, motions: Optional[Motions], settings: Any) -> Answer:
        answer: Answer = with_size(Answer())
        count = 0 if motions is None else len(motions)
        structs = None if motions is None else motions._structs
        self._check(call(self._open(), structs, count, settings, byref(answer)))
        self._of = answer._dtype()
        answer._copied = _copy(_address(answer), self._of, answer.count)
        return answer

    def gather(self, root: int = 0) -> Optional[NDArray[Any]]:
        """All records of the last answer in canonical order, on rank `root`; None on the
        others."""
        pages: List[NDArray[Any]] = [np.empty(0, self._of)]

        def take(_context: Any, records: int, count: int) -> int:
            pages.append(_copy(records, self._of, count))
            return 0

        self._check(_mpi.pccd_mpi_gather(self._open(), root, _each(take), None))
        return np.concatenate(pages) if self._rank == root else None

    def feature(self, object: int, points: int, feature: int) -> NDArray[np.uint32]:
        """Of a feature in this rank's records the numbers of its vertices in the whole
        mesh; points: 1 a vertex, 2 an edge, 3 a face. Not collective."""
        vertices = np.zeros(3, np.uint32)
        self._check(_mpi.pccd_mpi_feature(self._open(), u32("object", object),
                                          u32("points", points), u32("feature", feature),
                                          vertices.ctypes.data))
        return vertices[:points]

    def share(self) -> RankShare:
        """What this rank had of the last step."""
        share: RankShare = with_size(RankShare())
        self._check(_mpi.pccd_mpi_get_share(self._open(), byref(share)))
        return share
