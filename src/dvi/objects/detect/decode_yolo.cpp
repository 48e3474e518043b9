#include <algorithm>
#include <array>
#include <cmath>

#include <fmt/format.h>

#include "dvi/objects/detect/box_candidates.h"

namespace dvi::objects {
namespace {

// The encoding of boxes in YOLOv8: a distribution over bins (reg_max) per side; in YOLO26, the distance itself.
constexpr int kBins = 16, kSides = 4;

float sigmoid(float x) { return 1 / (1 + std::exp(-x)); }

// The maps of one stride of YOLOv8's head.
struct Level {
  int rows = 0, cols = 0, bins = kBins, coefficient_count = 0;
  const float *boxes = nullptr, *classes = nullptr, *coefficients = nullptr;

  std::ptrdiff_t cells() const { return static_cast<std::ptrdiff_t>(rows) * cols; }
};

// Decodes the distance from the center of a cell to a side of its box, in cells: the mean of the bins, weighted by the softmax
// of their logits.
double decode_distance(const float* logits, int bins, std::ptrdiff_t step) {
  if (bins == 1) return logits[0];
  float most = logits[0];
  for (int b = 1; b < bins; ++b) most = std::max(most, logits[b * step]);
  double sum = 0, weighted = 0;
  for (int b = 0; b < bins; ++b) {
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
    to[static_cast<std::size_t>(side)] = decode_distance(level.boxes + side * level.bins * step + cell, level.bins, step);
  const double width = static_cast<double>(input.width) / level.cols, height = static_cast<double>(input.height) / level.rows;
  return {(x + 0.5 - to[0]) * width, (y + 0.5 - to[1]) * height, (to[0] + to[2]) * width, (to[1] + to[3]) * height};
}

bool is_map(const Tensor& tensor) { return tensor.rank() == 4 && tensor.shape.front() == 1 && !tensor.values.empty(); }
bool have_same_grid(const Tensor& a, const Tensor& b) { return a.rows() == b.rows() && a.cols() == b.cols(); }

// Assigns the maps to strides. If numbers of channels are equal, the order is boxes, classes, coefficients. Returns an empty
// list if there are other maps.
std::vector<Level> find_levels(const std::vector<Tensor>& outputs, const Tensor* prototypes, int classes) {
  std::vector<Level> levels;
  std::vector<const Tensor*> free;
  for (const Tensor& output : outputs) {
    if (&output == prototypes) continue;
    if (!is_map(output)) return {};
    free.push_back(&output);
  }
  const auto take = [&](const Tensor& grid, int channels) -> const float* {
    const auto found = std::find_if(free.begin(), free.end(),
                                    [&](const Tensor* m) { return m->planes() == channels && have_same_grid(*m, grid); });
    if (found == free.end()) return nullptr;
    const float* data = (*found)->values.data();
    free.erase(found);
    return data;
  };
  while (!free.empty()) {
    const Tensor& grid = *free.front();
    Level level{grid.rows(), grid.cols(), kBins, prototypes ? prototypes->planes() : 0};
    for (const int bins : {kBins, 1}) {
      if (level.boxes) break;
      level.bins = bins;
      if (const float* both = take(grid, kSides * bins + classes)) {
        level.boxes = both;
        level.classes = both + kSides * bins * level.cells();
      } else if (const float* boxes = take(grid, kSides * bins)) {
        level.boxes = boxes;
        level.classes = take(grid, classes);
      }
    }
    if (prototypes) level.coefficients = take(grid, level.coefficient_count);
    if (!level.boxes || !level.classes || (prototypes && !level.coefficients)) return {};
    levels.push_back(level);
  }
  return levels;
}

// Returns the only map whose grid no other map has, or null.
const Tensor* find_prototypes(const std::vector<Tensor>& outputs) {
  const Tensor* found = nullptr;
  for (const Tensor& output : outputs) {
    if (!is_map(output)) continue;
    const auto alike = std::count_if(outputs.begin(), outputs.end(),
                                     [&](const Tensor& other) { return is_map(other) && have_same_grid(output, other); });
    if (alike > 1) continue;
    if (found) return nullptr;
    found = &output;
  }
  return found;
}

// The head of YOLOv8 before its boxes are decoded: a network for segmentation has prototypes, one for detection has none.
struct UndecodedHead {
  const Tensor* prototypes = nullptr;
  std::vector<Level> levels;
};

UndecodedHead find_undecoded_head(const std::vector<Tensor>& outputs, int classes) {
  UndecodedHead head{find_prototypes(outputs), {}};
  if (head.prototypes) head.levels = find_levels(outputs, head.prototypes, classes);
  if (head.levels.empty()) head = {nullptr, find_levels(outputs, nullptr, classes)};
  return head;
}

void add_candidates(const Level& level, const Description& description, cv::Size input, std::vector<BoxCandidate>& out) {
  const int count = static_cast<int>(description.classes.size());
  const std::ptrdiff_t step = level.cells();
  for (int y = 0; y < level.rows; ++y)
    for (int x = 0; x < level.cols; ++x) {
      const std::ptrdiff_t cell = static_cast<std::ptrdiff_t>(y) * level.cols + x;
      const int best = find_best_class(level.classes + cell, count, step);
      if (!description.is_removed(best)) continue;
      BoxCandidate candidate{best, sigmoid(level.classes[best * step + cell]), {}, {}};
      if (candidate.score < description.score) continue;
      candidate.box = decode_box(level, x, y, input);
      for (int m = 0; m < level.coefficient_count; ++m) candidate.coefficients.push_back(level.coefficients[m * step + cell]);
      if (is_usable(candidate, description)) out.push_back(std::move(candidate));
    }
}

}  // namespace

bool is_undecoded_yolov8(const std::vector<Tensor>& outputs, const Description& description) {
  return !find_undecoded_head(outputs, description.class_count()).levels.empty();
}

Detections decode_yolov5(const std::vector<Tensor>& outputs, const Description& description, const InputFit& fit) {
  const int count = description.class_count();
  const Tensor* rows = find_only_rows(outputs);
  const Tensor* prototypes = find_only_map(outputs);
  const int coefficients = prototypes ? prototypes->planes() : 0;
  if (!rows || rows->cols() != 5 + count + coefficients)
    throw_unexpected_shapes(outputs, description,
                            fmt::format("1xNx{0}, or 1xNx({0} + M) and 1xMxHxW, such as M = 32", 5 + count));
  std::vector<BoxCandidate> candidates;
  for (int i = 0; i < rows->rows(); ++i) {
    const float* row = rows->row(i);
    const int best = find_best_class(row + 5, count, 1);
    if (!description.is_removed(best)) continue;
    BoxCandidate candidate{best,
                           row[4] * row[5 + best],
                           cv::Rect2d(row[0] - 0.5 * row[2], row[1] - 0.5 * row[3], row[2], row[3]),
                           {row + 5 + count, row + 5 + count + coefficients}};
    if (is_usable(candidate, description)) candidates.push_back(std::move(candidate));
  }
  return draw_candidates(suppress_non_maxima(candidates, description, fit), prototypes, description, fit);
}

Detections decode_yolov8(const std::vector<Tensor>& outputs, const Description& description, const InputFit& fit) {
  const int count = description.class_count();
  std::vector<BoxCandidate> candidates;
  if (const UndecodedHead head = find_undecoded_head(outputs, count); !head.levels.empty()) {
    for (const Level& level : head.levels) add_candidates(level, description, fit.input, candidates);
    return draw_candidates(suppress_non_maxima(candidates, description, fit), head.prototypes, description, fit);
  }
  const Tensor* columns = find_only_rows(outputs);  // one box per column
  const Tensor* prototypes = find_only_map(outputs);
  const int coefficients = prototypes ? prototypes->planes() : 0;
  if (!columns || columns->rank() != 3 || columns->rows() != 4 + count + coefficients)
    throw_unexpected_shapes(outputs, description,
                            fmt::format("1x{0}xN, or 1x({0} + M)xN and 1xMxHxW, such as M = 32; or the maps of the head before "
                                        "its boxes are decoded",
                                        4 + count));
  const std::ptrdiff_t step = columns->cols();
  for (int i = 0; i < columns->cols(); ++i) {
    const float* column = columns->values.data() + i;
    const int best = find_best_class(column + 4 * step, count, step);
    if (!description.is_removed(best)) continue;
    BoxCandidate candidate{best,
                           column[(4 + best) * step],
                           cv::Rect2d(column[0] - 0.5 * column[2 * step], column[step] - 0.5 * column[3 * step],
                                      column[2 * step], column[3 * step]),
                           {}};
    if (!is_usable(candidate, description)) continue;
    for (int m = 0; m < coefficients; ++m) candidate.coefficients.push_back(column[(4 + count + m) * step]);
    candidates.push_back(std::move(candidate));
  }
  return draw_candidates(suppress_non_maxima(candidates, description, fit), prototypes, description, fit);
}

}  // namespace dvi::objects
