# SPDX-License-Identifier: GPL-3.0-or-later
"""Springs of groups of contacts for wanted moduli."""

import numpy as np
import pytest

import equidem as eq

ANY_START = (20e9, 10e9)


def directions(lattice):
    """Of each contact, degrees."""
    branch = lattice.centres[lattice.contacts[:, 1]] - lattice.centres[lattice.contacts[:, 0]]
    branch = branch + lattice.shifts * np.array(lattice.cell)
    return np.round(np.degrees(np.arctan2(branch[:, 1], branch[:, 0])) % 180).astype(int)


def two_phases(share=0.4):
    cell = eq.delaunay(discs=600, radius=1e-3, seed=2, periodic=True)
    hard = (np.random.default_rng(1).random(len(cell)) < share)[cell.contacts].all(axis=1)
    return cell, {"hard kN": ("kN", hard), "other kN": ("kN", ~hard), "hard kT": ("kT", hard), "other kT": ("kT", ~hard)}


def test_a_lattice_with_springs_by_direction_takes_a_wanted_anisotropic_tensor():
    lattice = eq.hexagonal(columns=4, rows=4, radius=1e-3, periodic=True)
    angles = directions(lattice)
    assert set(angles) == {0, 60, 120}
    random = np.random.default_rng(3)
    by_angle = {angle: random.uniform((0.5e9, 0.1e9), (2e9, 0.9e9)) for angle in (0, 60, 120)}
    wanted = eq.homogenize(lattice, np.array([by_angle[angle] for angle in angles])).stiffness
    targets = {name: wanted[i][j] for name, (i, j) in
               {"C11": (0, 0), "C22": (1, 1), "C66": (2, 2), "C12": (0, 1), "C16": (0, 2), "C26": (1, 2)}.items()}
    found = eq.fit_springs(lattice, ANY_START, targets,
                           {f"{kind} {angle}": (kind, angles == angle) for angle in by_angle for kind in ("kN", "kT")})
    stiffness = eq.homogenize(lattice, found.springs).stiffness
    assert found.reached and not found.misses and not found.at_limit
    assert np.allclose(stiffness, wanted, rtol=0, atol=1e-10 * np.abs(wanted).max())
    assert np.allclose(list(found.determined.values()), 1), found.determined  # six numbers, six springs


def test_a_rock_of_two_phases_takes_wanted_moduli_in_at_most_eight_evaluations():
    cell, unknowns = two_phases()
    found = eq.fit_springs(cell, ANY_START, {"E_stress": 70e9, "nu_stress": 0.24}, unknowns)
    moduli = eq.homogenize(cell, found.springs)
    assert found.reached and found.evaluations <= 8, found
    assert moduli.young_modulus.plane_stress == pytest.approx(70e9, rel=1e-9)
    assert moduli.poisson_ratio.plane_stress == pytest.approx(0.24, abs=1e-9)
    # Two targets determine two of four combinations of unknowns.
    assert np.sum(found.singular_values > 1e-9) == 2 and len(found.singular_values) == 4
    assert sum(found.determined.values()) == pytest.approx(2)


def test_of_springs_that_meet_the_targets_those_are_found_that_change_least():
    optimize = pytest.importorskip("scipy.optimize")
    cell, unknowns = two_phases()
    found = eq.fit_springs(cell, ANY_START, {"K": 40e9}, unknowns)

    def springs(logs):
        at_contacts = np.tile(ANY_START, (len(cell.contacts), 1))
        for (kind, chosen), log in zip(unknowns.values(), logs):
            at_contacts[chosen, ("kN", "kT").index(kind)] *= np.exp(log)
        return at_contacts

    def miss(logs):
        return np.log(eq.homogenize(cell, springs(logs), homogenize={"bounds": "affine"}).bulk_modulus_2d / 40e9)

    other = optimize.minimize(lambda logs: logs @ logs, np.zeros(4), constraints={"type": "eq", "fun": miss},
                              options={"ftol": 1e-12})
    assert other.success, other.message
    assert np.allclose(np.log(list(found.factors.values())), other.x, atol=1e-4), (found.factors, np.exp(other.x))


def test_auxetic_moduli_are_reached_where_positive_springs_allow_them():
    cell, _ = two_phases()
    found = eq.fit_springs(cell, ANY_START, {"E_stress": 30e9, "nu_stress": -0.2})
    assert found.reached and found.factors["kT"] * ANY_START[1] > found.factors["kN"] * ANY_START[0] > 0
    assert eq.homogenize(cell, found.springs).poisson_ratio.plane_stress == pytest.approx(-0.2, abs=1e-9)


def test_targets_that_conflict_are_named_and_weights_choose_between_them():
    cell, _ = two_phases()
    targets = {"K": 40e9, "G": 20e9, "nu_stress": 0.1}  # K and G have nu = 1/3
    even = eq.fit_springs(cell, ANY_START, targets)
    leant = eq.fit_springs(cell, ANY_START, targets, weights={"nu_stress": 100})
    assert not even.reached and {"K", "G"} <= set(even.misses)
    assert abs(leant.misses["nu_stress"]) < 0.01 * abs(even.misses["nu_stress"])


def test_a_target_beyond_the_limits_of_the_springs_says_which_of_them_is_in_the_way():
    cell, _ = two_phases()
    found = eq.fit_springs(cell, ANY_START, {"E_stress": 70e9, "nu_stress": 0.6})
    assert not found.reached and found.at_limit == ["kT"] and "nu_stress" in found.misses


def test_input_that_no_springs_fit_is_refused():
    cell, unknowns = two_phases()
    flags = unknowns["hard kN"][1]
    for words, arguments in [
            ("no target", dict(targets={"E": 1e9})),
            ("no targets", dict(targets={})),
            ("stable continuum", dict(targets={"K": -1e9})),
            ("no unknowns", dict(unknowns={})),
            ("no kind of spring", dict(unknowns={"a": ("kM", flags)})),
            ("has no contacts", dict(unknowns={"a": ("kN", [])})),
            ("do not exist", dict(unknowns={"a": ("kN", [100000])})),
            ("one flag for each", dict(unknowns={"a": ("kN", [True])})),
            ("'a' too", dict(unknowns={"a": ("kN", flags), "b": ("kN", flags)})),
            ("positive springs", dict(start=(1e9, 0.0))),
            ("both sides", dict(smallest=2)),
            ("not positive", dict(weights={"K": 0})),
            ("1 or more", dict(most=0))]:
        given = {"start": ANY_START, "targets": {"K": 1e9}, **arguments}
        with pytest.raises(eq.BadInput, match=words):
            eq.fit_springs(cell, given.pop("start"), given.pop("targets"), given.pop("unknowns", None), **given)
