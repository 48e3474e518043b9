#!/usr/bin/env python3
"""Tests the mutator and the classifier, with scripts instead of the program."""
import json
import os
import random
import shutil
import sqlite3
import struct
import sys
import tempfile
import unittest
import unittest.mock
from pathlib import Path

import apolloscape
import classify
import drives
import foreign
import fuzz
import kitti
import mutations
import png
import silent
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
            mask = png.Image(WIDTH, HEIGHT, png.GRAY, 8, bytes([255] * 50 + [0] * (WIDTH * HEIGHT - 50)))
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
        for color in png.CHANNELS.keys() - {png.PALETTE}:
            for depth in (8, 16):
                data = random.Random(1).randbytes(5 * 3 * png.CHANNELS[color] * depth // 8)
                image = png.Image(5, 3, color, depth, data)
                self.assertEqual(png.decode(png.encode(image)), image)

    def test_every_filter_is_undone(self):
        above = bytes([10, 20, 30])
        for kind, packed in ((0, (11, 22, 33)), (1, (11, 11, 11)), (2, (1, 2, 3)), (3, (6, 7, 7)), (4, (1, 2, 3))):
            rows = b"\0" + above + bytes([kind, *packed])
            self.assertEqual(png._unfilter(rows, 3, 2, 1), above + bytes([11, 22, 33]), kind)

    def test_damaged_files_are_not_decoded(self):
        data = png.encode(picture(1))
        for cut in range(0, len(data) - 16):
            self.assertIsNone(png.decode(data[:cut]))
        self.assertIsNone(png.decode(b"text"))

    def test_rgb_of_all_kinds(self):
        self.assertEqual(png.rgb(png.Image(1, 1, png.GRAY, 16, b"\x07\x01")), b"\7\7\7")
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
            if path.is_symlink() or not path.is_file():
                return os.readlink(path) if path.is_symlink() else path.is_dir()
            return path.read_bytes() if os.access(path, os.R_OK) else "no permission"  # root can read all
        return {os.fsencode(path.relative_to(drive)): content(path) for path in drive.rglob("*")}


class ForeignMutations(Temporary):
    """Tests each mutation with many seeds, so that each of its choices occurs."""

    def mutants(self, mutation, name, make=None, count=40):
        """Yields (description, drive) of a mutation of the file of this name, for many seeds."""
        for seed in range(count):
            drive = self.small_drive(f"{mutation.__name__}-{seed}")
            if make:
                make(drive)
            done = mutation(drive / name, random.Random(seed))
            if done is not None:
                yield done, drive
            shutil.rmtree(drive)

    def test_columns(self):
        sizes = {done: (drive / "lidar/000001.bin").stat().st_size for done, drive in
                 self.mutants(foreign.columns, "lidar/000001.bin") if "files" in done}
        self.assertEqual(sizes, {f"{size} bytes per point in 2 files": 50 * size for size in (12, 20, 24, 32)})

    def test_notations_keep_the_values(self):
        expected = "000000 1000.05\n000001 1000.15\n"
        for done, drive in self.mutants(foreign.notation, "times/lidar.txt"):
            text = (drive / "times/lidar.txt").read_text()
            self.assertNotEqual(text, expected)
            words = [line.replace(",", ".").split() for line in text.splitlines()]
            self.assertEqual([(name, float(time)) for name, time in words], [("000000", 1000.05), ("000001", 1000.15)], done)

    def test_units_of_times(self):
        mutants = {done: (drive / "times/lidar.txt").read_text() for done, drive in
                self.mutants(foreign.time_units, "times/lidar.txt", count=80)}
        self.assertEqual(mutants["times: nanoseconds"], "000000 1000050000000.00\n000001 1000150000000.00\n")
        self.assertEqual(mutants["times: from 0 to 1"], "000000 0\n000001 1\n")
        self.assertEqual(len(mutants), 7)

    def test_times_of_points(self):
        mutants = {}
        for done, drive in self.mutants(foreign.point_times, "lidar/000000.bin", count=80):
            header, _, rows = (drive / "lidar/000001.ply").read_bytes().partition(b"end_header\n")
            self.assertIn(b"element vertex 50\n", header)
            *point, mutants[done] = struct.unpack_from("<4fd", rows)
            self.assertEqual(point, [1, 2, 3, 0.5])
        self.assertEqual(len(mutants), 10)
        seconds = mutants["point times: seconds"]
        self.assertAlmostEqual(mutants["point times: microseconds"], seconds * 1e6)
        self.assertAlmostEqual(mutants["point times: absolute"], seconds + 1000)

    def test_unpadded_names(self):
        def third_frame(drive):
            for name in ("images/front/000002.png", "masks/front/000002.png", "lidar/000002.bin"):
                shutil.copy(drive / name.replace("2.", "1."), drive / name)
        mutants = {}
        for done, drive in self.mutants(foreign.unpadded, "lidar/000000.bin", third_frame):
            names = (drive / "poses.txt").read_text().split()[::13]
            mutants[done] = {str(path.relative_to(drive)) for path in drive.rglob("*.*")} | set(names)
        whole, folder = mutants["names from 8 without zeros in the whole drive"], mutants["names from 98 without zeros"]
        self.assertLessEqual({"lidar/8.bin", "lidar/10.bin", "masks/front/9.png", "images/front/10.png", "8", "9"}, whole)
        self.assertLessEqual({"lidar/98.bin", "lidar/100.bin", "images/front/000000.png", "000000"}, folder)

    def test_exif_is_valid(self):
        path = self.folder / "a.jpg"
        for seed in range(10):
            path.write_bytes(png.blocky_jpeg(picture(9)))
            done, data = foreign.exif(path, random.Random(seed)), path.read_bytes()
            size, name = struct.unpack_from(">H6s", data, 4)
            self.assertEqual((data[2:4], name, data[4 + size:6 + size]), (b"\xff\xe1", b"Exif\0\0", b"\xff\xdb"))
            order = "<" if data[12:14] == b"II" else ">"
            tag, kind, count, value = struct.unpack_from(order + "HHIH", data, 22)
            self.assertEqual((tag, kind, count), (0x112, 3, 1))
            self.assertEqual(done, f"Exif orientation {value}")

    def test_rotation_of_a_video(self):
        path = self.folder / "a.mp4"
        for version, times in ((0, 20), (1, 32)):
            path.write_bytes(b"\0\0\0\x5ctkhd" + bytes([version]) + bytes(3 + times + 16) + b"\xff" * 36 + b"size")
            foreign.rotated_video(path, random.Random(1))
            matrix = struct.unpack_from(">9i", path.read_bytes(), 8 + 4 + times + 16)
            self.assertEqual([abs(value) >> 16 for value in matrix[0:2] + matrix[3:5]].count(1), 2)
            self.assertEqual((matrix[8], path.read_bytes()[-4:]), (1 << 30, b"size"))

    def test_missing_parts_and_gaps(self):
        for done, drive in self.mutants(foreign.missing_part, "lidar/000000.bin"):
            self.assertEqual(len(list((drive / "lidar").iterdir())), 1, done)
        for done, drive in self.mutants(foreign.gap, "times/lidar.txt"):
            self.assertEqual((drive / "times/lidar.txt").read_text(), "000000 1000.05\n000001 1005.15\n")

    def test_clocks(self):
        times = {(drive / "times/lidar.txt").read_text().split()[1] for _, drive in
                 self.mutants(foreign.clock_offset, "times/lidar.txt")}
        self.assertEqual(times, {"1037.05", "982.05", "1001.05"})
        path = self.folder / "timestamps.txt"
        path.write_text(kitti.stamps(2, 0))
        foreign.shift_dates(path, 55)
        self.assertEqual(path.read_text().splitlines()[0], "2011-09-26 13:01:05.050000000")
        drives.bag_in_parts(self.folder / "bag")
        done = foreign.clock_offset(self.folder / "bag/drive_0.db3", random.Random(1))
        self.assertRegex(done, "the clock of /.* off by")

    def test_far_poses(self):
        mutants = {done.split(": ")[1]: (drive / "poses.txt").read_text() for done, drive in
                self.mutants(foreign.far_pose, "poses.txt", count=12)}
        self.assertIn(" 1000000\n", mutants["far"])
        self.assertIn(" nan\n", mutants["NaN"])
        self.assertGreater(len(mutants["long"]), 4000000)

    def test_labels_of_other_frames(self):
        for done, drive in self.mutants(foreign.label_numbers, "boxes.json"):
            shift = int(done.split()[1])
            self.assertEqual(list(json.loads((drive / "boxes.json").read_text())["frames"]), [f"{shift:06d}", f"{shift + 1:06d}"])
        for done, drive in self.mutants(foreign.plain_masks, "masks/front/000000.png"):
            values = {value for path in (drive / "masks/front").iterdir() for value in png.decode(path.read_bytes()).data}
            self.assertEqual(done, f"all pixels of 2 masks are {values.pop()}")
            self.assertFalse(values)

    def test_endings_and_encodings(self):
        for _, drive in self.mutants(foreign.upper_case, "lidar/000000.bin", count=5):
            self.assertTrue((drive / "lidar/000000.BIN").exists())
        for _, drive in self.mutants(foreign.byte_order_mark, "poses.txt", count=5):
            self.assertIn((drive / "poses.txt").read_bytes()[:2], (b"\xef\xbb", b"\xff\xfe", b"\xfe\xff"))

    def test_a_drive_is_chosen_to_which_the_mutation_applies(self):
        layouts = unittest.mock.Mock(drives={"bag": drives.Layout(self.folder / "bag", "", []),
                                             "folder": drives.Layout(self.small_drive(), "", [])})
        drives.bag_in_parts(self.folder / "bag")
        for seed in range(5):
            root = self.folder / f"root-{seed}"
            layout, path, _ = fuzz.changed_drive(layouts, random.Random(seed), foreign.columns, root)
            self.assertEqual((layout, path.parent), ("folder", root / "lidar"))


class Silence(Temporary):
    """Tests the detection of wrong results without a warning."""

    def result(self, value, frames=2, warnings=()):
        out = Path(tempfile.mkdtemp(dir=self.folder))
        (out / "frames").mkdir()
        for i in range(frames):
            (out / f"frames/{i:06d}.png").write_bytes(png.encode(picture(value)))
        (out / "report.json").write_text(json.dumps({"warnings": list(warnings)}))
        return out

    def test_quality_frames_and_warnings(self):
        mask = bytes([255] * 50 + [0] * (WIDTH * HEIGHT - 50))
        truths = [png.rgb(picture(100))] * 2
        quality = silent.psnr(silent.pictures(self.result(90) / "frames"), [mask] * 2, truths)
        self.assertAlmostEqual(quality, 32.9, places=1)  # a third of the samples is off by 10
        expected = silent.Reference([mask] * 2, truths, quality, {"drive: # frames have no scan"})
        self.assertEqual(silent.findings(self.result(90), expected), [])
        self.assertEqual(silent.findings(self.result(80), expected), ["silent: 26.9 dB without a warning, 32.9 dB undamaged"])
        known = ["drive: 2 frames have no scan", "align: no two frames show the same map points"]
        self.assertEqual(len(silent.findings(self.result(80, warnings=known), expected)), 1)
        self.assertEqual(silent.findings(self.result(80, warnings=["drive: the clocks differ"]), expected), [])
        self.assertEqual(silent.findings(self.result(90, frames=1), expected), ["silent: 1 of 2 frames without a warning"])


class Layouts(Temporary):
    def test_a_bag_in_parts(self):
        drives.bag_in_parts(self.folder / "bag")
        counts = []
        for part in (0, 1):
            with sqlite3.connect(self.folder / f"bag/drive_{part}.db3") as bag:
                counts.append(bag.execute("SELECT COUNT(*), MAX(timestamp) FROM messages").fetchone())
            bag.close()
        self.assertEqual(sum(count for count, _ in counts), 21)
        self.assertLess(counts[0][1], counts[1][1])
        self.assertGreater(min(count for count, _ in counts), 5)

    def test_masks_of_static_surfaces(self):
        drive = self.small_drive()
        with unittest.mock.patch.object(drives, "STATIC_MASK_PX", (2, 5, 4, 3)):
            drives.mask_static_surfaces(drive)
        mask = png.decode((drive / "masks/front/000001.png").read_bytes())
        self.assertEqual([mask.data[6 * WIDTH + x] for x in (17, 18, 21, 22)], [0, 255, 255, 0])
        self.assertEqual(sum(mask.data), 255 * (50 + 12))


    def test_kitti(self):
        source = self.small_drive()
        drive = kitti.convert(source, self.folder / "kitti", drives.calibration_of(source), drives.poses_of(source), "tracklets")
        self.assertTrue((drive / "image_02/data/0000000001.png").exists())
        self.assertIn("<first_frame>1</first_frame>", (drive / "tracklet_labels.xml").read_text())
        latitude, longitude = (drive / "oxts/data/0000000001.txt").read_text().split()[:2]
        self.assertAlmostEqual(float(latitude), kitti.LATITUDE)
        self.assertAlmostEqual(float(longitude) * 111319.49 * 0.6560590, 1, places=3)  # a meter east

    def test_apolloscape(self):
        source = self.small_drive()
        drive = apolloscape.convert(source, self.folder / "a", drives.calibration_of(source), drives.poses_of(source))
        self.assertEqual(len(list(drive.glob("image/*.jpg"))), 2)
        text = (drive / "lidar_bg/bg_1534313591.250000.pcd.ply").read_text()
        self.assertIn("end_header\n2 -1 3 0.5\n", text)  # x left, y back, z up


class Judgment(Temporary):
    """Tests programs whose `run` copies the drive's images to OUT, or fails in several ways."""
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
        self.expect("cannot be decoded", self.COPY + ": > $4/masks/000001.png\n")
        self.expect("a result is left", 'mkdir -p "$4"; echo "dvi: $2: bad" >&2; exit 3')
        late = 'if [ $1 = run ]; then mkdir -p $4/.dvi/stages $4/frames; : > $4/.dvi/stages/poses.bin; fi\n'
        refused = 'echo "dvi: $2/poses.txt: bad" >&2; exit 3'
        self.assertEqual(self.findings(late + refused), (3, []))  # stages are cached
        self.expect("a result is left", late + ": > $4/frames/000000.png\n" + refused)

    def test_writes_outside(self):
        self.expect("the drive was changed", self.COPY + "echo >> $2/poses.txt\n")
        self.expect("outside of the result", self.COPY + "touch $2/../elsewhere\n")


if __name__ == "__main__":
    unittest.main()
