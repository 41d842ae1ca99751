#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""equidem-papers validation, as a user does: run_papers_validation.py PROGRAM SOURCE_FOLDER [unittest options]."""
import csv
import math
import pathlib
import tempfile
import unittest

from program import ProgramTest, equidem, parse_json

ITEMS = ["bond_dilution", "site_dilution", "adsorption", "jamming", "friction", "impacts", "lammps", "point_load", "disc_moduli"]


class QuickValidation(ProgramTest):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.kept = tempfile.TemporaryDirectory()
        cls.out = pathlib.Path(cls.kept.name) / "out"
        done = equidem("validation", "--quick", "--out", cls.out, "--json", "-")
        cls.result = parse_json(done.stdout)
        cls.items = {item["item"]: item for item in cls.result["items"]}

    @classmethod
    def tearDownClass(cls):
        cls.kept.cleanup()
        super().tearDownClass()

    def comparisons(self, item, *words):
        found = [c for c in self.items[item]["comparisons"] if all(word in c["quantity"] for word in words)]
        self.assertTrue(found, (item, words))
        return found

    def check_agree(self, item, *words):
        for c in self.comparisons(item, *words):
            self.assertTrue(c["agrees"], c)

    def check_trends(self, item):
        for trend in self.items[item]["trends"]:
            self.assertTrue(trend["holds"], trend)

    def test_all_items_are_compared_with_named_sources(self):
        self.assertEqual(list(self.items), ITEMS)
        page = (self.out / "validation.md").read_text(encoding="utf-8")
        for item in self.items.values():
            for row in item["comparisons"] + item["trends"]:
                self.assertTrue(row["source"] == "closed form" or f"**{row['source']}**" in page, row)
        with open(self.out / "comparisons.csv", newline="", encoding="utf-8") as file:
            self.assertEqual(len(list(csv.DictReader(file))), sum(len(item["comparisons"]) for item in self.items.values()))
        for line in page.splitlines():
            if line.startswith("!["):
                self.assertTrue((self.out / line.split("(validation/")[1].rstrip(")")).exists(), line)

    def test_a_verdict_follows_from_the_two_numbers_and_their_errors(self):
        verdicts = set()
        for item in self.items.values():
            for c in item["comparisons"]:
                difference = abs(c["ours"] - c["published"])
                error = math.hypot(c["published_error"], c["standard_error"])
                verdicts.add(c["agrees"])
                if not c["agrees"]:
                    self.assertGreater(difference, 2.5 * error, c)
                    self.assertIn("differs by", c["verdict"])
                    self.assertGreater(len(c["verdict"].split(": ", 1)[1]), 20, c)
        self.assertEqual(verdicts, {True, False})  # quick cells are too small for the threshold of sites

    def test_a_lattice_with_missing_bonds_is_rigid_from_p_of_0_6602_on(self):
        self.check_agree("bond_dilution", "threshold")

    def test_missing_bonds_soften_by_three_times_their_share(self):
        self.check_agree("bond_dilution", "slope")
        for c in self.comparisons("bond_dilution", "(1) at p = "):
            self.assertLess(abs(c["ours"] - c["published"]), 0.06, c)

    def test_missing_discs_soften_a_lattice_until_about_0_7(self):
        for c in self.comparisons("site_dilution", "extrapolated"):
            self.assertLess(abs(c["ours"] - c["published"]), 0.05, c)

    def test_random_adsorption_ends_at_a_coverage_of_0_547(self):
        self.check_agree("adsorption")

    def test_discs_jam_near_0_842_with_2n_minus_1_contacts(self):
        self.check_agree("jamming")
        self.check_trends("jamming")
        for c in self.comparisons("jamming", "contacts beyond"):
            self.assertLess(abs(c["ours"]), 0.1, c)

    def test_large_friction_brings_the_coordination_near_3(self):
        self.check_trends("friction")
        for c in self.comparisons("friction", "friction 10"):
            self.assertLess(abs(c["ours"] - 3), 0.2, c)

    def test_impacts_follow_hertz_and_coulomb(self):
        self.check_agree("impacts")
        self.check_trends("impacts")

    def test_trajectories_of_lammps_without_friction_are_repeated_to_its_ten_digits(self):
        for words in (("dem01, Hooke",), ("dem02",), ("dem03",), ("dem10",), ("dem11",), ("dem15",)):
            self.check_agree("lammps", *words)
        for c in self.comparisons("lammps", "dem0"):
            self.assertLess(abs(c["ours"] - c["published"]), 0.04 * abs(c["published"]), c)

    def test_a_point_load_presses_as_on_an_elastic_half_plane(self):
        self.check_agree("point_load")
        self.check_trends("point_load")

    def test_uniform_strain_overestimates_the_moduli_of_discs(self):
        self.check_trends("disc_moduli")


class Usage(ProgramTest):
    def test_one_item_alone_is_computed(self):
        result = parse_json(self.check_done(equidem("validation", "--quick", "--only", "lammps", "--json", "-")).stdout)
        self.assertEqual([item["item"] for item in result["items"]], ["lammps"])

    def test_items_that_do_not_exist_are_refused(self):
        self.check_error(equidem("validation", "--only", "weather"), 2, "weather")

    def test_interrupted_it_stops_soon(self):
        stdout, _ = self.interrupt("validation", "--quiet")
        self.assertEqual(stdout, "")


if __name__ == "__main__":
    unittest.main()
