#!/usr/bin/env python3
"""example_cloth.py - a cloth falls on a sphere and stays outside of it.

Room:     client/python. Imports pccd and numpy, as any user would.
Does:     a position-based cloth. Each step is put to the daemon; vertices of features
          that meet stop before the time of impact, and the step is asked again until
          nothing meets any more, so that cloth and sphere never cross, nor the cloth
          itself.
          Prints the contacts of each step, and fails when a vertex got inside.
"""

import sys

import numpy as np

import pccd

SIDE = 24  # vertices along an edge of the cloth
STEPS = 60
STEP_S = 1 / 60
TRIES = 12  # shorter motions asked for before the whole cloth waits for the next step


def grid(side):
    """A square of 1.6 m at height 0.65 m: positions and triangles."""
    u, v = np.meshgrid(*2 * [np.linspace(-0.8, 0.8, side)], indexing="ij")
    x = np.stack([u, v, np.full_like(u, 0.65)], axis=-1).reshape(-1, 3)
    corner = (np.arange(side - 1)[:, None] * side + np.arange(side - 1)).reshape(-1)
    lower = np.stack([corner, corner + 1, corner + side], axis=-1)
    upper = np.stack([corner + 1, corner + side + 1, corner + side], axis=-1)
    return x, np.concatenate([lower, upper])


def sphere(rings=16, sides=32, radius=0.5):
    """Rings of vertices between two poles."""
    polar = np.linspace(0, np.pi, rings + 1)[1:-1, None]
    around = np.linspace(0, 2 * np.pi, sides, endpoint=False)[None, :]
    body = np.stack([np.sin(polar) * np.cos(around), np.sin(polar) * np.sin(around),
                     np.broadcast_to(np.cos(polar), (rings - 1, sides))], axis=-1)
    x = radius * np.concatenate([body.reshape(-1, 3), [[0, 0, 1], [0, 0, -1]]])
    at = np.arange((rings - 1) * sides).reshape(rings - 1, sides)
    right = np.roll(at, -1, axis=1)
    faces = [np.stack([at[:-1], at[1:], right[1:]], -1), np.stack([at[:-1], right[1:],
                                                                   right[:-1]], -1)]
    top, bottom = len(x) - 2, len(x) - 1
    faces += [np.stack([np.full(sides, top), at[0], right[0]], -1),
              np.stack([np.full(sides, bottom), right[-1], at[-1]], -1)]
    return x, np.concatenate([face.reshape(-1, 3) for face in faces])


def relax(x, edges, lengths, rounds=12):
    """Pull the edges of the cloth back to their lengths."""
    a, b = edges[:, 0], edges[:, 1]
    share = 1 / np.bincount(edges.reshape(-1), minlength=len(x))[:, None]
    for _ in range(rounds):
        gap = x[b] - x[a]
        length = np.linalg.norm(gap, axis=1, keepdims=True)
        half = 0.5 * (length - lengths) * gap / np.maximum(length, 1e-9)
        move = np.zeros_like(x)
        np.add.at(move, a, half)
        np.add.at(move, b, -half)
        x = x + 1.8 * share * move
    return x


def stop_times(contacts, cloth, edges, triangles, count):
    """For each vertex of the cloth the earliest time at which a feature of it meets
    something; 2: it meets nothing."""
    stop = np.full(count, 2.0)
    vf = contacts["kind"] == pccd.Kind.VF
    for side in "ab":
        ours = contacts["object_" + side] == cloth
        faces_or_vertices = ours & vf
        feature, toi = contacts["feature_" + side], contacts["toi"]
        at = feature[faces_or_vertices]
        corners = at[:, None] if side == "a" else triangles[at]
        np.minimum.at(stop, corners, toi[faces_or_vertices][:, None])
        np.minimum.at(stop, edges[feature[ours & ~vf]], toi[ours & ~vf][:, None])
    return stop


def main():
    x, triangles = grid(SIDE)
    with pccd.connect(private=True) as client:
        scene = client.scene_create()
        mesh = client.mesh_create(x, triangles)
        cloth = client.scene_add(scene, mesh)
        ball = client.scene_add(scene, client.mesh_create(*sphere()))
        client.object_set(scene, ball, self_collision=False)  # it never changes its shape
        edges = client.mesh_edges(mesh)
        lengths = np.linalg.norm(x[edges[:, 0]] - x[edges[:, 1]], axis=1, keepdims=True)
        velocity = np.zeros_like(x)
        for step in range(STEPS):
            velocity[:, 2] -= 9.81 * STEP_S
            x1 = relax(x + velocity * STEP_S, edges, lengths)
            total = 0
            for left in reversed(range(TRIES)):
                with client.step_x0x1(scene, cloth, x, x1) as answer:
                    total += answer.total
                    stop = stop_times(answer.contacts, cloth, edges, triangles, len(x))
                if answer.total == 0:
                    break
                keep = np.where(stop > 1, 1, 0.8 * stop)[:, None] if left > 1 else 0
                x1 = x + keep * (x1 - x)
            velocity, x = 0.99 * (x1 - x) / STEP_S, x1
            print(f"step {step:2}: {total:5} contacts, lowest point {x[:, 2].min():6.3f}")
        inside = int((np.linalg.norm(x, axis=1) < 0.49).sum())
        asked = client.stats()["steps"]
        print(f"{inside} vertices inside the sphere, {asked} steps asked")
    return 1 if inside or x[:, 2].min() > 0.3 else 0


if __name__ == "__main__":
    sys.exit(main())
