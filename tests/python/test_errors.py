# SPDX-License-Identifier: GPL-3.0-or-later
"""Wrong input is answered with one sentence: the problem, why it is one, what to do."""

import json
import os
import shutil
import subprocess
import sys

import numpy as np
import pytest

import equidem as eq
from scenes import CASES, HELD, PACKINGS, STUDIES, hexagonal

STUDY = STUDIES / "abe_lattice.toml"
CENTRES = [[0.0, 0.0], [2.0, 0.0], [1.0, 1.7]]
BLOCK = hexagonal(5, 5)
LOADS = np.ones((len(BLOCK), 2))

WRONG = {
    "a_wrong_shape": (lambda: eq.Assembly([[0, 0, 0]], 1.0), "shape"),
    "a_list_of_words": (lambda: eq.Assembly(["a", "b"], 1.0), "no array of numbers"),
    "a_ragged_list": (lambda: eq.Assembly([[0, 0], [1]], 1.0), "no array of numbers"),
    "nan": (lambda: eq.Assembly([[0, np.nan], [1, 0]], 1.0), "every number must be finite"),
    "no_discs": (lambda: eq.Assembly(np.zeros((0, 2)), 1.0), "disc"),
    "a_cell_of_no_width": (lambda: eq.Assembly(CENTRES, 1.0, cell=(0.0, 1.0)), "period"),
    "a_radius_of_zero": (lambda: eq.Assembly(CENTRES, 0.0), "radius"),
    "radii_of_too_few_discs": (lambda: eq.Assembly(CENTRES, [1.0, 1.0]), "shape"),
    "a_disc_that_does_not_exist": (lambda: eq.Assembly(CENTRES, 1.0, [[0, 7]]), "7"),
    "a_negative_disc": (lambda: eq.Assembly(CENTRES, 1.0, [[0, -1]]), "-1"),
    "contacts_that_are_no_whole_numbers": (lambda: eq.Assembly(CENTRES, 1.0, [[0.0, 1.5]]), "whole numbers"),
    "discs_that_touch_nothing": (lambda: eq.Assembly(CENTRES, 0.1), "contact"),
    "levers_without_contacts": (lambda: eq.Assembly(CENTRES, 1.0, levers=[[1, 1]]), "contacts"),
    "a_packing_without_a_unit": (lambda: eq.read(PACKINGS / "packing.data"), "unit of length"),
    "a_packing_without_boundaries":
        (lambda: eq.read(PACKINGS / "packing.data", unit_of_length="m"), "whether its box is periodic"),
    "a_frame_that_does_not_exist": (lambda: eq.read(PACKINGS / "packing.dump", frame=7), "no frame of time step 7"),
    "an_unknown_kind": (lambda: eq.assembly(kind="hexagnal"), 'Did you mean "hexagonal"'),
    "an_unknown_key": (lambda: eq.hexagonal(colums=4), "columns"),
    "no_springs": (lambda: eq.tension_test(BLOCK), "Give springs with kN and kT"),
    "springs_of_a_file_that_does_not_exist": (lambda: eq.solve(BLOCK, "stiff", supports=HELD), "no such file"),
    "springs_of_one_number": (lambda: eq.solve(BLOCK, 1e9, supports=HELD), "springs of type float"),
    "a_negative_normal_spring": (lambda: eq.tension_test(BLOCK, (-1.0, 0.0)), "kN"),
    "springs_of_too_few_contacts": (lambda: eq.tension_test(BLOCK, eq.Springs(np.ones(3), np.ones(3))), "shape"),
    "springs_with_a_misspelt_key": (lambda: eq.tension_test(BLOCK, {"kN": 1.0, "kT": 0.5, "kMM": 1.0}), "'kM'"),
    "springs_with_two_bending_stiffnesses":
        (lambda: eq.tension_test(BLOCK, {"kN": 1.0, "kT": 0.5, "kM": 1.0, "bond_width": 1.0}), "both given"),
    "springs_without_kT": (lambda: eq.tension_test(BLOCK, {"kN": 1.0}), "kT"),
    "springs_of_a_result_that_has_none":
        (lambda: eq.tension_test(BLOCK, eq.tension_test(BLOCK, (1e9, 0.5e9))), "a result without springs"),
    "a_weighting_of_springs_of_each_contact":
        (lambda: eq.tension_test(BLOCK, eq.Springs(np.ones(120), 0.5, weighting="voronoi")), "springs of each contact"),
    "a_matrix_of_springs_with_a_misspelt_key":
        (lambda: eq.stiffness_matrix(BLOCK, {"kN": 1.0, "kt": 0.5}), "'kT'"),
    "a_test_of_strength_of_another_name":
        (lambda: eq.StrengthSample(BLOCK, (1.0, 0.5)).strength(1.0, 1.0, kind="tensile"), "tension"),
    "a_load_that_falls_to_twice_its_peak": (lambda: eq.StrengthSample(BLOCK, (1.0, 0.5), fallen_to=2.0), "fallen_to is 2"),
    "a_notch_of_negative_length":
        (lambda: eq.StrengthSample(BLOCK, (1.0, 0.5)).strength(1.0, 1.0, notch=-1e-3), "a notch of -0.001"),
    "two_densities":
        (lambda: eq.Case(assembly=BLOCK, springs=eq.Springs(np.ones(len(BLOCK.contacts)), 0.5, density=2000.0), density=1000.0),
         "the density is 1000"),
    "a_negative_bond_width": (lambda: eq.tension_test(BLOCK, eq.Springs(1.0, 0.5, bond_width=-1)), "bond_width"),
    "a_bond_width_beside_springs_of_each_contact":
        (lambda: eq.tension_test(BLOCK, eq.Springs(np.ones(120), 0.5, bond_width=1)), "springs of each contact"),
    "a_stiffness_matrix_of_bonds_with_a_width":
        (lambda: eq.stiffness_matrix(BLOCK, eq.Springs(1.0, 0.5, bond_width=1)), "stiffness_matrix"),
    "nothing_that_acts": (lambda: eq.solve(BLOCK, (1.0, 0.5)), "nothing pulls"),
    "an_unknown_group": (lambda: eq.solve(BLOCK, (1.0, 0.5), supports=[{"group": "lefft", "ux": 0}]), "left"),
    "an_unknown_component": (lambda: eq.solve(BLOCK, (1.0, 0.5), supports=[{"group": "left", "uz": 0}]), "uz"),
    "a_support_that_is_no_table": (lambda: eq.solve(BLOCK, (1.0, 0.5), supports=["left"]), "dictionary"),
    "a_rigid_motion":
        (lambda: eq.solve(BLOCK, (1.0, 0.5), supports=[{"group": "left", "ux": 0}]), "translation along y"),
    "a_disc_of_a_group_that_does_not_exist":
        (lambda: eq.solve(BLOCK, (1.0, 0.5), supports=[{"group": [999], "ux": 0, "uy": 0}]), "999"),
    "loads_of_too_few_discs": (lambda: eq.factorize(BLOCK, (1.0, 0.5), HELD).solve(np.ones((3, 3))), "shape"),
    "weights_of_too_few_discs":
        (lambda: eq.factorize(BLOCK, (1.0, 0.5), HELD).derivatives(LOADS, motions=np.ones((3, 2))), "shape"),
    "weights_of_too_few_contacts":
        (lambda: eq.factorize(BLOCK, (1.0, 0.5), HELD).derivatives(LOADS, forces=np.ones((3, 2))), "shape"),
    "motions_with_four_columns": (lambda: eq.form_derivatives(BLOCK, (1.0, 0.5), np.ones((len(BLOCK), 4))), "shape"),
    "a_support_of_a_factor_on_no_disc":
        (lambda: eq.factorize(BLOCK, (1.0, 0.5), [{"group": [999], "ux": 0}]), "999"),
    "an_unknown_option": (lambda: eq.Case(CASES / "abe1996_fig6.toml").solve(acuracy=1), "acuracy"),
    "a_case_file_that_does_not_exist": (lambda: eq.Case("nowhere.toml"), "no such file"),
    "a_study_that_does_not_exist": (lambda: eq.study("nowhere.toml"), "nowhere.toml"),
    "complex_places": (lambda: eq.Assembly(np.array(CENTRES) + 1e-3j, 1.0), "numbers are real"),
    "places_as_text": (lambda: eq.Assembly([["0", "0"], ["2", "0"]], 1.0), "no array of numbers"),
    "masked_places":
        (lambda: eq.Assembly(np.ma.masked_greater(np.array(CENTRES), 1.9), 1.0), "masked"),
    "masked_contacts": (lambda: eq.Assembly(CENTRES, 1.0, np.ma.masked_equal([[0, 1]], 1)), "masked"),
    "masked_components_of_a_force":
        (lambda: eq.solve(BLOCK, (1.0, 0.5), supports=HELD,
                          loads=[{"group": "right", "force": np.ma.masked_equal([1.0, 0.0], 0.0)}]), "masked"),
    "a_gap_tolerance_beyond_one": (lambda: eq.Assembly(CENTRES, 1.0, gap_tolerance=1e9), "0 to 1"),
    "a_gap_tolerance_of_a_file_beyond_one":
        (lambda: eq.read(PACKINGS / "packing.dump", gap_tolerance=-0.1), "0 to 1"),
    "threads_beyond_all_machines": (lambda: eq.set_threads(10**9), "1 to 1024"),
    "half_a_thread": (lambda: eq.set_threads(1.5), "whole number"),
    "no_threads": (lambda: eq.set_threads(0), "1 to 1024"),
    "a_free_assembly_homogenized_as_a_cell":
        (lambda: eq.homogenize(BLOCK, (1e9, 0.5e9), homogenize={"boundary": "periodic"}), "periodic"),
    "too_many_discs": (lambda: eq.hexagonal(columns=10**9, rows=10**9, radius=1e-3), "out of range"),
}


