#include "dvi/bags/bag_messages.h"

#include <algorithm>

#include <fmt/format.h>

#include "dvi/bags/ros_message.h"
#include "dvi/core/error.h"
#include "dvi/core/median.h"

namespace dvi::bags {

std::int64_t median_period_ns(const std::vector<StampedEntry>& entries) {
  std::vector<std::int64_t> steps;
  for (std::size_t i = 1; i < entries.size(); ++i) steps.push_back(entries[i].time_ns - entries[i - 1].time_ns);
  return steps.empty() ? 100'000'000 : median(std::move(steps));
}

void BagMessages::refuse(const BagTopic& topic, std::size_t number, const std::string& why) const {
  throw InputError(path_, fmt::format("message {} of {}: {}", number, topic.name, why),
                   "convert or record it again, or select another topic by --topic");
}

std::vector<StampedEntry> BagMessages::list_stamped(const BagTopic& topic, std::vector<std::string>& warnings) const {
  std::vector<StampedEntry> out;
  bool set = false;
  for (std::size_t i = 0; i < topic.messages.size(); ++i) {
    const RosHeader header = decode(topic, i, [](std::string_view m, BagEncoding e) { return read_header(m, e); });
    out.push_back({header.stamp_ns, i});
    set = set || header.stamp_ns != 0;
  }
  if (!set) {
    warnings.push_back(fmt::format("the stamps of {} are not set; the times of recording are used instead", topic.name));
    for (StampedEntry& entry : out) entry.time_ns = topic.messages[entry.number].time_ns;
  }
  std::stable_sort(out.begin(), out.end(), [](const auto& a, const auto& b) { return a.time_ns < b.time_ns; });
  const std::size_t all = out.size();
  out.erase(std::unique(out.begin(), out.end(), [](const auto& a, const auto& b) { return a.time_ns == b.time_ns; }),
            out.end());
  if (out.size() < all)
    warnings.push_back(
        fmt::format("{} messages of {} have the same stamp as another one and are ignored", all - out.size(), topic.name));
  for (const StampedEntry& entry : out)
    if (entry.time_ns < 0 || entry.time_ns > 4'000'000'000 * 1'000'000'000)
      throw InputError(path_, fmt::format("message {} of {}: its stamp is not a time", entry.number, topic.name));
  return out;
}

}  // namespace dvi::bags
