# SPDX-License-Identifier: GPL-3.0-or-later
"""Folders that are damaged or in use, and runs that go on in them: run_damage.py PROGRAM SOURCE_FOLDER [unittest options]."""
import fcntl
import os
import shutil
import time
import unittest

from motion import CORNER, REST, SHAKE, RunTest
from program import CASES, CELL, COMMANDS, ENSEMBLE, NO_PICTURE, TENSION, contents, equidem, files_of, started

BOX, BALL = CASES / "grains_shaken.toml", CASES / "grains_between_walls.toml"
MEASURED = ("shaking.start=0.02", "output.probe_interval=4e-3", "output.frame_interval=7e-3")


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
    def check_damaged(self, start, resume, believed):
        """Whatever is damaged after `start`, `resume` refuses it or ends as after no damage; damage is refused in all files of
        `believed`, or in the folder of that name, and in no others. Of each kind of frames one file is damaged. The files that
        are not believed are damaged all at once: nothing that any of them says may change anything."""
        good, expected, out = (self.folder / name for name in ("good", "expected", "out"))
        self.done(*start, "--out", good)
        shutil.copytree(good, expected)
        self.done(*resume, "--out", expected)
        wanted, refused = contents(expected), {}
        files = [path for path in good.iterdir() if path.is_file()]
        for kind in ("discs", "contacts"):
            files += sorted(good.glob(f"frames/{kind}_*.vtp"))[1:2]
        alone, together = [], {}
        for path in sorted(path.relative_to(good) for path in files):
            for number, (damage, content) in enumerate(damages((good / path).read_bytes())):
                if path.parts[0] in believed:
                    alone.append((damage, {path: content}))
                else:
                    together.setdefault(number, {})[path] = content
        alone += [(f"damage {number}", changed) for number, changed in together.items()]
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
                    found = contents(out)
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
        case = ("run", BOX, "--threads", 1, "--quiet", NO_PICTURE, *MEASURED)
        tables = ("history.csv", "measures.csv", "surface.csv")
        refused = self.check_damaged((*case, "run.duration=0.03"), (*case, "run.duration=0.045", "--resume"),
                                     ("run.checkpoint.h5", "frames", "frames.pvd", *tables))
        for name in tables:
            self.assertTrue(any("digit" in damage for damage in refused[name]), refused)

    def test_of_bonded_discs_all_that_counts_is_checked(self):
        case = ("run", SHAKE, "--threads", 1, "--quiet", "output.files=['csv']", "run.step_rule=bound")
        self.check_damaged((*case, "run.duration=1.01e-3"), (*case, "run.duration=2e-3", "--resume"),
                           ("run.checkpoint.h5", "frames", "frames.pvd", "history.csv"))

    def test_of_a_sweep_all_that_counts_is_checked(self):
        case = ("sweep", TENSION, "--threads", 1, "--quiet", "--key", "ratio", "test=none",
                'support=[{group = "bottom", ux = 0.0, uy = 0.0}]', 'load=[{group = "top", kind = "total", force = [0.0, 1.0]}]')
        self.check_damaged((*case, "--values", "0,0.25,0.5"), (*case, "--values", "0,0.25,0.5,1", "--resume"),
                           ("sweep.csv", "case.toml"))

    def test_of_an_ensemble_all_that_counts_is_checked(self):
        case = ("homogenize", ENSEMBLE, "--threads", 1, "--quiet", "ensemble.discs=[20, 30]")
        self.check_damaged((*case, "ensemble.samples=3"), (*case, "ensemble.samples=4", "--resume"), ("samples.csv", "case.toml"))

    def test_measured_times_of_a_study_are_checked(self):
        out = self.folder / "out"
        study = (*COMMANDS["study"], "--out", out)
        self.done(*study)
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
        out, case = self.folder / "out", ("run", BOX, "--threads", 1, "--quiet", *MEASURED, "run.duration=0.03")
        for interval in ("4e-3", "6e-3"):  # the end is not a recorded time; it is
            for cell in ((), ("measures.cell=none",)):
                with self.subTest(interval=interval, cell=cell):
                    options = (f"output.probe_interval={interval}", *cell, "--out", out)
                    self.done(*case, *options, "--overwrite")
                    before = contents(out)
                    self.assertEqual(before["surface_plot.csv"].splitlines()[0].count(b","), 2)  # x and two curves
                    self.done(*case, *options, "--resume")
                    self.assertEqual(contents(out), before)

    def test_what_was_not_recorded_is_not_continued(self):
        run = ("run", SHAKE, "--threads", 1, "--quiet", NO_PICTURE, "--out", self.folder / "out", "run.step_rule=bound")
        self.done(*run, "run.duration=1e-3")
        self.done(*run, "run.duration=2e-3", "output.probe_interval=none", "--resume")
        self.check_error(equidem(*run, "run.duration=3e-3", "--resume"), 2, "history.csv", "without that file")


class InUse(RunTest):
    def test_a_folder_belongs_to_one_process(self):
        out = self.folder / "out"
        running = started("run", CORNER, "--out", out, "run.duration=10", "--threads", 1)
        try:
            began = time.monotonic()
            while not (out / "run.checkpoint.h5").exists() and time.monotonic() - began < 60:
                time.sleep(0.01)
            for option in ("--resume", "--overwrite"):
                if option == "--overwrite" or (out / "run.checkpoint.h5").exists():
                    self.check_error(equidem("run", CORNER, "--out", out, option), 2, str(out), "is in use", "Wait")
        finally:
            running.kill()
            running.communicate()
        self.done("run", CORNER, "--out", out, "--overwrite", "run.duration=1e-3", NO_PICTURE)

    def test_every_verb_that_writes_asks_for_its_folder(self):
        out = self.folder / "out"
        out.mkdir()
        descriptor = os.open(out, os.O_RDONLY)
        fcntl.flock(descriptor, fcntl.LOCK_EX)
        self.check_errors(*(((*command, "--out", out), "is in use", str(out)) for command in (
            *COMMANDS.values(), ("run", SHAKE), ("run", BALL), ("run", REST), ("homogenize", CELL))))
        self.assertEqual(list(out.iterdir()), [])
        self.done("solve", TENSION, "--out", out, "--dry-run")
        os.close(descriptor)
        self.done("solve", TENSION, "--out", out)


if __name__ == "__main__":
    unittest.main()
