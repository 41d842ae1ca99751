# SPDX-License-Identifier: GPL-3.0-or-later
"""Programs that are killed at random times, and then given the same command again, end with the same bytes.

    run_kills.py PROGRAM SOURCE_FOLDER [--kills N] [--seed S] [--report FILE]

N is 12 unless given; half of the kills are SIGKILL, the others SIGTERM. The same commands on one thread and on two end with
the same bytes, too. The numbers for the page of hard cases: run_kills.py PROGRAM SOURCE_FOLDER --kills 100 --report
data/hard_cases/kills.json
"""
import argparse
import json
import pathlib
import random
import shutil
import signal
import sys
import tempfile
import time

import h5py

from program import CASES, CELL, ENSEMBLE, NO_PICTURE, STUDY, TENSION, VARYING, equidem, files_of, started

OFTEN = (NO_PICTURE, "output.checkpoint_interval=0.02")
SUPPORT, LOAD = 'support=[{group = "bottom", ux = 0.0, uy = 0.0}]', 'load=[{group = "top", kind = "total", force = [0.0, 1.0]}]'
# Name: command, and the file from which --resume goes on, or None
JOBS = {
    "run, bonded discs": (("run", CASES / "run_shake.toml", *OFTEN, "run.duration=0.01", "run.step_rule=bound"), "run.checkpoint.h5"),
    "run, colliding bodies": (("run", CASES / "grains_shaken.toml", *OFTEN, "shaking.start=0.02", "run.duration=0.1",
                               "output.probe_interval=4e-3"), "run.checkpoint.h5"),
    "quasistatic, frictional contacts": (("quasistatic", CASES / "frictional_notch.toml", *OFTEN, "quasistatic.max_events=200",
                                          "quasistatic.frame_every=30"), "quasistatic.checkpoint.h5"),
    "pack, growth": (("pack", CASES / "pack_jammed.toml", "packing.grains=150"), None),
    "pack, falling": (("pack", CASES / "pack_soil.toml", "packing.grains=60", "packing.box=[0.15, 1.0]"), None),
    "solve": (("solve", TENSION, "assembly.columns=81", "assembly.rows=81"), None),
    "stability": (("stability", CELL), None),
    "homogenize": (("homogenize", CELL, "assembly.discs=3000"), None),
    "homogenize, ensemble": (("homogenize", ENSEMBLE, "ensemble.discs=[50, 100]", "ensemble.samples=60"), "samples.csv"),
    "homogenize --accuracy": (("homogenize", CELL, "--accuracy", "0.01"), None),
    "sweep": (("sweep", TENSION, "--key", "ratio", "--values", "0,0.1,0.2,0.3,0.4,0.5,0.6,0.7,0.8,0.9,1", "test=none",
               SUPPORT, LOAD), "sweep.csv"),
    "calibrate": (("calibrate", CASES / "calibrate_random.toml"), None),
    "study": (("study", STUDY, "--rounds", 3, "--budget", 0), None),
}


def lasting(value):
    """JSON without what varies."""
    if isinstance(value, list):
        return [lasting(entry) for entry in value]
    if isinstance(value, dict):
        return {key: lasting(entry) for key, entry in value.items() if key not in VARYING}
    return value


def datasets(path):
    found = {}
    with h5py.File(path, "r") as file:
        file.visititems(lambda name, item: found.update({name: item[()].tobytes()}) if isinstance(item, h5py.Dataset) else None)
    return found


def contents(name, out):
    """Bytes of every file; of JSON what does not vary; of a page whether it is whole; of a checkpoint all arrays but the counters of
    work (the neighbours are searched once more where a run goes on); of a study, whose tables hold measured times, the errors."""
    files = files_of(out)
    for path in files:
        if path == "result.json":
            files[path] = lasting(json.loads(files[path]))
        elif path == "index.html":  # it tells times; the film is among the arrays of the checkpoint
            files[path] = files[path].endswith(b"</html>\n")
        elif path.endswith(".checkpoint.h5"):
            files[path] = {key: value for key, value in datasets(out / path).items() if key != "counters"}
    if name == "study":
        return {"files": sorted(files), "errors": [[row["setting"], row["errors"]] for row in files["result.json"]["settings"]]}
    return files


