# SPDX-License-Identifier: GPL-3.0-or-later
"""Comparisons with published numbers, their verdicts, and the page and the report made of them."""
import math
import tomllib

from common import DATA, machine, markdown, published, rows_of

NUMBERS = published("validation/published")
STORED = published("validation/stored")  # ours, computed while the method was still there
SOURCES = {row["source"]: row["text"] for row in rows_of("validation/sources")}
TEXTS = tomllib.loads((DATA / "validation" / "texts.toml").read_text(encoding="utf-8"))
WHY = TEXTS["why"]
CONFIDENCE_WIDTH = 2.576  # standard errors of 99 % of a normal distribution
ROUND_OFF = 1e-12  # relative, of a computation of some thousand steps


class Comparison:
    """One published number beside ours, each with its standard error. `why`: the reason known for a difference;
    `allowance`: what the published number itself leaves out, added to its error."""
    def __init__(self, quantity, theirs, source, ours, why="", allowance=0.0, error=0.0):
        self.quantity, self.source, self.why, self.allowance = quantity, source, why, allowance
        self.theirs, self.ours = (float(theirs), float(error)), (float(ours[0]), float(ours[1]))

    @property
    def agrees(self):
        size = max(abs(self.theirs[0]), abs(self.ours[0]))
        error = math.hypot(self.theirs[1], self.ours[1], ROUND_OFF * size)
        return abs(self.ours[0] - self.theirs[0]) <= CONFIDENCE_WIDTH * error + self.allowance

    @property
    def verdict(self):
        if self.agrees:
            return "agrees"
        return f"differs by {self.ours[0] - self.theirs[0]:+.2g}" + (": " + self.why if self.why else "")

    def numbers(self):
        return {"quantity": self.quantity, "published": self.theirs[0], "published_error": self.theirs[1],
                "source": self.source, "ours": self.ours[0], "standard_error": self.ours[1], "agrees": self.agrees,
                "verdict": self.verdict}


class Findings:
    """What an item found."""
    def __init__(self, name, **values):
        kept = next(iter(STORED.values()))
        self.name, self.heading, self.text = name, TEXTS[name]["heading"], TEXTS[name]["text"].strip().format(**values)
        self.notes = [note.format(date=kept.date, commit=kept.commit) for note in TEXTS[name].get("notes", [])]
        self.comparisons, self.trends, self.tables, self.plots, self.seconds = [], [], {}, {}, 0.0

    def compare(self, quantity, name, ours, why="", allowance=0.0):
        """With the published number of that name."""
        row = NUMBERS[name]
        self.comparisons.append(Comparison(quantity, row.value, row.source, ours, why, allowance, row.error))

    def formula(self, quantity, formula, source, ours, why="", allowance=0.0):
        self.comparisons.append(Comparison(quantity, formula, source, ours, why, allowance))

    def trend(self, statement, source, holds, evidence):
        """A statement without a number."""
        self.trends.append({"statement": statement, "source": source, "holds": bool(holds), "evidence": evidence})

    @property
    def verdicts(self):
        return [one.agrees for one in self.comparisons] + [one["holds"] for one in self.trends]

    @property
    def sources(self):
        return list(dict.fromkeys([one.source for one in self.comparisons] + [one["source"] for one in self.trends]))


def step_error(*numbers):
    """The number of the finest step, and how far others are from it."""
    return numbers[-1], max(abs(number - numbers[-1]) for number in numbers)


def stored(name):
    return STORED[name].value, float(STORED[name].error)


# ---- the page

def shown(estimate):
    """"0.6601 ± 0.0012": two digits of the error; without an error ten digits."""
    value, error = estimate
    if not error > 1e-11 * abs(value):
        return f"{value:.10g}"
    decimals = min(max(1 - math.floor(math.log10(error)), 0), 12)
    return f"{value:.{decimals}f} ± {error:.{decimals}f}"


def seconds_text(seconds):
    return "under a second" if seconds < 1 else f"{seconds:.0f} s"


def page(sections, quick):
    """In Markdown, for the folder above that of the figures, which is called validation."""
    def command(only):
        return f"tools/papers/validation.py{only}{' --quick' if quick else ''} --out DIR"
    text = TEXTS["page"].lstrip("\n").format(command=command(""), machine=machine(),
                                             seconds=seconds_text(sum(section.seconds for section in sections)))
    text += markdown(["", "compared", "agree or hold", "source"], [
        [f"[{one.heading}](#{one.heading.replace(' ', '-').lower()})", str(len(one.verdicts)), str(sum(one.verdicts)),
         ", ".join(one.sources)] for one in sections]) + "\n"
    for one in sections:
        text += f"## {one.heading}\n\n{one.text}\n\n"
        text += "".join(f"![{plot.title}](validation/{name}.svg)\n\n" for name, plot in one.plots.items())
        if one.comparisons:
            text += markdown(["", "published", "source", "ours", "within the error"], [
                [c.quantity, shown(c.theirs), c.source, shown(c.ours), c.verdict] for c in one.comparisons]) + "\n"
        if one.trends:
            text += markdown(["statement", "source", "ours", ""], [
                [t["statement"], t["source"], t["evidence"], "holds" if t["holds"] else "**does not hold**"]
                for t in one.trends]) + "\n"
        text += "".join(note + "\n\n" for note in one.notes)
        text += f"`{command(f' --only {one.name}')}`: {seconds_text(one.seconds)}.\n\n"
    used = {source for one in sections for source in one.sources}
    return text + "## Sources\n\n" + "".join(f"- **{key}**: {words}.\n" for key, words in SOURCES.items() if key in used)


def report(sections):
    text = ""
    for one in sections:
        text += f"{one.heading}: {sum(one.verdicts)} of {len(one.verdicts)} agree or hold, {seconds_text(one.seconds)}\n"
        text += "".join(f"  {c.quantity}: {shown(c.theirs)} ({c.source}), ours {shown(c.ours)}, {c.verdict}\n"
                        for c in one.comparisons)
        text += "".join(f"  {t['statement']} ({t['source']}): {'holds' if t['holds'] else 'DOES NOT HOLD'}; {t['evidence']}\n"
                        for t in one.trends) + "\n"
    return text
