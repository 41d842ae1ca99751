# SPDX-License-Identifier: GPL-3.0-or-later
"""The page data/effects.md."""
from common import machine, plots_of, table, tables_of

TEXT = """# Cost of effects

A scene pays for the effects that it has. Written by

    {command}

from `equidem study effects`, `equidem study effects_statics`, `bench_dynamic --absent` and `bench_collisions --absent`, on
{machine}.

## The report

`run` lists the effects that a scene has, and why it lacks the others; the loop is chosen by them before the first step.
`equidem {case}` prints, among other things:

```
{report}
```

## In motion

{title}, {pieces:,.0f} disc-steps of each scene per timing, {rounds} rounds, median of the processor time of one thread. Each scene is the
one above it with one more effect. A scene with "or" has its effect in place of the last one with "+", and is compared with the one
before that; the next scene does without it. *evaluations* are those of a contact, per disc and step; bonds are not among them.

"""

AFTER = """C is the linear spring and dashpot, P the energy map of Fujioka & Ushijima (2005), which is for discs alone and for collisions of pairs.
From normal contacts to friction with tangential springs, dashpots and rotation it is {factor:.0f} % more here (law C). For comparison,
published: on a P100 tangential forces with history cost up to 38.1 % more than normal forces alone, torques up to 3.8 % more (Vilnius
Gediminas Technical University, *Performance evaluation of various DEM models on GPU*); those scenes are three-dimensional.

Contacts of law C are computed several at a time, with tangential springs and with friction that always slides (no tangential spring).
Ellipses and clumps have loops of their own beside that of the discs. The contacts of maps are computed one by one. Torques come with
the tangential springs; a scene without them has no rotations at all, in memory or in time.

Walls that move, are shaken or follow a stress, their histories and a case of one stage are beside the loop over contacts: they add
some per cent at most, which is the noise. Where a stage begins, the scene is checked, sorted and searched for neighbours as at the
start of a run: as long as {begin:.0f} steps of this scene take; with a body removed, {removed:.0f}. Cells that deform (shear as
Lees and Edwards) count the stress in every step, and a row of their history sorts all contacts. Bonds are computed
eight at a time, in the loop that is compiled for the springs, the dashpots and the strengths that a scene has; strengths are compared
with the forces where these are found. Dashpots are solved exactly, one group of bonds after the other. A network in which nothing collides or breaks is stepped
faster as bonded discs, in finite motion too (the first table).

## What is off costs nothing

Each loop beside one that is written by hand for its scene alone, without anything that a scene may switch on, with the same layout of
memory and the same vectors: 1.00 means that effects which the scene lacks take no time.

{bonded}The loops by hand for colliding discs lack also what every run of such bodies has: the search for neighbours, the ledger of energies,
walls that may move. A packed bed, which lacks what the tables above add, beside a loop that knows its pairs beforehand:

{bed}Free flight, where nothing else is left to do, beside `v += g dt; x += v dt`:

{flight}"""


def report_of(run, case):
    """The block of effects in the report of a command."""
    lines = run.call([run.program, *case.split()]).splitlines()
    begin = next(k for k, line in enumerate(lines) if line.startswith("effects"))
    end = next(k for k in range(begin + 1, len(lines)) if not lines[k].startswith(" "))
    return "\n".join(lines[begin:end])


def nanoseconds(result, row):
    return 1e9 * row["seconds"]["processor_median"] / result["pieces"]


def scenes(result, problem):
    """Name, row, ns and the ns that it is compared with. A scene with "or" is no base of others."""
    chain, found = [], []
    for row in result["settings"]:
        if row["problem"] != problem or "refusal" in row:
            continue
        ns, alternative = nanoseconds(result, row), row["method"].startswith("or ")
        base = None if not chain else chain[-2] if alternative and len(chain) > 1 else chain[-1]
        found.append((row["method"], row, ns, base))
        if not alternative:
            chain.append(ns)
    return found


def steps_between(result, ns, longer):
    """What a longer time of a disc-step is in steps, summed over all of a timing."""
    return (longer / ns - 1) * result["pieces"] / float(result["title"].split()[0])


def chain_table(result, problem):
    rows, plain = [], None
    for name, row, ns, base in scenes(result, problem):
        plain = plain or ns
        values = row["values"]
        rows.append([name, f"{values['unknowns']:.0f}", f"{values['bytes_per_disc']:.0f}", f"{values['evaluations']:.2g}", f"{ns:.1f}",
                     "" if base is None else f"{round(100 * (ns / base - 1)):+d} %", f"{ns / plain:.2f}"])
    return table(["scene", "unknowns per disc", "bytes per disc", "evaluations", "ns per disc-step", "added by the effect",
                  "over the plain scene"], rows)


def statics(run):
    result = run.study("effects_statics")
    plot = run.keep_plot("effects_statics", plots_of(result, run.folder)[0], "effects_statics")
    rows, plain = [], None
    for row in result["settings"]:
        if "refusal" in row:
            continue
        ns, values = nanoseconds(result, row), row["values"]
        plain = plain or ns
        entries = f"{values['factor_entries']:.0f}" if values["factor_entries"] else "none: multigrid"
        rows.append([row["method"], f"{values['unknowns']:.3g}", entries, f"{values['factor_bytes']:.0f}",
                     f"{1e-3 * ns:.3g}", f"{ns / plain:.2f}", f"{values['residual']:.0e}"])
    return (f"## At rest\n\n{result['title']}: processor time of the whole answer, which holds checks, ordering, factorization, solution and "
            f"refinement; one thread, {result['rounds']} rounds.\n\n![Time of a solution]({plot})\n\n" +
            table(["scene", "unknowns per disc", "entries of the factor per disc", "bytes of the solver per disc", "µs per disc",
                   "over the plain scene", "relative residual"], rows))


def absent(run, name, *options):
    text = run.call([run.beside("bench", f"bench_{name}"), "--absent", "--rounds", 3 if run.options.quick else 9, *options])
    return [table(rows[0], rows[1:]) for rows in tables_of(text)]


def page(run):
    result = run.study("effects")
    case = "run data/cases/run_pulse.toml --dry-run"
    text = TEXT.format(command=run.command(), machine=machine(result), case=case, report=report_of(run, case), title=result["title"],
                       pieces=result["pieces"], rounds=result["rounds"])
    problems = list(dict.fromkeys(row["problem"] for row in result["settings"]))
    names = {"bonded discs": "effects_bonded", "on a floor": "effects", "law P": "effects_law_P", "in a box": "effects_box",
             "cell": "effects_cell", "bonded": "effects_bonds"}
    for problem, plot in zip(problems, plots_of(result, run.folder)):
        name = next(name for word, name in names.items() if word in problem)
        text += f"### {problem}\n\n![Time of {problem}]({run.keep_plot('effects', plot, name)})\n\n" + chain_table(result, problem)
    law_c = {name: ns for problem in problems if "on a floor" in problem for name, _, ns, _ in scenes(result, problem)}
    factor = law_c["+ tangential dashpots"] / next(iter(law_c.values()))
    box = {name: ns for problem in problems if "pressed" in problem for name, _, ns, _ in scenes(result, problem)}
    begin, removed = (steps_between(result, box["+ one stage"], box[name]) for name in ("+ a second stage", "+ a body removed where it begins"))
    text += statics(run)
    (bonded,), (flight, bed) = absent(run, "dynamic", "--kinds", "hexagonal"), absent(run, "collisions")
    return (text + AFTER.format(factor=100 * (factor - 1), begin=begin, removed=removed, bonded=bonded, bed=bed, flight=flight)).rstrip() + "\n"
