#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""equidem stability, as a user runs it: run_stability.py PROGRAM SOURCE_FOLDER [unittest options]."""
import csv
import json
import math
import unittest

from program import CASES, TENSION, ProgramTest, equidem, parse_json

LATTICE = CASES / "hexagonal_cell.toml"
RADIUS, DENSITY, KN = 0.005, 2500.0, 1e9
MASS = DENSITY * math.pi * RADIUS**2


class StabilityTest(ProgramTest):
    def stability(self, case, *options):
        return parse_json(self.check_done(equidem("stability", case, "--json", "-", *options)).stdout)

    def lattice(self, kind, ratio, *options):
        return self.stability(LATTICE, "--set", f"assembly.kind={kind}", "--set", f"springs.kT={ratio * KN!r}", *options)

    def check_relative(self, value, expected, tolerance):
        self.assertLessEqual(abs(value - expected), tolerance * abs(expected), f"{value} against {expected}")


class Lattices(StabilityTest):
    def test_the_hexagonal_lattice_is_lost_at_m(self):
        result = self.lattice("hexagonal", 0.5)
        self.assertLess(abs(result["critical_ratio"] + 1 / 3), 1e-10)
        self.assertEqual(result["critical_wave_vector_name"], "M")
        self.assertEqual([p["name"] for p in result["critical_wave_vectors"]], ["M", "M", "M"])
        self.check_relative(math.hypot(*result["critical_wave_vector"]), 2 * math.pi / (2 * math.sqrt(3) * RADIUS), 1e-12)
        self.assertEqual(result["primitive_cell"]["discs"], 1)
        self.assertEqual(result["primitive_cell"]["copies"], 16)
        self.assertEqual(result["status"], "stable")
        self.assertEqual(result["mechanisms"]["count"], 0)

    def test_frequencies_and_time_steps_of_f10(self):
        for ratio in (0, 0.2, 1 / 3, 0.5, 1):
            for body, beta in (("disc", 0.5), ("sphere", 0.4)):
                mass = MASS if body == "disc" else DENSITY * 4 / 3 * math.pi * RADIUS**3
                for kind, squared in (("hexagonal", max(6 + 2 * ratio, 12 * ratio / beta)),
                                      ("square", max(4 + 4 * ratio, 8 * ratio / beta))):
                    with self.subTest(ratio=ratio, body=body, kind=kind):
                        result = self.lattice(kind, ratio, "--set", f"assembly.body={body}")
                        omega = math.sqrt(squared * KN / mass)
                        self.check_relative(result["omega_max"], omega, 1e-10)
                        self.check_relative(result["zone_omega_max"], omega, 1e-10)
                        self.check_relative(result["critical_time_step"], 2 / omega, 1e-10)
                        self.assertLessEqual(result["element_bound_time_step"], result["critical_time_step"] * (1 + 1e-12))

    def test_sound_and_rotational_gap_of_f9(self):
        for ratio in (0.1, 0.5, 1):
            result = self.lattice("hexagonal", ratio)
            scale = KN * 4 * RADIUS**2 / MASS
            for key in ("longitudinal", "homogenized_longitudinal"):
                for speed in result["sound_speeds"][key]:
                    self.check_relative(speed, math.sqrt(0.375 * (3 + ratio) * scale), 1e-12)
            for key in ("transverse", "homogenized_transverse"):
                for speed in result["sound_speeds"][key]:
                    self.check_relative(speed, math.sqrt(0.375 * (1 + ratio) * scale), 1e-12)
            self.check_relative(result["rotational_gap"], math.sqrt(24 * ratio * KN / MASS), 1e-12)

    def test_the_square_lattice_is_lost_at_once_and_turns_like_gears(self):
        result = self.lattice("square", 0.5)
        self.assertEqual(result["critical_ratio"], 0)
        self.assertEqual(result["mechanisms"]["count"], 1)
        self.assertIn("gears", result["mechanisms"]["description"][0])
        self.assertEqual(result["status"], "mechanism")

    def test_negative_springs_are_stable_in_statics_and_grow_in_motion(self):
        result = self.lattice("hexagonal", -0.1)
        self.assertEqual(result["status"], "stable")
        self.assertEqual(result["negative_pivots"], 16)
        self.check_relative(result["growth_rate"], math.sqrt(24 * 0.1 * KN / MASS), 1e-10)
        self.assertEqual(result["growth_wave_vector_name"], "Gamma")
        self.check_relative(result["ratio_margin"], 1 / 3 - 0.1, 1e-9)
        self.assertIn("a maximum of the energy, not a minimum", " ".join(result["report"].split()))
        self.assertEqual(self.lattice("hexagonal", -0.34)["status"], "unstable")

    def test_times_scale_with_the_root_of_the_density(self):
        given = self.stability(LATTICE)
        text = "".join(line for line in LATTICE.read_text().splitlines(True) if "density" not in line)
        path = self.folder / "without_density.toml"
        path.write_text(text)
        assumed = self.stability(path)
        self.assertIs(given["density_assumed"], False)
        self.assertIs(assumed["density_assumed"], True)
        self.check_relative(assumed["critical_time_step"] * math.sqrt(DENSITY), given["critical_time_step"], 1e-12)
        self.assertIn("DENSITY ASSUMED", assumed["report"])

    def test_the_density_of_a_continuum_gives_that_of_the_discs(self):
        rock = self.stability(CASES / "packed_rock.toml", "--set", "packing.grains=50")
        self.assertIs(rock["density_assumed"], False)
        self.check_relative(rock["density"], 2300 / 0.82, 1e-12)


