#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""The hard cases, as the tests measure them: tables and figure of data/hard_cases, which the page data/hard_cases.md shows.

    make_table.py write PROGRAM [DEBUG] FOLDER   run the test program, on one thread and on two, and the same tests of a debug build,
                                                 where one is given; large cases once, on two threads; and write the tables
    make_table.py summarize FOLDER               make the summaries and the figure of stored tasks again
    make_table.py check FOLDER                   do the tables have the cases of the tests beside this script, and no others?
"""

import json
import math
import os
import pathlib
import re
import subprocess
import sys
import tempfile

FLOOR = 2.0**-53
SOURCE = pathlib.Path(__file__).resolve().parents[2]
sys.path[:0] = [str(SOURCE / "docs" / "site"), str(SOURCE / "tools" / "bench" / "page_parts")]
sys.dont_write_bytecode = True

import tables  # noqa: E402

# Kind: sources of its cases, what is hard, what the program does.
KINDS = {
    "free motions": (["networks"], "gears, chains, rattlers, cells of one disc, networks near the onset of rigidity",
                     "finds zero-energy modes, fixes them where no load acts on them, else names the part and the support that it needs"),
    "ill-conditioned matrices": (["slender", "springs"], "strips of 2 x 1e5 discs, kT/kN from 1e-8 to 1e8 and near the critical one, joints 1e-10 as stiff",
                                 "refines the solution in extended precision, bounds its error by the condition, refuses where no digit is certain"),
    "sizes and units": (["scales", "large"], "radii in ratio 1000:1, from 1e-9 to 1e6 m, far from the origin; a million discs",
                        "decides nothing by an absolute number"),
    "multigrid": (["iterations"], "slender strips, springs ten decades apart, floppy networks",
                  "measures the residual by the contact law; elimination follows where iterations do not converge"),
    "bonds that break, contacts that slip": (["breakage"], "equal and zero strengths, loads to and fro, friction 0 to 10",
                                             "takes events at one load in a fixed order, closes the balance of energies, ends with a reason"),
    "impacts and rest": (["collisions"], "Newton's cradle, masses in ratio 1e6, restitution 0 and 1, steps as long as a contact; columns, heaps, wedges",
                         "keeps the energy of a contact and at rest what rests, refuses a step that lets bodies pass through one another"),
    "shapes": (["grain_shapes"], "needles of aspect 20, aligned and concentric bodies, radii 1:100", "finds the closest points from any start"),
    "boxes and bonds": (["grain_boxes"], "closing gaps, overfilled boxes, 100 g, all bonds broken at once, one grain, no gravity, friction 10",
                        "limits the step by the stiffest contact and bond, counts what leaves the box"),
}
STORED = ["kind", "case", "why it is hard", "task", "promised", "measured"]


def runs_of(programs):
    """(build, threads, program) of every run; the first is the one that the others are compared with."""
    builds = [("optimized", programs[0])] + [("debug", program) for program in programs[1:]]
    return [(build, threads, program) for build, program in builds for threads in (1, 2)]


def cases_of_sources():
    """Kind of each case, in the order in which the sources have them first."""
    kinds = {source: kind for kind, (sources, _, _) in KINDS.items() for source in sources}
    found = {}
    for path in sorted(pathlib.Path(__file__).parent.glob("*.cpp")):
        for name in re.findall(r'HardCase(?:::Words)? \w+\(?\s*\{\s*\.name = "([^"]+)"', path.read_text(encoding="utf-8")):
            found.setdefault(name, kinds.get(path.stem, "of no kind"))
    return found


def rows_of(run):
    build, threads, program = run
    with tempfile.TemporaryDirectory() as folder:
        path = pathlib.Path(folder) / "rows"
        environment = {**os.environ, "EQUIDEM_HARD_CASES": str(path), "EQUIDEM_HARD_CASES_THREADS": str(threads)}
        for tests in [[]] + [["[.large]"]] * (build == "optimized" and threads == 2):
            subprocess.run([program, *tests], env=environment, check=True, stdout=sys.stderr)
        return [json.loads(line) for line in path.read_text(encoding="utf-8").splitlines()]


def labels_of(runs):
    """Of some of the runs, as short as it can be said: {("debug", 1), ("debug", 2)} is "debug"."""
    labels = []
    for build in dict.fromkeys(build for build, _ in runs):
        threads = [str(count) for name, count in runs if name == build]
        labels.append(build if len(threads) == 2 else f"{build}, {threads[0]} thread{'s' * (threads[0] != '1')}")
    return "; ".join(labels)


def merged(measured):
    """One value where all runs print the same, else each with the runs that print it."""
    by_value = {}
    for run, value in measured:
        by_value.setdefault(value, []).append(run)
    if len(by_value) == 1:
        return next(iter(by_value))
    return "; ".join(f"{value} ({labels_of(runs)})" for value, runs in by_value.items())


def floored(task, promised, measured):
    """Numbers below the round-off of what they are a share of; the sentences of refusals stay as they are."""
    if promised == "refused":
        return measured
    return re.sub(r"[+-]?\b\d\.\d+e-\d+\b", lambda found: "< floor" if abs(float(found[0])) < FLOOR else found[0], measured)


def orders_of(task, measured):
    """Orders between the levels of three errors whose steps halve, to round-off; empty: the row has no such errors."""
    errors = re.fullmatch(r"(\d\.\de-\d+), (\d\.\de-\d+), (\d\.\de-\d+)", measured)
    if not errors:
        return []
    values = [float(error) for error in errors.groups()]
    if values[-1] < 1e-12:
        return []
    return [math.log2(values[k] / values[k + 1]) for k in (0, 1)]


def numbers_of(measured):
    """Error and bound of a task that has both; below the floor: the floor."""
    found = re.match(r"error (< floor|\S+), bound (< floor|[^\s,;]+)", measured)
    return tuple(FLOOR if text == "< floor" else float(text) for text in found.groups()) if found else None


def kinds_table(rows):
    """Tasks of each kind: right, refused, not promised, wrong."""
    counted = []
    for kind, (_, hard, done) in KINDS.items():
        own = [row for row in rows if row["kind"] == kind]
        refused = sum(row["promised"] == "refused" for row in own)
        free = sum(row["promised"].startswith("none") for row in own)
        pairs = [numbers for row in own if (numbers := numbers_of(row["measured"]))]
        wrong = sum(error > bound for error, bound in pairs)
        counted.append([kind, hard, done, len(own) - refused - free - wrong, refused, free, wrong])
    totals = [sum(row[k] for row in counted) for k in range(3, 7)]
    return [[*row[:3], *map(str, row[3:])] for row in [*counted, ["all", f"{len({row['case'] for row in rows})} cases", "", *totals]]]


def shortfalls_of(rows):
    """Tasks that do not reach second order, and those of which nothing is promised."""
    lines = []
    for row in rows:
        orders = orders_of(row["task"], row["measured"])
        if orders and min(orders) < 1.8:
            lines.append([row["case"], row["task"], f"orders {orders[0]:.1f}, {orders[1]:.1f}"])
        if row["promised"].startswith("none"):
            lines.append([row["case"], row["task"], f"not promised ({row['promised'].partition(': ')[2]}): {row['measured']}"])
    return lines


def attacks_of(folder):
    """What the tests of fuzzing and of kills wrote."""
    fuzzing, kills = (json.loads((folder / f"{name}.json").read_text(encoding="utf-8")) for name in ("fuzzing", "kills"))
    accepted = sum(count["accepted"] for count in fuzzing["readers"].values())
    ended = sum(kills["kills"].values())
    return [["files changed at random", f"{fuzzing['inputs']:,} files for {len(fuzzing['readers'])} readers",
             f"{accepted:,} accepted, the others refused by one line; crashes, hangs, defects: {fuzzing['findings'] or 'none'}", f"`{fuzzing['command']}`"],
            ["programs killed at random times", f"{ended} runs of {len(kills['kills'])} kinds", f"resumed: files that differ from those of a run "
             f"that was never ended: {len(kills['findings']) or 'none'}", f"`{kills['command']}`"]]


def summarize(folder):
    import figures

    rows = tables.rows_of(folder / "tasks.csv")
    tables.write_rows(folder / "kinds.csv", ["kind", "such as", "what is done", "right", "refused", "not promised", "wrong"], kinds_table(rows))
    tables.write_rows(folder / "shortfalls.csv", ["case", "task", "found"], shortfalls_of(rows))
    tables.write_rows(folder / "attacks.csv", ["attack", "tried", "found", "command"], attacks_of(folder))
    groups = {}
    for row in rows:
        if numbers := numbers_of(row["measured"]):
            groups.setdefault(row["task"].split()[0].rstrip(","), []).append(numbers[::-1])
    figures.bound_and_error(folder / "bounds", groups, "bound of the error that the program states", "true error")
    tables.fill()


def tasks_of(runs, rows_of_runs):
    """Rows of tasks.csv."""
    table, why = {}, {}  # case -> (task, promised, number) -> [(run, measured)]; the same task may come more than once
    for (build, threads, _), rows in zip(runs, rows_of_runs):
        seen = {}
        for row in rows:
            task = (row["task"], row["promised"])
            number = seen[row["case"], task] = seen.get((row["case"], task), 0) + 1
            cells = table.setdefault(row["case"], {}).setdefault((*task, number), [])
            cells.append(((build, threads), row["measured"]))
            why[row["case"]] = row["why"]
    return [[kind, case, why[case], task, promised, merged([(run, floored(task, promised, measured)) for run, measured in cells])]
            for case, kind in cases_of_sources().items() for (task, promised, _), cells in table[case].items()]


def main():
    if len(sys.argv) in (4, 5) and sys.argv[1] == "write":
        runs, folder = runs_of(sys.argv[2:-1]), pathlib.Path(sys.argv[-1])
        tables.write_rows(folder / "tasks.csv", STORED, tasks_of(runs, [rows_of(run) for run in runs]))
        summarize(folder)
        return 0
    if len(sys.argv) == 3 and sys.argv[1] == "summarize":
        summarize(pathlib.Path(sys.argv[2]))
        return 0
    if len(sys.argv) == 3 and sys.argv[1] == "check":
        stored = {row["case"]: row["kind"] for row in tables.rows_of(pathlib.Path(sys.argv[2]) / "tasks.csv")}
        tested = cases_of_sources()
        for name in sorted(stored.keys() ^ tested.keys() | {name for name in stored.keys() & tested.keys() if stored[name] != tested[name]}):
            print(f"the case '{name}' is {tested.get(name, 'in no test')}, and stored as {stored.get(name, 'nothing')}: write the tables anew")
        return 0 if tested and stored == tested else 1
    print(__doc__)
    return 2


if __name__ == "__main__":
    sys.exit(main())
