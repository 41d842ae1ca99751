# SPDX-License-Identifier: GPL-3.0-or-later
"""The same block of discs: MUMPS and multigrid of PETSc through equidem-mpi, CHOLMOD and equidem, all to the digits of a double."""

import json
import math
import tempfile
from pathlib import Path

from common import call, median, spread, table, tell

CASE = """schema = "equidem/1"
[assembly]
kind = "hexagonal"
columns = {side}
rows = {side}
radius = 0.005
[springs]
kN = 1e9
kT = 0.5e9
[[support]]
group = "left"
ux = 0
uy = 0
rotation = 0
[[load]]
group = "right"
kind = "per_disc"
force = [1.0, -0.25]
"""
GIVEN = "--set", "solver.method=multifrontal"
PEERS = {"MUMPS, minimum fill": [*GIVEN, "-equidem_mat_mumps_icntl_7", "2"], "CG + GAMG (PETSc)": ["-equidem_pc_type", "gamg"],
         "CG + BoomerAMG (hypre)": ["-equidem_pc_type", "hypre"]}
OURS = {"equidem, elimination": [*GIVEN], "equidem, multigrid": ["--set", "solver.method=multigrid"],
        "CHOLMOD, METIS": ["--set", "solver.method=cholmod", "--set", "solver.ordering=metis"],
        "CHOLMOD, AMD": ["--set", "solver.method=cholmod", "--set", "solver.ordering=amd"]}


def compare(equidem, quick, rounds):
    with tempfile.TemporaryDirectory() as folder:
        return [measure(equidem, discs, rounds, Path(folder)) for discs in ([10_000] if quick else [10_000, 100_000])]


def measure(equidem, discs, rounds, folder):
    case = folder / "block.toml"
    case.write_text(CASE.format(side=round(math.sqrt(discs))), encoding="utf-8")
    runs = {(name, threads): [equidem, "solve", case, "--threads", threads, *words] for name, words in OURS.items() for threads in (1, 2)}
    runs |= {(name, 1): [f"{equidem}-mpi", "solve", case, *words] for name, words in PEERS.items()}
    found = {"discs": discs, "solvers": [[*key, []] for key in runs]}
    for k in range(rounds):
        for (command, (_, _, taken)) in zip(runs.values(), found["solvers"]):
            call([*command, "--quiet", "--overwrite", "--json", folder / "result.json"], seconds=600)
            result = json.loads((folder / "result.json").read_text(encoding="utf-8"))
            taken.append({"total": sum(seconds for stage, seconds in result["times"].items() if stage != "assembly"),
                          "residual": result["relative_residual"], "iterations": result.get("iterations") or 0})
        tell(f"matrix: {discs} discs, round {k + 1} of {rounds}")
    return found


def report(found):
    return "\n\n".join(table_of(size) for size in found)


def table_of(found):
    rows = []
    base = median([run["total"] for run in found["solvers"][0][2]])
    for name, threads, runs in found["solvers"]:
        total = [run["total"] for run in runs]
        note = f" ({runs[0]['iterations']} iterations)" if runs[0]["iterations"] > 0 else ""
        rows.append([name + note, str(threads), spread(total), f"{runs[0]['residual']:.1e}", f"{median(total) / base:.2f}"])
    head = ["solver", "threads or ranks", "seconds", "relative residual", "over elimination on one thread"]
    return (
        f"## The same block: {found['discs']} discs of a hexagonal lattice\n\nThree unknowns a disc, the left side held, a load on the right one, "
        "kT/kN = 0.5. All that follows the assembly of discs: checks, matrix, ordering, factorization or set-up, solution, refinement, forces.\n\n"
        + table(head, rows)
    )
