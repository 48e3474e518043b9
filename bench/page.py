"""Writes the pages of results: Markdown, with their pictures beside them."""
import os
import platform
import re
import subprocess
from dataclasses import dataclass, field
from pathlib import Path

import pictures
from cases import MASK_ERRORS, STREET, Case
from scoring import Scorer, picture_names, write_text
from tables import cell, delta, interval, percent, share_of, table
from variants import AS_GIVEN, DVI, Variant, applies

TREE = Path(__file__).resolve().parent.parent
ORIGINS = {"copied": "copied", "interpolated": "interpolated", "synthesized": "synthesized", "empty": "left empty"}


@dataclass
class Outcome:
    """All that a page is made of."""
    cases: list[Case]
    methods: list[Variant]
    ablations: list[Variant]
    differences: list[tuple[str, str, str]]  # option, dvi's value, paper's
    externals: list[str]
    results: dict[tuple[str, str], dict]  # case, variant or external -> result
    failures: list[tuple[str, str, str]]  # case, what, message
    masked: list[Case] = field(default_factory=list)  # cases with mask errors, and the same cases with correct masks

    def audits(self) -> dict[tuple[str, str], str]:
        """The finding of `dvi audit` for each run; empty: none. Frames of other programs have no provenance."""
        return {key: result["audit"] for key, result in self.results.items() if "audit" in result}

    def failed_audits(self) -> list[tuple[str, str, str]]:
        return [(case, name, f"fails the audit: {found}") for (case, name), found in self.audits().items() if found]

    def finished(self) -> list[Case]:
        return [case for case in self.cases if (case.name, DVI.name) in self.results]

    def ablated(self) -> list[Case]:
        return [case for case in self.finished() if case.ablated]

    def whole_ablations(self) -> list[Variant]:
        """Those that were run on every case they apply to: no table has holes."""
        return [ablation for ablation in self.ablations
                if all(self.evaluation(case, ablation.name) for case in self.ablated() if applies(ablation, case))]

    def compared(self) -> list[str]:
        return [method.name for method in self.methods] + self.externals

    def same_pixels(self, case: Case, name: str) -> dict | None:
        result = self.results.get((case.name, name))
        return result["same_pixels"] if result else None

    def evaluation(self, case: Case, name: str) -> dict | None:
        return self.results.get((case.name, name), {}).get("evaluation")

    def true_pixels(self, case: Case, name: str) -> dict | None:
        return self.results.get((case.name, name), {}).get("true_pixels")

    def groups(self) -> dict[str, list[Case]]:
        grouped: dict[str, list[Case]] = {}
        for case in self.finished():
            grouped.setdefault(case.group, []).append(case)
        return grouped


def machine() -> str:
    info = Path("/proc/cpuinfo").read_text().splitlines()
    model = next((line.split(":", 1)[1].strip() for line in info if line.startswith("model name")), platform.machine())
    return f"{model}, {os.cpu_count()} cores"


def commit() -> str:
    def git(*arguments: str) -> str:
        return subprocess.run(["git", "-C", TREE, *arguments], capture_output=True, text=True).stdout.strip()

    changed = " with changes" if git("status", "--porcelain", "--", "src", "bench", "cmake", "CMakeLists.txt") else ""
    return (git("rev-parse", "--short=12", "HEAD") or "unknown") + changed


def audited(outcome: Outcome) -> str:
    runs, failed = len(outcome.audits()), outcome.failed_audits()
    if failed:
        named = ", ".join(f"{name} on {case}" for case, name, _ in failed)
        return f"**{len(failed)} of {runs} runs fail `dvi audit`** ([what failed](#what-failed)): {named}"
    return f"{runs} runs, all pass `dvi audit`: each copied pixel was reproduced from its source, none comes from inside a mask"


def measured(outcome: Outcome, command: str) -> str:
    return f"""- Machine: {machine()}
- Commit: `{commit()}`
- Command: `{command.strip()}`
- Provenance: {audited(outcome)}
"""


def head(outcome: Outcome, command: str) -> str:
    return f"""# Benchmarks
<!-- Written by ./dev bench quality. -->
Traffic is removed from drives whose true background is known, and the filled pixels are compared with it, inside the masks only.
The drives are synthetic streets with exact truth, and real drives into which `dvi holdout` inserted virtual traffic.

{measured(outcome, command)}
[metrics.md](metrics.md) defines every figure. All methods are scored on the same pixels, and **copied**, **interpolated** and
**synthesized** refer to the result of `dvi`: pixels copied from another frame, unobserved pixels that are interpolated from their
surroundings, and unobserved pixels that get texture as well. With virtual traffic, the scored pixels are those of its masks, because
the background of the real traffic, which is removed as well, is unknown. Intervals are 95 %, by bootstrap over frames. `-` is
undefined.

[benchmarks-reading.md](benchmarks-reading.md) discusses the results: where `dvi` is better, where it is worse, and why.
[ablations.md](ablations.md) has the effect of each part of the method.
"""


