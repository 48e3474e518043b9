#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "dvi/bags/bag_messages.h"

namespace dvi::bags {

/// Where the messages of a topic that are there lie in the whole recording.
struct FrameNumbers {
  std::vector<std::size_t> missing_before;  ///< per file of the bag: messages of the topic in missing files before it
  std::vector<std::string> missing;         ///< numbers of messages that are missing between others: "10-14"
  bool is_estimated = false;                ///< from the regular times of the messages, not from counts

  std::size_t number(const BagTopic& topic, std::size_t message) const {
    return message + missing_before[topic.messages[message].file];
  }
};

/// Numbers the messages of a topic as in the whole recording, so that frame numbers and masks keep their meaning where files of
/// a split recording are missing. By the counts of metadata.yaml, or where these do not say, by the times of the messages, if
/// these are regular. `entries` are in order of time. InputError where the numbers cannot be known.
FrameNumbers number_frames(const BagMessages& messages, const BagTopic& topic, const std::vector<StampedEntry>& entries);

}  // namespace dvi::bags
