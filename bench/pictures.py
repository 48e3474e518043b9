"""The page's pictures: plots as SVG, crops side by side as JPEG."""
from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import matplotlib
import numpy as np
from PIL import Image, ImageDraw, ImageFont

from cases import Case
from scoring import Scorer
from variants import DVI

if TYPE_CHECKING:
    from page import Outcome

matplotlib.use("svg")
matplotlib.rcParams.update({"svg.hashsalt": "dvi", "font.size": 8, "axes.spines.top": False, "axes.spines.right": False})
from matplotlib import pyplot  # noqa: E402  after the choice of how to draw

TILE = (240, 160)  # size of a crop, pixels
COLUMNS = 4
LABEL = 16  # height of a tile's title
KINDS = {1: (0, 170, 60), 2: (40, 90, 255), 3: (250, 200, 0), 4: (230, 40, 40), 5: (0, 0, 0), 6: (160, 60, 200)}


def save(figure: pyplot.Figure, file: Path) -> None:
    figure.savefig(file, bbox_inches="tight", metadata={"Date": None})
    pyplot.close(figure)


def plot_psnr(outcome: Outcome, file: Path) -> None:
    """A column a case: the methods' PSNR over all scored pixels with its interval, and (hollow) over those copied."""
    groups, methods = outcome.groups(), outcome.compared()
    figure, axes = pyplot.subplots(1, len(groups), figsize=(9.5, 3.2), sharey=True, squeeze=False,
                                   gridspec_kw={"width_ratios": [len(cases) + 0.3 for cases in groups.values()]})
    for axis, (group, cases) in zip(axes[0], groups.items()):
        for number, name in enumerate(methods):
            for x, case in enumerate(cases):
                if row := outcome.same_pixels(case, name):
                    place = x + (number - (len(methods) - 1) / 2) * 0.8 / len(methods)
                    low, high = row["all"]["interval"]["psnr"] if row["all"]["interval"] else (row["all"]["psnr"],) * 2
                    axis.plot([place, place], [low, high], color=f"C{number}", linewidth=1)
                    axis.plot(place, row["all"]["psnr"], "o", color=f"C{number}", markersize=4)
                    if row["copied"]["psnr"] is not None:
                        axis.plot(place, row["copied"]["psnr"], "o", color=f"C{number}", markersize=4, fillstyle="none")
        axis.set_xticks(range(len(cases)), [case.short for case in cases], rotation=20)
        axis.set_xlim(-0.6, len(cases) - 0.4)
        axis.set_title(group)
        axis.grid(axis="y", alpha=0.3)
    axes[0][0].set_ylabel("PSNR, dB: all (bar: 95 %), copied (hollow)")
    handles = [pyplot.Line2D([], [], marker="o", linestyle="", color=f"C{number}") for number in range(len(methods))]
    figure.legend(handles, methods, loc="lower center", ncol=len(methods), bbox_to_anchor=(0.5, -0.12), frameon=False)
    save(figure, file)


def plot_confidence(outcome: Outcome, file: Path) -> None:
    """A column a group, a line a case: what dvi's confidence says against the share within 10 gray levels (a reliability diagram,
    a dot for each tenth of the pixels), and below against the mean error."""
    groups = outcome.groups()
    figure, axes = pyplot.subplots(2, len(groups), figsize=(9.5, 5.6), sharex=True, sharey="row", squeeze=False,
                                   gridspec_kw={"height_ratios": [2, 1]})
    for (top, bottom), (group, cases) in zip(axes.T, groups.items()):
        top.plot([0, 1], [0, 1], color="0.4", linewidth=1, linestyle="--")
        for number, case in enumerate(cases):
            if figures := outcome.evaluation(case, DVI.name)["confidence"]:
                x = [decile["confidence"] for decile in figures["deciles"]]
                style = {"color": f"C{number}", "linewidth": 1, "marker": "o", "markersize": 3}
                top.plot(x, [decile["within"] for decile in figures["deciles"]], label=case.short, **style)
                bottom.plot(x, [decile["mae"] for decile in figures["deciles"]], **style)
        top.set(title=group, xlim=(0, 1), ylim=(0, 1))
        bottom.set(xlabel="predicted confidence", ylim=(0, None))
        top.legend(frameon=False, loc="upper left", fontsize=7)
        for axis in (top, bottom):
            axis.grid(alpha=0.3)
    axes[0][0].set_ylabel("measured: share within 10 gray levels")
    axes[1][0].set_ylabel("mean error, gray levels")
    save(figure, file)


