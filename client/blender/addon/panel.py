"""panel.py - the panel in the sidebar of the 3D view.

Room:     client/blender. Needs Blender.
Does:     settings, a button that checks a frame at a time while Blender goes on, a list
          of what was found that one jumps by, markers.
"""

import bpy
from bpy.props import (BoolProperty, CollectionProperty, FloatProperty,
                       FloatVectorProperty, IntProperty, PointerProperty, StringProperty)

from . import extract, markers
from .shape import Refusal, frame_text

FINDINGS_MAX = 10000  # in the list
running = None  # the Check of the operator that goes on, if any


class PCCD_PG_object(bpy.types.PropertyGroup):
    object: PointerProperty(type=bpy.types.Object)


class PCCD_PG_finding(bpy.types.PropertyGroup):
    """A check's Finding, as far as the list shows it and jumps to it."""

    frame: FloatProperty()
    kind: StringProperty()
    objects: StringProperty()
    first: StringProperty()
    second: StringProperty()
    count: IntProperty()
    time: FloatProperty()
    place: FloatVectorProperty(subtype="XYZ")
    text: StringProperty()


def _jump(settings, context):
    if 0 <= settings.finding < len(settings.findings):
        jump_to(context, settings.findings[settings.finding])


class PCCD_PG_check(bpy.types.PropertyGroup):
    objects: CollectionProperty(type=PCCD_PG_object)
    object: IntProperty()
    first: IntProperty(name="First", default=1, description="First frame to look at")
    last: IntProperty(name="Last", default=250, description="Last frame to look at")
    radius: FloatProperty(
        name="Thickness / 2", default=0, min=0, precision=5, unit="LENGTH",
        description="Radius of every vertex, edge and face: two surfaces meet when they "
        "are twice that far apart")
    rest_rings: IntProperty(
        name="Rings", default=0, min=0, max=8, description="Parts of one object that so "
        "few edges join have no thickness towards each other")
    rest_distance: FloatProperty(
        name="Rest exclusion", default=0, min=0, precision=5, unit="LENGTH",
        description="Parts of one object that are nearer than that in the first frame "
        "have no thickness towards each other")
    steps: IntProperty(
        name="Steps a frame", default=1, min=1, max=100, description="Between two of "
        "these, vertices go straight; what turns fast needs several")
    with_self: BoolProperty(name="Self", default=True,
                            description="Test each object against itself, too")
    make_markers: BoolProperty(name="Markers", default=True,
                               description="Put markers where something was found")
    only_at_their_frame: BoolProperty(
        name="At their frame only", default=True,
        description="Show a marker at its frame alone, not at all times")
    marker_size: FloatProperty(name="Size", default=0, min=0, unit="LENGTH",
                               description="How far a marker reaches; 0: by itself")
    findings: CollectionProperty(type=PCCD_PG_finding)
    finding: IntProperty(update=_jump)
    said: StringProperty()


