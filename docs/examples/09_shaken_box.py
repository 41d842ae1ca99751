# SPDX-License-Identifier: GPL-3.0-or-later
# %% [markdown]
# # A shaken box
#
# **What do the discs in a box do while it is shaken with 1 g at 2 Hz?**
#
# Discs fall into a box and come to rest. Then the box moves to and fro twice, with the acceleration a cos(2 pi f t),
# and ends where it began.

# %%
import matplotlib.pyplot as plt
import numpy as np
from matplotlib.animation import FuncAnimation, PillowWriter

import equidem as eq

width, g = 0.4, 9.81  # m, m/s²
filled = eq.pack({"method": "falling", "grains": 150, "box": (width, 1.0), "density": 2500.0,
                  "radii": {"smallest": 0.008, "largest": 0.012}}, (1e6, 5e5)).assembly
start, radii = np.array(filled.centres), np.array(filled.radii)

# %%
frequency, cycles, amplitude = 2.0, 2, g
simulation = eq.simulation(
    grains={"density": 2500.0},
    grain=[{"position": centre, "radius": radius} for centre, radius in zip(start, radii)],
    collisions={"law": "linear_dashpot", "restitution": 0.3, "contact_duration": 2e-3, "friction": 0.3},
    wall=[{"name": "floor", "point": (0, 0), "normal": (0, 1)}, {"name": "left", "point": (0, 0), "normal": (1, 0)},
          {"name": "right", "point": (width, 0), "normal": (-1, 0)}],
    shaking={"acceleration": amplitude, "frequency": frequency, "cycles": cycles},
    run={"duration": 1.3, "gravity": (0, -g)})
frames = list(simulation.frames(every=round(0.04 / simulation.time_step)))


def box_left(time):
    """Place of the left side: a(1 - cos(2 pi f t))/(2 pi f)² during the shaking."""
    omega = 2 * np.pi * frequency
    return amplitude * (1 - np.cos(omega * min(time, cycles / frequency))) / omega**2


# %% [markdown]
# Nothing leaves the box, and the ledger of energies closes: work of walls and gravity, what friction and dashpots take.

# %%
for frame in frames:
    x, y = frame.positions.T
    assert (x > box_left(frame.time)).all() and (x < box_left(frame.time) + width).all() and (y > 0).all()
energy = simulation.energy
print(f"work of the walls {energy['work_of_walls']:.1f} J/m, taken by friction {energy['lost_slip']:.1f} J/m")
assert abs(energy["error"]) < 0.01 * energy["work_of_walls"]

# %% [markdown]
# The animation, in a notebook by `HTML(animation.to_jshtml())`, and one figure of four moments.

# %%
height = 1.15 * max((frame.positions[:, 1] + radii).max() for frame in frames)


def draw(axes, frame):
    axes.clear()
    left = box_left(frame.time)
    axes.plot([left, left, left + width, left + width], [height, 0, 0, height], color="black")
    simulation.plot(axes, frame=frame, values=start[:, 1])
    axes.set(xlim=(-0.02, width + 0.15), ylim=(-0.02, height), title=f"t = {frame.time:.2f} s")


animated, one = plt.subplots(figsize=(4.5, 3.8))
animation = FuncAnimation(animated, lambda k: draw(one, frames[k]), frames=len(frames), interval=80)
animation.save("shaken_box.gif", PillowWriter(fps=12), dpi=60)
plt.close(animated)

figure, grid = plt.subplots(2, 2, figsize=(8.4, 5), layout="constrained")
for axes, time in zip(grid.flat, (0, 0.25, 0.75, 1.3)):
    draw(axes, min(frames, key=lambda frame: abs(frame.time - time)))
figure.suptitle("colour: height at the start")
plt.show()
