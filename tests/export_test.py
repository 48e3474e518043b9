#!/usr/bin/env python3
"""Reads exports of a result by code that is independent of the program, and by the tools for which they are
made, if these are installed.

    export_test.py OUT EXPORTS      EXPORTS/colmap, EXPORTS/nerfstudio and so on; exit code 1 with the first fault
"""
import json
import re
import shutil
import struct
import subprocess
import sys
import zlib
from pathlib import Path


def lines(path):
    return [line for line in path.read_text().splitlines() if not line.startswith("#")]


def rotate(q, x):
    w, a, b, c = q
    rows = ((1 - 2 * (b * b + c * c), 2 * (a * b - w * c), 2 * (a * c + w * b)),
            (2 * (a * b + w * c), 1 - 2 * (a * a + c * c), 2 * (b * c - w * a)),
            (2 * (a * c - w * b), 2 * (b * c + w * a), 1 - 2 * (a * a + b * b)))
    return [sum(r * v for r, v in zip(row, x)) for row in rows]


def close(a, b, within):
    assert abs(a - b) <= within, (a, b)


def check_colmap(folder, sources):
    model = folder / "sparse/0"
    camera = lines(model / "cameras.txt")[0].split()
    assert camera[1] == "PINHOLE", camera
    fx, fy, cx, cy = map(float, camera[4:8])
    close(cx, sources["cameras"][0]["K"][2] + 0.5, 1e-6)
    points = {int(line.split()[0]): [float(v) for v in line.split()[1:4]] for line in lines(model / "points3D.txt")}
    text = lines(model / "images.txt")
    centers, matched = {}, 0
    for head, tail in zip(text[::2], text[1::2]):
        words, observed = head.split(), tail.split()
        q, t = [float(v) for v in words[1:5]], [float(v) for v in words[5:8]]
        assert (folder / "images" / words[9]).exists() and (folder / "masks" / (words[9] + ".png")).exists(), words
        conjugate = [q[0], -q[1], -q[2], -q[3]]
        centers[words[9]] = [-v for v in rotate(conjugate, t)]
        for u, v, point in zip(observed[::3], observed[1::3], observed[2::3]):
            x, y, z = (a + b for a, b in zip(rotate(q, points[int(point)]), t))
            close(fx * x / z + cx, float(u), 0.05)
            close(fy * y / z + cy, float(v), 0.05)
            matched += 1
    assert matched > 100, matched
    if shutil.which("colmap"):
        text = subprocess.run(["colmap", "model_analyzer", "--path", model], check=True, capture_output=True, text=True,
                              env={"QT_QPA_PLATFORM": "offscreen", "PATH": "/usr/bin:/bin"})
        text = text.stdout + text.stderr
        assert f"Registered images: {len(centers)}" in text and f"Points: {len(points)}" in text, text
    return centers


def check_nerfstudio(folder, centers):
    table = json.loads((folder / "transforms.json").read_text())
    assert {frame["file_path"] for frame in table["frames"]} == {"images/" + name for name in centers}
    for frame in table["frames"]:
        matrix = frame["transform_matrix"]
        for axis in range(3):
            close(matrix[axis][3], centers[frame["file_path"].removeprefix("images/")][axis], 1e-4)
        close(-matrix[0][2], 1, 0.2)  # looks along the world's x
        close(matrix[2][1], 1, 0.2)  # up is the world's z
        for part in ("file_path", "mask_path", "depth_file_path"):
            header = (folder / frame[part]).read_bytes()[:26]
            size, depth = struct.unpack(">II", header[16:24]), header[24]
            assert size == (table["w"], table["h"]) and depth == (16 if part == "depth_file_path" else 8), (part, header)
    assert (folder / table["ply_file_path"]).read_bytes().startswith(b"ply\n")


def read_ply(path):
    data = path.read_bytes()
    begin = data.index(b"end_header\n") + 11
    names = [line.split()[2] for line in data[:begin].decode().splitlines() if line.startswith("property")]
    form = struct.Struct("<" + "".join("B" if name in ("red", "green", "blue") else "f" for name in names))
    return [dict(zip(names, values)) for values in form.iter_unpack(data[begin:])]


