# SPDX-License-Identifier: GPL-3.0-or-later
# yade -n -x -j1 laboratory_yade.py TEST SAMPLE STEP [MORE...]
# A test of the laboratory in YADE, with the discs of a case (CSV: x,y,radius,...), its springs, stages and time step STEP (s). Tests and
# what they want MORE: biaxial (left, bottom, right, top of a sample at rest; none: a loose one), shear_box (height of the lid of a sample
# at rest), repose (friction, and rolling friction where there is some), hopper, unconfined and brazilian (CSV of the bonds, i,j), beam.
# Discs are spheres in a plane with the masses and moments of discs. Prints one line of JSON.
import csv
import json
import math
import sys
import time

from yade import utils

test, sample, step = sys.argv[1], sys.argv[2], float(sys.argv[3])
with open(sample, encoding="utf-8") as file:
    discs = [tuple(float(row[name]) for name in ("x", "y", "radius")) for row in csv.DictReader(file)]


def advance(steps):
    """O.run with waiting would look for its end every 40 ms alone."""
    for _ in range(steps):
        O.step()


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
    rolls = isinstance(law, Law2_ScGeom6D_CohFrictPhys_CohesionMoment)
    spheres = Ig2_Sphere_Sphere_ScGeom6D if rolls else Ig2_Sphere_Sphere_ScGeom
    O.engines = [ForceResetter(), InsertionSortCollider([Bo1_Sphere_Aabb(), *shape_of]),
                 InteractionLoop([spheres(), *pairs], [contact], [law]), *more]
    O.dt = step


def biaxial():
    """As grains_biaxial.toml: 100 kPa from four walls without friction, friction 0.5 between discs, 0.0165 m/s until 10 per cent,
    of a loose sample until 5, behind its peak."""
    stress, (left, low, right, high) = 1e5, map(float, sys.argv[4:8] if len(sys.argv) > 4 else (0, 0, 0.2, 0.2))
    loose = len(sys.argv) == 4
    O.materials.append(FrictMat(young=1e8, poisson=0.5, frictionAngle=0 if loose else math.atan(0.5), density=2600, label="discs"))
    O.materials.append(FrictMat(young=1e8, poisson=0.5, frictionAngle=0, density=0, label="walls"))
    walls = utils.aabbWalls([(left, low, -0.5), (right, high, 0.5)], thickness=0, oversizeFactor=1.5, material="walls")
    O.bodies.append(walls)
    add_discs("discs", 2600)
    press = TriaxialStressController(thickness=0, stressMask=3, internalCompaction=False, goal1=-stress, goal2=-stress, goal3=0,
                                     max_vel=0.2, stressDamping=0.25, wall_back_activated=False, wall_front_activated=False)
    engines(Ip2_FrictMat_FrictMat_FrictPhys(**springs(1e8, 5e7)), Law2_ScGeom_FrictPhys_CundallStrack(),
            ([Bo1_Box_Aabb()], [Ig2_Box_Sphere_ScGeom()]), press, NewtonIntegrator(damping=0.2))

    def settle(limit, unbalanced):
        end = O.time + limit
        while O.time < end:
            advance(500)
            held = all(abs(press.stress(wall)[axis] / stress) > 0.99 for wall, axis in ((press.wall_right_id, 0), (press.wall_top_id, 1)))
            if held and utils.unbalancedForce() < unbalanced:
                return

    if loose:
        settle(1.0, 1e-3)
        # The friction of two materials is the lesser of theirs: walls stay smooth.
        O.materials[0].frictionAngle = math.atan(0.5)
        for contact in O.interactions:
            if min(contact.id1, contact.id2) >= 6:
                contact.phys.tangensOfFrictionAngle = 0.5
    settle(0.5, 1e-4)
    width, height = press.width, press.height
    press.stressMask, press.goal2 = 1, -0.08
    curve = []
    while press.height > height * (0.95 if loose else 0.9):
        advance(200)
        side, axial = -press.stress(press.wall_right_id)[0], -press.stress(press.wall_top_id)[1]
        curve.append((math.log(height / press.height), math.log(press.width * press.height / width / height), abs(axial), abs(side)))
    return {"curve": curve}


