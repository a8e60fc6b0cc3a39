#!/usr/bin/env python3
"""example_cloth_thick.py - a cloth with a thickness falls on a ball and passes through
nothing, itself included.

Room:     client/python. Imports pccd, numpy and the example beside it.
Does:     as examples/cloth_thick.c: ask which features come within their distance on the
          way, move those apart along the normals, with friction, ask again; then go as
          far as is safe.
          After each frame it looks whether anything is nearer than that, or crosses.

    example_cloth_thick.py [FRAMES [FILE]]      FILE: a recording, for pccdctl render
"""

import sys

import numpy as np

import pccd
from example_cloth_near import RADIUS, relax, sheet

FALL = 1e-4  # gravity, in units per frame squared
THICK = 4e-3  # half the cloth's thickness; an edge is 0.067
APART = 2 * THICK * 1.05  # where the response brings what meets
ROUNDS = 8
FRICTION = 0.5  # of the way past each other that is taken back


def features(contacts, triangles, edges):
    """Of each contact the four vertices, and the weights with which the point of feature
    b is taken from that of feature a."""
    p, q = contacts["param"].astype(float).T
    a, b = contacts["feature_a"], contacts["feature_b"]
    face = (contacts["kind"] == pccd.Kind.VF)[:, None]
    vf = np.c_[a, triangles[np.where(face[:, 0], b, 0)]]
    ee = np.c_[edges[np.where(face[:, 0], 0, a)], edges[np.where(face[:, 0], 0, b)]]
    one = np.ones_like(p)
    return (np.where(face, vf, ee),
            np.where(face, np.c_[one, p + q - 1, -p, -q], np.c_[1 - p, p, q - 1, -q]))


def push(x, end, contacts, triangles, edges, cloth):
    """Bring the features of each contact to a distance at the end of the frame. The ball,
    whose vertices come behind those of the cloth, does not give way."""
    vertices, weights = features(contacts, triangles, edges)
    normals = contacts["normal"].astype(float)
    gap = np.einsum("ci,cik,ck->c", weights, end[vertices], normals)
    past = np.einsum("ci,cik->ck", weights, (end - x)[vertices])
    past -= np.einsum("ck,ck->c", past, normals)[:, None] * normals
    weights = np.where((vertices < cloth) & (gap < APART)[:, None], weights, 0)
    give = (weights**2).sum(1)
    way = (APART - gap)[:, None] * normals - FRICTION * past
    way /= np.where(give > 0, give, np.inf)[:, None]
    move = weights[:, :, None] * way[:, None]
    count = np.bincount(vertices.reshape(-1), minlength=len(end))[:, None]
    total = np.zeros_like(end)
    np.add.at(total, vertices, move)
    end += 1.5 * total / np.maximum(count, 1.5)


def is_clear(client, scene):
    """Nothing is nearer than the thicknesses say, and nothing crosses."""
    found = 0
    for what in (pccd.NearWhat.PAIRS, pccd.NearWhat.CROSSINGS):
        with client.near(scene, what) as answer:
            found += answer.total + int(answer.incomplete)
    return found == 0


def main():
    frames = int(sys.argv[1]) if len(sys.argv) > 1 else 60
    flat, triangles = sheet()
    count, side = len(flat), int(len(flat)**0.5)
    cube = np.c_[2 * flat - 1, np.ones(count)]
    x = np.concatenate([np.c_[flat - (0.47, 0.52), np.full(count, RADIUS + 0.02)],
                        RADIUS * cube / np.linalg.norm(cube, axis=1, keepdims=True)])
    triangles = np.concatenate([triangles, triangles + count]).astype(np.uint32)
    at = np.arange(count).reshape(side, side)
    links = np.concatenate([np.stack([at[:, :-1], at[:, 1:]], -1).reshape(-1, 2),
                            np.stack([at[:-1], at[1:]], -1).reshape(-1, 2)])
    was, end, reached, met = x.copy(), x.copy(), x.copy(), 0
    with pccd.connect(private=True) as client:
        if len(sys.argv) > 2:
            client.record_start(sys.argv[2])
        scene = client.scene_create()
        mesh = client.mesh_create(x, triangles)
        edges = client.mesh_edges(mesh)
        handle = client.scene_add(scene, mesh)
        client.object_set(scene, handle, radius=THICK)
        moves = pccd.Motions()
        moves.x0x1(handle, x, end)  # reads the arrays as they are then
        for frame in range(frames):
            free = x + 0.98 * (x - was) - (0, 0, FALL)
            end[:count] = relax(free[:count], links)
            was[:] = x
            for _ in range(ROUNDS):
                with client.step(scene, moves) as answer:
                    if answer.total == 0:
                        break
                    met += answer.total
                    push(x, end, answer.contacts, triangles, edges, count)
            _, answer = client.step_safe(scene, moves, [reached])
            answer.release()
            x[:] = reached
            if not is_clear(client, scene):
                print(f"frame {frame}: something is too near")
                return 1
    print(f"{frames} frames, {met} contacts, nothing is nearer than {2 * THICK}")
    return 0 if met else 1


if __name__ == "__main__":
    sys.exit(main())
