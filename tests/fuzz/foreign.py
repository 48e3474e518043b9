"""Variants of drives as other programs and users write them. Each mutation takes (path, rng) and returns a short description, or None
if it does not apply to that file. The variants are not damaged: the program must read the drive correctly, warn, or refuse it."""
import json
import math
import re
import sqlite3
import struct
from datetime import datetime, timedelta
from decimal import Decimal

import png
from mutations import is_text

DECIMAL = re.compile(rb"(?<![\w.+:-])-?\d+\.\d+(?:[eE][-+]?\d+)?(?![\w.:])")
SCALES = {"milliseconds": 10**3, "microseconds": 10**6, "nanoseconds": 10**9, "kiloseconds": Decimal("0.001"), "zeros": 0,
          "negative": -1}
CLOCK_OFFSETS_S = (37, -18, 1)
GAP_S = 5
FAR_M = 1000000
SCAN_S = 0.1
KITTI_DATE = "%Y-%m-%d %H:%M:%S.%f"
ROTATIONS = {90: (0, 1, -1, 0), 180: (-1, 0, 0, -1), 270: (0, -1, 1, 0)}


def siblings(path):
    return sorted(other for other in path.parent.glob(f"*{path.suffix}") if other.is_file())


def some(path, rng):
    """All files of this kind in the folder, or this one."""
    return siblings(path) if rng.random() < 0.75 else [path]


def numbered(path):
    return [other for other in siblings(path) if other.stem.isdigit()]


def of(files):
    return f" in {len(files)} files" if len(files) > 1 else ""


def columns(path, rng):
    """Scans with more or fewer columns than x y z intensity."""
    if path.suffix != ".bin":
        return None
    count, files = rng.choice((3, 5, 6, 8)), some(path, rng)
    for file in files:
        points = list(struct.iter_unpack("<4f", file.read_bytes()))
        rows = ((*point, i % 16, SCAN_S * i / len(points), 0, 0)[:count] for i, point in enumerate(points))
        file.write_bytes(b"".join(struct.pack(f"<{count}f", *row) for row in rows))
    return f"{4 * count} bytes per point{of(files)}"


def notation(path, rng):
    """The same decimal numbers in another notation."""
    kind, write = rng.choice((("%.18e", lambda n: b"%.18e" % float(n)), ("%.17E", lambda n: b"%.17E" % float(n)),
                              ("plus signs", lambda n: n if n.startswith(b"-") else b"+" + n),
                              ("decimal commas", lambda n: n.replace(b".", b","))))
    data = path.read_bytes() if is_text(path) else b""
    if not DECIMAL.search(data):
        return None
    path.write_bytes(DECIMAL.sub(lambda match: write(match[0]), data))
    return f"numbers as {kind}"


def seconds_column(words, path):
    """Index of the word that is a time in seconds, in times/*.txt and in TUM poses; None if there is none."""
    column = 1 if path.parent.name == "times" else 0
    return column if len(words) > column and re.fullmatch(r"\d{3,}\.\d+", words[column]) else None


def edit_times(path, edit):
    """Replaces each time by edit(index, seconds); false if the file has no times."""
    rows = [line.split() for line in path.read_text("latin-1").splitlines()] if path.suffix == ".txt" and is_text(path) else []
    places = [seconds_column(words, path) for words in rows]
    if not rows or None in places:
        return False
    for i, (words, column) in enumerate(zip(rows, places)):
        words[column] = f"{edit(i, Decimal(words[column])):f}"
    path.write_text("".join(" ".join(words) + "\n" for words in rows))
    return True


def time_units(path, rng):
    unit, count = rng.choice((*SCALES, "from 0 to 1")), max(1, path.read_bytes().count(b"\n") - 1)
    done = edit_times(path, lambda i, t: Decimal(i) / count if unit == "from 0 to 1" else t * SCALES[unit])
    return f"times: {unit}" if done else None


