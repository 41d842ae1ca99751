# SPDX-License-Identifier: GPL-3.0-or-later
"""What the scripts of papers share (provisional)."""
import argparse
import csv
import json
import math
import os
import pathlib
import sys
import time
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass

import numpy as np

ROOT = pathlib.Path(__file__).resolve().parents[2]
DATA = ROOT / "data" / "papers"


# ---- samples, lines and curves, of sukegawa2010, breakage and validation

MASK = (1 << 64) - 1


class Random:
    """xoshiro256++ seeded through splitmix64, as equidem/core/random.hpp."""

    def __init__(self, seed):
        self.state = []
        for _ in range(4):
            seed = seed + 0x9e3779b97f4a7c15 & MASK
            z = seed
            z = (z ^ z >> 30) * 0xbf58476d1ce4e5b9 & MASK
            z = (z ^ z >> 27) * 0x94d049bb133111eb & MASK
            self.state.append(z ^ z >> 31)

    def bits(self):
        s = self.state
        rotated = lambda x, k: (x << k | x >> 64 - k) & MASK
        result = rotated(s[0] + s[3] & MASK, 23) + s[0] & MASK
        t = s[1] << 17 & MASK
        s[2] ^= s[0]
        s[3] ^= s[1]
        s[1] ^= s[2]
        s[0] ^= s[3]
        s[2] ^= t
        s[3] = rotated(s[3], 45)
        return result

    def uniform(self, low=0.0, high=1.0):
        return low + (high - low) * ((self.bits() >> 11) * 2.0 ** -53)

    def below(self, count):
        return self.bits() * count >> 64


@dataclass
class Mean:
    """Mean of independent samples; nan: not determined. `half_width`: of the interval of 95 % (Student)."""
    samples: int
    mean: float = math.nan
    deviation: float = math.nan
    error: float = math.nan

    @property
    def half_width(self):
        from scipy.stats import t
        return math.nan if self.samples < 2 else float(t.ppf(0.975, self.samples - 1)) * self.error


def mean_of(samples):
    n = len(samples)
    if n == 0:
        return Mean(0)
    mean = sum(samples) / n
    if n < 2:
        return Mean(n, mean)
    deviation = math.sqrt(sum((one - mean) ** 2 for one in samples) / (n - 1))
    return Mean(n, mean, deviation, deviation / math.sqrt(n))


@dataclass
class Line:
    intercept: float
    slope: float
    intercept_error: float
    slope_error: float


def fit_line(x, y, errors):
    """Least squares, each y weighted by the inverse square of its standard error."""
    x, y, weights = np.asarray(x, float), np.asarray(y, float), 1 / np.asarray(errors, float) ** 2
    all_weights = weights.sum()
    x_mean, y_mean = (weights * x).sum() / all_weights, (weights * y).sum() / all_weights
    xx = (weights * (x - x_mean) ** 2).sum()
    slope = (weights * (x - x_mean) * (y - y_mean)).sum() / xx
    return Line(y_mean - slope * x_mean, slope, math.sqrt(1 / all_weights + x_mean ** 2 / xx), math.sqrt(1 / xx))


_pool = None


def _worker():
    import signal

    import equidem
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    equidem.set_threads(1)
    equidem.show_progress(False)


def samples_of(task, function, arguments):
    """function(argument) of all, in processes side by side, with progress; in order."""
    import multiprocessing

    global _pool
    if _pool is None:
        _pool = ProcessPoolExecutor(os.cpu_count(), multiprocessing.get_context("spawn"), _worker)
    progress, found = Progress(task), []
    for one in _pool.map(function, arguments, chunksize=max(1, len(arguments) // 50)):
        found.append(one)
        progress(len(found) / len(arguments))
    return found


def curve_of(formula, low, high):
    x = [low + (high - low) * k / 100 for k in range(101)]
    return x, [formula(one) for one in x]


def curve(label, x, y, colour="black", style="-"):
    return {"label": label, "x": x, "y": y, "colour": colour, "style": style, "marker": "", "filled": True, "errors": None}


def marks(label, x, y, colour="black", marker="o", filled=True, line=False):
    return {**curve(label, x, y, colour, "-" if line else ""), "marker": marker, "filled": filled}


def bars(label, x, y, errors, colour="black", marker="o", filled=True, line=False):
    return {**marks(label, x, y, colour, marker, filled, line), "errors": errors}


def published_rows(name):
    with open(DATA / name, newline="", encoding="utf-8") as file:
        return list(csv.DictReader(file))


def listed(words):
    return words[0] if len(words) == 1 else ", ".join(words[:-1]) + " and " + words[-1]


def counted(number, one, many):
    return f"{number} {one if number == 1 else many}"


class Progress:
    """A line of progress on stderr."""
    shown = True

    def __init__(self, task):
        self.task, self.last = task, 0.0

    def __call__(self, share):
        now = time.monotonic()
        if Progress.shown and (now - self.last > 0.2 or share >= 1) and sys.stderr.isatty():
            sys.stderr.write(f"\r{self.task}: {100 * share:.0f} %".ljust(79) + ("\n" if share >= 1 else ""))
            sys.stderr.flush()
            self.last = now


COLOURS = {"black": "#000000", "blue": "#0072b2", "vermilion": "#d55e00", "green": "#009e73", "orange": "#e69f00", "purple": "#cc79a7",
           "skyblue": "#56b4e9", "yellow": "#f0e442"}


def draw(path, title, series, x, y, log="", x_range=None, y_range=None, lines=()):
    import matplotlib
    matplotlib.use("Agg")
    import matplotlib.pyplot as plt

    figure, axes = plt.subplots(figsize=(8, 6))
    for one in series:
        colour = COLOURS[one["colour"]]
        axes.errorbar(one["x"], one["y"], yerr=one["errors"], fmt="none" if not (one["style"] or one["marker"]) else "",
                      linestyle=one["style"] or "none", marker=one["marker"], color=colour, label=one["label"] or None,
                      markerfacecolor=colour if one["filled"] else "white", capsize=2, markersize=5, linewidth=1.2)
    for place, label, *colour in lines:
        axes.axvline(place, color=COLOURS[colour[0] if colour else "black"], linestyle=":", label=label)
    if "x" in log:
        axes.set_xscale("log")
    if "y" in log:
        axes.set_yscale("log")
    if x_range:
        axes.set_xlim(*x_range)
    if y_range:
        axes.set_ylim(*y_range)
    axes.set(title=title, xlabel=x, ylabel=y)
    axes.grid(True, alpha=0.3)
    if any(one["label"] for one in series) or lines:
        axes.legend(fontsize="small")
    figure.tight_layout()
    figure.savefig(path, dpi=120)
    plt.close(figure)


def write_table(path, table):
    with open(path, "w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(table)
        writer.writerows(zip(*[[one.item() if hasattr(one, "item") else one for one in column] for column in table.values()]))


class Paper:
    pass
