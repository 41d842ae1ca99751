#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Fujioka & Ushijima (2005), "An evaluation method of normal contact force with energy conservation in distinct element
method", section 5, computed again: Tables 1, 2 and Figs. 4 to 7, 10, 11, the law exact_flow beside the paper's; and two
tests that are not in the paper: coming to rest, and time of computing for an accuracy.

Example:
  tools/papers/fujioka2005.py --out figures      minutes; with --quick seconds
"""
import dataclasses
import math
import time

import common
import numpy as np
from common import Axis, Output, Plot, Progress, Series, Table, eq, published

PRINTED = published("fujioka2005")
E, G, D, DROP, FAST, R0 = (PRINTED[name].value for name in ("restitution", "gravity", "diameter", "drop", "fast_speed",
                                                            "stacked_radius"))
EXACT_SPEED, EXACT_PARTING = PRINTED["exact_speed"].value, PRINTED["exact_parting"].value
ERROR_OF_31 = PRINTED["parting_error_of_31"].value
THEORY = E * E  # energy after over before an impact
STEP = 1e-3  # s, section 5.1
STIFF, VERY_STIFF = 4.0, 1e4  # stiffnesses that only exact_flow permits: w dt = 2 and 100
SOFT_HERTZ = 1.5  # stiffness with which T survives the fast impacts, in place of that of Table 2
LETTERS = {"linear_dashpot": "C", "hertz_dashpot": "T", "five_case_map": "F", "energy_map": "P", "exact_flow": "X"}
TABLE2_STEPS = (1e-3, 1e-4, 1e-5)  # s
BALLS, DURATION, SLICES = 16, 5.0, 50  # of Table 1; s
SPEEDS, PARTINGS, RATIOS = "speed_error", "parting_error", "energy_ratios"


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
    def letter(self):
        return LETTERS[self.law]

    @property
    def name(self):
        return f"{self.letter} (a = {self.a:g})"

    def head(self):
        return {"law": self.law, "letter": self.letter, "a": self.a}

    def spheres(self, centres, step, e=E, velocities=None, radius=D / 2, refuse_crossing=True):
        """Spheres over a floor; contacts end at zero overlap as in the paper, those of X where the force is zero."""
        velocities = np.zeros((len(centres), 2)) if velocities is None else np.array(velocities, dtype=float)
        return eq._core.Spheres(np.array(centres, dtype=float), velocities, radius, self.law, self.a, e, self.of_paper,
                                G, step, refuse_crossing)


def variants(stiffness):
    a = {law: 4.62 if law == "hertz_dashpot" else 0.10 for law in LETTERS}
    return [Variant(law, a[law], LETTERS[law]) for law in LETTERS] + [Variant("exact_flow", stiffness, "X stiff")]


def column(balls):
    """Spheres in a vertical column over the floor, the k-th lowest with k + 1 gaps below it."""
    return [(0, ((k + 0.5) + (k + 1) * DROP) * D) for k in range(balls)]


# Tables 1 and 2.
def count_table2():
    rows = []
    for variant in variants(VERY_STIFF):
        steps = []
        for step in TABLE2_STEPS:
            run, count = variant.spheres(column(1), step), 0
            while not (count and run.sphere(0)[1] > D / 2):
                before = run.counters.evaluations
                run.advance(1)
                count += run.counters.evaluations > before
            steps.append(count)
        rows.append({**variant.head(), "variant": variant, "steps": steps})
    return rows


def samples_of(law):
    """States during impacts that begin at all phases of a step."""
    depths, closings, impact = [], [], 0
    while len(depths) < 4096:
        closing = 1e-3
        depth = max(1e-6, math.fmod(0.618033988749895 * (impact + 0.5), 1)) * closing
        while depth > 0:
            depths.append(depth)
            closings.append(closing)
            change, shift = law.step(depth, closing, closing >= depth)
            closing += change
            depth += shift + closing
        impact += 1
    return np.array(depths[:4096]), np.array(closings[:4096])


def gravity_first(variant, step):
    """Evaluations in the paper's run where gravity is added before the contact force; 0: not computed."""
    if not variant.of_paper:
        return 0
    law, fall, depth, closing, count = eq._core.Law(variant.law, variant.a, E), G * step * step / D, -DROP, 0.0, 0
    for _ in range(round(DURATION / step)):
        closing += fall
        if depth > 0:
            count += 1
            change, shift = law.step(depth, closing, closing >= depth)
            closing += change
            depth += shift
        depth += closing
    return BALLS * count


