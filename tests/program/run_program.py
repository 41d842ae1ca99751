#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Usage and solve, as a user does: run_program.py PROGRAM SOURCE_FOLDER [unittest options]."""
import csv
import json
import math
import os
import pathlib
import re
import subprocess
import unittest
import xml.etree.ElementTree

from program import CASES, PROGRAM, SOURCE, TENSION, ProgramTest, equidem, parse_json


class Usage(ProgramTest):
    def test_help_shows_examples_verbs_and_exit_codes(self):
        for arguments in (["--help"], ["help"]):
            text = self.check_done(equidem(*arguments)).stdout
            for word in ("solve", "sweep", "Examples:", "Exit codes:", "130"):
                self.assertIn(word, text)

    def test_help_of_a_verb_lists_its_options(self):
        for arguments in (["solve", "--help"], ["help", "solve"], ["sweep", "--help"]):
            text = self.check_done(equidem(*arguments)).stdout
            for word in ("--set", "--out", "--json", "--threads", "--seed", "--dry-run", "--quiet", "--overwrite"):
                self.assertIn(word, text)

    def test_help_case_lists_every_table(self):
        text = self.check_done(equidem("help", "case")).stdout
        for word in ("[assembly]", "[springs]", "[material]", "[test]", "[[support]]", "[[load]]", "kN", "default"):
            self.assertIn(word, text)
        self.assertLessEqual(max(map(len, text.splitlines())), 110)

    def test_help_case_shows_one_table_alone(self):
        for name in ("springs", "[springs]", "springs.kT"):
            text = self.check_done(equidem("help", "case", name)).stdout
            self.assertIn("kT", text)
            self.assertNotIn("[material]", text)
            self.assertLess(len(text.splitlines()), 60)
        walls = self.check_done(equidem("help", "case", "wall")).stdout
        self.assertEqual(walls.count("[[wall]]"), 1, walls)
        self.assertIn("(colliding bodies) false: [shaking]", walls)
        self.check_error(equidem("help", "case", "sprigns"), 2, "no table [sprigns]", "'springs'")
        for words in (("case", "springs", "kT"), ("result", "nu"), ("solve", "x"), ("engines", "x"), ("case", "--markdown", "x")):
            self.check_error(equidem("help", *words), 2, "one argument too many")

    def test_help_case_as_markdown_is_the_reference_page(self):
        page = (SOURCE / "docs" / "case_file.md").read_text(encoding="utf-8")
        self.assertEqual(self.check_done(equidem("help", "case", "--markdown")).stdout, page)

    def test_version_names_version_and_libraries(self):
        text = self.check_done(equidem("--version")).stdout
        self.assertRegex(text, r"equidem \d+\.\d+\.\d+")
        self.assertIn("CLI11", text)

    def test_bad_usage_is_exit_code_2_with_the_nearest_word(self):
        self.check_error(equidem(), 2, "a verb is missing", "--help")
        self.check_error(equidem("slove", TENSION), 2, "unknown verb 'slove'", "'solve'")
        self.check_error(equidem("reproduce", "abe1996"), 2, "'reproduce'", "tools/papers")
        self.check_error(equidem("--frob"), 2, "--frob")
        self.check_error(equidem("help", "solv"), 2, "'solve'")
        self.check_error(equidem("solve"), 2, "case file is missing")
        self.check_error(equidem("solve", TENSION, TENSION), 2, "one argument too many")
        self.check_error(equidem("solve", TENSION, "--treads", "2"), 2, "'--threads'")
        self.check_error(equidem("solve", TENSION, "--threads", "0"), 2, "--threads")
        self.check_error(equidem("solve", TENSION, "--set", "springs.kT"), 2, "springs.kT", "sets nothing")

    def test_bad_input_is_exit_code_2_with_its_place(self):
        self.check_error(equidem("solve", self.folder / "absent.toml"), 2, "absent.toml", "no such file")
        self.check_error(equidem("solve", self.folder), 2, "it is a folder")
        broken = self.folder / "broken.toml"
        broken.write_text(pathlib.Path(TENSION).read_text().replace("columns", "colums"))
        self.check_error(equidem("solve", broken), 2, "broken.toml:", "assembly.colums", "'columns'")
        self.check_error(equidem("solve", TENSION, "--seed", "3"), 2, "seed", "does not apply")
        self.check_error(equidem("solve", TENSION, "--set", "assembly.rows=2"), 2)


