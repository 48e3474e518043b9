#include "dvi/regularize/shift_field.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <map>
#include <memory>
#include <optional>
#include <tuple>
#include <vector>

#include "dvi/depth/target.h"
#include "dvi/drive/view.h"
#include "dvi/drive/vignetting.h"
#include "dvi/drive/warp.h"
#include "dvi/image/interpolate.h"
#include "dvi/regularize/min_sum.h"
#include "dvi/sample/candidates.h"

namespace dvi::regularize {
namespace {

/// Builds a ShiftField.
class ShiftFieldBuilder {
 public:
  ShiftFieldBuilder(const sample::Candidates& candidates, const depth::Target& target, double alpha, ShiftField& field)
      : candidates_(candidates),
        target_(target),
        alpha_(static_cast<std::int16_t>(std::lround(alpha))),
        field_(field),
        target_image_(target.image()),
        target_mask_(target.mask()),
        node_(candidates.leading.size(), -1),
        warped_(candidates.leading.size()) {}

  void build() {
    std::map<int, std::vector<int>> of_view;
    for (std::size_t i = 0; i < candidates_.leading.size(); ++i)
      if (candidates_.leading[i].found()) {
        node_[i] = static_cast<int>(field_.nodes());
        of_view[candidates_.leading[i].view].push_back(node_[i]);
        field_.pixel.push_back(static_cast<int>(i));
      }
    const std::array<int, 4> none{-1, -1, -1, -1};
    field_.neighbor.assign(field_.nodes(), none);
    field_.expected.assign(field_.nodes(), none);
    field_.colors.resize(field_.nodes() * row_size());
    field_.data.resize(field_.nodes() * field_.stride);
    for (const auto& [view, nodes] : of_view) add_view(view, nodes);
  }

 private:
  using Position = std::optional<cv::Point2f>;

  std::size_t row_size() const { return std::size_t{3} * field_.stride; }
  cv::Point pixel(int node) const { return candidates_.hole.pixels[field_.pixel[node]]; }
  WarpedPixel warped(int node) const { return {pixel(node), warped_[field_.pixel[node]]}; }
  const sample::Candidate& candidate(int node) const { return candidates_.leading[field_.pixel[node]]; }

  void add_view(int view, const std::vector<int>& nodes) {
    source_view_ = &target_.views[view];
    source_image_ = target_.views.images[view];
    source_mask_ = target_.views.masks[view];
    gain_ = gain_to(target_.view(), target_.views[view]);
    const Warp warp(target_.view(), target_.views[view]);
    for (const int node : nodes) warped_[field_.pixel[node]] = warp(pixel(node), target_.depth.z(pixel(node)));
    for (const int node : nodes) add_node(node, warp);
  }

  void add_node(int node, const Warp& warp) {
    const sample::Candidate& own = candidate(node);
    sample(own.position, pixel(node), &field_.colors[node * row_size()]);
    std::vector<int> boundary_cost(field_.labels());
    int boundary = 0;
    for (int d = 0; d < 4; ++d) {
      const cv::Point q = pixel(node) + cv::Point(kDirections[d][0], kDirections[d][1]);
      if (!cv::Rect({}, candidates_.hole.index.size()).contains(q)) continue;
      if (candidates_.hole.index(q) >= 0)
        add_edge(node, d, warp);
      else if ((*target_mask_)(q) == 0)
        boundary += add_boundary(node, q, warp, boundary_cost);
    }
    std::int16_t* data = &field_.data[static_cast<std::size_t>(node) * field_.stride];
    for (int i = 0; i < field_.labels(); ++i) {
      data[i] = boundary > 0 ? static_cast<std::int16_t>((2 * boundary_cost[i] + boundary) / (2 * boundary)) : alpha_;
      // The unshifted candidate is always allowed, because it was accepted by the sampling stage.
      if (i > 0 && !can_sample(*source_mask_, own.position + cv::Point2f(field_.shifts[i]))) data[i] += kForbiddenCost;
    }
  }

