# SPDX-License-Identifier: GPL-3.0-or-later
"""The figure of data/laboratory.md: what a test reads over what is expected."""
import re

from tables import rows_of


def number(cell):
    found = re.match(r"-?[\d.]+(e[+-]?\d+)?", cell)
    return float(found[0]) if found else None


def draw(folder):
    import figures

    ratios, base = [], ""
    for row in rows_of(folder / "the_tests_beside_what_is_expected.csv"):
        name = row["test"]
        if name.startswith("the same"):
            name = (base + name.removeprefix("the same")).replace("across the loaded diameter at the centre, along it", "along it at the centre")
        else:
            base = name.partition(",")[0]
        read, expected = number(row["read"]), number(row["expected"])
        if read is not None and expected is not None:
            ratios.append((re.split(r", (?:Pa|N/m²?|J/m|before)", name)[0], read / expected))
    figures.dots(folder / "read_over_expected", ratios, "read over expected")
