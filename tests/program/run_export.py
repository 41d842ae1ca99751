# SPDX-License-Identifier: GPL-3.0-or-later
"""equidem export to LAMMPS and YADE, as a user runs it: run_export.py PROGRAM SOURCE_FOLDER [unittest options]."""
import math
import re
import unittest

from program import CASES, SOURCE, TENSION, ProgramTest, equidem, result_in, rows_of
from scenes import grain, schedule, wall

FILES = {"lammps": {"in.equidem", "assembly.data", "load_x.txt"}, "yade": {"run_equidem.py"}}
ENGINES = tuple(FILES)
LEVERS = ("radii", "middle", "halfway")
RAMP = schedule("slow", "ramp", "end = 1e-3\n")
MANY = f"times = {[1e-5 * k for k in range(60)]}\nvalues = {[1e-4 * k for k in range(60)]}\n"
RUN = "[run]\nduration = 1e-3\n"


class ExportTest(ProgramTest):
    def bonds(self, further="", assembly="", kT=0.5e9, load=""):
        return self.write(f"""[assembly]
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
{further}""", "bonds.toml")

    def weighted(self):
        """A random network with springs of its own at each contact."""
        text = self.bonds(kT='0.5e9\nweighting = "voronoi"').read_text()
        return self.write(text.replace('kind = "hexagonal"\ncolumns = 4\nrows = 4', 'kind = "delaunay"\ndiscs = 40'), "weighted.toml")

    def grains(self, radius=0.01, restitution=1.0, law="linear_dashpot", collisions="", normal="[0.0, 1.0]", moving="", further=""):
        floor = wall("floor", (0.0, 0.0), (0.0, 1.0), moving).replace("[0.0, 1.0]", normal, 1)
        return self.write("[grains]\ndensity = 2500.0\n" + grain(0.0, 0.01) + grain(0.021, 0.01, radius) +
                          f'[collisions]\nlaw = "{law}"\nstiffness = 1e6\nrestitution = {restitution}\n{collisions}\n{floor}{RUN}{further}',
                          "grains.toml")

    def export(self, case, engine, *options, out="out"):
        return equidem("export", case, "--to", engine, "--out", self.folder / out, *options)

    def exported(self, case, engine, *options, out="out"):
        self.check_done(self.export(case, engine, *options, out=out))
        return self.folder / out

    def script(self, case, engine="lammps", *options):
        file = {"lammps": "in.equidem", "yade": "run_equidem.py"}[engine]
        return (self.exported(case, engine, "--overwrite", *options) / file).read_text()

    def check_refused(self, case, engines, *words):
        """Refused by these engines, with nothing written; the others take it."""
        for engine in ENGINES:
            with self.subTest(engine=engine, words=words):
                out = f"refused_{engine}_{len(list(self.folder.iterdir()))}"
                done = self.export(case, engine, out=out)
                if engine in engines:
                    name = {"lammps": "LAMMPS", "yade": "YADE"}[engine]
                    self.check_error(done, 2, f"the export to {name} does not carry", *words)
                    self.assertEqual(list((self.folder / out).glob("*")), [])
                else:
                    self.check_done(done)


class Folders(ExportTest):
    def test_a_folder_holds_the_model_a_readme_of_three_lines_and_the_case_in_the_same_bytes_each_time(self):
        for engine, files in FILES.items():
            out, again = (self.exported(TENSION, engine, out=f"{engine}_{k}") for k in (1, 2))
            self.assertEqual({path.name for path in out.iterdir()}, files | {"README", "case.toml", "result.json"})
            readme = (out / "README").read_text()
            self.assertEqual(readme.count("\n"), 3, readme)
            for word in ("431 discs and 1210 bonds", "one metre of depth", "Time step"):
                self.assertIn(word, readme)
            result = result_in(out)
            self.assertEqual((result["discs"], result["bonds"], result["format"]), (431, 1210, engine))
            self.check_same_files(out, again, *files, "README")

    def test_numbers_read_back_to_the_same_bits(self):
        text = (self.exported(self.bonds(), "lammps") / "assembly.data").read_text()
        atoms = text.split("Atoms # bpm/sphere\n\n")[1].split("\n\n")[0].splitlines()
        self.done("solve", self.bonds(), "--out", self.folder / "solved")
        self.assertEqual([tuple(float(word) for word in line.split()[5:7]) for line in atoms],
                         [(float(row["x_m"]), float(row["y_m"])) for row in rows_of(self.folder / "solved" / "discs.csv")])

    def test_formats_and_options_that_are_missing_or_unknown(self):
        out = ("--out", self.folder / "x")
        self.check_errors(((TENSION, "--to", "lamps", *out), "'lamps'", 'mean "lammps"'),
                          ((TENSION, "--to", "pfc", *out), "'pfc'", "earlier version", "equidem calibrate"),
                          ((TENSION, "--to", "yade"), "--out"), ((TENSION, *out), "--to"),
                          ((CASES / "pack_jammed.toml", "--to", "yade", *out), "assembly"),
                          ((CASES / "hexagonal_cell.toml", "--to", "lammps", *out), "nothing pulls or holds"),
                          ((TENSION, "--to", "matrix-market", "--accept", "friction", *out), "--accept", "Leave it out"),
                          before=("export",))

    def test_the_page_shows_the_table_of_the_program(self):
        table = self.done("help", "engines").stdout.strip()
        self.assertIn(table, (SOURCE / "docs" / "how_to" / "engines.md").read_text())
        self.assertGreater(table.count("\n"), 12)