def plot_ablations(outcome: Outcome, file: Path) -> None:
    """A row per ablation and a dot per case: the change of the PSNR of dvi, over all scored pixels and over copied ones."""
    cases, names = outcome.ablated(), [ablation.name for ablation in outcome.whole_ablations()]
    figure, axes = pyplot.subplots(1, 2, figsize=(9.5, 0.28 * len(names) + 0.9), sharey=True)
    for axis, origin in zip(axes, ("all", "copied")):
        axis.axvline(0, color="0.6", linewidth=1)
        for number, case in enumerate(cases):
            base = outcome.evaluation(case, DVI.name)[origin]["psnr"]
            rows = [(y, row[origin]["psnr"]) for y, name in enumerate(names) if (row := outcome.evaluation(case, name))]
            rows = [(y, value) for y, value in rows if value is not None]
            if base is not None:
                axis.plot([value - base for _, value in rows], [y for y, _ in rows], "o", color=f"C{number}", markersize=5,
                          alpha=0.8, label=case.name)
        axis.set(xlabel=f"PSNR minus that of dvi, dB: {origin}", ylim=(len(names) - 0.5, -0.5))
        axis.set_yticks(range(len(names)), names)
        axis.grid(alpha=0.3)
    axes[1].legend(frameon=False, loc="center left", bbox_to_anchor=(1, 0.5))
    save(figure, file)


def densest(weight: np.ndarray, size: tuple[int, int]) -> tuple[int, int, int, int]:
    """The box (left, top, right, bottom) of this width and height, or the image's if less, with the largest sum; of several
    the middle one, so that smaller regions are centered."""
    height, width = min(size[1], weight.shape[0]), min(size[0], weight.shape[1])
    sums = np.pad(weight.astype(np.float64).cumsum(0).cumsum(1), ((1, 0), (1, 0)))
    inside = sums[height:, width:] - sums[:-height, width:] - sums[height:, :-width] + sums[:-height, :-width]
    best = np.argwhere(inside == inside.max())
    top, left = best[np.abs(best - best.mean(axis=0)).sum(axis=1).argmin()]
    return int(left), int(top), int(left) + width, int(top) + height


def picture(folder: Path, name: str) -> Image.Image:
    return Image.open(next(folder.glob(f"{name}.*"))).convert("RGB")


def kinds(original: Image.Image, kind: np.ndarray) -> Image.Image:
    """The kind of each pixel, in colors on the input."""
    painted = np.array(original) // 2 + 64
    for value, color in KINDS.items():
        painted[kind == value] = painted[kind == value] // 2 + np.array(color, np.uint8) // 2
    return Image.fromarray(painted)


def tiles(outcome: Outcome, case: Case, scorer: Scorer, name: str) -> tuple[dict[str, Image.Image], np.ndarray]:
    """The pictures of a frame by title, and where it is scored."""
    folder, dvi = scorer.folder(case), scorer.result_folder(case, DVI.name)
    images = next(path for path in sorted((folder / case.drive / "images").iterdir()) if path.is_dir())
    original = picture(images, name)
    shown = {"input": original, "truth": picture(folder / case.truth, name)}
    for method in outcome.compared():
        if (case.name, method) in outcome.results:
            shown[method] = picture(scorer.result_folder(case, method) / "frames", name)
    shown["kinds of dvi"] = kinds(original, np.array(Image.open(dvi / f"kind/{name}.png")))
    scored = np.array(Image.open(dvi / f"masks/{name}.png").convert("L")) > 0
    if case.ignore:
        scored &= np.array(Image.open(folder / case.ignore / f"{name}.png").convert("L")) == 0
    if case.true_masks:
        scored &= np.array(Image.open(folder / case.true_masks / f"{name}.png").convert("L")) > 0
    return shown, scored


def crops(outcome: Outcome, case: Case, scorer: Scorer, names: dict[str, str], file: Path) -> None:
    """The median frame where most is scored, above the worst frame where dvi errs most."""
    sheets = []
    for which, name in names.items():
        shown, scored = tiles(outcome, case, scorer, name)
        error = np.abs(np.array(shown[DVI.name], np.int16) - np.array(shown["truth"], np.int16)).sum(2)
        box = densest(scored if which == "median" else scored * error, TILE)
        sheets.append(sheet({title: image.crop(box) for title, image in shown.items()}))
    joined = Image.new("RGB", (sheets[0].width, sum(part.height for part in sheets) + 8), "white")
    top = 0
    for part in sheets:
        joined.paste(part, (0, top))
        top += part.height + 8
    joined.save(file, quality=75)


def sheet(shown: dict[str, Image.Image]) -> Image.Image:
    font = ImageFont.truetype(matplotlib.font_manager.findfont("DejaVu Sans"), 11)
    rows = -(-len(shown) // COLUMNS)
    paper = Image.new("RGB", (COLUMNS * (TILE[0] + 4) - 4, rows * (TILE[1] + LABEL)), "white")
    draw = ImageDraw.Draw(paper)
    for number, (title, image) in enumerate(shown.items()):
        corner = (number % COLUMNS * (TILE[0] + 4), number // COLUMNS * (TILE[1] + LABEL))
        draw.text((corner[0] + 2, corner[1] + 1), title, fill="black", font=font)
        paper.paste(image, (corner[0], corner[1] + LABEL))
    return paper
