# SPDX-License-Identifier: GPL-3.0-or-later
"""The page data/accuracy.md."""
import json
import os
import statistics
import time

from common import ROOT, Failure, machine, plots_of, seconds, table, tables_of

# Studies of the page, in its order: heading, task of the first table, and the plots that are shown (by number).
STUDIES = {
    "integrators": ("A wave in a bonded lattice", "motion of a wave", [0]),
    "abe_lattice": ("Abe's tension test", "ν and G from a block in tension", [0]),
    "random_assembly": ("Random cells", "ν and G of random assemblies, standard error", [0, 1]),
    "solvers": ("Which solver, from which size on", "displacements at rest", [-1]),
    "collision_laws": ("Laws of collision", "rigid bodies, after a collision", [0, 1]),
    "ellipse_contact": ("Contact of ellipses", "normal and overlap of 1000 pairs of ellipses", [0]),
    "settled_void_ratio": ("Void ratio of discs that fell", "", [0]),
    "neighbour_margin": ("Margin of the neighbour lists", "", [0]),
}
ASKED = ("1e-2", "1e-3", "1e-4", "1e-8")
COMPARED = (1e-6, 1e-12)  # errors to which solvers are compared over sizes, as the study has them
# Commands with --accuracy: what is computed, command, repetitions.
VERBS = [
    ("K, G and ν of random cells", "homogenize data/cases/random_cell.toml --accuracy 1e-2"),
    ("ν and G of a lattice from a block in tension", "solve data/cases/abe1996_fig6.toml --accuracy 1e-3"),
    ("motion of bonded discs", "run data/cases/run_pulse.toml --accuracy 1e-2"),
]

TEXT = """# Cost of accuracy

Error against time, measured; written by

    {command}

Times are medians on one thread, on {machine}.

{summary}*error* is the measured one; of the periodic cell the bound that is printed, and of the last {verbs} rows, which choose their setting
themselves, the estimate, with 95 % confidence. Times of these rows are those of the whole command. A study is repeated with all its
settings, plots and CSV by `equidem study NAME --out DIR`. Its times are medians over rounds, each with all settings in random order.

## What is asked for is kept

Where a verb has a setting to choose, `--accuracy X` chooses it: `equidem homogenize` size and number of random cells, `equidem solve`
the size of the block of a tension test, `equidem run` the time step of bonded discs. Tests make random requests, whose true error is known:

{requests}*cheap* settings cost at most twice the cheapest sufficient one. Pilot computations are not counted there; the report states their cost:
two to five runs for a time step, thousands of discs for random cells, and little compared with a large block.

"""


def label(row):
    values = ", ".join(f"{key} = {value:.6g}" for key, value in row["setting"].items())
    return ", ".join(part for part in (row["method"], values) if part)


def worst(row, kind="assured_errors"):
    """The largest of the errors of a row; none where it has none."""
    errors = [error for error in row[kind].values() if error is not None]
    return max(errors) if errors else None


def cheapest_ways(run, name, result):
    """Rows of the first table: of each problem the cheapest setting for each accuracy; one that serves for several, once."""
    rows = []
    for problem in dict.fromkeys(row["problem"] for row in result["settings"]):
        done = [row for row in result["settings"] if row["problem"] == problem and "refusal" not in row and row["seconds"]["repetitions"]]
        chosen = {}
        for asked in ASKED:
            sufficient = [row for row in done if worst(row) is not None and worst(row) <= float(asked)]
            if sufficient:
                chosen[label(min(sufficient, key=lambda row: row["seconds"]["median"]))] = asked
        by_label = {label(row): row for row in done}
        for way, asked in chosen.items():
            row = by_label[way]
            task = ": ".join(part for part in (STUDIES[name][1], problem) if part)
            rows.append([task, asked, way, f"{worst(row, 'errors'):.1e}", seconds(row["seconds"]["median"]),
                         f"`{' '.join(['equidem study', name, *run.size_of(name), '--accuracy', asked])}`"])
    return rows


def timed(run, command):
    """JSON of a command, and its median time with all that it does."""
    target = run.folder / "verb.json"
    times = []
    for _ in range(3):
        begin = time.monotonic()
        run.call([run.program, *command.split(), "--quiet", "--threads", "1", "--json", target, "--overwrite"])
        times.append(time.monotonic() - begin)
    return json.loads(target.read_text(encoding="utf-8")), seconds(statistics.median(times))


def cell_row(run):
    """A lattice has a cell without sides: exact to round-off, with the bound that the program states."""
    command = "homogenize data/cases/hexagonal_cell.toml"
    result, taken = timed(run, command)
    bound = result["error_bound"] / max(max(map(abs, row)) for row in result["stiffness"])
    return ["K, G and ν of a lattice", "round-off", f"a periodic cell of {result['discs']} discs", f"{bound:.1e}", taken,
            f"`equidem {command}`"]


