#pragma once

#include <cstddef>
#include <cstdint>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "dvi/bags/bag.h"
#include "dvi/bags/bag_bytes.h"
#include "dvi/core/files.h"

namespace dvi::bags {

/// A message of a topic and the time of its header's stamp.
struct StampedEntry {
  std::int64_t time_ns = 0;
  std::size_t number = 0;  ///< index among the topic's messages
};

/// Returns the median time between consecutive messages, which are in order of time; 100 ms if there is only one.
std::int64_t median_period_ns(const std::vector<StampedEntry>& entries);

/// The messages of an open bag. Errors in them name the message.
class BagMessages {
 public:
  BagMessages(fs::path path, Bag bag) : path_(std::move(path)), bag_(std::move(bag)) {}
  const Bag& bag() const { return bag_; }
  const fs::path& path() const { return path_; }

  /// Returns the result of `parse` for a message's bytes. Throws InputError if it throws std::invalid_argument.
  template <class Parse>
  auto decode(const BagTopic& topic, std::size_t number, const Parse& parse) const {
    try {
      const std::string bytes = unpack_message(bag_.read(topic.messages[number]));
      return parse(std::string_view(bytes), topic.encoding);
    } catch (const std::invalid_argument& e) {
      refuse(topic, number, e.what());
    }
  }

  /// Lists the messages in order of their headers' stamps, or by the recorder's clock if these are not set. Ignores repeated
  /// stamps.
  std::vector<StampedEntry> list_stamped(const BagTopic& topic, std::vector<std::string>& warnings) const;

 private:
  [[noreturn]] void refuse(const BagTopic& topic, std::size_t number, const std::string& why) const;

  fs::path path_;
  Bag bag_;
};

}  // namespace dvi::bags
