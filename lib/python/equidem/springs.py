# SPDX-License-Identifier: GPL-3.0-or-later
"""The springs of contacts."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from . import _core
from ._arrays import Floats, floats
from .assembly import Assembly
from .errors import BadInput


@dataclass(frozen=True, eq=False)
class Springs:
    """Normal and tangential springs of contacts.

    Parameters
    ----------
    kN, kT : float or array (contacts,)
        Pa (N/m per metre of depth).
    weighting : str
        Of numbers: "uniform", "contact_density", "local_contact_density" or "voronoi" (`equidem help case`).
    bond_width : float
        Width w of a bond over the diameter of its smaller disc: contacts resist bending with kM = kN w²/12, the
        stiffness of a parallel bond (Potyondy and Cundall 2004). 0: they carry no moments. For kN and kT that are
        numbers.
    """

    kN: Any
    kT: Any
    weighting: str = "uniform"
    bond_width: float = 0.0

    @property
    def uniform(self) -> bool:
        """Whether the springs are numbers, not arrays."""
        return np.ndim(self.kN) == 0 and np.ndim(self.kT) == 0

    def at_contacts(self, assembly: Assembly) -> Floats:
        """(contacts, 2), Pa: kN and kT of each contact."""
        if self.uniform:
            kN, kT = floats("kN", self.kN, ()), floats("kT", self.kT, ())
            return _core.springs_at_contacts(assembly._native, float(kN), float(kT), self.weighting)
        m = len(assembly.contacts)
        columns = [_column(name, value, m) for name, value in (("kN", self.kN), ("kT", self.kT))]
        return np.stack(columns, axis=1)

    def _without_bending(self, wanted: str) -> Springs:
        """Itself. Errors: bond_width is given, which `wanted` does not take."""
        if self.bond_width == 0:
            return self
        raise BadInput(f"springs with bond_width = {self.bond_width}", f"{wanted} takes springs without moments",
                       "Leave bond_width out", "springs")

    def _native(self, assembly: Assembly) -> Floats:
        """The two numbers, or at_contacts()."""
        if self.uniform and self.weighting == "uniform":
            return floats("springs", [self.kN, self.kT], (2,))
        return self.at_contacts(assembly)


def _column(name: str, value: npt.ArrayLike, contacts: int) -> Floats:
    array = floats(name, value, (), (contacts,))
    return np.full(contacts, float(array)) if array.ndim == 0 else array


def springs_from(given: Any) -> Springs | None:
    """Springs from anything with kN and kT: Springs, a dictionary, a pair, or a part of the result of calibrate."""
    if given is None or isinstance(given, Springs):
        return given
    if isinstance(given, dict) or hasattr(given, "keys"):
        known = {name: given[name] for name in ("kN", "kT", "weighting", "bond_width") if name in given}
        if "kN" in known and "kT" in known:
            return Springs(**known)
    elif isinstance(given, (tuple, list)) and len(given) == 2:
        return Springs(*given)
    raise BadInput(f"springs of type {type(given).__name__}", "each contact has a normal and a tangential spring",
                   "Give equidem.Springs(kN=..., kT=...)", "springs")
