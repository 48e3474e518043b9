#include <algorithm>
#include <cmath>
#include <map>
#include <memory>
#include <optional>

#include <fmt/format.h>

#include "dvi/core/error.h"
#include "dvi/core/median.h"
#include "dvi/io/bag_messages.h"
#include "dvi/io/bag_topics.h"
#include "dvi/io/camera_choice.h"
#include "dvi/io/depth_scan.h"
#include "dvi/io/drive_config.h"
#include "dvi/io/image_file.h"
#include "dvi/io/plausible.h"
#include "dvi/io/reader.h"
#include "dvi/io/rgbd.h"
#include "dvi/io/ros_frames.h"
#include "dvi/io/scan_time.h"

namespace dvi::io {
namespace {

double as_seconds(std::int64_t ns) { return 1e-9 * static_cast<double>(ns); }

// By how much a topic's stamps are behind the recorder's clock, which is one for all topics.
double behind(const BagTopic& topic, const std::vector<StampedEntry>& stamps) {
  std::vector<double> out;
  for (const StampedEntry& entry : stamps) out.push_back(as_seconds(topic.messages[entry.number].time_ns - entry.time_ns));
  return median(std::move(out));
}

void compare_clocks(const fs::path& path, const BagCamera& camera, const std::vector<StampedEntry>& images,
                    const BagTopic& points, const std::vector<StampedEntry>& scans, std::vector<std::string>& warnings) {
  constexpr double kOtherClock = 0.5;  // seconds; what drivers and networks take is less
  const double ahead = behind(points, scans) - behind(*camera.images, images);
  if (std::abs(ahead) > kOtherClock)
    warnings.push_back(
        fmt::format("by when they were recorded, the stamps of {} are {:.2f} s {} those of {}: of another clock? "
                    "[camera.{}] offset_s = {:.2f} in dvi.toml would mend it",
                    camera.images->name, std::abs(ahead), ahead > 0 ? "ahead of" : "behind", points.name, camera.name, -ahead));
  if (std::abs(ahead) <= kOtherClock &&
      (images.front().time_ns > scans.back().time_ns || scans.front().time_ns > images.back().time_ns))
    throw InputError(path,
                     fmt::format("the stamps of {} are all before or after those of {}", camera.images->name, points.name));
}

// Sets the camera by its CameraInfo. An image that was rectified has the rectified camera.
void set_camera_of(Drive& drive, const RosCameraInfo& info, const BagCamera& camera, const fs::path& path) {
  const bool rectified = camera.images->name.find("rect") != std::string::npos;
  drive.camera.width = info.width, drive.camera.height = info.height;
  const auto set = [&](double fx, double fy, double cx, double cy) {
    drive.camera.fx = fx, drive.camera.fy = fy, drive.camera.cx = cx, drive.camera.cy = cy;
  };
  if (rectified) return set(info.P[0], info.P[5], info.P[2], info.P[6]);
  set(info.K[0], info.K[4], info.K[2], info.K[5]);
  const bool pinhole = info.model.empty() || info.model == "plumb_bob" || info.model == "radtan" || info.model == "none" ||
                       info.model == "rational_polynomial";
  const auto is_zero = [](double d) { return d == 0; };
  if (std::all_of(info.D.begin(), info.D.end(), is_zero)) return;
  const std::size_t kept = std::min(info.D.size(), drive.camera.distortion.size());
  if (!pinhole || !std::all_of(info.D.begin() + static_cast<std::ptrdiff_t>(kept), info.D.end(), is_zero))
    throw InputError(path,
                     fmt::format("{} has the distortion '{}' with {} numbers", camera.info->name, info.model, info.D.size()),
                     "undistort the images first (image_proc), or give K and distortion of five numbers in dvi.toml");
  std::copy_n(info.D.begin(), kept, drive.camera.distortion.begin());
}

RosFrames read_frames_tree(const BagMessages& messages) {
  RosFrames frames;
  for (const BagTopic& topic : messages.bag().topics) {
    if (!is_tf(topic) || topic.encoding == BagEncoding::other) continue;
    for (std::size_t i = 0; i < topic.messages.size(); ++i)
      for (const RosMotion& motion :
           messages.parsed(topic, i, [](std::string_view m, BagEncoding e) { return parse_tf(m, e); }))
        frames.add(motion, topic.name.ends_with("tf_static"));
  }
  return frames;
}

// world_from_lidar of a topic of poses; empty, with a warning, where it is not known where they are on the vehicle.
Trajectory read_pose_topic(const BagMessages& messages, const BagTopic& topic, const RosFrames& frames,
                           const std::string& lidar, std::vector<std::string>& warnings) {
  std::vector<StampedPose> poses;
  std::optional<SE3> child_from_lidar;
  for (std::size_t i = 0; i < topic.messages.size(); ++i) {
    const bool odometry = topic.type == "nav_msgs/Odometry";
    RosMotion motion = messages.parsed(
        topic, i, [&](std::string_view m, BagEncoding e) { return odometry ? parse_odometry(m, e) : parse_pose(m, e); });
    if (motion.child.empty()) motion.child = frames.between("base_link", lidar) ? "base_link" : lidar;
    if (!child_from_lidar) child_from_lidar = frames.between(motion.child, lidar);
    if (!child_from_lidar) {
      warnings.push_back(fmt::format("the poses of {} are not used: no tf joins their frame {} to {}, that of the scans",
                                     topic.name, motion.child, lidar));
      return {};
    }
    const std::int64_t time = motion.header.stamp_ns != 0 ? motion.header.stamp_ns : topic.messages[i].time_ns;
    poses.push_back({time, motion.parent_from_child * *child_from_lidar});
  }
  return Trajectory(std::move(poses));
}

// An antenna that no tf joins to the LiDAR is taken to be where that is.
std::vector<GeoFix> read_fixes(const BagMessages& messages, const BagTopic& topic, const RosFrames& frames,
                               const std::string& lidar) {
  std::vector<GeoFix> fixes;
  for (std::size_t i = 0; i < topic.messages.size(); ++i) {
    const RosFix fix = messages.parsed(topic, i, [](std::string_view m, BagEncoding e) { return parse_fix(m, e); });
    const std::int64_t time = fix.header.stamp_ns != 0 ? fix.header.stamp_ns : topic.messages[i].time_ns;
    const SE3 lidar_from_antenna = frames.between(lidar, fix.header.frame).value_or(SE3());
    if (fix.valid) fixes.push_back({time, fix.latitude_deg, fix.longitude_deg, lidar_from_antenna.t});
  }
  return fixes;
}

// The spread of the points' own times about the stamp; none where they have none.
struct PointTimes {
  double first = 0, last = 0;
};

std::optional<PointTimes> times_of_points(const RosCloud& cloud, const fs::path& path, const BagTopic& topic) {
  if (cloud.after_stamp.empty()) return std::nullopt;
  constexpr double kLongest = 2;  // seconds: twice that of the slowest LiDARs
  const auto [first, last] = std::minmax_element(cloud.after_stamp.begin(), cloud.after_stamp.end());
  if (*last - *first > kLongest || std::abs(*first) > kLongest)
    throw InputError(path,
                     fmt::format("{}: its points' times go from {:.3g} to {:.3g} s after the stamp", topic.name, *first, *last),
                     "they are to be seconds, or nanoseconds in whole numbers, after the stamp or since 1970");
  return PointTimes{*first, *last};
}

ScanHeader scan_header(const StampedEntry& entry, const std::optional<PointTimes>& times, std::int64_t period,
                       LidarConfig::Stamp stamp, const fs::path& path) {
  ScanHeader header{fmt::format("{:06d}", entry.number), entry.time_ns, entry.time_ns, entry.time_ns, path};
  if (times) {
    // A revolution lasts until the next begins; the last firing is a little before.
    constexpr double kLastFiring = 0.05;  // of a revolution
    header.start_ns += std::llround(1e9 * times->first);
    header.end_ns += std::llround(1e9 * times->last);
    const std::int64_t left = period - (header.end_ns - header.start_ns);
    if (left > 0 && static_cast<double>(left) < kLastFiring * static_cast<double>(period)) header.end_ns += left;
  } else {
    header.start_ns -= stamp == LidarConfig::Stamp::start ? 0 : stamp == LidarConfig::Stamp::end ? period : period / 2;
    header.end_ns = header.start_ns + period;
  }
  header.time_ns = header.start_ns + (header.end_ns - header.start_ns) / 2;
  return header;
}

std::int64_t median_period(const std::vector<StampedEntry>& entries) {
  std::vector<std::int64_t> steps;
  for (std::size_t i = 1; i < entries.size(); ++i) steps.push_back(entries[i].time_ns - entries[i - 1].time_ns);
  return steps.empty() ? 100'000'000 : median(std::move(steps));
}

Scan to_scan(RosCloud cloud, const ScanHeader& header, std::int64_t offset_ns, const Rotation& rotation) {
  Scan scan;
  if (cloud.after_stamp.empty()) {
    scan.time = times_by_azimuth(cloud.points, header, rotation);
  } else {
    // Stamps may have been moved by the clock's offset since.
    const double stamp = as_seconds(cloud.header.stamp_ns + offset_ns - header.time_ns);
    for (const double after : cloud.after_stamp) scan.time.push_back(static_cast<float>(stamp + after));
  }
  scan.points = std::move(cloud.points);
  scan.intensity = std::move(cloud.intensity);
  scan.ring = std::move(cloud.ring);
  return scan;
}

class BagReader {
 public:
  BagReader(const fs::path& path, const ReadOptions& options)
      : messages_(std::make_shared<BagMessages>(path, open_bag(path))),
        choice_(choose_topics(path, messages_->bag(), options.topics)),
        config_(read_drive_config(fs::is_directory(path) ? path : path.parent_path())) {
    drive_.path = path;
    for (const BagCamera& camera : choice_.cameras) drive_.camera_names.push_back(camera.name);
    drive_.camera_name = choose_camera(drive_, options.camera, "");
    for (const BagCamera& camera : choice_.cameras)
      if (camera.name == drive_.camera_name) camera_ = camera;
  }

