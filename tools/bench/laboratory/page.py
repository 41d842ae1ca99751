#!/usr/bin/env python3
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

sys.dont_write_bytecode = True
ROOT = Path(__file__).resolve().parents[3]
sys.path.insert(0, str(ROOT / "tools" / "bench" / "peers"))

import ensembles  # noqa: E402
import readings  # noqa: E402
import samples  # noqa: E402
from common import Failure, call, number, result_of, table, tell  # noqa: E402

CASES, SCRIPT = ROOT / "data" / "cases", ROOT / "tools" / "bench" / "peers" / "laboratory_yade.py"
TITLE = "# The laboratory\n"
HEADINGS = ("## The tests beside what is expected\n", "## Several samples\n", "## Beside YADE\n")
OPENINGS = (0.032, 0.040, 0.048, 0.056, 0.064)
HEAP_DIAMETER = 0.004  # m, mean of lab_heap.csv
HEAP_SOLID_FRACTION = 0.846  # area of discs in the middle of the column of lab_heap.csv, over that of the part


class Laboratory:
    def __init__(self, equidem, folder):
        self.equidem, self.folder = equidem, folder

    def run(self, name, *settings):
        """(folder, result, seconds) of a case on one thread."""
        out = self.folder / f"{name}{len(list(self.folder.iterdir()))}"
        words = [word for setting in settings for word in ("--set", setting)]
        start = time.monotonic()
        text = call([self.equidem, "run", CASES / f"grains_{name}.toml", "--out", out, "--threads", 1, "--json", "-", "--quiet", "--set",
                     "output.picture=false", *words])
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
             "Rowe (1962): (1 + sin φ_cv)/(1 - sin φ_cv) (1 + D) with φ_cv and D read in the test"],
            ["the same, beyond 8 % of strain", degrees(plain["late"]), "", f"φ_cv; volume {100 * plain['volume']:+.2f} %"],
            ["dilation D at the peak", number(plain["dilation"]), "", f"at {100 * plain['strain']:.1f} % of strain"],
            ["side stress, Pa", f"{plain['side'][0]:.5g} to {plain['side'][1]:.5g}", "1e+05", "of the servo walls"],
            ["direct shear box, angle in the plane at the peak", degrees(box["peak"]), degrees(box["taylor"]),
             "Taylor (1948): T/N = (T/N)_cv + dy/dx, both read in the test"],
            ["the same, over the last quarter", degrees(box["late"]), degrees(math.degrees(math.atan(math.sin(math.radians(plain["late"]))))),
             "tan φ = sin φ_cv of the biaxial test: no extension along the plane, coaxial (Davis 1968)"]]
    return rows


def rock(lab):
    moduli = json.loads(call([lab.equidem, "homogenize", CASES / "lab_rock.toml", "--json", "-", "--quiet"]))
    young, nu = (moduli[name]["plane_stress"] for name in ("young_modulus", "poisson_ratio"))
    out, _, _ = lab.run("unconfined")
    plain = readings.unconfined(out, 0.04)
    out, _, _ = lab.run("unconfined", "collisions.walls.friction=0.5")
    rubbing = readings.unconfined(out, 0.04)
    out, result, _ = lab.run("brazilian")
    split = readings.brazilian(out, 0.05)
    across, along = readings.stress_at_the_centre(out, 0.05, float(readings.rows_of_breaks(out)[0]["time_s"]))
    theory = readings.hondros(samples.HALF_ANGLE, ensembles.PROBE)
    crack = readings.breaks_near_the_diameter(out, split["time"] + 2e-4)
    return [["unconfined compression, E, Pa", number(plain["young_modulus"], 4), number(young, 4), "homogenize lab_rock.toml, uniform displacements"],
            ["the same, nu", number(plain["poisson_ratio"]), number(nu), "likewise"],
            ["unconfined strength, Pa", number(plain["strength"], 4), "", f"at a strain of {100 * plain['strain']:.2f} %"],
            ["the same, plates with friction 0.5", number(rubbing["strength"], 4), "", "held ends"],
            ["stress across the loaded diameter at the centre, before the first break, over 2P/(pi D)", number(across), number(theory[0]),
             "Hondros (1959), arcs of 20°, in a square of 0.48 radii"],
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
            "an empty cell\nhas no theory. One sample each.\n\n"
            + table(["test", "read", "expected", "from"], rows)
            + "\n\nDischarge over the opening W, `grains_hopper.toml`, bodies in a second between the 100th and the 900th that leave, standard errors\n"
            f"from four parts of the time; Beverloo's law in two dimensions, C (W - k d)^(3/2), with k = {number(law['closed'] / HEAP_DIAMETER)} and, the "
            f"solid fraction in the silo\nbeing {HEAP_SOLID_FRACTION}, C = {number(factor)} sqrt(g). The fit of other powers p with a k of their own has "
            "this chi squared per\ndegree of freedom.\n\n"
            + table(["W, mm", "W/d", "bodies a second", "3/2 power"], openings) + "\n\n" + table(["p", "chi squared", "k"], powers) + "\n")


