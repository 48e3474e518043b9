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

/// How a network's outputs are laid out; decode.h has the shapes.
enum class Layout { semantic, yolov5_seg, yolov8_seg };
constexpr auto names_of(Layout) {
  return std::array{std::pair{Layout::semantic, "semantic"}, std::pair{Layout::yolov5_seg, "yolov5-seg"},
                    std::pair{Layout::yolov8_seg, "yolov8-seg"}};
}

/// How an image is brought to the size of the input. letterbox: with its own aspect, centered on a gray ground.
enum class Fit { letterbox, stretch };
constexpr auto names_of(Fit) { return std::array{std::pair{Fit::letterbox, "letterbox"}, std::pair{Fit::stretch, "stretch"}}; }

/// The order of the input's channels.
enum class Channels { rgb, bgr };
constexpr auto names_of(Channels) { return std::array{std::pair{Channels::rgb, "RGB"}, std::pair{Channels::bgr, "BGR"}}; }

/// What MODEL.toml says of a network: docs/detector.md has every key.
struct Description {
  fs::path model, file;  ///< the network, and what describes it

  cv::Size input;
  Fit fit = Fit::letterbox;
  double pad = 114;  ///< gray of the letterbox's ground, 0..255
  Channels channels = Channels::rgb;
  std::array<double, 3> mean{0, 0, 0}, sigma{255, 255, 255};  ///< input = (gray level - mean) / sigma, as `channels`

  Layout layout = Layout::semantic;
  std::vector<std::string> outputs;  ///< names of those to use; empty: all
  double score = 0.25;               ///< detections below are dropped; not semantic
  double nms = 0.45;                 ///< of two boxes of a class with a larger IoU the better one stays; not semantic
  int least_pixels = 16;             ///< smaller objects are dropped

  std::vector<std::string> classes;  ///< lower case
  std::vector<char> removed;         ///< as `classes`: whether it is traffic
};

/// Reads MODEL.toml, which lies beside MODEL.onnx. InputError where there is none, or it is malformed.
Description read_description(const fs::path& model);

}  // namespace dvi::objects
