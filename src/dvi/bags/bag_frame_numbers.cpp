#include "dvi/bags/bag_frame_numbers.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <optional>

#include <fmt/format.h>

#include "dvi/core/error.h"
#include "dvi/core/median.h"

namespace dvi::bags {
namespace {

// The messages of a topic in consecutive missing files.
struct MessageGap {
  std::size_t file = 0;  // the first file after it
  std::string part;      // the first missing file
  std::optional<std::size_t> count = {};
};

// Counts the messages in the gaps of one topic.
class GapCounter {
 public:
  GapCounter(const BagMessages& messages, const BagTopic& topic, const std::vector<StampedEntry>& entries)
      : messages_(messages), topic_(topic), entries_(entries) {
    for (const MissingPart& part : messages.bag().missing)
      if (gaps_.empty() || gaps_.back().file != part.position) gaps_.push_back({part.position, part.name});
  }

  FrameNumbers run() {
    const std::optional<std::size_t> total = count_missing();
    if (total == std::size_t{0}) {
      for (MessageGap& gap : gaps_) gap.count = 0;
    } else {
      for (MessageGap& gap : gaps_) gap.count = estimate(gap);
      use_total(total);
    }
    return make_numbers();
  }

 private:
  std::optional<std::size_t> count_missing() const {
    constexpr std::size_t kMaxMessages = 100'000'000;
    const auto all = messages_.bag().counts.find(topic_.name);
    if (all == messages_.bag().counts.end() || all->second < topic_.messages.size() || all->second > kMaxMessages)
      return std::nullopt;
    return all->second - topic_.messages.size();
  }

  std::size_t file_of(const StampedEntry& entry) const { return topic_.messages[entry.number].file; }

  // Estimates the number of messages in a gap from regular times. Returns nothing if the times are irregular, or if the gap is
  // long in relation to the existing messages.
  std::optional<std::size_t> estimate(const MessageGap& gap) const {
    constexpr double kMaxIrregularity = 0.25;  // as a fraction of the period
    std::vector<std::int64_t> steps;
    for (std::size_t i = 1; i < entries_.size(); ++i)
      if (file_of(entries_[i - 1]) == file_of(entries_[i])) steps.push_back(entries_[i].time_ns - entries_[i - 1].time_ns);
    const auto after = std::find_if(entries_.begin(), entries_.end(), [&](const auto& e) { return file_of(e) >= gap.file; });
    if (steps.size() < 3 || after == entries_.begin() || after == entries_.end()) return std::nullopt;
    const auto period = static_cast<double>(median(steps));
    const auto is_irregular = [&](std::int64_t step) {
      return std::abs(static_cast<double>(step) - period) > kMaxIrregularity * period;
    };
    if (period <= 0 || std::any_of(steps.begin(), steps.end(), is_irregular)) return std::nullopt;
    const double mean =
        static_cast<double>(std::accumulate(steps.begin(), steps.end(), std::int64_t{0})) / static_cast<double>(steps.size());
    const double room = static_cast<double>(after->time_ns - std::prev(after)->time_ns) / mean;
    const double count = std::round(room);
    if (std::abs(room - count) > kMaxIrregularity || count < 1 || count > static_cast<double>(steps.size()))
      return std::nullopt;
    return static_cast<std::size_t>(count) - 1;
  }

  // The total takes precedence: it determines the count of a single gap and validates those of several gaps.
  void use_total(std::optional<std::size_t> total) {
    if (!total) return;
    std::size_t known = 0;
    MessageGap* unknown = nullptr;
    std::size_t unknowns = 0;
    for (MessageGap& gap : gaps_) {
      if (gaps_.size() == 1) gap.count.reset();
      if (!gap.count) unknown = &gap, ++unknowns;
      known += gap.count.value_or(0);
    }
    if (known > *total || (unknowns == 0 && known != *total)) {
      for (MessageGap& gap : gaps_) gap.count.reset();
    } else if (unknowns == 1) {
      unknown->count = *total - known;
      is_counted_ = gaps_.size() == 1;
    }
  }

  bool is_before_messages(const MessageGap& gap) const {
    return std::any_of(topic_.messages.begin(), topic_.messages.end(),
                       [&](const BagEntry& entry) { return entry.file >= gap.file; });
  }

  FrameNumbers make_numbers() const {
    FrameNumbers out;
    const std::size_t files = messages_.bag().files.size();
    out.missing_before.assign(files, 0);
    for (const MessageGap& gap : gaps_) {
      if (!is_before_messages(gap)) continue;
      if (!gap.count) refuse(gap);
      const std::size_t first =
          out.missing_before[gap.file] +
          static_cast<std::size_t>(std::count_if(topic_.messages.begin(), topic_.messages.end(),
                                                 [&](const BagEntry& entry) { return entry.file < gap.file; }));
      if (*gap.count > 0)
        out.missing.push_back(*gap.count == 1 ? fmt::format("{}", first) : fmt::format("{}-{}", first, first + *gap.count - 1));
      for (std::size_t file = gap.file; file < files; ++file) out.missing_before[file] += *gap.count;
      out.is_estimated |= !is_counted_ && *gap.count > 0;
    }
    return out;
  }

  [[noreturn]] void refuse(const MessageGap& gap) const {
    throw InputError(
        messages_.path(),
        fmt::format("{} is missing and had an unknown number of messages of {}: the frames after it cannot be numbered",
                    gap.part, topic_.name),
        "restore the file, or move the files after it into a separate folder without metadata.yaml");
  }

  const BagMessages& messages_;
  const BagTopic& topic_;
  const std::vector<StampedEntry>& entries_;
  std::vector<MessageGap> gaps_;
  bool is_counted_ = false;
};

}  // namespace

std::string frame_name(std::size_t number) { return fmt::format("{:06d}", number); }

FrameNumbers number_frames(const BagMessages& messages, const BagTopic& topic, const std::vector<StampedEntry>& entries) {
  return GapCounter(messages, topic, entries).run();
}

}  // namespace dvi::bags
