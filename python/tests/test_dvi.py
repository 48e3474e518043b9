"""The package on small synthetic drives that the program makes."""
import gc
import json
import os
import re
import shutil
import subprocess
import sys
import time

import numpy as np
import pytest

import dvi

PROGRAM = os.environ.get("DVI_PROGRAM", "dvi")


def read_png(path):
    cv2 = pytest.importorskip("cv2")
    picture = cv2.imread(str(path), cv2.IMREAD_UNCHANGED)
    return picture[:, :, ::-1] if picture.ndim == 3 else picture


@pytest.fixture(scope="session")
def street(tmp_path_factory):
    drive = tmp_path_factory.mktemp("drives") / "street"
    subprocess.run([PROGRAM, "synth", "-o", drive, "--frames", "5", "--width", "160", "--height", "96", "--beams", "24", "--columns",
                    "500", "--quiet"], check=True, capture_output=True)
    return drive


@pytest.fixture(scope="session")
def result(street, tmp_path_factory):
    """By the program itself."""
    out = tmp_path_factory.mktemp("results") / "out"
    subprocess.run([PROGRAM, "run", street, "-o", out, "--quiet"], check=True, capture_output=True)
    return out


def table(path):
    return dict(line.split() for line in path.read_text().splitlines())


class Street:
    """The synthetic street as an object, read by code of its own."""

    def __init__(self, drive):
        cv2 = pytest.importorskip("cv2")
        tomllib = pytest.importorskip("tomllib")
        self.drive, self.cv2 = drive, cv2
        settings = tomllib.loads((drive / "dvi.toml").read_text())
        self.name, camera = next(iter(settings["camera"].items()))
        pose = np.reshape(camera["camera_from_lidar"], (3, 4))
        self.cameras = [dvi.Camera(self.name, tuple(camera["size"]), np.reshape(camera["K"], (3, 3)), pose)]
        self.times = table(drive / f"times/{self.name}.txt")
        self.scan_times = table(drive / "times/lidar.txt")
        self.names = sorted(path.stem for path in (drive / "images" / self.name).iterdir())

    def __len__(self):
        return len(self.names)

    def frame(self, i):
        name = self.names[i]
        image = np.ascontiguousarray(self.cv2.imread(str(self.drive / f"images/{self.name}/{name}.png"))[:, :, ::-1])
        mask = self.cv2.imread(str(self.drive / f"masks/{self.name}/{name}.png"), 0)
        return dvi.FrameData({self.name: image}, float(self.times[name]), {self.name: mask})

    def scan(self, i):
        name = self.names[i]
        points = np.fromfile(self.drive / f"lidar/{name}.bin", "<f4").reshape(-1, 4)
        fraction = 0.5 * (1 - np.arctan2(points[:, 1], points[:, 0]) / np.pi)  # clockwise from behind, 10 per second
        return dvi.ScanData(points, float(self.scan_times[name]), 0.1 * (fraction - 0.5))


@pytest.mark.parametrize("threads", [1, 2])
def test_several_cameras_are_returned_in_turn(tmp_path, threads):
    drive = tmp_path / "drive"
    subprocess.run([PROGRAM, "synth", "-o", drive, "--frames", "3", "--width", "160", "--height", "96", "--beams", "24", "--columns",
                    "500", "--stereo-m", "0.5", "--side-cameras", "--quiet"], check=True, capture_output=True)
    run = dvi.run(drive, camera="all", out=tmp_path / "out", threads=threads)
    pairs = [(camera, frame.camera, frame.name) for camera, frame in run]
    cameras = ["front", "right", "side-left", "side-right"]
    assert pairs == [(camera, camera, f"{i:06}") for i in range(3) for camera in cameras]
    assert run.report["cameras"] == cameras
    again = [(camera, frame.camera, frame.name) for camera, frame in dvi.run(drive, camera="all", out=tmp_path / "out")]
    assert again == pairs


