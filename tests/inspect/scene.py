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
    # A check that finds contacts ends with 1, and what records it, too.
    if check and done.returncode not in ((0, 1) if "check" in arguments else (0,)):
        raise AssertionError(f"{arguments}: {done.returncode}: {done.stderr}")
    return done


def record_frames(name, frames, folder):
    """Of the steps alone: check would also ask what crosses between them."""
    pccdctl("record", "-o", name, "--", os.environ["PCCDCTL"], "load", *frames,
            folder=folder)


class Scene:
    """The recording in `folder`, with the steps that check told of."""

    def __init__(self, folder):
        frames = [f"frame{i}.ply" for i in range(FRAMES)]
        for i, name in enumerate(frames):
            write_frame(os.path.join(folder, name), i)
        self.folder = folder
        self.path = os.path.join(folder, NAME)
        record_frames(NAME, frames, folder)
        said = pccdctl("check", "--json", "--contacts", "contacts.csv", "--geometry",
                       *frames, folder=folder).stdout
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


# A face, a rod and a point, and above them two points, a point and a rod across,
# which come down.
RADIUS = 0.25
UNDER = ["v 0 0 0", "v 4 0 0", "v 0 4 0", "v 10 0 0", "v 14 0 0", "v 20 0 0"]
ABOVE = ["v 1 1 {0}", "v 11 0 {0}", "v 20 0 {0}", "v 13 -2 {0}", "v 13 2 {0}"]
NAMED = ["f 1 2 3", "l 4 5", "l 10 11", "p 6 7 8 9"]


class ThickScene:
    """A step of rods and points in `folder` that come down from `high` to the height 0.1,
    with what check said of it; `options` are check's."""

    def __init__(self, folder, high, *options):
        for name, height in (("high.obj", high), ("low.obj", 0.1)):
            with open(os.path.join(folder, name), "w") as to:
                lines = UNDER + [line.format(height) for line in ABOVE] + NAMED
                to.writelines(f"{line}\n" for line in lines)
        said = pccdctl("record", "-o", "thick.rec", "--",
                       os.environ["PCCDCTL"], "check", "--json", "--repeat", "0",
                       "--thickness", str(RADIUS), *options, "high.obj", "low.obj",
                       folder=folder).stdout
        self.said = json.loads(said)
        pccdctl("inspect", "thick.rec", "-o", "thick.html", "--up", "y", folder=folder)
        self.page = os.path.join(folder, "thick.html")


BAR = [(x, y, z) for x in (-2, 2) for y in (-.2, .2) for z in (-.3, .3)]
BAR_FACES = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4),
             (1, 5, 7, 3)]
TIP = (0, 1.2, .1)


class TurningScene:
    """A bar in `folder` that turns by half a turn about z, and whose side meets the tip
    of a triangle on its way."""

    def __init__(self, folder):
        tip = [TIP, (-1, 1.2, 1), (-1, 1.2, -1)]
        for name, places, faces in (("bar", BAR, BAR_FACES), ("tip", tip, [(0, 1, 2)])):
            with open(os.path.join(folder, f"{name}.obj"), "w") as to:
                to.writelines("v %g %g %g\n" % place for place in places)
                to.writelines(f"f {' '.join(str(i + 1) for i in face)}\n"
                              for face in faces)
        pccdctl("record", "-o", "turning.rec", "--", os.environ["PCCDCTL"], "check",
                "--motion", "screw", "--axis", "0,0,1", "--angle", "180deg", "bar.obj",
                "tip.obj", folder=folder)
        pccdctl("inspect", "turning.rec", "-o", "turning.html", "--up", "z",
                folder=folder)
        self.page = os.path.join(folder, "turning.html")


POST = "post of the left-hand gate"  # a name that is long


class ObjectsScene:
    """A sheet that comes down through two triangles, by a scene file in `folder` that
    names them; `pairs`: how many contacts check found between each two."""

    def __init__(self, folder):
        sheet = "v -2 -2 {0}\nv 2 -2 {0}\nv 0 2 {0}\n"
        texts = {"sheet0": sheet.format(2), "sheet1": sheet.format(-2),
                 "peg": "v 0 0 0\nv .5 .5 0\nv .2 .5 -1\n",
                 "post": "v .1 -1 0\nv .5 -1 0\nv .2 -1 -1\n"}
        for name, text in texts.items():
            with open(os.path.join(folder, f"{name}.obj"), "w") as to:
                to.write(f"{text}f 1 2 3\n")
        self.files = f"{POST.replace(' ', '-')}-with-its-hinges-and-bolts-{'x' * 20}.json"
        with open(os.path.join(folder, self.files), "w", encoding="utf-8") as to:
            json.dump({"pccd_scene": 1, "objects": [
                {"name": name, "files": f"{files}.obj"}
                for name, files in (("sheet", "sheet%d"), ("peg", "peg"),
                                    (POST, "post"))]}, to)
        pccdctl("check", "--repeat", "0", "--contacts", "objects.csv", self.files,
                folder=folder)
        self.pairs = {}
        with open(os.path.join(folder, "objects.csv"), newline="") as rows:
            for row in csv.DictReader(rows):
                pair = tuple(sorted((row["object_a"], row["object_b"]), reverse=True))
                self.pairs[pair] = self.pairs.get(pair, 0) + 1
        pccdctl("inspect", self.files, "-o", "objects.html", folder=folder)
        self.page = os.path.join(folder, "objects.html")


class FallScene:
    """A sheet that falls through a peg, a post and a hoop in five steps, as a page and as
    one with each other step; `counts`: contacts that check found, by step and pair."""

    def __init__(self, folder):
        for i in range(6):
            z = 4 - i
            _write(folder, f"fall{i}.obj", [(-9, -9, z), (9, -9, z), (0, 9, z)])
        standing = {"peg": (0, 1.4, 2.6), "post": (2, .2, .7), "hoop": (-2, 3.2, 3.7)}
        for name, (x, low, high) in standing.items():
            _write(folder, f"{name}.obj", [(x, 0, low), (x + .5, 0, low), (x, .5, high)])
        # The hoop is at both ends of the fall.
        with open(os.path.join(folder, "hoop.obj"), "a") as to:
            to.write("v -2 0 -.8\nv -1.5 0 -.8\nv -2 .5 -.3\nf 4 5 6\n")
        with open(os.path.join(folder, "fall.json"), "w") as to:
            json.dump({"pccd_scene": 1, "objects": [
                {"name": name, "files": f"{files}.obj"} for name, files in
                (("sheet", "fall%d"), ("peg", "peg"), ("post", "post"),
                 ("hoop", "hoop"))]}, to)
        pccdctl("check", "--repeat", "0", "--contacts", "fall.csv", "fall.json",
                folder=folder)
        self.pairs = {f"0,{i}": ("sheet", name) for i, name in enumerate(standing, 1)}
        self.counts = {}
        with open(os.path.join(folder, "fall.csv"), newline="") as rows:
            for row in csv.DictReader(rows):
                pair = next(key for key, names in self.pairs.items()
                            if set(names) == {row["object_a"], row["object_b"]})
                key = int(row["step"]), pair
                self.counts[key] = self.counts.get(key, 0) + 1
        pccdctl("inspect", "fall.json", folder=folder)
        pccdctl("inspect", "fall.json", "-o", "fall2.html", "--every", "2", folder=folder)


def _write(folder, name, corners):
    with open(os.path.join(folder, name), "w") as to:
        to.writelines("v %g %g %g\n" % corner for corner in corners)
        to.write("f 1 2 3\n")
