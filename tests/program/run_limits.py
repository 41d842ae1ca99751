#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Results that must not pass for sound ones, and outputs that must not get lost: run_limits.py PROGRAM SOURCE_FOLDER."""
import csv
import json
import os
import pathlib
import resource
import subprocess
import unittest

from program import CASES, PROGRAM, SOURCE, TENSION, ProgramTest, equidem, parse_json

CELL = CASES / "random_cell.toml"
ENSEMBLE = CASES / "ensemble.toml"


class Stability(ProgramTest):
    UNSTABLE = ("--set", "springs.kT=-3e8", "--set", "assembly.discs=30", "--seed", "1")

    def test_a_stiffness_that_is_not_positive_definite_is_no_sound_modulus(self):
        result = parse_json(self.check_done(equidem("homogenize", CELL, *self.UNSTABLE, "--json", "-")).stdout)
        self.assertLess(result["bulk_modulus_2d"], 0)
        self.assertEqual(result["status"], "unstable")
        self.assertGreater(result["unstable_strains"], 0)
        report = result["report"]
        self.assertIn("UNSTABLE", report)
        self.assertNotIn("every motion costs energy", report)

    def test_instability_comes_first_and_can_be_made_an_error(self):
        for verb, case, unstable in (("solve", TENSION, ("--set", "springs.kT=-0.9e9")),
                                     ("homogenize", CELL, self.UNSTABLE), ("stability", CELL, self.UNSTABLE)):
            done = self.check_done(equidem(verb, case, *unstable))
            self.assertTrue(done.stdout.startswith("UNSTABLE"), done.stdout)
            required = equidem(verb, case, *unstable, "--require-stable")
            self.assertEqual(required.returncode, 1, required.stderr)
            self.assertTrue(required.stdout.startswith("UNSTABLE"))
            self.assertIn("not stable", required.stderr)
            self.check_done(equidem(verb, case, "--require-stable"))

    def test_an_ensemble_takes_no_mean_over_unstable_cells(self):
        out = self.folder / "out"
        equidem("homogenize", ENSEMBLE, "--set", "ensemble.discs=[30]", "--set", "springs.kT=-3e8", "--set",
                "ensemble.samples=6", "--out", out)
        with open(out / "samples.csv", newline="", encoding="utf-8") as file:
            rows = list(csv.DictReader(file))
        self.assertEqual(len(rows), 6)
        refused = [row for row in rows if row["refusal"]]
        self.assertGreater(len(refused), 0)
        for row in rows:
            if not row["refusal"]:
                self.assertGreater(float(row["bulk_modulus_2d_Pa"]), 0)
                self.assertGreater(float(row["shear_modulus_Pa"]), 0)


