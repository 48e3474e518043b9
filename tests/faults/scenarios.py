"""Disturbances of a run. Each function applies one and returns (its description, the findings)."""
import os
import shutil
import signal
import subprocess
import tempfile
import time
from pathlib import Path

import classify
import png
from program import wait
from results import contents, differences, kind_of

REFUSED, INTERRUPTED = 3, 130
STAGES = ("poses", "map", "exposure", "alignment")  # in the order of a run
LOST = ("deleted", "cut", "emptied", "zeroed")  # damage by disks


class Scene:
    """One case: a shared drive with the result of an undisturbed run, and a folder for this case."""

    def __init__(self, program, undisturbed, folder, rng):
        self.program, self.drive, self.seconds = program, undisturbed.drive, undisturbed.seconds
        self.complete, self.expected = undisturbed.out, undisturbed.expected
        self.folder, self.out, self.rng = folder, folder / "out", rng

    def run(self, *options, out=None, **limits):
        return self.program.call("run", self.drive, "-o", out or self.out, *options, **limits)

    def finish(self, out=None):
        """Runs to the end; returns the differences from the result of an undisturbed run."""
        ended = self.run(out=out)
        if ended.code != 0:
            return [f"run again exits with {ended.code}: {classify.first_line(ended.err)}"]
        return differences(self.expected, out or self.out)

    def expect_refused(self, ended):
        """Returns findings about a call that must end with exit code 3 and a message with the result's folder."""
        return classify.judge(ended, self.out) + (["it succeeded, but an error was expected"] if ended.code == 0 else [])


def killed(scene):
    """A signal ends the run at a random time, up to three times; then the run is resumed."""
    done, found = [], []
    for _ in range(scene.rng.randint(1, 3)):
        name = scene.rng.choice(("SIGKILL", "SIGKILL", "SIGKILL", "SIGTERM", "SIGINT"))
        moment = scene.rng.uniform(0, scene.seconds)
        process = scene.program.start("run", scene.drive, "-o", scene.out)
        try:
            process.wait(moment)
        except subprocess.TimeoutExpired:
            process.send_signal(signal.Signals[name])
            code, _ = wait(process, 20)
            if code not in (0, 128 + signal.Signals[name], INTERRUPTED):  # until the program has a handler, signals end it
                found.append(f"{name} after {moment:.2f} s: exit {code}")
        done.append(f"{name} at {moment:.2f} s")
    return ", ".join(done), found + scene.finish()


def killed_after_stage(scene):
    """The run is killed after a stage is cached, several times; a later call must load the stage from the cache."""
    done, kept = [], {}
    for name in sorted(scene.rng.sample(range(len(STAGES)), scene.rng.randint(1, 3))):
        record = scene.out / f".dvi/stages/{STAGES[name]}.json"
        process = scene.program.start("run", scene.drive, "-o", scene.out)
        end = time.monotonic() + scene.program.seconds
        while process.poll() is None and not record.exists() and time.monotonic() < end:
            time.sleep(0.001)
        process.kill()
        process.wait()
        if record.exists():
            file = record.with_suffix(".bin")
            kept.setdefault(file, file.stat().st_mtime_ns)
        done.append(f"SIGKILL after {STAGES[name]}")
    found = scene.finish()
    again = [file.stem for file, written in kept.items() if file.stat().st_mtime_ns != written]
    return ", ".join(done), found + [f"{name} was made again" for name in again]


def call_despite_kills(scene, steps):
    """Each step is killed at a random time, up to twice, and called again. Returns a description, and findings."""
    done = []
    for step in steps:
        for _ in range(scene.rng.randint(0, 2)):
            moment = scene.rng.uniform(0, scene.seconds)
            process = scene.program.start(*step)
            try:
                process.wait(moment)
            except subprocess.TimeoutExpired:
                process.kill()
                process.wait()
                done.append(f"{step[0]} at {moment:.2f} s")
        ended = scene.program.call(*step)
        if ended.code != 0:
            return ", ".join(done), [f"{step[0]} again exits with {ended.code}: {classify.first_line(ended.err)}"]
    return ", ".join(done) or "no kill before the ends", []


def fills_of(scene):
    """Two fills with a common frame, in any order."""
    fills = [("fill", scene.out, "--frames", "0:1"), ("fill", scene.out, "--frames", "1:99")]
    scene.rng.shuffle(fills)
    return fills


def pieces_killed(scene):
    """plan, two fills with a common frame, and finish are each killed at a random time, up to twice, and called again."""
    done, found = call_despite_kills(scene, (("plan", scene.drive, "-o", scene.out), *fills_of(scene), ("finish", scene.out)))
    return done, found or differences(scene.expected, scene.out)


