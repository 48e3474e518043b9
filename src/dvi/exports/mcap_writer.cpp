#include "dvi/exports/mcap_writer.h"

#include <libdeflate.h>
#include <algorithm>
#include <bit>
#include <ios>
#include <limits>

#include <fmt/format.h>

#include "dvi/core/error.h"
#include "dvi/core/version.h"

namespace dvi::exports {
namespace {

static_assert(std::endian::native == std::endian::little, "numbers are written as they lie in memory");

const std::string kMagic("\x89MCAP0\r\n", 8);
constexpr std::size_t kChunkBytes = std::size_t{4} << 20;

// The opcodes of records.
enum class Record : char {
  header = 1,
  footer,
  schema,
  channel,
  message,
  chunk,
  message_index,
  chunk_index,
  statistics = 0x0B,
  summary_offset = 0x0E,
  data_end
};

/// The fields of a record in order.
class Fields {
 public:
  template <class T>
  Fields& number(T value) {
    bytes_.append(reinterpret_cast<const char*>(&value), sizeof value);
    return *this;
  }
  Fields& text(const std::string& value) {
    number(static_cast<std::uint32_t>(value.size()));
    bytes_ += value;
    return *this;
  }
  template <class A, class B>
  Fields& pairs(const std::vector<std::pair<A, B>>& values) {
    number(static_cast<std::uint32_t>(values.size() * (sizeof(A) + sizeof(B))));
    for (const auto& [a, b] : values) number(a).number(b);
    return *this;
  }
  template <class A, class B>
  Fields& pairs(const std::map<A, B>& values) {
    return pairs(std::vector<std::pair<A, B>>(values.begin(), values.end()));
  }
  const std::string& bytes() const { return bytes_; }

 private:
  std::string bytes_;
};

std::string record(Record kind, const std::string& content) {
  return std::string(1, static_cast<char>(kind)) + Fields().number(std::uint64_t{content.size()}).bytes() + content;
}
std::string record(Record kind, const Fields& fields) { return record(kind, fields.bytes()); }

}  // namespace

McapWriter::McapWriter(const fs::path& path) : path_(path), out_(path, std::ios::binary) {
  put(kMagic + record(Record::header, Fields().text("ros2").text(fmt::format("dvi {}", kVersion))));
}

void McapWriter::put(const std::string& bytes) {
  if (!out_.write(bytes.data(), static_cast<std::streamsize>(bytes.size())))
    throw InputError(path_, "cannot be written", "free space or choose another folder");
  written_ += bytes.size();
}

std::uint16_t McapWriter::add_channel(const std::string& topic, const std::string& type, const std::string& definition) {
  const auto number = static_cast<std::uint16_t>(schemas_.size() + 1);
  const auto [schema, is_new] = schemas_.try_emplace(type, number);
  if (is_new) definitions_ += record(Record::schema, Fields().number(number).text(type).text("ros2msg").text(definition));
  ++channels_;
  definitions_ += record(Record::channel, Fields().number(channels_).number(schema->second).text(topic).text("cdr").text(""));
  return channels_;
}

void McapWriter::write(std::uint16_t channel, std::int64_t time_ns, const std::string& cdr) {
  const auto time = static_cast<std::uint64_t>(std::max<std::int64_t>(time_ns, 0));
  if (chunk_.empty() && chunks_.empty()) chunk_ = definitions_;
  index_[channel].emplace_back(time, chunk_.size());
  const auto sequence = static_cast<std::uint32_t>(messages_[channel]++);
  chunk_ += record(Record::message, Fields().number(channel).number(sequence).number(time).number(time).bytes() + cdr);
  if (chunk_.size() >= kChunkBytes) end_chunk();
}

void McapWriter::end_chunk() {
  if (chunk_.empty()) return;
  ChunkIndex entry;
  entry.begin = written_;
  entry.uncompressed = chunk_.size();
  entry.first_ns = std::numeric_limits<std::uint64_t>::max();
  for (auto& [channel, messages] : index_)
    for (const auto& [time, offset] : messages) {
      entry.first_ns = std::min(entry.first_ns, time);
      entry.last_ns = std::max(entry.last_ns, time);
    }
  put(record(Record::chunk, Fields().number(entry.first_ns)
                                    .number(entry.last_ns)
                                    .number(entry.uncompressed)
                                    .number(libdeflate_crc32(0, chunk_.data(), chunk_.size()))
                                    .text("")
                                    .number(entry.uncompressed)
                                    .bytes() +
                                chunk_));
  entry.bytes = written_ - entry.begin;
  for (auto& [channel, messages] : index_) {
    std::stable_sort(messages.begin(), messages.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
    entry.index_of_channel[channel] = written_;
    put(record(Record::message_index, Fields().number(channel).pairs(messages)));
  }
  entry.index_bytes = written_ - entry.begin - entry.bytes;
  chunks_.push_back(entry);
  chunk_.clear();
  index_.clear();
}

std::string McapWriter::statistics() const {
  std::uint64_t messages = 0, first = chunks_.empty() ? 0 : chunks_.front().first_ns, last = 0;
  for (const auto& [channel, count] : messages_) messages += count;
  for (const ChunkIndex& chunk : chunks_) first = std::min(first, chunk.first_ns), last = std::max(last, chunk.last_ns);
  return record(Record::statistics, Fields()
                                        .number(messages)
                                        .number(static_cast<std::uint16_t>(schemas_.size()))
                                        .number(std::uint32_t{channels_})
                                        .number(std::uint32_t{0})  // attachments
                                        .number(std::uint32_t{0})  // metadata
                                        .number(static_cast<std::uint32_t>(chunks_.size()))
                                        .number(first)
                                        .number(last)
                                        .pairs(messages_));
}

void McapWriter::finish() {
  end_chunk();
  put(record(Record::data_end, Fields().number(std::uint32_t{0})));  // 0: no checksum of all data, since each chunk has its own
  const std::uint64_t summary = written_;
  put(definitions_);
  put(statistics());
  const std::uint64_t chunk_indices = written_;
  for (const ChunkIndex& c : chunks_)
    put(record(Record::chunk_index, Fields()
                                        .number(c.first_ns)
                                        .number(c.last_ns)
                                        .number(c.begin)
                                        .number(c.bytes)
                                        .pairs(c.index_of_channel)
                                        .number(c.index_bytes)
                                        .text("")
                                        .number(c.uncompressed)
                                        .number(c.uncompressed)));
  const std::uint64_t offsets = written_;
  if (!chunks_.empty())
    put(record(Record::summary_offset,
               Fields().number(static_cast<char>(Record::chunk_index)).number(chunk_indices).number(offsets - chunk_indices)));
  put(record(Record::footer, Fields().number(summary).number(offsets).number(std::uint32_t{0})) + kMagic);
  out_.close();
  if (!out_) throw InputError(path_, "cannot be written", "free space or choose another folder");
}

}  // namespace dvi::exports
