#pragma once

#include <cstdlib>
#include <filesystem>
#include <string>

#include <gtest/gtest.h>

namespace dvi {

/// The place of a recording or a file of another program that is too large for the repository: NAME below $DVI_DATA, or below
/// /tmp/dvi-data.
inline std::filesystem::path find_recording(const std::string& name) {
  const char* root = std::getenv("DVI_DATA");
  return std::filesystem::path(root != nullptr ? root : "/tmp/dvi-data") / name;
}

}  // namespace dvi

/// Skips the test where a recording is not there.
#define DVI_SKIP_WITHOUT(path) \
  if (!std::filesystem::exists(path)) GTEST_SKIP() << (path) << " is not there; set DVI_DATA to the recordings"
