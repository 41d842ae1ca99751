# SPDX-License-Identifier: GPL-3.0-or-later
"""The page that --out writes beside the files: run_result_pages.py PROGRAM SOURCE_FOLDER [unittest options]."""
import html.parser
import os
import shutil
import subprocess
import unittest
import zlib

from program import COMMANDS, ProgramTest, result_in

VOID = {"meta", "img", "input", "br", "hr"}
CHROMIUM = shutil.which("chromium") or shutil.which("chromium-browser")
# Numbers of result.json that the page of a command shows.
SHOWN = {
    "solve": ["poisson_ratio", "plane_strain.young_modulus", "relative_residual", "error_bound"],
    "homogenize": ["young_modulus.plane_strain", "poisson_ratio.plane_strain", "shear_modulus", "relative_residual"],
    "ensemble": ["ensemble.-1.young_modulus.plane_strain.mean"],
    "calibrate": ["kN", "kT", "achieved.poisson_ratio.plane_strain"],
    "stability": ["critical_ratio", "critical_time_step"],
    "pack": ["solid_fraction", "coordination_number"],
    "run": ["energy.kinetic", "energy.relative_error", "time"],
    "rest": ["poisson_ratio", "relative_unbalanced_force"],
    "grains": ["energy.kinetic", "time"],
    "quasistatic": ["peak.load"],
    "sweep": [],
    "study": [],
}
FIGURES = {"solve": 1, "homogenize": 3, "stability": 2, "run": 2, "grains": 2, "sweep": 2, "study": 1, "pack": 1}


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
    def page_of(self, name, *more, **options):
        out = self.folder / name
        self.done(*COMMANDS[name], "--out", out, "--overwrite", *more, **options)
        return (out / "index.html").read_text(encoding="utf-8")

    def test_every_verb_writes_a_page_that_needs_nothing_else(self):
        for name, shown in SHOWN.items():
            with self.subTest(name):
                text = self.page_of(name)
                page, result = Page(text), result_in(self.folder / name)
                self.assertTrue(text.startswith("<!DOCTYPE html>"))
                self.assertLess(len(text.encode()), 2_000_000)
                self.assertNotIn("http", text)
                self.assertEqual((page.all("html"), len(page.all("title")), len(page.all("h1")), page.all("link")),
                                 ([{"lang": "en"}], 1, 1, []))
                for tag, attributes in page.elements:
                    for key in ("src", "href"):
                        target = attributes.get(key, "#")
                        self.assertTrue(target.startswith(("data:image/png;base64,", "data:image/svg+xml;base64,", "#")),
                                        f"<{tag} {key}={target[:60]}>")
                    if tag in ("img", "svg", "canvas"):
                        self.assertTrue(attributes.get("alt") or attributes.get("aria-label"), f"<{tag}> has no words")
                names = [attributes["id"] for _, attributes in page.elements if "id" in attributes]
                self.assertEqual(len(names), len(set(names)), "two elements have one name")
                self.assertIn("prefers-color-scheme: dark", text)
                self.assertIn(f"equidem {COMMANDS[name][0]}", page.text)
                for path in shown:
                    self.assertIn(number_at(result, path), page.numbers, path)
                if name in FIGURES and shutil.which("gnuplot"):
                    self.assertGreaterEqual(len(page.all("figure")), FIGURES[name])
                    self.assertEqual(len(page.all("canvas")), 1 if name in ("run", "grains") else 0)
                if name in ("solve", "run", "pack"):  # the same case gives the same bytes
                    self.assertEqual(without_times(text), without_times(self.page_of(name)))

    def test_text_of_the_user_is_escaped(self):
        page = self.page_of("solve", 'title="a <script>alert(1)</script> & b"')
        self.assertNotIn("<script>alert", page)
        self.assertIn("a &lt;script&gt;alert(1)&lt;/script&gt; &amp; b", page)

    def test_warnings_stand_above_the_answer(self):
        page = self.page_of("solve", "springs.kN=5", "springs.kT=1")
        self.assertIn("softer than any solid", page.split('<section id="answer"')[0])
        self.assertNotIn('class="warnings"', self.page_of("solve"))

    def test_a_run_tells_whether_it_can_be_trusted(self):
        good, far = (self.page_of("run", *load).split('<section id="trust"')[1].split("</section>")[0]
                     for load in ((), ("load.0.force=[1e8,0]",)))
        for words in ("time step", "overlap", "balance of energies", "Poisson"):
            self.assertIn(words, good)
        self.assertEqual(good.count('<li class="good">'), 4, good)
        self.assertRegex(far, '<li class="(bad|doubtful)">.*overlap.*<em>Take stiffer springs')

    def test_without_gnuplot_the_page_says_so(self):
        programs = self.folder / "programs"
        programs.mkdir()
        (programs / "timeout").symlink_to(shutil.which("timeout"))
        page = self.page_of("run", env={**os.environ, "PATH": str(programs)})
        self.assertIn("gnuplot is not installed", Page(page).text)

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
            text = self.page_of(name)
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
