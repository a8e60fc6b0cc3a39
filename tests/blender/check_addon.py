"""check_addon.py - the add-on as it is installed, within one Blender.

Room:     tests/blender. Runs in Blender: blender -b -P check_addon.py -- ZIP FOLDER
Does:     install the zip, make bakes in FOLDER, try what a user does. tap.py tells.
"""

import contextlib
import io
import json
import os
import sys
import unittest

import bpy
import mathutils
import numpy as np

ZIP, FOLDER = sys.argv[sys.argv.index("--") + 1:][:2]
sys.dont_write_bytecode = True  # beside the sources
sys.path[:0] = [os.path.dirname(os.path.abspath(__file__)),
                os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "python")]

import bakes  # noqa: E402
import tap  # noqa: E402


def path(name):
    return os.path.join(FOLDER, name)


def add(name, x, polygons):
    mesh = bpy.data.meshes.new(name)
    mesh.from_pydata(x.tolist(), [], polygons.tolist())
    made = bpy.data.objects.new(name, mesh)
    bpy.context.scene.collection.objects.link(made)
    return made


def bake(name, lowest, change=None):
    """A file with the ball and the cloth, whose positions a point cache has."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    bpy.ops.preferences.addon_enable(module="pccd_blender")
    scene = bpy.context.scene
    scene.frame_start, scene.frame_end = 1, bakes.FRAMES
    frames, quads = bakes.cloth(lowest)
    if change is not None:
        change(frames)
    bakes.write_pc2(path(name + ".pc2"), frames)
    add("Ball", *bakes.ball())
    cloth = add("Cloth", frames[0], quads)
    cache = cloth.modifiers.new("Cache", "MESH_CACHE")
    cache.cache_format, cache.filepath = "PC2", path(name + ".pc2")
    cache.frame_start = 1
    bpy.ops.wm.save_as_mainfile(filepath=path(name + ".blend"))
    return frames, quads


def command(*arguments):
    """What bake_check does with the file that is open: status, output, complaint."""
    import pccd_blender
    out, err = io.StringIO(), io.StringIO()
    before, sys.argv = sys.argv, ["blender", "--", *arguments]
    try:
        with contextlib.redirect_stdout(out), contextlib.redirect_stderr(err):
            pccd_blender.bake_check()
        raise AssertionError("it did not end Blender")
    except SystemExit as end:
        return end.code, out.getvalue(), err.getvalue()
    finally:
        sys.argv = before


class Addon(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        bpy.ops.preferences.addon_install(filepath=ZIP)
        bake("clean", 0.55)
        cls.frames, cls.quads = bake("through", -9)

    def open(self, name="through"):
        bpy.ops.wm.open_mainfile(filepath=path(name + ".blend"))

    # If it failed, a user would have to install something else.
    def test_zip__brings_its_own_library(self):
        from pccd_blender.library import pccd
        self.assertEqual(pccd.__name__, "pccd_blender.pccd")
        self.assertTrue(pccd.__file__.startswith(os.environ["BLENDER_USER_SCRIPTS"]))
        with open("/proc/self/maps", encoding="ascii") as file:
            loaded = {line.split()[-1] for line in file if "libpccd" in line}
        self.assertTrue(loaded)
        self.assertTrue(all(one.startswith(os.environ["BLENDER_USER_SCRIPTS"])
                            for one in loaded), loaded)

    # If it failed, nobody would see where, which is what the add-on is for.
    def test_operator__lists_and_jumps(self):
        self.open()
        scene = bpy.context.scene
        asked = scene.pccd_check
        bpy.ops.pccd.range()
        self.assertEqual((asked.first, asked.last), (1, bakes.FRAMES))
        scene.frame_set(3)
        bpy.data.objects["Cloth"].select_set(True)
        bpy.data.objects["Ball"].select_set(True)
        bpy.ops.pccd.objects()
        self.assertEqual(len(asked.objects), 2)
        self.assertEqual(bpy.ops.pccd.check(), {"FINISHED"})
        self.assertEqual(scene.frame_current, 3)
        self.assertIn(f"{bakes.FRAMES} frames looked at: {len(asked.findings)} findings",
                      asked.said)
        number, last = [(k, one) for k, one in enumerate(asked.findings)
                        if one.kind == "crossing"][-1]
        self.assertEqual((last.frame, last.objects), (bakes.FRAMES, "Ball / Cloth"))
        bpy.data.objects["Ball"].select_set(False)
        asked.finding = number
        self.assertEqual(scene.frame_current, bakes.FRAMES)
        np.testing.assert_allclose(scene.cursor.location, last.place)
        self.assertTrue(bpy.data.objects["Ball"].select_get())
        radius = np.linalg.norm(last.place)
        self.assertTrue(0.45 < radius < 0.51, f"{radius} is not on the ball")

    # If it failed, Esc would end nothing, or leave the frame and the buttons as they
    # are while it goes on.
    def test_operator__is_cancelled(self):
        from pccd_blender import panel
        self.open()
        context = bpy.context
        context.scene.pccd_check.last = 100000

        class Pressed:
            type = "ESC"

        class Waited:
            type = "TIMER"

        class Operator:  # what Blender makes of the class, without a window
            timer = None
            begin, tick, end = (getattr(panel.PCCD_OT_check, name)
                                for name in ("begin", "tick", "end"))
            redraw = staticmethod(panel.PCCD_OT_check.redraw)

            def report(self, kind, text):
                raise AssertionError(text)

        class Manager:
            progress = []
            progress_update = progress.append
            event_timer_remove = progress_end = staticmethod(lambda *_: None)

        class Context:
            window_manager, screen = Manager, None

            def __getattr__(self, name):
                return getattr(context, name)

        made, modal = Operator(), panel.PCCD_OT_check.modal
        self.assertTrue(made.begin(context))
        for _ in range(3):
            self.assertEqual(modal(made, Context(), Waited), {"RUNNING_MODAL"})
        self.assertEqual(Manager.progress, [1, 2, 3])
        self.assertFalse(panel.PCCD_OT_check.poll(context))
        self.assertEqual(modal(made, Context(), Pressed), {"FINISHED"})
        self.assertTrue(panel.PCCD_OT_check.poll(context))
        self.assertIn("3 frames of 100000 looked at", context.scene.pccd_check.said)
        self.assertIn("cancelled", context.scene.pccd_check.said)

    # If it failed, a film of a check would show nothing, or everything at once.
    def test_markers__render_at_their_frames(self):
        self.open()
        bpy.context.scene.pccd_check.last = bakes.FRAMES
        bpy.context.scene.pccd_check.marker_size = 0.04
        bpy.ops.pccd.check()
        scene = bpy.context.scene
        self.assertTrue(any("pccd_markers" in one for one in scene.objects))
        camera = bpy.data.objects.new("Camera", bpy.data.cameras.new("Camera"))
        scene.collection.objects.link(camera)
        camera.location = (1.2, -1.4, 1.4)
        towards = mathutils.Vector((0, 0, 0.2)) - camera.location
        camera.rotation_euler = towards.to_track_quat("-Z", "Y").to_euler()
        sun = bpy.data.objects.new("Sun", bpy.data.lights.new("Sun", "SUN"))
        scene.collection.objects.link(sun)
        scene.camera, scene.render.engine = camera, "CYCLES"
        scene.cycles.samples, scene.cycles.use_denoising = 4, False
        scene.render.resolution_x, scene.render.resolution_y = 160, 120
        scene.view_settings.view_transform = "Standard"
        first = min(one.frame for one in scene.pccd_check.findings
                    if one.kind == "crossing")
        green, warm = self.render(first)
        self.assertGreater(green, 30)
        self.assertGreater(warm, 30)
        self.assertEqual(self.render(1), (0, 0))
        bpy.ops.pccd.remove_markers()
        self.assertFalse(any("pccd_markers" in one for one in scene.objects))
        self.assertFalse([one for one in bpy.data.meshes if one.name.startswith("pccd")])

    def render(self, frame):
        """How many pixels are as green as a crossing, and red as a contact."""
        scene = bpy.context.scene
        scene.frame_set(int(frame))
        scene.render.filepath = path(f"{os.getpid()}-{int(frame)}.png")
        bpy.ops.render.render(write_still=True)
        picture = bpy.data.images.load(scene.render.filepath)
        pixels = np.array(picture.pixels[:]).reshape(-1, 4)[:, :3]
        if os.environ.get("PCCD_PICTURES"):
            os.makedirs(os.environ["PCCD_PICTURES"], exist_ok=True)
            picture.save_render(f"{os.environ['PCCD_PICTURES']}/blender-{int(frame)}.png")
        red, green, blue = pixels.T
        return (int(((green > 0.7) & (red < 0.3) & (blue < 0.6)).sum()),
                int(((red > 0.7) & (green < 0.85 * red) & (blue < 0.75 * red)).sum()))

    # If it failed, the mesh of before the modifiers would be checked, or the object be
    # taken where it was modelled.
    def test_command__takes_the_modifiers_and_the_world(self):
        self.open()
        status, text, _ = command("--objects", "Cloth,Ball")
        self.assertEqual(status, 1)
        bpy.data.objects["Ball"].location.z = -9
        self.assertEqual(command()[0], 0)
        bpy.data.objects["Ball"].location.z = 0
        bpy.data.objects["Ball"].scale = (0.1, 0.1, 0.1)
        deeper = command()[1]
        self.assertNotEqual(deeper, text)
        bpy.data.objects["Cloth"].modifiers["Cache"].show_viewport = False
        self.assertEqual(command()[0], 0)

    # If it failed, these would be taken and not used.
    def test_command__knows_thickness_and_rest_exclusion(self):
        self.open()
        self.assertEqual(command("--frames", "1:3")[0], 0)
        self.assertEqual(command("--frames", "1:3", "--thickness", "0.2", "--rings",
                                 "8")[0], 1)
        crowded = command("--frames", "1:2", "--thickness", "0.1", "--objects", "Cloth")
        self.assertEqual(crowded[0], 1)
        self.assertIn("rest exclusion", crowded[1])
        for way in (("--rings", "4"), ("--rest-exclusion", "0.25"), ("--no-self",)):
            self.assertEqual(command("--frames", "1:2", "--thickness", "0.1", "--objects",
                                     "Cloth", *way)[0], 0, way)

    # If it failed, somebody would have to guess why, or be told that all is well.
    def test_command__says_what_it_cannot_check(self):
        self.open()
        lamp = bpy.data.objects.new("Lamp", bpy.data.lights.new("Lamp", "POINT"))
        curve = bpy.data.objects.new("Path", bpy.data.curves.new("Path", "CURVE"))
        for one in (lamp, curve):
            bpy.context.scene.collection.objects.link(one)
        add("Wire", np.zeros((2, 3)), np.empty((0, 3), int))
        add("Hidden", *bakes.ball()).hide_set(True)
        add("Gone", *bakes.ball()).hide_viewport = True
        for name, words in (("Nobody", 'no object "Nobody".*these meshes: .*Cloth'),
                            ("Lamp", '"Lamp" is no mesh but of the type light: take it'),
                            ("Path", '"Path" is no mesh .*curve: convert it'),
                            ("Wire", '"Wire" at frame 1 has no faces'),
                            ("Hidden", '"Hidden" is hidden'),
                            ("Gone", '"Gone" is hidden')):
            status, text, complaint = command("--objects", "Cloth," + name)
            self.assertEqual((status, text), (4, ""), name)
            self.assertRegex(complaint, "^bake check: " + words)
        status, text, _ = command("--frames", "1:2")  # all that can be
        self.assertEqual(status, 0, text)
        for wrong in (["--frames", "5:1"], ["--frames", "x"], ["--thickness", "-1"],
                      ["--rings", "9"], ["--nothing"]):
            status, text, complaint = command(*wrong)
            self.assertEqual((status, text), (2, ""), wrong)
            self.assertIn("bake check: ", complaint)

    # If it failed, vertices of one frame would be taken for others of the next.
    def test_command__tells_a_topology_that_changes(self):
        self.open()
        cut = bpy.data.objects["Cloth"].modifiers.new("Grow", "BUILD")
        cut.frame_start, cut.frame_duration = 1, 10
        status, _, complaint = command("--frames", "4:6", "--objects", "Cloth")
        self.assertEqual(status, 4)
        self.assertRegex(complaint, '"Cloth" is another mesh at frame 5 .* than at frame '
                         "4 .*modifiers are Cache, Grow")

    # If it failed, a simulation that has exploded would be told to be clean.
    def test_command__tells_what_is_nowhere(self):
        def explode(frames):
            frames[4][11, 2] = np.nan

        bake("nowhere", -9, explode)
        status, _, complaint = command("--objects", "Cloth")
        self.assertEqual(status, 4)
        self.assertIn('"Cloth" at frame 5: vertex 11 is nowhere', complaint)

    # If it failed, a quad that Blender cuts along its other diagonal in another frame
    # would be told to be another mesh.
    def test_command__checks_polygons_that_turn_over(self):
        bpy.ops.wm.read_factory_settings(use_empty=True)
        quad = np.float32([(0, 0, 0), (2, 0, 0), (2, 2, 0), (0, 2, 0)])
        dart = quad.copy()
        dart[1], flat = (0.5, 1.5, 0), np.array([(0, 1, 2, 3)])
        bakes.write_pc2(path("dart.pc2"), [quad, dart, quad])
        cache = add("Quad", quad, flat).modifiers.new("Cache", "MESH_CACHE")
        cache.cache_format, cache.filepath = "PC2", path("dart.pc2")
        cache.frame_start = 1
        status, _, complaint = command("--frames", "1:3", "--no-self")
        self.assertEqual((status, complaint), (0, ""))

    # If it failed, who reads the one could not read the other. The shell compares its
    # counts with pccdctl's, of the same frames in files.
    def test_json__is_that_of_pccdctl(self):
        self.open()
        status, text, _ = command("--json", "--save", path("marked.blend"))
        told = json.loads(text.splitlines()[0])
        self.assertEqual(status, 1)
        self.assertEqual(told["file"], path("through.blend"))
        self.assertEqual([one["name"] for one in told["objects"]], ["Ball", "Cloth"])
        x, triangles = bakes.ball()
        cut = np.concatenate([self.quads[:, :3], self.quads[:, [0, 2, 3]]])
        for k, frame in enumerate(self.frames):
            bakes.write_obj(path(f"{k}.obj"), np.concatenate([x, frame]),
                            np.concatenate([triangles, cut + len(x)]))
        bpy.ops.wm.open_mainfile(filepath=path("marked.blend"))
        self.assertTrue(any("pccd_markers" in one for one in bpy.context.scene.objects))
        self.assertEqual(json.loads(command("--json")[1])["contacts"], told["contacts"])


if __name__ == "__main__":
    tap.main(["check_addon"])
