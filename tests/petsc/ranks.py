# SPDX-License-Identifier: GPL-3.0-or-later
"""The two programs and what they write."""
import json
import os
import pathlib
import re
import subprocess
import sys

import numpy as np
import vtk
from vtk.util.numpy_support import vtk_to_numpy

PROGRAM, PARALLEL, MPIRUN, SOURCE = sys.argv[1:5]
CASES = pathlib.Path(SOURCE, "data", "cases")
SERIAL_FILES = "output.files=['vtk']"
LIMIT = 600  # s: ends a command that hangs, also on a busy machine
TENSION = CASES / "abe1996_fig6.toml"
CUT = (TENSION, "assembly.columns=41", "assembly.rows=23")


def words_of(arguments):
    """A word key=value is given by --set."""
    return [word for argument in map(str, arguments)
            for word in (("--set", argument) if re.match(r"[a-z]\w*(\.\w+)*=", argument) else (argument,))]


def result_in(folder):
    return json.loads((folder / "result.json").read_text(encoding="utf-8"))


def command(ranks, *arguments):
    environment = dict(os.environ, OMP_NUM_THREADS="1", OPENBLAS_NUM_THREADS="1",
                       OMPI_ALLOW_RUN_AS_ROOT="1", OMPI_ALLOW_RUN_AS_ROOT_CONFIRM="1",
                       OMPI_MCA_rmaps_base_oversubscribe="1",  # Open MPI 4; the next one is for 5
                       PRTE_MCA_rmaps_default_mapping_policy=":oversubscribe",
                       # Ranks of one machine share memory: looking for networks takes half of the start.
                       OMPI_MCA_pml="ob1", OMPI_MCA_btl="self,vader")
    return [MPIRUN, "-n", str(ranks), PARALLEL, *words_of(arguments)], environment


def parallel(ranks, *arguments):
    """Runs to its end. All ranks end by themselves: what is left a moment after the first has failed may be killed at once, not
    a second later as by default."""
    words, environment = command(ranks, *arguments)
    environment.update(OMPI_MCA_odls_base_sigkill_timeout="0", PRTE_MCA_odls_base_sigkill_timeout="0")
    return subprocess.run(words, env=environment, capture_output=True, text=True, timeout=LIMIT, check=False)


def serial(*arguments):
    return subprocess.run([PROGRAM, *words_of(arguments)], capture_output=True, text=True, timeout=LIMIT, check=False)


def checked(result, what):
    assert result.returncode == 0, f"{what}: exit code {result.returncode}\n{result.stdout}\n{result.stderr}"
    return result


def read(path):
    reader = vtk.vtkXMLPolyDataReader()
    reader.SetFileName(str(path))
    reader.Update()
    return reader.GetOutput()


def arrays(data, *names):
    return [vtk_to_numpy(data.GetPointData().GetArray(name)) for name in names]


def motions_of_serial(folder, name):
    data = read(folder / f"{name}_discs.vtp")
    displacements, rotations, radii = arrays(data, "displacement", "rotation", "radius")
    return np.column_stack([displacements[:, :2], radii * rotations])


def motions_of_ranks(folder, name, ranks):
    """In the order of the serial program, from the numbers of the discs."""
    numbers, motions = [], []
    for rank in range(ranks):
        data = read(folder / f"{name}_discs_{rank}.vtp")
        number, displacements, rotations, radii = arrays(data, "number", "displacement", "rotation", "radius")
        numbers.append(number)
        motions.append(np.column_stack([displacements[:, :2], radii * rotations]))
    numbers, motions = np.concatenate(numbers), np.concatenate(motions)
    assert sorted(numbers) == list(range(len(numbers))), "each disc belongs to one rank"
    return motions[np.argsort(numbers)]