@pytest.mark.parametrize("what", WRONG)
def test_wrong_input_is_refused_with_a_sentence(what):
    call, part = WRONG[what]
    with pytest.raises(eq.BadInput) as caught:
        call()
    sentence = str(caught.value)
    print(sentence)
    assert part in sentence
    assert caught.value.problem in sentence and sentence.endswith((".", "?")) and "\n" not in sentence
    assert "#" not in sentence and isinstance(caught.value, ValueError)


def test_a_poisson_ratio_out_of_reach_is_a_failed_computation_with_one_that_can_be_had():
    with pytest.raises(eq.ComputationFailed, match="at most 0.249999"):
        eq.calibrate(eq.square(columns=4, rows=4, radius=1e-3, periodic=True), young_modulus=1e9, poisson_ratio=0.4)


def test_a_run_that_fails_leaves_its_result_in_the_folder(tmp_path):
    case = eq.Case(CASES / "run_pulse.toml").set("run.time_step", 9e-6).set("run.allow_unstable_step", True)
    with pytest.raises(eq.ComputationFailed, match="ran away") as caught:
        case.set("run.duration", 0.05).set("output.frame_interval", 1e-3).run(out=tmp_path / "out")
    result = json.loads((tmp_path / "out/result.json").read_text(encoding="utf-8"))
    assert (result["status"], result["complete"], result["failure"]) == ("failed", False, str(caught.value))
    assert (tmp_path / "out/discs.csv").exists()


