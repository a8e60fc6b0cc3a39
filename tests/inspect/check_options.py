"""check_options.py - what pccdctl inspect writes, without a browser.

Room:     tests/inspect.
Does:     options, exit statuses, size; the data against what check said.
"""

import array
import json
import os
import pathlib
import random
import subprocess
import sys
import tempfile
import unittest

from page import Page
from scene import (FRAMES, NAME, RADIUS, Scene, ThickScene, pccdctl, positions,
                   record_frames)

MIB = 1 << 20
# Asks of a slide that it never takes, before each fall.
TRIES = """
import numpy, pccd
x = numpy.float64([[0, 0, 9], [1, 0, 9], [0, 1, 9]])
with pccd.connect(private=True) as client:
    scene = client.scene_create()
    body = client.scene_add(scene, client.mesh_create(x, [[0, 1, 2]]))
    for way in 4 * [(1, 0, 0), (0, 0, -.1)]:
        with client.step_x0x1(scene, body, x, x + way):
            x = x + way if way[2] else x
"""


class Options(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.made = tempfile.TemporaryDirectory()
        cls.addClassCleanup(cls.made.cleanup)
        cls.scene = Scene(cls.made.name)

    def page(self, *options):
        self.scene.inspect("page.html", *options)
        return Page(os.path.join(self.made.name, "page.html"))

    def worst(self, page, step, end, frame):
        return max(abs(a - b) for given, true in zip(page.positions(step, end),
                                                     positions(frame), strict=True)
                   for a, b in zip(given, true, strict=True))

    # If it failed, the page would show other places than the daemon was told.
    def test_page__holds_the_positions_of_both_ends(self):
        page = self.page()
        for step in range(FRAMES - 1):
            self.assertLess(self.worst(page, step, "x0", step), 1e-5)
            self.assertLess(self.worst(page, step, "x1", step + 1), 1e-5)

    # If it failed, the demo would name a command that does not make what it promises.
    def test_demo__names_a_command_that_makes_a_page(self):
        said = pccdctl("demo", "--steps", "1", folder=self.made.name).stdout
        lead, command = said.splitlines()[-1].split(": ")
        self.assertEqual(lead, "to look at it in a browser")
        subprocess.run(command.replace("--steps 100", "--steps 2"), shell=True,
                       check=True, capture_output=True, cwd=self.made.name, timeout=60)
        page = Page(os.path.join(self.made.name, "demo.html"))
        self.assertGreater(len(page.meta["steps"]), 1)

    # If it failed, the page would count otherwise than everybody else.
    def test_page__has_the_counts_that_check_told(self):
        page = self.page()
        self.assertEqual(len(page.meta["steps"]), FRAMES - 1)
        self.assertGreater(sum(said["contacts"] for said in self.scene.steps), 100)
        for step, said in zip(page.meta["steps"], self.scene.steps, strict=True):
            answer = step["answer"]
            self.assertEqual((answer["total"], answer["vf"], answer["ee"]),
                             (said["contacts"], said["vf"], said["ee"]))
            self.assertEqual(answer["hash"], said["hash"])
            self.assertEqual(answer["counters"]["candidates_vf"],
                             said["counters"]["candidates_vf"])
            self.assertEqual(step["contacts"]["count"], said["contacts"])
            self.assertEqual(step["recorded"], "same")

    # If it failed, nobody would see in the page that a step left out what stands.
    def test_page__counts_what_stood_still(self):
        where = self.made.name
        frames = ["frame3.ply"] * 4
        record_frames("rest.rec", frames, where)
        said = pccdctl("check", "--json", *frames, folder=where).stdout
        pccdctl("inspect", "rest.rec", "-o", "rest.html", folder=where)
        told = json.loads(said)["steps"][2]["counters"]
        step = Page(os.path.join(where, "rest.html")).meta["steps"][2]
        self.assertGreater(told["still_features"], 0)
        self.assertEqual(step["answer"]["counters"]["still_features"],
                         told["still_features"])

    # If it failed, rods, points and their contacts would not be there, or as others.
    def test_page__holds_rods_points_and_thickness(self):
        scene = ThickScene(self.made.name, 1, "--separation", "0.0625")
        page = Page(scene.page)
        step, mesh = page.meta["steps"][0], page.meta["meshes"][0]
        named = (("edges", 8, [3, 4, 9, 10]), ("points", 4, [5, 6, 7, 8]))
        for of, size, words in named:
            read = page.section(mesh[of]["at"], size * mesh[of]["count"])
            self.assertEqual(list(array.array("I", read)), words)
        self.assertEqual(step["objects"][0]["radius"], RADIUS)
        self.assertEqual(step["separation"], 0.0625)
        self.assertEqual(step["answer"]["safe_step"], scene.said["safe_step"])
        self.assertLess(scene.said["safe_step"], 1)
        kinds = [flags >> 6 for flags in page.flags(0)]
        for kind, name in enumerate(("vf", "ee", "ve", "vv")):
            self.assertEqual(kinds.count(kind), scene.said[name])
            self.assertGreater(scene.said[name], 0)

    # If it failed, what begins within its distance would look as if it came from outside.
    def test_page__tells_what_begins_within_its_distance(self):
        scene = ThickScene(self.made.name, 0.4, "--approach", "0.5")
        page = Page(scene.page)
        step = page.meta["steps"][0]
        flags = page.flags(0)
        self.assertEqual(step["answer"]["inside"], scene.said["inside"])
        self.assertEqual(sum(flag & 4 for flag in flags), 4 * scene.said["inside"])
        self.assertGreater(scene.said["inside"], 0)

    # If it failed, what stands still would be stored at each step.
    def test_page__stores_an_end_once(self):
        steps = self.page().meta["steps"]
        for before, after in zip(steps, steps[1:], strict=False):
            self.assertEqual(before["objects"][0]["x1"], after["objects"][0]["x0"])

    # If it failed, half of the room would show something else.
    def test_round__keeps_positions_to_a_65535th(self):
        page = self.page("--round")
        self.assertTrue(page.meta["is_rounded"])
        for step in range(FRAMES - 1):
            self.assertLess(self.worst(page, step, "x1", step + 1), 12 / 65535)

    # If it failed, what is very small or large would be shown black: its shader squares.
    def test_unit__is_as_large_as_what_is_very_small_or_large(self):
        self.assertEqual(self.page().meta["unit"], 1)
        corners = [(0, 0, 0), (3, 0, 0), (0, 2, 0)]
        for size in (2.0 ** 57, 2.0 ** -57):
            path = os.path.join(self.made.name, "size.obj")
            with open(path, "w") as to:
                to.writelines(f"v {size * x!r} {size * y!r} {size * z!r}\n"
                              for x, y, z in corners)
                to.write("f 1 2 3\n")
            pccdctl("record", "-o", "size.rec", "--", os.environ["PCCDCTL"],
                    "check", "--private", "size.obj", "size.obj", folder=self.made.name)
            for options in ((), ("--round",)):
                pccdctl("inspect", "size.rec", "-o", "size.html", *options,
                        folder=self.made.name)
                page = Page(os.path.join(self.made.name, "size.html"))
                self.assertEqual(page.meta["unit"], 4 * size)
                for given, true in zip(page.positions(0, "x0"), corners, strict=True):
                    for a, b in zip(given, true, strict=True):
                        self.assertLess(abs(a - size * b), 1e-4 * size)

    # If it failed, a long recording could not be thinned out.
    def test_every__shows_one_in_so_many(self):
        page = self.page("--every", "2", "--steps", "1..4")
        self.assertEqual([step["number"] for step in page.meta["steps"]], [1, 3])
        self.assertLess(self.worst(page, 1, "x0", 2), 1e-5)

    # If it failed, a page could become larger than a browser opens, or show the begin of
    # a recording and not its end, without a word.
    def test_size__is_kept_by_steps_that_are_left_out_evenly(self):
        names = [f"large{i}.ply" for i in range(15)]
        points, draw = 8000, random.Random(1).random  # cannot be compressed
        for name in names:
            with open(os.path.join(self.made.name, name), "w") as to:
                to.write(f"ply\nformat ascii 1.0\nelement vertex {points}\n"
                         "property float x\nproperty float y\nproperty float z\n"
                         "element face 1\nproperty list uchar int vertex_indices\n"
                         "end_header\n")
                to.writelines(f"{v} {draw():.7f} {draw():.7f}\n" for v in range(points))
                to.write("3 0 1 2\n")
        done = pccdctl("inspect", *names, "-o", "large.html", "--max-size", "2", "--json",
                       "--no-lanes", "--boxes", "0", folder=self.made.name)
        path = os.path.join(self.made.name, "large.html")
        said, shown = json.loads(done.stdout), Page(path).meta["steps"]
        self.assertLessEqual(os.path.getsize(path), 2 * MIB)
        self.assertGreater(said["every"], 1)
        self.assertIn(f"one step in {said['every']}: --max-size", done.stderr)
        self.assertEqual([step["number"] for step in shown],
                         list(range(1, len(names), said["every"])))
        self.assertGreater(len(shown), 2)

    # If it failed, what does not fit at all would end in a page without a step.
    def test_size__of_one_step_may_be_too_much(self):
        points, draw = 40000, random.Random(1).random
        with open(os.path.join(self.made.name, "wide.obj"), "w") as to:
            to.writelines(f"v {v} {draw():.7f} {draw():.7f}\n" for v in range(points))
            to.write("f 1 2 3\n")
        done = pccdctl("inspect", "wide.obj", "wide.obj", "-o", "none.html", "--max-size",
                       "1", folder=self.made.name, check=False)
        self.assertEqual(done.returncode, 4)
        self.assertIn("--max-size", done.stderr)
        self.assertFalse(os.path.exists(os.path.join(self.made.name, "none.html")))

    # If it failed, most scenes would lie on their side, and nobody could turn them.
    def test_up__is_guessed_recorded_or_given(self):
        self.assertEqual(self.page().meta["up"], "y")  # the sheet sinks
        self.assertEqual(self.page("--up", "x").meta["up"], "x")
        for name, height in (("above.obj", 1), ("below.obj", -1)):
            with open(os.path.join(self.made.name, name), "w") as to:
                to.write(f"v 0 0 {height}\nv 3 0 {height}\nv .1 2 {height}\nf 1 2 3\n")
        pccdctl("inspect", "above.obj", "below.obj", "-o", "up.html",
                folder=self.made.name)
        page = Page(os.path.join(self.made.name, "up.html"))
        self.assertEqual(page.meta["up"], "z")
        pccdctl("record", "-o", "up.rec", "--up", "x", "--", os.environ["PCCDCTL"],
                "check", "above.obj", "below.obj", folder=self.made.name)
        pccdctl("inspect", "up.rec", "-o", "up.html", folder=self.made.name)
        page = Page(os.path.join(self.made.name, "up.html"))
        self.assertEqual(page.meta["up"], "x")  # as recorded
        self.assertEqual(self.drawn(), self.drawn("--up", "x"))
        self.assertNotEqual(self.drawn(), self.drawn("--up", "y"))

    # If it failed, a program that asks again and again, and goes a part of the way, would
    # lie on its side: here it asks of a slide that it never takes, before each fall.
    def test_up__is_of_what_was_gone(self):
        build = pathlib.Path(os.environ["top_builddir"]).resolve()
        env = {**os.environ, "PYTHONPATH": str(build / "python"),
               "PCCD_LIBRARY": str(build / ".libs" / "libpccd.so.0")}

        def run(*command):
            return subprocess.run(command, cwd=self.made.name, env=env, check=False,
                                  capture_output=True, text=True)

        python = next((its for its in (sys.executable, "/usr/bin/python3")
                       if run(its, "-c", "import pccd").returncode == 0), None)
        if python is None:
            self.skipTest("no python3 that can import pccd, as without numpy")
        done = run(os.environ["PCCDCTL"], "record", "-o", "tries.rec", "--", python, "-c",
                   TRIES)
        self.assertEqual(done.returncode, 0, done.stderr)
        pccdctl("inspect", "tries.rec", "-o", "tries.html", folder=self.made.name)
        page = Page(os.path.join(self.made.name, "tries.html"))
        self.assertEqual((len(page.meta["steps"]), page.meta["up"]), (8, "z"))

    def drawn(self, *options):
        """A picture of up.rec."""
        pccdctl("render", "up.rec", "-o", "up.png", "--size", "200x150", *options,
                folder=self.made.name)
        return pathlib.Path(self.made.name, "up.png").read_bytes()

    # If it failed, the page would ask for something, or run what it was not built with.
    def test_page__names_no_address_and_has_a_policy(self):
        page = self.page()
        self.assertTrue(all(at.startswith("data:") for at in page.addresses))
        self.assertIn("default-src 'none'", page.policy)
        self.assertNotIn("unsafe", page.policy)
        self.assertEqual(page.meta["recording"]["name"], NAME)

    # If it failed, the hierarchies would be left out, or too large a level be there.
    def test_boxes__are_of_what_the_step_used_and_not_too_many(self):
        wide = (["--method", "wide"], ["vertices", "edges", "faces"], 512)
        paper = (["--method", "paper", "--boxes", "40"], ["triangles"], 40)
        for options, names, most in (wide, paper):
            for step in self.page(*options).meta["steps"]:
                self.assertEqual(list(step["boxes"]), names)
                for levels in step["boxes"].values():
                    self.assertEqual(levels[0]["count"], 1)
                    self.assertGreater(len(levels), 1)
                    self.assertLessEqual(max(level["count"] for level in levels), most)
        self.assertEqual(self.page("--boxes", "0").meta["steps"][0]["boxes"], {})

    # If it failed, steps would come without what threads did, or with it unasked.
    def test_lanes__are_recorded_unless_they_are_not_wanted(self):
        for step in self.page().meta["steps"]:
            self.assertGreaterEqual(step["events"]["threads"], 1)
            self.assertGreater(step["events"]["count"], 0)
        self.assertIsNone(self.page("--no-lanes").meta["steps"][0]["events"])

    # If it failed, a wrong use would end in something else than a sentence.
    def test_options__are_refused_when_they_are_wrong(self):
        for wrong in (["x.rec", "-o", "x.htm"], ["-o", "x.html"],
                      ["x.rec", "-o", "x.html", "--every", "0"],
                      ["x.rec", "-o", "x.html", "--up", "xy"],
                      ["x.rec", "-o", "x.html", "--max-size", "99999"]):
            done = pccdctl("inspect", *wrong, check=False, folder=self.made.name)
            self.assertEqual((done.returncode, bool(done.stderr)), (2, True), wrong)
        for wrong in (["x.rec"], [NAME, "--steps", "99"]):
            done = pccdctl("inspect", *wrong, "-o", "x.html", check=False,
                           folder=self.made.name)
            self.assertEqual((done.returncode, bool(done.stderr)), (4, True), wrong)
            self.assertFalse(os.path.exists(os.path.join(self.made.name, "x.html")))