def both(values, digits=3):
    mean, error = ensembles.mean_and_error(values)
    return f"{number(mean, digits)} ± {number(error, 1)}"


def several(lab, command):
    """The section of several samples."""
    presses, boxes = ensembles.sand(lab)
    plain, mean = [readings.biaxial(out) for out in presses], readings.stress_dilatancy(presses)
    sheared = [readings.shear_box(out) for out in boxes]
    soft = ensembles.small_strain(lab)
    rows = [["biaxial, angle of friction at the peak", both([one["peak"] for one in plain]) + "°", "", f"{len(plain)} loose samples of 445 discs"],
            ["the same, beyond 8 % of strain", both([one["late"] for one in plain]) + "°", "", "likewise"],
            ["peak of the mean of their curves", degrees(mean["peak"]), degrees(mean["rowe"]), f"Rowe: K (1 + D), D = {number(mean['dilation'])}, K = "
             f"R/(1 + D) = {number(mean['factor'])} beyond 8 %"],
            ["R against D over the mean curves", f"{number(mean['offset'])} + {number(mean['slope'])} D", f"{number(mean['factor'])} (1 + D)",
             f"R = s1/s2; correlation {number(mean['correlation'], 2)}"],
            ["shear box, angle at the peak", both([one["peak"] for one in sheared]) + "°", both([one["taylor"] for one in sheared]) + "°", "Taylor, of each sample"],
            ["the same, over the last quarter", both([one["late"] for one in sheared]) + "°", "", ""]]
    stiffness = [[seed, *(number(one[0] / 1e6, 4) + ", " + number(one[1]) for one in ((read["young_modulus"], read["poisson_ratio"]), read["statics"], read["homogenize"]))]
                 for seed, read in zip(ensembles.STIFFNESS_SEEDS, soft)]
    sizes, cells = ensembles.rock(lab)
    limit, limit_error, edge = ensembles.line_in_inverse(list(sizes), *zip(*(ensembles.mean_and_error(read[:, 0]) for read in sizes.values())))
    own = ensembles.line_in_inverse(list(sizes), *zip(*(ensembles.mean_and_error(read[:, 2]) for read in sizes.values())))
    diameter = 1.94e-3
    rock = [[f"{1e3 * width:.0f}", both(read[:, 0] / 1e9), both(read[:, 2] / 1e9), both(read[:, 0] / read[:, 2]), both(read[:, 1]), both(read[:, 3])]
            for width, read in sizes.items()]
    discs = [[f"{1e3 * width:.0f}", *(both(column) for column in read.T)] for width, read in ensembles.brazilian(lab).items()]
    theory, slopes = readings.hondros(samples.HALF_ANGLE, ensembles.PROBE), ensembles.repose(lab)
    return (f"{HEADINGS[1]}\n    {command}\n\nMeans and their standard errors.\n\n" + table(["test", "read", "expected", "from"], rows)
            + "\n\nStiffness of the biaxial test: slope of the axial stress (MPa) and of the strain across over that along between strains of 1e-5 and\n"
            "1e-4, the sides at 100 kPa, the plates at 1e-4 m/s; by statics of the same packing at rest, with the forces that it carries, between the\n"
            "same plates; and by `homogenize`, which moves its boundary as a whole. Discs that bear nothing are left out.\n\n"
            + table(["sample", "run", "statics between plates", "homogenize"], stiffness)
            + f"\n\nRock of several sizes, {len(ensembles.ROCK_SEEDS)} samples each: E (GPa) and nu of the gauges of `grains_unconfined.toml` and of `homogenize` of the\n"
            "sample (its boundary moved as a whole).\n\n"
            + table(["width, mm", "E, gauges", "E, homogenize", "ratio", "nu, gauges", "nu, homogenize"], rock)
            + f"\n\nE (1 - b/W) fits both: gauges {number(limit / 1e9)} ± {number(limit_error / 1e9, 1)} GPa with b = {number(edge / diameter, 2)} diameters, `homogenize` "
            f"{number(own[0] / 1e9)} ± {number(own[1] / 1e9, 1)} GPa\nwith b = {number(own[2] / diameter, 2)} diameters. Periodic cells of 800 discs, which have no edge, have "
            f"E = {both(cells[:, 0] / 1e9)} GPa, nu = {both(cells[:, 1])}.\n"
            "\nBrazilian discs of several sizes, four samples each, without strength: stresses across and along the loaded diameter in a square of\n"
            f"0.48 radii at the centre, over 2P/(pi D). Hondros (1959) with arcs of 20° and uniform pressure: {number(theory[0])} and {number(theory[1])}; finite elements of\n"
            "the disc with flat ends between rigid plates without friction, whose pressure is larger at the edges: 0.864 and -2.86.\n\n"
            + table(["diameter, mm", "across", "along"], discs)
            + f"\n\nAngle of repose over friction, {len(ensembles.HEAP_SEEDS)} samples each: a line by least squares through the highest disc in each of eleven columns\n"
            "of 10 mm.\n\n" + table(["friction", "slope", "of the samples"], [[friction, both(angles) + "°", ", ".join(f"{one:.1f}" for one in angles)]
                                                              for friction, angles in slopes.items()]) + "\n")


