#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Servo walls, histories of walls and stages, as a user runs them: run_stages.py PROGRAM SOURCE_FOLDER [unittest options]."""
import random
import shutil
import unittest

import numpy

from motion import RunTest, table
from program import CASES, equidem

BIAXIAL = CASES / "grains_biaxial.toml"
NO_PICTURE = ("--set", "output.files=['csv', 'vtk']")

PRESS = """schema = "equidem/1"
[grains]
density = 2500.0
[[grain]]
position = [0.02, 0.01]
radius = 0.01
[[grain]]
position = [0.05, 0.01]
radius = 0.01
[collisions]
law = "linear_dashpot"
restitution = 0.3
stiffness = 1.0e6
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
point = [0.07, 0.0]
normal = [-1.0, 0.0]
[[wall]]
name = "lid"
point = [0.0, 0.021]
normal = [0.0, -1.0]
"""
SERVO = 'servo = { force = 20.0, max_speed = 0.1 }\n'
RUN = "[run]\nduration = 0.1\n"
VERLET = ("--set", "run.integrator=velocity_verlet")
STAGES = """[run]
gravity = [0.0, -9.81]
[[stage]]
name = "press"
duration = 0.05
[[stage]]
name = "slide"
duration = 0.02
[[stage.wall]]
name = "left"
velocity = [0.01, 0.0]
[[stage]]
name = "open"
duration = 0.02
gravity = [0.0, 0.0]
[stage.collisions]
friction = 0.2
[[stage.wall]]
name = "lid"
removed = true
[[stage.wall]]
name = "roof"
point = [0.0, 0.025]
normal = [0.0, -1.0]
servo = { stress = 100.0, from = "left", to = "right", max_speed = 1.0 }
[output]
probe_interval = 1.0e-3
"""


class StageTest(RunTest):
    def write(self, text, name="case.toml"):
        path = self.folder / name
        path.write_text(text)
        return path

    def refused(self, text, *words, code=2):
        self.check_error(equidem("run", self.write(text), "--out", self.folder / "refused", "--overwrite"), code, *words)


