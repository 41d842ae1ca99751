# SPDX-License-Identifier: GPL-3.0-or-later
"""What the scripts of papers share: command line, published numbers, samples side by side, the module equidem.

A script computes an Output and hands main() the function that does. Files of one are written into --out: report.txt,
result.json, NAME.csv of a table, NAME.csv, NAME.svg and NAME.png of a plot. shown.py makes texts and plots.
"""
import argparse
import csv
import dataclasses
import json
import math
import multiprocessing
import pathlib
import signal
import sys
import time

import numpy as np

from shown import Plot, Row, csv_text

ROOT = pathlib.Path(__file__).resolve().parents[2]
DATA = ROOT / "data" / "papers"
try:
    import equidem as eq
except ImportError:  # not installed: the one that was built here
    for preset in ("release", "dev", "test"):
        sys.path.append(str(ROOT / "build" / preset / "python"))
    try:
        import equidem as eq
    except ImportError as missing:
        sys.exit(f"The Python module 'equidem' cannot be imported by {sys.executable} ({missing}). Run tools/prepare "
                 "release \"build python\" equidem_python, and take the interpreter that it was built for, such as "
                 "/usr/bin/python3")

EXIT_CODES = """
Exit codes: 0 done; 1 the computation failed, and the message says why; 2 bad input or usage; 130 interrupted."""


# ---- the command line, and what is delivered

@dataclasses.dataclass
class Output:
    """Results of a paper."""
    report: str
    numbers: dict  # of result.json
    tables: dict = dataclasses.field(default_factory=dict)  # name: {column: list}
    plots: dict = dataclasses.field(default_factory=dict)  # name: Plot, or a function of the path without its end
    texts: dict = dataclasses.field(default_factory=dict)  # file name: text


def main(name, description, reproduce, add_options=lambda parser: None):
    """Read the command line, reproduce (options -> Output), deliver, and end the process with its exit code."""
    parser = argparse.ArgumentParser(prog=f"tools/papers/{name}.py", description=description, epilog=EXIT_CODES,
                                     formatter_class=argparse.RawDescriptionHelpFormatter, allow_abbrev=False)
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
        Progress.shown = not options.quiet
        present = [pathlib.Path(options.json)] if options.json not in (None, "-") else []
        if options.out:
            options.out.mkdir(parents=True, exist_ok=True)
            present += sorted(options.out.glob("[!.]*.*"))
        for path in present:
            if path.exists() and not options.overwrite:
                raise eq.BadInput(f"'{path}' exists", "files are not replaced unasked",
                                  "Give --overwrite, or another folder")
        deliver(options, name, reproduce(options))
    except (eq.BadInput, OSError) as error:
        stop(error, 2)
    except (eq.Interrupted, KeyboardInterrupt):
        stop("stopped as asked", 130)
    except eq.ComputationFailed as error:
        stop(error, 1)


def stop(message, code):
    print(f"error: {message}", file=sys.stderr)
    sys.exit(code)


def plain(value):
    """What JSON can hold: numbers of NumPy as numbers of Python, null where they are not finite."""
    if isinstance(value, dict):
        return {str(key): plain(one) for key, one in value.items()}
    if hasattr(value, "tolist"):
        value = value.tolist()
    if isinstance(value, (list, tuple)):
        return [plain(one) for one in value]
    return None if isinstance(value, float) and not math.isfinite(value) else value


def deliver(options, name, output):
    """Write the files, and print the report."""
    numbers = {"status": "done", "paper": name, "version": eq.__version__, **output.numbers}
    numbers = json.dumps(plain(numbers), indent=2, allow_nan=False, ensure_ascii=False) + "\n"
    if options.out:
        texts = {**output.texts, "report.txt": output.report, "result.json": numbers}
        texts.update({f"{table}.csv": csv_text(columns) for table, columns in output.tables.items()})
        for plot, drawn in output.plots.items():
            if isinstance(drawn, Plot):
                texts[plot + ".csv"] = drawn.csv()
                drawn.draw(options.out / plot)
            else:
                drawn(options.out / plot)
        for file, text in texts.items():
            (options.out / file).write_text(text, encoding="utf-8")
    if options.json == "-":
        sys.stdout.write(numbers)
        return
    if options.json:
        pathlib.Path(options.json).write_text(numbers, encoding="utf-8")
    if not options.quiet:
        sys.stdout.write(output.report)


