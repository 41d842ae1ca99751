#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""tools/bench/in_python.py PAGE --build FOLDER [--markdown FILE] [options]

Pages of measured times that the Python module of a build makes: assemblies (making them, and their files), homogenize (the
effective stiffness of a cell beside one solution), shapes (a contact of ellipses or clumps beside one of discs), grain_threads
(settled boxes on one thread and on several)."""
import argparse
import math
import random
import resource
import statistics
import sys
import tempfile
import time
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent / "page_parts"))
sys.dont_write_bytecode = True
from common import ROOT, module_of, table  # noqa: E402

GRAVITY, SIZE = 9.81, 0.01  # m/s², m: radius of the largest bodies of a box
BOX_STEP = 1.5e-5  # s
SHAPES = ("discs", "ellipses", "clumps")


def spread(values, form="{:.3f}", factor=1.0):
    low, middle, high = min(values), statistics.median(values), max(values)
    return f"{form.format(factor * middle)} ({form.format(factor * low)} .. {form.format(factor * high)})"


def ratios(values, others):
    return [a / b for a, b in zip(values, others)]


def seconds_of(work):
    begin = time.perf_counter()
    found = work()
    return time.perf_counter() - begin, found


def assemblies(eq, request):
    def make(kind, discs):
        side = round(math.sqrt(discs))
        if kind == "delaunay":
            return eq.delaunay(discs=int(discs), radius=0.005)
        return eq.hexagonal(columns=round(discs / side + 0.5), rows=side, radius=0.005)

    made, files = [], []
    for discs in request.discs:
        for kind in ("hexagonal", "delaunay"):
            times = {1: [], 2: []}
            for _ in range(request.rounds):
                for threads, taken in times.items():
                    eq.set_threads(threads)
                    assembly = None  # its memory is used again
                    elapsed, assembly = seconds_of(lambda: make(kind, discs))
                    taken.append(elapsed)
            peak = 1024 * resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
            made.append([kind, str(len(assembly)), str(len(assembly.contacts)), spread(times[1]), spread(times[2]), f"{peak / len(assembly):.0f}"])
        for name in ["h5"] + ["json"] * (discs <= request.most_json):
            files.append(file_row(eq, assembly, name, request.rounds))
    return ("# Assemblies", "Points, triangulation, contacts, cells and sides of an assembly in memory; the peak is that of the process.\n\n" +
            table(["kind", "discs", "contacts", "one thread, s", "two threads, s", "peak memory, bytes a disc"], made) +
            "Files of Delaunay assemblies, two threads, checks included; plain: the same number of bytes in one piece. Files stay in "
            "the memory of the system.\n\n" +
            table(["format", "discs", "MB", "written, s", "plain written, s", "written, MB/s", "read, s", "plain read, s", "read, MB/s"], files))


def file_row(eq, assembly, name, rounds):
    times = [[], [], [], []]
    with tempfile.TemporaryDirectory() as folder:
        file, plain = Path(folder, f"assembly.{name}"), Path(folder, "plain")
        for k in range(-1, rounds):  # the first use of memory is slow
            found = [seconds_of(lambda: assembly.write(file, overwrite=True))[0]]
            content = file.read_bytes()
            found += [seconds_of(work)[0] for work in (lambda: plain.write_bytes(content), lambda: eq.read(file), plain.read_bytes)]
            for taken, value in zip(times, found):
                taken.extend([value] * (k >= 0))
    megabytes = 1e-6 * len(content)
    write, plainly, read, plain_read = times
    return [name, str(len(assembly)), f"{megabytes:.0f}", spread(write), spread(plainly), f"{megabytes / statistics.median(write):.0f}",
            spread(read), spread(plain_read), f"{megabytes / statistics.median(read):.0f}"]


def homogenize(eq, request):
    rows = []
    for discs in request.discs:
        cell = eq.delaunay(discs=int(discs), radius=0.005, periodic=True)
        for threads in request.threads:
            eq.set_threads(threads)
            one, whole = [], []
            for k in range(-1, request.rounds):  # the first use of memory is slow
                result = eq.homogenize(cell, (1e9, 0.5e9))
                solved = sum(result.times.get(stage, 0) for stage in ("solve", "refine")) / 3
                before = sum(result.times[stage] for stage in ("order", "analyze", "assemble", "factorize"))
                one.extend([before + solved] * (k >= 0))
                stages = sum(seconds for stage, seconds in result.times.items() if stage not in ("assembly", "bounds"))
                whole.extend([stages] * (k >= 0))
            rows.append([str(len(cell)), str(threads), spread(one), spread(whole), spread(ratios(whole, one), "{:.2f}")])
    return ("# Effective stiffness", "A periodic Delaunay cell, kT/kN = 0.5. One solution: order, analyze, assemble, factorize, and a third of the "
            "solution and refinement for three\nmean strains. Effective stiffness: all stages but the bounds beside it, error bound and rigidity included. Seconds, medians "
            "(smallest .. largest).\n\n" +
            table(["discs", "threads", "one solution, s", "effective stiffness, s", "ratio"], rows))


def contact_count(simulation):
    return len(next(iter(simulation.contacts.values())))


def box(width):
    return [{"name": "floor", "point": [0.0, 0.0], "normal": [0.0, 1.0]}, {"name": "left", "point": [0.0, 0.0], "normal": [1.0, 0.0]},
            {"name": "right", "point": [width, 0.0], "normal": [-1.0, 0.0]}]


def falling(aspect, bonded, side, integrator):
    """Bodies with the area of a disc of the radius 0.5 m, above a floor. aspect: 0: discs; -1: pairs of discs; else of ellipses."""
    stiffness, half, draw = 1e5, 0.5 / math.sqrt(2), random.Random(1)
    mass = math.pi / 4 / (2 if bonded else 1)
    step = 0.1 * math.sqrt(mass / stiffness)
    size = {0: 0.5, -1: 2 * half}.get(aspect, 0.5 * math.sqrt(abs(aspect)))
    spacing = 2.05 * size
    bodies, bonds = [], []
    for k in range(side * side):
        angle = draw.uniform(0, 2 * math.pi)
        body = {"position": [(k % side + 0.5) * spacing, (k // side + 0.5) * spacing], "velocity": [draw.uniform(-0.3, 0.3), 0.0], "angle": angle}
        if bonded:
            for sign in (-1, 1):
                bodies.append({**body, "radius": half, "position": [body["position"][0] + sign * half * math.cos(angle),
                                                                    body["position"][1] + sign * half * math.sin(angle)]})
            bonds.append({"grains": [2 * k, 2 * k + 1]})
        elif aspect == -1:
            bodies.append({**body, "discs": [[-half, 0.0, half], [half, 0.0, half]]})
        elif aspect == 0:
            bodies.append({**body, "radius": 0.5})
        else:
            bodies.append({**body, "half_axes": [0.5 * math.sqrt(aspect), 0.5 / math.sqrt(aspect)]})
    tables = {"grains": {"density": 1.0}, "grain": bodies, "wall": box(side * spacing),
              "collisions": {"law": "linear_dashpot", "stiffness": stiffness, "restitution": 0.3, "friction": 0.17, "tangential_ratio": 1 / 3,
                             "tangential_damping": 0.2},
              "run": {"duration": 1e9 * step, "time_step": step, "gravity": [0.0, -1.0], "integrator": integrator}}
    if bonds:
        tables.update(bond=bonds, bonds={"normal_dashpot": 0.5 * mass / step, "tangential_dashpot": 0.5 * mass / step / 3})
    return tables, math.ceil(3 * math.sqrt(side * 2 * size) / step)


def shapes(eq, request):
    cases = [("disc", 0, False), ("ellipse, aspect 1.2", 1.2, False), ("ellipse, aspect 2", 2, False), ("ellipse, aspect 5", 5, False),
             ("ellipse, aspect 20", 20, False), ("rigid pair of discs", -1, False), ("bonded pair of discs", -1, True)]
    named = [(*case, "semi_implicit_euler") for case in cases] + [(*cases[k], "velocity_verlet") for k in (0, -1)]
    simulations, times, steps = [], [[] for _ in named], 500
    for label, aspect, bonded, integrator in named:
        tables, settle = falling(aspect, bonded, request.side, integrator)
        simulations.append(eq.simulation(**tables))
        simulations[-1].advance(settle)
    for k in range(-1, request.rounds):
        for taken, simulation in zip(times, simulations):
            begin = time.thread_time()
            simulation.advance(steps)
            taken.extend([time.thread_time() - begin] * (k >= 0))
    rows, disc, per_disc = [], None, 0
    for (label, aspect, bonded, integrator), simulation, taken in zip(named, simulations, times):
        contacts = contact_count(simulation) / request.side**2
        if aspect == 0:
            disc, per_disc = taken, contacts
        ns = 1e9 / (request.side**2 * steps)
        rows.append([label, integrator, f"{contacts:.2f}", spread(taken, "{:.0f}", ns), spread(ratios(taken, disc), "{:.2f}"),
                     spread(taken, "{:.0f}", ns / contacts), spread(ratios(taken, disc), "{:.2f}", per_disc / contacts)])
    return ("# Shapes", f"{request.side**2} grains of equal area that have fallen into a box under gravity, with friction, tangential springs and "
            "dashpots; the law linear_dashpot. One\nthread, processor time; medians (smallest .. largest) of rounds in which all take "
            "turns. A step contains contacts, near pairs without contact,\nmotion and neighbour lists. Contacts are those at the end; \"over a "
            "disc\" compares with the disc of the same integrator. A bonded pair counts as\none grain: two discs and the dashpots between them.\n\n" +
            table(["shape", "integrator", "contacts per grain", "ns per grain and step", "over a disc", "ns per contact", "over a disc contact"], rows))


def loose(shape, count):
    """Bodies whose bounding circles are of radius 0.5 to 1 cm, in a loose lattice above the floor; the rows of their table."""
    columns, spacing, draw, rows = int(math.sqrt(1.1 * count)), 0.0205, random.Random(7), []
    for k in range(count):
        radius = SIZE * (0.5 + 0.5 * draw.randrange(8) / 7 if shape == "clumps" else draw.uniform(0.5, 1))  # clumps of one size share a shape
        room = SIZE - radius
        x, y = ((place + 0.5) * spacing + draw.uniform(-room, room) for place in (k % columns, k // columns))
        form = {"short_half_axis": 0.7 * radius} if shape == "ellipses" else {}
        if shape == "clumps":
            form = {"discs": f"{-0.3 * radius} 0 {0.7 * radius}; {0.3 * radius} 0 {0.7 * radius}"}
        rows.append({"x": x, "y": y, "radius": radius, "angle": draw.uniform(0, 2 * math.pi), **form})
    return rows, columns * spacing


def box_of_bodies(eq, folder, rows, width):
    file = Path(folder, "grains.csv")
    file.write_text("\n".join([",".join(rows[0]), *(",".join(str(value) for value in row.values()) for row in rows)]) + "\n", encoding="utf-8")
    return eq.simulation(grains={"density": 25.0, "path": str(file)}, wall=box(width),
                         collisions={"law": "linear_dashpot", "stiffness": 1e5, "restitution": 0.4, "friction": 0.3, "tangential_ratio": 0.8,
                                     "tangential_damping": 0.1},
                         run={"duration": 1e9 * BOX_STEP, "time_step": BOX_STEP, "gravity": [0.0, -GRAVITY]})


def grain_threads(eq, request):
    lines = []
    for shape in request.shapes.split(","):
        with tempfile.TemporaryDirectory() as folder:
            eq.set_threads(max(request.threads))
            rows, width = loose(shape, request.box)
            fallen = box_of_bodies(eq, folder, rows, width)
            fallen.advance(int(request.settle / BOX_STEP))
            for row, place, angle in zip(rows, fallen.positions, fallen.angles):
                row.update(x=place[0], y=place[1], angle=angle)
            for boxes in request.boxes:
                beside = [{**row, "x": row["x"] + k * width} for k in range(boxes) for row in rows]
                simulation = box_of_bodies(eq, folder, beside, boxes * width)
                simulation.advance(request.joining)
                steps, times = max(1, int(request.work / len(beside))), {threads: [] for threads in request.threads}
                for k in range(-1, request.rounds):
                    for threads, taken in times.items():
                        eq.set_threads(threads)
                        clock = time.thread_time if threads == 1 else time.perf_counter
                        begin = clock()
                        simulation.advance(steps)
                        taken.extend([clock() - begin] * (k >= 0))
                ns = 1e9 / (len(beside) * steps)
                for threads, taken in times.items():
                    lines.append([shape, str(len(beside)), str(threads), spread(taken, "{:.1f}", ns), f"{1e9 / (ns * statistics.median(taken)):.3g}",
                                  spread(ratios(times[request.threads[0]], taken), "{:.2f}"), f"{contact_count(simulation) / len(beside):.2f}"])
    return ("# Settled grains on several threads",
            "Discs, ellipses of aspect 1.4 and rigid pairs of discs, their bounding circles of radius 0.5 to 1 cm, linear spring and dashpot, friction "
            f"0.3 with a\ntangential spring. {request.box} of them have fallen into a box and come to rest; larger numbers are such boxes side by side "
            f"without the walls between\nthem, at rest at first and stepped {request.joining} times. One thread: processor time; more: wall time; medians "
            f"(smallest .. largest) of {request.rounds} rounds in which all take\nturns. The bits of the motion are those of one thread.\n\n" +
            table(["shape", "grains", "threads", "ns per grain and step", "grain-steps/s", "over the first", "contacts per grain"], lines))


def numbers(kind):
    return lambda text: [kind(float(word)) for word in text.split(",")]


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    pages = parser.add_subparsers(dest="page", required=True)
    for make in (assemblies, homogenize, shapes, grain_threads):
        page = pages.add_parser(make.__name__)
        page.set_defaults(make=make)
        page.add_argument("--build", type=Path, required=True, help="build folder of the module")
        page.add_argument("--markdown", type=Path, help="file of the page")
        page.add_argument("--rounds", type=int, default=5, help="in which all take turns; default %(default)s")
        if make is assemblies:
            page.add_argument("--discs", type=numbers(int), default=[100_000, 1_000_000], help="sizes, ascending")
            page.add_argument("--most-json", type=float, default=1e6, help="largest size that is written as JSON")
        elif make is homogenize:
            page.add_argument("--discs", type=numbers(int), default=[10_000, 100_000])
            page.add_argument("--threads", type=numbers(int), default=[1, 2])
        elif make is shapes:
            page.add_argument("--side", type=int, default=32, help="grains in a row, and rows")
        else:
            page.add_argument("--shapes", default=",".join(SHAPES))
            page.add_argument("--box", type=int, default=20000, help="grains that settle")
            page.add_argument("--boxes", type=numbers(int), default=[1, 50], help="numbers of such boxes side by side")
            page.add_argument("--threads", type=numbers(int), default=[1, 2])
            page.add_argument("--work", type=float, default=4e7, help="grains times steps in each measurement")
            page.add_argument("--settle", type=float, default=1.9, help="time for a box to fall and come to rest, s")
            page.add_argument("--joining", type=int, default=500, help="steps before the first measurement")
    request = parser.parse_args()
    eq = module_of(request.build)
    eq.show_progress(False)
    title, text = request.make(eq, request)
    found = eq.study(ROOT / "data" / "studies" / "integrators.toml", budget=1, rounds=3).machine
    command = " ".join(["tools/bench/in_python.py", *(word for word in sys.argv[1:])])
    page = (f"{title}\n\n    {command}\n\n{found.processor}, {found.cores} cores; equidem {found.version}, {found.build}, compiler "
            f"{found.compiler}.\n\n{text}").rstrip() + "\n"
    if request.markdown:
        request.markdown.write_text(page, encoding="utf-8")
    print(page)


if __name__ == "__main__":
    main()
