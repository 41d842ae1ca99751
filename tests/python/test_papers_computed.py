# SPDX-License-Identifier: GPL-3.0-or-later
"""The scripts abe1996, abe1996_random and fujioka2005 of tools/papers, as a user runs them, beside published
numbers."""
import pytest
from papers import ROOT, check_help, check_interrupt, result_of, rows, run


def published(name):
    return {row["name"]: float(row["value"]) for row in rows(ROOT / "data" / "papers" / f"{name}.csv")}


@pytest.fixture(scope="module", name="computed")
def fixture_computed(tmp_path_factory):
    """Of each paper, once: the folder and result.json."""
    made = {}

    def of(name):
        if name not in made:
            out = tmp_path_factory.mktemp(name) / "out"
            made[name] = out, result_of(name, out, "--quick")
        return made[name]
    return of


# ---- the command line

@pytest.mark.parametrize("name", ["abe1996", "abe1996_random", "fujioka2005"])
def test_help_names_options_and_exit_codes(name):
    check_help(name)


def test_bad_usage_is_exit_code_2(tmp_path):
    for arguments in (["--frob"], ["--thread", "2"]):
        done = run("fujioka2005", *arguments)
        assert done.returncode == 2 and arguments[0] in done.stderr and done.stdout == "", done
    (tmp_path / "figure4.svg").touch()
    done = run("fujioka2005", "--out", tmp_path)
    assert done.returncode == 2 and "figure4.svg" in done.stderr and "--overwrite" in done.stderr


def test_interrupted_it_ends_with_130(tmp_path):
    check_interrupt("fujioka2005", tmp_path / "out")


# ---- Abe (1996)

def test_abe1996_tension_test_follows_his_theory(computed):
    _, result = computed("abe1996")
    printed = published("abe1996")
    assert result["critical_ratio_lattice"] == pytest.approx(printed["scatter_begins"])
    points = {point["ratio"]: point for point in result["points"]}
    for name in ("poisson_ratio", "stiffness_ratio"):
        for ratio in (0, 1) if name == "stiffness_ratio" else (-0.2, 0, 1):
            wanted = printed[f"{name}_at_{ratio}"]
            assert points[ratio][f"theory_{name}"] == pytest.approx(wanted, abs=1e-15)
            error = 1e-12 if ratio == 0 else 0.02  # of order 1/rows
            assert points[ratio][name] == pytest.approx(wanted, abs=error), (name, ratio)
    assert not points[-0.9]["stable"] and points[0.5]["stable"]
    nu = {row["block"]: row["poisson_ratio"] for row in result["error_of_nu"]}
    assert abs(nu["17 rows of 17 discs, equal loads (Fig. 6)"]) > 5e-3
    assert abs(nu["17 rows of 17 discs, loads of the uniform state"]) < 1e-11
    assert abs(nu["periodic cell, homogenized"]) < 1e-12


def test_abe1996_lattices_have_the_moduli_of_his_equations(computed):
    _, result = computed("abe1996")
    for key in ("free_rotation_deviation", "restrained_rotation_deviation"):
        assert result["macroscopic_stress"][key] < 1e-12
    stress = result["macroscopic_stress"]
    assert stress["asymmetry"] == pytest.approx(stress["expected_asymmetry"])
    for row in result["square_lattice"]:
        assert row["poisson_ratio_rows"] == pytest.approx(0, abs=1e-12)
        assert row["poisson_ratio_diagonal"] == pytest.approx((1 - row["ratio"]) / 2, abs=1e-12)
        assert (row["anisotropy"] < 1e-12) == (row["ratio"] == 1)
    for row in result["restrained_waves"]:
        assert row["poisson_ratio"] == pytest.approx(row["wanted_poisson_ratio"], abs=1e-12)
        assert row["shear_modulus"] == pytest.approx(1, abs=1e-12)
    for row in result["unequal_radii"]:
        assert row["printed_mean_xx"] == pytest.approx(1, abs=1e-9)
        assert row["scatter_xx"] == pytest.approx(0.25, abs=0.05)


def test_abe1996_writes_its_figures(computed):
    out, _ = computed("abe1996")
    for name in ("figure6.png", "figure7.svg", "figure7_plane_stress.csv", "figure8.csv", "error_by_size.png"):
        assert (out / name).stat().st_size > 0, name
    assert {row["series"] for row in rows(out / "figure7.csv")} == {"theory", "nu_large", "nu_stable", "nu_unstable"}


