# SPDX-License-Identifier: GPL-3.0-or-later
"""Assemblies: discs and the contacts that join them."""

from __future__ import annotations

import os
from collections.abc import Mapping
from typing import Any

import numpy.typing as npt

from . import _core, _toml
from ._arrays import Floats, Integers, floats, integers, share
from .errors import BadInput


class Assembly:
    """Discs, or other bodies, and the contacts that join them; SI units, per metre of depth. It is immutable.

    Parameters
    ----------
    centres : array (n, 2)
        m.
    radii : array (n,) or number
        m.
    contacts : array (m, 2) or (m, 4), optional
        The two discs i and j of each contact; periodic cells: i, j and by how many periods in x and y the image of j is
        shifted that i touches. Left out: the pairs whose gap is at most `gap_tolerance` times the sum of their radii.
    levers : array (m, 2), optional
        m, distances of the contact point from the centres of i and j; left out: half the distance of the centres for
        given contacts, the distance in the ratio of the radii for those that are found.
    cell : (Lx, Ly), optional
        m, the period of a periodic cell.
    gap_tolerance : float
        From 0 to 1; 0: discs that overlap or touch.

    Raises
    ------
    BadInput
        Wrong shapes, numbers that are not finite, radii that are not positive, discs that do not exist, no contacts.

    Notes
    -----
    Arrays are read-only views of the memory of the assembly, which lives as long as one of them.
    """

    _native: _core.Assembly

    def __init__(self, centres: npt.ArrayLike, radii: npt.ArrayLike, contacts: npt.ArrayLike | None = None, *,
                 levers: npt.ArrayLike | None = None, cell: tuple[float, float] | None = None,
                 gap_tolerance: float = 0.0) -> None:
        places = floats("centres", centres, (None, 2))
        n = len(places)
        sizes = floats("radii", radii, (), (n,))
        sizes = sizes if sizes.ndim else floats("radii", [float(sizes)] * n, (n,))
        pairs = None if contacts is None else integers("contacts", contacts, (None, 2), (None, 4))
        arms = None
        if levers is not None:
            if pairs is None:
                raise BadInput("levers without contacts", "each belongs to a contact", "Give the contacts", "levers")
            arms = floats("levers", levers, (len(pairs), 2))
        tolerance = share("gap_tolerance", gap_tolerance)
        if pairs is not None and tolerance > 0:
            raise BadInput("contacts and gap_tolerance are both given", "the tolerance finds contacts",
                           "Leave one of them out", "gap_tolerance")
        period = None
        if cell is not None:
            sides = floats("cell", cell, (2,))
            period = (float(sides[0]), float(sides[1]))
        self._native = _core.from_arrays(places, sizes, pairs, arms, period, tolerance)

    @staticmethod
    def _of(native: _core.Assembly) -> Assembly:
        made = Assembly.__new__(Assembly)
        made._native = native
        return made

    def __len__(self) -> int:
        """Number of discs."""
        return len(self._native)

    def __repr__(self) -> str:
        cell = f", cell {self.cell[0]:.4g} x {self.cell[1]:.4g} m" if self.cell else ""
        return f"<Assembly of {len(self)} discs, {len(self.contacts)} contacts{cell}>"

    def __reduce__(self) -> tuple[Any, ...]:
        return Assembly._of_json, (self._native.json(),)

    @staticmethod
    def _of_json(text: str) -> Assembly:
        return Assembly._of(_core.from_json(text))

    def with_strengths(self, strengths: npt.ArrayLike) -> Assembly:
        """The same assembly whose contacts have strengths of their own, for `Case.quasistatic`.

        Parameters
        ----------
        strengths : array (m, 2)
            N/m, of each contact in tension and in shear.

        Raises
        ------
        BadInput
            Another shape, or a strength that is negative or not finite.
        """
        rows = floats("strengths", strengths, (len(self.contacts), 2))
        return Assembly._of(self._native.with_strengths(rows))

    def with_forces(self, forces: npt.ArrayLike) -> Assembly:
        """The same assembly whose contacts carry forces at rest.

        Parameters
        ----------
        forces : array (m, 2)
            N/m, of each contact on i: along the normal from i to j (tension positive) and along the tangent, the normal
            turned by 90 degrees counter-clockwise.

        Raises
        ------
        BadInput
            Another shape, or a force that is not finite.
        """
        rows = floats("forces", forces, (len(self.contacts), 2))
        return Assembly._of(self._native.with_forces(rows))

    def disc_stresses(self, forces: npt.ArrayLike) -> Floats:
        """Stress of each disc under forces of its contacts: s_ij = (1/V) sum F_i l_j, l from its centre to each contact
        point and V the area of its cell (Abe 1996, eq. 50). Not symmetric where a moment holds the disc.

        Parameters
        ----------
        forces : array (m, 2)
            N/m, as of `with_forces`, such as `contact_forces` of a solution.

        Returns
        -------
        array (n, 2, 2)
            Pa.

        Raises
        ------
        BadInput
            Another shape, a force that is not finite, or a disc whose cell has no area.
        """
        rows = floats("forces", forces, (len(self.contacts), 2))
        return self._native.disc_stresses(rows).reshape(-1, 2, 2)

    @property
    def kind(self) -> str:
        """"hexagonal", "square", "delaunay", "arrays", "file", ..."""
        return self._native.kind

    @property
    def centres(self) -> Floats:
        """(n, 2), m."""
        return self._native.centres

    @property
    def radii(self) -> Floats:
        """(n,), m."""
        return self._native.radii

    @property
    def contacts(self) -> Integers:
        """(m, 2): the discs i and j."""
        return self._native.contacts

    @property
    def shifts(self) -> Integers:
        """(m, 2): by how many periods the image of j is shifted that i touches."""
        return self._native.shifts

    @property
    def levers(self) -> Floats:
        """(m, 2), m: distances of the contact point from the centres of i and j."""
        return self._native.levers

    @property
    def normals(self) -> Floats:
        """(m, 2): unit normals from i to j; computed at each call."""
        return self._native.normals

    @property
    def cell_areas(self) -> Floats:
        """(n,), m²: the Voronoi (power) cell of each disc."""
        return self._native.cell_areas

    @property
    def facet_lengths(self) -> Floats:
        """(m,), m: the edge that the cells of both discs share; empty where unknown."""
        return self._native.facet_lengths

    @property
    def forces(self) -> Floats:
        """(m, 2), N/m: normal (tension positive) and tangential force that each contact carries at rest; (0, 2) where
        none are given; computed at each call."""
        return self._native.forces

    @property
    def cell(self) -> tuple[float, float] | None:
        """(Lx, Ly), m, of a periodic cell; None: free boundary."""
        return self._native.period

    @property
    def area(self) -> float:
        """m²: of the periodic cell, else the sum of the cells of the discs."""
        return self._native.area

    @property
    def solid_fraction(self) -> float:
        """Share of the area that the bodies cover."""
        return self._native.solid_fraction

    @property
    def coordination_number(self) -> float:
        """Mean number of contacts of a disc."""
        return self._native.coordination_number

    @property
    def groups(self) -> Mapping[str, Integers]:
        """The discs of each group: left, right, bottom, top, ... of a free assembly, and those of its file."""
        return self._native.groups

    def write(self, path: str | os.PathLike[str], *, overwrite: bool = False) -> None:
        """Write an assembly file: HDF5 where the name ends in .h5 or .hdf5, else JSON. Reading it back gives the same
        bits."""
        _core.write_assembly(os.fspath(path), self._native, overwrite)

    def plot(self, ax: Any = None, **options: Any) -> Any:
        """Draw the discs and their contacts with matplotlib; see `equidem.plot.discs`."""
        from . import plot

        return plot.discs(self, ax, **options)


