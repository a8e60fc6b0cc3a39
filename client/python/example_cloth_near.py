#!/usr/bin/env python3
"""example_cloth_near.py - a cloth falls on a ball, and no step is looked at for contacts.

Room:     client/python. Imports pccd and numpy, as any user would.
Does:     OGC's trust region, as examples/cloth_near.c does it. The daemon tells how near
          each vertex is to what it could meet; a vertex that moves by less than half of
          that meets nothing that does so, too. A way is gone in small pieces, and the
          daemon is asked after each whether anything crosses or touches.
Source:   "Offset Geometric Contact" (Chen, Hsu, Macklin, Yuksel 2025).
"""

import sys

import numpy as np

import pccd

SIDE, FRAMES, PIECES = 16, 30, 4
REACH = 0.03  # nobody asks for more: a vertex moves by less than half of it
RADIUS = 0.3
FALL = 1e-3  # gravity, in units per frame squared


def sheet():
    """A square of side 1 in the plane: positions and triangles."""
    v, u = np.meshgrid(*2 * [np.linspace(0, 1, SIDE)], indexing="ij")
    corner = (np.arange(SIDE - 1)[:, None] * SIDE + np.arange(SIDE - 1)).reshape(-1)
    lower = np.stack([corner, corner + 1, corner + SIDE], axis=-1)
    upper = np.stack([corner + 1, corner + SIDE + 1, corner + SIDE], axis=-1)
    return np.stack([u.reshape(-1), v.reshape(-1)], -1), np.concatenate([lower, upper])


def relax(x, edges, rounds=10):
    """Bring the vertices to where the cloth's edges have their length again."""
    a, b = edges[:, 0], edges[:, 1]
    share = 1 / np.bincount(edges.reshape(-1), minlength=len(x))[:, None]
    for _ in range(rounds):
        gap = x[b] - x[a]
        stretch = 1 - 1 / ((SIDE - 1) * np.linalg.norm(gap, axis=1, keepdims=True))
        move = np.zeros_like(x)
        np.add.at(move, a, 0.5 * stretch * gap)
        np.add.at(move, b, -0.5 * stretch * gap)
        x = x + 1.5 * share * move
    return x


def main():
    flat, triangles = sheet()
    cloth = np.c_[flat - (0.47, 0.52), np.full(len(flat), RADIUS + 0.02)]
    cube = np.c_[2 * flat - 1, np.ones(len(flat))]  # a face of it, brought to the radius
    ball = RADIUS * cube / np.linalg.norm(cube, axis=1, keepdims=True)
    at = np.arange(SIDE * SIDE).reshape(SIDE, SIDE)
    edges = np.concatenate([np.stack([at[:, :-1], at[:, 1:]], -1).reshape(-1, 2),
                            np.stack([at[:-1], at[1:]], -1).reshape(-1, 2)])
    was, end, held = cloth.copy(), cloth, 0
    with pccd.connect(private=True) as client:
        scene = client.scene_create()
        handle = client.scene_add(scene, client.mesh_create(cloth, triangles))
        client.scene_add(scene, client.mesh_create(ball, triangles))
        moves = pccd.Motions()
        moves.x1(handle, cloth)  # reads the array as it is then
        for piece in range(FRAMES * PIECES):
            if piece % PIECES == 0:
                end = cloth + 0.98 * (cloth - was) - (0, 0, FALL)
                was, end = cloth.copy(), relax(end, edges)
            with client.near(scene, pccd.NearWhat.VERTICES, REACH,
                             object_a=handle) as answer:
                bound = answer.vertex_bounds.copy()
            way = np.linalg.norm(end - cloth, axis=1)
            part = np.minimum(1, 0.49 * bound / np.maximum(way, 1e-300))
            held += int((part < 1).sum())
            cloth += part[:, None] * (end - cloth)
            with client.near(scene, pccd.NearWhat.CROSSINGS, motions=moves) as answer:
                if answer.verdict != pccd.Verdict.NO:
                    print(f"piece {piece}: {answer.total} crossings")
                    return 1
    print(f"{FRAMES} frames, {held} times a vertex was held, nothing touches")
    return 0 if held else 1


if __name__ == "__main__":
    sys.exit(main())
