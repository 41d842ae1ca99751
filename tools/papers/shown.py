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
    error: list = dataclasses.field(default_factory=list)  # bars to either side of each point; empty: none

    def ends(self):
        """Of the bars, the lower and the upper ones."""
        return [[y + sign * error for y, error in zip(self.y, self.error)] for sign in (-1, 1) if self.error]


@dataclasses.dataclass
class Plot:
    """Labels may hold formulas between dollars."""
    title: str
    x: Row  # label, low, high (None: as far as there are points), logarithmic
    y: Row
    series: list  # later ones are drawn on top
    vertical_lines: list  # (x, label, colour)

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
                columns.update(zip((name, name + "_low", name + "_high"), (series.y, *series.ends())))
            return csv_lines([list(columns), *zip(*columns.values())])
        bars = any(series.error for series in self.series)
        rows = [["series", x_name, y_name, *["low", "high"] * bars]]
        for name, series in zip(names, self.series):
            ends = series.ends() or [[""] * len(series.x)] * 2
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
            if series.error:
                axes.errorbar(series.x, series.y, yerr=series.error, capsize=2, elinewidth=0.9, **look)
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
    """Rows of cells as comma-separated values."""
    text = io.StringIO()
    csv.writer(text, lineterminator="\n").writerows([[shortest(cell) for cell in row] for row in rows])
    return text.getvalue()


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


TEXTS, EXPRESSIONS = ("label", "column"), ("low", "high", "look")  # among the keys of figures
NO_LIMITS = {"low": None, "high": None, "logarithmic": False}


class Page(string.Formatter):
    """What tools/papers/NAME.toml says, over the names of results and of functions."""
    def __init__(self, name, functions, options):
        self.name = name
        self.told = tomllib.loads(pathlib.Path(__file__).with_name(f"{name}.toml").read_text(encoding="utf-8"))
        self.names = {"math": math, "span": span, "told": self.told, "table": self.table, "text": self.text,
                      "lines": self.lines, **functions, **options}

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
        return self.vformat(text, (), {**self.names, **dict(names)})

    def get_field(self, field_name, args, kwargs):
        """Of the formatter: places hold expressions."""
        return self.value(field_name, kwargs), None

    def value(self, expression, names):
        """Of the text of an expression; what is no text stands for itself."""
        if not isinstance(expression, str):
            return expression
        return eval(expression, {**self.names, **names})  # pylint: disable=eval-used

    def filled(self, told, names):
        """An entry with its texts and expressions filled in."""
        return {key: self.fill(told[key], names) if key in TEXTS else
                self.value(told[key], names) if key in EXPRESSIONS else told[key] for key in told}

    def leaves(self, told, names):
        """(entry, names inside it) of an entry, for each item of `each` and all its `parts`."""
        keys, expression = told.get("each", ("one", [names.get("one")]))
        for item in self.value(expression, names):
            inside = {**names, **(dict(zip(keys.split(", "), item)) if ", " in keys else {keys: item})}
            for part in told.get("parts", ()):
                yield from self.leaves(part, inside)
            if "parts" not in told:
                yield told, inside

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

    def series(self, told, names):
        found, items = self.filled(told, names), [*self.items(told, names)] if "of" in told else None
        for key in {"x", "y", "error"} & told.keys():
            found[key] = list(self.value(told[key], names)) if items is None else [
                self.value(told[key], item) for item in items]
        found.update(found.get("look", {}))
        return Series(**{key: found[key] for key in found if key in Series.__annotations__})

    def figures(self, chosen=None, /, **names):
        """{name: Plot} of all figures, or of the entries that are chosen."""
        found = {}
        for key in self.told["figures"] if chosen is None else chosen:
            for told, inside in self.leaves(self.told["figures"][key], names):
                lines = told.get("lines", ())
                lines = self.value(lines, inside) if isinstance(lines, str) else [
                    (self.value(x, inside), self.fill(label, inside), colour) for x, label, colour in lines]
                axes = (Row({**NO_LIMITS, **self.filled(told[axis], inside)}) for axis in "xy")
                series = [self.series(*leaf) for leaf in self.leaves({"parts": told["series"]}, inside)]
                found[self.fill(told.get("name", key), inside)] = Plot(
                    self.fill(told["title"], inside), *axes, [one for one in series if one.x], lines)
        return found
