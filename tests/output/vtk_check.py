# SPDX-License-Identifier: GPL-3.0-or-later
"""Arguments FOLDER NAME, VTK's reader and the list of faults of read_with_vtk.py and read_frames.py. Ends the program with 77
where the Python module of VTK is missing."""
import os
import sys

try:
    import numpy as np
    from vtkmodules.util.numpy_support import vtk_to_numpy
    from vtkmodules.vtkIOXML import vtkXMLMultiBlockDataReader, vtkXMLPolyDataReader
except ImportError as missing:
    print(f"skipped: {missing}")
    sys.exit(77)

folder, name = sys.argv[1:]
faults = []


def path_of(file_name):
    return os.path.join(folder, file_name)


def compare(what, found, wanted):
    if np.shape(found) != np.shape(wanted) or not np.array_equal(found, wanted):
        faults.append(f"{what}: {found} is not {wanted}")


def poly_data(file_name):
    reader = vtkXMLPolyDataReader()
    reader.SetFileName(path_of(file_name))
    reader.Update()
    if reader.GetErrorCode():
        faults.append(f"{file_name}: error {reader.GetErrorCode()} of the reader")
    return reader.GetOutput()


def end(what):
    """Prints the faults; exit 0: none."""
    for fault in faults:
        print(fault)
    print(f"{what}: {len(faults)} faults")
    sys.exit(1 if faults else 0)
