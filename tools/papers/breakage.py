#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Strength of notched plates against the length of the notch, strength and scatter of samples by Weibull's law against
their size, each beside theory; energies.

Example:
  tools/papers/breakage.py --out figures      minutes; with --quick one
"""
import functools
import math
import time

import numpy as np
from scipy.optimize import curve_fit

from common import Output, eq, hexagonal_moduli, main, mean_of, power, rows_of, samples_of
from shown import Row

# The share of the peak to which the load falls, at which tests are over; of plates with scattered strengths.
TEST_OVER, SCATTERED_TEST_OVER = 0.9, 0.7
# Notches: up to this share of the width; exponents of a alone are those of notches from so many distances on.
LARGEST_SHARE, LEAST_LENGTH = 0.6, 12
# K sqrt(d)/f_t of the infinite lattice at each kT/kN, a stored result.
LATTICE = {row.ratio: row for row in rows_of("breakage/lattice_toughness", "date", "commit")}
RATIOS, MODULI = (0.0, 0.4), (2, 4, 8)  # kT/kN of notched plates; Weibull moduli


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
    return Row(columns=columns, discs=discs, ratio=ratio, notch_over_width=cut / sample.width,
               notch_over_distance=float(cut), strength=found.stress, toughness=toughness,
               energy_error=found.energy_error)


def fit_shifted(half, y, slope=None):
    """Least squares y = A + p ln(a + c), of a given slope p or of the best one: A, p, c and their standard errors."""
    free = slope is None

    def line(a, A, c, p=slope):
        return A + p * np.log(a + c)
    found, covariance = curve_fit(line, half, y, [y[0], 0.1, -0.5][:2 + free], xtol=1e-14, ftol=1e-14)
    names, errors = "Acp", np.sqrt(np.diag(covariance))
    return Row({"p": slope, **dict(zip(names, found)), **{name + "_error": one for name, one in zip(names, errors)}})


def fit_of(own):
    """sigma sqrt(sec(pi a/W)) against a, over the plates of one lattice and size."""
    half = np.array([0.5 * one.notch_over_distance for one in own])
    y = np.log([one.toughness for one in own]) - 0.5 * np.log(math.pi * half)
    free, as_root = fit_shifted(half, y), fit_shifted(half, y, -0.5)
    toughness, plain = math.exp(as_root.A) * math.sqrt(math.pi), (0.0, 0.0)
    long = half >= LEAST_LENGTH / 2
    if long.sum() >= 3:
        line, covariance = np.polyfit(np.log(half[long]), y[long], 1, cov=True)
        plain = line[0], math.sqrt(covariance[0, 0])
    # Two bonds break for each d of a crack along a row, each with the energy f_t²/(2 kN) at least: K² >= E f_t²/(kN d).
    griffith = math.sqrt(hexagonal_moduli(own[0].ratio)[2])
    return Row(columns=own[0].columns, ratio=own[0].ratio, exponent=free.p, exponent_error=free.p_error,
               shift=as_root.c, shift_error=as_root.c_error, toughness=toughness,
               toughness_error=toughness * as_root.A_error, plain_exponent=plain[0], plain_exponent_error=plain[1],
               lattice=LATTICE[own[0].ratio].toughness, griffith=griffith)


def notches(size):
    places = [(columns, ratio, cut) for ratio in RATIOS for columns in size.widths
              for cut in (2, 3, 4, 6, 8, 12, 16, 24, 32, 48, 64, 96) if cut <= LARGEST_SHARE * columns]
    plates = samples_of("notched plates:", notched_plate, places)
    return plates, [fit_of([one for one in plates if (one.columns, one.ratio) == (columns, ratio)])
                    for ratio in RATIOS for columns in size.widths]


# ---- Weibull

@functools.lru_cache(1)
def sample_of(kind, n):
    """Number of contacts, sample."""
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
    for m, n in ((m, n) for m in MODULI for n in sizes):
        contacts, strengths, errors = zip(*samples_of(f"{kind} of {n}, m = {m}:", scattered,
                                                      [(kind, n, m, seed) for seed in range(seeds)]))
        mean = mean_of(strengths)
        weakest = {"weakest_link": math.gamma(1 + 1 / m) * n ** (-1 / m)} if kind == "chains" else {}
        rows.append(Row(modulus=float(m), contacts=contacts[0], samples=seeds, strength=mean.mean,
                        standard_error=mean.standard_error, standard_deviation=mean.standard_deviation, **weakest,
                        energy_error=max(errors)))
    return rows


# ---- figures and page

def scatter_over_mean(m):
    """Of a chain: standard deviation over the mean."""
    return math.sqrt(math.gamma(1 + 2 / m) / math.gamma(1 + 1 / m)**2 - 1)


def exponent(a, b, key):
    """Of a number of samples against their contacts, between two sizes."""
    return f"{power([a.contacts, b.contacts], [a[key], b[key]]):.3f}"


def reproduce(options, _page):
    size, times = options.size, [time.monotonic()]
    plates, fits = notches(size)
    times.append(time.monotonic())
    chains = weibull("chains", [1, 4, 16, 64, 256], 4 * size.seeds)  # which take no time
    times.append(time.monotonic())
    samples = weibull("plates", size.columns, size.seeds)
    times.append(time.monotonic())
    error = max(one.energy_error for one in (*plates, *chains, *samples))
    names = {**locals(), "seconds": np.diff(times), "by_modulus": [
        (m, [one for one in samples if one.modulus == m]) for m in MODULI]}
    numbers = {"fits": fits, "chains": chains, "plates": samples, "energies": {"error": error}}
    return Output(names, numbers, {"notches_values": plates, "weibull_chains_values": chains,
                                   "weibull_plates_values": samples})


if __name__ == "__main__":
    main(reproduce)
