# SPDX-License-Identifier: GPL-3.0-or-later
"""equidem pack, as a user runs it: run_pack.py PROGRAM SOURCE_FOLDER [unittest options]."""
import math
import unittest

from program import CASES, NO_PICTURE, ProgramTest, equidem, parse_json, result_in, rows_of
from scenes import wall

SOIL, JAMMED, GRADED, ELLIPSES, PAIRS = (
    CASES / f"pack_{name}.toml" for name in ("soil", "jammed", "graded", "ellipses", "pairs"))
ROCK, GRAINS = CASES / "packed_rock.toml", CASES / "sandstone" / "rock.toml"
FEW = ("packing.grains=60", "packing.box=[0.15, 1.0]")
HELD = ('[[support]]\ngroup = "walls"\nux = 0.0\nuy = 0.0\nrotation = 0.0\n'
        '[[group]]\nname = "one"\ndiscs = [0]\n[[load]]\ngroup = "one"\nforce = [0.0, -1.0]\n')
WANTED = 'own_springs = false\n[material]\nshear_modulus = 1.0e8\npoisson_ratio = 0.2\nplane = "strain"\n'


class PackTest(ProgramTest):
    def pack(self, case, *options, name="out"):
        """Result, and the folder."""
        out = self.folder / name
        self.done("pack", case, "--out", out, *options)
        return result_in(out), out

    def run_of_grains(self, folder, springs=""):
        law = "restitution = 0.5\n" + ("" if springs else "stiffness = 1.0e8\n")
        return self.write(f'{springs}[grains]\npath = "{folder}/grains.csv"\n[collisions]\n{law}[run]\nduration = 1.0e-6\n', "grains.toml")


