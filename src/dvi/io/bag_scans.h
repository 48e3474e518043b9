#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "dvi/drive/drive.h"
#include "dvi/io/bag_messages.h"
#include "dvi/io/drive_config.h"
#include "dvi/io/point_times.h"
#include "dvi/io/ros_cloud.h"

namespace dvi::io {

/// The scans of a topic of a bag, sensor_msgs/PointCloud2 or CustomMsg of Livox.
class BagScans {
 public:
  /// `entries` are the messages in order of time, one at least. Infers from the first scan and one in the middle of the
  /// recording what the times of the points mean. Warns where they are not seconds or nanoseconds after the stamp or since
  /// 1970, and where there are none. InputError where they cannot be understood.
  BagScans(std::shared_ptr<const BagMessages> messages, const BagTopic& topic, const std::vector<StampedEntry>& entries,
           const LidarConfig& config, std::vector<std::string>& warnings);

  /// The frame of the scans.
  const std::string& frame() const { return frame_; }
  /// When the scan of a message begins and ends: half a period apart at least.
  ScanHeader header(const StampedEntry& entry) const;
  /// The scan of a header. Its times may have been moved by the clock offset of the configuration since. InputError where the
  /// message is damaged or holds no points.
  Scan read(const ScanHeader& header) const;

 private:
  RosCloud cloud(std::size_t number) const;
  void infer_times(const std::vector<StampedEntry>& entries, std::vector<std::string>& warnings);
  bool has_times() const { return times_.use == PointTimes::Use::times; }
  /// Whether points have the times of the message: also where these are all the same, unless the configuration has others.
  bool uses_times() const { return has_times() || (times_.use == PointTimes::Use::one_time && !is_rotation_given_); }
  std::vector<double> seconds_after_stamp(const RosCloud& cloud) const;

  std::shared_ptr<const BagMessages> messages_;
  BagTopic topic_;
  std::string frame_, time_field_;
  std::int64_t period_ns_;
  LidarConfig::Stamp stamp_;
  std::int64_t offset_ns_;
  Rotation rotation_;
  bool is_rotation_given_;
  PointTimes times_;
  double first_s_ = 0, last_s_ = 0;  ///< after the stamp: of the points of the first scan
};

}  // namespace dvi::io
