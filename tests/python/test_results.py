# SPDX-License-Identifier: GPL-3.0-or-later
"""Results show themselves as text, HTML, tables and pictures."""

import dataclasses
import doctest
import importlib
import json
import pkgutil
import re

import numpy as np
import pytest

import equidem as eq
from scenes import BLOCK, CASES, CELL, HELD, PULLED, SOURCE, SPRINGS, STUDIES, hexagonal, tension

STUDY = STUDIES / "abe_lattice.toml"
WIDE = {"kN": 1e9, "kT": 0.5e9, "bond_width": 0.8}
PACKING = {"method": "growth", "sides": "periodic", "grains": 60, "solid_fraction": 0.8, "gap_tolerance": 0.1,
           "radii": {"smallest": 1e-3, "largest": 2e-3}}


def unloaded():
    """A solution of one factor, without loads."""
    return eq.factorize(BLOCK, SPRINGS, HELD).solve(np.zeros((len(BLOCK), 3)))


def test_numbers_have_units_and_meanings():
    result = eq.tension_test(BLOCK, SPRINGS)
    assert result.units["plane_strain.young_modulus"] == "Pa" and result.units["displacements"] == "m"
    assert "Poisson" in result.labels["poisson_ratio"]
    assert result["poisson_ratio"] == result.poisson_ratio and "poisson_ratio" in dir(result)
    with pytest.raises(AttributeError, match="names all that it has"):
        result.poison_ratio


def test_moduli_are_found_by_plane_in_results_of_all_verbs():
    moduli = eq.homogenize(CELL, SPRINGS)
    assert moduli.plane_strain.poisson_ratio == moduli.poisson_ratio.plane_strain
    assert moduli.plane_stress.young_modulus == moduli.young_modulus.plane_stress
    achieved = eq.calibrate(CELL, young_modulus=1e9, poisson_ratio=0.1).achieved
    assert abs(achieved.plane_strain.poisson_ratio - 0.1) < 1e-12
    assert "plane_strain" not in moduli and "plane_strain" in eq.tension_test(BLOCK, SPRINGS)
    with pytest.raises(AttributeError, match="plane_strain"):
        eq.stability(CELL, SPRINGS).plane_strain


def test_a_result_is_shown_as_text_and_html():
    result = eq.tension_test(BLOCK, SPRINGS)
    assert "tension test" in repr(result) and repr(result) == result.report.rstrip("\n")
    assert result._repr_html_().startswith("<pre>")
    json.dumps(result.to_dict())
    assert "<table>" in unloaded()._repr_html_()


def test_the_stiffness_is_the_sum_of_springs_times_its_derivatives():
    cell = eq.delaunay(discs=60, radius=5e-3, seed=2, periodic=True)
    result = eq.homogenize(cell, SPRINGS, sensitivities=True)
    assert result.dC_dkN.shape == (len(cell.contacts), 3, 3) and result.units["dC_dkN"] == ""
    assert {unit for name, unit in result.units.items() if name.startswith("sensitivities")} == {""}
    assert "all kT" in result.labels["sensitivities.kT.young_modulus"]
    assert not result.dC_dkN.flags.writeable and "dC_dkM" not in result
    whole = 1e9 * result.dC_dkN.sum(axis=0) + 0.5e9 * result.dC_dkT.sum(axis=0)
    assert np.allclose(whole, result.stiffness, rtol=0, atol=1e-9 * np.abs(whole).max())
    assert result.dC_dx.shape == result.dC_dradius.shape == (len(cell), 3, 3) and result.units["dC_dy"] == "Pa/m"
    # it does not change where the whole cell moves
    assert abs(result.dC_dx.sum(axis=0)).max() <= 1e-9 * abs(result.dC_dx).max() * len(cell)
    assert "dC_dkN" not in eq.homogenize(cell, SPRINGS)


