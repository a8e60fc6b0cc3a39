"""parquet.py - a table as a Parquet file, without another library.

Room:     client/python. Needs numpy.
Does:     columns of whole numbers, doubles and text, none of them null, in pages that are
          plain and uncompressed; a row group for each piece of the table.
Source:   parquet.thrift of Apache Parquet's format; Thrift's compact protocol.
Threads:  any.
"""

from __future__ import annotations

from typing import Any, BinaryIO, Dict, Iterator, List

MAGIC = b"PAR1"
INT64, DOUBLE, BYTES = 2, 5, 6  # types of columns


class Wide(int):
    """A number that has 64 bits where others have 32."""


def _varint(value: int) -> bytes:
    made = bytearray()
    while value > 127:
        made.append(value & 127 | 128)
        value >>= 7
    return bytes((*made, value))


def _kind(value: Any) -> int:
    return (6 if isinstance(value, Wide) else 5 if isinstance(value, int) else
            8 if isinstance(value, bytes) else 9 if isinstance(value, list) else 12)


def _thrift(value: Any) -> bytes:
    """Bytes, a list of one kind, a number that is not negative, or a struct: what it has
    by the numbers of its fields, in their order."""
    if isinstance(value, int):
        return _varint(value << 1)
    if isinstance(value, bytes):
        return _varint(len(value)) + value
    if isinstance(value, list):
        kind = _kind(value[0]) if value else 12
        return (bytes([0xf0 | kind]) + _varint(len(value))
                + b"".join(_thrift(element) for element in value))
    made, before = b"", 0
    for field, member in value.items():
        made += bytes([field - before << 4 | _kind(member)]) + _thrift(member)
        before = field
    return made + b"\0"


def _type(values: Any) -> int:
    return (BYTES if isinstance(values, list) else
            DOUBLE if values.dtype.kind == "f" else INT64)


def _element(name: str, values: Any) -> Dict[int, Any]:
    """What the schema says of a column: required, and of text, that it is UTF-8."""
    made = {1: _type(values), 3: 0, 4: name.encode()}
    return {**made, 6: 0} if isinstance(values, list) else made


def _plain(values: Any) -> bytes:
    if not isinstance(values, list):
        made: bytes = values.astype(values.dtype.newbyteorder("<")).tobytes()
        return made
    texts = (text.encode() for text in values)
    return b"".join(len(text).to_bytes(4, "little") + text for text in texts)


def _write_column(file: BinaryIO, name: str, values: Any) -> Dict[int, Any]:
    """Write a page; what the end of the file says of it."""
    data, begin, count = _plain(values), file.tell(), len(values)
    file.write(_thrift({1: 0, 2: len(data), 3: len(data),
                        5: {1: count, 2: 0, 3: 3, 4: 3}}) + data)
    size = Wide(file.tell() - begin)
    return {2: Wide(begin), 3: {1: _type(values), 2: [0], 3: [name.encode()], 4: 0,
                                5: Wide(count), 6: size, 7: size, 9: Wide(begin)}}


def write(pieces: Iterator[Dict[str, Any]], path: str) -> None:
    """Write a file of a table whose pieces have the same columns: arrays of numpy, int64
    or float64, or lists of text. A piece has fewer than 2^31 bytes in a column."""
    schema: List[Any] = []
    groups: List[Any] = []
    rows = 0
    with open(path, "wb") as file:
        file.write(MAGIC)
        for piece in pieces:
            schema = [{4: b"schema", 5: len(piece)},
                      *(_element(name, values) for name, values in piece.items())]
            count = len(next(iter(piece.values())))
            if count > 0:
                begin = file.tell()
                columns = [_write_column(file, name, values)
                           for name, values in piece.items()]
                groups.append({1: columns, 2: Wide(file.tell() - begin), 3: Wide(count)})
                rows += count
        end = _thrift({1: 1, 2: schema, 3: Wide(rows), 4: groups, 6: b"pccd"})
        file.write(end + len(end).to_bytes(4, "little") + MAGIC)
