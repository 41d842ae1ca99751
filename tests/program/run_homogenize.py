#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""equidem homogenize, as a user runs it: run_homogenize.py PROGRAM SOURCE_FOLDER [unittest options]."""
import csv
import json
import math
import unittest

from program import CASES, SOURCE, TENSION, ProgramTest, equidem, parse_json

CELL = CASES / "random_cell.toml"
REFERENCE = SOURCE / "data" / "reference"
KN = 1e9

LATTICE = """schema = "equidem/1"
[assembly]
kind = "{kind}"
columns = 6
rows = 6
radius = 0.005
periodic = true
[springs]
kN = 1.0e9
kT = {kT}
"""


class HomogenizeTest(ProgramTest):
    def test_a_loose_disc_that_widens_the_region_of_a_sample_is_named(self):
        discs = [((i + 0.5 * (row % 2)) * 0.01, row * 0.005 * 3**0.5) for row in range(8) for i in range(8)]
        case = self.folder / "case.toml"
        case.write_text('schema = "equidem/1"\n[assembly]\nkind = "file"\npath = "discs.csv"\ngap_tolerance = 1e-6\n'
                        "[springs]\nkN = 1e9\nkT = 5e8\n")
        for loose, warned in (((0.12, 0.04), True), (None, False)):
            (self.folder / "discs.csv").write_text("x_m,y_m,radius_m\n" + "".join(
                f"{x},{y},0.005\n" for x, y in [*discs, *([loose] if loose else [])]))
            done = self.check_done(equidem("homogenize", case))
            for words in ("1 disc without contacts, the first disc 64 at (0.12, 0.04) m, makes the region", "Remove it"):
                self.assertEqual(words in " ".join(done.stdout.split()), warned, done.stdout)
            self.assertEqual("every disc carries load" in done.stdout, not warned, done.stdout)

    def homogenize(self, case, *options):
        return parse_json(self.check_done(equidem("homogenize", case, "--json", "-", *options)).stdout)

    def lattice(self, kind, kT):
        path = self.folder / "lattice.toml"
        path.write_text(LATTICE.format(kind=kind, kT=kT))
        return path

    def check_close(self, computed, expected, tolerance):
        """Every entry of two numbers or matrices, relative to the largest."""
        flat = [[value for row in m for value in row] if isinstance(m, list) else [m] for m in (computed, expected)]
        self.assertEqual(len(flat[0]), len(flat[1]))
        size = max(map(abs, flat[1]))
        for a, b in zip(*flat):
            self.assertLessEqual(abs(a - b), tolerance * size, f"{computed} against {expected}")