def test_a_frequency_changes_with_one_spring_as_its_derivative_says():
    plate = eq.delaunay(discs=80, radius=5e-3, seed=4)
    held = [{"group": "left", "ux": 0, "uy": 0}]

    def lowest(kT, **options):
        return eq.stability(plate, eq.Springs(np.full(len(kT), 1e9), kT), supports=held, **options)

    kT = np.full(len(plate.contacts), 0.5e9)
    found = lowest(kT, sensitivities=True)
    slopes = found.dnatural_frequencies_dkT
    assert slopes.shape == (len(kT), 4) and found.units["dnatural_frequencies_dkT"] == "Hz/Pa"
    assert np.isfinite(found.dcritical_ratio_dkN).all() and "dVp_x_dkN" not in found
    contact = slopes[:, 0].argmax()
    step = np.zeros(len(kT))
    step[contact] = 1e6
    difference = (lowest(kT + step).natural_frequencies[0] - lowest(kT - step).natural_frequencies[0]) / 2e6
    error = found.sensitivities.frequency_error * found.natural_frequencies[0] / 0.5e9  # the step is 0.2 % of the spring
    assert abs(difference - slopes[contact, 0]) <= 1e-5 * slopes[contact, 0] + error
    assert "dnatural_frequencies_dkT" not in lowest(kT)


def test_displacements_and_moduli_have_the_derivatives_of_their_factor():
    loads = [{"group": "right", "force": (1, 0), "case": "pull"}, {"group": "right", "force": (0, 1), "case": "lift"}]
    result = eq.solve(BLOCK, SPRINGS, supports=HELD, loads=loads, sensitivities=True)
    right = BLOCK.groups["right"]
    forces, weights = np.zeros((len(BLOCK), 2)), np.zeros((len(BLOCK), 2))
    forces[right, 1], weights[right, 1] = 1, 1 / len(right)
    expected = eq.factorize(BLOCK, SPRINGS, HELD).derivatives(forces, motions=weights)
    for by in ("kN", "kT"):
        found = result.lift[f"dright_uy_d{by}"]
        assert np.abs(found - expected[f"by_{by}"]).max() <= 1e-9 * np.abs(found).max()
    assert result.pull.units["dright_ux_dkN"] == "m/Pa" and "dE_dkN" not in result.pull
    test = eq.tension_test(BLOCK, SPRINGS, sensitivities=True)
    whole = 1e9 * test.dE_dkN.sum() + 0.5e9 * test.dE_dkT.sum()
    assert abs(whole - test.plane_stress.young_modulus) <= 1e-9 * whole


def test_load_cases_have_their_own_arrays():
    result = eq.solve(BLOCK, SPRINGS, supports=HELD, loads=[{"group": "right", "force": (1, 0), "case": "pull"},
                                                            {"group": "right", "force": (0, 1), "case": "lift"}])
    assert result.pull.displacements[:, 0].max() > 0 and result.lift.displacements[:, 1].max() > 0
    assert [case["case"] for case in result.load_cases] == ["pull", "lift"]


def test_a_sweep_is_a_table_with_units():
    pandas = pytest.importorskip("pandas")
    table = eq.sweep(eq.Case(assembly=CELL, springs=SPRINGS), {"springs.kN": [1e9, 2e9, -1e9], "springs.kT": [0.2e9, 0.4e9]})
    assert isinstance(table, pandas.DataFrame) and len(table) == 6
    assert table.attrs["units"]["shear_modulus"] == "Pa"
    assert table.attrs["units"]["springs.kN"] == "Pa"
    # Abe 1996, eq. (34): G = sqrt(3)/4 (kN + kT)
    expected = np.sqrt(3) / 4 * (table["springs.kN"] + table["springs.kT"])
    done = table["status"] != "failed"
    assert done.any() and not done.all() and table["message"][~done].str.len().min() > 20
    assert np.allclose(table["shear_modulus"][done], expected[done], rtol=1e-12)


def test_random_cells_are_sampled():
    result = eq.Case(assembly={"kind": "delaunay", "radius": 1e-3, "discs": 50, "periodic": True}, springs=SPRINGS,
                     ensemble={"discs": [50, 100], "samples": 4}).homogenize()
    assert result.status == "done" or result.status == "solved"


