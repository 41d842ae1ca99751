# SPDX-License-Identifier: GPL-3.0-or-later
"""An oracle: statics of discs with dense matrices, written from the contact law alone."""

import numpy as np


def contact_gradients(assembly):
    """Derivatives (m, 3 n) of stretch and slip of each contact by u_x, u_y and theta of all discs: Abe 1996, eqs. (1)
    to (3), with a lever for each disc."""
    n, m = len(assembly), len(assembly.contacts)
    cell = np.array(assembly.cell or (0.0, 0.0))
    stretch, slip = np.zeros((m, 3 * n)), np.zeros((m, 3 * n))
    branches = np.zeros((m, 2))
    for c, ((i, j), shift, (lever_i, lever_j)) in enumerate(zip(assembly.contacts, assembly.shifts, assembly.levers)):
        branch = assembly.centres[j] + shift * cell - assembly.centres[i]
        normal = branch / np.hypot(*branch)
        tangent = np.array([-normal[1], normal[0]])
        branches[c] = branch
        stretch[c, 3 * i:3 * i + 2] -= normal
        stretch[c, 3 * j:3 * j + 2] += normal
        slip[c, 3 * i:3 * i + 2] -= tangent
        slip[c, 3 * j:3 * j + 2] += tangent
        slip[c, 3 * i + 2] -= lever_i
        slip[c, 3 * j + 2] -= lever_j
    return stretch, slip, branches


def stiffness(assembly, kN, kT):
    """K (3 n, 3 n) of springs kN and kT, numbers or arrays (m,)."""
    stretch, slip, _ = contact_gradients(assembly)
    m = len(stretch)
    return (stretch.T * np.broadcast_to(kN, m)) @ stretch + (slip.T * np.broadcast_to(kT, m)) @ slip


def solve(assembly, kN, kT, held, loads):
    """Motions (n, 3) under loads (n, 3); held: components that do not move."""
    K = stiffness(assembly, kN, kT)
    free = np.setdiff1d(np.arange(len(K)), held)
    motion = np.zeros(len(K))
    motion[free] = np.linalg.solve(K[np.ix_(free, free)], loads.ravel()[free])
    return motion.reshape(-1, 3)


def effective_stiffness(cell, kN, kT):
    """C (3, 3) in Pa of a periodic cell: energies of unit strains, the motions beside them by least squares."""
    stretch, slip, branches = contact_gradients(cell)
    normals = branches / np.hypot(*branches.T)[:, None]
    tangents = np.stack([-normals[:, 1], normals[:, 0]], axis=1)
    strains = [np.array([[1, 0], [0, 0]]), np.array([[0, 0], [0, 1]]), np.array([[0, 0.5], [0.5, 0]])]
    given = np.array([np.concatenate([np.sum(along * (branches @ e), axis=1) for along in (normals, tangents)])
                      for e in strains]).T
    m = len(stretch)
    weights = np.sqrt(np.concatenate([np.full(m, kN), np.full(m, kT)]))[:, None]
    gradients = weights * np.concatenate([stretch, slip])
    motions = np.linalg.lstsq(gradients, -weights * given, rcond=None)[0]
    left = gradients @ motions + weights * given
    return left.T @ left / (cell.cell[0] * cell.cell[1])
