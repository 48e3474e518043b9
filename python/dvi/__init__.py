"""Removes traffic from recorded drives and fills the holes with pixels of other frames.

    for frame in dvi.run("DRIVE", out="OUT"):
        frame.image        # height x width x 3, uint8, RGB: the result
        frame.kind         # height x width, uint8: 0 original, 1 copied, 2 copied from elsewhere, 3 interpolated, 4, 5 made up

A dataset is a path to a recording that the program reads, or an object like `dvi.Dataset`. Options of the command line are keywords
(`--ego-mask` is ``ego_mask``, `--topic` is ``topics``, `--sources` is ``source_cameras``); ``config`` takes a TOML file, and ``set``
any option: ``set={"lidar.max_range_m": 80}``. ``print(dvi.config())`` lists the options with their meaning. ``progress`` is called as
``progress(stage, done, total)``. Ctrl-C stops the work. `dvi.InputError` and `dvi.UsageError` have the messages of the program.
"""
from __future__ import annotations

import json
import os
import tempfile
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Callable, Iterator, Mapping, Optional, Sequence, Union

import numpy as np

from . import _dvi
from ._dvi import Frame, InputError, UsageError
from .convert import convert
from .dataset import AnyPath, Array, Box, Camera, Dataset, FrameData, ScanData

InputError.__module__ = UsageError.__module__ = Frame.__module__ = __name__

__version__: str = _dvi.version
__all__ = ["Box", "Camera", "Dataset", "Frame", "FrameData", "InputError", "Map", "Masks", "Run", "ScanData", "UsageError", "check",
           "config", "convert", "eval", "export", "import_fill", "map", "masks", "run"]

Source = Union[AnyPath, Dataset]
Progress = Optional[Callable[[str, int, int], None]]


def _parse(document: str) -> dict[str, Any]:
    parsed: dict[str, Any] = json.loads(document)
    return parsed


class _Opened:
    """A dataset as a path; an object is written into a temporary folder first."""

    def __init__(self, dataset: Source, progress: Progress):
        self._folder: Optional[tempfile.TemporaryDirectory[str]] = None
        if isinstance(dataset, (str, os.PathLike)):
            self.path = os.fspath(dataset)
            return
        for name in ("__len__", "cameras", "frame", "scan"):
            if not hasattr(dataset, name):
                raise InputError(f"{type(dataset).__name__} is neither a path nor a dataset: it has no {name} (see dvi.Dataset)")
        self._folder = tempfile.TemporaryDirectory(prefix="dvi-")
        self.path = str(convert(dataset, Path(self._folder.name) / "drive", progress))

    def close(self) -> None:
        if self._folder is not None:
            self._folder.cleanup()

    def __enter__(self) -> str:
        return self.path

    def __exit__(self, *_: object) -> None:
        self.close()


class Run(Iterator[Any]):
    """The frames of a run in order of time, each as soon as it is made; pairs of a camera's name and a frame if several cameras are
    cleaned. Also a context manager: leaving it stops the work."""

    def __init__(self, dataset: Source, sources: Sequence[Source], out: Optional[AnyPath], force: bool, threads: int,
                 progress: Progress, options: Mapping[str, Any]):
        self._run: Optional[_dvi.Run] = None
        self._opened: list[_Opened] = []
        self._temporary: Optional[tempfile.TemporaryDirectory[str]] = None
        self.report: dict[str, Any] = {}  #: of the finished run, as report.json
        try:
            for source in (dataset, *sources):
                self._opened.append(_Opened(source, progress))
            if out is None:
                self._temporary = tempfile.TemporaryDirectory(prefix="dvi-out-")
                out = Path(self._temporary.name) / "out"
            paths = [opened.path for opened in self._opened]
            self._run = _dvi.Run(paths[0], paths[1:], os.fspath(out), dict(options), force, threads, progress)
        except BaseException:
            self.close()
            raise

    def __iter__(self) -> "Run":
        return self

    def __next__(self) -> "Frame | tuple[str, Frame]":
        if self._run is None:
            raise StopIteration
        try:
            frame = self._run.next()
        except BaseException:
            self.close()
            raise
        if frame is None:
            self._end(self._run)
            raise StopIteration
        return (frame.camera, frame) if frame.camera else frame

    def finish(self) -> dict[str, Any]:
        """Runs to the end without handing out the frames that are left. Returns the report."""
        if self._run is not None:
            try:
                self._run.finish()
            except BaseException:
                self.close()
                raise
            self._end(self._run)
        return self.report

    def _end(self, run: _dvi.Run) -> None:
        self.report = _parse(run.report)
        self.close()

    def close(self) -> None:
        """Stops the work, and removes temporary files. With `out`, finished frames are kept: the same call goes on from them."""
        if self._run is not None:
            self._run.close()
            self._run = None
        for opened in self._opened:
            opened.close()
        if self._temporary is not None:
            self._temporary.cleanup()

    def __enter__(self) -> "Run":
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def __del__(self) -> None:
        if hasattr(self, "_opened"):
            self.close()


def run(dataset: Source, *sources: Source, out: Optional[AnyPath] = None, force: bool = False, threads: int = 0,
        progress: Progress = None, **options: Any) -> Run:
    """Removes the traffic from a drive, frame by frame: `dvi run`.

    dataset: the drive to clean; sources: further drives of the same street to copy from. out: folder of the result with all its
    files; None: a temporary one. threads: 0 is all cores. Each `Frame` has numpy arrays, height x width, which share their memory
    with the program's (nothing is copied):

    image         x 3, uint8, RGB: the result; unmasked pixels are the input
    mask          uint8: 255 at removed pixels
    kind          uint8: 0 original, 1 copied, 2 copied from another drive or camera, 3 interpolated, 4 synthesized, 5 empty
    provenance    x 3, uint16: number of the source + 1 (0: none), 16 x and 16 y of the position copied from
    confidence    uint8: 255 times the probability of being within 10 gray levels of the truth
    depth         float32: meters along the optical axis, or from a camera that is not a pinhole camera; 0 unknown or sky

    With several cameras (camera="front,left" or "all"), pairs of a camera's name and a frame are returned.
    """
    return Run(dataset, sources, out, force, threads, progress, options)