def point_times(path, rng):
    """Scans of the folder layout as PLY, with a time for each point."""
    if path.parent.name != "lidar" or path.suffix != ".bin":
        return None
    unit = rng.choice((*SCALES, "seconds", "from -0.1 s", "from 0 to 1", "absolute"))
    for file in siblings(path):
        points, rows = list(struct.iter_unpack("<4f", file.read_bytes())), b""
        for x, y, z, intensity in points:
            t = (math.pi - math.atan2(y, x)) / (2 * math.pi) * SCAN_S
            t = {"seconds": t, "from -0.1 s": t - SCAN_S, "from 0 to 1": t / SCAN_S, "absolute": 1000 + t}.get(
                unit, t * float(SCALES.get(unit, 1)))
            rows += struct.pack("<4fd", x, y, z, intensity, t)
        names = "".join(f"property float {name}\n" for name in ("x", "y", "z", "intensity"))
        header = f"ply\nformat binary_little_endian 1.0\nelement vertex {len(points)}\n{names}property double t\nend_header\n"
        file.with_suffix(".ply").write_bytes(header.encode() + rows)
        file.unlink()
    return f"point times: {unit}"


def unpadded(path, rng):
    """Numbers without zeros in front: 10 sorts before 9."""
    if not path.stem.isdigit() or len(numbered(path)) < 3:
        return None
    shift, drive = rng.choice((8, 98)), next((folder for folder in path.parents if (folder / "dvi.toml").exists()), None)
    whole = drive and rng.random() < 0.6
    files = [other for other in (drive.rglob("*") if whole else numbered(path)) if other.stem.isdigit() and other.is_file()]
    for file in sorted(files, reverse=True):
        file.rename(file.with_name(f"{int(file.stem) + shift}{file.suffix}"))
    if whole:
        for text in [*drive.glob("times/*.txt"), *drive.glob("poses.txt"), *drive.glob("boxes.json")]:
            text.write_text(re.sub(r'(?m)^\d{6}(?= )|(?<=")\d{6}(?=":)', lambda m: str(int(m[0]) + shift), text.read_text()))
    return f"names from {shift} without zeros{' in the whole drive' if whole else ''}"


def exif(path, rng):
    """An Exif segment with an orientation."""
    data = path.read_bytes() if path.suffix == ".jpg" else b""
    if not data.startswith(b"\xff\xd8"):
        return None
    orientation, order, files = rng.randint(1, 8), rng.choice("<>"), some(path, rng)
    entries = struct.pack(order + "HIHHHIHHI", 42, 8, 1, 0x112, 3, 1, orientation, 0, 0)
    body = b"Exif\0\0" + (b"II" if order == "<" else b"MM") + entries
    for file in files:
        data = file.read_bytes()
        file.write_bytes(data[:2] + struct.pack(">BBH", 255, 0xE1, len(body) + 2) + body + data[2:])
    return f"Exif orientation {orientation}{of(files)}"


def rotated_video(path, rng):
    """The rotation in the track header of a video, as telephones write it."""
    data = bytearray(path.read_bytes()) if path.suffix == ".mp4" else b""
    at = data.find(b"tkhd")
    if at < 0:
        return None
    angle = rng.choice(sorted(ROTATIONS))
    a, b, c, d = (value << 16 for value in ROTATIONS[angle])
    struct.pack_into(">9i", data, at + 4 + (52 if data[at + 4] else 40), a, b, 0, c, d, 0, 0, 0, 1 << 30)
    path.write_bytes(data)
    return f"rotated by {angle} degrees"


def missing_part(path, rng):
    """One file of a series, or its second half."""
    files = siblings(path) if path.suffix == ".db3" else numbered(path)
    if len(files) < 2:
        return None
    middle = len(files) // 2
    gone = rng.choice((files[:1], files[middle:middle + 1], files[middle:], files[-1:]))
    for file in gone:
        file.unlink()
    return f"{len(gone)} of {len(files)} files deleted, from {gone[0].name}"


def gap(path, rng):
    """The recording, or one sensor, pauses for some seconds."""
    files = siblings(path) if path.parent.name == "times" and rng.random() < 0.5 else [path]
    middle = path.read_bytes().count(b"\n") // 2
    done = [edit_times(file, lambda i, t: t + (GAP_S if i >= middle else 0)) for file in files]
    return f"a gap of {GAP_S} s{of(files)}" if any(done) else None


def shift_dates(path, offset_s):
    lines = [datetime.strptime(line[:26], KITTI_DATE) + timedelta(seconds=offset_s) for line in path.read_text().splitlines()]
    path.write_text("".join(line.strftime(KITTI_DATE) + "000\n" for line in lines))