class Killing:
    def __init__(self, seed, folder):
        self.random = random.Random(seed)
        self.folder = folder
        self.findings = []

    def command(self, name, out, threads=1):
        given, resumed_from = JOBS[name]
        again = "--resume" if resumed_from and (out / resumed_from).exists() else "--overwrite"
        return [*given, "--out", out, "--threads", threads, "--quiet",
                *([] if name == "study" else [again])]  # a study goes on of itself

    def whole(self, name, threads=1):
        out = self.folder / f"whole_{list(JOBS).index(name)}_{threads}"
        shutil.rmtree(out, ignore_errors=True)
        began = time.monotonic()
        done = equidem(*self.command(name, out, threads), timeout=600)
        if done.returncode != 0:
            raise SystemExit(f"{name}: {done.stderr}")
        return out, time.monotonic() - began

    def compare(self, name, wanted, found, what):
        a, b = contents(name, wanted), contents(name, found)
        different = sorted(set(a) ^ set(b)) or [file for file in a if a[file] != b[file]]
        for file in different:
            keys = ""
            if isinstance(a.get(file), dict) and file in b:
                keys = ": " + ", ".join(key for key in a[file] if a[file][key] != b[file].get(key))
            self.find(f"{name}, {what}: {file}{keys}")

    def find(self, text):
        self.findings.append(text)
        print(text, file=sys.stderr)

    def kill_once(self, name, out, seconds, how):
        """Whether the program was still at work when it was killed."""
        with started(*self.command(name, out)) as running:
            time.sleep(self.random.uniform(0, 1) * seconds)
            running.send_signal(how)
            errors = running.communicate(timeout=120)[1]
        if running.returncode not in (0, 130, -signal.SIGKILL, -signal.SIGTERM):
            self.find(f"{name}, {how.name}: exit code {running.returncode}: {errors.strip()}")
        return running.returncode != 0

    def kill(self, name, kills):
        """Kill a job so often, at times all over its length, in a folder that goes on two kills long."""
        wanted, seconds = self.whole(name)
        done = idle = 0
        out = self.folder / "killed"
        while done < kills and idle < 20:
            shutil.rmtree(out, ignore_errors=True)
            for _ in range(2):
                how = signal.SIGKILL if self.random.random() < 0.5 else signal.SIGTERM
                if done < kills and self.kill_once(name, out, seconds, how):
                    done += 1
                else:
                    idle += 1
            again = equidem(*self.command(name, out), timeout=600)
            if again.returncode != 0:
                self.find(f"{name}, again: exit code {again.returncode}: {again.stderr.strip()}")
                continue
            self.compare(name, wanted, out, "killed")
        return done

    def threads(self, name):
        self.compare(name, self.whole(name)[0], self.whole(name, 2)[0], "two threads")


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--kills", type=int, default=12)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--only", help="a word of the names of the jobs that are killed", default="")
    parser.add_argument("--report")
    arguments = parser.parse_args()
    with tempfile.TemporaryDirectory(prefix="equidem_test_") as folder:
        killing = Killing(arguments.seed, pathlib.Path(folder))
        names = [name for name in JOBS if arguments.only in name]
        if arguments.kills < len(names):  # a short run: what can be resumed first
            names.sort(key=lambda name: JOBS[name][1] is None)
        kills = {name: 0 for name in names}
        for k in range(arguments.kills):
            kills[names[k % len(names)]] += 1
        done = {name: killing.kill(name, count) for name, count in kills.items() if count > 0}
        for name in names if arguments.kills >= len(names) else names[:4]:
            killing.threads(name)
    report = {"command": f"tests/program/run_kills.py PROGRAM SOURCE_FOLDER --kills {arguments.kills} --seed {arguments.seed}",
              "kills": done, "threads_compared": [1, 2], "findings": killing.findings}
    print(json.dumps(report, indent=2))
    if arguments.report:
        pathlib.Path(arguments.report).write_text(json.dumps(report, indent=2) + "\n", encoding="utf-8")
    return 1 if killing.findings or sum(done.values()) < arguments.kills else 0


if __name__ == "__main__":
    sys.exit(main())
