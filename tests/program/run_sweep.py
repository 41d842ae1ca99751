# SPDX-License-Identifier: GPL-3.0-or-later
"""equidem sweep, as a user does: run_sweep.py PROGRAM SOURCE_FOLDER [unittest options]."""
import resource
import signal
import time
import unittest

from program import CASES, CELL, NO_PICTURE, TENSION, ProgramTest, at_most, equidem, numbers_of, result_in, rows_of, started

PACKED, LATTICE, CRADLE = CASES / "packed_rock.toml", CASES / "hexagonal_cell.toml", CASES / "grains_cradle.toml"
ROCK = ("packing.grains=80", "packing.solid_fraction=0.8")
MACHINE = ("report", "times", "version", "units", "labels")  # keys of results that are no numbers of the computation
RATIO = ("--key", "ratio", "--values")
MANY = ("--key", "springs.kT", "--from", 0, "--to", "1e9", "--steps", 100000)
LAST = 2**63 - 1


def unit_in_names(unit):
    """The end of the name of a column: kg/m³ is _kg_per_m3."""
    text = unit[1:] if unit.startswith("1/") else unit
    text = text.replace("/", "_per_").replace("²", "2").replace("³", "3").lstrip("_")
    return f"_{text}" if text else ""


class SweepTest(ProgramTest):
    def sweep(self, *arguments):
        return self.result("sweep", *arguments)

    def table(self, name, *arguments):
        """Result, and the rows of the table."""
        return self.sweep(*arguments, "--out", self.folder / name), rows_of(self.folder / name / "sweep.csv")


