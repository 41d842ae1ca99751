# SPDX-License-Identifier: GPL-3.0-or-later
# yade -n -x -j1 laboratory_yade.py TEST SAMPLE STEP [BONDS]
# A test of the laboratory in YADE, with the discs of a case (CSV: x,y,radius,...), its springs, stages and time step STEP (s): biaxial,
# hopper, unconfined (BONDS: CSV i,j). Discs are spheres in a plane with the masses and moments of discs. Prints one line of JSON.
import csv
import json
import math
import sys
import time

from yade import utils

test, sample, step = sys.argv[1], sys.argv[2], float(sys.argv[3])
with open(sample, encoding="utf-8") as file:
    discs = [tuple(float(row[name]) for name in ("x", "y", "radius")) for row in csv.DictReader(file)]


def add_discs(material, density):
    for x, y, radius in discs:
        body = utils.sphere((x, y, 0), radius, material=material)
        body.state.mass = density * math.pi * radius**2
        body.state.inertia = (body.state.mass * radius**2 / 2,) * 3
        body.state.blockedDOFs = "zXY"
        O.bodies.append(body)


def springs(kn, ks):
    """All contacts have these, whatever the radii."""
    return dict(kn=MatchMaker(algo="val", val=kn), ks=MatchMaker(algo="val", val=ks))


def engines(contact, law, shapes, *more):
    shape_of, pairs = shapes
    O.engines = [ForceResetter(), InsertionSortCollider([Bo1_Sphere_Aabb(), *shape_of]),
                 InteractionLoop([Ig2_Sphere_Sphere_ScGeom(), *pairs], [contact], [law]), *more]
    O.dt = step


def biaxial():
    """As grains_biaxial.toml: 100 kPa from four walls without friction, friction 0.5 between discs, 0.0165 m/s until 10 per cent."""
    stress, size = 1e5, 0.2
    O.materials.append(FrictMat(young=1e8, poisson=0.5, frictionAngle=0, density=2600, label="discs"))
    O.materials.append(FrictMat(young=1e8, poisson=0.5, frictionAngle=0, density=0, label="walls"))
    walls = utils.aabbWalls([(0, 0, -0.5), (size, size, 0.5)], thickness=0, oversizeFactor=1.5, material="walls")
    O.bodies.append(walls)
    add_discs("discs", 2600)
    press = TriaxialStressController(thickness=0, stressMask=3, internalCompaction=False, goal1=-stress, goal2=-stress, goal3=0,
                                     max_vel=0.2, stressDamping=0.25, wall_back_activated=False, wall_front_activated=False)
    engines(Ip2_FrictMat_FrictMat_FrictPhys(**springs(1e8, 5e7)), Law2_ScGeom_FrictPhys_CundallStrack(),
            ([Bo1_Box_Aabb()], [Ig2_Box_Sphere_ScGeom()]), press, NewtonIntegrator(damping=0.2))

    def settle(limit, unbalanced):
        end = O.time + limit
        while O.time < end:
            O.run(500, True)
            held = all(abs(press.stress(wall)[axis] / stress) > 0.99 for wall, axis in ((press.wall_right_id, 0), (press.wall_top_id, 1)))
            if held and utils.unbalancedForce() < unbalanced:
                return

    settle(1.0, 1e-3)
    # The friction of two materials is the lesser of theirs: walls stay smooth.
    O.materials[0].frictionAngle = math.atan(0.5)
    for contact in O.interactions:
        if max(contact.id1, contact.id2) >= 6 and min(contact.id1, contact.id2) >= 6:
            contact.phys.tangensOfFrictionAngle = 0.5
    settle(0.5, 1e-4)
    width, height = press.width, press.height
    press.stressMask, press.goal2 = 1, -0.08
    curve = []
    while press.height > height * 0.9:
        O.run(200, True)
        side, axial = -press.stress(press.wall_right_id)[0], -press.stress(press.wall_top_id)[1]
        curve.append((math.log(height / press.height), math.log(press.width * press.height / width / height), abs(axial), abs(side)))
    return {"curve": curve}


