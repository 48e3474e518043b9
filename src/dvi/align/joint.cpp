#include "dvi/align/joint.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <functional>
#include <numeric>
#include <optional>
#include <set>
#include <utility>

#include <fmt/format.h>

#include "dvi/align/joint_solve.h"
#include "dvi/align/pair_store.h"
#include "dvi/align/unmasked_points.h"
#include "dvi/core/threads.h"
#include "dvi/drive/near_views.h"
#include "dvi/geometry/angles.h"

namespace dvi::align {
namespace {

/// Shares of the expected rotations that are tried: poses that are already good need a stronger prior.
constexpr std::array<double, 3> kPriorShares{0.1, 0.3, 1};

using Poses = std::vector<SE3>;  // camera_from_world of the views of a sequence

/// Finds for each view of a sequence the most similar views of earlier sequences, which constrain it.
std::vector<std::vector<std::size_t>> find_anchors(const SequenceViews& sequence) {
  std::vector<std::vector<std::size_t>> out;
  for (std::size_t i = sequence.first; sequence.first > 0 && i < sequence.last; ++i)
    out.push_back(find_nearest_views(sequence.views, i, {0, sequence.first}, {kAnchors, kJoint.radian_m}));
  return out;
}

/// The views of a sequence, followed by their anchors, and the pairs that are compared.
struct ChainViews {
  std::vector<std::size_t> views;
  Partners partners;

  explicit ChainViews(const SequenceViews& sequence)
      : views(sequence.last - sequence.first),
        partners{views.size(), find_anchors(sequence),
                 sequence.views[sequence.first].sensor == Sensor::depth_camera ? kJoint.max_handheld_frame_distance
                                                                               : kJoint.max_frame_distance} {
    std::iota(views.begin(), views.end(), sequence.first);
    std::set<std::size_t> anchors;
    for (const auto& of_view : partners.anchors) anchors.insert(of_view.begin(), of_view.end());
    views.insert(views.end(), anchors.begin(), anchors.end());
    const auto begin = views.begin() + static_cast<std::ptrdiff_t>(partners.count);
    for (auto& of_view : partners.anchors)
      for (std::size_t& anchor : of_view)
        anchor = static_cast<std::size_t>(std::lower_bound(begin, views.end(), anchor) - views.begin());
  }
};

/// The pairs of views of a sequence and their photometric models.
class Chain {
 public:
  /// `aligned` has the poses of the sequences before.
  Chain(const SequenceViews& sequence, const ChainViews& members, const Cameras& aligned, const AlignOptions& options)
      : views_(sequence.views),
        map_(sequence.map),
        members_(members.views),
        count_(members.partners.count),
        options_(options),
        pairs_(sequence.map.map, members.partners) {
    for (std::size_t i = count_; i < members_.size(); ++i) anchors_.push_back(aligned.camera_from_world[members_[i]]);
    const Camera& camera = view(0).camera;
    const double capture_px =
        kJoint.min_capture * std::max(to_radians(*options.rotation_deg), to_radians(options.mounting_deg)) * camera.fx;
    while (capture_px > 2 * std::exp2(coarsest_) && std::min(camera.width, camera.height) >> coarsest_ > 64) ++coarsest_;
    images_ = {members_.size(), [this](std::size_t i) {
                 return make_band_pass(*views_.images[members_[i]], *views_.masks[members_[i]],
                                       static_cast<int>(coarsest_) + 1);
               }};
  }

  /// Finds the pairs and returns their models at the given poses.
  std::vector<PairModel> find_pairs(const Tick& tick);
  std::vector<PairModel> fit_models(const Corrections& now, std::size_t coarsest, const Tick& tick) const;
  struct Check {
    std::vector<double> cost;       // per candidate
    std::vector<double> offset_px;  // median, per candidate
    int points = 0;
  };
  std::vector<Check> check(const std::vector<PairModel>& models, const std::vector<Poses>& candidates, const Tick& tick) const;

  std::size_t coarsest() const { return coarsest_; }
  std::size_t bytes_per_view() const {
    return kJoint.bytes_per_pixel * static_cast<std::size_t>(view(0).camera.width) *
           static_cast<std::size_t>(view(0).camera.height);
  }
  bool is_anchored() const { return members_.size() > count_; }
  Poses apply(const Corrections& c) const;

