#include <libdeflate.h>
#include <algorithm>
#include <array>
#include <map>
#include <optional>
#include <stdexcept>

#include <fmt/format.h>

#include "dvi/bags/changed_copy.h"
#include "dvi/bags/copy_bag.h"
#include "dvi/bags/mcap_records.h"

namespace dvi::bags {
namespace {

std::string make_record(std::uint8_t opcode, const std::string& content) {
  return to_bytes(opcode) + to_bytes(std::uint64_t{content.size()}) + content;
}

// The checksum of the data section. Writers begin it at the file, after the magic, or after the header, so that all three are
// computed, of the original and of the copy.
class DataChecksum {
 public:
  void begin() { sums_.push_back({}); }
  void add(std::string_view original, std::string_view copy) {
    for (Sums& sums : sums_) {
      sums.original = libdeflate_crc32(sums.original, original.data(), original.size());
      sums.copy = libdeflate_crc32(sums.copy, copy.data(), copy.size());
    }
  }
  // Returns the checksum of the copy that corresponds to one of the original; 0, which means that there is none, if that one
  // is not correct.
  std::uint32_t of_copy(std::uint32_t original) const {
    const auto found =
        std::find_if(sums_.begin(), sums_.end(), [&](const Sums& sums) { return original != 0 && sums.original == original; });
    return found == sums_.end() ? 0 : found->copy;
  }

 private:
  struct Sums {
    std::uint32_t original = 0, copy = 0;
  };
  std::vector<Sums> sums_;
};

class McapCopy {
 public:
  McapCopy(const BagFile& from, const fs::path& to, const ReplacedMessages& replaced)
      : from_(from), replaced_(replaced), copy_(from, to) {
    copy_.watch = [this](std::string_view original, std::string_view bytes) {
      checksum_.add(original, bytes);
      summary_sum_ = libdeflate_crc32(summary_sum_, bytes.data(), bytes.size());
    };
  }

  void run() {
    checksum_.begin();
    copy_.keep(0, kMcapMagic.size());
    checksum_.begin();
    std::uint64_t at = kMcapMagic.size();
    for (bool complete = false; !complete;) {
      const McapRecord record = read_mcap_record(from_, at);
      try {
        copy_record(record);
      } catch (const std::out_of_range&) {
        from_.fail(at, "a record is truncated");
      } catch (const std::invalid_argument& e) {
        from_.fail(at, fmt::format("a chunk cannot be packed: {}", e.what()));
      }
      if (at == kMcapMagic.size()) checksum_.begin();
      complete = record.opcode == footer_record;
      at = record.end();
    }
    copy_.keep(at, from_.size() - at);
    copy_.finish();
  }

 private:
  // The new position of a record, and the change of a chunk's sizes.
  struct Moved {
    std::uint64_t at = 0;
    std::uint64_t growth = 0;                                           // growth of the record, modulo 2^64
    std::optional<std::pair<std::uint64_t, std::uint64_t>> sizes = {};  // compressed and decompressed, of a changed chunk
  };

  void copy_record(const McapRecord& record) {
    if (record.opcode != message_index_record) offsets_.clear();
    switch (record.opcode) {
      case chunk_record:
        return copy_chunk(record);
      case message_record:
        return copy_message(record);
      case message_index_record:
        return copy_message_index(record);
      case attachment_record:
      case metadata_record:
        moved_[record.at] = {copy_.size()};
        return keep(record);
      case data_end_record:
        return copy_data_end(record);
      case chunk_index_record:
        return copy_chunk_index(record);
      case attachment_index_record:
      case metadata_index_record:
        return copy_index(record);
      case summary_offset_record:
        return copy_summary_offset(record);
      case footer_record:
        return copy_footer(record);
      default:
        return keep(record);
    }
  }

  void keep(const McapRecord& record) { copy_.keep(record.at, record.end() - record.at); }
  std::string read(const McapRecord& record) const { return from_.read(record.at, record.end() - record.at); }
  void replace(const McapRecord& record, const std::string& content) {
    copy_.replace(read(record), make_record(record.opcode, content));
  }

