#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""The table of hard cases, as the tests measure it.

    make_table.py write PROGRAM [DEBUG] PAGE   run the test program, on one thread and on two, and the same tests of a debug build,
                                               where one is given; large cases once, on two threads; and write the page
    make_table.py check PAGE                   does the page name the cases of the tests beside this script, and no others?
"""

import glob
import json
import math
import os
import re
import subprocess
import sys
import tempfile

HEAD = """# Hard cases

Each is right to a stated accuracy, or refused with a sentence that says what to do. Written by the tests:

    tests/hard_cases/make_table.py write build/release/tests/test_hard_cases [build/debug/tests/test_hard_cases] data/hard_cases.md

"""
READING = """*error* is the distance from the truth: quadruple precision, a closed form, or a solution known beforehand; of multigrid the distance
from elimination, and the bound is that of both. *bound* is what the program itself states, from the residual, an estimate of the
condition and the rounding of the geometry. Both are relative: of all motions (2-norm, rotations times the mean radius), or of the largest entry of the effective stiffness. *energy* is the error of
the ledger of energies, *heat* what a body at rest dissipates, of the elastic energy, *balance* the force that a body lacks to be
at rest, over the largest contact force. *< floor* is a value below the round-off of the quantity that it is a share of, 1.1e-16
(2^-53). Digits differ a little from machine to machine; that the error is within the bound, and the bound within what is
promised, is tested on each.

