# SPDX-License-Identifier: GPL-3.0-or-later
"""Servo walls, histories of walls, stages and walls that they change, as a user runs them: run_stages.py PROGRAM SOURCE_FOLDER
[unittest options]."""
import math
import unittest

import numpy

from motion import RunTest, table
from program import CASES, NO_PICTURE, equidem, flat, rows_of
from scenes import (APART, BOX, FALLING, HEAD, LAW, LID, NAMED, PRESS, RENAME, RUN, SERVO, STAGES, TOUCHING, VERLET, grain,
                    loose_square, output, probe, schedule, stage, stage_wall)

RISING = schedule("rise", "table", "times = [0.0, 0.06]\nvalues = [0.5, 1.0]\n") + "[run]\ntime_step = 2.0e-5\n"


class Servos(RunTest):
    def test_the_force_is_held_and_told(self):
        out = self.folder / "out"
        result = self.run_case(self.write(PRESS + SERVO + RUN + output(1e-3)), "--out", out, VERLET, NO_PICTURE)
        servo, = result["servos"]
        self.assertEqual((servo["wall"], servo["wanted"], servo["reached"]), ("lid", 20, True))
        self.assertAlmostEqual(servo["force"], 20, delta=1e-4)
        self.assertEqual(result["units"]["servos.force"], "N/m")
        walls = {one["name"]: one for one in result["forces_on_walls"]}
        self.assertAlmostEqual(walls["floor"]["force"][1], -20, delta=1e-3)
        # both discs press the lid alike, 0.02 and 0.05 m to the right of its point
        self.assertAlmostEqual(walls["lid"]["moment"], 20 * 0.035, delta=1e-4)
        works = sum(one["work"] for one in walls.values())
        self.assertAlmostEqual(works / result["energy"]["work_of_walls"], 1, delta=1e-12)
        self.assertLess(abs(result["energy"]["relative_error"]), 0.02)
        history = table(out / "history.csv")
        self.assertAlmostEqual(history["wall_lid_force_y_N_per_m"][-1], 20, delta=1e-4)
        # the mean force between two rows is the change of the impulse
        mean = numpy.diff(history["wall_lid_impulse_y_N_s_per_m"])[-10:] / numpy.diff(history["time_s"])[-10:]
        self.check_near(mean, numpy.full(10, 20.0), 1e-3)
        self.assertEqual(history["wall_floor_work_J_per_m"][-1], 0)

    def test_the_force_on_a_wall_is_that_of_its_contacts(self):
        pressed = PRESS.replace("[0.0, 0.021]", "[0.0, 0.0199]") + "[run]\ntime_step = 2.0e-5\n" + stage("push", None,
                                                                                                         "steps = 100\n")
        for integrator in ("semi_implicit_euler", "velocity_verlet"):
            with self.subTest(integrator=integrator):
                by_contacts = []
                for steps in (100, 101):
                    out = self.folder / f"{integrator}_{steps}"
                    result = self.run_case(self.write(pressed), "--out", out, f"stage.0.steps={steps}",
                                           f"run.integrator={integrator}", NO_PICTURE)
                    by_contacts.append(sum(float(row["normal_force_N_per_m"]) for row in rows_of(out / "contacts.csv")
                                           if row["wall"] == "lid"))
                lid, = (one for one in result["forces_on_walls"] if one["name"] == "lid")
                of_step = by_contacts[1] if integrator == "semi_implicit_euler" else sum(by_contacts) / 2
                self.assertGreater(abs(by_contacts[1] - by_contacts[0]), 1e-3)
                self.assertAlmostEqual(lid["force"][1], of_step, delta=1e-10 * of_step)

    def test_a_servo_wall_that_wants_no_force_and_has_one_is_told(self):
        pressed = PRESS.replace("[0.0, 0.021]", "[0.0, 0.0199]") + "servo = { force = 0.0 }\n[run]\nduration = 1.0e-3\n"
        result = self.run_case(self.write(pressed), NO_PICTURE)
        servo, = result["servos"]
        self.assertGreater(servo["force"], 0)
        self.assertFalse(servo["reached"])
        self.assertIn("'lid'", flat(result["report"]).split("WARNING")[1])

    def test_a_servo_that_cannot_keep_its_force_tells_by_how_much(self):
        # at a thousandth of the speed it cannot follow its schedule
        slow = self.write(PRESS.replace("0.021]", "0.0200001]") + SERVO.replace("max_speed = 0.1", "max_speed = 1.0e-4") +
                          "[run]\nduration = 0.05\n")
        result = self.run_case(slow)
        servo, = result["servos"]
        self.assertFalse(servo["reached"])
        self.assertIsNone(servo["overshoot"])
        self.assertLess(servo["force"], 0.9 * servo["wanted"])
        self.assertIn("never came within 1 % of the wanted one: 'lid'", flat(result["report"]).split("WARNING")[1])
        # discs in flight, which it pushes before it
        thrown = HEAD + APART + LAW + LID + SERVO + "[run]\nduration = 0.2\n"
        servo, = self.run_case(self.write(thrown))["servos"]
        self.assertGreater(servo["mean_error"], 0.5)

    def test_a_servo_that_meets_no_body_is_warned_of_and_the_run_goes_on_from_its_end(self):
        out, whole = self.folder / "out", self.folder / "whole"
        case = self.write(PRESS + "servo = { force = 1.0, max_speed = 1e-4 }\n" + RUN + output(1e-3))
        for options in ((), ("--resume",)):
            result = self.run_case(case, "--out", out, NO_PICTURE, *options)
            servo, = result["servos"]
            self.assertEqual((servo["touched"], servo["reached"], servo["force"]), (False, False, 0))
            self.assertIn("WARNING servo walls met no body, and nothing was pressed: 'lid'", flat(result["report"]))
            self.assertIn("met no body", (out / "index.html").read_text())
        longer = "run.duration=0.11"
        self.assertGreater(self.run_case(case, "--out", out, NO_PICTURE, longer, "--resume")["time"], 0.1)
        self.run_case(case, "--out", whole, NO_PICTURE, longer)
        self.check_same_files(out, whole, "history.csv", "grains.csv")

    def test_a_servo_wall_that_has_gone_ends_the_run_with_what_it_has(self):
        away = "servo = { force = 1.0, max_speed = 10.0, direction = [0.0, 1.0] }\n"
        gone = self.folder / "gone"
        result = self.check_partial(equidem("run", self.write(PRESS + away + RUN), "--out", gone), "wall.servo: step",
                                    "'lid' has gone", "met no body", out=gone)
        servo, = result["servos"]
        self.assertEqual((servo["wall"], servo["touched"], result["complete"]), ("lid", False, False))
        self.assertLess(result["time"], 0.1)
        self.check_there(gone, "grains.csv", "contacts.csv", "energy.csv", "picture.png", "case.toml", "index.html")
        # of stages, those before it are named
        staged = PRESS + SERVO + "[run]\n" + stage("press", 0.01) + stage("fling", 10.0, stage_wall("lid", away))
        out = self.folder / "out"
        result = self.check_partial(equidem("run", self.write(staged), "--out", out, NO_PICTURE), "'lid'", out=out)
        self.assertEqual([one["ended_by"] for one in result["stages"]], ["duration", "not over"])

    def test_the_side_stress_of_a_biaxial_test_is_held_within_a_percent_and_the_work_closes(self):
        self.write(loose_square(7, 3), "small.csv")
        text = (CASES / "grains_biaxial.toml").read_text()
        for old, new in (('"biaxial.csv"', '"small.csv"'), ("0.2, 0.0]", "0.0665, 0.0]"), ("[0.0, 0.2]", "[0.0, 0.0665]"),
                         ("0.008]", "0.002]")):
            text = text.replace(old, new)
        out = self.folder / "out"
        result = self.run_case(self.write(text), "--out", out, "stage.2.until.strain=0.01", NO_PICTURE)
        self.assertEqual([one["ended_by"] for one in result["stages"]], ["met its end"] * 3)
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


