# SPDX-License-Identifier: GPL-3.0-or-later
"""The built program, for the tests that drive it: run_VERB.py PROGRAM SOURCE_FOLDER [unittest options]."""
import csv
import json
import os
import pathlib
import re
import resource
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
NO_PICTURE = "output.files=['csv', 'vtk']"
ASSIGNMENT = re.compile(r"[a-z]\w*(\.\w+)*=")


def words_of(arguments):
    """The words of a command line; a word key=value is given by --set."""
    words = [PROGRAM]
    for word in map(str, arguments):
        if ASSIGNMENT.match(word) and words[-1] != "--set":
            words.append("--set")
        words.append(word)
    return words


def equidem(*arguments, **options):
    """The completed process; options are those of subprocess.run."""
    piped = {"stdout": subprocess.PIPE, "stderr": subprocess.PIPE, "text": True, "encoding": "utf-8", "timeout": 240}
    return subprocess.run(words_of(arguments), check=False, **{**piped, **options})


def started(*arguments, **options):
    return subprocess.Popen(words_of(arguments), **{"stdout": subprocess.PIPE, "stderr": subprocess.PIPE, "text": True,
                                                    **options})


def at_most(limit, what=resource.RLIMIT_FSIZE):
    """Option of equidem(): as on a disk that is full, or with so little memory."""
    return {"preexec_fn": lambda: resource.setrlimit(what, (limit, limit))}


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


def result_in(folder):
    return parse_json((folder / "result.json").read_text(encoding="utf-8"))


def rows_of(path):
    """Rows of a CSV file by the names of its columns."""
    with open(path, newline="", encoding="utf-8") as file:
        return list(csv.DictReader(file))


def flat(text):
    """Without the line breaks of a report."""
    return " ".join(text.split())


def files_of(out):
    """Content of every file of a folder, by its path there."""
    return {str(path.relative_to(out)): path.read_bytes() for path in sorted(out.rglob("*")) if path.is_file()}


# In result.json, what depends on the machine, the clock and the folder, or tells of the part of a run since it was resumed.
VARYING = ("report", "times", "particle_steps_per_second", "sweeps", "rebuilds", "bytes_per_disc", "bytes_per_grain", "loop_bytes",
           "springs_file", "threads", "seconds", "command", "machine")


def lasting(result):
    return {key: value for key, value in result.items() if key not in VARYING}


def contents(folder):
    """Bytes of all files; of result.json what lasts; of a page, which shows times, whether it is whole."""
    files = files_of(folder)
    if "result.json" in files:
        files["result.json"] = lasting(parse_json(files["result.json"].decode()))
    if "index.html" in files:
        files["index.html"] = files["index.html"].endswith(b"</html>\n")
    return files


