"""check_vtk.py - recordings as VTK sees them.

Room:     tests/python.
Does:     record a session of its own, read it by vtk_reader.py, compare with what the
          client was answered.
"""

import os
import tempfile
import unittest

import numpy as np
import pccd
from pccd.vtk_reader import RecordingReader
from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkCommonCore import vtkOutputWindow, vtkStringOutputWindow
from vtkmodules.vtkCommonExecutionModel import vtkStreamingDemandDrivenPipeline

FLOOR = np.float64([(9, 9, 9), (0, 0, 0), (4, 0, 0), (0, 4, 0)])  # one is of no face
DROP = np.float64([(.5, .5, 1), (1.5, .5, 2), (.5, 1.5, 2), (.7, .7, 3)])
FALLS = (0, -.5, -.8, -1.2)


def arrays(data):
    return {data.GetArrayName(i): vtk_to_numpy(data.GetArray(i))
            for i in range(data.GetNumberOfArrays())}


def polys(block):
    return vtk_to_numpy(block.GetPolys().GetConnectivityArray()).reshape(-1, 3)


class Vtk(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory()
        cls.paths = [os.path.join(cls.folder.name, name + ".rec")
                     for name in ("with", "without")]
        for path in cls.paths:
            cls.record(path, path == cls.paths[0])

    @classmethod
    def record(cls, path, contacts):
        """Steps 1 to 4; what they were answered, in cls.answers."""
        with pccd.connect("direct:") as client:
            client.record_start(path, contacts=contacts)
            scene = client.scene_create()
            cls.floor = client.scene_add(scene, client.mesh_create(FLOOR, [(1, 2, 3)]))
            cls.drop = client.scene_add(scene, client.mesh_create(
                DROP, [(0, 1, 2)], edges=[(2, 3)], radii=np.full(4, 0.125)))
            cls.x, cls.answers = [DROP], []
            for fall in FALLS:
                cls.x.append(cls.x[-1] + (0, 0, fall))
                with client.step_x1(scene, cls.drop, cls.x[-1]) as answer:
                    cls.answers.append(answer.contacts.copy())

    @classmethod
    def tearDownClass(cls):
        cls.folder.cleanup()

    def setUp(self):
        self.told = vtkStringOutputWindow()
        vtkOutputWindow.SetInstance(self.told)

    def tearDown(self):
        vtkOutputWindow.SetInstance(None)

    def reader(self, path):
        made = RecordingReader()
        made.SetFileName(path)
        made.UpdateInformation()
        return made

    def blocks(self, reader, step):
        reader.UpdateTimeStep(step)
        output = reader.GetOutputDataObject(0)
        self.assertEqual(output.GetInformation().Get(output.DATA_TIME_STEP()), step)
        return {output.GetMetaData(k).Get(output.NAME()): output.GetBlock(k)
                for k in range(output.GetNumberOfBlocks())}

    # If it failed, ParaView would have no slider, or one without the steps.
    def test_time__is_the_number_of_the_step(self):
        reader = self.reader(self.paths[0])
        self.assertEqual(reader.GetTimestepValues(), [1, 2, 3, 4])
        info = reader.GetOutputInformation(0)
        key = vtkStreamingDemandDrivenPipeline
        self.assertEqual(info.Get(key.TIME_STEPS()), (1, 2, 3, 4))
        self.assertEqual(info.Get(key.TIME_RANGE()), (1, 4))
        for between, step in ((0, 1), (2.9, 2), (9, 4)):
            reader.UpdateTimeStep(between)
            output = reader.GetOutputDataObject(0)
            self.assertEqual(output.GetInformation().Get(output.DATA_TIME_STEP()), step)

    # If it failed, objects would be shown somewhere else, or with others' vertices.
    def test_objects__are_where_the_step_has_left_them(self):
        reader = self.reader(self.paths[0])
        for step in (1, 3, 4, 2):
            blocks = self.blocks(reader, step)
            floor, drop = (blocks[f"object {handle}"] for handle in (self.floor,
                                                                     self.drop))
            self.assertEqual(set(blocks), {"contacts", f"object {self.floor}",
                                           f"object {self.drop}"})
            for block, x in ((floor, FLOOR), (drop, self.x[step])):
                np.testing.assert_allclose(vtk_to_numpy(block.GetPoints().GetData()), x,
                                           atol=1e-6)
            self.assertEqual(polys(floor).tolist(), [[1, 2, 3]])
            self.assertEqual(polys(drop).tolist(), [[0, 1, 2]])
            rod = vtk_to_numpy(drop.GetLines().GetConnectivityArray())
            self.assertEqual(rod.tolist(), [2, 3])
            data = arrays(drop.GetPointData())
            self.assertEqual(data["vertex"].tolist(), [0, 1, 2, 3])
            self.assertEqual(data["radius"].tolist(), [0.125] * 4)
            np.testing.assert_allclose(data["motion"],
                                       [(0, 0, FALLS[step - 1])] * 4, atol=1e-6)
            self.assertEqual(drop.GetNumberOfCells(),
                             len(arrays(drop.GetCellData())["contacts"]))

    # If it failed, objects could only be seen where a step ends.
    def test_moment__is_within_the_step(self):
        reader = self.reader(self.paths[0])
        name = f"object {self.drop}"
        for moment in (0, 0.5, 1):
            reader.SetMoment(moment)
            x = vtk_to_numpy(self.blocks(reader, 3)[name].GetPoints().GetData())
            np.testing.assert_allclose(x, self.x[2] + moment * (self.x[3] - self.x[2]),
                                       atol=1e-6)
        with self.assertRaises(ValueError):
            reader.SetMoment(1.5)

    # If it failed, contacts would be others than the program was told of, or miss where
    # a recording has only their number.
    def test_contacts__are_those_of_the_answer(self):
        self.assertGreater(sum(map(len, self.answers)), 2)
        for path in self.paths:
            reader = self.reader(path)
            for step, answer in enumerate(self.answers, 1):
                block = self.blocks(reader, step)["contacts"]
                data = arrays(block.GetPointData())
                self.assertEqual(block.GetNumberOfPoints(), len(answer))
                self.assertEqual(block.GetNumberOfVerts(), len(answer))
                for name in ("kind", "flags", "object_a", "feature_a", "object_b",
                             "feature_b"):
                    self.assertEqual(data[name].tolist(), answer[name].tolist(), name)
                np.testing.assert_allclose(data["toi"], answer["toi"], atol=1e-6)
                np.testing.assert_allclose(data["normal"].reshape(-1, 3),
                                           answer["normal"], atol=1e-6)
                x = vtk_to_numpy(block.GetPoints().GetData())
                on_floor = x[data["object_b"] == self.floor]
                np.testing.assert_allclose(on_floor[:, 2], 0, atol=1e-6)

    # If it failed, a wrong file would look like an empty recording.
    def test_failures__are_told_in_words(self):
        wrong = os.path.join(self.folder.name, "wrong.rec")
        with open(wrong, "w", encoding="ascii") as file:
            file.write("no recording of anything")
        for path, words in ((wrong, "not a recording"), (wrong + "s", "No such file")):
            reader = RecordingReader()
            reader.SetFileName(path)
            reader.Update()
            self.assertIn(words, self.told.GetOutput())
            self.assertEqual(reader.GetOutputDataObject(0).GetNumberOfBlocks(), 0)
        before = os.environ["PCCDCTL"]
        os.environ["PCCDCTL"] = "/nowhere/pccdctl"
        try:
            RecordingReader.Update(self.reader(self.paths[0]))
            self.assertIn("/nowhere/pccdctl", self.told.GetOutput())
        finally:
            os.environ["PCCDCTL"] = before


if __name__ == "__main__":
    unittest.main()
