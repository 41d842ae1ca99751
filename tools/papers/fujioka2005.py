#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Fujioka & Ushijima (2005), "An evaluation method of normal contact force with energy conservation in distinct element
method", section 5, computed again: Tables 1, 2 and Figs. 4 to 7, 10, 11, the law exact_flow beside the paper's, and
bodies that come to rest, which are not in the paper. Times of computing, single equations as they are printed and the
law C without lag are stored results, with their date.

Example:
  tools/papers/fujioka2005.py --out figures      minutes; with --quick seconds
"""
import dataclasses
import math

import numpy as np

from common import Output, eq, main, published, rows_of, tracked
from shown import Row

PRINTED = {name: row.value for name, row in published("fujioka2005").items()}
# Results of this project: TIMES of a release build on an idle machine, PARTS computed by methods that are gone.
TIMES, PARTS = Row(date="2026-11-23", commit="b6047f21"), Row(date="2026-11-29", commit="b733177e")
E, G, D, DROP, FAST, R0 = (PRINTED[name] for name in ("restitution", "gravity", "diameter", "drop", "fast_speed",
                                                      "stacked_radius"))
EXACT_SPEED, EXACT_PARTING = PRINTED["exact_speed"], PRINTED["exact_parting"]
THEORY = E * E  # energy after over before an impact
STEP = 1e-3  # s, section 5.1
STIFF, VERY_STIFF = 4.0, 1e4  # stiffnesses that only exact_flow permits: w dt = 2 and 100
SOFT_HERTZ = 1.5  # stiffness with which T survives the fast impacts, in place of that of Table 2
LETTERS = {"linear_dashpot": "C", "hertz_dashpot": "T", "five_case_map": "F", "energy_map": "P", "exact_flow": "X"}
TABLE2_STEPS = (1e-3, 1e-4, 1e-5)  # s
BALLS, DURATION = 16, 5.0  # of Table 1; s


@dataclasses.dataclass(frozen=True)
class Variant:
    """A law with its dimensionless stiffness k dt²/m (T: k d_c^(1/2) dt²/m). The paper does not print it; it follows
    from the counts of Table 2 and is kept while the step changes."""
    law: str
    a: float
    label: str = ""

    @property
    def of_paper(self):
        return self.law != "exact_flow"

    @property
    def lag(self):
        """s by which velocities are behind places: half a step in semi-implicit Euler."""
        return 0.5 * STEP if self.of_paper else 0

    def row(self, **found):
        return Row(law=self.law, letter=LETTERS[self.law], a=self.a, label=self.label, **found)

    def spheres(self, centres, step, e=E, velocity=0.0, radius=D / 2, refuse_crossing=True):
        """Spheres over a floor, moving along y; contacts end at zero overlap as in the paper, those of X where the
        force is zero."""
        velocities = np.zeros((len(centres), 2)) + (0, velocity)
        return eq._core.Spheres(np.array(centres, dtype=float), velocities, radius, self.law, self.a, e, self.of_paper,
                                G, step, refuse_crossing)


def variants(stiffness):
    a = {law: 4.62 if law == "hertz_dashpot" else 0.10 for law in LETTERS}
    return [Variant(law, a[law], LETTERS[law]) for law in LETTERS] + [Variant("exact_flow", stiffness, "X stiff")]


def column(balls):
    """Spheres in a vertical column over the floor, the k-th lowest with k + 1 gaps below it."""
    return [(0, ((k + 0.5) + (k + 1) * DROP) * D) for k in range(balls)]


# ---- Tables 1 and 2

def count_steps(variant, step):
    """Steps in contact of the first impact."""
    run, count = variant.spheres(column(1), step), 0
    while not (count and run.sphere(0)[1] > D / 2):
        before = run.counters.evaluations
        run.advance(1)
        count += run.counters.evaluations > before
    return count


def table1(size):
    """Evaluations of the law in the paper's run, beside the stored times. The balls do not meet: each makes those of
    one."""
    stored, rows = rows_of("fujioka2005/table1", "law", "letter"), []
    for variant, row in tracked("Table 1:", zip(variants(VERY_STIFF), stored), len(stored)):
        row["step_s"], row["label"] = max(row.step_s, size.table1_step), variant.label
        run = variant.spheres(column(1), row.step_s)
        run.advance(round(DURATION / row.step_s))
        rows.append(Row({**row, "evaluations": BALLS * run.counters.evaluations}))
    return rows


def costs(test):
    """Curves of error against time of computing."""
    rows = [row for row in rows_of("fujioka2005/costs", "test", "label") if row.test == test]
    own = {label: [row for row in rows if row.label == label] for label in dict.fromkeys(row.label for row in rows)}
    return [Row(test=test, label=label, letter=label[0], a=points[0].a, points=points) for label, points in own.items()]


# ---- Figs. 4 to 7: one ball on a floor

def leap(variant, y, v):
    """The flight up and down again to some steps above the floor in one move, by the closed form of its steps."""
    n = math.floor(2 * v / (G * STEP)) - 3
    if n < 100:
        return y, v
    lag = 1 if variant.of_paper else 0
    return y + n * STEP * (v - 0.5 * G * STEP * (n + lag)), v - n * G * STEP


def watch_impacts(variant, fast):
    """20 impacts, or fewer. Reading 1: E = v²/2 + g h of the first step apart over that of the step of contact; reading
    2: what a flight conserves, in semi-implicit Euler, whose velocity is half a step behind, v²/2 + g (h - v dt/2)."""
    y, v = column(1)[0][1], -FAST if fast else 0.0

    def energy(lag=0.0):
        return 0.5 * v * v + G * ((y - D / 2) - lag * v)

    def start():
        return variant.spheres([(0, y)], STEP, velocity=v, refuse_crossing=False)
    ratios, flights, paths, ran_away, met = [], [], [], False, False
    before, at_contact, run = energy(variant.lag), 0.0, start()
    for _ in range(100000 if fast else 8000):
        contacts = run.counters.contacts
        run.advance(1)
        if not met and run.counters.contacts > contacts:
            met, at_contact = True, energy()
            paths.append([])
        depth = -(y - D / 2) / D
        if depth > 0:
            paths[-1].append((depth, -v * STEP / D))
        y, v = run.sphere(0)[1::2]
        if not met or y - D / 2 <= 0:
            continue
        ratios.append(energy() / at_contact)
        flights.append(energy(variant.lag) / before)
        before, met, ran_away = energy(variant.lag), False, v * STEP > D / 2
        if ran_away or len(ratios) == 20:
            break
        if fast:
            y, v = leap(variant, y, v)
            run = start()
    return variant.row(paths=paths, energy_ratios=ratios, energy_ratios_of_flights=flights,
                       deepest=max((depth for path in paths for depth, _ in path), default=0.0), ran_away=ran_away)


# ---- Figs. 10, 11: a sphere slides down between two others

def slide(variant, step):
    """Errors of the final speed d' and of the time T0 at which B and C part, and sweeps of X in a step."""
    centres = [(-R0, R0), (R0, R0), (0, (1 + math.sqrt(3)) * R0)]
    run, parting, last = variant.spheres(centres, step, radius=R0), 0, math.ceil(1.3 * EXACT_PARTING / step)
    for k in range(1, last + 1):
        run.advance(1)
        if (1, 2) in run.contacts():
            parting = k
    # an Euler step lists the contacts at its start, a step of X those at its end
    later = 0 if variant.of_paper or not parting else 1
    return Row(time_step=step, speed_error=abs(run.sphere(1)[2] / math.sqrt(4 * G * R0) / EXACT_SPEED - 1),
               parting_error=abs((parting + later) * step / EXACT_PARTING - 1),
               sweeps_in_a_step=run.counters.sweeps / last)


