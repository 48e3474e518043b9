#include "dvi/objects/stationary_objects.h"

#include <numeric>
#include <set>
#include <vector>

#include <nlohmann/json.hpp>
#include <opencv2/core.hpp>

#include "dvi/core/threads.h"
#include "dvi/objects/draw_masks.h"
#include "dvi/objects/motion.h"

namespace dvi::objects {

void to_json(nlohmann::json& json, const StationaryObjects& objects) {
  json = {{"tracks", objects.tracks}, {"stationary", objects.stationary}, {"pixels", objects.pixels}};
}

std::optional<StationaryObjects> count_stationary(const CameraEvidence& evidence, const RemovalOptions& options) {
  if (!evidence.has(MaskSource::labels) || options.remove == Remove::moving) return std::nullopt;
  const Drive& drive = evidence.drive;
  StationaryObjects out{.stationary = find_stationary_tracks(drive, evidence.world_from_lidar).size()};
  if (out.stationary == 0) return std::nullopt;
  std::set<int> tracks;
  for (const Frame& frame : drive.frames)
    for (const Label& label : frame.labels)
      if (label.track >= 0) tracks.insert(label.track);
  out.tracks = tracks.size();
  const Lazy<cv::Mat1b> all = draw_plain_masks(evidence, shared(drive.labels()), options);
  const Lazy<cv::Mat1b> moving =
      draw_plain_masks(evidence, shared(remove_stationary(drive, evidence.world_from_lidar)), options);
  std::vector<std::size_t> pixels(all.size());
  parallel_for(pixels.size(), [&](std::size_t i) {
    pixels[i] = static_cast<std::size_t>(cv::countNonZero(cv::Mat1b(*all[i] & ~*moving[i])));
  });
  out.pixels = std::accumulate(pixels.begin(), pixels.end(), std::size_t{0});
  return out;
}

}  // namespace dvi::objects