def verb_rows(run):
    rows = []
    for task, command in VERBS:
        result, taken = timed(run, command)
        reached = result["accuracy"]
        way = ", ".join(f"{key} = {value:.6g}" for key, value in reached["value"].items())
        rows.append([task, command.split()[-1], way, f"{reached['estimated']:.1e}", taken,
                     f"`equidem {command}`"])
    return rows


def requests(run):
    """Rates of kept requests: from the tests of the same build, else those that an earlier run has kept."""
    kept = run.kept / "requests.json"
    tests = run.program.parents[1] / "tests"
    if (tests / "test_study").exists() and (tests / "test_homogenize").exists():
        target = run.folder / "requests"
        for program in ("test_study", "test_homogenize"):
            run.call([tests / program, "accuracy_asked*,what_is_recommended*"], env={**os.environ, "EQUIDEM_REQUESTS": str(target)})
        got = [json.loads(line) for line in target.read_text(encoding="utf-8").splitlines()]
        kept.write_text(json.dumps(got, indent=1, ensure_ascii=False) + "\n", encoding="utf-8")
    if not kept.exists():
        raise Failure(f"neither '{tests}' has the tests that make requests, nor does '{kept}' keep their rates")

    def share(row, key):
        return f"{100 * row[key] / row['requests']:.1f} %" if key in row else ""

    rows = [[row["task"], str(row["requests"]), share(row, "kept"), share(row, "honest"), share(row, "cheap")]
            for row in json.loads(kept.read_text(encoding="utf-8"))]
    return table(["request", "number", "within what was asked", "within what was estimated", "cheap"], rows)


def orders(result):
    rows = []
    for curve in result["orders"]:
        if curve["observed_order"] is None or curve.get("theoretical_order") is None:
            continue
        who = ", ".join(part for part in (curve["problem"], curve["method"]) if part)
        spread = f" ± {curve['uncertainty']:.2g}" if curve["uncertainty"] is not None else ""
        rows.append([who, curve["quantity"], f"{curve['observed_order']:.3f}{spread}", f"{curve['theoretical_order']:g}",
                     ("" if curve["agrees"] else "differs: ") + curve.get("why", "")])
    return table(["", "error of", "order measured", "theory", "because"], rows) if rows else ""


def fronts(result):
    """The settings than which none is both faster and as accurate."""
    text = ""
    for front in result["fronts"]:
        rows = [row for row in result["settings"] if row["problem"] == front["problem"]]
        by_label = {label(row): row for row in rows}
        lines = [[setting, seconds(by_label[setting]["seconds"]["median"]), f"{by_label[setting]['errors'][front['quantity']]:.2g}"]
                 for setting in front["settings"] if by_label[setting]["errors"].get(front["quantity"]) is not None]
        if lines:
            title = ": ".join(part for part in (front["problem"], front["quantity"]) if part)
            text += f"{title}\n\n" + table(["fastest settings of their accuracy", "time", "error"], lines)
    return text


def all_settings(result):
    """Every setting with its facts and errors."""
    quantities = result["quantities"]
    head = ["setting", "time"] + [q["label"] for q in quantities]
    rows = []
    for row in result["settings"]:
        if "refusal" in row:
            rows.append([label(row), "refused"] + [""] * len(quantities))
            continue
        cells = [row["values"][q["name"]] if q["fact"] else row["errors"].get(q["name"]) for q in quantities]
        rows.append([label(row), seconds(row["seconds"]["median"])] + ["" if cell is None else f"{cell:.4g}" for cell in cells])
    return table(head, rows)


def cheapest_of_methods(result, wanted):
    """Problem -> method -> the row of the cheapest setting that reaches an error."""
    found = {}
    for row in result["settings"]:
        if "refusal" in row or not row["seconds"]["repetitions"] or worst(row) > wanted:
            continue
        best = found.setdefault(row["problem"], {}).setdefault(row["method"], row)
        if row["seconds"]["median"] < best["seconds"]["median"]:
            found[row["problem"]][row["method"]] = row
    return found


def fastest_of(cheapest):
    return min(cheapest, key=lambda method: cheapest[method]["seconds"]["median"])


def by_size(result, wanted):
    """Time and memory of the cheapest setting of each method that reaches an error, against the size."""
    methods = list(dict.fromkeys(row["method"] for row in result["settings"]))

    def cell(problem, cheapest, method):
        if method not in cheapest:
            tried = [row for row in result["settings"] if row["problem"] == problem and row["method"] == method]
            return "refused" if any("refusal" in row for row in tried) else "not reached" if tried else "not tried"
        row = cheapest[method]
        memory = row["values"]["memory"]
        text = seconds(row["seconds"]["median"]) + (f", {memory:.3g} MB" if memory is not None else "")
        return f"**{text}**" if method == fastest_of(cheapest) else text

    rows = [[problem, *(cell(problem, cheapest, method) for method in methods)]
            for problem, cheapest in cheapest_of_methods(result, wanted).items()]
    return f"Error of at most {wanted:g}:\n\n" + table(["", *methods], rows)


