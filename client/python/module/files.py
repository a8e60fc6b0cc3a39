"""files.py - meshes of the files that meshio reads, as files that pccdctl reads.

Room:     client/python. Needs numpy and meshio.
Does:     tell what a file's own header counts from what meshio gave, refuse by name what
          meshio is known to lose, take the boundary of solid cells, write OBJ.
Does not: cut polygons, which pccdctl does for all files by one rule; read what pccdctl
          reads itself.
Threads:  any.
"""

from __future__ import annotations

import contextlib
import importlib
import io
import os
import re
import sys
import xml.etree.ElementTree
from typing import Any, Dict, List, Tuple

import numpy as np

# What pccdctl reads itself.
NATIVE = (".ply", ".obj", ".stl", ".glb", ".gltf", ".pc2", ".mdd")
# Of a solid cell its faces, by the places of their corners, outward.
SOLIDS: Dict[str, Tuple[Tuple[int, ...], ...]] = {
    "tetra": ((0, 2, 1), (0, 1, 3), (1, 2, 3), (0, 3, 2)),
    "hexahedron": ((0, 3, 2, 1), (4, 5, 6, 7), (0, 1, 5, 4), (1, 2, 6, 5), (2, 3, 7, 6),
                   (0, 4, 7, 3)),
    "wedge": ((0, 1, 2), (3, 5, 4), (0, 3, 4, 1), (1, 4, 5, 2), (0, 2, 5, 3)),
    "pyramid": ((0, 3, 2, 1), (0, 1, 4), (1, 2, 4), (2, 3, 4), (0, 4, 3)),
}


class Refusal(Exception):
    """Why a file is not read; begins with its name."""


def is_native(path: str) -> bool:
    """Whether pccdctl reads it."""
    return path.lower().endswith(NATIVE)


def _count(pattern: bytes, text: bytes) -> int:
    return sum(int(number) for number in re.findall(pattern, text))


def _judge_vtu(path: str, text: bytes) -> Tuple[int, int]:
    pieces = len(re.findall(rb"<Piece[\s>]", text))
    if pieces != 1:
        raise Refusal(f"{path}: {pieces} pieces, of which meshio keeps the last one's "
                      "cells; write it as one")
    return (_count(rb'NumberOfPoints\s*=\s*"\s*(\d+)', text),
            _count(rb'NumberOfCells\s*=\s*"\s*(\d+)', text))


def _judge_vtk(_path: str, text: bytes) -> Tuple[int, int]:
    points = re.search(rb"^POINTS\s+(\d+)", text, re.MULTILINE)
    cells = re.search(rb"^CELL_TYPES\s+(\d+)", text, re.MULTILINE)
    return (int(points[1]) if points else -1, int(cells[1]) if cells else -1)


def _judge_xdmf(_path: str, text: bytes) -> Tuple[int, int]:
    cells = re.findall(rb'<Topology[^>]*NumberOfElements\s*=\s*"\s*(\d+)\s*"', text)
    return -1, int(cells[0]) if len(cells) == 1 else -1


def _judge_tetgen(path: str, text: bytes) -> Tuple[int, int]:
    count = re.search(rb"^\s*(\d+)", text, re.MULTILINE)
    if count is None:  # meshio would look for it for ever
        raise Refusal(f"{path}: no line says how many there are")
    return -1, int(count[1]) if path.lower().endswith(".ele") else -1


_JUDGES = {".vtu": _judge_vtu, ".vtk": _judge_vtk, ".xdmf": _judge_xdmf,
           ".xmf": _judge_xdmf, ".ele": _judge_tetgen, ".node": _judge_tetgen}
# What meshio loses, or takes for something else, mostly without a word: its pattern, how
# often a file may have it, and what it is; "": the text that is found names itself.
_Lost = Tuple[Tuple[bytes, int, str], ...]
_XDMF: _Lost = ((rb"<Time\b", 0, "a time"), (rb"Temporal", 0, "a series of times"),
                (rb"\bBaseOffset\b", 0, "a BaseOffset"), (rb"\bSeek\b", 0, "a Seek"),
                (rb'Endian\s*=\s*"(?!Little|Native)', 0, "big-endian data"),
                (rb"xi:include", 0, "an include"), (rb"\bReference\b", 0, "a reference"),
                (rb"<Grid[\s>]", 1, "several grids"))
