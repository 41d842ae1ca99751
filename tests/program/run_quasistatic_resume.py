#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Paths of equidem quasistatic that are stopped, damaged and resumed: run_quasistatic_resume.py PROGRAM SOURCE_FOLDER
[unittest options]."""
import math
import random
import re
import signal
import time
import unittest

from program import NO_PICTURE, ProgramTest, equidem, files_of, result_in, rows_of, started
from run_quasistatic import FRICTIONAL, NOTCH, block

AVALANCHE = """[strength]
tension = 10.0e3
shear = 20.0e3
after_breaking = "frictional"
residual_friction = 0.4
[[dead_load]]
group = "top"
kind = "traction"
force = [0.0, -1.0e6]
[[load]]
group = "top"
kind = "total"
force = [100.0, 0.0]
[quasistatic]
control = "load"
"""
ANOTHER = "of another case"


def frames_of(out):
    return [int(step) for step in re.findall(r'timestep="(\d+)"[^>]*name="discs"', (out / "frames.pvd").read_text())]


class ResumeTest(ProgramTest):
    def path(self, case, out, *options):
        """The completed process, of one thread and without pictures."""
        return equidem("quasistatic", case, NO_PICTURE, "--threads", 1, "--out", out, *options)

    def followed(self, case, out, *options):
        return self.check_done(self.path(case, out, *options))

    def check_same_events(self, one, other):
        """Which contacts break, how and when, to round-off of the states between."""
        expected, found = (rows_of(out / "events.csv") for out in (one, other))
        self.assertEqual(len(found), len(expected))
        stress = max(abs(float(row[name])) for row in expected for name in row if name.startswith("stress"))
        for name in [name for name in expected[0] if name != "checksum"]:
            ours, theirs = [row[name] for row in found], [row[name] for row in expected]
            if name in ("mode", "loosened"):
                self.assertEqual(ours, theirs)
            elif name == "relative_residual":
                self.assertLess(max(map(float, ours)), 1e-12)
            else:
                most = max((abs(float(value)) for value in theirs if math.isfinite(float(value))), default=0)
                most = stress if name.startswith("stress") else most
                for a, b in zip(ours, theirs):
                    self.assertTrue(a == b or abs(float(a) - float(b)) <= 1e-9 * most, (name, a, b))


class Stopped(ResumeTest):
    def test_interrupted_it_ends_with_130_and_goes_on_with_the_same_events(self):
        larger = ("assembly.columns=61", "assembly.rows=61", "strength.weibull_modulus=2.0", "quasistatic.max_events=400")
        whole, part = self.folder / "whole", self.folder / "part"
        self.followed(NOTCH, whole, *larger)
        stdout, stderr = self.interrupt("quasistatic", NOTCH, NO_PICTURE, "--threads", 1, "--out", part, *larger,
                                        when=lambda: (part / "case.toml").exists())
        self.assertIn("not ended: stopped as asked", stdout)
        self.assertIn("--resume", stderr)
        result = result_in(part)
        self.assertEqual((result["status"], result["complete"]), ("interrupted", False))
        self.followed(NOTCH, part, *larger, "--resume")
        self.check_same_events(whole, part)

    def test_wherever_the_table_ends_the_path_goes_on_with_the_same_events(self):
        whole, part = self.folder / "whole", self.folder / "part"
        for out in (whole, part):
            self.followed(NOTCH, out)
        rows = (whole / "events.csv").read_text().splitlines(keepends=True)
        for kept in (1, 20, len(rows) - 1):
            (part / "events.csv").write_text("".join(rows[:kept + 1]))
            self.followed(NOTCH, part, "--resume")
            self.assertEqual((part / "events.csv").read_text().splitlines(keepends=True)[:kept + 1], rows[:kept + 1])
            self.assertTrue(result_in(part)["complete"])
            self.check_same_events(whole, part)

    def test_a_frictional_path_that_is_stopped_anywhere_goes_on_with_the_same_bits(self):
        options = ("quasistatic.max_events=260", "quasistatic.frame_every=20", "output.checkpoint_interval=1e-3")
        whole, part, draw, stops = self.folder / "whole", self.folder / "part", random.Random(1), 0
        self.followed(FRICTIONAL, whole, *options)
        self.assertGreater(len(files_of(whole)), 24)
        checkpoint = part / "quasistatic.checkpoint.h5"
        for k in range(12):
            running = started("quasistatic", FRICTIONAL, NO_PICTURE, "--threads", 1, "--out", part, *options,
                              *(["--resume"] if k else []))
            before = checkpoint.stat().st_mtime_ns if checkpoint.exists() else 0
            while running.poll() is None and not (checkpoint.exists() and checkpoint.stat().st_mtime_ns > before):
                time.sleep(0.002)
            time.sleep(draw.uniform(0, 0.15))
            running.send_signal(draw.choice((signal.SIGINT, signal.SIGKILL)))
            stderr = running.communicate(timeout=60)[1]
            if running.returncode == 0:
                break
            stops += 1
            self.assertIn(running.returncode, (130, -signal.SIGKILL), stderr)
        self.assertGreater(stops, 1)
        self.followed(FRICTIONAL, part, *options, "--resume")
        self.check_same_files(whole, part)
        self.check_same_files(whole, part, "case.toml")

    def test_frames_of_a_brittle_path_go_on_behind_those_that_are_there(self):
        options = ("quasistatic.max_events=60", "quasistatic.frame_every=7")
        whole, part, often = self.folder / "whole", self.folder / "part", "output.checkpoint_interval=1e-3"
        self.followed(NOTCH, whole, *options)
        self.interrupt("quasistatic", NOTCH, NO_PICTURE, "--out", part, *options, often,
                       when=lambda: (part / "quasistatic.checkpoint.h5").exists())
        self.followed(NOTCH, part, *options, often, "--resume")
        self.check_same_events(whole, part)
        self.check_same_files(whole, part, "frames.pvd")

    def test_a_path_that_was_ended_by_max_events_goes_on_to_the_events_of_a_whole_one(self):
        for case, first, last in ((NOTCH, 13, 40), (FRICTIONAL, 10, 200)):
            with self.subTest(case=case.name):
                whole, part = self.folder / case.stem / "whole", self.folder / case.stem / "part"
                until, shorter = f"quasistatic.max_events={last}", f"quasistatic.max_events={first}"
                self.followed(case, whole, until)
                self.followed(case, part, shorter)
                done = rows_of(part / "events.csv")
                self.assertLess(len(done), last)
                self.followed(case, part, until, "--resume", "title=another")
                self.check_same_events(whole, part)
                events = rows_of(whole / "events.csv")
                self.assertEqual([(row["contact"], row["mode"]) for row in done],
                                 [(row["contact"], row["mode"]) for row in events[:len(done)]])
                if case == FRICTIONAL:
                    self.check_same_files(whole, part, "events.csv")
                self.check_error(self.path(case, part, shorter, "--resume"), 2,
                                 f"max_events is {first}, and {len(events)} events are done",
                                 "goes on, and not back")

    def test_within_a_release_max_events_holds_and_the_path_goes_on_from_there(self):
        case = self.write(block(60, 8, AVALANCHE))
        for name, counts in (("once", [12]), ("in_parts", [3, 8, 12])):
            for k, count in enumerate(counts):
                self.followed(case, self.folder / name, f"quasistatic.max_events={count}", *(["--resume"] if k else []))
                result = result_in(self.folder / name)
                self.assertTrue(count <= result["event_count"] < count + 3, result["event_count"])
                self.assertIn(f"(max_events = {count}), while a broken bond gives up its force", result["ended"])
                self.assertEqual(len(rows_of(self.folder / name / "events.csv")), result["event_count"])
        self.check_same_files(self.folder / "once", self.folder / "in_parts", "events.csv")

    def test_a_signal_within_a_release_is_answered_and_all_that_is_done_is_delivered(self):
        case, out = self.write(block(300, 12, AVALANCHE)), self.folder / "stopped"
        self.interrupt("quasistatic", case, "--out", out, NO_PICTURE, after=4)
        result = result_in(out)
        self.assertGreater(result["event_count"], 0)
        self.assertEqual(result["ended"], "stopped as asked")
        self.assertEqual(len(rows_of(out / "events.csv")), result["event_count"])

    def test_a_resumed_path_may_write_other_frames(self):
        def run(case, events, every, *more):
            out = self.folder / case.stem
            self.followed(case, out, f"quasistatic.max_events={events}", f"quasistatic.frame_every={every}", *more)
            return out

        self.assertEqual(frames_of(run(NOTCH, 12, 5))[:2], [5, 10])
        self.assertEqual(frames_of(run(NOTCH, 23, 7, "--resume"))[:4], [5, 10, 14, 21])
        self.assertEqual(len(rows_of(run(NOTCH, 26, 0, "--resume") / "events.csv")), 26)
        self.assertEqual(frames_of(run(NOTCH, 34, 10, "--resume"))[:6], [5, 10, 14, 21, 30, 34])
        # Where contacts are frictional, many change at once.
        before = len(rows_of(run(FRICTIONAL, 10, 0) / "events.csv"))
        many = frames_of(run(FRICTIONAL, 200, 1, "--resume"))
        self.assertGreater(min(many), before)
        self.assertEqual(many[:-1], frames_of(run(FRICTIONAL, 260, 500, "--resume"))[:len(many) - 1])


class Refused(ResumeTest):
    def test_events_to_go_on_from_are_whole_or_refused(self):
        options, whole, part = ("quasistatic.max_events=12",), self.folder / "whole", self.folder / "part"
        for out in (whole, part):
            self.followed(NOTCH, out, *options)
        rows = (whole / "events.csv").read_text().splitlines(keepends=True)

        def resumed(*lines):
            (part / "events.csv").write_text("".join(lines))
            return self.path(NOTCH, part, *options, "--resume")

        for lines, *words in (
                *((rows[:gap] + rows[gap + 1:], "events.csv", "the events to continue", f"line {gap + 1} has the event {gap} where "
                   f"{gap - 1} should be") for gap in (1, 5, len(rows) - 2)),
                ([*rows[:4], rows[5], rows[4], *rows[6:]], "in another order"),
                ([*rows[:3], rows[3][:20] + "\n", *rows[4:]], "line 4"),  # cut in the middle of the table
                (["".join(rows[:3]).replace("tension", "shear", 1)], "events.csv")):
            with self.subTest(words=words):
                self.check_error(resumed(*lines), 2, *words)
        for left in (1, 20, len(rows[-1]) - 2):
            with self.subTest(left=left):
                done = self.check_done(resumed(*rows[:-1], rows[-1][:left]))
                self.assertIn("events.csv: the last line is cut short; going on behind 11 events", done.stderr)
                self.check_same_events(whole, part)
        self.assertNotIn("cut short", self.check_done(resumed("".join(rows)[:-1])).stderr)
        self.check_error(equidem("quasistatic", NOTCH, "--resume"), 2, "--resume has nothing to continue")

    def test_a_kept_state_that_was_altered_is_refused_and_one_that_is_missing_is_computed_again(self):
        options, out = ("quasistatic.max_events=20",), self.folder / "frictional"
        self.followed(FRICTIONAL, out, *options)
        checkpoint = out / "quasistatic.checkpoint.h5"
        kept = bytearray(checkpoint.read_bytes())
        kept[len(kept) // 2] ^= 1
        checkpoint.write_bytes(kept)
        self.check_error(self.path(FRICTIONAL, out, *options, "--resume"), 2, "checksum is wrong")
        self.check_error(self.path(FRICTIONAL, out, *options, "strength.seed=2", "--resume"), 2, ANOTHER)
        checkpoint.unlink()
        self.assertIn("computed again: no state was kept yet", self.followed(FRICTIONAL, out, *options, "--resume").stderr)

    def test_a_key_that_decides_the_path_is_named_where_it_differs(self):
        out, few = self.folder / "out", "quasistatic.max_events=5"
        self.followed(NOTCH, out, few)
        for change, told in (("strength.seed=2", "strength.seed is"), ("support.1.uy=2e-6", "support.1.uy is 1e-06 there and 2e-06"),
                             ("quasistatic.legs=[2.0, 1.0]", "quasistatic.legs is given here alone")):
            self.check_error(self.path(NOTCH, out, few, change, "--resume"), 2, ANOTHER, told)
        for change in ("homogenize.bounds=affine", 'schedule=[{name="ramp", kind="ramp", value=1, start=0, end=1}]'):
            self.followed(NOTCH, out, few, change, "--resume")

    def test_events_of_an_earlier_version_are_refused_by_their_words_and_columns(self):
        out, few = self.folder / "out", "quasistatic.max_events=5"
        self.followed(FRICTIONAL, out, few)
        version = result_in(out)["version"]
        kept, events = (out / "case.toml").read_text(), (out / "events.csv").read_text()
        (out / "case.toml").write_text(kept.replace('"frictional"', '"rubs"'))
        refused = self.path(FRICTIONAL, out, few, "--resume")
        self.check_error(refused, 2, f"before {version}", '"rubs" there', "Choose another --out")
        self.assertNotIn("Take the value", refused.stderr)
        (out / "case.toml").write_text(kept)
        (out / "events.csv").write_text(events.replace("friction_N", "rubbing_N", 1))
        self.check_error(self.path(FRICTIONAL, out, few, "--resume"), 2, f"other than {version}",
                         "'rubbing_N' there and 'friction_N' here")

    BLOCK = ('[assembly]\nkind = "hexagonal"\ncolumns = 5\nrows = 4\nradius = 0.01\n[springs]\nkN = 1e9\nkT = 3e8\n'
             '[[support]]\ngroup = "bottom"\nux = true\nuy = true\n[[load]]\ngroup = "top"\nforce = [0.0, 1e3]\n')

    def test_an_end_without_a_state_leaves_none_of_an_earlier_end_in_the_folder(self):
        case, out = self.write(self.BLOCK + "[strength]\ntension = 1e3\nshear = 1e4\nweibull_modulus = 8.0\n"), self.folder / "out"
        states = [out / name for name in ("discs.csv", "contacts.csv", "state.vtm", "state_discs.vtp", "state_contacts.vtp")]
        self.followed(case, out, "quasistatic.max_events=1")
        self.assertEqual([file.name for file in states if not file.exists()], [])
        self.assertIn("none is written: what is left does not carry its loads", self.followed(case, out, "--resume").stdout)
        self.assertEqual([file.name for file in states if file.exists()], [])

    def test_a_path_that_ends_under_its_dead_loads_says_so_and_draws_no_curve(self):
        pushed = '[[dead_load]]\ngroup = "top"\nforce = [1e3, -1e3]\n[strength]\ntension = 0\nshear = 0\nafter_breaking = "frictional"\n'
        case = self.write(self.BLOCK.replace("hexagonal", "square").replace("columns = 5", "columns = 1") + pushed)
        out = self.folder / "out"
        out.mkdir()
        (out / "curve.svg").write_text("of an earlier path")
        done = self.done("quasistatic", case, "--out", out, "--overwrite")
        self.assertIn("ended while the dead loads were applied: before any of the dead loads acts", done.stdout)
        self.assertEqual(result_in(out)["dead_loads_applied"], 0)
        self.assertEqual([file.name for file in out.glob("curve.*")], [])


if __name__ == "__main__":
    unittest.main()
