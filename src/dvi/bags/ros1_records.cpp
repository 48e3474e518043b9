#include "dvi/bags/ros1_records.h"

#include <exception>
#include <stdexcept>

#include <fmt/format.h>

#include "dvi/core/error.h"

namespace dvi::bags {

Ros1Fields::Ros1Fields(std::string_view bytes) {
  ByteCursor cursor(bytes);
  while (!cursor.empty()) {
    const std::string_view field = cursor.take_sized<std::uint32_t>();
    const std::size_t sign = field.find('=');
    if (sign == std::string_view::npos) throw std::out_of_range("a field has no '='");
    fields_.emplace(field.substr(0, sign), field.substr(sign + 1));
  }
}

std::string_view Ros1Fields::text(const std::string& name) const {
  const auto field = fields_.find(name);
  return field == fields_.end() ? std::string_view() : std::string_view(field->second);
}

std::int64_t Ros1Fields::time(const std::string& name) const {
  ByteCursor cursor(text(name));
  const std::int64_t seconds = cursor.take<std::uint32_t>();
  return seconds * 1'000'000'000 + cursor.take<std::uint32_t>();
}

Ros1Record read_ros1_record(const BagFile& file, std::uint64_t at) {
  const auto number = [&](std::uint64_t place) {
    const std::string bytes = file.read(place, 4);
    return std::uint64_t{ByteCursor(bytes).take<std::uint32_t>()};
  };
  const std::uint64_t size = number(at), data = at + 4 + size;
  try {
    std::string head = file.read(at + 4, size);
    const Ros1Fields fields(head);
    Ros1Record record{fields, std::move(head), at, data + 4, number(data)};
    if (record.end() > file.size()) file.fail(at, "the file ends within a record");
    return record;
  } catch (const std::out_of_range&) {
    file.fail(at, "the header of a record is damaged");
  }
}

std::string unpack_ros1_chunk(const BagFile& file, std::uint64_t at) {
  const Ros1Record record = read_ros1_record(file, at);
  try {
    return unpack(record.fields.text("compression"), file.read(record.data, record.length),
                  record.fields.number<std::uint32_t>("size"));
  } catch (const InputError&) {
    throw;
  } catch (const std::exception& e) {
    file.fail(at, fmt::format("a chunk cannot be unpacked: {}", e.what()));
  }
}

}  // namespace dvi::bags
