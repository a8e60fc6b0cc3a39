"""weld.py - vertices of arrays that are one, though they are apart.

Room:     client/python. May import: numpy, values.
Does:     what `pccdctl check --weld` does with files.
"""

from __future__ import annotations

from typing import Dict, List, NamedTuple, Sequence, Tuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .abi import Status
from .values import pack_indices, pack_vertices, refusal

_CELLS = 4  # a cell is so many distances wide: most vertices are looked for in one


class Welded(NamedTuple):
    """Triangles, edges and points with the least vertex at each place, and what became of
    the others: to[v] is the vertex that stands for v, joined how many others stand for,
    apart how many stay because they move away from the same place."""
    triangles: NDArray[np.uint32]
    edges: NDArray[np.uint32]
    points: NDArray[np.uint32]
    to: NDArray[np.uint32]
    joined: int
    apart: int


def weld(frames: Sequence[ArrayLike], triangles: ArrayLike = (), edges: ArrayLike = (),
         points: ArrayLike = (), distance: float = 0.0) -> Welded:
    """Find the vertices that are at one place in every one of `frames`, each an array
    [vertices, 3]: equal to the last bit, or at most `distance` apart. Vertices are not
    renumbered: the arrays of positions stay as they are, and what is joined is named no
    more. PccdError: E_INVAL for no frame or arrays of other shapes, E_INDEX for
    a vertex that is not there."""
    places = [pack_vertices("a frame", x).astype(np.float64) for x in frames]
    if not places or any(x.shape != places[0].shape for x in places):
        raise refusal(Status.E_INVAL, "frames are not one array (n, 3) or several of "
                      "one n")
    if not 0 <= distance < np.inf:
        raise refusal(Status.E_INVAL, f"distance is {distance}")
    named = [_indices(name, numbers, width) for name, numbers, width in
             (("triangles", triangles, 3), ("edges", edges, 2), ("points", points, 1))]
    used = np.unique(np.concatenate([numbers.ravel() for numbers in named]))
    if len(used) > 0 and used[-1] >= len(places[0]):
        raise refusal(Status.E_INDEX, f"vertex {used[-1]} of {len(places[0])}")
    to = np.arange(len(places[0]), dtype=np.uint32)
    group = np.zeros(len(used), np.uint32)
    first = 0
    for frame, x in enumerate(places):
        group = _join(x[used], group, distance)
        if frame == 0:
            first = int(np.count_nonzero(group != np.arange(len(used))))
    to[used] = used[group]
    joined = int(np.count_nonzero(group != np.arange(len(used))))
    three, two, one = (to[numbers] for numbers in named)
    return Welded(three, two, one, to, joined, first - joined)


def _indices(name: str, numbers: ArrayLike, width: int) -> NDArray[np.uint32]:
    """Of `width` vertices each; of a kind that is not there, none."""
    if np.size(numbers) == 0:
        return np.empty((0, width) if width > 1 else 0, np.uint32)
    return pack_indices(name, numbers, width)


def _join(x: NDArray[np.float64], group: NDArray[np.uint32],
          distance: float) -> NDArray[np.uint32]:
    """The least one of the same group that each can be joined to."""
    if distance == 0 and len(x) > 0:
        keys = np.column_stack([(x + 0.0).view(np.int64), group.astype(np.int64)])
        _, least, which = np.unique(keys, axis=0, return_index=True, return_inverse=True)
        found: NDArray[np.uint32] = least.astype(np.uint32)[which.ravel()]
        return found
    made = np.arange(len(x), dtype=np.uint32)
    cells: Dict[Tuple[float, ...], List[int]] = {}
    for i, place in enumerate(x):
        ends = [np.floor((place + by) / (_CELLS * distance))
                for by in (-distance, distance)]
        around = {tuple(ends[corner >> k & 1][k] for k in range(3))
                  for corner in range(8)}
        best = min((j for cell in around for j in cells.get((group[i], *cell), ())
                    if _is_near(place, x[j], distance)), default=i)
        made[i] = best
        if best == i:
            own = tuple(np.floor(place / (_CELLS * distance)))
            cells.setdefault((group[i], *own), []).append(i)
    return made


def _is_near(a: NDArray[np.float64], b: NDArray[np.float64], distance: float) -> bool:
    apart = 0.0
    for k in range(3):
        apart = apart + ((a[k] - b[k]) / distance) ** 2  # as pccdctl adds them
    return bool(apart <= 1)