def test_frames_are_those_of_the_program(street, result, tmp_path):
    stages = []
    frames = list(dvi.run(street, out=tmp_path / "out", progress=lambda stage, done, total: stages.append(stage)))
    assert [frame.name for frame in frames] == sorted(path.stem for path in (result / "frames").iterdir())
    assert stages
    for frame in frames:
        assert frame.image.shape == (96, 160, 3) and frame.image.dtype == np.uint8
        assert frame.depth.dtype == np.float32 and frame.provenance.dtype == np.uint16
        for kind in ("image", "mask", "kind", "confidence", "provenance"):
            file = {"image": "frames", "mask": "masks"}.get(kind, kind)
            assert (tmp_path / "out" / file / f"{frame.name}.png").read_bytes() == (result / file / f"{frame.name}.png").read_bytes()
            assert np.array_equal(getattr(frame, kind), read_png(result / file / f"{frame.name}.png")), kind
        written = read_png(result / "depth" / f"{frame.name}.png") / 256
        assert np.abs(written - np.minimum(frame.depth, 65535 / 256)).max() <= 1 / 256


def test_a_finished_result_is_read_and_not_made_again(street, tmp_path):
    first = list(dvi.run(street, out=tmp_path / "out"))
    begun = time.monotonic()
    run = dvi.run(street, out=tmp_path / "out")
    again = list(run)
    assert len(run.report["frames"]) == len(first) == len(again)
    for a, b in zip(first, again):
        assert a.name == b.name and np.array_equal(a.image, b.image) and np.array_equal(a.kind, b.kind)
    (tmp_path / "out/frames" / f"{first[2].name}.png").unlink()
    some = list(dvi.run(street, out=tmp_path / "out"))
    assert [f.name for f in some] == [f.name for f in first] and np.array_equal(some[2].image, first[2].image)
    assert time.monotonic() - begun < 60


def test_arrays_outlive_their_frame_and_are_not_copied(street):
    with dvi.run(street, method="telea") as run:
        frame = next(run)
        image, again = frame.image, frame.image
        assert image.ctypes.data == again.ctypes.data and not image.flags.owndata
        before = image.copy()
        del frame
    gc.collect()
    assert np.array_equal(image, before)


def test_a_run_is_closed_while_a_frame_waits(street, tmp_path):
    with dvi.run(street, method="telea", out=tmp_path / "out", threads=1) as run:
        assert next(run).name == "000000"
        # With one thread and one camera two frames wait for their turn, and the next for a place.
        written, until = tmp_path / "out/frames/000003.png", time.monotonic() + 60
        while not written.exists() and time.monotonic() < until:
            time.sleep(0.01)
        assert written.exists()
        time.sleep(0.2)
    with pytest.raises(StopIteration):
        next(run)


def test_an_object_gives_the_frames_of_the_folder(street, result):
    frames = list(dvi.run(Street(street)))
    assert len(frames) == 5
    for i, frame in enumerate(frames):
        expected = read_png(sorted((result / "frames").iterdir())[i])
        # Poses are estimated here and given there; pixels that were not removed are those of the input.
        assert np.array_equal(frame.image[frame.mask == 0], expected[frame.mask == 0])
        assert np.array_equal(frame.kind == 0, frame.mask == 0)


