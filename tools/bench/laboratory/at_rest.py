# SPDX-License-Identifier: GPL-3.0-or-later
"""The packing in which a run between four plates has ended, as an assembly with its forces at rest."""

import csv
import json
import math
from pathlib import Path

import numpy

import readings

SPRINGS = (1e8, 5e7)  # Pa, of the cases of sand
SIDES = {"left": (-1, 0), "right": (1, 0), "bottom": (0, -1), "top": (0, 1)}


def largest_piece(discs, contacts):
    """The discs of the largest set that contacts hold together."""
    leader = list(range(discs))

    def of(disc):
        while leader[disc] != disc:
            leader[disc] = disc = leader[leader[disc]]
        return disc

    for i, j in contacts:
        leader[of(i)] = of(j)
    pieces = {}
    for disc in range(discs):
        pieces.setdefault(of(disc), set()).add(disc)
    return max(pieces.values(), key=len)


class Packing:
    def __init__(self, folder):
        self.folder = Path(folder)
        tables = {}
        for name in ("grains", "contacts"):
            with open(self.folder / f"{name}.csv", newline="", encoding="utf-8") as file:
                tables[name] = list(csv.DictReader(file))
        self.discs = [[float(row[name]) for name in ("x_m", "y_m", "radius_m")] for row in tables["grains"]]
        self.touching = [(int(row["i"]), int(row["j"]), float(row["overlap_m"]), -float(row["normal_force_N_per_m"]),
                          -float(row["tangential_force_N_per_m"])) for row in tables["contacts"] if not row["wall"]]
        # a disc that leans on a plate alone bears nothing, nor do some that touch one another only
        bearing = largest_piece(len(self.discs), [contact[:2] for contact in self.touching])
        self.touching = [contact for contact in self.touching if contact[0] in bearing]
        self.on_plates = [(int(row["i"]), row["wall"], float(row["overlap_m"]), -float(row["normal_force_N_per_m"]))
                          for row in tables["contacts"] if row["wall"] and int(row["i"]) in bearing]
        read = readings.history(self.folder)
        at = {side: float(read[f"wall_{side}_{'x' if side in ('left', 'right') else 'y'}_m"][-1]) for side in SIDES}
        self.low, self.high = (at["left"], at["bottom"]), (at["right"], at["top"])

    def _assembly(self):
        return {"schema": "equidem-assembly/1", "box": [self.low, self.high], "discs": list(self.discs),
                "contacts": [[i, j, 0, 0] for i, j, *_ in self.touching],
                "levers": [[self.discs[i][2] - overlap / 2, self.discs[j][2] - overlap / 2] for i, j, overlap, *_ in self.touching],
                "forces": [[normal, across] for *_, normal, across in self.touching], "springs": [list(SPRINGS) for _ in self.touching]}

    def _write(self, name, assembly, case):
        (self.folder / f"{name}.json").write_text(json.dumps(assembly))
        path = self.folder / f"{name}.toml"
        path.write_text(f'schema = "equidem/1"\n[assembly]\nkind = "file"\npath = "{name}.json"\n{case}')
        return path

    def homogenized(self, program, call):
        """(E along y, nu) in plane stress, with the discs at the boundary moved by a mean strain."""
        case = self._write("packing", self._assembly(), "")
        stiffness = json.loads(call([program, "homogenize", case, "--json", "-", "--quiet"]))["stiffness"]
        # Uniaxial stress along y, without shear stress: the strains of s = (0, 1, 0).
        exx, eyy, _ = numpy.linalg.solve(stiffness, (0, 1, 0))
        return 1 / eyy, -exx / eyy

    def between_plates(self, program, call, strain=1e-8):
        """(E along y, nu) at a constant stress on the sides, by statics: each contact with a plate is a spring along the normal to a
        flat disc that stands still or moves with the plate. What plates leave to slip must not carry friction at rest: those forces,
        1e-3 of the others after a consolidation without friction, are left out."""
        assembly, groups = self._assembly(), {side: [] for side in SIDES}
        assembly["forces"] = [[normal, 0.0] for normal, _ in assembly["forces"]]
        assembly["curvatures"] = [[1 / self.discs[i][2], 1 / self.discs[j][2]] for i, j, *_ in self.touching]
        for i, side, overlap, normal in self.on_plates:
            x, y, radius = self.discs[i]
            lever = radius - overlap
            groups[side].append(len(assembly["discs"]))
            assembly["contacts"].append([i, len(assembly["discs"]), 0, 0])
            assembly["discs"].append([x + 2 * lever * SIDES[side][0], y + 2 * lever * SIDES[side][1], lever])
            for key, value in (("levers", [lever, lever]), ("forces", [normal, 0.0]), ("springs", [SPRINGS[0], 0.0]), ("curvatures", [1 / radius, 0.0])):
                assembly[key].append(value)
        assembly["groups"] = groups
        del assembly["box"]
        sides = self.high[0] - self.low[0], self.high[1] - self.low[1]
        stiffness = {}
        for axis in (0, 1):
            case = '[effects]\nprestress = "on"\n'
            for side, normal in SIDES.items():
                ways = [normal[k] * strain * sides[k] / 2 if k == axis else 0.0 for k in (0, 1)]
                case += f'[[support]]\ngroup = "{side}"\nux = {ways[0]!r}\nuy = {ways[1]!r}\nrotation = 0.0\n'
            out = self.folder / f"plates{axis}"
            call([program, "solve", self._write("plates", assembly, case), "--out", out, "--overwrite", "--quiet"])
            pulled = _forces_of(out, {side: [assembly["discs"][disc][:2] for disc in groups[side]] for side in SIDES})
            for _, side, _, normal in self.on_plates:
                pulled[side] -= normal  # contacts.csv holds the forces in total
            stiffness[axis] = [(pulled[low] + pulled[high]) / 2 / sides[1 - k] / strain for k, (low, high) in enumerate((("left", "right"), ("bottom", "top")))]
        (xx, yx), (xy, yy) = stiffness[0], stiffness[1]
        return yy - yx * xy / xx, xy / xx


def _forces_of(folder, places):
    """Sums of the normal forces of the discs at these places: those that touch nothing are not there."""
    tables = {}
    for name in ("discs", "contacts"):
        with open(folder / f"{name}.csv", newline="", encoding="utf-8") as file:
            tables[name] = list(csv.DictReader(file))
    numbers = {(round(float(row["x_m"]), 10), round(float(row["y_m"]), 10)): int(row["disc"]) for row in tables["discs"]}
    forces = {}
    for row in tables["contacts"]:
        for end in (int(row["i"]), int(row["j"])):
            forces[end] = forces.get(end, 0) + float(row["normal_force_N_per_m"])
    return {name: math.fsum(forces.get(numbers.get((round(x, 10), round(y, 10))), 0) for x, y in those) for name, those in places.items()}

