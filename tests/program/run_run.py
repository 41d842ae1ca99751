# SPDX-License-Identifier: GPL-3.0-or-later
"""equidem run of bonded discs, as a user runs it: run_run.py PROGRAM SOURCE_FOLDER [unittest options]."""
import math
import re
import unittest

import numpy

from motion import (CORNER, KN, MASS, PULSE, RADIUS, REST, SHAKE, RunTest, frames_of, needs_vtk, poly_data, sums_of_forces,
                    table)
from program import CASES, NO_PICTURE, equidem, files_of, flat
from scenes import output, probe


class StaticAgreement(RunTest):
    def displacements(self, verb, case, *options):
        out = self.folder / verb
        self.done(verb, case, "--threads", 1, "--out", out, "--overwrite", "output.files=['csv']", *options)
        discs = table(out / "discs.csv")
        return numpy.array([discs["ux_m"], discs["uy_m"], RADIUS * discs["rotation_rad"]])

    def test_a_run_ends_at_the_solution_of_the_matrix(self):
        springs, small = self.folder / "springs", ("assembly.columns=11", "assembly.rows=11")
        self.done("calibrate", CASES / "calibrate_lattice.toml", "--out", springs)
        text = REST.read_text()
        calibrated = self.write(re.sub(r"\[springs\]\nkN.*\nkT.*\n", "", text).replace(
            'schema = "equidem/1"', f'schema = "equidem/1"\nsprings = "{springs / "springs.toml"}"'), "calibrated.toml")
        damped = self.write(text.replace("until_rest = 1e-10", "duration = 0.03\n[run.damping]\nlocal = 0.5"), "damped.toml")
        far = "run.until_rest=1e-12"
        for case, *options in ((REST, far, "springs.kT=0.5e9"), (REST, far, "springs.kT=0"),
                               (REST, far, "effects.rotation=restrained"),
                               (CASES / "delaunay_tension.toml", far, "assembly.density=2650", "assembly.discs=400"),
                               (calibrated, far), (damped, *small)):
            with self.subTest(case=case.name, options=options):
                self.check_near(self.displacements("run", case, *options), self.displacements("solve", case, *options), 1e-9)


class Motion(RunTest):
    def test_free_fall(self):
        case = self.bonded_case([(0, 1)], [], """[springs]
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
""" + probe('name = "disc"\ngroup = "d0"\nquantities = ["displacement", "velocity"]\n') + output(1e-3))
        for integrator in ("leapfrog", "velocity_verlet", "fourth_order"):
            with self.subTest(integrator=integrator):
                h = self.history(case, f"run.integrator={integrator}")
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
            velocities = "".join(f'[[velocity]]\ngroup = "d{j}"\nvelocity = [{v!r}, 0.0]\n' for j, v in enumerate(shape))
            probes = "".join(probe(f'name = "d{j}"\ngroup = "d{j}"\n') for j in range(n))
            case = self.bonded_case([(2 * RADIUS * j, 0) for j in range(n)], [[j, j + 1, 0, 0] for j in range(n - 1)],
                                    f"[springs]\nkN = {KN}\nkT = 0.0\n[run]\nduration = 1e-3\n{velocities}{probes}{output(1e-9)}")
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
                h = self.history(case, "run.duration=0.01")
                lacks = sum(sign * h[f"{name}_J_per_m"] for name, sign in sums.items())
                size = max(numpy.abs(h[f"{name}_J_per_m"]).max() for name in sums)
                self.assertLessEqual(numpy.abs(lacks - h["error_J_per_m"]).max(), 1e-14 * size)
                # Exact for small motions; of the second order in the step for finite ones.
                self.assertLess(numpy.abs(lacks).max(), (1e-2 if case == CORNER else 1e-12) * size)

    def test_negative_kT_grows_as_predicted(self):
        case = self.write("""[assembly]
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
""" + probe('name = "all"\ngroup = "all"\nquantities = ["rotation"]\n') + output(1e-9))
        # All discs turn alike: rate² = 24 |kT|/m; in time theta = (spin/rate) sinh(rate t) but for the step squared.
        rate = math.sqrt(24 * 1e8 / MASS)
        h = self.history(case)
        self.check_near(h["all_rotation_rad"], 1e-6 / rate * numpy.sinh(rate * h["time_s"]), 1e-3)
        predicted = float(re.search(r"Motions grow at the rate (\S+) 1/s", self.report("run", case, "--dry-run"))[1])
        self.assertAlmostEqual(predicted / rate, 1, delta=1e-5)
        self.check_error(equidem("run", case, "run.allow_unstable_step=false"), 2, "kT is negative", "rate")
        self.check_error(equidem("run", case, "run.duration=1e-2"), 1, "ran away", "kT is negative", "step ")


