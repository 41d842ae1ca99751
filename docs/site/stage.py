#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Gather the pages of the site: stage.py SOURCE STAGE PROGRAM.

Pages are the Markdown files of docs/, data/ and of the top folder, with links as they are in the repository, and pages that
are made from the tables of the program. STAGE gets the pages as Sphinx reads them: links lead to other pages, to figures,
vector graphics where they exist, or to a copy of the file.
"""

import os
import pathlib
import posixpath
import re
import shutil
import subprocess
import sys

# Pages made here, by their place in docs/, which pages may link to.
GENERATED = ["reference/verbs.md", "reference/result.md", "examples/index.md"]
LINK = re.compile(r"\]\(([^)\s]+)\)")
TO_FOLDER = re.compile(r"\[`?([^\[\]`]*)`?\]\(([^)\s]+)\)")
INCLUDE = re.compile(r"^(```\{include\} )(\S+)$")
LITERAL = re.compile(r"^(\.\. literalinclude:: )(\S+)$", re.M)


def pages_of(source):
    """Every page of the repository and its place on the site, both relative."""
    pages = {}
    for path in sorted([*(source / "docs").rglob("*.md"), *(source / "docs").rglob("*.rst")]):
        name = path.relative_to(source).as_posix()
        pages[name] = name[len("docs/"):]
    for pattern in ("data/*.md", "data/benchmarks/*.md"):
        for path in sorted(source.glob(pattern)):
            name = path.relative_to(source).as_posix()
            pages[name] = name
    pages["CHANGELOG.md"] = "project/changelog.md"
    pages["CONTRIBUTING.md"] = "project/contributing.md"
    return pages


def outside_code(text):
    """Lines and whether each is text, not code; the line that opens a block of code counts as text."""
    fence = ""
    for line in text.split("\n"):
        mark = re.match(r"\s*(`{3,}|~{3,})", line)
        if fence:
            yield line, False
            if mark and mark.group(1).startswith(fence) and line.strip() == mark.group(1):
                fence = ""
        else:
            yield line, True
            if mark:
                fence = mark.group(1)


def links_of(text):
    """Targets of all links and pictures outside code."""
    for line, is_text in outside_code(text):
        if is_text:
            for found in LINK.finditer(re.sub(r"`[^`]*`(?!\])", "", line)):
                yield found.group(1)


class Stage:
    def __init__(self, source, stage):
        self.source, self.stage = source, stage
        self.pages = pages_of(source)
        self.pages.update({f"docs/{name}": name for name in GENERATED})

    def write(self, place, text):
        path = self.stage / place
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text, encoding="utf-8")

    def copied(self, name):
        """The place on the stage of a file of the repository that is no page."""
        place = posixpath.join("files", name)
        target = self.stage / place
        if not target.exists():
            target.parent.mkdir(parents=True, exist_ok=True)
            shutil.copyfile(self.source / name, target)
        return place

    def near(self, target, name, place):
        """The path from `place` to the copy of a file that the page `name` names."""
        wanted = posixpath.normpath(posixpath.join(posixpath.dirname(name), target))
        return posixpath.relpath(self.copied(wanted), posixpath.dirname(place) or ".")

    def link(self, target, name, place):
        """The target, seen from `place`, of a link of the page `name`."""
        if re.match(r"[a-z]+:|#", target):
            return target
        path, _, fragment = target.partition("#")
        wanted = posixpath.normpath(posixpath.join(posixpath.dirname(name), path))
        mark = "#" + fragment if fragment else ""
        if wanted == "README.md":
            place_of = "index.md"
        elif wanted in self.pages:
            place_of = self.pages[wanted]
        else:
            full = self.source / wanted
            if not full.is_file():
                raise SystemExit(f"{name}: the link {target} leads nowhere")
            if full.suffix == ".png" and full.with_suffix(".svg").exists():
                wanted = posixpath.splitext(wanted)[0] + ".svg"
            place_of = self.copied(wanted)
        return posixpath.relpath(place_of, posixpath.dirname(place) or ".") + ("#" + fragment if fragment else "")

    def without_folders(self, line, name):
        """Links to folders, which are no part of the site, as plain names."""
        def shown(found):
            folder = self.source / posixpath.dirname(name) / found.group(2)
            return f"`{found.group(1)}`" if folder.is_dir() else found.group(0)
        return TO_FOLDER.sub(shown, line)

    def text(self, name, place):
        """The text of a page with its links as they are at `place`."""
        if name.endswith(".rst"):
            return LITERAL.sub(lambda found: found.group(1) + self.near(found.group(2), name, place),
                               (self.source / name).read_text(encoding="utf-8"))
        lines = []
        for line, is_text in outside_code((self.source / name).read_text(encoding="utf-8")):
            if is_text:
                line = self.without_folders(line, name)
                line = LINK.sub(lambda found: f"]({self.link(found.group(1), name, place)})", line)
                # the source of a page is drawn with those words of a fence that Sphinx knows
                line = re.sub(r"^(\s*```\w+) not-run$", r"\1", line)
                line = INCLUDE.sub(lambda found: found.group(1) + self.part(found.group(2), name, place), line)
            lines.append(line)
        return "\n".join(lines)

    def part(self, target, name, place):
        """A file of the repository, staged so that the page at `place` can include it."""
        wanted = posixpath.normpath(posixpath.join(posixpath.dirname(name), target))
        part = posixpath.join("parts", place, wanted)
        self.write(part, self.text(wanted, place))
        return posixpath.relpath(part, posixpath.dirname(place) or ".")


def output_of(program, *words):
    return subprocess.run([program, *words], check=True, capture_output=True, text=True).stdout


def cell(text):
    return text.replace("|", "\\|").replace("<", "&lt;").replace("_", "\\_").replace("*", "\\*")


def verbs_of(program):
    """Names and meanings of all verbs, from the program's help."""
    listed = output_of(program, "--help").split("\nVerbs:\n")[1].split("\n\n")[0]
    return [line.split(None, 1) for line in listed.splitlines()]


