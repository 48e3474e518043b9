#pragma once

#include <cstddef>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "dvi/commands/estimate_coverage.h"
#include "dvi/core/progress.h"
#include "dvi/drive/drive.h"

namespace dvi::commands {

/// The results of `dvi check`.
struct CheckReport {
  std::string path, format, camera_name;
  std::vector<std::string> camera_names;  ///< all cameras of the drive
  std::vector<RecordedTopic> topics;      ///< topics of a bag
  Camera camera;
  std::size_t frames = 0, frames_with_pose = 0;
  int first_frame = 0, last_frame = 0;
  double frame_rate_hz = 0;
  std::size_t scans = 0;
  double scan_rate_hz = 0, mean_points = 0;  ///< points per scan
  std::size_t map_points = 0;                ///< points of the drive's own map, if it has one instead of scans
  double path_m = 0;
  std::optional<FoundPlace> place = {};         ///< place on Earth of the first LiDAR pose, by GPS
  std::string poses_from;                       ///< given or loam
  std::shared_ptr<const nlohmann::json> poses;  ///< as in report.json
  std::string mask_source;                      ///< the names of its mask sources, or "none"
  std::map<std::string, std::size_t> objects;   ///< number of labeled tracks by class
  double mean_masked = 0, largest_masked = 0;   ///< shares of an image
  bool finds_moving = false;                    ///< whether a run also removes moving objects, which a check does not find
  bool ready = false;                           ///< whether a run is possible
  std::vector<std::string> warnings;
  std::vector<std::string> pictures;       ///< files, if requested
  std::optional<CoverageReport> coverage;  ///< if requested and ready

  std::string brief() const;  ///< as text
};
std::string to_json(const CheckReport& report);

/// Reads all of job.target once, and reports its format, camera, frames, scans, points, poses, and masks, with warnings about
/// missing or contradictory data. If `with_coverage` is set, and a run is possible, also estimates the coverage of its holes,
/// which takes much longer. Throws InputError if the drive cannot be read.
CheckReport check(const job::Job& job, bool with_coverage, Progress& progress);

}  // namespace dvi::commands
