# SPDX-License-Identifier: GPL-3.0-or-later
"""equidem study, and --accuracy of the other verbs, as a user asks for them: run_study.py PROGRAM SOURCE_FOLDER [unittest
options]."""
import signal
import time
import unittest

from program import CASES, CELL, SOURCE, STUDY, TENSION, ProgramTest, equidem, result_in, rows_of, started

STUDIES = SOURCE / "data" / "studies"
SHORT = ("--budget", 0, "--rounds", 3)
CANTILEVER, LATTICE = CASES / "cantilever.toml", CASES / "hexagonal_cell.toml"
BAR = (CASES / "run_pulse.toml", "assembly.columns=21", "assembly.rows=5", "run.duration=4e-4")


class Study(ProgramTest):
    def study(self, name, *options):
        return self.result("study", STUDIES / f"{name}.toml", *SHORT, *options)

    def test_a_study_file_gives_table_json_and_plot(self):
        out = self.folder / "out"
        result = self.study("abe_lattice", "--out", out)
        self.assertEqual((result["status"], result["rounds"]), ("done", 3))
        self.assertLessEqual({"processor", "cores", "compiler", "build", "version"}, set(result["machine"]))
        self.assertIn("equidem study", result["command"])
        self.assertEqual([order["method"] for order in result["orders"]], ["centre", "quarter"])
        for order in result["orders"]:
            self.assertLess(abs(order["observed_order"] - 1), 0.1)
            self.assertTrue(order["agrees"])
        errors = [row["errors"]["poisson_ratio"] for row in result["settings"] if row["method"] == "centre"]
        self.assertEqual(errors, sorted(errors, reverse=True))
        for row in result["settings"]:
            self.assertEqual(row["seconds"]["repetitions"], 3)
            self.assertLessEqual(row["seconds"]["lower_quartile"], row["seconds"]["median"])
            self.assertGreater(row["seconds"]["processor_median"], 0)
        self.check_there(out, "samples.csv", "result.json", "abe_lattice_poisson_ratio.png", "abe_lattice_poisson_ratio.gp")
        self.assertEqual(len(rows_of(out / "study.csv")), 10)

    def test_orders_are_those_of_theory(self):
        orders = {order["method"]: order for order in self.study("integrators")["orders"]}
        self.assertEqual({method: order["theoretical_order"] for method, order in orders.items()},
                         {"leapfrog": 2, "velocity_verlet": 2, "fourth_order": 4, "thesis": 1})
        # the error of a mean falls as the root of the number of cells
        for order in (*orders.values(), self.study("random_cells")["orders"][0]):
            self.assertTrue(order["agrees"], order)

    def test_each_study_of_the_data_is_read(self):
        found = [path for path in STUDIES.glob("*.toml") if "[study]" in path.read_text()]
        self.assertGreaterEqual(len(found), 4)
        for path in found:
            self.done("study", path, "--dry-run")

    def test_the_accuracy_asked_for_is_reached_or_refused(self):
        chosen = self.study("abe_lattice", "--accuracy", 0.03)["recommendations"][0]["setting"]
        self.assertLessEqual(chosen["errors"]["poisson_ratio"], 0.03)
        done = equidem("study", STUDY, *SHORT, "--accuracy", 1e-9, "--quiet")
        self.check_error(done, 1, "no setting reaches 1e-09", "the best one reaches")

    def test_bad_usage_is_refused(self):
        self.check_errors(
            ((STUDY, "--accuracy", -1), "not positive"), ((STUDY, "--accuracy", "inf"), "--accuracy", "'inf' is not a finite number"),
            *(((STUDY, "--budget", budget), "--budget", f"'{budget}' is not a number from 0 to 1e+07", "'equidem study --help'")
              for budget in ("nan", "inf", "-1", "1s", "")),
            ((STUDY, "--seed", "99999999999999999999"), "--seed", "is not a whole number from 0 to 9223372036854775807"),
            ("integrators", "is no file", "'equidem study data/studies/integrators.toml'"),  # the old name of a study
            ("effects", "is no file", "such as data/studies/integrators.toml"), ((), "not said what to study"), before=("study",))

    def test_a_second_run_goes_on_and_another_study_is_refused(self):
        out = self.folder / "out"
        command = ("study", STUDY, "--out", out, "--budget", 0, "--quiet")
        self.done(*command, "--rounds", 3)
        first = rows_of(out / "samples.csv")
        self.done(*command, "--rounds", 5)
        second = rows_of(out / "samples.csv")
        self.assertEqual(max(int(row["round"]) for row in second), 5)
        for row in first:
            self.assertIn(row, second)
        self.check_errors((("study", STUDIES / "random_cells.toml", *SHORT, "--out", out), "another study", "--overwrite"),
                          ((*command, "--seed", 2), "another study"))

    def test_another_case_of_the_same_settings_is_another_study(self):
        case = self.write((CASES / "hexagonal_cell.toml").read_text(), "cell.toml")
        study = self.write('[study]\nverb = "homogenize"\ncase = "cell.toml"\nmeasure = "shear_modulus"\ntruth = "known"\nvalue = 1e8\n'
                           '[[vary]]\nkey = "assembly.rows"\nvalues = [2, 4]\n', "study.toml")
        command = ("study", study, *SHORT, "--quiet", "--out", self.folder / "out")
        for _ in range(2):
            self.done(*command)
        case.write_text(case.read_text().replace("kT = 0.5e9", "kT = 0.25e9"))
        self.check_error(equidem(*command), 2, "another study", "--overwrite")

    def test_interrupted_it_keeps_what_it_has(self):
        out = self.folder / "out"
        running = started("study", STUDY, "--rounds", 100, "--out", out, "--budget", 600, "--quiet")
        begin = time.monotonic()
        while not (out / "samples.csv").exists() and time.monotonic() - begin < 60:
            time.sleep(0.05)
        running.send_signal(signal.SIGINT)
        _, told = running.communicate(timeout=60)
        self.assertEqual(running.returncode, 130, told)
        self.assertIn("Run the same command to go on", told)
        self.assertGreater(len(rows_of(out / "samples.csv")), 0)
        self.assertEqual(result_in(out)["status"], "interrupted")
        self.assertEqual([path for path in out.iterdir() if ".tmp" in path.name], [])

    def test_settings_that_cannot_be_computed_are_told(self):
        text = STUDY.read_text().replace("../cases/abe1996_fig6.toml", TENSION)
        study = self.write(text.replace("[9, 17, 33, 65, 129]", "[1, 9, 17]"))
        settings = self.result("study", study, *SHORT)["settings"]
        self.assertIn("refusal", settings[0])
        self.assertIn("errors", settings[1])
        study = self.write(text.replace('"poisson_ratio"', '"poison_ratio"'))
        self.check_error(equidem("study", study, *SHORT, "--quiet"), 1, "none of the settings", "poison_ratio")