class Output(RunTest):
    def test_steps_times_and_energies_are_those_of_the_run(self):
        result = self.run_case(PULSE)
        self.assertLessEqual({"kinetic", "elastic", "potential", "dissipated", "input", "error"}, set(result["energy"]))
        self.assertEqual(result["status"], "done")
        self.assertEqual(result["steps"], math.ceil(2e-3 / result["time_step"]))
        self.assertAlmostEqual(result["time"] / (result["steps"] * result["time_step"]), 1, delta=1e-12)
        self.assertLess(result["time_step"], result["critical_time_step"])
        self.assertLess(abs(result["energy"]["relative_error"]), 1e-12)
        rest = self.run_case(REST)
        self.assertEqual((rest["status"], rest["discs"]), ("at_rest", 431))
        self.assertLess(rest["relative_unbalanced_force"], 1e-10)

    def test_the_report_states_step_limit_effects_and_balance(self):
        for case, fraction in ((PULSE, 0.8), (SHAKE, 0.8), (CORNER, 0.4)):
            report = self.done("run", case, "--threads", 1).stdout
            places = [report.find(word) for word in ("assembly", "springs", "effects", "motions", "integrator", "time step", "memory",
                                                     "steps  ", "energy", "balance", "times")]
            self.assertEqual(places, sorted(places), report)
            self.assertNotIn(-1, places, report)
            self.assertLessEqual(max(map(len, report.splitlines())), 112, report)
            self.assertRegex(report, rf"time step +\S+ s, {fraction} of the (critical|guaranteed) step \S+ s")
            self.assertNotIn("compare with a shorter step", report)
            end, most = map(float, re.search(r"error (\S+) of the largest term of the run at its end, at most (\S+) on the way",
                                             flat(report)).groups())
            self.assertLessEqual(end, most)
        self.assertIn("compare with a shorter step", self.report("run", PULSE, "run.integrator=thesis", "run.damping.contact=0.1"))

    def test_the_order_is_that_of_the_dampers_too(self):
        viscous = self.write(PULSE.read_text() + '[viscoelastic]\nnormal = "kelvin_voigt"\ntauN = 1e-7\n')
        for case, option, order in ((PULSE, "run.damping.mass=1.0", "2"), (PULSE, "run.damping.contact=0.1", "1"),
                                    (PULSE, "run.damping.local=0.1", "1"), (PULSE, "run.damping.stiffness=1e-7", "1"),
                                    (viscous, "title=v", "1 (dampers act half a step late)")):
            self.assertIn(f"integrator leapfrog, order {order}", self.report("run", case, "--dry-run", option))

    def test_what_a_run_does_not_record_or_move_is_told(self):
        schedules = "schedules as they are at t = 0"
        self.assertIn(schedules, self.report("run", SHAKE, "run.duration=none", "run.until_rest=1e-6"))
        self.assertNotIn(schedules, self.report("run", REST))
        silent = self.write(SHAKE.read_text().replace("probe_interval", "# probe_interval"))
        self.assertIn("probes not recorded", self.report("run", silent, "--dry-run"))

    def test_an_interval_far_longer_than_the_run_or_shorter_than_a_step(self):
        out = self.folder / "out"
        self.assertEqual(self.run_case(PULSE, "run.duration=1e-300", "--out", out)["steps"], 1)
        self.assertEqual(list(table(out / "history.csv")["step"]), [0, 1])
        result = self.run_case(SHAKE, "--out", out, "--overwrite", "run.duration=1e-3", "output.probe_interval=1e-30",
                               "output.frame_interval=1e-30")
        self.assertEqual(list(table(out / "history.csv")["step"]), list(range(result["steps"] + 1)))
        self.assertIn("at every step", result["report"])

    @needs_vtk
    def test_frames_and_histories_follow_their_schedules(self):
        out = self.folder / "out"
        result = self.run_case(SHAKE, "--out", out)
        h, frames = table(out / "history.csv"), frames_of(out)
        times, last = numpy.array([frame[0] for frame in frames]), frames[-1]
        for name, seen, interval in (("frames", times, 5e-4), ("history", h["time_s"], 2e-5)):
            with self.subTest(what=name):
                self.assertEqual((seen[0], seen[-1]), (0, result["time"]))
                wanted = interval * numpy.arange(math.floor(result["time"] / interval) + 1)
                self.assertEqual(len(seen), len(wanted) + (seen[-1] - wanted[-1] > result["time_step"] / 2))
                self.assertLessEqual(numpy.abs(seen[:len(wanted)] - wanted).max(), 0.5001 * result["time_step"])
        self.assertEqual(last[1], result["steps"])
        discs = table(out / "discs.csv")
        self.assertTrue(numpy.array_equal(last[2]["displacement"][:, 0], discs["ux_m"]))
        self.assertEqual(last[2]["velocity"].shape, (len(discs["ux_m"]), 3))
        self.assertEqual(h["kinetic_J_per_m"][-1], result["energy"]["kinetic"])

    @needs_vtk
    def test_contact_forces_in_frames_add_up_to_mass_times_acceleration(self):
        discs = [(0, 0), (2 * RADIUS, 0), (RADIUS, math.sqrt(3) * RADIUS)]
        for motion in ("small", "finite"):
            with self.subTest(motion=motion):
                case = self.bonded_case(discs, [[0, 1, 0, 0], [0, 2, 0, 0], [1, 2, 0, 0]], f"""
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
                step = self.run_case(case, "--out", out, NO_PICTURE)["time_step"]
                frames = frames_of(out)
                self.assertGreater(len(frames), 10)
                pushed, u = 0, [moved["displacement"][:, :2] for _, _, moved, _ in frames]
                for k in range(1, len(frames) - 1):
                    contacts = frames[k][3]
                    pushed += (contacts["j"] == -1).sum()
                    found = sums_of_forces(contacts, 3) + MASS * numpy.array([0, -9.81])
                    self.check_near(found, MASS * (u[k + 1] - 2 * u[k] + u[k - 1]) / step**2, 1e-7)
                self.assertGreater(pushed, 0)
                state, last = (poly_data(out / f"state_{kind}.vtp") for kind in ("discs", "contacts")), frames[-1]
                states = zip(state, last[2:], (("displacement", "rotation", "radius"),
                                               ("force", "normal_force", "tangential_force", "contact_point")
                                               if motion == "small" else ()))
                for found, shown, names in states:
                    for name in names:
                        self.assertTrue(numpy.array_equal(found[name], shown[name][:len(found[name])]), name)
        self.run_case(case, "--out", self.folder / "bare", "output.frame_contacts=false")
        self.assertEqual({name.split("_")[0] for name in files_of(self.folder / "bare" / "frames")}, {"discs"})

    def test_contacts_that_hardly_deform_are_questioned(self):
        for case, options, told in ((REST, (), False), (PULSE, ("run.duration=1e-4",), False),
                                    (REST, ("assembly.radius=5.0", "test.stress=1.0"), True)):
            report = self.run_case(case, *options)["report"]
            self.assertIn("contacts change by at most", report)
            self.assertEqual("other units" in report, told)

    def test_a_run_that_is_interrupted_names_the_way_to_go_on(self):
        long, out = ("run", PULSE, "run.duration=1000", "output.frame_interval=none",
                     "output.probe_interval=none"), self.folder / "out"
        self.assertIn("With --out DIR", self.interrupt(*long, after=0.3)[1])
        stderr = self.interrupt(*long, "--out", out, when=out.exists, after=0.5)[1]
        self.assertRegex(stderr, r"\d+ of \d+ steps are done\)\. Run the same command with --resume")


class Refusals(RunTest):
    def refuse(self, case, *given):
        """Of each: assignments with spaces between them, and words of the sentence."""
        self.check_errors(*((tuple(options.split(" ")), *words) for options, *words in given), before=("run", case))

    def test_numbers_out_of_range_and_unknown_words(self):
        self.refuse(PULSE, ("run.duration=0", "run.duration", "> 0"), ("run.duration=-1", "run.duration", "> 0"),
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
                    ("probe.0.group=nobody", "no group 'nobody'"), ("output.frame_interval=0", "> 0"),
                    ("schedule.0.times=[1e-4,1.001e-4,1.002e-4]", "run_pulse.toml:",
                     "an event at 0.0001001 s that steps of", "100 %"))
        self.refuse(CORNER, ("schedule.0.end=-1", "Put the end after the start"), ("wall.0.kN=0", "> 0"),
                    ("wall.0.normal=[0,0]", "is zero"), ("wall.1.point=[0.02,0]", "behind wall 'side'"),
                    ("wall.1.normal=[-0.1,-1.0] wall.1.point=[0.0,-0.05]", "wall"), ("assembly.periodic=true", "periodic"))
        self.refuse(SHAKE, ("schedule.0.frequency=1e6", "support.0.schedule", "miss"))
        self.assertRegex(self.report("run", SHAKE, "--dry-run", "schedule.0.frequency=25000"),
                         r"Of the schedule of support 0 steps miss up to \d+ % of its range")
        self.assertNotIn("steps miss", self.report("run", SHAKE, "--dry-run"))

    def test_what_is_missing_or_given_twice_is_named(self):
        pulse, shake, corner = (case.read_text() for case in (PULSE, SHAKE, CORNER))
        for text, *words in (
                (re.sub(r"density = .*\n", "", pulse), "density is missing", "kg/m³"),
                (re.sub(r"duration = .*\n", "", pulse), "neither duration nor until_rest"),
                ((CASES / "abe1996_fig6.toml").read_text(), "the case has no [run]"),
                (shake + '\n[[support]]\ngroup = "bottom_left"\nux = 2.0e-5\n', "case.toml:",
                 "prescribes ux of disc 0 a second time"),
                (corner + '\n[[velocity]]\ngroup = "left"\nvelocity = [1.0, 0.0]\n', "case.toml:", "two velocities"),
                (shake + '\n[[velocity]]\ngroup = "bottom_left"\nvelocity = [1.0, 0.0]\n', "case.toml:", "its ux is prescribed"),
                (corner + '\n[[wall]]\nname = "right"\npoint = [0.2, 0.0]\nnormal = [-1.0, 0.0]\nkN = 1e8\ndisplacement = 0.25\n'
                 'schedule = "approach"\n', "case.toml:", "'side'", "'right'", "cross at 0.02 s")):
            with self.subTest(words=words):
                self.refused(text, *words)
        spun = self.write(corner.replace("velocity = [", "spin = 1.0\nvelocity = ["))
        self.done("run", spun, "--dry-run")
        self.refuse(spun, ("springs.kT=0", "case.toml:", "rotations are no unknowns"))

    def test_discs_that_pass_through_each_other(self):
        case = self.bonded_case([(0, 0), (2 * RADIUS, 0)], [[0, 1, 0, 0]], f"[springs]\nkN = {KN}\nkT = 0.0\n[run]\nduration = 1e-3\n"
                                'motion = "finite"\n[[velocity]]\ngroup = "d0"\nvelocity = [1e6, 0.0]\n')
        self.check_error(equidem("run", case), 1, "the bonded discs 0 and 1 move past each other", "at the start")
        self.check_error(equidem("run", case, "velocity.0.velocity=[3000,0]"), 1, "bonded discs 0 and 1")
        self.done("run", case, "velocity.0.velocity=[10,0]")

    def test_one_disc_and_no_contact(self):
        case = self.bonded_case([(0, 1)], [], "[springs]\nkN = 1e9\nkT = 0.0\n[run]\nuntil_rest = 1e-9\nmotion = \"finite\"\n"
                                'gravity = [0.0, -9.81]\n[[wall]]\nname = "floor"\npoint = [0.0, 0.9]\nnormal = [0.0, 1.0]\nkN = 1e5\n')
        report = self.report("run", case)
        for words in ("1 disc, 0 contacts", "no normal springs: there are no contacts", "rest at rest: "):
            self.assertIn(words, report)
        self.check_error(equidem("run", case, "run.gravity=[1.0,0.0]"), 1, "not at rest", "no contact and no wall carries")

    def test_a_step_past_the_limit(self):
        critical = self.run_case(PULSE, "run.time_step=1e-6", "run.duration=0.01")["critical_time_step"]
        self.refuse(PULSE, (f"run.time_step={1.001 * critical}", "past the limit", f"{critical:.6g} s", "smaller step"))
        self.run_case(PULSE, f"run.time_step={0.999 * critical}")
        for ratio in (1.02, 1.5, 5.0):
            done = equidem("run", PULSE, "run.duration=0.2", "run.allow_unstable_step=true", f"run.time_step={ratio * critical}",
                           "schedule.0.times=[0,1e-3,2e-3]")
            with self.subTest(ratio=ratio):
                self.check_error(done, 1, "disc ", "step ", f"the time step is {ratio:.4g} times the critical one",
                                 "Take a step below")


if __name__ == "__main__":
    unittest.main()
