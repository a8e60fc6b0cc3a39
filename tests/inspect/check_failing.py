"""check_failing.py - the steps that fail, as pccdctl check shows them.

Room:     tests/inspect.
Does:     check frames of which some steps are free; read the page without a browser and
          in one, and the film by its pixels; compare them with what check says in JSON.
          $PCCD_PICTURES: a folder for the film.
"""

import csv
import json
import os
import random
import shutil
import struct
import tempfile
import unittest
import zlib

from browser import Browser, is_here
from page import Page
from scene import pccdctl, positions, write_frame

# Frames of scene.py: nothing moves; the sheet comes down on the pyramid; it rests there,
# crossed; it goes on.
ORDER = (0, 0, 1, 1, 2)
FAILING = (2, 3, 4)


def film(path):
    """The pictures of a film: of each its width, height and pixels, row after row."""
    with open(path, "rb") as source:
        data = source.read()
    at, packed, size = 8, [], (0, 0)
    while at < len(data):
        count, kind = struct.unpack(">I4s", data[at:at + 8])
        body = data[at + 8:at + 8 + count]
        at += 12 + count
        if kind == b"IHDR":
            size = struct.unpack(">II", body[:8])
        elif kind == b"fcTL":
            packed.append(b"")
        elif kind == b"IDAT":
            packed[-1] += body
        elif kind == b"fdAT":
            packed[-1] += body[4:]
    return [rows_of(zlib.decompress(picture), *size) for picture in packed]


def paeth(left, above, corner):
    first = left + above - corner
    return min((left, above, corner), key=lambda value: abs(first - value))


def rows_of(data, width, height):
    """PNG's filters undone: rows of bytes, three for each pixel."""
    rows, wide = [], 3 * width
    before = bytearray(wide)
    for y in range(height):
        kind, row = data[y * (wide + 1)], bytearray(data[y * (wide + 1) + 1:][:wide])
        for x in range(wide if kind else 0):
            left, above = row[x - 3] if x >= 3 else 0, before[x]
            corner = before[x - 3] if x >= 3 else 0
            row[x] = (row[x] + (0, left, above, (left + above) // 2,
                                paeth(left, above, corner))[kind]) & 255
        rows.append(row)
        before = row
    return rows


def timed(rows):
    """How many pixels are of the colour of a time, dark blue to yellow by red: surfaces
    and background have about as much green as blue, and no more red."""
    return sum(row[x] > row[x + 1] + 60 or row[x + 2] > row[x + 1] + 80
               for row in rows for x in range(0, len(row), 3))


