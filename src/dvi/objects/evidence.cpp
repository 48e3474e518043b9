#include "dvi/objects/evidence.h"

namespace dvi::objects {

std::shared_ptr<const ground::ScanGround> Evidence::ground(std::size_t camera) const {
  const std::size_t own = own_camera(camera);
  const CameraEvidence& evidence = cameras_[own];
  if (evidence.world_from_lidar.empty() || evidence.drive.scan_headers.empty()) return nullptr;
  auto& ground = grounds_[own];
  if (!ground) ground = std::make_shared<const ground::ScanGround>(evidence.drive, evidence.world_from_lidar);
  return ground;
}

Grounds Evidence::grounds() const {
  Grounds grounds(cameras_.size());
  for (std::size_t i = 0; i < cameras_.size(); ++i)
    if (own_camera(i) == i) grounds[i] = ground(i);
  return grounds;
}

void Evidence::set_grounds(const Grounds& grounds) { grounds_ = grounds; }

}  // namespace dvi::objects
