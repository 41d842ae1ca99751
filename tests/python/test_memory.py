# SPDX-License-Identifier: GPL-3.0-or-later
"""Arrays are views of the memory of their owner, which they keep."""

import gc
import pickle

import numpy as np
import pytest

import equidem as eq


def address(array):
    return array.__array_interface__["data"][0]


@pytest.mark.parametrize("name", ["centres", "radii", "contacts", "shifts", "levers", "cell_areas"])
def test_arrays_of_an_assembly_are_views(name):
    block = eq.hexagonal(columns=5, rows=5, radius=1e-3)
    first, second = getattr(block, name), getattr(block, name)
    assert address(first) == address(second)
    assert not first.flags.owndata and not first.flags.writeable
    with pytest.raises(ValueError):
        first[0] = 0


def test_arrays_of_a_contact_lie_in_one_memory():
    block = eq.hexagonal(columns=5, rows=5, radius=1e-3)
    assert address(block.shifts) - address(block.contacts) == 8
    assert address(block.levers) - address(block.contacts) == 16
    assert block.contacts.strides == (32, 4) and block.levers.strides == (32, 8)


def test_displacements_and_rotations_lie_in_one_memory():
    block = eq.hexagonal(columns=5, rows=5, radius=1e-3)
    result = eq.tension_test(block, (1e9, 0.5e9))
    assert address(result.rotations) - address(result.displacements) == 16
    assert result.displacements.strides == (24, 8)


def test_an_array_keeps_its_owner():
    centres = eq.hexagonal(columns=300, rows=300, radius=1e-3).centres
    before = centres.copy()
    gc.collect()
    for _ in range(20):
        eq.hexagonal(columns=300, rows=300, radius=2e-3)
    assert np.array_equal(centres, before)
    motions = eq.tension_test(eq.hexagonal(columns=30, rows=31, radius=1e-3), (1e9, 0.5e9)).displacements
    before = motions.copy()
    gc.collect()
    for _ in range(20):
        eq.tension_test(eq.hexagonal(columns=30, rows=31, radius=2e-3), (1e9, 0.5e9))
    assert np.array_equal(motions, before)


def test_an_assembly_is_not_copied_by_what_uses_it():
    block = eq.hexagonal(columns=5, rows=5, radius=1e-3)
    result = eq.tension_test(block, (1e9, 0.5e9))
    assert result.assembly is block


def test_written_assemblies_are_the_same_assemblies(tmp_path):
    turned = 0.2 + np.arange(6)[:, None] * [np.cos(0.3), np.sin(0.3)]
    pairs = [(k, k + 1) for k in range(5)]
    for made in (eq.hexagonal(columns=5, rows=6, radius=0.02), eq.square(columns=3, rows=4, radius=1 / 3),
                 eq.delaunay(discs=60, radii={"smallest": 4e-3, "largest": 6e-3}),
                 eq.delaunay(discs=60, radius=5e-3, periodic=True), eq.Assembly(turned, 0.5, pairs)):
        made = made.with_strengths(np.full((len(made.contacts), 2), 1 / 3)).with_forces(made.levers / 7)
        copies = [pickle.loads(pickle.dumps(made))]
        for name in ("a.json", "a.h5"):
            made.write(tmp_path / name, overwrite=True)
            copies.append(eq.read(tmp_path / name))
        for copy in copies:
            for name in ("centres", "radii", "contacts", "shifts", "levers", "cell_areas", "facet_lengths", "forces"):
                np.testing.assert_array_equal(getattr(copy, name), getattr(made, name), name)
            assert (copy.area, copy.cell, copy.solid_fraction) == (made.area, made.cell, made.solid_fraction)
            assert {name: list(discs) for name, discs in copy.groups.items()} == \
                {name: list(discs) for name, discs in made.groups.items()}


def test_results_and_assemblies_are_pickled():
    cell = eq.delaunay(discs=40, radius=1e-3, seed=1, periodic=True)
    copy = pickle.loads(pickle.dumps(cell))
    assert np.array_equal(copy.centres, cell.centres) and np.array_equal(copy.contacts, cell.contacts)
    result = eq.homogenize(cell, (1e9, 0.5e9))
    again = pickle.loads(pickle.dumps(result))
    assert again.to_dict() == result.to_dict() and again.units == result.units and again.report == result.report
    assert np.array_equal(again.fluctuations.xx.displacements, result.fluctuations.xx.displacements)
    error = pickle.loads(pickle.dumps(eq.BadInput("a", "b", "c", "d")))
    assert str(error) == "d: a (b). c."


