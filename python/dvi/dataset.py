"""Defines the recordings that dvi reads: a path, or an object of your own that answers four questions.

Axes: camera x right, y down, z forward; LiDAR x forward, y left, z up. Meters, seconds. A transform is named target_from_source.
"""
from __future__ import annotations

import os
from dataclasses import dataclass, field
from typing import Any, Mapping, Optional, Protocol, Sequence, Union, runtime_checkable

import numpy.typing as npt

AnyPath = Union[str, "os.PathLike[str]"]
Array = npt.NDArray[Any]


@dataclass
class Camera:
    """A camera of the rig."""

    name: str
    size: tuple[int, int]  #: width, height in pixels
    K: Any  #: 3 x 3, pixels; the center of the first pixel is (0, 0)
    camera_from_lidar: Any  #: 3 x 4 or 4 x 4
    distortion: Sequence[float] = ()  #: of the model, as docs/formats.md lists them; of a pinhole k1, k2, p1, p2, k3 of OpenCV
    model: str = "pinhole"  #: or fisheye, unified, equirectangular, cylindrical
    xi: float = 0  #: of the unified model


@dataclass
class Box:
    """A labeled object, in LiDAR axes at the time of the frame."""

    track: int
    kind: str  #: car, pedestrian, ...
    center: Any  #: 3, meters
    size: Any  #: length, width, height, meters
    yaw: float  #: radians about z


@dataclass
class FrameData:
    """The images of the cameras at one time."""

    images: Mapping[str, Array]  #: by camera: height x width x 3, uint8, RGB
    time: Any  #: seconds, or a mapping from camera to seconds
    masks: Mapping[str, Array] = field(default_factory=dict)  #: by camera: height x width, not 0 = remove
    boxes: Optional[Sequence[Box]] = None  #: None: nothing is labeled; an empty list: nothing is there


@dataclass
class ScanData:
    """One revolution of the LiDAR."""

    points: Array  #: N x 3 or N x 4 (with intensity), any float; points that are not finite are left out
    time: float  #: seconds: what `t` and `world_from_lidar` refer to
    t: Optional[Array] = None  #: N, seconds after `time` (negative before); None: already compensated for motion to `time`
    world_from_lidar: Any = None  #: 3 x 4 or 4 x 4, at `time`; None: poses are estimated from the scans


@runtime_checkable
class Dataset(Protocol):
    """A recording as an object. Frames and scans go by the same numbers, from 0 to len - 1, and are asked for once, in order."""

    cameras: Sequence[Camera]

    def __len__(self) -> int: ...

    def frame(self, i: int) -> FrameData: ...

    def scan(self, i: int) -> ScanData: ...
