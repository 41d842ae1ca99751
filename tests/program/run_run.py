#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""equidem run, as a user runs it: run_run.py PROGRAM SOURCE_FOLDER [unittest options]."""
import math
import re
import shutil
import unittest

import numpy

from motion import (CORNER, KN, MASS, PULSE, RADIUS, REST, SHAKE, RunTest, files_of, frame_files, frames_of, needs_vtk,
                    poly_data, sums_of_forces, table)
from program import CASES, equidem


class StaticAgreement(RunTest):
    def displacements(self, verb, case, *options):
        out = self.folder / verb
        self.check_done(equidem(verb, case, "--threads", 1, "--out", out, "--overwrite", "--set", "output.files=['csv']",
                                *options))
        discs = table(out / "discs.csv")
        return numpy.array([discs["ux_m"], discs["uy_m"], RADIUS * discs["rotation_rad"]])

    def test_rest_is_the_solution_of_the_matrix(self):
        for case, options in ((REST, ["springs.kT=0.5e9"]), (REST, ["springs.kT=0"]),
                              (REST, ["effects.rotation=restrained"]),
                              (CASES / "delaunay_tension.toml", ["assembly.density=2650", "assembly.discs=400"])):
            with self.subTest(case=case.name, options=options):
                sets = [word for option in [*options, "run.until_rest=1e-12"] for word in ("--set", option)]
                self.check_near(self.displacements("run", case, *sets), self.displacements("solve", case, *sets), 1e-9)

    def test_a_damped_motion_ends_at_the_solution_of_the_matrix(self):
        case = self.folder / "damped.toml"
        case.write_text(REST.read_text().replace("until_rest = 1e-10", "duration = 0.03\n[run.damping]\nlocal = 0.5"))
        small = ("--set", "assembly.columns=11", "--set", "assembly.rows=11")
        self.check_near(self.displacements("run", case, *small), self.displacements("solve", case, *small), 1e-9)

    def test_what_a_run_to_rest_does_not_heed_is_named(self):
        done = self.check_done(equidem("run", REST, "--set", "run.damping.contact=0.1", "--set", "run.time_step=1e-6",
                                       "--set", "output.frame_interval=1e-6"))
        self.assertRegex(done.stdout, r"not used +time_step, \[run.damping\], frame_interval: ")
        self.assertNotIn("not used", self.check_done(equidem("run", REST)).stdout)

    def test_springs_of_calibrate_are_accepted(self):
        springs = self.folder / "springs"
        self.check_done(equidem("calibrate", CASES / "calibrate_lattice.toml", "--out", springs))
        text = re.sub(r"\[springs\]\nkN.*\nkT.*\n", "", REST.read_text())
        case = self.folder / "calibrated.toml"
        case.write_text(text.replace('schema = "equidem/1"',
                                     f'schema = "equidem/1"\nsprings = "{springs / "springs.toml"}"'))
        self.check_near(self.displacements("run", case, "--set", "run.until_rest=1e-12"),
                        self.displacements("solve", case), 1e-9)


