# SPDX-License-Identifier: GPL-3.0-or-later
"""What holds for every verb: run_every_verb.py PROGRAM SOURCE_FOLDER [unittest options]."""
import os
import re
import shutil
import unittest

from program import (CASES, CELL, COMMANDS, ENSEMBLE, NO_PICTURE, STUDY, TENSION, ProgramTest, equidem, files_of, flat,
                     lasting, numbers_of, result_in)

LATTICE, RANDOM, STRENGTH = (CASES / f"calibrate_{name}.toml" for name in ("lattice", "random", "strength"))
SHAKE, REST, NOTCH = CASES / "run_shake.toml", CASES / "run_tension.toml", CASES / "notched_plate.toml"
ROCK = (CASES / "packed_rock.toml", "packing.grains=80", "packing.solid_fraction=0.8")

class Numbers(ProgramTest):
    def test_results_have_the_documented_keys(self):
        every = "status report times effects version"
        for verb, keys in (("solve", "unknowns relative_residual negative_pivots poisson_ratio stiffness_ratio strain stress"),
                           ("homogenize", "stiffness stress_asymmetry shear_modulus bulk_modulus_2d poisson_ratio young_modulus anisotropy "
                            "coordination_number solid_fraction fabric bounds rattlers mechanisms self_stresses error_bound "
                            "relative_residual condition unknowns"),
                           ("calibrate", "kN kT ratio achieved iterations factorizations feasible_poisson_ratio method"),
                           ("run", "steps time_step critical_time_step energy particle_steps_per_second time_step_ratio discs contacts "
                            "bytes_per_disc")):
            with self.subTest(verb=verb):
                self.assertEqual({*every.split(), *keys.split()} - set(self.result(*COMMANDS[verb])), set())

    def test_every_number_has_unit_and_label(self):
        shaken = ("run.duration=2e-3", "shaking.start=1e-3")
        for command in (*(command for verb, command in COMMANDS.items() if verb not in ("quasistatic", "export", "study")),
                        ("solve", CASES / "cantilever.toml"), ("solve", CASES / "truss.toml"),
                        ("solve", TENSION, "--accuracy", "1e-2"),
                        ("homogenize", CASES / "hexagonal_cell.toml"), ("homogenize", CASES / "free_sample.toml"),
                        ("homogenize", CASES / "restrained_rotation.toml"), ("calibrate", *ROCK), ("stability", TENSION),
                        ("stability", CELL, "assembly.discs=30", "springs.kT=-1e8"), ("pack", *ROCK),
                        ("pack", CASES / "pack_pairs.toml", "--dry-run"), ("pack", CASES / "pack_soil.toml", "packing.grains=30"),
                        ("run", CASES / "run_pulse.toml", "--dry-run"), ("run", CASES / "grains_shaken.toml", *shaken),
                        ("run", CASES / "grains_bonded.toml"), ("sweep", TENSION, "--key", "springs.kT", "--values", "0,1e9")):
            with self.subTest(command=command):
                result = self.result(*command)
                found = {path for path, _ in numbers_of({key: entry for key, entry in result.items()
                                                         if key not in ("units", "labels")},
                                                        positions=False)}
                self.assertGreater(len(found), 2)
                self.assertEqual(sorted(found - set(result["units"])), [])
                self.assertEqual(set(result["units"]), set(result["labels"]))

    def test_units_are_those_of_the_report(self):
        moduli = self.result("homogenize", CASES / "hexagonal_cell.toml")
        self.assertEqual([moduli["units"][name] for name in ("young_modulus.plane_strain", "error_bound")], ["Pa", "Pa"])
        self.assertEqual(moduli["labels"]["poisson_ratio.plane_strain"], "Poisson's ratio nu, plane strain")
        solved = self.result(*COMMANDS["solve"])["units"]
        self.assertEqual((solved["energy"], solved["error_bound"]), ("N", ""))
        cradle = self.result(*COMMANDS["grains"])
        self.assertEqual(cradle["units"]["energy.kinetic"], "J" if cradle["body"] == "sphere" else "J/m")
        text = self.done("help", "result").stdout
        for words in ('"units"', '"labels"', "poisson_ratio", "Pa", "critical_time_step"):
            self.assertIn(words, text)

    def test_the_numbers_do_not_depend_on_the_number_of_threads(self):
        wide = ("run", SHAKE, "run.duration=2e-3", "assembly.rows=61")
        sweep = ("sweep", ROCK[0], "--verb", "homogenize", *ROCK[1:], "--seeds", "1-4")
        packed = ("homogenize", ROCK[0], "packing.grains=none", "ensemble={discs = [40, 80], samples = 4}")
        for name, command in {**COMMANDS, "solve": ("solve", CASES / "delaunay_tension.toml"), "homogenize": ("homogenize", CELL),
                              "calibrate": ("calibrate", RANDOM), "run": wide, "sweep": sweep, "packed ensemble": packed}.items():
            if name in ("export", "study"):  # of one thread; of measured times
                continue
            results = []
            for threads in (1, 2, 3):
                with self.subTest(command=name, threads=threads):
                    out = self.folder / f"{name}_{threads}"
                    self.done(*command, "--threads", threads, "--out", out, NO_PICTURE)
                    results.append(lasting(result_in(out)))
                    self.assertEqual(results[-1], results[0])
                    self.assertEqual({path: content for path, content in files_of(out).items() if path.endswith((".csv", ".vtp"))},
                                     {path: content for path, content in files_of(self.folder / f"{name}_1").items()
                                      if path.endswith((".csv", ".vtp"))})


