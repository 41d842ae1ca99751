# SPDX-License-Identifier: GPL-3.0-or-later
"""Cases of motion in time, and what equidem run writes of them."""
import csv
import math
import unittest
import xml.etree.ElementTree

import numpy

try:
    from vtkmodules.util.numpy_support import vtk_to_numpy
    from vtkmodules.vtkIOXML import vtkXMLPolyDataReader
except ImportError:
    vtkXMLPolyDataReader = None

from program import CASES, NO_PICTURE, ProgramTest

CORNER, PULSE, SHAKE, REST = (CASES / f"run_{name}.toml" for name in ("corner", "pulse", "shake", "tension"))
KN, DENSITY, RADIUS = 1e9, 2650.0, 0.005
MASS = DENSITY * math.pi * RADIUS**2


def table(path):
    """Columns of a CSV file of numbers."""
    with open(path, newline="") as file:
        rows = list(csv.reader(file))
    return dict(zip(rows[0], numpy.array(rows[1:], dtype=float).T))


needs_vtk = unittest.skipIf(vtkXMLPolyDataReader is None, "the Python module of VTK (python3-vtk9) is missing")


def poly_data(path):
    """Arrays of a .vtp file by name, as VTK's own reader finds them; of points, lines and fields."""
    reader = vtkXMLPolyDataReader()
    reader.SetFileName(str(path))
    reader.Update()
    if reader.GetErrorCode():
        raise OSError(f"{path}: error {reader.GetErrorCode()} of VTK's reader")
    data = reader.GetOutput()
    arrays = {group.GetArrayName(k): vtk_to_numpy(group.GetArray(k))
              for group in (data.GetPointData(), data.GetCellData(), data.GetFieldData())
              for k in range(group.GetNumberOfArrays())}
    return {**arrays, "points": vtk_to_numpy(data.GetPoints().GetData())}


def frames_of(out, last=0):
    """(time, step, discs, contacts) of each frame that frames.pvd lists, or of the last ones; contacts is None where they are
    not written."""
    frames = []
    entries = list(xml.etree.ElementTree.parse(out / "frames.pvd").getroot().iter("DataSet"))
    times = sorted({float(entry.get("timestep")) for entry in entries})[-last:]
    for entry in entries:
        if float(entry.get("timestep")) < times[0]:
            continue
        data = poly_data(out / entry.get("file"))
        if entry.get("part") == "0":
            frames.append([float(entry.get("timestep")), int(entry.get("file").split("_")[-1][:-4]), data, None])
        else:
            frames[-1][3] = data
    return frames


def sums_of_forces(contacts, bodies):
    """Sum of the contact forces on each body, from the lines of a frame."""
    sums = numpy.zeros((bodies, 3))
    numpy.add.at(sums, contacts["i"], contacts["force"])
    inside = contacts["j"] >= 0
    numpy.add.at(sums, contacts["j"][inside], -contacts["force"][inside])
    return sums[:, :2]


class RunTest(ProgramTest):
    def run_case(self, case, *options):
        return self.result("run", case, "--threads", 1, *options)

    def bonded_case(self, discs, contacts, text):
        """A case of bonded discs of one size, and a group d0, d1, ... for each."""
        self.write_assembly("assembly.json", discs=[[x, y, RADIUS] for x, y in discs], contacts=contacts)
        groups = "".join(f'[[group]]\nname = "d{k}"\ndiscs = [{k}]\n' for k in range(len(discs)))
        return self.of_file("assembly.json", f"density = {DENSITY}\n{groups}{text}")

    def history(self, case, *options):
        out = self.folder / "history"
        self.run_case(case, "--out", out, "--overwrite", NO_PICTURE, *options)
        return table(out / "history.csv")

    def check_near(self, computed, expected, tolerance):
        """Every entry, relative to the largest."""
        size, error = numpy.abs(expected).max(), numpy.abs(computed - expected).max()
        self.assertGreater(size, 0)
        self.assertLessEqual(error, tolerance * size, f"{error / size:.2e}")

    def go_on_from(self, out, *stages):
        """Each name of a stage, with the checkpoint of its end as that of the run."""
        for name in stages:
            (out / "run.checkpoint.h5").write_bytes((out / f"run.{name}.checkpoint.h5").read_bytes())
            yield name
