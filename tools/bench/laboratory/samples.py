#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""tools/bench/laboratory/samples.py PROGRAM FOLDER

Writes the samples of the cases of the laboratory: lab_*.csv of data/cases, the same bytes each time. A rock is a jammed packing whose
discs are bonded across gaps up to a tenth of their radii; a Brazilian disc is cut out of one whose walls are its flat ends."""

import argparse
import json
import math
import subprocess
import tempfile
from pathlib import Path

PACK = """schema = "equidem/1"
[packing]
method = "growth"
grains = {grains}
box    = [{width}, {height}]
solid_fraction = "auto"
overlap = 1.0e-3
seed   = {seed}
gap_tolerance = 0.1
[packing.radii]
smallest = 0.0006
largest  = 0.0010
[springs]
kN = 2.0e9
kT = 8.0e8
"""
HEAP = """schema = "equidem/1"
[packing]
method = "falling"
grains = 2000
box    = [0.15, 0.5]
seed   = {seed}
[packing.radii]
smallest = 0.0016
largest  = 0.0024
[settling]
friction = 0.5
wall_friction = 0.5
unbalanced = 1.0e-3
[springs]
kN = 1.0e6
kT = 5.0e5
density = 2500.0
"""
SAND = """schema = "equidem/1"
[packing]
method = "local_moves"
grains = 445
box    = [0.2, 0.2]
seed   = {seed}
[packing.radii]
smallest = 0.0035
largest  = 0.0055
[springs]
kN = 1.0e8
kT = 5.0e7
"""
ROCK, ROCK_GRAINS = (0.04, 0.08), 800  # m, width and height
RADIUS, HALF_ANGLE, DISC_GRAINS = 0.025, math.radians(10), 1200  # m, of the Brazilian disc and of its flat ends


def packed(program, case):
    """Discs (x, y, r) and contacts (i, j) of a packing."""
    with tempfile.TemporaryDirectory() as folder:
        (Path(folder) / "pack.toml").write_text(case, encoding="utf-8")
        subprocess.run([program, "pack", "pack.toml", "--out", "out", "--quiet"], cwd=folder, check=True)
        made = json.loads((Path(folder) / "out" / "assembly.json").read_text())
    return made["discs"], [contact[:2] for contact in made["contacts"]]


def gauge_of(x, y, width, height):
    """Groups of a rock whose mean motions give its strains: bands near its sides, away from its corners."""
    if 0.1 * width < x < 0.9 * width:
        if 0.86 * height < y < 0.92 * height:
            return "upper"
        if 0.08 * height < y < 0.14 * height:
            return "lower"
    if 0.2 * height < y < 0.8 * height:
        if 0.06 * width < x < 0.16 * width:
            return "left"
        if 0.84 * width < x < 0.94 * width:
            return "right"
    return "rock"


def rock(program, grains=ROCK_GRAINS, seed=4):
    """A rock of these many discs, all as large as in the case; width and height follow."""
    width, height = (side * math.sqrt(grains / ROCK_GRAINS) for side in ROCK)
    discs, contacts = packed(program, PACK.format(grains=grains, width=width, height=height, seed=seed))
    return [(x, y, r, gauge_of(x, y, width, height)) for x, y, r in discs], contacts


def brazilian(program, grains=DISC_GRAINS, seed=6):
    """The disc about the origin, pressed along y on ends that are flat over 2 HALF_ANGLE; cut out of these many discs."""
    radius = RADIUS * math.sqrt(grains / DISC_GRAINS)
    half = radius * math.cos(HALF_ANGLE)
    discs, contacts = packed(program, PACK.format(grains=grains, width=2 * radius, height=2 * half, seed=seed))
    number, cut = {}, []
    for k, (x, y, r) in enumerate(discs):
        x, y = x - radius, y - half
        if math.hypot(x, y) <= radius - r / 2:
            number[k] = len(cut)
            cut.append((x, y, r, "rock"))
    return cut, [(number[i], number[j]) for i, j in contacts if i in number and j in number]


def heap(program, seed=3):
    return [(*disc, "grains") for disc in packed(program, HEAP.format(seed=seed))[0]]


def sand(program, seed):
    """The loose sand of several samples, as that of biaxial.csv."""
    return [(*disc, "grains") for disc in packed(program, SAND.format(seed=seed))[0]]


def write(folder, name, discs, contacts=None):
    with open(folder / f"{name}.csv", "w", encoding="utf-8") as file:
        file.write("x,y,radius,group\n" + "".join(f"{x:.9f},{y:.9f},{r:.9f},{group}\n" for x, y, r, group in discs))
    if contacts:
        with open(folder / f"{name}_bonds.csv", "w", encoding="utf-8") as file:
            file.write("i,j\n" + "".join(f"{i},{j}\n" for i, j in contacts))


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program", type=Path)
    parser.add_argument("folder", type=Path)
    request = parser.parse_args()
    program, folder = request.program.resolve(), request.folder
    write(folder, "lab_rock", *rock(program))
    write(folder, "lab_brazilian", *brazilian(program))
    write(folder, "lab_heap", heap(program))
    ends = {0: "ends", 10: "middle", 20: "ends"}
    write(folder, "lab_beam", [(0.01 * k, 0.0, 0.005, ends.get(k, "beam")) for k in range(21)], [(k, k + 1) for k in range(20)])


if __name__ == "__main__":
    main()
