#include "dvi/bags/bag_topics.h"

#include <algorithm>
#include <map>
#include <optional>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "dvi/bags/bag_bytes.h"
#include "dvi/bags/ros_image.h"
#include "dvi/core/error.h"

namespace dvi::bags {
namespace {

constexpr const char* kCloudType = "sensor_msgs/PointCloud2";
constexpr const char* kLivoxTypes[] = {"livox_ros_driver/CustomMsg", "livox_ros_driver2/CustomMsg",
                                       "livox_interfaces/CustomMsg"};
constexpr const char* kInfoType = "sensor_msgs/CameraInfo";
constexpr const char* kFixType = "sensor_msgs/NavSatFix";
constexpr const char* kPoseTypes[] = {"nav_msgs/Odometry", "geometry_msgs/PoseStamped",
                                      "geometry_msgs/PoseWithCovarianceStamped"};

bool is_poses(const BagTopic& topic) {
  return std::find(std::begin(kPoseTypes), std::end(kPoseTypes), topic.type) != std::end(kPoseTypes);
}

// Types of messages with images or scans that are not supported.
struct UnreadType {
  const char* type;
  const char* content;
  const char* remedy;
};

constexpr const char* kRepublish = "republish it as sensor_msgs/Image (ros2 run image_transport republish) and record it";
constexpr const char* kConvertPackets = "play it with the driver of the sensor, and record its sensor_msgs/PointCloud2";
constexpr UnreadType kUnreadTypes[] = {
    {"ffmpeg_image_transport_msgs/FFMPEGPacket", "compressed video", kRepublish},
    {"foxglove_msgs/CompressedVideo", "compressed video", kRepublish},
    {"theora_image_transport/Packet", "compressed video", kRepublish},
    {"velodyne_msgs/VelodyneScan", "packets of a LiDAR", kConvertPackets},
    {"ouster_ros/PacketMsg", "packets of a LiDAR", kConvertPackets},
    {"ouster_sensor_msgs/PacketMsg", "packets of a LiDAR", kConvertPackets},
    {"ouster_msgs/PacketMsg", "packets of a LiDAR", kConvertPackets},
    {"hesai_ros_driver/UdpFrame", "packets of a LiDAR", kConvertPackets},
    {"pandar_msgs/PandarScan", "packets of a LiDAR", kConvertPackets},
    {"nebula_msgs/NebulaPackets", "packets of a LiDAR", kConvertPackets},
    {"rslidar_msg/RslidarPacket", "packets of a LiDAR", kConvertPackets},
    {"rslidar_msgs/rslidarScan", "packets of a LiDAR", kConvertPackets},
    {"sensor_msgs/PointCloud", "points in a deprecated format", "convert it to sensor_msgs/PointCloud2"},
    {"sensor_msgs/LaserScan", "scans of one plane", "scans in three dimensions are required"},
};

bool has_word(const std::string& text, const char* word) { return text.find(word) != std::string::npos; }

std::string find_base(const BagTopic& topic) {
  const std::string ending = "/compressed";
  return is_compressed(topic) && topic.name.ends_with(ending) ? topic.name.substr(0, topic.name.size() - ending.size())
                                                              : topic.name;
}

std::string find_folder(const std::string& topic) {
  return topic.substr(0, topic.rfind('/') == std::string::npos ? 0 : topic.rfind('/'));
}

// Returns cam0 for /cam0/image_raw; keeps the last part if it is more specific than "image".
std::string make_camera_name(const std::string& base) {
  std::string name = base.substr(base.rfind('/') + 1).starts_with("image") ? find_folder(base) : base;
  while (name.starts_with('/')) name.erase(0, 1);
  std::replace(name.begin(), name.end(), '/', '_');
  return name.empty() ? "camera" : name;
}

class TopicChooser {
 public:
  TopicChooser(const fs::path& path, const Bag& bag) : path_(path), bag_(bag) {}

