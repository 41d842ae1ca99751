#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""The table of hard cases, as the tests measure it.

    make_table.py write PROGRAM [DEBUG] PAGE   run the test program, on one thread and on two, and the same tests of a debug build,
                                               where one is given; large cases once, on two threads; and write the page
    make_table.py check PAGE                   does the page name the cases of the tests beside this script, and no others?
"""

import glob
import json
import os
import re
import subprocess
import sys
import tempfile

HEAD = """# Hard cases

Each is right to a stated accuracy, or refused with a sentence that says what to do. Written by the tests:

    tests/hard_cases/make_table.py write build/release/tests/test_hard_cases [build/debug/tests/test_hard_cases] data/hard_cases.md

*error* is the distance from the truth: quadruple precision, a closed form, or a solution known beforehand. *bound* is what the
program itself states, from the residual, an estimate of the condition and the rounding of the geometry. Both are relative: of all
motions (2-norm, rotations times the mean radius), or of the largest entry of the effective stiffness. *energy* is the error of
the ledger of energies, *balance* the force that a body lacks to be at rest, over the largest contact force. Tasks named solve and
homogenize are statics, all others dynamics. Digits differ a little from machine to machine; that the error is within the bound,
and the bound within what is promised, is tested on each.

"""


def runs_of(programs):
    """(build, threads, program) of every run; the first is the one that the others are compared with."""
    builds = [("optimized", programs[0])] + [("debug", program) for program in programs[1:]]
    return [(build, threads, program) for build, program in builds for threads in (1, 2)]


def said_of(runs):
    builds = ("an optimized build on one thread and on two: one value where both" if len(runs) == 2 else
              "an optimized and a debug build, each on one thread and on two: one value where all four")
    return (f"Measured by {builds} print the same,\nelse each. Thin strips of 1e4 discs and more, assemblies of a million and "
            "runs of a million steps are measured once, by the\noptimized build on two threads.\n")


def cases_of_sources():
    """Names of the cases in the order in which the sources have them first."""
    names = []
    for path in sorted(glob.glob(os.path.join(os.path.dirname(os.path.abspath(__file__)), "*.cpp"))):
        with open(path, encoding="utf-8") as file:
            names += re.findall(r'HardCase(?:::Words)? \w+\(?\s*\{\s*\.name = "([^"]+)"', file.read())
    return list(dict.fromkeys(names))


def rows_of(run):
    build, threads, program = run
    with tempfile.TemporaryDirectory() as folder:
        path = os.path.join(folder, "rows")
        environment = {**os.environ, "EQUIDEM_HARD_CASES": path, "EQUIDEM_HARD_CASES_THREADS": str(threads)}
        for tests in [[]] + [["[.large]"]] * (build == "optimized" and threads == 2):
            subprocess.run([program, *tests], env=environment, check=True, stdout=sys.stderr)
        with open(path, encoding="utf-8") as file:
            return [json.loads(line) for line in file]


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
    return "<br>".join(f"{value} ({labels_of(runs)})" for value, runs in by_value.items())


def page_of(runs, rows_of_runs):
    table = {}  # case -> (task, promised) -> [(run, measured)]; the same task may come more than once
    why = {}
    for (build, threads, _), rows in zip(runs, rows_of_runs):
        seen = {}
        for row in rows:
            task = (row["task"], row["promised"])
            number = seen[row["case"], task] = seen.get((row["case"], task), 0) + 1
            cells = table.setdefault(row["case"], {}).setdefault((*task, number), [])
            cells.append(((build, threads), row["measured"]))
            why[row["case"]] = row["why"]
    text = HEAD + said_of(runs)
    for name in cases_of_sources():
        text += f"\n## {name}\n\n{why[name][0].upper()}{why[name][1:]}.\n\n"
        text += "| task | promised | measured |\n|---|---|---|\n"
        for (task, promised, _), cells in table[name].items():
            text += "| " + " | ".join(cell.replace("|", "\\|") for cell in (task, promised, merged(cells))) + " |\n"
    return text


def main():
    if len(sys.argv) in (4, 5) and sys.argv[1] == "write":
        runs = runs_of(sys.argv[2:-1])
        page = page_of(runs, [rows_of(run) for run in runs])
        with open(sys.argv[-1], "w", encoding="utf-8") as file:
            file.write(page)
        return 0
    if len(sys.argv) == 3 and sys.argv[1] == "check":
        with open(sys.argv[2], encoding="utf-8") as file:
            listed = re.findall(r"^## (.+)$", file.read(), re.MULTILINE)
        tested = cases_of_sources()
        for name in sorted(set(tested) - set(listed)):
            print(f"the page has no case '{name}': write it anew")
        for name in sorted(set(listed) - set(tested)):
            print(f"the page has a case '{name}' that no test has: write it anew")
        return 0 if tested and tested == listed else 1
    print(__doc__)
    return 2


if __name__ == "__main__":
    sys.exit(main())
