#include "dvi/bags/bag.h"

#include <algorithm>
#include <map>

#include "dvi/bags/bag_metadata.h"
#include "dvi/core/error.h"
#include "dvi/core/text.h"

namespace dvi::bags {
namespace {

Bag open_part(const fs::path& file) {
  const std::string ending = to_lower_case(file.extension().string());
  return ending == ".mcap" ? open_mcap(file) : ending == ".db3" ? open_db3(file) : open_ros1_bag(file);
}

// Converts "sensor_msgs/msg/Image" of ROS 2 to "sensor_msgs/Image" of ROS 1.
std::string to_plain_type(std::string type) {
  if (const std::size_t at = type.find("/msg/"); at != std::string::npos) type.erase(at, 4);
  return type;
}

}  // namespace

bool is_bag(const fs::path& path) {
  if (fs::is_regular_file(path)) return has_bag_ending(path);
  return fs::is_directory(path) && (has_bag_metadata(path) || !list_files(path, {".mcap", ".db3", ".bag"}).empty());
}

Bag open_bag(const fs::path& path) {
  const BagParts parts = find_bag_parts(path);
  Bag out;
  out.missing = parts.missing, out.counts = parts.counts, out.warnings = parts.warnings;
  std::vector<std::function<std::string(const BagEntry&)>> readers;
  std::map<std::string, BagTopic> topics;
  for (const fs::path& file : parts.files) {
    Bag part = open_part(file);
    for (BagTopic& topic : part.topics) {
      BagTopic& joined =
          topics.try_emplace(topic.name, BagTopic{topic.name, to_plain_type(topic.type), topic.encoding}).first->second;
      for (BagEntry& entry : topic.messages) {
        entry.file = readers.size();
        joined.messages.push_back(entry);
      }
    }
    out.files.push_back(file);
    readers.push_back(std::move(part.read));
  }
  std::size_t count = 0;
  for (auto& [name, topic] : topics) {
    std::stable_sort(topic.messages.begin(), topic.messages.end(),
                     [](const BagEntry& a, const BagEntry& b) { return a.time_ns < b.time_ns; });
    count += topic.messages.size();
    out.topics.push_back(std::move(topic));
  }
  if (count == 0) throw InputError(path, "holds no messages", "record it again");
  out.read = [readers](const BagEntry& entry) { return readers[entry.file](entry); };
  return out;
}

}  // namespace dvi::bags
