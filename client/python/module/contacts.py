"""contacts.py - the contacts that pccdctl check writes as CSV, as Parquet or HDF5.

Room:     client/python. Needs numpy; h5py for HDF5.
Does:     a column for each of the CSV with --geometry, and `step` in any case: whole
          numbers (-1: the kind has fewer vertices), doubles (NaN: mode pairs has none),
          text. Rows are read and written in pieces, so memory does not grow with them.
Threads:  any.
"""

from __future__ import annotations

import csv
import importlib
import os
from typing import Any, Dict, Iterator, List

import numpy as np

from . import parquet
from .files import Refusal

HDF5 = (".h5", ".hdf5")
PARQUET = (".parquet",)
ROWS = 1 << 16  # of a piece
WHOLE = ("step", "i0", "i1", "i2", "i3", "proved")
REAL = ("toi", "toi_hi", *(side + axis for side in "abn" for axis in "xyz"))

Piece = Dict[str, Any]  # arrays of numpy, lists of text


def is_named(path: str) -> bool:
    """Whether the file is one of these."""
    return path.lower().endswith(HDF5 + PARQUET)


def need(path: str) -> None:
    """A Refusal where its writer is missing: before the work."""
    try:
        if path.lower().endswith(HDF5):
            importlib.import_module("h5py")
    except ImportError:
        raise Refusal(f"{path}: this needs the Python module h5py (Debian: "
                      "python3-h5py); Parquet and CSV need none") from None


def _piece(head: List[str], rows: List[List[str]]) -> Piece:
    columns = dict(zip(head, zip(*rows))) if rows else {name: () for name in head}
    if "step" not in columns:
        columns = {"step": ("1",) * len(rows), **columns}
    piece: Piece = {}
    for name, values in columns.items():
        if name in WHOLE:
            piece[name] = np.array([value or "-1" for value in values], np.int64)
        elif name in REAL:
            piece[name] = np.array([value or "nan" for value in values], np.float64)
        else:
            piece[name] = list(values)
    return piece


def _pieces(path: str) -> Iterator[Piece]:
    """At least one, which may have no rows."""
    with open(path, newline="", encoding="utf-8", errors="backslashreplace") as source:
        reader = csv.reader(source)
        head = next(reader)
        rows: List[List[str]] = []
        is_first = True
        for row in reader:
            rows.append(row)
            if len(rows) == ROWS:
                yield _piece(head, rows)
                rows, is_first = [], False
        if rows or is_first:
            yield _piece(head, rows)


def _write_hdf5(pieces: Iterator[Piece], path: str) -> None:
    h5py = importlib.import_module("h5py")
    with h5py.File(path, "w") as file:
        group, count = file.create_group("contacts"), 0
        for piece in pieces:
            more = len(piece["kind"])
            for name, values in piece.items():
                if name not in group:
                    is_text = isinstance(values, list)
                    group.create_dataset(
                        name, (0,), h5py.string_dtype() if is_text else values.dtype,
                        maxshape=(None,), chunks=(ROWS,))
                group[name].resize((count + more,))
                if more > 0:
                    group[name][count:] = values
            count += more


def write(table: str, path: str) -> None:
    """The CSV file `table` as `path`, which appears whole or not at all."""
    made = f"{path}.{os.getpid()}.part"
    to_hdf5 = path.lower().endswith(HDF5)
    try:
        (_write_hdf5 if to_hdf5 else parquet.write)(_pieces(table), made)
        os.replace(made, path)
    except OSError as error:
        raise Refusal(f"{path}: cannot write: {error}") from None
    finally:
        if os.path.exists(made):
            os.remove(made)