class Models(ExportTest):
    def test_masses_springs_and_the_step_are_those_of_equidem(self):
        case = self.bonds(RUN)
        step = self.result("run", case, "--dry-run")["time_step"]
        mass = 2500 * math.pi * 0.005**2
        script = self.script(case, "yade")
        self.assertEqual(float(re.search(r"O.dt = (\S+)", script).group(1)), step)
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
        types = int(re.search(r"(\d+) bond types", (out / "assembly.data").read_text()).group(1))
        self.assertEqual(len(re.findall(r"^bond_coeff", (out / "in.equidem").read_text(), re.M)), types)
        self.assertGreater(types, result_in(out)["bonds"] // 2)

    def test_a_density_that_is_not_given_is_assumed_in_statics_and_said(self):
        self.assertIn("density 2500 kg/m³ assumed", self.check_done(self.export(TENSION, "yade")).stdout)
        self.assertNotIn("assumed", self.check_done(self.export(self.bonds(), "yade", out="given")).stdout)

    def test_lammps_dashpots_are_those_of_the_reduced_mass(self):
        script = self.script(self.grains(restitution=0.5))
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
        self.assertIn("pair_style granular", self.script(self.grains(restitution=0.5, radius=0.008)))

    def test_rolling_resistance_is_the_spring_dashpot_and_slider_of_lammps_at_the_reduced_radius(self):
        """The force at R, k = rolling_ratio kN, limited by mu_r N; the dashpot 2 zeta sqrt(k m') with 1/m' = R²(1/I_i + 1/I_j): of two
        equal discs, R = r/2 and I = m r²/2, m' is the mass of one; at a wall, R = r, half of it."""
        script = self.script(self.grains(collisions="rolling_friction = 0.2\nrolling_ratio = 0.5\nrolling_damping = 0.1"))
        mass = 2500 * math.pi * 0.01**2
        for pattern, share in (("pair_coeff", 1), ("wall/gran/region", 0.5)):
            spring, dashpot, limit = map(float, re.search(pattern + r".* rolling sds (\S+) (\S+) (\S+) ", script).groups())
            self.assertEqual((spring, limit), (0.5e6, 0.2))
            self.assertAlmostEqual(dashpot / (2 * 0.1 * math.sqrt(0.5e6 * share * mass)), 1, delta=1e-12)
        self.assertNotIn("rolling", self.script(self.grains()))


class Refusals(ExportTest):
    """What an engine does not carry is named, with what to do."""

    def test_springs_and_loads_of_bonds(self):
        rest, turning = RAMP + "[run]\nuntil_rest = 1e-6\n", '[[support]]\ngroup = "top"\nrotation = 1e-3\nschedule = "slow"\n'
        long, damped = schedule("slow", "table", MANY), RUN + "damping = {{ {} }}\n"
        for case, engines, *words in (
                (dict(kT=-1e8), ENGINES, "here negative kT of contact 0", "equidem solve"),
                (dict(load='schedule = "slow"', further=RAMP + RUN), ()),
                (dict(load='schedule = "slow"', further=rest), ENGINES),
                (dict(further=RAMP + RUN + turning), ["lammps"], "rotations that follow a schedule", "support of 'top'"),
                (dict(load='schedule = "slow"', further=long + RUN), ENGINES, "load on 'top'"),
                (dict(load="moment = 1.0"), ["lammps"], "moments as loads", "yade"),
                (dict(further="[strength]\ntension = 1.0\nshear = 2.0\n"), ENGINES, "strength"),
                (dict(further="[strength]\ntension = 1.0\nshear = 2.0\nfriction = 2.0\n"), ("yade",), "strengths of bonds", "lammps"),
                *((dict(further=table), ENGINES, "notches or dead loads") for table in (
                    '[[dead_load]]\ngroup = "top"\nforce = [0.0, 1.0]\n',
                    "[[notch]]\nfrom = [0.0, 0.0]\nto = [0.01, 0.0]\n")),
                (dict(further=damped.format("mass = 10.0")), ENGINES, "damping proportional to mass", "local"),
                (dict(further=damped.format("contact = 0.1")), ["yade"], "dashpots in bonds"),
                (dict(further=damped.format("local = 0.1")), ()),
                (dict(assembly='body = "sphere"'), ())):
            self.check_refused(self.bonds(**case), engines, *words)
        weak = self.bonds("[strength]\ntension = 1.0\nshear = 2.0\nfriction = 0.5\n")
        self.check_error(self.export(weak, "lammps"), 2, "friction 0.5 where shear/tension is 2", "Set strength.friction")
        self.check_refused(self.weighted(), ())
        two = self.bonds('case = "a"\n[[load]]\ngroup = "top"\nforce = [0.0, 1.0]\ncase = "b"\n')
        self.check_error(self.export(two, "yade"), 2, "2 load cases")

    def test_laws_and_walls_of_bodies_that_collide(self):
        moving = 'displacement = 0.01\ndirection = [0.0, 1.0]\nschedule = "slow"\n'
        for case, engines, *words in (
                (dict(law="exact_flow"), ENGINES, "laws of contact other than one linear spring", "here the law exact_flow"),
                (dict(restitution=0.5), ()),
                (dict(restitution=0.5, radius=0.008), ["yade"], "restitution below 1", "of bodies of unequal masses", "lammps"),
                (dict(restitution=0.5, collisions="[collisions.walls]\nrestitution = 0.9"), ["yade"], "pair to pair"),
                (dict(collisions="rolling_friction = 0.2"), ["yade"], "rolling resistance, here with the coefficient 0.2", "lammps"),
                (dict(radius=0.008, collisions="rolling_friction = 0.2\nrolling_damping = 0.3"), ENGINES, "rolling"),
                (dict(collisions="cohesion = 3.0\ncohesion_range = 1e-3"), ENGINES, "cohesion of 3 within 0.001 m"),
                (dict(moving=moving, further=RAMP), ()),
                (dict(moving=moving, further=schedule("slow", "sine", "frequency = 50.0\n")), ()),
                (dict(moving=moving, further=schedule("slow", "table", MANY)), ENGINES, "wall 'floor'"),
                (dict(normal="[0.1, 1.0]"), ["yade"], "not parallel to an axis", "wall 'floor'"),
                (dict(collisions="friction = 0.0"), ())):
            self.check_refused(self.grains(**case), engines, *words)
        self.check_refused(CASES / "grains_ellipses.toml", ENGINES, "neither discs nor spheres", "here grain 1")

    def test_friction_is_exported_only_where_its_levers_are_accepted(self):
        case = self.grains(collisions="friction = 0.3")
        self.check_refused(case, ENGINES, "friction of bodies that overlap, here with the coefficient 0.3",
                           "--accept friction", "0.7 per cent")
        for engine in ENGINES:
            out = self.exported(case, engine, "--accept", "friction", out=f"accepted_{engine}")
            self.assertIn("Accepted: friction", (out / "README").read_text())
        self.check_error(self.export(case, "lammps", "--accept", "ellipses"), 2, "ellipses", "--accept friction")

    def test_periodic_cells(self):
        cell = self.bonds(assembly="periodic = true").read_text()
        cell = cell[:cell.index("[[support]]")].replace("rows = 4", "rows = 8").replace("columns = 4", "columns = 8") + RUN
        self.check_refused(self.write(cell, "cell.toml"), [])
        self.check_error(self.export(self.write(cell.replace("columns = 8", "columns = 2"), "small.toml"), "lammps"), 2,
                         "does not carry")

    def test_contact_points_off_the_middle(self):
        discs = [[0, 0, 2.0], [3, 0, 1.0], [1.5, 2.6, 1.0]]
        lengths = [math.dist(discs[i][:2], discs[j][:2]) for i, j in ((0, 1), (0, 2), (1, 2))]
        case = self.of_file("three.json", '[springs]\nkN = 1e9\nkT = 1e8\n[[support]]\ngroup = "foot"\nux = true\nuy = true\n'
                            '[[support]]\ngroup = "side"\nuy = true\n[[load]]\ngroup = "head"\nforce = [0.0, -1.0]\n', "three.toml")

        def levers(*last):
            self.write_assembly("three.json", discs=discs, contacts=[[0, 1, 0, 0], [0, 2, 0, 0], [1, 2, 0, 0]],
                                levers=[[2.0, 1.0], [(lengths[1] + 1) / 2, (lengths[1] - 1) / 2],
                                        [share * lengths[2] for share in last]],
                                groups={"foot": [0], "side": [1], "head": [2]})
        levers(0.5, 0.5)
        self.check_refused(case, ["lammps"], "off the middle", "contact 0", "Export to yade")
        levers(0.3, 0.7)
        self.check_refused(case, ENGINES)
        levers(0.1, 0.1)
        self.check_error(self.export(case, "yade", out="gaps"), 2, "levers")

    def test_unequal_discs_bonded_across_gaps_are_exported_with_the_levers_of_the_engine(self):
        self.write("x,y,radius\n0,0,1\n3.1,0,2\n1.4,2.9,2\n", "gaps.csv")

        def case(levers):
            key = f'levers = "{levers}"\n' if levers else ""
            return self.of_file("gaps.csv", f'unit_of_length = "mm"\ngap_tolerance = 0.1\n{key}[springs]\nkN = 1e9\nkT = 0.5e9\n[[support]]\n'
                                'group = "bottom"\nux = true\nuy = true\n[[load]]\ngroup = "top"\nforce = [0.0, 1.0]\n')
        for engine in ENGINES:
            self.check_error(self.export(case(""), engine), 2, "assembly.levers", "middle", "halfway")
        for levers, engine in (("middle", "yade"), ("halfway", "lammps"), ("halfway", "yade")):
            self.check_there(self.exported(case(levers), engine, out=f"{levers}_{engine}"), "README")
        self.check_error(self.export(case("middle"), "lammps", out="no"), 2, "halfway")
        script = (self.folder / "middle_yade" / "run_equidem.py").read_text()
        for radius in ("0.001", "0.002"):  # contact points of YADE: (d + r_i - r_j)/2 by the radii of its bodies
            self.assertIn(radius, script)
        discs = [(0, 0, 1e-3), (3.1e-3, 0, 2e-3), (1.4e-3, 2.9e-3, 2e-3)]
        for levers in LEVERS:
            out = self.folder / f"solved_{levers}"
            self.done("solve", case(levers), "--out", out)
            for row in rows_of(out / "contacts.csv"):
                first, second = (discs[int(row[k])] for k in "ij")
                d, a, b = math.dist(first[:2], second[:2]), first[2], second[2]
                wanted = {"radii": d * a / (a + b), "middle": (d + a - b) / 2, "halfway": d / 2}[levers]
                self.assertAlmostEqual(float(row["lever_i_m"]), wanted, delta=1e-12 * d)
                self.assertAlmostEqual(float(row["lever_i_m"]) + float(row["lever_j_m"]), d, delta=1e-12 * d)
        packing = ("homogenize", CASES / "packed_rock.toml", "packing.grains=200", "packing.solid_fraction=0.78", "material=none",
                   "springs={kN=1e9,kT=0.5e9}")
        bulk = {levers: self.result(*packing, f'assembly.levers="{levers}"')["bulk_modulus_2d"] for levers in LEVERS}
        self.assertEqual(bulk["radii"], self.result(*packing)["bulk_modulus_2d"])
        self.assertTrue(1e-7 < abs(bulk["middle"] / bulk["radii"] - 1) < 1e-3, bulk)
        self.assertTrue(1e-4 < abs(bulk["halfway"] / bulk["radii"] - 1) < 1e-2, bulk)


if __name__ == "__main__":
    unittest.main()
