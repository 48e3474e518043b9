#include "dvi/sections/join_views.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <utility>

#include <fmt/format.h>

#include "dvi/core/error.h"
#include "dvi/sections/join_poses.h"

namespace dvi::sections {
namespace {

using align::Cameras;
using exposure::Gains;
using inputs::Poses, inputs::Recordings;

/// A view by its sequence in the whole drive and the name of its frame.
using ViewName = std::pair<std::size_t, std::string>;

const std::string& frame_name(const Recordings& drives, const View& view) {
  return drives[static_cast<std::size_t>(view.sequence)].drive.frames[view.frame].name;
}

/// Returns the views of a section by name; recordings that the whole drive lacks are left out.
std::map<ViewName, std::size_t> name_views(const RecordedViews& section, const Recordings& drives) {
  std::map<ViewName, std::size_t> names;
  for (std::size_t i = 0; i < section.views.size(); ++i) {
    const View& view = section.views[i];
    if (const auto whole = find_recording(drives, section.drives[static_cast<std::size_t>(view.sequence)]))
      names.emplace(ViewName{*whole, frame_name(section.drives, view)}, i);
  }
  return names;
}

std::vector<std::map<ViewName, std::size_t>> name_all_views(const std::vector<PlannedSection>& sections,
                                                            const Recordings& drives) {
  std::vector<std::map<ViewName, std::size_t>> names;
  for (const PlannedSection& section : sections) names.push_back(name_views({section.views, section.drives}, drives));
  return names;
}

/// Returns the number of views of its sequence between a view and the nearer end of the sequence.
std::size_t distance_from_ends(const Views& views, std::size_t view) {
  const auto [first, last] = views.of_sequence(views[view].sequence);
  return std::min(view - first, last - 1 - view);
}

}  // namespace

std::vector<ViewSource> find_view_sources(const JointViews& joint) {
  const auto& [sections, views, drives, borders] = joint;
  const std::vector<std::map<ViewName, std::size_t>> names = name_all_views(sections, drives);
  std::vector<ViewSource> sources;
  for (const View& view : views.views) {
    const ViewName name{static_cast<std::size_t>(view.sequence), frame_name(drives, view)};
    std::optional<ViewSource> best;
    std::size_t best_distance = 0;
    for (std::size_t k = 0; k < sections.size(); ++k) {
      const auto found = names[k].find(name);
      if (found == names[k].end()) continue;
      const std::size_t distance = distance_from_ends(sections[k].views, found->second);
      const bool is_own = view.drive == 0 && section_at(borders, view.time_ns) == k;
      if (is_own || !best || distance > best_distance) best = ViewSource{k, found->second}, best_distance = distance;
      if (is_own) break;
    }
    if (!best)
      throw InputError(drives[name.first].drive.path, fmt::format("no section has a pose for frame {}", name.second),
                       "plan with another number of sections");
    sources.push_back(*best);
  }
  return sources;
}

std::vector<std::size_t> number_views(const RecordedViews& section, const RecordedViews& joint) {
  const std::map<ViewName, std::size_t> joint_names = name_views(joint, joint.drives);
  std::vector<std::size_t> numbers(section.views.size());
  const std::map<ViewName, std::size_t> own = name_views(section, joint.drives);
  if (own.size() != section.views.size())
    throw InputError(section.drives.front().drive.path, "has other cameras or source drives than its section", "plan again");
  for (const auto& [name, view] : own) {
    const auto found = joint_names.find(name);
    if (found == joint_names.end())
      throw InputError(joint.drives[name.first].drive.path,
                       fmt::format("frame {} has a pose in one section, but none in the joint plan", name.second),
                       "plan with another number of sections");
    numbers[view] = found->second;
  }
  return numbers;
}

Gains join_gains(const JointViews& joint) {
  const auto& [sections, views, drives, borders] = joint;
  const std::vector<std::map<ViewName, std::size_t>> names = name_all_views(sections, drives);
  std::vector<cv::Vec3d> factors{cv::Vec3d(0, 0, 0)};  // logarithms
  for (std::size_t k = 0; k + 1 < sections.size(); ++k) {
    cv::Vec3d sum(0, 0, 0);
    std::size_t count = 0;
    for (const auto& [name, view] : names[k]) {
      const auto same = names[k + 1].find(name);
      if (same == names[k + 1].end()) continue;
      for (int c = 0; c < 3; ++c)
        sum[c] += std::log(sections[k].gains.of_view[view][c] / sections[k + 1].gains.of_view[same->second][c]);
      ++count;
    }
    factors.push_back(count > 0 ? factors.back() + sum / static_cast<double>(count) : factors.back());
  }
  Gains out(views.size());
  const std::vector<ViewSource> sources = find_view_sources(joint);
  for (std::size_t i = 0; i < views.size(); ++i) {
    const Gains& gains = sections[sources[i].section].gains;
    for (int c = 0; c < 3; ++c)
      out.of_view[i][c] = gains.of_view[sources[i].view][c] * static_cast<float>(std::exp(factors[sources[i].section][c]));
    out.compared[i] = gains.compared[sources[i].view];
    out.vignetting[i] = gains.vignetting[sources[i].view];
  }
  return out;
}

Cameras join_cameras(const JointViews& joint, const Poses& poses) {
  const auto& [sections, views, drives, borders] = joint;
  Cameras out(views);
  const std::vector<ViewSource> sources = find_view_sources(joint);
  for (std::size_t i = 0; i < views.size(); ++i) {
    const PlannedSection& section = sections[sources[i].section];
    const View& view = section.views[sources[i].view];
    const auto local = static_cast<std::size_t>(view.sequence);
    const Trajectory& trajectory = poses[static_cast<std::size_t>(views[i].sequence)].world_from_lidar;
    if (const std::optional<SE3> motion = joint_from_section(trajectory, section, local, view.time_ns))
      out.camera_from_world[i] = view.camera_from_world * motion->inverse();
    out.views[i] = section.cameras.views[sources[i].view];
  }
  for (std::size_t sequence = 0; sequence < out.sequences.size(); ++sequence) {
    align::SequenceAlignment& alignment = out.sequences[sequence];
    std::size_t count = 0;
    for (const PlannedSection& section : sections) {
      const auto local = find_recording(section.drives, drives[sequence]);
      if (!local || *local >= section.cameras.sequences.size()) continue;
      const align::SequenceAlignment& own = section.cameras.sequences[*local];
      alignment.kept |= own.kept;
      alignment.mounting += own.mounting;
      ++count;
    }
    if (count > 0) alignment.mounting /= static_cast<double>(count);
  }
  return out;
}

}  // namespace dvi::sections
