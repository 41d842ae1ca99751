#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""What a call from Python costs beyond the same computation in C++.

    tools/bench/python_overhead.py --build build/release [--discs N,...] [--rounds N] [--markdown FILE]

A hexagonal block, left side held, load on the right. In every round the program solves the case, and the module solves
it from an assembly in memory; both report the times of their stages, and the module that of the verb in C++, around
which its call does the rest: the case as text, the numbers as JSON and back, views of the arrays."""
import argparse
import json
import os
import subprocess
import sys
import tempfile
import time
from pathlib import Path

os.environ["OPENBLAS_NUM_THREADS"] = "1"
CALLS = 3  # of the module in a round
SPRINGS = (1e9, 0.5e9)
SUPPORTS = [{"group": "left", "ux": 0, "uy": 0}]
LOADS = [{"group": "right", "force": (1e3, 0)}]
CASE = """schema = "equidem/1"
assembly = {{ kind = "hexagonal", columns = {side}, rows = {side}, radius = 0.005 }}
springs  = {{ kN = {kN}, kT = {kT} }}
[[support]]
group = "left"
ux = 0.0
uy = 0.0
[[load]]
group = "right"
force = [1000.0, 0.0]
"""
TEXT = """\
`equidem.solve` of a hexagonal block, kT/kN = 0.5, left side held, load on the right, {threads} threads. \
Milliseconds, the least of {rounds} rounds in which the program and {calls} calls of the module take turns. Stages: \
the times that the result reports, without the making of the assembly. Verb in C++: the wall clock of the verb, with \
what no stage counts, such as the freeing of the factor. Call: the wall clock of the Python call; beyond the verb it \
writes the case as TOML, and gets the numbers as JSON and the arrays as views. Report, units and labels are made \
when they are asked for: `texts`, of the first access.
"""
COLUMNS = ("stages, program", "stages, module", "verb in C++", "call", "call beyond the verb", "texts")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--build", type=Path, required=True, help="build folder of program and module")
    parser.add_argument("--discs", default="1e2,1e3,1e4,1e5")
    parser.add_argument("--rounds", type=int, default=15)
    parser.add_argument("--markdown", type=Path, help="write the page into this file")
    options = parser.parse_args()
    sys.path.insert(0, str(options.build.resolve() / "python"))
    import equidem as eq

    eq.show_progress(False)
    rows = []
    for discs in (float(word) for word in options.discs.split(",")):
        side = round(discs**0.5)
        count, least = measured(eq, options.build / "tools" / "equidem", side, options.rounds)
        print(f"{count} discs: call {1e3 * least['call']:.3g} ms", file=sys.stderr)
        rows.append((count, least))
    text = page(rows, options, eq)
    if options.markdown:
        options.markdown.write_text(text, encoding="utf-8")
    print(text)


def measured(eq, program, side, rounds):
    """(discs, {what: least seconds of the rounds})."""
    block = eq.hexagonal(columns=side, rows=side, radius=5e-3)
    least = {}

    def take(name, seconds):
        least[name] = min(seconds, least.get(name, seconds))

    with tempfile.TemporaryDirectory() as folder:
        case = Path(folder) / "case.toml"
        case.write_text(CASE.format(side=side, kN=SPRINGS[0], kT=SPRINGS[1]), encoding="utf-8")
        for _ in range(rounds):
            done = subprocess.run([program, "solve", case, "--json", "-", "--quiet"], capture_output=True, check=True)
            take("stages, program", stages(json.loads(done.stdout)["times"]))
            for _ in range(CALLS):
                begin = time.perf_counter()
                result = eq.solve(block, SPRINGS, supports=SUPPORTS, loads=LOADS)
                whole = time.perf_counter() - begin
                take("stages, module", stages(result.times))
                take("verb in C++", result.elapsed)
                take("call", whole)
                take("call beyond the verb", whole - result.elapsed)
                begin = time.perf_counter()
                assert result.report and result.units
                take("texts", time.perf_counter() - begin)
                del result  # its arrays are freed outside the next call
    return len(block), least


def stages(times):
    """Seconds of all stages but the making of the assembly, which the module has in memory."""
    return sum(seconds for stage, seconds in times.items() if stage != "assembly")


def machine(eq):
    """The machine, in the words of a study."""
    found = eq.study(ROOT / "data" / "studies" / "integrators.toml", budget=1, rounds=3).machine
    return f"{found.processor}, {found.cores} cores; equidem {found.version}, {found.build}, compiler {found.compiler}"


def page(rows, options, eq):
    command = f"tools/bench/python_overhead.py --build build/release --discs {options.discs} --rounds {options.rounds}"
    lines = ["# From Python", "", f"    {command}", "", f"{machine(eq)}; Python {sys.version.split()[0]}; "
             f"load average {os.getloadavg()[0]:.1f}, of which the benchmark is at most 2.", "",
             TEXT.format(threads=eq.threads(), rounds=options.rounds, calls=CALLS),
             f"| discs | {' | '.join(COLUMNS)} | call beyond the verb over verb |",
             "|---" * (len(COLUMNS) + 2) + "|"]
    for discs, least in rows:
        numbers = [1e3 * least[name] for name in COLUMNS]
        share = least["call beyond the verb"] / least["verb in C++"]
        lines.append(f"| {discs} | {' | '.join(f'{number:.3g}' for number in numbers)} | {100 * share:.2g} % |")
    return "\n".join(lines) + "\n"


if __name__ == "__main__":
    main()
