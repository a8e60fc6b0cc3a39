"""check_logic.py - what the add-on computes, without Blender.

Room:     tests/blender.
Does:     give a Check shapes of its own, and compare with pccdctl and with what is known.
"""

import json
import os
import subprocess
import tempfile
import unittest

import bakes
import numpy as np
from pccd_blender import check, octahedra, report
from pccd_blender.shape import Refusal, Shape

PCCDCTL = os.environ["PCCDCTL"]


def triangulated(quads):
    return np.concatenate([quads[:, :3], quads[:, [0, 2, 3]]]).astype(np.uint32)


def shape(name, x, polygons, **rest):
    polygons = np.asarray(polygons)
    triangles = polygons if polygons.shape[-1] == 3 else triangulated(polygons)
    return Shape(name, np.float64(x), polygons.reshape(-1),
                 np.full(len(polygons), polygons.shape[-1]),
                 triangles.astype(np.uint32), **rest)


def run(frames, **settings):
    """A whole check of lists of shapes, frame 1 on."""
    made = check.Check(check.Settings(1, len(frames), **settings),
                       lambda moment, first: frames[moment - 1])
    while made.tick():
        pass
    return made


def cloth_and_ball(lowest=-9, frames=bakes.FRAMES):
    sheet, quads = bakes.cloth(lowest, frames)
    x, triangles = bakes.ball()
    return [[shape("Ball", x, triangles), shape("Cloth", one, quads)] for one in sheet]


def pccdctl(*arguments):
    done = subprocess.run([PCCDCTL, *arguments], capture_output=True, check=False)
    if done.returncode not in ((0, 1) if arguments[0] == "check" else (0,)):
        raise AssertionError(f"{arguments}: {done.returncode}: {done.stderr}")
    return json.loads(done.stdout)


class Counts(unittest.TestCase):
    # If it failed, the add-on would tell of other contacts than there are.
    def test_steps__are_those_of_pccdctl(self):
        frames, files = cloth_and_ball(), []
        offset = len(frames[0][0].x)
        both = np.concatenate([frames[0][0].triangles, frames[0][1].triangles + offset])
        one = run([[shape("Both", np.concatenate([s.x for s in frame]), both)]
                   for frame in frames])
        with tempfile.TemporaryDirectory() as folder:
            for k, frame in enumerate(frames):
                files.append(f"{folder}/{k}.obj")
                bakes.write_obj(files[-1], np.concatenate([s.x for s in frame]), both)
            told = pccdctl("check", "--json", *files)
            crossings = [pccdctl("near", "--json", "--what", "crossings", file)
                         for file in files]
        two = run(frames)
        self.assertGreater(told["contacts"], 100)
        for mine, theirs in zip(one.steps, told["steps"], strict=True):
            self.assertEqual({key: theirs[key] for key in mine if key not in
                              ("from", "to")},
                             {key: mine[key] for key in mine if key not in
                              ("from", "to")})
        for key in ("contacts", "vf", "ee", "possible"):
            self.assertEqual([s[key] for s in two.steps],
                             [s[key] for s in told["steps"]], key)
        self.assertEqual([m["crossings"] for m in two.frames],
                         [c["crossings"] for c in crossings])
        self.assertGreater(sum(m["crossings"] for m in two.frames), 100)
        whole = report.report(two, "", 1.0)
        for key in ("vertices", "edges", "triangles", "contacts", "vf", "ee", "possible",
                    "complete"):
            self.assertEqual(whole[key], told[key], key)

    # If it failed, the list would leave something out.
    def test_findings__count_what_the_steps_do(self):
        made = run(cloth_and_ball())
        for kind, total in (("crossing", sum(m["crossings"] for m in made.frames)),
                            ("contact", sum(s["contacts"] - s["initial"]
                                            for s in made.steps))):
            self.assertEqual(sum(f.count for f in made.findings if f.kind == kind), total)
        self.assertEqual({f.objects for f in made.findings}, {("Ball", "Cloth")})
        order = [f.frame for f in made.findings]
        self.assertEqual(order, sorted(order))
        first = made.findings[0]
        step = next(s for s in made.steps if s["contacts"])
        self.assertEqual((first.frame, first.to, first.time),
                         (step["from"], step["to"], step["toi_first"]))
        self.assertIn(f"frame {first.frame} -> {first.to}: {first.count} contacts of "
                      "Ball and Cloth, the first at t = ", report.finding_text(first))

    # If it failed, a marker would be somewhere else than the contact.
    def test_places__are_where_the_surfaces_meet(self):
        floor = shape("Floor", [(-9, -9, 0), (9, -9, 0), (0, 9, 0)], [(0, 1, 2)])
        roof = [shape("Roof", [(-1, 0, z), (1, 0, z), (0, 1, z + 1), (0, 0.5, z - 1)],
                      [(0, 1, 2), (0, 3, 1)]) for z in (2, 0.5, -0.5)]
        made = run([[floor, one] for one in roof])
        tip, later = made.findings[0], [f for f in made.findings if f.frame == 2]
        self.assertEqual((tip.kind, tip.frame, tip.count), ("contact", 1, 1))
        np.testing.assert_allclose(tip.places, [(0, 0.5, 0)], atol=1e-6)
        self.assertAlmostEqual(tip.time, 2 / 3, places=6)
        self.assertEqual({f.kind for f in later}, {"crossing", "contact"})
        for one in later:
            np.testing.assert_allclose(one.places[:, 2], 0, atol=1e-6)
            self.assertEqual(len(one.places), one.count)

    # If it failed, what turns would be taken along chords that nobody asked for.
    def test_steps_of_a_frame__are_times_between_frames(self):
        floor = shape("Floor", [(-9, -9, 0), (9, -9, 0), (0, 9, 0)], [(0, 1, 2)])
        asked = []

        def source(moment, first):
            asked.append(moment)
            return [floor, shape("Drop", [(0, 0, 8 - moment), (1, 0, 9), (0, 1, 9)],
                                 [(0, 1, 2)])]

        made = check.Check(check.Settings(7, 9, steps=4), source)
        while made.tick():
            pass
        self.assertEqual(asked, [7, 7.25, 7.5, 7.75, 8, 8.25, 8.5, 8.75, 9])
        self.assertEqual([(f.kind, f.frame, f.to) for f in made.findings][:3],
                         [("contact", 7.75, 8), ("touch", 8, 8),
                          ("crossing", 8.25, 8.25)])

    # If it failed, a scene full of contacts would fill the memory with markers, or the
    # list would tell fewer than there are.
    def test_places__are_cut_and_the_count_is_whole(self):
        before, check.PLACES_MAX = check.PLACES_MAX, 5
        try:
            made = run(cloth_and_ball())
        finally:
            check.PLACES_MAX = before
        contact = max((f for f in made.findings if f.kind == "contact"),
                      key=lambda f: f.count)
        self.assertGreater(contact.count, 5)
        self.assertEqual((len(contact.places), len(contact.times)), (5, 5))
        self.assertEqual(contact.times[0], contact.time)


