"""Mutations that damage one file of a drive. Each takes (path, rng) and returns a short description, or None if it does not apply."""
import os
import re
import shutil
import struct
from functools import lru_cache

import png

NUMBER = re.compile(rb"(?<![\w.])-?\d+(?:\.\d+)?(?:[eE][-+]?\d+)?")
HUGE = (b"1e308", b"-1e308", b"1e39", b"1e-320", b"2147483647", b"2147483648", b"-2147483648", b"4294967296",
        b"9223372036854775807", b"99999999999999999999999", b"1e999", b"-1", b"0", b"65536", b"100000")
NOT_NUMBERS = (b"nan", b"-nan", b"inf", b"-inf", b"NaN", b"1.#QNAN", b"0x7fffffff", b"", b"1,5", b"\x1b[2J", b"one")
HUGE_FLOATS = (3.4e38, -3.4e38, 1e30, -1e9, 1e-45, 0.0)
IMAGES, BINARY_CLOUDS = (".png", ".jpg"), (".bin",)
NAMES = (b"99999999999999999999", b"2147483647", b"2147483648", b"-1", b"000001 (copy)", b"\xff\xfe", b"new\nline",
         b"\x1b[31mred", b"0" * 200, b".hidden", b"000001.000001", b"1e9", b"9223372036.999999999")


def is_text(path):
    return path.is_file() and b"\0" not in path.read_bytes()[:4096] and path.suffix not in IMAGES + BINARY_CLOUDS


def truncate(path, rng):
    size = rng.randrange(path.stat().st_size)
    os.truncate(path, size)
    return f"cut to {size} bytes"


def empty(path, rng):
    path.write_bytes(b"")
    return "emptied"


def flip_bits(path, rng):
    data, count = bytearray(path.read_bytes()), rng.choice((1, 1, 4, 64))
    for _ in range(count):
        data[rng.randrange(len(data))] ^= 1 << rng.randrange(8)
    path.write_bytes(data)
    return f"{count} bits flipped"


def replace_number(path, rng, values):
    """Replaces one number in a text, or in the header of a point cloud."""
    data = path.read_bytes()
    if path.suffix in IMAGES + BINARY_CLOUDS:
        return None
    at = rng.choice([m.span() for m in NUMBER.finditer(data[:20000])] or [None])
    if at is None:
        return None
    value = rng.choice(values)
    path.write_bytes(data[:at[0]] + value + data[at[1]:])
    return f"{data[at[0]:at[1]].decode()} at byte {at[0]} became {value!r}"


