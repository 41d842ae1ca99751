# SPDX-License-Identifier: GPL-3.0-or-later
"""Pictures of assemblies and curves of results with matplotlib."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt

from .assembly import Assembly
from .errors import BadInput
from .result import Result

if TYPE_CHECKING:
    from matplotlib.axes import Axes


def discs(assembly: Assembly, ax: Axes | None = None, *, displacements: npt.ArrayLike | None = None,
          scale: float | None = None, values: npt.ArrayLike | None = None, label: str = "", contacts: bool = True,
          cmap: str = "viridis") -> Axes:
    """The discs and their contacts.

    Parameters
    ----------
    displacements : array (n, 2), optional
        m.
    scale : float, optional
        By which displacements are multiplied; left out: as large as is easily seen.
    values : array (n,), optional
        Colours of the discs; with a `label` a colour bar has its name.
    """
    from matplotlib.collections import LineCollection

    axes = _axes(ax)
    places = np.array(assembly.centres)
    low, high = places.min(axis=0), places.max(axis=0)
    if displacements is not None:
        moves = np.asarray(displacements)
        largest = float(np.hypot(moves[:, 0], moves[:, 1]).max(initial=0.0))
        if scale is None:
            scale = 0.05 * float(np.max(high - low)) / largest if largest > 0 else 1.0
        places = places + scale * moves
        axes.set_title(f"displacements x {scale:.3g}")
    bodies(places, assembly.radii, axes, values=values, label=label, cmap=cmap)
    if contacts:
        inside = ~np.asarray(assembly.shifts).any(axis=1)
        pairs = np.asarray(assembly.contacts)[inside]
        axes.add_collection(LineCollection(list(places[pairs]), colors="#3b5b7a", linewidths=0.5))
    return axes


def bodies(centres: npt.ArrayLike, radii: npt.ArrayLike, ax: Axes | None = None, *, values: npt.ArrayLike | None = None,
           label: str = "", cmap: str = "viridis") -> Axes:
    """Discs at places (n, 2), in m, such as those of a frame; the other parameters as of `discs`."""
    from matplotlib.collections import EllipseCollection

    axes = _axes(ax)
    places, width = np.asarray(centres), 2 * np.asarray(radii)
    drawn = EllipseCollection(width, width, np.zeros(len(places)), units="x", offsets=places,
                              transOffset=axes.transData, facecolors="#dde6f0", edgecolors="#3b5b7a", linewidths=0.4)
    axes.add_collection(drawn)
    if values is not None:
        drawn.set_array(np.asarray(values))
        drawn.set_cmap(cmap)
        if label:
            axes.figure.colorbar(drawn, ax=axes, label=label)
    margin = float(width.max())
    axes.set_xlim(float(places[:, 0].min()) - margin, float(places[:, 0].max()) + margin)
    axes.set_ylim(float(places[:, 1].min()) - margin, float(places[:, 1].max()) + margin)
    axes.set_aspect("equal")
    axes.set_xlabel("x, m")
    axes.set_ylabel("y, m")
    return axes


def dispersion(result: Result, ax: Axes | None = None) -> Axes:
    """The branches of the waves of a periodic cell along the points of symmetry; unstable ones below zero."""
    axes = _axes(ax)
    curve = result.dispersion
    squared = np.asarray(curve.squared_frequencies)
    frequencies = np.sign(squared) * np.sqrt(np.abs(squared)) / (2 * np.pi)
    axes.plot(curve.along, frequencies, color="#3b5b7a", linewidth=0.8)
    axes.axhline(0, color="black", linewidth=0.5)
    axes.set_xlabel("along the path, rad/m")
    axes.set_ylabel("frequency, Hz")
    return axes


def of(result: Result, ax: Axes | None = None, **options: Any) -> Axes:
    """The picture that suits a result."""
    if "dispersion" in result:
        return dispersion(result, ax)
    if result.assembly is None:
        raise BadInput("the result has no picture", "it holds neither an assembly nor a curve",
                       "Plot its numbers, or those of a sweep")
    if "displacements" in result:
        options.setdefault("displacements", result.displacements)
    return discs(result.assembly, ax, **options)


def _axes(ax: Axes | None) -> Axes:
    if ax is not None:
        return ax
    import matplotlib.pyplot as plt

    return plt.subplots()[1]
