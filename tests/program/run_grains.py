#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""equidem run of bodies that collide, as a user runs it: run_grains.py PROGRAM SOURCE_FOLDER [unittest options]."""
import csv
import math
import signal
import subprocess
import time
import unittest

import numpy

from motion import RunTest, frame_files, frames_of, needs_vtk, sums_of_forces, table
from program import CASES, PROGRAM, equidem, parse_json

CRADLE, DROP, STACKED, BETWEEN, PISTON = (
    CASES / f"grains_{name}.toml" for name in ("cradle", "drop", "stacked", "between_walls", "piston"))
LAWS = ("exact_flow", "linear_dashpot", "hertz_dashpot", "five_case_map", "energy_map")

BALL = """schema = "equidem/1"
[grains]
body = "sphere"
density = 2500.0
[[grain]]
position = [0.0, 0.02]
radius = 0.01
velocity = [0.0, -1.0]
[collisions]
restitution = 0.6
stiffness = 1.0e6
closing_speed = 1.0
[[wall]]
name = "floor"
point = [0.0, 0.0]
normal = [0.0, 1.0]
[run]
duration = 0.03
"""


def rows_of(path):
    with open(path, newline="") as file:
        return list(csv.DictReader(file))


class GrainTest(RunTest):
    def write(self, text, name="case.toml"):
        path = self.folder / name
        path.write_text(text)
        return path

    def end_of(self, case, *options):
        """Result, and rows of grains.csv."""
        out = self.folder / "end"
        result = self.run_case(case, "--out", out, "--overwrite", "--set", "output.files=['csv', 'vtk']", *options)
        return result, rows_of(out / "grains.csv")


    def check_delivered(self, out, status, reason):
        """The folder has the result of a run that did not come to its end, with the state there."""
        result = parse_json((out / "result.json").read_text())
        self.assertEqual((result["status"], result["complete"]), (status, False))
        self.assertIn(reason, result["failure"])
        for key in ("steps", "time", "energy", "time_step"):
            self.assertIn(key, result)
        for name in ("case.toml", "energy.csv", "grains.csv", "index.html"):
            self.assertTrue((out / name).exists(), name)


class Motion(GrainTest):
    def test_the_cradle_passes_its_motion_on(self):
        result, grains = self.end_of(CRADLE)
        for grain, expected in zip(grains, (0, 0, 0, 0, 1)):
            self.assertAlmostEqual(float(grain["vx_m_per_s"]), expected, delta=1e-9)
        self.assertEqual(result["contacts"], 4)
        self.assertEqual(result["energy"]["dissipated"], 0)
        self.assertLess(abs(result["energy"]["relative_error"]), 1e-9)

    def test_stacked_spheres_part_with_the_speed_of_rigid_ones(self):
        _, grains = self.end_of(STACKED)
        exact = 0.271462651012440 * math.sqrt(4 * 9.8 * 0.02)
        self.assertAlmostEqual(float(grains[1]["vx_m_per_s"]) / exact, 1, delta=1e-4)
        self.assertAlmostEqual(float(grains[0]["x_m"]) / -float(grains[1]["x_m"]), 1, delta=1e-13)

    def test_a_ball_leaves_with_the_restitution_asked_for_by_every_law(self):
        case = self.write(BALL)
        for law in LAWS:
            with self.subTest(law=law):
                result, grains = self.end_of(case, "--set", f"collisions.law={law}")
                self.assertEqual(result["contacts"], 1)
                tolerance = 0.02 if law.endswith("dashpot") else 1e-9  # that of 50 steps a contact
                self.assertAlmostEqual(float(grains[0]["vy_m_per_s"]), 0.6, delta=tolerance)
                mass = 2500 * 4 / 3 * math.pi * 1e-6
                lost = result["energy"]["dissipated"]
                self.assertAlmostEqual(lost / (0.5 * mass * (1 - 0.36)), 1, delta=0.05)

    def test_the_slow_drop_of_the_paper_rests_on_the_floor(self):
        result, grains = self.end_of(DROP)
        self.assertEqual(result["steps"], 5000)
        self.assertAlmostEqual(float(grains[0]["y_m"]), 112.5, delta=1e-2)
        self.assertLess(abs(float(grains[0]["vy_m_per_s"])), 1e-2)

    def test_the_paddle_works_on_the_grains(self):
        result, grains = self.end_of(PISTON)
        self.assertGreater(result["energy"]["work_of_walls"], 1)
        self.assertEqual(len(grains), 24)
        self.assertLess(abs(result["energy"]["relative_error"]), 1e-2)

    def test_the_end_of_a_run_is_read_back_as_a_start(self):
        out = self.folder / "first"
        self.run_case(PISTON, "--out", out, "--set", "run.duration=0.3", "--set", "output.files=['csv', 'vtk']")
        result, grains = self.end_of(PISTON, "--set", f'grains.path="{out / "grains.csv"}"', "--set", "run.duration=1e-4")
        self.assertEqual(result["grains"], 24)
        for a, b in zip(rows_of(out / "grains.csv"), grains):
            self.assertEqual(a["group"], b["group"])
            self.assertAlmostEqual(float(a["x_m"]), float(b["x_m"]), delta=1e-3)


