# SPDX-License-Identifier: GPL-3.0-or-later
"""Statics and homogenization of an assembly in memory."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt

from . import _core
from ._arrays import Floats, floats
from .assembly import Assembly
from .case import Case
from .errors import BadInput
from .result import Result
from .springs import springs_from

if TYPE_CHECKING:
    from scipy.sparse import bsr_matrix

Tables = Mapping[str, Any]


def solve(assembly: Assembly, springs: Any = None, *, supports: Iterable[Tables] = (), loads: Iterable[Tables] = (),
          accuracy: float | None = None, sensitivities: bool = False, **tables: Any) -> Result:
    """The equilibrium of an assembly under supports and loads; parameters and arrays as those of `Case` and
    `Case.solve`.

    Parameters
    ----------
    accuracy : float, optional
        Wanted relative error of the motions; the result says what was reached.
    sensitivities : bool
        Whether to return the derivatives by the springs of what is measured.

    Raises
    ------
    BadInput
        Supports that leave a motion free, a mechanism (named), groups that do not exist, ...
    ComputationFailed
        Where the stiffness matrix is singular to working precision.
    """
    case = Case(assembly=assembly, springs=springs, supports=supports, loads=loads, **tables)
    return case.solve(accuracy=accuracy, sensitivities=sensitivities)


def tension_test(assembly: Assembly, springs: Any = None, *, stress: float = 1e6, gauge: str | None = None,
                 accuracy: float | None = None, sensitivities: bool = False, **tables: Any) -> Result:
    """Abe's tension test (1996, section 3): a free block is pulled along x.

    Parameters
    ----------
    stress : float
        Pa.
    gauge : str, optional
        Where strains are read: "centre", "quarter" or "ends".
    sensitivities : bool
        Whether to return the derivatives of E and nu (plane stress) by the springs.
    """
    test = {"kind": "uniaxial_tension", "stress": stress, "gauge": gauge}
    case = Case(assembly=assembly, springs=springs, test=test, **tables)
    return case.solve(accuracy=accuracy, sensitivities=sensitivities)


def homogenize(cell: Assembly, springs: Any = None, *, accuracy: float | None = None, sensitivities: bool = False,
               second_order: int | None = None, **tables: Any) -> Result:
    """Effective stiffness (3, 3) in Pa (Voigt, engineering shear) and moduli of the continuum that an assembly stands
    for, with bounds and the bound of the error; arrays as those of `Case.homogenize`.

    Parameters
    ----------
    sensitivities : bool
        Whether to return the derivatives of the stiffness by the springs of each contact and by positions and radii.
    second_order : int, optional
        With these: random probes for the shift of the mean moduli by scatter of the springs,
        ``sensitivities.mean_shift``, over the square of their coefficient of variation.
    """
    case = Case(assembly=cell, springs=springs, **tables)
    return case.homogenize(accuracy=accuracy, sensitivities=sensitivities, second_order=second_order)


def calibrate(cell: Assembly, *, plane: str = "strain", weighting: str | None = None, **moduli: Any) -> Result:
    """Springs that give an assembly two wanted moduli. Strengths of contacts are found by `Case.calibrate`.

    Parameters
    ----------
    plane : str
        "strain" or "stress": to which the moduli refer.
    moduli
        Two keys of the table `material`, such as young_modulus (Pa) and poisson_ratio. Other keyword arguments that are
        dictionaries are tables of the case.
    """
    tables: dict[str, Any] = {name: value for name, value in moduli.items() if isinstance(value, Mapping)}
    material = {name: value for name, value in moduli.items() if name not in tables}
    if weighting is not None:
        material["weighting"] = weighting
    return Case(assembly=cell, material={"plane": plane, **material}, **tables).calibrate()


def stability(assembly: Assembly, springs: Any = None, *, supports: Iterable[Tables] = (), sensitivities: bool = False,
              **tables: Any) -> Result:
    """Mechanisms, waves, the critical kT/kN, natural frequencies and time steps; arrays as of `Case.stability`.
    `density` in kg/m³ is that of the discs.

    Parameters
    ----------
    sensitivities : bool
        Whether to return the derivatives of frequencies, speeds of sound and the critical kT/kN by the springs.
    """
    case = Case(assembly=assembly, springs=springs, supports=supports, **tables)
    return case.stability(sensitivities=sensitivities)


class Factor:
    """The factorized stiffness matrix of an assembly with its supports, made by `factorize`."""

    def __init__(self, assembly: Assembly, case: Case, error_bound: bool) -> None:
        self.assembly = assembly
        self._native = _core.factor(*case._inputs(), error_bound)

    @property
    def unknowns(self) -> int:
        """Components of the motions that are not held."""
        return self._native.unknowns

    def solve(self, loads: npt.ArrayLike) -> Result:
        """The equilibrium under a force (N/m) and, in the third column, a moment (N) on each disc.

        Parameters
        ----------
        loads : array (n, 2), (n, 3) or (n, 3, k)
            With k load cases displacements have the shape (n, 2, k), rotations (n, k), contact_forces (contacts, 2, k).
        """
        n = len(self.assembly)
        given = floats("loads", loads, (n, 2), (n, 3), (n, 2, None), (n, 3, None))
        if given.shape[1] == 2:
            given = np.concatenate([given, np.zeros_like(given[:, :1])], axis=1)
        if given.ndim == 2:
            return Result(*self._native.solve(np.ascontiguousarray(given)), self.assembly)
        if given.shape[2] == 0:
            raise BadInput("no load cases", "the last axis of loads is empty", "Give at least one", "loads")
        parts = [self._native.solve(np.ascontiguousarray(given[:, :, k])) for k in range(given.shape[2])]
        values = {name: [part[0][name] for part in parts] for name in parts[0][0]}
        arrays = {name: (np.stack([part[1][name][0] for part in parts], axis=-1), unit)
                  for name, (_, unit) in parts[0][1].items() if name != "supported_discs"}
        arrays["supported_discs"] = parts[0][1]["supported_discs"]
        return Result(values, arrays, self.assembly)

    def derivatives(self, loads: npt.ArrayLike, *, motions: npt.ArrayLike | None = None,
                    forces: npt.ArrayLike | None = None) -> Result:
        """Derivatives of a measured number q, a weighted sum over the equilibrium under `loads`, by every spring, load
        and position: one more solution with the factor, for the weights as loads.

        Parameters
        ----------
        loads : array (n, 2) or (n, 3)
            N/m and N, as of `solve`.
        motions : array (n, 2) or (n, 3), optional
            Weights of displacements and rotations in q.
        forces : array (contacts, 2), optional
            Weights of the normal and tangential forces of contacts in q.

        Returns
        -------
        Result
            value (q), by_kN, by_kT (contacts) by Pa, by_kM (contacts) by N where contacts bend, by_force (n, 2) by N/m,
            by_moment (n) by N, and by_position (n, 2) by m, while springs, loads and weights stay what they are and
            contact points divide the distance as before: absent off the line of centres and with forces at rest.
        """
        n, contacts = len(self.assembly), len(self.assembly.contacts)
        weights = np.zeros((contacts, 2)) if forces is None else floats("forces", forces, (contacts, 2))
        return Result(*self._native.derivatives(_with_turns("loads", loads, n), _with_turns("motions", motions, n),
                                                np.ascontiguousarray(weights)), self.assembly)


def factorize(assembly: Assembly, springs: Any = None, supports: Iterable[Tables] = (), *, error_bound: bool = False,
              **tables: Any) -> Factor:
    """One factorization for any number of loads.

    Parameters
    ----------
    supports : sequence of dict
        As of `Case`.
    error_bound : bool
        Estimate the condition of K, at the cost of two more solutions for each load.
    tables
        Of `Case`, such as ``solver={"method": "cholmod"}`` or ``effects={"rotation": "restrained"}``.

    Raises
    ------
    BadInput
        Supports that leave a motion free, a mechanism (named), groups and discs that do not exist.
    """
    return Factor(assembly, Case(assembly=assembly, springs=springs, supports=supports, **tables), error_bound)


def form_derivatives(assembly: Assembly, springs: Any, a: npt.ArrayLike, b: npt.ArrayLike | None = None,
                     **tables: Any) -> Result:
    """Derivatives of a . K b, N, by every spring and position, for two motions and the stiffness matrix K.

    Of a natural frequency omega with the mode a, which has the modal mass 1 (``stability(...).modes["0"]``), they are
    those of omega²; where frequencies coincide these have none.

    Parameters
    ----------
    a, b : array (n, 2) or (n, 3)
        Displacements in m and rotations in rad; b left out: a.

    Returns
    -------
    Result
        by_kN, by_kT, by_kM and by_position as of `Factor.derivatives`.
    """
    n = len(assembly)
    first = _with_turns("a", a, n)
    second = first if b is None else _with_turns("b", b, n)
    case = Case(assembly=assembly, springs=springs, **tables)
    return Result({}, _core.form_derivatives(*case._inputs(), first, second), assembly)


def _with_turns(name: str, rows: npt.ArrayLike | None, n: int) -> Floats:
    """(n, 3): left out, or without a third column, 0."""
    given = np.zeros((n, 3)) if rows is None else floats(name, rows, (n, 2), (n, 3))
    if given.shape[1] == 2:
        given = np.concatenate([given, np.zeros_like(given[:, :1])], axis=1)
    return np.ascontiguousarray(given)


class StrengthSample:
    """A free sample that is pulled apart or pressed again and again between frictionless ends, contact after contact in
    exact equilibrium, with any strengths of its contacts.

    Parameters
    ----------
    assembly : Assembly
        With the groups bottom and top, or along x left and right.
    springs : as of `Case`
    axis : str
        "x" or "y": the direction of the motion.
    fallen_to : float
        A test is over where the load has fallen to this share of its peak.
    rotation : str
        "from_scene" or "restrained".
    """

    def __init__(self, assembly: Assembly, springs: Any, *, axis: str = "y", fallen_to: float = 0.5,
                 rotation: str = "from_scene") -> None:
        self._native = _core.strength_sample(assembly._native, _springs_of(assembly, springs), axis, float(fallen_to),
                                             rotation)

    @property
    def width(self) -> float:
        """m, across the axis."""
        return self._native.width

    def strength(self, tension: float, shear: float, *, kind: str = "tension", friction: float = 0.0,
                 weibull_modulus: float | None = None, seed: int = 1, notch: float | None = None) -> Result:
        """The largest load over the width, under control of the motion.

        Parameters
        ----------
        tension, shear, friction, weibull_modulus, seed
            Of the contacts, as in the table `strength`; N/m.
        kind : str
            "tension" or "compression".
        notch : float, optional
            m, length 2a of a straight cut in the middle, across the axis.

        Returns
        -------
        Result
            stress (Pa), events (contacts that broke), energy_error.
        """
        stress, events, error = self._native.strength(kind, tension, shear, friction, weibull_modulus, seed, notch)
        return Result({"stress": stress, "events": events, "energy_error": error})


def stiffness_matrix(assembly: Assembly, springs: Any, *, rotation: str = "from_scene") -> bsr_matrix:
    """The assembled stiffness matrix without supports (Abe 1996, section 3), as scipy.sparse.

    Rows and columns are u_x, u_y (m) and, where rotations are unknowns, theta (rad) of disc 0, then of disc 1, ...:
    forces in N/m per m in Pa, moments in N. Forces at rest of the assembly count where `solve` takes them
    (effects.prestress = "auto").
    """
    from scipy.sparse import bsr_matrix

    data, columns, first = _core.stiffness_matrix(assembly._native, _springs_of(assembly, springs), rotation)
    size = data.shape[1] * len(assembly)
    matrix = bsr_matrix((data, columns, first), shape=(size, size))
    matrix.sum_duplicates()
    return matrix


def _springs_of(assembly: Assembly, springs: Any) -> Floats:
    chosen = springs_from(springs)
    chosen._check_alone("a stiffness_matrix of springs", ("bond_width", "kM"))
    return chosen._native(assembly)
