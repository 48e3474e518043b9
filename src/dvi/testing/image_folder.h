#pragma once

#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>

#include "dvi/testing/temp_folder.h"

namespace dvi {

/// A temporary folder to which a test writes images and scans.
class TestFolder : public TempFolder {
 public:
  fs::path write_image(const fs::path& name, const cv::Mat& image) const {
    std::vector<uchar> bytes;
    cv::imencode(name.extension().string(), image, bytes);
    return write(name, std::string(bytes.begin(), bytes.end()));
  }
  /// Writes points as float32 x, y, z, and intensity.
  fs::path write_bin(const fs::path& name, const std::vector<float>& numbers) const {
    return write(name, std::string(reinterpret_cast<const char*>(numbers.data()), numbers.size() * sizeof(float)));
  }
};

}  // namespace dvi
