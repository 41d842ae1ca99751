# SPDX-License-Identifier: GPL-3.0-or-later
"""Results: the numbers of result.json as attributes, and the arrays that are too large for it."""

from __future__ import annotations

import difflib
import html
import json
import math
import os
import re
import tempfile
from collections.abc import Iterator, Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

from .errors import BadInput, without_memory_names

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from pandas import DataFrame

    from . import _core
    from .assembly import Assembly


class Result(Mapping[str, Any]):
    """The result of a verb.

    Its numbers have the names of result.json (`equidem help result` lists them) and are attributes and keys alike:
    ``result.poisson_ratio``, ``result["poisson_ratio"]``. Nested objects are results too:
    ``result.plane_strain.young_modulus``, which also stands for ``result.young_modulus.plane_strain``. Arrays,
    such as ``result.displacements``, are read-only views.

    Attributes
    ----------
    elapsed : float
        s, wall clock of the verb in C++; nan where a result is not that of a verb.
    assembly : Assembly or None
        What was computed on, without discs that carry no load; of `pack`: what was made.
    """

    def __init__(self, values: Mapping[str, Any], arrays: Mapping[str, tuple[Any, str]] = {},
                 assembly: Assembly | None = None, delivered: _core.Delivered | None = None) -> None:
        own = dict(values)
        self._texts_read = False
        self._units: dict[str, str] = {}
        self._labels: dict[str, str] = {}
        self._report = ""
        self.assembly = assembly
        self.elapsed = math.nan
        self._delivered = delivered
        self._plain: dict[str, Any] = own
        self._arrays: dict[str, Any] = {}
        nested: dict[str, dict[str, tuple[Any, str]]] = {}
        for name, (array, unit) in arrays.items():
            first, _, rest = name.partition("/")
            if rest:
                nested.setdefault(first, {})[rest] = (array, unit)
            else:
                self._arrays[first] = array
                self._units[first] = unit
        self._values: dict[str, Any] = {name: _wrapped(value) for name, value in own.items()}
        self._values.update(self._arrays)
        for name, parts in nested.items():
            inner = own.get(name, {})
            self._arrays[name] = self._values[name] = Result(inner if isinstance(inner, Mapping) else {}, parts)

    def _read_texts(self) -> None:
        """Take over report, units and labels, which are not made before they are asked for."""
        if not self._texts_read and self._delivered is not None:
            found = json.loads(without_memory_names(self._delivered.texts()))
            self._units = {**found["units"], **self._units}
            self._labels, self._report = found["labels"], found["report"]
        self._texts_read = True

    @property
    def units(self) -> dict[str, str]:
        """Unit of each number and array by its name, nested names joined by "."."""
        self._read_texts()
        return self._units

    @property
    def labels(self) -> dict[str, str]:
        """Meaning of each number by its name."""
        self._read_texts()
        return self._labels

    @property
    def report(self) -> str:
        """The text that the command line prints."""
        self._read_texts()
        return self._report

    def __getstate__(self) -> dict[str, Any]:
        self._read_texts()
        return {**self.__dict__, "_delivered": None}

    def __getitem__(self, name: str) -> Any:
        return self._values[name]

    def __getattr__(self, name: str) -> Any:
        if name.startswith("_"):
            raise AttributeError(name)
        try:
            return self._values[name]
        except KeyError:
            if name in ("plane_strain", "plane_stress"):
                parts = {key: part[name] for key, part in self._values.items()
                         if isinstance(part, Result) and name in part}
                if parts:
                    return Result(parts)
            near = difflib.get_close_matches(name, self._values, 3, 0.5)
            known = " or ".join(f"'{one}'" for one in near)
            raise AttributeError(f"the result has no '{name}'. {f'Did you mean {known}? ' if near else ''}"
                                 "list(result) names all that it has") from None

    def __iter__(self) -> Iterator[str]:
        return iter(self._values)

    def __len__(self) -> int:
        return len(self._values)

    def __dir__(self) -> list[str]:
        return [*super().__dir__(), *self._values]

    def to_dict(self) -> dict[str, Any]:
        """The numbers as plain dictionaries and lists, as in result.json; arrays are left out."""
        return dict(self._plain)

    @property
    def histories(self) -> dict[str, DataFrame]:
        """Tables of the result, by name, with units in the names of their columns: of a run ``history`` (probes, walls,
        cell and energies, with ``output.probe_interval``), ``curves`` (stress, volume and friction over the strain of a
        test), ``measures_history`` and ``energies``; of a path of breaks ``curve`` and its envelopes. It needs pandas.
        """
        import pandas

        tables = {}
        for name, part in self._values.items():
            columns = dict(part) if isinstance(part, Result) else {}
            shapes = {np.shape(column) if hasattr(column, "shape") or isinstance(column, list) else () for column
                      in columns.values()}
            if len(shapes) == 1 and len(shape := shapes.pop()) == 1 and (part._arrays or shape[0] > 3):
                tables[name] = pandas.DataFrame(columns)
        return tables

    def save_page(self, path: str | os.PathLike[str], *, overwrite: bool = False) -> None:
        """Write the result as one HTML page that needs nothing else: the answer with its error, the case, what acts,
        figures, warnings and the way to repeat it.

        It is the page that the verb writes with ``out="folder"``; the figures are drawn now.

        Raises
        ------
        BadInput
            Where the file exists and `overwrite` is false, and where the result is only a part of one, or was
            unpickled.
        """
        if self._delivered is None:
            raise BadInput("this result has no page",
                           "pages are of the results of whole verbs, before they are pickled",
                           "Save the page of what solve, homogenize, run, ... returned")
        if not overwrite and os.path.exists(path):
            raise BadInput(f"'{os.fspath(path)}' exists", "it would be lost",
                           "Choose another name, or give overwrite=True")
        with tempfile.TemporaryDirectory(prefix="equidem_") as folder:
            text = self._delivered.page(folder)
        # The name of an assembly in memory is that of no file; lines of embedded figures, up to megabytes, have none.
        text = "\n".join(re.sub(r"(&quot;)?[^ &\n]*assembly#\d+(&quot;)?", "&quot;assembly.json&quot;", line)
                         if "assembly#" in line else line for line in text.split("\n"))
        with open(path, "w", encoding="utf-8") as file:
            file.write(text)

    def __repr__(self) -> str:
        if self.report:
            return self.report.rstrip("\n")
        return "Result(" + ", ".join(f"{k}={_short(v)}" for k, v in self._values.items()) + ")"

    def _repr_html_(self) -> str:
        if self.report:
            return f"<pre>{html.escape(self.report)}</pre>"
        rows = "".join(f"<tr><td>{html.escape(k)}</td><td>{html.escape(_short(v))}</td>"
                       f"<td>{html.escape(self.units.get(k, ''))}</td></tr>" for k, v in self._values.items())
        return f"<table>{rows}</table>"

    def plot(self, ax: Axes | None = None, **options: Any) -> Axes:
        """Draw the result with matplotlib: the deformed discs of a solution, the branches of a dispersion, load over
        motion of a path of breaks, stress over strain of a run that tests a sample, the energies of another run, error
        over time of a study, or the discs of a packing.

        Parameters
        ----------
        ax : matplotlib axes, optional
        options
            Of `equidem.plot.discs`, where discs are drawn.
        """
        from . import plot

        return plot.of(self, ax, **options)


def _wrapped(value: Any) -> Any:
    if isinstance(value, Mapping):
        return Result(value)
    if isinstance(value, list) and value and isinstance(value[0], Mapping):
        return [Result(item) for item in value]
    return value


def _short(value: Any) -> str:
    if isinstance(value, Result):
        return "..."
    if hasattr(value, "shape"):
        return f"array{value.shape}"
    if isinstance(value, float):
        return f"{value:.6g}"
    text = repr(value)
    return text if len(text) <= 60 else text[:57] + "..."
