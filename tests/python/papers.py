# SPDX-License-Identifier: GPL-3.0-or-later
"""The scripts of tools/papers, as a user runs them."""
import csv
import json
import os
import pathlib
import signal
import subprocess
import sys
import time

ROOT = pathlib.Path(__file__).parents[2]
PAPERS = ROOT / "tools" / "papers"


def run(name, *arguments):
    return subprocess.run([sys.executable, "-B", PAPERS / f"{name}.py", *map(str, arguments)], capture_output=True, text=True,
                          timeout=800, check=False)


def result_of(name, out, *arguments):
    """result.json of a run into a folder; report.txt is what it prints."""
    done = run(name, "--out", out, *arguments)
    assert done.returncode == 0, done.stderr
    assert done.stdout == (out / "report.txt").read_text(encoding="utf-8")
    return json.loads((out / "result.json").read_text(encoding="utf-8"))


def rows(path):
    with open(path, newline="", encoding="utf-8") as file:
        return list(csv.DictReader(file))


def check_help(name):
    """It names the options and exit codes; others are refused."""
    text = run(name, "--help").stdout
    for word in ("--out", "--json", "--overwrite", "--quick", "Example", "Exit codes:"):
        assert word in text, word
    refused = run(name, "--rows", "5")
    assert refused.returncode == 2 and "--rows" in refused.stderr and refused.stdout == ""


def check_interrupt(name, out, whole_group=False):
    """It stops soon, with exit code 130; the signal goes to it alone or, as that of `timeout`, to its workers too."""
    with subprocess.Popen([sys.executable, "-B", PAPERS / f"{name}.py", "--out", out, "--quiet"], stdout=subprocess.PIPE,
                          stderr=subprocess.PIPE, text=True, start_new_session=True) as started:
        while not out.exists():  # the computation begins
            time.sleep(0.1)
        time.sleep(8 if whole_group else 3)
        if whole_group:
            os.killpg(started.pid, signal.SIGTERM)
        else:
            started.send_signal(signal.SIGINT)
        try:
            stdout, stderr = started.communicate(timeout=60)
        finally:
            started.kill()
    assert (started.returncode, stdout) == (130, ""), stderr
