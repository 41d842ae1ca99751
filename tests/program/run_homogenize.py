# SPDX-License-Identifier: GPL-3.0-or-later
"""equidem homogenize of a cell or a sample, as a user runs it: run_homogenize.py PROGRAM SOURCE_FOLDER [unittest options]."""
import json
import math
import unittest

from program import CASES, CELL, ENSEMBLE, SOURCE, ProgramTest, equidem, flat, result_in, rows_of

REFERENCE, FREE = SOURCE / "data" / "reference", CASES / "free_sample.toml"
KN = 1e9
SPRINGS = "[springs]\nkN = 3.0e8\nkT = 1.2e8\n"


def lattice(kind, kT):
    return f'[assembly]\nkind = "{kind}"\ncolumns = 6\nrows = 6\nradius = 0.005\nperiodic = true\n[springs]\nkN = 1.0e9\nkT = {kT}\n'


class HomogenizeTest(ProgramTest):
    def homogenize(self, case, *options):
        return self.result("homogenize", case, *options)

    def lattice(self, kind, kT, *options):
        return self.homogenize(self.write(lattice(kind, kT)), *options)

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
                result = self.lattice("hexagonal", ratio * KN)
                K, G = math.sqrt(3) / 2 * KN, math.sqrt(3) / 4 * KN * (1 + ratio)
                self.check_close(result["stiffness"], [[K + G, K - G, 0], [K - G, K + G, 0], [0, 0, G]], 1e-12)
                self.check_close(result["bulk_modulus_2d"], K, 1e-12)
                self.check_close(result["shear_modulus"], G, 1e-12)
                self.assertAlmostEqual(result["poisson_ratio"]["plane_strain"], (1 - ratio) / 4, delta=1e-12)
                self.check_close(result["young_modulus"]["plane_stress"], 4 * K * G / (K + G), 1e-12)
                self.assertLess(result["anisotropy"], 1e-12)
                self.check_close(result["relation"]["shear_modulus"], G, 1e-12)
                self.assertEqual((result["coordination_number"], result["status"]), (6, "solved"))
                # The lattice follows the mean strain: Voigt is exact.
                self.check_close(result["bounds"]["voigt"], result["stiffness"], 1e-12)

    def test_square_lattice_and_its_gear_mode(self):
        kT = 0.3 * KN
        result = self.lattice("square", kT)
        self.check_close(result["stiffness"], [[KN, 0, 0], [0, KN, 0], [0, 0, kT / 2]], 1e-12)
        self.assertGreater(result["anisotropy"], 0.1)
        self.assertLess(result["stiffness_axes"]["one_axis"], 1e-12)
        turned = result["stiffness_axes"]["two_directions"] % (math.pi / 2)
        self.assertLess(min(turned, math.pi / 2 - turned), 1e-9)
        self.assertEqual((result["gear_modes"], [motion["kind"] for motion in result["mechanisms"]]), (1, ["gear"]))

    def test_rotation_restrained_shows_eq_53_and_an_unsymmetric_stress(self):
        kT = 0.4 * KN
        result = self.lattice("hexagonal", kT, "effects.rotation=restrained")
        for words in ("not symmetric", "eq. 53", "moments"):
            self.assertIn(words, result["report"])
        K, G, kappa = math.sqrt(3) / 2 * KN, math.sqrt(3) / 4 * (KN + kT), math.sqrt(3) / 2 * kT
        self.check_close(result["gradient_stiffness"], [[K + G, K - G, 0, 0], [K - G, K + G, 0, 0],
                                                        [0, 0, G + kappa, G - kappa], [0, 0, G - kappa, G + kappa]], 1e-12)
        self.check_close(result["displacement_operator"]["shear_modulus"], math.sqrt(3) / 4 * (KN + 3 * kT), 1e-12)
        self.check_close(result["displacement_operator"]["bulk_modulus_2d"], math.sqrt(3) / 2 * (KN - kT), 1e-12)
        self.check_close(result["poisson_ratio"]["plane_strain"], (1 - kT / KN) / 4, 1e-12)

    def test_a_weighted_random_cell_is_a_perfect_continuum(self):
        # kN = kT, k h/l, rotation restrained: sigma = kN eps for every seed (Bolander & Saito 1998).
        for seed in (1, 2):
            result = self.homogenize(CELL, "--seed", seed, "springs.kT=1e9", "springs.weighting=voronoi",
                                     "effects.rotation=restrained")
            self.check_close(result["stiffness"], [[KN, 0, 0], [0, KN, 0], [0, 0, KN / 2]], 1e-12)
            for modulus in ("bulk_modulus_2d", "shear_modulus"):
                self.check_close(result["relation"][modulus], KN / 2, 1e-12)

    def test_the_independent_reference_to_nine_digits(self):
        case = self.of_file(REFERENCE / "perturbed_hexagonal_400.json", "[springs]\nkN = 1.0\nkT = 0.5\n")
        for one in json.loads((REFERENCE / "perturbed_hexagonal_400_stiffness.json").read_text())["results"]:
            with self.subTest(ratio=one["kT_over_kN"], rotations=one["rotations"]):
                rotation = "free" if one["rotations"] == "free" else "restrained"
                result = self.homogenize(case, f"springs.kT={one['kT_over_kN']}", f"effects.rotation={rotation}",
                                         "homogenize.bounds=affine")
                self.check_close(result["stiffness"], one["C_voigt"], 1e-9)
                if rotation == "restrained" and one["kT_over_kN"] != 0:
                    self.check_close(result["gradient_stiffness"], one["C4"], 1e-9)

    def test_springs_share_the_moduli_among_them(self):
        out = self.folder / "out"
        result = self.homogenize(CELL, "--sensitivities", "springs.bond_width=0.5", "--out", out)
        changes = result["sensitivities"]
        self.assertEqual(sorted(changes), ["kM", "kN", "kT", "scatter"])
        for modulus, whole in (("bulk_modulus_2d", 1), ("shear_modulus", 1), ("young_modulus", 1), ("poisson_ratio", 0)):
            self.assertAlmostEqual(sum(changes[kind][modulus] for kind in ("kM", "kN", "kT")), whole, delta=1e-9)
        rows = rows_of(out / "sensitivities.csv")
        self.assertEqual(len(rows), result["contacts"])

        def shares(modulus):
            """Of each contact: its springs times the derivatives by them."""
            return [sum(float(row[spring]) * float(row[change]) for spring, change in (
                ("kN_Pa", f"d{modulus}_dkN"), ("kT_Pa", f"d{modulus}_dkT"), ("kM_N", f"d{modulus}_dkM_per_m2"))) for row in rows]
        self.check_close(sum(shares("E")), result["young_modulus"]["plane_stress"], 1e-9)
        spread = math.sqrt(sum(share**2 for share in shares("K")))
        self.check_close(changes["scatter"]["bulk_modulus_2d"], spread / result["bulk_modulus_2d"], 1e-9)
        for of in ("E", "G", "nu"):
            self.assertGreater((out / f"picture_effect_on_{of}.svg").stat().st_size, 10000)

    def test_scatter_of_springs_softens_the_mean(self):
        few, many = (self.homogenize(CELL, "--sensitivities", "--second-order", probes)["sensitivities"] for probes in (4, 64))
        for modulus in ("bulk_modulus_2d", "shear_modulus", "young_modulus"):
            shift, error = many["mean_shift"][modulus], many["mean_shift_error"][modulus]
            self.assertLess(shift, -10 * error)
            self.assertLess(abs(few["mean_shift"][modulus] - shift), 5 * math.hypot(few["mean_shift_error"][modulus], error))
        done = equidem("homogenize", CELL, "--second-order", "4")
        self.assertEqual(done.returncode, 2, done.stderr)
        self.assertIn("--sensitivities", done.stderr)

    def test_what_springs_do_is_refused_where_it_is_not_known(self):
        for case, options, words, found in ((CELL, ("springs.kT=-0.9e9",), "unstable mode", True),
                                            (FREE, ("homogenize.boundary=traction",), "tractions", True),
                                            (ENSEMBLE, (), "[ensemble]", False)):
            with self.subTest(words):
                done = equidem("homogenize", case, "--sensitivities", *options)
                self.assertEqual(done.returncode, 2, done.stderr)
                self.assertIn(words, done.stderr)
                self.assertEqual("stiffness" in done.stdout, found, done.stdout)  # what was found is delivered


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
        self.write_assembly("braced.json", cell=[n, n], discs=discs, contacts=contacts)
        return self.of_file("braced.json", "[springs]\nkN = 1.0\nkT = 0.3\n")

    def test_discs_without_load_are_named_and_change_nothing(self):
        out = self.folder / "out"
        whole, loose = self.homogenize(self.braced_square(False)), self.homogenize(self.braced_square(True), "--out", out)
        self.check_close(loose["stiffness"], whole["stiffness"], 1e-12)
        whole_shift, loose_shift = (self.homogenize(self.braced_square(hang), "--sensitivities", "--second-order", 4)
                                    ["sensitivities"]["mean_shift"] for hang in (False, True))
        self.check_close([list(loose_shift.values())], [list(whole_shift.values())], 1e-9)
        self.assertEqual([(one["rattlers"], one["discs_removed"]) for one in (whole, loose)], [(0, 0), (1, 2)])
        self.assertIn("disc 16", loose["left_out_parts"][0])
        self.assertEqual(loose["self_stresses"], whole["self_stresses"])
        forces = {(row["i"], row["j"]): float(row["normal_force_N_per_m"]) for row in rows_of(out / "contacts_strain_xy.csv")}
        self.assertEqual(forces["0", "17"], 0)
        self.assertGreater(forces["0", "5"], 0)  # the diagonal of positive shear is stretched

    def test_a_loose_disc_that_widens_the_region_of_a_sample_is_named(self):
        discs = [((i + 0.5 * (row % 2)) * 0.01, row * 0.005 * 3**0.5) for row in range(8) for i in range(8)]
        case = self.of_file("discs.csv", "gap_tolerance = 1e-6\n[springs]\nkN = 1e9\nkT = 5e8\n")
        for loose in ([(0.12, 0.04)], []):
            self.write("x_m,y_m,radius_m\n" + "".join(f"{x},{y},0.005\n" for x, y in [*discs, *loose]), "discs.csv")
            report = self.report("homogenize", case)
            for words in ("1 disc without contacts, the farthest disc 64 at (0.12, 0.04) m, makes the region", "Remove it"):
                self.assertEqual(words in report, bool(loose), report)
            self.assertEqual("every disc carries load" in report, not loose, report)

    def test_given_contacts_that_join_discs_that_lie_anywhere_are_questioned(self):
        places = [(i * 0.01, j * 0.01) for j in range(4) for i in range(4)]
        right = [(i, j) for i, a in enumerate(places) for j, b in enumerate(places)
                 if i < j and 0.0099 < abs(a[0] - b[0]) + abs(a[1] - b[1]) < 0.0101]
        self.write("x_m,y_m,radius_m\n" + "".join(f"{x},{y},0.005\n" for x, y in places), "discs.csv")
        case = self.of_file("discs.csv", "contacts = 'contacts.csv'\n[springs]\nkN = 1e9\nkT = 5e8\n")
        for shift in (0, 1):  # numbers from 1, read as those from 0
            self.write("i,j\n" + "".join(f"{(i + shift) % 16},{(j + shift) % 16}\n" for i, j in right), "contacts.csv")
            self.assertEqual("check that the contacts are too" in flat(self.report("homogenize", case)), bool(shift))
        random = self.report("homogenize", CELL, "assembly.points=random", "assembly.discs=300")
        self.assertNotIn("check that the contacts", flat(random))

    def test_an_unstable_lattice_is_marked_and_a_floppy_one_has_no_modulus(self):
        # The square lattice loses stability for every kT < 0.
        result = self.lattice("square", -0.1 * KN)
        self.assertEqual((result["status"], result["order"]), ("unstable", []))
        self.assertGreater(result["unstable_modes"], 0)
        self.check_error(equidem("homogenize", self.write(lattice("square", 0.0))), 2, "floppy", "kT > 0")


