# SPDX-License-Identifier: GPL-3.0-or-later
"""Bonds of colliding bodies, and bonds that stages make, as a user runs them: run_bonds.py PROGRAM SOURCE_FOLDER [unittest
options]."""
import math
import unittest

import numpy

from motion import RunTest, table
from program import CASES, NO_PICTURE, flat, rows_of
from scenes import FALLING, HEAD, LAW, PRESS, TOUCHING, grain, rock, stage, wall

BREAKING = CASES / "grains_breaking.toml"
BOND = "[[bond]]\ngrains = [0, 1]\nnormal_spring = 1.0e6\ntangential_spring = 5.0e5\nnormal_dashpot = 20.0\n"
PAIR = HEAD + TOUCHING + LAW
RUN = "[run]\nduration = 1.0e-3\n"


def strength(tension, shear):
    return f"[strength]\ntension = {tension}\nshear = {shear}\n"


class Stages(RunTest):
    def test_discs_that_are_cemented_keep_their_stress_and_break_under_more(self):
        out = self.folder / "out"
        result = self.run_case(self.write(rock()), "--out", out, NO_PICTURE)
        stages = {one["name"]: one for one in result["stages"]}
        self.assertEqual((stages["cement"]["bonds_made"], stages["cement"]["steps"]), (13, 500))
        self.assertGreater(result["breaks"]["number"], 0)
        self.assertLess(abs(result["energy"]["relative_error"]), 5e-3)
        history = table(out / "history.csv")
        cemented = (history["time_s"] > stages["cement"]["start"]) & (history["time_s"] <= stages["cement"]["end"])
        self.check_near(history["wall_lid_force_y_N_per_m"][cemented], numpy.full(cemented.sum(), 20.0), 1e-3)
        breaks, bonds = rows_of(out / "breaks.csv"), table(out / "bonds.csv")
        self.assertEqual(len(breaks) + len(bonds["i"]), 13)
        self.assertLess(max(int(row["bond"]) for row in breaks), 13)
        self.assertFalse({(int(row["i"]), int(row["j"])) for row in breaks} & set(zip(bonds["i"], bonds["j"])))
        self.assertGreater(numpy.ptp(bonds["tension"]), 0)
        self.assertIn(b"bending_moment", next((out / "frames").glob("contacts_*.vtp")).read_bytes())

    def test_a_bonded_body_that_a_stage_removes_goes_with_its_bonds(self):
        hole = stage("hole", 0.01, "[[stage.remove]]\nbox = [0.0, 0.0, 0.02, 0.02]\n"
                     "[[stage.grain]]\nposition = [0.0101, 0.0101]\nradius = 0.005\n")
        out = self.folder / "out"
        result = self.run_case(self.write(rock("[stage.bonds]\ngap_tolerance = 0.01\n" + hole)), "--out", out, NO_PICTURE)
        stages = {one["name"]: one for one in result["stages"]}
        self.assertEqual((stages["cement"]["bonds_made"], stages["hole"]["removed"], stages["hole"]["added"]), (13, 1, 1))
        self.assertEqual({int(row["number"]) for row in rows_of(out / "grains.csv")}, set(range(1, 9)))
        self.assertLess(max(int(row[k]) for row in rows_of(out / "bonds.csv") for k in "ij"), 7)  # the last is the new one

    def test_a_body_that_a_stage_adds_falls_freely_beside_a_bonded_pair_in_every_kind_of_scene(self):
        springs = "normal_spring = 4.0e5\ntangential_spring = 2.0e5"
        pair = "[grains]\ndensity = 1500.0\n" + grain(0.0, 0.03, 0.03) + grain(0.06, 0.03, 0.03) + \
            f"[bonds]\n{springs}\n[[bond]]\ngrains = [0, 1]\n" + LAW.replace("1.0e6", "4.0e5") + \
            wall("floor", (0.0, 0.0), (0.0, 1.0))
        added = "[[stage.grain]]\nposition = [{}, 0.2]\n{}\n"
        small = added.format(0.03, "radius = 0.02")
        for name, scene, more in (
                ("one", pair, small),
                ("two", pair, small + added.format(3.0, "radius = 0.005")),
                ("with strengths", pair + strength(1.0e3, 1.0e3), small),
                ("by groups", pair, small + 'group = "ball"\n[[stage.pair]]\ngroup = "ball"\nwith = "grains"\nfriction = 0.5\n'),
                ("an ellipse", pair, added.format(0.03, "half_axes = [0.02, 0.01]")),
                ("a clump", pair, added.format(0.03, "discs = [[-0.008, 0.0, 0.01], [0.008, 0.0, 0.01]]")),
                ("walls renamed", pair, small + '[[stage.rename]]\nwall = "floor"\nto = "ground"\n'),
                ("bonds made", pair, small + "[stage.bonds]\ngap_tolerance = 0.01\nnormal_spring = 4.0e5\n"),
                ("in a cell", pair + '[cell]\nperiodic = "x"\nwidth = 0.5\n', small),
                ("of dashpots", pair.replace(springs, "normal_dashpot = 50.0"), small)):
            with self.subTest(variant=name):
                out = self.folder / name
                case = self.write(scene + FALLING + stage("rest", 0.05) + stage("drop", 0.05, more))
                result = self.run_case(case, "--out", out, NO_PICTURE)
                grains, drop = rows_of(out / "grains.csv"), result["stages"][1]
                self.assertEqual(len(grains), 4 if name == "two" else 3)
                self.assertEqual([(row["i"], row["j"]) for row in rows_of(out / "bonds.csv")], [("0", "1")])
                fallen = 0.5 * 9.81 * (drop["end"] - drop["start"])**2
                self.assertAlmostEqual(0.2 - float(grains[2]["y_m"]), fallen, delta=3 * 9.81 * 0.05 * result["time_step"])
                self.assertLess(result["time_step"], result["bonds"]["critical_time_step"] or 1)
                self.assertLess(abs(float(grains[1]["x_m"]) - float(grains[0]["x_m"]) - 0.06), 1e-3)

    def test_bonds_that_are_read_back_keep_their_strengths(self):
        first, again = self.folder / "first", self.folder / "again"
        self.run_case(self.write(rock()), "--out", first, NO_PICTURE)
        bonds = table(first / "bonds.csv")
        self.assertLess(len(bonds["i"]), 13)
        text = BREAKING.read_text()
        given, law = text.index("[strength]"), text.index("[collisions]")
        head = text[:text.index("[[grain]]")] + f'path = "{first}/grains.csv"\n[bonds]\npath = "{first}/bonds.csv"\n'
        self.run_case(self.write(head + text[given:]), "--out", again, "run.duration=1e-4", NO_PICTURE)
        read = table(again / "bonds.csv")
        for column in ("i", "j", "tension", "shear"):
            self.assertEqual(list(read[column]), list(bonds[column]), column)
        self.refused(head + text[law:], "the file gives strengths", "[strength]")

    def test_bonds_that_tie_nobody_are_told(self):
        def tied(gap_tolerance):  # centres 0.03 m apart, radii 0.01 m
            bonds = f"[stage.bonds]\ngap_tolerance = {gap_tolerance}\nnormal_spring = 1.0e5\n"
            return self.run_case(self.write(PRESS + "[run]\n" + stage("a", 0.001) + stage("tie", 0.001, bonds)))
        self.assertIn("stage.bonds: no two discs were near enough in the stage 'tie'", flat(tied(0.49)["report"]))
        one = tied(0.51)
        self.assertEqual((one["stages"][1]["bonds_made"], "WARNING" in one["report"]), (1, False))

    def test_what_no_bond_can_bear_is_refused_with_the_step_that_it_bears(self):
        tie = "[bonds]\nnormal_spring = 1.0e11\n[run]\ntime_step = 1e-5\n" + stage("a", 0.001) + \
            stage("tie", 0.01, "[stage.bonds]\ngap_tolerance = 0.01\n")
        for text, *words in (
                (rock().replace("normal_spring = 1.0e6", "normal_spring = 1.0"), "'cement'", "too soft"),
                (rock().replace("[output]", "time_step = 1.0e-4\n[output]").replace("normal_spring = 1.0e6",
                                                                                    "normal_spring = 1.0e10"),
                 "'cement'", "limit"),
                (PAIR + BOND.replace("1.0e6", "1.0e8") + "[run]\nduration = 0.01\ntime_step = 7e-4\n", "run.time_step",
                 "the bonds impose"),
                (PAIR.replace("1.0e6", "1.0e3") + tie, "stage 'tie'", "limit", "the bonds impose")):
            with self.subTest(words=words):
                self.refused(text, *words)
        automatic = self.run_case(self.write(PAIR + BOND.replace("1.0e6", "1.0e9") + "[run]\nduration = 1e-4\n"))
        self.assertLess(automatic["time_step"], automatic["bonds"]["critical_time_step"])


