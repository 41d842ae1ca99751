#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Lines of each room of the library that the tests run: a table on stdout.

usage: tests/coverage.py [--label ROOMS]

Builds the preset "coverage", runs its tests without the slow ones (--label: those of some rooms, a regular
expression), and reads the counts with gcovr, which Debian has in a package of that name.
"""

import argparse
import collections
import json
import pathlib
import shutil
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parents[1]


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--label", default=".")
    options = parser.parse_args()
    if shutil.which("gcovr") is None:
        sys.exit("gcovr is not installed, which reads the counts. Install the package gcovr")
    for command in (["cmake", "--preset", "coverage", "-DEQUIDEM_BUILD_TESTS=ON"],
                    ["cmake", "--build", "--preset", "coverage"]):
        subprocess.run(command, cwd=ROOT, check=True, stdout=subprocess.DEVNULL)
    for counts in (ROOT / "build/coverage").rglob("*.gcda"):
        counts.unlink()
    tested = subprocess.run(["ctest", "--preset", "coverage", "--no-tests=error", "-L", options.label, "-LE", "^turn_"],
                            cwd=ROOT, check=False).returncode
    text = subprocess.run(["gcovr", "--root", ".", "--filter", "lib/equidem/", "--gcov-ignore-parse-errors",
                           "--json-summary", "-", "build/coverage/lib"],
                          cwd=ROOT, check=True, capture_output=True, text=True).stdout
    rooms: dict[str, collections.Counter[str]] = collections.defaultdict(collections.Counter)
    for file in json.loads(text)["files"]:
        for room in (file["filename"].split("/")[2], "all"):
            rooms[room].update(run=file["line_covered"], all=file["line_total"])
    print(f"{'room':<12} {'lines':>7} {'run, %':>7}")
    for room, lines in sorted(rooms.items(), key=lambda item: (item[0] == "all", item[0])):
        print(f"{room:<12} {lines['all']:>7} {100 * lines['run'] / lines['all']:>7.1f}")
    return tested


if __name__ == "__main__":
    sys.exit(main())
