#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "dvi/bags/bag_messages.h"

namespace dvi::bags {

/// The numbers of a topic's existing messages in the whole recording.
struct FrameNumbers {
  std::vector<std::size_t>
      missing_before;                ///< per file of the bag: the number of messages of the topic in missing files before it
  std::vector<std::string> missing;  ///< the numbers of missing messages between existing ones: "10-14"
  bool is_estimated = false;         ///< the numbers were estimated from regular times, not from counts

  std::size_t number(const BagTopic& topic, std::size_t message) const {
    return message + missing_before[topic.messages[message].file];
  }
};

/// Returns the name of the frame with a number: "000012".
std::string frame_name(std::size_t number);

/// Numbers the messages of a topic as in the whole recording, so that frame numbers and masks remain valid if files of a split
/// recording are missing. Uses the counts of metadata.yaml or, if there are none, the times of the messages if these are
/// regular. `entries` are in order of time. Throws InputError if the numbers cannot be determined.
FrameNumbers number_frames(const BagMessages& messages, const BagTopic& topic, const std::vector<StampedEntry>& entries);

}  // namespace dvi::bags
