# SPDX-License-Identifier: GPL-3.0-or-later
"""The scripts breakage, sukegawa2010 and validation of tools/papers, as a user runs them."""
import json
import math
import subprocess
import sys

import pytest
from papers import PAPERS, ROOT, check_help, check_interrupt, result_of, rows, run

ITEMS = ["bond_dilution", "site_dilution", "adsorption", "jamming", "friction", "impacts", "lammps", "point_load", "disc_moduli"]
SHAPES = ("discs", "ellipses", "bonded_pairs", "rigid_pairs")


@pytest.fixture(scope="module", name="breakage")
def fixture_breakage(tmp_path_factory):
    out = tmp_path_factory.mktemp("breakage") / "breakage"
    return out, result_of("breakage", out, "--quick")


@pytest.fixture(scope="module", name="validation")
def fixture_validation(tmp_path_factory):
    out = tmp_path_factory.mktemp("validation") / "validation"
    return out, {item["item"]: item for item in result_of("validation", out, "--quick")["items"]}


@pytest.fixture(scope="module", name="box")
def fixture_box(tmp_path_factory):
    out = tmp_path_factory.mktemp("box") / "box"
    return out, {one["run"]: one for one in result_of("sukegawa2010", out, "--quick")["runs"]}


# ---- all of them

@pytest.mark.parametrize("name", ["breakage", "sukegawa2010", "validation"])
def test_help_names_the_options_and_unknown_ones_are_refused(name):
    check_help(name)


def test_files_that_are_there_are_not_replaced(breakage):
    refused = run("breakage", "--quick", "--out", breakage[0])
    assert refused.returncode == 2 and "--overwrite" in refused.stderr


@pytest.mark.parametrize("name", ["breakage", "sukegawa2010", "validation"])
def test_interrupted_they_stop_soon(name, tmp_path):
    check_interrupt(name, tmp_path / "out")


def test_stopped_with_its_workers_a_script_ends(tmp_path):
    check_interrupt("validation", tmp_path / "out", whole_group=True)


def pictures_are_there(out, name):
    page = (out / f"{name}.md").read_text(encoding="utf-8")
    for line in page.splitlines():
        if line.startswith("!["):
            assert (out / line.split(f"({name}/")[1].rstrip(")")).exists(), line
    return page


# ---- breakage

def test_strength_falls_as_the_root_of_the_length_of_a_notch_with_the_toughness_of_the_lattice(breakage):
    out, result = breakage
    pictures_are_there(out, "breakage")
    assert len(rows(out / "notches_values.csv")) == 28
    for fit in result["fits"]:
        assert fit["toughness"] > fit["griffith"]
        if fit["columns"] == 41:
            assert abs(fit["exponent"] + 0.5) < 0.015
    for ratio in (0.0, 0.4):  # wider plates have longer notches of many discs
        narrow, wide = [abs(fit["toughness"] / fit["lattice"] - 1) for fit in result["fits"] if fit["ratio"] == ratio]
        assert wide < min(narrow, 0.02)
    assert result["energies"]["error"] < 1e-10


def test_chains_are_as_strong_as_their_weakest_link_and_larger_plates_are_weaker_and_scatter_less(breakage):
    result = breakage[1]
    for chain in result["chains"]:
        assert abs(chain["strength"] - chain["weakest_link"]) < 4.5 * chain["standard_error"]
    for modulus in (2, 4, 8):
        small, large = [plate for plate in result["plates"] if plate["modulus"] == modulus]
        assert large["strength"] < small["strength"] and large["standard_deviation"] < small["standard_deviation"]


# ---- validation

def comparisons(validation, item, *words):
    found = [c for c in validation[1][item]["comparisons"] if all(word in c["quantity"] for word in words)]
    assert found, (item, words)
    return found


def agree(validation, item, *words):
    return all(c["agrees"] for c in comparisons(validation, item, *words))


def hold(validation, item):
    return all(one["holds"] for one in validation[1][item]["trends"])


def test_all_items_are_compared_with_named_sources(validation):
    out, items = validation
    assert list(items) == ITEMS
    page = pictures_are_there(out, "validation")
    for item in items.values():
        for row in item["comparisons"] + item["trends"]:
            assert row["source"] == "closed form" or f"**{row['source']}**" in page
    assert len(rows(out / "comparisons.csv")) == sum(len(item["comparisons"]) for item in items.values())


def test_a_verdict_follows_from_the_two_numbers_and_their_errors(validation):
    verdicts = set()
    for item in validation[1].values():
        for c in item["comparisons"]:
            verdicts.add(c["agrees"])
            if not c["agrees"]:
                assert abs(c["ours"] - c["published"]) > 2.5 * math.hypot(c["published_error"], c["standard_error"])
                assert "differs by" in c["verdict"] and len(c["verdict"].split(": ", 1)[1]) > 20
    assert verdicts == {True, False}  # quick cells are too small for the threshold of sites


def test_a_lattice_with_missing_bonds_is_rigid_from_p_of_0_6602_on_and_softens_by_three_times_their_share(validation):
    assert agree(validation, "bond_dilution", "threshold") and agree(validation, "bond_dilution", "slope")
    assert all(abs(c["ours"] - c["published"]) < 0.06 for c in comparisons(validation, "bond_dilution", "(1) at p = "))
    assert all(abs(c["ours"] - c["published"]) < 0.05 for c in comparisons(validation, "site_dilution", "extrapolated"))


def test_random_adsorption_ends_at_0_547_and_discs_jam_near_0_842_with_2n_minus_1_contacts(validation):
    assert agree(validation, "adsorption") and agree(validation, "jamming") and hold(validation, "jamming")
    assert all(abs(c["ours"]) < 0.1 for c in comparisons(validation, "jamming", "contacts beyond"))


