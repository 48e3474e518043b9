#!/usr/bin/env python3
"""layouts.py LAYOUT DRIVE OUT: writes a drive of the plain layout, as `dvi synth` makes it, in the layout of a data set, after the
data set's own description and without any code of dvi's. Its scans are written as they are: they must be compensated for the motion
already, or be declared to be (rotation = "none")."""
import array
import datetime
import json
import math
import pathlib
import shutil
import struct
import sys
import tomllib

IDENTITY = [1.0, 0, 0, 0, 0, 1.0, 0, 0, 0, 0, 1.0, 0]


def times(a, b):
    """Multiplies two 3x4 transforms, given row by row."""
    out = []
    for r in range(3):
        for c in range(4):
            out.append(sum(a[4 * r + k] * b[4 * k + c] for k in range(3)) + (a[4 * r + 3] if c == 3 else 0))
    return out


def inverse(m):
    R = [[m[4 * c + r] for c in range(3)] for r in range(3)]
    t = [-sum(R[r][k] * m[4 * k + 3] for k in range(3)) for r in range(3)]
    return [*R[0], t[0], *R[1], t[1], *R[2], t[2]]


def quaternion(m):
    """Returns w, x, y, z of a rotation matrix, computed from its largest component for large angles."""
    r = [[m[4 * i + j] for j in range(3)] for i in range(3)]
    candidates = [1 + r[0][0] + r[1][1] + r[2][2], 1 + r[0][0] - r[1][1] - r[2][2], 1 - r[0][0] + r[1][1] - r[2][2],
                  1 - r[0][0] - r[1][1] + r[2][2]]
    k = candidates.index(max(candidates))
    s = 2 * math.sqrt(candidates[k])
    if k == 0:
        return [s / 4, (r[2][1] - r[1][2]) / s, (r[0][2] - r[2][0]) / s, (r[1][0] - r[0][1]) / s]
    if k == 1:
        return [(r[2][1] - r[1][2]) / s, s / 4, (r[0][1] + r[1][0]) / s, (r[0][2] + r[2][0]) / s]
    if k == 2:
        return [(r[0][2] - r[2][0]) / s, (r[0][1] + r[1][0]) / s, s / 4, (r[1][2] + r[2][1]) / s]
    return [(r[1][0] - r[0][1]) / s, (r[0][2] + r[2][0]) / s, (r[1][2] + r[2][1]) / s, s / 4]


def turned(yaw, center):
    c, s = math.cos(yaw), math.sin(yaw)
    return [c, -s, 0, center[0], s, c, 0, center[1], 0, 0, 1, center[2]]


def line(numbers):
    return " ".join(repr(float(n)) for n in numbers)


class Drive:
    """The contents of a drive of the plain layout, for its first camera."""

    def __init__(self, folder):
        self.folder = pathlib.Path(folder)
        settings = tomllib.loads((self.folder / "dvi.toml").read_text())
        self.camera, settings = next(iter(settings["camera"].items()))
        self.size, self.K, self.camera_from_lidar = settings["size"], settings["K"], settings["camera_from_lidar"]
        self.times = dict(row.split() for row in (self.folder / f"times/{self.camera}.txt").read_text().splitlines())
        self.names = sorted(self.times)
        rows = [row.split() for row in (self.folder / "poses.txt").read_text().splitlines()]
        self.poses = {row[0]: [float(n) for n in row[1:]] for row in rows}
        self.boxes = json.loads((self.folder / "boxes.json").read_text())["frames"]

    def ns(self, name):
        seconds, fraction = self.times[name].split(".")
        return int(seconds) * 10**9 + int(fraction.ljust(9, "0"))

    def image(self, name):
        return self.folder / f"images/{self.camera}/{name}.png"

    def scan(self, name):
        return self.folder / f"lidar/{name}.bin"

    def world_from_box(self, name, box):
        return times(self.poses[name], turned(box["yaw"], box["center"]))


def copy(source, target):
    target.parent.mkdir(parents=True, exist_ok=True)
    shutil.copy(source, target)


def write(path, text):
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(text)


def projection(K, t):
    fx, cx, fy, cy = K[0], K[2], K[4], K[5]
    return [fx, 0, cx, fx * t[0] + cx * t[2], 0, fy, cy, fy * t[1] + cy * t[2], 0, 0, 1, t[2]]


