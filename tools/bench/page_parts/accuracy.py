# SPDX-License-Identifier: GPL-3.0-or-later
"""What accuracy costs: tables and figures of data/accuracy, which the page data/accuracy.md shows."""
import csv
import json
import math
import os
import re
import statistics
import time

from common import Failure, seconds, stamp
from tables import rows_of, write_rows

# Kinds of work: their study files, the task in the table, the axis of the figure.
KINDS = {
    "integrators": (["integrators"], "vibration of a bonded disc", "relative error of the energy"),
    "impact": (["impact", "impact_long_steps"], "three impacts of a ball", "relative error of the energy"),
    "abe_lattice": (["abe_lattice"], "ν from a block in tension", "error of ν"),
    "random_cells": (["random_cells"], "G of random networks, standard error", "standard error of G/kN"),
}
NAMES = {"[50]": "cells of 50 discs", "[400]": "cells of 400", "centre": "gauge at the centre", "quarter": "gauge at a quarter"}
STATICS = "displacements of {discs} discs"
ASKED = ("1e-2", "1e-3", "1e-4", "1e-8")
BLOCK = "solve data/studies/block.toml"
ROWS = {317: "", 1001: " --set assembly.rows=1001 --set assembly.columns=1001"}  # options of a block of as many rows
# Method and options of each way to solve the block, multigrid being the automatic one; of a million discs that one alone.
ITERATIONS = [("multigrid", f"--accuracy {accuracy}") for accuracy in ("1e-2", "1e-4", "1e-6", "1e-8")] + [("multigrid", "")]
ELIMINATION = [(method, f"--set solver.method={method} --set solver.max_refinements={steps}")
               for method in ("multifrontal", "cholmod", "umfpack") for steps in (0, 4)]
# Commands with --accuracy: what is computed, command.
VERBS = [
    ("K, G and ν of random cells", "homogenize data/cases/random_cell.toml --accuracy 1e-2"),
    ("ν from a block in tension", "solve data/cases/abe1996_fig6.toml --accuracy 1e-3"),
    ("motion of bonded discs", "run data/cases/run_pulse.toml --accuracy 1e-2"),
]
POINTS = ["kind", "way", "setting", "seconds", "error", "commit"]
WAYS = ["task", "accuracy", "time", "error", "cheapest way", "command"]


def label(row):
    values = ", ".join(f"{key.rpartition('.')[2]} = {value:.6g}" for key, value in row["setting"].items())
    method, _, more = row["method"].partition(", ")
    return ", ".join(part for part in (NAMES.get(method, method), re.sub(r"^(\w+\.)+", "", more), values) if part)


def error_of(row, kind="assured_errors"):
    """The largest of the errors of a row; none where it has none."""
    errors = [error for error in row[kind].values() if error is not None]
    return max(errors) if errors else None


def timed_rows(result):
    return [row for row in result["settings"] if "refusal" not in row and row["seconds"]["repetitions"]]


def cheapest(rows):
    """Of rows (label, error that is assured, seconds, ...) the cheapest for each accuracy; one that serves for several, once. Of
    times that two digits do not distinguish the last counts, the finest level."""
    chosen = {}
    for asked in ASKED:
        sufficient = [row for row in rows if row[1] is not None and row[1] <= float(asked)]
        if sufficient:
            chosen[min(reversed(sufficient), key=lambda row: float(f"{row[2]:.2g}"))] = asked
    return [(asked, row) for row, asked in chosen.items()]


def of_studies(run, kind):
    """Points and cheapest ways of the studies of a kind; a study of one method shows what it varies as another curve."""
    names, task, _ = KINDS[kind]
    points, rows = [], []
    for name in names:
        for row in timed_rows(run.study(name)):
            error, taken = error_of(row, "errors"), row["seconds"]["processor_median"]
            if error is None:
                continue
            method = row["method"].partition(",")[0] or "measured"
            way = NAMES.get(method, method) + (", long steps" if name.endswith("long_steps") else "")
            points.append([kind, way, label(row), f"{taken:.4g}", f"{error:.3g}", stamp()["commit"]])
            rows.append((label(row), error_of(row), taken, error, name))
    return points, [[task, asked, seconds(taken), f"{error:.1e}", way, f"`equidem study data/studies/{name}.toml --accuracy {asked}`"]
                    for asked, (way, _, taken, error, name) in cheapest(rows)]


def motions(run, command):
    """Displacements of all discs, and the seconds of the solution that the report states."""
    folder = run.folder / "block"
    run.call([run.program, *command.split(), "--quiet", "--threads", "1", "--out", folder, "--overwrite"])
    with open(folder / "discs.csv", newline="", encoding="utf-8") as file:
        found = [float(row[axis]) for row in csv.DictReader(file) for axis in ("ux_m", "uy_m")]
    times = json.loads((folder / "result.json").read_text(encoding="utf-8"))["times"]
    return found, sum(taken for stage, taken in times.items() if stage not in ("assembly", "files"))