class Stages(RunTest):
    def test_stages_follow_one_another_and_are_told(self):
        out = self.folder / "out"
        case = self.write(PRESS + SERVO + STAGES)
        result = self.run_case(case, "--out", out, VERLET)
        self.assertEqual([one["name"] for one in result["stages"]], ["press", "slide", "open"])
        self.assertEqual({one["ended_by"] for one in result["stages"]}, {"duration"})
        for before, after in zip(result["stages"], result["stages"][1:]):
            self.assertEqual(before["end"], after["start"])
        self.assertNotIn("friction", result["stages"][0]["effects"])
        self.assertIn("friction", result["stages"][2]["effects"])
        self.assertLess(abs(result["energy"]["relative_error"]), 0.03)
        self.assertLess(result["energy"]["work_of_stages"], 0)  # what the lid had pressed into the discs
        self.assertEqual([one["name"] for one in result["forces_on_walls"]], ["floor", "left", "right", "roof"])
        history = table(out / "history.csv")
        ends = [one["end"] for one in result["stages"]]
        self.assertTrue(set(ends) <= set(history["time_s"]))
        roof, lid = history["wall_roof_y_m"], history["wall_lid_y_m"]
        self.assertTrue(numpy.isnan(roof[history["time_s"] <= ends[1]]).all())
        self.assertTrue(numpy.isnan(lid[history["time_s"] > ends[1]]).all())
        self.assertFalse(numpy.isnan(lid[history["time_s"] <= ends[1]]).any())
        self.assertAlmostEqual(history["wall_left_x_m"][-1], 0.01 * (ends[1] - ends[0]), delta=1e-12)
        self.assertEqual([(servo["stage"], servo["wall"]) for servo in result["servos"]],
                         [("press", "lid"), ("slide", "lid"), ("open", "roof")])
        self.assertIn("motion", (out / "index.html").read_text())

    def test_the_report_of_stages_tells_what_acts_in_any_of_them(self):
        case = self.write(PRESS + SERVO + STAGES)
        for options in ((), ("--dry-run",)):
            report = self.report("run", case, *options, VERLET)
            for words in ("no friction", "no motion of walls", "no servo walls"):
                self.assertNotIn(words, report.split("law ")[0])
            self.assertIn("left (line, moves)", report)
            self.assertIn("roof (line, servo)", report)
            changed = report.split("from the stage 'open' on: restitution 0.3")[1]
            self.assertIn("friction 0.2", changed.split("time step")[0])

    def test_a_stage_that_never_rests_stops_at_its_limit_and_goes_on_with_a_longer_one(self):
        restless = FALLING + stage("settle", 0.004, "[stage.until]\nkinetic = 1e-6\nunbalanced = 1e-3\n") + output(1e-3)
        case = self.write(PRESS.replace("[0.02, 0.01]", "[0.02, 0.0105]") + restless)
        out, whole = self.folder / "out", self.folder / "whole"
        self.check_error(equidem("run", case, "--out", out, NO_PICTURE), 1, "stage 'settle'", "0.004", "--resume")
        longer = ("stage.0.duration=10", NO_PICTURE)
        result = self.run_case(case, "--out", out, "--resume", *longer)
        direct = self.run_case(case, "--out", whole, *longer)
        self.assertEqual(result["stages"][0]["ended_by"], "met its end")
        self.assertLessEqual(result["stages"][0]["unbalanced_force_ratio"], 1e-3)
        self.assertEqual(result["steps"], direct["steps"])
        self.check_same_files(whole, out, "history.csv", "grains.csv")

    def test_a_wall_that_a_schedule_moves_is_taken_away_with_its_motion(self):
        out = self.folder / "out"
        text = PRESS + schedule("down", "table", "times = [0.0, 1.0]\nvalues = [0.0, 1.0]\n") + "[run]\n" + \
            stage("push", 0.03, stage_wall("lid", 'displacement = 0.1\nschedule = "down"\n')) + \
            stage("free", 0.03, stage_wall("lid", "removed = true\n")) + output(1e-3) + \
            probe('name = "one"\nbodies = [0]\nquantities = ["position", "velocity"]\n')
        result = self.run_case(self.write(text), "--out", out, NO_PICTURE)
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
        walls = BOX.replace("point = [0.0, 0.0]\nnormal = [1.0", "point = [0.01, 0.0]\nnormal = [1.0") + LID
        law = LAW + "friction = 0.5\ntangential_ratio = 0.5\ntangential_damping = 0.3\n"
        smooth = stage("rough", 0.1) + stage("smooth", None, "steps = 2\n[stage.collisions]\nfriction = 0.0\n")
        again = stage("again", None, "steps = 1\n[stage.collisions]\nfriction = 0.5\n")
        for shape, bodies in (("disc", TOUCHING), ("ellipse", TOUCHING.replace("radius = 0.01", "half_axes = [0.01, 0.01]"))):
            for integrator in ("semi_implicit_euler", "velocity_verlet"):
                with self.subTest(shape=shape, integrator=integrator):
                    head = f'{HEAD}{bodies}{law}{walls}[run]\ngravity = [-2.0, -9.81]\nintegrator = "{integrator}"\n'
                    out, whole = self.folder / f"{shape}_{integrator}", self.folder / f"whole_{shape}_{integrator}"
                    self.run_case(self.write(head + smooth + output(1.0)), "--out", out, NO_PICTURE)
                    contacts = rows_of(out / "contacts.csv")
                    self.assertTrue(contacts)
                    for contact in contacts:
                        self.assertEqual(float(contact["tangential_force_N_per_m"]), 0, contact)
                    step = self.run_case(self.write(head + smooth + again + output(1.0)), "--out", whole, NO_PICTURE)["time_step"]
                    # each contact slips for one step, no faster than the rims of its bodies
                    rim = max(math.hypot(float(row["vx_m_per_s"]), float(row["vy_m_per_s"])) +
                              0.01 * abs(float(row["spin_rad_per_s"]))
                              for row in rows_of(whole / "grains.csv"))
                    slipped = 0.5 * 5.0e5 * len(contacts) * (rim * step) ** 2
                    stored = table(whole / "history.csv")["elastic_tangential_J_per_m"]
                    self.assertGreater(stored[1], 0)      # at the end of the first stage
                    self.assertEqual(stored[2], 0)
                    self.assertGreater(stored[1], 5 * slipped)
                    self.assertLessEqual(stored[3], slipped)


