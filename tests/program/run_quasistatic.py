#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""equidem quasistatic: run_quasistatic.py PROGRAM SOURCE_FOLDER [unittest options]."""
import csv
import json
import math
import random
import re
import textwrap
import time
import unittest

from program import CASES, SOURCE, ProgramTest, equidem, parse_json

NOTCH = CASES / "notched_plate.toml"
NO_PICTURE = ("--set", "output.files=['csv', 'vtk']")
REFERENCE = SOURCE / "data" / "reference"


class Quasistatic(ProgramTest):
    def run_notch(self, *options):
        done = equidem("quasistatic", NOTCH, "--json", "-", "--threads", 1, *options)
        self.assertEqual(done.returncode, 0, done.stderr)
        return parse_json(done.stdout)

    def events_of(self, out):
        with open(out / "events.csv", newline="") as file:
            return list(csv.DictReader(file))

    def test_strengths_in_the_assembly_file_give_the_events_of_the_reference(self):
        cell = json.loads((REFERENCE / "perturbed_hexagonal_400.json").read_text())
        expected = json.loads((REFERENCE / "perturbed_hexagonal_400_breakage.json").read_text())
        cell["strengths"] = [list(pair) for pair in zip(expected["tension_strength"], expected["shear_strength"])]
        (self.folder / "cell.json").write_text(json.dumps(cell))
        xx, yy, xy = expected["results"][1]["strain"]
        case = self.folder / "case.toml"
        case.write_text(f'schema = "equidem/1"\n[assembly]\nkind = "file"\npath = "cell.json"\n'
                        f'[springs]\nkN = {expected["kN"]}\nkT = {expected["kT"]}\n'
                        f'[strength]\nfriction = {expected["friction"]}\n'
                        f'[strain]\nxx = {xx}\nyy = {yy}\nxy = {xy}\n[quasistatic]\nmax_events = 30\n')
        done = equidem("quasistatic", case, "--json", "-")
        self.assertEqual(done.returncode, 0, done.stderr)
        events = parse_json(done.stdout)["events"]
        self.assertEqual(len(events), 30)
        for event, known in zip(events, expected["results"][1]["breaks"]):
            self.assertEqual((event["contact"], event["mode"]), (known["contact"], known["mode"]))
            self.assertAlmostEqual(event["lambda"] / known["lambda"], 1, delta=1e-9)
            for ours, theirs in zip(event["stress"], known["stress_at_lambda"]):
                self.assertAlmostEqual(ours, theirs, delta=1e-9)

    def test_a_result_holds_events_curve_envelopes_and_energies(self):
        result = self.run_notch("--set", "quasistatic.max_events=12")
        self.assertEqual(result["status"], "done")
        self.assertEqual((result["event_count"], len(result["events"]), result["end"]), (12, 12, "most_events"))
        self.assertEqual(len(result["curve"]["load"]), 13)
        self.assertLess(result["energies"]["error"], 1e-10)
        self.assertLess(result["relative_residual"], 1e-12)
        self.assertEqual(result["cut_contacts"], 15)
        self.assertEqual(result["units"]["events.load"], "N/m")
        loads = [event["load"] for event in result["events"]]
        self.assertEqual(max(loads), result["peak"]["load"])
        self.assertEqual(sorted(result["load_envelope"]["load"]), result["load_envelope"]["load"])

    def test_the_largest_load_may_be_that_at_the_end_of_a_leg(self):
        first = self.run_notch("--set", "quasistatic.max_events=1")["events"][0]
        for share in (0.5, -3.0):
            result = self.run_notch("--set", f"quasistatic.legs=[{share * first['lambda']}]")
            self.assertEqual((result["event_count"], result["end"]), (0, "legs_done"))
            peak = result["peak"]
            self.assertIsNone(peak["event"])
            self.assertAlmostEqual(peak["load"] / (share * first["load"]), 1, delta=1e-9)
            (xx, xy), (yx, yy) = peak["stress"]
            for ours, of_event in zip((xx, yx, xy, yy), first["stress"]):
                self.assertAlmostEqual(ours, share * of_event, delta=1e-9 * abs(share * first["stress"][3]))
            for name in ("curve", "load_envelope", "motion_envelope"):
                self.assertEqual(result[name]["load"], [0, peak["load"]])
                self.assertEqual(result[name]["motion"], [0, peak["motion"]])
        done = equidem("quasistatic", NOTCH, "--set", f"quasistatic.legs=[{0.5 * first['lambda']}]")
        self.assertRegex(done.stdout, "largest load .*at the end of leg 0")

    def check_same_events(self, expected, found):
        """Which contacts break, how and when, to round-off of the states between."""
        self.assertEqual(len(found), len(expected))
        stress = max(abs(float(row[name])) for row in expected for name in row if name.startswith("stress"))
        for name in [name for name in expected[0] if name != "checksum"]:
            ours, theirs = [row[name] for row in found], [row[name] for row in expected]
            if name in ("mode", "loosened"):
                self.assertEqual(ours, theirs)
            elif name == "relative_residual":
                self.assertLess(max(map(float, ours)), 1e-12)
            else:
                most = max((abs(float(value)) for value in theirs if math.isfinite(float(value))), default=0)
                if name.startswith("stress"):
                    most = stress
                for a, b in zip(ours, theirs):
                    self.assertTrue(a == b or abs(float(a) - float(b)) <= 1e-9 * most, (name, a, b))

    def test_stopped_and_resumed_it_has_the_same_events(self):
        whole, part = self.folder / "whole", self.folder / "part"
        self.run_notch("--out", whole, *NO_PICTURE)
        table = part / "events.csv"
        equidem("quasistatic", NOTCH, "--out", part, *NO_PICTURE, "--set", "quasistatic.max_events=1")
        text = (part / "case.toml").read_text()
        refused = equidem("quasistatic", NOTCH, "--out", part, *NO_PICTURE, "--set", "strength.seed=7", "--resume")
        self.check_error(refused, 2, "another case")
        rows = (whole / "events.csv").read_text().splitlines(keepends=True)
        (part / "case.toml").write_text((whole / "case.toml").read_text())
        for kept in (1, 20, len(rows) - 1):
            table.write_text("".join(rows[:kept + 1]))
            result = self.run_notch("--out", part, *NO_PICTURE, "--resume")
            self.assertTrue(result["complete"])
            self.assertEqual(table.read_text().splitlines(keepends=True)[:kept + 1], rows[:kept + 1])
            self.check_same_events(self.events_of(whole), self.events_of(part))
        table.write_text("".join(rows[:3]).replace("tension", "shear", 1))
        self.check_error(equidem("quasistatic", NOTCH, "--out", part, *NO_PICTURE, "--resume"), 2, "events.csv")
        self.assertNotEqual(text, "")
        self.check_error(equidem("quasistatic", NOTCH, "--resume"), 2, "--resume has nothing to go on from")

    def test_events_to_go_on_from_are_whole_or_refused(self):
        options = (*NO_PICTURE, "--set", "quasistatic.max_events=12")
        whole, part = self.folder / "whole", self.folder / "part"
        self.run_notch("--out", whole, *options)
        self.run_notch("--out", part, *options)
        rows = (whole / "events.csv").read_text().splitlines(keepends=True)
        resumed = lambda text: ((part / "events.csv").write_text(text),
                                equidem("quasistatic", NOTCH, "--out", part, *options, "--resume"))[1]
        for gap in (1, 5, len(rows) - 2):
            with self.subTest(gap=gap):
                self.check_error(resumed("".join(rows[:gap] + rows[gap + 1:])), 2, "events.csv", "the events to continue",
                                 f"line {gap + 1} has the event {gap} where {gap - 1} should be")
        self.check_error(resumed("".join([*rows[:4], rows[5], rows[4], *rows[6:]])), 2, "in another order")
        for left in (1, 20, len(rows[-1]) - 2):
            with self.subTest(left=left):
                done = resumed("".join(rows[:-1]) + rows[-1][:left])
                self.check_done(done)
                self.assertIn("events.csv: the last line is cut short; going on behind 11 events", done.stderr)
                self.check_same_events(self.events_of(whole), self.events_of(part))
        done = resumed("".join(rows)[:-1])
        self.check_done(done)
        self.assertNotIn("cut short", done.stderr)
        # A line that is cut in the middle of the table is another matter.
        self.check_error(resumed("".join(rows[:3]) + rows[3][:20] + "\n" + "".join(rows[4:])), 2, "line 4")

    def test_interrupted_it_ends_with_130_and_goes_on_with_the_same_events(self):
        larger = (*NO_PICTURE, "--set", "assembly.columns=61", "--set", "assembly.rows=61", "--set",
                  "strength.weibull_modulus=2.0", "--set", "quasistatic.max_events=400", "--threads", 1)
        whole, part = self.folder / "whole", self.folder / "part"
        self.check_done(equidem("quasistatic", NOTCH, "--out", whole, *larger))
        stdout, stderr = self.interrupt("quasistatic", NOTCH, "--out", part, *larger,
                                        when=lambda: (part / "case.toml").exists())
        self.assertIn("not ended: stopped as asked", stdout)
        self.assertIn("--resume", stderr)
        result = parse_json((part / "result.json").read_text())
        self.assertEqual((result["status"], result["complete"]), ("interrupted", False))
        self.check_done(equidem("quasistatic", NOTCH, "--out", part, *larger, "--resume"))
        self.check_same_events(self.events_of(whole), self.events_of(part))
        # Wherever it was interrupted: here after 150 events.
        rows = (whole / "events.csv").read_text().splitlines(keepends=True)
        (part / "events.csv").write_text("".join(rows[:151]))
        self.check_done(equidem("quasistatic", NOTCH, "--out", part, *larger, "--resume"))
        self.check_same_events(self.events_of(whole), self.events_of(part))

    def unbonded(self, discs, contacts, groups, actions, friction):
        """The result of three or more discs without bonds, kN = 1e9 Pa, kT half of it."""
        (self.folder / "discs.json").write_text(json.dumps({
            "schema": "equidem-assembly/1", "discs": discs, "contacts": [[i, j, 0, 0] for i, j in contacts],
            "springs": [[1e9, 0.5e9]] * len(contacts), "strengths": [[0, 0]] * len(contacts), "groups": groups}))
        case = self.folder / "static.toml"
        case.write_text(f'schema = "equidem/1"\n[assembly]\nkind = "file"\npath = "discs.json"\n[strength]\n'
                        f'friction = {friction}\nafter_breaking = "frictional"\n{actions}[quasistatic]\nlegs = [1.0]\n')
        done = equidem("quasistatic", case, "--json", "-")
        self.assertEqual(done.returncode, 0, done.stderr)
        result = parse_json(done.stdout)
        self.assertEqual(result["end"], "legs_done")
        return result["energies"]

    def slow_run(self, grains, walls, friction, rest):
        """The energies of the same discs between walls, stepped in time until they are at rest."""
        case = self.folder / "run.toml"
        bodies = "".join(f"[[grain]]\nposition = [{x}, {y}]\nradius = {r}\n" for x, y, r in grains)
        case.write_text(f'schema = "equidem/1"\n[grains]\ndensity = 2500.0\n{bodies}[collisions]\n'
                        f'law = "exact_flow"\ndamping = 0.5\nstiffness = 1e9\nfriction = {friction}\n'
                        f'tangential_ratio = 0.5\n{walls}[run]\n{rest}[output]\nfiles = ["csv", "vtk"]\n')
        done = equidem("run", case, "--json", "-")
        self.assertEqual(done.returncode, 0, done.stderr)
        return parse_json(done.stdout)["energy"]

    def test_a_pyramid_that_nothing_slips_in_rests_as_a_slow_run_leaves_it(self):
        r, x, friction = 0.02, 0.021, 0.8
        top = r + math.sqrt(4 * r * r - x * x)
        weight = 2500.0 * math.pi * r * r * 9.81
        moved = self.slow_run([(-x, r, r), (x, r, r), (0, top, r)],
                              '[[wall]]\nname = "floor"\npoint = [0.0, 0.0]\nnormal = [0.0, 1.0]\n', friction,
                              "duration = 0.02\ngravity = [0.0, -9.81]\n")
        still = self.unbonded([[-x, r, r], [x, r, r], [0, top, r], [-x, -r, r], [x, -r, r]],
                             [(3, 0), (4, 1), (0, 2), (1, 2)], {"floor": [3, 4], "discs": [0, 1, 2]},
                             '[[support]]\ngroup = "floor"\nux = true\nuy = true\nrotation = true\n'
                             f'[[load]]\ngroup = "discs"\nforce = [0.0, {-weight}]\n', friction)
        # Energies go with the square of forces.
        self.assertAlmostEqual(still["elastic"] / moved["elastic"], 1, delta=2e-6)
        self.assertEqual(still["friction"], 0)

    def test_a_disc_that_a_piston_drives_into_a_corner_slips_as_in_a_slow_run(self):
        r, way, friction = 0.02, 4e-7, 0.3
        normal = (-math.cos(math.radians(60)), -math.sin(math.radians(60)))
        for degrees in (200, 260):
            along = (math.cos(math.radians(degrees)), math.sin(math.radians(degrees)))
            walls = "".join(f'[[wall]]\nname = "{name}"\npoint = [{x}, {y}]\nnormal = [{nx}, {ny}]\n{more}'
                            for name, x, y, nx, ny, more in (
                                ("floor", 0.0, 0.0, 0.0, 1.0, ""), ("left", 0.0, 0.0, 1.0, 0.0, ""),
                                ("piston", r - r * normal[0], r - r * normal[1], *normal,
                                 f'displacement = {way}\ndirection = [{along[0]}, {along[1]}]\nschedule = "push"\n')))
            moved = self.slow_run([(r, r, r)], walls + '[[schedule]]\nname = "push"\nkind = "ramp"\nstart = 0.0\n'
                                  "end = 0.2\n", friction, "duration = 0.21\n")
            still = self.unbonded([[r, r, r], [r, -r, r], [-r, r, r], [r - 2 * r * normal[0], r - 2 * r * normal[1], r]],
                                 [(1, 0), (2, 0), (3, 0)], {"walls": [1, 2], "piston": [3]},
                                 '[[support]]\ngroup = "walls"\nux = true\nuy = true\nrotation = true\n'
                                 f'[[support]]\ngroup = "piston"\nux = {way * along[0]}\nuy = {way * along[1]}\n'
                                 "rotation = true\n", friction)
            self.assertGreater(still["friction"], 0.01 * still["elastic"])
            self.assertAlmostEqual(still["elastic"] / moved["elastic"], 1, delta=1e-6)
            # While the piston moves the dashpot adds to the normal force, and so to friction.
            self.assertAlmostEqual(still["friction"] / moved["lost_slip"], 1, delta=0.002)

    def test_broken_frictional_contacts_open_close_slip_and_stick(self):
        case = CASES / "frictional_notch.toml"
        options = (*NO_PICTURE, "--set", "quasistatic.max_events=150", "--json", "-")
        out = self.folder / "frictional"
        done = equidem("quasistatic", case, "--out", out, *options)
        self.assertEqual(done.returncode, 0, done.stderr)
        result = parse_json(done.stdout)
        self.assertLess(result["energies"]["error"], 1e-10)
        self.assertGreater(result["energies"]["friction"], 0)
        self.assertLess(result["relative_residual"], 1e-12)
        rows = self.events_of(out)
        self.assertEqual(len(rows), result["event_count"])
        self.assertLessEqual({"slip", "stick"}, {row["mode"] for row in rows})
        self.assertIn("friction_N", rows[0])
        table = (out / "events.csv").read_text()
        again = equidem("quasistatic", case, "--out", out, "--resume", *options)
        self.assertEqual(again.returncode, 0, again.stderr)
        self.assertEqual((out / "events.csv").read_text(), table)
        self.assertIn(f"going on behind {len(rows)} events", again.stderr)
        (out / "events.csv").write_text("".join(table.splitlines(keepends=True)[:4] + table.splitlines(keepends=True)[5:]))
        self.check_error(equidem("quasistatic", case, "--out", out, "--resume", *options), 2, "rows are missing")
        self.check_error(equidem("quasistatic", case, "--set", "quasistatic.control=path"), 2, "depends on the path")
        self.check_error(equidem("quasistatic", case, "--set", "springs.kT=-1e9"), 2, "kT < 0")
        self.check_error(equidem("quasistatic", case, "--set", "solver.method=cholmod"), 2, "umfpack alone", "solver.method")
        self.check_error(equidem("quasistatic", case, "--set", "solver.memory_limit=1e5"), 1, "are allowed by memory_limit")
        dry = equidem("quasistatic", case, "--dry-run", "--json", "-")
        self.assertEqual(dry.returncode, 0, dry.stderr)
        self.assertEqual(parse_json(dry.stdout)["method"], "umfpack")
        self.check_error(equidem("quasistatic", case, "--set", "strength.residual_friction=-1"), 2, "residual_friction")

    def test_forces_at_rest_that_a_limit_of_friction_needs_are_told(self):
        pressed, friction = 100.0, 0.5
        (self.folder / "pair.json").write_text(json.dumps({
            "schema": "equidem-assembly/1", "discs": [[0, 0, 0.5], [1, 0, 0.5]], "contacts": [[0, 1, 0, 0]],
            "springs": [[1e6, 4e5]], "strengths": [[0, 0]], "forces": [[-pressed, 0]], "groups": {"f": [0], "b": [1]}}))
        case = self.folder / "case.toml"
        case.write_text(f'schema = "equidem/1"\n[assembly]\nkind = "file"\npath = "pair.json"\n[strength]\n'
                        f'after_breaking = "frictional"\nresidual_friction = {friction}\n'
                        '[[support]]\ngroup = "f"\nux = true\nuy = true\nrotation = true\n'
                        '[[support]]\ngroup = "b"\nrotation = true\n[[load]]\ngroup = "b"\nforce = [0.0, 1.0]\n'
                        '[quasistatic]\nlegs = [60.0]\n')
        done = equidem("quasistatic", case, "--json", self.folder / "result.json")
        self.check_done(done)
        result = parse_json((self.folder / "result.json").read_text())
        self.assertAlmostEqual(result["events"][0]["lambda"], friction * pressed, delta=1e-9)
        self.assertRegex(done.stdout, "forces at rest +contacts begin with them")
        self.assertNotIn("not used", done.stdout)
        self.assertIn("have friction 0.5", " ".join(done.stdout.split()))
        self.assertEqual(result["strength"]["residual_friction"], friction)
        self.assertFalse(result["prestress"]["counts"])
        case.write_text(case.read_text().replace('after_breaking = "frictional"\n', "").replace("residual_friction", "friction"))
        gone = equidem("quasistatic", case)
        self.check_done(gone)
        self.assertRegex(gone.stdout, "not used +forces at rest: .*quasistatic with")

    def test_other_verbs_tell_that_they_take_no_notch(self):
        done = equidem("solve", NOTCH)
        self.check_done(done)
        self.assertIn("[[notch]]: quasistatic alone takes them", done.stdout)

    def test_frames_pictures_and_a_page_are_written(self):
        out = self.folder / "out"
        done = equidem("quasistatic", NOTCH, "--out", out, "--set", "quasistatic.frame_every=10")
        self.assertEqual(done.returncode, 0, done.stderr)
        names = {path.name for path in out.iterdir()}
        self.assertLessEqual({"cracks.svg", "cracks.png", "curve.csv", "events.csv", "frames.pvd", "index.html", "case.toml"},
                             names)
        self.assertEqual(len(self.events_of(out)), 50)
        self.assertEqual((out / "frames.pvd").read_text().count("discs_"), 5)

    def test_the_state_at_the_end_of_a_path_balances_its_load(self):
        first = self.run_notch("--set", "quasistatic.max_events=1")["events"][0]["lambda"]
        for name, lambda_end, frame_every in (("before", 0.5 * first, 1), ("after", 1.01 * first, 1), ("none", 0.5 * first, 0)):
            with self.subTest(name=name):
                out = self.folder / name
                result = self.run_notch("--out", out, *NO_PICTURE, "--set", f"quasistatic.legs=[{lambda_end}]", "--set",
                                        "quasistatic.control=motion", "--set",
                                        f"quasistatic.frame_every={frame_every}")
                self.assertEqual(result["end"], "legs_done")
                events = self.events_of(out)
                with open(out / "discs.csv", newline="") as file:
                    discs = list(csv.DictReader(file))
                with open(out / "contacts.csv", newline="") as file:
                    contacts = list(csv.DictReader(file))
                self.assertTrue((out / "state.vtm").exists())
                highest = max(float(disc["y_m"]) for disc in discs)
                top = {k for k, disc in enumerate(discs) if float(disc["y_m"]) > highest - 1e-6}
                self.assertAlmostEqual(max(float(discs[k]["uy_m"]) for k in top) / (1e-6 * lambda_end), 1, delta=1e-9)
                pull = sum(float(c["force_y_N_per_m"]) * ((int(c["i"]) in top) - (int(c["j"]) in top)) for c in contacts)
                self.assertAlmostEqual(-pull / result["curve"]["load"][-1], 1, delta=1e-9)
                for event in events:
                    self.assertEqual(float(contacts[int(event["contact"])]["normal_force_N_per_m"]), 0)
                if frame_every == 0:
                    self.assertFalse((out / "frames.pvd").exists())
                    continue
                times = re.findall('timestep="([0-9.e+]+)"[^>]*name="discs"', (out / "frames.pvd").read_text())
                self.assertEqual([float(time) for time in times], [*range(1, len(events) + 1), len(events) + 1])

    def test_a_dry_run_tells_sizes_and_breaks_nothing(self):
        result = self.run_notch("--dry-run")
        self.assertEqual(result["status"], "dry_run")
        self.assertEqual(result["method"], "multifrontal")
        self.assertGreater(result["peak_bytes"], 0)
        self.assertNotIn("events", result)
        self.assertIn("multiplications and additions to factorize", " ".join(result["report"].split()))

    FRICTIONAL = """
        schema = "equidem/1"
        [assembly]
        kind = "hexagonal"
        columns = {columns}
        rows = {rows}
        radius = 0.5e-3
        [springs]
        kN = 10.0e9
        kT = 3.0e9
        [[support]]
        group = "bottom"
        ux = true
        uy = true
        """

    def frictional(self, text, **size):
        case = self.folder / "frictional.toml"
        case.write_text(textwrap.dedent(self.FRICTIONAL.format(**size)) + textwrap.dedent(text))
        return case

    AVALANCHE = """
        [strength]
        tension = 10.0e3
        shear = 20.0e3
        after_breaking = "frictional"
        residual_friction = 0.4
        [[dead_load]]
        group = "top"
        kind = "traction"
        force = [0.0, -1.0e6]
        [[load]]
        group = "top"
        kind = "total"
        force = [100.0, 0.0]
        [quasistatic]
        control = "load"
        """

    def test_within_a_release_max_events_holds_and_the_path_goes_on_from_there(self):
        case = self.frictional(self.AVALANCHE, columns=60, rows=8)
        tables = []
        for name, counts in (("once", [12]), ("in_parts", [3, 8, 12])):
            out = self.folder / name
            for k, count in enumerate(counts):
                done = equidem("quasistatic", case, "--out", out, "--json", "-", *NO_PICTURE, *(["--resume"] if k else []),
                               "--set", f"quasistatic.max_events={count}")
                self.assertEqual(done.returncode, 0, done.stderr)
                result = parse_json(done.stdout)
                self.assertGreaterEqual(result["event_count"], count)
                self.assertLess(result["event_count"], count + 3)
                self.assertIn(f"(max_events = {count}), while a broken bond gives up its force", result["ended"])
                self.assertEqual(len(self.events_of(out)), result["event_count"])
            tables.append((out / "events.csv").read_text())
        self.assertEqual(*tables)

    def test_a_signal_within_a_release_is_answered_and_all_that_is_done_is_delivered(self):
        case = self.frictional(self.AVALANCHE, columns=300, rows=12)
        out = self.folder / "stopped"
        self.interrupt("quasistatic", case, "--out", out, *NO_PICTURE, after=4)
        result = parse_json((out / "result.json").read_text())
        self.assertGreater(result["event_count"], 0)
        self.assertEqual(result["ended"], "stopped as asked")
        self.assertEqual(len(self.events_of(out)), result["event_count"])

    def test_a_load_that_contacts_do_not_carry_ends_the_path_at_once(self):
        case = self.frictional("""
            [strength]
            tension = 0.0
            shear = 0.0
            friction = 0.3
            after_breaking = "frictional"
            [[dead_load]]
            group = "top"
            kind = "total"
            force = [0.0, -500.0]
            [[support]]
            group = "top"
            ux = 1.0e-6
            [quasistatic]
            legs = [1.0, -1.0]
            """, columns=10, rows=12)
        begun = time.monotonic()
        done = equidem("quasistatic", case, "--json", "-")
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertLess(time.monotonic() - begun, 30)
        self.assertIn("no consistent contact state found", parse_json(done.stdout)["ended"])

    def test_the_motion_that_a_load_drives_is_named_as_what_it_is(self):
        (self.folder / "stack.json").write_text(json.dumps({
            "schema": "equidem-assembly/1",
            "discs": [[-0.3, 0.25, 0.25], [0.3, 0.25, 0.25], [0, 0.65, 0.25], [-0.3, -0.25, 0.25], [0.3, -0.25, 0.25]],
            "contacts": [[0, 2, 0, 0], [1, 2, 0, 0], [0, 3, 0, 0], [1, 4, 0, 0]],
            "strengths": [[1e9, 1e9], [1e9, 1e9], [0, 0], [0, 0]],
            "groups": {"top": [2], "ground": [3, 4]}}))
        case = self.folder / "push.toml"
        case.write_text(textwrap.dedent("""
            schema = "equidem/1"
            assembly = {kind = "file", path = "stack.json"}
            springs = {kN = 2.0e6, kT = 1.0e6}
            strength = {after_breaking = "frictional", residual_friction = 0.4}
            support = [{group = "ground", ux = true, uy = true, rotation = true}]
            dead_load = [{group = "top", force = [0.0, -3.0]}]
            load = [{group = "top", force = [0.2, 0.0]}]
            quasistatic = {legs = [1.0]}
            """))
        done = equidem("quasistatic", case, "--json", "-")
        self.assertEqual(done.returncode, 0, done.stderr)
        ended = parse_json(done.stdout)["ended"]
        self.assertIn("a motion of ", ended)
        self.assertNotIn("slip", ended)

    def test_motions_of_any_size_break_the_same_contacts(self):
        usual = self.run_notch("--set", "quasistatic.max_events=20")
        contacts = [event["contact"] for event in usual["events"]]
        for size in (1e-60, 1e30, 1e50, 1e65):
            with self.subTest(size=size):
                path = self.run_notch("--set", "quasistatic.max_events=20", "--set", f"support.1.uy={size!r}")
                self.assertEqual([event["contact"] for event in path["events"]], contacts)

    def test_a_network_without_stiffness_carries_no_load_and_breaks_nowhere(self):
        """A diluted cell without tangential springs: its forces are round-off, however far the cell is strained."""
        rows = 40
        for seed, keep in ((4, 0.65), (1, 0.6)):
            draw = random.Random(seed)
            discs = [[i + 0.5 * (j % 2) + draw.uniform(-0.1, 0.1), math.sqrt(0.75) * j + draw.uniform(-0.1, 0.1), 0.5]
                     for j in range(rows) for i in range(rows)]
            contacts = []
            for j in range(rows):
                for i in range(rows):
                    for di, dj in ((1, 0), (j % 2, 1), (j % 2 - 1, 1)):
                        if draw.random() <= keep:
                            contacts.append([j * rows + i, (j + dj) % rows * rows + (i + di) % rows,
                                             (i + di) // rows, (j + dj) // rows])
            (self.folder / "cell.json").write_text(json.dumps({
                "schema": "equidem-assembly/1", "discs": discs, "contacts": contacts,
                "cell": [rows, rows * math.sqrt(0.75)]}))
            for after in ("gone", "frictional"):
                with self.subTest(seed=seed, after_breaking=after):
                    case = self.folder / "cell.toml"
                    case.write_text(textwrap.dedent(f"""
                        schema = "equidem/1"
                        assembly = {{kind = "file", path = "cell.json"}}
                        springs = {{kN = 1.0e9, kT = 0.0}}
                        strength = {{tension = 1.0e4, shear = 1.0e4, after_breaking = "{after}"}}
                        strain = {{xx = 1.0e-3, yy = -1.0e-3}}
                        """))
                    done = equidem("quasistatic", case, "--json", "-")
                    if done.returncode == 1:
                        self.assertIn("too soft", done.stderr)
                        continue
                    self.assertEqual(done.returncode, 0, done.stderr)
                    result = parse_json(done.stdout)
                    self.assertEqual(result["event_count"], 0, result["ended"])
                    self.assertLess(result["energies"]["error"], 1e-6)

    def test_a_path_whose_next_event_cannot_be_computed_delivers_all_before_it(self):
        """Three pairs, of which the energy of the third break leaves the range of numbers, and with one pair alone that of the first."""
        for strengths in ([1e-100, 1e-99, 1e100], [1e100]):
            pairs = range(len(strengths))
            (self.folder / "pairs.json").write_text(json.dumps({
                "schema": "equidem-assembly/1", "discs": [[2.0 * k, y, 0.5] for k in pairs for y in (0.0, 1.0)],
                "contacts": [[2 * k, 2 * k + 1, 0, 0] for k in pairs], "strengths": [[s, s] for s in strengths],
                "groups": {"low": [2 * k for k in pairs], "high": [2 * k + 1 for k in pairs]}}))
            case = self.folder / "pairs.toml"
            case.write_text(textwrap.dedent("""
                schema = "equidem/1"
                assembly = {kind = "file", path = "pairs.json"}
                springs = {kN = 1.0e-150, kT = 1.0e-150}
                support = [{group = "low", ux = true, uy = true}, {group = "high", ux = true, uy = 1.0e-3}]
                """))
            out = self.folder / f"out{len(strengths)}"
            done = equidem("quasistatic", case, "--out", out, *NO_PICTURE)
            result = parse_json((out / "result.json").read_text())
            events = len(strengths) - 1
            self.assertEqual(done.returncode, 0 if events else 1, done.stderr)
            self.assertEqual((result["event_count"], result["end"], result["complete"]), (events, "failed", False))
            self.assertIn("leave the range of numbers", result["ended"])
            self.assertIn("leave the range of numbers", " ".join((result["report"] if "report" in result else done.stdout).split()))
            self.assertEqual(len(self.events_of(out)), events)
            self.assertEqual(len(result["curve"]["load"]), events + 1)
            for name in ("curve.csv", "discs.csv", "contacts.csv"):
                self.assertTrue((out / name).exists(), name)

    def test_what_is_missing_or_contradictory_is_refused(self):
        self.check_error(equidem("quasistatic", CASES / "random_cell.toml"), 2, "strengths are missing")
        self.check_error(equidem("quasistatic", NOTCH, "--set", "support.1.uy=true"), 2, "nothing grows with lambda")
        self.check_error(equidem("quasistatic", NOTCH, "--set", "notch.0.to=[-0.0005,0.0152]"), 2, "crosses no contact")
        self.check_error(equidem("quasistatic", NOTCH, "--set", "strength.tension=-1"), 2, "strength.tension")
        for size in ("1e-300", "1e300"):
            self.check_error(equidem("quasistatic", NOTCH, "--set", f"springs.kN={size}", "--set", f"springs.kT={size}"), 2,
                             "the largest spring", "leave the range of numbers", "Pa")
        self.check_error(equidem("quasistatic", NOTCH, "--set", "strain.xx=1e-3"), 2, "not periodic")
        self.check_error(equidem("quasistatic", NOTCH, "--set", "springs.kT=-1e8"), 2, "kT < 0", "Take kT >= 0")
        self.check_error(equidem("quasistatic", NOTCH, "--set", "strength.weibull_modulus=1e-3"), 2, "scatters them")
        self.check_error(equidem("quasistatic", NOTCH, "--set", "support.1.uy=1e300"), 2,
                         "the size of the motions of supports is 1e+300", "range of numbers")
        self.check_error(equidem("quasistatic", NOTCH, "--set", "quasistatic.legs=[0.0]"), 2, "quasistatic.legs",
                         "nothing happens on it")

    def test_refusals_name_the_line_and_the_key(self):
        plate = NOTCH.read_text()
        load = '[[load]]\ngroup = "top"\nkind = "total"\nforce = [0.0, 1.0e5]\n'
        pulled = plate.replace('[[support]]\ngroup = "top"\nuy = 1.0e-6               # m, times lambda\n', load)
        friction = 'friction        = 0.5\nafter_breaking  = "frictional"'
        cell = ('schema = "equidem/1"\n[assembly]\nkind = "hexagonal"\ncolumns = 8\nrows = 8\nradius = 0.5\n'
                'periodic = true\n[springs]\nkN = 1e9\nkT = 3e8\n[strength]\ntension = 1e6\nshear = 2e6\n')
        one = '[[group]]\nname = "one"\ndiscs = [0]\n'
        for text, at, key, words in (
                (plate.replace("uy = 1.0e-6", "uy = 0.0"), "[[support]]", "support", "nothing grows with lambda"),
                (cell + "[strain]\nxx = 0.0\n", "[strain]", "strain", "nothing grows with lambda"),
                (plate + "[strain]\nxx = 1e-3\n", "[strain]", "strain", "not periodic"),
                (plate + '[[load]]\ngroup = "left"\nforce = [1.0, 0.0]\n', "[[load]]", "load", "grow with lambda together"),
                (cell + "[strain]\nxx = 1e-3\n" + one + '[[dead_load]]\ngroup = "one"\nforce = [1.0, 0.0]\n',
                 "[[dead_load]]", "dead_load", "cannot carry its loads"),
                (pulled.replace("0.008, 0.0152", "1.0, 0.0152"), "[[load]]", "load", "cannot carry its loads"),
                (plate.replace("kT = 3.0e9", "kT = -1.0e8"), "[springs]", "springs", "kT < 0"),
                (plate.replace("tension         = 10.0e3", "#"), "[strength]", "strength", "one of two strengths is missing"),
                (plate.replace("weibull_modulus = 8.0", "weibull_modulus = 1e-3"), "[strength]", "strength", "scatters them"),
                (plate.replace("friction        = 0.5", friction), "control", "quasistatic.control", "their state depends on"),
                (plate.replace('"path"', '"motion"\nlegs = [1.0, 1.0]'), "legs", "quasistatic.legs", "nothing happens"),
                (plate.replace("from = [-0.001, 0.0152]", "from = [1.0, 1.0]").replace("0.008, 0.0152", "2.0, 2.0"),
                 "[[notch]]", "notch", "crosses no contact")):
            case = self.folder / "case.toml"
            case.write_text(text)
            line = 1 + next(k for k, row in enumerate(text.splitlines()) if row.startswith(at))
            with self.subTest(key=key, words=words):
                self.check_error(equidem("quasistatic", case), 2, f"case.toml:{line}: {key}", words)


if __name__ == "__main__":
    unittest.main()