def sizes(run, result):
    text, fastest = "", set()
    for number, wanted in enumerate(COMPARED):
        plot = f"solvers_time_to_{wanted:g}".replace("-", "_")
        text += f"![Time to an error of {wanted:g} against size]({run.keep_plot('solvers', plot, f'solvers_by_size_{number + 1}')})\n\n"
        text += by_size(result, wanted)
        fastest |= {fastest_of(cheapest) for cheapest in cheapest_of_methods(result, wanted).values()}
    never = [method for method in dict.fromkeys(row["method"] for row in result["settings"]) if method not in fastest]
    return text + (
        "Time, and the peak of memory beyond that of the block, of the cheapest setting of each solver that reaches the error; one "
        "thread; in bold\nthe fastest. The error is the distance from a direct solution that is refined with residuals in twice the "
        f"digits, not a residual.\nNever the fastest here: {', '.join(never) or 'none'}.\n\n"
        "`method = \"auto\"` takes multigrid from 2e4 discs on, where it is estimated to be faster; below, it would save milliseconds, "
        "and elimination\nnames mechanisms. Elimination wins where kT < 0, where springs differ by many orders of magnitude, near "
        "mechanisms ([hard cases](hard_cases.md))\nand on strips a few discs wide; refined, it also has the last digit. For tens of "
        "loads on the same supports both take about as long. CHOLMOD and\nUMFPACK serve as independent checks. GAMG of PETSc and BoomerAMG of hypre, which run on "
        "many machines, solve the same matrices in [static solves](benchmarks/static.md).\n\n")


def largest_blocks(result):
    """All solvers on the two largest blocks."""
    text = ""
    for problem in list(dict.fromkeys(row["problem"] for row in result["settings"]))[-2:]:
        done = [row for row in result["settings"] if row["problem"] == problem and "refusal" not in row]
        fastest = min(row["seconds"]["median"] for row in done)
        rows = [[label(row), seconds(row["seconds"]["median"]), f"{row['seconds']['median'] / fastest:.1f}",
                 f"{row['errors']['displacements']:.1e}", f"{row['values']['memory'] or 0:.3g} MB"] for row in done]
        text += f"All solvers, {problem}:\n\n" + table(["solver", "time", "over the fastest", "error of displacements", "memory"], rows)
    return text


def others():
    """Lines of data/benchmarks/peers.md on the same tasks."""
    text = (ROOT / "data" / "benchmarks" / "peers.md").read_text(encoding="utf-8")
    same = [part for part in text.split("\n## ") if part.startswith("The same answer")]
    if not same:
        return ""
    discs = same[0].split("bonded lattice of ")[1].split(" ")[0]
    rows = {row[0].split(",")[0]: row for row in reversed(tables_of(same[0])[0][1:])}  # of equidem the first, one thread
    own, yade = rows["equidem"], rows["YADE"]
    said = (f"Other programs on such tasks, from [side by side](benchmarks/peers.md). The displacements of {discs} discs in tension by "
            f"damped motion, one thread: YADE, with the best damping, takes {yade[1].replace(' to ', ' s to ')} "
            f"({own[3]} and {own[4]} times as long as equidem, which takes {own[1].split(' (')[0]} s to {own[2]}).\n\n")
    for part in text.split("\n## "):
        if not part.startswith("The same matrix"):
            continue
        rows = tables_of(part)[0]
        said += f"The same matrix of {part.splitlines()[0].replace('The same matrix: ', '')}:\n\n" + table(rows[0], rows[1:])
    return said


def section(run, name, result):
    heading, _, shown = STUDIES[name]
    text = f"## {heading}\n\n{result['title']}. `equidem study {name}`\n\n"
    if name == "solvers":
        text += sizes(run, result)
    plots = plots_of(result, run.folder)
    for number, plot in enumerate(plots[at] for at in shown if -len(plots) <= at < len(plots)):
        text += f"![{heading}]({run.keep_plot(name, plot, name + (f'_{number + 1}' if number else ''))})\n\n"
    text += orders(result)
    text += all_settings(result) if name in ("settled_void_ratio", "neighbour_margin") else fronts(result)
    if name == "solvers":
        text += largest_blocks(result) + others()
    without_order = all(curve["observed_order"] is None or curve.get("theoretical_order") is None for curve in result["orders"])
    remarks = ([] if without_order else result["advice"]) + result["notes"]
    return text + "".join(f"- {remark.strip()}\n" for remark in remarks) + "\n" * bool(remarks)


def page(run):
    results = {name: run.study(name) for name in STUDIES}
    rows = [row for name, result in results.items() if STUDIES[name][1] for row in cheapest_ways(run, name, result)]
    verbs = verb_rows(run)
    summary = table(["task", "accuracy", "cheapest way", "error", "time", "command"], [*rows, cell_row(run), *verbs])
    text = TEXT.format(command=run.command(), machine=machine(results["integrators"]), summary=summary, verbs=len(verbs),
                       requests=requests(run))
    return text + "".join(section(run, name, result) for name, result in results.items()).rstrip() + "\n"
