# SPDX-License-Identifier: GPL-3.0-or-later
"""What effects cost: tables and figure of data/effects. Each scene is the one before with something more, timed by the Python module."""
import copy
import math
import random
import statistics

from common import stamp
from tables import rows_of, tables_of, write_rows

DISC_STEPS = 1e6  # of each scene in a timing
R, STIFFNESS, STEP = 0.01, 1e6, 1e-5  # m, N/m, s of the bodies that collide
OVERLAP = 0.002 * R  # of discs that press one another
SCENES = ["problem", "scene", "unknowns per disc", "bytes per disc", "evaluations", "ns per disc-step", "added by the effect",
          "over the plain scene"]
STATICS = ["scene", "unknowns per disc", "entries of the factor per disc", "bytes of the solver per disc", "µs per disc", "over the plain scene",
           "relative residual"]


class Scene:
    """Tables of a case, and the number of its discs."""

    def __init__(self, discs, **tables):
        self.discs, self.tables = discs, tables

    def run(self, eq):
        """Result of about DISC_STEPS/discs steps."""
        tables = copy.deepcopy(self.tables)
        steps = round(DISC_STEPS / self.discs)
        for stage in tables.get("stage", []):
            stage["steps"] = steps // len(tables["stage"])
        if "stage" not in tables:
            tables["run"]["duration"] = steps * tables["run"]["time_step"]
        return eq.Case(**tables).run(threads=1)


def chain(scene, changes):
    """Name and scene: each change is made to the scene before it. What is called "or" has its effect in place of the last
    one, and the next scene does without it."""
    found, before = [], scene
    for name, change in changes:
        made = copy.deepcopy(before if name.startswith("or ") else scene)
        change(made.tables)
        found.append((name, made))
        if not name.startswith("or "):
            before, scene = scene, made
    return found


def all_of(name, **keys):
    return lambda tables: [entry.update(keys) for entry in tables[name]]


def put(name, **keys):
    """Change of some keys of a table, which is made where it does not exist."""
    return lambda tables: tables.setdefault(name, {}).update(keys)


def nothing(_):
    return None


def bonded(side):
    tables = {"assembly": {"kind": "hexagonal", "columns": side, "rows": side, "radius": 0.5, "density": 1.0},
              "springs": (1.0, 0.0), "run": {"time_step": 0.05}}
    return chain(Scene(side * side, **tables), [
        ("normal springs", nothing),
        ("+ tangential springs, no rotation", lambda t: t.update(springs=(1.0, 0.5), effects={"rotation": "restrained"})),
        ("+ rotation", lambda t: t.pop("effects")),
        ("+ gravity", put("run", gravity=[0.0, -1e-3])),
        ("+ a wall", lambda t: t.update(wall=[{"name": "floor", "point": [0.0, 0.0], "normal": [0.0, 1.0], "kN": 1.0}])),
        ("+ damping by mass", put("run", damping={"mass": 0.01})),
        ("+ dashpots at contacts", put("run", damping={"mass": 0.01, "contact": 0.1})),
        ("or local damping, without dashpots", put("run", damping={"mass": 0.01, "local": 0.1})),
        ("+ finite motion", put("run", motion="finite"))])


def line(name, point, normal):
    return {"name": name, "point": point, "normal": normal}


def box(width, height):
    return [line("floor", [0.0, 0.0], [0.0, 1.0]), line("lid", [0.0, height], [0.0, -1.0]),
            line("left", [0.0, 0.0], [1.0, 0.0]), line("right", [width, 0.0], [-1.0, 0.0])]


def colliding(positions, walls, law, velocities=None, **contact):
    discs = [{"position": list(x), "radius": R} for x in positions]
    for disc, velocity in zip(discs, velocities or []):
        disc["velocity"] = list(velocity)
    return Scene(len(discs), grains={"density": 2480.0}, grain=discs, wall=walls, run={"time_step": STEP},
                 collisions={"law": law, "tangential_ratio": 0.0, **contact})


def moving(wall, amplitude):
    def change(tables):
        tables["schedule"] = [{"name": "move", "kind": "sine", "value": 1.0, "frequency": 50.0}]
        tables["wall"][wall].update(displacement=amplitude, direction=[0.0, 1.0], schedule="move")
    return change


FRICTION = [("+ friction, sliding", put("collisions", friction=0.3)),
            ("+ tangential springs", put("collisions", tangential_ratio=0.5)),
            ("+ tangential dashpots", put("collisions", tangential_damping=0.1)),
            ("+ a moving wall", moving(0, 1e-4))]


def every_tenth(first, **keys):
    def change(tables):
        for disc in tables["grain"][first::10]:
            disc.pop("radius")
            disc.update(keys)
    return change


def bonds(step, **keys):
    """Between discs k and k + 1."""
    return lambda tables: tables.update(bond=[{"grains": [k, k + 1], **keys} for k in range(2, len(tables["grain"]) - 1, step)])


