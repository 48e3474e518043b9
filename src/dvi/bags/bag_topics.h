#pragma once

#include <optional>
#include <string>
#include <vector>

#include "dvi/bags/bag.h"
#include "dvi/drive/drive.h"

namespace dvi::bags {

/// A camera of a bag: a topic of images and the topic of its calibration.
struct BagCamera {
  std::string name;  ///< "cam0" of /cam0/image_raw
  const BagTopic* images = nullptr;
  const BagTopic* info = nullptr;  ///< none: there is no calibration
};

/// The topics of a bag that are used.
struct BagChoice {
  std::vector<BagCamera> cameras;
  const BagTopic* points = nullptr;  ///< none: depth images are used instead
  BagCamera depth = {};              ///< depth images instead of points; without a topic if there are none
  const BagTopic* poses = nullptr;   ///< Odometry or stamped poses; none: tf is used if it has motion
  bool has_named_poses = false;      ///< whether the user selected `poses`
  const BagTopic* gps = nullptr;     ///< NavSatFix; none: there is no such topic
};

/// Return whether a topic has a supported type.
bool is_livox(const BagTopic& topic);
bool is_scans(const BagTopic& topic);  ///< also those of Livox
bool is_images(const BagTopic& topic);
bool is_compressed(const BagTopic& topic);
bool is_tf(const BagTopic& topic);

/// Chooses topics: all color cameras, the LiDAR with the most points, and Odometry before poses. `named` selects topics:
/// "image=/a" any number of times, "points=/b", "depth=/e" (instead of points), "info=/c" (of the only camera), "poses=/d",
/// "gps=/f". Throws UsageError if an entry is malformed. Throws InputError with the existing topics if a topic is missing or of
/// another type, or if there are no images or points.
BagChoice choose_topics(const fs::path& path, const Bag& bag, const std::vector<std::string>& named);

/// Lists all topics with their use.
std::vector<RecordedTopic> list_topics(const Bag& bag, const BagChoice& choice);

/// Returns the rate of a topic in messages per second, by the times of recording.
double compute_rate_hz(const BagTopic& topic);

}  // namespace dvi::bags
