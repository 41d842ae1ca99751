# SPDX-License-Identifier: GPL-3.0-or-later
"""Pictures of assemblies and curves of results with matplotlib."""

from __future__ import annotations

import re
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


def bodies(centres: npt.ArrayLike, radii: npt.ArrayLike, ax: Axes | None = None, *, angles: npt.ArrayLike | None = None,
           values: npt.ArrayLike | None = None, label: str = "", cmap: str = "viridis") -> Axes:
    """Discs or ellipses at their places, such as those of a frame; the other parameters as of `discs`. Bodies that a
    stage has removed have no place and are left out.

    Parameters
    ----------
    centres : array (n, 2)
        m.
    radii : array (n,) or (n, 2)
        m, of discs, or half-axes of ellipses.
    angles : array (n,), optional
        rad, from the x-axis to the first half-axis of each ellipse; left out: 0.
    """
    from matplotlib.collections import EllipseCollection

    places, axes_of = np.asarray(centres), 2 * np.asarray(radii)
    width = np.column_stack([axes_of, axes_of]) if axes_of.ndim == 1 else axes_of
    turned = np.zeros(len(places)) if angles is None else np.asarray(angles)
    there = np.isfinite(places).all(axis=1)
    if not there.any():
        raise BadInput("there is nothing to draw", "no body is there", "Draw an earlier state")
    places, width, turned = places[there], width[there], turned[there]
    axes = _axes(ax)
    drawn = EllipseCollection(width[:, 0], width[:, 1], np.degrees(turned), units="xy", offsets=places,
                              transOffset=axes.transData, facecolors="#dde6f0", edgecolors="#3b5b7a", linewidths=0.4)
    axes.add_collection(drawn)
    if values is not None:
        drawn.set_array(np.asarray(values)[there])
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


def curve(result: Result, ax: Axes | None = None) -> Axes:
    """Load over motion of `Case.quasistatic`: all states of equilibrium, and what a test that prescribes the motion or
    the load measures."""
    axes = _axes(ax)
    for name, label, style in (("curve", "events", {"color": "#56b4e9", "linewidth": 0.8}),
                               ("motion_envelope", "envelope under motion control", {"color": "#d55e00"}),
                               ("load_envelope", "envelope under load control", {"color": "black", "linestyle": "--"})):
        axes.plot(result[name].motion, result[name].load, label=label, **style)
    by_strain = result.units.get("events.load") == "Pa"
    axes.set_xlabel("mean strain" if by_strain else "motion, m")
    axes.set_ylabel("stress, Pa" if by_strain else "load, N/m")
    axes.ticklabel_format(scilimits=(-2, 4))
    axes.legend(frameon=False)
    return axes


def stress(result: Result, ax: Axes | None = None) -> Axes:
    """Stress over strain of `Case.run`, where walls or a cell load a sample; compression positive, of a cell that is
    pulled tension."""
    axes = _axes(ax)
    curves = result.curves
    for name in curves:
        if name.endswith("_MPa"):
            axes.plot(curves.strain, curves[name], label=name.removesuffix("_MPa").replace("_", " "))
    axes.set_xlabel("strain")
    axes.set_ylabel("stress, MPa")
    axes.legend(frameon=False)
    return axes


def energies(result: Result, ax: Axes | None = None) -> Axes:
    """The terms of the energy ledger of `Case.run` over time, those that are zero throughout left out."""
    axes = _axes(ax)
    terms = {name: np.asarray(column) for name, column in result.energies.items() if name != "time_s"}
    for name, column in terms.items():
        if np.abs(column).max(initial=0.0) > 0 and not name.startswith("error"):
            axes.plot(result.energies.time_s, column, label=re.sub("_J(_per_m)?$", "", name).replace("_", " "))
    axes.set_xlabel("time, s")
    axes.set_ylabel("energy, J/m" if any(name.endswith("_per_m") for name in terms) else "energy, J")
    axes.ticklabel_format(scilimits=(-2, 4))
    axes.legend(frameon=False)
    return axes


def of(result: Result, ax: Axes | None = None, **options: Any) -> Axes:
    """The picture that suits a result."""
    for name, drawn in (("dispersion", dispersion), ("load_envelope", curve), ("curves", stress),
                        ("energies", energies)):
        if name in result and not (name == "energies" and "time_s" not in result.energies):
            return drawn(result, ax, **options)
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
