#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Tables of pages come from CSV files.

    docs/site/tables.py fill                  every table of the pages, from its file
    docs/site/tables.py check                 does every table show its file?
    docs/site/tables.py store REPORT FOLDER   each table of a report (Markdown) as FOLDER/HEADING.csv

A table stands between the lines "<!-- table FILE -->" and "<!-- end -->"; FILE is relative to the page. Behind FILE may
stand "where COLUMN = VALUE", or "where COLUMN" for rows that have a value there, several joined by "and", and
": COLUMN; COLUMN as HEAD; ...", the columns that are shown.
"""

import csv
import pathlib
import re
import sys

SOURCE = pathlib.Path(__file__).resolve().parents[2]
BLOCK = re.compile(r"^<!-- table (\S+?)(?: where ([^:\n]+?))?(?:: ([^\n]+?))? -->\n(.*?)^<!-- end -->$", re.M | re.S)


class Wrong(Exception):
    pass


def rows_of(path):
    """Rows of a CSV file as dictionaries."""
    with open(path, newline="", encoding="utf-8") as file:
        return list(csv.DictReader(file))


def write_rows(path, head, rows):
    path.parent.mkdir(parents=True, exist_ok=True)
    with open(path, "w", newline="", encoding="utf-8") as file:
        csv.writer(file, lineterminator="\n").writerows([head, *rows])


def table(head, rows):
    lines = [head, ["---"] * len(head), *rows]
    text = "".join("| " + " | ".join(line) + " |\n" for line in lines)
    return text.replace("| --- ", "|---").replace("--- |", "---|")


def unbroken(cell):
    """A cell in which no line breaks within a number or between it and its unit."""
    if "`" in cell:
        return cell
    cell = re.sub(r"(?<=\de)-(?=\d)|(?<=\d{4})-(?=\d\d)|(?<=\d{4}.\d\d)-(?=\d\d)", "\u2011", cell)
    cell = cell.replace(" .. ", "\u00a0..\u00a0")
    return re.sub(r"(?<=\d) (?=(?:[µm]?s|[MG]B|%|\d{3})(?![\w]))", "\u00a0", cell)


def shown(page, name, where, columns):
    """The Markdown of a block."""
    path = page.parent / name
    if not path.is_file():
        raise Wrong(f"{page.relative_to(SOURCE)}: there is no file {name}")
    rows = rows_of(path)
    head = list(rows[0]) if rows else []
    words = columns.split(";") if columns else head
    wanted = [(word.partition(" as ")[0].strip(), word.rpartition(" as ")[2].strip()) for word in words]
    conditions = [[part.strip() for part in word.split("=")] for word in where.split(" and ")] if where else []
    for column in [column for column, _ in wanted] + [condition[0] for condition in conditions]:
        if column not in head:
            raise Wrong(f"{page.relative_to(SOURCE)}: {name} has no column '{column}'; it has {', '.join(head)}")
    kept = [row for row in rows
            if all(row[column] == value[0] if value else row[column] for column, *value in conditions)]
    return table([label for _, label in wanted], [[unbroken(row[column]) for column, _ in wanted] for row in kept])


def filled(page):
    """The text of a page with its tables as their files have them."""
    def block(found):
        first = found.group(0).partition("\n")[0]
        return f"{first}\n{shown(page, *found.groups()[:3])}\n<!-- end -->"
    return BLOCK.sub(block, page.read_text(encoding="utf-8"))


def pages():
    return [SOURCE / "README.md", *sorted((SOURCE / "docs").rglob("*.md")), *sorted((SOURCE / "data").rglob("*.md"))]


def fill():
    for page in pages():
        text = filled(page)
        if text != page.read_text(encoding="utf-8"):
            page.write_text(text, encoding="utf-8")


def stale():
    """A sentence for each page whose tables are not those of their files."""
    for page in pages():
        try:
            if filled(page) != page.read_text(encoding="utf-8"):
                yield f"{page.relative_to(SOURCE)}: a table is not that of its file; run docs/site/tables.py fill"
        except Wrong as wrong:
            yield str(wrong)


def cells(line):
    return [cell.strip().replace("\\|", "|") for cell in re.split(r"(?<!\\)\|", line.strip())[1:-1]]


def tables_of(text):
    """Name and lines of cells of each table of a report; the name is that of its heading."""
    heading, found, lines = "table", [], []
    for line in [*text.split("\n"), ""]:
        if line.startswith("|"):
            lines.append(line)
            continue
        if lines:
            names = [name for name, _ in found]
            name, count = heading, 1
            while name in names:
                count += 1
                name = f"{heading}_{count}"
            found.append((name, [cells(one) for k, one in enumerate(lines) if k != 1]))
            lines = []
        if line.startswith("#"):
            heading = re.sub(r"\W+", "_", re.split("[:,]", line.lstrip("# ").lower())[0]).strip("_")
    return found


def store(report, folder):
    for name, (head, *rows) in tables_of(pathlib.Path(report).read_text(encoding="utf-8")):
        write_rows(pathlib.Path(folder) / f"{name}.csv", head, rows)


if __name__ == "__main__":
    if sys.argv[1:] == ["fill"]:
        fill()
    elif sys.argv[1:] == ["check"]:
        wrong = list(stale())
        print("\n".join(wrong) or "every table shows its file")
        sys.exit(1 if wrong else 0)
    elif len(sys.argv) == 4 and sys.argv[1] == "store":
        store(*sys.argv[2:])
    else:
        sys.exit(__doc__)
