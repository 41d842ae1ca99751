#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Ensembles of random cells, as a user does: run_ensemble.py PROGRAM SOURCE_FOLDER [unittest options]."""
import csv
import math
import pathlib
import statistics
import unittest

from program import CASES, ProgramTest, equidem, parse_json

ENSEMBLE = str(CASES / "ensemble.toml")
ROCK = str(CASES / "packed_rock.toml")
SMALL = ("--set", "ensemble.discs=[20, 60]", "--set", "ensemble.samples=6")


def rows(path):
    with open(path, newline="", encoding="utf-8") as file:
        return list(csv.DictReader(file))


class EnsembleTest(ProgramTest):
    def check_threads(self):
        """The samples of one thread, which have the bytes of those of three."""
        texts = []
        for threads in (1, 3):
            out = self.folder / str(threads)
            self.run_small("--threads", threads, "--out", out)
            texts.append((out / "samples.csv").read_text())
        self.assertEqual(*texts)
        return texts[0]


class Ensemble(EnsembleTest):
    def run_small(self, *options):
        return self.check_done(equidem("homogenize", ENSEMBLE, *SMALL, *options))

    def test_means_and_scatter_are_those_of_the_samples(self):
        out = self.folder / "out"
        result = parse_json(self.run_small("--out", out, "--json", "-").stdout)
        self.assertEqual(result["status"], "done")
        self.assertEqual([size["discs"] for size in result["ensemble"]], [20, 60])
        for size in result["ensemble"]:
            samples = [row for row in rows(out / "samples.csv") if int(row["discs"]) == size["discs"]]
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
        self.assertGreater(result["needed_discs"]["bulk_modulus_2d"]["one_cell"],
                           result["needed_discs"]["bulk_modulus_2d"]["mean_of_samples"] - 1)
        self.assertGreater(result["scatter_exponent"]["shear_modulus"]["standard_error"], 0)
        for name in ("ensemble.csv", "shear_modulus.png", "poisson_ratio.png", "scatter.png", "case.toml"):
            self.assertTrue((out / name).exists(), name)

    def test_a_sample_is_the_cell_that_homogenize_gives_for_its_seed(self):
        sampled = parse_json(self.run_small("--set", "ensemble.samples=2", "--json", "-").stdout)["ensemble"][1]
        text = pathlib.Path(ENSEMBLE).read_text(encoding="utf-8")
        single = self.folder / "cell.toml"
        single.write_text(text[:text.index("[ensemble]")])
        values = []
        for seed in (1, 2):
            done = equidem("homogenize", single, "--set", "assembly.discs=60", "--seed", seed, "--json", "-")
            values.append(parse_json(self.check_done(done).stdout)["shear_modulus"])
        self.assertAlmostEqual(sampled["shear_modulus"]["mean"] / statistics.mean(values), 1, places=13)

    def test_threads_change_no_bit(self):
        self.check_threads()

    def test_springs_h_over_l_with_kT_equal_to_kN_need_no_size(self):
        report = self.run_small("--set", "springs.weighting=voronoi", "--set", "springs.kT=1e9", "--set",
                                "effects.rotation=restrained").stdout
        self.assertIn("all cells agree to round-off", report)

    def test_interrupted_it_keeps_what_is_done_and_resume_gives_the_bits_of_an_uninterrupted_run(self):
        out, whole = self.folder / "out", self.folder / "whole"
        # What the user may ask more of on --resume: samples.
        command = ["homogenize", ENSEMBLE, "--set", "ensemble.discs=[30]"]
        stdout, stderr = self.interrupt(*command, "--set", "ensemble.samples=1000000", "--out", out,
                                        when=lambda: (out / "samples.csv").exists())
        self.assertIn("INCOMPLETE", stdout)
        self.assertIn("--resume", stderr)
        done = rows(out / "samples.csv")
        self.assertGreater(len(done), 0)
        self.assertEqual(parse_json((out / "result.json").read_text())["status"], "interrupted")

        more = [*command, "--set", f"ensemble.samples={len(done) + 5}"]
        self.check_error(equidem(*more, "--out", out), 2, "exists already")
        for change in ("springs.kT=0.2e9", "assembly.seed=2", "effects.rotation=restrained"):
            self.check_error(equidem(*more, "--out", out, "--resume", "--set", change), 2, "another case")
        self.check_done(equidem(*more, "--out", out, "--resume"))
        self.check_done(equidem(*more, "--out", whole))
        self.assertEqual((out / "samples.csv").read_bytes(), (whole / "samples.csv").read_bytes())
        self.assertEqual((out / "ensemble.csv").read_bytes(), (whole / "ensemble.csv").read_bytes())
        self.assertTrue(parse_json((out / "result.json").read_text())["complete"])

    def test_damaged_samples_are_not_continued(self):
        out = self.folder / "out"
        self.run_small("--out", out)
        table = out / "samples.csv"
        text = table.read_text()
        for damaged in (text.replace("seed", "sead", 1), text.replace("\n20,1,", "\n20,one,"),
                        text[:text.rindex("\n60,6")] + "\n60,6"):
            table.write_text(damaged)
            self.check_error(equidem("homogenize", ENSEMBLE, *SMALL, "--out", out, "--resume"), 2, "samples to continue")
        table.write_text(text)
        self.run_small("--out", out, "--resume")
        self.assertEqual(table.read_text(), text)

    def test_what_cannot_be_sampled_is_refused(self):
        self.check_error(equidem("homogenize", ENSEMBLE, *SMALL, "--resume"), 2, "--out")
        self.check_error(equidem("homogenize", ENSEMBLE, *SMALL, "--set", "assembly.periodic=false"), 2,
                         "free boundaries", "periodic = true")

    def test_cells_that_are_all_unstable_fail_with_the_reason(self):
        done = equidem("homogenize", ENSEMBLE, *SMALL, "--set", "springs.kT=-0.9e9")
        self.assertEqual(done.returncode, 1, done.stderr)
        self.assertIn("none of the cells", done.stderr)
        self.assertIn("12 cells of 12 have no moduli", done.stdout)

    def test_dry_run_samples_nothing(self):
        result = parse_json(self.run_small("--dry-run", "--json", "-").stdout)
        self.assertEqual(result["status"], "dry_run")
        self.assertEqual(result["unknowns"], [60, 180])
        large = self.run_small("--set", "ensemble.discs=[30, 1000000000]", "--dry-run").stdout
        self.assertIn("would be refused: solving a network of 1 000 000 000 discs needs", large)