def measure_table1(quick, progress):
    """Time of the processor, by turns, of equal runs the least of each slice: other load of the machine has little
    effect."""
    fine, rows = 1e-5 if quick else 1e-6, []
    for variant in variants(VERY_STIFF):
        step = STEP if variant.label == "X stiff" else fine
        balls = [(1.5 * D * k, column(1)[0][1]) for k in range(BALLS)]
        law = eq._core.Law(variant.law, variant.a, E) if variant.of_paper else None
        rows.append({**variant.head(), "variant": variant, "time_step": step, "run_seconds": 0.0,
                     "law_alone_nanoseconds": math.inf if law else math.nan,
                     "evaluations_gravity_first": gravity_first(variant, step), "alone": law,
                     "samples": samples_of(law) if law else None,
                     "runs": [variant.spheres(balls, step) for _ in range(3)]})
        progress.update(0.5 + 0.2 * len(rows) / 6)
    for part in range(SLICES):
        for row in rows:
            steps, least = round(DURATION / row["time_step"]) // SLICES, math.inf
            for run in row["runs"]:
                before = time.process_time()
                run.advance(steps)
                least = min(least, time.process_time() - before)
            row["run_seconds"] += least
            if part % 5 == 0 and row["alone"]:
                before = time.perf_counter()
                row["alone"].sum(*row["samples"], 20)
                row["law_alone_nanoseconds"] = min(row["law_alone_nanoseconds"],
                                                   (time.perf_counter() - before) * 1e9 / (20 * 4096))
        progress.update(0.7 + 0.3 * (part + 1) / SLICES)
    for row in rows:
        row["evaluations"] = row["runs"][0].counters.evaluations
        del row["runs"], row["samples"], row["alone"]
    return rows


# Figs. 4 to 7: one ball on a floor.
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
    lag = 0.5 * STEP if variant.of_paper else 0
    y, v = column(1)[0][1], -FAST if fast else 0.0

    def of_step():
        return 0.5 * v * v + G * (y - D / 2)

    def of_flight():
        return 0.5 * v * v + G * ((y - D / 2) - lag * v)

    def start():
        return variant.spheres([(0, y)], STEP, velocities=[(0, v)], refuse_crossing=False)
    ratios, flights, paths, deepest, ran_away, met = [], [], [], 0.0, False, False
    before, at_contact, run = of_flight(), 0.0, start()
    for _ in range(100000 if fast else 8000):
        contacts = run.counters.contacts
        run.advance(1)
        if not met and run.counters.contacts > contacts:
            met, at_contact = True, of_step()
        depth = -(y - D / 2) / D
        if depth > 0:
            if len(paths) == len(ratios):
                paths.append([])
            paths[-1].append((depth, -v * STEP / D))
            deepest = max(deepest, depth)
        y, v = run.sphere(0)[1::2]
        if not met or y - D / 2 <= 0:
            continue
        ratios.append(of_step() / at_contact)
        flights.append(of_flight() / before)
        paths += [[]] * (len(ratios) - len(paths))
        before, met, ran_away = of_flight(), False, v * STEP > D / 2
        if ran_away or len(ratios) == 20:
            break
        if fast:
            y, v = leap(variant, y, v)
            run = start()
    return {**variant.head(), "variant": variant, RATIOS: ratios, "energy_ratios_of_flights": flights,
            "deepest": deepest, "ran_away": ran_away, "paths": paths}


def impacts(fast):
    laws = variants(VERY_STIFF)
    if fast:
        laws.insert(2, Variant("hertz_dashpot", SOFT_HERTZ, "T soft"))
    return [watch_impacts(variant, fast) for variant in laws]


def compare_printed():
    """Energy after over before an impact by P without gravity over all phases of the contact step, with single
    equations as the paper prints them; theory: e²."""
    def ratio(reading, law, a, phase):
        depth, closing, first = phase, 1.0, True
        for _ in range(1000):
            if depth <= 0:
                break
            s = closing / depth
            change, shift = law.step(depth, closing, first)
            root = math.sqrt((1 + a) * s * s + a * a)
            if first and reading == "(20) with d_j":  # (17), (15) and (20) with d_j in place of the corrected depth
                corrected = s * E / math.sqrt(s * s + a) * closing
                change = corrected - closing - depth / (1 + a) * ((1 + a) * s + a - root)
                shift = corrected / s - depth
            if not first and s > 0 and reading == "(21) in all of mode 2":  # also where it gives d' <= 0
                change = -depth / (1 + a) * ((1 + a) * s + a + root)
            closing += change
            depth += shift + closing
            first = False
        return closing * closing
    rows = []
    for a in (0.10, 0.9):
        law = eq._core.Law("energy_map", a, E)
        for reading in ("as used", "(20) with d_j", "(21) in all of mode 2"):
            found = [ratio(reading, law, a, (k + 0.5) / 4000) for k in range(4000)]
            rows.append((reading, a, sum(found) / 4000, min(found), max(found)))
    return rows


