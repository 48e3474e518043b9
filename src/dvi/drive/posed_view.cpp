#include "dvi/drive/posed_view.h"

#include <cstdint>

namespace dvi {

std::optional<View> posed_view(const Drive& drive, std::size_t frame, const Trajectory& world_from_lidar) {
  const std::int64_t time = drive.frames[frame].time_ns;
  const std::optional<SE3> pose = world_from_lidar.at(time);
  if (!pose) return std::nullopt;
  View view{0, frame, time, drive.camera, drive.camera_from_lidar * pose->inverse()};
  view.sensor = drive.sensor;
  view.registered_depth = drive.registered_depth;
  return view;
}

}  // namespace dvi
