#include <algorithm>
#include <array>
#include <cmath>

#include <fmt/format.h>

#include "dvi/objects/detect/box_candidates.h"

namespace dvi::objects {
namespace {

// The encoding of boxes in YOLOv8: a distribution over bins (reg_max) per side.
constexpr int kBins = 16, kSides = 4, kBoxChannels = kBins * kSides;

float sigmoid(float x) { return 1 / (1 + std::exp(-x)); }

bool is_usable(const BoxCandidate& candidate, const Description& description) {
  const cv::Rect2d& box = candidate.box;
  return candidate.score >= description.score && std::isfinite(box.x) && std::isfinite(box.y) && box.width > 0 &&
         box.height > 0 && std::isfinite(box.width) && std::isfinite(box.height);
}

// The maps of one stride of YOLOv8's head.
struct Level {
  int rows = 0, cols = 0, coefficient_count = 0;
  const float *boxes = nullptr, *classes = nullptr, *coefficients = nullptr;

  std::ptrdiff_t cells() const { return static_cast<std::ptrdiff_t>(rows) * cols; }
};

// Decodes the distance from the center of a cell to a side of its box, in cells: the mean of the bins, weighted by the softmax
// of their logits.
double decode_distance(const float* logits, std::ptrdiff_t step) {
  float most = logits[0];
  for (int b = 1; b < kBins; ++b) most = std::max(most, logits[b * step]);
  double sum = 0, weighted = 0;
  for (int b = 0; b < kBins; ++b) {
    const double weight = std::exp(static_cast<double>(logits[b * step] - most));
    sum += weight;
    weighted += b * weight;
  }
  return weighted / sum;
}

cv::Rect2d decode_box(const Level& level, int x, int y, cv::Size input) {
  const std::ptrdiff_t cell = static_cast<std::ptrdiff_t>(y) * level.cols + x, step = level.cells();
  std::array<double, kSides> to{};  // left, top, right, bottom
  for (int side = 0; side < kSides; ++side)
    to[static_cast<std::size_t>(side)] = decode_distance(level.boxes + side * kBins * step + cell, step);
  const double width = static_cast<double>(input.width) / level.cols, height = static_cast<double>(input.height) / level.rows;
  return {(x + 0.5 - to[0]) * width, (y + 0.5 - to[1]) * height, (to[0] + to[2]) * width, (to[1] + to[3]) * height};
}

bool is_map(const cv::Mat& blob) { return blob.dims == 4 && blob.size[0] == 1 && !blob.empty(); }
bool have_same_grid(const cv::Mat& a, const cv::Mat& b) { return a.size[2] == b.size[2] && a.size[3] == b.size[3]; }

// Assigns the maps to strides. If numbers of channels are equal, the order is boxes, classes, coefficients.
std::vector<Level> find_levels(const std::vector<cv::Mat>& outputs, const cv::Mat& prototypes, int classes) {
  std::vector<Level> levels;
  std::vector<const cv::Mat*> free;
  for (const cv::Mat& output : outputs)
    if (is_map(output) && &output != &prototypes) free.push_back(&output);
  const auto take = [&](const cv::Mat& grid, int channels) -> const float* {
    const auto found = std::find_if(free.begin(), free.end(),
                                    [&](const cv::Mat* m) { return m->size[1] == channels && have_same_grid(*m, grid); });
    if (found == free.end()) return nullptr;
    const float* data = (*found)->ptr<float>();
    free.erase(found);
    return data;
  };
  while (!free.empty()) {
    const cv::Mat& grid = *free.front();
    Level level{grid.size[2], grid.size[3], prototypes.size[1]};
    if (const float* both = take(grid, kBoxChannels + classes)) {
      level.boxes = both;
      level.classes = both + kBoxChannels * level.cells();
    } else {
      level.boxes = take(grid, kBoxChannels);
      level.classes = take(grid, classes);
    }
    level.coefficients = take(grid, level.coefficient_count);
    if (!level.boxes || !level.classes || !level.coefficients) return {};
    levels.push_back(level);
  }
  return levels;
}

// Returns the only map whose grid no other map has, or null.
const cv::Mat* find_prototypes(const std::vector<cv::Mat>& outputs) {
  const cv::Mat* found = nullptr;
  for (const cv::Mat& output : outputs) {
    if (!is_map(output)) continue;
    const auto alike = std::count_if(outputs.begin(), outputs.end(),
                                     [&](const cv::Mat& other) { return is_map(other) && have_same_grid(output, other); });
    if (alike > 1) continue;
    if (found) return nullptr;
    found = &output;
  }
  return found;
}

void add_candidates(const Level& level, const Description& description, cv::Size input, std::vector<BoxCandidate>& out) {
  const int count = static_cast<int>(description.classes.size());
  const std::ptrdiff_t step = level.cells();
  for (int y = 0; y < level.rows; ++y)
    for (int x = 0; x < level.cols; ++x) {
      const std::ptrdiff_t cell = static_cast<std::ptrdiff_t>(y) * level.cols + x;
      const int best = find_best_class(level.classes + cell, count, step);
      if (best < 0 || description.removed[static_cast<std::size_t>(best)] == 0) continue;
      BoxCandidate candidate{best, sigmoid(level.classes[best * step + cell]), {}, {}};
      if (candidate.score < description.score) continue;
      candidate.box = decode_box(level, x, y, input);
      for (int m = 0; m < level.coefficient_count; ++m) candidate.coefficients.push_back(level.coefficients[m * step + cell]);
      if (is_usable(candidate, description)) out.push_back(std::move(candidate));
    }
}

}  // namespace

Detections decode_yolov5(const std::vector<cv::Mat>& outputs, const Description& description, const InputFit& fit) {
  const int count = static_cast<int>(description.classes.size());
  const cv::Mat *rows = nullptr, *prototypes = nullptr;
  for (const cv::Mat& output : outputs) {
    if (!prototypes && is_map(output)) prototypes = &output;
    if (!rows && output.dims == 3 && output.size[0] == 1 && !output.empty()) rows = &output;
  }
  if (!rows || !prototypes || rows->size[2] != 5 + count + prototypes->size[1])
    throw_unexpected_shapes(outputs, description, fmt::format("1xNx({} + M) and 1xMxHxW, such as M = 32", 5 + count));
  std::vector<BoxCandidate> candidates;
  for (int i = 0; i < rows->size[1]; ++i) {
    const float* row = rows->ptr<float>(0, i);
    const int best = find_best_class(row + 5, count, 1);
    if (best < 0 || description.removed[static_cast<std::size_t>(best)] == 0) continue;
    const float* coefficients = row + 5 + count;
    BoxCandidate candidate{best,
                           row[4] * row[5 + best],
                           cv::Rect2d(row[0] - 0.5 * row[2], row[1] - 0.5 * row[3], row[2], row[3]),
                           {coefficients, coefficients + prototypes->size[1]}};
    if (is_usable(candidate, description)) candidates.push_back(std::move(candidate));
  }
  return draw_candidates(candidates, *prototypes, description, fit);
}

Detections decode_yolov8(const std::vector<cv::Mat>& outputs, const Description& description, const InputFit& fit) {
  const int count = static_cast<int>(description.classes.size());
  const cv::Mat* prototypes = find_prototypes(outputs);
  const std::vector<Level> levels = prototypes ? find_levels(outputs, *prototypes, count) : std::vector<Level>();
  if (levels.empty())
    throw_unexpected_shapes(
        outputs, description,
        fmt::format("for each stride 1x{0}xHxW (or 1x64xHxW and 1x{1}xHxW) and 1xMxHxW, and 1xMxhxw prototypes, such "
                    "as M = 32: the head cut before its boxes are decoded",
                    kBoxChannels + count, count));
  std::vector<BoxCandidate> candidates;
  for (const Level& level : levels) add_candidates(level, description, fit.input, candidates);
  return draw_candidates(candidates, *prototypes, description, fit);
}

}  // namespace dvi::objects