def heap(friction, rolling=None):
    """The column of lab_heap.csv between two walls, with the springs and dashpots of the cases for the mean mass; with rolling friction
    local damping in place of dashpots. Rolling springs and limits of two discs of one radius are those of the cases: mu_r r/2."""
    if rolling is not None:
        mean = sum(radius for *_, radius in discs) / len(discs)
        O.materials.append(CohFrictMat(young=1e6 / mean, poisson=0.5, frictionAngle=math.atan(friction), density=2500, isCohesive=False,
                                       momentRotationLaw=True, alphaKr=0.25, alphaKtw=0, etaRoll=rolling / 2))
        law = (Ip2_CohFrictMat_CohFrictMat_CohFrictPhys(),
               Law2_ScGeom6D_CohFrictPhys_CohesionMoment(always_use_moment_law=True, useIncrementalForm=True))
        return column(*law, ([Bo1_Box_Aabb()], [Ig2_Box_Sphere_ScGeom6D()]), 0.2)
    mean = sum(2500 * math.pi * radius**2 for *_, radius in discs) / len(discs)
    loss = math.log(2) / math.hypot(math.pi, math.log(2))
    # Springs and dashpots of two bodies act one behind the other: a contact has half of each.
    O.materials.append(ViscElMat(kn=2e6, ks=1e6, cn=4 * loss * math.sqrt(mean / 2 * 1e6), cs=0, frictionAngle=math.atan(friction), density=2500))
    return column(Ip2_ViscElMat_ViscElMat_ViscElPhys(), Law2_ScGeom_ViscElPhys_Basic(),
                  ([Bo1_Box_Aabb(), Bo1_Wall_Aabb()], [Ig2_Box_Sphere_ScGeom(), Ig2_Wall_Sphere_ScGeom()]), 0)


def column(contact, law, shapes, damping):
    add_discs(0, 2500)

    def side(x, sense):
        if damping == 0:
            return utils.wall((x, 0, 0), 0, sense=sense, material=0)
        return utils.box((x - 0.002 * sense, 0.5, 0), (0.002, 0.5, 0.05), fixed=True, material=0)

    sides = [O.bodies.append(side(x, sense)) for x, sense in ((0, 1), (0.15, -1))]
    gate = O.bodies.append(utils.box((0.075, -0.002, 0), (0.085, 0.002, 0.05), fixed=True, material=0))
    engines(contact, law, shapes, NewtonIntegrator(gravity=(0, -9.81, 0), damping=damping))
    return sides, gate


def hopper():
    """As grains_hopper.toml."""
    _, gate = heap(0.5)
    advance(max(1, round(0.004 / step)))
    law = next(contact.phys for contact in O.interactions if contact.isReal)
    O.bodies.erase(gate)
    for centre in ((-0.01 + 0.055) / 2, (0.095 + 0.16) / 2):
        O.bodies.append(utils.box((centre, -0.002, 0), (0.0325, 0.002, 0.05), fixed=True, material=0))
    start, rows = O.time, []
    while O.time - start < 0.8:
        advance(round(0.01 / step))
        rows.append((O.time, sum(1 for body in O.bodies if isinstance(body.shape, Sphere) and body.state.pos[1] < 0)))
    return {"out": rows, "kn": law.kn}


def repose():
    """As grains_repose.toml."""
    (_, right), _ = heap(*map(float, sys.argv[4:6]))
    O.bodies.append(utils.box((0.1555, 0.003, 0), (0.0005, 0.003, 0.05), fixed=True, material=0))
    end = O.time + 0.2
    while O.time < end:
        advance(500)
        if utils.unbalancedForce() < 1e-2:
            break
    O.bodies.erase(right)
    advance(round(1.5 / step))
    return {"discs": [(body.state.pos[0], body.state.pos[1], body.shape.radius) for body in O.bodies if isinstance(body.shape, Sphere)]}


