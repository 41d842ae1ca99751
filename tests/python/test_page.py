# SPDX-License-Identifier: GPL-3.0-or-later
"""Results are saved as the page that the program writes."""

import pathlib
import pickle

import pytest

import equidem as eq

CASES = pathlib.Path(__file__).resolve().parents[2] / "data/cases"
BLOCK = eq.hexagonal(columns=7, rows=7, radius=1e-3)
CELL = eq.hexagonal(columns=4, rows=4, radius=1e-3, periodic=True)
SPRINGS = eq.Springs(kN=1e9, kT=0.5e9)


def result_of(verb):
    if verb == "solve":
        return eq.tension_test(BLOCK, SPRINGS)
    if verb == "homogenize":
        return eq.homogenize(CELL, SPRINGS)
    if verb == "stability":
        return eq.stability(CELL, SPRINGS)
    if verb == "calibrate":
        return eq.calibrate(CELL, young_modulus=1e9, poisson_ratio=0.1)
    if verb == "pack":
        return eq.pack({"grains": 30, "box": [0.1, 0.1], "radii": {"smallest": 4e-3, "largest": 6e-3},
                        "method": "growth", "overlap": 1e-3, "sides": "periodic"}, (1e8, 0.5e8))
    if verb == "quasistatic":
        return eq.Case(CASES / "notched_plate.toml").quasistatic()
    return eq.run(BLOCK, SPRINGS, density=2000.0, loads=[{"group": "right", "force": (1.0, 0.0)}],
                  run={"duration": 1e-4})


@pytest.mark.parametrize("verb", ["solve", "homogenize", "stability", "calibrate", "pack", "run", "quasistatic"])
def test_a_result_is_saved_as_a_page(verb, tmp_path):
    result = result_of(verb)
    page = tmp_path / "page.html"
    result.save_page(page)
    text = page.read_text(encoding="utf-8")
    assert text.startswith("<!DOCTYPE html>") and "http" not in text and len(text) < 2e6
    assert f"equidem {verb}" in text and str(tmp_path) not in text
    numbers = {"solve": "poisson_ratio", "stability": "critical_ratio", "calibrate": "kN", "pack": "solid_fraction"}
    if number := numbers.get(verb):
        assert f'<data value="{result[number]!r}"' in text
    assert "<figure>" in text or verb == "calibrate"
    assert "What was asked" in text and "#" not in text.split('id="case"')[1].split("</details>")[0]
    with pytest.raises(eq.BadInput, match="exists"):
        result.save_page(page)
    result.save_page(page, overwrite=True)


def without_report(page):
    return page.read_text(encoding="utf-8").split('<section id="report"')[0]


def test_the_page_is_that_of_the_folder(tmp_path):
    result = eq.Case(assembly={"kind": "hexagonal", "columns": 5, "rows": 5, "radius": 1e-3}, springs=SPRINGS,
                     test={"kind": "uniaxial_tension", "stress": 1e6}).solve(out=tmp_path / "out")
    result.save_page(tmp_path / "page.html")
    assert without_report(tmp_path / "page.html") == without_report(tmp_path / "out" / "index.html")


def test_the_page_of_a_path_is_that_of_the_folder(tmp_path):
    result = eq.Case(CASES / "notched_plate.toml").quasistatic(out=tmp_path / "out")
    result.save_page(tmp_path / "page.html")
    text = without_report(tmp_path / "page.html")
    assert text == without_report(tmp_path / "out" / "index.html") and text.count("<figure>") == 2


def test_the_page_of_bodies_with_probes_has_their_paths(tmp_path):
    case = eq.Case(CASES / "grains_piston.toml").set("run.duration", 0.1).set("probe.0.quantities", ["position"])
    case.run().save_page(tmp_path / "page.html")
    assert (tmp_path / "page.html").read_text(encoding="utf-8").count("<figure>") >= 3


def test_the_page_is_that_of_the_case_as_it_was(tmp_path):
    case = eq.Case(assembly=BLOCK, springs=SPRINGS, test={"kind": "uniaxial_tension", "stress": 1e6})
    result = case.solve()
    case.set("springs.kT", 0.0)
    result.save_page(tmp_path / "page.html")
    assert f'value="{result.poisson_ratio!r}"' in (tmp_path / "page.html").read_text(encoding="utf-8")


def test_a_part_of_a_result_has_no_page(tmp_path):
    with pytest.raises(eq.BadInput, match="no page"):
        result_of("solve").plane_strain.save_page(tmp_path / "page.html")
    with pytest.raises(eq.BadInput, match="no page"):
        pickle.loads(pickle.dumps(result_of("solve"))).save_page(tmp_path / "page.html")
