#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Walls that get another name in a stage, and keys of stages that do not go together: run_stage_walls.py PROGRAM SOURCE_FOLDER [unittest options]."""
import csv
import unittest

import numpy

from motion import table
from program import equidem
from run_stages import NO_PICTURE, PRESS, SERVO, VERLET, StageTest

NAMED = PRESS + SERVO + """[[schedule]]
name = "less"
kind = "table"
times = [0.0, 0.01]
values = [1.0, 0.5]
[run]
[[stage]]
name = "press"
duration = 0.03
[[stage]]
name = "relieve"
duration = 0.03
[[stage.rename]]
wall = "lid"
to = "plate"
[[stage.wall]]
name = "plate"
servo = { force = 20.0, schedule = "less", max_speed = 0.1 }
[[stage]]
name = "stand"
duration = 0.01
[[stage.wall]]
name = "plate"
[output]
probe_interval = 1.0e-3
"""
UNNAMED = NAMED.replace('[[stage.rename]]\nwall = "lid"\nto = "plate"\n', "").replace('"plate"', '"lid"')


class Walls(StageTest):
    def test_a_wall_with_another_name_moves_pushes_and_is_told_as_before(self):
        case, out, other = self.write(NAMED), self.folder / "out", self.folder / "other"
        result = self.run_case(case, "--out", out, *NO_PICTURE)
        plain = self.run_case(self.write(UNNAMED, "unnamed.toml"), "--out", other, *NO_PICTURE)
        self.assertEqual((out / "grains.csv").read_bytes(), (other / "grains.csv").read_bytes())
        history, expected, end = table(out / "history.csv"), table(other / "history.csv"), result["stages"][0]["end"]
        early = history["time_s"] <= end
        columns = [name for name in expected if name.startswith("wall_lid_")]
        self.assertTrue(any("work" in name for name in columns) and any("force" in name for name in columns), columns)
        for name in columns:
            now = name.replace("lid", "plate")
            self.assertTrue(numpy.isnan(history[now][early]).all() and numpy.isnan(history[name][~early]).all(), name)
            numpy.testing.assert_array_equal(numpy.where(early, history[name], history[now]), expected[name])
        for stage, (servo, before) in enumerate(zip(result["servos"], plain["servos"])):
            self.assertEqual((servo["wall"], before["wall"]), ("plate" if stage else "lid", "lid"))
            self.assertEqual({**servo, "wall": ""}, {**before, "wall": ""})
        self.assertEqual((len(result["servos"]), result["servos"][1]["wanted"]), (2, 10))
        self.assertEqual([wall["name"] for wall in result["forces_on_walls"]], ["floor", "left", "right", "plate"])
        self.assertEqual([stage.get("renamed_walls") for stage in result["stages"]],
                         [None, [{"from": "lid", "to": "plate"}], None])
        self.assertIn("wall 'lid' renamed 'plate'", " ".join(result["report"].split()))
        parts = self.folder / "parts"
        self.run_case(case, "--out", parts, *NO_PICTURE)
        for stage in ("relieve", "press"):
            (parts / "run.checkpoint.h5").write_bytes((parts / f"run.{stage}.checkpoint.h5").read_bytes())
            again = self.run_case(case, "--out", parts, "--resume", *NO_PICTURE)
            self.assertEqual(again["stages"][1]["renamed_walls"], result["stages"][1]["renamed_walls"])
            for name in ("history.csv", "grains.csv", "contacts.csv", "energy.csv"):
                self.assertEqual((out / name).read_bytes(), (parts / name).read_bytes(), (stage, name))

    def test_contacts_of_a_wall_with_another_name_go_by_that_name(self):
        push = PRESS.split('[[wall]]\nname = "lid"')[0] + """[[collisions.pair]]
group = "grains"
with = "floor"
friction = 0.0
[run]
gravity = [3.0, -9.81]
[[stage]]
name = "slide"
duration = 0.004
[[stage]]
name = "friction"
duration = 0.004
"""
        push = push.replace("[collisions]", "[collisions]\nfriction = 0.4").replace("[0.02, 0.01]", "[0.02, 0.00999]").replace("[0.05, 0.01]", "[0.04, 0.00999]")
        smooth = self.run_case(self.write(push), *VERLET)
        rename = '[[stage.rename]]\nwall = "floor"\nto = "ground"\n'
        rough = self.run_case(self.write(push + rename), *VERLET)
        same = self.run_case(self.write(push + rename + '[[stage.pair]]\ngroup = "grains"\nwith = "ground"\nfriction = 0.0\n'),
                             *VERLET)
        losses = [result["energy"]["lost_slip"] for result in (smooth, rough, same)]
        self.assertEqual((losses[0], losses[2]), (0, 0))
        self.assertGreater(losses[1], 0)

    def test_a_force_that_a_stage_does_not_name_goes_on_in_its_schedule(self):
        rising = '[[schedule]]\nname = "rise"\nkind = "table"\ntimes = [0.0, 0.06]\nvalues = [0.5, 1.0]\n[run]\ntime_step = 2.0e-5\n'
        first = '[[stage]]\nname = "a"\nduration = {}\n[[stage.wall]]\nname = "lid"\n' \
            'servo = {{ force = 20.0, schedule = "rise", max_speed = 0.1 }}\n'
        rest = '[[stage]]\nname = "b"\nduration = 0.01\n[[stage.rename]]\nwall = "lid"\nto = "plate"\n' \
            '[[stage]]\nname = "c"\nduration = 0.01\n'
        for scene, command in ((PRESS, ()), (PRESS, VERLET)):
            whole = self.run_case(self.write(scene + rising + first.format(0.05)), "--out", self.folder / "whole", "--overwrite", *command,
                                  *NO_PICTURE)
            case, out = self.write(scene + rising + first.format(0.03) + rest), self.folder / "out"
            parts = self.run_case(case, "--out", out, *command, "--overwrite", *NO_PICTURE)
            self.assertAlmostEqual(parts["servos"][-1]["wanted"], whole["servos"][0]["wanted"], delta=1e-12)
            self.assertGreater(whole["servos"][0]["wanted"], 18)
            heights = [[float(row["y_m"]) for row in csv.DictReader((folder / "grains.csv").read_text().splitlines())]
                       for folder in (out, self.folder / "whole")]
            numpy.testing.assert_allclose(*heights, rtol=1e-12)
            (out / "run.checkpoint.h5").write_bytes((out / "run.b.checkpoint.h5").read_bytes())
            again = self.run_case(case, "--out", out, "--resume", *command, *NO_PICTURE)
            self.assertEqual(again["servos"], parts["servos"])

    def test_wrong_names_of_walls_are_refused_with_their_line(self):
        mirrored = NAMED.replace('servo = { force = 20.0, max_speed = 0.1 }\n',
                                 'servo = { force = 20.0, max_speed = 0.1, mirror = "floor" }\n')
        early = UNNAMED.replace("duration = 0.03\n", 'duration = 0.03\n[[stage.rename]]\nwall = "lid"\nto = "plate"\n', 1)
        alone = NAMED[:NAMED.index("[[stage.wall]]")]
        twice = 'to = "plate"\n[[stage.rename]]\nwall = "{}"\nto = "third"\n'
        for text, words in ((NAMED.replace('wall = "lid"\nto', 'wall = "lit"\nto'), ("stage.rename.wall", "no wall", 'mean "lid"')),
                            (NAMED.replace('to = "plate"', 'to = "floor"'), ("stage.rename.to", "has or had that name")),
                            (alone.replace('to = "plate"', 'to = "grains"'), ("both called 'grains'",)),
                            (alone.replace('to = "plate"', 'to = "walls"'), ("stage.rename.to", "all of them")),
                            (NAMED.replace('to = "plate"', 'to = "a b"'), ("stage.rename.to", "letters")),
                            (NAMED.replace('to = "plate"\n', ""), ("stage.rename.to", "missing")),
                            (NAMED.replace('to = "plate"\n', twice.format("plate")), ("stage.rename.wall", "Rename it once")),
                            (NAMED.replace('to = "plate"\n', twice.format("lid")), ("stage.rename.wall", "Rename it once")),
                            (NAMED.replace('to = "plate"\n', 'to = "plate"\ngroup = "grains"\n'), ("wall", "group", "bodies or a wall")),
                            (NAMED.replace('name = "plate"\nservo', 'name = "lid"\nservo'), ("stage.wall.name", 'Write name = "plate"')),
                            (NAMED.replace('name = "plate"\nservo = ', 'name = "plate"\nremoved = true\n#'), ("renamed and removed",)),
                            (NAMED.replace('name = "plate"\nservo = ', 'name = "lid"\nremoved = true\n#'), ("renamed and removed",)),
                            (early, ("stage.rename", "first stage renames the wall 'lid'")),
                            (mirrored.replace('wall = "lid"\nto', 'wall = "floor"\nto').replace('[[stage.wall]]\nname = "plate"\nservo = ', "#"),
                             ("'floor' is renamed", "'lid' moves it as its mirror"))):
            with self.subTest(words=words):
                self.refused(text, "case.toml:", *words)

    def test_the_wrong_one_of_two_keys_is_named_with_its_line(self):
        shaking = "[stage.shaking]\nacceleration = 1.0\nfrequency = 100.0\ncycles = 1\n"

        def stage(text, base=PRESS + SERVO):
            return base + '[run]\n[[stage]]\nname = "a"\nduration = 0.01\n[[stage]]\nname = "b"\nduration = 0.01\n' + text

        def wall(name, text):
            return f'[[stage.wall]]\nname = "{name}"\n{text}\n'

        def pair(group, other):
            return f'[[stage.pair]]\ngroup = "{group}"\nwith = "{other}"\nfriction = 0.2\n'
        gone = wall("lid", "removed = true")
        rename = '[[stage.rename]]\nwall = "lid"\nto = "plate"\n'
        for text, key, line, words in (
                (wall("lit", "removed = true"), "stage.wall.name", 'name = "lit"', ('mean "lid"',)),
                (wall("lid", "removed = true\nshaken = false"), "stage.wall.shaken", "shaken = false", ("is removed, and shaken",)),
                (wall("lid", "servo = { force = 1.0, max_speed = 1.0 }\nvelocity = [0.0, -1.0]"), "stage.wall.servo", "servo = {",
                 ("a velocity", "Leave out that motion")),
                (wall("lid", 'servo = { force = 1.0, max_speed = 1.0, mirror = "flor" }'), "stage.wall.servo.mirror", 'mirror = "flor"', ()),
                (wall("lid", 'servo = { force = 1.0, max_speed = 1.0, mirror = "lid" }'), "stage.wall.servo.mirror", 'mirror = "lid"',
                 ("its own mirror",)),
                (wall("lid", 'servo = { stress = 1.0, max_speed = 1.0, from = "left", to = "west" }'), "stage.wall.servo.to", "west", ()),
                (shaking + "direction = [0.0, 1.0]\n", "stage.shaking", "[stage.shaking]", ("'lid' shakes along", "servo")),
                ('[stage.until]\nstrain = 0.1\nfrom = "floor"\nto = "left"\n', "stage.until.to", 'to = "left"', ("do not face",)),
                ('[stage.until]\nstrain = 0.1\nfrom = "floor"\nto = "floor"\n', "stage.until.to", 'to = "floor"', ("the same",)),
                ("[stage.bonds]\ngap_tolerance = 0.1\n", "stage.bonds", "[stage.bonds]", ("neither dashpots nor springs",)),
                (pair("grains", "lid") + gone, "stage.pair.with", 'with = "lid"', ("no wall 'lid' stands",)),
                (pair("grains", "lid") + rename, "stage.pair.with", 'with = "lid"', ('Write with = "plate"',)),
                (pair("grains", "nobody"), "stage.pair.with", 'with = "nobody"', ("no group of grains and no wall",)),
                (pair("lid", "grains"), "stage.pair.group", 'group = "lid"', ("but a wall", "Exchange")),
                (pair("lid", "floor"), "stage.pair.group", 'group = "lid"', ("do not meet",)),
                (pair("grains", "lid") + pair("grains", "lid").replace("0.2", "0.3"), "stage.pair", None, ("a pair twice",)),
                (wall("lid", "") + wall("lid", "velocity = [0.0, 1.0]"), "stage.wall.name", None, ("two walls 'lid'",)),
                ('[[stage.rename]]\ngroup = "grains"\nto = "lid"\n', "stage.rename.to", 'to = "lid"', ("both called 'lid'",)),
                ('[[stage.grain]]\nposition = [0.035, 0.01]\nradius = 0.001\ngroup = "lid"\n', "stage.grain.group", 'group = "lid"',
                 ("both called 'lid'",))):
            with self.subTest(text=text):
                content = stage(text)
                self.refused(content, f": {key}: ", *words)
                if line is None:
                    continue
                told = equidem("run", self.write(content)).stderr
                number = int(told.split("case.toml:")[1].split(":")[0])
                self.assertIn(line, content.splitlines()[number - 1], told)

    def test_bonds_that_tie_nobody_are_told(self):
        text = PRESS + "[run]\n[[stage]]\nname = \"a\"\nduration = 0.001\n[[stage]]\nname = \"tie\"\nduration = 0.001\n" + \
            "[stage.bonds]\ngap_tolerance = {}\nnormal_spring = 1.0e5\n"  # centres 0.03 m apart, radii 0.01 m
        none = self.run_case(self.write(text.format(0.49)))
        self.assertIn("stage.bonds: no two discs were near enough in the stage 'tie'", " ".join(none["report"].split()))
        one = self.run_case(self.write(text.format(0.51)))
        self.assertEqual((one["stages"][1]["bonds_made"], "WARNING" in one["report"]), (1, False))

    def test_a_disc_passes_to_a_wall_that_a_stage_puts_next_to_another_as_over_one(self):
        text = """schema = "equidem/1"
[grains]
density = 1800.0
[[grain]]
position = [-0.01, 1.998e-3]
radius = 2.0e-3
velocity = [0.25, 0.0]
[collisions]
law = "linear_dashpot"
stiffness = 110948.0      # m g/k = 2e-6 m
restitution = 1.0
[[wall]]
name = "first"
shape = "segment"
point = [-0.05, 0.0]
end = [0.0, 0.0]
[run]
gravity = [0.0, -9.81]
integrator = "velocity_verlet"
[output]
probe_interval = 2.0e-5
files = ["csv", "vtk"]
[[stage]]
name = "roll"
duration = 0.02
[[stage]]
name = "pass"
duration = 0.06
[[stage.rename]]
wall = "first"
to = "old"
[[stage.wall]]
name = "second"
shape = "segment"
point = [GAP, 0.0]
end = [0.05, 0.0]
"""
        for gap in ("3.0e-8", "3.0e-7", "3.0e-6", "-3.0e-6"):
            with self.subTest(gap=gap):
                out = self.folder / gap
                result = self.run_case(self.write(text.replace("GAP", gap)), "--out", out)
                self.assertNotIn("WARNING", result["report"])
                columns = table(out / "history.csv")
                force = sum(numpy.nan_to_num(columns[f"wall_{name}_force_y_N_per_m"]) for name in ("first", "old", "second"))
                weight = 1800 * numpy.pi * 2e-3**2 * 9.81
                self.assertLess(abs(force[1:] / weight + 1).max(), 1e-3)
        wide = self.run_case(self.write(text.replace("GAP", "1.0e-4")))
        self.assertIn('walls "old" and "second" end 0.0001 m apart', " ".join(wide["report"].split()))


if __name__ == "__main__":
    unittest.main()
