# SPDX-License-Identifier: GPL-3.0-or-later
"""Drives `equidem calibrate` as a user does: run_calibrate.py PROGRAM SOURCE_FOLDER [unittest options]."""
import json
import math
import re
import shutil
import subprocess
import unittest

from program import CASES, ProgramTest, equidem, result_in

RANDOM, LATTICE, STRENGTH = (CASES / f"calibrate_{name}.toml" for name in ("random", "lattice", "strength"))
FREE = ("assembly.periodic=false", "assembly.discs=300")
SMALL = ("assembly.discs=120", "strength_target.samples=2")
NO_COMPRESSION = "strength_target.compressive=none"
YADE = shutil.which("yade")
SCRIPT = """
import json
given = json.load(open("given.json"))
O.materials.append([FrictMat(young=young, poisson=given["poisson"]) for young in given["young"]])
O.materials.append([CohFrictMat(young=young, poisson=given["poisson"]) for young in given["young"]])
found = []
for kind, functor in ((0, Ip2_FrictMat_FrictMat_FrictPhys()), (2, Ip2_CohFrictMat_CohFrictMat_CohFrictPhys())):
    for a, b in ((0, 0), (0, 1), (1, 1)):
        O.bodies.clear(), O.interactions.clear()
        r, s = given["radii"][a], given["radii"][b]
        O.bodies.append([sphere((0, 0, 0), r, material=kind + a), sphere((0.999 * (r + s), 0, 0), s, material=kind + b)])
        geometry, law = ((Ig2_Sphere_Sphere_ScGeom(), Law2_ScGeom_FrictPhys_CundallStrack()) if kind == 0 else
                         (Ig2_Sphere_Sphere_ScGeom6D(), Law2_ScGeom6D_CohFrictPhys_CohesionMoment()))
        O.engines = [ForceResetter(), InsertionSortCollider([Bo1_Sphere_Aabb()]),
                     InteractionLoop([geometry], [functor], [law]), NewtonIntegrator()]
        O.dt = 1e-12
        O.step()
        found.append([O.interactions[0, 1].phys.kn, O.interactions[0, 1].phys.ks])
json.dump(found, open("found.json", "w"))
"""


class CalibrateTest(ProgramTest):
    def calibrated(self, *arguments):
        return self.result("calibrate", *arguments)

    def check_close(self, value, wanted, tolerance):
        self.assertTrue(math.isclose(value, wanted, rel_tol=tolerance), (value, wanted))

    def with_springs(self, springs):
        """The random cell with a springs file, or a table, in place of [material]."""
        text = re.sub(r"\[material\][^\[]*", "" if springs.endswith(".toml") else springs, RANDOM.read_text())
        if springs.endswith(".toml"):
            text = text.replace("[assembly]", f'springs = "{springs}"\n[assembly]', 1)
        return self.write(text, "with_springs.toml" if springs.endswith(".toml") else "with_table.toml")


