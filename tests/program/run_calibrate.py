#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Drives `equidem calibrate` as a user does: run_calibrate.py PROGRAM SOURCE_FOLDER [unittest options]."""
import math
import re
import unittest

import program
from program import CASES, equidem, parse_json

RANDOM = CASES / "calibrate_random.toml"
LATTICE = CASES / "calibrate_lattice.toml"
STRENGTH = CASES / "calibrate_strength.toml"
SMALL = ("--set", "assembly.discs=120", "--set", "strength_target.samples=2")


class Calibrate(program.ProgramTest):
    def calibrated(self, *arguments):
        return parse_json(self.check_done(equidem("calibrate", *arguments, "--json", "-")).stdout)

    def check_close(self, value, wanted, tolerance):
        self.assertTrue(math.isclose(value, wanted, rel_tol=tolerance), (value, wanted))

    def case_with_springs(self, case, file):
        """The case with a springs file in place of [material]."""
        text = re.sub(r"\[material\][^\[]*", "", case.read_text())
        path = self.folder / "with_springs.toml"
        path.write_text(text.replace("[assembly]", f'springs = "{file}"\n[assembly]', 1))
        return path

    def test_json_has_the_documented_keys_and_the_moduli_wanted(self):
        result = self.calibrated(RANDOM)
        for key in ("status", "report", "times", "effects", "version", "kN", "kT", "ratio", "achieved", "iterations",
                    "factorizations", "feasible_poisson_ratio", "method"):
            self.assertIn(key, result)
        self.assertEqual(result["status"], "calibrated")
        achieved = result["achieved"]
        self.check_close(achieved["shear_modulus"], 1e9, 1e-10)
        self.check_close(achieved["poisson_ratio"]["plane_strain"], 0.2, 1e-10)
        self.check_close(achieved["poisson_ratio"]["plane_stress"], 0.25, 1e-10)
        self.check_close(achieved["young_modulus"]["plane_strain"], 2.4e9, 1e-10)
        self.assertLess(achieved["relative_error"], 1e-10)
        self.assertLess(achieved["anisotropy"], 0.05)
        self.assertLessEqual(result["factorizations"], 12)
        self.check_close(result["ratio"], result["kT"] / result["kN"], 1e-15)
        low, high = result["feasible_poisson_ratio"]
        self.assertEqual(low, -1)
        self.assertTrue(0.2 < high < 0.25, high)
        # The mean field is near, and off by more than rounding.
        guess = result["mean_field"]["achieved"]["poisson_ratio"]["plane_strain"]
        self.assertTrue(1e-3 < abs(guess - 0.2) < 0.05, guess)

    def test_the_springs_file_gives_the_moduli_to_the_other_verbs(self):
        file = self.folder / "springs.toml"
        done = self.check_done(equidem("calibrate", RANDOM, "--springs", file))
        self.assertIn(str(file), done.stderr)
        case = self.case_with_springs(RANDOM, "springs.toml")
        moduli = parse_json(self.check_done(equidem("homogenize", case, "--set", "homogenize.bounds=affine",
                                                    "--json", "-")).stdout)
        self.check_close(moduli["shear_modulus"], 1e9, 1e-10)
        self.check_close(moduli["poisson_ratio"]["plane_strain"], 0.2, 1e-10)

    def test_one_springs_file_goes_through_all_verbs_with_its_density(self):
        out = self.folder / "rock"
        rock = self.calibrated(CASES / "packed_rock.toml", "--set", "packing.grains=120", "--out", out)
        density = rock["density"]["discs"]

        def case(name, text):
            path = self.folder / f"{name}.toml"
            path.write_text(f'schema = "equidem/1"\nsprings = "rock/springs.toml"\n{text}')
            return path

        def done(verb, *arguments):
            return parse_json(self.check_done(equidem(verb, *arguments, "--json", "-")).stdout)

        assembly = '[assembly]\nkind = "file"\npath = "rock/assembly.json"\n'
        bonded = case("bonded", assembly)
        self.check_close(done("homogenize", bonded)["young_modulus"]["plane_strain"], 20e9, 1e-9)
        judged = done("stability", bonded)
        self.assertFalse(judged["density_assumed"])
        self.assertEqual(judged["density"], density)
        step = done("run", case("moving", assembly + "[run]\nduration = 1e-6\ngravity = [0.0, -9.81]\n"))["time_step"]
        self.assertLess(step, judged["critical_time_step"])

        box = ('[packing]\ngrains = 120\nsolid_fraction = 0.75\ngap_tolerance = 0.2\nsides = "walls"\n'
               '[packing.radii]\nsmallest = 0.5e-3\nlargest = 1e-3\n')
        packed = self.folder / "packed"
        self.assertEqual(done("pack", case("box", box), "--out", packed)["density"], {"discs": density})
        pulled = '[test]\nkind = "uniaxial_tension"\nstress = 1e6\n'
        own = f'[assembly]\nkind = "file"\npath = "packed/assembly.json"\n{pulled}'
        for verb in ("solve", "homogenize", "stability", "run"):
            with self.subTest(verb=verb):
                both = case("both", own + ("[run]\nduration = 1e-6\n" if verb == "run" else ""))
                self.check_error(equidem(verb, both), 2, "the case gives springs, and so does the assembly file",
                                 "own_springs = false")
        self.check_error(equidem("calibrate", self.without_springs(both)), 2, "own_springs = false")
        alone = done("solve", case("alone", own.replace("[test]", "own_springs = false\n[test]")))
        self.assertEqual(alone["kN"], rock["kN"])

        floor = '[[wall]]\nname = "floor"\npoint = [0.0, 0.0]\nnormal = [0.0, 1.0]\n'
        falling = (f'[grains]\npath = "packed/grains.csv"\n[collisions]\nrestitution = 0.5\nfriction = 0.3\n{floor}'
                   '[run]\nduration = 1e-6\ngravity = [0.0, -9.81]\n')
        self.assertEqual(done("run", case("falling", falling))["status"], "done")

    def without_springs(self, case):
        """The case with a material in place of its springs."""
        path = self.folder / "material.toml"
        text = re.sub(r"springs = .*\n|\[test\][^\[]*|\[run\][^\[]*", "", case.read_text())
        path.write_text(text + '[material]\nshear_modulus = 1e9\npoisson_ratio = 0.2\nplane = "strain"\n')
        return path

    def test_weighting_is_part_of_the_springs_file(self):
        file = self.folder / "springs.toml"
        self.check_done(equidem("calibrate", RANDOM, "--set", "material.weighting=voronoi", "--springs", file))
        self.assertIn('weighting = "voronoi"', file.read_text())

    def test_bonds_of_a_width_are_calibrated_and_the_file_carries_it_to_the_other_verbs(self):
        springs = self.folder / "springs.toml"
        done = self.check_done(equidem("calibrate", RANDOM, "--set", "material.bond_width=1.2", "--springs", springs,
                                       "--json", "-"))
        found = parse_json(done.stdout)
        self.assertIn("bond_width = 1.2", springs.read_text())
        self.assertIn("pb_rmul = 1.2: it resists bending as these do", found["report"])
        self.assertIn("without the bending springs", found["report"])
        diameter = 2 * found["engines"]["radii"][0]
        self.assertAlmostEqual(found["engines"]["pfc"]["pb_kn"][0] * 1.2 * diameter / found["kN"], 1, 12)
        case = self.case_with_springs(RANDOM, "springs.toml")
        cell = parse_json(self.check_done(equidem("homogenize", case, "--json", "-")).stdout)
        self.check_close(cell["shear_modulus"], 1e9, 1e-10)
        self.check_close(cell["poisson_ratio"]["plane_strain"], 0.2, 1e-10)
        self.assertIn("bending springs", cell["effects"]["active"])
        without = self.folder / "without.toml"
        without.write_text(springs.read_text().replace("bond_width = 1.2\n", ""))
        softer = parse_json(self.check_done(equidem("homogenize", case, "--set", f"springs={without}", "--json", "-")).stdout)
        self.assertLess(softer["shear_modulus"], (1 - 1e-3) * cell["shear_modulus"])

    def test_a_springs_file_with_a_bending_spring_means_the_same_as_the_table(self):
        table = "[springs]\nkN = 2.0e9\nkT = 3.0e8\nkM = 4000.0\n"
        (self.folder / "springs.toml").write_text('schema = "equidem-springs/1"\n' + table)
        one, other = self.case_with_springs(RANDOM, "springs.toml"), self.folder / "other.toml"
        other.write_text(re.sub(r"\[material\][^\[]*", table, RANDOM.read_text()))
        read, given = (parse_json(self.check_done(equidem("homogenize", case, "--json", "-")).stdout) for case in (one, other))
        self.assertEqual(read["stiffness"], given["stiffness"])
        done = self.check_done(equidem("stability", one))
        self.assertIn("not sought: bending springs resist rotations too", done.stdout)
        self.check_error(equidem("quasistatic", one), 2, "springs.toml:", "springs.kM", "no bending springs")
        for wrong, words in (("kM = -1.0", ("springs.toml:", "springs.kM", ">= 0")),
                             ("kM = 1.0\nbond_width = 1.0", ("springs.toml:", "kM and bond_width are both given"))):
            with self.subTest(wrong=wrong):
                lines = table.replace("kM = 4000.0", wrong)
                (self.folder / "springs.toml").write_text('schema = "equidem-springs/1"\n' + lines)
                self.check_error(equidem("homogenize", one), 2, *words)
        (self.folder / "springs.toml").write_text('schema = "equidem-springs/1"\n' + table.replace("3.0e8", "-2.0e7"))
        softer = parse_json(self.check_done(equidem("homogenize", one, "--json", "-")).stdout)
        self.assertLess(softer["shear_modulus"], read["shear_modulus"])

    def test_files_are_written_as_asked_and_never_replaced_unasked(self):
        out = self.folder / "out"
        first = self.check_done(equidem("calibrate", LATTICE, "--out", out))
        self.assertEqual({path.name for path in out.iterdir()}, {"result.json", "index.html", "case.toml", "springs.toml", "assembly.json"})
        self.assertIn("springs.toml", first.stdout)
        before = (out / "springs.toml").read_bytes()
        self.check_error(equidem("calibrate", LATTICE, "--springs", out / "springs.toml"), 2, "exists already",
                         "--overwrite")
        self.check_error(equidem("calibrate", LATTICE, "--out", out), 2, "exists already")
        self.assertEqual((out / "springs.toml").read_bytes(), before)
        self.check_done(equidem("calibrate", LATTICE, "--springs", out / "springs.toml", "--overwrite", "--set",
                                "material.poisson_ratio=0.1"))
        self.assertNotEqual((out / "springs.toml").read_bytes(), before)

    def test_without_a_file_the_springs_are_printed(self):
        done = self.check_done(equidem("calibrate", LATTICE))
        self.assertIn('schema = "equidem-springs/1"', done.stdout)
        self.assertIsNone(self.calibrated(LATTICE)["springs_file"])

    def test_a_lattice_takes_the_closed_form(self):
        # Plane stress: kN = E/(sqrt3 (1 - nu)), kT = E (1 - 3 nu)/(sqrt3 (1 - nu²)).
        for given in ([], ["--set", "effects.rotation=restrained"], ["--set", "assembly.periodic=false"]):
            with self.subTest(given=given):
                result = self.calibrated(LATTICE, *given)
                self.check_close(result["kN"], 2e9 / (math.sqrt(3) * 0.7), 1e-14)
                self.check_close(result["kT"], 2e9 * 0.1 / (math.sqrt(3) * 0.91), 1e-13)
                self.assertEqual(result["iterations"], 0)
                self.assertEqual(result["verified"], "assembly.periodic=false" not in given)
                self.assertEqual(result["feasible_poisson_ratio"][0], -1)
                self.check_close(result["feasible_poisson_ratio"][1], 1 / 3, 1e-15)

    def test_out_of_range_gives_the_range_and_a_value_that_works(self):
        out = self.folder / "out"
        done = equidem("calibrate", RANDOM, "--set", "material.poisson_ratio=0.4", "--out", out)
        result = self.check_partial(done, "0.4", "plane strain", "static_only", out=out, status="not_feasible")
        nearest = re.search(r"at most ([0-9.]+[0-9])", done.stderr).group(1)
        low, high = result["feasible_poisson_ratio"]
        self.assertLess(low, high)
        self.assertAlmostEqual(high, float(nearest), delta=2e-6)
        self.assertTrue((out / "assembly.json").exists())
        self.assertFalse((out / "springs.toml").exists())
        result = self.calibrated(RANDOM, "--set", f"material.poisson_ratio={nearest}")
        self.check_close(result["achieved"]["poisson_ratio"]["plane_strain"], float(nearest), 1e-9)

    def test_static_only_is_said_in_the_report(self):
        done = self.check_done(equidem("calibrate", LATTICE, "--set", "material.poisson_ratio=0.4", "--set",
                                       "material.static_only=true"))
        self.assertIn("kT < 0", done.stdout)

    def test_a_free_sample_says_at_which_boundary_it_was_calibrated(self):
        for boundary in ("displacement", "traction"):
            result = self.calibrated(RANDOM, "--set", "assembly.periodic=false", "--set", "assembly.discs=300",
                                     "--set", f"homogenize.boundary={boundary}")
            self.assertEqual(result["boundary"], boundary)
            self.assertIn(boundary, result["report"])
        unasked = self.calibrated(RANDOM, "--set", "assembly.periodic=false", "--set", "assembly.discs=300")
        self.assertEqual(unasked["boundary"], "displacement")

    def test_what_cannot_be_calibrated_is_refused(self):
        self.check_error(equidem("calibrate", CASES / "abe1996_fig6.toml"), 2, "[material]")
        self.check_error(equidem("calibrate", LATTICE, "--set", "assembly.kind=square"), 2, "square lattice", "nu = 0")
        self.check_partial(equidem("calibrate", LATTICE, "--set", "material.poisson_ratio=0.4"), "-1 to 0.333333",
                           "at most 0.333333", "Abe 1996, eq. 34")
        self.check_error(equidem("calibrate", LATTICE, "--set", "material.poisson_ratio=1"), 2, "poisson_ratio")
        assembly = self.folder / "own.json"
        assembly.write_text('{"schema": "equidem-assembly/1", "cell": [2, 2], "discs": [[0, 0, 0.5], [1, 0, 0.5], '
                            '[0.5, 1, 0.5]], "contacts": [[0, 1, 0, 0]], "springs": [[1e9, 1e9]]}')
        case = self.folder / "own.toml"
        case.write_text('schema = "equidem/1"\n[assembly]\nkind = "file"\npath = "own.json"\n[material]\n'
                        'shear_modulus = 1e9\npoisson_ratio = 0.1\nplane = "strain"\n')
        self.check_error(equidem("calibrate", case), 2, "springs of its own", "Remove")

    def test_no_solid_in_plane_strain_is_said_to_be_one(self):
        # K < G/3.
        case = self.folder / "sheet.toml"
        case.write_text('schema = "equidem/1"\n[assembly]\nkind = "delaunay"\ndiscs = 300\nradius = 0.01\n'
                        'periodic = true\n[material]\nshear_modulus = 1e9\nbulk_modulus_2d = 0.1e9\n'
                        'plane = "stress"\n')
        result = self.calibrated(case)
        self.check_close(result["achieved"]["poisson_ratio"]["plane_stress"], -0.9 / 1.1, 1e-10)
        self.assertIsNone(result["achieved"]["poisson_ratio"]["plane_strain"])
        self.assertIsNone(result["achieved"]["young_modulus"]["plane_strain"])
        self.assertEqual(result["report"].count("no isotropic solid"), 2)
        self.assertNotIn("-4.5", result["report"])

    def test_outputs_are_checked_before_anything_is_written(self):
        same = self.folder / "same.json"
        self.check_error(equidem("calibrate", LATTICE, "--json", same, "--springs", same), 2, "both", str(same))
        self.assertFalse(same.exists())
        out = self.folder / "out"
        out.mkdir()
        self.check_error(equidem("calibrate", LATTICE, "--out", out, "--springs", out / ".." / "out" / "case.toml"), 2,
                         "both")
        self.assertEqual(list(out.iterdir()), [])
        missing = self.folder / "missing" / "springs.toml"
        self.check_error(equidem("calibrate", LATTICE, "--springs", missing), 2, "no folder", "missing")
        self.assertFalse(missing.parent.exists())

    def test_the_springs_file_says_of_what_its_moduli_are(self):
        for periodic in ("true", "false"):
            file = self.folder / f"{periodic}.toml"
            self.check_done(equidem("calibrate", LATTICE, "--set", f"assembly.periodic={periodic}", "--springs", file))
            text = file.read_text()
            self.assertEqual("infinite lattice" in text, periodic == "false")
            self.assertEqual("relative error" in text, periodic == "true")
        file = self.folder / "block.toml"
        self.check_done(equidem("calibrate", RANDOM, "--set", "assembly.periodic=false", "--set", "assembly.discs=300",
                                "--springs", file))
        self.assertIn("boundaries of kind displacement", file.read_text())

    def test_agreement_to_rounding_is_no_percentage(self):
        report = self.calibrated(RANDOM, "--set", "material.weighting=voronoi")["report"]
        self.assertIn("as wanted", report)
        self.assertIsNone(re.search(r"e-1\d %", report))

    def test_kT_below_0_names_the_key_that_allows_it(self):
        self.check_partial(equidem("calibrate", LATTICE, "--set", "material.poisson_ratio=0.33333333334"),
                           "static_only = true")

    def test_moduli_softer_than_any_solid_are_questioned(self):
        soft = ("--set", "assembly.discs=100", "--set", "material.shear_modulus=55")
        self.assertIn("softer than any solid", self.calibrated(RANDOM, *soft)["report"])
        for stiff in ((*soft[:2], "--dry-run"), (*soft, "--set", "assembly.radius=1.0")):
            self.assertNotIn("softer than any solid", self.calibrated(RANDOM, *stiff)["report"])

    def test_dry_run_and_quiet(self):
        size = self.calibrated(RANDOM, "--dry-run")
        names = re.findall(r"^(\S.{14})", size["report"], re.MULTILINE)
        self.assertEqual(len(names), len(set(names)), names)
        self.assertEqual(size["status"], "dry_run")
        self.assertGreater(size["unknowns"], 5000)
        done = self.check_done(equidem("calibrate", LATTICE, "--quiet"))
        self.assertEqual((done.stdout, done.stderr), ("", ""))

    def test_the_springs_do_not_depend_on_the_number_of_threads(self):
        one, two = (self.calibrated(RANDOM, "--threads", n) for n in (1, 2))
        self.assertEqual((one["kN"], one["kT"]), (two["kN"], two["kT"]))

    def strength_case(self, motion):
        """The sample of the calibration with its strengths, its ends moved."""
        text = re.sub(r"\[strength(_target)?\][^\[]*", "", STRENGTH.read_text()).replace("discs  = 600", "discs  = 120")
        path = self.folder / "sample.toml"
        path.write_text(text.replace("[assembly]", 'strength = "strength.toml"\n[assembly]', 1) + f"""
[quasistatic]
control = "motion"
[[support]]
group = "bottom"
uy = true
[[support]]
group = "bottom_left"
ux = true
[[support]]
group = "top"
uy = {motion}
""")
        return path

    def test_quasistatic_bears_the_strengths_that_were_calibrated(self):
        file = self.folder / "strength.toml"
        result = parse_json(self.check_done(equidem("calibrate", STRENGTH, *SMALL, "--strength", file, "--json", "-")).stdout)
        first = result["samples"][0]
        self.assertEqual(len(result["samples"]), 2)
        self.check_close(result["achieved"]["tensile"], 5e6, 1e-12)
        self.check_close(result["achieved"]["compressive"], 25e6, 0.005)
        for motion, wanted in ((1e-6, first["tensile"]), (-1e-6, first["compressive"])):
            sample = self.strength_case(motion)
            found = parse_json(self.check_done(equidem("quasistatic", sample, "--json", "-")).stdout)
            self.check_close(found["peak"]["load"] / result["width"], wanted, 1e-9)
        strength = result["contact_strength"]
        self.assertIn(f"tension = {strength['tension']}", file.read_text())
        self.assertGreater(strength["shear_error"], 0)
        self.assertEqual(strength["friction"], 0.5)
        low, high = result["feasible_strength_ratio"]
        self.assertTrue(low < 5 < high)
        self.assertEqual(result["units"]["contact_strength.tension"], "N/m")

    def test_the_friction_or_a_toughness_can_be_asked_for(self):
        friction = parse_json(self.check_done(equidem("calibrate", STRENGTH, *SMALL, "--set", "strength_target.shear_over_tension=1.0",
                                                      "--set", "strength.friction=none", "--out", self.folder / "out",
                                                      "--json", "-")).stdout)
        self.check_done(equidem("calibrate", self.folder / "out" / "case.toml", "--dry-run"))
        self.check_close(friction["contact_strength"]["shear_over_tension"], 1, 1e-12)
        self.check_close(friction["achieved"]["compressive"], 25e6, 0.005)
        notched = ("--set", "strength_target.compressive=none", "--set", "strength_target.notches=[0.002]")
        refused = equidem("calibrate", STRENGTH, *SMALL, *notched, "--set", "strength_target.toughness=9e5")
        self.assertEqual(refused.returncode, 1, refused.stderr)
        self.assertIn("toughness over tensile strength of 0.18 sqrt(m) is not feasible", refused.stderr)
        self.assertIn("times as large have it", refused.stderr)
        low, high = map(float, re.search(r"it has (\S+) to (\S+) sqrt", refused.stderr).groups())
        tough = parse_json(self.check_done(equidem("calibrate", STRENGTH, *SMALL, *notched, "--set",
                                                   f"strength_target.toughness={(low + high) / 2 * 5e6}", "--json", "-")).stdout)
        self.check_close(tough["achieved"]["toughness"], (low + high) / 2 * 5e6, 0.005)

    def test_what_the_tests_of_strength_do_not_use_is_told(self):
        self.assertNotIn("not used", self.check_done(equidem("calibrate", STRENGTH, *SMALL, "--dry-run")).stdout)
        path = self.folder / "acted_on.toml"
        path.write_text(STRENGTH.read_text() + """
[[support]]
group = "left"
ux    = true
[[load]]
group = "right"
force = [1.0, 0.0]
[quasistatic]
legs = [1.0]
""")
        told = r"not used\s+\[\[support\]\], \[\[load\]\], \[quasistatic\]: the tests of"
        for words in (["--dry-run"], []):
            self.assertRegex(self.check_done(equidem("calibrate", path, *SMALL, *words)).stdout, told)

    def test_a_ratio_that_is_not_feasible_gives_the_nearest_strengths_and_the_reason(self):
        out = self.folder / "out"
        done = equidem("calibrate", STRENGTH, *SMALL, "--set", "strength_target.compressive=1e9", "--out", out)
        self.assertEqual(done.returncode, 1, done.stderr)
        result = parse_json((out / "result.json").read_text())
        self.assertEqual(result["status"], "not_feasible")
        for text in (done.stderr, result["refusal"], " ".join(done.stdout.split())):
            self.assertIn("compressive over tensile strength of 200 is not feasible", text)
            self.assertIn("more bonds of each disc", text)
            self.assertIn("friction does not raise it", text)
        low, high = result["feasible_strength_ratio"]
        self.assertTrue(low < high < 200)
        self.check_close(result["achieved"]["compressive"] / result["achieved"]["tensile"], high, 1e-12)
        self.assertEqual(done.stderr.count(f"{high:.4g}"), 1)
        self.assertTrue((out / "index.html").exists())
        self.assertFalse((out / "strength.toml").exists())

    def test_strengths_that_cannot_be_found_are_refused(self):
        self.check_error(equidem("calibrate", STRENGTH, "--set", "strength.tension=1e3"), 2, "beside [strength_target]")
        self.check_error(equidem("calibrate", STRENGTH, "--set", "strength_target.shear_over_tension=1.0"), 2,
                         "strength.friction: it is given beside strength_target.shear_over_tension", "Remove one")
        self.check_error(equidem("calibrate", STRENGTH, "--set", "assembly.periodic=true"), 2, "no ends to pull at or press")
        self.check_error(equidem("calibrate", STRENGTH, "--set", "strength_target.toughness=1e5"), 2, "strength_target")
        self.check_error(equidem("calibrate", STRENGTH, "--springs", self.folder / "k.toml"), 2, "the case for strengths")
        self.check_error(equidem("calibrate", RANDOM, "--strength", self.folder / "k.toml"), 2, "the case for springs")
        self.check_error(equidem("calibrate", STRENGTH, "--set", "springs.kT=-1e8"), 2, "kT < 0")
        notched = ("--set", "strength_target.compressive=none", "--set", "strength_target.toughness=1e5")
        self.check_error(equidem("calibrate", STRENGTH, *notched, "--set", "strength_target.notches=[-0.002]"), 2,
                         "strength_target: the length of the notch is -0.002 m", "the length of the notch is -0.002 m (it must be > 0")
        self.check_error(equidem("calibrate", STRENGTH, *notched, "--set", "strength_target.notches=[0.2]"), 2,
                         "strength_target: a notch of 0.2 m in a sample", "Give shorter notches")
        self.check_error(equidem("calibrate", STRENGTH, *notched), 2, "strength_target: a toughness needs notches")
        for more in ((), ("--dry-run",)):
            self.check_error(equidem("calibrate", STRENGTH, "--set", "springs.bond_width=0.5", *more), 2, "bending springs")
        result = self.calibrated(STRENGTH, "--dry-run")
        self.assertGreater(result["peak_bytes"], 0)


if __name__ == "__main__":
    unittest.main()
