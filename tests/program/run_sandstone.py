# SPDX-License-Identifier: GPL-3.0-or-later
"""From a grading and a rock to springs, moduli, a static test and a wave: run_sandstone.py PROGRAM SOURCE_FOLDER."""
import pathlib
import shutil
import tempfile
import unittest

from program import CASES, ProgramTest, equidem, parse_json

YOUNG, NU = 20e9, 0.2


class Sandstone(ProgramTest):
    @classmethod
    def setUpClass(cls):
        """The calibrated rock, on which all cases are built."""
        super().setUpClass()
        cls.kept = tempfile.TemporaryDirectory()
        cls.cases = pathlib.Path(cls.kept.name) / "sandstone"
        shutil.copytree(CASES / "sandstone", cls.cases, ignore=shutil.ignore_patterns("rock", "out"))
        cls.calibrated = equidem("calibrate", cls.cases / "rock.toml", "--out", cls.cases / "rock", "--json", "-")

    @classmethod
    def tearDownClass(cls):
        cls.kept.cleanup()
        super().tearDownClass()

    def setUp(self):
        super().setUp()
        self.check_done(self.calibrated)

    def result_of(self, verb, case, *options):
        return self.result(verb, self.cases / case, *options)

    def test_the_commands_of_the_readme_lead_from_the_grading_to_the_wave(self):
        bonds = self.result_of("pack", "rock.toml")
        self.assertGreater(bonds["bonds"], 2 * bonds["grains"])
        found = parse_json(self.calibrated.stdout)
        cell = self.result_of("homogenize", "cell.toml")
        self.assertAlmostEqual(cell["young_modulus"]["plane_strain"] / YOUNG, 1, delta=1e-9)
        self.assertAlmostEqual(cell["poisson_ratio"]["plane_strain"], NU, delta=1e-9)
        test = self.result_of("solve", "tension.toml")
        self.assertAlmostEqual(test["fitted_young_modulus"] / YOUNG, 1, delta=0.1)
        self.assertAlmostEqual(test["fitted_poisson_ratio"], NU, delta=0.03)
        wave = self.result_of("run", "wave.toml")["waves"]["west"]
        self.assertAlmostEqual(wave["speed"] / found["wave_speeds"]["pressure"], 1, delta=0.003)
        self.assertAlmostEqual(wave["speed"] * wave["period"], wave["wavelength"], delta=1e-12)

    def test_loose_bodies_of_a_packing_are_left_out_of_the_static_test_and_named(self):
        packed = self.result_of("pack", "tension.toml")["grains"]
        test = self.result_of("solve", "tension.toml")
        self.assertGreater(len(test["left_out"]), 0)
        self.assertEqual(test["discs"] + len(test["left_out"]), packed)
        self.assertRegex(test["report"], r"left out +\d+ rattlers? \(disc \d+")
        self.assertLess(test["relative_residual"], 1e-14)

    def test_a_free_packing_stands_its_test_whatever_its_seed(self):
        small = ("packing.box=[0.04, 0.04]", "packing.solid_fraction=0.82")
        for seed in range(1, 9):
            with self.subTest(seed=seed):
                test = self.result_of("solve", "tension.toml", *small, f"packing.seed={seed}")
                self.assertLess(test["relative_residual"], 1e-14)
                self.assertAlmostEqual(test["fitted_young_modulus"] / YOUNG, 1, delta=0.2)  # free edges: softer


if __name__ == "__main__":
    unittest.main()
