#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""The page that --out writes beside the files: run_result_pages.py PROGRAM SOURCE_FOLDER [unittest options]."""
import html.parser
import json
import os
import shutil
import subprocess
import unittest
import zlib

from program import CASES, PROGRAM, TENSION, ProgramTest, equidem

VOID = {"meta", "img", "input", "br", "hr"}
CHROMIUM = shutil.which("chromium") or shutil.which("chromium-browser")
# Each verb with a small case, and numbers of result.json that its page shows.
VERBS = {
    "solve": ([TENSION, "--set", "assembly.columns=9", "--set", "assembly.rows=9"],
              ["poisson_ratio", "plane_strain.young_modulus", "relative_residual", "error_bound"]),
    "homogenize": ([CASES / "random_cell.toml", "--set", "assembly.discs=60"],
                   ["young_modulus.plane_strain", "poisson_ratio.plane_strain", "shear_modulus", "relative_residual"]),
    "ensemble": (["homogenize", CASES / "ensemble.toml", "--set", "ensemble.discs=[30,40]", "--set", "ensemble.samples=3"],
                 ["ensemble.-1.young_modulus.plane_strain.mean"]),
    "calibrate": ([CASES / "calibrate_random.toml", "--set", "assembly.discs=100"], ["kN", "kT", "achieved.poisson_ratio.plane_strain"]),
    "stability": ([CASES / "hexagonal_cell.toml"], ["critical_ratio", "critical_time_step"]),
    "pack": ([CASES / "pack_jammed.toml", "--set", "packing.grains=60", "--set", "packing.box=[0.13,0.13]"],
             ["solid_fraction", "coordination_number"]),
    "run": ([CASES / "run_pulse.toml"], ["energy.kinetic", "energy.relative_error", "time"]),
    "rest": (["run", CASES / "run_tension.toml"], ["poisson_ratio", "relative_unbalanced_force"]),
    "grains": (["run", CASES / "grains_cradle.toml"], ["energy.kinetic", "time"]),
    "sweep": ([TENSION, "--set", "assembly.columns=9", "--set", "assembly.rows=9", "--key", "ratio", "--from", "0", "--to", "1",
               "--steps", "3"], []),
    "study": ([CASES.parent / "studies" / "abe_lattice.toml", "--budget", "0", "--rounds", "3"], []),
}


class Page(html.parser.HTMLParser):
    """Elements, numbers and text of a page; an element that is not closed in its place is an error."""

    def __init__(self, text):
        super().__init__()
        self.open, self.elements, self.numbers, self.words = [], [], [], []
        self.feed(text)
        self.close()
        assert not self.open, f"not closed: {self.open}"

    def handle_starttag(self, tag, attributes):
        self.handle_startendtag(tag, attributes)
        if tag not in VOID:
            self.open.append(tag)

    def handle_startendtag(self, tag, attributes):
        attributes = dict(attributes)
        self.elements.append((tag, attributes))
        if tag == "data":
            self.numbers.append(float(attributes["value"]))

    def handle_endtag(self, tag):
        assert self.open and self.open[-1] == tag, f"</{tag}> closes {self.open[-1:]}"
        self.open.pop()

    def handle_data(self, data):
        self.words.append(data)

    def all(self, tag):
        return [attributes for name, attributes in self.elements if name == tag]

    @property
    def text(self):
        return "".join(self.words)


def number_at(result, path):
    for key in path.split("."):
        result = result[int(key)] if isinstance(result, list) else result[key]
    return result


def without_times(page):
    """The part before the report, which tells how long the stages took."""
    return page.split('<section id="report"')[0]


