#!/usr/bin/env python3
"""bag_messages.py DRIVE OUT: makes the messages of a vehicle with the drive's sensors, for write_mcap.mjs, write_db3.py
and write_ros1.py: OUT/messages.json, and the bytes of images and points beside it. Needs OpenCV's Python."""
import json
import pathlib
import struct
import sys
import tomllib

import cv2
import numpy as np

from layouts import inverse, quaternion, times

out = pathlib.Path(sys.argv[2])
out.mkdir(parents=True, exist_ok=True)
folder = pathlib.Path(sys.argv[1])
settings = tomllib.loads((folder / "dvi.toml").read_text())
messages = []
blobs = 0


def blob(data):
    global blobs
    blobs += 1
    (out / f"{blobs}.bytes").write_bytes(data)
    return {"bytes": f"{blobs}.bytes"}


def stamp(ns):
    return {"sec": ns // 10**9, "nanosec": ns % 10**9}


def header(ns, frame):
    return {"stamp": stamp(ns), "frame_id": frame}


def add(ns, topic, kind, value):
    messages.append({"time": str(ns), "topic": topic, "type": kind, "value": value})


def transform(ns, parent, child, pose):
    w, x, y, z = quaternion(pose)
    return {"header": header(ns, parent), "child_frame_id": child,
            "transform": {"translation": {"x": pose[3], "y": pose[7], "z": pose[11]}, "rotation": {"x": x, "y": y, "z": z, "w": w}}}


def stamps(name):
    rows = [row.split() for row in (folder / f"times/{name}.txt").read_text().splitlines()]
    return [(n, int(t.split(".")[0]) * 10**9 + int(t.split(".")[1].ljust(9, "0"))) for n, t in rows]


def azimuth_times(points, rate):
    """Returns seconds after the start of a scan that rotates clockwise from behind."""
    azimuth = np.arctan2(points[:, 1].astype(np.float64), points[:, 0].astype(np.float64))
    return np.mod(np.pi - azimuth, 2 * np.pi) / (2 * np.pi) / rate


base_from_lidar = [1.0, 0, 0, 0.9, 0, 1.0, 0, 0, 0, 0, 1.0, 1.8]
first = stamps("lidar")[0][1]
edges = [transform(first, "base_link", "lidar", base_from_lidar)]
for k, (camera, c) in enumerate(settings["camera"].items()):
    edges.append(transform(first, "base_link", camera + "_optical", times(base_from_lidar, inverse(c["camera_from_lidar"]))))
    K, (width, height) = c["K"], c["size"]
    for name, ns in stamps(camera):
        file = folder / f"images/{camera}/{name}.png"
        if k == 0:  # one camera as files, the others as pixels
            add(ns + 3000000, f"/{camera}/image_raw/compressed", "sensor_msgs/CompressedImage",
                {"header": header(ns, camera + "_optical"), "format": "png", "data": blob(file.read_bytes())})
        else:
            image = cv2.cvtColor(cv2.imread(str(file)), cv2.COLOR_BGR2RGB)
            add(ns + 3000000, f"/{camera}/image_raw", "sensor_msgs/Image",
                {"header": header(ns, camera + "_optical"), "height": height, "width": width, "encoding": "rgb8",
                 "is_bigendian": 0, "step": 3 * width, "data": blob(image.tobytes())})
        if name == stamps(camera)[0][0]:
            add(ns + 2000000, f"/{camera}/camera_info", "sensor_msgs/CameraInfo",
                {"header": header(ns, camera + "_optical"), "height": height, "width": width, "distortion_model": "plumb_bob",
                 "D": [0.0] * 5, "K": K, "R": [1.0, 0, 0, 0, 1.0, 0, 0, 0, 1.0],
                 "P": [K[0], 0, K[2], 0, 0, K[4], K[5], 0, 0, 0, 1.0, 0], "binning_x": 0, "binning_y": 0,
                 "roi": {"x_offset": 0, "y_offset": 0, "height": 0, "width": 0, "do_rectify": False}})
add(first, "/tf_static", "tf2_msgs/TFMessage", {"transforms": edges})
rate = settings["lidar"]["rate"]
for name, ns in stamps("lidar"):
    points = np.fromfile(folder / f"lidar/{name}.bin", np.float32).reshape(-1, 4)
    start = ns - int(0.5e9 / rate)
    after = np.round(1e9 * azimuth_times(points, rate)).astype(np.uint32)
    packed = np.zeros(len(points) + 1, dtype=[("x", "<f4"), ("y", "<f4"), ("z", "<f4"), ("intensity", "<f4"), ("t", "<u4"), ("ring", "<u2")])
    for i, field in enumerate(("x", "y", "z", "intensity")):
        packed[field][:-1] = points[:, i]
    packed["t"][:-1] = after
    packed["x"][-1] = np.nan  # no return
    fields = [("x", 0, 7), ("y", 4, 7), ("z", 8, 7), ("intensity", 12, 7), ("t", 16, 6), ("ring", 20, 4)]
    add(ns + int(0.5e9 / rate), "/lidar/points", "sensor_msgs/PointCloud2",
        {"header": header(start, "lidar"), "height": 1, "width": len(packed),
         "fields": [{"name": n, "offset": o, "datatype": d, "count": 1} for n, o, d in fields], "is_bigendian": False,
         "point_step": packed.itemsize, "row_step": packed.nbytes, "data": blob(packed.tobytes()), "is_dense": False})
poses = {row.split()[0]: [float(v) for v in row.split()[1:]] for row in (folder / "poses.txt").read_text().splitlines()}
for name, ns in stamps("lidar"):
    pose = times(poses[name], inverse(base_from_lidar))
    add(ns, "/tf", "tf2_msgs/TFMessage", {"transforms": [transform(ns, "odom", "base_link", pose)]})
    w, x, y, z = quaternion(pose)
    add(ns, "/odometry", "nav_msgs/Odometry",
        {"header": header(ns, "odom"), "child_frame_id": "base_link",
         "pose": {"pose": {"position": {"x": pose[3], "y": pose[7], "z": pose[11]}, "orientation": {"x": x, "y": y, "z": z, "w": w}},
                  "covariance": [0.0] * 36},
         "twist": {"twist": {"linear": {"x": 0, "y": 0, "z": 0}, "angular": {"x": 0, "y": 0, "z": 0}}, "covariance": [0.0] * 36}})
base_from_antenna = [1.0, 0, 0, 0.4, 0, 1.0, 0, 0.2, 0, 0, 1.0, 1.5]
edges.append(transform(first, "base_link", "gps", base_from_antenna))
for k, (name, ns) in enumerate(stamps("lidar")):  # x points east
    pose = times(times(poses[name], inverse(base_from_lidar)), base_from_antenna)
    add(ns + 50000000, "/gps/fix", "sensor_msgs/NavSatFix",
        {"header": header(ns, "gps"), "status": {"status": -1 if k == 1 else 0, "service": 1},
         "latitude": 49.0 + pose[7] / 111210.0, "longitude": 8.4 + pose[3] / 73171.0, "altitude": 115.0 + pose[11],
         "position_covariance": [0.0] * 9, "position_covariance_type": 0})
messages.sort(key=lambda m: int(m["time"]))
(out / "messages.json").write_text(json.dumps(messages))
