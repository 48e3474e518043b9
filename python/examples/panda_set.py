"""PandaSet by its devkit: python3 panda_set.py ROOT SEQUENCE OUT (needs the devkit `pandaset`)."""
import sys

import numpy as np

import dvi
from motions import motion, moved


def pose(entry):
    q, p = entry["heading"], entry["position"]
    return motion(q["w"], q["x"], q["y"], q["z"], p["x"], p["y"], p["z"])


class PandaSet:
    def __init__(self, sequence, camera="front_camera"):
        self.lidar, self.camera, self.name = sequence.lidar, sequence.camera[camera], camera
        self.start = min(self.lidar.timestamps)
        k, size = self.camera.intrinsics, self.camera[0].size
        # Both poses are of about the same time; the vehicle moves a little between them.
        camera_from_lidar = np.linalg.inv(pose(self.camera.poses[0])) @ pose(self.lidar.poses[0])
        self.cameras = [dvi.Camera(camera, size, [[k.fx, 0, k.cx], [0, k.fy, k.cy], [0, 0, 1]], camera_from_lidar)]

    def __len__(self):
        return len(self.lidar.timestamps)

    def frame(self, i):
        return dvi.FrameData({self.name: np.asarray(self.camera[i].convert("RGB"))}, self.camera.timestamps[i] - self.start)

    def scan(self, i):
        points = self.lidar[i]
        points = points[points.d == 0]  # the turning LiDAR; world axes, compensated already
        world_from_lidar = pose(self.lidar.poses[i])
        xyz = moved(np.linalg.inv(world_from_lidar), points[["x", "y", "z"]].to_numpy())
        return dvi.ScanData(np.column_stack([xyz, points.i / 255]), self.lidar.timestamps[i] - self.start,
                            world_from_lidar=world_from_lidar)


if __name__ == "__main__":
    from pandaset import DataSet

    sequence = DataSet(sys.argv[1])[sys.argv[2]]
    sequence.load()
    for frame in dvi.run(PandaSet(sequence), out=sys.argv[3]):
        print(frame.name)
