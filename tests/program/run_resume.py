# SPDX-License-Identifier: GPL-3.0-or-later
"""equidem run stopped, prolonged, damaged and gone on with: run_resume.py PROGRAM SOURCE_FOLDER [unittest options]."""
import random
import re
import signal
import subprocess
import time
import unittest

from motion import CORNER, RADIUS, REST, SHAKE, RunTest
from program import NO_PICTURE, contents, equidem, files_of, flat, result_in, rows_of, started, words_of
from run_cells import sheared_case
from run_grains import BETWEEN, BONDED, ELLIPSES, LAWS, PISTON, SHAKEN, tail_of
from run_bonds import BREAKING
from run_waves import standing_wave
from scenes import NAMED, POURED, POURED_OUTPUT, PRESS, RUN, SERVO, STAGES, VERLET, output, rock

PAIR = """[grains]
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
"""
OFTEN = "output.checkpoint_interval=0.01"


class ResumeTest(RunTest):
    def check_same(self, one, other):
        """All files but checkpoints, which hold counters of the work."""
        wanted, found = contents(one), contents(other)
        for files in (wanted, found):
            files["result.json"].pop("evaluations", None)  # of the neighbours that are searched once more
        self.assertEqual(found.keys(), wanted.keys())
        for name in wanted:
            if not name.endswith(".checkpoint.h5"):
                self.assertEqual(found[name], wanted[name], name)


