#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""equidem pack, as a user runs it: run_pack.py PROGRAM SOURCE_FOLDER [unittest options]."""
import csv
import math
import pathlib
import unittest

from program import CASES, ProgramTest, equidem, parse_json

SOIL, JAMMED, GRADED, ELLIPSES, PAIRS = (
    CASES / f"pack_{name}.toml" for name in ("soil", "jammed", "graded", "ellipses", "pairs"))
ROCK = CASES / "packed_rock.toml"
FEW = ("--set", "packing.grains=60", "--set", "packing.box=[0.15, 1.0]")


def rows_of(path):
    with open(path, newline="") as file:
        return list(csv.DictReader(file))


class PackTest(ProgramTest):
    def pack(self, case, *options, name="out"):
        """Result, and the folder."""
        out = self.folder / name
        self.check_done(equidem("pack", case, "--out", out, *options))
        return parse_json((out / "result.json").read_text()), out

    def case_of(self, assembly, rest=""):
        path = self.folder / "case.toml"
        path.write_text(f'schema = "equidem/1"\n[assembly]\nkind = "file"\npath = "{assembly}"\n{rest}')
        return path


class Files(PackTest):
    def test_a_packing_jams_and_feeds_every_other_verb(self):
        result, out = self.pack(JAMMED, "--set", "packing.grains=90")
        self.assertGreater(result["solid_fraction"], 0.8)
        network = parse_json((out / "assembly.json").read_text())
        self.assertEqual(len(network["discs"]), 90)
        self.assertEqual(len(network["contacts"]), result["contacts"])
        self.assertEqual(network["springs"][0], [1e8, 5e7])
        moduli = parse_json(self.check_done(
            equidem("homogenize", self.case_of(out / "assembly.json"), "--json", "-")).stdout)
        self.assertGreater(moduli["shear_modulus"], 1e7)
        self.assertAlmostEqual(moduli["solid_fraction"], result["solid_fraction"], delta=1e-9)
        waves = parse_json(self.check_done(
            equidem("stability", self.case_of(out / "assembly.json"), "--json", "-")).stdout)
        self.assertGreater(waves["omega_max"], 0)

    def test_a_packing_that_is_not_at_rest_is_delivered_with_the_reason(self):
        out = self.folder / "out"
        done = equidem("pack", SOIL, "--out", out, *FEW, "--set", "settling.longest=0.05")
        self.assertEqual(done.returncode, 1, done.stderr)
        self.assertIn("not at rest", done.stderr)
        self.assertIn("NOT DONE", done.stdout)
        result = parse_json((out / "result.json").read_text())
        self.assertEqual(result["status"], "failed")
        self.assertIn("not at rest", result["failure"])
        self.assertEqual(len(rows_of(out / "grains.csv")), 60)
        empty = equidem("pack", SOIL, "--out", self.folder / "empty", *FEW, "--set", "packing.region=[0.05, 5, 0.1, 6]")
        self.assertEqual(empty.returncode, 1, empty.stderr)
        self.assertIn("packing.region: no body reaches into the region measured", empty.stderr)
        self.assertEqual(len(rows_of(self.folder / "empty/grains.csv")), 60)

    def test_calibrated_springs_give_a_packing_the_moduli_wanted(self):
        result, out = self.pack(JAMMED, "--set", "packing.grains=90")
        wanted = 'own_springs = false\n[material]\nshear_modulus = 1.0e8\npoisson_ratio = 0.2\nplane = "strain"\n'
        done = parse_json(self.check_done(
            equidem("calibrate", self.case_of(out / "assembly.json", wanted), "--json", "-")).stdout)
        self.assertAlmostEqual(done["achieved"]["shear_modulus"] / 1e8, 1, delta=1e-6)

    def test_grains_have_the_density_of_the_discs_of_a_continuum(self):
        few = ("--set", "packing.grains=100")
        result, out = self.pack(ROCK, *few)
        calibrated = parse_json(self.check_done(equidem("calibrate", ROCK, *few, "--json", "-")).stdout)
        discs = calibrated["density"]["discs"]
        self.assertAlmostEqual(discs, 2300 / 0.82, delta=1e-6)
        self.assertEqual(result["density"], {"discs": discs, "continuum": 2300})
        self.assertEqual({float(row["density_kg_per_m3"]) for row in rows_of(out / "grains.csv")}, {discs})
        self.check_error(equidem("pack", ROCK, *few, "--set", "packing.density=2480"), 2, "material.density", "contradicts",
                         "2033.6", "Remove one of the two")
        default, _ = self.pack(JAMMED, "--set", "packing.grains=40", name="default")
        self.assertTrue(default["complete"])
        self.assertEqual(default["density"], {"discs": 2480})
        self.assertIn("the default", default["report"])

    def test_a_packing_below_jamming_tells_its_largest_void_and_no_contacts(self):
        rock = CASES / "sandstone" / "rock.toml"
        small = ("--set", "packing.box=[0.02, 0.02]")
        dense, loose = (parse_json(self.check_done(equidem("pack", rock, *small, "--set", f"packing.solid_fraction={fraction}",
                                                           "--json", "-")).stdout) for fraction in (0.82, 0.72))
        self.assertGreater(loose["largest_void"]["over_mean_radius"], dense["largest_void"]["over_mean_radius"])
        self.assertIn("would hold another disc", loose["report"])
        self.assertEqual((loose["contacts"], loose["rattlers"]), (0, loose["grains"]))
        self.assertIn("no two discs touch; bonds join them across gaps", loose["report"])
        self.assertNotIn("rattlers", loose["report"])
        alone = equidem("pack", rock, *small, "--set", "packing.solid_fraction=0.72", "--set", "packing.gap_tolerance=0")
        self.assertIn("no two discs touch, and none are bonded", self.check_done(alone).stdout)
        cell = parse_json(self.check_done(equidem("homogenize", rock, *small, "--set", "packing.solid_fraction=0.72", "--set",
                                                  "material=none", "--set", "springs={kN=1e9, kT=5e8}", "--json", "-")).stdout)
        self.assertEqual(cell["largest_void"], loose["largest_void"])

    def test_lengths_that_may_be_in_mm_are_questioned(self):
        rock = CASES / "sandstone" / "rock.toml"
        self.check_error(equidem("pack", rock, "--set", "packing.box=[100, 100]"), 2, "5.17e+09 bodies of 0.00144 m",
                         "the box may be in mm")
        sieves = self.folder / "sieves.csv"
        sieves.write_text("diameter_m,passing\n1.0,0\n2.0,1\n")
        coarse = ("--set", f'packing.radii.path="{sieves}"')
        self.check_error(equidem("pack", rock, *coarse), 2, "less than one body", "the radii or sieves may be in mm")
        self.check_error(equidem("pack", rock, *coarse, "--set", "packing.grains=9", "--set", "packing.solid_fraction=none"), 2,
                         "radii or sieves may be in mm")
        self.check_error(equidem("pack", rock, "--set", "packing.box=[0.003, 0.1]"), 2, "both sides at least 0.00402 m")

    def run_of_grains(self, folder, springs=""):
        case = self.folder / "grains.toml"
        case.write_text(f'schema = "equidem/1"\n{springs}[grains]\npath = "{folder}/grains.csv"\n[collisions]\n'
                        f'restitution = 0.5\n{"" if springs else "stiffness = 1.0e8"}\n[run]\nduration = 1.0e-6\n')
        return case

    def test_grains_without_density_or_with_another_than_the_springs_are_refused(self):
        few = ("--set", "packing.grains=60", "--set", "packing.sides=walls", "--set", "packing.solid_fraction=0.7")
        _, out = self.pack(JAMMED, *few, "--set", "packing.box=none")
        self.assertNotIn("density_kg_per_m3", rows_of(out / "grains.csv")[0])
        case = self.run_of_grains(out)
        self.check_error(equidem("run", case), 2, "the density of the grains is missing", "[grains]")
        self.check_done(equidem("run", case, "--set", "grains.density=2500"))
        springs = "[springs]\nkN = 1.0e8\nkT = 5.0e7\ndensity = 2600.0\n"
        self.check_done(equidem("run", self.run_of_grains(out, springs)))
        _, other = self.pack(JAMMED, *few, "--set", "packing.box=none", "--set", "packing.density=2500", name="other")
        self.check_error(equidem("run", self.run_of_grains(other, springs)), 2, "springs.density", "2600 kg/m³ here",
                         "2500 kg/m³ at", "grains.csv:2")

    def test_a_periodic_packing_is_no_start_of_a_run(self):
        _, out = self.pack(JAMMED, "--set", "packing.grains=40")
        self.check_error(equidem("run", self.run_of_grains(out), "--set", "grains.density=2500"), 2, "periodic cell",
                         'sides = "walls"')

    def test_the_most_steps_of_falling_are_known_before_they_are_taken(self):
        for case, falling in ((SOIL, True), (PAIRS, True), (JAMMED, False)):
            with self.subTest(case=case.name):
                few = FEW if case == SOIL else ("--set", "packing.grains=60")
                estimate = parse_json(self.check_done(equidem("pack", case, *few, "--dry-run", "--json", "-")).stdout)
                self.assertEqual("most_steps" in estimate, falling)
                if not falling:
                    continue
                result, _ = self.pack(case, *few, name=case.stem)
                self.assertEqual(result["time_step"], estimate["time_step"])
                self.assertLess(result["steps"], estimate["most_steps"])

    def test_discs_at_rest_are_solved_by_statics_and_stay_at_rest_in_a_run(self):
        result, out = self.pack(SOIL, *FEW)
        self.assertLessEqual(result["unbalanced_force_ratio"], 1e-6)
        held = ('[[support]]\ngroup = "walls"\nux = 0.0\nuy = 0.0\nrotation = 0.0\n'
                '[[group]]\nname = "one"\ndiscs = [0]\n[[load]]\ngroup = "one"\nforce = [0.0, -1.0]\n')
        self.check_done(equidem("solve", self.case_of(out / "assembly_with_walls.json", held)))

        run = self.folder / "run.toml"
        run.write_text(f"""schema = "equidem/1"
[grains]
path = "{out / 'grains.csv'}"
[collisions]
law = "linear_dashpot"
restitution = 0.1
stiffness = 1.3147565255273284e8
friction = 0.17
[[wall]]
name = "floor"
point = [0.0, 0.0]
normal = [0.0, 1.0]
[[wall]]
name = "left"
point = [0.0, 0.0]
normal = [1.0, 0.0]
[[wall]]
name = "right"
point = [0.15, 0.0]
normal = [-1.0, 0.0]
[run]
duration = 0.02
time_step = 4.0e-6
integrator = "velocity_verlet"
gravity = [0.0, -9.8]
""")
        self.check_done(equidem("run", run, "--out", self.folder / "ran", "--set", "output.files=['csv', 'vtk']"))
        before, after = rows_of(out / "grains.csv"), rows_of(self.folder / "ran" / "grains.csv")
        moved = max(math.dist((float(a["x_m"]), float(a["y_m"])), (float(b["x_m"]), float(b["y_m"])))
                    for a, b in zip(before, after))
        # The springs of friction begin without stretch: discs may slip a little, but none falls (g t²/2 is 2 mm).
        self.assertLess(moved, 2e-4)

    def test_a_grading_curve_is_packed_to_the_solid_fraction_asked_for(self):
        result, out = self.pack(GRADED, "--set", "packing.box=[0.1, 0.1]")
        area = sum(math.pi * float(row["radius_m"]) ** 2 for row in rows_of(out / "grains.csv"))
        self.assertAlmostEqual(area / 0.01, 0.8, delta=1e-12)
        self.assertTrue((out / "picture.png").stat().st_size > 1000)
        again = pathlib.Path(self.folder / "again")
        self.check_done(equidem("pack", out / "case.toml", "--out", again))
        self.assertEqual((out / "grains.csv").read_text(), (again / "grains.csv").read_text())


