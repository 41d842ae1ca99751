# SPDX-License-Identifier: GPL-3.0-or-later
"""What the scripts of papers share: command line, tables, plots, published numbers, the module equidem.

A script computes an Output and hands main() the function that does. Files of one are written into --out: report.txt,
result.json, NAME.csv of a table, NAME.csv, NAME.svg and NAME.png of a plot.
"""
import argparse
import csv
import dataclasses
import io
import json
import math
import multiprocessing
import pathlib
import re
import signal
import sys
import time

ROOT = pathlib.Path(__file__).resolve().parents[2]
DATA = ROOT / "data" / "papers"
try:
    import equidem as eq
except ImportError:  # not installed: the one that was built here
    for preset in ("release", "dev"):
        sys.path.append(str(ROOT / "build" / preset / "python"))
    try:
        import equidem as eq
    except ImportError as error:
        sys.exit(f"The Python module 'equidem' cannot be imported by {sys.executable} ({error}). Run tools/prepare release "
                 "\"build python\" equidem_python, and take the interpreter that it was built for, such as /usr/bin/python3")

EXIT_CODES = """
Exit codes: 0 done; 1 the computation failed, and the message says why; 2 bad input or usage; 130 interrupted."""
# The colour-blind-safe palette of Okabe and Ito (2008).
COLOURS = {"black": "#000000", "orange": "#E69F00", "sky_blue": "#56B4E9", "green": "#009E73", "yellow": "#F0E442",
           "blue": "#0072B2", "vermilion": "#D55E00", "purple": "#CC79A7"}
MARKERS = {"circle": "o", "square": "s", "triangle": "^", "diamond": "D"}


@dataclasses.dataclass
class Output:
    """Results of a paper."""
    report: str
    numbers: dict = dataclasses.field(default_factory=dict)  # of result.json
    tables: dict = dataclasses.field(default_factory=dict)  # name: {column: list}
    plots: dict = dataclasses.field(default_factory=dict)  # name: Plot, or a function of the path without its end
    texts: dict = dataclasses.field(default_factory=dict)  # file name: text
    status: str = "done"


@dataclasses.dataclass
class Series:
    """One curve. A point that is not finite is a gap."""
    label: str = ""  # in the legend; empty: not in the legend
    x: list = dataclasses.field(default_factory=list)
    y: list = dataclasses.field(default_factory=list)
    style: str = "line"  # line, dashed_line, points, line_with_points
    colour: str = "black"
    marker: str = "circle"
    filled: bool = True
    column: str = ""  # name in the data file; empty: made of the label
    low: list = dataclasses.field(default_factory=list)  # ends of an error bar at each point; empty: none
    high: list = dataclasses.field(default_factory=list)


@dataclasses.dataclass
class Axis:
    label: str = ""
    low: float | None = None
    high: float | None = None
    logarithmic: bool = False


