#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""A question that Abe (1996) leaves open: how far his mean field, eqs. (21) and (22), and the correction (11) are from
the exact moduli of random assemblies, over disorder, kT/kN and weightings.

Example:
  tools/papers/abe1996_random.py --out figures      minutes; with --quick seconds
"""
import dataclasses
import math

import numpy as np

from common import Output, eq, main, mean_of, means_of, moduli_of, power, seeds_of
from shown import Row, aligned

WEIGHTINGS = ("uniform", "contact_density", "voronoi", "local_contact_density")
RADIUS = 0.005  # m


@dataclasses.dataclass
class Family:
    """Random assemblies of one kind: periodic Delaunay cells of equal discs. Points are moved to (stretch x, y/stretch)
    before triangulation: anisotropic unless 1."""
    name: str
    points: str = "perturbed_hexagonal"
    disorder: float = 0.0
    stretch: float = 1.0
    geometry: Row | None = None

    def __post_init__(self):
        self.lattice, self.isotropic = self.points == "perturbed_hexagonal", self.stretch == 1
        self.random = not self.lattice or self.disorder > 0

    def cell(self, discs, seed):
        keys = {"disorder": self.disorder} if self.lattice else {}
        made = eq.delaunay(discs=discs, points=self.points, seed=seed, radius=RADIUS, periodic=True, **keys)
        by = np.array([self.stretch, 1 / self.stretch])
        return made if self.isotropic else eq.triangulated(made.centres * by, made.radii, cell=tuple(by * made.cell))


# ---- cells and their means

def mean_field(ratio, weighting, phi, z):
    """nu = (1 - kT/kN)/4 (22); K = phi z/(2 pi) kN for equal springs (21); with the correction (11), springs k/psi,
    psi of all discs or of the two of a contact, K = phi kN; with springs k h/l, whose facets obey sum h l = 2 A,
    K = kN/2."""
    bulk = {"uniform": phi * z / (2 * math.pi), "voronoi": 0.5}.get(weighting, phi)
    nu = (1 - ratio) / 4
    return bulk, bulk * (1 - 2 * nu), nu


def compute_cell(arguments):
    """Geometry: scatter of branch lengths over their mean, of the contacts of a disc, anisotropy sqrt(a_2² + b_2² +
    a_4² + b_4²) of psi(theta), phi, z. Points: K and G in kN and nu of plane strain of each answer, errors of the mean
    field (G and K over the exact one, less 1; nu less the exact one), anisotropy of the exact tensor. Words where the
    cell has no moduli."""
    family, discs, places, seed = arguments
    points = []
    try:
        cell = family.cell(discs, seed)
        phi, z = cell.solid_fraction, cell.coordination_number
        for weighting, ratio in places:
            springs = eq.Springs(kN=1.0, kT=ratio, weighting=weighting)
            found = eq.homogenize(cell, springs, homogenize={"bounds": "affine"})
            answers = {"exact": moduli_of(found.stiffness), "mean_field": mean_field(ratio, weighting, phi, z),
                       "voigt": moduli_of(found.bounds.voigt),
                       "uniform_stress": moduli_of(found.bounds.uniform_stress_estimate)}
            (K, G, nu), (K_field, G_field, nu_field) = answers["exact"], answers["mean_field"]
            points.append({**{f"{modulus}_{name}": value for name, values in answers.items()
                              for modulus, value in zip(("K", "G", "nu"), values)},
                           "K_error": K_field / K - 1, "G_error": G_field / G - 1, "nu_error": nu_field - nu,
                           "anisotropy": found.anisotropy})
    except (eq.BadInput, eq.ComputationFailed) as error:
        return f"{family.name}, seed {seed}: {error}"
    branches = cell.levers.sum(axis=1)
    return {"branches": branches.std(ddof=1) / branches.mean(), "phi": phi, "z": z,
            "contacts": np.bincount(cell.contacts.ravel(), minlength=len(cell)).std(ddof=1),
            "uneven": math.hypot(found.fabric.anisotropy_2, found.fabric.anisotropy_4)}, points


class Result:
    """`points`: mean over the cells, error (standard) and deviation of each family, weighting and ratio."""
    def __init__(self, size):
        self.refusals, self.points, self.ratios = [], [], size.ratios
        self.families = [*(Family(f"hexagonal, disorder {d:g}", disorder=d) for d in size.disorders),
                         Family("Poisson-disc", "poisson_disc"), Family("random", "random"),
                         Family("Poisson-disc, stretched", "poisson_disc", stretch=1.2)]
        places = [(weighting, ratio) for weighting in WEIGHTINGS for ratio in size.ratios]
        for family in self.families:
            found = seeds_of(f"homogenizing {family.name}:", compute_cell, size.samples, family, size.discs, places)
            self.refusals += [one for one in found if isinstance(one, str)]
            cells = [one for one in found if not isinstance(one, str)]
            if not cells:
                raise eq.ComputationFailed(f"none of the cells of '{family.name}' has moduli",
                                           "the first: " + self.refusals[-1], "", "")
            family.geometry = Row({key: one.mean for key, one in means_of([cell[0] for cell in cells]).items()})
            for (weighting, ratio), samples in zip(places, zip(*(points for _, points in cells))):
                means = means_of(samples)
                self.points.append(Row(family=family, weighting=weighting, ratio=ratio, **{
                    name: Row({key: one[what] for key, one in means.items()}) for name, what in (
                        ("mean", "mean"), ("error", "standard_error"), ("deviation", "standard_deviation"))}))
        # The two least disordered lattices; the isotropic family with the widest scatter of branch lengths.
        self.small, self.large = [family for family in self.families if family.lattice and family.random][:2]
        self.widest = max((family for family in self.families if family.isotropic),
                          key=lambda family: family.geometry.branches)
        self.middle = size.ratios[len(size.ratios) // 2]

    def of(self, weighting, family=None, ratio=None, anisotropic=False):
        """The points of a weighting on isotropic random families, or on all random ones, or on one family."""
        return [p for p in self.points if p.weighting == weighting and (ratio is None or p.ratio == ratio) and
                (p.family is family if family else p.family.random and (anisotropic or p.family.isotropic))]

    # ---- words and tables of the report

    def grid(self, weighting, title, number):
        """Families downwards, kT/kN to the right; means over the cells."""
        def told(value):
            return f"{value:.4f}" if number == "nu_exact" else f"{100 * value:+.2f} %"
        rows = [["kT/kN", *(f"{ratio:g}" for ratio in self.ratios)]]
        for family in self.families:
            values = [p.mean[number] for p in self.of(weighting, family)]
            rows.append([family.name, *(told(0.0 if abs(value) < 5e-5 else value) for value in values)])  # no sign
        if number == "nu_exact":
            rows.append(["mean field (1 - kT/kN)/4", *(told((1 - ratio) / 4) for ratio in self.ratios)])
        error = max(p.error[number] for p in self.points if p.weighting == weighting)
        end = f"{error:.2g}" if number == "nu_exact" else f"{100 * error:.2g} %"
        return f"{title} (standard errors up to {end})\n{aligned(rows)}\n"

    def range_of_error(self, weighting, modulus):
        points = sorted(self.of(weighting), key=lambda p: p.mean[modulus + "_error"])
        most = largest(points, modulus + "_error")
        if clean(most) == 0:
            return f"none: exact within {most:.0e}"
        least, most = (p.mean[modulus + "_error"] for p in (points[0], points[-1]))
        least, most = (f"{value:+.4f}" if modulus == "nu" else percent(value) for value in (least, most))
        return f"from {least} ({place(points[0])}) to {most} ({place(points[-1])})"

    def growth(self, weighting, number):
        """The exponent p of |error| ~ disorder^p between the two least disordered lattices, at the least kT/kN."""
        families = self.small, self.large
        return power([family.disorder for family in families],
                     [self.of(weighting, family)[0].mean[number] for family in families])

    def change_of_G(self, weighting, first, second):
        """From one answer to another, at the middle kT/kN."""
        mean = self.of(weighting, self.widest, self.middle)[0].mean
        return percent(mean["G_" + second] / mean["G_" + first] - 1)

    def summed_anisotropy(self, weighting):
        return sum(p.mean.anisotropy for p in self.of(weighting, self.families[-1]))

    def best(self, number):
        return min(WEIGHTINGS, key=lambda weighting: rms(self.of(weighting), number))

    def most(self, weighting):
        """The point with the largest nu, of all random families."""
        return max(self.of(weighting, anisotropic=True), key=lambda p: p.mean.nu_exact)

    def error_at(self, weighting, modulus, ratio):
        error = rms(self.of(weighting, ratio=ratio), modulus + "_error")
        return f"{error:.4f}" if modulus == "nu" else f"{100 * error:.2f}"

    def beyond(self):
        """Points at which the correction (11) changes nu by more than two standard errors."""
        return sum(abs(c.mean.nu_exact - u.mean.nu_exact) > 2 * math.hypot(c.error.nu_exact, u.error.nu_exact)
                   for u, c in zip(self.of("uniform"), self.of("contact_density")))

    def inside_bounds(self):
        tiny, points = 1e-12, [p.mean for weighting in WEIGHTINGS for p in self.of(weighting, anisotropic=True)]
        return Row(count=len(points), below=sum(p.G_exact <= p.G_voigt * (1 + tiny) for p in points),
                   above=sum(p.G_exact >= p.G_uniform_stress * (1 - tiny) for p in points),
                   between=sum(min(p.nu_voigt, p.nu_uniform_stress) - tiny <= p.nu_exact <=
                               max(p.nu_voigt, p.nu_uniform_stress) + tiny for p in points))

    def table(self):
        """mean_field.csv: one row for each point."""
        names = [(f"{modulus}_{answer}", "" if modulus == "nu" else "_over_kN", answer == "exact")
                 for modulus in ("nu", "G", "K") for answer in ("exact", "mean_field", "voigt", "uniform_stress")
                 if (modulus, answer) != ("K", "uniform_stress")]
        names += [(name, "", True) for name in ("nu_error", "G_error", "K_error", "anisotropy")]
        rows = []
        for p in self.points:
            row = {"points": p.family.points, "disorder": p.family.disorder, "stretch": p.family.stretch,
                   "weighting": p.weighting, "branch_scatter": p.family.geometry.branches, "kT_over_kN": p.ratio}
            for name, unit, has_error in names:
                row[name + unit] = p.mean[name]
                row.update({name + unit + "_standard_error": p.error[name]} if has_error else {})
            rows.append(row)
        return rows


def clean(value):
    """Round-off beside 1 is shown as 0."""
    return 0.0 if abs(value) < 1e-11 else value


def percent(share):
    return f"{100 * clean(share):+.3g} %"


def place(point):
    return f"{point.family.name}, kT/kN = {point.ratio:g}"


def rms(points, number):
    return math.sqrt(mean_of(p.mean[number]**2 for p in points).mean)


def largest(points, number):
    return max(abs(p.mean[number]) for p in points)


def scatter_of_G(points):
    """Of one cell, relative."""
    return math.sqrt(mean_of((p.deviation.G_exact / p.mean.G_exact)**2 for p in points).mean)


def errors_by(measure, points):
    return (f"{measure(points, 'nu_error'):.3f} in nu, {100 * measure(points, 'G_error'):.2g} % in G and "
            f"{100 * measure(points, 'K_error'):.2g} % in K")


def reproduce(options, page):
    r = Result(options.size)
    page.names.update(r=r, families=r.families)
    plots = page.figures()
    for name, plot in plots.items():  # room for the labels of the vertical lines
        if name.startswith("error"):
            values = [0.0, *(y for series in plot.series for y in series.y)]
            plot.y["high"] = max(values) + 0.35 * (max(values) - min(values))
    numbers = {"discs": options.size.discs, "samples": options.size.samples, "refusals": r.refusals,
               "points": r.table()}
    return Output({}, numbers, {"mean_field": r.table()}, plots=plots)


if __name__ == "__main__":
    main(reproduce)
