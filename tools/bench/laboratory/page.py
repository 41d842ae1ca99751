#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""tools/bench/laboratory/page.py --build FOLDER [--samples | --peers] [--page FILE]

Runs the cases of the laboratory and writes what they give beside what is expected; with --samples the same on several samples each, and
over their size; with --peers the tests in YADE, one core each, with their times. Each section of the page is made anew by its own call."""

import argparse
import json
import math
import sys
import tempfile
import time
from pathlib import Path

import numpy

sys.dont_write_bytecode = True
ROOT = Path(__file__).resolve().parents[3]
sys.path.insert(0, str(ROOT / "tools" / "bench" / "peers"))

import ensembles  # noqa: E402
import readings  # noqa: E402
import samples  # noqa: E402
import several  # noqa: E402
from common import Failure, call, number, result_of, table, tell  # noqa: E402

CASES, SCRIPT = ROOT / "data" / "cases", ROOT / "tools" / "bench" / "peers" / "laboratory_yade.py"
TITLE = "# The laboratory\n"
HEADINGS = ("## The tests beside what is expected\n", "## Several samples\n", "## Beside YADE\n")
PILE_SEEDS = (3, 4, 8)
OPENINGS = (0.032, 0.040, 0.048, 0.056, 0.064)
HEAP_DIAMETER = 0.004  # m, mean of lab_heap.csv
HEAP_SOLID_FRACTION = 0.846  # area of discs in the middle of the column of lab_heap.csv, over that of the part


REMARKS = """
The biaxial test and the shear box start from one packing at rest. From loose sand the two programs find other packings: without friction
it is the paths of the discs that decide where they jam, and these diverge. The angle at the peak then differs as between two
samples, by some degrees with 445 discs. The Brazilian disc of YADE bears more as local damping holds what splits: with 0.02 in place
of 0.2 it breaks at 1.83e6 Pa. With the few discs of the beam the time is that of the calls from Python.

The rows of YADE are those of scripts of ours with its engines (`tools/bench/peers/laboratory_yade.py`), since the examples of its package
(2023.02a) are three-dimensional: `concrete/brazilian.py` and `concrete/uniax.py` split and press spheres with a law of damage, the
biaxial test is `triax-tutorial`, `clumps/clump-hopper-test.py` and `DEM2020Benchmark/Case1_SiloFlow.py` empty a bunker and a silo,
`PeriodicBoundaries/periodicSandPile.py` heaps spheres, and `cylinders/bendingbeams.py` bends beams of cylinders under their weight.
`PeriodicBoundaries/periodic-simple-shear.py` shears a periodic cell; a shear box of two halves is not among them.

