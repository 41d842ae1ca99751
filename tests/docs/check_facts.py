#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""check_facts.py SOURCE PROGRAM: lists that pages repeat are those of the program, numbers those of the measured pages."""

import pathlib
import re
import subprocess
import sys

SOURCE, PROGRAM = (pathlib.Path(word).resolve() for word in sys.argv[1:3])


def page(name):
    return (SOURCE / name).read_text(encoding="utf-8")


def printed(*words):
    return subprocess.run([PROGRAM, *words], capture_output=True, text=True, check=True).stdout


def wrong_verbs():
    verbs = re.findall(r"^  (\w+) {2,}", printed("help").split("Verbs:")[1].split("\n\n")[0], re.M)
    for name in ("docs/choosing.md", "docs/reference/verbs_in_use.md"):
        yield from (f"{name}: the verb {verb} is missing" for verb in verbs if f"`{verb}`" not in page(name))
    linked = set(re.findall(r"verbs\.md#(\w+)", page("docs/choosing.md")))
    yield from (f"docs/choosing.md: {verb} is no verb" for verb in linked - set(verbs))


def wrong_formats():
    formats = re.findall(r"([a-z-]+): ", re.search(r"--to FORMAT REQUIRED *(.*)", printed("export", "--help")).group(1))
    formats = [name for name in formats if name != "format"]
    if len(formats) < 3:
        yield "export --help: no formats"
    for name in ("docs/choosing.md", "docs/reference/verbs_in_use.md", "lib/python/equidem/case.py"):
        text = page(name).lower().replace(" ", "-").replace("\n", "-")
        yield from (f"{name}: the format {format_} of export is missing" for format_ in formats if format_ not in text)
    if printed("help", "engines").strip() not in page("docs/how_to/engines.md"):
        yield "docs/how_to/engines.md: the table is not that of 'equidem help engines'"


def wrong_index():
    text = page("docs/index.md")
    table, _, lists = text.partition("```{toctree}")
    linked = {re.sub(r"^(\.\./)?(.*)\.\w+$", r"\2", link) for link in re.findall(r"\]\(([^)#]+)\)", table)}
    listed = set(re.findall(r"^[\w/]+$", lists, re.M))
    for folder in re.findall(r"^([\w/]+)/\*$", lists, re.M):
        listed |= {f"{folder}/{path.stem}" for path in (SOURCE / "docs" / folder).glob("*.md")}
    listed = {{"project/contributing": "CONTRIBUTING", "project/changelog": "CHANGELOG"}.get(name, name) for name in listed}
    yield from (f"docs/index.md: {name} is in a table of contents, not in the table" for name in listed - linked)
    yield from (f"docs/index.md: {name} is in the table, in no table of contents" for name in linked - listed
                if not name.startswith("data/benchmarks"))


def totals(name, kind, threads):
    """Seconds in all and MB of each solver, of the table of a page of bench_static."""
    table = re.search(rf"^{kind}\b.*?\n\n(.*?)\n\n", page(name), re.M | re.S).group(1)
    rows = [[cell.strip() for cell in line.split("|")[1:-1]] for line in table.splitlines()]
    columns = {column.partition(",")[0]: k for k, column in enumerate(rows[0])}
    return {row[0]: (float(row[columns["total"]].split()[0]), float(row[columns["peak"]]))
            for row in rows[2:] if row[1] == str(threads)}


def rounds_to(value, shown):
    """Whether a value has the digits that are shown."""
    return f"{value:.{len(shown.partition('.')[2])}f}" == shown


def wrong_numbers():
    speed, readme = page("docs/reference/speed.md"), page("README.md")
    names = ["equidem multifrontal", "equidem multigrid", "CHOLMOD, METIS on the unknowns",
             "CHOLMOD, AMD on the unknowns"]
    million = "data/benchmarks/static_million.md"
    static = "data/benchmarks/static.md"
    for label, name, kind in (("10 000", static, "hexagonal, 10050"), ("100 000", static, "hexagonal, 100014"),
                              ("1 000 000", million, "hexagonal"),
                              ("1 000 000, random (Delaunay)", million, "delaunay")):
        row = re.search(rf"^\| {re.escape(label)} \|(.*)\|$", speed, re.M).group(1).split("|")
        found = totals(name, kind, 2)
        for cell, solver in zip(row, names):
            seconds, _, memory = (word.strip(" GBs") for word in cell.partition(","))
            right = solver in found and rounds_to(found[solver][0], seconds) and (
                not memory or rounds_to(found[solver][1] / 1000, memory))
            if not right and (solver in found or cell.strip() != "not measured"):
                yield f"docs/reference/speed.md: {label}, {solver}: {cell.strip()}, measured {found.get(solver)}"
    found = totals(million, "hexagonal", 2)
    for solver in (*names[:3], "GAMG (PETSc), rigid motions"):
        number = f"{found[solver][0]:.3g} s"
        if number not in readme:
            yield f"README.md: {number} of {solver} is missing"
    yield from wrong_motion(speed, readme)


def wrong_motion(speed, readme):
    """Ratios to LAMMPS by state and cores, of the table of the page of peers; README.md has the first."""
    ratios = {}
    for row in re.findall(r"^\| \d+ \| (settled|flowing)[^|]*\| (\d) \|(.*)\|$", page("data/benchmarks/peers.md"), re.M):
        ratios.setdefault(row[:2], []).append(float(row[2].split("|")[3]))
    for (state, cores), values in ratios.items():
        wanted = f"{min(values):.1f} to {max(values):.1f}"
        for name, text in {"docs/reference/speed.md": speed, **({"README.md": readme} if (state, cores) == ("settled", "1") else {})}.items():
            if wanted not in text.replace("\n", " "):
                yield f"{name}: {state} discs on {cores} cores step {wanted} times as fast as LAMMPS on data/benchmarks/peers.md"


wrong = [*wrong_verbs(), *wrong_formats(), *wrong_index(), *wrong_numbers()]
print("\n".join(wrong) or "lists and numbers of the pages agree")
sys.exit(1 if wrong else 0)
