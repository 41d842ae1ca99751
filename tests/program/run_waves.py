# SPDX-License-Identifier: GPL-3.0-or-later
"""Standing waves of equidem run: run_waves.py PROGRAM SOURCE_FOLDER [unittest options]."""
import math
import unittest

from motion import KN, RADIUS, RunTest
from scenes import output

LONG, ACROSS = (1e-3, 0.0), (0.0, 1e-3)


def standing_wave(test, velocity=LONG, columns=48, periods=3.2, probe="wavelength = {length}"):
    """The halves of a periodic hexagonal cell that start against each other; the duration; and the speed of its moduli."""
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
    duration = periods * length / speed
    case = test.write(f"""[assembly]
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
duration = {duration}
{halves}[[probe]]
name = "west"
group = "west"
{probe.format(length=length)}
""" + output(length / speed / 400), "wave.toml")
    return case, duration, speed


class StandingWaves(RunTest):
    def test_a_standing_wave_has_the_speed_of_the_moduli(self):
        for velocity in (LONG, ACROSS):
            with self.subTest(velocity=velocity):
                case, _, speed = standing_wave(self, velocity, columns=96)
                wave = self.run_case(case)["waves"]["west"]
                self.assertEqual(wave["passages"], 6)
                self.assertAlmostEqual(wave["speed"] / speed, 1, delta=1.5e-3)  # 2e-4 by the dispersion of its length
                self.assertAlmostEqual(wave["theory"]["pressure" if velocity[0] else "shear"] / speed, 1, places=9)
                self.assertAlmostEqual(wave["speed_over_theory"] * speed / wave["speed"], 1, places=9)

    def test_a_wave_that_is_not_measured_says_why(self):
        done = self.run_case(standing_wave(self, periods=0.5)[0])
        self.assertIsNone(done["waves"]["west"]["speed"])
        self.assertIn("fewer than two times", done["report"])
        report = self.run_case(standing_wave(self)[0], "output.probe_interval=none")["report"]
        self.assertRegex(report, r"wave west +not measured: \[output\] has no probe_interval")

    def test_only_a_length_is_a_wavelength(self):
        for length, *words in (("0.0", "wavelength", "> 0"),
                               ("5.0", "probe.0.wavelength", "does not stand in a periodic cell", "width or the height")):
            case = standing_wave(self, probe=f"wavelength = {length}")[0]
            self.check_errors((("run", case), *words))


if __name__ == "__main__":
    unittest.main()
