#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""check_site.py SITE: every link of the built pages leads to a file of the site and to a mark in it, and no page loads
anything from elsewhere."""

import html.parser
import pathlib
import re
import sys
import urllib.parse

SITE = pathlib.Path(sys.argv[1]).resolve()
LOADED = {"img": "src", "script": "src", "link": "href", "iframe": "src"}


class Page(html.parser.HTMLParser):
    def __init__(self, path):
        super().__init__()
        self.path, self.marks, self.links, self.foreign = path, {""}, [], []
        self.feed(path.read_text(encoding="utf-8"))

    def handle_starttag(self, tag, attributes):
        values = dict(attributes)
        self.marks.update(values[name] for name in ("id", "name") if values.get(name))
        loaded = values.get(LOADED.get(tag, ""))
        target = loaded or (values.get("href") if tag == "a" else None)
        if target and re.match(r"[a-z]+:", target):
            if loaded and not target.startswith("data:"):
                self.foreign.append(target)
        elif target:
            self.links.append(target)


def broken(pages):
    for page in pages.values():
        name = page.path.relative_to(SITE)
        yield from (f"{name} loads {target}" for target in page.foreign)
        for target in page.links:
            path, _, mark = target.partition("#")
            path = urllib.parse.unquote(path.partition("?")[0])
            file = (page.path.parent / path).resolve() if path else page.path
            if not file.is_file():
                yield f"{name}: {target} leads nowhere"
            elif file in pages and urllib.parse.unquote(mark) not in pages[file].marks:
                yield f"{name}: {target} is no mark of that page"


found = {path: Page(path) for path in SITE.rglob("*.html") if "mathjax" not in path.parts}
wrong = sorted(set(broken(found)))
print("\n".join(wrong) or f"{len(found)} pages, every link leads somewhere")
sys.exit(1 if wrong or not found else 0)
