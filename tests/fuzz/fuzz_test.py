#!/usr/bin/env python3
"""Tests of the mutator and of the classifier, without the program: scripts take its place."""
import os
import random
import shutil
import struct
import sys
import tempfile
import unittest
import unittest.mock
from pathlib import Path

import apolloscape
import classify
import drives
import kitti
import mutations
import png
from program import Program

WIDTH, HEIGHT = 24, 16


def picture(value):
    return png.Image(WIDTH, HEIGHT, png.RGB, 8, bytes([value, 2, 3] * (WIDTH * HEIGHT)))


class Temporary(unittest.TestCase):
    def setUp(self):
        temporary = tempfile.TemporaryDirectory()
        self.addCleanup(temporary.cleanup)
        self.folder = Path(temporary.name)

    def small_drive(self, name="drive"):
        drive = self.folder / name
        for folder in ("images/front", "masks/front", "lidar", "times"):
            (drive / folder).mkdir(parents=True)
        for i in range(2):
            (drive / f"images/front/{i:06d}.png").write_bytes(png.encode(picture(i)))
            mask = png.Image(WIDTH, HEIGHT, png.GREY, 8, bytes([255] * 50 + [0] * (WIDTH * HEIGHT - 50)))
            (drive / f"masks/front/{i:06d}.png").write_bytes(png.encode(mask))
            (drive / f"lidar/{i:06d}.bin").write_bytes(struct.pack("<4f", 1, 2, 3, 0.5) * 50)
        (drive / "times/lidar.txt").write_text("000000 1000.05\n000001 1000.15\n")
        (drive / "poses.txt").write_text("".join(f"{i:06d} 1 0 0 {i} 0 1 0 0 0 0 1 0\n" for i in range(2)))
        (drive / "boxes.json").write_text(
            '{"version": 1, "frames": {"000000": [], "000001": [{"track": 0, "class": "car", "center": [12, 0, -1],'
            ' "size": [4, 2, 1.5], "yaw": 0}]}}')
        (drive / "dvi.toml").write_text(
            f"[camera.front]\nsize = [{WIDTH}, {HEIGHT}]\nK = [20.0, 0, 12.0, 0, 20.0, 8.0, 0, 0, 1]\n"
            "camera_from_lidar = [0, -1, 0, 0, 0, 0, -1, 0, 1, 0, 0, 0]\n")
        return drive

    def program(self, script, seconds=20):
        """Shell code in place of dvi: $1 is the command, $2 the drive, $4 OUT of `run`."""
        path = self.folder / "program.sh"
        path.write_text("#!/bin/sh\n" + script)
        path.chmod(0o755)
        return Program(path, seconds)