def check_las(path, points):
    data = path.read_bytes()
    assert data[:4] == b"LASF" and data[24:26] == b"\1\2", data[:26]
    size, offset, _, form, length, count = struct.unpack_from("<HIIBHI", data, 94)
    assert (size, offset, form, length, count) == (227, 227, 3, 34, len(points)), (size, offset, form, length, count)
    scale = struct.unpack_from("<d", data, 131)[0]
    high_x, low_x = struct.unpack_from("<dd", data, 179)
    for i, point in enumerate(points):
        x, y, z, _, flags, *_, red, _, _ = struct.unpack_from("<iiiHBBbBHdHHH", data, 227 + 34 * i)
        for value, axis in zip((x, y, z), "xyz"):
            close(value * scale, point[axis], 0.00051)
        assert flags == 9 and red == 257 * point["red"] and low_x - 1e-6 <= point["x"] <= high_x + 1e-6, i
    assert len(data) == 227 + 34 * count


def records(data, begin, end):
    while begin < end:
        kind, size = struct.unpack_from("<BQ", data, begin)
        yield kind, begin, data[begin + 9:begin + 9 + size]
        begin += 9 + size
    assert begin == end


def check_mcap(path, frames):
    data = path.read_bytes()
    magic = b"\x89MCAP0\r\n"
    assert data.startswith(magic) and data.endswith(magic)
    topics, counts, chunks = {}, {}, 0
    for kind, begin, record in records(data, 8, len(data) - 8):
        if kind == 6:
            size, crc, name = struct.unpack_from("<QII", record, 16)
            inner = record[40 + name:]
            assert len(inner) == size and zlib.crc32(inner) == crc
            chunks += 1
            for what, _, content in records(inner, 0, len(inner)):
                if what == 4:
                    topic = struct.unpack_from("<HHI", content)
                    topics[topic[0]] = content[8:8 + topic[2]].decode()
                if what == 5:
                    number = struct.unpack_from("<H", content)[0]
                    counts[topics[number]] = counts.get(topics[number], 0) + 1
        if kind == 8:
            place, length = struct.unpack_from("<QQ", record, 16)
            assert data[place] == 6 and struct.unpack_from("<Q", data, place + 1)[0] + 9 == length
            chunks -= 1
    assert chunks == 0 and counts == {"/map": 1, "/path": 1, "/tf": frames, "/camera/camera_info": frames,
                                      "/camera/image/compressed": frames, "/camera/kind/compressed": frames}, counts


def check_ortho(folder, place):
    if not shutil.which("gdalinfo"):
        print("skipped: gdalinfo is not installed (gdal-bin)")
        return
    read = lambda name: json.loads(subprocess.check_output(["gdalinfo", "-json", "-stats", folder / name]))
    color, evidence = read("ortho.tif"), read("evidence.tif")
    assert [band["colorInterpretation"] for band in color["bands"]] == ["Red", "Green", "Blue", "Alpha"], color["bands"]
    assert color["size"] == evidence["size"] and color["geoTransform"] == evidence["geoTransform"]
    assert abs(place["latitude_deg"] - 49.01) < 1e-4 and abs(place["longitude_deg"] - 8.43) < 1e-4, place
    assert abs(place["heading_deg"] - 90) < 2 and place["residual_m"] < 0.05, place
    wkt = color["coordinateSystem"]["wkt"]
    latitude = float(re.search(r'Latitude of natural origin",([\d.]+)', wkt)[1])
    assert abs(latitude - place["latitude_deg"]) < 1e-8 and "WGS 84" in wkt, wkt
    source, age, confidence, height = evidence["bands"]
    assert 0 <= source["minimum"] and 0 <= age["minimum"] and 0 <= confidence["minimum"] <= confidence["maximum"] <= 1
    assert -3 < height["mean"] < 0, height  # below the LiDAR
    for path in folder.glob("*.xml"):
        path.unlink()


def main():
    out, exports = map(Path, sys.argv[1:])
    sources = json.loads((out / "sources.json").read_text())
    centers = check_colmap(exports / "colmap", sources)
    check_nerfstudio(exports / "nerfstudio", centers)
    check_las(exports / "las/map.las", read_ply(exports / "ply/map.ply"))
    check_mcap(exports / "mcap/drive.mcap", len(centers))
    if (exports / "ortho").exists():
        check_ortho(exports / "ortho", json.loads((out / "report.json").read_text())["drives"][0]["place"])
    print("every export can be read")


if __name__ == "__main__":
    main()