class Springs(CalibrateTest):
    def test_the_moduli_are_those_wanted(self):
        result = self.calibrated(RANDOM)
        self.assertEqual(result["status"], "calibrated")
        achieved = result["achieved"]
        for value, wanted in ((achieved["shear_modulus"], 1e9), (achieved["poisson_ratio"]["plane_strain"], 0.2),
                              (achieved["poisson_ratio"]["plane_stress"], 0.25), (achieved["young_modulus"]["plane_strain"], 2.4e9)):
            self.check_close(value, wanted, 1e-10)
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

    def test_a_lattice_takes_the_closed_form(self):
        # Plane stress: kN = E/(sqrt3 (1 - nu)), kT = E (1 - 3 nu)/(sqrt3 (1 - nu²)).
        for given in ((), ("effects.rotation=restrained",), ("assembly.periodic=false",)):
            with self.subTest(given=given):
                result = self.calibrated(LATTICE, *given)
                self.check_close(result["kN"], 2e9 / (math.sqrt(3) * 0.7), 1e-14)
                self.check_close(result["kT"], 2e9 * 0.1 / (math.sqrt(3) * 0.91), 1e-13)
                self.assertEqual((result["iterations"], result["verified"]), (0, "assembly.periodic=false" not in given))
                self.assertEqual(result["feasible_poisson_ratio"][0], -1)
                self.check_close(result["feasible_poisson_ratio"][1], 1 / 3, 1e-15)

    def test_bonds_of_a_width_are_calibrated_and_the_file_carries_it_to_the_other_verbs(self):
        springs = self.folder / "springs.toml"
        found = self.calibrated(RANDOM, "material.bond_width=1.2", "--springs", springs)
        self.assertIn("bond_width = 1.2", springs.read_text())
        self.assertIn("pb_rmul = 1.2: it resists bending as these do", found["report"])
        self.assertIn("without the bending springs", found["report"])
        diameter = 2 * found["engines"]["radii"][0]
        self.assertAlmostEqual(found["engines"]["pfc"]["pb_kn"][0] * 1.2 * diameter / found["kN"], 1, 12)
        case = self.with_springs("springs.toml")
        cell = self.result("homogenize", case)
        self.check_close(cell["shear_modulus"], 1e9, 1e-10)
        self.check_close(cell["poisson_ratio"]["plane_strain"], 0.2, 1e-10)
        self.assertIn("bending springs", cell["effects"]["active"])
        without = self.write(springs.read_text().replace("bond_width = 1.2\n", ""), "without.toml")
        self.assertLess(self.result("homogenize", case, f"springs={without}")["shear_modulus"], (1 - 1e-3) * cell["shear_modulus"])

    def test_a_springs_file_with_a_bending_spring_means_the_same_as_the_table(self):
        table = "[springs]\nkN = 2.0e9\nkT = 3.0e8\nkM = 4000.0\n"

        def springs(text):
            return self.write('schema = "equidem-springs/1"\n' + text, "springs.toml")
        springs(table)
        case = self.with_springs("springs.toml")
        read, given = (self.result("homogenize", one) for one in (case, self.with_springs(table)))
        self.assertEqual(read["stiffness"], given["stiffness"])
        self.assertIn("not sought: bending springs resist rotations too", self.report("stability", case))
        self.check_error(equidem("quasistatic", case), 2, "springs.toml:", "springs.kM", "no bending springs")
        for wrong, *words in (("kM = -1.0", "springs.kM", ">= 0"),
                              ("kM = 1.0\nbond_width = 1.0", "kM and bond_width are both given")):
            with self.subTest(wrong=wrong):
                springs(table.replace("kM = 4000.0", wrong))
                self.check_error(equidem("homogenize", case), 2, "springs.toml:", *words)
        springs(table.replace("3.0e8", "-2.0e7"))
        self.assertLess(self.result("homogenize", case)["shear_modulus"], read["shear_modulus"])

    def test_a_free_sample_says_at_which_boundary_it_was_calibrated(self):
        for given, boundary in (((), "displacement"), (("homogenize.boundary=displacement",), "displacement"),
                                (("homogenize.boundary=traction",), "traction")):
            result = self.calibrated(RANDOM, *FREE, *given)
            self.assertEqual(result["boundary"], boundary)
            self.assertIn(boundary, result["report"])

    def test_no_solid_in_plane_strain_is_said_to_be_one(self):
        # K < G/3.
        result = self.calibrated(self.write('[assembly]\nkind = "delaunay"\ndiscs = 300\nradius = 0.01\nperiodic = true\n[material]\n'
                                            'shear_modulus = 1e9\nbulk_modulus_2d = 0.1e9\nplane = "stress"\n'))
        self.check_close(result["achieved"]["poisson_ratio"]["plane_stress"], -0.9 / 1.1, 1e-10)
        for modulus in ("poisson_ratio", "young_modulus"):
            self.assertIsNone(result["achieved"][modulus]["plane_strain"])
        self.assertEqual(result["report"].count("no isotropic solid"), 2)
        self.assertNotIn("-4.5", result["report"])

    def test_reports_read_well(self):
        report = self.calibrated(RANDOM, "material.weighting=voronoi")["report"]
        self.assertIn("as wanted", report)
        self.assertIsNone(re.search(r"e-1\d %", report))  # agreement to rounding is no percentage
        self.assertIn("kT < 0", self.report("calibrate", LATTICE, "material.poisson_ratio=0.4", "material.static_only=true"))
        soft = ("assembly.discs=100", "material.shear_modulus=55")
        for given, told in ((soft, True), ((soft[0], "--dry-run"), False), ((*soft, "assembly.radius=1.0"), False)):
            self.assertEqual("softer than any solid" in self.calibrated(RANDOM, *given)["report"], told, given)


