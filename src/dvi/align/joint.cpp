#include "dvi/align/joint.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <numeric>
#include <optional>
#include <set>
#include <utility>

#include <fmt/format.h>

#include "dvi/align/joint_solve.h"
#include "dvi/align/pair_store.h"
#include "dvi/align/sight.h"
#include "dvi/core/threads.h"
#include "dvi/drive/near_views.h"

namespace dvi::align {
namespace {

constexpr double kPairErrorPx = 0.2;  // by which a pair may mislead: surfaces that the map has a little off, light that moves
constexpr double kRoomDepth = 2;      // meters, usual: where so many pixels are so many millimeters
constexpr double kFlat = 0.01;        // of log brightness a pixel: no texture below
constexpr double kLeastCaught = 3;    // expected errors that the coarsest level must be able to catch
constexpr double kNoise = 2;          // standard errors by which held-out points must agree better
// Of the expected rotations: poses that are good already are better not believed to be off by as much as others.
constexpr std::array<double, 3> kParts{0.1, 0.3, 1};
constexpr double kMisplacedPx = 0.6;
// Meters over which a rotation common to all frames shows. An error of a position looks like one, by itself over this motion:
// those of handheld cameras, about a centimeter, like less than the expected 0.2 degrees only over 3 m.
constexpr double kHardlyMoves = 0.5, kHandHardlyMoves = 3;

// Frames from one to the other that are compared. A hand holds a view for seconds, of thirty images each; a vehicle does not.
constexpr std::size_t kFarthest = 8, kHandFarthest = 32;

constexpr double kRadian = 10;  // meters that count as much as a radian between the directions in which views look

double radians(double degrees) { return degrees * std::numbers::pi / 180; }

using Poses = std::vector<SE3>;  // camera_from_world, of a sequence's views

// Of each view of a sequence, the views of earlier sequences that it is held to: those that look from nearest to where it does.
std::vector<std::vector<std::size_t>> anchors_of(const SequenceViews& sequence) {
  std::vector<std::vector<std::size_t>> out;
  for (std::size_t i = sequence.first; sequence.first > 0 && i < sequence.last; ++i)
    out.push_back(find_nearest_views(sequence.views, i, {0, sequence.first}, kAnchors, kRadian));
  return out;
}

// The views of a sequence and then their anchors; who of these is compared with whom.
struct Members {
  std::vector<std::size_t> views;
  Partners partners;

