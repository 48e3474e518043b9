#include "dvi/objects/label_masks.h"

#include <algorithm>

#include <benchmark/benchmark.h>

namespace dvi::objects {
namespace {

/// The mask of a frame of 1280x720 from the 3D boxes of twelve cars on three lanes, grown.
void mask_of_boxes(benchmark::State& state) {
  Drive drive;
  drive.camera = {1280, 720, 1000, 1000, 639.5, 359.5, {}};
  drive.camera_from_lidar.R << 0, -1, 0, 0, 0, -1, 1, 0, 0;
  drive.frames.resize(1);
  for (int i = 0; i < 12; ++i) {
    Label label;
    label.box = Box{{Eigen::Matrix3d::Identity(), {8.0 + 4 * i, 3.5 * (i % 3 - 1), -1}}, {4.2, 1.8, 1.5}};
    drive.frames[0].labels.push_back(label);
  }
  std::shared_ptr<const cv::Mat1b> mask;
  for (auto _ : state) mask = draw_label_masks(drive, {MaskSource::labels}, shared(drive.labels()), {})[0];
  state.counters["masked"] = static_cast<double>(std::count(mask->begin(), mask->end(), 255));
}
BENCHMARK(mask_of_boxes)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace dvi::objects
