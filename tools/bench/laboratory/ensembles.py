# SPDX-License-Identifier: GPL-3.0-or-later
"""Tests of the laboratory on several samples each: means with their standard errors, and how they change with the size of the sample.
Each function takes the laboratory of page.py and returns rows of a table, or numbers."""

import json
import math
import sys
from pathlib import Path

import numpy

import at_rest
import readings
import samples

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "peers"))
from common import call  # noqa: E402

CASES = Path(__file__).resolve().parents[3] / "data" / "cases"
SAND_SEEDS, STIFFNESS_SEEDS, ROCK_SEEDS, HEAP_SEEDS = range(1, 9), range(1, 5), range(4, 8), range(3, 9)
ROCK_SIZES, DISC_SIZES = (200, 800, 3200), (300, 1200, 4800)
FRICTIONS = (0.05, 0.1, 0.2, 0.3, 0.5, 0.8)
ROLLING_FRICTIONS = (0.05, 0.1, 0.2, 0.4, 0.8)
PROBE = 0.24  # half the side of the square in which the Brazilian stress is read, over the radius of the disc


def mean_and_error(values):
    values = numpy.asarray(values)
    return float(values.mean()), float(values.std(ddof=1) / math.sqrt(len(values)))


def sample(lab, name, discs, contacts=None):
    """The settings of a case that takes a sample in place of its own."""
    samples.write(lab.folder, name, discs, contacts)
    settings = [f'grains.path="{lab.folder / name}.csv"']
    return settings + ([f'bonds.path="{lab.folder / name}_bonds.csv"'] if contacts else [])


def sand(lab):
    """Folders of the biaxial test and of the shear box on the same loose samples."""
    taken = [sample(lab, f"sand{seed}_sample", samples.sand(lab.equidem, seed)) for seed in SAND_SEEDS]
    return [lab.run("biaxial", *settings)[0] for settings in taken], [lab.run("shear_box", *settings)[0] for settings in taken]


def small_strain(lab):
    """Of each sample (E, nu): slopes of the axial stress and of the strain across over that along, at a constant side stress, in two ranges
    of strain; the same by statics of the packing at rest between the same plates; and by homogenize, the boundary moved as a whole."""
    found = []
    for seed in STIFFNESS_SEEDS:
        settings = sample(lab, f"sand{seed}_sample", samples.sand(lab.equidem, seed))
        held, _, _ = lab.run("biaxial", *settings, "stage.2.until.strain=1e-8")
        sheared, _, _ = lab.run("biaxial", *settings, "stage.2.wall.0.velocity=[0.0,1e-4]", "stage.2.wall.1.velocity=[0.0,-1e-4]",
                                "stage.2.until.strain=1e-4", "output.probe_interval=2e-4")
        packing = at_rest.Packing(held)
        found.append([readings.small_strain(sheared, 1e-5, 3e-5), readings.small_strain(sheared, 3e-5, 1e-4),
                      packing.between_plates(lab.equidem, call), packing.homogenized(lab.equidem, call)])
    return found


def rock(lab):
    """Over the sizes, of each sample: E and nu of the gauges, E of homogenize of the sample; and E, nu of periodic cells."""
    def homogenized(grains, seed, *settings):
        width, height = (side * math.sqrt(grains / samples.ROCK_GRAINS) for side in samples.ROCK)
        words = (f"packing.grains={grains}", f"packing.box=[{width},{height}]", f"packing.seed={seed}", *settings)
        text = call([lab.equidem, "homogenize", CASES / "lab_rock.toml", "--json", "-", "--quiet", *(part for word in words for part in ("--set", word))])
        return [json.loads(text)[name]["plane_stress"] for name in ("young_modulus", "poisson_ratio")]

    sizes = {}
    for grains in ROCK_SIZES:
        scale = math.sqrt(grains / samples.ROCK_GRAINS)
        width, height = (side * scale for side in samples.ROCK)
        rows = []
        for seed in ROCK_SEEDS:
            settings = sample(lab, f"rock{grains}_{seed}_sample", *samples.rock(lab.equidem, grains, seed))
            # A larger rock is pressed for longer, so that it is as near to rest, to the same strain.
            out, _, _ = lab.run("unconfined", *settings, "strength=none", f"wall.1.point=[0.0,{height + 1e-6}]", f"wall.0.displacement={2.5e-4 * scale}",
                                f"wall.1.displacement={2.5e-4 * scale}", f"schedule.0.times=[0.0,{1e-3 * scale},{1e-2 * scale}]",
                                f"run.duration={2.4e-3 * scale}", f"output.probe_interval={2e-5 * scale}")
            read = readings.elastic_gauges(out, width)
            rows.append([read["young_modulus"], read["poisson_ratio"], *homogenized(grains, seed)])
        sizes[width] = numpy.array(rows)
    cells = numpy.array([homogenized(samples.ROCK_GRAINS, seed, 'packing.sides="periodic"') for seed in ROCK_SEEDS])
    return sizes, cells


def line_in_inverse(widths, means, errors):
    """a, its error and b of a (1 - b/W) by weighted least squares."""
    weights = 1 / numpy.asarray(errors)
    (slope, limit), covariance = numpy.polyfit(1 / numpy.asarray(widths), means, 1, w=weights, cov="unscaled")
    return float(limit), float(math.sqrt(covariance[1, 1])), float(-slope / limit)


def brazilian(lab):
    """Over the diameters, of each sample: the stresses across and along the loaded diameter in a square about the centre over 2P/(pi D)."""
    sizes = {}
    for grains in DISC_SIZES:
        scale = math.sqrt(grains / samples.DISC_GRAINS)
        radius = samples.RADIUS * scale
        end, side = radius * math.cos(samples.HALF_ANGLE), PROBE * radius
        rows = []
        for seed in range(6, 10):
            settings = sample(lab, f"disc{grains}_{seed}_sample", *samples.brazilian(lab.equidem, grains, seed))
            out, _, _ = lab.run("brazilian", *settings, "strength=none", f"wall.0.point=[0.0,{-end}]", f"wall.1.point=[0.0,{end}]",
                                f"wall.0.displacement={1.5e-4 * scale}", f"wall.1.displacement={1.5e-4 * scale}",
                                f"schedule.0.times=[0.0,{1e-3 * scale},{1e-2 * scale}]", f"run.duration={2e-3 * scale}",
                                f"probe.0.box=[{-side},{-side},{side},{side}]", f"output.probe_interval={2e-5 * scale}")
            rows.append(readings.stress_at_the_centre(out, 2 * radius))
        sizes[2 * radius] = numpy.array(rows)
    return sizes


def repose(lab):
    """Angles of the slopes of the samples over the friction, and over the rolling friction of discs with friction 0.5."""
    taken = [sample(lab, f"heap{seed}_sample", samples.heap(lab.equidem, seed)) for seed in HEAP_SEEDS]

    def angles(*contact):
        return [readings.slope(lab.run("repose", *settings, *contact)[0])["angle"] for settings in taken]

    return ({friction: angles(f"collisions.friction={friction}") for friction in FRICTIONS},
            {rolling: angles(f"collisions.rolling_friction={rolling}", "collisions.rolling_damping=0.3") for rolling in ROLLING_FRICTIONS})
