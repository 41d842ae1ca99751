# SPDX-License-Identifier: GPL-3.0-or-later
"""Results that must not pass for sound ones, and input that is too large, too small or out of range: run_limits.py PROGRAM
SOURCE_FOLDER [unittest options]."""
import os
import pathlib
import resource
import subprocess
import unittest

from program import CASES, CELL, ENSEMBLE, STUDY, TENSION, ProgramTest, at_most, equidem, flat, parse_json, rows_of, words_of
from scenes import wall


class Stability(ProgramTest):
    UNSTABLE = ("springs.kT=-3e8", "assembly.discs=30", "--seed", "1")

    def test_a_stiffness_that_is_not_positive_definite_is_no_sound_modulus(self):
        result = self.result("homogenize", CELL, *self.UNSTABLE)
        self.assertLess(result["bulk_modulus_2d"], 0)
        self.assertEqual(result["status"], "unstable")
        self.assertGreater(result["unstable_strains"], 0)
        self.assertIn("UNSTABLE", result["report"])
        self.assertNotIn("every motion costs energy", result["report"])

    def test_instability_comes_first_and_can_be_made_an_error(self):
        for verb, case, unstable in (("solve", TENSION, ("springs.kT=-0.9e9",)), ("homogenize", CELL, self.UNSTABLE),
                                     ("stability", CELL, self.UNSTABLE)):
            self.assertTrue(self.done(verb, case, *unstable).stdout.startswith("UNSTABLE"))
            required = equidem(verb, case, *unstable, "--require-stable")
            self.assertEqual(required.returncode, 1, required.stderr)
            self.assertTrue(required.stdout.startswith("UNSTABLE"))
            self.assertIn("not stable", required.stderr)
            self.done(verb, case, "--require-stable")

    def test_an_ensemble_takes_no_mean_over_unstable_cells(self):
        out = self.folder / "out"
        equidem("homogenize", ENSEMBLE, "ensemble.discs=[30]", "springs.kT=-3e8", "ensemble.samples=6", "--out", out)
        rows = rows_of(out / "samples.csv")
        self.assertEqual(len(rows), 6)
        self.assertGreater(len([row for row in rows if row["refusal"]]), 0)
        for row in rows:
            if not row["refusal"]:
                self.assertGreater(float(row["bulk_modulus_2d_Pa"]), 0)
                self.assertGreater(float(row["shear_modulus_Pa"]), 0)


