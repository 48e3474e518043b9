#include <algorithm>
#include <map>
#include <optional>
#include <set>

#include <fmt/format.h>

#include "dvi/bags/bag.h"
#include "dvi/bags/bag_bytes.h"
#include "dvi/bags/mcap_records.h"
#include "dvi/core/error.h"

namespace dvi::bags {
namespace {

struct McapChannel {
  std::uint16_t schema = 0;
  std::string topic, encoding;
};

// Collects channels, chunks and messages from the records of one file.
class McapScan {
 public:
  explicit McapScan(const BagFile& file) : file_(file) {}

  Bag run() {
    if (file_.size() < kMcapMagic.size() || file_.read(0, kMcapMagic.size()) != kMcapMagic)
      throw InputError(file_.path(), "is not an MCAP file", "its first bytes are not those of the format");
    bool complete = false;
    for (std::uint64_t at = kMcapMagic.size(); !complete;) {
      if (at >= file_.size()) file_.fail(at, "the file ends without a footer");
      const McapRecord record = read_mcap_record(file_, at);
      if (record.opcode != message_index_record) finish_chunk();
      take(record);
      complete = record.opcode == footer_record;
      at = record.end();
    }
    find_unknown_channels();
    return make_bag();
  }

 private:
  void take(const McapRecord& record) {
    const auto [opcode, at, length] = record;
    if (opcode == chunk_record) {
      open_chunk_ = at;
      chunks_.push_back(at);
      return;
    }
    if (opcode != schema_record && opcode != channel_record && opcode != message_record && opcode != message_index_record)
      return;
    constexpr std::uint64_t kMessageHeadBytes = 2 + 4 + 8;
    const std::string bytes =
        file_.read(record.content(), opcode == message_record ? std::min(length, kMessageHeadBytes) : length);
    guard(at,
          [&] { take(opcode, bytes, opcode == message_index_record ? open_chunk_.value_or(kNoMcapChunk) : kNoMcapChunk, at); });
  }

  // Handles a record. `chunk` is the chunk that holds or indexes it; `at` is its position there or in the file.
  void take(std::uint8_t opcode, std::string_view bytes, std::uint64_t chunk, std::uint64_t at) {
    ByteCursor cursor(bytes);
    if (opcode == schema_record) {
      const auto id = cursor.take<std::uint16_t>();
      schemas_[id] = cursor.take_sized<std::uint32_t>();
    } else if (opcode == channel_record) {
      const auto id = cursor.take<std::uint16_t>();
      McapChannel channel;
      channel.schema = cursor.take<std::uint16_t>();
      channel.topic = cursor.take_sized<std::uint32_t>();
      channel.encoding = cursor.take_sized<std::uint32_t>();
      channels_[id] = std::move(channel);
    } else if (opcode == message_record) {
      const auto channel = cursor.take<std::uint16_t>();
      cursor.take(4);  // sequence
      messages_[channel].push_back({static_cast<std::int64_t>(cursor.take<std::uint64_t>()), 0, chunk, at});
    } else if (opcode == message_index_record && chunk != kNoMcapChunk) {
      indexed_ = true;
      const auto channel = cursor.take<std::uint16_t>();
      ByteCursor entries(cursor.take_sized<std::uint32_t>());
      while (!entries.empty()) {
        const auto time = static_cast<std::int64_t>(entries.take<std::uint64_t>());
        messages_[channel].push_back({time, 0, chunk, entries.take<std::uint64_t>()});
      }
    }
  }

  // Reads the messages of a chunk that is not followed by an index.
  void finish_chunk() {
    if (open_chunk_ && !indexed_) walk(*open_chunk_, true);
    open_chunk_.reset();
    indexed_ = false;
  }

  void walk(std::uint64_t place, bool with_messages) {
    const std::string chunk = unpack_mcap_chunk(file_, place);
    guard(place, [&] {
      ByteCursor cursor(chunk);
      while (!cursor.empty()) {
        const std::uint64_t at = chunk.size() - cursor.left();
        const auto opcode = cursor.take<std::uint8_t>();
        const std::string_view record = cursor.take_sized<std::uint64_t>();
        if (opcode == schema_record || opcode == channel_record || (opcode == message_record && with_messages))
          take(opcode, record, place, at);
      }
    });
  }

  // Files without a summary declare their channels in chunks only.
  void find_unknown_channels() {
    const auto unknown = [&](const auto& messages) {
      const auto channel = channels_.find(messages.first);
      return channel == channels_.end() || !schemas_.contains(channel->second.schema);
    };
    for (const std::uint64_t chunk : chunks_)
      if (std::any_of(messages_.begin(), messages_.end(), unknown)) walk(chunk, false);
    for (const auto& [id, list] : messages_)
      if (!channels_.contains(id))
        file_.fail(list.front().chunk, fmt::format("a message is of channel {}, which does not exist", id));
  }

  Bag make_bag() {
    std::map<std::string, BagTopic> topics;
    for (auto& [id, channel] : channels_) {
      BagTopic& topic = topics[channel.topic];
      topic.name = channel.topic;
      topic.type = schemas_[channel.schema];
      topic.encoding = channel.encoding == "cdr"    ? BagEncoding::cdr
                       : channel.encoding == "ros1" ? BagEncoding::ros1
                                                    : BagEncoding::other;
      const std::vector<BagEntry>& list = messages_[id];
      topic.messages.insert(topic.messages.end(), list.begin(), list.end());
    }
    Bag out;
    out.files = {file_.path()};
    for (auto& [name, topic] : topics) out.topics.push_back(std::move(topic));
    const auto chunks =
        std::make_shared<BagChunks>([file = file_](std::uint64_t place) { return unpack_mcap_chunk(file, place); });
    out.read = [file = file_, chunks](const BagEntry& entry) { return read(file, *chunks, entry); };
    return out;
  }

  static std::string read(const BagFile& file, BagChunks& chunks, const BagEntry& entry) {
    const auto data_of = [](std::string_view record) {
      ByteCursor cursor(record);
      cursor.take(1);
      std::string_view message = cursor.take_sized<std::uint64_t>();
      message.remove_prefix(std::min<std::size_t>(kMcapMessageHeadBytes, message.size()));
      return std::string(message);
    };
    if (entry.chunk == kNoMcapChunk) {
      const std::string head = file.read(entry.offset, kMcapHeadBytes);
      ByteCursor cursor(std::string_view(head).substr(1));
      return data_of(file.read(entry.offset, kMcapHeadBytes + cursor.take<std::uint64_t>()));
    }
    const std::shared_ptr<const std::string> chunk = chunks[entry.chunk];
    if (entry.offset >= chunk->size()) file.fail(entry.chunk, "the index of a chunk points beyond its end");
    try {
      return data_of(std::string_view(*chunk).substr(entry.offset));
    } catch (const std::out_of_range&) {
      file.fail(entry.chunk, "a message of the chunk is truncated");
    }
  }

  void guard(std::uint64_t at, const std::function<void()>& parse) const {
    try {
      parse();
    } catch (const std::out_of_range&) {
      file_.fail(at, "a record is truncated");
    }
  }

  const BagFile& file_;
  std::map<std::uint16_t, std::string> schemas_;
  std::map<std::uint16_t, McapChannel> channels_;
  std::map<std::uint16_t, std::vector<BagEntry>> messages_;
  std::vector<std::uint64_t> chunks_;
  std::optional<std::uint64_t> open_chunk_;
  bool indexed_ = false;
};

}  // namespace

Bag open_mcap(const fs::path& path) {
  const BagFile file(path);
  return McapScan(file).run();
}

}  // namespace dvi::bags
