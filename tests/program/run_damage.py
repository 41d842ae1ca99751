#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Folders that are damaged, in use or full, and runs that go on in them: run_damage.py PROGRAM SOURCE_FOLDER."""
import fcntl
import os
import resource
import shutil
import signal
import subprocess
import time
import unittest

from motion import CORNER, SHAKE, RunTest, files_of
from program import CASES, PROGRAM, TENSION, ProgramTest, equidem, parse_json

BOX, BALL = CASES / "grains_shaken.toml", CASES / "grains_between_walls.toml"
STUDY = CASES.parent / "studies" / "abe_lattice.toml"
CELL, ENSEMBLE, PACK = CASES / "random_cell.toml", CASES / "ensemble.toml", CASES / "pack_graded.toml"
NO_PICTURE = ("--set", "output.files=['csv', 'vtk']")
MEASURED = ("--set", "shaking.start=0.02", "--set", "output.probe_interval=4e-3", "--set", "output.frame_interval=7e-3")
VARYING = ("report", "times", "particle_steps_per_second", "bytes_per_grain", "loop_bytes", "sweeps", "rebuilds")  # in result.json


def contents(folder):
    """Bytes of all files; of result.json what does not vary from run to run; of a page, which shows that, whether it is whole."""
    files = files_of(folder)
    if "result.json" in files:
        result = parse_json(files["result.json"].decode())
        files["result.json"] = {key: value for key, value in result.items() if key not in VARYING}
    if "index.html" in files:
        files["index.html"] = files["index.html"].endswith(b"</html>\n")
    return files