 private:
  std::vector<SharedPoint> find_shared_points(std::size_t i, const Lazy<UnmaskedPoints>& sights) const;
  std::vector<PairModel> fit_models_of(std::size_t i, const Poses& poses, std::size_t coarsest, const Tick& tick) const;
  std::vector<map::VisiblePoint> select_textured(const UnmaskedPoints& sight, const View& view, const cv::Mat1f& texture) const;
  const View& view(std::size_t i) const { return views_[members_[i]]; }
  PosedImage get_posed(std::size_t i, const Poses& poses) const { return {view(i).camera, poses[i], images_[i]}; }

  const Views& views_;
  const map::VisibleMap& map_;
  std::vector<std::size_t> members_;  // indices of the views of the sequence, then of its anchors
  std::size_t count_, coarsest_ = 0;  // views of the sequence, and the coarsest pyramid level
  Poses anchors_;
  const AlignOptions& options_;
  Lazy<BandPass> images_;
  PairStore pairs_;
};

Poses Chain::apply(const Corrections& c) const {
  Poses out;
  for (std::size_t i = 0; i < count_; ++i)
    out.push_back(SE3{so3_exp(c.rotations[i]), c.positions[i]} * view(i).camera_from_world);
  out.insert(out.end(), anchors_.begin(), anchors_.end());
  return out;
}

// Selects the point with the most texture in each cell of a grid over the image.
std::vector<map::VisiblePoint> Chain::select_textured(const UnmaskedPoints& sight, const View& view,
                                                      const cv::Mat1f& texture) const {
  const cv::Size size(view.camera.width, view.camera.height);
  const double cell = std::max(1.0, std::sqrt(static_cast<double>(size.area()) / options_.points));
  const int columns = static_cast<int>(size.width / cell) + 1, rows = static_cast<int>(size.height / cell) + 1;
  std::vector<map::VisiblePoint> best(static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows));
  std::vector<double> slope(best.size(), kJoint.min_slope);
  for (const map::VisiblePoint& p : sight.points()) {
    const int column = static_cast<int>((p.u + 0.5) / cell), row = static_cast<int>((p.v + 0.5) / cell);
    const std::size_t at = static_cast<std::size_t>(row) * static_cast<std::size_t>(columns) + static_cast<std::size_t>(column);
    const double here = sample(texture, size, {p.u, p.v}).slope.norm();
    if (here <= slope[at] || sight.is_near_edge(p)) continue;
    slope[at] = here;
    best[at] = p;
  }
  std::erase_if(best, [](const map::VisiblePoint& p) { return p.z == 0; });
  return best;
}

std::vector<SharedPoint> Chain::find_shared_points(std::size_t i, const Lazy<UnmaskedPoints>& sights) const {
  std::vector<SharedPoint> out;
  for (const map::VisiblePoint& point : select_textured(*sights[i], view(i), images_[i]->front()))
    out.push_back({.index = point.index, .observed_by = 0});
  for (std::size_t k = 0; k < kPartners + kAnchors; ++k) {
    const std::optional<std::size_t> partner = pairs_.partners().get(i, k);
    if (!partner) continue;
    const View& other = view(*partner);
    const auto sight = sights[*partner];
    for (SharedPoint& point : out) {
      const Eigen::Vector3d p = other.camera_from_world * map_.map.points[point.index].position.cast<double>();
      if (!other.camera.in_front(p)) continue;
      const Eigen::Vector2d pixel = other.camera.project(p);
      if (other.camera.contains(pixel) && sight->is_visible(pixel, other.camera.depth(p)))
        point.observed_by = static_cast<std::uint16_t>(point.observed_by | 1U << k);
    }
  }
  return out;
}

std::vector<PairModel> Chain::fit_models_of(std::size_t i, const Poses& poses, std::size_t coarsest, const Tick& tick) const {
  const double expected = 2 * std::hypot(to_radians(*options_.rotation_deg), to_radians(options_.mounting_deg));
  const Freedom freedom = get_expected_position_m(view(0).sensor) > 0 ? Freedom::pose : Freedom::rotation;
  const PosedImage moving = get_posed(i, poses);
  std::vector<PairModel> out;
  for (const Pair& pair : pairs_.get_pairs(i))
    if (auto model = fit_pair({pair, moving, get_posed(pair.fixed, poses)}, coarsest, expected, freedom)) out.push_back(*model);
  tick();
  return out;
}

/// Appends the models of the views [first, last), which `fit` makes.
void add_models(std::size_t first, std::size_t last, const std::function<std::vector<PairModel>(std::size_t)>& fit,
                std::vector<PairModel>& all) {
  std::vector<std::vector<PairModel>> by_view(last - first);
  parallel_for(by_view.size(), [&](std::size_t i) { by_view[i] = fit(first + i); });
  for (const auto& some : by_view) all.insert(all.end(), some.begin(), some.end());
}

// Finds pairs and fits models in one pass, while the images are in memory.
std::vector<PairModel> Chain::find_pairs(const Tick& tick) {
  const Lazy<UnmaskedPoints> sights(
      members_.size(), [this](std::size_t i) { return UnmaskedPoints(*map_.points[members_[i]], *views_.masks[members_[i]]); });
  const Poses given = apply(Corrections(count_));
  const auto fit = [&](std::size_t i) { return fit_models_of(i, given, coarsest_, tick); };
  std::vector<PairModel> all;
  for_blocks(
      count_,
      [&](std::size_t first, std::size_t last) {
        std::vector<std::vector<SharedPoint>> points(last - first);
        parallel_for(points.size(), [&](std::size_t i) { points[i] = find_shared_points(first + i, sights); });
        for (const std::vector<SharedPoint>& of_view : points) pairs_.add(of_view);
        add_models(first, last, fit, all);
      },
      bytes_per_view());
  return all;
}

std::vector<PairModel> Chain::fit_models(const Corrections& now, std::size_t coarsest, const Tick& tick) const {
  const Poses poses = apply(now);
  const auto fit = [&](std::size_t i) { return fit_models_of(i, poses, coarsest, tick); };
  std::vector<PairModel> all;
  for_blocks(count_, [&](std::size_t first, std::size_t last) { add_models(first, last, fit, all); }, bytes_per_view());
  return all;
}

/// Finds the model of a pair; models are in the order of the moving views. Null if the pair had too few points.
const PairModel* find_model(const Pair& pair, const std::vector<PairModel>& models) {
  auto model = std::lower_bound(models.begin(), models.end(), pair.moving,
                                [](const PairModel& m, std::size_t moving) { return m.moving < moving; });
  for (; model != models.end() && model->moving == pair.moving; ++model)
    if (model->fixed == pair.fixed) return &*model;
  return nullptr;
}

std::vector<Chain::Check> Chain::check(const std::vector<PairModel>& models, const std::vector<Poses>& candidates,
                                       const Tick& tick) const {
  std::vector<Check> out(count_);
  parallel_in_order(
      count_,
      [&](std::size_t i) {
        const std::vector<Pair> pairs = pairs_.get_pairs(i);
        for (const Poses& candidate : candidates) {
          double cost = 0;
          int points = 0;
          std::vector<double> offsets;
          for (const Pair& pair : pairs) {
            const PairModel* const model = find_model(pair, models);
            if (model == nullptr) continue;
            const HeldOutCost a =
                evaluate_held_out({pair, get_posed(i, candidate), get_posed(pair.fixed, candidate)}, model->scale);
            cost += a.cost * a.points;
            points += a.points;
            offsets.insert(offsets.end(), a.offsets_px.begin(), a.offsets_px.end());
          }
          out[i].points = points;
          out[i].cost.push_back(points > 0 ? cost / points : 0);
          std::sort(offsets.begin(), offsets.end());
          out[i].offset_px.push_back(offsets.empty() ? 0 : offsets[offsets.size() / 2]);
        }
        tick();
      },
      bytes_per_view());
  return out;
}

/// Returns whether a measure is significantly lower for candidate b than for a, over the views of the drive.
bool is_lower(const std::vector<Chain::Check>& checks, std::size_t a, std::size_t b,
              std::vector<double> Chain::Check::* measure) {
  double n = 0, sum = 0, squares = 0;
  for (const Chain::Check& check : checks) {
    if (check.points == 0) continue;
    const double gain = (check.*measure)[a] - (check.*measure)[b];
    n += 1;
    sum += gain;
    squares += gain * gain;
  }
  if (n < 2) return false;
  const double mean = sum / n, variance = std::max(0.0, squares / n - mean * mean) / (n - 1);
  return mean > kJoint.min_sigmas * std::sqrt(variance);
}

/// Returns whether both cost and offsets are lower: a systematic error can reduce either of them alone.
bool is_better(const std::vector<Chain::Check>& checks, std::size_t a, std::size_t b) {
  return is_lower(checks, a, b, &Chain::Check::cost) && is_lower(checks, a, b, &Chain::Check::offset_px);
}

Expected make_expected(const AlignOptions& options, const View& view, double share, bool common) {
  return {.rotation = share * to_radians(*options.rotation_deg),
          .mounting = share * to_radians(options.mounting_deg),
          .pair = kJoint.pair_error_px / view.camera.fx,
          .common = common,
          .position = share * get_expected_position_m(view.sensor),
          .pair_m = kJoint.pair_error_px / view.camera.fx * kJoint.room_depth_m};
}

/// Returns whether the camera moves far enough for a common rotation to be observable.
bool has_motion(const SequenceViews& sequence) {
  const auto position = [&](std::size_t i) { return sequence.views[i].camera_from_world.inverse().t; };
  double max_distance_m = 0;  // from the first position
  for (std::size_t i = sequence.first; i < sequence.last; ++i)
    max_distance_m = std::max(max_distance_m, (position(i) - position(sequence.first)).norm());
  return max_distance_m >=
         (sequence.views[sequence.first].sensor == Sensor::depth_camera ? kJoint.min_handheld_path_m : kJoint.min_path_m);
}

/// Describes what could not be aligned.
std::vector<std::string> make_warnings(const SequenceViews& aligned, const Cameras& found) {
  const auto& [views, map, first, last] = aligned;
  std::vector<std::string> out;
  std::vector<double> offsets;
  for (std::size_t i = first; i < last; ++i)
    if (found.views[i].points > 0) offsets.push_back(found.views[i].offset_after_px);
  if (offsets.empty()) return {"no two frames show the same map points; all poses stay as given"};
  const std::size_t isolated = last - first - offsets.size();
  if (isolated > 0)
    out.push_back(
        fmt::format("{} of {} frames share too few map points with other frames to be aligned", isolated, last - first));
  std::sort(offsets.begin(), offsets.end());
  const double offset = offsets[offsets.size() / 2];
  if (offset > kJoint.max_offset_px)
    out.push_back(
        fmt::format("the median position error of colors is still {:.1f} px; check camera_from_lidar, the poses, and that "
                    "camera and LiDAR use the same clock",
                    offset));
  if (first == 0 && !views[first].registered_depth && !has_motion(aligned))
    out.emplace_back(
        "the camera hardly moves; a rotation common to all its frames cannot be estimated and is assumed to be zero");
  return out;
}

}  // namespace

