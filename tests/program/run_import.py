# SPDX-License-Identifier: GPL-3.0-or-later
"""Packings of LAMMPS and YADE in place of an assembly: moduli come out, and bad files are refused with their place."""
import shutil
import subprocess
import unittest

from program import SOURCE, ProgramTest, equidem, parse_json

PACKINGS = SOURCE / "data" / "packings"
LAMMPS = shutil.which("lmp")
YADE = shutil.which("yade")


class Import(ProgramTest):
    def case(self, path, *keys):
        file = self.folder / "case.toml"
        file.write_text('schema = "equidem/1"\n[assembly]\nkind = "file"\n' + f'path = "{path}"\n' +
                        "".join(f"{key}\n" for key in keys) + "[springs]\nkN = 1e9\nkT = 0.4e9\n")
        return file

    def homogenized(self, path, *keys):
        return parse_json(self.check_done(equidem("homogenize", self.case(path, *keys), "--json", "-")).stdout)

    def test_a_dump_and_a_data_file_have_the_same_moduli(self):
        dump = self.homogenized(PACKINGS / "packing.dump")
        data = self.homogenized(PACKINGS / "packing.data", 'unit_of_length = "m"', "periodic_box = true")
        self.assertEqual((dump["discs"], dump["contacts"]), (36, 76))
        self.assertGreater(dump["shear_modulus"], 1e7)
        self.assertAlmostEqual(dump["shear_modulus"] / data["shear_modulus"], 1, 9)
        self.assertAlmostEqual(dump["bulk_modulus_2d"] / data["bulk_modulus_2d"], 1, 9)

    def test_the_unit_scales_lengths_and_leaves_moduli(self):
        metres = self.homogenized(PACKINGS / "packing.data", 'unit_of_length = "m"', "periodic_box = true")
        millimetres = self.homogenized(PACKINGS / "packing.data", 'unit_of_length = "mm"', "periodic_box = true")
        self.assertAlmostEqual(millimetres["area"] / metres["area"], 1e-6, 15)
        self.assertAlmostEqual(millimetres["shear_modulus"] / metres["shear_modulus"], 1, 9)

    def test_what_the_file_does_not_say_is_asked_for(self):
        def refused(path, *words, keys=()):
            self.check_error(equidem("homogenize", self.case(path, *keys)), 2, *words)
        refused(PACKINGS / "packing.data", "packing.data", "unit of length", 'assembly.unit_of_length = "mm"')
        refused(PACKINGS / "packing.data", "whether its box is periodic", "assembly.periodic_box",
                keys=['unit_of_length = "m"'])
        half = self.folder / "half.dump"
        half.write_text((PACKINGS / "packing.dump").read_text()[:-100])
        refused(half, "half.dump: line", "cut off", "assembly.frame")
        self.assertEqual(self.homogenized(half, "frame = 15000")["discs"], 36)

    def test_the_echo_of_the_case_reads_the_same_packing(self):
        out = self.folder / "out"
        case = self.case(PACKINGS / "settled_ids.txt", 'unit_of_length = "m"',
                         f'contacts = "{PACKINGS / "settled_contacts.txt"}"')
        first = parse_json(self.check_done(equidem("stability", case, "--out", out, "--json", "-")).stdout)
        again = parse_json(self.check_done(equidem("stability", out / "case.toml", "--json", "-")).stdout)
        self.assertEqual(first["contacts"], 29)
        self.assertEqual(first["omega_max"], again["omega_max"])

    @unittest.skipIf(LAMMPS is None, "LAMMPS is not installed")
    def test_what_lammps_writes_now_is_read(self):
        shutil.copy(PACKINGS / "in.packing", self.folder)
        done = subprocess.run([LAMMPS, "-in", "in.packing"], cwd=self.folder, capture_output=True, text=True, timeout=120)
        self.assertEqual(done.returncode, 0, done.stdout[-1000:])
        dump = self.homogenized(self.folder / "packing.dump")
        listed = self.homogenized(self.folder / "packing.dump", f'contacts = "{self.folder / "contacts.dump"}"')
        self.assertEqual(dump["contacts"], listed["contacts"])
        self.assertAlmostEqual(dump["shear_modulus"] / listed["shear_modulus"], 1, 9)

    @unittest.skipIf(YADE is None, "YADE is not installed")
    def test_what_yade_writes_now_is_read(self):
        shutil.copy(PACKINGS / "pack_yade.py", self.folder)
        done = subprocess.run([YADE, "-x", "-n", "-j1", "pack_yade.py"], cwd=self.folder, capture_output=True, text=True,
                              timeout=120)
        self.assertTrue((self.folder / "settled_contacts.txt").exists(), done.stdout + done.stderr)
        case = self.case(self.folder / "settled.txt", 'unit_of_length = "m"',
                         f'contacts = "{self.folder / "settled_contacts.txt"}"')
        found = parse_json(self.check_done(equidem("stability", case, "--json", "-")).stdout)
        self.assertEqual(found["discs"], 25)
        self.assertEqual(found["contacts"], len((self.folder / "settled_contacts.txt").read_text().splitlines()) - 1)


if __name__ == "__main__":
    unittest.main()