YADE is the better choice for tests that you program: its scripts stop, change and measure anything in Python between steps, its servo
walls work in three dimensions, and its package brings tests of this kind in 3D. Its bonds break in tension and shear; the moments of
CohFrictMat yield.
"""


class Laboratory:
    def __init__(self, equidem, folder):
        self.equidem, self.folder = equidem, folder

    def run(self, name, *settings):
        """(folder, result, seconds) of a case on one thread."""
        out = self.folder / f"{name}{len(list(self.folder.iterdir()))}"
        words = [word for setting in settings for word in ("--set", setting)]
        start = time.monotonic()
        text = call([self.equidem, "run", CASES / f"grains_{name}.toml", "--out", out, "--threads", 1, "--json", "-", "--quiet", "--set",
                     "output.files=['csv', 'vtk']", *words])
        seconds = time.monotonic() - start
        tell(f"{name} {' '.join(settings)}: {seconds:.1f} s")
        return out, json.loads(text), seconds


def degrees(value):
    return f"{value:.1f}°"


def sand(lab):
    out, _, _ = lab.run("biaxial")
    plain = readings.biaxial(out)
    out, _, _ = lab.run("shear_box")
    box = readings.shear_box(out)
    rows = [["biaxial compression, angle of friction at the peak", degrees(plain["peak"]), degrees(plain["rowe"]),
             f"Rowe (1962): s1/s2 = K (1 + D), K = {number(plain['factor'])} beyond 8 % of strain"],
            ["the same, beyond 8 % of strain", degrees(plain["late"]), "", f"volume {100 * plain['volume']:+.2f} %"],
            ["dilation D at the peak", number(plain["dilation"]), "", f"at {100 * plain['strain']:.1f} % of strain"],
            ["side stress, Pa", f"{plain['side'][0]:.5g} to {plain['side'][1]:.5g}", "1e+05", "of the servo walls"],
            ["direct shear box, angle in the plane at the peak", degrees(box["peak"]), degrees(box["taylor"]),
             f"Taylor (1948): T/N - dy/dx = {number(math.tan(math.radians(box['late'])) - box['dilation_at_the_end'])} as over the last quarter; dy/dx = "
             f"{number(box['dilation'])}"],
            ["the same, over the last quarter", degrees(box["late"]), degrees(math.degrees(math.atan(math.sin(math.radians(plain["late"]))))),
             "tan φ = sin φ_cv of the biaxial test: no extension along the plane, coaxial (Davis 1968)"]]
    return rows


def rock(lab):
    moduli = json.loads(call([lab.equidem, "homogenize", CASES / "lab_rock.toml", "--json", "-", "--quiet"]))
    young, nu = (moduli[name]["plane_stress"] for name in ("young_modulus", "poisson_ratio"))
    out, _, _ = lab.run("unconfined")
    plain = readings.unconfined(out, 0.04)
    out, _, _ = lab.run("unconfined", "collisions.walls.friction=0.5")
    rough = readings.unconfined(out, 0.04)
    out, result, _ = lab.run("brazilian")
    split = readings.brazilian(out, 0.05)
    across, along = readings.stress_at_the_centre(out, 0.05, float(readings.rows_of_breaks(out)[0]["time_s"]))
    theory = readings.hondros(samples.HALF_ANGLE, ensembles.PROBE)
    crack = readings.breaks_near_the_diameter(out, split["time"] + 2e-4)
    return [["unconfined compression, E, Pa", number(plain["young_modulus"], 4), number(young, 4), "homogenize lab_rock.toml, its edge included: below"],
            ["the same, nu", number(plain["poisson_ratio"]), number(nu), "likewise"],
            ["unconfined strength, Pa", number(plain["strength"], 4), "", f"at a strain of {100 * plain['strain']:.2f} %"],
            ["the same, plates with friction 0.5", number(rough["strength"], 4), "", "held ends"],
            ["stress across the loaded diameter at the centre, before the first break, over 2P/(pi D)", number(across), number(theory[0]),
             "Hondros (1959), uniform pressure on arcs of 20°, in a square of 0.48 radii"],
            ["the same, along it", number(along), number(theory[1]), "likewise"],
            ["Brazilian strength 2P/(pi D), Pa", number(split["strength"], 4), "", f"1/{number(plain['strength'] / split['strength'])} of "
             f"the unconfined one; {result['breaks']['number']} bonds broke in all"],
            ["share of the breaks within 5 mm of the loaded diameter", number(crack["near"]), "", f"of {crack['breaks']} up to 0.2 ms "
             "behind the peak; 25 % of the area lie there"]]


def beam(lab):
    out, _, _ = lab.run("bonded_beam")
    read, theory = readings.beam(out, 0.35, 1, 4), readings.row_of_discs(20, 0.01, 1e5 / 12, 4e8, 0.005)
    loss = theory["loss_over_square"] * read["amplitude"] ** 2
    out, _, _ = lab.run("bonded_beam", "wall.2.displacement=5e-4", "run.duration=0.1")
    broken = readings.history(out)["wall_load_force_y_N_per_m"].max()
    return [["bonded beam, load over deflection, N/m²", number(read["stiffness"], 6), number(theory["stiffness"], 6),
             "row of discs in series, by hand"],
            ["the same", "", number(1 / (0.2**3 / (48 * 1e5 / 12 * 0.01) + 0.2 / (4 * 4e6)), 6), "beam: L³/(48 EI) + L/(4 GA), EI = kM l, GA = kT l"],
            ["area of the loop of a cycle, J/m", number(read["loop"], 4), number(loss, 4), "π (loss factor) K a²"],
            ["dissipated in a cycle by the ledger, J/m", number(read["lost"], 4), number(loss, 4), "likewise"],
            ["load at which it breaks, N/m", number(broken, 4), number(2 / 0.095 * 4e3 * 0.01 / 6, 4), "6 M/w = tension at the bonds beside the middle"]]


def hopper(lab):
    rates = []
    for opening in OPENINGS:
        out, _, _ = lab.run("hopper", f"stage.1.wall.1.end=[{0.075 - opening / 2:.4f},0.0]",
                            f"stage.1.wall.2.point=[{0.075 + opening / 2:.4f},0.0]")
        rates.append(readings.discharge(out))
    measured = [one["rate"] for one in rates], [one["error"] for one in rates]
    law = readings.power_law(OPENINGS, *measured)
    openings = [[f"{1e3 * opening:.0f}", number(opening / HEAP_DIAMETER), f"{one['rate']:.0f} ± {one['error']:.0f}",
                 f"{law['factor'] * (opening - law['closed']) ** 1.5:.0f}"] for opening, one in zip(OPENINGS, rates)]
    powers = [[power, number(one["misfit"]), number(one["closed"] / HEAP_DIAMETER)]
              for power in (1, 1.5, 2, 2.5) for one in [readings.power_law(OPENINGS, *measured, power)]]
    return openings, powers, law


def tests(lab, command):
    rows = sand(lab) + rock(lab) + beam(lab)
    openings, powers, law = hopper(lab)
    area = math.pi * HEAP_DIAMETER**2 / 4
    factor = law["factor"] * area / HEAP_SOLID_FRACTION / math.sqrt(9.81)
    return (f"{HEADINGS[0]}\n    {command}\n\nEach row is read from the histories of a case of `data/cases` by `tools/bench/laboratory/readings.py`; "
            "an empty cell\nhas no theory. One sample each; with its 445 discs the angles of the sand scatter by some degrees (several samples: below).\n\n"
            + table(["test", "read", "expected", "from"], rows)
            + "\n\nDischarge over the opening W, `grains_hopper.toml`, bodies in a second between the 100th and the 900th that leave, standard errors\n"
            f"from four parts of the time; Beverloo's law in two dimensions, C (W - k d)^(3/2), with k = {number(law['closed'] / HEAP_DIAMETER)} and, the "
            f"solid fraction in the silo\nbeing {HEAP_SOLID_FRACTION}, C = {number(factor)} sqrt(g). The fit of other powers p with a k of their own has "
            "this chi squared per\ndegree of freedom.\n\n"
            + table(["W, mm", "W/d", "bodies a second", "3/2 power"], openings) + "\n\n" + table(["p", "chi squared", "k"], powers) + "\n")


def of_several_samples(lab, command):
    return f"{HEADINGS[1]}\n    {command}\n\nMeans and their standard errors.\n\n" + several.section(lab)


def peer(test, sample, step, *more):
    return result_of(call(["yade", "-n", "-x", "-j1", SCRIPT, test, CASES / sample, repr(step), *map(str, more)]))


def sine(row):
    _, _, axial, side = row
    return (axial - side) / (axial + side)


def biaxial_of(theirs, rows=37):
    """Angles of friction (degrees) at the peak and, where it goes so far, beyond 8 per cent of strain; rows of 0.8 ms, means over 30 ms
    as in the readings."""
    sines = readings.smooth([sine(row) for row in theirs["curve"]], rows)
    late = [sine(row) for row in theirs["curve"] if row[0] > 0.08]
    return [math.degrees(math.asin(one)) for one in (max(sines), *([sum(late) / len(late)] if late else []))]


def packing_at_rest(lab, name, *settings):
    """Discs (CSV) and places of the walls where the sand has its friction and has come to rest."""
    until = "stage.2.until.displacement=1e-8" if name == "shear_box" else "stage.2.until.strain=1e-8"
    out, _, _ = lab.run(name, *settings, until)
    discs = readings.columns_without_text(out / "grains.csv", ("x_m", "y_m", "radius_m"))
    samples.write(lab.folder, f"{out.name}_rest", [(*disc, "grains") for disc in zip(*discs.values())])
    last = {column: values[-1] for column, values in readings.history(out).items()}
    return lab.folder / f"{out.name}_rest.csv", last


class Pairs:
    """Rows of the table: a test in equidem and in YADE."""

    def __init__(self):
        self.rows = []

    def add(self, test, what, ours, seconds, steps, theirs, found):
        ratio = theirs["seconds"] / theirs["steps"] / (seconds / steps)
        self.rows.append([test, what, ours, found, f"{seconds:.1f}", f"{theirs['seconds']:.1f}", number(ratio)])
        tell(f"{test}: YADE {theirs['seconds']:.1f} s")


def sand_pairs(lab, pairs):
    rest, walls = packing_at_rest(lab, "biaxial")
    out, result, seconds = lab.run("biaxial")
    theirs = peer("biaxial", rest, result["time_step"], *(walls[f"wall_{side}_m"] for side in ("left_x", "bottom_y", "right_x", "top_y")))
    read = readings.biaxial(out)
    pairs.add("biaxial, the same packing at rest", "φ at the peak, beyond 8 %", f"{degrees(read['peak'])}, {degrees(read['late'])}", seconds,
              result["steps"], theirs, ", ".join(map(degrees, biaxial_of(theirs))))
    loose = [ensembles.sample(lab, f"loose{seed}_sample", samples.sand(lab.equidem, seed)) for seed in ensembles.SAND_SEEDS]
    ours = [readings.biaxial(lab.run("biaxial", *settings)[0])["peak"] for settings in loose]
    found = [biaxial_of(peer("biaxial", lab.folder / f"loose{seed}_sample.csv", result["time_step"]))[0] for seed in ensembles.SAND_SEEDS]
    pairs.rows.append(["biaxial, eight loose samples", "φ at the peak", several.both(ours) + "°", several.both(found) + "°", "", "", ""])
    rest, walls = packing_at_rest(lab, "shear_box")
    out, result, seconds = lab.run("shear_box")
    theirs = peer("shear_box", rest, result["time_step"], walls["wall_lid_y_m"])
    read, rows = readings.shear_box(out), 62
    moved, _, ratio = map(numpy.array, zip(*theirs["curve"]))
    ratios = max(readings.smooth(ratio, rows)), float(ratio[moved > 0.75 * moved[-1]].mean())
    pairs.add("shear box, the same packing at rest", "φ in the plane, at the peak and over the last quarter", f"{degrees(read['peak'])}, {degrees(read['late'])}",
              seconds, result["steps"], theirs, ", ".join(degrees(math.degrees(math.atan(one))) for one in ratios))


def rock_pairs(lab, pairs):
    for name, bonds, scale, unit in (("unconfined", "lab_rock", 1 / 0.04, "strength, Pa"), ("brazilian", "lab_brazilian", 2 / (math.pi * 0.05), "2P/(pi D), Pa")):
        out, result, seconds = lab.run(name, "bonds.bending_spring=none")
        theirs = peer(name, f"{bonds}.csv", result["time_step"], CASES / f"{bonds}_bonds.csv")
        read = readings.unconfined(out, 0.04) if name == "unconfined" else readings.brazilian(out, 0.05)
        found = scale * max(readings.smooth([force for _, force in theirs["curve"]], 3))
        pairs.add(f"{name}, bonds without moments", unit, number(read["strength"]), seconds, result["steps"], theirs, number(found))
    out, result, seconds = lab.run("bonded_beam", "run.duration=0.1")
    read = readings.history(out)
    theirs = peer("beam", "lab_beam.csv", result["time_step"])
    bent, load = map(numpy.array, zip(*theirs["curve"]))
    ours = numpy.polyfit(read["ends_y_m"] - read["middle_y_m"], read["wall_load_force_y_N_per_m"], 1)[0]
    pairs.add("bonded beam, bent once", "load over deflection, N/m²", number(ours, 4), seconds, result["steps"], theirs, number(numpy.polyfit(bent, load, 1)[0], 4))


def heap_pairs(lab, pairs):
    for rolling in (None, 0.4):
        ours, found = [], []
        for seed in PILE_SEEDS:
            settings = ensembles.sample(lab, f"pile{seed}_sample", samples.heap(lab.equidem, seed))
            more = [f"collisions.rolling_friction={rolling}", "collisions.rolling_damping=0.3"] if rolling else []
            out, result, seconds = lab.run("repose", *settings, *more)
            ours.append(readings.slope(out)["angle"])
            theirs = peer("repose", lab.folder / f"pile{seed}_sample.csv", result["time_step"], 0.5, *([rolling] if rolling else []))
            found.append(readings.slope_of(*numpy.array(theirs["discs"]).T)["angle"])
        name = f"repose, friction 0.5, {f'rolling friction {rolling}, local damping in YADE, ' if rolling else ''}three samples"
        pairs.add(name, "slope", several.both(ours) + "°", seconds, result["steps"], theirs, several.both(found) + "°")
    out, result, seconds = lab.run("hopper")
    theirs = peer("hopper", "lab_heap.csv", result["time_step"])
    left = [(when, out_of) for when, out_of in theirs["out"] if 100 < out_of < 900]
    rate = (left[-1][1] - left[0][1]) / (left[-1][0] - left[0][0])
    read = readings.discharge(out)
    pairs.add("hopper", "bodies a second", f"{read['rate']:.0f} ± {read['error']:.0f}", seconds, result["steps"], theirs, f"{rate:.0f}")


def peers(lab, command):
    pairs = Pairs()
    sand_pairs(lab, pairs), rock_pairs(lab, pairs), heap_pairs(lab, pairs)
    return (f"{HEADINGS[2]}\n    {command}\n\nThe same discs, springs, friction and time step on one core each; local damping 0.2 in YADE in place of "
            "restitution, with the heaps\nviscous dashpots of the mean mass. The last column is the time of a step of YADE over that of ours.\n\n"
            + table(["test", "", "equidem", "YADE", "equidem, s", "YADE, s", "ratio of a step"], pairs.rows) + "\n" + REMARKS)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--build", type=Path, required=True, help="a build folder of the release preset")
    sections = parser.add_mutually_exclusive_group()
    sections.add_argument("--samples", action="store_true", help="the section of several samples")
    sections.add_argument("--peers", action="store_true", help="the section beside YADE; both left out: the first")
    parser.add_argument("--page", type=Path, help="its section is made anew")
    request = parser.parse_args()
    with tempfile.TemporaryDirectory() as name:
        lab = Laboratory(request.build.resolve() / "tools" / "equidem", Path(name))
        chosen = 2 if request.peers else 1 if request.samples else 0
        command = "tools/bench/laboratory/page.py --build build/release" + ("", " --samples", " --peers")[chosen]
        text = (tests, of_several_samples, peers)[chosen](lab, command)
    print(text)
    if request.page:
        old = request.page.read_text(encoding="utf-8") if request.page.exists() else ""
        parts = {"## " + part.split("\n", 1)[0] + "\n": "## " + part for part in old.split("\n## ")[1:]}
        parts[HEADINGS[chosen]] = text
        request.page.write_text(TITLE + "".join("\n" + parts[heading].strip("\n") + "\n" for heading in HEADINGS if heading in parts), encoding="utf-8")


if __name__ == "__main__":
    try:
        main()
    except Failure as failure:
        sys.exit(f"page.py: {failure}")
