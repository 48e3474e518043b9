#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "dvi/bags/bag_bytes.h"

namespace dvi::bags {

/// The first and last bytes of an MCAP file (https://mcap.dev/spec).
inline constexpr std::string_view kMcapMagic = "\x89MCAP0\r\n";
/// The size of a record's opcode and length.
inline constexpr std::uint64_t kMcapHeadBytes = 9;
/// The size of the fields of a message before its data: channel, sequence, log time, and publish time.
inline constexpr std::uint64_t kMcapMessageHeadBytes = 2 + 4 + 8 + 8;
/// The position of the chunk of a message that is not in a chunk: that of the magic.
inline constexpr std::uint64_t kNoMcapChunk = 0;

/// The opcodes of the records that are read or changed.
enum McapOpcode : std::uint8_t {
  footer_record = 2,
  schema_record = 3,
  channel_record = 4,
  message_record = 5,
  chunk_record = 6,
  message_index_record = 7,
  chunk_index_record = 8,
  attachment_record = 9,
  attachment_index_record = 10,
  metadata_record = 12,
  metadata_index_record = 13,
  summary_offset_record = 14,
  data_end_record = 15
};

/// The position of a record in its file.
struct McapRecord {
  std::uint8_t opcode = 0;
  std::uint64_t at = 0, length = 0;  ///< `length` is that of its content

  std::uint64_t content() const { return at + kMcapHeadBytes; }
  std::uint64_t end() const { return content() + length; }
};

/// Reads the head of the record at a byte. Throws InputError if the file ends within the record.
McapRecord read_mcap_record(const BagFile& file, std::uint64_t at);

/// The head of a chunk.
struct McapChunk {
  std::string compression;
  std::uint64_t size = 0, unpacked_size = 0, at = 0;  ///< of its records; `at` is where they begin in the file
  std::uint32_t checksum = 0;                         ///< of the decompressed records; 0: there is none
};

/// Reads the head of the chunk whose record begins at a byte. Throws std::out_of_range if it is truncated.
McapChunk read_mcap_chunk(const BagFile& file, std::uint64_t record);

/// Reads and decompresses the records of a chunk. Throws InputError if it is damaged.
std::string unpack_mcap_chunk(const BagFile& file, std::uint64_t record);

}  // namespace dvi::bags
