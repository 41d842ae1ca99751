#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""check_names.py FOLDER: names of the code that docs/vocabulary.md gives occur in lib/equidem, each term has one row;
every test that docs/errata.md names exists, and each of its rows has five cells."""

import pathlib
import re
import sys


def texts_of(folder, *ends):
    return [path.read_text(encoding="utf-8") for path in sorted(folder.rglob("*")) if path.suffix in ends]


def wrong_terms(root):
    words = {word for text in texts_of(root / "lib/equidem", ".hpp", ".cpp") for word in re.findall(r"\w+", text)}
    text = (root / "docs/vocabulary.md").read_text(encoding="utf-8").split("## Terms to avoid")[0]
    rows = [row for row in re.findall(r"^\| ([^|]*) \|(.*)\|$", text, re.M) if row[0] != "term" and row[0][:3] != "---"]
    terms = [term for term, _ in rows]
    yield from (f"the term '{term}' has {terms.count(term)} rows" for term in sorted(set(terms)) if terms.count(term) > 1)
    yield from (f"'{term}': no '{word}' in lib/equidem" for term, row in rows for code in re.findall(r"`([^`]*)`", row)
                for word in re.findall(r"\w+", code) if word not in words)
    if not terms:
        yield "docs/vocabulary.md has no terms"


def wrong_errata(root):
    tests = {name for text in texts_of(root / "tests", ".cpp", ".py")
             for name in re.findall(r'TEST_CASE\(\s*"(\w+)"', text) + re.findall(r"def (test_\w+)", text)}
    lines = (root / "docs/errata.md").read_text(encoding="utf-8").splitlines()
    rows = [line.split(" | ") for line in lines if line.startswith("| ") and not line.startswith("| paper")]
    yield from (f"{len(row)} cells in the row '{' | '.join(row[:2])}'" for row in rows if len(row) != 5)
    named = [name for row in rows for name in re.findall(r"`(\w+)`", row[-1])]
    yield from (f"no test '{name}'" for name in named if name not in tests)
    if not named:
        yield "docs/errata.md names no tests"


if __name__ == "__main__":
    broken = [*wrong_terms(pathlib.Path(sys.argv[1])), *wrong_errata(pathlib.Path(sys.argv[1]))]
    print("\n".join(broken) or "every name found")
    sys.exit(1 if broken else 0)
