# SPDX-License-Identifier: GPL-3.0-or-later
"""Verbs over values of keys, packings, runs and studies."""

from __future__ import annotations

import os
from collections.abc import Iterable, Mapping
from typing import TYPE_CHECKING, Any

import numpy.typing as npt

from . import _core, _toml
from ._arrays import floats, whole
from .assembly import Assembly
from .case import Case
from .result import Result
from .simulation import Simulation

if TYPE_CHECKING:
    from pandas import DataFrame


def sweep(case: Case, values: Mapping[str, Iterable[Any]], *, verb: str = "homogenize", **options: Any) -> DataFrame:
    """Carry out a verb for all combinations of values of keys, as `equidem sweep` does.

    Parameters
    ----------
    case : Case
    values : dict
        ``{"springs.kT": [0.2e9, 0.4e9], "assembly.seed": range(3)}``; the last key varies fastest. "ratio" is kT/kN at
        the kN of the case.
    verb : str
    options
        Of `equidem sweep`, with "_" for "-": ``seeds="1-5"``, ``out="folder"``, ``resume=True``, ...

    Returns
    -------
    pandas.DataFrame
        A row for each point: the values, the status, then the numbers of the result, nested names joined by ".". The
        status is "failed" where a point has no answer, and ``message`` says why. ``attrs["units"]`` has the units.

    Raises
    ------
    ComputationFailed
        Where no point has an answer.
    """
    import pandas

    words = ["--verb", verb]
    for key, given in values.items():
        words += ["--key", key, "--values", ",".join(_word(value, key) for value in given)]
    result = case._carry_out("sweep", words, options)
    points = result.to_dict()["points"]
    table = pandas.json_normalize(points).set_index("point").drop(columns="value")
    units = {key["key"]: key["unit"] for key in result.to_dict()["keys"]}
    for name in table.columns:
        units.setdefault(name, result.units.get(f"points.{name}", ""))
    table.attrs["units"] = {name: unit for name, unit in units.items() if unit}
    return table


def _word(value: Any, key: str) -> str:
    """A value as the command line takes it."""
    return value if isinstance(value, str) else _toml.value(value, key)


def pack(packing: Mapping[str, Any], springs: Any = None, **tables: Any) -> Result:
    """Bodies in a box, at random or at rest; `result.assembly` is the packing.

    Parameters
    ----------
    packing : dict
        The table `packing` of the case file.
    springs : as of `Case`
        Of the contacts; bodies that grow or fall repel each other by them.

    Examples
    --------
    >>> import equidem as eq
    >>> packing = eq.pack({"grains": 60, "box": [0.1, 0.1], "radii": {"smallest": 4e-3, "largest": 6e-3},
    ...                    "method": "growth", "overlap": 1e-3, "sides": "periodic"}, (1e8, 0.5e8))
    >>> len(packing.assembly)
    60
    """
    return Case(packing=packing, springs=springs, **tables).pack()


def pack_discs(radii: npt.ArrayLike, box: tuple[float, float], *, method: str = "growth", sides: str = "periodic",
               seed: int = 1, overlap: float = 1e-6, attempts: int = 100_000,
               settling: Mapping[str, float] | None = None) -> Result:
    """Discs of given radii in a box, as dense as the method gets, without a case.

    Parameters
    ----------
    radii : array (n,)
        m, in the order in which the discs are placed; growth takes them as ratios.
    box : (width, height)
        m; falling: the height is not used.
    method, sides, seed, overlap, attempts
        Of the table `packing`; falling takes the sides "open_top".
    settling : dict, optional
        Of discs that fall: kN and kT in Pa, damping, friction, wall_friction, unbalanced, longest (s).

    Returns
    -------
    Result
        solid_fraction, coordination_number, coordination_number_without_rattlers, rattlers, largest_overlap, seconds;
        `assembly` is the network of the contacts between the discs.
    """
    network, found = _core.pack_discs(floats("radii", radii, (None,)), (float(box[0]), float(box[1])), method, sides,
                                      whole("seed", seed, 0), float(overlap), whole("attempts", attempts, 1),
                                      dict(settling or {}))
    return Result(found, assembly=Assembly._of(network))


def simulation(assembly: Assembly | None = None, springs: Any = None, **tables: Any) -> Simulation:
    """A simulation in time, ready to be stepped: bonded discs of an assembly, or the bodies of a table `grains`.

    Parameters
    ----------
    tables
        Of the case file, such as ``run={"duration": 1e-3}``, ``wall=[...]``, ``velocity=[...]``, and those of `Case`.
    """
    return Case(assembly=assembly, springs=springs, **tables).simulation()


def run(assembly: Assembly | None = None, springs: Any = None, **tables: Any) -> Result:
    """A simulation carried to its end; arrays as of `Case.run`."""
    return Case(assembly=assembly, springs=springs, **tables).run()


def study(name: str | os.PathLike[str], **options: Any) -> Result:
    """Error against time: a built-in study (`equidem study --list`), or that of a case file with a table `study`.

    Parameters
    ----------
    options
        ``accuracy=1e-4`` adds the cheapest setting for that error.
    """
    return Case._of_file(os.fspath(name)).run_verb("study", **options)
