"""octahedra.py - the surface of many markers, and their colours.

Room:     client/blender. Needs numpy; no Blender.
Does:     an octahedron for each place, coloured by its time.
Source:   the scale is "plasma" of matplotlib (CC0) at nine places, as in the pictures of
          pccdctl.
"""

import numpy as np

SCALE = np.array([
    (0.050, 0.030, 0.528), (0.294, 0.012, 0.631), (0.492, 0.012, 0.658),
    (0.658, 0.134, 0.588), (0.798, 0.280, 0.470), (0.899, 0.424, 0.360),
    (0.973, 0.585, 0.252), (0.994, 0.770, 0.165), (0.940, 0.975, 0.131)])
CROSSING = (0.0, 0.85, 0.35)  # green, which the scale does not have
COLOURS = np.concatenate([SCALE, [CROSSING]])  # sRGB
TIPS = np.float64([(1, 0, 0), (-1, 0, 0), (0, 1, 0), (0, -1, 0), (0, 0, 1), (0, 0, -1)])
FACES = np.array([(0, 2, 4), (2, 1, 4), (1, 3, 4), (3, 0, 4),
                  (2, 0, 5), (1, 2, 5), (3, 1, 5), (0, 3, 5)])


def colour_indices(kind, times):
    """Of a finding's places: which of COLOURS each has."""
    if kind == "crossing":
        return np.full(len(times), len(SCALE))
    return np.clip(np.rint(times * (len(SCALE) - 1)), 0, len(SCALE) - 1).astype(int)


def linear(colour):
    """What a shader wants: of sRGB, the amount of light."""
    colour = np.asarray(colour, float)
    return np.where(colour <= 0.04045, colour / 12.92, ((colour + 0.055) / 1.055)**2.4)


def octahedra(places, size):
    """Vertices (6 k, 3) and triangles (8 k, 3), outwards, of k octahedra that reach so
    far from their places."""
    vertices = places[:, None] + size * TIPS
    faces = 6 * np.arange(len(places))[:, None, None] + FACES
    return vertices.reshape(-1, 3), faces.reshape(-1, 3)
