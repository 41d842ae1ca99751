#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""The rules of the house that a compiler does not check.

    check_architecture.py FOLDER

reads a source tree and prints every broken rule, one per line, as "file:line: what is wrong". Exit code 1 if there is
one. The order of the rooms is read from lib/CMakeLists.txt; the lines of each room, the order of folders inside rooms,
short pairs of files, includes that run backwards and terms to avoid (docs/vocabulary.md) are listed in
tests/architecture/house.toml: these lists may only shrink.

    check_architecture.py FOLDER --lines

prints the lines of each room beside its limit and its budget,

    check_architecture.py FOLDER --lower

writes house.toml with what rooms and lists have shrunk to.
"""

import collections
import fnmatch
import os
import re
import sys
import tomllib

HOUSE = "tests/architecture/house.toml"
VOCABULARY = "docs/vocabulary.md"
SHORTEST_PAIR = 100  # lines of a pair NAME.cpp, NAME.hpp: one concept that a reader has
LONGEST_SOURCE = 800  # lines
WIDEST_LINE = 120  # characters
FULLEST_FOLDER = 30  # sources in one folder of lib or tools
LARGEST_SVG = 300_000  # bytes of a figure in data

# Third-party headers, the places that may include them (patterns of paths), and the number of files of lib/equidem that
# may do so.
PARTS = [
    ("fmt/*", ["lib/equidem/core/text.hpp"], 1),
    ("CGAL/*", ["lib/equidem/assembly/*"], 1),
    ("nlohmann/*", ["lib/equidem/assembly/*", "lib/equidem/output/*", "tests/*"], 2),
    ("toml++/*", ["lib/equidem/casefile/*"], 1),
    ("cholmod.h", ["lib/equidem/linear/*", "tools/bench/*"], 1),
    ("umfpack.h", ["lib/equidem/linear/*", "tools/bench/*"], 1),
    ("cblas.h", ["lib/equidem/linear/*", "lib/python/*"], 1),
    ("Eigen/*", ["lib/equidem/breakage/*", "lib/equidem/homogenize/*", "lib/equidem/statics/*", "lib/equidem/waves/*",
                 "tests/*"], 6),
    ("Spectra/*", ["lib/equidem/waves/*"], 1),
    ("boost/geometry/*", ["lib/equidem/contact/*"], 1),
    ("boost/math/*", ["lib/equidem/core/*", "lib/equidem/homogenize/*", "lib/equidem/waves/*"], 4),
    ("cairo*", ["lib/equidem/output/*"], 1),
    ("hdf5.h", ["lib/equidem/core/files/*"], 1),
    ("metis.h", ["tools/bench/*"], 0),
    ("benchmark/*", ["tools/bench/*"], 0),
    ("CLI/*", ["tools/*"], 0),
    ("pybind11/*", ["lib/python/*"], 0),
    ("petsc*", ["lib/petsc/*", "tools/mpi/main.cpp"], 0),
    ("catch2/*", ["tests/support/*"], 0),
]
# Headers of the operating system and the compiler.
SYSTEM = ["sys/*", "unistd.h", "dlfcn.h", "fcntl.h", "pthread.h", "poll.h", "spawn.h", "sched.h", "immintrin.h", "malloc.h"]

SOURCES = (".cpp", ".hpp", ".h", ".c", ".py")
SCRIPTS = ("tools/prepare", "tools/test", "tools/demo", "tools/docs", "tools/package", "docs/site/build", ".ci/run",
           ".ci/format", ".ci/headers", ".ci/tidy", ".ci/sanitize")
SPDX = "SPDX-License-Identifier: GPL-3.0-or-later"
# Places on the machine of whoever writes: absolute paths below these.
MACHINE_PATH = re.compile(r"(?<![\w./\-~$}{])/(?:%s)\b" % "|".join(["work", "tmp", "root", "home", "mnt", "Users"]))
# Types at file level of a header, where namespaces are not indented; declarations end in a semicolon.
NAMESPACE = re.compile(r"(?:inline )?namespace ?([\w:]*) \{$")
TYPE = re.compile(r"(?:template .*> )?(?:class|struct|enum class) (?:\[\[\w+\]\] |alignas\(\w+\) )?(\w+)\b"
                  r"(?!.*;\s*$|<|::)")
# Numbers that depend on the locale of the process: 0.25 is read as 0 where a comma is the decimal sign.
LOCALE = re.compile(r"std::sto(?:f|d|ld|i|l|ll|ul|ull)\(|\b(?:std::)?(?:atof|atoi|atol|strto(?:d|f|ld|l|ll|ul|ull)|v?s?n?scanf)\("
                    r"|\b(?:std::)?[fsv]*n?printf\([^;]*%[-+ #0-9.*]*l?[aefgAEFG]|std::to_string\([^)]*\.[0-9]"
                    r"|\bstd::[io]?stringstream\b|std::locale\b|\bsetlocale\(|std::(?:basic_)?regex\b")
LOCALE_PY = re.compile(r"^\s*(?:import locale\b|from locale\b)|locale\.(?:setlocale|atof|str|format_string)\(|\{\w*:[^{}: ]*n\}")
INCLUDE = re.compile(r'^\s*#\s*include\s*(["<])([^">]+)[">]')


def files_of(root):
    for folder, folders, names in os.walk(root):
        inside = os.path.relpath(folder, root)
        folders[:] = sorted(f for f in folders if f not in (".git", "__pycache__")
                            and not (inside == "." and f in ("build", "out", ".cache")))
        for name in sorted(set(names) - {".git"}):  # a file in a worktree
            yield os.path.normpath(os.path.join(inside, name))


def rooms_of(root):
    """The names listed in set(EQUIDEM_ROOMS ...), in their order."""
    with open(os.path.join(root, "lib/CMakeLists.txt"), encoding="utf-8") as file:
        text = re.sub(r"#.*", "", file.read())
    found = re.search(r"set\(EQUIDEM_ROOMS\s+([^)]*)\)", text)
    return found.group(1).split() if found else []


def room_of(path):
    parts = path.split(os.sep)
    return parts[2] if len(parts) > 3 and parts[:2] == ["lib", "equidem"] else None


def includes_of(text):
    for number, line in enumerate(text.splitlines(), 1):
        found = INCLUDE.match(line)
        if found:
            yield number, found.group(1), found.group(2)


def check_own_include(path, header, rooms):
    """An include of "equidem/ROOM/..." from a file of the library."""
    here, there = room_of(path), header.split("/")[1]
    if there not in rooms:
        return f"'{header}' is in no room of lib/CMakeLists.txt"
    if here is not None and rooms.index(there) > rooms.index(here):
        return f"room '{here}' includes '{header}', but '{there}' comes after it"
    return None


def check_foreign_include(path, header, used):
    """An include of <...>; `used` collects which files of the library include which part."""
    if not re.search(r"[/.]", header) or any(fnmatch.fnmatch(header, s) for s in SYSTEM):
        return None
    for pattern, places, most in PARTS:
        if fnmatch.fnmatch(header, pattern):
            if not any(fnmatch.fnmatch(path, place) for place in places):
                return f"<{header}> may be included only in {', '.join(places)}"
            if path.startswith("lib/equidem/"):
                used.setdefault(pattern, set()).add(path)
                if len(used[pattern]) > most:
                    return f"<{header}> is included in more than {most} file(s): {', '.join(sorted(used[pattern]))}"
            return None
    return f"<{header}> is no part that check_architecture.py knows; give it one place in PARTS"


def check_locale(path, text):
    """Numbers of the library and the programs are read by from_chars and written by fmt."""
    if not path.startswith(("lib/", "tools/")) or path.startswith("tools/bench/"):
        return
    pattern = LOCALE_PY if path.endswith(".py") else LOCALE
    for number, line in enumerate(text.splitlines(), 1):
        found = pattern.search(line.split("//")[0])
        if found:
            yield number, f"'{found.group().strip()}' depends on the locale: use number_from or fmt"


def check_source(path, text, rooms, used):
    if path.startswith("lib/equidem/") and room_of(path) not in rooms:
        yield 1, f"'{room_of(path) or path}' is no room of lib/CMakeLists.txt"
        return
    for number, kind, header in includes_of(text):
        if header.startswith("equidem/"):
            wrong = check_own_include(path, header, rooms)
        elif kind == "<":
            wrong = check_foreign_include(path, header, used)
        elif path.startswith("lib/equidem/"):
            wrong = f"'{header}' must be written as \"equidem/ROOM/...\""
        else:
            wrong = None
        if wrong:
            yield number, wrong
    length = text.count("\n")
    if length > LONGEST_SOURCE:
        yield LONGEST_SOURCE + 1, f"the file has {length} lines, more than {LONGEST_SOURCE}: split it"


def circles(includes):
    """Sets of files that include one another, directly or through others: strongly connected components (Tarjan)."""
    index, low, stack, found = {}, {}, [], []

    def visit(file):
        index[file] = low[file] = len(index)
        stack.append(file)
        for other in includes.get(file, ()):
            if other not in index:
                visit(other)
                low[file] = min(low[file], low[other])
            elif other in stack:
                low[file] = min(low[file], index[other])
        if low[file] == index[file]:
            at = stack.index(file)
            if len(stack) - at > 1 or file in includes.get(file, ()):
                found.append(sorted(stack[at:]))
            del stack[at:]

    for file in sorted(includes):
        if file not in index:
            visit(file)
    return found


def types_of(text):
    """Number of the line and full name of each type that a header defines outside all others."""
    inside = []
    for number, line in enumerate(text.splitlines(), 1):
        opens, defines = NAMESPACE.match(line), TYPE.match(line)
        if opens:
            inside.append(opens.group(1))
        elif line.startswith("}  // namespace"):
            inside = inside[:-1]
        elif defines:
            yield number, "::".join(inside + [defines.group(1)])


def check_types(path, text, types):
    """Two definitions of a name in one program are undefined behaviour that no linker tells."""
    for number, name in types_of(text):
        first = types.setdefault(name, path)
        if first != path:
            yield number, f"{first} defines {name}, too: rename one of them"


def check_folders(paths):
    count = {}
    for path in paths:
        if path.startswith(("lib/", "tools/")) and path.endswith((".cpp", ".hpp")):
            count[os.path.dirname(path)] = count.get(os.path.dirname(path), 0) + 1
    for folder, files in sorted(count.items()):
        if files > FULLEST_FOLDER:
            yield folder, 1, f"the folder has {files} sources, more than {FULLEST_FOLDER}: divide it by what they do"


def part_of(path, house):
    """The entry of [lines] that a source of lib or tools counts in, or None."""
    if not path.endswith((".cpp", ".hpp")) or not path.startswith(("lib/", "tools/")):
        return None
    inside = [part for part in house["lines"] if path.startswith(part + "/")]
    return max(inside, key=len) if inside else os.path.dirname(path)


def check_lines(texts, house):
    """Rooms do not grow unnoticed."""
    for part, length in sorted(lines_of(texts, house).items()):
        most = house["lines"].get(part, 0)
        if length > most:
            yield HOUSE, 1, (f"{part} has {length} lines, more than {most}: take lines away, or raise its number in "
                             "[lines] in the same commit and say why in its message (--lines shows all of them)")


def lines_of(texts, house):
    count = collections.Counter()
    for path, text in texts.items():
        part = part_of(path, house)
        if part:
            count[part] += text.count("\n")
    return count


def is_interface(text):
    """A header of functions that others implement."""
    return re.search(r"\)[^;{}]*= 0;", text) is not None


def is_entry(stem, text):
    """One entry of a list, which a recipe of CONTRIBUTING.md makes a file: a lattice, a verb."""
    return stem.startswith("lib/equidem/assembly/lattices/") or re.search(r"^Run declare_\w+\(", text, re.M) is not None


def short_pairs(texts):
    """Pairs of lib and tools below the least length, and their lines; main.cpp, interfaces and entries may be short."""
    pairs = collections.Counter()
    for path, text in texts.items():
        if path.endswith((".cpp", ".hpp")) and path.startswith(("lib/", "tools/")):
            stem = os.path.splitext(path)[0]
            may_be_short = is_interface(text) or is_entry(stem, text) or stem.endswith("/main")
            pairs[stem] += SHORTEST_PAIR if may_be_short else text.count("\n")
    return {stem: length for stem, length in pairs.items() if length < SHORTEST_PAIR}


def check_short_pairs(texts, house):
    short = short_pairs(texts)
    for stem, length in sorted(short.items()):
        if stem not in house["short"]:
            yield stem, 1, (f"the pair has {length} lines, fewer than {SHORTEST_PAIR}: put it where a reader looks for it "
                            "in a file of its folder")
    for stem in sorted(set(house["short"]) - set(short)):
        yield HOUSE, 1, f"{stem} is not short any more, or gone: take it from the list 'short'"


def backward_includes(texts, house):
    """Room: {"folder -> folder": files with an include of that kind} against the order of folders in [folders]."""
    found = {}
    for path, text in texts.items():
        room = room_of(path)
        if room not in house["folders"]:
            continue
        order, here = house["folders"][room], os.path.dirname(path).partition(f"lib/equidem/{room}")[2].strip("/") or "."
        for header in {header for _, _, header in includes_of(text) if header.startswith(f"equidem/{room}/")}:
            there = os.path.dirname(header[len(f"equidem/{room}/"):]) or "."
            if here in order and there in order and order.index(there) > order.index(here):
                arrow = f"{room}: {here} -> {there}"
                found.setdefault(arrow, set()).add(path)
    return found


def folders_of(texts):
    found = {}
    for path in texts:
        room = room_of(path)
        if room and path.endswith((".cpp", ".hpp")):
            inside = os.path.dirname(path).partition(f"lib/equidem/{room}")[2].strip("/") or "."
            found.setdefault(room, set()).add(inside)
    return {room: folders for room, folders in found.items() if len(folders) > 1}


def check_order_of_folders(texts, house):
    for room, folders in sorted(folders_of(texts).items()):
        for missing in sorted(folders - set(house["folders"].get(room, []))):
            yield f"lib/equidem/{room}", 1, f"folder '{missing}' has no place in the order of [folders] in {HOUSE}"
    found = backward_includes(texts, house)
    for arrow, files in sorted(found.items()):
        most = house["backward"].get(arrow, 0)
        if len(files) > most:
            yield min(files), 1, (f"{arrow} runs backwards in {len(files)} file(s), {most} at most: {', '.join(sorted(files))}")
    for arrow in sorted(set(house["backward"]) - set(found)):
        yield HOUSE, 1, f"'{arrow}' runs backwards nowhere any more: take it from [backward]"


def has_words(path):
    """A file that people read the words of: comments, messages, help, pages."""
    written = path.startswith(("lib/", "tools/")) and path.endswith((".cpp", ".hpp", ".py", ".txt", ".csv", ".html"))
    page = path.endswith(".md") and (path.startswith("docs/") or path in ("README.md", "CONTRIBUTING.md"))
    return (written or page) and path != VOCABULARY and not path.endswith("CMakeLists.txt")


def lines_with_words(texts, words):
    """Term: [(file, line)] for each term to avoid, a regular expression of whole words."""
    found = {}
    for term in words:
        pattern = re.compile(rf"\b(?:{term})\b", re.IGNORECASE)
        for path, text in texts.items():
            if pattern.search(text):
                found.setdefault(term, []).extend((path, number) for number, line in enumerate(text.splitlines(), 1)
                                                  if pattern.search(line))
    return found


def check_words(texts, house):
    for term, places in lines_with_words(texts, house["words"]).items():
        most = house["words"][term]
        if len(places) > most:
            path, number = places[-1]
            yield path, number, (f"'{term}' stands in {len(places)} lines, {most} at most: {VOCABULARY} has another term, "
                                 "or lower the number of others")


def house_of(root):
    empty = {"lines": {}, "budget": {}, "folders": {}, "backward": {}, "short": [], "words": {}}
    path = os.path.join(root, HOUSE)
    if not os.path.exists(path):
        return None
    with open(path, "rb") as file:
        return {**empty, **tomllib.load(file)}


def check_house(texts, root):
    house = house_of(root)
    if house is None:
        return
    yield from check_lines(texts, house)
    yield from check_short_pairs(texts, house)
    yield from check_order_of_folders(texts, house)


def sources_of(root, wanted=lambda path: path.endswith((".cpp", ".hpp")) and path.startswith(("lib/", "tools/"))):
    texts = {}
    for path in files_of(root):
        if wanted(path):
            with open(os.path.join(root, path), encoding="utf-8") as file:
                texts[path] = file.read()
    return texts


def print_lines(root):
    texts, house = sources_of(root), house_of(root)
    count = lines_of(texts, house)
    files = collections.Counter(part_of(path, house) for path in texts)
    print(f"{'part':28}{'files':>7}{'lines':>8}{'limit':>8}{'budget':>8}")
    for part in sorted(set(count) | set(house["lines"]), key=lambda p: -count[p]):
        print(f"{part:28}{files[part]:7}{count[part]:8}{house['lines'].get(part, 0):8}{house['budget'].get(part, 0):8}")
    print(f"{'all':28}{len(texts):7}{sum(count.values()):8}{sum(house['lines'].values()):8}{sum(house['budget'].values()):8}")


def lower(root):
    """house.toml with the numbers and lists of today where these are smaller; what grew keeps its old number."""
    texts, house = sources_of(root), house_of(root)
    count, short, backward = lines_of(texts, house), short_pairs(texts), backward_includes(texts, house)
    lines = {part: min(most, count[part]) for part, most in house["lines"].items() if count[part]}
    folders = {room: [f for f in order if f in folders_of(texts).get(room, ())] for room, order in house["folders"].items()}
    kept = {"lines": lines, "budget": house["budget"], "folders": {r: f for r, f in folders.items() if len(f) > 1},
            "backward": {a: min(n, len(backward[a])) for a, n in house["backward"].items() if a in backward},
            "short": [stem for stem in house["short"] if stem in short]}
    words = lines_with_words(sources_of(root, has_words), house["words"])
    kept["words"] = {term: min(most, len(words.get(term, ()))) for term, most in house["words"].items()}
    with open(os.path.join(root, HOUSE), encoding="utf-8") as file:
        head = "".join(line for line in file if line.startswith("#"))
    with open(os.path.join(root, HOUSE), "w", encoding="utf-8") as file:
        file.write(head + "\n" + text_of(kept))


def text_of(house):
    rows = ["short = ["] + [f'  "{stem}",' for stem in sorted(house["short"])] + ["]"]
    for table in ("lines", "budget", "folders", "backward", "words"):
        rows += ["", f"[{table}]"] + [f'"{key}" = {json_of(value)}' for key, value in house[table].items()]
    return "\n".join(rows) + "\n"


def json_of(value):
    return str(value).replace("'", '"')


def has_licence(path, text):
    lines = text.splitlines()[:2]
    return any(SPDX in line for line in (lines[:2] if lines and lines[0].startswith("#!") else lines[:1]))


def is_source(path):
    return path.endswith(SOURCES + (".cmake",)) or path.endswith("CMakeLists.txt") or path in SCRIPTS


def violations(root):
    rooms = rooms_of(root)
    if not rooms:
        yield "lib/CMakeLists.txt", 1, "it lists no rooms in set(EQUIDEM_ROOMS ...)"
        return
    used, includes, types, sources, words, paths = {}, {}, {}, {}, {}, list(files_of(root))
    yield from check_folders(paths)
    for path in paths:
        full = os.path.join(root, path)
        if path.startswith("data/") and path.endswith(".svg") and os.path.getsize(full) > LARGEST_SVG:
            yield path, 1, f"the figure has {os.path.getsize(full)} bytes, more than {LARGEST_SVG}: keep its PNG alone"
        if os.path.islink(full) or os.path.getsize(full) > 1_000_000:
            continue
        try:
            with open(full, encoding="utf-8") as file:
                text = file.read()
        except UnicodeDecodeError:
            continue
        if path.startswith(("lib/", "tools/")) and path.endswith((".cpp", ".hpp")):
            sources[path] = text
        if has_words(path):
            words[path] = text
        if is_source(path) and not has_licence(path, text):
            yield path, 1, f"the first line is not '{SPDX}'"
        if path.endswith(SOURCES):
            for number, wrong in (*check_source(path, text, rooms, used), *check_locale(path, text)):
                yield path, number, wrong
        if path.startswith(("lib/", "tools/")) and not path.startswith("tools/bench/") and path.endswith(".hpp"):
            for number, wrong in check_types(path, text, types):
                yield path, number, wrong
        if path.startswith("lib/") and path.endswith(".hpp"):
            includes[path] = ["lib/" + header for _, _, header in includes_of(text) if header.startswith("equidem/")]
        for number, line in enumerate(text.splitlines(), 1):
            script = path.endswith(".py") and path.startswith(("tests/", "tools/"))
            if is_source(path) and not script and len(line) > WIDEST_LINE:
                yield path, number, f"the line has {len(line)} characters, more than {WIDEST_LINE}"
            if MACHINE_PATH.search(line) and not line.startswith("#!"):
                yield path, number, f"a path of one machine: {line.strip()[:100]}"
    yield from check_house(sources, root)
    yield from check_words(words, house_of(root) or {"words": {}})
    for circle in circles(includes):
        yield circle[0], 1, f"headers include one another: {', '.join(circle)}"


def main():
    if sys.argv[2:] == ["--lines"]:
        return print_lines(sys.argv[1])
    if sys.argv[2:] == ["--lower"]:
        return lower(sys.argv[1])
    count = 0
    for path, number, wrong in violations(sys.argv[1]):
        print(f"{path}:{number}: {wrong}")
        count += 1
    print(f"{count} broken rule(s)" if count else f"rooms in order: {' '.join(rooms_of(sys.argv[1]))}")
    return 1 if count else 0


if __name__ == "__main__":
    sys.exit(main())
