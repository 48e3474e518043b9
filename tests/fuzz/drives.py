"""Makes tiny drives in several layouts, so that files of each reader can be damaged."""
import shutil
import sqlite3
import struct
import tomllib
from pathlib import Path
from typing import NamedTuple

import apolloscape
import kitti
import png

BAGS = Path(__file__).resolve().parent.parent / "layouts/bags"
STATIC_MASK_PX = (8, 24, 24, 36)  # left, top, width, height
SYNTH = ("--frames", 4, "--width", 128, "--height", 80, "--beams", 16, "--columns", 200)


class Layout(NamedTuple):
    """A folder to copy, the drive's path in it, and the true images as RGB bytes, if they are known."""
    folder: Path
    inner: str
    truths: list


def synthetic_with_truth(program, folder, *options):
    """(A drive as `dvi synth` makes it, its true images as RGB bytes); its PNG masks are used, its boxes are not."""
    made = program.call("synth", "-o", folder, *SYNTH, *options)
    if made.code != 0:
        raise SystemExit(f"fuzz: dvi synth failed: {made.err}")
    truths = [png.rgb(png.decode(path.read_bytes())) for path in sorted((folder / "truth").glob("*.png"))]
    for truth in folder.glob("truth*"):
        shutil.rmtree(truth) if truth.is_dir() else truth.unlink()
    (folder / "README.txt").unlink(missing_ok=True)
    return folder, truths


def synthetic(program, folder, *options):
    return synthetic_with_truth(program, folder, *options)[0]


def mask_static_surfaces(drive):
    """Adds a rectangle to each mask, left and right in turn, whose background is copied well only with correct poses and times."""
    for i, path in enumerate(sorted((drive / "masks/front").glob("*.png"))):
        mask = png.decode(path.read_bytes())
        left, top, width, height = STATIC_MASK_PX
        left, data = (left, mask.width - left - width)[i % 2], bytearray(mask.data)
        for y in range(top, top + height):
            data[y * mask.width + left:y * mask.width + left + width] = b"\xff" * width
        path.write_bytes(png.encode(mask._replace(data=bytes(data))))


def calibration_of(drive):
    return tomllib.loads((drive / "dvi.toml").read_text())["camera"]["front"]


def poses_of(drive):
    lines = [line.split() for line in (drive / "poses.txt").read_text().splitlines()]
    return {words[0]: [float(word) for word in words[1:]] for words in lines}


def boxes_and_clouds(source, target):
    """JPEG images, boxes instead of masks, PLY and PCD scans of both kinds, TUM poses."""
    shutil.copytree(source, target)
    shutil.rmtree(target / "masks")
    for image in sorted((target / "images/front").glob("*.png")):
        image.with_suffix(".jpg").write_bytes(png.blocky_jpeg(png.decode(image.read_bytes())))
        image.unlink()
    for i, scan in enumerate(sorted((target / "lidar").glob("*.bin"))):
        points = list(struct.iter_unpack("<4f", scan.read_bytes()))
        scan.with_suffix(".pcd" if i % 2 else ".ply").write_bytes(pcd(points, i > 1) if i % 2 else ply(points, i > 1))
        scan.unlink()
    times = [line.split()[1] for line in (target / "times/lidar.txt").read_text().splitlines()]
    tum = "".join(f"{time} {p[3]} {p[7]} {p[11]} 0 0 0 1\n" for time, p in zip(times, poses_of(source).values()))
    (target / "poses.txt").write_text(tum)
    return target


def ply(points, binary):
    header = f"ply\nformat {'binary_little_endian' if binary else 'ascii'} 1.0\nelement vertex {len(points)}\n" + "".join(
        f"property float {name}\n" for name in ("x", "y", "z", "intensity")) + "property ushort ring\nend_header\n"
    if binary:
        return header.encode() + b"".join(struct.pack("<4fH", *p, 0) for p in points)
    return (header + "".join("%.6g %.6g %.6g %.3g 0\n" % p for p in points)).encode()