class Walls(RunTest):
    def test_a_wall_with_another_name_moves_pushes_and_is_told_as_before(self):
        out, other = self.folder / "out", self.folder / "other"
        result = self.run_case(self.write(NAMED), "--out", out, NO_PICTURE)
        unnamed = NAMED.replace(RENAME, "").replace('"plate"', '"lid"')
        plain = self.run_case(self.write(unnamed, "unnamed.toml"), "--out", other, NO_PICTURE)
        self.check_same_files(out, other, "grains.csv")
        history, expected, end = table(out / "history.csv"), table(other / "history.csv"), result["stages"][0]["end"]
        early = history["time_s"] <= end
        columns = [name for name in expected if name.startswith("wall_lid_")]
        self.assertTrue(any("work" in name for name in columns) and any("force" in name for name in columns), columns)
        for name in columns:
            now = name.replace("lid", "plate")
            self.assertTrue(numpy.isnan(history[now][early]).all() and numpy.isnan(history[name][~early]).all(), name)
            numpy.testing.assert_array_equal(numpy.where(early, history[name], history[now]), expected[name])
        for number, (servo, before) in enumerate(zip(result["servos"], plain["servos"])):
            self.assertEqual((servo["wall"], before["wall"]), ("plate" if number else "lid", "lid"))
            self.assertEqual({**servo, "wall": ""}, {**before, "wall": ""})
        self.assertEqual((len(result["servos"]), result["servos"][1]["wanted"]), (2, 10))
        self.assertEqual([one["name"] for one in result["forces_on_walls"]], ["floor", "left", "right", "plate"])
        self.assertEqual([one.get("renamed_walls") for one in result["stages"]], [None, [{"from": "lid", "to": "plate"}], None])
        self.assertIn("wall 'lid' renamed 'plate'", flat(result["report"]))

    def test_contacts_of_a_wall_with_another_name_go_by_that_name(self):
        discs = grain(0.02, 0.00999) + grain(0.04, 0.00999)
        smooth = "[[{}pair]]\ngroup = \"grains\"\nwith = \"{}\"\nfriction = 0.0\n"
        push = HEAD + discs + LAW + "friction = 0.4\n" + BOX + smooth.format("collisions.", "floor") + \
            "[run]\ngravity = [3.0, -9.81]\n" + stage("slide", 0.004) + stage("friction", 0.004)
        rename = '[[stage.rename]]\nwall = "floor"\nto = "ground"\n'
        before, rough, same = (self.run_case(self.write(push + more), VERLET)["energy"]["lost_slip"]
                               for more in ("", rename, rename + smooth.format("stage.", "ground")))
        self.assertEqual((before, same), (0, 0))
        self.assertGreater(rough, 0)

    def test_a_force_that_a_stage_does_not_name_goes_on_in_its_schedule(self):
        def first(duration):
            return PRESS + RISING + stage("a", duration, stage_wall("lid",
                                                                    'servo = { force = 20.0, schedule = "rise", max_speed = 0.1 }\n'))
        out, whole = self.folder / "out", self.folder / "whole"
        for integrator in ((), (VERLET,)):
            at_once = self.run_case(self.write(first(0.05)), "--out", whole, "--overwrite", *integrator, NO_PICTURE)
            case = self.write(first(0.03) + stage("b", 0.01, RENAME) + stage("c", 0.01))
            parts = self.run_case(case, "--out", out, *integrator, "--overwrite", NO_PICTURE)
            self.assertAlmostEqual(parts["servos"][-1]["wanted"], at_once["servos"][0]["wanted"], delta=1e-12)
            self.assertGreater(at_once["servos"][0]["wanted"], 18)
            heights = [[float(row["y_m"]) for row in rows_of(folder / "grains.csv")] for folder in (out, whole)]
            numpy.testing.assert_allclose(*heights, rtol=1e-12)
            for _ in self.go_on_from(out, "b"):
                again = self.run_case(case, "--out", out, "--resume", *integrator, NO_PICTURE)
                self.assertEqual(again["servos"], parts["servos"])

    def test_a_disc_passes_to_a_wall_that_a_stage_puts_next_to_another_as_over_one(self):
        text = """[grains]
density = 1800.0
[[grain]]
position = [-0.01, 1.998e-3]
radius = 2.0e-3
velocity = [0.25, 0.0]
[collisions]
law = "linear_dashpot"
stiffness = 110948.0      # m g/k = 2e-6 m
restitution = 1.0
[[wall]]
name = "first"
shape = "segment"
point = [-0.05, 0.0]
end = [0.0, 0.0]
[run]
gravity = [0.0, -9.81]
integrator = "velocity_verlet"
""" + output(2e-5, 'files = ["csv", "vtk"]\n') + stage("roll", 0.02) + \
            stage("pass", 0.06, '[[stage.rename]]\nwall = "first"\nto = "old"\n' +
                  stage_wall("second", 'shape = "segment"\npoint = [GAP, 0.0]\nend = [0.05, 0.0]\n'))
        for gap in ("3.0e-8", "3.0e-7", "3.0e-6", "-3.0e-6"):
            with self.subTest(gap=gap):
                out = self.folder / gap
                result = self.run_case(self.write(text.replace("GAP", gap)), "--out", out)
                self.assertNotIn("WARNING", result["report"])
                columns = table(out / "history.csv")
                force = sum(numpy.nan_to_num(columns[f"wall_{name}_force_y_N_per_m"]) for name in ("first", "old", "second"))
                weight = 1800 * numpy.pi * 2e-3**2 * 9.81
                self.assertLess(abs(force[1:] / weight + 1).max(), 1e-3)
        wide = self.run_case(self.write(text.replace("GAP", "1.0e-4")))
        self.assertIn('walls "old" and "second" end 0.0001 m apart', flat(wide["report"]))


if __name__ == "__main__":
    unittest.main()
