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


def setting(method, time, error=None):
    errors = {} if error is None else {"e": error}
    return {"method": method, "setting": {}, "errors": errors, "assured_errors": errors,
            "seconds": {"median": time, "processor_median": time, "repetitions": 3}}


class Pages(ProgramTest):
    def run_of(self):
        options = argparse.Namespace(program=PROGRAM, quick=True, budget=0, rounds=3, data=self.folder / "data")
        return common.Run(options, self.folder)

    def test_the_first_table_names_the_cheapest_sufficient_setting(self):
        result = {"settings": [setting("a", 1.0, 0.005), setting("b", 2.0, 5e-5), setting("c", 3.0, 1e-5), setting("d", 9.0)]}
        rows = accuracy.cheapest_ways("integrators", result)
        self.assertEqual([(row[1], row[2], row[4]) for row in rows], [("1e-2", "a", "1 s"), ("1e-4", "b", "2 s")])
        self.assertEqual(rows[0][5], "`equidem study data/studies/integrators.toml --accuracy 1e-2`")

    def test_an_alternative_is_compared_with_the_scene_before_the_one_that_it_replaces(self):
        names = ("plain", "+ x", "+ y", "or z, without y", "+ w")
        result = {"effects": {"active": []}, "bytes_per_disc": 100, "e": 3}
        scenes = [(name, result, time) for name, time in zip(names, (1, 2, 6, 3, 9))]
        bases = {name: (ns, base) for name, _, ns, base in effects.compared(scenes)}
        self.assertEqual(bases, {"plain": (1, None), "+ x": (2, 1), "+ y": (6, 2), "or z, without y": (3, 2), "+ w": (9, 6)})
        self.assertIn("| or z, without y | 2 | 100 | 3 | 3.0 | +50 % | 3.00 |", effects.chain_table(scenes, lambda found: found["e"]))

    def test_scenes_of_effects_differ_each_in_one_table_from_that_before(self):
        for _, _, make in effects.PROBLEMS:
            (_, plain), *others = make(4)
            for name, scene in others:
                self.assertNotEqual(scene.tables, plain.tables, name)

    def test_stored_results_stay_on_the_page(self):
        rows, sections = accuracy.stored((SOURCE / "data" / "accuracy.md").read_text(encoding="utf-8"))
        self.assertGreater(len(rows), 5)
        for heading in ("## Laws of collision", "## Contact of ellipses", "## Which solver, from which size on"):
            found = [text for text in sections if text.startswith(heading)]
            self.assertEqual(len(found), 1, heading)
            self.assertIn("commit 6167f57b", found[0])
        self.assertFalse([text for text in sections if text.startswith("## Abe's tension test")])

    def test_a_section_has_the_orders_the_front_and_both_formats_of_its_plot(self):
        run = self.run_of()
        text = accuracy.section(run, "integrators", run.study("integrators"))
        self.assertIn("![A bonded disc that vibrates](studies/integrators.png)", text)
        self.assertIn("| fourth_order | energy_elastic | 4.0", text)
        self.assertIn("| fastest settings of their accuracy | time | error |", text)
        for extension in ("png", "svg"):
            self.assertTrue((run.kept / f"integrators.{extension}").exists())

    def test_the_report_of_effects_is_that_of_a_run(self):
        said = effects.report_of(self.run_of(), "run data/cases/run_pulse.toml --dry-run")
        self.assertTrue(said.startswith("effects "))
        self.assertIn("no gravity: it is zero", said)
        self.assertNotIn("integrator", said)


if __name__ == "__main__":
    unittest.main()
