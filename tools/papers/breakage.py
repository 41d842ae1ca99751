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
from scipy.optimize import minimize_scalar

from common import Output, eq, hexagonal_moduli, main, mean_of, moved_discs, power, samples_of
from shown import Row

# The share of the peak to which the load falls, at which tests are over; of plates with scattered strengths.
TEST_OVER, SCATTERED_TEST_OVER = 0.9, 0.7
# Notches: up to this share of the width; exponents of a alone are those of notches from so many distances on.
LARGEST_SHARE, LEAST_LENGTH = 0.6, 12
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


def griffith_toughness(ratio):
    """Two bonds break for each d of a crack along a row, each with the energy f_t²/(2 kN) at least, so that
    K² = E G >= E f_t²/(kN d)."""
    return math.sqrt(hexagonal_moduli(ratio)[2])


def toughness_within(radius, ratio):
    """K sqrt(d)/f_t of the infinite lattice: K of the field of a crack around its tip (Williams 1957) at which the
    first contact reaches f_t, of the lattice within a circle about the tip whose rim is moved by that field."""
    half_row, reach, rim = math.sqrt(3) / 4, int(radius) + 2, 2.5  # the rim has every contact of the discs inside
    rows, columns = np.meshgrid(np.arange(-2 * reach, 2 * reach + 1), np.arange(-reach, reach + 1), indexing="ij")
    places = np.stack([columns + np.where(rows % 2 == 0, 0, 0.5), half_row * (2 * rows + 1)], axis=-1).reshape(-1, 2)
    places = places[np.hypot(*places.T) < radius]
    found = eq.Assembly(places, 0.5, gap_tolerance=1e-3)
    i, j = found.contacts.T
    # The crack opens the row of triangles along y = 0 for x < 0: its contacts are missing.
    opened = (places[i, 1] * places[j, 1] < 0) & (places[i, 0] + places[j, 0] < 0)
    lattice = eq.Assembly(places, 0.5, found.contacts[~opened])
    _, G, _, nu = hexagonal_moduli(ratio)
    kappa = (3 - nu) / (1 + nu)
    held = np.flatnonzero(np.hypot(*places.T) > radius - rim)
    x, y = places[held].T
    half, size = 0.5 * np.arctan2(y, x), np.sqrt(np.hypot(x, y) / (2 * math.pi)) / (2 * G)
    moved = np.stack([size * np.cos(half) * (kappa - 1 + 2 * np.sin(half) ** 2),
                      size * np.sin(half) * (kappa + 1 - 2 * np.cos(half) ** 2)], axis=1)
    u = eq.solve(lattice, eq.Springs(1.0, float(ratio)), **moved_discs(held, moved)).displacements
    i, j = lattice.contacts.T
    return 1 / ((u[j] - u[i]) * lattice.normals).sum(axis=1).max()


def fit_shifted(half, y, slope=None):
    """Least squares y = A + p ln(a + c) with c where the sum of squares is least; the slope is found too where none is
    given. Returns A, p, c and their standard errors."""
    def line_at(shift):
        x = np.log(half + shift)
        p = np.polyfit(x, y, 1)[0] if slope is None else slope
        A = np.mean(y - p * x)
        return A, p, ((y - A - p * x) ** 2).sum()
    shift = minimize_scalar(lambda c: line_at(c)[2], bounds=(-0.9 * half[0], 3.0), method="bounded",
                            options={"xatol": 1e-10}).x
    A, p, square = line_at(shift)
    by = np.stack([np.ones(len(half)), np.log(half + shift), p / (half + shift)])  # derivatives by A, p and c
    by = by if slope is None else by[[0, 2]]
    error = np.sqrt(square / (len(y) - len(by)) * np.diag(np.linalg.inv(by @ by.T)))
    return Row(A=A, p=p, c=shift, A_error=error[0], p_error=error[1], c_error=error[-1])


def fit_of(own, lattice):
    """sigma sqrt(sec(pi a/W)) against a, over the plates of one lattice and size."""
    half = np.array([0.5 * one.notch_over_distance for one in own])
    y = np.log([one.toughness for one in own]) - 0.5 * np.log(math.pi * half)
    free, as_root = fit_shifted(half, y), fit_shifted(half, y, -0.5)
    toughness, plain = math.exp(as_root.A) * math.sqrt(math.pi), (0.0, 0.0)
    long = half >= LEAST_LENGTH / 2
    if long.sum() >= 3:
        line, covariance = np.polyfit(np.log(half[long]), y[long], 1, cov=True)
        plain = line[0], math.sqrt(covariance[0, 0])
    return Row(columns=own[0].columns, ratio=own[0].ratio, exponent=free.p, exponent_error=free.p_error,
               shift=as_root.c, shift_error=as_root.c_error, toughness=toughness,
               toughness_error=toughness * as_root.A_error, plain_exponent=plain[0], plain_exponent_error=plain[1],
               lattice=lattice, griffith=griffith_toughness(own[0].ratio))


def notches(size):
    places = [(columns, ratio, cut) for ratio in RATIOS for columns in size.widths
              for cut in (2, 3, 4, 6, 8, 12, 16, 24, 32, 48, 64, 96) if cut <= LARGEST_SHARE * columns]
    plates, fits = samples_of("notched plates:", notched_plate, places), []
    for ratio in RATIOS:
        # The field is that of a continuum at the rim: what it lacks there falls with the radius.
        lattice = 2 * toughness_within(2 * size.rim, ratio) - toughness_within(size.rim, ratio)
        fits += [fit_of([one for one in plates if (one.columns, one.ratio) == (columns, ratio)], lattice)
                 for columns in size.widths]
    return plates, fits


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