class Progress:
    """Share that is done and time left, on stderr: on a terminal in one line, elsewhere a line a minute."""
    shown = True

    def __init__(self, task):
        self.task, self.begun, self.last = task, time.monotonic(), None
        self.terminal = sys.stderr.isatty()

    def update(self, fraction):
        first, every = (1, 0.2) if self.terminal else (3, 60)
        elapsed = time.monotonic() - self.begun
        if not Progress.shown or elapsed < first or (self.last is not None and elapsed - self.last < every):
            return
        left = f", {elapsed * (1 - fraction) / fraction:.0f} s left" if fraction > 0 else ""
        line = f"{self.task} {100 * fraction:.0f} %{left}"
        sys.stderr.write("\r\033[K" + line if self.terminal else line + "\n")
        sys.stderr.flush()
        self.last = elapsed

    def end(self):
        if self.terminal and self.last is not None:
            sys.stderr.write("\r\033[K")


# ---- data, words

def rows_of(name):
    """The rows of data/papers/NAME.csv as texts."""
    with open(DATA / (name + ".csv"), newline="", encoding="utf-8") as file:
        return [Row(row) for row in csv.DictReader(file)]


def published(name):
    """Numbers of data/papers/NAME.csv by their names: rows with value, unit, source and further columns as texts."""
    return {row.name: Row({**row, "value": float(row.value)}) for row in rows_of(name)}


def columns_of(rows):
    """Rows {key: value} as a table {column: list}."""
    return {key: [row[key] for row in rows] for key in rows[0]}


def counted(count, noun):
    return f"{count} {noun}{'' if count == 1 else 's'}"


def machine():
    with open("/proc/cpuinfo", encoding="utf-8") as file:
        names = [line.split(": ", 1)[1].strip() for line in file if line.startswith("model name")]
    return f"{names[0] if names else 'unknown processor'}, {len(names)} cores; equidem {eq.__version__}"


# ---- samples side by side, their means, lines of least squares

def begin_worker():
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    eq.set_threads(1)
    eq.show_progress(False)


workers = []


