#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""tools/bench/static.py --build FOLDER [--discs N,...] [--solvers NAME,...] [--threads N,...] [--json FILE] [--markdown FILE]

Static solves side by side with CHOLMOD. Every run is a fresh process of bench_static with peak memory and thread settings of its
own; solvers take turns."""
import argparse
import json
import math
import os
import statistics
import subprocess
import sys
from pathlib import Path

SOLVERS = {"equidem": "equidem multifrontal", "equidem-multigrid": "equidem multigrid", "cholmod-metis": "CHOLMOD, METIS on the unknowns",
           "cholmod-amd": "CHOLMOD, AMD on the unknowns", "cholmod-equidem": "CHOLMOD, order of equidem"}
STAGES = ("order", "analyze", "factorize", "solve")
TEXT = """
kT/kN = 0.5, 3 unknowns per disc, left side fixed, load on the right side. Seconds, medians (smallest .. largest); total = order + analyze
+ factorize + solve, one right-hand side, no refinement. Multigrid: factorize is the set-up of the grids, solve ends at a residual of the
contact law of 1e-12; K is assembled afterwards, for the residual of the table alone. The residual of the table is computed by equidem for
all. K: assembly of the stiffness matrix, not in the total. nnz(L): lower triangle, without explicit zeros, ours
where CHOLMOD counts them in our order. Factor: stored of L;
stored/nnz(L) counts 8 bytes an entry. Peak: of the whole process, the assembly and K included. CPU: seconds of all threads since the start
of the process, the set-up of the problem included; it depends least on other load of the machine. Threads are those of equidem: CHOLMOD
runs on one, supernodal, with 32-bit indices.
"""


def measured(program, *words):
    """What one solver needs. Memory that the system hands out for the first time is slow: another process touches it before."""
    discs = float(words[2])
    free = os.sysconf("SC_AVPHYS_PAGES") * os.sysconf("SC_PAGESIZE")
    subprocess.run([sys.executable, "-c", f"b'1' * {int(min(2e8 + 8e3 * discs, 0.5 * free))}"], check=True)
    settings = {**os.environ, "OPENBLAS_NUM_THREADS": "1", "OMP_NUM_THREADS": "1"}
    done = subprocess.run([program, *map(str, words)], env=settings, capture_output=True, text=True, check=False)
    if done.returncode != 0:
        sys.exit(f"bench_static {' '.join(map(str, words))}: {done.stderr.strip()}")
    run = json.loads(done.stdout)
    run["total"] = sum(run[stage] for stage in STAGES)
    return run


def compared(program, request, kind, discs):
    """The runs of each (solver, threads): every solver runs once in every round, so that a disturbance affects all of them."""
    series = {(solver, threads): [] for solver in request.solvers for threads in request.threads}
    rounds = request.repetitions or (9 if discs < 3e4 else 5 if discs < 3e5 else 3)
    for count in range(rounds):
        for (solver, threads), runs in series.items():
            print(f"{kind}, {discs:.0f} discs, round {count + 1} of {rounds}: {solver}, {threads} threads", file=sys.stderr)
            runs.append(measured(program, solver, kind, discs, threads))
    for (solver, threads), runs in series.items():
        alike = series.get(("cholmod-equidem", threads), [])
        for k, run in enumerate(runs):  # the fronts of equidem hold zeros, which CHOLMOD in the same order does not
            if solver == "equidem":
                run["nonzeros"] = alike[k]["nonzeros"] if alike else 0
    return series


def spread(values):
    return f"{statistics.median(values):.3g} ({min(values):.3g} .. {max(values):.3g})"


def table(head, rows):
    cells = [head, *rows]
    widths = [max(len(row[k]) for row in cells) for k in range(len(head))]
    lines = ["| " + " | ".join(cell.ljust(width) for cell, width in zip(row, widths)) + " |" for row in cells]
    return "\n".join([lines[0], "|" + "|".join("-" * (width + 2) for width in widths) + "|", *lines[1:]]) + "\n"


HEAD = ["assembly", "discs", "rounds", "solver", "threads", *STAGES, "total, s", "iterations", "K", "nnz(L)", "stored/nnz(L)", "factor, MB",
        "peak, MB", "peak/factor", "CPU", "residual"]


def medians(kind, series):
    rows = []
    for (solver, threads), runs in series.items():
        m = {name: statistics.median(run[name] for run in runs) for name in runs[0] if name != "machine"}
        entries, stored = m["nonzeros"], m["factor_bytes"]
        rows.append([kind, str(runs[0]["discs"]), str(len(runs)), SOLVERS[solver], str(threads), *(f"{m[stage]:.3g}" for stage in STAGES),
                     spread([run["total"] for run in runs]), f"{m['iterations']:.0f}" if m["iterations"] else "-", f"{m['assembly']:.3g}",
                     f"{entries:.3e}" if entries else "-", f"{stored / 8 / entries:.2f}" if entries else "-", f"{1e-6 * stored:.0f}",
                     f"{1e-6 * m['peak_bytes']:.0f}", f"{m['peak_bytes'] / stored:.2f}", f"{m['cpu']:.3g}", f"{m['residual']:.1e}"])
    return rows


def ratios(kind, series):
    """equidem over CHOLMOD with its own orderings, and its methods over those before them: medians of the ratios within a round."""
    rows, keys = [], list(series)
    for ours in (key for key in keys if key[0].startswith("equidem")):
        for theirs in keys:
            before = theirs[0].startswith("equidem") and keys.index(theirs) < keys.index(ours)
            if theirs[1] != ours[1] or not (before or theirs[0] in ("cholmod-metis", "cholmod-amd")):
                continue
            over = {name: [a[name] / b[name] if b[name] else math.nan for a, b in zip(series[ours], series[theirs])]
                    for name in ("total", "nonzeros", "peak_bytes")}
            entries = statistics.median(over["nonzeros"])
            share = statistics.median(run["assembly"] / run["total"] for run in series[ours])
            rows.append([kind, str(series[ours][0]["discs"]), SOLVERS[ours[0]], SOLVERS[theirs[0]], str(ours[1]), spread(over["total"]), f"{entries:.3f}" if entries > 0 else "-",
                         f"{statistics.median(over['peak_bytes']):.2f}", f"{100 * share:.1f} %"])
    return rows


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)

    def words(text):
        return text.split(",")

    parser.add_argument("--build", type=Path, required=True, help="build folder of bench_static")
    parser.add_argument("--discs", type=words, default=["1e4", "1e5"], help="numbers of discs; default 1e4,1e5")
    parser.add_argument("--kinds", type=words, default=["hexagonal", "delaunay"], help="assemblies; default both")
    parser.add_argument("--solvers", type=words, default=list(SOLVERS), help=f"default {','.join(SOLVERS)}")
    parser.add_argument("--threads", type=words, default=["1", "2"], help="default 1,2")
    parser.add_argument("--repetitions", type=int, help="rounds; the default falls with the size")
    parser.add_argument("--json", type=Path, help="file for all numbers")
    parser.add_argument("--markdown", type=Path, help="file for the report")
    request = parser.parse_args()
    unknown = [name for name in request.solvers if name not in SOLVERS]
    if unknown:
        parser.error(f"there is no solver '{unknown[0]}'; there are {', '.join(SOLVERS)}")
    program = request.build.resolve() / "tools" / "bench" / "bench_static"
    solvers, over, all_runs, machine = [], [], [], ""
    for kind in request.kinds:
        for discs in map(float, request.discs):
            series = compared(program, request, kind, discs)
            first = next(iter(series.values()))
            machine = first[0]["machine"]
            solvers += medians(kind, series)
            over += ratios(kind, series)
            all_runs += [{"kind": kind, "solver": solver, "threads": int(threads), "runs": runs} for (solver, threads), runs in series.items()]
    skipped, command = False, "tools/bench/static.py"
    for word in sys.argv[1:]:  # where a page is written, and the build, do not change it
        if not skipped and word not in ("--markdown", "--build"):
            command += f" {word}"
        skipped = not skipped and word in ("--markdown", "--build")
    page = f"# Static solves\n\n    {command}\n\n{machine}.\n{TEXT}\n## Solvers\n\n" + table(HEAD, solvers)
    if over:
        page += "\n## Ratios\n\n" + table(["assembly", "discs", "of", "over", "threads", "total", "nnz(L)", "peak", "K / total of equidem"], over)
    print(page)
    if request.markdown:
        request.markdown.write_text(page, encoding="utf-8")
    if request.json:
        request.json.write_text(json.dumps({"machine": machine, "series": all_runs}, indent=1) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