class Memory(ProgramTest):
    BLOCK = ("--set", "assembly.columns=150", "--set", "assembly.rows=150")
    GRID = ("--set", "assembly.columns=80", "--set", "assembly.rows=80")
    LOOSE = ("--set", "packing.solid_fraction=0.5")
    CASES = [("solve", TENSION, (*BLOCK, "--set", "solver.method=multifrontal")),
             ("solve", TENSION, (*BLOCK, "--set", "solver.method=cholmod")),
             ("solve", TENSION, (*BLOCK, "--set", "solver.method=umfpack")),
             ("solve", TENSION, (*BLOCK, "--set", "solver.method=multigrid")),
             ("solve", TENSION, (*BLOCK, "--set", "springs.kT=-0.1e9")),
             ("homogenize", CELL, ("--set", "assembly.discs=20000", "--set", "homogenize.bounds=affine")),
             ("homogenize", CELL, ("--set", "assembly.discs=20000")),
             ("homogenize", ENSEMBLE, ("--set", "ensemble.discs=[2000, 19000]", "--set", "ensemble.samples=2")),
             ("homogenize", ENSEMBLE, ("--set", "ensemble.discs=[40000]", "--set", "ensemble.samples=2")),
             ("quasistatic", CASES / "notched_plate.toml", (*BLOCK, "--set", "quasistatic.max_events=3")),
             ("quasistatic", CASES / "frictional_notch.toml", (*BLOCK, "--set", "quasistatic.max_events=3")),
             ("homogenize", CASES / "viscoelastic_cell.toml",
              ("--set", "assembly.discs=3000", "--set", "viscoelastic.frequencies=[1.0]")),
             ("stability", TENSION, GRID),
             ("stability", CELL, ("--set", "assembly.discs=10000")),
             ("calibrate", CASES / "calibrate_random.toml", ("--set", "assembly.discs=50000")),
             ("sweep", TENSION, (*BLOCK, "--key", "ratio", "--values", "0,0.1,0.2,0.3")),
             ("study", SOURCE / "data" / "studies" / "abe_lattice.toml", ("--rounds", 3, "--budget", 0)),
             ("export", TENSION, (*BLOCK, "--to", "lammps")), ("export", TENSION, (*BLOCK, "--to", "matrix-market")),
             ("pack", CASES / "pack_jammed.toml", ("--set", "packing.grains=50000", "--set", "packing.box=none", *LOOSE)),
             ("pack", CASES / "pack_jammed.toml", ("--set", "packing.grains=200000", "--set", "packing.box=none", "--set",
                                                   "packing.method=insertion", "--set", "packing.overlap=none", *LOOSE)),
             ("run", CASES / "run_pulse.toml",
              ("--set", "assembly.columns=150", "--set", "assembly.rows=150", "--set", "run.duration=1e-5"))]

    def fallen(self):
        """Discs in rows above a floor, in motion."""
        radius, side = 0.005, 300
        rows = (f"{(2 * i + j % 2) * radius * 1.02:.9g},{radius * (1 + 1.77 * j):.9g},{radius}" for j in range(side) for i in range(side))
        (self.folder / "grains.csv").write_text("x,y,radius\n" + "\n".join(rows) + "\n")
        case = self.folder / "grains.toml"
        case.write_text('''schema = "equidem/1"
[grains]
density = 2600.0
path = "grains.csv"
[collisions]
law = "linear_dashpot"
stiffness = 1.0e8
restitution = 0.3
friction = 0.3
[[wall]]
name = "floor"
point = [0.0, 0.0]
normal = [0.0, 1.0]
[run]
duration = 2e-4
gravity = [0.0, -9.81]
''')
        return "run", case, ()

    def peak(self, *arguments):
        """Of the process, bytes, and its standard output."""
        with open(self.folder / "said", "w+", encoding="utf-8") as said:
            process = subprocess.Popen([PROGRAM, *map(str, arguments)], stdout=said, stderr=subprocess.DEVNULL)
            _, status, usage = os.wait4(process.pid, 0)
            process.returncode = os.waitstatus_to_exitcode(status)
            self.assertEqual(process.returncode, 0, arguments)
            said.seek(0)
            return 1024 * usage.ru_maxrss, said.read()

    def test_a_dry_run_tells_the_memory_that_the_work_takes(self):
        bare, _ = self.peak("solve", CASES / "truss.toml")
        slack = 6e6  # buffers of libraries
        for verb, case, options in (*self.CASES, self.fallen()):
            with self.subTest(verb=verb, case=pathlib.Path(case).name, options=options):
                for files in ((), ("--out", self.folder / "out", "--overwrite"))[verb == "export":]:
                    told = parse_json(self.peak(verb, case, *options, *files, "--dry-run", "--json", "-")[1])["peak_bytes"]
                    taken, _ = self.peak(verb, case, *options, *files)
                    shown = f"told {told / 1e6:.0f} MB, taken {taken / 1e6:.0f} MB, {bare / 1e6:.0f} MB of it for any case; {files}"
                    self.assertLess(told - bare, 1.3 * (taken - bare) + slack, shown)
                    self.assertLess(taken - bare, 1.3 * (told - bare) + slack, shown)

    def test_twenty_five_million_discs_are_not_refused_for_a_factor_that_multigrid_does_not_make(self):
        """The first refusal names what any network of that size takes: 0.6 kB a disc by multigrid, not the factor."""
        def least(method):
            done = equidem("solve", TENSION, "--set", "assembly.columns=40000", "--set", "assembly.rows=40000", "--set",
                           f"solver.method={method}")
            self.check_error(done, 1, "solving a network of 1 600 000 000 discs needs at least")
            number, unit = done.stderr.split("at least ")[1].split()[:2]
            return float(number) * {"GB": 1e9, "TB": 1e12}[unit]

        needs = {method: least(method) for method in ("multigrid", "auto", "multifrontal")}
        self.assertEqual(needs["multigrid"], needs["auto"])
        self.assertLess(needs["multigrid"], 0.5 * needs["multifrontal"])


