#include <algorithm>
#include <map>
#include <memory>
#include <optional>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "dvi/bags/bag_camera.h"
#include "dvi/bags/bag_frame_numbers.h"
#include "dvi/bags/bag_messages.h"
#include "dvi/bags/bag_topics.h"
#include "dvi/bags/ros_frames.h"
#include "dvi/bags/ros_image.h"
#include "dvi/core/error.h"
#include "dvi/core/median.h"
#include "dvi/datasets/bag_scans.h"
#include "dvi/datasets/camera_choice.h"
#include "dvi/datasets/depth_scan.h"
#include "dvi/datasets/drive_config.h"
#include "dvi/datasets/reader.h"
#include "dvi/datasets/rgbd.h"
#include "dvi/geometry/plausible.h"
#include "dvi/media/image_file.h"
#include "dvi/media/image_storage.h"

namespace dvi::datasets {
namespace {

// Returns the median delay of a topic's stamps behind the clock of the recorder, which is the same for all topics.
double find_median_delay_s(const bags::BagTopic& topic, const std::vector<bags::StampedEntry>& stamps) {
  std::vector<double> out;
  for (const bags::StampedEntry& entry : stamps) out.push_back(ns_to_s(topic.messages[entry.number].time_ns - entry.time_ns));
  return median(std::move(out));
}

bags::RosFrames read_frames_tree(const bags::BagMessages& messages, std::vector<std::string>& warnings) {
  bags::RosFrames frames;
  int invalid = 0;
  std::string first_invalid;
  for (const bags::BagTopic& topic : messages.bag().topics) {
    if (!bags::is_tf(topic) || topic.encoding == bags::BagEncoding::other) continue;
    for (std::size_t i = 0; i < topic.messages.size(); ++i)
      for (const bags::RosMotion& motion :
           messages.decode(topic, i, [](std::string_view m, bags::BagEncoding e) { return bags::parse_tf(m, e); })) {
        if (motion.valid) {
          frames.add(motion, topic.name.ends_with("tf_static"));
        } else if (invalid++ == 0) {
          first_invalid = fmt::format("{} to {}, message {} of {}", motion.header.frame, motion.child, i, topic.name);
        }
      }
  }
  if (invalid > 0)
    warnings.push_back(
        fmt::format("{} transforms are ignored, because their quaternion does not have length 1 or their translation is not "
                    "finite; the first: {}",
                    invalid, first_invalid));
  return frames;
}

// An antenna that no tf connects with the LiDAR is assumed to be at the LiDAR's position.
std::vector<GeoFix> read_fixes(const bags::BagMessages& messages, const bags::BagTopic& topic, const bags::RosFrames& frames,
                               const std::string& lidar) {
  std::vector<GeoFix> fixes;
  for (std::size_t i = 0; i < topic.messages.size(); ++i) {
    const bags::RosFix fix =
        messages.decode(topic, i, [](std::string_view m, bags::BagEncoding e) { return bags::parse_fix(m, e); });
    const std::int64_t time = fix.header.stamp_ns != 0 ? fix.header.stamp_ns : topic.messages[i].time_ns;
    const SE3 lidar_from_antenna = frames.find_transform(lidar, fix.header.frame).value_or(SE3());
    if (fix.valid) fixes.push_back({time, fix.latitude_deg, fix.longitude_deg, lidar_from_antenna.t});
  }
  return fixes;
}

class BagReader {
 public:
  BagReader(const fs::path& path, const ReadOptions& options)
      : messages_(std::make_shared<bags::BagMessages>(path, bags::open_bag(path))),
        choice_(bags::choose_topics(path, messages_->bag(), options.topics)),
        config_(read_drive_config(fs::is_directory(path) ? path : path.parent_path())) {
    drive_.path = path;
    for (const bags::BagCamera& camera : choice_.cameras) drive_.camera_names.push_back(camera.name);
    drive_.camera_name = choose_camera(drive_, options.camera, "");
    for (const bags::BagCamera& camera : choice_.cameras)
      if (camera.name == drive_.camera_name) camera_ = camera;
  }

  DriveContents read() {
    drive_.other_files = messages_->bag().files;
    const std::vector<bags::StampedEntry> images = messages_->list_stamped(*camera_.images, drive_.warnings);
    const bags::BagTopic& measured = choice_.points ? *choice_.points : *choice_.depth.images;
    const std::vector<bags::StampedEntry> scans = messages_->list_stamped(measured, drive_.warnings);
    compare_clocks(images, measured, scans);
    drive_.warnings.insert(drive_.warnings.end(), messages_->bag().warnings.begin(), messages_->bag().warnings.end());
    warn_of_lost_messages(measured);
    add_frames(images);
    const bags::RosFrames frames = read_frames_tree(*messages_, drive_.warnings);
    if (choice_.points)
      read_lidar(scans, frames);
    else
      read_depth(scans, frames);
    if (config_) config_->apply(drive_);
    if (drive_.camera.fx == 0)
      throw InputError(messages_->path(), fmt::format("has no calibration of {}", camera_.images->name),
                       fmt::format("give [camera.{}] K and size in {}, or --topic info=TOPIC", camera_.name, config_path()));
    require_plausible(drive_.camera, messages_->path(), camera_.images->name);
    drive_.topics = bags::list_topics(messages_->bag(), choice_);
    return recording(frames);
  }

