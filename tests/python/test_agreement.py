# SPDX-License-Identifier: GPL-3.0-or-later
"""The module gives the numbers of an independent dense computation and of the program."""

import json
import os
import subprocess

import numpy as np
import pytest

import dense
import equidem as eq
from scenes import CASES, HELD, hexagonal

PROGRAM = os.environ["EQUIDEM_PROGRAM"]
SIZES = {"smallest": 3e-3, "largest": 6e-3}

BLOCKS = {
    "hexagonal": lambda **more: hexagonal(6, 5, 5e-3, **more),
    "square": lambda: eq.square(columns=5, rows=4, radius=5e-3),
    "delaunay": lambda **more: eq.delaunay(discs=40, radius=5e-3, seed=3, **more),
    "polydisperse": lambda **more: eq.delaunay(discs=40, radii=SIZES, seed=5, **more),
}
CELLS = {kind: lambda kind=kind: BLOCKS[kind](periodic=True) for kind in ("delaunay", "polydisperse")}
CELLS["hexagonal"] = lambda: hexagonal(4, 4, 5e-3, periodic=True)
KN, KT = 1e9, 0.3e9


@pytest.mark.parametrize("assembly", [*BLOCKS.values(), *CELLS.values()], ids=[*BLOCKS, *(f"cell_{kind}" for kind in CELLS)])
def test_the_stiffness_matrix_is_that_of_the_contact_law(assembly):
    made = assembly()
    expected = dense.stiffness(made, KN, KT)
    assert abs(eq.stiffness_matrix(made, (KN, KT)).toarray() - expected).max() <= 1e-14 * abs(expected).max()


@pytest.mark.parametrize("kind", BLOCKS)
def test_solutions_are_those_of_dense_matrices(kind):
    block = BLOCKS[kind]()
    left, right = block.groups["left"], block.groups["right"]
    held = np.concatenate([3 * left, 3 * left + 1, 3 * left + 2])
    loads = np.zeros((len(block), 3))
    loads[right, :2] = [1e3, -2e3]
    expected = dense.solve(block, KN, KT, held, loads)
    result = eq.solve(block, (KN, KT), supports=[{"group": "left", "ux": 0.0, "uy": True, "rotation": 0}],
                      loads=[{"group": "right", "force": (1e3, -2e3)}])
    scale = abs(expected[:, :2]).max()
    assert abs(result.displacements - expected[:, :2]).max() <= 1e-10 * scale
    assert abs(result.rotations - expected[:, 2]).max() <= 1e-10 * abs(expected[:, 2]).max()
    stretch, slip, _ = dense.contact_gradients(block)
    forces = np.stack([KN * stretch @ expected.ravel(), KT * slip @ expected.ravel()], axis=1)
    assert abs(result.contact_forces - forces).max() <= 1e-10 * abs(forces).max()
    assert np.allclose(result.reactions.sum(axis=0), -loads[:, :2].sum(axis=0), rtol=1e-10)


def test_a_load_on_a_side_of_discs_with_two_contacts_each_is_carried():
    """Two rows pulled along x stretch by the load of a row over kN in each of their contacts."""
    strip = eq.square(columns=4, rows=2, radius=0.5)
    pulled = eq.solve(strip, (1.0, 0.5), supports=[{"group": "left", "ux": 0.0, "uy": 0.0}],
                      loads=[{"group": "right", "kind": "total", "force": [3.0, 0.0]}])
    np.testing.assert_allclose(pulled.displacements[strip.groups["right"], 0], 3 * 1.5, rtol=1e-12)


def test_springs_of_each_contact_act_on_their_contact():
    block = BLOCKS["delaunay"]()
    random = np.random.default_rng(1)
    kN = random.uniform(0.5e9, 2e9, len(block.contacts))
    kT = random.uniform(0.1e9, 1e9, len(block.contacts))
    loads = random.normal(size=(len(block), 3)) * [1, 1, 1e-3]
    bottom = block.groups["bottom"]
    held = np.concatenate([3 * bottom, 3 * bottom + 1])
    expected = dense.solve(block, kN, kT, held, loads)
    factor = eq.factorize(block, eq.Springs(kN, kT), [{"group": "bottom", "ux": 0, "uy": 0}])
    assert abs(factor.solve(loads).displacements - expected[:, :2]).max() <= 1e-10 * abs(expected).max()


def test_one_factor_solves_many_loads():
    block = BLOCKS["hexagonal"]()
    loads = np.random.default_rng(2).normal(size=(len(block), 3, 4))
    factor = eq.factorize(block, (KN, KT), [{"group": block.groups["left"], "ux": 0, "uy": 0}])
    together = factor.solve(loads)
    assert together.displacements.shape == (len(block), 2, 4)
    for k in range(4):
        assert np.array_equal(together.displacements[:, :, k], factor.solve(loads[:, :, k]).displacements)


