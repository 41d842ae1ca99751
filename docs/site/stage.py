#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Gather the pages of the site: stage.py SOURCE STAGE PROGRAM.

Pages are those of docs/, the Markdown files of data/ and of the top folder, with links as they are in the repository,
and pages that generate.py makes. STAGE gets them as Sphinx reads them: links lead to other pages, to figures, vector
graphics where they exist, or to a copy of the file.
"""

import os
import pathlib
import posixpath
import re
import shutil
import sys

import gallery
import generate

# Pages made here, by their place in docs/, which pages may link to.
GENERATED = ["cases.md", "reference/verbs.md", "reference/result.md", "examples/index.md"]
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
    for pattern in ("data/*.md", "data/benchmarks/*.md", "data/papers/*.md", "data/*/report.md"):
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
        lines = ["---", "orphan: true", "---", ""] if name.endswith("/report.md") else []
        for line, is_text in outside_code((self.source / name).read_text(encoding="utf-8")):
            if is_text:
                line = self.without_folders(line, name)
                line = LINK.sub(lambda found: f"]({self.link(found.group(1), name, place)})", line)
                # Sphinx has no word for blocks that the tests leave out
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


def main():
    source, place = pathlib.Path(sys.argv[1]).resolve(), pathlib.Path(sys.argv[2])
    program = os.path.abspath(sys.argv[3])
    shutil.rmtree(place, ignore_errors=True)
    stage = Stage(source, place)
    for name, target in stage.pages.items():
        if target not in GENERATED:
            stage.write(target, stage.text(name, target))
    examples = sorted(script.stem for script in (source / "docs/examples").glob("*.py"))
    stage.write("examples/index.md", generate.examples_page(examples))
    stage.write("cases.md", gallery.page(source, place, program))
    stage.write("reference/verbs.md", generate.verbs_page(program))
    stage.write("reference/result.md", generate.result_page(program))


if __name__ == "__main__":
    main()
