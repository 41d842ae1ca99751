# SPDX-License-Identifier: GPL-3.0-or-later
"""The solvers of PETSc: one answer, iterations, stability."""
import json

import numpy as np

from ranks import CASES, CUT, SERIAL_FILES, checked, motions_of_ranks, motions_of_serial, parallel, serial


def every_solver_of_petsc_finds_the_same_motions(folder):
    case = (CASES / "abe1996_fig6.toml", *CUT)
    for name, options in {"gamg": (), "hypre": ("-equidem_pc_type", "hypre"), "jacobi": ("-equidem_pc_type", "jacobi"),
                          "mumps": ("--set", "solver.method=multifrontal"),
                          "grids": ("-equidem_pc_type", "equidem"), "grids of the case": ("--set", "solver.method=multigrid"),
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
    expected, found = motions_of_serial(folder / "serial", "state"), motions_of_ranks(folder / "negative", "state", 2)
    assert np.linalg.norm(found - expected) <= 1e-10 * np.linalg.norm(expected)


def grids_of_equidem():
    """The cases of blocks and cells that the grids of equidem solve, with the keys that make them larger."""
    yield "lattice", "solve", CASES / "abe1996_fig6.toml", ("--set", "assembly.columns=81", "--set", "assembly.rows=91")
    yield "points", "solve", CASES / "delaunay_tension.toml", ("--set", "assembly.discs=6000")
    yield "strip", "solve", CASES / "abe1996_fig6.toml", ("--set", "assembly.columns=201", "--set", "assembly.rows=11")
    yield "without kT", "solve", CASES / "abe1996_fig6.toml", ("--set", "springs.kT=0", "--set", "assembly.columns=61",
                                                              "--set", "assembly.rows=61")
    yield "few", "solve", CASES / "delaunay_tension.toml", ("--set", "assembly.discs=150")
    yield "cell", "homogenize", CASES / "random_cell.toml", ("--set", "assembly.discs=5000")


def the_grids_of_equidem_take_as_many_iterations_on_every_number_of_ranks(folder):
    """They span the assembly; blocks of ranks on their own would take more iterations with every rank. GAMG, whose
    aggregates end at ranks, is beside it."""
    for name, verb, case, arguments in grids_of_equidem():
        found = {}
        for kind in ("gamg", "equidem"):
            for ranks in (1, 2, 4):
                out = folder / f"{name} {kind} {ranks}"
                checked(parallel(ranks, verb, case, *arguments, "--out", out, "-equidem_pc_type", kind), name)
                found[kind, ranks] = json.loads((out / "result.json").read_text(encoding="utf-8"))["iterations"]
                state = "state" if verb == "solve" else "state_strain_xy"
                motions = motions_of_ranks(out, state, ranks)
                if (kind, ranks) == ("gamg", 1):
                    expected = motions
                difference = np.linalg.norm(motions - expected) / np.linalg.norm(expected)
                assert difference <= 1e-10, (name, kind, ranks, difference)
        print(f"{name}: iterations {found}, motions differ by {difference:.1e}")
        ours = [found["equidem", ranks] for ranks in (1, 2, 4)]
        assert max(ours) - min(ours) <= max(2, 0.1 * min(ours)), (name, ours)
        assert all(found["equidem", ranks] < 0.75 * found["gamg", ranks] for ranks in (1, 2, 4)), (name, found)


def stability_is_that_of_the_serial_program_on_every_number_of_ranks(folder):
    """Negative pivots beyond those of rotations, counted by MUMPS beside our own factorization, on both sides of the limit."""
    cut = ("--set", "assembly.columns=21", "--set", "assembly.rows=23")
    judged = set()
    for verb, case, arguments in (("solve", CASES / "abe1996_fig6.toml", cut),
                                  ("homogenize", CASES / "hexagonal_cell.toml", ("--set", "assembly.columns=12", "--set",
                                                                                "assembly.rows=10")),
                                  ("homogenize", CASES / "random_cell.toml", ("--set", "assembly.discs=300"))):
        for ratio in (-0.1, -0.25, -0.3, -0.4, -0.6):
            numbers = (*arguments, "--set", "springs.kN=1e9", "--set", f"springs.kT={ratio}e9")
            expected = json.loads(checked(serial(verb, case, *numbers, "--json", "-"), case).stdout)
            for ranks in (1, 2, 4):
                out = folder / "result.json"
                checked(parallel(ranks, verb, case, *numbers, "--json", out, "--overwrite"), case)
                found = json.loads(out.read_text(encoding="utf-8"))
                for key in ("status", "unstable_modes", "negative_pivots"):
                    assert found[key] == expected[key], (case.name, ratio, ranks, key, found[key], expected[key])
            judged.add(found["status"])
            print(f"{case.name}, kT/kN = {ratio}: {found['status']}, {found['negative_pivots']} negative pivots, "
                  f"{found['unstable_modes']} unstable modes on 1, 2, 4 ranks and in serial")
    assert judged == {"solved", "unstable"}, judged
    unstable = parallel(2, "solve", CASES / "abe1996_fig6.toml", *cut, "--set", "springs.kT=-0.4e9", "--require-stable")
    assert unstable.returncode == 1, (unstable.returncode, unstable.stderr)
    # No other solver counts, and none is believed.
    for options in (("-equidem_pc_type", "lu", "-equidem_pc_factor_mat_solver_type", "mumps"),
                    ("-equidem_mat_mumps_icntl_13", "0")):
        out = folder / "result.json"
        checked(parallel(2, "solve", CASES / "abe1996_fig6.toml", *cut, "--set", "springs.kT=-0.1e9", "--json", out, "--overwrite",
                         *options), options)
        found = json.loads(out.read_text(encoding="utf-8"))
        assert found["status"] == "unjudged" and found["unstable_modes"] is None, (options, found["status"])
