# SPDX-License-Identifier: GPL-3.0-or-later
"""Verbs over values of keys, packings, runs and studies."""

from __future__ import annotations

import itertools
from collections.abc import Iterable, Mapping
from typing import TYPE_CHECKING, Any

from .assembly import Assembly
from .case import Case
from .errors import BadInput, ComputationFailed
from .result import Result
from .simulation import Simulation

if TYPE_CHECKING:
    from pandas import DataFrame


def sweep(case: Case, values: Mapping[str, Iterable[Any]], *, verb: str = "homogenize", **options: Any) -> DataFrame:
    """Carry out a verb for all combinations of values of keys.

    Parameters
    ----------
    case : Case
    values : dict
        ``{"springs.kT": [0.2e9, 0.4e9], "assembly.seed": range(3)}``; the last key varies fastest.
    verb : str
    options
        Of the verb.

    Returns
    -------
    pandas.DataFrame
        A row for each point: the values, then the numbers of the result, nested names joined by "."; ``error`` holds the
        sentence where a point has no answer. ``attrs["units"]`` has the units.
    """
    import pandas

    if not values:
        raise BadInput("nothing is varied", "a sweep needs the values of at least one key",
                       'Give them, such as {"springs.kT": [...]}', "values")
    lists = {key: list(given) for key, given in values.items()}
    rows: list[dict[str, Any]] = []
    units: dict[str, str] = {}
    for point in itertools.product(*lists.values()):
        chosen = dict(zip(lists, point))
        varied = case.copy()
        for key, value in chosen.items():
            varied.set(key, value)
        try:
            result = varied.run_verb(verb, **options)
            units.update(result.units)
            rows.append({**chosen, **_numbers(result.to_dict()), "error": ""})
        except (BadInput, ComputationFailed) as error:
            rows.append({**chosen, "error": str(error)})
    table = pandas.DataFrame(rows)
    table.attrs["units"] = {name: units[name] for name in table.columns if units.get(name)}
    return table


def _numbers(values: Mapping[str, Any], prefix: str = "") -> dict[str, float]:
    found: dict[str, float] = {}
    for name, value in values.items():
        if isinstance(value, Mapping):
            if name not in ("times", "machine"):
                found.update(_numbers(value, f"{prefix}{name}."))
        elif isinstance(value, (int, float)) and not isinstance(value, bool):
            found[prefix + name] = value
    return found


def pack(packing: Mapping[str, Any], springs: Any = None, **tables: Any) -> Result:
    """Bodies in a box, at random or at rest; `result.assembly` is the packing.

    Parameters
    ----------
    packing : dict
        The table `packing` of the case file.
    springs : Springs, (kN, kT) or dict
        Of the contacts; bodies that grow or fall push each other by them.

    Examples
    --------
    >>> import equidem as eq
    >>> packing = eq.pack({"grains": 60, "box": [0.1, 0.1], "radii": {"smallest": 4e-3, "largest": 6e-3},
    ...                    "method": "growth", "overlap": 1e-3, "sides": "periodic"}, (1e8, 0.5e8))
    >>> len(packing.assembly)
    60
    """
    return Case(packing=packing, springs=springs, **tables).pack()


def simulation(assembly: Assembly | None = None, springs: Any = None, **tables: Any) -> Simulation:
    """A simulation in time, ready to be stepped: bonded discs of an assembly, or the bodies of a table `grains`.

    Parameters
    ----------
    tables
        Of the case file, such as ``run={"duration": 1e-3}``, ``wall=[...]``, ``velocity=[...]``, and those of `Case`.
    """
    return Case(assembly=assembly, springs=springs, **tables).simulation()


def run(assembly: Assembly | None = None, springs: Any = None, **tables: Any) -> Result:
    """The same to its end; the result holds the energy balance, events, waves and probes."""
    return Case(assembly=assembly, springs=springs, **tables).run()


def study(name: str, **options: Any) -> Result:
    """Error against time: a built-in study (`equidem study --list`), or that of a case file with a table `study`.

    Parameters
    ----------
    options
        ``accuracy=1e-4`` adds the cheapest setting for that error.
    """
    return Case(name).run_verb("study", **options)
