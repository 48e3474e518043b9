#pragma once

#include <optional>
#include <string>
#include <vector>

#include "dvi/bags/bag.h"
#include "dvi/drive/drive.h"

namespace dvi::bags {

/// A camera of a bag: a topic of images, and the one that tells its calibration.
struct BagCamera {
  std::string name;  ///< "cam0" of /cam0/image_raw
  const BagTopic* images = nullptr;
  const BagTopic* info = nullptr;  ///< none: there is none
};

/// What of a bag is used.
struct BagChoice {
  std::vector<BagCamera> cameras;
  const BagTopic* points = nullptr;  ///< none: there are depth images
  BagCamera depth = {};              ///< depth images instead of points; without a topic: there are none
  const BagTopic* poses = nullptr;   ///< Odometry or stamped poses; none: tf, if it tells motion
  bool named_poses = false;          ///< that the user named
  const BagTopic* gps = nullptr;     ///< NavSatFix; none: there is none
};

/// Types that are read.
bool is_livox(const BagTopic& topic);
bool is_images(const BagTopic& topic);
bool is_compressed(const BagTopic& topic);
bool is_tf(const BagTopic& topic);

/// Chooses topics: all color cameras, the LiDAR with the most points, Odometry before poses. `named`: "image=/a" any number of
/// times, "points=/b", "depth=/e" (instead of points), "info=/c" (of the only camera), "poses=/d", "gps=/f". UsageError where
/// one is of another form; InputError where the topic is not there or of another type, and where there are no images or points,
/// with the topics that there are.
BagChoice choose_topics(const fs::path& path, const Bag& bag, const std::vector<std::string>& named);

/// All topics with what they are taken for.
std::vector<RecordedTopic> list_topics(const Bag& bag, const BagChoice& choice);

/// Messages a second by when they were recorded.
double rate_of(const BagTopic& topic);

}  // namespace dvi::bags