def kitti_odometry(drive, out):
    """sequences/00 and poses/00.txt; P2 has an offset against camera 0, as in the benchmark."""
    offset = [0.06, 0.001, 0.003]
    rect0_from_lidar = times([1, 0, 0, -offset[0], 0, 1, 0, -offset[1], 0, 0, 1, -offset[2]], drive.camera_from_lidar)
    sequence = out / "sequences/00"
    first = None
    poses, stamps = [], []
    for i, name in enumerate(drive.names):
        copy(drive.image(name), sequence / f"image_2/{i:06d}.png")
        copy(drive.scan(name), sequence / f"velodyne/{i:06d}.bin")
        world_from_rect0 = times(drive.poses[name], inverse(rect0_from_lidar))
        first = first or world_from_rect0
        poses.append(line(times(inverse(first), world_from_rect0)))
        stamps.append(repr((drive.ns(name) - drive.ns(drive.names[0])) / 1e9))
    write(sequence / "calib.txt", "".join(f"P{k}: {line(projection(drive.K, offset if k == 2 else [0, 0, 0]))}\n" for k in range(4)) +
          f"Tr: {line(rect0_from_lidar)}\n")
    write(sequence / "times.txt", "\n".join(stamps) + "\n")
    write(out / "poses/00.txt", "\n".join(poses) + "\n")


def opencv_matrix(name, rows, columns, numbers):
    return (f'<{name} type_id="opencv-matrix"><rows>{rows}</rows><cols>{columns}</cols><dt>f</dt><data>\n{line(numbers)}</data>'
            f'</{name}>')