class Shapes(PackTest):
    def test_ellipses_jam_and_their_table_says_what_they_are(self):
        result, out = self.pack(ELLIPSES, "--set", "packing.grains=40", "--set", "packing.box=[0.15, 0.1]")
        self.assertEqual(result["shape"], "ellipse")
        self.assertGreater(result["solid_fraction"], 0.75)
        rows = rows_of(out / "grains.csv")
        self.assertEqual(len(rows), 40)
        for row in rows:
            self.assertAlmostEqual(float(row["radius_m"]) / float(row["short_half_axis_m"]), 2, delta=1e-12)
        self.assertTrue((out / "picture.png").stat().st_size > 1000)

    def test_ellipses_and_clumps_feed_every_other_verb(self):
        clumps = ("--set", "packing.shape.aspect=none", "--set", "packing.shape.kind=clump", "--set",
                  "packing.shape.discs=[[0, 0, 1], [1.5, 0, 1], [0.7, 1.2, 1]]", "--set", "packing.box=[0.2, 0.1]")
        for name, shape in (("ellipses", ("--set", "packing.box=[0.15, 0.1]")), ("clumps", clumps)):
            result, out = self.pack(ELLIPSES, "--set", "packing.grains=60", "--set", "packing.sides=periodic", *shape,
                                    name=name)
            network = parse_json((out / "assembly.json").read_text())
            self.assertEqual(len(network["discs"]), 60)
            for key in ("contacts", "levers", "normals", "offsets", "springs"):
                self.assertEqual(len(network[key]), result["contacts"])
            self.assertEqual(len(network["sections"]), 60)
            case = self.case_of(out / "assembly.json")
            moduli = parse_json(self.check_done(equidem("homogenize", case, "--json", "-")).stdout)
            self.assertGreater(moduli["shear_modulus"], 1e6)
            self.assertAlmostEqual(moduli["solid_fraction"], result["solid_fraction"], delta=1e-9)
            waves = parse_json(self.check_done(equidem("stability", case, "--json", "-", "--out",
                                                       self.folder / (name + "_waves"))).stdout)
            self.assertGreater(waves["omega_max"], 0)
            self.assertIsNone(waves["critical_ratio"])
            self.check_error(equidem("run", self.case_of(out / "assembly.json",
                                                         "density = 1000.0\n[run]\nduration = 1.0\n")), 2,
                             "off the lines of centres")
            wanted = 'own_springs = false\n[material]\nshear_modulus = 1.0e8\npoisson_ratio = 0.2\nplane = "strain"\n'
            done = parse_json(self.check_done(
                equidem("calibrate", self.case_of(out / "assembly.json", wanted), "--json", "-")).stdout)
            self.assertAlmostEqual(done["achieved"]["shear_modulus"] / 1e8, 1, delta=1e-6)

    def test_pairs_fall_and_come_to_rest(self):
        result, out = self.pack(PAIRS, "--set", "packing.grains=12", "--set", "packing.box=[0.12, 1.0]")
        self.assertLessEqual(result["unbalanced_force_ratio"], 1e-6)
        self.assertEqual(len(rows_of(out / "grains.csv")), 12)
        held = ('[[support]]\ngroup = "walls"\nux = 0.0\nuy = 0.0\nrotation = 0.0\n'
                '[[group]]\nname = "one"\ndiscs = [0]\n[[load]]\ngroup = "one"\nforce = [0.0, -1.0]\n')
        self.check_done(equidem("solve", self.case_of(out / "assembly_with_walls.json", held)))

    def test_what_a_shape_cannot_be_is_told_with_its_line(self):
        self.check_error(equidem("pack", ELLIPSES, "--set", "packing.shape.aspect=0.5"), 2, "aspect")
        self.check_error(equidem("pack", ELLIPSES, "--set", "packing.shape.kind=clump"), 2, "aspect", "clump")
        self.check_error(equidem("pack", ELLIPSES, "--set", "packing.shape.kind=clump", "--set",
                                 "packing.shape.aspect=none"), 2, "discs")
        self.check_error(equidem("pack", PAIRS, "--set", "settling.gravity=0"), 2, "gravity")


