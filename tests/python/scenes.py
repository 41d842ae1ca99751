# SPDX-License-Identifier: GPL-3.0-or-later
"""Folders, blocks and springs of several tests of the module."""
import pathlib

import equidem as eq

SOURCE = pathlib.Path(__file__).resolve().parents[2]
CASES, PACKINGS, STUDIES = (SOURCE / "data" / name for name in ("cases", "packings", "studies"))
BLOCK = eq.hexagonal(columns=7, rows=7, radius=1e-3)
CELL = eq.hexagonal(columns=4, rows=4, radius=1e-3, periodic=True)
SPRINGS = eq.Springs(kN=1e9, kT=0.5e9)
HELD = [{"group": "left", "ux": 0, "uy": 0}]
PULLED = {"kind": "uniaxial_tension", "stress": 1e6}


def hexagonal(columns, rows, radius=1e-3, **more):
    return eq.hexagonal(columns=columns, rows=rows, radius=radius, **more)


def tension(radius=1e-3):
    """A case of a block that is pulled."""
    return eq.Case(assembly=hexagonal(7, 7, radius), springs=(1e9, 0.5e9), test=PULLED)