 private:
  void compare_clocks(const std::vector<bags::StampedEntry>& images, const bags::BagTopic& points,
                      const std::vector<bags::StampedEntry>& scans) {
    constexpr double kMaxDelayS = 0.5;  // drivers and networks cause smaller delays
    const double ahead = find_median_delay_s(points, scans) - find_median_delay_s(*camera_.images, images);
    if (std::abs(ahead) > kMaxDelayS)
      drive_.warnings.push_back(fmt::format(
          "judging by the times of recording, the stamps of {} are {:.2f} s {} those of {} and may be of another clock: "
          "set [camera.{}] offset_s = {:.2f} in dvi.toml",
          camera_.images->name, std::abs(ahead), ahead > 0 ? "ahead of" : "behind", points.name, camera_.name, -ahead));
    if (std::abs(ahead) <= kMaxDelayS &&
        (images.front().time_ns > scans.back().time_ns || scans.front().time_ns > images.back().time_ns))
      throw InputError(messages_->path(),
                       fmt::format("the stamps of {} are all before or after those of {}", camera_.images->name, points.name));
  }

  // Reads world_from_lidar from the topic of poses. Returns an empty trajectory and adds a warning if their frame cannot be
  // related to the LiDAR.
  Trajectory read_pose_topic(const bags::RosFrames& frames, const std::string& lidar) {
    const bags::BagTopic& topic = *choice_.poses;
    std::vector<StampedPose> poses;
    std::optional<SE3> child_from_lidar;
    for (std::size_t i = 0; i < topic.messages.size(); ++i) {
      const bool odometry = topic.type == "nav_msgs/Odometry";
      bags::RosMotion motion = messages_->decode(topic, i, [&](std::string_view m, bags::BagEncoding e) {
        return odometry ? bags::parse_odometry(m, e) : bags::parse_pose(m, e);
      });
      if (motion.child.empty()) motion.child = frames.find_transform("base_link", lidar) ? "base_link" : lidar;
      if (!child_from_lidar) child_from_lidar = frames.find_transform(motion.child, lidar);
      if (!child_from_lidar) {
        drive_.warnings.push_back(
            fmt::format("the poses of {} are not used: no tf connects their frame {} with {}, the frame of the scans",
                        topic.name, motion.child, lidar));
        return {};
      }
      const std::int64_t time = motion.header.stamp_ns != 0 ? motion.header.stamp_ns : topic.messages[i].time_ns;
      poses.push_back({time, motion.parent_from_child * *child_from_lidar});
    }
    return Trajectory(std::move(poses));
  }

  // Numbers frames by their index in the whole recording.
  void add_frames(const std::vector<bags::StampedEntry>& images) {
    warn_of_lost_messages(*camera_.images);
    const bags::FrameNumbers numbers = bags::number_frames(*messages_, *camera_.images, images);
    if (!numbers.missing.empty())
      drive_.warnings.push_back(fmt::format("frames {} are missing because files are missing{}",
                                            fmt::join(numbers.missing, ", "),
                                            numbers.is_estimated ? " (estimated from the regular times of the others)" : ""));
    for (const bags::StampedEntry& image : images) {
      const std::size_t number = numbers.number(*camera_.images, image.number);
      image_of_frame_[static_cast<int>(number)] = image.number;
      drive_.frames.push_back(
          {static_cast<int>(number), bags::frame_name(number), image.time_ns, file_of(*camera_.images, image.number), {}});
    }
  }

  // Warns if no file is missing, but metadata.yaml counts more messages than the files hold.
  void warn_of_lost_messages(const bags::BagTopic& topic) {
    const bags::Bag& bag = messages_->bag();
    const auto count = bag.counts.find(topic.name);
    if (count != bag.counts.end() && bag.missing.empty() && count->second > topic.messages.size())
      drive_.warnings.push_back(
          fmt::format("{} of {} messages of {} that metadata.yaml counts are missing: the files are truncated",
                      count->second - topic.messages.size(), count->second, topic.name));
  }

