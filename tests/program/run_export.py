#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""equidem export, as a user runs it: run_export.py PROGRAM SOURCE_FOLDER [unittest options]."""
import csv
import json
import math
import re
import unittest

from program import CASES, SOURCE, TENSION, ProgramTest, equidem, parse_json

FILES = {"lammps": {"in.equidem", "assembly.data", "load_x.txt"}, "yade": {"run_equidem.py"}}
ENGINES = tuple(FILES)
GRAINS = '''schema = "equidem/1"
[grains]
density = 2500.0
[[grain]]
position = [0.0, 0.01]
radius = 0.01
[[grain]]
position = [0.021, 0.01]
radius = {radius}
[collisions]
law = "linear_dashpot"
stiffness = 1e6
restitution = {restitution}
{collisions}
[[wall]]
name = "floor"
point = [0.0, 0.0]
normal = {normal}
[run]
duration = 1e-3
{run}
'''
BONDS = '''schema = "equidem/1"
[assembly]
kind = "hexagonal"
columns = 4
rows = 4
radius = 0.005
density = 2500.0
{assembly}
[springs]
kN = 1e9
kT = {kT}
[[support]]
group = "bottom"
ux = true
uy = true
[[load]]
group = "top"
force = [1.0, 0.0]
{load}
'''


class ExportTest(ProgramTest):
    def bonds(self, further="", **parts):
        case = self.folder / "bonds.toml"
        case.write_text(BONDS.format(**{"assembly": "", "kT": 0.5e9, "load": "", **parts}) + further)
        return case

    def weighted(self):
        """A random network with springs of its own at each contact."""
        text = self.bonds(kT='0.5e9\nweighting = "voronoi"').read_text()
        case = self.folder / "weighted.toml"
        case.write_text(text.replace('kind = "hexagonal"\ncolumns = 4\nrows = 4', 'kind = "delaunay"\ndiscs = 40'))
        return case

    def grains(self, further="", **parts):
        case = self.folder / "grains.toml"
        case.write_text(GRAINS.format(**{"radius": 0.01, "restitution": 1.0, "collisions": "", "normal": "[0.0, 1.0]",
                                         "run": "", **parts}) + further)
        return case

    def export(self, case, engine, *options, out="out"):
        return equidem("export", case, "--to", engine, "--out", self.folder / out, *options)

    def exported(self, case, engine, *options, out="out"):
        self.check_done(self.export(case, engine, *options, out=out))
        return self.folder / out

    def check_refused(self, case, engines, *words):
        for engine in ENGINES:
            with self.subTest(engine=engine):
                out = f"refused_{engine}_{len(list(self.folder.iterdir()))}"
                done = self.export(case, engine, out=out)
                if engine in engines:
                    name = {"lammps": "LAMMPS", "yade": "YADE"}[engine]
                    self.check_error(done, 2, f"the export to {name} does not carry", *words)
                    self.assertEqual(list((self.folder / out).glob("*")), [])
                else:
                    self.check_done(done)


