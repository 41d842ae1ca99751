# SPDX-License-Identifier: GPL-3.0-or-later
"""Spheres that meet each other or a floor: the eight impacts of Chung & Ooi (2011) and the programs of LAMMPS."""
import math

import numpy as np

from common import Axis, Plot, Progress, Series, curve, eq, points, rows_of
from validation_findings import NUMBERS, WHY, Findings, step_error, stored

MATERIALS = {row["name"]: tuple(float(row[key]) for key in ("young_Pa", "poisson", "density_kg_per_m3"))
             for row in rows_of("validation/materials")}
SPHERE_FACTOR = 2 / 5  # I/(m R²)
STEPS_PER_CONTACT = 1000
FLOOR = {"name": "floor", "point": [0.0, 0.0], "normal": [0.0, 1.0]}
ALLOY = "aluminium alloy of test 6"


def sphere(radius, density, position, velocity=(0.0, 0.0), spin=0.0):
    return {"radius": radius, "density": density, "position": list(position), "velocity": list(velocity), "spin": spin}


def mass_of(body):
    return 4 / 3 * math.pi * body["radius"]**3 * body["density"]


class Scene:
    """Spheres of one kind of contact, with walls."""
    def __init__(self, spheres, law, contact, walls=(), gravity=0.0):
        self.spheres, self.law, self.contact, self.walls, self.gravity = spheres, law, contact, list(walls), gravity
        self.reduced_mass = 1 / sum(1 / mass_of(body) for body in spheres)

    def simulation(self, step, steps):
        walls = {"wall": self.walls} if self.walls else {}
        return eq.simulation(grains={"body": "sphere"}, grain=self.spheres, collisions={"law": self.law, **self.contact},
                             run={"duration": steps * step, "time_step": step, "integrator": "velocity_verlet",
                                  "gravity": [0.0, -self.gravity]}, **walls)

    def after(self, step, steps):
        """The run after a number of steps of the velocity Verlet scheme."""
        run = self.simulation(step, steps)
        run.advance(steps)
        return run

    def gap(self, places):
        radii = [body["radius"] for body in self.spheres]
        return places[0, 1] - radii[0] if len(radii) == 1 else np.linalg.norm(places[1] - places[0]) - sum(radii)

    def collide(self, step, deep=False):
        """An impact of bodies that begin in touch, until they part: the velocities and spins, and where `deep` before
        them the largest overlap and force and the duration."""
        run = self.simulation(step, 100 * STEPS_PER_CONTACT)
        gap, overlaps, forces = -1.0, [0.0], [0.0]
        while gap < 0:
            run.advance(1 if deep else 40)
            before, gap = min(gap, 0.0), self.gap(run.positions)
            if deep:
                overlaps.append(-gap)
                forces += list(run.contacts["normal_forces"])
        duration = run.time - step * gap / (gap - before)
        run.advance(1)  # a step that ends apart may have begun in contact
        return (peak(overlaps), peak(forces), duration) * deep + (run.velocities, run.spins)


def peak(samples):
    """The largest of samples at equal distances, by the parabola through the largest and its neighbours."""
    top = int(np.argmax(samples))
    if top in (0, len(samples) - 1):
        return samples[top]
    before, largest, after = samples[top - 1:top + 2]
    return largest - (before - after)**2 / (8 * (before - 2 * largest + after))


def measured(scene, duration, measure, deep=False):
    """Results with a step, half and a quarter of it."""
    found = [measure(*scene.collide(duration / (share * STEPS_PER_CONTACT), deep)) for share in (1, 2, 4)]
    return [step_error(*numbers) for numbers in zip(*found)]


def hertz_stiffness(material, reduced_radius, two):
    """F = k d^(3/2), k = 4/3 E* sqrt(R*); a rigid plane does not add to the compliance."""
    young, poisson, _ = MATERIALS[material]
    return 4 / 3 * young / (1 - poisson**2) / (2 if two else 1) * math.sqrt(reduced_radius)


