#!/usr/bin/env python3
"""Measures the cost of runs: CPU seconds per frame by stage and peak memory, by image size, by length of the drive and by number of drives.

    whole_run.py [--quick] [--rounds N]

Runs build/release/bin/dvi on synthetic drives, made once into build/bench/drives.
"""
import argparse
import json
import os
import platform
import signal
import subprocess
import sys
import tempfile
from pathlib import Path

from cost import cost_table, costs, medians

ROOT = Path(__file__).resolve().parent.parent
WORK = ROOT / "build" / "bench"
DVI = ROOT / "build" / "release" / "bin" / "dvi"

# (width, height, frames): three sizes of one length, three lengths of one size.
SIZES = ((320, 180, 20), (640, 360, 20), (1280, 720, 20))
LENGTHS = ((640, 360, 20), (640, 360, 40), (640, 360, 80))
QUICK_SIZES = ((160, 90, 10), (320, 180, 10))
QUICK_LENGTHS = ((320, 180, 10), (320, 180, 20))
# (width, height, frames) of each drive, and how many days of the street go into a run.
DRIVES, DAYS = (320, 180, 20), (1, 2, 3, 4, 5)
QUICK_DAYS = (1, 2)


class Failed(Exception):
    """Something did not go as it must, in words for the user."""


def say(text):
    print(text, file=sys.stderr, flush=True)


def call(command, **more):
    """Runs it; its own words are shown only if it fails."""
    done = subprocess.run([str(word) for word in command], capture_output=True, text=True, **more)
    if done.returncode != 0:
        raise Failed(f"{' '.join(str(word) for word in command)}\nfailed with {done.returncode}:\n{done.stdout}{done.stderr}".rstrip())
    return done.stdout


def drive(width, height, frames, day=1):
    """The synthetic drive, made if it is not there. A stop leaves no half a drive under its name."""
    path = WORK / "drives" / (f"{width}x{height}-{frames}" + (f"-day{day}" if day > 1 else ""))
    if not path.is_dir():
        say(f"making {path.relative_to(ROOT)}")
        path.parent.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryDirectory(dir=path.parent) as folder:
            made = Path(folder) / "drive"
            call([DVI, "synth", "-o", made, "--width", width, "--height", height, "--frames", frames, "--day", day,
                  "--quiet"])
            made.rename(path)
    return path


def run(program, *drives):
    """The costs of one run, the target's drive first; its result is not kept."""
    WORK.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory(dir=WORK, prefix="out-") as out:
        call([program, "run", *drives, "-o", Path(out) / "result", "--quiet"])
        return costs(json.loads((Path(out) / "result" / "report.json").read_text(encoding="utf-8")))


def measure(cases, rounds):
    """{case: costs}, the medians of so many runs each, in turn, so that a busy minute of the machine hits all alike. A case is
    width, height, frames and number of drives."""
    found = {case: [] for case in cases}
    drives = {case: [drive(*case[:3], day) for day in range(1, case[3] + 1)] for case in cases}
    for number in range(rounds):
        for case in cases:
            say(f"round {number + 1} of {rounds}: {', '.join(path.name for path in drives[case])}")
            found[case].append(run(DVI, *drives[case]))
    return {case: medians(runs) for case, runs in found.items()}


def machine():
    """The machine of the measurement."""
    models = [line.split(":", 1)[1].strip() for line in Path("/proc/cpuinfo").read_text(encoding="utf-8").splitlines()
              if line.startswith("model name")]
    return f"{models[0] if models else platform.machine()}, {len(os.sched_getaffinity(0))} cores"


def guarded(main):
    """Runs main; failures in words, and on SIGTERM as on Ctrl-C everything temporary is removed."""
    signal.signal(signal.SIGTERM, lambda *_: sys.exit(143))
    try:
        main()
    except Failed as failure:
        sys.exit(f"bench: {failure}")
    except KeyboardInterrupt:
        sys.exit(130)


def at_least_one(text):
    if (value := int(text)) < 1:
        raise ValueError
    return value


def main():
    arguments = argparse.ArgumentParser(prog="./dev bench whole", description="The cost of runs by image size, length and number of drives.")
    arguments.add_argument("--quick", action="store_true", help="smaller and shorter drives: a minute")
    arguments.add_argument("--rounds", type=at_least_one, default=3, metavar="N", help="runs of each, of which medians are shown")
    arguments = arguments.parse_args()

    sizes, lengths = (QUICK_SIZES, QUICK_LENGTHS) if arguments.quick else (SIZES, LENGTHS)
    days = QUICK_DAYS if arguments.quick else DAYS
    cases = [(*size, 1) for size in sizes + lengths] + [(*DRIVES, count) for count in days]
    found = measure(list(dict.fromkeys(cases)), arguments.rounds)
    print(f"{machine()}; CPU s per frame, medians of {arguments.rounds} runs\n")
    print(cost_table(f"{sizes[0][2]} frames", {f"{w}x{h}": found[w, h, n, 1] for w, h, n in sizes}) + "\n")
    print(cost_table(f"{lengths[0][0]}x{lengths[0][1]}", {f"{n} frames": found[w, h, n, 1] for w, h, n in lengths}) + "\n")
    print(cost_table(f"{DRIVES[0]}x{DRIVES[1]}, a frame of the target", {f"{n} drive{'s' * (n > 1)}": found[*DRIVES, n] for n in days}))


if __name__ == "__main__":
    guarded(main)
