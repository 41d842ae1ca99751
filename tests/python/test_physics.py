# SPDX-License-Identifier: GPL-3.0-or-later
"""Forces at rest, contacts that break and complex moduli, from arrays."""
import numpy as np
import pytest

import equidem as eq
from scenes import CELL, SPRINGS, hexagonal

CLAMPED = [{"group": [0, 16], "ux": 0.0, "uy": 0.0, "rotation": 0.0}]
PRESSED = [{"group": [15, 31], "kind": "total", "force": [-1.0, 0.0]}]
SOFT = (1.0, 0.5)
LAW = {"normal": "standard_solid", "tauN": 1e-3, "armN": 3.0, "tangential": "maxwell", "tauT": 2e-3}


def column():
    return eq.square(columns=16, rows=2, radius=0.5)


def clamped(assembly, **more):
    return eq.Case(assembly=assembly, springs=SOFT, supports=CLAMPED, **more)


# ---- forces at rest

def test_forces_of_arrays_and_loads_buckle_a_column_alike():
    by_loads = clamped(column(), loads=PRESSED, effects={"prestress": "on"}).stability()
    loaded = clamped(column(), loads=PRESSED).solve()
    carrying = column().with_forces(loaded.contact_forces)
    np.testing.assert_array_equal(carrying.forces, loaded.contact_forces)
    by_arrays = clamped(carrying).stability()
    assert by_arrays["critical_load"]["factor"] == pytest.approx(by_loads["critical_load"]["factor"], rel=1e-10)
    euler = np.pi**2 * 0.5 / (4 * 15.0**2)
    assert 0.98 * euler < by_loads["critical_load"]["factor"] < euler
    assert by_loads.buckling.displacements.shape == (32, 2)


def test_the_stiffness_matrix_holds_the_forces_at_rest_that_the_solution_holds():
    """u = K^-1 f of the free discs is the solution, which forces at rest change."""
    carrying = column().with_forces(1e-3 * clamped(column(), loads=PRESSED).solve().contact_forces)
    solved = clamped(carrying, loads=[{"group": [15, 31], "kind": "total", "force": [0.0, 1e-6]}]).solve()
    free = np.array([3 * d + k for d in range(32) if d not in (0, 16) for k in range(3)])
    load, motion = np.zeros(96), np.zeros(96)
    load[[3 * 15 + 1, 3 * 31 + 1]] = 0.5e-6
    K, without = (eq.stiffness_matrix(block, SOFT).toarray() for block in (carrying, column()))
    motion[free] = np.linalg.solve(K[np.ix_(free, free)], load[free])
    wrong = abs(motion.reshape(32, 3)[:, :2] - solved.displacements).max()
    assert wrong <= 1e-9 * abs(solved.displacements).max()
    assert abs(K - without).max() > 1e-6


def test_the_mean_stress_of_discs_is_that_of_the_forces_on_their_edges():
    """(1/A) sum f_i x_j over the outer forces: a pull of 3 N/m along x over 15 m."""
    pulled = eq.solve(column(), SOFT, supports=[{"group": [0, 16], "ux": 0.0}, {"group": [0], "uy": 0.0}],
                      loads=[{"group": [15, 31], "kind": "total", "force": [3.0, 0.0]}])
    stresses = column().disc_stresses(pulled.contact_forces)
    mean = np.average(stresses, 0, column().cell_areas)
    np.testing.assert_allclose(mean, [[3.0 * 15.0 / column().area, 0.0], [0.0, 0.0]], atol=1e-12)
    assert stresses.shape == (32, 2, 2)


# ---- contacts that break

def bundle():
    """Three pairs of discs, one above the other."""
    centres = [(3.0 * k, 2.0 * y) for k in range(3) for y in range(2)]
    return eq.Assembly(centres, 1.0, [(2 * k, 2 * k + 1) for k in range(3)])


def test_strengths_of_arrays_decide_the_order():
    fibres = bundle().with_strengths([(4.0, 1e9), (1.0, 1e9), (1.2, 1e9)])
    events = eq.Case(assembly=fibres, springs=(1000.0, 300.0),
                     supports=[{"group": [0, 2, 4], "ux": 0.0, "uy": 0.0, "rotation": 0.0},
                               {"group": [1, 3, 5], "ux": 0.0, "uy": 1e-3, "rotation": 0.0}]).quasistatic().events
    assert [(event["contact"], event["mode"]) for event in events] == [(1, "tension"), (2, "tension"), (0, "tension")]
    np.testing.assert_allclose([event["lambda"] for event in events], [1.0, 1.2, 4.0], rtol=1e-12)
    np.testing.assert_allclose([event["load"] for event in events], [3.0, 2.4, 4.0], rtol=1e-12)


def test_contacts_without_a_bond_slip_and_stick():
    # Kt u = mu N begins the slip, and the loop of a cycle of the amplitude A has the area 4 mu N (A - mu N/kT).
    pair = eq.Assembly([(0.0, 0.0), (2.0, 0.0)], 1.0, [(0, 1)]).with_strengths([(0.0, 0.0)])
    friction, amplitude = 0.1, 1e-3
    result = eq.Case(assembly=pair, springs=(1000.0, 300.0), strength={"friction": friction, "after_breaking": "frictional"},
                     supports=[{"group": [0], "ux": 0.0, "uy": 0.0, "rotation": 0.0},
                               {"group": [1], "uy": amplitude, "rotation": 0.0}],
                     dead_load=[{"group": [1], "force": [-1.0, 0.0]}],
                     quasistatic={"legs": [1.0, -1.0, 1.0]}).quasistatic()
    assert [event["mode"] for event in result.events] == ["slip", "stick", "slip", "stick", "slip"]
    np.testing.assert_allclose(result.events[0]["lambda"], friction / (300.0 * amplitude), rtol=1e-12)
    slip = amplitude - friction / 300.0
    np.testing.assert_allclose(result.energies.friction, friction * slip * 5, rtol=1e-12)