  Recording read() {
    drive_.other_files = messages_->bag().files;
    const std::vector<StampedEntry> images = messages_->stamped(*camera_.images, drive_.warnings);
    const BagTopic& measured = choice_.points ? *choice_.points : *choice_.depth.images;
    const std::vector<StampedEntry> scans = messages_->stamped(measured, drive_.warnings);
    compare_clocks(messages_->path(), camera_, images, measured, scans, drive_.warnings);
    for (const StampedEntry& image : images)
      drive_.frames.push_back({static_cast<int>(image.number),
                               fmt::format("{:06d}", image.number),
                               image.time_ns,
                               file_of(*camera_.images, image.number),
                               {}});
    const RosFrames frames = read_frames_tree(*messages_);
    if (choice_.points)
      read_lidar(scans, frames);
    else
      read_depth(scans, frames);
    if (config_) config_->apply(drive_);
    if (drive_.camera.fx == 0)
      throw InputError(messages_->path(), fmt::format("has no calibration of {}", camera_.images->name),
                       fmt::format("give [camera.{}] K and size in {}, or --topic info=TOPIC", camera_.name, config_path()));
    require_plausible(drive_.camera, messages_->path(), camera_.images->name);
    drive_.topics = list_topics(messages_->bag(), choice_);
    return recording(frames);
  }