  // Returns the content of a message with new data.
  std::string replace_data(std::size_t number, std::string_view content) const {
    if (content.size() < kMcapMessageHeadBytes) throw std::out_of_range("a message is truncated");
    return std::string(content.substr(0, kMcapMessageHeadBytes)) +
           replaced_.replace(number, content.substr(kMcapMessageHeadBytes));
  }

  const std::map<std::uint64_t, std::size_t>* find_replaced(std::uint64_t chunk) const {
    const auto found = replaced_.numbers.find(chunk);
    return found == replaced_.numbers.end() ? nullptr : &found->second;
  }

  void copy_message(const McapRecord& record) {
    const auto* const numbers = find_replaced(kNoMcapChunk);
    if (numbers == nullptr || !numbers->contains(record.at)) return keep(record);
    replace(record, replace_data(numbers->at(record.at), std::string_view(read(record)).substr(kMcapHeadBytes)));
  }

  void copy_chunk(const McapRecord& record) {
    Moved& moved = moved_[record.at];
    moved.at = copy_.size();
    const auto* const numbers = find_replaced(record.at);
    if (numbers == nullptr) return keep(record);
    const std::string packed = unpack_mcap_chunk(from_, record.at), records = replace_messages(packed, *numbers);
    if (records == packed) {
      offsets_.clear();
      return keep(record);
    }
    const McapChunk chunk = read_mcap_chunk(from_, record.at);
    const std::string repacked = pack(chunk.compression, records, from_.read(chunk.at, chunk.size));
    const std::uint32_t checksum = chunk.checksum == 0 ? 0 : libdeflate_crc32(0, records.data(), records.size());
    constexpr std::uint64_t kTimesBytes = 16;
    const std::uint64_t end = chunk.at + chunk.size;
    replace(record, from_.read(record.content(), kTimesBytes) + to_bytes(std::uint64_t{records.size()}) + to_bytes(checksum) +
                        with_size(chunk.compression) + to_bytes(std::uint64_t{repacked.size()}) + repacked +
                        from_.read(end, record.end() - end));
    moved.growth = repacked.size() - chunk.size;
    moved.sizes = {repacked.size(), records.size()};
  }

  // Returns the records of a chunk with replaced messages, and maps their offsets.
  std::string replace_messages(const std::string& chunk, const std::map<std::uint64_t, std::size_t>& numbers) {
    std::string out;
    ByteCursor cursor(chunk);
    while (!cursor.empty()) {
      const std::uint64_t at = chunk.size() - cursor.left();
      offsets_[at] = out.size();
      const auto opcode = cursor.take<std::uint8_t>();
      const std::string_view content = cursor.take_sized<std::uint64_t>();
      const auto number = numbers.find(at);
      if (opcode == message_record && number != numbers.end())
        out += make_record(opcode, replace_data(number->second, content));
      else
        out += chunk.substr(at, kMcapHeadBytes + content.size());
    }
    return out;
  }

  void copy_message_index(const McapRecord& record) {
    if (offsets_.empty()) return keep(record);
    const std::string bytes = read(record);
    ByteCursor cursor(bytes);
    cursor.take(kMcapHeadBytes);
    std::string content(cursor.take(sizeof(std::uint16_t))), list;
    ByteCursor entries(cursor.take_sized<std::uint32_t>());
    while (!entries.empty()) {
      list += entries.take(sizeof(std::int64_t));
      const auto offset = offsets_.find(entries.take<std::uint64_t>());
      if (offset == offsets_.end()) from_.fail(record.at, "the index of a chunk does not refer to a record");
      list += to_bytes(offset->second);
    }
    replace(record, content + with_size(list) + std::string(cursor.take(cursor.left())));
  }

  void copy_data_end(const McapRecord& record) {
    const std::string bytes = read(record);
    ByteCursor cursor(std::string_view(bytes).substr(kMcapHeadBytes));
    const std::uint32_t checksum = checksum_.of_copy(cursor.take<std::uint32_t>());
    replace(record, to_bytes(checksum) + std::string(cursor.take(cursor.left())));
    summary_sum_ = 0;
    shift_ = copy_.size() - record.end();
  }

