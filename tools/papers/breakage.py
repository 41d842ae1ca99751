#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Strength of notched plates against the length of the notch, strength and scatter of samples by Weibull's law against
their size, each beside theory; energies."""
import functools
import math
import time

import numpy as np

from common import (DATA, Axis, Output, Plot, Series, columns_of, eq, fit_line, machine, main, markdown, mean_of, moved_discs,
                    points, samples_of)

# The share of the peak to which the load falls, at which tests are over; of plates with scattered strengths.
TEST_OVER, SCATTERED_TEST_OVER = 0.9, 0.7
# Lengths of notches: up to this share of the width; exponents of a alone are those of notches from so many distances on.
LARGEST_SHARE, LEAST_LENGTH = 0.6, 12
LOOKS = (("blue", "circle"), ("vermilion", "square"), ("green", "triangle"))


# ---- notches

@functools.lru_cache(1)
def plate(columns, ratio):
    block = eq.hexagonal(columns=columns, rows=4 * math.floor(columns / math.sqrt(3) + 0.5), radius=0.5)
    return len(block), eq.StrengthSample(block, eq.Springs(1e9, ratio * 1e9), fallen_to=TEST_OVER)


def notched_plate(arguments):
    """A plate of equal strengths with a notch of `cut` distances of neighbours in its middle."""
    columns, ratio, cut = arguments
    discs, sample = plate(columns, ratio)
    found = sample.strength(1.0, 1e6, notch=float(cut))
    # K = sigma sqrt(pi a sec(pi a/W)) (Feddersen 1966)
    toughness = found.stress * math.sqrt(math.pi * cut / 2 / math.cos(math.pi * cut / 2 / sample.width))
    return {"columns": columns, "discs": discs, "ratio": ratio, "notch_over_width": cut / sample.width,
            "notch_over_distance": float(cut), "strength": found.stress, "toughness": toughness, "energy_error": found.energy_error}


def moduli(ratio):
    """K and G of the lattice over kN."""
    return math.sqrt(3) / 2, math.sqrt(3) / 4 * (1 + ratio)


def griffith_toughness(ratio):
    """Two bonds break for each d of a crack along a row, each with the energy f_t²/(2 kN) at least, so that
    K² = E G >= E f_t²/(kN d), E = 4 K G/(K + G) in the plane."""
    K, G = moduli(ratio)
    return math.sqrt(4 * K * G / (K + G))


def toughness_within(radius, ratio):
    """K sqrt(d)/f_t of the infinite lattice: K of the field of a crack around its tip (Williams 1957) at which the first
    contact reaches f_t, of the lattice within a circle about the tip whose rim is moved by that field."""
    half_row, reach, rim = math.sqrt(3) / 4, int(radius) + 2, 2.5  # the rim has every contact of the discs inside
    rows, columns = np.meshgrid(np.arange(-2 * reach, 2 * reach + 1), np.arange(-reach, reach + 1), indexing="ij")
    places = np.stack([columns + np.where(rows % 2 == 0, 0, 0.5), half_row * (2 * rows + 1)], axis=-1).reshape(-1, 2)
    places = places[np.hypot(*places.T) < radius]
    found = eq.Assembly(places, 0.5, gap_tolerance=1e-3)
    i, j = found.contacts[:, 0], found.contacts[:, 1]
    # The crack opens the row of triangles along y = 0 for x < 0: its contacts are missing.
    opened = (places[i, 1] * places[j, 1] < 0) & (places[i, 0] + places[j, 0] < 0)
    held = np.flatnonzero(np.hypot(*places.T) > radius - rim)
    contacts = found.contacts[~opened]
    lattice = eq.Assembly(places, 0.5, contacts)
    K, G = moduli(ratio)
    nu = (K - G) / (K + G)
    kappa = (3 - nu) / (1 + nu)
    at = places[held]
    half, size = 0.5 * np.arctan2(at[:, 1], at[:, 0]), np.sqrt(np.hypot(*at.T) / (2 * math.pi)) / (2 * G)
    moved = np.stack([size * np.cos(half) * (kappa - 1 + 2 * np.sin(half) ** 2),
                      size * np.sin(half) * (kappa + 1 - 2 * np.cos(half) ** 2)], axis=1)
    u = eq.solve(lattice, eq.Springs(1.0, float(ratio)), **moved_discs(held, moved)).displacements
    pairs = lattice.contacts
    stretch = ((u[pairs[:, 1]] - u[pairs[:, 0]]) * lattice.normals).sum(axis=1)
    return 1 / stretch.max()


def lattice_toughness(ratio, quick):
    # The field is that of a continuum at the rim: what it lacks there falls with the radius.
    near = 20 if quick else 40
    return 2 * toughness_within(2 * near, ratio) - toughness_within(near, ratio)


def fit_shifted(half, y, slope=None):
    """Least squares y = A + p ln(a + c) with c where the sum of squares is least; the slope is found too where none is
    given. Returns {"A", "p", "c": (number, standard error)}."""
    half, y = np.asarray(half), np.asarray(y)

    def line_at(shift):
        x = np.log(half + shift)
        if slope is None:
            line = fit_line(x, y, np.ones(len(y)))
            A, p = line.intercept, line.slope
        else:
            A, p = np.mean(y - slope * x), slope
        return A, p, ((y - A - p * x) ** 2).sum()

    low, high, golden = -0.9 * half[0], 3.0, 0.5 * (math.sqrt(5) - 1)
    for _ in range(100):
        first, second = high - golden * (high - low), low + golden * (high - low)
        low, high = (low, second) if line_at(first)[2] < line_at(second)[2] else (first, high)
    shift = 0.5 * (low + high)
    A, p, square = line_at(shift)
    by = np.stack([np.ones(len(half)), np.log(half + shift), p / (half + shift)])  # derivatives by A, p and c
    by = by if slope is None else by[[0, 2]]
    error = np.sqrt(square / (len(y) - len(by)) * np.diag(np.linalg.inv(by @ by.T)))
    return {"A": (A, error[0]), "p": (p, error[1] if slope is None else 0.0), "c": (shift, error[-1])}


def fit_of(plates, columns, ratio, lattice):
    """sigma sqrt(sec(pi a/W)) against a, over the plates of one lattice and size."""
    own = [one for one in plates if one["columns"] == columns and one["ratio"] == ratio]
    half = np.array([0.5 * one["notch_over_distance"] for one in own])
    y = np.log([one["toughness"] for one in own]) - 0.5 * np.log(math.pi * half)
    free, as_root = fit_shifted(half, y), fit_shifted(half, y, -0.5)
    toughness = math.exp(as_root["A"][0]) * math.sqrt(math.pi)
    fit = {"columns": columns, "ratio": ratio, "exponent": free["p"][0], "exponent_error": free["p"][1],
           "shift": as_root["c"][0], "shift_error": as_root["c"][1], "toughness": toughness,
           "toughness_error": toughness * as_root["A"][1], "plain_exponent": 0.0, "plain_exponent_error": 0.0,
           "lattice": lattice, "griffith": griffith_toughness(ratio)}
    long = half >= LEAST_LENGTH / 2
    if long.sum() >= 3:
        x, values = np.log(half[long]), y[long]
        line = fit_line(x, values, np.ones(len(x)))
        square = ((values - line.intercept - line.slope * x) ** 2).sum()
        fit["plain_exponent"] = line.slope
        fit["plain_exponent_error"] = line.slope_error * math.sqrt(square / (len(x) - 2))
    return fit


def notches(quick):
    sizes, cuts = [21, 41] if quick else [41, 81, 121], [2, 3, 4, 6, 8, 12, 16, 24, 32, 48, 64, 96]
    plates = samples_of("notched plates:", notched_plate, [(columns, ratio, cut) for ratio in (0.0, 0.4) for columns in sizes
                                                          for cut in cuts if cut <= LARGEST_SHARE * columns])
    fits = []
    for ratio in (0.0, 0.4):
        lattice = lattice_toughness(ratio, quick)
        fits += [fit_of(plates, columns, ratio, lattice) for columns in sizes]
    return plates, fits


# ---- Weibull

@functools.lru_cache(1)
def sample_of(kind, n):
    springs = eq.Springs(1e9, 0.4e9)
    if kind == "plates":
        block = eq.hexagonal(columns=n, rows=n, radius=0.5)
        return len(block.contacts), eq.StrengthSample(block, springs, fallen_to=SCATTERED_TEST_OVER)
    # Discs in a row, pulled along x with rotations restrained.
    centres = np.stack([np.arange(n + 1.0), np.zeros(n + 1)], axis=1)
    chain = eq.Assembly(centres, 0.5, np.stack([np.arange(n), np.arange(1, n + 1)], axis=1))
    return n, eq.StrengthSample(chain, springs, axis="x", fallen_to=TEST_OVER, rotation="restrained")


def scattered(arguments):
    kind, n, modulus, seed = arguments
    contacts, sample = sample_of(kind, n)
    found = sample.strength(1.0, 2.0, friction=0.5, weibull_modulus=modulus, seed=int(1e6 * modulus) + seed)
    return contacts, found.stress * (sample.width if kind == "chains" else 1.0), found.energy_error


def weibull(kind, sizes, seeds):
    """Strengths over f_t of chains, times the distance of neighbours of plates."""
    rows = []
    for modulus in (2, 4, 8):
        for n in sizes:
            found = samples_of(f"{kind} of {n}, m = {modulus}:", scattered, [(kind, n, modulus, seed) for seed in range(seeds)])
            mean = mean_of([strength for _, strength, _ in found])
            one = {"modulus": float(modulus), "contacts": found[0][0], "samples": seeds, "strength": mean.mean,
                   "standard_error": mean.standard_error, "standard_deviation": mean.standard_deviation}
            if kind == "chains":
                one["weakest_link"] = math.gamma(1 + 1 / modulus) * n ** (-1 / modulus)
            rows.append({**one, "energy_error": max(error for _, _, error in found)})
    return rows


# ---- plots and page

def notch_plot(plates, fits):
    series = []
    for (colour, marker), fit in zip(LOOKS, [fit for fit in fits if fit["ratio"]]):
        own = [one for one in plates if one["columns"] == fit["columns"] and one["ratio"] == fit["ratio"]]
        x = [one["notch_over_distance"] for one in own]
        theory = [one["strength"] * fit["toughness"] / one["toughness"] * math.sqrt(length / (length + 2 * fit["shift"]))
                  for one, length in zip(own, x)]
        label = "" if series else "K/sqrt(pi (a + c) sec(pi a/W)), K and c of each size"
        series += [Series(label, x, theory, colour=colour, column=f"theory {fit['columns']}"),
                   points(f"{fit['columns']} discs wide, kT/kN = {fit['ratio']:g}", x, [one["strength"] for one in own], colour, marker)]
    return Plot("Strength of plates with a notch in the middle",
                Axis("length of the notch 2a over the distance d of neighbours", logarithmic=True),
                Axis("strength sigma d / $f_t$", logarithmic=True), series)


def weibull_plot(chains, plates, scatter):
    series, key = [], "standard_deviation" if scatter else "strength"
    for rows, kind in ((chains, "chains"), (plates, "plates")):
        for (colour, marker), m in zip(LOOKS, (2, 4, 8)):
            own = [one for one in rows if one["modulus"] == m]
            x = [one["contacts"] for one in own]
            if kind == "chains":
                spread = math.sqrt(math.gamma(1 + 2 / m) / math.gamma(1 + 1 / m)**2 - 1) if scatter else 1
                series.append(Series("" if series else "weakest link", x, [one["weakest_link"] * spread for one in own],
                                     colour=colour, column=f"weakest link {m}"))
            series.append(points(f"{kind}, m = {m}", x, [one[key] for one in own], colour, marker, filled=kind == "plates",
                                 joined=kind == "plates"))
    what = "standard deviation" if scatter else "mean strength"
    return Plot("Scatter of the strength" if scatter else "Mean strength", Axis("number of contacts", logarithmic=True),
                Axis(f"{what} over $f_t$ (plates: times d)", logarithmic=True), series)


def with_error(value, error):
    return f"{value:.4f} ± {error:.4f}" if math.isfinite(error) else f"{value:.4f}"


def fits_text(fits):
    head = ["discs wide", "kT/kN", "exponent of a", "exponent of a + c", "c/d", "K_Ic sqrt(d)/f_t", "infinite lattice", "least by energy"]
    return markdown(head, [
        [str(fit["columns"]), f"{fit['ratio']:g}",
         with_error(fit["plain_exponent"], fit["plain_exponent_error"]) if fit["plain_exponent"] else "-",
         with_error(fit["exponent"], fit["exponent_error"]), with_error(fit["shift"], fit["shift_error"]),
         with_error(fit["toughness"], fit["toughness_error"]), f"{fit['lattice']:.4f}", f"{fit['griffith']:.4f}"] for fit in fits])


def sizes_text(rows):
    theory = "weakest_link" in rows[0]
    return markdown(["m", "contacts", "mean strength", *["weakest link", "standard errors apart"] * theory, "standard deviation",
                     "over the mean"], [
        [f"{one['modulus']:g}", str(one["contacts"]), with_error(one["strength"], one["standard_error"]),
         *([f"{one['weakest_link']:.4f}", f"{(one['strength'] - one['weakest_link']) / one['standard_error']:.1f}"] if theory else []),
         f"{one['standard_deviation']:.4f}", f"{one['standard_deviation'] / one['strength']:.3f}"] for one in rows])


def weakening_text(plates):
    """Exponents of the mean strength of plates between the two smallest and the two largest sizes, and of its scatter
    between the smallest and the largest."""
    def exponent(a, b, key):
        return f"{math.log(b[key] / a[key]) / math.log(b['contacts'] / a['contacts']):.3f}"
    rows = []
    for m in (2, 4, 8):
        own = [one for one in plates if one["modulus"] == m]
        rows.append([str(m), f"{-1 / m:.3f}", exponent(own[0], own[1], "strength"), exponent(own[-2], own[-1], "strength"),
                     exponent(own[0], own[-1], "standard_deviation")])
    return markdown(["m", "weakest link, -1/m", "exponent, two smallest", "two largest", "exponent of the scatter"], rows)


def reproduce(options):
    quick = options.quick
    seeds, columns = (20, [6, 12]) if quick else (100, [6, 12, 24, 48])
    times = [time.monotonic()]
    plates, fits = notches(quick)
    times.append(time.monotonic())
    chains = weibull("chains", [1, 4, 16, 64, 256], 4 * seeds)  # which take no time
    times.append(time.monotonic())
    samples = weibull("plates", columns, seeds)
    times.append(time.monotonic())
    error = max(one["energy_error"] for rows in (plates, chains, samples) for one in rows)
    page = (DATA / "breakage" / "page.md").read_text(encoding="utf-8").format(
        command=f"tools/papers/breakage.py{' --quick' if quick else ''} --out DIR", machine=machine(), test_over=100 * TEST_OVER,
        scattered_test_over=100 * SCATTERED_TEST_OVER, fits=fits_text(fits), count=len(plates), seconds=np.diff(times),
        chain_seeds=4 * seeds, seeds=seeds, chains=sizes_text(chains), plates=sizes_text(samples),
        weakening=weakening_text(samples), error=error)
    return Output(page, {"quick": quick, "fits": fits, "chains": chains, "plates": samples, "energies": {"error": error}},
                  {"notches_values": columns_of(plates), "weibull_chains_values": columns_of(chains),
                   "weibull_plates_values": columns_of(samples)},
                  {"notches": notch_plot(plates, fits), "weibull_mean": weibull_plot(chains, samples, False),
                   "weibull_scatter": weibull_plot(chains, samples, True)}, {"breakage.md": page})


if __name__ == "__main__":
    main("breakage", __doc__, reproduce, files=lambda options: ["breakage.md", "notches_values.csv", "weibull_chains_values.csv",
                                                                "weibull_plates_values.csv"])
