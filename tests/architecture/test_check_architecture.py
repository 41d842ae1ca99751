#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""The architecture check can fail: small trees, each with one broken rule, and one without."""

import os
import sys
import tempfile
import unittest

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
from check_architecture import SPDX, text_of, violations  # noqa: E402

LISTS = f"# {SPDX}\nset(EQUIDEM_ROOMS\n  core      # first\n  contact   # needs core (and nothing else)\n  output\n)\n"
GOOD = {
    "lib/CMakeLists.txt": LISTS,
    "lib/equidem/core/error.hpp": "#include <string>\n",
    "lib/equidem/core/text.hpp": "#include <fmt/format.h>\n",
    "lib/equidem/contact/spring.cpp": '#include "equidem/core/error.hpp"\n#include <sys/mman.h>\n',
    "lib/equidem/output/picture.cpp": '#include "equidem/contact/spring.hpp"\n#include <cairo/cairo.h>\n',
    "tools/equidem/main.cpp": '#include "equidem/output/picture.hpp"\n#include <CLI/CLI.hpp>\n#include "verb.hpp"\n',
    "tests/support/catch.hpp": "#include <catch2/catch.hpp>\n",
    "README.md": "Run tools/demo; see https://example.org/work/home.\n",
}


def violations_of(changes):
    """What the check says of the good tree with some files replaced or added."""
    with tempfile.TemporaryDirectory() as root:
        for path, text in {**GOOD, **changes}.items():
            full = os.path.join(root, path)
            os.makedirs(os.path.dirname(full), exist_ok=True)
            if path.endswith((".cpp", ".hpp")) and not text.startswith("//"):
                text = f"// {SPDX}\n{text}"
            with open(full, "w", encoding="utf-8") as file:
                file.write(text)
        return [f"{path}:{number}: {wrong}" for path, number, wrong in violations(root)]


