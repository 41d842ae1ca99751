#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""The page of file formats, and files that are read again: run_formats.py PROGRAM SOURCE_FOLDER [unittest options]."""
import csv
import re
import subprocess
import sys
import unittest

import numpy

from motion import RunTest, frames_of, needs_vtk, poly_data
from program import CASES, SOURCE, TENSION, equidem, parse_json

PAGE = (SOURCE / "docs" / "file_formats.md").read_text(encoding="utf-8")
NO_PICTURE = ("--set", "output.files=['csv', 'vtk']")


def section(title):
    return re.search(rf"^## {re.escape(title)}$(.*?)(?=^## |\Z)", PAGE, re.MULTILINE | re.DOTALL)[1]


def names_in_tables(text):
    """Names in the first column of all tables."""
    rows = re.findall(r"^\| (`.*?) \|", text, re.MULTILINE)
    return {name for row in rows for name in re.findall(r"`(\w+)`", row)}


def header_of(path):
    with open(path, newline="") as file:
        return next(csv.reader(file))


class Page(RunTest):
    def example(self, name):
        """Write an example of the page into the folder."""
        text = re.search(rf"^```\w+ {re.escape(name)}\n(.*?)^```$", PAGE, re.MULTILINE | re.DOTALL)[1]
        (self.folder / name).write_text(text)
        return name

    def case(self, text):
        path = self.folder / "case.toml"
        path.write_text('schema = "equidem/1"\n' + text)
        return path

    def check_columns(self, path, title):
        unknown = set(header_of(path)) - names_in_tables(section(title))
        self.assertEqual(unknown, set(), f"{path.name} has columns that the page does not name")

    def test_every_example_is_read(self):
        self.example("assembly.json")
        held = ('[[support]]\ngroup = "bottom"\nux = 0.0\nuy = 0.0\nrotation = 0.0\n'
                '[[load]]\ngroup = "apex"\nforce = [0.0, -1.0e3]\n')
        body = '[assembly]\nkind = "file"\npath = "assembly.json"\n'
        self.run_verb("solve", self.case(body + held))
        springs = f'springs = "{self.example("springs.toml")}"\n'
        self.run_verb("solve", self.case(springs + body + "own_springs = false\n" + held))
        self.example("grains.csv"), self.example("bonds.csv"), self.example("schedule.csv")
        result = self.run_verb("run", self.case(
            '[grains]\npath = "grains.csv"\ndensity = 2500.0\n[bonds]\npath = "bonds.csv"\n'
            '[collisions]\nrestitution = 0.5\nstiffness = 1.0e6\nlaw = "linear_dashpot"\n'
            '[[schedule]]\nname = "up"\nkind = "table"\npath = "schedule.csv"\n'
            '[[wall]]\nname = "floor"\npoint = [0.0, 0.0]\nnormal = [0.0, 1.0]\ndisplacement = 1.0e-4\nschedule = "up"\n'
            '[run]\nduration = 1.0e-3\n'))
        self.assertEqual(result["grains"], 4)
        self.run_verb("pack", self.case(
            '[springs]\nkN = 1.0e8\nkT = 5.0e7\n[packing]\ngrains = 20\nmethod = "rejection"\nbox = [0.1, 0.1]\n[packing.radii]\n'
            f'distribution = "sieve_curve"\npath = "{self.example("sieves.csv")}"\n'))

    def run_verb(self, verb, case, *options):
        return parse_json(self.check_done(equidem(verb, case, "--threads", 1, "--json", "-", *options)).stdout)

    def test_a_tension_test_of_a_lattice_that_is_read_back_is_the_same(self):
        tail = '[springs]\nkN = 3.0e8\nkT = 1.2e8\n[test]\nkind = "uniaxial_tension"\nstress = 2.0e5\n'
        for columns, rows in ((5, 6), (6, 5)):
            made = self.case(f'[assembly]\nkind = "hexagonal"\ncolumns = {columns}\nrows = {rows}\nradius = 0.02\n{tail}')
            names = ("area", "stress", "strain", "poisson_ratio", "stiffness_ratio", "theory", "gauge", "plane_strain")
            before = self.run_verb("solve", made)
            for form, name in (("json", "assembly.json"), ("hdf5", "assembly.h5")):
                out = self.folder / f"{columns}x{rows}" / form
                self.check_done(equidem("solve", made, "--out", out, "--set", f"output.assembly={form}"))
                back = self.folder / "back.toml"
                back.write_text(f'schema = "equidem/1"\n[assembly]\nkind = "file"\npath = "{out / name}"\n{tail}')
                after = self.run_verb("solve", back)
                self.assertEqual({n: before[n] for n in names}, {n: after[n] for n in names}, (columns, rows, form))

    def test_the_sides_of_a_row_of_discs_are_pulled_apart(self):
        (self.folder / "row.csv").write_text("x_mm,y_mm,r_mm\n0,0,3\n6,0,3\n12,0,3\n")
        held = '[[support]]\ngroup = "left"\nux = 0.0\nuy = 0.0\nrotation = 0.0\n[[support]]\ngroup = "right"\nuy = 0.0\n'
        case = self.case('[assembly]\nkind = "file"\npath = "row.csv"\ngap_tolerance = 1.0e-6\n'
                         f'[springs]\nkN = 1.0e6\nkT = 4.0e5\n{held}[[load]]\ngroup = "right"\nforce = [2.0, 0.0]\n')
        self.check_done(equidem("solve", case, "--out", self.folder / "row"))
        with open(self.folder / "row" / "discs.csv", encoding="utf8") as file:
            motions = [float(disc["ux_m"]) for disc in csv.DictReader(file)]
        self.assertEqual(len(motions), 3)
        for found, expected in zip(motions, (0, 2e-6, 4e-6)):
            self.assertAlmostEqual(found, expected, delta=1e-15)

    def test_every_column_that_is_written_is_on_the_page(self):
        out = self.folder / "out"
        states = "Discs and contacts (CSV)"
        for verb, case in (("solve", TENSION), ("homogenize", CASES / "random_cell.toml")):
            self.check_done(equidem(verb, case, "--out", out, "--overwrite", *NO_PICTURE))
            for name in ("discs.csv", "contacts.csv"):
                self.check_columns(out / name, states)
        for name, duration in (("shaken", 0.05), ("bonded", 0.01), ("ellipses", 0.01), ("drop", 0.01)):
            self.check_done(equidem("run", CASES / f"grains_{name}.toml", "--out", out, "--overwrite", *NO_PICTURE, "--set",
                                    f"run.duration={duration}", *(("--set", "shaking.start=0.01") if name == "shaken" else ())))
            self.check_columns(out / "grains.csv", "Grains (CSV)")
            self.check_columns(out / "contacts.csv", states)
        self.check_done(equidem("quasistatic", CASES / "notched_plate.toml", "--out", out, "--overwrite", *NO_PICTURE, "--set",
                                "quasistatic.max_events=2"))
        self.check_columns(out / "events.csv", "Events (CSV)")
        for name in ("history.csv", "energy.csv", "measures.csv"):
            text = section("Histories (CSV)")
            for column in header_of(out / name):
                known = names_in_tables(text) | {"step", "time_s"}
                column = re.sub(r"^wall_\w+?_(?=(v?[xy]|force|moment|impulse|work)_)", "wall_NAME_", column)
                end = re.search(r"_(ux_m|uy_m|rotation_rad|x_m|y_m|angle_rad|vx_m_per_s|vy_m_per_s|spin_rad_per_s|J(_per_m)?)$",
                                column)
                self.assertTrue(column in known or f"{column}_per_m" in known or (end and end[0] in text), f"{name}: {column}")

    @needs_vtk
    def test_every_array_of_frames_and_states_is_on_the_page(self):
        out = self.folder / "out"
        text = section("States and frames (VTK)")
        for case in ("grains_ellipses", "run_pulse"):
            self.check_done(equidem("run", CASES / f"{case}.toml", "--out", out, "--overwrite", *NO_PICTURE, "--set",
                                    "run.duration=1e-4"))
            for _, _, discs, contacts in frames_of(out):
                for found in (discs, contacts):
                    self.assertLessEqual(set(found), names_in_tables(text) | {"points", "TimeValue"})
        for end in ("discs", "contacts"):
            for name in poly_data(out / f"state_{end}.vtp"):
                self.assertTrue(name == "points" or f"`{name}`" in text, name)
        code = re.search(r"^```python\n(.*?)^```$", text, re.MULTILINE | re.DOTALL)[1]
        done = subprocess.run([sys.executable, "-c", code], cwd=self.folder, capture_output=True, text=True, timeout=60)
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertEqual(len(done.stdout.splitlines()), len(frames_of(out)))

    def test_keys_of_an_assembly_are_those_of_the_page(self):
        folder = SOURCE / "lib/equidem/assembly"
        known = re.search(r"> keys\{(.*?)\}", (folder / "files.cpp").read_text(), re.DOTALL)[1]
        of_contacts = re.findall(r'\{"(\w+)", ', (folder / "assembly.hpp").read_text())
        self.assertEqual(len(of_contacts), 4)
        self.assertEqual(set(re.findall(r'"(\w+)"', known)) | set(of_contacts),
                         names_in_tables(section("Assembly (JSON)")))