class Files(PackTest):
    def test_packings_of_every_shape_feed_every_other_verb(self):
        shape = ("packing.grains=60", "packing.sides=periodic")
        for name, case, options in (
                ("discs", JAMMED, ("packing.grains=90",)), ("ellipses", ELLIPSES, (*shape, "packing.box=[0.15, 0.1]")),
                ("clumps", ELLIPSES, (*shape, "packing.shape.aspect=none", "packing.shape.kind=clump", "packing.box=[0.2, 0.1]",
                                      "packing.shape.discs=[[0, 0, 1], [1.5, 0, 1], [0.7, 1.2, 1]]"))):
            with self.subTest(shape=name):
                result, out = self.pack(case, *options, name=name)
                network = parse_json((out / "assembly.json").read_text())
                bodies = int(options[0].split("=")[1])
                self.assertEqual(len(network["discs"]), bodies)
                for key in ("contacts", "springs", *(("levers", "normals", "offsets") if name != "discs" else ())):
                    self.assertEqual(len(network[key]), result["contacts"], key)
                assembly = self.of_file(out / "assembly.json")
                moduli = self.result("homogenize", assembly)
                self.assertGreater(moduli["shear_modulus"], 1e6)
                self.assertAlmostEqual(moduli["solid_fraction"], result["solid_fraction"], delta=1e-9)
                waves = self.result("stability", assembly, "--out", self.folder / (name + "_waves"))
                self.assertGreater(waves["omega_max"], 0)
                done = self.result("calibrate", self.of_file(out / "assembly.json", WANTED))
                self.assertAlmostEqual(done["achieved"]["shear_modulus"] / 1e8, 1, delta=1e-6)
                if name == "discs":
                    self.assertGreater(result["solid_fraction"], 0.8)
                    self.assertEqual(network["springs"][0], [1e8, 5e7])
                    self.assertGreater(moduli["shear_modulus"], 1e7)
                    continue
                self.assertEqual(len(network["sections"]), bodies)
                self.assertIsNone(waves["critical_ratio"])
                moving = self.of_file(out / "assembly.json", "density = 1000.0\n[run]\nduration = 1.0\n")
                self.check_error(equidem("run", moving), 2, "off the lines of centres")

    def test_a_packing_that_is_not_at_rest_is_delivered_with_the_reason(self):
        for name, option, words in (("falling", "settling.longest=0.05", "not at rest"),
                                    ("empty", "packing.region=[0.05, 5, 0.1, 6]",
                                     "packing.region: no body reaches into the region measured")):
            out = self.folder / name
            self.check_partial(equidem("pack", SOIL, "--out", out, *FEW, option), words, out=out)
            self.assertEqual(len(rows_of(out / "grains.csv")), 60)

    def test_grains_have_the_density_of_the_discs_of_a_continuum(self):
        few = "packing.grains=100"
        result, out = self.pack(ROCK, few)
        discs = self.result("calibrate", ROCK, few)["density"]["discs"]
        self.assertAlmostEqual(discs, 2300 / 0.82, delta=1e-6)
        self.assertEqual(result["density"], {"discs": discs, "continuum": 2300})
        self.assertEqual({float(row["density_kg_per_m3"]) for row in rows_of(out / "grains.csv")}, {discs})
        self.check_error(equidem("pack", ROCK, few, "packing.density=2480"), 2, "material.density", "contradicts", "2033.6",
                         "Remove one of the two")
        default, _ = self.pack(JAMMED, "packing.grains=40", name="default")
        self.assertTrue(default["complete"])
        self.assertEqual(default["density"], {"discs": 2480})
        self.assertIn("the default", default["report"])

    def test_grains_without_density_or_with_another_than_the_springs_are_refused(self):
        few = ("packing.grains=60", "packing.sides=walls", "packing.solid_fraction=0.7", "packing.box=none")
        springs = "[springs]\nkN = 1.0e8\nkT = 5.0e7\ndensity = 2600.0\n"
        _, out = self.pack(JAMMED, *few)
        self.assertNotIn("density_kg_per_m3", rows_of(out / "grains.csv")[0])
        case = self.run_of_grains(out)
        self.check_error(equidem("run", case), 2, "the density of the grains is missing", "[grains]")
        self.done("run", case, "grains.density=2500")
        self.done("run", self.run_of_grains(out, springs))
        _, other = self.pack(JAMMED, *few, "packing.density=2500", name="other")
        self.check_error(equidem("run", self.run_of_grains(other, springs)), 2, "springs.density", "2600 kg/m³ here", "2500 kg/m³ at",
                         "grains.csv:2")
        _, periodic = self.pack(JAMMED, "packing.grains=40", name="periodic")
        self.check_error(equidem("run", self.run_of_grains(periodic), "grains.density=2500"), 2, "periodic cell", 'sides = "walls"')

    def test_a_packing_below_jamming_tells_its_largest_void_and_no_contacts(self):
        dense, loose = ((GRAINS, "packing.box=[0.02, 0.02]", f"packing.solid_fraction={fraction}") for fraction in (0.82, 0.72))
        packed = self.result("pack", *loose)
        self.assertGreater(packed["largest_void"]["over_mean_radius"],
                           self.result("pack", *dense)["largest_void"]["over_mean_radius"])
        self.assertEqual((packed["contacts"], packed["rattlers"]), (0, packed["grains"]))
        for words in ("would hold another disc", "no two discs touch; bonds join them across gaps"):
            self.assertIn(words, packed["report"])
        self.assertNotIn("rattlers", packed["report"])
        self.assertIn("no two discs touch, and none are bonded", self.report("pack", *loose, "packing.gap_tolerance=0"))
        cell = self.result("homogenize", *loose, "material=none", "springs={kN=1e9, kT=5e8}")
        self.assertEqual(cell["largest_void"], packed["largest_void"])

    def test_discs_at_rest_are_solved_by_statics_and_stay_at_rest_in_a_run(self):
        result, out = self.pack(SOIL, *FEW)
        self.assertLessEqual(result["unbalanced_force_ratio"], 1e-6)
        self.done("solve", self.of_file(out / "assembly_with_walls.json", HELD))
        run = self.write(f'[grains]\npath = "{out / "grains.csv"}"\n[collisions]\nlaw = "linear_dashpot"\nrestitution = 0.1\n'
                         "stiffness = 1.3147565255273284e8\nfriction = 0.17\n" + wall("floor", (0.0, 0.0), (0.0, 1.0)) +
                         wall("left", (0.0, 0.0), (1.0, 0.0)) + wall("right", (0.15, 0.0), (-1.0, 0.0)) +
                         '[run]\nduration = 0.02\ntime_step = 4.0e-6\nintegrator = "velocity_verlet"\ngravity = [0.0, -9.8]\n')
        self.done("run", run, "--out", self.folder / "ran", NO_PICTURE)
        moved = max(math.dist((float(a["x_m"]), float(a["y_m"])), (float(b["x_m"]), float(b["y_m"])))
                    for a, b in zip(rows_of(out / "grains.csv"), rows_of(self.folder / "ran" / "grains.csv")))
        # The springs of friction begin without stretch: discs may slip a little, but none falls (g t²/2 is 2 mm).
        self.assertLess(moved, 2e-4)

    def test_pairs_fall_and_come_to_rest(self):
        result, out = self.pack(PAIRS, "packing.grains=12", "packing.box=[0.12, 1.0]")
        self.assertLessEqual(result["unbalanced_force_ratio"], 1e-6)
        self.assertEqual(len(rows_of(out / "grains.csv")), 12)
        self.done("solve", self.of_file(out / "assembly_with_walls.json", HELD))

    def test_ellipses_jam_and_their_table_says_what_they_are(self):
        result, out = self.pack(ELLIPSES, "packing.grains=40", "packing.box=[0.15, 0.1]")
        self.assertEqual(result["shape"], "ellipse")
        self.assertGreater(result["solid_fraction"], 0.75)
        rows = rows_of(out / "grains.csv")
        self.assertEqual(len(rows), 40)
        for row in rows:
            self.assertAlmostEqual(float(row["radius_m"]) / float(row["short_half_axis_m"]), 2, delta=1e-12)
        self.assertTrue((out / "picture.png").stat().st_size > 1000)

    def test_a_grading_curve_is_packed_to_the_solid_fraction_asked_for(self):
        _, out = self.pack(GRADED, "packing.box=[0.1, 0.1]")
        area = sum(math.pi * float(row["radius_m"]) ** 2 for row in rows_of(out / "grains.csv"))
        self.assertAlmostEqual(area / 0.01, 0.8, delta=1e-12)
        self.assertTrue((out / "picture.png").stat().st_size > 1000)


