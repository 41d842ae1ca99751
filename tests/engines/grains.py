# SPDX-License-Identifier: GPL-3.0-or-later
"""Colliding discs: the exported box in its engine against equidem."""
import numpy as np

import engines
from engines import Model

STIFFNESS = 1e6  # N/m²
WALLS = '''
[[wall]]
name = "floor"
point = [0.0, 0.0]
normal = [0.0, 1.0]
[[wall]]
name = "left"
point = [0.0, 0.0]
normal = [1.0, 0.0]
[[wall]]
name = "right"
point = [0.0602, 0.0]
normal = [-1.0, 0.0]
'''
BOX = '''
[grains]
path = "discs.csv"
density = 2500.0
[collisions]
law = "linear_dashpot"
stiffness = 1e6
restitution = {restitution}
friction = {friction}
tangential_ratio = 0.5
{further}
[run]
duration = {duration}
time_step = {time_step}
integrator = "velocity_verlet"
gravity = [0.0, -9.81]
{walls}
'''


def box_case(**settings):
    return BOX.format(**{"further": "", "time_step": 5e-5, "walls": WALLS, **settings})


def discs(path, radii):
    """Rows of four discs, each row shifted against the one below, above one another without contact."""
    with open(path, "w") as file:
        file.write("x,y,radius,vx,vy,spin\n")
        for k, radius in enumerate(radii):
            row, column = divmod(k, 4)
            x = 0.0075 + 0.015 * column + (0.00005 if row % 2 else 0.0)
            file.write(f"{x},{0.0076 + 0.0152 * row},{radius},{0.01 * (-1)**k},0,0\n")


class Box:
    """Twenty discs that fall in a box, stepped by equidem."""

    def __init__(self, program, folder, radii, **settings):
        discs(folder / "discs.csv", radii)
        case = box_case(**{"friction": 0.3, "restitution": 0.4, **settings})
        self.model = Model(program, folder, case)
        self.out = self.model.equidem("run", "run")
        self.end = engines.columns(self.out / "grains.csv", "x_m", "y_m", "angle_rad", "vx_m_per_s", "vy_m_per_s",
                                   "spin_rad_per_s")


EQUAL = [0.0075] * 20
GRADED = [0.0060 + 0.0015 * ((7 * k) % 20) / 19 for k in range(20)]


def end_in(engine, model):
    """Places, velocities and spins of the bodies of the exported model at its end; engine: lammps, newer_lammps or yade."""
    out = model.export("yade" if engine == "yade" else "lammps", "--accept", "friction")
    if engine == "yade":
        engines.run_yade(engines.yade(), out)
        end = np.loadtxt(out / "end.txt", ndmin=2)
        return end[:, :2], end[:, 5:7], end[:, 7]
    engines.run_lammps(engines.lammps() if engine == "lammps" else engines.lammps_with_bonds(), out)
    end = engines.dump(out / "end.dump")
    return np.stack([end["xu"], end["yu"]], 1), np.stack([end["vx"], end["vy"]], 1), end.get("omegaz")


#: The left wall pushes the discs: from the first step on; at a constant speed; along a smooth ramp; to and fro.
PISTONS = {
    "start": 'kind = "table"\ntimes = [0.0, 0.06]\nvalues = [0.0, 1.0]',
    "speed": 'kind = "table"\ntimes = [0.02, 0.08]\nvalues = [-0.02, 1.0]',
    "ramp": 'kind = "ramp"\nstart = 0.01\nend = 0.09',
    "sine": 'kind = "sine"\nstart = 0.02\nfrequency = 15.0',
}


def piston(kind):
    """The box of BOX whose left wall moves by up to 6 mm."""
    moving = 'name = "left"\ndisplacement = 6e-3\ndirection = [1.0, 0.0]\nschedule = "push"'
    return {"walls": WALLS.replace('name = "left"', moving) + f'[[schedule]]\nname = "push"\n{PISTONS[kind]}\n'}


def motion(engine, *cases, radii=EQUAL, way=0.5 * 9.81 * 0.1**2):
    """A check: places after impacts relative to a way, that fallen in a tenth of a second; the largest of the cases, each with settings
    of its own beside 0.1 s without friction."""
    def check(program, folder):
        values = []
        for number, settings in enumerate(cases or ({},)):
            (folder / str(number)).mkdir()
            box = Box(program, folder / str(number), radii, **{"duration": 0.1, "friction": 0.0, **settings})
            values.append(float(np.max(np.abs(end_in(engine, box.model)[0] - box.end[:, :2])) / way))
        return max(values)
    return check


