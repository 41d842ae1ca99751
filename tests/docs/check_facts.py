#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""check_facts.py SOURCE PROGRAM: lists that pages repeat are those of the program, numbers those of the measured pages."""

import pathlib
import re
import subprocess
import sys

SOURCE, PROGRAM = (pathlib.Path(word).resolve() for word in sys.argv[1:3])
sys.path.insert(0, str(SOURCE / "docs/site"))
sys.dont_write_bytecode = True

import tables  # noqa: E402



def page(name):
    return (SOURCE / name).read_text(encoding="utf-8")


def printed(*words):
    return subprocess.run([PROGRAM, *words], capture_output=True, text=True, check=True).stdout


def wrong_verbs():
    """docs/choosing.md names every verb, and no table, key or name of the module that does not exist."""
    text = page("docs/choosing.md")
    verbs = re.findall(r"^  (\w+) {2,}", printed("help").split("Verbs:")[1].split("\n\n")[0], re.M)
    yield from (f"docs/choosing.md: the verb {verb} is missing" for verb in verbs if f"`{verb}`" not in text)
    linked = set(re.findall(r"verbs\.md#(\w+)", text))
    yield from (f"docs/choosing.md: {verb} is no verb" for verb in linked - set(verbs))
    keys, table = set(), ""
    for line in printed("help", "case", "--markdown").split("\n"):
        if heading := re.match(r"### `\[+([\w.]+)\]+`", line):
            table = heading.group(1)
            keys.add(table)
        elif key := re.match(r"\| `(\w+)` \|", line):
            keys.add(f"{table}.{key.group(1)}")
    named = {word for _, word in re.findall(r"`(\[+)([a-z_]+)\]+`", text)} | set(re.findall(r"`([a-z_]+\.[a-z_]+)(?= = |`)", text))
    named -= {word for word in named if word.startswith(("eq.", "result.")) or word.endswith(".toml")}
    yield from (f"docs/choosing.md: {name} is no table or key of a case" for name in named - keys)
    module = (SOURCE / "docs/reference/python.md").read_text(encoding="utf-8")
    yield from (f"docs/choosing.md: eq.{name} is not in the module" for name in set(re.findall(r"`eq\.(\w+)`", text))
                if not re.search(rf":: (equidem\.)?{name}$", module, re.M))


def wrong_formats():
    formats = re.findall(r"([a-z-]+): ", re.search(r"--to FORMAT REQUIRED *(.*)", printed("export", "--help")).group(1))
    formats = [name for name in formats if name != "format"]
    if len(formats) < 3:
        yield "export --help: no formats"
    for name in ("docs/choosing.md", "lib/python/equidem/case.py"):
        text = page(name).lower().replace(" ", "-").replace("\n", "-")
        yield from (f"{name}: the format {format_} of export is missing" for format_ in formats if format_ not in text)
    if printed("help", "engines").strip() not in page("docs/how_to/engines.md"):
        yield "docs/how_to/engines.md: the table is not that of 'equidem help engines'"


def missing_rooms():
    """docs/reference/cpp.rst has a heading for every folder of the library."""
    rooms = re.findall(r"^  (\w+) +# ", page("lib/CMakeLists.txt"), re.M)
    headings = re.findall(r"^([\w, ]+)\n-+$", page("docs/reference/cpp.rst"), re.M)
    known = {name.strip() for heading in headings for name in heading.split(",")}
    yield from (f"docs/reference/cpp.rst: the folder {room} is missing" for room in rooms if room not in known)


def unknown_files():
    """docs/file_formats.md, or the page of export, names every file whose name the verbs and the writers have."""
    known = page("docs/file_formats.md") + page("docs/how_to/engines.md")
    for folder in ("tools/equidem", "tools/mpi", "lib/equidem/output"):
        for path in sorted((SOURCE / folder).rglob("*.cpp")):
            names = re.findall(r'"(\w+\.(?:csv|json|toml|h5|vt[mpi]|pvd|mtx|html|png|svg|txt))"', path.read_text(encoding="utf-8"))
            yield from (f"docs/file_formats.md: {name} of {path.relative_to(SOURCE)} is missing" for name in sorted(set(names)) if name not in known)


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


def wrong_numbers():
    """Numbers of README.md are those of the tables of data/benchmarks, rows that pages show are those of their files."""
    readme = page("README.md").replace("\n", " ")
    (million,) = (row for row in tables.rows_of(SOURCE / "data/benchmarks/solves.csv") if row["assembly"] == "hexagonal" and row["discs"] == "1 000 000")
    for solver in ("elimination", "multigrid", "CHOLMOD, METIS", "GAMG of PETSc"):
        if million[solver].partition(",")[0] not in readme:
            yield f"README.md: {million[solver].partition(',')[0]} of {solver} is missing"
    (settled,) = (row for row in tables.rows_of(SOURCE / "data/benchmarks/steps.csv") if row["discs"] == "settled" and row["cores"] == "1")
    if settled["faster than LAMMPS by"] not in readme:
        yield f"README.md: settled discs step {settled['faster than LAMMPS by']} times as fast as LAMMPS"
    speed = page("docs/reference/speed.md")
    steps = {(row["loop"], row["threads"]): row["disc-steps/s"].split()[0] for row in
             tables.rows_of(SOURCE / "data/benchmarks/dynamic/beside_plain_loops.csv") if row["assembly"] == "hexagonal" and row["discs"] == "1000500"}
    for loop, threads in (("equidem", "1"), ("equidem", "2"), ("plain, over pairs", "1")):
        number = f"{float(steps[loop, threads]):.2g}".replace("e+0", "e")
        if number not in speed:
            yield f"docs/reference/speed.md: {number} steps of a disc per second ({loop}, {threads} threads) is missing"
    yield from tables.stale()


def long_pages():
    """Pages of measurements have at most 60 lines beside their tables, others 150 in all, but for lists."""
    lists = ("docs/case_file.md", "docs/file_formats.md", "docs/vocabulary.md", "docs/index.md")
    for path in sorted([*(SOURCE / "data").glob("*.md"), *(SOURCE / "data/benchmarks").glob("*.md"), *(SOURCE / "docs").rglob("*.md")]):
        name, lines = path.relative_to(SOURCE).as_posix(), path.read_text(encoding="utf-8").split("\n")
        written = sum(not line.startswith(("|", "<!--")) and line != "" for line in lines)
        if name.startswith("data/") and written > 60:
            yield f"{name}: {written} lines beside its tables; 60 at most"
        if len(lines) > 151 and name not in lists:
            yield f"{name}: {len(lines) - 1} lines; 150 at most"


wrong = [*wrong_verbs(), *wrong_formats(), *missing_rooms(), *unknown_files(), *wrong_index(), *wrong_numbers(), *long_pages()]
print("\n".join(wrong) or "lists and numbers of the pages agree")
sys.exit(1 if wrong else 0)