def test_springs_that_are_given_replace_those_of_a_packing():
    packed = eq.pack(PACKING, (1e9, 0.5e9)).assembly
    own = eq.homogenize(packed)
    assert own.stiffness == eq.homogenize(packed, (1e9, 0.5e9)).stiffness
    assert np.allclose(eq.homogenize(packed, (2e9, 1e9)).stiffness, 2 * np.array(own.stiffness), rtol=1e-12)
    each = eq.Springs(np.full(len(packed.contacts), 3e9), np.full(len(packed.contacts), 1.5e9))
    assert np.allclose(eq.homogenize(packed, each).stiffness, 3 * np.array(own.stiffness), rtol=1e-12)
    assert eq.calibrate(packed, young_modulus=1e9, poisson_ratio=0.2).status == "calibrated"


def test_bonds_of_a_width_resist_bending():
    ends = [{"group": "left", "ux": 0, "uy": 0, "rotation": 0}, {"group": "right", "uy": 1e-6}]
    bent = eq.solve(BLOCK, eq.Springs(**WIDE), supports=ends)
    assert np.array_equal(bent.displacements, eq.solve(BLOCK, WIDE, supports=ends).displacements)
    assert np.abs(bent.bending_moments).max() > 0
    assert bent.energy > eq.solve(BLOCK, SPRINGS, supports=ends).energy
    case = eq.Case(assembly={"kind": "hexagonal", "columns": 7, "rows": 7, "radius": 1e-3}, springs=WIDE, supports=ends)
    assert np.allclose(bent.displacements, case.solve().displacements, rtol=1e-9, atol=1e-18)


@pytest.mark.parametrize("more", [{}, {"bond_width": 0.8}, {"weighting": "contact_density", "bond_width": 0.5}])
def test_calibrated_springs_passed_back_give_the_wanted_moduli(more):
    cell = eq.delaunay(discs=60, radius=1e-3, seed=1, periodic=True)
    found = eq.calibrate(cell, shear_modulus=1e6, poisson_ratio=0.2, density=2000.0, **more)
    print(dict(found.springs))
    assert {name: found.springs[name] for name in more} == more
    for springs in (found, found.springs, found.springs.to_dict(), eq.Springs(**found.springs)):
        assert abs(eq.homogenize(cell, springs).shear_modulus - 1e6) <= 1e-9 * 1e6
    advised = eq.homogenize(cell, found.mean_field)
    assert abs(advised.shear_modulus - found.mean_field.achieved.shear_modulus) <= 1e-9 * advised.shear_modulus
    # 2000 kg/m³ of the continuum are those of the discs times the solid fraction
    assert eq.stability(cell, found).density == pytest.approx(2000.0 / cell.solid_fraction, rel=1e-12)


def test_a_bending_spring_acts():
    moduli = [eq.tension_test(BLOCK, springs).plane_strain.young_modulus for springs in
              ({"kN": 1e9, "kT": 0.5e9}, {"kN": 1e9, "kT": 0.5e9, "kM": 300.0}, eq.Springs(1e9, 0.5e9, kM=300.0))]
    assert moduli[1] == moduli[2] > 1.001 * moduli[0]


def test_springs_have_the_keys_of_the_case_file():
    table = (SOURCE / "docs/case_file.md").read_text(encoding="utf-8").split("### `[springs]`")[1].split("###")[0]
    names = re.findall(r"^\| (`[^|]+`) \|.*\| (?!\(packings\)|\(assemblies; \[\[)[^|]* \|$", table, re.M)
    assert set(re.findall(r"`(\w+)`", " ".join(names))) == {field.name for field in dataclasses.fields(eq.Springs)}


def test_springs_of_each_contact_are_an_array_too():
    each = eq.Springs(1e9, 0.5e9).at_contacts(BLOCK)
    assert eq.tension_test(BLOCK, each).poisson_ratio == eq.tension_test(BLOCK, SPRINGS).poisson_ratio


