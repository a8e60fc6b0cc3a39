"""shape.py - an object at a moment, and whether it is still the same surface.

Room:     client/blender. Needs numpy; no Blender.
Does:     hold what extract.py has read; name what is wrong with it.
"""

import dataclasses

import numpy as np


class Refusal(Exception):
    """What cannot be checked, and why, in a sentence for whoever asked."""


@dataclasses.dataclass(frozen=True)
class Shape:
    """An object with its modifiers applied. x (n, 3) float64: in world space. corners
    (c,): vertex indices of the polygons, one polygon after the other. sizes (p,): how
    many of these each polygon has. triangles (m, 3): the polygons cut into triangles, or
    None where nobody asked. modifiers: their names, for messages."""

    name: str
    x: np.ndarray
    corners: np.ndarray
    sizes: np.ndarray
    triangles: np.ndarray = None
    modifiers: tuple = ()


def plural(count, one, many=None):
    """"1 vertex", "2 vertices"."""
    return f"{count} {one if count == 1 else many or one + 's'}"


def frame_text(moment):
    """"12", or "12.25" where a step begins within a frame."""
    return f"{moment:.6g}"


def check_shape(shape, moment):
    """Refuse what no answer would be right for."""
    at = f'"{shape.name}" at frame {frame_text(moment)}'
    if len(shape.sizes) == 0:
        raise Refusal(f"{at} has no faces" +
                      (" after its modifiers (" + ", ".join(shape.modifiers) + ")"
                       if shape.modifiers else "") +
                      ": take it off the list, or give it some")
    wrong = np.flatnonzero(~np.isfinite(shape.x).all(1))
    if len(wrong):
        raise Refusal(f"{at}: vertex {wrong[0]} is nowhere (its place is not a number or "
                      f"infinite), and so are {len(wrong) - 1} more: bake it anew, or "
                      "leave the frame out")


def _size_text(shape):
    return (plural(len(shape.x), "vertex", "vertices") + ", " +
            plural(len(shape.sizes), "face"))


def check_same(before, shape, moment_before, moment):
    """Refuse an object whose faces are not those of before: nobody knows then which
    vertex has gone where."""
    if len(before.x) == len(shape.x) and np.array_equal(before.sizes, shape.sizes) and \
            np.array_equal(before.corners, shape.corners):
        return
    text = (f'"{shape.name}" is another mesh at frame {frame_text(moment)} '
            f"({_size_text(shape)}) than at frame {frame_text(moment_before)} "
            f"({_size_text(before)}), so that nobody knows which vertex went where")
    if shape.modifiers:
        text += "; its modifiers are " + ", ".join(shape.modifiers) + \
            ": switch off the one that cuts or remeshes"
    raise Refusal(text)
