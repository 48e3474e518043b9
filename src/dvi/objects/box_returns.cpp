#include "dvi/objects/box_returns.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <utility>
#include <vector>

#include "dvi/core/median.h"
#include "dvi/core/threads.h"
#include "dvi/objects/merge_tracks.h"
#include "dvi/objects/seconds.h"

namespace dvi::objects {
namespace {

struct BoxReturnParams {
  double box_margin_m = 0.3;           ///< margin on all sides of the box of an object
  double size_quantile = 0.9;          ///< of the sizes over time: the largest may include returns of other objects
  std::size_t min_returns = 4;         ///< fewer returns in the box do not count as an observation
  double min_heading_speed_mps = 0.5;  ///< below, the heading is that of the nearest faster observation
};
constexpr BoxReturnParams kBoxReturns{};

double compute_quantile(std::vector<double> values) {
  const auto at =
      values.begin() + static_cast<std::ptrdiff_t>(kBoxReturns.size_quantile * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), at, values.end());
  return *at;
}

// Estimates the height of an object from the half of its observations that have most returns: from a large distance, no ray may
// hit a head. The median excludes leaves above it, which may move, too.
double estimate_height(const Track& track) {
  std::vector<std::pair<std::size_t, double>> heights;  // number of returns, meters
  for (const Cluster& o : track.observations) {
    double high = 0;
    for (const ClusterReturn& r : o.returns) high = std::max(high, r.point.z() - r.ground + 0.5 * r.ray_spacing_m);
    heights.emplace_back(o.returns.size(), high);
  }
  std::sort(heights.rbegin(), heights.rend());
  std::vector<double> best;
  for (std::size_t i = 0; 2 * i < heights.size(); ++i) best.push_back(heights[i].second);
  return median(best);
}

// The box of an object at any time: position, heading, and size.
class MovingBox {
 public:
  explicit MovingBox(const Track& track) : track_(&track), height_(estimate_height(track)) {
    for (std::size_t i = 0; i < track.observations.size(); ++i) velocities_.push_back(track.velocity(i));
    const auto moves = [](const Eigen::Vector2d& velocity) { return velocity.norm() > kBoxReturns.min_heading_speed_mps; };
    const auto first = std::find_if(velocities_.begin(), velocities_.end(), moves);
    Eigen::Vector2d heading = first == velocities_.end() ? Eigen::Vector2d(1, 0) : first->normalized();
    for (const Eigen::Vector2d& velocity : velocities_) {
      if (moves(velocity)) heading = velocity.normalized();
      headings_.push_back(heading);
    }
    half_size_ = (0.5 * estimate_size(track, headings_).array() + kBoxReturns.box_margin_m).matrix();
  }

  double height() const { return height_; }

  // Returns the size of the same object, along and across its heading, from another track with more of its returns.
  Eigen::Vector2d size(const Track& same) const {
    std::vector<Eigen::Vector2d> headings;
    for (const Cluster& o : same.observations) headings.push_back(headings_[track_->nearest(o.mean_time_ns)]);
    return estimate_size(same, headings);
  }

  // Returns the observation nearest to a time, or nothing outside of the time range of the track.
  std::optional<std::size_t> nearest(std::int64_t time_ns) const {
    const auto& observations = track_->observations;
    if (seconds_between(time_ns, observations.front().mean_time_ns) > kMaxExtrapolationS) return std::nullopt;
    if (seconds_between(observations.back().mean_time_ns, time_ns) > kMaxExtrapolationS) return std::nullopt;
    return track_->nearest(time_ns);
  }

  // Returns whether the box contains return `i`.
  bool contains(std::size_t nearest, const ObstacleReturns& returns, std::size_t i) const {
    const Eigen::Vector3d& x = returns.points[i];
    if (x.z() - returns.ground[i] > height_ + kBoxReturns.box_margin_m) return false;  // trees above the road
    const Cluster& cluster = track_->observations[nearest];
    const Eigen::Vector2d center =
        cluster.center + velocities_[nearest] * seconds_between(cluster.mean_time_ns, returns.time_ns[i]);
    const Eigen::Vector2d offset = x.head<2>() - center, &along = headings_[nearest];
    return std::abs(offset.dot(along)) < half_size_.x() &&
           std::abs(offset.x() * along.y() - offset.y() * along.x()) < half_size_.y();
  }

 private:
  static Eigen::Vector2d estimate_size(const Track& track, const std::vector<Eigen::Vector2d>& headings) {
    if (track.observations.empty()) return Eigen::Vector2d::Zero();
    std::vector<double> lengths, widths;
    for (std::size_t i = 0; i < headings.size(); ++i) {
      const Eigen::Vector2d size = measure_size(track.observations[i], headings[i]);
      lengths.push_back(size.x());
      widths.push_back(size.y());
    }
    return {compute_quantile(lengths), compute_quantile(widths)};
  }

  static Eigen::Vector2d measure_size(const Cluster& cluster, const Eigen::Vector2d& heading) {
    Eigen::Array2d low = Eigen::Array2d::Constant(1e9), high = -low;
    for (const ClusterReturn& r : cluster.returns) {
      const Eigen::Vector2d x = r.point.head<2>();
      const Eigen::Array2d at(x.dot(heading), x.y() * heading.x() - x.x() * heading.y());
      low = low.min(at);
      high = high.max(at);
    }
    return high - low;
  }

  const Track* track_;
  std::vector<Eigen::Vector2d> velocities_, headings_;  // per observation
  Eigen::Vector2d half_size_;
  double height_;
};

// Returns the returns of a scan within each box, by the index of the box.
std::map<std::size_t, Cluster> find_in_boxes(const std::vector<MovingBox>& boxes, const ObstacleReturns& returns) {
  std::map<std::size_t, Cluster> found;
  if (returns.points.empty()) return found;
  const std::int64_t middle = returns.time_ns[returns.time_ns.size() / 2];
  for (std::size_t k = 0; k < boxes.size(); ++k) {
    const auto nearest = boxes[k].nearest(middle);
    if (!nearest) continue;
    Cluster cluster;
    for (std::size_t i = 0; i < returns.points.size(); ++i)
      if (boxes[k].contains(*nearest, returns, i)) add(cluster, returns, i);
    if (cluster.returns.size() < kBoxReturns.min_returns) continue;
    cluster.returns.shrink_to_fit();  // all scans of the drive are kept
    measure(cluster);
    found.emplace(k, std::move(cluster));
  }
  return found;
}

}  // namespace

void estimate_extent(Track& track) {
  const MovingBox box(track);
  track.height_m = box.height();
  track.size_m = box.size(track);
}

std::vector<Track> collect_box_returns(std::vector<Track> tracks, const MovingReturns& returns) {
  const std::vector<MovingBox> boxes(tracks.begin(), tracks.end());
  for (Track& track : tracks)  // the boxes need the motion only
    for (Cluster& observation : track.observations) observation.returns = {};
  std::vector<Track> out(tracks.size());
  make_and_use(
      returns.scans(), [&](std::size_t i) { return find_in_boxes(boxes, *returns.obstacles(i)); },
      [&](std::size_t i, std::map<std::size_t, Cluster> found) {
        for (auto& [track, cluster] : found) {
          cluster.scan = i;
          out[track].observations.push_back(std::move(cluster));
        }
      });
  for (std::size_t k = 0; k < out.size(); ++k) {
    out[k].height_m = boxes[k].height();
    out[k].size_m = boxes[k].size(out[k]);
  }
  return merge_duplicates(std::move(out));
}

}  // namespace dvi::objects
