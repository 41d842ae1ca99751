#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""run_quadratic_spring.py PROGRAM: the program linked with a longer list of laws offers the law of the test and runs it."""

import json
import subprocess
import sys
import tempfile

CASE = """
schema = "equidem/1"
[grains]
body = "disc"
[[grain]]
position = [0.0, 0.0]
velocity = [1.0, 0.0]
radius = 0.1
density = 1000.0
[[grain]]
position = [0.3, 0.0]
velocity = [-1.0, 0.0]
radius = 0.1
density = 1000.0
[collisions]
law = "quadratic_spring"
restitution = 1.0
largest_overlap = 0.005
closing_speed = 2.0
[run]
duration = 0.1
integrator = "velocity_verlet"
"""


def run(*arguments):
    return subprocess.run([sys.argv[1], *arguments], capture_output=True, text=True, check=False)


help_text = " ".join(run("help", "case").stdout.split())
assert "quadratic_spring (Q): quadratic spring" in help_text, help_text
assert "quadratic_spring N/m^2" in help_text, help_text

with tempfile.NamedTemporaryFile("w", suffix=".toml") as case:
    case.write(CASE)
    case.flush()
    done = run("run", case.name, "--json", "-")
assert done.returncode == 0, done.stderr
result = json.loads(done.stdout)
assert "quadratic_spring (Q): quadratic spring, velocity Verlet" in result["report"], result["report"]
energy = result["energy"]
assert abs(energy["error"]) < 1e-3 * energy["kinetic"], energy
assert abs(energy["kinetic"] / 31.41592653589793 - 1) < 1e-3, energy
