"""Writes any dataset in the plain layout that the program reads (docs/formats.md)."""
from __future__ import annotations

import json
import shutil
from pathlib import Path
from typing import Any, Callable, Optional, Sequence

import numpy as np

from ._dvi import InputError, write_gray, write_rgb
from .dataset import AnyPath, Array, Camera, Dataset

Progress = Optional[Callable[[str, int, int], None]]

# The numbers of coefficients that the distortion of a camera model has; none is always possible.
_COEFFICIENTS: dict[str, tuple[int, ...]] = {"pinhole": (4, 5, 8), "fisheye": (4,), "unified": (4,), "equirectangular": (),
                                             "cylindrical": ()}


def _ask(place: str, question: Callable[[], Any]) -> Any:
    """Returns the answer of a dataset; its errors are reported with the place."""
    try:
        return question()
    except (KeyboardInterrupt, InputError):
        raise
    except Exception as error:
        raise InputError(f"{place} raised {type(error).__name__}: {error}") from error


def _array(place: str, value: Any, shape: Sequence[Optional[int]], what: str, kinds: str = "fiu") -> Array:
    array = np.asarray(value)
    fits = len(array.shape) == len(shape) and all(want is None or want == have for want, have in zip(shape, array.shape))
    if not fits or array.dtype.kind not in kinds:
        have = " x ".join(map(str, array.shape)) or "a single value"
        raise InputError(f"{place} is {have} of {array.dtype}; it must be {what}")
    return array


def _finite(place: str, array: Array) -> Array:
    if not np.isfinite(array).all():
        raise InputError(f"{place} holds values that are not finite")
    return array


def _number(place: str, value: Any) -> float:
    try:
        number = float(value)
    except (TypeError, ValueError):
        raise InputError(f"{place} is {value!r}; it must be a number of seconds") from None
    if not np.isfinite(number):
        raise InputError(f"{place} is {number}; it must be finite")
    return number


def _motion(place: str, value: Any) -> Array:
    array = np.asarray(value)
    if array.shape not in ((3, 4), (4, 4)) or array.dtype.kind not in "fiu":
        raise InputError(f"{place} has the shape {array.shape}; it must be 3 x 4 or 4 x 4")
    matrix = _finite(place, array.astype(float))[:3]
    if np.abs(matrix[:, :3] @ matrix[:, :3].T - np.eye(3)).max() > 1e-3 or np.linalg.det(matrix[:, :3]) < 0:
        raise InputError(f"{place} holds no rotation in its first three columns")
    return matrix


def _quaternion(R: Array) -> Array:
    """x, y, z, w of a rotation, by the largest eigenvector of Bar-Itzhack's matrix."""
    (a, b, c), (d, e, f), (g, h, i) = R
    K = np.array([[a - e - i, b + d, c + g, h - f], [b + d, e - a - i, f + h, c - g],
                  [c + g, f + h, i - a - e, d - b], [h - f, c - g, d - b, a + e + i]]) / 3
    vectors: Array = np.linalg.eigh(K)[1]
    return vectors[:, -1]


def _toml_array(values: Any) -> str:
    return "[" + ", ".join(repr(float(v)) for v in np.asarray(values, float).ravel()) + "]"