def summary(outcome: Outcome) -> str:
    text = ["## Summary", "PSNR in dB: all scored pixels / those that `dvi` copied. The best of each column is bold.\n"]
    for group, cases in outcome.groups().items():
        best = {case: max((row["all"]["psnr"] for name in outcome.compared() if (row := outcome.same_pixels(case, name))),
                          default=None) for case in cases}

        def entry(case: Case, name: str) -> str:
            if not (row := outcome.same_pixels(case, name)):
                return "-"
            both = f"{cell(row['all']['psnr'])} / {cell(row['copied']['psnr'])}"
            return f"**{both}**" if row["all"]["psnr"] == best[case] else both

        text.append(table([group, *(case.short for case in cases)],
                          [[name, *(entry(case, name) for case in cases)] for name in outcome.compared()]))
    text.append(table(["method", "description"], [[f"`{method.name}`", method.what] for method in outcome.methods]
                      + [[f"`{name}`", "frames of another program"] for name in outcome.externals], words=2))
    return "\n".join(text)


def departures(outcome: Outcome) -> str:
    rows = [[f"`{option}`", ours, published] for option, ours, published in outcome.differences]
    return ("## Differences between `paper` and `dvi`\nThese options and no others:\n\n"
            + table(["option", "dvi", "paper"], rows))


def ablations(outcome: Outcome) -> str:
    """The tables: a row for each ablation, a column for each case."""
    cases, whole = outcome.ablated(), outcome.whole_ablations()
    if not whole or not cases:
        return ""

    def entry(ablation: Variant, case: Case, origin: str, figure: str, digits: int) -> str:
        if not applies(ablation, case):
            return "n/a"
        theirs, ours = outcome.evaluation(case, ablation.name)[origin], outcome.evaluation(case, DVI.name)[origin]
        return delta(theirs[figure], ours[figure], digits)

    text = []
    for title, origin, figure, digits in (("PSNR, all, dB", "all", "psnr", 2), ("SSIM, all", "all", "ssim", 3),
                                          ("PSNR of the pixels copied by each, dB", "copied", "psnr", 2)):
        text.append(table([title, *(case.name for case in cases)],
                          [[v.name, *(entry(v, case, origin, figure, digits) for case in cases)] for v in whole]))
    text.append(table(["ablation", "change"], [[v.name, v.what] for v in whole], words=2))
    if left := [v.name for v in outcome.ablations if v not in whole]:
        text.append(f"Not run on every case, and therefore left out: {', '.join(left)}.\n")
    return "\n".join(text)


INCOMPLETE = """## Incomplete masks
The masks of the virtual traffic have the errors of detectors and annotators ([holdout.md](holdout.md#incomplete-masks) defines the
kinds). Images, scans and truth are those of correct masks. `dvi` completes objects where their masks lack them. `masks as given`
removes only the masked pixels (`objects.complete=false`). PSNR in dB: all pixels of the virtual traffic / those that the given
masks cover, and in parentheses the share of all its pixels that were removed. Pixels that were not removed show the virtual traffic
and count with their full error. Virtual traffic that is not removed from one frame may also be copied into the holes of other
frames, which the covered pixels show. Each kind of errors covers other pixels, so compare these figures within a column only.
"""


def removed_share(figures: dict) -> float:
    """The share of the scored pixels that were filled or left empty."""
    return sum(figures[origin]["pixels"] for origin in ORIGINS) / figures["all"]["pixels"]


def incomplete_masks(outcome: Outcome) -> str:
    def entry(case: Case | None, name: str) -> str:
        if not case or not (figures := outcome.true_pixels(case, name)):
            return "-"
        share = percent(removed_share(figures["all"]))
        return f"{cell(figures['all']['all']['psnr'])} / {cell(figures['covered']['all']['psnr'])} ({share})"

    measured = [case for case in outcome.masked if outcome.true_pixels(case, DVI.name)]
    text = [INCOMPLETE]
    for group in dict.fromkeys(case.group for case in measured):
        by_kind = {(case.short, case.mask_errors): case for case in measured if case.group == group}
        kinds = [kind for kind in ("", *MASK_ERRORS) if any(known == kind for _, known in by_kind)]
        rows = [[short, name, *(entry(by_kind.get((short, kind)), name) for kind in kinds)]
                for short in dict.fromkeys(short for short, _ in by_kind) for name in (DVI.name, AS_GIVEN.name)]
        text.append(table([group, "", *(kind or "correct" for kind in kinds)], rows, words=2))
    return "\n".join(text) if measured else ""


