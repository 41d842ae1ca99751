#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Forces at rest from pack to moduli and critical loads: run_prestress.py PROGRAM SOURCE_FOLDER [unittest options]."""
import csv
import json
import math
import unittest

from program import CASES, ProgramTest, equidem, parse_json

COLUMN = CASES / "column.toml"
SMOOTH = ("--set", "springs.shear_wave_speed=none", "--set", "springs.poisson_ratio=none", "--set", "springs.kN=1e8",
          "--set", "springs.kT=0")


class Prestress(ProgramTest):
    def done(self, *arguments):
        done = equidem(*arguments)
        self.assertEqual(done.returncode, 0, done.stderr)
        return done.stdout

    def case_of(self, assembly, more=""):
        path = self.folder / "case.toml"
        path.write_text(f'schema = "equidem/1"\n[assembly]\nkind = "file"\npath = "{assembly}"\n{more}')
        return path

    def refused(self, words, *arguments):
        done = equidem(*arguments)
        self.assertNotEqual(done.returncode, 0, done.stdout)
        for word in words:
            self.assertIn(word, done.stderr)

    def test_forces_of_contacts_are_totals_where_forces_at_rest_count(self):
        row = {"schema": "equidem-assembly/1", "discs": [[0, 0, 1], [2, 0, 1], [4, 0, 1]],
               "contacts": [[0, 1, 0, 0], [1, 2, 0, 0]], "forces": [[-100, 0], [-100, 0]], "curvatures": [[1, 1], [1, 1]],
               "groups": {"a": {"discs": [0]}, "b": {"discs": [2]}}}
        (self.folder / "row.json").write_text(json.dumps(row))
        case = self.case_of("row.json", '[springs]\nkN = 1.0e6\nkT = 5.0e5\n[effects]\nrotation = "restrained"\n'
                            '[[support]]\ngroup = "a"\nux = 0.0\nuy = 0.0\n[[support]]\ngroup = "b"\nuy = 0.0\n'
                            '[[load]]\ngroup = "b"\nforce = [30.0, 0.0]\n')
        for counts, force in (("on", 30 - 100), ("off", 30)):
            out = self.folder / counts
            self.done("solve", case, "--set", f"effects.prestress={counts}", "--out", out)
            with open(out / "contacts.csv", encoding="utf8") as file:
                found = [float(contact["normal_force_N_per_m"]) for contact in csv.DictReader(file)]
            self.assertEqual(len(found), 2)
            for value in found:
                self.assertAlmostEqual(value, force, delta=1e-9 * abs(force))

    def test_frictionless_ellipses_have_moduli_by_their_forces(self):
        packed = self.folder / "packed"
        report = self.done("pack", CASES / "pack_ellipses.toml", "--set", "packing.sides=periodic", "--set",
                           "packing.grains=60", *SMOOTH, "--out", packed)
        self.assertIn("forces at rest", report)
        self.assertLess(json.loads((packed / "result.json").read_text())["forces_at_rest"]["imbalance"], 1e-5)
        case = self.case_of(packed / "assembly.json")
        found = parse_json(self.done("homogenize", case, "--json", "-"))
        self.assertTrue(found["prestress"]["counts"])
        self.assertGreater(found["bulk_modulus_2d"], 1e6)
        self.assertLess(found["stress_at_rest"]["xx"], 0)
        self.assertIn("stress at rest", self.done("homogenize", case))
        # Without them the packing is floppy, or so soft that no digit is left.
        self.refused([], "homogenize", case, "--set", "effects.prestress=off")

        assembly = json.loads((packed / "assembly.json").read_text())
        largest = max(range(len(assembly["forces"])), key=lambda contact: abs(assembly["forces"][contact][0]))
        assembly["forces"][largest] = [0.0, 0.0]
        (self.folder / "unbalanced.json").write_text(json.dumps(assembly))
        on = ("--set", "effects.prestress=on")
        self.refused(["do not balance", "disc"], "homogenize", self.case_of("unbalanced.json"), *on)
        assembly = json.loads((packed / "assembly.json").read_text())
        del assembly["curvatures"]
        (self.folder / "unknown.json").write_text(json.dumps(assembly))
        self.refused(["curvatures"], "homogenize", self.case_of("unknown.json"), *on)
        case = self.case_of(packed / "assembly.json")
        self.refused(["quasistatic takes no prestress"], "quasistatic", case, *on)
        self.refused(["export --to lammps takes no prestress"], "export", case, *on, "--to", "lammps", "--out",
                     self.folder / "lammps")

    def test_bodies_that_fell_carry_forces_that_balance_their_weight(self):
        packed = self.folder / "fallen"
        self.done("pack", CASES / "pack_soil.toml", "--set", "packing.grains=30", "--set", "packing.box=[0.1, 0.5]",
                  "--out", packed)
        case = self.case_of(packed / "assembly_with_walls.json",
                            '[[support]]\ngroup = "walls"\nux = true\nuy = true\nrotation = true\n')
        report = self.done("stability", case, "--set", "effects.prestress=on")
        self.assertIn("weight, walls", " ".join(report.split()))
        self.assertIn("critical load", report)

    def test_a_slender_column_buckles_at_eulers_load_less_its_shear(self):
        out = self.folder / "column"
        quick = ("stability", COLUMN, "--set", "effects.prestress=on")
        self.assertIn("loses stability by", self.done(*quick, "--out", out))
        self.assertTrue((out / "picture_buckling.svg").exists())
        found, euler = json.loads((out / "result.json").read_text()), math.pi**2 * 1e9 * 0.005 / 128**2
        missing = 1 - found["critical_load"]["factor"] / euler
        self.assertGreater(missing, 7e-4)
        self.assertLess(missing, 9e-4)
        self.assertEqual((found["unstable_modes"], found["status"]), (0, "stable"))
        short = parse_json(self.done(*quick, "--set", "assembly.columns=33", "--json", "-"))
        self.assertAlmostEqual((1 - short["critical_load"]["factor"] / (4 * euler)) / missing, 4, delta=0.2)
        pushed = parse_json(self.done(*quick, "--set", "load.0.force=[-4000.0, 0.0]", "--json", "-"))
        self.assertEqual((pushed["unstable_modes"], pushed["status"]), (1, "unstable"))
        self.assertAlmostEqual(pushed["critical_load"]["factor"] * 4000 / found["critical_load"]["factor"], 1, delta=1e-9)

    def test_a_support_that_moves_compresses_a_column_as_a_load_does(self):
        # The end that moves cannot turn: four times the load of the free one.
        case, way = self.folder / "moved.toml", 1e-6
        text = COLUMN.read_text()
        text = text[:text.index("[[load]]")] + f'[[support]]\ngroup = "right"\nux = {-way}\n'
        case.write_text(text)
        quick = ("stability", case, "--set", "effects.prestress=on", "--json", "-")
        found = parse_json(self.done(*quick))
        pressed, euler = 2 * 1e9 * way / 64, math.pi**2 * 1e9 * 0.005 / 128**2
        self.assertAlmostEqual(found["critical_load"]["factor"] * pressed / (4 * euler), 1, delta=0.01)
        dry = parse_json(self.done(*quick, "--dry-run"))
        self.assertEqual(dry["status"], "dry_run")
        self.assertNotIn("prestress", dry)


if __name__ == "__main__":
    unittest.main()