def kitti_360(drive, out):
    name = "2013_05_28_drive_0000_sync"
    images, scans = out / f"data_2d_raw/{name}", out / f"data_3d_raw/{name}/velodyne_points"
    dates, poses, objects = [], [], []
    camera_from_imu = [0, -1, 0, 0.1, 0, 0, -1, 0.9, 1, 0, 0, -0.4]
    c, s = math.cos(0.01), math.sin(0.01)
    rectified = [c, 0, s, 0, 0, 1, 0, 0, -s, 0, c, 0]
    camera0_from_lidar = times(inverse(rectified), drive.camera_from_lidar)
    imu_from_lidar = times(inverse(camera_from_imu), camera0_from_lidar)
    for i, n in enumerate(drive.names):
        copy(drive.image(n), images / f"image_00/data_rect/{i:010d}.png")
        copy(drive.scan(n), scans / f"data/{i:010d}.bin")
        ns = drive.ns(n)
        dates.append(datetime.datetime.fromtimestamp(ns // 10**9, datetime.timezone.utc).strftime("%Y-%m-%d %H:%M:%S") +
                     f".{ns % 10**9:09d}")
        poses.append(f"{i} " + line(times(drive.poses[n], inverse(imu_from_lidar))))
        for box in drive.boxes[n]:
            m = drive.world_from_box(n, box)
            scaled = [m[4 * r + k] * (box["size"][k] if k < 3 else 1) for r in range(3) for k in range(4)] + [0, 0, 0, 1]
            corners = [v for x in (-.5, .5) for y in (-.5, .5) for z in (-.5, .5) for v in (x, y, z)]
            k = len(objects)
            objects.append(f"<object{k}><index>{k}</index><label>{box['class']}</label><semanticId>26</semanticId>"
                           f"<instanceId>{box['track']}</instanceId><timestamp>{i}</timestamp><dynamic>1</dynamic>"
                           f"<start_frame>0</start_frame><end_frame>{len(drive.names)}</end_frame>" +
                           opencv_matrix("transform", 4, 4, scaled) + opencv_matrix("vertices", 8, 3, corners) + f"</object{k}>")
    objects.append("<object9999><index>9999</index><label>building</label><timestamp>-1</timestamp><start_frame>0</start_frame>"
                   "<end_frame>9</end_frame>" + opencv_matrix("transform", 4, 4, [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1]) +
                   opencv_matrix("vertices", 2, 3, [-5, -5, -5, 5, 5, 5]) + "</object9999>")
    write(images / "image_00/timestamps.txt", "\n".join(dates) + "\n")
    write(scans / "timestamps.txt", "\n".join(dates) + "\n")
    write(out / f"data_poses/{name}/poses.txt", "\n".join(poses) + "\n")
    write(out / f"data_3d_bboxes/train/{name}.xml", '<?xml version="1.0"?>\n<opencv_storage>\n' + "\n".join(objects) +
          "\n</opencv_storage>\n")
    P = projection(drive.K, [0, 0, 0])
    rotation = [rectified[4 * r + k] for r in range(3) for k in range(3)]
    write(out / "calibration/perspective.txt",
          f"calib_time: 28-May-2013\ncorner_dist: 0.06\nS_rect_00: {line(drive.size)}\nR_rect_00: {line(rotation)}\nP_rect_00: {line(P)}\n")
    write(out / "calibration/calib_cam_to_velo.txt", line(inverse(camera0_from_lidar)) + "\n")
    write(out / "calibration/calib_cam_to_pose.txt", f"image_00: {line(inverse(camera_from_imu))}\n")


def nuscenes(drive, out):
    """Two key frames, the rest as sweeps between; the LiDAR's x is right and its y forward."""
    theirs_from_ours = [0, -1.0, 0, 0, 1.0, 0, 0, 0, 0, 0, 1.0, 0]
    ego_from_lidar = [1.0, 0, 0, 0.9, 0, 1.0, 0, 0, 0, 0, 1.0, 1.8]  # ours
    tables = {k: [] for k in ("scene", "sample", "sample_data", "calibrated_sensor", "sensor", "ego_pose", "sample_annotation",
                              "instance", "category")}
    tables["scene"] = [{"token": "s1", "name": "scene-0061", "nbr_samples": 2}, {"token": "s2", "name": "scene-0062"}]
    ego_from_camera = times(ego_from_lidar, inverse(drive.camera_from_lidar))
    K = drive.K
    for channel, modality, pose, intrinsic in (("CAM_FRONT", "camera", ego_from_camera, [K[0:3], K[3:6], K[6:9]]),
                                               ("LIDAR_TOP", "lidar", times(ego_from_lidar, inverse(theirs_from_ours)), [])):
        tables["sensor"].append({"token": "sensor " + channel, "channel": channel, "modality": modality})
        tables["calibrated_sensor"].append({"token": "calibrated " + channel, "sensor_token": "sensor " + channel,
                                            "translation": [pose[3], pose[7], pose[11]], "rotation": quaternion(pose),
                                            "camera_intrinsic": intrinsic})
    keys = (drive.names[0], drive.names[-1])
    for name in keys:
        tables["sample"].append({"token": "sample " + name, "timestamp": drive.ns(name) // 1000, "scene_token": "s1"})
    for name in drive.names:
        us, folder = drive.ns(name) // 1000, "samples" if name in keys else "sweeps"
        pose = times(drive.poses[name], inverse(ego_from_lidar))
        tables["ego_pose"].append({"token": "ego " + name, "timestamp": us, "rotation": quaternion(pose),
                                   "translation": [pose[3], pose[7], pose[11]]})
        points = array.array("f", drive.scan(name).read_bytes())
        target = out / f"{folder}/LIDAR_TOP/n001__LIDAR_TOP__{us}.pcd.bin"
        target.parent.mkdir(parents=True, exist_ok=True)
        target.write_bytes(b"".join(struct.pack("<5f", -points[i + 1], points[i], points[i + 2], points[i + 3], 7)
                                    for i in range(0, len(points), 4)))
        copy(drive.image(name), out / f"{folder}/CAM_FRONT/n001__CAM_FRONT__{us}.png")
        for channel, ending in (("CAM_FRONT", "png"), ("LIDAR_TOP", "pcd.bin")):
            tables["sample_data"].append({
                "token": f"{channel} {name}", "sample_token": "sample " + min(keys, key=lambda k: abs(drive.ns(k) - drive.ns(name))),
                "ego_pose_token": "ego " + name, "calibrated_sensor_token": "calibrated " + channel, "timestamp": us,
                "is_key_frame": name in keys, "filename": f"{folder}/{channel}/n001__{channel}__{us}.{ending}",
                "width": drive.size[0] if ending == "png" else 0, "height": drive.size[1] if ending == "png" else 0})
    category = {"pedestrian": "human.pedestrian.adult", "cyclist": "vehicle.bicycle"}
    for name in keys:
        for box in drive.boxes[name]:
            track, kind = f"instance {box['track']}", category.get(box["class"], "vehicle." + box["class"])
            if all(row["token"] != kind for row in tables["category"]):
                tables["category"].append({"token": kind, "name": kind})
            if all(row["token"] != track for row in tables["instance"]):
                tables["instance"].append({"token": track, "category_token": kind})
            pose, (length, width, height) = drive.world_from_box(name, box), box["size"]
            tables["sample_annotation"].append({"token": f"{track} {name}", "sample_token": "sample " + name, "instance_token": track,
                                                "translation": [pose[3], pose[7], pose[11]], "rotation": quaternion(pose),
                                                "size": [width, length, height]})
    for table, rows in tables.items():
        write(out / f"v1.0-mini/{table}.json", json.dumps(rows))


LAYOUTS = {"kitti-odometry": kitti_odometry, "kitti-360": kitti_360, "nuscenes": nuscenes}

if __name__ == "__main__":
    LAYOUTS[sys.argv[1]](Drive(sys.argv[2]), pathlib.Path(sys.argv[3]))
