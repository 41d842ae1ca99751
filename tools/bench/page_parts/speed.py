# SPDX-License-Identifier: GPL-3.0-or-later
"""How fast: the tables and figures of docs/reference/speed.md, from the tables of data/benchmarks."""
from tables import rows_of, write_rows

SOLVERS = {"equidem multifrontal": "elimination", "equidem multigrid": "multigrid", "CHOLMOD, METIS on the unknowns": "CHOLMOD, METIS",
           "CHOLMOD, AMD on the unknowns": "CHOLMOD, AMD", "GAMG (PETSc), rigid motions": "GAMG of PETSc"}
THREADS = "2"


def first(cell):
    """The median of "median (smallest .. largest)"."""
    return float(cell.split()[0])


def solves(folder):
    """(assembly, discs) -> solver -> seconds and MB, on two threads."""
    found = {}
    for row in [row for name in ("static/solvers", "static_million/solvers", "static_million/stored_peers") for row in rows_of(folder / f"{name}.csv")]:
        if row["threads"] == THREADS and row["solver"] in SOLVERS:
            found.setdefault((row["assembly"], int(row["discs"])), {})[SOLVERS[row["solver"]]] = (first(row["total, s"]), float(row["peak, MB"]))
    return found


def shown(taken, discs):
    if not taken:
        return "-"
    seconds, megabytes = taken
    return f"{seconds:.3g} s" + (f", {megabytes / 1000:.2g} GB" if discs > 5e5 else "")


def draw(folder):
    import figures

    found = solves(folder)
    write_rows(folder / "solves.csv", ["assembly", "discs", *SOLVERS.values()], [
        [kind, f"{round(discs, -len(str(discs)) + 2):,}".replace(",", " "), *(shown(taken.get(name), discs) for name in SOLVERS.values())]
        for (kind, discs), taken in sorted(found.items(), key=lambda item: (item[0][0] != "hexagonal", item[0][1]))])
    series = {}
    for (kind, discs), taken in found.items():
        for name, (seconds, _) in taken.items() if kind == "hexagonal" else ():
            series.setdefault(name, []).append((discs, seconds))
    figures.curves(folder / "solves", series, "discs of a hexagonal lattice", "time of one solution, s")
    ratios, boxes = {}, {}
    for row in rows_of(folder / "peers" / "the_same_box.csv"):
        state = row["state"].partition(",")[0]
        ratios.setdefault((state, row["cores"]), []).append((float(row["equidem over LAMMPS"]), row["over YADE"]))
        for name, column in (("equidem", "equidem"), ("LAMMPS", "LAMMPS, best skin"), ("YADE", "YADE")):
            if row[column]:
                cores = "one core" if row["cores"] == "1" else "two cores"
                boxes.setdefault(f"{row['discs']} discs, {state}, {cores}", []).append((name, 1e-6 * first(row[column])))
    write_rows(folder / "steps.csv", ["discs", "cores", "faster than LAMMPS by", "than YADE by"], [
        [state, cores, f"{min(a for a, _ in values):.1f} to {max(a for a, _ in values):.1f}",
         f"{values[0][1]} to {values[-1][1]}" if values[0][1] else "-"] for (state, cores), values in ratios.items()])
    figures.bars(folder / "steps", boxes, "million steps of a disc per second", by_name=True)
    loops = {}
    for row in rows_of(folder / "dynamic" / "beside_plain_loops.csv"):
        if row["assembly"] == "hexagonal" and row["loop"] in ("plain, over neighbours", "equidem"):
            name = "bonded, plain loop" if row["loop"] != "equidem" else f"bonded, {row['threads']} thread{'s' * (row['threads'] != '1')}"
            loops.setdefault(f"{int(row['discs']):,} discs".replace(",", " "), []).append((name, 1e-6 * first(row["disc-steps/s"])))
    for row in rows_of(folder / "grains" / "the_loop_of_colliding_discs.csv"):
        discs = f"{int(row['discs']):,} discs that collide".replace(",", " ")
        loops.setdefault(discs, []).append((row["state"], 1e-6 * first(row["disc-steps/s"])))
    figures.bars(folder / "loops", loops, "million steps of a disc per second")
