# SPDX-License-Identifier: GPL-3.0-or-later
"""Texts, tables and figures of the scripts of papers: what NAME.toml says of results is written and drawn.

A place {expression:format} in a text is filled as one of an f-string, from the names of the results; an expression
holds no ':' and no '!' outside brackets.

[tables.NAME]   head and row, whose cells are separated by " | ": a row for each item `of` a list. The keys of an item
                are names in it, `one` is the item itself. markdown = true: as one of Markdown. {table('NAME')} is its
                place in a text.
[figures.NAME]  title, axes x and y (label, low, high, logarithmic), lines = [[x, label, colour]], and series. Their x,
                y and error (of bars to either side) are expressions: numbers for each item `of` a list, or lists where
                there is no `of`; `where` chooses items, look is an expression of further members of Series.
each = ["names", list] makes a figure (`name` is the text of its name) or a series (or all its `parts`) for each item.
"""
import csv
import dataclasses
import io
import itertools
import math
import pathlib
import re
import string
import tomllib

# The colour-blind-safe palette of Okabe and Ito (2008).
COLOURS = {"black": "#000000", "orange": "#E69F00", "sky_blue": "#56B4E9", "green": "#009E73", "yellow": "#F0E442",
           "blue": "#0072B2", "vermilion": "#D55E00", "purple": "#CC79A7"}
MARKERS = {"circle": "o", "square": "s", "triangle": "^", "diamond": "D"}


class Row(dict):
    """A row of results, whose keys are attributes, too."""
    __getattr__ = dict.__getitem__


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
    errors: list = dataclasses.field(default_factory=list)  # bars to either side of each point; empty: none

    def ends(self):
        """Of the bars."""
        return [[y + sign * error for y, error in zip(self.y, self.errors)] for sign in (-1, 1)]


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
        x_name, y_name = (column_name(axis.label) or name for axis, name in ((self.x, "x"), (self.y, "y")))
        shared = all(list(series.x) == list(self.series[0].x) for series in self.series)
        names = [x_name] if shared else []
        for series in self.series:
            wanted = column_name(series.column or series.label) or "y"
            numbered = itertools.chain([wanted], (f"{wanted}_{k}" for k in itertools.count(2)))
            names.append(next(name for name in numbered if name not in names))
        if shared:
            columns = {x_name: self.series[0].x}
            for name, series in zip(names[1:], self.series):
                columns[name] = series.y
                if len(series.errors):
                    columns[name + "_low"], columns[name + "_high"] = series.ends()
            return csv_text(columns)
        bars = any(len(series.errors) for series in self.series)
        rows = [["series", x_name, y_name, *["low", "high"] * bars]]
        for name, series in zip(names, self.series):
            ends = series.ends() if len(series.errors) else [[""] * len(series.x)] * 2
            rows += [[name, *row] for row in zip(series.x, series.y, *ends * bars)]
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
        shown = [series for series in self.series if series.style in ("points", "line_with_points")]
        for series in self.series:
            colour = COLOURS[series.colour]
            look = {"color": colour, "label": series.label or "_", "linewidth": 1.4, "markersize": 6,
                    "linestyle": {"points": "", "dashed_line": "--"}.get(series.style, "-"),
                    "marker": MARKERS[series.marker] if series in shown else "",
                    "markerfacecolor": colour if series.filled else "none"}
            if len(series.errors):
                axes.errorbar(series.x, series.y, yerr=series.errors, capsize=2, elinewidth=0.9, **look)
            else:
                axes.plot(series.x, series.y, **look)
        for axis, name in ((self.x, "x"), (self.y, "y")):
            axes.set(**{name + "label": axis.label, name + "scale": "log" if axis.logarithmic else "linear"})
            axes.set(**{name + "lim": (axis.low, axis.high)})
        (low, high), beyond = axes.get_ylim(), []
        for series in shown:
            for edge, sign in ((high, "^"), (low, "v")):  # markers beyond the range are shown at its edge
                outside = [x for x, y in zip(series.x, series.y) if (y > high if sign == "^" else y < low)]
                if outside:
                    axes.plot(outside, [edge] * len(outside), sign, color=COLOURS[series.colour], markersize=5,
                              clip_on=False)
                    beyond = ["triangles at an edge: beyond it"]
        for x, label, colour in self.vertical_lines:
            axes.axvline(x, color=COLOURS[colour], linewidth=1, linestyle=(0, (5, 4)))
            axes.annotate(label, (x, 0.985), (-3, 0), xycoords=("data", "axes fraction"), textcoords="offset points",
                          rotation=90, ha="right", va="top", fontsize=10, color=COLOURS[colour])
        for label in beyond:
            axes.plot([], [], "^", color="#777777", markersize=5, label=label)
        labels = [series.label for series in self.series if series.label] + beyond
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


