# SPDX-License-Identifier: GPL-3.0-or-later
"""Usage and solve, as a user does: run_program.py PROGRAM SOURCE_FOLDER [unittest options]."""
import json
import math
import os
import pathlib
import re
import unittest
import xml.etree.ElementTree

from program import CASES, COMMANDS, SOURCE, TENSION, ProgramTest, equidem, flat, result_in, rows_of

TRUSS = CASES / "truss.toml"
LEFT = '[[support]]\ngroup = "left"\nux = true\nuy = true\n'


def block(columns, rows, more):
    return f'[assembly]\nkind = "hexagonal"\ncolumns = {columns}\nrows = {rows}\nradius = 0.01\n[springs]\nkN = 1e9\nkT = 3e8\n{LEFT}{more}'


class Usage(ProgramTest):
    def test_help_has_what_it_is_asked_for(self):
        options = ("--set", "--out", "--json", "--threads", "--seed", "--dry-run", "--quiet", "--overwrite")
        tables = ("[assembly]", "[springs]", "[material]", "[test]", "[[support]]", "[[load]]", "kN", "default")
        for words, *found in ((("--help",), "solve", "sweep", "Examples:", "Exit codes:", "130"),
                              (("help",), "solve", "sweep", "Examples:", "Exit codes:", "130"),
                              (("solve", "--help"), *options), (("help", "solve"), *options), (("sweep", "--help"), *options),
                              (("help", "case"), *tables), (("--version",), "CLI11")):
            text = self.done(*words).stdout
            for word in found:
                self.assertIn(word, text, words)
        self.assertRegex(text, r"equidem \d+\.\d+\.\d+")
        self.assertLessEqual(max(map(len, self.done("help", "case").stdout.splitlines())), 110)

    def test_help_case_shows_one_table_alone(self):
        for name in ("springs", "[springs]", "springs.kT"):
            text = self.done("help", "case", name).stdout
            self.assertIn("kT", text)
            self.assertNotIn("[material]", text)
            self.assertLess(len(text.splitlines()), 60)
        walls = self.done("help", "case", "wall").stdout
        self.assertEqual(walls.count("[[wall]]"), 1, walls)
        self.assertIn("(colliding bodies) false: [shaking]", walls)

    def test_help_case_as_markdown_is_the_reference_page(self):
        page = (SOURCE / "docs" / "case_file.md").read_text(encoding="utf-8")
        self.assertEqual(self.done("help", "case", "--markdown").stdout, page)

    def test_examples_of_the_help_are_there(self):
        for verb in ("solve", "run", "pack", "homogenize"):
            examples = re.findall(r"data/cases/(\S+\.toml)", self.done(verb, "--help").stdout)
            self.assertTrue(examples)
            self.check_there(CASES, *examples)

    def test_bad_usage_is_exit_code_2_with_the_nearest_word(self):
        self.check_errors(
            ((), "a verb is missing", "--help"), (("slove", TENSION), "unknown verb 'slove'", "'solve'"),
            (("reproduce", "abe1996"), "'reproduce'", "tools/papers"), ("--frob", "--frob"), (("help", "solv"), "'solve'"),
            ("solve", "case file is missing"), (("solve", TENSION, TENSION), "one argument too many"),
            (("solve", TENSION, "--treads", "2"), "'--threads'"), (("solve", TENSION, "--threads", "0"), "--threads"),
            (("solve", TENSION, "--set", "springs.kT"), "springs.kT", "sets nothing"),
            (("help", "case", "sprigns"), "no table [sprigns]", "'springs'"),
            *((("help", *words), "one argument too many") for words in (
                ("case", "springs", "kT"), ("result", "nu"), ("solve", "x"), ("engines", "x"), ("case", "--markdown", "x"))))

    def test_bad_input_is_exit_code_2_with_its_place(self):
        broken = self.write(pathlib.Path(TENSION).read_text().replace("columns", "colums"), "broken.toml")
        self.check_errors(
            ((self.folder / "absent.toml",), "absent.toml", "no such file"), ((self.folder,), "it is a folder"),
            ((broken,), "broken.toml:", "assembly.colums", "'columns'"), ((TENSION, "--seed", "3"), "seed", "does not apply"),
            ((TENSION, "assembly.rows=2"),), ((TRUSS, 'support=[{group = "apex", ux = true}]'), "free"),
            ((CASES / "pack_graded.csv",), "this is a CSV table, not a case file"),
            ((CASES / "truss.json",), "this is JSON, not a case file", "[assembly]"),
            ((TRUSS, "assembly.path=grains_piston.csv"), "grains_piston.csv", "does not say its unit of length",
             "assembly.unit_of_length"),
            (("/proc/self/mem",), "cannot read '/proc/self/mem'"), before=("solve",))


