# SPDX-License-Identifier: GPL-3.0-or-later
# %% [markdown]
# # A packing and its moduli by size
#
# **How many discs must a packing have until its moduli are those of the material?**
#
# Discs of 0.5 to 1 mm grow in a periodic box until they fill 0.82 of it, and are bonded where the gap between two is at
# most 5 % of the sum of their radii. Packings of several sizes and seeds tell how their moduli scatter.

# %%
import matplotlib.pyplot as plt
import numpy as np

import equidem as eq

packing = {"method": "growth", "sides": "periodic", "grains": 400, "solid_fraction": 0.82, "gap_tolerance": 0.05,
           "radii": {"smallest": 0.5e-3, "largest": 1e-3}}
springs = eq.Springs(kN=20e9, kT=5e9)
one = eq.pack(packing, springs)
moduli = eq.homogenize(one.assembly, springs)
print(one.assembly, f"E = {moduli.plane_strain.young_modulus / 1e9:.2f} GPa")

# %% [markdown]
# An ensemble of packings: the same, made and homogenized for each size and seed, in parallel.

# %%
sizes, samples = [100, 200, 400, 800], 12
ensemble = eq.Case(assembly={"kind": "packing"}, packing=packing, springs=springs,
                   ensemble={"discs": sizes, "samples": samples}).homogenize()
E = [size.plane_strain.young_modulus for size in ensemble.ensemble]
mean = np.array([e.mean for e in E])
scatter = np.array([e.standard_deviation for e in E])
half_width = np.array([(e.confidence_interval[1] - e.confidence_interval[0]) / 2 for e in E])

# %% [markdown]
# The scatter of one packing falls with the number of its discs, about as N^(-1/2): so many independent patches it has.

# %%
discs = np.array([size.mean_discs for size in ensemble.ensemble])
assert scatter[-1] < scatter[0] and abs(mean[-1] / mean[-2] - 1) < 0.03
assert abs(moduli.plane_strain.young_modulus - mean[2]) < 4 * scatter[2]

figure, (left, right) = plt.subplots(1, 2, figsize=(9, 3.8), layout="constrained")
one.plot(left, values=1e3 * np.array(one.assembly.radii), label="radius, mm")
left.set_title(f"one packing of {len(one.assembly)} discs")
right.errorbar(discs, mean / 1e9, half_width / 1e9, fmt="o", capsize=4, label=f"mean of {samples} packings, 95 %")
right.fill_between(discs, (mean - scatter) / 1e9, (mean + scatter) / 1e9, alpha=0.2,
                   label="standard deviation of one packing")
right.set(xscale="log", xlabel="discs", ylabel="Young's modulus, plane strain, GPa", ylim=(11.5, 14.2))
right.set_xticks(sizes, [str(size) for size in sizes], minor=False)
right.minorticks_off()
right.legend(frameon=False, loc="upper right")
plt.show()
