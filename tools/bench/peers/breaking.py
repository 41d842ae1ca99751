#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""tools/bench/peers/breaking.py --build FOLDER [--columns N] [--steps N,...] [--page FILE]

A bonded sample pulled until it breaks: the same discs, springs and strengths in YADE, slowly and with damping, and in equidem
quasistatic. Prints the section, and writes it to the end of the page where one is given."""

import argparse
import json
import random
import sys
import tempfile
from pathlib import Path

from common import Failure, call, number, result_of, table, tell

HERE = Path(__file__).resolve().parent
RADIUS, KN, KT, FRICTION = 0.5e-3, 1e9, 0.4e9, 0.5
TENSION, MODULUS = 1e3, 6.0  # N/m: a contact breaks at an opening of TENSION/KN = 1e-6 m, 0.002 of a radius
HEADING = "## Beside YADE\n"
SCENE = f"""[springs]
kN = {KN}
kT = {KT}
[[support]]
group = "bottom"
ux = true
uy = true
[[support]]
group = "top"
uy = 1.0e-6
"""


def sample(equidem, columns, folder):
    """An assembly file with strengths by Weibull's law."""
    lattice = folder / "lattice.toml"
    rows = round(columns * 1.6)
    lattice.write_text(f'schema = "equidem/1"\n[assembly]\nkind = "hexagonal"\ncolumns = {columns}\nrows = {rows}\nradius = {RADIUS}\n{SCENE}'
                       '[output]\nassembly = "json"\nfiles = ["csv"]\n')
    call([equidem, "solve", lattice, "--out", folder / "lattice", "--quiet"])
    assembly = json.loads((folder / "lattice" / "assembly.json").read_text())
    generator = random.Random(5)
    strength = [TENSION * generator.weibullvariate(1, MODULUS) for _ in assembly["contacts"]]
    assembly["strengths"] = [[one, 2 * one] for one in strength]
    (folder / "sample.json").write_text(json.dumps(assembly))
    return assembly


def ours(equidem, folder):
    case = folder / "sample.toml"
    case.write_text(f'schema = "equidem/1"\n[assembly]\nkind = "file"\npath = "sample.json"\n{SCENE}[strength]\nfriction = {FRICTION}\n'
                    '[quasistatic]\ncontrol = "motion"\n')
    result = json.loads(call([equidem, "quasistatic", case, "--json", "-", "--quiet", "--threads", 1]))
    events = result["events"]
    return {"broken": [(event["contact"], event["motion"]) for event in events],
            "curve": [(event["motion"], event["load"]) for event in events],
            "seconds": sum(result["times"].values()), "energy": result["energies"]["error"]}


def summary(found):
    peak = max(found["curve"], key=lambda point: point[1])
    before = [one for one in found["broken"] if one[1] < peak[0]]
    return {"peak": peak[1], "motion": peak[0], "first": found["broken"][0], "before": len(before), "all": len(found["broken"])}


def same_order(a, b):
    """How many first contacts agree in order, and how many of the first ten of a are among the first ten of b."""
    first, second = [one[0] for one in a["broken"]], [one[0] for one in b["broken"]]
    leading = next((k for k, (x, y) in enumerate(zip(first, second)) if x != y), min(len(first), len(second)))
    return leading, len(set(first[:10]) & set(second[:10]))


def section(equidem, columns, steps, command):
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        assembly = sample(equidem, columns, folder)
        exact = ours(equidem, folder)
        at = summary(exact)
        rows = [["equidem quasistatic", "-", number(exact["seconds"]), number(at["first"][1]), f"{at['peak']:.6g}", f"{at['motion']:.4g}",
                 at["before"], at["all"], "-", "-"]]
        for count in steps:
            text = call(["yade", "-n", "-x", "-j1", HERE / "breaking_yade.py", folder / "sample.json", KN, KT, FRICTION, 1.3 * at["motion"], count,
                         0.4])
            found = result_of(text)
            there = summary(found)
            leading, common = same_order(exact, found)
            rows.append(["YADE", f"{count:,}", number(found["seconds"]), number(there["first"][1]), f"{there['peak']:.6g}", f"{there['motion']:.4g}",
                         there["before"], there["all"], leading, common])
            tell(f"YADE, {count} steps: {found['seconds']:.1f} s, {found['seconds'] / exact['seconds']:.0f} times as long")
    head = ["", "steps", "s", "motion at the first break, m", "peak load, N/m", "at the motion, m", "breaks before the peak", "breaks in all",
            "first breaks in the same order", "of the first ten the same"]
    return (f"{HEADING}\n    {command}\n\nOne sample, {len(assembly['discs']):,} discs and {len(assembly['contacts']):,} bonds, hexagonal, kT/kN = "
            f"{KT / KN:g}, friction {FRICTION:g}, strengths by Weibull's law with\nm = {MODULUS:g}, pulled by its top at a constant speed until 1.3 "
            "times the motion of our peak (YADE: CohFrictMat, local damping 0.4, 0.3 of its\ncritical step), or break by break under control of the "
            "motion until nothing carries (equidem). The law of YADE carries our springs and both\nstrengths exactly; it differs behind the break, "
            "where its discs still press on each other and slide with friction, and in waves, which a break sends out. Both on one core.\n\n" + table(head, rows) + "\n")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--build", type=Path, required=True, help="a build folder")
    parser.add_argument("--columns", type=int, default=25)
    parser.add_argument("--steps", default="10000,100000", help="of YADE, separated by commas")
    parser.add_argument("--page", type=Path, help="its section is made anew")
    request = parser.parse_args()
    steps = [int(word) for word in request.steps.split(",")]
    text = section(request.build.resolve() / "tools" / "equidem", request.columns, steps,
                   f"tools/bench/peers/breaking.py --build build/release --columns {request.columns} --steps {request.steps}")
    print(text)
    if request.page:
        page = request.page.read_text(encoding="utf-8")
        request.page.write_text(page.split(HEADING)[0].rstrip("\n") + "\n\n" + text, encoding="utf-8")


if __name__ == "__main__":
    try:
        main()
    except Failure as failure:
        sys.exit(f"breaking.py: {failure}")
