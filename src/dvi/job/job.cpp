#include "dvi/job/job.h"

#include <charconv>
#include <map>
#include <utility>

#include <fmt/format.h>

#include "dvi/core/error.h"
#include "dvi/core/text.h"

namespace dvi::job {

void Options::describe(OptionTable& table) {
  table.section("lidar");
  table.add_automatic(
      "min_range_m", {&map.min_range_m, &odometry.min_range_m}, {0, 20},
      "Nearer returns are left out, such as the recording car; auto: 2 m for a LiDAR, 0.1 m for a depth camera.");
  table.add_automatic("max_range_m", {&map.max_range_m, &odometry.max_range_m}, {1, 500},
                      "Farther returns are left out; auto: 120 m for a LiDAR, 10 m for a depth camera.");
  masks.describe(table);
  objects.describe(table);
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

void Options::check() const {
  check_ranges(*this);
  masks.check();
  if (map.min_range_m && map.max_range_m && *map.max_range_m <= *map.min_range_m)
    throw UsageError(fmt::format("option lidar.max_range_m = {}: must be greater than lidar.min_range_m = {}", *map.max_range_m,
                                 *map.min_range_m));
}

objects::RemovalOptions Job::removal() const {
  objects::RemovalOptions removal{read.remove, options.masks, options.objects, options.map.pose_error_m};
  removal.objects.complete = options.objects.complete && !is_baseline(method);
  return removal;
}

OptionTable Job::table() {
  OptionTable table;
  table.section("job");
  table.add("target", target, {}, "Names the drive to clean.");
  table.add("sources", sources, "Names source drives of the same street to copy pixels from.");
  table.add("out", out, {}, "Names the folder of the result.");
  table.flags(true);
  table.add("camera", read.camera, {}, "Selects the cameras to clean: NAME, NAME,NAME, or all; empty: the drive's first.");
  const char* topics =
      "Selects the topics of a bag: image=TOPIC, points=TOPIC, depth=TOPIC, info=TOPIC, poses=TOPIC; empty: guessed.";
  table.add("topics", read.topics, topics).flag = "--topic";
  const char* source_cameras = "Selects the other cameras of the drives to copy pixels from: all, none, or NAME,NAME.";
  table.add("source_cameras", read.source_cameras, {}, source_cameras).flag = "--sources";
  table.add("frames", read.frames, {},
            "Selects the frames A to B (A:B, inclusive) or one frame (A), by the drive's own numbers; empty: all.");
  table.add(
      "masks", read.masks,
      "Determines the removed objects: auto (the drive's mask files, else its labels, else moving objects), labels, found "
      "(moving objects), none, DIR (masks, YOLO, Grounded-SAM-2, LabelMe, labels of points), or FILE (a video of masks; "
      "labels: "
      "KITTI, MOTS, COCO, CVAT, boxes.json). The union of several values is removed; white:PATH and black:PATH state the "
      "polarity of one.");
  table.add(
      "polarity", read.mask_files.polarity,
      "States which pixels of mask files are removed: white, black, or auto (white, unless most masks are mostly white).");
  table.add("classes", read.mask_files.classes, {},
            "Selects the classes to remove from labels, or from masks that are pictures of class ids: car,truck or "
            "semantic-kitti:car or 26,27; empty: all that is masked.");
  table.add("ego_mask", read.ego_mask, {},
            "Names a PNG that masks the ego vehicle in all frames, such as its hood; it is removed, too; empty: none.");
  table.add("detector", read.detector, {},
            "Names a network (an ONNX file, docs/detector.md) whose detections are removed, too; empty: none.");
  table.add("poses", read.poses,
            "Selects the poses: auto (given or loam, whichever map is sharper), given, loam (estimated from scans), or FILE.");
  Option& remove = table.add("remove", read.remove,
                             "Selects the removed objects: moving (labeled objects that move), labeled (all masked ones), or "
                             "all (as labeled, with the labels of the drive beside its mask files).");
  remove.set = [set = remove.set](const OptionValue& value) {
    set(value == OptionValue("labelled") ? OptionValue("labeled") : value);
  };
  table.add("method", method,
            "Selects the method: dvi, paper (the published form), or a baseline without depth and poses (flow, telea, ns).");
  table.flags(false);
  table.add(
      "memory_mb", memory_mb, {16, 1000000},
      "Limits the memory: 150 MB (at most half) are for the program itself; of the rest, a third is for the map (what does "
      "not fit is paged to unlinked files in TMPDIR), a third for the images, scans, masks, and depth maps that are kept "
      "for further use, and a third, or what one frame needs, for the work in progress. Memory that the map and "
      "the work leave free is used for further images. Fewer frames than threads are processed at a time if they do not fit. A "
      "warning states "
      "the least memory for one frame.");
  table.developer();
  table.add(
      "sections", sections, {0, 10000},
      "Cuts the drive into sections that are planned alone (dvi plan --section K/N, docs/scale.md); 0: one per 10,000 frames.");
  options.describe(table);
  return table;
}

void use_method(Method method, Options& options) {
  if (is_baseline(method)) options.smooth.enabled = false;
  if (method != Method::paper) return;
  // The published form: masks as given, every point outside masks and boxes, no exposure model, linear depth, plain occlusion
  // test.
  options.objects.complete = false;
  options.map.require_camera_visibility = false;
  options.map.carve = false;
  options.exposure.enabled = false;
  options.align.method = align::AlignMethod::paper;
  options.depth.split_edges = false;
  options.depth.median_px = 5;
  options.plane_sweep.enabled = false;
  options.sample.max_frame_gap = 0;
  options.sample.scored = false;
  options.sample.footprint = false;
  options.regularize.enabled = true;
  options.harmonize.poisson = true;
  options.harmonize.seam_gradients = false;
  options.harmonize.illumination_change = false;
  options.harmonize.robust_boundary = false;
  options.harmonize.within_range = false;
  options.harmonize.unobserved_last = false;
  options.harmonize.unobserved_vertical = 1;
  options.harmonize.surface_classes = false;
  options.harmonize.unobserved = harmonize::Unobserved::interpolate;
  options.smooth.enabled = true;
  options.smooth.replace_outliers = false;
}

std::string effective_toml(Job job) {
  // A later run starts from the method's values, a later version perhaps from other ones: both have to find what differs.
  Job plain, of_method;
  use_method(job.method, of_method.options);
  std::map<std::string, std::pair<std::string, std::string>> defaults;
  const OptionTable plain_table = plain.table(), method_table = of_method.table();
  for (const Option& option : plain_table.options()) defaults[option.name()].first = option.text();
  for (const Option& option : method_table.options()) defaults[option.name()].second = option.text();
  return job.table().dump_toml([&](const Option& option) {
    const auto& [ours, methods] = defaults.at(option.name());
    return option.audience == Audience::user || option.text() != ours || option.text() != methods;
  });
}

namespace {

std::vector<std::string> split_cameras(const std::string& cameras) {
  std::vector<std::string> names = split_at_commas(cameras);
  std::erase(names, "");
  return names;
}

}  // namespace

std::string first_camera(const std::string& cameras) {
  const std::vector<std::string> names = split_cameras(cameras);
  return names.empty() || is_all_cameras(names.front()) ? "" : names.front();
}

bool is_all_cameras(const std::string& cameras) { return cameras == "all"; }

bool has_other_cameras(const std::string& cameras) { return is_all_cameras(cameras) || split_cameras(cameras).size() > 1; }

void require_one_camera(const std::string& cameras, const std::string& user) {
  if (has_other_cameras(cameras))
    throw UsageError(fmt::format("--camera {}: {} takes one camera; give --camera NAME", cameras, user));
}

bool is_listed(const std::string& camera, const std::string& cameras) {
  const std::vector<std::string> names = split_cameras(cameras);
  return is_all_cameras(cameras) || std::find(names.begin(), names.end(), camera) != names.end();
}

FrameRange parse_frames(const std::string& text) {
  const auto number = [&](std::string_view part) {
    int value = 0;
    const auto [end, error] = std::from_chars(part.data(), part.data() + part.size(), value);
    if (error != std::errc() || end != part.data() + part.size())
      throw UsageError("--frames " + text + ": must be A:B or A, such as 10:49");
    return value;
  };
  const std::string_view view = text;
  const std::size_t colon = view.find(':');
  const int first = number(view.substr(0, colon));
  const FrameRange range{first, colon == std::string_view::npos ? first : number(view.substr(colon + 1))};
  if (range.first > range.last) throw UsageError("--frames " + text + ": the first frame is after the last");
  return range;
}

}  // namespace dvi::job
