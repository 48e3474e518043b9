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

#include "dvi/core/lazy.h"
#include "dvi/core/threads.h"
#include "dvi/drive/near_views.h"
#include "dvi/image/interpolate.h"
#include "dvi/image/nearest_pixel.h"
#include "dvi/sample/source_score.h"

namespace dvi::sample {
namespace {

double seconds_between(const View& a, const View& b) {
  if (a.drive != b.drive) return kSourceScore.other_drive_s;
  return static_cast<double>(std::llabs(a.time_ns - b.time_ns)) * 1e-9 +
         (a.sequence != b.sequence ? kSourceScore.other_camera_s : 0);
}

/// Rounds an extent of a footprint to whole source pixels, all of which are clear of the mask and of other surfaces.
uchar round_extent(double extent_px, float clearance_px) {
  constexpr int kMaxExtentPx = 8;
  const int clear = 2 * static_cast<int>(clearance_px) + 1;
  return static_cast<uchar>(std::clamp(cvRound(extent_px), 1, std::min(kMaxExtentPx, clear)));
}

/// Source frames whose visibility is computed at the same time. More would be computed in vain for pixels that the first of
/// them show well enough.
constexpr std::size_t kSourcesAhead = 8;

/// A source frame in which pixels of the target are searched.
class Source {
 public:
  Source(const depth::Target& target, std::size_t source, const SampleOptions& options)
      : number_(source),
        view_(target.views[source]),
        is_other_drive_(view_.drive != target.view().drive),
        source_from_target_(view_.camera_from_world * target.view().camera_from_world.inverse()),
        seconds_(seconds_between(view_, target.view())),
        visibility_(target.visibility),
        options_(options) {}

  /// Returns whether a pixel projects into the image of the source.
  bool contains(const SurfacePixel& pixel) const { return project(pixel).has_value(); }

  std::size_t number() const { return number_; }

  /// Sets the visibility of the source, which find_candidate() otherwise loads.
  void set_visibility(std::shared_ptr<const depth::VisibilityMap> visible) { visible_ = std::move(visible); }

  /// Returns the candidate for a pixel, or nothing if the source does not show it with a score above `min_score`.
  std::optional<Candidate> find_candidate(const SurfacePixel& pixel, float min_score) {
    const std::optional<SourcePosition> projection = project(pixel);
    if (!projection) return std::nullopt;
    const cv::Point2f at = quantize(projection->position.x(), projection->position.y());
    if (!visible_) visible_ = visibility_[number_];
    if (visible_->is_masked(at)) return std::nullopt;
    const float clearance = visible_->clearance_px(at);
    if (options_.scored && static_cast<float>(max_score(seconds_, clearance)) <= min_score) return std::nullopt;
    if (options_.occlusion_test && !shows_surface(at, projection->z, pixel.sigma)) return std::nullopt;
    const std::optional<SourceFootprint> footprint = measure_footprint(pixel, *projection, view_.camera, source_from_target_);
    if (!footprint) return std::nullopt;
    Candidate out{static_cast<int>(number_), at};
    out.position_error_px = static_cast<float>(estimate_position_error_px(*footprint, seconds_));
    if (options_.footprint)
      out.footprint = {round_extent(footprint->across, clearance), round_extent(footprint->down, clearance)};
    if (!options_.scored) return out;
    if (estimate_copy_error_px(*footprint, seconds_) > options_.max_error_px) return std::nullopt;
    out.score = static_cast<float>(score_source(*footprint, seconds_, clearance));
    return out;
  }

 private:
  std::optional<SourcePosition> project(const SurfacePixel& pixel) const {
    const bool is_other_sky = is_other_drive_ || source_from_target_.t.norm() > kSourceScore.max_sky_distance_m;
    if (is_other_sky && pixel.depth_m >= depth::DepthMap::kInfinity) return std::nullopt;
    std::optional<SourcePosition> projection = locate(pixel, view_.camera, source_from_target_);
    if (!projection) return std::nullopt;
    const cv::Point2f at = quantize(projection->position.x(), projection->position.y());
    if (!view_.camera.contains({at.x, at.y})) projection.reset();
    return projection;
  }
  bool shows_surface(cv::Point2f at, double z, double sigma) const {
    const double off = depth::VisibilityMap::kMaxSigmas * sigma;
    return !visible_->occludes(at, z - off, options_.occlusion_tolerance) &&
           !visible_->is_farther(at, z + off, options_.occlusion_tolerance);
  }

