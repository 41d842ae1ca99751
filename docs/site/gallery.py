#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""gallery.py SOURCE STAGE PROGRAM: a page of all cases of data/cases, each with a picture that the program makes of it.

A case is run by the first command of its comment. What takes longer than EQUIDEM_GALLERY_SECONDS (30) is interrupted,
and its picture is that of what was done until then.
"""

import concurrent.futures
import os
import pathlib
import re
import shutil
import signal
import subprocess
import sys
import tempfile

# Groups of the page: heading, begin of the names of their cases.
GROUPS = [("Equilibrium", ("abe1996", "cantilever", "delaunay", "restrained", "truss")),
          ("Moduli, springs, stability",
           ("random_cell", "two_minerals", "lab_rock", "free_sample", "ensemble", "viscoelastic", "hexagonal", "column",
            "calibrate")),
          ("Packings", ("pack",)), ("Breakage", ("notched", "frictional")), ("Bonded discs in motion", ("run",)),
          ("Bodies that collide", ("grains",)), ("From a sieve curve to a wave", ("sandstone",)), ("Others", ("",))]
# What shows a case best, in this order.
PICTURES = ("picture_buckling.png", "cracks.png", "picture*.png", "breaks_plot.png", "dispersion*.png", "*.png")
WIDTH = 420  # of a thumbnail, in pixels


def told(case):
    """Title, what the comment says of the case, and its first command."""
    text = case.read_text(encoding="utf-8")
    said, command = [], ""
    for line in text.split("\n\n", 1)[0].split("\n"):
        if line.startswith("#   equidem") and "'" not in line:
            command = command or line[4:].split("   ")[0]
        elif line.startswith("#") and not line.startswith("#  ") and not command:
            said.append(line[1:].strip())
    title = re.search(r'^title *= "(.*)"', text, re.M)
    return (title.group(1) if title else case.stem), " ".join(said).strip(), command


def command_of(case, command):
    """Words of the command that makes the picture, without its folder; a case without one is homogenized or scanned."""
    text = case.read_text(encoding="utf-8")
    words = command.split()[1:] if command else []
    if not words or words[0] == "sweep":
        verb = "homogenize" if "[ensemble]" in text else "stability"
        words = [verb, case.name]
    if "--out" in words:
        place = words.index("--out")
        del words[place:place + 2]
    return words


def picture(program, case, target, seconds):
    """Write the picture of a case, or of its assembly; returns whether there is one."""
    words = command_of(case, told(case)[2])
    ways = (words, ["homogenize", case.name])
    return any(drawn(program, way, case, target, seconds) for way in ways)


def drawn(program, words, case, target, seconds):
    with tempfile.TemporaryDirectory() as name:
        running = subprocess.Popen([program, *words, "--quiet", "--threads", "1", "--out", name, "--overwrite"],
                                   cwd=case.parent, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        try:
            running.communicate(timeout=seconds)
        except subprocess.TimeoutExpired:
            running.send_signal(signal.SIGINT)
            try:
                running.communicate(timeout=60)
            except subprocess.TimeoutExpired:
                running.kill()
                running.communicate()
                return False  # it may have left part of a picture
        found = next((path for pattern in PICTURES for path in sorted(pathlib.Path(name).glob(pattern))), None)
        if found is None:
            return False
        try:
            from PIL import Image
            with Image.open(found) as image:
                image = image.convert("RGB")
                image.thumbnail((WIDTH, WIDTH))
                image.quantize(128).save(target, optimize=True)
        except ImportError:
            shutil.copyfile(found, target)
        return True


def cases_of(source):
    """Cases of each group, without those that need files of another one."""
    left = sorted(path for path in (source / "data/cases").rglob("*.toml")
                  if "rock/" not in path.read_text(encoding="utf-8") or path.name == "rock.toml")
    for heading, names in GROUPS:
        found = [path for path in left if path.relative_to(source / "data/cases").as_posix().startswith(names)]
        left = [path for path in left if path not in found]
        if found:
            yield heading, found


def first_sentences(text, most=260):
    """As many whole sentences as fit into three lines."""
    kept = ""
    for sentence in re.split(r"(?<=[.?!:]) (?=[A-Z])", text):
        if kept and len(kept) + len(sentence) > most:
            break
        kept = f"{kept} {sentence}".strip()
    return kept.rstrip(":").replace("|", "\\|").replace("<", "&lt;").replace("*", "\\*").replace("_", "\\_")


def page(source, stage, program):
    """The page, with pictures in the folder files/cases of the stage."""
    seconds = float(os.environ.get("EQUIDEM_GALLERY_SECONDS", "30"))
    groups = list(cases_of(source))
    folder, copies = stage / "files/cases", stage / "files/data/cases"
    folder.mkdir(parents=True, exist_ok=True)
    with concurrent.futures.ThreadPoolExecutor(os.cpu_count() or 1) as pool:
        jobs = {case: pool.submit(picture, program, case, folder / f"{case.stem}.png", seconds)
                for _, cases in groups for case in cases}
    lines = ["# Cases as pictures", "", "Every case of `data/cases`, drawn by the program; runs that take longer than "
             f"{seconds:g} s as far as they came. A picture leads to its case file, whose comment has more commands.",
             ""]
    for heading, cases in groups:
        lines += [f"## {heading}", "", "| | |", "|---|---|"]
        for case in cases:
            title, said, command = told(case)
            place = case.relative_to(source / "data/cases")
            (copies / place).parent.mkdir(parents=True, exist_ok=True)
            shutil.copyfile(case, copies / place)
            shown = f"![{title}](files/cases/{case.stem}.png)" if jobs[case].result() else title
            words = " ".join(["equidem", *command_of(case, command)]).replace(case.name, f"data/cases/{place}")
            text = f"**{first_sentences(title)}**<br>{first_sentences(said)}<br>`{words}`"
            lines.append(f"| [{shown}](files/data/cases/{place}) | {text} |")
        lines.append("")
    return "\n".join(lines)


if __name__ == "__main__":
    source, stage = pathlib.Path(sys.argv[1]).resolve(), pathlib.Path(sys.argv[2]).resolve()
    (stage / "cases.md").write_text(page(source, stage, os.path.abspath(sys.argv[3])), encoding="utf-8")
