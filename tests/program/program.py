# SPDX-License-Identifier: GPL-3.0-or-later
"""The built program, for the tests that drive it: run_VERB.py PROGRAM SOURCE_FOLDER [unittest options]."""
import json
import os
import pathlib
import re
import shutil
import signal
import subprocess
import sys
import tempfile
import time
import unittest

PROGRAM = sys.argv.pop(1)
SOURCE = pathlib.Path(sys.argv.pop(1))
CASES = SOURCE / "data" / "cases"
TENSION = str(CASES / "abe1996_fig6.toml")


def equidem(*arguments, cwd=None, env=None):
    return subprocess.run([PROGRAM, *map(str, arguments)], capture_output=True, text=True, encoding="utf-8", cwd=cwd, env=env,
                          timeout=120)


def german(folder):
    """Environment in which a comma is the decimal sign; None where the locale cannot be made."""
    localedef = shutil.which("localedef")
    made = localedef and subprocess.run([localedef, "-i", "de_DE", "-f", "UTF-8", str(folder / "de_DE.UTF-8")],
                                        capture_output=True, check=False).returncode == 0
    return {**os.environ, "LOCPATH": str(folder), "LC_ALL": "de_DE.UTF-8"} if made else None


def refuse_constant(name):
    raise ValueError(f"{name} is not JSON")


def catches_interrupts(pid):
    """Whether a process has a handler of SIGINT and does not hold the signal back, by what Linux says."""
    status = dict(re.findall(r"^(\w+):\s*(.*)", pathlib.Path(f"/proc/{pid}/status").read_text(), re.MULTILINE))
    return (int(status["SigCgt"], 16) & ~int(status["SigBlk"], 16)) >> (signal.SIGINT - 1) & 1 == 1


def parse_json(text):
    return json.loads(text, parse_constant=refuse_constant)


class ProgramTest(unittest.TestCase):
    def setUp(self):
        self.temporary = tempfile.TemporaryDirectory(prefix="equidem_test_")
        self.folder = pathlib.Path(self.temporary.name)

    def tearDown(self):
        self.temporary.cleanup()

    def check_error(self, done, exit_code, *words):
        """One sentence on stderr, nothing on stdout; of work that was begun, the last one, and a report with the reason."""
        self.assertEqual(done.returncode, exit_code, done.stderr)
        sentence = done.stderr.splitlines()[-1] if done.stdout else done.stderr
        if done.stdout:
            self.assertRegex(done.stdout, "NOT (DONE|FEASIBLE) ")
        self.assertTrue(sentence.startswith(pathlib.Path(PROGRAM).name + ": "), done.stderr)
        self.assertLessEqual(sentence.count("\n"), 1, done.stderr)
        for word in words:
            self.assertIn(word, sentence)

    def check_partial(self, done, *words, out=None, status="failed"):
        """Exit code 1, and a report of what there is; result.json of out, with the reason."""
        self.assertNotEqual(done.stdout, "")
        self.check_error(done, 1, *words)
        if out is None:
            return None
        result = parse_json((out / "result.json").read_text())
        self.assertEqual(result["status"], status)
        self.assertEqual(result["refusal" if status == "not_feasible" else "failure"],
                         done.stderr.splitlines()[-1].split(": ", 1)[1])
        return result

    def interrupt(self, *arguments, when=lambda: True, after=0):
        """Started, sent SIGINT `after` seconds from when it catches it and when() holds, ended with 130; (stdout, stderr)."""
        running = subprocess.Popen([PROGRAM, *map(str, arguments)], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        try:
            start = time.monotonic()
            while not (catches_interrupts(running.pid) and when()) and time.monotonic() - start < 60:
                self.assertIsNone(running.poll())
                time.sleep(0.002)
            time.sleep(after)
            self.assertIsNone(running.poll())
            running.send_signal(signal.SIGINT)
            stdout, stderr = running.communicate(timeout=60)
        finally:
            if running.poll() is None:
                running.kill()
                running.communicate()
        self.assertEqual(running.returncode, 130, stderr)
        return stdout, stderr

    def check_done(self, done):
        self.assertEqual(done.returncode, 0, done.stderr)
        return done
