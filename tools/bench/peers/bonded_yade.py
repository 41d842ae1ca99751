# SPDX-License-Identifier: GPL-3.0-or-later
# yade -n -x -j1 bonded_yade.py FOLDER KN RATIO DAMPING STEP SECONDS
# The assembly, loads and displacements that `equidem solve --out FOLDER` wrote, by damped motion of bonded discs (CohFrictMat without
# opening and sliding). STEP: of YADE's own PWaveTimeStep. Prints one line of JSON: when which error was reached.
import csv
import json
import math
import sys
import time

import numpy as np
from yade import utils

folder, kn, ratio = sys.argv[1], float(sys.argv[2]), float(sys.argv[3])
damping, step, longest = (float(word) for word in sys.argv[4:7])
with open(folder + "/discs.csv") as file:
    rows = list(csv.DictReader(file))
place = np.array([[float(row["x_m"]), float(row["y_m"])] for row in rows])
exact = np.array([[float(row["ux_m"]), float(row["uy_m"])] for row in rows])
radius = float(rows[0]["radius_m"])
load = np.zeros_like(place)
with open(folder + "/contacts.csv") as file:
    contacts = list(csv.DictReader(file))
for row in contacts:  # what contacts pull at a disc balances what is put on it
    force = np.array([float(row["force_x_N_per_m"]), float(row["force_y_N_per_m"])])
    load[int(row["i"])] -= force
    load[int(row["j"])] += force
count = len(place)
bottom = place[:, 1] < place[:, 1].min() + 0.1 * radius
corner = bottom & (place[:, 0] < place[bottom, 0].min() + 0.1 * radius)
free = np.stack([~corner, ~bottom], 1)
load[~free] = 0
load[abs(load) < 1e-9 * abs(load).max()] = 0

O.materials.append(
    CohFrictMat(
        young=kn / radius,
        poisson=ratio,
        density=2500,
        frictionAngle=0.5,
        normalCohesion=1e30,
        shearCohesion=1e30,
        isCohesive=True,
        momentRotationLaw=False,
    )
)
for disc in range(count):
    body = utils.sphere((place[disc, 0], place[disc, 1], 0), radius, material=0)
    body.state.blockedDOFs = ("" if free[disc, 0] else "x") + ("" if free[disc, 1] else "y") + "zXY"
    O.bodies.append(body)
O.engines = [
    ForceResetter(),
    InsertionSortCollider([Bo1_Sphere_Aabb(aabbEnlargeFactor=1.05)]),
    InteractionLoop(
        [Ig2_Sphere_Sphere_ScGeom6D(interactionDetectionFactor=1.05)],
        [Ip2_CohFrictMat_CohFrictMat_CohFrictPhys(setCohesionNow=True, setCohesionOnNewContacts=True)],
        [Law2_ScGeom6D_CohFrictPhys_CohesionMoment(always_use_moment_law=False)],
    ),
    NewtonIntegrator(damping=damping),
]
O.dt = 1e-12
O.step()
bonds = [interaction for interaction in O.interactions if interaction.isReal]
assert len(bonds) == len(contacts), (len(bonds), len(contacts))
assert math.isclose(bonds[0].phys.kn, kn, rel_tol=1e-9) and math.isclose(bonds[0].phys.ks, ratio * kn, rel_tol=1e-9)
for disc in np.nonzero(load.any(axis=1))[0]:
    O.forces.setPermF(int(disc), (load[disc, 0], load[disc, 1], 0))
O.dt = step * utils.PWaveTimeStep()

wall, steps, reached, error = 0.0, 0, {}, math.inf
while wall < longest and len(reached) < 2:
    start = time.time()
    for _ in range(100):  # O.run with waiting would look for its end every 40 ms alone
        O.step()
    wall += time.time() - start
    steps += 100
    moved = np.array([body.state.pos for body in O.bodies])[:, :2] - place
    error = np.linalg.norm(moved - exact) / np.linalg.norm(exact)
    if not error < 1e6:
        break
    for wanted in ("1e-3", "1e-6"):
        if error < float(wanted) and wanted not in reached:
            reached[wanted] = wall
print("RESULT " + json.dumps({"discs": count, "steps": steps, "seconds": wall, "error": error, "reached": reached}))
