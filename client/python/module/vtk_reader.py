"""vtk_reader.py - recordings for VTK and ParaView, with time as a slider.

Room:     client/python. Imports nothing beside it, so that ParaView can load this file
          alone. Needs numpy, VTK 9 and the program pccdctl, which reads recordings: the
          one that $PCCDCTL names, or else the first of beside this module, in the build
          folder that it lies in, in $PATH.
Does:     one time step for each step that was answered, by its number; at each a block of
          contacts and a block for each object.
Threads:  as VTK has it: one.

In ParaView: Tools > Manage Plugins > Load New, this file; then File > Open a .rec. In
Python:

    from pccd.vtk_reader import RecordingReader

    reader = RecordingReader()
    reader.SetFileName("demo.rec")
    reader.UpdateInformation()
    reader.UpdateTimeStep(reader.GetTimestepValues()[-1])
    blocks = reader.GetOutputDataObject(0)  # vtkMultiBlockDataSet

The block "contacts" has a point where each contact is, with its kind (0 VF, 1 EE, 2 VE,
3 VV), toi, normal, flags, object_a, feature_a, object_b, feature_b (pccd_types.h). The
block "object H" has the triangles, rods and points of the object with the handle H, at
the Moment of the step (0 .. 1; 1 at first); motion, radius and vertex are data of its
points, contacts how many each triangle has. Contacts are those of the recording, or, if
that has none, of a daemon that repeats the step.
"""

from __future__ import annotations

import collections
import importlib
import json
import os
import shutil
import subprocess
import tempfile
from typing import Any, Callable, List, Optional, Tuple, TypeVar

import numpy as np

_core = importlib.import_module("vtkmodules.vtkCommonCore")
_model = importlib.import_module("vtkmodules.vtkCommonDataModel")
_pipeline = importlib.import_module("vtkmodules.vtkCommonExecutionModel")
_xml = importlib.import_module("vtkmodules.vtkIOXML")
_numbers = importlib.import_module("vtkmodules.util.numpy_support")
_algorithm: Any = importlib.import_module("vtkmodules.util.vtkAlgorithm")

T = TypeVar("T")
KIND_NONE = 8  # of a cell that is no contact
KEPT = 16  # steps that were read last


class _Decorators:
    """ParaView's; where there is no ParaView, they do nothing."""

    def __getattr__(self, name: str) -> Callable[..., Callable[[T], T]]:
        return lambda *_, **__: lambda decorated: decorated


smproxy = smproperty = smdomain = _Decorators()
try:
    _paraview = importlib.import_module("paraview.util.vtkAlgorithm")
    smproxy, smproperty = _paraview.smproxy, _paraview.smproperty
    smdomain = _paraview.smdomain
except ImportError:
    pass


def pccdctl() -> str:
    """The program; RuntimeError."""
    chosen = os.environ.get("PCCDCTL")
    if chosen:
        return chosen
    here = os.path.dirname(os.path.abspath(__file__))
    for folder in (here, os.path.dirname(os.path.dirname(here))):
        path = os.path.join(folder, "pccdctl")
        if os.access(path, os.X_OK) and os.path.isfile(path):
            return path
    found = shutil.which("pccdctl")
    if found is None:
        raise RuntimeError("no program pccdctl in $PATH (Debian's package pccd has it): "
                           "PCCDCTL names its file")
    return found


def run(*arguments: str) -> str:
    """What it prints; RuntimeError with what it complains of."""
    try:
        done = subprocess.run([pccdctl(), *arguments], stdin=subprocess.DEVNULL,
                              capture_output=True, text=True, errors="replace",
                              check=False)
    except OSError as problem:
        raise RuntimeError(str(problem)) from None
    if done.returncode != 0:
        raise RuntimeError(done.stderr.strip() or f"pccdctl ended with {done.returncode}")
    return done.stdout


def _array(data: Any, name: str) -> Any:
    return _numbers.vtk_to_numpy(data.GetArray(name))


