# SPDX-License-Identifier: GPL-3.0-or-later
"""What the scripts of papers share: command line, published numbers, samples side by side, the module equidem.

A script hands main() the function that computes its Output; shown.py makes report and plots of that. Files that are
written into --out: report.txt, result.json, NAME.csv of a table, NAME.csv, NAME.svg and NAME.png of a plot, and the
script's page, if it has one.
"""
import argparse
import csv
import dataclasses
import json
import math
import multiprocessing
import os
import pathlib
import signal
import sys
import time

import numpy as np

from shown import Page, Row, csv_lines

ROOT = pathlib.Path(__file__).resolve().parents[2]
DATA = ROOT / "data" / "papers"
sys.path += [str(ROOT / "build" / preset / "python") for preset in ("release", "dev", "test")]  # if not installed
try:
    import equidem as eq
except ImportError as missing:
    sys.exit(f"The Python module 'equidem' cannot be imported by {sys.executable} ({missing}). Run tools/prepare "
             "release \"build python\" equidem_python, and take the interpreter that it was built for, such as "
             "/usr/bin/python3")


# ---- the command line, and what is delivered

@dataclasses.dataclass
class Output:
    """Results of a paper."""
    names: dict  # of results in NAME.toml
    numbers: dict  # of result.json
    tables: dict = dataclasses.field(default_factory=dict)  # name: rows
    drawings: dict = dataclasses.field(default_factory=dict)  # name: function of the path without its end
    plots: dict | None = None  # name: Plot; left out: the figures of NAME.toml


def main(reproduce, add_options=lambda parser: None):
    """Read the command line, reproduce (options, page -> Output), deliver, and end the process with its exit code.
    options.size has the numbers of NAME.toml by which quick and full computations differ."""
    script = sys.modules["__main__"]
    name = pathlib.Path(script.__file__).stem
    parser = argparse.ArgumentParser(
        prog=f"tools/papers/{name}.py", description=script.__doc__, allow_abbrev=False,
        epilog="Exit codes: 0 done; 1 the computation failed, and the message says why; 2 bad input or usage; "
               "130 interrupted.", formatter_class=argparse.RawDescriptionHelpFormatter)
    add_options(parser)
    parser.add_argument("--quick", action="store_true",
                        help="a smaller computation: seconds or a minute instead of minutes or hours")
    parser.add_argument("--out", type=pathlib.Path, metavar="DIR", help="write tables and figures into this folder")
    parser.add_argument("--overwrite", action="store_true", help="replace files that exist")
    parser.add_argument("--json", metavar="FILE",
                        help="write the result as JSON; '-': to stdout, in place of the report")
    parser.add_argument("--threads", type=int, help="threads; left out: one per processor")
    parser.add_argument("--quiet", action="store_true", help="no report and no progress")
    options = parser.parse_args()
    signal.signal(signal.SIGTERM, signal.default_int_handler)
    try:
        if options.threads is not None:
            eq.set_threads(options.threads)
        eq.show_progress(False)
        tracked.shown = not options.quiet
        present = [pathlib.Path(options.json)] if options.json not in (None, "-") else []
        if options.out:
            options.out.mkdir(parents=True, exist_ok=True)
            present += sorted(options.out.glob("[!.]*.*"))
        for path in present:
            if path.exists() and not options.overwrite:
                raise FileExistsError(f"'{path}' exists (files are not replaced unasked). Give --overwrite, or another "
                                      "folder.")
        page = Page(name, {**globals(), **vars(script)}, vars(options))
        options.size = page.names["size"] = Row(page.told["size"]["quick" if options.quick else "full"])
        deliver(options, page, reproduce(options, page))
    except (OSError, eq.EquidemError, KeyboardInterrupt) as error:
        stopped = isinstance(error, KeyboardInterrupt)
        print("error:", "stopped as asked" if stopped else error, file=sys.stderr)
        sys.exit(130 if stopped else 1 if isinstance(error, eq.ComputationFailed) else 2)


