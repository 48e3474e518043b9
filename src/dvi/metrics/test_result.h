#pragma once

#include <filesystem>
#include <string>

#include <gtest/gtest.h>

#include <opencv2/core/mat.hpp>

#include "dvi/media/write_image.h"
#include "dvi/metrics/evaluate.h"
#include "dvi/metrics/test_scene.h"
#include "dvi/testing/temp_folder.h"

namespace dvi::metrics {

inline const cv::Size kSize(96, 72);
inline const cv::Rect kHole(30, 20, 40, 30);

inline cv::Mat1b box(const cv::Rect& rect, uchar value = 255) {
  cv::Mat1b mask(kSize, uchar{0});
  mask(rect) = value;
  return mask;
}

/// A result folder with its truth; the folder is removed after the test.
class ResultFixture : public testing::Test {
 protected:
  ResultFixture() {
    for (const char* part : {"out/frames", "out/masks", "out/kind", "truth", "ignore"}) make_folder(folder / part);
  }

  struct ResultFrame {
    cv::Mat3b truth, result;
    cv::Mat1b mask, kind;
  };
  void add(const std::string& name, const ResultFrame& frame) const {
    const std::string file = name + ".png";
    media::write_png(folder / "truth" / file, frame.truth);
    media::write_png(folder / "out/frames" / file, frame.result);
    media::write_png(folder / "out/masks" / file, frame.mask);
    media::write_png(folder / "out/kind" / file, frame.kind);
  }
  void add_perfect(const std::string& name) const {
    add(name, {make_scene(kSize, 0), make_scene(kSize, 0), box(kHole), box(kHole, 1)});
  }
  EvaluationFolders folders() const { return {folder / "out", folder / "truth"}; }
  Evaluation run(bool ignore = false) const {
    return evaluate({folder / "out", folder / "truth", ignore ? folder / "ignore" : fs::path()});
  }
  std::string error(const EvaluationFolders& of) const {
    return input_error([&] { evaluate(of); });
  }
  std::string error() const { return error(folders()); }

  const TempFolder temporary;
  const fs::path folder = temporary.path;
};

}  // namespace dvi::metrics
