#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Seeded faults: each line of faults.csv changes one place of a copy of the library, and the tests have to find it.

usage: tests/mutants/run.py FOLDER [--from K] [--count N] [--room ROOM]

FOLDER gets the copy and its build (preset dev), and results.csv: the fault, what found it, seconds. The tests of the
room come first, those of rooms that use it, then those that every room answers to. An interrupted run goes on where it
ended. Exit code 1 where fewer than 95 of 100 faults are found.
"""

import argparse
import csv
import pathlib
import shutil
import subprocess
import sys
import time

ROOT = pathlib.Path(__file__).resolve().parents[2]
BEHIND = ("invariants", "agreement", "hard_cases", "papers", "third_party")
# Rooms whose tests go through the formulas of another one.
USERS = {"geometry": ("packing", "grains"), "linear": ("statics", "breakage"), "statics": ("waves", "breakage"),
         "core": ("casefile",)}
SCRIPTS = {"output": ("run_export.py", "run_formats.py"), "casefile": ("run_pack.py",), "core": ("run_import.py",)}
LONGEST = 900  # s: a loop that does not end is a fault that is found
WANTED = 0.95
COLUMNS = ("file", "line", "was", "becomes", "found_by", "seconds")


def copied(folder: pathlib.Path) -> None:
    """The files that git knows, those that have changed alone, so that little is compiled again."""
    names = subprocess.run(["git", "ls-files", "-z"], cwd=ROOT, check=True, capture_output=True, text=True).stdout
    for name in filter(None, names.split("\0")):
        source, copy = ROOT / name, folder / name
        if not source.is_file() or (copy.is_file() and copy.read_bytes() == source.read_bytes()):
            continue
        copy.parent.mkdir(parents=True, exist_ok=True)
        shutil.copy(source, copy)


def quiet(command: list[str], folder: pathlib.Path) -> bool:
    """Whether a command succeeds within the time."""
    try:
        return subprocess.run(command, cwd=folder, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL,
                              stdin=subprocess.DEVNULL, timeout=LONGEST).returncode == 0
    except subprocess.TimeoutExpired:
        return False


def built(folder: pathlib.Path, *targets: str) -> bool:
    return subprocess.run(["ninja", "-C", "build/dev", *targets], cwd=folder, stdout=subprocess.DEVNULL,
                          stderr=subprocess.DEVNULL).returncode == 0


def found_by(folder: pathlib.Path, room: str) -> str:
    """The tests that fail; "" where none does."""
    for tests in (room, *USERS.get(room, ()), *BEHIND):
        program = f"test_{tests}"
        if not built(folder, program):
            return "the compiler"
        if not quiet([f"build/dev/tests/{program}", "--abort"], folder):
            return tests
    for script in SCRIPTS.get(room, ()):
        if not built(folder, "equidem"):
            return "the compiler"
        if not quiet([sys.executable, "-B", f"tests/program/{script}", str(folder / "build/dev/tools/equidem"),
                      str(folder)], folder):
            return script
    return ""


def seeded(folder: pathlib.Path, fault: dict[str, str]) -> dict[str, str | int]:
    path = folder / "lib/equidem" / fault["file"]
    text = path.read_text(encoding="utf-8")
    if text.count(fault["was"]) != 1:
        sys.exit(f"{fault['file']}: '{fault['was']}' is there {text.count(fault['was'])} times, and has to be once")
    begin = time.monotonic()
    path.write_text(text.replace(fault["was"], fault["becomes"]), encoding="utf-8")
    try:
        found = found_by(folder, fault["file"].split("/", maxsplit=1)[0])
    finally:
        path.write_text(text, encoding="utf-8")
    line = text[:text.index(fault["was"])].count("\n") + 1
    return {**fault, "line": line, "found_by": found, "seconds": round(time.monotonic() - begin)}


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder", type=pathlib.Path)
    parser.add_argument("--from", dest="first", type=int, default=0, metavar="K")
    parser.add_argument("--count", type=int, metavar="N")
    parser.add_argument("--room")
    options = parser.parse_args()
    folder = options.folder.resolve()
    if folder == ROOT or folder.is_relative_to(ROOT / "lib") or folder.is_relative_to(ROOT / "tests"):
        parser.error("the folder holds a copy, and must not lie within the sources")
    with open(ROOT / "tests/mutants/faults.csv", encoding="utf-8", newline="") as stream:
        faults = [fault for fault in csv.DictReader(stream) if options.room in (None, fault["file"].split("/")[0])]
    last = None if options.count is None else options.first + options.count
    copied(folder)
    if not quiet(["cmake", "--preset", "dev", "-DEQUIDEM_BUILD_TESTS=ON"], folder):
        sys.exit("the copy is not configured: try 'cmake --preset dev' in it")
    results = folder / "results.csv"
    done: list[dict[str, str]] = []
    if results.exists():
        with open(results, encoding="utf-8", newline="") as stream:
            done = list(csv.DictReader(stream))
    known = {(row["file"], row["was"], row["becomes"]) for row in done}
    with open(results, "a", encoding="utf-8", newline="") as stream:
        table = csv.DictWriter(stream, COLUMNS, lineterminator="\n")
        if not done:
            table.writeheader()
        for fault in faults[options.first:last]:
            if (fault["file"], fault["was"], fault["becomes"]) in known:
                continue
            row = seeded(folder, fault)
            table.writerow(row)
            stream.flush()
            done.append({name: str(value) for name, value in row.items()})
            print(f"{row['file']}:{row['line']}: {row['found_by'] or 'NOT FOUND'} ({row['seconds']} s)", flush=True)
    found = sum(row["found_by"] != "" for row in done)
    print(f"{found} of {len(done)} faults are found")
    return 0 if found >= WANTED * len(done) else 1


if __name__ == "__main__":
    sys.exit(main())
