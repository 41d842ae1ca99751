#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Sukegawa (2010), chapter 8: a box of 3000 discs, ellipses or bonded pairs filled and shaken; void ratios over seeds
beside the printed ones, surface, grains thrown, pictures; which shaking compacts best, and whether the box resonates.
Runs whose laws the program has no longer are those of data/papers/sukegawa2010/runs.csv; --stored takes all from there.
An interrupted computation is continued when the same command is given again."""
import dataclasses
import json
import math
import tomllib

import numpy as np
from scipy.special import stdtrit

from common import (DATA, Axis, Output, Plot, Series, Table, columns_of, eq, main, mean_of, points, rows_of, samples_of)
from sukegawa2010_box import NUMBERS, PICTURES, Fill, run_box

TEXTS = tomllib.loads((DATA / "sukegawa2010" / "texts.toml").read_text(encoding="utf-8"))
STORED = {"date": "2026-11-23", "commit": "ca6078f8"}
SHAPES = ("discs", "ellipses", "bonded_pairs", "rigid_pairs")
GRAVITY, PERIOD = NUMBERS["gravity"], NUMBERS["sloshing period"]
VARIANTS = {"": {}, "half_step": {"step_share": 0.25}, "soft": {"softness": 9.0}, "less_damping": {"damping": 0.1},
            "printed_step": {"step": NUMBERS["time step"]}, "bulk_springs": {"bulk": "springs"}, "bulk_density": {"bulk": "all"},
            "low_drop": {"row_share": 0.7}, "smooth": {"friction": 0.0}, "rough": {"friction": 0.5},
            "small": {"columns": 18, "rows": 34, "softness": 9.0},
            "mended_test": {"columns": 18, "rows": 34, "softness": 9.0, "ellipse_contact": "enlarged"},
            "strong_bonds": {"bond_step": NUMBERS["time step"] / 10}}
PRINTED_ROWS = (("forces in increments", "increments"), ("integrator (3.16)-(3.17)", "printed_integrator"),
                ("c_i = 1/s m_i", "mass_damping_1"), ("c_i = 10/s m_i", "mass_damping_10"), ("beta = 1.05", "beta_1.05"))


# ---- runs

class Run(dict):
    """A row of runs.csv: what was run, and its numbers. `filling`: the motion while the box was filled."""
    filling, falling, shaking, pictures = None, (), (), ()

    def __init__(self, row):
        text = ("run", "shape", "variant")
        super().__init__({key: value if key in text else float(value) for key, value in row.items()})

    @property
    def shown(self):
        """With pictures, and paths of nine grains."""
        return self["seed"] == 1 and not self["variant"] and self["cycles"] <= 10 and (
            self["frequency_Hz"], self["acceleration_gal"]) in SHOWN

    @property
    def mapped(self):
        """Part of the table over amplitudes and frequencies (sections 8.6 to 9.2)."""
        return (self["seed"] == 1 and not self["variant"] and self["shape"] in ("discs", "bonded_pairs") and
                self["acceleration_gal"] > 0 and self["cycles"] <= 10)


SHOWN = {(frequency, gal) for frequency in (10, 2, 1) for gal in (400, 800, 1200)}


def name_of(shape, variant, seed, gal, frequency, cycles):
    usual = max(2, math.floor(frequency + 0.5))
    return (f"{shape}{'_' if variant else ''}{variant}_{seed}_{gal:g}gal_{frequency:.3g}Hz" +
            (f"_{cycles}cycles" if cycles > usual else ""))


def plan(quick):
    """(row of runs.csv without numbers, filling) of the runs that the program can do, the most important first."""
    if quick:
        rows = [(shape, "", seed, 400.0, 10.0, 10) for shape, seed in
                (("discs", 1), ("bonded_pairs", 1), ("rigid_pairs", 1), ("ellipses", 1), ("discs", 2), ("discs", 3))]
        rows += [(shape, "", 1, 1200.0, 2.0, 2) for shape in ("discs", "bonded_pairs")]
        rows += [("discs", variant, 1, 400.0, 10.0, 10) for variant in ("bulk_springs", "bulk_density")]
    else:
        rows = [(row["shape"], row["variant"], int(row["seed"]), float(row["acceleration_gal"]), float(row["frequency_Hz"]),
                 int(row["cycles"])) for row in rows_of("sukegawa2010/runs") if row["variant"] in VARIANTS]
    small = {"columns": 8, "rows": 24, "softness": 25.0, "fall": 1.0} if quick else {}
    keys = ("shape", "variant", "seed", "acceleration_gal", "frequency_Hz", "cycles")
    return [({"run": name_of(*row), **dict(zip(keys, row))}, Fill(row[0], row[2], **{**small, **VARIANTS[row[1]]})) for row in rows]


def kept_run(arguments):
    """A run, kept in two files where a path is given."""
    *given, path = arguments
    names = ("numbers", "filling", "falling", "shaking", "pictures")
    found = {"fill": dataclasses.asdict(given[0]), **dict(zip(names, run_box(given)))}
    if path:
        path.parent.mkdir(parents=True, exist_ok=True)
        np.savez_compressed(path.with_suffix(".npz"), *(array for one in found["pictures"] for array in one))
        part = path.with_suffix(".part")
        part.write_text(json.dumps({**found, "pictures": []}, default=float), encoding="utf-8")
        part.rename(path)
    return found


def compute(options):
    """The runs of the plan, those that are in --out already taken from there."""
    kept, wanted, runs = options.out and options.out / "runs", plan(options.quick), {}
    for row, fill in wanted:
        path = kept and kept / f"{row['run']}.json"
        if path and path.exists():
            found = json.loads(path.read_text(encoding="utf-8"))
            if found["fill"] != dataclasses.asdict(fill):
                raise eq.BadInput(f"'{path}' has another filling", "results of different settings must not be mixed",
                                  "Choose another --out, or remove it")
            with np.load(path.with_suffix(".npz")) as file:
                arrays = list(file.values())
            runs[row["run"]] = {**found, "pictures": [arrays[k:k + 4] for k in range(0, len(arrays), 4)]}
    todo = [(row, fill) for row, fill in wanted if row["run"] not in runs]
    runs.update(zip([row["run"] for row, _ in todo], samples_of("reproducing Sukegawa 2010:", kept_run, [
        (fill, row["acceleration_gal"], row["frequency_Hz"], row["cycles"], kept and kept / f"{row['run']}.json")
        for row, fill in todo], 1)))
    done = []
    for row, _ in wanted:
        found = runs[row["run"]]
        run = Run({**row, **found["numbers"]})
        run.filling, run.falling, run.shaking, run.pictures = (found[key] for key in ("filling", "falling", "shaking", "pictures"))
        done.append(run)
    return done


def words(name):
    return name.replace("_", " ")


# ---- tables

def values_of(runs, key, shape="discs", gal=400, frequency=10, variant="", cycles=10):
    """Finite values over the runs that differ only in the seed. key: a name, or two whose difference is wanted."""
    numbers = [run[key] if isinstance(key, str) else run[key[0]] - run[key[1]] for run in runs
               if (run["shape"], run["variant"], run["acceleration_gal"], run["frequency_Hz"], run["cycles"]) ==
               (shape, variant, gal, frequency, cycles)]
    return [number for number in numbers if math.isfinite(number)]


def figures(value, digits):
    return f"{value:.{digits}f}" if math.isfinite(value) else "-"


def spread(values):
    if not values:
        return "-"
    mean = mean_of(values)
    return figures(mean.mean, 4) + (f" ± {mean.standard_deviation:.4f}" if len(values) > 1 else "")


WHOLE, INNER = ("whole_void_ratio_before", "whole_void_ratio"), ("void_ratio_before", "void_ratio")


def void_ratio_table(runs, before, after):
    table = Table(" & before & printed & after & printed & change & printed & seeds")
    for shape in SHAPES:
        first, last = (NUMBERS.get(f"{shape}, void ratio {when}") for when in ("before", "after"))
        beside = [f"{number:.3f}" if first else "" for number in (first or 0, last or 0, (last or 0) - (first or 0))]
        cells = [values_of(runs, key, shape) for key in (before, after, (after, before))]
        table.add(" & ".join([words(shape), *(f"{spread(cell)} & {printed}" for cell, printed in zip(cells, beside)), str(len(cells[2]))]))
    return table.text()


def variants_text(runs):
    table = Table(" & before & after & change & inner: before & change & seeds")
    for row in rows_of("sukegawa2010/variants"):
        cells = [values_of(runs, key, row["shape"], float(row["gal"]), variant=row["variant"], cycles=float(row["cycles"]))
                 for key in (*WHOLE, WHOLE[::-1], INNER[0], INNER[::-1])]
        if cells[3]:
            table.add(" & ".join([row["name"], *map(spread, cells), str(len(cells[3]))]))
    return TEXTS["variants"].format(table=table.text())


def half_width(values):
    return stdtrit(len(values) - 1, 0.975) * mean_of(values).standard_error if len(values) > 1 else math.nan


def printed_level(runs):
    """Printed details, one at a time, beside the void ratio of discs under (2.16) and the printed one."""
    printed, capped, rows = NUMBERS["discs, void ratio before"], values_of(runs, WHOLE[0], variant="printed_cap"), ""
    for name, variant in PRINTED_ROWS:
        found = values_of(runs, WHOLE[0], variant=variant)
        if not found or not capped:
            continue
        one, mean = len(found) == 1, mean_of(found).mean
        # With one seed: judged by the scatter of the runs with (2.16) alone.
        half = half_width(capped) * math.sqrt(len(capped)) if one else half_width(found)
        verdict = ("not decided" if not math.isfinite(half) else "does not explain it, too loose" if mean - half > printed else
                   "does not explain it, too dense" if mean + half < printed else "agrees with it within the scatter")
        rows += (f"  {name:<26} {spread(found)} against {spread(capped)} without, printed {printed:g}: {verdict}"
                 f"{' (one seed)' if one else ''}\n")
    radius = 0.5 * (NUMBERS["smallest radius"] + NUMBERS["largest radius"])
    mass = math.pi * radius**2 * NUMBERS["density"]
    fastest = mass * GRAVITY / (2 * math.sqrt(mass * Fill().springs()[0]))
    height = NUMBERS["box height"]
    return TEXTS["printed"].format(rows=rows, radius=100 * radius, fastest=fastest, time=height / fastest, height=height,
                                       steps=height / fastest / NUMBERS["time step"]) if rows else ""


def shakings_text(runs):
    table = Table(" & e before & e after & change & surface, mm & centre, mm & rough, mm & after, mm & slope & thrown")
    for shape in ("discs", "bonded_pairs"):
        own = [run for run in runs if run.mapped and run["shape"] == shape and run["frequency_Hz"] in (1, 2, 5, 10)]
        for run in sorted(own, key=lambda run: (-run["frequency_Hz"], run["acceleration_gal"])):
            table.add(" & ".join([
                f"{words(shape)}, {run['acceleration_gal']:g} gal, {run['frequency_Hz']:g} Hz",
                *(figures(x, 4) for x in (run[INNER[0]], run[INNER[1]], run[INNER[1]] - run[INNER[0]])),
                figures(1e3 * (run["surface_height_before_m"] - run["surface_height_m"]), 1),
                figures(1e3 * (run["centre_height_before_m"] - run["centre_height_m"]), 2),
                figures(1e3 * run["roughness_before_m"], 1), figures(1e3 * run["roughness_m"], 1), figures(run["largest_slope"], 2),
                figures(run["thrown"], 0)]))
    return TEXTS["shakings"].format(table=table.text())


# ---- sloshing

def sloshing_period(width, depth, mode=1):
    """By linear theory: omega² = g k tanh(k h), k = n pi/l."""
    k = mode * math.pi / width
    return 2 * math.pi / math.sqrt(GRAVITY * k * math.tanh(k * depth))


def printed_formula_period(width, depth):
    """(7.2) as printed: omega² = (pi g/l) tanh(2 pi h/l)."""
    k = math.pi / width
    return 2 * math.pi / math.sqrt(GRAVITY * k * math.tanh(2 * k * depth))


def liquid_amplification(period, width, depth):
    """Of a liquid without viscosity that is shaken at that period: modes 1, 3, 5, ... are oscillators under a uniform
    acceleration; their shares of the static shift of the centre of mass are proportional to 1/n^4 (long waves)."""
    modes = np.arange(1, 20, 2)
    own = np.array([sloshing_period(width, depth, n) for n in modes])
    return abs((modes**-4.0 / (1 - (own / period)**2)).sum() / (modes**-4.0).sum())


def amplification_of(run, width):
    """Swing of the centre of mass over that of a liquid whose surface tilts by a/g at once, l² a/(12 h g)."""
    tilted = 0.01 * run["acceleration_gal"] / GRAVITY * width**2 / (12 * run["surface_height_before_m"])
    return run["swing_m"] / tilted


def resonance_runs(runs):
    found = [run for run in runs if run.mapped and run["shape"] == "discs" and run["acceleration_gal"] == 400]
    return sorted(found, key=lambda run: -run["frequency_Hz"])


def periods_text(runs, width):
    discs = [run for run in runs if run["shape"] == "discs" and not run["variant"]]
    depth, table = discs[0]["surface_height_before_m"], Table(" & linear theory & (7.2) as printed")
    for name, h in (("height of the start, 2.25 m", NUMBERS["box height"]), (f"depth of the heap, {depth:.3f} m", depth)):
        table.add(f"{name} & {sloshing_period(width, h):.4f} s & {printed_formula_period(width, h):.4f} s")
    sweep = Table("period & swing, mm & amplification & liquid without loss & slope & thrown")
    for run in resonance_runs(runs):
        period = 1 / run["frequency_Hz"]
        sweep.add(f"discs, 400 gal, {period:.3g} s & {figures(1e3 * run['swing_m'], 2)} & {figures(amplification_of(run, width), 3)} & "
                  f"{liquid_amplification(period, width, depth):.3f} & {run['largest_slope']:.3f} & {run['thrown']:.0f}")
    return TEXTS["periods"].format(table=table.text(), depth=depth, sweep=sweep.text())


# ---- verdicts

def of_seeds(runs, key, shape, gal=400, frequency=10):
    """{seed: number} of the usual runs."""
    chosen = {}
    for run in runs:
        if (run["shape"], run["variant"], run["acceleration_gal"], run["frequency_Hz"]) == (shape, "", gal, frequency) and \
                run["cycles"] <= max(2, math.floor(frequency + 0.5)):
            value = run[key] if isinstance(key, str) else key(run)
            if math.isfinite(value):
                chosen[run["seed"]] = value
    return dict(sorted(chosen.items()))


def judge(differences):
    """A difference that a statement says is positive."""
    half = half_width(differences)
    if math.isnan(half):
        return "not decided"
    mean = mean_of(differences).mean
    return "holds" if mean - half > 0 else "does not hold" if mean + half < 0 else "not decided"


def interval(values):
    if len(values) == 1:
        return f"{values[0]:.3g}, one seed"
    return f"{mean_of(values).mean:.3g} ± {half_width(values):.1g}"


def line(text, smaller, larger, difference, verdict):
    return f"      {text:<66} {smaller:>8.3g} < {larger:>8.3g}, by {difference:<20} {verdict}\n"


def statement(section, text, comparisons, lines=()):
    """Holds where all its comparisons (what, smaller, larger) do, and does not where one of them does not."""
    rows, verdicts = "", [one["verdict"] for one in lines]
    for one in lines:
        rows += line(one["quantity"], float(one["smaller"]), float(one["larger"]), one["difference"], one["verdict"])
    for what, smaller, larger in comparisons:
        seeds = [seed for seed in smaller if seed in larger]
        if not seeds:
            return ""
        differences = [larger[seed] - smaller[seed] for seed in seeds]
        verdicts.append(judge(differences))
        rows += line(what, *(mean_of([side[seed] for seed in seeds]).mean for side in (smaller, larger)), interval(differences),
                     verdicts[-1])
    verdict = next(one for one in ("does not hold", "not decided", "holds") if one in verdicts)
    return f"  {section} {text}: {verdict.upper()}\n{rows}"


def statements(runs, stored):
    def rising(what, key, first, last, of=of_seeds):
        return f"{what}, {words(first)} < {words(last)}", of(runs, key, first), of(runs, key, last)

    def in_order(what, key, of=of_seeds):
        return [rising(what, key, "discs", "ellipses", of), rising(what, key, "ellipses", "bonded_pairs", of)]

    def filling(_, key, shape):
        return of_seeds(runs, lambda run: run.filling[key], shape)

    zero = dict.fromkeys((1.0, 2.0, 3.0), 0.0)
    lines = rows_of("sukegawa2010/filling") if stored else ()
    text = statement("8.5.2", "while the box is filled, discs, ellipses, bonded pairs move ever more",
                     [] if stored else in_order("path along x, m", "path_along_x_m", filling) +
                     in_order("rotation to and fro, rad", "turned_rad", filling), lines)
    text += statement("8.5.2", "while it is shaken they do, too",
                      in_order("path, m", "path_m") + in_order("rotation to and fro, rad", "turned_rad"))
    text += statement("8.5.2", "ellipses and pairs move violently just after the shaking begins",
                      [rising("path in the first 0.1 s, m", "first_path_m", "discs", other) for other in ("ellipses", "bonded_pairs")])
    text += statement("8.5.3", "discs on the left and on the right move towards the middle and sink",
                      [(f"displacement {way}, m", zero, of_seeds(runs, key, "discs"))
                       for way, key in (("inward", "inward_m"), ("downward", "sunk_m"))])
    text += statement("8.5.3", "ellipses move far along x, those of one height the same way",
                      [rising("displacement along x, m", "displaced_x_m", "discs", "ellipses"),
                       rising("common to a layer", "layered", "discs", "ellipses")])
    text += statement("8.5.3", "bonded pairs move far along x, in various directions",
                      [rising("displacement along x, m", "displaced_x_m", "discs", "bonded_pairs"),
                       rising("common to a layer", "layered", "bonded_pairs", "ellipses")])

    def change(key, shape, gal, frequency, factor):
        mild, strong = of_seeds(runs, key, shape), of_seeds(runs, key, shape, gal, frequency)
        return {seed: factor * abs(strong[seed] - mild[seed]) for seed in mild if seed in strong}
    for what, gal, frequency in (("at 10 Hz a larger amplitude changes little", 1200, 10),
                                 ("at 400 gal a lower frequency changes little", 400, 1)):
        text += statement("8.9.1", what, [
            (f"{words(shape)}, change of the {name}, less than a fifth of that by both", change(key, shape, gal, frequency, 1),
             change(key, shape, 1200, 1, 0.2)) for shape in ("discs", "bonded_pairs")
            for name, key in (("slope", "largest_slope"), ("void ratio", "void_ratio"))])
    text += statement("8.9.1", "large and slow shaking tilts the surface, most at 1200 gal, 1 Hz", [
        (f"{words(shape)}, slope at 1200 gal, {a} < {b} Hz", of_seeds(runs, "largest_slope", shape, 1200, a),
         of_seeds(runs, "largest_slope", shape, 1200, b)) for shape in ("discs", "bonded_pairs") for a, b in ((10, 2), (2, 1))])
    for what, name, key, first, last in (
            ("the surface of bonded pairs is rougher", "roughness", "roughness_m", "discs", "bonded_pairs"),
            ("fewer of the bonded pairs are thrown", "thrown", "thrown", "bonded_pairs", "discs")):
        order = "m, discs < pairs" if key == "roughness_m" else "pairs < discs"
        text += statement("8.9.2", what, [
            (f"{name} at {gal} gal, {frequency} Hz, {order}", of_seeds(runs, key, first, gal, frequency),
             of_seeds(runs, key, last, gal, frequency)) for gal, frequency in ((1200, 2), (800, 1), (1200, 1))])
    return text


def best_shakings(runs):
    """Section 9.2: the shaking after which the void ratio is smallest, and those that the scatter does not tell from it."""
    text = ""
    for shape in ("discs", "bonded_pairs"):
        found = [(f"{run['acceleration_gal']:g} gal, {run['frequency_Hz']:.3g} Hz",
                  of_seeds(runs, "void_ratio", shape, run["acceleration_gal"], run["frequency_Hz"]))
                 for run in runs if run.mapped and run["shape"] == shape]
        found = sorted((one for one in found if one[1]), key=lambda one: len(one[1]))
        if len(found) < 2:
            continue
        seeds = len(found[len(found) // 2][1])  # that half of the shakings have
        found = sorted((one for one in found if len(one[1]) >= seeds), key=lambda one: mean_of(one[1].values()).mean)
        name, best = found[0]
        text += f"  {words(shape)}: densest after {name}, e = {interval(list(best.values()))}, of {len(found)} shakings of {seeds} filling"
        if seeds == 1:
            text += ": no scatter is known\n"
            continue
        rivals = ""
        for other, values in found[1:]:
            more = [values[seed] - best[seed] for seed in best if seed in values]
            if judge(more) != "holds":
                rivals += f"    {other:<16} by {interval(more)}\n"
        text += "s; " + ("NOT DECIDED within the scatter against\n" + rivals if rivals else "no other is as good within the scatter\n")
    return "  9.2 the shaking that compacts best (void ratio away from walls)\n" + text if text else ""


def resonance_text(runs, width):
    found = resonance_runs(runs)
    nearest = min(range(len(found)), key=lambda k: abs(1 / found[k]["frequency_Hz"] - PERIOD), default=0)
    if not 0 < nearest < len(found) - 1 or abs(1 / found[nearest]["frequency_Hz"] - PERIOD) > 0.01:
        return ""
    left, here, right = found[nearest - 1:nearest + 2]
    amplitude = [amplification_of(run, width) for run in (left, here, right)]
    peak = amplitude[1] > max(amplitude[0], amplitude[2])
    return (f"  9.2 discs resonate at the period of {PERIOD:g} s: {'HOLDS' if peak else 'DOES NOT HOLD'} (one filling): amplification "
            f"{amplitude[1]:.3f} there, {amplitude[0]:.3f} at {1 / left['frequency_Hz']:.3g} s, {amplitude[2]:.3f} at "
            f"{1 / right['frequency_Hz']:.3g} s\n")


# ---- the report

def csv_table(head, name):
    table = Table(head)
    for row in rows_of(f"sukegawa2010/{name}"):
        table.add(" & ".join(row.values()))
    return table.text()


def report(runs, options, fill, missing):
    text = "Sukegawa (2010), chapter 8: grains in a box, filled and shaken\n\n"
    text += TEXTS["head"].format(places=fill.columns * fill.rows, rows=fill.rows, columns=fill.columns, cell=3, width=fill.width,
                                     integrator="corrected_verlet" if options.stored else "velocity_verlet")
    text += TEXTS["quick"].format(softness=fill.softness) if options.quick else TEXTS["start"]
    text += (TEXTS["stored"].format(**STORED) if missing else "") + "\n"
    text += TEXTS["void_ratios"].format(whole=void_ratio_table(runs, *WHOLE), inner=void_ratio_table(runs, *INNER))
    before = values_of(runs, WHOLE[0])
    solid = 1 / (1 + mean_of(before).mean)
    text += TEXTS["margin"].format(porosities="".join(f" beta {beta:4.2f}: {1 - solid / beta**2:.4f};" for beta in (1, 1.05, 1.1))) + "\n"
    text += "" if options.quick else variants_text(runs) + printed_level(runs)
    text += shakings_text(runs)
    text += TEXTS["verdicts"].format(statements=statements(runs, options.stored), best=best_shakings(runs),
                                         resonance=resonance_text(runs, fill.width))
    text += periods_text(runs, fill.width)
    table = Table(" & distance & rotation, rad")
    for run in runs:
        if run["shape"] == "bonded_pairs" and math.isfinite(run["bond_creep"]):
            table.add(f"{words(run['run'])} & {run['bond_creep']:.3g} & {run['bond_roll_rad']:.3g}")
    text += TEXTS["bonds"].format(table=table.text())
    table = Table(" & step, s & steps & largest overlap & energy error & contacts per body & seconds")
    for run in runs:
        if run["seed"] == 1 and run["acceleration_gal"] == 400 and run["frequency_Hz"] == 10 and \
                (not run["variant"] and run["cycles"] <= 10 or run["variant"] == "printed_step"):
            table.add(f"{words(run['shape'])} & {run['time_step_s']:.3g} & {run['steps']:.0f} & {run['largest_overlap']:.2g} of r_min & "
                      f"{run['energy_error']:+.2g} & {run['coordination']:.2f} & {run['seconds']:.0f}")
    text += TEXTS["numerics"].format(table=table.text())
    text += TEXTS["packings"].format(table=csv_table(
        " & discs & solid fraction & contacts & without rattlers & rattlers & overlap & moved & seconds", "packings"))
    return text + TEXTS["ellipses"].format(table=csv_table(
        " & at rest & time, s & void ratio & largest overlap & pairs above 0.01 & seconds", "fallen_ellipses"))


# ---- plots

def void_ratio_plot(runs):
    """Each seed before (open) and after (filled): between the walls, away from them, and as printed."""
    series = []
    for label, colour, marker, offset, keys in (("between the walls, each seed", "blue", "circle", -0.24, WHOLE),
                                                ("printed", "vermilion", "square", 0, None),
                                                ("away from walls and surface", "green", "triangle", 0.24, INNER)):
        for after, when in enumerate(("before", "after")):
            x, y = [], []
            for k, shape in enumerate(SHAPES):
                printed = NUMBERS.get(f"{shape}, void ratio {when}")
                found = values_of(runs, keys[after], shape) if keys else [printed] if printed else []
                x += [k + 1 + offset + (0.06 if after else -0.06)] * len(found)
                y += found
            series.append(points(f"{label}, {when}", x, y, colour, marker, filled=bool(after)))
    return Plot("Void ratio before (open) and after (filled) 400 gal, 10 Hz",
                Axis("1 discs   2 ellipses   3 bonded pairs   4 rigid pairs", 0.5, 4.5), Axis("void ratio"), series)


def over_frequency(runs, shape, title, label, key):
    series = []
    for gal, colour, marker in ((400, "blue", "circle"), (800, "vermilion", "square"), (1200, "green", "triangle")):
        own = sorted((run for run in runs if run.mapped and run["shape"] == shape and run["acceleration_gal"] == gal and
                      run["frequency_Hz"] in (1, 2, 5, 10)), key=lambda run: run["frequency_Hz"])
        if own:
            series.append(points(f"{gal} gal", [run["frequency_Hz"] for run in own], [run[key] for run in own], colour, marker,
                                 joined=True))
    return Plot(f"{words(shape)}: {title}", Axis("frequency, Hz", 0.8, 12, True), Axis(label), series)


def resonance_plot(runs, width):
    found = resonance_runs(runs)
    depth = found[-1]["surface_height_before_m"]
    periods = [0.01 * k for k in range(4, 261)]
    liquid = Series("liquid, linear theory", periods, [min(50.0, liquid_amplification(x, width, depth)) for x in periods],
                    "dashed_line")
    discs = points("discs", [1 / run["frequency_Hz"] for run in found], [amplification_of(run, width) for run in found], "blue")
    return Plot("Discs shaken by 400 gal: swing of their centre of mass over that of a liquid tilted by a/g",
                Axis("period of shaking, s", 0, 2.6), Axis("amplification", 0, 4), [liquid, discs],
                [(sloshing_period(width, depth), f"T1, depth {depth:.2f} m", "black"), (PERIOD, "printed 1.85 s", "vermilion")])


COLOURS = ("blue", "vermilion", "green", "black", "orange", "purple", "sky_blue", "yellow", "black")


def nine_grains(rows, labels, x, y, scale):
    """Curves of the nine grains, less their first values. x, y: "time", "x", "y" or "angle"; scale of positions."""
    def less_first(name, k):
        if name == "time":
            return [row["time_s"] for row in rows]
        values = np.array([row[f"{name}{k}_{'rad' if name == 'angle' else 'm'}"] for row in rows])
        return ((values - values[0]) * (1 if name == "angle" else scale)).tolist()
    return [Series(label, less_first(x, k), less_first(y, k), "line" if k < 8 else "dashed_line", COLOURS[k])
            for k, label in enumerate(labels)]


def history_plots(run, labels):
    plots, shape = {}, run["shape"]
    for stage, rows, unit, scale in (("falling", run.falling, "m", 1), ("shaken", run.shaking, "mm", 1e3)):
        title = f"{words(shape)}, {'400 gal, 10 Hz' if stage == 'shaken' else 'falling'}"
        box = " in the box" if stage == "shaken" else ""
        for what, label in (("x", f"displacement along x{box}, {unit}"), ("y", f"displacement along y, {unit}"), ("angle", "rotation, rad")):
            plots[f"{shape}_{stage}_{what}"] = Plot(title, Axis("time, s"), Axis(label), nine_grains(rows, labels, "time", what, scale))
    plots[f"{shape}_paths"] = Plot(f"Paths, {words(shape)}, 400 gal, 10 Hz", Axis("displacement along x in the box, mm"),
                                   Axis("displacement along y, mm"), nine_grains(run.shaking, labels, "x", "y", 1e3))
    return plots


def compaction_plot(runs):
    """Discs shaken by 400 gal, 10 Hz for 20 s; with the printed limit of friction as stored."""
    rows = rows_of("sukegawa2010/compaction_over_time")
    names = [row["series"] for row in rows]
    new = next((run for run in runs if run["run"] == "discs_1_400gal_10Hz_200cycles" and run.shaking), None)
    series = []
    for name, colour, style in zip(dict.fromkeys(names), ("blue", "vermilion", "black", "black"), ("line",) * 2 + ("dashed_line",) * 2):
        own = [row for row in rows if row["series"] == name]
        x, y = ([float(row[key]) for row in own] for key in list(rows[0])[1:3])
        if new and not series:
            x, y = ([row[key] for row in new.shaking] for key in ("time_s", "whole_void_ratio"))
        series.append(Series(words(name), x, y, style, colour))
    return Plot("Discs shaken by 400 gal, 10 Hz for 20 s", Axis("time of shaking, s"), Axis("void ratio between the walls"), series)


def draw_sheet(pictures, title):
    """A function of the path that draws bodies, coloured by the five layers of the start, side by side."""
    def draw(path):
        from matplotlib import pyplot
        from matplotlib.collections import EllipseCollection
        columns = len(pictures) if len(pictures) < 5 else 3
        figure, axes = pyplot.subplots(-(-len(pictures) // columns), columns, squeeze=False, layout="constrained",
                                       figsize=(4.2 * columns, 3.6 * -(-len(pictures) // columns)))
        figure.suptitle(title)
        for one in axes.flat:
            one.set_axis_off()
        for one, (label, (centres, angles, half_axes, layers)) in zip(axes.flat, pictures):
            one.add_collection(EllipseCollection(2 * half_axes[:, 0], 2 * half_axes[:, 1], np.degrees(angles), units="xy",
                                                 offsets=centres, transOffset=one.transData, array=layers, cmap="viridis",
                                                 edgecolors="black", linewidths=0.2))
            low, high = centres.min(axis=0) - half_axes.max(), centres.max(axis=0) + half_axes.max()
            one.plot([0, 0], [0, high[1]], "k", [0, high[0]], [0, 0], "k", [high[0]] * 2, [0, high[1]], "k", linewidth=1)
            one.set(xlim=(low[0], high[0]), ylim=(low[1], high[1]), aspect="equal", title=label)
        figure.savefig(f"{path}.png", dpi=150, bbox_inches="tight", metadata={"Software": None})
        pyplot.close(figure)
    return draw


def plots_of(runs, fill):
    plots = {"void_ratio": void_ratio_plot(runs)}
    for shape in ("discs", "bonded_pairs"):
        for name, title, label, key in (("compaction", "void ratio after shaking one filling", "void ratio", "void_ratio"),
                                        ("roughness", "roughness of the surface after shaking", "standard deviation, m", "roughness_m"),
                                        ("thrown", "grains thrown while shaken", "grains", "thrown")):
            plots[f"{name}_{shape}"] = over_frequency(runs, shape, title, label, key)
    plots["resonance"] = resonance_plot(runs, fill.width)
    plots["compaction_over_time"] = compaction_plot(runs)
    for shape in SHAPES:
        during = []
        for run in sorted((run for run in runs if run.shown and run["shape"] == shape and len(run.pictures)),
                          key=lambda run: (-run["frequency_Hz"], run["acceleration_gal"])):
            title = f"{run['acceleration_gal']:g} gal, {run['frequency_Hz']:g} Hz"
            during.append((title, run.pictures[2]))
            if title == "400 gal, 10 Hz":
                plots[f"{shape}_pictures"] = draw_sheet(list(zip(PICTURES, run.pictures)), f"{words(shape)}, {title}")
        if during:
            plots[f"{shape}_shakings"] = draw_sheet(during, f"Largest displacement of the centre of mass: {words(shape)}")
        for run in runs:
            if run["run"] == f"{shape}_1_400gal_10Hz" and len(run.falling):
                plots.update(history_plots(run, dataclasses.replace(fill, shape=shape).followed()[1]))
    return plots


def reproduce(options):
    old = [Run(row) for row in rows_of("sukegawa2010/runs")]
    fill = plan(options.quick)[0][1]
    new = [] if options.stored else compute(options)
    missing = [] if options.quick else [run for run in old if run["run"] not in {one["run"] for one in new}]
    by_name = {run["run"]: run for run in [*missing, *new]}
    runs = new if options.quick else [by_name[run["run"]] for run in old]
    rows = [{**run, "source": "stored" if run in missing else "computed"} for run in runs]
    return Output(report(runs, options, fill, missing), {"quick": options.quick, "runs": rows}, {"runs": columns_of(rows)},
                  plots_of(runs, fill))


if __name__ == "__main__":
    main("sukegawa2010", __doc__, reproduce, add_options=lambda parser: parser.add_argument(
        "--stored", action="store_true", help="tables and figures of the stored runs; nothing is computed"))