def test_derivatives_of_measured_numbers_are_those_of_differences():
    block = BLOCKS["delaunay"]()
    random = np.random.default_rng(4)
    n, m = len(block), len(block.contacts)
    loads, weights = random.normal(size=(n, 2)), random.normal(size=(n, 2))
    of_forces = random.normal(size=(m, 2)) / KN
    kN, kT = KN * random.uniform(0.8, 1.2, (2, m))
    held = [{"group": block.groups["left"], "ux": 0, "uy": 0}]

    def measured(change):
        factor = eq.factorize(block, eq.Springs(kN + change * direction, kT), held)
        state = factor.solve(loads)
        return (weights * state.displacements).sum() + (of_forces * state.contact_forces).sum()

    found = eq.factorize(block, eq.Springs(kN, kT), held).derivatives(loads, motions=weights, forces=of_forces)
    direction = KN * random.uniform(-1, 1, m)
    assert np.isclose(found.value, measured(0), rtol=1e-12)
    expected = (measured(1e-4) - measured(-1e-4)) / 2e-4
    assert abs(found.by_kN @ direction - expected) <= 1e-6 * abs(found.by_kN * direction).sum()
    # q is linear in the loads
    assert np.isclose((found.by_force * loads).sum(), found.value, rtol=1e-9)
    assert found.by_moment.shape == (n,) and found.by_position.shape == (n, 2) and "by_kM" not in found


def test_natural_frequencies_change_as_their_modes_say():
    block = BLOCKS["delaunay"]()
    m = len(block.contacts)
    direction = KN * np.random.default_rng(5).uniform(-0.1, 0.1, m)

    def lowest(change):
        result = eq.stability(block, eq.Springs(np.full(m, KN) + change * direction, np.full(m, KT)),
                              supports=HELD, density=2500.0)
        return result, result.natural_omegas[0] ** 2

    result, _ = lowest(0)
    mode = result.modes["0"]
    turned = np.column_stack([mode.displacements, mode.rotations])
    change = eq.form_derivatives(block, (KN, KT), turned).by_kN @ direction
    assert np.isclose((lowest(0.1)[1] - lowest(-0.1)[1]) / 0.2, change, rtol=1e-3)


@pytest.mark.parametrize("kind", CELLS)
def test_effective_stiffness_is_that_of_dense_matrices(kind):
    cell = CELLS[kind]()
    expected = dense.effective_stiffness(cell, KN, KT)
    assert abs(np.array(eq.homogenize(cell, (KN, KT)).stiffness) - expected).max() <= 1e-11 * abs(expected).max()


def test_natural_frequencies_are_those_of_dense_matrices():
    block, density = BLOCKS["delaunay"](), 2500.0
    left = block.groups["left"]
    free = np.setdiff1d(np.arange(3 * len(block)), np.concatenate([3 * left, 3 * left + 1]))
    mass = density * np.pi * block.radii**2
    inertia = np.stack([mass, mass, 0.5 * mass * block.radii**2], axis=1).ravel()[free]
    root = np.sqrt(inertia)
    K = dense.stiffness(block, KN, KT)[np.ix_(free, free)] / root[:, None] / root
    squared, vectors = np.linalg.eigh(K)
    result = eq.stability(block, (KN, KT), supports=HELD, density=density)
    assert np.allclose(result.natural_omegas, np.sqrt(squared[:4]), rtol=1e-6)
    mode = np.column_stack([result.modes["0"].displacements, result.modes["0"].rotations]).ravel()[free] * root
    assert abs(abs(mode @ vectors[:, 0]) / np.linalg.norm(mode) - 1) < 1e-6


def test_calibrated_springs_give_the_wanted_moduli():
    cell = CELLS["delaunay"]()
    springs = eq.calibrate(cell, young_modulus=30e9, poisson_ratio=0.15, plane="strain")
    moduli = eq.homogenize(cell, springs)
    assert abs(moduli.poisson_ratio.plane_strain - 0.15) < 1e-10
    assert abs(moduli.young_modulus.plane_strain / 30e9 - 1) < 1e-10


def test_an_assembly_from_arrays_is_the_one_that_its_arrays_came_from():
    for cell in (CELLS["polydisperse"](), BLOCKS["polydisperse"]()):
        contacts = np.concatenate([cell.contacts, cell.shifts], axis=1)
        copy = eq.Assembly(cell.centres, cell.radii, contacts, levers=cell.levers, cell=cell.cell)
        assert np.array_equal(copy.levers, cell.levers) and np.array_equal(copy.shifts, cell.shifts)
        if cell.cell:  # a free block from arrays has a region of its own
            assert np.allclose(copy.cell_areas, cell.cell_areas, rtol=1e-12)
        found = eq.stiffness_matrix(copy, (KN, KT)) - eq.stiffness_matrix(cell, (KN, KT))
        assert abs(found).max() == 0


@pytest.mark.parametrize("verb, case", [
    ("solve", "abe1996_fig6"), ("solve", "cantilever"), ("solve", "truss"), ("homogenize", "random_cell"),
    ("calibrate", "calibrate_lattice"), ("calibrate", "calibrate_random"), ("stability", "hexagonal_cell"),
    ("pack", "pack_jammed"), ("run", "run_corner"), ("run", "grains_cradle")])
def test_a_case_gives_the_numbers_of_the_program(verb, case):
    path = CASES / f"{case}.toml"
    done = subprocess.run([PROGRAM, verb, path, "--json", "-", "--quiet"], check=True, capture_output=True)
    expected = json.loads(done.stdout)
    result = eq.Case(path).run_verb(verb)
    found = result.to_dict()
    for key in expected.keys() - {"times", "report", "units", "labels", "seconds"}:
        if not key.endswith("per_second"):
            assert found[key] == expected[key], key


def test_an_assembly_in_memory_gives_the_numbers_of_its_case():
    from_file = eq.Case(CASES / "abe1996_fig6.toml").solve()
    in_memory = eq.tension_test(hexagonal(21, 21, 0.005), (1e9, 0.5e9), stress=1e6)
    assert in_memory.poisson_ratio == from_file.poisson_ratio
    assert in_memory.theory.poisson_ratio == from_file.theory.poisson_ratio
