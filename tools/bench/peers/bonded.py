# SPDX-License-Identifier: GPL-3.0-or-later
"""Abe's tension test of bonded discs: solved by equidem, relaxed by YADE."""

import csv
import json
import tempfile
from pathlib import Path

from common import call, median, number, result_of, spread, table, tell

HERE = Path(__file__).resolve().parent
RADIUS, KN, RATIO = 0.005, 1e6, 0.5
STRESS = 0.1  # Pa: strains of 1e-7, so that YADE's normals hardly turn
DAMPINGS = (0.05, 0.1, 0.2)
PREPARATION = {"files"}  # not part of finding the motions


def case(side):
    return f"""schema = "equidem/1"
[assembly]
kind = "hexagonal"
columns = {side}
rows = {side}
radius = {RADIUS}
[springs]
kN = {KN}
kT = {KN * RATIO}
[test]
kind = "uniaxial_tension"
stress = {STRESS}
"""


def poisson_ratio(discs, motion):
    """-e_yy/(e_xx - e_yy) of the straight lines through the motions of the middle half of the discs."""
    xs, ys = [disc[0] for disc in discs], [disc[1] for disc in discs]
    low_x, high_x = min(xs), max(xs)
    low_y, high_y = min(ys), max(ys)

    def slope(axis):
        chosen = [
            (disc[axis], move[axis])
            for disc, move in zip(discs, motion)
            if abs(disc[0] - (low_x + high_x) / 2) < (high_x - low_x) / 4
            and abs(disc[1] - (low_y + high_y) / 2) < (high_y - low_y) / 4
        ]
        mean = sum(place for place, _ in chosen) / len(chosen)
        return sum((place - mean) * move for place, move in chosen) / sum((place - mean) ** 2 for place, _ in chosen)

    horizontal, vertical = slope(0), slope(1)
    return -vertical / (horizontal - vertical)


def compare(equidem, quick, rounds):
    side = 31 if quick else 101
    longest = 60 if quick else 400
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder, "tension.toml")
        file.write_text(case(side))
        out = Path(folder, "out")
        call([equidem, "solve", file, "--out", out, "--quiet"])
        times, solution = {1: [], 2: []}, {}
        for k in range(rounds + 1):  # the first warms up
            for threads in times:
                text = call([equidem, "solve", file, "--json", "-", "--quiet", "--threads", threads], OMP_THREAD_LIMIT="2")
                solution = json.loads(text)
                seconds = sum(s for stage, s in solution["times"].items() if stage not in PREPARATION)
                if k > 0:
                    times[threads].append(seconds)
        with open(out / "discs.csv") as rows:
            discs = [(float(row["x_m"]), float(row["y_m"]), float(row["ux_m"]), float(row["uy_m"])) for row in csv.DictReader(rows)]
        tell(f"bonded: equidem {spread(times[1])} s on one thread; YADE next")
        best = {}
        trials = []
        for damping in DAMPINGS:
            text = call(
                ["yade", "-n", "-x", "-j1", HERE / "bonded_yade.py", out, KN, RATIO, damping, 0.8, longest], seconds=longest + 600
            )
            trial = {"damping": damping, **result_of(text)}
            trials.append(trial)
            tell(f"bonded: YADE, damping {damping}: {trial['reached']}, error {trial['error']:.1e} after {trial['seconds']:.0f} s")
            for wanted, seconds in trial["reached"].items():
                best[wanted] = min(seconds, best.get(wanted, seconds))
    ratio = poisson_ratio([disc[:2] for disc in discs], [disc[2:] for disc in discs])
    return {
        "discs": len(discs),
        "equidem": times,
        "error_bound": solution["error_bound"],
        "yade": best,
        "trials": trials,
        "poisson_ratio": {"equidem": ratio, "theory": (1 - RATIO) / 4},
    }


def report(found):
    rows = []
    for threads, seconds in found["equidem"].items():
        ratios = [
            number(found["yade"][wanted] / median(seconds)) if wanted in found["yade"] else "-" for wanted in ("1e-3", "1e-6")
        ]
        rows.append([f"equidem, {threads} thread{'s' if threads > 1 else ''}", spread(seconds), f"{found['error_bound']:.0e}", *ratios])
    yade = found["yade"]
    reached = ", ".join(f"{seconds:.3g} to {wanted}" for wanted, seconds in yade.items()) or "not reached"
    rows.append(["YADE, 1 thread, best damping", reached, "1e-3, 1e-6", "1", "1"])
    head = ["who", "seconds", "error of the displacements", "YADE over this, to 1e-3", "to 1e-6"]
    return (
        f"## The same answer: a bonded lattice of {found['discs']} discs in tension\n\n"
        f"kT/kN = {RATIO}. The displacements of all discs; YADE by damped motion with the best of the dampings "
        f"{', '.join(map(str, DAMPINGS))}, its error against the solution. equidem: assembly of the discs, springs, check, ordering, "
        "factorization, solution, refinement and the bound of its error. Poisson's ratio of the middle half is "
        f"{found['poisson_ratio']['equidem']:.6f}, of the infinite lattice {found['poisson_ratio']['theory']:.6f}.\n\n" + table(head, rows)
    )
