#pragma once

#include <cstdint>
#include <fstream>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "dvi/core/files.h"

namespace dvi::exports {

/// Writes an MCAP file (mcap.dev/spec, version 0) of ROS 2 messages, in chunks that are not compressed, with an index and a
/// summary at its end, so that readers can seek. Holds one chunk in memory. Not synchronized.
class McapWriter {
 public:
  /// Where the file is made; the caller renames it once finish() is done.
  explicit McapWriter(const fs::path& path);

  /// A topic with messages of a ROS 2 type, such as sensor_msgs/msg/CompressedImage, and the text of its definition. Returns
  /// its number. Of one type the first definition counts.
  std::uint16_t add_channel(const std::string& topic, const std::string& type, const std::string& definition);
  /// A message in CDR. InputError on a full disk.
  void write(std::uint16_t channel, std::int64_t time_ns, const std::string& cdr);
  void finish();

 private:
  struct ChunkIndex {
    std::uint64_t first_ns = 0, last_ns = 0, begin = 0, bytes = 0, index_bytes = 0, uncompressed = 0;
    std::map<std::uint16_t, std::uint64_t> index_of_channel;
  };
  using Index = std::vector<std::pair<std::uint64_t, std::uint64_t>>;  // time, offset in the chunk

  void put(const std::string& bytes);
  void end_chunk();
  std::string statistics() const;

  fs::path path_;
  std::ofstream out_;
  std::uint64_t written_ = 0;
  std::string chunk_, definitions_;               // records; schemas and channels are repeated in the summary
  std::map<std::string, std::uint16_t> schemas_;  // by type
  std::uint16_t channels_ = 0;
  std::map<std::uint16_t, Index> index_;  // of the chunk
  std::map<std::uint16_t, std::uint64_t> messages_;
  std::vector<ChunkIndex> chunks_;
};

}  // namespace dvi::exports