def statics(run):
    """Points and ways of the block, beside the motions by elimination with ten steps of refinement."""
    points, ways = [], []
    for rows, size_of in ROWS.items():
        truth, _ = motions(run, f"{BLOCK}{size_of} --set solver.method=multifrontal --set solver.max_refinements=10")
        size, found = math.hypot(*truth), []
        for method, options in ITERATIONS + ELIMINATION * (rows < 1000):
            command = f"{BLOCK}{size_of} {options}".strip()
            taken, error = [], 0.0
            for _ in range(run.options.rounds):
                moved, one = motions(run, command)
                taken.append(one)
                error = math.hypot(*(a - b for a, b in zip(moved, truth))) / size
            way = ", ".join([method, *re.findall(r"[\w]+[ =][\w.-]+$", options)])
            found.append((way, error, statistics.median(taken), command))
            points.append([f"solvers_{rows}", method, way, f"{found[-1][2]:.4g}", f"{error:.3g}", stamp()["commit"]])
        discs = f"{len(truth) // 2:,}".replace(",", " ")
        ways += [[STATICS.format(discs=discs), asked, seconds(taken), f"{error:.1e}", way, f"`equidem {command}`"]
                 for asked, (way, error, taken, command) in cheapest(found[::-1])]
    return points, ways


def timed(run, command):
    """JSON of a command, and its median time with all that it does."""
    target = run.folder / "verb.json"
    times = []
    for _ in range(3):
        begin = time.monotonic()
        run.call([run.program, *command.split(), "--quiet", "--threads", "1", "--json", target, "--overwrite"])
        times.append(time.monotonic() - begin)
    return json.loads(target.read_text(encoding="utf-8")), seconds(statistics.median(times))


def verb_rows(run):
    """A lattice has a cell without sides, exact to round-off; the others choose their setting themselves."""
    command = "homogenize data/cases/hexagonal_cell.toml"
    result, taken = timed(run, command)
    bound = result["error_bound"] / max(max(map(abs, row)) for row in result["stiffness"])
    rows = [["K, G and ν of a lattice", "round-off", taken, f"{bound:.1e}", f"a periodic cell of {result['discs']} discs", f"`equidem {command}`"]]
    for task, command in VERBS:
        result, taken = timed(run, command)
        reached = result["accuracy"]
        way = ", ".join(f"{key.rpartition('.')[2]} = {value:.6g}" for key, value in reached["value"].items())
        rows.append([task, command.split()[-1], taken, f"{reached['estimated']:.1e}", way, f"`equidem {command}`"])
    return rows


def requests(run):
    """Rates of kept requests, where the build has the tests that make them; else the stored ones stay."""
    tests = run.program.parents[1] / "tests"
    if not all((tests / program).exists() for program in ("test_study", "test_homogenize")):
        if not (run.data / "accuracy" / "requests.csv").exists():
            raise Failure(f"neither '{tests}' has the tests that make requests, nor are their rates stored")
        return
    target = run.folder / "requests"
    for program in ("test_study", "test_homogenize"):
        run.call([tests / program, "accuracy_asked*,what_is_recommended*"], env={**os.environ, "EQUIDEM_REQUESTS": str(target)})

    def share(row, key):
        return f"{100 * row[key] / row['requests']:.1f} %" if key in row else ""

    got = [json.loads(line) for line in target.read_text(encoding="utf-8").splitlines()]
    write_rows(run.data / "accuracy" / "requests.csv", ["request", "number", "within what was asked", "within what was estimated", "cheap"],
               [[row["task"], str(row["requests"]), share(row, "kept"), share(row, "honest"), share(row, "cheap")] for row in got])


def draw(folder):
    """A figure for each kind of points.csv."""
    import figures

    kinds = {}
    for row in rows_of(folder / "points.csv"):
        kinds.setdefault(row["kind"], {}).setdefault(row["way"], []).append((float(row["seconds"]), float(row["error"])))
    for kind in (*KINDS, "solvers_317"):
        series = kinds[kind]
        axis = KINDS[kind][2] if kind in KINDS else "relative error of the displacements"
        figures.curves(folder / kind, series, "time, s", axis, floor=1e-16, above=kind.startswith("solvers"))


def make(run):
    folder = run.data / "accuracy"
    points, ways = [], []
    for found in [*(of_studies(run, kind) for kind in KINDS), statics(run)]:
        points += found[0]
        ways += found[1]
    write_rows(folder / "points.csv", POINTS, points)
    write_rows(folder / "ways.csv", WAYS, [*ways, *verb_rows(run)])
    found = stamp(run.study("integrators"))
    write_rows(folder / "measured.csv", list(found), [list(found.values())])
    requests(run)
    draw(folder)
