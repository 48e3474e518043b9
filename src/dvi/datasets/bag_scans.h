#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "dvi/bags/bag_messages.h"
#include "dvi/bags/ros_cloud.h"
#include "dvi/datasets/drive_config.h"
#include "dvi/drive/drive.h"
#include "dvi/media/point_times.h"

namespace dvi::datasets {

/// The scans of a topic of a bag, sensor_msgs/PointCloud2 or CustomMsg of Livox.
class BagScans {
 public:
  /// `entries` are the messages in order of time, one at least. Infers from the first scan and one in the middle of the
  /// recording what the times of the points mean. Warns where they are not seconds or nanoseconds after the stamp or since
  /// 1970, and where there are none. InputError where they cannot be understood.
  BagScans(std::shared_ptr<const bags::BagMessages> messages, const bags::BagTopic& topic,
           const std::vector<bags::StampedEntry>& entries, const LidarConfig& config, std::vector<std::string>& warnings);

  /// The frame of the scans.
  const std::string& frame() const { return frame_; }
  /// When the scan of a message begins and ends: half a period apart at least.
  ScanHeader header(const bags::StampedEntry& entry) const;
  /// The scan of a header. Its times may have been moved by the clock offset of the configuration since. InputError where the
  /// message is damaged or holds no points.
  Scan read(const ScanHeader& header) const;

 private:
  bags::RosCloud cloud(std::size_t number) const;
  void infer_times(const std::vector<bags::StampedEntry>& entries, std::vector<std::string>& warnings);
  bool has_times() const { return times_.use == media::PointTimes::Use::times; }
  /// Whether points have the times of the message: also where these are all the same, unless the configuration has others.
  bool uses_times() const { return has_times() || (times_.use == media::PointTimes::Use::one_time && !is_rotation_given_); }
  std::vector<double> seconds_after_stamp(const bags::RosCloud& cloud) const;

  std::shared_ptr<const bags::BagMessages> messages_;
  bags::BagTopic topic_;
  std::string frame_, time_field_;
  std::int64_t period_ns_;
  LidarConfig::Stamp stamp_;
  std::int64_t offset_ns_;
  Rotation rotation_;
  bool is_rotation_given_;
  media::PointTimes times_;
  double first_s_ = 0, last_s_ = 0;  ///< after the stamp: of the points of the first scan
};

}  // namespace dvi::datasets