class Breaking(RunTest):
    def test_a_bond_without_strength_holds_while_it_carries_nothing_or_is_refused(self):
        text, out = PAIR + BOND + strength(0.0, 0.0) + RUN, self.folder / "out"
        result = self.run_case(self.write(text))
        self.assertEqual((result["breaks"]["number"], result["energy"]["kinetic"]), (0, 0))
        moves = text.replace("[0.04, 0.01]\n", "[0.04, 0.01]\nvelocity = [1.0e-6, 0.0]\n")
        result = self.run_case(self.write(moves), "--out", out, NO_PICTURE)
        self.assertEqual((result["breaks"]["number"], rows_of(out / "breaks.csv")[0]["step"]), (1, "1"))
        for wrong in ("-1.0", "nan", "inf"):
            self.refused(PAIR + BOND + strength(wrong, 1.0) + RUN, "case.toml:", "strength")

    def test_discs_that_overlap_under_a_bond_part_with_the_energy_of_the_overlap(self):
        overlap, speed = 1e-5, 1e-6
        text = PAIR.replace("[0.04, 0.01]", f"[{0.04 - overlap!r}, 0.01]\nvelocity = [{speed}, 0.0]") + BOND + \
            strength(1e-4, 1.0) + '[run]\nduration = 0.01\nintegrator = "velocity_verlet"\n'
        energy = self.run_case(self.write(text))["energy"]
        stored = 0.5e6 * overlap**2
        self.assertLess(energy["initial"], 1e-4 * stored)
        self.assertAlmostEqual(-energy["lost_breaking"] / stored, 1, delta=1e-3)
        self.assertLess(abs(energy["relative_error"]), 1e-2)

    def test_too_much_energy_of_discs_that_overlapped_under_bonds_names_the_overlap(self):
        # two heavy discs throw a light one: it gets 1.5 k dt²/m times their energy by the first step
        half = 0.01
        light = half * math.sqrt(3) - 2e-5
        text = HEAD + grain(0.0, half, more="density = 1e6\n") + grain(0.0, -half, more="density = 1e6\n") + \
            grain(repr(light), 0.0, more="velocity = [1e-6, 0.0]\n") + LAW.replace("restitution = 0.3", "restitution = 1.0") + \
            "[bonds]\nnormal_spring = 1.0e3\ntangential_spring = 1.0e3\n[[bond]]\ngrains = [0, 2]\n[[bond]]\ngrains = [1, 2]\n" + \
            strength(1e-9, 1e-9)
        step = 1.9 / math.sqrt(1e6 / (2500 * math.pi * 1e-4))
        self.refused(text + f'[run]\nduration = {40 * step!r}\ntime_step = {step!r}\nintegrator = "semi_implicit_euler"\n',
                     "most of it set free by bonds that broke", "overlap by up to 1.73e-05 m under bonds", code=1)

    def test_everything_breaks_at_once_and_the_run_goes_on(self):
        # a ring whose discs fly apart alike: all bonds reach their strength in the same step
        count, radius = 12, 0.01
        ring = radius / math.sin(math.pi / count)
        turn = [2 * math.pi * k / count for k in range(count)]
        discs = "".join(grain(repr(ring * math.cos(a)), repr(ring * math.sin(a)), radius,
                              f"velocity = [{math.cos(a)!r}, {math.sin(a)!r}]\n") for a in turn)
        bonds = "".join(f"[[bond]]\ngrains = [{k}, {(k + 1) % count}]\n" for k in range(count))
        text = HEAD + discs + LAW + bonds + "[bonds]\nnormal_spring = 1.0e6\ntangential_spring = 5.0e5\n" + strength(400.0, 900.0) + \
            '[run]\nduration = 5.0e-3\nintegrator = "velocity_verlet"\n'
        out = self.folder / "out"
        result = self.run_case(self.write(text), "--out", out, NO_PICTURE)
        self.assertEqual(result["breaks"]["number"], count)
        breaks = rows_of(out / "breaks.csv")
        self.assertEqual({row["mode"] for row in breaks}, {"tension"})
        steps = {int(row["step"]) for row in breaks}
        self.assertLessEqual(max(steps) - min(steps), 1)  # round-off may split one step
        self.assertFalse(rows_of(out / "bonds.csv"))
        energy = result["energy"]
        self.assertLess(abs(energy["relative_error"]), 1e-3)
        self.assertAlmostEqual((energy["kinetic"] + energy["lost_breaking"]) / energy["initial"], 1, delta=1e-3)


if __name__ == "__main__":
    unittest.main()
