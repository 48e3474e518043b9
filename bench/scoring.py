"""Makes cases, runs variants on them, scores the results. Finished parts are not done again.

    ROOT/cases/CASE/              the case, and recipe.json: the key it was made under
    ROOT/results/CASE/NAME/       result.json; frames/ of the pictures only (of dvi: the whole result, with its report.html)
    ROOT/work/                    the current run
A result's key is a hash of the program, the case's recipe, and the options: another key, another run.
"""
import hashlib
import json
import os
import shutil
import subprocess
import tempfile
import time
from pathlib import Path

from PIL import Image, ImageChops

from cases import Case
from fill_holes import fill_holes
from variants import AS_GIVEN, DVI, Variant


class Failed(Exception):
    """dvi refused or failed: its message."""


def hash_of(program: Path) -> str:
    return hashlib.sha256(program.read_bytes()).hexdigest()


def key_of(*parts: object) -> str:
    return hashlib.sha256(json.dumps(parts, default=str).encode()).hexdigest()[:16]


def fingerprint(folder: Path) -> list[tuple[str, int, int]]:
    """Names, sizes and times of a folder's files."""
    return [(file.name, file.stat().st_size, file.stat().st_mtime_ns) for file in sorted(folder.iterdir())]


def read_json(file: Path) -> dict | None:
    return json.loads(file.read_text()) if file.exists() else None


def write_text(file: Path, text: str) -> None:
    """Written beside, renamed: nothing half-written."""
    beside = file.with_suffix(".new")
    beside.write_text(text, encoding="utf-8")
    os.replace(beside, file)


def write_json(file: Path, document: dict) -> None:
    write_text(file, json.dumps(document, indent=1))


def refusal(done: subprocess.CompletedProcess) -> str:
    message = (done.stderr.strip() or "no message").splitlines()[-1].removeprefix("dvi: ")
    return f"{message} (exit code {done.returncode})"


def breaches(audit: dict) -> str:
    """What `dvi audit` found, in words."""
    return "; ".join(f"{name}: {found['pixels']} pixels, the first in frame {found['first']['frame']} at "
                     f"{found['first']['x']}, {found['first']['y']}"
                     for name, found in audit["findings"].items() if found["pixels"])


