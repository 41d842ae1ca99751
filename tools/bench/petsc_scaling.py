#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""tools/bench/petsc_scaling.py --build FOLDER [--discs N,...] [--largest N] [--repetitions N] [--markdown FILE]

The page data/petsc.md: equidem-mpi on one rank and on two, strong and weak scaling, memory and messages by formula and
counted, GAMG beside the multigrid of equidem on one, two and four ranks, and what a billion discs on a thousand ranks need by
these constants. Sizes that the free memory does not bear, and runs that fail, are left out with a sentence that says why."""

import argparse
import json
import math
import os
import resource
import subprocess
import sys
import tempfile
from pathlib import Path

CASE = """schema = "equidem/1"
[assembly]
{assembly}
radius = 0.005
[springs]
kN = 1.0e9
kT = 0.5e9
[test]
kind = "uniaxial_tension"
stress = 1.0e6
gauge = "quarter"
"""
ASSEMBLIES = {"hexagonal": 'kind = "hexagonal"\ncolumns = {columns}\nrows = {rows}', "random": 'kind = "delaunay"\ndiscs = {discs}'}
# Of a network that a cluster has; assumed, not measured.
LATENCY, BANDWIDTH = 2e-6, 10e9  # s, B/s
SQRT3 = math.sqrt(3)
LARGE = 4e5  # discs
# B: what a disc takes at the peak, which the first large run replaces by what it measured.
MEMORY_OF_DISC = 4500


def shape(discs):
    """Columns and rows of a block about as high as wide."""
    columns = max(8, round(math.sqrt(discs * SQRT3 / 2)))
    return columns, max(8, round(discs / columns))


def processor_seconds():
    usage = resource.getrusage(resource.RUSAGE_CHILDREN)
    return usage.ru_utime + usage.ru_stime


def free_memory():
    for line in Path("/proc/meminfo").read_text(encoding="utf-8").splitlines():
        if line.startswith("MemAvailable:"):
            return 1024 * int(line.split()[1])
    return math.inf


def refusal(discs, of_a_disc):
    """A sentence where so many discs, on any number of ranks of this machine, need more than its free memory; else None."""
    margin = 1.1
    needed, free = margin * discs * of_a_disc, free_memory()
    if needed <= free:
        return None
    return (f"{discs:.0e} discs were left out: they need about {si(needed)} ({of_a_disc:.0f} B a disc at the peak, a tenth more), and "
            f"{si(free)} of memory are free. Give smaller --discs, or run this on a larger machine.")


class Failed(Exception):
    """A run that ended with an error."""


def reason(errors):
    """The sentence of equidem-mpi, else that of mpirun, else the last words."""
    lines = [line.strip() for line in errors.splitlines() if line.strip(" -")]
    for word in ("equidem-mpi:", "mpirun noticed"):
        for line in lines:
            if word in line:
                return line.removeprefix("equidem-mpi: ")
    return lines[-1] if lines else "it wrote nothing"


def run(build, folder, discs, ranks, kind="gamg", assembly="hexagonal"):
    columns, rows = shape(discs)
    case, out = folder / "block.toml", folder / "result.json"
    made = ASSEMBLIES[assembly].format(columns=columns, rows=rows, discs=discs)
    case.write_text(CASE.format(assembly=made), encoding="utf-8")
    environment = dict(os.environ, OMP_NUM_THREADS="1", OPENBLAS_NUM_THREADS="1", OMPI_ALLOW_RUN_AS_ROOT="1",
                       OMPI_ALLOW_RUN_AS_ROOT_CONFIRM="1", OMPI_MCA_rmaps_base_oversubscribe="1",
                       PRTE_MCA_rmaps_default_mapping_policy=":oversubscribe")  # Open MPI 4 and 5
    used = processor_seconds()
    done = subprocess.run(["mpirun", "-n", str(ranks), build / "tools" / "equidem-mpi", "solve", case, "--quiet", "--overwrite",
                           "--json", out, "-equidem_pc_type", kind], env=environment, check=False, stdout=subprocess.DEVNULL,
                          stderr=subprocess.PIPE, text=True)
    if done.returncode != 0:
        raise Failed(f"{discs:.0e} discs were left out: the run on {ranks} ranks with {kind} ended with exit code "
                     f"{done.returncode}: {reason(done.stderr)}")
    result = json.loads(out.read_text(encoding="utf-8"))
    used = processor_seconds() - used
    times = result["times"]
    return {"discs": result["discs"], "ranks": ranks, "columns": columns, "rows": rows, "iterations": result["iterations"],
            "passes": result["refinements"] + 1, "before": times["assembly"] + times["assemble"], "set_up": times["set up"],
            "solve": times["solve"], "all": sum(times.values()), "peak": result["peak_bytes"],
            "owned": result["discs_of_a_rank"], "ghosts": result["ghosts_of_a_rank"], "exchange": result["exchange_bytes"],
            "messages": result["messages"], "bytes": result["message_bytes"], "sums": result["sums_over_ranks"],
            "residual": result["relative_residual"], "processor": used}


def least(build, folder, jobs, repetitions, base):
    """The fastest of several runs of each job (discs, ranks, preconditioner, assembly), which take turns; large ones, and those of which
    only counts are told (more than two ranks), run once.
    And the sentences on those left out."""
    best, left_out, of_a_disc = {}, {}, MEMORY_OF_DISC
    for _ in range(repetitions):
        for job in sorted(jobs):
            if job[0] in left_out or (job in best and (job[0] >= LARGE or job[1] > 2)):
                continue
            sentence = refusal(job[0], of_a_disc)
            if sentence:
                left_out[job[0]] = sentence
                print(sentence, file=sys.stderr)
                continue
            try:
                one = run(build, folder, *job)
            except Failed as failed:  # such as killed for memory that others took meanwhile
                left_out[job[0]] = str(failed)
                print(failed, file=sys.stderr)
                continue
            if one["discs"] >= LARGE / 4:
                of_a_disc = max(of_a_disc, (one["peak"] - base) / one["owned"])
            if job not in best or one["all"] < best[job]["all"]:
                best[job] = one
            print(f"{one['discs']} discs, {job[3]}, {one['ranks']} ranks, {job[2]}: {one['all']:.1f} s", file=sys.stderr)
    return best, list(left_out.values())


def grid(columns, rows, ranks):
    """Blocks side by side and one above the other, as equidem-mpi cuts a hexagonal block."""
    pairs = [(a, ranks // a) for a in range(1, ranks + 1) if ranks % a == 0]
    return min(pairs, key=lambda p: (p[0] - 1) * rows * SQRT3 / 2 + (p[1] - 1) * columns)


def exchange_by_formula(columns, rows, ranks):
    """Bytes that the block with most neighbours sends for one value of each unknown: its left column and its lowest row are
    mirrored and, where it has a block on its right too, every other disc of the right column."""
    across, along = grid(columns, rows, ranks)
    wide, high = columns / across, rows / along
    left = high if across > 1 else 0
    right = high / 2 if across > 2 else 0
    lowest = wide if along > 1 else 0
    return 8 * 3 * (left + right + lowest)


def si(number, unit="B"):
    for size, prefix in ((1e12, "T"), (1e9, "G"), (1e6, "M"), (1e3, "k")):
        if number >= size:
            return f"{number / size:.3g} {prefix}{unit}"
    return f"{number:.3g} {unit}"


def faster(one, more):
    """By processor time: that of several ranks holds their waiting."""
    return more["ranks"] * one["processor"] / more["processor"]


def table(lines, head, rows):
    lines.append("| " + " | ".join(head) + " |")
    lines.append("|" + "---|" * len(head))
    lines.extend("| " + " | ".join(row) + " |" for row in rows)
    lines.append("")


def base_memory(build, folder):
    return run(build, folder, 100, 1)["peak"]


def number_of(discs):
    return f"{discs:,}".replace(",", " ")


def strong(sizes, largest, best, base):
    rows = []
    for discs in sizes:
        one, two = best[(discs, 1, "gamg", "hexagonal")], best[(discs, 2, "gamg", "hexagonal")]
        rows += [(one, "1.00"), (two, f"{faster(one, two):.2f}")]
    if (largest, 2, "gamg", "hexagonal") in best:
        rows.append((best[(largest, 2, "gamg", "hexagonal")], "one rank was not run"))
    return [[number_of(r["discs"]), str(r["ranks"]), f"{r['set_up']:.2f}", f"{r['solve']:.2f}", f"{r['all']:.2f}", f"{r['processor']:.1f}",
             ratio, str(r["iterations"]), f"{r['residual']:.0e}", si(r["peak"]), f"{(r['peak'] - base) / r['owned']:.0f}"] for r, ratio in rows]


def weak(sizes, best):
    rows = []
    for discs in sizes:
        one, two = (best.get((ranks * discs, ranks, "gamg", "hexagonal")) for ranks in (1, 2))
        if one and two:
            rows.append([f"{discs:.0e}", f"{one['processor']:.1f}", f"{two['processor']:.1f}",
                         f"{2 * one['processor'] / two['processor']:.2f}", str(two["iterations"])])
    return rows


def counts(best):
    """Rows of iterations and messages, of the smallest block of each assembly."""
    rows = []
    for assembly, name in (("hexagonal", "hexagonal"), ("random", "random triangulation")):
        found = [job for job in sorted(best) if job[3] == assembly]
        rows += [[f"{number_of(best[job]['discs'])} discs, {name}", str(job[1]), str(best[job]["iterations"]), str(best[job]["messages"]),
                  si(best[job]["bytes"]), str(best[job]["sums"])] for job in found if job[0] == found[0][0]]
    return rows


def page(command, built, sizes, largest, best, cuts, base, left_out):
    lines = ["# Statics on PETSc: measured, and planned past it", "",
             f"`{command}` writes this page. {os.cpu_count()} processors, load {os.getloadavg()[0]:.1f} at the end; equidem-mpi was "
             f"built {built}. Where others work on the machine, times by the clock scatter, and say little; processor times say "
             "more: those of two ranks hold their waiting for each other, so that ratios of them are what is surely kept. Memory, "
             "iterations and messages do not depend on the load.", "",
             "The tension test of blocks, conjugate gradients, each pass to 1e-8, two passes to the digits of a "
             "double. Memory and messages are those of the rank with most.", "",
             "## Strong scaling", "", "Hexagonal blocks, with GAMG.", ""]
    table(lines, ["discs", "ranks", "set up, s", "solve, s", "all, s", "processors, s", "faster by at least", "iterations", "residual", "memory of a rank",
                  f"of it for a disc, B (beyond {si(base)})"], strong(sizes, largest, best, base))
    one = best[(max(sizes), 1, "gamg", "hexagonal")]
    planned = largest or 4e6
    lines += [f"By the last column of one rank {planned:.0e} discs take {si(base + planned * (one['peak'] - base) / one['owned'])}. The peak is that "
              "of the assembly of the matrix: its coordinates, places and a copy."]
    if (largest, 2, "gamg", "hexagonal") in best:
        lines[-1] += f" Two ranks took at most {si(2 * best[(largest, 2, 'gamg', 'hexagonal')]['peak'])} together."
    lines += [""]
    lines += [text for sentence in left_out for text in (sentence, "")]
    lines += ["## Weak scaling", "", "Twice the discs on two ranks take twice the processor time of one where nothing is lost.", ""]
    table(lines, ["discs of a rank", "one rank: processor, s", "two ranks: processors, s", "share kept, at least", "iterations on two"],
          weak(sizes, best))
    lines += ["## Iterations", ""]
    lines += ["Iterations and messages do not depend on the compiler or on what else the machine does.", ""]
    table(lines, ["assembly", "ranks", "iterations", "messages of the rank with most", "bytes of it", "sums over ranks"], counts(best))
    lines += ["## Messages", "",
              "A rank has a block of w columns and h rows. It sends 8 B for each component of the discs that others mirror: the left "
              "column, the lowest row, and every other disc of the right column, which upper left contacts reach: "
              "24 (h + w + h/2) B where it has neighbours on all sides.", ""]
    rows = [[number_of(r["discs"]), str(r["ranks"]), si(exchange_by_formula(r["columns"], r["rows"], r["ranks"])),
             si(r["exchange"]), str(r["messages"]), si(r["bytes"]), str(r["sums"]),
             f"{r['messages'] / r['iterations']:.1f}", f"{r['sums'] / r['iterations']:.1f}"] for r in cuts]
    table(lines, ["discs", "ranks", "one exchange by formula", "counted", "messages in all", "bytes in all", "sums over ranks",
                  "messages of an iteration", "sums of an iteration"], rows)
    lines += plan(sizes, best, cuts, base)
    return "\n".join(lines)


def plan(sizes, best, cuts, base):
    runs = [best[(discs, ranks, "gamg", "hexagonal")] for discs in sizes for ranks in (1, 2) if 4 * discs >= max(sizes)]
    large = max(sizes)
    memory = [(r["peak"] - base) / r["owned"] for r in runs]
    # Of one rank, less what others took of its processor.
    alone = [(r, min(1, r["processor"] / r["all"]) / r["discs"]) for r in runs if r["ranks"] == 1]
    set_up = [(r["before"] + r["set_up"]) * share for r, share in alone]
    step = [r["solve"] * share / r["iterations"] for r, share in alone]
    small, big = (best[(discs, 1, "gamg", "hexagonal")] for discs in (min(sizes), large))
    decades = math.log10(big["discs"] / small["discs"])
    growth = (big["iterations"] - small["iterations"]) / decades if decades > 0 else 0
    discs, ranks = 1e9, 1000
    own = discs / ranks
    few = big["iterations"]
    many = max(few, big["iterations"] + 2 * growth * math.log10(discs / big["discs"]), 1.5 * few)
    columns, rows = shape(discs)
    exchange = exchange_by_formula(columns, rows, ranks)
    inner = cuts[-1]  # nine blocks: the middle one has neighbours on all sides
    per_iteration = inner["messages"] / inner["iterations"]
    volume = inner["bytes"] / inner["exchange"] / inner["iterations"]
    sums = max(r["sums"] / r["iterations"] for r in cuts)
    deeper = 2  # more grids than those of the blocks that were counted

    def wire(iterations, grids):
        return iterations * (grids * per_iteration * LATENCY + volume * exchange / BANDWIDTH
                             + sums * LATENCY * math.log2(ranks))

    low = own * (min(set_up) + few * min(step)) + wire(few, 1)
    high = own * (max(set_up) + many * max(step)) + wire(many, deeper)
    wide = 1.35  # indices of 8 B in place of 4: entries of 16 B in place of 12, and their lists
    return ["## A billion discs on a thousand ranks", "",
            "Constants of the larger blocks above; the smallest and the largest one measured span the range.", "",
            "| quantity | value | from |", "|---|---|---|",
            f"| discs of a rank | {own:.0e}, and {exchange / 24:.0f} that neighbours mirror | 1e9/1000; formula above |",
            f"| memory of a rank | {si(base + own * wide * min(memory))} to {si(base + own * wide * max(memory))} | "
            f"{min(memory):.0f} to {max(memory):.0f} B a disc, times {wide} for indices of 64 bits, which 3e9 unknowns need |",
            f"| memory in all | {si(ranks * own * wide * max(memory))} | 1000 ranks |",
            f"| iterations, both passes | {few} to {many:.0f} | {growth:+.1f} for ten times as many discs measured; twice that, or half "
            "as many more, at most |",
            f"| one exchange | {si(exchange)} to send, up to 6 neighbours | formula |",
            f"| messages of a rank | {per_iteration * few:.0f} to {deeper * per_iteration * many:.0f} | {per_iteration:.0f} an "
            f"iteration counted on nine ranks, all grids together; up to {deeper} times as many for more grids |",
            f"| sums over ranks | {sums * few:.0f} to {sums * many:.0f} | {sums:.1f} an iteration counted |",
            f"| messages take | {wire(few, 1):.2f} to {wire(many, deeper):.2f} s | {LATENCY * 1e6:.0f} µs and {BANDWIDTH / 1e9:.0f} GB/s assumed, "
            "a sum over ranks log2(1000) latencies |",
            f"| time | {low:.0f} to {high:.0f} s | {min(set_up) * 1e6:.1f} to {max(set_up) * 1e6:.1f} µs a disc before the iterations, "
            f"{min(step) * 1e6:.2f} to {max(step) * 1e6:.2f} µs a disc and iteration |", "",
            "What is not in these numbers: coarse grids of GAMG have fewer unknowns than ranks and are gathered on some of them, which "
            "costs time beyond a hundred ranks that two cannot show; the cores of a node share its memory, so that a full node is "
            "slower than two cores by up to its share of bandwidth. The time may be three times as long for either reason. A PETSc of "
            "64-bit indices is needed from 7.2e8 discs on (Debian: petsc64-dev); with one of 32 bits equidem-mpi refuses. The files "
            "for ParaView have 260 B for a disc: 260 GB, in 2000 pieces.", ""]


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--build", type=Path, required=True, help="a build folder with equidem-mpi")
    parser.add_argument("--discs", default="1e5,2e5,5e5,1e6", help="sizes of blocks; default %(default)s")
    parser.add_argument("--largest", help="one more size, on two ranks alone")
    parser.add_argument("--repetitions", type=int, default=3)
    parser.add_argument("--markdown", type=Path, help="the page; left out: stdout")
    request = parser.parse_args()
    sizes = sorted(int(float(word)) for word in request.discs.split(","))
    largest = int(float(request.largest)) if request.largest else None
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        build = request.build.resolve()
        base = base_memory(build, folder)
        jobs = {(discs, ranks, "gamg", "hexagonal") for discs in sizes for ranks in (1, 2)}
        jobs |= {(2 * discs, 2, "gamg", "hexagonal") for discs in sizes if 2 * discs <= max(sizes)}
        jobs |= {(min(sizes), ranks, "gamg", "hexagonal") for ranks in (4, 9)}
        jobs |= {(min(sizes), ranks, "gamg", "random") for ranks in (1, 2, 4)}
        if largest:
            jobs.add((largest, 2, "gamg", "hexagonal"))
        best, left_out = least(build, folder, jobs, request.repetitions, base)
    sizes = [discs for discs in sizes if all((discs, ranks, "gamg", "hexagonal") in best for ranks in (1, 2))]
    few = [(sizes[0], ranks, "gamg", "hexagonal") for ranks in (4, 9)] if sizes else []
    if not sizes or not all(job in best for job in few):
        sys.exit("There is no page without the smallest block on 1, 2, 4 and 9 ranks.")
    cuts = [best[(discs, 2, "gamg", "hexagonal")] for discs in sizes] + [best[job] for job in few]
    about = subprocess.run([build / "tools" / "equidem-mpi", "--version"], capture_output=True, text=True, check=True).stdout
    built = about.splitlines()[1].partition(", compiler")[0] + f" (preset {build.name})"
    further = f"--largest {request.largest} " if largest else ""
    command = f"tools/bench/petsc_scaling.py --build build/{build.name} --discs {request.discs} {further}--markdown data/petsc.md"
    text = page(command, built, sizes, largest, best, cuts, base, left_out)
    if request.markdown:
        request.markdown.write_text(text, encoding="utf-8")
    else:
        print(text)


if __name__ == "__main__":
    main()