def _put(data: Any, name: str, values: Any) -> None:
    made = _numbers.numpy_to_vtk(np.ascontiguousarray(values), deep=True)
    made.SetName(name)
    data.AddArray(made)


def _cells(corners: Any) -> Any:
    """Cells of so many corners each, (m, k)."""
    made, (count, each) = _model.vtkCellArray(), corners.shape
    offsets = each * np.arange(count + 1, dtype=np.int64)
    flat = np.ascontiguousarray(corners, np.int64).reshape(-1)
    made.SetData(_numbers.numpy_to_vtkIdTypeArray(offsets, deep=True),
                 _numbers.numpy_to_vtkIdTypeArray(flat, deep=True))
    return made


def _poly_data(x: Any) -> Any:
    made, points = _model.vtkPolyData(), _core.vtkPoints()
    points.SetData(_numbers.numpy_to_vtk(np.ascontiguousarray(x), deep=True))
    made.SetPoints(points)
    return made


class _Step:
    """A file of pccdctl export, as arrays: points (n, 3), whose they are, and cells of
    one, two and three corners, in the order of the data of cells."""

    def __init__(self, path: str) -> None:
        reader = _xml.vtkXMLPolyDataReader()
        reader.SetFileName(path)
        reader.Update()
        self.data = data = reader.GetOutput()
        self.x = _numbers.vtk_to_numpy(data.GetPoints().GetData())
        self.owner = _array(data.GetPointData(), "object")
        self.corners = [
            _numbers.vtk_to_numpy(cells.GetConnectivityArray()).reshape(-1, each)
            for each, cells in enumerate((data.GetVerts(), data.GetLines(),
                                          data.GetPolys()), 1)]
        self.is_contact = _array(data.GetCellData(), "kind") != KIND_NONE

    def _names(self, data: Any) -> List[str]:
        return [data.GetArrayName(i) for i in range(data.GetNumberOfArrays())]

    def contacts(self) -> Any:
        """A point for each."""
        cells = np.flatnonzero(self.is_contact)
        made = _poly_data(self.x[self.corners[0][cells, 0]])
        made.SetVerts(_cells(np.arange(len(cells)).reshape(-1, 1)))
        data = self.data.GetCellData()
        for name in self._names(data):
            if name != "contacts":
                _put(made.GetPointData(), name, _array(data, name)[cells])
        made.GetPointData().SetActiveScalars("toi")
        return made

    def object(self, handle: int) -> Any:
        """Its points lie one after the other."""
        mine = np.flatnonzero(self.owner == handle)
        made = _poly_data(self.x[mine])
        kept, first = [], 0
        for corners, put in zip(self.corners,
                                (made.SetVerts, made.SetLines, made.SetPolys)):
            is_mine = ~self.is_contact[first:first + len(corners)]
            is_mine &= self.owner[corners[:, 0]] == handle
            put(_cells(corners[is_mine] - mine[0]))
            kept.append(first + np.flatnonzero(is_mine))
            first += len(corners)
        data = self.data.GetPointData()
        for name in self._names(data):
            if name != "object":
                _put(made.GetPointData(), name, _array(data, name)[mine])
        _put(made.GetPointData(), "vertex", np.arange(len(mine), dtype=np.uint32))
        _put(made.GetCellData(), "contacts",
             _array(self.data.GetCellData(), "contacts")[np.concatenate(kept)])
        return made

    def blocks(self) -> List[Tuple[str, Any]]:
        made = [("contacts", self.contacts())]
        for handle in np.unique(self.owner[self.owner > 0]).tolist():
            made.append((f"object {handle}", self.object(handle)))
        return made


@smproxy.reader(name="pccdRecordingReader", label="Recording of pccd", extensions="rec",
                file_description="Recordings of pccd")
