#include "dvi/objects/silhouettes.h"

#include <algorithm>
#include <utility>
#include <vector>

#include <opencv2/imgproc.hpp>

#include "dvi/image/enlarge.h"
#include "dvi/image/region.h"
#include "dvi/objects/background_comparison.h"
#include "dvi/objects/cache_masks.h"
#include "dvi/objects/edges.h"

namespace dvi::objects {
namespace {

struct SilhouetteParams {
  double boundary_share = 0.25;     ///< of an outline's shorter side: how far an object may end beyond or within its outline
  int min_boundary_px = 4;          ///< smallest width of this boundary, pixels of half size
  int band_radii = 3;               ///< width of the compared band around an outline, in edge search radii
  int min_part_px = 20;             ///< pixels of half size; smaller parts are noise
  int min_rejected_px = 200;        ///< smallest outline that the images can reject, pixels of half size: ten parts
  double min_decided_share = 0.75;  ///< share of decided pixels in a rejected outline
  double min_matching_share = 0.8;  ///< share of pixels among these that show the background; edges and leaves move
  /// Share of an outline's shorter side. Narrower notches are filled, because objects have none, but resemble their background
  /// by chance.
  double notch_share = 0.125;
  std::size_t max_colors = 64;       ///< colors of an object that are compared with its background
  double min_distinct_share = 0.75;  ///< share of these colors that the background must exclude
  double similar_levels = 25;  ///< gray levels between a pixel and a color of the object, up to which it may be of the object
  int margin_px = 2;           ///< pixels of half size over which the lens and motion blur smear an object
  int upper_margin_px = 3;     ///< the same above the ground, where rails and mirrors are too thin to be detected
};
constexpr SilhouetteParams kSilhouette{};

cv::Mat1b resize_nearest(const cv::Mat1b& mask, cv::Size size) {
  cv::Mat1b out;
  cv::resize(mask, out, size, 0, 0, cv::INTER_NEAREST);
  return out;
}

// Removes thin structures, such as displaced edges. Thin parts of a thick structure remain.
cv::Mat1b open_mask(const cv::Mat1b& mask) { return grown(grown(mask, -1), 1); }

// Returns the width of the boundary of an outline.
int compute_boundary_width_px(const cv::Rect& part, int min_px = kSilhouette.min_boundary_px) {
  return std::max(min_px, cvRound(kSilhouette.boundary_share * std::min(part.width, part.height)));
}

// Returns the pixels within the boundary of an outline, or within that of a narrower one that it is connected to, such as a
// person beside a car.
cv::Mat1b find_middle(const cv::Mat1b& outline, int min_px = kSilhouette.min_boundary_px) {
  const int width_px = compute_boundary_width_px(cv::boundingRect(outline), min_px);
  cv::Mat1b out = grown_far(outline, -width_px);
  if (cv::countNonZero(out) == 0) return out;
  cv::Mat1i parts;
  const int count = label_connected_parts(cv::Mat1b(outline & ~grown_far(out, width_px)), parts);
  for (int i = 1; i <= count; ++i)
    if (const cv::Mat1b part(parts == i); cv::countNonZero(part) >= kSilhouette.min_part_px)
      out |= find_middle(part, kSilhouette.min_boundary_px / 2);
  return out;
}

// Returns the parts of a mask that overlap another mask and are not noise.
cv::Mat1b select_overlapping(const cv::Mat1b& other, const cv::Mat1b& mask) {
  cv::Mat1i parts;
  const std::size_t count = static_cast<std::size_t>(label_connected_parts(mask, parts)) + 1;
  std::vector<int> pixels(count, 0);
  std::vector<bool> overlaps(count, false);
  for (int y = 0; y < parts.rows; ++y)
    for (int x = 0; x < parts.cols; ++x) {
      const auto part = static_cast<std::size_t>(parts(y, x));
      ++pixels[part];
      if (other(y, x) != 0) overlaps[part] = true;
    }
  cv::Mat1b out(mask.size(), uchar{0});
  for (int y = 0; y < parts.rows; ++y)
    for (int x = 0; x < parts.cols; ++x)
      if (const auto part = static_cast<std::size_t>(parts(y, x));
          part != 0 && overlaps[part] && pixels[part] >= kSilhouette.min_part_px)
        out(y, x) = 255;
  return out;
}

// Marks pixels as undecided if they have a color of the object and the object would hardly differ from its background.
void mark_undecided(const cv::Rect& part, const cv::Mat1b& outline, const cv::Mat3b& image, ImageDifference& difference) {
  std::vector<cv::Vec3f> colors;
  for (int y = part.y; y < part.br().y; ++y)
    for (int x = part.x; x < part.br().x; ++x)
      if (outline(y, x) != 0 && difference.differs(y, x) != 0) colors.push_back(image(y, x));
  const std::size_t step = colors.size() / kSilhouette.max_colors + 1;
  for (int y = part.y; y < part.br().y; ++y)
    for (int x = part.x; x < part.br().x; ++x) {
      if (outline(y, x) == 0 || difference.differs(y, x) != 0 || difference.undecided(y, x) != 0) continue;
      std::size_t compared = 0, distinct = 0;
      bool similar = false;
      for (std::size_t i = 0; i < colors.size(); i += step, ++compared) {
        distinct += difference.background.differs({x, y}, colors[i]);
        similar = similar || cv::norm(colors[i] - cv::Vec3f(image(y, x)), cv::NORM_INF) < kSilhouette.similar_levels;
      }
      if (similar && static_cast<double>(distinct) < kSilhouette.min_distinct_share * static_cast<double>(compared))
        difference.undecided(y, x) = 255;
    }
}

// Returns whether an outline shows its background. Errors of a LiDAR may move with the vehicle, but no image shows them. A
// small outline has too few pixels for a decision.
bool is_rejected(const cv::Mat1b& outline, const ImageDifference& difference) {
  const int pixels = cv::countNonZero(outline), decided = cv::countNonZero(outline & ~difference.undecided);
  return pixels >= kSilhouette.min_rejected_px && decided > kSilhouette.min_decided_share * pixels &&
         cv::countNonZero(outline & difference.matches) > kSilhouette.min_matching_share * decided;
}

// Returns the pixels that differ or are undecided and are connected to the outline. Thin structures beyond it are removed.
cv::Mat1b find_object(const cv::Mat1b& outline, const ImageDifference& difference) {
  const cv::Mat1b within(outline & difference.undecided);
  const cv::Mat1b out = select_overlapping(outline, cv::Mat1b(difference.differs | within));
  return cv::Mat1b((out & outline) | (open_mask(out) & ~outline));
}

// Returns the silhouette of each object: the part that is connected to the middle of its outline, with narrow notches filled.
cv::Mat1b find_silhouettes(const cv::Mat1b& outline, const cv::Mat1b& object, const ImageDifference& difference) {
  cv::Mat1b out(outline.size(), uchar{0});
  cv::Mat1i parts;
  const int count = label_connected_parts(cv::Mat1b(outline | object), parts);
  for (int i = 1; i <= count; ++i) {
    const cv::Mat1b part(parts == i), whole(outline & part), own(object & part);
    if (cv::countNonZero(own & difference.differs) < kSilhouette.min_part_px) {
      if (!is_rejected(whole, difference)) out |= whole;
      continue;
    }
    const cv::Rect box = cv::boundingRect(part);
    cv::Mat1b seed = find_middle(whole);
    if (cv::countNonZero(seed) == 0) seed = whole;
    const int notch_px =
        std::max(kSilhouette.min_boundary_px - 1, cvRound(kSilhouette.notch_share * std::min(box.width, box.height)));
    const cv::Mat1b closed = grown_far(grown_far(cv::Mat1b(own | seed), notch_px), -notch_px);
    out |= select_overlapping(seed, cv::Mat1b(closed & part));
  }
  return out;
}

class SilhouetteFinder {
 public:
  SilhouetteFinder(BackgroundComparison comparison, Lazy<cv::Mat1b> outlines)
      : comparison_(std::move(comparison)), outlines_(std::move(outlines)) {}

