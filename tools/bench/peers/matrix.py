# SPDX-License-Identifier: GPL-3.0-or-later
"""The same stiffness matrix: MUMPS and multigrid through PETSc, CHOLMOD, equidem."""

import json
import re
import tempfile
from pathlib import Path

from common import Failure, call, median, spread, table, tell

HERE = Path(__file__).resolve().parent
PEERS = {"mumps": "MUMPS, minimum fill", "gamg": "CG + GAMG (PETSc), to 1e-8", "hypre": "CG + BoomerAMG (hypre), to 1e-8"}


def build(folder):
    program = Path(folder, "matrix_petsc")
    flags = call(["pkg-config", "--cflags", "--libs", "petsc"]).split()
    call(["mpicxx", "-std=c++17", "-O3", "-DNDEBUG", HERE / "matrix_petsc.cpp", "-o", program, *flags])
    return program


def compare(bench, quick, rounds):
    with tempfile.TemporaryDirectory() as folder:
        program = build(folder)
        return [measure(program, bench, discs, rounds, folder) for discs in ([10_000] if quick else [10_000, 100_000])]


def measure(program, bench, discs, rounds, folder):
    found = {"discs": discs, "peers": {name: [] for name in PEERS}, "ours": {}}
    matrix = Path(folder, "matrix")
    call([bench, "--write-matrix", matrix, "--kinds", "hexagonal", "--discs", discs])
    for k in range(rounds):
        for name in PEERS:
            text = call([program, matrix, name], seconds=600)
            match = re.search(r"analyze (\S+) factorize (\S+) solve (\S+) residual (\S+) iterations (\d+)", text)
            if not match:
                raise Failure(f"{name} gave no result: {text.strip()[-300:]}")
            found["peers"][name].append([float(word) for word in match.groups()])
        file = Path(folder, f"ours{k}.json")
        solvers = ["equidem", "cholmod-metis", "cholmod-amd"]
        call([bench, "--discs", discs, "--kinds", "hexagonal", "--solvers", ",".join(solvers), "--threads", "1,2", "--repetitions", 1,
              "--json", file], OMP_THREAD_LIMIT="2")
        for run in json.loads(file.read_text())["comparisons"][0]["series"]:
            total = sum(run[stage][0] for stage in ("order", "analyze", "factorize", "solve"))
            one = {"total": total, "residual": run["residual"][0]}
            found["ours"].setdefault(f"{run['solver']}, {run['threads']}", []).append(one)
        tell(f"matrix: {discs} discs, round {k + 1} of {rounds}")
    return found


def report(found):
    return "\n\n".join(table_of(size) for size in found)


def table_of(found):
    rows = []
    base = median([run["total"] for run in found["ours"]["equidem, 1"]])
    for name, runs in found["ours"].items():
        total = [run["total"] for run in runs]
        solver, threads = name.rsplit(", ", 1)
        rows.append([solver, threads, spread(total), f"{runs[0]['residual']:.1e}", f"{median(total) / base:.2f}"])
    for name, runs in found["peers"].items():
        total = [sum(run[:3]) for run in runs]
        note = f" ({runs[0][4]:.0f} iterations)" if runs[0][4] > 0 else ""
        rows.append([PEERS[name] + note, "1", spread(total), f"{runs[0][3]:.1e}", f"{median(total) / base:.2f}"])
    head = ["solver", "threads", "seconds", "relative residual", "over equidem on one thread"]
    return (
        f"## The same matrix: {found['discs']} discs of a hexagonal lattice\n\nThree unknowns a disc, the left side held, a load on the right one, "
        "kT/kN = 0.5. Ordering, analysis, factorization (or set-up) and one solution.\n\n" + table(head, rows)
    )
