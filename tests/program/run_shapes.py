#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""equidem run of ellipses, clumps, bonded pairs and boxes that shake, as a user runs it: run_shapes.py PROGRAM SOURCE_FOLDER."""
import csv
import math
import unittest

from motion import RunTest
from program import CASES, equidem, parse_json

ELLIPSES, BONDED, SHAKEN, PAIRS = (
    CASES / f"{name}.toml" for name in ("grains_ellipses", "grains_bonded", "grains_shaken", "pack_pairs"))
SHORT_SHAKE = ("--set", "shaking.start=0.25", "--set", "shaking.cycles=1", "--set", "run.duration=0.36")


def rows_of(path):
    with open(path, newline="") as file:
        return list(csv.DictReader(file))


class ShapeTest(RunTest):
    def run_to(self, name, case, *options):
        """Result, and the folder."""
        out = self.folder / name
        self.check_done(equidem("run", case, "--out", out, "--set", "output.files=['csv', 'vtk']", *options))
        return parse_json((out / "result.json").read_text()), out


class Resume(ShapeTest):
    def test_every_scene_is_prolonged_with_the_same_bits(self):
        for case, half, whole in ((ELLIPSES, "0.2", "0.3"), (BONDED, "0.1", "0.2"), (SHAKEN, "0.3", "0.36")):
            with self.subTest(case=case.name):
                shake = SHORT_SHAKE if case == SHAKEN else ()
                name = case.stem
                self.run_to(name + "_whole", case, *shake, "--set", f"run.duration={whole}")
                self.run_to(name, case, *shake, "--set", f"run.duration={half}")
                self.run_to(name, case, *shake, "--set", f"run.duration={whole}", "--resume")
                tables = ["grains.csv", "contacts.csv", *(["bonds.csv"] if case == BONDED else []),
                          *(["measures.csv", "surface.csv", "fields.csv", "history.csv"]
                            if case == SHAKEN else [])]
                for table in tables:
                    one, other = ((self.folder / folder / table).read_text() for folder in (name, name + "_whole"))
                    if table in ("measures.csv", "surface.csv", "history.csv"):
                        # the end of the first half is a row of its own
                        one = [line for line in one.splitlines() if line in set(other.splitlines())]
                        other = other.splitlines()
                    self.assertEqual(one, other, table)

    def test_other_bonds_are_another_run(self):
        _, first = self.run_to("first", BONDED, "--set", "run.duration=0.01")
        case = self.folder / "again.toml"
        text = BONDED.read_text()
        case.write_text(text[:text.index("[bonds]")] + '[bonds]\npath = "bonds.csv"\n' +
                        text[text.index("[collisions]"):])
        rows = (first / "bonds.csv").read_text()
        (self.folder / "bonds.csv").write_text(rows)
        self.run_to("second", case, "--set", "run.duration=0.01")
        (self.folder / "bonds.csv").write_text(rows.replace("2000", "3000"))
        self.check_error(equidem("run", case, "--out", self.folder / "second", "--resume"), 2, "another")