class Files(GrainTest):
    @needs_vtk
    def test_histories_and_frames_agree(self):
        out = self.folder / "out"
        self.run_case(PISTON, "--out", out, "--set", "run.duration=0.3")
        history = table(out / "history.csv")
        frames = frames_of(out)
        numpy.testing.assert_array_equal([frame[0] for frame in frames], history["time_s"])
        large = [k for k, grain in enumerate(rows_of(out / "grains.csv")) if grain["group"] == "large"]
        self.check_near(numpy.array([discs["points"][large, 0].mean() for _, _, discs, _ in frames]), history["large_x_m"],
                        1e-13)
        for name in ("picture.png", "picture.svg", "energy.csv", "energy_plot.png", "contacts.csv", "case.toml", "result.json"):
            self.assertTrue((out / name).stat().st_size > 0, name)

    @needs_vtk
    def test_contact_forces_in_frames_add_up_to_mass_times_acceleration(self):
        out = self.folder / "out"
        result = self.run_case(PISTON, "--out", out, "--set", "run.duration=0.35", "--set", "output.files=['csv', 'vtk']",
                               "--set", "output.frame_interval=1e-30")
        frames, grains = frames_of(out, 200), rows_of(out / "grains.csv")
        mass = numpy.array([math.pi * float(g["density_kg_per_m3"]) * float(g["radius_m"]) ** 2 for g in grains])[:, None]
        compared = 0
        partners = [{k: sorted((i, j) for i, j in zip(c["i"], c["j"]) if k in (i, j)) for k in range(len(grains))}
                    for _, _, _, c in frames]
        for before, after, had, have in zip(frames, frames[1:], partners, partners[1:]):
            change = mass * (after[2]["velocity"] - before[2]["velocity"])[:, :2] / result["time_step"]
            error = numpy.abs(sums_of_forces(after[3], len(grains)) + mass * [0, -9.81] - change).max(axis=1)
            same = [k for k in had if had[k] and had[k] == have[k]]  # a contact that ended within the step is not listed
            compared += len(same)
            self.assertLess(error[same].max(initial=0), 1e-8 * 9.81 * mass.max())
        self.assertGreater(compared, 1000)
        last = frames[-1][2]
        for column, values in (("x_m", last["points"][:, 0]), ("y_m", last["points"][:, 1]), ("angle_rad", last["angle"]),
                               ("vx_m_per_s", last["velocity"][:, 0]), ("spin_rad_per_s", last["spin"])):
            self.assertTrue(numpy.array_equal(values, [float(g[column]) for g in grains]), column)

    def test_the_written_case_gives_the_same_run(self):
        for case in (CRADLE, BETWEEN, PISTON):
            with self.subTest(case=case.name):
                first, second = self.folder / "first", self.folder / "second"
                for source, out in ((case, first), (first / "case.toml", second)):
                    self.run_case(source, "--out", out, "--overwrite", "--set", "run.duration=0.2",
                                  "--set", "output.files=['csv', 'vtk']")
                self.assertEqual((first / "grains.csv").read_bytes(), (second / "grains.csv").read_bytes())
                self.assertEqual((first / "case.toml").read_text(), (second / "case.toml").read_text())

    def test_columns_of_energy_add_up(self):
        out = self.folder / "out"
        self.run_case(BETWEEN, "--out", out, "--set", "output.files=['csv', 'vtk']")
        h = table(out / "history.csv")
        terms = {name: column for name, column in h.items() if name.endswith("_J_per_m") and name != "error_J_per_m"}
        lacks = sum(-column if name.startswith(("work", "initial")) else column for name, column in terms.items())
        size = max(numpy.abs(column).max() for column in terms.values())
        self.assertLess(numpy.abs(lacks - h["error_J_per_m"]).max(), 1e-13 * size)

    def test_a_dry_run_says_how_large_it_is_and_writes_nothing(self):
        out = self.folder / "out"
        size = self.run_case(BETWEEN, "--dry-run", "--out", out)
        self.assertEqual(size["status"], "dry_run")
        self.assertEqual(size["steps"], self.run_case(BETWEEN)["steps"])
        self.assertFalse(out.exists())