def sections_killed(scene):
    """The same with a plan in two sections, which are joined. Their overlaps are the whole drive, so the frames are the same."""
    sections = [("plan", scene.drive, "-o", scene.out, "--section", section) for section in ("1/2", "2/2")]
    scene.rng.shuffle(sections)
    done, found = call_despite_kills(scene, (*sections, ("join", scene.out), *fills_of(scene), ("finish", scene.out)))
    frames = {name: content for name, content in scene.expected.items() if name.startswith(("frames/", "provenance/"))}
    made = contents(scene.out)
    return done, found or [f"{name} differs" for name, content in frames.items() if made.get(name) != content]


def import_killed(scene):
    """An import of another program's fill is killed up to three times; then it is repeated or undone, or a run completes it."""
    fill, imported = scene.folder / "fill", scene.folder / "imported"
    scene.program.call("run", scene.drive, "-o", fill, "--method", "telea")
    shutil.copytree(scene.complete, imported)
    shutil.copytree(scene.complete, scene.out)
    begun = time.monotonic()
    ended = scene.program.call("import-fill", imported, fill / "frames")
    seconds, done = time.monotonic() - begun, []
    if ended.code != 0:
        return "an import", [f"exit {ended.code}: {classify.first_line(ended.err)}"]
    for _ in range(scene.rng.randint(1, 3)):
        moment = scene.rng.uniform(0, seconds)
        process = scene.program.start("import-fill", scene.out, fill / "frames")
        try:
            process.wait(moment)
        except subprocess.TimeoutExpired:
            process.kill()
            process.wait()
            done.append(f"SIGKILL at {moment:.2f} s")
    end, arguments, expected = scene.rng.choice((
        ("repeated", ("import-fill", scene.out, fill / "frames"), contents(imported)),
        ("undone", ("import-fill", scene.out, "--undo"), scene.expected),
        ("a run", ("run", scene.drive, "-o", scene.out), None)))
    calls = (arguments, ("audit", scene.out, scene.drive))
    found = [f"{call[0]} exits with {ended.code}: {classify.first_line(ended.err)}"
             for call in calls if (ended := scene.program.call(*call)).code != 0]
    return ", ".join([*done, end]), found + (differences(expected, scene.out) if expected else [])


def stages_damaged(scene):
    """Frames are missing, and files of cached stages are missing or damaged."""
    shutil.copytree(scene.complete, scene.out)
    done = [": ".join(damage(scene.out, scene.rng, lambda name: name.startswith("frames/"), ("deleted",)))]
    done += [": ".join(damage(scene.out, scene.rng, lambda name: name.startswith(".dvi/stages/"), (*LOST, "changed")))
             for _ in range(scene.rng.choice((1, 1, 2, 4)))]
    return ", ".join(done), scene.finish()


