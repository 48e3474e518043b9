#include <algorithm>
#include <cmath>
#include <limits>

#include <fmt/format.h>
#include <opencv2/core.hpp>

#include "dvi/image/region.h"
#include "dvi/objects/detect/box_candidates.h"

namespace dvi::objects {
namespace {

cv::Mat1f view_plane(const cv::Mat& blob, int plane) {
  const int rows = blob.size[blob.dims - 2], cols = blob.size[blob.dims - 1];
  const auto offset = static_cast<std::size_t>(plane) * static_cast<std::size_t>(rows) * static_cast<std::size_t>(cols);
  return {rows, cols, const_cast<float*>(blob.ptr<float>()) + offset};
}

// Returns the class of each pixel of the image, -1 if all logits are NaN.
cv::Mat1i find_best_classes(const cv::Mat& logits, const InputFit& fit) {
  cv::Mat1f best(fit.image, -std::numeric_limits<float>::infinity());
  cv::Mat1i classes(fit.image, -1);
  for (int c = 0; c < logits.size[1]; ++c) {
    const cv::Mat1f value = resample_to_image(view_plane(logits, c), fit, {{0, 0}, fit.image});
    const cv::Mat1b better(value > best);
    value.copyTo(best, better);
    classes.setTo(c, better);
  }
  return classes;
}

// Returns whether an output is the class of each pixel. Other outputs may have such a shape, but not whole numbers.
bool is_class_map(const cv::Mat& blob) {
  const bool plane =
      blob.dims == 2 || (blob.dims == 3 && blob.size[0] == 1) || (blob.dims == 4 && blob.size[0] == 1 && blob.size[1] == 1);
  if (!plane || blob.empty()) return false;
  const cv::Mat1f ids = view_plane(blob, 0);
  return ids.rows > 1 && std::all_of(ids.begin(), ids.end(), [](float id) { return id == std::floor(id) && id >= 0; });
}

// Resamples a class map to the image. Classes cannot be interpolated, so each pixel takes the nearest one.
cv::Mat1i resample_nearest(const cv::Mat1f& ids, const InputFit& fit) {
  const auto cell = [](double in_input, int count, int input) {
    return std::clamp(static_cast<int>(in_input * count / input), 0, count - 1);
  };
  cv::Mat1i out(fit.image);
  for (int y = 0; y < out.rows; ++y) {
    const int row = cell((y + 0.5) * fit.scale.y + fit.offset.y, ids.rows, fit.input.height);
    for (int x = 0; x < out.cols; ++x)
      out(y, x) = cvRound(ids(row, cell((x + 0.5) * fit.scale.x + fit.offset.x, ids.cols, fit.input.width)));
  }
  return out;
}

// Adds the 4-connected parts of a mask, in raster order of their first pixels.
void add_parts(Detections& out, int type, const cv::Mat1b& mask, int min_pixels) {
  cv::Mat1i labels;
  std::vector<cv::Rect> boxes(static_cast<std::size_t>(label_connected_parts(mask, labels)));
  std::vector<int> order;
  for (int y = 0; y < labels.rows; ++y)
    for (int x = 0; x < labels.cols; ++x) {
      if (labels(y, x) == 0) continue;
      cv::Rect& box = boxes[static_cast<std::size_t>(labels(y, x) - 1)];
      if (box.empty()) order.push_back(labels(y, x));
      box |= cv::Rect(x, y, 1, 1);
    }
  for (const int label : order) {
    const cv::Rect& box = boxes[static_cast<std::size_t>(label - 1)];
    add_detection(out, {type, 1, cv::Mat1b(labels(box) == label), box.tl()}, min_pixels);
  }
}

}  // namespace

Detections decode_semantic(const std::vector<cv::Mat>& outputs, const Description& description, const InputFit& fit) {
  const int count = static_cast<int>(description.classes.size());
  bool found = false;
  cv::Mat1i classes;
  for (const cv::Mat& output : outputs) {
    if (found) break;
    const bool logits = output.dims == 4 && output.size[0] == 1 && output.size[1] == count && !output.empty();
    if (!logits && !is_class_map(output)) continue;
    found = true;
    classes = logits ? find_best_classes(output, fit) : resample_nearest(view_plane(output, 0), fit);
  }
  if (!found)
    throw_unexpected_shapes(outputs, description, fmt::format("1x{}xHxW (logits), or 1xHxW (the class of each pixel)", count));
  Detections out;
  for (int c = 0; c < count; ++c)
    if (description.removed[static_cast<std::size_t>(c)] != 0)
      add_parts(out, c, cv::Mat1b(classes == c), description.least_pixels);
  return out;
}

}  // namespace dvi::objects