class Files(CalibrateTest):
    def test_one_springs_file_goes_through_all_verbs_with_its_density(self):
        out = self.folder / "rock"
        rock = self.calibrated(CASES / "packed_rock.toml", "packing.grains=120", "--out", out)
        density = rock["density"]["discs"]

        def case(name, text, springs='springs = "rock/springs.toml"\n'):
            return self.write(springs + text, f"{name}.toml")

        assembly = '[assembly]\nkind = "file"\npath = "rock/assembly.json"\n'
        bonded = case("bonded", assembly)
        cell = self.result("homogenize", bonded)
        self.check_close(cell["young_modulus"]["plane_strain"], 20e9, 1e-9)
        self.check_close(cell["shear_modulus"], rock["achieved"]["shear_modulus"], 1e-10)
        pulled = '[[group]]\nname = "one"\ndiscs = [0]\n[[group]]\nname = "other"\ndiscs = [7]\n[[support]]\ngroup = "one"\nux = 0.0\n' \
            'uy = 0.0\n[[load]]\ngroup = "other"\nforce = [1.0, 0.0]\n[[load]]\ngroup = "one"\nforce = [-1.0, 0.0]\n'
        self.done("solve", case("pulled", assembly + pulled))
        judged = self.result("stability", bonded)
        self.assertEqual((judged["density_assumed"], judged["density"]), (False, density))
        step = self.result("run", case("moving", assembly + "[run]\nduration = 1e-6\ngravity = [0.0, -9.81]\n"))["time_step"]
        self.assertLess(step, judged["critical_time_step"])

        box = case("box", '[packing]\ngrains = 120\nsolid_fraction = 0.75\ngap_tolerance = 0.2\nsides = "walls"\n'
                   "[packing.radii]\nsmallest = 0.5e-3\nlargest = 1e-3\n")
        self.assertEqual(self.result("pack", box, "--out", self.folder / "packed")["density"], {"discs": density})
        test = '[test]\nkind = "uniaxial_tension"\nstress = 1e6\n'
        own = '[assembly]\nkind = "file"\npath = "packed/assembly.json"\n'
        both, moving = case("both", own + test), case("both_moving", own + test + "[run]\nduration = 1e-6\n")
        material = case("material", own + '[material]\nshear_modulus = 1e9\npoisson_ratio = 0.2\nplane = "strain"\n', "")
        twice = "the case gives springs, and so does the assembly file"
        self.check_errors(*(((verb, both), twice, "own_springs = false") for verb in ("solve", "homogenize", "stability")),
                          (("run", moving), twice, "own_springs = false"), (("calibrate", material), "own_springs = false"))
        self.assertEqual(self.result("solve", case("alone", own + "own_springs = false\n" + test))["kN"], rock["kN"])

        falling = '[grains]\npath = "packed/grains.csv"\n[collisions]\nrestitution = 0.5\nfriction = 0.3\n[[wall]]\nname = "floor"\n' \
            "point = [0.0, 0.0]\nnormal = [0.0, 1.0]\n[run]\nduration = 1e-6\ngravity = [0.0, -9.81]\n"
        self.assertEqual(self.result("run", case("falling", falling))["status"], "done")

    def test_the_springs_file_is_named_written_as_asked_and_says_of_what_its_moduli_are(self):
        for case, options, there, absent in (
                (RANDOM, ("material.weighting=voronoi",), 'weighting = "voronoi"', "infinite lattice"),
                (RANDOM, FREE, "boundaries of kind displacement", "infinite lattice"),
                (LATTICE, ("assembly.periodic=true",), "relative error", "infinite lattice"),
                (LATTICE, ("assembly.periodic=false",), "infinite lattice", "relative error")):
            with self.subTest(options=options):
                file = self.folder / f"{len(list(self.folder.iterdir()))}.toml"
                self.assertIn(str(file), self.done("calibrate", case, *options, "--springs", file).stderr)
                self.assertIn(there, file.read_text())
                self.assertNotIn(absent, file.read_text())
        self.done("calibrate", LATTICE, "material.poisson_ratio=0.1", "--springs", file, "--overwrite")
        out = self.folder / "out"
        self.assertIn("springs.toml", self.done("calibrate", LATTICE, "--out", out).stdout)
        self.assertEqual({path.name for path in out.iterdir()},
                         {"result.json", "index.html", "case.toml", "springs.toml", "assembly.json"})
        self.assertNotEqual((out / "springs.toml").read_text(), file.read_text())
        without = self.calibrated(LATTICE)
        self.assertIsNone(without["springs_file"])
        self.assertIn('schema = "equidem-springs/1"', without["report"])

    def test_every_program_has_its_parameters_with_units(self):
        result = self.calibrated(RANDOM)
        engines, kN, kT = result["engines"], result["kN"], result["kT"]
        self.assertEqual(engines["depth"], 1)
        for first, second in (("lammps", "k_r k_s"), ("lammps", "kn kt"), ("pfc", "kn ks")):
            self.assertEqual([engines[first][name] for name in second.split()], [kN, kT])
        for young, kn, radius in zip(engines["yade"]["young"], engines["pfc"]["pb_kn"], engines["radii"]):
            self.assertAlmostEqual(young * radius / kN, 1, 12)
            self.assertAlmostEqual(kn * 2 * radius / kN, 1, 12)
        self.assertAlmostEqual(engines["yade"]["poisson"], kT / kN, 14)
        for word in ("bpm/rotational", "gran/hooke/history", "CohFrictMat", "linearpbond", "per metre of depth", "N/m", "Pa/m"):
            self.assertIn(word, result["report"])
        self.assertNotIn("engines", self.calibrated(RANDOM, "material.weighting=voronoi"))  # springs that differ have none
        negative = self.calibrated(RANDOM, "material.poisson_ratio=0.26", "material.static_only=true")
        self.assertNotIn("engines", negative)
        self.assertIn("kT < 0: they have no such springs", negative["report"])

    @unittest.skipIf(YADE is None, "YADE is not installed")
    def test_yade_makes_these_springs_between_bodies_of_any_radii(self):
        result = self.calibrated(RANDOM, "assembly.radius=none", "assembly.radii={smallest=0.004,largest=0.006}")
        engines = result["engines"]
        self.assertGreater(engines["radii"][0], 1.2 * engines["radii"][1])
        self.write(json.dumps({**engines["yade"], "radii": engines["radii"]}), "given.json")
        self.write(SCRIPT, "springs.py")
        done = subprocess.run([YADE, "-x", "-n", "-j1", "springs.py"], cwd=self.folder, capture_output=True, text=True, timeout=120)
        self.assertTrue((self.folder / "found.json").exists(), done.stdout + done.stderr)
        for kn, ks in json.loads((self.folder / "found.json").read_text()):
            self.assertAlmostEqual(kn / result["kN"], 1, 10)
            self.assertAlmostEqual(ks / result["kT"], 1, 10)


