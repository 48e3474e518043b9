#!/usr/bin/env python3
"""Compares this tree with another revision: CPU time of every stage's benchmarks, and the cost of whole runs.

    against.py REV [--rounds N] [--quick]

Builds both, REV in a worktree below build/bench that is removed again, and runs them in turn. This tree is measured
with its uncommitted changes. The command only prints ratios; it does not fail if they are large.
"""
import argparse
import json
import os
import shutil
import subprocess
from contextlib import contextmanager

from cost import ratio_table
from whole_run import ROOT, WORK, Failed, at_least_one, call, drive, guarded, machine, run, say

IN_MS = {"ns": 1e-6, "us": 1e-3, "ms": 1.0, "s": 1e3}


def git(*words):
    return call(["git", "-C", ROOT, *words]).strip()


def commit_of(revision):
    """Its short name. Failed where there is no such revision."""
    asked = ["git", "-C", str(ROOT), "rev-parse", "--short", "--verify", "--quiet", "--end-of-options", revision + "^{commit}"]
    done = subprocess.run(asked, capture_output=True, text=True)
    if done.stderr:
        raise Failed(f"--against needs a git clone: {done.stderr.strip()}")
    if done.returncode != 0:
        raise Failed(f"there is no revision '{revision}': give a commit, branch or tag, such as HEAD~1 (a shallow clone has few)")
    return done.stdout.strip()


@contextmanager
def worktree(commit):
    """The tree of that commit, for as long as it is needed."""
    path = WORK / commit
    remove(path)  # left by a run that was killed
    git("worktree", "add", "--detach", path, commit)
    try:
        yield path
    finally:
        remove(path)


def remove(path):
    if path.exists():
        shutil.rmtree(path)
    git("worktree", "prune")


def build(tree):
    """Its program and benchmarks, by its own preset. ccache, if available, finds the objects of earlier calls."""
    environment = os.environ | {"CCACHE_BASEDIR": str(tree), "CCACHE_NOHASHDIR": "1"}
    say(f"building {tree}")
    call(["cmake", "--preset", "release", "-DDVI_BENCH=ON"], cwd=tree, env=environment)
    call(["cmake", "--build", "build/release", "--target", "dvi", "benches"], cwd=tree, env=environment)


def binaries(tree):
    return tree / "build" / "release" / "bin"


def time_stages(program, seconds):
    """{benchmark: CPU milliseconds} of one of the stages' programs."""
    found = json.loads(call([program, "--benchmark_format=json", f"--benchmark_min_time={seconds}"]))
    room = program.name.removesuffix("_bench").removeprefix("dvi_")
    return {f"{room}: {b['name'].removesuffix('/process_time')}": b["cpu_time"] * IN_MS[b["time_unit"]] for b in found["benchmarks"]}


def in_turn(rounds, before, after):
    """What both give, round by round; who is first changes, since the machine warms up and slows down."""
    old, new = [], []
    for number in range(rounds):
        for measure, into in [(before, old), (after, new)][:: 1 if number % 2 == 0 else -1]:
            into.append(measure())
    return old, new


def compare_stages(base, rounds, seconds):
    """The rounds of all benchmarks: programs one after another, so that both sides of one lie close together in time."""
    old, new = [{} for _ in range(rounds)], [{} for _ in range(rounds)]
    programs = [{path.name: path for path in sorted(binaries(tree).glob("*_bench"))} for tree in (base, ROOT)]
    for name in programs[0] | programs[1]:
        say(f"{name}, {rounds} rounds")
        sides = [lambda path=side.get(name): time_stages(path, seconds) if path else {} for side in programs]
        for into, found in zip((old, new), in_turn(rounds, *sides)):
            for merged, one in zip(into, found):
                merged |= one
    return old, new


def compare_runs(base, rounds, case):
    say(f"whole runs on {case[2]} frames of {case[0]}x{case[1]}, {rounds} rounds")
    target = drive(*case)
    return in_turn(rounds, *(lambda tree=tree: run(binaries(tree) / "dvi", target) for tree in (base, ROOT)))


def main():
    arguments = argparse.ArgumentParser(prog="./dev bench --against", description="CPU time and memory of this tree against REV's.")
    arguments.add_argument("revision", metavar="REV", help="commit, branch or tag")
    arguments.add_argument("--rounds", type=at_least_one, default=5, metavar="N", help="how often each side is measured")
    arguments.add_argument("--quick", action="store_true", help="one round of short benchmarks on a small drive: a look, no measurement")
    arguments = arguments.parse_args()

    rounds, seconds, case = (1, 0.01, (160, 90, 10)) if arguments.quick else (arguments.rounds, 0.2, (640, 360, 40))
    commit = commit_of(arguments.revision)
    with worktree(commit) as base:
        for tree in (base, ROOT):
            build(tree)
        names = (commit, "this tree")
        stages, runs = compare_stages(base, rounds, seconds), compare_runs(base, rounds, case)
    print(f"{machine()}; medians of {rounds} rounds; ratio: this tree / {commit}\n")
    print(ratio_table("benchmarks, CPU ms", names, *stages) + "\n")
    print(ratio_table(f"whole run, {case[0]}x{case[1]}, {case[2]} frames", names, *runs))


if __name__ == "__main__":
    guarded(main)