def replace_float(path, rng, values):
    data = bytearray(path.read_bytes())
    if path.suffix not in (".bin", ".ply", ".pcd") or len(data) < 600 or (path.suffix != ".bin" and is_text(path)):
        return None
    at, value, count = rng.randrange(len(data) // 8, len(data) // 4) * 4, rng.choice(values), rng.choice((1, 1, 400))
    for place in range(at, min(at + 4 * count, len(data) - 3), 4):
        struct.pack_into("<f", data, place, value)
    path.write_bytes(data)
    return f"{count} floats from byte {at} became {value}"


def huge(path, rng):
    return replace_float(path, rng, HUGE_FLOATS) or replace_number(path, rng, HUGE) or image_header(path, rng)


def not_a_number(path, rng):
    return replace_float(path, rng, (float("nan"), float("inf"))) or replace_number(path, rng, NOT_NUMBERS)


def duplicate_line(path, rng):
    return edit_lines(path, rng, lambda lines, i: lines[:i + 1] + lines[i:], "twice")


def drop_line(path, rng):
    return edit_lines(path, rng, lambda lines, i: lines[:i] + lines[i + 1:], "dropped")


def swap_lines(path, rng):
    return edit_lines(path, rng, lambda lines, i: lines[i:] + lines[:i], "moved to the top with all that follow")


def edit_lines(path, rng, edit, done):
    if not is_text(path):
        return None
    lines = path.read_bytes().splitlines(keepends=True)
    if not lines:
        return None
    at = rng.randrange(len(lines))
    path.write_bytes(b"".join(edit(lines, at)))
    return f"line {at + 1} {done}"


def encoding(path, rng):
    if not is_text(path):
        return None
    text = path.read_bytes().decode("latin-1")
    kind = rng.choice(("utf-16", "utf-16-be", "utf-8-sig", "latin-1", "cr", "crlf", "nul"))
    at = rng.randrange(len(text) + 1)
    if kind in ("cr", "crlf"):
        data = text.replace("\n", "\r" if kind == "cr" else "\r\n").encode("latin-1")
    elif kind in ("latin-1", "nul"):
        data = (text[:at] + ("\0" if kind == "nul" else "\xfc") + text[at:]).encode("latin-1")
    else:
        data = text.encode(kind)
    path.write_bytes(data)
    return f"as {kind}"


def swap_files(path, rng):
    others = sorted(p for p in path.parent.rglob("*") if p.is_file() and p != path and not p.is_symlink())
    if not others:
        return None
    other = rng.choice(others)
    mine, theirs = path.read_bytes(), other.read_bytes()
    path.write_bytes(theirs), other.write_bytes(mine)
    return f"swapped with {other.name}"


def remove(path, rng):
    shutil.rmtree(path) if path.is_dir() else path.unlink()
    return "deleted"


def instead(path, rng, make, done):
    remove(path, rng)
    make(path)
    return done


def dangling_link(path, rng):
    return instead(path, rng, lambda p: p.symlink_to("nowhere"), "a dangling link instead")


def link_loop(path, rng):
    target = rng.choice((path.name, "."))
    return instead(path, rng, lambda p: p.symlink_to(target), f"a link to '{target}' instead")


def directory_instead(path, rng):
    return instead(path, rng, lambda p: p.mkdir(), "an empty folder instead") if path.is_file() else None


def file_instead(path, rng):
    return instead(path, rng, lambda p: p.write_bytes(b"1\n"), "a file instead") if path.is_dir() else None


def fifo_instead(path, rng):
    return instead(path, rng, os.mkfifo, "a FIFO instead")


def device_instead(path, rng):
    device = rng.choice(("/dev/zero", "/dev/null"))
    return instead(path, rng, lambda p: p.symlink_to(device), f"a link to {device} instead")


def no_permission(path, rng):
    if os.geteuid() == 0:
        return None  # root can read all files
    path.chmod(0)
    return "no permission"


def free_name(path, rng):
    """A name of the list and the file beside it that would have it; no file where there is one already."""
    name = rng.choice(NAMES)
    target = os.fsencode(path.parent) + b"/" + name + os.fsencode(path.suffix)
    return name, None if os.path.lexists(target) else target


def rename(path, rng):
    name, target = free_name(path, rng)
    if target is None:
        return None
    os.rename(path, target)
    return f"renamed to {name!r}"


def stray(path, rng):
    if not path.is_file():
        return None
    name, target = free_name(path, rng)
    if target is None:
        return None
    shutil.copyfile(path, target)
    return f"copied to {name!r}"


def repaint(path, rng):
    """Writes a valid image with a different size, depth, or number of channels."""
    image = png.decode(path.read_bytes()) if path.suffix == ".png" else None
    if image is None:
        return None
    width, height = rng.choice(((1, 1), (image.width * 2, image.height), (image.width, image.height - 1),
                                (image.height, image.width), (image.width, image.height), (image.width, image.height)))
    color, depth = rng.choice((png.GRAY, png.RGB, png.GRAY_ALPHA, png.RGBA)), rng.choice((8, 16))
    size = width * height * png.CHANNELS[color] * depth // 8
    data = (image.data * (size // len(image.data) + 1))[:size]
    path.write_bytes(png.encode(png.Image(width, height, color, depth, data)))
    return f"repainted as {width}x{height}, color type {color}, {depth} bits"


def palette(path, rng):
    image = png.decode(path.read_bytes()) if path.suffix == ".png" else None
    if image is None:
        return None
    data, entries = rng.randbytes(image.width * image.height), rng.choice((256, 2))
    painted = png.Image(image.width, image.height, png.PALETTE, 8, data)
    path.write_bytes(png.encode(painted, palette=rng.randbytes(3 * entries)))
    return f"a palette of {entries} colors"


def image_header(path, rng):
    """Writes a size in the header that differs from the data, with a valid checksum."""
    data = bytearray(path.read_bytes()) if path.suffix == ".png" else b""
    if not data.startswith(png.SIGNATURE):
        return None
    at, value = rng.choice((16, 20)), rng.choice((0, 1, 30000, 65536, 1000000, 2**31 - 1, 2**31, 2**32 - 1))
    struct.pack_into(">I", data, at, value)
    data[12:33] = png.chunk(b"IHDR", bytes(data[16:29]))[4:]
    path.write_bytes(data)
    return f"{'width' if at == 16 else 'height'} {value} in the header"


@lru_cache(maxsize=1)
def _bomb():
    return png.bomb()


def bomb(path, rng):
    if path.suffix not in IMAGES:
        return None
    path.write_bytes(_bomb())
    return "a picture of 30000x30000 in a small file"


def sparse(path, rng):
    """Makes a huge sparse file."""
    size = rng.choice((3 << 30, 1 << 36))
    os.truncate(path, size)
    return f"{size >> 30} GB of zeros"


def garbage(path, rng):
    path.write_bytes(rng.randbytes(rng.choice((1, 16, 5000))))
    return "random bytes"


def nested(path, rng):
    """Writes deep nesting, which overflows the stack of recursive parsers."""
    start, level = {".json": (b"", b"["), ".toml": (b"a = ", b"["), ".xml": (b"", b"<a>")}.get(path.suffix, (None, b""))
    if start is None:
        return None
    path.write_bytes(start + level * 200000)
    return "200000 levels deep"


def replace_word(path, rng):
    """Replaces a word of a text by another word of it."""
    if not is_text(path):
        return None
    words = re.split(rb"(\s+)", path.read_bytes())
    if len(words) < 3:
        return None
    i, j = rng.randrange(0, len(words), 2), rng.randrange(0, len(words), 2)
    words[i] = words[j]
    path.write_bytes(b"".join(words))
    return f"word {i // 2} became {words[j][:20]!r}"


ON_FILES = (truncate, empty, flip_bits, huge, not_a_number, duplicate_line, drop_line, swap_lines, encoding, swap_files,
            directory_instead, no_permission, stray, repaint, palette, image_header, bomb, sparse, garbage, nested, replace_word)
ON_ANYTHING = (remove, rename, dangling_link, link_loop, fifo_instead, device_instead, file_instead)
ALL = ON_FILES + ON_ANYTHING


def kind_of(path, root):
    """Returns the kind of a file: files of one kind have the same reader."""
    if path.is_dir():
        return "folder"
    parent = str(path.parent.relative_to(root))
    return f"{parent}/*{path.suffix}" if re.search(r"\d{3}", path.name) else f"{parent}/{path.name}"


def mutate(root, rng, mutation):
    """Applies a mutation to a file or folder below `root`, with equal probability per kind; returns (the path, the description)."""
    kinds = {}
    for path in sorted(root.rglob("*")):
        if path.is_file() or mutation in ON_ANYTHING:
            kinds.setdefault(kind_of(path, root), []).append(path)
    for kind in rng.sample(sorted(kinds), len(kinds)):
        path = rng.choice(kinds[kind])
        done = mutation(path, rng)
        if done is not None:
            return path, done
    return None, "does not apply"
