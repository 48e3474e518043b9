#pragma once

#include <stdexcept>
#include <string_view>

#include "dvi/bags/bag.h"
#include "dvi/bags/bag_bytes.h"
#include "dvi/bags/copy_bag.h"
#include "dvi/bags/ros_cloud.h"
#include "dvi/bags/ros_image.h"
#include "dvi/bags/ros_message.h"
#include "parser.h"

namespace dvi::fuzz {

/// Reads every message of a bag.
inline void read_all(const fs::path& file) {
  const bags::Bag bag = bags::open_bag(file);
  for (const bags::BagTopic& topic : bag.topics)
    for (const bags::BagEntry& entry : topic.messages) {
      const std::string bytes = bag.read(entry);
      try {
        bags::read_header(bytes, topic.encoding);
      } catch (const std::invalid_argument&) {  // the reader of bags names the message
      }
    }
}

/// Copies a bag with one more byte in every message.
inline void copy_all(const fs::path& file) {
  const bags::Bag bag = bags::open_bag(file);
  bags::ReplacedMessages replaced;
  for (const bags::BagTopic& topic : bag.topics)
    for (const bags::BagEntry& entry : topic.messages) replaced.numbers[entry.chunk][entry.offset] = 0;
  replaced.replace = [](std::size_t, std::string_view message) { return std::string(message) + "x"; };
  bags::copy_bag_file(file, file.parent_path() / ("copy" + file.extension().string()), replaced);
}

}  // namespace dvi::fuzz