class ReadBack(RunTest):
    def write(self, name, text):
        path = self.folder / name
        path.write_text('schema = "equidem/1"\n' + text)
        return path

    def test_what_calibrate_writes_is_solved_and_has_the_moduli(self):
        out = self.folder / "calibrated"
        self.check_done(equidem("calibrate", CASES / "calibrate_random.toml", "--out", out))
        case = self.write("case.toml", 'springs = "calibrated/springs.toml"\n[assembly]\nkind = "file"\n'
                                       'path = "calibrated/assembly.json"\n')
        moduli = parse_json(self.check_done(equidem("homogenize", case, "--json", "-")).stdout)
        wanted = parse_json((out / "result.json").read_text())["achieved"]["shear_modulus"]
        self.assertAlmostEqual(moduli["shear_modulus"] / wanted, 1, delta=1e-10)
        held = ('[[group]]\nname = "one"\ndiscs = [0]\n[[group]]\nname = "other"\ndiscs = [7]\n[[support]]\ngroup = "one"\n'
                'ux = 0.0\nuy = 0.0\n[[load]]\ngroup = "other"\nforce = [1.0, 0.0]\n[[load]]\ngroup = "one"\n'
                'force = [-1.0, 0.0]\n')
        self.check_done(equidem("solve", self.write("solve.toml", case.read_text().split("\n", 1)[1] + held)))

    @needs_vtk
    def test_what_pack_and_run_write_is_where_a_run_starts(self):
        for pack, options in (("pack_ellipses", ("--set", "packing.grains=40")),
                              ("pack_pairs", ("--set", "packing.grains=40", "--set",
                                               "packing.shape.kind=bonded_pair"))):
            with self.subTest(case=pack):
                first, second, third = (self.folder / f"{pack}_{k}" for k in "123")
                self.check_done(equidem("pack", CASES / f"{pack}.toml", "--out", first, *options, *NO_PICTURE))
                bonds = "[bonds]\npath = \"{}/bonds.csv\"\n" if (first / "bonds.csv").exists() else ""
                for source, out in ((first, second), (second, third)):
                    case = self.write(f"{out.name}.toml", f'[grains]\npath = "{source}/grains.csv"\ndensity = 2500.0\n{bonds.format(source)}'
                                      '[collisions]\nrestitution = 0.5\nstiffness = 1.0e6\nlaw = "linear_dashpot"\n'
                                      '[run]\nduration = 1.0e-5\ntime_step = 1.0e-6\n[output]\nframe_interval = 5.0e-6\n')
                    self.check_done(equidem("run", case, "--out", out, *NO_PICTURE))
                    with open(source / "grains.csv", newline="") as file:
                        rows = list(csv.DictReader(file))
                    discs = frames_of(out)[0][2]
                    for column, found in (("x_m", discs["points"][:, 0]), ("y_m", discs["points"][:, 1]),
                                          ("angle_rad", discs["angle"]), ("radius_m", discs["radius"]),
                                          ("vx_m_per_s", discs["velocity"][:, 0]), ("spin_rad_per_s", discs["spin"])):
                        self.assertTrue(numpy.array_equal(found, [float(row[column]) for row in rows]), column)

    def test_tables_of_plots_have_no_cell_without_a_number(self):
        out = self.folder / "sweep"
        self.check_done(equidem("sweep", TENSION, "--key", "ratio", "--values", "0,0.5,1", "--out", out))
        tables = [path for path in out.glob("*.csv") if path.with_suffix(".gp").exists()]
        self.assertTrue(tables)
        for path in tables:
            with open(path, newline="") as file:
                rows = list(csv.reader(file))
            self.assertEqual({len(row) for row in rows}, {len(rows[0])})
            if rows[0][0] == "series":
                self.assertEqual(len(rows[0]), 3, path.name)
            self.assertNotIn("", [cell for row in rows for cell in row], path.name)


if __name__ == "__main__":
    unittest.main()