# Figs. 10, 11: a sphere slides down between two others.
def slide(variant, step):
    """Errors of the final speed d' and of the time T0 at which B and C part, sweeps of X in a step, and time of
    computing."""
    centres = [(-R0, R0), (R0, R0), (0, (1 + math.sqrt(3)) * R0)]
    run, parting, last = variant.spheres(centres, step, radius=R0), 0, math.ceil(1.3 * EXACT_PARTING / step)
    for k in range(1, last + 1):
        run.advance(1)
        if (1, 2) in run.contacts():
            parting = k
    # an Euler step lists the contacts at its start, a step of X those at its end
    point = errors_of(step, run.sphere(1)[2], (parting + (0 if variant.of_paper or not parting else 1)) * step)
    steps, least, spent, rounds = math.ceil(EXACT_PARTING / step), math.inf, 0, 0
    while rounds < 3 or (spent < 0.05 and rounds < 100):
        timed = variant.spheres(centres, step, radius=R0)
        begun = time.perf_counter()
        timed.advance(steps)
        taken = time.perf_counter() - begun
        least, spent, rounds = min(least, taken), spent + taken, rounds + 1
    return {**point, "seconds": least, "sweeps_in_a_step": run.counters.sweeps / last}


def errors_of(step, speed, parting):
    return {"time_step": step, SPEEDS: abs(speed / math.sqrt(4 * G * R0) / EXACT_SPEED - 1),
            PARTINGS: abs(parting / EXACT_PARTING - 1), "seconds": 0.0, "sweeps_in_a_step": 0.0}


def slide_without_lag(step):
    """C by symmetry: the closing speed is the change of overlap since the step before, not the old velocity along the
    new normal."""
    law, bx, by, vx, vy, c, vc = eq._core.Law("linear_dashpot", 0.10, E), R0, R0, 0.0, 0.0, (1 + math.sqrt(3)) * R0, 0.0
    pair_before = floor_before = parting = 0.0
    for n in range(1, math.ceil(1.3 * EXACT_PARTING / step) + 1):
        distance = math.hypot(bx, by - c)
        pair, floor, nx, ny = 2 * R0 - distance, R0 - by, bx / distance, (by - c) / distance
        gx = gy = on_c = 0.0
        if pair > 0:
            # change of the closing speed shared by two equal masses; A acts on C as the mirror image of B
            push = -0.5 * law.step(pair, pair - pair_before, True)[0] / step
            gx, gy, on_c, parting = push * nx, push * ny, -2 * push * ny, n * step
        if floor > 0:
            gy -= law.step(floor, floor - floor_before, True)[0] / step
        pair_before, floor_before = pair, floor
        vx, vy, vc = vx + gx, vy + gy - G * step, vc + on_c - G * step
        bx, by, c = bx + step * vx, by + step * vy, c + step * vc
    return errors_of(step, vx, parting)


def order(points, key):
    """Slope of log(error) over log(step), least squares over steps up to 1e-4 s."""
    fine = [p for p in points if p["time_step"] <= 1.01e-4 and p[key] > 0]
    u, v = (np.log([p[name] for p in fine]) for name in ("time_step", key))
    return float(((u - u.mean()) * v).sum() / ((u - u.mean()) ** 2).sum())


def slide_stacked(quick, progress):
    """1e-3 to 1e-6 s, four per decade; quick: to 1e-5 s, two per decade."""
    steps, curves = [10 ** (-k / 4) for k in range(12, 21 if quick else 25, 2 if quick else 1)], []
    for variant in variants(STIFF):
        curves.append({"variant": variant, "label": variant.label, "points": [slide(variant, step) for step in steps]})
        progress.update(0.2 + 0.3 * len(curves) / 6)
    without_lag = [slide_without_lag(step) for step in steps]
    curves.append({"variant": variants(STIFF)[0], "label": "C, no lag", "points": without_lag})
    for one in curves:
        one.update(speed_order=order(one["points"], SPEEDS), parting_order=order(one["points"], PARTINGS))
    return curves


# A bouncing ball over 3 s, beside the rigid one.
def rigid_height(at):
    height = DROP * D
    speed = math.sqrt(2 * G * height)
    left = at - speed / G
    if left < 0:
        return height - 0.5 * G * at * at
    speed *= E
    while left > 2 * speed / G:
        left -= 2 * speed / G
        speed *= E
    return speed * left - 0.5 * G * left * left


