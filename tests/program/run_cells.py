#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Periodic cells of colliding bodies, as a user runs them: run_cells.py PROGRAM SOURCE_FOLDER [unittest options]."""
import random
import unittest

import numpy

from motion import RunTest, table
from program import CASES, equidem

SHEARED = CASES / "grains_sheared_cell.toml"
NO_PICTURE = ("--set", "output.files=['csv', 'vtk']")
DISCS = """schema = "equidem/1"
[grains]
density = 2500.0
[[grain]]
position = [0.02, 0.01]
radius = 0.01
[[grain]]
position = [0.05, 0.01]
radius = 0.01
[collisions]
law = "linear_dashpot"
stiffness = 1.0e6
restitution = 0.5
"""
CELL = '[cell]\nwidth = 0.1\nheight = 0.1\n'
RUN = '[run]\nduration = 0.01\nintegrator = "velocity_verlet"\n'
FLOOR = '[[wall]]\nname = "floor"\npoint = [0.0, -0.02]\nnormal = [0.0, 1.0]\n'


class CellTest(RunTest):
    def write(self, text, name="case.toml"):
        path = self.folder / name
        path.write_text(text)
        return path

    def small_case(self):
        """The case of a sheared cell with 64 discs."""
        random.seed(5)
        rows = [f"{0.0095 * (i + 0.5) + random.uniform(-4e-4, 4e-4):.7f},{0.0095 * (j + 0.5) + random.uniform(-4e-4, 4e-4):.7f},"
                f"{random.uniform(0.0035, 0.0042):.7f}" for i in range(8) for j in range(8)]
        self.write("x,y,radius\n" + "\n".join(rows) + "\n", "small.csv")
        text = SHEARED.read_text().replace('"biaxial.csv"', '"small.csv"').replace("= 0.2 ", "= 0.076 ")
        return self.write(text.replace("height   = 0.2", "height   = 0.076").replace("xy       = 2.0", "xy       = 10.0"))

    def test_the_stress_is_held_and_the_work_is_that_of_the_stress(self):
        out = self.folder / "out"
        result = self.run_case(self.small_case(), "--out", out, "--set", "run.duration=0.4",
                               "--set", "output.probe_interval=1e-4", *NO_PICTURE)
        servo, = result["cell"]["servos"]
        self.assertEqual((servo["component"], servo["reached"], servo["wanted"]), ("yy", True, -1e5))
        self.assertLess(servo["mean_error"], 0.05)
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
        area = history["cell_area_m2"][late]
        work = numpy.trapz(history["cell_stress_xy_Pa"][late] * area, history["cell_strain_xy"][late])
        work += numpy.trapz(history["cell_stress_yy_Pa"][late] * area, history["cell_strain_yy"][late])
        told = history["work_of_cell_J_per_m"][late]
        self.assertAlmostEqual(work / (told[-1] - told[0]), 1, delta=0.03)
        self.assertAlmostEqual(result["cell"]["stress_xy"], history["cell_stress_xy_Pa"][-1], delta=1e-6 * 1e5)

    def test_errors_of_a_stress_of_zero_are_no_shares_and_the_stress_told_is_that_of_the_cell(self):
        result = self.run_case(self.small_case(), "--set", "run.duration=0.2", "--set", "cell.servo.stress_xx=0.0",
                               *NO_PICTURE)
        cell = result["cell"]
        self.assertNotEqual(cell["stress_xx"], 0)
        for servo in cell["servos"]:
            self.assertEqual(servo["stress"], cell[f"stress_{servo['component']}"])
            self.assertTrue(servo["reached"] or servo["wanted"] != 0)
            # whether a sample without lateral stress reaches the other one, depends on single contacts
            for key in ("overshoot", "mean_error") if servo["reached"] else ():
                self.assertEqual(servo[key] is None, servo["wanted"] == 0, (servo, key))

    def test_a_run_that_was_cut_off_ends_with_the_same_rows(self):
        case, whole, parts = self.small_case(), self.folder / "whole", self.folder / "parts"
        short = ("--set", "run.steps_per_contact=none", "--set", "run.time_step=4e-6", *NO_PICTURE)
        self.run_case(case, "--out", whole, "--set", "run.duration=0.2", *short)
        self.run_case(case, "--out", parts, "--set", "run.duration=0.13", *short)
        self.run_case(case, "--out", parts, "--resume", "--set", "run.duration=0.2", *short)
        self.assertEqual((whole / "grains.csv").read_bytes(), (parts / "grains.csv").read_bytes())
        self.assertEqual((whole / "contacts.csv").read_bytes(), (parts / "contacts.csv").read_bytes())

    def test_a_packing_with_periodic_sides_rests_in_a_cell_of_its_size(self):
        packed = self.folder / "packed"
        pack = equidem("pack", CASES / "pack_jammed.toml", "--set", "packing.grains=60", "--out", packed, "--quiet")
        self.check_done(pack)
        text = f'schema = "equidem/1"\n[grains]\ndensity = 2500.0\npath = "{packed}/grains.csv"\n' + \
            DISCS[DISCS.index("[collisions]"):].replace("1.0e6", "1.0e8") + "[cell]\nwidth = 0.5\nheight = 0.5\n" + RUN
        out = self.folder / "out"
        result = self.run_case(self.write(text), "--out", out, *NO_PICTURE)
        self.assertGreater(result["cell"]["coordination_number"], 3.5)  # across the sides too
        self.assertLess(result["cell"]["stress_xx"], -1e3)
        self.assertLess(result["energy"]["kinetic"], 1e-3 * result["energy"]["elastic"])
        for wrong, words in ((text.replace("width = 0.5", "width = 0.6"), ("grains.csv:2", "width = 0.5 m", "[cell] has 0.6 m")),
                             (text.replace("[cell]\nwidth = 0.5\nheight = 0.5\n", ""), ("grains.csv:1", "Add [cell]"))):
            self.check_error(equidem("run", self.write(wrong)), 2, *words)

    def test_what_a_cell_cannot_be_is_refused_with_its_line(self):
        motion, servo = "[cell.motion]\nxy = 1.0\n", "[cell.servo]\nstress_yy = -1.0\nmax_rate = 1.0\n"
        x = CELL.replace("height = 0.1\n", 'periodic = "x"\n')
        for text, words in (
                (CELL.replace("0.1\nh", "0.03\nh"), ("cell", "width = 0.03 m", "several images")),
                (CELL.replace("height = 0.1\n", ""), ("cell.height", "missing")),
                (CELL.replace("width = 0.1\n", ""), ("cell.width", "missing")),
                (CELL + "depth = 1.0\n", ("unknown key",)),
                (CELL + FLOOR, ("cell", "wall 'floor'")),
                (x + FLOOR.replace("[0.0, 1.0]", "[1.0, 0.0]"), ("no line along x",)),
                (x + "height = 0.1\n" + FLOOR, ("height = 0.1 m",)),
                (x + FLOOR + motion, ("cell.motion", "along x alone")),
                (CELL + "[cell.motion]\nxx = 0.0\n", ("cell.motion", "all rates are 0")),
                (CELL + motion.replace("1.0", '1.0\nschedule = "no"'), ("cell.motion.schedule",)),
                (CELL + motion.replace("xy", "yy") + servo, ("rate_yy", "stress_yy")),
                (CELL + servo.replace("stress_yy = -1.0\n", ""), ("keeps no stress",)),
                (CELL + servo.replace("max_rate = 1.0\n", ""), ("cell.servo.max_rate",)),
                (CELL + "[measures]\n", ("measures",)),
                (CELL + '[[probe]]\nname = "middle"\nbodies = [0]\n'
                 'box = [0.0, 0.0, 0.1, 0.1]\nquantities = ["stress"]\n',
                 ("probe.quantities", "stress in a periodic cell", "history.csv has the stress of the cell")),
                (x.replace("[cell]\n", "[cell]\nshift = 0.01\n") + FLOOR, ("shift = 0.01 m",)),
                (CELL + '[[stage]]\nname = "a"\nduration = 1.0\n' + motion, ("cell.motion", "outside of the stages"))):
            with self.subTest(text=text):
                run = RUN.replace("duration = 0.01\n", "") if "stage" in text else RUN
                self.check_error(equidem("run", self.write(DISCS + text + run)), 2, "case.toml:", *words)
        self.check_error(equidem("run", self.write(DISCS + CELL + motion + RUN), "--set", "run.integrator=semi_implicit_euler"), 2,
                         "velocity_verlet")
        self.check_error(equidem("run", self.write(DISCS.replace("linear_dashpot", "exact_flow") + CELL + RUN.split("integ")[0])), 2,
                         "exact_flow")
        self.check_error(equidem("run", self.write(DISCS + CELL + RUN + "gravity = [0.0, -9.81]\n")), 2, "gravity")
        self.check_error(equidem("export", self.write(DISCS + CELL + RUN), "--to", "lammps", "--out", self.folder / "model"), 2,
                         "periodic cells of bodies that collide")


if __name__ == "__main__":
    unittest.main()
