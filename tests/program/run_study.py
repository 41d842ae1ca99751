#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""equidem study, as a user does: run_study.py PROGRAM SOURCE_FOLDER [unittest options]."""
import csv
import signal
import subprocess
import time
import unittest

from program import CASES, PROGRAM, SOURCE, ProgramTest, equidem, parse_json

STUDIES = SOURCE / "data" / "studies"
STUDY = str(STUDIES / "abe_lattice.toml")
SHORT = ("--budget", 0, "--rounds", 3)


def rows(path):
    with open(path, newline="", encoding="utf-8") as file:
        return list(csv.DictReader(file))


class Study(ProgramTest):
    def test_a_study_file_gives_table_json_and_plot(self):
        out = self.folder / "out"
        result = parse_json(self.check_done(equidem("study", STUDY, *SHORT, "--out", out, "--json", "-")).stdout)
        self.assertEqual(result["status"], "done")
        self.assertEqual(result["rounds"], 3)
        for key in ("processor", "cores", "compiler", "build", "version"):
            self.assertIn(key, result["machine"])
        self.assertIn("equidem study", result["command"])
        self.assertEqual([order["method"] for order in result["orders"]], ["centre", "quarter"])
        for order in result["orders"]:
            self.assertLess(abs(order["observed_order"] - 1), 0.1)
            self.assertTrue(order["agrees"])
        errors = [row["errors"]["poisson_ratio"] for row in result["settings"] if row["method"] == "centre"]
        self.assertEqual(errors, sorted(errors, reverse=True))
        for row in result["settings"]:
            self.assertEqual(row["seconds"]["repetitions"], 3)
            self.assertLessEqual(row["seconds"]["lower_quartile"], row["seconds"]["median"])
            self.assertGreater(row["seconds"]["processor_median"], 0)
        for name in ("study.csv", "samples.csv", "result.json", "abe_lattice_poisson_ratio.png",
                     "abe_lattice_poisson_ratio.gp"):
            self.assertTrue((out / name).exists(), name)
        self.assertEqual(len(rows(out / "study.csv")), 10)

    def test_a_dry_run_tells_the_settings_and_writes_nothing(self):
        out = self.folder / "out"
        result = parse_json(self.check_done(equidem("study", STUDY, *SHORT, "--dry-run", "--out", out, "--json", "-")).stdout)
        self.assertEqual((result["status"], result["number_of_settings"]), ("dry_run", 10))
        self.assertFalse(out.exists())

    def test_integrators_have_the_orders_of_theory(self):
        done = self.check_done(equidem("study", STUDIES / "integrators.toml", *SHORT, "--json", "-"))
        orders = {order["method"]: order for order in parse_json(done.stdout)["orders"]}
        self.assertEqual({method: order["theoretical_order"] for method, order in orders.items()},
                         {"leapfrog": 2, "velocity_verlet": 2, "fourth_order": 4, "thesis": 1})
        for order in orders.values():
            self.assertTrue(order["agrees"], order)

    def test_the_error_of_a_mean_falls_as_the_root_of_the_number_of_cells(self):
        done = self.check_done(equidem("study", STUDIES / "random_cells.toml", *SHORT, "--json", "-"))
        order = parse_json(done.stdout)["orders"][0]
        self.assertTrue(order["agrees"], order)

    def test_each_study_of_the_data_is_read(self):
        found = [path for path in STUDIES.glob("*.toml") if "[study]" in path.read_text()]
        self.assertGreaterEqual(len(found), 4)
        for path in found:
            self.check_done(equidem("study", path, "--dry-run"))

    def test_the_accuracy_asked_for_is_reached_or_refused(self):
        done = self.check_done(equidem("study", STUDY, *SHORT, "--accuracy", 0.03, "--json", "-"))
        chosen = parse_json(done.stdout)["recommendations"][0]["setting"]
        self.assertLessEqual(chosen["errors"]["poisson_ratio"], 0.03)
        done = equidem("study", STUDY, *SHORT, "--accuracy", 1e-9, "--quiet")
        self.check_error(done, 1, "no setting reaches 1e-09", "the best one reaches")
        self.check_error(equidem("study", STUDY, "--accuracy", -1), 2, "not positive")
        self.check_error(equidem("study", STUDY, "--accuracy", "inf"), 2, "--accuracy", "'inf' is not a finite number")

    def test_options_out_of_range_are_refused(self):
        for budget in ("nan", "inf", "-1", "1s", ""):
            self.check_error(equidem("study", STUDY, "--budget", budget), 2, "--budget",
                             f"'{budget}' is not a number from 0 to 1e+07", "'equidem study --help'")
        self.check_error(equidem("study", STUDY, "--seed", "99999999999999999999"), 2, "--seed",
                         "is not a whole number from 0 to 9223372036854775807")

    def test_a_second_run_goes_on_and_another_study_is_refused(self):
        out = self.folder / "out"
        command = ("study", STUDY, "--out", out, "--budget", 0, "--quiet")
        self.check_done(equidem(*command, "--rounds", 3))
        first = rows(out / "samples.csv")
        self.check_done(equidem(*command, "--rounds", 5))
        second = rows(out / "samples.csv")
        self.assertEqual(max(int(row["round"]) for row in second), 5)
        for row in first:
            self.assertIn(row, second)
        self.check_error(equidem("study", STUDIES / "random_cells.toml", *SHORT, "--out", out), 2, "another study", "--overwrite")
        self.check_error(equidem(*command, "--seed", 2), 2, "another study")

    def test_another_case_of_the_same_settings_is_another_study(self):
        study, case, out = self.folder / "study.toml", self.folder / "cell.toml", self.folder / "out"
        case.write_text((CASES / "hexagonal_cell.toml").read_text())
        study.write_text('schema = "equidem/1"\n[study]\nverb = "homogenize"\ncase = "cell.toml"\nmeasure = "shear_modulus"\n'
                         'truth = "known"\nvalue = 1e8\n[[vary]]\nkey = "assembly.rows"\nvalues = [2, 4]\n')
        command = ("study", study, *SHORT, "--quiet", "--out", out)
        self.check_done(equidem(*command))
        self.check_done(equidem(*command))
        case.write_text(case.read_text().replace("kT = 0.5e9", "kT = 0.25e9"))
        self.check_error(equidem(*command), 2, "another study", "--overwrite")

    def test_interrupted_it_keeps_what_it_has(self):
        out = self.folder / "out"
        command = [PROGRAM, "study", STUDY, "--rounds", "100", "--out", str(out), "--budget", "600", "--quiet"]
        running = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        begin = time.monotonic()
        while not (out / "samples.csv").exists() and time.monotonic() - begin < 60:
            time.sleep(0.05)
        running.send_signal(signal.SIGINT)
        _, told = running.communicate(timeout=60)
        self.assertEqual(running.returncode, 130, told)
        self.assertIn("Run the same command to go on", told)
        done = rows(out / "samples.csv")
        self.assertGreater(len(done), 0)
        self.assertEqual(parse_json((out / "result.json").read_text())["status"], "interrupted")
        self.assertEqual([path for path in out.iterdir() if ".tmp" in path.name], [])

    def test_settings_that_cannot_be_computed_are_told(self):
        text = (STUDIES / "abe_lattice.toml").read_text().replace("../cases/abe1996_fig6.toml", str(CASES / "abe1996_fig6.toml"))
        study = self.folder / "study.toml"
        study.write_text(text.replace("[9, 17, 33, 65, 129]", "[1, 9, 17]"))
        result = parse_json(self.check_done(equidem("study", study, *SHORT, "--json", "-")).stdout)
        self.assertIn("refusal", result["settings"][0])
        self.assertIn("errors", result["settings"][1])
        study.write_text(text.replace('"poisson_ratio"', '"poison_ratio"'))
        self.check_error(equidem("study", study, *SHORT, "--quiet"), 1, "none of the settings", "poison_ratio")

    def test_the_old_name_of_a_study_is_refused_with_its_file(self):
        self.check_error(equidem("study", "integrators"), 2, "is no file", "'equidem study data/studies/integrators.toml'")
        self.check_error(equidem("study", "effects"), 2, "is no file", "such as data/studies/integrators.toml")
        self.check_error(equidem("study"), 2, "not said what to study")


if __name__ == "__main__":
    unittest.main()
