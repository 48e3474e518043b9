#!/usr/bin/env python3
"""Runs the fuzz targets of the parsers, each for some seconds, and prints their findings.

    parsers.py --build build/asan-ubsan [--seconds N] [--seed S] [--only NAME] [--jobs N]

Prints a line for each target, below each finding the command that repeats it. Exits with 1 if there are findings. Inputs that
show one are kept in BUILD/findings.
"""
import argparse
import os
import re
import shutil
import subprocess
import sys
import tempfile
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import NamedTuple

CORPUS = Path(__file__).resolve().parent / "corpus"
LIMITS = ("-timeout=10", "-rss_limit_mb=1024", "-malloc_limit_mb=256")  # an input has 4 KB
OPTIONS = {"ASAN_OPTIONS": "detect_stack_use_after_return=1:strict_string_checks=1", "UBSAN_OPTIONS": "print_stacktrace=1"}


class Outcome(NamedTuple):
    """The numbers of inputs of a target, and of edges and features of the code that they reached."""
    name: str
    executions: int
    edges: int
    features: int
    findings: list


def counts(log):
    """Returns (executions, edges, features) from the output of libFuzzer."""
    printed = re.findall(r"^#(\d+)\s.* cov: (\d+) ft: (\d+)", log, re.M)
    runs, edges, features = printed[-1] if printed else (0, 0, 0)
    done = re.search(r"^stat::number_of_executed_units: (\d+)", log, re.M)
    return int(done[1] if done else runs), int(edges), int(features)


def headline(log):
    """Returns the line that describes the error."""
    for pattern in (r"dvi: does not hold: .*", r".*: Assertion .* failed", r".*: runtime error: .*",
                    r"terminate called after .*(?:\n +what\(\).*)?", r"ERROR: (?:AddressSanitizer|LeakSanitizer|libFuzzer): .*"):
        if found := re.search(pattern, log):
            return " ".join(found[0].split())
    return "ended without a message"


def run(program, seconds, seed, kept):
    """Runs one target on its seeds, in a folder in memory if the system has one."""
    name = program.name.removeprefix("parse_")
    with tempfile.TemporaryDirectory(prefix="dvi-parsers-", dir="/dev/shm" if os.path.isdir("/dev/shm") else None) as temporary:
        folder = Path(temporary)
        for part in ("corpus", "found"):
            (folder / part).mkdir()
        call = [program, folder / "corpus", CORPUS / name, f"-max_total_time={seconds}", f"-seed={seed}", "-print_final_stats=1",
                f"-artifact_prefix={folder}/found/", *LIMITS]
        done = subprocess.run(call, env={**os.environ, **OPTIONS, "TMPDIR": temporary}, stdin=subprocess.DEVNULL,
                              stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, check=False)
        log = done.stderr.decode("utf-8", "backslashreplace")
        findings = []
        for artifact in sorted((folder / "found").iterdir()):
            kept.mkdir(exist_ok=True)
            shutil.copy(artifact, kept / f"{name}-{artifact.name}")
            findings.append(f"{headline(log)}\n    {program} {kept / f'{name}-{artifact.name}'}")
        if done.returncode != 0 and not findings:
            findings.append(f"exit {done.returncode}: {headline(log)}\n    {program} {CORPUS / name}")
    return Outcome(name, *counts(log), findings)


def main():
    options = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    options.add_argument("--build", type=Path, required=True)
    options.add_argument("--seconds", type=int, default=30)
    options.add_argument("--seed", type=int, default=1)
    options.add_argument("--only", default="*", help="the name of a target")
    options.add_argument("--jobs", type=int, default=os.cpu_count())
    arguments = options.parse_args()
    programs = sorted(arguments.build.resolve().glob(f"bin/parse_{arguments.only}"))
    if not programs:
        sys.exit(f"parsers: {arguments.build} has no target '{arguments.only}'")
    print(f"{'parser':20}{'executions':>12}{'edges':>8}{'features':>10}", flush=True)
    with ThreadPoolExecutor(arguments.jobs) as pool:
        outcomes = []
        for outcome in pool.map(lambda p: run(p, arguments.seconds, arguments.seed, arguments.build.resolve() / "findings"), programs):
            print(f"{outcome.name:20}{outcome.executions:12}{outcome.edges:8}{outcome.features:10}", flush=True)
            for finding in outcome.findings:
                print(f"  {finding}", flush=True)
            outcomes.append(outcome)
    bad = sum(1 for outcome in outcomes if outcome.findings)
    print(f"{len(outcomes)} parsers, {sum(o.executions for o in outcomes)} executions, {bad} with findings")
    return 1 if bad else 0


if __name__ == "__main__":
    sys.exit(main())
