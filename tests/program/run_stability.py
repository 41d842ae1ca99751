# SPDX-License-Identifier: GPL-3.0-or-later
"""equidem stability, and forces at rest from pack to moduli and critical loads, as a user runs them: run_stability.py PROGRAM
SOURCE_FOLDER [unittest options]."""
import json
import math
import unittest

from program import CASES, CELL, TENSION, ProgramTest, equidem, flat, result_in, rows_of

LATTICE, COLUMN = CASES / "hexagonal_cell.toml", CASES / "column.toml"
RADIUS, DENSITY, KN = 0.005, 2500.0, 1e9
MASS = DENSITY * math.pi * RADIUS**2
PRESTRESS = "effects.prestress=on"


class StabilityTest(ProgramTest):
    def stability(self, case, *options):
        return self.result("stability", case, *options)

    def lattice(self, kind, ratio, *options):
        return self.stability(LATTICE, f"assembly.kind={kind}", f"springs.kT={ratio * KN!r}", *options)

    def block(self, size, *options):
        return self.stability(TENSION, f"assembly.columns={size}", f"assembly.rows={size}", *options)

    def check_relative(self, value, expected, tolerance):
        self.assertLessEqual(abs(value - expected), tolerance * abs(expected), f"{value} against {expected}")


class Lattices(StabilityTest):
    def test_the_hexagonal_lattice_is_lost_at_m(self):
        result = self.lattice("hexagonal", 0.5)
        self.assertLess(abs(result["critical_ratio"] + 1 / 3), 1e-10)
        self.assertEqual(result["critical_wave_vector_name"], "M")
        self.assertEqual([p["name"] for p in result["critical_wave_vectors"]], ["M", "M", "M"])
        self.check_relative(math.hypot(*result["critical_wave_vector"]), 2 * math.pi / (2 * math.sqrt(3) * RADIUS), 1e-12)
        self.assertEqual((result["primitive_cell"]["discs"], result["primitive_cell"]["copies"]), (1, 16))
        self.assertEqual((result["status"], result["mechanisms"]["count"]), ("stable", 0))

    def test_frequencies_and_time_steps_of_f10(self):
        for ratio in (0, 0.2, 1 / 3, 0.5, 1):
            for body, beta in (("disc", 0.5), ("sphere", 0.4)):
                mass = MASS if body == "disc" else DENSITY * 4 / 3 * math.pi * RADIUS**3
                for kind, squared in (("hexagonal", max(6 + 2 * ratio, 12 * ratio / beta)),
                                      ("square", max(4 + 4 * ratio, 8 * ratio / beta))):
                    with self.subTest(ratio=ratio, body=body, kind=kind):
                        result = self.lattice(kind, ratio, f"assembly.body={body}")
                        omega = math.sqrt(squared * KN / mass)
                        self.check_relative(result["omega_max"], omega, 1e-10)
                        self.check_relative(result["zone_omega_max"], omega, 1e-10)
                        self.check_relative(result["critical_time_step"], 2 / omega, 1e-10)
                        self.assertLessEqual(result["element_bound_time_step"], result["critical_time_step"] * (1 + 1e-12))

    def test_sound_and_rotational_gap_of_f9(self):
        for ratio in (0.1, 0.5, 1):
            result = self.lattice("hexagonal", ratio)
            for kind, share in (("longitudinal", 3), ("transverse", 1)):
                for speed in result["sound_speeds"][kind] + result["sound_speeds"]["homogenized_" + kind]:
                    self.check_relative(speed, math.sqrt(0.375 * (share + ratio) * KN * 4 * RADIUS**2 / MASS), 1e-12)
            self.check_relative(result["rotational_gap"], math.sqrt(24 * ratio * KN / MASS), 1e-12)

    def test_the_square_lattice_is_lost_at_once_and_turns_like_gears(self):
        result = self.lattice("square", 0.5)
        self.assertEqual((result["critical_ratio"], result["status"], result["mechanisms"]["count"]), (0, "mechanism", 1))
        self.assertIn("gears", result["mechanisms"]["description"][0])

    def test_negative_springs_are_stable_in_statics_and_grow_in_motion(self):
        result = self.lattice("hexagonal", -0.1)
        self.assertEqual((result["status"], result["negative_pivots"], result["growth_wave_vector_name"]), ("stable", 16, "Gamma"))
        self.check_relative(result["growth_rate"], math.sqrt(24 * 0.1 * KN / MASS), 1e-10)
        self.check_relative(result["ratio_margin"], 1 / 3 - 0.1, 1e-9)
        report = flat(result["report"])
        self.assertIn("a maximum of the energy, not a minimum", report)
        self.assertIn("with kT < 0 no time step is stable", report)
        self.assertNotIn("stable below", report)
        self.assertNotIn("guaranteed", report)
        self.assertEqual(self.lattice("hexagonal", -0.34)["status"], "unstable")

    def test_negative_springs_that_no_motion_feels_do_not_grow(self):
        discs = [[x + y % 2, y * math.sqrt(3), 1] for y in range(2) for x in (0, 2)]
        contacts, springs = [], []
        for d, (x, y, _) in enumerate(discs):
            right, up = d ^ 1, (d + 2) % 4
            contacts += [[d, right, int(x > 1), 0], [d, up, 0, int(d > 1)]]
            # the other neighbour above: a column to the left from even rows, to the right from odd ones
            contacts += [[d, up ^ 1, (-1 if x < 1 else 0) if y == 0 else (1 if x > 2 else 0), int(d > 1)]]
            springs += [[1.0, 0.5], [1.0, 0.5], [1.0, -0.01 if d == 0 else 0.5]]
        self.write_assembly("cell.json", cell=[4, 2 * math.sqrt(3)], discs=discs, contacts=contacts, springs=springs)
        self.assertIn("growth none: some kT are negative, but no motion has negative energy",
                      self.report("stability", self.of_file("cell.json")))

    def test_times_scale_with_the_root_of_the_density(self):
        given = self.stability(LATTICE)
        assumed = self.stability(self.write("".join(line for line in LATTICE.read_text().splitlines(True) if "density" not in line)))
        self.assertIs(given["density_assumed"], False)
        self.assertIs(assumed["density_assumed"], True)
        self.check_relative(assumed["critical_time_step"] * math.sqrt(DENSITY), given["critical_time_step"], 1e-12)
        self.assertIn("DENSITY ASSUMED", assumed["report"])
        rock = self.stability(CASES / "packed_rock.toml", "packing.grains=50")  # the density of a continuum
        self.assertIs(rock["density_assumed"], False)
        self.check_relative(rock["density"], 2300 / 0.82, 1e-12)

    def test_a_cell_of_one_disc_has_only_the_waves_of_the_infinite_lattice(self):
        for ratio in (0, -0.1):
            result = self.lattice("square", ratio, "assembly.columns=1", "assembly.rows=1")
            self.assertEqual((result["omega_max"], result["critical_time_step"], result["status"]), (0, None, "mechanism"))
            self.check_relative(result["zone_omega_max"], math.sqrt(4 * KN / MASS), 1e-10)
            self.assertGreater(result["mechanisms"]["free_waves"], 0)
            self.assertIn("that repeats with the cell", flat(result["report"]))
        self.check_relative(result["growth_rate"], math.sqrt(8 * 0.1 / 0.5 * KN / MASS), 1e-10)

    def test_tables_of_the_waves_and_of_the_critical_ratio_over_the_zone(self):
        folder = self.folder / "waves"
        self.done("stability", LATTICE, "--out", folder)
        rows = rows_of(folder / "dispersion.csv")
        self.assertEqual([row["point"] for row in rows if row["point"]], ["Gamma", "M", "K", "Gamma"])
        translations = [row[f"omega_{branch}_rad_per_s"] for row in rows if row["point"] == "Gamma" for branch in (1, 2)]
        self.assertEqual(translations, ["0"] * 4)
        grid = rows_of(folder / "critical_ratio.csv")
        self.assertEqual(len(grid), 48 * 48)
        self.assertAlmostEqual(max(float(row["critical_ratio"]) for row in grid), -1 / 3, delta=1e-12)


