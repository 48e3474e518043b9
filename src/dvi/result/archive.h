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

static_assert(std::endian::native == std::endian::little && sizeof(std::size_t) == 8, "numbers are written as they are");

/// Stands for a value of any type.
struct AnyValue {
  template <class T>
  operator T() const;  // NOLINT(google-explicit-constructor): that it converts is all it does
};

/// Whether braces with `Count` values make a T.
template <class T, std::size_t Count>
constexpr bool takes_values() {
  return []<std::size_t... I>(std::index_sequence<I...>) {
    return requires { T{((void)I, AnyValue{})...}; };
  }(std::make_index_sequence<Count>());
}

/// Names a type.
template <class T>
struct Of {};

/// Hands each part of `value` to the archive, which writes or reads it bit for bit: numbers as they lie in memory
/// (little-endian), containers behind their count, structs field by field without padding. The fields of a struct are named by
///
///   constexpr auto fields_of(Of<Pose>) { return std::tuple{&Pose::time_ns, &Pose::position}; }
///
/// An aggregate that leaves one out does not compile, unless a field converts from anything (std::optional). A class that
/// guards its fields has a pass_parts(archive, value, Of<Class>()).
template <class Archive, class T>
void pass(Archive& archive, T& value) {
  using Value = std::remove_const_t<T>;
  if constexpr (std::is_arithmetic_v<Value> || std::is_enum_v<Value>) {
    archive.bytes(&value, sizeof value);
  } else if constexpr (requires { Value::SizeAtCompileTime; }) {  // a matrix of Eigen
    static_assert(sizeof value == Value::SizeAtCompileTime * sizeof *value.data());
    archive.bytes(value.data(), sizeof value);
  } else if constexpr (requires { Value::AmbientDimAtCompileTime; }) {  // a box of Eigen
    pass(archive, value.min());
    pass(archive, value.max());
  } else if constexpr (requires { value.val; }) {  // a vector of OpenCV
    archive.bytes(value.val, sizeof value.val);
  } else if constexpr (requires { value.has_value(); }) {
    archive.optional(value);
  } else if constexpr (requires { value.get_allocator(); }) {
    archive.items(value);
  } else if constexpr (requires { pass_parts(archive, value, Of<Value>()); }) {
    pass_parts(archive, value, Of<Value>());
  } else {
    constexpr auto fields = fields_of(Of<Value>());
    if constexpr (std::is_aggregate_v<Value>)
      static_assert(!takes_values<Value, std::tuple_size_v<decltype(fields)> + 1>(), "fields_of() leaves out a field");
    std::apply([&](const auto... field) { (pass(archive, value.*field), ...); }, fields);
  }
}

/// Writes a file of one schema beside its place. InputError on a full or read-only disk.
class ArchiveWriter {
 public:
  ArchiveWriter(const fs::path& file, const std::string& schema);

  template <class T>
  ArchiveWriter& operator<<(const T& value) {
    pass(*this, value);
    return *this;
  }
  /// Puts the file into its place, not synced.
  void finish();

  // For pass().
  void bytes(const void* from, std::size_t count);
  template <class T>
  void optional(const T& value) {
    *this << value.has_value();
    if (value) *this << *value;
  }
  template <class T>
  void items(const T& container) {
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

/// Reads it. InputError where the file is of another schema, cut, or longer than what is read.
class ArchiveReader {
 public:
  ArchiveReader(fs::path file, const std::string& schema);

  /// `value` is replaced; a container keeps its allocator.
  template <class T>
  ArchiveReader& operator>>(T& value) {
    pass(*this, value);
    return *this;
  }
  /// Nothing may be left.
  void finish() const;

  // For pass().
  void bytes(void* to, std::size_t count);
  template <class T>
  void optional(T& value) {
    bool has = false;
    *this >> has;
    value.reset();
    if (has) *this >> value.emplace();
  }
  template <class T>
  void items(T& container) {
    const std::size_t count = counted();
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
  std::size_t counted();  // of items: not more than there are bytes

  fs::path file_;
  std::uintmax_t left_ = 0;
  std::ifstream in_;
};

}  // namespace dvi::result
