"""Converts a drive of the `folder` layout to `kitti-raw`."""
import json
import math
import shutil

EARTH_RADIUS = 6378137
LATITUDE = 49.0


def numbers(values):
    return " ".join(f"{v:.12g}" for v in values)


def stamps(count, shift):
    return "".join(f"2011-09-26 13:00:{10.05 + 0.1 * i + shift:012.9f}\n" for i in range(count))


def oxts(pose):
    """A packet at a pose of 12 numbers: the development kit's Mercator projection, inverted."""
    scale = math.cos(math.radians(LATITUDE))
    origin = math.log(math.tan(math.radians(90 + LATITUDE) / 2))
    longitude = math.degrees(pose[3] / (scale * EARTH_RADIUS))
    latitude = math.degrees(2 * math.atan(math.exp(origin + pose[7] / (scale * EARTH_RADIUS)))) - 90
    yaw, pitch, roll = math.atan2(pose[4], pose[0]), math.asin(-pose[8]), math.atan2(pose[9], pose[10])
    return f"{latitude:.12f} {longitude:.12f} {numbers([pose[11], roll, pitch, yaw, 8, 0, 8])}\n"


def tracklets(frames):
    """The labels of boxes.json as tracklet_labels.xml."""
    by_track = {}
    for index, name in enumerate(sorted(frames)):
        for box in frames[name]:
            by_track.setdefault(box["track"], []).append((index, box))
    items = ""
    for poses in by_track.values():
        first, box = poses[0]
        length, width, height = box["size"]
        steps = "".join(
            f"<item><tx>{b['center'][0]}</tx><ty>{b['center'][1]}</ty><tz>{b['center'][2] - height / 2}</tz>"
            f"<rx>0</rx><ry>0</ry><rz>{b['yaw']}</rz></item>\n" for _, b in poses)
        items += (f"<item><objectType>{box['class'].capitalize()}</objectType><h>{height}</h><w>{width}</w><l>{length}</l>"
                  f"<first_frame>{first}</first_frame><poses><count>{len(poses)}</count>\n{steps}</poses></item>\n")
    return f'<?xml version="1.0"?>\n<boost_serialization><tracklets><count>{len(by_track)}</count>\n{items}' \
           "</tracklets></boost_serialization>\n"


def tracking(count, width, height):
    """Rectangles of one car in the middle of each image, as KITTI's tracking labels."""
    return "".join(f"{i} 0 Car 0 0 0 {width * 0.4} {height * 0.4} {width * 0.6} {height * 0.6} -1 -1 -1 0 0 0 0\n"
                   for i in range(count))


def mots(count, width, height):
    """The outline of one car, 24 columns left or right in the image, as MOTS' runs: six bits per character, the lowest five first."""
    def run(value):
        text = ""
        while value > 15 or not text:
            text, value = text + chr(48 + (value & 31 | 32)), value >> 5
        return text + chr(48 + value)
    def runs(left):
        return run(height * left) + run(height * 24) + run(height * (width - left - 24))
    return "".join(f"{i} 1000 1 {height} {width} {runs((8, width - 32)[i % 2])}\n" for i in range(count))


def convert(source, target, calibration, poses, labels):
    """Writes TARGET/2011_09_26 and returns the drive in it; `labels`: tracklets or outlines."""
    day, images = target / "2011_09_26", sorted((source / "images/front").glob("*.png"))
    drive, count = day / "2011_09_26_drive_0001_sync", len(images)
    for folder in ("image_02/data", "velodyne_points/data", "oxts/data"):
        (drive / folder).mkdir(parents=True)
    k, m, (width, height) = calibration["K"], calibration["camera_from_lidar"], calibration["size"]
    (day / "calib_cam_to_cam.txt").write_text(
        f"calib_time: 09-Jan-2012 13:57:47\nS_rect_02: {width} {height}\nR_rect_00: 1 0 0 0 1 0 0 0 1\n"
        f"P_rect_02: {numbers([k[0], 0, k[2], 0, 0, k[4], k[5], 0, 0, 0, 1, 0])}\n")
    (day / "calib_velo_to_cam.txt").write_text(
        f"R: {numbers(m[0:3] + m[4:7] + m[8:11])}\nT: {numbers([m[3], m[7], m[11]])}\n")
    (day / "calib_imu_to_velo.txt").write_text("R: 1 0 0 0 1 0 0 0 1\nT: 0 0 0\n")
    (drive / "image_02/timestamps.txt").write_text(stamps(count, 0))
    (drive / "oxts/timestamps.txt").write_text(stamps(count, 0))
    for name, shift in (("", 0), ("_start", -0.05), ("_end", 0.05)):
        (drive / f"velodyne_points/timestamps{name}.txt").write_text(stamps(count, shift))
    for i, image in enumerate(images):
        shutil.copy(image, drive / f"image_02/data/{i:010d}.png")
        shutil.copy(source / f"lidar/{image.stem}.bin", drive / f"velodyne_points/data/{i:010d}.bin")
        (drive / f"oxts/data/{i:010d}.txt").write_text(oxts(poses[image.stem]))
    if labels == "tracklets":
        (drive / "tracklet_labels.xml").write_text(tracklets(json.loads((source / "boxes.json").read_text())["frames"]))
    else:
        (drive / "tracking_labels.txt").write_text(tracking(count, width, height))
        (drive / "mots_instances.txt").write_text(mots(count, width, height))
    return drive
