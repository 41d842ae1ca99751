# SPDX-License-Identifier: GPL-3.0-or-later
"""Arrays are views of the memory of their owner, which they keep; files and copies give them back."""

import gc
import pickle

import numpy as np
import pytest

import equidem as eq
from scenes import BLOCK, HELD, SPRINGS, hexagonal, tension


def address(array):
    return array.__array_interface__["data"][0]


@pytest.mark.parametrize("name", ["centres", "radii", "contacts", "shifts", "levers", "cell_areas"])
def test_arrays_of_an_assembly_are_views(name):
    first, second = getattr(BLOCK, name), getattr(BLOCK, name)
    assert address(first) == address(second)
    assert not first.flags.owndata and not first.flags.writeable
    with pytest.raises(ValueError):
        first[0] = 0


def test_arrays_of_one_thing_lie_in_one_memory():
    assert address(BLOCK.shifts) - address(BLOCK.contacts) == 8
    assert address(BLOCK.levers) - address(BLOCK.contacts) == 16
    assert BLOCK.contacts.strides == (32, 4) and BLOCK.levers.strides == (32, 8)
    result = eq.tension_test(BLOCK, SPRINGS)
    assert address(result.rotations) - address(result.displacements) == 16
    assert result.displacements.strides == (24, 8)
    assert result.assembly is BLOCK  # no copy


def test_an_array_keeps_its_owner():
    for made in (lambda radius: hexagonal(300, 300, radius).centres,
                 lambda radius: eq.tension_test(hexagonal(30, 31, radius), (1e9, 0.5e9)).displacements):
        array = made(1e-3)
        before = array.copy()
        gc.collect()
        for _ in range(20):
            made(2e-3)
        assert np.array_equal(array, before)


def test_written_assemblies_are_the_same_assemblies(tmp_path):
    turned = 0.2 + np.arange(6)[:, None] * [np.cos(0.3), np.sin(0.3)]
    pairs = [(k, k + 1) for k in range(5)]
    for made in (hexagonal(5, 6, 0.02), eq.square(columns=3, rows=4, radius=1 / 3),
                 eq.delaunay(discs=60, radii={"smallest": 4e-3, "largest": 6e-3}),
                 eq.delaunay(discs=60, radius=5e-3, periodic=True), eq.Assembly(turned, 0.5, pairs)):
        made = made.with_strengths(np.full((len(made.contacts), 2), 1 / 3)).with_forces(made.levers / 7)
        copies = [pickle.loads(pickle.dumps(made))]
        for name in ("a.json", "a.h5"):
            made.write(tmp_path / name, overwrite=True)
            copies.append(eq.read(tmp_path / name))
            with pytest.raises(eq.BadInput, match="exists already"):
                made.write(tmp_path / name)
        for copy in copies:
            for name in ("centres", "radii", "contacts", "shifts", "levers", "cell_areas", "facet_lengths", "forces"):
                np.testing.assert_array_equal(getattr(copy, name), getattr(made, name), name)
            assert (copy.area, copy.cell, copy.solid_fraction) == (made.area, made.cell, made.solid_fraction)
            assert {name: list(discs) for name, discs in copy.groups.items()} == \
                {name: list(discs) for name, discs in made.groups.items()}


def test_results_and_errors_are_pickled():
    result = eq.homogenize(eq.delaunay(discs=40, radius=1e-3, seed=1, periodic=True), SPRINGS)
    again = pickle.loads(pickle.dumps(result))
    assert again.to_dict() == result.to_dict() and again.units == result.units and again.report == result.report
    assert np.array_equal(again.fluctuations.xx.displacements, result.fluctuations.xx.displacements)
    error = pickle.loads(pickle.dumps(eq.BadInput("a", "b", "c", "d")))
    assert str(error) == "d: a (b). c."


def test_a_folder_of_results_is_computed_again_and_changed_only_by_what_is_asked(tmp_path):
    kept = tmp_path / "kept"
    result = tension().solve(out=kept)
    assert (kept / "result.json").exists()
    assert eq.Case(kept / "case.toml").solve().poisson_ratio == result.poisson_ratio
    before = {path: path.read_bytes() for path in kept.iterdir()}
    with pytest.raises(eq.BadInput, match="exists already"):
        tension(2e-3).solve(out=kept)
    tension(2e-3).solve(out=kept, overwrite=True, dry_run=True)
    assert {path: path.read_bytes() for path in kept.iterdir()} == before
    tension(2e-3).solve(out=kept, overwrite=True)
    assert eq.read(kept / "given_assembly.h5").radii[0] == 2e-3

    with pytest.raises(eq.BadInput):
        tension().set("springs.kT", -5e9).set("springs.kN", -1).solve(out=tmp_path / "failed")
    tension().solve(out=tmp_path / "dry", dry_run=True)
    assert [path.name for path in tmp_path.iterdir()] == ["kept"]


def test_a_run_goes_on_with_its_own_assembly_alone(tmp_path):
    def run(block, **options):
        return eq.Case(assembly=block, springs=SPRINGS, density=2000.0, supports=HELD,
                       loads=[{"group": "right", "force": (1e3, 0)}],
                       run={"duration": 1e-5}).run(out=tmp_path / "out", **options)
    run(hexagonal(5, 5))
    run(hexagonal(5, 5), resume=True)
    with pytest.raises(eq.BadInput, match="not that of the run that is to go on"):
        run(hexagonal(6, 5), resume=True)


def test_a_packing_between_walls_is_measured():
    packed = eq.pack({"grains": 60, "solid_fraction": "auto", "box": [0.1, 0.1], "radii": {"smallest": 0.004, "largest": 0.006},
                      "overlap": 1e-3}, (1e8, 0.5e8)).assembly
    copy = pickle.loads(pickle.dumps(packed))
    assert packed.area == copy.area > 0.0099
    assert {"left", "right", "bottom", "top"} <= set(packed.groups)
    assert eq.homogenize(packed, (1e8, 0.5e8)).shear_modulus == eq.homogenize(copy, (1e8, 0.5e8)).shear_modulus


def test_groups_of_arrays_are_named_beside_those_that_there_are(tmp_path):
    held = [{"group": np.arange(5), "ux": 0, "uy": 0}]
    eq.Case(assembly=hexagonal(5, 5, 1e-2), springs=SPRINGS, supports=held, loads=[{"group": [20, 21], "force": (1e3, 0)}],
            output={"assembly": "json"}).solve(out=tmp_path / "out")
    again = eq.read(tmp_path / "out/assembly.json")
    result = eq.solve(again, SPRINGS, supports=held, loads=[{"group": [20, 21, 22], "force": (1e3, 0)}])
    assert np.abs(result.displacements).max() > 0
