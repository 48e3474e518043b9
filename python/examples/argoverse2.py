"""Argoverse 2 sensor logs, from their own files: python3 argoverse2.py LOG OUT (needs pandas, pyarrow, Pillow)."""
import sys
from pathlib import Path

import numpy as np
import pandas as pd
from PIL import Image

import dvi
from motions import motion, moved

QUATERNION = ["qw", "qx", "qy", "qz", "tx_m", "ty_m", "tz_m"]


class Argoverse2:
    def __init__(self, log, camera="ring_front_center"):
        self.log, self.name = Path(log), camera
        sensors = pd.read_feather(self.log / "calibration/egovehicle_SE3_sensor.feather").set_index("sensor_name")
        k = pd.read_feather(self.log / "calibration/intrinsics.feather").set_index("sensor_name").loc[camera]
        self.ego_from_lidar = motion(*sensors.loc["up_lidar", QUATERNION])
        ego_from_camera = motion(*sensors.loc[camera, QUATERNION])
        K = [[k.fx_px, 0, k.cx_px], [0, k.fy_px, k.cy_px], [0, 0, 1]]
        self.cameras = [dvi.Camera(camera, (int(k.width_px), int(k.height_px)), K,
                                   np.linalg.inv(ego_from_camera) @ self.ego_from_lidar)]
        poses = pd.read_feather(self.log / "city_SE3_egovehicle.feather").set_index("timestamp_ns")
        self.city_from_ego = {t: motion(*row) for t, row in zip(poses.index, poses[QUATERNION].to_numpy())}
        self.sweeps = sorted(int(p.stem) for p in (self.log / "sensors/lidar").glob("*.feather"))
        images = np.array(sorted(int(p.stem) for p in (self.log / "sensors/cameras" / camera).glob("*.jpg")))
        self.images = [int(images[np.abs(images - t).argmin()]) for t in self.sweeps]

    def __len__(self):
        return len(self.sweeps)

    def frame(self, i):
        file = self.log / "sensors/cameras" / self.name / f"{self.images[i]}.jpg"
        return dvi.FrameData({self.name: np.asarray(Image.open(file).convert("RGB"))}, 1e-9 * (self.images[i] - self.sweeps[0]))

    def scan(self, i):
        sweep = pd.read_feather(self.log / f"sensors/lidar/{self.sweeps[i]}.feather")
        sweep = sweep[sweep.laser_number < 32]  # the upper of the two LiDARs; points are compensated already
        points = moved(np.linalg.inv(self.ego_from_lidar), sweep[["x", "y", "z"]].to_numpy(float))
        return dvi.ScanData(np.column_stack([points, sweep.intensity / 255]), 1e-9 * (self.sweeps[i] - self.sweeps[0]),
                            world_from_lidar=self.city_from_ego[self.sweeps[i]] @ self.ego_from_lidar)


if __name__ == "__main__":
    for frame in dvi.run(Argoverse2(sys.argv[1]), out=sys.argv[2]):
        print(frame.name)
