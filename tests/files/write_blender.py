"""write_blender.py - has Blender write the scenes, in all formats and ways that it knows.

Room:     tests/files. Runs in Blender 3.4 to 4.3; needs scenes.json of scenes.py.
Does:     OBJ, PLY, STL, glTF and FBX, standing and as two frames; animated by locations,
          quaternions, shape keys and bones; PC2 and MDD. A file is SCENE.WAY.ENDING, the
          two of a motion SCENE.WAY.0.ENDING and SCENE.WAY.1.ENDING.
Usage:    blender -b --factory-startup -P write_blender.py -- SCENES.JSON FOLDER
"""

import json
import os
import sys

import addon_utils
import bpy

FRAMES = 24  # steps of an animation
OLD = bpy.app.version < (4, 0, 0)


def clear():
    bpy.ops.wm.read_factory_settings(use_empty=True)
    for name in "io_scene_gltf2", "io_scene_fbx", "io_mesh_ply", "io_mesh_stl", \
            "io_export_pc2", "io_shape_mdd", "io_scene_obj", "io_scene_x3d":
        try:
            addon_utils.enable(name)
        except Exception:  # this Blender has it built in, or not at all
            pass
    bpy.context.scene.render.fps = 24
    bpy.context.scene.frame_start, bpy.context.scene.frame_end = 1, 1 + FRAMES


def new_object(name, vertices, faces):
    mesh = bpy.data.meshes.new(name)
    mesh.from_pydata(vertices, [], faces)
    made = bpy.data.objects.new(name, mesh)
    bpy.context.collection.objects.link(made)
    bpy.context.view_layer.objects.active = made
    made.select_set(True)
    return made


def cut_seams(made):
    """A texture in which each quad has a place of its own: seams everywhere."""
    layer = made.data.uv_layers.new(name="UVMap")
    for face in made.data.polygons:
        for k, loop in enumerate(face.loop_indices):
            corner = ((0, 0), (1, 0), (1, 1), (0, 1))[k % 4]
            layer.data[loop].uv = [(face.index + 0.9 * corner[0]) / 64, 0.9 * corner[1]]


def build(name, things):
    """The scene as objects, standing at t = 0."""
    clear()
    add = bpy.ops.mesh
    if name == "cube":
        add.primitive_cube_add(size=2)
    elif name == "ball":
        add.primitive_uv_sphere_add()
    elif name == "ico":
        add.primitive_ico_sphere_add()
    elif name == "monkey":
        add.primitive_monkey_add()
    objects = []
    for one in things if name != "cube" else []:
        objects.append(new_object(one["name"], one["vertices"], one["faces"]))
        if "seams" in one:
            cut_seams(objects[-1])
    return objects


def put(objects, things, t):
    for made, one in zip(objects, things):
        made.location = [t * m for m in one["move"]]
    bpy.context.view_layer.update()


def calls():
    """By ending and way: what writes a file, given its path."""
    scene, mesh, wm = bpy.ops.export_scene, bpy.ops.export_mesh, bpy.ops.wm
    ways = {
        ("obj", "plain"): lambda p: wm.obj_export(filepath=p),
        ("obj", "cut"): lambda p: wm.obj_export(filepath=p, export_triangulated_mesh=True,
                                                export_uv=False, export_normals=False),
        ("obj", "groups"): lambda p: wm.obj_export(filepath=p, export_object_groups=True,
                                                   export_smooth_groups=True),
        ("glb", "plain"): lambda p: scene.gltf(filepath=p, export_format="GLB",
                                               export_animations=False),
        ("glb", "smooth"): lambda p: scene.gltf(filepath=p, export_format="GLB",
                                                export_animations=False,
                                                export_normals=False),
        ("gltf", "plain"): lambda p: scene.gltf(filepath=p, export_format="GLTF_SEPARATE",
                                                export_animations=False),
        ("fbx", "plain"): lambda p: scene.fbx(filepath=p),
    }
    if OLD:
        ways.update({
            ("obj", "legacy"): lambda p: scene.obj(filepath=p, check_existing=False),
            ("ply", "binary"): lambda p: mesh.ply(filepath=p, use_ascii=False),
            ("ply", "ascii"): lambda p: mesh.ply(filepath=p, use_ascii=True),
            ("ply", "bare"): lambda p: mesh.ply(filepath=p, use_normals=False,
                                                use_uv_coords=False, use_colors=False),
            ("stl", "binary"): lambda p: mesh.stl(filepath=p, ascii=False),
            ("stl", "ascii"): lambda p: mesh.stl(filepath=p, ascii=True),
            ("gltf", "inside"): lambda p: scene.gltf(filepath=p, export_animations=False,
                                                     export_format="GLTF_EMBEDDED"),
            ("x3d", "plain"): lambda p: scene.x3d(filepath=p),
            ("dae", "plain"): lambda p: wm.collada_export(filepath=p)})
    else:
        ways.update({
            ("ply", "binary"): lambda p: wm.ply_export(filepath=p, ascii_format=False),
            ("ply", "ascii"): lambda p: wm.ply_export(filepath=p, ascii_format=True),
            ("ply", "cut"): lambda p: wm.ply_export(filepath=p, ascii_format=False,
                                                    export_triangulated_mesh=True),
            ("stl", "binary"): lambda p: wm.stl_export(filepath=p, ascii_format=False),
            ("stl", "ascii"): lambda p: wm.stl_export(filepath=p, ascii_format=True)})
    return ways


