#!/usr/bin/env python3
"""Tests of the constants of the quality benchmark."""
import re
import subprocess
import tempfile
import unittest
from pathlib import Path

import constants
from constants import Unknown

TREE = Path(__file__).resolve().parent.parent

SHADOWS = """namespace dvi::objects {
namespace {

struct ShadowParams {
  /// Seconds, earlier and later.
  std::array<double, 3> offsets_s{0.3, 0.5, 0.7};
  int blur_px = 3;  ///< shadows are large
  std::size_t max_bytes = std::size_t{192} << 20;
};
constexpr ShadowParams kShadows{};

struct Shadow {
  double area_px = 0;
};

constexpr double kHalfWidthM = 2, kLengthM = 1.0 / 3;  // extent of a shadow
inline constexpr int kSteps[] = {1, 2, 4};
constexpr double kAreaM2 = kHalfWidthM * kLengthM;
constexpr int kBlur = kShadows.blur_px;
constexpr const char* kName = "shadow";
"""
FILE = Path("src/dvi/objects/shadows.cpp")


def names(found):
    return [(constant.name, constant.value, constant.comment) for constant in found]


class Parsing(unittest.TestCase):
    def test_fields_of_parameters_and_literals_are_found(self):
        self.assertEqual(names(constants.parse_file(FILE, SHADOWS)), [
            ("ShadowParams.offsets_s", "{0.3, 0.5, 0.7}", ""),
            ("ShadowParams.blur_px", "3", "shadows are large"),
            ("ShadowParams.max_bytes", "std::size_t{192} << 20", ""),
            ("kHalfWidthM", "2", "extent of a shadow"),
            ("kLengthM", "1.0 / 3", "extent of a shadow"),
            ("kSteps", "{1, 2, 4}", ""),
        ])

    def test_a_change_replaces_the_value_only(self):
        found = {constant.name: constant for constant in constants.parse_file(FILE, SHADOWS)}
        for name, value, before, after in (("ShadowParams.blur_px", "5", "blur_px = 3;", "blur_px = 5;"),
                                           ("ShadowParams.offsets_s", "{1,2,3}", "{0.3, 0.5, 0.7}", "{1,2,3}"),
                                           ("kHalfWidthM", "7", "kHalfWidthM = 2,", "kHalfWidthM = 7,")):
            self.assertEqual(constants.Change(found[name], value).apply(SHADOWS), SHADOWS.replace(before, after))

    def test_names_are_resolved_or_refused_with_a_remedy(self):
        road = Path("src/dvi/ground/road.h")
        known = constants.parse_file(FILE, SHADOWS) + constants.parse_file(road, "constexpr int kHalfWidthM = 4;\n")
        self.assertEqual(constants.parse_change("ShadowParams.blur_px=5", known).label, "objects::ShadowParams.blur_px=5")
        self.assertEqual(constants.parse_change("objects::ShadowParams.offsets_s={1, 2, 3}", known).value, "{1,2,3}")
        self.assertEqual(constants.parse_change("ground::kHalfWidthM=5", known).constant.file, road)
        for text, message in (("ShadowParams.blur=5", "closest: objects::ShadowParams.blur_px"),
                              ("object::kSteps=5", "closest: objects::kSteps"),
                              ("Nothing.like_it=5", "see --list-constants"),
                              ("kHalfWidthM=5", r"ambiguous: objects::kHalfWidthM \(.*:16\), ground::kHalfWidthM \(.*road.h:1\)"),
                              ("ShadowParams.blur_px=3", "the present value"),
                              ("ShadowParams.blur_px", "expected"), ("kLengthM=1/2", "expected"), ("kLengthM=1;int x", "expected")):
            with self.assertRaisesRegex(Unknown, message, msg=text):
                constants.parse_change(text, known)


class ThisTree(unittest.TestCase):
    def test_every_field_of_the_parameters_has_a_name_of_its_own(self):
        found = constants.find(TREE)
        labels = [constant.label for constant in found]
        self.assertEqual(len(labels), len(set(labels)), "a constant that cannot be addressed")
        for module in constants.MODULES:
            for file in [file for kind in ("h", "cpp") for file in (TREE / "src/dvi" / module).rglob(f"*.{kind}")]:
                for name, body in re.findall(r"struct (\w+Params) \{(.*?)\n\s*\};", file.read_text(), re.DOTALL):
                    fields = re.sub("//.*", "", body).count(";")
                    self.assertEqual(sum(label.startswith(f"{module}::{name}.") for label in labels), fields, name)


class Building(unittest.TestCase):
    def setUp(self):
        folder = Path(self.enterContext(tempfile.TemporaryDirectory()))
        self.tree, self.work = folder / "tree", folder / "tree/build/bench/constants"
        for name, text in {
            "CMakeLists.txt": "cmake_minimum_required(VERSION 3.25)\nproject(small CXX)\n"
                              "add_executable(dvi src/dvi/objects/main.cpp)\n"
                              "set_target_properties(dvi PROPERTIES RUNTIME_OUTPUT_DIRECTORY ${CMAKE_BINARY_DIR}/bin)\n",
            "CMakePresets.json": '{"version": 6, "configurePresets": [{"name": "release", "generator": "Ninja",'
                                 ' "binaryDir": "${sourceDir}/build/release"}]}',
            "src/dvi/objects/main.cpp": '#include "params.h"\n#include <iostream>\n'
                                        "int main() { std::cout << SmallParams{}.size + kOffset; }\n",
            "src/dvi/objects/params.h": "struct SmallParams {\n  int size = 3;\n};\nconstexpr int kOffset = 10;\n",
        }.items():
            (self.tree / name).parent.mkdir(parents=True, exist_ok=True)
            (self.tree / name).write_text(text)

    def change(self, text):
        return constants.parse_change(text, constants.find(self.tree))

    def test_each_change_is_built_alone(self):
        programs = [constants.build(self.tree, self.work, self.change(text)) for text in ("SmallParams.size=4", "kOffset=20")]
        self.assertEqual([subprocess.check_output([program], text=True) for program in programs], ["14", "23"])
        self.assertIn("size = 3;", (self.tree / "src/dvi/objects/params.h").read_text())
        with self.assertRaisesRegex(constants.NotBuilt, "SmallParams.size=word does not compile: .*word"):
            constants.build(self.tree, self.work, self.change("SmallParams.size=word"))

    def test_equal_files_are_not_written_again_and_old_ones_are_removed(self):
        copy = self.work / "tree"
        constants.copy_tree(self.tree, copy, self.change("kOffset=20"))
        before = (copy / "src/dvi/objects/main.cpp").stat().st_mtime_ns
        (copy / "src/dvi/objects/old.h").touch()
        (copy / "build").mkdir()
        (copy / "build/object").touch()
        constants.copy_tree(self.tree, copy, self.change("SmallParams.size=4"))
        self.assertEqual((copy / "src/dvi/objects/main.cpp").stat().st_mtime_ns, before)
        self.assertEqual((copy / "src/dvi/objects/params.h").read_text(),
                         "struct SmallParams {\n  int size = 4;\n};\nconstexpr int kOffset = 10;\n")
        self.assertFalse((copy / "src/dvi/objects/old.h").exists())
        self.assertTrue((copy / "build/object").exists())


if __name__ == "__main__":
    unittest.main()
