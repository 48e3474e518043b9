#!/usr/bin/env python3
"""Renders the parts of results whose unobserved pixels look worst, by `dvi eval`, one sheet per result.

    ./dev bench look [OUT...] [--parts N] [-o DIR]

Without OUT, the results of `./dev bench quality` are shown: of each case, all variants whose whole result is there. Each row is a
part, twice as large: input, result, result with the outline of the unobserved pixels, and the truth where the case has one.
"""
import argparse
import json
import subprocess
import sys
import tomllib
from dataclasses import dataclass
from pathlib import Path

import cv2
import numpy as np

TREE = Path(__file__).resolve().parent.parent
CROP = (200, 130)  # smallest size of a crop, pixels
BORDER = 24  # around a part, pixels
LARGEST = (480, 300)  # a larger part is cropped around its middle
SCALE = 2
LINE = 18  # height of a line of text
FIRST_UNOBSERVED = 3  # the smallest value in kind/ of an unobserved pixel
FIGURES = ("look", "texture", "boundary", "blank", "color")


@dataclass(frozen=True)
class Result:
    name: str
    folder: Path
    truth: Path | None = None


def quality_results(root: Path) -> list[Result]:
    """The whole results of `./dev bench quality`."""
    found = []
    for kinds in sorted(root.glob("results/*/*/kind")):
        case, variant = kinds.parent.parent.name, kinds.parent.name
        truth = next((path for path in (root / "cases" / case / "truth", root / "cases" / case / "drive/truth") if path.is_dir()),
                     None)
        found.append(Result(f"{case}-{variant}", kinds.parent, truth))
    return found


def given_result(folder: Path) -> Result:
    """A result; a drive of `dvi synth` or `dvi holdout` has its truth beside or inside it."""
    drive = Path(read_options(folder).get("target", ""))
    truth = next((path for path in (drive / "truth", drive.parent / "truth") if path.is_dir()), None)
    return Result(f"{folder.parent.name}-{folder.name}", folder, truth)


def read_options(folder: Path) -> dict:
    file = folder / "dvi.toml"
    return tomllib.loads(file.read_text())["job"] if file.exists() else {}


def input_file(result: Result, frame: str) -> Path | None:
    """The input of a frame: the file that the result names, in its drive."""
    sources = result.folder / "sources.json"
    if not sources.exists():
        return None
    for source in json.loads(sources.read_text())["sources"]:
        if source["frame"] == frame:
            file = Path(source["file"])
            drive = Path(read_options(result.folder).get("target", ""))
            return next((path for path in (file, drive / file) if path.is_file()), None)
    return None


def read(file: Path | None, like: np.ndarray) -> np.ndarray | None:
    """An image of that size, if there is one."""
    image = cv2.imread(str(file)) if file is not None and file.exists() else None
    return image if image is not None and image.shape == like.shape else None


