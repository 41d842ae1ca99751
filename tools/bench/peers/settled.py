# SPDX-License-Identifier: GPL-3.0-or-later
"""A settled box of discs with friction: steps of discs per second in LAMMPS, YADE and equidem, on one core and on two."""

import json
import math
import random
import re
import tempfile
from pathlib import Path

from common import call, median, number, result_of, spread, table, tell

HERE = Path(__file__).resolve().parent
SPACING = 0.0205  # m, of the grid they fall from
STIFFNESS, MASS = 1e5, 2.2e-3  # N/m, and the reduced mass of two discs of the mean radius, kg
DASHPOT = (4000.0, 2000.0)  # 1/s, times the mass: normal, tangential
STEP = 1.5e-5  # s
SKINS = (0.0005, 0.001, 0.002)  # m, LAMMPS: the best counts
CORES = (1, 2)


def loose_grid(columns, rows, file):
    """Discs of 0.5 to 1 cm as a LAMMPS data file; the width of the box, m."""
    generator = random.Random(7)
    lines = []
    for row in range(rows):
        for column in range(columns):
            radius = generator.uniform(0.005, 0.010)
            room = 0.0100 - radius
            x = (column + 0.5) * SPACING + generator.uniform(-room, room)
            y = (row + 0.5) * SPACING + generator.uniform(-room, room)
            lines.append(f"{len(lines) + 1} 1 {2 * radius:.9f} 2500 {x:.9f} {y:.9f} 0")
    width = columns * SPACING
    head = f"discs\n\n{len(lines)} atoms\n1 atom types\n\n-0.001 {width + 0.001} xlo xhi\n-0.001 {rows * SPACING * 1.2} ylo yhi\n-0.01 0.01 zlo zhi\n"
    file.write_text(head + "\nAtoms # sphere\n\n" + "\n".join(lines) + "\n")
    return width


def case_of(dump, width, angle, steps, folder):
    """The dump of LAMMPS as a case of equidem: linear spring, dashpot, tangential spring capped by friction."""
    lines = dump.read_text().splitlines()
    head = next(k for k, line in enumerate(lines) if line.startswith("ITEM: ATOMS"))
    columns = lines[head].split()[2:]
    discs = [dict(zip(columns, line.split())) for line in lines[head + 1 :] if line.strip()]
    rows = [f"{d['x']},{d['y']},{float(d['diameter']) / 2!r},{d['vx']},{d['vy']},{d['omegaz']}" for d in discs]
    (folder / "discs.csv").write_text("x,y,radius,vx,vy,spin\n" + "\n".join(rows) + "\n")
    zeta = DASHPOT[0] * MASS / (2 * math.sqrt(STIFFNESS * MASS))
    restitution = math.exp(-math.pi * zeta / math.sqrt(1 - zeta * zeta))
    tangential = DASHPOT[1] * MASS / (2 * math.sqrt(MASS / 3 * 0.8 * STIFFNESS))
    gravity = (9.81 * math.sin(math.radians(angle)), -9.81 * math.cos(math.radians(angle)))
    file = folder / "settled.toml"
    file.write_text(f"""schema = "equidem/1"
[grains]
path = "discs.csv"
density = 25.0
[collisions]
law = "linear_dashpot"
restitution = {restitution!r}
stiffness = {STIFFNESS}
friction = 0.5
tangential_ratio = 0.8
tangential_damping = {tangential!r}
[[wall]]
name = "left"
point = [0.0, 0.0]
normal = [1.0, 0.0]
[[wall]]
name = "right"
point = [{width!r}, 0.0]
normal = [-1.0, 0.0]
[[wall]]
name = "floor"
point = [0.0, 0.0]
normal = [0.0, 1.0]
[run]
duration = {steps * STEP!r}
time_step = {STEP}
gravity = [{gravity[0]!r}, {gravity[1]!r}]
""")
    return file, len(discs)


