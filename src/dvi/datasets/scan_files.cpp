#include "dvi/datasets/scan_files.h"

#include <algorithm>
#include <map>
#include <memory>
#include <mutex>
#include <set>

#include <fmt/format.h>

#include "dvi/core/error.h"
#include "dvi/core/median.h"
#include "dvi/core/text.h"
#include "dvi/datasets/map_file.h"

namespace dvi::datasets {
namespace {

// The period of scans is the shorter one of that of their headers and that of their times: a rate that is not stated is 10 Hz
// by default, and scans may be missing.
media::TimedScan make_timed_scan(const Drive& drive, std::size_t number, std::int64_t clock_offset_ns) {
  std::vector<double> steps;
  for (std::size_t i = 1; i < drive.scan_headers.size(); ++i)
    steps.push_back(1e-9 * static_cast<double>(drive.scan_headers[i].time_ns - drive.scan_headers[i - 1].time_ns));
  const ScanHeader& header = drive.scan_headers[number];
  const double length = 1e-9 * static_cast<double>(header.end_ns - header.start_ns);
  media::TimedScan scan;
  scan.start_s = 1e-9 * static_cast<double>(header.start_ns - clock_offset_ns);
  if (length > 0) scan.period_s = length;
  if (const double step = steps.empty() ? 0 : median(std::move(steps)); step > 0)
    scan.period_s = length > 0 ? std::min(length, step) : step;
  return scan;
}

media::BinLayout find_layout(Drive& drive, const LidarConfig& config, const media::TimedScan& last) {
  std::vector<fs::path> files;
  for (const ScanHeader& header : drive.scan_headers)
    if (media::is_bin(header.file)) files.push_back(header.file);
  if (!config.columns.empty()) return media::use_stated_layout(files, config.columns);
  const media::BinLayout layout = media::infer_bin_layout(files, last);
  if (layout.shape() != media::BinShape())
    drive.warnings.push_back(fmt::format(
        "scans are read as {}, inferred from their values; [lidar] columns in dvi.toml overrides this ('_' means not used)",
        layout.text()));
  return layout;
}

// Throws InputError if coordinates seem to be in other units or in world axes.
void require_meters(const media::PointCloud& cloud, const fs::path& file, double units_per_meter) {
  constexpr double kMaxMedianRangeM = 500, kMaxMedianRangeMm = 100'000;
  std::vector<double> ranges;
  for (const Eigen::Vector3f& point : cloud.points) ranges.push_back(point.cast<double>().norm() / units_per_meter);
  const double range = median(std::move(ranges));
  if (range <= kMaxMedianRangeM) return;
  const std::string problem = fmt::format("half of its points are {:.0f} m away or more: ", range);
  if (range <= kMaxMedianRangeMm)
    throw InputError(file, problem + "its coordinates look like millimeters",
                     "set [lidar] units_per_meter = 1000 in dvi.toml, or convert the scans to meters");
  throw InputError(file, problem + "its coordinates are not meters in the axes of the sensor",
                   "transform the scans to the axes of the sensor, or set [lidar] units_per_meter in dvi.toml");
}

media::PointTimes find_point_times(Drive& drive, const media::PointCloud& cloud, const ScanHeader& header,
                                   media::TimedScan scan) {
  if (cloud.t.empty()) return {};
  scan.turn_share = media::compute_turn_share(cloud.points);
  media::PointTimes times = media::infer_point_times(cloud.t, scan);
  if (times.use == media::PointTimes::Use::unknown)
    throw InputError(header.file, fmt::format("the times of its points {}", times.text),
                     "convert them to seconds after the start of the scan, correct [lidar] rate, or remove the field");
  if (times.use == media::PointTimes::Use::times && !times.usual())
    drive.warnings.push_back(fmt::format("the times of the points in scans {}, by their values", times.text));
  return times;
}

/// The scans whose columns were checked. Scans are read several times.
class CheckedScans {
 public:
  bool contains(const fs::path& file) const {
    const std::scoped_lock lock(mutex_);
    return files_.contains(file);
  }
  void insert(const fs::path& file) {
    const std::scoped_lock lock(mutex_);
    files_.insert(file);
  }

 private:
  mutable std::mutex mutex_;
  std::set<fs::path> files_;
};

}  // namespace

Scan ScanFiles::read(const ScanHeader& header) const {
  media::PointCloud cloud = media::read_point_cloud(header.file, bin);
  if (units_per_meter != 1)
    for (Eigen::Vector3f& point : cloud.points) point /= static_cast<float>(units_per_meter);
  return to_scan(std::move(cloud), header, clock);
}

ScanFiles inspect_scan_files(Drive& drive, const LidarConfig& config, const Rotation& rotation) {
  ScanFiles files{.bin = {},
                  .clock = {.rotation = rotation, .times = {}, .clock_offset_ns = config.offset_ns},
                  .units_per_meter = config.units_per_meter};
  if (drive.scan_headers.empty()) return files;
  const std::size_t last = drive.scan_headers.size() - 1;
  const media::TimedScan scan = make_timed_scan(drive, last, config.offset_ns);
  files.bin = find_layout(drive, config, scan);
  const ScanHeader& header = drive.scan_headers[last];
  const media::PointCloud cloud = media::read_point_cloud(header.file, files.bin);
  require_meters(cloud, header.file, config.units_per_meter);
  files.clock.times = find_point_times(drive, cloud, header, scan);
  if (files.clock.times.use == media::PointTimes::Use::none) {
    if (!config.turn) files.clock.rotation.turn = Turn::none;
    drive.warnings.push_back(fmt::format(
        "the times of the points in scans {} and are not used: {}", files.clock.times.text,
        config.turn ? "[lidar] rotation is used instead"
                    : "scans are assumed to be compensated for motion; set [lidar] rotation in dvi.toml if this is wrong"));
  }
  return files;
}

void attach_scan_files(DriveContents& recording, const LidarConfig& config, const Rotation& rotation) {
  recording.inspect_scans = [config, rotation](DriveContents& cut) {
    const ScanFiles files = inspect_scan_files(cut.drive, config, rotation);
    cut.point_bytes = files.bin.shape().point_bytes();
    cut.read_scan = [files, checked = std::make_shared<CheckedScans>()](const ScanHeader& header) {
      ScanFiles known = files;
      known.bin.stated = files.bin.stated || checked->contains(header.file);
      Scan scan = known.read(header);
      checked->insert(header.file);
      return scan;
    };
  };
}

std::string describe_other_scans(const fs::path& drive) {
  std::map<std::string, std::size_t> files;
  if (fs::is_directory(drive / "lidar"))
    for (const auto& entry : fs::directory_iterator(drive / "lidar"))
      if (entry.is_regular_file() && !entry.path().filename().string().starts_with("."))
        ++files[to_lower_case(entry.path().extension().string())];
  std::string text;
  for (const auto& [ending, count] : files)
    text += fmt::format("{}{} {}", text.empty() ? "" : ", ", count, ending.empty() ? "without an ending" : ending);
  return text;
}

void refuse_other_geometry(const fs::path& drive) {
  if (const std::string others = describe_other_scans(drive); !others.empty())
    throw InputError(drive / "lidar", "holds no scans in a supported format (.bin, .ply, .pcd), but " + others,
                     "convert each scan to .bin (float32 x y z intensity), .ply or .pcd; see docs/formats.md");
  refuse_other_map(drive);
}

}  // namespace dvi::datasets