"""
FLOOR = 2.0**-53
STATICS = ("solve", "homogenize", "stability", "quasistatic")  # first words of tasks
ATTACKS = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "data", "hard_cases")


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


def floored(task, promised, measured):
    """Numbers below the round-off of what they are a share of; the sentences of refusals stay as they are."""
    if promised == "refused":
        return measured
    return re.sub(r"[+-]?\b\d\.\d+e-\d+\b", lambda found: "< floor" if abs(float(found[0])) < FLOOR else found[0], measured)


def anchor_of(title):
    """The name that GitHub gives a heading."""
    return re.sub(r"[^\w\- ]", "", title.lower()).replace(" ", "-")


def orders_of(task, measured):
    """Orders between the levels of three errors whose steps halve, to round-off; empty: the row has no such errors."""
    errors = re.fullmatch(r"(\d\.\de-\d+), (\d\.\de-\d+), (\d\.\de-\d+)", measured)
    if not errors:
        return []
    values = [float(error) for error in errors.groups()]
    if values[-1] < 1e-12:
        return []
    return [math.log2(values[k] / values[k + 1]) for k in (0, 1)]


def shortfalls_of(table):
    """Tasks that do not reach second order, and those of which nothing is promised."""
    lines = []
    for case, tasks in table.items():
        for (task, promised, _), cells in tasks.items():
            orders = orders_of(task, cells[0][1])
            link = f"[{case}](#{anchor_of(case)})"
            if orders and min(orders) < 1.8:
                lines.append(f"| {link} | {task} | orders {orders[0]:.1f}, {orders[1]:.1f} |")
            if promised.startswith("none"):
                lines.append(f"| {link} | {task} | not promised ({promised.partition(': ')[2]}): {cells[0][1]} |")
    return ("## Orders that are not reached, and what is not promised\n\nA smooth motion has order 2. Where contacts begin and end "
            "within a step, several at a time, errors at three steps that halve\nfall irregularly.\n\n| case | task | found "
            "|\n|---|---|---|\n" + "\n".join(lines) + "\n\n")


def attacks():
    """Paragraphs with the numbers that the tests of fuzzing and of kills wrote."""
    text = "## Attacks\n\n"
    with open(os.path.join(ATTACKS, "fuzzing.json"), encoding="utf-8") as file:
        fuzzing = json.load(file)
    readers = fuzzing["readers"]
    accepted = sum(count["accepted"] for count in readers.values())
    text += (f"**Nearly valid inputs.** {fuzzing['inputs']:,} files, valid ones changed at random, were given to {len(readers)} "
             f"readers\n({', '.join(readers)}).\nSanitizers: {fuzzing['sanitizers']}. {accepted:,} were accepted, and cases among them "
             "read back to the same text; the others were refused by one\nline. Crashes, hangs (more than a second), defects: "
             f"{fuzzing['findings'] or 'none'}. The slowest took {fuzzing['slowest_ms']} ms. Command:\n`{fuzzing['command']} --report "
             "data/hard_cases/fuzzing.json`\n\n")
    with open(os.path.join(ATTACKS, "kills.json"), encoding="utf-8") as file:
        kills = json.load(file)
    text += (f"**Kills.** {sum(kills['kills'].values())} programs were ended by SIGKILL or SIGTERM at random times and given the same "
             "command again, with\n`--resume` where the verb has it: "
             f"{'; '.join(f'{name}: {count}' for name, count in kills['kills'].items())}.\nAll files equal those of a program that was "
             "never ended, to the byte (of `result.json`, what does not depend on the clock or\nthe folder; of a "
             "checkpoint, all but counters of work; of a study, the errors); "
             "so do those of one thread and of two. Differences: "
             f"{len(kills['findings']) or 'none'}. Command:\n`{kills['command']} --report data/hard_cases/kills.json`\n\n")
    return text


def summary_of(table):
    rows = [(promised, cells) for tasks in table.values() for (_, promised, _), cells in tasks.items()]
    refused = sum(promised == "refused" for promised, _ in rows)
    told = sum(promised.startswith("none") for promised, _ in rows)
    wrong = 0
    for promised, cells in rows:
        for _, measured in cells:
            found = re.match(r"error (\S+), bound (\S+),", measured)
            wrong += found is not None and float(found[1]) > float(found[2])
    return (f"**{len(table)} cases, {len(rows)} tasks: right {len(rows) - refused - told - wrong}, refused with a sentence {refused}, "
            f"wrong: {wrong or 'none'}.** Of {told} more nothing is promised:\nthe page says what they do. A task whose test fails writes no "
            "page.\n\n")


def section_of(name, why, tasks):
    text = f"### {name}\n\n{why[0].upper()}{why[1:]}.\n\n| task | promised | measured |\n|---|---|---|\n"
    for (task, promised, _), cells in tasks.items():
        shown = merged([(run, floored(task, promised, measured)) for run, measured in cells])
        text += "| " + " | ".join(cell.replace("|", "\\|") for cell in (task, promised, shown)) + " |\n"
    return text + "\n"


def page_of(runs, rows_of_runs, attacked):
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
    table = {name: table[name] for name in cases_of_sources()}
    parts = {"Statics": [], "Dynamics": []}
    for name, tasks in table.items():
        parts["Statics" if any(task.startswith(STATICS) for task, _, _ in tasks) else "Dynamics"].append(name)
    text = HEAD + summary_of(table) + READING + said_of(runs) + "\n"
    for part, names in parts.items():
        text += f"{part}: " + " ·\n".join(f"[{name}](#{anchor_of(name)})" for name in names) + ".\n\n"
    text += attacked
    text += shortfalls_of(table)
    for part, names in parts.items():
        text += f"## {part}\n\n" + "".join(section_of(name, why[name], table[name]) for name in names)
    return text.rstrip("\n") + "\n"


def main():
    if len(sys.argv) in (4, 5) and sys.argv[1] == "write":
        runs = runs_of(sys.argv[2:-1])
        attacked = attacks()  # before the tests, which take minutes
        page = page_of(runs, [rows_of(run) for run in runs], attacked)
        with open(sys.argv[-1], "w", encoding="utf-8") as file:
            file.write(page)
        return 0
    if len(sys.argv) == 3 and sys.argv[1] == "check":
        with open(sys.argv[2], encoding="utf-8") as file:
            listed = re.findall(r"^### (.+)$", file.read(), re.MULTILINE)
        tested = cases_of_sources()
        for name in sorted(set(tested) - set(listed)):
            print(f"the page has no case '{name}': write it anew")
        for name in sorted(set(listed) - set(tested)):
            print(f"the page has a case '{name}' that no test has: write it anew")
        return 0 if tested and sorted(tested) == sorted(listed) else 1
    print(__doc__)
    return 2


if __name__ == "__main__":
    sys.exit(main())