class CommandLine(PackTest):
    def test_seeds_give_other_packings(self):
        _, three = self.pack(JAMMED, "packing.grains=40", "--seed", 3, name="three")
        _, four = self.pack(JAMMED, "packing.grains=40", "--seed", 4, name="four")
        self.assertNotEqual((three / "grains.csv").read_text(), (four / "grains.csv").read_text())

    def test_the_most_steps_of_falling_are_known_before_they_are_taken(self):
        for case, falling in ((SOIL, True), (PAIRS, True), (JAMMED, False)):
            with self.subTest(case=case.name):
                few = FEW if case == SOIL else ("packing.grains=60",)
                estimate = self.result("pack", case, *few, "--dry-run")
                self.assertEqual("most_steps" in estimate, falling)
                if falling:
                    result, _ = self.pack(case, *few, name=case.stem)
                    self.assertEqual(result["time_step"], estimate["time_step"])
                    self.assertLess(result["steps"], estimate["most_steps"])

    def test_a_dry_run_tells_the_time_of_methods_but_falling(self):
        rejection = ("packing.method=rejection", "packing.solid_fraction=0.4", "packing.box=none")
        for case, options in ((JAMMED, ()), (JAMMED, rejection), (GRAINS, ())):
            with self.subTest(options=options):
                self.assertGreater(self.result("pack", case, *options, "--dry-run")["estimated_seconds"], 0)

    def test_errors_name_line_and_remedy(self):
        free, equal = ("packing.box=none",), ("packing.radii.smallest=0.01", "packing.box=none", "packing.solid_fraction=0.92")
        sieves = self.write("diameter_m,passing\n1.0,0\n2.0,1\n", "sieves.csv")
        coarse = f'packing.radii.path="{sieves}"'
        self.check_errors(
            ((JAMMED, "packing.method=grow"), "growth"), ((JAMMED, "packing.solid_fraction=0.5"), "Remove one"),
            ((JAMMED, "packing.grains=20", "packing.region=[0.7, 0, 0.8, 1]"), "packing.region", "out of the periodic box"),
            ((JAMMED, *equal), "packing.solid_fraction", "hexagonal lattice, 0.9069"),
            ((ELLIPSES, "packing.shape.aspect=0.5"), "aspect"), ((ELLIPSES, "packing.shape.kind=clump"), "aspect", "clump"),
            ((ELLIPSES, "packing.shape.kind=clump", "packing.shape.aspect=none"), "discs"),
                          ((PAIRS, "settling.gravity=0"), "gravity"),
            # lengths that may be in mm
            ((GRAINS, "packing.box=[100, 100]"), "5.17e+09 bodies of 0.00144 m", "the box may be in mm"),
            ((GRAINS, coarse), "less than one body", "the radii or sieves may be in mm"),
            ((GRAINS, coarse, "packing.grains=9", "packing.solid_fraction=none"), "radii or sieves may be in mm"),
            ((GRAINS, "packing.box=[0.003, 0.1]"), "both sides at least 0.00402 m"), before=("pack",))
        jammed = equidem("pack", JAMMED, "packing.solid_fraction=0.95", *free, "packing.grains=30")
        self.check_error(jammed, 1, "packing.solid_fraction",
                         "jam before they reach the solid fraction of 0.95 that is asked for", '"auto"')
        self.assertRegex(jammed.stdout, r"NOT DONE +.*: the discs jam")

    def test_a_packing_that_is_impossible_in_its_box_is_told_before_it_is_tried(self):
        for sides, box, *words in (("periodic", "[0.03, 0.5]", "two of them side by side", "at least 0.0404 m"),
                                   ("walls", "[0.015, 0.5]", "does not fit in", "at least 0.0202 m"),
                                   ("walls", "[0.1, 0.1]", "times the area of the box")):
            options = ("pack", JAMMED, f"packing.sides={sides}", f"packing.box={box}", "packing.solid_fraction=none")
            self.check_errors((options, "packing.box", *words), ((*options, "--dry-run"), "packing.box", *words))


if __name__ == "__main__":
    unittest.main()
