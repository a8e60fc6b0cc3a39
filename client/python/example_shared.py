#!/usr/bin/env python3
"""example_shared.py - two clients move one scene, and a third one looks on.

Room:     client/python. Imports pccd and numpy, as any user would.
Does:     a plate rises while a needle falls through it, over the same time: whoever moves
          the plate holds its frames for the steps of the other. The third client reads
          the contacts of each step. They could be three processes.
"""

import sys

import numpy as np

import pccd

PLATE = np.array([[-1, -1, 0], [1, -1, 0], [0, 1, 0]], np.float32)
NEEDLE = np.array([[0, 0, 1], [0.01, 0, 2], [0, 0.01, 2]], np.float32)
STEPS = 4


def enter(client, x):
    """Take part in the scene, with an object of one's own."""
    scene = client.scene_create(name="example", share=pccd.Share.OPEN)
    return scene, client.scene_add(scene, client.mesh_create(x, [[0, 1, 2]]))


def move(client, scene, body, x, settings):
    """Submit its way to x; the number of the step."""
    with client.frame(scene, x.nbytes) as frame:
        frame.x1(body, len(x))[:] = x
        return frame.commit(settings)


def main():
    found = 0
    with pccd.connect(private=True) as plate, pccd.connect(plate.url) as needle, \
            pccd.connect(plate.url) as reader:
        plate_scene, plate_body = enter(plate, PLATE)
        needle_scene, needle_body = enter(needle, NEEDLE)
        needle.object_set(needle_scene, needle_body, self_collision=False)
        scene = reader.scene_create(name="example", share=pccd.Share.ATTACH)
        for step in range(1, STEPS + 1):
            way = np.float32([0, 0, step / STEPS])
            held = move(plate, plate_scene, plate_body, PLATE + way,
                        pccd.StepSettings(hold=True))
            plate.wait_held(held)
            with needle.wait(move(needle, needle_scene, needle_body, NEEDLE - way,
                                  pccd.StepSettings())) as answer:
                assert plate.wait(held).hash == answer.hash
            news = reader.scene_wait(scene)
            with reader.scene_read(scene, news.number) as page:
                times = np.unique(page.contacts["toi"].round(3))
                print(f"step {news.number}: {page.total} contacts", *times)
                found += page.total
    return 0 if found else 1


if __name__ == "__main__":
    sys.exit(main())
