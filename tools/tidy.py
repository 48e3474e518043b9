#!/usr/bin/env python3
"""Runs clang-tidy on the .cpp files named on stdin, and remembers which passed.

    tidy.py --build build/release [--jobs N]

A file that passed is left out until it, a header of the project that it includes, or .clang-tidy changes.
"""
import argparse
import hashlib
import os
import re
import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

from check_layers import includes

ROOT = Path(__file__).resolve().parent.parent


def with_headers(file, known=None):
    """The file and all headers of the project that it includes, directly or not."""
    known = set() if known is None else known
    if file not in known:
        known.add(file)
        for _, name in includes(file):
            if (header := ROOT / "src" / name).is_file():
                with_headers(header, known)
    return known


def fingerprint(file):
    digest = hashlib.sha256((ROOT / ".clang-tidy").read_bytes())
    for part in sorted(with_headers(file)):
        digest.update(str(part.relative_to(ROOT)).encode() + b"\0" + part.read_bytes())
    return digest.hexdigest()


def findings(output):
    """What clang-tidy found, without missing includes: what one's own header includes need not be included again."""
    blocks = re.split(r"^(?=\S+:\d+:\d+: (?:warning|error):)", output, flags=re.MULTILINE)
    return [block for block in blocks if block.strip() and "no header providing" not in block.splitlines()[0]]


def tidy(file, build):
    """Empty if the file is in order."""
    command = ["clang-tidy-19", "--quiet", "-p", build, "--extra-arg=-Wno-unknown-warning-option", file]
    done = subprocess.run(command, capture_output=True, text=True, cwd=ROOT)
    broken = done.returncode != 0 and not done.stdout.strip()
    return done.stderr if broken else "".join(findings(done.stdout))


def main():
    arguments = argparse.ArgumentParser()
    arguments.add_argument("--build", required=True)
    arguments.add_argument("--jobs", type=int, default=os.cpu_count())
    arguments = arguments.parse_args()

    passed = ROOT / "build" / "tidy"
    passed.mkdir(parents=True, exist_ok=True)
    files = [(ROOT / line.strip()) for line in sys.stdin if line.strip()]
    marks = {file: passed / fingerprint(file) for file in files}
    due = [file for file in files if not marks[file].exists()]
    print(f"clang-tidy: {len(due)} of {len(files)} files are new or changed", flush=True)

    failed = 0
    with ThreadPoolExecutor(arguments.jobs) as pool:
        for number, (file, output) in enumerate(zip(due, pool.map(lambda f: tidy(f, arguments.build), due)), 1):
            print(f"[{number}/{len(due)}] {file.relative_to(ROOT)}{': FAILED' if output else ''}", flush=True)
            if output:
                failed += 1
                print(output.replace(f"{ROOT}/", ""), flush=True)
            else:
                marks[file].touch()
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