_NASTRAN: _Lost = ((rb"^(INCLUDE|GRDSET)\b", 0, ""),)
_TECPLOT: _Lost = ((rb"^\s*ZONE\b", 1, "several zones"),)
_PERMAS: _Lost = ((rb"^\s*\$COOR\b", 1, "several blocks $COOR"),)
_LOST: Dict[str, _Lost] = {
    ".vtk": ((rb"^(TRIANGLE_STRIPS|DATASET POLYDATA)\b", 0, ""),),
    ".xdmf": _XDMF, ".xmf": _XDMF,
    ".inp": ((rb"^\*\s*NODE\s*(,|$)", 1, "several blocks *NODE"),
             (rb"^\*\s*NODE\b.*\bSYSTEM\s*=\s*[CS]", 0, "*NODE in other coordinates"),
             (rb"^\*\s*INSTANCE\b", 1, "several *INSTANCE"),
             (rb"^\*\s*INSTANCE\b.*\n\s*[^*\s]", 0, "an *INSTANCE that is moved"),
             (rb"^\*\s*(INCLUDE|SYSTEM|NGEN|NFILL|NCOPY|NMAP|ELGEN|ELCOPY)\b", 0, "")),
    ".bdf": _NASTRAN, ".nas": _NASTRAN, ".fem": _NASTRAN,
    ".dat": _TECPLOT, ".tec": _TECPLOT, ".dato": _PERMAS, ".post": _PERMAS,
    ".su2": ((rb"^\s*NPOIN\b", 1, "several zones"),)}


def _judge(path: str) -> Tuple[int, int]:
    """What the file itself says: how many points and cells; -1: that is not known."""
    # meshio takes .dato.gz for plain text, too.
    ending = os.path.splitext(re.sub(r"\.gz$", "", path.lower()))[1]
    if ending == ".fbx":
        raise Refusal(f"{path}: FBX is not read; open it in Blender and export glTF "
                      "(.glb), which pccdctl check reads, animations included")
    judge, lost = _JUDGES.get(ending), _LOST.get(ending, ())
    try:
        with open(path, "rb") as file:
            text = file.read() if judge is not None or lost else b""
    except OSError as problem:
        raise Refusal(f"{path}: cannot open: {problem.strerror}") from None
    for pattern, most, what in lost:
        found = list(re.finditer(pattern, text, re.MULTILINE | re.IGNORECASE))
        if len(found) > most:
            raise Refusal(f"{path}: it has {what or found[0][0].decode()}, which meshio "
                          "loses; write PLY, or a VTU file for each moment")
    return judge(path, text) if judge is not None else (-1, -1)


def _read(path: str) -> Any:
    try:
        meshio = importlib.import_module("meshio")
    except ImportError:
        raise Refusal(f"{path}: python3 has no meshio (Debian: python3-meshio), which "
                      "reads such files") from None
    said = io.StringIO()
    try:
        # It prints what it leaves out, and ends the program where it cannot go on.
        with contextlib.redirect_stdout(said), contextlib.redirect_stderr(said):
            mesh = meshio.read(path)
    except (SystemExit, Exception) as problem:  # pylint: disable=broad-except
        words = " ".join((said.getvalue() or repr(problem)).split())
        raise Refusal(f"{path}: meshio does not read it: {words}") from None
    if said.getvalue().strip():
        words = " ".join(said.getvalue().split())
        complain(f"{path}: meshio says: {words}")
    return mesh


def _corners(face: List[int]) -> List[int]:
    """Without those that stand twice: a quad may be a triangle so, a hexahedron any other
    solid."""
    return [face[k] for k in range(len(face)) if face[k] != face[k - 1]]


def _boundary(cells: List[Tuple[str, Any]]) -> Tuple[List[Any], set[Tuple[int, ...]]]:
    """The faces that one solid cell alone has, in the order of the cells."""
    faces: Dict[Tuple[int, ...], Any] = {}
    for kind, corners in cells:
        for cell in corners.tolist():
            for places in SOLIDS[kind]:
                face = _corners([cell[place] for place in places])
                key = tuple(sorted(face))
                faces[key] = None if key in faces or len(set(face)) < 3 else face
    kept = {key: face for key, face in faces.items() if face is not None}
    return list(kept.values()), set(kept)


