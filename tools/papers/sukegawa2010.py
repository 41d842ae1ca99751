#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Sukegawa (2010), chapter 8: a box of 3000 discs, ellipses or bonded pairs filled and shaken; void ratios over seeds
beside the printed ones, surface, grains thrown, pictures; which shaking compacts best, and whether the box resonates.
Runs whose laws the program has no longer are those of data/papers/sukegawa2010/runs.csv; --stored takes all from there.
An interrupted computation is continued when the same command is given again.

Examples:
  tools/papers/sukegawa2010.py --quick --out figures    a small box: a minute
  tools/papers/sukegawa2010.py --stored --out figures   the stored runs: seconds
"""
import dataclasses
import json
import math

import numpy as np
from scipy.special import stdtrit

from common import Output, eq, main, mean_of, rows_of, samples_of, with_error
from shown import Row
from sukegawa2010_box import NUMBERS, PICTURES, Fill, run_box

STORED = Row(date="2026-11-23", commit="ca6078f8")
SHAPES = ("discs", "ellipses", "bonded_pairs", "rigid_pairs")
GRAVITY, PERIOD = NUMBERS["gravity"], NUMBERS["sloshing period"]
WHOLE, INNER = ("whole_void_ratio_before", "whole_void_ratio"), ("void_ratio_before", "void_ratio")


# ---- runs

def usual_cycles(frequency):
    return max(2, math.floor(frequency + 0.5))


class Run(Row):
    """A row of runs.csv: what was run, and its numbers; beside them what a run of this day has: `filling`, the motion
    while the box was filled, histories and pictures."""
    filling, falling, shaking, pictures = None, (), (), ()

    def __init__(self, row, numbers=(), **more):
        super().__init__({**row, **dict(numbers)})
        vars(self).update(more, title=f"{self.acceleration_gal:g} gal, {self.frequency_Hz:.3g} Hz")

    def number(self, key):
        """key: a name, that of a number of the filling, or two whose difference is wanted."""
        if isinstance(key, tuple):
            return self[key[0]] - self[key[1]]
        return self.filling[key.removeprefix("filling.")] if key.startswith("filling.") else self[key]


class Runs(list):
    def of_seeds(self, key, shape="discs", gal=400, frequency=10, variant="", cycles=None):
        """{seed: number} of the runs that differ in the seed alone, where it is finite."""
        wanted = (shape, variant, gal, frequency, cycles or usual_cycles(frequency))
        found = {run.seed: run.number(key) for run in self if wanted == (
            run.shape, run.variant, run.acceleration_gal, run.frequency_Hz, run.cycles)}
        return {seed: value for seed, value in sorted(found.items()) if math.isfinite(value)}

    def values(self, key, *chosen, **more):
        return list(self.of_seeds(key, *chosen, **more).values())

    def mapped(self, shape, frequencies=None):
        """Those of the table over amplitudes and frequencies (sections 8.6 to 9.2)."""
        return [run for run in self if (run.shape, run.variant, run.seed) == (shape, "", 1) and run.cycles <= 10 and
                run.acceleration_gal > 0 and (frequencies is None or run.frequency_Hz in frequencies)]

    def resonance(self):
        return sorted((run for run in self.mapped("discs") if run.acceleration_gal == 400),
                      key=lambda run: -run.frequency_Hz)


def plan(options, told, stored):
    """(row of runs.csv without its numbers, filling) of the runs that the program can do, the most important first."""
    keys = ("run", "shape", "variant", "seed", "acceleration_gal", "frequency_Hz", "cycles")
    return [(Row({key: row[key] for key in keys}),
             Fill(row["shape"], int(row["seed"]), **{**options.size, **told["variants"][row["variant"]]}))
            for row in (told["quick_runs"] if options.quick else stored) if row["variant"] in told["variants"]]


def kept_run(arguments):
    """A run, kept in a file where a path is given."""
    row, fill, path = arguments
    found = {"fill": dataclasses.asdict(fill), **run_box(fill, row.acceleration_gal, row.frequency_Hz, row.cycles)}
    if path:
        path.parent.mkdir(parents=True, exist_ok=True)
        part = path.with_suffix(".part")
        part.write_text(json.dumps(found), encoding="utf-8")
        part.rename(path)
    return found


def read_run(path, fill):
    found = json.loads(path.read_text(encoding="utf-8"))
    if found["fill"] != dataclasses.asdict(fill):
        raise eq.BadInput(f"'{path}' has another filling", "results of different settings must not be mixed",
                          "Choose another folder, or remove it")
    return found


def compute(options, planned):
    """The runs of the plan, those that are in --out already taken from there."""
    kept = options.out and options.out / "runs"
    wanted = [(row, fill, kept and kept / f"{row.run}.json") for row, fill in planned]
    runs = {row.run: read_run(path, fill) for row, fill, path in wanted if path and path.exists()}
    todo = [one for one in wanted if one[0].run not in runs]
    runs.update(zip([row.run for row, _, _ in todo], samples_of("reproducing Sukegawa 2010:", kept_run, todo, 1)))
    return [Run(row, **runs[row.run]) for row, _, _ in wanted]


# ---- words of tables

def words(name):
    return name.replace("_", " ")


def figures(value, digits):
    return f"{value:.{digits}f}" if math.isfinite(value) else "-"


def spread(values):
    """Mean and standard deviation."""
    mean = mean_of(values) if values else None
    return with_error(mean.mean, mean.standard_deviation) if values else "-"


def printed(shape, *times):
    """Printed void ratio, or the difference of two; empty where there is none."""
    numbers = [NUMBERS.get(f"{shape}, void ratio {when}") for when in times]
    return "" if None in numbers else f"{numbers[-1] - (numbers[0] if len(times) > 1 else 0):.3f}"


def half_width(values):
    """Of the interval of 95 %."""
    return stdtrit(len(values) - 1, 0.975) * mean_of(values).standard_error if len(values) > 1 else math.nan


def judge(differences):
    """A difference that a statement says is positive."""
    mean, half = mean_of(differences).mean, half_width(differences)
    return "holds" if mean - half > 0 else "does not hold" if mean + half < 0 else "not decided"


def fastest(radius):
    """Speed of a disc that falls under c_i read as (2.27)."""
    mass = math.pi * radius**2 * NUMBERS["density"]
    return mass * GRAVITY / (2 * math.sqrt(mass * Fill().springs()[0]))


# ---- sloshing

def sloshing_period(width, depth, mode=1, printed=1):
    """By linear theory: omega² = g k tanh(k h), k = n pi/l; printed = 2: (7.2) as printed, (pi g/l) tanh(2 pi h/l)."""
    k = mode * math.pi / width
    return 2 * math.pi / math.sqrt(GRAVITY * k * math.tanh(printed * k * depth))


def liquid_amplification(period, width, depth):
    """Of a liquid without viscosity that is shaken at that period: modes 1, 3, 5, ... are oscillators under a uniform
    acceleration; their shares of the static shift of the centre of mass are proportional to 1/n^4 (long waves)."""
    modes = np.arange(1, 20, 2)
    own = np.array([sloshing_period(width, depth, n) for n in modes])
    return abs((modes**-4.0 / (1 - (own / period)**2)).sum() / (modes**-4.0).sum())


def amplification_of(run, width):
    """Swing of the centre of mass over that of a liquid whose surface tilts by a/g at once, l² a/(12 h g)."""
    tilted = 0.01 * run.acceleration_gal / GRAVITY * width**2 / (12 * run.surface_height_before_m)
    return run.swing_m / tilted


def around_resonance(runs, width):
    """The runs below, at and above the printed period, with their amplifications, where there are such."""
    found = runs.resonance()
    nearest = min(range(len(found)), key=lambda k: abs(1 / found[k].frequency_Hz - PERIOD), default=0)
    near = found[nearest - 1:nearest + 2] if nearest else []
    there = len(near) == 3 and abs(1 / near[1].frequency_Hz - PERIOD) < 0.01
    return [Row(period=1 / run.frequency_Hz, amplitude=amplification_of(run, width)) for run in near if there]


# ---- verdicts

def interval(values):
    if len(values) == 1:
        return f"{values[0]:.3g}, one seed"
    return f"{mean_of(values).mean:.3g} ± {half_width(values):.1g}"


def sides(runs, told):
    """{seed: number} of both sides of a comparison."""
    found = []
    for shape, at, factor in zip(told["shapes"], told.get("at", [[400, 10]] * 2), told.get("change", [None] * 2)):
        numbers = runs.of_seeds(told["key"], shape, *at) if shape else dict.fromkeys((1.0, 2.0, 3.0), 0.0)
        if factor:
            mild = runs.of_seeds(told["key"], shape)
            numbers = {seed: factor * abs(numbers[seed] - mild[seed]) for seed in mild if seed in numbers}
        found.append(numbers)
    return found


def compared(runs, told):
    """Over the seeds that both sides have; nothing where there are none."""
    smaller, larger = sides(runs, told)
    seeds = [seed for seed in smaller if seed in larger]
    differences = [larger[seed] - smaller[seed] for seed in seeds]
    return seeds and Row(quantity=told["what"], difference=interval(differences), verdict=judge(differences),
                         smaller=mean_of(smaller[seed] for seed in seeds).mean,
                         larger=mean_of(larger[seed] for seed in seeds).mean)


def decided(runs, statements, stored):
    """Statements with their comparisons: one holds where all of these do, and does not where one of them does not."""
    for told in statements:
        rows = rows_of("sukegawa2010/filling") if stored and "stored" in told else [
            compared(runs, one) for one in told["compared"]]
        verdicts = [row and row.verdict for row in rows]
        if all(verdicts):
            yield {**told, "rows": rows, "verdict": next(
                one for one in ("does not hold", "not decided", "holds") if one in verdicts)}


def best_shakings(runs):
    """Section 9.2: for each shape the shaking after which the void ratio is smallest, and those that scatter does not
    tell from it; of the shakings that at least as many seeds have as half of all."""
    for shape in ("discs", "bonded_pairs"):
        found = [Row(title=run.title, values=runs.of_seeds("void_ratio", shape, run.acceleration_gal, run.frequency_Hz))
                 for run in runs.mapped(shape)]
        found = sorted((one for one in found if one["values"]), key=lambda one: len(one["values"]))
        seeds = len(found[len(found) // 2]["values"]) if len(found) > 1 else math.inf
        found = sorted((one for one in found if len(one["values"]) >= seeds),
                       key=lambda one: mean_of(one["values"].values()).mean)
        for one in found:
            one["more"] = [value - found[0]["values"][seed] for seed, value in one["values"].items()
                           if seed in found[0]["values"]]
        if found:
            yield {"shape": shape, "best": found[0], "count": len(found), "seeds": seeds, "rivals": [
                one for one in found[1:] if seeds > 1 and judge(one.more) != "holds"]}


# ---- plots

def void_ratio_points(runs, key, after, offset):
    """Each seed, beside the number of its shape: void ratios between the walls, away from them, or printed."""
    found = []
    for k, shape in enumerate(SHAPES):
        number = NUMBERS.get(f"{shape}, void ratio {'after' if after else 'before'}")
        values = runs.values(key[after], shape) if key else [number] if number else []
        found += [{"x": k + 1 + offset + (0.06 if after else -0.06), "e": value} for value in values]
    return found


def histories(runs, fill):
    """Figures of the motion of nine grains from their start: (name, title, labels, abscissae, ordinates, names)."""
    found = []
    for run in (run for shape in SHAPES for run in runs if run.run == f"{shape}_1_400gal_10Hz" and run.falling):
        names = dataclasses.replace(fill, shape=run.shape).followed()[1]
        for stage, title, history, box, unit, scale in (
                ("falling", "falling", run.falling, "", "m", 1),
                ("shaken", "400 gal, 10 Hz", run.shaking, " in the box", "mm", 1e3)):
            x, y, angle = (factor * (np.array(history[key]) - history[key][0])
                           for key, factor in (("x_m", scale), ("y_m", scale), ("angle_rad", 1)))
            time = np.repeat(history["time_s"], x.shape[1]).reshape(x.shape)
            for what, values, label in (("x", x, f"displacement along x{box}, {unit}"),
                                        ("y", y, f"displacement along y, {unit}"), ("angle", angle, "rotation, rad")):
                found.append((f"{run.shape}_{stage}_{what}", f"{words(run.shape)}, {title}", "time, s", label, time,
                              values, names))
        found.append((f"{run.shape}_paths", f"Paths, {words(run.shape)}, 400 gal, 10 Hz",
                      "displacement along x in the box, mm", "displacement along y, mm", x, y, names))
    return found


def compaction_curves(runs):
    """Discs shaken by 400 gal, 10 Hz for 20 s; with the printed limit of friction as stored."""
    rows = rows_of("sukegawa2010/compaction_over_time", "series")
    curves = {name: [(time, void_ratio) for series, time, void_ratio in map(dict.values, rows) if series == name]
              for name in dict.fromkeys(row.series for row in rows)}
    for run in runs:
        if run.run == "discs_1_400gal_10Hz_200cycles" and run.shaking:
            curves[next(iter(curves))] = [*zip(run.shaking["time_s"], run.shaking["whole_void_ratio"])]
    return curves


def draw_sheet(pictures, title):
    """A function of the path that draws bodies, coloured by the five layers of the start, side by side."""
    def draw(path):
        from matplotlib import pyplot
        columns = len(pictures) if len(pictures) < 5 else 3
        rows = -(-len(pictures) // columns)
        figure, axes = pyplot.subplots(rows, columns, squeeze=False, layout="constrained",
                                       figsize=(4.2 * columns, 3.6 * rows))
        figure.suptitle(title)
        for one in axes.flat:
            one.set_axis_off()
        for one, (label, (centres, angles, half_axes, layers)) in zip(axes.flat, pictures):
            eq.plot.bodies(centres, half_axes, one, angles=angles, values=layers)
            right, top = np.max(centres, axis=0) + np.max(half_axes)
            one.plot([0, 0, right, right], [top, 0, 0, top], "k", linewidth=1)
            one.set_title(label)
        figure.savefig(f"{path}.png", dpi=150, bbox_inches="tight", metadata={"Software": None})
        pyplot.close(figure)
    return draw


def sheets(runs):
    found = {}
    for shape in SHAPES:
        own = sorted((run for run in runs if run.shape == shape and run.seed == 1 and not run.variant and
                      run.cycles <= 10 and run.acceleration_gal in (400, 800, 1200) and
                      run.frequency_Hz in (10, 2, 1) and run.pictures),
                     key=lambda run: (-run.frequency_Hz, run.acceleration_gal))
        if own:
            found[f"{shape}_shakings"] = draw_sheet([(run.title, run.pictures[2]) for run in own],
                                                    f"Largest displacement of the centre of mass: {words(shape)}")
        if own and own[0].title == "400 gal, 10 Hz":
            found[f"{shape}_pictures"] = draw_sheet([*zip(PICTURES, own[0].pictures)],
                                                    f"{words(shape)}, {own[0].title}")
    return found


def reproduce(options, page):
    stored = rows_of("sukegawa2010/runs", "run", "shape", "variant")
    old, planned = [Run(row) for row in stored], plan(options, page.told, stored)
    new = {} if options.stored else {run.run: run for run in compute(options, planned)}
    fill = planned[0][1]
    missing = [] if options.quick else [run for run in old if run.run not in new]
    runs = Runs(new.values() if options.quick else [new.get(run.run, run) for run in old])
    page.names.update(
        runs=runs, fill=fill, width=fill.width, missing=missing, before=runs.values(WHOLE[0]),
        radius=0.5 * (NUMBERS["smallest radius"] + NUMBERS["largest radius"]),
        depth=runs.of_seeds("surface_height_before_m")[1.0])
    names = {"resonance": around_resonance(runs, fill.width), "best": [*best_shakings(runs)],
             "decided": [*decided(runs, page.told["statements"], options.stored)]}
    rows = [{**run, "source": "stored" if run in missing else "computed"} for run in runs]
    return Output(names, {"runs": rows}, {"runs": rows}, sheets(runs))


if __name__ == "__main__":
    main(reproduce, lambda parser: parser.add_argument(
        "--stored", action="store_true", help="tables and figures of the stored runs; nothing is computed"))
