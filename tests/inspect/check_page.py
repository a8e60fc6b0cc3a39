"""check_page.py - the page of pccdctl inspect in a headless Chromium.

Room:     tests/inspect.
Does:     open it from the file system and use it as people do; compare what it shows with
          what check said of the same frames. All cases have one browser, but the one
          without WebGL.
          $PCCD_PICTURES: a folder for pictures of it. $NODE_MODULES: where axe-core is.
"""

import csv
import json
import math
import os
import pathlib
import shlex
import tempfile
import unittest

from browser import Browser, is_here
from page import Page
from scene import (BAR, FRAMES, NAME, POST, RADIUS, TIP, FallScene, ObjectsScene, Scene,
                   ThickScene, TurningScene, faces, pccdctl, positions, record_frames)

SPACE, ENTER, RIGHT, HOME, DOWN = " ", "\ue007", "\ue014", "\ue011", "\ue015"
PAGE_UP, SHIFT = "\ue00e", "\ue008"
TAB, ESCAPE = "\ue004", "\ue00c"
AXE = pathlib.Path(os.environ.get("NODE_MODULES", ""), "axe-core", "axe.min.js")
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
# The two features of each row of the list.
ROWS = """
    return [...document.querySelectorAll('#contact-rows .row')].map((row) =>
      [...row.querySelectorAll('.features > span')].map((one) => one.title));"""
# The colours of a picture without its rim, and how many pixels have each: the page counts
# faster than Python.
PIXELS = """
    const [png, done] = arguments;
    const image = new Image();
    image.onload = () => {
      const canvas = new OffscreenCanvas(image.width - 4, image.height - 4);
      const context = canvas.getContext('2d');
      context.drawImage(image, -2, -2);
      const {data} = context.getImageData(0, 0, canvas.width, canvas.height);
      const counts = new Map();
      for (let i = 0; i < data.length; i += 4) {
        const colour = data.slice(i, i + 3).join();
        counts.set(colour, (counts.get(colour) ?? 0) + 1);
      }
      done([...counts].map(([colour, many]) => [colour.split(',').map(Number), many]));
    };
    image.src = `data:image/png;base64,${png}`;"""


# How many contacts the bars over the list tell of, how many the buttons of the kinds that
# are listed; and whether the bars are other ones than the last time.
DRAWN = """
    const canvas = document.getElementById('histogram');
    const {left, top, width} = canvas.getBoundingClientRect();
    const number = (text) => Number(text.split(' ')[0].replaceAll('\u202f', ''));
    const tips = Array.from({length: 60}, (_, bin) => {
      canvas.dispatchEvent(new PointerEvent('pointermove',
        {clientX: left + (bin + 0.5) / 60 * width, clientY: top + 5}));
      return [...document.querySelectorAll('#tip div')];
    }).flat();
    canvas.dispatchEvent(new PointerEvent('pointerleave'));
    const before = window.bars;
    window.bars = canvas.toDataURL();
    const buttons = document.querySelectorAll('.kind-button[aria-pressed=true] b');
    return [...[tips, [...buttons]].map((all) =>
      all.reduce((sum, {textContent}) => sum + number(textContent), 0)),
      window.bars !== before];"""


def number(text):
    return int("".join(digit for digit in text if digit.isdigit()))


def luminance(colour):
    parts = [c / 12.92 if c <= 0.04045 else ((c + 0.055) / 1.055) ** 2.4
             for c in (part / 255 for part in colour)]
    return 0.2126 * parts[0] + 0.7152 * parts[1] + 0.0722 * parts[2]


def contrast(a, b):
    """1 .. 21, as WCAG 2.2 defines it."""
    low, high = sorted((luminance(a), luminance(b)))
    return (high + 0.05) / (low + 0.05)


class All:
    """What the cases share: a folder, a recording with its page, a browser."""


def setUpModule():
    if not is_here():
        return
    made = tempfile.TemporaryDirectory()
    unittest.addModuleCleanup(made.cleanup)
    All.folder = made.name
    All.scene = Scene(made.name)
    All.scene.inspect("page.html")
    All.browser = Browser(made.name)
    unittest.addModuleCleanup(All.browser.close)


