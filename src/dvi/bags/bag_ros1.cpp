#include <map>
#include <optional>

#include <fmt/format.h>

#include "dvi/bags/bag.h"
#include "dvi/bags/bag_bytes.h"
#include "dvi/bags/ros1_records.h"
#include "dvi/core/error.h"

namespace dvi::bags {
namespace {

class Ros1Scan {
 public:
  explicit Ros1Scan(const BagFile& file) : file_(file) {}

  Bag run() {
    if (file_.size() < kRos1Magic.size() || file_.read(0, kRos1Magic.size()) != kRos1Magic)
      throw InputError(file_.path(), "is not a ROS 1 bag of version 2.0", "its first line is not #ROSBAG V2.0");
    std::optional<std::uint64_t> chunk;  // whose index has not been read yet
    for (std::uint64_t at = kRos1Magic.size(); at < file_.size();) {
      const Ros1Record record = read_ros1_record(file_, at);
      guard(at, [&] {
        const auto op = record.fields.number<std::uint8_t>("op");
        if (chunk && op != index_data_op) walk(*chunk);
        if (op == index_data_op && chunk_of_index_) index(record);
        if (op != index_data_op) chunk_of_index_.reset();
        chunk.reset();
        if (op == connection_op) connect(record.fields, file_.read(record.data, record.length));
        if (op == chunk_op) chunk = chunk_of_index_ = at;
      });
      at = record.end();
    }
    if (chunk) guard(*chunk, [&] { walk(*chunk); });
    return make_bag();
  }

 private:
  void connect(const Ros1Fields& fields, const std::string& data) {
    const auto id = fields.number<std::uint32_t>("conn");
    BagTopic& topic = topics_[id];
    topic.name = fields.text("topic");
    topic.type = Ros1Fields(data).text("type");
    topic.encoding = BagEncoding::ros1;
  }

  void index(const Ros1Record& record) {
    const std::string bytes = file_.read(record.data, record.length);
    ByteCursor cursor(bytes);
    std::vector<BagEntry>& messages = topics_[record.fields.number<std::uint32_t>("conn")].messages;
    while (!cursor.empty()) {
      const std::int64_t seconds = cursor.take<std::uint32_t>(), nanoseconds = cursor.take<std::uint32_t>();
      messages.push_back({seconds * 1'000'000'000 + nanoseconds, 0, *chunk_of_index_, cursor.take<std::uint32_t>()});
    }
  }

  // Reads the messages of a chunk without an index, as left by a killed recorder.
  void walk(std::uint64_t place) {
    const std::string chunk = unpack_ros1_chunk(file_, place);
    ByteCursor cursor(chunk);
    while (!cursor.empty()) {
      const std::uint64_t at = chunk.size() - cursor.left();
      const Ros1Fields fields(cursor.take_sized<std::uint32_t>());
      const std::string_view data = cursor.take_sized<std::uint32_t>();
      const auto op = fields.number<std::uint8_t>("op");
      if (op == connection_op) connect(fields, std::string(data));
      if (op == message_data_op)
        topics_[fields.number<std::uint32_t>("conn")].messages.push_back({fields.time("time"), 0, place, at});
    }
  }

  Bag make_bag() {
    std::map<std::string, BagTopic> by_name;  // each publisher of a topic has a connection of its own
    for (auto& [id, topic] : topics_) {
      if (topic.name.empty())
        file_.fail(file_.size(), fmt::format("messages refer to connection {}, which does not exist", id));
      BagTopic& joined = by_name[topic.name];
      joined.name = topic.name, joined.type = topic.type, joined.encoding = topic.encoding;
      joined.messages.insert(joined.messages.end(), topic.messages.begin(), topic.messages.end());
    }
    Bag out;
    out.files = {file_.path()};
    for (auto& [name, topic] : by_name) out.topics.push_back(std::move(topic));
    const auto chunks =
        std::make_shared<BagChunks>([file = file_](std::uint64_t place) { return unpack_ros1_chunk(file, place); });
    out.read = [file = file_, chunks](const BagEntry& entry) {
      const std::shared_ptr<const std::string> chunk = (*chunks)[entry.chunk];
      try {
        ByteCursor cursor(*chunk);
        cursor.take(entry.offset);
        cursor.take_sized<std::uint32_t>();
        return std::string(cursor.take_sized<std::uint32_t>());
      } catch (const std::out_of_range&) {
        file.fail(entry.chunk, "the index of a chunk points beyond its end");
      }
    };
    return out;
  }

  void guard(std::uint64_t at, const std::function<void()>& parse) const {
    try {
      parse();
    } catch (const std::out_of_range&) {
      file_.fail(at, "a record is damaged");
    }
  }

  const BagFile& file_;
  std::map<std::uint32_t, BagTopic> topics_;
  std::optional<std::uint64_t> chunk_of_index_;
};

}  // namespace

Bag open_ros1_bag(const fs::path& path) {
  const BagFile file(path);
  return Ros1Scan(file).run();
}

}  // namespace dvi::bags