  std::size_t number_;
  const View& view_;
  bool is_other_drive_;
  SE3 source_from_target_;
  double seconds_;
  const Lazy<depth::VisibilityMap>& visibility_;
  const SampleOptions& options_;
  std::shared_ptr<const depth::VisibilityMap> visible_;
};

/// The candidates of each pixel with the highest scores so far.
class Ranking {
 public:
  Ranking(std::size_t pixels, std::size_t ranks) : ranks_(ranks), candidates_(pixels * ranks), min_score_(pixels, kNoScore) {}

  /// Inserts a candidate behind those with the same or a higher score.
  void add(std::size_t pixel, const Candidate& candidate) {
    Candidate* const begin = &candidates_[pixel * ranks_];
    Candidate* const end = begin + ranks_;
    Candidate* const place =
        std::find_if(begin, end, [&](const Candidate& c) { return !c.found() || c.score < candidate.score; });
    if (place == end) return;
    std::move_backward(place, end - 1, end);
    *place = candidate;
    if (end[-1].found()) min_score_[pixel] = end[-1].score;
  }
  /// The score above which a further candidate of the pixel is kept.
  float min_score(std::size_t pixel) const { return min_score_[pixel]; }
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
  static constexpr float kNoScore = -1;
  std::size_t ranks_;
  std::vector<Candidate> candidates_;
  std::vector<float> min_score_;  // one per pixel
};

/// Parameters of the known pixels around a hole.
struct KnownPixelParams {
  int min_distance_px = 4;   ///< Smallest distance to the mask; nearer pixels may be blended with the removed object.
  int max_distance_px = 40;  ///< Largest distance to the mask.
  int step_px = 6;           ///< Spacing of the grid.
};
constexpr KnownPixelParams kKnownPixels;

/// Selects known pixels around the mask, on a grid.
Region select_known_pixels(const cv::Mat1b& mask) {
  cv::Mat1b near(grown(mask, kKnownPixels.max_distance_px));
  near.setTo(0, grown(mask, kKnownPixels.min_distance_px));
  for (int y = 0; y < near.rows; ++y)
    for (int x = 0; x < near.cols; ++x)
      if (x % kKnownPixels.step_px != 0 || y % kKnownPixels.step_px != 0) near(y, x) = 0;
  return Region(near);
}

/// Finds, for each of the pixels, the index of the nearest hole pixel that has a candidate; the size of the hole if none has.
std::vector<std::size_t> find_nearest_copied(const Candidates& hole, const Region& pixels) {
  if (pixels.size() == 0) return {};
  cv::Mat1b copied(hole.hole.index.size(), uchar{0}), used(copied.size(), uchar{0});
  for (std::size_t i = 0; i < hole.leading.size(); ++i)
    if (hole.leading[i].found()) copied(hole.hole.pixels[i]) = used(hole.hole.pixels[i]) = 255;
  for (const cv::Point p : pixels.pixels) used(p) = 255;
  const cv::Rect box = cv::boundingRect(used);  // pixels outside it cannot be nearer
  const NearestPixel nearest(copied(box));
  std::vector<std::size_t> out;
  out.reserve(pixels.size());
  for (const cv::Point p : pixels.pixels) {
    const std::optional<cv::Point> found = nearest.find(p - box.tl());
    out.push_back(found ? static_cast<std::size_t>(hole.hole.index(*found + box.tl())) : hole.hole.size());
  }
  return out;
}

}  // namespace

Candidates sample_known(const depth::Target& target, const Candidates& hole, const SampleOptions& options) {
  Region known = select_known_pixels(*target.mask());
  const std::vector<std::size_t> nearest = find_nearest_copied(hole, known);
  std::map<std::size_t, std::vector<SurfacePixel>> of_view;
  for (const SurfacePixel& surface : find_surface_pixels(known, target.view().camera, target.depth)) {
    const std::size_t copied = nearest[surface.pixel];
    if (copied == hole.hole.size()) continue;
    const auto add = [&](const Candidate& c) {
      if (c.found() && target.views[c.view].drive == target.view().drive)
        of_view[static_cast<std::size_t>(c.view)].push_back(surface);
    };
    add(hole.leading[copied]);
    for (const Candidate& c : hole.others(copied)) add(c);
  }
  Ranking ranking(known.size(), hole.extra_per_pixel + 1);
  for (const auto& [view, surface] : of_view) {
    Source source(target, view, options);
    for (const SurfacePixel& pixel : surface)
      if (const std::optional<Candidate> candidate = source.find_candidate(pixel, ranking.min_score(pixel.pixel)))
        ranking.add(pixel.pixel, *candidate);
  }
  return ranking.finish(std::move(known));
}

std::vector<std::size_t> list_search_order(const Views& views, std::size_t target, const SampleOptions& options) {
  const std::size_t max_gap = options.max_frame_gap > 0 ? static_cast<std::size_t>(options.max_frame_gap) : views.size();
  const auto [first, last] = views.of_sequence(views[target].sequence);
  std::vector<std::size_t> order;
  for (std::size_t i = target + 1; i < std::min(last, target + 1 + max_gap); ++i) order.push_back(i);
  for (std::size_t i = target; i-- > std::max(first, target - std::min(target, max_gap));) order.push_back(i);
  for (const std::size_t i : list_views_of_other_cameras(views, target, max_gap)) order.push_back(i);
  const auto seconds = [&](std::size_t i) { return seconds_between(views[i], views[target]); };
  if (options.scored)
    std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return seconds(a) < seconds(b); });
  for (const std::size_t i : find_nearest_views_of_other_drives(views, target, 2 * max_gap)) order.push_back(i);
  std::erase_if(order, [&](std::size_t i) { return !shares_colors(views[i], views[target]); });
  return order;
}

