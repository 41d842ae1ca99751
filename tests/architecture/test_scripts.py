#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Every script of tools/ starts: test_scripts.py SOURCE [unittest options].

With --help each prints its usage; an unknown option is refused. Commands that install or build are replaced by ones that
fail, so that a script which gets to them is found.
"""

import os
import pathlib
import subprocess
import sys
import tempfile
import unittest

SOURCE = pathlib.Path(sys.argv.pop(1)).resolve()
SCRIPTS = sorted(path for path in (SOURCE / "tools").rglob("*")
                 if path.is_file() and os.access(path, os.X_OK) and path.read_bytes()[:2] == b"#!")
FAILING = ("apt-get", "sudo", "cmake", "ctest", "cpack", "mpirun")


class Scripts(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)
        (self.folder / "bin").mkdir()
        for name in FAILING:
            self.command(name, f'echo "{name} $*" >>{self.folder}/called\nexit 99')

    def command(self, name, body):
        path = self.folder / "bin" / name
        path.write_text(f"#!/bin/bash\n{body}\n", encoding="utf-8")
        path.chmod(0o755)

    def start(self, script, *words):
        """The script with the commands of setUp; a script whose modules are not installed is left out."""
        environment = {**os.environ, "PATH": f"{self.folder}/bin:/usr/bin:/bin", "PYTHONDONTWRITEBYTECODE": "1"}
        done = subprocess.run([script, *words], cwd=self.folder, env=environment, stdin=subprocess.DEVNULL,
                              capture_output=True, text=True, timeout=60)
        if "No module named 'numpy'" in done.stderr:
            self.skipTest("python3-numpy is not installed")
        return done

    def called(self):
        path = self.folder / "called"
        return path.read_text(encoding="utf-8") if path.exists() else ""

    def test_there_are_scripts(self):
        self.assertGreater(len(SCRIPTS), 10)

    def test_every_script_prints_its_usage(self):
        for script in SCRIPTS:
            with self.subTest(script=script.relative_to(SOURCE)):
                done = self.start(script, "--help")
                self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
                self.assertIn("usage:", done.stdout.lower())
                self.assertIn(script.name, done.stdout)
                self.assertEqual(self.called(), "")

    def test_every_script_refuses_an_unknown_option(self):
        for script in SCRIPTS:
            with self.subTest(script=script.relative_to(SOURCE)):
                done = self.start(script, "--no-such-option")
                self.assertEqual(done.returncode, 2, done.stdout + done.stderr)
                self.assertNotRegex(done.stderr, "unbound variable|Traceback")
                self.assertEqual(self.called(), "")

    def test_scripts_that_build_reach_cmake(self):
        self.command("dpkg-query", "echo installed")
        for name in ("yade", "lmp", "mpirun"):
            self.command(name, "exit 99")
        for script in ("docs", "package", "test", "bench/all", "bench/peers/run"):
            with self.subTest(script=script):
                (self.folder / "called").unlink(missing_ok=True)
                done = self.start(SOURCE / "tools" / script)
                self.assertNotEqual(done.returncode, 0)
                self.assertNotRegex(done.stderr, "unbound variable|Traceback")
                self.assertRegex(self.called(), "^cmake --preset (release|packages|test) ")


if __name__ == "__main__":
    unittest.main()