class Refusals(CalibrateTest):
    def test_out_of_range_gives_the_range_and_a_value_that_works(self):
        out = self.folder / "out"
        done = equidem("calibrate", RANDOM, "material.poisson_ratio=0.4", "--out", out)
        result = self.check_partial(done, "0.4", "plane strain", "static_only", out=out, status="not_feasible")
        nearest = float(re.search(r"at most ([0-9.]+[0-9])", done.stderr).group(1))
        low, high = result["feasible_poisson_ratio"]
        self.assertLess(low, high)
        self.assertAlmostEqual(high, nearest, delta=2e-6)
        self.check_there(out, "assembly.json")
        self.assertFalse((out / "springs.toml").exists())
        result = self.calibrated(RANDOM, f"material.poisson_ratio={nearest}")
        self.check_close(result["achieved"]["poisson_ratio"]["plane_strain"], nearest, 1e-9)
        for ratio, *words in (("0.4", "-1 to 0.333333", "at most 0.333333", "Abe 1996, eq. 34"),
                              ("0.33333333334", "static_only = true")):
            self.check_partial(equidem("calibrate", LATTICE, f"material.poisson_ratio={ratio}"), *words)

    def test_what_cannot_be_calibrated_is_refused(self):
        self.write_assembly("own.json", cell=[2, 2], discs=[[0, 0, 0.5], [1, 0, 0.5], [0.5, 1, 0.5]], contacts=[[0, 1, 0, 0]],
                            springs=[[1e9, 1e9]])
        own = self.of_file("own.json", '[material]\nshear_modulus = 1e9\npoisson_ratio = 0.1\nplane = "strain"\n')
        notched = (STRENGTH, NO_COMPRESSION, "strength_target.toughness=1e5")
        self.check_errors(
            ((CASES / "abe1996_fig6.toml",), "[material]"), ((LATTICE, "assembly.kind=square"), "square lattice", "nu = 0"),
            ((LATTICE, "material.poisson_ratio=1"), "poisson_ratio"), ((own,), "springs of its own", "Remove"),
            ((STRENGTH, "strength.tension=1e3"), "beside [strength_target]"),
            ((STRENGTH, "strength_target.shear_over_tension=1.0"),
             "strength.friction: it is given beside strength_target.shear_over_tension",
             "Remove one"),
            ((STRENGTH, "assembly.periodic=true"), "no ends to pull at or press"),
            ((STRENGTH, "strength_target.toughness=1e5"), "strength_target"),
            ((STRENGTH, "--springs", self.folder / "k.toml"), "the case for strengths"),
            ((RANDOM, "--strength", self.folder / "k.toml"), "the case for springs"), ((STRENGTH, "springs.kT=-1e8"), "kT < 0"),
            ((*notched, "strength_target.notches=[-0.002]"), "strength_target: the length of the notch is -0.002 m",
             "the length of the notch is -0.002 m (it must be > 0"),
            ((*notched, "strength_target.notches=[0.2]"), "strength_target: a notch of 0.2 m in a sample", "Give shorter notches"),
            (notched, "strength_target: a toughness needs notches"), ((STRENGTH, "springs.bond_width=0.5"), "bending springs"),
            ((STRENGTH, "springs.bond_width=0.5", "--dry-run"), "bending springs"), before=("calibrate",))


