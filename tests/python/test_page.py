# SPDX-License-Identifier: GPL-3.0-or-later
"""Results are saved as the page that the program writes."""

import pickle

import pytest

import equidem as eq
from scenes import BLOCK, CASES, CELL, PULLED, SPRINGS, tension

NOTCH = eq.Case(CASES / "notched_plate.toml")
# Of each verb a result, and a number that its page shows.
VERBS = {
    "solve": (lambda: eq.tension_test(BLOCK, SPRINGS), "poisson_ratio"),
    "homogenize": (lambda: eq.homogenize(CELL, SPRINGS), None),
    "stability": (lambda: eq.stability(CELL, SPRINGS), "critical_ratio"),
    "calibrate": (lambda: eq.calibrate(CELL, young_modulus=1e9, poisson_ratio=0.1), "kN"),
    "pack": (lambda: eq.pack({"grains": 30, "box": [0.1, 0.1], "radii": {"smallest": 4e-3, "largest": 6e-3}, "method": "growth",
                              "overlap": 1e-3, "sides": "periodic"}, (1e8, 0.5e8)), "solid_fraction"),
    "run": (lambda: eq.run(BLOCK, SPRINGS, density=2000.0, loads=[{"group": "right", "force": (1.0, 0.0)}],
                           run={"duration": 1e-4}), None),
    "quasistatic": (NOTCH.quasistatic, None),
}


@pytest.mark.parametrize("verb", VERBS)
def test_a_result_is_saved_as_a_page(verb, tmp_path):
    compute, number = VERBS[verb]
    result, page = compute(), tmp_path / "page.html"
    result.save_page(page)
    text = page.read_text(encoding="utf-8")
    assert text.startswith("<!DOCTYPE html>") and "http" not in text and len(text) < 2e6
    assert f"equidem {verb}" in text and str(tmp_path) not in text
    assert number is None or f'<data value="{result[number]!r}"' in text
    assert "<figure>" in text or verb == "calibrate"
    assert "What was asked" in text and "#" not in text.split('id="case"')[1].split("</details>")[0]
    with pytest.raises(eq.BadInput, match="exists"):
        result.save_page(page)
    result.save_page(page, overwrite=True)


def without_report(page):
    return page.read_text(encoding="utf-8").split('<section id="report"')[0]


@pytest.mark.parametrize(("solve", "figures"), [
    (eq.Case(assembly={"kind": "hexagonal", "columns": 5, "rows": 5, "radius": 1e-3}, springs=SPRINGS, test=PULLED).solve, 1),
    (NOTCH.quasistatic, 2)])
def test_the_page_is_that_of_the_folder(solve, figures, tmp_path):
    solve(out=tmp_path / "out").save_page(tmp_path / "page.html")
    text = without_report(tmp_path / "page.html")
    assert text == without_report(tmp_path / "out" / "index.html") and text.count("<figure>") >= figures


def test_the_page_of_bodies_with_probes_has_their_paths(tmp_path):
    case = eq.Case(CASES / "grains_piston.toml").set("run.duration", 0.1).set("probe.0.quantities", ["position"])
    case.run().save_page(tmp_path / "page.html")
    assert (tmp_path / "page.html").read_text(encoding="utf-8").count("<figure>") >= 3


def test_the_page_is_that_of_the_case_as_it_was(tmp_path):
    case = tension()
    result = case.solve()
    case.set("springs.kT", 0.0)
    result.save_page(tmp_path / "page.html")
    assert f'value="{result.poisson_ratio!r}"' in (tmp_path / "page.html").read_text(encoding="utf-8")


def test_a_part_of_a_result_has_no_page(tmp_path):
    result = tension().solve()
    for part in (result.plane_strain, pickle.loads(pickle.dumps(result))):
        with pytest.raises(eq.BadInput, match="no page"):
            part.save_page(tmp_path / "page.html")