def follow_ball(variant, a, step):
    between, least, spent, rounds = round(0.1 / step), math.inf, 0, 0
    while rounds < 3 or (spent < 0.005 and rounds < 200):
        run, heights, taken = Variant(variant.law, a).spheres(column(1), step), [], 0.0
        for _ in range(30):
            begun = time.perf_counter()
            run.advance(between)
            taken += time.perf_counter() - begun
            heights.append(run.sphere(0)[1] - 0.5 * D)
        least, spent, rounds = min(least, taken), spent + taken, rounds + 1
    squares = sum((height - rigid_height(k * 0.1)) ** 2 for k, height in enumerate(heights, 1))
    return {"time_step": step, "a": a, "error": math.sqrt(squares / 30) / (DROP * D), "seconds": least}


def cost_of_ball(quick, progress):
    steps, curves = [1e-2, 5e-3, 2e-3, 1e-3, 5e-4, 2e-4, 1e-4, *([] if quick else [5e-5, 2e-5, 1e-5])], []
    for variant in variants(0.0):
        one_step = variant.a == 0
        places = [(10.0 ** k, 0.1) for k in range(4, 13)] if one_step else [(variant.a, step) for step in steps]
        curves.append({"variant": variant, "label": "X, step 0.1 s" if one_step else variant.label,
                       "points": [follow_ball(variant, a, step) for a, step in places]})
        progress.update(0.03 * len(curves))
    return curves


# Bodies that come to rest under gravity; not in the paper.
def settle(variant, balls, duration, e):
    run, hertz = variant.spheres(column(balls), STEP, e), variant.law == "hertz_dashpot"
    mass = 4 / 3 * math.pi * (D / 2) ** 3
    # of two balls the reduced mass is half that of a ball and the floor
    floor = variant.a * mass / (STEP * STEP) / (math.sqrt(D) if hertz else 1)
    springs = [floor] + [0.5 * floor] * (balls - 1)

    def overlap(k, force):
        return (force / springs[k]) ** (2 / 3) if hertz else force / springs[k]

    def elastic(k, pressed):
        return springs[k] * (0.4 * pressed ** 2.5 if hertz else 0.5 * pressed * pressed) if pressed > 0 else 0.0
    lag, still, height = 0.5 * STEP if variant.of_paper else 0, 0.0, -0.5 * D
    for k in range(balls):
        pressed = overlap(k, (balls - k) * mass * G)
        height += D - pressed
        still += mass * G * height + elastic(k, pressed)

    def energy():
        """At the instant of the velocities: half a step back in semi-implicit Euler."""
        total, below = 0.0, -0.5 * D
        for k in range(balls):
            _, y, _, v = run.sphere(k)
            y -= lag * v
            total += 0.5 * mass * v * v + mass * G * y + elastic(k, below + D - y)
            below = y
        return total
    weight, last, times, energies = balls * G * mass, round(duration / STEP), [], []
    every, late, speeds, overlaps, touched = last // 400, last - last // 10, 0.0, 0.0, 0
    while run.step < last:
        run.advance(1 if run.step >= late else every)
        if run.step % every == 0:
            times.append(run.step * STEP)
            energies.append((energy() - still) / (weight * D))
        if run.step > late:
            speeds += sum(run.sphere(k)[2] ** 2 + run.sphere(k)[3] ** 2 for k in range(balls)) / balls
            overlaps += 0.5 * D - run.sphere(0)[1]
            touched += sum(j < 0 for _, j in run.contacts())
    steps = last - late
    return {**variant.head(), "variant": variant, "balls": balls, "times": times, "energies": energies,
            "speed_of_g_dt": math.sqrt(speeds / steps) / (G * STEP), "share_of_steps_in_contact": touched / steps,
            "overlap_of_static": overlaps / steps / overlap(0, weight), "energy_above_rest": energies[-1]}


def come_to_rest(balls, duration, e=E):
    return [settle(variant, balls, duration, e) for variant in variants(STIFF)]


def compute(quick):
    progress = Progress("reproducing Fujioka & Ushijima 2005")
    r = {"quick": quick, "table2": count_table2(), "slow_impacts": impacts(False), "fast_impacts": impacts(True),
         "printed": compare_printed(), "ball": cost_of_ball(quick, progress), "stacked": slide_stacked(quick, progress)}
    r.update(rest=come_to_rest(1, 6), column=come_to_rest(4 if quick else 10, 10 if quick else 40),
             lossless=come_to_rest(5, 10 if quick else 40, 1.0))
    progress.update(0.5)
    r["table1"] = measure_table1(quick, progress)
    progress.end()
    return r


def of(rows, label):
    return next(row for row in rows if row["variant"].label == label)


def worst(ratios, first=1, last=20):
    """Largest |ratio - e²| of the impacts from the first-th to the last-th."""
    return max((abs(ratio - THEORY) for ratio in ratios[first - 1:last]), default=0.0)