def at_rest(side):
    discs = [(R * (2 * k + row % 2), R * (0.999 + 1.7315 * row)) for row in range(side) for k in range(side)]
    scene = colliding(discs, [line("floor", [0.0, 0.0], [0.0, 1.0])], "linear_dashpot", stiffness=STIFFNESS, restitution=0.5)
    scene.tables["run"]["gravity"] = [0.0, -9.8]
    return chain(scene, [
        ("normal contacts, a floor, gravity", nothing), *FRICTION,
        ("+ a tenth ellipses", every_tenth(0, half_axes=[R, 0.8 * R])),
        ("+ a tenth clumps", every_tenth(5, discs=[[-0.3 * R, 0.0, 0.7 * R], [0.3 * R, 0.0, 0.7 * R]])),
        ("+ bonds, two in ten", bonds(10, normal_spring=1e5, tangential_spring=1e5, normal_dashpot=10.0, tangential_dashpot=10.0))])


def flying(side):
    """Discs that collide mostly in pairs, as the maps require; a contact lasts 20 steps."""
    spacing, draw = 2.1 * R, random.Random(1)
    discs = [(spacing * (0.5 + k), spacing * (0.5 + row)) for row in range(side) for k in range(side)]
    speeds = [(draw.uniform(-4, 4), draw.uniform(-4, 4)) for _ in discs]
    scene = colliding(discs, box(spacing * side, spacing * side), "energy_map", speeds, stiffness=1e8, restitution=0.9)
    return chain(scene, [("normal contacts", nothing), *FRICTION])


def rows(side):
    """Rows of discs that press one another, each in the gaps of the one below; spacing, width, height and stress."""
    spacing = 2 * R - OVERLAP
    discs = [(spacing * (0.5 + k + 0.5 * (row % 2)), spacing * (0.5 + 0.5 * math.sqrt(3) * row)) for row in range(side) for k in range(side)]
    # Three contacts a disc with the force k OVERLAP and the branch s: p = 3 f s/(2 A), A = sqrt(3) s²/2.
    return discs, spacing, spacing * (side + 0.5), spacing * (1 + 0.5 * math.sqrt(3) * (side - 1)), math.sqrt(3) * STIFFNESS * OVERLAP / spacing


def pressed(side):
    discs, _, width, height, _ = rows(side)
    return colliding(discs, box(width, height), "linear_dashpot", stiffness=STIFFNESS, restitution=0.5, friction=0.3, tangential_ratio=0.5)


def in_box(side):
    _, spacing, width, height, stress = rows(side)

    def servo(tables):
        for wall, length in ((1, width), (3, height)):
            tables["wall"][wall]["servo"] = {"stress": stress, "length": length, "max_speed": 0.1}

    def stages(count, **more):
        return lambda tables: tables.update(stage=[{"name": f"part_{k + 1}", **(more if k else {})} for k in range(count)])

    return chain(pressed(side), [
        ("between four walls", nothing), ("+ a moving wall", moving(1, 0.1 * OVERLAP)),
        ("or shaken, all walls", put("shaking", acceleration=1.0, frequency=500.0)),
        ("or two servo walls, which keep a stress", servo),
        ("or one stage", stages(1)), ("or two stages", stages(2)),
        ("or two stages, a body removed between them", stages(2, remove=[{"box": [0.0, 0.0, spacing, spacing]}]))])


def in_cell(side):
    _, spacing, _, _, stress = rows(side)
    width, height = spacing * side, 0.5 * math.sqrt(3) * spacing * side
    scene = pressed(side)
    scene.tables["run"]["integrator"] = "velocity_verlet"
    return chain(scene, [
        ("between four walls", nothing),
        ("or periodic along x, with floor and lid", lambda t: t.update(wall=t["wall"][:2], cell={"periodic": "x", "width": width})),
        ("+ a cell in place of the walls", lambda t: (t.pop("wall"), t.update(cell={"width": width, "height": height}))),
        ("+ shear at a constant rate", put("cell", motion={"xy": 1.0})),
        ("+ a stress that it keeps", put("cell", servo={"stress_yy": -stress, "max_rate": 10.0}))])


def rock(side):
    pairs = []
    for row in range(side):
        for k in range(side):
            disc, left = row * side + k, 1 if row % 2 else -1
            pairs += [(disc, disc + 1)] * (k + 1 < side)
            if row + 1 < side:
                pairs += [(disc, disc + side)] + [(disc, disc + side + left)] * (0 <= k + left < side)
    scene = colliding(rows(side)[0], [line("floor", [0.0, 0.0], [0.0, 1.0])], "linear_dashpot", stiffness=STIFFNESS, restitution=0.5)
    scene.tables["run"]["gravity"] = [0.0, -9.8]
    return chain(scene, [
        ("normal contacts, no bonds", nothing),
        ("+ bonds with springs along", lambda t: t.update(bonds={"normal_spring": STIFFNESS}, bond=[{"grains": list(pair)} for pair in pairs])),
        ("+ springs across", put("bonds", tangential_spring=0.4 * STIFFNESS)),
        ("+ a width: springs against bending", put("bonds", bending_spring=STIFFNESS * R * R / 3)),  # as wide as a disc
        ("+ dashpots along and across", put("bonds", normal_dashpot=10.0, tangential_dashpot=10.0)),
        ("+ strengths, of which none is reached", put("strength", tension=1e9, shear=1e9))])


