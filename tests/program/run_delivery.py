# SPDX-License-Identifier: GPL-3.0-or-later
"""What is computed is delivered, whatever fails on the way: run_delivery.py PROGRAM SOURCE_FOLDER [unittest options]."""
import os
import pathlib
import resource
import shutil
import signal
import subprocess
import time
import unittest

from program import CASES, PROGRAM, TENSION, ProgramTest, catches_interrupts, equidem, parse_json

CELL = CASES / "random_cell.toml"
ENSEMBLE = CASES / "ensemble.toml"
SMALL_ENSEMBLE = ("--set", "ensemble.discs=[20, 40]", "--set", "ensemble.samples=3")
PACKING = CASES / "pack_jammed.toml"
VERBS = {"solve": ("solve", TENSION), "homogenize": ("homogenize", CELL), "stability": ("stability", CELL),
         "ensemble": ("homogenize", ENSEMBLE, *SMALL_ENSEMBLE), "calibrate": ("calibrate", CASES / "calibrate_random.toml"),
         "pack": ("pack", PACKING, "--set", "packing.grains=60"),
         "run": ("run", CASES / "run_tension.toml"), "quasistatic": ("quasistatic", CASES / "notched_plate.toml"),
         "export": ("export", TENSION, "--to", "lammps"),
         "sweep": ("sweep", TENSION, "--key", "ratio", "--values", "0,0.5,1")}


def run(*arguments, **options):
    return subprocess.run([PROGRAM, *map(str, arguments)], stderr=subprocess.PIPE, text=True, timeout=240, check=False, **options)


class Streams(ProgramTest):
    def to_closed_stdout(self, *arguments):
        return run(*arguments, preexec_fn=lambda: os.close(1))

    def to_full_stdout(self, *arguments):
        with open("/dev/full", "w", encoding="utf-8") as full:
            return run(*arguments, stdout=full)

    def to_reader_that_has_gone(self, *arguments):
        reading, writing = os.pipe()
        os.close(reading)
        try:
            return run(*arguments, stdout=writing)
        finally:
            os.close(writing)

    def test_the_answer_lies_in_the_folder_whatever_takes_the_report(self):
        for name, command in VERBS.items():
            for way in (self.to_closed_stdout, self.to_full_stdout, self.to_reader_that_has_gone):
                with self.subTest(verb=name, way=way.__name__):
                    out, file = self.folder / name, self.folder / "file.json"
                    done = way(*command, "--out", out, "--json", file, "--overwrite")
                    self.assertEqual(done.returncode, 0, done.stderr)
                    self.assertIn("cannot write to stdout", done.stderr)
                    result = parse_json((out / "result.json").read_text())
                    self.assertEqual(parse_json(file.read_text())["status"], result["status"])
                    self.assertIn("cannot write to stdout", result["warnings"][0])
                    self.assertEqual((out / "index.html").exists(), name != "export")
                    shutil.rmtree(out)

    def test_an_answer_that_reaches_nobody_is_a_failure(self):
        for way in (self.to_closed_stdout, self.to_full_stdout, self.to_reader_that_has_gone):
            for words in ((), ("--json", "-"), ("--dry-run",)):
                with self.subTest(way=way.__name__, words=words):
                    done = way("solve", TENSION, *words)
                    self.assertEqual(done.returncode, 1, done.stderr)
                    self.assertIn("cannot write to stdout", done.stderr)

    def test_a_closed_stream_is_no_file_of_the_results(self):
        """The first file that is opened would take the number of a closed stream, and the report would go into it."""
        out = self.folder / "out"
        command = ("run", CASES / "run_pulse.toml", "--set", "run.duration=2e-4", "--out", out)
        done = subprocess.run([PROGRAM, *map(str, command)], timeout=240, check=False, preexec_fn=lambda: os.closerange(0, 3))
        self.assertEqual(done.returncode, 0)
        for path in out.iterdir():
            if path.is_file() and path.name not in ("result.json", "index.html"):
                self.assertNotIn(b"assembly        ", path.read_bytes(), path)
        self.check_done(equidem(*command, "--resume"))

    def test_help_for_a_reader_that_has_enough_is_no_failure(self):
        for words in (("help", "case"), ("--help",), ("help", "study")):
            done = self.to_reader_that_has_gone(*words)
            self.assertEqual((done.returncode, done.stderr), (0, ""), words)


