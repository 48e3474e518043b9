#include "dvi/objects/follow.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <utility>
#include <vector>

#include "dvi/core/median.h"
#include "dvi/core/threads.h"
#include "dvi/objects/same_objects.h"
#include "dvi/objects/seconds.h"

namespace dvi::objects {
namespace {

constexpr double kBoxMargin = 0.3;  // meters
constexpr double kUsual = 0.9;      // quantile of the sizes seen: single ones hold returns of others
constexpr std::size_t kFewestInBox = 4;

double quantile(std::vector<double> values) {
  const auto at = values.begin() + static_cast<std::ptrdiff_t>(kUsual * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), at, values.end());
  return *at;
}

// Of the half of its scans that show most of it: from afar, no ray may hit a head.
double usual_height(const Track& track) {
  std::vector<std::pair<std::size_t, double>> heights;  // returns, meters
  for (const Cluster& o : track.observations) {
    double high = 0;
    for (std::size_t i = 0; i < o.points.size(); ++i) high = std::max(high, o.points[i].z() - o.ground[i] + 0.5 * o.rise[i]);
    heights.emplace_back(o.points.size(), high);
  }
  std::sort(heights.rbegin(), heights.rend());
  std::vector<double> best;
  for (std::size_t i = 0; 2 * i < heights.size(); ++i) best.push_back(heights[i].second);
  return median(best);  // leaves above it may move, too
}

// Where an object is at any time, and how large it is: length along its heading, width, height.
class Motion {
 public:
  explicit Motion(const Track& track) : track_(&track), height_(usual_height(track)) {
    for (std::size_t i = 0; i < track.observations.size(); ++i) velocities_.push_back(track.velocity(i));
    const auto moves = [](const Eigen::Vector2d& velocity) { return velocity.norm() > 0.5; };
    const auto first = std::find_if(velocities_.begin(), velocities_.end(), moves);  // before, it waits to go there
    Eigen::Vector2d heading = first == velocities_.end() ? Eigen::Vector2d(1, 0) : first->normalized();
    for (const Eigen::Vector2d& velocity : velocities_) {
      if (moves(velocity)) heading = velocity.normalized();
      headings_.push_back(heading);
    }
    half_ = (0.5 * usual_size(track, headings_).array() + kBoxMargin).matrix();
  }

  double height() const { return height_; }
  /// Along and across its way, of the same object with other returns.
  Eigen::Vector2d size(const Track& same) const {
    std::vector<Eigen::Vector2d> headings;
    for (const Cluster& o : same.observations) headings.push_back(headings_[track_->nearest(o.mean_time_ns)]);
    return usual_size(same, headings);
  }

  /// Whether it is followed at a time, and then the observation nearest to it.
  std::optional<std::size_t> at(std::int64_t time_ns) const {
    const auto& seen = track_->observations;
    if (seconds_from(time_ns, seen.front().mean_time_ns) > kGoesOn) return std::nullopt;
    if (seconds_from(seen.back().mean_time_ns, time_ns) > kGoesOn) return std::nullopt;
    return track_->nearest(time_ns);
  }
  bool holds(std::size_t nearest, const Eigen::Vector3d& x, double ground, std::int64_t time_ns) const {
    if (x.z() - ground > height_ + kBoxMargin) return false;  // trees above the road
    const Cluster& cluster = track_->observations[nearest];
    const Eigen::Vector2d center = cluster.center + velocities_[nearest] * seconds_from(cluster.mean_time_ns, time_ns);
    const Eigen::Vector2d off = x.head<2>() - center, &along = headings_[nearest];
    return std::abs(off.dot(along)) < half_.x() && std::abs(off.x() * along.y() - off.y() * along.x()) < half_.y();
  }

 private:
  static Eigen::Vector2d usual_size(const Track& track, const std::vector<Eigen::Vector2d>& headings) {
    if (track.observations.empty()) return Eigen::Vector2d::Zero();
    std::vector<double> lengths, widths;
    for (std::size_t i = 0; i < headings.size(); ++i) {
      const Eigen::Vector2d size = size_of(track.observations[i], headings[i]);
      lengths.push_back(size.x());
      widths.push_back(size.y());
    }
    return {quantile(lengths), quantile(widths)};
  }
  static Eigen::Vector2d size_of(const Cluster& cluster, const Eigen::Vector2d& heading) {
    Eigen::Array2d low = Eigen::Array2d::Constant(1e9), high = -low;
    for (const Eigen::Vector3d& x : cluster.points) {
      const Eigen::Array2d at(x.head<2>().dot(heading), x.y() * heading.x() - x.x() * heading.y());
      low = low.min(at);
      high = high.max(at);
    }
    return high - low;
  }

  const Track* track_;
  std::vector<Eigen::Vector2d> velocities_, headings_;  // as the observations
  Eigen::Vector2d half_;
  double height_;
};

// What a scan shows of each object that is near, by its number.
std::map<std::size_t, Cluster> look(const std::vector<Motion>& motions, const ObstacleReturns& returns) {
  std::map<std::size_t, Cluster> found;
  if (returns.points.empty()) return found;
  const std::int64_t middle = returns.time_ns[returns.time_ns.size() / 2];
  for (std::size_t k = 0; k < motions.size(); ++k) {
    const auto nearest = motions[k].at(middle);
    if (!nearest) continue;
    Cluster cluster;
    for (std::size_t i = 0; i < returns.points.size(); ++i)
      if (motions[k].holds(*nearest, returns.points[i], returns.ground[i], returns.time_ns[i])) add(cluster, returns, i);
    if (cluster.points.size() < kFewestInBox) continue;
    measure(cluster);
    found.emplace(k, std::move(cluster));
  }
  return found;
}

}  // namespace

std::vector<Track> followed(const std::vector<Track>& tracks, const MovingReturns& returns) {
  const std::vector<Motion> motions(tracks.begin(), tracks.end());
  std::vector<Track> out(tracks.size());
  for_blocks(returns.scans(), [&](std::size_t first, std::size_t last) {
    std::vector<std::map<std::size_t, Cluster>> seen(last - first);
    parallel_for(seen.size(), [&](std::size_t i) { seen[i] = look(motions, *returns.obstacles(first + i)); });
    for (std::size_t i = first; i < last; ++i)
      for (auto& [track, cluster] : seen[i - first]) {
        cluster.scan = i;
        out[track].observations.push_back(std::move(cluster));
      }
  });
  for (std::size_t k = 0; k < out.size(); ++k) {
    out[k].height_m = motions[k].height();
    out[k].size_m = motions[k].size(out[k]);
  }
  return without_duplicates(std::move(out));
}

}  // namespace dvi::objects