def hertz_elastic(scene, v):
    """Largest overlap (5 m v²/(4 k))^(2/5), force, duration 2.9432 overlap/v (4/5 sqrt(pi) Gamma(2/5)/Gamma(9/10))."""
    k = scene.contact["stiffness"]
    overlap = (1.25 * scene.reduced_mass * v * v / k)**0.4
    return overlap, k * overlap**1.5, 0.8 * math.sqrt(math.pi) * math.gamma(0.4) / math.gamma(0.9) * overlap / v


def meeting_spheres(material):
    """Test 1: two equal spheres meet head on."""
    density, radius = MATERIALS[material][2], 0.01
    return Scene([sphere(radius, density, (-radius, 0), (10, 0)), sphere(radius, density, (radius, 0), (-10, 0))],
                 "hertz_dashpot", {"stiffness": hertz_stiffness(material, radius / 2, True), "restitution": 1.0})


class Oblique:
    """An oblique impact on the floor."""
    def __init__(self, material, radius, normal, tangential=0.0, spin=0.0, restitution=1.0, mu=0.0, hertz=True):
        self.radius, self.normal, self.tangential, self.spin, self.mu = radius, normal, tangential, spin, mu
        k = hertz_stiffness(material, radius, False) * (1 if hertz else math.sqrt(radius))
        contact = {"stiffness": k, "restitution": restitution, **({"friction": mu, "tangential_ratio": 2 / 7} if mu else {})}
        body = sphere(radius, MATERIALS[material][2], (0, radius), (tangential, -normal), spin)
        self.scene = Scene([body], "hertz_dashpot" if hertz else "linear_dashpot", contact, [FLOOR])
        self.duration = hertz_elastic(self.scene, normal)[2] if hertz else math.pi * math.sqrt(mass_of(body) / k)
        self.slowed = mu * (1 + restitution) * normal  # change of the tangential velocity where the contact slides throughout
        self.surface_speed = tangential + spin * radius

    def compare_sliding(self, findings, name):
        for what, formula in (("tangential velocity after, m/s", self.tangential - self.slowed),
                              ("spin after, rad/s", self.spin - self.slowed / (SPHERE_FACTOR * self.radius))):
            findings.formula(f"{name}: {what}", formula, "Chung & Ooi 2011", stored(f"{name}: {what}"))

    def surface_point(self):
        """Surface speeds over mu times the normal speeds before and after."""
        v, spin = self.scene.collide(self.duration / STEPS_PER_CONTACT)
        return self.surface_speed / (self.mu * self.normal), (v[0, 0] + spin[0] * self.radius) / (self.mu * v[0, 1])


def test5(over_friction, hertz=True):
    return Oblique("steel", 1e-5, 5.0, over_friction * 0.3 * 5, mu=0.3, hertz=hertz)


def compare_elastic(findings, name, scene, closing):
    overlap, force, duration = hertz_elastic(scene, closing)
    ours = measured(scene, duration, lambda d, f, t, *_: (1e6 * d, 1e-3 * f, 1e6 * t), deep=True)
    for what, number, formula in zip(("largest overlap, µm", "largest force, kN", "duration, µs"), ours,
                                     (1e6 * overlap, 1e-3 * force, 1e6 * duration)):
        findings.formula(f"{name}: {what}", formula, "Hertz 1882", number)