def shear_box():
    """As grains_shear_box.toml from its packing at rest on; the lid is a body of a tenth of the mass of the sand that 100 kPa push."""
    stress, size, half, gap, top = 1e5, 0.2, 0.5, 5e-4, float(sys.argv[4])
    for label, friction in (("discs", 0.5), ("plates", 0.5), ("sides", 0.0)):
        O.materials.append(FrictMat(young=1e8, poisson=0.5, frictionAngle=math.atan(friction), density=2600, label=label))
    add_discs("discs", 2600)

    def plate(centre, extents, material, fixed=True):
        return O.bodies.append(utils.box((*centre, 0), (*extents, half), fixed=fixed, material=material))

    t = 1e-3
    lid = plate((size / 2, top + t), (size / 2, t), "plates", fixed=False)
    floor = plate((size / 2, -t), (size / 2 + 0.02, t), "plates")
    lower = [floor, plate((-t, 0.03), (t, 0.05), "sides"), plate((size + t, 0.03), (t, 0.05), "sides"),
             plate((-0.025, 0.08 - t), (0.025, t), "sides")]
    upper = [plate((-t, 0.165 + gap), (t, 0.085), "sides"), plate((size + t, 0.165 + gap), (t, 0.085), "sides"),
             plate((size + 0.025, 0.08 + gap + t), (0.025, t), "sides")]
    state = O.bodies[lid].state
    state.mass = 0.1 * sum(2600 * math.pi * radius**2 for *_, radius in discs)
    state.blockedDOFs = "xzXYZ"
    engines(Ip2_FrictMat_FrictMat_FrictPhys(**springs(1e8, 5e7)), Law2_ScGeom_FrictPhys_CundallStrack(),
            ([Bo1_Box_Aabb()], [Ig2_Box_Sphere_ScGeom()]), NewtonIntegrator(damping=0.2))
    O.forces.setPermF(lid, (0, -stress * size, 0))

    while O.time < 0.5:
        advance(500)
        if utils.unbalancedForce() < 1e-4:
            break
    for wall in lower:
        O.bodies[wall].state.vel = (0.02, 0, 0)
    start, bottom, curve = O.bodies[floor].state.pos[0], state.pos[1], []
    while O.bodies[floor].state.pos[0] - start < 0.016:
        pushed = 0
        for _ in range(4):
            advance(50)
            pushed -= sum(O.forces.f(wall)[0] for wall in lower) / 4
        curve.append((O.bodies[floor].state.pos[0] - start, state.pos[1] - bottom, pushed / (stress * size)))
    return {"curve": curve}


def pressed(ends, way):
    """The bonded rock between two plates without friction at the heights `ends`, each of which goes `way` in 10 ms, until 8 ms or the
    force has fallen to 0.3 of its peak. Springs along and across alone: CohFrictMat has no bond that breaks in bending."""
    speed, start = 0.95 * way / 9e-3, 0.05 * way / 1e-3
    # Contacts with walls have their springs from the materials: those of the mean radius.
    young = 2e9 / (sum(radius for *_, radius in discs) / len(discs))
    O.materials.append(CohFrictMat(young=young, poisson=0.4, density=2600, frictionAngle=math.atan(0.5), normalCohesion=1e30,
                                   shearCohesion=1e30, isCohesive=True, momentRotationLaw=False, fragile=True))
    O.materials.append(CohFrictMat(young=young, poisson=0.4, density=0, frictionAngle=0, normalCohesion=0, shearCohesion=0,
                                   isCohesive=False, momentRotationLaw=False))
    add_discs(0, 2600)
    bottom, top = (O.bodies.append(utils.wall((0, y, 0), 1, sense=sense, material=1)) for y, sense in zip(ends, (1, -1)))
    contacts = cohesive([Bo1_Wall_Aabb()], [Ig2_Wall_Sphere_ScGeom()], False)
    with open(sys.argv[4], encoding="utf-8") as file:
        pairs = {(int(row["i"]), int(row["j"])) for row in csv.DictReader(file)}
    found = 0
    for contact in contacts:
        pair = (min(contact.id1, contact.id2), max(contact.id1, contact.id2))
        if max(pair) >= len(discs):
            continue
        if pair not in pairs and pair[::-1] not in pairs:
            O.interactions.erase(*pair)
            continue
        least = 2 * min(discs[pair[0]][2], discs[pair[1]][2])
        contact.phys.kn, contact.phys.ks, contact.phys.unp = 2e9, 8e8, contact.geom.penetrationDepth
        contact.phys.normalAdhesion, contact.phys.shearAdhesion = 4e6 * least, 8e6 * least
        found += 1
    rows = []
    while O.time < 8e-3 and not (len(rows) > 50 and rows[-1][1] < 0.3 * max(force for _, force in rows)):
        now = start if O.time < 1e-3 else speed
        O.bodies[bottom].state.vel, O.bodies[top].state.vel = (0, now, 0), (0, -now, 0)
        force = 0
        for _ in range(4):
            advance(25)
            force += (O.forces.f(top)[1] - O.forces.f(bottom)[1]) / 8
        rows.append((O.time, force))
    return {"curve": rows, "bonds": found}


