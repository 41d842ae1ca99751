#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""equidem-papers fujioka2005, as a user does: run_papers_fujioka2005.py PROGRAM SOURCE_FOLDER [unittest options]."""
import csv
import unittest

from program import ProgramTest, equidem, parse_json

FIGURES = ("figure4", "figure4_flights", "figure5", "figure6", "figure7", "figure10", "figure11", "stacked_cost", "ball_cost", "rest",
           "column", "lossless")


class Fujioka2005(ProgramTest):
    def test_tables_and_figures(self):
        out = self.folder / "out"
        result = parse_json(self.check_done(
            equidem("fujioka2005", "--quick", "--out", out, "--json", "-")).stdout)
        self.assertEqual(result["status"], "done")

        of_paper = {row["letter"]: row for row in reversed(result["table2"])}
        printed = {"C": [9, 10, 10], "T": [14, 23, 37], "F": [2, 1, 1], "P": [3, 3, 3]}
        for letter, steps in printed.items():
            self.assertEqual(of_paper[letter]["steps"], steps, letter)

        for row in result["fast_impacts"]:
            if row["letter"] in "FPX":
                self.assertEqual(len(row["energy_ratios"]), 20, row["letter"])
                for ratio in row["energy_ratios"]:
                    self.assertAlmostEqual(ratio, 0.49, delta=2e-4, msg=row["letter"])
            if row["letter"] == "C":
                self.assertGreater(row["deepest"], 1)

        slow = {row["letter"]: row for row in reversed(result["slow_impacts"])}
        for ratio in slow["P"]["energy_ratios"][:10]:
            self.assertAlmostEqual(ratio, 0.49, delta=2e-3)
        self.assertLess(slow["P"]["energy_ratios_of_flights"][9], 0.45)
        hertz = {row["a"]: row for row in result["fast_impacts"] if row["letter"] == "T"}
        self.assertTrue(hertz[4.62]["ran_away"])
        self.assertFalse(hertz[1.5]["ran_away"])
        self.assertLess(max(hertz[1.5]["energy_ratios"]), 0.7)
        self.assertGreater(min(hertz[1.5]["energy_ratios"]), 0.4)
        report = (out / "report.txt").read_text(encoding="utf-8")
        self.assertEqual(report.count("An evaluation of P costs +"), 1)
        self.assertIn("The conclusions of the paper", report)

        for row in result["stacked"]:
            error = min(zip(row["time_step"], row["speed_error"]))[1]
            if row["letter"] in "FPX":
                self.assertLess(error, 1e-5, row["label"])
                self.assertGreater(row["speed_order"], 1, row["label"])
        lag = {row["label"]: row["speed_order"] for row in result["stacked"]}
        self.assertLess(lag["C"], 0.3)
        self.assertGreater(lag["C, no lag"], 1.8)

        counts = {row["letter"]: row for row in reversed(result["table1"])}
        resting = 16 * (5 - 0.67763 * 1.7 / 0.3) / 1e-5
        for letter in "TFPX":
            self.assertAlmostEqual(counts[letter]["evaluations"] / resting, 1, delta=0.06, msg=letter)
        self.assertAlmostEqual(
            counts["P"]["evaluations_gravity_first"] / counts["F"]["evaluations_gravity_first"], 1.86, delta=0.02)

        for row in result["column"]:
            if row["letter"] == "X":
                self.assertLess(row["speed_of_g_dt"], 1e-4)
                self.assertAlmostEqual(row["overlap_of_static"], 1, delta=1e-6)
            elif row["letter"] in "FP":
                self.assertGreater(row["speed_of_g_dt"], 0.1)

        for name in FIGURES:
            for end in (".csv", ".gp", ".png"):
                self.assertTrue((out / (name + end)).exists(), name + end)
        with open(out / "table2.csv", newline="", encoding="utf-8") as file:
            rows = list(csv.DictReader(file))
        self.assertEqual([row["letter"] for row in rows], ["C", "T", "F", "P", "X", "X"])
        self.assertEqual((out / "report.txt").read_text(encoding="utf-8")[:8], "Fujioka ")

    def test_options_of_other_papers_are_refused(self):
        self.check_error(equidem("fujioka2005", "--rows", "5"), 2, "--rows", "fujioka2005")
        self.check_error(equidem("fujioka2006"), 2, "fujioka2005")

    def test_interrupted_it_stops_soon(self):
        stdout, _ = self.interrupt("fujioka2005")
        self.assertEqual(stdout, "")


if __name__ == "__main__":
    unittest.main()
