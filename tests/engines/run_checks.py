#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Exported models in the engines that they are for.

    run_checks.py PROGRAM GROUP               the checks of a group; exit code 77 where the engine is not installed
    run_checks.py PROGRAM --csv FILE          all checks, as the table of the page data/interop.md

Variables: EQUIDEM_LAMMPS, EQUIDEM_LAMMPS_BPM, EQUIDEM_YADE name the programs, else lmp and yade.
"""
import csv
import pathlib
import sys
import tempfile

import bonds
import driven
import engines
import grains
import vibration

#: group, engine, what is compared, limit, function of the program and a folder that returns the relative difference
CHECKS = [
    ("lammps_bonds", "LAMMPS", "forces and moments of discs displaced at random, 2e-4 of the spacing", 1e-6,
     bonds.lammps_forces),
    ("lammps_bonds", "LAMMPS", "displacements and rotations at rest under tension, strains of 1e-4", 1e-4,
     bonds.odd_part("lammps", bonds.tension)),
    ("lammps_bonds", "LAMMPS", "displacements under tension, strains of 1e-5, finite motion not taken out", 1e-4,
     bonds.lammps_shrinking),
    ("lammps_bonds", "LAMMPS", "at rest, with prescribed displacements and rotations", 1e-4,
     bonds.odd_part("lammps", bonds.shear)),
    ("lammps_bonds", "LAMMPS", "at rest, with restrained rotations", 1e-4, bonds.odd_part("lammps", bonds.restrained)),
    ("lammps_bonds", "LAMMPS", "share of bonds that break otherwise, with strengths", 1e-9, bonds.lammps_strengths),
    ("lammps_bonds", "LAMMPS", "period of the lowest mode", 1e-4, vibration.lammps_period),
    ("lammps_bonds", "LAMMPS", "a network that loads and gravity set in motion", 1e-4,
     bonds.run_difference("lammps", bonds.SET_IN_MOTION)),
    ("lammps_bonds", "LAMMPS", "a block that falls on a wall of springs, with gravity and local damping", 1e-3,
     bonds.run_difference("lammps", bonds.FALLING)),
    ("lammps_bonds", "LAMMPS", "a block into which a wall of springs moves", 1e-3,
     bonds.run_difference("lammps", bonds.PUSHED)),
    ("lammps_bonds", "LAMMPS", "a pulse in a periodic cell", 1e-3, bonds.run_difference("lammps", driven.LATTICE)),
    ("lammps_bonds", "LAMMPS", "a network whose supports and loads follow a ramp, a sine and a table", 1e-3,
     bonds.run_difference("lammps", driven.driven(1.0, False))),
    ("lammps_bonds", "LAMMPS", "a network with dashpots in its bonds, set in motion", 1e-3,
     bonds.run_difference("lammps", *driven.DASHPOTS)),
    ("yade_bonds", "YADE", "forces and moments of discs displaced at random, 1e-4 of the spacing", 1e-6,
     bonds.yade_forces),
    ("yade_bonds", "YADE", "displacements and rotations at rest under tension, strains of 1e-4", 1e-6,
     bonds.odd_part("yade", bonds.tension)),
    ("yade_bonds", "YADE", "at rest, with prescribed displacements and rotations, and moments", 1e-6,
     bonds.odd_part("yade", bonds.shear_with_moments)),
    ("yade_bonds", "YADE", "at rest, with restrained rotations", 1e-6, bonds.odd_part("yade", bonds.restrained)),
    ("yade_bonds", "YADE", "at rest, discs of two radii, contact points off the middle", 1e-6,
     bonds.odd_part("yade", bonds.pulled_rows, bonds.rows_file)),
    ("yade_bonds", "YADE", "a network that loads and gravity set in motion", 1e-4,
     bonds.run_difference("yade", bonds.SET_IN_MOTION)),
    ("yade_bonds", "YADE", "a pulse in periodic cells, of a lattice and at random", 1e-5,
     bonds.run_difference("yade", driven.LATTICE, driven.RANDOM)),
    ("yade_bonds", "YADE", "a network whose supports, turning too, and loads follow a ramp, a sine and a table", 1e-5,
     bonds.run_difference("yade", driven.driven(0.01, True))),
    ("yade_bonds", "YADE", "period of the lowest mode", 1e-4, vibration.yade_period),
    ("lammps_grains", "LAMMPS", "places of 20 equal discs that fall in a box, after 0.1 s", 1e-6, grains.motion("lammps")),
    ("lammps_grains", "LAMMPS", "places of 20 discs that a wall pushes at a constant speed", 1e-6,
     grains.motion("lammps", grains.STEADY)),
    ("lammps_grains", "LAMMPS", "the same along a ramp, and to and fro", 1e-3, grains.motion("lammps", *grains.CURVED)),
    ("lammps_grains", "LAMMPS", "overlaps and normal forces when they have settled", 1e-6, grains.lammps_settled(0.0)),
    ("lammps_grains", "LAMMPS", "speed and spin of a disc that slides on a floor until it rolls", 1e-4,
     grains.sliding("lammps")),
    ("lammps_grains", "LAMMPS", "overlaps when they have settled with friction (other levers, see below)", 2e-2,
     grains.lammps_settled(0.3)),
    ("lammps_bonds", "LAMMPS", "places of 20 unequal discs that fall in a box, after 0.1 s (style granular)", 1e-6,
     grains.motion("newer_lammps", radii=grains.GRADED)),
    ("lammps_bonds", "LAMMPS", "speed and spin of a disc that slides on a floor until it rolls (newer LAMMPS)", 1e-4,
     grains.sliding("newer_lammps")),
    ("lammps_bonds", "LAMMPS", "speed and spin of a disc that rolling friction slows", 1e-4,
     grains.sliding("newer_lammps", **grains.ROLLING)),
    ("lammps_bonds", "LAMMPS", "places of 20 equal discs without damping in a box, after 0.05 s", 1e-6,
     grains.motion("newer_lammps", {"duration": 0.05, "restitution": 1.0})),
    ("yade_grains", "YADE", "places of 20 equal discs that fall in a box, after 0.1 s", 1e-6, grains.motion("yade")),
    ("yade_grains", "YADE", "overlaps and normal forces of a settled box of 20 unequal discs", 1e-6,
     grains.yade_settled),
    ("yade_grains", "YADE", "places of 20 discs that a wall pushes, steadily, along a ramp, to and fro", 1e-6,
     grains.motion("yade", *grains.LOSSLESS, way=6e-3)),
    ("yade_grains", "YADE", "speed and spin of a disc that slides on a floor until it rolls", 1e-3, grains.sliding("yade")),
]


def measure(program, group=None):
    """(check, difference) of each; the differences are printed as they come."""
    for check in CHECKS:
        if group is not None and check[0] != group:
            continue
        with tempfile.TemporaryDirectory(prefix="equidem_engines_") as folder:
            value = check[4](program, pathlib.Path(folder))
        print(f"{check[1]}: {check[2]}: {value:.2e}, at most {check[3]:.0e}", flush=True)
        yield check, value


def main():
    program = pathlib.Path(sys.argv[1]).resolve()
    if sys.argv[2] == "--csv":
        with open(sys.argv[3], "w", newline="", encoding="utf-8") as file:
            rows = csv.writer(file, lineterminator="\n")
            rows.writerow(["engine", "compared", "difference", "limit of the test"])
            rows.writerows([check[1], check[2], f"{value:.1e}", f"{check[3]:.0e}"] for check, value in measure(program))
        return 0
    try:
        bad = [check[2] for check, value in measure(program, sys.argv[2]) if not value <= check[3]]
    except engines.Missing as missing:
        print(f"skipped: {missing} is not installed")
        return 77
    for name in bad:
        print(f"FAILED: {name}")
    return 1 if bad else 0


if __name__ == "__main__":
    sys.exit(main())
