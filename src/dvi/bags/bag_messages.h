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

/// A message of a topic, and when it says that it was taken.
struct StampedEntry {
  std::int64_t time_ns = 0;
  std::size_t number = 0;  ///< among the topic's messages
};

/// The usual time from one message to the next, which are in order of time: 100 ms where there is only one.
std::int64_t median_period_ns(const std::vector<StampedEntry>& entries);

/// Messages of an open bag, with errors that name them.
class BagMessages {
 public:
  BagMessages(fs::path path, Bag bag) : path_(std::move(path)), bag_(std::move(bag)) {}
  const Bag& bag() const { return bag_; }
  const fs::path& path() const { return path_; }

  /// What `parse` makes of a message's bytes.
  template <class Parse>
  auto parsed(const BagTopic& topic, std::size_t number, const Parse& parse) const {
    try {
      const std::string bytes = unpack_message(bag_.read(topic.messages[number]));
      return parse(std::string_view(bytes), topic.encoding);
    } catch (const std::invalid_argument& e) {
      refuse(topic, number, e.what());
    }
  }

  /// In order of their headers' stamps; by the recorder's clock where these are not set. Repeated stamps are left out.
  std::vector<StampedEntry> stamped(const BagTopic& topic, std::vector<std::string>& warnings) const;

 private:
  [[noreturn]] void refuse(const BagTopic& topic, std::size_t number, const std::string& why) const;

  fs::path path_;
  Bag bag_;
};

}  // namespace dvi::bags