  cv::Mat1b refine(std::size_t target) const {
    const cv::Mat1b outline = *outlines_[target];
    if (cv::countNonZero(outline) == 0) return outline;
    cv::Mat1b half;
    cv::resize(outline, half, {outline.cols / kHalfSizeFactor, outline.rows / kHalfSizeFactor}, 0, 0, cv::INTER_AREA);
    half = cv::Mat1b(half > 0);
    const ImageDifference difference = compare(target, half);
    const cv::Mat1b object = find_object(half, difference);
    // Undecided pixels end with the outline. Pixels that differ have a margin everywhere.
    const cv::Mat1b silhouette = find_silhouettes(half, object, difference);
    const int margin_px = kSilhouette.margin_px;
    const cv::Mat1b upper(grown(silhouette, kSilhouette.upper_margin_px) & ~difference.ground);
    const cv::Mat1b within = resize_nearest(cv::Mat1b(grown(silhouette, margin_px) | upper), outline.size());
    const cv::Mat1b differing(open_mask(object) & difference.differs & (silhouette | ~half));
    const cv::Mat1b beyond = resize_nearest(grown(differing, margin_px), outline.size());
    return add_edges(target, cv::Mat1b((within & outline) | beyond), difference);
  }

 private:
  // Adds the missing edges of objects to a mask of full size.
  cv::Mat1b add_edges(std::size_t target, const cv::Mat1b& mask, const ImageDifference& difference) const {
    cv::Mat1b half;
    cv::resize(mask, half, difference.differs.size(), 0, 0, cv::INTER_AREA);
    half = cv::Mat1b(half == 255);
    const cv::Mat1b with_edges = add_missing_edges(half, difference.background, comparison_.half_size_view(target)->image,
                                                   compute_edge_search_radius_px(half.size()));
    return cv::Mat1b(mask | resize_nearest(cv::Mat1b(with_edges & ~half), mask.size()));
  }

  ImageDifference compare(std::size_t target, const cv::Mat1b& outline) const {
    cv::Mat1b band(outline.size(), uchar{0});
    for (const cv::Rect& part : find_part_boxes(outline)) {
      const int width =
          std::max(compute_boundary_width_px(part), kSilhouette.band_radii * compute_edge_search_radius_px(outline.size()));
      band(enlarge(part, width, band.size())) = 255;
    }
    ImageDifference out = comparison_.compare(target, band);
    const auto half = comparison_.half_size_view(target);
    for (const cv::Rect& part : find_part_boxes(outline)) mark_undecided(part, outline, half->image, out);
    return out;
  }

  BackgroundComparison comparison_;
  Lazy<cv::Mat1b> outlines_;
};

}  // namespace

Lazy<cv::Mat1b> refine_silhouettes(const Views& views, const Lazy<cv::Mat1f>& static_depth,
                                   const std::shared_ptr<const ground::ScanGround>& ground) {
  const auto refine = [&](const Views& masked) {
    const auto finder =
        std::make_shared<const SilhouetteFinder>(BackgroundComparison(masked, static_depth, ground), views.masks);
    return cache_masks(views.size(), [finder](std::size_t i) { return finder->refine(i); });
  };
  // Generous outlines cover the background of each other, so the outlines are refined again with the smaller masks.
  Views narrower = views;
  narrower.masks = refine(views);
  return refine(narrower);
}

}  // namespace dvi::objects