def plain(value):
    """What JSON can hold: numbers of NumPy as numbers of Python, null where they are not finite."""
    if isinstance(value, dict):
        return {str(key): plain(one) for key, one in value.items()}
    if hasattr(value, "tolist"):
        value = value.tolist()
    if isinstance(value, (list, tuple)):
        return [plain(one) for one in value]
    return None if isinstance(value, float) and not math.isfinite(value) else value


def deliver(options, page, output):
    """Write the files, and print the report."""
    page.names.update(output.names)
    numbers = {"status": "done", "paper": page.name, "version": eq.__version__, "quick": options.quick,
               **output.numbers}
    report, plots = page.text("report"), page.figures() if output.plots is None else output.plots
    texts = {"report.txt": report, "result.json": json.dumps(plain(numbers), indent=2, ensure_ascii=False) + "\n"}
    if "page" in page.told:
        texts[f"{page.name}.md"] = page.text("page")
    texts.update({f"{table}.csv": csv_lines([list(rows[0]), *(row.values() for row in rows)])
                  for table, rows in output.tables.items()})
    texts.update({f"{name}.csv": plot.csv() for name, plot in plots.items()})
    if options.out:
        for file, text in texts.items():
            (options.out / file).write_text(text, encoding="utf-8")
        for figure, draw in {**{name: plot.draw for name, plot in plots.items()}, **output.drawings}.items():
            draw(options.out / figure)
    if options.json and options.json != "-":
        pathlib.Path(options.json).write_text(texts["result.json"], encoding="utf-8")
    if options.json == "-" or not options.quiet:
        sys.stdout.write(texts["result.json" if options.json == "-" else "report.txt"])


def tracked(task, items, count=None):
    """The items, of which there are `count`, with the share that is done and the time left on stderr: on a terminal in
    one line, elsewhere a line a minute."""
    begun, last, terminal = time.monotonic(), -math.inf, sys.stderr.isatty()
    first, every = (1, 0.2) if terminal else (3, 60)
    for done, item in enumerate(items, 1):
        yield item
        elapsed, share = time.monotonic() - begun, done / (count or len(items))
        if tracked.shown and elapsed >= first and elapsed - last >= every:
            line = f"{task} {100 * share:.0f} %, {elapsed * (1 - share) / share:.0f} s left"
            print("\r\033[K" + line if terminal else line, end="" if terminal else "\n", file=sys.stderr, flush=True)
            last = elapsed
    if terminal and last >= 0:
        sys.stderr.write("\r\033[K")


tracked.shown = True


# ---- data, words

def rows_of(name, *texts):
    """The rows of data/papers/NAME.csv: texts; where columns of texts are named, the others are numbers."""
    with open(DATA / (name + ".csv"), newline="", encoding="utf-8") as file:
        return [Row({key: cell if key in texts or not texts else float(cell) for key, cell in row.items()})
                for row in csv.DictReader(file)]


def published(name):
    """Numbers of data/papers/NAME.csv by their names: rows with value, unit, source and further columns as texts."""
    return {row.name: Row({**row, "value": float(row.value)}) for row in rows_of(name)}


def counted(count, noun):
    return f"{count} {noun}{'' if count == 1 else 's'}"


def with_error(value, error, decimals=4):
    """A number and its error, unless that is not known."""
    return f"{value:.{decimals}f}" + (f" ± {error:.{decimals}f}" if math.isfinite(error) else "")


def machine():
    with open("/proc/cpuinfo", encoding="utf-8") as file:
        names = [line.split(": ", 1)[1].strip() for line in file if line.startswith("model name")]
    return f"{names[0] if names else 'unknown processor'}, {len(names)} cores; equidem {eq.__version__}"


# ---- samples side by side, their means, lines of least squares

def begin_worker():
    """Signals to all processes go to the first one, which ends the others: one that is killed while it takes a sample
    keeps a lock for which the end would wait for ever."""
    os.setpgrp()
    eq.set_threads(1)
    eq.show_progress(False)


workers = []