class Servos(StageTest):
    def test_the_force_is_held_and_told(self):
        out = self.folder / "out"
        result = self.run_case(self.write(PRESS + SERVO + RUN + "[output]\nprobe_interval = 1e-3\n"), "--out", out,
                               *VERLET, *NO_PICTURE)
        servo, = result["servos"]
        self.assertEqual((servo["wall"], servo["wanted"], servo["reached"]), ("lid", 20, True))
        self.assertAlmostEqual(servo["force"], 20, delta=1e-4)
        self.assertEqual(result["units"]["servos.force"], "N/m")
        walls = {wall["name"]: wall for wall in result["forces_on_walls"]}
        self.assertAlmostEqual(walls["floor"]["force"][1], -20, delta=1e-3)
        # both discs press the lid alike, 0.02 and 0.05 m to the right of its point
        self.assertAlmostEqual(walls["lid"]["moment"], 20 * 0.035, delta=1e-4)
        works = sum(wall["work"] for wall in walls.values())
        self.assertAlmostEqual(works / result["energy"]["work_of_walls"], 1, delta=1e-12)
        self.assertLess(abs(result["energy"]["relative_error"]), 0.02)
        history = table(out / "history.csv")
        self.assertAlmostEqual(history["wall_lid_force_y_N_per_m"][-1], 20, delta=1e-4)
        # the mean force between two rows is the change of the impulse
        mean = numpy.diff(history["wall_lid_impulse_y_N_s_per_m"])[-10:] / numpy.diff(history["time_s"])[-10:]
        self.check_near(mean, numpy.full(10, 20.0), 1e-3)
        self.assertEqual(history["wall_floor_work_J_per_m"][-1], 0)

    def test_a_run_with_a_servo_goes_on_with_the_same_files(self):
        case = self.write(PRESS + SERVO + RUN + "[output]\nprobe_interval = 1e-3\n")
        whole, parts = self.folder / "whole", self.folder / "parts"
        self.run_case(case, "--out", whole, *NO_PICTURE)
        self.run_case(case, "--out", parts, "--set", "run.duration=0.043", *NO_PICTURE)
        self.run_case(case, "--out", parts, "--resume", *NO_PICTURE)
        for name in ("history.csv", "grains.csv", "contacts.csv"):
            self.assertEqual((whole / name).read_bytes(), (parts / name).read_bytes(), name)

    def test_each_key_given_wrong_is_refused_with_its_line(self):
        def servo(keys):
            return PRESS + f"servo = {{ {keys} }}\n" + RUN
        for keys, words in (("force = -1.0, max_speed = 0.1", ("wall.servo.force", "-1")),
                            ("force = 1.0, stress = 1.0, max_speed = 0.1", ("both given",)),
                            ("max_speed = 0.1", ("neither force nor stress",)),
                            ("force = 1.0, max_speed = 0.0", ("wall.servo.max_speed",)),
                            ("force = 1.0, max_speed = 0.1, relaxation = 1.5", ("wall.servo.relaxation",)),
                            ("force = 1.0, max_speed = 0.1, gain = 1.0", ("gain", "unknown key")),
                            ("force = 1.0, max_speed = 0.1, length = 1.0", ("length is given without stress",)),
                            ("stress = 1.0, max_speed = 0.1", ("no length to act on", "wall.servo")),
                            ("stress = 1.0, max_speed = 0.1, from = \"left\"", ("from is given without to",)),
                            ("stress = 1.0, max_speed = 0.1, from = \"left\", to = \"west\"", ("'west'", "no other wall")),
                            ("stress = 1.0, max_speed = 0.1, from = \"left\", to = \"floor\"", ("'floor'", "cross")),
                            ("force = 1.0, max_speed = 0.1, mirror = \"west\"", ("wall.servo", "'west'", "no wall of that name")),
                            ("force = 1.0, max_speed = 0.1, direction = [0.0, 0.0]", ("wall.servo.direction", "zero")),
                            ("force = 1.0, max_speed = 0.1, schedule = \"up\"", ("wall.servo.schedule", "up"))):
            with self.subTest(keys=keys):
                self.refused(servo(keys), "case.toml:", *words)
        pushed = 'servo = { force = 1.0, max_speed = 0.1 }\ndisplacement = 0.01\nschedule = "up"\n'
        up = '[[schedule]]\nname = "up"\nkind = "ramp"\nend = 1.0\n'
        self.refused(PRESS + pushed + up + RUN, "wall.servo", "'lid'", "displacement")
        self.refused(PRESS.replace('"linear_dashpot"', '"energy_map"') + SERVO + RUN, "'lid'", "map")
        sphere = PRESS.replace("[grains]\n", '[grains]\nbody = "sphere"\n')
        self.refused(sphere + 'servo = { stress = 1.0, length = 1.0, max_speed = 0.1 }\n' + RUN, "grains.body", "spheres")

    def test_export_refuses_what_no_engine_carries(self):
        for text, words in ((PRESS + SERVO + RUN, ("follow a force", "'lid'")),
                            (PRESS + SERVO.replace("servo", "# servo") + STAGES.replace("removed = true", ""), ("in stages",))):
            self.check_error(equidem("export", self.write(text), "--to", "lammps", "--out", self.folder / "model"), 2, *words)

    def test_a_servo_that_meets_no_body_is_warned_of_and_the_run_goes_on_from_its_end(self):
        out, whole = self.folder / "out", self.folder / "whole"
        text = PRESS + 'servo = { force = 1.0, max_speed = 1e-4 }\n' + RUN + "[output]\nprobe_interval = 1e-3\n"
        for options in ((), ("--resume",)):
            result = self.run_case(self.write(text), "--out", out, *NO_PICTURE, *options)
            servo, = result["servos"]
            self.assertEqual((servo["touched"], servo["reached"], servo["force"]), (False, False, 0))
            self.assertIn("WARNING servo walls met no body, and nothing was pressed: 'lid'", " ".join(result["report"].split()))
            self.assertIn("met no body", (out / "index.html").read_text())
        longer = ("--set", "run.duration=0.11")
        self.assertGreater(self.run_case(self.write(text), "--out", out, *NO_PICTURE, *longer, "--resume")["time"], 0.1)
        self.run_case(self.write(text), "--out", whole, *NO_PICTURE, *longer)
        for name in ("history.csv", "grains.csv"):
            self.assertEqual((out / name).read_bytes(), (whole / name).read_bytes(), name)
        text = PRESS + 'servo = { force = 1.0, max_speed = 10.0, direction = [0.0, 1.0] }\n' + RUN
        gone = self.folder / "gone"
        result = self.check_partial(equidem("run", self.write(text), "--out", gone), "'lid'", "met no body", out=gone)
        servo, = result["servos"]
        self.assertEqual((servo["wall"], servo["touched"], result["complete"]), ("lid", False, False))
        self.assertLess(result["time"], 0.1)
        for name in ("grains.csv", "contacts.csv", "energy.csv", "picture.png", "case.toml", "index.html"):
            self.assertTrue((gone / name).exists(), name)

    def test_a_stage_that_fails_leaves_the_result_of_those_before_it(self):
        out = self.folder / "out"
        text = PRESS + SERVO + ('[run]\n[[stage]]\nname = "press"\nduration = 0.01\n[[stage]]\nname = "fling"\n'
                                'duration = 10.0\n[[stage.wall]]\nname = "lid"\n'
                                'servo = { force = 1.0, max_speed = 10.0, direction = [0.0, 1.0] }\n')
        result = self.check_partial(equidem("run", self.write(text), "--out", out, *NO_PICTURE), "'lid'", out=out)
        self.assertEqual([stage["ended_by"] for stage in result["stages"]], ["duration", "not over"])