class Magnitudes(ProgramTest):
    def test_loads_and_springs_of_any_size_give_the_same_moduli(self):
        def solved(*options):
            done = self.check_done(equidem("solve", TENSION, *options, "--json", "-"))
            result = parse_json(done.stdout)
            return result["fitted_poisson_ratio"]

        usual = solved()
        for stress in ("1e-160", "1e-250", "1e140"):
            self.assertAlmostEqual(solved("--set", f"test.stress={stress}") / usual, 1, delta=1e-12)
        self.check_error(equidem("solve", TENSION, "--set", "test.stress=1e-300"), 2, "underflow", "units")
        for unit in ("1e-160", "1e-100", "1e60", "1e160"):
            for method in ("multifrontal", "multigrid"):
                found = solved("--set", f"springs.kN={unit}", "--set", f"springs.kT={float(unit) / 2!r}", "--set",
                               f"solver.method={method}")
                beside = solved("--set", "springs.kN=1.0", "--set", "springs.kT=0.5", "--set", f"solver.method={method}")
                self.assertAlmostEqual(found / beside, 1, delta=1e-10, msg=f"{unit} {method}")
        for radius in ("1e-50", "1e50"):
            self.assertAlmostEqual(solved("--set", f"assembly.radius={radius}") / usual, 1, delta=1e-10)

    def test_sizes_whose_squares_leave_the_range_of_a_double_are_refused(self):
        for radius in ("1e-160", "1e-153", "1e150"):
            done = equidem("homogenize", CELL, "--set", "assembly.discs=100", "--set", f"assembly.radius={radius}")
            self.check_error(done, 2, "radius of a disc", "1e-70")

    def test_springs_too_far_apart_are_refused_before_memory_is_taken(self):
        for tangential in ("-1e308", "1e308", "-1e20"):
            done = equidem("stability", CELL, "--set", "assembly.discs=10000", "--set", f"springs.kT={tangential}")
            self.check_error(done, 2, "contact 0 has kT/kN", "so ill-scaled")

    def test_springs_of_any_size_have_moduli(self):
        known = None
        for size in ("1e-300", "1e-160", "1e0", "1e160", "1e300"):
            result = parse_json(self.check_done(equidem("homogenize", CELL, "--set", f"springs.kN={size}", "--set",
                                                        f"springs.kT={size}", "--json", "-")).stdout)
            shares = [result["shear_modulus"] / float(size), result["bounds"]["traction"][0][0] / float(size),
                      result["bounds"]["uniform_stress_estimate"][0][0] / float(size),
                      result["poisson_ratio"]["plane_stress"], result["anisotropy"]]
            known = known or shares
            for share, expected in zip(shares, known):
                self.assertAlmostEqual(share / expected, 1, places=11)
            self.assertTrue(all(step["margin"] > 0 for step in result["order"]))


