# SPDX-License-Identifier: GPL-3.0-or-later
"""Bonded discs: the exported model in its engine against equidem."""
import json
import math

import numpy as np

import engines
from engines import Model

KN, KT, DENSITY = 1e9, 0.3e9, 2500
NETWORK = f'''
[assembly]
kind = "delaunay"
discs = 60
radius = 0.005
seed = 3
density = {DENSITY}
[springs]
kN = {KN}
kT = {KT}
'''
FREE = NETWORK + "[run]\nduration = 1e-4\n"
WEIGHTED = NETWORK + 'weighting = "voronoi"\n'
TENSION = WEIGHTED + '[test]\nkind = "uniaxial_tension"\nstress = {stress}\n'
SHEAR = WEIGHTED + '''
[[support]]
group = "bottom"
ux = 0.0
uy = 0.0
rotation = 0.0
[[support]]
group = "top"
ux = {ux}
rotation = {turn}
[[load]]
group = "right"
force = [0.0, {force}]
kind = "total"
'''
RESTRAINED = '[effects]\nrotation = "restrained"\n'


class Displaced:
    """The network with every disc moved at random by about `size` of the spacing, and the forces of the linear law."""

    def __init__(self, program, folder, size, further=""):
        self.model = Model(program, folder, FREE + further)
        solved = Model(program, folder, TENSION.format(stress=1.0).replace('weighting = "voronoi"\n', ""), "solved")
        out = solved.equidem("solve", "solved")
        self.places = engines.columns(out / "discs.csv", "x_m", "y_m")
        ends = engines.columns(out / "contacts.csv", "i", "j").astype(int)
        geometry = engines.columns(out / "contacts.csv", "branch_x_m", "branch_y_m", "lever_i_m", "lever_j_m")
        random = np.random.default_rng(1)
        self.moved = size * 0.01 * random.standard_normal((len(self.places), 2))
        self.turned = size * random.standard_normal(len(self.places))
        self.forces = np.zeros((len(self.places), 3))
        self.components = []  # of each contact, normal (tension positive) and tangential
        for (i, j), (x, y, lever_i, lever_j) in zip(ends, geometry):
            along = np.array([x, y]) / math.hypot(x, y)
            across = np.array([-along[1], along[0]])
            apart = self.moved[j] - self.moved[i]
            slip = apart @ across - lever_i * self.turned[i] - lever_j * self.turned[j]
            self.components.append((KN * (apart @ along), KT * slip))
            force = KN * (apart @ along) * along + KT * slip * across
            self.forces[i] += [*force, lever_i * KT * slip]
            self.forces[j] += [*-force, lever_j * KT * slip]


def worst(forces, expected):
    """Of forces and of moments, each relative to the largest."""
    return max(engines.relative(forces[:, :2], expected[:, :2]), engines.relative(forces[:, 2], expected[:, 2]))


def lammps_forces(program, folder):
    """The part of the forces that is odd in the motion: the law is linear, the effect of finite motion is not."""
    lammps = engines.lammps_with_bonds()
    state = Displaced(program, folder, 2e-4)
    out = state.model.export("lammps")
    script = engines.head_of(out / "in.equidem")
    for name, sign in (("plus", 1), ("minus", -1)):
        for disc, (place, moved, turned) in enumerate(zip(state.places, state.moved, state.turned)):
            x, y = place + sign * moved
            script += f"set atom {disc + 1} x {x!r} y {y!r} quat 0 0 1 {math.degrees(sign * turned)!r}\n"
        script += f"run 0\nwrite_dump all custom {name}.dump id fx fy tqz modify format float %.17g sort id\n"
    (out / "forces.in").write_text(script)
    engines.run_lammps(lammps, out, "forces.in")
    plus, minus = (np.stack([engines.dump(out / f"{name}.dump")[key] for key in ("fx", "fy", "tqz")], 1)
                   for name in ("plus", "minus"))
    return worst((plus - minus) / 2, state.forces)