  const Moved& find_moved(const McapRecord& index, std::uint64_t at) const {
    const auto found = moved_.find(at);
    if (found == moved_.end()) from_.fail(index.at, "the index does not refer to a record");
    return found->second;
  }

  void copy_chunk_index(const McapRecord& record) {
    const std::string bytes = read(record);
    ByteCursor cursor(std::string_view(bytes).substr(kMcapHeadBytes));
    std::string content(cursor.take(16));  // first and last time
    const auto at = cursor.take<std::uint64_t>(), length = cursor.take<std::uint64_t>();
    const Moved& moved = find_moved(record, at);
    const std::uint64_t index_shift = moved.at + moved.growth - at;
    content += to_bytes(moved.at) + to_bytes(length + moved.growth);
    std::string map;
    ByteCursor entries(cursor.take_sized<std::uint32_t>());
    while (!entries.empty()) {
      map += entries.take(sizeof(std::uint16_t));
      map += to_bytes(entries.take<std::uint64_t>() + index_shift);
    }
    content += with_size(map);
    content += cursor.take(sizeof(std::uint64_t));  // length of the message indices
    content += with_size(cursor.take_sized<std::uint32_t>());
    const auto packed = cursor.take<std::uint64_t>(), unpacked = cursor.take<std::uint64_t>();
    const auto [new_packed, new_unpacked] = moved.sizes.value_or(std::pair{packed, unpacked});
    content += to_bytes(new_packed) + to_bytes(new_unpacked) + std::string(cursor.take(cursor.left()));
    replace(record, content);
  }

  // The index of an attachment or metadata begins with its position.
  void copy_index(const McapRecord& record) {
    const std::string bytes = read(record);
    ByteCursor cursor(std::string_view(bytes).substr(kMcapHeadBytes));
    const Moved& moved = find_moved(record, cursor.take<std::uint64_t>());
    replace(record, to_bytes(moved.at) + std::string(cursor.take(cursor.left())));
  }

  // The records of the summary keep their sizes, so that all move by the same distance.
  void copy_summary_offset(const McapRecord& record) {
    const std::string bytes = read(record);
    ByteCursor cursor(std::string_view(bytes).substr(kMcapHeadBytes));
    std::string content(cursor.take(1));
    content += to_bytes(cursor.take<std::uint64_t>() + shift_);
    replace(record, content + std::string(cursor.take(cursor.left())));
  }

  void copy_footer(const McapRecord& record) {
    const std::string bytes = read(record);
    ByteCursor cursor(std::string_view(bytes).substr(kMcapHeadBytes));
    const auto move = [&](std::uint64_t at) { return at == 0 ? 0 : at + shift_; };
    const auto summary = cursor.take<std::uint64_t>(), offsets = cursor.take<std::uint64_t>();
    const auto checksum = cursor.take<std::uint32_t>();
    const std::string rest(cursor.take(cursor.left()));
    std::string positions = to_bytes(move(summary)) + to_bytes(move(offsets));
    const std::string summed = bytes.substr(0, kMcapHeadBytes) + positions;  // the checksum includes this part of the footer
    const std::uint32_t sum = libdeflate_crc32(summary_sum_, summed.data(), summed.size());
    replace(record, positions + to_bytes(checksum == 0 ? 0U : sum) + rest);
  }

  const BagFile& from_;
  const ReplacedMessages& replaced_;
  ChangedCopy copy_;
  DataChecksum checksum_;
  std::map<std::uint64_t, Moved> moved_;            // chunks, attachments, and metadata, by their old position
  std::map<std::uint64_t, std::uint64_t> offsets_;  // in the last chunk, new by old; empty if it did not change
  std::uint32_t summary_sum_ = 0;
  std::uint64_t shift_ = 0;  // distance by which the summary moves, modulo 2^64
};

}  // namespace

void copy_mcap(const fs::path& from, const fs::path& to, const ReplacedMessages& replaced) {
  const BagFile file(from);
  McapCopy(file, to, replaced).run();
}

}  // namespace dvi::bags