class OtherCases(StabilityTest):
    def test_free_edges_are_lost_before_the_lattice(self):
        for size, ratio in {5: -0.3360, 11: -0.2754, 19: -0.2658}.items():
            result = self.block(size)
            self.assertAlmostEqual(result["critical_ratio"], ratio, delta=5e-5)
            self.assertIsNone(result["critical_wave_vector"])
            self.assertIn("critical_motion", result)

    def test_natural_frequencies_fall_with_the_size_of_the_sample(self):
        lowest = {}
        for size in (11, 21, 41):
            result = self.block(size, "assembly.density=2500", "--frequencies", "6")
            values = result["natural_frequencies"]
            self.assertEqual((len(values), values), (6, sorted(values)))
            self.assertTrue(result["natural_frequencies_converged"])
            self.assertEqual(result["zero_energy_modes"], 0)
            self.check_relative(result["longest_period"] * values[0], 1, 1e-12)
            for hertz, omega, residual in zip(values, result["natural_omegas"], result["natural_omega_squared_error_bounds"]):
                self.check_relative(hertz, omega / (2 * math.pi), 1e-12)
                self.assertLessEqual(residual, 1e-6 * omega**2)
            self.assertLess(omega, result["omega_max"])
            lowest[size] = values[0]
        self.assertTrue(1.7 < lowest[11] / lowest[21] < 2.3, lowest)
        self.assertTrue(1.8 < lowest[21] / lowest[41] < 2.2, lowest)
        self.assertNotIn("natural_frequencies", self.stability(TENSION, "--frequencies", "0"))
        self.assertNotIn("natural_frequencies", self.stability(TENSION, "springs.kT=-0.1e9"))

    def test_mechanisms_have_no_natural_frequency(self):
        result = self.block(70, "assembly.kind=square", "springs.kT=0")
        self.assertIsNone(result["natural_frequencies"])
        self.assertIn("zero-energy modes would have to be told apart", flat(result["report"]))
        few = self.stability(LATTICE)
        self.assertEqual(few["zero_energy_modes"], 2)
        self.assertIn("above 2 zero-energy modes", flat(few["report"]))

    def test_a_random_cell(self):
        small, large = self.stability(CELL, "assembly.discs=12"), self.stability(CELL)
        self.assertEqual(small["primitive_cell"]["discs"], small["discs"])
        for key in ("longitudinal", "transverse"):
            for speed, expected in zip(small["sound_speeds"][key], small["sound_speeds"]["homogenized_" + key]):
                self.check_relative(speed, expected, 1e-9)
        self.assertNotIn("rotational_gap", large)
        self.assertIn("Other waves were not searched", large["critical_ratio_searched"])
        for result in (small, large):
            self.assertTrue(-1 < result["critical_ratio"] < 0)
            self.assertLess(result["element_bound_time_step"], result["critical_time_step"])

    def test_springs_share_half_of_the_frequencies_and_speeds_among_them(self):
        out = self.folder / "out"
        result = self.stability(CELL, "assembly.density=2000", "--sensitivities", "--frequencies", "3", "--out", out)
        changes, rows = result["sensitivities"], rows_of(out / "sensitivities.csv")
        self.assertEqual(len(rows), result["contacts"])
        self.assertLess(changes["frequency_error"], 1e-3)
        totals = [(sum(changes[kind]["natural_frequencies"][k] for kind in ("kN", "kT")), changes["frequency_error"])
                  for k in range(3)]
        totals += [(sum(changes[kind]["sound_speeds"][speed] for kind in ("kN", "kT")), 1e-9)
                   for speed in ("Vp_x", "Vs_x", "Vp_y", "Vs_y")]
        for total, error in totals:
            self.assertAlmostEqual(total, 0.5, delta=1e-9 + error)
        for column, of_all in (("df1_d{}_Hz_per_Pa", result["natural_frequencies"][0]),
                               ("dVs_y_d{}_m_per_s_per_Pa", result["sound_speeds"]["homogenized_transverse"][1])):
            share = sum(float(row[f"{k}_Pa"]) * float(row[column.format(k)]) for row in rows for k in ("kN", "kT"))
            self.assertAlmostEqual(share / of_all, 0.5, delta=1e-9 + changes["frequency_error"])
        self.assertAlmostEqual(changes["kN"]["critical_ratio"], 0, delta=1e-7)  # all springs alike change no ratio
        self.assertGreater(changes["scatter"]["critical_ratio"], 1e-3)
        self.check_there(out, "picture_effect_on_f1.svg")

    def test_frequencies_that_coincide_have_no_derivatives(self):
        result = self.stability(LATTICE, "--sensitivities")
        report = flat(result["report"])
        self.assertIn("frequencies coincide", report)
        self.assertIn(None, result["sensitivities"]["kN"]["natural_frequencies"])
        self.assertIn("a wave of the infinite assembly", report)
        done = equidem("stability", LATTICE, "--sensitivities", "springs.kT=-0.4e9")
        self.assertEqual(done.returncode, 2, done.stderr)
        self.assertIn("unstable network", done.stderr)
        self.assertIn("critical kT/kN", done.stdout)

    def test_magnitudes_beyond_numbers_are_refused(self):
        self.check_errors(*(((f"assembly.{key}={value}",), "1e") for key, value in (
            ("density", "1e-300"), ("density", "1e300"), ("radius", "1e-100"), ("radius", "1e100"))),
            before=("stability", CELL, "assembly.discs=30"))


