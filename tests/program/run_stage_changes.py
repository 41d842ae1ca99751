# SPDX-License-Identifier: GPL-3.0-or-later
"""Stages that change bodies, shake, deform a cell or begin from another run's checkpoint, as a user runs them:
run_stage_changes.py PROGRAM SOURCE_FOLDER [unittest options]."""
import unittest

import numpy

from motion import RunTest, frames_of, needs_vtk, table
from program import NO_PICTURE, equidem, flat, result_in, rows_of
from scenes import CHOSEN, FALLING, HEAD, POURED, POURED_OUTPUT, ROUGH_BOX, STAGED_CELL

TOP = '[[stage.rename]]\ngroup = "top"\n'



class Bodies(RunTest):
    def test_grains_are_poured_taken_away_and_renamed(self):
        out = self.folder / "out"
        result = self.run_case(self.write(POURED + POURED_OUTPUT), "--out", out)
        self.assertEqual([[one.get(change, 0) for one in result["stages"]] for change in ("added", "removed", "renamed")],
                         [[0, 2, 0, 0], [0, 0, 1, 0], [0, 0, 1, 0]])
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
        self.check_there(out, "picture.png", "index.html", "energy_plot.png")
        self.assertNotIn("NaN", (out / "index.html").read_text().replace("isNaN", ""))
        again = HEAD + 'path = "out/grains.csv"\n' + ROUGH_BOX[ROUGH_BOX.index("[collisions]"):] + FALLING + "duration = 0.01\n"
        self.assertEqual(self.run_case(self.write(again))["grains"], 3)

    @needs_vtk
    def test_frames_have_the_bodies_that_are_there(self):
        out = self.folder / "out"
        result = self.run_case(self.write(POURED + POURED_OUTPUT), "--out", out, NO_PICTURE)
        pour, level = (result["stages"][k]["start"] for k in (1, 2))
        for time, _, discs, contacts in frames_of(out):
            expected = [0, 1] if time <= pour else [0, 1, 2, 3] if time <= level else [0, 1, 2]
            with self.subTest(time=time):
                self.assertEqual(list(discs["body"]), expected)
                self.assertTrue(numpy.isfinite(discs["points"]).all())
                self.assertTrue(numpy.isfinite(contacts["points"]).all())
                self.assertLessEqual(set(contacts["i"]), set(expected))

    def test_a_choice_that_holds_no_grain_is_told_with_its_line(self):
        text = POURED.replace(CHOSEN, "box = [0.2, 0.0, 0.3, 0.06]\n") + """[[stage.remove]]
box = [0.2, 0.0, 0.3, 0.03]
group = "smooth"
[[stage.rename]]
box = [5.0, 5.0, 6.0, 6.0]
to = "far"
"""
        case, out = self.write(text), self.folder / "out"
        lines = case.read_text().splitlines()
        level, last = (number + 1 for number, line in enumerate(lines) if line == "[[stage.remove]]")
        self.run_case(case, "--out", out, NO_PICTURE)
        for again in ((), self.go_on_from(out, "level")):
            for _ in again:
                self.run_case(case, "--out", out, NO_PICTURE, "--resume")
            report = flat(result_in(out)["report"])
            self.assertEqual(report.count("WARNING"), 3, report)
            for line, words in ((level, "stage.remove: the box of the stage 'level' held no grain"),
                                (last, "stage.remove: the box of the stage 'last' held no grain"),
                                (len(lines) - 2, "stage.rename: the box of the stage 'last' held no grain")):
                self.assertIn(f"case.toml:{line}: {words}", report)
            self.assertIn("correct the box", report)
        self.assertNotIn("WARNING", self.run_case(self.write(POURED), NO_PICTURE)["report"])

    def test_a_group_and_a_box_together_choose_those_of_the_group_in_the_box(self):
        kept = POURED.replace('[[stage.remove]]\ngroup = "top"\n' + CHOSEN, "")  # both stay on top, one of them in the box
        for chosen, groups in (("", ["smooth", "smooth"]), (CHOSEN, ["top", "smooth"])):
            self.run_case(self.write(kept.replace(TOP, TOP + chosen)), "--out", self.folder / "out", "--overwrite", NO_PICTURE)
            self.assertEqual([row["group"] for row in rows_of(self.folder / "out" / "grains.csv")], ["grains", "grains", *groups])