def test_large_friction_brings_the_coordination_near_3(validation):
    assert hold(validation, "friction")
    assert all(abs(c["ours"] - 3) < 0.2 for c in comparisons(validation, "friction", "friction 10"))


def test_impacts_follow_hertz_and_coulomb(validation):
    assert agree(validation, "impacts") and hold(validation, "impacts")


def test_trajectories_of_lammps_without_friction_are_repeated_to_its_ten_digits(validation):
    for words in ("dem02", "dem03", "dem10", "dem11"):
        assert agree(validation, "lammps", words), words


def test_numbers_that_are_stored_are_shown_with_their_date_and_not_judged(validation):
    out, items = validation
    stored = {name: {row["name"] for row in item["stored"]} for name, item in items.items() if item["stored"]}
    assert {name: len(rows) for name, rows in stored.items()} == {"impacts": 14, "lammps": 14}
    page = (out / "validation.md").read_text(encoding="utf-8")
    for name, quantities in stored.items():
        assert not quantities & {c["quantity"] for c in items[name]["comparisons"]}
        for quantity in quantities:
            line = next(line for line in page.splitlines() if line.startswith(f"| {quantity} |"))
            assert line.endswith("| 2026-11-28 | d8744bcd |") and "agrees" not in line and "differs" not in line


def test_a_point_load_presses_as_on_an_elastic_half_plane(validation):
    assert agree(validation, "point_load") and hold(validation, "point_load")


def test_uniform_strain_overestimates_the_moduli_of_discs(validation):
    assert hold(validation, "disc_moduli")


def test_one_item_alone_is_computed_and_others_are_refused():
    done = run("validation", "--quick", "--only", "lammps", "--json", "-")
    assert [item["item"] for item in json.loads(done.stdout)["items"]] == ["lammps"]
    refused = run("validation", "--only", "weather")
    assert refused.returncode == 2 and "weather" in refused.stderr


# ---- sukegawa2010

def test_boxes_are_filled_and_shaken_with_their_pictures(box):
    out, runs = box
    for shape in SHAPES:
        one = runs[f"{shape}_1_400gal_10Hz"]
        assert 0.1 < one["void_ratio_before"] < 0.3 and one["centre_height_m"] < one["centre_height_before_m"]
        for name in ("pictures.png", "shakings.png", "paths.png", "falling_y.png", "shaken_angle.csv"):
            assert (out / f"{shape}_{name}").exists(), (shape, name)
    discs = [one["void_ratio_before"] for one in runs.values() if one["shape"] == "discs"]
    assert runs["ellipses_1_400gal_10Hz"]["void_ratio_before"] < min(discs)
    assert runs["discs_1_1200gal_2Hz"]["largest_slope"] > 10 * runs["discs_1_400gal_10Hz"]["largest_slope"]
    assert runs["bonded_pairs_1_400gal_10Hz"]["bond_creep"] > 0 and runs["discs_1_400gal_10Hz"]["bond_creep"] is None
    assert all(abs(one["energy_error"]) < 0.02 for one in runs.values())
    # rho = (1 + e) gamma in springs and masses: the same motion but for rounding, until it grows.
    bulk, usual = (json.loads((out / "runs" / f"discs{variant}_1_400gal_10Hz.json").read_text(encoding="utf-8"))["falling"]
                   for variant in ("_bulk_density", ""))
    assert max(abs(a - b) for key in ("x_m", "y_m") for one, other in zip(bulk[key][:20], usual[key])
               for a, b in zip(one, other)) < 1e-9
    assert bulk["y_m"][19][8] < bulk["y_m"][0][8] - 0.15  # the lower rows have met the floor
    assert [row["run"] for row in rows(out / "runs.csv")] == list(runs)


def test_runs_that_are_done_are_taken_from_the_folder_and_those_of_other_fillings_refused(box):
    out, runs = box
    (out / "runs" / "discs_2_400gal_10Hz.json").unlink()
    again = {one["run"]: one for one in result_of("sukegawa2010", out, "--quick", "--overwrite")["runs"]}

    def numbers(found):
        return {name: {key: value for key, value in one.items() if key != "seconds"} for name, one in found.items()}
    assert numbers(again) == numbers(runs)
    kept = out / "runs" / "discs_3_400gal_10Hz.json"
    kept.write_text(kept.read_text(encoding="utf-8").replace('"seed": 3', '"seed": 4'), encoding="utf-8")
    refused = run("sukegawa2010", "--quick", "--out", out, "--overwrite")
    assert refused.returncode == 2 and "discs_3_400gal_10Hz.json" in refused.stderr


def test_the_stored_runs_give_the_stored_report(tmp_path):
    result = result_of("sukegawa2010", tmp_path / "out", "--stored")
    assert len(result["runs"]) == 135 and {one["source"] for one in result["runs"]} == {"stored"}
    report = (tmp_path / "out" / "report.txt").read_text(encoding="utf-8")
    assert report == (ROOT / "data" / "papers" / "sukegawa2010" / "report.txt").read_text(encoding="utf-8")


def test_the_printed_period_follows_from_neither_formula():
    program = ("import sys; sys.path.insert(0, sys.argv[1]); import sukegawa2010 as s; "
               "print(*(s.sloshing_period(1.215, h, printed=factor) for h in (2.25, 0.549) for factor in (1, 2)))")
    found = subprocess.run([sys.executable, "-B", "-c", program, PAPERS], capture_output=True, text=True, check=True).stdout
    linear, printed, heap, printed_heap = map(float, found.split())
    assert min(abs(period - 1.85) for period in (linear, printed, heap, printed_heap)) > 0.5
    assert round(linear, 2) == round(printed, 2) == 1.25 and heap == pytest.approx(1.3235, rel=1e-4)