def lammps(folder, name, width, skin, steps, angle, discs, ranks):
    """Steps of discs per second in three runs."""
    log = folder / "lammps.log"
    several = ["mpirun", "-n", ranks] if ranks > 1 else []
    call([*several, "lmp", "-in", "measure.lammps", "-log", log, "-screen", "none", "-var", "restart", folder / f"{name}.restart", "-var", "W", width,
          "-var", "skin", skin, "-var", "steps", steps, "-var", "angle", angle], folder=HERE,
         OMPI_ALLOW_RUN_AS_ROOT="1", OMPI_ALLOW_RUN_AS_ROOT_CONFIRM="1")
    loops = [float(word) for word in re.findall(r"Loop time of (\S+)", log.read_text())][1:]
    return [discs * steps / loop for loop in loops]


def measure(equidem, width, name, steps, angle, rounds, folder):
    dump = folder / f"{name}.dump"
    file, discs = case_of(dump, width, angle, steps, folder)
    found = {"discs": discs, "angle": angle, "equidem": {cores: [] for cores in CORES},
             "lammps": {cores: {skin: [] for skin in SKINS} for cores in CORES}, "yade": []}
    for _ in range(rounds):
        for cores in CORES:
            result = json.loads(call([equidem, "run", file, "--json", "-", "--quiet", "--threads", cores]))
            found["equidem"][cores].append(result["particle_steps_per_second"])
            for skin in SKINS:
                found["lammps"][cores][skin] += lammps(folder, name, width, skin, steps // 3, angle, discs, cores)
        found["contacts_per_disc"] = result["touching"] / discs
        found["bytes_per_disc"] = result["bytes_per_grain"]
        text = call(["yade", "-n", "-x", "-j1", HERE / "settled_yade.py", dump, width, max(50, steps // 40), angle])
        found["yade"] += result_of(text)["rates"]
    tell(f"settled: {discs} discs, {angle} degrees: equidem {spread(found['equidem'][1])}")
    return found


def compare(equidem, quick, rounds):
    boxes = [(40, 75, 60_000, 9000)] if quick else [(40, 75, 120_000, 30_000), (100, 200, 150_000, 4500)]
    found = []
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        for columns, rows, settling, steps in boxes:
            init = folder / "loose.data"
            width = loose_grid(columns, rows, init)
            call(["lmp", "-in", "settle.lammps", "-log", "none", "-screen", "none", "-var", "init", init, "-var", "W", width, "-var", "steps", settling,
                  "-var", "out", folder / "box"], folder=HERE)
            for angle in (0, 40):
                found.append(measure(equidem, width, "box", steps, angle, rounds, folder))
    return found


def report(found):
    rows = []
    for box in found:
        state = "settled" if box["angle"] == 0 else f"flowing, gravity tilted by {box['angle']} degrees"
        for cores in CORES:
            theirs = max(box["lammps"][cores].values(), key=median)
            ours = median(box["equidem"][cores])
            yade = [spread(box["yade"]), number(ours / median(box["yade"]))] if cores == 1 else ["", ""]
            rows.append([box["discs"], state, cores, spread(box["equidem"][cores]), spread(theirs), yade[0], number(ours / median(theirs)),
                         yade[1], number(box["contacts_per_disc"])])
    head = ["discs", "state", "cores", "equidem", "LAMMPS, best skin", "YADE", "equidem over LAMMPS", "over YADE", "contacts a disc"]
    return (
        "## The same box: discs with friction, steps of discs per second\n\nRadii 0.5 to 1 cm, linear springs and dashpots, tangential springs capped "
        "by friction 0.5, rotation, three walls, settled by LAMMPS; one core, or two: two threads of equidem, two MPI ranks of LAMMPS side by side in x. LAMMPS: "
        "gran/hooke/history, Debian's build. YADE: "
        "Cundall and Strack's law with local damping. equidem: `run`, its histories and checks included.\n\n" + table(head, rows)
    )
