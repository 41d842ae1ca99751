# SPDX-License-Identifier: GPL-3.0-or-later
"""Cases: everything that the command line can do."""

from __future__ import annotations

import contextlib
import itertools
import json
import os
import pathlib
import tempfile
from collections.abc import Iterable, Iterator, Mapping
from typing import Any

import numpy as np

from . import _core, _toml
from ._arrays import integers
from .assembly import Assembly
from .errors import BadInput, EquidemError, without_memory_names
from .result import Result
from .simulation import Simulation
from .springs import springs_from, springs_table


class Case:
    """A case file, or its tables as dictionaries. Its verbs are those of the program, with the same defaults.

    Parameters
    ----------
    file : path, optional
        A case file (TOML) that exists. Its tables may be changed by `set`.
    assembly : Assembly, optional
        In place of a table `assembly`; only without a file.
    springs : Springs, (kN, kT), dict, path of a springs file or the result of calibrate, optional
        In place of those that the assembly has.
    supports : sequence of dict
        ``{"group": "left", "ux": 0.0, "uy": 0.0, "rotation": 0.0}``, in m and rad; what is left out stays free. A group
        is a name, or an array of disc numbers.
    loads : sequence of dict
        ``{"group": "right", "force": (1e6, 0), "moment": 0, "kind": "traction"}``; kinds "per_disc" (N/m), "total"
        (N/m) and "traction" (Pa).
    tables
        Further tables by their names in the case file: ``effects={"rotation": "restrained"}``. Groups of `dead_load`,
        `velocity` and `probe` may be arrays too.

    Examples
    --------
    >>> import equidem as eq
    >>> case = eq.Case(assembly={"kind": "hexagonal", "columns": 21, "rows": 21, "radius": 5e-3},
    ...                springs=(1e9, 0.5e9), test={"kind": "uniaxial_tension", "stress": 1e6})
    >>> round(case.set("springs.kT", 0.0).solve().poisson_ratio, 6)
    0.25
    """

    def __init__(self, file: str | os.PathLike[str] | None = None, *,
                 assembly: Assembly | Mapping[str, Any] | None = None, springs: Any = None,
                 supports: Iterable[Mapping[str, Any]] = (), loads: Iterable[Mapping[str, Any]] = (),
                 **tables: Any) -> None:
        self._file = "" if file is None else os.fspath(file)
        if self._file and not os.path.exists(self._file):
            raise BadInput(f"no such file '{self._file}'", f"the folder is {os.getcwd()}", "Correct the name")
        self._assembly: Assembly | None = None
        self._tables: dict[str, Any] = {}
        self._overrides: list[str] = []
        if self._file:
            if assembly is not None or springs is not None or supports or loads or tables:
                raise BadInput("a case file and tables beside it", "the file holds all of them",
                               "Change keys of the file by set()")
            return
        self._tables = {name: table for name, table in tables.items() if table is not None}
        self._set_assembly(assembly, springs)
        self._groups: list[dict[str, Any]] = list(self._tables.pop("group", []))
        for name, entries in (("support", supports), ("load", loads)):
            listed = [*self._tables.get(name, []), *entries]
            if listed:
                self._tables[name] = listed
        for name in ("support", "load", "dead_load", "velocity", "probe"):
            if name in self._tables:
                self._tables[name] = [self._with_group(name, entry) for entry in self._tables[name]]
        if self._groups:
            self._tables["group"] = self._groups

    @staticmethod
    def _of_file(name: str) -> Case:
        """The case of a file, whose existence is not checked."""
        case = Case()
        case._file = name
        return case

    def _set_assembly(self, assembly: Assembly | Mapping[str, Any] | None, springs: Any) -> None:
        if isinstance(assembly, Assembly):
            table: dict[str, Any] = {"kind": "file", "path": "assembly"}
            density = self._tables.pop("density", None)
            if density is not None:
                table["density"] = density
            if springs is not None or "material" in self._tables:
                table["own_springs"] = False
            self._tables["assembly"] = table
            self._assembly = assembly
        elif assembly is not None:
            self._tables["assembly"] = dict(assembly)
        if isinstance(springs, (str, os.PathLike)):
            self._tables["springs"] = springs
        elif springs is not None:
            given = springs_table(springs)
            if self._assembly is None or not any(np.ndim(given.get(name, 0)) for name in ("kN", "kT")):
                self._tables["springs"] = given
                return
            each = springs_from(given)
            self._assembly = Assembly._of(self._assembly._native.with_springs(each.at_contacts(self._assembly)))
            self._tables["assembly"]["own_springs"] = True
            if each.density is not None:
                density = self._tables["assembly"].setdefault("density", each.density)
                if density != each.density:
                    raise BadInput(f"the density is {density:g} kg/m³, and that of the springs {each.density:g}",
                                   "discs have one", "Leave one of them out", "density")

    def _with_group(self, table: str, entry: Mapping[str, Any]) -> dict[str, Any]:
        """The entry with the name of its group, made where it lists discs."""
        if not isinstance(entry, Mapping):
            raise BadInput(f"a {table} of type {type(entry).__name__}", "it is a table of keys",
                           'Give a dictionary such as {"group": "left", ...}', table)
        named = dict(entry)
        group = named.get("group")
        if group is None or isinstance(group, str):
            return named
        discs = np.unique(integers(f"{table}.group", group, (None,))).tolist()
        for known in self._groups:
            if known.get("discs") == discs:
                named["group"] = known["name"]
                return named
        taken = {known.get("name") for known in self._groups}
        if self._assembly is not None:
            taken |= set(self._assembly.groups)
        named["group"] = next(name for name in map("discs {}".format, itertools.count(1)) if name not in taken)
        self._groups.append({"name": named["group"], "discs": discs})
        return named

    def set(self, key: str, value: Any) -> Case:
        """Set a key, such as "springs.kT" or "load.0.moment"; None takes it out. Returns the case."""
        self._overrides.append(f"{key}=" + ("none" if value is None else _toml.value(value, key)))
        return self

    def copy(self) -> Case:
        """A case of its own with the same file, tables and changes."""
        copied = Case._of_file("")
        copied.__dict__.update(self.__dict__)
        copied._overrides = list(self._overrides)
        return copied

    def __repr__(self) -> str:
        what = repr(self._file) if self._file else ", ".join(self._tables)
        return f"<Case {what}{', ' + ', '.join(self._overrides) if self._overrides else ''}>"

    def _inputs(self) -> tuple[str, str, _core.Assembly | None, list[str]]:
        native = self._assembly._native if self._assembly is not None else None
        return _toml.document(self._tables), self._file, native, self._overrides

    def run_verb(self, verb: str, **options: Any) -> Result:
        """Carry out a verb of the program.

        Parameters
        ----------
        options
            Of the command line, with "_" for "-": ``accuracy=1e-3``, ``dry_run=True``, ``out="folder"``,
            ``overwrite=True``, ``require_stable=True``, ...
        """
        return self._carry_out(verb, [], options)

    def _carry_out(self, verb: str, words: list[str], options: Mapping[str, Any]) -> Result:
        """Carry out a verb. `words` come before the options."""
        words = list(words)
        for name, value in options.items():
            option = "--" + name.replace("_", "-")
            if value is True:
                words.append(option)
            elif value is not None and value is not False:
                words += [option, os.fspath(value) if isinstance(value, (str, os.PathLike)) else str(value)]
        with self._kept_assembly(options) as case:
            text, file, native, overrides = case._inputs()
            numbers, arrays, made, seconds, delivered = _core.run_verb(verb, text, file, native, overrides, words)
        assembly = self._assembly if made is None else Assembly._of(made)
        result = Result(json.loads(without_memory_names(numbers)), arrays, assembly, delivered)
        result.elapsed = seconds
        return result

    @contextlib.contextmanager
    def _kept_assembly(self, options: Mapping[str, Any]) -> Iterator[Case]:
        """The case; with `out` and an assembly in memory the case with that in a file of the folder, so that the case
        file written there can be run again. The file is taken away where the verb fails."""
        out = options.get("out")
        if self._assembly is None or out is None or options.get("dry_run"):
            yield self
            return
        path = pathlib.Path(out).absolute() / "given_assembly.h5"
        before = path.exists()
        if before and options.get("resume"):
            self._check_same_assembly(path)
        else:
            self._assembly.write(path, overwrite=bool(options.get("overwrite")))
        copied = self.copy()
        copied._assembly = None
        copied._tables = {**self._tables, "assembly": {**self._tables["assembly"], "path": str(path)}}
        try:
            yield copied
        except EquidemError:
            if not before:
                path.unlink()
                with contextlib.suppress(OSError):  # the folder holds more
                    path.parent.rmdir()
            raise

    def _check_same_assembly(self, path: pathlib.Path) -> None:
        """Refuse to go on with another assembly, or other springs of its contacts, than those of the folder."""
        assert self._assembly is not None
        with tempfile.TemporaryDirectory() as folder:
            own = pathlib.Path(folder) / "own.h5"
            self._assembly.write(own)
            same = own.read_bytes() == path.read_bytes()
        if not same:
            raise BadInput("the assembly is not that of the run that is to go on", f"'{path}' has another one",
                           "Give the assembly of that run, or choose another out", "assembly")

    def solve(self, **options: Any) -> Result:
        """Equilibrium under supports and loads, or Abe's tension test (table `test`).

        Arrays: displacements (n, 2) in m, rotations (n,) in rad, contact_forces (contacts, 2), normal (tension
        positive) and tangential, in N/m, supported_discs, reactions in N/m and reaction_moments in N; of several load
        cases each under its name. With ``sensitivities=True`` the derivatives by the springs of each contact: of a
        tension test dE_dkN, dnu_dkN (plane stress), ...; else of the mean displacement of each group that loads act on,
        and of the mean stress, dGROUP_ux_dkN, dstress_xx_dkN, ...
        """
        return self.run_verb("solve", **options)

    def homogenize(self, **options: Any) -> Result:
        """Effective stiffness and moduli, with bounds; of many random cells with the table `ensemble`.

        Arrays: fluctuations.xx.displacements, ... for the unit mean strains xx, yy and xy. With
        ``sensitivities=True`` the derivatives of the stiffness by the springs of each contact, dC_dkN and dC_dkT
        (contacts, 3, 3) and, where contacts bend, dC_dkM in 1/m²; of periodic cells of discs without forces at rest
        also dC_dx and dC_dy (n, 3, 3) in Pa/m by the positions, with contact points that divide the distance as before,
        and, where they divide it as the radii do, dC_dradius. With the table
        `viscoelastic` also viscoelastic.frequencies (n) in Hz and, complex, viscoelastic.shear_moduli,
        .bulk_moduli_2d and .young_moduli (plane strain) in Pa, .poisson_ratios (plane strain), (n) each, and
        .stiffnesses (n, 9) in Pa by rows.
        """
        return self.run_verb("homogenize", **options)

    def calibrate(self, **options: Any) -> Result:
        """Springs that give the assembly the wanted moduli (table `material`), or strengths of the contacts for wanted
        strengths (table `strength_target`): `result.contact_strength`, in N/m (with a bond length Pa), with standard
        errors, and `result.samples`.
        """
        return self.run_verb("calibrate", **options)

    def stability(self, **options: Any) -> Result:
        """Mechanisms, waves, the critical kT/kN, natural frequencies and time steps.

        Arrays: modes["0"].displacements, modes["0"].rotations, ... of the lowest natural frequencies; of small periodic
        cells dispersion.along, dispersion.wave_vectors and dispersion.squared_frequencies; where forces at rest count,
        buckling.displacements and buckling.rotations of the mode that is lost at the critical load. With
        ``sensitivities=True`` the derivatives by the springs of each contact: dnatural_frequencies_dkN and _dkT, and
        _dkM where contacts bend, (contacts, frequencies), NaN where frequencies coincide; of periodic assemblies those
        of the speeds of sound of the homogenized continuum, dVp_x_dkN, dVs_x_dkN, dVp_y_dkN, ...; dcritical_ratio_dkN,
        with kT = r kN, where the critical kT/kN is not that of a wave of a small cell.
        """
        return self.run_verb("stability", **options)

    def pack(self, **options: Any) -> Result:
        """Bodies in a box, at random or at rest (table `packing`); `result.assembly` is the packing."""
        return self.run_verb("pack", **options)

    def run(self, **options: Any) -> Result:
        """The dynamics of the table `run`, to its end; `simulation` steps it.

        Arrays: ``energies.time_s``, ``energies.kinetic_J_per_m``, ... over the run; with ``output.probe_interval`` the
        columns of history.csv as ``history.time_s``, ...: probes, walls, the periodic cell and energies; with the table
        `measures` those of measures.csv as ``measures_history.time_s``, ...
        """
        return self.run_verb("run", **options)

    def quasistatic(self, **options: Any) -> Result:
        """Contacts that break one after another (tables `strength`, `strain`, `dead_load`, `notch`, `quasistatic`).

        `result.events` lists them: lambda, contact, mode, stress [xx, yx, xy, yy] in Pa, load, motion, energies in N.
        With ``strength.after_breaking = "frictional"`` contacts without a bond open, close, slip and stick too.
        """
        return self.run_verb("quasistatic", **options)

    def export(self, to: str, out: str | os.PathLike[str], **options: Any) -> Result:
        """The model as input of another program, in the folder `out`.

        Parameters
        ----------
        to
            "lammps", "yade" or "matrix-market": what ``equidem export --to`` takes.
        options
            Those of the verb; ``accept="friction"`` exports what the program computes otherwise, as its refusal says.

        Raises
        ------
        BadInput
            A part of the model that the program does not carry, by its name; files in `out` without ``overwrite=True``.
        """
        return self.run_verb("export", to=to, out=out, **options)

    def simulation(self) -> Simulation:
        """The dynamics of the table `run` with its duration, ready to be stepped."""
        return Simulation(_core.steps(*self._inputs()))