def test_abe1996_random_answers_in_sentences_tables_and_plots(computed):
    out, result = computed("abe1996_random")
    report = (out / "report.txt").read_text(encoding="utf-8")
    for words in ("Errors of the mean field", "The correction (11)", "With a local psi", "Best for nu"):
        assert words in report
    table = rows(out / "mean_field.csv")
    assert len(table) == len(result["points"]) == 7 * 4 * 3
    for point in result["points"]:
        if point["points"] == "perturbed_hexagonal" and point["disorder"] == 0:
            assert abs(point["nu_error"]) < 1e-12 and abs(point["G_error"]) < 1e-12
        if point["weighting"] == "local_contact_density" and point["points"] == "poisson_disc" \
                and point["stretch"] == 1 and point["kT_over_kN"] == 0:
            assert abs(point["nu_error"]) < 0.015
        if point["weighting"] == "voronoi":
            assert abs(point["K_error"]) < 1e-12
    for name in ("poisson_ratio_uniform", "error_poisson_ratio_voronoi", "error_shear_modulus_contact_density"):
        assert (out / (name + ".png")).exists(), name


# ---- Fujioka & Ushijima (2005)

def test_fujioka2005_counts_the_steps_of_table_2(computed):
    out, result = computed("fujioka2005")
    printed = published("fujioka2005")
    steps = {row["letter"]: row["steps"] for row in reversed(result["table2"])}
    for letter in "CTFP":
        assert steps[letter] == [printed[f"steps_{letter}_1e-{k}"] for k in (3, 4, 5)], letter
    assert [row["letter"] for row in rows(out / "table2.csv")] == ["C", "T", "F", "P", "X", "X"]


def test_fujioka2005_impacts_keep_the_energy_as_printed(computed):
    _, result = computed("fujioka2005")
    theory = published("fujioka2005")["restitution"] ** 2
    for row in result["fast_impacts"]:
        if row["letter"] in "FPX":
            assert row["energy_ratios"] == pytest.approx([theory] * 20, abs=2e-4), row["letter"]
        if row["letter"] == "C":
            assert row["deepest"] > 1
    slow = {row["letter"]: row for row in reversed(result["slow_impacts"])}
    assert slow["P"]["energy_ratios"][:10] == pytest.approx([theory] * 10, abs=2e-3)
    assert slow["P"]["energy_ratios_of_flights"][9] < 0.45
    hertz = {row["a"]: row for row in result["fast_impacts"] if row["letter"] == "T"}
    assert hertz[4.62]["ran_away"] and not hertz[1.5]["ran_away"]
    assert 0.4 < min(hertz[1.5]["energy_ratios"]) and max(hertz[1.5]["energy_ratios"]) < 0.7


def test_fujioka2005_stacked_spheres_converge_but_for_the_lag_of_C(computed):
    _, result = computed("fujioka2005")
    for row in result["stacked"]:
        if row["letter"] in "FPX":
            assert min(zip(row["time_step"], row["speed_error"]))[1] < 1e-5, row["label"]
            assert row["speed_order"] > 1, row["label"]
    order = {row["label"]: row["speed_order"] for row in result["stacked"]}
    assert order["C"] < 0.3 and order["C, no lag"] > 1.8


def test_fujioka2005_evaluations_of_table_1_are_those_of_balls_at_rest(computed):
    _, result = computed("fujioka2005")
    counts = {row["letter"]: row for row in reversed(result["table1"])}
    resting = 16 * (5 - 0.67763 * 1.7 / 0.3) / 1e-5
    for letter in "TFPX":
        assert counts[letter]["evaluations"] / resting == pytest.approx(1, abs=0.06), letter
    share = counts["P"]["evaluations_gravity_first"] / counts["F"]["evaluations_gravity_first"]
    assert share == pytest.approx(1.86, abs=0.02)


def test_fujioka2005_columns_come_to_rest_under_X_alone(computed):
    out, result = computed("fujioka2005")
    for row in result["column"]:
        if row["letter"] == "X":
            assert row["speed_of_g_dt"] < 1e-4 and row["overlap_of_static"] == pytest.approx(1, abs=1e-6)
        elif row["letter"] in "FP":
            assert row["speed_of_g_dt"] > 0.1
    report = (out / "report.txt").read_text(encoding="utf-8")
    assert "The conclusions of the paper" in report and report.count("An evaluation of P costs +") == 1
    for name in ("figure4", "figure4_flights", "figure5", "figure6", "figure7", "figure10", "figure11", "stacked_cost",
                 "ball_cost", "rest", "column", "lossless"):
        for end in (".csv", ".svg", ".png"):
            assert (out / (name + end)).exists(), name + end
