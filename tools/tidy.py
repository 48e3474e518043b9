#!/usr/bin/env python3
"""Runs clang-tidy on the .cpp files named on stdin, and remembers what passed.

    tidy.py --build build/release [--jobs N] [--alone]

Files of one room are read together: most of the time goes into the headers of libraries, which are then read once. With
--alone each file is read by itself, for the checks that ask for it. What passed is left out until one of its files, a header
of the project that they include, or .clang-tidy changes.
"""
import argparse
import hashlib
import os
import re
import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor
from itertools import groupby
from pathlib import Path

from check_layers import includes

ROOT = Path(__file__).resolve().parent.parent
PASSED = ROOT / "build" / "tidy"
UNIT = 12  # files read together
# The first looks at the main file only; the second grows with the square of the files read together.
ALONE = ["misc-include-cleaner", "performance-unnecessary-value-param"]


def with_headers(file, known=None):
    """The file and all headers of the project that it includes, directly or not."""
    known = set() if known is None else known
    if file not in known:
        known.add(file)
        for _, name in includes(file):
            if (header := ROOT / "src" / name).is_file():
                with_headers(header, known)
    return known


def fingerprint(files, checks):
    digest = hashlib.sha256((ROOT / ".clang-tidy").read_bytes() + checks.encode())
    for part in sorted(set().union(*map(with_headers, files))):
        digest.update(str(part.relative_to(ROOT)).encode() + b"\0" + part.read_bytes())
    return digest.hexdigest()


def findings(output):
    """What clang-tidy found, without missing includes: what one's own header includes need not be included again."""
    blocks = re.split(r"^(?=\S+:\d+:\d+: (?:warning|error):)", output, flags=re.MULTILINE)
    return [block for block in blocks if block.strip() and "no header providing" not in block.splitlines()[0]]


def tidy(file, checks, build):
    """Empty if the file is in order."""
    command = ["clang-tidy-19", "--quiet", "-p", build, f"--checks={checks}", "--extra-arg=-Wno-unknown-warning-option", file]
    done = subprocess.run(command, capture_output=True, text=True, cwd=ROOT)
    broken = done.returncode != 0 and not done.stdout.strip()
    return done.stderr if broken else "".join(findings(done.stdout))


class Unit:
    """Files that are read together."""

    def __init__(self, files, checks):
        self.files, self.checks = files, checks
        self.mark = PASSED / fingerprint(files, checks)
        self.name = str(files[0].relative_to(ROOT)) + (f" and {len(files) - 1} more" if len(files) > 1 else "")

    def tidy(self, build):
        if len(self.files) == 1:
            return tidy(self.files[0], self.checks, build)
        source = self.mark.with_suffix(".cpp")
        source.write_text("".join(f'#include "{file}"\n' for file in self.files))
        try:
            return tidy(source, self.checks, build)
        finally:
            source.unlink()


def units(files, alone):
    if alone:
        return [Unit([file], "-*," + ",".join(ALONE)) for file in files]
    checks = ",".join(f"-{check}" for check in ALONE)
    rooms = groupby(sorted(files), key=lambda file: file.parent)
    return [Unit(part, checks) for _, room in rooms for part in in_parts(list(room))]


def in_parts(files):
    """Of about the same size, none larger than a unit."""
    count = -(-len(files) // UNIT)
    return [files[len(files) * k // count:len(files) * (k + 1) // count] for k in range(count)]


def main():
    arguments = argparse.ArgumentParser()
    arguments.add_argument("--build", required=True)
    arguments.add_argument("--jobs", type=int, default=os.cpu_count())
    arguments.add_argument("--alone", action="store_true")
    arguments = arguments.parse_args()

    PASSED.mkdir(parents=True, exist_ok=True)
    every = units([ROOT / line.strip() for line in sys.stdin if line.strip()], arguments.alone)
    due = [unit for unit in every if not unit.mark.exists()]
    print(f"clang-tidy: {len(due)} of {len(every)} units are new or changed", flush=True)

    failed = 0
    with ThreadPoolExecutor(arguments.jobs) as pool:
        for number, (unit, output) in enumerate(zip(due, pool.map(lambda u: u.tidy(arguments.build), due)), 1):
            print(f"[{number}/{len(due)}] {unit.name}{': FAILED' if output else ''}", flush=True)
            if output:
                failed += 1
                print(output.replace(f"{ROOT}/", ""), flush=True)
            else:
                unit.mark.touch()
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
