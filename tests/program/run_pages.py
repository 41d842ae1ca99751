#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""The parts of tools/bench/pages: run_pages.py PROGRAM SOURCE_FOLDER [unittest options]."""
import argparse
import sys
import unittest

from program import PROGRAM, SOURCE, ProgramTest

sys.path.insert(0, str(SOURCE / "tools" / "bench" / "page_parts"))
sys.dont_write_bytecode = True

import accuracy  # noqa: E402
import common  # noqa: E402
import effects  # noqa: E402


def setting(method, time, error=None, problem=""):
    errors = {} if error is None else {"e": error}
    return {"problem": problem, "method": method, "setting": {}, "errors": errors, "assured_errors": errors,
            "values": {"unknowns": 2, "bytes_per_disc": 100, "evaluations": 3},
            "seconds": {"median": time, "processor_median": time, "repetitions": 3}}


class Pages(ProgramTest):
    def run_of(self):
        options = argparse.Namespace(program=PROGRAM, quick=True, budget=0, rounds=3, data=self.folder / "data")
        return common.Run(options, self.folder)

    def test_the_first_table_names_the_cheapest_sufficient_setting(self):
        result = {"settings": [setting("a", 1.0, 0.005), setting("b", 2.0, 5e-5), setting("c", 3.0, 1e-5), setting("d", 9.0)]}
        run = self.run_of()
        rows = accuracy.cheapest_ways(run, "integrators", result)
        self.assertEqual([(row[1], row[2], row[4]) for row in rows], [("1e-2", "a", "1 s"), ("1e-4", "b", "2 s")])
        self.assertEqual(rows[0][5], "`equidem study integrators --accuracy 1e-2`")
        run.options = argparse.Namespace(quick=False, discs="1e6")
        self.assertEqual(accuracy.cheapest_ways(run, "solvers", result)[0][5],
                         "`equidem study solvers --discs 1e6 --accuracy 1e-2`")

    def test_an_alternative_is_compared_with_the_scene_before_the_one_that_it_replaces(self):
        names = ("plain", "+ x", "+ y", "or z, without y", "+ w")
        result = {"pieces": 1e9, "settings": [setting(name, time) for name, time in zip(names, (1, 2, 6, 3, 9))]}
        bases = {name: (ns, base) for name, _, ns, base in effects.scenes(result, "")}
        self.assertEqual(bases, {"plain": (1, None), "+ x": (2, 1), "+ y": (6, 2), "or z, without y": (3, 2), "+ w": (9, 6)})
        self.assertIn("| or z, without y | 2 | 100 | 3 | 3.0 | +50 % | 3.00 |", effects.chain_table(result, ""))

    def test_numbers_of_other_programs_are_those_of_their_page(self):
        page = (SOURCE / "data" / "benchmarks" / "peers.md").read_text(encoding="utf-8")
        said = accuracy.others()
        for line in page.split("## The same answer")[1].splitlines():
            if line.startswith("| 0."):
                for cell in line.strip("|").split("|"):
                    self.assertIn(cell.strip(), said)
        for program in ("YADE", "MUMPS", "GAMG", "cholmod"):
            self.assertIn(program, said)

    def test_a_section_has_the_orders_the_fronts_and_both_formats_of_its_plot(self):
        run = self.run_of()
        text = accuracy.section(run, "integrators", run.study("integrators"))
        self.assertIn("![A wave in a bonded lattice](studies/integrators.png)", text)
        self.assertIn("| fourth_order | motion | 4.0", text)
        self.assertIn("| fastest settings of their accuracy | time | error |", text)
        for extension in ("png", "svg"):
            self.assertTrue((run.kept / f"integrators.{extension}").exists())

    def test_solvers_are_compared_by_the_time_to_the_same_error(self):
        def solver(method, time, error, problem):
            return {**setting(method, time, error, problem), "values": {"memory": 2.0}}

        result = {"settings": [solver("a", 1.0, 1e-7, "small"), solver("a", 2.0, 1e-13, "small"), solver("b", 3.0, 1e-13, "small"),
                               {**solver("a", 0.0, None, "large"), "refusal": "too large"}, solver("b", 5.0, 1e-13, "large")]}
        self.assertIn("| small | **1 s, 2 MB** | 3 s, 2 MB |\n| large | refused | **5 s, 2 MB** |", accuracy.by_size(result, 1e-6))
        self.assertIn("| small | **2 s, 2 MB** |", accuracy.by_size(result, 1e-12))

    def test_the_report_of_effects_is_that_of_a_run(self):
        said = effects.report_of(self.run_of(), "run data/cases/run_pulse.toml --dry-run")
        self.assertTrue(said.startswith("effects "))
        self.assertIn("no gravity: it is zero", said)
        self.assertNotIn("integrator", said)


if __name__ == "__main__":
    unittest.main()