  BagChoice run(const std::vector<std::string>& named) {
    BagChoice choice;
    const BagTopic* info = nullptr;
    std::vector<const BagTopic*> images;
    for (const std::string& text : named) {
      const std::size_t sign = text.find('=');
      const std::string key = text.substr(0, sign), topic = sign == std::string::npos ? "" : text.substr(sign + 1);
      if (key == "image") {
        images.push_back(require(topic, "images", is_images));
      } else if (key == "points") {
        choice.points = require(topic, "sensor_msgs/PointCloud2 or CustomMsg of Livox", is_scans);
      } else if (key == "depth") {
        choice.depth.images =
            require(topic, "depth images", [this](const BagTopic& t) { return t.type == "sensor_msgs/Image" && !is_color(t); });
      } else if (key == "info") {
        info = require(topic, "sensor_msgs/CameraInfo", [](const BagTopic& t) { return t.type == kInfoType; });
      } else if (key == "poses") {
        choice.poses = require(topic, "poses", is_poses);
        choice.has_named_poses = true;
      } else if (key == "gps") {
        choice.gps = require(topic, kFixType, [](const BagTopic& t) { return t.type == kFixType; });
      } else {
        throw UsageError(fmt::format(
            "--topic {}: expected image=TOPIC, points=TOPIC, depth=TOPIC, info=TOPIC, poses=TOPIC or gps=TOPIC", text));
      }
    }
    if (images.empty()) images = guess_images(&TopicChooser::is_color);
    if (images.empty()) images = guess_images(&TopicChooser::is_gray);
    if (images.empty()) fail("no topic of images" + explain_unread());
    for (const BagTopic* topic : images)
      choice.cameras.push_back({make_camera_name(find_base(*topic)), topic, info ? info : find_info(*topic)});
    make_unique(choice.cameras);
    if (choice.points == nullptr && choice.depth.images == nullptr) choice.points = guess_points();
    if (choice.points == nullptr && choice.depth.images == nullptr) choice.depth.images = guess_depth(choice.cameras);
    if (choice.points == nullptr && choice.depth.images == nullptr)
      fail("no topic of sensor_msgs/PointCloud2 and none of depth images" + explain_unread());
    if (choice.depth.images != nullptr) choice.depth.name = "depth", choice.depth.info = find_info(*choice.depth.images);
    if (choice.poses == nullptr) choice.poses = guess_poses();
    if (choice.gps == nullptr) choice.gps = find_most_messages(kFixType);
    return choice;
  }

 private:
  template <class Fits>
  const BagTopic* require(const std::string& name, const char* what, const Fits& fits) const {
    for (const BagTopic& topic : bag_.topics)
      if (topic.name == name) {
        if (!fits(topic)) fail(fmt::format("topic {} of {}, which holds no {}", name, topic.type, what));
        if (topic.encoding == BagEncoding::other || topic.messages.empty())
          fail(fmt::format("topic {} {}", name,
                           topic.messages.empty() ? "without messages" : "in an encoding that is not supported"));
        return &topic;
      }
    fail(fmt::format("no topic {}", name));
  }

  [[noreturn]] void fail(const std::string& what) const {
    std::vector<std::string> topics;
    for (const BagTopic& topic : bag_.topics)
      topics.push_back(fmt::format("{} ({}, {} messages)", topic.name, topic.type, topic.messages.size()));
    throw InputError(path_, "has " + what, fmt::format("it has {}", fmt::join(topics, ", ")));
  }

  // Describes the topics with images or scans that are not used.
  std::string explain_unread() const {
    std::string text;
    for (const BagTopic& topic : bag_.topics) {
      if (topic.messages.empty()) continue;
      for (const UnreadType& unread : kUnreadTypes)
        if (topic.type == unread.type)
          text += fmt::format("; {} holds {}, which is not supported: {}", topic.name, unread.content, unread.remedy);
      if (topic.encoding == BagEncoding::other && (is_images(topic) || is_scans(topic)))
        text += fmt::format("; the messages of {} are neither CDR nor of ROS 1", topic.name);
      else if (is_images(topic) && !is_color(topic))
        text += fmt::format("; {} holds depth by its encoding and name", topic.name);
    }
    return text;
  }

  static bool is_usable(const BagTopic& topic) { return topic.encoding != BagEncoding::other && !topic.messages.empty(); }

  // Lists one topic per camera; raw images take precedence over compressed ones.
  std::vector<const BagTopic*> guess_images(bool (TopicChooser::*fits)(const BagTopic&) const) const {
    std::map<std::string, const BagTopic*> by_base;
    for (const BagTopic& topic : bag_.topics) {
      if (!is_images(topic) || !is_usable(topic) || has_word(topic.name, "depth") || has_word(topic.name, "disparity"))
        continue;
      if (!(this->*fits)(topic)) continue;
      const BagTopic*& known = by_base[find_base(topic)];
      if (known == nullptr || is_compressed(*known)) known = &topic;
    }
    std::vector<const BagTopic*> out;
    for (const auto& [base, topic] : by_base) out.push_back(topic);
    return out;
  }

  // Reads the first image without its pixels. Returns nothing if it cannot be read, which is reported on use.
  std::optional<RosImage> read_first_image(const BagTopic& topic) const {
    try {
      const std::string message = unpack_message(bag_.read(topic.messages.front()));
      RosImage image = parse_image(message, topic.encoding);
      image.data = {};
      return image;
    } catch (const std::invalid_argument&) {
      return std::nullopt;
    }
  }

  bool is_color(const BagTopic& topic) const {
    if (is_compressed(topic)) return !is_compressed_depth(topic);
    const auto image = read_first_image(topic);
    return !image || !is_depth(*image);
  }

  bool is_compressed_depth(const BagTopic& topic) const {
    try {
      return parse_compressed_image(unpack_message(bag_.read(topic.messages.front())), topic.encoding).is_depth();
    } catch (const std::invalid_argument&) {
      return false;
    }
  }

  // Returns whether images are gray of 16 bits, which some depth cameras use for depth.
  bool is_gray(const BagTopic& topic) const {
    const auto image = is_compressed(topic) ? std::nullopt : read_first_image(topic);
    return image && image->encoding == "mono16";
  }

