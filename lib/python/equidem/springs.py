# SPDX-License-Identifier: GPL-3.0-or-later
"""The springs of contacts."""

from __future__ import annotations

import dataclasses
import difflib
from collections.abc import Mapping
from typing import Any

import numpy as np
import numpy.typing as npt

from . import _core
from ._arrays import Floats, floats
from .assembly import Assembly
from .errors import BadInput
from .result import Result


@dataclasses.dataclass(frozen=True, eq=False)
class Springs:
    """The table `springs` of a case: normal and tangential springs of contacts, and how they resist bending.

    Parameters
    ----------
    kN, kT : float or array (contacts,)
        Pa (N/m per metre of depth).
    weighting : str
        Of numbers: "uniform", "contact_density", "local_contact_density" or "voronoi" (`equidem help case`).
    bond_width : float, optional
        Width w of a bond over the diameter of its smaller disc: contacts resist bending with kM = kN w²/12, the
        stiffness of a parallel bond (Potyondy and Cundall 2004). For kN and kT that are numbers.
    kM : float, optional
        N, bending spring of every contact, in place of bond_width.
    density : float, optional
        kg/m³, of the discs that these springs are for.
    """

    kN: Any
    kT: Any
    weighting: str = "uniform"
    bond_width: float | None = None
    kM: float | None = None
    density: float | None = None

    @property
    def uniform(self) -> bool:
        """Whether the springs are numbers, not arrays."""
        return np.ndim(self.kN) == 0 and np.ndim(self.kT) == 0

    def at_contacts(self, assembly: Assembly) -> Floats:
        """(contacts, 2), Pa: kN and kT of each contact."""
        if self.uniform:
            kN, kT = floats("kN", self.kN, ()), floats("kT", self.kT, ())
            return _core.springs_at_contacts(assembly._native, float(kN), float(kT), self.weighting)
        self._check_alone("springs of each contact", ("weighting", "bond_width", "kM"))
        m = len(assembly.contacts)
        columns = [_column(name, value, m) for name, value in (("kN", self.kN), ("kT", self.kT))]
        return np.stack(columns, axis=1)

    def _table(self) -> dict[str, Any]:
        """The keys that differ from their defaults."""
        return {field.name: value for field in dataclasses.fields(self)
                if (value := getattr(self, field.name)) is not field.default and value is not None}

    def _check_alone(self, what: str, excluded: tuple[str, ...]) -> None:
        for name, value in self._table().items():
            if name in excluded and value not in ("uniform", 0):
                raise BadInput(f"{what} with {name} = {value}", "they are kN and kT alone", f"Leave {name} out",
                               f"springs.{name}")

    def _native(self, assembly: Assembly) -> Floats:
        """The two numbers, or at_contacts()."""
        if self.uniform and self.weighting == "uniform":
            return floats("springs", [self.kN, self.kT], (2,))
        return self.at_contacts(assembly)


def _column(name: str, value: npt.ArrayLike, contacts: int) -> Floats:
    array = floats(name, value, (), (contacts,))
    return np.full(contacts, float(array)) if array.ndim == 0 else array


def springs_table(given: Any) -> dict[str, Any]:
    """All keys that were given of the table `springs`: by Springs, a dictionary, a pair, an array (contacts, 2), the
    result of calibrate or a part of it."""
    if isinstance(given, Springs):
        return given._table()
    if isinstance(given, Result):
        table = dict(given.get("springs", given))
        for name in ("achieved", "missing"):  # of the springs that the mean field advises
            table.pop(name, None)
        if not {"kN", "kT"} <= table.keys() or not table.keys() <= _fields():
            raise BadInput("a result without springs", "calibrate finds springs",
                           "Give equidem.Springs(kN=..., kT=...)", "springs")
        return table
    if isinstance(given, Mapping):
        return dict(given)
    if isinstance(given, np.ndarray) and given.ndim == 2 and given.shape[1] == 2:
        return {"kN": given[:, 0], "kT": given[:, 1]}
    if isinstance(given, (tuple, list, np.ndarray)) and len(given) == 2:
        return {"kN": given[0], "kT": given[1]}
    raise BadInput(f"springs of type {type(given).__name__}", "each contact has a normal and a tangential spring",
                   "Give equidem.Springs(kN=..., kT=...)", "springs")


def springs_from(given: Any) -> Springs:
    """The springs of springs_table, whose keys are checked here."""
    table = springs_table(given)
    for name in table:
        if name not in _fields():
            known = {key.lower(): key for key in sorted(_fields())}
            nearest = difflib.get_close_matches(str(name).lower(), known, 1)
            raise BadInput("unknown key", f"the keys are {', '.join(sorted(_fields()))}",
                           f"Did you mean '{known[nearest[0]]}'?" if nearest else "Remove it", f"springs.{name}")
    for name in ("kN", "kT"):
        if table.get(name) is None:
            raise BadInput("the key is missing", "each contact has a normal and a tangential spring", f"Give {name}",
                           f"springs.{name}")
    return Springs(**table)


def _fields() -> set[str]:
    return {field.name for field in dataclasses.fields(Springs)}