class Memory(ProgramTest):
    def fallen(self):
        """Discs in rows above a floor, in motion."""
        radius, side = 0.005, 300
        self.write("x,y,radius\n" + "".join(f"{(2 * i + j % 2) * radius * 1.02:.9g},{radius * (1 + 1.77 * j):.9g},{radius}\n"
                                            for j in range(side) for i in range(side)), "grains.csv")
        return self.write('[grains]\ndensity = 2600.0\npath = "grains.csv"\n[collisions]\nlaw = "linear_dashpot"\nstiffness = 1.0e8\n'
                          "restitution = 0.3\nfriction = 0.3\n" + wall("floor", (0.0, 0.0), (0.0, 1.0)) +
                          "[run]\nduration = 2e-4\ngravity = [0.0, -9.81]\n")

    def peak(self, *arguments):
        """Of the process, bytes, and its standard output."""
        with open(self.folder / "said", "w+", encoding="utf-8") as said:
            process = subprocess.Popen(words_of(arguments), stdout=said, stderr=subprocess.DEVNULL)
            _, status, usage = os.wait4(process.pid, 0)
            process.returncode = os.waitstatus_to_exitcode(status)
            self.assertEqual(process.returncode, 0, arguments)
            said.seek(0)
            return 1024 * usage.ru_maxrss, said.read()

    def test_a_dry_run_tells_the_memory_that_the_work_takes(self):
        block, loose = ("assembly.columns=150", "assembly.rows=150"), ("packing.box=none", "packing.solid_fraction=0.5")
        jammed = CASES / "pack_jammed.toml"
        bare, _ = self.peak("solve", CASES / "truss.toml")
        slack = 6e6  # buffers of libraries
        for command in (
                *(("solve", TENSION, *block, f"solver.method={method}")
                  for method in ("multifrontal", "cholmod", "umfpack", "multigrid")),
                ("solve", TENSION, *block, "springs.kT=-0.1e9"),
                ("homogenize", CELL, "assembly.discs=20000", "homogenize.bounds=affine"),
                ("homogenize", CELL, "assembly.discs=20000"),
                ("homogenize", ENSEMBLE, "ensemble.discs=[2000, 19000]", "ensemble.samples=2"),
                ("homogenize", ENSEMBLE, "ensemble.discs=[40000]", "ensemble.samples=2"),
                ("quasistatic", CASES / "notched_plate.toml", *block, "quasistatic.max_events=3"),
                ("quasistatic", CASES / "frictional_notch.toml", *block, "quasistatic.max_events=3"),
                ("homogenize", CASES / "viscoelastic_cell.toml", "assembly.discs=3000", "viscoelastic.frequencies=[1.0]"),
                ("stability", TENSION, "assembly.columns=80", "assembly.rows=80"), ("stability", CELL, "assembly.discs=10000"),
                ("calibrate", CASES / "calibrate_random.toml", "assembly.discs=50000"),
                ("sweep", TENSION, *block, "--key", "ratio", "--values", "0,0.1,0.2,0.3"),
                ("study", STUDY, "--rounds", 3, "--budget", 0),
                ("export", TENSION, *block, "--to", "lammps"), ("export", TENSION, *block, "--to", "matrix-market"),
                ("pack", jammed, "packing.grains=50000", *loose),
                ("pack", jammed, "packing.grains=200000", "packing.method=insertion", "packing.overlap=none", *loose),
                ("run", CASES / "run_pulse.toml", *block, "run.duration=1e-5"), ("run", self.fallen())):
            with self.subTest(command=command):
                # Two cells at once need not reach their peaks together.
                most = 2.3 if command[1] == ENSEMBLE else 1.3
                for files in ((), ("--out", self.folder / "out", "--overwrite"))[command[0] == "export":]:
                    told = parse_json(self.peak(*command, *files, "--dry-run", "--json", "-")[1])["peak_bytes"]
                    taken, _ = self.peak(*command, *files)
                    shown = f"told {told / 1e6:.0f} MB, taken {taken / 1e6:.0f} MB, {bare / 1e6:.0f} MB of it for any case; {files}"
                    self.assertLess(told - bare, most * (taken - bare) + slack, shown)
                    self.assertLess(taken - bare, 1.3 * (told - bare) + slack, shown)

    def test_twenty_five_million_discs_are_not_refused_for_a_factor_that_multigrid_does_not_make(self):
        """The first refusal names what any network of that size takes: 0.6 kB a disc by multigrid, not the factor."""
        def least(method):
            done = equidem("solve", TENSION, "assembly.columns=40000", "assembly.rows=40000", f"solver.method={method}")
            self.check_error(done, 1, "solving a network of 1 600 000 000 discs needs at least")
            number, unit = done.stderr.split("at least ")[1].split()[:2]
            return float(number) * {"GB": 1e9, "TB": 1e12}[unit]

        needs = {method: least(method) for method in ("multigrid", "auto", "multifrontal")}
        self.assertEqual(needs["multigrid"], needs["auto"])
        self.assertLess(needs["multigrid"], 0.5 * needs["multifrontal"])

    def within(self, address_space, *arguments):
        """The process with that many bytes of address space."""
        if equidem("--version", **at_most(address_space, resource.RLIMIT_AS)).returncode != 0:
            self.skipTest("this build needs more address space to start")
        return equidem(*arguments, **at_most(address_space, resource.RLIMIT_AS))

    def test_what_memory_cannot_hold_is_refused_with_a_remedy(self):
        self.write('{"schema": "equidem-assembly/1", "discs": [' + "[0, 0, 0.5]," * 7000000 + "[0, 0, 0.5]]}", "many.json")
        many = self.of_file("many.json", "[springs]\nkN = 1.0\nkT = 0.5\n")
        threads, grid = ("2000 threads cannot be started", "ulimit"), ("assembly.columns=40000", "assembly.rows=40000")
        for space, command, *words in (
                (2 << 30, ("homogenize", ENSEMBLE, "--threads", 2000), *threads),
                (2 << 30, ("sweep", TENSION, "--key", "ratio", "--values", "0,0.5,1", "--threads", 2000), *threads),
                *((4 << 30, (*command, *option), "needs at least", "of memory are available")
                  for option in ((), ("--dry-run",)) for command in (
                    ("solve", TENSION, *grid), ("homogenize", CELL, "assembly.discs=1000000000"),
                    ("run", CASES / "run_tension.toml", *grid))),
                (1 << 30, ("solve", TENSION, "assembly.columns=600", "assembly.rows=600", "solver.method=multifrontal"),
                 "of address space", "ulimit -v"),  # buffers of the linear algebra count
                (450 << 20, ("homogenize", many), "many.json", "of memory are available")):
            with self.subTest(command=command):
                self.check_error(self.within(space, *command), 1, *words)