def cells(variant):
    return f"{variant.label} & {variant.a:g}"


def printed_steps(label):
    return [round(PRINTED[f"steps_{label}_1e-{k}"].value) for k in (3, 4, 5)]


def table_1(rows):
    table = Table("law & a & step & evaluations & gravity first & run & law alone & printed: evaluations & run & "
                  "one evaluation")
    for row in rows:
        label, first, own = row["variant"].label, row["evaluations_gravity_first"], row["variant"].of_paper
        alone = row["law_alone_nanoseconds"] if own else PRINTED[f"law_alone_{label}"].value
        printed = [PRINTED[f"{name}_{label}"].value for name in ("evaluations", "run", "evaluation")] if own else []
        table.add(f"{cells(row['variant'])} & {row['time_step']:.0e} s & {row['evaluations']:.3g} & "
                  f"{format(first, '.3g') if first else '-'} & {row['run_seconds']:.3g} s & {alone:.3g} ns"
                  + (" & {:.3g} & {:g} s & {:.2f} µs".format(*printed) if printed else ""))
    return table


def table_2(rows):
    table = Table("law & a & 1e-3 s & 1e-4 s & 1e-5 s & printed")
    for row in rows:
        beside = " & " + ", ".join(map(str, printed_steps(row["letter"]))) if row["variant"].of_paper else ""
        table.add(cells(row["variant"]) + "".join(f" & {n}" for n in row["steps"]) + beside)
    return table


def table_of_impacts(laws, key):
    table = Table("law & a & impacts & N = 1 & 2 & 3 & 4 & 5 & 6 & 7 & 8 & 9 & 10 & 15 & 20 & worst to 10 & worst & "
                  "deepest & ")
    for law in laws:
        ratios = law[key]
        shown = "".join(f" & {ratios[n - 1]:.4f}" if n <= len(ratios) else " & -" for n in (*range(1, 11), 15, 20))
        table.add(f"{cells(law['variant'])} & {len(ratios)}{'+' if len(ratios) == 20 else ' '}{shown} & "
                  f"{worst(ratios, 1, 10):.1e} & {worst(ratios):.1e} & {law['deepest']:.2g} d & "
                  f"{'unstable' if law['ran_away'] else ''}")
    return table


def point_at(one, step):
    return next((p for p in one["points"] if abs(p["time_step"] / step - 1) < 0.01), None)


def table_of_stacked(curves):
    table = Table("law & a & d': 1e-3 s & 1e-4 s & 1e-5 s & 1e-6 s & order & T0: 1e-3 s & 1e-4 s & 1e-5 s & 1e-6 s & "
                  "order")
    for one in curves:
        row = f"{one['label']} & {one['variant'].a:g}"
        for key in (SPEEDS, PARTINGS):
            found = [point_at(one, step) for step in (1e-3, 1e-4, 1e-5, 1e-6)]
            row += "".join(f" & {p[key]:.1e}" if p else " & -" for p in found)
            row += f" & {one[key.replace('error', 'order')]:.2f}"
        table.add(row)
    return table


def costs(curves, key, wanted):
    """Times of the cheapest point with at most the wanted error."""
    table = Table("law & a" + "".join(f" & {accuracy:.0e}" for accuracy in wanted))
    for one in (one for one in curves if one["points"][0]["seconds"] > 0):
        row = cells(one["variant"]) if one["label"] == one["variant"].label else one["label"] + " & any"
        for accuracy in wanted:
            least = min((p["seconds"] for p in one["points"] if p[key] <= accuracy), default=None)
            row += " & -" if least is None else f" & {least:.2g} s"
        table.add(row)
    return table


def at_rest(laws):
    table = Table("law & a & speed, of g dt & energy above rest, of weight x d & "
                  "overlap at the floor, of the static one & steps in contact")
    for law in laws:
        table.add(f"{cells(law['variant'])} & {law['speed_of_g_dt']:.2g} & {max(0.0, law['energy_above_rest']):.1e} & "
                  f"{law['overlap_of_static']:.6f} & {100 * law['share_of_steps_in_contact']:.1f} %")
    return table


def changes(law):
    """Relative change of the energy since the start."""
    return [energy / law["energies"][0] - 1 for energy in law["energies"]]


def passages(law):
    """Percent of the impacts of P whose states pass through the modes 1, 2 and 4, and that part from mode 2."""
    border, share, by_124, from_2 = math.sqrt(1 - law["a"]), 100 / len(law["paths"]), 0.0, 0.0
    for path in law["paths"]:
        slopes = [closing / depth for depth, closing in path]
        if len(path) == 2 and slopes[0] >= 1 and slopes[1] >= border:
            from_2 += share
        if len(path) == 3 and slopes[0] >= 1 and 0 < slopes[1] < border and slopes[2] < -border:
            by_124 += share
    return {"by_124": by_124, "from_2": from_2}


