#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "dvi/bags/bag_parts.h"
#include "dvi/core/files.h"

namespace dvi::bags {

/// The position of a message: the file of the bag, and the byte in that file or in a chunk of it.
struct BagEntry {
  std::int64_t time_ns = 0;  ///< the time of recording, by the recorder's clock
  std::size_t file = 0;
  std::uint64_t chunk = 0;  ///< the byte at which the chunk begins in the file; unused for databases
  std::uint64_t offset = 0;
};

/// The encoding of messages. `other` means that the topic is listed but cannot be read.
enum class BagEncoding { cdr, ros1, other };

/// A topic and its messages.
struct BagTopic {
  std::string name, type;  ///< "/points", "sensor_msgs/PointCloud2"; types of ROS 2 are without "/msg"
  BagEncoding encoding = BagEncoding::cdr;
  std::vector<BagEntry> messages = {};  ///< in order of time
};

/// A recorded bag: the positions of all messages. Their bytes are read on demand, from any thread.
struct Bag {
  std::vector<fs::path> files;
  std::vector<BagTopic> topics;                    ///< sorted by name
  std::vector<MissingPart> missing = {};           ///< of a split recording
  std::map<std::string, std::size_t> counts = {};  ///< messages of each topic in the whole recording; empty if unknown
  std::vector<std::string> warnings = {};
  std::function<std::string(const BagEntry&)> read;
};

/// Returns whether a path is a bag by its name: a file .mcap, .db3 or .bag, or a folder with such files or a metadata.yaml of
/// rosbag2.
bool is_bag(const fs::path& path);

/// Opens a bag. All parts in a folder are one recording. Throws InputError with the byte if a file is truncated or damaged, or
/// if it holds no messages.
Bag open_bag(const fs::path& path);

/// Open a single file of each format. Neither the topics nor their messages need to be sorted.
Bag open_mcap(const fs::path& file);
Bag open_ros1_bag(const fs::path& file);
Bag open_db3(const fs::path& file);

}  // namespace dvi::bags
