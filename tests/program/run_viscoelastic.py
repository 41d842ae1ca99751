#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""[viscoelastic] in every verb, as a user runs it: run_viscoelastic.py PROGRAM SOURCE_FOLDER [unittest options]."""
import csv
import math
import re
import unittest

from program import CASES, SOURCE, ProgramTest, equidem, parse_json

LATTICE = """schema = "equidem/1"
[assembly]
kind = "hexagonal"
columns = 6
rows = 6
radius = 0.005
periodic = {periodic}
density = 2600.0
[springs]
kN = 1.0e9
kT = 0.5e9
[viscoelastic]
{keys}
{rest}
"""
SOLID = 'normal = "standard_solid"\ntauN = 1.0e-3\narmN = 3.0\ntangential = "maxwell"\ntauT = 0.5e-3\n'
VOIGT = 'normal = "kelvin_voigt"\ntauN = 1.0e-5\ntangential = "kelvin_voigt"\ntauT = 2.0e-5\n'
TABLE = 'normal = "table"\ntangential = "elastic"\npath = "springs.csv"\n'


class ViscoelasticTest(ProgramTest):
    def case(self, keys, rest="", periodic="true"):
        path = self.folder / "case.toml"
        path.write_text(LATTICE.format(keys=keys, rest=rest, periodic=periodic))
        return path

    def homogenize(self, case, *options):
        return parse_json(self.check_done(equidem("homogenize", case, "--json", "-", *options)).stdout)

    def table(self, *rows):
        (self.folder / "springs.csv").write_text("frequency,kN_storage,kN_loss,kT_storage,kT_loss\n" + "\n".join(rows))


class Moduli(ViscoelasticTest):
    def test_lattices_have_the_closed_forms(self):
        result = self.homogenize(self.case(SOLID + "frequencies = [1.0, 150.0, 1.0e5]\n"))
        self.assertEqual([row["frequency"] for row in result["viscoelastic"]["harmonic"]], [1.0, 150.0, 1e5])
        for row in result["viscoelastic"]["harmonic"]:
            omega = 2 * math.pi * row["frequency"]
            maxwell = lambda tau: 1j * omega * tau / (1 + 1j * omega * tau)
            kN, kT = 1e9 * (1 + 3 * maxwell(1e-3)), 0.5e9 * maxwell(0.5e-3)
            for name, expected in (("bulk_modulus_2d", math.sqrt(3) / 2 * kN),
                                   ("shear_modulus", math.sqrt(3) / 4 * (kN + kT))):
                found = complex(row[name]["storage"], row[name]["loss"])
                self.assertLess(abs(found - expected), 1e-12 * abs(expected), name)
            nu = row["poisson_ratio"]["plane_strain"]
            self.assertLess(abs(complex(nu["storage"], nu["loss"]) - (1 - kT / kN) / 4), 1e-12)
            self.assertLess(row["relative_residual"], 1e-14)
        self.assertEqual(result["viscoelastic"]["normal"], "standard_solid")

    def test_the_table_the_plot_and_the_case_are_written(self):
        out = self.folder / "out"
        result = self.homogenize(CASES / "viscoelastic_cell.toml", "--out", out)
        rows = result["viscoelastic"]["harmonic"]
        with open(out / "viscoelastic.csv", newline="") as file:
            read = list(csv.DictReader(file))
        self.assertEqual(len(read), len(rows))
        for line, row in zip(read, rows):
            self.assertEqual(float(line["shear_modulus_loss_Pa"]), row["shear_modulus"]["loss"])
            self.assertAlmostEqual(float(line["omega_rad_per_s"]) / float(line["frequency_Hz"]), 2 * math.pi, delta=1e-14)
        columns = re.findall(r"`(\w+)`", (SOURCE / "docs/file_formats.md").read_text())
        self.assertEqual(set(read[0]) - set(columns), set(), "columns that the page of file formats does not name")
        self.assertTrue((out / "moduli_over_frequency.csv").exists())
        # The loss has one peak, the storage rises through it, and slow strains meet kN alone.
        loss = [row["shear_modulus"]["loss"] for row in rows]
        storage = [row["shear_modulus"]["storage"] for row in rows]
        top = loss.index(max(loss))
        self.assertTrue(all(b > a for a, b in zip(storage, storage[1:])))
        self.assertTrue(all(b > a for a, b in zip(loss[:top], loss[1:top + 1])))
        self.assertTrue(all(b < a for a, b in zip(loss[top:], loss[top + 1:])))
        slow = self.homogenize(CASES / "random_cell.toml", "--set", "assembly.discs=200", "--set", "springs.kT=0.0")
        self.assertAlmostEqual(storage[0] / slow["shear_modulus"], 1, delta=1e-4)
        again = self.homogenize(out / "case.toml")
        self.assertEqual(again["viscoelastic"], result["viscoelastic"])

    def test_measured_springs_are_those_of_the_table(self):
        self.table("1,1.0e9,1.0e8,0,0", "100,3.0e9,5.0e8,0,0")
        rows = self.homogenize(self.case(TABLE + "frequencies = [1.0, 10.0, 100.0]\n"))["viscoelastic"]["harmonic"]
        for row, factor in zip(rows, (1 + 0.1j, 2 + 0.3j, 3 + 0.5j)):  # straight over the logarithm of frequency
            K = math.sqrt(3) / 2 * 1e9 * factor
            self.assertLess(abs(complex(row["bulk_modulus_2d"]["storage"], row["bulk_modulus_2d"]["loss"]) - K), 1e-12 * abs(K))
        own = self.homogenize(self.case(TABLE))["viscoelastic"]["harmonic"]
        self.assertEqual([row["frequency"] for row in own], [1.0, 100.0])

    def test_a_case_without_the_table_says_nothing_of_it(self):
        result = self.homogenize(CASES / "random_cell.toml", "--set", "assembly.discs=50")
        self.assertNotIn("viscoelastic", result)