def test_a_verb_says_how_long_it_took():
    result = eq.tension_test(BLOCK, SPRINGS)
    assert 0.5 * sum(result.times.values()) < result.elapsed < 60
    assert np.isnan(unloaded().elapsed)


def test_refusals_of_an_ensemble_do_not_name_cases_in_memory():
    packing = {**PACKING, "grains": 100, "solid_fraction": 0.84, "gap_tolerance": 0.05,
               "radii": {"smallest": 0.5e-3, "largest": 1e-3}}
    result = eq.Case(assembly={"kind": "packing"}, packing=packing, springs=SPRINGS,
                     ensemble={"discs": [400], "samples": 5}).homogenize()
    print(result.report)
    assert 0 < len(result.refusals) < 5
    assert "#" not in result.report and all(refusal.why.startswith("packing.") for refusal in result.refusals)


def test_a_study_shows_the_price_of_accuracy():
    result = eq.study(STUDY, accuracy=1e-3, rounds=3, budget=1)
    assert result.status == "done" and len(result.settings) > 5


def test_a_dry_run_computes_nothing():
    result = tension().solve(dry_run=True)
    assert result.status == "dry_run" and "displacements" not in result and result.unknowns > 0


def pulse():
    return eq.run(hexagonal(20, 5), SPRINGS, density=2500.0, run={"duration": 1e-4},
                  velocity=[{"group": "left", "velocity": (0.1, 0.0)}],
                  probe=[{"name": "far", "group": "right", "quantities": ["velocity"]}],
                  output={"probe_interval": 1e-5, "frame_interval": 1e-5})


def test_a_run_in_memory_has_its_histories():
    result = pulse()
    history, energies = result.history, result.energies
    assert history.time_s[0] == 0 and abs(history.time_s[-1] - 1e-4) <= result.time_step
    assert len(history.far_vx_m_per_s) == len(history.time_s) >= 10 and history.far_vx_m_per_s[-1] > 0
    total = energies.kinetic_J_per_m + energies.elastic_J_per_m - energies.sway_J_per_m
    assert np.abs(total - total[0]).max() <= 1e-9 * total[0] and len(total) > 10


def test_histories_are_those_of_the_folder(tmp_path):
    case = eq.Case(CASES / "grains_piston.toml").set("output.probe_interval", 0.01).set("run.duration", 0.1)
    memory, files = case.run(), case.run(out=tmp_path / "out")
    columns = (tmp_path / "out/history.csv").read_text(encoding="utf-8").splitlines()[0].split(",")
    assert list(memory.history) == list(files.history) == columns and "wall" in " ".join(columns)
    table = np.genfromtxt(tmp_path / "out/history.csv", delimiter=",", skip_header=1)
    for k, name in enumerate(columns):
        assert np.array_equal(memory.history[name], table[:, k], equal_nan=True)
        assert np.array_equal(files.history[name], table[:, k], equal_nan=True)


def test_measures_of_a_box_are_a_history_too():
    discs = [{"position": [x, y], "radius": 0.1, "density": 1000.0} for x in (0.15, 0.4, 0.7) for y in (0.15, 0.45)]
    walls = [{"name": "floor", "point": [0, 0], "normal": [0, 1]}, {"name": "left", "point": [0, 0], "normal": [1, 0]},
             {"name": "right", "point": [0.9, 0], "normal": [-1, 0]}]
    result = eq.run(grain=discs, wall=walls, collisions={"restitution": 0.5, "stiffness": 1e5},
                    run={"duration": 0.1, "gravity": [0, -9.81]}, measures={}, output={"probe_interval": 0.01})
    history = result.measures_history
    assert history.time_s[0] == 0 and len(history.void_ratio) == len(history.time_s) == len(result.history.time_s)
    assert list(result.measures.void_ratio) == ["before", "after"]


