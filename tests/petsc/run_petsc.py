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
from vtk.util.numpy_support import vtk_to_numpy

PROGRAM, PARALLEL, MPIRUN, SOURCE = sys.argv[1:5]
CASES = pathlib.Path(SOURCE, "data", "cases")
SERIAL_FILES = ("--set", "output.csv=false", "--set", "output.picture=false")
LIMIT = 120  # s


def command(ranks, *arguments):
    environment = dict(os.environ, OMP_NUM_THREADS="1", OPENBLAS_NUM_THREADS="1",
                       OMPI_ALLOW_RUN_AS_ROOT="1", OMPI_ALLOW_RUN_AS_ROOT_CONFIRM="1",
                       OMPI_MCA_rmaps_base_oversubscribe="1")
    return [MPIRUN, "-n", str(ranks), PARALLEL, *map(str, arguments)], environment


def parallel(ranks, *arguments):
    words, environment = command(ranks, *arguments)
    return subprocess.run(words, env=environment, capture_output=True, text=True, timeout=LIMIT, check=False)


def serial(*arguments):
    return subprocess.run([PROGRAM, *map(str, arguments)], capture_output=True, text=True, timeout=LIMIT, check=False)


def checked(result, what):
    assert result.returncode == 0, f"{what}: exit code {result.returncode}\n{result.stdout}\n{result.stderr}"
    return result


def read(path):
    reader = vtk.vtkXMLPolyDataReader()
    reader.SetFileName(str(path))
    reader.Update()
    return reader.GetOutput()


def arrays(data, *names):
    return [vtk_to_numpy(data.GetPointData().GetArray(name)) for name in names]


def motions_of_serial(folder, name):
    data = read(folder / f"{name}_discs.vtp")
    displacements, rotations, radii = arrays(data, "displacement", "rotation", "radius")
    return np.column_stack([displacements[:, :2], radii * rotations])


def motions_of_ranks(folder, name, ranks):
    """In the order of the serial program, from the numbers of the discs."""
    numbers, motions = [], []
    for rank in range(ranks):
        data = read(folder / f"{name}_discs_{rank}.vtp")
        number, displacements, rotations, radii = arrays(data, "number", "displacement", "rotation", "radius")
        numbers.append(number)
        motions.append(np.column_stack([displacements[:, :2], radii * rotations]))
    numbers, motions = np.concatenate(numbers), np.concatenate(motions)
    assert sorted(numbers) == list(range(len(numbers))), "each disc belongs to one rank"
    return motions[np.argsort(numbers)]


CUT = ("--set", "assembly.columns=41", "--set", "assembly.rows=23")
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


def blocks(folder):
    """Name -> (case, arguments), with assemblies of every kind, supports, loads, imposed motions, restrained rotation."""
    for name, kind, kT, rotation in (("hexagonal", "hexagonal", 0.5e9, "free"), ("square", "square", 0.3e9, "free"),
                                     ("restrained", "hexagonal", 0.5e9, "restrained"),
                                     ("without kT", "hexagonal", 0.0, "free")):
        path = folder / f"{name.replace(' ', '_')}.toml"
        path.write_text(BLOCK.format(kind=kind, kT=kT, rotation=rotation), encoding="utf-8")
        yield name, path, ()
    made = serial("solve", CASES / "delaunay_tension.toml", "--set", "assembly.discs=700", "--set",
                  "output.assembly=json", *SERIAL_FILES, "--out", folder / "made")
    checked(made, "an assembly to read")
    path = folder / "from_file.toml"
    path.write_text(FILE.format(path=folder / "made" / "assembly.json"), encoding="utf-8")
    yield "file", path, ()
    yield "tension of a lattice", CASES / "abe1996_fig6.toml", CUT
    yield "points", CASES / "delaunay_tension.toml", ("--set", "assembly.discs=1200")
    yield "points of chance", CASES / "delaunay_tension.toml", ("--set", "assembly.discs=900", "--set",
                                                                "assembly.points=random", "--set", "assembly.aspect=3")
    yield "unequal discs", CASES / "delaunay_tension.toml", ("--set", "assembly.discs=900", "--set", "assembly.radius=none",
                                                             "--set", "assembly.radii={smallest = 0.004, largest = 0.008}")


NUMBERS = ("poisson_ratio", "stiffness_ratio", "fitted_poisson_ratio", "energy", "largest_deformation")