def limit(first: int, size: int, smallest: int, largest: int, whole: int) -> tuple[int, int]:
    """A range of pixels around a part, in an image of `whole` pixels."""
    wanted = min(max(size + 2 * BORDER, smallest), largest, whole)
    begin = min(max(first + size // 2 - wanted // 2, 0), whole - wanted)
    return begin, begin + wanted


def outline(frame: np.ndarray, kind: np.ndarray) -> np.ndarray:
    """The frame with the outlines of the unobserved pixels, enlarged."""
    large = cv2.resize(frame, None, fx=SCALE, fy=SCALE, interpolation=cv2.INTER_NEAREST)
    mask = cv2.resize((kind >= FIRST_UNOBSERVED).astype(np.uint8), None, fx=SCALE, fy=SCALE, interpolation=cv2.INTER_NEAREST)
    lines, _ = cv2.findContours(mask, cv2.RETR_LIST, cv2.CHAIN_APPROX_NONE)
    cv2.drawContours(large, lines, -1, (0, 255, 255), 1)
    return large


def caption(part: dict) -> str:
    figures = [f"{name} {part[name]:.2f}" if part[name] is not None else f"{name} -" for name in FIGURES]
    return f"frame {part['frame']}, {part['pixels']} px at {part['box'][0]},{part['box'][1]}: " + ", ".join(figures)


def row(result: Result, part: dict) -> np.ndarray:
    """A part: its pictures side by side, with the figures below."""
    file = f"{part['frame']}.png"
    frame = cv2.imread(str(result.folder / "frames" / file))
    kind = cv2.imread(str(result.folder / "kind" / file), cv2.IMREAD_UNCHANGED)
    x, y, width, height = part["box"]
    left, right = limit(x, width, CROP[0], LARGEST[0], frame.shape[1])
    top, bottom = limit(y, height, CROP[1], LARGEST[1], frame.shape[0])
    shown = {"input": read(input_file(result, part["frame"]), frame), "result": frame, "unobserved": frame,
             "truth": read(result.truth / file, frame) if result.truth else None}
    tiles = []
    for title, image in shown.items():
        if image is None:
            continue
        crop = np.ascontiguousarray(image[top:bottom, left:right])
        tile = (outline(crop, kind[top:bottom, left:right]) if title == "unobserved"
                else cv2.resize(crop, None, fx=SCALE, fy=SCALE, interpolation=cv2.INTER_NEAREST))
        tiles.append(cv2.copyMakeBorder(write(tile.shape[1], title, tile), 0, 0, 0, 6, cv2.BORDER_CONSTANT, value=(255,) * 3))
    pictures = np.hstack(tiles)
    return np.vstack([pictures, write(pictures.shape[1], caption(part)), np.full((8, pictures.shape[1], 3), 255, np.uint8)])


def write(width: int, text: str, below: np.ndarray | None = None) -> np.ndarray:
    """A line of text, above a picture if one is given."""
    line = np.full((LINE, width, 3), 255, np.uint8)
    cv2.putText(line, text, (2, LINE - 5), cv2.FONT_HERSHEY_SIMPLEX, 0.42, (0, 0, 0), 1, cv2.LINE_AA)
    return line if below is None else np.vstack([line, below])


def sheet(result: Result, parts: list[dict]) -> np.ndarray:
    rows = [row(result, part) for part in parts]
    width = max(picture.shape[1] for picture in rows)
    return np.vstack([cv2.copyMakeBorder(picture, 0, 0, 0, width - picture.shape[1], cv2.BORDER_CONSTANT, value=(255,) * 3)
                      for picture in rows])


def measure(dvi: Path, folder: Path) -> dict | None:
    """The look of a result by `dvi eval`. None if all its pixels were observed."""
    done = subprocess.run([dvi, "eval", folder, "--json", "--quiet"], capture_output=True, text=True)
    if done.returncode:
        raise SystemExit(f"{folder}: {(done.stderr.strip() or 'no message').splitlines()[-1]}")
    return json.loads(done.stdout)["look"]


def main(arguments: list[str]) -> int:
    parser = argparse.ArgumentParser(prog="./dev bench look", description=__doc__.splitlines()[0])
    parser.add_argument("results", nargs="*", type=Path, metavar="OUT", help="results of dvi run; none: those of ./dev bench quality")
    parser.add_argument("--parts", type=int, default=6, metavar="N", help="parts per result, at most 6 (default: 6)")
    parser.add_argument("-o", "--out", type=Path, default=TREE / "build/bench/look", metavar="DIR", help="folder of the sheets")
    parser.add_argument("--dvi", type=Path, default=TREE / "build/release/bin/dvi", help="the program")
    given = parser.parse_args(arguments)
    results = [given_result(folder.resolve()) for folder in given.results] or quality_results(TREE / "build/bench/quality")
    if not results:
        parser.error("there are no results of ./dev bench quality: run it first, or give results of dvi run")
    given.out.mkdir(parents=True, exist_ok=True)
    for result in results:
        look = measure(given.dvi, result.folder)
        if look is None or not look["worst_parts"]:
            print(f"{result.name}: no unobserved pixels that differ from their surroundings")
            continue
        file = given.out / f"{result.name}.png"
        cv2.imwrite(str(file), sheet(result, look["worst_parts"][:given.parts]))
        print(f"{file}: look {look['look']:.2f}, impact {look['impact']:.2f}")
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
