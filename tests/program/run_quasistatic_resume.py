#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Paths of equidem quasistatic whose state is kept, stopped and resumed: run_quasistatic_resume.py PROGRAM SOURCE_FOLDER
[unittest options]."""
import csv
import random
import re
import signal
import subprocess
import time
import unittest

from program import CASES, PROGRAM, ProgramTest, equidem, parse_json

NOTCH = CASES / "notched_plate.toml"
NO_PICTURE = ("--set", "output.files=['csv', 'vtk']")


class QuasistaticResume(ProgramTest):
    def cracks_of(self, out):
        with open(out / "events.csv", newline="") as file:
            return [(row["contact"], row["mode"]) for row in csv.DictReader(file)]

    def test_a_frictional_path_that_is_stopped_anywhere_goes_on_with_the_same_bits(self):
        options = (*NO_PICTURE, "--set", "quasistatic.max_events=260", "--set", "quasistatic.frame_every=20", "--set",
                   "output.checkpoint_interval=1e-3", "--threads", 1)
        case, whole, part = CASES / "frictional_notch.toml", self.folder / "whole", self.folder / "part"
        self.check_done(equidem("quasistatic", case, "--out", whole, *options))
        expected = {path.relative_to(whole): path.read_bytes() for path in whole.rglob("*") if self.is_of_path(path)}
        self.assertGreater(len(expected), 24)
        draw = random.Random(1)
        stops, resume = [], []
        while len(stops) < 12:
            running = subprocess.Popen([PROGRAM, "quasistatic", case, "--out", part, *map(str, options), *resume],
                                       stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True)
            checkpoint = part / "quasistatic.checkpoint.h5"
            before = checkpoint.stat().st_mtime_ns if checkpoint.exists() else 0
            while running.poll() is None and not (checkpoint.exists() and checkpoint.stat().st_mtime_ns > before):
                time.sleep(0.002)
            time.sleep(draw.uniform(0, 0.15))
            how = draw.choice((signal.SIGINT, signal.SIGKILL))
            running.send_signal(how)
            stderr = running.communicate(timeout=60)[1]
            resume = ["--resume"]
            if running.returncode == 0:
                break
            stops.append((how.name, stderr))
            self.assertIn(running.returncode, (130, -signal.SIGKILL), stderr)
        self.assertGreater(len(stops), 1)
        self.check_done(equidem("quasistatic", case, "--out", part, *options, "--resume"))
        found = {path.relative_to(part): path.read_bytes() for path in part.rglob("*") if self.is_of_path(path)}
        self.assertEqual(sorted(expected), sorted(found))
        self.assertEqual([path for path in expected if expected[path] != found[path]], [], stops)

    @staticmethod
    def is_of_path(path):
        """Files that do not tell times."""
        return path.suffix in (".csv", ".vtp", ".pvd") or path.name == "case.toml"

    def test_a_kept_state_that_was_altered_or_is_of_another_case_is_refused(self):
        options = (*NO_PICTURE, "--set", "quasistatic.max_events=20")
        case, out = CASES / "frictional_notch.toml", self.folder / "frictional"
        self.check_done(equidem("quasistatic", case, "--out", out, *options))
        checkpoint = out / "quasistatic.checkpoint.h5"
        kept = bytearray(checkpoint.read_bytes())
        kept[len(kept) // 2] ^= 1
        checkpoint.write_bytes(kept)
        self.check_error(equidem("quasistatic", case, "--out", out, *options, "--resume"), 2, "checksum is wrong")
        self.check_error(equidem("quasistatic", case, "--out", out, *options, "--set", "strength.seed=2", "--resume"), 2,
                         "of another case")
        checkpoint.unlink()
        done = self.check_done(equidem("quasistatic", case, "--out", out, *options, "--resume"))
        self.assertIn("computed again: no state was kept yet", done.stderr)

    def test_frames_of_a_brittle_path_go_on_behind_those_that_are_there(self):
        options = (*NO_PICTURE, "--set", "quasistatic.max_events=60", "--set", "quasistatic.frame_every=7")
        whole, part = self.folder / "whole", self.folder / "part"
        self.check_done(equidem("quasistatic", NOTCH, "--out", whole, *options))
        stop = (*options, "--set", "output.checkpoint_interval=1e-3")
        self.interrupt("quasistatic", NOTCH, "--out", part, *stop,
                       when=lambda: (part / "quasistatic.checkpoint.h5").exists())
        self.check_done(equidem("quasistatic", NOTCH, "--out", part, *stop, "--resume"))
        self.assertEqual(self.cracks_of(whole), self.cracks_of(part))
        self.assertEqual((whole / "frames.pvd").read_text(), (part / "frames.pvd").read_text())

    def test_a_path_that_was_ended_by_max_events_goes_on_to_the_events_of_a_whole_one(self):
        frictional = CASES / "frictional_notch.toml"
        for case, first, last in ((NOTCH, 13, 40), (frictional, 10, 200)):
            with self.subTest(case=case.name):
                whole, part = self.folder / case.stem / "whole", self.folder / case.stem / "part"
                command = ("quasistatic", case, *NO_PICTURE, "--threads", 1)
                until = ("--set", f"quasistatic.max_events={last}")
                self.check_done(equidem(*command, *until, "--out", whole))
                self.check_done(equidem(*command, "--set", f"quasistatic.max_events={first}", "--out", part))
                done = self.cracks_of(part)
                self.assertLess(len(done), last)
                self.check_done(equidem(*command, *until, "--out", part, "--resume", "--set", "title=another"))
                self.assertEqual(self.cracks_of(whole), self.cracks_of(part))
                self.assertEqual(done, self.cracks_of(whole)[:len(done)])
                if case == frictional:
                    self.assertEqual((whole / "events.csv").read_bytes(), (part / "events.csv").read_bytes())
                back = equidem(*command, "--set", f"quasistatic.max_events={first}", "--out", part, "--resume")
                self.check_error(back, 2, f"max_events is {first}, and {len(self.cracks_of(whole))} events are done",
                                 "goes on, and not back")

    def frames_of(self, out):
        return [int(step) for step in re.findall(r'timestep="(\d+)"[^>]*name="discs"', (out / "frames.pvd").read_text())]

    def test_a_resumed_path_may_write_other_frames(self):
        def run(case, events, every, *more):
            self.check_done(equidem("quasistatic", case, *NO_PICTURE, "--out", self.folder / case.stem, "--set",
                                    f"quasistatic.max_events={events}", "--set", f"quasistatic.frame_every={every}", *more))

        out = self.folder / NOTCH.stem
        run(NOTCH, 12, 5)
        self.assertEqual(self.frames_of(out)[:2], [5, 10])
        run(NOTCH, 23, 7, "--resume")
        self.assertEqual(self.frames_of(out)[:4], [5, 10, 14, 21])
        run(NOTCH, 26, 0, "--resume")
        self.assertEqual(len(self.cracks_of(out)), 26)
        run(NOTCH, 34, 10, "--resume")
        self.assertEqual(self.frames_of(out)[:6], [5, 10, 14, 21, 30, 34])
        # Where contacts are frictional, many change at once.
        frictional = CASES / "frictional_notch.toml"
        out = self.folder / frictional.stem
        run(frictional, 10, 0)
        before = len(self.cracks_of(out))
        run(frictional, 200, 1, "--resume")
        self.assertGreater(min(self.frames_of(out)), before)
        many = self.frames_of(out)
        run(frictional, 260, 500, "--resume")
        self.assertEqual(many[:-1], self.frames_of(out)[:len(many) - 1])

    def test_a_key_that_decides_the_path_is_named_where_it_differs(self):
        out = self.folder / "out"
        command = ("quasistatic", NOTCH, *NO_PICTURE, "--out", out, "--set", "quasistatic.max_events=5")
        self.check_done(equidem(*command))
        for change, told in (("strength.seed=2", "strength.seed is"), ("support.1.uy=2e-6", "support.1.uy is 1e-06 there and 2e-06"),
                             ("quasistatic.legs=[2.0, 1.0]", "quasistatic.legs is given here alone")):
            self.check_error(equidem(*command, "--set", change, "--resume"), 2, "of another case", told)
        for change in ("homogenize.bounds=affine", "schedule=[{name=\"ramp\", kind=\"ramp\", value=1, start=0, end=1}]"):
            self.check_done(equidem(*command, "--set", change, "--resume"))

    def test_events_of_an_earlier_version_are_refused_by_their_words_and_columns(self):
        out, case = self.folder / "out", CASES / "frictional_notch.toml"
        command = ("quasistatic", case, *NO_PICTURE, "--out", out, "--set", "quasistatic.max_events=5")
        self.check_done(equidem(*command))
        version = parse_json((out / "result.json").read_text())["version"]
        kept, events = (out / "case.toml").read_text(), (out / "events.csv").read_text()
        (out / "case.toml").write_text(kept.replace('"frictional"', '"rubs"'))
        refused = equidem(*command, "--resume")
        self.check_error(refused, 2, f"before {version}", '"rubs" there', "Choose another --out")
        self.assertNotIn("Take the value", refused.stderr)
        (out / "case.toml").write_text(kept)
        (out / "events.csv").write_text(events.replace("friction_N", "rubbing_N", 1))
        self.check_error(equidem(*command, "--resume"), 2, f"other than {version}", "'rubbing_N' there and 'friction_N' here")

    BLOCK = ('schema = "equidem/1"\n[assembly]\nkind = "hexagonal"\ncolumns = 5\nrows = 4\nradius = 0.01\n[springs]\nkN = 1e9\n'
             'kT = 3e8\n[[support]]\ngroup = "bottom"\nux = true\nuy = true\n[[load]]\ngroup = "top"\nforce = [0.0, 1e3]\n')

    def test_an_end_without_a_state_leaves_none_of_an_earlier_end_in_the_folder(self):
        case, out = self.folder / "case.toml", self.folder / "out"
        case.write_text(self.BLOCK + "[strength]\ntension = 1e3\nshear = 1e4\nweibull_modulus = 8.0\n")
        states = [out / name for name in ("discs.csv", "contacts.csv", "state.vtm", "state_discs.vtp", "state_contacts.vtp")]
        self.check_done(equidem("quasistatic", case, "--out", out, "--set", "quasistatic.max_events=1"))
        self.assertEqual([file.name for file in states if not file.exists()], [])
        done = self.check_done(equidem("quasistatic", case, "--out", out, "--resume"))
        self.assertIn("none is written: what is left does not carry its loads", done.stdout)
        self.assertEqual([file.name for file in states if file.exists()], [])

    def test_a_path_that_ends_under_its_dead_loads_says_so_and_draws_no_curve(self):
        case, out = self.folder / "case.toml", self.folder / "out"
        pushed = '[[dead_load]]\ngroup = "top"\nforce = [1e3, -1e3]\n[strength]\ntension = 0\nshear = 0\nafter_breaking = "frictional"\n'
        case.write_text(self.BLOCK.replace("hexagonal", "square").replace("columns = 5", "columns = 1") + pushed)
        out.mkdir()
        (out / "curve.svg").write_text("of an earlier path")
        done = self.check_done(equidem("quasistatic", case, "--out", out, "--overwrite"))
        self.assertIn("ended while the dead loads were applied: before any of the dead loads acts", done.stdout)
        self.assertEqual(parse_json((out / "result.json").read_text())["dead_loads_applied"], 0)
        self.assertEqual([file.name for file in out.glob("curve.*")], [])


if __name__ == "__main__":
    unittest.main()
