# SPDX-License-Identifier: GPL-3.0-or-later
# %% [markdown]
# # A pulse and its dispersion
#
# **How fast does a pulse run through a lattice, and why does it leave ripples behind?**
#
# One plane of discs is pushed along x. Its pulse holds waves of all lengths; short ones are slower than the long ones,
# which have the sound speed of the continuum.

# %%
import matplotlib.pyplot as plt
import numpy as np

import equidem as eq

kN, kT, radius, density = 1e9, 0.5e9, 5e-3, 2600.0  # Pa, Pa, m, kg/m³
lattice = eq.hexagonal(columns=128, rows=2, radius=radius, periodic=True)
planes = np.argsort(lattice.centres[:, 0])  # one disc each, one radius apart
middle = planes[[len(planes) // 2]]
simulation = eq.simulation(lattice, (kN, kT), density=density, run={"duration": 0.75e-3, "step_fraction": 0.2},
                           velocity=[{"group": middle, "velocity": (1.0, 0.0)}])
dt = simulation.time_step
velocity = np.array([frame.velocities[planes, 0] for frame in simulation.frames(every=1)])  # (times, planes)
assert abs(simulation.energy["error"]) < 1e-12 * simulation.energy["initial"]

# %% [markdown]
# The amplitude of each wave number q oscillates at one frequency, so v(t + dt) + v(t - dt) = 2 cos(omega dt) v(t).
# Theory for planes that move along x, and the sound speed of its long waves:
#
# m omega² = 2 kN (1 - cos 2qa) + (kN + 3 kT)(1 - cos qa),   c² = (K + G)/rho

# %%
waves = np.fft.rfft(velocity, axis=1)
q = 2 * np.pi * np.fft.rfftfreq(len(planes), radius)
cosine = np.sum((waves[2:] + waves[:-2]) * waves[1:-1].conj(), axis=0).real / np.sum(2 * abs(waves[1:-1]) ** 2, axis=0)
measured = np.arccos(np.clip(cosine, -1, 1)) / dt
mass = density * np.pi * radius**2
omega = np.sqrt((2 * kN * (1 - np.cos(2 * q * radius)) + (kN + 3 * kT) * (1 - np.cos(q * radius))) / mass)
stepped = 2 / dt * np.arcsin(omega * dt / 2)  # of central differences at this step
assert abs(measured - stepped)[1:].max() < 1e-6 * stepped.max()

moduli = eq.homogenize(lattice, (kN, kT))
sound = np.sqrt((moduli.bulk_modulus_2d + moduli.shear_modulus) / (density * lattice.solid_fraction))
assert abs(omega[1] / q[1] / sound - 1) < 1e-3
print(f"sound speed {sound:.1f} m/s; the longest wave runs at {omega[1] / q[1]:.1f} m/s")

# %%
times = 1e3 * dt * np.arange(len(velocity))
figure, (left, right) = plt.subplots(1, 2, figsize=(9, 3.8), layout="constrained")
x = radius * (np.arange(len(planes)) - len(planes) // 2)
image = left.pcolormesh(x, times, velocity, cmap="RdBu_r", vmin=-0.12, vmax=0.12, rasterized=True)
figure.colorbar(image, ax=left, label="velocity, m/s")
for side in (-1, 1):
    left.plot(side * 1e-3 * times * sound, times, "k--", linewidth=1, label="sound speed" if side > 0 else None)
left.set(xlabel="x, m", ylabel="time, ms", xlim=(x[0], x[-1]), ylim=(0, times[-1]), title="the pulse")
left.legend(loc="lower right")
right.plot(q, measured / 2e3 / np.pi, "o", markersize=3, markerfacecolor="none", label="measured in the pulse")
right.plot(q, omega / 2e3 / np.pi, color="black", linewidth=1, label="theory")
right.plot(q, sound * q / 2e3 / np.pi, "k--", linewidth=1, label="sound speed of the continuum")
right.set(xlabel="wave number q, rad/m", ylabel="frequency, kHz", xlim=(0, q[-1]),
          ylim=(0, 1.25 * omega.max() / 2e3 / np.pi), title="its dispersion")
right.legend(frameon=False, loc="lower right")
plt.show()