class Refusals(ViscoelasticTest):
    def refuse(self, keys, *words, verb="homogenize", rest="", periodic="true", options=()):
        self.check_error(equidem(verb, self.case(keys, rest, periodic), *options), 2, str(self.folder), *words)

    def test_keys_that_contradict(self):
        self.refuse('normal = "elastic"\n', "both springs are elastic")
        self.refuse('normal = "maxwell"\n', "tauN")
        self.refuse('normal = "maxwell"\ntauN = 0.0\n', "without viscosity")
        self.refuse('normal = "kelvin_voigt"\ntauN = -1.0\n', "tauN")
        self.refuse('normal = "kelvin_voigt"\ntauN = 1.0\narmN = 2.0\n', "armN")
        self.refuse('normal = "table"\n', "path")
        self.refuse('normal = "kelvin_voigt"\ntauN = 1.0\npath = "springs.csv"\n', "no spring is read")
        self.refuse('normal = "kelvin_voigt"\ntauN = 1.0\nlowest = 1.0\n', "highest")
        self.refuse('normal = "kelvin_voigt"\ntauN = 1.0\nlowest = 2.0\nhighest = 1.0\n', "lowest")
        self.refuse('normal = "kelvin_voigt"\ntauN = 1.0\nfrequencies = [0.0]\n', "frequenc")

    def test_tables_that_are_not_passive_or_not_known(self):
        def refuse(rows, *words, keys=TABLE):
            self.table(*rows)
            self.refuse(keys, *words)
        refuse(["2,1e9,0,0,0", "1,1e9,0,0,0"], "comes after")
        refuse(["1,1e9,-1,0,0"], "loss", "give away energy")
        refuse(["1,-1e9,1,0,0"], "unstable")
        refuse(["1,1e9,1,0"], "columns")
        refuse(["1,1e9,one,0,0"], "springs.csv:2", "'one' is no kN_loss")
        refuse(["1,1e9,1,0,0", "10,1e9,1,0,0"], "outside the table", keys=TABLE + "frequencies = [11.0]\n")
        (self.folder / "springs.csv").unlink()
        self.refuse(TABLE, "springs.csv")

    def test_springs_that_cannot_be(self):
        case = self.case(SOLID)
        self.check_error(equidem("homogenize", case, "--set", "springs.kT=-0.1e9"), 2, "every rotation grows")
        self.check_error(equidem("homogenize", case, "--set", "homogenize.boundary=traction"), 2, "traction")

    def test_verbs_that_take_elastic_springs(self):
        for verb, rest in (("stability", ""), ("quasistatic", ""), ("calibrate", "")):
            self.refuse(SOLID, verb, "[viscoelastic]", verb=verb, rest=rest)
        self.refuse(SOLID, "[viscoelastic]", verb="export", options=("--to", "matrix-market", "--out", self.folder / "o"))
        test = '[test]\nkind = "uniaxial_tension"\nstress = 1.0e6\n'
        self.refuse(SOLID, "no equilibrium", verb="solve", rest=test, periodic="false")
        self.refuse(SOLID, "Kelvin-Voigt", verb="run", rest=test + "[run]\nduration = 1.0e-5\n", periodic="false")


class OtherVerbs(ViscoelasticTest):
    TEST = '[test]\nkind = "uniaxial_tension"\nstress = 1.0e6\n'

    def test_at_rest_dashpots_carry_nothing(self):
        case = self.case(VOIGT, self.TEST, "false")
        with_dashpots = parse_json(self.check_done(equidem("solve", case, "--json", "-")).stdout)
        case.write_text(case.read_text().replace("[viscoelastic]\n" + VOIGT, ""))
        elastic = parse_json(self.check_done(equidem("solve", case, "--json", "-")).stdout)
        self.assertEqual(with_dashpots["poisson_ratio"], elastic["poisson_ratio"])

    def test_a_run_with_equal_times_is_one_with_stiffness_damping(self):
        run = self.TEST + "[run]\nduration = 1.0e-4\n{}"
        case = self.case(VOIGT.replace("2.0e-5", "1.0e-5"), run.format(""), "false")
        voigt = parse_json(self.check_done(equidem("run", case, "--json", "-")).stdout)
        case.write_text(LATTICE.format(keys="", rest=run.format("[run.damping]\nstiffness = 1.0e-5\n"), periodic="false")
                        .replace("[viscoelastic]\n", ""))
        damped = parse_json(self.check_done(equidem("run", case, "--json", "-")).stdout)
        self.assertEqual(voigt["energy"], damped["energy"])
        self.assertGreater(voigt["energy"]["damped_contact"], 0)

    def test_a_run_with_other_dashpots_too_is_refused(self):
        rest = self.TEST + "[run]\nduration = 1.0e-4\n[run.damping]\nstiffness = 1.0e-5\n"
        self.check_error(equidem("run", self.case(VOIGT, rest, "false")), 2, "several kinds of damping")


if __name__ == "__main__":
    unittest.main()
