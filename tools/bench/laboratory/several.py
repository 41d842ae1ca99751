# SPDX-License-Identifier: GPL-3.0-or-later
"""The section of several samples on the page of the laboratory, as text."""

import math
import sys
from pathlib import Path

import ensembles
import readings
import samples

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "peers"))
from common import number, table  # noqa: E402

DIAMETER = 1.94e-3  # m, mean of the rock


def both(values):
    """Mean and standard error, to two digits of the error."""
    mean, error = ensembles.mean_and_error(values)
    decimals = max(0, 1 - math.floor(math.log10(error)))
    return f"{mean:.{decimals}f} ± {error:.{decimals}f}"


def fitted(sizes, column):
    """ensembles.line_in_inverse of a column over the sizes."""
    return ensembles.line_in_inverse(list(sizes), *zip(*(ensembles.mean_and_error(read[:, column]) for read in sizes.values())))


def sand(lab):
    presses, boxes = ensembles.sand(lab)
    plain, mean = [readings.biaxial(out) for out in presses], readings.stress_dilatancy(presses)
    sheared, parts = [readings.shear_box(out) for out in boxes], [readings.taylor(out) for out in boxes]

    def of(reads, name):
        return both([read[name] for read in reads]) + "°"

    factor = number(mean["factor"])
    return table(["test", "read", "expected", "from"], [
        ["biaxial, angle of friction at the peak", of(plain, "peak"), "", f"{len(plain)} loose samples of 445 discs"],
        ["the same, beyond 8 % of strain", of(plain, "late"), "", "likewise"],
        ["peak of the mean of their curves", f"{mean['peak']:.1f}°", f"{mean['rowe']:.1f}°",
         f"Rowe: R = K (1 + D), D = {number(mean['dilation'])}, K = {factor} beyond 8 %"],
        ["R = s1/s2 over D along the mean curves", f"{number(mean['offset'])} + {number(mean['slope'])} D", f"{factor} (1 + D)",
         f"least squares, correlation {number(mean['correlation'], 2)}"],
        ["shear box, angle at the peak", of(sheared, "peak"), of(sheared, "taylor"), "Taylor, by T/N - dy/dx over the last quarter of each"],
        ["the same, over the last quarter", of(sheared, "late"), "", ""],
        ["T/N over the first 5 mm and the last 8 mm", ", ".join(both([read[k][0] for read in parts]) for k in (0, 1)), "", ""],
        ["T/N - dy/dx, likewise", *(both([read[k][0] - read[k][1] for read in parts]) for k in (0, 1)), "Taylor: the same in both"]])


def stiffness(lab):
    rows = []
    for seed, found in zip(ensembles.STIFFNESS_SEEDS, ensembles.small_strain(lab)):
        rows.append([seed, *(f"{number(young / 1e6, 4)}, {number(ratio)}" for young, ratio in found), f"{found[0][0] / found[2][0]:.4f}"])
    return ("Stiffness of the biaxial test: slope of the axial stress (MPa) and of the strain across over that along, at strains from 1e-5 to\n"
            "3e-5 and from there to 1e-4, the sides at 100 kPa, the plates at 1e-4 m/s; by statics of the same packing at rest, with the forces\n"
            "that it carries, between the same plates; and by `homogenize`, which moves its boundary as a whole. Discs that bear nothing are\n"
            "left out. Contacts that open and slip soften the rest of the way.\n\n"
            + table(["sample", "run, to 3e-5", "run, to 1e-4", "statics between plates", "homogenize", "E, run to 3e-5 over statics"], rows))


def rock(lab):
    sizes, cells = ensembles.rock(lab)
    rows = [[f"{1e3 * width:.0f}", both(read[:, 0] / 1e9), both(read[:, 2] / 1e9), both(read[:, 0] / read[:, 2]), both(read[:, 1]), both(read[:, 3])]
            for width, read in sizes.items()]
    inside, whole = fitted(sizes, 0), fitted(sizes, 2)

    def fit(of):
        return f"E = {of[0] / 1e9:.3f} ± {of[1] / 1e9:.3f} GPa, b = {number(of[2] / DIAMETER, 2)} mean diameters"

    return (f"Rock of several sizes, {len(ensembles.ROCK_SEEDS)} samples each: E (GPa) and nu of the gauges of `grains_unconfined.toml`, and of `homogenize` of\n"
            "the sample, its boundary moved as a whole.\n\n"
            + table(["width, mm", "E, gauges", "E, homogenize", "ratio", "nu, gauges", "nu, homogenize"], rows)
            + f"\n\nLines E (1 - b/W): of the gauges {fit(inside)};\nof `homogenize` {fit(whole)}: half a diameter at each side lacks the bonds of\n"
            f"discs outside. Periodic cells of 800 discs, which have no edge: E = {both(cells[:, 0] / 1e9)} GPa, nu = {both(cells[:, 1])}.")


def brazilian(lab):
    sizes = ensembles.brazilian(lab)
    uniform, rigid = (readings.hondros(samples.HALF_ANGLE, ensembles.PROBE, jaws) for jaws in (False, True))
    across, along = fitted(sizes, 0), fitted(sizes, 1)
    return ("Brazilian discs of several sizes, four samples each, without strength: stresses across and along the loaded diameter in a square of\n"
            f"0.48 radii at the centre, over 2P/(pi D). Hondros (1959) with arcs of 20°: {number(uniform[0])} and {number(uniform[1])} for a uniform pressure,\n"
            f"{number(rigid[0])} and {number(rigid[1])} for that under rigid jaws, which is larger at their edges. The plates here are rigid, and touch few discs.\n\n"
            + table(["diameter, mm", "across", "along"], [[f"{1e3 * width:.0f}", *(both(column) for column in read.T)] for width, read in sizes.items()])
            + f"\n\ns (1 - b/D) fits s = {across[0]:.3f} ± {across[1]:.3f} across, with b = {number(across[2] / DIAMETER, 2)} mean diameters, and s = {along[0]:.3f} ± "
            f"{along[1]:.3f} along.")


def repose(lab):
    slopes, rolling = ensembles.repose(lab)

    def rows(name, of):
        return table([name, "slope", "of the samples"],
                     [[friction, both(angles) + "°", ", ".join(f"{one:.1f}" for one in angles)] for friction, angles in of.items()])

    return (f"Angle of repose over friction, {len(ensembles.HEAP_SEEDS)} samples each: a line by least squares through the highest disc in each of eleven\n"
            "columns of 10 mm. It grows with each step of the friction, from 0.5 to 0.8 by less than its standard error.\n\n"
            + rows("friction", slopes)
            + "\n\nOver the rolling friction of the same columns with friction 0.5 and rolling damping 0.3.\n\n" + rows("rolling friction", rolling))


def section(lab):
    return "\n\n".join(part(lab) for part in (sand, stiffness, rock, brazilian, repose)) + "\n"
