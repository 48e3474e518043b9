#!/usr/bin/env python3
"""Changes a small drive in each case, and checks the behavior of dvi.

Most mutations damage one file. Others (foreign.py) write the drive as other programs do; then dvi must not
write a wrong result without a warning: if it succeeds without a new warning, the result must be as good as that of the unchanged
drive.

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
from threading import Lock
from typing import NamedTuple

import cases
import classify
import drives
import foreign
import mutations
import silent
from program import Program

HUGE_BYTES = 1 << 30
MUTATIONS = mutations.ALL + foreign.ALL
# Changes that no program can detect, with the reason, by (mutation, start of its description).
UNNOTICEABLE = {
}


class Case(NamedTuple):
    number: int
    mutation: str
    what: str
    code: int | None
    findings: list
    cpu: float


class Layouts:
    """The drives to change, and the result of a run on each unchanged drive, which is made on demand."""

    def __init__(self, program, folder):
        self.program, self.folder = program, folder
        self.drives = drives.all_layouts(program, folder / "layouts")
        self.lock, self.references = Lock(), {}

    def reference(self, name):
        with self.lock:
            if name not in self.references:
                layout, folder = self.drives[name], self.folder / "reference"
                drive = Path(shutil.copytree(layout.folder, folder / "drive")) / layout.inner  # warnings name it as those of a case
                self.references[name] = silent.reference(self.program, drive, folder / "out", layout.truths)
                shutil.rmtree(folder)
            return self.references[name]


def must_be_noticed(mutation, done):
    return mutation in foreign.ALL and not any(mutation.__name__ == name and done.startswith(start) for name, start in UNNOTICEABLE)


def changed_drive(layouts, rng, mutation, root):
    """Copies a drive that the mutation applies to, and applies it; returns (name of the layout, the path, the description)."""
    for layout in rng.sample(sorted(layouts.drives), len(layouts.drives)):
        shutil.copytree(layouts.drives[layout].folder, root)
        path, done = mutations.mutate(root, rng, mutation)
        if path:
            break
        shutil.rmtree(root)
    else:
        shutil.copytree(layouts.drives[layout].folder, root)
    return layout, path, done


def run_case(program, layouts, seed, number, folder):
    """Runs the case of this seed and number; its mutant is the same on every machine."""
    rng = random.Random(f"{seed}/{number}")
    mutation, root = MUTATIONS[number % len(MUTATIONS)], folder / "drive"
    layout, path, done = changed_drive(layouts, rng, mutation, root)
    name = ascii(str(path.relative_to(root)))[1:-1] if path else ""
    expected = layouts.reference(layout) if path and must_be_noticed(mutation, done) else None
    code, found, cpu = classify.findings(program, root / layouts.drives[layout].inner, folder / "out", path, root, expected)
    return Case(number, mutation.__name__, f"{layout}: {name}: {done}", code, found, cpu)


def not_copied(folder, names):
    """Returns FIFOs, which block, and sparse huge files, which need much space when they are copied."""
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


def table(results):
    counts = Counter((case.mutation, case.code) for case in results)
    codes = sorted({case.code for case in results}, key=lambda code: -1 if code is None else code)
    lines = [f"{'mutation':18}" + "".join(f"{'hang' if code is None else f'exit {code}':>9}" for code in codes) + "  findings"]
    for mutation in [m.__name__ for m in MUTATIONS]:
        row = [counts[mutation, code] for code in codes]
        if sum(row):
            bad = sum(1 for case in results if case.mutation == mutation and case.findings)
            lines.append(f"{mutation:18}" + "".join(f"{n or '':>9}" for n in row) + f"{bad or '':>10}")
    return "\n".join(lines)


def main():
    parser = cases.parser(__doc__, 300)
    parser.add_argument("--keep", type=Path, help="copies drives and results to this folder")
    options = parser.parse_args()
    program = Program(options.program.resolve(), options.seconds)
    with tempfile.TemporaryDirectory(prefix="dvi-fuzz-") as temporary:
        work = Path(temporary)
        layouts = Layouts(Program(program.path), work)
        with ThreadPoolExecutor(options.jobs) as pool:
            run = pool.map(lambda n: in_folder(program, layouts, options.seed, n, work, options.keep), cases.numbers(options))
            results = [cases.report(case, case.mutation, "--case", options.seed) for case in run]
    if options.case is not None:
        print(f"{results[0].mutation}: {results[0].what}: exit {results[0].code}")
    print(table(results))
    bad = sum(1 for case in results if case.findings)
    print(f"{len(results)} cases, {bad} with findings, {sum(c.cpu for c in results) / max(1, len(results)):.2f} CPU s per case")
    return 1 if bad else 0


if __name__ == "__main__":
    sys.exit(main())
