# SPDX-License-Identifier: GPL-3.0-or-later
"""What is computed is delivered, whatever fails on the way: run_delivery.py PROGRAM SOURCE_FOLDER [unittest options]."""
import os
import pathlib
import shutil
import signal
import subprocess
import time
import unittest

from program import (CASES, CELL, COMMANDS, ENSEMBLE, TENSION, ProgramTest, at_most, equidem, files_of, flat, parse_json, result_in,
                     started)
from scenes import wall

SHAKE, REST = CASES / "run_shake.toml", CASES / "run_tension.toml"
NOBODY = "cannot write to stdout"


def to_closed_stdout(*arguments):
    return equidem(*arguments, stdout=None, preexec_fn=lambda: os.close(1))


def to_full_stdout(*arguments):
    with open("/dev/full", "w", encoding="utf-8") as full:
        return equidem(*arguments, stdout=full)


def to_reader_that_has_gone(*arguments):
    reading, writing = os.pipe()
    os.close(reading)
    try:
        return equidem(*arguments, stdout=writing)
    finally:
        os.close(writing)


READERS = (to_closed_stdout, to_full_stdout, to_reader_that_has_gone)


class Streams(ProgramTest):
    def test_the_answer_lies_in_the_folder_whatever_takes_the_report(self):
        for name, command in COMMANDS.items():
            for reader in READERS:
                with self.subTest(command=name, reader=reader.__name__):
                    out, file = self.folder / name, self.folder / "file.json"
                    done = reader(*command, "--out", out, "--json", file, "--overwrite")
                    self.assertEqual(done.returncode, 0, done.stderr)
                    self.assertIn(NOBODY, done.stderr)
                    result = result_in(out)
                    self.assertEqual(parse_json(file.read_text())["status"], result["status"])
                    self.assertIn(NOBODY, result["warnings"][0])
                    self.assertEqual((out / "index.html").exists(), name != "export")
                    shutil.rmtree(out)

    def test_an_answer_that_reaches_nobody_is_a_failure(self):
        solve = ("solve", TENSION)
        for reader in READERS:
            for command in (solve, (*solve, "--json", "-"), (*solve, "--dry-run"), ("homogenize", CELL),
                            ("homogenize", CELL, "--json", "-")):
                with self.subTest(reader=reader.__name__, command=command):
                    done = reader(*command)
                    self.assertEqual(done.returncode, 1, done.stderr)
                    self.assertIn(NOBODY, done.stderr)

    def test_help_for_a_reader_that_has_enough_is_no_failure(self):
        for words in (("--version",), ("--help",), ("help", "case"), ("help", "solve"), ("help", "study")):
            done = to_reader_that_has_gone(*words)
            self.assertEqual((done.returncode, done.stderr), (0, ""), words)
            done = to_full_stdout(*words)
            self.assertEqual(done.returncode, 1, words)
            self.assertIn(NOBODY + " (No space left on device)", done.stderr)

    def test_a_closed_stream_is_no_file_of_the_results(self):
        """The first file that is opened would take the number of a closed stream, and the report would go into it."""
        out = self.folder / "out"
        command = ("run", CASES / "run_pulse.toml", "run.duration=2e-4", "--out", out)
        self.assertEqual(equidem(*command, stdout=None, stderr=None, preexec_fn=lambda: os.closerange(0, 3)).returncode, 0)
        for path in out.iterdir():
            if path.is_file() and path.name not in ("result.json", "index.html"):
                self.assertNotIn(b"assembly        ", path.read_bytes(), path)
        self.done(*command, "--resume")

    def test_a_pipe_gets_the_json_and_pipes_and_devices_stay_what_they_are(self):
        pipe, null = self.folder / "pipe", pathlib.Path("/dev/null")
        os.mkfifo(pipe)
        with subprocess.Popen(["cat", pipe], stdout=subprocess.PIPE, text=True) as reader:
            self.done("solve", TENSION, "--json", pipe, "--overwrite")
            text = reader.communicate(timeout=60)[0]
        self.assertEqual(parse_json(text)["status"], "solved")
        self.assertTrue(pipe.is_fifo())
        self.assertEqual(list(self.folder.iterdir()), [pipe])
        self.done("solve", TENSION, "--json", null, "--overwrite")
        self.assertTrue(null.is_char_device())
        self.check_error(equidem("solve", TENSION, "--json", null), 2, "exists already")


