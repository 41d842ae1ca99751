# SPDX-License-Identifier: GPL-3.0-or-later
# %% [markdown]
# # What accuracy costs
#
# **Which integrator is the cheapest for a wanted error, and what does another digit cost?**
#
# A study times every setting of a method against its error. This one steps a plane wave of a bonded lattice, whose
# motion is known in closed form.

# %%
import matplotlib.pyplot as plt

import equidem as eq

study = eq.study("integrators", accuracy=1e-6, rounds=3, budget=5)
best = study.recommendations[0]
print(best.text)

# %% [markdown]
# The errors of a scheme of order p fall as dt^p: with the slope -p against the time, which is proportional to 1/dt.

# %%
for order in study.orders:
    print(f"{order.method:16} order {order.observed_order:.3f}, theory {order.theoretical_order:g}")
    assert abs(order.observed_order - order.theoretical_order) < 0.3

# %%
figure, axes = plt.subplots(figsize=(6.4, 4.4), layout="constrained")
for order, marker, size in zip(study.orders, "o^sd", (8, 4, 5, 5)):
    settings = [setting for setting in study.settings if setting.method == order.method]
    axes.loglog([1e6 * setting.seconds.median for setting in settings], [setting.errors.motion for setting in settings],
                marker + "-", markersize=size, label=f"{order.method}, order {order.theoretical_order:g}")
chosen = best.setting
axes.plot(1e6 * chosen.seconds.median, chosen.errors.motion, "o", markersize=13, markerfacecolor="none", color="black",
          label=f"cheapest below {study.accuracy:g}")
axes.axhline(study.accuracy, color="black", linewidth=0.6, linestyle=":")
axes.set(xlabel="time of the run, µs", ylabel="error of the motion, of the amplitude",
         title="a wave in a bonded lattice")
axes.legend(frameon=False)
plt.show()