class Parts(ProgramTest):
    def gnuplot(self, script):
        """A folder with a gnuplot of its own, first in PATH."""
        folder = self.folder / "bin"
        folder.mkdir(exist_ok=True)
        path = folder / "gnuplot"
        path.write_text(script)
        path.chmod(0o755)
        return {**os.environ, "PATH": f"{folder}:{os.environ['PATH']}"}

    def test_a_gnuplot_that_fails_costs_its_picture_alone(self):
        for name in ("sweep", "quasistatic", "ensemble"):
            with self.subTest(verb=name):
                out = self.folder / name
                done = run(*VERBS[name], "--out", out, stdout=subprocess.PIPE,
                           env=self.gnuplot("#!/bin/sh\necho 'line 7: no fonts' >&2\nexit 3\n"))
                self.assertEqual(done.returncode, 0, done.stderr)
                result = parse_json((out / "result.json").read_text())
                for text in (done.stderr, done.stdout, " ".join(result["warnings"]), (out / "index.html").read_text()):
                    self.assertIn("no fonts", " ".join(text.split()))

    def test_a_gnuplot_that_hangs_is_asked_for_no_longer_than_the_user_wants(self):
        """It ignores SIGTERM, and what it has started holds its stderr."""
        out = self.folder / "out"
        env = self.gnuplot("#!/bin/sh\ntrap '' TERM INT\ntouch \"$(dirname \"$0\")/begun\"\nsleep 300 &\nwhile :; do sleep 1; done\n")
        command = [PROGRAM, *map(str, VERBS["sweep"]), "--out", str(out)]
        with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, env=env) as running:
            start = time.monotonic()
            while not (self.folder / "bin" / "begun").exists() and time.monotonic() - start < 60:
                time.sleep(0.01)
            self.assertEqual(parse_json((out / "result.json").read_text())["status"], "done")
            self.assertTrue((out / "sweep.csv").exists())
            asked = time.monotonic()
            running.send_signal(signal.SIGINT)
            stdout = running.communicate(timeout=60)[0]
            self.assertLess(time.monotonic() - asked, 5)
        self.assertEqual(running.returncode, 130)
        self.assertIn("nu theory", stdout)
        groups = [path for path in pathlib.Path("/proc").glob("[0-9]*/environ") if self.holds(path, env["PATH"])]
        self.assertEqual(groups, [])

    @staticmethod
    def holds(path, text):
        try:
            return f"PATH={text}".encode() in path.read_bytes().split(b"\0") and path.parent.name != str(os.getpid())
        except OSError:
            return False

    def test_a_disk_that_fills_up_costs_what_does_not_fit(self):
        limit = 30000  # of a file: result.json fits, the tables of discs do not
        done = run("homogenize", CELL, "--out", self.folder / "out", stdout=subprocess.PIPE,
                   preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (limit, limit)))
        self.assertEqual(done.returncode, 1, done.stderr)
        self.assertIn("cannot write", done.stderr.splitlines()[-1])
        result = parse_json((self.folder / "out" / "result.json").read_text())
        self.assertGreater(result["shear_modulus"], 0)
        self.assertIn("_strain_xx.csv", " ".join(result["warnings"]))
        self.assertIn("plane strain", done.stdout)
        self.assertTrue((self.folder / "out" / "case.toml").exists())

    def test_a_table_of_a_run_that_cannot_be_written_costs_no_other_part(self):
        out = self.folder / "out"
        (out / "contacts.csv" / "in the way").mkdir(parents=True)
        done = equidem("run", CASES / "grains_cradle.toml", "--out", out)
        self.assertEqual(done.returncode, 1, done.stderr)
        result = parse_json((out / "result.json").read_text())
        self.assertEqual(result["status"], "done")
        self.assertEqual(len(result["warnings"]), 1, result["warnings"])
        self.assertIn("contacts.csv", result["warnings"][0])
        for name in ("grains.csv", "energy.csv", "energy_plot.png", "picture.png", "case.toml", "index.html"):
            self.assertTrue((out / name).exists(), name)

    def test_a_path_a_sweep_and_an_ensemble_go_on_where_they_cannot_be_saved(self):
        # limit of a file: the case fits, the tables and the checkpoint do not
        for limit, command, words in (
                (3000, ("sweep", TENSION, "--key", "ratio", "--from", 0, "--to", 1, "--steps", 41), "nu theory"),
                (3000, ("homogenize", ENSEMBLE, "--set", "ensemble.discs=[20, 40]", "--set", "ensemble.samples=20"), "discs"),
                (30000, ("quasistatic", CASES / "frictional_notch.toml", "--set", "quasistatic.max_events=20", "--set",
                         "output.checkpoint_interval=1e-9"), "20 events")):
            done = run(*command, "--out", self.folder / command[0], stdout=subprocess.PIPE,
                       preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (limit, limit)))
            self.assertEqual(done.returncode, 1, done.stderr)
            self.assertIn("cannot write", done.stderr)
            self.assertIn(words, done.stdout)


