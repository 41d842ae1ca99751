# SPDX-License-Identifier: GPL-3.0-or-later
"""Comparisons with published numbers and their verdicts, and what is only stored."""
import math

from common import published, rows_of
from shown import Row, told_of

NUMBERS = published("validation/published")
# Numbers of ours beside published ones, computed while the method was still there: shown, not judged.
STORED = rows_of("validation/stored")
WHY = told_of("validation")["why"]
CONFIDENCE_WIDTH = 2.576  # standard errors of 99 % of a normal distribution
ROUND_OFF = 1e-12  # relative, of a computation of some thousand steps


class Findings:
    """What an item found: rows of comparisons, statements and tables, and `values` of its text and its figures."""
    def __init__(self, name, /, **values):
        self.name, self.values = name, values
        self.comparisons, self.trends, self.notes, self.tables, self.seconds = [], [], [], {}, 0.0
        self.stored = [row for row in STORED if row.item == name]

    def formula(self, quantity, theirs, source, ours, why="", allowance=0.0, error=0.0):
        """A number of a source beside ours, each with its standard error. `why`: the reason known for a difference;
        `allowance`: what the published number itself leaves out, added to its error."""
        (number, own_error), theirs = map(float, ours), float(theirs)
        size = max(abs(theirs), abs(number))
        allowed = CONFIDENCE_WIDTH * math.hypot(error, own_error, ROUND_OFF * size) + allowance
        agrees = abs(number - theirs) <= allowed
        verdict = "agrees" if agrees else f"differs by {number - theirs:+.2g}" + (": " + why if why else "")
        self.comparisons.append(Row(
            quantity=quantity, published=theirs, published_error=float(error), source=source, ours=number,
            standard_error=own_error, agrees=agrees, verdict=verdict))

    def compare(self, quantity, name, ours, why="", allowance=0.0):
        """With the published number of that name."""
        row = NUMBERS[name]
        self.formula(quantity, row.value, row.source, ours, why, allowance, float(row.error))

    def trend(self, statement, source, holds, evidence):
        """A statement without a number."""
        self.trends.append(Row(statement=statement, source=source, holds=bool(holds), evidence=evidence))

    @property
    def verdicts(self):
        return [one.agrees for one in self.comparisons] + [one.holds for one in self.trends]

    @property
    def sources(self):
        return list(dict.fromkeys(one.source for one in (*self.comparisons, *self.trends, *self.stored)))


def step_error(*numbers):
    """The number of the finest step, and how far others are from it."""
    return numbers[-1], max(abs(number - numbers[-1]) for number in numbers)


def value_and_error(mean):
    return mean.mean, mean.standard_error


def columns(means):
    return [mean.mean for mean in means], [mean.standard_error for mean in means]
