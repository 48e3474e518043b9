"""The command line and the output of programs that run numbered cases."""
import argparse
import os
from pathlib import Path

from program import SECONDS


def parser(description, count):
    options = argparse.ArgumentParser(description=description.split("\n")[0])
    options.add_argument("--program", type=Path, required=True)
    options.add_argument("--cases", type=int, default=count)
    options.add_argument("--seed", type=int, default=1)
    options.add_argument("--case", type=int, help="only this one")
    options.add_argument("--jobs", type=int, default=os.cpu_count())
    options.add_argument("--seconds", type=float, default=SECONDS, help="time limit of one call")
    return options


def numbers(options):
    return range(options.cases) if options.case is None else [options.case]


def report(case, kind, option, seed):
    """Prints the findings of a case below the command that repeats it; returns the case."""
    if case.findings:
        print(f"./dev fuzz --seed {seed} {option} {case.number}: {kind}: {case.what}", flush=True)
    for finding in case.findings:
        print(f"    {finding}", flush=True)
    return case