def samples_of(task, function, arguments, at_once=0):
    """function of each argument, in processes side by side, `at_once` to a process, with progress; in order."""
    if not workers:
        workers.append(multiprocessing.get_context("spawn").Pool(eq.threads(), begin_worker))
    progress, found = Progress(task), []
    for one in workers[0].imap(function, arguments, at_once or max(1, len(arguments) // 50)):
        found.append(one)
        progress.update(len(found) / len(arguments))
    progress.end()
    return found


def seeds_of(task, function, count, *arguments):
    """Samples that differ in their seed, from 1 on."""
    return samples_of(task, function, [(*arguments, seed) for seed in range(1, count + 1)])


def mean_of(samples):
    """Mean, its standard error and the standard deviation; nan where the samples do not determine it."""
    samples = [float(sample) for sample in samples]
    mean = sum(samples) / len(samples)
    scatter = sum((sample - mean) ** 2 for sample in samples)
    deviation = math.sqrt(scatter / (len(samples) - 1)) if len(samples) > 1 else math.nan
    return Row(mean=mean, standard_error=deviation / math.sqrt(len(samples)), standard_deviation=deviation)


def fit_line(x, y, errors):
    """The line y = intercept + slope x of least squares, each y weighted by the inverse square of its standard error,
    with its own errors."""
    weights = [1 / error**2 for error in errors]
    total = sum(weights)
    x_mean, y_mean = (sum(w * value for w, value in zip(weights, values)) / total for values in (x, y))
    xx = sum(w * (at - x_mean)**2 for w, at in zip(weights, x))
    slope = sum(w * (at - x_mean) * (value - y_mean) for w, at, value in zip(weights, x, y)) / xx
    return Row(intercept=y_mean - slope * x_mean, slope=slope, intercept_error=math.sqrt(1 / total + x_mean**2 / xx),
               slope_error=math.sqrt(1 / xx))


class Random:
    """xoshiro256++ seeded through splitmix64: the numbers of equidem/core/random.hpp."""
    def __init__(self, seed):
        self.state = []
        for _ in range(4):
            seed = (seed + 0x9E3779B97F4A7C15) % 2**64
            z = (seed ^ seed >> 30) * 0xBF58476D1CE4E5B9 % 2**64
            z = (z ^ z >> 27) * 0x94D049BB133111EB % 2**64
            self.state.append(z ^ z >> 31)

    def bits(self):
        def turned_left(x, k):
            return (x << k | x >> 64 - k) % 2**64
        a, b, c, d = self.state
        result = (turned_left((a + d) % 2**64, 23) + a) % 2**64
        c, d = c ^ a, d ^ b
        self.state = [a ^ d, b ^ c, c ^ (b << 17) % 2**64, turned_left(d, 45)]
        return result

    def uniform(self):
        return (self.bits() >> 11) * 2.0**-53

    def shuffle(self, values):
        """A list in random order, in place."""
        for k in range(len(values), 1, -1):
            other = self.bits() * k >> 64
            values[k - 1], values[other] = values[other], values[k - 1]
        return values


# ---- contacts and moduli

def turned(vectors):
    """By 90 degrees counter-clockwise."""
    return np.stack([-vectors[:, 1], vectors[:, 0]], axis=1)


def components(vectors, normals):
    """Along the normal and the tangent of each contact."""
    return np.stack([(vectors * normals).sum(axis=1), (vectors * turned(normals)).sum(axis=1)], axis=1)


def vectors_of(forces, normals):
    """Normal (tension positive) and tangential forces (contacts, 2) as vectors, on the first disc of each contact."""
    return forces[:, :1] * normals + forces[:, 1:] * turned(normals)


def disc_stresses(assembly, forces):
    """Abe (1996), (50), of every disc, (n, 2, 2): sum of force by arm over the area of the cell of the disc."""
    stresses = np.zeros((len(assembly), 2, 2))
    dyad = vectors_of(forces, assembly.normals)[:, :, None] * assembly.normals[:, None, :]
    for end in (0, 1):  # on the second disc the opposite force, at the opposite arm
        np.add.at(stresses, assembly.contacts[:, end], assembly.levers[:, end, None, None] * dyad)
    return stresses / assembly.cell_areas[:, None, None]


def moduli_of(c):
    """K and G of the isotropic part of a stiffness, and nu of plane strain."""
    c = np.asarray(c)
    bulk, shear = (c[0, 0] + c[1, 1] + 2 * c[0, 1]) / 4, (c[0, 0] + c[1, 1] - 2 * c[0, 1] + 4 * c[2, 2]) / 8
    return bulk, shear, (bulk - shear) / (2 * bulk)


def hexagonal_moduli(ratio):
    """K, G, E and nu in the plane of the hexagonal lattice with kN = 1 and that kT/kN (Abe 1996, eq. 34)."""
    K, G = math.sqrt(3) / 2, math.sqrt(3) / 4 * (1 + ratio)
    return K, G, 4 * K * G / (K + G), (K - G) / (K + G)


def moved_discs(discs, motions, **groups):
    """Supports of discs, each with its motion, and their groups beside those given."""
    names = [f"disc {disc}" for disc in discs]
    return {"supports": [{"group": name, "ux": float(u[0]), "uy": float(u[1])} for name, u in zip(names, motions)],
            "group": [{"name": name, "discs": [int(disc)]} for name, disc in zip(names, discs)] +
                     [{"name": name, "discs": members} for name, members in groups.items()]}
