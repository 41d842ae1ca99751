#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Assemblies in HDF5 files, those of other programs too: run_hdf5.py PROGRAM SOURCE_FOLDER [unittest options]."""
import os
import pathlib
import re
import resource
import subprocess
import sys
import unittest

import numpy

from program import CASES, PROGRAM, SOURCE, ProgramTest, equidem, parse_json

try:
    import h5py
except ImportError:
    h5py = None

CELL = CASES / "random_cell.toml"
SMALL = ("--set", "assembly.discs=200", "--set", "output.files=['csv']")
needs_h5py = unittest.skipUnless(h5py, "python3-h5py is not installed")


class Hdf5(ProgramTest):
    def case(self, path):
        case = self.folder / "case.toml"
        case.write_text(f'schema = "equidem/1"\n[assembly]\nkind = "file"\npath = "{path}"\n[springs]\nkN = 1.0e9\nkT = 0.5e9\n')
        return case

    def homogenized(self, case, *options):
        return parse_json(self.check_done(equidem("homogenize", case, "--json", "-", *options)).stdout)

    def written(self, name="written", *options):
        out = self.folder / name
        self.check_done(equidem("homogenize", CELL, *SMALL, "--set", "output.assembly=hdf5", "--out", out, *options))
        return out / "assembly.h5"

    def test_the_answer_is_that_of_the_assembly_itself_to_the_last_bit(self):
        direct = self.homogenized(CELL, *SMALL)["stiffness"]
        self.assertEqual(self.homogenized(self.case(self.written()))["stiffness"], direct)

    def test_the_key_chooses_the_format_of_every_verb(self):
        for verb, case, alone in (("solve", "abe1996_fig6", set()), ("homogenize", "random_cell", set()),
                                  ("calibrate", "calibrate_random", {"assembly.json"}),
                                  ("pack", "pack_pairs", {"assembly.json", "assembly_with_walls.json"})):
            few = ("--set", "packing.grains=30") if verb == "pack" else ()
            for chosen, end in ((None, ".json"), ("json", ".json"), ("hdf5", ".h5")):
                with self.subTest(verb=verb, chosen=chosen):
                    out = self.folder / f"{verb}_{chosen}"
                    key = ("--set", f"output.assembly={chosen}") if chosen else ()
                    self.check_done(equidem(verb, CASES / f"{case}.toml", "--out", out, "--set", "output.files=['csv']",
                                            *few, *key))
                    names = {path.name for path in out.glob("assembly*")}
                    stems = {pathlib.Path(name).stem for name in alone} or ({"assembly"} if chosen else set())
                    self.assertEqual(names, {stem + end for stem in stems})

    @needs_h5py
    def test_the_layout_is_that_of_the_page(self):
        page = (SOURCE / "docs" / "file_formats.md").read_text(encoding="utf-8")
        text = re.search(r"^## Assembly \(HDF5\)$(.*?)^## ", page, re.MULTILINE | re.DOTALL)[1]
        rows = {name: (kind, unit) for name, kind, unit in
                re.findall(r"^\| `(\S+)` \| \([^)]*\) \| (\w+) \| ([^|]*?) ?\|", text, re.MULTILINE)}
        out = self.folder / "cantilever"
        self.check_done(equidem("solve", CASES / "cantilever.toml", "--out", out, "--set", "output.assembly=hdf5", "--set",
                                "output.files=['csv', 'vtk']"))
        found = {}
        for path in (self.written(), out / "assembly.h5"):
            with h5py.File(path) as file:
                self.assertEqual(file.attrs["schema"].decode(), "equidem-assembly/1")
                file.visititems(lambda name, item: found.update({name: item.dtype.name + " " + item.attrs.get(
                    "unit", b"").decode()}) if isinstance(item, h5py.Dataset) else None)
        for name, held in found.items():
            name = re.sub(r"^groups/\w+/", "groups/NAME/", name)
            self.assertEqual(held.strip(), " ".join(rows[name]).strip(), name)
        self.assertLessEqual({"discs", "contacts", "cell_areas", "facet_lengths", "cell", "groups/left/discs"}, set(found))
        code = re.search(r"^```python\n(.*?)^```$", text, re.MULTILINE | re.DOTALL)[1]
        subprocess.run([sys.executable, "-c", code], cwd=self.folder, check=True, timeout=60)
        done = self.check_done(equidem("homogenize", self.case("triangle.h5"), "--dry-run", "--json", "-"))
        self.assertEqual(parse_json(done.stdout)["discs"], 3)

    @needs_h5py
    def test_numbers_of_other_widths_and_orders_compressed_or_not_are_read(self):
        path = self.written()
        direct = self.homogenized(self.case(path))["stiffness"]
        other = self.folder / "other.h5"
        with h5py.File(path) as source, h5py.File(other, "w") as file:
            file.attrs["schema"] = "equidem-assembly/1"
            file.create_dataset("cell", data=source["cell"][:].astype(">f8"))
            file.create_dataset("discs", data=source["discs"][:], chunks=(7, 2), compression="gzip", shuffle=True)
            file.create_dataset("contacts", data=source["contacts"][:].astype(">i8"), chunks=True, maxshape=(None, 4))
        again = self.homogenized(self.case(other))["stiffness"]
        self.assertEqual(again, direct)

    @needs_h5py
    def test_what_other_programs_write_amiss_is_refused(self):
        def file(name, **datasets):
            with h5py.File(self.folder / name, "w") as made:
                made.attrs["schema"] = "equidem-assembly/1"
                made["discs"] = [[0.0, 0, 0.5], [1, 0, 0.5]]
                for key, value in datasets.items():
                    if key in made:
                        del made[key]
                    if value is not None:
                        made[key] = value
            return self.case(name)

        for words, datasets in ((("contacts[0]", "5000000000 is out of range"), {"contacts": [[0, 5000000000, 0, 0]]}),
                                (("discs", "no numbers"), {"discs": ["a", "b"]}),
                                (("discs", "the shape (6)"), {"discs": numpy.zeros(6)}),
                                (("discs", "the shape ()"), {"discs": 1.0}),
                                (("discs[1]", "not finite"), {"discs": [[0.0, 0, 1], [numpy.inf, 0, 1]]}),
                                (("contacts", "no whole numbers"), {"contacts": [[0.0, 1.0, 0.0, 0.0]]}),
                                (("discs", "missing"), {"discs": None}),
                                (("springs", "2 rows for 1 contact"), {"contacts": [[0, 1, 0, 0]],
                                                                       "springs": [[1.0, 1], [1, 1]]}),
                                (("the assembly has no discs",), {"discs": numpy.zeros((0, 3))}),
                                (("facet_length", "no contacts"), {"facet_lengths": [1.0]})):
            with self.subTest(words=words):
                self.check_error(equidem("homogenize", file("a.h5", **datasets)), 2, "a.h5", *words)
        with h5py.File(self.folder / "large.h5", "w") as made:
            made.attrs["schema"] = "equidem-assembly/1"
            made.create_dataset("discs", shape=(2_000_000_000, 3), dtype="f8", chunks=(1000, 3))
        self.check_error(equidem("homogenize", self.case("large.h5")), 1, "large.h5", "2 000 000 000 discs need")

    def test_a_file_that_cannot_be_written_whole_leaves_nothing(self):
        limit = 20000
        out = self.folder / "full"
        done = subprocess.run([PROGRAM, "homogenize", CELL, *SMALL, "--set", "output.assembly=hdf5", "--set", "output.files=[]",
                               "--out", out], capture_output=True, text=True, timeout=120,
                              preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (limit, limit)))
        self.assertEqual(done.returncode, 1, done.stderr)
        self.assertIn("cannot write", done.stderr)
        self.assertIn("assembly.h5", done.stderr)
        self.assertFalse((out / "assembly.h5").exists(), sorted(out.glob("*")))
        self.assertEqual([path for path in out.glob("*") if path.suffix == ".part"], [])

    @unittest.skipIf(os.geteuid() == 0, "root may write everywhere")
    def test_a_folder_that_cannot_be_written_to_is_told_before_the_work(self):
        out = self.folder / "locked"
        out.mkdir(mode=0o500)
        self.check_error(equidem("homogenize", CELL, "--set", "output.assembly=hdf5", "--out", out), 2, "cannot write")


if __name__ == "__main__":
    unittest.main()