class Accuracy(ProgramTest):
    def ask(self, verb, case, asked, *options):
        """(result, its part on accuracy) of a command with --accuracy."""
        result = self.result(verb, case, "--accuracy", asked, *options)
        accuracy = result["accuracy"]
        self.assertEqual(accuracy["requested"], asked)
        self.assertLessEqual(accuracy["estimated"], asked)
        self.assertIn("ten times more accuracy", result["report"])
        return result, accuracy

    def test_block_is_as_large_as_the_accuracy_needs_and_no_larger(self):
        rows = []
        for asked in (0.02, 0.004, 0.002):
            result, accuracy = self.ask("solve", TENSION, asked)
            error = max(abs(result["poisson_ratio"] - result["theory"]["poisson_ratio"]),
                        abs(result["stiffness_ratio"] / result["theory"]["stiffness_ratio"] - 1))
            self.assertLessEqual(error, asked)
            rows.append(accuracy["value"]["assembly.rows"])
            if rows[-1] > 9:
                self.assertGreater(error, asked / 1.5)
                more = accuracy["ten_times_more"]
                self.assertAlmostEqual(more["value"]["assembly.rows"] / (10 * rows[-1]), 1, delta=0.2)
                self.assertGreater(more["time_factor"], 100)
        self.assertEqual(rows, sorted(set(rows)))

    def test_case_written_is_the_one_chosen(self):
        out = self.folder / "out"
        result, _ = self.ask("solve", TENSION, 0.005, "--out", out)
        self.assertEqual(self.result("solve", out / "case.toml")["poisson_ratio"], result["poisson_ratio"])
        out = self.folder / "cells"
        result, accuracy = self.ask("homogenize", CELL, 0.01, "--out", out)
        size = self.result("homogenize", out / "case.toml")["ensemble"][0]
        for key in ("discs", "samples"):
            self.assertEqual(size[key], accuracy["value"][f"ensemble.{key}"])
        self.assertIn(size["shear_modulus"]["mean"], [one["shear_modulus"]["mean"] for one in result["ensemble"]])

    def test_more_accuracy_takes_more_cells(self):
        discs = []
        for asked in (0.03, 0.01, 0.004):
            accuracy = self.ask("homogenize", CELL, asked)[1]
            discs.append(accuracy["value"]["ensemble.discs"] * accuracy["value"]["ensemble.samples"])
            self.assertGreater(accuracy["ten_times_more"]["time_factor"], 5)
        self.assertEqual(discs, sorted(discs))
        self.assertLess(discs[0], discs[-1])

    def motions(self, *arguments):
        """Result, and the displacements of the discs at the end."""
        out = self.folder / "motions"
        result = self.result("run", *arguments, "--out", out, "--overwrite")
        return result, [float(row[u]) for row in rows_of(out / "discs.csv") for u in ("ux_m", "uy_m")]

    @staticmethod
    def error(found, exact):
        return max(abs(a - b) for a, b in zip(found, exact)) / max(map(abs, exact))

    def test_step_is_as_short_as_the_accuracy_needs_and_no_shorter(self):
        # A standing wave of a bar that a sine load drives, and the same with a step so short that nothing is left to gain.
        bar = (*BAR, 'schedule.0={name = "push", kind = "sine", value = 1.0, frequency = 3e3}')
        exact, steps = self.motions(*bar, "run.time_step=2e-8")[1], []
        for asked in (0.01, 0.001):
            result, found = self.motions(*bar, "--accuracy", asked)
            accuracy, error = result["accuracy"], self.error(found, exact)
            self.assertLessEqual(max(error, accuracy["estimated"]), asked)
            steps.append(accuracy["value"]["run.time_step"])
        self.assertAlmostEqual(accuracy["ten_times_more"]["time_factor"], 10**0.5, delta=1)
        self.assertGreater(error, 0.0005)
        self.assertLess(steps[1], steps[0])

    def test_steps_of_viscous_springs_are_found_by_their_true_order(self):
        text = (CASES / "run_shake.toml").read_text().replace("contact = 0.02", "contact = 0.0")
        for key, old, new in (("duration", "0.02 ", "0.002 "), ("columns ", " 10", " 5"), ("rows   ", " 35", " 9")):
            text = text.replace(f"{key} ={old}", f"{key} ={new}")
        case = self.write(text + '[viscoelastic]\nnormal = "kelvin_voigt"\ntangential = "kelvin_voigt"\ntauN = 5e-6\ntauT = 5e-6\n')
        exact = self.motions(case, "run.time_step=2e-8")[1]
        errors = [self.error(self.motions(case, f"run.time_step={step}")[1], exact) for step in (8e-7, 4e-7, 2e-7)]
        for coarse, fine in zip(errors, errors[1:]):
            self.assertAlmostEqual(coarse / fine, 2, delta=0.15, msg=errors)
        for asked in (0.01, 2e-4):
            result, found = self.motions(case, "--accuracy", asked)
            self.assertLessEqual(max(self.error(found, exact), result["accuracy"]["estimated"]), asked)
            self.assertRegex(result["report"], r"integrator +leapfrog, order 1 ")

    def test_what_is_more_accurate_than_asked_is_not_to_be_made_coarser_for_ten_times_more(self):
        for verb, case, asked, *options in (("solve", TENSION, 0.1, "springs.kT=0"), ("homogenize", CELL, 0.9),
                                            ("run", BAR[0], 0.9, *BAR[1:])):
            accuracy = self.ask(verb, case, asked, *options)[1]
            more = accuracy["ten_times_more"]
            self.assertLessEqual(accuracy["estimated"], 0.1 * asked)
            self.assertIn("has it already", more["note"])
            self.assertEqual((more["value"], more["time_factor"]), (accuracy["value"], 1))

    def test_assembly_that_is_given_is_known_to_its_bound(self):
        for verb, case in (("solve", CANTILEVER), ("homogenize", LATTICE)):
            self.assertEqual(self.ask(verb, case, 1e-9)[1]["value"], {})
            self.check_error(equidem(verb, case, "--accuracy", "1e-15"), 1, "cannot be reached", "is known to")

    def test_a_dry_run_says_how_an_accuracy_would_be_reached(self):
        for verb, case, told in (("solve", TENSION, "9 rows"), ("solve", CANTILEVER, "error bound is compared"),
                                 ("homogenize", LATTICE, "error bound is compared"), ("homogenize", CELL, "cells of"),
                                 ("run", BAR[0], "root 2")):
            self.assertIn(told, self.report(verb, case, "--accuracy", "1e-3", "--dry-run", "--out", self.folder / "out"))
            self.assertFalse((self.folder / "out").exists())

    def test_what_cannot_be_reached_gives_the_best_there_is_and_the_reason(self):
        out = self.folder / "out"
        best = self.check_partial(equidem("homogenize", CELL, "--accuracy", "1e-6", "--out", out), "cannot be reached",
                                  "reach about", out=out)
        self.assertIs(best["complete"], False)
        self.assertGreater(best["accuracy"]["estimated"], 1e-6)
        self.assertEqual(best["accuracy"]["requested"], 1e-6)
        self.check_there(out, "ensemble.csv")
        ask = ("--accuracy", "0.1")
        self.check_errors((("homogenize", CASES / "ensemble.toml", "assembly.periodic=false", *ask), "free boundaries"),
                          (("solve", TENSION, "--accuracy", "2"), "--accuracy"),
                          (("run", CASES / "run_tension.toml", *ask), "until_rest"),
                          (("run", CASES / "grains_cradle.toml", *ask), "collide"),
                          (("pack", CASES / "pack_jammed.toml", *ask), "takes no --accuracy", "solve"),
                          (("stability", CELL, *ask), "takes no --accuracy", "solve"))


if __name__ == "__main__":
    unittest.main()
