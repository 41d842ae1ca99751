#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""equidem-papers and its papers on Abe (1996), as a user does: run_papers_abe1996.py PROGRAM SOURCE_FOLDER [unittest options]."""
import csv
import unittest

from program import ProgramTest, equidem, parse_json


def rows(path):
    with open(path, newline="", encoding="utf-8") as file:
        return list(csv.DictReader(file))


class Usage(ProgramTest):
    def test_help_lists_the_papers(self):
        for arguments in (["--help"], ["help"]):
            text = self.check_done(equidem(*arguments)).stdout
            for word in ("abe1996", "abe1996_random", "fujioka2005", "sukegawa2010", "Examples:", "Exit codes:"):
                self.assertIn(word, text)
        self.assertIn("--quick", self.check_done(equidem("fujioka2005", "--help")).stdout)

    def test_bad_usage_is_exit_code_2(self):
        self.check_error(equidem(), 2, "a paper is missing", "abe1996_random")
        self.check_error(equidem("abe1997"), 2, "unknown paper 'abe1997'", "'abe1996'")
        self.check_error(equidem("abe1996", "--quick"), 2, "unknown option", "--quick")
        self.check_error(equidem("abe1996_random", "--rows", "9"), 2, "--rows", "abe1996_random")


class Abe1996(ProgramTest):
    def test_tables_and_figures(self):
        out = self.folder / "out"
        result = parse_json(self.check_done(equidem("abe1996", "--rows", "9", "--columns", "9", "--out", out,
                                                    "--json", "-")).stdout)
        self.assertEqual((result["status"], result["paper"], result["rows"]), ("done", "abe1996", 9))
        self.assertAlmostEqual(result["critical_ratio_lattice"], -1 / 3)
        self.assertLess(result["macroscopic_stress"]["free_rotation_deviation"], 1e-12)
        for name in ("figure7.png", "figure8.csv", "error_by_size.gp", "tension.svg", "tension.vtm", "report.txt"):
            self.assertTrue((out / name).exists(), name)
        self.check_error(equidem("abe1996", "--rows", "9", "--out", out), 2, "figure7.csv", "--overwrite")


class Abe1996Random(ProgramTest):
    def test_quick_study_answers_in_sentences_tables_and_plots(self):
        out = self.folder / "out"
        report = self.check_done(equidem("abe1996_random", "--quick", "--out", out)).stdout
        for words in ("Errors of the mean field", "The correction (11)", "Best for nu"):
            self.assertIn(words, report)
        points = parse_json((out / "result.json").read_text())["points"]
        self.assertEqual(len(points), len(rows(out / "mean_field.csv")))
        for point in points:
            if point["points"] == "perturbed_hexagonal" and point["disorder"] == 0:
                self.assertAlmostEqual(point["poisson_ratio_error"]["mean"], 0, places=12)
                self.assertAlmostEqual(point["shear_modulus_error"]["mean"], 0, places=12)
            if point["weighting"] == "voronoi":
                self.assertAlmostEqual(point["bulk_modulus_error"]["mean"], 0, places=12)
        for name in ("poisson_ratio_uniform", "error_poisson_ratio_voronoi", "error_shear_modulus_contact_density"):
            self.assertTrue((out / (name + ".png")).exists(), name)


if __name__ == "__main__":
    unittest.main()