RARE = {"fbx": "pass", "x3d": "cube", "dae": "cube"}  # what is not read is written once


def write(path, how):
    if os.path.exists(path):
        os.remove(path)
    try:
        how(path)
    except Exception as error:  # of a program of others: say it, go on
        print(f"not written: {os.path.basename(path)}: {error}".splitlines()[0])


def write_standing(folder, name, scene):
    things, moves = scene["things"], scene["right"]["moves"]
    for (ending, way), how in calls().items():
        if RARE.get(ending, name) != name or name == "swing":
            continue
        for k in (0, 1) if moves else (0,):
            objects = build(name, things)
            put(objects, things, k)
            write(os.path.join(folder, f"{name}.{way}.{k}.{ending}" if moves else
                               f"{name}.{way}.{ending}"), how)


def linear(owner):
    for curve in owner.animation_data.action.fcurves:
        for key in curve.keyframe_points:
            key.interpolation = "LINEAR"


def by_location(made, one):
    for frame, t in (1, 0), (1 + FRAMES, 1):
        made.location = [t * m for m in one["move"]]
        made.keyframe_insert("location", frame=frame)
    linear(made)


def by_quaternion(made, _):
    made.rotation_mode = "QUATERNION"
    for frame, turn in (1, (1, 0, 0, 0)), (1 + FRAMES, (0.5 ** 0.5, 0, 0, 0.5 ** 0.5)):
        made.rotation_quaternion = turn
        made.keyframe_insert("rotation_quaternion", frame=frame)
    linear(made)


def by_shape_key(made, one):
    made.shape_key_add(name="Basis")
    key = made.shape_key_add(name="Down")
    for point, v in zip(key.data, made.data.vertices):
        point.co = [a + m for a, m in zip(v.co, one["move"])]
    for frame, value in (1, 0), (1 + FRAMES, 1):
        key.value = value
        key.keyframe_insert("value", frame=frame)
    linear(made.data.shape_keys)


def by_bone(made, one):
    """A bone along z takes the object with it."""
    bones = bpy.data.armatures.new("Bones")
    rig = bpy.data.objects.new("Rig", bones)
    bpy.context.collection.objects.link(rig)
    bpy.context.view_layer.objects.active = rig
    bpy.ops.object.mode_set(mode="EDIT")
    bone = bones.edit_bones.new("Bone")
    bone.head, bone.tail = (0, 0, 0), (0, 0, 1)
    bpy.ops.object.mode_set(mode="OBJECT")
    made.vertex_groups.new(name="Bone").add(range(len(made.data.vertices)), 1, "REPLACE")
    made.modifiers.new("Armature", "ARMATURE").object = rig
    made.parent = rig
    pose = rig.pose.bones["Bone"]
    for frame, t in (1, 0), (1 + FRAMES, 1):
        pose.location = (0, t * one["move"][2], 0)  # y is along the bone
        pose.keyframe_insert("location", frame=frame)
    linear(rig)


