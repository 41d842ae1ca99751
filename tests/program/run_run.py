#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""equidem run, as a user runs it: run_run.py PROGRAM SOURCE_FOLDER [unittest options]."""
import math
import re
import unittest

import h5py
import numpy

from motion import CORNER, KN, MASS, PULSE, RADIUS, REST, SHAKE, RunTest, table
from program import CASES, equidem


class StaticAgreement(RunTest):
    def displacements(self, verb, case, *options):
        out = self.folder / verb
        self.check_done(equidem(verb, case, "--threads", 1, "--out", out, "--overwrite", "--set", "output.vtk=false",
                                "--set", "output.picture=false", *options))
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
            end, most = (float(x) for x in re.search(r"lacks (\S+) of the largest term of the run\s+at its end, at most "
                                                     r"(\S+) on the way", report).groups())
            self.assertLessEqual(end, most)

    def test_the_order_is_that_of_the_dampers_too(self):
        for option, order in (("run.damping.mass=1.0", 2), ("run.damping.contact=0.1", 1), ("run.damping.local=0.1", 1),
                              ("run.damping.stiffness=1e-7", 1)):
            report = self.check_done(equidem("run", PULSE, "--dry-run", "--set", option)).stdout
            self.assertRegex(report, rf"integrator +leapfrog, order {order}")

    def test_a_run_to_rest_says_that_schedules_stand_still(self):
        for case, told in ((SHAKE, True), (REST, False)):
            report = self.check_done(equidem("run", case, "--set", "run.duration=none", "--set", "run.until_rest=1e-6")
                                     if told else equidem("run", case)).stdout
            self.assertEqual(bool(re.search(r"schedules +as they are at t = 0", report)), told)

    def test_an_interval_far_longer_than_the_run(self):
        out = self.folder / "out"
        self.assertEqual(self.run_case(PULSE, "--set", "run.duration=1e-300", "--out", out)["steps"], 1)
        self.assertEqual(list(table(out / "history.csv")["step"]), [0, 1])

    def test_frames_and_histories_follow_their_schedules(self):
        out = self.folder / "out"
        result = self.run_case(SHAKE, "--out", out)
        h = table(out / "history.csv")
        with h5py.File(out / "frames.h5", "r") as file:
            count = int(file["frames"][0])
            times, steps = file["time"][:count], file["step"][:count]
            moved, velocity = file["displacement"][count - 1], file["velocity"][count - 1]
        for name, seen, interval in (("frames", times, 5e-4), ("history", h["time_s"], 2e-5)):
            with self.subTest(what=name):
                self.assertEqual(seen[0], 0)
                self.assertEqual(seen[-1], result["time"])
                wanted = interval * numpy.arange(math.floor(result["time"] / interval) + 1)
                self.assertEqual(len(seen), len(wanted) + (seen[-1] - wanted[-1] > result["time_step"] / 2))
                self.assertLessEqual(numpy.abs(seen[:len(wanted)] - wanted).max(), 0.5001 * result["time_step"])
        self.assertEqual(steps[-1], result["steps"])
        discs = table(out / "discs.csv")
        self.assertTrue(numpy.array_equal(moved[:, 0], discs["ux_m"]))
        self.assertEqual(velocity.shape, (len(discs["ux_m"]), 3))
        self.assertEqual(h["kinetic_J_per_m"][-1], result["energy"]["kinetic"])

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
        names = sorted(path.name for path in out.iterdir())
        for kept in ("result.json", "discs.csv", "frames.h5", "history.csv", "run.checkpoint.h5"):
            for path in out.iterdir():
                path.unlink()
            (out / kept).write_text("mine")
            with self.subTest(file=kept):
                self.check_error(equidem("run", SHAKE, *short), 2, kept, "exists already", "--overwrite")
                self.assertEqual((out / kept).read_text(), "mine")
        self.run_case(SHAKE, *short, "--overwrite")
        self.assertEqual(sorted(path.name for path in out.iterdir()), names)

    def test_the_echoed_case_repeats_the_run(self):
        out = self.folder / "out"
        first = self.run_case(CORNER, "--out", out)
        self.assertEqual(self.run_case(out / "case.toml")["energy"], first["energy"])

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


