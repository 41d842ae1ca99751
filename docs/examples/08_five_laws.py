# SPDX-License-Identifier: GPL-3.0-or-later
# %% [markdown]
# # Collisions by the five laws
#
# **Which law of collision returns the restitution that was asked for, and at which time step?**
#
# Two equal spheres meet head-on with a restitution of 0.7. Their speed after over that before is measured for steps
# from a third to a three-hundredth of the duration of the contact.

# %%
import matplotlib.pyplot as plt
import numpy as np

import equidem as eq

wanted, radius, speed = 0.7, 0.02, 1.0  # -, m, m/s
laws = {"exact_flow": "exact flow", "linear_dashpot": "linear spring and dashpot",
        "hertz_dashpot": "Hertz spring and dashpot", "five_case_map": "five-case map", "energy_map": "energy map"}


def restitution(law, steps_per_contact):
    spheres = [{"position": (side * 1.03 * radius, 0.0), "radius": radius, "velocity": (-side * speed / 2, 0.0)}
               for side in (-1, 1)]
    simulation = eq.simulation(grains={"body": "sphere", "density": 2500.0}, grain=spheres,
                               collisions={"law": law, "restitution": wanted, "largest_overlap": 0.01 * radius,
                                           "closing_speed": speed},
                               run={"duration": 5e-3, "steps_per_contact": steps_per_contact})
    simulation.run()
    velocity = simulation.velocities[:, 0]
    assert abs(velocity.sum()) < 1e-12  # momentum
    return (velocity[1] - velocity[0]) / speed


# %%
steps = np.unique(np.geomspace(3.5, 300, 16).round(1))
errors = {law: np.array([abs(restitution(law, n) - wanted) for n in steps]) for law in laws}
for law, error in errors.items():
    print(f"{laws[law]:26} largest error {error.max():.1e}, at the smallest step {error[-1]:.1e}")

# %% [markdown]
# The exact flow solves the contact in closed form over the step, its beginning and end included: round-off at any step.
# The maps apply the restitution at once. Forces at the start of a step err with the step. (Errors of 0 are drawn at
# 1e-17.)

# %%
assert errors["exact_flow"].max() < 1e-9
assert errors["linear_dashpot"][-1] < 0.02

figure, axes = plt.subplots(figsize=(6.4, 4.4), layout="constrained")
for (law, error), marker in zip(errors.items(), "os^dv"):
    axes.loglog(1 / steps, np.maximum(error, 1e-17), marker + "-", markersize=4, label=laws[law])
axes.set(xlabel="time step over duration of the contact", ylabel="error of the restitution",
         title=f"two spheres meet, restitution {wanted}", ylim=(3e-18, 3))
axes.legend(frameon=False)
plt.show()