def compare_spinning_pairs(findings):
    radius, speed, spin = 0.1, 0.2, 10.0

    def scene(other, density, speeds, spins):
        contact = {"stiffness": hertz_stiffness(ALLOY, 1 / (1 / radius + 1 / other), True), "restitution": 0.5,
                   "friction": 0.4, "tangential_ratio": 2 / 7}
        return Scene([sphere(radius, 2700, (-radius, 0), (speeds[0], 0), spins[0]),
                      sphere(other, density, (other, 0), (speeds[1], 0), spins[1])], "hertz_dashpot", contact)
    # Equal spheres that spin against each other: the surfaces do not slip, and nothing acts across the contact.
    equal = scene(radius, 2700, (speed, -speed), (spin, -spin))
    same = measured(equal, hertz_elastic(equal, 2 * speed)[2], lambda v, turn: (turn[0], v[0, 1]))
    findings.formula("test 7, equal spheres: spin after, rad/s", spin, "Chung & Ooi 2011", same[0])
    findings.formula("test 7, equal spheres: tangential velocity after, m/s", 0, "Chung & Ooi 2011", same[1])
    # A sphere that spins meets one five times as large and 1000 times as dense, at rest. The closed form keeps the
    # normal; in a contact of finite duration it turns by about this angle.
    unequal = scene(5 * radius, 2.7e6, (speed, 0), (spin, 0))
    mass = mass_of(unequal.spheres[0])
    slowed = 0.4 * 1.5 * unequal.reduced_mass * speed / mass  # mu (1 + e) m* v/m
    turned = slowed * hertz_elastic(unequal, speed)[2] / (6 * radius)
    for quantity, change, before in (("spin after, rad/s", slowed / (SPHERE_FACTOR * radius), spin),
                                     ("tangential velocity after, m/s", slowed, 0)):
        name = f"test 8, one five times as large: {quantity}"
        findings.formula(name, before - change, "Chung & Ooi 2011", stored(name), allowance=turned * change)


def force_plot():
    series = []
    for material, colour in (("glass", "blue"), ("limestone", "vermilion")):
        scene, times, forces = meeting_spheres(material), [], []
        _, largest, duration = hertz_elastic(scene, 20)
        run = scene.simulation(duration / 100, 200)
        for _ in range(101):
            times.append(1e6 * run.time)
            forces.append(1e-3 * scene.contact["stiffness"] * max(0.0, -scene.gap(run.positions))**1.5)
            run.advance(1)
        series += [Series(material, times, forces, colour=colour),
                   points(f"{material}, closed form: peak and end", [0.5e6 * duration, 1e6 * duration], [1e-3 * largest, 0],
                          colour, filled=False)]
    return Plot("Test 1: force of two spheres that meet head on at 20 m/s", Axis("time, µs"), Axis("normal force, kN"), series)


