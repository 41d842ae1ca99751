# SPDX-License-Identifier: GPL-3.0-or-later
"""Contacts that break, from arrays."""
import numpy as np
import pytest

import equidem as eq


def bundle():
    """Three pairs of discs, one above the other."""
    centres = [(3.0 * k, 2.0 * y) for k in range(3) for y in range(2)]
    return eq.Assembly(centres, 1.0, [(2 * k, 2 * k + 1) for k in range(3)])


def test_strengths_of_arrays_decide_the_order():
    fibres = bundle().with_strengths([(4.0, 1e9), (1.0, 1e9), (1.2, 1e9)])
    result = eq.Case(assembly=fibres, springs=(1000.0, 300.0),
                     supports=[{"group": [0, 2, 4], "ux": 0.0, "uy": 0.0, "rotation": 0.0},
                               {"group": [1, 3, 5], "ux": 0.0, "uy": 1e-3, "rotation": 0.0}]).quasistatic()
    events = result.events
    assert [event["contact"] for event in events] == [1, 2, 0]
    assert [event["mode"] for event in events] == ["tension"] * 3
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


def test_wrong_strengths_are_refused():
    for wrong in ([(1.0, 1.0)], np.ones((3, 3)), [(1.0, -1.0)] * 3):
        with pytest.raises(eq.BadInput):
            bundle().with_strengths(wrong)


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