def the_motions_are_those_of_the_serial_program_on_every_number_of_ranks(folder):
    for name, case, arguments in blocks(folder):
        one = folder / f"serial {name}"
        checked(serial("solve", case, *arguments, *SERIAL_FILES, "--set", "solver.method=multifrontal", "--out", one), name)
        expected = motions_of_serial(one, "state")
        numbers = json.loads((one / "result.json").read_text(encoding="utf-8"))
        for ranks in (1, 2, 4):
            out = folder / f"{ranks} {name}"
            checked(parallel(ranks, "solve", case, *arguments, "--out", out), name)
            found = motions_of_ranks(out, "state", ranks)
            difference = np.linalg.norm(found - expected) / np.linalg.norm(expected)
            print(f"{name}, {ranks} ranks: motions differ by {difference:.1e}")
            assert found.shape == expected.shape, name
            assert difference <= 1e-10, name
            result = json.loads((out / "result.json").read_text(encoding="utf-8"))
            assert result["relative_residual"] <= 1e-11, result["relative_residual"]
            for key in NUMBERS:
                if key not in numbers:
                    continue
                assert abs(result[key] - numbers[key]) <= 1e-9 * abs(numbers[key]), (name, key, result[key], numbers[key])
            for key in ("discs", "contacts", "unknowns", "status"):
                assert result[key] == numbers[key], (name, key, result[key], numbers[key])
            stress = np.subtract(result["stress_tensor"], numbers["stress_tensor"])
            assert np.abs(stress).max() <= 1e-9 * np.abs(numbers["stress_tensor"]).max(), (name, stress)


def cells(folder):
    yield "hexagonal", CASES / "hexagonal_cell.toml", ("--set", "assembly.columns=12", "--set", "assembly.rows=10")
    yield "square", CASES / "hexagonal_cell.toml", ("--set", "assembly.kind=square", "--set", "assembly.columns=12",
                                                    "--set", "assembly.rows=10")
    yield "odd square", CASES / "hexagonal_cell.toml", ("--set", "assembly.kind=square", "--set", "assembly.columns=11",
                                                        "--set", "assembly.rows=10")
    yield "points", CASES / "random_cell.toml", ()
    yield "points, few", CASES / "random_cell.toml", ("--set", "assembly.discs=30")
    yield "restrained", CASES / "random_cell.toml", ("--set", "effects.rotation=restrained")
    yield "facets", CASES / "random_cell.toml", ("--set", "springs.weighting=voronoi")
    yield "packing", CASES / "packed_rock.toml", ("--set", "packing.grains=300", "--set", "springs.kN=1e9", "--set",
                                                  "springs.kT=0.5e9", "--set", "material=none")


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
            for key in ("bulk_modulus_2d", "shear_modulus"):
                assert abs(result[key] - expected[key]) <= 1e-9 * abs(expected[key]), (name, key)
            assert result["hill_mandel"] <= 1e-9, result["hill_mandel"]
            assert result["gear_modes"] == expected["gear_modes"], name


def every_solver_of_petsc_finds_the_same_motions(folder):
    case = (CASES / "abe1996_fig6.toml", *CUT)
    for name, options in {"gamg": (), "hypre": ("-equidem_pc_type", "hypre"), "jacobi": ("-equidem_pc_type", "jacobi"),
                          "mumps": ("--set", "solver.method=multifrontal"),
                          "grids": ("-equidem_pc_type", "equidem"), "grids of the case": ("--set", "solver.method=multigrid"),
                          "lu": ("-equidem_ksp_type", "preonly", "-equidem_pc_type", "lu",
                                 "-equidem_pc_factor_mat_solver_type", "mumps")}.items():
        checked(parallel(2, "solve", *case, "--out", folder / name, *options), name)
        found = motions_of_ranks(folder / name, "state", 2)
        if name == "gamg":
            first = found
        difference = np.linalg.norm(found - first) / np.linalg.norm(first)
        solver = json.loads((folder / name / "result.json").read_text(encoding="utf-8"))["solver"]
        print(f"{solver}: motions differ by {difference:.1e}")
        assert difference <= 1e-10, name
    # kT < 0: the matrix is not definite, and MUMPS is taken.
    negative = (*case, "--set", "springs.kT=-0.05e9", *SERIAL_FILES)
    checked(serial("solve", *negative, "--out", folder / "serial"), "kT < 0")
    result = checked(parallel(2, "solve", *negative, "--out", folder / "negative"), "kT < 0")
    assert "mumps" in result.stdout, result.stdout
    expected, found = motions_of_serial(folder / "serial", "state"), motions_of_ranks(folder / "negative", "state", 2)
    assert np.linalg.norm(found - expected) <= 1e-10 * np.linalg.norm(expected)


