#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""equidem quasistatic: run_quasistatic.py PROGRAM SOURCE_FOLDER [unittest options]."""
import json
import math
import random
import re
import unittest

from program import CASES, NO_PICTURE, SOURCE, ProgramTest, equidem, flat, parse_json, result_in, rows_of

NOTCH, FRICTIONAL = CASES / "notched_plate.toml", CASES / "frictional_notch.toml"
REFERENCE = SOURCE / "data" / "reference"


def block(columns, rows, more):
    """A block that stands on its bottom."""
    return f'''[assembly]
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
{more}'''


def walls(*given):
    return "".join(f'[[wall]]\nname = "{name}"\npoint = [{x}, {y}]\nnormal = [{nx}, {ny}]\n{more}' for name, x, y, nx,
                   ny, more in given)


class QuasistaticTest(ProgramTest):
    def run_notch(self, *options):
        return self.result("quasistatic", NOTCH, "--threads", 1, *options)

    def path_of(self, more, **assembly):
        """The result for an assembly in a file."""
        self.write_assembly("assembly.json", **assembly)
        return self.result("quasistatic", self.of_file("assembly.json", more))


class Events(QuasistaticTest):
    def test_strengths_in_the_assembly_file_give_the_events_of_the_reference(self):
        cell = json.loads((REFERENCE / "perturbed_hexagonal_400.json").read_text())
        expected = json.loads((REFERENCE / "perturbed_hexagonal_400_breakage.json").read_text())
        cell["strengths"] = [list(pair) for pair in zip(expected["tension_strength"], expected["shear_strength"])]
        known = expected["results"][1]
        xx, yy, xy = known["strain"]
        events = self.path_of(f'[springs]\nkN = {expected["kN"]}\nkT = {expected["kT"]}\n[strength]\nfriction = {expected["friction"]}\n'
                              f"[strain]\nxx = {xx}\nyy = {yy}\nxy = {xy}\n[quasistatic]\nmax_events = 30\n", **cell)["events"]
        self.assertEqual(len(events), 30)
        for event, known in zip(events, known["breaks"]):
            self.assertEqual((event["contact"], event["mode"]), (known["contact"], known["mode"]))
            self.assertAlmostEqual(event["lambda"] / known["lambda"], 1, delta=1e-9)
            for ours, theirs in zip(event["stress"], known["stress_at_lambda"]):
                self.assertAlmostEqual(ours, theirs, delta=1e-9)

    def test_a_result_holds_events_curve_envelopes_and_energies(self):
        result = self.run_notch("quasistatic.max_events=12")
        self.assertEqual(result["status"], "done")
        self.assertEqual((result["event_count"], len(result["events"]), result["end"]), (12, 12, "most_events"))
        self.assertEqual(len(result["curve"]["load"]), 13)
        self.assertLess(result["energies"]["error"], 1e-10)
        self.assertLess(result["relative_residual"], 1e-12)
        self.assertEqual(result["cut_contacts"], 15)
        self.assertEqual(result["units"]["events.load"], "N/m")
        self.assertEqual(max(event["load"] for event in result["events"]), result["peak"]["load"])
        self.assertEqual(sorted(result["load_envelope"]["load"]), result["load_envelope"]["load"])

    def test_the_largest_load_may_be_that_at_the_end_of_a_leg(self):
        first = self.run_notch("quasistatic.max_events=1")["events"][0]
        for share in (0.5, -3.0):
            result = self.run_notch(f"quasistatic.legs=[{share * first['lambda']}]")
            self.assertEqual((result["event_count"], result["end"]), (0, "legs_done"))
            peak = result["peak"]
            self.assertIsNone(peak["event"])
            self.assertAlmostEqual(peak["load"] / (share * first["load"]), 1, delta=1e-9)
            (xx, xy), (yx, yy) = peak["stress"]
            for ours, of_event in zip((xx, yx, xy, yy), first["stress"]):
                self.assertAlmostEqual(ours, share * of_event, delta=1e-9 * abs(share * first["stress"][3]))
            for name in ("curve", "load_envelope", "motion_envelope"):
                for key in ("load", "motion"):
                    self.assertEqual(result[name][key], [0, peak[key]])
        self.assertRegex(self.report("quasistatic", NOTCH, f"quasistatic.legs=[{0.5 * first['lambda']}]"),
                         "largest load .*at the end of leg 0")

    def test_frames_pictures_and_a_page_are_written(self):
        out = self.folder / "out"
        self.done("quasistatic", NOTCH, "--out", out, "quasistatic.frame_every=10")
        self.check_there(out, "cracks.svg", "cracks.png", "curve.csv", "events.csv", "frames.pvd", "index.html", "case.toml")
        self.assertEqual(len(rows_of(out / "events.csv")), 50)
        self.assertEqual((out / "frames.pvd").read_text().count("discs_"), 5)

    def test_the_state_at_the_end_of_a_path_balances_its_load(self):
        first = self.run_notch("quasistatic.max_events=1")["events"][0]["lambda"]
        for name, lambda_end, frame_every in (("before", 0.5 * first, 1), ("after", 1.01 * first, 1), ("none", 0.5 * first, 0)):
            with self.subTest(name=name):
                out = self.folder / name
                result = self.run_notch("--out", out, NO_PICTURE, f"quasistatic.legs=[{lambda_end}]", "quasistatic.control=motion",
                                        f"quasistatic.frame_every={frame_every}")
                self.assertEqual(result["end"], "legs_done")
                events, discs, contacts = (rows_of(out / f"{kind}.csv") for kind in ("events", "discs", "contacts"))
                self.check_there(out, "state.vtm")
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

    def test_motions_of_any_size_break_the_same_contacts(self):
        usual = [event["contact"] for event in self.run_notch("quasistatic.max_events=20")["events"]]
        for size in (1e-60, 1e30, 1e50, 1e65):
            with self.subTest(size=size):
                path = self.run_notch("quasistatic.max_events=20", f"support.1.uy={size!r}")
                self.assertEqual([event["contact"] for event in path["events"]], usual)

    def test_a_network_without_stiffness_carries_no_load_and_breaks_nowhere(self):
        """A diluted cell without tangential springs: its forces are round-off, however far the cell is strained."""
        rows = 40
        for seed, keep in ((4, 0.65), (1, 0.6)):
            draw = random.Random(seed)
            discs = [[i + 0.5 * (j % 2) + draw.uniform(-0.1, 0.1), math.sqrt(0.75) * j + draw.uniform(-0.1, 0.1), 0.5]
                     for j in range(rows) for i in range(rows)]
            contacts = [[j * rows + i, (j + dj) % rows * rows + (i + di) % rows, (i + di) // rows, (j + dj) // rows]
                        for j in range(rows) for i in range(rows) for di, dj in ((1, 0), (j % 2, 1), (j % 2 - 1, 1))
                        if draw.random() <= keep]
            self.write_assembly("cell.json", discs=discs, contacts=contacts, cell=[rows, rows * math.sqrt(0.75)])
            for after in ("gone", "frictional"):
                with self.subTest(seed=seed, after_breaking=after):
                    done = equidem("quasistatic", self.of_file("cell.json",
                                                               "[springs]\nkN = 1.0e9\nkT = 0.0\n[strength]\ntension = 1.0e4\n"
                                                               f'shear = 1.0e4\nafter_breaking = "{after}"\n[strain]\nxx = 1.0e-3\n'
                                                               "yy = -1.0e-3\n"), "--json", "-")
                    if done.returncode == 1:
                        self.assertIn("too soft", done.stderr)
                        continue
                    result = parse_json(self.check_done(done).stdout)
                    self.assertEqual(result["event_count"], 0, result["ended"])
                    self.assertLess(result["energies"]["error"], 1e-6)

    def test_a_path_whose_next_event_cannot_be_computed_delivers_all_before_it(self):
        """Three pairs, of which the energy of the third break leaves the range of numbers, and with one pair alone that of the first."""
        for strengths in ([1e-100, 1e-99, 1e100], [1e100]):
            pairs, events = range(len(strengths)), len(strengths) - 1
            self.write_assembly("pairs.json", discs=[[2.0 * k, y, 0.5] for k in pairs for y in (0.0, 1.0)],
                                contacts=[[2 * k, 2 * k + 1, 0, 0] for k in pairs], strengths=[[s, s] for s in strengths],
                                groups={"low": [2 * k for k in pairs], "high": [2 * k + 1 for k in pairs]})
            case, out = self.of_file("pairs.json", '[springs]\nkN = 1.0e-150\nkT = 1.0e-150\n[[support]]\ngroup = "low"\nux = true\nuy = true\n'
                                     '[[support]]\ngroup = "high"\nux = true\nuy = 1.0e-3\n'), self.folder / f"out{events}"
            done = equidem("quasistatic", case, "--out", out, NO_PICTURE)
            result = result_in(out)
            self.assertEqual(done.returncode, 0 if events else 1, done.stderr)
            self.assertEqual((result["event_count"], result["end"], result["complete"]), (events, "failed", False))
            for text in (result["ended"], result["report"] if "report" in result else done.stdout):
                self.assertIn("leave the range of numbers", flat(text))
            self.assertEqual((len(rows_of(out / "events.csv")), len(result["curve"]["load"])), (events, events + 1))
            self.check_there(out, "curve.csv", "discs.csv", "contacts.csv")


class Friction(QuasistaticTest):
    def unbonded(self, discs, contacts, groups, actions, friction):
        """Energies of three or more discs without bonds, kN = 1e9 Pa, kT half of it."""
        result = self.path_of(f'[strength]\nfriction = {friction}\nafter_breaking = "frictional"\n{actions}[quasistatic]\nlegs = [1.0]\n',
                              discs=discs, contacts=[[i, j, 0, 0] for i, j in contacts], springs=[[1e9, 0.5e9]] * len(contacts),
                              strengths=[[0, 0]] * len(contacts), groups=groups)
        self.assertEqual(result["end"], "legs_done")
        return result["energies"]

    def slow_run(self, grains, around, friction, rest):
        """The energies of the same discs between walls, stepped in time until they are at rest."""
        bodies = "".join(f"[[grain]]\nposition = [{x}, {y}]\nradius = {r}\n" for x, y, r in grains)
        return self.result("run", self.write(f'[grains]\ndensity = 2500.0\n{bodies}[collisions]\nlaw = "exact_flow"\ndamping = 0.5\n'
                                             f"stiffness = 1e9\nfriction = {friction}\ntangential_ratio = 0.5\n{around}[run]\n{rest}"),
                           NO_PICTURE)["energy"]

    def test_a_pyramid_that_nothing_slips_in_rests_as_a_slow_run_leaves_it(self):
        r, x, friction = 0.02, 0.021, 0.8
        top = r + math.sqrt(4 * r * r - x * x)
        weight = 2500.0 * math.pi * r * r * 9.81
        moved = self.slow_run([(-x, r, r), (x, r, r), (0, top, r)], walls(("floor", 0.0, 0.0, 0.0, 1.0, "")), friction,
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
            push = f'displacement = {way}\ndirection = [{along[0]}, {along[1]}]\nschedule = "push"\n'
            around = walls(("floor", 0.0, 0.0, 0.0, 1.0, ""), ("left", 0.0, 0.0, 1.0, 0.0, ""),
                           ("piston", r - r * normal[0], r - r * normal[1], *normal, push))
            moved = self.slow_run([(r, r, r)], around + '[[schedule]]\nname = "push"\nkind = "ramp"\nstart = 0.0\nend = 0.2\n',
                                  friction, "duration = 0.21\n")
            still = self.unbonded([[r, r, r], [r, -r, r], [-r, r, r], [r - 2 * r * normal[0], r - 2 * r * normal[1], r]],
                                  [(1, 0), (2, 0), (3, 0)], {"walls": [1, 2], "piston": [3]},
                                  '[[support]]\ngroup = "walls"\nux = true\nuy = true\nrotation = true\n'
                                  f'[[support]]\ngroup = "piston"\nux = {way * along[0]}\nuy = {way * along[1]}\nrotation = true\n', friction)
            self.assertGreater(still["friction"], 0.01 * still["elastic"])
            self.assertAlmostEqual(still["elastic"] / moved["elastic"], 1, delta=1e-6)
            # While the piston moves the dashpot adds to the normal force, and so to friction.
            self.assertAlmostEqual(still["friction"] / moved["lost_slip"], 1, delta=0.002)

    def test_broken_frictional_contacts_open_close_slip_and_stick(self):
        command = ("quasistatic", FRICTIONAL, NO_PICTURE, "quasistatic.max_events=150", "--out", self.folder / "out")
        result = self.result(*command)
        self.assertLess(result["energies"]["error"], 1e-10)
        self.assertGreater(result["energies"]["friction"], 0)
        self.assertLess(result["relative_residual"], 1e-12)
        table = self.folder / "out" / "events.csv"
        rows, text = rows_of(table), table.read_text()
        self.assertEqual(len(rows), result["event_count"])
        self.assertLessEqual({"slip", "stick"}, {row["mode"] for row in rows})
        self.assertIn("friction_N", rows[0])
        self.assertIn(f"going on behind {len(rows)} events", self.done(*command, "--resume").stderr)
        self.assertEqual(table.read_text(), text)
        lines = text.splitlines(keepends=True)
        table.write_text("".join(lines[:4] + lines[5:]))
        self.check_error(equidem(*command, "--resume"), 2, "rows are missing")
        self.assertEqual(self.result("quasistatic", FRICTIONAL, "--dry-run")["method"], "umfpack")
        self.check_errors(("quasistatic.control=path", "depends on the path"), ("springs.kT=-1e9", "kT < 0"),
                          ("solver.method=cholmod", "umfpack alone", "solver.method"),
                          ("strength.residual_friction=-1", "residual_friction"), before=("quasistatic", FRICTIONAL))
        self.check_error(equidem("quasistatic", FRICTIONAL, "solver.memory_limit=1e5"), 1, "are allowed by memory_limit")

    def test_forces_at_rest_that_a_limit_of_friction_needs_are_told(self):
        pressed, friction = 100.0, 0.5
        self.write_assembly("pair.json", discs=[[0, 0, 0.5], [1, 0, 0.5]], contacts=[[0, 1, 0, 0]], springs=[[1e6, 4e5]],
                            strengths=[[0, 0]], forces=[[-pressed, 0]], groups={"f": [0], "b": [1]})
        held = '[[support]]\ngroup = "f"\nux = true\nuy = true\nrotation = true\n[[support]]\ngroup = "b"\nrotation = true\n' \
            '[[load]]\ngroup = "b"\nforce = [0.0, 1.0]\n[quasistatic]\nlegs = [60.0]\n'
        result = self.result("quasistatic", self.of_file(
            "pair.json", f'[strength]\nafter_breaking = "frictional"\nresidual_friction = {friction}\n{held}'))
        self.assertAlmostEqual(result["events"][0]["lambda"], friction * pressed, delta=1e-9)
        self.assertRegex(result["report"], "forces at rest +contacts begin with them")
        self.assertNotIn("not used", result["report"])
        self.assertIn("have friction 0.5", flat(result["report"]))
        self.assertEqual(result["strength"]["residual_friction"], friction)
        self.assertFalse(result["prestress"]["counts"])
        gone = self.of_file("pair.json", f"[strength]\nfriction = {friction}\n{held}")
        self.assertRegex(self.report("quasistatic", gone), "not used forces at rest: .*quasistatic with")

    def test_a_load_that_contacts_do_not_carry_ends_the_path_at_once(self):
        case = self.write(block(10, 12, """[strength]
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
"""))
        self.assertIn("no consistent contact state found", self.result("quasistatic", case)["ended"])

    def test_the_motion_that_a_load_drives_is_named_as_what_it_is(self):
        ended = self.path_of("""[springs]
kN = 2.0e6
kT = 1.0e6
[strength]
after_breaking = "frictional"
residual_friction = 0.4
[[support]]
group = "ground"
ux = true
uy = true
rotation = true
[[dead_load]]
group = "top"
force = [0.0, -3.0]
[[load]]
group = "top"
force = [0.2, 0.0]
[quasistatic]
legs = [1.0]
""", discs=[[-0.3, 0.25, 0.25], [0.3, 0.25, 0.25], [0, 0.65, 0.25], [-0.3, -0.25, 0.25], [0.3, -0.25, 0.25]],
                             contacts=[[0, 2, 0, 0], [1, 2, 0, 0], [0, 3, 0, 0], [1, 4, 0, 0]],
                             strengths=[[1e9, 1e9], [1e9, 1e9], [0, 0], [0, 0]], groups={"top": [2], "ground": [3, 4]})["ended"]
        self.assertIn("a motion of ", ended)
        self.assertNotIn("slip", ended)


class Refusals(QuasistaticTest):
    def test_what_is_missing_or_contradictory(self):
        self.check_errors(
            ((CASES / "random_cell.toml",), "strengths are missing"),
            ((NOTCH, "notch.0.to=[-0.0005,0.0152]"), "crosses no contact"),
            ((NOTCH, "strength.tension=-1"), "strength.tension"),
            *(((NOTCH, f"springs.kN={size}", f"springs.kT={size}"), "the largest spring", "leave the range of numbers", "Pa")
              for size in ("1e-300", "1e300")),
            ((NOTCH, "support.1.uy=true"), "nothing grows with lambda"),
            ((NOTCH, "springs.kT=-1e8"), "kT < 0", "Take kT >= 0"),
            ((NOTCH, "support.1.uy=1e300"), "the size of the motions of supports is 1e+300", "range of numbers"),
            ((NOTCH, "quasistatic.legs=[0.0]"), "quasistatic.legs", "nothing happens on it"), before=("quasistatic",))

    def test_refusals_name_the_line_and_the_key(self):
        plate = NOTCH.read_text()
        pulled = plate.replace('[[support]]\ngroup = "top"\nuy = 1.0e-6               # m, times lambda\n',
                               '[[load]]\ngroup = "top"\nkind = "total"\nforce = [0.0, 1.0e5]\n')
        cell = ('schema = "equidem/1"\n[assembly]\nkind = "hexagonal"\ncolumns = 8\nrows = 8\nradius = 0.5\n'
                'periodic = true\n[springs]\nkN = 1e9\nkT = 3e8\n[strength]\ntension = 1e6\nshear = 2e6\n')
        one = '[[group]]\nname = "one"\ndiscs = [0]\n[[dead_load]]\ngroup = "one"\nforce = [1.0, 0.0]\n'
        for text, at, key, words in (
                (plate.replace("uy = 1.0e-6", "uy = 0.0"), "[[support]]", "support", "nothing grows with lambda"),
                (cell + "[strain]\nxx = 0.0\n", "[strain]", "strain", "nothing grows with lambda"),
                (plate + "[strain]\nxx = 1e-3\n", "[strain]", "strain", "not periodic"),
                (plate + '[[load]]\ngroup = "left"\nforce = [1.0, 0.0]\n', "[[load]]", "load", "grow with lambda together"),
                (cell + "[strain]\nxx = 1e-3\n" + one, "[[dead_load]]", "dead_load", "cannot carry its loads"),
                (pulled.replace("0.008, 0.0152", "1.0, 0.0152"), "[[load]]", "load", "cannot carry its loads"),
                (plate.replace("kT = 3.0e9", "kT = -1.0e8"), "[springs]", "springs", "kT < 0"),
                (plate.replace("tension         = 10.0e3", "#"), "[strength]", "strength", "one of two strengths is missing"),
                (plate.replace("weibull_modulus = 8.0", "weibull_modulus = 1e-3"), "[strength]", "strength", "scatters them"),
                (plate.replace("friction        = 0.5", 'friction = 0.5\nafter_breaking = "frictional"'), "control",
                 "quasistatic.control", "their state depends on"),
                (plate.replace('"path"', '"motion"\nlegs = [1.0, 1.0]'), "legs", "quasistatic.legs", "nothing happens"),
                (plate.replace("from = [-0.001, 0.0152]", "from = [1.0, 1.0]").replace("0.008, 0.0152", "2.0, 2.0"),
                 "[[notch]]", "notch", "crosses no contact")):
            line = 1 + next(k for k, row in enumerate(text.splitlines()) if row.startswith(at))
            with self.subTest(key=key, words=words):
                self.refused(text, f"case.toml:{line}: {key}", words, verb="quasistatic")


if __name__ == "__main__":
    unittest.main()