@dataclasses.dataclass
class Plot:
    """Labels may hold formulas between dollars."""
    title: str
    x: Axis
    y: Axis
    series: list = dataclasses.field(default_factory=list)  # later ones are drawn on top
    vertical_lines: list = dataclasses.field(default_factory=list)  # (x, label, colour)

    def csv(self):
        """One row for each x where all series share them, else one row for each point."""
        names = Names()
        bars = any(series.low for series in self.series)
        if all(list(series.x) == list(self.series[0].x) for series in self.series):
            columns = {names.add(column_name(self.x.label) or "x"): self.series[0].x}
            for series in self.series:
                name = names.add(column_name(series.column or series.label) or "y")
                columns[name] = series.y
                if series.low:
                    columns.update({names.add(name + "_low"): series.low, names.add(name + "_high"): series.high})
            return csv_text(columns)
        rows = [["series", column_name(self.x.label) or "x", column_name(self.y.label) or "y",
                 *(["low", "high"] if bars else [])]]
        for series in self.series:
            name = names.add(column_name(series.column or series.label) or "y")
            for k, (x, y) in enumerate(zip(series.x, series.y)):
                ends = [series.low[k], series.high[k]] if series.low else [""] * (2 if bars else 0)
                rows.append([name, x, y, *ends])
        return csv_lines(rows)

    def draw(self, path):
        """Draw PATH.svg and PATH.png, 900 x 650 pixels."""
        import matplotlib
        matplotlib.use("Agg")
        from matplotlib import pyplot
        pyplot.rcParams.update({"svg.fonttype": "none", "svg.hashsalt": "equidem", "font.size": 12,
                                "axes.spines.top": False, "axes.spines.right": False, "mathtext.default": "it"})
        figure, axes = pyplot.subplots(figsize=(9, 6.5), dpi=100)
        axes.set_title(self.title, fontsize=12 * min(1, 85 / max(len(self.title), 1)))
        axes.grid(color="#dddddd", linewidth=0.5)
        axes.set_axisbelow(True)
        for series in self.series:
            colour, shown = COLOURS[series.colour], series.style in ("points", "line_with_points")
            look = {"color": colour, "label": series.label or "_", "linewidth": 1.4, "markersize": 6,
                    "linestyle": {"points": "", "dashed_line": "--"}.get(series.style, "-"),
                    "marker": MARKERS[series.marker] if shown else "",
                    "markerfacecolor": colour if series.filled else "none"}
            if series.low:
                down = [max(0, y - low) for y, low in zip(series.y, series.low)]
                up = [max(0, high - y) for y, high in zip(series.y, series.high)]
                axes.errorbar(series.x, series.y, yerr=[down, up], capsize=2, elinewidth=0.9, **look)
            else:
                axes.plot(series.x, series.y, **look)
        for axis, scale, limits in ((self.x, axes.set_xscale, axes.set_xlim), (self.y, axes.set_yscale, axes.set_ylim)):
            if axis.logarithmic:
                scale("log")
            limits(axis.low, axis.high)
        (low, high), beyond = axes.get_ylim(), ""
        for series in (one for one in self.series if one.style in ("points", "line_with_points")):
            for edge, sign in ((high, "^"), (low, "v")):  # markers beyond the range are shown at its edge
                outside = [x for x, y in zip(series.x, series.y) if (y > high if sign == "^" else y < low)]
                if outside:
                    axes.plot(outside, [edge] * len(outside), sign, color=COLOURS[series.colour], markersize=5,
                              clip_on=False)
                    beyond = "triangles at an edge: beyond it"
        for x, label, colour in self.vertical_lines:
            axes.axvline(x, color=COLOURS[colour], linewidth=1, linestyle=(0, (5, 4)))
            axes.annotate(label, (x, 0.985), (-3, 0), xycoords=("data", "axes fraction"), textcoords="offset points",
                          rotation=90, ha="right", va="top", fontsize=10, color=COLOURS[colour])
        axes.set_xlabel(self.x.label)
        axes.set_ylabel(self.y.label)
        if beyond:
            axes.plot([], [], "^", color="#777777", markersize=5, label=beyond)
        labels = [series.label for series in self.series if series.label] + ([beyond] if beyond else [])
        if labels:
            columns = max(1, min(len(labels), 3, 100 // (8 + max(len(label) for label in labels))))
            axes.legend(loc="upper center", bbox_to_anchor=(0.5, -0.12), ncol=columns, frameon=False, fontsize=10)
        save(figure, path)


def save(figure, path):
    """Save a figure of matplotlib as PATH.svg and PATH.png, with the same bytes each time."""
    from matplotlib import pyplot
    figure.savefig(f"{path}.svg", bbox_inches="tight", metadata={"Date": None})
    figure.savefig(f"{path}.png", bbox_inches="tight", metadata={"Software": None})
    pyplot.close(figure)


def curve(formula, low, high, **look):
    """A curve of 100 pieces."""
    x = [low + (high - low) * k / 100 for k in range(101)]
    return Series(x=x, y=[formula(at) for at in x], **look)


class Names:
    """Names of columns, made different."""
    def __init__(self):
        self.all = []

    def add(self, wanted):
        name, k = wanted, 2
        while name in self.all:
            name, k = f"{wanted}_{k}", k + 1
        self.all.append(name)
        return name


def column_name(label):
    return re.sub(r"[^0-9A-Za-z]+", "_", label).strip("_")


def shortest(value):
    """The shortest text that reads back to the same bits; whole numbers without a point."""
    if isinstance(value, float):
        return str(int(value)) if value.is_integer() and abs(value) < 1e16 else repr(float(value))
    return "" if value is None else str(value)


def csv_lines(rows):
    text = io.StringIO()
    csv.writer(text, lineterminator="\n").writerows([[shortest(cell) for cell in row] for row in rows])
    return text.getvalue()


def csv_text(columns):
    """A table {column: list} as comma-separated values."""
    return csv_lines([list(columns), *zip(*columns.values())])


class Table:
    """A table of text; cells of a row are separated by " & "."""
    def __init__(self, *rows):
        self.rows = []
        for row in rows:
            self.add(row)

    def add(self, row):
        self.rows.append(row.split(" & "))

    def _widths(self, least):
        columns = max(len(row) for row in self.rows)
        return [max([least, *(len(row[k]) for row in self.rows if k < len(row))]) for k in range(columns)]

    def __str__(self):
        return self.text()

    def text(self):
        widths = self._widths(0)
        lines = []
        for row in self.rows:
            cells = [cell.rjust(widths[k]) if k else cell.ljust(widths[0]) for k, cell in enumerate(row)]
            lines.append("".join("  " + cell for cell in cells).rstrip(" ") + "\n")
        return "".join(lines)

    def markdown(self):
        widths = self._widths(3)
        full = [row + [""] * (len(widths) - len(row)) for row in self.rows]
        lines = ["".join(f"| {cell.ljust(width)} " for cell, width in zip(row, widths)) + "|\n" for row in full]
        lines.insert(1, "".join("|" + "-" * (width + 2) for width in widths) + "|\n")
        return "".join(lines)


def filled(name, **values):
    """The text tools/papers/NAME.txt with values, as str.format does it."""
    return (ROOT / "tools" / "papers" / (name + ".txt")).read_text(encoding="utf-8").format(**values)


def counted(count, noun):
    return f"{count} {noun}{'' if count == 1 else 's'}"


@dataclasses.dataclass
class Mean:
    """Mean of samples, its standard error and their standard deviation; nan where the samples do not determine it."""
    mean: float
    standard_error: float
    standard_deviation: float


def mean_of(samples):
    samples = [float(sample) for sample in samples]
    mean = sum(samples) / len(samples)
    if len(samples) < 2:
        return Mean(mean, math.nan, math.nan)
    scatter = sum((sample - mean) ** 2 for sample in samples)
    deviation = math.sqrt(scatter / (len(samples) - 1))
    return Mean(mean, deviation / math.sqrt(len(samples)), deviation)


def published(name):
    """Numbers of data/papers/NAME.csv by their names: objects with value, unit, source and further columns as texts."""
    with open(DATA / (name + ".csv"), newline="", encoding="utf-8") as file:
        rows = list(csv.DictReader(line for line in file if not line.startswith("#")))
    return {row["name"]: argparse.Namespace(**{**row, "value": float(row["value"])}) for row in rows}


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


def main(name, description, reproduce, *, files=lambda options: [], quick=True, add_options=lambda parser: None):
    """Read the command line, reproduce, deliver, and end the process with its exit code.

    reproduce takes the options and gives an Output; files gives the names of what it will write into --out beside
    report.txt and result.json, which must not exist unless --overwrite is given; add_options declares more options.
    """
    parser = argparse.ArgumentParser(prog=f"tools/papers/{name}.py", description=description, epilog=EXIT_CODES,
                                     formatter_class=argparse.RawDescriptionHelpFormatter, allow_abbrev=False)
    add_options(parser)
    if quick:
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
        targets = [pathlib.Path(options.json)] if options.json not in (None, "-") else []
        if options.out:
            targets += [options.out / file for file in ("report.txt", "result.json", *files(options))]
            options.out.mkdir(parents=True, exist_ok=True)
        for path in targets:
            if path.exists() and not options.overwrite:
                raise eq.BadInput(f"'{path}' exists", "files are not replaced unasked",
                                  "Give --overwrite, or another folder")
        deliver(options, name, reproduce(options))
    except (eq.BadInput, OSError) as error:
        sys.exit(stop(error, 2))
    except (eq.Interrupted, KeyboardInterrupt):
        sys.exit(stop("stopped as asked", 130))
    except eq.ComputationFailed as error:
        sys.exit(stop(error, 1))


def stop(message, code):
    print(f"error: {message}", file=sys.stderr)
    return code


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
    numbers = {"status": output.status, "paper": name, "version": eq.__version__, **output.numbers}
    numbers = json.dumps(plain(numbers), indent=2, allow_nan=False, ensure_ascii=False) + "\n"
    if options.out:
        texts = {**output.texts, "report.txt": output.report, "result.json": numbers}
        texts.update({f"{table}.csv": csv_text(columns) for table, columns in output.tables.items()})
        for plot, drawn in output.plots.items():
            (options.out / plot).parent.mkdir(parents=True, exist_ok=True)
            if isinstance(drawn, Plot):
                texts[plot + ".csv"] = drawn.csv()
                drawn.draw(options.out / plot)
            else:
                drawn(options.out / plot)
        for file, text in texts.items():
            (options.out / file).parent.mkdir(parents=True, exist_ok=True)
            (options.out / file).write_text(text, encoding="utf-8")
    if options.json == "-":
        sys.stdout.write(numbers)
        return
    if options.json:
        pathlib.Path(options.json).write_text(numbers, encoding="utf-8")
    if not options.quiet:
        sys.stdout.write(output.report)


# ---- random numbers, samples side by side, lines of least squares

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
        def turned(x, k):
            return (x << k | x >> 64 - k) % 2**64
        a, b, c, d = self.state
        result = (turned((a + d) % 2**64, 23) + a) % 2**64
        c, d = c ^ a, d ^ b
        self.state = [a ^ d, b ^ c, c ^ (b << 17) % 2**64, turned(d, 45)]
        return result

    def uniform(self, low=0.0, high=1.0):
        return low + (high - low) * ((self.bits() >> 11) * 2.0**-53)

    def below(self, count):
        return self.bits() * count >> 64


@dataclasses.dataclass
class Line:
    """y = intercept + slope x, with standard errors from those of y."""
    intercept: float
    slope: float
    intercept_error: float
    slope_error: float


def fit_line(x, y, errors):
    """The line of least squares, each y weighted by the inverse square of its standard error."""
    weights = [1 / error**2 for error in errors]
    total = sum(weights)
    x_mean, y_mean = (sum(w * value for w, value in zip(weights, values)) / total for values in (x, y))
    xx = sum(w * (at - x_mean)**2 for w, at in zip(weights, x))
    slope = sum(w * (at - x_mean) * (value - y_mean) for w, at, value in zip(weights, x, y)) / xx
    return Line(y_mean - slope * x_mean, slope, math.sqrt(1 / total + x_mean**2 / xx), math.sqrt(1 / xx))


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


def rows_of(name):
    """The rows of data/papers/NAME.csv as texts."""
    with open(DATA / (name + ".csv"), newline="", encoding="utf-8") as file:
        return list(csv.DictReader(file))


def columns_of(rows):
    """Rows {key: value} as a table {column: list}."""
    return {key: [row[key] for row in rows] for key in rows[0]}


def points(label, x, y, colour="black", marker="circle", *, filled=True, joined=False, errors=()):
    """Points, where wanted joined by a line or with bars of +- one standard error."""
    return Series(label, list(x), list(y), "line_with_points" if joined else "points", colour, marker, filled,
                  low=[at - error for at, error in zip(y, errors)], high=[at + error for at, error in zip(y, errors)])


def moved_discs(discs, motions, **groups):
    """Supports of discs, each with its motion, and their groups beside those given."""
    names = [f"disc {disc}" for disc in discs]
    return {"supports": [{"group": name, "ux": float(u[0]), "uy": float(u[1])} for name, u in zip(names, motions)],
            "group": [{"name": name, "discs": [int(disc)]} for name, disc in zip(names, discs)] +
                     [{"name": name, "discs": members} for name, members in groups.items()]}


def markdown(head, rows):
    """A table of Markdown."""
    return "".join("| " + " | ".join(cells) + " |\n" for cells in (head, ["---"] * len(head), *rows))


def machine():
    with open("/proc/cpuinfo", encoding="utf-8") as file:
        names = [line.split(": ", 1)[1].strip() for line in file if line.startswith("model name")]
    return f"{names[0] if names else 'unknown processor'}, {len(names)} cores; equidem {eq.__version__}"
