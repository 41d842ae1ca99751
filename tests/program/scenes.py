# SPDX-License-Identifier: GPL-3.0-or-later
"""Texts of cases that several tests use: bodies between walls, and stages."""
import random


def grain(x, y, radius=0.01, more=""):
    return f"[[grain]]\nposition = [{x}, {y}]\nradius = {radius}\n{more}"


def wall(name, point, normal, more=""):
    return f'[[wall]]\nname = "{name}"\npoint = [{point[0]}, {point[1]}]\nnormal = [{normal[0]}, {normal[1]}]\n{more}'


def stage(name, duration, more=""):
    """`duration` in s, or None where `more` has what ends it."""
    end = "" if duration is None else f"duration = {duration}\n"
    return f'[[stage]]\nname = "{name}"\n{end}{more}'


def stage_wall(name, more=""):
    return f'[[stage.wall]]\nname = "{name}"\n{more}'


def schedule(name, kind, keys):
    return f'[[schedule]]\nname = "{name}"\nkind = "{kind}"\n{keys}'


def probe(keys):
    return f"[[probe]]\n{keys}"


def output(probe_interval, more=""):
    return f"[output]\nprobe_interval = {probe_interval}\n{more}"


def rows_of_discs(count, spacing, radius=0.01):
    """A square of discs."""
    return "".join(grain(0.5 * spacing + spacing * i, 0.5 * spacing + spacing * j, radius)
                   for i in range(count) for j in range(count))


def loose_square(count, seed):
    """x,y,radius of a square of unequal discs that do not touch, as a table."""
    draw = random.Random(seed).uniform
    return "x,y,radius\n" + "".join(f"{0.0095 * (i + 0.5) + draw(-4e-4, 4e-4):.7f},{0.0095 * (j + 0.5) + draw(-4e-4, 4e-4):.7f},"
                                    f"{draw(0.0035, 0.0042):.7f}\n" for i in range(count) for j in range(count))


HEAD = "[grains]\ndensity = 2500.0\n"
LAW = '[collisions]\nlaw = "linear_dashpot"\nrestitution = 0.3\nstiffness = 1.0e6\n'
APART = grain(0.02, 0.01) + grain(0.05, 0.01)
TOUCHING = grain(0.02, 0.01) + grain(0.04, 0.01)
BOX = wall("floor", (0.0, 0.0), (0.0, 1.0)) + wall("left", (0.0, 0.0), (1.0, 0.0)) + wall("right", (0.07, 0.0), (-1.0, 0.0))
LID = wall("lid", (0.0, 0.021), (0.0, -1.0))
PRESS = HEAD + APART + LAW + BOX + LID  # to be followed by the servo of the lid
SERVO = "servo = { force = 20.0, max_speed = 0.1 }\n"
RUN = "[run]\nduration = 0.1\n"
FALLING = "[run]\ngravity = [0.0, -9.81]\n"
VERLET = "run.integrator=velocity_verlet"
UNTIL_REST = "[stage.until]\nkinetic = 1e-6\nunbalanced = 1e-3\n"

# A lid presses two discs, the left wall moves, the lid goes and a roof comes.
STAGES = FALLING + stage("press", 0.05) + stage("slide", 0.02, stage_wall("left", "velocity = [0.01, 0.0]\n")) + \
    stage("open", 0.02, "gravity = [0.0, 0.0]\n[stage.collisions]\nfriction = 0.2\n" + stage_wall("lid", "removed = true\n") +
          stage_wall("roof", "point = [0.0, 0.025]\nnormal = [0.0, -1.0]\n"
                     'servo = { stress = 100.0, from = "left", to = "right", max_speed = 1.0 }\n')) + output(1e-3)

# Two discs lie, two are poured onto them, one of these is taken away and the other renamed, and that one is smooth.
CHOSEN = "box = [0.05, 0.0, 0.07, 0.06]\n"
ROUGH_BOX = HEAD + APART + LAW + "friction = 0.4\ntangential_ratio = 0.5\n" + BOX
POURED = ROUGH_BOX + FALLING + stage("settle", 2.0, UNTIL_REST) + stage("pour", 2.0, UNTIL_REST + """[[stage.grain]]
position = [0.0351, 0.03]
radius = 0.01
group = "top"
[[stage.grain]]
position = [0.06, 0.04]
radius = 0.008
group = "top"
""") + stage("level", 0.1, f"""[[stage.remove]]
group = "top"
{CHOSEN}[[stage.rename]]
group = "top"
to = "smooth"
[[stage.pair]]
group = "smooth"
with = "grains"
friction = 0.0
""") + stage("last", 0.2)
POURED_OUTPUT = output(5e-3, "frame_interval = 0.05\n") + \
    probe('name = "tops"\ngroup = "top"\nquantities = ["position", "velocity"]\n')

# The lid gets another name, and a smaller force.
RENAME = '[[stage.rename]]\nwall = "lid"\nto = "plate"\n'
NAMED = PRESS + SERVO + schedule("less", "table", "times = [0.0, 0.01]\nvalues = [1.0, 0.5]\n") + "[run]\n" + \
    stage("press", 0.03) + stage("relieve", 0.03, RENAME + stage_wall(
        "plate", 'servo = { force = 20.0, schedule = "less", max_speed = 0.1 }\n')) + \
    stage("stand", 0.01, stage_wall("plate")) + output(1e-3)

# A cell is consolidated, sheared and held.
STAGED_CELL = '[grains]\ndensity = 2500.0\npath = "grains.csv"\n' + LAW.replace("1.0e6", "1.0e7") + """friction = 0.4
tangential_ratio = 0.5
[cell]
width = 0.076
height = 0.076
[cell.servo]
stress_xx = -1.0e5
stress_yy = -1.0e5
max_rate = 5.0
[run]
integrator = "velocity_verlet"
""" + output(1e-3) + stage("consolidate", 0.3, "[stage.until]\nkinetic = 1e-4\nunbalanced = 0.02\n") + \
    stage("shear", 0.1, '[stage.until]\nstrain = 0.05\ncomponent = "xy"\n[stage.cell.motion]\nxx = 0.0\nxy = 1.0\n') + \
    stage("stand", 0.01, "[stage.cell.motion]\nxx = 0.0\nyy = 0.0\n")


def rock(bonds="[stage.bonds]\ngap_tolerance = 0.01\n"):
    """Three, two and three discs in rows that touch are pressed, cemented and crushed."""
    discs = "".join(grain(f"{0.01 + 0.01 * (row % 2) + 0.02 * k:.7f}", f"{0.01 + 0.0173205 * row:.7f}")
                    for row in range(3) for k in range(3 - row % 2))
    walls = (BOX + LID).replace("[0.07, 0.0]", "[0.0601, 0.0]").replace("[0.0, 0.021]", "[0.0, 0.0547]")
    return HEAD + discs + LAW + walls + SERVO + """[bonds]
normal_spring = 1.0e6
tangential_spring = 5.0e5
bending_spring = 30.0
normal_dashpot = 20.0
tangential_dashpot = 10.0
[strength]
tension = 100.0
shear = 200.0
weibull_modulus = 5.0
[run]
integrator = "velocity_verlet"
""" + output(1e-3, "frame_interval = 0.02\n") + stage("press", 0.05) + stage("cement", None, "steps = 500\n" + bonds) + \
        stage("crush", 0.05, stage_wall("right", "removed = true\n") + stage_wall("left", "removed = true\n") +
              stage_wall("lid", "velocity = [0.0, -0.01]\n"))