class Folders(ExportTest):
    def test_a_folder_holds_the_model_a_readme_of_three_lines_and_the_case(self):
        for engine, files in FILES.items():
            out = self.exported(TENSION, engine, out=engine)
            self.assertEqual({path.name for path in out.iterdir()}, files | {"README", "case.toml", "result.json"})
            readme = (out / "README").read_text()
            self.assertEqual(readme.count("\n"), 3, readme)
            for word in ("431 discs and 1210 bonds", "one metre of depth", "Time step"):
                self.assertIn(word, readme)
            result = parse_json((out / "result.json").read_text())
            self.assertEqual((result["discs"], result["bonds"], result["format"]), (431, 1210, engine))

    def test_the_same_case_gives_the_same_bytes(self):
        for engine, files in FILES.items():
            first, second = (self.exported(TENSION, engine, out=f"{engine}_{k}") for k in (1, 2))
            for name in files | {"README"}:
                self.assertEqual((first / name).read_bytes(), (second / name).read_bytes(), name)

    def test_numbers_read_back_to_the_same_bits(self):
        text = (self.exported(self.bonds(), "lammps") / "assembly.data").read_text()
        atoms = text.split("Atoms # bpm/sphere\n\n")[1].split("\n\n")[0].splitlines()
        self.check_done(equidem("solve", self.bonds(), "--out", self.folder / "solved"))
        with open(self.folder / "solved" / "discs.csv") as file:
            places = [(row["x_m"], row["y_m"]) for row in csv.DictReader(file)]
        self.assertEqual([tuple(float(word) for word in line.split()[5:7]) for line in atoms],
                         [tuple(map(float, place)) for place in places])

    def test_files_of_the_user_stay(self):
        out = self.exported(self.bonds(), "yade")
        (out / "notes.txt").write_text("mine")
        script = out / "run_equidem.py"
        script.write_text("changed")
        self.check_error(self.export(self.bonds(), "yade"), 2, "exists", "--overwrite")
        self.assertEqual(script.read_text(), "changed")
        self.exported(self.bonds(), "yade", "--overwrite")
        self.assertIn("CohFrictMat", script.read_text())
        self.assertEqual((out / "notes.txt").read_text(), "mine")

    def test_one_file_that_exists_keeps_all_others_from_being_written(self):
        out = self.folder / "out"
        out.mkdir()
        (out / "assembly.data").write_text("mine")
        self.check_error(self.export(self.bonds(), "lammps"), 2, "assembly.data", "exists")
        self.assertEqual([path.name for path in out.iterdir()], ["assembly.data"])

    def test_a_dry_run_tells_the_size_and_writes_nothing(self):
        done = self.check_done(equidem("export", TENSION, "--to", "lammps", "--dry-run", "--json", "-"))
        self.assertEqual(parse_json(done.stdout)["bonds"], 1210)

    def test_formats_and_options_that_are_missing_or_unknown(self):
        self.check_error(self.export(TENSION, "lamps"), 2, "'lamps'", 'mean "lammps"')
        self.check_error(self.export(TENSION, "pfc"), 2, "'pfc'", "earlier version", "equidem calibrate")
        self.check_error(equidem("export", TENSION, "--to", "yade"), 2, "--out")
        self.check_error(equidem("export", TENSION, "--out", self.folder / "x"), 2, "--to")
        self.check_error(self.export(CASES / "pack_jammed.toml", "yade"), 2, "assembly")
        self.check_error(self.export(CASES / "hexagonal_cell.toml", "lammps"), 2, "nothing pulls or holds")


