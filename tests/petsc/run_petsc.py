#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""equidem-mpi beside the serial program.

    run_petsc.py PROGRAM PARALLEL_PROGRAM MPIRUN SOURCE_FOLDER TEST
"""
import json
import os
import pathlib
import signal
import subprocess
import sys
import tempfile
import time

import numpy as np
import vtk

from ranks import (CASES, CUT, SERIAL_FILES, TENSION, checked, command, motions_of_ranks, motions_of_serial, parallel,
                   result_in,
                   serial)

BLOCK = """schema = "equidem/1"
[assembly]
kind = "{kind}"
columns = 24
rows = 17
radius = 0.01
[springs]
kN = 1.0e9
kT = {kT}
[effects]
rotation = "{rotation}"
[[group]]
name = "some"
discs = [5, 100, 101, 250]
[[group]]
name = "corner"
box = [0.3, 0.2, 0.6, 0.6]
[[support]]
group = "bottom"
ux = true
uy = true
rotation = true
[[support]]
group = "top"
uy = 1.0e-4
[[load]]
group = "right"
kind = "traction"
force = [1.0e4, -2.0e4]
[[load]]
group = "some"
kind = "total"
force = [10.0, 5.0]
[[load]]
group = "corner"
force = [0.3, 0.7]
"""
FILE = """schema = "equidem/1"
[assembly]
kind = "file"
path = "{path}"
[springs]
kN = 1.0e9
kT = 0.4e9
[test]
kind = "uniaxial_tension"
stress = 1.0e6
gauge = "quarter"
"""


def pressed_block(folder):
    """A hexagonal block whose contacts all carry the same force at rest, a fiftieth of kN l: they balance each other."""
    checked(serial("solve", *CUT, "output.assembly=json", "--out", folder / "block"), "an assembly to press")
    assembly = json.loads((folder / "block" / "assembly.json").read_text(encoding="utf-8"))
    assembly["forces"] = [[-2e5, 0] for _ in assembly["contacts"]]
    (folder / "pressed.json").write_text(json.dumps(assembly), encoding="utf-8")
    path = folder / "pressed.toml"
    path.write_text(FILE.format(path=folder / "pressed.json"), encoding="utf-8")
    return path


def blocks(folder):
    """Name -> (case, arguments), with assemblies of every kind, supports, loads, imposed motions, restrained rotation."""
    for name, kind, kT, rotation in (("hexagonal", "hexagonal", 0.5e9, "free"), ("square", "square", 0.3e9, "free"),
                                     ("restrained", "hexagonal", 0.5e9, "restrained"),
                                     ("without kT", "hexagonal", 0.0, "free"),
                                     ("bonds", "square", "0.3e9\nbond_width = 0.8", "free")):
        path = folder / f"{name.replace(' ', '_')}.toml"
        path.write_text(BLOCK.format(kind=kind, kT=kT, rotation=rotation), encoding="utf-8")
        yield name, path, ()
    made = serial("solve", CASES / "delaunay_tension.toml", "assembly.discs=700", "output.assembly=json", SERIAL_FILES,
                  "--out", folder / "made")
    checked(made, "an assembly to read")
    path = folder / "from_file.toml"
    path.write_text(FILE.format(path=folder / "made" / "assembly.json"), encoding="utf-8")
    yield "file", path, ()
    path = pressed_block(folder)
    yield "forces at rest", path, (PRESTRESS,)
    yield "forces at rest, restrained", path, (PRESTRESS, "effects.rotation=restrained")
    yield "forces at rest, without kT", path, (PRESTRESS, "springs.kT=0")
    yield "forces at rest, bonds", path, (PRESTRESS, "springs.bond_width=0.8")
    yield "tension of a lattice", TENSION, CUT[1:]
    yield "points", CASES / "delaunay_tension.toml", ("assembly.discs=1200",)
    yield "points of chance", CASES / "delaunay_tension.toml", ("assembly.discs=900", "assembly.points=random",
                                                                "assembly.aspect=3")
    yield "unequal discs", CASES / "delaunay_tension.toml", ("assembly.discs=900", "assembly.radius=none",
                                                             "assembly.radii={smallest = 0.004, largest = 0.008}")


PRESTRESS = "effects.prestress=on"
NUMBERS = ("poisson_ratio", "stiffness_ratio", "fitted_poisson_ratio", "energy", "largest_deformation")


def the_motions_are_those_of_the_serial_program_on_every_number_of_ranks(folder):
    for name, case, arguments in blocks(folder):
        one = folder / f"serial {name}"
        checked(serial("solve", case, *arguments, SERIAL_FILES, "solver.method=multifrontal", "--out", one), name)
        expected = motions_of_serial(one, "state")
        numbers = result_in(one)
        for ranks in (1, 2, 4):
            out = folder / f"{ranks} {name}"
            checked(parallel(ranks, "solve", case, *arguments, "--out", out), name)
            found = motions_of_ranks(out, "state", ranks)
            difference = np.linalg.norm(found - expected) / np.linalg.norm(expected)
            print(f"{name}, {ranks} ranks: motions differ by {difference:.1e}")
            assert found.shape == expected.shape, name
            assert difference <= 1e-10, name
            result = result_in(out)
            assert result["relative_residual"] <= 1e-11, result["relative_residual"]
            for key in NUMBERS:
                if key not in numbers:
                    continue
                assert abs(result[key] - numbers[key]) <= 1e-9 * abs(numbers[key]), (name, key, result[key], numbers[key])
            pressed = PRESTRESS in arguments
            expect = {"status": "unjudged", "negative_pivots": None, "unstable_modes": None} if pressed else numbers
            for key in ("status", "negative_pivots", "unstable_modes"):
                assert result[key] == expect[key], (name, key, result[key], expect[key])
            for key in ("discs", "contacts", "unknowns"):
                assert result[key] == numbers[key], (name, key, result[key], numbers[key])
            stress = np.subtract(result["stress_tensor"], numbers["stress_tensor"])
            assert np.abs(stress).max() <= 1e-9 * np.abs(numbers["stress_tensor"]).max(), (name, stress)


def cells(folder):
    yield "hexagonal", CASES / "hexagonal_cell.toml", ("assembly.columns=12", "assembly.rows=10")
    yield "square", CASES / "hexagonal_cell.toml", ("assembly.kind=square", "assembly.columns=12", "assembly.rows=10")
    yield "odd square", CASES / "hexagonal_cell.toml", ("assembly.kind=square", "assembly.columns=11", "assembly.rows=10")
    yield "points", CASES / "random_cell.toml", ()
    yield "points, few", CASES / "random_cell.toml", ("assembly.discs=30",)
    yield "restrained", CASES / "random_cell.toml", ("effects.rotation=restrained",)
    yield "facets", CASES / "random_cell.toml", ("springs.weighting=voronoi",)
    yield "packing", CASES / "packed_rock.toml", ("packing.grains=300", "springs.kN=1e9", "springs.kT=0.5e9", "material=none")
    yield "bonds of points", CASES / "random_cell.toml", ("springs.bond_width=0.9",)
    yield "bonds of a square lattice", CASES / "hexagonal_cell.toml", ("assembly.kind=square", "assembly.columns=12",
                                                                       "assembly.rows=10", "springs.bond_width=0.7")
    path = packed_ellipses(folder)
    yield "ellipses under pressure", path, (PRESTRESS,)
    yield "ellipses under pressure, restrained", path, (PRESTRESS, "effects.rotation=restrained")
    yield "bonds of a packing", CASES / "packed_rock.toml", ("packing.grains=300", "springs.kN=1e9", "springs.kT=0.5e9",
                                                             "springs.bond_width=0.5", "material=none")


def packed_ellipses(folder):
    """Frictionless ellipses under pressure: their moduli are those of the forces at rest."""
    smooth = ("springs.shear_wave_speed=none", "springs.poisson_ratio=none", "springs.kN=1e8", "springs.kT=0",
              "packing.sides=periodic", "packing.grains=60")
    checked(serial("pack", CASES / "pack_ellipses.toml", *smooth, "--out", folder / "ellipses"), "a packing")
    path = folder / "ellipses.toml"
    path.write_text(f'schema = "equidem/1"\n[assembly]\nkind = "file"\npath = "{folder / "ellipses" / "assembly.json"}"\n',
                    encoding="utf-8")
    return path


def the_moduli_are_those_of_the_serial_program_on_every_number_of_ranks(folder):
    for name, case, arguments in cells(folder):
        one = checked(serial("homogenize", case, *arguments, "--json", "-"), name)
        expected = json.loads(one.stdout)
        for ranks in (1, 2, 4):
            out = folder / f"{ranks}.json"
            checked(parallel(ranks, "homogenize", case, *arguments, "--json", out, "--overwrite"), name)
            result = json.loads(out.read_text(encoding="utf-8"))
            stiffness = np.array(expected["stiffness"])
            difference = np.abs(np.array(result["stiffness"]) - stiffness).max() / np.abs(stiffness).max()
            print(f"{name}, {ranks} ranks: stiffnesses differ by {difference:.1e}")
            assert difference <= 1e-9, name
            for key in ("prestress_part", "cauchy_stiffness", "gradient_stiffness"):
                assert np.abs(np.subtract(result.get(key, 0),
                                          expected.get(key, 0))).max() <= 1e-9 * np.abs(stiffness).max(), (name, key)
            for key in ("bulk_modulus_2d", "shear_modulus"):
                assert abs(result[key] - expected[key]) <= 1e-9 * abs(expected[key]), (name, key)
            assert result["hill_mandel"] <= 1e-9, result["hill_mandel"]
            assert result["gear_modes"] == expected["gear_modes"], name


def every_solver_of_petsc_finds_the_same_motions(folder):
    case = CUT
    for name, options in {"gamg": (), "hypre": ("-equidem_pc_type", "hypre"), "jacobi": ("-equidem_pc_type", "jacobi"),
                          "mumps": ("solver.method=multifrontal",),
                          "multigrid": ("solver.method=multigrid",),
                          "lu": ("-equidem_ksp_type", "preonly", "-equidem_pc_type", "lu",
                                 "-equidem_pc_factor_mat_solver_type", "mumps")}.items():
        checked(parallel(2, "solve", *case, "--out", folder / name, *options), name)
        found = motions_of_ranks(folder / name, "state", 2)
        if name == "gamg":
            first = found
        difference = np.linalg.norm(found - first) / np.linalg.norm(first)
        solver = result_in(folder / name)["solver"]
        print(f"{solver}: motions differ by {difference:.1e}")
        assert difference <= 1e-10, name
    # kT < 0: the matrix is not definite, and MUMPS is taken.
    negative = (*case, "springs.kT=-0.05e9", SERIAL_FILES)
    checked(serial("solve", *negative, "--out", folder / "serial"), "kT < 0")
    result = checked(parallel(2, "solve", *negative, "--out", folder / "negative"), "kT < 0")
    assert "mumps" in result.stdout, result.stdout
    status = result_in(folder / "negative")["status"]
    assert status == "unjudged", status
    expected, found = motions_of_serial(folder / "serial", "state"), motions_of_ranks(folder / "negative", "state", 2)
    assert np.linalg.norm(found - expected) <= 1e-10 * np.linalg.norm(expected)


def the_files_of_all_ranks_open_as_one_data_set(folder):
    result = checked(parallel(4, "solve", *CUT, "--out", folder / "out"), "solve")
    result = result_in(folder / "out")
    reader = vtk.vtkXMLMultiBlockDataReader()
    reader.SetFileName(str(folder / "out" / "state.vtm"))
    reader.Update()
    blocks_of = reader.GetOutput()
    counts = []
    for block in range(blocks_of.GetNumberOfBlocks()):
        pieces = blocks_of.GetBlock(block)
        assert pieces.GetNumberOfBlocks() == 4
        counts.append([pieces.GetBlock(k).GetNumberOfCells() for k in range(4)])
    assert [sum(count) for count in counts] == [result["discs"], result["contacts"]], counts
    assert all(count > 0 for count in counts[0]), counts


def refused(result, *words):
    text = result.stderr
    sentences = [line for line in text.splitlines() if line.startswith("equidem-mpi:")]
    assert result.returncode == 2, (result.returncode, text)
    assert len(sentences) == 1, text
    for word in words:
        assert word in sentences[0], (word, text)


def bad_input_ends_all_ranks_with_one_sentence(folder):
    lattice, random = CASES / "hexagonal_cell.toml", CASES / "random_cell.toml"
    for ranks, arguments, *words in (
            (4, ("solve", TENSION, "assembly.columns=1", "assembly.rows=1"), "4 ranks", "1 disc"),
            (2, ("solve", TENSION, "assembly.columns=2", "assembly.rows=2"), "few for the gauges"),
            (2, ("solve", CASES / "grains_cradle.toml"), "grains_cradle.toml"),
                                     (2, ("solve", TENSION, "springs.kN=-1"), "springs.kN"),
            (2, ("solve", folder / "none.toml"), "none.toml"), (2, ("run", TENSION), "unknown verb 'run'"),
            (2, ("solve", TENSION, "--accuracy", "1e-3"), "--accuracy"), (2, ("solve", TENSION, "--dry-run"), "--dry-run"),
            (2, ("homogenize", TENSION), "periodic"), (2, ("solve", *CUT, "-equidem_ksp_rtol"),
                                                       "-equidem_ksp_rtol has no value"),
            (2, ("homogenize", CASES / "ensemble.toml"), "ensemble"),
            (2, ("homogenize", random, "springs.weighting=contact_density"), "weighting"),
            (2, ("homogenize", lattice, "assembly.kind=square", "springs.kT=0"), "floppy"),
            *((2, ("solve", TENSION, f"-equidem_{name}", value), "PETSc refuses an option", told)
              for name, value, told in (("pc_type", "wrong", "wrong"), ("ksp_rtol", "many", "many"),
                                        ("pc_type", "ilu", "ILU")))):
        refused(parallel(ranks, *arguments), *words)
    block = BLOCK.format(kind="hexagonal", kT=1e8, rotation="free")
    along_x = block.replace("ux = true\n", "").replace("uy = true\n", "ux = true\n").replace("uy = 1.0e-4", "ux = 0.0")
    square = BLOCK.format(kind="square", kT=1e8, rotation="free")
    for text, *words in ((block.replace("ux = true\nuy = true", "uy = true"), "translation along x"),
                         (along_x, "translation along y"),
                         (block.replace("discs = [5, 100, 101, 250]", "discs = [5, 10000]"), "10000", "some"),
                         (square.replace("rotation = true\n", ""), "counter-rotate")):
        path = folder / "block.toml"
        path.write_text(text, encoding="utf-8")
        refused(parallel(2, "solve", path), *words)


def a_load_that_drives_a_mechanism_is_refused(folder):
    path = folder / "rows.toml"
    path.write_text(BLOCK.format(kind="square", kT=0.0, rotation="free"), encoding="utf-8")
    for method in ("auto", "multifrontal"):
        result = parallel(2, "solve", path, f"solver.method={method}", "support.1=none")
        assert result.returncode == 1 and "mechanism" in result.stderr, (method, result.returncode, result.stderr)


def options_that_petsc_does_not_use_are_named(folder):
    result = checked(parallel(2, "solve", TENSION, "-equidem_pc_typo", "gamg", "--json", folder / "a.json",
                              "-equidem_ksp_rtol", "1e-6"), "solve")
    assert "did not use -equidem_pc_typo:" in result.stderr, result.stderr
    assert (folder / "a.json").exists()
    result = parallel(2, "solve", TENSION, "-equidem_ksp_max_it", "2", "-typo")
    assert result.returncode == 1 and "did not converge" in result.stderr and "did not use -typo:" in result.stderr, result.stderr


def start_long():
    """Two ranks that iterate for minutes."""
    words, environment = command(2, "solve", TENSION, "assembly.columns=401", "assembly.rows=401", "-equidem_pc_type",
                                 "jacobi", "-equidem_ksp_max_it", "100000", "-equidem_ksp_monitor")
    process = subprocess.Popen(words, env=environment, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    ranks = []
    while len(ranks) < 2 and process.poll() is None:
        time.sleep(0.05)
        children = pathlib.Path(f"/proc/{process.pid}/task/{process.pid}/children").read_text(encoding="utf-8")
        ranks = [int(rank) for rank in children.split()]
    while "0 KSP Residual" not in process.stdout.readline():
        assert process.poll() is None, process.communicate()
    return process, ranks


def lives(process):
    """A process that has ended may remain as a zombie where nobody waits for it."""
    try:
        status = pathlib.Path(f"/proc/{process}/stat").read_text(encoding="utf-8")
    except FileNotFoundError:
        return False
    return status.rpartition(")")[2].split()[0] not in "ZX"


def all_end(ranks):
    """mpirun ends before the last of them."""
    end = time.monotonic() + 30
    while any(map(lives, ranks)) and time.monotonic() < end:
        time.sleep(0.1)
    return not any(map(lives, ranks))


def a_rank_that_dies_ends_all(_):
    for dead in (0, 1):
        process, ranks = start_long()
        os.kill(ranks[dead], signal.SIGKILL)
        _, errors = process.communicate(timeout=60)
        print(process.returncode, errors)
        assert process.returncode != 0, errors
        assert all_end(ranks), ranks


def an_interrupted_run_ends(_):
    process, ranks = start_long()
    process.send_signal(signal.SIGINT)
    _, errors = process.communicate(timeout=60)
    print(process.returncode, errors)
    assert process.returncode != 0, errors
    assert all_end(ranks), ranks


if __name__ == "__main__":
    with tempfile.TemporaryDirectory() as temporary:
        globals()[sys.argv[5]](pathlib.Path(temporary))
