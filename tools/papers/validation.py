#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Numbers that others have published (rigidity, adsorption, jamming, friction, impacts, LAMMPS, a point load, moduli),
computed again, with error bars and verdicts."""
import math
import time

import numpy as np

from common import (Axis, Output, Plot, Progress, Random, Series, columns_of, counted, curve, eq, fit_line, main, mean_of,
                    moved_discs, points, samples_of)
from validation_findings import NUMBERS, WHY, Findings, page, report, step_error
from validation_spheres import impacts, lammps

FIVE_COLOURS = ("sky_blue", "green", "orange", "purple", "vermilion")


def value_and_error(mean):
    return mean.mean, mean.standard_error


def columns(means):
    return [mean.mean for mean in means], [mean.standard_error for mean in means]


def fitted_line(fit, to):
    return curve(lambda x: fit.intercept + fit.slope * x, 0, to, label="fit", style="dashed_line")


def published_point(name, label):
    return points(label, [0], [NUMBERS[name].value], marker="diamond", filled=False)


# ---- missing bonds and discs

# Removed bonds keep this share of their stiffness, so that floppy cells have moduli, too; more where the matrix is
# else too close to singular.
REMAINDERS = (1e-11, 1e-10, 1e-9)


def random_order(count, seed):
    random, order = Random(seed), list(range(count))
    for k in range(count, 1, -1):
        other = random.below(k)
        order[k - 1], order[other] = order[other], order[k - 1]
    return np.array(order)


def stiffnesses(cell, bonds, order, kept, removed=REMAINDERS[0]):
    there = np.zeros(len(order), bool)
    there[order[:kept]] = True
    return np.where(there if bonds else there[cell.contacts].all(axis=1), 1.0, removed)


def branches(cell):
    i, j = cell.contacts.T
    return cell.centres[j] + cell.shifts * np.array(cell.cell) - cell.centres[i]


def share_in_removed(cell, kN):
    """Share of the remainders in the energy of the softest strain: 1 of a floppy cell, whose stiffness is proportional
    to the remainder, 0 of a rigid one."""
    result = eq.homogenize(cell, eq.Springs(kN, 0 * kN))
    scale = np.array([1, 1, math.sqrt(2)])
    softest = scale * np.linalg.eigh(np.outer(scale, scale) * np.array(result.stiffness))[1][:, 0]
    (i, j), branch, stretch = cell.contacts.T, branches(cell), 0
    for amount, name, strain in zip(softest, ("xx", "yy", "xy"), np.array([[1, 0, 0, 0], [0, 0, 0, 1], [0, .5, .5, 0]])):
        moved = result.fluctuations[name].displacements
        stretch += amount * ((branch @ strain.reshape(2, 2) + moved[j] - moved[i]) * cell.normals).sum(axis=1)
    energy = kN * stretch**2
    return energy[kN < 1].sum() / energy.sum()


def onset(arguments):
    """The share of bonds or sites at which a cell becomes rigid, as they come back in a random order."""
    bonds, size, seed = arguments
    cell = eq.delaunay(discs=size * size, points="perturbed_hexagonal", disorder=0.1, seed=seed, periodic=True, radius=0.5)
    order = random_order(len(cell.contacts) if bonds else len(cell), seed ^ 0x5BD1E995)
    floppy, rigid = int(0.5 * len(order)), int(0.9 * len(order))
    while rigid - floppy > 1:
        middle = (floppy + rigid) // 2
        for removed in REMAINDERS:
            try:
                share = share_in_removed(cell, stiffnesses(cell, bonds, order, middle, removed))
                break
            except eq.ComputationFailed:
                if removed == REMAINDERS[-1]:
                    raise
        floppy, rigid = (floppy, middle) if share < 0.5 else (middle, rigid)
    return rigid / len(order)


def add_thresholds(findings, bonds, quick):
    what, key = ("bonds", "bond threshold") if bonds else ("discs", "site threshold")
    sizes = [(8, 48), (12, 48), (20, 32)] if quick else [(8, 400), (12, 400), (18, 300), (26, 240), (38, 160)]
    sides, counts = zip(*sizes)
    all_shares = [sorted(samples_of(f"removing {what} of {side} x {side} discs:", onset,
                                    [(bonds, side, seed) for seed in range(1, count + 1)])) for side, count in sizes]
    means = [mean_of(shares) for shares in all_shares]
    fit = fit_line([side**(-1 / NUMBERS["rigidity exponent"].value) for side in sides], *columns(means))
    findings.compare("threshold, mean onset extrapolated to infinite size", key, (fit.intercept, fit.intercept_error),
                     WHY["size"])
    # Where the curves "share of cells that are rigid" of both sizes cross, both normal distributions of the onsets.
    (m1, e1, s1), (m2, e2, s2) = ((mean.mean, mean.standard_error, mean.standard_deviation) for mean in (means[0], means[-1]))
    wide = s1 - s2
    t1, t2 = (s / math.sqrt(2 * (count - 1)) for s, count in ((s1, counts[0]), (s2, counts[-1])))
    error = math.sqrt((s2 / wide * e1)**2 + (s1 / wide * e2)**2 + (s2 * (m1 - m2) / wide**2 * t1)**2 +
                      (s1 * (m2 - m1) / wide**2 * t2)**2)
    findings.compare(f"threshold, crossing of sizes {sides[0]} and {sides[-1]}", key, ((m2 * s1 - m1 * s2) / wide, error),
                     WHY["size"])
    name = ("bond" if bonds else "site") + "_onsets"
    findings.tables[name] = {"side_discs": sides, "samples": counts, "mean_onset": columns(means)[0],
                             "standard_error": columns(means)[1],
                             "standard_deviation": [mean.standard_deviation for mean in means]}
    series = []
    for side, shares, colour in zip(sides, all_shares, FIVE_COLOURS):
        n = np.arange(len(shares))
        risen = np.stack([n, n + 1], axis=1).ravel() / len(n)
        series.append(Series(f"{side} x {side} discs", np.repeat(shares, 2).tolist(), risen.tolist(), colour=colour))
    findings.plots[name] = Plot(f"Cells that resist every strain; {what} of a triangular lattice removed",
                                Axis(f"share p of {what} that are left"), Axis("share of cells that are rigid", 0, 1.12), series,
                                [(NUMBERS[key].value, f"{NUMBERS[key].value:.4f}, {NUMBERS[key].source}", "black")])


def effective_medium(p):
    """K and G over those of the full lattice (Feng et al. 1985): (p - 2/3)/(1/3)."""
    threshold = NUMBERS["effective-medium threshold"].value
    return (p - threshold) / (1 - threshold)


def relative_moduli(arguments):
    side, p, seed = arguments
    cell = eq.hexagonal(columns=side, rows=side, radius=0.5, periodic=True)
    order = random_order(len(cell.contacts), seed)
    kept = math.floor(p * len(order) + 0.5)
    diluted = eq.homogenize(cell, eq.Springs(stiffnesses(cell, True, order, kept), np.zeros(len(order))))
    full = eq.homogenize(cell, eq.Springs(1.0, 0.0))
    return diluted.bulk_modulus_2d / full.bulk_modulus_2d, diluted.shear_modulus / full.shear_modulus


def bond_dilution(quick):
    findings = Findings("bond_dilution", exponent=NUMBERS["rigidity exponent"].value)
    add_thresholds(findings, True, quick)
    side, count = (16, 8) if quick else (48, 24)
    shares = [0.98, 0.94, 0.9, 0.8, 0.7] if quick else [0.98, 0.96, 0.94, 0.9, 0.85, 0.8, 0.75, 0.7, 0.68, 0.66]
    found = [samples_of(f"moduli at p = {p:g}:", relative_moduli, [(side, p, seed) for seed in range(1, count + 1)])
             for p in shares]
    table, threshold = {"p": shares}, NUMBERS["effective-medium threshold"].value
    series = [curve(effective_medium, threshold, 1, label="effective medium, (p - 2/3)/(1/3)", column="effective_medium")]
    for name, colour, marker, own in zip("KG", ("vermilion", "blue"), ("circle", "square"),
                                         zip(*(zip(*both) for both in found))):
        means = [mean_of(samples) for samples in own]
        values, errors = columns(means)
        near = [(1 - p, (1 - value) / (1 - p), error / (1 - p)) for p, value, error in zip(shares, values, errors) if p >= 0.9]
        fit = fit_line(*zip(*near))
        findings.compare(f"slope of {name}/{name}(1) over p at p = 1", "effective-medium slope",
                         (fit.intercept, fit.intercept_error))
        for p, mean in zip(shares, means):
            if p in (0.9, 0.8, 0.7):
                findings.formula(f"{name}/{name}(1) at p = {p:g}", effective_medium(p), "Feng et al. 1985",
                                 value_and_error(mean), WHY["medium"])
        table.update({f"{name}_over_full": values, f"{name}_standard_error": errors})
        series.append(points(name, shares, values, colour, marker, filled=False, errors=errors))
    findings.tables["bond_moduli"] = {**table, "effective_medium": [effective_medium(p) for p in shares]}
    findings.plots["bond_moduli"] = Plot("Moduli of the triangular lattice with missing bonds, central forces",
                                         Axis("share p of bonds that are left", 0.62, 1.01),
                                         Axis("modulus over that of the full lattice", -0.02), series,
                                         [(NUMBERS["bond threshold"].value, "0.6602, generic lattice", "black")])
    return findings


def site_dilution(quick):
    findings = Findings("site_dilution", exponent=NUMBERS["rigidity exponent"].value)
    add_thresholds(findings, False, quick)
    return findings


# ---- packings

def coverage_after(arguments):
    """Discs of diameter 1 in a periodic square, one attempt each."""
    t, side, seed = arguments
    disc = math.pi / 4
    radii = np.full(math.floor(t * side * side / disc + 0.5), 0.5)
    packing = eq.pack_discs(radii, (side, side), method="rejection", attempts=1, seed=seed)
    return len(packing.assembly) * disc / (side * side)


def adsorption(quick):
    side, count = (40.0, 8) if quick else (80.0, 24)
    times = [4, 8, 16, 32, 64, 128, 256] + ([] if quick else [512])
    findings = Findings("adsorption", side=side, count=count, first=times[-4], last=times[-1])
    coverage = [samples_of(f"adsorbing until t = {t}:", coverage_after, [(t, side, seed) for seed in range(1, count + 1)])
                for t in times]
    # The coverages of one sample at several times are correlated: a line through those of each sample, then the mean.
    roots, late = [1 / math.sqrt(t) for t in times], list(zip(*coverage[-4:]))
    limit = mean_of([fit_line(roots[-4:], sample, [1] * 4).intercept for sample in late])
    findings.compare("coverage at saturation", "adsorption coverage", value_and_error(limit), WHY["coverage"])
    # theta(4t) - theta(t) falls as t^a: a from two such differences a factor of two in t apart.
    exponent = mean_of([math.log2((d - b) / (c - a)) for a, b, c, d in late])
    findings.compare("exponent of the approach", "adsorption exponent", value_and_error(exponent), WHY["approach"])
    means, errors = columns([mean_of(samples) for samples in coverage])
    slope = (means[-1] - limit.mean) / roots[-1]
    findings.tables["adsorption"] = {"t": times, "coverage": means, "standard_error": errors}
    findings.plots["adsorption"] = Plot("Random sequential adsorption of equal discs", Axis("$t^{-1/2}$", -0.01, 0.52),
                                        Axis("coverage"), [
        curve(lambda x: limit.mean + slope * x, 0, 0.5, label="limit - c $t^{-1/2}$, fitted to the last four times", column="fit"),
        points("rejection", roots, means, "vermilion", errors=errors),
        published_point("adsorption coverage", "0.5471, Zhang and Torquato 2013")])
    return findings


JAMMING_OVERLAP = 1e-7  # mean, of the mean radius
JAMMED = ("solid_fraction", "z_without_rattlers", "contacts_beyond_isostatic", "share_of_rattlers")


def jam(arguments):
    """Half of the discs 1.4 times as large as the others, grown in a periodic square until they jam; None: refused."""
    discs, seed = arguments
    radii = np.where(np.arange(discs) < discs // 2, 0.5, 0.7)
    side = math.sqrt(sum(math.pi * r * r for r in radii) / NUMBERS["jamming fraction"].value)  # a start: radii are scaled
    try:
        packing = eq.pack_discs(radii, (side, side), overlap=JAMMING_OVERLAP, seed=seed)
    except eq.ComputationFailed:
        return None
    held, z = discs - packing.rattlers, packing.coordination_number_without_rattlers
    return packing.solid_fraction, z, 0.5 * z * held - (2 * held - 1), packing.rattlers / discs


def jamming(quick):
    sizes = [(64, 60), (128, 40), (256, 16)] if quick else [(64, 400), (128, 300), (256, 200), (512, 80), (1024, 30)]
    # Excess of z at that overlap: 3.6 (phi - phi_J)^(1/2) (O'Hern et al. 2003), phi - phi_J about the overlap.
    nu, excess = NUMBERS["jamming exponent"].value, NUMBERS["excess coordination"].value * math.sqrt(JAMMING_OVERLAP)
    findings = Findings("jamming", overlap=JAMMING_OVERLAP, exponent=nu, excess=excess)
    discs, found, refused = [n for n, _ in sizes], [], 0
    for n, count in sizes:
        samples = samples_of(f"jamming {n} discs:", jam, [(n, seed) for seed in range(1, count + 1)])
        found.append([mean_of(own) for own in zip(*(one for one in samples if one))])
        refused += samples.count(None)
    means = dict(zip(JAMMED, zip(*found)))
    x = [n**(-0.5 / nu) for n in discs]
    fractions = fit_line(x, *columns(means["solid_fraction"]))
    z = fit_line([1 / n for n in discs], *columns(means["z_without_rattlers"]))
    findings.compare("solid fraction, extrapolated to infinite size", "jamming fraction",
                     (fractions.intercept, fractions.intercept_error), WHY["made"])
    findings.compare("z without rattlers, extrapolated in 1/N", "jamming coordination", (z.intercept, z.intercept_error),
                     allowance=excess)
    for n, surplus in zip(discs, means["contacts_beyond_isostatic"]):
        findings.compare(f"contacts beyond 2 N' - 1, N = {n}", "contacts beyond 2 N' - 1", value_and_error(surplus),
                         allowance=0.5 * n * excess)
    least, most = NUMBERS["least jamming fraction"].value, NUMBERS["largest jamming fraction"].value
    findings.trend(f"packings with 2 N' - 1 contacts jam between {least:g} and {most:g}, by how fast they are made",
                   NUMBERS["least jamming fraction"].source, least < fractions.intercept < most,
                   f"{fractions.intercept:.4f} ± {fractions.intercept_error:.4f} at infinite size")
    if refused:
        findings.notes.append(f"`pack` found no state with the wanted overlap for {counted(refused, 'cell')}, left out.")
    table = {"discs": discs, "samples": [count for _, count in sizes]}
    for name in JAMMED:
        table[name], table[name + "_standard_error"] = columns(means[name])
    findings.tables["jamming"] = table
    values, errors = columns(means["solid_fraction"])
    findings.plots["jamming"] = Plot("Bidisperse discs (1 : 1.4) at jamming", Axis("$N^{-1/(2ν)}$, ν = 0.71", -0.001),
                                     Axis("solid fraction"), [
        points("growth in periodic cells", x, values, "vermilion", errors=errors), fitted_line(fractions, x[0]),
        published_point("jamming fraction", "0.842, O'Hern et al. 2003")])
    return findings


def settled(arguments):
    """Discs of two sizes that fall into a box and come to rest: (z without rattlers, root of the largest overlap)."""
    mu, stiffness, discs, damping, seed = arguments
    packing = eq.pack_discs(np.where(np.arange(discs) % 2 == 0, 0.005, 0.007), (0.0108 * math.sqrt(discs), 1.0),
                            method="falling", sides="open_top", seed=seed,
                            settling={"kN": stiffness, "kT": stiffness, "damping": damping, "friction": mu,
                                      "wall_friction": mu, "unbalanced": 1e-5, "longest": 60})
    return packing.coordination_number_without_rattlers, math.sqrt(packing.largest_overlap)


def friction(quick):
    discs, count, soft, decades = (150, 2, 1e7, 1) if quick else (500, 4, 1e7, 2)
    findings = Findings("friction", discs=discs, count=count)

    def settle(mu, stiffness, damping=1.0):
        """(mu, stiffness, mean z, mean depth)"""
        both = samples_of(f"settling with friction {mu:g}, kN = {1e-6 * stiffness:g} MPa:", settled,
                          [(mu, stiffness, discs, damping, seed) for seed in range(1, count + 1)])
        return mu, stiffness, *(mean_of(own) for own in zip(*both))

    def shown_z(row):
        return f"{row[2].mean:.3f} ± {row[2].standard_error:.3f}"

    over_friction = [settle(mu, soft) for mu in ([0, 0.3, 10] if quick else [0, 0.1, 0.3, 1, 10])]
    over_stiffness = [over_friction[-1]] + [settle(10, soft * 10**k) for k in range(1, decades + 1)]
    depths, (z, errors) = [row[3].mean for row in over_stiffness], columns([row[2] for row in over_stiffness])
    fit = fit_line(depths, z, errors)
    findings.compare("z without rattlers, friction 10, rigid discs", "frictional coordination",
                     (fit.intercept, fit.intercept_error), WHY["fallen"])
    means = [row[2] for row in over_friction]
    falls = all(b.mean < a.mean + 2.6 * math.hypot(a.standard_error, b.standard_error) for a, b in zip(means, means[1:]))
    findings.trend("z falls from 4 towards 3 as friction grows, most of the way", "Shundyak et al. 2007",
                   falls and 3 < means[-1].mean < 3.25 and means[0].mean > 3.75,
                   ", ".join(f"{shown_z(row)} at {row[0]:g}" for row in over_friction))
    braked = [f"{shown_z(over_stiffness[1] if damping == 1 else settle(10, 10 * soft, damping))} at h = {damping:g}"
              for damping in ((0.1, 1.0) if quick else (0.1, 0.3, 1.0, 3.0))]
    findings.notes = [f"How slowly the discs come to rest matters: at friction 10 and kN = {1e-5 * soft:g} MPa, z is "
                      f"{', '.join(braked[:-1])} and {braked[-1]}."]
    rows = over_friction + over_stiffness[1:]
    z_of_rows, errors_of_rows = columns([row[2] for row in rows])
    findings.tables["friction"] = {"friction": [row[0] for row in rows], "kN_Pa": [row[1] for row in rows],
                                   "z_without_rattlers": z_of_rows, "standard_error": errors_of_rows,
                                   "root_of_largest_overlap": [row[3].mean for row in rows]}
    findings.plots["friction"] = Plot("Coordination of discs settled with friction 10",
                                      Axis("square root of the largest overlap over the radius", -0.001),
                                      Axis("z without rattlers", 2.95), [
        points(f"$k_N$ = {1e-6 * soft:g} to {1e-6 * soft * 10**decades:g} MPa, from right to left", depths, z, "vermilion",
               errors=errors),
        fitted_line(fit, depths[0]),
        curve(lambda _: NUMBERS["frictional coordination"].value, 0, depths[0], label="3, Shundyak et al. 2007")])
    return findings


# ---- a point load

def half_plane(kT):
    """E and the displacement under a unit force into y < 0 at the origin, in plane stress, up to a rigid translation
    along y (Timoshenko & Goodier, article 36), of the sheet with kN = 1: K = sqrt3/2 kN, G = sqrt3/4 (kN + kT) (Abe 1996,
    eq. 34)."""
    K, G = math.sqrt(3) / 2, math.sqrt(3) / 4 * (1 + kT)
    young, nu = 4 * K * G / (K + G), (K - G) / (K + G)

    def displacement(x):
        r, angle, unit = np.hypot(*x.T), np.arctan2(x[:, 0], -x[:, 1]), 1 / (math.pi * young)
        s, c = np.sin(angle), np.cos(angle)
        along = unit * (-2 * c * np.log(r) - (1 - nu) * angle * s)
        across = unit * (2 * nu * s + 2 * s * np.log(r) - (1 - nu) * angle * c + (1 - nu) * s)
        return np.stack([along * s + across * c, -along * c + across * s], axis=1)
    return young, displacement


def turned(vectors):
    """By 90 degrees counter-clockwise."""
    return np.stack([-vectors[:, 1], vectors[:, 0]], axis=1)


def disc_stresses(block, forces):
    """Mean stress of each disc: sum of arm times force over the area of its cell."""
    n, stress = block.normals, np.zeros((len(block), 2, 2))
    f = forces[:, :1] * n + forces[:, 1:] * turned(n)  # on i; on j the opposite, at the opposite arm
    for end in (0, 1):
        np.add.at(stress, block.contacts[:, end], (block.levers[:, end:end + 1] * n)[:, :, None] * f[:, None, :])
    return stress / block.cell_areas[:, None, None]


class LoadedBlock:
    """A block twice as wide as deep; discs of its sides and bottom follow the elastic solution. Errors in the half ring
    from a quarter to three quarters of the depth, relative to 2 P/(pi r) and P/E; root mean squares."""
    def __init__(self, depth, kT):
        radius, self.depth = 0.5, depth
        # An odd number of rows: the top row is a long one, with a disc in its middle.
        block = eq.hexagonal(columns=2 * depth + 1, rows=depth | 1, radius=radius)
        top = block.groups["top"]
        loaded = int(top[len(top) // 2])
        places, (young, displacement) = block.centres - block.centres[loaded], half_plane(kT)
        held = list(dict.fromkeys(int(disc) for side in ("left", "right", "bottom") for disc in block.groups[side]))
        rest = eq.solve(block, eq.Springs(1.0, kT), **moved_discs(held, displacement(places[held]), loaded=[loaded]),
                        loads=[{"group": "loaded", "kind": "total", "force": [0.0, -1.0]}])
        motions, stresses, r = rest.displacements, disc_stresses(block, rest.contact_forces), np.hypot(*places.T)
        reach = -places[block.groups["bottom"][0], 1]
        line = (np.abs(places[:, 0]) < 0.1 * radius) & (places[:, 1] < -3 * radius) & (places[:, 1] > -0.9 * reach)
        # depth over the diameter, stress over Flamant's and settlement times E/P below the load, the deepest first
        self.below = [(-places[d, 1] / (2 * radius), -stresses[d, 1, 1] * math.pi * r[d] / 2, -motions[d, 1] * young)
                      for d in np.flatnonzero(line)]
        self.half_way = self.below[len(self.below) // 2]
        self.deep, self.shallow = self.below[len(self.below) // 4], self.below[3 * len(self.below) // 4]
        # difference of the settlements at a quarter and at three quarters of the line over 2/pi ln(z2/z1)
        self.settled = ((self.shallow[2] - self.deep[2]) / (2 / math.pi * math.log(self.deep[0] / self.shallow[0])))
        ring = (r >= 0.25 * reach) & (r <= 0.75 * reach) & (places[:, 1] <= -2 * radius)
        n, unit, t = places[ring] / r[ring, None], 2 / (math.pi * r[ring]), stresses[ring]

        def stress(a, b):
            return np.einsum("ki,kij,kj->k", a, t, b)

        def root(squares):
            return math.sqrt(np.mean(squares))
        radial = 2 * places[ring, 1] / (math.pi * r[ring]**2)
        self.stress = root(((stress(n, n) - radial) / unit)**2)
        self.other = root(((stress(turned(n), turned(n)) / unit)**2 + (stress(n, turned(n)) / unit)**2) / 2)
        self.displacement = root((((motions[ring] - displacement(places[ring])) * young)**2).sum(axis=1))


def point_load(quick):
    progress, findings, rows, series = Progress("a point load:"), Findings("point_load"), [], []
    depths = [12, 24, 48] if quick else [16, 32, 64, 128, 256]
    for ratio, colour in ((0.0, "blue"), (0.5, "vermilion")):
        blocks, name = [], f"kT/kN = {ratio:g}"
        for depth in depths:
            blocks.append(LoadedBlock(depth, ratio))
            rows.append({"kT_over_kN": ratio, "rows": depth, "stress_difference": blocks[-1].stress,
                         "other_stresses": blocks[-1].other, "displacement_difference": blocks[-1].displacement})
            progress.update(len(rows) / (2 * len(depths)))
        last, before = blocks[-1], blocks[-2]
        findings.formula(f"{name}: stress below the load over 2 P/(pi r), at {last.half_way[0]:.0f} diameters", 1,
                         "Flamant 1892", step_error(before.half_way[1], last.half_way[1]), WHY["lattice"])
        findings.formula(f"{name}: settlement at {last.shallow[0]:.0f} less that at {last.deep[0]:.0f} diameters over "
                         "2 P/(pi E) ln(z2/z1)", 1, "Flamant 1892", step_error(before.settled, last.settled), WHY["lattice"])
        for what, unit, marker in (("stress", "2P/(πr)", "circle"), ("displacement", "P/E", "square")):
            errors = [getattr(block, what) for block in blocks]
            order = [math.log(a / b) / math.log(y / x) for a, b, x, y in zip(errors, errors[1:], depths, depths[1:])]
            findings.trend(f"{name}: the difference of the {what} vanishes with the size", "Flamant 1892",
                           order[-1] > 0.8 and errors[-1] < errors[0], f"{errors[-1]:.2g} at {depths[-1]} rows, order "
                           f"{order[-1]:.2f} ± {abs(order[-1] - order[-2]):.2f}")
            series.append(points(f"{what}, over {unit}, $k_T/k_N$ = {ratio:g}", depths, errors, colour, marker,
                                 filled=marker == "circle", joined=True))
    progress.end()
    findings.tables["point_load"] = columns_of(rows)
    findings.plots["point_load"] = Plot("Point load on a hexagonal half-plane: difference from the elastic solution",
                                        Axis("depth of the block, rows", logarithmic=True),
                                        Axis("root mean square of the difference", logarithmic=True), series)
    return findings


# ---- moduli of packings

RATIOS = (0.05, 0.25, 0.5, 1)
MODULI = ("z_without_rattlers", "K_over_kN", "G_over_kN", "K_over_uniform_strain", "G_over_uniform_strain",
          "slip_by_displacements", "slip_by_rotations")


def packed_moduli(arguments):
    """The numbers MODULI of a packing for each kT/kN."""
    discs, overlap, seed = arguments
    radii = 0.4 + 0.3 * np.arange(discs) / discs
    side = math.sqrt(sum(math.pi * r * r for r in radii) / 0.85)
    packing = eq.pack_discs(radii, (side, side), overlap=overlap, seed=seed)
    network, found = packing.assembly, []
    (i, j), n, branch = network.contacts.T, network.normals, branches(network)
    t = turned(n)

    def components(direction):
        """Of the branch in the unit strains xx, yy, xy."""
        (a, b), (x, y) = direction.T, branch.T
        return np.stack([a * x, b * y, 0.5 * (a * y + b * x)], axis=1)
    normal, tangential = components(n), components(t)
    for ratio in RATIOS:
        exact = eq.homogenize(network, eq.Springs(1.0, float(ratio)))
        C = (normal.T @ normal + ratio * tangential.T @ tangential) / network.area
        K, G = (C[0, 0] + C[1, 1] + 2 * C[0, 1]) / 4, (C[0, 0] + C[1, 1] - 2 * C[0, 1] + 4 * C[2, 2]) / 8
        # Slip of the contacts under the unit shear strain: that of uniform strain, and what displacements and rotations
        # of the discs add to it, each summed with the uniform one and over its square.
        slip, moved = tangential[:, 2], exact.fluctuations.xy
        displaced = ((moved.displacements[j] - moved.displacements[i]) * t).sum(axis=1)
        rolled = -(network.levers[:, 0] * moved.rotations[i] + network.levers[:, 1] * moved.rotations[j])
        found.append((packing.coordination_number_without_rattlers, exact.bulk_modulus_2d, exact.shear_modulus,
                      exact.bulk_modulus_2d / K, exact.shear_modulus / G, slip @ displaced / (slip @ slip),
                      slip @ rolled / (slip @ slip)))
    return found


def disc_moduli(quick):
    discs, count, overlaps = (150, 4, [1e-4, 5e-3, 0.04]) if quick else (800, 12, [1e-5, 1e-3, 5e-3, 0.02, 0.05])
    findings, rows = Findings("disc_moduli", discs=discs, least=overlaps[0], most=overlaps[-1], count=count), []
    for overlap in overlaps:
        found = samples_of(f"packings of overlap {overlap:g}:", packed_moduli, [(discs, overlap, seed) for seed in range(1, count + 1)])
        rows += [(ratio, dict(zip(MODULI, map(mean_of, zip(*own))))) for ratio, own in zip(RATIOS, zip(*found))]
    for modulus in "KG":
        key, series, holds, shares = f"{modulus}_over_uniform_strain", [], True, []
        for ratio, colour in zip(RATIOS, ("sky_blue", "green", "orange", "vermilion")):
            own = [means for at, means in rows if at == ratio]
            share, errors = columns([means[key] for means in own])
            holds = holds and all(b > a - 2.6 * math.hypot(e, f) for a, b, e, f in zip(share, share[1:], errors, errors[1:]))
            shares += share
            series.append(points(f"$k_T/k_N$ = {ratio:g}", [means["z_without_rattlers"].mean for means in own], share, colour,
                                 joined=True, errors=errors))
        findings.trend(f"uniform strain overestimates {modulus}, the less the more contacts there are", "Agnolin & Kruyt 2008",
                       holds and max(shares) < 1, f"{modulus} is {min(shares):.3f} to {max(shares):.3f} of it")
        findings.plots[f"disc_moduli_{modulus}"] = Plot(
            f"{modulus} of random packings of discs over that of uniform strain", Axis("coordination z, without rattlers"),
            Axis(f"{modulus} / {modulus} of uniform strain", 0, 1), series)
    # "Generally": at three quarters of the points displacements do not relax the slip at all.
    moved, rolled = ([means[name].mean for _, means in rows] for name in ("slip_by_displacements", "slip_by_rotations"))
    alone = sum(slip >= 0 for slip in moved)
    findings.trend("along the tangents of contacts the relaxation is generally due to rotations alone", "Agnolin & Kruyt 2008",
                   max(rolled) < 0 and 4 * alone >= 3 * len(rows),
                   f"rotations take up to {-min(rolled):.2f} of the slip of uniform shear; displacements change it by "
                   f"{min(moved):+.2f} to {max(moved):+.2f}, and add to it at {alone} of {len(rows)} points, those of smaller kT/kN")
    table = {"kT_over_kN": [ratio for ratio, _ in rows]}
    for name in MODULI:
        table[name], table[name + "_standard_error"] = columns([means[name] for _, means in rows])
    findings.tables["disc_moduli"] = table
    return findings


# ---- the whole

ITEMS = {item.__name__: item for item in (bond_dilution, site_dilution, adsorption, jamming, friction, impacts, lammps,
                                          point_load, disc_moduli)}


def reproduce(options):
    sections = []
    for name in options.only:
        begun = time.monotonic()
        sections.append(ITEMS[name](options.quick))
        sections[-1].seconds = time.monotonic() - begun
    tables = {f"{name}_values": table for one in sections for name, table in one.tables.items()}
    rows = [{"item": one.name, **comparison.numbers()} for one in sections for comparison in one.comparisons]
    tables["comparisons"] = {key: column for key, column in columns_of(rows).items() if key != "agrees"}
    items = [{"item": one.name, "seconds": one.seconds, "comparisons": [c.numbers() for c in one.comparisons],
              "trends": one.trends} for one in sections]
    return Output(report(sections), {"quick": options.quick, "items": items}, tables,
                  {name: plot for one in sections for name, plot in one.plots.items()}, {"validation.md": page(sections, options.quick)})


if __name__ == "__main__":
    main("validation", __doc__, reproduce, files=lambda options: ["validation.md", "comparisons.csv"],
         add_options=lambda parser: parser.add_argument("--only", choices=ITEMS, nargs="+", default=list(ITEMS), metavar="ITEM",
                                                        help="items to compute, of " + ", ".join(ITEMS)))