def pcd(points, binary):
    header = (f"# .PCD v0.7\nVERSION 0.7\nFIELDS x y z intensity\nSIZE 4 4 4 4\nTYPE F F F F\nCOUNT 1 1 1 1\n"
              f"WIDTH {len(points)}\nHEIGHT 1\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS {len(points)}\n"
              f"DATA {'binary' if binary else 'ascii'}\n")
    if binary:
        return header.encode() + b"".join(struct.pack("<4f", *p) for p in points)
    return (header + "".join("%.6g %.6g %.6g %.3g\n" % p for p in points)).encode()


def depth_images(source, target):
    """Depth images instead of scans: the ground and a wall that comes nearer, in millimeters."""
    shutil.copytree(source, target)
    shutil.rmtree(target / "lidar")
    (target / "depth/front").mkdir(parents=True)
    (target / "times/lidar.txt").unlink()
    calibration = calibration_of(source)
    (width, height), k = calibration["size"], calibration["K"]
    for i, image in enumerate(sorted((target / "images/front").glob("*.png"))):
        wall = 20 - 0.8 * i
        rows = [min(wall, 1.7 * k[4] / (y - k[5])) if y > k[5] else wall for y in range(height)]
        data = b"".join(struct.pack(">H", int(1000 * z)) * width for z in rows)
        (target / "depth/front" / image.name).write_bytes(png.encode(png.Image(width, height, png.GRAY, 16, data)))
    return target


def video(program, source, target):
    """The video of a run instead of images."""
    shutil.copytree(source, target)
    made = program.call("run", source, "-o", target / "out")
    if made.code != 0:
        raise SystemExit(f"fuzz: dvi run failed: {made.err}")
    shutil.rmtree(target / "images/front")
    (target / "out/video.mp4").rename(target / "images/front.mp4")
    shutil.rmtree(target / "out")
    return target


def bag_in_parts(target):
    """A ROS 2 bag in two databases, with the metadata.yaml that lists them."""
    target.mkdir()
    names = [f"drive_{part}.db3" for part in (0, 1)]
    for name, condition in zip(names, (">=", "<")):
        shutil.copy(BAGS / "sqlite.db3", target / name)
        with sqlite3.connect(target / name) as bag:
            middle = "(SELECT (MIN(timestamp) + MAX(timestamp)) / 2 FROM messages WHERE topic_id > 1)"
            bag.execute(f"DELETE FROM messages WHERE timestamp {condition} {middle}")
        bag.close()
    (target / "metadata.yaml").write_text(
        "rosbag2_bagfile_information:\n  version: 4\n  storage_identifier: sqlite3\n  relative_file_paths:\n" +
        "".join(f"    - {name}\n" for name in names) +
        "  duration:\n    nanoseconds: 250000000\n  starting_time:\n    nanoseconds_since_epoch: 1000050000000\n"
        "  message_count: 21\n  topics_with_message_count: []\n  compression_format: \"\"\n  compression_mode: \"\"\n")


def all_layouts(program, folder):
    """Returns the layouts by name."""
    source, truths = synthetic_with_truth(program, folder / "folder")
    mask_static_surfaces(source)
    calibration, poses = calibration_of(source), poses_of(source)
    boxes_and_clouds(source, folder / "boxes")
    depth_images(source, folder / "depth")
    video(program, source, folder / "video")
    kitti_drive = kitti.convert(source, folder / "kitti", calibration, poses, "tracklets")
    kitti.convert(source, folder / "kitti-outlines", calibration, poses, "outlines")
    apolloscape.convert(source, folder / "apolloscape", calibration, poses)
    bag_in_parts(folder / "bag")
    (folder / "mcap").mkdir()
    shutil.copy(BAGS / "zstd.mcap", folder / "mcap/drive.mcap")
    inner = kitti_drive.relative_to(folder / "kitti")
    return {path.name: Layout(path, inner if path.name.startswith("kitti") else "",
                              [] if path.name in ("bag", "mcap") else truths)
            for path in sorted(folder.iterdir())}
