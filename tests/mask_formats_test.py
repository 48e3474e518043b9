#!/usr/bin/env python3
"""Writes the masks of a synthetic drive in the formats of other tools, by the rules of these formats, and compares the masks of
`dvi mask` with them; then draws the polygons that `dvi mask` writes. Skipped without numpy and OpenCV.

    mask_formats_test.py DVI
"""
import base64
import json
import subprocess
import sys
import tempfile
import xml.etree.ElementTree as ElementTree
from pathlib import Path

try:
    import cv2
    import numpy as np
except ImportError:
    print("skipped: needs python3-opencv and python3-numpy")
    sys.exit(77)

MIN_OVERLAP = 0.99
AS_GIVEN = ["--poses", "given", "--quiet", "--set", "masks.dilate_px=0", "--set", "masks.shadows=false", "--set",
            "objects.complete=false"]  # fmt: skip


def run(*arguments):
    subprocess.run([str(argument) for argument in arguments], check=True, stdout=subprocess.DEVNULL)


def overlap(a, b):
    union = np.count_nonzero(a | b)
    return np.count_nonzero(a & b) / union if union else 1.0


def read_masks(folder):
    return {file.stem: cv2.imread(str(file), cv2.IMREAD_GRAYSCALE) > 0 for file in sorted(folder.glob("*.png"))}


def split_objects(mask):
    count, parts = cv2.connectedComponents(mask.astype("uint8"), connectivity=4)
    return [parts == part for part in range(1, count)]


def list_contours(mask):
    """Returns contours near the edges of pixels, from an enlarged mask."""
    scale = 8
    large = cv2.resize(mask.astype("uint8"), None, fx=scale, fy=scale, interpolation=cv2.INTER_NEAREST)
    contours, _ = cv2.findContours(large, cv2.RETR_EXTERNAL, cv2.CHAIN_APPROX_NONE)
    return [(contour[:, 0, :] + 0.5) / scale for contour in contours]


def write_yolo(folder, masks, extras):
    (folder / "labels").mkdir(parents=True)
    for name, mask in masks.items():
        lines, size = [], np.array(mask.shape[::-1])
        for track, part in enumerate(split_objects(mask), start=1):
            for contour in list_contours(part):
                numbers = [2, *(contour / size).reshape(-1)] + extras(track)
                lines.append(("%g " * len(numbers)).rstrip() % tuple(numbers))
        if lines:
            (folder / "labels" / f"{name}.txt").write_text("\n".join(lines) + "\n")


def write_grounded_sam(folder, masks):
    for part in ("mask_data", "json_data"):
        (folder / part).mkdir(parents=True)
    for name, mask in masks.items():
        ids = np.zeros(mask.shape, "uint16")
        labels = {}
        for number, part in enumerate(split_objects(mask), start=1):
            ids[part] = number
            labels[str(number)] = {"instance_id": number, "class_name": "car"}
        np.save(folder / "mask_data" / f"mask_{name}.npy", ids)
        (folder / "json_data" / f"mask_{name}.json").write_text(json.dumps({"mask_name": f"mask_{name}.npy", "labels": labels}))


def write_panoptic(folder, masks):
    (folder / "panoptic").mkdir(parents=True)
    annotations = []
    for index, (name, mask) in enumerate(masks.items()):
        colors = np.zeros((*mask.shape, 3), "uint8")
        segments = []
        for number, part in enumerate(split_objects(mask), start=1):
            identity = 70000 + 300 * number
            colors[part] = [identity >> 16, identity >> 8 & 255, identity & 255]  # BGR
            segments.append({"id": identity, "category_id": 1})
        colors[~mask] = [0, 1, 44]
        segments.append({"id": 300, "category_id": 2})
        cv2.imwrite(str(folder / "panoptic" / f"{name}.png"), colors)
        annotations.append({"image_id": index, "file_name": f"{name}.png", "segments_info": segments})
    categories = [{"id": 1, "name": "car", "isthing": 1}, {"id": 2, "name": "road", "isthing": 0}]
    (folder / "panoptic.json").write_text(json.dumps({"images": [], "annotations": annotations, "categories": categories}))


def write_labelme(folder, masks):
    folder.mkdir(parents=True)
    for name, mask in masks.items():
        shapes = []
        for part in split_objects(mask):
            rows, columns = np.nonzero(part)
            x, y, right, bottom = columns.min(), rows.min(), columns.max(), rows.max()
            png = cv2.imencode(".png", part[y : bottom + 1, x : right + 1].astype("uint8"))[1].tobytes()
            shapes.append({"label": "car", "shape_type": "mask", "points": [[int(x), int(y)], [int(right), int(bottom)]],
                           "mask": base64.b64encode(png).decode()})  # fmt: skip
        (folder / f"{name}.json").write_text(json.dumps({"imagePath": f"{name}.png", "shapes": shapes}))