class ProgramTest(unittest.TestCase):
    def setUp(self):
        self.temporary = tempfile.TemporaryDirectory(prefix="equidem_test_")
        self.folder = pathlib.Path(self.temporary.name)

    def tearDown(self):
        self.temporary.cleanup()

    def write(self, text, name="case.toml"):
        """A file in the folder of the test; a case gets its first line."""
        path = self.folder / name
        head = 'schema = "equidem/1"\n' if name.endswith(".toml") and "schema = " not in text else ""
        path.write_text(head + text, encoding="utf-8")
        return path

    def write_assembly(self, name, **parts):
        return self.write(json.dumps({"schema": "equidem-assembly/1", **parts}), name)

    def of_file(self, path, more="", name="case.toml"):
        """A case of an assembly in a file."""
        return self.write(f'[assembly]\nkind = "file"\npath = "{path}"\n{more}', name)

    def check_done(self, done):
        self.assertEqual(done.returncode, 0, done.stderr)
        return done

    def done(self, *arguments, **options):
        """The process, which ended with exit code 0."""
        return self.check_done(equidem(*arguments, **options))

    def result(self, *arguments, **options):
        """The JSON that it prints."""
        return parse_json(self.done(*arguments, "--json", "-", **options).stdout)

    def report(self, *arguments, **options):
        """What it prints, without line breaks."""
        return flat(self.done(*arguments, **options).stdout)

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

    def check_errors(self, *cases, before=()):
        """Refused with exit code 2: a command, or words behind `before`, and what its sentence contains."""
        for command, *words in cases:
            command = (command,) if isinstance(command, str) else command
            with self.subTest(command=command):
                self.check_error(equidem(*before, *command), 2, *words)

    def refused(self, text, *words, verb="run", code=2):
        """A case of this text."""
        done = equidem(verb, self.write(text), "--out", self.folder / "refused", "--overwrite", NO_PICTURE)
        self.check_error(done, code, *words)
        return done

    def check_partial(self, done, *words, out=None, status="failed"):
        """Exit code 1, and a report of what there is; result.json of out, with the reason."""
        self.assertNotEqual(done.stdout, "")
        self.check_error(done, 1, *words)
        if out is None:
            return None
        result = result_in(out)
        self.assertEqual(result["status"], status)
        self.assertEqual(result["refusal" if status == "not_feasible" else "failure"],
                         done.stderr.splitlines()[-1].split(": ", 1)[1])
        return result

    def check_same_files(self, one, other, *names):
        """Byte for byte; of folders, all files in them; without names, all tables and frames."""
        if not names:
            names = sorted({path.name for out in (one, other) for path in out.iterdir()
                            if path.suffix in (".csv", ".pvd", ".vti") or path.name == "frames"})
            self.assertGreater(len(names), 0)
        for name in names:
            if (one / name).is_dir():
                self.assertEqual(files_of(one / name), files_of(other / name), name)
            else:
                self.assertEqual((one / name).read_bytes(), (other / name).read_bytes(), name)

    def check_there(self, out, *names):
        for name in names:
            self.assertTrue((out / name).exists(), name)

    def interrupt(self, *arguments, when=lambda: True, after=0, signals=(signal.SIGINT,)):
        """Started, sent signals `after` seconds from when it catches them and when() holds, ended with 130; (stdout, stderr)."""
        running = started(*arguments)
        try:
            start = time.monotonic()
            while not (catches_interrupts(running.pid) and when()) and time.monotonic() - start < 60:
                self.assertIsNone(running.poll())
                time.sleep(0.002)
            time.sleep(after)
            self.assertIsNone(running.poll())
            for number in signals:
                running.send_signal(number)
            stdout, stderr = running.communicate(timeout=60)
        finally:
            if running.poll() is None:
                running.kill()
                running.communicate()
        self.assertEqual(running.returncode, 130, stderr)
        return stdout, stderr


CELL, ENSEMBLE, STUDY = CASES / "random_cell.toml", CASES / "ensemble.toml", SOURCE / "data" / "studies" / "abe_lattice.toml"
BLOCK = ("assembly.columns=9", "assembly.rows=9")
# Each verb with a small case, and what else it computes.
COMMANDS = {
    "solve": ("solve", TENSION, *BLOCK),
    "homogenize": ("homogenize", CELL, "assembly.discs=60"),
    "ensemble": ("homogenize", ENSEMBLE, "ensemble.discs=[20, 40]", "ensemble.samples=3"),
    "calibrate": ("calibrate", CASES / "calibrate_random.toml", "assembly.discs=100"),
    "stability": ("stability", CASES / "hexagonal_cell.toml"),
    "pack": ("pack", CASES / "pack_jammed.toml", "packing.grains=60", "packing.box=[0.13,0.13]"),
    "run": ("run", CASES / "run_pulse.toml"),
    "rest": ("run", CASES / "run_tension.toml"),
    "grains": ("run", CASES / "grains_cradle.toml"),
    "quasistatic": ("quasistatic", CASES / "notched_plate.toml", "quasistatic.max_events=12"),
    "export": ("export", TENSION, "--to", "lammps"),
    "sweep": ("sweep", TENSION, *BLOCK, "--key", "ratio", "--from", 0, "--to", 1, "--steps", 3),
    "study": ("study", STUDY, "--budget", 0, "--rounds", 3),
}


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