class Solve(ProgramTest):
    def test_json_on_stdout_is_all_there_is_and_has_the_documented_keys(self):
        done = self.check_done(equidem("solve", TENSION, "--json", "-"))
        result = parse_json(done.stdout)
        for key in ("status", "report", "times", "effects", "version", "unknowns", "relative_residual",
                    "negative_pivots", "poisson_ratio", "stiffness_ratio", "strain", "stress"):
            self.assertIn(key, result)
        self.assertEqual(result["status"], "solved")
        self.assertEqual(set(result["effects"]), {"active", "inactive"})
        self.assertLess(result["relative_residual"], 1e-12)
        self.assertEqual(result["negative_pivots"], 0)
        self.assertEqual(len(result["strain"]), 3)
        self.assertEqual(len(result["stress"]), 3)
        # -e22 / (e11 - e22), eq. (35)
        e11, e22, _ = result["strain"]
        self.assertTrue(math.isclose(result["poisson_ratio"], -e22 / (e11 - e22), rel_tol=1e-12))
        self.assertLess(abs(result["poisson_ratio"] - result["theory"]["poisson_ratio"]), 0.01)

    def test_set_changes_the_answer_as_the_file_would(self):
        changed = self.folder / "changed.toml"
        changed.write_text(pathlib.Path(TENSION).read_text().replace("kT = 0.5e9", "kT = 0.0"))
        by_file = parse_json(self.check_done(equidem("solve", changed, "--json", "-")).stdout)
        by_set = parse_json(self.check_done(equidem("solve", TENSION, "--set", "springs.kT=0", "--json", "-")).stdout)
        for key in ("poisson_ratio", "stiffness_ratio", "strain", "stress", "energy"):
            self.assertEqual(by_file[key], by_set[key])
        # At kT = 0 theory is exact at every size: nu = 1/4.
        self.assertTrue(math.isclose(by_set["poisson_ratio"], 0.25, rel_tol=1e-12), by_set["poisson_ratio"])

    def test_the_answer_does_not_depend_on_the_number_of_threads(self):
        answers = [parse_json(self.check_done(equidem("solve", CASES / "delaunay_tension.toml", "--threads", n,
                                                      "--json", "-")).stdout) for n in (1, 2, 3)]
        for answer in answers[1:]:
            self.assertEqual(answer["strain"], answers[0]["strain"])
            self.assertEqual(answer["energy"], answers[0]["energy"])

    def test_every_case_of_the_data_folder_in_which_something_acts_is_solved(self):
        acts = [case for case in sorted(CASES.glob("*.toml")) if not case.name.startswith("run_")
                if any(table in case.read_text() for table in ("\n[test]", "\n[[load]]", "\n[[support]]"))]
        self.assertGreaterEqual(len(acts), 5)
        for case in acts:
            with self.subTest(case=case.name):
                done = self.check_done(equidem("solve", case))
                self.assertIn("residual", done.stdout)
                self.assertIn("stability       stable", done.stdout)
                self.assertEqual(done.stderr, "")

    def test_moments_explain_an_asymmetric_stress(self):
        result = parse_json(self.check_done(equidem("solve", CASES / "restrained_rotation.toml", "--json", "-")).stdout)
        self.assertGreater(abs(result["stress_asymmetry"]), 0.1 * abs(result["stress"][2]))
        self.assertTrue(math.isclose(result["stress_asymmetry"], result["moment_per_area"], rel_tol=1e-9), result)
        free = parse_json(self.check_done(equidem("solve", CASES / "restrained_rotation.toml",
                                                  "--set", "effects.rotation=free", "--json", "-")).stdout)
        self.assertLess(abs(free["stress_asymmetry"]), 1e-9 * abs(free["stress"][2]))

    def test_a_stress_of_forces_that_cancel_is_symmetric_where_no_moment_acts(self):
        # A strip that is bent: the forces of its halves cancel in the mean, which is round-off.
        bent = self.folder / "bent.toml"
        bent.write_text('schema = "equidem/1"\n[assembly]\nkind = "hexagonal"\ncolumns = 60\nrows = 7\nradius = 0.01\n'
                        '[springs]\nkN = 1e9\nkT = 3e8\n[[support]]\ngroup = "left"\nux = true\nuy = true\n' +
                        "".join(f'[[group]]\nname = "{name}"\nbox = [1.18, {low}, 2.0, {high}]\n[[load]]\ngroup = "{name}"\n'
                                f'force = [{force}, 0.0]\n'
                                for name, low, high, force in (("low", -1, 0.03, -1e3), ("high", 0.09, 1, 1e3))))
        for turned in ((), ("--set", "springs.kT=1e-2")):
            done = self.check_done(equidem("solve", bent, *turned))
            self.assertIn("stress", done.stdout)
            self.assertNotIn("not symmetric", done.stdout)

    def test_an_asymmetry_that_the_error_of_the_solution_may_make_is_not_known(self):
        # Moments of a millionth of the work of the stress: more than round-off, and less than what iterations leave.
        turned = self.folder / "turned.toml"
        turned.write_text('schema = "equidem/1"\n[assembly]\nkind = "hexagonal"\ncolumns = 30\nrows = 30\nradius = 0.01\n'
                          '[springs]\nkN = 1e9\nkT = 3e8\n[[support]]\ngroup = "left"\nux = true\nuy = true\n'
                          '[[load]]\ngroup = "right"\nkind = "total"\nforce = [1e3, 0.0]\nmoment = 6e-4\n')
        exact = self.check_done(equidem("solve", turned)).stdout
        self.assertIn("not symmetric: xy - yx = 0.00", exact)
        rough = self.check_done(equidem("solve", turned, "--set", "solver.method=multigrid", "--accuracy", "0.5")).stdout
        self.assertNotIn("not symmetric", rough)
        self.assertIn("whether it is symmetric is not known: xy - yx = ", rough)

    def test_files_are_written_and_the_echoed_case_repeats_the_result(self):
        out = self.folder / "new" / "out"
        done = self.check_done(equidem("solve", CASES / "truss.toml", "--out", out))
        self.assertIn(str(out), done.stderr)
        names = {path.name for path in out.iterdir()}
        self.assertLessEqual({"result.json", "case.toml", "discs.csv", "contacts.csv", "state.vtm", "picture.svg",
                              "picture.png"}, names)
        first = parse_json((out / "result.json").read_text())
        again = parse_json(self.check_done(equidem("solve", out / "case.toml", "--json", "-")).stdout)
        self.assertEqual(first["energy"], again["energy"])
        with open(out / "discs.csv", newline="") as file:
            self.assertEqual(len(list(csv.DictReader(file))), 3)

    def test_load_cases_share_a_run_and_keep_their_own_files(self):
        out = self.folder / "out"
        done = self.check_done(equidem("solve", CASES / "cantilever.toml", "--out", out, "--json", "-"))
        result = parse_json(done.stdout)
        self.assertEqual([one["case"] for one in result["load_cases"]], ["weight", "tip"])
        for name in ("weight", "tip"):
            self.assertTrue((out / f"discs_{name}.csv").exists())

    def test_nothing_is_overwritten_unasked(self):
        out = self.folder / "out"
        self.check_done(equidem("solve", CASES / "truss.toml", "--out", out))
        before = (out / "result.json").read_bytes()
        self.check_error(equidem("solve", CASES / "truss.toml", "--out", out), 2, "exists already", "--overwrite")
        self.assertEqual((out / "result.json").read_bytes(), before)
        self.check_done(equidem("solve", CASES / "truss.toml", "--out", out, "--overwrite"))
        target = self.folder / "x.json"
        target.write_text("mine")
        self.check_error(equidem("solve", TENSION, "--json", target), 2, "x.json", "exists already")
        self.assertEqual(target.read_text(), "mine")

    def test_an_output_that_cannot_be_written_is_told_before_the_computation(self):
        obstacle = self.folder / "file"
        obstacle.write_text("")
        self.check_error(equidem("solve", TENSION, "--out", obstacle / "out"), 2, "cannot write", "not a folder")
        self.check_error(equidem("solve", TENSION, "--json", self.folder), 2, "cannot write", "folder")
        if os.geteuid() != 0:
            locked = self.folder / "locked"
            locked.mkdir(mode=0o500)
            self.check_error(equidem("solve", TENSION, "--out", locked / "out"), 2, "cannot write", "locked")

    def test_quiet_says_nothing_and_dry_run_solves_nothing(self):
        done = self.check_done(equidem("solve", TENSION, "--quiet"))
        self.assertEqual((done.stdout, done.stderr), ("", ""))
        out = self.folder / "out"
        done = self.check_done(equidem("solve", TENSION, "--dry-run", "--out", out, "--json", "-"))
        size = parse_json(done.stdout)
        self.assertEqual(size["status"], "dry_run")
        self.assertFalse(out.exists())
        solved = parse_json(self.check_done(equidem("solve", TENSION, "--json", "-")).stdout)
        self.assertEqual(size["unknowns"], solved["unknowns"])
        self.assertEqual(size["factor_nonzeros"], solved["factor_nonzeros"])

    def test_a_dry_run_tells_the_size_of_every_verb_of_statics(self):
        for verb, case in (("solve", TENSION), ("homogenize", CASES / "random_cell.toml"),
                           ("calibrate", CASES / "calibrate_random.toml"), ("stability", CASES / "hexagonal_cell.toml")):
            with self.subTest(verb=verb):
                size = parse_json(self.check_done(equidem(verb, case, "--dry-run", "--json", "-")).stdout)
                self.assertGreater(size["peak_bytes"], size["solver_bytes"])
                self.assertNotIn("estimated_seconds", size)

    def test_a_dry_run_says_where_the_memory_does_not_suffice(self):
        limited = ("--set", "solver.memory_limit=1e5", "--dry-run")
        size = parse_json(self.check_done(equidem("solve", TENSION, *limited, "--json", "-")).stdout)
        self.assertIn("would be refused", size["report"])
        self.assertIn("memory_limit", size["refusal"])
        self.check_error(equidem("solve", TENSION, *limited[:2]), 1, "are allowed by memory_limit")
        self.assertIsNone(parse_json(self.check_done(equidem("solve", TENSION, "--dry-run", "--json", "-")).stdout)["refusal"])

    def test_a_table_or_an_assembly_in_place_of_a_case_is_recognised(self):
        self.check_error(equidem("solve", CASES / "pack_graded.csv"), 2, "this is a CSV table, not a case file")
        self.check_error(equidem("solve", CASES / "truss.json"), 2, "this is JSON, not a case file", '[assembly]')
        self.check_error(equidem("solve", CASES / "truss.toml", "--set", "assembly.path=grains_piston.csv"), 2,
                         "grains_piston.csv", "does not say its unit of length", "assembly.unit_of_length")

    def test_deformations_that_do_not_fit_the_units_are_questioned(self):
        def deformation(*options):
            result = parse_json(self.check_done(equidem("solve", TENSION, *options, "--json", "-")).stdout)
            line = result["report"].split("deformation ")[1].split("\n\n")[0].split("energy  ")[0]
            return result["largest_deformation"], " ".join(line.split())

        usual, told = deformation()
        self.assertNotIn("other units", told)
        self.assertNotIn("much", told)
        stress = parse_json(self.check_done(equidem("solve", TENSION, "--json", "-")).stdout)["stress"][0]
        little, told = deformation("--set", f"test.stress={stress * 1e-9 / usual * 0.5}")
        self.assertAlmostEqual(little / 0.5e-9, 1, delta=0.01)
        self.assertIn("in other units than meant", told)
        much, told = deformation("--set", f"test.stress={stress * 0.1 / usual}")
        self.assertAlmostEqual(much / 0.1, 1, delta=0.01)
        self.assertIn("the motions are taken as small", told)

    def test_a_case_that_cannot_stand_says_which_motion_is_free(self):
        done = equidem("solve", CASES / "truss.toml", "--set", "support=[{group = \"apex\", ux = true}]")
        self.check_error(done, 2, "free")


