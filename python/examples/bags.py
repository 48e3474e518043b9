"""ROS 1 and ROS 2 bags by the package `rosbags`: python3 bags.py BAG IMAGE_TOPIC POINTS_TOPIC OUT (needs rosbags).

Calibration is not in every bag: fill in K and camera_from_lidar. Poses are estimated from the scans.
"""
import sys
from pathlib import Path

import numpy as np
from rosbags.highlevel import AnyReader

import dvi

K = [[1000, 0, 640], [0, 1000, 360], [0, 0, 1]]
CAMERA_FROM_LIDAR = [[0, -1, 0, 0], [0, 0, -1, -0.2], [1, 0, 0, -0.3]]
TYPES = {1: "i1", 2: "u1", 3: "i2", 4: "u2", 5: "i4", 6: "u4", 7: "f4", 8: "f8"}


def seconds(message):
    return message.header.stamp.sec + 1e-9 * message.header.stamp.nanosec


class Bag:
    def __init__(self, path, image_topic, points_topic):
        self.reader = AnyReader([Path(path)])
        self.reader.open()
        self.images, self.clouds = self.messages(image_topic), self.messages(points_topic)
        size = (self.images[0].width, self.images[0].height)
        self.start = seconds(self.clouds[0])
        self.cameras = [dvi.Camera("camera", size, K, CAMERA_FROM_LIDAR)]

    def messages(self, topic):  # all at once: for long bags, keep their times and read one at a time
        connections = [c for c in self.reader.connections if c.topic == topic]
        return [self.reader.deserialize(raw, c.msgtype) for c, _, raw in self.reader.messages(connections)]

    def __len__(self):
        return len(self.clouds)

    def frame(self, i):
        image = min(self.images, key=lambda m: abs(seconds(m) - seconds(self.clouds[i])))
        pixels = np.asarray(image.data).reshape(image.height, image.step)[:, : 3 * image.width].reshape(image.height, image.width, 3)
        return dvi.FrameData({"camera": pixels[:, :, ::-1] if image.encoding == "bgr8" else pixels}, seconds(image) - self.start)

    def scan(self, i):
        cloud = self.clouds[i]
        layout = {"names": [f.name for f in cloud.fields], "formats": [TYPES[f.datatype] for f in cloud.fields],
                  "offsets": [f.offset for f in cloud.fields], "itemsize": cloud.point_step}
        points = np.frombuffer(cloud.data.tobytes(), layout)
        t = next((points[name].astype(float) for name in ("t", "time", "timestamp", "offset_time") if name in layout["names"]), None)
        if t is not None and t.max() - t.min() > 10:  # nanoseconds
            t = 1e-9 * t
        time = seconds(cloud)
        if t is not None and t.min() > 1e6:  # seconds since 1970
            t = t - time
        return dvi.ScanData(np.column_stack([points[axis] for axis in "xyz"]), time - self.start, t)


if __name__ == "__main__":
    for frame in dvi.run(Bag(*sys.argv[1:4]), out=sys.argv[4]):
        print(frame.name)