PROBLEMS = [("bonded discs", bonded), ("colliding discs at rest on a floor", at_rest),
            ("discs flying in a box, energy map", flying), ("colliding discs pressed in a box", in_box),
            ("colliding discs in a cell", in_cell), ("colliding discs, bonded", rock)]


def measured(run, scenes, work, seconds_of):
    """Name, last result and median seconds: in every round all scenes take turns, in an order drawn anew."""
    times, results, draw = {name: [] for name, _ in scenes}, {}, random.Random(1)
    for count in range(run.options.rounds + 1):
        for name, scene in draw.sample(scenes, len(scenes)):
            results[name] = work(scene)
            if count:
                times[name].append(seconds_of(results[name]))
    return [(name, results[name], statistics.median(times[name])) for name, _ in scenes]


def compared(scenes):
    """Name, result, time and the time that it is compared with. A scene with "or" is no base of others."""
    before, found = [], []
    for name, result, time in scenes:
        alternative = name.startswith("or ")
        base = None if not before else before[-2] if alternative and len(before) > 1 else before[-1]
        found.append((name, result, time, base))
        if not alternative:
            before.append(time)
    return found


def chain_rows(problem, scenes, contacts_of):
    """Of scenes whose times are ns of a disc-step."""
    lines, plain = [], scenes[0][2]
    for name, result, ns, base in compared(scenes):
        memory = result["bytes_per_grain"] if "bytes_per_grain" in result else result["bytes_per_disc"]
        lines.append([problem, name, "3" if "rotation" in result["effects"]["active"] else "2", f"{memory:.0f}", f"{contacts_of(result):.2g}",
                      f"{ns:.1f}", "" if base is None else f"{round(100 * (ns / base - 1)):+d} %", f"{ns / plain:.2f}"])
    return lines


def in_motion(run, eq, side):
    def contacts(result):
        if "evaluations" in result:
            return result["evaluations"] / (result["steps"] * side * side)
        return result["contacts"] / result["discs"]

    lines = []
    for problem, make in PROBLEMS:
        scenes = [(label, result.to_dict(), 1e9 * seconds / DISC_STEPS)
                  for label, result, seconds in measured(run, make(side), lambda scene: scene.run(eq), lambda r: r["times"]["steps"])]
        lines += chain_rows(problem, scenes, contacts)
    return lines


def statics(run, eq, side):
    cases = [("normal springs, kT = 0", {"springs": (1e9, 0.0)}),
             ("+ tangential springs, rotation restrained", {"springs": (1e9, 0.5e9), "effects": {"rotation": "restrained"}}),
             ("+ rotation free", {"springs": (1e9, 0.5e9)}), ("or kT/kN = -0.2, by L D L^T", {"springs": (1e9, -0.2e9)})]
    block = {"kind": "hexagonal", "columns": side, "rows": side, "radius": 0.005}

    def solve(tables):
        return eq.Case(assembly=block, test={"kind": "uniaxial_tension", "stress": 1e6}, **tables).solve(threads=1)

    lines, plain = [], None
    for name, result, seconds in measured(run, cases, solve, lambda result: sum(result["times"].values())):
        found, discs = result.to_dict(), result["discs"]
        plain = plain or seconds
        entries = found.get("factor_nonzeros", 0) / discs
        lines.append([name, f"{found['unknowns'] / discs:.3g}", f"{entries:.0f}" if entries else "none: multigrid",
                      f"{found['factor_bytes'] / discs:.0f}", f"{1e6 * seconds / discs:.3g}", f"{seconds / plain:.2f}",
                      f"{found['relative_residual']:.0e}"])
    return lines


def absent(run, name, *options):
    """Tables of a benchmark of loops beside ones by hand."""
    return [rows for _, rows in tables_of(run.call([run.beside("bench", f"bench_{name}"), "--absent", "--rounds", 3 if run.options.quick else 9, *options]))]


def draw(folder):
    """One figure of bars: the time of a step with each effect."""
    import figures

    groups = {}
    for row in rows_of(folder / "scenes.csv"):
        groups.setdefault(row["problem"], []).append((row["scene"], float(row["ns per disc-step"])))
    figures.bars(folder / "scenes", groups, "ns per disc and step")


def make(run):
    eq, folder = run.module(), run.data / "effects"
    write_rows(folder / "scenes.csv", SCENES, in_motion(run, eq, 20 if run.options.quick else 50))
    write_rows(folder / "statics.csv", STATICS, statics(run, eq, 30 if run.options.quick else 150))
    loops = dict(zip(("bonded", "flight", "bed"), absent(run, "dynamic", "--kinds", "hexagonal") + absent(run, "collisions")))
    for name, (head, *rows) in loops.items():
        write_rows(folder / f"by_hand_{name}.csv", head, rows)
    found = stamp(run.study("integrators"))
    write_rows(folder / "measured.csv", list(found), [list(found.values())])
    draw(folder)