class Mesh:
    """Points, and what is between them, as the lines of an OBJ file."""

    def __init__(self, path: str):
        points, cells = _judge(path)
        mesh = _read(path)
        if np.any(mesh.point_data.get("nastran:ref", 0)):
            raise Refusal(f"{path}: points in a coordinate system of their own, which "
                          "meshio passes over; write PLY or VTU")
        self.path = path
        self.points = np.asarray(mesh.points)
        if self.points.ndim != 2 or self.points.shape[1] not in (2, 3):
            raise Refusal(f"{path}: points of shape {self.points.shape}, where (n, 3) or "
                          "(n, 2) is needed")
        blocks = [(str(block.type), np.asarray(block.data)) for block in mesh.cells]
        for what, said, got in (("points", points, len(self.points)),
                                ("cells", cells, sum(len(data) for _, data in blocks))):
            if said not in (-1, got):
                raise Refusal(f"{path}: {said} {what} by the file itself, and meshio "
                              f"gives {got}")
        self.faces: List[Any] = []
        self.lines: List[Any] = []
        self.vertices: List[Any] = []
        self._take(blocks)

    def _take(self, blocks: List[Tuple[str, Any]]) -> None:
        self.faces, known = _boundary([block for block in blocks if block[0] in SOLIDS])
        for kind, data in blocks:
            if kind in ("triangle", "quad") or re.fullmatch(r"polygon\d*", kind):
                # A surface that is named beside its solid is that solid's boundary.
                cut = ((_corners(face), face) for face in data.tolist())
                self.faces += [few if len(few) > 2 else face for few, face in cut
                               if not known or tuple(sorted(few)) not in known]
            elif kind == "line":
                self.lines += data.tolist()
            elif kind == "vertex":
                self.vertices += data.tolist()
            elif kind not in SOLIDS:
                raise Refusal(f"{self.path}: cells of the type {kind} are not read")

    def write(self, path: str) -> None:
        """As OBJ; every number as exact as it is."""
        points = self.points.astype(np.float64)
        if points.shape[1] == 2:
            points = np.column_stack([points, np.zeros(len(points))])
        with open(path, "w", encoding="ascii") as file:
            file.writelines(map("v %.17g %.17g %.17g\n".__mod__,
                                map(tuple, points.tolist())))
            for letter, rows in (("f", self.faces), ("l", self.lines),
                                 ("p", self.vertices)):
                file.writelines(f"{letter} {' '.join(str(v + 1) for v in row)}\n"
                                for row in rows)


def shown(text: str) -> str:
    """A name that cannot control a terminal, as pccdctl shows it."""
    return re.sub("[\x00-\x1f\x7f-\x9f\udc80-\udcff]",
                  lambda one: f"\\x{ord(one[0]) & 0xff:02x}", text)


def complain(text: str) -> None:
    """A line on stderr."""
    print(shown(text), file=sys.stderr)


def _numbered(path: str) -> List[str]:
    """The files of a pattern such as step%d.vtu, as pccdctl takes them; [] of others."""
    folder, name = os.path.split(path)
    found = re.findall(r"%(?:0[1-9]\d?)?d", name)
    if len(found) != 1 or os.path.exists(path):
        return []
    head, tail = name.split(found[0])
    if "%" in head + tail:  # not of the pattern, and not to be formatted
        return []
    try:
        names = set(os.listdir(folder or "."))
    except OSError as problem:
        raise Refusal(f"{path}: cannot read the folder: {problem.strerror}") from None
    fitting = re.compile(re.escape(head) + r"(\d{1,18})" + re.escape(tail))
    numbers = sorted({int(match[1]) for match in map(fitting.fullmatch, names)
                      if match is not None and name % int(match[1]) in names})
    if not numbers:
        raise Refusal(f"{path}: no file has such a name with a number")
    for before, after in zip(numbers, numbers[1:]):
        if after != before + 1:
            raise Refusal(f"{path}: number {before + 1} is missing: there are {before} "
                          f"and {after}")
    return [os.path.join(folder, name % number) for number in numbers]


def expand(path: str) -> List[str]:
    """The files of a pattern or of the moments of a PVD, in their order; otherwise the
    one that it is."""
    if not is_native(path):
        numbered = _numbered(path)
        if numbered:
            return numbered
    if not path.lower().endswith(".pvd"):
        return [path]
    try:
        sets = list(xml.etree.ElementTree.parse(path).iter("DataSet"))
        made = [(float(one.get("timestep", "0")), one.get("file", "")) for one in sets]
    except (OSError, ValueError, xml.etree.ElementTree.ParseError) as problem:
        raise Refusal(f"{path}: no PVD: {problem}") from None
    if not made or len({time for time, _ in made}) != len(made):
        raise Refusal(f"{path}: {len(made)} files, where one for each moment is read")
    folder = os.path.dirname(path)
    return [os.path.join(folder, name) for _, name in sorted(made)]
