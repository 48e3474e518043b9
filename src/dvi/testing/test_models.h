#pragma once

#include <cstdlib>
#include <string>

#include <gtest/gtest.h>

#include "dvi/testing/temp_folder.h"

namespace dvi {

/// Writes the networks of test_models.py to a folder. Returns false if no Python with onnx is installed.
inline bool make_test_models(const fs::path& folder) {
  for (const char* python : {"python3", "/usr/bin/python3"}) {
    const std::string interpreter = python;
    if (std::system((interpreter + " -c 'import onnx' 2>/dev/null").c_str()) != 0) continue;
    const std::string command = interpreter + " -B " + DVI_TEST_MODELS + " " + folder.string();
    EXPECT_EQ(std::system(command.c_str()), 0) << command;
    return true;
  }
  return false;
}

/// Returns the TOML description of such a network.
inline std::string test_description(const std::string& kind, const std::string& input_more = "",
                                    const std::string& output_more = "") {
  const std::string first = kind == "semantic" ? "\"street\", " : "";
  return "[input]\nsize = [64, 64]\n" + input_more + "\n[output]\nkind = \"" + kind + "\"\n" + output_more +
         "\n[classes]\nnames = [" + first + "\"Car\", \"person\"]\n";
}

}  // namespace dvi