class ReadBack(ShapeTest):
    def test_ellipses_and_clumps_go_on_from_their_table(self):
        _, out = self.run_to("first", ELLIPSES, "--set", "run.duration=0.1")
        text = ELLIPSES.read_text()
        case = self.folder / "again.toml"
        case.write_text('schema = "equidem/1"\n[grains]\npath = "first/grains.csv"\n' + text[text.index("[collisions]"):])
        self.run_to("again", case, "--set", "run.duration=1.0e-6", "--set", "run.time_step=1.0e-6")
        before, after = rows_of(out / "grains.csv"), rows_of(self.folder / "again" / "grains.csv")
        self.assertEqual([row["discs_m"] for row in before], [row["discs_m"] for row in after])
        for a, b in zip(before, after):
            self.assertLess(math.dist((float(a["x_m"]), float(a["y_m"])), (float(b["x_m"]), float(b["y_m"]))), 1e-5)

    def test_bonded_pairs_that_were_packed_are_run(self):
        packed = self.folder / "packed"
        self.check_done(equidem("pack", PAIRS, "--set", "packing.shape.kind=bonded_pair", "--set", "packing.grains=8",
                                "--set", "packing.box=[0.1, 1.0]", "--set", "settling.unbalanced=1e-3", "--out", packed))
        bonds = rows_of(packed / "bonds.csv")
        self.assertEqual([(int(row["i"]), int(row["j"])) for row in bonds], [(2 * k, 2 * k + 1) for k in range(8)])
        text = BONDED.read_text()
        case = self.folder / "case.toml"
        case.write_text('schema = "equidem/1"\n[grains]\npath = "packed/grains.csv"\n'
                        '[bonds]\npath = "packed/bonds.csv"\n' +
                        text[text.index("[collisions]"):].replace("0.08, 0.0", "0.1, 0.0"))
        result, out = self.run_to("ran", case, "--set", "run.duration=1.0e-3")
        self.assertEqual(result["bonds"]["number"], 8)
        for row, again in zip(bonds, rows_of(out / "bonds.csv")):
            self.assertEqual(row["normal_dashpot"], again["normal_dashpot"])
        # the two of a pair, which overlap from nothing to hold them apart, do not collide
        contacts = rows_of(out / "contacts.csv")
        self.assertFalse([c for c in contacts if c["j"] and int(c["i"]) // 2 == int(c["j"]) // 2])


class Shaking(ShapeTest):
    def test_measures_compare_the_moment_before_the_shaking_with_the_end(self):
        result, out = self.run_to("out", SHAKEN, *SHORT_SHAKE)
        measures = result["measures"]
        self.assertAlmostEqual(measures["time"]["before"], 0.25, delta=0.011)
        self.assertLessEqual(measures["time"]["before"], 0.25)
        before = [row for row in rows_of(out / "measures.csv") if float(row["time_s"]) <= 0.25][-1]
        self.assertEqual(measures["void_ratio"]["before"], float(before["void_ratio"]))
        self.assertLess(measures["void_ratio"]["before"], 0.3)  # discs that lie; 1.6 at the start
        self.assertLess(abs(measures["settlement"]), 0.02)
        self.assertIn("before, at t =", result["report"])

    def test_a_hundred_g_shakes_a_box_and_loses_nothing(self):
        result, out = self.run_to("out", BONDED, "--set", "shaking.acceleration=980.665", "--set",
                                  "shaking.frequency=20", "--set", "shaking.cycles=2", "--set", "shaking.start=0.05",
                                  "--set", "run.duration=0.16")
        self.assertAlmostEqual(result["shaking"]["peak_acceleration"], 980.665, delta=1e-9)
        self.assertLess(abs(result["energy"]["relative_error"]), 1e-2)
        for row in rows_of(out / "grains.csv"):
            self.assertGreater(float(row["x_m"]), 0)
            self.assertLess(float(row["x_m"]), 0.08)


class Refusals(ShapeTest):
    def test_shapes_that_cannot_be_are_told_with_their_line(self):
        cases = ((ELLIPSES, "collisions.law=exact_flow", "linear_dashpot"),
                 (ELLIPSES, "grain.5.half_axes=[0.007, 0.014]", "quarter turn"),
                 (ELLIPSES, "grain.5.position=[0.093, 0.258]", "inside one another"),
                 (BONDED, "bond.0.grains=[0, 0]", "itself"),
                 (BONDED, "bonds.normal_dashpot=nan", "finite"),
                 (SHAKEN, "shaking.frequency=none", "frequency"),
                 (SHAKEN, "shaking.acceleration=1e300", "m/s"),
                 (SHAKEN, "measures.cell=1e-9", "measures.cell"))
        for case, key, word in cases:
            with self.subTest(key=key):
                self.check_error(equidem("run", case, "--set", key), 2, word)


if __name__ == "__main__":
    unittest.main()
