#!/usr/bin/env python3
"""write_rgbd_bag.py DRIVE OUT.bag [16UC1|32FC1]: a plain drive with depth images as a ROS 1 bag, by Debian's python3-rosbag.

Depth has its own pose and calibration if the drive's dvi.toml contains them."""
import pathlib
import sys
import tomllib

import cv2
import geometry_msgs.msg
import numpy as np
import rosbag
import rospy
import sensor_msgs.msg
import tf2_msgs.msg

drive, kind = pathlib.Path(sys.argv[1]), sys.argv[3] if len(sys.argv) > 3 else "16UC1"
config = tomllib.loads((drive / "dvi.toml").read_text())
(name, camera), depth = next(iter(config["camera"].items())), config.get("depth", {})
WORLD, COLOR = "world", "color_optical"
DEPTH = "depth_optical" if "depth_from_color" in depth else COLOR


def matrix(numbers):
    return np.vstack([np.array(numbers, float).reshape(3, 4), [0, 0, 0, 1]])


def stamped(kind_of_message, text, frame):
    seconds, digits = text.split(".")
    message = kind_of_message()
    message.header.stamp, message.header.frame_id = rospy.Time(int(seconds), int(digits.ljust(9, "0"))), frame
    return message


def transform(motion, text, parent, child):
    """Returns the tf message of parent_from_child."""
    message = stamped(geometry_msgs.msg.TransformStamped, text, parent)
    message.child_frame_id = child
    t, q = message.transform.translation, message.transform.rotation
    t.x, t.y, t.z = motion[:3, 3]
    w = np.sqrt(max(0, 1 + np.trace(motion[:3, :3]))) / 2
    assert w > 0.1, "this drive turns too far for a short script"
    R = motion[:3, :3]
    q.w, q.x, q.y, q.z = w, (R[2, 1] - R[1, 2]) / (4 * w), (R[0, 2] - R[2, 0]) / (4 * w), (R[1, 0] - R[0, 1]) / (4 * w)
    return tf2_msgs.msg.TFMessage([message])


def info(K, size, text, frame):
    message = stamped(sensor_msgs.msg.CameraInfo, text, frame)
    message.width, message.height, message.K, message.distortion_model = *size, K, "plumb_bob"
    message.P = [K[0], 0, K[2], 0, 0, K[4], K[5], 0, 0, 0, 1, 0]
    return message


lines = [line.split() for line in (drive / f"times/{name}.txt").read_text().splitlines()]
poses = {line.split()[0]: matrix(line.split()[1:]) for line in (drive / "poses.txt").read_text().splitlines()}
color_from_body = matrix(camera["camera_from_lidar"]) if "camera_from_lidar" in camera else np.eye(4)
with rosbag.Bag(sys.argv[2], "w") as bag:
    for i, (frame, text) in enumerate(lines):
        def write(topic, message):
            bag.write(topic, message, rospy.Time.from_sec(float(text)))
        values = cv2.imread(str(drive / f"depth/{name}/{frame}.png"), cv2.IMREAD_UNCHANGED)
        if i == 0:
            if DEPTH != COLOR:
                write("/tf_static", transform(matrix(depth["depth_from_color"]), text, DEPTH, COLOR))
            write("/camera/rgb/camera_info", info(camera["K"], camera["size"], text, COLOR))
            write("/camera/depth/camera_info", info(depth.get("K", camera["K"]), values.shape[::-1], text, DEPTH))
        # The tree has one root, so the pose is that of its topmost sensor.
        root = DEPTH if DEPTH != COLOR else COLOR
        body = poses[frame] @ np.linalg.inv(color_from_body)
        root_pose = body @ np.linalg.inv(matrix(depth["depth_from_color"])) if root != COLOR else body
        write("/tf", transform(root_pose, text, WORLD, root))
        image = stamped(sensor_msgs.msg.CompressedImage, text, COLOR)
        file = next((drive / f"images/{name}").glob(frame + ".*"))
        image.format, image.data = file.suffix[1:], file.read_bytes()
        write("/camera/rgb/image_color/compressed", image)
        values = np.where(values == 65535, 0, values).astype(np.uint16)
        if kind == "32FC1":
            values = np.where(values == 0, np.nan, values / 1000).astype(np.float32)
        message = stamped(sensor_msgs.msg.Image, text, DEPTH)
        message.height, message.width, message.encoding = *values.shape, kind
        message.step, message.data = values.strides[0], values.tobytes()
        write("/camera/depth/image", message)
