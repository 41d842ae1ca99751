#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Hard cases of servo walls, stages, bonds and cells, as a user meets them: run_hard_stages.py PROGRAM SOURCE_FOLDER [unittest
options]."""
import csv
import math
import unittest

import numpy

from motion import table
from program import equidem
from run_stages import NO_PICTURE, PRESS, SERVO, StageTest

TWO = PRESS[:PRESS.index("[[wall]]")]
WALLS = PRESS[PRESS.index("[[wall]]"):]
BONDS = """[[bond]]
grains = [0, 1]
normal_spring = 1.0e6
tangential_spring = 5.0e5
normal_dashpot = 20.0
"""
STRENGTH = "[strength]\ntension = {}\nshear = {}\n"
TOUCHING = TWO.replace("[0.05, 0.01]", "[0.04, 0.01]")


def rows_of(path):
    with open(path, newline="") as file:
        return list(csv.DictReader(file))


class HardCases(StageTest):
    def test_a_wall_that_a_schedule_moves_is_taken_away_with_its_motion(self):
        out = self.folder / "out"
        text = PRESS + """[[schedule]]
name = "down"
kind = "table"
times = [0.0, 1.0]
values = [0.0, 1.0]
[run]
[[stage]]
name = "push"
duration = 0.03
[[stage.wall]]
name = "lid"
displacement = 0.1
schedule = "down"
[[stage]]
name = "free"
duration = 0.03
[[stage.wall]]
name = "lid"
removed = true
[output]
probe_interval = 1.0e-3
[[probe]]
name = "one"
bodies = [0]
quantities = ["position", "velocity"]
"""
        text = text.replace("normal = [0.0, -1.0]", "normal = [0.0, -1.0]")
        result = self.run_case(self.write(text), "--out", out, *NO_PICTURE)
        history = table(out / "history.csv")
        pushed = history["time_s"] <= result["stages"][0]["end"] + 1e-12
        self.assertGreater(history["wall_lid_work_J_per_m"][pushed][-1], 0)
        self.assertTrue(numpy.isnan(history["wall_lid_y_m"][~pushed][1:]).all())
        free = history["one_vy_m_per_s"][~pushed][1:]
        self.assertGreater(abs(free[0]), 1e-4)  # thrown up by the floor that was pressed
        self.assertLess(abs(result["energy"]["relative_error"]), 5e-3)
        self.refused(text.replace("removed = true", 'removed = true\ndisplacement = 0.1\nschedule = "down"'), "case.toml:",
                     "'lid' is removed, and displacement is given")

    def test_contacts_that_lose_their_friction_carry_no_tangential_force_and_no_spring_that_comes_back(self):
        bodies = {"disc": TOUCHING, "ellipse": TOUCHING.replace("radius = 0.01", "half_axes = [0.01, 0.01]")}
        stages = """[run]
