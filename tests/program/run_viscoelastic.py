#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""[viscoelastic] in every verb, as a user runs it: run_viscoelastic.py PROGRAM SOURCE_FOLDER [unittest options]."""
import math
import re
import unittest

from program import CASES, CELL, SOURCE, ProgramTest, equidem, rows_of

SOLID = 'normal = "standard_solid"\ntauN = 1.0e-3\narmN = 3.0\ntangential = "maxwell"\ntauT = 0.5e-3\n'
VOIGT = 'normal = "kelvin_voigt"\ntauN = 1.0e-5\ntangential = "kelvin_voigt"\ntauT = 2.0e-5\n'
TABLE = 'normal = "table"\ntangential = "elastic"\npath = "springs.csv"\n'
TEST = '[test]\nkind = "uniaxial_tension"\nstress = 1.0e6\n'
RUN = TEST + "[run]\nduration = 1.0e-4\n"


class ViscoelasticTest(ProgramTest):
    def case(self, keys, rest="", periodic="true"):
        """Without keys, of elastic springs."""
        return self.write(f"""[assembly]
kind = "hexagonal"
columns = 6
rows = 6
radius = 0.005
periodic = {periodic}
density = 2600.0
[springs]
kN = 1.0e9
kT = 0.5e9
""" + (f"[viscoelastic]\n{keys}\n" if keys else "") + rest)

    def block(self, keys, rest):
        return self.case(keys, rest, "false")

    def table(self, *rows):
        self.write("frequency,kN_storage,kN_loss,kT_storage,kT_loss\n" + "\n".join(rows), "springs.csv")

    def check_near(self, found, expected, error=1e-12):
        found = complex(found["storage"], found["loss"])
        self.assertLess(abs(found - expected), error * abs(expected), (found, expected))


class Moduli(ViscoelasticTest):
    def test_lattices_have_the_closed_forms(self):
        found = self.result("homogenize", self.case(SOLID + "frequencies = [1.0, 150.0, 1.0e5]\n"))["viscoelastic"]
        self.assertEqual([row["frequency"] for row in found["harmonic"]], [1.0, 150.0, 1e5])
        self.assertEqual(found["normal"], "standard_solid")
        for row in found["harmonic"]:
            def maxwell(tau, omega=2 * math.pi * row["frequency"]):
                return 1j * omega * tau / (1 + 1j * omega * tau)
            kN, kT = 1e9 * (1 + 3 * maxwell(1e-3)), 0.5e9 * maxwell(0.5e-3)
            self.check_near(row["bulk_modulus_2d"], math.sqrt(3) / 2 * kN)
            self.check_near(row["shear_modulus"], math.sqrt(3) / 4 * (kN + kT))
            nu = row["poisson_ratio"]["plane_strain"]
            self.assertLess(abs(complex(nu["storage"], nu["loss"]) - (1 - kT / kN) / 4), 1e-12)
            self.assertLess(row["relative_residual"], 1e-14)

    def test_the_table_the_plot_and_the_case_are_written(self):
        out, cell = self.folder / "out", CASES / "viscoelastic_cell.toml"
        result = self.result("homogenize", cell, "--out", out)
        rows, read = result["viscoelastic"]["harmonic"], rows_of(out / "viscoelastic.csv")
        for line, row in zip(read, rows, strict=True):
            self.assertEqual(float(line["shear_modulus_loss_Pa"]), row["shear_modulus"]["loss"])
            self.assertAlmostEqual(float(line["omega_rad_per_s"]) / float(line["frequency_Hz"]), 2 * math.pi, delta=1e-14)
        columns = re.findall(r"`(\w+)`", (SOURCE / "docs/file_formats.md").read_text())
        self.assertEqual(set(read[0]) - set(columns), set(), "columns that the page of file formats does not name")
        self.check_there(out, "moduli_over_frequency.csv")
        # The loss has one peak, the storage rises through it, and slow strains meet kN alone.
        storage, loss = ([row["shear_modulus"][part] for row in rows] for part in ("storage", "loss"))
        top = loss.index(max(loss))
        self.assertEqual((storage, loss[:top + 1], loss[top:]),
                         (sorted(set(storage)), sorted(set(loss[:top + 1])), sorted(set(loss[top:]), reverse=True)))
        slow = self.result("homogenize", CELL, "assembly.discs=200", "springs.kT=0.0")
        self.assertNotIn("viscoelastic", slow)
        self.assertAlmostEqual(storage[0] / slow["shear_modulus"], 1, delta=1e-4)
        self.assertEqual(self.result("homogenize", out / "case.toml")["viscoelastic"], result["viscoelastic"])

    def test_measured_springs_are_those_of_the_table(self):
        self.table("1,1.0e9,1.0e8,0,0", "100,3.0e9,5.0e8,0,0")
        rows = self.result("homogenize", self.case(TABLE + "frequencies = [1.0, 10.0, 100.0]\n"))["viscoelastic"]["harmonic"]
        for row, factor in zip(rows, (1 + 0.1j, 2 + 0.3j, 3 + 0.5j), strict=True):  # straight over the logarithm of frequency
            self.check_near(row["bulk_modulus_2d"], math.sqrt(3) / 2 * 1e9 * factor)
        own = self.result("homogenize", self.case(TABLE))["viscoelastic"]["harmonic"]
        self.assertEqual([row["frequency"] for row in own], [1.0, 100.0])


