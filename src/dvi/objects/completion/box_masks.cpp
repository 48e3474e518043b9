#include "dvi/objects/completion/box_masks.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "dvi/image/enlarge.h"
#include "dvi/image/nearest_pixel.h"
#include "dvi/image/region.h"

namespace dvi::objects {
namespace {

struct BoxMaskParams {
  int min_side_px = 8;              ///< shortest straight piece of the outline of a box
  double min_straight_share = 0.7;  ///< share of such pieces of the outline; boxes that are dilated have round corners
  std::size_t max_boxes = 24;       ///< of one part
  double max_rest_share = 0.02;     ///< of the area that no rectangle covers
  double max_image_share = 0.5;     ///< of the area of a part; larger ones are not objects
  int border_px = 15;               ///< around a part, where GrabCut learns the colors of the background
  int iterations = 4;               ///< of GrabCut; its result hardly changes afterward
  int max_pixels = 40000;           ///< of an area for GrabCut; larger ones are reduced in size, because its cost is high
  int min_seeds = 5;                ///< of objects; fewer may be errors
  float min_distance_px = 2;        ///< between a seed of the background and the next one of an object, at edges of objects
  float max_ground_px = 6;          ///< distance to a return on the ground beside an object, as between rays
  float max_reach_px = 60;          ///< distance to a return of an object up to which its margin applies
  float max_ray_gap_px = 8;         ///< distance to a return behind the object, without which the background is not observed
  int gap_px = 2;                   ///< gaps between an object and its shadow
  std::size_t max_masks = 100;      ///< that are looked at for fixed pixels
  std::size_t min_masks = 5;        ///< of which pixels may be fixed
  double fixed_share = 0.9;         ///< of masks that cover a fixed pixel
  double min_extent_share = 0.6;    ///< of the sides of a box that its object reaches across; boxes may be dilated
};
constexpr BoxMaskParams kBoxMasks;

bool is_box_shaped(const cv::Mat1b& part) {
  std::vector<std::vector<cv::Point>> outlines;
  cv::findContours(part, outlines, cv::RETR_EXTERNAL, cv::CHAIN_APPROX_SIMPLE);
  double straight = 0, all = 0;
  for (const std::vector<cv::Point>& outline : outlines)
    for (std::size_t i = 0; i < outline.size(); ++i) {
      const cv::Point step = outline[(i + 1) % outline.size()] - outline[i];
      const double length = std::hypot(step.x, step.y);
      all += length;
      if ((step.x == 0 || step.y == 0) && length >= kBoxMasks.min_side_px) straight += length;
    }
  return straight >= kBoxMasks.min_straight_share * all && all > 0;
}

// Calls `visit` with each rectangle within a mask that cannot be extended upward, to the left, or to the right.
template <class Visit>
void visit_rectangles(const cv::Mat1b& mask, const Visit& visit) {
  std::vector<int> height(static_cast<std::size_t>(mask.cols) + 1, 0);  // height of the column above the row; 0 at the end
  for (int y = 0; y < mask.rows; ++y) {
    for (int x = 0; x < mask.cols; ++x) {
      int& column = height[static_cast<std::size_t>(x)];
      column = mask(y, x) != 0 ? column + 1 : 0;
    }
    std::vector<std::pair<int, int>> open;  // first column and height of the rectangles that still extend to the right
    for (int x = 0; x <= mask.cols; ++x) {
      int first = x;
      const int here = height[static_cast<std::size_t>(x)];
      while (!open.empty() && open.back().second > here) {
        first = open.back().first;
        visit(cv::Rect(first, y - open.back().second + 1, x - first, open.back().second));
        open.pop_back();
      }
      if (here > 0 && (open.empty() || open.back().second < here)) open.emplace_back(first, here);
    }
  }
}

// Reduces the initial state of GrabCut in size: a pixel is of an object if any of its pixels certainly is, else of the
// background if any of these certainly is.
cv::Mat1b reduce_state(const cv::Mat1b& state, int factor) {
  cv::Mat1b out(state.rows / factor, state.cols / factor);
  for (int y = 0; y < out.rows; ++y)
    for (int x = 0; x < out.cols; ++x) {
      const cv::Mat1b block = state(cv::Rect(x * factor, y * factor, factor, factor));
      const auto has = [&](int value) { return std::find(block.begin(), block.end(), value) != block.end(); };
      out(y, x) = has(cv::GC_FGD)      ? cv::GC_FGD
                  : has(cv::GC_BGD)    ? cv::GC_BGD
                  : has(cv::GC_PR_FGD) ? cv::GC_PR_FGD
                                       : cv::GC_PR_BGD;
    }
  return out;
}

// Runs GrabCut from an initial state, and returns the pixels of objects.
cv::Mat1b run_grab_cut(const cv::Mat3b& image, const cv::Mat1b& state) {
  const int factor = static_cast<int>(std::ceil(std::sqrt(static_cast<double>(image.total()) / kBoxMasks.max_pixels)));
  cv::Mat1b reduced = factor == 1 ? state.clone() : reduce_state(state, factor);
  cv::Mat3b small;
  cv::resize(image(cv::Rect(0, 0, reduced.cols * factor, reduced.rows * factor)), small, reduced.size(), 0, 0, cv::INTER_AREA);
  cv::Mat background_model, object_model;
  cv::setRNGSeed(0);  // k-means, with which GrabCut begins, continues the random numbers of its thread
  cv::grabCut(small, reduced, {}, background_model, object_model, kBoxMasks.iterations, cv::GC_INIT_WITH_MASK);
  cv::Mat1b out, object((reduced == cv::GC_FGD) | (reduced == cv::GC_PR_FGD));
  cv::resize(object, out, {reduced.cols * factor, reduced.rows * factor}, 0, 0, cv::INTER_NEAREST);
  cv::copyMakeBorder(out, out, 0, image.rows - out.rows, 0, image.cols - out.cols, cv::BORDER_REPLICATE);
  return out;
}

// Marks the pixels of a part of a mask that belong to objects, by GrabCut.
cv::Mat1b cut_out_objects(const cv::Mat3b& image, const cv::Mat1b& part, const BoxSeeds& seeds, int min_margin_px) {
  cv::Mat1f to_object, to_background, to_ground;
  cv::distanceTransform(cv::Mat1b(~seeds.object), to_object, cv::DIST_L2, cv::DIST_MASK_5);
  cv::distanceTransform(cv::Mat1b(~seeds.background), to_background, cv::DIST_L2, cv::DIST_MASK_5);
  cv::distanceTransform(cv::Mat1b(~seeds.ground), to_ground, cv::DIST_L2, cv::DIST_MASK_5);
  cv::Mat1b state(part.size(), uchar{cv::GC_BGD});
  for (int y = 0; y < part.rows; ++y)
    for (int x = 0; x < part.cols; ++x) {
      if (part(y, x) == 0) continue;
      const bool is_nearer = to_object(y, x) <= to_background(y, x);
      state(y, x) = seeds.object(y, x) != 0 ? cv::GC_FGD
                    : seeds.background(y, x) != 0 && to_object(y, x) > kBoxMasks.min_distance_px
                        ? cv::GC_BGD
                        : (is_nearer ? cv::GC_PR_FGD : cv::GC_PR_BGD);
    }
  cv::Mat1b object = run_grab_cut(image, state);
  object |= cv::Mat1b(to_background > kBoxMasks.max_ray_gap_px);
  object |= cv::Mat1b(to_ground < to_background) & cv::Mat1b(to_ground < kBoxMasks.max_ground_px);
  object = grown(grown(object, kBoxMasks.gap_px), min_margin_px - kBoxMasks.gap_px);
  const NearestPixel seed(seeds.object);
  cv::Mat1f distance;
  cv::distanceTransform(cv::Mat1b(~object), distance, cv::DIST_L2, cv::DIST_MASK_5);
  for (int y = 0; y < part.rows; ++y)
    for (int x = 0; x < part.cols; ++x)
      if (part(y, x) != 0 && object(y, x) == 0)
        if (const auto nearest = seed.find({x, y}, kBoxMasks.max_reach_px))
          if (distance(y, x) <= seeds.margin_px(*nearest)) object(y, x) = 255;
  return cv::Mat1b(object & part);
}

// Returns the boxes of a part that contain too few seeds of an object of their own, which other boxes do not cover.
cv::Mat1b find_boxes_without_objects(const cv::Mat1b& part, const std::vector<cv::Rect>& boxes, const cv::Mat1b& seeds) {
  cv::Mat1b covering(part.size(), uchar{0}), out = covering.clone();
  for (const cv::Rect& box : boxes) cv::Mat1b(covering(box) + 1).copyTo(covering(box));
  const cv::Mat1b alone(covering == 1);
  for (const cv::Rect& box : boxes)
    if (cv::countNonZero(seeds(box) & alone(box)) < kBoxMasks.min_seeds) out(box).setTo(255, alone(box));
  return out;
}

// Returns the bounding box of the largest connected part of a mask.
cv::Rect find_largest_part(const cv::Mat1b& mask) {
  cv::Mat1i parts;
  cv::Mat1i stats;
  cv::Mat centers;
  const int count = cv::connectedComponentsWithStats(mask, parts, stats, centers, 8, CV_32S);
  int largest = 0;
  for (int i = 1; i < count; ++i)
    if (largest == 0 || stats(i, cv::CC_STAT_AREA) > stats(largest, cv::CC_STAT_AREA)) largest = i;
  return largest == 0 ? cv::Rect() : box_of_part(stats, largest);
}

// Removes from the background the boxes whose object does not reach across them. A bounding box touches its object on all
// sides: other rectangles, such as a banner or a mask of the ego vehicle, are removed as a whole.
void keep_other_rectangles(const BoxPart& part, cv::Mat1b& background) {
  const cv::Mat1b objects(part.mask & ~background);
  for (const cv::Rect& box : part.boxes) {
    const cv::Rect object = find_largest_part(objects(box));
    if (object.width < kBoxMasks.min_extent_share * box.width || object.height < kBoxMasks.min_extent_share * box.height)
      background(box).setTo(0);
  }
}

}  // namespace

std::vector<cv::Rect> split_into_boxes(const cv::Mat1b& part) {
  std::vector<cv::Rect> out;
  if (!is_box_shaped(part)) return out;
  cv::Mat1b rest = part.clone();
  const int area = cv::countNonZero(part);
  while (out.size() < kBoxMasks.max_boxes && cv::countNonZero(rest) > kBoxMasks.max_rest_share * area) {
    cv::Mat1i sums;
    cv::integral(rest, sums, CV_32S);
    cv::Rect best;
    int most = 0;
    visit_rectangles(part, [&](const cv::Rect& box) {
      const int covered = sums(box.br()) - sums(box.y, box.br().x) - sums(box.br().y, box.x) + sums(box.tl());
      if (std::min(box.width, box.height) >= kBoxMasks.min_side_px && covered > most) best = box, most = covered;
    });
    if (most == 0) break;
    rest(best) = 0;
    out.push_back(best);
  }
  return out;
}

std::vector<BoxPart> find_box_parts(const cv::Mat1b& mask) {
  std::vector<BoxPart> out;
  cv::Mat1i parts;
  cv::Mat1i stats;
  cv::Mat centers;
  const int count = cv::connectedComponentsWithStats(mask, parts, stats, centers, 8, CV_32S);
  for (int i = 1; i < count; ++i) {
    if (stats(i, cv::CC_STAT_AREA) > kBoxMasks.max_image_share * static_cast<double>(mask.total())) continue;
    const cv::Rect area = enlarge(box_of_part(stats, i), kBoxMasks.border_px, mask.size());
    BoxPart part{area, cv::Mat1b(parts(area) == i), {}};
    part.boxes = split_into_boxes(part.mask);
    if (!part.boxes.empty()) out.push_back(std::move(part));
  }
  return out;
}

cv::Mat1b find_fixed_pixels(const Lazy<cv::Mat1b>& masks) {
  const std::size_t count = std::min(masks.size(), kBoxMasks.max_masks);
  if (count < kBoxMasks.min_masks) return {};
  cv::Mat1w covering;
  for (std::size_t i = 0; i < count; ++i) {
    const auto mask = masks[i * masks.size() / count];
    if (covering.empty()) covering = cv::Mat1w(mask->size(), std::uint16_t{0});
    cv::add(covering, cv::Scalar(1), covering, *mask);
  }
  return cv::Mat1b(covering >= kBoxMasks.fixed_share * static_cast<double>(count));
}

cv::Mat1b find_background(const BoxPart& part, const cv::Mat3b& image, const BoxSeeds& seeds) {
  const BoxSeeds within{seeds.object(part.area), seeds.background(part.area), seeds.margin_px(part.area),
                        seeds.ground(part.area)};
  if (cv::countNonZero(within.object & part.mask) < kBoxMasks.min_seeds) return {part.mask.size(), uchar{0}};
  const int margin_px = std::max(1, cvRound(kSilhouetteMarginShare * image.cols));
  const cv::Mat1b kept = find_boxes_without_objects(part.mask, part.boxes, within.object);
  cv::Mat1b out(part.mask & ~kept & ~cut_out_objects(image(part.area).clone(), part.mask, within, margin_px));
  keep_other_rectangles(part, out);
  return out;
}

}  // namespace dvi::objects