class Hostile(ProgramTest):
    """Input that must end in a sentence, never in a hang or a wrong verdict."""

    def truss_reading(self, write):
        (self.folder / "truss.toml").write_text((CASES / "truss.toml").read_text())
        write(self.folder / "truss.json")
        return equidem("solve", self.folder / "truss.toml")

    def test_a_file_that_may_never_end_is_refused(self):
        self.check_error(self.truss_reading(os.mkfifo), 2, "truss.json", "no regular file")

    def test_an_empty_assembly_file_is_called_empty(self):
        self.check_error(self.truss_reading(lambda path: path.write_text(" \n")), 2, "truss.json", "empty")

    def test_control_characters_reach_neither_terminals_nor_pages(self):
        text = (CASES / "notched_plate.toml").read_text()
        case = self.folder / "titled.toml"
        for title in (r"a\u001b[31m", r"a\u0001", r"a\u007f", r"a\u009b2J"):
            case.write_text(re.sub(r'title *=.*', lambda _: f'title = "{title}"', text))
            line = case.read_text().split("title", 1)[0].count("\n") + 1
            self.check_error(equidem("quasistatic", case), 2, f"titled.toml:{line}", "control characters")
        done = equidem("sweep", TENSION, "--key", "ratio", "--values", "0,1", "--title", "a\x1b[2J")
        self.check_error(done, 2, "--title", "control characters")
        self.assertNotIn("\x1b", done.stderr)
        case.write_text(re.sub(r'title *=.*', lambda _: 'title = "a ]]> b <c> & d"', text))
        self.check_done(equidem("quasistatic", case, "--out", self.folder / "out"))
        for name in ("curve.svg", "cracks.svg"):
            if (self.folder / "out" / name).exists():
                xml.etree.ElementTree.parse(self.folder / "out" / name)

    def test_a_list_of_many_names_is_cut(self):
        text = json.loads((CASES / "truss.json").read_text())
        text["groups"].update({f"group_{k}": [0] for k in range(3000)})
        (self.folder / "truss.json").write_text(json.dumps(text))
        (self.folder / "truss.toml").write_text(re.sub(r'group *= *"[^"]*"', 'group = "nowhere"', (CASES / "truss.toml").read_text()))
        done = equidem("solve", self.folder / "truss.toml")
        self.check_error(done, 2, "no group 'nowhere'", "..., 3 0", " in all")
        self.assertLess(len(done.stderr), 500)

    def test_a_key_given_twice_is_refused(self):
        text = (CASES / "truss.json").read_text().replace('"discs"', '"discs": [], "discs"', 1)
        self.check_error(self.truss_reading(lambda path: path.write_text(text)), 2, "'discs'", "twice")

    def test_springs_too_far_apart_are_no_mechanism(self):
        done = equidem("solve", TENSION, "--set", "springs.kT=1e30")
        self.check_error(done, 2, "springs differ by a factor")
        self.assertNotIn("mechanism", done.stderr)

    def test_numbers_that_overflow_are_called_that(self):
        self.check_error(equidem("solve", TENSION, "--set", "test.stress=1e300"), 2, "overflow")

    def test_a_state_that_the_solver_cannot_judge_is_not_called_stable(self):
        given = ["--set", "springs.kT=-0.35e9", "--set", 'solver.method="umfpack"']
        self.assertIn("NOT KNOWN", self.check_done(equidem("solve", TENSION, *given)).stdout)
        result = parse_json(self.check_done(equidem("solve", TENSION, *given, "--json", "-")).stdout)
        self.assertEqual(result["status"], "unjudged")
        self.assertIsNone(result["unstable_modes"])
        judged = parse_json(self.check_done(equidem("solve", TENSION, *given[:2], "--json", "-")).stdout)
        self.assertEqual(judged["status"], "unstable")


if __name__ == "__main__":
    unittest.main()
