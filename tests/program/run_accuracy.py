#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""--accuracy of the verbs, as a user asks for it: run_accuracy.py PROGRAM SOURCE_FOLDER [unittest options]."""
import csv
import time
import unittest

from program import CASES, TENSION, ProgramTest, equidem, parse_json

CELL = str(CASES / "random_cell.toml")
CANTILEVER = str(CASES / "cantilever.toml")


class Accuracy(ProgramTest):
    def ask(self, *arguments):
        result = parse_json(self.check_done(equidem(*arguments, "--json", "-")).stdout)
        accuracy = result["accuracy"]
        self.assertEqual(accuracy["requested"], float(arguments[arguments.index("--accuracy") + 1]))
        self.assertLessEqual(accuracy["estimated"], accuracy["requested"])
        self.assertIn("ten times more accuracy", result["report"])
        return result, accuracy

    def test_block_is_as_large_as_the_accuracy_needs_and_no_larger(self):
        rows = []
        for asked in (0.02, 0.004, 0.002):
            result, accuracy = self.ask("solve", TENSION, "--accuracy", str(asked))
            errors = [abs(result["poisson_ratio"] - result["theory"]["poisson_ratio"]),
                      abs(result["stiffness_ratio"] / result["theory"]["stiffness_ratio"] - 1)]
            self.assertLessEqual(max(errors), asked)
            rows.append(accuracy["value"]["assembly.rows"])
            if rows[-1] > 9:
                self.assertGreater(max(errors), asked / 1.5)
                more = accuracy["ten_times_more"]
                self.assertAlmostEqual(more["value"]["assembly.rows"] / (10 * rows[-1]), 1, delta=0.2)
                self.assertGreater(more["time_factor"], 100)
        self.assertEqual(rows, sorted(set(rows)))

    def test_case_written_is_the_one_chosen(self):
        out = self.folder / "out"
        result, accuracy = self.ask("solve", TENSION, "--accuracy", "0.005", "--out", str(out))
        again = parse_json(self.check_done(equidem("solve", out / "case.toml", "--json", "-")).stdout)
        self.assertEqual(again["poisson_ratio"], result["poisson_ratio"])

        out = self.folder / "cells"
        result, accuracy = self.ask("homogenize", CELL, "--accuracy", "0.01", "--out", str(out))
        again = parse_json(self.check_done(equidem("homogenize", out / "case.toml", "--json", "-")).stdout)
        size = again["ensemble"][0]
        self.assertEqual(size["discs"], accuracy["value"]["ensemble.discs"])
        self.assertEqual(size["samples"], accuracy["value"]["ensemble.samples"])
        self.assertIn(size["shear_modulus"]["mean"], [s["shear_modulus"]["mean"] for s in result["ensemble"]])

    def test_more_accuracy_takes_more_cells(self):
        discs = []
        for asked in ("0.03", "0.01", "0.004"):
            accuracy = self.ask("homogenize", CELL, "--accuracy", asked)[1]
            discs.append(accuracy["value"]["ensemble.discs"] * accuracy["value"]["ensemble.samples"])
            self.assertGreater(accuracy["ten_times_more"]["time_factor"], 5)
        self.assertEqual(discs, sorted(discs))
        self.assertLess(discs[0], discs[-1])

    def test_step_is_as_short_as_the_accuracy_needs_and_no_shorter(self):
        # A standing wave of a bar that a sine load drives, and the same with a step so short that nothing is left to gain.
        bar = [str(CASES / "run_pulse.toml"), "--set", "assembly.columns=21", "--set", "assembly.rows=5", "--set",
               "run.duration=4e-4", "--set", "schedule.0={name = \"push\", kind = \"sine\", value = 1.0, frequency = 3e3}"]

        def motions(*options):
            out = self.folder / str(len(list(self.folder.iterdir())))
            result = parse_json(self.check_done(equidem("run", *bar, "--out", out, "--json", "-", *options)).stdout)
            with open(out / "discs.csv", newline="", encoding="utf-8") as file:
                return result, [(float(row["ux_m"]), float(row["uy_m"])) for row in csv.DictReader(file)]

        exact = motions("--set", "run.time_step=2e-8")[1]
        largest = max(max(map(abs, u)) for u in exact)
        steps = []
        for asked in ("0.01", "0.001"):
            result, found = motions("--accuracy", asked)
            accuracy = result["accuracy"]
            error = max(max(abs(a[0] - b[0]), abs(a[1] - b[1])) for a, b in zip(found, exact)) / largest
            self.assertLessEqual(error, float(asked))
            self.assertLessEqual(accuracy["estimated"], float(asked))
            steps.append(accuracy["value"]["run.time_step"])
        self.assertAlmostEqual(accuracy["ten_times_more"]["time_factor"], 10**0.5, delta=1)
        self.assertGreater(error, 0.0005)
        self.assertLess(steps[1], steps[0])
        self.check_error(equidem("run", CASES / "run_tension.toml", "--accuracy", "0.1"), 2, "until_rest")
        self.check_error(equidem("run", CASES / "grains_cradle.toml", "--accuracy", "0.1"), 2, "collide")

    def test_steps_of_viscous_springs_are_found_by_their_true_order(self):
        case, out = self.folder / "viscous.toml", self.folder / "viscous"
        text = (CASES / "run_shake.toml").read_text().replace("contact = 0.02", "contact = 0.0")
        for key, old, new in (("duration", "0.02 ", "0.002 "), ("columns ", " 10", " 5"), ("rows   ", " 35", " 9")):
            text = text.replace(f"{key} ={old}", f"{key} ={new}")
        case.write_text(text + '[viscoelastic]\nnormal = "kelvin_voigt"\ntangential = "kelvin_voigt"\n'
                               'tauN = 5e-6\ntauT = 5e-6\n')

        def motions(*options):
            result = parse_json(self.check_done(
                equidem("run", case, "--out", out, "--overwrite", "--json", "-", *options)).stdout)
            with open(out / "discs.csv", newline="", encoding="utf-8") as file:
                return result, [float(row[u]) for row in csv.DictReader(file) for u in ("ux_m", "uy_m")]

        exact = motions("--set", "run.time_step=2e-8")[1]

        def error(found):
            return max(abs(a - b) for a, b in zip(found, exact)) / max(map(abs, exact))

        errors = [error(motions("--set", f"run.time_step={step}")[1]) for step in (8e-7, 4e-7, 2e-7)]
        for coarse, fine in zip(errors, errors[1:]):
            self.assertAlmostEqual(coarse / fine, 2, delta=0.15, msg=errors)
        for asked in (0.01, 2e-4):
            result, found = motions("--accuracy", str(asked))
            self.assertLessEqual(error(found), asked)
            self.assertLessEqual(result["accuracy"]["estimated"], asked)
            self.assertRegex(result["report"], r"integrator +leapfrog, order 1 ")

    def test_what_is_more_accurate_than_asked_is_not_to_be_made_coarser_for_ten_times_more(self):
        for arguments in (("solve", TENSION, "--set", "springs.kT=0", "--accuracy", "0.1"),
                          ("homogenize", CELL, "--accuracy", "0.9"),
                          ("run", str(CASES / "run_pulse.toml"), "--set", "assembly.columns=21", "--set", "assembly.rows=5",
                           "--set", "run.duration=4e-4", "--accuracy", "0.9")):
            accuracy = self.ask(*arguments)[1]
            more = accuracy["ten_times_more"]
            self.assertLessEqual(accuracy["estimated"], 0.1 * accuracy["requested"])
            self.assertIn("has it already", more["note"])
            self.assertEqual(more["value"], accuracy["value"])
            self.assertEqual(more["time_factor"], 1)

    def test_assembly_that_is_given_is_known_to_its_bound(self):
        for arguments in (("solve", CANTILEVER), ("homogenize", str(CASES / "hexagonal_cell.toml"))):
            accuracy = self.ask(*arguments, "--accuracy", "1e-9")[1]
            self.assertEqual(accuracy["value"], {})
            self.check_error(equidem(*arguments, "--accuracy", "1e-15"), 1, "cannot be reached", "is known to")

    def test_a_dry_run_says_how_an_accuracy_would_be_reached(self):
        for words, told in ((("solve", TENSION), "9 rows"), (("solve", CANTILEVER), "error bound is compared"),
                            (("homogenize", CASES / "hexagonal_cell.toml"), "error bound is compared"),
                            (("homogenize", CELL), "cells of"), (("run", CASES / "run_pulse.toml"), "root 2")):
            start = time.monotonic()
            done = self.check_done(equidem(*words, "--accuracy", "1e-3", "--dry-run", "--out", self.folder / "out"))
            self.assertIn(told, " ".join(done.stdout.split()))
            self.assertLess(time.monotonic() - start, 20)
            self.assertFalse((self.folder / "out").exists())

    def test_what_cannot_be_reached_gives_the_best_there_is_and_the_reason(self):
        out = self.folder / "out"
        best = self.check_partial(equidem("homogenize", CELL, "--accuracy", "1e-6", "--out", out), "cannot be reached",
                                  "reach about", out=out)
        self.assertIs(best["complete"], False)
        self.assertGreater(best["accuracy"]["estimated"], 1e-6)
        self.assertEqual(best["accuracy"]["requested"], 1e-6)
        self.assertTrue((out / "ensemble.csv").exists())
        self.check_error(equidem("homogenize", CASES / "ensemble.toml", "--set", "assembly.periodic=false", "--accuracy",
                                 "0.1"), 2, "free boundaries")
        self.check_error(equidem("solve", TENSION, "--accuracy", "2"), 2, "--accuracy")
        for verb, case in (("pack", "pack_jammed.toml"), ("stability", "random_cell.toml")):
            self.check_error(equidem(verb, CASES / case, "--accuracy", "0.1"), 2, "takes no --accuracy", "solve")


if __name__ == "__main__":
    unittest.main()