class Interrupted(ProgramTest):
    def interrupted(self, *command, signals):
        """The command, asked to stop once stderr has told how far it is."""
        with subprocess.Popen([PROGRAM, *map(str, command)], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True) as running:
            progress = running.stderr.readline()
            for number in signals:
                running.send_signal(number)
            stdout, stderr = running.communicate(timeout=240)
        if running.returncode == 0:
            self.skipTest("it was done before it could be interrupted")
        return running.returncode, stdout, progress + stderr

    def test_a_packing_that_is_interrupted_is_delivered_as_it_lies_then(self):
        """Its largest void is found, and its assembly is written, by loops that a signal ends. Two signals at once, as
        timeout of coreutils sends them, are one request."""
        for signals in ((signal.SIGINT,), (signal.SIGTERM, signal.SIGTERM)):
            with self.subTest(signals=signals):
                out = self.folder / signals[0].name
                code, stdout, stderr = self.interrupted("pack", PACKING, "--set", "packing.grains=12000", "--set",
                                                        "packing.box=none", "--set", "packing.solid_fraction=0.8",
                                                        "--set", "output.assembly=hdf5", "--out", out,
                                                        signals=signals)
                self.assertEqual(code, 130, stderr)
                self.assertIn("NOT DONE", stdout)
                result = parse_json((out / "result.json").read_text())
                self.assertEqual((result["status"], result["complete"]), ("interrupted", False))
                for name in ("case.toml", "grains.csv", "assembly.h5", "picture.png", "index.html"):
                    self.assertTrue((out / name).exists(), name)
                self.assertNotIn("warnings", result)

    def test_an_export_that_is_interrupted_says_so(self):
        for words in (("lammps",), ("yade",), ("matrix-market",)):
            out = self.folder / words[0]
            command = ("export", TENSION, "--to", *words, "--set", "assembly.columns=300", "--set", "assembly.rows=300", "--out", out)
            with self.subTest(to=words[0]), subprocess.Popen([PROGRAM, *map(str, command)], stdout=subprocess.PIPE,
                                                             stderr=subprocess.PIPE, text=True) as running:
                while not catches_interrupts(running.pid):
                    time.sleep(0.001)
                running.send_signal(signal.SIGINT)
                stderr = running.communicate(timeout=240)[1]
                self.assertEqual(running.returncode, 130, stderr)
                self.assertFalse((out / "result.json").exists())


    def part_of(self, *command, file="result.json"):
        """(result, report) of a command interrupted behind its first results: asked to stop ever later until there are some."""
        for k in range(8):
            out = self.folder / f"{command[0]}{k}"
            stdout, stderr = self.interrupt(*command, "--out", out, after=0.1 * 2**k)
            if stdout:
                result = parse_json((out / "result.json").read_text())
                self.assertEqual((result["status"], result["complete"]), ("interrupted", False))
                self.assertIn("stopped as asked (", result["failure"])
                self.assertIn(result["failure"], stderr)
                self.assertIn("NOT DONE", stdout)
                for name in ("case.toml", "index.html"):
                    self.assertTrue((out / name).exists(), name)
                return result, " ".join(stdout.split()), out
            self.assertFalse((out / "result.json").exists())
        self.fail("nothing was delivered")

    def test_springs_found_until_an_interruption_are_delivered_with_their_error(self):
        result, report, out = self.part_of("calibrate", CASES / "calibrate_random.toml", "--set", "assembly.discs=20000",
                                           "--set", "material.poisson_ratio=0.2499")  # the range is scanned, and refuses it
        self.assertGreater(result["kN"], 0)
        self.assertGreater(result["achieved"]["relative_error"], 1e-6)
        self.assertIn("the moduli are off by {:.2g}".format(result["achieved"]["relative_error"]), result["failure"])
        self.assertIn("springs file none", report)
        self.assertFalse((out / "springs.toml").exists())

    def test_strengths_found_until_an_interruption_are_delivered_with_their_ratio(self):
        result, report, out = self.part_of("calibrate", CASES / "calibrate_strength.toml", "--set", "strength_target.samples=8")
        self.assertGreater(result["contact_strength"]["tension"], 0)
        self.assertIn("not converged: the nearest ratio of ", result["failure"])
        self.assertIn("strength file none", report)
        self.assertFalse((out / "strength.toml").exists())

    def test_moduli_and_frequencies_found_until_an_interruption_are_delivered(self):
        frequencies = [10.0**(k / 50) for k in range(200)]
        result, _, out = self.part_of("homogenize", CASES / "viscoelastic_cell.toml", "--set",
                                      f"viscoelastic.frequencies={frequencies}")
        self.assertGreater(result["shear_modulus"], 0)
        done = len(result["viscoelastic"]["harmonic"])
        self.assertIn(f"{done} of 200 frequencies are done", result["failure"])
        self.assertEqual(len((out / "viscoelastic.csv").read_text().splitlines()), done + 1)

    def test_load_cases_solved_until_an_interruption_are_delivered(self):
        case = self.folder / "loads.toml"
        case.write_text((CASES / "cantilever.toml").read_text() + "".join(
            f'[[load]]\ncase = "pull_{k}"\ngroup = "right"\nkind = "traction"\nforce = [0.0, {k + 1}.0]\n' for k in range(200)))
        result, report, out = self.part_of("solve", case, "--set", "assembly.columns=200", "--set", "assembly.rows=60")
        done = len(result["load_cases"])
        self.assertIn(f"{done} of 202 load cases are done", result["failure"])
        self.assertLess(done, 202)
        self.assertIn("weight", report)

    def test_the_stability_found_until_an_interruption_is_delivered(self):
        result, report, out = self.part_of("stability", CASES / "random_cell.toml", "--set", "assembly.discs=20000",
                                           "--set", "assembly.density=2600.0")
        self.assertIn("found as far as the ", result["failure"])
        self.assertEqual(result["mechanisms"]["count"], 0)
        self.assertNotIn("critical_ratio", result)
        self.assertNotIn("stable in statics", report)