class Solve(ProgramTest):
    def test_poissons_ratio_is_that_of_the_strains_and_near_theory(self):
        result = self.result("solve", TENSION)
        self.assertEqual((result["status"], result["negative_pivots"]), ("solved", 0))
        self.assertEqual(set(result["effects"]), {"active", "inactive"})
        self.assertLess(result["relative_residual"], 1e-12)
        self.assertEqual((len(result["strain"]), len(result["stress"])), (3, 3))
        # -e22 / (e11 - e22), eq. (35)
        e11, e22, _ = result["strain"]
        self.assertTrue(math.isclose(result["poisson_ratio"], -e22 / (e11 - e22), rel_tol=1e-12))
        self.assertLess(abs(result["poisson_ratio"] - result["theory"]["poisson_ratio"]), 0.01)

    def test_set_changes_the_answer_as_the_file_would(self):
        by_file = self.result("solve", self.write(pathlib.Path(TENSION).read_text().replace("kT = 0.5e9", "kT = 0.0")))
        by_set = self.result("solve", TENSION, "springs.kT=0")
        for key in ("poisson_ratio", "stiffness_ratio", "strain", "stress", "energy"):
            self.assertEqual(by_file[key], by_set[key])
        # At kT = 0 theory is exact at every size: nu = 1/4.
        self.assertTrue(math.isclose(by_set["poisson_ratio"], 0.25, rel_tol=1e-12), by_set["poisson_ratio"])

    def test_every_case_of_the_data_folder_in_which_something_acts_is_solved(self):
        acts = [case for case in sorted(CASES.glob("*.toml")) if not case.name.startswith("run_")
                if any(table in case.read_text() for table in ("\n[test]", "\n[[load]]", "\n[[support]]"))]
        self.assertGreaterEqual(len(acts), 5)
        for case in acts:
            with self.subTest(case=case.name):
                done = self.done("solve", case)
                self.assertIn("residual", done.stdout)
                self.assertIn("stability       stable", done.stdout)
                self.assertEqual(done.stderr, "")

    def test_moments_explain_an_asymmetric_stress(self):
        result = self.result("solve", CASES / "restrained_rotation.toml")
        self.assertGreater(abs(result["stress_asymmetry"]), 0.1 * abs(result["stress"][2]))
        self.assertTrue(math.isclose(result["stress_asymmetry"], result["moment_per_area"], rel_tol=1e-9), result)
        free = self.result("solve", CASES / "restrained_rotation.toml", "effects.rotation=free")
        self.assertLess(abs(free["stress_asymmetry"]), 1e-9 * abs(free["stress"][2]))

    def test_a_stress_of_forces_that_cancel_is_symmetric_where_no_moment_acts(self):
        # A strip that is bent: the forces of its halves cancel in the mean, which is round-off.
        bent = self.write(block(60, 7, "".join(
            f'[[group]]\nname = "{name}"\nbox = [1.18, {low}, 2.0, {high}]\n[[load]]\ngroup = "{name}"\nforce = [{force}, 0.0]\n'
            for name, low, high, force in (("low", -1, 0.03, -1e3), ("high", 0.09, 1, 1e3)))))
        for turned in ((), ("springs.kT=1e-2",)):
            report = self.report("solve", bent, *turned)
            self.assertIn("stress", report)
            self.assertNotIn("not symmetric", report)

    def test_an_asymmetry_that_the_error_of_the_solution_may_make_is_not_known(self):
        # Moments of a millionth of the work of the stress: more than round-off, and less than what iterations leave.
        turned = self.write(block(30, 30, '[[load]]\ngroup = "right"\nkind = "total"\nforce = [1e3, 0.0]\nmoment = 6e-4\n'))
        self.assertIn("not symmetric: xy - yx = 0.00", self.done("solve", turned).stdout)
        rough = self.done("solve", turned, "solver.method=multigrid", "--accuracy", "0.5").stdout
        self.assertNotIn("not symmetric", rough)
        self.assertIn("whether it is symmetric is not known: xy - yx = ", rough)

    def test_tables_have_a_row_for_each_disc_and_files_for_each_load_case(self):
        out = self.folder / "new" / "out"
        self.done("solve", TRUSS, "--out", out)
        self.assertEqual(len(rows_of(out / "discs.csv")), 3)
        out = self.folder / "loads"
        self.done("solve", CASES / "cantilever.toml", "--out", out)
        self.assertEqual([one["case"] for one in result_in(out)["load_cases"]], ["weight", "tip"])
        self.check_there(out, "discs_weight.csv", "discs_tip.csv")

    def test_springs_share_moduli_and_displacements_among_them(self):
        out = self.folder / "tension"
        result = self.result("solve", TENSION, "--sensitivities", "--out", out)
        changes, rows = result["sensitivities"], rows_of(out / "sensitivities.csv")
        self.assertEqual(len(rows), result["contacts"])
        for modulus, of_all in (("young_modulus", 1), ("poisson_ratio", 0)):
            self.assertAlmostEqual(sum(changes[kind][modulus] for kind in ("kN", "kT")), of_all, delta=1e-9)
        young = sum(float(row[f"{k}_Pa"]) * float(row[f"dE_d{k}"]) for row in rows for k in ("kN", "kT"))
        self.assertTrue(math.isclose(young, result["plane_stress"]["young_modulus"], rel_tol=1e-9), young)
        self.check_there(out, "picture_effect_on_E.svg", "picture_effect_on_nu.svg")
        out = self.folder / "bent"
        result = self.result("solve", CASES / "cantilever.toml", "--sensitivities", "--out", out)
        for one in result["load_cases"]:  # springs twice as stiff halve what hangs down
            self.check_there(out, f"sensitivities_{one['case']}.csv")
            changes = [sum(one["sensitivities"][kind]["displacement"][name] for kind in ("kN", "kT"))
                       for name in one["sensitivities"]["kN"]["displacement"]]
            self.assertAlmostEqual(math.hypot(*changes), 1, delta=1e-9)
            self.assertGreater(max(changes), 0.99)

    def test_derivatives_of_an_unstable_state_are_refused(self):
        done = equidem("solve", TENSION, "--sensitivities", "springs.kT=-0.3e9")
        self.assertEqual(done.returncode, 2, done.stderr)
        self.assertIn("equilibrium is unstable", done.stderr)
        self.assertIn("UNSTABLE", done.stdout)  # what was found is delivered
        self.check_errors(((TENSION, "--sensitivities", "--accuracy", "0.01"), "the contacts of one block"), before=("solve",))

    def test_deformations_that_do_not_fit_the_units_are_questioned(self):
        def deformation(*options):
            result = self.result("solve", TENSION, *options)
            told = flat(result["report"].split("deformation ")[1].split("\n\n")[0].split("energy  ")[0])
            return result["largest_deformation"], told, result["stress"][0]

        usual, told, stress = deformation()
        self.assertNotIn("other units", told)
        self.assertNotIn("much", told)
        for wanted, words in ((0.5e-9, "in other units than meant"), (0.1, "the motions are taken as small")):
            found, told, _ = deformation(f"test.stress={stress * wanted / usual}")
            self.assertAlmostEqual(found / wanted, 1, delta=0.01)
            self.assertIn(words, told)

    def test_a_state_that_the_solver_cannot_judge_is_not_called_stable(self):
        unstable, umfpack = "springs.kT=-0.35e9", 'solver.method="umfpack"'
        result = self.result("solve", TENSION, unstable, umfpack)
        self.assertIn("NOT KNOWN", result["report"])
        self.assertEqual((result["status"], result["unstable_modes"]), ("unjudged", None))
        self.assertEqual(self.result("solve", TENSION, unstable)["status"], "unstable")