class Thickness(unittest.TestCase):
    # If it failed, a cloth of 2 cm would be let through at 1 cm.
    def test_thickness__is_kept_at_frames_and_between(self):
        frames = cloth_and_ball(0.53)  # 0.03 above the ball at last
        self.assertEqual(run(frames).findings, [])
        thick = run(frames, radius=0.02, rest_rings=8)
        self.assertEqual({f.kind for f in thick.findings}, {"near", "contact"})
        self.assertEqual(run(frames, radius=0.0149, rest_rings=8).findings, [])
        self.assertEqual(thick.settings.radius, report.report(thick, "", 1)["thickness"])

    # If it failed, a thickness above the length of an edge would find the cloth near
    # itself everywhere, and nothing else would be seen.
    def test_rest_exclusion__leaves_neighbours_thin(self):
        sheet, quads = bakes.cloth(0)
        frames = [[shape("Cloth", one, quads)] for one in sheet[:3]]
        crowded = run(frames, radius=0.1)  # an edge is 0.17
        self.assertTrue(all(step["crowded"] for step in crowded.steps))
        self.assertIn("rest exclusion", report.summary_text(crowded))
        self.assertIn("near", {f.kind for f in crowded.findings})
        self.assertEqual(run(frames, radius=0.1, rest_rings=4).findings, [])
        self.assertEqual(run(frames, radius=0.1, rest_distance=0.21).findings, [])

    # If it failed, a rigid body would be told of its own folds.
    def test_self__can_be_left_out(self):
        sheet, quads = bakes.cloth(0)
        frames = [[shape("Cloth", one, quads)] for one in sheet[:2]]
        self.assertEqual(run(frames, radius=0.1, with_self=False).findings, [])

    # If it failed, a wrong number would be taken for another one.
    def test_settings__are_refused_by_name(self):
        for wrong, word in (({"radius": -1}, "thickness"),
                            ({"radius": float("nan")}, "thickness"),
                            ({"rest_distance": -1}, "rest exclusion"),
                            ({"rest_rings": 9}, "rings"), ({"steps": 0}, "steps"),
                            ({"last": 0}, "frames 1 to 0")):
            with self.assertRaisesRegex(Refusal, word):
                check.Settings(**{"first": 1, "last": 2, **wrong})