class Refusals(RunTest):
    def refuse(self, case, option, *words, code=2):
        options = [word for one in option.split(" ") for word in ("--set", one)]
        with self.subTest(option=option):
            self.check_error(equidem("run", case, *options), code, *words)

    def test_numbers_out_of_range_and_unknown_words(self):
        for option, *words in (("run.duration=0", "run.duration", "> 0"), ("run.duration=-1", "run.duration", "> 0"),
                               ("run.time_step=0", "run.time_step", "> 0"), ("run.time_step=-1e-6", "> 0"),
                               ("run.time_step=1.0", "longer than the run"), ("run.time_step=nan", "finite"),
                               ("run.duration=1e30", "1e+15"), ("run.time_step=1e-300", "1e+15"),
                               ("run.integrator=euler", '"leapfrog"', '"fourth_order"'),
                               ("run.damping.viscous=1", "mass, stiffness, contact, local"),
                               ("run.damping.contact=-0.1", ">= 0"), ("run.damping.local=1", "< 1"),
                               ("run.damping.contact=0.1 run.damping.stiffness=1e-6", "stiffness and contact"),
                               ("run.damping.contact=0.1 run.damping.local=0.1", "Keep one", "run"),
                               ("run.integrator=fourth_order run.damping.contact=0.1", "fourth", "run_pulse.toml:"),
                               ("run.integrator=thesis", "no time step is stable"),
                               ("run.until_rest=1e-8", "duration and until_rest"),
                               ("run.step_fraction=1.5", "<= 1"), ("run.step_rule=guess", '"lanczos"'),
                               ("assembly.density=0", "density", "> 0"),
                               ("schedule.0.times=[0,2,1]", "ascend"), ("load.0.schedule=pull", '"push"'),
                               ("probe.0.group=nobody", "no group 'nobody'"), ("output.frame_interval=0", "> 0")):
            self.refuse(PULSE, option, *words)
        for option, *words in (("schedule.0.end=-1", "Put the end after the start"),
                               ("wall.0.kN=0", "> 0"), ("wall.0.normal=[0,0]", "is zero"),
                               ("wall.1.point=[0.02,0]", "behind wall 'side'"),
                               ("wall.1.normal=[-0.1,-1.0] wall.1.point=[0.0,-0.05]", "wall"),
                               ("assembly.periodic=true", "periodic")):
            self.refuse(CORNER, option, *words)

    def test_what_is_missing_is_named(self):
        for case, line, *words in ((PULSE, r"density = .*\n", "density is missing", "kg/m³"),
                                   (PULSE, r"duration = .*\n", "neither duration nor until_rest")):
            broken = self.folder / "broken.toml"
            broken.write_text(re.sub(line, "", case.read_text()))
            with self.subTest(words=words):
                self.check_error(equidem("run", broken), 2, *words)
        self.check_error(equidem("run", CASES / "abe1996_fig6.toml"), 2, "the case has no [run]")

    def test_motions_prescribed_twice(self):
        case = self.folder / "twice.toml"
        case.write_text(SHAKE.read_text() + '\n[[support]]\ngroup = "bottom_left"\nux = 2.0e-5\n')
        self.check_error(equidem("run", case), 2, "twice.toml:", "prescribes ux of disc 0 a second time")
        case.write_text(CORNER.read_text() + '\n[[velocity]]\ngroup = "left"\nvelocity = [1.0, 0.0]\n')
        self.check_error(equidem("run", case), 2, "twice.toml:", "two velocities")

    def test_walls_that_cross(self):
        case = self.folder / "walls.toml"
        case.write_text(CORNER.read_text() + '\n[[wall]]\nname = "right"\npoint = [0.2, 0.0]\nnormal = [-1.0, 0.0]\n'
                        'kN = 1e8\ndisplacement = 0.25\nschedule = "approach"\n')
        self.check_error(equidem("run", case), 2, "walls.toml:", "'side'", "'right'", "cross at 0.02 s")

    def test_events_that_steps_miss(self):
        for case, option, *words in ((PULSE, "schedule.0.times=[1e-4,1.001e-4,1.002e-4]", "run_pulse.toml:",
                                      "an event at 0.0001001 s that steps of", "100 %"),
                                     (SHAKE, "schedule.0.frequency=1e6", "support.0.schedule", "miss")):
            self.refuse(case, option, *words)
        told = self.check_done(equidem("run", SHAKE, "--dry-run", "--set", "schedule.0.frequency=25000")).stdout
        self.assertRegex(" ".join(told.split()), r"Of the schedule of support 0 steps miss up to \d+ % of its range")
        self.assertNotIn("steps miss", self.check_done(equidem("run", SHAKE, "--dry-run")).stdout)

    def test_velocities_that_would_be_dropped(self):
        case = self.folder / "dropped.toml"
        case.write_text(SHAKE.read_text() + '\n[[velocity]]\ngroup = "bottom_left"\nvelocity = [1.0, 0.0]\n')
        self.check_error(equidem("run", case), 2, "dropped.toml:", "its ux is prescribed")
        case.write_text(CORNER.read_text().replace("velocity = [", "spin = 1.0\nvelocity = ["))
        self.check_done(equidem("run", case, "--dry-run"))
        self.check_error(equidem("run", case, "--set", "springs.kT=0"), 2, "dropped.toml:", "rotations are no unknowns")

    def test_discs_that_pass_through_each_other(self):
        case = self.write_case([(0, 0), (2 * RADIUS, 0)], [[0, 1, 0, 0]], f"""[springs]
kN = {KN}
kT = 0.0
[run]
duration = 1e-3
motion = "finite"
[[velocity]]
group = "d0"
velocity = [1e6, 0.0]
""")
        self.refuse(case, "run.gravity=[0,0]", "the bonded discs 0 and 1 move past each other", "at the start", code=1)
        self.refuse(case, "velocity.0.velocity=[3000,0]", "bonded discs 0 and 1", code=1)
        self.check_done(equidem("run", case, "--set", "velocity.0.velocity=[10,0]"))

    def test_one_disc_and_no_contact(self):
        case = self.write_case([(0, 1)], [], """[springs]
kN = 1e9
kT = 0.0
[run]
until_rest = 1e-9
motion = "finite"
gravity = [0.0, -9.81]
[[wall]]
name = "floor"
point = [0.0, 0.9]
normal = [0.0, 1.0]
kN = 1e5
""")
        report = self.check_done(equidem("run", case)).stdout
        self.assertIn("1 disc, 0 contacts", report)
        self.assertRegex(report, "no normal springs: there are no contacts")
        self.assertRegex(report, "rest +at rest: ")
        self.refuse(case, "run.gravity=[1.0,0.0]", "not at rest", "no contact and no wall carries", code=1)

    def test_a_step_past_the_limit(self):
        result = self.run_case(PULSE, "--set", "run.time_step=1e-6", "--set", "run.duration=0.01")
        critical = result["critical_time_step"]
        self.refuse(PULSE, f"run.time_step={1.001 * critical}", "past the limit", f"{critical:.6g} s", "smaller step")
        self.run_case(PULSE, "--set", f"run.time_step={0.999 * critical}")
        for ratio in (1.02, 1.5, 5.0):
            done = equidem("run", PULSE, "--set", "run.duration=0.2", "--set", "run.allow_unstable_step=true",
                           "--set", f"run.time_step={ratio * critical}", "--set", "schedule.0.times=[0,1e-3,2e-3]")
            with self.subTest(ratio=ratio):
                self.check_error(done, 1, "disc ", "step ", f"the time step is {ratio:.4g} times the critical one",
                                 "Take a step below")


if __name__ == "__main__":
    unittest.main()
