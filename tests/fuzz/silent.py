"""Finds wrong results without a warning, by comparison with the truth of a synthetic drive."""
import json
import math
import re
from typing import NamedTuple

import png

MAX_LOSS_DB = 1.5


class Reference(NamedTuple):
    """A run on an undamaged drive: masks, true images as RGB bytes (none: frames are only counted), PSNR, and warnings."""
    masks: list
    truths: list
    psnr: float
    warnings: set


def pictures(folder):
    """PNG files in order of their numbers."""
    return sorted(folder.glob("*.png"), key=lambda path: (len(path.stem), path.stem))


def warnings_of(out):
    """Returns the warnings of a run without their numbers, and without those of the alignment, for which the drives are too small."""
    try:
        return {re.sub(r"[\d.]+", "#", text) for text in json.loads((out / "report.json").read_text())["warnings"]
                if not text.startswith("align:")}
    except (OSError, ValueError, KeyError):
        return {"report.json cannot be read"}


def psnr(frames, reference_masks, truths):
    """PSNR over the pixels of the reference's masks; None if a frame cannot be compared."""
    squared, count = 0, 0
    for path, mask, truth in zip(frames, reference_masks, truths):
        image = png.decode(path.read_bytes())
        result = png.rgb(image) if image else b""
        if len(result) != len(truth):
            return None
        for i, removed in enumerate(mask):
            if removed:
                squared += sum((a - b) ** 2 for a, b in zip(result[3 * i:3 * i + 3], truth[3 * i:3 * i + 3]))
                count += 3
    return 10 * math.log10(255 ** 2 * count / squared) if squared else math.inf


def reference(program, drive, out, truths):
    """Runs the undamaged drive; OUT is left for the caller."""
    ended = program.call("run", drive, "-o", out)
    if ended.code != 0:
        raise SystemExit(f"fuzz: dvi run on an undamaged drive exits with {ended.code}: {ended.err}")
    masks = [png.decode(path.read_bytes()).data for path in pictures(out / "masks")]
    return Reference(masks, truths, psnr(pictures(out / "frames"), masks, truths), warnings_of(out))


def findings(out, expected):
    """Returns findings about a result that has no other warnings than the undamaged drive."""
    if warnings_of(out) - expected.warnings:
        return []
    frames = pictures(out / "frames")
    if len(frames) != len(expected.masks):
        return [f"silent: {len(frames)} of {len(expected.masks)} frames without a warning"]
    quality = psnr(frames, expected.masks, expected.truths)
    if quality is not None and quality < expected.psnr - MAX_LOSS_DB:
        return [f"silent: {quality:.1f} dB without a warning, {expected.psnr:.1f} dB undamaged"]
    return []
