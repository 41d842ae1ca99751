#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Follows recipes of CONTRIBUTING.md: a lattice, a packing method, a linear solver and a verb are added.

    follow_recipes.py SOURCE BUILD PROGRAM OBJECTS

copies each list to a temporary folder, adds one file and the lines of the list, compiles these files and those that use
the lists, links them in front of the objects of the program (OBJECTS: a file with one path a line) and its libraries, and
runs the new program. A recipe may touch no files but the two that CONTRIBUTING.md names.
"""

import concurrent.futures
import json
import os
import re
import shlex
import shutil
import subprocess
import sys
import tempfile

RECIPES = {
    "A lattice": {
        "file": ("lib/equidem/assembly/lattices/triangular.hpp", "triangular.hpp"),
        "list": "lib/equidem/assembly/lattices.cpp",
        "lines": [(r'(#include "equidem/assembly/lattices\.hpp"\n)',
                   r'\1#include "equidem/assembly/lattices/triangular.hpp"\n'),
                  (r"(lattices::hexagonal,\n)", r"\1    lattices::triangular,\n")],
        "users": r"$^",
    },
    "A packing method": {
        "file": ("lib/equidem/packing/methods/grid.cpp", "grid.cpp"),
        "list": "lib/equidem/packing/packing.hpp",
        "lines": [(r"FillBox fill_by_rejection,", "FillBox fill_by_grid, fill_by_rejection,"),
                  (r"(enum class PackingMethod \{[^}]*falling)", r"\1, grid"),
                  (r"(\.bytes_of_body = 1200\},\n)",
                   r'\1      {PackingMethod::grid, "grid", "in square cells", "passes", fill_by_grid},\n')],
        "users": r"\bPackingMethod\b|entry_of\(options\.method\)",
    },
    "A linear solver": {
        "file": ("lib/equidem/linear/dense_cholesky.cpp", "dense_cholesky.cpp"),
        "list": "lib/equidem/linear/linear_solver.hpp",
        "lines": [(r"(std::unique_ptr<Factorization> factorize_by_)(cholmod)(\([^;]*;\n)", r"\1dense\3\1\2\3"),
                  (r"(enum class SolverMethod \{[^}]*umfpack)", r"\1, dense"),
                  (r"(\.factorize = factorize_by_umfpack\}\},\n)",
                   r'\1      {SolverMethod::dense, "dense", "Cholesky of the full matrix",\n'
                   r"       {.definite_only = true, .factorize = factorize_by_dense}},\n")],
        "users": r"\bSolverMethod\b|entry_of\(options\.method\)",
    },
    "A verb": {
        "file": ("tools/equidem/count.cpp", "count.cpp"),
        "list": "tools/equidem/verbs.hpp",
        "lines": [(r"(Run declare_study\(CLI::App& command\);\n)", r"\1Run declare_count(CLI::App& command);\n"),
                  (r'(\n\};\n\n\}  // namespace)', r'\n    Verb{"count", "number of discs", declare_count},\1')],
        "users": r"$^",
    },
}


def paragraph_of(text, heading):
    """The recipe with this heading: from "**A lattice.**" to the next empty line."""
    found = re.search(r"\*\*%s\.\*\*.*?(?=\n\n|\Z)" % re.escape(heading), text, re.S)
    assert found, f"CONTRIBUTING.md has no recipe '{heading}'"
    return found.group(0)


def add(source, folder, heading, recipe):
    """Write the new file and the changed list; returns the sources to compile."""
    path, example = recipe["file"]
    text = open(os.path.join(source, "CONTRIBUTING.md"), encoding="utf-8").read()
    for name in (os.path.dirname(path), recipe["list"]):
        assert name in paragraph_of(text, heading), f"the recipe '{heading}' does not name {name}"
    assert not os.path.exists(os.path.join(source, path)), f"{path} exists: give the example of this recipe another name"
    text = open(os.path.join(source, recipe["list"]), encoding="utf-8").read()
    for pattern, replacement in recipe["lines"]:
        text, count = re.subn(pattern, replacement, text, count=1)
        assert count == 1, f"{recipe['list']} has no place for: {replacement}"
    for name in (path, recipe["list"]):
        os.makedirs(os.path.dirname(os.path.join(folder, name)), exist_ok=True)
    shutil.copy(os.path.join(os.path.dirname(os.path.abspath(__file__)), "examples", example), os.path.join(folder, path))
    with open(os.path.join(folder, recipe["list"]), "w", encoding="utf-8") as file:
        file.write(text)
    return [os.path.join(folder, p) for p in (path, recipe["list"]) if p.endswith(".cpp")]


def users_of(source, pattern):
    """Sources of the library and the program that read a list."""
    found = []
    for top in ("lib/equidem", "tools/equidem"):
        for folder, _, names in os.walk(os.path.join(source, top)):
            for name in names:
                path = os.path.join(folder, name)
                if name.endswith(".cpp") and re.search(pattern, open(path, encoding="utf-8").read()):
                    found.append(path)
    return found


def flags_of(build):
    """How the program is compiled, without optimization and output."""
    entry = next(e for e in json.load(open(os.path.join(build, "compile_commands.json"), encoding="utf-8"))
                 if "equidem_program.dir" in e["command"])
    words = shlex.split(entry["command"])
    compiler = next(k for k, w in enumerate(words) if not re.search(r"ccache|launcher", w))
    kept, skip = [], False
    for word in words[compiler + 1:]:
        if skip:
            skip = False
        elif word in ("-include", "-o", "-c", "-MT", "-MF", "-Xclang", "-include-pch"):
            skip = True
        elif not re.match(r"-(O\d|g\d?$|M|Winvalid-pch|fpch|Werror)", word):
            kept.append(word)
    return words[compiler], kept


def shared_libraries(program):
    """Paths of the libraries that the program names."""
    needed = re.findall(r"NEEDED.*\[(.*)\]", subprocess.run(["readelf", "-d", program], capture_output=True, text=True,
                                                           check=True).stdout)
    paths = dict(re.findall(r"^\s*(\S+) => (\S+)", subprocess.run(["ldd", program], capture_output=True, text=True,
                                                                 check=True).stdout, re.M))
    return [paths[name] for name in needed if name in paths and not re.match(r"lib(c|m|stdc\+\+|gcc_s)\.so", name)]


def units_of(folder, sources):
    """One file for the sources of each room, which reads their headers once, as most presets do; main.cpp stays alone."""
    rooms = {}
    for path in sources:
        room = re.search(r"(lib/equidem/\w+|tools/equidem)/", path).group(1)
        rooms.setdefault("main" if path.endswith("/main.cpp") else room, []).append(path)
    units = []
    for paths in rooms.values():
        units.append((os.path.join(folder, f"unit{len(units)}.cpp"), sorted({os.path.dirname(path) for path in paths})))
        with open(units[-1][0], "w", encoding="utf-8") as file:
            file.writelines(f'#include "{os.path.abspath(path)}"\n' for path in paths)
    return units


def build_program(source, build, program, objects, folder, sources):
    compiler, flags = flags_of(build)
    first = ["-I" + os.path.join(folder, p) for p in ("lib", "tools/equidem")]
    units = units_of(folder, sources)
    made = [os.path.join(folder, f"object{k}.o") for k in range(len(units))]

    def compile_one(k):
        # The lists are found in the temporary folder first, everything else beside the source.
        path, folders = units[k]
        beside = ["-I" + folder for folder in folders]
        subprocess.run([compiler, *first, *flags, *beside, "-O0", "-c", path, "-o", made[k]], check=True)

    with concurrent.futures.ThreadPoolExecutor(os.cpu_count()) as pool:
        list(pool.map(compile_one, range(len(units))))
    old = [o for o in open(objects, encoding="utf-8").read().split() if o.endswith(".o") and not o.endswith("main.cpp.o")]
    archives = [os.path.join(f, n) for top in ("lib", "tools") for f, _, names in os.walk(os.path.join(build, top))
                for n in names if n.startswith("libequidem") and n.endswith(".a")]
    result = os.path.join(folder, "equidem")
    # The linker keeps the first of several definitions: the new objects, in front of those that they replace.
    subprocess.run([compiler, *(f for f in flags if f.startswith("-fsanitize")), "-Wl,--allow-multiple-definition", *made,
                    *old, "-Wl,--start-group", *archives, "-Wl,--end-group", *shared_libraries(program), "-lpthread",
                    "-ldl", "-o", result], check=True)
    return result


def run(program, *arguments, exit_code=0):
    done = subprocess.run([program, *arguments], capture_output=True, text=True, check=False)
    assert done.returncode == exit_code, f"{arguments}: exit code {done.returncode}\n{done.stdout}{done.stderr}"
    return done.stdout if exit_code == 0 else done.stderr


def result(program, *arguments):
    return json.loads(run(program, *arguments, "--json", "-", "--quiet"))


def check(new, source):
    case = os.path.join(source, "data/cases/")
    block = case + "abe1996_fig6.toml"
    hexagonal = result(new, "solve", block)
    triangular = result(new, "solve", block, "--set", "assembly.kind=triangular")
    assert triangular["poisson_ratio"] == hexagonal["poisson_ratio"], (triangular, hexagonal)
    assert '"triangular"' in run(new, "solve", block, "--set", "assembly.kind=triangle", exit_code=2)

    grid = result(new, "pack", case + "pack_jammed.toml", "--set", "packing.method=grid", "--set", "packing.grains=50")
    assert grid["status"] == "done" and grid["grains"] == 50, grid

    small = ["--set", "assembly.columns=5", "--set", "assembly.rows=5"]
    ours = result(new, "solve", block, *small)
    dense = result(new, "solve", block, *small, "--set", "solver.method=dense")
    assert abs(dense["poisson_ratio"] - ours["poisson_ratio"]) < 1e-12, (dense, ours)
    assert "positive definite" in run(new, "solve", block, *small, "--set", "solver.method=dense", "--set",
                                      "springs.kT=-0.1e9", exit_code=2)

    assert result(new, "count", block, *small)["discs"] == 23
    text = run(new, "help", "case")
    for name in ("triangular", "grid", "dense"):
        assert name in text, f"'help case' does not name {name}"
    assert "count" in run(new, "--help")


def main():
    source, build, program, objects = sys.argv[1:]
    with tempfile.TemporaryDirectory() as folder:
        sources, users = [], set()
        for heading, recipe in RECIPES.items():
            sources += add(source, folder, heading, recipe)
            users |= set(users_of(source, recipe["users"]))
        # A quoted include is searched beside the including file first: users of verbs.hpp are compiled beside the new list.
        for name in ("main.cpp", "verbs.cpp"):
            users.discard(os.path.join(source, "tools/equidem", name))
            sources.append(shutil.copy(os.path.join(source, "tools/equidem", name), os.path.join(folder, "tools/equidem")))
        sources += sorted(users)
        new = build_program(source, build, program, objects, folder, sources)
        check(new, source)
    print(f"{len(RECIPES)} recipes followed, {len(sources)} files compiled: "
          f"{', '.join(os.path.basename(s) for s in sources)}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
