# SPDX-License-Identifier: GPL-3.0-or-later
"""The page of file formats, and files that are read again: run_formats.py PROGRAM SOURCE_FOLDER [unittest options]."""
import csv
import pathlib
import re
import subprocess
import sys
import unittest

import numpy

from motion import RunTest, frames_of, needs_vtk, poly_data
from program import CASES, CELL, NO_PICTURE, SOURCE, TENSION, equidem, rows_of

try:
    import h5py
except ImportError:
    h5py = None

PAGE = (SOURCE / "docs" / "file_formats.md").read_text(encoding="utf-8")
SMALL = (CELL, "assembly.discs=200", "output.files=['csv']")
SPRINGS = "[springs]\nkN = 1.0e9\nkT = 0.5e9\n"
needs_h5py = unittest.skipUnless(h5py, "python3-h5py is not installed")


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
        self.write(re.search(rf"^```\w+ {re.escape(name)}\n(.*?)^```$", PAGE, re.MULTILINE | re.DOTALL)[1], name)
        return name

    def python_of(self, title):
        """What the block of Python in a section prints."""
        code = re.search(r"^```python\n(.*?)^```$", section(title), re.MULTILINE | re.DOTALL)[1]
        done = subprocess.run([sys.executable, "-c", code], cwd=self.folder, capture_output=True, text=True, timeout=60)
        self.assertEqual(done.returncode, 0, done.stderr)
        return done.stdout

    def check_columns(self, path, title):
        unknown = set(header_of(path)) - names_in_tables(section(title))
        self.assertEqual(unknown, set(), f"{path.name} has columns that the page does not name")

    def test_every_example_is_read(self):
        for name in ("assembly.json", "springs.toml", "grains.csv", "bonds.csv", "schedule.csv", "sieves.csv"):
            self.example(name)
        held = ('[[support]]\ngroup = "bottom"\nux = 0.0\nuy = 0.0\nrotation = 0.0\n'
                '[[load]]\ngroup = "apex"\nforce = [0.0, -1.0e3]\n')
        self.done("solve", self.of_file("assembly.json", held))
        self.done("solve", self.write('springs = "springs.toml"\n[assembly]\nkind = "file"\npath = "assembly.json"\nown_springs = false\n' + held))
        result = self.run_case(self.write(
            '[grains]\npath = "grains.csv"\ndensity = 2500.0\n[bonds]\npath = "bonds.csv"\n'
            '[collisions]\nrestitution = 0.5\nstiffness = 1.0e6\nlaw = "linear_dashpot"\n'
            '[[schedule]]\nname = "up"\nkind = "table"\npath = "schedule.csv"\n'
            '[[wall]]\nname = "floor"\npoint = [0.0, 0.0]\nnormal = [0.0, 1.0]\ndisplacement = 1.0e-4\nschedule = "up"\n'
            "[run]\nduration = 1.0e-3\n"))
        self.assertEqual(result["grains"], 4)
        self.done("pack", self.write(SPRINGS + '[packing]\ngrains = 20\nmethod = "rejection"\nbox = [0.1, 0.1]\n[packing.radii]\n'
                                     'distribution = "sieve_curve"\npath = "sieves.csv"\n'))

    def test_every_column_that_is_written_is_on_the_page(self):
        out, states = self.folder / "out", "Discs and contacts (CSV)"
        shaken = ("run.duration=0.05", "shaking.start=0.01")
        for command, tables in (
                (("solve", TENSION), {"discs": states, "contacts": states}),
                                (("homogenize", CELL), {"discs": states, "contacts": states}),
                *((("run", CASES / f"grains_{name}.toml", *options), {"grains": "Grains (CSV)", "contacts": states})
                  for name, options in (("shaken", shaken),
                                        *((name, ("run.duration=0.01",)) for name in ("bonded", "ellipses", "drop")))),
                (("quasistatic", CASES / "notched_plate.toml", "quasistatic.max_events=2"), {"events": "Events (CSV)"})):
            self.done(*command, "--out", out, "--overwrite", NO_PICTURE)
            for name, title in tables.items():
                self.check_columns(out / f"{name}.csv", title)
        text = section("Histories (CSV)")
        known = names_in_tables(text) | {"step", "time_s"}
        for name in ("history.csv", "energy.csv", "measures.csv"):
            for column in header_of(out / name):
                column = re.sub(r"^wall_\w+?_(?=(v?[xy]|force|moment|impulse|work)_)", "wall_NAME_", column)
                end = re.search(r"_(ux_m|uy_m|rotation_rad|x_m|y_m|angle_rad|vx_m_per_s|vy_m_per_s|spin_rad_per_s|J(_per_m)?)$", column)
                self.assertTrue(column in known or f"{column}_per_m" in known or (end and end[0] in text), f"{name}: {column}")

    @needs_vtk
    def test_every_array_of_frames_and_states_is_on_the_page(self):
        out, title = self.folder / "out", "States and frames (VTK)"
        for case in ("grains_ellipses", "run_pulse"):
            self.done("run", CASES / f"{case}.toml", "--out", out, "--overwrite", NO_PICTURE, "run.duration=1e-4")
            for _, _, discs, contacts in frames_of(out):
                for found in (discs, contacts):
                    self.assertLessEqual(set(found), names_in_tables(section(title)) | {"points", "TimeValue"})
        for end in ("discs", "contacts"):
            for name in poly_data(out / f"state_{end}.vtp"):
                self.assertTrue(name == "points" or f"`{name}`" in section(title), name)
        self.assertEqual(len(self.python_of(title).splitlines()), len(frames_of(out)))

    def test_keys_of_an_assembly_are_those_of_the_page(self):
        folder = SOURCE / "lib/equidem/assembly"
        known = re.search(r"> keys\{(.*?)\}", (folder / "files.cpp").read_text(), re.DOTALL)[1]
        of_contacts = re.findall(r'\{"(\w+)", ', (folder / "assembly.hpp").read_text())
        self.assertEqual(len(of_contacts), 4)
        self.assertEqual(set(re.findall(r'"(\w+)"', known)) | set(of_contacts), names_in_tables(section("Assembly (JSON)")))

    def test_tables_of_plots_have_no_cell_without_a_number(self):
        out = self.folder / "sweep"
        self.done("sweep", TENSION, "--key", "ratio", "--values", "0,0.5,1", "--out", out)
        tables = [path for path in out.glob("*.csv") if path.with_suffix(".gp").exists()]
        self.assertTrue(tables)
        for path in tables:
            with open(path, newline="") as file:
                rows = list(csv.reader(file))
            self.assertEqual({len(row) for row in rows}, {len(rows[0])})
            if rows[0][0] == "series":
                self.assertEqual(len(rows[0]), 3, path.name)
            self.assertNotIn("", [cell for row in rows for cell in row], path.name)

    @needs_h5py
    def test_the_layout_of_an_assembly_in_hdf5_is_that_of_the_page(self):
        title = "Assembly (HDF5)"
        rows = {name: (kind, unit) for name, kind, unit in
                re.findall(r"^\| `(\S+)` \| \([^)]*\) \| (\w+) \| ([^|]*?) ?\|", section(title), re.MULTILINE)}
        found = {}
        for number, command in enumerate((("homogenize", *SMALL), ("solve", CASES / "cantilever.toml", NO_PICTURE))):
            self.done(*command, "output.assembly=hdf5", "--out", self.folder / str(number))
            with h5py.File(self.folder / str(number) / "assembly.h5") as file:
                self.assertEqual(file.attrs["schema"].decode(), "equidem-assembly/1")
                file.visititems(lambda name, item: found.update({name: item.dtype.name + " " + item.attrs.get("unit", b"").decode()})
                                if isinstance(item, h5py.Dataset) else None)
        for name, held in found.items():
            name = re.sub(r"^groups/\w+/", "groups/NAME/", name)
            self.assertEqual(held.strip(), " ".join(rows[name]).strip(), name)
        self.assertLessEqual({"discs", "contacts", "cell_areas", "facet_lengths", "cell", "groups/left/discs"}, set(found))
        self.python_of(title)
        self.assertEqual(self.result("homogenize", self.of_file("triangle.h5", SPRINGS), "--dry-run")["discs"], 3)


