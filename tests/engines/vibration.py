# SPDX-License-Identifier: GPL-3.0-or-later
"""The period of the lowest mode of bonded discs: in the engine against `equidem stability`."""
import math
import re

import numpy as np

import engines
from bonds import NETWORK
from engines import Model

VIBRATION = NETWORK + '''
[[support]]
group = "bottom"
ux = 0.0
uy = 0.0
rotation = 0.0
'''
PERIODS = 4


class Mode:
    """The lowest mode of the network, held at its bottom, by the masses and bonds of the exported script of YADE; its
    frequency is that of `equidem stability`."""

    def __init__(self, program, folder):
        held = Model(program, folder, VIBRATION, "frequency")
        frequency = held.equidem("stability", "stability", "--frequencies", "1")
        self.omega = 2 * math.pi * engines.result_of(frequency)["natural_frequencies"][0]
        self.model = Model(program, folder, VIBRATION + f"[run]\nduration = {PERIODS * 2.2 * math.pi / self.omega}\n")
        script = (self.model.export("yade") / "run_equidem.py").read_text()
        bodies = re.search(r'BODIES = """\n(.*?)"""', script, re.S).group(1).splitlines()
        bonds = re.search(r'BONDS = """\n(.*?)"""', script, re.S).group(1).splitlines()
        self.step = float(re.search(r"O.dt = (\S+)", script).group(1))
        place = np.array([[float(word) for word in line.split()[:2]] for line in bodies])
        mass = np.array([[float(line.split()[k]) for k in (3, 3, 4)] for line in bodies]).ravel()
        free = np.array([word == "-" for line in bodies for word in line.split()[12:15]])
        stiffness = np.zeros((len(mass), len(mass)))
        for line in bonds:
            i, j, kn, ks = (float(word) for word in line.split()[:4])
            i, j = int(i), int(j)
            branch = place[j] - place[i]
            length = math.hypot(*branch)
            n, lever = branch / length, length / 2
            for k, row in ((kn, [-n[0], -n[1], 0, n[0], n[1], 0]), (ks, [n[1], -n[0], -lever, -n[1], n[0], -lever])):
                at = [*range(3 * i, 3 * i + 3), *range(3 * j, 3 * j + 3)]
                stiffness[np.ix_(at, at)] += k * np.outer(row, row)
        root = np.sqrt(mass[free])
        squares, shapes = np.linalg.eigh(stiffness[np.ix_(free, free)] / np.outer(root, root))
        self.weights = np.zeros(len(mass))  # the projection of a motion on the mode
        self.weights[free] = shapes[:, 0] * root
        self.shape = np.zeros(len(mass))
        self.shape[free] = shapes[:, 0] / root
        self.shape /= np.max(np.abs(self.shape))
        self.frequency_error = abs(math.sqrt(squares[0]) / self.omega - 1)

    def period_error(self, times, motions):
        """Of the mean period between the rising zeros of the mode's share in the motions (n, 3 discs); the step of
        leapfrog shortens a period by (omega h)²/24, which is taken out."""
        share = motions @ self.weights
        at = np.nonzero((share[:-1] < 0) & (share[1:] >= 0))[0]  # rising
        zeros = times[at] - share[at] * (times[at + 1] - times[at]) / (share[at + 1] - share[at])
        period = (zeros[-1] - zeros[0]) / (len(zeros) - 1)
        return max(abs(period * self.omega / (2 * math.pi) * (1 + (self.omega * self.step)**2 / 24) - 1),
                   self.frequency_error)


def yade_period(program, folder):
    yade = engines.yade()
    mode = Mode(program, folder)
    out = mode.model.folder / "case_yade"
    np.savetxt(out / "speeds.txt", 1e-4 * mode.omega * mode.shape.reshape(-1, 3), fmt="%.17g")
    script = engines.head_of(out / "run_equidem.py") + '''
O.step()
for body, line in zip(O.bodies, open("speeds.txt")):
    x, y, turning = map(float, line.split())
    state = body.state
    state.pos += O.dt * Vector3(x, y, 0)
    state.ori = Quaternion((0, 0, 1), O.dt * turning)
    state.vel, state.angVel = (x, y, 0), (0, 0, turning)
with open("motions.txt", "w") as file:
    while O.iter < STEPS:
        O.run(10, True)
        numbers = [number for body in O.bodies for number in (body.state.displ()[0], body.state.displ()[1],
                                                              body.state.rot()[2])]
        file.write(" ".join("%.12g" % number for number in [O.iter * O.dt, *numbers]) + "\\n")
'''
    (out / "period.py").write_text(script)
    engines.run_yade(yade, out, "period.py")
    table = np.loadtxt(out / "motions.txt")
    return mode.period_error(table[:, 0], table[:, 1:])


def lammps_period(program, folder):
    lammps = engines.lammps_with_bonds()
    mode = Mode(program, folder)
    out = mode.model.export("lammps")
    script = engines.head_of(out / "in.equidem")
    for disc, (x, y, turning) in enumerate(1e-4 * mode.omega * mode.shape.reshape(-1, 3)):
        script += f"set atom {disc + 1} vx {x!r} vy {y!r} omega 0 0 {turning!r}\n"
    script += "dump motions all custom 10 motions.dump id x y c_turn[1] c_turn[2]\n"
    script += "dump_modify motions format float %.17g sort id\n"
    script += f"run {math.ceil(PERIODS * 2.2 * math.pi / mode.omega / mode.step)}\n"
    (out / "period.in").write_text(script)
    engines.run_lammps(lammps, out, "period.in")
    states = (out / "motions.dump").read_text().split("ITEM: TIMESTEP\n")[1:]
    times = np.array([int(state.split("\n", 1)[0]) for state in states]) * mode.step
    tables = np.array([[[float(word) for word in line.split()[1:]]
                        for line in state.split("ITEM: ATOMS")[1].splitlines()[1:]] for state in states])
    moved = tables[:, :, :2] - tables[0, :, :2]
    turned = 2 * np.arctan2(tables[:, :, 3], tables[:, :, 2])
    return mode.period_error(times, np.concatenate([moved, turned[:, :, None]], 2).reshape(len(states), -1))
