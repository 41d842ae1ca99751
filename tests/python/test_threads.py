# SPDX-License-Identifier: GPL-3.0-or-later
"""Threads, processes and Ctrl-C."""

import concurrent.futures
import json
import multiprocessing
import signal
import subprocess
import sys
import threading
import time

import numpy as np

import equidem as eq
from scenes import STUDIES, hexagonal, tension

STUDY = str(STUDIES / "integrators.toml")


def test_two_threads_at_once_give_the_answers_of_one():
    cells = [eq.delaunay(discs=2000, radius=1e-3, seed=seed, periodic=True) for seed in range(4)]
    alone = [eq.homogenize(cell, (1e9, 0.5e9)).stiffness for cell in cells]
    found = [None] * len(cells)

    def work(first):
        for k in range(first, len(cells), 2):
            found[k] = eq.homogenize(cells[k], (1e9, 0.5e9)).stiffness

    with concurrent.futures.ThreadPoolExecutor(2) as workers:
        list(workers.map(work, range(2)))
    assert found == alone


def test_results_have_the_same_bits_for_any_number_of_threads():
    block = hexagonal(60, 61)
    results = []
    for count in (1, 2, 3):
        eq.set_threads(count)
        results.append(eq.tension_test(block, (1e9, 0.5e9)).displacements)
    assert np.array_equal(results[0], results[1]) and np.array_equal(results[0], results[2])


def test_a_verb_with_its_own_threads_leaves_those_of_the_user():
    eq.set_threads(2)
    eq.study(STUDY, rounds=3, budget=1)
    tension().solve(threads=1)
    assert eq.threads() == 2


def test_progress_is_shown_only_where_it_is_wanted():
    script = ("import sys, equidem as eq; eq.show_progress(sys.argv[1] == 'shown')\n"
              "eq._core.display_progress_by(lambda line: print(line))\n"
              f"eq.study({STUDY!r}, budget=2, rounds=50)")
    lines = {word: subprocess.run([sys.executable, "-c", script, word], capture_output=True, text=True, check=True)
             for word in ("shown", "hidden")}
    assert "integrators" in lines["shown"].stdout and lines["hidden"].stdout + lines["hidden"].stderr == ""


def test_other_threads_run_during_a_solution():
    block = hexagonal(300, 301)
    ticks, stop = 0, threading.Event()

    def tick():
        nonlocal ticks
        while not stop.is_set():
            ticks += 1
            time.sleep(0.001)

    ticking = threading.Thread(target=tick)
    ticking.start()
    before = ticks
    _core_solution(block)
    during = ticks - before
    stop.set()
    ticking.join()
    print(f"{during} turns of the other thread during the solution")
    assert during > 10


def _core_solution(block):
    """A solution in one call of the compiled part, between whose lines Python cannot change threads."""
    case = eq.Case(assembly=block, springs=(1e9, 0.5e9), test={"kind": "uniaxial_tension"})
    eq._core.run_verb("solve", *case._inputs(), [])


def poisson_ratio():
    return eq.tension_test(hexagonal(61, 61), (1e9, 0.5e9)).poisson_ratio


def test_a_forked_process_computes():
    expected = poisson_ratio()
    context = multiprocessing.get_context("fork")
    queue = context.Queue()
    child = context.Process(target=lambda: queue.put(poisson_ratio()))
    child.start()
    found = queue.get(timeout=60)
    child.join(60)
    assert found == expected and child.exitcode == 0


LONG = """
import equidem as eq, signal
signal.signal(signal.SIGINT, signal.default_int_handler)  # ignored in what a shell runs in the background
cell = eq.delaunay(discs=300, radius=1e-3, seed=1, periodic=True)
simulation = eq.simulation(cell, (1e9, 0.5e9), density=2500.0, run={"duration": 1e4})
print("begun", flush=True)
try:
    simulation.advance(simulation.steps)
except KeyboardInterrupt as error:
    print(type(error).__name__, flush=True)
print(eq.tension_test(eq.hexagonal(columns=7, rows=7, radius=1e-3), (1e9, 0.5e9)).status, flush=True)
try:
    while True:
        pass
except KeyboardInterrupt as error:
    print(type(error).__name__)
"""


def test_ctrl_c_ends_a_long_computation_and_python_goes_on():
    child = subprocess.Popen([sys.executable, "-c", LONG], stdout=subprocess.PIPE, text=True)
    assert child.stdout.readline() == "begun\n"
    time.sleep(0.3)
    child.send_signal(signal.SIGINT)
    assert child.stdout.readline() == "Interrupted\n"
    assert child.stdout.readline() == "solved\n"
    time.sleep(0.1)
    child.send_signal(signal.SIGINT)  # Python has its own handler back
    assert child.stdout.readline() == "KeyboardInterrupt\n"
    assert child.wait(60) == 0


CALIBRATED = """
import equidem as eq, signal, sys
signal.signal(signal.SIGINT, signal.default_int_handler)
cell = eq.delaunay(discs=20000, radius=1e-3, seed=1, periodic=True)
case = eq.Case(assembly=cell, material={"shear_modulus": 1e9, "poisson_ratio": 0.2499, "plane": "strain"})
print("begun", flush=True)
try:
    case.calibrate(out=sys.argv[1])
except KeyboardInterrupt as error:
    print(error)
"""


def test_ctrl_c_leaves_the_springs_found_until_then_in_the_folder(tmp_path):
    for k in range(8):
        out = tmp_path / str(k)
        with subprocess.Popen([sys.executable, "-c", CALIBRATED, str(out)], stdout=subprocess.PIPE, text=True) as child:
            assert child.stdout.readline() == "begun\n"
            time.sleep(0.2 * 2**k)
            child.send_signal(signal.SIGINT)
            sentence = child.communicate(timeout=60)[0]
        assert sentence.startswith("stopped as asked")
        if (out / "result.json").exists():
            break
    result = json.loads((out / "result.json").read_text())
    assert result["status"] == "interrupted" and result["kN"] > 0
    assert result["failure"] == sentence.strip() and "not converged: with the best springs of" in sentence


def test_the_module_is_imported_without_what_only_some_of_it_needs():
    script = "import equidem, sys; print([m for m in ('scipy', 'pandas', 'matplotlib') if m in sys.modules])"
    done = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, check=True)
    assert done.stdout == "[]\n"
