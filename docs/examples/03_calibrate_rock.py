# SPDX-License-Identifier: GPL-3.0-or-later
# %% [markdown]
# # Calibrating a rock
#
# **Which springs make a random assembly behave as a rock with E = 30 GPa, nu = 0.15 and 2600 kg/m³?**
#
# A search on kT/kN finds kN and kT of *this* assembly, in about ten factorizations.

# %%
import matplotlib.pyplot as plt
import numpy as np

import equidem as eq

E, nu, density = 30e9, 0.15, 2600.0  # Pa, plane strain, kg/m³
cell = eq.delaunay(discs=1000, radii={"smallest": 0.8e-3, "largest": 1.2e-3}, seed=4, periodic=True)
rock = eq.calibrate(cell, young_modulus=E, poisson_ratio=nu, density=density, plane="strain")
print(f"kN = {rock.kN:.4g} Pa, kT = {rock.kT:.4g} Pa, {rock.factorizations} factorizations")
print(f"density of the discs {rock.density.discs:.0f} kg/m³, steps below {rock.guaranteed_step:.3g} s are stable")
lowest, highest = rock.feasible_poisson_ratio
print(f"this assembly can have nu up to {highest:.3f}")

# %% [markdown]
# The moduli of the assembly with these springs are the wanted ones, to round-off. The springs that the mean field
# advises miss them.

# %%
moduli = eq.homogenize(cell, rock)
assert abs(moduli.plane_strain.young_modulus / E - 1) < 1e-12 and abs(moduli.plane_strain.poisson_ratio - nu) < 1e-12
advised = eq.homogenize(cell, rock.mean_field)
G = E / (2 * (1 + nu))
K = G / (1 - 2 * nu)
assert np.isclose(rock.wave_speeds.pressure, np.sqrt((K + G) / density), rtol=1e-12)
assert np.isclose(rock.wave_speeds.shear, np.sqrt(G / density), rtol=1e-12)

# %% [markdown]
# Why one pair of springs: Poisson's ratio falls with kT/kN alone, and E grows with kN at a given ratio.

# %%
ratios = np.linspace(0, 1, 15)
curve = [eq.homogenize(cell, (rock.kN, r * rock.kN)).plane_strain.poisson_ratio for r in ratios]
assert (np.diff(curve) < 0).all() and abs(curve[0] - highest) < 1e-9

figure, axes = plt.subplots(figsize=(6.4, 4.2), layout="constrained")
axes.plot(ratios, curve, label="this assembly")
axes.plot(ratios, (1 - ratios) / 4, "--", color="0.5", label="mean field, (1 - kT/kN)/4")
axes.plot(rock.ratio, moduli.plane_strain.poisson_ratio, "o", color="C3",
          label=f"calibrated: E = {E / 1e9:g} GPa, nu = {nu}")
axes.plot(rock.mean_field.kT / rock.mean_field.kN, advised.plane_strain.poisson_ratio, "s", color="0.4",
          label=f"advised by the mean field: E = {advised.plane_strain.young_modulus / 1e9:.1f} GPa, "
                f"nu = {advised.plane_strain.poisson_ratio:.3f}")
axes.axhline(highest, color="C0", linewidth=0.8, linestyle=":", label=f"largest feasible nu, {highest:.3f}")
axes.set(xlabel="kT/kN", ylabel="Poisson's ratio, plane strain", xlim=(0, 1))
axes.legend(frameon=False, loc="lower left", fontsize=9)
plt.show()
