"""files.py - files whose contents are known, for those who ask about them.

Room:     tests/mcp.
Does:     write boxes, triangles and scene files; coordinates are small whole numbers and
          halves, so that times and distances are exact.
"""

import json

BOX = ((1, 2, 4, 3), (5, 7, 8, 6), (1, 5, 6, 2), (3, 4, 8, 7), (1, 3, 7, 5), (2, 6, 8, 4))


def write_mesh(path, vertices, faces):
    """An OBJ file; faces count from 1."""
    with open(path, "w", encoding="ascii") as file:
        file.writelines("v %r %r %r\n" % tuple(x) for x in vertices)
        file.writelines("f " + " ".join(map(str, face)) + "\n" for face in faces)


def write_box(path, low, high):
    """A closed box between two corners; its vertex 0 is the low one, 7 the high one."""
    corners = [[(low, high)[k][0], (low, high)[j][1], (low, high)[i][2]]
               for k in (0, 1) for j in (0, 1) for i in (0, 1)]
    write_mesh(path, corners, BOX)


def write_triangle(path, *corners):
    write_mesh(path, corners, [(1, 2, 3)])


def write_falling(folder):
    """A box of side 2 that falls by 4 a frame, and a floor whose top is 0."""
    for i in range(4):
        write_box(folder / f"box{i}.obj", (0, 0, 10 - 4 * i), (2, 2, 12 - 4 * i))
    write_box(folder / "floor.obj", (-50, -50, -100), (50, 50, 0))


def write_hinge(folder):
    """A leaf that turns about z, up to 1.5; at 30 degrees it meets an edge of a post."""
    write_box(folder / "post.obj", (0.75 ** 0.5 - 0.2, 0.5, -0.15), (0.75 ** 0.5, 0.7,
                                                                     0.15))
    write_box(folder / "leaf.obj", (0.5, -0.2, -0.05), (1.5, 0, 0.05))
    write_scene(folder / "hinge.json",
                [{"name": "post", "files": "post.obj"},
                 {"name": "leaf", "files": "leaf.obj", "joint": "pin"}],
                joints=[{"name": "pin", "type": "revolute", "axis": [0, 0, 1],
                         "range": [0, 1.5]}])


def write_scene(path, objects, **more):
    path.write_text(json.dumps({"pccd_scene": 1, "objects": objects, **more}))