def under_parent(made, one):
    """Keys of an object whose parent is turned, scaled and elsewhere."""
    parent = bpy.data.objects.new("Parent", None)
    bpy.context.collection.objects.link(parent)
    for other in list(bpy.data.objects):
        if other is not parent:
            other.parent = parent
    parent.location, parent.scale = (3, 5, 7), (2, 2, 2)
    parent.rotation_mode = "QUATERNION"
    parent.rotation_quaternion = (0.5, 0.5, 0.5, 0.5)
    by_location(made, one)


def beside_lamps(made, one):
    for name, data in ("Camera", bpy.data.cameras.new("Camera")), \
            ("Lamp", bpy.data.lights.new("Lamp", "POINT")):
        other = bpy.data.objects.new(name, data)
        other.rotation_euler = (1, 2, 3)
        bpy.context.collection.objects.link(other)
    by_location(made, one)


def write_animated(folder, scenes):
    write_gltf = bpy.ops.export_scene.gltf
    for name, way, how in ("pass", "location", by_location), \
            ("drop", "key", by_shape_key), ("pass", "key", by_shape_key), \
            ("drop", "bone", by_bone), ("pass", "bone", by_bone), \
            ("swing", "quaternion", by_quaternion), ("pass", "parent", under_parent), \
            ("pass", "lamps", beside_lamps):
        for ending, kind in ("glb", "GLB"), ("gltf", "GLTF_SEPARATE"):
            things = scenes[name]["things"]
            objects = build(name, things)
            moved = next(k for k, one in enumerate(things)
                         if any(one["move"]) or "turn" in one)
            how(objects[moved], things[moved])
            write(os.path.join(folder, f"{name}.{way}.{ending}"),
                  lambda p: write_gltf(filepath=p, export_format=kind,
                                       export_cameras=True, export_lights=True))


def write_squeezed(folder, scenes):
    """What only a library can read."""
    for name in "cube", "cloth":
        build(name, scenes[name]["things"])
        path = os.path.join(folder, f"{name}.draco.glb")
        write(path, lambda p: bpy.ops.export_scene.gltf(
            filepath=p, export_format="GLB", export_animations=False,
            export_draco_mesh_compression_enable=True))


def write_caches(folder, scenes):
    """Positions alone, of one object, beside an OBJ of it."""
    for name in "drop", "pass":
        for ending in "pc2", "mdd":
            things = scenes[name]["things"]
            build(name, [])
            vertices, faces, moved = [], [], []
            for one in things:
                faces += [[k + len(vertices) for k in f] for f in one["faces"]]
                vertices += one["vertices"]
                moved += [[a + m for a, m in zip(v, one["move"])]
                          for v in one["vertices"]]
            made = new_object("All", vertices, faces)
            made.shape_key_add(name="Basis")
            key = made.shape_key_add(name="Down")
            for point, at in zip(key.data, moved):
                point.co = at
            for frame, value in (1, 0), (1 + FRAMES, 1):
                key.value = value
                key.keyframe_insert("value", frame=frame)
            linear(made.data.shape_keys)
            write(os.path.join(folder, f"{name}.{ending}.0.obj"),
                  lambda p: bpy.ops.wm.obj_export(filepath=p))
            export = getattr(bpy.ops.export_shape, ending)
            span = {"range_start": 1, "range_end": 1 + FRAMES} if ending == "pc2" else \
                {"frame_start": 1, "frame_end": 1 + FRAMES, "fps": 24}
            write(os.path.join(folder, f"{name}.{ending}.1.{ending}"),
                  lambda p: export(filepath=p, **span))


def main():
    source, folder = sys.argv[sys.argv.index("--") + 1:]
    with open(source, encoding="ascii") as file:
        scenes = json.load(file)
    folder = os.path.join(folder, "blender-%d.%d" % bpy.app.version[:2])
    os.makedirs(folder, exist_ok=True)
    for name, scene in scenes.items():
        if name != "globe":
            write_standing(folder, name, scene)
    write_animated(folder, scenes)
    write_squeezed(folder, scenes)
    if OLD:
        write_caches(folder, scenes)


main()