class Models(ExportTest):
    def test_masses_springs_and_the_step_are_those_of_equidem(self):
        case = self.bonds("[run]\nduration = 1e-3\n")
        run = parse_json(self.check_done(equidem("run", case, "--dry-run", "--json", "-")).stdout)
        mass = 2500 * math.pi * 0.005**2
        script = (self.exported(case, "yade", out="yade") / "run_equidem.py").read_text()
        self.assertEqual(float(re.search(r"O.dt = (\S+)", script).group(1)), run["time_step"])
        row = re.search(r'BODIES = """\n(.*?)\n', script).group(1).split()
        self.assertAlmostEqual(float(row[3]), mass, delta=1e-14 * mass)
        self.assertAlmostEqual(float(row[4]), mass * 0.005**2 / 2, delta=1e-18)
        self.assertEqual(row[12:], ["0", "0", "-"])
        data = (self.exported(case, "lammps", out="lammps") / "assembly.data").read_text()
        atom = data.split("Atoms # bpm/sphere\n\n")[1].split()
        volume = 4 / 3 * math.pi * (float(atom[3]) / 2)**3
        self.assertAlmostEqual(float(atom[4]) * volume, mass, delta=1e-14 * mass)

    def test_lammps_has_a_bond_type_for_each_pair_of_springs(self):
        out = self.exported(self.weighted(), "lammps")
        script = (out / "in.equidem").read_text()
        bonds = parse_json((out / "result.json").read_text())["bonds"]
        types = int(re.search(r"(\d+) bond types", (out / "assembly.data").read_text()).group(1))
        self.assertEqual(len(re.findall(r"^bond_coeff", script, re.M)), types)
        self.assertGreater(types, bonds // 2)

    def test_a_density_that_is_not_given_is_assumed_in_statics_and_said(self):
        self.assertIn("density 2500 kg/m³ assumed", self.check_done(self.export(TENSION, "yade")).stdout)
        self.assertNotIn("assumed", self.check_done(self.export(self.bonds(), "yade", out="given")).stdout)

    def test_lammps_dashpots_are_those_of_the_reduced_mass(self):
        out = self.exported(self.grains(restitution=0.5), "lammps")
        script = (out / "in.equidem").read_text()
        coefficients = re.search(r"pair_style gran/hooke/history (.*)", script).group(1).split()
        low, high = 0.0, 0.7
        for _ in range(60):  # contacts end at zero force: Schwager & Poeschel (2007)
            zeta = (low + high) / 2
            root = math.sqrt(1 - zeta**2)
            e = math.exp(-zeta / root * (math.pi - math.atan2(2 * zeta * root, 1 - 2 * zeta**2)))
            low, high = (zeta, high) if e > 0.5 else (low, zeta)
        reduced = 2500 * math.pi * 0.01**2 / 2
        self.assertAlmostEqual(float(coefficients[2]), 2 * zeta * math.sqrt(1e6 / reduced), delta=1e-9)
        self.assertIn("limit_damping", script)
        graded = self.grains(restitution=0.5, radius=0.008)
        script = (self.exported(graded, "lammps", "--overwrite") / "in.equidem").read_text()
        self.assertIn("pair_style granular", script)

    def test_rolling_resistance_is_the_spring_dashpot_and_slider_of_lammps_at_the_reduced_radius(self):
        """The force at R, k = rolling_ratio kN, limited by mu_r N; the dashpot 2 zeta sqrt(k m') with 1/m' = R²(1/I_i + 1/I_j): of two
        equal discs, R = r/2 and I = m r²/2, m' is the mass of one; at a wall, R = r, half of it."""
        case = self.grains(collisions="rolling_friction = 0.2\nrolling_ratio = 0.5\nrolling_damping = 0.1")
        script = (self.exported(case, "lammps") / "in.equidem").read_text()
        mass = 2500 * math.pi * 0.01**2
        pair, wall = (re.search(pattern + r".* rolling sds (\S+) (\S+) (\S+) ", script).groups() for pattern in ("pair_coeff", "wall/gran/region"))
        for given, share in ((pair, 1), (wall, 0.5)):
            self.assertEqual((float(given[0]), float(given[2])), (0.5e6, 0.2))
            self.assertAlmostEqual(float(given[1]) / (2 * 0.1 * math.sqrt(0.5e6 * share * mass)), 1, delta=1e-12)
        smooth = (self.exported(self.grains(), "lammps", "--overwrite") / "in.equidem").read_text()
        self.assertNotIn("rolling", smooth)


class Refusals(ExportTest):
    """What an engine does not carry is named, with what to do."""

    def test_negative_tangential_springs(self):
        self.check_refused(self.bonds(kT=-1e8), ENGINES, "here negative kT of contact 0", "equidem solve")

    def test_contact_points_off_the_middle(self):
        discs = [[0, 0, 2.0], [3, 0, 1.0], [1.5, 2.6, 1.0]]
        lengths = [math.dist(discs[i][:2], discs[j][:2]) for i, j in ((0, 1), (0, 2), (1, 2))]
        text = {"schema": "equidem-assembly/1", "discs": discs, "contacts": [[0, 1, 0, 0], [0, 2, 0, 0], [1, 2, 0, 0]],
                "levers": [[2.0, 1.0], [(lengths[1] + 1) / 2, (lengths[1] - 1) / 2], [lengths[2] / 2] * 2],
                "groups": {"foot": [0], "side": [1], "head": [2]}}
        case = self.folder / "three.toml"
        case.write_text('''schema = "equidem/1"
[assembly]
kind = "file"
path = "three.json"
[springs]
kN = 1e9
kT = 1e8
[[support]]
group = "foot"
ux = true
uy = true
[[support]]
group = "side"
uy = true
[[load]]
group = "head"
force = [0.0, -1.0]
''')
        (self.folder / "three.json").write_text(json.dumps(text))
        self.check_refused(case, ["lammps"], "off the middle", "contact 0", "Export to yade")
        text["levers"][2] = [0.3 * lengths[2], 0.7 * lengths[2]]
        (self.folder / "three.json").write_text(json.dumps(text))
        for engine in ENGINES:
            self.check_error(self.export(case, engine, out=engine + "_levers"), 2, "does not carry")
        text["levers"][2] = [0.1 * lengths[2], 0.1 * lengths[2]]
        (self.folder / "three.json").write_text(json.dumps(text))
        self.check_error(self.export(case, "yade", out="gaps"), 2, "levers")

    def test_unequal_discs_bonded_across_gaps_are_exported_with_the_levers_of_the_engine(self):
        (self.folder / "gaps.csv").write_text("x,y,radius\n0,0,1\n3.1,0,2\n1.4,2.9,2\n")
        case = self.folder / "gaps.toml"
        text = '''schema = "equidem/1"
[assembly]
kind = "file"
path = "gaps.csv"
unit_of_length = "mm"
gap_tolerance = 0.1
{levers}
[springs]
kN = 1e9
kT = 0.5e9
[[support]]
group = "bottom"
ux = true
uy = true
[[load]]
group = "top"
force = [0.0, 1.0]
'''
        case.write_text(text.format(levers=""))
        for engine in ("lammps", "yade"):
            self.check_error(self.export(case, engine), 2, "assembly.levers", "middle", "halfway")
        for levers, engine in (("middle", "yade"), ("halfway", "lammps"), ("halfway", "yade")):
            with self.subTest(levers=levers, engine=engine):
                case.write_text(text.format(levers=f'levers = "{levers}"'))
                out = self.exported(case, engine, out=f"{levers}_{engine}")
                self.assertTrue((out / "README").exists())
        case.write_text(text.format(levers='levers = "middle"'))
        self.check_error(self.export(case, "lammps", out="no"), 2, "halfway")
        script = (self.folder / "middle_yade" / "run_equidem.py").read_text()
        for radius in ("0.001", "0.002"):  # contact points of YADE: (d + r_i - r_j)/2 by the radii of its bodies
            self.assertIn(radius, script)
        for levers in ("radii", "middle", "halfway"):
            out = self.folder / f"solved_{levers}"
            case.write_text(text.format(levers=f'levers = "{levers}"'))
            self.check_done(equidem("solve", case, "--out", out))
            with open(out / "contacts.csv", encoding="utf-8") as table:
                rows = list(csv.DictReader(table))
            discs = [(0, 0, 1e-3), (3.1e-3, 0, 2e-3), (1.4e-3, 2.9e-3, 2e-3)]
            for row in rows:
                i, j = int(row["i"]), int(row["j"])
                d = math.dist(discs[i][:2], discs[j][:2])
                a, b = discs[i][2], discs[j][2]
                wanted = {"radii": d * a / (a + b), "middle": (d + a - b) / 2, "halfway": d / 2}[levers]
                self.assertAlmostEqual(float(row["lever_i_m"]), wanted, delta=1e-12 * d)
                self.assertAlmostEqual(float(row["lever_i_m"]) + float(row["lever_j_m"]), d, delta=1e-12 * d)
        packing = ("homogenize", CASES / "packed_rock.toml", "--set", "packing.grains=200", "--set", "packing.solid_fraction=0.78",
                   "--set", "material=none", "--set", "springs={kN=1e9,kT=0.5e9}", "--json", "-")
        bulk = {levers: parse_json(self.check_done(equidem(*packing, "--set", f'assembly.levers="{levers}"')).stdout)["bulk_modulus_2d"]
                for levers in ("radii", "middle", "halfway")}
        self.assertEqual(bulk["radii"], parse_json(self.check_done(equidem(*packing)).stdout)["bulk_modulus_2d"])
        self.assertTrue(1e-7 < abs(bulk["middle"] / bulk["radii"] - 1) < 1e-3, bulk)
        self.assertTrue(1e-4 < abs(bulk["halfway"] / bulk["radii"] - 1) < 1e-2, bulk)

    def test_ellipses_and_clumps(self):
        self.check_refused(CASES / "grains_ellipses.toml", ENGINES, "neither discs nor spheres", "here grain 1")

    def test_laws_of_collision(self):
        case = self.grains()
        case.write_text(case.read_text().replace("linear_dashpot", "exact_flow"))
        self.check_refused(case, ENGINES, "laws of contact other than one linear spring", "here the law exact_flow")

    def test_dashpots_and_friction(self):
        self.check_refused(self.grains(restitution=0.5), [])
        self.check_refused(self.grains(restitution=0.5, radius=0.008), ["yade"], "restitution below 1", "of bodies of unequal masses", "lammps")
        self.check_refused(self.grains(restitution=0.5, collisions="[collisions.walls]\nrestitution = 0.9"), ["yade"],
                           "pair to pair")

    def test_rolling_and_cohesion(self):
        self.check_refused(self.grains(collisions="rolling_friction = 0.2"), ["yade"], "rolling resistance, here with the coefficient 0.2", "lammps")
        self.check_refused(self.grains(radius=0.008, collisions="rolling_friction = 0.2\nrolling_damping = 0.3"), ENGINES, "rolling")
        self.check_refused(self.grains(collisions="cohesion = 3.0\ncohesion_range = 1e-3"), ENGINES, "cohesion of 3 within 0.001 m")

    def test_friction_is_exported_only_where_its_levers_are_accepted(self):
        case = self.grains(collisions="friction = 0.3")
        self.check_refused(case, ENGINES, "friction of bodies that overlap, here with the coefficient 0.3", "--accept friction",
                           "0.7 per cent")
        for engine in ENGINES:
            out = self.exported(case, engine, "--accept", "friction", out=f"accepted_{engine}")
            self.assertIn("Accepted: friction", (out / "README").read_text())
        self.check_error(self.export(case, "lammps", "--accept", "ellipses"), 2, "ellipses", "--accept friction")
        self.check_error(self.export(TENSION, "matrix-market", "--accept", "friction"), 2, "--accept", "Leave it out")
        smooth = self.grains(collisions="friction = 0.0")
        self.check_done(self.export(smooth, "lammps", out="smooth"))

    def test_walls_that_move(self):
        moving = 'displacement = 0.01\ndirection = [0.0, 1.0]\nschedule = "push"\n'
        schedule = '[[schedule]]\nname = "push"\nkind = "{}"\n'
        def case(text):
            given = self.grains(text)
            given.write_text(given.read_text().replace("[run]\n", moving + "[run]\n"))
            return given
        for kind in ("ramp", "sine"):
            self.check_refused(case(schedule.format(kind) + ("end = 1e-3\n" if kind == "ramp" else "frequency = 50.0\n")), [])
        points = f"times = {[1e-5 * k for k in range(60)]}\nvalues = {[1e-4 * k for k in range(60)]}\n"
        self.check_refused(case(schedule.format("table") + points), ENGINES, "does not carry", "wall 'floor'")

    def test_walls(self):
        self.check_refused(self.grains(normal="[0.1, 1.0]"), ["yade"], "not parallel to an axis", "wall 'floor'")

    def test_schedules_and_moments(self):
        schedule = '[[schedule]]\nname = "slow"\nkind = "ramp"\nend = 1e-3\n[run]\nduration = 1e-3\n'
        self.check_refused(self.bonds(schedule, load='schedule = "slow"'), [])
        rest = schedule.replace("duration = 1e-3", "until_rest = 1e-6")
        self.check_refused(self.bonds(rest, load='schedule = "slow"'), ENGINES, "does not carry")
        turning = schedule + '[[support]]\ngroup = "top"\nrotation = 1e-3\nschedule = "slow"\n'
        self.check_refused(self.bonds(turning), ["lammps"], "rotations that follow a schedule", "support of 'top'")
        long = schedule.replace('"ramp"\nend = 1e-3', f'"table"\ntimes = {[1e-5 * k for k in range(60)]}\nvalues = {[0.0] * 60}')
        self.check_refused(self.bonds(long, load='schedule = "slow"'), ENGINES, "does not carry", "load on 'top'")
        self.check_refused(self.bonds(load="moment = 1.0"), ["lammps"], "moments as loads", "yade")

    def test_bonds_that_break(self):
        for table in ("[strength]\ntension = 1.0\nshear = 2.0\n", '[[dead_load]]\ngroup = "top"\nforce = [0.0, 1.0]\n',
                      "[[notch]]\nfrom = [0.0, 0.0]\nto = [0.01, 0.0]\n"):
            with self.subTest(table):
                self.check_refused(self.bonds(table), ENGINES, "strengths, notches or dead loads")

    def test_damping(self):
        run = "[run]\nduration = 1e-3\ndamping = {{ {} }}\n"
        self.check_refused(self.bonds(run.format("mass = 10.0")), ENGINES, "damping proportional to mass", "local")
        self.check_refused(self.bonds(run.format("contact = 0.1")), ["yade"], "dashpots in bonds")
        self.check_refused(self.bonds(run.format("local = 0.1")), [])

    def test_periodic_cells(self):
        cell = self.bonds(assembly="periodic = true").read_text()
        cell = cell[:cell.index("[[support]]")].replace("rows = 4", "rows = 8").replace("columns = 4", "columns = 8")
        (self.folder / "cell.toml").write_text(cell + "[run]\nduration = 1e-4\n")
        self.check_refused(self.folder / "cell.toml", [])
        small = self.folder / "small.toml"
        small.write_text((self.folder / "cell.toml").read_text().replace("columns = 8", "columns = 2"))
        self.check_error(self.export(small, "lammps", out="small"), 2, "does not carry")

    def test_spheres_and_springs_that_differ(self):
        self.check_refused(self.bonds(assembly='body = "sphere"'), [])
        self.check_refused(self.weighted(), [])

    def test_several_load_cases(self):
        case = self.bonds('case = "a"\n[[load]]\ngroup = "top"\nforce = [0.0, 1.0]\ncase = "b"\n')
        self.check_error(self.export(case, "yade"), 2, "2 load cases")


class Pages(ExportTest):
    def test_the_page_shows_the_table_of_the_program(self):
        table = self.check_done(equidem("help", "engines")).stdout.strip()
        self.assertIn(table, (SOURCE / "docs" / "how_to" / "engines.md").read_text())
        self.assertGreater(table.count("\n"), 12)


if __name__ == "__main__":
    unittest.main()