def test_the_other_commands(street, result, tmp_path):
    assert dvi.check(street)["frames"]["count"] == 5
    assert dvi.check(street, frames="1:3", out=tmp_path / "pictures")["frames"]["count"] == 3
    assert any((tmp_path / "pictures").iterdir())
    found = dvi.map(street, out=tmp_path / "map", trajectory="tum")
    assert (tmp_path / "map/trajectory.txt").exists()
    assert found.points.shape == found.colors.shape and len(found.points) > 1000
    assert found.world_from_camera.shape == (5, 4, 4) and found.times.shape == (5,)
    masks = dvi.masks(street, out=tmp_path / "masks")
    assert (masks.folder / "masks.json").exists() and masks.report["schema"] == "dvi-masks/1"
    scores = dvi.eval(result, street / "truth", external={"own": result / "frames"})
    assert scores["all"]["frames"] == 5 and "own" in str(scores)
    assert dvi.eval(result, street / "truth", masks=result / "masks")["all"] == scores["all"]
    assert dvi.export("ply", result, tmp_path / "ply")["counts"]["points"] > 1000
    assert dvi.export("labels", result, tmp_path / "labels")["counts"]["scans"] == 5
    assert dvi.export("folder", result, tmp_path / "clean", quality=90)["counts"]["cleaned images"] == 5
    assert dvi.eval(result, points=street / "truth_points")["points"]["all"]["sa"] > 0.99


def test_another_programs_fill_is_imported(street, result, tmp_path):
    out = tmp_path / "out"
    shutil.copytree(result, out)
    holes = dvi.export("holes", out, tmp_path / "holes", layout="pairs", grow_px=1)["counts"]
    dvi.run(street, method="telea", out=tmp_path / "telea").finish()
    assert dvi.import_fill(out, tmp_path / "telea/frames")["pixels"] == holes["pixels"] > 0
    assert json.loads((out / "report.json").read_text())["hole"]["imported"] == holes["pixels"]
    assert dvi.import_fill(out, undo=True)["pixels"] == 0
    assert (out / "video.mp4").read_bytes() == (result / "video.mp4").read_bytes()
    with pytest.raises(TypeError, match="either frames or undo"):
        dvi.import_fill(out)
    with pytest.raises(dvi.InputError, match="the frames of the result itself"):
        dvi.import_fill(out, out / "frames")


def test_errors_have_the_words_of_the_program(street, tmp_path):
    with pytest.raises(dvi.InputError, match="nowhere"):
        list(dvi.run(tmp_path / "nowhere"))
    with pytest.raises(dvi.UsageError, match="option job.method = 'fast': must be one of dvi, paper"):
        dvi.run(street, method="fast")
    with pytest.raises(dvi.UsageError, match="--masks none removes nothing"):
        list(dvi.run(street, masks=["none"]))
    with pytest.raises(dvi.UsageError, match="depth.nothing"):
        dvi.run(street, set={"depth.nothing": 1})
    with pytest.raises(TypeError, match=r"no option 'mask' \(did you mean 'masks'\?\)"):
        dvi.check(street, mask="labels")
    with pytest.raises(TypeError, match="no option 'color'"):
        dvi.export("ply", street, tmp_path / "ply", color="red")
    with pytest.raises(dvi.InputError, match="int is neither a path nor a dataset"):
        dvi.check(3)


def program(*arguments):
    return subprocess.run([PROGRAM, *arguments], check=True, capture_output=True, text=True).stdout


def short_forms():
    """Option, its flag, and its allowed values, of every option that has a short form."""
    rows = re.findall(r"^\| `(\S+)` \| `(--\S+)` \| [^|]* \| (.*) \|$", program("config", "dump", "--all", "--markdown"), re.M)
    return [(option, flag, re.sub(r".*\[(.*)\]$|.*", r"\1", doc).split(r" \| ")) for option, flag, doc in rows]


def test_every_short_form_is_a_keyword_with_the_same_effect():
    options = short_forms()
    assert {"job.masks", "job.topics", "harmonize.unobserved"} < {option for option, _, _ in options}
    for option, flag, allowed in options:
        value = allowed[-1] or ("1:2" if option == "job.frames" else "a=b")
        expected = program("config", "dump", "--all", flag, value)
        assert expected != program("config", "dump", "--all")
        assert dvi.config(all=True, **{option.split(".")[1]: value}) == expected, option
        assert dvi.config(all=True, set={option: value}) == expected, option
    topics = program("config", "dump", "--topic", "image=/a", "--topic", "points=/b")
    assert dvi.config(topics=["image=/a", "points=/b"]) == dvi.config(set={"job.topics": ("image=/a", "points=/b")}) == topics
    assert dvi.config(masks=None) == program("config", "dump")


