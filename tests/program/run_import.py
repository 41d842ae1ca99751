# SPDX-License-Identifier: GPL-3.0-or-later
"""Packings of LAMMPS and YADE in place of an assembly: moduli come out, and bad files are refused with their place."""
import shutil
import subprocess
import unittest

from program import CASES, SOURCE, ProgramTest, equidem, german

PACKINGS = SOURCE / "data" / "packings"
DATA, DUMP = PACKINGS / "packing.data", PACKINGS / "packing.dump"
LAMMPS, YADE = shutil.which("lmp"), shutil.which("yade")
METRES, MILLIMETRES, PERIODIC = 'unit_of_length = "m"', 'unit_of_length = "mm"', "periodic_box = true"


class Import(ProgramTest):
    def case(self, path, *keys):
        return self.of_file(path, "".join(f"{key}\n" for key in keys) + "[springs]\nkN = 1e9\nkT = 0.4e9\n")

    def homogenized(self, path, *keys):
        return self.result("homogenize", self.case(path, *keys))

    def check_equal_moduli(self, one, other):
        for modulus in ("shear_modulus", "bulk_modulus_2d"):
            self.assertAlmostEqual(one[modulus] / other[modulus], 1, 9)

    def test_a_dump_and_a_data_file_have_the_same_moduli_in_any_unit(self):
        dump, data, smaller = self.homogenized(DUMP), self.homogenized(DATA, METRES,
                                                                       PERIODIC), self.homogenized(DATA, MILLIMETRES, PERIODIC)
        self.assertEqual((dump["discs"], dump["contacts"]), (36, 76))
        self.assertGreater(dump["shear_modulus"], 1e7)
        self.check_equal_moduli(dump, data)
        self.check_equal_moduli(smaller, data)
        self.assertAlmostEqual(smaller["area"] / data["area"], 1e-6, 15)

    def test_what_the_file_does_not_say_is_asked_for(self):
        empty, half = self.write("\n\n", "empty.csv"), self.write(DUMP.read_text()[:-100], "half.dump")
        for path, keys, *words in ((DATA, (), "packing.data", "unit of length", 'assembly.unit_of_length = "mm"'),
                                   (DATA, (METRES,), "whether its box is periodic", "assembly.periodic_box"),
                                   (empty, (MILLIMETRES,), "the file is empty"),
                                   (half, (), "half.dump: line", "cut off", "assembly.frame"),
                                   ("/proc/self/mem", (), "cannot read '/proc/self/mem'")):
            with self.subTest(words=words):
                self.check_error(equidem("homogenize", self.case(path, *keys)), 2, *words)
        self.assertEqual(self.homogenized(half, "frame = 15000")["discs"], 36)

    def test_the_echo_of_the_case_reads_the_same_packing(self):
        out = self.folder / "out"
        case = self.case(PACKINGS / "settled_ids.txt", METRES, f'contacts = "{PACKINGS / "settled_contacts.txt"}"')
        first, again = self.result("stability", case, "--out", out), self.result("stability", out / "case.toml")
        self.assertEqual(first["contacts"], 29)
        self.assertEqual(first["omega_max"], again["omega_max"])

    def test_tables_as_programs_and_spreadsheets_write_them_are_read(self):
        """The discs of each table touch one another."""
        for text, *keys in (
                ("x_mm;y_mm;d_mm\r\n0,5;0,5;1,0\r\n1,5;0,5;1,0\r\n1,0;1,3660254;1,0\r\n",),
                ("0,5 0,5 0,5\n1,5 0,5 0,5\n1,0 1,3660254 0,5\n", MILLIMETRES),
                ('"x_mm","y_mm","r_mm"\n"0","0","2"\n"4","0","2"\n"2","3.4641016","2"\n',),
                ('x_mm,y_mm,label,r_mm\n0,0,"gneis, dark",2\n4,0,"quartz",2\n2,3.4641016,"mica, pale",2\n',),
                ("x (mm)\ty (mm)\tr (mm)\n0\t0\t2\n4\t0\t2\n2\t3.4641016\t2\n",),
                ("\tx_mm\ty_mm\tr_mm\n0\t0\t0\t2\n1\t4\t0\t2\n2\t2\t3.4641016\t2\n",),
                ("# settled on 3 May\n0.00 0.00 0.0 0.02\n0.04 0.00 0.0 0.02\n0.02 0.034641016151377546 0.0 0.02\n", METRES),
                ("#format x_y_z_r\n# by hand, 3 of May\n0 0 0 2\n# one more\n4 0 0 2\n2 3.4641016 0 2\n", MILLIMETRES),
                ("\ufeffx [µm],y [µm],d [µm]\r0,0,300\r300,0,300\r150,259.8076,300\r",)):
            with self.subTest(text=text):
                (self.folder / "grains.csv").write_bytes(text.encode())
                self.assertEqual(self.homogenized("grains.csv", "gap_tolerance = 1e-6", *keys)["contacts"], 3)

    def test_other_encodings_are_named_and_messages_are_utf8(self):
        for encoding, *words in (("latin-1", "grains.csv", "line 1", "not UTF-8", "0xb5"), ("utf-16", "grains.csv:1", "UTF-16")):
            (self.folder / "grains.csv").write_bytes("x [µm],y [µm],d [µm]\n0,0,300\n300,0,300\n".encode(encoding))
            self.check_error(equidem("homogenize", self.case("grains.csv")), 2, *words)
        (self.folder / "case.toml").write_bytes(b'schema = "equidem/1"\ntitle = "gr\xfcn"\n')
        self.check_error(equidem("homogenize", self.folder / "case.toml"), 2, "case.toml:2")

    def test_a_disc_that_is_there_twice_is_refused_by_its_ids_and_a_deep_overlap_is_warned_of(self):
        rows = "id,x_mm,y_mm,r_mm\n1,0,0,5\n2,10,0,5\n3,5,8.660254037844386,5\n4,15,8.660254037844386,5\n"
        case = self.case("grid.csv", "period = [0.02, 0.017320508075688773]")
        for fifth in ("5,0,0,5", "5,3e-9,0,5", "5,19.999999997,0,5"):
            self.write(rows + fifth + "\n", "grid.csv")
            self.check_error(equidem("homogenize", case), 2, "grid.csv: line 6", "particles 1 and 5 lie in one place", "line 2")
        self.write(rows + "5,1.5,0,5\n", "grid.csv")
        found = self.result("homogenize", case, "--out", self.folder / "out")
        self.assertEqual(found["overlapping_discs"], [0, 4])
        self.assertIn("warning", found["report"])
        self.assertIn("overlap at most 1.7 of the smaller radius", found["report"])
        self.assertIn("there twice", (self.folder / "out" / "index.html").read_text())

    def test_a_comma_as_decimal_sign_of_the_locale_changes_nothing(self):
        env = german(self.folder)
        if env is None:
            self.skipTest("the locale de_DE cannot be made")
        self.write("x_mm,y_mm,r_mm\n0.5,0.5,0.5\n1.5,0.5,0.5\n1.0,1.3660254,0.5\n", "grains.csv")
        for command in (("homogenize", self.case("grains.csv", "gap_tolerance = 1e-6"), "springs.kT=0.25e9"),
                        ("sweep", CASES / "hexagonal_cell.toml", "--verb", "homogenize", "--key", "ratio", "--from",
                         "0.2", "--to", "0.6",
                         "--steps", "3"), ("pack", CASES / "pack_graded.toml")):
            results = [self.result(*command, env=e) for e in (None, env)]
            numbers = [{k: v for k, v in result.items() if isinstance(v, float) and "second" not in k} for result in results]
            self.assertEqual(*numbers)

    @unittest.skipIf(LAMMPS is None, "LAMMPS is not installed")
    def test_what_lammps_writes_now_is_read(self):
        shutil.copy(PACKINGS / "in.packing", self.folder)
        done = subprocess.run([LAMMPS, "-in", "in.packing"], cwd=self.folder, capture_output=True, text=True, timeout=120)
        self.assertEqual(done.returncode, 0, done.stdout[-1000:])
        dump = self.homogenized("packing.dump")
        listed = self.homogenized("packing.dump", 'contacts = "contacts.dump"')
        self.assertEqual(dump["contacts"], listed["contacts"])
        self.check_equal_moduli(dump, listed)

    @unittest.skipIf(YADE is None, "YADE is not installed")
    def test_what_yade_writes_now_is_read(self):
        shutil.copy(PACKINGS / "pack_yade.py", self.folder)
        done = subprocess.run([YADE, "-x", "-n", "-j1", "pack_yade.py"], cwd=self.folder, capture_output=True, text=True, timeout=120)
        self.assertTrue((self.folder / "settled_contacts.txt").exists(), done.stdout + done.stderr)
        found = self.result("stability", self.case("settled.txt", METRES, 'contacts = "settled_contacts.txt"'))
        self.assertEqual(found["discs"], 25)
        self.assertEqual(found["contacts"], len((self.folder / "settled_contacts.txt").read_text().splitlines()) - 1)


if __name__ == "__main__":
    unittest.main()
