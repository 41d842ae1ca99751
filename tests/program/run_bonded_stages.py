#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Bonds in stages, as a user runs them: run_bonded_stages.py PROGRAM SOURCE_FOLDER [unittest options]."""
import csv
import shutil
import unittest

import numpy

from motion import table
from program import CASES
from run_stages import NO_PICTURE, PRESS, SERVO, StageTest

BREAKING = CASES / "grains_breaking.toml"


def rows_of(path):
    with open(path, newline="") as file:
        return list(csv.DictReader(file))


class BondedStages(StageTest):
    """Discs that are pressed, cemented, and pulled apart or crushed."""

    def rock(self, bonds="[stage.bonds]\ngap_tolerance = 0.01\n", pull=""):
        # three, two and three discs in rows that touch: a load from above draws the rows apart
        places = [(0.01 + 0.01 * (row % 2) + 0.02 * k, 0.01 + 0.0173205 * row) for row in range(3) for k in range(3 - row % 2)]
        grains = "".join(f"[[grain]]\nposition = [{x:.7f}, {y:.7f}]\nradius = 0.01\n" for x, y in places)
        head, walls = PRESS[:PRESS.index("[[grain]]")], PRESS[PRESS.index("[collisions]"):]
        walls = walls.replace("[0.07, 0.0]", "[0.0601, 0.0]").replace("[0.0, 0.021]", "[0.0, 0.0547]")
        return self.write(head + grains + walls + SERVO + """[bonds]
normal_spring = 1.0e6
tangential_spring = 5.0e5
bending_spring = 30.0
normal_dashpot = 20.0
tangential_dashpot = 10.0
[strength]
tension = 100.0
shear = 200.0
weibull_modulus = 5.0
[run]
integrator = "velocity_verlet"
[output]
probe_interval = 1.0e-3
frame_interval = 0.02
[[stage]]
name = "press"
duration = 0.05
[[stage]]
name = "cement"
steps = 500
""" + bonds + """[[stage]]
name = "crush"
duration = 0.05
[[stage.wall]]
name = "right"
removed = true
[[stage.wall]]
name = "left"
removed = true
[[stage.wall]]
name = "lid"
""" + (pull or "velocity = [0.0, -0.01]\n"))

    def test_a_body_that_a_stage_adds_falls_freely_beside_a_bonded_pair_in_every_kind_of_scene(self):
        pair = '''schema = "equidem/1"
[grains]
density = 1500.0
[[grain]]
position = [0.0, 0.03]
radius = 0.03
[[grain]]
position = [0.06, 0.03]
radius = 0.03
[bonds]
normal_spring = 4.0e5
tangential_spring = 2.0e5
[[bond]]
grains = [0, 1]
[collisions]
law = "linear_dashpot"
stiffness = 4.0e5
restitution = 0.4
[[wall]]
name = "floor"
point = [0.0, 0.0]
normal = [0.0, 1.0]
[run]
gravity = [0.0, -9.81]
[[stage]]
name = "rest"
duration = 0.05
[[stage]]
name = "drop"
duration = 0.05
'''
        added = "[[stage.grain]]\nposition = [{}, 0.2]\n{}\n"
        small = added.format(0.03, "radius = 0.02")
        strength = "[strength]\ntension = 1.0e3\nshear = 1.0e3\n"
        variants = {
            "one": (pair, small),
            "two": (pair, small + added.format(3.0, "radius = 0.005")),
            "with strengths": (pair + strength, small),
            "by groups": (pair, small + 'group = "ball"\n[[stage.pair]]\ngroup = "ball"\nwith = "grains"\nfriction = 0.5\n'),
            "an ellipse": (pair, added.format(0.03, "half_axes = [0.02, 0.01]")),
            "a clump": (pair, added.format(0.03, "discs = [[-0.008, 0.0, 0.01], [0.008, 0.0, 0.01]]")),
            "walls renamed": (pair, small + '[[stage.rename]]\nwall = "floor"\nto = "ground"\n'),
            "bonds made": (pair, small + "[stage.bonds]\ngap_tolerance = 0.01\nnormal_spring = 4.0e5\n"),
            "in a cell": (pair + '[cell]\nperiodic = "x"\nwidth = 0.5\n', small),
            "of dashpots": (pair.replace("normal_spring = 4.0e5\ntangential_spring = 2.0e5", "normal_dashpot = 50.0"), small),
        }
        for name, (scene, stage) in variants.items():
            with self.subTest(variant=name):
                out = self.folder / name
                at = scene.index("[run]\n")
                head, tail = scene[:at], scene[at:]
                stages, more = tail.split('name = "drop"\nduration = 0.05\n')
                result = self.run_case(self.write(head + more + stages + 'name = "drop"\nduration = 0.05\n' + stage),
                                       "--out", out, *NO_PICTURE)
                grains, bonds = rows_of(out / "grains.csv"), rows_of(out / "bonds.csv")
                self.assertEqual(len(grains), 4 if name == "two" else 3)
                self.assertEqual([(row["i"], row["j"]) for row in bonds], [("0", "1")])
                stage = result["stages"][1]
                fallen = 0.5 * 9.81 * (stage["end"] - stage["start"])**2
                self.assertAlmostEqual(0.2 - float(grains[2]["y_m"]), fallen, delta=3 * 9.81 * 0.05 * result["time_step"])
                self.assertLess(result["time_step"], result["bonds"]["critical_time_step"] or 1)
                self.assertLess(abs(float(grains[1]["x_m"]) - float(grains[0]["x_m"]) - 0.06), 1e-3)

    def test_a_bonded_body_that_a_stage_removes_goes_with_its_bonds(self):
        case = self.rock(bonds="[stage.bonds]\ngap_tolerance = 0.01\n[[stage]]\nname = \"hole\"\nduration = 0.01\n"
                         "[[stage.remove]]\nbox = [0.0, 0.0, 0.02, 0.02]\n[[stage.grain]]\nposition = [0.0101, 0.0101]\nradius = 0.005\n")
        out = self.folder / "out"
        result = self.run_case(case, "--out", out, *NO_PICTURE)
        stages = {stage["name"]: stage for stage in result["stages"]}
        self.assertEqual((stages["cement"]["bonds_made"], stages["hole"]["removed"], stages["hole"]["added"]), (13, 1, 1))
        self.assertEqual({int(row["number"]) for row in rows_of(out / "grains.csv")}, set(range(1, 9)))
        self.assertLess(max(int(row[k]) for row in rows_of(out / "bonds.csv") for k in "ij"), 7)  # the last is the new one

    def test_discs_that_are_cemented_keep_their_stress_and_break_under_more(self):
        out = self.folder / "out"
        result = self.run_case(self.rock(), "--out", out, *NO_PICTURE)
        stages = {stage["name"]: stage for stage in result["stages"]}
        self.assertEqual(stages["cement"]["bonds_made"], 13)
        self.assertEqual(stages["cement"]["steps"], 500)
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

    def test_a_bonded_run_in_stages_that_is_interrupted_goes_on_with_the_same_files(self):
        case = self.rock()
        whole, parts = self.folder / "whole", self.folder / "parts"
        self.run_case(case, "--out", whole, *NO_PICTURE)
        self.run_case(case, "--out", parts, *NO_PICTURE)
        for stage in ("cement", "press"):
            shutil.copy(parts / f"run.{stage}.checkpoint.h5", parts / "run.checkpoint.h5")
            self.run_case(case, "--out", parts, "--resume", *NO_PICTURE)
            for name in ("history.csv", "grains.csv", "contacts.csv", "bonds.csv", "breaks.csv", "energy.csv"):
                self.assertEqual((whole / name).read_bytes(), (parts / name).read_bytes(), (stage, name))

    def test_bonds_that_are_read_back_keep_their_strengths(self):
        first, again = self.folder / "first", self.folder / "again"
        self.run_case(self.rock(), "--out", first, *NO_PICTURE)
        bonds = table(first / "bonds.csv")
        self.assertLess(len(bonds["i"]), 13)
        text = BREAKING.read_text()
        text = text[:text.index("[[grain]]")] + f'path = "{first}/grains.csv"\n[bonds]\npath = "{first}/bonds.csv"\n' \
            + text[text.index("[strength]"):]
        self.run_case(self.write(text), "--out", again, "--set", "run.duration=1e-4", *NO_PICTURE)
        read = table(again / "bonds.csv")
        for column in ("i", "j", "tension", "shear"):
            self.assertEqual(list(read[column]), list(bonds[column]), column)
        self.refused(text.replace("[strength]", "[measures]").split("[measures]")[0] + text[text.index("[collisions]"):],
                     "the file gives strengths", "[strength]")

    def test_strengths_of_grains_hold_in_a_resumed_run(self):
        whole, parts = self.folder / "whole", self.folder / "parts"
        self.run_case(BREAKING, "--out", whole, *NO_PICTURE)
        self.run_case(BREAKING, "--out", parts, "--set", "run.duration=0.09", *NO_PICTURE)
        broken = len(rows_of(parts / "breaks.csv"))
        self.run_case(BREAKING, "--out", parts, "--resume", *NO_PICTURE)
        self.assertGreater(broken, 0)
        for name in ("grains.csv", "contacts.csv", "bonds.csv", "breaks.csv", "energy.csv"):
            self.assertEqual((whole / name).read_bytes(), (parts / name).read_bytes(), name)

    def test_what_no_bond_can_bear_is_refused(self):
        self.refused(self.rock().read_text().replace("normal_spring = 1.0e6", "normal_spring = 1.0"), "'cement'", "too soft",
                     code=2)
        self.refused(self.rock().read_text().replace("[output]", "time_step = 1.0e-4\n[output]")
                     .replace("normal_spring = 1.0e6", "normal_spring = 1.0e10"), "'cement'", "limit", code=2)


if __name__ == "__main__":
    unittest.main()
