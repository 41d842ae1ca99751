#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""tools/bench/laboratory/two_ways.py --build FOLDER --csv FILE

The unconfined strength of the rock of grains_unconfined.toml, its bonds without moments, by `run` at several speeds and dashpots and by
`quasistatic`: the same discs, bonds, springs, strengths and plates, on several samples."""

import argparse
import csv
import json
import math
import sys
import tempfile
from pathlib import Path

sys.dont_write_bytecode = True
ROOT = Path(__file__).resolve().parents[3]
sys.path[:0] = [str(ROOT / "tools" / "bench" / "peers"), str(ROOT / "docs" / "site")]

import ensembles  # noqa: E402
import page  # noqa: E402
import readings  # noqa: E402
import samples  # noqa: E402
import several  # noqa: E402
import tables  # noqa: E402
from common import call  # noqa: E402

CLOSING = 4e-4  # m, of each plate, over the time of the run
TIMES = (0.016, 0.032, 0.064, 0.128)  # s
DASHPOTS = (450.0, 180.0)  # N s/m, a tenth of the critical ones
AT_PLATES = 2e-6  # m, gap within which a disc bears on its plate from the start


def quasistatic(program, folder, discs, bonds, box, springs, friction, motion, after="gone"):
    """Peak and first break (Pa) between plates without friction that close by control of the motion.
    \\param bonds (i, j, kN, kT, tension, shear)"""
    def levers(i, j):
        distance = math.hypot(discs[j][0] - discs[i][0], discs[j][1] - discs[i][1])
        share = discs[i][2] / (discs[i][2] + discs[j][2])
        return share * distance, (1 - share) * distance

    lower = [k for k, (_, y, r) in enumerate(discs) if y - r < AT_PLATES]
    upper = [k for k, (_, y, r) in enumerate(discs) if y + r > box[1] - AT_PLATES]
    assembly = {"schema": "equidem-assembly/1", "box": [[0, 0], box], "discs": [list(map(float, disc)) for disc in discs],
                "contacts": [[i, j, 0, 0] for i, j, *_ in bonds], "levers": [levers(i, j) for i, j, *_ in bonds],
                "strengths": [bond[4:6] for bond in bonds], "groups": {"lower": lower, "upper": upper, "corner": lower[:1]}}
    if springs:
        assembly["springs"] = [bond[2:4] for bond in bonds]
    (folder / "plates.json").write_text(json.dumps(assembly))
    uniform = "" if springs else f"[springs]\nkN = {bonds[0][2]}\nkT = {bonds[0][3]}\n"
    supports = "".join(f'[[support]]\ngroup = "{group}"\n{way}\n' for group, way in (("lower", "uy = 0.0"), ("corner", "ux = 0.0"), ("upper", f"uy = {-motion}")))
    legs = "legs = [1.0]\n" if after == "frictional" else ""
    (folder / "plates.toml").write_text(
        f'schema = "equidem/1"\n[assembly]\nkind = "file"\npath = "plates.json"\n{uniform}[strength]\nfriction = {friction}\nafter_breaking = "{after}"\n'
        f'{supports}[quasistatic]\ncontrol = "motion"\n{legs}[output]\nfiles = ["csv"]\n')
    call([program, "quasistatic", folder / "plates.toml", "--out", folder / "plates", "--overwrite", "--quiet"])
    with open(folder / "plates" / "curve.csv", newline="", encoding="utf-8") as file:
        loads = [float(row["load_N_m"]) / box[0] for row in csv.DictReader(file) if row["series"] == "events"]
    return max(loads), next(load for load in loads if load > 0)


def strengths(lab, seed):
    """Of one sample: {name: Pa}."""
    discs, contacts = samples.rock(lab.equidem, seed=seed)
    taken = ensembles.sample(lab, f"ways{seed}_sample", discs, contacts)
    found = {}
    for part in (0, 0.1, 1):
        dashpots = [f"bonds.{name}_dashpot={10 * part * one}" for name, one in zip(("normal", "tangential"), DASHPOTS)]
        for time in TIMES:
            out, _, _ = lab.run("unconfined", *taken, "bonds.bending_spring=none", *dashpots, f"wall.0.displacement={CLOSING}", f"wall.1.displacement={CLOSING}",
                                f"schedule.0.times=[0.0,{time / 10},{time}]", f"run.duration={time}", f"output.probe_interval={time / 500}")
            found[part, time] = readings.unconfined(out, samples.ROCK[0])["strength"]
    bare = [(x, y, r) for x, y, r, _ in discs]
    width = [2 * min(bare[i][2], bare[j][2]) for i, j in contacts]
    bonds = [(i, j, 2e9, 8e8, 4e6 * w, 8e6 * w) for (i, j), w in zip(contacts, width)]
    for after in ("gone", "frictional"):
        found[after], found["first"] = quasistatic(lab.equidem, lab.folder, bare, bonds, samples.ROCK, False, 0.5, 2 * CLOSING, after)
    return found


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--build", type=Path, required=True)
    parser.add_argument("--csv", type=Path, required=True)
    request = parser.parse_args()
    with tempfile.TemporaryDirectory() as name:
        lab = page.Laboratory(request.build.resolve() / "tools" / "equidem", Path(name))
        each = [strengths(lab, seed) for seed in ensembles.ROCK_SEEDS]

    def row(label, keys, blank=0):
        return [label, *("" for _ in range(blank)), *(several.both([one[key] / 1e6 for one in each]) for key in keys)]

    head = ["way", *(f"{2 * CLOSING / samples.ROCK[1] / time:.3g} of strain a second" for time in TIMES)]
    rows = [row(f"run, {label}", [(part, time) for time in TIMES]) for part, label in ((0, "no dashpots"), (0.1, "dashpots of 10 %"), (1, "critical dashpots"))]
    rows += [row(label, [key], 3) for label, key in (("quasistatic, first break", "first"), ("quasistatic, broken contacts gone", "gone"),
                                                       ("quasistatic, broken contacts frictional", "frictional"))]
    tables.write_rows(request.csv, head, rows)


if __name__ == "__main__":
    main()
