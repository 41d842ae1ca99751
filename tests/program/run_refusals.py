#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""What equidem run refuses, as a user sees it: run_refusals.py PROGRAM SOURCE_FOLDER [unittest options]."""
import re
import unittest

from motion import CORNER, KN, PULSE, RADIUS, SHAKE, RunTest, table
from program import CASES, equidem


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