class Branches(RunTest):
    def test_a_case_begins_with_the_state_at_the_end_of_a_stage_of_another_run(self):
        case, whole, same, branch, every = self.write(POURED), *(self.folder / name for name in ("whole", "same", "branch", "every"))
        direct = self.run_case(case, "--out", whole, NO_PICTURE)
        start = whole / "run.level.checkpoint.h5"
        begun = self.run_case(case, "--out", same, "--begin-from", start, NO_PICTURE)
        self.check_same_files(whole, same, "grains.csv")
        self.assertEqual((begun["energy"]["relative_error"], begun["begun_from"]), (direct["energy"]["relative_error"], str(start)))
        tilted = self.write(POURED + "gravity = [3.0, -9.0]\n", "tilted.toml")
        at_once = self.run_case(tilted, "--out", every, NO_PICTURE)
        branched = self.run_case(tilted, "--out", branch, "--begin-from", start, NO_PICTURE)
        self.check_same_files(every, branch, "grains.csv")
        self.assertEqual([one["steps"] for one in branched["stages"]], [one["steps"] for one in at_once["stages"]])
        self.assertNotEqual((whole / "grains.csv").read_bytes(), (branch / "grains.csv").read_bytes())

    def test_a_branch_that_is_interrupted_goes_on_with_the_step_that_it_has(self):
        case, whole, parts, straight = self.write(POURED + POURED_OUTPUT), *(self.folder / name for name in ("whole", "parts", "one"))
        stiffer = self.run_case(case, "--out", whole, NO_PICTURE, "stage.3.collisions.stiffness=2e6")
        begin = ("--begin-from", whole / "run.settle.checkpoint.h5")
        one = self.run_case(case, "--out", straight, *begin, NO_PICTURE)
        self.run_case(case, "--out", parts, *begin, NO_PICTURE)
        for _ in self.go_on_from(parts, "pour"):
            two = self.run_case(case, "--out", parts, "--resume", NO_PICTURE)
        self.assertEqual(one["steps"], two["steps"])
        for result in (one, two):
            self.assertEqual((result["begun_from"], result["time_step"]), (str(begin[1]), stiffer["time_step"]))
            self.assertRegex(flat(result["report"]), "begun with the state in .*, stage 'settle'")
        self.assertLess(two["time_step"], self.run_case(case, "--dry-run")["time_step"])
        self.check_same_files(straight, parts, "history.csv", "grains.csv", "energy.csv")

    def test_states_that_do_not_fit_are_refused_with_what_differs(self):
        out, plain, none = (self.folder / name for name in ("out", "plain", "none"))
        self.run_case(self.write(POURED), "--out", out, NO_PICTURE)
        self.run_case(self.write(ROUGH_BOX + "[run]\nduration = 0.001\n", "plain.toml"), "--out", plain, NO_PICTURE)
        settled, level = (f"{out}/run.{name}.checkpoint.h5" for name in ("settle", "level"))
        for start, text, options, *words in (
                (level, POURED, ("run.time_step=3e-5", "collisions.stiffness=9e5"), "'level'", "another one", "stiffness"),
                (level, POURED.replace("friction = 0.0", "friction = 0.1"), (), "'level'", "another one", "friction = 0.1"),
                (level, POURED.replace("[0.06, 0.04]", "[0.06, 0.045]"), (), "'level'", "another one", "position"),
                (settled, POURED, ("stage.3.collisions.stiffness=9e6",), "this case needs", "time_step"),
                (out / "run.checkpoint.h5", POURED, (), "'last' is over", "no other"),
                (level, POURED[:POURED.index('[[stage]]\nname = "level"')], (), "3 stages have begun", "this case has 2"),
                (level, ROUGH_BOX + "[run]\nduration = 1.0\n", (), "not in stages"),
                (out / "grains.csv", POURED, (), "no checkpoint"),
                (out / "none.h5", POURED, (), "no such file"),
                (level, POURED, ("--resume",), "--resume exclude"),
                (plain / "run.checkpoint.h5", POURED, (), "no run in stages")):
            with self.subTest(words=words):
                self.check_error(equidem("run", self.write(text), "--begin-from", start, "--out", none, *options), 2, *words)
                self.assertFalse(none.exists())


class Shaking(RunTest):
    def test_a_box_shakes_within_its_stage_and_ends_where_it_was(self):
        out = self.folder / "out"
        text = POURED + "[stage.shaking]\nacceleration = 2.0\nfrequency = 20.0\ncycles = 3\n" + \
            POURED_OUTPUT.replace("0.005", "1.0e-3") + "[measures]\nregion = [0.0, 0.0, 0.07, 0.02]\n"
        result = self.run_case(self.write(text), "--out", out, NO_PICTURE)
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
        self.assertEqual(len(table(out / "measures.csv")["time_s"]), len(history["time_s"]))


class Cells(RunTest):
    def test_a_cell_of_discs_and_ellipses_is_consolidated_and_sheared_in_stages(self):
        random, rows = numpy.random.default_rng(5), ["x,y,radius,short_half_axis"]
        for k, (i, j) in enumerate(numpy.ndindex(8, 8)):
            dx, dy = random.uniform(-3e-4, 3e-4, 2)
            radius = random.uniform(0.0035, 0.0042)
            rows.append(f"{0.0095 * (i + 0.5) + dx:.7f},{0.0095 * (j + 0.5) + dy:.7f},{radius:.7f}," +
                        (f"{0.8 * radius:.7f}" if k % 3 == 0 else ""))
        self.write("\n".join(rows) + "\n", "grains.csv")
        out, cut = self.folder / "out", self.folder / "cut"
        result = self.run_case(self.write(STAGED_CELL), "--out", out, NO_PICTURE)
        self.assertEqual([one["ended_by"] for one in result["stages"]], ["met its end", "met its end", "duration"])
        history = table(out / "history.csv")
        start, end = result["stages"][1]["start"], result["stages"][2]["start"]
        shear = (history["time_s"] > start) & (history["time_s"] <= end)
        at = numpy.searchsorted(history["time_s"], start)
        for component in ("xx", "yy"):
            self.assertAlmostEqual(history[f"cell_stress_{component}_Pa"][at] / -1e5, 1, delta=0.05)
        self.assertAlmostEqual(history["cell_strain_xy"][shear][-1], 0.05, delta=2e-3)
        self.assertEqual(len(set(history["cell_width_m"][shear])), 1)
        self.assertGreater(history["cell_stress_xy_Pa"][shear][-1], 5e3)
        self.assertEqual(len(set(history["cell_height_m"][history["time_s"] > end])), 1)
        self.assertGreater(history["cell_coordination_number"][-1], 2.5)
        self.assertLess(abs(result["energy"]["relative_error"]), 5e-3)
        self.run_case(self.write(STAGED_CELL), "--out", cut, "--begin-from", out / "run.consolidate.checkpoint.h5", NO_PICTURE)
        self.check_same_files(out, cut, "grains.csv")


if __name__ == "__main__":
    unittest.main()
