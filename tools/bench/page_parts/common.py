# SPDX-License-Identifier: GPL-3.0-or-later
"""Runs of equidem, and what both pages say of them."""
import json
import os
import shutil
import subprocess
import sys
import time
from pathlib import Path

ROOT = Path(__file__).resolve().parents[3]
sys.path.insert(0, str(ROOT / "docs" / "site"))
os.environ["OPENBLAS_NUM_THREADS"] = "1"


class Failure(Exception):
    pass


def module_of(build):
    """The Python module of a build folder, on one thread."""
    sys.path.insert(0, str(Path(build).resolve() / "python"))
    import equidem

    equidem.set_threads(1)
    return equidem


class Run:
    """Options of the run, the programs and the folder of results."""

    def __init__(self, options, folder):
        self.options, self.folder = options, Path(folder)
        self.program = Path(options.program).resolve()
        self.data = Path(options.data).resolve()

    def call(self, command, **more):
        done = subprocess.run([str(part) for part in command], capture_output=True, text=True, cwd=ROOT, check=False, **more)
        if done.returncode != 0:
            raise Failure(f"{' '.join(str(part) for part in command)}: {done.stderr.strip() or done.stdout[-500:]}")
        return done.stdout

    def study(self, name):
        """Result of the study file data/studies/NAME.toml."""
        print(f"study {name}", file=sys.stderr, flush=True)
        self.call([self.program, "study", ROOT / "data" / "studies" / f"{name}.toml", "--overwrite", "--quiet", "--out", self.folder / name,
                   "--budget", self.options.budget, "--rounds", self.options.rounds])
        return json.loads((self.folder / name / "result.json").read_text(encoding="utf-8"))

    def module(self):
        """The Python module of the same build."""
        return module_of(self.program.parents[1])

    def beside(self, *parts):
        """A program of the same build, such as bench/bench_dynamic."""
        path = self.program.parent.joinpath(*parts)
        if not path.exists():
            raise Failure(f"'{path}' does not exist: build all of that preset first")
        return path


def stamp(result=None):
    """Commit of the source, date, processor and compiler of what is measured, the last two from the JSON of a study."""
    def git(*words):
        if shutil.which("git") is None:
            return "unknown"
        return subprocess.run(["git", *words], capture_output=True, text=True, cwd=ROOT, check=False).stdout.strip()

    found = {"commit": git("rev-parse", "--short=8", "HEAD"), "date": time.strftime("%Y-%m-%d")}
    if result:
        m = result["machine"]
        found |= {"processor": f"{m['processor'] or 'unknown'}, {m['cores']} cores", "build": f"{m['build']}, compiler {m['compiler']}"}
    return found


def seconds(value):
    for unit, size in (("s", 1), ("ms", 1e-3), ("µs", 1e-6)):
        if value >= size:
            return f"{value / size:.3g} {unit}"
    return f"{value * 1e9:.3g} ns"


def table(head, rows):
    lines = ["| " + " | ".join(head) + " |", "|---" * len(head) + "|"]
    return "\n".join(lines + ["| " + " | ".join(row) + " |" for row in rows]) + "\n\n"
