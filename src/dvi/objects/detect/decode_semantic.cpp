#include <algorithm>
#include <cmath>
#include <limits>

#include <fmt/format.h>
#include <opencv2/core.hpp>

#include "dvi/image/region.h"
#include "dvi/objects/detect/box_candidates.h"

namespace dvi::objects {
namespace {

// Returns the class of each pixel of the image, -1 if all logits are NaN.
cv::Mat1i find_best_classes(const Tensor& logits, const InputFit& fit) {
  cv::Mat1f best(fit.image, -std::numeric_limits<float>::infinity());
  cv::Mat1i classes(fit.image, -1);
  for (int c = 0; c < logits.planes(); ++c) {
    const cv::Mat1f value = resample_to_image(logits.plane(c), fit, {{0, 0}, fit.image});
    const cv::Mat1b better(value > best);
    value.copyTo(best, better);
    classes.setTo(c, better);
  }
  return classes;
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
    add_detection(out, {type, 1, cv::Mat1b(labels(box) == label), box.tl(), false}, min_pixels);
  }
}

}  // namespace

bool is_class_map(const Tensor& tensor) {
  if (tensor.rank() < 2 || tensor.planes() != 1 || tensor.rows() < 2) return false;
  return std::all_of(tensor.values.begin(), tensor.values.end(), [](float id) { return id == std::floor(id) && id >= 0; });
}

Detections decode_semantic(const std::vector<Tensor>& outputs, const Description& description, const InputFit& fit) {
  const int count = description.class_count();
  const auto has_logits = [&](const Tensor& output) { return output.rank() == 4 && output.planes() == count; };
  const auto found = std::find_if(outputs.begin(), outputs.end(),
                                  [&](const Tensor& output) { return has_logits(output) || is_class_map(output); });
  if (found == outputs.end())
    throw_unexpected_shapes(outputs, description, fmt::format("1x{}xHxW (logits), or 1xHxW (the class of each pixel)", count));
  const cv::Mat1i classes = has_logits(*found) ? find_best_classes(*found, fit) : resample_nearest(found->plane(0), fit);
  Detections out;
  for (int c = 0; c < count; ++c)
    if (description.is_removed(c)) add_parts(out, c, cv::Mat1b(classes == c), description.least_pixels);
  return out;
}

}  // namespace dvi::objects