def slide_stacked(size):
    """1e-3 s and less, by quarters of a decade; orders: slopes of log(error) over log(step) up to 1e-4 s. Last: C whose
    closing speed is the change of overlap since the step before, not the old velocity along the new normal."""
    steps = [10 ** (-k / 4) for k in size.quarters]
    curves = [variant.row(points=[slide(variant, step) for step in steps])
              for variant in tracked("stacked spheres:", variants(STIFF))]
    without_lag = dataclasses.replace(variants(STIFF)[0], label="C, no lag")
    curves.append(without_lag.row(points=[row for row in rows_of("fujioka2005/without_lag", "label")
                                          if round(-4 * math.log10(row.time_step)) in size.quarters]))
    for one in curves:
        for what in ("speed", "parting"):
            fine = [(p.time_step, p[what + "_error"]) for p in one.points
                    if p.time_step <= 1.01e-4 and p[what + "_error"] > 0]
            one[what + "_order"] = np.polyfit(*np.log(fine).T, 1)[0]
    return curves


# ---- bodies that come to rest under gravity; not in the paper

def settle(variant, balls, duration, e):
    run, hertz = variant.spheres(column(balls), STEP, e), variant.law == "hertz_dashpot"
    mass = 4 / 3 * math.pi * (D / 2) ** 3
    weight, floor = balls * G * mass, variant.a * mass / (STEP * STEP) / (math.sqrt(D) if hertz else 1)
    # of two balls the reduced mass is half that of a ball and the floor
    springs, power = np.array([floor] + [0.5 * floor] * (balls - 1)), 1.5 if hertz else 1

    def energy(y, v=0.0):
        overlaps = np.maximum(0, D - np.diff(y, prepend=-0.5 * D))
        return (0.5 * mass * v**2 + mass * G * y + springs * overlaps**(power + 1) / (power + 1)).sum()
    at_rest = (np.arange(balls, 0, -1) * mass * G / springs)**(1 / power)  # overlaps
    still = energy(np.cumsum(D - at_rest) - 0.5 * D)
    last, times, energies = round(duration / STEP), [], []
    every, late, speeds, overlaps, touched = last // 400, last - last // 10, 0.0, 0.0, 0
    while run.step < last:
        run.advance(1 if run.step >= late else every)
        _, y, u, v = np.array([run.sphere(k) for k in range(balls)]).T
        if run.step % every == 0:
            times.append(run.step * STEP)
            energies.append((energy(y - variant.lag * v, v) - still) / (weight * D))  # at the instant of the velocities
        if run.step > late:
            speeds += (u**2 + v**2).mean()
            overlaps += 0.5 * D - y[0]
            touched += sum(j < 0 for _, j in run.contacts())
    steps, changes = last - late, [energy / energies[0] - 1 for energy in energies]
    return variant.row(
        times=times, energies=energies, changes=changes, balls=balls, energy_above_rest=energies[-1],
        speed_of_g_dt=math.sqrt(speeds / steps) / (G * STEP), share_of_steps_in_contact=touched / steps,
        overlap_of_static=overlaps / steps / at_rest[0], energy_change=changes[-1])