def aligned(rows):
    """Lines of text; the first column is aligned to the left, others to the right."""
    widths = [max(len(row[k]) for row in rows if k < len(row)) for k in range(max(map(len, rows)))]
    return "".join("".join("  " + (cell.rjust(width) if k else cell.ljust(width))
                           for k, (cell, width) in enumerate(zip(row, widths))).rstrip(" ") + "\n" for row in rows)


def markdown(head, rows):
    return "".join("| " + " | ".join(cells) + " |\n" for cells in (head, ["---"] * len(head), *rows))


def span(low, high):
    """Items {at} of a curve of 100 pieces."""
    return [{"at": low + (high - low) * k / 100} for k in range(101)]


class Expressions(string.Formatter):
    """str.format whose places hold expressions."""
    def get_field(self, field_name, args, kwargs):
        return eval(field_name, dict(kwargs)), None  # pylint: disable=eval-used


def told_of(name):
    """tools/papers/NAME.toml."""
    return tomllib.loads(pathlib.Path(__file__).with_name(f"{name}.toml").read_text(encoding="utf-8"))


class Page:
    """What NAME.toml says, over the names of results and of functions."""
    def __init__(self, name, *names):
        self.told = told_of(name)
        self.names = {"math": math, "span": span, "told": self.told, "table": self.table, "text": self.text,
                      "lines": self.lines}
        for more in names:
            self.names.update(more)

    def text(self, name, /, **names):
        return self.fill(self.told[name], names)

    def lines(self, name, rows):
        """The text once for each row, joined."""
        return "".join(self.fill(self.told[name], self.inside(row)) for row in rows)

    @staticmethod
    def inside(item):
        """The names inside an item of a list."""
        return {"one": item, **(item if isinstance(item, dict) else {})}

    def fill(self, text, names=()):
        return Expressions().vformat(text, (), {**self.names, **dict(names)})

    def value(self, expression, names):
        """Of the text of an expression; what is no text stands for itself."""
        if not isinstance(expression, str):
            return expression
        return eval(expression, {**self.names, **names})  # pylint: disable=eval-used

    def each(self, told, names):
        """The names inside each item of `each`, or those given where there is none."""
        if "each" not in told:
            return [names]
        keys, expression = told["each"]
        keys = keys.split(", ")
        return [{**names, **dict(zip(keys, item if len(keys) > 1 else [item]))}
                for item in self.value(expression, names)]

    def items(self, told, names):
        """The names inside each item of the list `of`, of those that `where` chooses."""
        for item in self.value(told["of"], names):
            inside = {**names, **self.inside(item)}
            if self.value(told.get("where", True), inside):
                yield inside

    def table(self, name, /, **names):
        told = self.told["tables"][name]
        head, *rows = [self.fill(cells, inside).split(" | ") for cells, inside in (
            (told["head"], names), *((told["row"], inside) for inside in self.items(told, names)))]
        return markdown(head, rows) if told.get("markdown") else aligned([head, *rows])

    def leaves(self, told, names):
        """(entry, names inside it) of an entry, for each item of `each` and all its `parts`."""
        for inside in self.each(told, names):
            if "parts" in told:
                yield from (one for part in told["parts"] for one in self.leaves(part, inside))
            else:
                yield told, inside

    def series(self, parts, names):
        for told, inside in self.leaves({"parts": parts}, names):
            found = {key: told[key] for key in ("style", "colour", "marker", "filled") if key in told}
            found.update({key: self.fill(told[key], inside) for key in ("label", "column") if key in told})
            for key, member in (("x", "x"), ("y", "y"), ("error", "errors")):
                if key in told:
                    found[member] = list(self.value(told[key], inside)) if "of" not in told else [
                        self.value(told[key], item) for item in self.items(told, inside)]
            found.update(self.value(told.get("look", {}), inside))
            if found["x"]:
                yield Series(**found)

    def axis(self, told, names):
        return Axis(self.fill(told["label"], names), self.value(told.get("low"), names),
                    self.value(told.get("high"), names), told.get("logarithmic", False))

    def figures(self, chosen=None, /, **names):
        """{name: Plot} of all figures, or of the entries that are chosen."""
        found = {}
        for key in self.told["figures"] if chosen is None else chosen:
            told = self.told["figures"][key]
            for inside in self.each(told, names):
                lines = told.get("lines", ())
                lines = self.value(lines, inside) if isinstance(lines, str) else [
                    (self.value(x, inside), self.fill(label, inside), colour) for x, label, colour in lines]
                found[self.fill(told.get("name", key), inside)] = Plot(
                    self.fill(told["title"], inside), self.axis(told["x"], inside), self.axis(told["y"], inside),
                    [*self.series(told["series"], inside)], lines)
        return found