 private:
  void read_lidar(const std::vector<StampedEntry>& scans, const RosFrames& frames) {
    const RosCloud first = cloud(scans.front().number);
    const auto times = times_of_points(first, messages_->path(), *choice_.points);
    for (const StampedEntry& scan : scans)
      drive_.scan_headers.push_back(scan_header(scan, times, median_period(scans),
                                                config_ ? config_->lidar.stamp : LidarConfig::Stamp::middle,
                                                file_of(*choice_.points, scan.number)));
    if (!times && !(config_ && config_->lidar.turn))
      drive_.warnings.push_back(
          fmt::format("the points of {} have no times: by azimuth, clockwise, the stamp in the middle; "
                      "[lidar] rotation and stamp in dvi.toml say otherwise",
                      choice_.points->name));
    set_camera(frames, first.header.frame);
    set_poses(frames, first.header.frame, {});
  }

  // A LiDAR's axes at the first camera.
  void read_depth(const std::vector<StampedEntry>& depths, const RosFrames& frames) {
    for (const StampedEntry& depth : depths)
      drive_.scan_headers.push_back({fmt::format("{:06d}", depth.number), depth.time_ns, depth.time_ns, depth.time_ns,
                                     file_of(*choice_.depth.images, depth.number)});
    const std::string first = frame_of(*choice_.cameras.front().images);
    set_camera(frames, first);
    drive_.camera_from_lidar = drive_.camera_from_lidar * camera_from_level();
    set_poses(frames, first, camera_from_level());
  }
  std::string frame_of(const BagTopic& topic) const {
    return messages_->parsed(topic, 0, [](std::string_view m, BagEncoding e) { return read_header(m, e); }).frame;
  }