class Report(HomogenizeTest):
    def test_bounds_are_in_order_and_enclose_the_moduli(self):
        result = self.homogenize(CELL)
        self.assertEqual(set(result["bounds"]), {"voigt", "uniform_stress_estimate", "displacement", "traction", "periodic"})
        self.assertLess(result["error_bound"], 1e-6 * KN)
        self.assertLess(result["hill_mandel"], 1e-12)
        self.assertEqual(result["boundary"], "periodic")
        self.assertEqual([(step["lower"], step["upper"]) for step in result["order"]],
                         [("traction", "periodic"), ("periodic", "displacement"), ("displacement", "voigt")])
        for step in result["order"]:
            self.assertGreater(step["margin"], 0, step)
        # The mean field of Abe, (20), (21) with psi = z/(2 pi): K = phi psi kN; (22): nu = (1 - r)/4.
        psi = result["coordination_number"] / (2 * math.pi)
        self.check_close(result["relation"]["bulk_modulus_2d"], result["solid_fraction"] * psi * KN, 1e-12)
        self.check_close(result["relation"]["poisson_ratio"]["plane_strain"], (1 - 0.5) / 4, 1e-12)

    def test_the_report_reads_from_the_network_to_the_bounds(self):
        report = self.done("homogenize", CELL).stdout
        places = [report.find(word) for word in ("assembly", "effects", "rigidity", "stiffness", "error bound", "moduli",
                                                 "anisotropy",
                                                 "fabric", "bounds and estimates", "Voigt", "no bound", "mean field", "order")]
        self.assertEqual(places, sorted(places), report)
        self.assertNotIn(-1, places, report)
        self.assertLessEqual(max(map(len, report.splitlines())), 112, report)

    def test_a_free_sample_has_two_answers_side_by_side(self):
        result = self.homogenize(FREE)
        self.assertEqual(result["boundary"], "displacement")
        self.assertEqual(result["bounds"]["displacement"], result["stiffness"])
        self.assertGreater(result["stiffness"][0][0], result["bounds"]["traction"][0][0])
        pulled = self.homogenize(FREE, "homogenize.boundary=traction", "homogenize.bounds=affine")
        self.assertEqual(pulled["stiffness"], result["bounds"]["traction"])

    def test_the_mean_of_the_stresses_of_the_discs_of_a_unit_strain_is_a_column_of_the_stiffness(self):
        out = self.folder / "out"
        self.done("homogenize", CELL, "--out", out)
        result, discs = result_in(out), rows_of(out / "discs_strain_xx.csv")
        self.assertEqual(len(discs), result["discs"])
        area = sum(float(disc["cell_area_m2"]) for disc in discs)
        mean = sum(float(disc["cell_area_m2"]) * float(disc["stress_xx_Pa"]) for disc in discs) / area
        self.assertLess(abs(mean / 1e-3 - result["stiffness"][0][0]), 1e-9 * KN)