class Refusals(unittest.TestCase):
    def setUp(self):
        self.sheet, self.quads = bakes.cloth(0)

    def refused(self, words, *shapes):
        with self.assertRaisesRegex(Refusal, words):
            run([[one] for one in shapes])

    # If it failed, vertices would be taken for others, and contacts be made up.
    def test_topology__is_told_by_name(self):
        first = shape("Cloth", self.sheet[0], self.quads, modifiers=("Cut",))
        fewer = shape("Cloth", self.sheet[1], self.quads[:-1], modifiers=("Cut",))
        self.refused(r'"Cloth" is another mesh at frame 2 \(169 vertices, 143 faces\) '
                     r"than at frame 1 \(169 vertices, 144 faces\).*modifiers are Cut",
                     first, fewer)
        turned = shape("Cloth", self.sheet[1], self.quads[:, ::-1])
        self.refused('"Cloth" is another mesh at frame 2', first, turned)

    # If it failed, nobody would know which of a bake's objects has exploded.
    def test_nowhere__is_told_by_name(self):
        broken = self.sheet[1].copy()
        broken[[7, 9]] = np.nan
        self.refused('"Cloth" at frame 2: vertex 7 is nowhere.*1 more',
                     shape("Cloth", self.sheet[0], self.quads),
                     shape("Cloth", broken, self.quads))
        far = self.sheet[1] + 1e19
        self.refused("frame 2: E_NOTFINITE", shape("Cloth", self.sheet[0], self.quads),
                     shape("Cloth", far, self.quads))

    # If it failed, an object of edges alone would be passed through in silence.
    def test_no_faces__is_told_by_name(self):
        self.refused('"Wire" at frame 1 has no faces after its modifiers',
                     shape("Wire", self.sheet[0], self.quads[:0], modifiers=("Skin",)))
        with self.assertRaisesRegex(Refusal, "no object to check"):
            run([[]])

    # If it failed, whoever is tired of waiting would lose all, or be told that all was
    # looked at.
    def test_cancel__keeps_what_was_found(self):
        frames = cloth_and_ball()
        made = check.Check(check.Settings(1, 9), lambda moment, first: frames[moment - 1])
        while not made.findings:
            self.assertTrue(made.tick())
        done, found = made.done, len(made.findings)
        made.cancel()
        self.assertFalse(made.tick())
        self.assertEqual((made.done, len(made.findings)), (done, found))
        self.assertTrue(made.is_cancelled)
        told = report.report(made, "", 1)
        self.assertTrue(told["cancelled"] and not told["complete"])
        self.assertRegex(report.summary_text(made), rf"^{done} frames of 9 .*cancelled")

    # If it failed, each check would leave a scene in Blender's memory.
    def test_library__is_freed(self):
        frames = cloth_and_ball(frames=3)
        made = run(frames)
        self.assertIsNone(made._client)
        made = check.Check(check.Settings(1, 9), lambda moment, first: frames[moment - 1])
        with self.assertRaises(IndexError):
            while made.tick():
                pass
        self.assertIsNone(made._client)


class Markers(unittest.TestCase):
    # If it failed, markers would look dark from outside, or be somewhere else.
    def test_octahedra__are_closed_around_their_places(self):
        places = np.float64([(0, 0, 0), (5, 6, 7)])
        x, faces = octahedra.octahedra(places, 0.5)
        self.assertEqual((len(x), len(faces)), (12, 16))
        np.testing.assert_allclose(x.reshape(2, 6, 3).mean(1), places)
        a, b, c = (x[faces[:, k]] for k in range(3))
        normal = np.cross(b - a, c - a)
        outwards = (a + b + c) / 3 - np.repeat(places, 8, 0)
        self.assertTrue(((normal * outwards).sum(1) > 0).all())
        np.testing.assert_allclose(np.linalg.norm(x[0] - places[0]), 0.5)

    # If it failed, a late contact would look like an early one.
    def test_colours__go_with_time(self):
        indices = octahedra.colour_indices("contact", np.array([0, 0.5, 1]))
        self.assertEqual(indices.tolist(), [0, 4, 8])
        self.assertEqual(octahedra.colour_indices("crossing", np.zeros(2)).tolist(),
                         [9, 9])
        self.assertAlmostEqual(float(octahedra.linear(0.5)), 0.214041, places=5)


if __name__ == "__main__":
    unittest.main()