class Magnitudes(ProgramTest):
    def test_loads_and_springs_of_any_size_give_the_same_moduli(self):
        def solved(*options):
            return self.result("solve", TENSION, *options)["fitted_poisson_ratio"]

        usual = solved()
        for stress in ("1e-160", "1e-250", "1e140"):
            self.assertAlmostEqual(solved(f"test.stress={stress}") / usual, 1, delta=1e-12)
        for radius in ("1e-50", "1e50"):
            self.assertAlmostEqual(solved(f"assembly.radius={radius}") / usual, 1, delta=1e-10)
        for method in ("multifrontal", "multigrid"):
            beside = solved("springs.kN=1.0", "springs.kT=0.5", f"solver.method={method}")
            for unit in ("1e-160", "1e-100", "1e60", "1e160"):
                found = solved(f"springs.kN={unit}", f"springs.kT={float(unit) / 2!r}", f"solver.method={method}")
                self.assertAlmostEqual(found / beside, 1, delta=1e-10, msg=f"{unit} {method}")

    def test_springs_of_any_size_have_moduli(self):
        known = None
        for size in ("1e-300", "1e-160", "1e0", "1e160", "1e300"):
            result = self.result("homogenize", CELL, f"springs.kN={size}", f"springs.kT={size}")
            shares = [result["shear_modulus"] / float(size), result["bounds"]["traction"][0][0] / float(size),
                      result["bounds"]["uniform_stress_estimate"][0][0] / float(size),
                      result["poisson_ratio"]["plane_stress"], result["anisotropy"]]
            known = known or shares
            for share, expected in zip(shares, known):
                self.assertAlmostEqual(share / expected, 1, places=11)
            self.assertTrue(all(step["margin"] > 0 for step in result["order"]))

    def test_magnitudes_out_of_range_are_refused(self):
        seed = "is not a whole number from 0 to 9223372036854775807"
        self.check_errors(
            (("solve", TENSION, "test.stress=1e-300"), "underflow", "units"),
            *((("homogenize", CELL, "assembly.discs=100", f"assembly.radius={radius}"), "radius of a disc", "1e-70")
              for radius in ("1e-160", "1e-153", "1e150")),  # their squares leave the range of a double
            *((("stability", CELL, "assembly.discs=10000", f"springs.kT={kT}"), "contact 0 has kT/kN", "so ill-scaled")
              for kT in ("-1e308", "1e308", "-1e20")),  # before memory is taken
            *((("homogenize", CELL, "--seed", given), "--seed", f"'{given}' {seed}")
              for given in ("99999999999999999999", "-1", "1.5", "one")))
        self.done("homogenize", CELL, "--seed", "9223372036854775807", "--dry-run")