class Prolonged(ResumeTest):
    def scenes(self):
        """Name: case, options, and the ends to which it is run one after another."""
        for law in LAWS:
            stiff = {"hertz_dashpot": ("collisions.stiffness=1e9", "collisions.largest_overlap=none"),
                     "five_case_map": ("run.time_step=1e-5",)}.get(law, ())
            yield law, BETWEEN, (f"collisions.law={law}", *stiff), ("0.3", "0.6")
        yield "ellipses and clumps", ELLIPSES, (), ("0.2", "0.3")
        yield "bonded pairs", BONDED, (), ("0.1", "0.2")
        yield "bonds that break", BREAKING, (), ("0.09", "0.15")
        measured = ("shaking.start=0.02", "output.probe_interval=4e-3", "output.frame_interval=7e-3")
        yield "a box that shakes and is measured", SHAKEN, measured, ("0.0213", "0.0301", "0.042", "0.0517")
        yield "a servo wall", self.write(PRESS + SERVO + RUN + output(1e-3), "servo.toml"), (), ("0.043", "0.1")
        yield "a periodic cell", sheared_case(self), ("run.steps_per_contact=none", "run.time_step=4e-6"), ("0.13", "0.2")
        wave, duration, _ = standing_wave(self)
        for name, case, options, ends in (("a standing wave", wave, (), (duration / 2, duration)),
                                          ("bonded discs", SHAKE, (), ("3.3e-3", "7.12e-3", "1.5e-2")),
                                          ("bonded discs of finite motion", CORNER, ("run.step_rule=bound",), ("1.01e-3", "4.4e-3"))):
            step = self.run_case(case, "--dry-run", *options, f"run.duration={ends[-1]}")["time_step"]
            yield name, case, (*options, f"run.time_step={step!r}"), ends

    def test_a_run_that_is_prolonged_has_the_files_of_one_that_ran_through(self):
        for name, case, options, ends in self.scenes():
            with self.subTest(scene=name):
                out, whole = self.folder / f"parts {name}", self.folder / f"whole {name}"
                self.run_case(case, "--out", whole, *options, f"run.duration={ends[-1]}")
                resume = ()
                for end in ends:
                    self.run_case(case, "--out", out, *options, f"run.duration={end}", *resume)
                    resume = ("--resume",)
                    if "break" in name:
                        self.assertGreater(len(rows_of(out / "breaks.csv")), 0)
                self.check_same(whole, out)

    def test_bonds_of_every_kind_go_on_after_any_step_with_the_same_rows(self):
        springs, dashpots = "normal_spring = 2.0e6\ntangential_spring = 1.0e6\n", "normal_dashpot = 100.0\nrolling_dashpot = 1e-3\n"
        whole, out = self.folder / "whole", self.folder / "out"
        for bonds in (springs, dashpots, springs + dashpots, springs + dashpots + "[strength]\ntension = 60.0\nshear = 60.0\n"):
            case = self.write(PAIR.format(bonds))
            for integrator in ("semi_implicit_euler", "velocity_verlet"):
                common = (f"run.integrator={integrator}", "run.time_step=1.5e-5")
                self.run_case(case, "--out", whole, "--overwrite", *common)
                for end in ((), ("run.duration=1.5e-5",), ("run.duration=3.3e-4",), ("run.duration=9.9e-4",)):
                    with self.subTest(bonds=bonds, integrator=integrator, end=end):
                        self.run_case(case, "--out", out, "--overwrite", *common, *end)
                        self.run_case(case, "--out", out, "--resume", *common)
                        self.check_same(whole, out)

    def test_a_run_in_stages_goes_on_from_the_end_of_each_with_the_same_files(self):
        for name, text, options, stages in (("walls", PRESS + SERVO + STAGES, (VERLET,), ("slide", "press")),
                                            ("names", NAMED, (), ("relieve", "press")), ("bonds", rock(), (), ("cement", "press")),
                                            ("bodies", POURED + POURED_OUTPUT, (), ("level", "pour", "settle"))):
            case, whole, parts = self.write(text, f"{name}.toml"), self.folder / f"whole_{name}", self.folder / f"parts_{name}"
            self.run_case(case, "--out", whole, *options, NO_PICTURE)
            self.run_case(case, "--out", parts, *options, NO_PICTURE)
            for ended in self.go_on_from(parts, *stages):
                with self.subTest(scene=name, stage=ended):
                    self.run_case(case, "--out", parts, "--resume", *options, NO_PICTURE)
                    self.check_same(whole, parts)

    def test_a_run_goes_on_with_the_step_that_it_had(self):
        # So short a run takes its step from the bound, a longer one would take it from the exact limit.
        out, whole = self.folder / "out", self.folder / "whole"
        short = self.run_case(SHAKE, "--out", out, "run.duration=1e-3")
        self.assertEqual(short["time_step_rule"], "bound")
        longer = self.run_case(SHAKE, "--out", out, "--resume")
        self.assertEqual((longer["time_step"], longer["time_step_rule"]), (short["time_step"], "bound"))
        self.assertIn("that of the checkpoint", longer["report"])
        self.assertNotEqual(self.run_case(SHAKE, "--dry-run")["time_step"], short["time_step"])
        self.run_case(SHAKE, "--out", whole, f"run.time_step={short['time_step']!r}")
        self.check_same_files(out, whole, "discs.csv", "history.csv", "energy.csv")
        for same in (f"run.time_step={short['time_step']!r}", "run.step_fraction=0.8", "run.integrator=leapfrog"):
            self.run_case(SHAKE, "--out", out, "--resume", same)
        self.run_case(out / "case.toml", "--out", out, "--resume")
        self.check_errors(("run.duration=1e-3", "its checkpoint lies at", "does not go back"),
                          ("run.step_fraction=0.5", "another case", "'step_fraction = 0.8' there"),
                          before=("run", SHAKE, "--out", out, "--resume"))

    def test_a_finished_run_that_is_resumed_keeps_its_film_to_the_end(self):
        """Its last frame is not one that a longer run has, and is not in the checkpoint of one that is resumed."""
        out = self.folder / "out"
        # 1012 steps: the last one is a sample of the energies, and none of the film
        settings = ("--out", out, "run.time_step=1e-5", "run.duration=1.012e-2")
        self.assertEqual(self.run_case(CORNER, *settings)["steps"], 1012)
        films = []
        for resume in (("--resume",), ("--resume",)):
            films.append(re.search(r'<section id="motion".*?</section>', (out / "index.html").read_text(), re.DOTALL)[0])
            self.run_case(CORNER, *settings, *resume)
        self.assertEqual(*films)

    def test_a_measure_with_nothing_left_to_measure_is_null_and_the_run_is_delivered(self):
        unbonded = PAIR.replace("[[bond]]\ngrains = [0, 1]\n", "").replace("[bonds]\n{}\n", "")
        for what, text, reason in (
                ("flown away", PAIR, "no heap of bodies is left"),
                ("far apart", unbonded.replace("cell = 0.02", "cell = 2e-4").replace("[0.1, 0.0]", "[1000.0, 0.0]"),
                 "more than a million"),
                ("a region left empty", PAIR.replace("cell = 0.02", "cell = 0.02\nregion = [0.0, 0.0, 0.02, 0.04]"),
                 "no heap of bodies")):
            text = text.replace("[0.1, 0.0]", "[1.0, 0.0]").replace("{}", "normal_spring = 2.0e6\nnormal_dashpot = 100.0")
            with self.subTest(what=what):
                case, out = self.write(text), self.folder / what
                for options in ((), ("--resume",)):
                    result = self.run_case(case, "--out", out, "run.duration=0.4", "output.probe_interval=0.02", "run.time_step=6e-5",
                                           *options)
                    measures, report = result["measures"], flat(result["report"])
                    self.assertIsNone(measures["void_ratio"]["after"])
                    for words in ("WARNING", "there are no fields at the end", reason):
                        self.assertIn(words, report)
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


