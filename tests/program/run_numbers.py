# SPDX-License-Identifier: GPL-3.0-or-later
"""The numbers of the cases, beside those of numbers.csv: the same for every compiler and processor to DIGITS.

    run_numbers.py PROGRAM SOURCE_FOLDER --write    numbers.csv anew, where a change is meant; CHANGELOG says which
"""
import csv
import math
import re
import sys
import unittest

from program import CASES, SOURCE, ProgramTest, equidem, numbers_of, parse_json

TABLE = SOURCE / "tests" / "program" / "numbers.csv"
DIGITS = 1e-8  # relative; an elastic answer of these cases has a condition below 1e6
NOTHING = 1e-30  # what round-off leaves where an answer is 0
TASKS = [
    ("solve", "abe1996_fig6"), ("solve", "delaunay_tension"), ("solve", "restrained_rotation"), ("solve", "cantilever"),
    ("solve", "truss"), ("solve", "abe1996_fig6", "solver.method=multigrid", "assembly.rows=101", "assembly.columns=101"),
    ("homogenize", "hexagonal_cell"), ("homogenize", "random_cell"), ("homogenize", "random_cell", "springs.weighting=voronoi"),
    ("homogenize", "free_sample"), ("homogenize", "packed_rock"), ("homogenize", "two_minerals"),
    ("homogenize", "viscoelastic_cell"), ("calibrate", "calibrate_lattice"), ("calibrate", "packed_rock"),
    ("stability", "hexagonal_cell"), ("stability", "random_cell", "assembly.discs=60"), ("stability", "column"),
    ("quasistatic", "notched_plate"), ("run", "grains_cradle"), ("run", "run_tension"),
]
# Of work and round-off, not of the answer; directions where none is preferred.
OTHERS = re.compile(r"time|residual|error|bytes|refine|iteration|condition|seconds|balance|operations|nonzeros|power|factor_|"
                    r"factorizations|updates|accuracy|threads|step|width|drift|evaluations|unstable_|overlap|gap|asymmetry|sweeps|rebuilds|"
                    r"hill_mandel|anisotropy|axis|axes|direction|\.\d+\.")


def numbers_in(text):
    """Those of the answer, not those of lists."""
    return {name: value for name, value in numbers_of(parse_json(text))
            if not isinstance(value, list) and not OTHERS.search(name)}


def answers():
    for verb, case, *settings in TASKS:
        done = equidem(verb, CASES / f"{case}.toml", *settings, "--json", "-", "--quiet", "--threads", "1")
        yield (verb, case, " ".join(settings)), done


class Numbers(ProgramTest):
    def test_numbers_of_the_cases_are_those_of_every_compiler_and_processor(self):
        with open(TABLE, encoding="utf-8", newline="") as stream:
            rows = list(csv.DictReader(stream))
        for task, done in answers():
            with self.subTest(task=task):
                self.assertEqual(done.returncode, 0, done.stderr)
                found = numbers_in(done.stdout)
                stored = {row["number"]: float(row["value"]) for row in rows if (row["verb"], row["case"], row["settings"]) == task}
                self.assertEqual(sorted(found), sorted(stored))
                for name, value in stored.items():
                    self.assertLessEqual(abs(found[name] - value), max(DIGITS * abs(value), NOTHING), name)


def write():
    with open(TABLE, "w", encoding="utf-8", newline="") as stream:
        table = csv.writer(stream, lineterminator="\n")
        table.writerow(["verb", "case", "settings", "number", "value"])
        for task, done in answers():
            for name, value in numbers_in(done.stdout).items():
                table.writerow([*task, name, value if isinstance(value, int) or not math.isfinite(value) else f"{value:.12g}"])


if __name__ == "__main__":
    if "--write" in sys.argv:
        write()
    else:
        unittest.main()
