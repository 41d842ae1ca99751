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


def test_the_stiffness_matrix_holds_the_forces_at_rest_that_the_solution_holds():
    """u = K^-1 f of the free discs is the solution, which forces at rest change."""
    resting = eq.Case(assembly=column(), springs=(1.0, 0.5), supports=CLAMPED, loads=PRESSED).solve()
    carrying = column().with_forces(1e-3 * resting.contact_forces)
    push = [{"group": [15, 31], "kind": "total", "force": [0.0, 1e-6]}]
    solved = eq.Case(assembly=carrying, springs=(1.0, 0.5), supports=CLAMPED, loads=push).solve()
    free = np.array([3 * d + k for d in range(32) if d not in (0, 16) for k in range(3)])
    load = np.zeros(96)
    load[[3 * 15 + 1, 3 * 31 + 1]] = 0.5e-6
    motion = np.zeros(96)
    motion[free] = np.linalg.solve(eq.stiffness_matrix(carrying, (1.0, 0.5)).toarray()[np.ix_(free, free)], load[free])
    wrong = abs(motion.reshape(32, 3)[:, :2] - solved.displacements).max()
    assert wrong <= 1e-9 * abs(solved.displacements).max()
    without = eq.stiffness_matrix(column(), (1.0, 0.5)).toarray()
    assert abs(eq.stiffness_matrix(carrying, (1.0, 0.5)).toarray() - without).max() > 1e-6


def test_the_mean_stress_of_discs_is_that_of_the_forces_on_their_edges():
    """(1/A) sum f_i x_j over the outer forces: a pull of 3 N/m along x over 15 m."""
    held = [{"group": [0, 16], "ux": 0.0}, {"group": [0], "uy": 0.0}]
    pulled = eq.solve(column(), (1.0, 0.5), supports=held,
                      loads=[{"group": [15, 31], "kind": "total", "force": [3.0, 0.0]}])
    stresses = column().disc_stresses(pulled.contact_forces)
    mean = np.average(stresses, 0, column().cell_areas)
    np.testing.assert_allclose(mean, [[3.0 * 15.0 / column().area, 0.0], [0.0, 0.0]], atol=1e-12)
    assert stresses.shape == (32, 2, 2)


def test_wrong_forces_are_refused():
    for wrong in ([(1.0, 1.0)], np.full((len(column().contacts), 2), np.nan)):
        with pytest.raises(eq.BadInput):
            column().with_forces(wrong)
        with pytest.raises(eq.BadInput):
            column().disc_stresses(wrong)
    with pytest.raises(eq.BadInput, match="no contact carries a force"):
        eq.Case(assembly=column(), springs=(1.0, 0.5), supports=CLAMPED, effects={"prestress": "on"}).stability()
