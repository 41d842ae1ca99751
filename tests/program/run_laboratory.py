#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""The tests of the laboratory, on less time than the cases take: run_laboratory.py PROGRAM SOURCE_FOLDER [unittest options]."""
import math
import sys
import unittest

import numpy

from motion import RunTest
from program import CASES, SOURCE, equidem, parse_json

sys.path.insert(0, str(SOURCE / "tools" / "bench" / "laboratory"))
import readings  # noqa: E402

QUIET = ("--set", "output.picture=false")


class Laboratory(RunTest):
    def run_test(self, name, *options):
        out = self.folder / "out"
        return self.run_case(CASES / f"grains_{name}.toml", "--out", out, "--overwrite", *QUIET, *options), out


class Beam(Laboratory):
    def test_the_row_has_the_stiffness_of_statics_and_loses_what_its_dashpots_take(self):
        """Inertia adds (4 Hz over the first frequency, 79 Hz)^2 = 0.3 % to the stiffness at most, twice that to the loss."""
        result, out = self.run_test("bonded_beam")
        theory = readings.row_of_discs(20, 0.01, 1e5 / 12, 4e8, 0.005)
        read = readings.beam(out, 0.35, 1, 4)
        self.assertAlmostEqual(read["stiffness"] / theory["stiffness"], 1, delta=0.003)
        loss = theory["loss_over_square"] * read["amplitude"] ** 2
        self.assertAlmostEqual(read["lost"] / loss, 1, delta=0.006)
        self.assertAlmostEqual(read["loop"] / loss, 1, delta=0.006)
        self.assertEqual(result["breaks"]["number"], 0)

    def test_the_beam_breaks_in_its_middle_where_the_moment_reaches_its_strength(self):
        """6 M/w = tension, M = P (L/2 - l/2)/2: P = 2/0.095 (4e3 0.01/6) = 140.4 N/m; the way is P over the stiffness of the row."""
        result, out = self.run_test("bonded_beam", "--set", "wall.2.displacement=5e-4", "--set", "run.duration=0.1", "--set",
                                    "output.probe_interval=5e-5", "--set", "run.steps_per_contact=10")
        breaks = readings.rows_of_breaks(out)
        self.assertTrue({(one["bond"], one["mode"]) for one in breaks} <= {("9", "bending"), ("10", "bending")}, breaks)
        self.assertGreater(len(breaks), 0)
        read = readings.history(out)
        strength = 2 / 0.095 * 4e3 * 0.01 / 6
        self.assertAlmostEqual(read["wall_load_force_y_N_per_m"].max() / strength, 1, delta=0.02)
        theory = readings.row_of_discs(20, 0.01, 1e5 / 12, 4e8, 0.005)["stiffness"]
        at = float(breaks[0]["time_s"])
        bent = (read["ends_y_m"] - read["middle_y_m"])[read["time_s"] <= at].max()
        self.assertAlmostEqual(bent / (strength / theory), 1, delta=0.02)
        self.assertLess(abs(result["energy"]["relative_error"]), 1e-3)


class Rock(Laboratory):
    def test_the_gauges_of_the_unconfined_test_read_the_moduli_of_the_packing(self):
        """Between plates without friction; gauges are means over few discs: 6 % of E, 0.03 of nu."""
        _, out = self.run_test("unconfined", "--set", "run.duration=2.4e-3", "--set", "strength=none")
        moduli = parse_json(self.check_done(equidem("homogenize", CASES / "lab_rock.toml", "--json", "-", "--quiet")).stdout)
        read = readings.history(out)
        stress = (readings.mean_force(read, "top", "y") - readings.mean_force(read, "bottom", "y")) / 2 / 0.04
        along, across = read["upper_y_m"] - read["lower_y_m"], read["right_x_m"] - read["left_x_m"]
        late = stress > 0.3 * stress.max()
        found = readings.elastic(stress[late], readings.middle(1 - along / along[0])[late],
                                 readings.middle(across / across[0] - 1)[late])
        self.assertAlmostEqual(found["young_modulus"] / moduli["young_modulus"]["plane_stress"], 1, delta=0.06)
        self.assertAlmostEqual(found["poisson_ratio"], moduli["poisson_ratio"]["plane_stress"], delta=0.03)


class Heaps(Laboratory):
    def test_a_hopper_counts_what_has_left_it(self):
        """All bodies are above the gate before, and as many are missing above it as are counted below."""
        _, out = self.run_test("hopper", "--set", "stage.1.duration=0.12")
        read = readings.history(out)
        counted = read["out_inside"]
        self.assertEqual(counted[0], 0)
        self.assertTrue((numpy.diff(counted) >= 0).all())
        below = int((readings.columns_without_text(out / "grains.csv", ("y_m",))["y_m"] <= 0).sum())
        self.assertEqual(counted[-1], below)
        # 0.12 s at the steady rate of data/laboratory.md, 1269 a second, would be 152; the start is slower
        self.assertGreater(below, 60)
        self.assertLess(below, 152)

    def test_a_slope_of_a_known_angle_is_read(self):
        with open(self.folder / "grains.csv", "w", encoding="utf-8") as file:
            file.write("x_m,y_m,radius_m\n")
            for k in range(60):
                for row in range(1 + int((60 - k) * math.tan(math.radians(20)))):
                    file.write(f"{0.0025 * k},{0.0025 * row},0.00125\n")
        read = readings.slope(self.folder)
        self.assertAlmostEqual(read["angle"], 20, delta=3 * read["error"])
        self.assertLess(read["error"], 1)


class Sand(Laboratory):
    def test_the_shear_box_dilates_as_taylor_says(self):
        """T/N = (T/N) at the end + dy/dx at the peak, both from fits over some rows of 445 discs: within 3 degrees."""
        result, out = self.run_test("shear_box", "--set", "run.steps_per_contact=12")
        self.assertEqual([stage["ended_by"] for stage in result["stages"]], ["met its end"] * 3)
        read = readings.shear_box(out)
        self.assertGreater(read["dilation"], 0.2)
        self.assertLess(abs(read["taylor"] - read["peak"]), 3)
        # what moves the lower half acts on the upper half and on nothing else
        whole = readings.history(out, "shear")
        upper = sum(readings.mean_force(whole, wall, "x") for wall in ("lid", "upper_left", "upper_right", "roof"))
        lower = sum(readings.mean_force(whole, wall, "x") for wall in ("floor", "lower_left", "lower_right", "shelf"))
        self.assertLess(abs((upper + lower).mean()), 0.02 * abs(lower.mean()))


if __name__ == "__main__":
    unittest.main()