def lammps_strengths(program, folder):
    """Share of the bonds that LAMMPS breaks otherwise than |T| = shear - friction N with friction = shear/tension, of discs displaced so
    that about half of them break; bonds within 1 % of the limit do not count, since the motion is finite."""
    lammps = engines.lammps_with_bonds()
    size, tension = 2e-4, 1e3
    state = Displaced(program, folder, size, f"[strength]\ntension = {tension}\nshear = {1.5 * tension}\nfriction = 1.5\n")
    normal, tangential = np.array(state.components).T
    use = normal / tension + np.abs(tangential) / (1.5 * tension)
    out = state.model.export("lammps")
    script = engines.head_of(out / "in.equidem")
    for disc, (place, moved, turned) in enumerate(zip(state.places, state.moved, state.turned)):
        x, y = place + moved
        script += f"set atom {disc + 1} x {x!r} y {y!r} quat 0 0 1 {math.degrees(turned)!r}\n"
    script += ("compute left all property/local btype batom1 batom2\nrun 1\n"
               "dump left all local 1 left.dump c_left[1] c_left[2] c_left[3]\nrun 0\n")
    (out / "strengths.in").write_text(script)
    engines.run_lammps(lammps, out, "strengths.in")
    rows = (out / "left.dump").read_text().split("ITEM: ENTRIES")[-1].splitlines()[1:]
    left = {tuple(sorted(int(float(word)) - 1 for word in row.split()[1:3])) for row in rows}
    ends = [tuple(sorted(pair)) for pair in engines.columns(folder / "solved" / "contacts.csv", "i", "j").astype(int)]
    counted = np.abs(use - 1) > 0.01
    broken = np.array([pair not in left for pair in ends])
    if not 0.2 < np.mean(use >= 1) < 0.8:
        raise engines.Failed(f"{np.mean(use >= 1):.0%} of the bonds are to break: no test of strengths")
    return float(np.mean((broken != (use >= 1))[counted]))


def yade_forces(program, folder):
    yade = engines.yade()
    state = Displaced(program, folder, 1e-4)
    out = state.model.export("yade")
    np.savetxt(out / "moved.txt", np.column_stack([state.moved, state.turned]), fmt="%.17g")
    head = engines.head_of(out / "run_equidem.py")
    script = "".join(head + f'''
for body, line in zip(O.bodies, open("moved.txt")):
    x, y, turned = ({sign} * float(word) for word in line.split())
    body.state.blockedDOFs = "xyzXYZ"
    body.state.pos += Vector3(x, y, 0)
    body.state.ori = Quaternion((0, 0, 1), turned)
    body.state.vel, body.state.angVel = (x / O.dt, y / O.dt, 0), (0, 0, turned / O.dt)
O.step()
with open("{name}", "w") as file:
    for body in O.bodies:
        force = O.forces.f(body.id)
        file.write("%.17g %.17g %.17g\\n" % (force[0], force[1], O.forces.t(body.id)[2]))
O.reset()
''' for sign, name in ((1, "plus.txt"), (-1, "minus.txt")))
    (out / "forces.py").write_text(script)
    engines.run_yade(yade, out, "forces.py")
    return worst((np.loadtxt(out / "plus.txt") - np.loadtxt(out / "minus.txt")) / 2, state.forces)


def motions_in(engine, model, places):
    """Displacements and rotations of the exported model at its end."""
    out = model.export(engine)
    if engine == "yade":
        engines.run_yade(engines.yade(), out)
        end = np.loadtxt(out / "end.txt")
        return end[:, 3:5], end[:, 2]
    engines.run_lammps(engines.lammps_with_bonds(), out)
    end = engines.dump(out / "end.dump")
    turned = 2 * np.arctan2(end["c_turn[2]"], end["c_turn[1]"]) if "c_turn[2]" in end else None
    return np.stack([end["xu"], end["yu"]], 1) - places, turned


def rest(engine, program, folder, case):
    """Displacements and rotations at rest in the engine beside those of `equidem solve`."""
    model = Model(program, folder, case)
    table = model.equidem("solve", "solved") / "discs.csv"
    expected = engines.columns(table, "ux_m", "uy_m", "rotation_rad")
    return motions_in(engine, model, engines.columns(table, "x_m", "y_m")), (expected[:, :2], expected[:, 2])


def run_difference(engine, *cases):
    """A check: displacements after a run in the engine and in equidem, relative to the largest; the largest of the cases."""
    def check(program, folder):
        values = []
        for number, case in enumerate(cases):
            (folder / str(number)).mkdir()
            model = Model(program, folder / str(number), case)
            table = model.equidem("run", "run") / "discs.csv"
            moved, _ = motions_in(engine, model, engines.columns(table, "x_m", "y_m"))
            values.append(engines.relative(moved, engines.columns(table, "ux_m", "uy_m")))
        return max(values)
    return check


