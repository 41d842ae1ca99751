#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""equidem sweep, and the numbers of all results, as a user does: run_sweep.py PROGRAM SOURCE_FOLDER [unittest options]."""
import csv
import resource
import signal
import subprocess
import time
import unittest

from program import CASES, PROGRAM, TENSION, ProgramTest, equidem, parse_json

ROCK = ("packing.grains=80", "packing.solid_fraction=0.8")
NO_PICTURE = ("--set", "output.files=[]")
MACHINE = ("report", "times", "version", "units", "labels")  # keys of results that are no numbers of the computation


def sets(*assignments):
    return [word for assignment in assignments for word in ("--set", assignment)]


def rows(out):
    with open(out / "sweep.csv", newline="", encoding="utf-8") as file:
        return list(csv.DictReader(file))


def numbers_of(value, path=(), positions=True):
    """(path, number) of all numbers below, those of lists of numbers as one list."""
    if isinstance(value, dict):
        for key, entry in value.items():
            yield from numbers_of(entry, (*path, key), positions)
    elif isinstance(value, list) and value and all(isinstance(entry, dict) for entry in value):
        for k, entry in enumerate(value):
            yield from numbers_of(entry, (*path, str(k)) if positions else path, positions)
    elif isinstance(value, (int, float)) and not isinstance(value, bool):
        yield ".".join(path), value
    elif isinstance(value, list) and value and not isinstance(value[0], (str, bool)):
        yield ".".join(path), value


def unit_in_names(unit):
    """The end of the name of a column: kg/m³ is _kg_per_m3."""
    text = unit[1:] if unit.startswith("1/") else unit
    text = text.replace("/", "_per_").replace("²", "2").replace("³", "3").lstrip("_")
    return f"_{text}" if text else ""


