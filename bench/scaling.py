#!/usr/bin/env python3
"""How the time of a run falls with the number of threads: predicted from its tasks, and measured on the cores of this machine.

    ./dev bench scaling [DRIVE] [ARGS of dvi run...]

Without a drive, a synthetic street of 48 frames of 1242x375 pixels. Prints a table.
"""
import argparse
import os
import sys
import tempfile
import time
from pathlib import Path

from replay import read, replay
from tables import cell, table
from whole_run import DVI, ROOT, WORK, call, drive, guarded, machine, say

STREET = (1242, 375, 48)
THREADS = (1, 2, 4, 8, 16)


def run(path, more, threads, trace=None):
    """Seconds of a run. Its tasks are written to `trace`."""
    environment = dict(os.environ, **({"DVI_TASK_TRACE": str(trace)} if trace else {}))
    with tempfile.TemporaryDirectory(dir=WORK, prefix="out-") as out:
        begun = time.monotonic()
        call([DVI, "run", path, "-o", Path(out) / "result", "--threads", threads, "--quiet", *more], env=environment)
        return time.monotonic() - begun


def rows_of(stages, threads):
    """Per stage, the seconds with each number of threads; the last row is the sum."""
    rows = [(name, [replay(work, count) for count in threads]) for name, work in stages]
    return [*rows, ("whole run", [sum(seconds) for seconds in zip(*(each for _, each in rows))])]


def main(arguments):
    parser = argparse.ArgumentParser(prog="./dev bench scaling", description=__doc__.splitlines()[0])
    parser.add_argument("drive", nargs="?", type=Path, help="the drive (default: a synthetic street)")
    given, more = parser.parse_known_args(arguments)
    path = given.drive or drive(*STREET)
    WORK.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory(dir=WORK, prefix="trace-") as folder:
        trace = Path(folder) / "trace"
        say("a run with one thread")
        measured = {1: run(path, more, 1, trace)}
        stages = read(trace)
    for count in THREADS[1:]:
        if count <= os.cpu_count():
            say(f"a run with {count} threads")
            measured[count] = run(path, more, count)
    rows = rows_of(stages, THREADS)
    whole = rows[-1][1]
    print(f"{path.name}, {machine()}; predicted seconds of each stage by the number of threads:\n")
    print(table(["stage", *map(str, THREADS)],
                [[name, *(cell(each, 2) for each in seconds)] for name, seconds in rows if seconds[0] >= 0.05 or name == "whole run"]
                + [["predicted speedup", *(cell(whole[0] / each, 2) for each in whole)],
                   ["measured speedup", *(cell(measured[1] / measured[each], 2) if each in measured else "-" for each in THREADS)]]))


if __name__ == "__main__":
    guarded(lambda: main(sys.argv[1:]))