class ReadBack(RunTest):
    def test_the_sides_of_a_row_of_discs_are_pulled_apart(self):
        self.write("x_mm,y_mm,r_mm\n0,0,3\n6,0,3\n12,0,3\n", "row.csv")
        case = self.of_file("row.csv", "gap_tolerance = 1.0e-6\n[springs]\nkN = 1.0e6\nkT = 4.0e5\n"
                            '[[support]]\ngroup = "left"\nux = 0.0\nuy = 0.0\nrotation = 0.0\n[[support]]\ngroup = "right"\nuy = 0.0\n'
                            '[[load]]\ngroup = "right"\nforce = [2.0, 0.0]\n')
        self.done("solve", case, "--out", self.folder / "row")
        for disc, expected in zip(rows_of(self.folder / "row" / "discs.csv"), (0, 2e-6, 4e-6), strict=True):
            self.assertAlmostEqual(float(disc["ux_m"]), expected, delta=1e-15)

    @needs_vtk
    def test_what_pack_and_run_write_is_where_a_run_starts(self):
        for pack, options in (("pack_ellipses", ("packing.grains=40",)),
                              ("pack_pairs", ("packing.grains=40", "packing.shape.kind=bonded_pair"))):
            with self.subTest(case=pack):
                first, second, third = (self.folder / f"{pack}_{k}" for k in "123")
                self.done("pack", CASES / f"{pack}.toml", "--out", first, *options, NO_PICTURE)
                for source, out in ((first, second), (second, third)):
                    bonds = f'[bonds]\npath = "{source}/bonds.csv"\n' if (first / "bonds.csv").exists() else ""
                    case = self.write(f'[grains]\npath = "{source}/grains.csv"\ndensity = 2500.0\n{bonds}[collisions]\nrestitution = 0.5\n'
                                      'stiffness = 1.0e6\nlaw = "linear_dashpot"\n[run]\nduration = 1.0e-5\ntime_step = 1.0e-6\n'
                                      "[output]\nframe_interval = 5.0e-6\n")
                    self.done("run", case, "--out", out, NO_PICTURE)
                    rows, discs = rows_of(source / "grains.csv"), frames_of(out)[0][2]
                    for column, found in (("x_m", discs["points"][:, 0]), ("y_m", discs["points"][:, 1]),
                                          ("angle_rad", discs["angle"]), ("radius_m", discs["radius"]),
                                          ("vx_m_per_s", discs["velocity"][:, 0]), ("spin_rad_per_s", discs["spin"])):
                        self.assertTrue(numpy.array_equal(found, [float(row[column]) for row in rows]), column)


