"""Makes cases, runs variants on them, scores the results. What is finished is not done again.

    ROOT/cases/CASE/              the case, and recipe.json: the key it was made under
    ROOT/results/CASE/NAME/       result.json; frames/ of the pictures only (of dvi: all that `dvi eval` reads)
    ROOT/work/                    the run that is going on
A result's key is a hash of the program, the case's recipe, and the options: another key, another run.
"""
import hashlib
import json
import os
import shutil
import subprocess
import time
from pathlib import Path

from cases import Case
from variants import DVI, Variant

READ_BY_EVAL = ("frames", "masks", "kind", "confidence")


class Failed(Exception):
    """dvi refused or failed: its message."""


def key_of(*parts: object) -> str:
    return hashlib.sha256(json.dumps(parts, default=str).encode()).hexdigest()[:16]


def fingerprint(folder: Path) -> list[tuple[str, int, int]]:
    """Names, sizes and times of a folder's files."""
    return [(file.name, file.stat().st_size, file.stat().st_mtime_ns) for file in sorted(folder.iterdir())]


def read_json(file: Path) -> dict | None:
    return json.loads(file.read_text()) if file.exists() else None


def write_json(file: Path, document: dict) -> None:
    """Written beside, renamed: nothing half-written."""
    beside = file.with_suffix(".new")
    beside.write_text(json.dumps(document, indent=1))
    os.replace(beside, file)


def picture_names(evaluation: dict) -> dict[str, str]:
    """The frames to show: of dvi's median error, and of its largest."""
    ranked = sorted((frame["all"]["mae"], frame["name"]) for frame in evaluation["per_frame"] if frame["all"]["pixels"])
    return {"median": ranked[(len(ranked) - 1) // 2][1], "worst": ranked[-1][1]}


class Scorer:
    def __init__(self, dvi: Path, root: Path):
        self.dvi, self.root = dvi.resolve(), root.resolve()
        self.program = hashlib.sha256(self.dvi.read_bytes()).hexdigest()

    def folder(self, case: Case) -> Path:
        return self.root / "cases" / case.name

    def result_folder(self, case: Case, name: str) -> Path:
        return self.root / "results" / case.name / name

    def call(self, *arguments: str | Path, cwd: Path) -> str:
        """stdout of dvi. Failed with the last line of its message otherwise."""
        done = subprocess.run([self.dvi, *arguments, "--quiet"], cwd=cwd, capture_output=True, text=True)
        if done.returncode < 0 or done.returncode == 130:
            raise KeyboardInterrupt
        if done.returncode:
            message = (done.stderr.strip() or "no message").splitlines()[-1].removeprefix("dvi: ")
            raise Failed(f"{message} (exit code {done.returncode})")
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

    def run_arguments(self, case: Case, variant: Variant) -> list[str]:
        return ["run", "drive", *(case.sources if variant.fusion else ()), *variant.arguments]

    def run_key(self, case: Case, variant: Variant) -> str:
        return key_of(self.case_key(case), case.truth, case.ignore, self.run_arguments(case, variant))

    def known(self, case: Case, variant: Variant) -> dict | None:
        """The result, if there is one that is still true."""
        result = read_json(self.result_folder(case, variant.name) / "result.json")
        return result if result and result["key"] == self.run_key(case, variant) else None

    def score(self, case: Case, variant: Variant, same_pixels: bool) -> dict:
        """Runs a variant on a case that was made. With `same_pixels` it is scored on the pixels and kinds of dvi, too."""
        begun = time.monotonic()
        out = self.root / "work"
        shutil.rmtree(out, ignore_errors=True)
        arguments = self.run_arguments(case, variant)
        self.call(*arguments, "-o", out, cwd=self.folder(case))
        report = json.loads((out / "report.json").read_text())
        result = {
            "key": self.run_key(case, variant),
            "command": " ".join(("dvi", *arguments)),
            "evaluation": self.evaluate(case, out),
            "cost": report["cost"],
            "warnings": report["warnings"],
        }
        if variant == DVI:
            result["same_pixels"] = result["evaluation"]
        elif same_pixels:
            result["same_pixels"] = self.beside(case, variant.name, out / "frames")
        result["seconds"] = time.monotonic() - begun
        self.keep(case, variant.name, out, result, whole=variant == DVI)
        return result

    def evaluate(self, case: Case, out: Path, *more: str) -> dict:
        folder = self.folder(case)
        ignore = ("--ignore", case.ignore) if case.ignore else ()
        return json.loads(self.call("eval", out, "--truth", case.truth, *ignore, "--json", *more, cwd=folder))

    def beside(self, case: Case, name: str, frames: Path) -> dict:
        """Frames of any program, on the pixels that dvi filled and by the kinds that it gave them."""
        out = self.result_folder(case, DVI.name)
        return self.evaluate(case, out, "--external", f"{name}={frames.resolve()}")["external"][name]

    def external(self, case: Case, name: str, frames: Path) -> dict:
        folder = self.result_folder(case, name)
        key = key_of(self.run_key(case, DVI), fingerprint(frames))
        result = read_json(folder / "result.json")
        if not result or result["key"] != key:
            result = {"key": key, "same_pixels": self.beside(case, name, frames)}
            shutil.rmtree(self.root / "work", ignore_errors=True)
            shutil.copytree(frames, self.root / "work" / "frames")
            self.keep(case, name, self.root / "work", result, whole=False)
        return result

    def keep(self, case: Case, name: str, out: Path, result: dict, whole: bool) -> None:
        """Moves what is needed later out of the run's folder; result.json comes last and marks it as finished."""
        folder = self.result_folder(case, name)
        shutil.rmtree(folder, ignore_errors=True)
        folder.mkdir(parents=True)
        if whole:
            for part in READ_BY_EVAL:
                shutil.move(out / part, folder / part)
        else:
            (folder / "frames").mkdir()
            dvi = read_json(self.result_folder(case, DVI.name) / "result.json")
            for frame in picture_names(dvi["evaluation"]).values():
                picture = next((out / "frames").glob(f"{frame}.*"))
                shutil.move(picture, folder / "frames" / picture.name)
        write_json(folder / "result.json", result)
        shutil.rmtree(out)