  void read_lidar(const std::vector<bags::StampedEntry>& entries, const bags::RosFrames& frames) {
    const LidarConfig config = config_ ? config_->lidar : LidarConfig();
    scans_ = std::make_shared<BagScans>(messages_, *choice_.points, entries, config);
    drive_.warnings.insert(drive_.warnings.end(), scans_->warnings().begin(), scans_->warnings().end());
    for (const bags::StampedEntry& entry : entries) drive_.scan_headers.push_back(scans_->header(entry));
    set_camera(frames, scans_->frame());
    set_poses(frames, scans_->frame(), {});
  }

  // The scans of depth images are in the axes that a level LiDAR at the camera would have.
  void read_depth(const std::vector<bags::StampedEntry>& depths, const bags::RosFrames& frames) {
    const std::int64_t half = bags::median_period_ns(depths) / 2;  // images and depth are not synchronous
    for (const bags::StampedEntry& depth : depths)
      drive_.scan_headers.push_back({fmt::format("{:06d}", depth.number), depth.time_ns, depth.time_ns - half,
                                     depth.time_ns + half, file_of(*choice_.depth.images, depth.number)});
    const std::string first = frame_of(*choice_.cameras.front().images);
    set_camera(frames, first);
    drive_.camera_from_lidar = drive_.camera_from_lidar * camera_from_level();
    set_poses(frames, first, camera_from_level());
  }
  std::string frame_of(const bags::BagTopic& topic) const {
    return messages_->decode(topic, 0, [](std::string_view m, bags::BagEncoding e) { return bags::read_header(m, e); }).frame;
  }

  // Depth is registered to the images if tf states that both cameras are at the same position.
  DepthScan depth_scan(Drive& drive, const bags::RosFrames& frames) const {
    const bags::BagTopic& topic = *choice_.depth.images;
    const bags::RosImage first =
        messages_->decode(topic, 0, [](std::string_view m, bags::BagEncoding e) { return bags::parse_image(m, e); });
    const std::string color = frame_of(*camera_.images);
    DepthCamera depth;
    if (first.header.frame != color) {
      depth.depth_from_color = frames.find_transform(first.header.frame, color);
      if (!depth.depth_from_color)
        throw InputError(
            messages_->path(),
            fmt::format("no tf connects {} of {} with {} of {}", first.header.frame, topic.name, color, camera_.images->name),
            "record /tf_static as well, or record depth that is registered to the images");
      if (choice_.depth.info == nullptr)
        throw InputError(messages_->path(), fmt::format("has no calibration of {}", topic.name),
                         "record its camera_info as well");
      std::vector<std::string> warnings;  // are ignored: they are about the frame of the color camera
      depth.camera = bags::read_bag_camera(*messages_, choice_.depth, warnings);
    }
    if (config_) config_->depth.apply(depth);
    return make_depth_scan(drive, depth, cv::Size(static_cast<int>(first.width), static_cast<int>(first.height)), topic.name);
  }

  fs::path file_of(const bags::BagTopic& topic, std::size_t number) const {
    return messages_->bag().files[topic.messages[number].file];
  }
  std::string config_path() const {
    return ((fs::is_directory(messages_->path()) ? messages_->path() : messages_->path().parent_path()) / "dvi.toml").string();
  }
  void set_camera(const bags::RosFrames& frames, const std::string& lidar) {
    const bool overridden = config_ && config_->camera(camera_.name).K;
    if (camera_.info != nullptr && !overridden) drive_.camera = bags::read_bag_camera(*messages_, camera_, drive_.warnings);
    if (config_ && config_->camera(camera_.name).camera_from_lidar) return;
    const bags::RosHeader image =
        messages_->decode(*camera_.images, 0, [](std::string_view m, bags::BagEncoding e) { return bags::read_header(m, e); });
    const auto camera_from_lidar = frames.find_transform(image.frame, lidar);
    if (!camera_from_lidar)
      throw InputError(
          messages_->path(),
          fmt::format("no tf connects {}, the frame of {}, with {}, the frame of {}", image.frame, camera_.images->name, lidar,
                      choice_.points ? choice_.points->name : choice_.cameras.front().images->name),
          fmt::format("record /tf_static as well, or set [camera.{}] camera_from_lidar in {}", camera_.name, config_path()));
    drive_.camera_from_lidar = *camera_from_lidar;
  }

  // `frame_from_lidar` is the rotation of a LiDAR relative to the tf frame of its name.
  void set_poses(const bags::RosFrames& frames, const std::string& lidar, const SE3& frame_from_lidar) {
    if (!choice_.has_named_poses) drive_.poses = frames.find_motion(lidar);
    if (drive_.poses.empty() && choice_.poses != nullptr)
      drive_.poses = read_pose_topic(frames, lidar);
    else
      choice_.poses = nullptr;
    std::vector<StampedPose> poses = drive_.poses.poses();
    for (StampedPose& pose : poses) pose.world_from_body = pose.world_from_body * frame_from_lidar;
    if (!poses.empty() && choice_.points == nullptr) drive_.poses = Trajectory(std::move(poses));
    if (choice_.gps == nullptr) return;
    drive_.fixes = read_fixes(*messages_, *choice_.gps, frames, lidar);
    for (GeoFix& fix : drive_.fixes) fix.antenna = frame_from_lidar.inverse() * fix.antenna;
  }

