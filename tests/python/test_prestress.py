# SPDX-License-Identifier: GPL-3.0-or-later
"""Forces at rest in the stiffness, from arrays."""
import numpy as np
import pytest

import equidem as eq

CLAMPED = [{"group": [0, 16], "ux": 0.0, "uy": 0.0, "rotation": 0.0}]
PRESSED = [{"group": [15, 31], "kind": "total", "force": [-1.0, 0.0]}]


def column():
    return eq.square(columns=16, rows=2, radius=0.5)


def test_forces_of_arrays_and_loads_buckle_a_column_alike():
    case = dict(springs=(1.0, 0.5), supports=CLAMPED)
    by_loads = eq.Case(assembly=column(), loads=PRESSED, effects={"prestress": "on"}, **case).stability()
    loaded = eq.Case(assembly=column(), loads=PRESSED, **case).solve()
    carrying = column().with_forces(loaded.contact_forces)
    np.testing.assert_array_equal(carrying.forces, loaded.contact_forces)
    by_arrays = eq.Case(assembly=carrying, **case).stability()
    assert by_arrays["critical_load"]["factor"] == pytest.approx(by_loads["critical_load"]["factor"], rel=1e-10)
    euler = np.pi**2 * 0.5 / (4 * 15.0**2)
    assert 0.98 * euler < by_loads["critical_load"]["factor"] < euler
    assert by_loads.buckling.displacements.shape == (32, 2)


def test_wrong_forces_are_refused():
    for wrong in ([(1.0, 1.0)], np.full((len(column().contacts), 2), np.nan)):
        with pytest.raises(eq.BadInput):
            column().with_forces(wrong)
    with pytest.raises(eq.BadInput, match="no contact carries a force"):
        eq.Case(assembly=column(), springs=(1.0, 0.5), supports=CLAMPED, effects={"prestress": "on"}).stability()