def confidence(outcome: Outcome) -> str:
    rows = []
    for case in outcome.finished():
        if figures := outcome.evaluation(case, DVI.name)["confidence"]:
            rows.append([case.name, percent(figures["mean"]), percent(figures["within"]), cell(figures["ece"], 3),
                         cell(figures["ause"], 3)])
    return ("## Calibration of the confidence\nFor `dvi`: the mean confidence (predicted), the share of pixels within 10 gray levels of the truth (measured),\n"
            "the expected calibration error (ECE), and the area under the sparsification error (AUSE). 0 is best for both.\n\n"
            + table(["case", "predicted", "measured", "ECE", "AUSE"], rows)
            + "\nThe plots show measured over predicted confidence, with a dot per decile of the pixels. On the dashed line the confidence is\n"
              "calibrated, above it too low, below it too high. The mean errors of the same deciles are below the plots.\n")


def details(outcome: Outcome, case: Case, scorer: Scorer) -> str:
    rows, parts = [], []
    for name in outcome.compared():
        if not (same := outcome.same_pixels(case, name)):
            continue
        result = outcome.results[case.name, name]
        own, cost, everything, whole = result.get("evaluation"), result.get("cost"), same["all"], same["whole_frame"]
        rows.append([
            name, cell(everything["psnr"]), interval(everything), cell(everything["ssim"], 3), cell(everything["mae"]),
            cell(everything["rmse"]), cell(everything["sharpness"]), cell(everything["flicker"]),
            cell(everything["misplaced_px"]), share_of(own), f"{cell(whole['psnr'])} / {cell(whole['ssim'], 3)}",
            cell(cost and sum(stage["cpu_seconds_per_frame"] for stage in cost["stages"])),
            cell(cost and cost["peak_memory_bytes"] / 1e6, 0),
        ])
        parts += [[title, name, cell(figures["psnr"]), interval(figures), cell(figures["ssim"], 3), cell(figures["mae"]),
                   cell(figures["rmse"]), cell(figures["sharpness"]), cell(figures["flicker"])]
                  for origin, title in ORIGINS.items() if (figures := same[origin])["pixels"]]
    ours = outcome.same_pixels(case, DVI.name)
    shares = ", ".join(f"{title} {percent(ours[origin]['share'])}"
                       for origin, title in ORIGINS.items() if ours[origin]["pixels"])
    parts.sort(key=lambda row: list(ORIGINS.values()).index(row[0]))
    return "\n".join([
        f"### {case.name}",
        f"{case.what[0].upper()}{case.what[1:]}. {ours['all']['frames']} frames, {ours['all']['pixels']} pixels scored: "
        f"{shares}.\n",
        "```", *(f"dvi {' '.join(shown(part) for part in command)}" for command in case.commands), "```",
        table(["all scored", "PSNR", "95 %", "SSIM", "MAE", "RMSE", "sharpness", "flicker", "misplaced px",
               "own copies: share, PSNR", "whole frame: PSNR / SSIM", "CPU s per frame", "peak MB"], rows),
        "<details><summary>By origin</summary>\n\n"
        + table(["where dvi", "method", "PSNR", "95 %", "SSIM", "MAE", "RMSE", "sharpness", "flicker"], parts, words=2)
        + "\n</details>\n",
        *warnings(outcome, case),
    ])


def warnings(outcome: Outcome, case: Case) -> list[str]:
    """The warnings of the runs, and the runs that gave them."""
    by_text: dict[str, list[str]] = {}
    for name in outcome.compared():
        for text in outcome.results.get((case.name, name), {}).get("warnings", []):
            by_text.setdefault(text, []).append(name)
    return [f"Warning of {', '.join(names)}: {text}\n" for text, names in by_text.items()]


def shown(text: str) -> str:
    """Without the folders of absolute paths: the paths on this machine are irrelevant."""
    return re.sub(r"(?<!\S)/\S*/", "", text)


def crops_note(names: dict[str, str]) -> str:
    return (f"Above: frame {names['median']}, which has the median error of `dvi`, at the largest scored region. "
            f"Below: frame {names['worst']}, its worst frame, at the largest error. In the last tile, green is copied, blue copied from "
            "another drive, yellow interpolated, red synthesized.\n")


