"""write_numpy.py - has meshio, VTK and trimesh write the scenes, those that are here.

Room:     tests/files. Needs numpy and meshio, vtk or trimesh; scenes.json of scenes.py.
Does:     OBJ, PLY, STL, glTF, OFF, and what meshio or VTK must read: VTU, legacy VTK,
          XDMF, MSH; surfaces, and a cube of tetrahedra.
Usage:    write_numpy.py SCENES FOLDER
"""

import json
import os
import sys
import traceback

import numpy as np

WHICH = "cube", "two", "cloth", "drop", "pass", "rain", "comb", "ell", "slope", "flag"


def frames(scene):
    """What names a frame, vertices and faces; at t = 1, too, if the scene moves."""
    for t in (0, 1) if scene["right"]["moves"] else (0,):
        vertices, faces = [], []
        for one in scene["things"]:
            faces += [[k + len(vertices) for k in f] for f in one["faces"]]
            vertices += [[a + t * m for a, m in zip(v, one["move"])]
                         for v in one["vertices"]]
        yield f".{t}" if scene["right"]["moves"] else "", np.array(vertices), faces


def fans(faces):
    return np.array([[f[0], f[k], f[k + 1]] for f in faces for k in range(1, len(f) - 1)])


def tried(path, how):
    """Somebody else's program may not do it; then there is no half of a file."""
    try:
        how(path)
    except Exception:
        print(f"not written: {path}:", traceback.format_exc(limit=-1).splitlines()[-1])
        if os.path.exists(path):
            os.remove(path)


def write_meshio(scenes, target):
    import meshio
    folder = os.path.join(target, f"meshio-{meshio.__version__}")
    os.makedirs(folder, exist_ok=True)

    def keep(name, points, cells, form, **options):
        tried(os.path.join(folder, name), lambda path: meshio.Mesh(points, cells).write(
            path, file_format=form, **options))

    for name in WHICH:
        for suffix, points, faces in frames(scenes[name]):
            if any(len(f) > 4 for f in faces):
                continue
            quads = [f for f in faces if len(f) == 4]
            mixed = [("quad", np.array(quads))] if quads else []
            if len(quads) < len(faces):
                mixed.append(("triangle", np.array([f for f in faces if len(f) == 3])))
            three = [("triangle", fans(faces))]
            for way, cells in ("mixed", mixed), ("cut", three):
                for ending, form in ("obj", "obj"), ("vtu", "vtu"), ("vtk", "vtk"), \
                        ("xdmf", "xdmf"), ("msh", "gmsh"):
                    keep(f"{name}.{way}{suffix}.{ending}", points, cells, form)
                keep(f"{name}.{way}22{suffix}.msh", points, cells, "gmsh22", binary=False)
                keep(f"{name}.{way}{suffix}.ply", points, cells, "ply")
                keep(f"{name}.{way}-ascii{suffix}.ply", points, cells, "ply",
                     binary=False)
            keep(f"{name}.cut{suffix}.stl", points, three, "stl")
            keep(f"{name}.cut-binary{suffix}.stl", points, three, "stl", binary=True)
            keep(f"{name}.cut{suffix}.off", points, three, "off")
    points = next(frames(scenes["cube"]))[1]  # vertex 4 i + 2 j + k
    five = [("tetra", np.array([[0, 3, 5, 6], [1, 0, 3, 5], [2, 0, 6, 3], [4, 0, 5, 6],
                                [7, 3, 6, 5]]))]
    for ending, form in ("vtu", "vtu"), ("vtk", "vtk"), ("xdmf", "xdmf"), ("msh", "gmsh"):
        keep(f"cube.tetrahedra.{ending}", points, five, form)


def vtk_surface(points, faces):
    import vtk
    made, cells, places = vtk.vtkPolyData(), vtk.vtkCellArray(), vtk.vtkPoints()
    places.SetDataTypeToDouble()
    for p in points:
        places.InsertNextPoint(*p)
    for f in faces:
        cells.InsertNextCell(len(f), f)
    made.SetPoints(places)
    made.SetPolys(cells)
    return made


def write_vtk(scenes, target):
    import vtk
    folder = os.path.join(target, f"vtk-{vtk.VTK_VERSION}")
    os.makedirs(folder, exist_ok=True)

    def keep(name, writer, data, **settings):
        made = getattr(vtk, writer)()
        for key, value in settings.items():
            getattr(made, key)(*([value] if value is not None else []))
        made.SetFileName(os.path.join(folder, name))
        made.SetInputData(data)
        made.Write()

    for name in WHICH:
        for suffix, points, faces in frames(scenes[name]):
            data = vtk_surface(points, faces)
            three = vtk_surface(points, fans(faces).tolist())
            join = vtk.vtkAppendFilter()
            join.AddInputData(data)
            join.Update()
            grid = join.GetOutput()
            keep(f"{name}.plain{suffix}.obj", "vtkOBJWriter", data)
            keep(f"{name}.ascii{suffix}.ply", "vtkPLYWriter", data,
                 SetFileTypeToASCII=None)
            keep(f"{name}.little{suffix}.ply", "vtkPLYWriter", data,
                 SetDataByteOrderToLittleEndian=None)
            keep(f"{name}.big{suffix}.ply", "vtkPLYWriter", data,
                 SetDataByteOrderToBigEndian=None)
            if max(map(len, faces)) <= 4:  # others would be cut as fans
                keep(f"{name}.ascii{suffix}.stl", "vtkSTLWriter", three,
                     SetFileTypeToASCII=None)
                keep(f"{name}.binary{suffix}.stl", "vtkSTLWriter", three,
                     SetFileTypeToBinary=None)
            keep(f"{name}.ascii{suffix}.vtu", "vtkXMLUnstructuredGridWriter", grid,
                 SetDataModeToAscii=None)
            keep(f"{name}.appended{suffix}.vtu", "vtkXMLUnstructuredGridWriter", grid,
                 SetDataModeToAppended=None)
            keep(f"{name}.grid{suffix}.vtk", "vtkUnstructuredGridWriter", grid)
            keep(f"{name}.surface{suffix}.vtk", "vtkPolyDataWriter", data)


def write_trimesh(scenes, target):
    import trimesh
    folder = os.path.join(target, f"trimesh-{trimesh.__version__}")
    os.makedirs(folder, exist_ok=True)
    for name in WHICH[:6]:
        for suffix, points, faces in frames(scenes[name]):
            mesh = trimesh.Trimesh(points, fans(faces), process=False)
            for ending, way, options in ("obj", "plain", {}), ("ply", "binary", {}), \
                    ("ply", "ascii", {"encoding": "ascii"}), ("stl", "binary", {}), \
                    ("stl", "ascii", {"file_type": "stl_ascii"}), ("glb", "plain", {}), \
                    ("off", "plain", {}):
                path = os.path.join(folder, f"{name}.{way}{suffix}.{ending}")
                tried(path, lambda p: mesh.export(p, **options))


def main():
    source, target = sys.argv[1:]
    with open(os.path.join(source, "scenes.json"), encoding="ascii") as file:
        scenes = json.load(file)
    for write in write_meshio, write_vtk, write_trimesh:
        try:
            write(scenes, target)
        except ImportError as error:
            print(f"not written: {error}")


main()