def test_a_matrix_that_is_singular_is_a_failed_computation_or_bad_input():
    with pytest.raises(eq.EquidemError):
        eq.solve(BLOCK, (1.0, -0.9), supports=HELD, loads=[{"group": "right", "force": (1, 0)}], require_stable=True)


PUBLIC = {
    "Assembly": lambda **more: eq.Assembly(CENTRES, 1.0, **more),
    "Case": lambda **more: eq.Case(assembly=BLOCK, springs=(1.0, 0.5), **more).solve(),
    "Springs": lambda **more: eq.Springs(1.0, 0.5, **more),
    "assembly": lambda **more: eq.assembly(kind="square", columns=4, rows=4, radius=1.0, **more),
    "calibrate": lambda **more: eq.calibrate(BLOCK, young_modulus=1e9, poisson_ratio=0.1, **more),
    "consolidate": lambda **more: eq.consolidate(eq.Case(CASES / "grains_biaxial.toml"), void_ratio=0.2, **more),
    "delaunay": lambda **more: eq.delaunay(discs=20, radius=1.0, **more),
    "factorize": lambda **more: eq.factorize(BLOCK, (1.0, 0.5), HELD, **more),
    "fit_springs": lambda **more: eq.fit_springs(BLOCK, (1.0, 0.5), {"K": 1.0}, **more),
    "form_derivatives": lambda **more: eq.form_derivatives(BLOCK, (1.0, 0.5), np.zeros((len(BLOCK), 2)), **more),
    "hexagonal": lambda **more: eq.hexagonal(columns=4, rows=4, radius=1.0, **more),
    "homogenize": lambda **more: eq.homogenize(BLOCK, (1.0, 0.5), **more),
    "StrengthSample": lambda **more: eq.StrengthSample(BLOCK, (1.0, 0.5), **more),
    "pack_discs": lambda **more: eq.pack_discs([0.1] * 9, (1.0, 1.0), **more),
    "triangulated": lambda **more: eq.triangulated(CENTRES, [1.0] * len(CENTRES), **more),
    "pack": lambda **more: eq.pack({"grains": 9, "box": [1, 1], "radii": {"smallest": 0.1, "largest": 0.1}}, **more),
    "read": lambda **more: eq.read(PACKINGS / "packing.dump", **more),
    "run": lambda **more: eq.run(BLOCK, (1.0, 0.5), density=1.0, run={"duration": 1e-6}, **more),
    "simulation": lambda **more: eq.simulation(BLOCK, (1.0, 0.5), density=1.0, run={"duration": 1e-6}, **more),
    "solve": lambda **more: eq.solve(BLOCK, (1.0, 0.5), supports=HELD, **more),
    "square": lambda **more: eq.square(columns=4, rows=4, radius=1.0, **more),
    "stability": lambda **more: eq.stability(BLOCK, (1.0, 0.5), **more),
    "stiffness_matrix": lambda **more: eq.stiffness_matrix(BLOCK, (1.0, 0.5), **more),
    "study": lambda **more: eq.study(STUDY, **more),
    "sweep": lambda **more: eq.sweep(eq.Case(assembly=BLOCK, springs=(1.0, 0.5)), {"springs.kT": [0.1]}, **more),
    "tension_test": lambda **more: eq.tension_test(BLOCK, (1.0, 0.5), **more),
    "set_threads": lambda **more: eq.set_threads(1, **more),
    "show_progress": lambda **more: eq.show_progress(True, **more),
    "threads": lambda **more: eq.threads(**more),
}
NOT_CALLED = {"ConsolidatedSand", "Factor", "FittedSprings", "Frame", "Result", "Simulation", "plot", "BadInput",
              "ComputationFailed", "EquidemError", "Interrupted"}


