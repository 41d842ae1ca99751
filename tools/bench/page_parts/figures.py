# SPDX-License-Identifier: GPL-3.0-or-later
"""Figures of pages: error against time, times against size, bars. Each is written as PNG and SVG."""
import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402

COLOURS = ("#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9", "#000000")
MARKERS = "os^Dvp*"
plt.rcParams.update({"font.size": 9, "axes.spines.top": False, "axes.spines.right": False, "svg.hashsalt": "equidem", "svg.fonttype": "none", "legend.frameon": False})


def save(figure, path):
    for extension in ("png", "svg"):
        figure.savefig(path.with_suffix(f".{extension}"), dpi=130, metadata={"Date": None} if extension == "svg" else {})
    plt.close(figure)


def spread_out(places, gap):
    """Heights at least `gap` apart, near the given ones, in the same order."""
    order = sorted(range(len(places)), key=places.__getitem__)
    found = list(places)
    for _ in range(200):
        moved = False
        for low, high in zip(order, order[1:]):
            short = gap - (found[high] - found[low])
            if short > 1e-6:
                found[low], found[high], moved = found[low] - short / 2, found[high] + short / 2, True
        if not moved:
            break
    return found


def curves(path, series, xlabel, ylabel, floor=0.0, above=False):
    """Logarithmic curves with their names at their lower ends, or slanted above their upper ones. series: name -> points (x, y); values below
    the floor are drawn on it."""
    figure, axes = plt.subplots(figsize=(4.8, 3.4), layout="constrained")
    axes.set(xscale="log", yscale="log", xlabel=xlabel, ylabel=ylabel)
    axes.grid(True, which="major", color="#dddddd", linewidth=0.6)
    ends = []
    for k, (name, points) in enumerate(series.items()):
        points = [(x, max(y, floor)) for x, y in sorted(points)]
        colour = COLOURS[k % len(COLOURS)]
        axes.plot(*zip(*points), color=colour, marker=MARKERS[k % len(MARKERS)], markersize=4, linewidth=1.2)
        ends.append((name, colour, max(points, key=lambda point: point[1]) if above else min(reversed(points), key=lambda point: point[1])))
    axes.margins(x=0.08, y=0.08)
    if above:
        low, high = axes.get_ylim()
        axes.set_ylim(low, high * (high / low) ** 0.3)
        for name, colour, end in ends:
            axes.annotate(name, end, xytext=(3, 5), textcoords="offset points", color=colour, rotation=40, va="bottom")
        save(figure, path)
        return
    low, high = axes.get_xlim()
    room = 0.075 * max(len(name) for name in series)  # inches of the widest name
    axes.set_xlim(low, high * (high / low) ** (room / (4.0 - room)))
    figure.canvas.draw()
    shown = axes.transData.transform([end for _, _, end in ends])
    for (name, colour, end), place, height in zip(ends, shown, spread_out([y for _, y in shown], 13.0)):
        axes.annotate(name, end, xytext=(7, (height - place[1]) * 72 / figure.dpi), textcoords="offset points", color=colour, va="center",
                      bbox={"facecolor": "white", "edgecolor": "none", "alpha": 0.8, "pad": 0.5})
    save(figure, path)


def bars(path, groups, xlabel, by_name=False):
    """Horizontal bars below the names of their groups: group -> list of (name, value); a colour for each group, or for each name."""
    count = sum(len(rows) + 1 for rows in groups.values())
    figure, axes = plt.subplots(figsize=(4.8, 0.35 + 0.2 * count), layout="constrained")
    names, places, place, named = [], [], 0, {}
    largest = max(value for rows in groups.values() for _, value in rows)
    for k, (group, rows) in enumerate(groups.items()):
        axes.text(0, place, group, fontweight="bold", va="center", fontsize=8)
        for name, value in rows:
            place += 1
            seen = named.setdefault(name, len(named)) if by_name else k
            axes.barh(place, value, height=0.75, color=COLOURS[seen % len(COLOURS)])
            axes.text(value + 0.01 * largest, place, f"{value:.3g}", va="center", fontsize=7)
            names.append(name)
            places.append(place)
        place += 1
    axes.set_yticks(places, names, fontsize=8)
    axes.tick_params(axis="y", length=0)
    axes.set(ylim=(place - 0.4, -0.7), xlim=(0, 1.12 * largest), xlabel=xlabel)
    save(figure, path)


def dots(path, values, xlabel):
    """A dot for each (name, value) beside the line at 1."""
    figure, axes = plt.subplots(figsize=(4.8, 0.5 + 0.24 * len(values)), layout="constrained")
    axes.axvline(1, color="black", linewidth=0.8)
    axes.plot([value for _, value in values], range(len(values)), "o", color=COLOURS[0], markersize=5)
    axes.set_yticks(range(len(values)), [name for name, _ in values], fontsize=8)
    axes.grid(True, axis="x", color="#dddddd", linewidth=0.6)
    axes.tick_params(axis="y", length=0)
    axes.set(ylim=(len(values) - 0.4, -0.6), xlabel=xlabel)
    save(figure, path)


def bound_and_error(path, groups, xlabel, ylabel):
    """Points (x, y) of groups beside the line on which both are equal."""
    figure, axes = plt.subplots(figsize=(4.8, 3.8), layout="constrained")
    axes.set(xscale="log", yscale="log", xlabel=xlabel, ylabel=ylabel)
    axes.grid(True, which="major", color="#dddddd", linewidth=0.6)
    values = [value for points in groups.values() for point in points for value in point]
    ends = (min(values) / 3, max(values) * 3)
    axes.fill_between(ends, ends, [ends[1]] * 2, color="#f4dccf", linewidth=0)
    axes.plot(ends, ends, color="black", linewidth=0.8)
    axes.text(0.04, 0.92, "beyond the bound: wrong", transform=axes.transAxes, color=COLOURS[1])
    for k, (name, points) in enumerate(groups.items()):
        axes.plot(*zip(*points), MARKERS[k], color=COLOURS[k], markersize=4, markerfacecolor="none", label=name)
    axes.set(xlim=ends, ylim=ends)
    axes.legend(loc="lower right", fontsize=8)
    save(figure, path)