class Stopped(ResumeTest):
    def test_a_run_that_is_stopped_by_any_signal_goes_on_with_the_same_bits(self):
        csv, chance = "output.files=['csv']", random.Random(4)
        corner = ("run.duration=0.15", "output.frame_interval=2e-3", "output.checkpoint_interval=0.02", csv)
        shake = ("run.duration=0.04", "output.frame_interval=1e-3", "output.checkpoint_interval=0.02", csv)
        slow = ("stage.0.duration=20", "stage.1.duration=20", "stage.1.wall.0.velocity=[1e-4, 0.0]", "stage.2.duration=20",
                "output.checkpoint_interval=0.02", "output.probe_interval=0.1", NO_PICTURE)
        staged = self.write(PRESS + SERVO + STAGES, "staged.toml")
        kill, interrupted = 0, 0
        for case, options, signals in (
                (CORNER, corner, (signal.SIGINT, signal.SIGHUP, *[signal.SIGKILL] * 3)),
                (SHAKE, shake, (signal.SIGTERM, *[signal.SIGKILL] * 3)),
                (BETWEEN, ("run.duration=3.0", OFTEN, NO_PICTURE), (signal.SIGINT, signal.SIGKILL)),
                (PISTON, ("run.duration=0.6", OFTEN, NO_PICTURE), (signal.SIGINT, signal.SIGKILL)),
                (staged, slow, (signal.SIGINT,) * 3)):
            with self.subTest(case=case.name):
                whole, out = self.folder / f"whole_{case.stem}", self.folder / case.stem
                command = ("run", case, *options, "--threads", 1, "--out")
                began = time.monotonic()
                self.done(*command, whole)
                seconds = time.monotonic() - began
                for number in signals:
                    running = started(*command, out, *(["--resume"] if (out / "run.checkpoint.h5").exists() else ["--overwrite"]))
                    while not (out / "run.checkpoint.h5").exists() and running.poll() is None:
                        time.sleep(0.002)
                    time.sleep(chance.uniform(0.05, 0.3) * seconds)
                    running.send_signal(number)
                    if number == signal.SIGHUP:
                        running.send_signal(number)  # the system and the shell each send one
                    errors = running.communicate()[1]
                    self.assertIn(running.returncode, (0, -number if number == signal.SIGKILL else 130), errors)
                    if running.returncode == 130:
                        interrupted += 1
                        result = result_in(out)
                        self.assertEqual((result["status"], result["complete"]), ("interrupted", False))
                        self.assertIn("steps are done", result["failure"])
                        self.assertLessEqual({"steps", "time", "energy", "time_step"}, set(result))
                        self.check_there(out, "run.checkpoint.h5", "case.toml", "energy.csv", "index.html")
                    kill += running.returncode == -signal.SIGKILL
                self.done(*command, out, "--resume")
                self.check_same(whole, out)
        self.assertGreater(min(kill, interrupted), 2)

    def test_under_nohup_a_run_outlives_its_terminal(self):
        out, null = self.folder / "out", {name: subprocess.DEVNULL for name in ("stdin", "stdout", "stderr")}
        command = words_of(("run", CORNER, "--out", out, "run.duration=0.15", "output.frame_interval=2e-3", "output.files=['csv']"))
        running = subprocess.Popen(["nohup", *command], **null)
        while not (out / "history.csv").exists() and running.poll() is None:
            time.sleep(0.002)
        running.send_signal(signal.SIGHUP)
        self.assertEqual(running.wait(), 0)
        self.check_there(out, "result.json")