class Refusals(HomogenizeTest):
    def test_what_cannot_be_homogenized(self):
        self.check_errors(((FREE, "homogenize.boundary=periodic"), "homogenize.boundary", "periodic"),
                          ((CELL, "homogenize.boundary=perodic"), "homogenize.boundary", 'Did you mean "periodic"?'),
                          ((FREE, "ensemble.samples=3"), "ensemble", "delaunay"), ((CELL, "--resume"), "--resume", "[ensemble]"),
                          before=("homogenize",))

    def test_a_broken_springs_file_is_named(self):
        text = lattice("hexagonal", 1.0)
        case = self.write('springs = "springs.toml"\n' + text[:text.index("[springs]")])
        self.check_error(equidem("homogenize", case), 2, "springs.toml", "no such file")
        self.write('schema = "equidem-springs/1"\n[springs]\nkN = -1.0\nkT = 0.0\n', "springs.toml")
        self.check_error(equidem("homogenize", case), 2, "springs.toml:3: springs.kN", "out of range")


class FreeSamples(HomogenizeTest):
    def block(self, degrees, more=(), rest=""):
        """A case of a hexagonal block of 8 by 8 discs that lies askew."""
        c, s = math.cos(math.radians(degrees)), math.sin(math.radians(degrees))
        places = [(k + 0.5 * (row % 2), row * math.sqrt(3) / 2) for row in range(8) for k in range(8)] + list(more)
        self.write_assembly("block.json", discs=[[c * x - s * y, s * x + c * y, 0.5] for x, y in places],
                            groups={"base": list(range(8)), "lid": list(range(56, 64))})
        return self.of_file("block.json", f"gap_tolerance = 1e-9\n{SPRINGS}{rest}")

    def test_moduli_do_not_depend_on_how_a_block_lies(self):
        wanted = self.homogenize(self.block(0))
        for degrees in (13, 30, 45, 77):
            found = self.homogenize(self.block(degrees))
            for key, error in (("area", 1e-12), ("solid_fraction", 1e-12), ("bulk_modulus_2d", 1e-10), ("shear_modulus", 1e-10)):
                self.assertAlmostEqual(found[key] / wanted[key], 1, delta=error)

    def test_a_written_assembly_has_the_area_and_the_stress_of_the_one_that_was_made(self):
        test = '[test]\nkind = "uniaxial_tension"\nstress = 2.0e5\n'
        hexagonal = 'kind = "hexagonal"\ncolumns = {}\nrows = {}\nradius = 0.02\n'
        for name, assembly in (("even", hexagonal.format(5, 6)), ("wide", hexagonal.format(6, 5)), ("odd", hexagonal.format(7, 7)),
                               ("delaunay", 'kind = "delaunay"\ndiscs = 60\nradii = {smallest = 0.004, largest = 0.006}\n')):
            for form, suffix in (("json", "json"), ("hdf5", "h5")):
                out = self.folder / f"{name}_{form}"
                made = self.write(f'[assembly]\n{assembly}{SPRINGS}{test}[output]\nassembly = "{form}"\n', "made.toml")
                self.done("solve", made, "--out", out)
                back = self.of_file(out / f"assembly.{suffix}", SPRINGS + test, "back.toml")
                for verb in ("solve", "homogenize"):
                    first, second = (self.result(verb, case) for case in (made, back))
                    for key in ("area", "solid_fraction", "stress", "stiffness", "strain", "poisson_ratio",
                                "stiffness_ratio", "theory",
                                "gauge", "plane_strain"):
                        self.assertEqual(first.get(key), second.get(key), (name, form, verb, key))
                    self.assertIn("area", first)

    def test_a_rattler_at_the_edge_leaves_the_area_as_it_is(self):
        load = '[[support]]\ngroup = "base"\nux = true\nuy = true\n[[load]]\ngroup = "lid"\nkind = "total"\nforce = [0.0, 1.0e5]\n'
        without, beside = (self.result("solve", self.block(0, more, load)) for more in ((), ((8.7, 2.0),)))
        height = 7 * math.sqrt(3) / 2 + 1
        self.assertIn("rattler", beside["report"])
        self.assertAlmostEqual(without["area"], 8.5 * height, delta=1e-10)
        self.assertAlmostEqual(beside["area"], 9.7 * height, delta=1e-10)


if __name__ == "__main__":
    unittest.main()
