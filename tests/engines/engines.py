# SPDX-License-Identifier: GPL-3.0-or-later
"""The programs that exported models are checked by: where they are, how they run, what they write."""
import csv
import json
import os
import pathlib
import re
import shutil
import subprocess

import numpy as np


class Missing(Exception):
    """An engine that is not installed."""


class Failed(Exception):
    """A program that ended with an error."""


def call(command, folder):
    done = subprocess.run([str(word) for word in command], cwd=folder, capture_output=True, text=True, timeout=500,
                          env={**os.environ, "OMP_NUM_THREADS": "1"}, stdin=subprocess.DEVNULL)
    if done.returncode != 0:
        raise Failed(f"{' '.join(map(str, command))}: {(done.stderr or done.stdout).strip()[-1500:]}")
    return done.stdout + done.stderr


def lammps():
    """A LAMMPS with granular styles."""
    return found("EQUIDEM_LAMMPS", "lmp")


def lammps_with_bonds():
    """A LAMMPS with the package BPM: that of EQUIDEM_LAMMPS_BPM, or lmp where it has it."""
    program = found("EQUIDEM_LAMMPS_BPM", "lmp")
    if "bpm/rotational" not in subprocess.run([program, "-h"], capture_output=True, text=True).stdout:
        raise Missing("LAMMPS with BPM (lmp is built without it; EQUIDEM_LAMMPS_BPM names another)")
    return program


def yade():
    return found("EQUIDEM_YADE", "yade")


def found(variable, name):
    program = shutil.which(os.environ.get(variable) or name)
    if program is None:
        raise Missing(f"{name} (or {variable})")
    return program


def version_of_lammps(program):
    help_text = subprocess.run([program, "-h"], capture_output=True, text=True).stdout
    return re.search(r"- (\d+ \w+ \d+)", help_text).group(1)


def version_of_yade(program):
    return subprocess.run([program, "--version"], capture_output=True, text=True).stdout.split()[-1].strip("'\"")


class Model:
    """A case in a folder, solved by equidem and exported."""

    def __init__(self, program, folder, text, name="case"):
        self.program, self.folder = program, pathlib.Path(folder)
        self.case = self.folder / f"{name}.toml"
        self.case.write_text('schema = "equidem/1"\n' + text)

    def equidem(self, verb, out, *options):
        call([self.program, verb, self.case, "--out", out, "--quiet", *options], self.folder)
        return self.folder / out

    def export(self, engine, *options):
        """The folder that was written."""
        return self.equidem("export", f"{self.case.stem}_{engine}", "--to", engine, *options)


def rows(path):
    with open(path) as file:
        return list(csv.DictReader(file))


def columns(path, *names):
    table = rows(path)
    return np.array([[float(row[name]) for name in names] for row in table])


def head_of(script):
    """The part of a script before the motion: the model, with its bonds at rest."""
    return script.read_text().split("# Motion\n")[0]


def dump(path):
    """Columns by name of the last state of a LAMMPS dump."""
    lines = path.read_text().split("ITEM: ATOMS ")[-1].splitlines()
    return dict(zip(lines[0].split(), np.array([[float(word) for word in line.split()] for line in lines[1:]]).T))


def run_lammps(program, folder, script="in.equidem", *words):
    call([program, "-in", script, "-log", "log.lammps", "-screen", "none", *words], folder)


def run_yade(program, folder, script="run_equidem.py"):
    """What it wrote; a script that fails does not change the exit code of yade."""
    text = call([program, "-n", "-x", "-j1", script], folder)
    if "Traceback" in text:
        raise Failed(f"{script}: {text.strip()[-1500:]}")
    return text


def relative(found_values, expected):
    """The largest difference over the largest expected value."""
    return float(np.max(np.abs(np.asarray(found_values) - expected)) / np.max(np.abs(expected)))


def result_of(folder):
    return json.loads((folder / "result.json").read_text())