def test_a_run_records_the_options_of_the_program(street, tmp_path):
    program("run", street, "-o", tmp_path / "a", "--quiet", "--method", "telea", "--frames", "1:2", "--unobserved", "leave", "--set",
            "video.crf=20")
    dvi.run(street, out=tmp_path / "b", method="telea", frames="1:2", unobserved="leave", set={"video.crf": 20}).finish()
    recorded = (tmp_path / "a/dvi.toml").read_text().replace(str(tmp_path / "a"), str(tmp_path / "b"))
    assert (tmp_path / "b/dvi.toml").read_text() == recorded
    dvi.run(street, out=tmp_path / "c", config=tmp_path / "a/dvi.toml").finish()
    assert (tmp_path / "c/dvi.toml").read_text() == recorded.replace(str(tmp_path / "b"), str(tmp_path / "c"))


def broken(street, where, **fields):
    class Broken(Street):
        pass

    def answer(self, i):
        item = getattr(Street, where)(self, i)
        for name, value in fields.items():
            setattr(item, name, value(item) if i == 3 else getattr(item, name))
        return item

    setattr(Broken, where, answer)
    return Broken(street)


@pytest.mark.parametrize("where, fields, words", [
    ("frame", {"images": lambda f: {k: v / 255 for k, v in f.images.items()}}, r"frame\(3\)\.images\['\w+'\] is 96 x 160 x 3 of float64"),
    ("frame", {"images": lambda f: {k: v[:, :, 0] for k, v in f.images.items()}}, r"frame\(3\)\.images\['\w+'\] is 96 x 160 of uint8"),
    ("frame", {"images": lambda f: {k: v[:90] for k, v in f.images.items()}}, r"it must be 96 x 160 x 3 of uint8, RGB"),
    ("frame", {"images": lambda f: {}}, r"frame\(3\)\.images\['\w+'\] raised KeyError"),
    ("frame", {"time": lambda f: float("nan")}, r"frame\(3\)\.time is nan"),
    ("frame", {"masks": lambda f: {k: v[:5] for k, v in f.masks.items()}}, r"frame\(3\)\.masks\['\w+'\] is 5 x 160"),
    ("scan", {"points": lambda s: s.points.T}, r"scan\(3\)\.points has the shape \(4, \d+\)"),
    ("scan", {"points": lambda s: s.points * np.nan}, r"scan\(3\)\.points has no finite point"),
    ("scan", {"t": lambda s: None}, r"scan\(3\)\.t is missing, unlike"),
    ("scan", {"t": lambda s: s.t[:7]}, r"scan\(3\)\.t is 7 of float"),
    ("scan", {"time": lambda s: 0.0}, r"scan\(3\)\.time is not after"),
    ("scan", {"world_from_lidar": lambda s: np.eye(4)}, r"1 of 5 scans have a world_from_lidar"),
])
def test_bad_datasets_are_refused_by_place(street, tmp_path, where, fields, words):
    with pytest.raises(dvi.InputError, match=words):
        dvi.convert(broken(street, where, **fields), tmp_path / "drive")
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("lens", ["fisheye", "unified", "panorama"])
def test_cameras_of_every_model_are_written(tmp_path, lens):
    tomllib = pytest.importorskip("tomllib")
    drive = tmp_path / "drive"
    subprocess.run([PROGRAM, "synth", "-o", drive, "--frames", "2", "--width", "160", "--height", "80", "--beams", "24", "--columns",
                    "500", "--lens", lens, "--quiet"], check=True, capture_output=True)
    street, recorded = Street(drive), tomllib.loads((drive / "dvi.toml").read_text())["camera"]["front"]
    street.cameras[0].model = recorded["model"]
    street.cameras[0].distortion = recorded.get("distortion", [])
    street.cameras[0].xi = recorded.get("xi", 0)
    written = tomllib.loads((dvi.convert(street, tmp_path / "copy") / "dvi.toml").read_text())["camera"]["front"]
    for key in ("model", "distortion", "xi"):
        assert written.get(key) == recorded.get(key), key
    assert dvi.check(street)["frames"]["count"] == 2