def shift_topic(path, rng, offset_s):
    """Header stamps of one topic of a bag: CDR, little-endian seconds after four bytes."""
    with sqlite3.connect(path) as bag:
        topics = [row[0] for row in bag.execute("SELECT name FROM topics WHERE name NOT LIKE '/tf%' ORDER BY id")]
        topic = rng.choice(topics)
        messages = bag.execute("SELECT messages.id, data FROM messages JOIN topics ON topics.id = topic_id WHERE name = ?",
                               (topic,)).fetchall()
        for number, data in messages:
            seconds = struct.unpack_from("<i", data, 4)[0] + offset_s
            bag.execute("UPDATE messages SET data = ? WHERE id = ?", (data[:4] + struct.pack("<i", seconds) + data[8:], number))
    bag.close()
    return topic


def clock_offset(path, rng):
    """The clock of one sensor differs."""
    offset_s = rng.choice(CLOCK_OFFSETS_S)
    if path.suffix == ".db3":
        return f"the clock of {shift_topic(path, rng, offset_s)} off by {offset_s} s"
    if path.name.startswith("timestamps"):
        for file in path.parent.glob("timestamps*.txt"):
            shift_dates(file, offset_s)
    elif not edit_times(path, lambda _, t: t + offset_s):
        return None
    return f"clock off by {offset_s} s"


def far_pose(path, rng):
    """One pose is impossible, or a line is very long."""
    oxts = path.parent.parent.name == "oxts" and path.parent.name == "data"
    if not oxts and path.name not in ("poses.txt", "global_poses.txt"):
        return None
    lines = path.read_text().splitlines()
    at, kind = rng.randrange(len(lines)), rng.choice(("far", "NaN", "long"))
    words = lines[at].split()
    column = 0 if oxts else 1 if len(words) == 8 else len(words) - 1
    if kind == "long":
        words += ["1"] * 2000000
    else:
        words[column] = "nan" if kind == "NaN" else "-1" if oxts else str(FAR_M)
    lines[at] = " ".join(words)
    path.write_text("\n".join(lines) + "\n")
    return f"pose {at + 1}: {kind}"


def upper_case(path, rng):
    """File extensions in upper case, as some cameras write them."""
    files = some(path, rng)
    if not path.suffix or path.suffix == path.suffix.upper():
        return None
    for file in files:
        file.rename(file.with_suffix(file.suffix.upper()))
    return f"{path.suffix.upper()}{of(files)}"


def byte_order_mark(path, rng):
    """Texts with a byte order mark, as Windows editors write them."""
    if not is_text(path):
        return None
    kind = rng.choice(("utf-8-sig", "utf-16"))
    path.write_bytes(path.read_text("latin-1").replace("\n", "\r\n").encode(kind))
    return f"{kind} with CRLF"


def plain_masks(path, rng):
    """Masks that mark nothing, or everything."""
    if "mask" not in str(path.parent.name) + str(path.parent.parent.name) or path.suffix != ".png":
        return None
    value, files = rng.choice((0, 0, 255)), siblings(path)
    for file in files:
        image = png.decode(file.read_bytes())
        file.write_bytes(png.encode(image._replace(data=bytes([value]) * len(image.data))))
    return f"all pixels of {len(files)} masks are {value}"


def shift_keys(text, shift):
    document = json.loads(text)
    document["frames"] = {f"{int(name) + shift:06d}": boxes for name, boxes in document["frames"].items()}
    return json.dumps(document)


def label_numbers(path, rng):
    """Labels and masks that count from another frame."""
    shift, mask = rng.choice((1, 4, 100)), path.suffix == ".png" and path.parent.parent.name == "masks"
    if mask:
        for file in sorted(numbered(path), reverse=True):
            file.rename(file.with_name(f"{int(file.stem) + shift:06d}.png"))
    elif path.name in ("tracking_labels.txt", "mots_instances.txt"):
        path.write_text(re.sub(r"(?m)^\d+", lambda m: str(int(m[0]) + shift), path.read_text()))
    elif path.name == "tracklet_labels.xml":
        path.write_text(re.sub(r"(?<=<first_frame>)\d+", lambda m: str(int(m[0]) + shift), path.read_text()))
    elif path.name == "boxes.json":
        path.write_text(shift_keys(path.read_text(), shift))
    else:
        return None
    return f"labels {shift} frames later"


ALL = (columns, notation, time_units, point_times, unpadded, exif, rotated_video, missing_part, gap, clock_offset, far_pose,
       upper_case, byte_order_mark, plain_masks, label_numbers)