class Parts(ProgramTest):
    def gnuplot(self, script):
        """A folder with a gnuplot of its own, first in PATH."""
        folder = self.folder / "bin"
        folder.mkdir(exist_ok=True)
        self.write(script, "bin/gnuplot").chmod(0o755)
        return {**os.environ, "PATH": f"{folder}:{os.environ['PATH']}"}

    def test_a_gnuplot_that_fails_costs_its_picture_alone(self):
        env = self.gnuplot("#!/bin/sh\necho 'line 7: no fonts' >&2\nexit 3\n")
        for name in ("sweep", "quasistatic", "ensemble"):
            with self.subTest(command=name):
                out = self.folder / name
                done = self.done(*COMMANDS[name], "--out", out, env=env)
                for text in (done.stderr, done.stdout, " ".join(result_in(out)["warnings"]), (out / "index.html").read_text()):
                    self.assertIn("no fonts", flat(text))

    def test_a_gnuplot_that_hangs_is_asked_for_no_longer_than_the_user_wants(self):
        """It ignores SIGTERM, and what it has started holds its stderr."""
        out, begun = self.folder / "out", self.folder / "bin" / "begun"
        env = self.gnuplot("#!/bin/sh\ntrap '' TERM INT\ntouch \"$(dirname \"$0\")/begun\"\nsleep 300 &\nwhile :; do sleep 1; done\n")
        with started(*COMMANDS["sweep"], "--out", out, env=env) as running:
            start = time.monotonic()
            while not begun.exists() and time.monotonic() - start < 60:
                time.sleep(0.01)
            self.assertEqual(result_in(out)["status"], "done")
            self.check_there(out, "sweep.csv")
            asked = time.monotonic()
            running.send_signal(signal.SIGINT)
            stdout = running.communicate(timeout=60)[0]
            self.assertLess(time.monotonic() - asked, 5)
        self.assertEqual(running.returncode, 130)
        self.assertIn("nu theory", stdout)
        self.assertEqual([path for path in pathlib.Path("/proc").glob("[0-9]*/environ") if self.holds(path, env["PATH"])], [])

    @staticmethod
    def holds(path, text):
        try:
            return f"PATH={text}".encode() in path.read_bytes().split(b"\0") and path.parent.name != str(os.getpid())
        except OSError:
            return False

    def test_a_disk_that_fills_up_costs_what_does_not_fit(self):
        shake = ("run", SHAKE, "--threads", 1)
        for limit, command, report, lost, kept in (  # limit of a file
                (3000, ("solve", TENSION), "nu, (35)", "result.json", ""),
                                                   (3000, ("homogenize", CELL), "plane strain", "result.json", ""),
                (3000, ("run", REST), "rest", "result.json", ""), (3000, ("stability", CELL), "kT", "result.json", ""),
                (3000, ("sweep", TENSION, "--key", "ratio", "--steps", 41, "--from", 0, "--to", 1), "nu theory", "result.json", ""),
                (3000, ("homogenize", ENSEMBLE, "ensemble.discs=[20, 40]", "ensemble.samples=20"), "discs", "", ""),
                (30000, ("quasistatic", CASES / "frictional_notch.toml", "quasistatic.max_events=20",
                         "output.checkpoint_interval=1e-9"),
                 "20 events", "", ""),
                (30000, ("homogenize", CELL), "plane strain", "discs_strain_xx.csv", "result.json case.toml"),
                (20000, ("homogenize", CELL, "assembly.discs=200", "output.assembly=hdf5", "output.files=[]"),
                 "plane strain", "assembly.h5", ""),
                (1000, (*shake, "output.frame_interval=5e-4"), "", "frames", ""),
                                                   (60000, (*shake, "output.frame_interval=1.0"), "", "frames", ""),
                (200000, (*shake, "output.frame_interval=1.0"), "", "history.csv", "")):
            with self.subTest(limit=limit, command=command):
                out = self.folder / "out"
                done = equidem(*command, "--out", out, **at_most(limit))
                self.assertEqual(done.returncode, 1, done.stderr)
                self.assertIn(report, done.stdout)
                self.assertIn("cannot write", done.stderr.splitlines()[-1])
                if command[0] == "run" and lost != "result.json":
                    self.check_error(done, 1, str(out / lost))
                else:
                    self.assertIn("WARNING", done.stdout)
                    self.assertFalse(lost and (out / lost).exists(), lost)
                self.check_there(out, *kept.split())
                if "result.json" in kept:
                    self.assertIn("_strain_xx.csv", " ".join(result_in(out)["warnings"]))
                    self.assertGreater(result_in(out)["shear_modulus"], 0)
                self.assertEqual([path for path in out.glob("*") if path.suffix == ".part"], [])
                shutil.rmtree(out)

    def test_a_table_of_a_run_that_cannot_be_written_costs_no_other_part(self):
        out = self.folder / "out"
        (out / "contacts.csv" / "in the way").mkdir(parents=True)
        done = equidem(*COMMANDS["grains"], "--out", out)
        self.assertEqual(done.returncode, 1, done.stderr)
        result = result_in(out)
        self.assertEqual((result["status"], len(result["warnings"])), ("done", 1), result["warnings"])
        self.assertIn("contacts.csv", result["warnings"][0])
        self.check_there(out, "grains.csv", "energy.csv", "energy_plot.png", "picture.png", "case.toml", "index.html")


