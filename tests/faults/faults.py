#!/usr/bin/env python3
"""Disturbs runs of dvi, and compares their results with the result of an undisturbed run.

    faults.py --program build/release/bin/dvi [--cases N] [--seed S] [--case K] [--jobs N]

Prints each finding below the command that repeats it, and a table of cases by scenario. Exits with 1 if there are findings.
"""
import random
import shutil
import sys
import tempfile
import time
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import NamedTuple

sys.path.insert(0, str(Path(__file__).resolve().parent.parent / "fuzz"))

import cases  # noqa: E402
import drives  # noqa: E402
import scenarios  # noqa: E402
from program import Program  # noqa: E402
from results import contents  # noqa: E402


class Case(NamedTuple):
    number: int
    scenario: str
    what: str
    findings: list


class Undisturbed:
    """A drive, and the result of an undisturbed run."""

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


def table(done):
    lines = [f"{'scenario':18}{'cases':>9}{'findings':>10}"]
    for name in dict.fromkeys(scenario.__name__ for scenario in scenarios.ALL):
        mine = [case for case in done if case.scenario == name]
        if mine:
            lines.append(f"{name:18}{len(mine):>9}{sum(1 for case in mine if case.findings) or '':>10}")
    return "\n".join(lines)


def main():
    options = cases.parser(__doc__, 40).parse_args()  # with --case, the times of signals differ
    program = Program(options.program.resolve(), options.seconds)
    with tempfile.TemporaryDirectory(prefix="dvi-faults-") as temporary:
        work = Path(temporary)
        undisturbed = Undisturbed(program, work)
        with ThreadPoolExecutor(options.jobs) as pool:
            run = pool.map(lambda n: run_case(program, undisturbed, options.seed, n, work), cases.numbers(options))
            done = [cases.report(case, case.scenario, "--fault", options.seed) for case in run]
    if options.case is not None:
        print(f"{done[0].scenario}: {done[0].what}")
    print(table(done))
    bad = sum(1 for case in done if case.findings)
    skipped = sum(1 for case in done if case.what.startswith("skipped"))
    print(f"{len(done)} faults, {bad} with findings" + (f", {skipped} skipped" if skipped else ""))
    return 1 if bad else 0


if __name__ == "__main__":
    sys.exit(main())
