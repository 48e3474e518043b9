#pragma once

#include <cstdint>
#include <fstream>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "dvi/core/files.h"

namespace dvi::exports {

/// Writes an MCAP file (mcap.dev/spec, version 0) of ROS 2 messages in uncompressed chunks, with an index and a summary at its
/// end for seeking. Holds one chunk in memory. Not thread-safe.
class McapWriter {
 public:
  /// Begins the file; the caller renames it after finish().
  explicit McapWriter(const fs::path& path);

  /// Adds a topic with messages of a ROS 2 type, such as sensor_msgs/msg/CompressedImage, and the text of its definition.
  /// Returns the channel's number. For each type, the first definition is used.
  std::uint16_t add_channel(const std::string& topic, const std::string& type, const std::string& definition);
  /// Writes a message in CDR. Throws InputError on a full disk.
  void write(std::uint16_t channel, std::int64_t time_ns, const std::string& cdr);
  void finish();

 private:
  struct ChunkIndex {
    std::uint64_t first_ns = 0, last_ns = 0, begin = 0, bytes = 0, index_bytes = 0, uncompressed = 0;
    std::map<std::uint16_t, std::uint64_t> index_of_channel;
  };
  using Index = std::vector<std::pair<std::uint64_t, std::uint64_t>>;  // time and offset in the chunk

  void put(const std::string& bytes);
  void end_chunk();
  std::string statistics() const;

  fs::path path_;
  std::ofstream out_;
  std::uint64_t written_ = 0;
  std::string chunk_, definitions_;               // records; the summary repeats schemas and channels
  std::map<std::string, std::uint16_t> schemas_;  // number by type
  std::uint16_t channels_ = 0;
  std::map<std::uint16_t, Index> index_;  // index of the current chunk
  std::map<std::uint16_t, std::uint64_t> messages_;
  std::vector<ChunkIndex> chunks_;
};

}  // namespace dvi::exports