  // Registered where tf says that it was taken from the camera's own place.
  DepthScan depth_scan(Drive& drive, const RosFrames& frames) const {
    const BagTopic& topic = *choice_.depth.images;
    const RosImage first = messages_->parsed(topic, 0, [](std::string_view m, BagEncoding e) { return parse_image(m, e); });
    const std::string colour = frame_of(*camera_.images);
    DepthCamera depth;
    if (first.header.frame != colour) {
      depth.depth_from_color = frames.between(first.header.frame, colour);
      if (!depth.depth_from_color)
        throw InputError(
            messages_->path(),
            fmt::format("no tf joins {} of {} to {} of {}", first.header.frame, topic.name, colour, camera_.images->name),
            "record /tf_static too, or depth that is registered to the images");
      if (choice_.depth.info == nullptr)
        throw InputError(messages_->path(), fmt::format("has no calibration of {}", topic.name), "record its camera_info too");
      Drive of_depth;
      set_camera_of(
          of_depth,
          messages_->parsed(*choice_.depth.info, 0, [](std::string_view m, BagEncoding e) { return parse_camera_info(m, e); }),
          choice_.depth, messages_->path());
      depth.camera = of_depth.camera;
    }
    if (config_) config_->depth.apply(depth);
    return depth_scan_of(drive, depth, cv::Size(static_cast<int>(first.width), static_cast<int>(first.height)), topic.name);
  }

  fs::path file_of(const BagTopic& topic, std::size_t number) const {
    return messages_->bag().files[topic.messages[number].file];
  }
  std::string config_path() const {
    return ((fs::is_directory(messages_->path()) ? messages_->path() : messages_->path().parent_path()) / "dvi.toml").string();
  }
  RosCloud cloud(std::size_t number) const {
    return messages_->parsed(*choice_.points, number, [](std::string_view m, BagEncoding e) { return parse_cloud(m, e); });
  }

  void set_camera(const RosFrames& frames, const std::string& lidar) {
    if (camera_.info) {
      const RosCameraInfo info =
          messages_->parsed(*camera_.info, 0, [](std::string_view m, BagEncoding e) { return parse_camera_info(m, e); });
      const bool overridden = config_ && config_->camera(camera_.name).K;
      if (!overridden) set_camera_of(drive_, info, camera_, messages_->path());
    }
    if (config_ && config_->camera(camera_.name).camera_from_lidar) return;
    const RosHeader image =
        messages_->parsed(*camera_.images, 0, [](std::string_view m, BagEncoding e) { return read_header(m, e); });
    const auto camera_from_lidar = frames.between(image.frame, lidar);
    if (!camera_from_lidar)
      throw InputError(
          messages_->path(),
          fmt::format("no tf joins {}, the frame of {}, to {}, that of {}", image.frame, camera_.images->name, lidar,
                      choice_.points ? choice_.points->name : choice_.cameras.front().images->name),
          fmt::format("record /tf_static too, or give [camera.{}] camera_from_lidar in {}", camera_.name, config_path()));
    drive_.camera_from_lidar = *camera_from_lidar;
  }