class Inputs(ProgramTest):
    def test_no_result_replaces_an_input_of_its_case(self):
        bodies = self.folder / "grains.csv"
        bodies.write_text("x,y,radius\n0,0.05,0.02\n0.05,0.05,0.02\n")
        case = self.folder / "c.toml"
        case.write_text('''schema = "equidem/1"
[grains]
density = 2500.0
path = "grains.csv"
[collisions]
restitution = 0.8
contact_duration = 1.0e-3
[[wall]]
name = "floor"
point = [0.0, 0.0]
normal = [0.0, 1.0]
[run]
duration = 0.01
gravity = [0.0, -9.81]
''')
        (self.folder / "springs.json").write_text('schema = "equidem-springs/1"\n[springs]\nkN = 1e9\nkT = 5e8\n')
        (self.folder / "case.toml").write_text('''schema = "equidem/1"
springs = "springs.json"
[assembly]
kind = "hexagonal"
columns = 9
rows = 9
radius = 0.005
[test]
kind = "uniaxial_tension"
''')
        os.link(case, self.folder / "other.json")
        (self.folder / "of_bonds").mkdir()
        (self.folder / "of_bonds" / "bonds.csv").write_text("i,j\n0,1\n")
        (self.folder / "tied.toml").write_text(case.read_text() + '[bonds]\npath = "of_bonds/bonds.csv"\nnormal_spring = 1e6\n')
        def files():
            return {path: path.read_bytes() for path in self.folder.rglob("*") if path.is_file()}

        before = files()
        for command in (("run", "c.toml", "--out", ".", "--overwrite"),
                        ("run", "tied.toml", "--out", "of_bonds", "--overwrite"),
                        ("run", "c.toml", "--json", "c.toml", "--overwrite"),
                        ("run", "c.toml", "--json", "other.json", "--overwrite"),
                        ("run", "c.toml", "--json", "grains.csv", "--overwrite"),
                        ("solve", "case.toml", "--json", "springs.json", "--overwrite"),
                        ("sweep", "case.toml", "--key", "assembly.rows", "--values", "9,11", "--json", "springs.json", "--overwrite"),
                        ("solve", "case.toml", "--out", self.folder, "--overwrite")):
            with self.subTest(command=command):
                self.check_error(equidem(*command, cwd=self.folder), 2, "is an input of the case", "Choose another")
                self.assertEqual(files(), before)
        out = self.folder / "out"
        for _ in range(2):
            self.check_done(equidem("solve", "case.toml", "--out", out, "--overwrite", cwd=self.folder))


if __name__ == "__main__":
    unittest.main()
