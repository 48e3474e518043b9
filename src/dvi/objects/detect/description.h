#pragma once

#include <array>
#include <string>
#include <utility>
#include <vector>

#include <opencv2/core/types.hpp>

#include "dvi/core/files.h"
#include "dvi/core/named.h"

namespace dvi::objects {

using dvi::to_string;

/// The layout of a network's outputs; decode.h defines the shapes.
enum class Layout { semantic, yolov5_seg, yolov8_seg };
constexpr auto names_of(Layout) {
  return std::array{std::pair{Layout::semantic, "semantic"}, std::pair{Layout::yolov5_seg, "yolov5-seg"},
                    std::pair{Layout::yolov8_seg, "yolov8-seg"}};
}

/// How an image is fitted into the input. letterbox: with its own aspect ratio, centered on a gray background. stretch: to the
/// whole input.
enum class Fit { letterbox, stretch };
constexpr auto names_of(Fit) { return std::array{std::pair{Fit::letterbox, "letterbox"}, std::pair{Fit::stretch, "stretch"}}; }

/// The order of the channels of the input.
enum class Channels { rgb, bgr };
constexpr auto names_of(Channels) { return std::array{std::pair{Channels::rgb, "RGB"}, std::pair{Channels::bgr, "BGR"}}; }

/// The description of a network in MODEL.toml. docs/detector.md explains every key.
struct Description {
  fs::path model, file;  ///< the network, and its description

  cv::Size input;
  Fit fit = Fit::letterbox;
  double pad = 114;  ///< gray level of the background of the letterbox, 0..255
  Channels channels = Channels::rgb;
  std::array<double, 3> mean{0, 0, 0},
      sigma{255, 255, 255};  ///< input = (gray level - mean) / sigma, per channel in the order of `channels`

  Layout layout = Layout::semantic;
  std::vector<std::string> outputs;  ///< names of the outputs to use; empty: all
  double score = 0.25;               ///< detections with a smaller score are dropped; unused by semantic
  double nms = 0.45;      ///< IoU of two boxes of a class above which the better one suppresses the other; unused by semantic
  int least_pixels = 16;  ///< smaller objects are dropped

  std::vector<std::string> classes;  ///< lower case
  std::vector<char> removed;         ///< per class, whether it is removed
};

/// Reads MODEL.toml beside MODEL.onnx. Throws InputError if it is missing or malformed.
Description read_description(const fs::path& model);

}  // namespace dvi::objects
