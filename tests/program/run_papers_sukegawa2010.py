#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""equidem-papers sukegawa2010, as a user does: run_papers_sukegawa2010.py PROGRAM SOURCE_FOLDER [unittest options]."""
import csv
import json
import unittest

from program import ProgramTest, equidem, parse_json

SHAPES = ("discs", "ellipses", "bonded_pairs", "rigid_pairs")


def numbers(result):
    """Of each run what does not depend on the machine."""
    return {run["name"]: {key: value for key, value in run.items() if key != "seconds"} for run in result["runs"]}


class Sukegawa2010(ProgramTest):
    def test_tables_pictures_and_going_on(self):
        out = self.folder / "out"
        command = ("sukegawa2010", "--quick", "--out", out, "--json", "-")
        result = parse_json(self.check_done(equidem(*command)).stdout)
        self.assertEqual(result["status"], "done")
        self.assertEqual(len(result["runs"]), result["planned"])
        runs = {run["name"]: run for run in result["runs"]}

        for shape in SHAPES:
            run = runs[f"{shape}_1_400gal_10Hz"]
            self.assertLess(0.1, run["void_ratio_before"], shape)
            self.assertLess(run["void_ratio_before"], 0.3, shape)
            self.assertLess(run["centre_height_m"], run["centre_height_before_m"], shape)
            for end in ("_start.png", "_filled.png"):
                self.assertTrue((out / f"{shape}_1{end}").exists(), shape + end)
            for name in (f"{shape}_1_400gal_10Hz_after.png", f"{shape}_1_400gal_10Hz_during.png",
                         f"{shape}_paths.png", f"{shape}_falling_y.png", f"{shape}_shaken_angle.csv"):
                self.assertTrue((out / name).exists(), name)
        discs = [run["void_ratio_before"] for run in result["runs"] if run["shape"] == "discs"]
        self.assertLess(runs["ellipses_1_400gal_10Hz"]["void_ratio_before"], min(discs))
        self.assertGreater(runs["discs_1_1200gal_2Hz"]["largest_slope"],
                           10 * runs["discs_1_400gal_10Hz"]["largest_slope"])
        self.assertGreater(runs["bonded_pairs_1_400gal_10Hz"]["bond_creep"], 0)
        self.assertIsNone(runs["rigid_pairs_1_400gal_10Hz"]["bond_creep"])

        # Forces in increments are those of the library: with the whole force limited the packing is as dense; with
        # (2.16) it is looser, with beta = 1.05 as loose as discs that much larger.
        def before(variant):
            return runs[f"discs_{variant}_1_400gal_10Hz"]["whole_void_ratio_before"]
        self.assertLess(min(before("increments_capped"), max(discs)), before("increments"))
        self.assertLess(abs(before("increments_capped") - runs["discs_1_400gal_10Hz"]["whole_void_ratio_before"]), 0.02)
        self.assertLess(before("printed_integrator"), 0.35)
        self.assertGreater(before("beta_1.05"), before("increments") + 0.05)
        # rho = (1 + e) gamma in springs and masses: the same motion but for rounding, until it grows.
        self.assertAlmostEqual(before("bulk_density"), runs["discs_1_400gal_10Hz"]["whole_void_ratio_before"], 3)
        self.assertTrue((out / "discs_shakings.png").exists())

        page = (out / "discs_1_1200gal_2Hz.html").read_text(encoding="utf-8")
        self.assertTrue(page.startswith("<!DOCTYPE html>"))
        self.assertLess(len(page), 2_000_000)
        report = (out / "report.txt").read_text(encoding="utf-8")
        for words in ("0.213", "0.139", "1.85 s follows from neither", "(7.2) as printed", "8.5.2", "NOT DECIDED",
                      "rejection, growth, gravity", "as printed: step "):
            self.assertIn(words, report)
        with open(out / "runs.csv", newline="", encoding="utf-8") as file:
            self.assertEqual([row["run"] for row in csv.DictReader(file)], list(runs))

        # Again on one thread, with a filling and a shaking of it taken away: the same bits.
        for name in ("discs_2.h5", "discs_2_400gal_10Hz.json", "discs_1_400gal_10Hz.json"):
            (out / "runs" / name).unlink()
        again = parse_json(self.check_done(equidem(*command, "--threads", "1")).stdout)
        self.assertEqual(numbers(again), numbers(result))

        # A run of other settings is not taken for one of these.
        kept = out / "runs" / "discs_3_400gal_10Hz.json"
        kept.write_text(json.dumps(dict(json.loads(kept.read_text(encoding="utf-8")), settings="others")),
                        encoding="utf-8")
        self.check_error(equidem(*command), 2, "other settings", "discs_3_400gal_10Hz.json", "--out")
        kept.unlink()

        # Nor is one that was altered.
        for name in ("discs_1_400gal_10Hz.json", "discs_1_400gal_10Hz.csv", "discs_1.csv"):
            path = out / "runs" / name
            good = path.read_bytes()
            at = good.rindex(b".") + 1
            path.write_bytes(good[:at] + bytes([good[at] ^ 1]) + good[at + 1:])
            self.check_error(equidem(*command), 2, "altered", name.replace(".csv", ".json"))
            path.write_bytes(good)

    def test_options_of_other_papers_are_refused(self):
        self.check_error(equidem("sukegawa2010", "--rows", "5"), 2, "--rows", "sukegawa2010")

    def test_interrupted_it_stops_soon_and_can_go_on(self):
        out = self.folder / "out"
        stdout, stderr = self.interrupt("sukegawa2010", "--out", out, "--quiet")
        self.assertEqual(stdout, "")
        self.assertIn("same command again", stderr)


if __name__ == "__main__":
    unittest.main()