def test_a_test_of_a_sample_has_curves_tables_and_a_plot():
    pandas = pytest.importorskip("pandas")
    matplotlib = pytest.importorskip("matplotlib")
    matplotlib.use("Agg")
    case = eq.Case(CASES / "grains_sheared_cell.toml").set("run.duration", 0.3)
    result = case.run()
    tables = result.histories
    assert set(tables) == {"history", "energies", "curves"}
    assert all(isinstance(table, pandas.DataFrame) for table in tables.values())
    history, curves = tables["history"], tables["curves"]
    assert len(curves) == (history["cell_strain_xy"] > 0).sum() + 1
    assert np.array_equal(curves["strain"], np.asarray(history["cell_strain_xy"])[-len(curves):])
    volume = np.asarray(history["cell_strain_xx"] + history["cell_strain_yy"])[-len(curves):]
    assert np.allclose(curves["volume_strain"], volume - volume[0], rtol=0, atol=1e-12)
    labels = [line.get_label() for line in result.plot().lines]
    assert "shear stress" in labels and "axial stress" in labels
    assert 0 < result.sample.friction_angle.peak < np.pi / 2 and result.sample.strain == curves["strain"].iloc[-1]
    path = eq.Case(CASES / "notched_plate.toml").set("quasistatic.max_events", 20).quasistatic()
    assert {"curve", "load_envelope", "motion_envelope"} <= set(path.histories)


def test_pictures_are_drawn(tmp_path):
    matplotlib = pytest.importorskip("matplotlib")
    matplotlib.use("Agg")
    import matplotlib.pyplot as plt

    axes = eq.tension_test(BLOCK, SPRINGS).plot()
    assert len(axes.collections) == 2 and "displacements x" in axes.get_title()
    waves = eq.stability(CELL, SPRINGS, density=2500.0)
    assert len(waves.plot().lines) > 3
    path = eq.Case(CASES / "notched_plate.toml").quasistatic()
    assert [line.get_label() for line in path.plot().lines][0] == "events" and path.assembly is not None
    run = pulse()
    axes = run.plot()
    assert "kinetic" in [line.get_label() for line in axes.lines] and axes.get_xlabel() == "time, s"
    BLOCK.plot(values=np.arange(len(BLOCK)), label="number")
    ellipses = eq.plot.bodies([[0, 0], [np.nan, 0]], [[2, 1], [2, 1]], angles=[0.5, 0]).collections[0]
    assert len(ellipses.get_offsets()) == 1 and ellipses.axes.get_ylim() == (-4, 4)
    with pytest.raises(eq.BadInput, match="no picture"):
        eq.study(STUDY, rounds=3, budget=1).plot()
    plt.savefig(tmp_path / "discs.png")
    plt.close("all")
    assert (tmp_path / "discs.png").stat().st_size > 5000


def test_examples_of_the_docstrings_work():
    for module in pkgutil.iter_modules(eq.__path__, "equidem."):
        if module.name.endswith("_core"):
            continue
        failed, tried = doctest.testmod(importlib.import_module(module.name))
        print(module.name, tried)
        assert failed == 0
    assert doctest.testmod(eq).failed == 0


def test_every_public_name_is_documented():
    for name in eq.__all__:
        thing = getattr(eq, name)
        assert thing.__doc__ and len(thing.__doc__) > 20, name


def test_a_case_is_exported_as_the_program_does(tmp_path):
    case = eq.Case(assembly={"kind": "hexagonal", "columns": 5, "rows": 5, "radius": 5e-3}, springs=(1e9, 0.5e9), test=PULLED)
    result = case.export("yade", out=tmp_path / "yade")
    assert result.bonds > 40 and result.time_step > 0
    assert "CohFrictMat" in (tmp_path / "yade" / "run_equidem.py").read_text()
    with pytest.raises(eq.BadInput, match="pass overwrite=True"):
        case.export("yade", out=tmp_path / "yade")
    with pytest.raises(eq.BadInput, match="does not carry .*negative kT"):
        case.set("springs.kT", -1e8).export("lammps", out=tmp_path / "lammps")