class TheCheck(unittest.TestCase):
    def fails_with(self, changes, *parts):
        found = violations_of(changes)
        self.assertEqual(len(found), 1, found)
        for part in parts:
            self.assertIn(part, found[0])

    def test_accepts_a_tree_in_order(self):
        self.assertEqual(violations_of({}), [])

    def test_each_broken_rule_is_found_in_its_file(self):
        licensed = "// " + SPDX
        wide = f"{licensed}\n//" + "é" * 118 + "\n"
        for file, text, *parts in (
                ("lib/equidem/core/error.cpp", '#include "equidem/contact/spring.hpp"\n',
                 "lib/equidem/core/error.cpp:2", "'contact' comes after it"),
                ("lib/equidem/core/error.cpp", "#include <equidem/contact/spring.hpp>\n", "'contact' comes after it"),
                ("lib/equidem/core/error.cpp", '#include "../contact/spring.hpp"\n', "must be written as"),
                ("lib/equidem/contact/law.hpp", '#  include "equidem/output/picture.hpp"\n',
                 "room 'contact' includes 'equidem/output/picture.hpp'"),
                ("lib/equidem/extra/a.cpp", "\n", "'extra' is no room"),
                ("tools/equidem/run.cpp", '#include "equidem/extra/a.hpp"\n', "in no room"),
                ("lib/equidem/contact/law.cpp", "#include <fmt/format.h>\n",
                 "<fmt/format.h> may be included only in lib/equidem/core/text.hpp"),
                ("tests/core/test_a.cpp", "#include <catch2/catch.hpp>\n", "tests/support/"),
                ("lib/equidem/core/error.cpp", "#include <CGAL/Kernel.h>\n", "lib/equidem/assembly/"),
                ("lib/equidem/output/canvas.cpp", "#include <cairo/cairo-svg.h>\n", "more than 1 file(s)",
                 "canvas.cpp", "picture.cpp"),
                ("lib/equidem/contact/law.cpp", "#include <boost/any.hpp>\n", "is no part"),
                *(("lib/equidem/core/a.cpp", f"{licensed}\n{line}\n", "a.cpp:2", "depends on the locale") for line in (
                    "double x = std::stod(word);", "double x = atof(word);", "double x = strtod(word, nullptr);",
                    'snprintf(text, 9, "%.3g", x);', "std::istringstream in(text);", "std::ostringstream out;")),
                ("lib/python/a.py", f"# {SPDX}\nimport locale\n", "a.py:2", "depends on the locale"),
                ("lib/equidem/core/error.hpp", "// A comment.\n", "SPDX"), ("cmake/more.cmake", "set(a b)\n", "SPDX"),
                ("tools/demo", "#!/bin/bash\nset -e\n", "SPDX"), ("lib/equidem/core/error.hpp", "\n" * 800, "has 801 lines"),
                ("lib/equidem/core/error.hpp", wide + "/" * 121, "error.hpp:3", "has 121 characters"),
                ("cmake/more.cmake", f"# {SPDX}\n" + "#" * 121, "cmake/more.cmake:2", "has 121 characters"),
                ("data/a/figure.svg", "<svg>" + " " * 300_000, "data/a/figure.svg:1", "keep its PNG alone"),
                *(("README.md", f"Look into /{place}.\n", "README.md:1: a path of one machine")
                  for place in ("work/main", "tmp/x", "root", "home/me")),
                ("lib/CMakeLists.txt", f"# {SPDX}\n# set(EQUIDEM_ROOMS core)\n", "lists no rooms")):
            with self.subTest(file=file, parts=parts):
                self.fails_with({file: text}, *parts)

    def test_what_is_near_a_broken_rule_is_accepted(self):
        fine = 'fprintf(stderr, "%s", text);\nstd::to_string(count);\nto_string(kind);\n'
        for file, text in (("tools/a.cpp", f"// {SPDX}\n{fine}"), ("lib/equidem/core/error.hpp", "\n" * 399),
                           ("lib/equidem/core/error.hpp", f"// {SPDX}\n//" + "é" * 118 + "\n")):
            self.assertEqual(violations_of({file: text}), [])

    def test_rejects_headers_that_include_one_another(self):
        include = '#include "equidem/core/{}.hpp"\n'
        self.fails_with({"lib/equidem/core/a.hpp": include.format("b"), "lib/equidem/core/b.hpp": include.format("c"),
                         "lib/equidem/core/c.hpp": include.format("a")}, "core/a.hpp, lib/equidem/core/b.hpp, lib")
        self.fails_with({"lib/equidem/core/a.hpp": include.format("a")}, "include one another")

    def test_rejects_two_types_of_one_name(self):
        header = "namespace equidem{} {{\nstruct Table;\n{} Table {{\n  int rows;\n}};\n}}  // namespace equidem{}\n"
        first = {"lib/equidem/core/a.hpp": header.format("", "struct", "")}
        self.fails_with({**first, "lib/equidem/output/b.hpp": header.format("", "class", "")},
                        "lib/equidem/output/b.hpp:4: lib/equidem/core/a.hpp defines equidem::Table, too")
        other = header.format("::out", "class", "::out")
        self.assertEqual(violations_of({**first, "lib/equidem/output/b.hpp": other}), [])

    def test_rejects_a_folder_that_is_too_full(self):
        files = {f"tools/equidem/file{k}.cpp": "\n" for k in range(30)}
        self.fails_with(files, "tools/equidem:1", "has 31 sources")
        self.assertEqual(violations_of(dict(list(files.items())[:29])), [])

    def house(self, **changes):
        lines = {"lib/equidem/core": 2, "lib/equidem/contact": 3, "lib/equidem/output": 3, "tools/equidem": 4,
                 **changes.pop("lines", {})}
        short = ["lib/equidem/core/error", "lib/equidem/core/text", "lib/equidem/contact/spring", "lib/equidem/output/picture"]
        parts = {"lines": lines, "budget": {}, "folders": {}, "backward": {}, "short": short, "words": {}, **changes}
        return {"tests/architecture/house.toml": text_of(parts),
                "lib/equidem/core/error.hpp": f"// {SPDX}\n", "lib/equidem/core/text.hpp": f"// {SPDX}\n"}

    def test_rejects_a_room_that_grows(self):
        self.assertEqual(violations_of(self.house()), [])
        self.fails_with(self.house(lines={"lib/equidem/contact": 2}), "lib/equidem/contact has 3 lines, more than 2")
        self.assertEqual(violations_of(self.house(lines={"lib/equidem/contact": 9})), [])
        extra = {"tools/new/main.cpp": "int main() {}\n"}
        self.fails_with({**self.house(), **extra}, "tools/new has 2 lines, more than 0")

    def test_rejects_a_short_pair_that_is_not_listed(self):
        extra = {"tools/equidem/verb.cpp": "\n" * 59, "tools/equidem/verb.hpp": "\n" * 38}
        house = self.house(lines={"tools/equidem": 200})
        self.fails_with({**house, **extra}, "tools/equidem/verb:1", "has 99 lines, fewer than 100")
        self.assertEqual(violations_of({**house, **extra, "tools/equidem/verb.hpp": "\n" * 39}), [])
        interface = {"tools/equidem/verb.hpp": "struct Verb {\n  virtual void run() = 0;\n};\n"}
        self.assertEqual(violations_of({**house, **interface}), [])
        self.fails_with({**house, "lib/equidem/core/error.cpp": "\n" * 100,
                         **self.house(lines={"lib/equidem/core": 200})}, "core/error is not short any more")

    def test_rejects_a_backward_include_between_folders_of_a_room(self):
        wide = "\n" * 100
        below = {"lib/equidem/core/files/a.hpp": wide, "lib/equidem/core/b.cpp": '#include "equidem/core/files/a.hpp"\n' + wide}
        lines = {"lib/equidem/core": 400}
        wrong = violations_of({**self.house(lines=lines), **below})
        self.assertEqual(len(wrong), 2, wrong)  # the room itself and its folder have no place
        self.assertIn("has no place in the order", wrong[0])
        order = {"folders": {"core": ["files", "."]}}
        self.assertEqual(violations_of({**self.house(lines=lines, **order), **below}), [])
        back = {"folders": {"core": [".", "files"]}}
        self.fails_with({**self.house(lines=lines, **back), **below},
                        "core/b.cpp:1: core: . -> files runs backwards in 1 file(s)")
        allowed = {**back, "backward": {"core: . -> files": 1}}
        self.assertEqual(violations_of({**self.house(lines=lines, **allowed), **below}), [])
        self.fails_with(self.house(backward={"core: . -> files": 1}), "runs backwards nowhere any more")

    def test_rejects_more_lines_with_a_term_to_avoid(self):
        words = {"rub(?:s|bing)?": 1, "push": 0}
        code = {"lib/equidem/core/text.hpp": f"// {SPDX}\n// Two discs rub.\nvoid f() {{ v.push_back(1); }}  // the rubber\n"}
        house = self.house(lines={"lib/equidem/core": 9}, words=words)
        self.assertEqual(violations_of({**house, **code}), [])
        self.fails_with({**house, **code, "docs/page.md": "Contacts that are Rubbing.\n"}, "stands in 2 lines, 1 at most")
        self.fails_with({**house, **code, "docs/page.md": "They push.\n"}, "docs/page.md:1: 'push'")
        self.assertEqual(violations_of({**house, **code, "docs/vocabulary.md": "Avoid push.\n"}), [])


if __name__ == "__main__":
    unittest.main()