class Stages(StageTest):
    def test_stages_follow_one_another_and_are_told(self):
        out = self.folder / "out"
        case = self.write(PRESS + SERVO + STAGES)
        result = self.run_case(case, "--out", out, *VERLET)
        self.assertEqual([stage["name"] for stage in result["stages"]], ["press", "slide", "open"])
        self.assertEqual({stage["ended_by"] for stage in result["stages"]}, {"duration"})
        for before, after in zip(result["stages"], result["stages"][1:]):
            self.assertEqual(before["end"], after["start"])
        self.assertNotIn("friction", result["stages"][0]["effects"])
        self.assertIn("friction", result["stages"][2]["effects"])
        self.assertLess(abs(result["energy"]["relative_error"]), 0.03)
        self.assertLess(result["energy"]["work_of_stages"], 0)  # what the lid had pressed into the discs
        self.assertEqual([wall["name"] for wall in result["forces_on_walls"]], ["floor", "left", "right", "roof"])
        history = table(out / "history.csv")
        ends = [stage["end"] for stage in result["stages"]]
        self.assertTrue(set(ends) <= set(history["time_s"]))
        roof, lid = history["wall_roof_y_m"], history["wall_lid_y_m"]
        self.assertTrue(numpy.isnan(roof[history["time_s"] <= ends[1]]).all())
        self.assertTrue(numpy.isnan(lid[history["time_s"] > ends[1]]).all())
        self.assertFalse(numpy.isnan(lid[history["time_s"] <= ends[1]]).any())
        left = history["wall_left_x_m"]
        self.assertAlmostEqual(left[-1], 0.01 * (ends[1] - ends[0]), delta=1e-12)
        self.assertEqual([(servo["stage"], servo["wall"]) for servo in result["servos"]],
                         [("press", "lid"), ("slide", "lid"), ("open", "roof")])
        # the checkpoint at the end of a stage goes on to the same end
        parts = self.folder / "parts"
        shutil.copytree(out, parts)
        for stage in ("slide", "press"):
            shutil.copy(parts / f"run.{stage}.checkpoint.h5", parts / "run.checkpoint.h5")
            self.run_case(case, "--out", parts, "--resume", *VERLET)
            for name in ("history.csv", "grains.csv", "contacts.csv", "energy.csv"):
                self.assertEqual((out / name).read_bytes(), (parts / name).read_bytes(), name)
        self.assertIn("motion", (out / "index.html").read_text())

    def test_the_report_of_stages_tells_what_acts_in_any_of_them(self):
        case = self.write(PRESS + SERVO + STAGES)
        for options in ((), ("--dry-run",)):
            done = equidem("run", case, *options, *VERLET)
            self.assertEqual(done.returncode, 0, done.stderr)
            report = " ".join(done.stdout.split())
            for words in ("no friction", "no motion of walls", "no servo walls"):
                self.assertNotIn(words, report.split("law ")[0])
            self.assertIn("left (line, moves)", report)
            self.assertIn("roof (line, servo)", report)
            changed = report.split("from the stage 'open' on: restitution 0.3")[1]
            self.assertIn("friction 0.2", changed.split("time step")[0])

    def test_stages_that_are_interrupted_go_on_with_the_same_files(self):
        case = self.write(PRESS + SERVO + STAGES)
        long = ("--set", "stage.0.duration=20", "--set", "stage.1.duration=20", "--set", "stage.1.wall.0.velocity=[1e-4, 0.0]",
                "--set", "stage.2.duration=20", "--set", "output.checkpoint_interval=0.02", "--set",
                "output.probe_interval=0.1", *NO_PICTURE)
        whole, parts = self.folder / "whole", self.folder / "parts"
        self.run_case(case, "--out", whole, *long)
        for k in range(3):
            self.interrupt("run", case, "--out", parts, *(["--resume"] if k else []), "--threads", "1", *long,
                           when=(parts / "run.checkpoint.h5").exists, after=0.05)
        self.run_case(case, "--out", parts, "--resume", *long)
        for name in ("history.csv", "grains.csv", "contacts.csv", "energy.csv"):
            self.assertEqual((whole / name).read_bytes(), (parts / name).read_bytes(), name)
        self.check_error(equidem("run", case, "--out", parts, "--resume", *long, "--set", "stage.1.duration=30"), 2,
                         "another case")

    def test_a_stage_that_never_rests_stops_at_its_limit_and_goes_on_with_a_longer_one(self):
        restless = ('[run]\ngravity = [0.0, -9.81]\n[[stage]]\nname = "settle"\nduration = 0.004\n[stage.until]\n'
                    'kinetic = 1e-6\nunbalanced = 1e-3\n[output]\nprobe_interval = 1e-3\n')
        case = self.write(PRESS.replace("[0.02, 0.01]", "[0.02, 0.0105]") + restless)
        out, whole = self.folder / "out", self.folder / "whole"
        self.check_error(equidem("run", case, "--out", out, *NO_PICTURE), 1, "stage 'settle'", "0.004", "--resume")
        longer = ("--set", "stage.0.duration=10", *NO_PICTURE)
        result = self.run_case(case, "--out", out, "--resume", *longer)
        direct = self.run_case(case, "--out", whole, *longer)
        self.assertEqual(result["stages"][0]["ended_by"], "met its end")
        self.assertLessEqual(result["stages"][0]["unbalanced_force_ratio"], 1e-3)
        self.assertEqual(result["steps"], direct["steps"])
        for name in ("history.csv", "grains.csv"):
            self.assertEqual((whole / name).read_bytes(), (out / name).read_bytes(), name)

    def test_each_key_given_wrong_is_refused_with_its_line(self):
        def stage(text, servo=SERVO, run="[run]\n"):
            return PRESS + servo + run + '[[stage]]\nname = "a"\nduration = 0.01\n' + text
        wall = "[[stage.wall]]\nname = \"{}\"\n"
        mirror = 'servo = { force = 1.0, max_speed = 0.1, mirror = "floor" }\n'
        for text, words in ((PRESS + SERVO + "[run]\n", ("run.duration", "missing")),
                            (stage("", run=RUN), ("run.duration", "both given")),
                            (stage('[[stage]]\nname = "a"\nduration = 1.0\n'), ("two stages 'a'",)),
                            (stage('[[stage]]\nname = "b"\n'), ("neither duration nor steps",)),
                            (stage('[[stage]]\nname = "b c"\nduration = 1.0\n'), ("stage.name",)),
                            (stage("[stage.until]\n"), ("stage.until", "nothing is given")),
                            (stage("[stage.until]\nstrain = 0.1\n"), ("strain is given without from",)),
                            (stage('[stage.until]\nstrain = 0.1\nfrom = "left"\nto = "west"\n'), ("stage.until.to", "'west'")),
                            (stage('[stage.until]\nstrain = 0.1\nfrom = "left"\nto = "left"\n'), ("the same",)),
                            (stage('[stage.until]\ndisplacement = 0.1\nwall = "west"\n'), ("stage.until.wall", "'west'")),
                            (stage('[stage.until]\nkinetic = -0.1\n'), ("stage.until.kinetic",)),
                            (stage(wall.format("west") + "removed = true\n"), ("no wall \"west\"",)),
                            (stage(wall.format("west") + "velocity = [1.0, 0.0]\n"), ("'west' is a new wall", "point")),
                            (stage(wall.format("left") + "point = [1.0, 0.0]\n"), ("'left' is there already",)),
                            (stage(wall.format("left") + "removed = true\nvelocity = [1.0, 0.0]\n"), ("is removed, and",)),
                            (stage(wall.format("left") + "removed = true\nnormal = [1.0, 0.0]\n"), ("is removed, and",)),
                            (stage(wall.format("left") + 'shape = "segment"\n'), ("'left' is there already", "stage.wall.shape")),
                            (stage(wall.format("left") + "removed = true\n" + wall.format("left") +
                                   "point = [0.0, 0.0]\nnormal = [1.0, 0.0]\n"), ("two walls 'left'",)),
                            (stage(wall.format("left") + 'removed = true\n[[stage]]\nname = "b"\nduration = 0.1\n' +
                                   wall.format("left") + "point = [0.0, 0.0]\nnormal = [1.0, 0.0]\n"),
                             ("'left' is new", "an earlier one had that name")),
                            (stage(wall.format("left") + 'displacement = 0.001\nschedule = "step"\n') +
                             '[[schedule]]\nname = "step"\nkind = "table"\ntimes = [0.0, 1.0]\nvalues = [0.5, 1.0]\n',
                             ("'left' would jump", "stage.wall.schedule")),
                            (stage("steps = 10\n"), ("both given",)),
                            (stage("[stage.bonds]\n"), ("stage.bonds", "bonds")),
                            (stage("[stage.bonds]\ngap_tolerance = 2.0\nnormal_spring = 1.0\n"), ("gap_tolerance",)),
                            (stage("[stage.bonds]\nnormal_spring = -1.0\n"), ("stage.bonds.normal_spring",)),
                            (stage("[strength]\ntension = 1.0\nshear = 1.0\n"), ("no grains are tied",)),
                            (stage(wall.format("floor") + "removed = true\n", mirror), ("'floor' is removed", "mirror")),
                            (stage(wall.format("left") + "speed = 1.0\n"), ("unknown key",)),
                            (stage(wall.format("left") + 'displacement = 1.0\nschedule = "up"\n'), ("stage.wall.schedule",)),
                            (stage('[stage.collisions]\nfriction = -1.0\n'), ("stage.collisions.friction",)),
                            (stage('[[stage.pair]]\ngroup = "grains"\nwith = "west"\n'), ("west",)),
                            (stage("[shaking]\nacceleration = 1.0\nfrequency = 1.0\n"), ("shaking",))):
            with self.subTest(text=text[len(PRESS):]):
                self.refused(text, "case.toml:", *words)


