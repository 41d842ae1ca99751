#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""equidem run stopped, damaged and gone on with: run_resume.py PROGRAM SOURCE_FOLDER [unittest options]."""
import random
import re
import resource
import signal
import subprocess
import time
import unittest

from motion import CORNER, RADIUS, REST, SHAKE, RunTest, files_of, frame_files
from program import PROGRAM, equidem, parse_json


PAIR = '''schema = "equidem/1"
[grains]
density = 2600.0
[[grain]]
position = [0.0, 0.02]
radius = 0.01
[[grain]]
position = [0.02, 0.02]
radius = 0.01
velocity = [0.1, 0.0]
[bonds]
{}
[[bond]]
grains = [0, 1]
[collisions]
law = "linear_dashpot"
stiffness = 1.0e7
restitution = 0.3
[run]
duration = 1.0e-3
[[probe]]
name = "p"
group = "grains"
quantities = ["stress", "velocity"]
box = [-0.02, 0.0, 0.05, 0.05]
[output]
probe_interval = 1e-4
frame_interval = 3e-4
files = ["csv", "vtk"]
[measures]
cell = 0.02
'''


class ResumeOfBonds(RunTest):
    def test_bonds_of_every_kind_go_on_after_any_step_with_the_same_rows(self):
        springs, dashpots = "normal_spring = 2.0e6\ntangential_spring = 1.0e6\n", "normal_dashpot = 100.0\nrolling_dashpot = 1e-3\n"
        for bonds in (springs, dashpots, springs + dashpots,
                      springs + dashpots + "[strength]\ntension = 60.0\nshear = 60.0\n"):
            for integrator in ("semi_implicit_euler", "velocity_verlet"):
                case, whole = self.folder / "case.toml", self.folder / "whole"
                case.write_text(PAIR.format(bonds))
                common = ("--set", f"run.integrator={integrator}", "--set", "run.time_step=1.5e-5")
                first = self.run_case(case, "--out", whole, "--overwrite", *common)
                for end in (None, "1.5e-5", "3.3e-4", "9.9e-4"):
                    with self.subTest(bonds=bonds, integrator=integrator, end=end):
                        out = self.folder / "out"
                        self.run_case(case, "--out", out, "--overwrite", *common,
                                      *(("--set", f"run.duration={end}") if end else ()))
                        again = self.run_case(case, "--out", out, "--resume", *common)
                        for name in ("history.csv", "fields.csv", "fields.vti", "grains.csv", "bonds.csv", "contacts.csv",
                                     "energy.csv", "measures.csv"):
                            self.assertEqual((whole / name).read_bytes(), (out / name).read_bytes(), name)
                        self.assertEqual(frame_files(whole), frame_files(out))
                        for key in ("energy", "bonds", "measures", "forces_on_walls"):
                            self.assertEqual(first.get(key), again.get(key), key)

    def test_a_measure_with_nothing_left_to_measure_is_null_and_the_run_is_delivered(self):
        case = self.folder / "case.toml"
        for what, text, reason in (
                ("flown away", PAIR, "no heap of bodies is left"),
                ("far apart", PAIR.replace("cell = 0.02", "cell = 2e-4").replace("[[bond]]\ngrains = [0, 1]\n", "")
                 .replace("[bonds]\n{}\n", "").replace("velocity = [0.1, 0.0]", "velocity = [1000.0, 0.0]"), "more than a million"),
                ("a region left empty", PAIR.replace("cell = 0.02", "cell = 0.02\nregion = [0.0, 0.0, 0.02, 0.04]"), "no heap of bodies")):
            text = text.replace("velocity = [0.1, 0.0]", "velocity = [1.0, 0.0]")
            with self.subTest(what=what):
                out = self.folder / what
                case.write_text(text.replace("{}", "normal_spring = 2.0e6\nnormal_dashpot = 100.0"))
                for options in ((), ("--resume",)):
                    result = self.run_case(case, "--out", out, "--set", "run.duration=0.4", "--set", "output.probe_interval=0.02",
                                           "--set", "run.time_step=6e-5", *options)
                    measures, report = result["measures"], " ".join(result["report"].split())
                    self.assertIsNone(measures["void_ratio"]["after"])
                    self.assertIn("WARNING", report)
                    self.assertIn("there are no fields at the end", report)
                    self.assertIn(reason, report)
                    self.assertNotIn("nan", report)
                    self.assertIn("there are no fields at the end", (out / "index.html").read_text())
                    self.assertEqual((out / "fields.csv").read_text().count("\n"), 1)
                    self.assertFalse((out / "fields.vti").exists())
                if "region" in what:
                    self.assertIn("no body is left in the region", report)
                if what != "far apart":
                    self.assertIn("there is no surface", report)
                    self.assertIsNone(measures["surface_height"]["after"])
                    self.assertIsNone(measures["surface_slope"]["after"])
                    self.assertIn(",nan,nan,nan,", (out / "measures.csv").read_text().splitlines()[-1])


