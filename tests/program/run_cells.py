# SPDX-License-Identifier: GPL-3.0-or-later
"""Periodic cells of colliding bodies, as a user runs them: run_cells.py PROGRAM SOURCE_FOLDER [unittest options]."""
import unittest

import numpy

from motion import RunTest, table
from program import CASES, NO_PICTURE, equidem, flat
from scenes import APART, HEAD, LAW, loose_square, output, rows_of_discs, schedule, stage

SHEARED = CASES / "grains_sheared_cell.toml"
CELL = "[cell]\nwidth = 0.1\nheight = 0.1\n"
VERLET = '[run]\nintegrator = "velocity_verlet"\n'
SQUARE = HEAD + rows_of_discs(5, 0.02) + LAW
MISSED = "the stress of the cell never came within 1 % of the wanted one: yy"


def sheared_case(test):
    """The case of a sheared cell with 64 discs, in the folder of a test."""
    test.write(loose_square(8, 5), "small.csv")
    text = SHEARED.read_text()
    for old, new in (('"biaxial.csv"', '"small.csv"'), ("= 0.2 ", "= 0.076 "), ("height   = 0.2", "height   = 0.076"),
                     ("xy       = 2.0", "xy       = 10.0")):
        text = text.replace(old, new)
    return test.write(text)


def servo(stress, most, component="yy", more=""):
    return f"stress_{component} = {stress}\nmax_rate = {most}\n{more}"


