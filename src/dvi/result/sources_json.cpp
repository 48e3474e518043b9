#include "dvi/result/sources_json.h"

#include <array>

#include <nlohmann/json.hpp>

#include "dvi/core/files.h"
#include "dvi/geometry/camera_json.h"

namespace dvi::result {
namespace {

/// Returns the calibration of a camera in the form of dvi.toml of the plain layout.
nlohmann::json camera_json(const Drive& drive) {
  nlohmann::json out = to_json(drive.camera);
  out["drive"] = fs::absolute(drive.path).lexically_normal().string();
  out["camera"] = drive.camera_name;
  return out;
}

}  // namespace

nlohmann::json sources_json(const Views& views, const inputs::Recordings& drives) {
  nlohmann::json sources = nlohmann::json::array();
  for (std::size_t i = 0; i < views.size(); ++i) {
    const Drive& drive = drives[static_cast<std::size_t>(views[i].sequence)].drive;
    const Frame& frame = drive.frames[views[i].frame];
    const cv::Vec3f& gain = views[i].gain;
    sources.push_back({{"number", i},
                       {"drive", fs::absolute(drive.path).lexically_normal().string()},
                       {"camera", drive.camera_name},
                       {"frame", frame.name},
                       {"file", fs::absolute(frame.file).lexically_normal().string()},
                       {"exposure_gain", std::array<float, 3>{gain[2], gain[1], gain[0]}},
                       {"vignetting", views[i].vignetting}});
  }
  nlohmann::json cameras = nlohmann::json::array();
  for (const inputs::Recording& open : drives) cameras.push_back(camera_json(open.drive));
  return {{"schema", "dvi-sources/1"}, {"cameras", cameras}, {"sources", sources}};
}

}  // namespace dvi::result