def read(path: str | os.PathLike[str], *, gap_tolerance: float = 0.0, unit_of_length: str = "",
         frame: int | None = None, contacts: str | os.PathLike[str] | None = None, periodic_box: bool | None = None,
         period: tuple[float, float] | None = None, plane: str = "x-y") -> Assembly:
    """Read an assembly file, JSON or HDF5, or a packing of another program: a LAMMPS data file or dump, a text export
    of YADE, a table with the columns x, y and radius or diameter.

    Parameters
    ----------
    gap_tolerance : float
        For a file without contacts: pairs whose gap is at most this share of the sum of their radii touch.
    unit_of_length : str
        Unit of lengths in a file of another program that does not say it: "m", "mm", a length such as "2.5 mm".
    frame : int, optional
        Time step of the frame of a LAMMPS dump; default: its last.
    contacts : path, optional
        Table of the contacts of such a file, with the columns i and j.
    periodic_box : bool, optional
        Whether the box of a LAMMPS file is the periodic cell; default: as its flags say.
    period : (float, float), optional
        Width and height in m of the periodic cell of such a file without a box.
    plane : str
        Plane that such a sample lies in: "x-y", "x-z" or "y-z"; its second axis is read as y.
    """
    tolerance = share("gap_tolerance", gap_tolerance)
    return Assembly._of(_core.read_assembly(os.fspath(path), tolerance, unit_of_length, frame,
                                            None if contacts is None else os.fspath(contacts), periodic_box, period,
                                            plane))