@unittest.skipUnless(is_here(), "no chromium, or no chromedriver")
class InBrowser(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.browser, cls.scene = All.browser, All.scene
        cls.page = os.path.join(All.folder, "page.html")

    def open(self, page=None, behind="", browser=None):
        browser = browser or self.browser
        browser.open_blank()
        browser.said(), browser.asked()
        browser.open(page or self.page, behind)
        browser.wait(READY)
        browser.frames()

    def text(self, name):
        return self.browser.run(TEXT, name)

    def value(self, name):
        return self.browser.run("return pccd.state.values[arguments[0]]", name)

    def is_seen(self, name):
        return self.browser.run(
            "return document.getElementById(arguments[0]).checkVisibility()", name)

    def set(self, name, value):
        self.browser.run(SET, name, str(value))
        if name == "step":  # its data are unpacked first
            self.browser.wait("return pccd.state.values.index === arguments[0]",
                              int(value))
        self.browser.frames()

    def facts(self, name):
        """Of one of the lists of names and values."""
        return self.browser.run("""
            const all = [...document.getElementById(arguments[0])
              .querySelectorAll("dt, dd, .fact > *")].map((one) => one.textContent);
            return Object.fromEntries(all.filter((_, i) => i % 2 === 0)
              .map((name, i) => [name, all[2 * i + 1]]));""", name)

    def pixels(self, selector):
        """The colours of an element as it is seen: [[red, green, blue], how many]."""
        return self.browser.run_async(PIXELS, self.browser.picture_of(selector))

    def assertDrawn(self, many, is_other=True):
        """By the bars over the list, and by the kinds that are listed."""
        self.assertEqual(self.browser.run(DRAWN), [many, many, is_other])

    def axe(self):
        """That axe has nothing to say, by WCAG 2.2 AA and its own best practice."""
        self.browser.frames(3)
        self.browser.run(AXE.read_text())
        found = self.browser.run_async("""
            const [done] = arguments;
            const tags = ['wcag2a', 'wcag2aa', 'wcag21aa', 'wcag22aa', 'best-practice'];
            axe.run({runOnly: tags}).then(({violations, passes}) => done([passes.length,
              ...violations.map(({id, nodes}) => `${id}: ${nodes[0].html}`)]));""")
        self.assertGreater(found[0], 20)
        self.assertEqual(found[1:], [])

    def picture(self, name):
        folder = os.environ.get("PCCD_PICTURES")
        if folder:
            self.browser.picture(os.path.join(folder, f"{name}.png"))


# Lead a page back to how it was opened, which it keeps; false: it is a new one.
BACK = """
    const [done] = arguments;
    if (!window.opened) {
      window.opened = {...window.pccd?.state.values};
      done(false);
      return;
    }
    document.getElementById('help').close();
    document.activeElement.blur();
    pccd.data.load(opened.index).then(() => {
      pccd.state.set({...opened, chosen: -1});
      pccd.state.set(opened);
      pccd.view.fit(opened.up, true);
      done(true);
    });"""


class Opened(InBrowser):
    """One page, led back before each case; one that needs a new page, or leaves none that
    can be led back, opens it."""

    def setUp(self):
        if self.browser.run_async(BACK):
            self.browser.frames()
            self.browser.said()
        else:
            self.open()
            self.browser.run_async(BACK)

    def tearDown(self):
        self.assertEqual(self.browser.said(), [])

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
        self.open()
        self.browser.run("document.getElementById('play').click()")
        self.browser.frames(20)
        asked = [at for at in self.browser.asked() if not at.startswith("data:")]
        self.assertEqual(asked, [self.browser.run("return location.href.split('#')[0]")])
        self.assertTrue(asked[0].startswith("file:///"))

    # If it failed, there would be nothing to see.
    def test_view__shows_surfaces_and_contacts(self):
        self.assertGreater(self.browser.run(COLOURS, "view"), 500)
        drawn = self.browser.run("return pccd.view.picture()")
        self.browser.run("pccd.state.set({kinds: []})")
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

    # If it failed, one would have to go through all steps to know where to look.
    def test_whole__says_which_steps_are_worth_a_look(self):
        totals = [said["contacts"] for said in self.scene.steps]
        most = totals.index(max(totals))
        first = next(i for i, total in enumerate(totals) if total > 0)
        self.assertTrue(self.text("whole").startswith(
            f"In {sum(total > 0 for total in totals)} of {len(totals)} steps something "
            f"meets, {first + 1} to {len(totals)}; first in step {first + 1}, most in "
            f"step {most + 1} ({max(totals)}"),
            self.text("whole"))
        self.browser.click("#whole button")
        self.browser.wait("return pccd.state.values.index === arguments[0]", first)

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
        self.assertDrawn(said["ee"])
        self.browser.click("#kind-vf")
        self.set("find", "vertex")
        self.assertDrawn(said["vf"])
        self.set("find", "")
        self.browser.run("pccd.state.set({range: [0.25, 0.5]})")
        times = self.scene.times(self.value("index") + 1)
        self.assertEqual(len(self.value("picked")),
                         sum(0.25 <= time <= 0.5 for time in times))
        self.browser.click("#range-clear")
        self.assertEqual(len(self.value("picked")), said["contacts"])
        # What is dragged over is whole bars: that at t = 0 has what is at t = 0.
        self.browser.run("""
            const canvas = document.getElementById('histogram');
            const {left, top, width} = canvas.getBoundingClientRect();
            canvas.setPointerCapture = () => {};
            const to = 0.301 * width;
            [['down', 1], ['move', to], ['up', to]].forEach(([of, x]) =>
              canvas.dispatchEvent(new PointerEvent(`pointer${of}`,
                {clientX: left + x, clientY: top + 5})));""")
        self.assertEqual(self.value("range"), [0, 19 / 60])
        self.browser.click("#range-clear")

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
        self.assertIn("face", self.facts("detail-facts")["second"])
        self.assertNotEqual(self.browser.run("return pccd.view.picture()"), before)

    # If it failed, one would see a small contact, and not where in the scene it is.
    def test_contact__is_seen_with_the_scene_until_one_goes_closer(self):
        fly = """const {index, t} = pccd.state.values;
            const [size, isClose] = arguments;
            pccd.view.flyToContact(pccd.data.step(index), 0, t, size, isClose);"""
        self.browser.run(fly, 1e-5, True)
        self.browser.wait(f"{IN_SIGHT} < 0.1")
        self.browser.run(fly, 1e-5, False)
        self.browser.wait(f"{IN_SIGHT} > 0.5")
        # However large its features are, closer is nearer.
        away = """return Math.hypot(...pccd.state.values.camera.split(",").slice(3)
            .map(Number))"""
        self.browser.frames(30)
        before = self.browser.run(away)
        self.browser.run(fly, 1e3, True)
        self.browser.wait(f"return (() => {{ {away} }})() < 0.7 * arguments[0]", before)

    # If it failed, a level of a hierarchy would not be seen, or not be around the scene.
    def test_boxes__of_a_level_appear_around_the_scene(self):
        self.assertFalse(self.is_seen("hierarchy"))
        self.browser.click("#engine summary")
        self.browser.frames()
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
            const root = pccd.data.step(index).boxesAt('faces', 0);
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
        self.browser.run("pccd.state.set({chosen: -1, t: 1})")
        before = self.browser.run("return pccd.view.picture()")
        self.browser.click("#contact-rows .row:nth-child(2)")
        self.browser.wait("return pccd.view.picture() !== arguments[0]", before)
        self.browser.run("pccd.state.set({chosen: -1, t: 1})")
        self.browser.click("#fit")
        self.browser.wait("return pccd.view.picture() === arguments[0]", before)

    # If it failed, what the threads did would be in the page and not be seen, or be in
    # the way of who does not ask for it.
    def test_lanes__are_drawn_for_each_thread(self):
        self.open()
        self.assertFalse(self.is_seen("lanes"))
        self.browser.click("#engine summary")
        self.browser.frames(3)
        self.assertEqual(self.facts("engine-facts")["times"],
                         "when this page was written")
        self.browser.run("""
            const [step] = pccd.data.meta.steps;
            step.answer.times.step = 3 * step.events.ns;""")
        self.set("step", 0)
        self.assertIn("threads were recorded for ", self.text("lanes-lost"))
        self.assertGreaterEqual(self.value("lanes"), 1)
        self.assertGreater(self.browser.run(COLOURS, "lanes"), 5)
        self.assertGreater(self.browser.run(COLOURS, "timeline"), 5)

    # If it failed, who has no mouse could not use the page.
    def test_keys__do_what_the_help_says(self):
        self.browser.run("document.activeElement.blur()")
        self.browser.press(HOME)
        self.browser.wait("return pccd.state.values.index === 0")
        self.browser.press(RIGHT)
        self.browser.wait("return pccd.state.values.index === 1")
        self.browser.press("1")
        self.assertEqual(self.value("kinds"), [False, True, True, True, True])
        self.browser.press(SPACE)
        self.assertTrue(self.value("playing"))
        self.browser.press(SPACE)
        self.assertFalse(self.value("playing"))
        # How far the camera is from what it looks at: turned around, over, nearer.
        texts = [self.value("camera")]
        for key in (".", PAGE_UP, "+", "-"):
            self.browser.press(key)
            self.browser.wait(f"return pccd.state.values.camera !== '{texts[-1]}'")
            texts.append(self.value("camera"))
        far = [math.hypot(*map(float, text.split(",")[3:])) for text in texts[1:]]
        for now, right in zip(far, (far[0], far[0], 0.8 * far[0], far[0]), strict=True):
            self.assertAlmostEqual(now / right, 1, 4)
        self.browser.press("?")
        self.assertTrue(self.browser.run("return document.getElementById('help').open"))
        said = self.browser.run("return document.getElementById('help').innerText")
        for what in ("fingers", "vertex-face", "step; home", "faces count from 0"):
            self.assertIn(what, said)
        for what in ("hierarchy", "vertex-vertex", "thickness"):  # not on the screen
            self.assertNotIn(what, said)
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
        self.open()
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

    # If it failed, one would see figures and not what they mean.
    def test_sentence__says_what_is_seen_and_goes_through_it(self):
        self.set("step", 1)
        said, times = self.scene.steps[1], self.scene.times(2)
        self.assertEqual(self.text("sentence").replace("\u202f", "").replace("\xa0", " "),
                         f"Step 2 of {FRAMES - 1}: {said['contacts']} contacts, "
                         f"the first at t = {times[0]:.4g}")
        for button, place in (("first", 0), ("next", 1), ("next", 2), ("previous", 1)):
            self.browser.click(f"#go-{button}")
            self.assertEqual(self.value("chosen"), self.value("picked")[place])
            self.assertEqual(self.text("place"),
                             f"row {place + 1} of {said['contacts']}, by time")
        self.assertEqual(self.facts("detail-facts")["time"], f"t = {times[1]:.4g}")
        # The two numbers of a contact say what they count, in each order of the list.
        chosen = self.value("chosen")
        self.assertEqual(self.facts("detail-facts")["number"],
                         f"contact {chosen + 1} of this step, in file order")
        self.set("order", "record")
        self.assertEqual(self.text("place"),
                         f"row {chosen + 1} of {said['contacts']}, in file order")

    # If it failed, a page would open where nothing is to be seen yet, or long after, and
    # not say which moment that is.
    def test_page__opens_at_the_first_contact_of_the_step_with_most(self):
        self.open()
        most = max(self.scene.steps, key=lambda said: said["contacts"])
        self.assertEqual(number(self.text("total")), most["contacts"])
        times = self.browser.run("""
            const {index} = pccd.state.values;
            return [...pccd.data.step(index).contacts.toi];""")
        self.assertEqual((self.value("chosen"), self.value("t")),
                         (times.index(min(times)), min(times)))
        self.assertIn("with the most contacts; ", self.text("caption"))
        self.assertIn(", its first contact", self.text("caption"))
        self.assertEqual(self.text("detail-head"), "First contact of this step")
        self.assertTrue(self.is_seen("pin"))
        self.assertGreater(self.browser.run(IN_SIGHT), 0.9)
        self.set("step", 0)  # there it is not the moment of anything
        self.assertEqual((self.value("chosen"), self.value("t")), (-1, 1))
        self.assertIn("step 1; t = 1, its end", self.text("caption"))
        self.browser.run("pccd.state.set({t: 0.99999999977})")
        self.browser.frames()
        self.assertEqual(self.text("caption"), "step 1; t = 0.9999999998")
        # Both places that tell the time tell the same, also while it plays.
        self.assertEqual(self.browser.run("""
            pccd.state.set({t: 0.25});
            return ['caption', 'time-number'].map((name) =>
              document.getElementById(name).textContent);"""),
                         ["step 1; t = 0.25", "0.25"])
        self.set("find", "nonsense")
        self.assertTrue(self.is_seen("go-first"))  # no button moves to where it was
        self.assertFalse(self.browser.run(
            "return document.getElementById('go-first').matches(':enabled')"))
        self.browser.click("#go-earliest")
        index = next(i for i, said in enumerate(self.scene.steps) if said["contacts"])
        self.browser.wait("return pccd.state.values.chosen >= 0")
        self.assertEqual(self.value("index"), index)
        self.assertLess(abs(self.value("t") - self.scene.times(index + 1)[0]), 1e-6)
        self.assertEqual(self.text("detail-head"), "First contact of all steps")
        self.assertFalse(self.browser.run(
            "return document.getElementById('go-earliest').matches(':enabled')"))
        # Where all steps have as many, none is the one with most.
        self.browser.run("pccd.data.all.forEach(({answer}) => { answer.total = 9; });"
                         "pccd.state.set({t: 0.5});")
        self.browser.frames()
        self.assertNotIn("with the most", self.text("caption"))
        # Of a batch each step is of another scene.
        self.browser.run("pccd.data.meta.steps[2].scene = 1")
        self.set("step", 2)
        self.assertIn("Step 3 of 5, scene 2 of 2: ", self.text("sentence"))

    # If it failed, nobody would know what the list is for, or what the lines are that
    # appear in the view.
    def test_list__says_that_it_can_be_clicked_and_what_is_drawn(self):
        self.assertIn(" contacts: click a row to see it", self.text("picked"))
        self.browser.run("pccd.state.set({chosen: 0})")
        self.browser.frames(3)
        drawn = dict((tuple(colour), many) for colour, many in self.pixels("#view"))
        colours = []
        for name, least in (("first", 5), ("second", 5), ("normal", 45)):  # with a head
            colour = self.browser.run("""
                const at = [...document.querySelectorAll('#detail dt')]
                  .find((one) => one.textContent === arguments[0]).nextSibling;
                return getComputedStyle(at.querySelector('.dot')).backgroundColor;
                """, name)
            colour = tuple(int(part) for part in colour[4:-1].split(","))
            self.assertGreater(drawn.get(colour, 0), least, name)
            colours.append(colour)
        self.assertApart(colours)
        # A kind with how it begins is not cut.
        self.browser.run("pccd.data.step(pccd.state.values.index).contacts.flags.fill(2);"
                         "pccd.state.set({chosen: 1})")
        self.addCleanup(self.open)
        self.browser.frames(3)
        kinds = self.browser.run("""
            return [...document.querySelectorAll('#contact-rows .kind')].map((one) =>
              [one.textContent.slice(2), one.scrollWidth > one.clientWidth]);""")
        self.assertEqual(kinds[:2], [[" at 0", False]] * 2)

    def assertApart(self, colours):
        """In grey, too."""
        self.assertGreater(min(contrast(a, b) for i, a in enumerate(colours)
                               for b in colours[:i]), 1.5)

    # If it failed, nobody could find the contacts of a vertex, a face or an edge.
    def test_find__takes_features_edges_by_their_vertices_and_times(self):
        number = self.value("index") + 1
        rows = [row for row in self.scene.contacts if int(row["step"]) == number]
        vf = [row for row in rows if row["kind"] == "vf"]
        ee = [row for row in rows if row["kind"] == "ee"]
        ends = [[{row[a], row[b]} for row in ee] for a, b in (("i0", "i1"), ("i2", "i3"))]
        a, b = ee[0]["i0"], ee[0]["i1"]
        vertex = vf[0]["i0"]
        names = ("i0", "i1", "i2", "i3")
        all_of = sum(vertex in (row[name] for name in names) for row in rows)
        own = sum(row["i0"] == vertex for row in vf)
        self.assertGreater(all_of, own)
        wanted = {
            f"vertex {vertex}": all_of,
            f"vertex {vertex} meets face": own,
            f"edge {b} {a}": sum({a, b} in pair for pair in zip(*ends, strict=True)),
            f"e {a}-{b} t<0.5": sum({a, b} in pair and float(row["toi"]) < 0.5
                                    for row, *pair in zip(ee, *ends, strict=True)),
            a: sum(a in (row[name] for name in names) for row in rows),
            f"v{vertex}": all_of,
            f"Vertex #{vertex}": all_of,
            "t < 0.5": sum(float(row["toi"]) < 0.5 for row in rows),
            "face": len(vf), "": len(rows), "vf": len(vf), "EE": len(ee), "edge 0-2": 0,
            "vertex 99999": 0, "nonsense": 0, "vertex -1": 0}
        self.assertGreater(len(vf) * len(ee), 0)
        for text, many in wanted.items():
            with self.subTest(text=text):
                self.set("find", text)
                self.assertEqual(len(self.value("picked")), many)
                said = self.text("picked")
                self.assertEqual(f", {own} of the vertex itself, {all_of - own} of its "
                                 "edges and faces: " in said, many == all_of)
                unknown = {"nonsense": "“nonsense”", "vertex -1": "“-1”"}.get(text)
                self.assertEqual(": frame0 has 174 vertices" in said,
                                 text == "vertex 99999", said)
                self.assertEqual(": frame0 has no edge 0-2" in said,
                                 text == "edge 0-2", said)
                self.assertEqual(" in this step" in said, many < len(rows), said)
                self.assertEqual("no object is called" in said, unknown is not None)
                self.assertIn(unknown or "", said)

    # If it failed, a contact could not be found again in the files, or sent to somebody.
    def test_detail__has_place_normal_and_text_to_copy(self):
        number = self.value("index") + 1
        self.browser.run("Object.defineProperty(navigator.clipboard, 'writeText', "
                         "{value: async (text) => { window.copied = text; }})")
        self.browser.run("pccd.state.set({chosen: 0})")
        facts = self.facts("detail-facts")
        row = next(row for row in self.scene.contacts if int(row["step"]) == number)
        self.assertEqual(facts["first"], f"vertex {row['i0']}, the line shows its path")
        self.assertEqual(shlex.split(facts["picture command"]), [
            "pccdctl", "render", NAME, "--steps", str(number), "--at", "contact 1"])
        for name, of, error in (("place", "a", 0.02), ("normal", "n", 1e-4)):
            given = [float(x) for x in facts[name][1:].split(")")[0].split(",")]
            true = [float(row[of + axis]) for axis in "xyz"]
            self.assertLess(math.dist(given, true), error)
        self.assertIn("), points from the second to the first", facts["normal"])
        first = positions(number - 1)
        way = [a - b for a, b in zip(first[int(row["i0"])], first[int(row["i1"])],
                                     strict=True)]
        # From the face to the vertex.
        self.assertGreater(sum(x * y for x, y in zip(given, way, strict=True)), 0)
        self.browser.click("#copy")
        self.browser.wait("return window.copied")
        copied = self.browser.run("return window.copied")
        told = json.loads(copied)
        self.assertEqual(told["file"], NAME)
        self.assertEqual((told["step"], told["record"], told["kind"]), (number, 1, "vf"))
        self.assertEqual((told["toi"], told["a"]["vertex"]),
                         (float(row["toi"]), int(row["i0"])))
        self.assertEqual(faces()[told["b"]["face"]],
                         tuple(int(row[i]) for i in ("i1", "i2", "i3")))
        self.assertLess(max(abs(x - float(row["b" + axis]))
                            for x, axis in zip(told["at"], "xyz", strict=True)), 1e-5)
        self.assertEqual(self.text("copied"), "copied")
        # The list, as check --contacts has it.
        self.set("find", "vf")
        self.browser.click("#copy-list")
        self.browser.wait("return window.copied.startsWith('step,kind')")
        copied = csv.DictReader(self.browser.run("return window.copied").splitlines())
        same = ("step", "kind", "i0", "i1", "i2", "i3", "proved")
        true = sorted((row for row in self.scene.contacts
                       if (int(row["step"]), row["kind"]) == (number, "vf")),
                      key=lambda row: float(row["toi"]))
        for given, row in zip(copied, true, strict=True):
            self.assertEqual([given[name] for name in same], [row[name] for name in same])
            self.assertEqual(float(given["toi"]), float(row["toi"]))
            self.assertLess(max(abs(float(given[x]) - float(row["b" + x]))
                                for x in "xyz"), 1e-5)

    # If it failed, who is sent an address would see something else.
    def test_address__brings_back_what_was_looked_at(self):
        self.set("step", 3)
        self.set("find", "edge")
        self.set("up", "x")
        self.browser.click("#go-next")
        self.browser.click("#xray")
        self.browser.click("#wires")
        self.browser.click("#engine summary")
        self.browser.press("1")
        self.browser.run("pccd.state.set({range: [0, 0.9]});"
                         "pccd.state.set({chosen: pccd.state.values.picked.at(-1)});"
                         "pccd.fly(pccd.state.values.chosen)")
        self.browser.frames(1)
        at_once, camera = self.value("camera"), None
        while camera != self.value("camera"):  # it glides
            camera = self.value("camera")
            self.browser.frames(8)
        self.assertEqual(at_once, camera)  # whoever copies the address does not wait
        names = ("index", "chosen", "find", "up", "opacity", "wires", "engine", "kinds",
                 "range", "camera", "t")
        values = [self.value(name) for name in names]
        self.browser.wait("return location.hash.includes('range=0%2C0.9')")
        behind = self.browser.run("return location.hash")
        self.open(behind=behind)
        again = [self.value(name) for name in names]
        self.assertEqual(again[:-1], values[:-1])
        self.assertLess(abs(again[-1] - values[-1]), 1e-6)
        self.assertTrue(self.browser.run("return document.getElementById('engine').open"))
        self.assertTrue(self.is_seen("detail"))
        self.assertTrue(self.browser.run("""
            const [list, row] = ['#contacts', '.row[aria-selected=true]'].map((name) =>
              document.querySelector(name)?.getBoundingClientRect());
            return row && row.top >= list.top && row.bottom <= list.bottom;"""))
        self.assertGreater(self.browser.run(
            "return document.getElementById('contacts').scrollTop"), 0)
        self.open(behind="#step=x&record=-3&t=7&up=q&order=q&pair=9,9&camera=1,,2,0,0,0")
        self.assertEqual((self.value("chosen"), self.value("pair")), (-1, ""))
        self.assertEqual(self.value("camera"), "")

    # If it failed, a click on a surface would choose what lies behind it, out of sight.
    def test_click__chooses_nothing_that_a_surface_hides(self):
        *found, i = self.browser.run(HIDDEN)
        self.assertEqual(found, [-1, True, True])
        # Nor is what is chosen drawn there as if nothing hid it.
        for t, is_behind in ((0, True), (1, False)):
            self.browser.run("const [chosen, t] = arguments; pccd.state.set({chosen, t})",
                             i, t)
            self.browser.frames(4)
            self.assertEqual(self.browser.run(BEHIND), is_behind)

    # If it failed, text over the view, or small and grey text, could not be read; or
    # early contacts not be seen in the dark.
    def test_contrast__is_enough_in_the_dark_and_in_the_light(self):
        self.browser.run("pccd.state.set({chosen: pccd.state.values.picked[0]})")
        self.addCleanup(self.browser.dress, "dark")
        texts = ("#caption", "#scale-text", "#fit", "#sentence", "#place", "#find",
                 "#go-next", "#detail dt", "#detail dd", "#kind-vf", "#picked",
                 ".row.head .number", "#contact-rows .row .number", ".fact span",
                 "#engine summary", ".chip", "#step-text")
        for theme in ("dark", "light"):
            self.browser.dress(theme)
            self.browser.frames(3)
            self.browser.run("document.getElementById('contacts').scrollTop = 0")
            self.browser.frames(3)  # its rows are made anew
            for text in texts:
                with self.subTest(theme=theme, text=text):
                    pixels = self.pixels(text)
                    plate = max(pixels, key=lambda pixel: pixel[1])[0]
                    text_pixels = [colour for colour, many in pixels if many > 1]
                    self.assertGreaterEqual(
                        max(contrast(plate, colour) for colour in text_pixels), 4.5)
            self.assertApart(self.browser.run("""
                return [...document.querySelectorAll('#detail dd .dot')].map((one) =>
                  getComputedStyle(one).backgroundColor.match(/\\d+/g).map(Number));"""))
            words, *phases = self.browser.run("""
                const style = getComputedStyle(document.documentElement);
                return ['on-phase', 'phase-refit', 'phase-traversal', 'phase-high',
                  'phase-tests', 'phase-rebuild', 'phase-wait', 'phase-merge']
                  .map((name) => style.getPropertyValue(`--${name}`)
                    .match(/[\\da-f]{2}/g).map((part) => parseInt(part, 16)));""")
            self.assertGreaterEqual(min(contrast(words, one) for one in phases), 4.5)
            view = self.browser.run("return getComputedStyle("
                                    "document.querySelector('.stage')).backgroundColor")
            behind = [int(part) for part in view[4:-1].split(",")]
            scale = [colour for colour, _ in self.pixels("#scale")]
            self.assertGreater(len(scale), 60)
            self.assertGreaterEqual(min(contrast(colour, behind) for colour in scale), 3)

    # If it failed, who has no mouse could not reach a part, or see where he is.
    def test_tab__reaches_everything(self):
        self.open()
        self.browser.run("pccd.state.set({chosen: 0}); document.activeElement.blur()")
        reached = []
        while "engine" not in reached and len(reached) < 60:
            self.browser.press(TAB)
            reached.append(self.browser.run("""
                const one = document.activeElement;
                return one.id || one.parentElement.id;"""))
        for name in ("fit", "view", "up", "go-next", "closer", "copy", "kind-vf", "find",
                     "order", "contacts", "previous", "play", "step", "time", "engine"):
            self.assertIn(name, reached)
        self.browser.press(ENTER)
        self.assertTrue(self.browser.run("return document.getElementById('engine').open"))
        self.browser.run("document.activeElement.blur()")
        self.browser.press("/", "e", "d", "g", "e", ENTER)
        self.assertEqual(self.value("find"), "edge")
        self.assertEqual(self.value("chosen"), self.value("picked")[0])
        self.browser.press(DOWN, ENTER)
        self.assertEqual(self.value("chosen"), self.value("picked")[1])
        self.browser.press(ESCAPE)
        self.assertEqual(self.value("chosen"), -1)
        # A button that there is nothing more to do for gives the list what is typed next.
        self.browser.run("document.getElementById('go-earliest').focus()")
        self.browser.press(ENTER)
        self.browser.wait("return document.activeElement.id === 'contacts'")

    @unittest.skipUnless(AXE.is_file(), "no axe-core in $NODE_MODULES")
    # If it failed, a screen reader would have nothing to say of a part of the page.
    def test_page__has_no_findings_of_axe(self):
        self.addCleanup(self.browser.dress, "dark")
        for theme in ("dark", "light"):
            self.browser.dress(theme)
            self.browser.run("pccd.state.set({chosen: 0});"
                             "document.getElementById('engine').open = true;")
            self.axe()

    # If it failed, a large page would say that nothing meets until it has been read.
    def test_page__says_nothing_of_contacts_while_it_loads(self):
        part = os.path.join(All.folder, "part.html")
        with open(self.page, encoding="utf-8") as page, \
                open(part, "w", encoding="utf-8") as to:
            to.write(page.read().split('<script type="application/octet-stream"')[0])
        self.browser.open(part)
        seen = self.browser.run("return document.body.innerText")
        self.assertIn("Loading", seen)
        self.assertFalse(any(digit.isdigit() for digit in seen), seen)

    # If it failed, nobody could be shown what the page looks like.
    def test_picture__can_be_taken(self):
        folder = os.environ.get("PCCD_PICTURES", All.folder)
        path = os.path.join(folder, "inspect.png")
        self.browser.picture(path)
        self.assertGreater(os.path.getsize(path), 20000)


# Of a contact on the pyramid, seen from above: what a click on it chooses while the sheet
# is above it; whether it chooses it when it sees through, and when the sheet is below.
HIDDEN = """
    const step = pccd.data.step(pccd.state.values.index);
    const {contacts, at0, at1} = step;
    const stands = (i) => [0, 1, 2].every((k) => at0[3 * i + k] === at1[3 * i + k]);
    const i = [...contacts.toi.keys()].find((one) => contacts.kind[one] === 0
      && contacts.toi[one] > 0.3 && contacts.toi[one] < 0.7 && stands(one));
    pccd.view.lookFrom("0,0,0,0.1,9,0.1");
    const pick = (t, opacity) => pccd.view.pick(step,
      {...pccd.state.values, picked: [i], t, opacity}, ...pccd.view.placeOf(step, i, t));
    return new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(() =>
      done([pick(0, 1), pick(0, 0.28) === i, pick(1, 1) === i, i]))));"""
# Whether the ring around what is chosen says that a surface hides it.
BEHIND = "return document.getElementById('pin').classList.contains('behind')"
# How far the handle of the step's slider is from the middle of the bar, at both ends.
AMISS = """
    const bars = document.getElementById('timeline').getBoundingClientRect();
    const slider = document.getElementById('step').getBoundingClientRect();
    const steps = pccd.data.all;
    const bar = Math.min(128, bars.width / steps.length);
    return [slider.left + 8 - bars.left - bar / 2,
      slider.right - 8 - bars.left - (steps.length - 0.5) * bar];"""
ROWS_SEEN = """
    const list = document.getElementById('contacts').getBoundingClientRect();
    const end = Math.min(list.bottom, innerHeight);
    return [...document.querySelectorAll('#contact-rows .row')].filter((row) =>
      row.getBoundingClientRect().bottom <= end + 1).length;"""
# The sizes of all texts in pixels.
TEXT_SIZES = """
    return [...document.querySelectorAll('body *')].filter((one) => one.checkVisibility()
      && [...one.childNodes].some(({nodeType}) => nodeType === 3))
      .map((one) => parseFloat(getComputedStyle(one).fontSize));"""
# Colours some pixels above and below the middle of the first contact's dot.
DOT = """
    const {index, t, picked} = pccd.state.values;
    const [x, y] = pccd.view.placeOf(pccd.data.step(index), picked[0], t);
    pccd.view.picture();
    const view = document.getElementById('view');
    const copy = new OffscreenCanvas(view.width, view.height).getContext('2d');
    copy.drawImage(view, 0, 0);
    const ratio = view.width / view.clientWidth;
    return [-2, 2].map((away) =>
      [...copy.getImageData(Math.round(x * ratio), Math.round(y * ratio) + away, 1, 1)
        .data]);"""
# Names, and what stands beside them, that are cut.
CUT = """
    const names = 'h1, .chip, #sentence, #detail dd, #objects .name';
    return [...document.querySelectorAll(names)].filter((one) => {
      const [its, of] = [one, one.parentElement].map((of) => of.getBoundingClientRect());
      return one.scrollWidth > one.clientWidth + 1
        || one.scrollHeight > one.clientHeight + 1
        || its.left < of.left - 1 || its.right > of.right + 1 || its.width === 0;
    }).map((one) => one.textContent);"""
IN_SIGHT = "return pccd.view.partInSight(pccd.data.step(pccd.state.values.index))"


# What each bar of the steps tells, and whether it is seen.
BARS = """
    const canvas = document.getElementById('timeline');
    const {left, top, width} = canvas.getBoundingClientRect();
    const context = canvas.getContext('2d');
    const part = Math.min(128 / width, 1 / pccd.data.all.length);
    const bars = pccd.data.all.map((_, i) => {
      canvas.dispatchEvent(new PointerEvent('pointermove',
        {clientX: left + (i + 0.5) * part * width, clientY: top + 5}));
      const [, , blue, opaque] = context.getImageData(
        Math.floor((i + 0.5) * part * canvas.width), canvas.height - 2, 1, 1).data;
      return [document.querySelector('#tip strong').textContent,
        opaque === 255 && blue > 240];
    });
    canvas.dispatchEvent(new PointerEvent('pointerleave'));
    return bars;"""


class Objects(InBrowser):
    """A sheet that comes down on two triangles, in one step."""

    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.objects = ObjectsScene(All.folder)

    @unittest.skipUnless(AXE.is_file(), "no axe-core in $NODE_MODULES")
    # If it failed, the boxes before objects would be too small, or have no names.
    def test_objects__have_no_findings_of_axe(self):
        self.open(self.objects.page)
        self.browser.run("document.getElementById('objects-fold').open = true")
        self.axe()

    # If it failed, the page would say of pairs that nobody asked about that they do not
    # meet, and its command would draw another contact.
    def test_options_that_leave_out_pairs__are_told(self):
        page = os.path.join(All.folder, "some.html")
        pccdctl("inspect", "--no-self", "--between", f"peg,{POST}", "-o", page,
                self.objects.files, folder=All.folder)
        self.open(page)
        self.assertIn(f"--no-self --between 'peg,{POST}'", self.text("chips"))
        self.assertIn("nothing that was asked about meets", self.text("sentence"))
        pccdctl("check", "--between", "sheet,peg", "--page", page, self.objects.files,
                check=False, folder=All.folder)
        self.open(page)
        self.assertTrue(self.facts("detail-facts")["picture command"].startswith(
            "pccdctl render FILES --between sheet,peg --steps 1 "))

    # If it failed, objects would have numbers where the user gave them names.
    def test_objects__have_names_and_colours_and_can_be_asked_for(self):
        self.open(self.objects.page)
        sentence = self.text("sentence")
        for name in ("peg", POST):
            self.assertIn(f"between sheet and {name}", sentence)
        title = "return document.getElementById('sentence').title"
        self.assertEqual(self.browser.run(title), sentence)  # which may be cut
        self.assertNotIn("recorded", self.text("chips"))  # it was computed
        self.assertTrue(self.facts("detail-facts")["picture command"].startswith(
            f"pccdctl render {self.objects.files} --steps 1 "))
        self.assertIn("1 of 1 step drawn", self.text("chips"))
        # What the box of words says before any stands in it is not cut by the pairs.
        self.assertTrue(self.browser.run("""
            const find = document.getElementById('find');
            const context = document.createElement('canvas').getContext('2d');
            const {fontSize, fontFamily} = getComputedStyle(find);
            context.font = `${fontSize} ${fontFamily}`;
            const {width} = context.measureText(find.placeholder);
            find.style.flexGrow = '0'; // as narrow as pairs can make it
            const room = find.clientWidth - 34; // beside its rims and the cross
            find.style.flexGrow = '';
            return width > 60 && width <= room;"""))
        self.browser.run("document.getElementById('objects-fold').open = true")
        self.browser.frames()
        self.assertTrue(self.browser.run("""
            const {bottom} = document.querySelector('.object').getBoundingClientRect();
            return bottom <= innerHeight;"""))
        self.browser.click(".object input")
        self.assertEqual(self.text("object-count"),
                         "3, 1 hidden; contacts stay in the view and in the list")
        self.browser.click(".object input")
        self.set("find", "vertex 4 of peg")
        self.assertIn("peg has 3 vertices", self.text("picked"))
        self.set("find", "")
        both = self.objects.pairs
        for at, (pair, many) in enumerate(sorted(both.items()), 1):
            self.set("pair", f"0,{at}")
            self.assertEqual(len(self.value("picked")), many)
            self.assertDrawn(many, at == 1)  # both have theirs at the same times
            self.assertIn(" and ".join(pair), self.text("pair"))
        cut = self.browser.run("""
            return [...document.querySelectorAll('#contact-rows .features > span')]
              .map((one) => [one.textContent, one.scrollWidth > one.clientWidth]);""")
        self.assertTrue(any(f" of {POST}" in text for text, _ in cut))
        self.assertFalse(any(is_cut for _, is_cut in cut), cut)
        self.set("pair", "")
        self.set("find", "green")  # the third of colours.js
        self.assertEqual(len(self.value("picked")), both["sheet", POST])
        self.assertTrue(self.facts("detail-facts")["normal"].endswith(
            f", points from sheet to {POST}"), self.facts("detail-facts"))
        self.set("find", "peg vertex")
        self.assertEqual(len(self.value("picked")), both["sheet", "peg"])
        self.browser.click("#go-first")
        self.assertIn(" of peg", self.facts("detail-facts")["first"])
        # As the page writes it; the number belongs to the object that it stands with.
        self.set("find", "")
        written = self.browser.run(ROWS)
        self.set("find", " meets ".join(written[0]))
        self.assertEqual(len(self.value("picked")), written.count(written[0]))
        for feature in set(sum(written, [])):
            self.set("find", feature)
            found = self.browser.run(ROWS)
            self.assertTrue(any(feature in row for row in found), (feature, found))
            if not feature.startswith("vertex"):  # which has edges and faces
                self.assertTrue(all(feature in row for row in found), (feature, found))
        self.assertEqual(self.browser.said(), [])

    # If it failed, nobody could tell in which steps two objects meet, or the bars would
    # be of others.
    def test_pair__is_followed_through_all_steps(self):
        scene = FallScene(All.folder)
        meets = {"0,1": "peg meet in 2 of 5 steps, 2 to 3; first in step 2",
                 "0,2": "post meet in 1 of 5 steps; first in step 4",
                 "0,3": "hoop meet in 2 of 5 steps, 1 and 5; first in step 1"}
        for page, is_drawn, pairs in (("fall.html", [True] * 5, ["0,1", "0,2", "0,3"]),
                                      ("fall2.html", [True, False] * 3, ["0,1"])):
            self.open(os.path.join(All.folder, page))
            for pair in pairs:
                with self.subTest(page=page, pair=pair):
                    self.set("pair", pair)
                    self.assertTrue(self.text("whole").startswith(
                        f"sheet and {meets[pair]}"), self.text("whole"))
                    counts = [scene.counts.get((step, pair), 0) for step in range(1, 6)]
                    name = f"of {' and '.join(scene.pairs[pair])}"
                    absent = ["" if its else ", not drawn" for its in is_drawn]
                    self.assertEqual(self.browser.run(BARS), [
                        [f"step {i + 1}: {many} {name}{absent[i]}", many > 0]
                        for i, many in enumerate(counts)])
            # Each pair is offered, and what is told of all pairs says so.
            self.browser.run("pccd.data.meta.recording.steps = 9")
            self.set("pair", "1,2")
            self.assertIn("peg and post: never in steps 1 to 5", self.text("pair"))
            self.assertIn(", all pairs: ", self.text("sentence"))
            self.assertIn("safe step of all pairs", self.facts("facts"))
            self.set("step", 0)
            self.browser.run("""
                const t = Math.min(...pccd.data.step(0).contacts.toi);
                pccd.state.set({t, pair: '0,3'});""")
            self.assertIn(", its first contact of this pair", self.text("caption"))
            self.browser.run("pccd.state.set({pair: '0,1'})")
            self.assertNotIn("first", self.text("caption"))
            self.set("pair", pair)
            if page == "fall.html":  # the first of the pair, and on from there
                self.browser.run("document.activeElement.blur()")
                self.browser.press(HOME, held=[SHIFT])
                self.browser.wait("return pccd.state.values.chosen >= 0")
                self.assertEqual(self.value("index"), 0)
                for button, step in (("next", 4), ("previous", 0)):
                    for _ in self.value("picked"):
                        self.browser.click(f"#go-{button}")
                    self.browser.wait("const {index, chosen, pair} = pccd.state.values;"
                                      "return index === arguments[0] && chosen >= 0 "
                                      "&& pair === '0,3'", step)

    # If it failed, one would have to search each step between the first and the last.
    def test_steps__that_meet_are_all_named_while_they_fit(self):
        files = [f"fall{i}.obj" for i in [0, 3, 3, 0] * 3 + [0]]
        with open(os.path.join(All.folder, "fro.json"), "w") as to:
            json.dump({"pccd_scene": 1, "objects": [
                {"name": "sheet", "files": files}, {"name": "peg", "files": "peg.obj"}]},
                to)
        pccdctl("inspect", "fro.json", folder=All.folder)
        self.open(os.path.join(All.folder, "fro.html"))
        self.assertIn("something meets, 1, 3, 5, 7, 9 and 11; first", self.text("whole"))

    # If it failed, a page that has no room for the counts of all pairs would say of those
    # that two objects do not meet.
    def test_pair__of_too_many_is_said_to_be_unknown(self):
        with open(os.path.join(All.folder, "points.obj"), "w") as to:
            to.write("v 0 0 0\np 1\n")
        with open(os.path.join(All.folder, "points.json"), "w") as to:
            json.dump({"pccd_scene": 1, "objects": [
                {"name": f"p{i}", "thickness": .1, "files": ["points.obj"] * 7}
                for i in range(60)]}, to)
        pccdctl("inspect", "--max-size", "1", "-o", "points.html",
                "points.json", folder=All.folder)
        self.open(os.path.join(All.folder, "points.html"), "#kinds=00000")  # draws none
        self.set("pair", "0,1")
        self.assertEqual(
            self.text("whole"), "p0 and p1 meet in 4 of 6 steps, 1 to 4; 2 steps: not "
            "known, as the page has no room to count the pairs of 2: --max-size "
            "allows more; first in step 1")
        self.assertEqual([told for told, _ in self.browser.run(BARS)][3:5], [
            "step 4: 1 of p0 and p1", "step 5: not known how many of p0 and p1"])

    # If it failed, what threads did would be drawn for a part of the time that its phases
    # have.
    def test_lanes__reach_to_the_end_of_a_step_that_tells_its_start(self):
        [step] = Page(self.objects.page).meta["steps"]
        times = step["answer"]["times"]
        self.assertTrue(step["tells_start"])
        self.assertGreaterEqual(step["events"]["ns"], times["step"] - times["ingest"])

    # If it failed, a name that is long would be cut, or cut what stands beside it.
    def test_names__are_whole_in_any_width(self):
        self.addCleanup(self.browser.resize_back)
        self.browser.resize(1100, 760)
        self.open(self.objects.page)
        self.browser.run("document.getElementById('objects-fold').open = true")
        self.assertEqual(self.browser.run(CUT), [])
        self.browser.run("document.documentElement.style.fontSize = '32px'")
        self.assertEqual(self.browser.run(CUT), [])

    # If it failed, half of a contact's dot would be within the face that it lies on.
    def test_dot__is_whole_on_a_face_that_is_tilted(self):
        self.open(self.objects.page)
        self.browser.run("pccd.state.set({chosen: -1, wires: false})")
        self.browser.frames(3)
        above, below = self.browser.run(DOT)
        self.assertLess(max(abs(a - b) for a, b in zip(above, below)), 60)

    # If it failed, half of the page would be of no use for two frames.
    def test_one_step__has_no_part_that_does_nothing(self):
        self.open(self.objects.page)
        for name in ("previous", "next", "step", "timeline", "kind-ve", "kind-vv",
                     "kind-ef", "thick", "range-clear"):
            self.assertFalse(self.is_seen(name), name)
        for name in ("play", "time", "find", "pair", "goes", "detail"):
            self.assertTrue(self.is_seen(name), name)

    # If it failed, what falls would lie on its side.
    def test_up__is_what_falls_or_what_was_asked_for(self):
        self.open(self.objects.page)
        self.assertEqual(self.value("up"), "z")
        self.set("up", "x")
        self.browser.frames()
        self.assertEqual(self.value("up"), "x")

    # If it failed, pairs that were asked for would be counted and not be listed.
    def test_pairs__are_listed(self):
        pccdctl("record", "-o", "pairs.rec", "--", os.environ["PCCDCTL"], "check",
                "--mode", "pairs", "--repeat", "0", self.objects.files, folder=All.folder)
        pccdctl("inspect", "pairs.rec", "-o", "pairs.html", folder=All.folder)
        self.open(os.path.join(All.folder, "pairs.html"))
        self.assertIn("pairs of features that may meet", self.text("sentence"))
        self.assertEqual(len(self.value("picked")), number(self.text("total")))
        self.assertGreater(number(self.text("total")), 0)
        self.assertNotIn("t = ", self.text("detail-facts") + self.text("sentence"))
        self.assertNotIn("safe step", self.facts("facts"))
        self.assertIn("step 1; t = 0, its start", self.text("caption"))
        self.browser.click("#go-first")
        self.assertNotIn("time", self.facts("detail-facts"))
        self.assertEqual(self.browser.said(), [])

    # If it failed, a page would say that nothing meets in what is tangled from the start,
    # or contradict itself where less than all was asked for.
    def test_sentence__claims_what_was_asked_and_no_more(self):
        for frame in (0, 1):
            with open(os.path.join(All.folder, f"tangled{frame}.obj"), "w") as to:
                to.write(f"v 0 0 0\nv 1 0 0\nv 0 {1 + frame} 0\nf 1 2 3\n"
                         "v .25 .25 -1\nv .25 .25 3\nv .375 .5 3\nf 4 5 6\n")
        frames = ["tangled0.obj", "tangled1.obj", "tangled0.obj"]
        record_frames("tangled.rec", frames, All.folder)
        pccdctl("record", "-o", "first.rec", "--", os.environ["PCCDCTL"], "check",
                "--mode", "first", "--repeat", "0", self.objects.files, folder=All.folder)
        for files, words, safe in (
                (frames, "0 contacts, but 2 pairs of features already intersect at the "
                 "start", "0"),
                (["tangled.rec"], "0 contacts during the step; what already intersects "
                 "at its start was not asked with it", "1"),
                (["first.rec"], ", the earliest; later ones were not asked for", None)):
            with self.subTest(files=files):
                pccdctl("inspect", *files, "-o", "said.html", folder=All.folder)
                self.open(os.path.join(All.folder, "said.html"))
                self.assertIn(words, self.text("sentence"))
                self.assertNotIn("meets", self.text("sentence"))
                if safe:
                    self.assertEqual("2 steps begin with intersections; step 1 begins "
                                     "with 2 pairs that intersect" in self.text("chips"),
                                     files == frames)
                    self.assertEqual(self.facts("facts")["safe step"], safe)
                    self.browser.resize(320, 568)
                    self.assertEqual(self.browser.run(
                        "return document.documentElement.scrollWidth"), 320)
                    self.browser.resize_back()


# Plates of the view that lie over each other.
PLATES = """
    const plates = ["#fit", "#wires", "#xray", "#up", "#hierarchy", ".legend", "#axes"]
      .map((name) => [name, document.querySelector(name).getBoundingClientRect()])
      .filter(([, box]) => box.width > 0);
    return plates.flatMap(([a, one], i) => plates.slice(i + 1)
      .filter(([, other]) => one.left < other.right && other.left < one.right
        && one.top < other.bottom && other.top < one.bottom)
      .map(([b]) => `${a} ${b}`));"""
# What reaches beyond the sides of the page, or lies over its neighbour below.
BEYOND = """
    const wide = document.documentElement.clientWidth;
    return [...document.querySelectorAll("body *")].filter((one) => {
      const {left, right, width, height} = one.getBoundingClientRect();
      return width > 0 && height > 0 && (left < -1 || right > wide + 1)
        && !one.closest("h1, .list, .lane-room");
    }).map((one) => `${one.tagName} ${one.id} ${one.className}`);"""
OVERLAPS = """
    const parts = [...document.querySelector("aside").children]
      .filter((part) => part.checkVisibility());
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


class LeftOut(InBrowser):
    """Four steps, by a daemon that keeps few records: nothing; the first contacts; few;
    most, of which some were not told."""

    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        few = os.path.join(All.folder, "few.sh")
        with open(few, "w") as to:
            to.write('#!/bin/sh\nexec "$PCCD_DAEMON" --contacts-max 36 "$@"\n')
        os.chmod(few, 0o755)
        frames = [f"frame{i}.ply" for i in (0, 0, 1, 2, 3)]
        pccdctl("record", "-o", "few.rec", "--", os.environ["PCCDCTL"], "load",
                "--private", "--daemon", few, *frames, folder=All.folder)
        said = pccdctl("check", "--json", "--repeat", "0", *frames, folder=All.folder)
        cls.steps = json.loads(said.stdout)["steps"]

    def show(self, *options, behind=""):
        pccdctl("inspect", "few.rec", "-o", "few.html", *options, folder=All.folder)
        self.open(os.path.join(All.folder, "few.html"), behind)

    # If it failed, a page with one step in two would call a step the first with a contact
    # that is not, and the true one could not be found.
    def test_whole__is_of_steps_that_are_left_out_too(self):
        most, first = self.steps[3]["contacts"], self.steps[1]
        self.show("--every", "2")
        self.assertTrue(self.text("whole").startswith(
            "In 3 of 4 steps something meets, 2 to 4; first in step 2, most in step 4 "
            f"({most})"),
            self.text("whole"))
        self.assertNotIn("with the most", self.text("caption"))
        feature = first["first"]
        for go, word in (("#whole button", "edge"), ("#go-earliest", "face")):
            self.browser.click(go)
            self.set("find", word)  # one goes on, and it is not spoken of any more
            self.assertFalse(self.is_seen("absent"))
            self.browser.click(go)
            self.assertEqual(self.value("find"), word)
            self.browser.frames()
            said = self.text("absent")
            self.assertIn("step 2 was left out: the page has one step in 2. Known of "
                          f"it: {first['contacts']} contacts, the first at t = "
                          f"{first['toi_first']:.4g}: ", said)
            for side in ("a", "b"):
                name, its = next(iter(feature[side].items()))
                its = "-".join(map(str, its)) if name == "edge" else its
                self.assertIn(f"{name} {its}", said)
            self.browser.run(SET, "step", "2")  # the slider is of all steps, as the bars
            self.browser.frames()
            self.assertFalse(self.is_seen("absent"))
            self.assertEqual(self.value("index"), 1)
            self.set("step", 0)
            self.browser.run(SET, "step", "1")  # is left out: so to the next that is not
            self.browser.wait("return pccd.state.values.index === 1")
            self.assertEqual(self.browser.run("return step.value"), "2")
            self.set("step", 0)
        self.show("--every", "2", behind="#step=4")
        command = self.browser.run(
            "return document.querySelector('#absent code').innerText")
        pccdctl(*shlex.split(command)[1:], folder=All.folder)
        self.open(os.path.join(All.folder, "step-4.html"))
        self.assertEqual(number(self.text("total")), most)
        self.assertTrue(self.text("sentence").startswith("Step 4 of 4: "))
        self.assertIn("1 of 4 steps drawn, 1 to 3 not in the page", self.text("chips"))
        # A part does not claim to be all.
        self.show("--steps", "3..4")
        self.assertTrue(self.text("sentence").startswith(
            "Step 4 (of 3 to 4; 4 recorded): "), self.text("sentence"))
        self.assertIn("(steps 3 to 4) something meets, 3 to 4; of these first in step 3",
                      self.text("whole"))
        self.assertEqual(self.text("step-last"), "3\N{EN DASH}4")
        self.assertEqual(self.text("go-earliest"), "First of steps 3 to 4")
        self.browser.click("#go-earliest")
        self.browser.wait("return pccd.state.values.index === 0")
        self.assertEqual(self.text("detail-head"), "First contact of steps 3 to 4")
        self.open(behind="#step=77")
        self.assertIn("knows no step 77: its steps are 1 to 5", self.text("absent"))

    # If it failed, an answer that the program did not get would be shown as the one it
    # had.
    def test_chips__tell_what_was_incomplete_when_it_was_recorded(self):
        self.show()
        chips = self.text("chips")
        self.assertIn("1 of 4 answers was incomplete when recorded", chips)
        self.assertIn("3 of 4 answers as recorded", chips)
        self.assertIn("complete, all proved", chips)
        self.assertNotIn("✓ answers as recorded", chips)
        self.set("step", 3)
        self.assertEqual(self.facts("facts")["as recorded"], "incomplete")
        self.set("step", 2)
        self.assertNotIn("as recorded", self.facts("facts"))
        self.assertEqual(self.facts("facts")["answer"], "complete, all proved")


class Phone(InBrowser):
    # If it failed, words of the legend would be under the axes, or buttons under others.
    def test_plates__lie_beside_each_other_in_any_width(self):
        self.addCleanup(self.browser.resize_back)
        self.open()
        self.browser.run("document.getElementById('engine').open = true")
        for wide, high in ((1400, 900), (1100, 760), (950, 700), (400, 800)):
            self.browser.resize(wide, high)
            self.browser.frames(3)
            self.assertEqual(self.browser.run(PLATES), [], wide)

    # If it failed, "click a row" would stand over no row, the slider show another step
    # than the bars, what was clicked move away, or who needs large letters not get them.
    def test_page__fits_a_small_screen_and_large_letters(self):
        self.addCleanup(self.browser.resize_back)
        self.browser.resize(1100, 800)
        self.open()
        self.assertGreaterEqual(self.browser.run(ROWS_SEEN), 4)
        self.assertLess(max(map(abs, self.browser.run(AMISS))), 1)
        where = """const {left, top} = document.getElementById('detail-close')
            .getBoundingClientRect(); return [left, top];"""
        before = self.browser.run(where)
        self.browser.click("#copy")
        self.browser.wait("return document.getElementById('copied').textContent")
        self.assertEqual(self.browser.run(where), before)
        sizes = self.browser.run(TEXT_SIZES)
        self.browser.run("document.documentElement.style.fontSize = '32px'")
        self.browser.frames(3)
        self.assertEqual(self.browser.run(TEXT_SIZES)[:20],
                         [2 * size for size in sizes[:20]])
        self.browser.resize(550, 400)  # 200 %
        self.open()
        self.assertTrue(self.is_seen("chips"))

    # If it failed, the page would be shrunk on a phone until its sides fit, with buttons
    # that no finger hits, or what is under the view could not be reached.
    def test_page__fits_a_phone(self):
        browser = self.browser
        self.addCleanup(browser.resize_back)
        for wide, high in ((400, 800), (320, 568), (600, 400)):
            with self.subTest(wide=wide):
                browser.resize(wide, high)
                self.open()
                self.assertEqual(
                    browser.run("return document.documentElement.scrollWidth"), wide)
                for script in (BEYOND, OVERLAPS, SMALL):
                    self.assertEqual(browser.run(script), [])
                stage = browser.run(
                    "return document.querySelector('.stage').clientHeight")
                self.assertTrue(high / 3 < stage < 0.7 * high, stage)
                # The sliders stay in sight, and the view goes out of it.
                browser.run("document.getElementById('engine').scrollIntoView()")
                step = browser.run("return document.getElementById('step')"
                                   ".getBoundingClientRect().bottom")
                self.assertTrue(0 < step <= high, step)
                folder = os.environ.get("PCCD_PICTURES")
                if folder:
                    browser.run("scrollTo(0, 0)")
                    browser.picture(os.path.join(folder, f"inspect-{wide}.png"))
                self.set("step", 0)
                self.assertEqual(browser.said(), [])

    # If it failed, a tap on a contact would show nothing, or something out of sight.
    def test_tap__shows_the_contact_where_it_was_tapped(self):
        self.addCleanup(self.browser.resize_back)
        self.browser.resize(360, 800)
        self.open()
        self.browser.frames(10)
        x, y = self.browser.run("""
            pccd.state.set({chosen: -1, t: 0.875});
            const {index, picked, t} = pccd.state.values;
            const [x, y] = pccd.view.placeOf(pccd.data.step(index), picked[0], t);
            const {left, top} = document.getElementById('view').getBoundingClientRect();
            return [left + x + 12, top + y + 12];""")
        self.browser.tap(x, y)
        self.browser.wait("return pccd.state.values.chosen >= 0")
        self.browser.frames()
        self.assertIn("place", self.facts("detail-facts"))
        self.assertEqual(self.value("t"), self.browser.run("""
            const {index, chosen} = pccd.state.values;
            return pccd.data.step(index).contacts.toi[chosen];"""))
        box = self.browser.run("""
            const detail = document.getElementById('detail').getBoundingClientRect();
            return [detail.top, detail.bottom];""")
        self.assertTrue(0 <= box[0] < box[1] <= 800, box)
        # The next one is a tap away: nothing lies over its button.
        self.assertTrue(self.browser.run("""
            const next = document.getElementById('go-next');
            const {left, top, width, height} = next.getBoundingClientRect();
            const [row, around] = ['place', 'goes'].map((id) =>
              document.getElementById(id).getBoundingClientRect());
            return document.elementFromPoint(left + width / 2, top + height / 2) === next
              && row.top >= around.top && row.bottom <= around.bottom;"""))
        self.picture("tapped")
        self.browser.run("pccd.state.set({playing: false})")
        self.browser.click("#detail-close")
        self.assertFalse(self.is_seen("detail"))


LINES = """
    const {contacts: lines} = pccd.data.step(0);
    const {origin} = pccd.data.meta;
    return [Array.from(lines.ends, (x, i) => x + origin[i % 3]),
      ...lines.distance, ...lines.kind];"""
FLOOR = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"
NEEDLE = "v .25 .25 {}\nv .25 .25 3\nv .375 .5 3\nf 1 2 3\n"


class Near(InBrowser):
    """Questions about what is near, of which a program asked nothing else."""

    # If it failed, what a solver asks before each iteration could not be looked at.
    def test_lines__are_between_nearest_points_or_edges_that_cross(self):
        cases = (("nearest", 0.5, [.25, .25, .5, .25, .25, 0], 0.5, 0,
                  "1 nearest pair of features between needle and floor; "
                  "the least distance is 0.5", "vertex 0 of needle"),
                 ("crossings", -1, [.25, .25, -1, .25, .25, 3], 0, 4,
                  "2 edges that pass through faces between needle and floor",
                  "edge 0-1 of needle"))
        for what, height, ends, distance, kind, sentence, first in cases:
            with self.subTest(what=what), tempfile.TemporaryDirectory() as folder:
                for name, text in (("floor", FLOOR), ("needle", NEEDLE.format(height))):
                    with open(os.path.join(folder, f"{name}.obj"), "w") as file:
                        file.write(text)
                pccdctl("record", "-o", "near.rec", "--", os.environ["PCCDCTL"], "near",
                        "--what", what, "--repeat", "0", "needle.obj", "floor.obj",
                        folder=folder)
                pccdctl("inspect", "near.rec", "-o", "near.html", folder=folder)
                self.open(os.path.join(folder, "near.html"))
                found = self.browser.run(LINES)
                lines = self.value("lines")
                self.assertEqual(lines, 1 if kind == 0 else len(found[0]) // 6)
                self.assertGreaterEqual(lines, 1)
                self.assertEqual(found[0][:6], ends)
                self.assertEqual((found[1], found[-1]), (distance, kind))
                self.assertIn("answers as recorded", self.text("chips"))
                self.assertIn(sentence, self.text("sentence"))
                # Crossings are told where they were asked for, and only there.
                self.assertEqual("crossings" in self.facts("facts"), what == "crossings")
                # Two questions tell what crosses: edges in faces, and what touches.
                self.assertEqual(self.is_seen("transport"), what == "crossings")
                self.assertEqual(self.facts("detail-facts")["first"], first)
                self.assertTrue(self.is_seen("pin"))
                self.assertGreater(self.browser.run(COLOURS, "view"), 20)
                self.picture(f"inspect-{what}")
                self.set("find", "face 99")
                self.assertEqual(self.value("lines"), 0)
                self.assertEqual(self.browser.said(), [])


    # If it failed, a page would count what it lists nowhere.
    def test_bounds__are_listed_by_vertex(self):
        for name, text in (("floor", FLOOR), ("needle", NEEDLE.format(0.5))):
            with open(os.path.join(All.folder, f"{name}.obj"), "w") as file:
                file.write(text)
        pccdctl("record", "-o", "bounds.rec", "--", os.environ["PCCDCTL"], "near",
                "--what", "vertices", "--distance", ".52", "--repeat", "0", "needle.obj",
                "floor.obj", folder=All.folder)
        pccdctl("inspect", "bounds.rec", "-o", "bounds.html", folder=All.folder)
        self.open(os.path.join(All.folder, "bounds.html"))
        self.assertIn("6 vertices with their bounds; the least distance is 0.5; 4 have "
                      "something within 0.52", self.text("sentence"))
        rows = self.browser.run("""
            return [...document.querySelectorAll('#contact-rows .row')]
              .map((row) => [...row.children].map((part) => part.innerText.trim()));""")
        self.assertEqual(rows[0][1:], ["", "vertex 0 of needle", "0.5"])
        self.assertEqual(sorted(row[2] for row in rows[1:]),
                         [f"vertex {i} of floor" for i in range(3)])
        self.browser.click("#contact-rows .row")
        self.assertEqual(self.facts("detail-facts"), {
            "vertex": "vertex 0 of needle", "place": "(0.25, 0.25, 0.5)", "bound": "0.5",
            "number": "record 1 of the file"})
        self.assertFalse(self.is_seen("kind-vv"))
        self.assertEqual(self.text("head-kind"), "")


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


class Thick(InBrowser):
    def show(self, *arguments):
        scene = ThickScene(All.folder, *arguments)
        self.open(scene.page)
        return scene.said

    def change(self, values):
        """Of the page's state; how many pixels of the view have changed."""
        self.browser.run(CHANGED)
        self.browser.run(f"pccd.state.set({values})")
        self.browser.frames()
        return self.browser.run(CHANGED)

    def tearDown(self):
        self.assertEqual(self.browser.said(), [])

    # If it failed, rods and points would not be seen, or have another thickness than they
    # meet with; or triangles would have one unasked.
    def test_view__shows_rods_points_and_thickness(self):
        self.show(1, "--separation", "0.25")
        self.change("{kinds: []}")
        hide = "{hidden: new Set([pccd.data.step(0).objects[0].handle])}"
        face, rods = self.change(hide)
        self.assertGreater(face, 1000)
        self.assertGreater(rods, 1000)  # they are to the right of the face
        self.change("{hidden: new Set()}")
        around = self.change("{thick: true}")
        self.assertGreater(min(around), 100)
        self.assertEqual(self.change("{thick: false}"), around)
        # Without the separation rods are as thick as they are.
        self.show(1)
        self.change("{kinds: []}")
        face, rods = self.change("{thick: true}")
        self.assertGreater(face, 100)
        self.assertEqual(rods, 0)
        self.assertGreater(self.change("{opacity: 0.28}")[1], 100)

    # If it failed, contacts of points would not be listed, or be drawn where nothing is.
    def test_contacts__of_all_kinds_are_listed_and_span_their_distance(self):
        said = self.show(1)
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
        self.assertEqual(self.facts("detail-facts")["distance"], "0.5")
        self.change("{thick: true}")
        self.picture("inspect-thick")

    # If it failed, the buttons of all kinds would make a page wider than a phone.
    def test_page__fits_a_phone_with_all_kinds(self):
        self.addCleanup(self.browser.resize_back)
        self.browser.resize(400, 800)
        self.show(1)
        for script in (BEYOND, OVERLAPS, SMALL):
            self.assertEqual(self.browser.run(script), [])
        self.change("{thick: true}")
        self.picture("inspect-thick-400")

    # If it failed, nobody would see how far a step is safe, and what begins too near.
    def test_answer__tells_the_safe_step_and_what_begins_inside(self):
        said = self.show(0.4, "--approach", "0.5", "--separation", "0.125")
        facts = self.facts("facts")
        self.assertEqual(facts["safe step"], f"{said['safe_step']:.4g}")
        self.assertIn("before this t no contact begins", self.browser.run(
            "return document.querySelector('#facts .fact').title"))
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
        self.show(1)
        self.assertTrue(self.browser.run(shown))
        self.show(1, "--thickness", "0")
        self.assertFalse(self.browser.run(shown))
        self.browser.run("document.activeElement.blur()")
        self.browser.press("t")
        self.assertFalse(self.browser.run("return pccd.state.values.thick"))


class Turning(InBrowser):
    # If it failed, what turns would be drawn on straight ways: a half turn would go
    # through its axis, and what the body meets would lie beside it.
    def test_view__draws_what_turns_and_its_contacts_on_arcs(self):
        scene = TurningScene(All.folder)
        self.open(scene.page)
        facts = self.browser.run("""
            return [...document.querySelectorAll('#facts .fact')].map((one) =>
              one.textContent + getComputedStyle(one, '::after').content);""")
        self.assertIn("no contact begins", facts[0])
        self.assertIn("on the way that they turn", facts[1])
        # Where some are questions, all are counted by one name.
        self.assertRegex(self.text("sentence"), "^Entry [0-9]+ of [0-9]+, a step: ")
        self.assertRegex(self.text("step-text"), "^Entry [0-9]+ / [0-9]+$")
        self.assertRegex(self.text("whole"), "In 2 of 2 steps .[0-9]+ entries are "
                         "questions. something meets, 1 and ")
        # What was asked and refused is not told as if nothing had been found.
        self.assertRegex(self.text("chips"), "[0-9]+ questions were not answered")
        refused = next(step["index"] for step in self.browser.run(
            "return pccd.data.meta.steps") if step["answer"]["status"] != "OK")
        self.set("step", refused)
        self.assertIn("it was not answered: invalid argument (E_INVAL)",
                      self.text("sentence"))
        self.assertFalse(any(digit.isdigit() for digit in self.text("picked")))
        self.set("step", 0)
        origin = self.browser.run("return pccd.data.meta.origin")
        areas = []
        for t, place in ((0, lambda x, y: (x, y)), (0.5, lambda x, y: (-y, x)),
                         (1, lambda x, y: (-x, -y))):
            self.browser.run("""
                pccd.state.set({kinds: [], t: arguments[0], hidden: new Set()});
                pccd.view.picture();""", t)
            given = self.browser.run("return pccd.positions(0)")
            true = [x for a, b, z in BAR for x in (*place(a, b), z)]
            self.assertLess(max(abs(x + origin[i % 3] - true[i])
                                for i, x in enumerate(given)), 1e-5)
            self.browser.frames()
            self.browser.run(CHANGED)
            self.browser.run("""
                pccd.state.set({hidden: new Set([pccd.data.step(0).objects[0].handle])});
                """)
            self.browser.frames()
            areas.append(sum(self.browser.run(CHANGED)))
        self.assertGreater(3 * areas[1], max(areas))
        self.browser.run("pccd.state.set({kinds: [true, true, true, true, true]})")
        self.browser.frames()
        self.browser.run("document.querySelector('#contact-rows .row').click()")
        self.browser.frames()
        place = self.facts("detail-facts")["place"].strip("()").split(", ")
        self.assertLess(math.dist([float(x) for x in place], TIP), 1e-3)
        self.picture("inspect-turning")
        # From behind the bar it is hidden; going to it, one comes to where it is not.
        target = [x - middle for x, middle in zip(TIP, origin, strict=True)]
        self.browser.run("pccd.state.set({hidden: new Set()});"
                         "pccd.view.lookFrom(arguments[0])",
                         ",".join(str(x) for x in (*target, 9, .1, .1)))
        self.browser.wait(BEHIND)
        self.browser.run("pccd.fly(pccd.state.values.chosen)")
        self.browser.wait(f"return !(() => {{ {BEHIND} }})()")
        self.assertEqual(self.browser.said(), [])


class Lean(InBrowser):
    # If it failed, a browser without a graphics card would show nothing, and not say why.
    def test_page__says_that_there_is_no_webgl_and_shows_the_rest(self):
        with Browser(All.folder, dark=False, webgl=False) as browser:
            self.open(browser=browser)
            self.assertIn("no WebGL", browser.run(TEXT, "failure"))
            busiest = max(said["contacts"] for said in self.scene.steps)
            self.assertEqual(number(browser.run(TEXT, "total")), busiest)
            self.assertGreater(browser.run(COLOURS, "timeline"), 5)
            light = browser.run("return getComputedStyle(document.body).backgroundColor")
            self.assertGreater(number(light.split(",")[0]), 200)