class OtherVerbs(ViscoelasticTest):
    def test_at_rest_dashpots_carry_nothing(self):
        with_dashpots, elastic = (self.result("solve", self.block(keys, TEST))["poisson_ratio"] for keys in (VOIGT, ""))
        self.assertEqual(with_dashpots, elastic)

    def test_a_run_with_equal_times_is_one_with_stiffness_damping(self):
        voigt = self.result("run", self.block(VOIGT.replace("2.0e-5", "1.0e-5"), RUN))["energy"]
        damped = self.result("run", self.block("", RUN + "[run.damping]\nstiffness = 1.0e-5\n"))["energy"]
        self.assertEqual(voigt, damped)
        self.assertGreater(voigt["damped_contact"], 0)


class Refusals(ViscoelasticTest):
    def refuse(self, verb, case, *words):
        with self.subTest(verb=verb, words=words):
            options = ("--to", "matrix-market", "--out", self.folder / "o") if verb == "export" else ()
            self.check_error(equidem(verb, case, *options), 2, str(self.folder), *words)

    def test_keys_that_contradict(self):
        voigt = 'normal = "kelvin_voigt"\ntauN = 1.0\n'
        for keys, words in (('normal = "elastic"\n', "both springs are elastic"), ('normal = "maxwell"\n', "tauN"),
                            ('normal = "maxwell"\ntauN = 0.0\n', "without viscosity"),
                            ('normal = "kelvin_voigt"\ntauN = -1.0\n', "tauN"),
                            (voigt + "armN = 2.0\n", "armN"), ('normal = "table"\n', "path"),
                            (voigt + 'path = "springs.csv"\n', "no spring is read"),
                            (voigt + "lowest = 1.0\n", "highest"), (voigt + "lowest = 2.0\nhighest = 1.0\n", "lowest"),
                            (voigt + "frequencies = [0.0]\n", "frequenc")):
            self.refuse("homogenize", self.case(keys), words)

    def test_tables_that_are_not_passive_or_not_known(self):
        self.refuse("homogenize", self.case(TABLE), "springs.csv")
        for rows, keys, *words in ((("2,1e9,0,0,0", "1,1e9,0,0,0"), "", "comes after"),
                                   (("1,1e9,-1,0,0",), "", "loss", "give away energy"),
                                   (("1,-1e9,1,0,0",), "", "unstable"), (("1,1e9,1,0",), "", "columns"),
                                   (("1,1e9,one,0,0",), "", "springs.csv:2", "'one' is no kN_loss"),
                                   (("1,1e9,1,0,0", "10,1e9,1,0,0"), "frequencies = [11.0]\n", "outside the table")):
            self.table(*rows)
            self.refuse("homogenize", self.case(TABLE + keys), *words)

    def test_verbs_and_springs_that_cannot_be(self):
        case = self.case(SOLID)
        self.check_errors((("homogenize", case, "springs.kT=-0.1e9"), "every rotation grows"),
                          (("homogenize", case, "homogenize.boundary=traction"), "traction"))
        for verb in ("stability", "quasistatic", "calibrate"):
            self.refuse(verb, case, verb, "[viscoelastic]")
        self.refuse("export", case, "[viscoelastic]")
        self.refuse("solve", self.block(SOLID, TEST), "no equilibrium")
        self.refuse("run", self.block(SOLID, RUN), "Kelvin-Voigt")
        self.refuse("run", self.block(VOIGT, RUN + "[run.damping]\nstiffness = 1.0e-5\n"), "several kinds of damping")


if __name__ == "__main__":
    unittest.main()
