#include <map>
#include <stdexcept>

#include <fmt/format.h>

#include "dvi/bags/changed_copy.h"
#include "dvi/bags/copy_bag.h"
#include "dvi/bags/ros1_records.h"

namespace dvi::bags {
namespace {

class Ros1Copy {
 public:
  Ros1Copy(const BagFile& from, const fs::path& to, const ReplacedMessages& replaced)
      : from_(from), replaced_(replaced), copy_(from, to) {}

  void run() {
    copy_.keep(0, kRos1Magic.size());
    std::uint64_t index = 0;  // the old position of the connections and chunk infos at the end
    for (std::uint64_t at = kRos1Magic.size(); at < from_.size();) {
      const Ros1Record record = read_ros1_record(from_, at);
      try {
        if (index == at) header_ = with_ros1_number(header_, "index_pos", copy_.size());
        const auto op = record.fields.number<std::uint8_t>("op");
        if (op == bag_header_op) index = record.fields.number<std::uint64_t>("index_pos"), header_ = record.head;
        copy_record(record, op);
      } catch (const std::out_of_range&) {
        from_.fail(at, "a record is damaged");
      } catch (const std::invalid_argument& e) {
        from_.fail(at, fmt::format("a chunk cannot be packed: {}", e.what()));
      }
      at = record.end();
    }
    if (!header_.empty()) copy_.overwrite(kRos1Magic.size() + sizeof(std::uint32_t), header_);
    copy_.finish();
  }

 private:
  void copy_record(const Ros1Record& record, std::uint8_t op) {
    if (op != index_data_op) offsets_.clear();
    if (op == chunk_op) return copy_chunk(record);
    if (op == index_data_op && !offsets_.empty()) return copy_index(record);
    if (op == chunk_info_op) return copy_chunk_info(record);
    keep(record);
  }

  void keep(const Ros1Record& record) { copy_.keep(record.at, record.end() - record.at); }
  void write(const std::string& head, const std::string& data) { copy_.replace({}, with_size(head) + with_size(data)); }

  void copy_chunk(const Ros1Record& record) {
    moved_[record.at] = copy_.size();
    const auto numbers = replaced_.numbers.find(record.at);
    if (numbers == replaced_.numbers.end()) return keep(record);
    const std::string records = unpack_ros1_chunk(from_, record.at), changed = replace_messages(records, numbers->second);
    if (changed == records) {
      offsets_.clear();
      return keep(record);
    }
    const std::string head = with_ros1_number(record.head, "size", static_cast<std::uint32_t>(changed.size()));
    write(head, pack(record.fields.text("compression"), changed, from_.read(record.data, record.length)));
  }

  // Returns the records of a chunk with replaced messages, and maps their offsets.
  std::string replace_messages(const std::string& chunk, const std::map<std::uint64_t, std::size_t>& numbers) {
    std::string out;
    ByteCursor cursor(chunk);
    while (!cursor.empty()) {
      const std::uint64_t at = chunk.size() - cursor.left();
      offsets_[at] = static_cast<std::uint32_t>(out.size());
      const std::string_view head = cursor.take_sized<std::uint32_t>(), data = cursor.take_sized<std::uint32_t>();
      const auto number = numbers.find(at);
      out += with_size(head);
      out += with_size(number == numbers.end() ? std::string(data) : replaced_.replace(number->second, data));
    }
    return out;
  }

  void copy_index(const Ros1Record& record) {
    const std::string bytes = from_.read(record.data, record.length);
    ByteCursor cursor(bytes);
    std::string list;
    while (!cursor.empty()) {
      list += cursor.take(8);  // time
      const auto offset = offsets_.find(cursor.take<std::uint32_t>());
      if (offset == offsets_.end()) from_.fail(record.at, "the index of a chunk does not refer to a record");
      list += to_bytes(offset->second);
    }
    write(record.head, list);
  }

  void copy_chunk_info(const Ros1Record& record) {
    const auto moved = moved_.find(record.fields.number<std::uint64_t>("chunk_pos"));
    if (moved == moved_.end()) from_.fail(record.at, "the index does not refer to a chunk");
    write(with_ros1_number(record.head, "chunk_pos", moved->second), from_.read(record.data, record.length));
  }

  const BagFile& from_;
  const ReplacedMessages& replaced_;
  ChangedCopy copy_;
  std::string header_;                              // the header of the bag
  std::map<std::uint64_t, std::uint64_t> moved_;    // chunks, new position by old
  std::map<std::uint64_t, std::uint32_t> offsets_;  // in the last chunk, new by old; empty if it did not change
};

}  // namespace

void copy_ros1_bag(const fs::path& from, const fs::path& to, const ReplacedMessages& replaced) {
  const BagFile file(from);
  Ros1Copy(file, to, replaced).run();
}

}  // namespace dvi::bags
