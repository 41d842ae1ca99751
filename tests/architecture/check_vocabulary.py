#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""check_vocabulary.py FOLDER: names in the code that docs/vocabulary.md gives occur in lib/equidem, terms occur once."""

import os
import re
import sys


def main():
    root = sys.argv[1]
    words = set()
    for folder, _, names in os.walk(os.path.join(root, "lib/equidem")):
        for name in names:
            if name.endswith((".hpp", ".cpp")):
                words.update(re.findall(r"\w+", open(os.path.join(folder, name), encoding="utf-8").read()))
    text = open(os.path.join(root, "docs/vocabulary.md"), encoding="utf-8").read().split("## Terms to avoid")[0]
    rows = re.findall(r"^\| ([^|]*) \|(.*)\|$", text, re.M)
    terms = [term for term, _ in rows if term != "term" and not term.startswith("---")]
    broken = [f"the term '{term}' has {terms.count(term)} rows" for term in sorted(set(terms)) if terms.count(term) > 1]
    for term, row in rows:
        for code in re.findall(r"`([^`]*)`", row):
            broken += [f"'{term}': no '{word}' in lib/equidem" for word in re.findall(r"\w+", code) if word not in words]
    print("\n".join(broken) or f"{len(terms)} terms, every name found")
    return 1 if broken or not terms else 0


if __name__ == "__main__":
    sys.exit(main())