def assembly(**keys: Any) -> Assembly:
    """The assembly of a table ``[assembly]`` of the case file: ``equidem help case`` lists its keys.

    Examples
    --------
    >>> import equidem as eq
    >>> len(eq.assembly(kind="square", columns=4, rows=3, radius=1e-3))
    12
    """
    # the reader of cases asks for springs, which the assembly does not depend on
    tables = {"assembly": keys, "springs": {"kN": 1.0, "kT": 1.0}}
    return Assembly._of(_core.build_assembly(_toml.document(tables)))


def hexagonal(**keys: Any) -> Assembly:
    """A block of the hexagonal lattice (Abe 1996, Figs. 5 and 6).

    Parameters
    ----------
    columns, rows : int
        Discs in the first row, and number of rows.
    radius : float
        m.
    periodic : bool
        A periodic cell; rows are then even.
    """
    return assembly(kind="hexagonal", **keys)


def square(**keys: Any) -> Assembly:
    """A block of the square lattice, with the parameters of `hexagonal`."""
    return assembly(kind="square", **keys)


def delaunay(**keys: Any) -> Assembly:
    """Random points and their Delaunay (or, for different radii, regular) triangulation, whose edges are the contacts.

    Parameters
    ----------
    discs : int
        Wanted number; len() is the number reached.
    seed : int
    points : str
        "poisson_disc", "perturbed_hexagonal" or "random".
    disorder : float
        Of "perturbed_hexagonal", from 0 to below 0.5.
    radius : float, or radii : {"smallest": ..., "largest": ...}
        m.
    aspect : float
        Width over height; or box : (width, height) in m instead of discs.
    periodic : bool
    """
    return assembly(kind="delaunay", **keys)


def triangulated(centres: npt.ArrayLike, radii: npt.ArrayLike, *, cell: tuple[float, float] | None = None) -> Assembly:
    """Given discs whose contacts are the edges of their Delaunay (or, for different radii, regular) triangulation.

    Parameters
    ----------
    centres : array (n, 2)
        m.
    radii : array (n,)
        m.
    cell : (Lx, Ly), optional
        m, the period of a periodic cell.
    """
    places = floats("centres", centres, (None, 2))
    sides = None if cell is None else floats("cell", cell, (2,))
    period = None if sides is None else (float(sides[0]), float(sides[1]))
    return Assembly._of(_core.triangulated(places, floats("radii", radii, (len(places),)), period))
