# SPDX-License-Identifier: GPL-3.0-or-later
"""equidem run of discs, ellipses, clumps, bonded pairs and boxes that shake, as a user runs it: run_grains.py PROGRAM
SOURCE_FOLDER [unittest options]."""
import math
import unittest

import numpy

from motion import RunTest, frames_of, needs_vtk, sums_of_forces, table
from program import CASES, NO_PICTURE, equidem, flat, rows_of
from scenes import grain, wall

CRADLE, DROP, STACKED, BETWEEN, PISTON, ELLIPSES, BONDED, SHAKEN = (
    CASES / f"grains_{name}.toml" for name in ("cradle", "drop", "stacked", "between_walls", "piston", "ellipses",
                                               "bonded", "shaken"))
PAIRS = CASES / "pack_pairs.toml"
LAWS = ("exact_flow", "linear_dashpot", "hertz_dashpot", "five_case_map", "energy_map")
FLOOR = wall("floor", (0.0, 0.0), (0.0, 1.0))
BALL = '[grains]\nbody = "sphere"\ndensity = 2500.0\n' + grain(0.0, 0.02, more="velocity = [0.0, -1.0]\n") + """[collisions]
restitution = 0.6
stiffness = 1.0e6
closing_speed = 1.0
""" + FLOOR + "[run]\nduration = 0.03\n"


def tail_of(case, table):
    """The text of a case from a table on."""
    text = case.read_text()
    return text[text.index(table):]


class GrainTest(RunTest):
    def end_of(self, case, *options):
        """Result, and rows of grains.csv."""
        out = self.folder / "end"
        return self.run_case(case, "--out", out, "--overwrite", NO_PICTURE, *options), rows_of(out / "grains.csv")


class Motion(GrainTest):
    def test_the_cradle_passes_its_motion_on(self):
        result, grains = self.end_of(CRADLE)
        for one, expected in zip(grains, (0, 0, 0, 0, 1)):
            self.assertAlmostEqual(float(one["vx_m_per_s"]), expected, delta=1e-9)
        self.assertEqual((result["contacts"], result["energy"]["dissipated"]), (4, 0))
        self.assertLess(abs(result["energy"]["relative_error"]), 1e-9)

    def test_stacked_spheres_part_with_the_speed_of_rigid_ones(self):
        _, grains = self.end_of(STACKED)
        exact = 0.271462651012440 * math.sqrt(4 * 9.8 * 0.02)
        self.assertAlmostEqual(float(grains[1]["vx_m_per_s"]) / exact, 1, delta=1e-4)
        self.assertAlmostEqual(float(grains[0]["x_m"]) / -float(grains[1]["x_m"]), 1, delta=1e-13)

    def test_a_ball_leaves_with_the_restitution_asked_for_by_every_law(self):
        case, mass = self.write(BALL), 2500 * 4 / 3 * math.pi * 1e-6
        for law in LAWS:
            with self.subTest(law=law):
                result, grains = self.end_of(case, f"collisions.law={law}")
                self.assertEqual(result["contacts"], 1)
                tolerance = 0.02 if law.endswith("dashpot") else 1e-9  # that of 50 steps a contact
                self.assertAlmostEqual(float(grains[0]["vy_m_per_s"]), 0.6, delta=tolerance)
                self.assertAlmostEqual(result["energy"]["dissipated"] / (0.5 * mass * (1 - 0.36)), 1, delta=0.05)

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

    def test_measures_compare_the_moment_before_the_shaking_with_the_end(self):
        out = self.folder / "out"
        result = self.run_case(SHAKEN, "--out", out, NO_PICTURE, "shaking.start=0.25", "shaking.cycles=1", "run.duration=0.36")
        measures = result["measures"]
        self.assertAlmostEqual(measures["time"]["before"], 0.25, delta=0.011)
        self.assertLessEqual(measures["time"]["before"], 0.25)
        before = [row for row in rows_of(out / "measures.csv") if float(row["time_s"]) <= 0.25][-1]
        self.assertEqual(measures["void_ratio"]["before"], float(before["void_ratio"]))
        self.assertLess(measures["void_ratio"]["before"], 0.3)  # discs that lie; 1.6 at the start
        self.assertLess(abs(measures["settlement"]), 0.02)
        self.assertIn("before, at t =", result["report"])

    def test_a_hundred_g_shakes_a_box_and_loses_nothing(self):
        result, grains = self.end_of(BONDED, "shaking.acceleration=980.665", "shaking.frequency=20", "shaking.cycles=2",
                                     "shaking.start=0.05", "run.duration=0.16")
        self.assertAlmostEqual(result["shaking"]["peak_acceleration"], 980.665, delta=1e-9)
        self.assertLess(abs(result["energy"]["relative_error"]), 1e-2)
        for row in grains:
            self.assertTrue(0 < float(row["x_m"]) < 0.08, row)


