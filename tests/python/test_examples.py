# SPDX-License-Identifier: GPL-3.0-or-later
"""The examples of docs/examples run, agree with theory by their own assertions, and become notebooks."""

import importlib.util
import json
import pathlib
import runpy
import subprocess
import sys
import time

import numpy as np
import pytest

pytest.importorskip("matplotlib")
pytest.importorskip("pandas")
pytest.importorskip("scipy")

import matplotlib.pyplot as plt  # noqa: E402

SOURCE = pathlib.Path(__file__).resolve().parents[2]
EXAMPLES = sorted((SOURCE / "docs/examples").glob("*.py"))
TOOL = SOURCE / "tools/notebooks"


def test_there_are_eleven_examples():
    assert [int(path.name[:2]) for path in EXAMPLES] == list(range(1, 12))


@pytest.mark.parametrize("example", EXAMPLES, ids=lambda path: path.stem)
def test_an_example_runs_and_draws_one_figure(example, tmp_path, monkeypatch):
    shown = []

    def show():
        for number in plt.get_fignums():
            figure = plt.figure(number)
            figure.canvas.draw()
            shown.append((figure, np.asarray(figure.canvas.buffer_rgba())))

    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(plt, "show", show)
    plt.switch_backend("Agg")
    begin = time.monotonic()
    runpy.run_path(str(example), run_name="__main__")
    print(f"{time.monotonic() - begin:.1f} s")
    assert len(shown) == 1
    figure, pixels = shown[0]
    ink = (pixels[:, :, :3] < 200).any(axis=2).mean()
    print(f"{100 * ink:.1f} % of the figure is drawn on")
    assert 0.01 < ink < 0.9
    for axes in figure.axes:
        ticks = "".join(label.get_text() for label in axes.get_xticklabels())
        assert axes.get_ylabel() and (axes.get_xlabel() or "Γ" in ticks or axes.get_label() == "<colorbar>")
    plt.close("all")


@pytest.mark.parametrize("example", EXAMPLES, ids=lambda path: path.stem)
def test_an_example_begins_with_a_question_and_ends_with_its_figure(example):
    text = example.read_text(encoding="utf-8")
    first = text.split("# %%")[1]
    assert first.startswith(" [markdown]\n# # ") and first.count("?**") == 1
    assert text.rstrip().endswith("plt.show()") and "assert " in text
    assert 30 <= len(text.splitlines()) <= 90


def test_notebooks_hold_the_code_of_the_scripts(tmp_path):
    subprocess.run([sys.executable, TOOL, "--into", tmp_path], check=True)
    for example in EXAMPLES:
        made = json.loads((tmp_path / f"{example.stem}.ipynb").read_text(encoding="utf-8"))
        if importlib.util.find_spec("nbformat"):
            import nbformat

            nbformat.validate(made)
        code = ["".join(cell["source"]) for cell in made["cells"] if cell["cell_type"] == "code"]
        assert len(code) >= 3 and all(source in example.read_text(encoding="utf-8") for source in code)
        assert "".join(made["cells"][0]["source"]).startswith("# ")
        compile("\n".join(code), str(example), "exec")


def test_executed_notebooks_hold_text_and_figure(tmp_path):
    subprocess.run([sys.executable, TOOL, "--run", "--into", tmp_path, EXAMPLES[2]], check=True)
    made = json.loads((tmp_path / f"{EXAMPLES[2].stem}.ipynb").read_text(encoding="utf-8"))
    outputs = [output for cell in made["cells"] for output in cell.get("outputs", [])]
    assert [output["output_type"] for output in outputs] == ["stream", "display_data"]
    page = (tmp_path / f"{EXAMPLES[2].stem}.md").read_text(encoding="utf-8")
    assert f"({EXAMPLES[2].stem}.svg)" in page and "<svg" in (tmp_path / f"{EXAMPLES[2].stem}.svg").read_text()
