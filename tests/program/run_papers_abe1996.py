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
            for word in ("abe1996", "abe1996_random", "fujioka2005", "Examples:", "Exit codes:"):
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
        blocks = {row["block"]: row["poisson_ratio"] for row in result["error_of_nu"]}
        self.assertGreater(abs(blocks["9 rows of 9 discs, equal loads (Fig. 6)"]), 1e-2)
        self.assertLess(abs(blocks["9 rows of 9 discs, loads of the uniform state"]), 1e-11)
        self.assertLess(abs(blocks["periodic cell, homogenized"]), 1e-12)
        for row in result["square_lattice"]:
            self.assertAlmostEqual(row["poisson_ratio_rows"], 0, places=12)
            self.assertAlmostEqual(row["poisson_ratio_diagonal"], (1 - row["ratio"]) / 2, places=12)
            self.assertEqual(row["anisotropy"] < 1e-12, row["ratio"] == 1)
        for row in result["restrained_waves"]:
            self.assertAlmostEqual(row["poisson_ratio"], row["wanted_poisson_ratio"], places=12)
            self.assertAlmostEqual(row["shear_modulus"], 1, places=12)
        for row in result["unequal_radii"]:
            self.assertAlmostEqual(row["printed_mean_xx"], 1, places=9)
            self.assertAlmostEqual(row["scatter_xx"], 0.25, delta=0.05)
        for name in ("figure7.png", "figure8.csv", "error_by_size.gp", "figure6.svg", "figure7_plane_stress.csv",
                     "tension.vtm", "report.txt"):
            self.assertTrue((out / name).exists(), name)
        self.check_error(equidem("abe1996", "--rows", "9", "--out", out), 2, "figure7.csv", "--overwrite")


class Abe1996Random(ProgramTest):
    def test_quick_study_answers_in_sentences_tables_and_plots(self):
        out = self.folder / "out"
        report = self.check_done(equidem("abe1996_random", "--quick", "--out", out)).stdout
        for words in ("Errors of the mean field", "The correction (11)", "With a local psi", "Best for nu"):
            self.assertIn(words, report)
        points = parse_json((out / "result.json").read_text())["points"]
        self.assertEqual(len(points), len(rows(out / "mean_field.csv")))
        for point in points:
            if point["points"] == "perturbed_hexagonal" and point["disorder"] == 0:
                self.assertAlmostEqual(point["poisson_ratio_error"]["mean"], 0, places=12)
                self.assertAlmostEqual(point["shear_modulus_error"]["mean"], 0, places=12)
            if point["weighting"] == "local_contact_density" and point["points"] == "poisson_disc" \
                    and point["stretch"] == 1 and point["ratio"] == 0:
                self.assertLess(abs(point["poisson_ratio_error"]["mean"]), 0.015)
            if point["weighting"] == "voronoi":
                self.assertAlmostEqual(point["bulk_modulus_error"]["mean"], 0, places=12)
        for name in ("poisson_ratio_uniform", "error_poisson_ratio_voronoi", "error_shear_modulus_contact_density"):
            self.assertTrue((out / (name + ".png")).exists(), name)


if __name__ == "__main__":
    unittest.main()