def come_to_rest(balls, duration, e=E):
    return [settle(variant, balls, duration, e) for variant in tracked(f"{balls} at rest:", variants(STIFF))]


def compute(size):
    laws = variants(VERY_STIFF)
    return Row(slow_impacts=[watch_impacts(variant, False) for variant in laws],
               fast_impacts=[watch_impacts(variant, True) for variant in (
                   *laws[:2], Variant("hertz_dashpot", SOFT_HERTZ, "T soft"), *laws[2:])],
               printed=rows_of("fujioka2005/corrections", "reading"), bouncing_ball=costs("ball"),
               table2=[variant.row(steps=[count_steps(variant, step) for step in TABLE2_STEPS]) for variant in laws],
               stacked_costs=costs("stacked"), stacked=slide_stacked(size), rest=come_to_rest(1, 6),
               column=come_to_rest(size.balls, size.duration), lossless=come_to_rest(5, size.duration, 1.0),
               table1=table1(size))


# ---- what the report says

def of(rows, label):
    return next(row for row in rows if row.label == label)


def worst(ratios, first=1, last=20):
    """Largest |ratio - e²| of the impacts from the first-th to the last-th."""
    return max((abs(ratio - THEORY) for ratio in ratios[first - 1:last]), default=0.0)


def printed_steps(letter):
    return [round(PRINTED[f"steps_{letter}_1e-{k}"]) for k in (3, 4, 5)]


def cells(values, spec, unit=""):
    """Of a table; "-" where a value is missing."""
    return " | ".join("-" if value is None else format(value, spec) + unit for value in values)


def at_steps(points, key, steps=(1e-3, 1e-4, 1e-5, 1e-6)):
    return [next((p[key] for p in points if abs(p.time_step / step - 1) < 0.01), None) for step in steps]