  // Returns the depth topic with the most messages that is not compressed. Registered depth takes precedence over raw depth.
  const BagTopic* guess_depth(const std::vector<BagCamera>& cameras) const {
    const BagTopic* best = nullptr;
    for (const BagTopic& topic : bag_.topics) {
      if (std::any_of(cameras.begin(), cameras.end(), [&](const BagCamera& c) { return c.images == &topic; })) continue;
      if (topic.type != "sensor_msgs/Image" || !is_usable(topic) || is_color(topic)) continue;
      const auto registered = [](const BagTopic& t) { return has_word(t.name, "registered") || has_word(t.name, "aligned"); };
      const auto rank = [&](const BagTopic& t) { return std::pair(registered(t), t.messages.size()); };
      if (best == nullptr || rank(topic) > rank(*best)) best = &topic;
    }
    return best;
  }

  // Returns the calibration in the folder of the images, or in the nearest one above it.
  const BagTopic* find_info(const BagTopic& images) const {
    for (std::string folder = find_folder(find_base(images));; folder = find_folder(folder)) {
      for (const BagTopic& topic : bag_.topics)
        if (topic.type == kInfoType && is_usable(topic) && find_folder(topic.name) == folder) return &topic;
      if (folder.empty()) return nullptr;
    }
  }

  static void make_unique(std::vector<BagCamera>& cameras) {
    std::map<std::string, int> counts;
    for (BagCamera& camera : cameras)
      if (const int count = ++counts[camera.name]; count > 1) camera.name += fmt::format("_{}", count);
  }

  // A map can be a point cloud as well, but the scans have the most messages.
  const BagTopic* guess_points() const {
    const BagTopic* best = nullptr;
    std::pair<bool, double> most;
    for (const BagTopic& topic : bag_.topics) {
      if (!is_scans(topic) || !is_usable(topic)) continue;
      const double bytes =
          static_cast<double>(bag_.read(topic.messages.front()).size()) * static_cast<double>(topic.messages.size());
      const std::pair rank(topic.messages.size() > 1, bytes);
      if (best == nullptr || rank > most) most = rank, best = &topic;
    }
    return best;
  }

  const BagTopic* find_most_messages(const char* type) const {
    const BagTopic* best = nullptr;
    for (const BagTopic& topic : bag_.topics)
      if (topic.type == type && is_usable(topic) && (best == nullptr || topic.messages.size() > best->messages.size()))
        best = &topic;
    return best;
  }

  const BagTopic* guess_poses() const {
    for (const char* type : kPoseTypes)
      if (const BagTopic* best = find_most_messages(type)) return best;
    return nullptr;
  }

  const fs::path& path_;
  const Bag& bag_;
};

}  // namespace

bool is_scans(const BagTopic& topic) { return topic.type == kCloudType || is_livox(topic); }

bool is_livox(const BagTopic& topic) {
  return std::find(std::begin(kLivoxTypes), std::end(kLivoxTypes), topic.type) != std::end(kLivoxTypes);
}
bool is_images(const BagTopic& topic) { return topic.type == "sensor_msgs/Image" || is_compressed(topic); }
bool is_compressed(const BagTopic& topic) {
  return topic.type == "sensor_msgs/CompressedImage" && !has_word(topic.name, "compressedDepth");
}
bool is_tf(const BagTopic& topic) { return topic.type == "tf2_msgs/TFMessage" || topic.type == "tf/tfMessage"; }

BagChoice choose_topics(const fs::path& path, const Bag& bag, const std::vector<std::string>& named) {
  return TopicChooser(path, bag).run(named);
}

double compute_rate_hz(const BagTopic& topic) {
  if (topic.messages.size() < 2) return 0;
  const auto span = static_cast<double>(topic.messages.back().time_ns - topic.messages.front().time_ns);
  return span > 0 ? 1e9 * static_cast<double>(topic.messages.size() - 1) / span : 0;
}

std::vector<RecordedTopic> list_topics(const Bag& bag, const BagChoice& choice) {
  std::vector<RecordedTopic> out;
  for (const BagTopic& topic : bag.topics) {
    RecordedTopic row{topic.name, topic.type, topic.messages.size(), compute_rate_hz(topic), ""};
    for (const BagCamera& camera : choice.cameras) {
      if (camera.images == &topic) row.use = "images of " + camera.name;
      if (camera.info == &topic) row.use = "calibration of " + camera.name;
    }
    if (choice.points == &topic) row.use = "scans";
    if (choice.depth.images == &topic) row.use = "depth images";
    if (choice.depth.info == &topic && row.use.empty()) row.use = "calibration of the depth images";
    if (choice.poses == &topic) row.use = "poses";
    if (choice.gps == &topic) row.use = "position on Earth";
    if (is_tf(topic)) row.use = "poses of the sensors";
    out.push_back(std::move(row));
  }
  return out;
}

}  // namespace dvi::bags