class Files(ProgramTest):
    def test_files_are_written_and_the_echoed_case_repeats_them(self):
        state = "discs{0}.csv contacts{0}.csv state{0}.vtm picture{0}.svg picture{0}.png"
        three = " ".join(state.format(f"_strain_{component}") for component in ("xx", "yy", "xy"))
        for name, files in (("solve", state.format("")), ("homogenize", three),
                            ("ensemble", "ensemble.csv samples.csv shear_modulus.png poisson_ratio.png scatter.png"),
                            ("calibrate", "springs.toml assembly.json"),
                            ("stability", "dispersion.csv dispersion_plot.svg dispersion_plot.png critical_ratio_plot.png"),
                            ("pack", "grains.csv assembly.json picture.png"), ("run", "discs.csv history.csv frames.pvd energy.csv"),
                            ("rest", "discs.csv state.vtm"), ("grains", "grains.csv energy.csv"),
                            ("quasistatic", "events.csv curve.csv cracks.svg")):
            with self.subTest(command=name):
                first, again = self.folder / name / "first", self.folder / name / "again"
                done = self.done(*COMMANDS[name], "--out", first)
                self.assertIn(str(first), done.stderr)
                self.check_there(first, *files.split(), "result.json", "case.toml", "index.html")
                self.done(COMMANDS[name][0], first / "case.toml", "--out", again)
                self.assertEqual(lasting(result_in(again)), lasting(result_in(first)))
                self.check_same_files(first, again, "case.toml", *(path.name for path in first.glob("*.csv")))

    def test_nothing_is_overwritten_unasked(self):
        for name, command in COMMANDS.items():
            if name == "study":  # goes on where it ended
                continue
            out, kept = self.folder / name, self.folder / f"{name}_kept"
            self.done(*command, "--out", out)
            files = sorted(path.name for path in out.iterdir() if path.is_file())
            for file in files:
                with self.subTest(command=name, file=file):
                    kept.mkdir()
                    (kept / file).write_text("mine")
                    done = equidem(*command, "--out", kept)
                    self.check_error(done, 2, file, "exists already", "--overwrite")
                    self.assertEqual((kept / file).read_text(), "mine")
                    self.assertEqual(list(files_of(kept)), [file])
                shutil.rmtree(kept)
            before = set(files_of(out))
            (out / "notes.txt").write_text("mine")
            self.done(*command, "--out", out, "--overwrite")
            self.assertEqual(set(files_of(out)), {*before, "notes.txt"})

    def test_outputs_are_checked_before_anything_is_computed_or_written(self):
        obstacle = self.write("", "file")
        target, same, locked = self.write("mine", "x.json"), self.folder / "same.json", self.folder / "locked"
        out, missing = self.folder / "out", self.folder / "missing" / "springs.toml"
        out.mkdir()
        self.check_errors(
            (("solve", TENSION, "--out", obstacle / "out"), "cannot write", "not a folder"),
            (("solve", TENSION, "--json", self.folder), "cannot write", "folder"),
            (("solve", TENSION, "--json", target), "x.json", "exists already"),
            (("homogenize", CELL, "--json", missing), "there is no folder", str(missing.parent)),
            (("calibrate", LATTICE, "--springs", missing), "no folder", "missing"),
            (("calibrate", LATTICE, "--springs", target), "exists already", "--overwrite"),
            (("calibrate", LATTICE, "--json", same, "--springs", same), "both", str(same)),
            (("calibrate", LATTICE, "--out", out, "--springs", out / ".." / "out" / "case.toml"), "both"))
        self.assertEqual((target.read_text(), list(out.iterdir()), same.exists(), missing.parent.exists()),
                         ("mine", [], False, False))
        if os.geteuid() != 0:  # root may write everywhere
            locked.mkdir(mode=0o500)
            self.check_errors((("solve", TENSION, "--out", locked / "out"), "cannot write", "locked"),
                              (("homogenize", CELL, "output.assembly=hdf5", "--out", locked), "cannot write"))

    def test_quiet_says_nothing(self):
        for name, command in COMMANDS.items():
            with self.subTest(command=name):
                done = self.done(*command, "--quiet", *(("--out", self.folder / "model") if name == "export" else ()))
                self.assertEqual((done.stdout, done.stderr), ("", ""))

    def test_what_a_verb_does_not_use_is_told(self):
        acted = self.write(STRENGTH.read_text() + '[[support]]\ngroup = "left"\nux = true\n[[load]]\ngroup = "right"\nforce = [1.0, 0.0]\n'
                           "[quasistatic]\nlegs = [1.0]\n")
        small = ("assembly.discs=120", "strength_target.samples=2")
        tests = "not used [[support]], [[load]], [quasistatic]: the tests of"
        damped = ("run.damping.contact=0.1", "run.time_step=1e-6", "output.frame_interval=1e-6")
        for told, *command in (("[[notch]]: quasistatic alone takes them", "solve", NOTCH),
                               ("not used [test]: ", "homogenize", TENSION),
                               ("not used [ensemble]", "stability", ENSEMBLE, "assembly.discs=12"),
                               ("not used time_step, [run.damping], frame_interval: ", "run", REST, *damped),
                               (tests, "calibrate", acted, *small), (tests, "calibrate", acted, *small, "--dry-run"),
                               (None, "calibrate", STRENGTH, *small, "--dry-run"), (None, "homogenize", CELL), (None, "run", REST)):
            with self.subTest(command=command):
                report = self.report(*command)
                if told:
                    self.assertIn(told, report)
                else:
                    self.assertNotIn("not used", report)


