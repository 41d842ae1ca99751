# SPDX-License-Identifier: GPL-3.0-or-later
"""Pages that are made from the tables of the program, as Markdown."""

import re
import subprocess


def output_of(program, *words):
    return subprocess.run([program, *words], check=True, capture_output=True, text=True).stdout


def cell(text):
    return text.replace("|", "\\|").replace("<", "&lt;").replace("_", "\\_").replace("*", "\\*")


def table(columns, rows):
    """A table; the first cell of a row is code."""
    lines = ["| " + " | ".join(columns) + " |", "|" + "---|" * len(columns)]
    for name, *others in rows:
        lines.append("| `" + name.replace("|", "\\|") + "` | " + " | ".join(map(cell, others)) + " |")
    return [*lines, ""]


def verbs_of(program):
    """Names and meanings of all verbs, from the program's help."""
    listed = output_of(program, "--help").split("\nVerbs:\n")[1].split("\n\n")[0]
    return [line.split(None, 1) for line in listed.splitlines()]


def examples_of(help_text):
    """The commands of a verb's help, each with its comment, lines that go on joined."""
    lines = []
    for line in help_text.partition("\nExamples:\n")[2].splitlines():
        if line.startswith("  equidem "):
            lines.append(line.strip())
        elif line.startswith("   ") and lines:
            lines[-1] += " " + line.strip()
    return [(command, comment.strip()) for command, _, comment in (line.partition("  ") for line in lines)]


def entries_of(help_text, section):
    """Names and meanings below a heading of the help, whose meanings begin in column 30."""
    rows = []
    for line in help_text.partition(f"\n{section}:\n")[2].partition("\n\n")[0].splitlines():
        name, meaning = line[:30].strip(), line[30:].strip()
        if len(line) > 30 and line[29] != " ":  # the name is longer than its column
            name, meaning = line.strip(), ""
        if name:
            rows.append([name, meaning])
        else:
            rows[-1][1] = f"{rows[-1][1]} {meaning}".strip()
    return rows


def verbs_page(program):
    page = ["# Verbs", "",
            "`equidem VERB CASE.toml [OPTIONS]`. This page is made from `equidem VERB --help`; the keys of",
            "the case file have [their own](../case_file.md).", ""]
    for verb, meaning in verbs_of(program):
        text = output_of(program, verb, "--help")
        usage = re.search(r"^Usage: (.*)$", text, re.M).group(1)
        page += [f"## {verb}", "", cell(meaning[0].upper() + meaning[1:]) + ".", "", f"`{usage}`", ""]
        for section, title in (("Positionals", "argument"), ("Options", "option")):
            rows = entries_of(text, section)
            page += table([title, "meaning"], rows) if rows else []
        page.append("```sh")
        for command, comment in examples_of(text):
            page += [f"# {comment}"] if comment else []
            page.append(command)
        page += ["```", ""]
    return "\n".join(page)


def result_page(program):
    intro, _, listed = output_of(program, "help", "result").partition("\nNames of numbers")
    page = ["# Numbers of result.json", "",
            "This page is `equidem help result`. In Python a result has the same numbers as",
            "attributes: `result.plane_strain.young_modulus`.", ""]
    for paragraph in intro.strip().split("\n\n"):
        if re.match(r"\w+   ", paragraph):
            page += table(["key", "meaning"], [line.split(None, 1) for line in paragraph.splitlines()])
        else:
            page += [cell(paragraph), ""]
    # Columns of the list: name, unit or blanks, meaning. The first number has no unit.
    lines = [line for line in listed.splitlines()[1:] if line.startswith("  ")]
    column = re.match(r"  \S+\s+", lines[0]).end()
    rows = [(line.split()[0], " ".join(line[:column].split()[1:]), line[column:]) for line in lines]
    return "\n".join(page + table(["number", "unit", "meaning"], rows))


def examples_page(names):
    """The contents of the examples, whose pages tools/notebooks makes."""
    contents = ["```{toctree}", ":maxdepth: 1", "", *names, "```"] if names else []
    return "\n".join(["# Examples", "",
                      "Scripts to copy from, each with one question and one figure: `docs/examples/` of the source.",
                      "", *contents, ""])