class Interrupted(ProgramTest):
    def test_a_packing_that_is_interrupted_is_delivered_as_it_lies_then(self):
        """Its largest void is found, and its assembly is written, by loops that a signal ends. Two signals at once, as
        timeout of coreutils sends them, are one request."""
        for signals in ((signal.SIGINT,), (signal.SIGTERM, signal.SIGTERM)):
            with self.subTest(signals=signals):
                out = self.folder / signals[0].name
                stdout, _ = self.interrupt("pack", CASES / "pack_jammed.toml", "packing.grains=30000", "packing.box=none",
                                           "packing.solid_fraction=0.8", "output.assembly=hdf5", "--out", out, after=0.3, signals=signals)
                self.assertIn("NOT DONE", stdout)
                result = result_in(out)
                self.assertEqual((result["status"], result["complete"]), ("interrupted", False))
                self.check_there(out, "case.toml", "grains.csv", "assembly.h5", "picture.png", "index.html")
                self.assertNotIn("warnings", result)

    def test_an_export_that_is_interrupted_says_so(self):
        for form in ("lammps", "yade", "matrix-market"):
            with self.subTest(to=form):
                out = self.folder / form
                self.interrupt("export", TENSION, "--to", form, "assembly.columns=300", "assembly.rows=300", "--out", out)
                self.assertFalse((out / "result.json").exists())

    def part_of(self, *command):
        """(result, report, folder) of a command interrupted behind its first results: asked to stop ever later until there are some."""
        for k in range(8):
            out = self.folder / f"{command[0]}{k}"
            stdout, stderr = self.interrupt(*command, "--out", out, after=0.1 * 2**k)
            if stdout:
                result = result_in(out)
                self.assertEqual((result["status"], result["complete"]), ("interrupted", False))
                self.assertIn("stopped as asked (", result["failure"])
                self.assertIn(result["failure"], stderr)
                self.assertIn("NOT DONE", stdout)
                self.check_there(out, "case.toml", "index.html")
                return result, flat(stdout), out
            self.assertFalse((out / "result.json").exists())
        self.fail("nothing was delivered")

    def test_springs_found_until_an_interruption_are_delivered_with_their_error(self):
        result, report, out = self.part_of("calibrate", CASES / "calibrate_random.toml", "assembly.discs=20000",
                                           "material.poisson_ratio=0.2499")  # the range is scanned, and refuses it
        self.assertGreater(result["kN"], 0)
        self.assertGreater(result["achieved"]["relative_error"], 1e-6)
        self.assertIn("the moduli are off by {:.2g}".format(result["achieved"]["relative_error"]), result["failure"])
        self.assertIn("springs file none", report)
        self.assertFalse((out / "springs.toml").exists())

    def test_strengths_found_until_an_interruption_are_delivered_with_their_ratio(self):
        result, report, out = self.part_of("calibrate", CASES / "calibrate_strength.toml", "strength_target.samples=8")
        self.assertGreater(result["contact_strength"]["tension"], 0)
        self.assertIn("not converged: the nearest ratio of ", result["failure"])
        self.assertIn("strength file none", report)
        self.assertFalse((out / "strength.toml").exists())

    def test_moduli_and_frequencies_found_until_an_interruption_are_delivered(self):
        frequencies = [10.0**(k / 50) for k in range(200)]
        result, _, out = self.part_of("homogenize", CASES / "viscoelastic_cell.toml", f"viscoelastic.frequencies={frequencies}")
        self.assertGreater(result["shear_modulus"], 0)
        done = len(result["viscoelastic"]["harmonic"])
        self.assertIn(f"{done} of 200 frequencies are done", result["failure"])
        self.assertEqual(len((out / "viscoelastic.csv").read_text().splitlines()), done + 1)

    def test_load_cases_solved_until_an_interruption_are_delivered(self):
        case = self.write((CASES / "cantilever.toml").read_text() + "".join(
            f'[[load]]\ncase = "pull_{k}"\ngroup = "right"\nkind = "traction"\nforce = [0.0, {k + 1}.0]\n' for k in range(200)))
        result, report, _ = self.part_of("solve", case, "assembly.columns=200", "assembly.rows=60")
        done = len(result["load_cases"])
        self.assertIn(f"{done} of 202 load cases are done", result["failure"])
        self.assertLess(done, 202)
        self.assertIn("weight", report)

    def test_the_stability_found_until_an_interruption_is_delivered(self):
        result, report, _ = self.part_of("stability", CELL, "assembly.discs=20000", "assembly.density=2600.0")
        self.assertIn("found as far as the ", result["failure"])
        self.assertEqual(result["mechanisms"]["count"], 0)
        self.assertNotIn("critical_ratio", result)
        self.assertNotIn("stable in statics", report)


