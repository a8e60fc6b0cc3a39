"""check_page.py - the page of pccdctl inspect in a headless Chromium.

Room:     tests/inspect.
Does:     open it from the file system and use it as people do; compare what it shows with
          what check said of the same frames.
          $PCCD_PICTURES: a folder for pictures of it.
"""

import math
import os
import tempfile
import unittest

from browser import Browser, is_here
from scene import FRAMES, NAME, RADIUS, Scene, ThickScene, pccdctl, positions

SPACE, ENTER, RIGHT, HOME = " ", "\ue007", "\ue014", "\ue011"
READY = "return document.body.classList.contains('ready')"
# How many colours a canvas shows; of the view, after it has been drawn.
COLOURS = """
    const from = document.getElementById(arguments[0]);
    if (from.id === 'view') pccd.view.picture();
    const copy = document.createElement('canvas');
    copy.width = from.width;
    copy.height = from.height;
    const context = copy.getContext('2d');
    context.drawImage(from, 0, 0);
    const {data} = context.getImageData(0, 0, copy.width, copy.height);
    return new Set(new Uint32Array(data.buffer)).size;"""
SET = """
    const input = document.getElementById(arguments[0]);
    input.value = arguments[1];
    input.dispatchEvent(new Event(input.tagName === 'SELECT' ? 'change' : 'input'));"""
TEXT = "return document.getElementById(arguments[0]).textContent"


def number(text):
    return int("".join(digit for digit in text if digit.isdigit()))


