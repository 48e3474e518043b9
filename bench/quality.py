#!/usr/bin/env python3
"""Measures quality on cases with a truth: all methods, written to docs/benchmarks.md, or all ablations, to docs/ablations.md.

    ./dev bench quality [--quick] [--external NAME=DIR]... [--drive NAME=PATH[@A:B]]...
    ./dev bench quality --ablations [--drive NAME=PATH[@A:B]]... [--constant NAME=VALUE]...
    ./dev bench quality --quick --constant NAME=VALUE...

Finished parts are not run again; Ctrl-C stops, and the same command resumes.
"""
import argparse
import os
import sys
import time
from collections.abc import Callable, Sequence
from pathlib import Path

import cases
import constants
import page
import variants
from cases import Case
from page import Outcome
from scoring import Failed, Scorer
from variants import Variant

TREE = Path(__file__).resolve().parent.parent


def say(text: str) -> None:
    print(text, file=sys.stderr, flush=True)


def minutes(seconds: float) -> str:
    return f"{seconds:.0f} s" if seconds < 100 else f"{seconds / 60:.0f} min"


class Progress:
    """Counts the runs, and prints the number, the name, and the remaining time of each."""

    def __init__(self, due: int):
        self.due, self.done, self.begun = due, 0, time.monotonic()

    def report(self, what: str) -> None:
        passed = time.monotonic() - self.begun
        left = f", {minutes(passed / self.done * (self.due - self.done))} left" if self.done else ""
        self.done += 1
        say(f"[{self.done} of {self.due}] {what}{left}")

    def skip(self, count: int) -> None:
        self.due -= count


def plan(chosen: list[Case], methods: list[Variant], ablations: list[Variant],
         masked: Sequence[Case] = ()) -> list[tuple[Case, list[Variant]]]:
    """The runs in order: all methods before any ablation, and real drives first; dvi before other methods, because its result
    determines the pixels to compare and the frames to show. Each ablation runs on all cases, so that its table has whole rows.
    Only dvi runs on cases with mask errors, with and without the completion of objects."""
    others = [method for method in methods if method != variants.DVI]
    chosen = sorted(chosen, key=lambda case: case.group == cases.STREET)
    return ([(case, [variants.DVI, *others]) for case in chosen]
            + [(case, [variants.DVI, variants.AS_GIVEN] if case.mask_errors else [variants.DVI])
               for case in masked if case not in chosen]
            + [(case, [ablation]) for ablation in ablations for case in chosen
               if case.ablated and variants.applies(ablation, case)])


def attempt(outcome: Outcome, case: Case, what: str, work: Callable[[], dict | None]) -> bool:
    """Whether the work succeeded. A failure is printed and listed on the page."""
    try:
        if (result := work()) is not None:
            outcome.results[case.name, what] = result
            if result.get("audit"):
                say(f"{case.name}: {what} fails the audit: {result['audit']}")
        return True
    except Failed as why:
        say(f"{case.name}: {what} failed: {why}")
        outcome.failures.append((case.name, what, str(why)))
        return False


def run_all(scorer: Scorer, outcome: Outcome, until: float = float("inf")) -> None:
    """Runs everything that can begin before a time of the monotonic clock; the rest is missing on the page."""
    todo = plan(outcome.cases, outcome.methods, outcome.ablations, outcome.masked)
    due = [(case, [variant for variant in row if scorer.known(case, variant) is None]) for case, row in todo]
    progress = Progress(sum(len(row) for _, row in due))
    failed: set[str] = set()  # cases without a result of dvi: there is nothing to compare with
    for (case, row), (_, missing) in zip(todo, due):
        if case.name in failed:
            progress.skip(len(missing))
            continue
        if missing and not attempt(outcome, case, "making the case", lambda: scorer.make(case)):
            progress.skip(len(missing))
            failed.add(case.name)
            continue
        for variant in row:
            if variant not in missing:
                outcome.results[case.name, variant.name] = scorer.known(case, variant)
                continue
            if time.monotonic() > until:
                continue
            progress.report(f"{case.name}: {variant.name}")
            worked = attempt(outcome, case, variant.name, lambda: scorer.score(case, variant, variant in outcome.methods))
            if not worked and variant == variants.DVI:
                progress.skip(len(missing) - 1)
                failed.add(case.name)
                break


def run_externals(scorer: Scorer, outcome: Outcome, externals: dict[str, Path]) -> None:
    for name, folder in externals.items():
        for case in outcome.cases:
            frames = folder / case.name
            if (case.name, variants.DVI.name) not in outcome.results:
                continue
            if not frames.is_dir():
                say(f"{name}: no folder {frames}: left out")
                continue
            say(f"{case.name}: {name}")
            attempt(outcome, case, name, lambda: scorer.external(case, name, frames))


def build_changed(changes: list[constants.Change]) -> list[Variant]:
    """An ablation for each change of a constant. NotBuilt if one does not compile."""
    rows = []
    for change in changes:
        say(f"building the program with {change.label}")
        rows.append(variants.changed_constant(change, constants.build(TREE, TREE / "build/bench/constants", change)))
    return rows


def list_constants() -> str:
    return "\n".join(f"{constant.label} = {constant.value}" + (f"  // {constant.comment}" if constant.comment else "")
                     for constant in constants.find(TREE))


