#include "dvi/datasets/box_track.h"

#include <iterator>
#include <set>

#include <fmt/format.h>

#include "dvi/core/text.h"

namespace dvi::datasets {
namespace {

using Boxes = std::map<std::int64_t, Box>;
using Key = Boxes::const_iterator;

// The limits of interpolation between key frames.
struct BoxTrackParams {
  std::int64_t max_extrapolation_ns = 250'000'000;  // half the usual period of key frames
  std::int64_t max_step_ns = 1'100'000'000;         // one missing key frame
  std::int64_t max_bridged_ns = 5'000'000'000;      // the motion within longer gaps is unknown
};
constexpr BoxTrackParams kTrackParams;

Eigen::Vector3d position(Key key) { return key->second.frame_from_box.t; }

// Returns the velocity from one box to the next in m/s, if their times are near enough to determine it.
std::optional<Eigen::Vector3d> estimate_velocity(Key from, Key to) {
  if (to->first - from->first > kTrackParams.max_step_ns) return std::nullopt;
  return (position(to) - position(from)) / ns_to_s(to->first - from->first);
}

// Returns whether both ends of a gap agree with a steady motion: the position predicted from each side that has a known
// velocity lies near the other side. An object without a known velocity has to be stationary.
bool is_bridged(const Boxes& boxes, Key before, Key after) {
  constexpr double kMaxStationaryM = 1, kMaxAccelerationMps2 = 1;
  const double dt = ns_to_s(after->first - before->first);
  if (after->first - before->first > kTrackParams.max_bridged_ns) return false;
  const auto earlier = before == boxes.begin() ? std::nullopt : estimate_velocity(std::prev(before), before);
  const auto later = std::next(after) == boxes.end() ? std::nullopt : estimate_velocity(after, std::next(after));
  const Eigen::Vector3d displacement = position(after) - position(before);
  if (!earlier && !later) return displacement.norm() <= kMaxStationaryM;
  const double tolerance = kMaxStationaryM + 0.5 * kMaxAccelerationMps2 * dt * dt;
  return (!earlier || (displacement - *earlier * dt).norm() <= tolerance) &&
         (!later || (displacement - *later * dt).norm() <= tolerance);
}

Box interpolate(Key before, Key after, std::int64_t time_ns) {
  const double u = static_cast<double>(time_ns - before->first) / static_cast<double>(after->first - before->first);
  const SE3 &a = before->second.frame_from_box, &b = after->second.frame_from_box;
  const Eigen::Matrix3d turn = so3_exp(u * so3_log(a.R.transpose() * b.R));
  return Box{{a.R * turn, a.t + u * (b.t - a.t)}, before->second.size};
}

}  // namespace

std::optional<Box> BoxTrack::at(std::int64_t time_ns) const {
  auto after = boxes.lower_bound(time_ns);
  if (after != boxes.end() && after->first == time_ns) return after->second;
  const std::int64_t first = boxes.begin()->first, last = boxes.rbegin()->first;
  if (time_ns < first - kTrackParams.max_extrapolation_ns || time_ns > last + kTrackParams.max_extrapolation_ns)
    return std::nullopt;
  if (boxes.size() == 1) return boxes.begin()->second;
  if (after == boxes.begin()) ++after;
  if (after == boxes.end()) --after;
  const auto before = std::prev(after);
  const bool in_gap =
      time_ns > before->first + kTrackParams.max_extrapolation_ns && time_ns < after->first - kTrackParams.max_extrapolation_ns;
  if (after->first - before->first > kTrackParams.max_step_ns && in_gap && !is_bridged(boxes, before, after))
    return std::nullopt;
  return interpolate(before, after, time_ns);
}

std::vector<BoxTrack::Gap> BoxTrack::gaps() const {
  std::vector<Gap> out;
  for (auto before = boxes.begin(); before != boxes.end() && std::next(before) != boxes.end(); ++before)
    if (const auto after = std::next(before); after->first - before->first > kTrackParams.max_step_ns)
      out.push_back({before->first + kTrackParams.max_extrapolation_ns, after->first - kTrackParams.max_extrapolation_ns,
                     is_bridged(boxes, before, after)});
  return out;
}

std::optional<std::string> describe_gaps(const std::vector<BoxTrack>& tracks, const Drive& drive) {
  std::size_t bridged = 0, open = 0;
  std::set<int> frames, objects;
  std::string first;
  for (const BoxTrack& track : tracks)
    for (const BoxTrack::Gap& gap : track.gaps()) {
      std::vector<int> within;
      for (const Frame& frame : drive.frames)
        if (frame.time_ns > gap.first_ns && frame.time_ns < gap.last_ns) within.push_back(frame.number);
      if (within.empty()) continue;
      objects.insert(track.number);
      ++(gap.bridged ? bridged : open);
      if (gap.bridged) continue;
      if (first.empty()) first = fmt::format("{} in frames {}", track.type, format_ranges(within));
      frames.insert(within.begin(), within.end());
    }
  if (objects.empty()) return std::nullopt;
  std::string text = fmt::format("{} labeled objects have no boxes for more than a second in between: {} gaps are interpolated",
                                 objects.size(), bridged);
  if (open > 0)
    text +=
        fmt::format(", {} are not, because the motion is unknown: the objects are not removed in frames {}; the first is a {}",
                    open, format_ranges({frames.begin(), frames.end()}), first);
  return text;
}

}  // namespace dvi::datasets
