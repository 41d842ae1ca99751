#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""A question that Abe (1996) leaves open: how far his mean field, eqs. (21) and (22), and the correction (11) are from
the exact moduli of random assemblies, over disorder, kT/kN and weightings.

Example:
  tools/papers/abe1996_random.py --out figures      minutes; with --quick seconds
"""
import concurrent.futures
import dataclasses
import math

import common
import numpy as np
from common import Axis, Output, Plot, Progress, Series, Table, counted, curve, eq

WEIGHTINGS = ("uniform", "contact_density", "voronoi", "local_contact_density")
# Numbers of a point by their place: K and G in kN and nu of plane strain of each answer, errors of the mean field (G
# and K over the exact one, less 1; nu less the exact one), anisotropy of the exact tensor.
EXACT, MEAN_FIELD, VOIGT, UNIFORM_STRESS, ERRORS, ANISOTROPY = 0, 3, 6, 9, 12, 15
K, G, NU = 0, 1, 2
RADIUS = 0.005  # m


@dataclasses.dataclass(frozen=True)
class Family:
    """Random assemblies of one kind: periodic Delaunay cells of equal discs. Points are moved to (stretch x, y/stretch)
    before triangulation: anisotropic unless 1."""
    name: str
    points: str = "perturbed_hexagonal"
    disorder: float = 0.0
    stretch: float = 1.0

    @property
    def lattice(self):
        return self.points == "perturbed_hexagonal"

    @property
    def random(self):
        return not self.lattice or self.disorder > 0

    @property
    def isotropic(self):
        return self.stretch == 1

    def cell(self, discs, seed):
        keys = {"disorder": self.disorder} if self.lattice else {}
        made = eq.delaunay(discs=discs, points=self.points, seed=seed, radius=RADIUS, periodic=True, **keys)
        if self.isotropic:
            return made
        by = np.array([self.stretch, 1 / self.stretch])
        return eq.triangulated(made.centres * by, made.radii, cell=tuple(by * made.cell))


class Plan:
    def __init__(self, quick):
        disorders = (0, 0.1, 0.2, 0.45) if quick else (0, 0.05, 0.1, 0.2, 0.3, 0.45)
        self.families = [*(Family(f"hexagonal, disorder {d:g}", disorder=float(d)) for d in disorders),
                         Family("Poisson-disc", "poisson_disc"), Family("random", "random"),
                         Family("Poisson-disc, stretched", "poisson_disc", stretch=1.2)]
        self.ratios = [0.0, 0.25, 1.0] if quick else [0.0, 0.05, 0.1, 0.25, 0.5, 0.75, 1.0]
        self.discs, self.samples = (120, 4) if quick else (1600, 32)


def moduli_of(stiffness):
    """K, G and nu of plane strain of the isotropic part."""
    c = np.array(stiffness)
    bulk, shear = (c[0, 0] + c[1, 1] + 2 * c[0, 1]) / 4, (c[0, 0] + c[1, 1] - 2 * c[0, 1] + 4 * c[2, 2]) / 8
    return [bulk, shear, (bulk - shear) / (2 * bulk)]


def mean_field(ratio, weighting, phi, z):
    """nu = (1 - kT/kN)/4 (22); K = phi z/(2 pi) kN for equal springs (21); with the correction (11), springs k/psi,
    psi of all discs or of the two of a contact, K = phi kN; with springs k h/l, whose facets obey sum h l = 2 A,
    K = kN/2."""
    bulk = {"uniform": phi * z / (2 * math.pi), "voronoi": 0.5}.get(weighting, phi)
    nu = (1 - ratio) / 4
    return [bulk, bulk * (1 - 2 * nu), nu]


def compute_cell(plan, family, seed):
    """Geometry: scatter of branch lengths over their mean, of the contacts of a disc, anisotropy sqrt(a_2² + b_2² +
    a_4² + b_4²) of psi(theta), phi, z; and the numbers of the points."""
    cell = family.cell(plan.discs, seed)
    phi, z, points, fabric = cell.solid_fraction, cell.coordination_number, [], None
    for weighting in WEIGHTINGS:
        for ratio in plan.ratios:
            springs = eq.Springs(kN=1.0, kT=ratio, weighting=weighting)
            found = eq.homogenize(cell, springs, homogenize={"bounds": "affine"})
            fabric = fabric or found.fabric
            exact, mean = moduli_of(found.stiffness), mean_field(ratio, weighting, phi, z)
            beside = [moduli_of(found.bounds[name]) for name in ("voigt", "uniform_stress_estimate")]
            points.append([*exact, *mean, *beside[0], *beside[1],
                           mean[K] / exact[K] - 1, mean[G] / exact[G] - 1, mean[NU] - exact[NU], found.anisotropy])
    branches = np.array(cell.levers).sum(axis=1)
    contacts = np.bincount(np.array(cell.contacts).ravel(), minlength=len(cell))
    geometry = [branches.std(ddof=1) / branches.mean(), contacts.std(ddof=1),
                math.hypot(fabric.anisotropy_2, fabric.anisotropy_4), phi, z]
    return geometry, np.reshape(points, (len(WEIGHTINGS), len(plan.ratios), 16))


class Result:
    """Means over the cells: mean, error (standard) and deviation [family, weighting, ratio, number]; geometry."""
    def __init__(self, plan):
        self.plan, self.refusals, self.geometry, means = plan, [], [], []
        progress, done = Progress("homogenizing random cells:"), 0
        total = len(plan.families) * plan.samples
        for family in plan.families:
            cells = []
            with concurrent.futures.ThreadPoolExecutor(eq.threads()) as pool:
                tasks = {seed: pool.submit(compute_cell, plan, family, seed) for seed in range(1, plan.samples + 1)}
                for seed, task in tasks.items():
                    try:
                        cells.append(task.result())
                    except (eq.BadInput, eq.ComputationFailed) as error:
                        self.refusals.append(f"{family.name}, seed {seed}: {error}")
                    except BaseException:
                        pool.shutdown(cancel_futures=True)
                        raise
                    done += 1
                    progress.update(done / total)
            if not cells:
                raise eq.ComputationFailed(f"none of the cells of '{family.name}' has moduli",
                                           "the first: " + self.refusals[-1], "", "")
            self.geometry.append(np.mean([geometry for geometry, _ in cells], axis=0))
            means.append(np.array([points for _, points in cells]))
        progress.end()
        self.mean = np.array([points.mean(axis=0) for points in means])
        self.deviation = np.array([points.std(axis=0, ddof=1) for points in means])
        self.error = np.array([d / math.sqrt(len(points)) for d, points in zip(self.deviation, means)])

    def chosen(self, weighting, anisotropic=False, ratio=None):
        """(family, weighting, ratio) of the points of a weighting on isotropic random families, or all random ones."""
        return [(f, weighting, r) for f, family in enumerate(self.plan.families)
                if family.random and (anisotropic or family.isotropic)
                for r, one in enumerate(self.plan.ratios) if ratio is None or one == ratio]

    def values(self, points, number):
        return np.array([self.mean[point][number] for point in points])

    def rms(self, points, number):
        return math.sqrt((self.values(points, number) ** 2).mean())

    def largest(self, points, number):
        return float(np.abs(self.values(points, number)).max())

    def place(self, point):
        return f"{self.plan.families[point[0]].name}, kT/kN = {self.plan.ratios[point[2]]:g}"


def clean(value):
    """Round-off beside 1 is shown as 0."""
    return 0.0 if abs(value) < 1e-11 else value


def percent(share):
    return f"{100 * clean(share):+.3g} %"


def head_of_ratios(r, first="kT/kN"):
    return first + "".join(f" & {ratio:g}" for ratio in r.plan.ratios)


def describe_families(r):
    table = Table("assemblies & branch lengths, sd/mean & contacts of a disc, sd & anisotropy of psi(theta) & phi & z")
    for family, (branches, contacts, uneven, phi, z) in zip(r.plan.families, r.geometry):
        table.add(f"{family.name} & {branches:.4f} & {contacts:.3f} & {uneven:.4f} & {phi:.4f} & {z:.3f}")
    return table.text()


def grid(r, w, title, number):
    """Families downwards, kT/kN to the right; means over the cells."""
    shares, table = number != EXACT + NU, Table(head_of_ratios(r))
    for f, family in enumerate(r.plan.families):
        values = [0.0 if abs(value) < 5e-5 else value for value in r.mean[f, w, :, number]]  # without a sign
        table.add(family.name + "".join(f" & {100 * x:+.2f} %" if shares else f" & {x:.4f}" for x in values))
    if not shares:
        table.add("mean field (1 - kT/kN)/4" + "".join(f" & {x:.4f}" for x in r.mean[0, w, :, MEAN_FIELD + NU]))
    error = r.error[:, w, :, number].max()
    return f"{title} (standard errors up to {f'{100 * error:.2g} %' if shares else f'{error:.2g}'})\n{table.text()}\n"


def describe_weighting(r, w):
    return (f'Weighting "{WEIGHTINGS[w]}"\n' + grid(r, w, "nu, exact", EXACT + NU)
            + grid(r, w, "G of the mean field over the exact one, less 1", ERRORS + G)
            + grid(r, w, "K of the mean field over the exact one, less 1", ERRORS + K))


def errors_of(r):
    text = ""
    for w, weighting in enumerate(WEIGHTINGS):
        points = r.chosen(w)
        text += f"  {weighting}:\n"
        for modulus, name in ((NU, "nu"), (G, "G"), (K, "K")):
            values = r.values(points, ERRORS + modulus)
            if clean(np.abs(values).max()) == 0:
                text += f"    {name:<3} none: exact within {np.abs(values).max():.0e}\n"
                continue
            low, high = (f"{f'{values[k]:+.4f}' if modulus == NU else percent(values[k])} ({r.place(points[k])})"
                         for k in (values.argmin(), values.argmax()))
            text += f"    {name:<3} from {low} to {high}\n"
    return text


def effect_of_disorder(r):
    """The exponent of |error| ~ disorder^p between the two least disordered lattices, and errors against kT/kN."""
    lattices = [f for f, family in enumerate(r.plan.families) if family.lattice and family.random][:2]
    small, larger = (r.plan.families[f].disorder for f in lattices)
    exponents = Table(" & p of nu & p of G")
    against = Table(head_of_ratios(r, "kT/kN, root mean square over isotropic random assemblies"))
    for w, name in enumerate(WEIGHTINGS):
        growth = r.mean[lattices[1], w, 0] / r.mean[lattices[0], w, 0]
        exponents.add(name + "".join(f" & {math.log(growth[ERRORS + m]) / math.log(larger / small):.2f}"
                                     for m in (NU, G)))
        by_ratio = [r.chosen(w, ratio=ratio) for ratio in r.plan.ratios]
        against.add(f"{name}: error of nu" + "".join(f" & {r.rms(points, ERRORS + NU):.4f}" for points in by_ratio))
        against.add(f"{name}: error of G, %" + "".join(f" & {100 * r.rms(p, ERRORS + G):.2f}" for p in by_ratio))
    return {"without": np.abs(r.mean[0, :, :, ERRORS:ANISOTROPY]).max(), "small": small, "larger": larger,
            "exponents": exponents, "against_ratio": against}


def causes_of_error(r):
    """Causes of the error of G, on the isotropic assembly with the widest scatter of branch lengths."""
    widest = max((f for f, family in enumerate(r.plan.families) if family.isotropic), key=lambda f: r.geometry[f][0])
    k, table = len(r.plan.ratios) // 2, Table(" & branch lengths & non-uniform strain & both")
    for w, name in enumerate(WEIGHTINGS):
        exact, mean, voigt = (r.mean[widest, w, k, answer + G] for answer in (EXACT, MEAN_FIELD, VOIGT))
        table.add(f"{name} & {percent(voigt / mean - 1)} & {percent(exact / voigt - 1)} & {percent(exact / mean - 1)}")
    return {"widest": r.plan.families[widest].name, "middle": r.plan.ratios[k], "causes": table}


def effect_of_correction(r):
    uniform, corrected, local = (r.chosen(w) for w in (0, 1, 3))
    before, after, local_after = (r.rms(points, ERRORS + NU) for points in (uniform, corrected, local))
    table = Table("kT/kN & uniform & nu & contact_density & change & nu & voronoi & nu & local & nu")
    for ratio, numbers in zip(r.plan.ratios, np.moveaxis(r.mean[-1], 1, 0)):
        a, nu = numbers[:, ANISOTROPY], [f"{error:+.4f}" for error in numbers[:, ERRORS + NU]]
        table.add(f"{ratio:g} & {a[0]:.4f} & {nu[0]} & {a[1]:.4f} & {percent(a[1] / a[0] - 1)} & {nu[1]} & "
                  f"{a[2]:.4f} & {nu[2]} & {a[3]:.4f} & {nu[3]}")
    sums = r.mean[-1, :, :, ANISOTROPY].sum(axis=1)
    return {"before": before, "after": after, "after_change": percent(after / before - 1), "count": len(uniform),
            "beyond": sum(abs(r.mean[c][NU] - r.mean[u][NU]) > 2 * math.hypot(r.error[c][NU], r.error[u][NU])
                          for u, c in zip(uniform, corrected)),
            "helps": "helps" if after < 0.9 * before else "does not help",
            "uneven": max(geometry[2] for family, geometry in zip(r.plan.families, r.geometry) if family.isotropic),
            "local": local_after, "local_change": percent(local_after / before - 1),
            "nearer": (np.abs(r.values(local, ERRORS + NU)) < np.abs(r.values(uniform, ERRORS + NU))).sum(),
            "stretched": r.plan.families[-1], "uneven_stretched": r.geometry[-1][2], "stretched_table": table,
            "stretched_changes": [percent(sums[w] / sums[0] - 1) for w in (1, 2)],
            "local_largest": r.largest(local, ERRORS + NU), "local_G": 100 * r.rms(local, ERRORS + G),
            "local_K": 100 * r.rms(local, ERRORS + K)}


def best_weighting(r):
    table, scores = Table("weighting & error of nu & error of G & error of K & scatter of G, one cell & anisotropy"), []
    for w, name in enumerate(WEIGHTINGS):
        points = r.chosen(w)
        bulk, shear, nu = (r.rms(points, ERRORS + m) for m in (K, G, NU))
        scores.append((bulk, shear, nu))
        scatter = math.sqrt(np.mean([(r.deviation[p][G] / r.mean[p][G]) ** 2 for p in points]))
        table.add(f"{name} & {nu:.4f} & {100 * shear:.2f} % & {100 * bulk:.2f} % & {100 * scatter:.2f} % & "
                  f"{r.rms(points, ANISOTROPY):.4f}")
    return {"scores": table, "best": [WEIGHTINGS[int(np.argmin(np.array(scores)[:, m]))] for m in (NU, G, K)],
            "worst_bulk": np.abs(r.mean[:, 2, :, ERRORS + K]).max()}


def inside_bounds(r):
    numbers = np.array([r.mean[p] for w in range(len(WEIGHTINGS)) for p in r.chosen(w, True)]).T
    ends, nu, tiny = np.sort(numbers[[VOIGT + NU, UNIFORM_STRESS + NU]], axis=0), numbers[EXACT + NU], 1e-12
    return {"bounded": numbers.shape[1], "below": (numbers[EXACT + G] <= numbers[VOIGT + G] * (1 + tiny)).sum(),
            "above": (numbers[EXACT + G] >= numbers[UNIFORM_STRESS + G] * (1 - tiny)).sum(),
            "between": ((ends[0] - tiny <= nu) & (nu <= ends[1] + tiny)).sum()}


def report(r):
    """tools/papers/abe1996_random.txt with its numbers."""
    limits, equal = "", r.chosen(0)
    for w, name in enumerate(WEIGHTINGS):
        most = max(r.chosen(w, True), key=lambda point: r.mean[point][NU])
        limits += f"  {name:<21} {r.mean[most][NU]:.4f} ± {r.error[most][NU]:.4f} ({r.place(most)})\n"
    at_most, rms = (f"{measure(equal, ERRORS + NU):.3f} in nu, {100 * measure(equal, ERRORS + G):.2g} % in G and "
                    f"{100 * measure(equal, ERRORS + K):.2g} % in K" for measure in (r.largest, r.rms))
    return common.filled(
        "abe1996_random", plan=r.plan, families=describe_families(r), limits=limits, at_most=at_most, rms=rms,
        weightings="".join(describe_weighting(r, w) for w in range(len(WEIGHTINGS))), errors=errors_of(r),
        refused=f"{counted(len(r.refusals), 'cell')} without moduli, left out; the first: {r.refusals[0]}\n\n"
        if r.refusals else "", **effect_of_disorder(r), **causes_of_error(r), **effect_of_correction(r),
        **best_weighting(r), **inside_bounds(r))


LOOKS = [{"colour": colour, "marker": marker} for colour, marker in zip(
    ("yellow", "sky_blue", "green", "orange", "purple", "blue", "vermilion", "black"),
    ("circle", "square", "triangle", "diamond") * 2)]


def with_bars(series, values, errors):
    """Bars of two standard errors to either side."""
    series.y, series.low, series.high = list(values), list(values - 2 * errors), list(values + 2 * errors)
    return series


def poisson_plot(r, w):
    end, looks = r.plan.ratios[-1], iter(LOOKS)
    plot = Plot(f'Random assemblies, springs weighted "{WEIGHTINGS[w].replace("_", " ")}"; bars: two standard errors',
                Axis("$k_T/k_N$"), Axis("Poisson's ratio ν (plane strain)"), [
        curve(lambda x: (1 - x) / 4, 0, end, label="mean field (22), Voigt", column="mean_field"),
        # uniform stress in two dimensions, plane strain: Kruyt & Rothenburg (2002)
        curve(lambda x: (1 - x) / (2 * (1 + x)), 0, end, label="uniform stress", style="dashed_line",
              column="uniform_stress")])
    for f, family in enumerate(r.plan.families):
        if family.isotropic and family.random:
            series = Series(family.name, r.plan.ratios, style="line_with_points", **next(looks))
            plot.series.append(with_bars(series, r.mean[f, w, :, EXACT + NU], r.error[f, w, :, EXACT + NU]))
    return plot


def error_plot(r, w, label, number):
    """Error against the scatter of branch lengths: a line through the perturbed lattices, points for the others."""
    plot = Plot(f'Springs weighted "{WEIGHTINGS[w].replace("_", " ")}"; lines: disordered lattices; bars: two standard '
                "errors", Axis("scatter of branch lengths, sd/mean"), Axis(label))
    kinds = [[f for f, family in enumerate(r.plan.families) if family.isotropic and family.lattice == lattice]
             for lattice in (True, False)]
    plot.vertical_lines = [(r.geometry[f][0], r.plan.families[f].name, "black") for f in kinds[1]]
    for k, ratio in enumerate(r.plan.ratios):
        name, look = f"$k_T/k_N$ = {ratio:g}", {**LOOKS[(k + 1) % 8], "marker": LOOKS[k % 4]["marker"]}
        for kind, style, extra in ((kinds[0], "line_with_points", {"label": name}),
                                   (kinds[1], "points", {"column": name + ", others"})):
            series = Series(x=[r.geometry[f][0] for f in kind], style=style, **extra, **look)
            plot.series.append(with_bars(series, r.mean[kind, w, k, number], r.error[kind, w, k, number]))
    values = [0.0, *(y for series in plot.series for y in series.y)]
    plot.y.high = max(values) + 0.35 * (max(values) - min(values))  # room for the labels of the vertical lines
    return plot


def table_of(r):
    places = [(f, w, k) for f in range(len(r.plan.families)) for w in range(len(WEIGHTINGS))
              for k in range(len(r.plan.ratios))]
    families = [r.plan.families[f] for f, _, _ in places]
    columns = {"points": [family.points for family in families], "disorder": [family.disorder for family in families],
               "stretch": [family.stretch for family in families], "weighting": [WEIGHTINGS[w] for _, w, _ in places],
               "branch_scatter": [r.geometry[f][0] for f, _, _ in places],
               "kT_over_kN": [r.plan.ratios[k] for _, _, k in places]}

    def add(name, number, with_error=False):
        columns[name] = r.values(places, number)
        if with_error:
            columns[name + "_standard_error"] = np.array([r.error[place][number] for place in places])
    for modulus, name, unit in ((NU, "nu", ""), (G, "G", "_over_kN"), (K, "K", "_over_kN")):
        add(f"{name}_exact{unit}", EXACT + modulus, True)
        add(f"{name}_mean_field{unit}", MEAN_FIELD + modulus)
        add(f"{name}_voigt{unit}", VOIGT + modulus)
        if modulus != K:
            add(f"{name}_uniform_stress{unit}", UNIFORM_STRESS + modulus)
    for name, number in (("nu_error", ERRORS + NU), ("G_error", ERRORS + G), ("K_error", ERRORS + K),
                         ("anisotropy", ANISOTROPY)):
        add(name, number, True)
    return columns


def plots(r):
    drawn = {}
    for w, name in enumerate(WEIGHTINGS):
        drawn[f"poisson_ratio_{name}"] = poisson_plot(r, w)
        drawn[f"error_poisson_ratio_{name}"] = error_plot(r, w, "ν of the mean field less the exact one", ERRORS + NU)
        drawn[f"error_shear_modulus_{name}"] = error_plot(r, w, "G of the mean field over the exact one, less 1",
                                                          ERRORS + G)
    return drawn


def reproduce(options):
    r = Result(Plan(options.quick))
    table = table_of(r)
    points = [dict(zip(table, row)) for row in zip(*table.values())]
    numbers = {"discs": r.plan.discs, "samples": r.plan.samples, "refusals": r.refusals, "points": points}
    return Output(report(r), numbers, {"mean_field": table}, plots(r))


if __name__ == "__main__":
    common.main("abe1996_random", __doc__, reproduce, files=lambda options: ["mean_field.csv"] + [
        f"{what}_{name}.svg" for name in WEIGHTINGS for what in ("poisson_ratio", "error_poisson_ratio",
                                                                "error_shear_modulus")])
