#include "dvi/objects/detect/decode.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <opencv2/dnn.hpp>
#include <opencv2/imgproc.hpp>

#include "dvi/core/error.h"
#include "dvi/objects/detect/box_candidates.h"
#include "dvi/objects/detect/network.h"

namespace dvi::objects {
namespace {

constexpr int kMaxBoxes = 1000;  // in non-maximum suppression: many more than an image has objects

// Returns the pixels of the image that a box in the input touches.
cv::Rect to_image_pixels(const cv::Rect2d& box, const InputFit& fit) {
  const cv::Point2d a = fit.to_image(box.tl()), b = fit.to_image(box.br());
  const double width = fit.image.width, height = fit.image.height;
  const cv::Point first(static_cast<int>(std::floor(std::clamp(a.x, 0.0, width))),
                        static_cast<int>(std::floor(std::clamp(a.y, 0.0, height))));
  const cv::Point end(static_cast<int>(std::ceil(std::clamp(b.x, 0.0, width))),
                      static_cast<int>(std::ceil(std::clamp(b.y, 0.0, height))));
  return {first, end};
}

// Returns the indices of candidates that no better one of their class suppresses. The boxes of each class are moved to another
// area, so that they do not suppress those of other classes.
std::vector<int> suppress_non_maxima(const std::vector<BoxCandidate>& candidates, const Description& description,
                                     const InputFit& fit) {
  const double class_offset = 4 * (fit.input.width + fit.input.height);
  std::vector<cv::Rect2d> boxes;
  std::vector<float> scores;
  for (const BoxCandidate& c : candidates) {
    boxes.push_back(c.box + cv::Point2d(class_offset * c.type, 0));
    scores.push_back(c.score);
  }
  std::vector<int> kept;
  cv::dnn::NMSBoxes(boxes, scores, 0, static_cast<float>(description.nms), kept, 1, kMaxBoxes);
  return kept;
}

}  // namespace

int find_best_class(const float* values, int count, std::ptrdiff_t step) {
  int best = -1;
  for (int c = 0; c < count; ++c)
    if (const float value = values[c * step]; std::isfinite(value) && (best < 0 || value > values[best * step])) best = c;
  return best;
}

void add_detection(Detections& detections, const DetectedPart& part, int min_pixels) {
  if (part.mask.empty() || cv::countNonZero(part.mask) < min_pixels) return;
  const cv::Rect box = cv::boundingRect(part.mask);
  detections.push_back({part.type, part.score, box + part.corner, part.mask(box).clone()});
}

Detections draw_candidates(const std::vector<BoxCandidate>& candidates, const cv::Mat& prototypes,
                           const Description& description, const InputFit& fit) {
  const int count = prototypes.size[1], rows = prototypes.size[2], cols = prototypes.size[3];
  const cv::Mat1f flat(count, rows * cols, const_cast<float*>(prototypes.ptr<float>()));
  Detections out;
  for (const int i : suppress_non_maxima(candidates, description, fit)) {
    const BoxCandidate& candidate = candidates[static_cast<std::size_t>(i)];
    const cv::Rect part = to_image_pixels(candidate.box, fit);
    if (part.empty()) continue;
    const cv::Mat1f weights(1, count, const_cast<float*>(candidate.coefficients.data()));
    const cv::Mat1f logits = cv::Mat1f(weights * flat).reshape(1, rows);
    const cv::Mat1b mask(resample_to_image(logits, fit, part) > 0);
    add_detection(out, {candidate.type, candidate.score, mask, part.tl()}, description.least_pixels);
  }
  return out;
}

void throw_unexpected_shapes(const std::vector<cv::Mat>& outputs, const Description& description, const std::string& expected) {
  throw InputError(description.model,
                   fmt::format("its outputs are {}, and kind \"{}\" with {} classes expects {}", format_shapes(outputs),
                               to_string(description.layout), description.classes.size(), expected),
                   fmt::format("correct 'kind', 'names', or the classes in {}, or export it as docs/detector.md describes",
                               description.file.filename().string()));
}

Detections decode(const std::vector<cv::Mat>& outputs, const Description& description, const InputFit& fit) {
  switch (description.layout) {
    case Layout::semantic:
      return decode_semantic(outputs, description, fit);
    case Layout::yolov5_seg:
      return decode_yolov5(outputs, description, fit);
    case Layout::yolov8_seg:
      break;
  }
  return decode_yolov8(outputs, description, fit);
}

}  // namespace dvi::objects