gravity = [-2.0, -9.81]
[[stage]]
name = "rough"
duration = 0.1
[[stage]]
name = "smooth"
steps = 2
[stage.collisions]
friction = 0.0
[[stage]]
name = "again"
steps = 1
[stage.collisions]
friction = 0.5
[output]
probe_interval = 1.0
"""
        walls = WALLS.replace("point = [0.0, 0.0]\nnormal = [1.0", "point = [0.01, 0.0]\nnormal = [1.0")
        for shape, scene in bodies.items():
            for integrator in ("semi_implicit_euler", "velocity_verlet"):
                with self.subTest(shape=shape, integrator=integrator):
                    rough = scene.replace("[collisions]", "[collisions]\nfriction = 0.5\ntangential_ratio = 0.5\ntangential_damping = 0.3")
                    text = (rough + walls + stages).replace("[run]", f'[run]\nintegrator = "{integrator}"')
                    out = self.folder / f"{shape}_{integrator}"
                    short = self.write(text[:text.index('[[stage]]\nname = "again"')] + "[output]\nprobe_interval = 1.0\n")
                    self.run_case(short, "--out", out, *NO_PICTURE)
                    contacts = rows_of(out / "contacts.csv")
                    self.assertTrue(contacts)
                    for contact in contacts:
                        self.assertEqual(float(contact["tangential_force_N_per_m"]), 0, contact)
                    whole = self.folder / f"whole_{shape}_{integrator}"
                    step = self.run_case(self.write(text), "--out", whole, *NO_PICTURE)["time_step"]
                    # each contact slips for one step, no faster than the rims of its bodies
                    rims = sorted(math.hypot(float(row["vx_m_per_s"]), float(row["vy_m_per_s"])) + 0.01 * abs(float(row["spin_rad_per_s"]))
                                  for row in rows_of(whole / "grains.csv"))
                    slipped = 0.5 * 5.0e5 * len(contacts) * (rims[-1] * step) ** 2
                    stored = table(whole / "history.csv")["elastic_tangential_J_per_m"]
                    self.assertGreater(stored[1], 0)      # at the end of the first stage
                    self.assertEqual(stored[2], 0)
                    self.assertGreater(stored[1], 5 * slipped)
                    self.assertLessEqual(stored[3], slipped)

    def test_a_servo_wall_that_wants_no_force_and_has_one_is_told(self):
        pressed = PRESS.replace("[0.0, 0.021]", "[0.0, 0.0199]") + 'servo = { force = 0.0 }\n[run]\nduration = 1.0e-3\n'
        result = self.run_case(self.write(pressed), *NO_PICTURE)
        servo, = result["servos"]
        self.assertGreater(servo["force"], 0)
        self.assertFalse(servo["reached"])
        self.assertIn("'lid'", " ".join(result["report"].split()).split("WARNING")[1])

    def test_the_force_on_a_wall_is_that_of_its_contacts(self):
        pressed = PRESS.replace("[0.0, 0.021]", "[0.0, 0.0199]") + "[run]\ntime_step = 2.0e-5\n[[stage]]\nname = 'push'\nsteps = 100\n"
        for integrator in ("semi_implicit_euler", "velocity_verlet"):
            with self.subTest(integrator=integrator):
                by_contacts = []
                for steps in (100, 101):
                    out = self.folder / f"{integrator}_{steps}"
                    result = self.run_case(self.write(pressed), "--out", out, "--set", f"stage.0.steps={steps}",
                                           "--set", f"run.integrator={integrator}", *NO_PICTURE)
                    by_contacts.append(sum(float(row["normal_force_N_per_m"]) for row in rows_of(out / "contacts.csv")
                                           if row["wall"] == "lid"))
                lid, = (wall for wall in result["forces_on_walls"] if wall["name"] == "lid")
                of_step = by_contacts[1] if integrator == "semi_implicit_euler" else sum(by_contacts) / 2
                self.assertGreater(abs(by_contacts[1] - by_contacts[0]), 1e-3)
                self.assertAlmostEqual(lid["force"][1], of_step, delta=1e-10 * of_step)

    def test_a_stress_between_a_wall_and_itself_is_refused(self):
        twice = PRESS + 'servo = { stress = 100.0, from = "left", to = "left" }\n[run]\nduration = 0.1\n'
        self.refused(twice, "case.toml:", "wall.servo.to", "between 'left' and itself", "Name another wall")

    def test_a_servo_wall_with_nothing_to_push_says_so(self):
        lone = TWO + '[[wall]]\nname = "lid"\npoint = [0.0, 0.5]\nnormal = [0.0, -1.0]\n' + SERVO
        servo, = self.run_case(self.write(lone + "[run]\nduration = 0.2\n"))["servos"]
        self.assertFalse(servo["touched"])
        up = lone.replace("max_speed = 0.1 }", "max_speed = 0.1, direction = [0.0, 1.0] }")
        self.refused(up + "[run]\nduration = 10.0\n", "wall.servo: step", "'lid' has gone", "met no body", code=1)
        # discs in flight, which it pushes before it: the force is not kept, and that is told
        servo, = self.run_case(self.write(lone.replace("0.5]", "0.021]") + "[run]\nduration = 0.2\n"))["servos"]
        self.assertGreater(servo["mean_error"], 0.5)

    def test_a_servo_that_cannot_keep_its_force_tells_by_how_much(self):
        # at a thousandth of the speed it cannot follow its schedule
        slow = PRESS.replace("0.021]", "0.0200001]") + SERVO.replace("max_speed = 0.1", "max_speed = 1.0e-4") + \
            "[run]\nduration = 0.05\n"
        servo, = self.run_case(self.write(slow))["servos"]
        self.assertFalse(servo["reached"])
        self.assertIsNone(servo["overshoot"])
        self.assertLess(servo["force"], 0.9 * servo["wanted"])
        done = equidem("run", self.write(slow))
        self.assertEqual(done.returncode, 0)
        self.assertIn("WARNING", done.stdout)
        self.assertIn("never came within 1 % of the wanted one: 'lid'", " ".join(done.stdout.split()))

    def test_a_cell_with_a_servo_and_nothing_to_press_says_so(self):
        cell = '[cell]\nwidth = 0.1\nheight = 0.1\n[cell.servo]\nstress_yy = {}\nmax_rate = {}\n' \
            '[run]\nduration = 0.1\nintegrator = "velocity_verlet"\n'
        for stress, words in ((-1000.0, "or for longer"), (1000.0, "contacts carry no tension")):
            result = self.run_case(self.write(TWO + cell.format(stress, 0.01)))
            self.assertEqual((result["contacts"], result["cell"]["servos"][0]["reached"]), (0, False))
            warning = " ".join(result["report"].split()).split("WARNING")[1]
            self.assertIn("the stress of the cell never came within 1 % of the wanted one: yy", warning)
            self.assertIn(words, warning)
        squares = "".join(f"[[grain]]\nposition = [{0.01 + 0.02 * i}, {0.01 + 0.02 * j}]\nradius = 0.01\n"
                          for i in range(5) for j in range(5))
        full = TWO[:TWO.index("[[grain]]")] + squares + TWO[TWO.index("[collisions]"):]
        done = equidem("run", self.write(full + cell.format(-1000.0, 1e-5)))
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertIn("the stress of the cell never came within 1 % of the wanted one: yy", " ".join(done.stdout.split()))

    def test_a_cell_that_misses_its_stress_in_any_stage_is_told(self):
        squares = "".join(f"[[grain]]\nposition = [{0.01 + 0.02 * i}, {0.01 + 0.02 * j}]\nradius = 0.01\n"
                          for i in range(5) for j in range(5))
        stages = "".join(f'[[stage]]\nname = "{name}"\nduration = {time}\n[stage.cell.servo]\nstress_yy = -1000.0\nmax_rate = {rate}\n'
                         for name, time, rate in (("slow", 0.01, 1e-5), ("fast", 0.5, 0.1), ("again", 0.01, 1e-9)))
        text = TWO[:TWO.index("[[grain]]")] + squares + TWO[TWO.index("[collisions]"):] + \
            '[cell]\nwidth = 0.1\nheight = 0.1\n[run]\nintegrator = "velocity_verlet"\n' + stages
        case, out = self.write(text), self.folder / "out"
        for options in ((), ("--resume",)):
            result = self.run_case(case, "--out", out, *options, *NO_PICTURE)
            servos = result["cell"]["servos"]
            self.assertEqual([(servo["stage"], servo["component"], servo["reached"]) for servo in servos],
                             [("slow", "yy", False), ("fast", "yy", True), ("again", "yy", True)])
            self.assertEqual([servo["overshoot"] is None for servo in servos], [True, False, False])
            self.assertGreater(servos[0]["stress"], 0.5 * servos[0]["wanted"])
            self.assertIn("the stress of the cell never came within 1 % of the wanted one: yy in the stage 'slow'; let it",
                          " ".join(result["report"].split()))
            (out / "run.checkpoint.h5").write_bytes((out / "run.slow.checkpoint.h5").read_bytes())

    def test_a_stress_of_a_cell_that_a_stage_does_not_name_goes_on_in_its_schedule(self):
        squares = "".join(f"[[grain]]\nposition = [{0.01 + 0.02 * i}, {0.01 + 0.02 * j}]\nradius = 0.0101\n"
                          for i in range(5) for j in range(5))
        rising = '[[schedule]]\nname = "rise"\nkind = "table"\ntimes = [0.0, 0.06]\nvalues = [0.5, 1.0]\n'
        text = TWO[:TWO.index("[[grain]]")] + squares + TWO[TWO.index("[collisions]"):] + rising + \
            '[cell]\nwidth = 0.1\nheight = 0.1\n[run]\nintegrator = "velocity_verlet"\ntime_step = 2.0e-5\n'
        stress = '[stage.cell.servo]\nstress_yy = -1000.0\nschedule = "rise"\nmax_rate = 0.1\n'
        other = '[stage.cell.servo]\nstress_xx = -500.0\nmax_rate = 0.1\n'

        def stage(name, duration, servo=""):
            return f'[[stage]]\nname = "{name}"\nduration = {duration}\n' + servo
        wanted = []
        for stages in (stage("a", 0.05, stress), stage("a", 0.01, stress) + stage("b", 0.02) + stage("c", 0.02),
                       stage("a", 0.01, stress) + stage("b", 0.02, other) + stage("c", 0.02)):
            servos = self.run_case(self.write(text + stages), "--out", self.folder / f"out{len(wanted)}", *NO_PICTURE)["cell"]["servos"]
            wanted.append([servo["wanted"] for servo in servos if servo["component"] == "yy"][-1])
        self.assertLess(wanted[0], -900)
        for other in wanted[1:]:
            self.assertAlmostEqual(other, wanted[0], delta=1e-9)

    def test_bonds_stiffer_than_the_step_bears_are_refused_with_the_step_that_they_bear(self):
        run = "[run]\nduration = 0.01\ntime_step = {}\n"
        for text, words in ((TOUCHING + BONDS.replace("1.0e6", "1.0e8") + run.format("7e-4"), ("run.time_step", "the bonds impose")),
                            (TOUCHING.replace("1.0e6", "1.0e3") + "[bonds]\nnormal_spring = 1.0e11\n" +
                             "[run]\ntime_step = 1e-5\n[[stage]]\nname = \"a\"\nduration = 0.001\n[[stage]]\nname = \"tie\"\n"
                             "duration = 0.01\n[stage.bonds]\ngap_tolerance = 0.01\n", ("stage 'tie'", "limit", "the bonds impose"))):
            with self.subTest(words=words):
                self.refused(text, *words)
        automatic = self.run_case(self.write(TOUCHING + BONDS.replace("1.0e6", "1.0e9") + "[run]\nduration = 1e-4\n"))
        self.assertLess(automatic["time_step"], automatic["bonds"]["critical_time_step"])

    def test_a_bond_without_strength_holds_while_it_carries_nothing_or_is_refused(self):
        run = "[run]\nduration = 1.0e-3\n"
        text = TOUCHING + BONDS + STRENGTH.format(0.0, 0.0) + run
        result = self.run_case(self.write(text))
        self.assertEqual(result["breaks"]["number"], 0)
        self.assertEqual(result["energy"]["kinetic"], 0)
        out = self.folder / "out"
        moves = text.replace("[0.04, 0.01]\n", "[0.04, 0.01]\nvelocity = [1.0e-6, 0.0]\n")
        result = self.run_case(self.write(moves), "--out", out, *NO_PICTURE)
        self.assertEqual(result["breaks"]["number"], 1)
        self.assertEqual(rows_of(out / "breaks.csv")[0]["step"], "1")
        for strength in ("-1.0", "nan", "inf"):
            self.refused(TOUCHING + BONDS + STRENGTH.format(strength, 1.0) + run, "case.toml:", "strength")

    def test_discs_that_overlap_under_a_bond_part_with_the_energy_of_the_overlap(self):
        overlap, speed = 1e-5, 1e-6
        text = TOUCHING.replace("[0.04, 0.01]", f"[{0.04 - overlap!r}, 0.01]\nvelocity = [{speed}, 0.0]") + BONDS + \
            STRENGTH.format(1e-4, 1.0) + '[run]\nduration = 0.01\nintegrator = "velocity_verlet"\n'
        energy = self.run_case(self.write(text))["energy"]
        stored = 0.5e6 * overlap**2
        self.assertLess(energy["initial"], 1e-4 * stored)
        self.assertAlmostEqual(-energy["lost_breaking"] / stored, 1, delta=1e-3)
        self.assertLess(abs(energy["relative_error"]), 1e-2)

    def test_too_much_energy_of_discs_that_overlapped_under_bonds_names_the_overlap(self):
        # two heavy discs throw a light one: it gets 1.5 k dt²/m times their energy by the first step
        head = TOUCHING[:TOUCHING.index("[[grain]]")]
        half = 0.01
        light = half * math.sqrt(3) - 2e-5
        text = head + f"[[grain]]\nposition = [0.0, {half}]\nradius = 0.01\ndensity = 1e6\n" + \
            f"[[grain]]\nposition = [0.0, {-half}]\nradius = 0.01\ndensity = 1e6\n" + \
            f"[[grain]]\nposition = [{light!r}, 0.0]\nradius = 0.01\nvelocity = [1e-6, 0.0]\n" + \
            "[collisions]\nlaw = \"linear_dashpot\"\nstiffness = 1.0e6\nrestitution = 1.0\n" + \
            "[bonds]\nnormal_spring = 1.0e3\ntangential_spring = 1.0e3\n[[bond]]\ngrains = [0, 2]\n[[bond]]\ngrains = [1, 2]\n" + \
            STRENGTH.format(1e-9, 1e-9)
        step = 1.9 / math.sqrt(1e6 / (2500 * math.pi * 1e-4))
        self.refused(text + f'[run]\nduration = {40 * step!r}\ntime_step = {step!r}\nintegrator = "semi_implicit_euler"\n',
                     "most of it set free by bonds that broke", "overlap by up to 1.73e-05 m under bonds", code=1)

    def test_everything_breaks_at_once_and_the_run_goes_on(self):
        # a ring whose discs fly apart alike: all bonds reach their strength in the same step
        count, radius = 12, 0.01
        ring = radius / math.sin(math.pi / count)
        turn = [2 * math.pi * k / count for k in range(count)]
        grains = "".join(f"[[grain]]\nposition = [{ring * math.cos(a)!r}, {ring * math.sin(a)!r}]\nradius = {radius}\n"
                         f"velocity = [{math.cos(a)!r}, {math.sin(a)!r}]\n" for a in turn)
        bonds = "".join(f"[[bond]]\ngrains = [{k}, {(k + 1) % count}]\n" for k in range(count))
        head = TWO[:TWO.index("[[grain]]")] + grains + TWO[TWO.index("[collisions]"):]
        text = head + bonds + "[bonds]\nnormal_spring = 1.0e6\ntangential_spring = 5.0e5\n" + STRENGTH.format(400.0, 900.0)
        out = self.folder / "out"
        result = self.run_case(self.write(text + '[run]\nduration = 5.0e-3\nintegrator = "velocity_verlet"\n'), "--out", out,
                               *NO_PICTURE)
        self.assertEqual(result["breaks"]["number"], count)
        breaks = rows_of(out / "breaks.csv")
        self.assertEqual({row["mode"] for row in breaks}, {"tension"})
        steps = {int(row["step"]) for row in breaks}
        self.assertLessEqual(max(steps) - min(steps), 1)  # round-off may split one step
        self.assertLess(abs(result["energy"]["relative_error"]), 1e-3)
        self.assertFalse(rows_of(out / "bonds.csv"))
        energy = result["energy"]
        self.assertAlmostEqual((energy["kinetic"] + energy["lost_breaking"]) / energy["initial"], 1, delta=1e-3)

    def test_a_cell_that_shears_past_many_periods_keeps_its_contacts_and_its_energy(self):
        random = numpy.random.default_rng(2)
        places = [(0.0205 * (i + 0.5), 0.0205 * (j + 0.5)) for i in range(5) for j in range(5)]
        grains = "".join(f"[[grain]]\nposition = [{x + random.uniform(-2e-4, 2e-4):.6f}, {y:.6f}]\nradius = 0.01\n" for x, y in places)
        head = TWO[:TWO.index("[[grain]]")] + grains + TWO[TWO.index("[collisions]"):]
        text = head + "[cell]\nwidth = 0.1025\nheight = 0.1025\n[cell.motion]\nxy = 40.0\n[output]\nprobe_interval = 1e-3\n" \
            '[run]\nduration = 0.2\nintegrator = "velocity_verlet"\n'
        out = self.folder / "out"
        result = self.run_case(self.write(text), "--out", out, *NO_PICTURE)
        history = table(out / "history.csv")
        self.assertAlmostEqual(history["cell_strain_xy"][-1], 8, delta=0.01)
        self.assertTrue((abs(history["cell_shift_m"]) <= 0.05125 * (1 + 1e-9)).all())
        self.assertGreater(numpy.sum(abs(numpy.diff(history["cell_shift_m"])) > 0.05), 5)  # it jumped by a period so often
        self.assertLess(abs(result["energy"]["relative_error"]), 5e-3)

    def test_a_cell_that_collapses_or_is_driven_too_fast_is_refused_by_what_does_it(self):
        cell = '[cell]\nwidth = 0.1\nheight = 0.1\n[cell.motion]\n{} = {}\n[run]\nduration = 0.1\nintegrator = "velocity_verlet"\n'
        self.refused(TWO + cell.format("yy", -20.0), "case.toml:", "cell: step", "has become", code=1)
        self.refused(TWO + cell.format("xy", 1e7), "run.time_step: step 0: bodies of the periodic cell would pass through",
                     "Use a step below", code=1)
        fast = TWO.replace("[0.05, 0.01]", "[0.05, 0.01]\nvelocity = [1e6, 0.0]")
        self.refused(fast + cell.format("xy", 1.0), "cell: grain 1 of the periodic cell moves", "pass through others")

    def test_wrong_changes_of_bodies_are_refused_with_their_line(self):
        def stage(text, first=""):
            return PRESS + "[run]\n[[stage]]\nname = \"a\"\nduration = 0.01\n" + first + \
                '[[stage]]\nname = "b"\nduration = 0.01\n' + text
        grain = "[[stage.grain]]\nposition = [0.035, 0.2]\nradius = 0.01\n"
        for text, words in (
                (stage("[[stage.remove]]\n"), ("stage.remove", "neither a group nor a box")),
                (stage('[[stage.remove]]\ngroup = "grain"\n'), ("stage.remove.group", "grains")),
                (stage("[[stage.remove]]\nbox = [1.0, 0.0, 0.0, 1.0]\n"), ("stage.remove.box", "empty")),
                (stage("[[stage.remove]]\nbox = [1.0, 0.0]\n"), ("stage.remove.box",)),
                (stage('[[stage.remove]]\ngroup = "grains"\n'), ("stage 'b'", "all bodies are removed")),
                (stage('[[stage.rename]]\ngroup = "grains"\n'), ("stage.rename.to", "missing")),
                (stage('[[stage.rename]]\ngroup = "grains"\nto = "walls"\n'), ("stage.rename.to", "all of them")),
                (stage('[[stage.rename]]\ngroup = "grains"\nto = "a b"\n'), ("stage.rename.to", "letters")),
                (stage('[[stage.rename]]\ngroup = "grains"\nto = ""\n'), ("stage.rename.to", "empty")),
                (stage('[[stage.rename]]\ngroup = "grains"\nto = "lid"\n'), ("both called 'lid'",)),
                (stage('[[stage.rename]]\nto = "x"\n'), ("stage.rename", "neither")),
                (stage(grain.replace("radius = 0.01\n", "")), ("stage.grain", "radius")),
                (stage(grain.replace("0.01", "-0.01", 1)), ("stage.grain.radius",)),
                (stage(grain.replace("0.01", "0.01\nmass = 1.0", 1)), ("unknown key",)),
                (stage(grain + grain), ("stage.1", "inside one another")),
                (stage(grain.replace("0.035, 0.2]", "0.025, 0.012]")), ("stage 'b'", "inside one another")),
                (stage(grain.replace("0.2]", "-0.5]")), ("stage 'b'", "behind wall")),
                (stage('[stage.grains]\npath = "none.csv"\n'), ("stage.grains.path", "none.csv")),
                (stage("", grain), ("first stage changes the grains",)),
                (stage("", "[[stage.remove]]\ngroup = \"grains\"\n"), ("first stage changes the grains",)),
                (stage(grain + '[[probe]]\nname = "p"\ngroup = "later"\n'), ("probe.group", "begins")),
                (stage(grain + '[[probe]]\nname = "p"\nbodies = [3]\n'), ("probe.bodies", "no body 3")),
                (stage('[[stage.pair]]\ngroup = "smooth"\nwith = "lid"\nfriction = 0.1\n'), ("smooth", "no group")),
                (stage("[stage.shake]\nacceleration = 1.0\n"), ("unknown",)),
                (stage("[stage.cell.motion]\nxy = 1.0\n"), ("stage.cell", "no [cell]"))):
            with self.subTest(text=text[len(PRESS):]):
                done = equidem("run", self.write(text), "--out", self.folder / "refused", "--overwrite", *NO_PICTURE)
                self.check_error(done, 2, *words)
                self.assertTrue("case.toml:" in done.stderr or "stage 'b'" in done.stderr, done.stderr)


if __name__ == "__main__":
    unittest.main()