class Motion(RunTest):
    def test_free_fall(self):
        case = self.write_case([(0, 1)], [], """[springs]
kN = 1e9
kT = 0.5e9
[run]
duration = 0.1
time_step = 1e-3
gravity = [1.0, -9.81]
[[velocity]]
group = "d0"
velocity = [0.5, 2.0]
spin = 3.0
[[probe]]
name = "disc"
group = "d0"
quantities = ["displacement", "velocity"]
[output]
probe_interval = 1e-3
""")
        for integrator in ("leapfrog", "velocity_verlet", "fourth_order"):
            with self.subTest(integrator=integrator):
                h = self.history(case, "--set", f"run.integrator={integrator}")
                t = h["time_s"]
                self.assertEqual(len(t), 101)
                self.check_near(h["disc_ux_m"], 0.5 * t + 0.5 * t**2, 1e-12)
                self.check_near(h["disc_uy_m"], 2.0 * t - 0.5 * 9.81 * t**2, 1e-12)
                self.check_near(h["disc_vy_m_per_s"], 2.0 - 9.81 * t, 1e-12)
                fallen = -MASS * (h["disc_ux_m"] - 9.81 * h["disc_uy_m"])
                total = h["kinetic_J_per_m"] + h["potential_J_per_m"]
                self.check_near(total, numpy.full_like(total, h["initial_J_per_m"][0]), 1e-12)
                self.check_near(h["potential_J_per_m"], fallen, 1e-12)

    def test_a_chain_vibrates_at_its_frequencies(self):
        # Free ends: u_j = cos(pi p (j + 1/2)/n), omega = 2 sqrt(k/m) sin(pi p/(2 n)); central differences make it
        # (2/h) asin(omega h/2), and begin as sin.
        n = 7
        for mode in (1, 4, n - 1):
            shape = [math.cos(math.pi * mode * (j + 0.5) / n) for j in range(n)]
            velocities = "".join(f'[[velocity]]\ngroup = "d{j}"\nvelocity = [{v!r}, 0.0]\n'
                                 for j, v in enumerate(shape))
            probes = "".join(f'[[probe]]\nname = "d{j}"\ngroup = "d{j}"\n' for j in range(n))
            case = self.write_case([(2 * RADIUS * j, 0) for j in range(n)], [[j, j + 1, 0, 0] for j in range(n - 1)],
                                   f"[springs]\nkN = {KN}\nkT = 0.0\n[run]\nduration = 1e-3\n{velocities}{probes}"
                                   "[output]\nprobe_interval = 1e-9\n")
            with self.subTest(mode=mode):
                h = self.history(case)
                t, step = h["time_s"], h["time_s"][1]
                omega = 2 * math.sqrt(KN / MASS) * math.sin(math.pi * mode / (2 * n))
                seen = 2 / step * math.asin(omega * step / 2)
                expected = numpy.outer(shape, numpy.sin(seen * t)) * step / math.sin(seen * step)
                self.check_near(numpy.array([h[f"d{j}_ux_m"] for j in range(n)]), expected, 1e-9)
                total = h["kinetic_J_per_m"] + h["elastic_J_per_m"] - h["sway_J_per_m"]
                self.check_near(total, numpy.full_like(total, 0.5 * MASS * sum(v * v for v in shape)), 1e-12)

    def test_columns_of_energy_add_up(self):
        sums = {"kinetic": 1, "elastic": 1, "potential": 1, "sway": -1, "damped_mass": 1, "damped_contact": 1, "damped_local": 1,
                "work_of_loads": -1, "work_of_supports": -1, "work_of_walls": -1, "initial": -1}
        for case in (SHAKE, CORNER, PULSE):
            with self.subTest(case=case.name):
                h = self.history(case, "--set", "run.duration=0.01")
                lacks = sum(sign * h[f"{name}_J_per_m"] for name, sign in sums.items())
                size = max(numpy.abs(h[f"{name}_J_per_m"]).max() for name in sums)
                self.assertLessEqual(numpy.abs(lacks - h["error_J_per_m"]).max(), 1e-14 * size)
                # Exact for small motions; of the second order in the step for finite ones.
                self.assertLess(numpy.abs(lacks).max(), (1e-2 if case == CORNER else 1e-12) * size)

    def test_negative_kT_grows_as_predicted(self):
        case = self.folder / "growing.toml"
        case.write_text("""schema = "equidem/1"
[assembly]
kind = "hexagonal"
columns = 6
rows = 6
radius = 0.005
density = 2650.0
periodic = true
[springs]
kN = 1e9
kT = -1e8
[run]
duration = 2e-5
allow_unstable_step = true
step_fraction = 0.02
[[group]]
name = "all"
box = [-1.0, -1.0, 1.0, 1.0]
[[velocity]]
group = "all"
spin = 1e-6
[[probe]]
name = "all"
group = "all"
quantities = ["rotation"]
[output]
probe_interval = 1e-9
""")
        # All discs turn alike: rate² = 24 |kT|/m; in time theta = (spin/rate) sinh(rate t) but for the step squared.
        rate = math.sqrt(24 * 1e8 / MASS)
        h = self.history(case)
        self.check_near(h["all_rotation_rad"], 1e-6 / rate * numpy.sinh(rate * h["time_s"]), 1e-3)
        notes = equidem("run", case, "--dry-run").stdout
        predicted = float(re.search(r"Motions grow at the\s+rate (\S+) 1/s", notes)[1])
        self.assertAlmostEqual(predicted / rate, 1, delta=1e-5)
        self.check_error(equidem("run", case, "--set", "run.allow_unstable_step=false"), 2, "kT is negative", "rate")
        self.check_error(equidem("run", case, "--set", "run.duration=1e-2"), 1, "ran away", "kT is negative", "step ")


