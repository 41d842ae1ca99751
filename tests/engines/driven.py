# SPDX-License-Identifier: GPL-3.0-or-later
"""Bonded discs that schedules drive, whose bonds have dashpots, or that fill a periodic cell: the exported model in its
engine against equidem."""
from bonds import NETWORK

#: Supports and loads that follow a ramp, a sine and a table; the table and the ramp change from the first step on.
DRIVEN = NETWORK + '''
[[schedule]]
name = "ramp"
kind = "ramp"
end = 1.5e-4
[[schedule]]
name = "sine"
kind = "sine"
start = 3.0e-5
frequency = 8000.0
[[schedule]]
name = "table"
kind = "table"
times = [0.0, 8.0e-5, 1.4e-4]
values = [0.0, 1.0, -0.5]
[[support]]
group = "bottom"
ux = 0.0
uy = 0.0
rotation = 0.0
[[support]]
group = "top"
ux = {across}
uy = {up}
{turning}
schedule = "ramp"
[[load]]
group = "right"
force = {sine}
kind = "per_disc"
schedule = "sine"
[[load]]
group = "left"
force = {table}
{moment}
kind = "per_disc"
schedule = "table"
[[load]]
group = "left"
force = {constant}
kind = "per_disc"
[run]
duration = 2.0e-4
time_step = 4.0e-7
'''


def driven(size, turning):
    """Strains are about 1e-4 times the size; LAMMPS takes neither rotations nor moments."""
    return DRIVEN.format(across=4e-6 * size, up=2e-6 * size, sine=[300 * size, -500 * size], table=[200 * size, 100 * size],
                         constant=[-50 * size, 0.0], turning=f"rotation = {1e-4 * size}" if turning else "",
                         moment=f"moment = {size}" if turning else "")


DASHPOTS = [(NETWORK + '''
[[support]]
group = "bottom"
ux = 0.0
uy = 0.0
rotation = 0.0
[[load]]
group = "top"
force = [300.0, -500.0]
kind = "per_disc"
[run]
duration = 2.0e-4
time_step = 4.0e-7
damping = {{ {damping} }}
''').format(damping=damping) for damping in ("stiffness = 5.0e-6", "contact = 0.2")]

#: A pulse in a periodic cell, across whose sides discs are bonded.
PERIODIC = '''
[assembly]
{assembly}
density = 2500.0
periodic = true
[springs]
kN = 1e9
kT = 0.3e9
[[group]]
name = "some"
discs = [3, 4, 10, 17]
[[velocity]]
group = "some"
velocity = [0.02, 0.01]
[run]
duration = 2e-4
'''
LATTICE, RANDOM = (PERIODIC.format(assembly=assembly) for assembly in (
    'kind = "hexagonal"\ncolumns = 8\nrows = 8\nradius = 0.005', 'kind = "delaunay"\ndiscs = 60\nradius = 0.005\nseed = 3'))
