#!/usr/bin/env python3
"""How cost grows with the length of a drive and with the number of source drives, written to docs/growth.md.

    ./dev bench growth [--frames N] [--sources N]

Runs build/release/bin/dvi on synthetic drives of small images, the short ones first. Finished runs are not repeated;
Ctrl-C stops, and the same command resumes.
"""
import argparse
import hashlib
import json
import sys
import tempfile
from pathlib import Path

from cost import costs
from page import commit
from scoring import read_json, write_json, write_text
from tables import cell, table
from whole_run import DVI, ROOT, WORK, at_least_one, call, guarded, machine, say

LENGTHS = (40, 80, 160, 320, 640, 1280, 2560)  # frames
SOURCES, SOURCE_FRAMES = (1, 2, 4, 8, 16), 24   # drives beside the target, and how long each is
SCENE = ("--width", 160, "--height", 90, "--beams", 16, "--columns", 450)
# Small, so that drives of this size reach the bound.
BOUNDS = ("--set", "job.memory_mb=250")
FIGURES = ("CPU s per frame", "peak MB", "MB on disk per frame")


def drive(frames, day=1, reverse=False):
    """The synthetic drive, made if it is not there. An interruption leaves no incomplete drive under its name."""
    path = WORK / "growth/drives" / f"{frames}-day{day}{'-reverse' * reverse}"
    if not path.is_dir():
        say(f"making {path.relative_to(ROOT)}")
        path.parent.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryDirectory(dir=path.parent) as folder:
            made = Path(folder) / "drive"
            call([DVI, "synth", "-o", made, "--frames", frames, "--day", day, *["--reverse"] * reverse, *SCENE, "--quiet"])
            made.rename(path)
    return path


def days_of_a_street(count):
    """The target and `count` source drives: the same street on other days, from the ninth on in the opposite direction."""
    return [drive(SOURCE_FRAMES), *(drive(SOURCE_FRAMES, 2 + i % 8, i >= 8) for i in range(count))]


def bytes_in(folder):
    return sum(file.stat().st_size for file in folder.rglob("*") if file.is_file())


def measure(name, drives):
    """The costs of a run; those of an earlier call with the same program are read."""
    result = WORK / "growth/results" / f"{name}.json"
    key = hashlib.sha256(DVI.read_bytes() + repr((SCENE, BOUNDS, SOURCE_FRAMES)).encode()).hexdigest()[:16]
    known = read_json(result)
    if known and known["key"] == key:
        return known["costs"]
    paths = drives()
    say(f"running {name}")
    with tempfile.TemporaryDirectory(dir=WORK, prefix="out-") as folder:
        out = Path(folder) / "result"
        call([DVI, "run", *paths, "-o", out, *BOUNDS, "--quiet"])
        report = json.loads((out / "report.json").read_text(encoding="utf-8"))
        found = costs(report) | {"MB on disk per frame": bytes_in(out) / report["cost"]["frames_made"] / 1e6}
    result.parent.mkdir(parents=True, exist_ok=True)
    write_json(result, {"key": key, "costs": found})
    return found


def rows_of(columns):
    """One line per stage with any cost, in ms per frame, then the other figures."""
    names = list(dict.fromkeys(name for column in columns.values() for name in column))
    other = ("peak MB", "MB on disk per frame", "hole, 1000 px per frame")
    rows = []
    for name in names:
        if name == "wall s per frame":
            continue
        values = [column.get(name) for column in columns.values()]
        if name in other:
            digits = 2 if name.startswith("MB") else 1 if name.startswith("hole") else 0
            rows.append([name, *(cell(value, digits) for value in values)])
        elif max(value or 0 for value in values) >= 0.0005:
            what = "**CPU ms per frame**" if name == "CPU s per frame" else f"&nbsp;&nbsp;{name.strip()}" if name[0] == " " else name
            rows.append([what, *(cell(None if value is None else 1000 * value, 1) for value in values)])
    return rows


def plot(lengths, sources, file):
    import matplotlib
    matplotlib.use("svg")
    import matplotlib.pyplot as plt
    matplotlib.rcParams["svg.hashsalt"] = "growth"
    figure, axes = plt.subplots(2, len(FIGURES), figsize=(11, 5.6), layout="constrained")
    for row, (found, label) in enumerate(((lengths, "frames"), (sources, "source drives"))):
        for axis, figure_name in zip(axes[row], FIGURES):
            values = [costs_of[figure_name] for costs_of in found.values()]
            axis.plot(list(found), values, "o-", color="#0072b2")
            axis.set(xscale="log", xlabel=label, title=figure_name, ylim=(0, 1.08 * max(values)))
            axis.set_xticks(list(found), [str(n) for n in found])
            axis.minorticks_off()
            axis.grid(alpha=0.3)
    file.parent.mkdir(parents=True, exist_ok=True)
    figure.savefig(file, metadata={"Date": None})


def write_page(lengths, sources, command, target=ROOT / "docs/growth.md"):
    plot(lengths, sources, target.parent / "images/growth.svg")
    text = f"""# How cost grows
<!-- Written by ./dev bench growth. -->
Synthetic streets of 160x90 px and 16 beams; `{' '.join(BOUNDS)}`. Figures are CPU milliseconds per frame
of the target by stage (the indented stages are parts of `completion` and `fill`), the peak memory, and the size of the result.

- Machine: {machine()}
- Commit: `{commit()}`
- Command: `{command}`

![CPU, memory and bytes by length and by source drives](images/growth.svg)

## By length
{table(["frames", *map(str, lengths)], rows_of(lengths))}
## By source drives
A target of {SOURCE_FRAMES} frames, and source drives of the same street on other days, of {SOURCE_FRAMES} frames each;
from the ninth on, driven in the opposite direction.

{table(["source drives", *map(str, sources)], rows_of(sources))}"""
    write_text(target, text)


def main():
    parser = argparse.ArgumentParser(prog="./dev bench growth", description=__doc__.splitlines()[0])
    parser.add_argument("--frames", type=at_least_one, default=LENGTHS[-1], metavar="N", help="no drives longer than this")
    parser.add_argument("--sources", type=at_least_one, default=SOURCES[-1], metavar="N", help="no more source drives than this")
    options = parser.parse_args()
    WORK.mkdir(parents=True, exist_ok=True)
    lengths = {n: measure(f"frames-{n}", lambda n=n: [drive(n)]) for n in LENGTHS if n <= options.frames}
    sources = {n: measure(f"sources-{n}", lambda n=n: days_of_a_street(n)) for n in SOURCES if n <= options.sources}
    write_page(lengths, sources, " ".join(["./dev bench growth", *sys.argv[1:]]))
    say("docs/growth.md is written")


if __name__ == "__main__":
    guarded(main)