class ResultPages(ProgramTest):
    def page_of(self, name, *more, environment=None):
        arguments, _ = VERBS[name]
        words = [name, *arguments] if str(arguments[0]).endswith(".toml") else arguments
        out = self.folder / name
        done = subprocess.run([PROGRAM, *map(str, words), "--out", str(out), "--overwrite", *more], capture_output=True, text=True,
                              env=environment, timeout=120)
        self.check_done(done)
        return (out / "index.html").read_text(encoding="utf-8"), json.loads((out / "result.json").read_text(encoding="utf-8"))

    def test_every_verb_writes_a_page_that_needs_nothing_else(self):
        for name, (_, shown) in VERBS.items():
            with self.subTest(name):
                text, result = self.page_of(name)
                page = Page(text)
                self.assertTrue(text.startswith("<!DOCTYPE html>"))
                self.assertLess(len(text.encode()), 2_000_000)
                self.assertNotIn("http", text)
                self.assertEqual(page.all("html"), [{"lang": "en"}])
                self.assertEqual(len(page.all("title")), 1)
                self.assertEqual(len(page.all("h1")), 1)
                self.assertEqual(page.all("link"), [])
                for tag, attributes in page.elements:
                    for key in ("src", "href"):
                        target = attributes.get(key, "#")
                        self.assertTrue(target.startswith(("data:image/png;base64,", "data:image/svg+xml;base64,", "#")), f"<{tag} {key}={target[:60]}>")
                    if tag in ("img", "svg", "canvas"):
                        self.assertTrue(attributes.get("alt") or attributes.get("aria-label"), f"<{tag}> has no words")
                names = [attributes["id"] for _, attributes in page.elements if "id" in attributes]
                self.assertEqual(len(names), len(set(names)), "two elements have one name")
                self.assertIn("prefers-color-scheme: dark", text)
                self.assertIn("equidem " + ("homogenize" if name == "ensemble" else "run" if name in ("rest", "grains") else name),
                              page.text)
                for path in shown:
                    self.assertIn(number_at(result, path), page.numbers, path)

    def test_figures_and_frames_are_in_the_page(self):
        if shutil.which("gnuplot") is None:
            self.skipTest("gnuplot is not installed")
        for name, figures, players in (("solve", 1, 0), ("homogenize", 3, 0), ("stability", 2, 0), ("run", 2, 1), ("grains", 2, 1),
                                       ("sweep", 2, 0), ("study", 1, 0), ("pack", 1, 0)):
            with self.subTest(name):
                page = Page(self.page_of(name)[0])
                self.assertGreaterEqual(len(page.all("figure")), figures)
                self.assertEqual(len(page.all("canvas")), players)

    def test_the_same_case_gives_the_same_bytes(self):
        for name in ("solve", "run", "pack"):
            with self.subTest(name):
                self.assertEqual(without_times(self.page_of(name)[0]), without_times(self.page_of(name)[0]))

    def test_text_of_the_user_is_escaped(self):
        page, _ = self.page_of("solve", "--set", 'title="a <script>alert(1)</script> & b"')
        self.assertNotIn("<script>alert", page)
        self.assertIn("a &lt;script&gt;alert(1)&lt;/script&gt; &amp; b", page)

    def test_warnings_stand_above_the_answer(self):
        page, _ = self.page_of("solve", "--set", "springs.kN=5", "--set", "springs.kT=1")
        self.assertIn("softer than any solid", page.split('<section id="answer"')[0])
        self.assertNotIn('class="warnings"', self.page_of("solve")[0])

    def test_a_run_tells_whether_it_can_be_trusted(self):
        page, _ = self.page_of("run")
        trust = page.split('<section id="trust"')[1].split("</section>")[0]
        for words in ("time step", "overlap", "balance of energies", "Poisson"):
            self.assertIn(words, trust)
        self.assertEqual(trust.count('<li class="good">'), 4, trust)
        far, _ = self.page_of("run", "--set", "load.0.force=[1e8,0]")
        trust = far.split('<section id="trust"')[1].split("</section>")[0]
        self.assertRegex(trust, '<li class="(bad|doubtful)">.*overlap.*<em>Take stiffer springs')

    def test_without_gnuplot_the_page_says_so(self):
        programs = self.folder / "programs"
        programs.mkdir()
        (programs / "timeout").symlink_to(shutil.which("timeout"))
        page, _ = self.page_of("run", environment={**os.environ, "PATH": str(programs)})
        self.assertIn("gnuplot is not installed", Page(page).text)

    def test_a_page_is_not_lost_without_overwrite(self):
        out = self.folder / "kept"
        out.mkdir()
        (out / "index.html").write_text("mine")
        self.check_error(equidem("solve", TENSION, "--out", out), 2, "index.html")
        self.assertEqual((out / "index.html").read_text(), "mine")

    def test_a_dry_run_writes_no_page(self):
        out = self.folder / "dry"
        self.check_done(equidem("solve", TENSION, "--out", out, "--dry-run"))
        self.assertFalse((out / "index.html").exists())

    def browse(self, page, *options):
        if CHROMIUM is None:
            self.skipTest("chromium is not installed")
        done = subprocess.run([CHROMIUM, "--headless", "--no-sandbox", "--disable-gpu", "--enable-logging=stderr",
                               f"--user-data-dir={self.folder / 'chromium'}", *options, page.as_uri()],
                              capture_output=True, text=True, timeout=100)
        self.assertNotIn("CONSOLE", done.stderr)
        return done.stdout

    def test_a_browser_shows_the_page_without_an_error(self):
        self.page_of("run")
        for width in (400, 1200):
            picture = self.folder / f"{width}.png"
            self.browse(self.folder / "run" / "index.html", f"--window-size={width},1500", f"--screenshot={picture}")
            data = picture.read_bytes()
            chunks, at = b"", 8
            while at < len(data):
                length = int.from_bytes(data[at:at + 4], "big")
                if data[at + 4:at + 8] == b"IDAT":
                    chunks += data[at + 8:at + 8 + length]
                at += 12 + length
            self.assertGreater(len(set(zlib.decompress(chunks))), 100, "the page is blank")

    def test_the_slider_moves_the_picture(self):
        for name in ("run", "grains"):
            text, _ = self.page_of(name)
            probe = """<script>
const canvas = document.querySelector('canvas'), slider = document.querySelector('input'), seen = [];
for (const f of [0, slider.max]) {
  slider.value = f;
  slider.dispatchEvent(new Event('input'));
  seen.push([canvas.toDataURL(), document.querySelector('.controls span').textContent]);
}
document.body.dataset.moved = seen[0][0] != seen[1][0] && seen[0][1] != seen[1][1] && slider.max > 5;
</script></body>"""
            page = self.folder / "probed.html"
            page.write_text(text.replace("</body>", probe), encoding="utf-8")
            self.assertIn('data-moved="true"', self.browse(page, "--dump-dom"), name)


if __name__ == "__main__":
    unittest.main()