  explicit Members(const SequenceViews& sequence)
      : views(sequence.last - sequence.first),
        partners{views.size(), anchors_of(sequence),
                 sequence.views[sequence.first].sensor == Sensor::depth_camera ? kHandFarthest : kFarthest} {
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

class Chain {
 public:
  // Of the sequences before it, `aligned` has the poses.
  Chain(const SequenceViews& sequence, const Members& members, const Cameras& aligned, const AlignOptions& options)
      : views_(sequence.views),
        map_(sequence.map),
        members_(members.views),
        count_(members.partners.count),
        options_(options),
        pairs_(sequence.map.map, members.partners) {
    for (std::size_t i = count_; i < members_.size(); ++i) anchors_.push_back(aligned.camera_from_world[members_[i]]);
    const Camera& camera = view(0).camera;
    const double caught = kLeastCaught * std::max(radians(*options.rotation_deg), radians(options.mounting_deg)) * camera.fx;
    while (caught > 2 * std::exp2(coarsest_) && std::min(camera.width, camera.height) >> coarsest_ > 64) ++coarsest_;
    images_ = {members_.size(), [this](std::size_t i) {
                 return band_pass(*views_.images[members_[i]], *views_.masks[members_[i]], static_cast<int>(coarsest_) + 1);
               }};
  }

  /// Returns their models where the views are as given.
  std::vector<PairModel> find_pairs(const Tick& tick);
  std::vector<PairModel> models(const Corrections& now, std::size_t coarsest, const Tick& tick) const;
  struct Check {
    std::vector<double> cost;       // a candidate
    std::vector<double> offset_px;  // median, a candidate
    int points = 0;
  };
  std::vector<Check> check(const std::vector<PairModel>& models, const std::vector<Poses>& candidates, const Tick& tick) const;

  std::size_t coarsest() const { return coarsest_; }
  bool anchored() const { return members_.size() > count_; }
  Poses turned(const Corrections& c) const;

 private:
  std::vector<SharedPoint> shared_points(std::size_t i, const Lazy<UnmaskedPoints>& sights) const;
  std::vector<PairModel> models_of(std::size_t i, const Poses& poses, std::size_t coarsest) const;
  void add_models(std::size_t first, std::size_t last, const Poses& poses, std::size_t coarsest, std::vector<PairModel>& all,
                  const Tick& tick) const;
  std::vector<map::VisiblePoint> textured(const UnmaskedPoints& sight, const View& view, const cv::Mat1f& texture) const;
  const View& view(std::size_t i) const { return views_[members_[i]]; }
  PosedImage posed(std::size_t i, const Poses& poses) const { return {view(i).camera, poses[i], images_[i]}; }

  const Views& views_;
  const map::VisibleMap& map_;
  std::vector<std::size_t> members_;  // of `views`: the sequence's, then its anchors
  std::size_t count_, coarsest_ = 0;  // of the sequence
  Poses anchors_;
  const AlignOptions& options_;
  Lazy<BandPass> images_;
  PairStore pairs_;  // by moving view
};

Poses Chain::turned(const Corrections& c) const {
  Poses out;
  for (std::size_t i = 0; i < count_; ++i)
    out.push_back(SE3{so3_exp(c.rotations[i]), c.positions[i]} * view(i).camera_from_world);
  out.insert(out.end(), anchors_.begin(), anchors_.end());
  return out;
}

// The most textured point of each cell of a grid over the image.
std::vector<map::VisiblePoint> Chain::textured(const UnmaskedPoints& sight, const View& view, const cv::Mat1f& texture) const {
  const cv::Size size(view.camera.width, view.camera.height);
  const double cell = std::max(1.0, std::sqrt(static_cast<double>(size.area()) / options_.points));
  const int columns = static_cast<int>(size.width / cell) + 1, rows = static_cast<int>(size.height / cell) + 1;
  std::vector<map::VisiblePoint> best(static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows));
  std::vector<double> slope(best.size(), kFlat);
  for (const map::VisiblePoint& p : sight.points()) {
    const int column = static_cast<int>((p.u + 0.5) / cell), row = static_cast<int>((p.v + 0.5) / cell);
    const std::size_t at = static_cast<std::size_t>(row) * static_cast<std::size_t>(columns) + static_cast<std::size_t>(column);
    const double here = spot_at(texture, size, {p.u, p.v}).slope.norm();
    if (here <= slope[at] || sight.beside_nearer(p)) continue;
    slope[at] = here;
    best[at] = p;
  }
  std::erase_if(best, [](const map::VisiblePoint& p) { return p.z == 0; });
  return best;
}

std::vector<SharedPoint> Chain::shared_points(std::size_t i, const Lazy<UnmaskedPoints>& sights) const {
  std::vector<SharedPoint> out;
  for (const map::VisiblePoint& point : textured(*sights[i], view(i), images_[i]->front()))
    out.push_back({.index = point.index, .seen_by = 0});
  for (std::size_t k = 0; k < kPartners + kAnchors; ++k) {
    const std::optional<std::size_t> partner = pairs_.partners().of(i, k);
    if (!partner) continue;
    const View& other = view(*partner);
    const auto sight = sights[*partner];
    for (SharedPoint& point : out) {
      const Eigen::Vector3d p = other.camera_from_world * map_.map.points[point.index].position.cast<double>();
      if (!other.camera.in_front(p)) continue;
      const Eigen::Vector2d pixel = other.camera.project(p);
      if (other.camera.contains(pixel) && sight->shows(pixel, p.z()))
        point.seen_by = static_cast<std::uint16_t>(point.seen_by | 1U << k);
    }
  }
  return out;
}

std::vector<PairModel> Chain::models_of(std::size_t i, const Poses& poses, std::size_t coarsest) const {
  const double expected = 2 * std::hypot(radians(*options_.rotation_deg), radians(options_.mounting_deg));
  const Freedom freedom = expected_position_m(view(0).sensor) > 0 ? Freedom::pose : Freedom::rotation;
  const PosedImage moving = posed(i, poses);
  std::vector<PairModel> out;
  for (const Pair& pair : pairs_.of(i))
    if (auto model = fit_pair(pair, moving, posed(pair.fixed, poses), coarsest, expected, freedom)) out.push_back(*model);
  return out;
}

// Appends the models of the views [first, last).
void Chain::add_models(std::size_t first, std::size_t last, const Poses& poses, std::size_t coarsest,
                       std::vector<PairModel>& all, const Tick& tick) const {
  std::vector<std::vector<PairModel>> by_view(last - first);
  parallel_for(by_view.size(), [&](std::size_t i) {
    by_view[i] = models_of(first + i, poses, coarsest);
    tick();
  });
  for (const auto& some : by_view) all.insert(all.end(), some.begin(), some.end());
}

// In one pass, while the images are at hand.
std::vector<PairModel> Chain::find_pairs(const Tick& tick) {
  const Lazy<UnmaskedPoints> sights(
      members_.size(), [this](std::size_t i) { return UnmaskedPoints(*map_.points[members_[i]], *views_.masks[members_[i]]); });
  const Poses given = turned(Corrections(count_));
  std::vector<PairModel> all;
  for_blocks(count_, [&](std::size_t first, std::size_t last) {
    std::vector<std::vector<SharedPoint>> points(last - first);
    parallel_for(points.size(), [&](std::size_t i) { points[i] = shared_points(first + i, sights); });
    for (const std::vector<SharedPoint>& of_view : points) pairs_.add(of_view);
    add_models(first, last, given, coarsest_, all, tick);
  });
  return all;
}

std::vector<PairModel> Chain::models(const Corrections& now, std::size_t coarsest, const Tick& tick) const {
  const Poses poses = turned(now);
  std::vector<PairModel> all;
  for_blocks(count_, [&](std::size_t first, std::size_t last) { add_models(first, last, poses, coarsest, all, tick); });
  return all;
}

// The model of a pair; they lie in the order of the moving views. None where there was too little to fit.
const PairModel* model_of(const Pair& pair, const std::vector<PairModel>& models) {
  auto model = std::lower_bound(models.begin(), models.end(), pair.moving,
                                [](const PairModel& m, std::size_t moving) { return m.moving < moving; });
  for (; model != models.end() && model->moving == pair.moving; ++model)
    if (model->fixed == pair.fixed) return &*model;
  return nullptr;
}

std::vector<Chain::Check> Chain::check(const std::vector<PairModel>& models, const std::vector<Poses>& candidates,
                                       const Tick& tick) const {
  std::vector<Check> out(count_);
  parallel_in_order(count_, [&](std::size_t i) {
    const std::vector<Pair> pairs = pairs_.of(i);
    for (const Poses& candidate : candidates) {
      double cost = 0;
      int points = 0;
      std::vector<double> offsets;
      for (const Pair& pair : pairs) {
        const PairModel* const model = model_of(pair, models);
        if (model == nullptr) continue;
        const HeldOutCost a = held_out(pair, posed(i, candidate), posed(pair.fixed, candidate), model->scale);
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
  });
  return out;
}

// Whether a measure is lower for candidate b than for a by more than noise, over the views of the drive.
bool lower(const std::vector<Chain::Check>& checks, std::size_t a, std::size_t b, std::vector<double> Chain::Check::* measure) {
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
  return mean > kNoise * std::sqrt(variance);
}

// Both the cost and the offsets: each alone can be bought with a systematic error.
bool better(const std::vector<Chain::Check>& checks, std::size_t a, std::size_t b) {
  return lower(checks, a, b, &Chain::Check::cost) && lower(checks, a, b, &Chain::Check::offset_px);
}

Expected expected_errors(const AlignOptions& options, const View& view, double part, bool common) {
  return {.rotation = part * radians(*options.rotation_deg),
          .mounting = part * radians(options.mounting_deg),
          .pair = kPairErrorPx / view.camera.fx,
          .common = common,
          .position = part * expected_position_m(view.sensor),
          .pair_m = kPairErrorPx / view.camera.fx * kRoomDepth};
}

// Whether surfaces come nearer, or pass by, so that a rotation common to all frames shows.
bool moves(const SequenceViews& sequence) {
  const auto place = [&](std::size_t i) { return sequence.views[i].camera_from_world.inverse().t; };
  double most = 0;  // meters from the first place to the farthest
  for (std::size_t i = sequence.first; i < sequence.last; ++i) most = std::max(most, (place(i) - place(sequence.first)).norm());
  return most >= (sequence.views[sequence.first].sensor == Sensor::depth_camera ? kHandHardlyMoves : kHardlyMoves);
}

// What could not be aligned, in words.
std::vector<std::string> warnings(const SequenceViews& aligned, const Cameras& found) {
  const auto& [views, map, first, last] = aligned;
  std::vector<std::string> out;
  std::vector<double> offsets;
  for (std::size_t i = first; i < last; ++i)
    if (found.views[i].points > 0) offsets.push_back(found.views[i].offset_after_px);
  if (offsets.empty()) return {"no two frames show the same map points; all poses stay as given"};
  const std::size_t alone = last - first - offsets.size();
  if (alone > 0)
    out.push_back(fmt::format("{} of {} frames share too few map points with others to be aligned", alone, last - first));
  std::sort(offsets.begin(), offsets.end());
  const double offset = offsets[offsets.size() / 2];
  if (offset > kMisplacedPx)
    out.push_back(
        fmt::format("colors stay misplaced by {:.1f} px in the median; check camera_from_lidar, the poses, and that camera "
                    "and LiDAR share one clock",
                    offset));
  if (first == 0 && !views[first].registered_depth && !moves(aligned))
    out.emplace_back(
        "the camera hardly moves; a rotation common to all its frames cannot be estimated and is assumed to be none");
  return out;
}

}  // namespace

void align_jointly(const SequenceViews& sequence, const AlignOptions& options, const Tick& tick, Cameras& out) {
  const Views& views = sequence.views;
  const std::size_t first = sequence.first, last = sequence.last;
  Chain chain(sequence, Members(sequence), out, options);
  const Corrections given(last - first);
  const auto expected = [&, common = chain.anchored() || (!views[first].registered_depth && moves(sequence))](double part) {
    return expected_errors(options, views[first], part, common);
  };
  const Corrections coarse = solve(chain.find_pairs(tick), given, expected(1));
  const std::vector<PairModel> models = chain.models(coarse, std::min<std::size_t>(chain.coarsest(), 1), tick);

  std::vector<Corrections> candidates{given};
  for (const double part : kParts) candidates.push_back(solve(models, coarse, expected(part)));
  std::vector<Poses> poses;
  for (const Corrections& candidate : candidates) poses.push_back(chain.turned(candidate));
  const std::vector<Chain::Check> checks = chain.check(models, poses, tick);
  std::size_t best = 0;
  for (std::size_t k = 1; k < candidates.size(); ++k)
    if (better(checks, best, k)) best = k;
  const Corrections& chosen = candidates[best];
  out.sequences.push_back({best > 0, chosen.mounting, {}});

  for (std::size_t i = 0; i < checks.size(); ++i) {
    out.views[first + i] = {chosen.rotations[i], chosen.positions[i], checks[i].offset_px[0], checks[i].offset_px[best],
                            checks[i].points};
    out.camera_from_world[first + i] = poses[best][i];
  }
  out.sequences.back().warnings = warnings(sequence, out);
}

}  // namespace dvi::align
