#include "dvi/registration/seen_through.h"

#include <cmath>

#include "dvi/drive/free_space.h"

namespace dvi::registration {
namespace {

constexpr double kAround = 12, kBetween = 4;  // meters of way: scans that look, and from one to the next
constexpr double kPointRadius = 0.1;          // meters: radius of a point
constexpr double kPlacedTo = 0.1;             // meters: the drives may be off each other by so much
constexpr std::size_t kEvery = 3;             // of the points

}  // namespace

RayVotes sight(const KeyScans& keys, std::size_t key, const std::vector<Eigen::Vector3d>& world) {
  std::vector<int> votes((world.size() + kEvery - 1) / kEvery, 0);
  double next = keys[key].way_m - kAround;
  for (std::size_t k = 0; k < keys.size() && keys[k].way_m <= keys[key].way_m + kAround; ++k) {
    if (keys[k].way_m < next) continue;
    next = keys[k].way_m + kBetween;
    const std::size_t scan = keys[k].scan;
    const FreeSpace free(*keys.drive().scans[scan], keys.drive().scan_headers[scan], keys.world_from_lidar(), kPlacedTo);
    if (!free.valid()) continue;
    for (std::size_t i = 0; i < votes.size(); ++i) {
      const FreeSpace::Seen seen = free.judge(world[kEvery * i], kPointRadius);
      votes[i] += seen == FreeSpace::Seen::hit ? 1 : seen == FreeSpace::Seen::passed ? -1 : 0;
    }
  }
  RayVotes out;
  for (const int vote : votes) {
    out.hit += vote > 0 ? 1 : 0;
    out.passed += vote < 0 ? 1 : 0;
  }
  return out;
}

}  // namespace dvi::registration
