# SPDX-License-Identifier: GPL-3.0-or-later
"""What servo walls, stages, shaking and cells of colliding bodies refuse, with its line: run_stage_refusals.py PROGRAM
SOURCE_FOLDER [unittest options]."""
import unittest

from motion import RunTest
from program import equidem
from scenes import (APART, HEAD, LAW, NAMED, POURED, PRESS, RENAME, RUN, SERVO, STAGED_CELL, STAGES, schedule,
                    stage, stage_wall, wall)

RAMP = schedule("up", "ramp", "end = 1.0\n")


def servo(keys, scene=PRESS):
    return f"{scene}servo = {{ {keys} }}\n"


def first(text, lid=SERVO, run="[run]\n"):
    """A case whose first stage has these tables."""
    return PRESS + lid + run + stage("a", 0.01, text)


def second(text, of_first="", lid=""):
    """A case whose second stage has these tables."""
    return PRESS + lid + "[run]\n" + stage("a", 0.01, of_first) + stage("b", 0.01, text)


class Refusals(RunTest):
    def check(self, *cases, place="case.toml:"):
        for text, *words in cases:
            with self.subTest(text=text[-300:]):
                self.refused(text, place, *words)

    def test_keys_of_a_servo_wall(self):
        force, stress = "force = 1.0, max_speed = 0.1", "stress = 1.0, max_speed = 0.1"
        self.check(*((servo(keys) + RUN, *words) for keys, *words in (
            ("force = -1.0, max_speed = 0.1", "wall.servo.force", "-1"),
            (stress + ", force = 1.0", "both given"),
            ("max_speed = 0.1", "neither force nor stress"),
            ("force = 1.0, max_speed = 0.0", "wall.servo.max_speed"),
            (force + ", relaxation = 1.5", "wall.servo.relaxation"),
            (force + ", gain = 1.0", "gain", "unknown key"),
            (force + ", length = 1.0", "length is given without stress"),
            (stress, "no length to act on", "wall.servo"),
            (stress + ', from = "left"', "from is given without to"),
            (stress + ', from = "left", to = "west"', "'west'", "no other wall"),
            (stress + ', from = "left", to = "floor"', "'floor'", "cross"),
            (stress + ', from = "left", to = "left"', "wall.servo.to", "between 'left' and itself", "Name another wall"),
            (force + ', mirror = "west"', "wall.servo", "'west'", "no wall of that name"),
            (force + ", direction = [0.0, 0.0]", "wall.servo.direction", "zero"),
            (force + ', schedule = "up"', "wall.servo.schedule", "up"))))
        pushed = servo(force) + 'displacement = 0.01\nschedule = "up"\n'
        self.refused(pushed + RAMP + RUN, "wall.servo", "'lid'", "displacement")
        self.refused(PRESS.replace('"linear_dashpot"', '"energy_map"') + SERVO + RUN, "'lid'", "map")
        sphere = PRESS.replace("[grains]\n", '[grains]\nbody = "sphere"\n')
        self.refused(servo(stress + ", length = 1.0", sphere) + RUN, "grains.body", "spheres")

    def test_what_no_engine_carries(self):
        for text, *words in ((PRESS + SERVO + RUN, "follow a force", "'lid'"),
                             (PRESS + STAGES.replace("removed = true", ""), "in stages")):
            self.check_error(equidem("export", self.write(text), "--to", "lammps", "--out", self.folder / "model"), 2, *words)

    def test_keys_of_stages(self):
        left = stage_wall("left", "removed = true\n")
        again = stage_wall("left", "point = [0.0, 0.0]\nnormal = [1.0, 0.0]\n")
        jump = schedule("step", "table", "times = [0.0, 1.0]\nvalues = [0.5, 1.0]\n")
        self.check(
            (PRESS + SERVO + "[run]\n", "run.duration", "missing"),
            (first("", run=RUN), "run.duration", "both given"),
            (first(stage("a", 1.0)), "two stages 'a'"),
            (first(stage("b", None)), "neither duration nor steps"),
            (first(stage("b c", 1.0)), "stage.name"),
            (first("steps = 10\n"), "both given"),
            (first("[stage.until]\n"), "stage.until", "nothing is given"),
            (first("[stage.until]\nstrain = 0.1\n"), "strain is given without from"),
            (first('[stage.until]\nstrain = 0.1\nfrom = "left"\nto = "west"\n'), "stage.until.to", "'west'"),
            (first('[stage.until]\nstrain = 0.1\nfrom = "left"\nto = "left"\n'), "the same"),
            (first('[stage.until]\ndisplacement = 0.1\nwall = "west"\n'), "stage.until.wall", "'west'"),
            (first("[stage.until]\nkinetic = -0.1\n"), "stage.until.kinetic"),
            (first(stage_wall("west", "removed = true\n")), 'no wall "west"'),
            (first(stage_wall("west", "velocity = [1.0, 0.0]\n")), "'west' is a new wall", "point"),
            (first(stage_wall("left", "point = [1.0, 0.0]\n")), "'left' is there already"),
            (first(left + "velocity = [1.0, 0.0]\n"), "is removed, and"),
            (first(left + "normal = [1.0, 0.0]\n"), "is removed, and"),
            (first(stage_wall("left", 'shape = "segment"\n')), "'left' is there already", "stage.wall.shape"),
            (first(left + again), "two walls 'left'"),
            (first(left + stage("b", 0.1, again)), "'left' is new", "an earlier one had that name"),
            (first(stage_wall("left", 'displacement = 0.001\nschedule = "step"\n')) + jump, "'left' would jump",
             "stage.wall.schedule"),
            (first("[stage.bonds]\n"), "stage.bonds", "bonds"),
            (first("[stage.bonds]\ngap_tolerance = 2.0\nnormal_spring = 1.0\n"), "gap_tolerance"),
            (first("[stage.bonds]\nnormal_spring = -1.0\n"), "stage.bonds.normal_spring"),
            (first("[strength]\ntension = 1.0\nshear = 1.0\n"), "no grains are tied"),
            (first(stage_wall("floor", "removed = true\n"), 'servo = { force = 1.0, max_speed = 0.1, mirror = "floor" }\n'),
             "'floor' is removed", "mirror"),
            (first(stage_wall("left", "speed = 1.0\n")), "unknown key"),
            (first(stage_wall("left", 'displacement = 1.0\nschedule = "up"\n')), "stage.wall.schedule"),
            (first("[stage.collisions]\nfriction = -1.0\n"), "stage.collisions.friction"),
            (first('[[stage.pair]]\ngroup = "grains"\nwith = "west"\n'), "west"),
            (first("[shaking]\nacceleration = 1.0\nfrequency = 1.0\n"), "shaking"))

    def test_changes_of_bodies(self):
        new = "[[stage.grain]]\nposition = [0.035, 0.2]\nradius = 0.01\n"
        group = '[[stage.rename]]\ngroup = "grains"\n'
        self.check(
            (second("[[stage.remove]]\n"), "stage.remove", "neither a group nor a box"),
            (second('[[stage.remove]]\ngroup = "grain"\n'), "stage.remove.group", "grains"),
            (second("[[stage.remove]]\nbox = [1.0, 0.0, 0.0, 1.0]\n"), "stage.remove.box", "empty"),
            (second("[[stage.remove]]\nbox = [1.0, 0.0]\n"), "stage.remove.box"),
            (second('[[stage.remove]]\ngroup = "grains"\n'), "stage 'b'", "all bodies are removed"),
            (second(group), "stage.rename.to", "missing"),
            (second(group + 'to = "walls"\n'), "stage.rename.to", "all of them"),
            (second(group + 'to = "a b"\n'), "stage.rename.to", "letters"),
            (second(group + 'to = ""\n'), "stage.rename.to", "empty"),
            (second(group + 'to = "lid"\n'), "both called 'lid'"),
            (second('[[stage.rename]]\nto = "x"\n'), "stage.rename", "neither"),
            (second(new.replace("radius = 0.01\n", "")), "stage.grain", "radius"),
            (second(new.replace("0.01", "-0.01", 1)), "stage.grain.radius"),
            (second(new.replace("0.01", "0.01\nmass = 1.0", 1)), "unknown key"),
            (second(new + new), "stage.1", "inside one another"),
            (second(new.replace("0.035, 0.2]", "0.025, 0.012]")), "stage 'b'", "inside one another"),
            (second(new.replace("0.2]", "-0.5]")), "stage 'b'", "behind wall"),
            (second('[stage.grains]\npath = "none.csv"\n'), "stage.grains.path", "none.csv"),
            (second("", new), "first stage changes the grains"),
            (second("", '[[stage.remove]]\ngroup = "grains"\n'), "first stage changes the grains"),
            (second(new + '[[probe]]\nname = "p"\ngroup = "later"\n'), "probe.group", "begins"),
            (second(new + '[[probe]]\nname = "p"\nbodies = [3]\n'), "probe.bodies", "no body 3"),
            (second('[[stage.pair]]\ngroup = "smooth"\nwith = "lid"\nfriction = 0.1\n'), "smooth", "no group"),
            (second("[stage.shake]\nacceleration = 1.0\n"), "unknown"),
            (second("[stage.cell.motion]\nxy = 1.0\n"), "stage.cell", "no [cell]"))
        top = POURED.replace('[[stage.rename]]\ngroup = "top"\n', '[[stage.rename]]\nwall = "floor"\n{}', 1)
        self.check(*((top.replace("{}", key), "stage.rename", "both given")
                     for key in ('group = "top"\n', "box = [0.05, 0.0, 0.07, 0.06]\n")))

    def test_names_of_walls(self):
        plate, moved = 'to = "plate"\n', 'name = "plate"\nservo'
        alone = NAMED[:NAMED.index("[[stage.wall]]")]
        twice = plate + '[[stage.rename]]\nwall = "{}"\nto = "third"\n'
        unnamed = NAMED.replace(RENAME, "").replace('"plate"', '"lid"')
        mirrored = NAMED.replace(SERVO, 'servo = { force = 20.0, max_speed = 0.1, mirror = "floor" }\n')
        self.check(
            (NAMED.replace('wall = "lid"\nto', 'wall = "lit"\nto'), "stage.rename.wall", "no wall", 'mean "lid"'),
            (NAMED.replace(plate, 'to = "floor"\n'), "stage.rename.to", "has or had that name"),
            (alone.replace(plate, 'to = "grains"\n'), "both called 'grains'"),
            (alone.replace(plate, 'to = "walls"\n'), "stage.rename.to", "all of them"),
            (NAMED.replace(plate, 'to = "a b"\n'), "stage.rename.to", "letters"),
            (NAMED.replace(plate, ""), "stage.rename.to", "missing"),
            (NAMED.replace(plate, twice.format("plate")), "stage.rename.wall", "Rename it once"),
            (NAMED.replace(plate, twice.format("lid")), "stage.rename.wall", "Rename it once"),
            (NAMED.replace(plate, plate + 'group = "grains"\n'), "wall", "group", "bodies or a wall"),
            (NAMED.replace(moved, 'name = "lid"\nservo'), "stage.wall.name", 'Write name = "plate"'),
            (NAMED.replace(moved, 'name = "plate"\nremoved = true\n# servo'), "renamed and removed"),
            (NAMED.replace(moved, 'name = "lid"\nremoved = true\n# servo'), "renamed and removed"),
            (unnamed.replace("duration = 0.03\n", "duration = 0.03\n" + RENAME, 1), "stage.rename",
             "first stage renames the wall 'lid'"),
            (mirrored.replace('wall = "lid"\nto', 'wall = "floor"\nto').replace(f"[[stage.wall]]\n{moved} = ", "#"),
             "'floor' is renamed", "'lid' moves it as its mirror"))

    def test_the_wrong_one_of_two_keys_is_named_with_its_line(self):
        slow = "servo = {{ force = 1.0, max_speed = 1.0{} }}\n"

        def pair(group, other, friction=0.2):
            return f'[[stage.pair]]\ngroup = "{group}"\nwith = "{other}"\nfriction = {friction}\n'
        for text, key, line, *words in (
                (stage_wall("lit", "removed = true\n"), "stage.wall.name", 'name = "lit"', 'mean "lid"'),
                (stage_wall("lid", "removed = true\nshaken = false\n"), "stage.wall.shaken", "shaken = false",
                 "is removed, and shaken"),
                (stage_wall("lid", slow.format("") + "velocity = [0.0, -1.0]\n"), "stage.wall.servo", "servo = {", "a velocity",
                 "Leave out that motion"),
                (stage_wall("lid", slow.format(', mirror = "flor"')), "stage.wall.servo.mirror", 'mirror = "flor"'),
                (stage_wall("lid", slow.format(', mirror = "lid"')), "stage.wall.servo.mirror", 'mirror = "lid"', "its own mirror"),
                (stage_wall("lid", slow.replace("force", "stress").format(', from = "left", to = "west"')),
                 "stage.wall.servo.to", "west"),
                ("[stage.shaking]\nacceleration = 1.0\nfrequency = 100.0\ncycles = 1\ndirection = [0.0, 1.0]\n", "stage.shaking",
                 "[stage.shaking]", "'lid' shakes along", "servo"),
                ('[stage.until]\nstrain = 0.1\nfrom = "floor"\nto = "left"\n', "stage.until.to", 'to = "left"', "do not face"),
                ('[stage.until]\nstrain = 0.1\nfrom = "floor"\nto = "floor"\n', "stage.until.to", 'to = "floor"', "the same"),
                ("[stage.bonds]\ngap_tolerance = 0.1\n", "stage.bonds", "[stage.bonds]", "neither dashpots nor springs"),
                (pair("grains", "lid") + stage_wall("lid", "removed = true\n"), "stage.pair.with", 'with = "lid"',
                 "no wall 'lid' stands"),
                (pair("grains", "lid") + RENAME, "stage.pair.with", 'with = "lid"', 'Write with = "plate"'),
                (pair("grains", "nobody"), "stage.pair.with", 'with = "nobody"', "no group of grains and no wall"),
                (pair("lid", "grains"), "stage.pair.group", 'group = "lid"', "but a wall", "Exchange"),
                (pair("lid", "floor"), "stage.pair.group", 'group = "lid"', "do not meet"),
                (pair("grains", "lid") + pair("grains", "lid", 0.3), "stage.pair", "", "a pair twice"),
                (stage_wall("lid") + stage_wall("lid", "velocity = [0.0, 1.0]\n"), "stage.wall.name", "", "two walls 'lid'"),
                ('[[stage.rename]]\ngroup = "grains"\nto = "lid"\n', "stage.rename.to", 'to = "lid"', "both called 'lid'"),
                ('[[stage.grain]]\nposition = [0.035, 0.01]\nradius = 0.001\ngroup = "lid"\n', "stage.grain.group", 'group = "lid"',
                 "both called 'lid'")):
            with self.subTest(text=text):
                told = self.refused(second(text, lid=SERVO), f": {key}: ", *words).stderr
                number = int(told.split("case.toml:")[1].split(":")[0])
                self.assertIn(line, (self.folder / "case.toml").read_text().splitlines()[number - 1], told)

    def test_shaking_of_a_stage(self):
        shaking = "[stage.shaking]\nacceleration = 2.0\nfrequency = 20.0\n"
        cycles = shaking + "cycles = 3\n"
        still = "".join(stage_wall(name, "shaken = false\n") for name in ("floor", "left", "right"))
        self.check(*((POURED + text, *words) for text, *words in (
            (shaking + "duration = 0.07\n", "stage.shaking.duration", "cycles"),
            (cycles.replace("20.0", "-1.0"), "stage.shaking.frequency"),
            (cycles + 'record = "r.csv"\n', "stage.shaking"),
            (cycles + still, "stage.shaking", "no wall that shakes"),
            (cycles + stage_wall("floor", "velocity = [0.1, 0.0]\n"), "'floor' moves by itself"),
            (shaking + "start = 1.0\n", "stage.shaking.start", "begins to shake at 1"))))
        self.refused(POURED.replace('name = "last"\nduration = 0.2', 'name = "last"\nsteps = 20') + shaking, "stage.shaking",
                     "Give cycles or duration")

    def test_cells_of_stages(self):
        self.write("x,y,radius\n0.02,0.02,0.004\n0.05,0.05,0.004\n", "grains.csv")
        cell, motion = STAGED_CELL, "xx = 0.0\nxy = 1.0"
        no_cell = cell[:cell.index("[cell]")] + cell[cell.index("[run]"):]
        self.check(
            (no_cell.replace(f"[stage.cell.motion]\n{motion}\n", ""), "stage.until.component", "no cell"),
            (no_cell.replace('strain = 0.05\ncomponent = "xy"', "kinetic = 1e-3"), "stage.cell", "no [cell]"),
            (cell.replace('component = "xy"', 'component = "zz"'), "stage.until.component", "xy"),
            (cell.replace('component = "xy"\n', ""), "strain is given without", "component"),
            (cell.replace('component = "xy"\n', 'component = "xy"\nfrom = "a"\nto = "b"\n'), "both given"),
            (cell.replace("[run]", "[cell.motion]\nxy = 1.0\n[run]"), "cell.motion", "outside of the stages"),
            (cell.replace("max_rate = 5.0\n", 'max_rate = 5.0\nschedule = "s"\n'), "cell.servo.schedule"),
            (cell.replace(motion, 'xy = 1.0\nschedule = "s"'), "stage.cell.motion.schedule"),
            (cell.replace(motion, "zz = 1.0"), "unknown key"),
            (cell.replace("velocity_verlet", "semi_implicit_euler"), "velocity_verlet"),
            (cell.replace("[run]", "[measures]\n[run]"), "measures"))

    def test_what_a_cell_cannot_be(self):
        verlet, cell, along = '[run]\nintegrator = "velocity_verlet"\n', "[cell]\nwidth = 0.1\nheight = 0.1\n", '[cell]\nwidth = 0.1\nperiodic = "x"\n'
        motion, held = "[cell.motion]\nxy = 1.0\n", "[cell.servo]\nstress_yy = -1.0\nmax_rate = 1.0\n"
        floor = wall("floor", (0.0, -0.02), (0.0, 1.0))
        box_probe = '[[probe]]\nname = "middle"\nbodies = [0]\nbox = [0.0, 0.0, 0.1, 0.1]\nquantities = ["stress"]\n'
        self.check(*((HEAD + APART + LAW + text + verlet + ("" if "stage" in text else "duration = 0.01\n"), *words)
                     for text, *words in (
            (cell.replace("0.1\nh", "0.03\nh"), "cell", "width = 0.03 m", "several images"),
            (cell.replace("height = 0.1\n", ""), "cell.height", "missing"),
            (cell.replace("width = 0.1\n", ""), "cell.width", "missing"),
            (cell + "depth = 1.0\n", "unknown key"),
            (cell + floor, "cell", "wall 'floor'"),
            (along + floor.replace("[0.0, 1.0]", "[1.0, 0.0]"), "no line along x"),
            (along + "height = 0.1\n" + floor, "height = 0.1 m"),
            (along + floor + motion, "cell.motion", "along x alone"),
            (cell + "[cell.motion]\nxx = 0.0\n", "cell.motion", "all rates are 0"),
            (cell + motion + 'schedule = "no"\n', "cell.motion.schedule"),
            (cell + motion.replace("xy", "yy") + held, "rate_yy", "stress_yy"),
            (cell + held.replace("stress_yy = -1.0\n", ""), "keeps no stress"),
            (cell + held.replace("max_rate = 1.0\n", ""), "cell.servo.max_rate"),
            (cell + "[measures]\n", "measures"),
            (cell + box_probe, "probe.quantities", "stress in a periodic cell", "history.csv has the stress of the cell"),
            (along + "shift = 0.01\n" + floor, "shift = 0.01 m"),
            (cell + stage("a", 1.0, motion), "cell.motion", "outside of the stages"))))
        scene = HEAD + APART + LAW + cell
        self.refused(scene + motion + "[run]\nduration = 0.01\nintegrator = \"semi_implicit_euler\"\n", "velocity_verlet")
        self.refused(scene.replace("linear_dashpot", "exact_flow") + "[run]\nduration = 0.01\n", "exact_flow")
        self.refused(scene + verlet + "duration = 0.01\ngravity = [0.0, -9.81]\n", "gravity")


if __name__ == "__main__":
    unittest.main()