def hopper():
    """As grains_hopper.toml, with its dashpots for the mean mass."""
    mean = sum(2500 * math.pi * radius**2 for *_, radius in discs) / len(discs)
    loss = math.log(2) / math.hypot(math.pi, math.log(2))
    # Springs and dashpots of two bodies act one behind the other: a contact has half of each.
    O.materials.append(ViscElMat(kn=2e6, ks=1e6, cn=4 * loss * math.sqrt(mean / 2 * 1e6), cs=0, frictionAngle=math.atan(0.5), density=2500))
    add_discs(0, 2500)
    for x, sense in ((0, 1), (0.15, -1)):
        O.bodies.append(utils.wall((x, 0, 0), 0, sense=sense, material=0))
    gate = O.bodies.append(utils.box((0.075, -0.002, 0), (0.085, 0.002, 0.05), fixed=True, material=0))
    engines(Ip2_ViscElMat_ViscElMat_ViscElPhys(), Law2_ScGeom_ViscElPhys_Basic(),
            ([Bo1_Box_Aabb(), Bo1_Wall_Aabb()], [Ig2_Box_Sphere_ScGeom(), Ig2_Wall_Sphere_ScGeom()]),
            NewtonIntegrator(gravity=(0, -9.81, 0), damping=0))
    O.run(max(1, round(0.004 / step)), True)
    law = next(contact.phys for contact in O.interactions if contact.isReal)
    O.bodies.erase(gate)
    for centre in ((-0.01 + 0.055) / 2, (0.095 + 0.16) / 2):
        O.bodies.append(utils.box((centre, -0.002, 0), (0.0325, 0.002, 0.05), fixed=True, material=0))
    start, rows = O.time, []
    while O.time - start < 0.8:
        O.run(round(0.01 / step), True)
        rows.append((O.time, sum(1 for body in O.bodies if isinstance(body.shape, Sphere) and body.state.pos[1] < 0)))
    return {"out": rows, "kn": law.kn}


def unconfined():
    """As grains_unconfined.toml with springs along and across alone: CohFrictMat has no bond that breaks in bending."""
    speed, start = 0.95 * 2.5e-4 / 9e-3, 0.05 * 2.5e-4 / 1e-3
    # Contacts with walls have their springs from the materials: those of the mean radius.
    young = 2e9 / (sum(radius for *_, radius in discs) / len(discs))
    O.materials.append(CohFrictMat(young=young, poisson=0.4, density=2600, frictionAngle=math.atan(0.5), normalCohesion=1e30,
                                   shearCohesion=1e30, isCohesive=True, momentRotationLaw=False, fragile=True))
    O.materials.append(CohFrictMat(young=young, poisson=0.4, density=0, frictionAngle=0, normalCohesion=0, shearCohesion=0,
                                   isCohesive=False, momentRotationLaw=False))
    add_discs(0, 2600)
    bottom, top = (O.bodies.append(utils.wall((0, y, 0), 1, sense=sense, material=1)) for y, sense in ((-1e-6, 1), (0.080001, -1)))
    detect = Ig2_Sphere_Sphere_ScGeom6D(interactionDetectionFactor=1.12)
    bond = Ip2_CohFrictMat_CohFrictMat_CohFrictPhys(setCohesionNow=True, setCohesionOnNewContacts=True)
    O.engines = [ForceResetter(), InsertionSortCollider([Bo1_Sphere_Aabb(aabbEnlargeFactor=1.12), Bo1_Wall_Aabb()]),
                 InteractionLoop([detect, Ig2_Wall_Sphere_ScGeom()], [bond],
                                 [Law2_ScGeom6D_CohFrictPhys_CohesionMoment(always_use_moment_law=False), Law2_ScGeom_FrictPhys_CundallStrack()]),
                 NewtonIntegrator(damping=0.2)]
    O.dt = 1e-15
    O.step()
    detect.interactionDetectionFactor, bond.setCohesionOnNewContacts = 1.0, False
    with open(sys.argv[4], encoding="utf-8") as file:
        pairs = {(int(row["i"]), int(row["j"])) for row in csv.DictReader(file)}
    found = {}
    for contact in list(O.interactions):
        pair = (min(contact.id1, contact.id2), max(contact.id1, contact.id2))
        if max(pair) >= len(discs):
            continue
        if pair not in pairs and pair[::-1] not in pairs:
            O.interactions.erase(*pair)
            continue
        least = 2 * min(discs[pair[0]][2], discs[pair[1]][2])
        contact.phys.kn, contact.phys.ks, contact.phys.unp = 2e9, 8e8, contact.geom.penetrationDepth
        contact.phys.normalAdhesion, contact.phys.shearAdhesion = 4e6 * least, 8e6 * least
        found[pair] = True
    O.dt = step
    rows, width = [], 0.04
    while O.time < 8e-3 and not (len(rows) > 50 and rows[-1][1] < 0.3 * max(force for _, force in rows)):
        now = start if O.time < 1e-3 else speed
        O.bodies[bottom].state.vel, O.bodies[top].state.vel = (0, now, 0), (0, -now, 0)
        force = 0
        for _ in range(4):
            O.run(25, True)
            force += (O.forces.f(top)[1] - O.forces.f(bottom)[1]) / 8 / width
        closed = O.bodies[bottom].state.pos[1] - O.bodies[top].state.pos[1] + 0.080002
        rows.append((closed / 0.08, force))
    return {"curve": rows, "bonds": len(found)}


began = time.time()
result = {"biaxial": biaxial, "hopper": hopper, "unconfined": unconfined}[test]()
print("RESULT " + json.dumps({"seconds": time.time() - began, "steps": O.iter, **result}))