class Resume(RunTest):
    # Long enough to be caught in the middle; checkpoints as often as a run can be stopped.
    SETTINGS = {CORNER: ("--set", "run.duration=0.15", "--set", "output.frame_interval=2e-3"),
                SHAKE: ("--set", "run.duration=0.04", "--set", "output.frame_interval=1e-3")}
    COMMON = ("--set", "output.checkpoint_interval=0.02", "--set", "output.files=['csv']",
              "--threads", "1")

    def start(self, case, out):
        resume = ["--resume"] if (out / "run.checkpoint.h5").exists() else ["--overwrite"]
        return subprocess.Popen([PROGRAM, "run", str(case), "--out", str(out), *self.SETTINGS[case], *self.COMMON,
                                 *resume], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)

    def uninterrupted(self, case):
        out = self.folder / "whole"
        began = time.monotonic()
        self.check_done(equidem("run", case, "--out", out, "--overwrite", *self.SETTINGS[case], *self.COMMON))
        return out, time.monotonic() - began

    def check_same(self, a, b):
        for name in ("discs.csv", "history.csv", "case.toml", "energy.csv", "energy.gp"):
            self.assertEqual((a / name).read_bytes(), (b / name).read_bytes(), name)
        self.assertEqual(frame_files(a), frame_files(b))
        results = [parse_json((out / "result.json").read_text()) for out in (a, b)]
        for key in ("energy", "steps", "time", "time_step"):
            self.assertEqual(results[0][key], results[1][key])

    def test_killed_at_any_moment_it_goes_on_with_the_same_bits(self):
        chance = random.Random(4)
        for case in (CORNER, SHAKE):
            with self.subTest(case=case.name):
                whole, seconds = self.uninterrupted(case)
                out = self.folder / f"killed_{case.stem}"
                killed = 0
                for _ in range(3):
                    running = self.start(case, out)
                    time.sleep(chance.uniform(0.05, 0.9) * seconds)
                    running.kill()
                    errors = running.communicate()[1]
                    self.assertIn(running.returncode, (0, -signal.SIGKILL), errors)
                    killed += running.returncode != 0
                self.assertGreater(killed, 0)
                running = self.start(case, out)
                errors = running.communicate()[1]
                self.assertEqual(running.returncode, 0, errors)
                self.check_same(whole, out)

    def test_interrupted_it_leaves_a_checkpoint_and_goes_on_with_the_same_bits(self):
        for case, how in ((CORNER, signal.SIGINT), (SHAKE, signal.SIGTERM), (CORNER, signal.SIGHUP)):
            with self.subTest(case=case.name, how=how):
                whole, seconds = self.uninterrupted(case)
                out = self.folder / f"interrupted_{case.stem}_{how.name}"
                running = self.start(case, out)
                while not (out / "history.csv").exists() and running.poll() is None:
                    time.sleep(0.002)
                time.sleep(0.3 * seconds)
                running.send_signal(how)
                if how == signal.SIGHUP:
                    running.send_signal(how)  # the system and the shell each send one
                errors = running.communicate()[1]
                if running.returncode == 0:
                    self.skipTest("the run was over before it could be interrupted")
                self.assertEqual(running.returncode, 130, errors)
                self.assertTrue((out / "run.checkpoint.h5").exists())
                partial = parse_json((out / "result.json").read_text())
                self.assertEqual((partial["status"], partial["complete"]), ("interrupted", False))
                running = self.start(case, out)
                errors = running.communicate()[1]
                self.assertEqual(running.returncode, 0, errors)
                self.check_same(whole, out)

    def test_a_finished_run_is_prolonged_to_the_files_of_one_that_was_never_finished(self):
        for case, option, ends in ((SHAKE, (), ("3.3e-3", "7.12e-3", "1.5e-2")),
                                   (CORNER, ("--set", "run.step_rule=bound"), ("1.01e-3", "4.4e-3"))):
            with self.subTest(case=case.name):
                out, whole = self.folder / "out", self.folder / "whole"
                resume, last = ("--overwrite",), ("--set", f"run.duration={ends[-1]}")
                step = self.run_case(case, "--dry-run", *option, *last)["time_step"]
                for end in ends:
                    self.run_case(case, "--out", out, *option, *resume, "--set", f"run.duration={end}",
                                  "--set", f"run.time_step={step!r}")
                    resume = ("--resume",)
                self.run_case(case, "--out", whole, "--overwrite", *option, *last, "--set", f"run.time_step={step!r}")
                self.check_same(out, whole)

    def test_a_finished_run_that_is_resumed_keeps_its_film_to_the_end(self):
        """Its last frame is not one that a longer run has, and is not in the checkpoint of one that is resumed."""
        def film(out):
            return re.search(r'<section id="motion".*?</section>', (out / "index.html").read_text(), re.DOTALL)[0]

        out = self.folder / "out"
        # 1012 steps: the last one is a sample of the energies, and none of the film
        settings = ("--out", out, "--set", "run.time_step=1e-5", "--set", "run.duration=1.012e-2")
        self.assertEqual(self.run_case(CORNER, *settings)["steps"], 1012)
        whole = film(out)
        self.run_case(CORNER, *settings, "--resume")
        self.assertEqual(film(out), whole)

    def test_a_run_goes_on_with_the_step_that_it_had(self):
        # So short a run takes its step from the bound, a longer one would take it from the exact limit.
        out, whole = self.folder / "out", self.folder / "whole"
        short = self.run_case(SHAKE, "--out", out, "--set", "run.duration=1e-3")
        self.assertEqual(short["time_step_rule"], "bound")
        longer = self.run_case(SHAKE, "--out", out, "--resume")
        self.assertEqual((longer["time_step"], longer["time_step_rule"]), (short["time_step"], "bound"))
        self.assertIn("that of the checkpoint", longer["report"])
        self.assertNotEqual(self.run_case(SHAKE, "--dry-run")["time_step"], short["time_step"])
        self.run_case(SHAKE, "--out", whole, "--set", f"run.time_step={short['time_step']!r}")
        for name in ("discs.csv", "history.csv", "energy.csv"):
            self.assertEqual((out / name).read_bytes(), (whole / name).read_bytes(), name)
        for same in (f"run.time_step={short['time_step']!r}", "run.step_fraction=0.8", "run.integrator=leapfrog"):
            self.run_case(SHAKE, "--out", out, "--resume", "--set", same)
        self.run_case(out / "case.toml", "--out", out, "--resume")
        self.check_error(equidem("run", SHAKE, "--out", out, "--resume", "--set", "run.duration=1e-3"), 2,
                         "its checkpoint lies at", "does not go back")
        self.check_error(equidem("run", SHAKE, "--out", out, "--resume", "--set", "run.step_fraction=0.5"), 2,
                         "another case", "'step_fraction = 0.8' there")

    def test_the_answer_does_not_depend_on_the_number_of_threads(self):
        outs = []
        for n in (1, 2, 3):
            outs.append(self.folder / f"threads_{n}")
            self.check_done(equidem("run", SHAKE, "--threads", n, "--out", outs[-1], "--set", "run.duration=2e-3",
                                    "--set", "assembly.rows=61", "--set", "output.files=['csv', 'vtk']"))
        for out in outs[1:]:
            self.check_same(outs[0], out)

    def test_under_nohup_a_run_outlives_its_terminal(self):
        out = self.folder / "out"
        running = subprocess.Popen(["nohup", PROGRAM, "run", str(CORNER), "--out", str(out), *self.SETTINGS[CORNER], *self.COMMON],
                                   stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, stdin=subprocess.DEVNULL)
        while not (out / "history.csv").exists() and running.poll() is None:
            time.sleep(0.002)
        running.send_signal(signal.SIGHUP)
        self.assertEqual(running.wait(), 0)
        self.assertTrue((out / "result.json").exists())

    def test_a_checkpoint_of_another_case_is_refused_with_what_differs(self):
        out = self.folder / "out"
        short = ("--out", out, "--set", "run.duration=1e-3")
        self.run_case(SHAKE, *short)
        for option, *words in (("springs.kT=0.4e9", "kT"), ("run.damping.contact=0.03", "contact = 0.0"),
                               ("run.time_step=1e-6", "step 1e-06 s"), ("schedule.0.frequency=300", "frequency"),
                               ("assembly.rows=33", "rows"), ("probe.0.group=bottom", "group = ")):
            with self.subTest(option=option):
                self.check_error(equidem("run", SHAKE, *short, "--resume", "--set", option), 2, "another case", *words)
        # What is written and printed may change.
        self.run_case(SHAKE, *short, "--resume", "--set", "title=again", "--set", "output.files=['csv']")

    def test_tables_that_no_motion_depends_on_may_change(self):
        out = self.folder / "out"
        short = ("--out", out, "--set", "run.duration=2e-4")
        self.run_case(SHAKE, *short)
        for option in ("strength={tension=1.0e3, shear=1.0e3}", "quasistatic.max_events=5", "homogenize.bounds=affine",
                       "solver.method=cholmod"):
            with self.subTest(option):
                self.run_case(SHAKE, *short, "--resume", "--set", option)

    def test_files_that_a_case_names_are_part_of_it(self):
        text = "[springs]\nkN = 1e9\nkT = 0.0\n[run]\nduration = 1e-4\n"
        case = self.write_case([(0, 0), (2 * RADIUS, 0)], [[0, 1, 0, 0]], text)
        out = self.folder / "out"
        self.run_case(case, "--out", out)
        self.write_case([(0, 0), (2.1 * RADIUS, 0)], [[0, 1, 0, 0]], text)
        self.check_error(equidem("run", case, "--out", out, "--resume"), 2, "another case", "discs and contacts")

    def test_a_damaged_checkpoint_is_refused(self):
        out = self.folder / "out"
        short = ("--out", out, "--set", "run.duration=1e-3")
        self.run_case(SHAKE, *short)
        good = (out / "run.checkpoint.h5").read_bytes()
        altered = bytearray(good)
        altered[len(good) // 2] ^= 1
        for name, bad in (("truncated", good[:-100]), ("half", good[:len(good) // 2]), ("empty", b""),
                          ("altered", bytes(altered)), ("text", b"a checkpoint\n" * 100)):
            with self.subTest(damage=name):
                (out / "run.checkpoint.h5").write_bytes(bad)
                before = files_of(out)
                self.check_error(equidem("run", SHAKE, *short, "--resume"), 2, "run.checkpoint.h5")
                self.assertEqual(files_of(out), before)
        (out / "run.checkpoint.h5").unlink()
        self.check_error(equidem("run", SHAKE, *short, "--resume"), 2, "run.checkpoint.h5", "no such file")
        self.check_error(equidem("run", SHAKE, "--resume"), 2, "--resume", "--out")
        self.check_error(equidem("run", REST, "--resume", "--out", out), 2, "--resume", "rest")

    def test_a_full_disk_stops_the_run_with_the_file_named(self):
        for limit, interval, name in ((1000, "5e-4", "frames"), (60000, "1.0", "frames"), (200000, "1.0", "history.csv")):
            with self.subTest(bytes=limit, interval=interval):
                out = self.folder / "full"
                # Without SIGXFSZ a file past the limit is an error of the write, as on a full disk.
                done = subprocess.run([PROGRAM, "run", str(SHAKE), "--out", str(out), "--overwrite", "--threads", "1",
                                       "--set", f"output.frame_interval={interval}"], capture_output=True, text=True,
                                      restore_signals=False, timeout=120,
                                      preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (limit, limit)))
                self.check_error(done, 1, str(out / name))


if __name__ == "__main__":
    unittest.main()