class OtherCases(StabilityTest):
    def test_free_edges_are_lost_before_the_lattice(self):
        known = {5: -0.3360, 11: -0.2754, 19: -0.2658}
        for size, ratio in known.items():
            result = self.stability(TENSION, "--set", f"assembly.columns={size}", "--set", f"assembly.rows={size}")
            self.assertAlmostEqual(result["critical_ratio"], ratio, delta=5e-5)
            self.assertIsNone(result["critical_wave_vector"])
            self.assertIn("critical_motion", result)

    def test_natural_frequencies_fall_with_the_size_of_the_sample(self):
        lowest = {}
        for size in (11, 21, 41):
            result = self.stability(TENSION, "--set", f"assembly.columns={size}", "--set", f"assembly.rows={size}",
                                    "--set", "assembly.density=2500", "--frequencies", "6")
            values = result["natural_frequencies"]
            self.assertEqual(len(values), 6)
            self.assertEqual(values, sorted(values))
            self.assertTrue(result["natural_frequencies_converged"])
            self.assertEqual(result["zero_energy_modes"], 0)
            self.check_relative(result["longest_period"] * values[0], 1, 1e-12)
            for hertz, omega, residual in zip(values, result["natural_omegas"], result["natural_omega_squared_error_bounds"]):
                self.check_relative(hertz, omega / (2 * math.pi), 1e-12)
                self.assertLessEqual(residual, 1e-6 * omega**2)
            self.assertLess(omega, result["omega_max"])
            lowest[size] = values[0]
        self.assertTrue(1.7 < lowest[11] / lowest[21] < 2.3, lowest)
        self.assertTrue(1.8 < lowest[21] / lowest[41] < 2.2, lowest)
        self.assertNotIn("natural_frequencies", self.stability(TENSION, "--frequencies", "0"))
        self.assertNotIn("natural_frequencies", self.stability(TENSION, "--set", "springs.kT=-0.1e9"))

    def test_mechanisms_have_no_natural_frequency(self):
        square = ("--set", "assembly.kind=square", "--set", "springs.kT=0", "--set", "assembly.columns=70",
                  "--set", "assembly.rows=70")
        result = self.stability(TENSION, *square)
        self.assertIsNone(result["natural_frequencies"])
        self.assertIn("zero-energy modes would have to be told apart", " ".join(result["report"].split()))
        few = self.stability(CASES / "hexagonal_cell.toml")
        self.assertEqual(few["zero_energy_modes"], 2)
        self.assertIn("above 2 zero-energy modes", " ".join(few["report"].split()))

    def test_a_random_cell(self):
        small = self.stability(CASES / "random_cell.toml", "--set", "assembly.discs=12")
        self.assertEqual(small["primitive_cell"]["discs"], small["discs"])
        for key in ("longitudinal", "transverse"):
            for speed, expected in zip(small["sound_speeds"][key], small["sound_speeds"]["homogenized_" + key]):
                self.check_relative(speed, expected, 1e-9)
        large = self.stability(CASES / "random_cell.toml")
        self.assertNotIn("rotational_gap", large)
        self.assertIn("Other waves were not searched", large["critical_ratio_searched"])
        for result in (small, large):
            self.assertTrue(-1 < result["critical_ratio"] < 0)
            self.assertLess(result["element_bound_time_step"], result["critical_time_step"])

    def test_a_cell_of_one_disc_has_only_the_waves_of_the_infinite_lattice(self):
        one = ("--set", "assembly.columns=1", "--set", "assembly.rows=1")
        for ratio in (0, -0.1):
            result = self.lattice("square", ratio, *one)
            self.assertEqual(result["omega_max"], 0)
            self.assertIsNone(result["critical_time_step"])
            self.check_relative(result["zone_omega_max"], math.sqrt(4 * KN / MASS), 1e-10)
            self.assertEqual(result["status"], "mechanism")
            self.assertGreater(result["mechanisms"]["free_waves"], 0)
            self.assertIn("that repeats with the cell", " ".join(result["report"].split()))
        self.check_relative(result["growth_rate"], math.sqrt(8 * 0.1 / 0.5 * KN / MASS), 1e-10)

    def test_magnitudes_beyond_numbers_are_refused(self):
        for key, value in (("density", "1e-300"), ("density", "1e300"), ("radius", "1e-100"), ("radius", "1e100")):
            self.check_error(equidem("stability", CASES / "random_cell.toml", "--set", "assembly.discs=30",
                                     "--set", f"assembly.{key}={value}"), 2, "1e")

    def test_what_is_said_about_negative_springs(self):
        grows = " ".join(self.lattice("hexagonal", -0.1)["report"].split())
        self.assertIn("with kT < 0 no time step is stable", grows)
        self.assertNotIn("stable below", grows)
        self.assertNotIn("guaranteed", grows)
        discs = [[x + y % 2, y * math.sqrt(3), 1] for y in range(2) for x in (0, 2)]
        contacts, springs = [], []
        for d, (x, y, _) in enumerate(discs):
            right, up = d ^ 1, (d + 2) % 4
            contacts += [[d, right, int(x > 1), 0], [d, up, 0, int(d > 1)]]
            # the other neighbour above: a column to the left from even rows, to the right from odd ones
            contacts += [[d, up ^ 1, (-1 if x < 1 else 0) if y == 0 else (1 if x > 2 else 0), int(d > 1)]]
            springs += [[1.0, 0.5], [1.0, 0.5], [1.0, -0.01 if d == 0 else 0.5]]
        (self.folder / "cell.json").write_text(json.dumps({
            "schema": "equidem-assembly/1", "cell": [4, 2 * math.sqrt(3)], "discs": discs, "contacts": contacts,
            "springs": springs}))
        case = self.folder / "cell.toml"
        case.write_text('schema = "equidem/1"\n[assembly]\nkind = "file"\npath = "cell.json"\n')
        report = " ".join(self.stability(case)["report"].split())
        self.assertIn("growth none: some kT are negative, but no motion has negative energy", report)

    def test_an_ensemble_is_not_judged_and_that_is_said(self):
        result = self.stability(CASES / "ensemble.toml", "--set", "assembly.discs=12")
        self.assertIn("not used [ensemble]", " ".join(result["report"].split()))

    def test_files(self):
        folder = self.folder / "waves"
        self.check_done(equidem("stability", LATTICE, "--out", folder, "--quiet"))
        with open(folder / "dispersion.csv", newline="") as file:
            rows = list(csv.DictReader(file))
        self.assertEqual([row["point"] for row in rows if row["point"]], ["Gamma", "M", "K", "Gamma"])
        translations = [row[f"omega_{branch}_rad_per_s"] for row in rows if row["point"] == "Gamma" for branch in (1, 2)]
        self.assertEqual(translations, ["0"] * 4)
        with open(folder / "critical_ratio.csv", newline="") as file:
            grid = list(csv.DictReader(file))
        self.assertEqual(len(grid), 48 * 48)
        self.assertAlmostEqual(max(float(row["critical_ratio"]) for row in grid), -1 / 3, delta=1e-12)
        for name in ("result.json", "case.toml", "dispersion_plot.svg", "dispersion_plot.png", "critical_ratio_plot.png"):
            self.assertTrue((folder / name).exists(), name)
        self.check_error(equidem("stability", LATTICE, "--out", folder), 2, "--overwrite")

    def test_dry_run_computes_nothing_but_says_how_much(self):
        result = self.stability(LATTICE, "--dry-run")
        self.assertEqual(result["status"], "dry_run")
        self.assertNotIn("critical_ratio", result)
        self.assertLess(result["element_bound_time_step"], self.stability(LATTICE)["critical_time_step"])


if __name__ == "__main__":
    unittest.main()
