"""weld.py - vertices of arrays that are one, though they are apart.

Room:     client/python. May import: numpy.
Does:     what `pccdctl check --weld` does with files.
"""

from __future__ import annotations

from typing import Dict, List, NamedTuple, Sequence, Tuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

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
    more. ValueError: no frame, or arrays of other shapes."""
    places = [np.asarray(x, np.float64) for x in frames]
    if not places or any(x.ndim != 2 or x.shape != (len(places[0]), 3) for x in places):
        raise ValueError("frames: arrays [vertices, 3] of one length, at least one")
    if not distance >= 0:
        raise ValueError("distance: 0 and above")
    named = [np.asarray(numbers, np.uint32).reshape(-1, width)
             for numbers, width in ((triangles, 3), (edges, 2), (points, 1))]
    used = np.unique(np.concatenate([numbers.ravel() for numbers in named]))
    if len(used) > 0 and used[-1] >= len(places[0]):
        raise ValueError(f"vertex {used[-1]} of {len(places[0])}")
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
    return Welded(three, two, one.ravel(), to, joined, first - joined)


def _join(x: NDArray[np.float64], group: NDArray[np.uint32],
          distance: float) -> NDArray[np.uint32]:
    """The least one of the same group that each can be joined to."""
    if distance == 0 and len(x) > 0:
        keys = np.column_stack([(x + 0.0).view(np.int64), group.astype(np.int64)])
        _, least, which = np.unique(keys, axis=0, return_index=True, return_inverse=True)
        return least.astype(np.uint32)[which.ravel()]
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
