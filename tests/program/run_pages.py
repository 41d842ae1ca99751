# SPDX-License-Identifier: GPL-3.0-or-later
"""The parts of tools/bench/pages: run_pages.py PROGRAM SOURCE_FOLDER [unittest options]."""
import argparse
import importlib.util
import shutil
import sys
import unittest

from program import PROGRAM, SOURCE, ProgramTest

sys.path.insert(0, str(SOURCE / "tools" / "bench" / "page_parts"))
sys.dont_write_bytecode = True

import accuracy  # noqa: E402
import common  # noqa: E402
import effects  # noqa: E402


class Pages(ProgramTest):
    def run_of(self):
        options = argparse.Namespace(program=PROGRAM, quick=True, budget=0, rounds=3, data=self.folder / "data")
        return common.Run(options, self.folder)

    def test_the_cheapest_sufficient_setting_is_named_once(self):
        rows = [("a", 0.005, 1.0), ("b", 5e-5, 2.0), ("c", 1e-5, 3.0), ("d", None, 0.1)]
        self.assertEqual(accuracy.cheapest(rows), [("1e-2", rows[0]), ("1e-4", rows[1])])

    def test_an_alternative_is_compared_with_the_scene_before_the_one_that_it_replaces(self):
        names = ("plain", "+ x", "+ y", "or z, without y", "+ w")
        result = {"effects": {"active": []}, "bytes_per_disc": 100, "e": 3}
        scenes = [(name, result, time) for name, time in zip(names, (1, 2, 6, 3, 9))]
        bases = {name: (ns, base) for name, _, ns, base in effects.compared(scenes)}
        self.assertEqual(bases, {"plain": (1, None), "+ x": (2, 1), "+ y": (6, 2), "or z, without y": (3, 2), "+ w": (9, 6)})
        self.assertIn(["p", "or z, without y", "2", "100", "3", "3.0", "+50 %", "3.00"],
                      effects.chain_rows("p", scenes, lambda found: found["e"]))

    def test_scenes_of_effects_differ_each_in_one_table_from_that_before(self):
        for _, make in effects.PROBLEMS:
            (_, plain), *others = make(4)
            for name, scene in others:
                self.assertNotEqual(scene.tables, plain.tables, name)

    def test_points_of_a_study_have_the_errors_of_all_its_methods(self):
        points, ways = accuracy.of_studies(self.run_of(), "integrators")
        self.assertEqual({point[1] for point in points}, {"leapfrog", "velocity_verlet", "fourth_order", "thesis"})
        self.assertIn("`equidem study data/studies/integrators.toml --accuracy 1e-8`", [way[-1] for way in ways])
        for point in points:
            self.assertGreater(float(point[4]), 0)

    def test_the_block_of_accuracy_has_the_motions_of_elimination(self):
        run = self.run_of()
        command = f"{accuracy.BLOCK} --set assembly.rows=21 --set assembly.columns=21 --set solver.method="
        exact, _ = accuracy.motions(run, command + "multifrontal")
        close, seconds = accuracy.motions(run, command + "multigrid --accuracy 1e-2")
        self.assertGreater(seconds, 0)
        self.assertLess(max(abs(a - b) for a, b in zip(exact, close)), 1e-2 * max(map(abs, exact)))

    @unittest.skipUnless(importlib.util.find_spec("matplotlib"), "matplotlib is not installed")
    def test_stored_results_are_drawn_again(self):
        folder = self.folder / "effects"
        shutil.copytree(SOURCE / "data" / "effects", folder)
        (folder / "scenes.png").unlink()
        effects.draw(folder)
        self.assertTrue((folder / "scenes.png").exists())


if __name__ == "__main__":
    unittest.main()