def test_the_list_of_public_functions_is_complete():
    assert set(PUBLIC) | NOT_CALLED == set(eq.__all__)


@pytest.mark.parametrize("name", PUBLIC)
def test_every_public_function_refuses_unknown_keywords(name):
    with pytest.raises((eq.BadInput, TypeError), match="unknwon"):
        PUBLIC[name](unknwon=1)


@pytest.mark.parametrize("verb", ["solve", "homogenize", "calibrate", "stability", "pack", "run", "quasistatic"])
def test_every_verb_refuses_unknown_options(verb):
    with pytest.raises(eq.BadInput, match="unknwon"):
        eq.Case(CASES / "abe1996_fig6.toml").run_verb(verb, unknwon=1)


@pytest.mark.parametrize("name", ["Assembly", "Factor", "Steps", "Delivered"])
def test_objects_of_the_compiled_part_are_made_there_alone(name):
    made = getattr(eq._core, name)
    with pytest.raises(TypeError):
        made()
    with pytest.raises(TypeError):
        made.__new__(made)


def test_bytes_of_other_encodings_are_refused_and_decoded(tmp_path):
    path = tmp_path / "grains.csv"
    path.write_bytes(b"x [\xb5m],y [\xb5m],d [\xb5m]\r\n0,0,300\r\n300,0,300\r\n150,259.8076,300\r\n")
    with pytest.raises(eq.BadInput, match="not UTF-8.*0xb5"):
        eq.read(path, gap_tolerance=1e-6)
    path.write_text("x [µm],y [µm],d [µm]\n0,0,300\n300,0,300\n150,259.8076,300\n", encoding="utf-8")
    assert len(eq.read(path, gap_tolerance=1e-6).contacts) == 3


