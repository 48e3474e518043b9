#include "dvi/registration/ray_votes.h"

#include <cmath>

#include "dvi/drive/free_space.h"

namespace dvi::registration {

RayVotes count_ray_votes(const KeyScans& keys, std::size_t key, const std::vector<Eigen::Vector3d>& points_in_world) {
  std::vector<int> votes((points_in_world.size() + kRayVotes.point_step - 1) / kRayVotes.point_step, 0);
  double next = keys[key].path_length_m - kRayVotes.max_path_m;
  for (std::size_t k = 0; k < keys.size() && keys[k].path_length_m <= keys[key].path_length_m + kRayVotes.max_path_m; ++k) {
    if (keys[k].path_length_m < next) continue;
    next = keys[k].path_length_m + kRayVotes.scan_spacing_m;
    const std::size_t scan = keys[k].scan;
    const FreeSpace free(*keys.drive().scans[scan], keys.drive().scan_headers[scan], keys.world_from_lidar(),
                         kRayVotes.position_error_m);
    if (!free.valid()) continue;
    for (std::size_t i = 0; i < votes.size(); ++i) {
      const FreeSpace::Seen seen = free.judge(points_in_world[kRayVotes.point_step * i], kRayVotes.point_radius_m);
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
