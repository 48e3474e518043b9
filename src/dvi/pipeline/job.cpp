#include "dvi/pipeline/job.h"

#include <algorithm>
#include <charconv>

#include <fmt/format.h>

#include "dvi/core/error.h"

namespace dvi::pipeline {

void Options::describe(OptionTable& table) {
  masks.describe(table);
  odometry.describe(table);
  map.describe(table);
  exposure.describe(table);
  align.describe(table);
  depth.describe(table);
  plane_sweep.describe(table);
  sample.describe(table);
  regularize.describe(table);
  harmonize.describe(table);
  smooth.describe(table);
  flow.describe(table);
  video.describe(table);
}

OptionTable Job::table() {
  OptionTable table;
  table.section("job");
  table.add("target", target, {}, "The drive to clean.");
  table.add("sources", sources, "Further drives of the same place.");
  table.add("out", out, {}, "The folder of the result.");
  table.add("camera", read.camera, {}, "The camera to use; empty: the drive's first.");
  table.add("frames", read.frames, {}, "A:B, both included, by the drive's own numbers; empty: all.");
  table.add("masks", read.masks, {}, "A folder of PNG, a file of labels, labels, auto; empty: what the drive brings.");
  table.add("poses", read.poses, {},
            "auto (given or loam, whichever makes the sharper map), given, loam (from the scans), or a file of poses.");
  table.add(
      "remove", read.remove, {"moving", "labelled", "all"},
      "moving: of what labels name only what changes its place; labelled: what the masks say; all: both masks and labels.");
  table.add("method", method, methods(), "Ours, the published form of the stages, or a baseline without depth.");
  table.add("memory_mb", memory_mb, {16, 1000000},
            "Bound of the images, scans, masks and depth maps that are kept, so that they need not be made again.");
  options.describe(table);
  return table;
}

void Options::check() const {
  if (regularize.window % 2 == 0) throw UsageError("option regularize.window: an odd number is wanted");
}

const std::vector<std::string>& methods() {
  static const std::vector<std::string> all{"dvi", "paper", "flow", "telea", "ns"};
  return all;
}

bool is_baseline(const std::string& method) { return method == "flow" || method == "telea" || method == "ns"; }

void use_method(const std::string& method, Options& options) {
  if (std::find(methods().begin(), methods().end(), method) == methods().end())
    throw UsageError(fmt::format("--method {}: there are {}", method, fmt::join(methods(), ", ")));
  if (is_baseline(method)) options.smooth.enabled = false;
  if (method != "paper") return;
  // The published form: every point outside masks and boxes, no exposure model, linear depth, plain occlusion test.
  options.map.witnessed_only = false;
  options.map.carve = false;
  options.exposure.enabled = false;
  options.align.method = "paper";
  options.depth.split_edges = false;
  options.depth.median_px = 5;
  options.plane_sweep.enabled = false;
  options.sample.reach_frames = 0;
  options.sample.scored = false;
  options.sample.footprint = false;
  options.regularize.enabled = true;
  options.harmonize.poisson = true;
  options.harmonize.seam_gradients = false;
  options.harmonize.unseen_last = false;
  options.harmonize.unseen_vertical = 1;
  options.smooth.enabled = true;
}

FrameRange parse_frames(const std::string& text) {
  FrameRange range;
  const auto colon = text.find(':');
  const auto number = [&](std::string_view part, int& value) {
    const auto [end, error] = std::from_chars(part.data(), part.data() + part.size(), value);
    return error == std::errc() && end == part.data() + part.size();
  };
  const std::string_view view = text;
  if (colon == std::string::npos || !number(view.substr(0, colon), range.first) || !number(view.substr(colon + 1), range.last))
    throw UsageError("--frames " + text + ": wanted is A:B, two numbers");
  if (range.first > range.last) throw UsageError("--frames " + text + ": the first is behind the last");
  return range;
}

}  // namespace dvi::pipeline
