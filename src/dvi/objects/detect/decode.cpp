#include "dvi/objects/detect/decode.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "dvi/core/error.h"
#include "dvi/objects/detect/box_candidates.h"

namespace dvi::objects {
namespace {

constexpr const char* kKnownLayouts =
    "dvi reads the outputs of YOLOv5 to YOLO26, RT-DETR, DETR, Mask R-CNN, and semantic networks (docs/detector.md lists the "
    "shapes)";

// Returns whether the sixth numbers of the rows are classes. In a layout with one score per class they are not whole.
bool has_class_numbers(const Tensor& rows, int classes) {
  for (int i = 0; i < rows.rows(); ++i)
    if (const float type = rows.row(i)[5]; type != std::floor(type) || type < 0 || type >= static_cast<float>(classes))
      return false;
  return true;
}

// Recognizes the layout of rows: of 4 + classes, 5 + classes, or 6 numbers, each with the coefficients of the prototypes.
Layout recognize_rows(const Tensor& rows, int coefficients, int classes) {
  if (coefficients == 0 && rows.rank() == 2 && rows.cols() == 7) return Layout::nms;
  if (rows.rank() != 3) return Layout::automatic;
  const int across = rows.cols() - coefficients, along = rows.rows() - coefficients;
  if (across == 6 && has_class_numbers(rows, classes)) return Layout::nms;
  if (across == 5 + classes) return Layout::yolov5;
  if (along == 4 + classes) return Layout::yolov8;
  return across == 4 + classes && coefficients == 0 ? Layout::detr : Layout::automatic;
}

bool is_semantic(const Tensor& tensor, int classes) {
  return (tensor.rank() == 4 && tensor.planes() == classes && classes > 1) ||
         (tensor.has_whole_numbers && is_class_map(tensor));
}

[[noreturn]] void throw_unknown(const std::vector<Tensor>& outputs, const Description& description) {
  const bool classifies = outputs.size() == 1 && outputs.front().rank() <= 2 && outputs.front().rows() == 1;
  const std::string shapes = format_shapes(outputs);
  if (classifies)
    throw InputError(description.model,
                     fmt::format("is a classifier: its output is {}, which does not show where objects are", shapes),
                     "give a network for detection or segmentation");
  throw InputError(
      description.model, fmt::format("its outputs are unknown: {}, with {} classes", shapes, description.class_count()),
      fmt::format("{}; if it is one of these, correct the classes, or set 'kind' and 'names' in [output] of MODEL.toml",
                  kKnownLayouts));
}

[[noreturn]] void throw_unnamed(const std::vector<Tensor>& outputs, const Description& description) {
  throw InputError(description.model,
                   fmt::format("has no names of its classes in its metadata; its outputs are {}", format_shapes(outputs)),
                   fmt::format("write them into {}: [classes] and names = [\"person\", \"car\", ...], or names = \"COCO\"",
                               fs::path(description.model).replace_extension(".toml").filename().string()));
}

}  // namespace

Layout recognize_layout(const std::vector<Tensor>& outputs, const Description& description) {
  const int classes = description.class_count();
  const Tensor* map = find_only_map(outputs);
  const Tensor* rows = find_only_rows(outputs);
  if (outputs.size() == 1 && !map && rows && rows->rows() == 1 && rows->rank() == 2) throw_unknown(outputs, description);
  if (classes == 0) throw_unnamed(outputs, description);
  if (find_rcnn_outputs(outputs).boxes) return Layout::rcnn;
  if (find_detr_outputs(outputs, classes).logits && !map) return Layout::detr;
  if (is_undecoded_yolov8(outputs, description)) return Layout::yolov8;
  if (rows && outputs.size() == (map ? 2U : 1U)) {
    const Layout layout = recognize_rows(*rows, map ? map->planes() : 0, classes);
    if (layout != Layout::automatic) return layout;
  }
  const bool is_segmentation =
      std::any_of(outputs.begin(), outputs.end(), [&](const Tensor& tensor) { return is_semantic(tensor, classes); });
  if (is_segmentation) return Layout::semantic;
  throw_unknown(outputs, description);
}

void throw_unexpected_shapes(const std::vector<Tensor>& outputs, const Description& description, const std::string& expected) {
  throw InputError(description.model,
                   fmt::format("its outputs are {}, and kind \"{}\" with {} classes expects {}", format_shapes(outputs),
                               to_string(description.layout), description.class_count(), expected),
                   "correct 'kind', 'names', or the classes in MODEL.toml, or export it as docs/detector.md describes");
}

Detections decode(const std::vector<Tensor>& outputs, const Description& description, const InputFit& fit) {
  switch (description.layout) {
    case Layout::semantic:
      return decode_semantic(outputs, description, fit);
    case Layout::yolov5:
      return decode_yolov5(outputs, description, fit);
    case Layout::yolov8:
      return decode_yolov8(outputs, description, fit);
    case Layout::nms:
      return decode_nms(outputs, description, fit);
    case Layout::detr:
      return decode_detr(outputs, description, fit);
    case Layout::rcnn:
      return decode_rcnn(outputs, description, fit);
    case Layout::automatic:
      break;
  }
  Description recognized = description;
  recognized.layout = recognize_layout(outputs, description);
  return decode(outputs, recognized, fit);
}

}  // namespace dvi::objects
