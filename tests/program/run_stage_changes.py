#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Stages that change bodies, shake, deform a cell or begin from another run's checkpoint, as a user runs them:
run_stage_changes.py PROGRAM SOURCE_FOLDER [unittest options]."""
import csv
import unittest

import numpy

from motion import frames_of, needs_vtk, table
from program import equidem
from run_stages import NO_PICTURE, PRESS, StageTest

BOX = PRESS.split("[[wall]]\nname = \"lid\"")[0].replace("[collisions]", "[collisions]\nfriction = 0.4\ntangential_ratio = 0.5")
STAGES = BOX + """[run]
gravity = [0.0, -9.81]
[[stage]]
name = "settle"
duration = 2.0
[stage.until]
kinetic = 1e-6
unbalanced = 1e-3
[[stage]]
name = "pour"
duration = 2.0
[stage.until]
kinetic = 1e-6
unbalanced = 1e-3
[[stage.grain]]
position = [0.0351, 0.03]
radius = 0.01
group = "top"
[[stage.grain]]
position = [0.06, 0.04]
radius = 0.008
group = "top"
[[stage]]
name = "level"
duration = 0.1
[[stage.remove]]
group = "top"
box = [0.05, 0.0, 0.07, 0.06]
[[stage.rename]]
group = "top"
to = "smooth"
[[stage.pair]]
group = "smooth"
with = "grains"
friction = 0.0
[[stage]]
name = "last"
duration = 0.2
"""
OUTPUT = """[output]
probe_interval = 5.0e-3
frame_interval = 0.05
[[probe]]
name = "tops"
group = "top"
quantities = ["position", "velocity"]
"""
SHAKING = """[stage.shaking]
acceleration = 2.0
frequency = 20.0
cycles = 3
"""
CELL = """schema = "equidem/1"
[grains]
density = 2500.0
path = "grains.csv"
[collisions]
law = "linear_dashpot"
stiffness = 1.0e7
restitution = 0.3
friction = 0.4
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
[output]
probe_interval = 1.0e-3
[[stage]]
name = "consolidate"
duration = 0.3
[stage.until]
kinetic = 1e-4
unbalanced = 0.02
[[stage]]
name = "shear"
duration = 0.1
[stage.until]
strain = 0.05
component = "xy"
[stage.cell.motion]
xx = 0.0
xy = 1.0
[[stage]]
name = "stand"
duration = 0.01
[stage.cell.motion]
xx = 0.0
yy = 0.0
"""


def rows_of(path):
    with open(path, newline="") as file:
        return list(csv.DictReader(file))


class Bodies(StageTest):
    def test_grains_are_poured_taken_away_and_renamed(self):
        out = self.folder / "out"
        result = self.run_case(self.write(STAGES + OUTPUT), "--out", out, *NO_PICTURE)
        self.assertEqual([stage.get("added", 0) for stage in result["stages"]], [0, 2, 0, 0])
        self.assertEqual([stage.get("removed", 0) for stage in result["stages"]], [0, 0, 1, 0])
        self.assertEqual([stage.get("renamed", 0) for stage in result["stages"]], [0, 0, 1, 0])
        self.assertEqual((result["grains"], result["added_in_stages"]), (2, 2))
        self.assertIn("1 grain removed, 1 grain renamed", result["report"])
        grains = rows_of(out / "grains.csv")
        self.assertEqual([(row["grain"], row["number"], row["group"]) for row in grains],
                         [("0", "0", "grains"), ("1", "1", "grains"), ("2", "2", "smooth")])
        for contact in rows_of(out / "contacts.csv"):  # rows of grains.csv
            self.assertLess(int(contact["i"]), 3)
            if "2" in (contact["i"], contact["j"]) and contact["j"]:
                self.assertEqual(float(contact["tangential_force_N_per_m"]), 0)
        history = table(out / "history.csv")
        pour, level = (result["stages"][k]["start"] for k in (1, 2))
        before, on_top = history["time_s"] < pour - 1e-9, history["time_s"] > level + 1e-9
        self.assertTrue(numpy.isnan(history["tops_x_m"][before]).all())
        self.assertFalse(numpy.isnan(history["tops_x_m"][~before][1:]).any())
        numpy.testing.assert_allclose(history["tops_x_m"][on_top][-1], float(grains[2]["x_m"]), rtol=1e-12)
        self.assertLess(abs(result["energy"]["relative_error"]), 5e-3)
        self.assertLess(abs(result["energy"]["work_of_stages"]), 1e-3)

    @needs_vtk
    def test_frames_have_the_bodies_that_are_there(self):
        out = self.folder / "out"
        result = self.run_case(self.write(STAGES + OUTPUT), "--out", out, *NO_PICTURE)
        pour, level = (result["stages"][k]["start"] for k in (1, 2))
        for time, _, discs, contacts in frames_of(out):
            expected = [0, 1] if time <= pour else [0, 1, 2, 3] if time <= level else [0, 1, 2]
            with self.subTest(time=time):
                self.assertEqual(list(discs["body"]), expected)
                self.assertTrue(numpy.isfinite(discs["points"]).all())
                self.assertTrue(numpy.isfinite(contacts["points"]).all())
                self.assertLessEqual(set(contacts["i"]), set(expected))

    def test_what_is_read_back_goes_on_and_pages_are_drawn(self):
        out = self.folder / "out"
        self.run_case(self.write(STAGES + OUTPUT), "--out", out)
        for name in ("picture.png", "index.html", "energy_plot.png"):
            self.assertTrue((out / name).exists(), name)
        self.assertNotIn("NaN", (out / "index.html").read_text().replace("isNaN", ""))
        again = BOX.replace("density = 2500.0\n", f'path = "{out}/grains.csv"\n', 1)
        again = again[:again.index("[[grain]]")] + again[again.index("[collisions]"):]
        result = self.run_case(self.write(again + "[run]\nduration = 0.01\ngravity = [0.0, -9.81]\n"))
        self.assertEqual(result["grains"], 3)

    def test_a_run_that_changes_bodies_goes_on_from_each_stage_with_the_same_files(self):
        case, whole, parts = self.write(STAGES + OUTPUT), self.folder / "whole", self.folder / "parts"
        self.run_case(case, "--out", whole, *NO_PICTURE)
        self.run_case(case, "--out", parts, *NO_PICTURE)
        for stage in ("level", "pour", "settle"):
            (parts / "run.checkpoint.h5").write_bytes((parts / f"run.{stage}.checkpoint.h5").read_bytes())
            result = self.run_case(case, "--out", parts, "--resume", *NO_PICTURE)
            self.assertEqual(result["stages"][2]["removed"], 1)
            for name in ("history.csv", "grains.csv", "contacts.csv", "energy.csv", "frames.pvd"):
                self.assertEqual((whole / name).read_bytes(), (parts / name).read_bytes(), (stage, name))


    def test_a_choice_that_holds_no_grain_is_told_with_its_line(self):
        text = STAGES.replace("box = [0.05, 0.0, 0.07, 0.06]", "box = [0.2, 0.0, 0.3, 0.06]") + """[[stage.remove]]
