# SPDX-License-Identifier: GPL-3.0-or-later
# %% [markdown]
# # The critical ratio and its wave
#
# **At which kT/kN does a hexagonal lattice lose its stability, and by which motion?**
#
# Negative tangential springs give Poisson's ratios above 1/4 (Abe 1996), until at a critical ratio some wave costs no
# energy any more. `stability` searches all waves for it.

# %%
import matplotlib.pyplot as plt
import numpy as np

import equidem as eq

radius = 5e-3  # m
cell = eq.hexagonal(columns=2, rows=2, radius=radius, periodic=True)
found = eq.stability(cell, (1.0, 0.5))
print(f"critical kT/kN = {found.critical_ratio:.9f}, at the point {found.critical_wave_vector_name}")
assert abs(found.critical_ratio + 1 / 3) < 1e-9

# %% [markdown]
# Theory: the stiffness of a wave exp(i q.x) of kN = 1 and kT = ratio, with each rotation at its own equilibrium. Its
# lowest eigenvalue is the energy that the wave costs.


# %%
def wave_stiffness(q, ratio):
    angles = np.arange(6) * np.pi / 3
    normal, tangent = np.array([np.cos(angles), np.sin(angles)]).T, np.array([-np.sin(angles), np.cos(angles)]).T
    phase = 2 * radius * normal @ q
    push = np.einsum("c,ci,cj->ij", 1 - np.cos(phase), normal, normal)
    push += ratio * np.einsum("c,ci,cj->ij", 1 - np.cos(phase), tangent, tangent)
    turn = ratio * radius * np.sin(phase) @ tangent
    return push - np.outer(turn, turn) / (ratio * radius**2 * np.sum(1 + np.cos(phase)))


path = found.dispersion  # the wave vectors from Gamma by M and K back to Gamma
at_m = np.array(found.critical_wave_vector)
assert abs(np.linalg.eigvalsh(wave_stiffness(at_m, -1 / 3))[0]) < 1e-12

# %% [markdown]
# The wave at M changes sign from row to row, so that a cell of 2 x 2 discs holds it: the stiffness matrix of the cell,
# with its rotations eliminated, has the same eigenvalue.

# %%
K = eq.stiffness_matrix(cell, (1.0, -0.3)).toarray()
rotations = np.arange(2, len(K), 3)
others = np.setdiff1d(np.arange(len(K)), rotations)
B = K[np.ix_(others, rotations)]
values, modes = np.linalg.eigh(K[np.ix_(others, others)] - B @ np.linalg.solve(K[np.ix_(rotations, rotations)], B.T))
moving = np.flatnonzero(abs(values) > 1e-9)[0]  # after the two translations
assert abs(values[moving] - np.linalg.eigvalsh(wave_stiffness(at_m, -0.3))[0]) < 1e-12

# %%
figure, (left, right) = plt.subplots(1, 2, figsize=(9.4, 3.8), layout="constrained", width_ratios=(3, 2))
for ratio in (0.5, -0.1, -0.25, -1 / 3, -0.4):
    left.plot(path.along, [np.linalg.eigvalsh(wave_stiffness(q, ratio))[0] for q in path.wave_vectors],
              label=f"kT/kN = {ratio:.3g}")
left.axhline(0, color="black", linewidth=0.6)
corners = np.cumsum([0, 1, np.sqrt(1 / 3), np.sqrt(4 / 3)]) * np.hypot(*at_m)
left.set_xticks(corners, ["Γ", "M", "K", "Γ"])
left.set(ylabel="lowest stiffness of the wave over kN", title="the energy of waves", xlim=(0, corners[-1]))
left.legend(frameon=False, loc="upper right", fontsize=9)

block = eq.hexagonal(columns=7, rows=6, radius=radius)
values, vectors = np.linalg.eigh(wave_stiffness(at_m, -1 / 3))
wave = np.cos(np.asarray(block.centres - block.centres[0]) @ at_m)
block.plot(right, displacements=np.outer(wave, vectors[:, 0]), values=wave, scale=0.35 * radius, contacts=False,
           cmap="coolwarm")
right.set_title("at -1/3 this wave costs no energy:\nred and blue discs move oppositely")
plt.show()