def samples_of(task, function, arguments, at_once=0):
    """function of each argument, in processes side by side, `at_once` to a process, with progress; in order."""
    if not workers:
        workers.append(multiprocessing.get_context("spawn").Pool(eq.threads(), begin_worker))
    found = workers[0].imap(function, arguments, at_once or max(1, len(arguments) // 50))
    return [*tracked(task, found, len(arguments))]


def seeds_of(task, function, count, *arguments):
    """Samples that differ in their seed, from 1 on."""
    return samples_of(task, function, [(*arguments, seed) for seed in range(1, count + 1)])


def mean_of(samples):
    """Mean, its standard error and the standard deviation; nan where the samples do not determine it."""
    samples = np.array([*samples], float)
    deviation = samples.std(ddof=1) if len(samples) > 1 else math.nan
    return Row(mean=samples.mean(), standard_error=deviation / math.sqrt(len(samples)), standard_deviation=deviation)


def means_of(samples):
    """mean_of each key of samples {key: number}."""
    return Row({key: mean_of(sample[key] for sample in samples) for key in samples[0]})


def mean_columns(samples):
    """The same as columns of one row: means, and standard errors behind them."""
    return {key + end: mean[what] for key, mean in means_of(samples).items()
            for end, what in (("", "mean"), ("_standard_error", "standard_error"))}


def power(x, y):
    """The exponent p of y ~ x^p between the last two points."""
    return math.log(y[-1] / y[-2]) / math.log(x[-1] / x[-2])


def fit_line(points):
    """The line y = intercept + slope x of least squares through points (x, y, standard error of y), each weighted by
    the inverse square of that, with its own errors."""
    x, y, errors = np.array([*points]).T
    (slope, intercept), covariance = np.polyfit(x, y, 1, w=1 / errors, cov="unscaled")
    slope_error, intercept_error = np.sqrt(np.diag(covariance))
    return Row(intercept=intercept, slope=slope, intercept_error=intercept_error, slope_error=slope_error)


# ---- contacts and moduli

UNIT_STRAINS = {"xx": [[1, 0], [0, 0]], "yy": [[0, 0], [0, 1]], "xy": [[0, 0.5], [0.5, 0]]}


def frames(normals):
    """Normal and tangent, the normal turned by 90 degrees counter-clockwise, of each contact, (contacts, 2, 2)."""
    return np.stack([normals, normals @ [[0, 1], [-1, 0]]], axis=1)


def components(vectors, normals):
    """Along the normal and the tangent of each contact."""
    return np.einsum("cij,cj->ci", frames(normals), vectors)


def affine_motions(assembly, gradient):
    """Motions (contacts, 2) of the second disc of each contact against the first, along normal and tangent, where all
    discs follow the gradient [[u1,1, u1,2], [u2,1, u2,2]] and do not turn."""
    branches = assembly.levers.sum(axis=1)[:, None] * assembly.normals
    return components(branches @ np.array(gradient).T, assembly.normals)


def unit_motions(cell, found):
    """The same under the unit strains xx, yy and xy of a homogenized cell, (3, contacts, 2): of the uniform strain, of
    what displacements and of what rotations of the discs add to it."""
    (i, j), states = cell.contacts.T, [found.fluctuations[name] for name in UNIT_STRAINS]
    uniform = [affine_motions(cell, strain) for strain in UNIT_STRAINS.values()]
    displaced = [components(one.displacements[j] - one.displacements[i], cell.normals) for one in states]
    rolled = [(cell.levers * one.rotations[cell.contacts]).sum(axis=1)[:, None] * (0, -1) for one in states]
    return np.array(uniform), np.array(displaced), np.array(rolled)


def moduli_of(c):
    """K and G of the isotropic part of a stiffness, and nu of plane strain."""
    c = np.asarray(c)
    bulk, shear = (c[0, 0] + c[1, 1] + 2 * c[0, 1]) / 4, (c[0, 0] + c[1, 1] - 2 * c[0, 1] + 4 * c[2, 2]) / 8
    return bulk, shear, (bulk - shear) / (2 * bulk)


def hexagonal_moduli(ratio):
    """K, G, E and nu in the plane of the hexagonal lattice with kN = 1 and that kT/kN (Abe 1996, eq. 34)."""
    K, G = math.sqrt(3) / 2, math.sqrt(3) / 4 * (1 + ratio)
    return K, G, 4 * K * G / (K + G), (K - G) / (K + G)