def verdicts(r):
    """What the numbers say of each conclusion of the paper."""
    slow, fast, table1 = r["slow_impacts"], r["fast_impacts"], r["table1"]
    ten, late, flights = ({letter: worst(of(slow, letter)[key], first, 10) for letter in "CTFP"} for key, first in
                          ((RATIOS, 1), (RATIOS, 6), ("energy_ratios_of_flights", 1)))
    worst_fast = {letter: worst(of(fast, letter)[RATIOS]) for letter in "FP"}
    t, soft, c, p = of(fast, "T"), of(fast, "T soft"), of(table1, "C"), of(table1, "P")
    agree = sum(n == printed for row in r["table2"] if row["variant"].of_paper
                for n, printed in zip(row["steps"], printed_steps(row["letter"])))
    errors = {key: {letter: [q[key] for q in of(r["stacked"], letter)["points"]] for letter in "CTFP"}
              for key in (SPEEDS, PARTINGS)}
    better = {key: sum(max(p, f) < min(c, t) for c, t, f, p in zip(*e.values())) for key, e in errors.items()}
    speeds, steps = errors[SPEEDS], [q["time_step"] for q in r["stacked"][0]["points"]]
    apart = [abs(f / p - 1) for f, p, step in zip(speeds["F"], speeds["P"], steps) if step <= 1.01e-4]
    last = {letter: error[-1] for letter, error in speeds.items()}
    holds = {"narrow": max(ten["P"], ten["F"]) < min(ten["C"], ten["T"]), "late": late["P"] < late["F"],
             "through": len(of(fast, "C")[RATIOS]) < 2, "goes_on": not t["ran_away"],
             "near": max(worst_fast.values()) < 1e-3, "counts": agree == 12,
             "cheap": p["law_alone_nanoseconds"] < 1.1 * c["law_alone_nanoseconds"],
             "shorter": all(p[key] < c[key] for key in ("run_seconds", "evaluations")),
             "accurate": max(last["P"], last["F"]) < min(last["C"], last["T"])}
    said = {name: "holds" if one else "does not hold here" for name, one in holds.items()}
    return {"v": {**said, "soft": "neither" if soft["ran_away"] else "it holds"}, "ten": ten, "late": late, "t": t,
            "of_flights": flights, "worst_fast": worst_fast, "deepest_of_C": of(fast, "C")["deepest"], "soft": soft,
            "soft_range": (min(soft[RATIOS]), max(soft[RATIOS])), "impacts_of_P": len(of(fast, "P")[RATIOS]),
            **passages(of(fast, "P")), "p": p, "c": c, "agree": agree, "smallest": steps[-1], "last": last,
            "better": better, "steps": len(steps), "apart": max(apart), "fine": len(apart),
            "f_better": sum(f < p for f, p in zip(speeds["F"], speeds["P"]))}


def report(r):
    """tools/papers/fujioka2005.txt with its numbers."""
    c, f, p = (of(r["table1"], letter) for letter in "CFP")
    step, rest = c["time_step"], math.sqrt(2 * DROP * D / G) * (1 + E) / (1 - E)
    corrections, lossless = Table("law P & a & mean & least & largest"), Table("law & a & at the end & largest")
    for name, a, *numbers in r["printed"]:
        corrections.add(f"{name} & {a:g}" + "".join(f" & {number:.6f}" for number in numbers))
    for law in r["lossless"]:
        lossless.add(f"{cells(law['variant'])} & {changes(law)[-1]:+.1e} & {max(map(abs, changes(law))):.1e}")
    return common.filled(
        "fujioka2005", table1=table_1(r["table1"]), rest=rest, here=f" (here {step:g} s)" if r["quick"] else "",
        evaluations=[16 * (DURATION - rest) / 1e-6, 16 * (50 - rest) / 1e-5],
        printed_shares=[PRINTED[f"evaluations_{x}"].value / PRINTED["evaluations_C"].value for x in "FP"],
        share=p["evaluations_gravity_first"] / f["evaluations_gravity_first"],
        source_of_X=PRINTED["law_alone_X"].source,
        more_alone=100 * (p["law_alone_nanoseconds"] / c["law_alone_nanoseconds"] - 1),
        per_step=p["run_seconds"] * 1e9 / (16 * DURATION / step),
        more_run=100 * (p["run_seconds"] / c["run_seconds"] - 1), table2=table_2(r["table2"]), corrections=corrections,
        slow=table_of_impacts(r["slow_impacts"], RATIOS),
        flights=table_of_impacts(r["slow_impacts"], "energy_ratios_of_flights"),
        fast=table_of_impacts(r["fast_impacts"], RATIOS), exact_speed=EXACT_SPEED, exact_parting=EXACT_PARTING,
        error_of_31=ERROR_OF_31, stacked=table_of_stacked(r["stacked"]),
        sweeps=[point_at(of(r["stacked"], label), 1e-4)["sweeps_in_a_step"] for label in ("X", "X stiff")],
        cost_of_stacked=costs(r["stacked"], SPEEDS, (1e-2, 1e-3, 1e-4, 1e-5, 1e-6)),
        cost_of_ball=costs(r["ball"], "error", (1e-1, 1e-2, 1e-3, 1e-4, 1e-6)), one_ball=at_rest(r["rest"]),
        column=at_rest(r["column"]), balls=[r[key][0]["balls"] for key in ("column", "lossless")], lossless=lossless,
        bounced=r["lossless"][0]["times"][-1], **verdicts(r))


