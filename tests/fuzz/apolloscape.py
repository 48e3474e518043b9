"""Converts a drive of the `folder` layout to `apolloscape`."""
import math
import shutil
import struct

import png

FIRST = 1534313591.05


def ply(points, binary):
    """Points (x, y, z, intensity) in LiDAR axes, as a file in the axes of the recordings: x left, y back, z up."""
    kind = "binary_little_endian" if binary else "ascii"
    native = [(y, -x, z, i) for x, y, z, i in points]
    header = f"ply\nformat {kind} 1.0\nelement vertex {len(native)}\n" + "".join(
        f"property float {name}\n" for name in ("x", "y", "z", "intensity")) + "end_header\n"
    if binary:
        return header.encode() + b"".join(struct.pack("<4f", *p) for p in native)
    return (header + "".join("%.6g %.6g %.6g %.3g\n" % p for p in native)).encode()


def convert(source, target, calibration, poses):
    """Writes a drive into TARGET and returns it. Its dvi.toml replaces the calibration of the published recordings."""
    for folder in ("image", "lidar_bg", "1534313591-1534313599", "1534313591-1534313599_mask"):
        (target / folder).mkdir(parents=True)
    ends, motions = "", ""
    for i, image in enumerate(sorted((source / "images/front").glob("*.png"))):
        time, scan = f"{FIRST + 0.1 * i:.6f}", f"lidar_bg/bg_{FIRST + 0.1 * (i + 1):.6f}.pcd.ply"
        (target / f"image/{time}.jpg").write_bytes(png.blocky_jpeg(png.decode(image.read_bytes())))
        shutil.copy(source / f"masks/front/{image.name}", target / f"1534313591-1534313599_mask/{time}.png")
        points = list(struct.iter_unpack("<4f", (source / f"lidar/{image.stem}.bin").read_bytes()))
        (target / scan).write_bytes(ply(points, binary=i % 2 == 0))
        pose = poses[image.stem]
        yaw = math.atan2(pose[4], pose[0])
        ends += f"{scan} 0 {yaw:.9f} 0 {-pose[3] - 0.4:.6f} {pose[11]:.6f} {-pose[7]:.6f}\n"  # back, up, left
        motions += f"{scan} 0 0 0 0.8 0 0\n"
    (target / "1534313591-1534313599/global_poses.txt").write_text(ends)
    (target / "1534313591-1534313599/rel_poses.txt").write_text(motions)
    (target / "dvi.toml").write_text("[camera.front]\n" + "".join(
        f"{key} = {calibration[key]}\n" for key in ("size", "K", "camera_from_lidar")))
    return target
