# SPDX-License-Identifier: GPL-3.0-or-later
# yade -n -x -j1 settled_yade.py DUMP WIDTH STEPS ANGLE
# Discs that LAMMPS has settled, with YADE's linear spring and friction law (Cundall and Strack) and its local damping. Prints steps
# of discs per second.
import json
import math
import sys
import time

from yade import utils

dump, width, steps, angle = sys.argv[1], float(sys.argv[2]), int(sys.argv[3]), math.radians(float(sys.argv[4]))
with open(dump) as file:
    lines = file.read().splitlines()
head = next(k for k, line in enumerate(lines) if line.startswith("ITEM: ATOMS"))
columns = lines[head].split()[2:]
discs = [dict(zip(columns, map(float, line.split()))) for line in lines[head + 1 :] if line.strip()]
O.materials.append(FrictMat(young=1e5 / 0.0075, poisson=0.8, frictionAngle=math.atan(0.5), density=2500))
for disc in discs:
    body = utils.sphere((disc["x"], disc["y"], 0), disc["diameter"] / 2, material=0)
    body.state.blockedDOFs = "zXY"
    O.bodies.append(body)
for place, axis, sense in (((0, 0, 0), 0, 1), ((width, 0, 0), 0, -1), ((0, 0, 0), 1, 1)):
    O.bodies.append(utils.wall(place, axis, sense=sense, material=0))
O.engines = [
    ForceResetter(),
    InsertionSortCollider([Bo1_Sphere_Aabb(), Bo1_Wall_Aabb()]),
    InteractionLoop(
        [Ig2_Sphere_Sphere_ScGeom(), Ig2_Wall_Sphere_ScGeom()],
        [Ip2_FrictMat_FrictMat_FrictPhys()],
        [Law2_ScGeom_FrictPhys_CundallStrack()],
    ),
    NewtonIntegrator(gravity=(9.81 * math.sin(angle), -9.81 * math.cos(angle), 0), damping=0.2),
]
O.dt = 1.5e-5


def advance(number):
    """O.run with waiting would look for its end every 40 ms alone."""
    for _ in range(number):
        O.step()


advance(1000)
rates = []
for _ in range(3):
    start = time.time()
    advance(steps)
    rates.append(len(discs) * steps / (time.time() - start))
contacts = sum(1 for interaction in O.interactions if interaction.isReal)
print("RESULT " + json.dumps({"rates": rates, "contacts": contacts}))