class Resume(GrainTest):
    SETTINGS = ("--set", "output.checkpoint_interval=0.01", "--set", "output.files=['csv', 'vtk']")

    def check_same(self, a, b):
        for name in ("grains.csv", "contacts.csv", "history.csv", "energy.csv", "case.toml"):
            self.assertEqual((a / name).read_bytes(), (b / name).read_bytes(), name)
        self.assertEqual(frame_files(a), frame_files(b))
        results = [parse_json((out / "result.json").read_text()) for out in (a, b)]
        for key in ("energy", "steps", "time", "time_step", "contacts"):
            self.assertEqual(results[0][key], results[1][key])

    def test_stopped_and_gone_on_with_it_has_the_same_bits(self):
        for case, long in ((BETWEEN, ("--set", "run.duration=3.0")), (PISTON, ("--set", "run.duration=0.6"))):
            for killing in (signal.SIGINT, signal.SIGKILL):
                with self.subTest(case=case.name, killing=killing):
                    whole, out = self.folder / f"whole_{case.stem}", self.folder / f"{case.stem}_{killing}"
                    if not whole.exists():
                        self.check_done(equidem("run", case, "--out", whole, *self.SETTINGS, *long))
                    command = [PROGRAM, "run", str(case), "--out", str(out), *self.SETTINGS, *long]
                    running = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
                    while not (out / "run.checkpoint.h5").exists() and running.poll() is None:
                        time.sleep(0.002)
                    running.send_signal(killing)
                    errors = running.communicate()[1]
                    if running.returncode != 0:
                        self.assertEqual(running.returncode, 130 if killing == signal.SIGINT else -killing, errors)
                        if killing == signal.SIGINT:
                            self.check_delivered(out, "interrupted", "steps are done")
                    self.check_done(equidem("run", case, "--out", out, *self.SETTINGS, *long, "--resume"))
                    self.check_same(whole, out)

    def test_every_law_is_prolonged_with_the_same_bits(self):
        for law in LAWS:
            with self.subTest(law=law):
                out, whole = self.folder / f"out_{law}", self.folder / f"whole_{law}"
                options = ("--set", f"collisions.law={law}", "--set", "output.files=['csv', 'vtk']")
                if law == "hertz_dashpot":
                    options += ("--set", "collisions.stiffness=1e9", "--set", "collisions.largest_overlap=none")
                if law == "five_case_map":
                    options += ("--set", "run.time_step=1e-5")
                self.run_case(BETWEEN, "--out", out, *options, "--set", "run.duration=0.3")
                self.run_case(BETWEEN, "--out", out, *options, "--set", "run.duration=0.6", "--resume")
                self.run_case(BETWEEN, "--out", whole, *options, "--set", "run.duration=0.6")
                for name in ("grains.csv", "contacts.csv"):
                    self.assertEqual((out / name).read_bytes(), (whole / name).read_bytes(), name)

    def test_a_checkpoint_of_another_case_is_refused(self):
        out = self.folder / "out"
        self.run_case(BETWEEN, "--out", out, "--set", "run.duration=0.1")
        resume = ("run", BETWEEN, "--out", out, "--resume")
        self.check_error(equidem(*resume, "--set", "collisions.friction=0.2"), 2, "another case", "friction")
        self.check_error(equidem(*resume, "--set", "run.duration=0.05"), 2, "a run does not go back")
        self.check_error(equidem("run", BETWEEN, "--resume"), 2, "--out")
        self.check_error(equidem("run", BETWEEN, "--out", self.folder / "none", "--resume"), 2, "no such file")


