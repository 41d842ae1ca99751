#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""equidem-papers breakage, as a user does: run_papers_breakage.py PROGRAM SOURCE_FOLDER [unittest options]."""
import unittest

from program import ProgramTest, equidem, parse_json


class QuickBreakage(ProgramTest):
    def test_curves_stand_beside_theory_with_their_pictures(self):
        out = self.folder / "out"
        result = parse_json(self.check_done(equidem("breakage", "--quick", "--out", out, "--json", "-")).stdout)
        page = (out / "breakage.md").read_text(encoding="utf-8")
        for line in page.splitlines():
            if line.startswith("!["):
                self.assertTrue((out / line.split("(breakage/")[1].rstrip(")")).exists(), line)
        for name in ("notches_values.csv", "weibull_chains_values.csv", "weibull_plates_values.csv"):
            self.assertTrue((out / name).exists(), name)
        # Strength falls as the root of the length, with the toughness of the lattice.
        for fit in result["fits"]:
            self.assertGreater(fit["toughness"], fit["griffith"], fit)
            if fit["columns"] == 41:
                self.assertLess(abs(fit["exponent"] + 0.5), 0.015, fit)
        for ratio in {fit["ratio"] for fit in result["fits"]}:  # wider plates have longer notches of many discs
            fits = [fit for fit in result["fits"] if fit["ratio"] == ratio]
            narrow, wide = [abs(fit["toughness"] / fit["lattice"] - 1) for fit in fits]
            self.assertLess(wide, min(narrow, 0.02), ratio)
        for chain in result["chains"]:
            self.assertLess(abs(chain["strength"] - chain["weakest_link"]), 4.5 * chain["standard_error"], chain)
        # Larger plates are weaker, and scatter less.
        for modulus in (2, 4, 8):
            small, large = [plate for plate in result["plates"] if plate["modulus"] == modulus]
            self.assertLess(large["strength"], small["strength"])
            self.assertLess(large["standard_deviation"], small["standard_deviation"])
        self.assertLess(result["energies"]["error"], 1e-10)


if __name__ == "__main__":
    unittest.main()