class Failing(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.made = tempfile.TemporaryDirectory()
        cls.addClassCleanup(cls.made.cleanup)
        cls.files = [f"f{place}.ply" for place in range(len(ORDER))]
        for name, frame in zip(cls.files, ORDER, strict=True):
            write_frame(os.path.join(cls.made.name, name), frame)
        cls.done = cls.check("--page", "bad.html", "--film", "bad.apng", "--json",
                             "--contacts", "contacts.csv")
        cls.steps = json.loads(cls.done.stdout)["steps"]

    @classmethod
    def check(cls, *options, files=None):
        return pccdctl("check", *options, *(files or cls.files), folder=cls.made.name)

    def path(self, name):
        return os.path.join(self.made.name, name)

    # If it failed, the steps that fail would be others than those that are shown.
    def test_scene__fails_where_it_was_made_to(self):
        bad = [number for number, step in enumerate(self.steps, 1)
               if step["contacts"] + step["crossings"] > 0]
        self.assertEqual(tuple(bad), FAILING)
        self.assertIn("page       bad.html: 3 of 3 steps that fail\n", self.done.stderr)
        self.assertIn("film       bad.apng: 3 of 3 steps that fail\n", self.done.stderr)

    # If it failed, the page would show what nobody asked for, or other numbers.
    def test_page__has_the_steps_that_fail_as_check_told_them(self):
        page = Page(self.path("bad.html"))
        shown = page.meta["steps"]
        self.assertEqual(tuple(step["number"] for step in shown), FAILING)
        for place, step in enumerate(shown):
            said = self.steps[step["number"] - 1]
            self.assertEqual(step["answer"]["total"], said["contacts"])
            self.assertEqual(step["answer"]["hash"], said["hash"])
            self.assertEqual(step["contacts"]["count"], said["contacts"])
            for end, frame in (("x0", step["number"] - 1), ("x1", step["number"])):
                for given, true in zip(page.positions(place, end),
                                       positions(ORDER[frame]), strict=True):
                    self.assertLess(max(abs(a - b) for a, b in zip(given, true)), 1e-5)

    # If it failed, a film of what fails would not show where. In mode any there are no
    # contacts, and nothing else is of a time's colour but the legend.
    def test_film__marks_the_contacts_of_its_steps(self):
        pictures = film(self.path("bad.apng"))
        if "PCCD_PICTURES" in os.environ:
            shutil.copy(self.path("bad.apng"), os.environ["PCCD_PICTURES"])
        self.check("--mode", "any", "--film", "any.apng")
        bare = timed(film(self.path("any.apng"))[0])
        self.assertEqual(len(pictures), len(FAILING))
        for rows in pictures:
            self.assertGreater(timed(rows), bare + 60)  # of the larger dot some 80

    # If it failed, a bad bake would fill disk and memory, or be cut without a word.
    def test_failing__bounds_what_is_shown_and_says_so(self):
        said = self.check("--page", "few.html", "--failing", "2").stdout
        self.assertIn("few.html: 2 of 3 steps that fail; --failing has more", said)
        shown = Page(self.path("few.html")).meta["steps"]
        self.assertEqual(tuple(step["number"] for step in shown), FAILING[:2])

    # If it failed, a page that is full would show how a bad bake begins, and not how it
    # ends.
    def test_size__leaves_out_steps_evenly(self):
        points, draw = 2500, random.Random(1).random  # cannot be compressed
        names = [f"large{i}.ply" for i in range(12)]
        for place, name in enumerate(names):
            tip = (-1) ** place
            with open(self.path(name), "w") as to:
                to.write(f"ply\nformat ascii 1.0\nelement vertex {points + 6}\n"
                         "property float x\nproperty float y\nproperty float z\n"
                         "element face 2\nproperty list uchar int vertex_indices\n"
                         f"end_header\n0 0 0\n1 0 0\n0 1 0\n.2 .2 {tip}\n"
                         f".3 .2 {3 * tip}\n.2 .3 {3 * tip}\n")
                to.writelines(f"{v} {draw():.7f} {draw():.7f}\n" for v in range(points))
                to.write("3 0 1 2\n3 3 4 5\n")
        said = self.check("--page", "large.html", "--max-size", "1", files=names).stdout
        shown = [step["number"] for step in Page(self.path("large.html")).meta["steps"]]
        every = shown[1] - shown[0]
        self.assertGreater(every, 1)
        self.assertEqual(shown, list(range(1, len(names), every)))
        self.assertLessEqual(os.path.getsize(self.path("large.html")), 1 << 20)
        self.assertIn(f"{len(shown)} of 11 steps that fail; --max-size has room for one "
                      f"in {every}\n", said)

    # If it failed, an old page would be taken for one of this check.
    def test_free__has_no_page_and_says_so(self):
        said = self.check("--page", "none.html", "--film", "none.apng",
                          files=self.files[:2]).stdout
        self.assertIn("page       none: no step fails, none.html is as it was", said)
        self.assertIn("film       none: no step fails", said)
        self.assertFalse(os.path.exists(self.path("none.html")))

    # If it failed, what stands would not be seen, or stand elsewhere.
    def test_scene_file__is_shown_with_what_stands(self):
        peg = [(0, 0, 0), (2, 2, 0), (1, 3, -3)]
        sheet = [(-2, -2), (2, -2), (0, 2)]
        files = {"peg.obj": peg}
        for number, height in enumerate((2, 1, -1, -2)):
            files[f"sheet{number}.obj"] = [(x, y, height) for x, y in sheet]
        for name, points in files.items():
            with open(self.path(name), "w", encoding="utf-8") as to:
                to.writelines("v %g %g %g\n" % point for point in points)
                to.write("f 1 2 3\n")
        with open(self.path("scene.json"), "w", encoding="utf-8") as to:
            json.dump({"pccd_scene": 1, "objects": [
                {"name": "sheet", "files": "sheet%d.obj"},
                {"name": "peg", "files": "peg.obj"}]}, to)
        self.check("--page", "scene.html", "--contacts", "scene.csv", "--geometry",
                   files=["scene.json"])
        page = Page(self.path("scene.html"))
        self.assertEqual([step["number"] for step in page.meta["steps"]], [2, 3])
        self.assertEqual([one["name"] for one in page.meta["steps"][0]["objects"]],
                         ["sheet", "peg"])
        for end in ("x0", "x1"):
            self.assertEqual([tuple(round(c, 6) for c in point)
                              for point in page.positions(0, end, 1)], peg)
        with open(self.path("scene.csv"), newline="") as rows:
            row = next(row for row in csv.DictReader(rows) if row["kind"] == "vf")
        self.assertEqual((row["object_a"], row["object_b"]), ("peg", "sheet"))
        self.assertEqual([float(row["a" + axis]) for axis in "xyz"], [0, 0, 0])
        self.assertEqual([float(row["n" + axis]) for axis in "xyz"], [0, 0, -1])

    # If it failed, wrong usage would be found after hours, or do nothing.
    def test_usage__is_refused_before_anything_else(self):
        for options, text in ((("--page", "x.png"), "does not end with .html"),
                              (("--film", "x.png"), "does not end with .apng"),
                              (("--failing", "2"), "what --page and --film show"),
                              (("--max-size", "2"), "the page that --page writes")):
            done = pccdctl("check", *options, *self.files, check=False,
                           folder=self.made.name)
            self.assertEqual(done.returncode, 2)
            self.assertIn(text, done.stderr)

    @unittest.skipUnless(is_here(), "no chromium, or no chromedriver")
    # If it failed, nobody could look at it.
    def test_page__opens_in_a_browser_with_its_contacts(self):
        browser = Browser(self.made.name)
        self.addCleanup(browser.close)
        browser.open_blank()
        browser.said(), browser.asked()
        browser.open(self.path("bad.html"))
        browser.wait("return document.body.classList.contains('ready')")
        browser.frames()
        with open(self.path("contacts.csv"), newline="") as rows:
            told = list(csv.DictReader(rows))
        for place, number in enumerate(FAILING):
            browser.run("""const input = document.getElementById('step');
                input.value = arguments[0];
                input.dispatchEvent(new Event('input'));""", str(place))
            browser.frames()
            count = browser.run("return document.getElementById('total').textContent")
            self.assertEqual(int("".join(c for c in count if c.isdigit())),
                             sum(int(row["step"]) == number for row in told))
        self.assertEqual(browser.said(), [])