class Biaxial(StageTest):
    """The case of a biaxial test with a small sample."""

    def small_case(self):
        random.seed(3)
        rows = [f"{0.0095 * (i + 0.5) + random.uniform(-4e-4, 4e-4):.7f},{0.0095 * (j + 0.5) + random.uniform(-4e-4, 4e-4):.7f},"
                f"{random.uniform(0.0035, 0.0042):.7f}" for i in range(7) for j in range(7)]
        self.write("x,y,radius\n" + "\n".join(rows) + "\n", "small.csv")
        text = BIAXIAL.read_text().replace('"biaxial.csv"', '"small.csv"').replace("0.2, 0.0]", "0.0665, 0.0]")
        return self.write(text.replace("[0.0, 0.2]", "[0.0, 0.0665]").replace("0.008]", "0.002]"))

    def test_the_side_stress_is_held_within_a_percent_and_the_work_closes(self):
        out = self.folder / "out"
        result = self.run_case(self.small_case(), "--out", out, "--set", "stage.2.until.strain=0.01", *NO_PICTURE)
        self.assertEqual([stage["ended_by"] for stage in result["stages"]], ["met its end"] * 3)
        self.assertLess(abs(result["energy"]["relative_error"]), 3e-3)
        history = table(out / "history.csv")
        shear = history["time_s"] > result["stages"][-1]["start"] + 0.01
        self.assertGreater(shear.sum(), 50)
        height = history["wall_top_y_m"] - history["wall_bottom_y_m"]
        width = history["wall_right_x_m"] - history["wall_left_x_m"]
        side = 0.5 * (history["wall_right_force_x_N_per_m"] - history["wall_left_force_x_N_per_m"]) / height
        axial = 0.5 * (history["wall_top_force_y_N_per_m"] - history["wall_bottom_force_y_N_per_m"]) / width
        self.check_near(side[shear], numpy.full(shear.sum(), 1e5), 0.01)
        self.assertGreater(axial[shear][-1], 1.3e5)
        # work of the walls: stress times change of strain, by the trapezoidal rule over the rows
        force_y, force_x = axial * width, side * height
        work = -numpy.trapz(force_y[shear], height[shear]) - numpy.trapz(force_x[shear], width[shear])
        told = sum(history[f"wall_{name}_work_J_per_m"] for name in ("left", "right", "bottom", "top"))[shear]
        self.assertAlmostEqual(work / (told[-1] - told[0]), 1, delta=0.01)
        self.check_near(told, history["work_of_walls_J_per_m"][shear], 1e-9)


if __name__ == "__main__":
    unittest.main()
