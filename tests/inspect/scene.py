"""scene.py - a recording to be looked at, and what is known of it.

Room:     tests/inspect. May use: Python's standard library.
Does:     write frames of a sheet that sinks through a pyramid, have pccdctl check them
          and record that, read what check said.
Does not: read pages (page.py).
"""

import csv
import json
import math
import os
import subprocess

SIDE = 12
FRAMES = 6
NAME = "<!--<script>&amp;' one.rec"  # of the recording: must not be read as markup
PYRAMID = [(3, 0, 3), (9, 0, 3), (9, 0, 9), (3, 0, 9), (6, 5, 6)]
PYRAMID_FACES = [(0, 1, 4), (1, 2, 4), (2, 3, 4), (3, 0, 4)]


def positions(frame):
    """Of all vertices: the sheet, then the pyramid, which stands still."""
    sheet = [(x, 5.5 - frame + 0.25 * math.sin(x + frame) * math.cos(y), y)
             for x in range(SIDE + 1) for y in range(SIDE + 1)]
    return sheet + PYRAMID


def faces():
    row = SIDE + 1
    sheet = []
    for x in range(SIDE):
        for y in range(SIDE):
            a, b, c, d = (x * row + y, x * row + y + 1, (x + 1) * row + y,
                          (x + 1) * row + y + 1)
            sheet += [(a, b, c), (c, b, d)]
    first = row * row
    return sheet + [tuple(first + corner for corner in face) for face in PYRAMID_FACES]


def write_frame(path, frame):
    x, triangles = positions(frame), faces()
    with open(path, "w") as to:
        to.write("ply\nformat ascii 1.0\n"
                 f"element vertex {len(x)}\nproperty float x\nproperty float y\n"
                 f"property float z\nelement face {len(triangles)}\n"
                 "property list uchar int vertex_indices\nend_header\n")
        to.writelines("%.9g %.9g %.9g\n" % point for point in x)
        to.writelines("3 %d %d %d\n" % face for face in triangles)


def pccdctl(*arguments, check=True, folder=None):
    done = subprocess.run([os.environ["PCCDCTL"], *arguments], capture_output=True,
                          text=True, cwd=folder, check=False, timeout=120)
    if check and done.returncode != 0:
        raise AssertionError(f"{arguments}: {done.returncode}: {done.stderr}")
    return done


class Scene:
    """The recording in `folder`, with the steps that check told of."""

    def __init__(self, folder):
        frames = [f"frame{i}.ply" for i in range(FRAMES)]
        for i, name in enumerate(frames):
            write_frame(os.path.join(folder, name), i)
        self.folder = folder
        self.path = os.path.join(folder, NAME)
        said = pccdctl("record", "-o", NAME, "--", os.environ["PCCDCTL"], "check",
                       "--json", "--contacts", "contacts.csv", *frames,
                       folder=folder).stdout
        self.steps = json.loads(said)["steps"]
        with open(os.path.join(folder, "contacts.csv"), newline="") as rows:
            self.contacts = list(csv.DictReader(rows))

    def times(self, step):
        """Of the contacts of a step, from 1, in order."""
        return sorted(float(row["toi"]) for row in self.contacts
                      if int(row["step"]) == step)

    def inspect(self, name, *options, check=True):
        """Write a page; what pccdctl said."""
        return pccdctl("inspect", NAME, "-o", name, *options, check=check,
                       folder=self.folder)
