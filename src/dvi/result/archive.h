#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <fstream>
#include <optional>
#include <string>
#include <tuple>
#include <type_traits>
#include <utility>

#include "dvi/core/draft.h"
#include "dvi/core/files.h"
#include "dvi/core/scratch.h"

namespace dvi::result {

static_assert(std::endian::native == std::endian::little && sizeof(std::size_t) == 8,
              "the byte order and size of numbers are those of the file");

/// Converts to any type, in unevaluated expressions.
struct AnyValue {
  template <class T>
  operator T() const;  // NOLINT(google-explicit-constructor): implicit conversion is its purpose
};

/// Whether a T can be initialized from `Count` values in braces.
template <class T, std::size_t Count>
constexpr bool takes_values() {
  return []<std::size_t... I>(std::index_sequence<I...>) {
    return requires { T{((void)I, AnyValue{})...}; };
  }(std::make_index_sequence<Count>());
}

/// Selects the overload of fields_of() or pass_parts() for a type.
template <class T>
struct Of {};

/// Passes each part of `value` to the archive, which writes or reads it bit for bit: numbers as in memory (little-endian),
/// containers after their count, and structs field by field without padding. fields_of() lists the fields of a struct:
///
///   constexpr auto fields_of(Of<Pose>) { return std::tuple{&Pose::time_ns, &Pose::position}; }
///
/// If the list of an aggregate is incomplete, the program does not compile, except for fields that convert from any type
/// (std::optional). A class with private fields has a function pass_parts(archive, value, Of<Class>()).
template <class Archive, class T>
void pass(Archive& archive, T& value) {
  using Value = std::remove_const_t<T>;
  if constexpr (std::is_arithmetic_v<Value> || std::is_enum_v<Value>) {
    archive.pass_bytes(&value, sizeof value);
  } else if constexpr (requires { Value::SizeAtCompileTime; }) {  // a matrix of Eigen
    static_assert(sizeof value == Value::SizeAtCompileTime * sizeof *value.data());
    archive.pass_bytes(value.data(), sizeof value);
  } else if constexpr (requires { Value::AmbientDimAtCompileTime; }) {  // a box of Eigen
    pass(archive, value.min());
    pass(archive, value.max());
  } else if constexpr (requires { value.val; }) {  // a vector of OpenCV
    archive.pass_bytes(value.val, sizeof value.val);
  } else if constexpr (requires { value.has_value(); }) {
    archive.pass_optional(value);
  } else if constexpr (requires { value.get_allocator(); }) {
    archive.pass_items(value);
  } else if constexpr (requires { pass_parts(archive, value, Of<Value>()); }) {
    pass_parts(archive, value, Of<Value>());
  } else {
    constexpr auto fields = fields_of(Of<Value>());
    if constexpr (std::is_aggregate_v<Value>)
      static_assert(!takes_values<Value, std::tuple_size_v<decltype(fields)> + 1>(), "fields_of() lacks a field");
    std::apply([&](const auto... field) { (pass(archive, value.*field), ...); }, fields);
  }
}

/// Writes a file of one schema under a temporary name in the same folder. Throws InputError if the disk is full or read-only.
class ArchiveWriter {
 public:
  ArchiveWriter(const fs::path& file, const std::string& schema);

  template <class T>
  ArchiveWriter& operator<<(const T& value) {
    pass(*this, value);
    return *this;
  }
  /// Renames the file to its final name, without syncing it to disk.
  void finish();

  // For pass().
  void pass_bytes(const void* from, std::size_t count);
  template <class T>
  void pass_optional(const T& value) {
    *this << value.has_value();
    if (value) *this << *value;
  }
  template <class T>
  void pass_items(const T& container) {
    *this << container.size();
    std::size_t i = 0;
    for (const auto& item : container) {
      *this << item;
      page_out_sometimes(i++);
    }
  }

 private:
  fs::path file_;
  Draft draft_;
  std::ofstream out_;
};

/// Reads such a file. Throws InputError if the file has another schema, is truncated, or is longer than the values read.
class ArchiveReader {
 public:
  ArchiveReader(fs::path file, const std::string& schema);

  /// Replaces `value`. A container keeps its allocator.
  template <class T>
  ArchiveReader& operator>>(T& value) {
    pass(*this, value);
    return *this;
  }
  /// Throws InputError if any bytes are left.
  void finish() const;

  // For pass().
  void pass_bytes(void* to, std::size_t count);
  template <class T>
  void pass_optional(T& value) {
    bool has = false;
    *this >> has;
    if (has)
      *this >> value.emplace();
    else
      value.reset();
  }
  template <class T>
  void pass_items(T& container) {
    const std::size_t count = read_count();
    container.clear();
    container.reserve(count);
    for (std::size_t i = 0; i < count; ++i) {
      container.push_back(typename T::value_type());
      *this >> container.back();
      page_out_sometimes(i);
    }
  }

 private:
  [[noreturn]] void refuse(const std::string& problem) const;
  std::size_t read_count();  // at most the number of bytes left

  fs::path file_;
  std::uintmax_t left_ = 0;
  std::ifstream in_;
};

}  // namespace dvi::result