class _Writer:
    def __init__(self, dataset: Dataset, folder: Path):
        self.dataset, self.folder = dataset, folder
        self.cameras = [self._camera(i, c) for i, c in enumerate(_ask("dataset.cameras", lambda: list(dataset.cameras)))]
        if not self.cameras:
            raise InputError("dataset.cameras is empty; it must have at least one dvi.Camera")
        names = [c.name for c in self.cameras]
        if len(set(names)) < len(names):
            raise InputError(f"dataset.cameras has two cameras of one name: {', '.join(names)}")
        self.length = _ask("len(dataset)", lambda: len(dataset))
        if self.length < 1:
            raise InputError("len(dataset) is 0; it must have frames")
        self.times: dict[str, list[str]] = {name: [] for name in names}
        self.scan_times: list[str] = []
        self.starts: list[float] = []
        self.poses: list[str] = []
        self.boxes: dict[str, list[dict[str, Any]]] = {}
        self.has_t: Optional[bool] = None

    def _camera(self, i: int, camera: Any) -> Camera:
        place = f"dataset.cameras[{i}]"
        for name in ("name", "size", "K", "camera_from_lidar"):
            if not hasattr(camera, name):
                raise InputError(f"{place} has no {name}; it must be like dvi.Camera")
        if not isinstance(camera.name, str) or not camera.name or set(camera.name) & set('/\\"\n') or camera.name.startswith("."):
            raise InputError(f"{place}.name is {camera.name!r}; it must be a name of a folder")
        width, height = _array(f"{place}.size", camera.size, (2,), "width and height", "iu")
        K = _finite(f"{place}.K", _array(f"{place}.K", camera.K, (3, 3), "3 x 3 numbers").astype(float))
        pose = _motion(f"{place}.camera_from_lidar", camera.camera_from_lidar)
        return Camera(camera.name, (int(width), int(height)), K, pose, *self._lens(place, camera))

    def _lens(self, place: str, camera: Any) -> tuple[Sequence[float], str, float]:
        model = getattr(camera, "model", "pinhole")
        if model not in _COEFFICIENTS:
            raise InputError(f"{place}.model is {model!r}; it must be one of {', '.join(_COEFFICIENTS)}")
        distortion = np.asarray(getattr(camera, "distortion", ()))
        if distortion.ndim != 1 or len(distortion) not in (0, *_COEFFICIENTS[model]) or (len(distortion) and distortion.dtype.kind not in "fiu"):
            have = " x ".join(map(str, distortion.shape)) or "a single value"
            counts = " or ".join(map(str, _COEFFICIENTS[model])) or "no"
            raise InputError(f"{place}.distortion is {have} of {distortion.dtype}; it must be {counts} numbers for the model {model}")
        xi = float(getattr(camera, "xi", 0))
        return tuple(float(v) for v in _finite(f"{place}.distortion", distortion.astype(float))), model, xi

    def frame(self, i: int) -> None:
        place, name = f"dataset.frame({i})", f"{i:06d}"
        frame = self._item(place, lambda: self.dataset.frame(i), ("images", "time"))
        for camera in self.cameras:
            width, height = camera.size
            image = _ask(f"{place}.images['{camera.name}']", lambda: frame.images[camera.name])
            what = f"{height} x {width} x 3 of uint8, RGB, as the size of the camera says"
            image = _array(f"{place}.images['{camera.name}']", image, (height, width, 3), what, "u")
            if image.dtype != np.uint8:
                raise InputError(f"{place}.images['{camera.name}'] is of {image.dtype}; it must be {what}")
            write_rgb(str(self.folder / "images" / camera.name / f"{name}.png"), image)
            time = frame.time
            if hasattr(time, "keys"):
                time = _ask(f"{place}.time['{camera.name}']", lambda: frame.time[camera.name])
            self.times[camera.name].append(f"{name} {_number(f'{place}.time', time):.9f}\n")
            mask = (getattr(frame, "masks", None) or {}).get(camera.name)
            if mask is not None:
                mask = _array(f"{place}.masks['{camera.name}']", mask, (height, width), f"{height} x {width}", "biu")
                write_gray(str(self.folder / "masks" / camera.name / f"{name}.png"), ((mask != 0) * 255).astype(np.uint8))
        boxes = getattr(frame, "boxes", None)
        if boxes is not None:
            self.boxes[name] = [self._box(f"{place}.boxes[{k}]", box) for k, box in enumerate(boxes)]

    def _box(self, place: str, box: Any) -> dict[str, Any]:
        def three(part: str) -> list[float]:
            return [float(v) for v in _finite(f"{place}.{part}", _array(f"{place}.{part}", getattr(box, part), (3,), "3 numbers"))]

        entry: dict[str, Any] = _ask(place, lambda: {"track": int(box.track), "class": str(box.kind), "center": three("center"),
                                                     "size": three("size"), "yaw": _number(f"{place}.yaw", box.yaw)})
        return entry

    def _item(self, place: str, question: Callable[[], Any], fields: Sequence[str]) -> Any:
        item = _ask(f"{place} (len(dataset) is {self.length})", question)
        for field in fields:
            if not hasattr(item, field):
                raise InputError(f"{place} has no {field}; it returned {type(item).__name__}")
        return item

    def scan(self, i: int) -> None:
        place, name = f"dataset.scan({i})", f"{i:06d}"
        scan = self._item(place, lambda: self.dataset.scan(i), ("points", "time"))
        points = np.asarray(scan.points)
        if points.ndim != 2 or points.shape[1] not in (3, 4) or points.dtype.kind not in "fiu":
            raise InputError(f"{place}.points has the shape {points.shape} of {points.dtype}; it must be N x 3, or N x 4 with intensity")
        t, time = getattr(scan, "t", None), _number(f"{place}.time", scan.time)
        if self.has_t is None:
            self.has_t = t is not None
        if self.has_t != (t is not None):
            raise InputError(f"{place}.t is {'missing' if t is None else 'given'}, unlike that of the scans before")
        points = points.astype("<f4")
        columns = {"x": points[:, 0], "y": points[:, 1], "z": points[:, 2],
                   "intensity": points[:, 3] if points.shape[1] == 4 else np.zeros(len(points), "<f4")}
        start = time
        if t is not None:
            t = _array(f"{place}.t", t, (len(points),), f"{len(points)} seconds, one a point", "f").astype(float)
            _finite(f"{place}.t", t)
            first = float(t.min()) if len(t) else 0.0
            start, columns["t"] = time + first, (t - first).astype("<f4")
        table = np.zeros(len(points), [(field, "<f4") for field in columns])
        for field, values in columns.items():
            table[field] = values
        table = table[np.isfinite(points).all(axis=1)]
        if not len(table):
            raise InputError(f"{place}.points has no finite point")
        header = "ply\nformat binary_little_endian 1.0\nelement vertex %d\n" % len(table)
        header += "".join(f"property float {field}\n" for field in columns) + "end_header\n"
        (self.folder / "lidar" / f"{name}.ply").write_bytes(header.encode() + table.tobytes())
        self.scan_times.append(f"{name} {start:.9f}\n")
        self.starts.append(start)
        if getattr(scan, "world_from_lidar", None) is not None:
            pose = _motion(f"{place}.world_from_lidar", scan.world_from_lidar)
            numbers = [*pose[:, 3], *_quaternion(pose[:, :3])]
            self.poses.append(" ".join([f"{time:.9f}"] + [repr(float(v)) for v in numbers]) + "\n")

    def tables(self) -> None:
        if 0 < len(self.poses) < self.length:
            raise InputError(f"{len(self.poses)} of {self.length} scans have a world_from_lidar; give it for all or for none")
        if self.poses:
            (self.folder / "poses.txt").write_text("".join(self.poses))
        if self.boxes:
            (self.folder / "boxes.json").write_text(json.dumps({"version": 1, "frames": self.boxes}))
        (self.folder / "times").mkdir()
        for name, lines in self.times.items():
            (self.folder / "times" / f"{name}.txt").write_text("".join(lines))
        (self.folder / "times/lidar.txt").write_text("".join(self.scan_times))
        steps = np.diff(self.starts)
        if (steps <= 0).any():
            i = int(np.argmax(steps <= 0)) + 1
            raise InputError(f"dataset.scan({i}).time is not after that of the scan before")
        rate = 1 / float(np.median(steps)) if len(steps) else 10.0
        text = f'[drive]\nversion = 1\ncamera = "{self.cameras[0].name}"\n\n[lidar]\nrate = {rate!r}\n'
        text += 'stamp = "start"\n' if self.has_t else 'stamp = "middle"\nrotation = "none"\n'
        for camera in self.cameras:
            text += f'\n[camera."{camera.name}"]\nsize = [{camera.size[0]}, {camera.size[1]}]\nK = {_toml_array(camera.K)}\n'
            text += f"camera_from_lidar = {_toml_array(camera.camera_from_lidar)}\n"
            if len(camera.distortion):
                text += f"distortion = {_toml_array(camera.distortion)}\n"
            if camera.model != "pinhole" or len(camera.distortion) == 4:
                text += f'model = "{camera.model}"\n'
            if camera.model == "unified":
                text += f"xi = {camera.xi!r}\n"
        (self.folder / "dvi.toml").write_text(text)