class CommandLine(PackTest):
    def test_seeds_give_other_packings_and_threads_do_not(self):
        texts = []
        for name, options in (("a", ["--seed", 3]), ("b", ["--seed", 3, "--threads", 2]), ("c", ["--seed", 4])):
            _, out = self.pack(JAMMED, "--set", "packing.grains=40", *options, name=name)
            texts.append((out / "grains.csv").read_text())
        self.assertEqual(texts[0], texts[1])
        self.assertNotEqual(texts[0], texts[2])

    def test_errors_name_line_and_remedy(self):
        self.check_error(equidem("pack", JAMMED, "--set", "packing.method=grow"), 2, "growth")
        self.check_error(equidem("pack", JAMMED, "--set", "packing.solid_fraction=0.5"), 2, "Remove one")
        crowded = ("--set", "packing.solid_fraction=0.95", "--set", "packing.box=none", "--set", "packing.grains=30")
        jammed = equidem("pack", JAMMED, *crowded)
        self.assertEqual(jammed.returncode, 1, jammed.stderr)
        for words in ("packing.solid_fraction", "jam before they reach the solid fraction of 0.95 that is asked for", "\"auto\""):
            self.assertIn(words, jammed.stderr)
        self.assertRegex(jammed.stdout, r"NOT DONE +.*: the discs jam")
        self.check_error(equidem("pack", JAMMED, "--set", "packing.grains=20", "--set", "packing.region=[0.7, 0, 0.8, 1]"), 2,
                         "packing.region", "out of the periodic box")
        _, out = self.pack(JAMMED, "--set", "packing.grains=20")
        self.check_error(equidem("pack", JAMMED, "--out", out), 2, "exists")

    def test_a_packing_that_is_impossible_in_its_box_is_told_before_it_is_tried(self):
        for sides, box, words in (("periodic", "[0.03, 0.5]", ("packing.box", "two of them side by side", "at least 0.0404 m")),
                                  ("walls", "[0.015, 0.5]", ("packing.box", "does not fit in", "at least 0.0202 m")),
                                  ("walls", "[0.1, 0.1]", ("packing.box", "times the area of the box"))):
            with self.subTest(sides=sides, box=box):
                options = ("--set", f"packing.sides={sides}", "--set", f"packing.box={box}", "--set",
                           "packing.solid_fraction=none")
                self.check_error(equidem("pack", JAMMED, *options), 2, *words)
                self.check_error(equidem("pack", JAMMED, *options, "--dry-run"), 2, *words)
        equal = ("--set", "packing.radii.smallest=0.01", "--set", "packing.box=none", "--set", "packing.solid_fraction=0.92")
        self.check_error(equidem("pack", JAMMED, *equal), 2, "packing.solid_fraction", "hexagonal lattice, 0.9069")

    def test_a_dry_run_tells_the_time_of_methods_but_falling(self):
        for case, options in ((JAMMED, ()),
                              (JAMMED, ("--set", "packing.method=rejection", "--set", "packing.solid_fraction=0.4",
                                        "--set", "packing.box=none")),
                              (CASES / "sandstone" / "rock.toml", ())):
            with self.subTest(options=options):
                size = parse_json(self.check_done(equidem("pack", case, *options, "--dry-run", "--json", "-")).stdout)
                self.assertGreater(size["estimated_seconds"], 0)

    def test_a_dry_run_packs_nothing(self):
        done = self.check_done(equidem("pack", SOIL, "--dry-run", "--out", self.folder / "none"))
        self.assertIn("3 000", done.stdout)
        self.assertFalse((self.folder / "none").exists())


if __name__ == "__main__":
    unittest.main()