@unittest.skipUnless(is_here(), "no chromium, or no chromedriver")
class InBrowser(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.made = tempfile.TemporaryDirectory()
        cls.addClassCleanup(cls.made.cleanup)
        cls.scene = Scene(cls.made.name)
        cls.scene.inspect("page.html")
        cls.page = os.path.join(cls.made.name, "page.html")

    def open(self, browser):
        browser.open_blank()
        browser.said(), browser.asked()
        browser.open(self.page)
        browser.wait(READY)
        browser.frames()


class Opened(InBrowser):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.browser = Browser(cls.made.name)
        cls.addClassCleanup(cls.browser.close)

    def setUp(self):
        self.open(self.browser)

    def tearDown(self):
        self.assertEqual(self.browser.said(), [])

    def text(self, name):
        return self.browser.run(TEXT, name)

    def value(self, name):
        return self.browser.run("return pccd.state.values[arguments[0]]", name)

    def set(self, name, value):
        self.browser.run(SET, name, str(value))
        self.browser.frames()

    def shown(self, step, t):
        """The places of vertices, step from 0, against the true ones."""
        origin = self.browser.run("return pccd.data.meta.origin")
        given = self.browser.run("return pccd.positions(0)")
        before, after = positions(step), positions(step + 1)
        true = [a[k] + t * (b[k] - a[k]) for a, b in zip(before, after, strict=True)
                for k in range(3)]
        return max(abs(x + origin[i % 3] - true[i]) for i, x in enumerate(given))

    # If it failed, a page from a disk would need the network, or tell somebody of itself.
    def test_page__asks_nobody_for_anything(self):
        self.browser.run("document.getElementById('play').click()")
        self.browser.frames(20)
        asked = [at for at in self.browser.asked() if not at.startswith("data:")]
        self.assertEqual(asked, [self.browser.run("return location.href")])
        self.assertTrue(asked[0].startswith("file:///"))

    # If it failed, there would be nothing to see.
    def test_view__shows_surfaces_and_contacts(self):
        self.assertGreater(self.browser.run(COLOURS, "view"), 500)
        drawn = self.browser.run("return pccd.view.picture()")
        self.browser.run("pccd.state.set({kinds: [false, false]})")
        self.browser.frames()
        self.assertNotEqual(self.browser.run("return pccd.view.picture()"), drawn)

    # If it failed, what lies between two steps would not be seen, or would be wrong.
    def test_time__moves_vertices_between_the_ends(self):
        self.set("step", 2)
        pictures = set()
        for t in (0, 0.25, 0.5, 1):
            self.set("time", t)
            self.assertLess(self.shown(2, t), 1e-5)
            pictures.add(self.browser.run("return pccd.view.picture()"))
        self.assertEqual(len(pictures), 4)

    # If it failed, the page would show other contacts than the daemon answered.
    def test_steps__have_the_contacts_that_check_told(self):
        for step, said in enumerate(self.scene.steps):
            self.set("step", step)
            self.assertLess(self.shown(step, 1), 1e-5)
            self.assertEqual(number(self.text("total")), said["contacts"])
            self.assertEqual([number(self.text(f"kind-{kind}")) for kind in ("vf", "ee")],
                             [said["vf"], said["ee"]])
            self.assertEqual(self.text("hash"), said["hash"])
            times = self.browser.run("""
                const {index, picked} = pccd.state.values;
                return picked.map((i) => pccd.data.step(index).contacts.toi[i]);""")
            true = self.scene.times(step + 1)
            self.assertEqual(len(times), len(true))
            self.assertLess(max((abs(a - b) for a, b in zip(times, true, strict=True)),
                                default=0), 1e-6)

    # If it failed, a contact would be drawn where nothing touches.
    def test_contacts__lie_on_both_features_at_their_time(self):
        worst = self.browser.run("""
            const step = pccd.data.step(pccd.state.values.index);
            const {contacts: c, objects: [{x0, x1, mesh}]} = step;
            const at = (v, t) => [0, 1, 2].map((k) =>
              x0[3 * v + k] + t * (x1[3 * v + k] - x0[3 * v + k]));
            let worst = 0;
            for (let i = 0; i < c.count; i++) {
              const t = c.toi[i];
              const mark = [0, 1, 2].map((k) =>
                step.at0[3 * i + k] + t * (step.at1[3 * i + k] - step.at0[3 * i + k]));
              const edge = [0, 1].map((k) => at(mesh.edges[2 * c.featureA[i] + k], t));
              const place = c.kind[i] === 0 ? at(c.featureA[i], t)
                : edge[0].map((x, k) => x + c.u[i] * (edge[1][k] - x));
              worst = Math.max(worst, ...mark.map((x, k) => Math.abs(x - place[k])));
            }
            return worst;""")
        self.assertLess(worst, 1e-3)

    # If it failed, kinds and times could not be told apart.
    def test_filters__leave_out_kinds_and_times(self):
        said = self.scene.steps[self.value("index")]
        self.browser.click("#kind-vf")
        self.assertEqual(number(self.text("picked").split(" of ")[0]), said["ee"])
        self.browser.click("#kind-vf")
        self.browser.run("pccd.state.set({range: [0.25, 0.5]})")
        times = self.scene.times(self.value("index") + 1)
        self.assertEqual(len(self.value("picked")),
                         sum(0.25 <= time <= 0.5 for time in times))
        self.browser.click("#range-clear")
        self.assertEqual(len(self.value("picked")), said["contacts"])

    # If it failed, a contact of the list could not be found in the view.
    def test_contact__is_flown_to_when_it_is_chosen(self):
        before = self.browser.run("return pccd.view.picture()")
        self.browser.click("#contact-rows .row:nth-child(3)")
        self.browser.frames(60)
        chosen = self.value("chosen")
        self.assertEqual(chosen, self.value("picked")[2])
        toi = self.browser.run("""
            const {index, chosen} = pccd.state.values;
            return pccd.data.step(index).contacts.toi[chosen];""")
        self.assertEqual(self.value("t"), toi)
        self.assertIn("meets", self.text("caption"))
        self.assertNotEqual(self.browser.run("return pccd.view.picture()"), before)

    # If it failed, a level of a hierarchy would not be seen, or not be around the scene.
    def test_boxes__of_a_level_appear_around_the_scene(self):
        without = self.browser.run("return pccd.view.picture()")
        levels = self.browser.run("""
            return pccd.data.meta.steps[pccd.state.values.index].boxes.faces
              .map(({count}) => count);""")
        self.assertGreater(len(levels), 1)
        pictures = {without}
        for level, count in enumerate(levels):
            self.set("level", level + 1)
            self.assertEqual(self.value("boxes"), count)
            self.assertIn(f"level {level} ", self.text("level-text"))
            pictures.add(self.browser.run("return pccd.view.picture()"))
        self.assertEqual(len(pictures), len(levels) + 1)
        outside = self.browser.run("""
            const {index} = pccd.state.values;
            const root = pccd.data.boxes(index, 'faces', 0);
            const {x0, x1} = pccd.data.step(index).objects[0];
            const is_in = (x, i, at) =>
              x >= root[at + i % 3] && x <= root[at + 3 + i % 3];
            return [...x0].filter((x, i) => !is_in(x, i, 0)).length
              + [...x1].filter((x, i) => !is_in(x, i, 6)).length;""")
        self.assertEqual(outside, 0)
        self.set("level", 0)
        self.assertEqual(self.browser.run("return pccd.view.picture()"), without)

    # If it failed, who has lost sight of the scene would not find it again.
    def test_fit__shows_everything_again(self):
        before = self.browser.run("return pccd.view.picture()")
        self.browser.click("#contact-rows .row:nth-child(2)")
        self.browser.wait("return pccd.view.picture() !== arguments[0]", before)
        self.browser.run("pccd.state.set({chosen: -1, t: 1})")
        self.browser.click("#fit")
        self.browser.wait("return pccd.view.picture() === arguments[0]", before)

    # If it failed, what the threads did would be in the page and not be seen.
    def test_lanes__are_drawn_for_each_thread(self):
        self.assertGreaterEqual(self.value("lanes"), 1)
        self.assertGreater(self.browser.run(COLOURS, "lanes"), 5)
        self.assertGreater(self.browser.run(COLOURS, "timeline"), 5)

    # If it failed, who has no mouse could not use the page.
    def test_keys__do_what_the_help_says(self):
        self.browser.run("document.activeElement.blur()")
        self.browser.press(HOME)
        self.assertEqual(self.value("index"), 0)
        self.browser.press(RIGHT, RIGHT)
        self.assertEqual(self.value("index"), 2)
        self.browser.press("1")
        self.assertEqual(self.value("kinds"), [False, True, True, True])
        self.browser.press(SPACE)
        self.assertTrue(self.value("playing"))
        self.browser.press(SPACE)
        self.assertFalse(self.value("playing"))
        self.browser.press("?")
        self.assertTrue(self.browser.run("return document.getElementById('help').open"))
        unnamed = self.browser.run("""
            return [...document.querySelectorAll('button, input, select, canvas')]
              .filter((one) => !one.getAttribute('aria-label') && !one.textContent.trim()
                && !one.labels?.length).map((one) => one.outerHTML);""")
        self.assertEqual(unnamed, [])

    # If it failed, playing would show steps without what lies between them.
    def test_play__goes_through_times_and_steps(self):
        self.set("step", 0)
        self.set("speed", 4)
        self.browser.run("""
            window.seen = {steps: new Set(), times: new Set()};
            pccd.state.on(['t', 'index'], ({t, index}) => {
              seen.steps.add(index);
              seen.times.add(t);
            });
            document.getElementById('play').click();""")
        self.browser.wait("return seen.steps.size === arguments[0]", FRAMES - 1)
        self.assertGreater(self.browser.run("return seen.times.size"), 4)

    # If it failed, the name of a file could put markup, or a script, into the page.
    def test_name__stays_text(self):
        self.assertEqual(self.text("name"), NAME)
        self.assertEqual(self.browser.run("return document.title").split(" · ")[0], NAME)
        self.assertEqual(self.browser.run("""
            return [...document.scripts].filter((one) => !one.type).length"""), 1)
        run = "window.hurt = false; const one = document.createElement('script');" \
              "one.textContent = 'window.hurt = true'; document.body.append(one);" \
              "return window.hurt"
        self.assertFalse(self.browser.run(run))
        self.assertTrue(all("Content Security Policy" in line
                            for line in self.browser.said()))

    # If it failed, nobody could be shown what the page looks like.
    def test_picture__can_be_taken(self):
        folder = os.environ.get("PCCD_PICTURES", self.made.name)
        path = os.path.join(folder, "inspect.png")
        self.browser.picture(path)
        self.assertGreater(os.path.getsize(path), 20000)


# What reaches beyond the sides of the page, or lies over its neighbour below.
BEYOND = """
    const wide = document.documentElement.clientWidth;
    return [...document.querySelectorAll("body *")].filter((one) => {
      const {left, right, width, height} = one.getBoundingClientRect();
      return width > 0 && height > 0 && (left < -1 || right > wide + 1)
        && !one.closest("h1, .list, .lane-room");
    }).map((one) => `${one.tagName} ${one.id} ${one.className}`);"""
OVERLAPS = """
    const parts = [...document.querySelector("aside").children];
    const bottom = (part) => Math.max(0,
      ...[...part.querySelectorAll(".bar, .list, table, .facts")]
        .map((child) => child.getBoundingClientRect().bottom));
    return parts.filter((one, i) => i > 0
      && one.getBoundingClientRect().top + 1 < bottom(parts[i - 1]))
      .map((one) => one.className);"""
SMALL = """
    return [...document.querySelectorAll("button, select")].filter((one) => {
      const {width, height} = one.getBoundingClientRect();
      return width > 0 && (width < 32 || height < 36);
    }).map((one) => one.id);"""


class Phone(InBrowser):
    # If it failed, the page would be shrunk on a phone until its sides fit, with buttons
    # that no finger hits, or what is under the view could not be reached.
    def test_page__fits_a_phone(self):
        for wide, high in ((400, 800), (320, 568), (600, 400)):
            with self.subTest(wide=wide), Browser(self.made.name) as browser:
                browser.resize(wide, high)
                self.open(browser)
                self.assertEqual(
                    browser.run("return document.documentElement.scrollWidth"), wide)
                for script in (BEYOND, OVERLAPS, SMALL):
                    self.assertEqual(browser.run(script), [])
                stage = browser.run(
                    "return document.querySelector('.stage').clientHeight")
                self.assertTrue(high / 3 < stage < 0.7 * high, stage)
                # The sliders stay in sight, and the view goes out of it.
                browser.run("document.getElementById('lanes').scrollIntoView()")
                step = browser.run("return document.getElementById('step')"
                                   ".getBoundingClientRect().bottom")
                self.assertTrue(0 < step <= high, step)
                folder = os.environ.get("PCCD_PICTURES")
                if folder:
                    browser.run("scrollTo(0, 0)")
                    browser.picture(os.path.join(folder, f"inspect-{wide}.png"))
                browser.run(SET, "step", "0")
                browser.frames()
                self.assertEqual(browser.run("return pccd.state.values.index"), 0)
                self.assertEqual(browser.said(), [])


LINES = """
    const {lines} = pccd.data.step(0);
    const {origin} = pccd.data.meta;
    return [Array.from(lines.ends, (x, i) => x + origin[i % 3]),
      ...lines.distance, ...lines.kind];"""
FLOOR = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"
NEEDLE = "v .25 .25 {}\nv .25 .25 3\nv .375 .5 3\nf 1 2 3\n"


@unittest.skipUnless(is_here(), "no chromium, or no chromedriver")
class Near(unittest.TestCase):
    """Questions about what is near, of which a program asked nothing else."""

    # If it failed, what a solver asks before each iteration could not be looked at.
    def test_lines__are_between_nearest_points_or_edges_that_cross(self):
        cases = (("nearest", 0.5, [.25, .25, .5, .25, .25, 0], 0.5, 0),
                 ("crossings", -1, [.25, .25, -1, .25, .25, 3], 0, 4))
        for what, height, ends, distance, kind in cases:
            with self.subTest(what=what), tempfile.TemporaryDirectory() as folder, \
                    Browser(folder) as browser:
                for name, text in (("floor", FLOOR), ("needle", NEEDLE.format(height))):
                    with open(os.path.join(folder, f"{name}.obj"), "w") as file:
                        file.write(text)
                pccdctl("record", "-o", "near.rec", "--", os.environ["PCCDCTL"], "near",
                        "--what", what, "--repeat", "0", "needle.obj", "floor.obj",
                        folder=folder)
                pccdctl("inspect", "near.rec", "-o", "near.html", folder=folder)
                browser.open(os.path.join(folder, "near.html"))
                browser.wait(READY)
                browser.frames()
                found = browser.run(LINES)
                lines = browser.run("return pccd.state.values.lines")
                self.assertEqual(lines, 1 if kind == 0 else len(found[0]) // 6)
                self.assertGreaterEqual(lines, 1)
                self.assertEqual(found[0][:6], ends)
                self.assertEqual((found[1], found[-1]), (distance, kind))
                self.assertIn(what, browser.run(TEXT, "caption"))
                self.assertIn("answers as recorded", browser.run(TEXT, "chips"))
                self.assertEqual(browser.run(TEXT, "total-what"), f"near: {what}")
                self.assertGreater(browser.run(COLOURS, "view"), 20)
                if "PCCD_PICTURES" in os.environ:
                    browser.picture(os.path.join(os.environ["PCCD_PICTURES"],
                                                 f"inspect-{what}.png"))
                self.assertEqual(browser.said(), [])


# The places of the contacts' sticks: from the second feature to the first.
STICKS = """
    const step = pccd.data.step(0);
    const {origin} = pccd.data.meta;
    return Array.from({length: step.contacts.count}, (_, i) => [0, 1].flatMap((end) =>
      [0, 1, 2].map((k) => step.at0[3 * i + k] + end * step.reach[3 * i + k]
        + step.contacts.toi[i] * (step.at1[3 * i + k] - step.at0[3 * i + k])
        + origin[k])));"""
# How many pixels of the view are not as in the picture that is kept: [left, right]; and
# keep this one.
CHANGED = """
    const copy = document.createElement('canvas');
    const view = document.getElementById('view');
    pccd.view.picture();
    copy.width = view.width;
    copy.height = view.height;
    const context = copy.getContext('2d');
    context.drawImage(view, 0, 0);
    const {data} = context.getImageData(0, 0, copy.width, copy.height);
    const pixels = new Uint32Array(data.buffer);
    const before = window.kept;
    window.kept = pixels;
    const sides = [0, 0];
    before?.forEach((pixel, i) => {
      sides[i % copy.width < 0.6 * copy.width ? 0 : 1] += pixel !== pixels[i] ? 1 : 0;
    });
    return sides;"""


@unittest.skipUnless(is_here(), "no chromium, or no chromedriver")
class Thick(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.made = tempfile.TemporaryDirectory()
        cls.addClassCleanup(cls.made.cleanup)
        cls.browser = Browser(cls.made.name)
        cls.addClassCleanup(cls.browser.close)

    def open(self, *arguments):
        scene = ThickScene(self.made.name, *arguments)
        self.browser.open_blank()
        self.browser.said()
        self.browser.open(scene.page)
        self.browser.wait(READY)
        self.browser.frames()
        return scene.said

    def set(self, values):
        """Of the page's state; how many pixels of the view have changed."""
        self.browser.run(CHANGED)
        self.browser.run(f"pccd.state.set({values})")
        self.browser.frames()
        return self.browser.run(CHANGED)

    def picture(self, name):
        folder = os.environ.get("PCCD_PICTURES")
        if folder:
            self.browser.picture(os.path.join(folder, f"inspect-{name}.png"))

    def tearDown(self):
        self.assertEqual(self.browser.said(), [])

    # If it failed, rods and points would not be seen, or have another thickness than they
    # meet with; or triangles would have one unasked.
    def test_view__shows_rods_points_and_thickness(self):
        self.open(1, "--separation", "0.25")
        self.set("{kinds: []}")
        hide = "{hidden: new Set([pccd.data.step(0).objects[0].handle])}"
        face, rods = self.set(hide)
        self.assertGreater(face, 1000)
        self.assertGreater(rods, 1000)  # they are to the right of the face
        self.set("{hidden: new Set()}")
        around = self.set("{thick: true}")
        self.assertGreater(min(around), 100)
        self.assertEqual(self.set("{thick: false}"), around)
        # Without the separation rods are as thick as they are.
        self.open(1)
        self.set("{kinds: []}")
        face, rods = self.set("{thick: true}")
        self.assertGreater(face, 100)
        self.assertEqual(rods, 0)
        self.assertGreater(self.set("{opacity: 0.28}")[1], 100)

    # If it failed, contacts of points would not be listed, or be drawn where nothing is.
    def test_contacts__of_all_kinds_are_listed_and_span_their_distance(self):
        said = self.open(1)
        for kind in ("vf", "ee", "ve", "vv"):
            self.assertTrue(self.browser.run(
                f"return document.getElementById('kind-{kind}').checkVisibility()"))
            self.assertEqual(number(self.browser.run(TEXT, f"kind-{kind}")), said[kind])
        sticks = self.browser.run("return pccd.state.values.sticks")
        self.assertEqual(sticks, said["contacts"])
        for *second, z1, x0, y0, z0 in self.browser.run(STICKS):
            apart = math.dist((*second, z1), (x0, y0, z0))
            self.assertLess(abs(apart - 2 * RADIUS), 1e-4)
            self.assertLess(min(z0, z1), 0.01)
        self.browser.press("3")
        self.assertEqual(self.browser.run("return pccd.state.values.picked.length"),
                         said["contacts"] - said["ve"])
        self.browser.press("3")
        self.browser.run("document.querySelector('#contact-rows .row').click()")
        self.browser.frames(60)
        self.assertIn("at the distance 0.5", self.browser.run(TEXT, "caption"))
        self.set("{thick: true}")
        self.picture("thick")

    # If it failed, the buttons of all kinds would make a page wider than a phone.
    def test_page__fits_a_phone_with_all_kinds(self):
        self.browser.resize(400, 800)
        self.open(1)
        for script in (BEYOND, OVERLAPS, SMALL):
            self.assertEqual(self.browser.run(script), [])
        self.set("{thick: true}")
        self.picture("thick-400")
        self.browser.resize(1500, 950)

    # If it failed, nobody would see how far a step is safe, and what begins too near.
    def test_answer__tells_the_safe_step_and_what_begins_inside(self):
        said = self.open(0.4, "--approach", "0.5", "--separation", "0.125")
        facts = self.browser.run("""
            return Object.fromEntries([...document.querySelectorAll('.fact')].map((one) =>
              [one.firstChild.textContent, one.lastChild.textContent]));""")
        self.assertEqual(float(facts["safe step"]), round(said["safe_step"], 6))
        self.assertEqual((facts["separation"], facts["approach"]), ("0.125", "0.5"))
        self.assertEqual(int(facts["inside at 0"]), said["inside"])
        rows = self.browser.run(TEXT, "contact-rows")
        self.assertGreater(said["inside"], 0)
        self.assertEqual(rows.count(" in"), said["inside"])
        # Two that begin 0.4 apart meet at half of that.
        self.assertTrue(any(abs(math.dist(stick[:3], stick[3:]) - 0.2) < 1e-4
                            for stick in self.browser.run(STICKS)))

    # If it failed, a page without thickness would have a button that does nothing.
    def test_thick__is_offered_only_where_something_is(self):
        shown = "return document.getElementById('thick').checkVisibility()"
        self.open(1)
        self.assertTrue(self.browser.run(shown))
        self.open(1, "--thickness", "0")
        self.assertFalse(self.browser.run(shown))
        self.browser.run("document.activeElement.blur()")
        self.browser.press("t")
        self.assertFalse(self.browser.run("return pccd.state.values.thick"))


class Lean(InBrowser):
    # If it failed, a browser without a graphics card would show nothing, and not say why.
    def test_page__says_that_there_is_no_webgl_and_shows_the_rest(self):
        with Browser(self.made.name, dark=False, webgl=False) as browser:
            self.open(browser)
            self.assertIn("no WebGL", browser.run(TEXT, "failure"))
            busiest = max(said["contacts"] for said in self.scene.steps)
            self.assertEqual(number(browser.run(TEXT, "total")), busiest)
            self.assertGreater(browser.run(COLOURS, "timeline"), 5)
            light = browser.run("return getComputedStyle(document.body).backgroundColor")
            self.assertGreater(number(light.split(",")[0]), 200)