def impacts(quick):
    progress, findings = Progress("eight impacts:"), Findings("impacts")
    for material in ("glass", "limestone"):
        compare_elastic(findings, f"test 1, {material}", meeting_spheres(material), 20)
    for material in ("aluminium alloy", "magnesium alloy"):
        compare_elastic(findings, f"test 2, {material}", Oblique(material, 0.1, 0.2).scene, 0.2)
    progress.update(0.3)
    for material, e in zip(("aluminium oxide", "cast iron", "aluminium oxide", "cast iron", "aluminium oxide"),
                           (0.2, 0.4, 0.6, 0.8, 1.0)):
        for hertz in (True, False):
            impact = Oblique(material, 0.0025, 3.9, restitution=e, hertz=hertz)
            ours = measured(impact.scene, impact.duration, lambda v, _: (v[0, 1] / 3.9,))
            findings.formula(f"test 3, {material}, {'Hertz' if hertz else 'linear'}: restitution", e, "Chung & Ooi 2011", ours[0])
    progress.update(0.6)
    for degrees in (40, 60, 80):
        angle = math.radians(degrees)
        Oblique("aluminium oxide", 0.0025, 3.9 * math.cos(angle), 3.9 * math.sin(angle), restitution=0.98,
                mu=0.092).compare_sliding(findings, f"test 4, {degrees} degrees")
    test5(10).compare_sliding(findings, "test 5, surface speed 10 µ v_n")
    stuck = test5(2, hertz=False)
    ours = measured(stuck.scene, stuck.duration, lambda v, spin: ((v[0, 0] + spin[0] * stuck.radius) / stuck.surface_speed,))
    findings.formula("test 5, linear springs with kT/kN = 2/7, surface speed 2 µ v_n: surface speed after over before", -1,
                     "closed form", ours[0])
    for material in (ALLOY, "nylon"):
        Oblique(material, 0.1, 0.2, spin=3 * 0.2 / 0.1, restitution=0.5, mu=0.4).compare_sliding(
            findings, f"test 6, {material.removesuffix(' of test 6')}, spin 3 v_n/R")
    compare_spinning_pairs(findings)
    speeds = np.arange(0.5, 14.01, 1.5 if quick else 0.5)
    (before, hertz), (_, linear) = (zip(*(test5(x, by_hertz).surface_point() for x in speeds)) for by_hertz in (True, False))
    progress.end()
    slides = [abs(b - (a - 7)) < 1e-3 for a, b in zip(before, hertz)]
    first = slides.index(True)
    findings.trend("test 5: contacts slide throughout from a surface speed of 7 µ v_n on, and not below", "Chung & Ooi 2011",
                   all(slides[first:]) and abs(before[first] - 7) <= 1.5, f"the first that does is {before[first]:g} µ v_n")
    findings.tables["impacts_oblique"] = {"surface_before": before, "surface_after_hertz": hertz, "surface_after_linear": linear}
    findings.plots["impacts_force"] = force_plot()
    findings.plots["impacts_oblique"] = Plot("Test 5: oblique elastic impact of a sphere on a rigid plane",
                                             Axis("surface speed before / (µ normal speed)"),
                                             Axis("surface speed after / (µ normal speed)"), [
        curve(lambda x: x - 7, 7, 14, label="slides throughout: x - 7", column="sliding"),
        curve(lambda x: -x, 0, 3.5, label="sticks, linear springs with $k_T/k_N$ = 2/7: -x", style="dashed_line",
              column="sticking"),
        points("linear springs", before, linear, "blue", "square", filled=False),
        points("Hertz, tangential spring of constant stiffness", before, hertz, "vermilion")])
    return findings


# ---- the programs of LAMMPS

THEIR_TOLERANCE = 1e-10  # relative, of the comparison with a recorded trajectory


class TheirSphere:
    """One sphere on a floor by LAMMPS's rules, in which it differs: friction is limited by mu times the size of the
    normal force, attraction included, and each of the runs starts with a force of the velocities of the full step, for
    which the tangential spring is not stretched."""
    radius, mass = 0.0025, mass_of({"radius": 0.0025, "density": 2700})

    def __init__(self, kN, kT, mu, step, place, velocity, cN=0.0, cT=0.0, gravity=0.0):
        self.kN, self.kT, self.mu, self.step, self.cN, self.cT, self.gravity = kN, kT, mu, step, cN, cT, gravity
        self.y, (self.vx, self.vy), self.spin, self.stretch = place, velocity, 0.0, 0.0

    def evaluate(self, stretches):
        self.ax, self.ay, self.turning = 0.0, -self.gravity, 0.0
        overlap = self.radius - self.y
        if overlap <= 0:
            self.stretch = 0.0
            return
        normal, slip = self.kN * overlap - self.cN * self.vy, self.vx + self.spin * self.radius
        if stretches:
            self.stretch += slip * self.step
        tangential, limit = -self.kT * self.stretch - self.cT * slip, self.mu * abs(normal)
        if abs(tangential) > limit:
            tangential = math.copysign(limit, tangential)
            self.stretch = -(tangential + self.cT * slip) / self.kT
        self.ax, self.ay = tangential / self.mass, self.ay + normal / self.mass
        self.turning = tangential / (SPHERE_FACTOR * self.mass * self.radius)

    def kick(self):
        self.vx += 0.5 * self.step * self.ax
        self.vy += 0.5 * self.step * self.ay
        self.spin += 0.5 * self.step * self.turning

    def run(self, steps):
        self.evaluate(False)
        for _ in range(steps):
            self.kick()
            self.y += self.step * self.vy
            self.evaluate(True)
            self.kick()
        return self

    def apart(self, velocity, spin):
        """Relative difference from the recorded numbers."""
        return max(abs(self.vx / NUMBERS[velocity].value - 1), abs(-self.spin / NUMBERS[spin].value - 1))


