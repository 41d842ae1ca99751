# SPDX-License-Identifier: GPL-3.0-or-later
"""Complex moduli over frequency as arrays."""

import numpy as np
import pytest

import equidem as eq

CELL = eq.hexagonal(columns=6, rows=6, radius=1e-3, periodic=True)
SPRINGS = eq.Springs(kN=1e9, kT=0.5e9)
LAW = {"normal": "standard_solid", "tauN": 1e-3, "armN": 3.0, "tangential": "maxwell", "tauT": 2e-3}


def test_complex_moduli_are_those_of_the_lattice():
    found = eq.homogenize(CELL, SPRINGS, viscoelastic={**LAW, "frequencies": [1.0, 200.0, 1e4]}).viscoelastic
    ix = 2j * np.pi * found.frequencies
    kN = 1e9 * (1 + 3 * ix * 1e-3 / (1 + ix * 1e-3))
    kT = 0.5e9 * ix * 2e-3 / (1 + ix * 2e-3)
    K, G = np.sqrt(3) / 2 * kN, np.sqrt(3) / 4 * (kN + kT)
    for array, expected in ((found.bulk_moduli_2d, K), (found.shear_moduli, G), (found.poisson_ratios, (1 - kT / kN) / 4),
                            (found.young_moduli, 2 * G * (1 + (1 - kT / kN) / 4))):
        assert array.dtype == np.complex128 and array.shape == (3,)
        assert np.abs(array - expected).max() < 1e-12 * np.abs(expected).max()
    C = found.stiffnesses.reshape(3, 3, 3)
    assert np.abs(C - C.transpose(0, 2, 1)).max() == 0
    assert np.abs(C[:, 0, 0] - (K + G)).max() < 1e-12 * np.abs(K + G).max()
    assert [row.shear_modulus.loss for row in found.harmonic] == list(found.shear_moduli.imag)


def test_springs_of_each_contact_are_scaled_alike():
    rng = np.random.default_rng(3)
    contacts = len(CELL.contacts)
    own = eq.Springs(kN=1e9 * rng.uniform(0.5, 1.5, contacts), kT=1e9 * rng.uniform(0.5, 1.5, contacts))
    law = {"normal": "kelvin_voigt", "tauN": 1e-3, "tangential": "kelvin_voigt", "tauT": 1e-3, "frequencies": [50.0]}
    result = eq.homogenize(CELL, own, viscoelastic=law)
    factor = 1 + 2j * np.pi * 50 * 1e-3
    assert np.abs(result.viscoelastic.stiffnesses[0] - factor * np.ravel(result.stiffness)).max() < 1e-12 * abs(factor) * 2e9


def test_verbs_without_an_answer_refuse_by_name():
    with pytest.raises(eq.BadInput, match="stability takes elastic springs"):
        eq.stability(CELL, SPRINGS, viscoelastic=LAW)
    with pytest.raises(eq.BadInput, match="no equilibrium"):
        eq.tension_test(eq.hexagonal(columns=7, rows=7, radius=1e-3), SPRINGS, viscoelastic=LAW)