def odd_part(engine, case_of, prepare=lambda folder: None):
    """A check: half the difference of the motions under loads of both signs, relative to that of equidem: the part of first order
    in the motion, which is all of it in equidem."""
    def check(program, folder):
        parts = []
        prepare(folder)
        for sign in (1, -1):
            (folder / str(sign)).mkdir()
            parts.append(rest(engine, program, folder / str(sign), case_of(sign)))
        return max(engines.relative((parts[0][0][k] - parts[1][0][k]) / 2, parts[0][1][k]) for k in range(len(parts[0][1]))
                   if np.any(parts[0][1][k]))
    return check


def tension(sign):
    return TENSION.format(stress=sign * 1e5)


def shear(sign):
    return SHEAR.format(ux=sign * 2e-6, turn=sign * 3e-4, force=sign * 2e3)


def shear_with_moments(sign):
    return shear(sign) + f"moment = {sign * 30.0}\n"


def restrained(sign):
    return RESTRAINED + tension(sign)


def lammps_shrinking(program, folder):
    """The error at a strain of about 1e-5 as it is; at a tenth of it LAMMPS's own rounding is as large."""
    moved, expected = rest("lammps", program, folder, TENSION.format(stress=1e4))
    return engines.relative(moved[0], expected[0])


def rows_file(folder):
    """Discs of two radii that touch: the contact points are off the middle."""
    (folder / "rows.json").write_text(rows_of_two_radii(10, 4))


def pulled_rows(sign):
    return f'''
[assembly]
kind = "file"
path = "../rows.json"
[springs]
kN = 1e9
kT = 0.3e9
[[support]]
group = "foot"
ux = 0.0
uy = 0.0
[[load]]
group = "head"
force = [{sign * 60}, {sign * 20}]
'''


def rows_of_two_radii(columns, lines):
    """A square arrangement of alternating discs of 2 and 1 mm, braced along one diagonal, with levers that are the
    radii along the rows and columns."""
    large, small = 0.002, 0.001
    discs, contacts, levers = [], [], []
    for line in range(lines):
        for column in range(columns):
            radius = large if (line + column) % 2 == 0 else small
            discs.append((column * (large + small), line * (large + small), radius))

    def join(i, j):
        length = math.dist(discs[i][:2], discs[j][:2])
        contacts.append([i, j, 0, 0])
        first = (length + discs[i][2] - discs[j][2]) / 2
        levers.append([first, length - first])

    for line in range(lines):
        for column in range(columns):
            k = line * columns + column
            if column + 1 < columns:
                join(k, k + 1)
            if line + 1 < lines:
                join(k, k + columns)
            if column + 1 < columns and line + 1 < lines:
                join(k, k + columns + 1)
    return json.dumps({"schema": "equidem-assembly/1", "discs": discs, "contacts": contacts, "levers": levers,
                       "groups": {"foot": [line * columns for line in range(lines)],
                                  "head": [line * columns + columns - 1 for line in range(lines)]}})


#: Loads and gravity that set the network in motion from rest.
SET_IN_MOTION = NETWORK + '''
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
duration = 1e-4
time_step = 4e-7
gravity = [300.0, -700.0]
'''


#: A block above a wall of springs, which the lowest discs touch at y = -6.698729810778e-4.
BLOCK_ON_WALL = '''
[assembly]
kind = "hexagonal"
columns = 6
rows = 6
radius = 0.005
density = 2500.0
[springs]
kN = 1e9
kT = 0.3e9
[[wall]]
name = "floor"
normal = [0.0, 1.0]
kN = 1e9
{wall}
[run]
duration = 5e-4
damping = {{ local = 0.05 }}
{run}
'''


#: A block that falls on a wall and rebounds; its gravity and speed keep strains near 1e-4.
FALLING = BLOCK_ON_WALL.format(wall="point = [0.0, -6.7e-4]", run='''gravity = [0.0, -9.81]
[[velocity]]
group = "all"
velocity = [0.0, -0.05]
[[group]]
name = "all"
box = [-1.0, -1.0, 1.0, 1.0]
''')
#: A wall of springs that moves into a block along a ramp.
PUSHED = BLOCK_ON_WALL.format(run="", wall='''point = [0.0, -6.698729810778e-4]
displacement = 1.0e-5
direction = [0.0, 1.0]
schedule = "slowly"
[[schedule]]
name = "slowly"
kind = "ramp"
end = 4.0e-4
''')