class Refusals(GrainTest):
    def test_other_verbs_need_an_assembly(self):
        for verb in ("solve", "homogenize", "calibrate", "stability"):
            with self.subTest(verb=verb):
                self.check_error(equidem(verb, CRADLE), 2, "[assembly]", "equidem run")

    def test_wrong_input_is_told_with_its_line(self):
        case = self.write(BALL)
        for change, words in (
                (("density = 2500.0\n", ""), ("case.toml:4", "density")),
                (("[0.0, 0.02]", "[0.0, -0.02]"), ("behind", "floor")),
                (("restitution = 0.6", "restitution = 60"), ("case.toml:10", "from 0 to 1")),
                (("[run]\nduration = 0.03\n", ""), ("[run]",)),
                (("stiffness = 1.0e6\n", ""), ("stiff", "contact_duration"))):
            with self.subTest(change=change):
                self.check_error(equidem("run", self.write(BALL.replace(*change))), 2, *words)
        self.check_error(equidem("run", case, "--seed", 3), 2, "--seed")

    def test_a_step_in_which_a_ball_would_cross_the_floor_ends_the_run_with_what_it_has(self):
        case = self.write(BALL.replace("[0.0, -1.0]", "[0.0, -1000.0]").replace("[run]", "[run]\ntime_step = 1.0e-4"))
        out = self.folder / "out"
        done = equidem("run", case, "--out", out)
        self.check_partial(done, "case.toml", "step", out=out)
        self.assertTrue((out / "run.checkpoint.h5").exists())
        self.check_delivered(out, "failed", "case.toml")

    def test_motion_that_comes_from_nothing_is_no_answer(self):
        text = BALL.replace("closing_speed = 1.0\n", "law = \"hertz_dashpot\"\n").replace("1.0e6", "1.0e14")
        out = self.folder / "out"
        done = equidem("run", self.write(text.replace("[run]", "[run]\ntime_step = 1.0e-4")), "--out", out)
        self.check_partial(done, "case.toml", "times the energy", "shorter time_step", out=out)
        self.check_delivered(out, "failed", "times the energy")

    def test_maps_say_that_beds_are_not_for_them(self):
        column = BALL
        for old, new in (("restitution = 0.6\nstiffness = 1.0e6\nclosing_speed = 1.0", "restitution = 0.5\ncontact_duration = 1e-3"),
                         ("velocity = [0.0, -1.0]\n", ""), ("0.02]", "0.01]"),
                         ("duration = 0.03", "duration = 0.5\ngravity = [0.0, -9.8]")):
            column = column.replace(old, new)
        column += "".join(f"[[grain]]\nposition = [0.0, {0.02 * n + 0.01}]\nradius = 0.01\n" for n in range(1, 6))
        for law, doubtful in (("exact_flow", False), ("linear_dashpot", False), ("five_case_map", True), ("energy_map", True)):
            with self.subTest(law=law):
                text = equidem("run", self.write(column.replace("[collisions]", f'[collisions]\nlaw = "{law}"'))).stdout
                self.assertEqual(doubtful, "two by two" in text, text)
                self.assertEqual(doubtful, "came from nothing" in " ".join(text.split()), text)
        self.assertNotIn("two by two", equidem("run", DROP, "--set", "run.duration=0.1").stdout)

    def test_bytes_of_a_file_do_not_reach_the_terminal_raw(self):
        self.write("x,y,radius\n0,0.02,\x1b[31m\x07\n", "grains.csv")
        done = equidem("run", self.write(BALL.replace("density", 'path = "grains.csv"\ndensity', 1)))
        self.check_error(done, 2, "grains.csv:2", r"\x1b[31m\x07")

    def test_a_grain_in_a_wrong_place_is_told_with_its_line(self):
        self.check_error(equidem("run", self.write(BALL.replace("[0.0, 0.02]", "[0.0, -0.02]"))), 2,
                         "case.toml:5: grain", "behind")


if __name__ == "__main__":
    unittest.main()
