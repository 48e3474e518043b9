"""Classifies the behavior of dvi on a drive as correct or as a finding."""
import re

import png
import silent
from program import MEMORY_BYTES

REFUSED = 3
LONGEST_MESSAGE = 4000


def findings(program, drive, out, mutated=None, root=None, expected=None):
    """Calls check, run and, if it succeeded, audit; returns (exit of run, findings, CPU seconds).

    `root` is the folder with all files of the drive, if it is not `drive`; no other file is beside OUT. `expected` is the
    silent.Reference of a drive whose mutation must be detected.
    """
    root = root or drive
    before = snapshot(root)
    check, run = program.call("check", drive), program.call("run", drive, "-o", out)
    found, calls = judge(check, root, mutated) + judge(run, root, mutated), [check, run]
    if run.code == 0:
        audit = program.call("audit", out, drive)
        calls.append(audit)
        if audit.code != 0:
            found.append(f"wrong result: audit exits with {audit.code}: {first_line(audit.err)}")
        found += wrong_pixels(drive, out) + (silent.findings(out, expected) if expected else [])
    elif run.code == REFUSED and leaves_result(out):
        found.append("a result is left although the run was refused")
    if snapshot(root) != before:
        found.append("the drive was changed")
    if set(out.parent.iterdir()) - {root, out}:
        found.append("files were written outside of the result")
    return run.code, found, sum(call.cpu for call in calls)


def leaves_result(out):
    """Whether a refused run left more files than the cached stages."""
    kept = any((out / ".dvi/stages").glob("*"))
    return out.exists() and (not kept or any(path.is_file() and ".dvi" not in path.parts for path in out.rglob("*")))


def judge(ended, drive, mutated=None):
    """Returns findings about the exit code, the message, and the memory of a call. Messages must name a file of `drive`."""
    found, command = [], ended.arguments[0]
    if ended.code is None:
        found.append(f"{command} hangs")
    elif ended.code >= 128:
        found.append(f"{command} ends by signal {ended.code - 128}")
    elif ended.code not in (0, REFUSED):
        found.append(f"{command} exits with {ended.code}: {first_line(ended.err)}")
    elif ended.code == REFUSED:
        found += [f"{command}: {problem}: {first_line(ended.err)}" for problem in bad_message(ended.err, drive, mutated)]
    if ended.peak_bytes > MEMORY_BYTES:
        found.append(f"{command} takes {ended.peak_bytes >> 20} MB")
    return found


def bad_message(text, drive, mutated=None):
    """Returns the problems of a message, which must name the file that causes the error."""
    problems = []
    if not text.startswith("dvi: "):
        problems.append("the message does not begin with 'dvi: '")
    if str(drive) not in text and not (mutated and mutated.name in text):
        problems.append("the message names no file")
    if re.search(r"[\x00-\x08\x0b-\x1f\x7f]", text):
        problems.append("the message holds control characters")
    if len(text) > LONGEST_MESSAGE:
        problems.append("the message is long")
    return problems


def first_line(text):
    return ascii(text.strip().split("\n")[0][:200])[1:-1]


def snapshot(folder):
    """Returns the size, time, and mode of all files of a drive."""
    return {path: (status.st_size, status.st_mtime_ns, status.st_mode)
            for path in [folder, *folder.rglob("*")] for status in [path.lstat()]}


def wrong_pixels(drive, out):
    """Returns findings about pixels outside of the mask that differ from the input. Only the audit checks formats that png.py lacks."""
    inputs = {path.stem: path for folder in ("images/front", "image_02/data") for path in (drive / folder).glob("*.png")
              if path.is_file()}
    found = []
    for frame in sorted((out / "frames").glob("*.png")):
        mask = png.decode((out / "masks" / frame.name).read_bytes())
        result = png.decode(frame.read_bytes())
        if mask is None or result is None or (result.width, result.height) != (mask.width, mask.height):
            found.append(f"wrong result: {frame.name} or its mask cannot be decoded")
            continue
        source = png.decode(inputs[frame.stem].read_bytes()) if frame.stem in inputs else None
        if source is None or source.depth != 8 or source.color not in (png.GRAY, png.RGB):
            continue
        if differs_outside(png.rgb(source), png.rgb(result), mask.data):
            found.append(f"wrong result: {frame.name} differs from its image outside of the mask")
    return found


def differs_outside(source, result, mask):
    if len(source) != len(result):
        return True
    return source != result and any(source[3 * i:3 * i + 3] != result[3 * i:3 * i + 3]
                                    for i, removed in enumerate(mask) if not removed)
