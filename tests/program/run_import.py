# SPDX-License-Identifier: GPL-3.0-or-later
"""Packings of LAMMPS and YADE in place of an assembly: moduli come out, and bad files are refused with their place."""
import shutil
import subprocess
import unittest

from program import CASES, SOURCE, ProgramTest, equidem, german, parse_json

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
        (self.folder / "empty.csv").write_text("\n\n")
        refused(self.folder / "empty.csv", "the file is empty", keys=['unit_of_length = "mm"'])
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

    def triangle(self, text, *keys, name="grains.csv", encoding="utf-8"):
        """The discs of a table, of which each touches both others."""
        (self.folder / name).write_bytes(text.encode(encoding))
        self.assertEqual(self.homogenized(self.folder / name, "gap_tolerance = 1e-6", *keys)["contacts"], 3)

    def test_tables_as_programs_and_spreadsheets_write_them_are_read(self):
        self.triangle("x_mm;y_mm;d_mm\r\n0,5;0,5;1,0\r\n1,5;0,5;1,0\r\n1,0;1,3660254;1,0\r\n")
        self.triangle("0,5 0,5 0,5\n1,5 0,5 0,5\n1,0 1,3660254 0,5\n", 'unit_of_length = "mm"')
        self.triangle('"x_mm","y_mm","r_mm"\n"0","0","2"\n"4","0","2"\n"2","3.4641016","2"\n')
        self.triangle('x_mm,y_mm,label,r_mm\n0,0,"gneis, dark",2\n4,0,"quartz",2\n2,3.4641016,"mica, pale",2\n')
        self.triangle("x (mm)\ty (mm)\tr (mm)\n0\t0\t2\n4\t0\t2\n2\t3.4641016\t2\n")
        self.triangle("\tx_mm\ty_mm\tr_mm\n0\t0\t0\t2\n1\t4\t0\t2\n2\t2\t3.4641016\t2\n")
        self.triangle("# settled on 3 May\n0.00 0.00 0.0 0.02\n0.04 0.00 0.0 0.02\n0.02 0.034641016151377546 0.0 0.02\n",
                      'unit_of_length = "m"')
        self.triangle("#format x_y_z_r\n# by hand, 3 of May\n0 0 0 2\n# one more\n4 0 0 2\n2 3.4641016 0 2\n",
                      'unit_of_length = "mm"')
        self.triangle("x [µm],y [µm],d [µm]\r0,0,300\r300,0,300\r150,259.8076,300\r", encoding="utf-8-sig")

    def test_other_encodings_are_named_and_messages_are_utf8(self):
        for encoding, words in (("latin-1", ("grains.csv", "line 1", "not UTF-8", "0xb5")), ("utf-16", ("grains.csv:1", "UTF-16"))):
            (self.folder / "grains.csv").write_bytes("x [µm],y [µm],d [µm]\n0,0,300\n300,0,300\n".encode(encoding))
            self.check_error(equidem("homogenize", self.case("grains.csv")), 2, *words)
        (self.folder / "case.toml").write_bytes(b'schema = "equidem/1"\ntitle = "gr\xfcn"\n')
        self.check_error(equidem("homogenize", self.folder / "case.toml"), 2, "case.toml:2")

    def test_a_disc_that_is_there_twice_is_refused_by_its_ids_and_a_deep_overlap_is_warned_of(self):
        rows = "id,x_mm,y_mm,r_mm\n1,0,0,5\n2,10,0,5\n3,5,8.660254037844386,5\n4,15,8.660254037844386,5\n"
        period = "period = [0.02, 0.017320508075688773]"
        for fifth in ("5,0,0,5", "5,3e-9,0,5", "5,19.999999997,0,5"):
            (self.folder / "grid.csv").write_text(rows + fifth + "\n")
            done = equidem("homogenize", self.case("grid.csv", period))
            self.check_error(done, 2, "grid.csv: line 6", "particles 1 and 5 lie in one place", "line 2")
        (self.folder / "grid.csv").write_text(rows + "5,1.5,0,5\n")
        case = self.case("grid.csv", period)
        found = parse_json(self.check_done(equidem("homogenize", case, "--json", "-")).stdout)
        self.assertEqual(found["overlapping_discs"], [0, 4])
        said = self.check_done(equidem("homogenize", case, "--out", self.folder / "out")).stdout
        self.assertIn("warning", said)
        self.assertIn("overlap at most 1.7 of the smaller radius", said)
        self.assertIn("there twice", (self.folder / "out" / "index.html").read_text())

    def test_a_file_that_cannot_be_read_is_a_sentence(self):
        self.check_error(equidem("solve", "/proc/self/mem"), 2, "cannot read '/proc/self/mem'")
        self.check_error(equidem("homogenize", self.case("/proc/self/mem")), 2, "cannot read '/proc/self/mem'")

    def test_a_word_among_the_ratios_of_a_sweep_is_a_sentence(self):
        done = equidem("sweep", CASES / "abe1996_fig6.toml", "--key", "ratio", "--values", "0,0.5,x")
        self.check_error(done, 2, "--values", "'x'", "ratio")

    def test_a_comma_as_decimal_sign_of_the_locale_changes_nothing(self):
        env = german(self.folder)
        if env is None:
            self.skipTest("the locale de_DE cannot be made")
        (self.folder / "grains.csv").write_text("x_mm,y_mm,r_mm\n0.5,0.5,0.5\n1.5,0.5,0.5\n1.0,1.3660254,0.5\n")
        runs = [("homogenize", self.case("grains.csv", "gap_tolerance = 1e-6"), "--set", "springs.kT=0.25e9"),
                ("sweep", CASES / "hexagonal_cell.toml", "--verb", "homogenize", "--key", "ratio", "--from", "0.2", "--to", "0.6",
                 "--steps", "3"), ("pack", CASES / "pack_graded.toml")]
        for run in runs:
            texts = [self.check_done(equidem(*run, "--json", "-", env=e)).stdout for e in (None, env)]
            numbers = [{k: v for k, v in parse_json(text).items() if isinstance(v, float) and "second" not in k} for text in texts]
            self.assertEqual(*numbers)

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