class PackedCells(EnsembleTest):
    """Ensembles of packings: every cell is packed anew."""
    SMALL = ("--set", "packing.grains=none", "--set", "ensemble={discs = [40, 80], samples = 4}")

    def run_small(self, *options):
        return self.check_done(equidem("homogenize", ROCK, *self.SMALL, *options))

    def test_means_are_those_of_single_packings_of_the_same_seeds(self):
        out = self.folder / "out"
        result = parse_json(self.run_small("--out", out, "--json", "-").stdout)
        self.assertEqual([size["mean_discs"] for size in result["ensemble"]], [40, 80])
        self.assertGreater(result["ensemble"][0]["shear_modulus"]["standard_deviation"], 0)
        samples = [row for row in rows(out / "samples.csv") if row["discs"] == "80"]
        self.assertEqual([row["seed"] for row in samples], ["1", "2", "3", "4"])
        for row in samples[1:3]:
            single = parse_json(self.check_done(equidem(
                "homogenize", ROCK, "--set", "packing.grains=80", "--seed", row["seed"], "--json", "-")).stdout)
            self.assertAlmostEqual(single["shear_modulus"] / float(row["shear_modulus_Pa"]), 1, places=13)

    def test_threads_change_no_bit_and_samples_are_continued(self):
        text = self.check_threads()
        more = self.run_small("--set", "ensemble.samples=5", "--out", self.folder / "1", "--resume")
        self.assertIn("5 cells", more.stdout)
        self.assertTrue((self.folder / "1" / "samples.csv").read_text().startswith(text.split("\n80,")[0]))

    def test_an_accuracy_chooses_size_and_number_of_packings(self):
        result = parse_json(self.check_done(equidem(
            "homogenize", ROCK, "--accuracy", "0.1", "--json", "-")).stdout)
        self.assertLess(result["accuracy"]["estimated"], 0.1)

    def test_walls_and_sizes_that_cannot_be_packed_are_told(self):
        self.check_error(equidem("homogenize", ROCK, *self.SMALL, "--set", "packing.sides=walls"), 2, "free boundaries",
                         "packing.sides = \"periodic\"")
        self.check_error(equidem("homogenize", ROCK, "--set", "packing.sides=walls", "--accuracy", "0.1"), 2,
                         "packing.sides = \"periodic\"")
        dense = equidem("homogenize", ROCK, *self.SMALL, "--set", "packing.solid_fraction=0.95")
        self.assertEqual(dense.returncode, 1, dense.stderr)
        self.assertIn("jam before they reach", dense.stderr)


if __name__ == "__main__":
    unittest.main()
