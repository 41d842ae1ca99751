#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Abe (1996), "Spring constants of distinct element in continuum analysis", computed again: the tension test of Figs. 6
to 8, macroscopic stress of section 4, and what its ends, its size and the lattice do to it.

Examples:
  tools/papers/abe1996.py                  tables on the screen
  tools/papers/abe1996.py --out figures    and Figs. 6, 7, 8, the error against size: seconds
"""
import functools
import math

import numpy as np

from common import (Output, affine_motions, eq, frames, hexagonal_moduli, main, means_of, power, tracked,
                    unit_motions)
from shown import Row, save

SQRT3 = math.sqrt(3)
STRESS = 1e6  # Pa
KN = 1e9  # Pa
RADIUS = 0.005  # m
SHOWN_RATIO = 0.5  # kT/kN of the picture
UNEQUAL_RATIO, UNEQUAL_DISCS = 0.25, 400


# ---- Abe's relations between springs and continuum, r = kT/kN

def theory_nu(r):
    """(22), plane strain."""
    return (1 - r) / 4


def theory_stiffness(r):
    """(37): 2 G/((1 - nu) kN)."""
    return 2 * (SQRT3 / 4) * (1 + r) / (1 - theory_nu(r))


def in_plane_stress(nu):
    """nu of plane stress, -e22/e11, from that of plane strain, nu/(1 - nu): section 2 in the other direction."""
    return nu / (1 - nu)


# ---- Figs. 6 to 8: the tension test

@functools.lru_cache
def block_of(columns, rows):
    return eq.hexagonal(columns=columns, rows=rows, radius=RADIUS)


def periodic(lattice=eq.hexagonal):
    return lattice(columns=8, rows=8, radius=RADIUS, periodic=True)


def tension(block, ratio, **tables):
    return eq.tension_test(block, (KN, ratio * KN), stress=STRESS, gauge="centre", **tables)


def ratio_point(block, ratio):
    test = tension(block, ratio)
    keys = "poisson_ratio", "stiffness_ratio", "negative_pivots", "unstable_modes", "relative_residual"
    return Row(ratio=ratio, **{key: test[key] for key in keys}, stable=test.unstable_modes == 0,
               theory_poisson_ratio=theory_nu(ratio), theory_stiffness_ratio=theory_stiffness(ratio))


def error_of_size(rows, ratio):
    point = ratio_point(block_of(rows, rows), ratio)
    return Row(ratio=ratio, rows=rows, poisson_ratio_error=abs(point.poisson_ratio - theory_nu(ratio)),
               stiffness_ratio_error=abs(point.stiffness_ratio / theory_stiffness(ratio) - 1))


def affine_forces(cell, ratio, h, rotation=0.0):
    """Normal (tension positive) and tangential forces of contacts with kN = 1 where all discs follow the gradient h and
    turn by the rotation."""
    lengths = cell.levers.sum(axis=1)
    return (affine_motions(cell, h) - np.stack([0 * lengths, rotation * lengths], axis=1)) * (1, ratio)


def uniform_state(block, ratio):
    """nu of the test under the loads that a uniform state needs in place of equal ones, and these loads on the right
    side over the mean load of a row."""
    e11 = STRESS / theory_stiffness(ratio)
    forces = affine_forces(block, ratio, np.diag([e11, -in_plane_stress(theory_nu(ratio)) * e11]))
    missing, on_first = np.zeros((len(block), 3)), np.einsum("cij,ci->cj", frames(block.normals), forces)
    for side, sign in ((0, -1), (1, 1)):
        loads = np.column_stack([sign * on_first, -block.levers[:, side] * forces[:, 1]])
        np.add.at(missing, block.contacts[:, side], loads)
    test = tension(block, ratio)
    left = [int(disc) for disc in block.groups["left"]]  # held, without reactions: the loads are in balance
    supports = [{"group": left[:1], "ux": 0.0, "uy": 0.0}, {"group": left[-1:], "ux": 0.0}]
    moves = eq.factorize(block, (KN, ratio * KN), supports).solve(missing).displacements
    xx, yy = ((moves[b, axis] - moves[a, axis]) / (block.centres[b, axis] - block.centres[a, axis])
              for axis, (a, b) in enumerate((test.gauge.horizontal, test.gauge.vertical)))
    right = block.groups["right"]
    shares = missing[right, 0] / (STRESS * test.height / len(right))
    return -yy / (xx - yy), Row(total=sum(shares), corner=shares[0], short_row=shares[1], long_row=shares[2])


def explain_error(size, ratio=1):
    """The tension test at one ratio on other blocks and under other loads: causes of the error of nu."""
    def nu(columns, rows=size.rows):
        return tension(block_of(columns, rows), ratio).poisson_ratio
    block = f"{size.rows} rows of {{}} discs".format
    uniform, edges = uniform_state(block_of(size.columns, size.rows), ratio)
    found = {block(size.columns) + ", equal loads (Fig. 6)": nu(size.columns),
             **{block(times * size.columns): nu(times * size.columns) for times in (2, 4, 8)},
             f"{size.large} rows of {size.large} discs": nu(size.large, size.large),
             block(size.columns) + ", loads of the uniform state": uniform,
             "periodic cell, homogenized": eq.homogenize(periodic(), (1.0, float(ratio))).poisson_ratio.plane_strain}
    return [Row(block=name, poisson_ratio=nu) for name, nu in found.items()], edges


# ---- section 4: macroscopic stress of uniform strain

def check_stress(size):
    """On the periodic lattice: largest deviation over discs, strains and ratios, relative to the largest stress, from
    (52) and from (55)."""
    cell, worst = periodic(), {"free": 0.0, "restrained": 0.0}
    gradients = [[[1e-3, 0], [0, 0]], [[0, 0], [0, 1e-3]], [[0, 1e-3], [0, 0]], [[0, 0], [1e-3, 0]],
                 [[7e-4, -3e-4], [9e-4, 2e-4]]]
    for ratio in (-0.3, -0.1, 0.0, 0.25, 0.5, 1.0):
        bulk, shear = hexagonal_moduli(ratio)[:2]
        for h in map(np.array, gradients):
            spin = h[1, 0] - h[0, 1]
            continuum = (bulk - shear) * np.trace(h) * np.eye(2) + shear * (h + h.T)  # (52)
            # (55) over the cell 2 sqrt3 a^2, its first bracket completed by d_2i d_2j (u_1,1 + 3 u_2,2)
            cosserat = continuum + SQRT3 / 2 * ratio * spin * np.array([[0, -1], [1, 0]])
            for name, rotation, expected in (("free", spin / 2, continuum), ("restrained", 0, cosserat)):
                stresses = cell.disc_stresses(affine_forces(cell, ratio, h, rotation))
                worst[name] = max(worst[name], np.abs(stresses - expected).max() / np.abs(expected).max())
    ratio, spin = 0.5, 1e-3
    forces = KN * affine_forces(cell, ratio, [[0, 0], [spin, 0]])
    stress = scatter(cell.disc_stresses(forces), cell.cell_areas)[0]
    test = tension(block_of(size.columns, size.rows), ratio, effects={"rotation": "restrained"})
    return Row(free_rotation_deviation=worst["free"], restrained_rotation_deviation=worst["restrained"],
               ratio=ratio, spin=spin, asymmetry=stress[0, 1] - stress[1, 0],
               expected_asymmetry=-SQRT3 * ratio * KN * spin,
               moment_density=-(cell.levers.sum(axis=1) * forces[:, 1]).sum() / cell.area,
               restrained_poisson_ratio=test.poisson_ratio)


# ---- lattices and waves

def nu_along_x(c):
    """nu of plane strain of a uniaxial stress along x: with e22 = -(C12/C22) e11 in eq. (35)."""
    return c[0, 1] / (c[1, 1] + c[0, 1])


def wave_moduli(cell, springs, **tables):
    """gamma c^2 of long waves, longitudinal and transverse, every 15 degrees, Pa."""
    waves = eq.stability(cell, springs, density=1.0, **tables)
    return [[waves.mass_per_area * speed ** 2 for speed in speeds]
            for speeds in zip(waves.sound_speeds.longitudinal, waves.sound_speeds.transverse)]


def square_lattice(ratio):
    """Section 2.2, kN = 1 Pa."""
    cell = periodic(eq.square)
    found, waves = eq.homogenize(cell, (1.0, ratio)), wave_moduli(cell, (1.0, ratio))
    turn, along = np.array([[0.5, 0.5, 1], [0.5, 0.5, -1], [-0.5, 0.5, 0]]), np.array(found.stiffness)
    at_45 = turn @ along @ turn.T  # C' = T C T^T
    return Row(ratio=ratio, along_rows=along, turned=at_45, anisotropy=found.anisotropy,
               poisson_ratio_rows=nu_along_x(along), poisson_ratio_diagonal=nu_along_x(at_45),
               waves_rows=waves[0], waves_diagonal=waves[3])


def entries(p):
    """C11, C12, C66 of the square lattice along the rows and at 45 degrees."""
    return [c[place] for c in (p.along_rows, p.turned) for place in ((0, 0), (0, 1), (2, 2))]


def worst_of_square(points):
    """Largest difference of these and of long waves from their formulas."""
    def formulas(r):
        return [1, 0, r / 2, (1 + r) / 2, (1 - r) / 2, 0.5, 1, r / 2, (1 + r) / 2, 0.5]
    return max(abs(number - formula) for p in points
               for number, formula in zip([*entries(p), *p.waves_rows, *p.waves_diagonal], formulas(p.ratio)))


def restrained_waves(nu):
    """The hexagonal lattice with rotation restrained and springs of eq. (53) for G = 1 Pa."""
    bulk_wanted = 1 / (1 - 2 * nu)
    kT = max(0.0, (2 - bulk_wanted) / (2 * SQRT3))
    cell, springs, held = periodic(), (kT + 2 * bulk_wanted / SQRT3, kT), {"rotation": "restrained"}
    longitudinal, shears = np.array(wave_moduli(cell, springs, effects=held)).T
    bulks = longitudinal - shears
    return Row(wanted_poisson_ratio=nu, kN=springs[0], kT=kT, shear_modulus=shears[0],
               poisson_ratio=(bulks[0] - shears[0]) / (2 * bulks[0]),
               deviation=np.abs([shears - 1, bulks / bulk_wanted - 1]).max(),
               poisson_ratio_of_tension=nu_along_x(np.array(eq.homogenize(cell, springs, effects=held).stiffness)))


# ---- end of section 4.2: unequal radii

def scatter(stresses, areas):
    """Mean and standard deviation of each component, weighted by area."""
    mean = np.average(stresses, 0, areas)
    return mean, np.sqrt(np.average((stresses - mean)**2, 0, areas))


def unequal_sample(spread, seed):
    """One random cell under the mean uniaxial stress of 1 Pa along x."""
    cell = eq.delaunay(discs=UNEQUAL_DISCS, points="poisson_disc", seed=seed, periodic=True,
                       radii={"smallest": RADIUS, "largest": spread * RADIUS})
    found = eq.homogenize(cell, (1.0, UNEQUAL_RATIO), homogenize={"bounds": "affine"})
    compliance = np.linalg.inv(found.stiffness)[:, 0]
    forces = np.tensordot(compliance, sum(unit_motions(cell, found)), 1) * (1, UNEQUAL_RATIO)
    stresses = cell.disc_stresses(forces)
    # (50) as printed, with the area of the disc over the solid fraction of the assembly in place of the cell
    areas = math.pi * cell.radii ** 2 / cell.solid_fraction
    printed_mean, printed_scatter = scatter(stresses * (cell.cell_areas / areas)[:, None, None], areas)
    deviation = scatter(stresses, cell.cell_areas)[1]
    bulk = cell.solid_fraction * cell.coordination_number / (2 * math.pi)  # (21)
    return {"solid_fraction": cell.solid_fraction, "coordination_number": cell.coordination_number,
            "poisson_ratio": found.poisson_ratio.plane_strain,
            "shear_modulus_error": bulk * (1 - 2 * theory_nu(UNEQUAL_RATIO)) / found.shear_modulus - 1,
            "bulk_modulus_error": bulk / found.bulk_modulus_2d - 1, "scatter_xx": deviation[0, 0],
            "scatter_yy": deviation[1, 1], "scatter_xy": deviation[0, 1], "printed_mean_xx": printed_mean[0, 0],
            "printed_scatter_xx": printed_scatter[0, 0]}


# ---- the whole

def compute(size):
    block, large = block_of(size.columns, size.rows), block_of(size.large, size.large)
    test = tension(block, SHOWN_RATIO)
    lengths = [float(np.hypot(*(block.centres[b] - block.centres[a])))
               for a, b in (test.gauge.horizontal, test.gauge.vertical)]
    supported = eq.Case(assembly=block, springs=(KN, KN), test={"kind": "uniaxial_tension", "gauge": "centre"})
    parts = {
        "points": lambda: [ratio_point(block, step / 20) for step in range(-18, 21)],
        "large_points": lambda: [ratio_point(large, step / 10) for step in range(-2, 11)],
        "convergence": lambda: [error_of_size(rows, ratio) for ratio in (0.0, 0.1, 0.5, 1.0) for rows in size.sizes],
        "error_of_nu": lambda: explain_error(size),
        "critical_ratio_block": lambda: supported.stability().critical_ratio,
        "macroscopic_stress": lambda: check_stress(size),
        "square_lattice": lambda: [square_lattice(ratio) for ratio in (0.1, 0.25, 0.5, 1.0, 2.0)],
        "restrained_waves": lambda: [restrained_waves(nu) for nu in (-0.5, 0.0, 0.1, 0.2, 0.25)],
        "unequal_radii": lambda: [Row(spread=spread, **means_of([
            unequal_sample(spread, seed) for seed in range(1, size.samples + 1)])) for spread in (1.0, 1.25, 1.5, 2.0)]}
    found = {name: parts[name]() for name in tracked("reproducing Abe 1996", parts)}
    found["error_of_nu"], edges = found["error_of_nu"]
    return Row(columns=size.columns, rows=size.rows, height=test.height, gauge_length=lengths[0],
               gauge_height=lengths[1], critical_ratio_lattice=-1 / 3, edges=edges, **found)


def shown(value):
    """Without the sign of a number that is zero to five digits."""
    return 0.0 if abs(value) < 5e-6 else value


def digits(*numbers):
    return " | ".join(f"{shown(number):.4f}" for number in numbers)


def nu_of_53(r):
    """(K - G)/(2 K) of springs (53)."""
    return (2 * (1 - r) - (1 + 3 * r)) / (4 * (1 - r))


def errors_by_size(points, sizes):
    """Rows of cells: sizes downwards, errors of nu and of (36) at each ratio to the right; the last row has slopes."""
    columns = [[*(f"{rows:>5}" for rows in sizes), "slope"]]
    for ratio in sorted({p.ratio for p in points}):
        for key in ("poisson_ratio_error", "stiffness_ratio_error"):
            errors = [p[key] for p in points if p.ratio == ratio]
            columns.append([*(f"{error:.1e}" for error in errors),
                            f"{power(sizes, errors):.2f}" if ratio else "round-off"])
    return zip(*columns)


def draw_block(size, path):
    """Fig. 6: the block under tension, coloured by the stress of its discs."""
    from matplotlib import pyplot
    block = block_of(size.columns, size.rows)
    test = tension(block, SHOWN_RATIO)
    axes = pyplot.subplots(figsize=(9, 8), dpi=100)[1]
    eq.plot.discs(block, axes, displacements=test.displacements, label="stress xx, Pa",
                  values=block.disc_stresses(test.contact_forces)[:, 0, 0])
    centres, radius = block.centres, block.radii[0]
    for side, sign in (("left", -1), ("right", 1)):
        for x, y in centres[block.groups[side]]:
            axes.annotate("", (x + sign * 4 * radius, y), (x + sign * 1.5 * radius, y),
                          arrowprops={"arrowstyle": "->", "color": "#D55E00"})
    for (first, last), names in ((test.gauge.horizontal, "AB"), (test.gauge.vertical, "CD")):
        axes.plot(*centres[[first, last]].T, "k-", linewidth=1.2)
        for disc, name in zip((first, last), names):
            axes.annotate(name, centres[disc], (4, 4), textcoords="offset points", fontweight="bold")
    axes.set_xlim(axes.get_xlim()[0] - 3 * radius, axes.get_xlim()[1] + 3 * radius)
    axes.set_title(f"Abe (1996), Fig. 6: {size.rows} rows, kT/kN = {SHOWN_RATIO}; {axes.get_title()}", fontsize=11)
    save(axes.figure, path)


def reproduce(options, _page):
    r = compute(options.size)
    numbers = {key: value for key, value in r.items() if key not in ("edges", "large_points")}
    numbers["unequal_radii"] = [{key: value if key == "spread" else value.mean for key, value in p.items()}
                                for p in r.unequal_radii]
    return Output(r, numbers, drawings={"figure6": lambda path: draw_block(options.size, path)})


if __name__ == "__main__":
    main(reproduce)