class Output(RunTest):
    def test_json_has_the_documented_keys(self):
        result = self.run_case(PULSE)
        for key in ("status", "report", "times", "effects", "version", "steps", "time_step", "critical_time_step",
                    "energy", "particle_steps_per_second", "time_step_ratio", "discs", "contacts", "bytes_per_disc"):
            self.assertIn(key, result)
        for key in ("kinetic", "elastic", "potential", "dissipated", "input", "error"):
            self.assertIn(key, result["energy"])
        self.assertEqual(result["status"], "done")
        self.assertEqual(result["steps"], math.ceil(2e-3 / result["time_step"]))
        self.assertAlmostEqual(result["time"] / (result["steps"] * result["time_step"]), 1, delta=1e-12)
        self.assertLess(result["time_step"], result["critical_time_step"])
        self.assertLess(abs(result["energy"]["relative_error"]), 1e-12)
        rest = self.run_case(REST)
        self.assertEqual(rest["status"], "at_rest")
        self.assertLess(rest["relative_unbalanced_force"], 1e-10)
        self.assertEqual(rest["discs"], 431)

    def test_the_report_states_step_limit_effects_and_balance(self):
        for case, fraction in ((PULSE, 0.8), (SHAKE, 0.8), (CORNER, 0.4)):
            report = self.check_done(equidem("run", case, "--threads", 1)).stdout
            places = [report.find(word) for word in ("assembly", "springs", "effects", "motions", "integrator",
                                                     "time step", "memory", "steps  ", "energy", "balance", "times")]
            self.assertEqual(places, sorted(places), report)
            self.assertNotIn(-1, places, report)
            self.assertLessEqual(max(map(len, report.splitlines())), 112, report)
            self.assertRegex(report, rf"time step +\S+ s, {fraction} of the (critical|guaranteed) step \S+ s")
            self.assertNotIn("compare with a shorter step", report)

    def test_a_balance_that_lacks_much_is_pointed_at(self):
        done = self.check_done(equidem("run", PULSE, "--set", "run.integrator=thesis",
                                       "--set", "run.damping.contact=0.1"))
        self.assertIn("compare with a shorter step", done.stdout)

    def test_the_balance_is_held_against_the_most_energy_of_the_run(self):
        for case in (CORNER, PULSE):
            report = self.check_done(equidem("run", case, "--threads", 1)).stdout
            end, most = (float(x) for x in re.search(r"error (\S+) of the largest term of the run\s+at its end, at most "
                                                     r"(\S+) on the way", report).groups())
            self.assertLessEqual(end, most)

    def test_the_order_is_that_of_the_dampers_too(self):
        for option, order in (("run.damping.mass=1.0", 2), ("run.damping.contact=0.1", 1), ("run.damping.local=0.1", 1),
                              ("run.damping.stiffness=1e-7", 1)):
            report = self.check_done(equidem("run", PULSE, "--dry-run", "--set", option)).stdout
            self.assertRegex(report, rf"integrator +leapfrog, order {order}")
        viscous = self.folder / "viscous.toml"
        viscous.write_text(PULSE.read_text() + '[viscoelastic]\nnormal = "kelvin_voigt"\ntauN = 1e-7\n')
        report = self.check_done(equidem("run", viscous, "--dry-run")).stdout
        self.assertRegex(report, r"integrator +leapfrog, order 1 \(dampers act half a step late\)")

    def test_a_run_to_rest_says_that_schedules_stand_still(self):
        for case, told in ((SHAKE, True), (REST, False)):
            report = self.check_done(equidem("run", case, "--set", "run.duration=none", "--set", "run.until_rest=1e-6")
                                     if told else equidem("run", case)).stdout
            self.assertEqual(bool(re.search(r"schedules +as they are at t = 0", report)), told)

    def test_an_interval_far_longer_than_the_run(self):
        out = self.folder / "out"
        self.assertEqual(self.run_case(PULSE, "--set", "run.duration=1e-300", "--out", out)["steps"], 1)
        self.assertEqual(list(table(out / "history.csv")["step"]), [0, 1])

    @needs_vtk
    def test_frames_and_histories_follow_their_schedules(self):
        out = self.folder / "out"
        result = self.run_case(SHAKE, "--out", out)
        h = table(out / "history.csv")
        frames = frames_of(out)
        times, last = numpy.array([frame[0] for frame in frames]), frames[-1]
        moved, velocity = last[2]["displacement"], last[2]["velocity"]
        for name, seen, interval in (("frames", times, 5e-4), ("history", h["time_s"], 2e-5)):
            with self.subTest(what=name):
                self.assertEqual(seen[0], 0)
                self.assertEqual(seen[-1], result["time"])
                wanted = interval * numpy.arange(math.floor(result["time"] / interval) + 1)
                self.assertEqual(len(seen), len(wanted) + (seen[-1] - wanted[-1] > result["time_step"] / 2))
                self.assertLessEqual(numpy.abs(seen[:len(wanted)] - wanted).max(), 0.5001 * result["time_step"])
        self.assertEqual(last[1], result["steps"])
        discs = table(out / "discs.csv")
        self.assertTrue(numpy.array_equal(moved[:, 0], discs["ux_m"]))
        self.assertEqual(velocity.shape, (len(discs["ux_m"]), 3))
        self.assertEqual(h["kinetic_J_per_m"][-1], result["energy"]["kinetic"])

    @needs_vtk
    def test_contact_forces_in_frames_add_up_to_mass_times_acceleration(self):
        discs = [(0, 0), (2 * RADIUS, 0), (RADIUS, math.sqrt(3) * RADIUS)]
        for motion in ("small", "finite"):
            with self.subTest(motion=motion):
                case = self.write_case(discs, [[0, 1, 0, 0], [0, 2, 0, 0], [1, 2, 0, 0]], f"""
[springs]
kN = {KN}
kT = {0.4 * KN}
[run]
duration = 2e-4
motion = "{motion}"
gravity = [0.0, -9.81]
[[wall]]
name = "floor"
point = [0.0, {-0.99 * RADIUS}]
normal = [0.1, 1.0]
kN = {KN}
[output]
frame_interval = 1e-30
""")
                out = self.folder / motion
                step = self.run_case(case, "--out", out, "--set", "output.files=['csv', 'vtk']")["time_step"]
                frames = frames_of(out)
                self.assertGreater(len(frames), 10)
                pushed, u = 0, [discs["displacement"][:, :2] for _, _, discs, _ in frames]
                for k in range(1, len(frames) - 1):
                    contacts = frames[k][3]
                    pushed += (contacts["j"] == -1).sum()
                    found = sums_of_forces(contacts, 3) + MASS * numpy.array([0, -9.81])
                    self.check_near(found, MASS * (u[k + 1] - 2 * u[k] + u[k - 1]) / step**2, 1e-7)
                self.assertGreater(pushed, 0)
                state = poly_data(out / "state_discs.vtp")
                for name in ("displacement", "rotation", "radius"):
                    self.assertTrue(numpy.array_equal(state[name], frames[-1][2][name]), name)
                if motion == "small":
                    state, last = poly_data(out / "state_contacts.vtp"), frames[-1][3]
                    for name in ("force", "normal_force", "tangential_force", "contact_point"):
                        self.assertTrue(numpy.array_equal(state[name], last[name][:3]), name)
        self.run_case(case, "--out", self.folder / "bare", "--set", "output.frame_contacts=false")
        self.assertEqual({name.split("_")[0] for name in frame_files(self.folder / "bare")}, {"frames.pvd", "frames/discs"})

    def test_an_interval_shorter_than_a_step_is_every_step(self):
        out = self.folder / "out"
        result = self.run_case(SHAKE, "--out", out, "--set", "run.duration=1e-3",
                               "--set", "output.probe_interval=1e-30", "--set", "output.frame_interval=1e-30")
        self.assertEqual(list(table(out / "history.csv")["step"]), list(range(result["steps"] + 1)))
        self.assertIn("at every step", result["report"])

    def test_probes_without_an_interval_are_pointed_at(self):
        case = self.folder / "silent.toml"
        case.write_text(SHAKE.read_text().replace("probe_interval", "# probe_interval"))
        self.assertRegex(self.check_done(equidem("run", case, "--dry-run")).stdout, "probes +not recorded")

    def test_nothing_is_overwritten_unasked(self):
        out = self.folder / "out"
        short = ("--out", out, "--set", "run.duration=1e-3")
        self.run_case(SHAKE, *short)
        names = list(files_of(out))
        for kept in ("result.json", "discs.csv", "frames.pvd", "history.csv", "run.checkpoint.h5"):
            shutil.rmtree(out)
            out.mkdir()
            (out / kept).write_text("mine")
            with self.subTest(file=kept):
                self.check_error(equidem("run", SHAKE, *short), 2, kept, "exists already", "--overwrite")
                self.assertEqual((out / kept).read_text(), "mine")
        self.run_case(SHAKE, *short, "--overwrite")
        self.assertEqual(list(files_of(out)), names)

    def test_the_echoed_case_repeats_the_run(self):
        out = self.folder / "out"
        first = self.run_case(CORNER, "--out", out)
        self.assertEqual(self.run_case(out / "case.toml")["energy"], first["energy"])

    def test_contacts_that_hardly_deform_are_questioned(self):
        for options in ((REST,), (PULSE, "--set", "run.duration=1e-4")):
            report = self.run_case(*options)["report"]
            self.assertIn("contacts change by at most", report)
            self.assertNotIn("other units", report)
        self.assertIn("other units", self.run_case(REST, "--set", "assembly.radius=5.0", "--set", "test.stress=1.0")["report"])

    def test_a_run_that_is_interrupted_names_the_way_to_go_on(self):
        long = ("run", PULSE, "--set", "run.duration=1000", "--set", "output.frame_interval=none", "--set",
                "output.probe_interval=none")
        self.assertIn("With --out DIR", self.interrupt(*long, after=0.3)[1])
        out = self.folder / "out"
        stderr = self.interrupt(*long, "--out", out, when=lambda: (out / "run.checkpoint.h5").exists() or out.exists(),
                                after=0.5)[1]
        self.assertRegex(stderr, r"\d+ of \d+ steps are done\)\. Run the same command with --resume")

    def test_dry_run_states_the_work_and_makes_no_file(self):
        out = self.folder / "out"
        size = self.run_case(SHAKE, "--dry-run", "--out", out)
        self.assertEqual((size["status"], size["steps"]), ("dry_run", self.run_case(SHAKE)["steps"]))
        self.assertGreater(size["estimated_seconds"], 0)
        self.assertRegex(size["report"], r"steps +3 \d\d\d, about ")
        self.assertFalse(out.exists())

    def test_examples_of_the_help_are_there(self):
        examples = re.findall(r"data/cases/(\S+\.toml)", self.check_done(equidem("run", "--help")).stdout)
        self.assertTrue(examples)
        for example in examples:
            self.assertTrue((CASES / example).exists(), example)


if __name__ == "__main__":
    unittest.main()
