# SPDX-License-Identifier: GPL-3.0-or-later
# %% [markdown]
# # Figure 7: Poisson's ratio and the ratio of the springs
#
# **Which Poisson's ratio does a hexagonal block of discs show in a tension test, for each ratio kT/kN of its springs?**
#
# Abe (1996) derives nu = (1 - kT/kN)/4 in plane strain for the infinite lattice and computes a block of 21 rows (Fig.
# 7). Here the block is solved for each ratio, and the infinite lattice is homogenized from one periodic cell.

# %%
import matplotlib.pyplot as plt
import numpy as np

import equidem as eq

kN = 1e9  # Pa
ratios = np.linspace(-0.25, 1.0, 11)
theory = (1 - ratios) / 4

# %% [markdown]
# The infinite lattice: a periodic cell of four discs, solved to the last digits.

# %%
cell = eq.hexagonal(columns=2, rows=2, radius=5e-3, periodic=True)
infinite = np.array([eq.homogenize(cell, (kN, r * kN)).plane_strain.poisson_ratio for r in ratios])
assert abs(infinite - theory).max() < 1e-12

# %% [markdown]
# Free blocks, pulled along x by 1 MPa. Their faces disturb the strain that the gauge in the middle reads; the error
# falls with the size of the block.

# %%
blocks = {}
for rows in (11, 21, 61):
    block = eq.hexagonal(columns=rows, rows=rows, radius=5e-3)
    tests = [eq.tension_test(block, (kN, r * kN), stress=1e6) for r in ratios]
    assert all(test.unstable_modes == 0 and test.relative_residual < 1e-12 for test in tests)
    blocks[rows] = np.array([test.poisson_ratio for test in tests])
assert abs(blocks[61] - theory)[ratios > -0.2].max() < 0.01

# %% [markdown]
# Below kT/kN = -1/3 the lattice is unstable, and a tension test measures no property of a material.

# %%
figure, axes = plt.subplots(figsize=(6.4, 4.2), layout="constrained")
axes.axvspan(-0.45, -1 / 3, color="0.9", label="unstable lattice")
axes.plot([-0.45, 1], [1.45 / 4, 0], color="black", linewidth=1, label="theory, (1 - kT/kN)/4")
for (rows, values), marker in zip(blocks.items(), "^so"):
    axes.plot(ratios, values, marker, markersize=5, markerfacecolor="none", label=f"{rows} x {rows} discs")
axes.plot(ratios, infinite, "x", color="black", markersize=5, label="periodic cell")
axes.set(xlabel="kT/kN", ylabel="Poisson's ratio, plane strain", xlim=(-0.45, 1.05), ylim=(-0.02, 0.4))
axes.legend(frameon=False)
plt.show()
