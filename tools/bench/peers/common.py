# SPDX-License-Identifier: GPL-3.0-or-later
"""Commands, medians and tables of the comparisons."""

import json
import os
import statistics
import subprocess
import sys


class Failure(Exception):
    """A comparison cannot go on; the message says why."""


def call(command, folder=None, seconds=1800, **settings):
    """What a command prints; on one thread unless settings (environment variables) say otherwise."""
    environment = {**os.environ, "OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1", "OMP_THREAD_LIMIT": "1"}
    environment.update(settings)
    command = [str(word) for word in command]
    try:
        done = subprocess.run(
            command, cwd=folder, env=environment, stdin=subprocess.DEVNULL, capture_output=True, text=True, timeout=seconds
        )
    except FileNotFoundError:
        raise Failure(f"{command[0]} is not there") from None
    except subprocess.TimeoutExpired:
        raise Failure(f"{command[0]} took more than {seconds} s") from None
    if done.returncode != 0:
        raise Failure(f"{' '.join(command[:4])} ... failed: {(done.stderr or done.stdout).strip()[-500:]}")
    return done.stdout


def result_of(text):
    """The object behind the word RESULT."""
    for line in text.splitlines():
        if line.startswith("RESULT "):
            return json.loads(line[len("RESULT ") :])
    raise Failure(f"no result in: {text.strip()[-300:]}")


def median(values):
    return statistics.median(values)


def tell(message):
    print(message, file=sys.stderr, flush=True)


def number(value, digits=3):
    return f"{value:.{digits}g}"


def spread(values, digits=3):
    """"median (smallest .. largest)"."""
    if len(values) == 1:
        return number(values[0], digits)
    return f"{number(median(values), digits)} ({number(min(values), digits)} .. {number(max(values), digits)})"


def table(head, rows):
    lines = ["| " + " | ".join(head) + " |", "|" + "---|" * len(head)]
    lines += ["| " + " | ".join(str(cell) for cell in row) + " |" for row in rows]
    return "\n".join(lines)