class Strengths(CalibrateTest):
    def test_quasistatic_bears_the_strengths_that_were_calibrated(self):
        file = self.folder / "strength.toml"
        result = self.calibrated(STRENGTH, *SMALL, "--strength", file)
        first, strength = result["samples"][0], result["contact_strength"]
        self.assertEqual(len(result["samples"]), 2)
        self.check_close(result["achieved"]["tensile"], 5e6, 1e-12)
        self.check_close(result["achieved"]["compressive"], 25e6, 0.005)
        sample = re.sub(r"\[strength(_target)?\][^\[]*", "", STRENGTH.read_text()).replace("discs  = 600", "discs  = 120")
        sample = sample.replace("[assembly]", 'strength = "strength.toml"\n[assembly]', 1)
        for motion, wanted in ((1e-6, first["tensile"]), (-1e-6, first["compressive"])):  # its ends moved
            case = self.write(sample + '[quasistatic]\ncontrol = "motion"\n[[support]]\ngroup = "bottom"\nuy = true\n[[support]]\n'
                              f'group = "bottom_left"\nux = true\n[[support]]\ngroup = "top"\nuy = {motion}\n')
            self.check_close(self.result("quasistatic", case)["peak"]["load"] / result["width"], wanted, 1e-9)
        self.assertIn(f"tension = {strength['tension']}", file.read_text())
        self.assertGreater(strength["shear_error"], 0)
        self.assertEqual(strength["friction"], 0.5)
        low, high = result["feasible_strength_ratio"]
        self.assertTrue(low < 5 < high)
        self.assertEqual(result["units"]["contact_strength.tension"], "N/m")

    def test_the_friction_or_a_toughness_can_be_asked_for(self):
        out = self.folder / "out"
        friction = self.calibrated(STRENGTH, *SMALL, "strength_target.shear_over_tension=1.0", "strength.friction=none", "--out", out)
        self.done("calibrate", out / "case.toml", "--dry-run")
        self.check_close(friction["contact_strength"]["shear_over_tension"], 1, 1e-12)
        self.check_close(friction["achieved"]["compressive"], 25e6, 0.005)
        notched = (STRENGTH, *SMALL, NO_COMPRESSION, "strength_target.notches=[0.002]")
        refused = equidem("calibrate", *notched, "strength_target.toughness=9e5")
        self.check_error(refused, 1, "toughness over tensile strength of 0.18 sqrt(m) is not feasible", "times as large have it")
        low, high = map(float, re.search(r"it has (\S+) to (\S+) sqrt", refused.stderr).groups())
        wanted = (low + high) / 2 * 5e6
        self.check_close(self.calibrated(*notched, f"strength_target.toughness={wanted}")["achieved"]["toughness"], wanted, 0.005)

    def test_a_ratio_that_is_not_feasible_gives_the_nearest_strengths_and_the_reason(self):
        out = self.folder / "out"
        done = equidem("calibrate", STRENGTH, *SMALL, "strength_target.compressive=1e9", "--out", out)
        result = result_in(out)
        self.assertEqual((done.returncode, result["status"]), (1, "not_feasible"), done.stderr)
        for text in (done.stderr, result["refusal"], " ".join(done.stdout.split())):
            for words in ("compressive over tensile strength of 200 is not feasible", "more bonds of each disc",
                          "friction does not raise it"):
                self.assertIn(words, text)
        low, high = result["feasible_strength_ratio"]
        self.assertTrue(low < high < 200)
        self.check_close(result["achieved"]["compressive"] / result["achieved"]["tensile"], high, 1e-12)
        self.assertEqual(done.stderr.count(f"{high:.4g}"), 1)
        self.check_there(out, "index.html")
        self.assertFalse((out / "strength.toml").exists())


if __name__ == "__main__":
    unittest.main()