#: At a constant speed of the wall both make the same steps. Along curves its speed, which acts on the dashpots, is a difference over a
#: step in LAMMPS. Without dashpots YADE makes the steps of equidem.
STEADY = {"duration": 0.05, **piston("speed")}
CURVED = [{"duration": 0.05, "time_step": 5e-6, **piston(kind)} for kind in ("ramp", "sine")]
LOSSLESS = [{"duration": duration, "restitution": 1.0, "time_step": 2e-6, **piston(kind)}
            for kind, duration in (("start", 0.04), ("speed", 0.04), ("ramp", 0.04), ("sine", 0.025))]


class Sliding:
    """A disc at rest on the floor, pressed in by its weight, gets a speed along it and slides until it rolls; with spin, the
    speed of its rim, it rolls from the start."""

    def __init__(self, program, folder, spin=0.0, further=""):
        pressed = 2500 * np.pi * 0.0075**2 * 9.81 / STIFFNESS
        (folder / "discs.csv").write_text(f"x,y,radius,vx,vy,spin\n0.01,{0.0075 - pressed!r},0.0075,0.2,0,{-spin / 0.0075!r}\n")
        case = box_case(restitution=1.0, friction=0.3, duration=0.03, time_step=2e-6, further=further)
        self.model = Model(program, folder, case)
        table = self.model.equidem("run", "run") / "grains.csv"
        self.end = engines.columns(table, "vx_m_per_s", "spin_rad_per_s")[0]

    def difference(self, speed, spin):
        """Relative to the first speed."""
        return float(max(abs(speed - self.end[0]), 0.0075 * abs(spin - self.end[1])) / 0.2)


def sliding(engine, spin=0.0, further="", slowed=(0.0, 1.0)):
    """A check; `slowed`: the least and the most that it loses of its speed."""
    def check(program, folder):
        disc = Sliding(program, folder, spin, further)
        lost = 1 - disc.end[0] / 0.2
        if not slowed[0] < lost < slowed[1]:
            raise engines.Failed(f"the disc lost {lost:.2g} of its speed")
        _, velocities, spins = end_in(engine, disc.model)
        return disc.difference(velocities[0, 0], spins[0])
    return check


#: Rolling friction slows it, by spring, dashpot and limit.
ROLLING = {"spin": 0.2, "further": "rolling_friction = 0.2\nrolling_ratio = 0.3\nrolling_damping = 0.3", "slowed": (0.01, 0.9)}


def overlaps(places, radii):
    """Overlap of each pair of discs that touch and of discs with the floor, m."""
    found = {}
    for i, (place, radius) in enumerate(zip(places, radii)):
        for wall, distance in (("floor", place[1]), ("left", place[0]), ("right", 0.0602 - place[0])):
            if radius > distance:
                found[i, wall] = radius - distance
        for j in range(i + 1, len(places)):
            overlap = radius + radii[j] - np.hypot(*(places[j] - place))
            if overlap > 0:
                found[i, j] = overlap
    return found


def settled_difference(places, expected_places, radii):
    """Largest difference of an overlap, and so of a normal force, relative to the largest; 1 where other discs touch.
    Contacts of less than a millionth of it do not count."""
    found, expected = overlaps(places, radii), overlaps(expected_places, radii)
    largest = max(expected.values())
    return max(abs(found.get(pair, 0.0) - expected.get(pair, 0.0)) for pair in {*found, *expected}) / largest


def lammps_settled(friction):
    """A check: both settle from the same start. With friction the levers of LAMMPS are the radii, those of equidem add up to the
    distance of the centres, so that moments differ by overlap over diameter, here 1e-3; which contacts slide decides the rest."""
    def check(program, folder):
        box = Box(program, folder, EQUAL, duration=1.5, friction=friction)
        return settled_difference(end_in("lammps", box.model)[0], box.end[:, :2], EQUAL)
    return check


def yade_settled(program, folder):
    """A box that equidem has settled: forces of all contacts in the first step."""
    Box(program, folder, GRADED, duration=1.5, friction=0.0)
    again = Model(program, folder, box_case(restitution=1.0, friction=0.0, duration=5e-5)
                  .replace("discs.csv", "run/grains.csv"), "settled")
    out = again.export("yade")
    engines.run_yade(engines.yade(), out)
    walls = {20 + k: name for k, name in enumerate(("floor", "left", "right"))}
    found = {}
    for row in np.loadtxt(out / "end_contacts.txt"):
        i, j = sorted((int(row[0]), int(row[1])))
        found[i, walls.get(j, j)] = float(np.hypot(row[3], row[4]))
    places = engines.columns(again.folder / "run" / "grains.csv", "x_m", "y_m")
    expected = {pair: STIFFNESS * overlap for pair, overlap in overlaps(places, GRADED).items()}
    largest = max(expected.values())
    return max(abs(found.get(pair, 0.0) - expected.get(pair, 0.0)) for pair in {*found, *expected}) / largest
