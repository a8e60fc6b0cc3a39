"""bakes.py - a cloth that is let down, frame by frame: numbers, for tests.

Room:     tests/blender. Needs numpy; no Blender.
Does:     the positions that a bake has, as Blender keeps them (float32), and the files
          that Blender and pccdctl read them from.
"""

import struct

import numpy as np

FRAMES, SIDE = 9, 13


def cloth(lowest, frames=FRAMES):
    """A sheet, a list of float32 (n, 3), and its quads (m, 4). It is let down by 0.15 a
    frame, but no deeper than so far; a little of it hangs, so that it is not flat."""
    at = np.linspace(-1, 1, SIDE)
    x, y = np.meshgrid(at, at, indexing="ij")
    made = []
    for k in range(frames):
        z = max(1.1 - 0.15 * k, lowest) - 0.1 * (x * x + y * y)
        made.append(np.stack([x, y, z], -1).reshape(-1, 3).astype(np.float32))
    ids = np.arange(SIDE * SIDE).reshape(SIDE, SIDE)
    quads = np.stack([ids[:-1, :-1], ids[1:, :-1], ids[1:, 1:], ids[:-1, 1:]], -1)
    return made, quads.reshape(-1, 4)


def ball(radius=0.5, rings=8, segments=12):
    """Vertices (n, 3) of float32 and triangles (m, 3) of a sphere around the origin."""
    vertices, triangles = [(0, 0, radius), (0, 0, -radius)], []
    for ring in range(1, rings):
        angle = np.pi * ring / rings
        for k in range(segments):
            turn = 2 * np.pi * k / segments
            vertices.append(radius * np.array([np.sin(angle) * np.cos(turn),
                                               np.sin(angle) * np.sin(turn),
                                               np.cos(angle)]))
    first = lambda ring, k: 2 + (ring - 1) * segments + k % segments
    for k in range(segments):
        triangles.append((0, first(1, k), first(1, k + 1)))
        triangles.append((1, first(rings - 1, k + 1), first(rings - 1, k)))
        for ring in range(1, rings - 1):
            a, b = first(ring, k), first(ring, k + 1)
            c, d = first(ring + 1, k), first(ring + 1, k + 1)
            triangles += [(a, c, d), (a, d, b)]
    return np.float32(vertices), np.array(triangles)


def write_pc2(path, frames):
    """A point cache, which Blender's modifier Mesh Cache plays."""
    with open(path, "wb") as file:
        file.write(struct.pack("<12siiffi", b"POINTCACHE2\0", 1, len(frames[0]), 1.0, 1.0,
                               len(frames)))
        for one in frames:
            file.write(one.tobytes())


def write_obj(path, x, triangles):
    """For pccdctl: every digit that a double has."""
    with open(path, "w", encoding="ascii") as file:
        file.writelines(f"v {a!r} {b!r} {c!r}\n" for a, b, c in x.astype(float).tolist())
        file.writelines(f"f {a} {b} {c}\n" for a, b, c in (triangles + 1).tolist())