class Points(SweepTest):
    def check_row(self, row, result):
        """A row of the table has every number of a result, digit for digit."""
        expected = {}
        for path, value in numbers_of({key: entry for key, entry in result.items() if key not in MACHINE}):
            if not isinstance(value, list):
                name = ".".join(part for part in path.split(".") if not part.isdigit())
                expected[path + unit_in_names(result["units"][name])] = value
        self.assertGreater(len(expected), 10)
        for name, value in expected.items():
            self.assertIn(name, row)
            self.assertEqual(float(row[name]), value, name)

    def test_points_are_single_commands_digit_for_digit(self):
        for verb, key, values, number, given, single in (
                ("calibrate", "material.poisson_ratio", (0.1, 0.15, 0.2), "kN", (), lambda value: f"material.poisson_ratio={value}"),
                ("homogenize", "ratio", (0, 0.25, 0.5), "coordination_number", ("springs={kN = 1e9, kT = 5e8}", "material=none"),
                 lambda value: f"springs={{kN = 1e9, kT = {value * 1e9}}}")):
            with self.subTest(verb=verb):
                case = (PACKED, *ROCK, *given)
                result, table = self.table(verb, *case, "--verb", verb, "--key", key, "--values",
                                           ",".join(map(str, values)), "--seeds", "1-3")
                self.assertEqual([(float(row[key]), row["seed"]) for row in table],
                                 [(value, seed) for value in values for seed in ("1", "2", "3")])
                self.assertEqual([row["point"] for row in table], [str(k) for k in range(1, 10)])
                for k in (0, 4, 8):
                    alone = self.result(verb, *case, single(values[k // 3]), "--seed", k % 3 + 1)
                    self.check_row(table[k], alone)
                    for name in ("status", number):
                        self.assertEqual(result["points"][k][name], alone[name])
        swept = self.sweep(TENSION, "--key", "springs.kT", "--values", "0.25e9")["points"][0]
        self.assertEqual(swept["poisson_ratio"], self.result("solve", TENSION, "springs.kT=0.25e9")["poisson_ratio"])

    def test_the_curve_follows_theory(self):
        result, table = self.table("out", TENSION, "--key", "ratio", "--from", "0", "--to", "1", "--steps", "3")
        self.assertTrue(result["complete"])
        self.assertEqual([point["value"] for point in result["points"]], [0, 0.5, 1])
        for point in result["points"]:
            self.assertEqual(point["status"], "solved")
            self.assertLess(abs(point["poisson_ratio"] - (1 - point["value"]) / 4), 0.01)
        self.assertEqual([row["ratio"] for row in table], ["0", "0.5", "1"])
        self.check_there(self.folder / "out", "poisson_ratio.csv", "poisson_ratio.gp", "stiffness_ratio.csv",
                         "case.toml", "result.json")

    def test_what_is_varied_stands_in_what_is_written(self):
        result, table = self.table("out", TENSION, "--key", "springs.kT", "--values", "0,5e8", "--key", "assembly.rows",
                                   "--values", "9,11")
        self.assertEqual(result["verb"], "solve")
        self.assertEqual(result["keys"], [{"key": "springs.kT", "unit": "Pa", "values": [0, 5e8]},
                                          {"key": "assembly.rows", "unit": "", "values": [9, 11]}])
        self.assertEqual([(row["springs.kT_Pa"], row["assembly.rows"]) for row in table],
                         [("0", "9"), ("0", "11"), ("500000000", "9"), ("500000000", "11")])
        self.assertEqual(result["points"][2]["springs.kT"], 5e8)
        self.assertEqual(result["units"]["points.springs.kT"], "Pa")
        self.assertIn("# springs.kT = 0, 500000000\n", (self.folder / "out" / "case.toml").read_text())
        self.assertIn("energy_N", table[0])
        script = (self.folder / "out" / "poisson_ratio.gp").read_text(encoding="utf-8")
        for words in ("assembly.rows = 9", "assembly.rows = 11", "springs.kT, Pa"):
            self.assertIn(words, script)

    def test_lists_stand_side_by_side_and_words_are_values(self):
        pairs = self.sweep(TENSION, "--list", "--key", "assembly.rows", "--values", "9,13", "--key", "assembly.columns",
                           "--values", "13,9")
        self.assertEqual([(point["assembly.rows"], point["assembly.columns"], point["discs"]) for point in pairs["points"]],
                         [(9, 13, 113), (13, 9, 111)])
        words = self.sweep(TENSION, "--key", "solver.method", "--values", "multifrontal,cholmod", "--key", "output.frame_contacts",
                           "--values", "true,false")["points"]
        self.assertEqual([point["solver.method"] for point in words], ["multifrontal"] * 2 + ["cholmod"] * 2)
        self.assertEqual([point["status"] for point in words], ["solved"] * 4)

    def test_seeds_and_whole_numbers_keep_all_their_digits(self):
        for most in (2**53 + 1, LAST):
            command = (CELL, "--verb", "homogenize", "assembly.discs=60")
            by_seed = self.sweep(*command, "--seeds", f"{most - 1}-{most}")
            by_key = self.sweep(*command, "--key", "assembly.seed", "--values", f"{most - 1},{most}")
            self.assertEqual(by_seed["keys"][0]["values"], [most - 1, most])
            self.assertEqual([[point["seed"] for point in by_seed["points"]], [point["assembly.seed"] for point in by_key["points"]]],
                             [[most - 1, most]] * 2)
            self.assertEqual([point["shear_modulus"] for point in by_key["points"]],
                             [point["shear_modulus"] for point in by_seed["points"]])

    def test_runs_and_packings_are_swept(self):
        grains = self.sweep(CRADLE, "--verb", "run", "--key", "collisions.restitution", "--values", "0.5,1")["points"]
        self.assertGreater(grains[0]["energy"]["dissipated"], grains[1]["energy"]["dissipated"])
        packings = self.sweep(PACKED, "--verb", "pack", *ROCK, "--seeds", "1-2")["points"]
        self.assertEqual([point["seed"] for point in packings], [1, 2])
        self.assertNotEqual(packings[0]["bonds"], packings[1]["bonds"])
        self.table("stability", LATTICE, "--verb", "stability", *RATIO, "0.1,0.2")
        head = (self.folder / "stability" / "sweep.csv").read_text().splitlines()[0].split(",")
        self.assertEqual(head.count("ratio"), 1)  # which is a number of the results, too
        self.assertLess(result_in(self.folder / "stability")["points"][0]["critical_ratio"], 0)

    def test_a_run_to_rest_shows_what_it_measures(self):
        rest, out = CASES / "run_tension.toml", self.folder / "out"
        self.assertIn("E strain, Pa", self.done("sweep", rest, "--verb", "run", *RATIO, "0,0.5", "--out", out).stdout)
        self.check_there(out, "plane_strain_young_modulus.gp")
        young = float(rows_of(out / "sweep.csv")[1]["plane_strain.young_modulus_Pa"])
        self.assertAlmostEqual(young / self.result("solve", rest)["plane_strain"]["young_modulus"], 1, delta=1e-9)

    def test_energies_of_runs_have_their_units(self):
        for case, key, unit in (("run_pulse", "springs.kT", "J_per_m"), ("grains_cradle", "collisions.restitution", "J")):
            result, table = self.table(case, CASES / f"{case}.toml", "--verb", "run", "--key", key, "--values", "0.5,0.8")
            columns = [name for name in table[0] if name.startswith("energy.")]
            self.assertGreater(len(columns), 5)
            for name in columns:
                self.assertTrue(name == "energy.relative_error" or name.endswith("_" + unit), name)
            for row, point in zip(table, result["points"], strict=True):
                self.assertEqual(float(row["energy.kinetic_" + unit]), point["energy"]["kinetic"])
            self.assertIn("kinetic energy, J", (self.folder / case / "energy_kinetic.gp").read_text(encoding="utf-8"))

    def test_the_ratio_of_a_point_is_that_to_its_own_kN(self):
        keys = (("--key", "springs.kN", "--values", "1e9,3e9"), (*RATIO, "0,0.5"))
        for first, second in (keys, keys[::-1]):
            for point in self.sweep(LATTICE, "--verb", "homogenize", *first, *second)["points"]:
                G = 3**0.5 / 4 * point["springs.kN"] * (1 + point["ratio"])
                self.assertLess(abs(point["shear_modulus"] / G - 1), 1e-12, point)

    def test_points_that_are_unstable_or_fail_are_marked_with_their_sentence(self):
        stable, unstable = self.sweep(TENSION, *RATIO, "-0.1,-0.35")["points"]
        self.assertEqual((stable["unstable_modes"], stable["status"], unstable["status"]), (0, "solved", "unstable"))
        self.assertGreater(unstable["unstable_modes"], 0)
        bad, good = self.sweep(TENSION, "--key", "springs.kN", "--values", "-1,1e9")["points"]
        self.assertEqual((bad["status"], good["status"]), ("failed", "solved"))
        self.assertIn("out of range", bad["message"])
        self.assertNotIn("poisson_ratio", bad)
        done = equidem("sweep", TENSION, "--key", "springs.kN", "--values", "-1,-2")
        self.assertEqual(done.returncode, 1)
        self.assertIn("out of range", done.stderr)

    def test_reasons_of_failures_stand_below_the_table_once_each(self):
        text = self.done("sweep", CELL, "--verb", "homogenize", "assembly.discs=60", "--key", "springs.kN", "--values", "-1,1e9",
                         "--seeds", "1-3").stdout
        self.assertEqual([line.split() for line in text.splitlines() if "failed" in line],
                         [["-1", "1", "failed"], ["-1", "2", "failed"], ["-1", "3", "failed"],
                          ["failed", "3", "points;", "3", "done"]])
        self.assertEqual(text.count("is out of range"), 1)
        self.assertIn("points 1, 2, 3: --set springs.kN=-1", text)
        self.assertLess(max(map(len, text.splitlines())), 115)


class Curves(SweepTest):
    def test_the_title_of_the_curve_is_the_users_and_its_symbols_are_typeset(self):
        for number, (options, title) in enumerate(((("--title", "My a_b {sweep}"), r"My a\_b \{sweep\}"),
                                                   (('title="Block of 50_000"',), r"Block of 50\_000"),
                                                   (('title=""',), "k_T/k_N varied"))):
            self.table(str(number), TENSION, *RATIO, "0,0.5", *options)
            script = (self.folder / str(number) / "stiffness_ratio.gp").read_text(encoding="utf-8")
            self.assertIn(f"set title '{title}'", script)
            self.assertIn("set ylabel '2G/((1 - ν) k_N)'", script)

    def test_seeds_are_drawn_with_their_mean(self):
        self.table("out", CELL, "--verb", "homogenize", "assembly.discs=60", *RATIO, "0,1", "--seeds", "1,2")
        script = (self.folder / "out" / "young_modulus_plane_strain.gp").read_text(encoding="utf-8")
        self.assertIn("each seed", script)
        self.assertIn("mean", script)

    def test_one_value_makes_no_curve(self):
        for name, values in (("one", (*RATIO, "0.5")), ("other", ("--key", "springs.kN", "--values", "1e9,-1"))):
            self.table(name, TENSION, *values)
            self.assertEqual(list((self.folder / name).glob("*.gp")), [])


class Resume(SweepTest):
    def test_resumed_after_a_kill_the_table_has_the_same_bytes(self):
        command = ("sweep", PACKED, "--verb", "homogenize", "packing.grains=300", "--key", "packing.solid_fraction",
                   "--values", "0.8,0.81",
                   "--seeds", "1-25", "--quiet", "--out")
        whole, out = self.folder / "whole", self.folder / "out"
        self.done(*command, whole)
        running = started(*command, out)
        while not (out / "sweep.csv").exists() and running.poll() is None:
            time.sleep(0.01)
        running.send_signal(signal.SIGKILL)
        running.communicate()
        self.assertLess(len(rows_of(out / "sweep.csv")), 50)
        self.done(*command, out, "--resume")
        self.check_same_files(whole, out, "sweep.csv")

    def test_interrupted_it_keeps_what_is_done_and_resume_completes_it(self):
        out = self.folder / "out"
        stdout, stderr = self.interrupt("sweep", TENSION, *MANY, "--out", out, when=lambda: (out / "sweep.csv").exists())
        self.assertIn("INCOMPLETE", stdout)
        self.assertIn("--resume", stderr)
        done = rows_of(out / "sweep.csv")
        self.assertGreater(len(done), 0)
        self.assertEqual(result_in(out)["status"], "interrupted")

        values = ",".join([row["springs.kT_Pa"] for row in done] + ["0.9e9", "1e9"])
        shorter = ("sweep", TENSION, "--key", "springs.kT", "--values", values, "--out", out)
        self.check_errors(((), "exists already"), (("--resume", "springs.kN=2e9"), "another case"),
                          (("--resume", "--verb", "stability"), "another case"), before=shorter)
        self.done(*shorter, "--resume")
        completed = rows_of(out / "sweep.csv")
        for row in done + completed:
            del row["point"], row["checksum"]  # positions in the lists of values
        self.assertEqual(completed[:len(done)], done)
        self.assertEqual(len(completed), len(done) + 2)
        self.assertTrue(result_in(out)["complete"])

    def test_the_first_interrupt_that_is_caught_ends_it_as_an_interrupted_one(self):
        for milliseconds in range(0, 60, 3):
            with self.subTest(milliseconds=milliseconds):
                self.interrupt("sweep", TENSION, *MANY, after=1e-3 * milliseconds)

    def test_a_file_that_has_changed_is_no_reason_to_go_on(self):
        discs = [((i + 0.5 * (row % 2)) * 0.02, row * 0.01 * 3**0.5) for row in range(6) for i in range(6)]

        def write(some):
            self.write("x_m,y_m,radius_m\n" + "".join(f"{x},{y},0.01\n" for x, y in some), "discs.csv")
        case = self.of_file("discs.csv", "gap_tolerance = 1e-6\n[springs]\nkN = 1e9\nkT = 5e8\n[strength]\ntension = 1e5\nshear = 1e5\n"
                            '[[support]]\ngroup = "bottom"\nux = true\nuy = true\n[[load]]\ngroup = "top"\nforce = [0.0, 1.0]\n'
                            "[quasistatic]\nmax_events = 1\n")
        for verb, more in (("sweep", ("--verb", "homogenize", "--key", "effects.rotation", "--values", "free,restrained")),
                           ("quasistatic", (NO_PICTURE,))):
            write(discs)
            command = (verb, case, *more, "--out", self.folder / verb)
            self.done(*command)
            self.done(*command, "--resume")
            write(discs[:-1])
            self.check_error(equidem(*command, "--resume"), 2, "of another case", "a file that")


class Refusals(SweepTest):
    def test_bad_input_is_one_error(self):
        many = ("--from", "0", "--to", "1", "--steps", "10000")
        kT = ("--key", "springs.kT", "--values")
        self.check_errors(
            ((), "--key", "--seeds"), (("--values", "1"), "--key"),
            (("--key", "springs.kT"), "springs.kT is given no values", "--values", "--from"),
                          (("--key", "springs.kT", "--from", "1"), "--to"),
            (("--key", "springs.kTT", "--values", "1"), "'kT'"), ((*kT, "nan"), "nan"), ((*RATIO, "1", *RATIO, "1"), "twice"),
            *(((*RATIO, values), "--values", "finite", "Leave it out") for values in ("1,,2", ",", "1,", "", "1 2", "1x")),
            *(((*RATIO, f"0,{value}"), f"'{value}'", "kT/kN") for value in ("x", "true", "none")),
            *((("--key", "ratio", "--from", "0", "--to", "1", option, "nan"), option) for option in ("--from", "--to")),
            (("--key", "ratio", "--from=-1e308", "--to", "1e308"), "overflow"), ((*RATIO, "0", "--resume"), "--out"),
            (("--list", *RATIO, "0,1", "--key", "assembly.rows", "--values", "9"),
             "ratio takes 2 values and assembly.rows takes 1", "--list"),
            (("--seeds", "1-3"), "seed", "does not apply"), (("--key", "seed", "--values", "a"), "'seed'", "--seeds"),
            (("--seeds", "3-1"), "--seeds", "3-1"), (("--seeds", "1", "--seed", "1"), "--seed and --seeds"),
            (("--verb", "slove", *RATIO, "0"), "'slove'", "solve"), (("--verb", "study", *RATIO, "0"), "'study'", "no case"),
            (("--key", "ratio", *many, "--key", "springs.kN", *many), "1e+08 points", "GB", "hours", "1 000 000"),
            ((*RATIO, "0.5", *kT, "2e7"), "ratio and springs.kT", "both set springs.kT"), before=("sweep", TENSION))
        self.check_errors(
            ((CRADLE, "--verb", "run", "--seeds", "1-3"), "--seeds", "random"),
            ((CASES / "calibrate_random.toml", *RATIO, "0"), "needs springs"),
            ((CELL, "--verb", "homogenize", "--seeds", "1,2", "--key", "assembly.seed", "--values", "5"), "--seeds",
             "both set assembly.seed"),
            ((PACKED, "--verb", "homogenize", "--values", "0.1", "--key", "gap_tolerance"), "Write packing.gap_tolerance."),
            ((PACKED, "--verb", "homogenize", "--values", "0.1", "--key", "gap_tolerence"), "Did you mean packing.gap_tolerance?"),
            ((PACKED, "--verb", "homogenize", "--values", "0.1", "--key", "ratoi"), "--key ratio"), before=("sweep",))
        springs = self.write('schema = "equidem-springs/1"\n[springs]\nkN = 1e9\nkT = 2e8\n', "springs.toml")
        done = equidem("sweep", TENSION, f"springs='{springs}'", "--key", "springs.kN", "--values", "1e9,2e9")
        self.assertEqual(done.returncode, 1, done.stderr)
        self.assertIn("varies kT/kN by --key ratio", done.stderr)

    def test_too_many_points_are_refused_before_they_take_memory(self):
        for words, points in ((("--seeds", f"0-{LAST}"), "9.22e+18"), (("--seeds", "0-999999", "--seeds", "0-999999"), "2e+06"),
                              (("--key", "ratio", "--from", "0", "--to", "1", "--steps", "1000000", "--seeds", "0-1"), "2e+06")):
            done = equidem("sweep", CELL, "--verb", "homogenize", *words, "--dry-run", **at_most(2 << 30, resource.RLIMIT_AS))
            self.check_error(done, 2, f"the sweep has {points} points", "Give at most")

    def test_samples_beyond_the_largest_seed_are_refused_with_their_line(self):
        strength = CASES / "calibrate_strength.toml"
        self.check_errors(*(((verb, case, f"{key}={LAST}", "--dry-run"), key, f"the largest seed is {LAST}") for verb, case, key in (
            ("homogenize", CASES / "ensemble.toml", "assembly.seed"), ("calibrate", strength, "assembly.seed"),
            ("calibrate", strength, "strength.seed"))))

    def test_a_verb_without_numbers_is_not_offered(self):
        done = equidem("sweep", TENSION, "--verb", "export", *RATIO, "0,1")
        self.check_error(done, 2, "cannot vary 'export'")
        offered = done.stderr.split("Give one of ")[1].strip(".\n")
        self.assertNotIn("export", offered)
        self.assertIn("quasistatic", offered)
        self.assertIn(offered, self.report("sweep", "--help"))


if __name__ == "__main__":
    unittest.main()