def grids_of_equidem(folder):
    """The cases of blocks and cells that the grids of equidem solve, with the keys that make them larger."""
    yield "lattice", "solve", CASES / "abe1996_fig6.toml", ("--set", "assembly.columns=81", "--set", "assembly.rows=91")
    yield "points", "solve", CASES / "delaunay_tension.toml", ("--set", "assembly.discs=6000")
    yield "strip", "solve", CASES / "abe1996_fig6.toml", ("--set", "assembly.columns=201", "--set", "assembly.rows=11")
    yield "without kT", "solve", CASES / "abe1996_fig6.toml", ("--set", "springs.kT=0", "--set", "assembly.columns=61",
                                                              "--set", "assembly.rows=61")
    yield "few", "solve", CASES / "delaunay_tension.toml", ("--set", "assembly.discs=150")
    yield "cell", "homogenize", CASES / "random_cell.toml", ("--set", "assembly.discs=5000")


def the_grids_of_equidem_take_as_many_iterations_on_every_number_of_ranks(folder):
    """They span the assembly; blocks of ranks on their own would take more iterations with every rank. GAMG, whose
    aggregates end at ranks, is beside it."""
    for name, verb, case, arguments in grids_of_equidem(folder):
        found = {}
        for kind in ("gamg", "equidem"):
            for ranks in (1, 2, 4):
                out = folder / f"{name} {kind} {ranks}"
                checked(parallel(ranks, verb, case, *arguments, "--out", out, "-equidem_pc_type", kind), name)
                found[kind, ranks] = json.loads((out / "result.json").read_text(encoding="utf-8"))["iterations"]
                state = "state" if verb == "solve" else "state_strain_xy"
                motions = motions_of_ranks(out, state, ranks)
                if (kind, ranks) == ("gamg", 1):
                    expected = motions
                difference = np.linalg.norm(motions - expected) / np.linalg.norm(expected)
                assert difference <= 1e-10, (name, kind, ranks, difference)
        print(f"{name}: iterations {found}, motions differ by {difference:.1e}")
        ours = [found["equidem", ranks] for ranks in (1, 2, 4)]
        assert max(ours) - min(ours) <= max(2, 0.1 * min(ours)), (name, ours)
        assert all(found["equidem", ranks] < 0.75 * found["gamg", ranks] for ranks in (1, 2, 4)), (name, found)


def stability_is_that_of_the_serial_program_on_every_number_of_ranks(folder):
    """Negative pivots beyond those of rotations, counted by MUMPS beside our own factorization, on both sides of the limit."""
    cut = ("--set", "assembly.columns=21", "--set", "assembly.rows=23")
    judged = set()
    for verb, case, arguments in (("solve", CASES / "abe1996_fig6.toml", cut),
                                  ("homogenize", CASES / "hexagonal_cell.toml", ("--set", "assembly.columns=12", "--set",
                                                                                "assembly.rows=10")),
                                  ("homogenize", CASES / "random_cell.toml", ("--set", "assembly.discs=300"))):
        for ratio in (-0.1, -0.25, -0.3, -0.4, -0.6):
            numbers = (*arguments, "--set", "springs.kN=1e9", "--set", f"springs.kT={ratio}e9")
            expected = json.loads(checked(serial(verb, case, *numbers, "--json", "-"), case).stdout)
            for ranks in (1, 2, 4):
                out = folder / "result.json"
                checked(parallel(ranks, verb, case, *numbers, "--json", out, "--overwrite"), case)
                found = json.loads(out.read_text(encoding="utf-8"))
                for key in ("status", "unstable_modes", "negative_pivots"):
                    assert found[key] == expected[key], (case.name, ratio, ranks, key, found[key], expected[key])
            judged.add(found["status"])
            print(f"{case.name}, kT/kN = {ratio}: {found['status']}, {found['negative_pivots']} negative pivots, "
                  f"{found['unstable_modes']} unstable modes on 1, 2, 4 ranks and in serial")
    assert judged == {"solved", "unstable"}, judged
    unstable = parallel(2, "solve", CASES / "abe1996_fig6.toml", *cut, "--set", "springs.kT=-0.4e9", "--require-stable")
    assert unstable.returncode == 1, (unstable.returncode, unstable.stderr)
    # No other solver counts, and none is believed.
    for options in (("-equidem_pc_type", "lu", "-equidem_pc_factor_mat_solver_type", "mumps"),
                    ("-equidem_mat_mumps_icntl_13", "0")):
        out = folder / "result.json"
        checked(parallel(2, "solve", CASES / "abe1996_fig6.toml", *cut, "--set", "springs.kT=-0.1e9", "--json", out, "--overwrite",
                         *options), options)
        found = json.loads(out.read_text(encoding="utf-8"))
        assert found["status"] == "unjudged" and found["unstable_modes"] is None, (options, found["status"])


