# SPDX-License-Identifier: GPL-3.0-or-later
"""Manual pages, completion and packages: run_manual.py PROGRAM SOURCE_FOLDER [unittest options]."""
import os
import pathlib
import re
import shutil
import subprocess
import sys
import unittest

from program import PROGRAM, SOURCE, ProgramTest, equidem

sys.path.insert(0, str(SOURCE / "cmake" / "debian"))

import changelog  # noqa: E402

sys.path.insert(0, str(SOURCE / "docs" / "site"))

import generate  # noqa: E402

VERBS = tuple(name for name, _ in generate.verbs_of(PROGRAM))
PAGES = ("", *VERBS, "case", "result", "engines")


def shown(page):
    """A page without the marks of roff."""
    return re.sub(r"\\f[BIR]", "", page).replace("\\-", "-").replace("\\(aq", "'")


class Manual(ProgramTest):
    def page(self, name):
        return self.done("help", "man", *([name] if name else [])).stdout

    def test_every_option_of_a_verb_is_on_its_page(self):
        for verb in VERBS:
            options = re.findall(r"^  (?:-\w,)?(--[\w-]+)", self.done("help", verb).stdout, re.MULTILINE)
            self.assertIn("--out", options)
            named = re.findall(r"^\.TP\n(?:-\w, )?(--[\w-]+)", shown(self.page(verb)), re.MULTILINE)
            self.assertEqual(named, options)

    def test_the_first_page_refers_to_all_others(self):
        pages = re.findall(r"^\.BR equidem-(\w+) \((\d)\)", shown(self.page("")), re.MULTILINE)
        self.assertEqual(pages, [*((verb, "1") for verb in VERBS), ("case", "5"), ("result", "5"), ("engines", "5")])

    def test_pages_have_the_sections_of_a_manual(self):
        self.assertEqual(re.findall(r"^\.SH (.*)", self.page(""), re.MULTILINE),
                         ["NAME", "SYNOPSIS", "VERBS", "OPTIONS", "EXAMPLES", "EXIT STATUS", "SEE ALSO"])
        self.assertEqual(re.findall(r"^\.SH (.*)", self.page("study"), re.MULTILINE),
                         ["NAME", "SYNOPSIS", "ARGUMENTS", "OPTIONS", "EXAMPLES", "SEE ALSO"])
        self.assertIn("m\\[u00B2]", self.page("result"))

    @unittest.skipUnless(shutil.which("groff"), "groff is not installed")
    def test_groff_accepts_every_page(self):
        for name in PAGES:
            done = subprocess.run(["groff", "-ww", "-z", "-man", "-Tutf8"], input=self.page(name), capture_output=True,
                                  text=True, timeout=60)
            self.assertEqual(done.stderr, "", name)

    def test_other_names_are_refused(self):
        self.check_error(equidem("help", "man", "slove"), 2, "no manual page on 'slove'")
        self.check_error(equidem("help", "completion", "csh"), 2, "'csh'", "bash")


class Completion(ProgramTest):
    def setUp(self):
        super().setUp()
        (self.folder / "equidem").symlink_to(pathlib.Path(PROGRAM).resolve())

    def completed(self, *words):
        """What bash offers for the last of the words, which are split as bash does it."""
        asked = '. "$1"; shift; COMP_WORDS=("$@"); COMP_CWORD=$(($# - 1)); _equidem; printf "%s\\n" "${COMPREPLY[@]}"'
        return self.bash("-c", asked, "bash", self.script(), "equidem", *words).stdout.split()

    def script(self):
        return self.write(self.done("help", "completion", "bash").stdout, "completion")

    def bash(self, *words):
        done = subprocess.run(["bash", *words], capture_output=True, text=True, cwd=self.folder, timeout=60,
                              env={"PATH": f"{self.folder}:{os.environ['PATH']}"})
        self.assertEqual(done.returncode, 0, done.stderr)
        return done

    def test_verbs_options_keys_and_words(self):
        for words, offered in ((("st",), ["stability", "study"]), (("help", "man", "so"), ["solve"]),
                               (("solve", "--re"), ["--require-stable"]), (("solve", "--set", "springs.kT"), ["springs.kT="]),
                               (("sweep", "--key", "springs.kT"), ["springs.kT"]), (("sweep", "--verb", "ho"), ["homogenize"]),
                               (("solve", "compl"), ["completion"]), (("solve", "--threads", ""), [])):  # completion: a file
            self.assertEqual(self.completed(*words), offered)
        for words, offered in ((("solve", "case.toml", "--"), "--accuracy"),
                               (("solve", "--set", "assembly.kind", "=", "h"), "hexagonal"),
                               (("solve", "--set", "load.0."), "load.0.force=")):
            self.assertIn(offered, self.completed(*words))
        self.assertNotIn("--accuracy", self.completed("pack", "--"))

    def test_every_key_that_is_offered_is_known(self):
        keys = self.completed("sweep", "--key", "")
        self.assertEqual(len(keys), len(set(keys)))
        self.assertGreater(len(keys), 100)
        text = self.done("help", "case").stdout
        for key in keys:
            self.assertRegex(text, rf"(?m)^  (?:[\w.]+, )*(?:\w+\.)*{re.escape(key.split('.')[-1])}\b", key)

    def test_bash_can_read_its_script(self):
        self.assertEqual(self.bash("-n", self.script()).stderr, "")


class Packages(unittest.TestCase):
    def test_the_version_has_its_changes_and_is_the_one_to_cite(self):
        version = re.search(r"project\(equidem VERSION ([\d.]+)", (SOURCE / "CMakeLists.txt").read_text())[1]
        self.assertIn(f"\nversion: {version}\n", (SOURCE / "CITATION.cff").read_text())
        text = changelog.debian_changelog((SOURCE / "CHANGELOG.md").read_text(), "1~debian12", "A B <a@b.example>")
        self.assertTrue(text.startswith(f"equidem ({version}-1~debian12) unstable; urgency=medium\n\n  [ Added ]\n  * "), text[:80])

    def test_changes_are_converted(self):
        text = ("# C\n\n## [Unreleased]\n\n- not yet\n\n## [1.2.0] - 2026-01-31\n\nWords.\n\n### Added\n\n- A [page](p.md) of\n"
                "  two lines.\n- More.\n\n## [1.1.0] - 2025-12-01\n\n### Fixed\n\n- It.\n")
        self.assertEqual(changelog.debian_changelog(text, "1", "A B <a@b.example>"),
                         "equidem (1.2.0-1) unstable; urgency=medium\n\n  [ Added ]\n  * A page of two lines.\n  * More.\n\n"
                         " -- A B <a@b.example>  Sat, 31 Jan 2026 12:00:00 +0000\n\n"
                         "equidem (1.1.0-1) unstable; urgency=medium\n\n  [ Fixed ]\n  * It.\n\n"
                         " -- A B <a@b.example>  Mon, 01 Dec 2025 12:00:00 +0000\n")


if __name__ == "__main__":
    unittest.main()
