# SPDX-License-Identifier: GPL-3.0-or-later
"""Ensembles of random cells and of packings, as a user does: run_ensemble.py PROGRAM SOURCE_FOLDER [unittest options]."""
import math
import statistics
import unittest

from program import CASES, ENSEMBLE, ProgramTest, equidem, result_in, rows_of

ROCK = CASES / "packed_rock.toml"
SMALL = ("homogenize", ENSEMBLE, "ensemble.discs=[20, 60]", "ensemble.samples=6")
PACKED = ("homogenize", ROCK, "packing.grains=none", "ensemble={discs = [40, 80], samples = 4}")


class Ensemble(ProgramTest):
    def test_means_and_scatter_are_those_of_the_samples(self):
        out = self.folder / "out"
        result = self.result(*SMALL, "--out", out)
        self.assertEqual((result["status"], [size["discs"] for size in result["ensemble"]]), ("done", [20, 60]))
        for size in result["ensemble"]:
            samples = [row for row in rows_of(out / "samples.csv") if int(row["discs"]) == size["discs"]]
            self.assertEqual([int(row["seed"]) for row in samples], [1, 2, 3, 4, 5, 6])
            moduli = [float(row["shear_modulus_Pa"]) for row in samples]
            told = size["shear_modulus"]
            self.assertAlmostEqual(told["mean"] / statistics.mean(moduli), 1, places=13)
            self.assertAlmostEqual(told["standard_deviation"] / statistics.stdev(moduli), 1, places=12)
            self.assertAlmostEqual(told["standard_error"] * math.sqrt(6) / told["standard_deviation"], 1, places=13)
            low, high = told["confidence_interval"]
            self.assertTrue(low < told["mean"] < high)
            for key in ("plane_strain", "plane_stress"):
                self.assertIn("mean", size["poisson_ratio"][key])
                self.assertIn("mean", size["young_modulus"][key])
        needed = result["needed_discs"]["bulk_modulus_2d"]
        self.assertGreater(needed["one_cell"], needed["mean_of_samples"] - 1)
        self.assertGreater(result["scatter_exponent"]["shear_modulus"]["standard_error"], 0)

    def test_a_sample_is_the_cell_that_homogenize_gives_for_its_seed(self):
        text = ENSEMBLE.read_text(encoding="utf-8")
        cell = self.write(text[:text.index("[ensemble]")])
        for command, single, seeds in ((SMALL, (cell, "assembly.discs=60"), (1, 2)), (PACKED, (ROCK, "packing.grains=80"), (2, 3))):
            out = self.folder / single[1]
            size = self.result(*command, "--out", out)["ensemble"][1]
            self.assertGreater(size["shear_modulus"]["standard_deviation"], 0)
            rows = [row for row in rows_of(out / "samples.csv") if row["discs"] == single[1].split("=")[1]]
            moduli = {row["seed"]: float(row["shear_modulus_Pa"]) for row in rows if not row["refusal"]}
            for seed in seeds:
                alone = self.result("homogenize", *single, "--seed", seed)["shear_modulus"]
                self.assertAlmostEqual(alone / moduli[str(seed)], 1, places=13)
            self.assertAlmostEqual(size["shear_modulus"]["mean"] / statistics.mean(moduli.values()), 1, places=13)

    def test_springs_h_over_l_with_kT_equal_to_kN_need_no_size(self):
        self.assertIn("all cells agree to round-off",
                      self.report(*SMALL, "springs.weighting=voronoi", "springs.kT=1e9", "effects.rotation=restrained"))

    def test_interrupted_it_keeps_what_is_done_and_resume_gives_the_bits_of_an_uninterrupted_run(self):
        out, whole = self.folder / "out", self.folder / "whole"
        command = ("homogenize", ENSEMBLE, "ensemble.discs=[30]")
        stdout, stderr = self.interrupt(*command, "ensemble.samples=1000000", "--out", out,
                                        when=lambda: (out / "samples.csv").exists())
        self.assertIn("INCOMPLETE", stdout)
        self.assertIn("--resume", stderr)
        done = len(rows_of(out / "samples.csv"))
        self.assertGreater(done, 0)
        self.assertEqual(result_in(out)["status"], "interrupted")

        more = (*command, f"ensemble.samples={done + 5}")  # what the user may ask more of
        self.check_errors((("--out", out), "exists already"), *((("--out", out, "--resume", change), "another case") for change in (
            "springs.kT=0.2e9", "assembly.seed=2", "effects.rotation=restrained")), before=more)
        self.done(*more, "--out", out, "--resume")
        self.done(*more, "--out", whole)
        self.check_same_files(out, whole, "samples.csv", "ensemble.csv")
        self.assertTrue(result_in(out)["complete"])
        # fewer samples keep those that were computed
        fewer = self.result(*command, "ensemble.samples=2", "--out", out, "--resume")
        self.assertEqual(fewer["ensemble"][0]["samples"], 2)
        self.check_same_files(out, whole, "samples.csv")

    def test_packings_are_continued(self):
        out = self.folder / "out"
        self.done(*PACKED, "--out", out)
        before = (out / "samples.csv").read_text()
        self.assertIn("5 cells", self.report(*PACKED, "ensemble.samples=5", "--out", out, "--resume"))
        self.assertTrue((out / "samples.csv").read_text().startswith(before.split("\n80,")[0]))

    def test_damaged_samples_are_not_continued(self):
        out = self.folder / "out"
        self.done(*SMALL, "--out", out)
        table = out / "samples.csv"
        text = table.read_text()
        for damaged in (text.replace("seed", "sead", 1), text.replace("\n20,1,", "\n20,one,"),
                        text[:text.rindex("\n60,6")] + "\n60,6"):
            table.write_text(damaged)
            self.check_error(equidem(*SMALL, "--out", out, "--resume"), 2, "samples to continue")
        table.write_text(text)
        self.done(*SMALL, "--out", out, "--resume")
        self.assertEqual(table.read_text(), text)

    def test_an_accuracy_chooses_size_and_number_of_packings(self):
        self.assertLess(self.result("homogenize", ROCK, "--accuracy", "0.1")["accuracy"]["estimated"], 0.1)

    def test_what_cannot_be_sampled_is_refused(self):
        periodic = 'packing.sides = "periodic"'
        self.check_errors(((*SMALL, "--resume"), "--out"),
                          ((*SMALL, "assembly.periodic=false"), "free boundaries", "periodic = true"),
                          ((*PACKED, "packing.sides=walls"), "free boundaries", periodic),
                          (("homogenize", ROCK, "packing.sides=walls", "--accuracy", "0.1"), periodic))
        for command, told, found in (((*SMALL, "springs.kT=-0.9e9"), "none of the cells", "12 cells of 12 have no moduli"),
                                     ((*PACKED, "packing.solid_fraction=0.95"), "jam before they reach", "")):
            done = equidem(*command)
            self.assertEqual(done.returncode, 1, done.stderr)
            self.assertIn(told, done.stderr)
            self.assertIn(found, done.stdout)


if __name__ == "__main__":
    unittest.main()
