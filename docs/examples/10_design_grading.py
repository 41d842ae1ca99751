# SPDX-License-Identifier: GPL-3.0-or-later
# %% [markdown]
# # A design study: which grading gives nu = 0.15?
#
# **How wide must a grading be, and how densely packed, for a Poisson's ratio of 0.15 with springs of kT/kN = 0.7?**
#
# Packings over a grid of gradings and solid fractions, six seeds each, in one table.

# %%
import matplotlib.pyplot as plt
import numpy as np

import equidem as eq

wanted, smallest, seeds = 0.15, 1e-3, 6
case = eq.Case(assembly={"kind": "packing"}, springs=(20e9, 14e9),
               packing={"method": "growth", "sides": "periodic", "grains": 250, "gap_tolerance": 0.05,
                        "solid_fraction": 0.8, "radii": {"smallest": smallest, "largest": 2 * smallest}})
table = eq.sweep(case, {"packing.radii.largest": np.array([1.2, 2, 3, 4]) * smallest,
                        "packing.solid_fraction": [0.78, 0.80, 0.82], "packing.seed": range(1, seeds + 1)})
table = table[table["status"] == "solved"].rename(columns={"poisson_ratio.plane_strain": "nu",
                                                    "packing.solid_fraction": "fraction"})
table["width"] = table["packing.radii.largest"] / smallest
means = table.groupby(["width", "fraction"])["nu"].agg(["mean", "sem"]).round(4)
print(means)

# %% [markdown]
# A plane through all points: density counts, the width of the grading a little.

# %%
design = np.stack([np.ones(len(table)), np.log(table["width"]), table["fraction"]], axis=1)
fit, *_ = np.linalg.lstsq(design, table["nu"].to_numpy(), rcond=None)
scatter = np.std(table["nu"] - design @ fit, ddof=3)
width = 2.5
fraction = (wanted - fit[0] - fit[1] * np.log(width)) / fit[2]
print(f"nu = {fit[0]:.3f} {fit[1]:+.4f} ln(width) {fit[2]:+.3f} fraction, scatter {scatter:.4f}")
print(f"largest/smallest = {width}: nu = {wanted} at a solid fraction of {fraction:.3f}")

# %% [markdown]
# The design, tried on larger packings that the fit has not seen.

# %%
designed = case.copy().set("packing.radii.largest", width * smallest).set("packing.solid_fraction", fraction)
tries = eq.sweep(designed.set("packing.grains", 600), {"packing.seed": range(11, 14)})["poisson_ratio.plane_strain"]
print(f"nu of three packings of 600 discs: {', '.join(f'{nu:.4f}' for nu in tries)}")
assert abs(tries.mean() - wanted) < 3 * scatter

figure, axes = plt.subplots(figsize=(6.4, 4.2), layout="constrained")
for color, (fixed, group) in zip(("C0", "C1", "C2"), table.groupby("fraction")):
    points = group.groupby("width")["nu"].agg(["mean", "sem"])
    axes.errorbar(points.index, points["mean"], points["sem"], fmt="o", capsize=3, color=color,
                  label=f"solid fraction {fixed:g}")
    axes.plot(points.index, fit[0] + fit[1] * np.log(points.index) + fit[2] * fixed, "--", linewidth=0.8,
              color=color)
axes.axhline(wanted, color="black", linewidth=0.8, linestyle=":")
axes.errorbar(width, tries.mean(), tries.sem(), fmt="*", markersize=12, capsize=3, color="C3",
              label=f"designed: solid fraction {fraction:.3f}")
axes.set(xlabel="largest over smallest radius", ylabel="Poisson's ratio, plane strain",
         title=f"mean and standard error of {seeds} packings", xlim=(1, 4.2), ylim=(0.12, 0.26))
axes.legend(frameon=False, loc="upper left", ncols=2, fontsize=9)
plt.show()