def jump_to(context, finding):
    """Go to the frame, select the objects, put the cursor and the views at the place."""
    scene = context.scene
    whole = int(finding.frame // 1)
    scene.frame_set(whole, subframe=finding.frame - whole)
    scene.cursor.location = finding.place
    for one in context.view_layer.objects:
        one.select_set(one.name in (finding.first, finding.second))
    first = context.view_layer.objects.get(finding.first)
    if first is not None:
        context.view_layer.objects.active = first
        size = max(first.dimensions) or 1
        for area in context.screen.areas if context.screen else ():
            if area.type == "VIEW_3D":
                view = area.spaces.active.region_3d
                view.view_location = finding.place
                view.view_distance = size / 2
                area.tag_redraw()


def start(context):
    """A Check of what the panel says, and its source; Refusal, ImportError."""
    from . import check  # needs the library, which may be missing
    asked = context.scene.pccd_check
    chosen = [one.object for one in asked.objects if one.object is not None]
    settings = check.Settings(asked.first, asked.last, asked.radius, asked.rest_distance,
                              asked.rest_rings, asked.steps, asked.with_self)
    chosen = chosen or extract.objects_named(context.view_layer, [])
    source = extract.Source(context.scene, context.view_layer, chosen)
    return check.Check(settings, source), source


def show(context, checking):
    """Fill the list, and make the markers."""
    from . import report
    asked = context.scene.pccd_check
    asked.findings.clear()
    for found in checking.findings[:FINDINGS_MAX]:
        one = asked.findings.add()
        one.frame, one.kind, one.time = found.frame, found.kind, found.time
        one.count = min(found.count, 2**31 - 1)
        one.first, one.second = found.objects[0], found.objects[-1]
        one.objects = " / ".join(found.objects)
        one.place, one.text = found.places[0], report.finding_text(found)
    asked.said = report.summary_text(checking)
    if asked.make_markers:
        markers.make(context.scene, checking.findings, asked.marker_size,
                     asked.only_at_their_frame)


class PCCD_OT_check(bpy.types.Operator):
    """Look at every frame of the range for what crosses, and between them for what meets.
Esc cancels"""

    bl_idname = "pccd.check"
    bl_label = "Check"

    @classmethod
    def poll(cls, context):
        return running is None

    def begin(self, context):
        """Whether there is something to go on with."""
        global running
        try:
            running, self.source = start(context)
        except (Refusal, ImportError) as problem:
            return self.fail(context, problem)
        return True

    def fail(self, context, problem):
        context.scene.pccd_check.said = str(problem)
        self.report({"ERROR"}, str(problem))
        return False

    def tick(self, context):
        """A frame. Whether there are more."""
        try:
            if running.tick():
                return True
        except (Refusal, ImportError, MemoryError) as problem:
            self.end(context)
            return self.fail(context, problem)
        self.end(context)
        return False

    def end(self, context):
        """Show what was found, at the frame of before."""
        global running
        checking, running = running, None
        checking.close()
        self.source.restore()
        show(context, checking)

    def execute(self, context):
        """From a script: all at once."""
        if not self.begin(context):
            return {"CANCELLED"}
        while self.tick(context):
            pass
        return {"FINISHED"}

    def invoke(self, context, event):
        if not self.begin(context):
            return {"CANCELLED"}
        manager = context.window_manager
        self.timer = manager.event_timer_add(0.01, window=context.window)
        manager.progress_begin(0, running.total)
        manager.modal_handler_add(self)
        return {"RUNNING_MODAL"}

    def modal(self, context, event):
        if event.type == "ESC":
            running.cancel()
        elif event.type != "TIMER":
            return {"PASS_THROUGH"}
        manager = context.window_manager
        if self.tick(context):
            manager.progress_update(running.done)
            context.scene.pccd_check.said = \
                f"frame {frame_text(running.moment(running.done))}: " \
                f"{running.done} of {running.total}; Esc cancels"
            self.redraw(context)
            return {"RUNNING_MODAL"}
        manager.event_timer_remove(self.timer)
        manager.progress_end()
        self.redraw(context)
        return {"FINISHED"}

    def cancel(self, context):
        """Blender itself ends it: another file is opened, the window is closed."""
        global running
        if running is not None:
            running.close()
        running = None

    @staticmethod
    def redraw(context):
        for area in context.screen.areas if context.screen else ():
            if area.type == "VIEW_3D":
                area.tag_redraw()


class PCCD_OT_cancel(bpy.types.Operator):
    """End the check after the frame at hand; what was found stays"""

    bl_idname = "pccd.cancel"
    bl_label = "Cancel"

    def execute(self, context):
        if running is not None:
            running.cancel()
        return {"FINISHED"}


class PCCD_OT_objects(bpy.types.Operator):
    """Check the selected objects; without any, every mesh that is shown"""

    bl_idname = "pccd.objects"
    bl_label = "Take the selected objects"

    def execute(self, context):
        asked = context.scene.pccd_check
        asked.objects.clear()
        for one in context.selected_objects:
            asked.objects.add().object = one
        return {"FINISHED"}


class PCCD_OT_range(bpy.types.Operator):
    """Check the frames of the scene"""

    bl_idname = "pccd.range"
    bl_label = "The scene's frames"

    def execute(self, context):
        asked, scene = context.scene.pccd_check, context.scene
        asked.first, asked.last = scene.frame_start, scene.frame_end
        return {"FINISHED"}


class PCCD_OT_remove_markers(bpy.types.Operator):
    """Remove all markers of the scene"""

    bl_idname = "pccd.remove_markers"
    bl_label = "Remove markers"

    def execute(self, context):
        markers.remove(context.scene)
        return {"FINISHED"}


class PCCD_UL_objects(bpy.types.UIList):
    def draw_item(self, context, layout, data, item, icon, active, name, index):
        layout.label(text=item.object.name if item.object else "(removed)",
                     icon="OBJECT_DATA")


class PCCD_UL_findings(bpy.types.UIList):
    def draw_item(self, context, layout, data, item, icon, active, name, index):
        split = layout.split(factor=0.68, align=True)
        split.label(text=f"{frame_text(item.frame)}  {item.kind}  {item.objects}")
        split.label(text=f"{item.count}" +
                    (f"  {item.time:.2f}" if item.kind == "contact" else ""))


class PCCD_PT_check(bpy.types.Panel):
    bl_label = "Crossings and contacts"
    bl_category = "pccd"
    bl_space_type = "VIEW_3D"
    bl_region_type = "UI"

    def draw(self, context):
        layout, asked = self.layout, context.scene.pccd_check
        layout.operator("pccd.objects")
        if asked.objects:
            layout.template_list("PCCD_UL_objects", "", asked, "objects", asked, "object",
                                 rows=2)
        else:
            layout.label(text="Every mesh that is shown")
        row = layout.row(align=True)
        row.prop(asked, "first")
        row.prop(asked, "last")
        row.operator("pccd.range", text="", icon="TIME")
        column = layout.column(align=True)
        for name in ("radius", "rest_rings", "rest_distance", "steps", "with_self"):
            column.prop(asked, name)
        column = layout.column(align=True)
        for name in ("make_markers", "only_at_their_frame", "marker_size"):
            column.prop(asked, name)
        layout.operator("pccd.cancel" if running is not None else "pccd.check")
        self.write(context, asked.said)
        if asked.findings:
            split = layout.split(factor=0.68)
            split.label(text="Frame, kind, objects")
            split.label(text="Pairs, t")
            layout.template_list("PCCD_UL_findings", "", asked, "findings", asked,
                                 "finding", rows=8)
            if 0 <= asked.finding < len(asked.findings):
                self.write(context, asked.findings[asked.finding].text)
        layout.operator("pccd.remove_markers")

    def write(self, context, text):
        letters = context.region.width / (7 * context.preferences.system.ui_scale)
        column = self.layout.column(align=True)
        for line in wrapped(text, max(int(letters), 20)):
            column.label(text=line)


def wrapped(text, width):
    """Lines of a message, as wide as so many letters: a label has one line."""
    lines = [""]
    for word in text.split():
        if lines[-1] and len(lines[-1]) + len(word) >= width:
            lines.append("")
        lines[-1] += (" " if lines[-1] else "") + word
    return lines if text else []


CLASSES = (PCCD_PG_object, PCCD_PG_finding, PCCD_PG_check, PCCD_OT_check, PCCD_OT_cancel,
           PCCD_OT_objects, PCCD_OT_range, PCCD_OT_remove_markers, PCCD_UL_objects,
           PCCD_UL_findings, PCCD_PT_check)


def register():
    for one in CLASSES:
        bpy.utils.register_class(one)
    bpy.types.Scene.pccd_check = PointerProperty(type=PCCD_PG_check)


def unregister():
    del bpy.types.Scene.pccd_check
    for one in reversed(CLASSES):
        bpy.utils.unregister_class(one)