class RecordingReader(_algorithm.VTKPythonAlgorithmBase):  # type: ignore[misc]
    """The reader; the head of this file says what it gives."""

    def __init__(self) -> None:
        super().__init__(nInputPorts=0, nOutputPorts=1,
                         outputType="vtkMultiBlockDataSet")
        self._path: Optional[str] = None
        self._moment = 1.0
        self._steps: Optional[List[int]] = None
        self._kept: collections.OrderedDict[int, Any] = collections.OrderedDict()

    # Of a function with types not every ParaView can count the arguments.
    @smproperty.stringvector(name="FileName", number_of_elements=1)
    @smdomain.filelist()
    def SetFileName(self, path: Optional[str]) -> None:
        """The recording."""
        if path != self._path:
            self._path, self._steps = path, None
            self._kept.clear()
            self.Modified()

    @smproperty.doublevector(name="Moment", number_of_elements=1, default_values=[1.0])
    @smdomain.doublerange(min=0.0, max=1.0)
    def SetMoment(self, moment: float) -> None:
        """Show objects at this part of each step: 0 its begin, 1 its end."""
        if not 0 <= moment <= 1:
            raise ValueError(f"the moment {moment}: from 0 to 1")
        if moment != self._moment:
            self._moment = moment
            self._kept.clear()
            self.Modified()

    @smproperty.doublevector(name="TimestepValues", number_of_elements=0,
                             information_only="1", si_class="vtkSITimeStepsProperty")
    def GetTimestepValues(self) -> List[float]:
        """The numbers of the steps that were answered."""
        if self._steps is None and self._path:
            listed = json.loads(run("export", "--list", "--json", "--", self._path))
            self._steps = [one["step"] for one in listed]
        return [float(step) for step in self._steps or []]

    def _read(self, step: int) -> Any:
        """The blocks of a step; those read last are kept."""
        if step not in self._kept:
            assert self._path is not None
            with tempfile.TemporaryDirectory() as folder:
                path = os.path.join(folder, "step.vtp")
                run("export", "-o", path, "--steps", str(step), "--time",
                    repr(self._moment), "--", self._path)
                self._kept[step] = _Step(path).blocks()
            while len(self._kept) > KEPT:
                self._kept.popitem(last=False)
        self._kept.move_to_end(step)
        return self._kept[step]

    def _told(self, work: Callable[[], None]) -> int:
        """What is wrong, as VTK tells it."""
        try:
            work()
            return 1
        except RuntimeError as problem:
            _core.vtkOutputWindow.GetInstance().DisplayErrorText(
                f"{type(self).__name__}: {problem}\n")
            return 0

    def RequestInformation(self, request: Any, inInfo: Any, outInfo: Any) -> int:
        def work() -> None:
            times = self.GetTimestepValues()
            key, info = _pipeline.vtkStreamingDemandDrivenPipeline, \
                outInfo.GetInformationObject(0)
            info.Remove(key.TIME_STEPS())
            info.Remove(key.TIME_RANGE())
            if times:
                info.Set(key.TIME_STEPS(), times, len(times))
                info.Set(key.TIME_RANGE(), [times[0], times[-1]], 2)

        return self._told(work)

    def RequestData(self, request: Any, inInfo: Any, outInfo: Any) -> int:
        def work() -> None:
            times = self.GetTimestepValues()
            output = _model.vtkMultiBlockDataSet.GetData(outInfo, 0)
            if not times:
                return
            key = _pipeline.vtkStreamingDemandDrivenPipeline.UPDATE_TIME_STEP()
            info = outInfo.GetInformationObject(0)
            wanted = info.Get(key) if info.Has(key) else times[0]
            step = max((time for time in times if time <= wanted), default=times[0])
            blocks = self._read(int(step))
            output.SetNumberOfBlocks(len(blocks))
            for k, (name, block) in enumerate(blocks):
                output.SetBlock(k, block)
                output.GetMetaData(k).Set(_model.vtkCompositeDataSet.NAME(), name)
            output.GetInformation().Set(_model.vtkDataObject.DATA_TIME_STEP(), step)

        return self._told(work)
