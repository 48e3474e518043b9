#pragma once

#include <array>
#include <cstddef>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "dvi/align/align.h"
#include "dvi/core/files.h"
#include "dvi/core/progress.h"
#include "dvi/inputs/poses.h"
#include "dvi/inputs/poses_report.h"
#include "dvi/inputs/recordings.h"
#include "dvi/map/static_map.h"
#include "dvi/metrics/artifacts.h"
#include "dvi/objects/stationary_objects.h"
#include "dvi/result/cpu_clock.h"
#include "dvi/result/filled_view.h"

namespace dvi::result {

/// Shares of a hole by the origin of its pixels, 0..1. unobserved: seen by no other frame, however it was filled.
struct HoleParts {
  double copied = 0, copied_elsewhere = 0, interpolated = 0, synthesized = 0, empty = 0, unobserved = 0;
};

/// Pixels of a hole by where they come from.
struct HoleReport {
  std::size_t pixels = 0, copied = 0, copied_elsewhere = 0, interpolated = 0, synthesized = 0, empty = 0;

  HoleParts share() const;
  HoleReport& operator+=(const HoleReport& other);
};

struct FrameAlignmentReport {
  std::array<double, 3> rotation_deg{};  ///< pitch, yaw, roll
  std::array<double, 3> position_m{};    ///< along the camera's axes; depth cameras only
  double offset_before_px = 0, offset_after_px = 0;
  int points = 0;
};

struct FrameReport {
  int number = 0;
  std::string name;
  HoleReport hole;
  std::optional<regularize::Energies> energy;  ///< where they were minimized
  FrameAlignmentReport alignment;
  std::array<float, 3> exposure_gain{};  ///< RGB
};

struct DriveAlignmentReport {
  bool kept = false;  ///< whether held-out points agree better with the refined poses; else they stay as given
  std::array<double, 3> mounting_deg{};
};

/// Another camera of a drive, which lends: pixels, or where it has no colors for them, structure to find depth by.
struct CameraReport {
  std::string camera, masks;  ///< its name; what tells its traffic
  bool gray = false;
  std::size_t frames = 0;
  std::optional<DriveAlignmentReport> alignment;
  std::vector<std::string> warnings;
};

/// Where a source drive lies in the target's world, as its scans say (registration/registration.h).
struct RegistrationReport {
  std::array<std::array<double, 4>, 3> target_from_source{};  ///< from its own first LiDAR pose, [R | t]
  double overlap = 0;                                         ///< share of its scans that lie on what earlier drives saw
  double residual_m = 0;
  double bound_m = 0, bound_deg = 0;  ///< 95 % of errors are smaller
  std::size_t things = 0, things_agree = 0;
  double passed_share = 0, rival = 0;
};

struct DriveReport {
  std::string path, format, camera;
  std::size_t frames = 0, scans = 0;
  inputs::PosesReport poses;
  std::optional<FoundPlace> place;                 ///< where the world of the target's first LiDAR pose lies, by its GPS
  std::optional<RegistrationReport> registration;  ///< none: of the target, and where given poses are kept
  std::optional<DriveAlignmentReport> alignment;
  std::vector<std::string> warnings;
  std::vector<CameraReport> other_cameras;
};

struct MapReport {
  std::size_t points = 0;
  map::MapCounts counts;
};

struct CostReport {
  std::vector<StageTime> stages;
  std::map<std::string, double> fill_cpu_seconds;  ///< what the stage "fill" is made of
  std::size_t frames_made = 0;
  std::size_t peak_memory_bytes = 0;

  /// Adds what another process spent on the same result.
  CostReport& operator+=(const CostReport& other);
};

/// What report.json holds.
struct RunReport {
  std::string version, method;
  bool baseline = false;
  std::vector<DriveReport> drives;
  HoleReport hole;                                       ///< of all frames
  metrics::Artifacts artifacts;                          ///< what draws the eye in them
  std::optional<objects::StationaryObjects> stationary;  ///< removed from the target
  std::optional<MapReport> map;                          ///< a baseline has none
  CostReport cost;
  std::vector<std::string> warnings;
  std::vector<FrameReport> frames;

  /// A few lines for a person: what was filled, from where, what was unobserved, where to look in `out`.
  std::string brief(const std::string& out) const;
};

FrameReport frame_report(const Frame& frame, const FilledView& view, const align::ViewAlignment& alignment);
MapReport map_report(const map::StaticMap& map);
/// One entry a drive, with its other cameras.
std::vector<DriveReport> drive_reports(const inputs::Recordings& drives, const inputs::Poses& poses,
                                       const align::Cameras& cameras);

/// What a run cost so far.
CostReport cost_report(const Progress& progress, const CpuClock& clock, std::size_t frames_made);

/// As written to disk and read back; nothing where the file is missing or damaged.
std::string to_json(const RunReport& report);
std::optional<RunReport> read_run_report(const fs::path& file);

}  // namespace dvi::result
