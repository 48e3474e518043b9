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

/// Reads the scans of one topic of a bag: sensor_msgs/PointCloud2, or CustomMsg of Livox.
class BagScans {
 public:
  /// Infers the meaning of the points' times from the first scan and from one in the middle of the recording. `entries` are the
  /// messages in order of time, at least one. Warns if the times are not seconds or nanoseconds after the stamp or since
  /// 1970, or if there are none. Throws InputError if their meaning cannot be determined.
  BagScans(std::shared_ptr<const bags::BagMessages> messages, const bags::BagTopic& topic,
           const std::vector<bags::StampedEntry>& entries, const LidarConfig& config);

  const std::vector<std::string>& warnings() const { return warnings_; }
  /// Returns the tf frame of the scans.
  const std::string& frame() const { return frame_; }
  /// Returns the header of a message's scan. Its start and end are at least half a period apart.
  ScanHeader header(const bags::StampedEntry& entry) const;
  /// Reads the scan of a header. The clock offset of the configuration may have been added to the header's times since. Throws
  /// InputError if the message is damaged or holds no points.
  Scan read(const ScanHeader& header) const;

 private:
  bags::RosCloud cloud(std::size_t number) const;
  void infer_times(const std::vector<bags::StampedEntry>& entries);
  bool has_times() const { return times_.use == media::PointTimes::Use::times; }
  /// Returns whether points have the times of the message. This includes equal times of all points, unless the configuration
  /// states a rotation.
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
  std::vector<std::string> warnings_;
  double first_s_ = 0, last_s_ = 0;  ///< of the points of the first scan, after its stamp
};

}  // namespace dvi::datasets