def the_files_of_all_ranks_open_as_one_data_set(folder):
    result = checked(parallel(4, "solve", CASES / "abe1996_fig6.toml", *CUT, "--out", folder / "out"), "solve")
    result = json.loads((folder / "out" / "result.json").read_text(encoding="utf-8"))
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
    case = CASES / "abe1996_fig6.toml"
    refused(parallel(4, "solve", case, "--set", "assembly.columns=1", "--set", "assembly.rows=1"), "4 ranks", "1 disc")
    refused(parallel(2, "solve", case, "--set", "assembly.columns=2", "--set", "assembly.rows=2"), "few for the gauges")
    refused(parallel(2, "solve", CASES / "grains_cradle.toml"), "grains_cradle.toml")
    refused(parallel(2, "solve", case, "--set", "springs.kN=-1"), "springs.kN")
    refused(parallel(2, "solve", folder / "none.toml"), "none.toml")
    refused(parallel(2, "run", case), "no verb 'run'")
    refused(parallel(2, "solve", case, "--accuracy", "1e-3"), "--accuracy")
    refused(parallel(2, "solve", case, "--dry-run"), "--dry-run")
    refused(parallel(2, "homogenize", case), "periodic")
    refused(parallel(2, "homogenize", CASES / "ensemble.toml"), "ensemble")
    refused(parallel(2, "homogenize", CASES / "random_cell.toml", "--set", "springs.weighting=contact_density"), "weighting")
    refused(parallel(2, "homogenize", CASES / "hexagonal_cell.toml", "--set", "assembly.kind=square", "--set",
                     "springs.kT=0"), "floppy")
    path = folder / "loose.toml"
    block = BLOCK.format(kind="hexagonal", kT=1e8, rotation="free")
    path.write_text(block.replace("ux = true\nuy = true", "uy = true"), encoding="utf-8")
    refused(parallel(2, "solve", path), "translation along x")
    path.write_text(block.replace("ux = true\n", "").replace("uy = true\n", "ux = true\n").replace("uy = 1.0e-4", "ux = 0.0"),
                    encoding="utf-8")
    refused(parallel(2, "solve", path), "translation along y")
    path.write_text(block.replace("discs = [5, 100, 101, 250]", "discs = [5, 10000]"), encoding="utf-8")
    refused(parallel(2, "solve", path), "10000", "some")
    path.write_text(BLOCK.format(kind="square", kT=1e8, rotation="free").replace("rotation = true\n", ""), encoding="utf-8")
    refused(parallel(2, "solve", path), "counter-rotate")


def a_load_that_drives_a_mechanism_is_refused(folder):
    path = folder / "rows.toml"
    path.write_text(BLOCK.format(kind="square", kT=0.0, rotation="free"), encoding="utf-8")
    for method in ("auto", "multifrontal"):
        result = parallel(2, "solve", path, "--set", f"solver.method={method}", "--set", "support.1=none")
        assert result.returncode == 1 and "mechanism" in result.stderr, (method, result.returncode, result.stderr)


def options_that_petsc_does_not_use_are_named(folder):
    result = checked(parallel(2, "solve", CASES / "abe1996_fig6.toml", "-equidem_pc_typo", "gamg", "--json", folder / "a.json",
                              "-equidem_ksp_rtol", "1e-6"), "solve")
    assert "did not use -equidem_pc_typo:" in result.stderr, result.stderr
    assert (folder / "a.json").exists()
    result = parallel(2, "solve", CASES / "abe1996_fig6.toml", "-equidem_pc_type", "wrong")
    assert result.returncode == 1 and "PETSc ended with an error" in result.stderr, result.stderr


def start_long():
    words, environment = command(2, "solve", CASES / "abe1996_fig6.toml", "--set", "assembly.columns=401", "--set",
                                 "assembly.rows=401", "-equidem_pc_type", "jacobi", "-equidem_ksp_max_it", "100000")
    process = subprocess.Popen(words, env=environment, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    ranks = []
    while len(ranks) < 2 and process.poll() is None:
        time.sleep(0.05)
        children = pathlib.Path(f"/proc/{process.pid}/task/{process.pid}/children").read_text(encoding="utf-8")
        ranks = [int(rank) for rank in children.split()]
    time.sleep(2)
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
    process, ranks = start_long()
    os.kill(ranks[-1], signal.SIGKILL)
    _, errors = process.communicate(timeout=60)
    assert process.returncode != 0, errors
    print(process.returncode, errors)
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
