#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Standing waves of equidem run: run_waves.py PROGRAM SOURCE_FOLDER [unittest options]."""
import math
import re
import unittest

from motion import KN, RADIUS, RunTest
from program import equidem


class StandingWaves(RunTest):
    def case_of(self, velocity, columns=48, periods=3.2, probe="wavelength = {length}"):
        """The halves of a periodic hexagonal cell that start against each other; and the speed of its moduli."""
        length, height, density = 2 * RADIUS * columns, 4 * math.sqrt(3) * RADIUS, 2650.0
        shear = math.sqrt(3) / 4 * KN * 1.5  # kT = kN/2: G = sqrt3/4 (kN + kT), K = sqrt3/2 kN
        bulk = math.sqrt(3) / 2 * KN
        solid = math.pi / (2 * math.sqrt(3))
        speed = math.sqrt((bulk + shear if velocity[0] else shear) / (solid * density))
        halves = "".join(f"""[[group]]
name = "{name}"
box = [{west}, -1.0, {west + length / 2}, {2 * height}]
[[velocity]]
group = "{name}"
velocity = [{sign * velocity[0]}, {sign * velocity[1]}]
""" for name, west, sign in (("west", -RADIUS / 2, 1), ("east", length / 2 - RADIUS / 2, -1)))
        case = self.folder / "wave.toml"
        case.write_text(f"""schema = "equidem/1"
[assembly]
kind = "hexagonal"
periodic = true
columns = {columns}
rows = 4
radius = {RADIUS}
density = {density}
[springs]
kN = {KN}
kT = {0.5 * KN}
[run]
duration = {periods * length / speed}
{halves}[[probe]]
name = "west"
group = "west"
{probe.format(length=length)}
[output]
probe_interval = {length / speed / 400}
""")
        return case, speed

    def test_a_standing_wave_has_the_speed_of_the_moduli(self):
        for velocity in ((1e-3, 0.0), (0.0, 1e-3)):
            with self.subTest(velocity=velocity):
                case, speed = self.case_of(velocity, columns=96)
                wave = self.run_case(case)["waves"]["west"]
                self.assertEqual(wave["passages"], 6)
                self.assertAlmostEqual(wave["speed"] / speed, 1, delta=1.5e-3)  # 2e-4 by the dispersion of its length
                self.assertAlmostEqual(wave["theory"]["pressure" if velocity[0] else "shear"] / speed, 1, places=9)
                self.assertAlmostEqual(wave["speed_over_theory"] * speed / wave["speed"], 1, places=9)

    def test_a_wave_that_is_resumed_has_the_same_speed(self):
        case, _ = self.case_of((1e-3, 0.0))
        whole = self.run_case(case)["waves"]
        duration = float(re.search(r"duration = (.*)", case.read_text()).group(1))
        step = self.run_case(case, "--dry-run")["time_step"]
        self.run_case(case, "--out", self.folder / "out", "--set", f"run.duration={duration / 2}",
                      "--set", f"run.time_step={step!r}")
        self.assertEqual(self.run_case(case, "--out", self.folder / "out", "--resume")["waves"], whole)

    def test_a_run_too_short_for_a_period_says_so(self):
        case, _ = self.case_of((1e-3, 0.0), periods=0.5)
        done = self.run_case(case)
        self.assertIsNone(done["waves"]["west"]["speed"])
        self.assertIn("fewer than two times", done["report"])

    def test_only_a_length_is_a_wavelength(self):
        case, _ = self.case_of((1e-3, 0.0), probe="wavelength = 0.0")
        self.check_error(equidem("run", case), 2, "wavelength", "> 0")
        case, _ = self.case_of((1e-3, 0.0), probe="wavelength = 5.0")
        self.check_error(equidem("run", case), 2, "probe.0.wavelength", "does not stand in a periodic cell", "width or the height")

    def test_a_wave_without_an_interval_of_its_probe_says_so(self):
        case, _ = self.case_of((1e-3, 0.0))
        report = self.run_case(case, "--set", "output.probe_interval=none")["report"]
        self.assertRegex(report, r"wave west +not measured: \[output\] has no probe_interval")


if __name__ == "__main__":
    unittest.main()
