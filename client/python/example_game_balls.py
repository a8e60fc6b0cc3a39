#!/usr/bin/env python3
"""example_game_balls.py - a game's loop: three balls fall into a cloth that hangs by its
corners, and nothing passes through anything.

Room:     client/python. Imports pccd, numpy and the examples beside it.
Does:     as examples/game_balls.c: move all as if nothing were in the way, ask what
          meets, answer each contact by an impulse along its normal, ask again; then go as
          far as is safe. Balls do not turn. After each frame it looks whether anything is
          too near.

    example_game_balls.py [FRAMES]; with PCCD_RECORD=FILE it is recorded, for render
"""

import sys

import numpy as np

import pccd
from example_cloth_near import SIDE, relax, sheet
from example_cloth_thick import is_clear

RINGS, ROUND = 8, 12  # of a ball
SIZE = 0.12  # radius of a ball; the cloth has sides of 1
FALL = 4e-4  # gravity, in units per frame squared
THICK = 4e-3  # what each body adds to the distance at which it is met
APART = 2 * THICK * 1.05
BOUNCE = 0.3  # part of the speed along the normal with which bodies part
LIGHT = 0.08  # mass of a vertex of the cloth; a ball has 1
TRIES = 12


def ball():
    """A globe around 0: positions, the poles first and last, and triangles."""
    up, around = np.meshgrid(np.pi * np.arange(1, RINGS + 1) / (RINGS + 1),
                             2 * np.pi * np.arange(ROUND) / ROUND, indexing="ij")
    rings = np.stack([np.sin(up) * np.cos(around), np.sin(up) * np.sin(around),
                      -np.cos(up)], -1).reshape(-1, 3)
    v = 1 + np.arange(RINGS * ROUND)
    beside = np.where(v % ROUND == 0, v + 1 - ROUND, v + 1)
    below = np.where(v <= ROUND, 0, beside - ROUND)
    above = np.minimum(v + ROUND, RINGS * ROUND + 1)
    return (SIZE * np.concatenate([[(0, 0, -1)], rings, [(0, 0, 1)]]),
            np.concatenate([np.c_[v, below, beside], np.c_[v, beside, above]]))


class Body:
    """An object of the scene. A ball moves as a whole; the cloth hangs by corners."""

    def __init__(self, client, scene, mesh, x, triangles, mass=None):
        self.x, self.was, self.end, self.reached = x.copy(), x.copy(), x.copy(), x.copy()
        self.handle = client.scene_add(scene, mesh)
        self.triangles, self.edges = triangles, client.mesh_edges(mesh)
        self.mass = mass  # of each vertex; None: a ball, which has 1
        client.object_set(scene, self.handle, radius=THICK)

    def give(self, vertices, weights):
        """How far a push of 1 brings a sum of vertices."""
        return 1 if self.mass is None else (weights**2 / self.mass[vertices]).sum()

    def push(self, vertices, weights, way):
        """The same push, for its ways."""
        if self.mass is None:
            self.end += weights.sum() * way
        else:
            self.end[vertices] += (weights / self.mass[vertices])[:, None] * way


def sides_of(contact, bodies):
    """Body, vertices and weights of side a, and of side b. The sum of both is how far the
    point of a is from that of b."""
    a, b = bodies[contact["object_a"]], bodies[contact["object_b"]]
    p, q = contact["param"].astype(float)
    if contact["kind"] == pccd.Kind.VF:
        return ((a, np.array([contact["feature_a"]]), np.array([1])),
                (b, b.triangles[contact["feature_b"]], np.array([p + q - 1, -p, -q])))
    return ((a, a.edges[contact["feature_a"]], np.array([1 - p, p])),
            (b, b.edges[contact["feature_b"]], np.array([q - 1, -q])))


def respond(contacts, bodies):
    """An impulse at the point of each contact, along its normal: both sides part."""
    for contact in contacts:
        sides, normal = sides_of(contact, bodies), contact["normal"].astype(float)
        gap = sum(w @ body.end[v] @ normal for body, v, w in sides)
        speed = gap - sum(w @ body.x[v] @ normal for body, v, w in sides)
        give = sum(body.give(v, w) for body, v, w in sides)
        if gap < APART and give > 0:
            push = max(APART - gap, -(1 + BOUNCE) * speed) / give
            for body, v, w in sides:
                body.push(v, w, push * normal)


def main():
    frames = int(sys.argv[1]) if len(sys.argv) > 1 else 150
    flat, triangles = sheet()
    round_x, round_triangles = ball()
    at = np.arange(SIDE * SIDE).reshape(SIDE, SIDE)
    links = np.concatenate([np.stack([at[:, :-1], at[:, 1:]], -1).reshape(-1, 2),
                            np.stack([at[:-1], at[1:]], -1).reshape(-1, 2)])
    mass = np.full(SIDE * SIDE, LIGHT)
    mass[at[::SIDE - 1, ::SIDE - 1]] = np.inf  # no push moves a corner
    met = 0
    with pccd.connect(private=True) as client:
        scene = client.scene_create()
        x = np.c_[flat - 0.5, np.zeros(len(flat))]
        mesh = client.mesh_create(x, triangles)
        cloth = Body(client, scene, mesh, x, triangles, mass)
        mesh = client.mesh_create(round_x, round_triangles)  # the balls share it
        balls = [Body(client, scene, mesh,
                      round_x + (0.05 * i - 0.1, 0.07 - 0.03 * i, 0.3 * i),
                      round_triangles)
                 for i in (1, 2, 3)]
        bodies = {body.handle: body for body in [cloth, *balls]}
        moves = pccd.Motions()
        for body in bodies.values():
            moves.x0x1(body.handle, body.x, body.end)  # reads the arrays as they are then
        for frame in range(frames):
            for body in bodies.values():
                body.end[:] = 2 * body.x - body.was - (0, 0, FALL)
                body.was[:] = body.x
            cloth.end[:] = relax(cloth.end, links)
            cloth.end[mass == np.inf] = cloth.x[mass == np.inf]
            for _ in range(TRIES):
                with client.step(scene, moves) as answer:
                    if answer.total == 0:
                        break
                    met += answer.total
                    respond(answer.contacts, bodies)
            _, answer = client.step_safe(scene, moves,
                                         [body.reached for body in bodies.values()])
            answer.release()
            for body in bodies.values():
                body.x[:] = body.reached
            if not is_clear(client, scene):
                print(f"frame {frame}: something is too near")
                return 1
    print(f"{frames} frames, {met} contacts, nothing is nearer than {2 * THICK}")
    return 0 if met else 1


if __name__ == "__main__":
    sys.exit(main())
