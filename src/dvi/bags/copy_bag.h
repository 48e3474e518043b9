#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <string>
#include <string_view>

#include "dvi/core/files.h"

namespace dvi::bags {

/// The messages of one file of a bag that get other bytes.
struct ReplacedMessages {
  /// The number that `replace` gets, by BagEntry::chunk and BagEntry::offset.
  std::map<std::uint64_t, std::map<std::uint64_t, std::size_t>> numbers;
  /// Returns the new bytes of a message. It is called once per message, in the order of the file.
  std::function<std::string(std::size_t number, std::string_view message)> replace;
};

/// Copies one file of a bag (.mcap, .bag or .db3) to another file in the same format and replaces some messages. All other
/// messages, their order and times, and all records about channels, schemas, connections, attachments and metadata keep their
/// bytes. Chunks without replaced messages are copied as they are; others are compressed again in the same format. Indices and
/// checksums are adapted. Holds one chunk in memory. Throws InputError if the file is damaged or the disk is full.
void copy_bag_file(const fs::path& from, const fs::path& to, const ReplacedMessages& replaced);

/// Copy a file of each format.
void copy_mcap(const fs::path& from, const fs::path& to, const ReplacedMessages& replaced);
void copy_ros1_bag(const fs::path& from, const fs::path& to, const ReplacedMessages& replaced);
void copy_db3(const fs::path& from, const fs::path& to, const ReplacedMessages& replaced);

}  // namespace dvi::bags
