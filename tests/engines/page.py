# SPDX-License-Identifier: GPL-3.0-or-later
"""The page data/interop.md."""
import engines


def text_of(results):
    """results: (check, relative difference) of run_checks.measure."""
    lammps, yade = engines.version_of_lammps(engines.lammps_with_bonds()), engines.version_of_yade(engines.yade())
    older = engines.version_of_lammps(engines.lammps())
    text = f'''# Exported models in LAMMPS and YADE

Models of `equidem export` run in the program that they are for, compared with equidem: LAMMPS {lammps} (packages BPM,
GRANULAR, MOLECULE), for boxes of equal discs LAMMPS {older}, and YADE {yade}. Differences are the largest of
all discs or contacts over the largest value. This page was written by

    tests/engines/run_checks.py PROGRAM --page data/interop.md

and the same checks are tests with the label `engines`; they are skipped where an engine is not installed
(`EQUIDEM_LAMMPS_BPM` of CMake names a LAMMPS with BPM).

| engine | compared | difference | limit of the test |
|---|---|---|---|
'''
    for check, value in results:
        text += f"| {check[1]} | {check[2]} | {value:.1e} | {check[3]:.0e} |\n"
    return text + '''
- Bonds: a network of 60 discs from a random triangulation, with springs of their own where it rests. The laws are
  linear in equidem; engines compute finite motion. Half the difference of two states, under loads of both signs,
  leaves the part of first order; the third order remains. The row "finite motion not taken out" shows one state as
  it is.
- LAMMPS computes angles of bonds by the arc cosine, which loses half of the digits of small ones: its rest is
  certain to about 1e-5 at strains of 1e-5, and worse below.
- Periods: the factor 1 + (omega h)²/24 of leapfrog with the step h is taken out.
- Grains: without friction LAMMPS and equidem (`integrator = "velocity_verlet"`) make the same steps. With friction
  the levers of contacts differ by parts of the overlap: LAMMPS takes the radii, YADE the middle of the overlap,
  equidem parts of the distance in the ratio of the radii, and the radius at a wall. Moments differ by overlap over
  diameter, here 1e-3, and settled boxes by which contacts slide because of it; and the slip of a step is taken at
  its end, in equidem in its middle.
- Friction is exported where `--accept friction` is given, with the levers of the engine.
- Schedules, dashpots of bonds and pulses: one run as it is, with its finite motion, which falls with the loads (YADE: by
  ten with loads a tenth; LAMMPS loses digits of small angles then). A support of LAMMPS is driven by the force that
  puts it into its place in each step.
- Walls that move: the speed of a wall acts on dashpots; LAMMPS takes the difference of two places over a step.
'''