def test_strengths_of_contacts_are_calibrated():
    case = eq.Case(assembly={"kind": "delaunay", "discs": 80, "aspect": 0.6, "radius": 1e-3}, springs=(1e9, 4e8),
                   strength={"friction": 0.5, "weibull_modulus": 6.0},
                   strength_target={"tensile": 5e6, "compressive": 30e6, "samples": 2})
    result = case.calibrate()
    assert result.achieved.tensile == pytest.approx(5e6, rel=1e-12)
    assert result.achieved.compressive == pytest.approx(30e6, rel=5e-3)
    assert result.contact_strength.shear > 0 and result.contact_strength.friction == 0.5
    with pytest.raises(eq.EquidemError, match="is not feasible"):
        case.set("strength_target.compressive", 1e10).calibrate()


# ---- complex moduli

def test_complex_moduli_are_those_of_the_lattice():
    found = eq.homogenize(CELL, SPRINGS, viscoelastic={**LAW, "frequencies": [1.0, 200.0, 1e4]}).viscoelastic
    ix = 2j * np.pi * found.frequencies
    kN = 1e9 * (1 + 3 * ix * 1e-3 / (1 + ix * 1e-3))
    kT = 0.5e9 * ix * 2e-3 / (1 + ix * 2e-3)
    K, G, nu = np.sqrt(3) / 2 * kN, np.sqrt(3) / 4 * (kN + kT), (1 - kT / kN) / 4
    for array, expected in ((found.bulk_moduli_2d, K), (found.shear_moduli, G), (found.poisson_ratios, nu),
                            (found.young_moduli, 2 * G * (1 + nu))):
        assert array.dtype == np.complex128 and array.shape == (3,)
        assert np.abs(array - expected).max() < 1e-12 * np.abs(expected).max()
    C = found.stiffnesses.reshape(3, 3, 3)
    assert np.abs(C - C.transpose(0, 2, 1)).max() == 0
    assert np.abs(C[:, 0, 0] - (K + G)).max() < 1e-12 * np.abs(K + G).max()
    assert [row.shear_modulus.loss for row in found.harmonic] == list(found.shear_moduli.imag)


def test_springs_of_each_contact_are_scaled_alike():
    rng = np.random.default_rng(3)
    own = eq.Springs(*(1e9 * rng.uniform(0.5, 1.5, len(CELL.contacts)) for _ in "NT"))
    law = {"normal": "kelvin_voigt", "tauN": 1e-3, "tangential": "kelvin_voigt", "tauT": 1e-3, "frequencies": [50.0]}
    result = eq.homogenize(CELL, own, viscoelastic=law)
    factor = 1 + 2j * np.pi * 50 * 1e-3
    assert np.abs(result.viscoelastic.stiffnesses[0] - factor * np.ravel(result.stiffness)).max() < 1e-12 * abs(factor) * 2e9


# ---- refusals

@pytest.mark.parametrize(("call", "words"), [
    *((call, "") for wrong in ([(1.0, 1.0)], np.full((len(column().contacts), 2), np.nan))
      for call in (lambda wrong=wrong: column().with_forces(wrong), lambda wrong=wrong: column().disc_stresses(wrong))),
    *((lambda wrong=wrong: bundle().with_strengths(wrong), "") for wrong in ([(1.0, 1.0)], np.ones((3, 3)), [(1.0, -1.0)] * 3)),
    (lambda: clamped(column(), effects={"prestress": "on"}).stability(), "no contact carries a force"),
    (lambda: eq.stability(CELL, SPRINGS, viscoelastic=LAW), "stability takes elastic springs"),
    (lambda: eq.tension_test(hexagonal(7, 7), SPRINGS, viscoelastic=LAW), "no equilibrium")])
def test_wrong_forces_strengths_and_springs_are_refused(call, words):
    with pytest.raises(eq.BadInput, match=words):
        call()


def test_the_stress_of_a_path_is_the_traction_of_its_load_on_the_side():
    """Supports that move two opposite sides apart: a traction of that stress has the same resultant. Supports that shear have no section."""
    plate, springs = eq.hexagonal(columns=7, rows=9, radius=0.5e-3), eq.Springs(kN=1e10, kT=3e9)
    held = {"group": "bottom", "ux": 0.0, "uy": 0.0}
    strength = {"tension": 1e4, "shear": 2e4, "weibull_modulus": 8.0}
    for pulled in ({"group": "top", "uy": 1e-6}, {"group": "top", "uy": -1e-6}):
        path = eq.Case(assembly=plate, springs=springs, supports=[held, pulled], strength=strength,
                       quasistatic={"max_events": 5}).quasistatic()
        peak = path.peak
        solved = eq.solve(plate, springs, supports=[held],
                          loads=[{"group": "top", "force": (0.0, peak.section_stress), "kind": "traction"}])
        assert -solved.reactions[:, 1].sum() == pytest.approx(peak.load, rel=1e-9)
        height = 8 * np.sqrt(3) * 0.5e-3
        assert peak.section_strain == pytest.approx(peak.motion / height, rel=1e-9)
    sheared = eq.Case(assembly=plate, springs=springs, supports=[held, {"group": "top", "ux": 1e-6, "uy": 0.0}],
                      strength=strength, quasistatic={"max_events": 5}).quasistatic()
    assert "section_stress" not in sheared.peak