class Inputs(ProgramTest):
    def test_levers_and_shifts_that_cannot_be_are_named(self):
        for contacts, levers, *words in (([[0, 0, 1, 0], [0, 0, 0, 1]], {"levers": [[0.5, 0.5], [0.3, 0.3]]}, "contact 1", "0.3"),
                                         ([[0, 0, 3000000000, 0]], {}, "3000000000 is out of range", "shifts")):
            self.write_assembly("cell.json", cell=[1.0, 1.0], discs=[[0, 0, 0.5]], contacts=contacts, **levers)
            self.check_error(equidem("homogenize", self.of_file("cell.json", "[springs]\nkN = 1.0\nkT = 0.5\n")), 2, *words)

    def test_names_of_files_are_names(self):
        lattice = CASES / "calibrate_lattice.toml"
        self.check_errors(*((("solve", TENSION, option, ""), option, "the name is empty") for option in ("--out", "--json")),
                          *((("solve", TENSION, option, "--quiet"), option, "'--quiet' is an option")
                            for option in ("--out", "--json")),
                          (("calibrate", lattice, "--springs", ""), "--springs", "empty"),
                          (("solve", CASES / "calibrate_random.toml", "springs.kN=1e9"), "both given"))  # not the keys of one of them

    def test_keys_of_any_length_and_depth_end_in_a_short_sentence(self):
        text = pathlib.Path(TENSION).read_text()
        for line, *words in (("k" * 100000 + " = 1", "100000 bytes"), ('"' + "k é" * 30000 + '" = 1', "120000 bytes"),
                             (("k" * 100000 + " = 1\n") * 2, "not TOML"),
                             ("[" + "a." * 39999 + "a]", "40000 parts"), ("a." * 39999 + "a = 1", "40000 parts"),
                             (("a." * 99 + "a = {") * 250 + "}" * 250, "parts")):
            with self.subTest(words=words):
                done = equidem("solve", self.write(f"{text}\n{line}\n"))
                self.check_error(done, 2, "case.toml:", *words)
                self.assertLess(len(done.stderr), 800)
        self.check_error(equidem("solve", TENSION, "--set", "a." * 39999 + "a=1"), 2, "unknown table")
        done = equidem("solve", CASES / "truss.toml", 'support.0.group="' + "g" * 100000 + '"')
        self.check_error(done, 2, "ggg...ggg", "group")
        self.assertLess(len(done.stderr), 800)

    def test_a_disc_without_a_power_cell_costs_the_stresses_of_discs_alone(self):
        self.write_assembly("swallowed.json", discs=[[0, 0, 1], [2, 0, 1], [1, 3**0.5, 1], [0.5, 0, 0.05], [3, 3**0.5, 1]],
                            contacts=[[i, j, 0, 0] for i, j in ((0, 1), (0, 2), (1, 2), (0, 3), (1, 3), (1, 4), (2, 4))],
                            groups={"low": [0, 1], "up": [4]})
        case = self.of_file("swallowed.json", '[springs]\nkN = 1.0\nkT = 0.5\n[[support]]\ngroup = "low"\nux = 0\nuy = 0\n'
                            '[[load]]\ngroup = "up"\nkind = "total"\nforce = [0, -1]\n')
        out = self.folder / "out"
        self.assertIn("has no area", self.done("solve", case, "--out", out).stdout)
        header = (out / "discs.csv").read_text().splitlines()[0]
        self.assertIn("ux", header)
        self.assertNotIn("stress", header)

    def test_a_solid_fraction_above_1_is_explained(self):
        done = self.result("homogenize", CELL, "assembly.discs=200", "assembly.radius=none",
                           "assembly.radii={smallest = 0.0001, largest = 0.01}")
        self.assertGreater(done["solid_fraction"], 1)
        self.assertIn("solid fraction exceeds 1, since discs overlap", flat(done["report"]))
        self.assertNotIn("exceeds 1", self.report("homogenize", CELL, "assembly.discs=200"))

    def test_sentences_read_well(self):
        done = equidem("sweep", CELL, "--key", "ratio", "--values", "0,1")
        self.assertTrue(done.stderr.rstrip().endswith("[[load]])."), done.stderr)
        floppy = self.done("stability", CASES / "hexagonal_cell.toml", "assembly.kind=square", "springs.kT=0").stdout
        self.assertEqual(floppy.count("motions in which no contact"), 1)
        self.assertNotIn("motions without energy: 6 motions", flat(floppy))
        few = self.done("homogenize", ENSEMBLE, "ensemble.discs=[20, 21]", "ensemble.samples=3").stdout
        self.assertIn("do not tell how the scatter falls", few)
        self.assertNotIn("--", few)


if __name__ == "__main__":
    unittest.main()