class DryRuns(ProgramTest):
    def dry(self, *command):
        """What a dry run prints; it writes nothing."""
        out = self.folder / "none"
        result = self.result(*command, "--dry-run", "--out", out)
        self.assertEqual(result["status"], "dry_run")
        self.assertFalse(out.exists())
        return result

    def test_a_dry_run_tells_the_size_and_writes_nothing(self):
        for name, command in {**COMMANDS, "shake": ("run", SHAKE), "between": ("run", CASES / "grains_between_walls.toml")}.items():
            with self.subTest(command=name):
                size = self.dry(*command)
                if name in ("solve", "homogenize", "calibrate", "stability"):
                    self.assertGreater(size["peak_bytes"], size["solver_bytes"])
                    self.assertNotIn("estimated_seconds", size)
                done = {} if name == "export" else self.result(*command)
                for key in {"solve": ("unknowns", "factor_nonzeros"), "run": ("steps",), "shake": ("steps",),
                            "between": ("steps",)}.get(name, ()):
                    self.assertEqual(size[key], done[key], key)

    def test_each_verb_has_its_own_sizes(self):
        self.assertEqual(self.dry(*COMMANDS["export"])["bonds"], 1210)
        self.assertEqual(self.dry("homogenize", CELL)["factorizations"], 3)
        random = self.dry("calibrate", RANDOM)
        names = re.findall(r"^(\S.{14})", random["report"], re.MULTILINE)
        self.assertEqual(len(names), len(set(names)), names)
        self.assertGreater(random["unknowns"], 5000)
        self.assertGreater(self.dry("calibrate", STRENGTH)["peak_bytes"], 0)
        hexagonal = COMMANDS["stability"]
        self.assertLess(self.dry(*hexagonal)["element_bound_time_step"], self.result(*hexagonal)["critical_time_step"])
        self.assertNotIn("critical_ratio", self.dry(*hexagonal))
        path = self.dry("quasistatic", NOTCH)
        self.assertEqual(path["method"], "multifrontal")
        self.assertGreater(path["peak_bytes"], 0)
        self.assertNotIn("events", path)
        self.assertIn("multiplications and additions to factorize", flat(path["report"]))
        self.assertGreater(self.dry("homogenize", CELL)["unknowns"], 1000)
        shake = self.dry("run", SHAKE)
        self.assertGreater(shake["estimated_seconds"], 0)
        self.assertRegex(shake["report"], r"steps +3 \d\d\d, about ")
        self.assertIn("3 000", self.dry("pack", CASES / "pack_soil.toml")["report"])
        self.assertEqual(self.dry("study", STUDY, "--rounds", 3, "--budget", 0)["number_of_settings"], 10)
        sweep = self.dry("sweep", TENSION, "--key", "ratio", "--values", "0,1", "--key", "assembly.rows", "--values", "9,11,13")
        self.assertEqual(sweep["number_of_points"], 6)
        self.assertIn("6 points of ratio, assembly.rows", sweep["report"])
        self.assertGreater(sweep["unknowns"], 100)
        failing = self.dry("sweep", TENSION, "--key", "springs.kN", "--values", "-1,1e9")
        self.assertIn("2 points of springs.kN; point 2:", failing["report"])
        ensemble = COMMANDS["ensemble"]
        self.assertEqual(self.dry(*ensemble)["unknowns"], [60, 120])
        self.assertIn("would be refused: solving a network of 1 000 000 000 discs needs",
                      self.report(*ensemble, "ensemble.discs=[30, 1000000000]", "--dry-run"))

    def test_a_dry_run_says_where_the_memory_does_not_suffice(self):
        limited = "solver.memory_limit=1e5"
        size = self.dry("solve", TENSION, limited)
        self.assertIn("would be refused", size["report"])
        self.assertIn("memory_limit", size["refusal"])
        self.check_error(equidem("solve", TENSION, limited), 1, "are allowed by memory_limit")
        self.assertIsNone(self.dry("solve", TENSION)["refusal"])


if __name__ == "__main__":
    unittest.main()
