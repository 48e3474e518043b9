#include "dvi/datasets/bag_scans.h"

#include "dvi/core/text.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "dvi/bags/bag_topics.h"
#include "dvi/core/error.h"

namespace dvi::datasets {
namespace {

// Drivers usually write seconds or nanoseconds after the stamp or since 1970; such times need no warning.
bool is_usual(const media::PointTimes& times) {
  const bool is_counted = times.unit_s == 1 || times.unit_s == 1e-9;
  return times.use == media::PointTimes::Use::times && is_counted && times.zero != media::PointTimes::Zero::first_point;
}

}  // namespace

BagScans::BagScans(std::shared_ptr<const bags::BagMessages> messages, const bags::BagTopic& topic,
                   const std::vector<bags::StampedEntry>& entries, const LidarConfig& config)
    : messages_(std::move(messages)),
      topic_(topic),
      period_ns_(bags::median_period_ns(entries)),
      stamp_(config.stamp),
      offset_ns_(config.offset_ns),
      rotation_(config.rotation()),
      is_rotation_given_(config.turn.has_value()) {
  infer_times(entries);
  if (has_times() || is_rotation_given_) return;
  if (times_.text.empty()) {
    warnings_.push_back(
        fmt::format("the points of {} have no times: they are inferred from the azimuth, with a clockwise rotation and the "
                    "stamp in the middle; "
                    "set [lidar] rotation and stamp in dvi.toml if this is wrong",
                    topic_.name));
  } else {
    rotation_.turn = Turn::none;
    warnings_.push_back(fmt::format(
        "the times of the points of {} ({}) {}: the scans are assumed to be compensated for motion; if they are not, set "
        "[lidar] rotation in dvi.toml",
        topic_.name, time_field_, times_.text));
  }
}

bags::RosCloud BagScans::cloud(std::size_t number) const {
  const auto parse = bags::is_livox(topic_) ? bags::parse_livox : bags::parse_cloud;
  bags::RosCloud cloud = messages_->decode(topic_, number, parse);
  if (cloud.points.empty())
    throw InputError(messages_->path(), fmt::format("message {} of {} holds no finite points", number, topic_.name));
  if (cloud.header.stamp_ns == 0) cloud.header.stamp_ns = topic_.messages[number].time_ns;
  return cloud;
}

void BagScans::infer_times(const std::vector<bags::StampedEntry>& entries) {
  bags::RosCloud first = cloud(entries.front().number);
  frame_ = first.header.frame, time_field_ = first.time_field;
  times_.use = media::PointTimes::Use::none;
  if (first.times.empty()) return;
  bags::RosCloud middle = cloud(entries[entries.size() / 2].number);
  times_ = media::infer_point_times(
      middle.times, {ns_to_s(period_ns_), ns_to_s(middle.header.stamp_ns), media::compute_turn_share(middle.points)});
  if (times_.use == media::PointTimes::Use::unknown)
    throw InputError(messages_->path(),
                     fmt::format("the times of the points of {} ({}) {}", topic_.name, time_field_, times_.text),
                     "correct them, or record the scans without them");
  if (!has_times()) return;
  if (!is_usual(times_))
    warnings_.push_back(fmt::format("the times of the points of {} ({}) {}", topic_.name, time_field_, times_.text));
  for (const bags::RosCloud* example : {&first, &middle}) {
    const std::vector<double> seconds = seconds_after_stamp(*example);
    const auto [least, most] = std::minmax_element(seconds.begin(), seconds.end());
    first_s_ = *least, last_s_ = *most;
    if (2 * (last_s_ - first_s_) >= ns_to_s(period_ns_)) return;
  }
  // A scan that is cropped to a field of view is shorter than a period.
  const double center_s = 0.5 * (first_s_ + last_s_);
  first_s_ = center_s - 0.25 * ns_to_s(period_ns_), last_s_ = center_s + 0.25 * ns_to_s(period_ns_);
}

std::vector<double> BagScans::seconds_after_stamp(const bags::RosCloud& cloud) const {
  constexpr double kMaxTimeS = 10;  // after the stamp
  const std::vector<double> seconds = media::to_seconds_after_start(cloud.times, times_, ns_to_s(cloud.header.stamp_ns), 0);
  for (const double after : seconds)
    if (!(std::abs(after) <= kMaxTimeS))
      throw InputError(messages_->path(),
                       fmt::format("{}: a time of its points ({}) is {:.4g} s after the stamp {:.4f}", topic_.name,
                                   cloud.time_field, after, ns_to_s(cloud.header.stamp_ns)),
                       "correct the times, or record the scans without them");
  return seconds;
}

ScanHeader BagScans::header(const bags::StampedEntry& entry) const {
  const fs::path file = messages_->bag().files[topic_.messages[entry.number].file];
  ScanHeader header{fmt::format("{:06d}", entry.number), entry.time_ns, entry.time_ns, entry.time_ns, file};
  if (has_times()) {
    // A revolution lasts until the next one begins; the last firing is slightly earlier.
    constexpr double kLastFiringShare = 0.05;  // fraction of a revolution, before its end
    header.start_ns += std::llround(1e9 * first_s_);
    header.end_ns += std::llround(1e9 * last_s_);
    const std::int64_t left = period_ns_ - (header.end_ns - header.start_ns);
    if (left > 0 && static_cast<double>(left) < kLastFiringShare * static_cast<double>(period_ns_)) header.end_ns += left;
  } else {
    using Stamp = LidarConfig::Stamp;
    header.start_ns -= stamp_ == Stamp::start ? 0 : stamp_ == Stamp::end ? period_ns_ : period_ns_ / 2;
    header.end_ns = header.start_ns + period_ns_;
  }
  header.time_ns = header.start_ns + (header.end_ns - header.start_ns) / 2;
  return header;
}

Scan BagScans::read(const ScanHeader& header) const {
  bags::RosCloud cloud = this->cloud(std::stoul(header.name));
  Scan scan;
  if (uses_times() && !cloud.times.empty()) {
    const double stamp_s = ns_to_s(cloud.header.stamp_ns + offset_ns_ - header.time_ns);
    for (const double after : seconds_after_stamp(cloud)) scan.time.push_back(static_cast<float>(stamp_s + after));
  } else {
    scan.time = times_by_azimuth(cloud.points, header, rotation_);
  }
  if (cloud.points.size() < cloud.message_points) {
    scan.file_points = cloud.message_points;
    scan.file_index = std::move(cloud.index);
  }
  scan.points = std::move(cloud.points);
  scan.intensity = std::move(cloud.intensity);
  scan.ring = std::move(cloud.ring);
  return scan;
}

}  // namespace dvi::datasets
