#!/usr/bin/env python3
"""The include check itself, on trees made for it."""
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

PROJECT = Path(__file__).resolve().parent.parent


def run(root):
    done = subprocess.run([sys.executable, PROJECT / "tools/check_layers.py", root], capture_output=True, text=True)
    return done.returncode, done.stdout


class CheckLayers(unittest.TestCase):
    def check(self, **files):
        """Runs the check on a tree of FOLDER__NAME_EXT="dvi/included.h" files; included files exist."""
        with tempfile.TemporaryDirectory() as folder:
            source = Path(folder) / "src"
            (Path(folder) / "ARCHITECTURE.md").write_text((PROJECT / "ARCHITECTURE.md").read_text(encoding="utf-8"), encoding="utf-8")
            for key, included in files.items():
                name = "dvi/" + key.replace("__", "/").replace("_DOT_", ".")
                for path in [name, included]:
                    (source / path).parent.mkdir(parents=True, exist_ok=True)
                if included.startswith("dvi/"):
                    (source / included).touch()
                with (source / name).open("a", encoding="utf-8") as out:
                    out.write(f'#include "{included}"\n')
            return run(folder)

    def assert_fails(self, reason, **files):
        code, output = self.check(**files)
        self.assertEqual(code, 1, output)
        self.assertIn(reason, output)

    def assert_passes(self, **files):
        code, output = self.check(**files)
        self.assertEqual(code, 0, output)

    def test_downwards_and_sideways_pass(self):
        self.assert_passes(sample__a_DOT_h="dvi/drive/view.h", sample__b_DOT_cpp="dvi/sample/a.h")
        self.assert_passes(run__a_DOT_cpp="dvi/sample/sample.h", cli__a_DOT_cpp="dvi/run/run.h")

    def test_upwards_fails_and_names_the_line(self):
        self.assert_fails("src/dvi/core/a.h:1: must not include \"dvi/drive/view.h\"", core__a_DOT_h="dvi/drive/view.h")
        self.assert_fails("media may include", media__a_DOT_cpp="dvi/objects/masks.h")
        self.assert_fails("run may include", run__a_DOT_cpp="dvi/synth/street.h")
        self.assert_fails("metrics may include", metrics__a_DOT_cpp="dvi/synth/street.h")
        self.assert_fails("metrics may include", metrics__a_DOT_cpp="dvi/holdout/holdout.h")

    def test_an_earlier_stage_is_known_by_its_types_only(self):
        self.assert_passes(sample__a_DOT_h="dvi/depth/depth_map.h")
        self.assert_fails("only its types", sample__a_DOT_cpp="dvi/depth/delaunay.h")

    def test_a_later_stage_is_unknown(self):
        self.assert_fails("runs after", depth__a_DOT_cpp="dvi/sample/candidates.h")

    def test_only_tests_of_stages_may_use_the_synthetic_street(self):
        self.assert_passes(depth__a_test_DOT_cpp="dvi/synth/street.h")
        self.assert_fails("depth may include", depth__a_DOT_cpp="dvi/synth/street.h")

    def test_heavy_headers_stay_out_of_headers(self):
        for heavy in ["CLI/CLI.hpp", "toml++/toml.h", "nlohmann/json.hpp", "opencv2/imgproc.hpp", "libavcodec/avcodec.h"]:
            self.assert_fails("is heavy", media__a_DOT_h=heavy)
            self.assert_passes(media__a_DOT_cpp=heavy)
        self.assert_passes(media__a_DOT_h="opencv2/core/mat.hpp")
        self.assert_passes(media__test_scan_DOT_h="opencv2/imgcodecs.hpp")

    def test_links_in_cmake_are_compared(self):
        with tempfile.TemporaryDirectory() as folder:
            module = Path(folder) / "src/dvi/media"
            module.mkdir(parents=True)
            (Path(folder) / "ARCHITECTURE.md").write_text((PROJECT / "ARCHITECTURE.md").read_text(encoding="utf-8"), encoding="utf-8")
            (module / "CMakeLists.txt").write_text("dvi_module(media PUBLIC dvi::drive)\n")
            self.assertEqual(run(folder)[0], 0)
            (module / "CMakeLists.txt").write_text("dvi_module(media PUBLIC dvi::run)\n")
            self.assertIn("must not link dvi::run", run(folder)[1])

    def test_unknown_modules_and_missing_headers_fail(self):
        self.assert_fails("no place in the layer table", attic__a_DOT_h="vector")
        self.assert_fails("there is no module", media__a_DOT_h="dvi/attic/a.h")


if __name__ == "__main__":
    unittest.main()
