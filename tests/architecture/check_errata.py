#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""check_errata.py FOLDER: every test that docs/errata.md names exists, and every row has five cells."""

import os
import re
import sys


def main():
    root = sys.argv[1]
    tests = set()
    for folder, _, names in os.walk(os.path.join(root, "tests")):
        for name in names:
            if name.endswith((".cpp", ".py")):
                text = open(os.path.join(folder, name), encoding="utf-8").read()
                tests.update(re.findall(r'TEST_CASE\(\s*"(\w+)"', text) + re.findall(r"def (test_\w+)", text))
    rows = [line.split(" | ") for line in open(os.path.join(root, "docs/errata.md"), encoding="utf-8")
            if line.startswith("| ") and not line.startswith("| paper")]
    broken = [f"{len(row)} cells in the row '{' | '.join(row[:2])}'" for row in rows if len(row) != 5]
    named = [name for row in rows for name in re.findall(r"`(\w+)`", row[-1])]
    broken += [f"no test '{name}'" for name in named if name not in tests]
    print("\n".join(broken) or f"{len(rows)} rows, {len(named)} tests found")
    return 1 if broken or not named else 0


if __name__ == "__main__":
    sys.exit(main())