class ClosedForms(HomogenizeTest):
    def test_hexagonal_lattice(self):
        for ratio in (-0.3, 0.0, 0.25, 1.0):
            with self.subTest(ratio=ratio):
                kT = ratio * KN
                result = self.homogenize(self.lattice("hexagonal", kT))
                K, G = math.sqrt(3) / 2 * KN, math.sqrt(3) / 4 * (KN + kT)
                self.check_close(result["stiffness"], [[K + G, K - G, 0], [K - G, K + G, 0], [0, 0, G]], 1e-12)
                self.check_close(result["bulk_modulus_2d"], K, 1e-12)
                self.check_close(result["shear_modulus"], G, 1e-12)
                self.assertAlmostEqual(result["poisson_ratio"]["plane_strain"], (1 - ratio) / 4, delta=1e-12)
                self.check_close(result["young_modulus"]["plane_stress"], 4 * K * G / (K + G), 1e-12)
                self.assertLess(result["anisotropy"], 1e-12)
                self.check_close(result["relation"]["shear_modulus"], G, 1e-12)
                self.assertEqual(result["coordination_number"], 6)
                self.assertEqual(result["status"], "solved")
                # The lattice follows the mean strain: Voigt is exact.
                self.check_close(result["bounds"]["voigt"], result["stiffness"], 1e-12)

    def test_square_lattice_and_its_gear_mode(self):
        kT = 0.3 * KN
        result = self.homogenize(self.lattice("square", kT))
        self.check_close(result["stiffness"], [[KN, 0, 0], [0, KN, 0], [0, 0, kT / 2]], 1e-12)
        self.assertGreater(result["anisotropy"], 0.1)
        self.assertLess(result["stiffness_axes"]["one_axis"], 1e-12)
        turned = result["stiffness_axes"]["two_directions"] % (math.pi / 2)
        self.assertLess(min(turned, math.pi / 2 - turned), 1e-9)
        self.assertEqual(result["gear_modes"], 1)
        self.assertEqual([motion["kind"] for motion in result["mechanisms"]], ["gear"])

    def test_rotation_restrained_shows_eq_53_and_an_unsymmetric_stress(self):
        kT = 0.4 * KN
        done = self.check_done(equidem("homogenize", self.lattice("hexagonal", kT), "--set",
                                       "effects.rotation=restrained"))
        for words in ("not symmetric", "eq. 53", "moments"):
            self.assertIn(words, done.stdout)
        result = self.homogenize(self.lattice("hexagonal", kT), "--set", "effects.rotation=restrained")
        K, G, kappa = math.sqrt(3) / 2 * KN, math.sqrt(3) / 4 * (KN + kT), math.sqrt(3) / 2 * kT
        self.check_close(result["gradient_stiffness"], [[K + G, K - G, 0, 0], [K - G, K + G, 0, 0],
                                                        [0, 0, G + kappa, G - kappa], [0, 0, G - kappa, G + kappa]],
                         1e-12)
        self.check_close(result["displacement_operator"]["shear_modulus"], math.sqrt(3) / 4 * (KN + 3 * kT), 1e-12)
        self.check_close(result["displacement_operator"]["bulk_modulus_2d"], math.sqrt(3) / 2 * (KN - kT), 1e-12)
        self.check_close(result["poisson_ratio"]["plane_strain"], (1 - kT / KN) / 4, 1e-12)

    def test_a_weighted_random_cell_is_a_perfect_continuum(self):
        # kN = kT, k h/l, rotation restrained: sigma = kN eps for every seed (Bolander & Saito 1998).
        for seed in (1, 2):
            result = self.homogenize(CELL, "--seed", seed, "--set", "springs.kT=1e9", "--set",
                                     "springs.weighting=voronoi", "--set", "effects.rotation=restrained")
            self.check_close(result["stiffness"], [[KN, 0, 0], [0, KN, 0], [0, 0, KN / 2]], 1e-12)
            for modulus in ("bulk_modulus_2d", "shear_modulus"):
                self.check_close(result["relation"][modulus], KN / 2, 1e-12)

    def test_the_independent_reference_to_nine_digits(self):
        case = self.folder / "reference.toml"
        case.write_text(f"""schema = "equidem/1"
[assembly]
kind = "file"
path = "{REFERENCE / 'perturbed_hexagonal_400.json'}"
[springs]
kN = 1.0
kT = 0.5
""")
        known = json.loads((REFERENCE / "perturbed_hexagonal_400_stiffness.json").read_text())["results"]
        for one in known:
            with self.subTest(ratio=one["kT_over_kN"], rotations=one["rotations"]):
                rotation = "free" if one["rotations"] == "free" else "restrained"
                result = self.homogenize(case, "--set", f"springs.kT={one['kT_over_kN']}", "--set",
                                         f"effects.rotation={rotation}", "--set", "homogenize.bounds=affine")
                self.check_close(result["stiffness"], one["C_voigt"], 1e-9)
                if rotation == "restrained" and one["kT_over_kN"] != 0:
                    self.check_close(result["gradient_stiffness"], one["C4"], 1e-9)

    def test_springs_share_the_moduli_among_them(self):
        out = self.folder / "out"
        result = self.homogenize(CELL, "--sensitivities", "--set", "springs.bond_width=0.5", "--out", out)
        changes = result["sensitivities"]
        self.assertEqual(sorted(changes), ["kM", "kN", "kT", "scatter"])
        for modulus, whole in (("bulk_modulus_2d", 1), ("shear_modulus", 1), ("young_modulus", 1), ("poisson_ratio", 0)):
            self.assertAlmostEqual(sum(changes[kind][modulus] for kind in ("kM", "kN", "kT")), whole, delta=1e-9)
        rows = list(csv.DictReader((out / "sensitivities.csv").read_text().splitlines()))
        self.assertEqual(len(rows), result["contacts"])
        stiff = sum(float(row["kN_Pa"]) * float(row["dE_dkN"]) + float(row["kT_Pa"]) * float(row["dE_dkT"])
                    + float(row["kM_N"]) * float(row["dE_dkM_per_m2"]) for row in rows)
        self.check_close(stiff, result["young_modulus"]["plane_stress"], 1e-9)
        spread = math.sqrt(sum((float(row["kN_Pa"]) * float(row["dK_dkN"]) + float(row["kT_Pa"])
                                * float(row["dK_dkT"]) + float(row["kM_N"]) * float(row["dK_dkM_per_m2"])) ** 2
                               for row in rows))
        self.check_close(changes["scatter"]["bulk_modulus_2d"], spread / result["bulk_modulus_2d"], 1e-9)
        for of in ("E", "G", "nu"):
            self.assertGreater((out / f"picture_effect_on_{of}.svg").stat().st_size, 10000)

    def test_what_springs_do_is_refused_where_it_is_not_known(self):
        for case, options, words in ((CELL, ("springs.kT=-0.9e9",), "unstable mode"),
                                     (CASES / "free_sample.toml", ("homogenize.boundary=traction",), "tractions"),
                                     (CASES / "ensemble.toml", (), "[ensemble]")):
            with self.subTest(words):
                done = equidem("homogenize", case, "--sensitivities", *(word for one in options for word in ("--set", one)))
                self.assertEqual(done.returncode, 2, done.stderr)
                self.assertIn(words, done.stderr)
                # what was found is delivered
                self.assertEqual("stiffness" in done.stdout, words in ("unstable mode", "tractions"), done.stdout)