class Pictures(Temporary):
    def test_png_round_trip(self):
        for colour in png.CHANNELS.keys() - {png.PALETTE}:
            for depth in (8, 16):
                data = random.Random(1).randbytes(5 * 3 * png.CHANNELS[colour] * depth // 8)
                image = png.Image(5, 3, colour, depth, data)
                self.assertEqual(png.decode(png.encode(image)), image)

    def test_every_filter_is_undone(self):
        above = bytes([10, 20, 30])
        for kind, packed in ((0, (11, 22, 33)), (1, (11, 11, 11)), (2, (1, 2, 3)), (3, (6, 7, 7)), (4, (1, 2, 3))):
            rows = b"\0" + above + bytes([kind, *packed])
            self.assertEqual(png._unfilter(rows, 3, 2, 1), above + bytes([11, 22, 33]), kind)

    def test_damaged_files_are_no_pictures(self):
        data = png.encode(picture(1))
        for cut in range(0, len(data) - 16):
            self.assertIsNone(png.decode(data[:cut]))
        self.assertIsNone(png.decode(b"text"))

    def test_rgb_of_all_kinds(self):
        self.assertEqual(png.rgb(png.Image(1, 1, png.GREY, 16, b"\x07\x01")), b"\7\7\7")
        self.assertEqual(png.rgb(png.Image(1, 1, png.RGBA, 8, b"\1\2\3\4")), b"\1\2\3")

    def test_jpeg_has_its_markers(self):
        data = png.blocky_jpeg(picture(200))
        self.assertTrue(data.startswith(b"\xff\xd8") and data.endswith(b"\xff\xd9"))
        self.assertIn(struct.pack(">HH", HEIGHT, WIDTH), data)


class Mutations(Temporary):
    def test_a_seed_makes_the_same_mutant_again(self):
        for number, mutation in enumerate(mutations.ALL):
            if mutation in (mutations.bomb, mutations.sparse):
                continue
            made = []
            for attempt in range(2):
                drive = self.small_drive(f"{number}-{attempt}")
                path, done = mutations.mutate(drive, random.Random(number), mutation)
                made.append((path and path.relative_to(drive), done, self.bytes_of(drive)))
                shutil.rmtree(drive)
            self.assertEqual(made[0], made[1], mutation.__name__)

    def test_each_changes_the_drive(self):
        original = self.bytes_of(self.small_drive("original"))
        for mutation in mutations.ALL:
            if mutation in (mutations.bomb, mutations.sparse, mutations.no_permission, mutations.replace_word):
                continue
            for seed in range(3):
                drive = self.small_drive()
                path, done = mutations.mutate(drive, random.Random(seed), mutation)
                if path and "twice" not in done and "moved" not in done and "word" not in done:
                    self.assertNotEqual(self.bytes_of(drive), original, f"{mutation.__name__}: {path} {done}")
                shutil.rmtree(drive)

    def test_a_wrong_header_has_a_right_checksum(self):
        path = self.small_drive() / "images/front/000000.png"
        mutations.image_header(path, random.Random(3))
        data = path.read_bytes()
        self.assertEqual(png.chunk(b"IHDR", data[16:29]), data[8:33])

    def test_each_kind_of_file_is_reached(self):
        drive, kinds = self.small_drive(), set()
        for seed in range(60):
            copy = Path(shutil.copytree(drive, self.folder / "copy"))
            path, _ = mutations.mutate(copy, random.Random(seed), mutations.empty)
            kinds.add(mutations.kind_of(path, copy))
            shutil.rmtree(copy)
        self.assertEqual(kinds, {mutations.kind_of(p, drive) for p in drive.rglob("*") if p.is_file()})

    @staticmethod
    def bytes_of(drive):
        def content(path):
            return os.readlink(path) if path.is_symlink() else path.read_bytes() if path.is_file() else path.is_dir()
        return {os.fsencode(path.relative_to(drive)): content(path) for path in drive.rglob("*")}


class Layouts(Temporary):
    def test_kitti(self):
        source = self.small_drive()
        drive = kitti.convert(source, self.folder / "kitti", drives.calibration_of(source), drives.poses_of(source), "tracklets")
        self.assertTrue((drive / "image_02/data/0000000001.png").exists())
        self.assertIn("<first_frame>1</first_frame>", (drive / "tracklet_labels.xml").read_text())
        latitude, longitude = (drive / "oxts/data/0000000001.txt").read_text().split()[:2]
        self.assertAlmostEqual(float(latitude), kitti.LATITUDE)
        self.assertAlmostEqual(float(longitude) * 111319.49 * 0.6560590, 1, places=3)  # a metre east

    def test_apolloscape(self):
        source = self.small_drive()
        drive = apolloscape.convert(source, self.folder / "a", drives.calibration_of(source), drives.poses_of(source))
        self.assertEqual(len(list(drive.glob("image/*.jpg"))), 2)
        text = (drive / "lidar_bg/bg_1534313591.250000.pcd.ply").read_text()
        self.assertIn("end_header\n2 -1 3 0.5\n", text)  # x left, y back, z up


class Judgement(Temporary):
    """`run` of these programs copies the drive's pictures to OUT, or fails in a way of its own."""
    COPY = ('[ $1 = run ] || exit 0\nmkdir -p $4/frames $4/masks\ncp $2/images/front/* $4/frames\ncp $2/masks/front/* $4/masks\n')

    def findings(self, script, seconds=20):
        drive, out = self.small_drive("case/drive"), self.folder / "case/out"
        try:
            return classify.findings(self.program(script, seconds), drive, out, drive / "poses.txt")[:2]
        finally:
            shutil.rmtree(drive.parent)

    def test_right_answers(self):
        self.assertEqual(self.findings(self.COPY), (0, []))
        self.assertEqual(self.findings('echo "dvi: $2/poses.txt: is empty" >&2; exit 3'), (3, []))
        self.assertEqual(self.findings('echo "dvi: poses.txt: is empty" >&2; exit 3'), (3, []))

    def expect(self, words, script, seconds=20):
        found = self.findings(script, seconds)[1]
        self.assertTrue(any(words in finding for finding in found), f"{words} not in {found}")

    def test_wrong_endings(self):
        self.expect("check exits with 1", "exit 1")
        self.expect("run exits with 2", '[ $1 = check ] || exit 2')
        self.expect("ends by signal 11", "kill -SEGV $$")
        self.expect("hangs", "exec sleep 60", seconds=0.3)

    def test_too_much_memory(self):
        with unittest.mock.patch.object(classify, "MEMORY_BYTES", 200 << 20):
            self.expect("check takes", f"exec {sys.executable} -c 'x = b\"1\" * (250 << 20)'")

    def test_wrong_messages(self):
        self.expect("names no file", 'echo "dvi: something is wrong" >&2; exit 3')
        self.expect("does not begin", 'echo "libpng: $2 is bad" >&2; exit 3')
        self.expect("control characters", 'printf "dvi: $2: \\033[2J\\n" >&2; exit 3')
        self.expect("is long", 'printf "dvi: $2: %05000d\\n" 1 >&2; exit 3')

    def test_wrong_results(self):
        self.expect("audit exits with 3", self.COPY.replace("exit 0", "[ $1 = check ] || exit 3; exit 0"))
        self.expect("000000.png differs from its image", self.COPY + "cp $2/images/front/000001.png $4/frames/000000.png\n")
        self.expect("is no picture", self.COPY + ": > $4/masks/000001.png\n")
        self.expect("a result is left", 'mkdir -p "$4"; echo "dvi: $2: bad" >&2; exit 3')

    def test_writes_outside(self):
        self.expect("the drive was changed", self.COPY + "echo >> $2/poses.txt\n")
        self.expect("outside of the result", self.COPY + "touch $2/../elsewhere\n")


if __name__ == "__main__":
    unittest.main()