LOOKS = {"C": ("orange", "square", True), "T": ("green", "triangle", True), "T soft": ("purple", "triangle", False),
         "F": ("sky_blue", "diamond", False), "P": ("blue", "circle", True), "X": ("vermilion", "circle", False),
         "X stiff": ("black", "circle", True)}  # each variant has one colour and marker in all figures


def series_of(variant, label="", style="line_with_points"):
    colour, marker, filled = LOOKS[variant.label]
    return Series(label or variant.name, style=style, colour=colour, marker=marker, filled=filled)


def f_over_p(plot):
    """F after P, with which it often coincides: its open marker or dashed line leaves P in sight."""
    where = {series.colour: k for k, series in enumerate(plot.series)}
    f, p = where.get("sky_blue"), where.get("blue")
    if f is not None and p is not None and f < p:
        plot.series[f], plot.series[p] = plot.series[p], plot.series[f]
    return plot


def ratio_plot(title, laws, low, high, key=RATIOS):
    plot = Plot(title, Axis("impact", 0, 21), Axis("energy after / energy before the impact", low, high),
                [Series(f"theory e² = {THEORY:.2f}", [0, 21], [THEORY, THEORY])])
    for law in laws:
        stiff = law["variant"].label == "X stiff"  # its markers would hide those of P
        series = series_of(law["variant"], style="dashed_line" if stiff else "line_with_points")
        series.x, series.y = list(range(1, len(law[key]) + 1)), law[key]
        plot.series.append(series)
    return plot


def phase_plot(title, fast, labels, depth):
    """The first impacts of some laws in the plane of depth and closing."""
    plot = Plot(title, Axis("depth d, diameters", 0, depth), Axis("closing in a step p + q, diameters", -0.5, 0.5))
    lines = [("s = 1, s = 0, s = -√(1 - a)", "", 1, "black"), ("", "s = 0", 0, "black"),
             ("", "s = -root(1 - a)", -math.sqrt(0.9), "black")]
    for label, name, slope, colour in lines + ([("s = 1/e (F)", "", 1 / E, "sky_blue")] if "F" in labels else []):
        end = min(depth, 0.5 / abs(slope)) if slope else depth
        plot.series.append(Series(label, [0, end], [0, slope * end], "dashed_line", colour, column=name))
    for law in (of(fast, label) for label in labels):
        series = series_of(law["variant"])
        for path in law["paths"][:8]:
            for depths, closing in (*path, (math.nan, math.nan)):
                series.x.append(depths)
                series.y.append(closing)
        series.filled = series.filled and law["variant"].label != "T"  # its only state coincides with another
        plot.series.append(series)
    return plot


def curve_plot(title, label, curves, x, y):
    name = "time step, s" if x == "time_step" else "time of computing, s"
    plot = Plot(title, Axis(name, logarithmic=True), Axis(label, logarithmic=True))
    for one in curves:
        special, points = one["label"] != one["variant"].label, [p for p in one["points"] if p[x] > 0 and p[y] > 0]
        if not points:
            continue
        series = series_of(one["variant"], one["label"] if special else "")
        series.x, series.y = [p[x] for p in points], [p[y] for p in points]
        if special and one["variant"].label == "C":
            series.filled, series.colour = False, "purple"
        plot.series.append(series)
    return f_over_p(plot)


def time_plot(title, label, least, laws, values):
    plot = Plot(title, Axis("time, s"), Axis(label, least, logarithmic=True))
    for law in laws:
        series = series_of(law["variant"], style="line")
        series.x, series.y = law["times"], [max(least, value) for value in values(law)]
        plot.series.append(series)
    return plot


