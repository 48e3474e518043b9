#include "dvi/sample/sample.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <map>
#include <memory>
#include <numeric>
#include <optional>
#include <utility>
#include <vector>

#include <opencv2/imgproc.hpp>

#include "dvi/drive/near_views.h"
#include "dvi/image/interpolate.h"
#include "dvi/sample/sighting.h"

namespace dvi::sample {
namespace {

double seconds_between(const View& a, const View& b) {
  if (a.drive != b.drive) return kSecondsElsewhere;
  return static_cast<double>(std::llabs(a.time_ns - b.time_ns)) * 1e-9 + (a.sequence != b.sequence ? kSecondsOfRig : 0);
}

/// Pixels of the source to be averaged where one pixel of the target spans so many, all of them clear of the mask and of other
/// surfaces.
uchar pixels_spanned(double spanned, float clear_px) {
  constexpr int kMost = 8;
  const int clear = 2 * static_cast<int>(clear_px) + 1;
  return static_cast<uchar>(std::clamp(cvRound(spanned), 1, std::min(kMost, clear)));
}

/// Meters between two cameras beyond which they do not show the same sky; parts of a drive that nothing ties together lie
/// farther apart, and do not even share a heading.
constexpr double kMaxSkyDistanceM = 2000;

/// One source, asked for pixels of the target.
class Source {
 public:
  Source(const depth::Target& target, std::size_t source, const SampleOptions& options)
      : number_(source),
        view_(target.views[source]),
        other_day_(view_.drive != target.view().drive),
        source_from_target_(view_.camera_from_world * target.view().camera_from_world.inverse()),
        seconds_(seconds_between(view_, target.view())),
        visibility_(target.visibility),
        options_(options) {}

  /// None unless it is trusted more than `than`.
  std::optional<Candidate> show(const SurfacePixel& pixel, float than) {
    const bool is_apart = other_day_ || source_from_target_.t.norm() > kMaxSkyDistanceM;
    if (is_apart && pixel.at.z() >= depth::DepthMap::kInfinity) return std::nullopt;  // no sky stays
    const std::optional<SourcePosition> place = locate(pixel, view_.camera, source_from_target_);
    if (!place) return std::nullopt;
    const cv::Point2f at = quantized(place->position.x(), place->position.y());
    if (!view_.camera.contains({at.x, at.y})) return std::nullopt;
    if (!lent_) lent_ = visibility_[number_];
    if (lent_->is_masked(at)) return std::nullopt;
    const float clear = lent_->clearance_px(at);
    if (options_.scored && static_cast<float>(most_trust(seconds_, clear)) <= than) return std::nullopt;
    if (options_.occlusion_test && !same_surface(at, place->z, pixel.sigma)) return std::nullopt;
    const std::optional<SourceFootprint> seen = sight(pixel, *place, view_.camera, source_from_target_);
    if (!seen) return std::nullopt;
    Candidate out{static_cast<int>(number_), at};
    out.misplaced = static_cast<float>(expected_shift(*seen, seconds_));
    if (options_.footprint) {
      out.footprint = {pixels_spanned(seen->across, clear), pixels_spanned(seen->down, clear)};
    }
    if (!options_.scored) return out;
    if (expected_error(*seen, seconds_) > options_.max_error_px) return std::nullopt;
    out.trust = static_cast<float>(trust(*seen, seconds_, clear));
    return out;
  }

 private:
  bool same_surface(cv::Point2f at, double z, double sigma) const {
    const double off = depth::VisibilityMap::kMaxSigmas * sigma;
    return !lent_->occludes(at, z - off, options_.occlusion_tolerance) &&
           !lent_->is_farther(at, z + off, options_.occlusion_tolerance);
  }

  std::size_t number_;
  const View& view_;
  bool other_day_;
  SE3 source_from_target_;
  double seconds_;
  const Lazy<depth::VisibilityMap>& visibility_;
  const SampleOptions& options_;
  std::shared_ptr<const depth::VisibilityMap> lent_;  // once a pixel may be seen
};

/// The best candidates of each pixel so far.
class Ranking {
 public:
  Ranking(std::size_t pixels, std::size_t ranks) : ranks_(ranks), candidates_(pixels * ranks), least_(pixels, kOpen) {}

  /// Behind those that are trusted as much.
  void add(std::size_t pixel, const Candidate& candidate) {
    Candidate* const begin = &candidates_[pixel * ranks_];
    Candidate* const end = begin + ranks_;
    Candidate* const place =
        std::find_if(begin, end, [&](const Candidate& c) { return !c.found() || c.trust < candidate.trust; });
    if (place == end) return;
    std::move_backward(place, end - 1, end);
    *place = candidate;
    if (end[-1].found()) least_[pixel] = end[-1].trust;
  }
  /// A candidate is kept if it is trusted more than this.
  float least(std::size_t pixel) const { return least_[pixel]; }
  Candidates finish(Region&& hole) const {
    Candidates out{std::move(hole), {}, ranks_ - 1, {}};
    out.leading.reserve(out.hole.size());
    out.extra.reserve(out.hole.size() * out.extra_per_pixel);
    for (std::size_t i = 0; i < out.hole.size(); ++i) {
      const Candidate* const begin = &candidates_[i * ranks_];
      out.leading.push_back(*begin);
      out.extra.insert(out.extra.end(), begin + 1, begin + ranks_);
    }
    return out;
  }

