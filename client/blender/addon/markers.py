"""markers.py - what was found, as objects that render.

Room:     client/blender. Needs Blender.
Does:     make a mesh of octahedra for what was found at a frame, and one for what meets
          on the way to the next, which is shown at both; or show all of them always.
          Remove them.
"""

import collections
import math

import bpy
import numpy as np

from . import octahedra
from .extract import is_marker

COLLECTION = "pccd markers"


def remove(scene):
    """Those of a scene, with what only they used."""
    for collection in list(scene.collection.children):
        if "pccd_markers" not in collection:
            continue
        for one in list(collection.objects):
            if is_marker(one):
                mesh, action = one.data, one.animation_data and one.animation_data.action
                bpy.data.objects.remove(one)
                bpy.data.meshes.remove(mesh)
                if action:
                    bpy.data.actions.remove(action)
        if not collection.objects:
            bpy.data.collections.remove(collection)


def _material(number):
    """Of one of the colours; it gives light, so that it looks the same in any light."""
    name = f"pccd {'crossing' if number == len(octahedra.SCALE) else number}"
    material = bpy.data.materials.get(name)
    if material is not None and "pccd_markers" in material:
        return material
    material = bpy.data.materials.new(name)
    material["pccd_markers"] = 1
    colour = [*octahedra.linear(octahedra.COLOURS[number]), 1]
    material.diffuse_color = colour
    material.use_nodes = True
    nodes = material.node_tree.nodes
    nodes.clear()
    light, end = nodes.new("ShaderNodeEmission"), nodes.new("ShaderNodeOutputMaterial")
    light.inputs["Color"].default_value = colour
    material.node_tree.links.new(light.outputs[0], end.inputs["Surface"])
    return material


def _show_at(one, first, last):
    """Hide an object but from one frame to another."""
    for hidden, at in ((True, first - 1), (False, first), (True, last + 1)):
        for name in ("hide_viewport", "hide_render"):
            setattr(one, name, hidden)
            one.keyframe_insert(name, frame=at)


def default_size(findings):
    """A hundredth of the box around all places; if there is one place alone, 0.05."""
    places = np.concatenate([one.places for one in findings])
    return max(0.01 * float(np.linalg.norm(np.ptp(places, axis=0))), 0) or 0.05


def make(scene, findings, size=0.0, only_at_their_frame=True):
    """Objects for the findings instead of those that the scene has. size: how far one
    reaches, in Blender's units; 0: default_size. How many markers there are."""
    remove(scene)
    if not findings:
        return 0
    size = size or default_size(findings)
    collection = bpy.data.collections.new(COLLECTION)
    collection["pccd_markers"] = 1
    scene.collection.children.link(collection)
    by_frames = collections.defaultdict(list)
    for one in findings:
        by_frames[math.floor(one.frame), math.ceil(one.to)].append(one)
    made = 0
    for (first, last), those in by_frames.items():
        places = np.concatenate([one.places for one in those])
        colours = np.concatenate([octahedra.colour_indices(one.kind, one.times)
                                  for one in those])
        vertices, faces = octahedra.octahedra(places, size)
        mesh = bpy.data.meshes.new(
            f"pccd {first}" if first == last else f"pccd {first} to {last}")
        mesh.from_pydata(vertices.tolist(), [], faces.tolist())
        used = np.unique(colours)
        for number in used:
            mesh.materials.append(_material(int(number)))
        mesh.polygons.foreach_set("material_index", np.repeat(
            np.searchsorted(used, colours), len(octahedra.FACES)).astype(np.int32))
        marker = bpy.data.objects.new(mesh.name, mesh)
        marker["pccd_markers"] = 1
        marker.show_in_front = True  # in the view, where a surface would hide it
        collection.objects.link(marker)
        if only_at_their_frame:
            _show_at(marker, first, last)
        made += len(places)
    scene.frame_set(scene.frame_current, subframe=scene.frame_subframe)
    return made