def picture_names(evaluation: dict) -> dict[str, str]:
    """The frames to show: of dvi's median error, and of its largest."""
    ranked = sorted((frame["all"]["mae"], frame["name"]) for frame in evaluation["per_frame"] if frame["all"]["pixels"])
    return {"median": ranked[(len(ranked) - 1) // 2][1], "worst": ranked[-1][1]}


def intersect(masks: Path, others: Path, target: Path) -> None:
    """Writes the pixels that both masks of a frame cover."""
    for file in masks.glob("*.png"):
        both = ImageChops.darker(Image.open(file).convert("L"), Image.open(others / file.name).convert("L"))
        both.save(target / file.name)


class Scorer:
    def __init__(self, dvi: Path, root: Path):
        self.dvi, self.root = dvi.resolve(), root.resolve()
        self.program = hash_of(self.dvi)

    def folder(self, case: Case) -> Path:
        return self.root / "cases" / case.name

    def result_folder(self, case: Case, name: str) -> Path:
        return self.root / "results" / case.name / name

    def start(self, *arguments: str | Path, cwd: Path, program: Path | None = None) -> subprocess.CompletedProcess:
        done = subprocess.run([program or self.dvi, *arguments, "--quiet"], cwd=cwd, capture_output=True, text=True)
        if done.returncode < 0 or done.returncode == 130:
            raise KeyboardInterrupt
        return done

    def call(self, *arguments: str | Path, cwd: Path, program: Path | None = None) -> str:
        """stdout of dvi. Failed with the last line of its message otherwise."""
        done = self.start(*arguments, cwd=cwd, program=program)
        if done.returncode:
            raise Failed(refusal(done))
        return done.stdout

    def case_key(self, case: Case) -> str:
        return key_of(self.program, case.commands)

    def make(self, case: Case) -> None:
        folder, key = self.folder(case), self.case_key(case)
        recipe = read_json(folder / "recipe.json")
        if recipe and recipe["key"] == key:
            return
        shutil.rmtree(folder, ignore_errors=True)
        folder.mkdir(parents=True)
        for command in case.commands:
            self.call(*command, cwd=folder)
        write_json(folder / "recipe.json", {"key": key, "commands": [" ".join(("dvi", *command)) for command in case.commands]})

    def drives(self, case: Case, variant: Variant) -> list[str]:
        return [case.drive, *(case.sources if variant.fusion else ())]

    def run_arguments(self, case: Case, variant: Variant) -> list[str]:
        # Shadows would join the masks of the methods that know poses only: all fill the same pixels.
        return ["run", *self.drives(case, variant), "--set", "masks.shadows=false", *variant.arguments]

    def run_key(self, case: Case, variant: Variant) -> str:
        program = [hash_of(variant.program)] if variant.program else []
        fill = [variant.fill] if variant.fill else []
        return key_of(self.case_key(case), case.truth, case.ignore, case.true_masks, self.run_arguments(case, variant), "audit", *program,
                      *fill)

    def known(self, case: Case, variant: Variant) -> dict | None:
        """The result, if there is one that is still true."""
        result = read_json(self.result_folder(case, variant.name) / "result.json")
        return result if result and result["key"] == self.run_key(case, variant) else None

    def score(self, case: Case, variant: Variant, same_pixels: bool) -> dict:
        """Runs a variant on a case that was made, and audits it. With `same_pixels` it is scored on the pixels and kinds of dvi,
        too. A program with a changed constant runs and audits; the program under test makes the cases and scores."""
        begun = time.monotonic()
        out = self.root / "work"
        shutil.rmtree(out, ignore_errors=True)
        arguments = self.run_arguments(case, variant)
        if variant.fill:  # the result of dvi is known, because it is first
            shutil.copytree(self.result_folder(case, DVI.name), out)
        else:
            self.call(*arguments, "-o", out, cwd=self.folder(case), program=variant.program)
        report = json.loads((out / "report.json").read_text())
        if variant.fill and report["hole"]["share"]["unobserved"] > 0:
            self.import_fill(out, variant.fill)
        # First, because the report shows the truth of the last evaluation.
        true_pixels = self.true_pixels(case, out) if case.true_masks and variant in (DVI, AS_GIVEN) else None
        result = {
            "key": self.run_key(case, variant),
            "command": " ".join(("dvi", *arguments)),
            "audit": self.audit(case, variant, out),
            "evaluation": self.evaluate(case, out),
            "cost": report["cost"],
            "warnings": report["warnings"],
        }
        if true_pixels:
            result["true_pixels"] = true_pixels
        if variant == DVI:
            result["same_pixels"] = result["evaluation"]
        elif same_pixels:
            result["same_pixels"] = self.beside(case, out / "frames")
        result["seconds"] = time.monotonic() - begun
        self.keep(case, variant.name, out, result, whole=variant == DVI)
        return result

    def import_fill(self, out: Path, inpainter: str) -> None:
        """Fills the unobserved pixels of a result by another program."""
        with tempfile.TemporaryDirectory(dir=self.root) as folder:
            holes, filled = Path(folder) / "holes", Path(folder) / "filled"
            self.call("export", "holes", out, "-o", holes, cwd=self.root)
            fill_holes(holes, filled, inpainter)
            self.call("import-fill", out, filled, cwd=self.root)

    def audit(self, case: Case, variant: Variant, out: Path) -> str:
        """The problem that the audit found in a run's provenance; empty: none."""
        done = self.start("audit", out, *self.drives(case, variant), "--json", cwd=self.folder(case), program=variant.program)
        if done.returncode == 0:
            return ""
        return breaches(json.loads(done.stdout)) if done.stdout else refusal(done)

    def evaluate(self, case: Case, out: Path, *more: str) -> dict:
        """Scores a result: on the virtual traffic if the case has some, because nothing is known of the background of the real
        traffic, which dvi removes, too."""
        folder = self.folder(case)
        ignore = ("--ignore", case.ignore) if case.ignore else ()
        masks = ("--masks", case.true_masks) if case.true_masks and "--masks" not in more else ()
        return json.loads(self.call("eval", out, "--truth", case.truth, *ignore, *masks, "--json", *more, cwd=folder))

    def given_masks(self, case: Case) -> Path:
        """The masks in the drive of a case with virtual traffic."""
        folder = self.folder(case)
        holdout = json.loads(((folder / case.true_masks).parent / "holdout.json").read_text())
        return folder / case.drive / "masks" / holdout["source"]["camera"]

    def true_pixels(self, case: Case, out: Path) -> dict:
        """Figures over all pixels of the virtual traffic, and over those that the masks of the drive cover."""
        true_masks = self.folder(case) / case.true_masks
        with tempfile.TemporaryDirectory(dir=self.root) as covered:
            intersect(true_masks, self.given_masks(case), Path(covered))
            return {name: {origin: figures for origin, figures in self.evaluate(case, out, "--masks", masks).items()
                           if origin in ("all", "copied", "interpolated", "synthesized", "empty", "imported")}
                    for name, masks in (("all", true_masks), ("covered", covered))}

    def beside(self, case: Case, frames: Path) -> dict:
        """A run's frames, on the pixels that dvi filled and by the kinds that it gave them: as if they were dvi's result, whose
        own evaluation is known and not made again."""
        dvi = self.result_folder(case, DVI.name)
        with tempfile.TemporaryDirectory(dir=self.root) as folder:
            for part in ("masks", "kind", "depth"):
                (Path(folder) / part).symlink_to(dvi / part)
            (Path(folder) / "frames").symlink_to(frames)
            # Ghosts are counted in results of dvi only, by their sources.
            return {**self.evaluate(case, Path(folder)), "ghosts_left_out": None}

    def external(self, case: Case, name: str, frames: Path) -> dict:
        folder = self.result_folder(case, name)
        key = key_of(self.run_key(case, DVI), fingerprint(frames))
        result = read_json(folder / "result.json")
        if not result or result["key"] != key:
            dvi = self.result_folder(case, DVI.name)
            evaluation = self.evaluate(case, dvi, "--external", f"{name}={frames.resolve()}")
            result = {"key": key, "same_pixels": evaluation["external"][name]}
            shutil.rmtree(self.root / "work", ignore_errors=True)
            shutil.copytree(frames, self.root / "work" / "frames")
            self.keep(case, name, self.root / "work", result, whole=False)
        return result

    def keep(self, case: Case, name: str, out: Path, result: dict, whole: bool) -> None:
        """Moves the files that are needed later out of the run's folder; result.json is last and marks the result as finished."""
        folder = self.result_folder(case, name)
        shutil.rmtree(folder, ignore_errors=True)
        folder.mkdir(parents=True)
        if whole:  # as `dvi eval` left it: its report shows the truth beside it
            shutil.rmtree(out / ".dvi/stages", ignore_errors=True)
            for part in list(out.iterdir()):
                shutil.move(part, folder / part.name)
        else:
            (folder / "frames").mkdir()
            dvi = read_json(self.result_folder(case, DVI.name) / "result.json")
            for frame in picture_names(dvi["evaluation"]).values():
                picture = next((out / "frames").glob(f"{frame}.*"))
                shutil.move(picture, folder / "frames" / picture.name)
        write_json(folder / "result.json", result)
        shutil.rmtree(out)
