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

// Boxes held against each other: many more than one image has objects.
constexpr int kMostBoxes = 1000;

// The pixels of the image that a box in the input touches.
cv::Rect pixels_of(const cv::Rect2d& box, const InputFit& fit) {
  const cv::Point2d a = fit.in_image(box.tl()), b = fit.in_image(box.br());
  const double width = fit.image.width, height = fit.image.height;
  const cv::Point first(static_cast<int>(std::floor(std::clamp(a.x, 0.0, width))),
                        static_cast<int>(std::floor(std::clamp(a.y, 0.0, height))));
  const cv::Point end(static_cast<int>(std::ceil(std::clamp(b.x, 0.0, width))),
                      static_cast<int>(std::ceil(std::clamp(b.y, 0.0, height))));
  return {first, end};
}

// Boxes of different classes lie side by side, where none suppresses another.
std::vector<int> unsuppressed(const std::vector<BoxCandidate>& candidates, const Description& description,
                              const InputFit& fit) {
  const double apart = 4 * (fit.input.width + fit.input.height);
  std::vector<cv::Rect2d> boxes;
  std::vector<float> scores;
  for (const BoxCandidate& c : candidates) {
    boxes.push_back(c.box + cv::Point2d(apart * c.type, 0));
    scores.push_back(c.score);
  }
  std::vector<int> kept;
  cv::dnn::NMSBoxes(boxes, scores, 0, static_cast<float>(description.nms), kept, 1, kMostBoxes);
  return kept;
}

}  // namespace

int best_class(const float* values, int count, std::ptrdiff_t step) {
  int best = -1;
  for (int c = 0; c < count; ++c)
    if (const float value = values[c * step]; std::isfinite(value) && (best < 0 || value > values[best * step])) best = c;
  return best;
}

void keep(Detections& detections, int type, float score, const cv::Mat1b& mask, cv::Point corner, int least_pixels) {
  if (mask.empty() || cv::countNonZero(mask) < least_pixels) return;
  const cv::Rect box = cv::boundingRect(mask);
  detections.push_back({type, score, box + corner, mask(box).clone()});
}

Detections with_masks(const std::vector<BoxCandidate>& candidates, const cv::Mat& prototypes, const Description& description,
                      const InputFit& fit) {
  const int count = prototypes.size[1], rows = prototypes.size[2], cols = prototypes.size[3];
  const cv::Mat1f flat(count, rows * cols, const_cast<float*>(prototypes.ptr<float>()));
  Detections out;
  for (const int i : unsuppressed(candidates, description, fit)) {
    const BoxCandidate& candidate = candidates[static_cast<std::size_t>(i)];
    const cv::Rect part = pixels_of(candidate.box, fit);
    if (part.empty()) continue;
    const cv::Mat1f weights(1, count, const_cast<float*>(candidate.coefficients.data()));
    const cv::Mat1f logits = cv::Mat1f(weights * flat).reshape(1, rows);
    keep(out, candidate.type, candidate.score, cv::Mat1b(map_in_image(logits, fit, part) > 0), part.tl(),
         description.least_pixels);
  }
  return out;
}

void refuse_shapes(const std::vector<cv::Mat>& outputs, const Description& description, const std::string& expected) {
  throw InputError(description.model,
                   fmt::format("its outputs are {}, and kind \"{}\" with {} classes expects {}", shapes_of(outputs),
                               to_string(description.layout), description.classes.size(), expected),
                   fmt::format("correct 'kind', 'names' or the classes in {}, or export it as docs/detector.md says",
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
