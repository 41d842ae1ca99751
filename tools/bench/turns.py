#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""tools/bench/turns.py OLD NEW [options]

Times of a step of colliding bodies by the Python modules of two builds that take turns, scene by scene: bodies of several shapes,
fallen into a box and at rest there, driven walls, bonds, a sheared cell. Prints a table, and writes it to a page."""
import argparse
import math
import statistics
import subprocess
import sys
import time
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent / "page_parts"))
sys.dont_write_bytecode = True
from common import module_of, table  # noqa: E402
from in_python import falling, spread  # noqa: E402


def box(aspect, integrator, bonded=False, **tables):
    def make(side):
        scene, settle = falling(aspect, bonded, side, integrator)
        for key, value in tables.items():
            scene[key] = {**scene.get(key, {}), **value}
        return scene, settle
    return make


def shaken(side):
    scene, settle = falling(0, False, side, "velocity_verlet")
    period = 50 * scene["run"]["time_step"]
    scene["shaking"] = {"direction": [1.0, 0.0], "acceleration": 0.5, "frequency": 1 / period}
    return scene, settle


def lattice(side, spacing):
    return [[(k % side + 0.5 * (k // side % 2)) * spacing, (k // side + 0.5) * spacing * math.sqrt(3) / 2] for k in range(side * side)]


def block(breaking):
    """A hexagonal block of bonded discs that falls on a floor: it stays whole, or it breaks."""
    def make(side):
        radius, density, stiffness = 0.5, 1.0, 1e5
        places = [[x, y + 0.1] for x, y in lattice(side, 2 * radius)]
        bonds = [{"grains": [a, b]} for a in range(side * side) for b in (a + 1, a + side, a + side + 1, a + side - 1)
                 if b < side * side and math.dist(places[a], places[b]) < 2.01 * radius]
        step = 0.05 * math.sqrt(density * math.pi * radius**2 / stiffness)
        scene = {"grains": {"density": density}, "grain": [{"position": place, "radius": radius} for place in places], "bond": bonds,
                 "bonds": {"normal_spring": stiffness, "tangential_spring": 0.4 * stiffness, "bending_spring": stiffness * radius**2 / 3},
                 "strength": {"tension": 60.0 if breaking else 1e9, "shear": 120.0 if breaking else 1e9, "weibull_modulus": 4.0},
                 "wall": [{"name": "floor", "point": [0.0, 0.0], "normal": [0.0, 1.0]}],
                 "collisions": {"law": "linear_dashpot", "stiffness": stiffness, "restitution": 0.3, "friction": 0.3, "tangential_ratio": 0.4},
                 "run": {"duration": 1e9 * step, "time_step": step, "gravity": [0.0, -1.0], "integrator": "velocity_verlet"}}
        return scene, 0
    return make


def sheared(spacing):
    def make(side):
        scene, _ = falling(0, False, side, "velocity_verlet")
        width = side * spacing
        for body, place in zip(scene["grain"], lattice(side, spacing)):
            body["position"] = place
        del scene["wall"]
        del scene["run"]["gravity"]
        scene["cell"] = {"periodic": "xy", "width": width, "height": width * math.sqrt(3) / 2, "motion": {"xx": -0.02, "yy": -0.02, "xy": 0.2}}
        return scene, 500
    return make


EULER, VERLET = "semi_implicit_euler", "velocity_verlet"
SCENES = {"discs, Euler": box(0, EULER), "discs, Verlet": box(0, VERLET), "discs, Euler, no friction": box(0, EULER, collisions={"friction": 0.0}),
          "ellipses of aspect 2, Euler": box(2, EULER), "ellipses of aspect 2, Verlet": box(2, VERLET), "ellipses of aspect 20, Euler": box(20, EULER),
          "clumps of two discs, Euler": box(-1, EULER), "clumps of two discs, Verlet": box(-1, VERLET), "pairs tied by dashpots, Euler": box(-1, EULER, True),
          "pairs tied by dashpots, Verlet": box(-1, VERLET, True), "shaken box, Verlet": shaken, "bonded block, Verlet": block(False),
          "bonded block that breaks, Verlet": block(True), "sheared cell, Verlet": sheared(1.05), "sheared cell full of contacts, Verlet": sheared(0.998)}


class Builds:
    """A build as a process of its own, which makes a scene and then steps it as often as it is asked to."""

    def __init__(self, build, request):
        command = [sys.executable, __file__, "--worker", build, build, "--side", str(request.side), "--steps", str(request.steps),
                   "--threads", str(request.threads)]
        self.process = subprocess.Popen(list(map(str, command)), stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True)

    def __call__(self, word):
        self.process.stdin.write(word + "\n")
        self.process.stdin.flush()
        answer = self.process.stdout.readline()
        if not answer:
            sys.exit(f"{word}: the build ended")
        return float(answer)


def work(request):
    eq = module_of(request.old)
    eq.show_progress(False)
    eq.set_threads(request.threads)
    clock = time.thread_time if request.threads == 1 else time.perf_counter
    simulation = None
    for line in sys.stdin:
        word = line.strip()
        if word in SCENES:
            tables, settle = SCENES[word](request.side)
            simulation = eq.simulation(**tables)
            simulation.advance(settle)
        begin = clock()
        if word == "step":
            simulation.advance(request.steps)
        print(clock() - begin, flush=True)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("old", type=Path, help="build folder of a module")
    parser.add_argument("new", type=Path, help="build folder of another")
    parser.add_argument("--worker", action="store_true", help=argparse.SUPPRESS)
    parser.add_argument("--side", type=int, default=32, help="bodies in a row, and rows")
    parser.add_argument("--steps", type=int, default=500, help="of a turn")
    parser.add_argument("--threads", type=int, default=1, help="one: times of the processor; more: times of the clock")
    parser.add_argument("--rounds", type=int, default=7)
    parser.add_argument("--scenes", default="", help="part of their names")
    parser.add_argument("--markdown", type=Path, help="file of the page")
    request = parser.parse_args()
    if request.worker:
        return work(request)
    builds, rows = [Builds(build, request) for build in (request.old, request.new)], []
    for name in SCENES:
        if request.scenes not in name:
            continue
        times = [[], []]
        for build in builds:
            build(name)
        for k in range(-1, request.rounds):
            for taken, build in zip(times, builds):
                taken.extend([build("step")] * (k >= 0))
        ns = 1e9 / (request.side**2 * request.steps)
        rows.append([name, spread(times[0], "{:.1f}", ns), spread(times[1], "{:.1f}", ns),
                     f"{statistics.median(times[0]) / statistics.median(times[1]):.2f}"])
        print(*rows[-1], sep=" | ", flush=True)
    command = " ".join(["tools/bench/turns.py", *(word for word in sys.argv[1:])])
    clock = "One thread, processor time" if request.threads == 1 else f"{request.threads} threads, time of the clock"
    page = (f"# Two builds in turns\n\n    {command}\n\n{request.side**2} bodies of equal area, linear spring and dashpot, friction with a tangential "
            f"spring. {clock} of a body and step\nin ns, medians (smallest .. largest) of rounds in which both take turns.\n\n" +
            table(["scene", "old", "new", "old/new"], rows))
    if request.markdown:
        request.markdown.write_text(page, encoding="utf-8")
    print(page)
    return None


if __name__ == "__main__":
    main()