class Inputs(ProgramTest):
    def test_no_result_replaces_an_input_of_its_case(self):
        self.write("x,y,radius\n0,0.05,0.02\n0.05,0.05,0.02\n", "grains.csv")
        case = self.write('[grains]\ndensity = 2500.0\npath = "grains.csv"\n[collisions]\nrestitution = 0.8\ncontact_duration = 1.0e-3\n' +
                          wall("floor", (0.0, 0.0), (0.0, 1.0)) + "[run]\nduration = 0.01\ngravity = [0.0, -9.81]\n", "c.toml")
        self.write('schema = "equidem-springs/1"\n[springs]\nkN = 1e9\nkT = 5e8\n', "springs.json")
        self.write('springs = "springs.json"\n[assembly]\nkind = "hexagonal"\ncolumns = 9\nrows = 9\nradius = 0.005\n'
                   '[test]\nkind = "uniaxial_tension"\n')
        os.link(case, self.folder / "other.json")
        (self.folder / "of_bonds").mkdir()
        self.write("i,j\n0,1\n", "of_bonds/bonds.csv")
        self.write(case.read_text() + '[bonds]\npath = "of_bonds/bonds.csv"\nnormal_spring = 1e6\n', "tied.toml")
        before = files_of(self.folder)
        for command in (("run", "c.toml", "--out", "."), ("run", "tied.toml", "--out", "of_bonds"),
                        ("run", "c.toml", "--json", "c.toml"),
                        ("run", "c.toml", "--json", "other.json"), ("run", "c.toml", "--json", "grains.csv"),
                        ("solve", "case.toml", "--json", "springs.json"),
                        ("sweep", "case.toml", "--key", "assembly.rows", "--values", "9,11", "--json", "springs.json"),
                        ("solve", "case.toml", "--out", self.folder)):
            with self.subTest(command=command):
                self.check_error(equidem(*command, "--overwrite", cwd=self.folder), 2, "is an input of the case", "Choose another")
                self.assertEqual(files_of(self.folder), before)
        for _ in range(2):
            self.done("solve", "case.toml", "--out", self.folder / "out", "--overwrite", cwd=self.folder)


if __name__ == "__main__":
    unittest.main()
