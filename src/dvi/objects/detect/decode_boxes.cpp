#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <opencv2/core.hpp>

#include "dvi/objects/detect/box_candidates.h"

namespace dvi::objects {
namespace {

constexpr float kMaxShare = 2;  // boxes as shares of the input may extend beyond it; in pixels, such boxes are empty

cv::Rect2d make_box(const float* corners, cv::Size2d scale) {
  return {corners[0] * scale.width, corners[1] * scale.height, (corners[2] - corners[0]) * scale.width,
          (corners[3] - corners[1]) * scale.height};
}

cv::Rect2d make_centered_box(const float* box, cv::Size2d scale) {
  return {(box[0] - 0.5 * box[2]) * scale.width, (box[1] - 0.5 * box[3]) * scale.height, box[2] * scale.width,
          box[3] * scale.height};
}

// Returns the size of the input if the boxes are shares of it, else 1 x 1.
cv::Size2d find_scale(const std::vector<const float*>& boxes, cv::Size input) {
  float most = 0;
  for (const float* box : boxes)
    for (int i = 0; i < 4; ++i)
      if (std::isfinite(box[i])) most = std::max(most, box[i]);
  return most <= kMaxShare ? cv::Size2d(input) : cv::Size2d(1, 1);
}

// Returns the share of a class in the probabilities of logits, or their sigmoid for networks without a class of no object.
float compute_score(const float* logits, int count, int type, bool has_no_object) {
  if (!has_no_object) return 1 / (1 + std::exp(-logits[type]));
  float most = logits[0];
  for (int c = 1; c < count; ++c) most = std::max(most, logits[c]);
  float sum = 0;
  for (int c = 0; c < count; ++c) sum += std::exp(logits[c] - most);
  return std::exp(logits[type] - most) / sum;
}

// The sizes of a tensor without its first axis of size 1.
std::vector<int> drop_batch(const Tensor& tensor, std::size_t rank) {
  const bool has_batch = tensor.shape.size() == rank + 1 && tensor.shape.front() == 1;
  return {tensor.shape.begin() + (has_batch ? 1 : 0), tensor.shape.end()};
}

// Draws a mask of probabilities of the whole input, or of the box.
cv::Mat1b draw_probabilities(const cv::Mat1f& probabilities, const cv::Rect2d& box, const InputFit& fit) {
  const cv::Rect area = to_image_pixels(box, fit);
  if (area.empty()) return {};
  if (probabilities.size() == fit.input) return cv::Mat1b(resample_to_image(probabilities, fit, area) > 0.5F);
  // The probabilities are an image of the box alone.
  InputFit in_box = fit;
  in_box.input = cv::Size(1, 1);
  in_box.scale = {fit.scale.x / box.width, fit.scale.y / box.height};
  in_box.offset = {(fit.offset.x - box.x) / box.width, (fit.offset.y - box.y) / box.height};
  return cv::Mat1b(resample_to_image(probabilities, in_box, area) > 0.5F);
}

}  // namespace

RcnnOutputs find_rcnn_outputs(const std::vector<Tensor>& outputs) {
  RcnnOutputs out;
  for (const Tensor& output : outputs) {
    const std::vector<int> rows = drop_batch(output, 2), list = drop_batch(output, 1);
    if (output.has_whole_numbers && list.size() == 1) out.labels = &output;
    if (!output.has_whole_numbers && list.size() == 1) out.scores = &output;
    if (!output.has_whole_numbers && rows.size() == 2 && rows[1] == 4) out.boxes = &output;
    if (output.rank() == 4 && output.shape[1] == 1) out.masks = &output;
  }
  const bool is_whole = out.boxes && out.labels && out.scores && out.labels->values.size() == out.scores->values.size() &&
                        out.boxes->values.size() == 4 * out.labels->values.size() &&
                        (!out.masks || out.masks->shape[0] == static_cast<int>(out.labels->values.size()));
  return is_whole ? out : RcnnOutputs();
}

DetrOutputs find_detr_outputs(const std::vector<Tensor>& outputs, int classes) {
  DetrOutputs out;
  for (const Tensor& output : outputs) {
    if (output.rank() != 3 || output.shape.front() != 1) continue;
    const bool has_name = output.name.find("box") != std::string::npos;
    if (output.cols() == 4 && (has_name || !out.boxes)) out.boxes = &output;
  }
  for (const Tensor& output : outputs)
    if (output.rank() == 3 && output.shape.front() == 1 && &output != out.boxes && out.boxes &&
        output.rows() == out.boxes->rows() && (output.cols() == classes || output.cols() == classes + 1))
      out.logits = &output;
  return out.logits ? out : DetrOutputs();
}

Detections decode_nms(const std::vector<Tensor>& outputs, const Description& description, const InputFit& fit) {
  const Tensor* prototypes = find_only_map(outputs);
  const Tensor* rows = find_only_rows(outputs);
  const int coefficients = prototypes ? prototypes->planes() : 0;
  const bool has_image_numbers = rows && rows->rank() == 2 && rows->cols() == 7 && !prototypes;
  if (!rows || (rows->cols() != 6 + coefficients && !has_image_numbers))
    throw_unexpected_shapes(outputs, description, "1xNx6, Nx7, or 1xNx(6 + M) and 1xMxHxW, such as M = 32");
  std::vector<const float*> boxes;
  for (int i = 0; i < rows->rows(); ++i) boxes.push_back(rows->row(i) + (has_image_numbers ? 1 : 0));
  const cv::Size2d scale = find_scale(boxes, fit.input);
  std::vector<BoxCandidate> candidates;
  for (const float* row : boxes) {
    const int score = has_image_numbers ? 5 : 4, type = has_image_numbers ? 4 : 5;  // YOLOv7 has the class first
    if (!std::isfinite(row[type])) continue;
    BoxCandidate candidate{static_cast<int>(std::lround(row[type])), row[score], make_box(row, scale), {}};
    candidate.coefficients.assign(row + 6, row + 6 + coefficients);
    if (is_usable(candidate, description)) candidates.push_back(std::move(candidate));
  }
  return draw_candidates(candidates, prototypes, description, fit);
}

Detections decode_detr(const std::vector<Tensor>& outputs, const Description& description, const InputFit& fit) {
  const int classes = description.class_count();
  const DetrOutputs separate = find_detr_outputs(outputs, classes);
  const Tensor* rows = find_only_rows(outputs);
  const bool has_scores = !separate.logits && rows && rows->cols() == 4 + classes;
  if (!separate.logits && !has_scores)
    throw_unexpected_shapes(
        outputs, description,
        fmt::format("1xNx{} or 1xNx{} (logits) and 1xNx4 (boxes), or 1xNx{}", classes, classes + 1, classes + 4));
  const Tensor& boxes = separate.logits ? *separate.boxes : *rows;
  std::vector<BoxCandidate> candidates;
  for (int i = 0; i < boxes.rows(); ++i) {
    const float* scores = separate.logits ? separate.logits->row(i) : rows->row(i) + 4;
    const int type = find_best_class(scores, classes, 1);
    if (type < 0) continue;
    const float score =
        has_scores ? scores[type] : compute_score(scores, separate.logits->cols(), type, separate.logits->cols() > classes);
    BoxCandidate candidate{type, score, make_centered_box(boxes.row(i), fit.input), {}};
    if (is_usable(candidate, description)) candidates.push_back(std::move(candidate));
  }
  return draw_candidates(suppress_non_maxima(candidates, description, fit), nullptr, description, fit);
}

Detections decode_rcnn(const std::vector<Tensor>& outputs, const Description& description, const InputFit& fit) {
  const RcnnOutputs found = find_rcnn_outputs(outputs);
  if (!found.boxes)
    throw_unexpected_shapes(outputs, description,
                            "Nx4 (boxes), N whole numbers (classes), N (scores), and possibly Nx1xHxW (masks)");
  std::vector<BoxCandidate> candidates;
  Detections out;
  for (int i = 0; i < static_cast<int>(found.labels->values.size()); ++i) {
    const auto k = static_cast<std::size_t>(i);
    const BoxCandidate candidate{static_cast<int>(std::lround(found.labels->values[k])),
                                 found.scores->values[k],
                                 make_box(found.boxes->values.data() + 4 * k, {1, 1}),
                                 {}};
    if (!is_usable(candidate, description)) continue;
    if (!found.masks) {
      candidates.push_back(candidate);
      continue;
    }
    const DetectedPart part{candidate.type, candidate.score, draw_probabilities(found.masks->plane(i), candidate.box, fit),
                            to_image_pixels(candidate.box, fit).tl(), false};
    add_detection(out, part, description.least_pixels);
  }
  return found.masks ? out : draw_candidates(candidates, nullptr, description, fit);
}

}  // namespace dvi::objects