def lammps(_quick):
    progress, findings = Progress("programs of LAMMPS:"), Findings("lammps")

    def recorded(name, ours, why=""):
        findings.compare(name, name, (ours, 0), WHY.get(why, ""), THEIR_TOLERANCE * abs(NUMBERS[name].value))

    def kept(why, *names):
        for name in names:
            recorded(name, stored(name)[0], why)

    kept("", "dem01, Hooke, 2-D: speed after 947 steps", "dem01, Hooke, 2-D: place after 947 steps",
         "dem01, Hooke, e = 0.8: speed after 2068 steps, m/s")
    modulus = 7e10 / (2 * (1 - 0.33**2))
    tsuji = Scene([sphere(0.0025, 2700, (x, 0), (v, 0)) for x, v in ((-0.00255, 2), (0.00255, -2))], "hertz_dashpot",
                  {"stiffness": 4 / 3 * modulus * math.sqrt(0.00125), "restitution": 0.5})
    recorded("dem01, Hertz with Tsuji's dashpot, e = 0.5: speed after 4100 steps, m/s",
             -tsuji.after(1e-8, 4100).velocities[0, 0], "polynomial")
    # Their k of F = k sqrt(R*) d^(3/2), without R*.
    meeting = Scene([sphere(0.01, 2800, (x, 0), (v, 0)) for x, v in ((-0.0101, 10), (0.0101, -10))], "hertz_dashpot",
                    {"stiffness": 3.33333e10 * math.sqrt(0.005), "restitution": 1.0})
    recorded("dem02, Hertz, two spheres: place after 1508 steps, m", -meeting.after(2e-8, 1508).positions[0, 0])
    recorded("dem02, Hertz, two spheres: speed after 2508 steps, m/s", -meeting.after(2e-8, 2508).velocities[0, 0])
    falling = Scene([sphere(0.0025, 7000, (0, 0.00255), (0, -3.9))], "hertz_dashpot",
                    {"stiffness": 7.11111e10 * math.sqrt(0.0025), "restitution": 1.0}, [FLOOR])
    recorded("dem03, Hertz, wall: place after 2138 steps, m", falling.after(1e-8, 2138).positions[0, 1])
    recorded("dem03, Hertz, wall: speed after 3038 steps, m/s", falling.after(1e-8, 3038).velocities[0, 1])
    progress.update(0.2)
    # Their x, z and spin about y are our x, y and minus the spin.
    log_e, mass = math.log(0.98), TheirSphere.mass  # e = exp(-pi zeta/sqrt(1 - zeta²))
    zeta = -log_e / math.hypot(math.pi, log_e)
    oblique, grazing, apart = "dem04, oblique impact on a wall", "dem04, grazing impact, classic model", []
    for name, sphere_, parts in (
            (oblique, TheirSphere(2e7, 5.7e6, 0.092, 1e-8, 0.00255, (2.5069, -2.9876), cN=2 * zeta * math.sqrt(mass * 2e7)),
             (1724, 1133)),
            (grazing, TheirSphere(2e7, 2 / 7 * 2e7, 0.5, 1e-8, 0.00255, (3.7839, -0.94345), cN=mass * 4300,
                                  cT=0.5 * mass * 4300), (5400, 1000))):
        kept("attraction", f"{name}: tangential velocity, m/s")
        kept("segments", f"{name}: normal velocity, m/s")
        kept("attraction", f"{name}: spin, rad/s")
        for steps in parts:
            sphere_.run(steps)
        apart.append(sphere_.apart(f"{name}: tangential velocity, m/s", f"{name}: spin, rad/s"))
    rolling = Scene([sphere(0.0025, 2700, (0, 0.002499982), (1.4, 0))], "linear_dashpot",
                    {"stiffness": 1e4, "restitution": 1.0, "friction": 0.4, "tangential_ratio": 0.28}, [FLOOR], gravity=1.0)
    for at, steps in (("0.4 s", 40000), ("1 s", 100000)):
        run = rolling.after(1e-5, steps)
        recorded(f"dem05, sliding to rolling: velocity at {at}, m/s", run.velocities[0, 0], "first step")
        recorded(f"dem05, sliding to rolling: spin at {at}, rad/s", -run.spins[0], "first step")
    apart.append(TheirSphere(1e4, 2.8e3, 0.4, 1e-5, 0.002499982, (1.4, 0), gravity=1.0).run(40000).apart(
        "dem05, sliding to rolling: velocity at 0.4 s, m/s", "dem05, sliding to rolling: spin at 0.4 s, rad/s"))
    progress.update(0.7)
    kept("attraction", "dem06, spinning sphere: tangential velocity, m/s")
    kept("segments", "dem06, spinning sphere: normal velocity, m/s")
    kept("attraction", "dem06, spinning sphere: spin, rad/s")
    lid, stiff = {"name": "lid", "point": [0.0, 0.0018], "normal": [0.0, -1.0]}, {"stiffness": 1e3, "restitution": 1.0}
    run = Scene([sphere(0.0005, 1e4, (0, y)) for y in (0.00045, 0.00135)], "linear_dashpot", stiff, [FLOOR, lid],
                gravity=9.81).after(2e-6, 1000)
    recorded("dem10, compressed stack: lower place after 1000 steps, m", run.positions[0, 1])
    recorded("dem10, compressed stack: upper place after 1000 steps, m", run.positions[1, 1])
    recorded("dem10, compressed stack: lower velocity after 1000 steps, m/s", run.velocities[0, 1])
    alone = Scene([sphere(0.0005, 1e4, (0, 1.0))], "linear_dashpot", stiff, [FLOOR], gravity=9.81)
    findings.formula("dem10, free fall: place after 0.1 s, m", 1 - 0.5 * 9.81 * 0.01, "LAMMPS 2026",
                     step_error(*(alone.after(step, steps).positions[0, 1] for step, steps in ((1e-4, 1000), (5e-5, 2000)))))
    # The closed forms of two programs whose recorded numbers could not be had, with numbers of our own.
    e, radius, normal, tangential, mu, k = 0.7, 0.0025, 2.0, 3.0, 0.1, 1e10
    wall = Scene([sphere(radius, 2700, (0, radius), (0, -normal))], "linear_dashpot", {"stiffness": k, "restitution": e}, [FLOOR])
    duration = math.pi * math.sqrt(wall.reduced_mass / k)
    findings.formula("dem11, region wall: speed after, e = 0.7, m/s", e * normal, "LAMMPS 2026",
                     step_error(*(wall.collide(share * duration)[0][0, 1] for share in (1e-3, 5e-4, 2.5e-4))))
    # Two spheres that slide throughout: the closed form keeps the normal; in a contact of finite duration it turns.
    turned, change = 2 * tangential * duration / (2 * radius), mu * (1 + e) * normal
    for what, formula in (("spin after, rad/s", -2.5 * change / radius), ("tangential velocity after, m/s", tangential - change)):
        name = f"dem15, oblique impact of two spheres: {what}"
        findings.formula(name, formula, "LAMMPS 2026", stored(name), allowance=turned * abs(formula))
    progress.end()
    findings.trend("with LAMMPS's two rules a plain loop repeats the recorded velocities and spins of dem04 and dem05",
                   "LAMMPS 2026", max(apart) < THEIR_TOLERANCE, f"to {max(apart):.1e} of their size")
    return findings
