# SPDX-License-Identifier: GPL-3.0-or-later
"""The solvers of PETSc: one answer."""
import json

import numpy as np

from ranks import CASES, CUT, SERIAL_FILES, checked, motions_of_ranks, motions_of_serial, parallel, serial


def every_solver_of_petsc_finds_the_same_motions(folder):
    case = (CASES / "abe1996_fig6.toml", *CUT)
    for name, options in {"gamg": (), "hypre": ("-equidem_pc_type", "hypre"), "jacobi": ("-equidem_pc_type", "jacobi"),
                          "mumps": ("--set", "solver.method=multifrontal"),
                          "multigrid": ("--set", "solver.method=multigrid"),
                          "lu": ("-equidem_ksp_type", "preonly", "-equidem_pc_type", "lu",
                                 "-equidem_pc_factor_mat_solver_type", "mumps")}.items():
        checked(parallel(2, "solve", *case, "--out", folder / name, *options), name)
        found = motions_of_ranks(folder / name, "state", 2)
        if name == "gamg":
            first = found
        difference = np.linalg.norm(found - first) / np.linalg.norm(first)
        solver = json.loads((folder / name / "result.json").read_text(encoding="utf-8"))["solver"]
        print(f"{solver}: motions differ by {difference:.1e}")
        assert difference <= 1e-10, name
    # kT < 0: the matrix is not definite, and MUMPS is taken.
    negative = (*case, "--set", "springs.kT=-0.05e9", *SERIAL_FILES)
    checked(serial("solve", *negative, "--out", folder / "serial"), "kT < 0")
    result = checked(parallel(2, "solve", *negative, "--out", folder / "negative"), "kT < 0")
    assert "mumps" in result.stdout, result.stdout
    status = json.loads((folder / "negative" / "result.json").read_text(encoding="utf-8"))["status"]
    assert status == "unjudged", status
    expected, found = motions_of_serial(folder / "serial", "state"), motions_of_ranks(folder / "negative", "state", 2)
    assert np.linalg.norm(found - expected) <= 1e-10 * np.linalg.norm(expected)