void align_jointly(const SequenceViews& sequence, const AlignOptions& options, const Tick& tick, Cameras& out) {
  const Views& views = sequence.views;
  const std::size_t first = sequence.first, last = sequence.last;
  Chain chain(sequence, ChainViews(sequence), out, options);
  const CacheBudget::Loan loan = lend_free_memory(chain.bytes_per_view(), static_cast<std::size_t>(thread_count()));
  const Corrections given(last - first);
  const auto expected = [&, common = chain.is_anchored() || (!views[first].registered_depth && has_motion(sequence))](
                            double share) { return make_expected(options, views[first], share, common); };
  const Corrections coarse = solve_jointly(chain.find_pairs(tick), given, expected(1));
  const std::vector<PairModel> models = chain.fit_models(coarse, std::min<std::size_t>(chain.coarsest(), 1), tick);

  std::vector<Corrections> candidates{given};
  for (const double share : kPriorShares) candidates.push_back(solve_jointly(models, coarse, expected(share)));
  std::vector<Poses> poses;
  for (const Corrections& candidate : candidates) poses.push_back(chain.apply(candidate));
  const std::vector<Chain::Check> checks = chain.check(models, poses, tick);
  std::size_t best = 0;
  for (std::size_t k = 1; k < candidates.size(); ++k)
    if (is_better(checks, best, k)) best = k;
  const Corrections& chosen = candidates[best];
  out.sequences.push_back({best > 0, chosen.mounting, {}});

  for (std::size_t i = 0; i < checks.size(); ++i) {
    out.views[first + i] = {chosen.rotations[i], chosen.positions[i], checks[i].offset_px[0], checks[i].offset_px[best],
                            checks[i].points};
    out.camera_from_world[first + i] = poses[best][i];
  }
  out.sequences.back().warnings = make_warnings(sequence, out);
}

}  // namespace dvi::align