def least_costs(points, wanted):
    """Times of the cheapest points with at most the wanted errors."""
    return [min((p.seconds for p in points if p.error <= accuracy), default=None) for accuracy in wanted]


def passages(law):
    """Percent of the impacts of P whose states pass through the modes 1, 2 and 4, and that part from mode 2."""
    border, share, found = math.sqrt(1 - law.a), 100 / len(law.paths), Row(by_124=0.0, from_2=0.0)
    for path in law.paths:
        slopes = [closing / depth for depth, closing in path]
        if len(path) == 2 and slopes[0] >= 1 and slopes[1] >= border:
            found["from_2"] += share
        if len(path) == 3 and slopes[0] >= 1 and 0 < slopes[1] < border and slopes[2] < -border:
            found["by_124"] += share
    return found


def said(holds):
    """Of a conclusion of the paper."""
    return "holds" if holds else "does not hold here"


def conclusions(r):
    """Numbers by which the report decides each conclusion of the paper."""
    def worst_of(key, first):
        return Row({letter: worst(of(r.slow_impacts, letter)[key], first, 10) for letter in "CTFP"})
    points = Row({letter: of(r.stacked, letter).points for letter in "CTFP"})
    fast = Row({label.replace(" ", "_"): of(r.fast_impacts, label) for label in ("C", "T", "T soft", "F", "P")})
    return Row(
        ten=worst_of("energy_ratios", 1), late=worst_of("energy_ratios", 6), fast=fast, passages=passages(fast.P),
        of_flights=worst_of("energy_ratios_of_flights", 1), points=points,
        worst_fast=Row({letter: worst(fast[letter].energy_ratios) for letter in "FP"}),
        agree=sum(n == printed for row in r.table2 if row.letter != "X"
                  for n, printed in zip(row.steps, printed_steps(row.letter))),
        better=Row({key: sum(max(p[key], f[key]) < min(c[key], t[key]) for c, t, f, p in zip(*points.values()))
                    for key in ("speed_error", "parting_error")}),
        last=Row({letter: own[-1].speed_error for letter, own in points.items()}),
        apart=[abs(f.speed_error / p.speed_error - 1) for f, p in zip(points.F, points.P) if p.time_step <= 1.01e-4])


# ---- figures

def name_of(law):
    steps = "X, step 0.1 s"
    return {steps: steps + ", a = 1e4 to 1e12", "C, no lag": law.label}.get(law.label, f"{law.letter} (a = {law.a:g})")


def f_over_p(laws):
    """F after P, with which it often coincides: its open marker or dashed line leaves P in sight."""
    c, t, f, p, *others = laws
    return c, t, p, f, *others


def edge(slope, depth):
    """Where a line from the origin leaves a plane of depth and closing."""
    return min(depth, 0.5 / abs(slope)) if slope else depth


def first_paths(law):
    """States of the first impacts, with gaps between them."""
    return [state for path in law.paths[:8] for state in (*path, (math.nan, math.nan))]


def numbers_of(row):
    """What result.json has of a row: without curves, the points as columns."""
    points = row.get("points", [{}])
    return {**{key: row[key] for key in row if key not in ("points", "paths", "times", "energies", "changes")},
            **{key: [point[key] for point in points] for key in points[0] if key not in row}}


def reproduce(options, _page):
    r = compute(options.size)
    c, f, p = (of(r.table1, letter) for letter in "CFP")
    names = {**r, **conclusions(r), "c": c, "f": f, "p": p,
             "at_rest_from": math.sqrt(2 * DROP * D / G) * (1 + E) / (1 - E)}
    numbers = {"exact_speed": EXACT_SPEED, "exact_parting_time": EXACT_PARTING,
               **{key: [numbers_of(row) for row in rows] for key, rows in r.items() if key != "printed"}}
    return Output(names, numbers, {
        "table1": [{key: row[key] for key in row if key != "label"} for row in r.table1],
        "table2": [{"law": row.law, "letter": row.letter, "a": row.a, **{
            f"steps_at_{step:.0e}_s": steps for step, steps in zip(TABLE2_STEPS, row.steps)}} for row in r.table2]})


if __name__ == "__main__":
    main(reproduce)
