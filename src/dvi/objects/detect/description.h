#pragma once

#include <array>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include <opencv2/core/types.hpp>

#include "dvi/core/files.h"
#include "dvi/core/named.h"
#include "dvi/objects/detect/onnx_file.h"

namespace dvi::objects {

using dvi::to_string;

/// The layout of a network's outputs; decode.h defines the shapes. automatic: recognized by the shapes.
enum class Layout { automatic, semantic, yolov5, yolov8, nms, detr, rcnn };
constexpr auto names_of(Layout) {
  return std::array{std::pair{Layout::automatic, "auto"}, std::pair{Layout::semantic, "semantic"},
                    std::pair{Layout::yolov5, "yolov5"},  std::pair{Layout::yolov8, "yolov8"},
                    std::pair{Layout::nms, "nms"},        std::pair{Layout::detr, "detr"},
                    std::pair{Layout::rcnn, "rcnn"}};
}

/// How an image is fitted into the input. letterbox: with its own aspect ratio, centered on a gray background. stretch: to the
/// whole input.
enum class Fit { letterbox, stretch };
constexpr auto names_of(Fit) { return std::array{std::pair{Fit::letterbox, "letterbox"}, std::pair{Fit::stretch, "stretch"}}; }

/// The order of the channels of the input.
enum class Channels { rgb, bgr };
constexpr auto names_of(Channels) { return std::array{std::pair{Channels::rgb, "RGB"}, std::pair{Channels::bgr, "BGR"}}; }

/// The description of a network: its declarations, the metadata of its exporter, and MODEL.toml, of which the later replace the
/// former. docs/detector.md explains every key.
struct Description {
  fs::path model;
  std::vector<fs::path> files;  ///< the network and all files that were read with it

  cv::Size input;  ///< empty: the size of each image, rounded up to whole strides
  Fit fit = Fit::letterbox;
  double pad = 114;  ///< gray level of the background of the letterbox, 0..255
  Channels channels = Channels::rgb;
  std::array<double, 3> mean{0, 0, 0},
      sigma{255, 255, 255};  ///< input = (gray level - mean) / sigma, per channel in the order of `channels`

  Layout layout = Layout::automatic;
  std::vector<std::string> outputs;  ///< names of the outputs to use; empty: all
  double score = 0.25;               ///< detections with a smaller score are dropped; unused by semantic
  double nms = 0.45;      ///< IoU of two boxes of a class above which the better one suppresses the other; unused by semantic
  int least_pixels = 16;  ///< smaller objects are dropped

  std::vector<std::string> classes;           ///< lower case; empty: unknown
  std::set<std::string, std::less<>> chosen;  ///< names of the classes that MODEL.toml removes; empty: those of traffic
  std::vector<char> removed;                  ///< per class, whether it is removed

  int class_count() const { return static_cast<int>(classes.size()); }
  bool is_removed(int type) const { return type >= 0 && type < class_count() && removed[static_cast<std::size_t>(type)] != 0; }
};

/// Describes a network by its declarations, its metadata, config.json and preprocessor_config.json beside it (Hugging Face),
/// and MODEL.toml beside it. Throws InputError if a file is malformed, if the network does not take one image, or if no class
/// is removed.
Description describe_network(const OnnxFile& file);

/// Adds the metadata that exporters write: into the network (Ultralytics), or beside it (Hugging Face).
void add_exporter_metadata(const OnnxFile& file, Description& out);

/// Adds the keys of MODEL.toml. Throws InputError, with file and line, if it is malformed.
void add_model_toml(const fs::path& toml, Description& out);

/// Returns the classes of a data set whose name a MODEL.toml may give: "COCO" (80 classes), "COCO-91" (with the background and
/// the unused numbers, as in torchvision), or "Cityscapes" (19 classes). Returns an empty list for other names.
std::vector<std::string> list_known_classes(const std::string& data_set);

/// Removes the classes of these names, in lower case. Throws InputError if the network has none of them.
void choose_classes(const std::set<std::string, std::less<>>& names, Description& out);

}  // namespace dvi::objects