class Inputs(ProgramTest):
    def lattice_file(self, **parts):
        content = {"schema": "equidem-assembly/1", "cell": [1.0, 1.0], "discs": [[0, 0, 0.5]],
                   "contacts": [[0, 0, 1, 0], [0, 0, 0, 1]], **parts}
        (self.folder / "cell.json").write_text(json.dumps(content))
        case = self.folder / "cell.toml"
        case.write_text('schema = "equidem/1"\n[assembly]\nkind = "file"\npath = "cell.json"\n'
                        '[springs]\nkN = 1.0\nkT = 0.5\n')
        return case

    def test_levers_that_do_not_add_up_are_named(self):
        case = self.lattice_file(levers=[[0.5, 0.5], [0.3, 0.3]])
        self.check_error(equidem("homogenize", case), 2, "contact 1", "0.3")

    def test_a_shift_out_of_range_is_not_called_a_disc(self):
        case = self.lattice_file(contacts=[[0, 0, 3000000000, 0]])
        self.check_error(equidem("homogenize", case), 2, "3000000000 is out of range", "shifts")

    def test_a_seed_beyond_the_largest_number_is_no_other_seed(self):
        for seed in ("99999999999999999999", "-1", "1.5", "one"):
            self.check_error(equidem("homogenize", CELL, "--seed", seed), 2, "--seed",
                             f"'{seed}' is not a whole number from 0 to 9223372036854775807")
        self.check_done(equidem("homogenize", CELL, "--seed", "9223372036854775807", "--dry-run"))

    def test_names_of_files_are_names(self):
        for option in ("--out", "--json"):
            self.check_error(equidem("solve", TENSION, option, ""), 2, option, "the name is empty")
            self.check_error(equidem("solve", TENSION, option, "--quiet"), 2, option, "'--quiet' is an option")
        self.check_error(equidem("calibrate", CASES / "calibrate_lattice.toml", "--springs", ""), 2, "--springs", "empty")

    def case_with(self, line):
        case = self.folder / "case.toml"
        case.write_text(pathlib.Path(TENSION).read_text() + "\n" + line + "\n", encoding="utf-8")
        return case

    def test_keys_of_any_length_and_depth_end_in_a_short_sentence(self):
        for line, *words in (("k" * 100000 + " = 1", "100000 bytes"), ('"' + "k é" * 30000 + '" = 1', "120000 bytes"),
                             (("k" * 100000 + " = 1\n") * 2, "not TOML"),
                             ("[" + "a." * 39999 + "a]", "40000 parts"), ("a." * 39999 + "a = 1", "40000 parts"),
                             (("a." * 99 + "a = {") * 250 + "}" * 250, "parts")):
            with self.subTest(words=words):
                done = equidem("solve", self.case_with(line))
                self.check_error(done, 2, "case.toml:", *words)
                self.assertLess(len(done.stderr), 800)
        self.check_error(equidem("solve", TENSION, "--set", "a." * 39999 + "a=1"), 2, "unknown table")
        done = equidem("solve", CASES / "truss.toml", "--set", 'support.0.group="' + "g" * 100000 + '"')
        self.check_error(done, 2, "ggg...ggg", "group")
        self.assertLess(len(done.stderr), 800)

    def test_a_disc_without_a_power_cell_costs_the_stresses_of_discs_alone(self):
        (self.folder / "swallowed.json").write_text(json.dumps({
            "schema": "equidem-assembly/1",
            "discs": [[0, 0, 1], [2, 0, 1], [1, 3**0.5, 1], [0.5, 0, 0.05], [3, 3**0.5, 1]],
            "contacts": [[i, j, 0, 0] for i, j in ((0, 1), (0, 2), (1, 2), (0, 3), (1, 3), (1, 4), (2, 4))],
            "groups": {"low": [0, 1], "up": [4]}}))
        case = self.folder / "swallowed.toml"
        case.write_text('schema = "equidem/1"\n[assembly]\nkind = "file"\npath = "swallowed.json"\n'
                        '[springs]\nkN = 1.0\nkT = 0.5\n[[support]]\ngroup = "low"\nux = 0\nuy = 0\n'
                        '[[load]]\ngroup = "up"\nkind = "total"\nforce = [0, -1]\n')
        out = self.folder / "out"
        self.assertIn("has no area", self.check_done(equidem("solve", case, "--out", out)).stdout)
        header = (out / "discs.csv").read_text().splitlines()[0]
        self.assertIn("ux", header)
        self.assertNotIn("stress", header)

    def test_a_solid_fraction_above_1_is_explained(self):
        sizes = ("--set", "assembly.discs=200", "--set", "assembly.radius=none", "--set",
                 "assembly.radii={smallest = 0.0001, largest = 0.01}")
        done = parse_json(self.check_done(equidem("homogenize", CELL, *sizes, "--json", "-")).stdout)
        self.assertGreater(done["solid_fraction"], 1)
        self.assertIn("solid fraction exceeds 1, since discs overlap", " ".join(done["report"].split()))
        equal = self.check_done(equidem("homogenize", CELL, "--set", "assembly.discs=200"))
        self.assertNotIn("exceeds 1", equal.stdout)

    def test_springs_and_material_together_are_named_before_their_keys(self):
        self.check_error(equidem("solve", CASES / "calibrate_random.toml", "--set", "springs.kN=1e9"), 2, "both given")


class TooLarge(ProgramTest):
    def within(self, address_space, *arguments):
        """Run with that many bytes of address space."""
        done = [subprocess.run([PROGRAM, *map(str, given)], capture_output=True, text=True, timeout=120,
                               preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_AS, (address_space, address_space)))
                for given in (("--version",), arguments)]
        if done[0].returncode != 0:
            self.skipTest("this build needs more address space to start")
        return done[1]

    def test_threads_that_cannot_be_started_are_an_error_with_a_remedy(self):
        for command in (("homogenize", ENSEMBLE), ("sweep", TENSION, "--key", "ratio", "--values", "0,0.5,1")):
            done = self.within(2 << 30, *command, "--threads", 2000)
            self.check_error(done, 1, "2000 threads cannot be started", "ulimit")

    def test_what_cannot_fit_is_refused_before_it_is_built(self):
        for verb, case, keys in (("solve", TENSION, ("columns=40000", "rows=40000")),
                                 ("homogenize", CELL, ("discs=1000000000",)),
                                 ("run", CASES / "run_tension.toml", ("columns=40000", "rows=40000"))):
            for option in ((), ("--dry-run",)):
                done = self.within(4 << 30, verb, case, *option, *(f"--set=assembly.{key}" for key in keys))
                self.check_error(done, 1, "needs at least", "of memory are available")

    def test_buffers_of_the_linear_algebra_count(self):
        done = self.within(1 << 30, "solve", TENSION, "--set", "assembly.columns=600", "--set", "assembly.rows=600",
                           "--set", "solver.method=multifrontal")
        self.check_error(done, 1, "of address space", "ulimit -v")

    def test_a_file_that_memory_cannot_hold_is_refused(self):
        file = self.folder / "many.json"
        file.write_text('{"schema": "equidem-assembly/1", "discs": [' + "[0, 0, 0.5]," * 7000000 + "[0, 0, 0.5]]}")
        case = self.folder / "many.toml"
        case.write_text('schema = "equidem/1"\n[assembly]\nkind = "file"\npath = "many.json"\n'
                        '[springs]\nkN = 1.0\nkT = 0.5\n')
        self.check_error(self.within(450 << 20, "homogenize", case), 1, "many.json", "of memory are available")


