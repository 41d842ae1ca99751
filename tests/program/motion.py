# SPDX-License-Identifier: GPL-3.0-or-later
"""Cases of motion in time, for the tests of equidem run."""
import csv
import json
import math

import h5py
import numpy

from program import CASES, ProgramTest, equidem, parse_json

CORNER, PULSE, SHAKE, REST = (CASES / f"run_{name}.toml" for name in ("corner", "pulse", "shake", "tension"))
KN, DENSITY, RADIUS = 1e9, 2650.0, 0.005
MASS = DENSITY * math.pi * RADIUS**2


def table(path):
    """Columns of a CSV file of numbers."""
    with open(path, newline="") as file:
        rows = list(csv.reader(file))
    return dict(zip(rows[0], numpy.array(rows[1:], dtype=float).T))


def datasets(path):
    found = {}
    with h5py.File(path, "r") as file:
        file.visititems(lambda name, item: found.update({name: item[()].tobytes()})
                        if isinstance(item, h5py.Dataset) else None)
    return found


class RunTest(ProgramTest):
    def run_case(self, case, *options):
        return parse_json(self.check_done(equidem("run", case, "--threads", 1, "--json", "-", *options)).stdout)

    def write_case(self, discs, contacts, text, cell=None):
        """A case of bonded discs of one size, and a group d0, d1, ... for each."""
        (self.folder / "assembly.json").write_text(json.dumps(
            {"schema": "equidem-assembly/1", "cell": cell, "discs": [[x, y, RADIUS] for x, y in discs],
             "contacts": contacts}))
        groups = "".join(f'[[group]]\nname = "d{k}"\ndiscs = [{k}]\n' for k in range(len(discs)))
        case = self.folder / "case.toml"
        case.write_text(f'schema = "equidem/1"\n[assembly]\nkind = "file"\npath = "assembly.json"\n'
                        f'density = {DENSITY}\n{groups}{text}')
        return case

    def history(self, case, *options):
        out = self.folder / "history"
        self.run_case(case, "--out", out, "--overwrite", "--set", "output.picture=false", *options)
        return table(out / "history.csv")

    def check_near(self, computed, expected, tolerance):
        """Every entry, relative to the largest."""
        size, error = numpy.abs(expected).max(), numpy.abs(computed - expected).max()
        self.assertGreater(size, 0)
        self.assertLessEqual(error, tolerance * size, f"{error / size:.2e}")
