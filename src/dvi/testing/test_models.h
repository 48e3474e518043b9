#pragma once

#include <cstdlib>
#include <string>

#include <gtest/gtest.h>

#include "dvi/testing/temp_folder.h"

namespace dvi {

/// Writes the networks of test_models.py to a folder, for a version of ONNX's operators. Returns false if no Python with onnx
/// is installed.
inline bool make_test_models(const fs::path& folder, int opset = 12) {
  for (const char* python : {"python3", "/usr/bin/python3"}) {
    const std::string interpreter = python;
    if (std::system((interpreter + " -c 'import onnx' 2>/dev/null").c_str()) != 0) continue;
    const std::string command = interpreter + " -B " + DVI_TEST_MODELS + " " + folder.string() + " " + std::to_string(opset);
    EXPECT_EQ(std::system(command.c_str()), 0) << command;
    return true;
  }
  return false;
}

/// Returns a MODEL.toml with the names of the classes of such a network: with a class of the background for semantic networks
/// and for Mask R-CNN.
inline std::string test_description(bool has_background, const std::string& input = "", const std::string& output = "") {
  const std::string first = has_background ? "\"street\", " : "";
  return "[input]\n" + input + "\n[output]\n" + output + "\n[classes]\nnames = [" + first + "\"Car\", \"person\"]\n";
}

}  // namespace dvi
