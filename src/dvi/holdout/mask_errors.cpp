#include "dvi/holdout/mask_errors.h"

#include <algorithm>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <opencv2/imgproc.hpp>

#include "dvi/core/error.h"
#include "dvi/core/random.h"
#include "dvi/image/region.h"

namespace dvi::holdout {
namespace {

/// Marks five consecutive frames among those in which the object is visible.
void mark_burst(const std::vector<bool>& visible, Random& random, std::vector<bool>& missed) {
  std::vector<std::size_t> frames;
  for (std::size_t i = 0; i < visible.size(); ++i)
    if (visible[i]) frames.push_back(i);
  const std::size_t length = std::min(kMaskErrors.burst_frames, frames.size());
  const auto first = static_cast<std::size_t>(random.below(static_cast<int>(frames.size() - length) + 1));
  for (std::size_t k = first; k < first + length; ++k) missed[frames[k]] = true;
}

cv::Rect draw_box(cv::Size image, Random& random) {
  const auto draw_edge = [&](int limit) {
    return std::min(kMaskErrors.min_box_px + random.below(kMaskErrors.max_box_px - kMaskErrors.min_box_px + 1), limit);
  };
  const int width = draw_edge(image.width), height = draw_edge(image.height);
  const int x = random.below(image.width - width + 1), y = random.below(image.height - height + 1);
  return {x, y, width, height};
}

void draw_false_boxes(cv::Size image, Random& random, std::vector<std::optional<cv::Rect>>& boxes) {
  for (std::optional<cv::Rect>& box : boxes)
    if (random.uniform() < kMaskErrors.false_probability) box = draw_box(image, random);
  if (!boxes.empty() && std::none_of(boxes.begin(), boxes.end(), [](const auto& box) { return box.has_value(); }))
    boxes[static_cast<std::size_t>(random.below(static_cast<int>(boxes.size())))] = draw_box(image, random);
}

cv::Mat1b keep_if_large(const cv::Mat1b& silhouette) {
  const double share = cv::countNonZero(silhouette) / static_cast<double>(silhouette.total());
  return share >= kMaskErrors.min_late_share ? silhouette.clone() : cv::Mat1b(silhouette.size(), uchar{0});
}

cv::Mat1b tighten(const cv::Mat1b& silhouette) {
  const cv::Mat1b opened = grown(grown(silhouette, -kMaskErrors.opening_radius_px), kMaskErrors.opening_radius_px);
  return grown(opened, -kMaskErrors.erosion_radius_px);
}

cv::Mat1b fill_bounding_box(const cv::Mat1b& silhouette) {
  cv::Mat1b mask(silhouette.size(), uchar{0});
  mask(cv::boundingRect(silhouette)) = 255;
  return mask;
}

cv::Mat1b add_box(const cv::Mat1b& silhouette, const std::optional<cv::Rect>& box) {
  cv::Mat1b mask = silhouette.clone();
  if (box) mask(*box) = 255;
  return mask;
}

}  // namespace

MaskErrors parse_mask_errors(const std::string& text) {
  for (const auto& [kind, name] : names_of(MaskErrors{}))
    if (text == name) return kind;
  throw UsageError(fmt::format("--mask-errors {}: unknown; the kinds are {}", text, fmt::join(list_names<MaskErrors>(), ", ")));
}

ObjectErrors draw_errors(MaskErrors kind, const std::vector<bool>& visible, cv::Size image, std::uint64_t seed) {
  ObjectErrors errors{kind, std::vector<bool>(visible.size()), std::vector<std::optional<cv::Rect>>(visible.size())};
  Random random(seed);
  if (kind == MaskErrors::miss)
    std::generate(errors.missed.begin(), errors.missed.end(), [&] { return random.uniform() < kMaskErrors.miss_probability; });
  if (kind == MaskErrors::burst) mark_burst(visible, random, errors.missed);
  if (kind == MaskErrors::false_boxes) draw_false_boxes(image, random, errors.false_boxes);
  return errors;
}

cv::Mat1b add_errors(const cv::Mat1b& silhouette, const ObjectErrors& errors, std::size_t frame) {
  switch (errors.kind) {
    case MaskErrors::none:
      break;
    case MaskErrors::miss:
    case MaskErrors::burst:
      return errors.missed[frame] ? cv::Mat1b(silhouette.size(), uchar{0}) : silhouette.clone();
    case MaskErrors::late:
      return keep_if_large(silhouette);
    case MaskErrors::tight:
      return tighten(silhouette);
    case MaskErrors::boxes:
      return fill_bounding_box(silhouette);
    case MaskErrors::false_boxes:
      return add_box(silhouette, errors.false_boxes[frame]);
  }
  return silhouette.clone();
}

}  // namespace dvi::holdout
