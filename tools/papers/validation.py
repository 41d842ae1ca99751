#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Numbers that others have published (rigidity, adsorption, jamming, friction, impacts, LAMMPS, a point load, moduli),
computed again, with error bars and verdicts.

Example:
  tools/papers/validation.py --out figures      minutes; with --quick one
"""
import math
import time

import numpy as np

from common import (Output, eq, fit_line, frames, hexagonal_moduli, main, mean_columns, mean_of,
                    moduli_of, power, rows_of, seeds_of, tracked, unit_motions)
from shown import Row
from validation_spheres import NUMBERS, STORED, THEIR_TOLERANCE, impacts, lammps, step_error

SOURCES = rows_of("validation/sources")
CONFIDENCE_WIDTH = 2.576  # standard errors of 99 % of a normal distribution
ROUND_OFF = 1e-12  # relative, of a computation of some thousand steps


def estimate(found):
    """Number and standard error of a mean, of the end of a line at 0, or of a pair."""
    for number, error in (("mean", "standard_error"), ("intercept", "intercept_error")):
        if number in found:
            return found[number], found[error]
    return found


# ---- missing bonds and discs

# Removed bonds keep this share of their stiffness, so that floppy cells have moduli, too; more where the matrix is
# else too close to singular.
REMAINDERS = (1e-11, 1e-10, 1e-9)


def stiffnesses(cell, bonds, order, kept, removed=REMAINDERS[0]):
    there = np.isin(np.arange(len(order)), order[:kept])
    return np.where(there if bonds else there[cell.contacts].all(axis=1), 1.0, removed)


def share_in_removed(cell, kN):
    """Share of the remainders in the energy of the softest strain: 1 of a floppy cell, whose stiffness is proportional
    to the remainder, 0 of a rigid one."""
    result = eq.homogenize(cell, eq.Springs(kN, 0 * kN))
    scale = np.array([1, 1, math.sqrt(2)])
    softest = scale * np.linalg.eigh(np.outer(scale, scale) * np.array(result.stiffness))[1][:, 0]
    uniform, displaced, _ = unit_motions(cell, result)
    energy = kN * np.tensordot(softest, uniform + displaced, 1)[:, 0]**2
    return energy[kN < 1].sum() / energy.sum()


def is_rigid(cell, bonds, order, kept):
    for removed in REMAINDERS:
        try:
            return share_in_removed(cell, stiffnesses(cell, bonds, order, kept, removed)) < 0.5
        except eq.ComputationFailed:
            if removed == REMAINDERS[-1]:
                raise


def onset(arguments):
    """The share of bonds or sites at which a cell becomes rigid, as they come back in a random order."""
    bonds, size, seed = arguments
    cell = eq.delaunay(discs=size * size, points="perturbed_hexagonal", disorder=0.1, seed=seed, periodic=True,
                       radius=0.5)
    order = eq._core.Random(seed ^ 0x5BD1E995).order(len(cell.contacts) if bonds else len(cell))
    floppy, rigid = int(0.5 * len(order)), int(0.9 * len(order))
    while rigid - floppy > 1:
        middle = (floppy + rigid) // 2
        floppy, rigid = (floppy, middle) if is_rigid(cell, bonds, order, middle) else (middle, rigid)
    return rigid / len(order)


def dilution(bonds, size):
    """Thresholds of rigidity, from onsets of cells of several sizes."""
    what, name = ("bonds", "bond") if bonds else ("discs", "site")
    exponent, rows, onsets = NUMBERS["rigidity exponent"].value, [], []
    for side, count in size.cells:
        shares = sorted(seeds_of(f"removing {what} of {side} x {side} discs:", onset, count, bonds, side))
        mean = mean_of(shares)
        rows.append(Row(side_discs=side, samples=count, mean_onset=mean.mean, standard_error=mean.standard_error,
                        standard_deviation=mean.standard_deviation))
        onsets.append(Row(side=side, shares=shares))
    fit = fit_line((row.side_discs**(-1 / exponent), row.mean_onset, row.standard_error) for row in rows)
    # Where the curves "share of cells that are rigid" of both sizes cross, both normal distributions of the onsets.
    (m1, e1, s1, n1), (m2, e2, s2, n2) = ((row.mean_onset, row.standard_error, row.standard_deviation, row.samples)
                                          for row in (rows[0], rows[-1]))
    wide, t1, t2 = s1 - s2, s1 / math.sqrt(2 * (n1 - 1)), s2 / math.sqrt(2 * (n2 - 1))
    error = math.hypot(s2 / wide * e1, s1 / wide * e2, s2 * (m1 - m2) / wide**2 * t1, s1 * (m2 - m1) / wide**2 * t2)
    return {"exponent": exponent, "onsets": onsets, "name": name, "what": what, "fit": fit,
            "crossing": ((m2 * s1 - m1 * s2) / wide, error), "threshold": NUMBERS[name + " threshold"]}, {
                name + "_onsets": rows}


def site_dilution(size):
    return dilution(False, size)


def effective_medium(p):
    """K and G over those of the full lattice (Feng et al. 1985): (p - 2/3)/(1/3)."""
    return 1 - (1 - p) / (1 - NUMBERS["effective-medium threshold"].value)


def relative_moduli(arguments):
    side, p, seed = arguments
    cell = eq.hexagonal(columns=side, rows=side, radius=0.5, periodic=True)
    order = eq._core.Random(seed).order(len(cell.contacts))
    kept = math.floor(p * len(order) + 0.5)
    diluted = eq.homogenize(cell, eq.Springs(stiffnesses(cell, True, order, kept), np.zeros(len(order))))
    full = eq.homogenize(cell, eq.Springs(1.0, 0.0))
    return diluted.bulk_modulus_2d / full.bulk_modulus_2d, diluted.shear_modulus / full.shear_modulus


def bond_dilution(size):
    found, tables = dilution(True, size)
    rows = tables["bond_moduli"] = []
    for p in size.shares:
        K, G = map(mean_of, zip(*seeds_of(f"moduli at p = {p:g}:", relative_moduli, size.count, size.side, p)))
        rows.append(Row(p=p, K_over_full=K.mean, K_standard_error=K.standard_error, G_over_full=G.mean,
                        G_standard_error=G.standard_error, effective_medium=effective_medium(p)))
    found["slopes"] = [fit_line(
        (1 - row.p, (1 - row[name + "_over_full"]) / (1 - row.p), row[name + "_standard_error"] / (1 - row.p))
        for row in rows if row.p >= 0.9) for name in "KG"]
    return found, tables


# ---- packings

def coverage_after(arguments):
    """Discs of diameter 1 in a periodic square, one attempt each."""
    t, side, seed = arguments
    disc = math.pi / 4
    radii = np.full(math.floor(t * side * side / disc + 0.5), 0.5)
    packing = eq.pack_discs(radii, (side, side), method="rejection", attempts=1, seed=seed)
    return len(packing.assembly) * disc / (side * side)


def adsorption(size):
    times = size.times
    coverage = [seeds_of(f"adsorbing until t = {t}:", coverage_after, size.count, t, size.side) for t in times]
    # The coverages of one sample at several times are correlated: a line through those of each sample, then the mean.
    roots, late = [1 / math.sqrt(t) for t in times], list(zip(*coverage[-4:]))
    limit = mean_of(fit_line(zip(roots[-4:], sample, [1] * 4)).intercept for sample in late)
    # theta(4t) - theta(t) falls as t^a: a from two such differences a factor of two in t apart.
    exponent = mean_of(math.log2((d - b) / (c - a)) for a, b, c, d in late)
    means = map(mean_of, coverage)
    rows = [Row(t=t, coverage=mean.mean, standard_error=mean.standard_error) for t, mean in zip(times, means)]
    slope = (rows[-1].coverage - limit.mean) / roots[-1]
    return {"first": times[-4], "last": times[-1], "limit": limit, "slope": slope, "exponent": exponent}, {
        "adsorption": rows}


JAMMING_OVERLAP = 1e-7  # mean, of the mean radius


def jam(arguments):
    """Half of the discs 1.4 times as large as the others, grown in a periodic square until they jam; None: refused."""
    discs, seed = arguments
    radii = np.where(np.arange(discs) < discs // 2, 0.5, 0.7)
    # A start: the radii are scaled.
    side = math.sqrt(sum(math.pi * r * r for r in radii) / NUMBERS["jamming fraction"].value)
    try:
        packing = eq.pack_discs(radii, (side, side), overlap=JAMMING_OVERLAP, seed=seed)
    except eq.ComputationFailed:
        return None
    held, z = discs - packing.rattlers, packing.coordination_number_without_rattlers
    return {"solid_fraction": packing.solid_fraction, "z_without_rattlers": z,
            "contacts_beyond_isostatic": 0.5 * z * held - (2 * held - 1), "share_of_rattlers": packing.rattlers / discs}


def jamming(size):
    # Excess of z at that overlap: 3.6 (phi - phi_J)^(1/2) (O'Hern et al. 2003), phi - phi_J about the overlap.
    nu, excess = NUMBERS["jamming exponent"].value, NUMBERS["excess coordination"].value * math.sqrt(JAMMING_OVERLAP)
    rows, refused = [], 0
    for n, count in size.cells:
        samples = seeds_of(f"jamming {n} discs:", jam, count, n)
        rows.append(Row(discs=n, samples=count, **mean_columns([one for one in samples if one])))
        refused += samples.count(None)

    def line_of(name, x):
        return fit_line((x(row.discs), row[name], row[name + "_standard_error"]) for row in rows)
    return {"overlap": JAMMING_OVERLAP, "exponent": nu, "excess": excess, "refused": refused,
            "line": line_of("solid_fraction", lambda n: n**(-0.5 / nu)),
            "z": line_of("z_without_rattlers", lambda n: 1 / n)}, {"jamming": rows}


def settled(arguments):
    """Discs of two sizes that fall into a box and come to rest: (z without rattlers, root of the largest overlap)."""
    mu, stiffness, discs, damping, seed = arguments
    packing = eq.pack_discs(np.where(np.arange(discs) % 2 == 0, 0.005, 0.007), (0.0108 * math.sqrt(discs), 1.0),
                            method="falling", sides="open_top", seed=seed,
                            settling={"kN": stiffness, "kT": stiffness, "damping": damping, "friction": mu,
                                      "wall_friction": mu, "unbalanced": 1e-5, "longest": 60})
    return packing.coordination_number_without_rattlers, math.sqrt(packing.largest_overlap)


def friction(size):
    soft = 1e7

    def settle(mu, stiffness, damping=1.0):
        found = seeds_of(f"settling with friction {mu:g}, kN = {1e-6 * stiffness:g} MPa:", settled, size.count,
                         mu, stiffness, size.discs, damping)
        z, depth = (mean_of(own) for own in zip(*found))
        return Row(friction=mu, kN_Pa=stiffness, z_without_rattlers=z.mean, standard_error=z.standard_error,
                   root_of_largest_overlap=depth.mean)

    over_friction = [settle(mu, soft) for mu in size.coefficients]
    over_stiffness = [over_friction[-1]] + [settle(10, soft * 10**k) for k in range(1, size.decades + 1)]
    line = fit_line((row.root_of_largest_overlap, row.z_without_rattlers, row.standard_error)
                    for row in over_stiffness)
    z = [row.z_without_rattlers for row in over_friction]
    falls = all(b.z_without_rattlers < a.z_without_rattlers + 2.6 * math.hypot(a.standard_error, b.standard_error)
                for a, b in zip(over_friction, over_friction[1:]))
    braked = [(damping, over_stiffness[1] if damping == 1 else settle(10, 10 * soft, damping))
              for damping in size.dampings]
    return {"line": line, "stiffer": over_stiffness, "over_friction": over_friction, "braked": braked,
            "falls": falls and 3 < z[-1] < 3.25 and z[0] > 3.75}, {"friction": over_friction + over_stiffness[1:]}


# ---- a point load

def half_plane(kT):
    """E and the displacement under a unit force into y < 0 at the origin, in plane stress, up to a rigid translation
    along y (Timoshenko & Goodier, article 36), of the sheet with kN = 1."""
    young, nu = hexagonal_moduli(kT)[2:]

    def displacement(x):
        r, angle, unit = np.hypot(*x.T), np.arctan2(x[:, 0], -x[:, 1]), 1 / (math.pi * young)
        s, c = np.sin(angle), np.cos(angle)
        along = unit * (-2 * c * np.log(r) - (1 - nu) * angle * s)
        across = unit * (2 * nu * s + 2 * s * np.log(r) - (1 - nu) * angle * c + (1 - nu) * s)
        return np.stack([along * s + across * c, -along * c + across * s], axis=1)
    return young, displacement


def loaded_block(depth, kT):
    """A block twice as wide as deep; discs of its sides and bottom follow the elastic solution. Errors in the half ring
    from a quarter to three quarters of the depth, relative to 2 P/(pi r) and P/E; root mean squares."""
    radius = 0.5
    # An odd number of rows: the top row is a long one, with a disc in its middle.
    block = eq.hexagonal(columns=2 * depth + 1, rows=depth | 1, radius=radius)
    top = block.groups["top"]
    loaded = int(top[len(top) // 2])
    places, (young, displacement) = block.centres - block.centres[loaded], half_plane(kT)
    held = list(dict.fromkeys(int(disc) for side in ("left", "right", "bottom") for disc in block.groups[side]))
    rest = eq.solve(block, eq.Springs(1.0, kT), loads=[{"group": [loaded], "kind": "total", "force": [0.0, -1.0]}],
                    supports=[{"group": [disc], "ux": float(u[0]), "uy": float(u[1])}
                              for disc, u in zip(held, displacement(places[held]))])
    motions, stresses, r = rest.displacements, block.disc_stresses(rest.contact_forces), np.hypot(*places.T)
    reach = -places[block.groups["bottom"][0], 1]
    # depth over the diameter, stress over Flamant's and settlement times E/P below the load, the deepest first
    below = [(-places[d, 1] / (2 * radius), -stresses[d, 1, 1] * math.pi * r[d] / 2, -motions[d, 1] * young)
             for d in np.flatnonzero((np.abs(places[:, 0]) < 0.1 * radius) & (places[:, 1] < -3 * radius) &
                                     (places[:, 1] > -0.9 * reach))]
    half_way, deep, shallow = (below[share * len(below) // 4] for share in (2, 1, 3))
    ring = (r >= 0.25 * reach) & (r <= 0.75 * reach) & (places[:, 1] <= -2 * radius)
    n, unit = places[ring] / r[ring, None], 2 / (math.pi * r[ring])
    along = frames(n)  # radial direction, and across
    t = along @ stresses[ring] @ along.transpose(0, 2, 1) / unit[:, None, None]

    def root(squares):
        return math.sqrt(np.mean(squares))
    return Row(
        kT_over_kN=kT, rows=depth, half_way=half_way, deep=deep[0], shallow=shallow[0],
        # difference of the settlements at a quarter and at three quarters of the line over 2/pi ln(z2/z1)
        settled=(shallow[2] - deep[2]) / (2 / math.pi * math.log(deep[0] / shallow[0])),
        stress_difference=root((t[:, 0, 0] - n[:, 1])**2),
        other_stresses=root((t[:, 1, 1]**2 + t[:, 0, 1]**2) / 2),
        displacement_difference=root((((motions[ring] - displacement(places[ring])) * young)**2).sum(axis=1)))


def point_load(size):
    places = [(depth, ratio) for ratio in (0.0, 0.5) for depth in size.depths]
    rows, orders = [loaded_block(*place) for place in tracked("a point load:", places)], []
    lattices = rows[:len(size.depths)], rows[len(size.depths):]
    for blocks in lattices:
        for what in ("stress", "displacement"):
            errors = [block[what + "_difference"] for block in blocks]
            order, before = -power(size.depths, errors), -power(size.depths[:-1], errors[:-1])
            orders.append(Row(ratio=blocks[0].kT_over_kN, what=what, first=errors[0], last=errors[-1], order=order,
                              change=abs(order - before)))
    kept = ("kT_over_kN", "rows", "stress_difference", "other_stresses", "displacement_difference")
    return {"orders": orders, "depth": size.depths[-1], "finest": [blocks[-2:] for blocks in lattices]}, {
        "point_load": [Row({key: row[key] for key in kept}) for row in rows]}


# ---- moduli of packings

RATIOS = (0.05, 0.25, 0.5, 1)


def packed_moduli(arguments):
    """The numbers of a packing for each kT/kN."""
    discs, overlap, seed = arguments
    radii = 0.4 + 0.3 * np.arange(discs) / discs
    side = math.sqrt(sum(math.pi * r * r for r in radii) / 0.85)
    packing = eq.pack_discs(radii, (side, side), overlap=overlap, seed=seed)
    network, found = packing.assembly, []
    for ratio in RATIOS:
        exact = eq.homogenize(network, eq.Springs(1.0, float(ratio)))
        uniform, displaced, rolled = unit_motions(network, exact)
        K, G, _ = moduli_of(np.einsum("ikc,jkc,c->ij", uniform, uniform, (1, ratio)) / network.area)
        # Slip of the contacts under the unit shear strain: that of uniform strain, and what displacements and rotations
        # of the discs add to it, each summed with the uniform one and over its square.
        slip, displaced, rolled = (motions[2, :, 1] for motions in (uniform, displaced, rolled))
        found.append({"z_without_rattlers": packing.coordination_number_without_rattlers,
                      "K_over_kN": exact.bulk_modulus_2d, "G_over_kN": exact.shear_modulus,
                      "K_over_uniform_strain": exact.bulk_modulus_2d / K,
                      "G_over_uniform_strain": exact.shear_modulus / G,
                      "slip_by_displacements": slip @ displaced / (slip @ slip),
                      "slip_by_rotations": slip @ rolled / (slip @ slip)})
    return found


def disc_moduli(size):
    rows = []
    for overlap in size.overlaps:
        found = seeds_of(f"packings of overlap {overlap:g}:", packed_moduli, size.count, size.discs, overlap)
        rows += [Row(kT_over_kN=ratio, **mean_columns(own)) for ratio, own in zip(RATIOS, zip(*found))]
    return {"least": size.overlaps[0], "most": size.overlaps[-1]}, {"disc_moduli": rows}


def grows(rows, key):
    """Whether the means of each kT/kN grow with the overlap, within their errors, and stay below 1."""
    return max(row[key] for row in rows) < 1 and all(
        b[key] > a[key] - 2.6 * math.hypot(a[key + "_standard_error"], b[key + "_standard_error"])
        for a, b in zip(rows, rows[len(RATIOS):]))


# ---- the whole

ITEMS = {item.__name__: item for item in (bond_dilution, site_dilution, adsorption, jamming, friction, impacts, lammps,
                                          point_load, disc_moduli)}


def shown(value, error):
    """"0.6601 ± 0.0012": two digits of the error; without an error ten digits."""
    if not error > 1e-11 * abs(value):
        return f"{value:.10g}"
    decimals = min(max(1 - math.floor(math.log10(error)), 0), 12)
    return f"{value:.{decimals}f} ± {error:.{decimals}f}"


def judged(page, told, names):
    """A comparison: a published number, or a theory, and ours, each with its standard error; `why`: the reason known
    for a difference; allowance: what the published number itself leaves out, added to its error."""
    theirs = NUMBERS[page.fill(told["published"], names)] if "published" in told else Row(
        value=float(page.value(told["theory"], names)), error=0, source=told["source"])
    (ours, own_error), error = map(float, estimate(page.value(told["ours"], names))), float(theirs.error)
    size = max(abs(theirs.value), abs(ours))
    agrees = abs(ours - theirs.value) <= (CONFIDENCE_WIDTH * math.hypot(error, own_error, ROUND_OFF * size) +
                                          page.value(told.get("allowance", 0), names))
    why = page.told["why"].get(page.fill(told.get("why", ""), names), "")
    verdict = "agrees" if agrees else f"differs by {ours - theirs.value:+.2g}" + (": " + why if why else "")
    return Row(quantity=page.fill(told["quantity"], names), published=theirs.value, published_error=error,
               source=theirs.source, ours=ours, standard_error=own_error, agrees=agrees, verdict=verdict)


def decided(page, told, names):
    """A statement without a number."""
    return Row(statement=page.fill(told["statement"], names), source=told["source"],
               holds=bool(page.value(told["holds"], names)), evidence=page.fill(told["evidence"], names))


def section(page, name, size):
    """What an item found, and what its entry in validation.toml says of that."""
    begun, told = time.monotonic(), page.told[name]
    values, tables = ITEMS[name](size)
    names = {**size, **values, **tables}
    comparisons, trends = ([judge(page, *leaf) for leaf in page.leaves({"parts": told.get(kind, [])}, names)]
                           for kind, judge in (("comparisons", judged), ("trends", decided)))
    stored = [row for row in STORED if row.item == name]
    return Row(name=name, heading=told["heading"], words=page.fill(told["text"].strip(), names), tables=tables,
               plots=page.figures(told.get("figures", ()), **names), comparisons=comparisons, trends=trends,
               stored=stored, notes=list(filter(None, (page.fill(note, names) for note in told.get("notes", [])))),
               verdicts=[one.agrees for one in comparisons] + [one.holds for one in trends],
               sources=list(dict.fromkeys(one.source for one in (*comparisons, *trends, *stored))),
               seconds=time.monotonic() - begun)


def reproduce(options, page):
    def command(only=""):
        return f"tools/papers/validation.py{only}{' --quick' if options.quick else ''} --out DIR"
    sections = [section(page, name, Row(options.size.get(name, {}))) for name in options.only]
    tables = {f"{name}_values": rows for one in sections for name, rows in one.tables.items()}
    tables["comparisons"] = [{"item": one.name, **{key: row[key] for key in row if key != "agrees"}}
                             for one in sections for row in one.comparisons]
    tables["summary"] = [{"subject": one.heading, "compared": len(one.verdicts), "agree or hold": sum(one.verdicts),
                          "source": ", ".join(one.sources)} for one in sections]
    tables["differences"] = [
        {"quantity": row.quantity, "published": shown(row.published, row.published_error), "source": row.source,
         "ours": shown(row.ours, row.standard_error), "because": row.verdict.partition(": ")[2].replace(" (see below)", "")}
        for one in sections for row in one.comparisons if not row.agrees]
    items = [{"item": one.name, **{key: one[key] for key in ("seconds", "comparisons", "trends", "stored")}}
             for one in sections]
    return Output({"sections": sections, "command": command}, {"items": items}, tables,
                  plots={name: plot for one in sections for name, plot in one.plots.items()})


if __name__ == "__main__":
    main(reproduce, lambda parser: parser.add_argument(
        "--only", choices=ITEMS, nargs="+", default=list(ITEMS), metavar="ITEM",
        help="items to compute, of " + ", ".join(ITEMS)))