class Prestress(StabilityTest):
    def test_forces_of_contacts_are_totals_where_forces_at_rest_count(self):
        self.write_assembly("row.json", discs=[[0, 0, 1], [2, 0, 1], [4, 0, 1]], contacts=[[0, 1, 0, 0], [1, 2, 0, 0]],
                            forces=[[-100, 0], [-100, 0]], curvatures=[[1, 1], [1, 1]],
                            groups={"a": {"discs": [0]}, "b": {"discs": [2]}})
        case = self.of_file("row.json", '[springs]\nkN = 1.0e6\nkT = 5.0e5\n[effects]\nrotation = "restrained"\n'
                            '[[support]]\ngroup = "a"\nux = 0.0\nuy = 0.0\n[[support]]\ngroup = "b"\nuy = 0.0\n'
                            '[[load]]\ngroup = "b"\nforce = [30.0, 0.0]\n')
        for counts, force in (("on", 30 - 100), ("off", 30)):
            out = self.folder / counts
            self.done("solve", case, f"effects.prestress={counts}", "--out", out)
            found = [float(contact["normal_force_N_per_m"]) for contact in rows_of(out / "contacts.csv")]
            self.assertEqual(len(found), 2)
            for value in found:
                self.assertAlmostEqual(value, force, delta=1e-9 * abs(force))

    def test_frictionless_ellipses_have_moduli_by_their_forces(self):
        packed = self.folder / "packed"
        report = self.report("pack", CASES / "pack_ellipses.toml", "packing.sides=periodic", "packing.grains=60", "--out", packed,
                             "springs.shear_wave_speed=none", "springs.poisson_ratio=none", "springs.kN=1e8", "springs.kT=0")
        self.assertIn("forces at rest", report)
        self.assertLess(result_in(packed)["forces_at_rest"]["imbalance"], 1e-5)
        case = self.of_file(packed / "assembly.json")
        found = self.result("homogenize", case)
        self.assertTrue(found["prestress"]["counts"])
        self.assertGreater(found["bulk_modulus_2d"], 1e6)
        self.assertLess(found["stress_at_rest"]["xx"], 0)
        self.assertIn("stress at rest", found["report"])

        assembly = json.loads((packed / "assembly.json").read_text())
        forces = assembly["forces"]
        largest = max(range(len(forces)), key=lambda contact: abs(forces[contact][0]))
        self.write(json.dumps({**assembly, "forces": [[0.0, 0.0] if k == largest else f for k, f in enumerate(forces)]}),
                   "unbalanced.json")
        self.write(json.dumps({key: value for key, value in assembly.items() if key != "curvatures"}), "unknown.json")
        lammps = ("--to", "lammps", "--out", self.folder / "lammps")
        for verb, path, options, *words in (
                ("homogenize", packed / "assembly.json", ("effects.prestress=off",)),  # floppy, or so soft that no digit is left
                ("homogenize", "unbalanced.json", (PRESTRESS,), "do not balance", "disc"),
                ("homogenize", "unknown.json", (PRESTRESS,), "curvatures"),
                ("quasistatic", packed / "assembly.json", (PRESTRESS,), "quasistatic takes no prestress"),
                ("export", packed / "assembly.json", (PRESTRESS, *lammps), "export --to lammps takes no prestress")):
            with self.subTest(verb=verb, words=words):
                done = equidem(verb, self.of_file(path), *options)
                self.assertNotEqual(done.returncode, 0, done.stdout)
                for word in words:
                    self.assertIn(word, done.stderr)

    def test_bodies_that_fell_carry_forces_that_balance_their_weight(self):
        packed = self.folder / "fallen"
        self.done("pack", CASES / "pack_soil.toml", "packing.grains=30", "packing.box=[0.1, 0.5]", "--out", packed)
        held = '[[support]]\ngroup = "walls"\nux = true\nuy = true\nrotation = true\n'
        report = self.report("stability", self.of_file(packed / "assembly_with_walls.json", held), PRESTRESS)
        self.assertIn("weight, walls", report)
        self.assertIn("critical load", report)

    def test_a_slender_column_buckles_at_eulers_load_less_its_shear(self):
        out, euler = self.folder / "column", math.pi**2 * 1e9 * 0.005 / 128**2
        self.assertIn("loses stability by", self.report("stability", COLUMN, PRESTRESS, "--out", out))
        self.check_there(out, "picture_buckling.svg")
        found = result_in(out)
        missing = 1 - found["critical_load"]["factor"] / euler
        self.assertTrue(7e-4 < missing < 9e-4, missing)
        self.assertEqual((found["unstable_modes"], found["status"]), (0, "stable"))
        short = self.stability(COLUMN, PRESTRESS, "assembly.columns=33")
        self.assertAlmostEqual((1 - short["critical_load"]["factor"] / (4 * euler)) / missing, 4, delta=0.2)
        pushed = self.stability(COLUMN, PRESTRESS, "load.0.force=[-4000.0, 0.0]")
        self.assertEqual((pushed["unstable_modes"], pushed["status"]), (1, "unstable"))
        self.assertAlmostEqual(pushed["critical_load"]["factor"] * 4000 / found["critical_load"]["factor"], 1, delta=1e-9)

    def test_a_support_that_moves_compresses_a_column_as_a_load_does(self):
        # The end that moves cannot turn: four times the load of the free one.
        text, way = COLUMN.read_text(), 1e-6
        case = self.write(text[:text.index("[[load]]")] + f'[[support]]\ngroup = "right"\nux = {-way}\n')
        pressed, euler = 2 * 1e9 * way / 64, math.pi**2 * 1e9 * 0.005 / 128**2
        self.assertAlmostEqual(self.stability(case, PRESTRESS)["critical_load"]["factor"] * pressed / (4 * euler), 1, delta=0.01)
        self.assertNotIn("prestress", self.stability(case, PRESTRESS, "--dry-run"))


if __name__ == "__main__":
    unittest.main()
