# SPDX-License-Identifier: GPL-3.0-or-later
"""Runs of equidem, and what both pages say of them."""
import json
import os
import shutil
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[3]
os.environ["OPENBLAS_NUM_THREADS"] = "1"


class Failure(Exception):
    pass


class Run:
    """Options of the run, the programs and the folder of results."""

    def __init__(self, options, folder):
        self.options, self.folder = options, Path(folder)
        self.program = Path(options.program).resolve()
        self.data = Path(options.data).resolve()
        self.kept = self.data / "studies"
        self.kept.mkdir(parents=True, exist_ok=True)

    def call(self, command, **more):
        done = subprocess.run([str(part) for part in command], capture_output=True, text=True, cwd=ROOT, check=False, **more)
        if done.returncode != 0:
            raise Failure(f"{' '.join(str(part) for part in command)}: {done.stderr.strip() or done.stdout[-500:]}")
        return done.stdout

    def size_of(self, study):
        """The option for the largest block of a study that has one."""
        return ["--discs", self.options.discs] if study == "solvers" and not self.options.quick else []

    def study(self, name):
        print(f"study {name}", file=sys.stderr, flush=True)
        command = [self.program, "study", name, "--overwrite", "--quiet", "--out", self.folder / name]
        command += self.size_of(name)
        command += ["--quick"] * self.options.quick + ["--budget", self.options.budget, "--rounds", self.options.rounds]
        self.call(command)
        return json.loads((self.folder / name / "result.json").read_text(encoding="utf-8"))

    def beside(self, *parts):
        """A program of the same build, such as bench/bench_dynamic."""
        path = self.program.parent.joinpath(*parts)
        if not path.exists():
            raise Failure(f"'{path}' does not exist: build all of that preset first")
        return path

    def keep_plot(self, study, plot, name):
        """Copy PNG and SVG of a plot. Returns its Markdown."""
        for extension in ("png", "svg"):
            shutil.copyfile(self.folder / study / f"{plot}.{extension}", self.kept / f"{name}.{extension}")
        return f"studies/{name}.png"

    def command(self):
        quick = " --quick" if self.options.quick else "" if self.options.only == "effects" else f" --discs {self.options.discs}"
        if self.options.only:
            quick += f" --only {self.options.only}"
        return f"tools/bench/pages build/release/tools/equidem{quick} --budget {self.options.budget:g} --rounds {self.options.rounds}"


def plots_of(result, folder):
    """Names of the plots of a study, in the order of its problems and quantities."""
    problems = list(dict.fromkeys(row["problem"] for row in result["settings"]))
    quantities = [q["name"] for q in result["quantities"] if not q["fact"]] or ["time"]

    def plain(text):
        return "_".join("".join(c if c.isascii() and c.isalnum() else " " for c in text).split())

    names = ["_".join(part for part in (result["study"], plain(problem), quantity) if part)
             for problem in problems for quantity in quantities]
    return [name for name in names if (folder / result["study"] / f"{name}.png").exists()]


def seconds(value):
    for unit, size in (("s", 1), ("ms", 1e-3), ("µs", 1e-6)):
        if value >= size:
            return f"{value / size:.3g} {unit}"
    return f"{value * 1e9:.3g} ns"


def machine(result):
    m = result["machine"]
    return f"{m['processor'] or 'unknown processor'}, {m['cores']} cores; {m['build']}, compiler {m['compiler']}"


def table(head, rows):
    lines = ["| " + " | ".join(head) + " |", "|---" * len(head) + "|"]
    return "\n".join(lines + ["| " + " | ".join(row) + " |" for row in rows]) + "\n\n"


def tables_of(markdown, heading=""):
    """The tables below a heading, as lists of rows of cells, the head first."""
    text = markdown[markdown.index(heading):] if heading else markdown
    if heading:
        text = text.split("\n## ", 2)[0 if not text.startswith("## ") else 0]
    found, rows = [], []
    for line in text.splitlines() + [""]:
        if line.startswith("|"):
            cells = [cell.strip() for cell in line.strip().strip("|").split("|")]
            if not set("".join(cells)) <= set("-"):
                rows.append(cells)
        elif rows:
            found.append(rows)
            rows = []
    return found