class Hdf5(RunTest):
    def written(self):
        out = self.folder / "written"
        self.done("homogenize", *SMALL, "output.assembly=hdf5", "--out", out)
        return out / "assembly.h5"

    def stiffness_of(self, path):
        return self.result("homogenize", self.of_file(path, SPRINGS))["stiffness"]

    def test_the_answer_is_that_of_the_assembly_itself_to_the_last_bit(self):
        self.assertEqual(self.stiffness_of(self.written()), self.result("homogenize", *SMALL)["stiffness"])

    def test_the_key_chooses_the_format_of_every_verb(self):
        for command, alone in ((("solve", TENSION), set()), (("homogenize", CELL), set()),
                               (("calibrate", CASES / "calibrate_random.toml"), {"assembly.json"}),
                               (("pack", CASES / "pack_pairs.toml", "packing.grains=30"),
                                {"assembly.json", "assembly_with_walls.json"})):
            for chosen, end in ((None, ".json"), ("json", ".json"), ("hdf5", ".h5")):
                with self.subTest(command=command, chosen=chosen):
                    out = self.folder / f"{command[0]}_{chosen}"
                    self.done(*command, "--out", out, "output.files=['csv']", *((f"output.assembly={chosen}",) if chosen else ()))
                    stems = {pathlib.Path(name).stem for name in alone} or ({"assembly"} if chosen else set())
                    self.assertEqual({path.name for path in out.glob("assembly*")}, {stem + end for stem in stems})

    @needs_h5py
    def test_numbers_of_other_widths_and_orders_compressed_or_not_are_read(self):
        path, other = self.written(), self.folder / "other.h5"
        with h5py.File(path) as source, h5py.File(other, "w") as file:
            file.attrs["schema"] = "equidem-assembly/1"
            file.create_dataset("cell", data=source["cell"][:].astype(">f8"))
            file.create_dataset("discs", data=source["discs"][:], chunks=(7, 2), compression="gzip", shuffle=True)
            file.create_dataset("contacts", data=source["contacts"][:].astype(">i8"), chunks=True, maxshape=(None, 4))
        self.assertEqual(self.stiffness_of(other), self.stiffness_of(path))

    @needs_h5py
    def test_what_other_programs_write_amiss_is_refused(self):
        one = [[0, 1, 0, 0]]
        for datasets, *words in (({"contacts": [[0, 5000000000, 0, 0]]}, "contacts[0]", "5000000000 is out of range"),
                                 ({"discs": ["a", "b"]}, "discs", "no numbers"),
                                 ({"discs": numpy.zeros(6)}, "discs", "the shape (6)"),
                                 ({"discs": 1.0}, "discs", "the shape ()"),
                                 ({"discs": [[0.0, 0, 1], [numpy.inf, 0, 1]]}, "discs[1]", "not finite"),
                                 ({"contacts": [[0.0, 1.0, 0.0, 0.0]]}, "contacts", "no whole numbers"),
                                 ({"discs": None}, "discs", "missing"),
                                 ({"contacts": one, "springs": [[1.0, 1], [1, 1]]}, "springs", "2 rows for 1 contact"),
                                 ({"discs": numpy.zeros((0, 3))}, "the assembly has no discs"),
                                 ({"facet_lengths": [1.0]}, "facet_length", "no contacts")):
            with self.subTest(words=words):
                with h5py.File(self.folder / "a.h5", "w") as made:
                    made.attrs["schema"] = "equidem-assembly/1"
                    for key, value in {"discs": [[0.0, 0, 0.5], [1, 0, 0.5]], **datasets}.items():
                        if value is not None:
                            made[key] = value
                self.check_error(equidem("homogenize", self.of_file("a.h5", SPRINGS)), 2, "a.h5", *words)
        with h5py.File(self.folder / "large.h5", "w") as made:
            made.attrs["schema"] = "equidem-assembly/1"
            made.create_dataset("discs", shape=(2_000_000_000, 3), dtype="f8", chunks=(1000, 3))
        self.check_error(equidem("homogenize", self.of_file("large.h5", SPRINGS)), 1, "large.h5", "2 000 000 000 discs need")


if __name__ == "__main__":
    unittest.main()