def config(*, all: bool = False, **options: Any) -> str:
    """Returns the options with their values and meaning, as TOML: what `dvi config dump` prints. all: developer options, too."""
    return _dvi.config(options, all)


def check(dataset: Source, *, out: Optional[AnyPath] = None, coverage: bool = False, threads: int = 0,
          progress: Progress = None, **options: Any) -> dict[str, Any]:
    """Describes a drive, its errors, and its missing data, as `dvi check --json` does. out: folder for pictures."""
    with _Opened(dataset, progress) as path:
        return _parse(_dvi.check(path, "" if out is None else os.fspath(out), options, coverage, threads, progress))


@dataclass
class Map:
    """The static map of a drive, in world axes: the drive's first LiDAR pose, x forward, y left, z up."""

    points: Array  #: N x 3, float32, meters
    colors: Array  #: N x 3, uint8, RGB; 128, 128, 128 where no frame observed the point
    world_from_camera: Array  #: frames x 4 x 4
    times: Array  #: frames, seconds
    report: dict[str, Any]  #: as map.json


def map(dataset: Source, *, out: Optional[AnyPath] = None, trajectory: str = "none", threads: int = 0,
        progress: Progress = None, **options: Any) -> Map:
    """Poses and static map of a drive: `dvi map`. out: folder for its files; None: they are not kept. trajectory: kitti or tum
    also writes trajectory.txt."""
    with tempfile.TemporaryDirectory(prefix="dvi-map-") as temporary, _Opened(dataset, progress) as path:
        folder = Path(temporary) / "map" if out is None else Path(out)
        report = _parse(_dvi.map(path, str(folder), trajectory, options, threads, progress))
        points, colors = _dvi.read_map(str(folder / "map.ply"))
        rows = np.loadtxt(folder / "poses.txt", ndmin=2).reshape(-1, 3, 4)
        poses = np.concatenate([rows, np.broadcast_to([[[0.0, 0, 0, 1]]], (len(rows), 1, 4))], axis=1)
        return Map(points, colors, poses, np.loadtxt(folder / "times.txt", ndmin=1), report)


@dataclass
class Masks:
    """What would be removed from a drive."""

    folder: Optional[Path]  #: with masks/CAMERA/NAME.png, which ``masks=`` takes back; None if not kept
    report: dict[str, Any]  #: as masks.json


def masks(dataset: Source, *, out: Optional[AnyPath] = None, threads: int = 0, progress: Progress = None,
          **options: Any) -> Masks:
    """Determines the objects that a run would remove: `dvi mask`. out: a new folder for the masks; None: only the report is kept."""
    with tempfile.TemporaryDirectory(prefix="dvi-masks-") as temporary, _Opened(dataset, progress) as path:
        folder = Path(temporary) / "masks" if out is None else Path(out)
        report = _parse(_dvi.masks(path, str(folder), options, threads, progress))
        return Masks(None if out is None else folder, report)


def eval(out: AnyPath, truth: Optional[AnyPath] = None, *, ignore: Optional[AnyPath] = None,
         masks: Optional[AnyPath] = None, labels: Optional[AnyPath] = None,
         points: Optional[AnyPath] = None,
         external: Mapping[str, AnyPath] = {}, threads: int = 0, progress: Progress = None) -> dict[str, Any]:
    """Scores a result: what `dvi eval --json` prints. truth: folder of NAME.png; None: only artifacts and ghosts are counted;
    ignore: of masks not to score; masks: of masks to score instead of the masks of the result; labels: file of labels with 3D boxes
    and tracks, for ghosts; points: folder of true labels of the scans' points, NAME.label; external: folders of other programs'
    frames, by the name of the program."""
    others = [f"{name}={os.fspath(folder)}" for name, folder in external.items()]
    names = ["" if path is None else os.fspath(path) for path in (truth, ignore, masks, labels, points)]
    return _parse(_dvi.evaluate(os.fspath(out), names[0], names[1], names[2], names[3], names[4], others, threads, progress))


def export(format: str, out: AnyPath, folder: AnyPath, *, threads: int = 0, progress: Progress = None,
           **options: Any) -> dict[str, Any]:
    """Writes a result for other tools: what `dvi export --json` prints. format: colmap, nerfstudio, ply, las, ortho, mcap, video, holes,
    labels (of the points of the scans), bag or folder (the recording with clean images; a bag of one file is exported to a file)."""
    return _parse(_dvi.export(format, os.fspath(out), os.fspath(folder), options, threads, progress))


def import_fill(out: AnyPath, frames: Optional[AnyPath] = None, *, undo: bool = False, threads: int = 0,
                progress: Progress = None) -> dict[str, Any]:
    """Fills the unobserved pixels of a result from another program's images: what `dvi import-fill --json` prints. frames: the folder
    of the images, one per frame. undo: restores the frames of the run instead."""
    if undo == (frames is not None):
        raise TypeError("import_fill() takes either frames or undo=True")
    return _parse(_dvi.import_fill(os.fspath(out), "" if frames is None else os.fspath(frames), threads, progress))