def disk_full(scene):
    """The disk is too small for the result or for one of its files; then it has enough space."""
    total = sum(p.stat().st_size for p in scene.complete.rglob("*") if p.is_file())
    kilobytes = scene.rng.randrange(4, max(8, total // 1024))
    disk = Tmpfs.mounted(scene.folder / "disk", f"size={kilobytes}k")
    if disk is None:
        largest = max(p.stat().st_size for p in scene.complete.rglob("*") if p.is_file())
        limit = scene.rng.randrange(largest)
        return f"files of at most {limit} bytes", scene.expect_refused(scene.run(file_bytes=limit)) + scene.finish()
    with disk:
        scene.out = disk.folder / "out"
        ended = scene.run()
        found = scene.expect_refused(ended) if ended.code else differences(scene.expected, scene.out)
        disk.remount("size=256m")
        return f"a disk of {kilobytes} kB", found + scene.finish()


def read_only(scene):
    """The result is read-only, before it is begun or half finished."""
    disk = Tmpfs.mounted(scene.folder / "disk", "size=256m")
    if disk is None:
        return "skipped: needs the right to mount a tmpfs", []
    with disk:
        scene.out, half = disk.folder / "out", scene.rng.random() < 0.5
        if half:
            shutil.copytree(scene.complete, scene.out)
            (scene.out / "video.mp4").unlink()
        disk.remount("ro")
        found = scene.expect_refused(scene.run())
        disk.remount("rw")
        return f"{'a result without video' if half else 'no result yet'}", found + scene.finish()


def damaged(scene):
    """One file of a complete result is deleted, truncated, emptied, or changed; a run makes it again."""
    shutil.copytree(scene.complete, scene.out)
    path, done = damage(scene.out, scene.rng, lambda name: not name.startswith(".dvi/"), (*LOST, "changed"))
    return f"{path}: {done}", scene.finish()


def power_cut(scene):
    """One or several manifests are truncated, emptied, or filled with zeros, in a complete or unfinished result."""
    shutil.copytree(scene.complete, scene.out)
    done = []
    if scene.rng.random() < 0.7:
        (scene.out / "report.json").unlink()  # the report is written last
        done.append("an unfinished run")
    done += [": ".join(damage(scene.out, scene.rng, lambda name: name.startswith(".dvi/"), LOST))
            for _ in range(scene.rng.choice((1, 1, 3)))]
    found = scene.finish()
    if found and any("job.json" in what for what in done):  # without this file, the drives of the folder are unknown
        ended = scene.run()
        if ended.code == REFUSED and "--force" in ended.err:
            forced = scene.run("--force")
            found = differences(scene.expected, scene.out) if forced.code == 0 else [f"--force exits with {forced.code}"]
    return ", ".join(done), found


def damage(out, rng, wanted, ways):
    """Damages one random file, with equal probability per kind; returns (its path in OUT, the kind of damage)."""
    kinds = {}
    for path in sorted(p for p in out.rglob("*") if p.is_file()):
        name = str(path.relative_to(out))
        if wanted(name):
            kinds.setdefault(kind_of(name), []).append(path)
    path = rng.choice(kinds[rng.choice(sorted(kinds))])
    data, done = path.read_bytes(), rng.choice(ways)
    if done == "deleted":
        path.unlink()
    else:
        at = rng.randrange(len(data)) if data else 0
        path.write_bytes({"cut": data[:at], "emptied": b"", "zeroed": bytes(len(data)),
                          "changed": data[:at] + bytes(x ^ 1 for x in data[at:at + 1]) + data[at + 1:]}[done])
    return str(path.relative_to(out)), done


def two_at_once(scene):
    """Two runs write to one OUT; one is refused, or both end with the correct result."""
    delay, calls = scene.rng.uniform(0, scene.seconds), []
    for _ in range(2):
        err = tempfile.TemporaryFile()
        calls.append((scene.program.start("run", scene.drive, "-o", scene.out, err=err), err))
        time.sleep(delay if len(calls) == 1 else 0)
    found, codes = [], []
    for process, err in calls:
        code, _ = wait(process, scene.program.seconds)
        err.seek(0)
        text = err.read().decode("utf-8", "backslashreplace")
        err.close()
        codes.append(code)
        if code not in (0, REFUSED):
            found.append(f"one ends with {code}: {classify.first_line(text)}")
        elif code == REFUSED:
            found += classify.bad_message(text, scene.out)
    if 0 not in codes:
        found.append("neither succeeded")
    else:
        found += differences(scene.expected, scene.out)
    return f"the second {delay:.2f} s after the first: exits {codes[0]} and {codes[1]}", found + scene.finish()


def input_changed(scene):
    """A file of the drive changes after a run, possibly with an unchanged date; the next run must give the result of a fresh run."""
    drive = scene.folder / "drive"
    shutil.copytree(scene.drive, drive)
    scene.drive = drive
    first = scene.run()
    if first.code != 0:
        return "the first run", [f"exit {first.code}"]
    path = scene.rng.choice([drive / name for name in (
        "images/front/000001.png", "masks/front/000002.png", "lidar/000001.bin", "poses.txt", "dvi.toml")])
    status, keep_date = path.stat(), scene.rng.random() < 0.5
    path.write_bytes(changed(path))
    if keep_date:
        os.utime(path, ns=(status.st_atime_ns, status.st_mtime_ns))
    what = path.name + (", its date kept" if keep_date else "")
    fresh, again = scene.run(out=scene.folder / "fresh"), scene.run()
    if fresh.code != again.code:
        return what, [f"a fresh run exits with {fresh.code}, the next one with {again.code}"]
    expected = contents(scene.folder / "fresh")
    return what, differences(expected, scene.out) if fresh.code == 0 else []


def changed(path):
    """Returns other valid content, of the same size for some formats."""
    data = path.read_bytes()
    if path.suffix == ".png":
        image = png.decode(data)
        middle = len(image.data) // 2
        flipped = bytes(255 - x for x in image.data[middle:middle + 30])
        return png.encode(image._replace(data=image.data[:middle] + flipped + image.data[middle + 30:]))
    if path.suffix == ".bin":
        return bytes(len(data) // 2) + data[len(data) // 2:]
    if path.name == "poses.txt":
        return data.replace(b" 1.7", b" 1.6")
    return data.replace(b"79.5", b"78.5").replace(b"63.5", b"64.5")


class Tmpfs:
    """A temporary file system, unmounted at the end."""

    def __init__(self, folder):
        self.folder = folder

    @classmethod
    def mounted(cls, folder, options):
        folder.mkdir()
        ended = subprocess.run(["mount", "-t", "tmpfs", "-o", options, "tmpfs", folder], stderr=subprocess.DEVNULL)
        return cls(folder) if ended.returncode == 0 else None

    def remount(self, options):
        subprocess.run(["mount", "-o", f"remount,{options}", self.folder], check=True)

    def __enter__(self):
        return self

    def __exit__(self, *_):
        subprocess.run(["umount", self.folder], check=True)


ALL = (killed, damaged, power_cut, disk_full, stages_damaged, killed, two_at_once, read_only, input_changed, damaged,
       killed_after_stage, stages_damaged, pieces_killed, import_killed, sections_killed)