def convert(dataset: Dataset, folder: AnyPath, progress: Progress = None) -> Path:
    """Writes a dataset into a new or empty folder in dvi's plain layout, all of it or nothing. Returns the folder.

    Each frame and scan is asked for once, in order, and one at a time is held. InputError names the place of what is wrong, such as
    ``dataset.frame(3).images['front'] is 8 x 6 x 3 of float64``.
    """
    folder = Path(folder)
    if folder.exists() and (not folder.is_dir() or any(folder.iterdir())):
        raise InputError(f"{folder}: is not empty; choose another folder")
    part = folder.parent / f".{folder.name}.part"
    shutil.rmtree(part, ignore_errors=True)
    try:
        (part / "lidar").mkdir(parents=True)
        writer = _Writer(dataset, part)
        for camera in writer.cameras:
            (part / "images" / camera.name).mkdir(parents=True)
            (part / "masks" / camera.name).mkdir(parents=True)
        for i in range(writer.length):
            writer.frame(i)
            writer.scan(i)
            if progress is not None:
                progress("convert", i + 1, writer.length)
        writer.tables()
        for camera in writer.cameras:
            masks = part / "masks" / camera.name
            if not any(masks.iterdir()):
                masks.rmdir()
        if not any((part / "masks").iterdir()):
            (part / "masks").rmdir()
        if folder.exists():
            folder.rmdir()
        part.rename(folder)
    finally:
        shutil.rmtree(part, ignore_errors=True)
    return folder
