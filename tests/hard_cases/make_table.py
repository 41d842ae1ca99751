#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""The table of hard cases, as the tests measure it.

    make_table.py write PROGRAM PAGE   run the test program, large cases too, and write the page
    make_table.py check PAGE           does the page name the cases of the tests beside this script, and no others?
"""

import glob
import json
import os
import re
import subprocess
import sys
import tempfile

HEAD = """# Hard cases

Each is right to a stated accuracy, or refused with a sentence that says what to do. Written by the tests:

    tests/hard_cases/make_table.py write build/release/tests/test_hard_cases data/hard_cases.md

*error* is the distance from the truth: quadruple precision, a closed form, or a solution known beforehand. *bound* is what the
program itself states, from the residual, an estimate of the condition and the rounding of the geometry. Both are relative: of all
motions (2-norm, rotations times the mean radius), or of the largest entry of the effective stiffness. Digits differ a little from
machine to machine; that the error is within the bound, and the bound within what is promised, is tested on each.
"""


def cases_of_sources():
    """Names of the cases in the order in which the sources have them first."""
    names = []
    for path in sorted(glob.glob(os.path.join(os.path.dirname(os.path.abspath(__file__)), "*.cpp"))):
        with open(path, encoding="utf-8") as file:
            names += re.findall(r'HardCase(?:::Words)? \w+\(?\s*\{\s*\.name = "([^"]+)"', file.read())
    return list(dict.fromkeys(names))


def measured_rows(program):
    with tempfile.TemporaryDirectory() as folder:
        path = os.path.join(folder, "rows")
        for tests in ([], ["[.large]"]):
            subprocess.run([program, *tests], env={**os.environ, "EQUIDEM_HARD_CASES": path}, check=True)
        with open(path, encoding="utf-8") as file:
            return [json.loads(line) for line in file]


def page_of(rows):
    text = HEAD
    for name in cases_of_sources():
        own = [row for row in rows if row["case"] == name]
        text += f"\n## {name}\n\n{own[0]['why'][0].upper()}{own[0]['why'][1:]}.\n\n"
        text += "| task | promised | measured |\n|---|---|---|\n"
        for row in own:
            text += "| " + " | ".join(row[key].replace("|", "\\|") for key in ("task", "promised", "measured")) + " |\n"
    return text


def main():
    if len(sys.argv) == 4 and sys.argv[1] == "write":
        page = page_of(measured_rows(sys.argv[2]))
        with open(sys.argv[3], "w", encoding="utf-8") as file:
            file.write(page)
        return 0
    if len(sys.argv) == 3 and sys.argv[1] == "check":
        with open(sys.argv[2], encoding="utf-8") as file:
            listed = re.findall(r"^## (.+)$", file.read(), re.MULTILINE)
        tested = cases_of_sources()
        for name in sorted(set(tested) - set(listed)):
            print(f"the page has no case '{name}': write it anew")
        for name in sorted(set(listed) - set(tested)):
            print(f"the page has a case '{name}' that no test has: write it anew")
        return 0 if tested and tested == listed else 1
    print(__doc__)
    return 2


if __name__ == "__main__":
    sys.exit(main())