class Rigidity(HomogenizeTest):
    def braced_square(self, loose):
        """A periodic 4 x 4 square lattice with one diagonal in each square, and discs that carry no load."""
        n = 4
        discs = [[q + 0.5, r + 0.5, 0.5] for r in range(n) for q in range(n)]
        contacts = [[r * n + q, (r + dr) % n * n + (q + dq) % n, (q + dq) // n, (r + dr) // n]
                    for r in range(n) for q in range(n) for dq, dr in ((1, 0), (0, 1), (1, 1))]
        if loose:
            discs += [[2.0, 2.0, 0.1], [1.0, 1.2, 0.1]]  # touching nothing; hanging on disc 0
            contacts.append([0, n * n + 1, 0, 0])
        (self.folder / "braced.json").write_text(json.dumps(
            {"schema": "equidem-assembly/1", "cell": [n, n], "discs": discs, "contacts": contacts}))
        case = self.folder / "braced.toml"
        case.write_text('schema = "equidem/1"\n[assembly]\nkind = "file"\npath = "braced.json"\n'
                        '[springs]\nkN = 1.0\nkT = 0.3\n')
        return case

    def test_discs_without_load_are_named_and_change_nothing(self):
        whole = self.homogenize(self.braced_square(loose=False))
        loose = self.homogenize(self.braced_square(loose=True))
        self.check_close(loose["stiffness"], whole["stiffness"], 1e-12)
        self.assertEqual((whole["rattlers"], whole["discs_removed"]), (0, 0))
        self.assertEqual((loose["rattlers"], loose["discs_removed"]), (1, 2))
        self.assertIn("disc 16", loose["left_out"][0])
        self.assertEqual(loose["self_stresses"], whole["self_stresses"])

    def test_left_out_contacts_carry_nothing_in_the_files(self):
        out = self.folder / "out"
        self.check_done(equidem("homogenize", self.braced_square(loose=True), "--out", out))
        with open(out / "contacts_strain_xy.csv", newline="") as file:
            forces = {(row["i"], row["j"]): float(row["normal_force_N_per_m"]) for row in csv.DictReader(file)}
        self.assertEqual(forces["0", "17"], 0)
        self.assertGreater(forces["0", "5"], 0)  # the diagonal of positive shear is stretched

    def test_a_floppy_network_prints_no_modulus(self):
        self.check_error(equidem("homogenize", self.lattice("square", 0.0)), 2, "floppy", "kT > 0")

    def test_an_unstable_lattice_is_marked(self):
        # The square lattice gives way for every kT < 0.
        result = self.homogenize(self.lattice("square", -0.1 * KN))
        self.assertEqual(result["status"], "unstable")
        self.assertGreater(result["unstable_modes"], 0)
        self.assertEqual(result["order"], [])


class Report(HomogenizeTest):
    def test_json_has_the_documented_keys(self):
        result = self.homogenize(CELL)
        for key in ("status", "report", "times", "effects", "version", "stiffness", "stress_asymmetry", "shear_modulus",
                    "bulk_modulus_2d", "poisson_ratio", "young_modulus", "anisotropy", "coordination_number",
                    "solid_fraction", "fabric", "bounds", "rattlers", "mechanisms", "self_stresses", "error_bound",
                    "relative_residual", "condition", "unknowns"):
            self.assertIn(key, result)
        self.assertEqual(set(result["bounds"]), {"voigt", "uniform_stress_estimate", "displacement", "traction",
                                                 "periodic"})
        self.assertLess(result["error_bound"], 1e-6 * KN)
        self.assertLess(result["hill_mandel"], 1e-12)
        self.assertEqual(result["boundary"], "periodic")

    def test_bounds_are_in_order_and_enclose_the_moduli(self):
        result = self.homogenize(CELL)
        self.assertEqual([(step["lower"], step["upper"]) for step in result["order"]],
                         [("traction", "periodic"), ("periodic", "displacement"), ("displacement", "voigt")])
        for step in result["order"]:
            self.assertGreater(step["margin"], 0, step)

    def test_the_mean_field_of_abe_stands_beside(self):
        # (20), (21) with psi = z/(2 pi): K = phi psi kN; (22): nu = (1 - r)/4.
        result = self.homogenize(CELL)
        psi = result["coordination_number"] / (2 * math.pi)
        self.check_close(result["relation"]["bulk_modulus_2d"], result["solid_fraction"] * psi * KN, 1e-12)
        self.check_close(result["relation"]["poisson_ratio"]["plane_strain"], (1 - 0.5) / 4, 1e-12)

    def test_the_report_reads_from_the_network_to_the_bounds(self):
        report = self.check_done(equidem("homogenize", CELL)).stdout
        places = [report.find(word) for word in ("assembly", "effects", "rigidity", "stiffness", "error bound", "moduli",
                                                 "anisotropy", "fabric", "bounds and estimates", "Voigt", "no bound",
                                                 "mean field", "order")]
        self.assertEqual(places, sorted(places), report)
        self.assertNotIn(-1, places, report)
        self.assertLessEqual(max(map(len, report.splitlines())), 112, report)

    def test_a_free_sample_has_two_answers_side_by_side(self):
        result = self.homogenize(CASES / "free_sample.toml")
        self.assertEqual(result["boundary"], "displacement")
        self.assertEqual(result["bounds"]["displacement"], result["stiffness"])
        self.assertGreater(result["stiffness"][0][0], result["bounds"]["traction"][0][0])
        pulled = self.homogenize(CASES / "free_sample.toml", "--set", "homogenize.boundary=traction",
                                 "--set", "homogenize.bounds=affine")
        self.assertEqual(pulled["stiffness"], result["bounds"]["traction"])

    def test_what_acts_in_the_case_is_called_unused(self):
        done = self.check_done(equidem("homogenize", TENSION))
        self.assertRegex(done.stdout, r"not used +\[test\]: ")
        self.assertNotIn("not used", self.check_done(equidem("homogenize", CELL)).stdout)

    def test_the_answer_does_not_depend_on_the_number_of_threads(self):
        answers = [self.homogenize(CELL, "--threads", n) for n in (1, 2, 3)]
        for answer in answers[1:]:
            for key in ("stiffness", "bounds", "tangential_part", "fabric"):
                self.assertEqual(answer[key], answers[0][key])

    def test_files_are_written_and_the_echoed_case_repeats_the_result(self):
        out = self.folder / "out"
        done = self.check_done(equidem("homogenize", CELL, "--out", out))
        self.assertIn(str(out), done.stderr)
        names = {path.name for path in out.iterdir()}
        for state in ("strain_xx", "strain_yy", "strain_xy"):
            self.assertLessEqual({f"discs_{state}.csv", f"contacts_{state}.csv", f"state_{state}.vtm",
                                  f"picture_{state}.svg", f"picture_{state}.png"}, names)
        first = parse_json((out / "result.json").read_text())
        self.assertEqual(self.homogenize(out / "case.toml")["stiffness"], first["stiffness"])
        # The mean of the stresses of the discs of a unit strain is a column of the stiffness.
        with open(out / "discs_strain_xx.csv", newline="") as file:
            discs = list(csv.DictReader(file))
        self.assertEqual(len(discs), first["discs"])
        area = sum(float(disc["cell_area_m2"]) for disc in discs)
        mean = sum(float(disc["cell_area_m2"]) * float(disc["stress_xx_Pa"]) for disc in discs) / area
        self.assertLess(abs(mean / 1e-3 - first["stiffness"][0][0]), 1e-9 * KN)
        self.check_error(equidem("homogenize", CELL, "--out", out), 2, "exists already", "--overwrite")

    def test_dry_run_solves_nothing(self):
        out = self.folder / "out"
        size = parse_json(self.check_done(equidem("homogenize", CELL, "--dry-run", "--out", out, "--json", "-")).stdout)
        self.assertEqual(size["status"], "dry_run")
        self.assertEqual(size["factorizations"], 3)
        self.assertGreater(size["unknowns"], 1000)
        self.assertFalse(out.exists())


class Refusals(HomogenizeTest):
    def test_a_free_assembly_has_no_images(self):
        self.check_error(equidem("homogenize", CASES / "free_sample.toml", "--set", "homogenize.boundary=periodic"), 2,
                         "homogenize.boundary", "periodic")

    def test_a_misspelt_boundary_is_named(self):
        self.check_error(equidem("homogenize", CELL, "--set", "homogenize.boundary=perodic"), 2, "homogenize.boundary",
                         'Did you mean "periodic"?')

    def test_lattices_make_no_ensemble(self):
        self.check_error(equidem("homogenize", CASES / "free_sample.toml", "--set", "ensemble.samples=3"), 2, "ensemble",
                         "delaunay")

    def test_nothing_to_resume(self):
        self.check_error(equidem("homogenize", CELL, "--resume"), 2, "--resume", "[ensemble]")

    def test_a_broken_springs_file_is_named(self):
        case = self.folder / "case.toml"
        text = LATTICE.format(kind="hexagonal", kT=1.0)
        case.write_text('springs = "springs.toml"\n' + text[:text.index("[springs]")])
        self.check_error(equidem("homogenize", case), 2, "springs.toml", "no such file")
        (self.folder / "springs.toml").write_text('schema = "equidem-springs/1"\n[springs]\nkN = -1.0\nkT = 0.0\n')
        self.check_error(equidem("homogenize", case), 2, "springs.toml:3: springs.kN", "out of range")


class FreeSamples(HomogenizeTest):
    SPRINGS = "[springs]\nkN = 3.0e8\nkT = 1.2e8\n"

    def case(self, name, assembly, more=""):
        path = self.folder / name
        path.write_text('schema = "equidem/1"\n[assembly]\n' + assembly + self.SPRINGS + more)
        return path

    def block(self, degrees, more=()):
        """A case of a hexagonal block of 8 by 8 discs that lies askew."""
        c, s = math.cos(math.radians(degrees)), math.sin(math.radians(degrees))
        places = [(k + 0.5 * (row % 2), row * math.sqrt(3) / 2) for row in range(8) for k in range(8)] + list(more)
        discs = [[c * x - s * y, s * x + c * y, 0.5] for x, y in places]
        groups = {"base": list(range(8)), "lid": list(range(56, 64))}
        (self.folder / f"block{degrees}.json").write_text(json.dumps(
            {"schema": "equidem-assembly/1", "discs": discs, "groups": groups}))
        return f'kind = "file"\npath = "block{degrees}.json"\ngap_tolerance = 1e-9\n'

    def test_moduli_do_not_depend_on_how_a_block_lies(self):
        wanted = self.homogenize(self.case("as_it_lies.toml", self.block(0)))
        for degrees in (13, 30, 45, 77):
            found = self.homogenize(self.case("turned.toml", self.block(degrees)))
            for key in ("area", "solid_fraction"):
                self.assertAlmostEqual(found[key] / wanted[key], 1, delta=1e-12)
            for key in ("bulk_modulus_2d", "shear_modulus"):
                self.assertAlmostEqual(found[key] / wanted[key], 1, delta=1e-10)

    def test_a_written_assembly_has_the_area_and_the_stress_of_the_one_that_was_made(self):
        test = '[test]\nkind = "uniaxial_tension"\nstress = 2.0e5\n'
        kinds = {"hexagonal": 'kind = "hexagonal"\ncolumns = 5\nrows = 6\nradius = 0.02\n',
                 "odd": 'kind = "hexagonal"\ncolumns = 7\nrows = 7\nradius = 0.02\n',
                 "delaunay": 'kind = "delaunay"\ndiscs = 60\nradii = {smallest = 0.004, largest = 0.006}\n'}
        for name, assembly in kinds.items():
            for form, suffix in (("json", "json"), ("hdf5", "h5")):
                out = self.folder / f"{name}_{form}"
                made = self.case("made.toml", assembly, test + f'[output]\nassembly = "{form}"\n')
                self.check_done(equidem("solve", made, "--out", out))
                back = self.case("back.toml", f'kind = "file"\npath = "{out.name}/assembly.{suffix}"\n', test)
                for verb in ("solve", "homogenize"):
                    first, second = (parse_json(self.check_done(equidem(verb, case, "--json", "-")).stdout)
                                     for case in (made, back))
                    for key in ("area", "solid_fraction", "stress", "stiffness"):
                        self.assertEqual(first.get(key), second.get(key), (name, form, verb, key))
                    self.assertIn("area", first)

    def test_a_rattler_at_the_edge_leaves_the_area_as_it_is(self):
        load = ('[[support]]\ngroup = "base"\nux = true\nuy = true\n'
                '[[load]]\ngroup = "lid"\nkind = "total"\nforce = [0.0, 1.0e5]\n')
        results = []
        for more in ((), ((8.7, 2.0),)):
            case = self.case("held.toml", self.block(0, more), load)
            results.append(parse_json(self.check_done(equidem("solve", case, "--json", "-")).stdout))
        without, beside = results
        height = 7 * math.sqrt(3) / 2 + 1
        self.assertIn("rattler", beside["report"])
        self.assertAlmostEqual(without["area"], 8.5 * height, delta=1e-10)
        self.assertAlmostEqual(beside["area"], 9.7 * height, delta=1e-10)


if __name__ == "__main__":
    unittest.main()
