#!/usr/bin/env python3
"""Disturbs runs of dvi, and compares what comes out at last with an undisturbed run.

    faults.py --program build/release/bin/dvi [--cases N] [--seed S] [--case K] [--jobs N]

Prints each finding below the command that repeats it, and a table of cases by scenario. Exits with 1 if there are findings.
"""
import argparse
import os
import random
import shutil
import sys
import tempfile
import time
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import NamedTuple

sys.path.insert(0, str(Path(__file__).resolve().parent.parent / "fuzz"))

import drives  # noqa: E402
import scenarios  # noqa: E402
from program import SECONDS, Program  # noqa: E402
from results import contents  # noqa: E402


class Case(NamedTuple):
    number: int
    scenario: str
    what: str
    findings: list


class Undisturbed:
    """A drive, and what a run makes of it when nothing happens."""

    def __init__(self, program, work):
        self.drive, self.out = drives.synthetic(program, work / "drive"), work / "undisturbed"
        begun = time.monotonic()
        ended = program.call("run", self.drive, "-o", self.out)
        self.seconds = time.monotonic() - begun
        if ended.code != 0:
            raise SystemExit(f"faults: an undisturbed run exits with {ended.code}: {ended.err}")
        self.expected = contents(self.out)


def run_case(program, undisturbed, seed, number, work):
    scenario, folder = scenarios.ALL[number % len(scenarios.ALL)], work / f"case-{number}"
    folder.mkdir()
    scene = scenarios.Scene(program, undisturbed, folder, random.Random(f"faults {seed}/{number}"))
    try:
        return Case(number, scenario.__name__, *scenario(scene))
    finally:
        shutil.rmtree(folder)


def table(cases):
    lines = [f"{'scenario':18}{'cases':>9}{'findings':>10}"]
    for name in dict.fromkeys(scenario.__name__ for scenario in scenarios.ALL):
        mine = [case for case in cases if case.scenario == name]
        if mine:
            lines.append(f"{name:18}{len(mine):>9}{sum(1 for case in mine if case.findings) or '':>10}")
    return "\n".join(lines)


def tell(case, seed):
    """The case's findings, below the command that repeats it."""
    if case.findings:
        print(f"./dev fuzz --seed {seed} --fault {case.number}: {case.scenario}: {case.what}", flush=True)
    for finding in case.findings:
        print(f"    {finding}", flush=True)
    return case


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--program", type=Path, required=True)
    parser.add_argument("--cases", type=int, default=40)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--case", type=int, help="only this one; moments in time are never quite the same")
    parser.add_argument("--jobs", type=int, default=os.cpu_count())
    parser.add_argument("--seconds", type=float, default=SECONDS, help="time limit of one call")
    options = parser.parse_args()
    program = Program(options.program.resolve(), options.seconds)
    numbers = range(options.cases) if options.case is None else [options.case]
    with tempfile.TemporaryDirectory(prefix="dvi-faults-") as temporary:
        work = Path(temporary)
        undisturbed = Undisturbed(program, work)
        with ThreadPoolExecutor(options.jobs) as pool:
            run = pool.map(lambda n: run_case(program, undisturbed, options.seed, n, work), numbers)
            cases = [tell(case, options.seed) for case in run]
    if options.case is not None:
        print(f"{cases[0].scenario}: {cases[0].what}")
    print(table(cases))
    bad = sum(1 for case in cases if case.findings)
    skipped = sum(1 for case in cases if case.what.startswith("skipped"))
    print(f"{len(cases)} faults, {bad} with findings" + (f", {skipped} skipped" if skipped else ""))
    return 1 if bad else 0


if __name__ == "__main__":
    sys.exit(main())
