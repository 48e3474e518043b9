#pragma once

#include <stdexcept>
#include <string_view>

#include "dvi/io/bag.h"
#include "dvi/io/bag_bytes.h"
#include "dvi/io/ros_cloud.h"
#include "dvi/io/ros_image.h"
#include "dvi/io/ros_message.h"
#include "parser.h"

namespace dvi::fuzz {

/// Reads every message of a bag.
inline void read_all(const fs::path& file) {
  const io::Bag bag = io::open_bag(file);
  for (const io::BagTopic& topic : bag.topics)
    for (const io::BagEntry& entry : topic.messages) {
      const std::string bytes = bag.read(entry);
      try {
        io::read_header(bytes, topic.encoding);
      } catch (const std::invalid_argument&) {  // the reader of bags names the message
      }
    }
}

}  // namespace dvi::fuzz