  void add_edge(int node, int direction, const Warp& warp) {
    const cv::Point q = pixel(node) + cv::Point(kDirections[direction][0], kDirections[direction][1]);
    const int inside = candidates_.hole.index(q);
    const int other = node_[inside];
    if (other < 0) return;
    const bool same = candidate(other).view == candidate(node).view;
    const Position q_at = same ? warped_[inside] : warp(q, target_.depth.z(q));
    const cv::Point2f at = find_neighbor_in_source(warped(node), candidate(node).position, {q, q_at});
    field_.neighbor[node][direction] = other;
    if (same && at == candidate(other).position)
      field_.expected[node][direction] = other;
    else if (can_sample(*source_mask_, at))
      field_.expected[node][direction] = add_row(at, q);
  }

  /// Adds the terms of eq. 3 for one neighbor outside the hole. Returns 1 if the source shows it, else 0.
  int add_boundary(int node, cv::Point q, const Warp& warp, std::vector<int>& cost) {
    const cv::Point2f at = find_neighbor_in_source(warped(node), candidate(node).position, {q, warp(q, target_.depth.z(q))});
    if (!can_sample(*source_mask_, at)) return 0;
    scratch_.resize(row_size());
    sample(at, q, scratch_.data());
    const cv::Vec3b truth = (*target_image_)(q);
    for (int c = 0; c < 3; ++c)
      for (int i = 0; i < field_.labels(); ++i) cost[i] += std::abs(scratch_[c * field_.stride + i] - truth[c]);
    return 1;
  }

  /// Appends a row with the colors of a pixel at a position of the source. Returns its index.
  int add_row(cv::Point2f at, cv::Point target_pixel) {
    const std::size_t begin = field_.colors.size();
    field_.colors.resize(begin + row_size());
    sample(at, target_pixel, &field_.colors[begin]);
    return static_cast<int>(begin / row_size());
  }

  /// Samples the source at all shifts from a position, in the illumination of the target at a pixel.
  void sample(cv::Point2f at, cv::Point target_pixel, std::uint8_t* row) const {
    const cv::Mat3b& image = *source_image_;
    const cv::Vec3f gain = vignetting_to(target_.view(), target_pixel, *source_view_, at) * gain_;
    for (int i = 0; i < field_.labels(); ++i) {
      const cv::Point2f shifted = at + cv::Point2f(field_.shifts[i]);
      const cv::Vec3f color = bilinear(image, {std::clamp(shifted.x, 0.0F, static_cast<float>(image.cols - 1)),
                                               std::clamp(shifted.y, 0.0F, static_cast<float>(image.rows - 1))});
      for (int c = 0; c < 3; ++c) row[c * field_.stride + i] = cv::saturate_cast<std::uint8_t>(color[c] * gain[c]);
    }
  }

  const sample::Candidates& candidates_;
  const depth::Target& target_;
  std::int16_t alpha_;
  ShiftField& field_;
  std::shared_ptr<const cv::Mat3b> target_image_, source_image_;
  std::shared_ptr<const cv::Mat1b> target_mask_, source_mask_;
  const View* source_view_ = nullptr;
  cv::Vec3f gain_;                // gain from the source to the target
  std::vector<int> node_;         // node of each hole pixel, or -1
  std::vector<Position> warped_;  // position of each hole pixel in its candidate's view
  std::vector<std::uint8_t> scratch_;
};

}  // namespace

std::vector<cv::Point> list_shifts(int window) {
  std::vector<cv::Point> shifts;
  for (int y = -(window / 2); y <= window / 2; ++y)
    for (int x = -(window / 2); x <= window / 2; ++x) shifts.emplace_back(x, y);
  const auto key = [](cv::Point o) { return std::tuple(o.dot(o), o.y, o.x); };
  std::sort(shifts.begin(), shifts.end(), [&](cv::Point a, cv::Point b) { return key(a) < key(b); });
  return shifts;
}

ShiftField make_shift_field(const sample::Candidates& candidates, const depth::Target& target, int window, double alpha) {
  ShiftField field;
  field.shifts = list_shifts(window);
  field.stride = (field.labels() + kLanes - 1) / kLanes * kLanes;
  ShiftFieldBuilder(candidates, target, alpha, field).build();
  return field;
}

}  // namespace dvi::regularize
