# SPDX-License-Identifier: GPL-3.0-or-later
# %% [markdown]
# # What accuracy costs
#
# **Which integrator is the cheapest for a wanted error, and what does another digit cost?**
#
# A study file says what varies; each setting is timed against its error. This one steps a bonded disc that vibrates,
# whose motion is known in closed form.

# %%
import pathlib
import tempfile

import matplotlib.pyplot as plt

import equidem as eq

folder = pathlib.Path(tempfile.mkdtemp())
# m = pi/4 kg/m and kN = pi**3 Pa: a period of 1 s; alpha = pi/5 per second is 5 % of the critical damping.
(folder / "oscillator.toml").write_text("""
schema = "equidem/1"
assembly = {kind = "hexagonal", columns = 2, rows = 1, radius = 0.5, density = 1.0}
springs = {kN = 31.006276680299816, kT = 0.0}
run = {duration = 1.125, damping = {mass = 0.6283185307179586}}
support = [{group = "left", ux = 0.0, uy = 0.0}]
velocity = [{group = "right", velocity = [1.0, 0.0]}]
""")
(folder / "study.toml").write_text("""
schema = "equidem/1"

[study]
verb = "run"
case = "oscillator.toml"
measure = "energy.elastic"
truth = "known"
value = 0.09536402807942365   # kN u**2/2, u = (v/w) exp(-alpha t/2) sin(w t)

[[vary]]
key = "run.integrator"
names = "leapfrog, velocity_verlet, fourth_order, thesis"
orders = [2, 2, 4, 1]

[[vary]]
key = "run.time_step"
values = [0.03125, 0.015625, 0.0078125, 0.00390625, 0.001953125]
refines = "smaller"
""")

# %%
study = eq.study(folder / "study.toml", accuracy=1e-4, rounds=3, budget=5)
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
    axes.loglog([1e6 * setting.seconds.median for setting in settings],
                [setting.errors.energy_elastic for setting in settings], marker + "-", markersize=size,
                label=f"{order.method}, order {order.theoretical_order:g}")
chosen = best.setting
axes.plot(1e6 * chosen.seconds.median, chosen.errors.energy_elastic, "o", markersize=13, markerfacecolor="none",
          color="black", label=f"cheapest below {study.accuracy:g}")
axes.axhline(study.accuracy, color="black", linewidth=0.6, linestyle=":")
axes.set(xlabel="time of the run, µs", ylabel="relative error of the elastic energy",
         title="a bonded disc that vibrates")
axes.legend(frameon=False)
plt.show()