def choose_cases(recordings: list[cases.Recording], quick: bool) -> list[Case]:
    chosen = cases.street() + [case for recording in recordings for case in cases.held_out(recording)]
    if not quick:
        return chosen
    first = recordings[0].name if recordings else None
    return [case for case in chosen if case.name in ("street-exact", "street-two-days", f"{first}-lead")]


def choose_masked(recordings: list[cases.Recording], quick: bool) -> list[Case]:
    if quick:
        return []
    return cases.street_masks() + [case for recording in recordings for case in cases.held_out_masks(recording)]


def parse_external(text: str) -> tuple[str, Path]:
    """NAME=DIR. ValueError otherwise."""
    name, equals, folder = text.partition("=")
    if not (name and equals and folder) or "/" in name:
        raise ValueError(f"--external {text}: expected NAME=DIR")
    if name in [variant.name for variant in (*variants.METHODS, variants.AS_GIVEN, *variants.ABLATIONS)] or name.startswith("paper-"):
        raise ValueError(f"--external {text}: '{name}' is a variant of dvi's; take another name")
    if not Path(folder).is_dir():
        raise ValueError(f"--external {text}: {folder} is not a folder; expected DIR/CASE/NAME.png")
    return name, Path(folder)


def parse(arguments: list[str]) -> argparse.Namespace:
    parser = argparse.ArgumentParser(prog="./dev bench quality", description=__doc__.splitlines()[0])
    parser.add_argument("--quick", action="store_true",
                        help="three cases, all methods: about 5 minutes; with --constant two cases, and its ablations only; writes to "
                             "build/bench/quality/quick/")
    parser.add_argument("--ablations", action="store_true",
                        help="the default method with one part switched off or changed, instead of the methods")
    parser.add_argument("--minutes", type=float, default=float("inf"), metavar="N",
                        help="begin no run after N minutes, and write the page with the finished ones")
    parser.add_argument("--external", action="append", default=[], metavar="NAME=DIR",
                        help="frames of another program, DIR/CASE/NAME.png, join the tables")
    parser.add_argument("--drive", action="append", default=[], metavar="NAME=PATH[@A:B]",
                        help="a recording of your own, beside the KITTI raw drives found in $DVI_DATA")
    parser.add_argument("--constant", action="append", default=[], metavar="[MODULE::]NAME=VALUE",
                        help="implies --ablations: one more, which builds the program with another value of a constant, such as "
                             "STRUCT.FIELD")
    parser.add_argument("--list-constants", action="store_true", help="print all constants and their values, and end")
    parser.add_argument("--dvi", type=Path, default=TREE / "build/release/bin/dvi", help="the program")
    options = parser.parse_args(arguments)
    try:
        options.external = dict(map(parse_external, options.external))
        options.drive = list(map(cases.parse_recording, options.drive))
        known = constants.find(TREE) if options.constant else []
        options.constant = list(dict.fromkeys(constants.parse_change(text, known) for text in options.constant))
    except ValueError as wrong:
        parser.error(str(wrong))
    if options.quick and options.ablations:
        parser.error("--quick --ablations: of ablations, --quick runs those of --constant only")
    options.ablations |= bool(options.constant)
    if options.ablations and options.external:
        parser.error("--external: frames of another program are compared with methods, not with ablations")
    return options


def choose(given: argparse.Namespace, changed: list[Variant]) -> Outcome:
    """What to run."""
    drives = recordings(given.drive)
    differing = variants.differences(*(variants.options(given.dvi, method) for method in ("dvi", "paper")))
    chosen = choose_cases(drives, given.quick)
    if given.ablations:
        ablations = () if given.quick else (*variants.ABLATIONS, *variants.published_switches(differing))
        return Outcome([case for case in chosen if case.ablated], [variants.DVI], [*ablations, *changed], differing, [], {}, [])
    return Outcome(chosen, list(variants.METHODS), [], differing, list(given.external), {}, [], choose_masked(drives, given.quick))


def recordings(named: list[cases.Recording]) -> list[cases.Recording]:
    found = cases.find_recordings(Path(os.environ["DVI_DATA"])) if "DVI_DATA" in os.environ else []
    if not found:
        say("no KITTI raw drives in $DVI_DATA: without virtual traffic in them")
    return named + found


def main(arguments: list[str]) -> int:
    given = parse(arguments)
    if given.list_constants:
        print(list_constants())
        return 0
    try:
        changed = build_changed(given.constant)
    except constants.NotBuilt as why:
        say(str(why))
        return 1
    root = TREE / "build/bench/quality"
    scorer = Scorer(given.dvi, root)
    outcome = choose(given, changed)
    run_all(scorer, outcome, time.monotonic() + 60 * given.minutes)
    outcome.cases[:] = [case for case in outcome.cases if (case.name, variants.DVI.name) in outcome.results]
    run_externals(scorer, outcome, given.external)
    name, folder = "ablations" if given.ablations else "benchmarks", root / "quick" if given.quick else TREE / "docs"
    target, images = folder / f"{name}.md", folder / "images" / name
    command = "./dev bench quality " + " ".join(arguments)
    if given.ablations:
        page.write_ablations(target, images, outcome, command)
    else:
        page.write(target, images, outcome, scorer, command)
    print(target)
    return 1 if outcome.failures or outcome.failed_audits() else 0


if __name__ == "__main__":
    try:
        sys.exit(main(sys.argv[1:]))
    except KeyboardInterrupt:
        say("stopped; the same command goes on from here")
        sys.exit(130)
