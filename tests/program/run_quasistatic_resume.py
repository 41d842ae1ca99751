#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Paths of equidem quasistatic whose state is kept, stopped and resumed: run_quasistatic_resume.py PROGRAM SOURCE_FOLDER
[unittest options]."""
import csv
import random
import signal
import subprocess
import time
import unittest

from program import CASES, PROGRAM, ProgramTest, equidem

NOTCH = CASES / "notched_plate.toml"
NO_PICTURE = ("--set", "output.picture=false")


class QuasistaticResume(ProgramTest):
    def cracks_of(self, out):
        with open(out / "events.csv", newline="") as file:
            return [(row["contact"], row["mode"]) for row in csv.DictReader(file)]

    def test_a_rubbing_path_that_is_stopped_anywhere_goes_on_with_the_same_bits(self):
        options = (*NO_PICTURE, "--set", "quasistatic.max_events=260", "--set", "quasistatic.frame_every=20", "--set",
                   "output.checkpoint_interval=1e-3", "--threads", 1)
        case, whole, part = CASES / "rubbing_notch.toml", self.folder / "whole", self.folder / "part"
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
        case, out = CASES / "rubbing_notch.toml", self.folder / "rubs"
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


if __name__ == "__main__":
    unittest.main()