class Sweep(ProgramTest):
    def sweep(self, *arguments):
        return parse_json(self.check_done(equidem("sweep", *arguments, "--json", "-")).stdout)

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
        springs = sets("springs={kN = 1e9, kT = 5e8}", "material=none")
        kN = 1e9
        for verb, key, values, given, single in (
                ("calibrate", "material.poisson_ratio", (0.1, 0.15, 0.2), [], "material.poisson_ratio={}"),
                ("homogenize", "ratio", (0, 0.25, 0.5), springs, None)):
            with self.subTest(verb=verb):
                out = self.folder / verb
                case = (CASES / "packed_rock.toml", *sets(*ROCK), *given)
                result = self.sweep(*case, "--verb", verb, "--key", key, "--values", ",".join(map(str, values)), "--seeds",
                                    "1-3", "--out", out)
                table = rows(out)
                self.assertEqual([(float(row[key]), row["seed"]) for row in table],
                                 [(value, seed) for value in values for seed in ("1", "2", "3")])
                self.assertEqual([row["point"] for row in table], [str(k) for k in range(1, 10)])
                for k in (0, 4, 8):
                    value = values[k // 3]
                    change = [single.format(value)] if single else [f"springs={{kN = {kN}, kT = {value * kN}}}"]
                    alone = parse_json(self.check_done(equidem(verb, *case, *sets(*change), "--seed", k % 3 + 1, "--json",
                                                               "-")).stdout)
                    self.check_row(table[k], alone)
                    self.assertEqual(result["points"][k]["status"], alone["status"])
                    self.assertEqual(result["points"][k]["coordination_number" if verb == "homogenize" else "kN"],
                                     alone["coordination_number" if verb == "homogenize" else "kN"])

    def test_what_is_varied_stands_in_what_is_written(self):
        out = self.folder / "out"
        result = self.sweep(TENSION, "--key", "springs.kT", "--values", "0,5e8", "--key", "assembly.rows", "--values", "9,11",
                            "--out", out)
        self.assertEqual(result["verb"], "solve")
        self.assertEqual(result["keys"], [{"key": "springs.kT", "unit": "Pa", "values": [0, 5e8]},
                                          {"key": "assembly.rows", "unit": "", "values": [9, 11]}])
        self.assertEqual([(row["springs.kT_Pa"], row["assembly.rows"]) for row in rows(out)],
                         [("0", "9"), ("0", "11"), ("500000000", "9"), ("500000000", "11")])
        self.assertEqual(result["points"][2]["springs.kT"], 5e8)
        self.assertEqual(result["units"]["points.springs.kT"], "Pa")
        self.assertIn("# springs.kT = 0, 500000000\n", (out / "case.toml").read_text())
        self.assertIn("energy_N", rows(out)[0])
        script = (out / "poisson_ratio.gp").read_text(encoding="utf-8")
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
        for most in (2**53 + 1, 2**63 - 1):
            command = (CASES / "random_cell.toml", "--verb", "homogenize", *sets("assembly.discs=60"))
            by_seed = self.sweep(*command, "--seeds", f"{most - 1}-{most}")
            self.assertEqual([point["seed"] for point in by_seed["points"]], [most - 1, most])
            self.assertEqual(by_seed["keys"][0]["values"], [most - 1, most])
            by_key = self.sweep(*command, "--key", "assembly.seed", "--values", f"{most - 1},{most}")
            self.assertEqual([point["assembly.seed"] for point in by_key["points"]], [most - 1, most])
            self.assertEqual([point["shear_modulus"] for point in by_key["points"]],
                             [point["shear_modulus"] for point in by_seed["points"]])

    def test_too_many_points_are_refused_before_they_take_memory(self):
        steps = ("--key", "ratio", "--from", "0", "--to", "1", "--steps", "1000000", "--seeds", "0-1")
        for words, points in ((("--seeds", f"0-{2**63 - 1}"), "9.22e+18"), (("--seeds", "0-999999", "--seeds", "0-999999"), "2e+06"),
                              (steps, "2e+06")):
            done = subprocess.run([PROGRAM, "sweep", CASES / "random_cell.toml", "--verb", "homogenize", *words, "--dry-run"],
                                  capture_output=True, text=True, timeout=60, check=False,
                                  preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_AS, (2 << 30, 2 << 30)))
            self.check_error(done, 2, f"the sweep has {points} points", "Give at most")

    def test_samples_beyond_the_largest_seed_are_refused_with_their_line(self):
        last = 2**63 - 1
        for verb, case, key in (("homogenize", "ensemble.toml", "assembly.seed"), ("calibrate", "calibrate_strength.toml", "assembly.seed"),
                                ("calibrate", "calibrate_strength.toml", "strength.seed")):
            done = equidem(verb, CASES / case, *sets(f"{key}={last}"), "--dry-run")
            self.check_error(done, 2, key, f"the largest seed is {last}")

    def test_what_is_no_ratio_is_refused_and_a_verb_without_numbers_is_not_offered(self):
        for value in ("x", "true", "none"):
            self.check_error(equidem("sweep", TENSION, "--key", "ratio", "--values", f"0,{value}"), 2, f"'{value}'", "kT/kN")
        done = equidem("sweep", TENSION, "--verb", "export", "--key", "ratio", "--values", "0,1")
        self.check_error(done, 2, "cannot vary 'export'")
        self.assertNotIn("export", done.stderr.split("Give one of")[1])
        offered = done.stderr.split("Give one of ")[1].strip(".\n")
        self.assertIn(offered, " ".join(self.check_done(equidem("sweep", "--help")).stdout.split()))
        self.assertIn("quasistatic", offered)

    def test_seeds_are_drawn_with_their_mean(self):
        out = self.folder / "out"
        self.sweep(CASES / "random_cell.toml", "--verb", "homogenize", *sets("assembly.discs=60"), "--key", "ratio", "--values",
                   "0,1", "--seeds", "1,2", "--out", out)
        script = (out / "young_modulus_plane_strain.gp").read_text(encoding="utf-8")
        self.assertIn("each seed", script)
        self.assertIn("mean", script)

    def test_runs_and_packings_are_swept(self):
        grains = self.sweep(CASES / "grains_cradle.toml", "--verb", "run", "--key", "collisions.restitution", "--values",
                            "0.5,1")["points"]
        self.assertGreater(grains[0]["energy"]["dissipated"], grains[1]["energy"]["dissipated"])
        packings = self.sweep(CASES / "packed_rock.toml", "--verb", "pack", *sets(*ROCK), "--seeds", "1-2")["points"]
        self.assertEqual([point["seed"] for point in packings], [1, 2])
        self.assertNotEqual(packings[0]["bonds"], packings[1]["bonds"])
        stability = self.sweep(CASES / "hexagonal_cell.toml", "--verb", "stability", "--key", "ratio", "--values",
                               "0.5")["points"]
        self.assertLess(stability[0]["critical_ratio"], 0)

    def test_the_bytes_do_not_depend_on_the_number_of_threads(self):
        tables = []
        for threads in (1, 2):
            out = self.folder / str(threads)
            self.check_done(equidem("sweep", CASES / "packed_rock.toml", "--verb", "homogenize", *sets(*ROCK), "--seeds", "1-4",
                                    "--threads", threads, "--out", out))
            tables.append((out / "sweep.csv").read_bytes())
        self.assertEqual(*tables)

    def test_resumed_after_a_kill_the_table_has_the_same_bytes(self):
        command = ["sweep", CASES / "packed_rock.toml", "--verb", "homogenize", *sets("packing.grains=300"), "--key",
                   "packing.solid_fraction", "--values", "0.8,0.81", "--seeds", "1-25", "--quiet"]
        whole, out = self.folder / "whole", self.folder / "out"
        self.check_done(equidem(*command, "--out", whole))
        wanted = (whole / "sweep.csv").read_bytes()
        with subprocess.Popen([PROGRAM, *map(str, command), "--out", str(out)]) as running:
            while not (out / "sweep.csv").exists() and running.poll() is None:
                time.sleep(0.01)
            running.send_signal(signal.SIGKILL)
        table = out / "sweep.csv"
        self.assertLess(len(rows(out)), 50)
        self.check_done(equidem(*command, "--out", out, "--resume"))
        self.assertEqual(table.read_bytes(), wanted)

    def test_a_dry_run_tells_the_number_of_points_and_the_size_of_one(self):
        result = self.sweep(TENSION, "--key", "ratio", "--values", "0,1", "--key", "assembly.rows", "--values", "9,11,13",
                            "--dry-run")
        self.assertEqual(result["number_of_points"], 6)
        self.assertIn("6 points of ratio, assembly.rows", result["report"])
        failing = self.sweep(TENSION, "--key", "springs.kN", "--values", "-1,1e9", "--dry-run")
        self.assertIn("2 points of springs.kN; point 2:", failing["report"])
        self.assertGreater(result["unknowns"], 100)

    def test_bad_input_is_one_error(self):
        sweep = ("sweep", TENSION)
        self.check_error(equidem(*sweep), 2, "--key", "--seeds")
        self.check_error(equidem(*sweep, "--values", "1"), 2, "--key")
        self.check_error(equidem(*sweep, "--key", "springs.kT"), 2, "springs.kT is given no values", "--values", "--from")
        self.check_error(equidem(*sweep, "--key", "springs.kT", "--from", "1"), 2, "--to")
        self.check_error(equidem(*sweep, "--key", "springs.kTT", "--values", "1"), 2, "'kT'")
        self.check_error(equidem(*sweep, "--key", "springs.kT", "--values", "nan"), 2, "nan")
        self.check_error(equidem(*sweep, "--key", "ratio", "--values", "1", "--key", "ratio", "--values", "1"), 2, "twice")
        for values in ("1,,2", ",", "1,", "", "1 2", "1x"):
            self.check_error(equidem(*sweep, "--key", "ratio", "--values", values), 2, "--values", "finite", "Leave it out")
        for option in ("--from", "--to"):
            self.check_error(equidem(*sweep, "--key", "ratio", "--from", "0", "--to", "1", option, "nan"), 2, option)
        self.check_error(equidem(*sweep, "--key", "ratio", "--from=-1e308", "--to", "1e308"), 2, "overflow")
        self.check_error(equidem(*sweep, "--key", "ratio", "--values", "0", "--resume"), 2, "--out")
        self.check_error(equidem(*sweep, "--list", "--key", "ratio", "--values", "0,1", "--key", "assembly.rows", "--values",
                                 "9"), 2, "ratio takes 2 values and assembly.rows takes 1", "--list")
        self.check_error(equidem(*sweep, "--seeds", "1-3"), 2, "seed", "does not apply")
        self.check_error(equidem(*sweep, "--key", "seed", "--values", "a"), 2, "'seed'", "--seeds")
        self.check_error(equidem(*sweep, "--seeds", "3-1"), 2, "--seeds", "3-1")
        self.check_error(equidem(*sweep, "--seeds", "1", "--seed", "1"), 2, "--seed and --seeds")
        self.check_error(equidem("sweep", CASES / "grains_cradle.toml", "--verb", "run", "--seeds", "1-3"), 2, "--seeds",
                         "random")
        self.check_error(equidem(*sweep, "--verb", "slove", "--key", "ratio", "--values", "0"), 2, "'slove'", "solve")
        self.check_error(equidem(*sweep, "--verb", "study", "--key", "ratio", "--values", "0"), 2, "'study'", "no case")
        many = ("--from", "0", "--to", "1", "--steps", "10000")
        self.check_error(equidem(*sweep, "--key", "ratio", *many, "--key", "springs.kN", *many), 2, "1e+08 points", "GB",
                         "hours", "1 000 000")
        self.check_error(equidem("sweep", CASES / "calibrate_random.toml", "--key", "ratio", "--values", "0"), 2, "needs springs")

    def test_the_ratio_of_a_point_is_that_to_its_own_kN(self):
        keys = (("--key", "springs.kN", "--values", "1e9,3e9"), ("--key", "ratio", "--values", "0,0.5"))
        for first, second in (keys, keys[::-1]):
            result = self.sweep(CASES / "hexagonal_cell.toml", "--verb", "homogenize", *first, *second)
            for point in result["points"]:
                G = 3**0.5 / 4 * point["springs.kN"] * (1 + point["ratio"])
                self.assertLess(abs(point["shear_modulus"] / G - 1), 1e-12, point)
        two = ("--key", "ratio", "--values", "0.5", "--key", "springs.kT", "--values", "2e7")
        self.check_error(equidem("sweep", TENSION, *two), 2, "ratio and springs.kT", "both set springs.kT")
        seeds = ("--seeds", "1,2", "--key", "assembly.seed", "--values", "5")
        self.check_error(equidem("sweep", CASES / "random_cell.toml", "--verb", "homogenize", *seeds), 2, "--seeds",
                         "both set assembly.seed")

    def test_a_file_that_has_changed_is_no_reason_to_go_on(self):
        discs = [((i + 0.5 * (row % 2)) * 0.02, row * 0.01 * 3**0.5) for row in range(6) for i in range(6)]
        table, case, out = self.folder / "discs.csv", self.folder / "case.toml", self.folder / "out"
        write = lambda some: table.write_text("x_m,y_m,radius_m\n" + "".join(f"{x},{y},0.01\n" for x, y in some))
        case.write_text('schema = "equidem/1"\n[assembly]\nkind = "file"\npath = "discs.csv"\ngap_tolerance = 1e-6\n'
                        '[springs]\nkN = 1e9\nkT = 5e8\n[strength]\ntension = 1e5\nshear = 1e5\n'
                        '[[support]]\ngroup = "bottom"\nux = true\nuy = true\n[[load]]\ngroup = "top"\nforce = [0.0, 1.0]\n'
                        '[quasistatic]\nmax_events = 1\n')
        for verb, more in (("sweep", ("--verb", "homogenize", "--key", "effects.rotation", "--values", "free,restrained")),
                           ("quasistatic", NO_PICTURE)):
            write(discs)
            command = (verb, case, *more, "--out", out / verb)
            self.check_done(equidem(*command))
            self.check_done(equidem(*command, "--resume"))
            write(discs[:-1])
            self.check_error(equidem(*command, "--resume"), 2, "of another case", "a file that")

    def test_the_curve_follows_theory(self):
        out = self.folder / "out"
        done = self.check_done(equidem("sweep", TENSION, "--key", "ratio", "--from", "0", "--to", "1", "--steps", "3",
                                       "--out", out, "--json", "-"))
        result = parse_json(done.stdout)
        self.assertTrue(result["complete"])
        self.assertEqual([point["value"] for point in result["points"]], [0, 0.5, 1])
        for point in result["points"]:
            self.assertEqual(point["status"], "solved")
            self.assertLess(abs(point["poisson_ratio"] - (1 - point["value"]) / 4), 0.01)
        self.assertEqual([row["ratio"] for row in rows(out)], ["0", "0.5", "1"])
        for name in ("poisson_ratio.csv", "poisson_ratio.gp", "stiffness_ratio.csv", "case.toml", "result.json"):
            self.assertTrue((out / name).exists(), name)

    def test_a_number_named_as_the_key_is_one_column(self):
        out = self.folder / "stability"
        self.check_done(equidem("sweep", CASES / "hexagonal_cell.toml", "--verb", "stability", "--key", "ratio",
                                "--values", "0.1,0.2", "--out", out))
        head = (out / "sweep.csv").read_text().splitlines()[0].split(",")
        self.assertEqual(head.count("ratio"), 1)

    def test_the_title_of_the_curve_is_the_users_and_its_symbols_are_typeset(self):
        for number, (options, title) in enumerate([(["--title", "My a_b {sweep}"], r"My a\_b \{sweep\}"),
                                                   (["--set", 'title="Block of 50_000"'], r"Block of 50\_000"),
                                                   (["--set", 'title=""'], "k_T/k_N varied")]):
            out = self.folder / str(number)
            self.check_done(equidem("sweep", TENSION, "--key", "ratio", "--values", "0,0.5", "--out", out, *options))
            script = (out / "stiffness_ratio.gp").read_text(encoding="utf-8")
            self.assertIn(f"set title '{title}'", script)
            self.assertIn("set ylabel '2G/((1 - ν) k_N)'", script)

    def test_a_point_equals_the_solve_of_its_value(self):
        swept = parse_json(self.check_done(equidem("sweep", TENSION, "--key", "springs.kT", "--values", "0.25e9",
                                                   "--json", "-")).stdout)
        solved = parse_json(self.check_done(equidem("solve", TENSION, "--set", "springs.kT=0.25e9", "--json", "-")).stdout)
        self.assertEqual(swept["points"][0]["poisson_ratio"], solved["poisson_ratio"])

    def test_a_point_that_fails_stays_with_its_sentence(self):
        done = self.check_done(equidem("sweep", TENSION, "--key", "springs.kN", "--values", "-1,1e9", "--json", "-"))
        bad, good = parse_json(done.stdout)["points"]
        self.assertEqual(bad["status"], "failed")
        self.assertIn("out of range", bad["message"])
        self.assertNotIn("poisson_ratio", bad)
        self.assertEqual(good["status"], "solved")

    def test_reasons_of_failures_stand_below_the_table_once_each(self):
        done = self.check_done(equidem("sweep", CASES / "random_cell.toml", "--verb", "homogenize", *sets("assembly.discs=60"),
                                       "--key", "springs.kN", "--values", "-1,1e9", "--seeds", "1-3"))
        lines = done.stdout.splitlines()
        self.assertEqual([line.split() for line in lines if "failed" in line],
                         [["-1", "1", "failed"], ["-1", "2", "failed"], ["-1", "3", "failed"],
                          ["failed", "3", "points;", "3", "done"]])
        self.assertEqual(done.stdout.count("is out of range"), 1)
        self.assertIn("points 1, 2, 3: --set springs.kN=-1", done.stdout)
        self.assertLess(max(map(len, lines)), 115)

    def test_one_value_makes_no_curve(self):
        out = self.folder / "out"
        self.sweep(TENSION, "--key", "ratio", "--values", "0.5", "--out", out)
        self.sweep(TENSION, "--key", "springs.kN", "--values", "1e9,-1", "--out", self.folder / "other")
        self.assertEqual([*out.glob("*.gp"), *(self.folder / "other").glob("*.gp")], [])
        self.assertTrue((out / "sweep.csv").exists())

    def test_a_run_shows_what_it_measures(self):
        out = self.folder / "out"
        rest = equidem("sweep", CASES / "run_tension.toml", "--verb", "run", "--key", "ratio", "--values", "0,0.5", "--out", out)
        self.assertIn("E strain, Pa", self.check_done(rest).stdout)
        self.assertTrue((out / "plane_strain_young_modulus.gp").exists())
        solved = parse_json(self.check_done(equidem("solve", CASES / "run_tension.toml", "--json", "-")).stdout)
        self.assertAlmostEqual(float(rows(out)[1]["plane_strain.young_modulus_Pa"]) / solved["plane_strain"]["young_modulus"],
                               1, delta=1e-9)

    def test_energies_of_runs_have_their_units(self):
        for case, key, unit in (("run_pulse", "springs.kT", "J_per_m"), ("grains_cradle", "collisions.restitution", "J")):
            out = self.folder / case
            result = self.sweep(CASES / f"{case}.toml", "--verb", "run", "--key", key, "--values", "0.5,0.8", "--out", out)
            columns = [name for name in rows(out)[0] if name.startswith("energy.")]
            self.assertGreater(len(columns), 5)
            for name in columns:
                self.assertTrue(name == "energy.relative_error" or name.endswith("_" + unit), name)
            for k, row in enumerate(rows(out)):
                self.assertEqual(float(row["energy.kinetic_" + unit]), result["points"][k]["energy"]["kinetic"])
            self.assertIn("kinetic energy, J", (out / "energy_kinetic.gp").read_text(encoding="utf-8"))

    def test_a_key_that_does_not_exist_is_answered_with_the_nearest(self):
        sweep = ("sweep", CASES / "packed_rock.toml", "--verb", "homogenize", "--values", "0.1", "--key")
        self.check_error(equidem(*sweep, "gap_tolerance"), 2, "Write packing.gap_tolerance.")
        self.check_error(equidem(*sweep, "gap_tolerence"), 2, "Did you mean packing.gap_tolerance?")
        self.check_error(equidem(*sweep, "ratoi"), 2, "--key ratio")
        springs = self.folder / "springs.toml"
        springs.write_text('schema = "equidem-springs/1"\n[springs]\nkN = 1e9\nkT = 2e8\n')
        done = equidem("sweep", TENSION, *sets(f"springs='{springs}'"), "--key", "springs.kN", "--values", "1e9,2e9")
        self.assertEqual(done.returncode, 1, done.stderr)
        self.assertIn("varies kT/kN by --key ratio", done.stderr)

    def test_when_all_points_fail_so_does_the_sweep(self):
        done = equidem("sweep", TENSION, "--key", "springs.kN", "--values", "-1,-2")
        self.assertEqual(done.returncode, 1)
        self.assertIn("out of range", done.stderr)

    def test_unstable_points_are_marked(self):
        done = self.check_done(equidem("sweep", TENSION, "--key", "ratio", "--values", "-0.1,-0.35", "--json", "-"))
        stable, unstable = parse_json(done.stdout)["points"]
        self.assertEqual(stable["unstable_modes"], 0)
        self.assertEqual(stable["status"], "solved")
        self.assertGreater(unstable["unstable_modes"], 0)
        self.assertEqual(unstable["status"], "unstable")

    def test_the_first_interrupt_that_is_caught_ends_it_as_an_interrupted_one(self):
        for milliseconds in range(0, 60, 3):
            with self.subTest(milliseconds=milliseconds):
                self.interrupt("sweep", TENSION, "--key", "springs.kT", "--from", 0, "--to", "1e9", "--steps", 100000,
                               after=1e-3 * milliseconds)

    def test_interrupted_it_keeps_what_is_done_and_resume_completes_it(self):
        out = self.folder / "out"
        stdout, stderr = self.interrupt("sweep", TENSION, "--key", "springs.kT", "--from", 0, "--to", "1e9", "--steps", 100000,
                                        "--out", out, when=lambda: (out / "sweep.csv").exists())
        self.assertIn("INCOMPLETE", stdout)
        self.assertIn("--resume", stderr)
        done = rows(out)
        self.assertGreater(len(done), 0)
        self.assertEqual(parse_json((out / "result.json").read_text())["status"], "interrupted")

        values = [row["springs.kT_Pa"] for row in done] + ["0.9e9", "1e9"]
        shorter = ["sweep", TENSION, "--key", "springs.kT", "--values", ",".join(values), "--out", out]
        self.check_error(equidem(*shorter), 2, "exists already")
        self.check_error(equidem(*shorter, "--resume", "--set", "springs.kN=2e9"), 2, "another case")
        self.check_error(equidem(*shorter, "--resume", "--verb", "stability"), 2, "another case")
        self.check_done(equidem(*shorter, "--resume"))
        completed = rows(out)
        for row in done + completed:
            del row["point"], row["checksum"]  # positions in the lists of values
        self.assertEqual(completed[:len(done)], done)
        self.assertEqual(len(completed), len(done) + 2)
        self.assertTrue(parse_json((out / "result.json").read_text())["complete"])

