#pragma once

#include <string>

#include "dvi/bags/bag.h"
#include "dvi/testing/image_folder.h"  // IWYU pragma: export

namespace dvi {

/// Serializes fields in the encoding of CDR or ROS 1.
class MessageBytes {
 public:
  explicit MessageBytes(bags::BagEncoding encoding) : encoding_(encoding) {}

  template <class T>
  MessageBytes& add(T value) {
    while (encoding_ == bags::BagEncoding::cdr && bytes_.size() % sizeof(T) != 0) bytes_.push_back('\0');
    bytes_.append(reinterpret_cast<const char*>(&value), sizeof(T));
    return *this;
  }
  MessageBytes& add_text(const std::string& text) {
    const bool ended = encoding_ == bags::BagEncoding::cdr;
    add(static_cast<std::uint32_t>(text.size() + (ended ? 1 : 0)));
    bytes_ += text + std::string(ended ? 1 : 0, '\0');
    return *this;
  }
  MessageBytes& add_data(const std::string& data) {
    add(static_cast<std::uint32_t>(data.size()));
    bytes_ += data;
    return *this;
  }
  MessageBytes& add_header(std::int32_t seconds, std::uint32_t nanoseconds, const std::string& frame) {
    if (encoding_ == bags::BagEncoding::ros1) add<std::uint32_t>(7);
    return add(seconds).add(nanoseconds).add_text(frame);
  }
  std::string text() const { return encoding_ == bags::BagEncoding::cdr ? std::string("\0\1\0\0", 4) + bytes_ : bytes_; }

 private:
  bags::BagEncoding encoding_;
  std::string bytes_;
};

}  // namespace dvi