  // Cameras of 10, 12, or 14 bits use only the lower part of 16-bit pixels.
  int find_topic_bits() {
    constexpr std::size_t kMaxSamples = 50;
    const bags::BagTopic& topic = *camera_.images;
    const auto largest_value = [&](std::string_view m, bags::BagEncoding e) {
      const auto largest_of = [](const auto& image) { return bags::has_16_bits(image) ? bags::find_largest_value(image) : -1; };
      return bags::is_compressed(topic) ? largest_of(bags::parse_compressed_image(m, e)) : largest_of(bags::parse_image(m, e));
    };
    int largest = 0;
    const std::size_t step = topic.messages.size() / kMaxSamples + 1;
    for (std::size_t i = 0; i < topic.messages.size(); i += step) {
      const int value = messages_->decode(topic, i, largest_value);
      if (value < 0) return 16;
      largest = std::max(largest, value);
    }
    const int bits = media::estimate_value_bits(largest);
    if (bits < 16)
      drive_.warnings.push_back(fmt::format("the 16-bit images of {} hold no value above {} and are read as {}-bit images",
                                            topic.name, largest, bits));
    return bits;
  }

  DriveContents recording(const bags::RosFrames& frames) {
    const int value_bits = find_topic_bits();
    DriveContents out;
    const cv::Size size(drive_.camera.width, drive_.camera.height);
    out.drive = std::move(drive_);
    out.read_image = [messages = messages_, topic = *camera_.images, size, value_bits,
                      image_of_frame = image_of_frame_](const Frame& frame) {
      const std::size_t number = image_of_frame.at(frame.number);
      const std::string place = fmt::format("{}: message {} of {}", messages->path().string(), number, topic.name);
      const auto raw_image = [&](std::string_view m, bags::BagEncoding e) {
        return bags::to_bgr(bags::parse_image(m, e), value_bits);
      };
      const auto decode_file = [&](std::string_view m, bags::BagEncoding e) {
        const bags::RosCompressedImage image = bags::parse_image_file(m, e);
        const cv::Mat3b decoded = media::decode_image(place, image.file, size);
        return bags::convert_bayer_file(bags::has_16_bits(image) ? bags::to_bgr(image, value_bits) : decoded, image.format);
      };
      const cv::Mat3b image = bags::is_compressed(topic) ? messages->decode(topic, number, decode_file)
                                                         : messages->decode(topic, number, raw_image);
      if (image.size() != size)
        throw InputError(place,
                         fmt::format("is {}x{} pixels instead of {}x{}", image.cols, image.rows, size.width, size.height),
                         "images and calibration must have the same size");
      return image;
    };
    if (choice_.points == nullptr) {
      const auto number_of = [](const std::string& name) { return static_cast<std::size_t>(std::stoul(name)); };
      out.read_scan = [messages = messages_, topic = *choice_.depth.images, number_of,
                       scan = depth_scan(out.drive, frames)](const ScanHeader& header) {
        const cv::Mat1w image = messages->decode(topic, number_of(header.name), [](std::string_view m, bags::BagEncoding e) {
          return bags::to_depth(bags::parse_image(m, e));
        });
        if (image.size() != cv::Size(scan.camera.width, scan.camera.height))
          throw InputError(messages->path(),
                           fmt::format("message {} of {} differs in size from the first one", header.name, topic.name));
        return scan(image, fmt::format("{}: message {} of {}", messages->path().string(), header.name, topic.name));
      };
      return out;
    }
    out.read_scan = [scans = scans_](const ScanHeader& header) { return scans->read(header); };
    return out;
  }

  std::shared_ptr<const bags::BagMessages> messages_;
  bags::BagChoice choice_;
  std::optional<DriveConfig> config_;
  bags::BagCamera camera_;
  std::map<int, std::size_t> image_of_frame_;  // message by number of the frame
  std::shared_ptr<const BagScans> scans_;      // none if the scans are depth images
  Drive drive_;
};

}  // namespace

DriveFormat rosbag_format() {
  return {"rosbag", "a ROS 1 or ROS 2 bag: .bag, .mcap or .db3, or a folder of such files", bags::is_bag,
          [](const fs::path& path, const ReadOptions& options) { return BagReader(path, options).read(); }};
}

}  // namespace dvi::datasets