class Files(GrainTest):
    @needs_vtk
    def test_histories_and_frames_agree(self):
        out = self.folder / "out"
        self.run_case(PISTON, "--out", out, "run.duration=0.3")
        history, frames = table(out / "history.csv"), frames_of(out)
        numpy.testing.assert_array_equal([frame[0] for frame in frames], history["time_s"])
        large = [k for k, row in enumerate(rows_of(out / "grains.csv")) if row["group"] == "large"]
        self.check_near(numpy.array([discs["points"][large, 0].mean() for _, _, discs, _ in frames]), history["large_x_m"], 1e-13)
        for name in ("picture.png", "picture.svg", "energy.csv", "energy_plot.png", "contacts.csv", "case.toml", "result.json"):
            self.assertTrue((out / name).stat().st_size > 0, name)

    @needs_vtk
    def test_contact_forces_in_frames_add_up_to_mass_times_acceleration(self):
        out = self.folder / "out"
        result = self.run_case(PISTON, "--out", out, "run.duration=0.35", NO_PICTURE, "output.frame_interval=1e-30")
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
                    self.run_case(source, "--out", out, "--overwrite", "run.duration=0.2", NO_PICTURE)
                self.check_same_files(first, second, "grains.csv", "case.toml")

    def test_columns_of_energy_add_up(self):
        out = self.folder / "out"
        self.run_case(BETWEEN, "--out", out, NO_PICTURE)
        h = table(out / "history.csv")
        terms = {name: column for name, column in h.items() if name.endswith("_J_per_m") and name != "error_J_per_m"}
        lacks = sum(-column if name.startswith(("work", "initial")) else column for name, column in terms.items())
        size = max(numpy.abs(column).max() for column in terms.values())
        self.assertLess(numpy.abs(lacks - h["error_J_per_m"]).max(), 1e-13 * size)

    def test_the_end_of_a_run_is_read_back_as_a_start(self):
        first = self.folder / "first"
        self.run_case(PISTON, "--out", first, "run.duration=0.3", NO_PICTURE)
        result, grains = self.end_of(PISTON, f'grains.path="{first / "grains.csv"}"', "run.duration=1e-4")
        self.assertEqual(result["grains"], 24)
        for a, b in zip(rows_of(first / "grains.csv"), grains):
            self.assertEqual(a["group"], b["group"])
            self.assertAlmostEqual(float(a["x_m"]), float(b["x_m"]), delta=1e-3)

    def test_ellipses_and_clumps_go_on_from_their_table(self):
        first = self.folder / "first"
        self.run_case(ELLIPSES, "--out", first, NO_PICTURE, "run.duration=0.1")
        case = self.write('[grains]\npath = "first/grains.csv"\n' + tail_of(ELLIPSES, "[collisions]"))
        _, after = self.end_of(case, "run.duration=1.0e-6", "run.time_step=1.0e-6")
        before = rows_of(first / "grains.csv")
        self.assertEqual([row["discs_m"] for row in before], [row["discs_m"] for row in after])
        for a, b in zip(before, after):
            self.assertLess(math.dist((float(a["x_m"]), float(a["y_m"])), (float(b["x_m"]), float(b["y_m"]))), 1e-5)

    def test_bonded_pairs_that_were_packed_are_run(self):
        packed, out = self.folder / "packed", self.folder / "end"
        self.done("pack", PAIRS, "packing.shape.kind=bonded_pair", "packing.grains=8", "packing.box=[0.1, 1.0]",
                  "settling.unbalanced=1e-3", "--out", packed)
        bonds = rows_of(packed / "bonds.csv")
        self.assertEqual([(int(row["i"]), int(row["j"])) for row in bonds], [(2 * k, 2 * k + 1) for k in range(8)])
        case = self.write('[grains]\npath = "packed/grains.csv"\n[bonds]\npath = "packed/bonds.csv"\n' +
                          tail_of(BONDED, "[collisions]").replace("0.08, 0.0", "0.1, 0.0"))
        result, _ = self.end_of(case, "run.duration=1.0e-3")
        self.assertEqual(result["bonds"]["number"], 8)
        for row, again in zip(bonds, rows_of(out / "bonds.csv")):
            self.assertEqual(row["normal_dashpot"], again["normal_dashpot"])
        # the two of a pair, which overlap from nothing to hold them apart, do not collide
        contacts = rows_of(out / "contacts.csv")
        self.assertFalse([c for c in contacts if c["j"] and int(c["i"]) // 2 == int(c["j"]) // 2])


class Refusals(GrainTest):
    def test_other_verbs_need_an_assembly(self):
        self.check_errors(*(((verb, CRADLE), "[assembly]", "equidem run")
                            for verb in ("solve", "homogenize", "calibrate", "stability")))

    def test_wrong_input_is_told_with_its_line(self):
        for change, *words in ((("density = 2500.0\n", ""), "case.toml:4", "density"),
                               (("[0.0, 0.02]", "[0.0, -0.02]"), "case.toml:5: grain", "behind", "floor"),
                               (("restitution = 0.6", "restitution = 60"), "case.toml:10", "from 0 to 1"),
                               (("[run]\nduration = 0.03\n", ""), "[run]"),
                               (("stiffness = 1.0e6\n", ""), "stiff", "contact_duration")):
            with self.subTest(change=change):
                self.check_error(equidem("run", self.write(BALL.replace(*change))), 2, *words)
        self.check_errors((("run", self.write(BALL), "--seed", 3), "--seed"),
                          (("run", ELLIPSES, "collisions.law=exact_flow"), "linear_dashpot"),
                          (("run", ELLIPSES, "grain.5.half_axes=[0.007, 0.014]"), "quarter turn"),
                          (("run", ELLIPSES, "grain.5.position=[0.093, 0.258]"), "inside one another"),
                          (("run", BONDED, "bond.0.grains=[0, 0]"), "itself"),
                          (("run", BONDED, "bonds.normal_dashpot=nan"), "finite"),
                          (("run", SHAKEN, "shaking.frequency=none"), "frequency"),
                          (("run", SHAKEN, "shaking.acceleration=1e300"), "m/s"),
                          (("run", SHAKEN, "measures.cell=1e-9"), "measures.cell"))

    def test_a_run_that_fails_delivers_what_it_has(self):
        step = ("[run]", "[run]\ntime_step = 1.0e-4")
        for changes, *words in (((("[0.0, -1.0]", "[0.0, -1000.0]"), step), "case.toml", "step"),  # it would cross the floor
                                ((("closing_speed = 1.0\n", 'law = "hertz_dashpot"\n'), ("1.0e6", "1.0e14"), step),
                                 "case.toml", "times the energy", "shorter time_step")):
            with self.subTest(words=words):
                text = BALL
                for change in changes:
                    text = text.replace(*change)
                out = self.folder / words[-1]
                result = self.check_partial(equidem("run", self.write(text), "--out", out), *words, out=out)
                self.assertFalse(result["complete"])
                self.assertLessEqual({"steps", "time", "energy", "time_step"}, set(result))
                self.check_there(out, "case.toml", "energy.csv", "grains.csv", "index.html", "run.checkpoint.h5")

    def test_maps_say_that_beds_are_not_for_them(self):
        column = BALL
        for old, new in (("restitution = 0.6\nstiffness = 1.0e6\nclosing_speed = 1.0", "restitution = 0.5\ncontact_duration = 1e-3"),
                         ("velocity = [0.0, -1.0]\n", ""), ("0.02]", "0.01]"),
                         ("duration = 0.03", "duration = 0.5\ngravity = [0.0, -9.8]")):
            column = column.replace(old, new)
        column += "".join(grain(0.0, 0.02 * n + 0.01) for n in range(1, 6))
        for law, doubtful in (("exact_flow", False), ("linear_dashpot", False), ("five_case_map", True), ("energy_map", True)):
            with self.subTest(law=law):
                text = flat(equidem("run", self.write(column.replace("[collisions]", f'[collisions]\nlaw = "{law}"'))).stdout)
                self.assertEqual(doubtful, "two by two" in text, text)
                self.assertEqual(doubtful, "came from nothing" in text, text)
        self.assertNotIn("two by two", self.report("run", DROP, "run.duration=0.1"))

    def test_bytes_of_a_file_do_not_reach_the_terminal_raw(self):
        self.write("x,y,radius\n0,0.02,\x1b[31m\x07\n", "grains.csv")
        self.refused(BALL.replace("density", 'path = "grains.csv"\ndensity', 1), "grains.csv:2", r"\x1b[31m\x07")


if __name__ == "__main__":
    unittest.main()
