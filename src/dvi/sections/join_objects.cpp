#include "dvi/sections/join_objects.h"

#include <algorithm>
#include <map>
#include <numeric>
#include <set>
#include <utility>

#include "dvi/objects/assign_tracks.h"

namespace dvi::sections {
namespace {

using objects::CameraObjects, objects::MotionState;

/// Parameters of the comparison of two labels in one frame.
struct CoincidenceParams {
  double min_overlap = 0.5;   ///< intersection over union of their rectangles
  double center_share = 0.5;  ///< between the centers of their boxes, relative to the diagonal of the smaller one
};
constexpr CoincidenceParams kCoincidence;

/// Returns the bounding rectangle of an outline; none if it is empty.
std::optional<cv::Rect2d> bounds_of(const Instance& outline) {
  cv::Rect2d bounds;
  std::size_t position = 0;
  const auto height = static_cast<std::size_t>(std::max(1, outline.size.height));
  for (std::size_t run = 0; run < outline.runs.size(); ++run) {
    const std::size_t first = position, length = outline.runs[run];
    position += length;
    if (run % 2 == 0 || length == 0) continue;
    const std::size_t last = position - 1, column = first / height, last_column = last / height;
    const bool spans = column != last_column;
    const auto top = static_cast<double>(spans ? 0 : first % height),
               bottom = static_cast<double>(spans ? height - 1 : last % height);
    bounds |= cv::Rect2d(static_cast<double>(column), top, static_cast<double>(last_column - column + 1), bottom - top + 1);
  }
  if (bounds.empty()) return std::nullopt;
  return bounds;
}

std::optional<cv::Rect2d> rect_of(const Label& label) {
  if (label.rect) return label.rect;
  return label.instance ? bounds_of(*label.instance) : std::nullopt;
}

/// Whether two labels of one frame show the same object.
bool coincide(const Label& a, const Label& b) {
  if (a.box && b.box) {
    const double diagonal = std::min(a.box->size.norm(), b.box->size.norm());
    return (a.box->frame_from_box.t - b.box->frame_from_box.t).norm() <= kCoincidence.center_share * diagonal;
  }
  const std::optional<cv::Rect2d> of_a = rect_of(a), of_b = rect_of(b);
  if (!of_a || !of_b) return false;
  const double common = (*of_a & *of_b).area();
  return common >= kCoincidence.min_overlap * (of_a->area() + of_b->area() - common);
}

/// Counts, for each pair of objects of two sections, the frames in which they coincide.
std::map<std::pair<int, int>, std::size_t> count_coincidences(const PlannedSection& before, const PlannedSection& after) {
  std::map<std::pair<int, int>, std::size_t> votes;
  const std::vector<Frame>&a = before.target().frames, &b = after.target().frames;
  for (std::size_t i = 0, j = 0; i < a.size() && j < b.size();) {
    if (a[i].number != b[j].number) {
      ++(a[i].number < b[j].number ? i : j);
      continue;
    }
    for (const Label& label : (*before.objects.labels)[i])
      for (const Label& other : (*after.objects.labels)[j])
        if (label.track >= 0 && other.track >= 0 && coincide(label, other)) ++votes[{label.track, other.track}];
    ++i, ++j;
  }
  return votes;
}

/// Returns the pairs of the same object, those with most votes first.
std::vector<std::pair<int, int>> match_objects(const PlannedSection& before, const PlannedSection& after) {
  const auto votes = count_coincidences(before, after);
  std::map<int, std::size_t> tracks, observations;
  for (const auto& [pair, count] : votes) {
    tracks.try_emplace(pair.first, tracks.size());
    observations.try_emplace(pair.second, observations.size());
  }
  std::vector<objects::TrackCandidate> candidates;
  for (const auto& [pair, count] : votes)
    candidates.push_back({-static_cast<double>(count), tracks.at(pair.first), observations.at(pair.second)});
  const auto assigned = objects::assign_tracks(std::move(candidates), observations.size());
  std::vector<int> track_at(tracks.size());
  for (const auto& [track, index] : tracks) track_at[index] = track;
  std::vector<std::pair<int, int>> pairs;
  for (const auto& [observation, index] : observations)
    if (assigned[index]) pairs.emplace_back(track_at[*assigned[index]], observation);
  return pairs;
}

std::set<int> list_objects(const CameraObjects& objects) {
  std::set<int> numbers;
  for (const SharedLabels& labels : {objects.labels, objects.completed, objects.shown, objects.background})
    for (const std::vector<Label>& frame : *labels)
      for (const Label& label : frame)
        if (label.track >= 0) numbers.insert(label.track);
  for (const objects::ObjectMotion& motion : objects.motions) numbers.insert(motion.object);
  return numbers;
}

/// The joint number of each object of each section.
std::vector<std::map<int, int>> number_objects(const std::vector<PlannedSection>& sections) {
  std::vector<std::map<int, int>> joint(sections.size());
  std::set<int> used;
  int next = 0;
  for (const PlannedSection& section : sections)
    if (const std::set<int> numbers = list_objects(section.objects); !numbers.empty())
      next = std::max(next, *numbers.rbegin() + 1);
  for (std::size_t k = 0; k < sections.size(); ++k) {
    if (k > 0)
      for (const auto& [before, after] : match_objects(sections[k - 1], sections[k])) joint[k][after] = joint[k - 1].at(before);
    for (const int number : list_objects(sections[k].objects)) {
      if (joint[k].contains(number)) continue;
      joint[k][number] = used.contains(number) ? next++ : number;
      used.insert(joint[k][number]);
    }
  }
  return joint;
}

/// Takes the labels of the frames that each section fills.
SharedLabels join_labels(const std::vector<PlannedSection>& sections, const Drive& target,
                         const std::vector<std::map<int, int>>& numbers, SharedLabels CameraObjects::* part) {
  FrameLabels joint(target.frames.size());
  for (std::size_t k = 0; k < sections.size(); ++k) {
    const Drive& drive = sections[k].target();
    const FrameLabels& labels = *(sections[k].objects.*part);
    std::size_t whole = 0;
    for (std::size_t i = 0; i < drive.frames.size() && i < labels.size(); ++i) {
      if (!sections[k].section.own.contains(drive.frames[i].number)) continue;
      while (whole < target.frames.size() && target.frames[whole].number < drive.frames[i].number) ++whole;
      if (whole == target.frames.size() || target.frames[whole].number != drive.frames[i].number) continue;
      joint[whole] = labels[i];
      for (Label& label : joint[whole])
        if (label.track >= 0) label.track = numbers[k].at(label.track);
    }
  }
  return shared(std::move(joint));
}

}  // namespace

CameraObjects join_objects(const std::vector<PlannedSection>& sections, const Drive& target) {
  const std::vector<std::map<int, int>> numbers = number_objects(sections);
  CameraObjects joint(join_labels(sections, target, numbers, &CameraObjects::labels));
  joint.completed = join_labels(sections, target, numbers, &CameraObjects::completed);
  joint.shown = join_labels(sections, target, numbers, &CameraObjects::shown);
  joint.background = join_labels(sections, target, numbers, &CameraObjects::background);
  std::map<int, MotionState> motions;
  for (std::size_t k = 0; k < sections.size(); ++k)
    for (const objects::ObjectMotion& motion : sections[k].objects.motions) {
      MotionState& state = motions[numbers[k].at(motion.object)];
      state = std::max(state, motion.state);
    }
  for (const auto& [object, state] : motions) joint.motions.push_back({object, state});
  return joint;
}

}  // namespace dvi::sections
