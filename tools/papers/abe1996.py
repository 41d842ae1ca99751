#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Abe (1996), "Spring constants of distinct element in continuum analysis", computed again: the tension test of Figs. 6
to 8, macroscopic stress of section 4, and what its ends, its size and the lattice do to it.

Examples:
  tools/papers/abe1996.py                  tables on the screen
  tools/papers/abe1996.py --out figures    and Figs. 6, 7, 8, the error against size: seconds
"""
import math

import common
import numpy as np
from common import Axis, Output, Plot, Progress, Series, Table, counted, curve, eq, mean_of

SQRT3 = math.sqrt(3)
LARGE_ROWS = 129
SIZES = (9, 17, 33, 65, 129)
STRESS = 1e6  # Pa
KN = 1e9  # Pa
RADIUS = 0.005  # m
SHOWN_RATIO = 0.5  # kT/kN of the picture
UNEQUAL = {"discs": 400, "samples": 12, "ratio": 0.25}


# Abe's relations between springs and continuum, r = kT/kN.
def theory_nu(r):
    """(22), plane strain."""
    return (1 - r) / 4


def theory_stiffness(r):
    """(37): 2 G/((1 - nu) kN)."""
    return 2 * (SQRT3 / 4) * (1 + r) / (1 - theory_nu(r))


def in_plane_stress(nu):
    """nu of plane stress, -e22/e11, from that of plane strain, nu/(1 - nu): section 2 in the other direction."""
    return nu / (1 - nu)


def block_of(columns, rows):
    return eq.hexagonal(columns=columns, rows=rows, radius=RADIUS)


def tension(block, ratio, gauge, **tables):
    return eq.tension_test(block, (KN, ratio * KN), stress=STRESS, gauge=gauge, **tables)


def affine_forces(cell, kN, kT, h, rotation):
    """Normal (tension positive) and tangential forces of the contacts where all discs follow the gradient
    h = [[u1,1, u1,2], [u2,1, u2,2]] and turn by the rotation; frames (normal, tangent) of the contacts beside them."""
    normals = np.array(cell.normals)
    tangents = np.stack([-normals[:, 1], normals[:, 0]], axis=1)
    lengths = np.array(cell.levers).sum(axis=1)
    moved = lengths[:, None] * (normals @ np.array(h).T)
    stretch, slip = (moved * normals).sum(axis=1), (moved * tangents).sum(axis=1) - rotation * lengths
    return np.stack([kN * stretch, kT * slip], axis=1), normals, tangents


def disc_stresses(cell, forces):
    """(50) of every disc, (n, 2, 2): force by arm over the area of the cell of the disc."""
    normals = np.array(cell.normals)
    tangents = np.stack([-normals[:, 1], normals[:, 0]], axis=1)
    on_i = forces[:, :1] * normals + forces[:, 1:] * tangents
    dyad = on_i[:, :, None] * normals[:, None, :]
    stresses, levers = np.zeros((len(cell), 2, 2)), np.array(cell.levers)
    for side in (0, 1):
        np.add.at(stresses, np.array(cell.contacts)[:, side], levers[:, side, None, None] * dyad)
    return stresses / np.array(cell.cell_areas)[:, None, None]


def uniform_state(columns, rows, ratio, gauge):
    """nu of the test under the loads that a uniform state needs in place of equal ones, and these loads on the right
    side over the mean load of a row."""
    block = block_of(columns, rows)
    e11 = STRESS / (KN * theory_stiffness(ratio))
    h = np.diag([e11, -in_plane_stress(theory_nu(ratio)) * e11])
    forces, normals, tangents = affine_forces(block, KN, ratio * KN, h, 0)
    on_i = forces[:, :1] * normals + forces[:, 1:] * tangents
    missing, contacts, levers = np.zeros((len(block), 3)), np.array(block.contacts), np.array(block.levers)
    for side, sign in ((0, -1), (1, 1)):
        np.add.at(missing[:, :2], contacts[:, side], sign * on_i)
        np.add.at(missing[:, 2], contacts[:, side], -levers[:, side] * forces[:, 1])
    test = tension(block, ratio, gauge)
    left = [int(disc) for disc in block.groups["left"]]  # held, without reactions: the loads are in balance
    supports = [{"group": left[:1], "ux": 0.0, "uy": 0.0}, {"group": left[-1:], "ux": 0.0}]
    rest = eq.factorize(block, (KN, ratio * KN), supports).solve(missing)
    (a, b), (c, d) = test.gauge.horizontal, test.gauge.vertical
    centres, moves = np.array(block.centres), np.array(rest.displacements)
    xx = (moves[b, 0] - moves[a, 0]) / (centres[b, 0] - centres[a, 0])
    yy = (moves[d, 1] - moves[c, 1]) / (centres[d, 1] - centres[c, 1])
    right = block.groups["right"]
    shares = [missing[disc, 0] / (STRESS * test.height / rows) for disc in right]
    edges = {"total": sum(shares), "corner": shares[0], "short_row": shares[1], "long_row": shares[2], "rows": rows}
    return -yy / (xx - yy), edges


def ratio_point(block, ratio, gauge):
    test = tension(block, ratio, gauge)
    return {"ratio": ratio, "poisson_ratio": test.poisson_ratio, "stiffness_ratio": test.stiffness_ratio,
            "negative_pivots": test.negative_pivots, "unstable_modes": test.unstable_modes,
            "relative_residual": test.relative_residual, "stable": test.unstable_modes == 0,
            "theory_poisson_ratio": theory_nu(ratio), "theory_stiffness_ratio": theory_stiffness(ratio)}


def explain_error(rows, columns, gauge, ratio=1):
    """The tension test at one ratio on other blocks and under other loads: causes of the error of nu."""
    def nu(columns, rows):
        return tension(block_of(columns, rows), ratio, gauge).poisson_ratio
    size = f"{rows} rows of {{}} discs".format
    found = {size(columns) + ", equal loads (Fig. 6)": nu(columns, rows)}
    found.update({size(times * columns): nu(times * columns, rows) for times in (2, 4, 8)})
    found[f"{LARGE_ROWS} rows of {LARGE_ROWS} discs"] = nu(LARGE_ROWS, LARGE_ROWS)
    found[size(columns) + ", loads of the uniform state"], edges = uniform_state(columns, rows, ratio, gauge)
    cell = eq.hexagonal(columns=8, rows=8, radius=RADIUS, periodic=True)
    found["periodic cell, homogenized"] = eq.homogenize(cell, (1.0, float(ratio))).poisson_ratio.plane_strain
    return {"ratio": ratio, "theory": theory_nu(ratio), "variations": found, **edges}


def check_stress(rows, columns, gauge):
    """Section 4: macroscopic stress of uniform strain on the periodic lattice, largest deviation over discs, strains
    and ratios, relative to the largest stress, from (52) and from (55)."""
    cell = eq.hexagonal(columns=8, rows=8, radius=RADIUS, periodic=True)
    worst = {"free": 0.0, "restrained": 0.0}
    gradients = [[[1e-3, 0], [0, 0]], [[0, 0], [0, 1e-3]], [[0, 1e-3], [0, 0]], [[0, 0], [1e-3, 0]],
                 [[7e-4, -3e-4], [9e-4, 2e-4]]]
    for kN, kT in ((KN, ratio * KN) for ratio in (-0.3, -0.1, 0.0, 0.25, 0.5, 1.0)):
        for h in map(np.array, gradients):
            volume, spin = np.trace(h), h[1, 0] - h[0, 1]
            shear, bulk = SQRT3 / 4 * (kN + kT), SQRT3 / 2 * kN  # (34)
            continuum = (bulk - shear) * volume * np.eye(2) + shear * (h + h.T)  # (52)
            # (55) over the cell 2 sqrt3 a^2, its first bracket completed by d_2i d_2j (u_1,1 + 3 u_2,2).
            cosserat = SQRT3 / 4 * ((kN - kT) * volume * np.eye(2) + (kN + kT) * (h + h.T))
            cosserat = cosserat + SQRT3 / 2 * kT * spin * np.array([[0, -1], [1, 0]])
            for name, rotation, expected in (("free", spin / 2, continuum), ("restrained", 0, cosserat)):
                stresses = disc_stresses(cell, affine_forces(cell, kN, kT, h, rotation)[0])
                worst[name] = max(worst[name], np.abs(stresses - expected).max() / np.abs(expected).max())
    ratio, spin = 0.5, 1e-3
    forces = affine_forces(cell, KN, ratio * KN, [[0, 0], [spin, 0]], 0)[0]
    stress = np.tensordot(cell.cell_areas, disc_stresses(cell, forces), 1) / cell.area
    moments = -(np.array(cell.levers).sum(axis=1) * forces[:, 1]).sum() / cell.area
    restrained = tension(block_of(columns, rows), ratio, gauge, effects={"rotation": "restrained"})
    return {"free_rotation_deviation": worst["free"], "restrained_rotation_deviation": worst["restrained"],
            "ratio": ratio, "spin": spin, "asymmetry": stress[0, 1] - stress[1, 0],
            "expected_asymmetry": -SQRT3 * ratio * KN * spin, "moment_density": moments,
            "restrained_poisson_ratio": restrained.poisson_ratio}


def nu_along_x(c):
    """nu of plane strain of a uniaxial stress along x: with e22 = -(C12/C22) e11 in eq. (35)."""
    return c[0][1] / (c[1][1] + c[0][1])


def wave_moduli(cell, springs, **tables):
    """gamma c^2 of long waves, longitudinal and transverse, every 15 degrees, Pa."""
    waves = eq.stability(cell, springs, density=1.0, **tables)
    return [[waves.mass_per_area * speed ** 2 for speed in speeds]
            for speeds in zip(waves.sound_speeds.longitudinal, waves.sound_speeds.transverse)]


def square_lattice():
    """Section 2.2, kN = 1 Pa."""
    cell, points = eq.square(columns=8, rows=8, radius=RADIUS, periodic=True), []
    # C' = T C T^T at 45 degrees
    turn = np.array([[0.5, 0.5, 1], [0.5, 0.5, -1], [-0.5, 0.5, 0]])
    for ratio in (0.1, 0.25, 0.5, 1.0, 2.0):
        found, waves = eq.homogenize(cell, (1.0, ratio)), wave_moduli(cell, (1.0, ratio))
        along = np.array(found.stiffness)
        turned = turn @ along @ turn.T
        points.append({"ratio": ratio, "along_rows": along, "turned": turned, "anisotropy": found.anisotropy,
                       "poisson_ratio_rows": nu_along_x(along), "poisson_ratio_diagonal": nu_along_x(turned),
                       "waves_rows": waves[0], "waves_diagonal": waves[3]})
    return points


def restrained_waves():
    """The hexagonal lattice with rotation restrained and springs of eq. (53) for G = 1 Pa."""
    cell, points, held = eq.hexagonal(columns=8, rows=8, radius=RADIUS, periodic=True), [], {"rotation": "restrained"}
    for nu in (-0.5, 0.0, 0.1, 0.2, 0.25):
        bulk_wanted = 1 / (1 - 2 * nu)
        kT = max(0.0, (2 - bulk_wanted) / (2 * SQRT3))
        kN = kT + 2 * bulk_wanted / SQRT3
        waves = wave_moduli(cell, (kN, kT), effects=held)
        pairs = [(transverse, longitudinal - transverse) for longitudinal, transverse in waves]
        shear, bulk = pairs[0]
        stress = eq.homogenize(cell, (kN, kT), effects=held).stiffness
        points.append({"wanted_poisson_ratio": nu, "kN": kN, "kT": kT, "shear_modulus": shear,
                       "poisson_ratio": (bulk - shear) / (2 * bulk),
                       "deviation": max(max(abs(g - 1), abs(k / bulk_wanted - 1)) for g, k in pairs),
                       "poisson_ratio_of_tension": nu_along_x(stress)})
    return points


def scatter(stresses, areas):
    """Mean and standard deviation of each component, weighted by area."""
    shares = areas / areas.sum()
    mean = np.tensordot(shares, stresses, 1)
    return mean, np.sqrt(np.tensordot(shares, (stresses - mean) ** 2, 1))


def unequal_sample(cell, ratio):
    """One random cell under the mean uniaxial stress of 1 Pa along x: end of section 4.2."""
    found = eq.homogenize(cell, (1.0, ratio), homogenize={"bounds": "affine"})
    compliance = np.linalg.inv(found.stiffness)[:, 0]
    strain = np.array([[compliance[0], compliance[2] / 2], [compliance[2] / 2, compliance[1]]])
    forces, normals, tangents = affine_forces(cell, 1, ratio, strain, 0)
    i, j = np.array(cell.contacts).T
    levers = np.array(cell.levers)
    for name, weight in zip(("xx", "yy", "xy"), compliance):
        state = found.fluctuations[name]
        apart = np.array(state.displacements)[j] - np.array(state.displacements)[i]
        turn = np.array(state.rotations)
        forces[:, 0] += weight * (apart * normals).sum(axis=1)
        slip = (apart * tangents).sum(axis=1) - levers[:, 0] * turn[i] - levers[:, 1] * turn[j]
        forces[:, 1] += weight * ratio * slip
    stresses, cells = disc_stresses(cell, forces), np.array(cell.cell_areas)
    # (50) as printed, with the area of the disc over the solid fraction of the assembly in place of the cell
    areas = math.pi * np.array(cell.radii) ** 2 / cell.solid_fraction
    printed_mean, printed_scatter = scatter(stresses * (cells / areas)[:, None, None], areas)
    deviation = scatter(stresses, cells)[1]
    bulk = cell.solid_fraction * cell.coordination_number / (2 * math.pi)  # (21)
    return {"solid_fraction": cell.solid_fraction, "coordination_number": cell.coordination_number,
            "poisson_ratio": found.poisson_ratio.plane_strain,
            "shear_modulus_error": bulk * (1 - 2 * theory_nu(ratio)) / found.shear_modulus - 1,
            "bulk_modulus_error": bulk / found.bulk_modulus_2d - 1, "scatter_xx": deviation[0, 0],
            "scatter_yy": deviation[1, 1], "scatter_xy": deviation[0, 1], "printed_mean_xx": printed_mean[0, 0],
            "printed_scatter_xx": printed_scatter[0, 0]}


def unequal_radii(progress):
    points = []
    for spread in (1.0, 1.25, 1.5, 2.0):
        samples = [unequal_sample(eq.delaunay(
            discs=UNEQUAL["discs"], points="poisson_disc", seed=seed, periodic=True,
            radii={"smallest": RADIUS, "largest": spread * RADIUS}), UNEQUAL["ratio"])
                   for seed in range(1, UNEQUAL["samples"] + 1)]
        points.append({"spread": spread, **{key: mean_of(sample[key] for sample in samples) for key in samples[0]}})
        progress.update(0.75 + 0.25 * len(points) / 4)
    return points


def compute(rows, columns, gauge):
    progress = Progress("reproducing Abe 1996")
    block, large = block_of(columns, rows), block_of(LARGE_ROWS, LARGE_ROWS)
    test = tension(block, SHOWN_RATIO, gauge)
    centres = np.array(block.centres)
    lengths = [float(np.hypot(*(centres[b] - centres[a]))) for a, b in (test.gauge.horizontal, test.gauge.vertical)]
    result = {"columns": columns, "rows": rows, "height": test.height, "gauge_length": lengths[0],
              "gauge_height": lengths[1], "critical_ratio_lattice": -1 / 3}
    result["points"] = [ratio_point(block, step / 20, gauge) for step in range(-18, 21)]
    progress.update(0.2)
    result["large_points"] = [ratio_point(large, step / 10, gauge) for step in range(-2, 11)]
    progress.update(0.4)
    result["convergence"] = []
    for ratio in (0.0, 0.1, 0.5, 1.0):
        for size in SIZES:
            point = ratio_point(block_of(size, size), ratio, gauge)
            result["convergence"].append({
                "ratio": ratio, "rows": size, "poisson_ratio_error": abs(point["poisson_ratio"] - theory_nu(ratio)),
                "stiffness_ratio_error": abs(point["stiffness_ratio"] / theory_stiffness(ratio) - 1)})
    progress.update(0.6)
    result["edges"] = explain_error(rows, columns, gauge)
    supported = eq.Case(assembly=block, springs=(KN, KN), test={"kind": "uniaxial_tension", "gauge": gauge})
    result["critical_ratio_block"] = supported.stability().critical_ratio
    result["macroscopic_stress"] = check_stress(rows, columns, gauge)
    progress.update(0.75)
    result.update(square_lattice=square_lattice(), restrained_waves=restrained_waves(),
                  unequal_radii=unequal_radii(progress))
    progress.end()
    return result


def shown(value):
    """Without the sign of a number that is zero to five digits."""
    return 0.0 if abs(value) < 5e-6 else value


def report(r):
    """tools/papers/abe1996.txt with its numbers."""
    ratios = Table("kT/kN & nu (35) & (1-r)/4 & difference & plane stress & (1-r)/(3+r) & (36) & (37) & difference & "
                   "negative pivots & ")
    for p in r["points"]:
        found, nu, stiffness = p["poisson_ratio"], p["theory_poisson_ratio"], p["theory_stiffness_ratio"]
        state = "stable" if p["stable"] else f"UNSTABLE by {counted(p['unstable_modes'], 'mode')}"
        ratios.add(f"{p['ratio']:>5.2f} & {found:.5f} & {nu:.5f} & {found - nu:.1e} & {in_plane_stress(found):.5f} & "
                   f"{in_plane_stress(nu):.5f} & {p['stiffness_ratio']:.5f} & {stiffness:.5f} & "
                   f"{p['stiffness_ratio'] - stiffness:.1e} & {p['negative_pivots']} & {state}")
    head, slopes, rows = "rows", "slope", [f"{size:>5}" for size in SIZES]
    for ratio in sorted({p["ratio"] for p in r["convergence"]}):
        head += f" & kT/kN = {ratio:.1f}: nu & (36)"
        for key in ("poisson_ratio_error", "stiffness_ratio_error"):
            errors = [p[key] for p in r["convergence"] if p["ratio"] == ratio]
            rows = [f"{row} & {error:.1e}" for row, error in zip(rows, errors)]
            slopes += " & round-off" if ratio == 0 else \
                f" & {math.log(errors[-1] / errors[-2]) / math.log(SIZES[-1] / SIZES[-2]):.2f}"
    causes, theory = Table(" & nu & difference from theory"), theory_nu(r["edges"]["ratio"])
    for name, nu in r["edges"]["variations"].items():
        causes.add(f"{name} & {shown(nu):.5f} & {nu - theory:.1e}")
    square, worst = Table("kT/kN & C11/kN & C12/kN & C66/kN & at 45°: C11/kN & C12/kN & C66/kN & anisotropy & "
                          "nu, rows & nu, 45° & waves, rows: L & T & waves, 45°: L & T"), 0
    for p in r["square_lattice"]:
        x, c, t = p["ratio"], p["along_rows"], p["turned"]
        tensor, waves = [c[0, 0], c[0, 1], c[2, 2], t[0, 0], t[0, 1], t[2, 2]], [*p["waves_rows"], *p["waves_diagonal"]]
        others = [p["anisotropy"], p["poisson_ratio_rows"], p["poisson_ratio_diagonal"]]
        square.add(f"{x:.2f}" + "".join(f" & {shown(number):.4f}" for number in (*tensor, *others, *waves)))
        formulas = [1, 0, x / 2, (1 + x) / 2, (1 - x) / 2, 0.5, 1, x / 2, (1 + x) / 2, 0.5]
        worst = max([worst, *(abs(number - wanted) for number, wanted in zip((*tensor, *waves), formulas))])
    waves = Table("nu wanted & kN/G (53) & kT/G (53) & waves: G & nu & largest deviation & uniaxial stress: nu & "
                  "(1-r)/4")
    for p in r["restrained_waves"]:
        waves.add(f"{p['wanted_poisson_ratio']:.2f} & {p['kN']:.5f} & {p['kT']:.5f} & {p['shear_modulus']:.5f} & "
                  f"{shown(p['poisson_ratio']):.5f} & {p['deviation']:.0e} & {p['poisson_ratio_of_tension']:.5f} & "
                  f"{theory_nu(p['kT'] / p['kN']):.5f}")
    unequal = Table("radii & phi & z & nu & mean field: G & K & s11, sd & s22, sd & s12, sd & "
                    "with pi r²/phi: mean s11 & sd")
    for p in r["unequal_radii"]:
        mean = {key: value.mean for key, value in p.items() if key != "spread"}
        unequal.add(f"1 to {p['spread']:g} & {mean['solid_fraction']:.4f} & {mean['coordination_number']:.3f} & "
                    f"{mean['poisson_ratio']:.4f} ± {p['poisson_ratio'].standard_error:.4f} & "
                    f"{100 * mean['shear_modulus_error']:+.1f} % & {100 * mean['bulk_modulus_error']:+.1f} %" + "".join(
                        f" & {mean[key]:.3f}" for key in ("scatter_xx", "scatter_yy", "scatter_xy", "printed_mean_xx",
                                                          "printed_scatter_xx")))
    scatter, printed_scatter = ([100 * r["unequal_radii"][k][key].mean for k in (0, -1)]
                                for key in ("scatter_xx", "printed_scatter_xx"))
    x = r["macroscopic_stress"]["ratio"]
    of_53 = (2 * (1 - x) - (1 + 3 * x)) / (4 * (1 - x))  # (K - G)/(2 K)
    return common.filled("abe1996", **r, short_row=r["columns"] - 1, radius=RADIUS, kN=KN, stress=STRESS,
                         table_of_ratios=ratios, table_of_sizes=Table(head, *rows, slopes), table_of_causes=causes,
                         table_of_square=square, worst_of_square=worst, table_of_waves=waves, table_of_unequal=unequal,
                         section4={**r["macroscopic_stress"], "theory": theory_nu(x), "of_53": of_53},
                         unequal={**UNEQUAL, "theory": theory_nu(UNEQUAL["ratio"])}, scatter=scatter,
                         printed_scatter=printed_scatter, spread=r["unequal_radii"][-1]["spread"])


def points_of(points, key, mark, **look):
    return Series(x=[p["ratio"] for p in points], y=[mark(p[key]) for p in points], style="points", **look)


def plots(r):
    rows, columns = r["rows"], r["columns"]
    ratio = "$k_T/k_N$"

    def title(figure):
        return f"Abe (1996), {figure}: {rows} rows of {columns} and {columns - 1} discs"

    def poisson(name, plane, high, theory, mark):
        stable = [p for p in r["points"] if p["stable"]]
        unstable = [p for p in r["points"] if not p["stable"]]
        key = "poisson_ratio"
        return Plot(title(name), Axis(ratio, -1, 1), Axis(f"Poisson's ratio ν (plane {plane})", -0.2, high), [
            curve(lambda x: mark(theory_nu(x)), -1, 1, label=theory, column="theory"),
            points_of(r["large_points"], key, mark, label=f"{LARGE_ROWS} rows", colour="orange", marker="square",
                      filled=False, column="nu_large"),
            points_of(stable, key, mark, label=f"{rows} rows, stable", colour="blue", column="nu_stable"),
            points_of(unstable, key, mark, label=f"{rows} rows, unstable", colour="vermilion", filled=False,
                      column="nu_unstable")],
            [(-1 / 3, "infinite lattice: -1/3", "black"),
             (r["critical_ratio_block"], f"this block: {r['critical_ratio_block']:.4f}", "vermilion")])

    def same(value):
        return value
    positive = [[p for p in r[key] if p["ratio"] >= 0] for key in ("points", "large_points")]
    figure8 = Plot(title("Fig. 8"), Axis(ratio, 0, 1), Axis("$2G/((1 - ν) k_N)$", 1, 2), [
        curve(theory_stiffness, 0, 1, label="eq. (37)", column="theory"),
        points_of(positive[1], "stiffness_ratio", same, label=f"{LARGE_ROWS} rows", colour="orange", marker="square",
                  filled=False, column="large"),
        points_of(positive[0], "stiffness_ratio", same, label=f"{rows} rows, eq. (36)", colour="blue",
                  column="computed")])
    by_size = Plot("Abe's tension test: error against size", Axis("rows", logarithmic=True),
                   Axis("error", logarithmic=True))
    for value, colour in ((0.1, "orange"), (0.5, "blue"), (1.0, "vermilion")):  # 0 is exact but for round-off
        points = [p for p in r["convergence"] if p["ratio"] == value]
        for key, name, marker in (("poisson_ratio_error", "ν", "circle"), ("stiffness_ratio_error", "(36)", "square")):
            by_size.series.append(Series(
                f"{name}, {ratio} = {value:g}", list(SIZES), [p[key] for p in points], "line_with_points", colour,
                marker, marker == "circle", f"{'nu' if name == 'ν' else 'stiffness'}_{value:g}"))
    by_size.series.append(Series("0.2/rows", list(SIZES), [0.2 / size for size in SIZES], "dashed_line"))
    return {"figure7": poisson("Fig. 7", "strain", 0.8, f"eq. (22): (1 - {ratio})/4", same),
            "figure7_plane_stress": poisson("Fig. 7 in plane stress", "stress", 1.4, f"(1 - {ratio})/(3 + {ratio})",
                                            in_plane_stress),
            "figure8": figure8, "error_by_size": by_size}


def draw_block(rows, columns, gauge, path):
    """Fig. 6: the block under tension, coloured by the stress of its discs."""
    from matplotlib import pyplot
    block = block_of(columns, rows)
    test = tension(block, SHOWN_RATIO, gauge)
    axes = pyplot.subplots(figsize=(9, 8), dpi=100)[1]
    stresses = disc_stresses(block, np.array(test.contact_forces))[:, 0, 0]
    eq.plot.discs(block, axes, displacements=test.displacements, values=stresses, label="stress xx, Pa")
    centres, radius = np.array(block.centres), block.radii[0]
    for side, sign in (("left", -1), ("right", 1)):
        for x, y in centres[block.groups[side]]:
            axes.annotate("", (x + sign * 4 * radius, y), (x + sign * 1.5 * radius, y),
                          arrowprops={"arrowstyle": "->", "color": "#D55E00"})
    for (first, last), names in ((test.gauge.horizontal, "AB"), (test.gauge.vertical, "CD")):
        axes.plot(*centres[[first, last]].T, "k-", linewidth=1.2)
        for disc, name in zip((first, last), names):
            axes.annotate(name, centres[disc], (4, 4), textcoords="offset points", fontweight="bold")
    axes.set_xlim(axes.get_xlim()[0] - 3 * radius, axes.get_xlim()[1] + 3 * radius)
    axes.set_title(f"Abe (1996), Fig. 6: {rows} rows, kT/kN = {SHOWN_RATIO}; {axes.get_title()}", fontsize=11)
    common.save(axes.figure, path)


def reproduce(options):
    global LARGE_ROWS, SIZES
    if options.quick:
        LARGE_ROWS, SIZES, UNEQUAL["samples"] = 33, SIZES[:3], 4
    result = compute(options.rows, options.columns, options.gauge)
    numbers = {key: value for key, value in result.items() if key not in ("edges", "large_points")}
    variations = result["edges"]["variations"].items()
    numbers["error_of_nu"] = [{"block": name, "poisson_ratio": nu} for name, nu in variations]
    numbers["unequal_radii"] = [{key: getattr(value, "mean", value) for key, value in p.items()}
                                for p in result["unequal_radii"]]
    drawn = plots(result)
    drawn["figure6"] = lambda path: draw_block(options.rows, options.columns, options.gauge, path)
    return Output(report(result), numbers, plots=drawn)


def add_options(parser):
    parser.add_argument("--columns", type=int, default=21, help="discs in a long row of the block (21)")
    parser.add_argument("--rows", type=int, default=21, help="rows of the block (21)")
    parser.add_argument("--gauge", choices=("centre", "quarter", "ends"), default="centre",
                        help="where strains are measured")


FIGURES = ("figure6", "figure7", "figure7_plane_stress", "figure8", "error_by_size")
if __name__ == "__main__":
    common.main("abe1996", __doc__, reproduce, add_options=add_options,
                files=lambda options: [f"{name}.svg" for name in FIGURES])
