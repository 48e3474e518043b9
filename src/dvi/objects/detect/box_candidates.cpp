#include "dvi/objects/detect/box_candidates.h"

#include <algorithm>
#include <cmath>

#include <opencv2/dnn.hpp>
#include <opencv2/imgproc.hpp>

namespace dvi::objects {
namespace {

constexpr int kMaxBoxes = 1000;  // in non-maximum suppression: many more than an image has objects

const Tensor* find_only(const std::vector<Tensor>& outputs, int rank) {
  const Tensor* found = nullptr;
  for (const Tensor& output : outputs) {
    const bool is_of_rank = output.rank() == rank || (rank == 3 && output.rank() == 2);
    if (!is_of_rank || (output.rank() > 2 && output.shape.front() != 1)) continue;
    if (found) return nullptr;
    found = &output;
  }
  return found;
}

}  // namespace

int find_best_class(const float* values, int count, std::ptrdiff_t step) {
  int best = -1;
  for (int c = 0; c < count; ++c)
    if (const float value = values[c * step]; std::isfinite(value) && (best < 0 || value > values[best * step])) best = c;
  return best;
}

bool is_usable(const BoxCandidate& candidate, const Description& description) {
  const cv::Rect2d& box = candidate.box;
  return description.is_removed(candidate.type) && candidate.score >= description.score && std::isfinite(box.x) &&
         std::isfinite(box.y) && box.width > 0 && box.height > 0 && std::isfinite(box.width) && std::isfinite(box.height);
}

cv::Rect to_image_pixels(const cv::Rect2d& box, const InputFit& fit) {
  const cv::Point2d a = fit.to_image(box.tl()), b = fit.to_image(box.br());
  const double width = fit.image.width, height = fit.image.height;
  const cv::Point first(static_cast<int>(std::floor(std::clamp(a.x, 0.0, width))),
                        static_cast<int>(std::floor(std::clamp(a.y, 0.0, height))));
  const cv::Point end(static_cast<int>(std::ceil(std::clamp(b.x, 0.0, width))),
                      static_cast<int>(std::ceil(std::clamp(b.y, 0.0, height))));
  return {first, end};
}

std::vector<BoxCandidate> suppress_non_maxima(const std::vector<BoxCandidate>& candidates, const Description& description,
                                              const InputFit& fit) {
  // The boxes of each class are moved to another area, so that they do not suppress those of other classes.
  const double class_offset = 4 * (fit.input.width + fit.input.height);
  std::vector<cv::Rect2d> boxes;
  std::vector<float> scores;
  for (const BoxCandidate& c : candidates) {
    boxes.push_back(c.box + cv::Point2d(class_offset * c.type, 0));
    scores.push_back(c.score);
  }
  std::vector<int> kept;
  cv::dnn::NMSBoxes(boxes, scores, 0, static_cast<float>(description.nms), kept, 1, kMaxBoxes);
  std::vector<BoxCandidate> out;
  for (const int i : kept) out.push_back(candidates[static_cast<std::size_t>(i)]);
  return out;
}

void add_detection(Detections& detections, const DetectedPart& part, int min_pixels) {
  if (part.mask.empty() || cv::countNonZero(part.mask) < min_pixels) return;
  const cv::Rect box = cv::boundingRect(part.mask);
  detections.push_back({part.type, part.score, box + part.corner, part.mask(box).clone(), part.is_box});
}

Detections draw_candidates(const std::vector<BoxCandidate>& candidates, const Tensor* prototypes,
                           const Description& description, const InputFit& fit) {
  Detections out;
  for (const BoxCandidate& candidate : candidates) {
    const cv::Rect area = to_image_pixels(candidate.box, fit);
    if (area.empty()) continue;
    DetectedPart part{candidate.type, candidate.score, {}, area.tl(), prototypes == nullptr};
    if (prototypes) {
      const cv::Mat1f flat(prototypes->planes(), prototypes->rows() * prototypes->cols(),
                           const_cast<float*>(prototypes->values.data()));
      const cv::Mat1f weights(1, prototypes->planes(), const_cast<float*>(candidate.coefficients.data()));
      part.mask = resample_to_image(cv::Mat1f(weights * flat).reshape(1, prototypes->rows()), fit, area) > 0;
    } else {
      part.mask = cv::Mat1b(area.size(), uchar{255});
    }
    add_detection(out, part, description.least_pixels);
  }
  return out;
}

const Tensor* find_only_map(const std::vector<Tensor>& outputs) { return find_only(outputs, 4); }

const Tensor* find_only_rows(const std::vector<Tensor>& outputs) { return find_only(outputs, 3); }

}  // namespace dvi::objects
