#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""check_links.py SOURCE: every link of the pages of the site leads to a file of the repository and to a heading of it,
and every page of docs/ is in a table of contents."""

import fnmatch
import pathlib
import re
import sys

sys.dont_write_bytecode = True
SOURCE = pathlib.Path(sys.argv[1]).resolve()
sys.path.insert(0, str(SOURCE / "docs/site"))

import stage  # noqa: E402


def anchors_of(text):
    """Anchors of headings, as GitHub and MyST make them."""
    found = {}
    for line, is_text in stage.outside_code(text):
        heading = re.match(r"#+ (.*)", line)
        if is_text and heading:
            anchor = re.sub(r"[^\w\- ]", "", heading.group(1).strip().lower()).replace(" ", "-")
            found[anchor] = found.get(anchor, -1) + 1
    return {f"{name}-{k}" if k else name for name, count in found.items() for k in range(count + 1)}


def broken_links():
    pages = stage.pages_of(SOURCE)
    generated = {SOURCE / "docs" / name for name in stage.GENERATED}
    for name in [*(name for name in pages if name.endswith(".md")), "README.md"]:
        text = (SOURCE / name).read_text(encoding="utf-8")
        for target in stage.links_of(text):
            if re.match(r"[a-z]+:", target):
                continue
            path, _, fragment = target.partition("#")
            file = (SOURCE / name).parent / path if path else SOURCE / name
            if file.resolve() in generated:
                continue
            if not file.exists():
                yield f"{name}: {target} leads nowhere"
            elif fragment and file.suffix == ".md" and fragment not in anchors_of(file.read_text(encoding="utf-8")):
                yield f"{name}: {target} is no heading of {path or name}"


def lost_pages():
    listed = re.findall(r"^[\w/\[\]!*]+$", (SOURCE / "docs/index.md").read_text(encoding="utf-8"), re.M)
    for place in stage.pages_of(SOURCE).values():
        page = place.rpartition(".")[0]
        elsewhere = place.startswith(("data/", "project/")) or page == "index"
        if not elsewhere and not any(fnmatch.fnmatch(page, pattern) for pattern in listed):
            yield f"docs/{place} is in no table of contents of docs/index.md"


broken = [*broken_links(), *lost_pages()]
print("\n".join(broken) or "every link leads somewhere, every page is listed")
sys.exit(1 if broken else 0)
