#pragma once

#include <cstddef>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "dvi/commands/forecast_holes.h"
#include "dvi/core/progress.h"
#include "dvi/drive/drive.h"

namespace dvi::commands {

/// What `dvi check` found.
struct CheckReport {
  std::string path, format, camera_name;
  std::vector<std::string> camera_names;  ///< all that the drive has
  std::vector<RecordedTopic> topics;      ///< of a bag
  Camera camera;
  std::size_t frames = 0, frames_with_pose = 0;
  int first_frame = 0, last_frame = 0;
  double frame_rate_hz = 0;
  std::size_t scans = 0;
  double scan_rate_hz = 0, mean_points = 0;  ///< points of a scan
  std::size_t map_points = 0;                ///< of the map that it brings instead of scans
  double path_m = 0;
  std::optional<FoundPlace> place = {};         ///< of the world of the first LiDAR pose, by GPS
  std::string poses_from;                       ///< given, loam
  std::shared_ptr<const nlohmann::json> poses;  ///< as report.json has them
  std::string mask_source;                      ///< files, labels, detector, none
  std::map<std::string, std::size_t> objects;   ///< what labels say is removed: tracks by class
  double mean_masked = 0, largest_masked = 0;   ///< parts of an image
  bool ready = false;                           ///< for a run
  std::vector<std::string> warnings;
  std::vector<std::string> pictures;       ///< files, if asked for
  std::optional<ForecastReport> forecast;  ///< if asked for and ready

  std::string brief() const;  ///< some lines for a person
};
std::string to_json(const CheckReport& report);

/// Reads all of job.target once and says what it is: format, camera, frames, scans, points, poses, masks, what of it is missing
/// or odd, and, if `with_forecast` and it is ready for a run, how much of its holes other frames will have seen, which takes
/// much longer. InputError where something is too bad to go on with.
CheckReport check(const job::Job& job, bool with_forecast, Progress& progress);

}  // namespace dvi::commands
