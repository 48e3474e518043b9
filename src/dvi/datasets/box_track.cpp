#include "dvi/datasets/box_track.h"

#include <iterator>
#include <set>

#include <fmt/format.h>

#include "dvi/core/text.h"

namespace dvi::datasets {
namespace {

using Boxes = std::map<std::int64_t, Box>;
using Key = Boxes::const_iterator;

constexpr std::int64_t kBeyondNs = 250'000'000;        // half the usual distance of key frames
constexpr std::int64_t kMaxStepNs = 1'100'000'000;     // one key frame is missing
constexpr std::int64_t kMaxBridgedNs = 5'000'000'000;  // longer, and the object may have done anything

double seconds(std::int64_t ns) { return 1e-9 * static_cast<double>(ns); }

Eigen::Vector3d place(Key key) { return key->second.frame_from_box.t; }

// The velocity from one box to the next, m/s, if they are near enough in time to tell it.
std::optional<Eigen::Vector3d> velocity(Key from, Key to) {
  if (to->first - from->first > kMaxStepNs) return std::nullopt;
  return (place(to) - place(from)) / seconds(to->first - from->first);
}

// Whether a gap's ends agree with a steady motion: the place that is predicted from each side with a known velocity lies near
// the other side. Without any velocity, the object has to be stationary.
bool is_bridged(const Boxes& boxes, Key before, Key after) {
  constexpr double kMaxStationaryM = 1, kMaxAccelerationMps2 = 1;
  const double dt = seconds(after->first - before->first);
  if (after->first - before->first > kMaxBridgedNs) return false;
  const auto earlier = before == boxes.begin() ? std::nullopt : velocity(std::prev(before), before);
  const auto later = std::next(after) == boxes.end() ? std::nullopt : velocity(after, std::next(after));
  const Eigen::Vector3d displacement = place(after) - place(before);
  if (!earlier && !later) return displacement.norm() <= kMaxStationaryM;
  const double tolerance = kMaxStationaryM + 0.5 * kMaxAccelerationMps2 * dt * dt;
  return (!earlier || (displacement - *earlier * dt).norm() <= tolerance) &&
         (!later || (displacement - *later * dt).norm() <= tolerance);
}

Box between(Key before, Key after, std::int64_t time_ns) {
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
  if (time_ns < first - kBeyondNs || time_ns > last + kBeyondNs) return std::nullopt;
  if (boxes.size() == 1) return boxes.begin()->second;
  if (after == boxes.begin()) ++after;
  if (after == boxes.end()) --after;
  const auto before = std::prev(after);
  const bool in_gap = time_ns > before->first + kBeyondNs && time_ns < after->first - kBeyondNs;
  if (after->first - before->first > kMaxStepNs && in_gap && !is_bridged(boxes, before, after)) return std::nullopt;
  return between(before, after, time_ns);
}

std::vector<BoxTrack::Gap> BoxTrack::gaps() const {
  std::vector<Gap> out;
  for (auto before = boxes.begin(); before != boxes.end() && std::next(before) != boxes.end(); ++before)
    if (const auto after = std::next(before); after->first - before->first > kMaxStepNs)
      out.push_back({before->first + kBeyondNs, after->first - kBeyondNs, is_bridged(boxes, before, after)});
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
      if (first.empty()) first = fmt::format("{} in frames {}", track.type, ranges(within));
      frames.insert(within.begin(), within.end());
    }
  if (objects.empty()) return std::nullopt;
  std::string text = fmt::format("{} labeled objects have no boxes for more than a second in between: {} gaps are interpolated",
                                 objects.size(), bridged);
  if (open > 0)
    text += fmt::format(", {} are not, because the motion is unknown, and the objects stay in frames {}: the first is a {}",
                        open, ranges({frames.begin(), frames.end()}), first);
  return text;
}

}  // namespace dvi::datasets
