# SPDX-License-Identifier: GPL-3.0-or-later
# yade -n -x -j1 breaking_yade.py ASSEMBLY KN KT FRICTION MOTION STEPS DAMPING
# The discs and bonds of an assembly file with strengths, its bottom held and its top moved up by MOTION (m) in STEPS steps at a constant
# speed. CohFrictMat carries kN, kT (contact points in the middle), f_t, f_s - friction N; a bond that breaks leaves a contact with friction.
# Prints one line of JSON: breaks in their order, the load against the motion.
import json
import math
import sys
import time

from yade import utils

path = sys.argv[1]
kn, kt, friction, motion = (float(word) for word in sys.argv[2:6])
steps, damping = int(sys.argv[6]), float(sys.argv[7])
with open(path, encoding="utf-8") as file:
    assembly = json.load(file)
radius = assembly["discs"][0][2]
bottom, top = (set(assembly["groups"][side]["discs"]) for side in ("bottom", "top"))

O.materials.append(CohFrictMat(young=kn / radius, poisson=kt / kn, density=2500, frictionAngle=math.atan(friction), normalCohesion=1e30,
                               shearCohesion=1e30, isCohesive=True, momentRotationLaw=False, fragile=True))
for number, disc in enumerate(assembly["discs"]):
    body = utils.sphere((disc[0], disc[1], 0), disc[2], material=0)
    body.state.blockedDOFs = ("xy" if number in bottom else "y" if number in top else "") + "zXY"
    O.bodies.append(body)
detect = Ig2_Sphere_Sphere_ScGeom6D(interactionDetectionFactor=1.05)
bond = Ip2_CohFrictMat_CohFrictMat_CohFrictPhys(setCohesionNow=True, setCohesionOnNewContacts=True)
newton = NewtonIntegrator(damping=damping)
O.engines = [
    ForceResetter(),
    InsertionSortCollider([Bo1_Sphere_Aabb(aabbEnlargeFactor=1.05)]),
    InteractionLoop([detect], [bond], [Law2_ScGeom6D_CohFrictPhys_CohesionMoment(always_use_moment_law=False)]),
    newton,
]
O.dt = 1e-12
O.step()
detect.interactionDetectionFactor, bond.setCohesionOnNewContacts = 1.0, False
for (i, j, *_), (tension, shear) in zip(assembly["contacts"], assembly["strengths"]):
    physics = O.interactions[i, j].phys
    assert math.isclose(physics.kn, kn, rel_tol=1e-9) and math.isclose(physics.ks, kt, rel_tol=1e-9)
    physics.normalAdhesion, physics.shearAdhesion = tension, shear
O.dt = 0.3 * utils.PWaveTimeStep()
speed = motion / (steps * O.dt)
for disc in top:
    O.bodies[disc].state.vel = (0, speed, 0)


def holds(pair):
    try:
        found = O.interactions[pair[0], pair[1]]
    except IndexError:
        return False
    return found.isReal and not found.phys.cohesionBroken


whole = {number: pair for number, pair in enumerate(assembly["contacts"])}
broken, curve, reading = [], [], 0.0


def read_off():
    global reading
    begin = time.time()
    moved = O.bodies[last].state.pos[1] - height
    curve.append((moved, -sum(O.forces.f(disc)[1] for disc in top)))
    for number in [number for number, pair in whole.items() if not holds(pair)]:
        broken.append((number, moved))
        del whole[number]
    reading += time.time() - begin


last = max(top)
height = O.bodies[last].state.pos[1]
O.engines = O.engines + [PyRunner(iterPeriod=max(10, steps // 2000), command="read_off()")]
begin = time.time()
for _ in range(steps):  # O.run with waiting would look for its end every 40 ms alone
    O.step()
wall = time.time() - begin - reading
print("RESULT " + json.dumps({"seconds": wall, "broken": broken, "curve": curve}))