def peer(test, sample, step, *more):
    return result_of(call(["yade", "-n", "-x", "-j1", SCRIPT, test, CASES / sample, repr(step), *more]))


def sine(row):
    _, _, axial, side = row
    return (axial - side) / (axial + side)


def peers(lab, command):
    rows = []

    def add(test, what, ours, seconds, steps, theirs, found):
        rows.append([test, what, ours, found, f"{seconds:.1f}", f"{theirs['seconds']:.1f}", number(theirs["seconds"] / theirs["steps"] / (seconds / steps))])
        tell(f"{test}: YADE {theirs['seconds']:.1f} s")

    out, result, seconds = lab.run("biaxial")
    theirs = peer("biaxial", "biaxial.csv", result["time_step"])
    sines = [sum(map(sine, theirs["curve"][k:k + 30])) / 30 for k in range(len(theirs["curve"]) - 30)]
    read = readings.biaxial(out)
    late = [sine(row) for row in theirs["curve"] if row[0] > 0.08]
    add("biaxial", "φ at the peak, beyond 8 %", f"{degrees(read['peak'])}, {degrees(read['late'])}", seconds, result["steps"], theirs,
        ", ".join(degrees(math.degrees(math.asin(one))) for one in (max(sines), sum(late) / len(late))))

    out, result, seconds = lab.run("unconfined", "bonds.bending_spring=none")
    theirs = peer("unconfined", "lab_rock.csv", result["time_step"], CASES / "lab_rock_bonds.csv")
    read, curve = readings.unconfined(out, 0.04), theirs["curve"]
    peak = max(range(len(curve)), key=lambda k: curve[k][1])
    add("unconfined, bonds without moments", "strength, Pa", number(read["strength"]), seconds, result["steps"], theirs, number(curve[peak][1]))

    out, result, seconds = lab.run("hopper")
    theirs = peer("hopper", "lab_heap.csv", result["time_step"])
    left = [(when, out_of) for when, out_of in theirs["out"] if 100 < out_of < 900]
    rate = (left[-1][1] - left[0][1]) / (left[-1][0] - left[0][0])
    read = readings.discharge(out)
    add("hopper", "bodies a second", f"{read['rate']:.0f} ± {read['error']:.0f}", seconds, result["steps"], theirs, f"{rate:.0f}")
    return (f"{HEADINGS[1]}\n    {command}\n\nThe same discs, springs, friction and time step on one core each; local damping 0.2 in YADE in place of "
            "restitution, in the hopper\nviscous dashpots of the mean mass. The last column is the time of a step of YADE over that of ours.\n\n"
            + table(["test", "", "equidem", "YADE", "equidem, s", "YADE, s", "ratio of a step"], rows) + "\n"
            "\nYADE is the better choice for tests that you program: its scripts stop, change and measure anything in Python between steps, its servo\n"
            "walls work in three dimensions, and its package brings tests of this kind in 3D. Its bonds break in tension and shear; the moments "
            "of\nCohFrictMat yield. Ours have no rolling resistance between bodies that are not bonded.\n")


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
        text = (tests, several, peers)[chosen](lab, command)
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
