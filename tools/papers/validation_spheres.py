# SPDX-License-Identifier: GPL-3.0-or-later
"""Spheres that meet each other or a floor: the eight impacts of Chung & Ooi (2011) and the programs of LAMMPS."""
import math
import tomllib

import numpy as np

from common import DATA, eq, published, rows_of, tracked
from shown import Row

MATERIALS = {row.name: row for row in rows_of("validation/materials", "name", "source")}
NUMBERS = published("validation/published")
# Numbers of ours beside published ones, computed while the method was still there: shown, not judged.
STORED = rows_of("validation/stored")
STEPS_PER_CONTACT = 1000
FLOOR = {"name": "floor", "point": [0.0, 0.0], "normal": [0.0, 1.0]}


def step_error(*numbers):
    """The number of the finest step, and how far others are from it."""
    return numbers[-1], max(abs(number - numbers[-1]) for number in numbers)


def sphere(radius, density, position, velocity=(0.0, 0.0), spin=0.0):
    return {"radius": radius, "density": density, "position": list(position), "velocity": list(velocity), "spin": spin}


def mass_of(body):
    return 4 / 3 * math.pi * body["radius"]**3 * body["density"]


def simulation(tables, step, steps):
    return eq.simulation(**{**tables, "run": {**tables.get("run", {}), "duration": steps * step, "time_step": step,
                                              "integrator": "velocity_verlet"}})


class Scene:
    """Spheres of one kind of contact, with walls."""
    def __init__(self, spheres, law, contact, walls=()):
        self.spheres, self.contact = spheres, contact
        self.tables = {"grains": {"body": "sphere"}, "grain": spheres, "collisions": {"law": law, **contact}}
        self.tables.update({"wall": walls} if walls else {})
        self.reduced_mass = 1 / sum(1 / mass_of(body) for body in spheres)

    def gap(self, places):
        radii = [body["radius"] for body in self.spheres]
        return places[0, 1] - radii[0] if len(radii) == 1 else np.linalg.norm(places[1] - places[0]) - sum(radii)

    def collide(self, step, deep=False):
        """An impact of bodies that begin in touch, until they part: velocities and spins; where `deep` also the largest
        overlap and force, the duration, and the overlap at each step."""
        run = simulation(self.tables, step, 100 * STEPS_PER_CONTACT)
        gap, overlaps, forces = -1.0, [0.0], [0.0]
        while gap < 0:
            run.advance(1 if deep else 40)
            before, gap = min(gap, 0.0), self.gap(run.positions)
            if deep:
                overlaps.append(-gap)
                forces += list(-run.contacts["normal_forces"])
        duration = run.time - step * gap / (gap - before)
        run.advance(1)  # a step that ends apart may have begun in contact
        return Row(velocities=run.velocities, spins=run.spins, overlap=peak(overlaps), force=peak(forces),
                   duration=duration, overlaps=overlaps)

    def measured(self, duration, measure, deep=False):
        """Numbers of an impact with a step, half and a quarter of it."""
        found = [measure(self.collide(duration / (share * STEPS_PER_CONTACT), deep)) for share in (1, 2, 4)]
        return [step_error(*numbers) for numbers in zip(*found)]


def peak(samples):
    """The largest of samples at equal distances, by the parabola through the largest and its neighbours."""
    top = int(np.argmax(samples))
    if top in (0, len(samples) - 1):
        return samples[top]
    before, largest, after = samples[top - 1:top + 2]
    return largest - (before - after)**2 / (8 * (before - 2 * largest + after))


# ---- the eight impacts

def hertz_stiffness(material, reduced_radius, two):
    """F = k d^(3/2), k = 4/3 E* sqrt(R*); a rigid plane does not add to the compliance."""
    own = MATERIALS[material]
    return 4 / 3 * own.young_Pa / (1 - own.poisson**2) / (2 if two else 1) * math.sqrt(reduced_radius)


def hertz_elastic(scene, v):
    """Largest overlap (5 m v²/(4 k))^(2/5), force, duration 2.9432 overlap/v (4/5 sqrt(pi) Gamma(2/5)/Gamma(9/10))."""
    k = scene.contact["stiffness"]
    overlap = (1.25 * scene.reduced_mass * v * v / k)**0.4
    return overlap, k * overlap**1.5, 0.8 * math.sqrt(math.pi) * math.gamma(0.4) / math.gamma(0.9) * overlap / v


def meeting_spheres(material):
    """Test 1: two equal spheres meet head on at 20 m/s."""
    density, radius = MATERIALS[material].density_kg_per_m3, 0.01
    return Scene([sphere(radius, density, (-radius, 0), (10, 0)), sphere(radius, density, (radius, 0), (-10, 0))],
                 "hertz_dashpot", {"stiffness": hertz_stiffness(material, radius / 2, True), "restitution": 1.0})


def impact_on_floor(material, radius, normal, tangential=0.0, restitution=1.0, mu=0.0, hertz=True):
    """The scene of an oblique impact, its duration."""
    k = hertz_stiffness(material, radius, False) * (1 if hertz else math.sqrt(radius))
    contact = {"stiffness": k, "restitution": restitution}
    if mu:
        contact.update(friction=mu, tangential_ratio=2 / 7)
    body = sphere(radius, MATERIALS[material].density_kg_per_m3, (0, radius), (tangential, -normal))
    scene = Scene([body], "hertz_dashpot" if hertz else "linear_dashpot", contact, [FLOOR])
    return scene, hertz_elastic(scene, normal)[2] if hertz else math.pi * math.sqrt(mass_of(body) / k)