def rest_plot(title, laws):
    plot = time_plot(title, "energy above rest, of weight times diameter", 1e-16, laws, lambda law: law["energies"])
    plot.series[2].style = "dashed_line"  # F
    return f_over_p(plot)


def plots(r):
    paper, error = "Fujioka & Ushijima (2005), Fig. ", "relative error of d'"
    slow, fast, stacked = r["slow_impacts"], r["fast_impacts"], r["stacked"]
    figure6 = phase_plot(paper + "6: fast impacts of C and X; in the wall for d > 1", fast, ["C", "X"], 1.3)
    figure6.vertical_lines = [(1, "", "black")]
    figure11 = curve_plot(paper + "11: parting time T0 of the stacked spheres", "relative error of T0", stacked,
                          "time_step", PARTINGS)
    ends = [stacked[0]["points"][k]["time_step"] for k in (-1, 0)]
    figure11.series.insert(0, Series("the paper's T0", ends, [ERROR_OF_31] * 2, "dashed_line"))
    ball = curve_plot("A bouncing ball over 3 s: error of the height against the rigid ball",
                      "rms error of the height, of the drop", r["ball"], "seconds", "error")
    ball.series[-1].label = "X, step 0.1 s, a = 1e4 to 1e12"
    return {
        "figure4": ratio_plot(paper + "4: slow impacts, steps of contact and parting", slow, 0.35, 0.6),
        "figure4_flights": ratio_plot(paper + "4: slow impacts, from flight to flight", slow, 0.35, 0.6,
                                      "energy_ratios_of_flights"),
        "figure5": ratio_plot(paper + "5: fast impacts; F, P and X lie on the line of theory", fast, 0.4, 0.7),
        "figure6": figure6,
        "figure7": phase_plot(paper + "7: fast impacts of T, F and P", fast, ["F", "P", "T soft", "T"], 0.6),
        "figure10": curve_plot(paper + "10: final speed d' of the stacked spheres", error, stacked, "time_step",
                               SPEEDS),
        "figure11": figure11,
        "stacked_cost": curve_plot("Stacked spheres: error of d' against the time of computing", error, stacked,
                                   "seconds", SPEEDS),
        "ball_cost": ball, "rest": rest_plot("One ball falls and comes to rest", r["rest"]),
        "column": rest_plot(f"{r['column'][0]['balls']} balls fall and settle", r["column"]),
        "lossless": time_plot(f"{r['lossless'][0]['balls']} balls that lose nothing (e = 1) fall and bounce",
                              "relative change of the energy", 1e-9, r["lossless"], lambda law: map(abs, changes(law)))}


def reproduce(options):
    r = compute(options.quick)

    def without(rows, *left_out):
        return [{key: value for key, value in row.items() if key not in ("variant", *left_out)} for row in rows]

    def curves(rows):
        return [{**one["variant"].head(), **without([one], "points")[0],
                 **{key: [p[key] for p in one["points"]] for key in one["points"][0] if key != "a"}} for one in rows]
    numbers = {"quick": options.quick, "table1": without(r["table1"]), "table2": without(r["table2"]),
               "exact_speed": EXACT_SPEED, "exact_parting_time": EXACT_PARTING, "stacked": curves(r["stacked"]),
               "bouncing_ball": curves(r["ball"]),
               "lossless": [{**law["variant"].head(), "energy_change": changes(law)[-1]} for law in r["lossless"]]}
    numbers.update({key: without(r[key], "paths") for key in ("slow_impacts", "fast_impacts")})
    numbers.update({key: without(r[key], "times", "energies") for key in ("rest", "column")})

    names = {"law": "law", "letter": "letter", "a": "a"}
    of_table1 = {**names, "time_step": "step_s", "evaluations": "evaluations",
                 "evaluations_gravity_first": "evaluations_gravity_first", "run_seconds": "run_s",
                 "law_alone_nanoseconds": "law_alone_ns"}
    tables = {table: {name: [row[key] for row in r[table]] for key, name in columns.items()}
              for table, columns in (("table1", of_table1), ("table2", names))}
    for k, step in enumerate(TABLE2_STEPS):
        tables["table2"][f"steps_at_{step:.0e}_s"] = [row["steps"][k] for row in r["table2"]]
    return Output(report(r), numbers, tables, plots(r))


FIGURES = ("figure4", "figure4_flights", "figure5", "figure6", "figure7", "figure10", "figure11", "stacked_cost",
           "ball_cost", "rest", "column", "lossless")
if __name__ == "__main__":
    common.main("fujioka2005", __doc__, reproduce,
                files=lambda options: ["table1.csv", "table2.csv", *(f"{name}.svg" for name in FIGURES)])