def test_lenses_that_do_not_exist(street, tmp_path):
    other = Street(street)
    other.cameras[0].model = "thin"
    with pytest.raises(dvi.InputError, match=r"cameras\[0\]\.model is 'thin'; it must be one of pinhole, fisheye"):
        dvi.convert(other, tmp_path / "drive")
    other.cameras[0].model, other.cameras[0].distortion = "fisheye", [0.1, 0.2]
    with pytest.raises(dvi.InputError, match=r"cameras\[0\]\.distortion is 2 of float64; it must be 4 numbers for the model fisheye"):
        dvi.convert(other, tmp_path / "drive")


def test_the_module_is_the_program(street, result, tmp_path):
    def call(*arguments):
        return subprocess.run([sys.executable, "-m", "dvi", *arguments], capture_output=True, text=True)

    assert call("version").stdout == subprocess.run([PROGRAM, "version"], capture_output=True, text=True).stdout
    refused = call("run", "nowhere", "-o", tmp_path / "out")
    assert refused.returncode == 3 and "nowhere: does not exist" in refused.stderr
    assert call("run", "--no-such-option").returncode == 2
    done = call("run", street, "-o", tmp_path / "out", "--quiet")
    assert done.returncode == 0, done.stderr
    for frame in sorted((result / "frames").iterdir()):
        assert (tmp_path / "out/frames" / frame.name).read_bytes() == frame.read_bytes()


def test_types_are_complete():
    pytest.importorskip("mypy")
    package = os.path.dirname(dvi.__file__)
    checked = subprocess.run([sys.executable, "-m", "mypy", "--strict", "--cache-dir", os.devnull, package], capture_output=True, text=True)
    assert checked.returncode == 0, checked.stdout + checked.stderr


def test_datasets_that_raise_or_lie_about_their_length(street, tmp_path):
    longer = Street(street)
    longer.__class__ = type("Longer", (Street,), {"__len__": lambda self: 6})
    with pytest.raises(dvi.InputError, match=r"frame\(5\) \(len\(dataset\) is 6\) raised IndexError"):
        dvi.convert(longer, tmp_path / "drive")
    empty = Street(street)
    empty.cameras = []
    with pytest.raises(dvi.InputError, match="cameras is empty"):
        dvi.convert(empty, tmp_path / "drive")
    empty.cameras = [dvi.Camera("front", (160, 96), np.eye(3), 2 * np.eye(4))]
    with pytest.raises(dvi.InputError, match=r"cameras\[0\]\.camera_from_lidar holds no rotation"):
        dvi.convert(empty, tmp_path / "drive")


def test_what_a_callback_raises_ends_the_work(street, tmp_path):
    def fail(stage, done, total):
        raise RuntimeError("enough")

    with pytest.raises(RuntimeError, match="enough"):
        dvi.run(street, out=tmp_path / "out", progress=fail).finish()


def test_ctrl_c_and_the_interpreter_goes_on_meanwhile(street, tmp_path):
    script = """if True:
        import os, signal, sys, threading, dvi
        ticks = []
        def tick():
            while not ticks or ticks[-1] < 5:
                ticks.append(len(ticks))
            os.kill(os.getpid(), signal.SIGINT)
        threading.Timer(0.3, tick).start()
        try:
            while True:
                for frame in dvi.run(sys.argv[1], threads=1, set={"stages.regularize": True}):
                    pass
        except KeyboardInterrupt:
            print("interrupted", len(ticks))
    """
    done = subprocess.run([sys.executable, "-c", script, str(street)], capture_output=True, text=True, timeout=60)
    assert done.stdout.startswith("interrupted 6"), done.stderr
