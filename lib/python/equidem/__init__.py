# SPDX-License-Identifier: GPL-3.0-or-later
"""equidem: the exact equilibrium of assemblies of discs, and the continuum they stand for.

>>> import equidem as eq
>>> block = eq.hexagonal(columns=21, rows=21, radius=5e-3)
>>> test = eq.tension_test(block, eq.Springs(kN=1e9, kT=0.5e9), stress=1e6)
>>> round(test.poisson_ratio, 3)
0.12

SI units, per metre of depth; angles in rad, counter-clockwise; tension positive.
"""

from __future__ import annotations

import sys

from . import _core, plot
from ._arrays import whole
from .assembly import Assembly, assembly, delaunay, hexagonal, read, square, triangulated
from .case import Case
from .errors import BadInput, ComputationFailed, EquidemError, Interrupted
from .fitting import ConsolidatedSand, FittedSprings, consolidate, fit_springs
from .result import Result
from .simulation import Frame, Simulation
from .springs import Springs
from .statics import (Factor, StrengthSample, calibrate, factorize, form_derivatives, homogenize, solve, stability,
                      stiffness_matrix, tension_test)
from .sweep import pack, pack_discs, run, simulation, study, sweep

_MOST_THREADS = 1024
__version__: str = _core.version

__all__ = [
    "Assembly", "BadInput", "Case", "ComputationFailed", "ConsolidatedSand", "EquidemError", "Factor",
    "FittedSprings", "Frame", "Interrupted", "Result", "Simulation", "Springs", "StrengthSample", "assembly",
    "calibrate", "consolidate", "delaunay", "factorize", "fit_springs", "form_derivatives", "hexagonal",
    "homogenize", "pack", "pack_discs", "plot", "read", "run", "set_threads", "show_progress", "simulation",
    "solve", "square", "stability", "stiffness_matrix", "study", "sweep", "tension_test", "threads", "triangulated",
]


def set_threads(count: int) -> None:
    """Number of threads of all computations; one per processor until set. Results have the same bits for any number."""
    _core.set_threads(whole("threads", count, 1, _MOST_THREADS))


def threads() -> int:
    """Number of threads of all computations."""
    return _core.threads()


def show_progress(shown: bool) -> None:
    """Whether long computations show their progress on stderr, in notebooks below the cell; they do until set."""
    _core.show_progress(bool(shown))


def _display(line: str) -> None:
    sys.stderr.write("\r" + line.ljust(79) + ("" if line else "\r"))
    sys.stderr.flush()


if "ipykernel" in sys.modules:
    _core.display_progress_by(_display)