def cohesive(shapes, pairs, moments):
    """The loop of bonded discs; all contacts of discs up to a gap of 12 per cent, which are bonds, without their springs."""
    detect = Ig2_Sphere_Sphere_ScGeom6D(interactionDetectionFactor=1.12)
    bond = Ip2_CohFrictMat_CohFrictMat_CohFrictPhys(setCohesionNow=True, setCohesionOnNewContacts=True)
    laws = [Law2_ScGeom6D_CohFrictPhys_CohesionMoment(always_use_moment_law=moments)]
    if pairs:
        laws.append(Law2_ScGeom_FrictPhys_CundallStrack())
    O.engines = [ForceResetter(), InsertionSortCollider([Bo1_Sphere_Aabb(aabbEnlargeFactor=1.12), *shapes]),
                 InteractionLoop([detect, *pairs], [bond], laws), NewtonIntegrator(damping=0.2)]
    O.dt = 1e-15
    O.step()
    detect.interactionDetectionFactor, bond.setCohesionOnNewContacts = 1.0, False
    O.dt = step
    return list(O.interactions)


def unconfined():
    """As grains_unconfined.toml."""
    return pressed((-1e-6, 0.080001), 2.5e-4)


def brazilian():
    """As grains_brazilian.toml."""
    return pressed((-0.024621, 0.024621), 1.5e-4)


def beam():
    """As grains_bonded_beam.toml until its first cycle, without dashpots: the middle disc goes down by 0.15 mm, those at the ends stay."""
    O.materials.append(CohFrictMat(young=1e9 / 0.005, poisson=0.4, density=2500, frictionAngle=0.5, normalCohesion=1e30, shearCohesion=1e30,
                                   isCohesive=True, momentRotationLaw=True, fragile=True))
    add_discs(0, 2500)
    for contact in cohesive([], [], True):
        phys = contact.phys
        phys.kn, phys.ks, phys.kr, phys.unp, phys.maxRollPl = 1e9, 4e8, 1e5 / 12, contact.geom.penetrationDepth, 1e30
    for body, blocked in ((0, "yzXY"), (20, "yzXY"), (10, "xyzXY")):
        O.bodies[body].state.blockedDOFs = blocked
    end, loads = 0.1, []
    while O.time < end:
        # As the ramp of the case: 3 s^2 - 2 s^3 of the way.
        share = min(1, O.time / end)
        O.bodies[10].state.vel = (0, -1.5e-4 * 6 * share * (1 - share) / end, 0)
        advance(20)
        loads.append((O.bodies[0].state.pos[1] - O.bodies[10].state.pos[1], O.forces.f(10)[1]))
    return {"curve": loads}


began = time.time()
tests = (biaxial, shear_box, unconfined, brazilian, beam, repose, hopper)
result = next(one for one in tests if one.__name__ == test)()
print("RESULT " + json.dumps({"seconds": time.time() - began, "steps": O.iter, **result}))
