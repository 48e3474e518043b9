#include "dvi/bags/mcap_records.h"

#include <algorithm>
#include <exception>

#include <fmt/format.h>

#include "dvi/core/error.h"

namespace dvi::bags {

McapRecord read_mcap_record(const BagFile& file, std::uint64_t at) {
  const std::string bytes = file.read(at, kMcapHeadBytes);
  ByteCursor cursor(bytes);
  McapRecord record{.opcode = cursor.take<std::uint8_t>(), .at = at, .length = cursor.take<std::uint64_t>()};
  if (record.length > file.size() - record.content()) file.fail(at, "the file ends within a record");
  return record;
}

McapChunk read_mcap_chunk(const BagFile& file, std::uint64_t record) {
  constexpr std::uint64_t kMaxHeadBytes = 8 + 8 + 8 + 4 + 4 + 64 + 8;  // the name of the compression may have 64 bytes
  const std::uint64_t begin = record + kMcapHeadBytes;
  const std::string bytes = file.read(begin, std::min(kMaxHeadBytes, file.size() - begin));
  ByteCursor cursor(bytes);
  cursor.take(16);  // first and last time
  McapChunk chunk;
  chunk.unpacked_size = cursor.take<std::uint64_t>();
  chunk.checksum = cursor.take<std::uint32_t>();
  chunk.compression = cursor.take_sized<std::uint32_t>();
  chunk.size = cursor.take<std::uint64_t>();
  chunk.at = begin + bytes.size() - cursor.left();
  return chunk;
}

std::string unpack_mcap_chunk(const BagFile& file, std::uint64_t record) {
  try {
    const McapChunk chunk = read_mcap_chunk(file, record);
    return unpack(chunk.compression, file.read(chunk.at, chunk.size), chunk.unpacked_size);
  } catch (const InputError&) {
    throw;
  } catch (const std::exception& e) {
    file.fail(record, fmt::format("a chunk cannot be unpacked: {}", e.what()));
  }
}

}  // namespace dvi::bags
