# SPDX-License-Identifier: GPL-3.0-or-later
"""The page data/accuracy.md: studies of data/studies, and results that are stored in the page itself."""
import json
import os
import statistics
import time

from common import ROOT, Failure, machine, plots_of, seconds, table, tables_of

# Study files of the page, in its order: heading and task of the first table; no task: no row there.
STUDIES = {
    "integrators": ("A bonded disc that vibrates", "elastic energy of a vibrating disc"),
    "abe_lattice": ("Abe's tension test", "ν from a block in tension"),
    "random_cells": ("Random cells", "G of random cells of 50 discs over kN, standard error"),
    "settled_void_ratio": ("Void ratio of discs that fell", ""),
}
ASKED = ("1e-2", "1e-3", "1e-4", "1e-8")
STORED = "stored"  # mark of a row of the first table, and begin of a section, that was measured by an earlier commit
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
settings, plots and CSV by `equidem study data/studies/NAME.toml --out DIR`. Its times are medians over rounds, each with all settings in
random order. What is called stored was measured once, by the commit that its section names.

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


def cheapest_ways(name, result):
    """Rows of the first table: the cheapest setting for each accuracy; one that serves for several, once."""
    done = [row for row in result["settings"] if "refusal" not in row and row["seconds"]["repetitions"]]
    chosen = {}
    for asked in ASKED:
        sufficient = [row for row in done if worst(row) is not None and worst(row) <= float(asked)]
        if sufficient:
            chosen[label(min(sufficient, key=lambda row: row["seconds"]["median"]))] = asked
    by_label = {label(row): row for row in done}
    return [[STUDIES[name][1], asked, way, f"{worst(by_label[way], 'errors'):.1e}", seconds(by_label[way]["seconds"]["median"]),
             f"`equidem study data/studies/{name}.toml --accuracy {asked}`"] for way, asked in chosen.items()]


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
        spread = f" ± {curve['uncertainty']:.2g}" if curve["uncertainty"] is not None else ""
        rows.append([curve["method"], curve["quantity"], f"{curve['observed_order']:.3f}{spread}", f"{curve['theoretical_order']:g}",
                     "agrees" if curve["agrees"] else "differs"])
    return table(["", "error of", "order measured", "theory", ""], rows) if rows else ""


def front(result):
    """The settings than which none is both faster and as accurate."""
    by_label = {label(row): row for row in result["settings"]}
    rows = [[setting, seconds(by_label[setting]["seconds"]["median"]), f"{by_label[setting]['errors'][each['quantity']]:.2g}"]
            for each in result["fronts"] for setting in each["settings"]]
    return table(["fastest settings of their accuracy", "time", "error"], rows) if rows else ""


def section(run, name, result):
    text = f"## {STUDIES[name][0]}\n\n{result['title']}. `equidem study data/studies/{name}.toml`\n\n"
    for plot in plots_of(result, run.folder):
        text += f"![{STUDIES[name][0]}]({run.keep_plot(name, plot, name)})\n\n"
    told = orders(result)
    remarks = [result["advice"]] * bool(told and result["advice"]) + result["notes"]
    return text + told + front(result) + "".join(f"- {remark.strip()}\n" for remark in remarks) + "\n" * bool(remarks)


def stored(page):
    """Rows of the first table, and sections, of the present page that no study file makes."""
    first, *sections = page.split("\n## ")
    rows = [row for row in tables_of(first)[0] if row[-1] == STORED]
    kept = [f"## {text.rstrip()}\n\n" for text in sections if text.split("\n\n")[1].lower().startswith(STORED)
            and text.splitlines()[0] not in [heading for heading, _ in STUDIES.values()]]
    return rows, kept


def page(run):
    results = {name: run.study(name) for name in STUDIES}
    rows = [row for name, result in results.items() if STUDIES[name][1] for row in cheapest_ways(name, result)]
    verbs = verb_rows(run)
    stored_rows, stored_sections = stored((ROOT / "data" / "accuracy.md").read_text(encoding="utf-8"))
    summary = table(["task", "accuracy", "cheapest way", "error", "time", "command"], [*rows, *stored_rows, cell_row(run), *verbs])
    text = TEXT.format(command=run.command(), machine=machine(results["integrators"]), summary=summary, verbs=len(verbs),
                       requests=requests(run))
    sections = [section(run, name, result) for name, result in results.items()]
    return (text + "".join(sections + stored_sections)).rstrip() + "\n"
