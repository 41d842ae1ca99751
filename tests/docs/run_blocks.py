#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""The commands and the code of the documentation, run as a reader does.

    run_blocks.py PROGRAM SOURCE MODULE [unittest options]

On each page of docs/, in its order and in one folder that has data/ beside it: blocks `toml` whose first line is
"# NAME" are written into the file NAME, blocks `sh` are run, blocks `python` are run in one interpreter. A block `text`
after one of these is its output, where "..." stands for anything. Blocks that are marked "not-run" or begin with a
command of tools/ are left out. README.md is read as a page too.
"""

import contextlib
import doctest
import io
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile
import unittest

PROGRAM, SOURCE, MODULE = (pathlib.Path(word).resolve() for word in sys.argv[1:4])
sys.path[:0] = [str(MODULE), str(SOURCE / "docs/site")]
os.environ.update(PYTHONPATH=str(MODULE), MPLBACKEND="Agg")
import generate  # noqa: E402

BLOCK = re.compile(r"^```(\w+)([^\n]*)\n(.*?)^```$", re.M | re.S)
# Pages that are lists of formats and keys: their blocks are parts of files, tested with the formats.
LISTS = ("case_file.md", "file_formats.md")


def blocks_of(page):
    found = BLOCK.findall(page.read_text(encoding="utf-8"))
    return [(language, words.strip(), body) for language, words, body in found]


class Pages(unittest.TestCase):
    maxDiff = None

    def run_page(self, page):
        checker = doctest.OutputChecker()
        flags = doctest.ELLIPSIS | doctest.NORMALIZE_WHITESPACE
        namespace, output = {"__name__": "page"}, None
        with tempfile.TemporaryDirectory() as folder, inside(folder):
            os.symlink(SOURCE / "data", "data")
            (pathlib.Path(folder) / "bin").mkdir()
            os.symlink(PROGRAM, "bin/equidem")
            environment = {**os.environ, "PATH": f"{folder}/bin:/usr/bin:{os.environ['PATH']}"}
            for language, words, body in blocks_of(page):
                with self.subTest(block=body):
                    if words == "not-run" or body.startswith("tools/"):
                        output = None
                    elif language == "toml" and re.match(r"# \S+\.toml\n", body):
                        pathlib.Path(body.split()[1]).write_text(body, encoding="utf-8")
                    elif language == "sh":
                        done = subprocess.run(["bash", "-euc", body], capture_output=True, text=True, env=environment,
                                              timeout=100)
                        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
                        output = done.stdout
                    elif language == "python":
                        printed = io.StringIO()
                        with contextlib.redirect_stdout(printed):
                            exec(compile(body, str(page), "exec"), namespace)
                        output = printed.getvalue()
                    elif language == "text" and output is not None:
                        if not checker.check_output(body, output, flags):
                            self.fail(f"{page.name}: the output is not that of the page:\n{output}")
                        output = None


@contextlib.contextmanager
def inside(folder):
    before = os.getcwd()
    os.chdir(folder)
    try:
        yield
    finally:
        os.chdir(before)


def test_of(page):
    return lambda self: self.run_page(page)


for path in [SOURCE / "README.md", *sorted((SOURCE / "docs").rglob("*.md"))]:
    if path.name not in LISTS and blocks_of(path):
        name = path.relative_to(SOURCE).with_suffix("").as_posix().replace("/", "_")
        setattr(Pages, f"test_{name}", test_of(path))


class Verbs(unittest.TestCase):
    """Their examples are those of the help, on the page that generate.py makes of it."""

    def test_examples_of_all_verbs_are_accepted(self):
        with tempfile.TemporaryDirectory() as folder, inside(folder):
            os.symlink(SOURCE / "data", "data")
            shutil.copyfile(SOURCE / "data/cases/random_cell.toml", "cell.toml")
            shutil.copyfile(SOURCE / "data/cases/abe1996_fig6.toml", "sample.toml")
            for verb, _ in generate.verbs_of(PROGRAM):
                examples = generate.examples_of(generate.output_of(PROGRAM, verb, "--help"))
                self.assertTrue(examples, verb)
                for command, _ in examples:
                    with self.subTest(command=command):
                        words = [word for word in command.split()[1:] if word != "--resume"]
                        if "--accuracy" not in words or verb == "study":  # elsewhere it excludes a dry run
                            words.append("--dry-run")
                        done = subprocess.run([PROGRAM, *words], capture_output=True, text=True, timeout=100)
                        self.assertEqual(done.returncode, 0, done.stderr)


class Python(unittest.TestCase):
    def test_the_reference_has_all_public_names(self):
        import equidem

        page = (SOURCE / "docs/reference/python.md").read_text(encoding="utf-8")
        listed = set(re.findall(r"^\.\. auto\w+:: (?:equidem\.)?(\w+)", page, re.M))
        self.assertEqual(set(equidem.__all__) - listed, set())


if __name__ == "__main__":
    unittest.main(argv=[sys.argv[0], *sys.argv[4:]])
