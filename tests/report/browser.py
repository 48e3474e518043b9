"""Starts a headless Chromium that opens reports from disk, and makes results to open."""
import json
import os
import re
import shutil
import subprocess
from pathlib import Path
from urllib.parse import quote

from selenium import webdriver
from selenium.webdriver.chrome.service import Service
from selenium.webdriver.support.ui import WebDriverWait

PICTURES = ["frames", "masks", "kind", "provenance", "sources_used", "harmonization", "confidence", "depth"]


def start(width=1280, height=720, dark=False):
    options = webdriver.ChromeOptions()
    options.binary_location = shutil.which("chromium")
    for argument in ("--headless=new", "--no-sandbox", "--disable-gpu", "--disable-dev-shm-usage", "--hide-scrollbars"):
        options.add_argument(argument)
    options.set_capability("goog:loggingPrefs", {"browser": "ALL", "performance": "ALL"})
    driver = webdriver.Chrome(service=Service(shutil.which("chromedriver")), options=options)
    driver.execute_cdp_cmd("Emulation.setDeviceMetricsOverride",
                           {"width": width, "height": height, "deviceScaleFactor": 1, "mobile": False})
    if dark:
        driver.execute_cdp_cmd("Emulation.setEmulatedMedia", {"features": [{"name": "prefers-color-scheme", "value": "dark"}]})
    return driver


def address(out, view="overview"):
    return f"file://{quote(str(out))}/report.html#{view}"


def until(driver, condition, seconds=10):
    """Waits until a JavaScript expression holds."""
    WebDriverWait(driver, seconds, poll_frequency=0.02).until(lambda d: d.execute_script(f"return Boolean({condition})"), condition)


def errors(driver):
    return [entry["message"] for entry in driver.get_log("browser") if entry["level"] == "SEVERE"]


def requests(driver):
    """Returns every address requested since the last call."""
    messages = [json.loads(entry["message"])["message"] for entry in driver.get_log("performance")]
    return [m["params"]["request"]["url"] for m in messages if m["method"] == "Network.requestWillBeSent"]


def resident_bytes(driver):
    """Returns the memory of the browser's page processes; shared memory is divided among them (PSS)."""
    parents = {int(stat.parent.name): int(text_of(stat).rpartition(")")[2].split()[1]) for stat in Path("/proc").glob("[0-9]*/stat")
               if text_of(stat)}
    ours = {driver.service.process.pid}
    while more := {child for child, parent in parents.items() if parent in ours} - ours:
        ours |= more
    rollups = [text_of(Path(f"/proc/{process}/smaps_rollup")) for process in ours
               if "--type=renderer" in text_of(Path(f"/proc/{process}/cmdline"))]
    return sum(1024 * int(found[1]) for text in rollups if (found := re.search(r"^Pss: +(\d+) kB", text, re.MULTILINE)))


def text_of(file):
    """Reads a file of a process; empty if the process has ended."""
    try:
        return file.read_text(errors="replace")
    except OSError:
        return ""


def dvi(program, *arguments):
    done = subprocess.run([program, *map(str, arguments)], capture_output=True, text=True, check=False)
    if done.returncode != 0:
        raise RuntimeError(f"dvi {' '.join(map(str, arguments))}: {done.stderr}")
    return done.stdout


def dvi_without_override(program, *arguments):
    """Exit code and stderr of a call to which the modes of files apply, as they do to every user but root.

    Another user could not run a program that lies below /root, so root only gives up the right to ignore modes.
    """
    limits = ["setpriv", "--bounding-set=-dac_override,-dac_read_search", "--inh-caps=-all"] if os.geteuid() == 0 else []
    done = subprocess.run([*limits, program, *map(str, arguments)], capture_output=True, text=True, check=False)
    return done.returncode, done.stderr


def result_of(names, out, real):
    """Makes a result whose frames have these names, with repeated pictures of a real result."""
    report = json.loads((real / "report.json").read_text())
    sources = json.loads((real / "sources.json").read_text())
    frames, listed = report["frames"], sources["sources"]
    for folder in PICTURES:
        (out / folder).mkdir(parents=True)
    report["frames"] = []
    sources["sources"] = []
    for i, name in enumerate(names):
        frame = frames[i % len(frames)]
        for folder in PICTURES:
            (out / folder / f"{name}.png").hardlink_to(real / folder / f"{frame['name']}.png")
        report["frames"].append({**frame, "name": name, "number": i})
        sources["sources"].append({**listed[i % len(frames)], "frame": name, "number": i})
    (out / "report.json").write_text(json.dumps(report))
    (out / "sources.json").write_text(json.dumps(sources))
    shutil.copy(real / "dvi.toml", out)
