#include "dvi/drive/image_returns.h"

#include <cstdint>
#include <optional>

#include "dvi/drive/deskew.h"
#include "dvi/drive/nearest_in_time.h"

namespace dvi {
std::vector<ImageReturn> project_returns(const Drive& drive, std::size_t frame, const Trajectory& world_from_lidar) {
  std::vector<ImageReturn> out;
  const std::int64_t time_ns = drive.frames[frame].time_ns;
  const ScanHeader* const header = nearest_in_time(drive.scan_headers, time_ns, kMaxFrameToScanNs);
  const std::optional<SE3> pose = world_from_lidar.at(time_ns);
  if (!header || !pose) return out;
  const SE3 camera_from_world = drive.camera_from_lidar * pose->inverse();
  const auto scan = drive.scans[static_cast<std::size_t>(header - drive.scan_headers.data())];
  for (const Eigen::Vector3d& world : to_world(*scan, *header, world_from_lidar)) {
    const Eigen::Vector3d in_camera = camera_from_world * world;
    if (!drive.camera.in_front(in_camera)) continue;
    const Eigen::Vector2d pixel = drive.camera.project(in_camera);
    if (!drive.camera.contains(pixel)) continue;
    out.emplace_back(static_cast<float>(pixel.x()), static_cast<float>(pixel.y()),
                     static_cast<float>(drive.camera.depth(in_camera)));
  }
  return out;
}

}  // namespace dvi