class Numbers(ProgramTest):
    def test_every_number_has_unit_and_label(self):
        shaken = sets("run.duration=2e-3", "shaking.start=1e-3")
        for command in (("solve", TENSION), ("solve", CASES / "cantilever.toml"), ("solve", CASES / "truss.toml"),
                        ("solve", TENSION, "--accuracy", "1e-2"), ("homogenize", CASES / "hexagonal_cell.toml"),
                        ("homogenize", CASES / "free_sample.toml"), ("homogenize", CASES / "restrained_rotation.toml"),
                        ("homogenize", CASES / "ensemble.toml", *sets("ensemble.discs=[20, 30]", "ensemble.samples=3")),
                        ("calibrate", CASES / "calibrate_random.toml", *sets("assembly.discs=60")),
                        ("calibrate", CASES / "packed_rock.toml", *sets(*ROCK)),
                        ("stability", CASES / "hexagonal_cell.toml"), ("stability", TENSION),
                        ("stability", CASES / "random_cell.toml", *sets("assembly.discs=30", "springs.kT=-1e8")),
                        ("pack", CASES / "packed_rock.toml", *sets(*ROCK)), ("pack", CASES / "pack_pairs.toml", "--dry-run"),
                        ("pack", CASES / "pack_soil.toml", *sets("packing.grains=30")),
                        ("run", CASES / "run_tension.toml"), ("run", CASES / "run_pulse.toml"),
                        ("run", CASES / "run_pulse.toml", "--dry-run"), ("run", CASES / "grains_cradle.toml"),
                        ("run", CASES / "grains_shaken.toml", *shaken), ("run", CASES / "grains_bonded.toml"),
                        ("sweep", TENSION, "--key", "springs.kT", "--values", "0,1e9")):
            with self.subTest(command=" ".join(map(str, command))):
                result = parse_json(self.check_done(equidem(*command, "--json", "-")).stdout)
                found = {path for path, _ in numbers_of({key: entry for key, entry in result.items()
                                                         if key not in ("units", "labels")}, positions=False)}
                self.assertGreater(len(found), 2)
                self.assertEqual(sorted(found - set(result["units"])), [])
                self.assertEqual(set(result["units"]), set(result["labels"]))

    def test_units_are_those_of_the_report(self):
        moduli = parse_json(self.check_done(equidem("homogenize", CASES / "hexagonal_cell.toml", "--json", "-")).stdout)
        self.assertEqual(moduli["units"]["young_modulus.plane_strain"], "Pa")
        self.assertEqual(moduli["units"]["error_bound"], "Pa")
        self.assertEqual(moduli["labels"]["poisson_ratio.plane_strain"], "Poisson's ratio nu, plane strain")
        solved = parse_json(self.check_done(equidem("solve", TENSION, "--json", "-")).stdout)
        self.assertEqual((solved["units"]["energy"], solved["units"]["error_bound"]), ("N", ""))
        cradle = parse_json(self.check_done(equidem("run", CASES / "grains_cradle.toml", "--json", "-")).stdout)
        self.assertEqual(cradle["units"]["energy.kinetic"], "J" if cradle["body"] == "sphere" else "J/m")

    def test_help_lists_them(self):
        text = self.check_done(equidem("help", "result")).stdout
        for words in ('"units"', '"labels"', "poisson_ratio", "Pa", "critical_time_step"):
            self.assertIn(words, text)


if __name__ == "__main__":
    unittest.main()