GERMAN = """
import json
import locale
import sys

locale.setlocale(locale.LC_ALL, "de_DE.UTF-8")
assert locale.localeconv()["decimal_point"] == ","
import equidem as eq

cell, ensemble = (eq.Case(path) for path in sys.argv[1:])
table = eq.sweep(cell, {"ratio": [0.2, 0.6]})
scale = eq.sweep(cell, {}, key="springs.kT", **{"from": 0.5, "to": 0.75}, steps=2)
ensemble.homogenize(accuracy=0.2)
print(json.dumps([list(map(float, column)) for column in
                  (table["kT"], table["poisson_ratio.plane_strain"], scale["kT"])]))
"""


def test_numbers_do_not_depend_on_the_locale(tmp_path):
    localedef = shutil.which("localedef")
    made = localedef and subprocess.run([localedef, "-i", "de_DE", "-f", "UTF-8", str(tmp_path / "de_DE.UTF-8")],
                                        capture_output=True, check=False).returncode == 0
    if not made:
        pytest.skip("the locale de_DE cannot be made")
    head, springs = 'schema = "equidem/1"\n[assembly]\nperiodic = true\n', "[springs]\nkN = 2.0e8\nkT = 0.5e8\n"
    cell, ensemble = tmp_path / "cell.toml", tmp_path / "ensemble.toml"
    cell.write_text(head + 'kind = "hexagonal"\ncolumns = 2\nrows = 2\nradius = 0.01\n' + springs)
    ensemble.write_text(head + 'kind = "delaunay"\nradius = 0.002\n' + springs + "[ensemble]\ndiscs = [30, 60]\nsamples = 3\n")
    done = subprocess.run([sys.executable, "-c", GERMAN, str(cell), str(ensemble)], capture_output=True, text=True,
                          encoding="utf-8", env={**os.environ, "LOCPATH": str(tmp_path)})
    assert done.returncode == 0, done.stderr
    assert json.loads(done.stdout) == [pytest.approx([0.4e8, 1.2e8]), pytest.approx([0.2, 0.1]), pytest.approx([0.5, 0.75])]


def test_options_that_take_no_value_are_named_as_arguments_that_are_true():
    flags = eq._core.flags_of_verbs()
    assert {"overwrite", "dry-run", "resume", "require-stable"} <= flags and not {"out", "seed", "set"} & flags
    for flag in flags:
        assert eq.errors.in_python(f"pass --{flag}, or wait") == f"pass {flag.replace('-', '_')}=True, or wait"
    assert eq.errors.in_python("Add --out DIR") == "Add out=DIR"
