#include "dvi/synthesize/exemplars.h"

#include <algorithm>
#include <optional>
#include <utility>
#include <vector>

#include <opencv2/imgproc.hpp>

#include "dvi/image/region.h"
#include "dvi/synthesize/exemplar_level.h"
#include "dvi/synthesize/exemplar_search.h"

namespace dvi::synthesize {
namespace {

/// Parameters of the pyramid and of the division into parts.
struct CompletionParams {
  int max_levels = 6;           ///< Levels of the pyramid.
  double coarse_radius = 3;     ///< The coarsest level has holes with inscribed circles of this radius, in pixels.
  int min_size_px = 48;         ///< Smallest width and height of a level that is halved.
  int coarse_rounds = 12;       ///< Rounds of search and votes at the coarsest level.
  int fine_rounds = 3;          ///< Rounds at the finest level; others have a number in between.
  int final_radius_px = 1;      ///< Distance of the patches that have the last vote, for sharp colors.
  int part_distance_px = 48;    ///< Half of the distance from which on unknown parts are completed on their own.
  int min_margin_px = 100;      ///< Least extent of the surroundings in which exemplars are searched.
  int min_exemplars = 30000;    ///< Least number of usable pixels in them ...
  int exemplars_per_pixel = 4;  ///< ... plus this number per unknown pixel.
};
constexpr CompletionParams kCompletion;

/// Makes the pyramid of an image until its largest hole is small.
std::vector<ExemplarLevel> make_levels(ExemplarLevel finest) {
  cv::Mat1f inside;
  cv::distanceTransform(finest.unknown, inside, cv::DIST_L2, cv::DIST_MASK_PRECISE);
  double largest = 0;
  cv::minMaxLoc(inside, nullptr, &largest);
  std::vector<ExemplarLevel> levels{std::move(finest)};
  while (static_cast<int>(levels.size()) < kCompletion.max_levels && largest > kCompletion.coarse_radius &&
         std::min(levels.back().size().width, levels.back().size().height) > kCompletion.min_size_px) {
    levels.push_back(halve(levels.back()));
    largest /= 2;
  }
  return levels;
}

}  // namespace

std::vector<UnknownPart> divide_for_search(const cv::Mat1b& unknown, const cv::Mat1b& usable) {
  cv::Mat1i labels;
  const int count = label_connected_parts(grown_far(unknown, kCompletion.part_distance_px), labels);
  std::vector<UnknownPart> out;
  for (int label = 1; label <= count; ++label) {
    const cv::Mat1b part(unknown & (labels == label));
    const cv::Rect tight = cv::boundingRect(part), all({}, unknown.size());
    if (tight.empty()) continue;
    const int wanted = kCompletion.min_exemplars + kCompletion.exemplars_per_pixel * cv::countNonZero(part);
    cv::Rect box;
    for (int margin = kCompletion.min_margin_px; box != all; margin *= 2) {
      box = cv::Rect(tight.x - margin, tight.y - margin, tight.width + 2 * margin, tight.height + 2 * margin) & all;
      if (cv::countNonZero(usable(box)) >= wanted) break;
    }
    out.push_back({box, part(box)});
  }
  return out;
}

void complete_from_exemplars(cv::Mat3f& color, const ExemplarMasks& masks, const SurfaceGuide& guide, std::uint64_t seed) {
  const auto& [unknown, usable] = masks;
  if (cv::countNonZero(unknown) == 0) return;
  ExemplarLevel finest;
  cv::cvtColor(color, finest.color, cv::COLOR_BGR2BGRA);
  finest.color = finest.color.mul(cv::Scalar(1, 1, 1, 0));
  finest.prior = finest.color.clone();
  finest.unknown = unknown.clone();
  finest.usable = usable & ~unknown & (guide.group != 0);
  finest.group = guide.group;
  finest.ground = guide.ground.clone();
  derive_level(finest);
  std::vector<ExemplarLevel> levels = make_levels(std::move(finest));
  std::optional<ExemplarSearch> coarser;
  const int count = static_cast<int>(levels.size());
  for (int k = count - 1; k >= 0; --k) {
    ExemplarSearch search(levels[k], seed + static_cast<std::uint64_t>(k));
    search.start(coarser ? &*coarser : nullptr);
    coarser.reset();
    levels.resize(k + 1);  // the coarser levels are no longer needed
    if (k + 1 < count) search.vote();
    const int more = count == 1 ? 0 : (kCompletion.coarse_rounds - kCompletion.fine_rounds) * k / (count - 1);
    for (int round = 0; round < kCompletion.fine_rounds + more; ++round) {
      search.improve(round % 2 == 0);
      search.vote();
    }
    if (k == 0) search.vote(kCompletion.final_radius_px);
    coarser.emplace(std::move(search));
  }
  for (const cv::Point p : coarser->targets().pixels)
    if (unknown(p) != 0 && coarser->match(p).found())
      for (int c = 0; c < 3; ++c) color(p)[c] = levels.front().color(p)[c];
}

}  // namespace dvi::synthesize