def write_arrays(folder, masks):
    folder.mkdir(parents=True)
    for name, mask in masks.items():
        np.save(folder / f"{name}.npy", mask)


def write_inverted(folder, masks):
    """Writes masks for OpenDroneMap and Metashape."""
    folder.mkdir(parents=True)
    for name, mask in masks.items():
        cv2.imwrite(str(folder / f"{name}_mask.png"), 255 * (~mask).astype("uint8"))


def write_video(file, masks):
    height, width = next(iter(masks.values())).shape
    video = cv2.VideoWriter(str(file), cv2.VideoWriter_fourcc(*"mp4v"), 10, (width, height))
    for mask in masks.values():
        video.write(np.repeat(255 * mask.astype("uint8")[:, :, None], 3, axis=2))
    video.release()


def fill(polygons, shape):
    """Returns the pixels whose centers are in any of the polygons, by the even-odd rule."""
    filled = np.zeros(shape, bool)
    centers = np.arange(shape[1]) + 0.5
    for polygon in polygons:
        inside = np.zeros(shape, bool)
        for (ax, ay), (bx, by) in zip(polygon, np.roll(polygon, -1, axis=0)):
            for row in range(max(0, int(np.floor(min(ay, by)))), min(shape[0], int(np.ceil(max(ay, by))) + 1)):
                y = row + 0.5
                if (ay <= y) != (by <= y):
                    inside[row] ^= centers > ax + (y - ay) / (by - ay) * (bx - ax)
        filled |= inside
    return filled


def read_coco_polygons(file):
    document = json.loads(file.read_text())
    names = {image["id"]: Path(image["file_name"]).stem for image in document["images"]}
    polygons = {name: [] for name in names.values()}
    for annotation in document["annotations"]:
        polygons[names[annotation["image_id"]]] += [np.reshape(part, (-1, 2)) for part in annotation["segmentation"]]
    return polygons


def read_cvat_polygons(file, names):
    polygons = {name: [] for name in names}
    for shape in ElementTree.parse(file).iter("polygon"):
        if shape.get("outside") == "0":
            points = [[float(number) for number in point.split(",")] for point in shape.get("points").split(";")]
            polygons[names[int(shape.get("frame"))]].append(np.array(points))
    return polygons


def check(name, worst):
    print(f"{name}: smallest overlap {worst:.4f}")
    return worst >= MIN_OVERLAP


def main(dvi):
    with tempfile.TemporaryDirectory() as temporary:
        folder = Path(temporary)
        drive = folder / "drive"
        run(dvi, "synth", "-o", drive, "--frames", 6, "--width", 480, "--height", 270, "--quiet")
        masks = read_masks(drive / "masks/front")
        write_yolo(folder / "yolo", masks, lambda track: [])
        write_yolo(folder / "yolo_conf", masks, lambda track: [0.75])
        write_yolo(folder / "yolo_track", masks, lambda track: [0.75, track])
        write_grounded_sam(folder / "sam", masks)
        write_panoptic(folder / "coco", masks)
        write_labelme(folder / "labelme", masks)
        write_arrays(folder / "arrays", masks)
        write_inverted(folder / "inverted", masks)
        write_video(folder / "masks.mp4", masks)
        passed = True
        for given in ("yolo", "yolo_conf", "yolo_track", "sam", "coco/panoptic.json", "labelme", "arrays", "inverted", "masks.mp4"):
            out = folder / "out" / Path(given).stem
            run(dvi, "mask", drive, "-o", out, "--masks", folder / given, *AS_GIVEN)
            made = read_masks(out / "masks/front")
            passed &= check(given, min(overlap(made[name], mask) for name, mask in masks.items()))
        run(dvi, "mask", drive, "-o", folder / "masks", "--masks", "labels", "--poses", "given", "--quiet")
        final = read_masks(folder / "masks/masks/front")
        for file, polygons in (("coco.json", read_coco_polygons(folder / "masks/coco.json")),
                               ("annotations.xml", read_cvat_polygons(folder / "masks/annotations.xml", sorted(final)))):  # fmt: skip
            passed &= check(file, min(overlap(fill(polygons[name], mask.shape), mask) for name, mask in final.items()))
    return 0 if passed else 1


if __name__ == "__main__":
    sys.exit(main(sys.argv[1]))
