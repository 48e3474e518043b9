#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "dvi/bags/bag_parts.h"
#include "dvi/core/files.h"

namespace dvi::bags {

/// Where a message stands: in which file of the bag and at which byte; where it is in a chunk, at which byte of that.
struct BagEntry {
  std::int64_t time_ns = 0;  ///< when it was recorded, by the recorder's clock
  std::size_t file = 0;
  std::uint64_t chunk = 0;  ///< the chunk's place in the file; of a database, nothing
  std::uint64_t offset = 0;
};

/// How messages are laid out as bytes. other: by an encoding that is listed but not read.
enum class BagEncoding { cdr, ros1, other };

struct BagTopic {
  std::string name, type;  ///< "/points", "sensor_msgs/PointCloud2": types of ROS 2 without "/msg"
  BagEncoding encoding = BagEncoding::cdr;
  std::vector<BagEntry> messages = {};  ///< in order of time
};

/// A recorded bag: the places of all messages, whose bytes are read on demand, from any thread.
struct Bag {
  std::vector<fs::path> files;
  std::vector<BagTopic> topics;                    ///< by name
  std::vector<MissingPart> missing = {};           ///< of a split recording
  std::map<std::string, std::size_t> counts = {};  ///< messages of each topic in the whole recording; empty where unknown
  std::vector<std::string> warnings = {};
  std::function<std::string(const BagEntry&)> read;
};

/// Whether a path is a bag by its name: a file .mcap, .db3 or .bag, or a folder of such files or of a metadata.yaml of rosbag2.
bool is_bag(const fs::path& path);

/// Opens a bag. The parts of a folder are one recording. InputError, with the byte, where a file is cut or damaged, and where
/// it holds no messages.
Bag open_bag(const fs::path& path);

/// The formats of single files. `topics` need not be sorted, nor their messages.
Bag open_mcap(const fs::path& file);
Bag open_ros1_bag(const fs::path& file);
Bag open_db3(const fs::path& file);

}  // namespace dvi::bags
