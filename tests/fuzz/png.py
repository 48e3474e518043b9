"""PNG files and the simplest JPEG files, with Python's standard library alone."""
import struct
import zlib
from functools import lru_cache
from typing import NamedTuple

SIGNATURE = b"\x89PNG\r\n\x1a\n"
GRAY, RGB, PALETTE, GRAY_ALPHA, RGBA = 0, 2, 3, 4, 6
CHANNELS = {GRAY: 1, RGB: 3, PALETTE: 1, GRAY_ALPHA: 2, RGBA: 4}


class Image(NamedTuple):
    """Samples row by row, channels interleaved; 16-bit samples are two bytes, the high one first."""
    width: int
    height: int
    color: int
    depth: int
    data: bytes

    @property
    def pixel_bytes(self):
        return CHANNELS[self.color] * self.depth // 8


def chunk(kind, data):
    return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))


def encode(image, palette=b""):
    stride = image.width * image.pixel_bytes
    rows = b"".join(b"\0" + image.data[y * stride:(y + 1) * stride] for y in range(image.height))
    header = struct.pack(">IIBBBBB", image.width, image.height, image.depth, image.color, 0, 0, 0)
    return (SIGNATURE + chunk(b"IHDR", header) + (chunk(b"PLTE", palette) if palette else b"") +
            chunk(b"IDAT", zlib.compress(rows)) + chunk(b"IEND", b""))


def bomb(side=30000):
    """A valid file of about 100 kB whose picture, decoded to 8-bit RGB, takes 2.7 GB."""
    packer = zlib.compressobj(9)
    row = bytes(1 + (side + 7) // 8)
    data = b"".join(packer.compress(row) for _ in range(side)) + packer.flush()
    header = struct.pack(">IIBBBBB", side, side, 1, GRAY, 0, 0, 0)
    return SIGNATURE + chunk(b"IHDR", header) + chunk(b"IDAT", data) + chunk(b"IEND", b"")


def decode(data):
    """The Image of a PNG file with 8 or 16 bits a sample, without palette or interlacing; None for any other file."""
    try:
        return _decode(data)
    except (KeyError, IndexError, ValueError, struct.error, zlib.error):
        return None


@lru_cache(maxsize=256)
def _decode(data):
    if not data.startswith(SIGNATURE):
        return None
    at, packed, header = len(SIGNATURE), b"", None
    while at < len(data):
        size, kind = struct.unpack_from(">I4s", data, at)
        body = data[at + 8:at + 8 + size]
        if kind == b"IHDR":
            header = struct.unpack(">IIBBBBB", body)
        elif kind == b"IDAT":
            packed += body
        at += size + 12
    if header is None:
        return None
    width, height, depth, color, _, _, interlaced = header
    if depth not in (8, 16) or color == PALETTE or interlaced or width * height > 1 << 24:
        return None
    step = CHANNELS[color] * depth // 8
    return Image(width, height, color, depth, _unfilter(zlib.decompress(packed), width * step, height, step))


def _unfilter(rows, stride, height, step):
    out, above = bytearray(), bytearray(stride)
    for y in range(height):
        begin = y * (stride + 1)
        kind, row = rows[begin], bytearray(rows[begin + 1:begin + 1 + stride])
        if len(row) != stride:
            raise ValueError("cut")
        if kind == 1:
            for i in range(step, stride):
                row[i] = (row[i] + row[i - step]) & 255
        elif kind == 2:
            row = bytearray((a + b) & 255 for a, b in zip(row, above))
        elif kind in (3, 4):
            for i in range(stride):
                left, up, corner = (row[i - step], above[i], above[i - step]) if i >= step else (0, above[i], 0)
                row[i] = (row[i] + ((left + up) // 2 if kind == 3 else _paeth(left, up, corner))) & 255
        elif kind != 0:
            raise ValueError("unknown filter")
        out += row
        above = row
    return bytes(out)


def _paeth(left, up, corner):
    a, b, c = abs(up - corner), abs(left - corner), abs(left + up - 2 * corner)
    return left if a <= b and a <= c else up if b <= c else corner


def rgb(image):
    """8-bit RGB samples of any Image."""
    data = image.data[::2] if image.depth == 16 else image.data
    step = CHANNELS[image.color]
    planes = [data[i::step] for i in ((0, 1, 2) if step > 2 else (0, 0, 0))]
    out = bytearray(3 * image.width * image.height)
    for i in range(3):
        out[i::3] = planes[i]
    return bytes(out)


def blocky_jpeg(image):
    """A baseline JPEG file of an 8-bit Image: one color per 8x8 block, which needs no cosine transform."""
    samples, bits, before = rgb(image), [], [0, 0, 0]
    sizes = 12  # the lengths of DC differences 0-11, all coded with 4 bits
    for top in range(0, image.height, 8):
        for left in range(0, image.width, 8):
            at = 3 * (min(top + 4, image.height - 1) * image.width + min(left + 4, image.width - 1))
            r, g, b = samples[at:at + 3]
            luma = 0.299 * r + 0.587 * g + 0.114 * b
            for i, value in enumerate((luma - 128, 0.564 * (b - luma), 0.713 * (r - luma))):
                dc = round(value)  # with a quantizer of 8, DC is the mean
                difference, before[i] = dc - before[i], dc
                length = abs(difference).bit_length()
                bits.append(f"{length:04b}")
                if length:
                    bits.append(f"{difference if difference > 0 else difference + (1 << length) - 1:0{length}b}")
                bits.append("0")  # end of block
    text = "".join(bits)
    text += "1" * (-len(text) % 8)
    scan = int(text, 2).to_bytes(len(text) // 8, "big").replace(b"\xff", b"\xff\0")

    def segment(marker, body):
        return struct.pack(">BBH", 255, marker, len(body) + 2) + body

    components = bytes([3]) + bytes(x for i in (1, 2, 3) for x in (i, 0x11, 0))
    return (b"\xff\xd8" + segment(0xDB, bytes([0] + [8] * 64)) +
            segment(0xC0, struct.pack(">BHH", 8, image.height, image.width) + components) +
            segment(0xC4, bytes([0, 0, 0, 0, sizes] + [0] * 12) + bytes(range(sizes))) +
            segment(0xC4, bytes([0x10, 1] + [0] * 15 + [0])) +
            segment(0xDA, bytes([3, 1, 0, 2, 0, 3, 0, 0, 63, 0])) + scan + b"\xff\xd9")