 private:
  static constexpr float kOpen = -1;
  std::size_t ranks_;
  std::vector<Candidate> candidates_;
  std::vector<float> least_;  // the trust of each pixel's last one
};

/// Pixels round the mask on a grid: not those beside it, which traffic may blur into, nor far from it.
Region known_pixels(const cv::Mat1b& mask) {
  constexpr int kBeside = 4, kFar = 40, kStep = 6;  // px
  cv::Mat1b near(grown(mask, kFar));
  near.setTo(0, grown(mask, kBeside));
  for (int y = 0; y < near.rows; ++y)
    for (int x = 0; x < near.cols; ++x)
      if (x % kStep != 0 || y % kStep != 0) near(y, x) = 0;
  return Region(near);
}

/// For each of the pixels, the nearest one of the hole that was found; `hole.size()` where none was.
std::vector<std::size_t> nearest_found(const Candidates& hole, const Region& pixels) {
  cv::Mat1b missing(hole.hole.index.size(), uchar{255});
  for (std::size_t i = 0; i < hole.leading.size(); ++i)
    if (hole.leading[i].found()) missing(hole.hole.pixels[i]) = 0;
  if (cv::countNonZero(missing) == static_cast<int>(missing.total()))
    return std::vector<std::size_t>(pixels.size(), hole.hole.size());
  cv::Mat distance;
  cv::Mat1i label;
  cv::distanceTransform(missing, distance, label, cv::DIST_L2, cv::DIST_MASK_5, cv::DIST_LABEL_PIXEL);
  std::vector<std::size_t> of_label(static_cast<std::size_t>(cv::countNonZero(missing == 0)) + 1);
  for (const cv::Point p : hole.hole.pixels)
    if (missing(p) == 0) of_label[static_cast<std::size_t>(label(p))] = static_cast<std::size_t>(hole.hole.index(p));
  std::vector<std::size_t> out;
  out.reserve(pixels.size());
  for (const cv::Point p : pixels.pixels) out.push_back(of_label[static_cast<std::size_t>(label(p))]);
  return out;
}

}  // namespace

Candidates sample_known(const depth::Target& target, const Candidates& hole, const SampleOptions& options) {
  Region known = known_pixels(*target.mask());
  const std::vector<std::size_t> nearest = nearest_found(hole, known);
  std::map<std::size_t, std::vector<SurfacePixel>> of_view;
  for (const SurfacePixel& surface : surface_pixels(known, target.view().camera, target.depth)) {
    const std::size_t like = nearest[surface.pixel];
    if (like == hole.hole.size()) continue;
    const auto ask = [&](const Candidate& c) {
      if (c.found() && target.views[c.view].drive == target.view().drive)
        of_view[static_cast<std::size_t>(c.view)].push_back(surface);
    };
    ask(hole.leading[like]);
    for (const Candidate& c : hole.others(like)) ask(c);
  }
  Ranking ranking(known.size(), hole.extra_per_pixel + 1);
  for (const auto& [view, surface] : of_view) {
    Source source(target, view, options);
    for (const SurfacePixel& pixel : surface)
      if (const std::optional<Candidate> candidate = source.show(pixel, ranking.least(pixel.pixel)))
        ranking.add(pixel.pixel, *candidate);
  }
  return ranking.finish(std::move(known));
}

std::vector<std::size_t> search_order(const Views& views, std::size_t target, const SampleOptions& options) {
  const std::size_t reach = options.max_frame_gap > 0 ? static_cast<std::size_t>(options.max_frame_gap) : views.size();
  const auto [first, last] = views.of_sequence(views[target].sequence);
  std::vector<std::size_t> order;
  for (std::size_t i = target + 1; i < std::min(last, target + 1 + reach); ++i) order.push_back(i);
  for (std::size_t i = target; i-- > std::max(first, target - std::min(target, reach));) order.push_back(i);
  for (const std::size_t i : of_other_cameras(views, target, reach)) order.push_back(i);
  const auto seconds = [&](std::size_t i) { return seconds_between(views[i], views[target]); };
  if (options.scored)
    std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return seconds(a) < seconds(b); });
  for (const std::size_t i : nearest_of_other_drives(views, target, 2 * reach)) order.push_back(i);
  std::erase_if(order, [&](std::size_t i) { return !shares_colors(views[i], views[target]); });
  return order;
}

Candidates sample(const depth::Target& target, const SampleOptions& options) {
  Region hole(*target.mask());
  Ranking ranking(hole.size(), options.scored ? static_cast<std::size_t>(options.sources) : 1);
  const std::vector<SurfacePixel> surface = surface_pixels(hole, target.view().camera, target.depth);
  std::vector<std::uint32_t> open(surface.size());  // those that may still find a better source
  std::iota(open.begin(), open.end(), 0U);
  for (const std::size_t i : search_order(target.views, target.index, options)) {
    // Frames of the target's drive come by falling trust: what is full stays as it is.
    const double most = options.scored ? most_trust(seconds_between(target.views[i], target.view())) : 1;
    std::erase_if(open, [&](std::uint32_t k) { return ranking.least(surface[k].pixel) >= most; });
    if (open.empty()) break;
    Source source(target, i, options);
    for (const std::uint32_t k : open) {
      const std::size_t pixel = surface[k].pixel;
      const std::optional<Candidate> candidate = source.show(surface[k], ranking.least(pixel));
      if (candidate) ranking.add(pixel, *candidate);
    }
  }
  return ranking.finish(std::move(hole));
}

}  // namespace dvi::sample