HOW = """## Other programs and other drives
```
./dev bench quality                                    all cases, with the KITTI raw drives found in $DVI_DATA
./dev bench quality --quick                            three cases, all methods, about 5 minutes on 2 cores
./dev bench quality --drive NAME=PATH@A:B              also a recording of your own: all scenarios
./dev bench quality --external NAME=DIR                also frames of another program
./dev bench quality --ablations                        the parts of the method instead, into ablations.md
```
To compare ProPainter or a network of your own with these results: after a first run, the cases are in
`build/bench/quality/cases/CASE`. The program reads `drive/images/`, fills the pixels that are 255 in
`build/bench/quality/results/CASE/dvi/masks/`, and writes whole frames to `DIR/CASE/NAME.png`, with the names and sizes of the
images. Cases that are missing in DIR are left out. The truth in `truth/` or `drive/truth/` must not be used by the program.

Each pair of case and method is run once; finished results stay in `build/bench/quality/` until the program, the case or the
options change.
"""


HOW_ABLATIONS = """## Other constants and other drives
```
./dev bench quality --ablations                        all ablations
./dev bench quality --ablations --drive NAME=PATH@A:B  also on a recording of your own
./dev bench quality --constant NAME=VALUE              also an ablation that changes a constant of the source code
./dev bench quality --list-constants                   prints the constants and their values
```
"""


def clear(images: Path) -> None:
    images.mkdir(parents=True, exist_ok=True)
    for old in [*images.glob("*.jpg"), *images.glob("*.svg")]:
        old.unlink()


def what_failed(outcome: Outcome) -> str:
    rows = [[case, what, shown(message)] for case, what, message in [*outcome.failures, *outcome.failed_audits()]]
    return "## What failed\n" + table(["case", "what", "message"], rows, words=3) if rows else ""


def image(file: Path, target: Path, alt: str) -> str:
    """A picture on the page `target`."""
    return f"![{alt}]({os.path.relpath(file, target.parent)})\n"


def write(target: Path, images: Path, outcome: Outcome, scorer: Scorer, command: str) -> None:
    """The page of the methods."""
    clear(images)
    text = [head(outcome, command), summary(outcome)]
    if outcome.finished():
        pictures.plot_psnr(outcome, images / "psnr.svg")
        text.append(image(images / "psnr.svg", target, "PSNR of each method, case by case"))
    text += [departures(outcome), incomplete_masks(outcome), confidence(outcome)]
    if any(outcome.evaluation(case, DVI.name)["confidence"] for case in outcome.finished()):
        pictures.plot_confidence(outcome, images / "confidence.svg")
        text.append(image(images / "confidence.svg", target, "Reliability of the confidence: measured over predicted, case by case"))
    text.append("## Cases")
    for case in outcome.finished():
        text.append(details(outcome, case, scorer))
        names = picture_names(outcome.evaluation(case, DVI.name))
        # Recordings have owners, and licenses that this repository's does not cover: their pictures stay in build/.
        ours = case.group == STREET
        place = (images if ours else scorer.root / "crops") / f"{case.name}.jpg"
        place.parent.mkdir(parents=True, exist_ok=True)
        pictures.crops(outcome, case, scorer, names, place)
        text.append(image(place, target, f"{case.name}: input, truth and each method") if ours
                    else f"Crops side by side, not part of this repository: `build/bench/quality/crops/{place.name}`.\n")
        text.append(crops_note(names))
        text.append("The report shows every frame with the truth and the difference: "
                    f"`build/bench/quality/results/{case.name}/{DVI.name}/report.html`.\n")
    text += [what_failed(outcome), HOW]
    write_text(target, "\n".join(filter(None, text)))


def write_ablations(target: Path, images: Path, outcome: Outcome, command: str) -> None:
    """The page of the ablations."""
    clear(images)
    text = [f"""# Ablations
<!-- Written by ./dev bench quality --ablations. -->
`dvi` with one change minus `dvi` without it, on some of the cases of the [benchmarks](benchmarks.md): positive values mean that the
change improves the result. `n/a`: a single drive. [benchmarks-reading.md](benchmarks-reading.md#ablations) discusses the results.

{measured(outcome, command)}""", ablations(outcome)]
    if outcome.whole_ablations() and outcome.ablated():
        pictures.plot_ablations(outcome, images / "psnr.svg")
        text.append(image(images / "psnr.svg", target, "The effect of each ablation, case by case"))
    text += [what_failed(outcome), HOW_ABLATIONS]
    write_text(target, "\n".join(filter(None, text)))