def verbs_page(program):
    page = ["# Verbs", "", "`equidem VERB CASE.toml [OPTIONS]`. This page is made from `equidem VERB --help`; the keys of the "
            "case file have [their own](../case_file.md).", ""]
    for verb, meaning in verbs_of(program):
        page += [f"## {verb}", "", cell(meaning[0].upper() + meaning[1:]) + ".", ""]
        examples = []
        section = ""
        for line in output_of(program, verb, "--help").splitlines():
            if line.startswith("Usage:"):
                page += [f"`{line[len('Usage: '):]}`", ""]
            elif line and not line.startswith(" ") and line.endswith(":"):
                section = line
                if section in ("Positionals:", "Options:"):
                    page += ["", "| option | meaning |" if section == "Options:" else "| argument | meaning |", "|---|---|"]
            elif section in ("Positionals:", "Options:") and line.startswith("  "):
                name, text = line[2:30].rstrip(), line[30:].strip()
                if len(line) > 30 and line[29] != " ":  # the name is longer than its column
                    name, text = line.strip(), ""
                if name:
                    page.append(f"| `{name}` | {cell(text)} |".replace("`|`", "`\\|`"))
                    page[-1] = re.sub(r"`([^`]*)`", lambda m: "`" + m.group(1).replace("|", "\\|") + "`", page[-1], count=1)
                else:
                    page[-1] = page[-1][:-2].rstrip() + f" {cell(text)} |"
            elif section == "Examples:" and line.startswith("  "):
                examples.append(line[2:])
        if examples:
            page += ["", "```text", *examples, "```"]
        page.append("")
    return "\n".join(page)


def result_page(program):
    """The list of quantities as a table; columns of the help: name, unit, meaning."""
    intro, _, listed = output_of(program, "help", "result").partition("\nNames of numbers")
    page = ["# Numbers of result.json", "", "This page is `equidem help result`. In Python a result has the same numbers as "
            "attributes: `result.plane_strain.young_modulus`.", ""]
    paragraphs = intro.strip().split("\n\n")
    for paragraph in paragraphs:
        if re.match(r"\w+   ", paragraph):
            page += ["| key | meaning |", "|---|---|"]
            for line in paragraph.splitlines():
                name, text = line.split(None, 1)
                page.append(f"| `{name}` | {cell(text)} |")
        else:
            page.append(cell(paragraph))
        page.append("")
    page += ["| number | unit | meaning |", "|---|---|---|"]
    lines = [line for line in listed.splitlines()[1:] if line.startswith("  ")]
    for line in lines:
        name, rest = line.split(None, 1) if not line[2:].startswith(" ") else ("", line.strip())
        unit, meaning = "", rest
        column = re.match(r"\s{2}(\S+)(\s+)(\S+)\s{2,}(\S.*)$", line)
        if column and len(column.group(1) + column.group(2)) <= 38 and " " not in column.group(3):
            unit, meaning = column.group(3), column.group(4)
        page.append(f"| `{name}` | {cell(unit)} | {cell(meaning)} |")
    return "\n".join(page) + "\n"


def example_pages(source, stage):
    """Scripts in the percent format as pages."""
    listed = []
    for script in sorted((source / "docs/examples").glob("*.py")):
        page, kind = [], "code"
        for chunk in re.split(r"^# %%", script.read_text(encoding="utf-8"), flags=re.M):
            head, _, body = chunk.partition("\n")
            kind = "text" if "[markdown]" in head else "code"
            if kind == "text":
                page += [re.sub(r"^# ?", "", body, flags=re.M).strip(), ""]
            elif body.strip() and not body.startswith("# SPDX"):
                page += ["```python", body.strip("\n"), "```", ""]
        text = "\n".join(page)
        if not text.startswith("# "):
            text = f"# {script.stem[3:].replace('_', ' ').capitalize()}\n\n" + text
        stage.write(f"examples/{script.stem}.md", text)
        listed.append(script.stem)
    contents = ["```{toctree}", ":maxdepth: 1", "", *listed, "```"] if listed else []
    stage.write("examples/index.md", "\n".join([
        "# Examples", "", "Scripts to copy from, each with one question and one figure: `docs/examples/` of the source.", "",
        *contents, ""]))


def main():
    source, place, program = pathlib.Path(sys.argv[1]).resolve(), pathlib.Path(sys.argv[2]), os.path.abspath(sys.argv[3])
    shutil.rmtree(place, ignore_errors=True)
    stage = Stage(source, place)
    for name, target in stage.pages.items():
        if target not in GENERATED:
            stage.write(target, stage.text(name, target))
    stage.write("reference/verbs.md", verbs_page(program))
    stage.write("reference/result.md", result_page(program))
    example_pages(source, stage)


if __name__ == "__main__":
    main()
