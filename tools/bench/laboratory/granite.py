#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""tools/bench/laboratory/granite.py PROGRAM [--sample FOLDER] [--csv FOLDER]

The granite of Potyondy & Cundall (2004), Int. J. Rock Mech. Min. Sci. 41, 1329, two dimensions: --sample writes the discs and bonds of
the cases of data/cases/granite, the same bytes each time; else moduli and strengths of several samples go into tables beside theirs."""

import argparse
import itertools
import json
import math
import os
import random
import sys
import tempfile
from pathlib import Path
from typing import NamedTuple

import numpy

sys.dont_write_bytecode = True
ROOT = Path(__file__).resolve().parents[3]
sys.path[:0] = [str(ROOT / "tools" / "bench" / "peers"), str(ROOT / "docs" / "site")]

import readings  # noqa: E402
import samples  # noqa: E402
import tables  # noqa: E402
import two_ways  # noqa: E402
from common import call, tell  # noqa: E402

CASES = ROOT / "data" / "cases" / "granite"
WIDTH, HEIGHT = 0.0317, 0.0634  # m
DENSITY = 3900 / (WIDTH * HEIGHT)  # discs a square metre, so that the radii are theirs
END = WIDTH / 2 * math.cos(samples.HALF_ANGLE)  # m, half the distance of the plates of the Brazilian disc
DISC_DENSITY = 2630  # kg/m³
MODULUS, RATIO = 62e9, 2.5  # Pa, 1: Ec = Ec_bar, kn/ks = kn_bar/ks_bar
STRENGTH, DEVIATION = 157e6, 36e6  # Pa, normal and shear strength of the bonds, each drawn from a normal distribution
MEAN_RATIO = 0.917  # of 2 r/(r_i + r_j) over the contacts, as in cell.toml
TOUCHING = 1e-5  # gap over the sum of the radii within which discs are bonded
PACK = """schema = "equidem/1"
[packing]
method = "growth"
grains = {grains}
box    = [{width}, {height}]
solid_fraction = "auto"
overlap = 1.0e-6
seed   = {seed}
[packing.radii]
smallest = 0.000275
largest  = 0.0004565
[springs]
kN = 62.0e9
kT = 24.8e9
"""


def processor_seconds():
    """Of this process and of those that it has waited for: other work on the machine does not count."""
    return sum(os.times()[:4])


def gaps_of(discs, k, box):
    """Distances of the centre of a disc from the others and from the walls, less their radii, and the directions away from them."""
    x, y, _ = discs[k]
    away = discs[k, :2] - discs[:, :2]
    distance = numpy.hypot(*away.T)
    distance[k] = math.inf
    gaps = numpy.append(distance - discs[:, 2], [x, y, box[0] - x, box[1] - y])
    return gaps, numpy.vstack([away / distance[:, None], [[1, 0], [0, 1], [-1, 0], [0, -1]]])


def largest_beside(discs, k, box, near=8, steps=60):
    """Where a disc is largest among those around it, near its place: linear programs of three unknowns, one after the other, each in a
    square of a tenth of its radius about the place so far."""
    x, y, r = discs[k]
    bound = numpy.array([[1, 0, 0], [-1, 0, 0], [0, 1, 0], [0, -1, 0]])
    for _ in range(steps):
        discs[k] = x, y, r
        gaps, normals = gaps_of(discs, k, box)
        chosen = numpy.argsort(gaps)[:near]
        rows = numpy.vstack([numpy.column_stack([-normals[chosen], numpy.ones(near)]), bound])
        limits = numpy.append(gaps[chosen], numpy.full(4, 0.1 * r))
        threes = numpy.array(list(itertools.combinations(range(near + 4), 3)))
        regular = abs(numpy.linalg.det(rows[threes])) > 1e-9
        corners = numpy.linalg.solve(rows[threes[regular]], limits[threes[regular]][..., None])[..., 0]
        inside = (corners @ rows.T <= limits + 1e-12 * r).all(axis=1)
        dx, dy, _ = corners[inside][corners[inside, 2].argmax()]
        x, y = x + dx, y + dy
        discs[k] = x, y, r
        r = gaps_of(discs, k, box)[0].min()
        if math.hypot(dx, dy) < 1e-9 * r:
            break
    discs[k] = x, y, r


def touching(discs):
    """Pairs of discs that touch."""
    pairs = []
    for i, (x, y, r) in enumerate(discs[:-1]):
        other = discs[i + 1:]
        near = numpy.hypot(other[:, 0] - x, other[:, 1] - y) <= (1 + TOUCHING) * (other[:, 2] + r)
        pairs += [(i, i + 1 + int(j)) for j in numpy.flatnonzero(near)]
    return pairs


def genesis(program, seed, width=WIDTH, height=HEIGHT):
    """Discs (x, y, r) and contacts: a packing that jams at the least isotropic stress; those with fewer than three contacts grow until
    they have three, as the floaters of the paper. And the number of these."""
    grains = round(DENSITY * width * height)
    packed, _ = samples.packed(program, PACK.format(grains=grains, width=width, height=height, seed=seed))
    discs, box = numpy.array(packed), (width, height)
    contacts = numpy.bincount(numpy.array(touching(discs)).ravel(), minlength=len(discs))
    edges = numpy.column_stack([discs[:, :2], box - discs[:, :2]])
    contacts += (edges <= (1 + TOUCHING) * discs[:, 2:]).sum(axis=1)
    floaters = numpy.flatnonzero(contacts < 3)
    for k in floaters:
        largest_beside(discs, k, box)
    return discs, touching(discs), len(floaters)


class Bonds(NamedTuple):
    """Microproperties: Ec = Ec_bar (Pa), kn/ks = kn_bar/ks_bar, dashpots over the critical ones, whether the bonds carry moments."""
    modulus: float = MODULUS
    ratio: float = RATIO
    damping: float = 0.1
    moments: bool = True

    def rows(self, discs, contacts, seed):
        """Parallel bonds as wide as the smaller disc: area 2 r, moment of inertia 2/3 r³, stiffness Ec/(r_i + r_j) per area, per depth."""
        draw = random.Random(seed)
        for i, j in contacts:
            ri, rj = discs[i][2], discs[j][2]
            r, per_area = min(ri, rj), self.modulus / (ri + rj)
            reduced = DISC_DENSITY * math.pi / (1 / ri**2 + 1 / rj**2)
            normal = 2 * r * per_area
            dashpot = 2 * self.damping * math.sqrt(normal * reduced)
            strengths = [max(draw.gauss(STRENGTH, DEVIATION), 0.0) * 2 * r for _ in range(2)]
            yield i, j, normal, normal / self.ratio, self.moments * per_area * 2 / 3 * r**3, dashpot, dashpot / self.ratio, *strengths

    def settings(self):
        """Of the contacts, which act beside the bonds."""
        return [f"collisions.stiffness={self.modulus}", f"collisions.tangential_ratio={1 / self.ratio}", f"collisions.walls.stiffness={2 * self.modulus}"]


def write(folder, name, discs, groups, bonds):
    samples.write(folder, name, [(*disc, group) for disc, group in zip(discs, groups)])
    head = "i,j,normal_spring,tangential_spring,bending_spring,normal_dashpot,tangential_dashpot,tension,shear\n"
    with open(folder / f"{name}_bonds.csv", "w", encoding="utf-8") as file:
        file.write(head + "".join(f"{i},{j}," + ",".join(f"{value:.6g}" for value in values) + "\n" for i, j, *values in bonds))


def brazilian_of(discs, contacts):
    """The disc about the origin that is cut out of a sample between plates: its loaded ends are flat over 2 samples.HALF_ANGLE."""
    moved = discs - [WIDTH / 2, END, 0]
    kept = numpy.flatnonzero(numpy.hypot(*moved[:, :2].T) <= (WIDTH - moved[:, 2]) / 2)
    number = {int(k): n for n, k in enumerate(kept)}
    return moved[kept], [(number[i], number[j]) for i, j in contacts if i in number and j in number]


def statics(program, folder, discs, contacts):
    """E and nu (plane stress) of the sample with all contacts closed: contact and bond of each as one spring, with the mean 2 r/(r_i +
    r_j), and by bond_width the bending of the bonds alone."""
    bare = Bonds(moments=False)
    ratios = [bond[2] / bare.modulus for bond in bare.rows(discs, contacts, 0)]
    mean = float(numpy.mean(ratios))
    assembly = {"schema": "equidem-assembly/1", "box": [[0, 0], [WIDTH, HEIGHT]], "discs": [list(map(float, disc)) for disc in discs],
                "contacts": [[i, j, 0, 0] for i, j in contacts]}
    (folder / "sample.json").write_text(json.dumps(assembly))
    kN = bare.modulus * (1 + mean)
    (folder / "sample.toml").write_text('schema = "equidem/1"\n[assembly]\nkind = "file"\npath = "sample.json"\nlevers = "radii"\n[springs]\n'
                                        f"kN = {kN}\nkT = {kN / bare.ratio}\nbond_width = {math.sqrt(mean / (1 + mean))}\n")
    found = json.loads(call([program, "homogenize", folder / "sample.toml", "--json", "-", "--quiet"]))
    return [found[name]["plane_stress"] for name in ("young_modulus", "poisson_ratio")]


class Sample:
    """The tests of one sample; its discs are kept in a folder, and read there where they are."""

    def __init__(self, program, folder, seed):
        self.program, self.folder, self.seed = program, folder, seed
        self.seconds, self.discs = {}, {}
        for name, height, offset in (("unconfined", HEIGHT, 0), ("brazilian", 2 * END, 100)):
            path = folder / f"{name}_{seed}.json"
            if not path.is_file():
                start = processor_seconds()
                discs, contacts, floaters = genesis(program, seed + offset, WIDTH, height)
                path.write_text(json.dumps([discs.tolist(), contacts, floaters, processor_seconds() - start]))
            discs, contacts, floaters, self.seconds[name] = json.loads(path.read_text())
            self.discs[name] = numpy.array(discs), contacts, floaters
        self.discs["brazilian"] = brazilian_of(*self.discs["brazilian"][:2])

    def write(self, folder, name, bonds=Bonds()):
        discs, contacts = self.discs[name][:2]
        groups = [samples.gauge_of(x, y, WIDTH, HEIGHT) if name == "unconfined" else "rock" for x, y, _ in discs]
        write(folder, name, discs, groups, bonds.rows(discs, contacts, self.seed))

    def run(self, name, *settings, bonds=Bonds(), slower=1):
        """What the readings of a test find, and its seconds and steps."""
        self.write(self.folder, name, bonds)
        out, time_of = self.folder / name, 1e-3 * slower
        words = [f'grains.path="{out}.csv"', f'bonds.path="{out}_bonds.csv"', 'output.files=["csv"]', *bonds.settings(), *settings,
                 f"schedule.0.times=[0.0,{time_of / 10},{time_of}]", f"run.duration={time_of}", f"output.probe_interval={time_of / 500}"]
        start = processor_seconds()
        result = json.loads(call([self.program, "run", CASES / f"{name}.toml", "--out", out, "--overwrite", "--threads", 1, "--json", "-", "--quiet",
                                  *(part for word in words for part in ("--set", word))]))
        seconds = processor_seconds() - start
        read = readings.unconfined(out, WIDTH) if name == "unconfined" else readings.brazilian(out, WIDTH)
        tell(f"seed {self.seed}, {name} {' '.join(settings)} {bonds} {slower}: {seconds:.1f} s, {read['strength']:.4g} Pa")
        return {**read, "seconds": seconds, "steps": result["steps"]}

    def both(self, *settings, **how):
        return [self.run(name, *settings, **how) for name in ("unconfined", "brazilian")]

    def quasistatic(self):
        """Unconfined strength and seconds, contact and bond as one spring without moments, which breaks at the strength of the bond."""
        discs, contacts = self.discs["unconfined"][:2]
        start = processor_seconds()
        bonds = [(i, j, kN + MODULUS, (kN + MODULUS) / RATIO, *more[-2:]) for i, j, kN, *more in Bonds().rows(discs, contacts, self.seed)]
        peak, _ = two_ways.quasistatic(self.program, self.folder, discs, bonds, (WIDTH, HEIGHT), True, 0.0, 3e-4)
        return peak, processor_seconds() - start


def calibrated(program):
    """Bonds with the springs that one command finds for the values of the laboratory, and its report."""
    start = processor_seconds()
    found = json.loads(call([program, "calibrate", CASES / "calibrated.toml", "--json", "-", "--quiet"]))
    share = found["kN"] / (1 + MEAN_RATIO)
    return Bonds(modulus=share, ratio=found["kN"] / found["kT"]), processor_seconds() - start


def spread(values, scale=1.0, digits=1):
    """Mean and standard deviation of the samples, as theirs."""
    values = numpy.array(values) * scale
    return f"{values.mean():.{digits}f} ± {values.std(ddof=1):.{digits}f}" if len(values) > 1 else f"{values.mean():.{digits}f}"


def table_of_samples(program, folder, seeds, csv):
    rows, times = [], []
    for seed in seeds:
        sample = Sample(program, folder, seed)
        discs, contacts, floaters = sample.discs["unconfined"]
        start = processor_seconds()
        closed = statics(program, folder, discs, contacts)
        by_statics = processor_seconds() - start
        quiet, held_s = sample.quasistatic()
        pressed, split = sample.both()
        rows.append([seed, floaters, 2 * len(contacts) / len(discs), *closed, pressed["young_modulus"], pressed["poisson_ratio"], pressed["strength"],
                     split["strength"], quiet])
        times.append([*sample.seconds.values(), by_statics, held_s, pressed["seconds"], split["seconds"]])
    tables.write_rows(csv / "samples.csv", ["seed", "floaters", "contacts of a disc", "E with all contacts closed, Pa", "nu likewise", "E, Pa", "nu",
                                            "unconfined strength, Pa", "Brazilian strength, Pa", "unconfined strength by quasistatic, Pa"],
                      [[f"{value:.5g}" for value in row] for row in rows])
    _, floaters, z, closed, closed_nu, young, nu, pressed, split, quiet = zip(*rows)
    packed, packed_disc, by_statics, held, ran, ran_disc = numpy.mean(times, axis=0)
    tables.write_rows(csv / "beside_theirs.csv", ["", "theirs", "ours", "processor time of one sample, s"], [
        ["genesis: contacts of a disc", "", f"{spread(z, 1, 3)}, {spread(floaters, 1, 0)} floaters", f"{packed:.0f}"],
        ["E by statics, all contacts closed, GPa", "", spread(closed, 1e-9), f"{by_statics:.1f}"],
        ["nu likewise", "", spread(closed_nu, 1, 4), ""],
        ["E, GPa", "70.9 ± 0.9", spread(young, 1e-9), f"{ran:.0f}"],
        ["nu", "0.237 ± 0.011", spread(nu, 1, 3), ""],
        ["unconfined strength, MPa", "199.1 ± 13.0", spread(pressed, 1e-6), ""],
        ["Brazilian strength, MPa", "44.7 ± 3.3", spread(split, 1e-6), f"{ran_disc:.0f}, and {packed_disc:.0f} of genesis"],
        ["ratio of both", "4.5", spread(numpy.divide(pressed, split), 1, 2), ""],
        ["unconfined strength by quasistatic, one spring, no moments, MPa", "", spread(quiet, 1e-6), f"{held:.0f}"]])


def table_of_variants(program, folder, seeds, csv):
    laboratory, seconds = calibrated(program)
    variants = {"as above": {}, "closing twice as fast": {"slower": 0.5}, "closing half as fast": {"slower": 2},
                "bonds without dashpots": {"bonds": Bonds(damping=0.0)}, "dashpots of 50 %": {"bonds": Bonds(damping=0.5)},
                "bonds without moments": {"bonds": Bonds(moments=False)},
                "contacts only where the bond has broken": {"settings": ["strength.after_breaking=none"]},
                f"springs for E = 69 GPa, nu = 0.26 by calibrate in {seconds:.0f} s: Ec = {laboratory.modulus / 1e9:.1f} GPa, kn/ks = {laboratory.ratio:.2f}":
                    {"bonds": laboratory}}
    rows = []
    for label, how in variants.items():
        reads = [Sample(program, folder, seed).both(*how.get("settings", []), **{key: how[key] for key in how if key != "settings"}) for seed in seeds]
        pressed, split = ([read[k] for read in reads] for k in (0, 1))
        rows.append([label, *(spread([read[name] for read in pressed], scale, digits)
                              for name, scale, digits in (("young_modulus", 1e-9, 1), ("poisson_ratio", 1, 3), ("strength", 1e-6, 1))),
                     spread([read["strength"] for read in split], 1e-6), spread([a["strength"] / b["strength"] for a, b in zip(pressed, split)], 1, 2)])
        tables.write_rows(csv / "variants.csv", ["", "E, GPa", "nu", "unconfined, MPa", "Brazilian, MPa", "ratio"], rows)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program", type=Path)
    parser.add_argument("--sample", type=Path, help="folder for the discs and bonds of the cases")
    parser.add_argument("--csv", type=Path, help="folder of the tables")
    parser.add_argument("--seeds", type=int, default=10, help="number of samples")
    parser.add_argument("--variants", type=int, default=3, help="number of samples of each variant")
    parser.add_argument("--keep", type=Path, help="folder in which the discs of the samples are kept, and read where they are")
    request = parser.parse_args()
    program = request.program.resolve()
    with tempfile.TemporaryDirectory() as name:
        folder = (request.keep or Path(name)).resolve()
        if request.sample:
            sample = Sample(program, folder, 1)
            for test in ("unconfined", "brazilian"):
                sample.write(request.sample, test)
        if request.csv:
            table_of_samples(program, folder, range(1, request.seeds + 1), request.csv)
            table_of_variants(program, folder, range(1, request.variants + 1), request.csv)


if __name__ == "__main__":
    main()