  // Of a LiDAR that is turned against the frame of that name.
  void set_poses(const RosFrames& frames, const std::string& lidar, const SE3& frame_from_lidar) {
    if (!choice_.named_poses) drive_.poses = frames.motion_of(lidar);
    if (drive_.poses.empty() && choice_.poses != nullptr)
      drive_.poses = read_pose_topic(*messages_, *choice_.poses, frames, lidar, drive_.warnings);
    else
      choice_.poses = nullptr;
    std::vector<StampedPose> poses = drive_.poses.poses();
    for (StampedPose& pose : poses) pose.world_from_body = pose.world_from_body * frame_from_lidar;
    if (!poses.empty() && choice_.points == nullptr) drive_.poses = Trajectory(std::move(poses));
    if (choice_.gps == nullptr) return;
    drive_.fixes = read_fixes(*messages_, *choice_.gps, frames, lidar);
    for (GeoFix& fix : drive_.fixes) fix.antenna = frame_from_lidar.inverse() * fix.antenna;
  }

  Recording recording(const RosFrames& frames) {
    Recording out;
    const cv::Size size(drive_.camera.width, drive_.camera.height);
    out.drive = std::move(drive_);
    const auto number_of = [](const std::string& name) { return static_cast<std::size_t>(std::stoul(name)); };
    out.read_image = [messages = messages_, topic = *camera_.images, size, number_of](const Frame& frame) {
      const std::size_t number = number_of(frame.name);
      const std::string place = fmt::format("{}: message {} of {}", messages->path().string(), number, topic.name);
      const auto raw_image = [](std::string_view m, BagEncoding e) { return to_bgr(parse_image(m, e)); };
      const cv::Mat3b image = is_compressed(topic)
                                  ? decode_image(place, messages->parsed(topic, number, compressed_image), size)
                                  : messages->parsed(topic, number, raw_image);
      if (image.size() != size)
        throw InputError(place,
                         fmt::format("is {}x{} pixels instead of {}x{}", image.cols, image.rows, size.width, size.height),
                         "images and calibration must be of one size");
      return image;
    };
    if (choice_.points == nullptr) {
      out.read_scan = [messages = messages_, topic = *choice_.depth.images, number_of,
                       scan = depth_scan(out.drive, frames)](const ScanHeader& header) {
        const cv::Mat1w image = messages->parsed(topic, number_of(header.name),
                                                 [](std::string_view m, BagEncoding e) { return to_depth(parse_image(m, e)); });
        if (image.size() != cv::Size(scan.camera.width, scan.camera.height))
          throw InputError(messages->path(),
                           fmt::format("message {} of {} is of another size than the first", header.name, topic.name));
        return scan(image, fmt::format("{}: message {} of {}", messages->path().string(), header.name, topic.name));
      };
      return out;
    }
    const std::int64_t offset = config_ ? config_->lidar.offset_ns : 0;
    const Rotation rotation = config_ ? config_->lidar.rotation() : Rotation();
    out.read_scan = [messages = messages_, topic = *choice_.points, number_of, offset, rotation](const ScanHeader& header) {
      RosCloud cloud =
          messages->parsed(topic, number_of(header.name), [](std::string_view m, BagEncoding e) { return parse_cloud(m, e); });
      if (cloud.points.empty())
        throw InputError(messages->path(), fmt::format("message {} of {} holds no finite points", header.name, topic.name));
      if (cloud.header.stamp_ns == 0) cloud.header.stamp_ns = topic.messages[number_of(header.name)].time_ns;
      return to_scan(std::move(cloud), header, offset, rotation);
    };
    return out;
  }

  std::shared_ptr<const BagMessages> messages_;
  BagChoice choice_;
  std::optional<DriveConfig> config_;
  BagCamera camera_;
  Drive drive_;
};

}  // namespace

DriveFormat rosbag_format() {
  return {"rosbag", "a ROS 1 or ROS 2 bag: .bag, .mcap or .db3, or a folder of such files", is_bag,
          [](const fs::path& path, const ReadOptions& options) { return BagReader(path, options).read(); }};
}

}  // namespace dvi::io
