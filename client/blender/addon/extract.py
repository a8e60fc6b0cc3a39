"""extract.py - Blender's objects as shapes.

Room:     client/blender. Needs Blender.
Does:     read objects with their modifiers applied, in world space, and say in words why
          one cannot be read.
"""

import bpy
import numpy as np

from .shape import Refusal, Shape


def objects_named(view_layer, names):
    """The objects of these names, or all meshes that are shown where there are none."""
    view_layer.update()  # else what was added just now is not shown yet
    if not names:
        found = [one for one in view_layer.objects
                 if one.type == "MESH" and one.visible_get(view_layer=view_layer) and
                 not is_marker(one) and len(one.data.polygons)]
        if not found:
            raise Refusal("no mesh with faces is shown in the view layer "
                          f'"{view_layer.name}"')
        return found
    found = []
    for name in dict.fromkeys(names):
        if name not in view_layer.objects:
            near = [one.name for one in view_layer.objects if one.type == "MESH"][:10]
            raise Refusal(f'no object "{name}" in the view layer "{view_layer.name}"; '
                          "it has these meshes: " + (", ".join(near) or "none"))
        found.append(view_layer.objects[name])
    return found


def is_marker(one):
    return "pccd_markers" in one


def check_object(one, view_layer):
    """Refuse what Blender has no surface of."""
    if one.type != "MESH":
        raise Refusal(f'"{one.name}" is no mesh but of the type {one.type.lower()}: ' +
                      ("convert it to a mesh (Object > Convert)"
                       if one.type in ("CURVE", "SURFACE", "META", "FONT", "CURVES")
                       else "take it off the list"))
    if one.mode == "EDIT":
        raise Refusal(f'"{one.name}" is being edited: leave its edit mode')
    if not one.visible_get(view_layer=view_layer):
        raise Refusal(f'"{one.name}" is hidden, and Blender does not compute what is '
                      "hidden: show it, or take it off the list")


def _read(mesh, name, dtype, each=1):
    values = np.empty(len(mesh) * each, dtype)
    mesh.foreach_get(name, values)
    return values


def shape_of(one, depsgraph, with_triangles):
    """An object as the depsgraph has it."""
    evaluated = one.evaluated_get(depsgraph)
    mesh = evaluated.to_mesh()
    try:
        local = _read(mesh.vertices, "co", np.float32, 3).reshape(-1, 3)
        corners = _read(mesh.loops, "vertex_index", np.int32)
        sizes = _read(mesh.polygons, "loop_total", np.int32)
        triangles = None
        if with_triangles:
            mesh.calc_loop_triangles()
            triangles = _read(mesh.loop_triangles, "vertices", np.int32, 3)
            triangles = triangles.reshape(-1, 3).astype(np.uint32)
    finally:
        evaluated.to_mesh_clear()
    world = np.array(evaluated.matrix_world, np.float64)
    x = local.astype(np.float64) @ world[:3, :3].T + world[:3, 3]
    names = tuple(modifier.name for modifier in one.modifiers if modifier.show_viewport)
    return Shape(one.name, x, corners, sizes, triangles, names)


class Source:
    """The function that a Check is given: it sets the scene's frame and reads."""

    def __init__(self, scene, view_layer, objects):
        if not objects:
            raise Refusal("no object to check: choose some")
        self._scene, self._view_layer = scene, view_layer
        self._names = [one.name for one in objects]
        self._frame = scene.frame_current, scene.frame_subframe
        for one in objects:
            check_object(one, view_layer)

    def __call__(self, moment, with_triangles):
        whole = int(moment // 1)
        self._scene.frame_set(whole, subframe=moment - whole)
        # Names, not the objects: these may be gone, or be others after an undo.
        objects = objects_named(self._view_layer, self._names)
        for one in objects:
            check_object(one, self._view_layer)
        depsgraph = bpy.context.evaluated_depsgraph_get()
        return [shape_of(one, depsgraph, with_triangles) for one in objects]

    def restore(self):
        """The frame that the scene was at."""
        self._scene.frame_set(self._frame[0], subframe=self._frame[1])
