#!/usr/bin/env python3
"""Damages one file of a small drive per case, and looks at what dvi makes of it.

    fuzz.py --program build/release/bin/dvi [--cases N] [--seed S] [--case K] [--keep DIR] [--jobs N]

Prints each finding below the command that repeats it, and a table of exits by mutation. Exits with 1 if there are findings.
"""
import random
import shutil
import sys
import tempfile
from collections import Counter
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import NamedTuple

import cases
import classify
import drives
import mutations
from program import Program

HUGE_BYTES = 1 << 30


class Case(NamedTuple):
    number: int
    mutation: str
    what: str
    code: int | None
    findings: list
    cpu: float


def run_case(program, layouts, seed, number, folder):
    """The case of this seed and number: the same mutant on every machine."""
    rng = random.Random(f"{seed}/{number}")
    mutation = mutations.ALL[number % len(mutations.ALL)]
    layout = rng.choice(sorted(layouts))
    source, inner = layouts[layout]
    root = folder / "drive"
    shutil.copytree(source, root)
    path, done = mutations.mutate(root, rng, mutation)
    name = ascii(str(path.relative_to(root)))[1:-1] if path else ""
    code, found, cpu = classify.findings(program, root / inner, folder / "out", path, root)
    return Case(number, mutation.__name__, f"{layout}: {name}: {done}", code, found, cpu)


def not_copied(folder, names):
    """FIFOs, which block, and huge files, which take no disk only until they are copied."""
    paths = [Path(folder) / name for name in names]
    return [path.name for path in paths if path.is_fifo() or path.lstat().st_size > HUGE_BYTES]


def in_folder(program, layouts, seed, number, work, keep):
    folder = work / f"case-{number}"
    folder.mkdir()
    try:
        return run_case(program, layouts, seed, number, folder)
    finally:
        if keep:
            shutil.rmtree(keep / folder.name, ignore_errors=True)
            shutil.copytree(folder, keep / folder.name, symlinks=True, ignore=not_copied)
        shutil.rmtree(folder)


def table(told):
    counts = Counter((case.mutation, case.code) for case in told)
    codes = sorted({case.code for case in told}, key=lambda code: -1 if code is None else code)
    lines = [f"{'mutation':18}" + "".join(f"{'hang' if code is None else f'exit {code}':>9}" for code in codes) + "  findings"]
    for mutation in [m.__name__ for m in mutations.ALL]:
        row = [counts[mutation, code] for code in codes]
        if sum(row):
            bad = sum(1 for case in told if case.mutation == mutation and case.findings)
            lines.append(f"{mutation:18}" + "".join(f"{n or '':>9}" for n in row) + f"{bad or '':>10}")
    return "\n".join(lines)


def main():
    parser = cases.parser(__doc__, 300)
    parser.add_argument("--keep", type=Path, help="copies drives and results to this folder")
    options = parser.parse_args()
    program = Program(options.program.resolve(), options.seconds)
    with tempfile.TemporaryDirectory(prefix="dvi-fuzz-") as temporary:
        work = Path(temporary)
        layouts = drives.all_layouts(Program(program.path), work / "layouts")
        with ThreadPoolExecutor(options.jobs) as pool:
            run = pool.map(lambda n: in_folder(program, layouts, options.seed, n, work, options.keep), cases.numbers(options))
            told = [cases.tell(case, case.mutation, "--case", options.seed) for case in run]
    if options.case is not None:
        print(f"{told[0].mutation}: {told[0].what}: exit {told[0].code}")
    print(table(told))
    bad = sum(1 for case in told if case.findings)
    print(f"{len(told)} cases, {bad} with findings, {sum(c.cpu for c in told) / max(1, len(told)):.2f} CPU s per case")
    return 1 if bad else 0


if __name__ == "__main__":
    sys.exit(main())
