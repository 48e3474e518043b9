#!/usr/bin/env python3
"""livox_messages.py DRIVE MESSAGES: the first camera and the scans of a plain drive as ROS messages, for write_ros1.py and
write_mcap.mjs. The scans are CustomMsg of Livox' drivers, and the images are gray with 12 of 16 bits in use."""
import json
import pathlib
import sys
import tomllib

import cv2
import numpy as np

from layouts import inverse, quaternion

folder, out = pathlib.Path(sys.argv[1]), pathlib.Path(sys.argv[2])
out.mkdir(parents=True, exist_ok=True)
camera, settings = next(iter(tomllib.loads((folder / "dvi.toml").read_text())["camera"].items()))
SCAN_NS = 100_000_000
messages = []


def header(ns, frame):
    return {"stamp": {"sec": ns // 10**9, "nanosec": ns % 10**9}, "frame_id": frame}


def add(ns, topic, kind, value):
    messages.append({"time": str(ns), "topic": topic, "type": kind, "value": value})


def stamps(name):
    rows = [row.split() for row in (folder / f"times/{name}.txt").read_text().splitlines()]
    return [(n, int(t.split(".")[0]) * 10**9 + int(t.split(".")[1].ljust(9, "0"))) for n, t in rows]


def transform(ns, parent, child, pose):
    w, x, y, z = quaternion(pose)
    return {"header": header(ns, parent), "child_frame_id": child,
            "transform": {"translation": {"x": pose[3], "y": pose[7], "z": pose[11]}, "rotation": {"x": x, "y": y, "z": z, "w": w}}}


K, (width, height) = settings["K"], settings["size"]
poses = {row.split()[0]: [float(v) for v in row.split()[1:]] for row in (folder / "poses.txt").read_text().splitlines()}
for i, (name, ns) in enumerate(stamps(camera)):
    gray = cv2.imread(str(folder / f"images/{camera}/{name}.png"), cv2.IMREAD_GRAYSCALE)
    (out / f"{name}.bytes").write_bytes((gray.astype("<u2") << 4).tobytes())
    if i == 0:
        add(ns - 1, "/camera/camera_info", "sensor_msgs/CameraInfo",
            {"header": header(ns, "camera"), "height": height, "width": width, "distortion_model": "plumb_bob", "D": [0.0] * 5,
             "K": K, "R": [1.0, 0, 0, 0, 1.0, 0, 0, 0, 1.0], "P": [K[0], 0, K[2], 0, 0, K[4], K[5], 0, 0, 0, 1.0, 0],
             "binning_x": 0, "binning_y": 0,
             "roi": {"x_offset": 0, "y_offset": 0, "height": 0, "width": 0, "do_rectify": False}})
        add(ns - 1, "/tf_static", "tf2_msgs/TFMessage",
            {"transforms": [transform(ns, "livox_frame", "camera", inverse(settings["camera_from_lidar"]))]})
    add(ns, "/camera/image_raw", "sensor_msgs/Image",
        {"header": header(ns, "camera"), "height": height, "width": width, "encoding": "mono16", "is_bigendian": 0,
         "step": 2 * width, "data": {"bytes": f"{name}.bytes"}})
for name, ns in stamps("lidar"):
    points = np.fromfile(folder / f"lidar/{name}.bin", np.float32).reshape(-1, 4)
    turned = np.mod(np.pi - np.arctan2(points[:, 1].astype(float), points[:, 0].astype(float)), 2 * np.pi) / (2 * np.pi)
    start = ns - SCAN_NS // 2
    rows = [{"offset_time": int(t * SCAN_NS), "x": float(p[0]), "y": float(p[1]), "z": float(p[2]),
             "reflectivity": int(255 * p[3]), "tag": 16, "line": i % 4} for i, (p, t) in enumerate(zip(points, turned))]
    rows.append({"offset_time": 0, "x": 0.0, "y": 0.0, "z": 0.0, "reflectivity": 0, "tag": 0, "line": 0})  # no return
    add(ns + SCAN_NS // 2, "/livox/lidar", "livox_ros_driver2/CustomMsg",
        {"header": header(start, "livox_frame"), "timebase": str(start), "point_num": len(rows), "lidar_id": 1, "rsvd": [0, 0, 0],
         "points": rows})
    add(ns, "/tf", "tf2_msgs/TFMessage", {"transforms": [transform(ns, "odom", "livox_frame", poses[name])]})
messages.sort(key=lambda m: int(m["time"]))
(out / "messages.json").write_text(json.dumps(messages))