box = [0.2, 0.0, 0.3, 0.03]
group = "smooth"
[[stage.rename]]
box = [5.0, 5.0, 6.0, 6.0]
to = "far"
"""
        case, out = self.write(text), self.folder / "out"
        lines = text.splitlines()
        level = lines.index("[[stage.remove]]") + 1
        last = len(lines) - lines[::-1].index("[[stage.remove]]"), len(lines) - 2
        for options in ((), ("--resume",)):
            result = self.run_case(case, "--out", out, *options, *NO_PICTURE)
            report = " ".join(result["report"].split())
            self.assertEqual(report.count("WARNING"), 3, report)
            for line, words in ((level, "stage.remove: the box of the stage 'level' held no grain"),
                                (last[0], "stage.remove: the box of the stage 'last' held no grain"),
                                (last[1], "stage.rename: the box of the stage 'last' held no grain")):
                self.assertIn(f"case.toml:{line}: {words}", report)
            self.assertIn("correct the box", report)
            if not options:
                (out / "run.checkpoint.h5").write_bytes((out / "run.level.checkpoint.h5").read_bytes())
        whole = self.run_case(self.write(STAGES), *NO_PICTURE)
        self.assertNotIn("WARNING", whole["report"])

    def test_a_group_and_a_box_together_choose_those_of_the_group_in_the_box(self):
        box = "box = [0.05, 0.0, 0.07, 0.06]\n"  # one of the two on top, and one of the two below
        out = self.folder / "out"
        text = STAGES.replace('[[stage.remove]]\ngroup = "top"\n' + box, "")
        both = text.replace('[[stage.rename]]\ngroup = "top"\n', '[[stage.rename]]\ngroup = "top"\n' + box)
        self.run_case(self.write(text), "--out", self.folder / "all", *NO_PICTURE)
        self.run_case(self.write(both), "--out", out, *NO_PICTURE)
        self.assertEqual([row["group"] for row in rows_of(self.folder / "all" / "grains.csv")],
                         ["grains", "grains", "smooth", "smooth"])
        self.assertEqual([row["group"] for row in rows_of(out / "grains.csv")], ["grains", "grains", "top", "smooth"])
        for key in ('group = "top"\n', box):
            self.refused(text.replace('[[stage.rename]]\ngroup = "top"\n', '[[stage.rename]]\nwall = "floor"\n' + key),
                         "case.toml:", "stage.rename", "both given")


class Branches(StageTest):
    def test_a_case_begins_with_the_state_at_the_end_of_a_stage_of_another_run(self):
        case, whole = self.write(STAGES), self.folder / "whole"
        direct = self.run_case(case, "--out", whole, *NO_PICTURE)
        start = whole / "run.level.checkpoint.h5"
        same = self.run_case(case, "--out", self.folder / "same", "--begin-from", start, *NO_PICTURE)
        self.assertEqual((whole / "grains.csv").read_bytes(), (self.folder / "same" / "grains.csv").read_bytes())
        self.assertEqual(same["energy"]["relative_error"], direct["energy"]["relative_error"])
        self.assertEqual(same["begun_from"], str(start))
        tilted = self.write(STAGES + "gravity = [3.0, -9.0]\n", "tilted.toml")
        branch = self.run_case(tilted, "--out", self.folder / "branch", "--begin-from", start, *NO_PICTURE)
        every = self.run_case(tilted, "--out", self.folder / "every", *NO_PICTURE)
        self.assertEqual((self.folder / "every" / "grains.csv").read_bytes(),
                         (self.folder / "branch" / "grains.csv").read_bytes())
        self.assertEqual([stage["steps"] for stage in branch["stages"]], [stage["steps"] for stage in every["stages"]])
        self.assertNotEqual((whole / "grains.csv").read_bytes(), (self.folder / "branch" / "grains.csv").read_bytes())

    def test_a_branch_that_is_interrupted_goes_on_with_the_step_that_it_has(self):
        case, whole, parts = self.write(STAGES + OUTPUT), self.folder / "whole", self.folder / "parts"
        stiffer = self.run_case(case, "--out", whole, *NO_PICTURE, "--set", "stage.3.collisions.stiffness=2e6")
        begin = ("--begin-from", whole / "run.settle.checkpoint.h5")
        one = self.run_case(case, "--out", self.folder / "one", *begin, *NO_PICTURE)
        self.run_case(case, "--out", parts, *begin, *NO_PICTURE)
        (parts / "run.checkpoint.h5").write_bytes((parts / "run.pour.checkpoint.h5").read_bytes())
        two = self.run_case(case, "--out", parts, "--resume", *NO_PICTURE)
        self.assertEqual(one["steps"], two["steps"])
        self.assertEqual((one["begun_from"], two["begun_from"]), (str(begin[1]), str(begin[1])))
        for result in (one, two):
            self.assertRegex(" ".join(result["report"].split()), "begun with the state in .*, stage 'settle'")
        self.assertEqual((one["time_step"], two["time_step"]), (stiffer["time_step"], stiffer["time_step"]))
        self.assertLess(two["time_step"], self.run_case(case, "--dry-run")["time_step"])
        for name in ("history.csv", "grains.csv", "energy.csv"):
            self.assertEqual((self.folder / "one" / name).read_bytes(), (parts / name).read_bytes(), name)

    def test_states_that_do_not_fit_are_refused_with_what_differs(self):
        case, out = self.write(STAGES), self.folder / "out"
        self.run_case(case, "--out", out, *NO_PICTURE)
        settled, level = (f"{out}/run.{stage}.checkpoint.h5" for stage in ("settle", "level"))

        def refused(start, *words, text=STAGES, options=()):
            self.check_error(equidem("run", self.write(text), "--begin-from", start, "--out", self.folder / "x", *options), 2,
                             *words)
            self.assertFalse((self.folder / "x").exists())
        refused(level, "'level'", "another one", "stiffness", options=("--set", "run.time_step=3e-5", "--set", "collisions.stiffness=9e5"))
        refused(level, "'level'", "another one", "friction = 0.1", text=STAGES.replace("friction = 0.0", "friction = 0.1"))
        refused(level, "'level'", "another one", "position", text=STAGES.replace("[0.06, 0.04]", "[0.06, 0.045]"))
        refused(settled, "this case needs", "time_step", options=("--set", "stage.3.collisions.stiffness=9e6"))
        refused(out / "run.checkpoint.h5", "'last' is over", "no other")
        refused(level, "3 stages have begun", "this case has 2", text=STAGES[:STAGES.index('[[stage]]\nname = "level"')])
        refused(level, "not in stages", text=BOX + "[run]\nduration = 1.0\n")
        refused(out / "grains.csv", "no checkpoint")
        refused(out / "none.h5", "no such file")
        refused(level, "--resume exclude", options=("--resume",))
        plain = self.folder / "plain"
        self.run_case(self.write(BOX + "[run]\nduration = 0.001\n", "plain.toml"), "--out", plain, *NO_PICTURE)
        refused(plain / "run.checkpoint.h5", "no run in stages")


class Shaking(StageTest):
    def test_a_box_shakes_within_its_stage_and_ends_where_it_was(self):
        out = self.folder / "out"
        text = STAGES + SHAKING + OUTPUT.replace("5.0e-3", "1.0e-3") + "[measures]\nregion = [0.0, 0.0, 0.07, 0.02]\n"
        result = self.run_case(self.write(text), "--out", out, *NO_PICTURE)
        history, start = table(out / "history.csv"), result["stages"][3]["start"]
        time, place = history["time_s"] - start, history["wall_floor_x_m"]
        amplitude = 2.0 / (2 * numpy.pi * 20) ** 2
        inside = (time > 0) & (time < 3 / 20)
        expected = amplitude * (1 - numpy.cos(2 * numpy.pi * 20 * time))
        numpy.testing.assert_allclose(place[inside], expected[inside], atol=2e-3 * amplitude)  # of a step
        numpy.testing.assert_allclose(place[(time <= 0) | (time > 3 / 20)], 0, atol=1e-12)
        self.assertAlmostEqual(result["stages"][3]["shaking"]["peak_acceleration"], 2.0)
        self.assertIn("in the stage 'last'", result["report"])
        self.assertLess(result["measures"]["time"]["before"], start + 1e-9)
        self.assertGreater(result["measures"]["time"]["before"], start - 1.1e-3)
        measures = table(out / "measures.csv")
        self.assertEqual(len(measures["time_s"]), len(history["time_s"]))

    def test_shaking_that_cannot_be_is_refused(self):
        still = "".join(f'[[stage.wall]]\nname = "{name}"\nshaken = false\n' for name in ("floor", "left", "right"))
        for text, words in ((SHAKING.replace("cycles = 3", "duration = 0.07"), ("stage.shaking.duration", "cycles")),
                            (SHAKING.replace("20.0", "-1.0"), ("stage.shaking.frequency",)),
                            (SHAKING + "record = \"r.csv\"\n", ("stage.shaking",)),
                            (SHAKING + still, ("stage.shaking", "no wall that shakes")),
                            (SHAKING + '[[stage.wall]]\nname = "floor"\nvelocity = [0.1, 0.0]\n', ("'floor' moves by itself",)),
                            (SHAKING.replace("cycles = 3\n", "start = 1.0\n"), ("stage.shaking.start", "begins to shake at 1"))):
            with self.subTest(text=text):
                self.refused(STAGES + text, "case.toml:", *words)
        self.refused(STAGES.replace('name = "last"\nduration = 0.2', 'name = "last"\nsteps = 20') +
                     SHAKING.replace("cycles = 3\n", ""), "stage.shaking", "Give cycles or duration")


class Cells(StageTest):
    def grains(self):
        random = numpy.random.default_rng(5)
        places = [(0.0095 * (i + 0.5), 0.0095 * (j + 0.5)) for i in range(8) for j in range(8)]
        rows = ["x,y,radius,short_half_axis"]
        for k, (x, y) in enumerate(places):
            dx, dy = random.uniform(-3e-4, 3e-4, 2)
            radius = random.uniform(0.0035, 0.0042)
            rows.append(f"{x + dx:.7f},{y + dy:.7f},{radius:.7f}," + (f"{0.8 * radius:.7f}" if k % 3 == 0 else ""))
        self.write("\n".join(rows) + "\n", "grains.csv")

    def test_a_cell_of_discs_and_ellipses_is_consolidated_and_sheared_in_stages(self):
        self.grains()
        out = self.folder / "out"
        result = self.run_case(self.write(CELL), "--out", out, *NO_PICTURE)
        self.assertEqual([stage["ended_by"] for stage in result["stages"]], ["met its end", "met its end", "duration"])
        history = table(out / "history.csv")
        start, end = result["stages"][1]["start"], result["stages"][2]["start"]
        shear = (history["time_s"] > start) & (history["time_s"] <= end)
        at = numpy.searchsorted(history["time_s"], start)
        self.assertAlmostEqual(history["cell_stress_xx_Pa"][at] / -1e5, 1, delta=0.05)
        self.assertAlmostEqual(history["cell_stress_yy_Pa"][at] / -1e5, 1, delta=0.05)
        self.assertAlmostEqual(history["cell_strain_xy"][shear][-1], 0.05, delta=2e-3)
        self.assertEqual(len(set(history["cell_width_m"][shear])), 1)
        self.assertGreater(history["cell_stress_xy_Pa"][shear][-1], 5e3)
        self.assertEqual(len(set(history["cell_height_m"][history["time_s"] > end])), 1)
        self.assertGreater(history["cell_coordination_number"][-1], 2.5)
        self.assertLess(abs(result["energy"]["relative_error"]), 5e-3)
        cut = self.folder / "cut"
        self.run_case(self.write(CELL), "--out", cut, "--begin-from", out / "run.consolidate.checkpoint.h5", *NO_PICTURE)
        self.assertEqual((out / "grains.csv").read_bytes(), (cut / "grains.csv").read_bytes())

    def test_cells_of_stages_given_wrong_are_refused_with_their_line(self):
        self.grains()
        no_cell = CELL[:CELL.index("[cell]")] + CELL[CELL.index("[run]"):]
        no_motion = no_cell.replace("[stage.cell.motion]\nxx = 0.0\nxy = 1.0\n", "")
        for text, words in ((no_motion, ("stage.until.component", "no cell")),
                            (no_cell.replace('strain = 0.05\ncomponent = "xy"', "kinetic = 1e-3"), ("stage.cell", "no [cell]")),
                            (CELL.replace('component = "xy"', 'component = "zz"'), ("stage.until.component", "xy")),
                            (CELL.replace('component = "xy"\n', ""), ("strain is given without", "component")),
                            (CELL.replace('component = "xy"\n', 'component = "xy"\nfrom = "a"\nto = "b"\n'), ("both given",)),
                            (CELL.replace("[run]", "[cell.motion]\nxy = 1.0\n[run]"), ("cell.motion", "outside of the stages")),
                            (CELL.replace("max_rate = 5.0\n", 'max_rate = 5.0\nschedule = "s"\n'), ("cell.servo.schedule",)),
                            (CELL.replace("xx = 0.0\nxy = 1.0", 'xy = 1.0\nschedule = "s"'), ("stage.cell.motion.schedule",)),
                            (CELL.replace("xx = 0.0\nxy = 1.0", "zz = 1.0"), ("unknown key",)),
                            (CELL.replace("velocity_verlet", "semi_implicit_euler"), ("velocity_verlet",)),
                            (CELL.replace("[run]", "[measures]\n[run]"), ("measures",))):
            with self.subTest(text=text[-300:]):
                self.refused(text, "case.toml:", *words)


if __name__ == "__main__":
    unittest.main()
