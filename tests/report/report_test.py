#!/usr/bin/env python3
"""Opens reports in a headless Chromium from disk, and uses their controls.

    report_test.py DVI [TEST...]      exit code 77: the browser or its driver is not installed
"""
import json
import shutil
import sys
import tempfile
import time
import unittest
from pathlib import Path
from urllib.parse import quote

try:
    from selenium.webdriver import ActionChains
    from selenium.webdriver.common.by import By
    from selenium.webdriver.common.keys import Keys

    import browser
except ImportError:
    print("skipped: the package python3-selenium is not installed")
    sys.exit(77)
if not shutil.which("chromium") or not shutil.which("chromedriver"):
    print("skipped: the packages chromium and chromium-driver are not installed")
    sys.exit(77)

PROGRAM = sys.argv.pop(1) if len(sys.argv) > 1 else "dvi"


class Report(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = Path(tempfile.mkdtemp(prefix="dvi-report-"))
        street, cls.out = cls.folder / "street", cls.folder / "result"
        browser.dvi(PROGRAM, "synth", "-o", street, "--frames", 6, "--width", 160, "--height", 96, "--beams", 32, "--columns", 900,
                    "--quiet")
        browser.dvi(PROGRAM, "run", street, "-o", cls.out, "--quiet")
        browser.dvi(PROGRAM, "eval", cls.out, "--truth", street / "truth", "--quiet")
        cls.driver = browser.start()
        cls.driver.get("about:blank")
        cls.blank = browser.resident_bytes(cls.driver)

    @classmethod
    def tearDownClass(cls):
        cls.driver.quit()
        shutil.rmtree(cls.folder)

    def open(self, out, view="overview"):
        self.driver.get("about:blank")
        self.driver.get(browser.address(out, view))

    def setUp(self):
        browser.errors(self.driver), browser.requests(self.driver)  # discards those of the previous test
        self.began = time.monotonic()

    def tearDown(self):
        print(f"{time.monotonic() - self.began:.1f} s ", end="", flush=True)

    def js(self, expression):
        return self.driver.execute_script(f"return {expression}")

    def text(self, selector):
        return self.driver.find_element(By.CSS_SELECTOR, selector).text

    def press(self, key):
        ActionChains(self.driver).send_keys(key).perform()

    def no_error(self, out):
        self.assertEqual(browser.errors(self.driver), [])
        inside = f"file://{quote(str(out))}/"
        outside = [url for url in browser.requests(self.driver) if not url.startswith((inside, "data:", "about:", "blob:"))]
        self.assertEqual(outside, [], "requests that leave the folder")

    def copied_pixel(self, frame):
        """Returns a copied pixel of the frame, and its position in the window."""
        return self.driver.execute_async_script("""
            const done = arguments[1];
            dvi.receipts(arguments[0]).then((block) => {
              const all = [...block.hole.keys()].filter((k) => block.fields.source[k] > 0), k = all[all.length >> 1];
              const [x, y] = [block.hole[k] % block.width, Math.floor(block.hole[k] / block.width)];
              const at = dvi.frameView.map.latLngToContainerPoint([-y - 0.5, x + 0.5]), box = document.getElementById("picture").getBoundingClientRect();
              done([x, y, Math.round(box.left + at.x), Math.round(box.top + at.y)]);
            });""", frame)

    def click_at(self, x, y):
        actions = ActionChains(self.driver)
        actions.w3c_actions.pointer_action.move_to_location(x, y).click()
        actions.perform()

    def test_a_camera_is_selected(self):
        street, out = self.folder / "rig", self.folder / "rig_result"
        browser.dvi(PROGRAM, "synth", "-o", street, "--frames", 3, "--width", 160, "--height", 96, "--beams", 32, "--columns", 900,
                    "--stereo-m", 0.5, "--quiet")
        browser.dvi(PROGRAM, "run", street, "--camera", "all", "-o", out, "--quiet")
        self.open(out, "frames/1")
        browser.until(self.driver, "dvi.frameView && dvi.frameView.map")
        self.assertEqual(self.js("[...document.querySelectorAll('#camera option')].map((o) => o.value)"), ["front", "right"])
        self.assertEqual(self.text("#frame-name"), "000001  (2 of 3)")
        self.js("(() => { const s = document.getElementById('camera'); s.value = 'right'; s.dispatchEvent(new Event('change')); })()")
        browser.until(self.driver, "location.hash === '#frames/4'")
        self.assertEqual(self.js("document.getElementById('camera').value"), "right")
        self.assertEqual(self.text("#frame-name"), "000001  (2 of 3)")
        for _ in range(3):
            self.press(Keys.ARROW_RIGHT)
        browser.until(self.driver, "location.hash === '#frames/5'")
        self.assertEqual(self.js("dvi.frameName(5)"), "right/000002")
        self.press(Keys.HOME)
        browser.until(self.driver, "location.hash === '#frames/3'")
        self.open(out, "overview")
        browser.until(self.driver, "document.getElementById('objects')")
        self.assertIn("right", self.text("#objects"))
        self.no_error(out)

    def test_overview_shows_the_figures_of_the_run(self):
        self.open(self.out)
        browser.until(self.driver, "document.querySelectorAll('.tile').length > 4")
        share = json.loads((self.out / "report.json").read_text())["hole"]["share"]
        shown = [tile.text.split("\n")[0] for tile in self.driver.find_elements(By.CSS_SELECTOR, ".tile")]
        self.assertEqual(shown[0], f"{100 * share['copied']:.1f} %")
        self.assertIn("Against the truth", self.text("#overview"))
        self.assertGreaterEqual(len(self.driver.find_elements(By.CSS_SELECTOR, ".card")), 1)
        self.no_error(self.out)

    def test_overview_lists_removed_objects(self):
        self.open(self.out)
        browser.until(self.driver, "document.getElementById('objects')")
        objects = json.loads((self.out / "objects.json").read_text())["objects"]
        rows = self.driver.find_elements(By.CSS_SELECTOR, "#objects tbody tr")
        self.assertEqual(len(rows), len(objects))
        self.assertEqual({row.find_element(By.TAG_NAME, "td").text for row in rows}, {str(entry["object"]) for entry in objects})
        self.no_error(self.out)

    def test_overview_shows_the_objects_to_check_before_publishing(self):
        self.open(self.out)
        browser.until(self.driver, "document.getElementById('objects')")
        shown = self.js("""(() => {
            const residue = {remains_visible: false, visible_frames: [], highest_score: 0.2, highest_score_frame: dvi.frames()[1].number,
                             highest_score_box: [20, 30, 16, 12]};
            dvi.data.objects = Array.from({length: 30}, (_, i) => ({object: i, class: "car", residue: {...residue, highest_score: i / 100}}));
            dvi.data.objects[3].residue = {...residue, remains_visible: true, visible_frames: [1, 2]};
            dvi.data.objects[4].residue = null;
            document.getElementById("doubtful")?.remove();
            document.getElementById("overview").append(dvi.doubtfulObjects());
            return [...document.querySelectorAll("#doubtful .card p")].map((text) => text.textContent);
        })()""")
        self.assertEqual(len(shown), 20)
        self.assertIn("Object 3 (car)", shown[0])
        self.assertIn("remains visible", shown[0])
        self.assertIn("Object 29 (car)", shown[1])
        self.assertEqual(len(self.driver.find_elements(By.CSS_SELECTOR, "#doubtful svg.crop")), 40)
        self.no_error(self.out)

    def test_long_lists_of_objects_are_closed(self):
        self.open(self.out)
        browser.until(self.driver, "document.getElementById('objects')")
        count = self.js("""(() => {
            const one = {object: 0, class: "car", evidence: "labels", motion: "static", first_frame: 0, last_frame: 3, frames: 4,
                         completed_frames: [1, 2], removed_pixels: 1000, residue: {remains_visible: false, visible_frames: []}};
            dvi.data.objects = Array.from({length: 600}, (_, i) => ({...one, object: i}));
            dvi.data.objects[599].residue = {remains_visible: true, visible_frames: [0, 1, 3]};
            document.getElementById("objects").replaceWith(dvi.objectTable());
            return document.querySelectorAll("#objects details:not([open]) tbody tr").length;
        })()""")
        self.assertEqual(count, 485)
        self.assertIn("599", self.text("#objects tbody tr"), "objects that remain visible are first")
        self.assertIn("0–1, 3", self.text("#objects tbody tr"))
        self.assertIn("100 more in objects.json", self.text("#objects"))
        self.js("(() => { dvi.data.objects = []; document.getElementById('objects').replaceWith(dvi.objectTable()); })()")
        self.assertIn("No removed object is known", self.text("#objects"))
        self.no_error(self.out)

    def test_clicking_a_pixel_shows_its_provenance(self):
        self.open(self.out, "frames/2")
        browser.until(self.driver, "document.querySelector('#picture img') && document.querySelector('#picture img').complete")
        self.press("b")  # the divider to the edge
        x, y, *place = self.copied_pixel(2)
        self.click_at(*place)
        browser.until(self.driver, "document.getElementById('source-position')")
        receipt = json.loads(browser.dvi(PROGRAM, "inspect", self.out, "000002", x, y, "--json"))
        self.assertEqual(self.text("#pixel-position"), f"{x}, {y}")
        shown = [float(n) for n in self.text("#source-position").split(", ")]
        self.assertEqual(shown, [receipt["source"]["x"], receipt["source"]["y"]])
        self.assertIn(f"frame {receipt['source']['frame']}", self.text("#receipt"))
        self.assertIn(f"{receipt['depth_m']:.2f} m", self.text("#receipt"))
        self.assertEqual(len(self.driver.find_elements(By.CSS_SELECTOR, "#receipt .crop")), 3)
        self.driver.find_element(By.ID, "to-source").click()
        browser.until(self.driver, f"document.getElementById('frame-name').textContent.startsWith('{receipt['source']['frame']}')")
        self.no_error(self.out)

    def test_divider_keys_and_overlays(self):
        self.open(self.out, "frames/0")
        browser.until(self.driver, "document.querySelector('#picture img') && document.querySelector('#picture img').complete")
        before = self.js("dvi.frameView.map.getPane('left').style.clip")
        ActionChains(self.driver).drag_and_drop_by_offset(self.driver.find_element(By.ID, "divider"), -200, 0).perform()
        self.assertNotEqual(self.js("dvi.frameView.map.getPane('left').style.clip"), before)
        self.press("\ue014")  # right arrow
        browser.until(self.driver, "location.hash === '#frames/1'")
        for key, overlay in zip("mkcdex0", ["mask", "kind", "confidence", "depth", "blending", "error", "none"]):
            self.press(key)
            browser.until(self.driver, f"document.getElementById('picture').dataset.overlay === '{overlay}'")
            drawn = self.js("Boolean(document.querySelector('.leaflet-overlay-pane + * canvas, #picture canvas'))")
            self.assertEqual(drawn, overlay != "none", overlay)
        self.press("n")
        browser.until(self.driver, "location.hash !== '#frames/1'")
        self.press(" ")
        shown = self.js("location.hash")
        browser.until(self.driver, f"location.hash !== '{shown}'")
        self.press(" ")
        self.no_error(self.out)

    def test_clicking_the_map_goes_to_a_frame(self):
        self.open(self.out, "above")
        browser.until(self.driver, "dvi.mapView")
        x, y = self.driver.execute_script("""
            const at = dvi.mapView.map.latLngToContainerPoint([dvi.data.above.world_from_camera[3][7] + 2, dvi.data.above.world_from_camera[3][3]]);
            const box = document.getElementById("map").getBoundingClientRect();
            return [Math.round(box.left + at.x), Math.round(box.top + at.y)];""")
        self.click_at(x, y)
        browser.until(self.driver, "location.hash === '#frames/3'")
        self.no_error(self.out)

    def test_stages(self):
        self.open(self.out, "stages")
        browser.until(self.driver, "document.querySelectorAll('#stages article').length === 6")
        self.no_error(self.out)

    def test_a_thousand_frames_open_in_two_seconds(self):
        out = self.folder / "long"
        browser.result_of([f"{i:06d}" for i in range(1000)], out, self.out)
        browser.dvi(PROGRAM, "report", out, "--quiet")
        start = time.monotonic()
        self.open(out, "frames/500")
        browser.until(self.driver, "document.querySelector('#picture img') && document.querySelector('#picture img').complete")
        seconds = time.monotonic() - start
        print(f"1000 frames: the first picture after {seconds:.2f} s,"
              f" {self.js('performance.memory.usedJSHeapSize') / 1e6:.0f} MB of JavaScript,"
              f" {browser.resident_bytes(self.driver) / 1e6:.0f} MB of the browser's processes for pages ({self.blank / 1e6:.0f} MB"
              f" when blank),"
              f" index.js {(out / 'report/index.js').stat().st_size / 1e6:.1f} MB")
        self.press("k")
        browser.until(self.driver, "document.querySelector('#picture canvas')")
        self.no_error(out)

    def test_names_that_need_escaping(self):
        odd = ["a'b\"c", "Straße ü", "<script>alert(1)<", "100%20 #1?", "{{x}}&amp;"]
        out = self.folder / "Ä \"odd\" <script> #1 %41 'result'"
        browser.result_of(odd, out, self.out)
        browser.dvi(PROGRAM, "report", out, "--quiet")
        for i, name in enumerate(odd):
            self.open(out, f"frames/{i}")
            browser.until(self.driver, "document.querySelector('#picture img') && document.querySelector('#picture img').naturalWidth")
            self.assertTrue(self.text("#frame-name").startswith(name))
        self.no_error(out)

    def test_missing_parts_are_reported(self):
        out = self.folder / "partly"
        browser.result_of(["a", "b"], out, self.out)
        (out / "kind/b.png").unlink()
        (out / "report.json").unlink()
        (out / ".dvi").mkdir()
        browser.dvi(PROGRAM, "report", out, "--quiet")
        self.open(out)
        self.assertIn("not finished", self.text("#overview"))
        self.no_error(out)
        browser.result_of(["a", "b"], self.folder / "deleted", self.out)
        out = self.folder / "deleted"
        (out / "kind/b.png").unlink()
        (out / "sources.json").write_text("{")
        browser.dvi(PROGRAM, "report", out, "--quiet")
        self.open(out)
        self.assertIn("sources.json is damaged", self.text("#overview"))
        self.assertIn("pictures of 1 of 2 frames are missing", self.text("#overview"))
        self.open(out, "frames/1")
        self.assertIn("kind/b.png", self.text("#receipt"))
        self.no_error(out)
        moved = self.folder / "moved"
        out.rename(moved)
        self.open(moved, "frames/0")
        browser.until(self.driver, "document.querySelector('#picture img') && document.querySelector('#picture img').naturalWidth")
        shutil.rmtree(moved / "report")
        self.open(moved)
        self.assertIn("This report is incomplete", self.text("main"))

    def test_a_result_without_frames_opens(self):
        out = self.folder / "empty"
        (out / ".dvi").mkdir(parents=True)
        browser.dvi(PROGRAM, "report", out, "--quiet")
        for view in ("above", "stages", "frames/3", "overview"):
            self.open(out, view)
            browser.until(self.driver, f"dvi.started.has('{view.split('/')[0]}')")
            self.press(" n")
        self.no_error(out)
        self.assertIn("has no frames yet", self.text("#overview"))
        self.assertIn("not finished", self.text("#overview"))

    def test_a_read_only_result_opens(self):
        out = self.folder / "read only"
        shutil.copytree(self.out, out)
        for part in (out, out / "report"):
            part.chmod(0o555)
        code, message = browser.dvi_without_override(PROGRAM, "report", out, "--quiet")
        self.assertEqual(code, 3)
        self.assertEqual(message.splitlines(), [f"dvi: {out}: cannot be written (Permission denied); copy it to a writable folder for a "
                                                "new report; an existing report.html can be opened where it is"])
        self.open(out, "frames/0")
        browser.until(self.driver, "document.querySelector('#picture img') && document.querySelector('#picture img').naturalWidth")
        self.no_error(out)
        for part in (out, out / "report"):
            part.chmod(0o755)


if __name__ == "__main__":
    unittest.main(verbosity=2)
