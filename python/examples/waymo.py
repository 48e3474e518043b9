"""Waymo Open Dataset, perception v1: python3 waymo.py SEGMENT.tfrecord OUT (needs waymo_open_dataset, tensorflow)."""
import sys

import numpy as np
import tensorflow as tf
from waymo_open_dataset import dataset_pb2
from waymo_open_dataset.utils import frame_utils

import dvi
from motions import moved

CAMERA_AXES = np.array([[0, -1, 0, 0], [0, 0, -1, 0], [1, 0, 0, 0], [0, 0, 0, 1]])  # from x forward, y left, z up
FRONT = dataset_pb2.CameraName.FRONT
TOP = dataset_pb2.LaserName.TOP


class Waymo:
    def __init__(self, segment):
        self.frames = [dataset_pb2.Frame.FromString(record.numpy()) for record in tf.data.TFRecordDataset(segment)]
        context = self.frames[0].context
        camera = next(c for c in context.camera_calibrations if c.name == FRONT)
        laser = next(c for c in context.laser_calibrations if c.name == TOP)
        self.vehicle_from_lidar = np.reshape(laser.extrinsic.transform, (4, 4))
        fx, fy, cx, cy, *distortion = camera.intrinsic
        pose = CAMERA_AXES @ np.linalg.inv(np.reshape(camera.extrinsic.transform, (4, 4))) @ self.vehicle_from_lidar
        self.cameras = [dvi.Camera("FRONT", (camera.width, camera.height), [[fx, 0, cx], [0, fy, cy], [0, 0, 1]], pose, distortion)]
        self.start = self.frames[0].timestamp_micros

    def __len__(self):
        return len(self.frames)

    def frame(self, i):
        image = next(image for image in self.frames[i].images if image.name == FRONT)
        return dvi.FrameData({"FRONT": tf.io.decode_jpeg(image.image).numpy()}, image.pose_timestamp - 1e-6 * self.start)

    def scan(self, i):
        frame = self.frames[i]
        ranges, projections, _, top_pose = frame_utils.parse_range_image_and_camera_projection(frame)
        points, _ = frame_utils.convert_range_image_to_point_cloud(frame, ranges, projections, top_pose)
        points = moved(np.linalg.inv(self.vehicle_from_lidar), points[0])  # from TOP, compensated to the frame's pose
        pose = np.reshape(frame.pose.transform, (4, 4)) @ self.vehicle_from_lidar
        return dvi.ScanData(points, 1e-6 * (frame.timestamp_micros - self.start), world_from_lidar=pose)


if __name__ == "__main__":
    for frame in dvi.run(Waymo(sys.argv[1]), out=sys.argv[2]):
        print(frame.name)