def elastic(name, scene, closing):
    """Rows of an elastic impact beside Hertz's theory."""
    overlap, force, duration = hertz_elastic(scene, closing)
    ours = scene.measured(duration, lambda c: (1e6 * c.overlap, 1e-3 * c.force, 1e6 * c.duration), deep=True)
    names = ("largest overlap, µm", "largest force, kN", "duration, µs")
    theories = (1e6 * overlap, 1e-3 * force, 1e6 * duration)
    return [Row(name=name, what=what, theory=theory, ours=one) for what, theory, one in zip(names, theories, ours)]


OBLIQUE = Row(radius=1e-5, normal=5.0, mu=0.3)  # of test 5


def oblique(surface_speed, hertz=True):
    """Test 5: steel meets the floor."""
    return impact_on_floor("steel", OBLIQUE.radius, OBLIQUE.normal, surface_speed, mu=OBLIQUE.mu, hertz=hertz)


def surface_after(found):
    return found.velocities[0, 0] + found.spins[0] * OBLIQUE.radius


def force_rows(material):
    """Test 1: force over time, kN and µs, and the closed form of its peak and end."""
    scene = meeting_spheres(material)
    _, largest, duration = hertz_elastic(scene, 20)
    overlaps, k = scene.collide(duration / 100, deep=True).overlaps, 1e-3 * scene.contact["stiffness"]
    rows = [Row(time=1e4 * duration * step, force=k * max(0.0, depth)**1.5) for step, depth in enumerate(overlaps)]
    return rows, [Row(time=0.5e6 * duration, force=1e-3 * largest), Row(time=1e6 * duration, force=0)]


def impacts(size):
    floor, found, surface = impact_on_floor, {"elastic": [], "restitutions": []}, OBLIQUE.mu * OBLIQUE.normal
    for material in ("glass", "limestone"):
        found["elastic"] += elastic(f"test 1, {material}", meeting_spheres(material), 20)
    for material in ("aluminium alloy", "magnesium alloy"):
        found["elastic"] += elastic(f"test 2, {material}", floor(material, 0.1, 0.2)[0], 0.2)
    for material, e in zip(("aluminium oxide", "cast iron", "aluminium oxide", "cast iron", "aluminium oxide"),
                           (0.2, 0.4, 0.6, 0.8, 1.0)):
        for name, hertz in (("Hertz", True), ("linear", False)):
            scene, duration = floor(material, 0.0025, 3.9, restitution=e, hertz=hertz)
            ours, = scene.measured(duration, lambda c: (c.velocities[0, 1] / 3.9,))
            found["restitutions"].append(Row(name=f"{material}, {name}", theory=e, ours=ours))
    scene, duration = oblique(2 * surface, hertz=False)
    found["stuck"], = scene.measured(duration, lambda c: (surface_after(c) / (2 * surface),))
    # Test 7: equal spheres that spin against each other do not slip, and nothing acts across the contact.
    stiffness = hertz_stiffness("aluminium alloy of test 6", 0.05, True)
    contact = {"stiffness": stiffness, "restitution": 0.5, "friction": 0.4, "tangential_ratio": 2 / 7}
    equal = Scene([sphere(0.1, 2700, (-0.1, 0), (0.2, 0), 10.0), sphere(0.1, 2700, (0.1, 0), (-0.2, 0), -10.0)],
                  "hertz_dashpot", contact)
    found["spin"], found["across"] = equal.measured(hertz_elastic(equal, 0.4)[2],
                                                    lambda c: (c.spins[0], c.velocities[0, 1]))
    found["forces"] = {material: force_rows(material) for material in ("glass", "limestone")}
    rows = []
    for before in tracked("oblique impacts:", np.arange(0.5, 14.01, size.apart) * surface):
        row = Row(surface_before=before / surface)
        for name, hertz in (("hertz", True), ("linear", False)):
            scene, duration = oblique(before, hertz)
            after = scene.collide(duration / STEPS_PER_CONTACT)
            row["surface_after_" + name] = surface_after(after) / (OBLIQUE.mu * after.velocities[0, 1])
        rows.append(row)
    found["slides"] = [abs(row.surface_after_hertz - (row.surface_before - 7)) < 1e-3 for row in rows]
    found["first"] = rows[found["slides"].index(True)].surface_before
    return found, {"impacts_oblique": rows}


# ---- the programs of LAMMPS

SYSTEMS = tomllib.loads((DATA / "validation" / "lammps.toml").read_text(encoding="utf-8"))
THEIR_TOLERANCE = 1e-10  # relative, of their comparison with a recorded trajectory


def replayed(name, step, steps):
    """A system of lammps.toml after a number of steps."""
    run = simulation(SYSTEMS[name], step, steps)
    run.advance(steps)
    return run


def lammps(_size):
    readings = []
    for row in tracked("programs of LAMMPS:", rows_of("validation/readings")):
        numbers = getattr(replayed(row.system, float(row.step_s), int(row.steps)), row.quantity)[int(row.body)]
        ours = float(row.sign) * (numbers if row.quantity == "spins" else numbers["xy".index(row.axis)])
        readings.append(Row(name=row.name, ours=ours, why=row.why))
    # The closed form of a program whose recorded numbers could not be had, with numbers of our own.
    wall = Scene([sphere(0.0025, 2700, (0, 0.0025), (0, -2.0))], "linear_dashpot",
                 {"stiffness": 1e10, "restitution": 0.7}, [FLOOR])
    duration = math.pi * math.sqrt(wall.reduced_mass / 1e10)
    return {"readings": readings, "fall": step_error(*(replayed("alone", step, steps).positions[0, 1]
                                 for step, steps in ((1e-4, 1000), (5e-5, 2000)))),
            "wall": wall.measured(duration, lambda c: (c.velocities[0, 1],))[0]}, {}
