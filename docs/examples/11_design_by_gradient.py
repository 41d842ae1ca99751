# SPDX-License-Identifier: GPL-3.0-or-later
# %% [markdown]
# # Design by gradient: a cell with a wanted Poisson's ratio
#
# **Which radii and springs give nu = 0.12 with the least change, and what does the exact gradient save?**
#
# The unknowns are the radii of some 20 discs, which move the contact points, and the kT of their contacts, three times
# as many. `scipy.optimize` finds them from the derivatives of `homogenize`, and once more from differences.

# %%
import time

import matplotlib.pyplot as plt
import numpy as np
from scipy.optimize import minimize

import equidem as eq

wanted, radius, kN, kT = 0.12, 1e-3, 1e9, 0.4e9
network = eq.delaunay(discs=20, radius=radius, seed=3, periodic=True)
pairs = np.column_stack([network.contacts, network.shifts])
discs = len(network)
ends = network.centres[network.contacts[:, 1]] + network.shifts * np.array(network.cell)
distance = np.linalg.norm(ends - network.centres[network.contacts[:, 0]], axis=1)


def cell(radii):
    """Contact points divide the distance of the centres as the radii do."""
    share = radii[network.contacts[:, 0]] / radii[network.contacts].sum(axis=1)
    return eq.Assembly(network.centres, radii, pairs, levers=np.column_stack([share, 1 - share]) * distance[:, None],
                       cell=network.cell)


evaluations = 0


def poisson_ratio(unknowns, gradient=False):
    """nu in plane stress, and its derivatives by the logarithms of all radii and of all kT."""
    global evaluations
    evaluations += 1
    radii, springs = radius * np.exp(unknowns[:discs]), kT * np.exp(unknowns[discs:])
    h = eq.homogenize(cell(radii), eq.Springs(np.full(len(springs), kN), springs), sensitivities=gradient,
                      homogenize={"bounds": "affine"})
    if not gradient:
        return h.poisson_ratio.plane_stress, None
    K, G = h.bulk_modulus_2d, h.shear_modulus

    def of_nu(change):                                         # nu = (K - G)/(K + G)
        dK = (change[:, 0, 0] + change[:, 1, 1] + 2 * change[:, 0, 1]) / 4
        dG = (change[:, 0, 0] + change[:, 1, 1] - 2 * change[:, 0, 1] + 4 * change[:, 2, 2]) / 8
        return 2 * (G * dK - K * dG) / (K + G)**2

    return h.poisson_ratio.plane_stress, np.concatenate([radii * of_nu(h.dC_dradius), springs * of_nu(h.dC_dkT)])


# %% [markdown]
# The miss is weighed against the change, so that every radius and spring changes as little as it can.

# %%
def cost(unknowns, gradient):
    nu, slopes = poisson_ratio(unknowns, gradient)
    value = 1e5 * (nu - wanted)**2 + unknowns @ unknowns
    history.append((evaluations, value))
    return (value, 2e5 * (nu - wanted) * slopes + 2 * unknowns) if gradient else value


start = np.random.default_rng(1).normal(scale=0.02, size=discs + len(pairs))
print(f"nu = {poisson_ratio(start)[0]:.4f} at the start")
ways = {}
for name, gradient in (("exact gradient", True), ("differences", False)):
    evaluations, history, begin = 0, [], time.perf_counter()
    found = minimize(cost, start, args=(gradient,), jac=gradient, method="L-BFGS-B",
                     options={"maxfun": 10**6, "ftol": 1e-10, "gtol": 1e-6})
    ways[name] = np.array(history)
    radii, springs = np.split(abs(np.exp(found.x) - 1), [discs])
    print(f"{name:15} nu = {poisson_ratio(found.x)[0]:.4f} in {len(history):5} evaluations, "
          f"{time.perf_counter() - begin:6.2f} s; radii change by up to {radii.max():.1%}, kT by {springs.max():.1%}")
assert 20 * len(ways["exact gradient"]) < len(ways["differences"])

# %% [markdown]
# Differences need an evaluation for each unknown and step. The gradient costs a tenth of one homogenization, whatever
# the number of unknowns.

# %%
figure, axes = plt.subplots()
for name, costs in ways.items():
    axes.loglog(*costs.T, label=name)
axes.set(xlabel="evaluations", ylabel="cost")
axes.legend()
plt.show()
