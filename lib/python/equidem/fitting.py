# SPDX-License-Identifier: GPL-3.0-or-later
"""Springs of groups of contacts for wanted moduli, by Gauss-Newton with the exact derivatives of a homogenization; the
friction with which sand is consolidated to a wanted void ratio."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt

from ._arrays import Floats, floats, whole
from .assembly import Assembly
from .errors import BadInput, ComputationFailed
from .springs import Springs, springs_from
from .statics import homogenize

if TYPE_CHECKING:
    from .case import Case
    from .simulation import Simulation

_KINDS = ("kN", "kT")
_POSITIVE = {"C11", "C22", "C66", "K", "G", "E_strain", "E_stress"}  # of a stable continuum
_PLACES = {"C11": (0, 0), "C22": (1, 1), "C66": (2, 2), "C12": (0, 1), "C16": (0, 2), "C26": (1, 2)}


def _bulk(c: Any) -> Any:
    return (c[0, 0] + c[1, 1] + 2 * c[0, 1]) / 4


def _shear(c: Any) -> Any:
    return (c[0, 0] + c[1, 1] - 2 * c[0, 1] + 4 * c[2, 2]) / 8


# Means over all directions; K and G are two-dimensional. Complex arguments give exact derivatives.
_MODULI: dict[str, Callable[[Any], Any]] = {
    "K": _bulk,
    "G": _shear,
    "nu_strain": lambda c: (_bulk(c) - _shear(c)) / (2 * _bulk(c)),
    "nu_stress": lambda c: (_bulk(c) - _shear(c)) / (_bulk(c) + _shear(c)),
    "E_strain": lambda c: _shear(c) * (3 * _bulk(c) - _shear(c)) / _bulk(c),
    "E_stress": lambda c: 4 * _bulk(c) * _shear(c) / (_bulk(c) + _shear(c)),
}


def _value(name: str, stiffness: Any) -> Any:
    return stiffness[_PLACES[name]] if name in _PLACES else _MODULI[name](stiffness)


@dataclasses.dataclass(frozen=True)
class FittedSprings:
    """What `fit_springs` found.

    Attributes
    ----------
    springs : Springs
        Of each contact.
    reached : bool
        Whether every target is met to the tolerance; else they conflict, or the limits of the springs are in the way.
    values : dict
        Each target as the springs have it.
    factors : dict
        Of each unknown: its springs over those at the start.
    at_limit : list of str
        Unknowns at the smallest or the largest factor.
    misses : dict
        Targets that are not met: by how much, relative (logarithms of ratios), of Poisson's ratios absolute.
    evaluations : int
        Homogenizations.
    singular_values : array
        Of the change of all targets (relative, times weights) by the logarithms of all unknowns; a zero for each
        combination of unknowns that no target determines.
    determined : dict
        Of each unknown the share, 0 to 1, that the targets determine; the rest stays as at the start.
    """

    springs: Springs
    reached: bool
    values: dict[str, float]
    factors: dict[str, float]
    at_limit: list[str]
    misses: dict[str, float]
    evaluations: int
    singular_values: Floats
    determined: dict[str, float]


class _Problem:
    """Residuals and their derivatives by the logarithms of the factors."""

    def __init__(self, cell: Assembly, start: Floats, unknowns: dict[str, tuple[int, npt.NDArray[np.bool_]]],
                 targets: dict[str, float], weights: Floats, tables: Mapping[str, Any]) -> None:
        self.cell, self.start, self.unknowns, self.targets, self.weights = cell, start, unknowns, targets, weights
        self.tables = tables
        self.evaluations = 0

    def springs(self, logs: Floats) -> Springs:
        springs = self.start.copy()
        for (kind, chosen), log in zip(self.unknowns.values(), logs):
            springs[chosen, kind] *= np.exp(log)
        return Springs(kN=springs[:, 0], kT=springs[:, 1])

    def __call__(self, logs: Floats) -> tuple[Floats, Floats, Floats]:
        """Values of the targets, residuals and their derivatives."""
        springs = self.springs(logs)
        found = homogenize(self.cell, springs, sensitivities=True, **self.tables)
        self.evaluations += 1
        stiffness = np.asarray(found.stiffness)
        size = float(np.abs(stiffness).max())
        derivatives = (found.dC_dkN, found.dC_dkT)
        changes = [np.einsum("c,cij->ij", (springs.kN, springs.kT)[kind][chosen], derivatives[kind][chosen])
                   for kind, chosen in self.unknowns.values()]
        values, misses, rows = [], [], []
        for name, wanted in self.targets.items():
            tiny = 1e-100
            value = _value(name, stiffness)
            slopes = np.array([_value(name, stiffness + 1j * tiny * change).imag / tiny for change in changes])
            values.append(value)
            if name in _POSITIVE:  # of one factor of all springs the logarithm is a linear function
                misses.append(np.log(value / wanted))
                rows.append(slopes / value)
            else:
                scale = 1.0 if name.startswith("nu") else abs(wanted) or size
                misses.append((value - wanted) / scale)
                rows.append(slopes / scale)
        return np.array(values), self.weights * np.array(misses), self.weights[:, None] * np.array(rows)


def _step(logs: Floats, residuals: Floats, slopes: Floats, low: float, high: float) -> Floats:
    """The logarithms nearest to 0 that solve the linearized equations (Gauss-Newton); those at a limit stay there."""
    free = np.ones(len(logs), bool)
    new = logs.copy()
    for _ in range(len(logs)):
        right = slopes @ logs - residuals - slopes[:, ~free] @ new[~free]
        new[free] = np.linalg.lstsq(slopes[:, free], right, rcond=1e-9)[0]
        beyond = free & ((new < low) | (new > high))
        if not beyond.any():
            break
        new[beyond] = np.clip(new[beyond], low, high)
        free &= ~beyond
        if not free.any():
            break
    return new


def _unknowns(given: Mapping[str, Any] | None, start: Floats) -> dict[str, tuple[int, npt.NDArray[np.bool_]]]:
    m = len(start)
    if given is None:
        given = {kind: (kind, np.ones(m, bool)) for kind in _KINDS}
    if not given:
        raise BadInput("there are no unknowns", "springs are looked for", "Name some", "unknowns")
    found: dict[str, tuple[int, npt.NDArray[np.bool_]]] = {}
    owner: dict[int, npt.NDArray[np.object_]] = {k: np.full(m, None, object) for k in range(2)}
    for name, (kind, contacts) in given.items():
        where = f"unknowns[{name!r}]"
        if kind not in _KINDS:
            raise BadInput(f"{kind!r} is no kind of spring", "an unknown is kN or kT of some contacts",
                           "Give ('kN', contacts) or ('kT', contacts)", where)
        chosen = np.zeros(m, bool)
        numbers = np.asarray(contacts)
        if numbers.size == 0:
            numbers = numbers.astype(np.int64)
        if numbers.dtype == bool and numbers.shape != (m,):
            raise BadInput(f"the mask has the shape {numbers.shape}", f"the assembly has {m} contacts",
                           "Give one flag for each", where)
        if numbers.dtype != bool and (numbers.dtype.kind not in "iu" or np.any((numbers < 0) | (numbers >= m))):
            raise BadInput("contacts that do not exist", f"the assembly has {m} contacts, counted from 0",
                           "Give their numbers, or one flag for each", where)
        chosen[numbers] = True
        k = _KINDS.index(kind)
        if not chosen.any():
            raise BadInput("the group has no contacts", "its springs change nothing", "Leave it out", where)
        if owner[k][chosen].astype(bool).any():
            other = next(one for one in owner[k][chosen] if one)
            raise BadInput(f"contacts are in {other!r} too", "a spring is one unknown",
                           "Give groups that do not overlap", where)
        if not (start[chosen, k] > 0).all():
            raise BadInput(f"{kind} is not positive at the start", "springs are changed by factors",
                           "Start with positive springs", where)
        owner[k][chosen] = name
        found[name] = (k, chosen)
    return found


def _targets(given: Mapping[str, float], weights: Mapping[str, float] | None) -> tuple[dict[str, float], Floats]:
    known = [*_PLACES, *_MODULI]
    for name in [*given, *(weights or {})]:
        if name not in known:
            raise BadInput(f"{name!r} is no target", f"targets are {', '.join(known)}", "Name one of them", "targets")
    if not given:
        raise BadInput("there are no targets", "springs are found for wanted moduli", "Give some", "targets")
    targets = {name: float(floats(f"targets[{name!r}]", value, ())) for name, value in given.items()}
    for name, value in targets.items():
        if name in _POSITIVE and value <= 0:
            raise BadInput(f"{name} = {value:g} Pa", "a stable continuum has it above 0", "Give a positive one",
                           "targets")
    of_targets = floats("weights", [(weights or {}).get(name, 1.0) for name in targets], (len(targets),))
    if not (of_targets > 0).all():
        raise BadInput("a weight is not positive", "its target would not count", "Leave the target out", "weights")
    return targets, of_targets


def fit_springs(cell: Assembly, start: Any, targets: Mapping[str, float],
                unknowns: Mapping[str, tuple[str, npt.ArrayLike]] | None = None, *,
                weights: Mapping[str, float] | None = None, smallest: float = 1e-3, largest: float = 1e3,
                tolerance: float = 1e-10, most: int = 50, **tables: Any) -> FittedSprings:
    """Springs with which a cell has wanted moduli: any number of unknowns and of targets.

    Each unknown is a common factor of kN or kT of some contacts. Gauss-Newton with exact derivatives (one
    homogenization a step) finds the factors that meet the targets with the least change, as the sum of the squares of
    their logarithms; where targets conflict, those with the least sum of squares of the weighted misses.

    Parameters
    ----------
    cell : Assembly
        Periodic, or a sample under displacements of its sides.
    start : Springs or what `homogenize` takes
        Positive where they are unknown.
    targets : dict
        "C11", "C22", "C66", "C12", "C16", "C26" (Pa, of stress xx, yy, xy by strain xx, yy, 2 xy), "K", "G" (Pa,
        two-dimensional), "E_strain", "E_stress" (Pa), "nu_strain", "nu_stress" in plane strain and stress.
    unknowns : dict, optional
        Name: (``"kN"`` or ``"kT"``, numbers or mask of contacts). Left out: all kN, and all kT.
    weights : dict, optional
        Of targets, 1 where none is given; they matter where targets conflict.
    smallest, largest : float
        Limits of the factors.
    tolerance : float
        Of every target, relative, of Poisson's ratios and of targets 0 (over the largest stiffness) absolute.
    most : int
        Homogenizations.
    **tables
        Further tables of the case, such as ``homogenize={"bounds": "affine"}``.

    Returns
    -------
    FittedSprings

    Raises
    ------
    BadInput
        Unknowns that overlap, are empty or not positive; targets that do not exist or that no stable continuum has.
    ComputationFailed
        The network is not stable at the start.
    """
    if not 0 < smallest < 1 < largest:
        raise BadInput(f"smallest = {smallest:g}, largest = {largest:g}", "factors begin at 1",
                       "Give limits on both sides")
    most = whole("most", most, 1)
    springs = springs_from(start).at_contacts(cell)
    chosen = _unknowns(unknowns, springs)
    wanted, of_targets = _targets(targets, weights)
    problem = _Problem(cell, springs, chosen, wanted, of_targets, {"homogenize": {"bounds": "affine"}, **tables})
    low, high = np.log(smallest), np.log(largest)
    logs: Floats = np.zeros(len(chosen))
    values, residuals, slopes = problem(logs)
    while problem.evaluations < most and np.abs(residuals / of_targets).max() > tolerance:
        new = _step(logs, residuals, slopes, low, high)
        share, better = 1.0, False
        while problem.evaluations < most and share > 1e-3:
            trial = logs + share * (new - logs)
            try:
                found = problem(trial)
            except ComputationFailed:  # not stable there
                share /= 4
                continue
            better = bool(np.sum(found[1]**2) < (1 - 1e-12) * np.sum(residuals**2))
            if better:
                break
            share /= 4
        if not better:
            break
        logs, (values, residuals, slopes) = trial, found
    _, sizes, directions = np.linalg.svd(slopes)
    rank = int(np.sum(sizes > 1e-9 * sizes.max(initial=0)))
    shares = np.sum(directions[:rank]**2, axis=0)
    singular = np.zeros(len(chosen))
    singular[:min(len(sizes), len(chosen))] = sizes[:len(chosen)]
    misses = {name: float(miss) for name, miss in zip(wanted, residuals / of_targets) if abs(miss) > tolerance}
    names = list(chosen)
    return FittedSprings(
        springs=problem.springs(logs), reached=not misses, values=dict(zip(wanted, map(float, values))),
        factors=dict(zip(names, map(float, np.exp(logs)))),
        at_limit=[name for name, log in zip(names, logs) if not low < log < high], misses=misses,
        evaluations=problem.evaluations, singular_values=singular, determined=dict(zip(names, map(float, shares))))


@dataclasses.dataclass(frozen=True)
class ConsolidatedSand:
    """What `consolidate` found.

    Attributes
    ----------
    friction : float
        Between the bodies while they are consolidated.
    void_ratio : float
        At the end of the consolidation.
    case : Case
        With that friction.
    tried : dict
        Void ratio of each friction that was tried.
    """

    friction: float
    void_ratio: float
    case: Case
    tried: dict[float, float]

    @property
    def porosity(self) -> float:
        """Voids over the whole area."""
        return self.void_ratio / (1 + self.void_ratio)


def consolidate(case: Case, *, void_ratio: float | None = None, porosity: float | None = None,
                tolerance: float = 2e-3, largest_friction: float = 1.0) -> ConsolidatedSand:
    """The friction with which the first stage of a case consolidates sand to a wanted void ratio, by bisection: it
    keeps discs from sliding into voids, so that the same stress leaves a looser packing. Later stages give the sand the
    friction of its test.

    Parameters
    ----------
    case : Case
        Of discs in a periodic cell, or between two pairs of opposite plates; its first stage, or the whole run, is the
        consolidation, with the key ``collisions.friction``.
    void_ratio, porosity : float
        One of them, at the end of that stage.
    tolerance : float, optional
        Of the void ratio. The void ratio of a sample is no smooth function of the friction: few discs may not reach a
        small one.
    largest_friction : float, optional
        Friction is sought from 0 to this.

    Raises
    ------
    BadInput
        A void ratio out of reach, with the range that the frictions 0 and `largest_friction` give.
    ComputationFailed
        No friction tried gives the void ratio to the tolerance.
    """
    if (void_ratio is None) == (porosity is None):
        raise BadInput("a void ratio or a porosity is wanted, one of them", "either follows from the other",
                       "Give void_ratio or porosity")
    if porosity is not None:
        if not 0 < porosity < 1:
            raise BadInput(f"the porosity is {porosity:g}", "it is a share between 0 and 1", "Correct it", "porosity")
        void_ratio = porosity / (1 - porosity)
    wanted = float(void_ratio or 0)
    if not (wanted > 0 and tolerance > 0 and largest_friction > 0):
        raise BadInput("void_ratio, tolerance and largest_friction are > 0", "one of them is not", "Correct it")
    tried: dict[float, float] = {}

    def consolidated(friction: float) -> float:
        simulation = case.copy().set("collisions.friction", friction).simulation()
        simulation.finish_stage()
        tried[friction] = _void_ratio(simulation)
        return tried[friction]

    low, high = 0.0, float(largest_friction)
    densest, loosest = consolidated(low), consolidated(high)
    if not densest - tolerance <= wanted <= loosest + tolerance:
        raise BadInput(f"the void ratio {wanted:.4g} is out of reach",
                       f"friction 0 consolidates this sand to {densest:.4g} and friction {high:g} to {loosest:.4g}",
                       "Choose one between them, another grading or stress, or a rolling resistance for looser sand",
                       "void_ratio")
    most = 12
    while min(abs(found - wanted) for found in tried.values()) > tolerance and len(tried) < most:
        middle = (low + high) / 2
        if consolidated(middle) < wanted:
            low = middle
        else:
            high = middle
    friction = min(tried, key=lambda mu: (abs(tried[mu] - wanted), mu))
    if abs(tried[friction] - wanted) > tolerance:
        raise ComputationFailed(f"the void ratio {wanted:.4g} is not reached to {tolerance:g}",
                                f"friction {friction:.4g} is nearest, with {tried[friction]:.4g}: the packing jumps "
                                "from one friction to the next", "Take more discs, or a larger tolerance")
    return ConsolidatedSand(friction, tried[friction], case.copy().set("collisions.friction", friction), tried)


def _void_ratio(simulation: Simulation) -> float:
    """Of the periodic cell, or of the box between two pairs of opposite plates."""
    if simulation.cell is not None:
        return float(simulation.cell["void_ratio"])
    bodies, walls = simulation.assembly, simulation.walls
    spans = []
    for axis in range(2):
        pressed = sorted(wall["position"][axis] for wall in walls.values()
                         if abs(wall["force"][axis]) > abs(wall["force"][1 - axis]))  # normal beside friction
        spans.append(pressed[-1] - pressed[0] if len(pressed) == 2 else 0.0)
    if len(walls) != 4 or min(spans) <= 0 or bodies is None or len(bodies) != len(simulation.positions):
        raise BadInput("this sample has no void ratio",
                       "it is neither in a periodic cell nor discs between four plates",
                       "Consolidate it in a [cell], or between two pairs of opposite walls")
    return float(spans[0] * spans[1]) / (np.pi * float((np.asarray(bodies.radii) ** 2).sum())) - 1