def damages(content):
    """Name and bytes of damaged files; None: no file."""
    yield "deleted", None
    yield "empty", b""
    for share in (0.3, 0.7):
        yield f"cut at {share}", content[:int(share * len(content))]
    yield "cut by a byte", content[:-1]
    for share in (0.05, 0.35, 0.65, 0.95):
        at = int(share * len(content))
        yield f"byte {at} flipped", content[:at] + bytes([content[at] ^ 0x10]) + content[at + 1:]
    digits = [at for at, byte in enumerate(content) if byte in b"0123456789"]
    for at in digits[len(digits) // 3::len(digits) // 2 + 1]:
        yield f"digit {at} changed", content[:at] + bytes([content[at] ^ 1]) + content[at + 1:]
    yield "foreign", b"grain,step,time_s\n5,1,x\n-1,2,0\n"


class Damage(RunTest):
    def check_damaged(self, start, resume, believed, same=contents):
        """Whatever is damaged after `start`, `resume` refuses it or ends as after no damage; damage is refused in all files of
        `believed`, or in the folder of that name, and in no others. Of each kind of frames one file is damaged. The files that
        are not believed are damaged all at once: nothing that any of them says may change anything."""
        good, expected, out = (self.folder / name for name in ("good", "expected", "out"))
        self.check_done(equidem(*start, "--out", good))
        shutil.copytree(good, expected)
        self.check_done(equidem(*resume, "--out", expected))
        wanted = same(expected)
        refused = {}
        files = [path for path in good.iterdir() if path.is_file()]
        for kind in ("discs", "contacts"):
            files += sorted(good.glob(f"frames/{kind}_*.vtp"))[1:2]
        alone, together = [], {}
        for path in sorted(path.relative_to(good) for path in files):
            made = list(damages((good / path).read_bytes()))
            if path.parts[0] in believed:
                alone += [(damage, {path: content}) for damage, content in made]
                continue
            for number, (_, content) in enumerate(made):
                together.setdefault(number, {})[path] = content
        for number, changed in together.items():
            alone.append((f"damage {number}", changed))
        for damage, changed in alone:
            with self.subTest(files=[str(path) for path in changed], damage=damage):
                shutil.rmtree(out, ignore_errors=True)
                shutil.copytree(good, out)
                for path, content in changed.items():
                    (out / path).unlink()
                    if content is not None:
                        (out / path).write_bytes(content)
                before = files_of(out)
                done = equidem(*resume, "--out", out)
                part = next(iter(changed)).parts[0]
                if done.returncode == 0:
                    found = same(out)
                    self.assertEqual(found.keys(), wanted.keys())
                    for name, value in wanted.items():
                        self.assertEqual(found[name], value, name)
                    continue
                self.check_error(done, 2, "frames" if part.startswith("frames") else part)
                self.assertEqual(files_of(out), before)
                refused.setdefault(part, []).append(damage)
        self.assertEqual(set(refused), set(believed))
        return refused

    def test_of_colliding_bodies_all_that_counts_is_checked(self):
        case = ("run", BOX, "--threads", 1, "--quiet", *NO_PICTURE, *MEASURED, "--set", "output.probe_interval=4e-3")
        refused = self.check_damaged((*case, "--set", "run.duration=0.03"),
                                     (*case, "--set", "run.duration=0.045", "--resume"),
                                     ("run.checkpoint.h5", "frames", "frames.pvd", "history.csv", "measures.csv",
                                      "surface.csv"))
        for name in ("history.csv", "measures.csv", "surface.csv"):
            self.assertTrue(any("digit" in damage for damage in refused[name]), refused)

    def test_of_bonded_discs_all_that_counts_is_checked(self):
        case = ("run", SHAKE, "--threads", 1, "--quiet", "--set", "output.files=['csv']", "--set",
                "run.step_rule=bound")
        self.check_damaged((*case, "--set", "run.duration=1.01e-3"), (*case, "--set", "run.duration=2e-3", "--resume"),
                           ("run.checkpoint.h5", "frames", "frames.pvd", "history.csv"))

    def test_of_a_sweep_all_that_counts_is_checked(self):
        case = ("sweep", TENSION, "--threads", 1, "--quiet", "--key", "ratio", "--set", "test=none", "--set",
                "support=[{group = \"bottom\", ux = 0.0, uy = 0.0}]", "--set",
                "load=[{group = \"top\", kind = \"total\", force = [0.0, 1.0]}]")
        self.check_damaged((*case, "--values", "0,0.25,0.5"), (*case, "--values", "0,0.25,0.5,1", "--resume"),
                           ("sweep.csv", "case.toml"))

    def test_of_an_ensemble_all_that_counts_is_checked(self):
        case = ("homogenize", ENSEMBLE, "--threads", 1, "--quiet", "--set", "ensemble.discs=[20, 30]")
        self.check_damaged((*case, "--set", "ensemble.samples=3"), (*case, "--set", "ensemble.samples=4", "--resume"),
                           ("samples.csv", "case.toml"))

    def test_measured_times_of_a_study_are_checked(self):
        out = self.folder / "out"
        study = ("study", STUDY, "--budget", 0, "--rounds", 3, "--out", out)
        self.check_done(equidem(*study))
        table = out / "samples.csv"
        good = table.read_bytes()
        row = good.split(b"\n")[2]
        digit = good.index(row) + row.index(b".") + 2
        table.write_bytes(good[:digit] + bytes([good[digit] ^ 1]) + good[digit + 1:])
        self.check_error(equidem(*study), 2, "samples.csv", "line 3 was altered", "--overwrite")
        table.write_bytes(good[:-5])
        self.check_error(equidem(*study), 2, "samples.csv", "was altered")


class GoingOn(RunTest):
    def test_a_finished_box_with_fields_goes_on_to_its_own_files(self):
        out, first = self.folder / "out", self.folder / "first"
        for interval in ("4e-3", "6e-3"):  # the end is not a recorded time; it is
            with self.subTest(interval=interval):
                case = ("run", BOX, "--threads", 1, "--quiet", *MEASURED, "--set", "run.duration=0.03", "--set",
                        f"output.probe_interval={interval}")
                shutil.rmtree(out, ignore_errors=True)
                shutil.rmtree(first, ignore_errors=True)
                for cell in ((), ("--set", "measures.cell=none")):
                    self.check_done(equidem(*case, *cell, "--out", out, "--overwrite"))
                    before = contents(out)
                    self.assertEqual(before["surface_plot.csv"].splitlines()[0].count(b","), 2)  # x and two curves
                    self.check_done(equidem(*case, *cell, "--out", out, "--resume"))
                    self.assertEqual(contents(out), before)

    def test_a_box_that_goes_on_past_its_end_has_the_files_of_one_that_ran_through(self):
        out, whole = self.folder / "out", self.folder / "whole"
        case = ("run", BOX, "--threads", 1, "--quiet", *MEASURED)
        resume = ()
        for end in ("0.0213", "0.0301", "0.042", "0.0517"):
            self.check_done(equidem(*case, "--out", out, "--set", f"run.duration={end}", *resume))
            resume = ("--resume",)
        self.check_done(equidem(*case, "--out", whole, "--set", f"run.duration={end}"))
        found, wanted = contents(out), contents(whole)
        self.assertEqual(found.keys(), wanted.keys())
        for name in wanted.keys() - {"run.checkpoint.h5"}:  # that holds the counters
            self.assertEqual(found[name], wanted[name], name)

    def test_what_was_not_recorded_is_not_continued(self):
        out = self.folder / "out"
        run = ("run", SHAKE, "--threads", 1, "--quiet", *NO_PICTURE, "--out", out, "--set", "run.step_rule=bound")
        self.check_done(equidem(*run, "--set", "run.duration=1e-3"))
        self.check_done(equidem(*run, "--set", "run.duration=2e-3", "--set", "output.probe_interval=none", "--resume"))
        self.check_error(equidem(*run, "--set", "run.duration=3e-3", "--resume"), 2, "history.csv", "without that file")


class InUse(RunTest):
    def test_a_folder_belongs_to_one_process(self):
        out = self.folder / "out"
        command = [PROGRAM, "run", str(CORNER), "--out", str(out), "--set", "run.duration=10", "--threads", "1"]
        running = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE)
        try:
            began = time.monotonic()
            while not (out / "frames.pvd").exists() and time.monotonic() - began < 60:
                time.sleep(0.01)
            for option in ("--resume", "--overwrite"):
                goes_on = option == "--overwrite" or (out / "run.checkpoint.h5").exists()
                done = equidem("run", CORNER, "--out", out, option)
                if goes_on:
                    self.check_error(done, 2, str(out), "is in use", "Wait")
        finally:
            running.send_signal(signal.SIGKILL)
            running.communicate()
        self.check_done(equidem("run", CORNER, "--out", out, "--overwrite", "--set", "run.duration=1e-3", *NO_PICTURE))

    def test_every_verb_that_writes_asks_for_its_folder(self):
        out = self.folder / "out"
        out.mkdir()
        descriptor = os.open(out, os.O_RDONLY)
        fcntl.flock(descriptor, fcntl.LOCK_EX)
        for command in (("run", SHAKE), ("run", BALL), ("run", CASES / "run_tension.toml"), ("solve", TENSION),
                        ("sweep", TENSION, "--key", "ratio", "--values", "0"), ("homogenize", CELL), ("pack", PACK),
                        ("homogenize", ENSEMBLE), ("stability", CELL), ("study", STUDY),
                        ("calibrate", CASES / "calibrate_random.toml")):
            with self.subTest(verb=command[0]):
                self.check_error(equidem(*command, "--out", out), 2, "is in use", str(out))
                self.assertEqual(list(out.iterdir()), [])
        self.check_done(equidem("solve", TENSION, "--out", out, "--dry-run"))
        os.close(descriptor)
        self.check_done(equidem("solve", TENSION, "--out", out))


class FullDisk(ProgramTest):
    def test_a_full_disk_costs_no_answer(self):
        limit = 3000  # of a file, as on a disk that is full
        for command, words in ((("solve", TENSION), "nu, (35)"), (("homogenize", CELL), "plane strain"),
                               (("run", CASES / "run_tension.toml"), "rest"), (("stability", CELL), "kT"),
                               (("sweep", TENSION, "--key", "ratio", "--steps", 41, "--from", 0, "--to", 1), "nu theory")):
            with self.subTest(verb=command[0]):
                out = self.folder / command[0]
                done = subprocess.run([PROGRAM, *map(str, command), "--out", str(out)], capture_output=True, text=True,
                                      timeout=120,
                                      preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (limit, limit)))
                self.assertEqual(done.returncode, 1, done.stderr)
                self.assertIn(words, done.stdout)
                self.assertIn("cannot write", done.stderr.splitlines()[-1])
                self.assertFalse((out / "result.json").exists())
                self.assertIn("WARNING", done.stdout)


if __name__ == "__main__":
    unittest.main()
