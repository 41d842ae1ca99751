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
        self.kept = self.data / "studies"
        self.kept.mkdir(parents=True, exist_ok=True)

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

    def keep_plot(self, study, plot, name):
        """Copy PNG and SVG of a plot. Returns its Markdown."""
        for extension in ("png", "svg"):
            shutil.copyfile(self.folder / study / f"{plot}.{extension}", self.kept / f"{name}.{extension}")
        return f"studies/{name}.png"

    def command(self):
        quick = " --quick" if self.options.quick else ""
        if self.options.only:
            quick += f" --only {self.options.only}"
        return f"tools/bench/pages build/release/tools/equidem{quick} --budget {self.options.budget:g} --rounds {self.options.rounds}"


def plots_of(result, folder):
    """Names of the plots of a study."""
    names = [f"{result['study']}_{quantity['name']}" for quantity in result["quantities"]]
    return [name for name in names if (folder / result["study"] / f"{name}.png").exists()]


def bars(run, name, title, unit, values):
    """A chart of horizontal bars in the folder of plots. Returns its Markdown."""
    import matplotlib
    matplotlib.use("Agg")
    import matplotlib.pyplot as plt

    figure, axes = plt.subplots(figsize=(8, 0.5 + 0.45 * len(values)), layout="constrained")
    axes.bar_label(axes.barh(list(values), list(values.values()), color="#0072b2"), fmt="%.3g", padding=3)
    axes.invert_yaxis()
    axes.set(xlabel=unit, title=title)
    axes.spines[["top", "right"]].set_visible(False)
    for extension in ("png", "svg"):
        figure.savefig(run.kept / f"{name}.{extension}", dpi=110, metadata={"Date": None} if extension == "svg" else {})
    plt.close(figure)
    return f"studies/{name}.png"


def seconds(value):
    for unit, size in (("s", 1), ("ms", 1e-3), ("µs", 1e-6)):
        if value >= size:
            return f"{value / size:.3g} {unit}"
    return f"{value * 1e9:.3g} ns"


def machine_text(run):
    return machine(run.study("integrators"))


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