class Hostile(ProgramTest):
    """Input that must end in a sentence, never in a hang or a wrong verdict."""

    def test_what_an_assembly_file_cannot_be(self):
        self.write(TRUSS.read_text(), "truss.toml")
        file = self.folder / "truss.json"
        twice = (CASES / "truss.json").read_text().replace('"discs"', '"discs": [], "discs"', 1)
        for make, *words in ((os.mkfifo, "truss.json", "no regular file"),  # it may never end
                             (lambda path: path.write_text(" \n"), "truss.json", "empty"),
                             (lambda path: path.write_text(twice), "'discs'", "twice")):
            with self.subTest(words=words):
                file.unlink(missing_ok=True)
                make(file)
                self.check_error(equidem("solve", self.folder / "truss.toml"), 2, *words)

    def test_control_characters_reach_neither_terminals_nor_pages(self):
        text, case = (CASES / "notched_plate.toml").read_text(), self.folder / "titled.toml"
        for title in (r"a\u001b[31m", r"a\u0001", r"a\u007f", r"a\u009b2J"):
            case.write_text(re.sub(r"title *=.*", lambda _: f'title = "{title}"', text))
            line = case.read_text().split("title", 1)[0].count("\n") + 1
            self.check_error(equidem("quasistatic", case), 2, f"titled.toml:{line}", "control characters")
        done = equidem("sweep", TENSION, "--key", "ratio", "--values", "0,1", "--title", "a\x1b[2J")
        self.check_error(done, 2, "--title", "control characters")
        self.assertNotIn("\x1b", done.stderr)
        out = self.folder / "out"
        self.done(*COMMANDS["quasistatic"], 'title="a ]]> b <c> & d"', "--out", out)
        pictures = list(out.glob("*.svg"))
        self.assertGreater(len(pictures), 0)
        for picture in pictures:
            xml.etree.ElementTree.parse(picture)

    def test_a_list_of_many_names_is_cut(self):
        text = json.loads((CASES / "truss.json").read_text())
        text["groups"].update({f"group_{k}": [0] for k in range(3000)})
        self.write(json.dumps(text), "truss.json")
        case = self.write(re.sub(r'group *= *"[^"]*"', 'group = "nowhere"', TRUSS.read_text()))
        done = equidem("solve", case)
        self.check_error(done, 2, "no group 'nowhere'", "..., 3 0", " in all")
        self.assertLess(len(done.stderr), 500)

    def test_springs_too_far_apart_are_no_mechanism(self):
        done = equidem("solve", TENSION, "springs.kT=1e30")
        self.check_error(done, 2, "springs differ by a factor")
        self.assertNotIn("mechanism", done.stderr)

    def test_numbers_that_overflow_are_called_that(self):
        self.check_error(equidem("solve", TENSION, "test.stress=1e300"), 2, "overflow")


if __name__ == "__main__":
    unittest.main()