class Refused(ResumeTest):
    def test_a_checkpoint_of_another_case_is_refused_with_what_differs(self):
        out, boxed = self.folder / "out", self.folder / "boxed"
        short = ("run", SHAKE, "--out", out, "run.duration=1e-3")
        self.done(*short)
        self.check_errors(("springs.kT=0.4e9", "another case", "kT"), ("run.damping.contact=0.03", "another case", "contact = 0.0"),
                          ("run.time_step=1e-6", "another case", "step 1e-06 s"),
                          ("schedule.0.frequency=300", "another case", "frequency"),
                          ("assembly.rows=33", "another case", "rows"), ("probe.0.group=bottom", "another case", "group = "),
                          before=(*short, "--resume"))
        # what is written and printed, and what no motion depends on, may change
        for options in (("title=again", "output.files=['csv']"), ("strength={tension=1.0e3, shear=1.0e3}",),
                        ("quasistatic.max_events=5",),
                        ("homogenize.bounds=affine",), ("solver.method=cholmod",)):
            with self.subTest(options):
                self.done(*short, "--resume", *options)
        self.run_case(BETWEEN, "--out", boxed, "run.duration=0.1")
        self.check_errors((("--out", boxed, "run.duration=0.1", "collisions.friction=0.2"), "another case", "friction"),
                          (("--out", boxed, "run.duration=0.05"), "a run does not go back"),
                          ((), "--out"), (("--out", self.folder / "none"), "no such file"), before=("run", BETWEEN, "--resume"))

    def test_files_that_a_case_names_are_part_of_it(self):
        text, out = "[springs]\nkN = 1e9\nkT = 0.0\n[run]\nduration = 1e-4\n", self.folder / "out"
        for distance, words in ((2, ()), (2.1, ("another case", "discs and contacts"))):
            case = self.bonded_case([(0, 0), (distance * RADIUS, 0)], [[0, 1, 0, 0]], text)
            if words:
                self.check_error(equidem("run", case, "--out", out, "--resume"), 2, *words)
            else:
                self.run_case(case, "--out", out)
        case = self.write('[grains]\npath = "grains.csv"\n[bonds]\npath = "bonds.csv"\n' + tail_of(BONDED, "[collisions]"))
        self.run_case(BONDED, "--out", self.folder / "first", "run.duration=0.01", NO_PICTURE)
        for name in ("grains.csv", "bonds.csv"):
            self.write((self.folder / "first" / name).read_text(), name)
        other = self.folder / "other"
        self.run_case(case, "--out", other, "run.duration=0.01", NO_PICTURE)
        self.write((self.folder / "bonds.csv").read_text().replace("2000", "3000"), "bonds.csv")
        self.check_error(equidem("run", case, "--out", other, "--resume"), 2, "another")

    def test_a_stage_of_another_length_is_another_case(self):
        case, out = self.write(PRESS + SERVO + STAGES), self.folder / "out"
        self.run_case(case, "--out", out, NO_PICTURE)
        self.check_error(equidem("run", case, "--out", out, "--resume", NO_PICTURE, "stage.1.duration=30"), 2, "another case")

    def test_a_damaged_checkpoint_is_refused(self):
        out = self.folder / "out"
        short = ("run", SHAKE, "--out", out, "run.duration=1e-3")
        self.done(*short)
        checkpoint = out / "run.checkpoint.h5"
        good = checkpoint.read_bytes()
        altered = bytearray(good)
        altered[len(good) // 2] ^= 1
        for name, bad in (("truncated", good[:-100]), ("half", good[:len(good) // 2]), ("empty", b""), ("altered", bytes(altered)),
                          ("text", b"a checkpoint\n" * 100)):
            with self.subTest(damage=name):
                checkpoint.write_bytes(bad)
                before = files_of(out)
                self.check_error(equidem(*short, "--resume"), 2, "run.checkpoint.h5")
                self.assertEqual(files_of(out), before)
        checkpoint.unlink()
        self.check_errors(((*short, "--resume"), "run.checkpoint.h5", "no such file"),
                          (("run", REST, "--resume", "--out", out), "--resume", "rest"))


if __name__ == "__main__":
    unittest.main()
