#pragma once

#include <unistd.h>

#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>

#include "dvi/core/error.h"
#include "dvi/core/files.h"

namespace dvi::io {

/// A folder of a test's own that goes with it.
class TestFolder {
 public:
  TestFolder() {
    const auto* test = testing::UnitTest::GetInstance()->current_test_info();
    path =
        fs::path(testing::TempDir()) / (std::string(test->test_suite_name()) + "_" + test->name() + std::to_string(getpid()));
    fs::remove_all(path);
    make_folder(path);
  }
  ~TestFolder() { fs::remove_all(path); }
  TestFolder(const TestFolder&) = delete;
  TestFolder& operator=(const TestFolder&) = delete;

  fs::path write(const fs::path& name, const std::string& bytes) const {
    make_folder((path / name).parent_path());
    write_file(path / name, bytes);
    return path / name;
  }
  fs::path write_image(const fs::path& name, const cv::Mat& image) const {
    std::vector<uchar> bytes;
    cv::imencode(name.extension().string(), image, bytes);
    return write(name, std::string(bytes.begin(), bytes.end()));
  }
  /// x y z intensity as float32, four numbers a point.
  fs::path write_bin(const fs::path& name, const std::vector<float>& numbers) const {
    return write(name, std::string(reinterpret_cast<const char*>(numbers.data()), numbers.size() * sizeof(float)));
  }

  fs::path path;
};

/// What the InputError says that this throws; a failure if it throws none.
template <class Body>
std::string input_error(const Body& body) {
  try {
    body();
  } catch (const InputError& e) {
    return e.what();
  }
  ADD_FAILURE() << "no InputError was thrown";
  return {};
}

}  // namespace dvi::io
