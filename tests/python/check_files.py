"""check_files.py - python3 -m pccd check, on files that meshio writes and on broken ones.

Room:     tests/python.
Does:     compare what it says with what pccdctl check says of OBJ files of the same
          content; see that what meshio loses is refused by name.
"""

import json
import os
import subprocess
import sys
import tempfile
import unittest

import meshio
import numpy as np

FLOOR = [(-9, -9, 0), (9, -9, 0), (0, 9, 0)]
TET = [(0, 0, 1), (1, 0, 5), (0, 1, 5), (-1, -1, 5), (0, 0, 9)]
CUBE = [(x, y, z) for z in (0, 1) for x, y in ((0, 0), (1, 0), (1, 1), (0, 1))]
# An arrow's head, whose notch is at the second corner, and a peg in the notch.
DART = [(0, 0, 0), (1, 1, 0), (0, 4, 0), (-4, 0, 0)]
PEG = [(.1, 1.2, 1), (.1, 1.2, 9), (.2, 1.2, 9)]


def down(points, by):
    return [(x, y, z - by) for x, y, z in points]


class Files(unittest.TestCase):
    def setUp(self):
        made = tempfile.TemporaryDirectory()
        self.addCleanup(made.cleanup)
        self.folder = made.name

    def path(self, name):
        return os.path.join(self.folder, name)

    def write(self, name, points, cells):
        meshio.write(self.path(name), meshio.Mesh(
            np.float64(points), [(kind, np.int64(data)) for kind, data in cells]))

    def text(self, name, text):
        with open(self.path(name), "w", encoding="utf-8") as file:
            file.write(text)

    def obj(self, name, points, faces):
        self.text(name, "".join("v %.17g %.17g %.17g\n" % point for point in points)
                  + "".join("f " + " ".join(str(v + 1) for v in face) + "\n"
                            for face in faces))

    def run_it(self, command, *arguments):
        return subprocess.run([*command, "check", *arguments], cwd=self.folder, text=True,
                              stdout=subprocess.PIPE, stderr=subprocess.PIPE, timeout=100,
                              check=False)

    def check(self, status, *arguments):
        done = self.run_it([sys.executable, "-m", "pccd"], "--private", *arguments)
        self.assertEqual(done.returncode, status, done.stdout + done.stderr)
        return done

    def told(self, status, *arguments):
        return json.loads(self.check(status, "--json", *arguments).stdout)

    def direct(self, *arguments):
        done = self.run_it([os.environ["PCCDCTL"]], "--private", "--json", *arguments)
        return done.returncode, json.loads(done.stdout)

    def refused(self, words, *names):
        done = self.check(4, *names)
        self.assertEqual(done.stdout, "")
        self.assertIn(f"pccd: {names[0]}: ", done.stderr)
        self.assertIn(words, done.stderr)

    # If it failed, a file of another kind would have another report, or another status.
    def test_files__of_meshio_have_the_answers_of_pccdctl(self):
        tops = [[0, 1, 2], [3, 4, 5]]
        for name, by in (("a", 0), ("b", 2)):
            points = FLOOR + down(TET[:3], by)
            self.obj(f"{name}.obj", points, tops)
            for ending in ("vtu", "vtk", "xdmf", "msh", "mesh", "off"):
                self.write(f"{name}.{ending}", points, [("triangle", tops)])
        status, due = self.direct("a.obj", "b.obj")
        self.assertEqual((status, due["contacts"]), (1, 1))
        for ending in ("vtu", "vtk", "xdmf", "msh", "mesh", "off"):
            told = self.told(1, f"a.{ending}", f"b.{ending}")
            for key in ("hash", "contacts", "vertices", "triangles", "toi_first"):
                self.assertEqual(told[key], due[key], (ending, key))
            self.assertEqual((told["from"], told["to"]), (f"a.{ending}", f"b.{ending}"))
        self.assertEqual(self.told(1, "a.vtu", "b.obj")["hash"], due["hash"])
        self.assertEqual(self.told(0, "a.vtu", "a.vtk")["contacts"], 0)

    # If it failed, what is inside of a solid would meet, or its surface would have holes.
    def test_solids__give_their_boundary(self):
        solids = [("tetra", [(3, 4, 5, 6), (4, 5, 6, 7)])]
        for name, by in (("a", 0), ("b", 2)):
            self.write(f"{name}.vtu", FLOOR + down(TET, by),
                       [("triangle", [(0, 1, 2)]), *solids])
            self.write(f"{name}.msh", FLOOR + down(TET, by),
                       [("triangle", [(0, 1, 2), (3, 4, 5), (5, 4, 7)]), *solids])
        told = self.told(1, "a.vtu", "b.vtu")
        self.assertEqual((told["triangles"], told["contacts"]), (7, 1))
        self.assertEqual(self.told(1, "a.msh", "b.msh")["triangles"], 7)
        for kind, corners, count in (("hexahedron", range(8), 12),
                                     ("wedge", (0, 1, 2, 4, 5, 6), 8),
                                     ("pyramid", (0, 1, 2, 3, 4), 6)):
            self.write(f"{kind}.vtu", CUBE, [(kind, [list(corners)])])
            told = self.told(0, f"{kind}.vtu", f"{kind}.vtu")
            self.assertEqual((told["triangles"], told["contacts"]), (count, 0), kind)
        # Corners that stand twice: tetrahedra as hexahedra, a triangle as a quad.
        self.write("twice.vtu", TET + FLOOR,
                   [("hexahedron", [(0, 1, 2, 2, 3, 3, 3, 3), (1, 2, 3, 3, 4, 4, 4, 4)]),
                    ("quad", [(5, 6, 7, 7)])])
        self.assertEqual(self.told(0, "twice.vtu", "twice.vtu")["triangles"], 7)

    # If it failed, a fan would put a wall where there is a notch.
    def test_polygons__are_cut_by_the_rule_of_pccdctl(self):
        for name, by in (("a", 0), ("b", 2)):
            points = DART + down(PEG, by)
            self.write(f"{name}.vtu", points, [("quad", [(1, 2, 3, 0)]),
                                               ("triangle", [(4, 5, 6)])])
            self.obj(f"{name}.obj", points, [(1, 2, 3, 0), (4, 5, 6)])
        status, due = self.direct("a.obj", "b.obj")
        told = self.told(status, "a.vtu", "b.vtu")
        self.assertEqual(told["hash"], due["hash"])
        self.assertEqual(told["triangles"], 3)

    # If it failed, what was loaded would be a part of what the file says.
    def test_files__that_meshio_loses_are_refused(self):
        self.write("a.vtu", FLOOR, [("triangle", [(0, 1, 2)])])
        with open(self.path("a.vtu"), encoding="utf-8") as file:
            vtu = file.read()
        begin, end = vtu.index("<Piece"), vtu.index("</Piece>") + 8
        self.text("pieces.vtu", vtu[:end] + vtu[begin:end] + vtu[end:])
        self.refused("2 pieces", "pieces.vtu", "a.vtu")
        head = "# vtk DataFile Version 3.0\nx\nASCII\nDATASET "
        points = "POINTS 4 double\n0 0 0 1 0 0 0 1 0 1 1 0\n"
        self.text("poly.vtk", f"{head}POLYDATA\n{points}POLYGONS 1 4\n3 0 1 2\n")
        self.refused("DATASET POLYDATA", "poly.vtk", "a.vtu")
        self.text("strip.vtk",
                  f"{head}UNSTRUCTURED_GRID\n{points}TRIANGLE_STRIPS 1 5\n4 0 1 2 3\n")
        self.refused("TRIANGLE_STRIPS", "strip.vtk", "a.vtu")
        self.text("quad.off", "OFF\n4 1 0\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n4 0 1 2 3\n")
        self.refused("meshio does not read it", "quad.off", "a.vtu")
        self.write("a.xdmf", FLOOR, [("triangle", [(0, 1, 2)])])
        with open(self.path("a.xdmf"), encoding="utf-8") as file:
            xdmf = file.read()
        self.text("count.xdmf", xdmf.replace('Elements="1"', 'Elements="2"'))
        self.refused("2 cells by the file itself, and meshio gives 1", "count.xdmf")
        self.text("time.xdmf", xdmf.replace("</Grid>", '<Time Value="1"/></Grid>'))
        self.refused("it has a time", "time.xdmf", "a.vtu")
        self.text("big.xdmf", xdmf.replace("<DataItem", '<DataItem Endian="Big"'))
        self.refused("big-endian", "big.xdmf", "a.vtu")
        self.text("base.xdmf", xdmf.replace("<DataItem", '<DataItem BaseOffset="4"'))
        self.refused("BaseOffset", "base.xdmf", "a.vtu")
        part = "*Node\n1, 0,0,0\n2, 1,0,0\n3, 0,1,0\n*Element, type=S3\n1, 1,2,3\n"
        axes = 'VARIABLES = "X", "Y", "Z"\n'
        zone = ("ZONE NODES=3, ELEMENTS=1, DATAPACKING=POINT, ZONETYPE=FETRIANGLE\n"
                "0 0 0\n1 0 0\n0 1 0\n1 2 3\n")
        grid = "GRID,1,{0},0.,0.,0.\nGRID,2,{0},1.,0.,0.\nGRID,3,{0},0.,1.,0.\n"
        deck = "BEGIN BULK\n" + grid + "CTRIA3,1,1,1,2,3\n"
        su2 = ("NDIME= 3\nNELEM= 1\n5 0 1 2 0\nNPOIN= 3\n0 0 0 0\n1 0 0 1\n0 1 0 2\n"
               "NMARK= 0\n")
        for name, words, text in (
                ("parts.inp", "several blocks *NODE", part + part),
                ("axes.inp", "*NODE in other", part.replace("*Node", "*Node, system=C")),
                ("copies.inp", "several *INSTANCE",
                 part + 2 * "*Instance, name=A\n*End Instance\n"),
                ("moved.inp", "an *INSTANCE that is moved",
                 part + "*Instance, name=A\n 9., 0., 0.\n*End Instance\n"),
                ("more.inp", "*ELGEN", part + "*ELGEN\n1, 2, 1, 1\n"),
                ("frame.bdf", "a coordinate system", deck.format(7) + "ENDDATA\n"),
                ("more.bdf", "include", deck.format("") + "include 'a.bdf'\nENDDATA\n"),
                ("zones.dat", "several zones", axes + zone + zone),
                ("zones.su2", "several zones", su2 + su2),
                ("parts.dato", "several blocks $COOR", "$COOR\n1 0 0 0\n$COOR\n"),
                ("a.dato.gz", "several blocks $COOR", "$COOR\n1 0 0 0\n$COOR\n"),
                ("none.ele", "no line says", "# nothing\n")):
            self.text(name, text)
            self.refused(words, name, "a.vtu")
        self.text("one.inp", part + "*Instance, name=A\n*End Instance\n*Node Output\nU\n")
        self.text("one.bdf", deck.format("") + "ENDDATA\n")
        self.text("one.dat", axes + zone)
        self.text("one.su2", su2)
        for name in ("one.inp", "one.bdf", "one.dat", "one.su2"):
            self.assertEqual(self.told(0, name, name)["triangles"], 1, name)
        self.text("a.fbx", "Kaydara FBX Binary  ")
        self.refused("export glTF", "a.fbx", "a.vtu")
        self.write("curved.vtu", TET + [(2, 2, 2)], [("triangle6", [range(6)])])
        self.refused("triangle6", "curved.vtu", "a.vtu")
        self.refused("cannot open: No such file", "none.vtu", "a.vtu")
        self.text("a.unknown", "?")
        self.refused("meshio does not read it", "a.unknown", "a.vtu")

    # If it failed, a report would not say which file it is about, or the order would be
    # another one without a word.
    def test_names__are_those_given(self):
        for number, by in ((1, 0), (2, .5), (10, 2)):
            self.write(f"f{number}.vtu", FLOOR + down(TET[:3], by),
                       [("triangle", [(0, 1, 2), (3, 4, 5)])])
        done = self.check(1, "f1.vtu", "f10.vtu", "f2.vtu", "--contacts", "c.csv")
        self.assertIn("warning: f2.vtu comes after f10.vtu", done.stderr)
        self.assertIn("   1  f10.vtu: 1 (1 vf", done.stdout)
        with open(self.path("c.csv"), encoding="ascii") as file:
            self.assertEqual(len(file.readlines()), 3)
        done = self.check(4, "f%d.vtu")
        self.assertIn("f%d.vtu: number 3 is missing: there are 2 and 10", done.stderr)
        os.rename(self.path("f10.vtu"), self.path("f3.vtu"))
        self.assertEqual([step["to"] for step in self.told(1, "f%d.vtu")["steps"]],
                         ["f2.vtu", "f3.vtu"])
        self.text("all.pvd", '<VTKFile type="Collection"><Collection>' + "".join(
            f'<DataSet timestep="{time}" part="0" file="f{number}.vtu"/>'
            for time, number in ((10, 3), (9, 2), (1, 1))) + "</Collection></VTKFile>")
        self.assertEqual([step["to"] for step in self.told(1, "all.pvd")["steps"]],
                         ["f2.vtu", "f3.vtu"])
        self.assertIn("f1.vtu is one frame", self.check(2, "f1.vtu").stderr)
        odd = 'an "odd" \udcff\x1b name.vtu'
        os.rename(self.path("f1.vtu"), self.path(odd))
        self.assertEqual(self.told(1, odd, "f3.vtu")["from"], odd)
        self.assertIn('step       an "odd" \\xff\\x1b name.vtu -> f3.vtu',
                      self.check(1, odd, "f3.vtu").stdout)
        os.rename(self.path(odd), self.path("\udcff\x1b.fbx"))
        self.assertIn("pccd: \\xff\\x1b.fbx: FBX", self.check(4, "\udcff\x1b.fbx").stderr)

    # If it failed, a script could not tell a mistake from a contact.
    def test_usage__is_told(self):
        for words, status in ((["check", "--nonsense"], 2), ([], 2), (["--help"], 0)):
            done = subprocess.run([sys.executable, "-m", "pccd", *words], check=False,
                                  stdout=subprocess.PIPE, stderr=subprocess.PIPE)
            self.assertEqual(done.returncode, status, words)
        done = subprocess.run([sys.executable, "-m", "pccd", "check", "a", "b"],
                              check=False, stderr=subprocess.PIPE, text=True,
                              env={**os.environ, "PCCD_LIBRARY": "/nowhere"})
        self.assertEqual(done.returncode, 4)
        self.assertIn("pccd: pccd ", done.stderr)