def test_a_file_gives_back_the_same_bits(tmp_path):
    cell = eq.delaunay(discs=40, radii={"smallest": 1e-3, "largest": 2e-3}, seed=1, periodic=True)
    for name in ("cell.json", "cell.h5"):
        cell.write(tmp_path / name)
        again = eq.read(tmp_path / name)
        assert np.array_equal(again.centres, cell.centres) and np.array_equal(again.levers, cell.levers)
        with pytest.raises(eq.BadInput, match="exists already"):
            cell.write(tmp_path / name)
        cell.write(tmp_path / name, overwrite=True)


def test_results_written_to_a_folder_can_be_computed_again(tmp_path):
    block = eq.hexagonal(columns=7, rows=7, radius=1e-3)
    case = eq.Case(assembly=block, springs=(1e9, 0.5e9), test={"kind": "uniaxial_tension", "stress": 1e6})
    result = case.solve(out=tmp_path / "result")
    assert (tmp_path / "result/result.json").exists()
    assert eq.Case(tmp_path / "result/case.toml").solve().poisson_ratio == result.poisson_ratio
    with pytest.raises(eq.BadInput, match="exists already"):
        case.solve(out=tmp_path / "result")


def test_a_folder_of_results_is_changed_only_by_what_is_asked(tmp_path):
    def case(radius):
        return eq.Case(assembly=eq.hexagonal(columns=7, rows=7, radius=radius), springs=(1e9, 0.5e9),
                       test={"kind": "uniaxial_tension", "stress": 1e6})

    kept = tmp_path / "kept"
    case(1e-3).solve(out=kept)
    before = {path: path.read_bytes() for path in kept.iterdir()}
    with pytest.raises(eq.BadInput, match="exists already"):
        case(2e-3).solve(out=kept)
    case(2e-3).solve(out=kept, overwrite=True, dry_run=True)
    assert {path: path.read_bytes() for path in kept.iterdir()} == before
    case(2e-3).solve(out=kept, overwrite=True)
    assert eq.read(kept / "given_assembly.h5").radii[0] == 2e-3

    with pytest.raises(eq.BadInput):
        case(1e-3).set("springs.kT", -5e9).set("springs.kN", -1).solve(out=tmp_path / "failed")
    case(1e-3).solve(out=tmp_path / "dry", dry_run=True)
    assert [path.name for path in tmp_path.iterdir()] == ["kept"]


def test_a_run_goes_on_with_its_own_assembly_alone(tmp_path):
    def case(block):
        return eq.Case(assembly=block, springs=eq.Springs(1e9, 5e8), density=2000.0, supports=[{"group": "left", "ux": 0, "uy": 0}],
                       loads=[{"group": "right", "force": (1e3, 0)}], run={"duration": 1e-5})
    block = eq.hexagonal(columns=5, rows=5, radius=1e-2)
    case(block).run(out=tmp_path / "out")
    case(block).run(out=tmp_path / "out", resume=True)
    with pytest.raises(eq.BadInput, match="not that of the run that is to go on"):
        case(eq.hexagonal(columns=6, rows=5, radius=1e-2)).run(out=tmp_path / "out", resume=True)


def test_a_packing_between_walls_is_measured():
    packed = eq.pack({"grains": 60, "solid_fraction": "auto", "box": [0.1, 0.1], "radii": {"smallest": 0.004, "largest": 0.006},
                      "overlap": 1e-3}, (1e8, 0.5e8)).assembly
    copy = pickle.loads(pickle.dumps(packed))
    assert packed.area == copy.area > 0.0099
    assert {"left", "right", "bottom", "top"} <= set(packed.groups)
    assert eq.homogenize(packed, (1e8, 0.5e8)).shear_modulus == eq.homogenize(copy, (1e8, 0.5e8)).shear_modulus


def test_groups_of_arrays_are_named_beside_those_that_there_are(tmp_path):
    block = eq.hexagonal(columns=5, rows=5, radius=1e-2)
    held = [{"group": np.arange(5), "ux": 0, "uy": 0}]
    eq.Case(assembly=block, springs=(1e9, 5e8), supports=held, loads=[{"group": [20, 21], "force": (1e3, 0)}],
            output={"assembly": "json"}).solve(out=tmp_path / "out")
    again = eq.read(tmp_path / "out/assembly.json")
    result = eq.solve(again, (1e9, 5e8), supports=held, loads=[{"group": [20, 21, 22], "force": (1e3, 0)}])
    assert np.abs(result.displacements).max() > 0