class Cells(RunTest):
    def test_the_stress_is_held_and_the_work_is_that_of_the_stress(self):
        out = self.folder / "out"
        result = self.run_case(sheared_case(self), "--out", out, "run.duration=0.4", "output.probe_interval=1e-4", NO_PICTURE)
        held, = result["cell"]["servos"]
        self.assertEqual((held["component"], held["reached"], held["wanted"]), ("yy", True, -1e5))
        self.assertLess(held["mean_error"], 0.05)
        self.assertLess(abs(result["energy"]["relative_error"]), 3e-3)
        history = table(out / "history.csv")
        self.assertAlmostEqual(history["cell_width_m"][-1], 0.076, delta=1e-12)
        self.assertAlmostEqual(history["cell_height_m"][-1], 0.076 * numpy.exp(history["cell_strain_yy"][-1]), delta=1e-9)
        self.assertGreater(history["cell_strain_xy"][-1], 1)  # past its width
        self.assertTrue((abs(history["cell_shift_m"]) <= 0.038 * (1 + 1e-9)).all())
        late = history["cell_strain_xy"] > 0.3
        friction = history["cell_stress_xy_Pa"][late].mean() / -history["cell_stress_yy_Pa"][late].mean()
        self.assertTrue(0.15 < friction < 0.45, friction)
        self.assertAlmostEqual(history["cell_stress_yy_Pa"][late].mean(), -1e5, delta=5e3)  # as the mean error
        work = sum(numpy.trapz(history[f"cell_stress_{at}_Pa"][late] * history["cell_area_m2"][late],
                               history[f"cell_strain_{at}"][late])
                   for at in ("xy", "yy"))
        told = history["work_of_cell_J_per_m"][late]
        self.assertAlmostEqual(work / (told[-1] - told[0]), 1, delta=0.03)
        self.assertAlmostEqual(result["cell"]["stress_xy"], history["cell_stress_xy_Pa"][-1], delta=1e-6 * 1e5)

    def test_errors_of_a_stress_of_zero_are_no_shares_and_the_stress_told_is_that_of_the_cell(self):
        cell = self.run_case(sheared_case(self), "run.duration=0.2", "cell.servo.stress_xx=0.0", NO_PICTURE)["cell"]
        self.assertNotEqual(cell["stress_xx"], 0)
        for one in cell["servos"]:
            self.assertEqual(one["stress"], cell[f"stress_{one['component']}"])
            self.assertTrue(one["reached"] or one["wanted"] != 0)
            # whether a sample without lateral stress reaches the other one, depends on single contacts
            for key in ("overshoot", "mean_error") if one["reached"] else ():
                self.assertEqual(one[key] is None, one["wanted"] == 0, (one, key))

    def test_a_packing_with_periodic_sides_rests_in_a_cell_of_its_size(self):
        packed = self.folder / "packed"
        self.done("pack", CASES / "pack_jammed.toml", "packing.grains=60", "--out", packed, "--quiet")
        sides = "[cell]\nwidth = 0.5\nheight = 0.5\n"
        text = f'{HEAD}path = "{packed}/grains.csv"\n{LAW.replace("1.0e6", "1.0e8")}{sides}{VERLET}duration = 0.01\n'
        result = self.run_case(self.write(text), "--out", self.folder / "out", NO_PICTURE)
        self.assertGreater(result["cell"]["coordination_number"], 3.5)  # across the sides too
        self.assertLess(result["cell"]["stress_xx"], -1e3)
        self.assertLess(result["energy"]["kinetic"], 1e-3 * result["energy"]["elastic"])
        for wrong, words in ((text.replace("width = 0.5", "width = 0.6"), ("grains.csv:2", "width = 0.5 m", "[cell] has 0.6 m")),
                             (text.replace(sides, ""), ("grains.csv:1", "Add [cell]"))):
            self.refused(wrong, *words)

    def test_a_cell_with_a_servo_and_nothing_to_press_says_so(self):
        for stress, words in ((-1000.0, "or for longer"), (1000.0, "contacts carry no tension")):
            text = f"{HEAD}{APART}{LAW}{CELL}[cell.servo]\n{servo(stress, 0.01)}{VERLET}duration = 0.1\n"
            result = self.run_case(self.write(text))
            self.assertEqual((result["contacts"], result["cell"]["servos"][0]["reached"]), (0, False))
            warning = flat(result["report"]).split("WARNING")[1]
            self.assertIn(MISSED, warning)
            self.assertIn(words, warning)
        full = self.write(f"{SQUARE}{CELL}[cell.servo]\n{servo(-1000.0, 1e-5)}{VERLET}duration = 0.1\n")
        self.assertIn(MISSED, self.report("run", full))

    def test_a_cell_that_misses_its_stress_in_any_stage_is_told(self):
        stages = "".join(stage(name, time, "[stage.cell.servo]\n" + servo(-1000.0, rate))
                         for name, time, rate in (("slow", 0.01, 1e-5), ("fast", 0.5, 0.1), ("again", 0.01, 1e-9)))
        case, out = self.write(SQUARE + CELL + VERLET + stages), self.folder / "out"
        results = [self.run_case(case, "--out", out, NO_PICTURE)]
        results += [self.run_case(case, "--out", out, "--resume", NO_PICTURE) for _ in self.go_on_from(out, "slow")]
        for result in results:
            servos = result["cell"]["servos"]
            self.assertEqual([(one["stage"], one["component"], one["reached"]) for one in servos],
                             [("slow", "yy", False), ("fast", "yy", True), ("again", "yy", True)])
            self.assertEqual([one["overshoot"] is None for one in servos], [True, False, False])
            self.assertGreater(servos[0]["stress"], 0.5 * servos[0]["wanted"])
            self.assertIn(f"{MISSED} in the stage 'slow'; let it", flat(result["report"]))

    def test_a_stress_of_a_cell_that_a_stage_does_not_name_goes_on_in_its_schedule(self):
        text = HEAD + rows_of_discs(5, 0.02, 0.0101) + LAW + CELL + VERLET + "time_step = 2.0e-5\n" + \
            schedule("rise", "table", "times = [0.0, 0.06]\nvalues = [0.5, 1.0]\n")
        rising = "[stage.cell.servo]\n" + servo(-1000.0, 0.1, more='schedule = "rise"\n')
        across = "[stage.cell.servo]\n" + servo(-500.0, 0.1, "xx")
        wanted = []
        for number, stages in enumerate((stage("a", 0.05, rising), *(
                stage("a", 0.01, rising) + stage("b", 0.02, other) + stage("c", 0.02) for other in ("", across)))):
            servos = self.run_case(self.write(text + stages), "--out", self.folder / f"out{number}", NO_PICTURE)["cell"]["servos"]
            wanted.append([one["wanted"] for one in servos if one["component"] == "yy"][-1])
        self.assertLess(wanted[0], -900)
        for found in wanted[1:]:
            self.assertAlmostEqual(found, wanted[0], delta=1e-9)

    def test_a_cell_that_shears_past_many_periods_keeps_its_contacts_and_its_energy(self):
        draw = numpy.random.default_rng(2)
        discs = "".join(f"[[grain]]\nposition = [{0.0205 * (i + 0.5) + draw.uniform(-2e-4, 2e-4):.6f}, {0.0205 * (j + 0.5):.6f}]\n"
                        "radius = 0.01\n" for i in range(5) for j in range(5))
        text = HEAD + discs + LAW + CELL.replace("0.1", "0.1025") + "[cell.motion]\nxy = 40.0\n" + VERLET + "duration = 0.2\n"
        out = self.folder / "out"
        result = self.run_case(self.write(text + output(1e-3)), "--out", out, NO_PICTURE)
        history = table(out / "history.csv")
        self.assertAlmostEqual(history["cell_strain_xy"][-1], 8, delta=0.01)
        self.assertTrue((abs(history["cell_shift_m"]) <= 0.05125 * (1 + 1e-9)).all())
        self.assertGreater(numpy.sum(abs(numpy.diff(history["cell_shift_m"])) > 0.05), 5)  # it jumped by a period so often
        self.assertLess(abs(result["energy"]["relative_error"]), 5e-3)

    def test_a_cell_that_collapses_or_is_driven_too_fast_is_refused_by_what_does_it(self):
        for body, component, rate, code, *words in (
                (APART, "yy", -20.0, 1, "case.toml:", "cell: step", "has become"),
                (APART, "xy", 1e7, 1, "run.time_step: step 0: bodies of the periodic cell would pass through", "Use a step below"),
                (APART.replace("[0.05, 0.01]", "[0.05, 0.01]\nvelocity = [1e6, 0.0]"), "xy", 1.0, 2,
                 "cell: grain 1 of the periodic cell moves", "pass through others")):
            with self.subTest(words=words):
                self.refused(f"{HEAD}{body}{LAW}{CELL}[cell.motion]\n{component} = {rate}\n{VERLET}duration = 0.1\n",
                             *words, code=code)

    def test_periodic_cells_of_bodies_that_collide_are_not_exported(self):
        case = self.write(HEAD + APART + LAW + CELL + VERLET + "duration = 0.01\n")
        self.check_error(equidem("export", case, "--to", "lammps", "--out", self.folder / "model"), 2,
                         "periodic cells of bodies that collide")


if __name__ == "__main__":
    unittest.main()
