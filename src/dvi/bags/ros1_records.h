#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <string_view>

#include "dvi/bags/bag_bytes.h"

namespace dvi::bags {

/// The first line of a ROS 1 bag (https://wiki.ros.org/Bags/Format/2.0).
inline constexpr std::string_view kRos1Magic = "#ROSBAG V2.0\n";

/// The opcodes of the records that are read or changed.
enum Ros1Op : std::uint8_t {
  message_data_op = 2,
  bag_header_op = 3,
  index_data_op = 4,
  chunk_op = 5,
  chunk_info_op = 6,
  connection_op = 7
};

/// The fields "name=value" of a record's header. Throws std::out_of_range if they are damaged or missing.
class Ros1Fields {
 public:
  explicit Ros1Fields(std::string_view bytes);
  std::string_view text(const std::string& name) const;  ///< empty if there is no such field
  template <class T>
  T number(const std::string& name) const {
    return ByteCursor(text(name)).take<T>();
  }
  std::int64_t time(const std::string& name) const;

 private:
  std::map<std::string, std::string> fields_;
};

/// The header of a record, and the position of its data in the file.
struct Ros1Record {
  Ros1Fields fields;
  std::string head;  ///< the bytes of the fields
  std::uint64_t at = 0, data = 0, length = 0;

  std::uint64_t end() const { return data + length; }
};

/// Reads the header of the record at a byte. Throws InputError if it is damaged or if the file ends within the record.
Ros1Record read_ros1_record(const BagFile& file, std::uint64_t at);

/// Reads and decompresses the records of the chunk at a byte. Throws InputError if it is damaged.
std::string unpack_ros1_chunk(const BagFile& file, std::uint64_t at);

/// Returns the bytes of a header with another number in a field. Throws std::out_of_range unless the field has its size.
template <class T>
std::string with_ros1_number(std::string head, std::string_view name, T value) {
  for (ByteCursor cursor(head); !cursor.empty();) {
    const std::string_view field = cursor.take_sized<std::uint32_t>();
    if (field.size() != name.size() + 1 + sizeof value || !field.starts_with(name) || field[name.size()] != '=') continue;
    std::memcpy(head.data() + (field.data() - head.data()) + name.size() + 1, &value, sizeof value);
    return head;
  }
  throw std::out_of_range("a field is missing");
}

}  // namespace dvi::bags