class Outputs(ProgramTest):
    @unittest.skipUnless(pathlib.Path("/dev/full").exists(), "no device that is always full")
    def test_what_stdout_cannot_take_is_told(self):
        for command in (("homogenize", CELL), ("homogenize", CELL, "--json", "-"), ("solve", TENSION),
                        ("solve", TENSION, "--json", "-"), ("solve", TENSION, "--dry-run"), ("--version",), ("--help",),
                        ("help", "case"), ("help", "solve"), ("help", "study")):
            with self.subTest(command=command), open("/dev/full", "w", encoding="utf-8") as full:
                done = subprocess.run([PROGRAM, *map(str, command)], stdout=full, stderr=subprocess.PIPE, text=True,
                                      timeout=120, check=False)
                self.assertEqual(done.returncode, 1, done.stderr)
                self.assertIn("cannot write to stdout (No space left on device)", done.stderr)

    def test_a_pipe_gets_the_json_and_stays_a_pipe(self):
        pipe = self.folder / "pipe"
        os.mkfifo(pipe)
        with subprocess.Popen(["cat", pipe], stdout=subprocess.PIPE, text=True) as reader:
            self.check_done(equidem("solve", TENSION, "--json", pipe, "--overwrite"))
            text = reader.communicate(timeout=60)[0]
        self.assertEqual(parse_json(text)["status"], "solved")
        self.assertTrue(pipe.is_fifo())
        self.assertEqual(list(self.folder.iterdir()), [pipe])

    @unittest.skipUnless(pathlib.Path("/dev/null").is_char_device(), "no device that takes everything")
    def test_a_device_stays_a_device(self):
        self.check_done(equidem("solve", TENSION, "--json", "/dev/null", "--overwrite"))
        self.assertTrue(pathlib.Path("/dev/null").is_char_device())
        self.check_error(equidem("solve", TENSION, "--json", "/dev/null"), 2, "exists already")

    def test_a_file_in_a_folder_that_is_not_there_is_told_before_the_computation(self):
        there = self.folder / "nowhere" / "x.json"
        self.check_error(equidem("homogenize", CELL, "--json", there), 2, "there is no folder", str(there.parent))
        self.assertFalse(there.parent.exists())

    def test_resume_with_fewer_samples_keeps_those_computed(self):
        out = self.folder / "out"
        command = ["homogenize", ENSEMBLE, "--set", "ensemble.discs=[20]", "--out", out]
        self.check_done(equidem(*command, "--set", "ensemble.samples=5"))
        table = (out / "samples.csv").read_text()
        done = self.check_done(equidem(*command, "--set", "ensemble.samples=2", "--resume", "--json", "-"))
        self.assertEqual(parse_json(done.stdout)["ensemble"][0]["samples"], 2)
        self.assertEqual((out / "samples.csv").read_text(), table)

    def test_sentences_read_well(self):
        done = equidem("sweep", CELL, "--key", "ratio", "--values", "0,1")
        self.assertTrue(done.stderr.rstrip().endswith("[[load]])."), done.stderr)
        floppy = self.check_done(equidem("stability", CASES / "hexagonal_cell.toml", "--set", "assembly.kind=square",
                                         "--set", "springs.kT=0")).stdout
        self.assertEqual(floppy.count("motions in which no contact"), 1)
        self.assertNotIn("motions without energy: 6 motions", " ".join(floppy.split()))
        few = self.check_done(equidem("homogenize", ENSEMBLE, "--set", "ensemble.discs=[20, 21]", "--set",
                                      "ensemble.samples=3")).stdout
        self.assertIn("do not tell how the scatter falls", few)
        self.assertNotIn("--", few)


if __name__ == "__main__":
    unittest.main()