Candidates sample(const depth::Target& target, const SampleOptions& options) {
  Region hole(*target.mask());
  Ranking ranking(hole.size(), options.scored ? static_cast<std::size_t>(options.sources) : 1);
  const std::vector<SurfacePixel> surface = find_surface_pixels(hole, target.view().camera, target.depth);
  std::vector<std::uint32_t> open(surface.size());  // pixels that may still find a better source
  std::iota(open.begin(), open.end(), 0U);
  const std::vector<std::size_t> order = list_search_order(target.views, target.index, options);
  for (std::size_t first = 0; first < order.size() && !open.empty(); first += kSourcesAhead) {
    std::vector<Source> sources;
    std::vector<double> bounds;
    for (std::size_t k = first; k < std::min(first + kSourcesAhead, order.size()); ++k) {
      sources.emplace_back(target, order[k], options);
      bounds.push_back(options.scored ? max_score(seconds_between(target.views[order[k]], target.view())) : 1);
    }
    std::vector<char> is_needed(sources.size(), 0);
    parallel_for(sources.size(), [&](std::size_t k) {
      const auto needs = [&](std::uint32_t i) {
        return ranking.min_score(surface[i].pixel) < bounds[k] && sources[k].contains(surface[i]);
      };
      is_needed[k] = std::any_of(open.begin(), open.end(), needs) ? 1 : 0;
    });
    std::vector<std::size_t> needed, numbers;
    for (std::size_t k = 0; k < sources.size(); ++k)
      if (is_needed[k] != 0) needed.push_back(k), numbers.push_back(sources[k].number());
    for_each_item(target.visibility, numbers, [&](std::size_t n, std::shared_ptr<const depth::VisibilityMap> visible) {
      sources[needed[n]].set_visibility(std::move(visible));
    });
    for (const std::size_t k : needed) {
      // Later frames have lower scores, so that they cannot improve pixels whose candidates all have higher ones.
      std::erase_if(open, [&](std::uint32_t i) { return ranking.min_score(surface[i].pixel) >= bounds[k]; });
      for (const std::uint32_t i : open) {
        const std::size_t pixel = surface[i].pixel;
        const std::optional<Candidate> candidate = sources[k].find_candidate(surface[i], ranking.min_score(pixel));
        if (candidate) ranking.add(pixel, *candidate);
      }
    }
  }
  return ranking.finish(std::move(hole));
}

}  // namespace dvi::sample
