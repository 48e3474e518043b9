#include "dvi/metrics/evaluate.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <filesystem>
#include <functional>
#include <set>
#include <string>
#include <vector>

#include <opencv2/core.hpp>

#include "dvi/core/error.h"
#include "dvi/core/files.h"
#include "dvi/core/frame_name.h"
#include "dvi/core/interrupt.h"
#include "dvi/core/threads.h"
#include "dvi/media/image_file.h"
#include "dvi/media/write_image.h"
#include "dvi/metrics/bootstrap.h"
#include "dvi/metrics/evaluation.h"
#include "dvi/metrics/tally.h"

namespace dvi::metrics {
namespace {

std::string join_first(const std::vector<std::string>& names) {
  constexpr std::size_t kMaxShown = 5;
  std::string text;
  for (std::size_t i = 0; i < std::min(names.size(), kMaxShown); ++i) text += (i ? ", " : "") + names[i];
  return names.size() > kMaxShown ? text + " and " + std::to_string(names.size() - kMaxShown) + " more" : text;
}

std::vector<std::string> subtract(const std::vector<std::string>& names, const std::vector<std::string>& others) {
  const std::set<std::string> known(others.begin(), others.end());
  std::vector<std::string> rest;
  for (const std::string& name : names)
    if (!known.contains(name)) rest.push_back(name);
  return rest;
}

/// Checks the folders and returns the names of the frames of the result.
std::vector<std::string> check_folders(const EvaluationFolders& folders) {
  const std::vector<std::string> names = list_frames(folders.out);
  for (const char* part : {"frames", "masks", "kind"})
    if (!fs::is_directory((folders.out / picture_file(part, names.empty() ? "" : names.front())).parent_path()))
      throw InputError(folders.out, std::string("has no result (") + part + "/ is missing)",
                       "give the folder that `dvi run` wrote");
  if (names.empty()) throw InputError(folders.out / "frames", "has no frames", "give the folder that `dvi run` wrote");
  if (folders.truth.empty()) return names;
  if (FrameImages(folders.truth, names).list().empty())
    throw InputError(folders.truth, "has no PNG files", "give the folder of the true frames, NAME.png");
  if (!folders.ignore.empty() && subtract(names, FrameImages(folders.ignore, names).list()).size() == names.size())
    throw InputError(folders.ignore, "has no NAME.png for any frame of " + folders.out.string(),
                     "give the folder with the masks of ignored pixels");
  if (!folders.masks.empty() && subtract(names, FrameImages(folders.masks, names).list()).size() == names.size())
    throw InputError(folders.masks, "has no NAME.png for any frame of " + folders.out.string(),
                     "give the folder with the masks of scored pixels");
  for (const ExternalFrames& external : folders.external)
    if (!fs::is_directory(external.folder))
      throw InputError(external.folder, "is not a folder", "give the folder of the frames of " + external.name + ", NAME.png");
  return names;
}

fs::path find_frame(const ExternalFrames& external, const std::string& name) {
  for (const char* ending : {".png", ".jpg"})
    if (fs::exists(external.folder / (name + ending))) return external.folder / (name + ending);
  throw InputError(external.folder / (name + ".png"), "is missing", "every frame with a mask requires a NAME.png or NAME.jpg");
}

cv::Mat1b load_scored(const EvaluationFolders& folders, const cv::Mat1b& removed, const std::string& file) {
  if (folders.masks.empty()) return removed.clone();
  if (!fs::exists(folders.masks / file))
    throw InputError(folders.masks / file, "is missing", "every frame requires the mask of its scored pixels");
  return media::read_mask(folders.masks / file, removed.size());
}

/// Loads a frame of the run, or of another program.
ScoredFrame load(const EvaluationFolders& folders, const FrameImages& truth, const ExternalFrames* external,
                 const std::string& name) {
  const std::string file = name + ".png";
  const cv::Size size = media::image_size(folders.out / picture_file("frames", name));
  ScoredFrame frame;
  frame.result = media::read_image(folders.out / picture_file("frames", name), size);
  frame.clean = frame.result;
  frame.kind = media::read_png_gray(folders.out / picture_file("kind", name), size);
  const cv::Mat1b removed = media::read_mask(folders.out / picture_file("masks", name), size);
  frame.scored = load_scored(folders, removed, file);
  if (cv::countNonZero(frame.scored) == 0) return frame;

  const fs::path true_image = truth.file(name);
  if (!fs::exists(true_image)) throw InputError(true_image, "is missing", "every frame with a mask requires its truth");
  frame.truth = media::read_image(true_image, size);
  const cv::Mat1b changed(removed | frame.scored);
  if (external)
    media::read_image(find_frame(*external, name), size).copyTo(frame.result, changed);
  else if (const fs::path values = folders.out / picture_file("confidence", name); fs::is_directory(values.parent_path()))
    frame.confidence = media::read_png_gray(values, size);
  frame.clean = frame.result.clone();
  frame.truth.copyTo(frame.clean, changed);
  if (!folders.ignore.empty() && fs::exists(folders.ignore / file))
    frame.scored.setTo(0, media::read_mask(folders.ignore / file, size));
  return frame;
}

/// Collects the tallies in the order of the frames.
struct Collector {
  Evaluation evaluation;
  Tally total;
  std::array<std::vector<OriginSums>, kOrigins.size()> frames;

  void add(const std::string& name, const Tally& tally) {
    if (tally.pixels(Origin::all) == 0) {
      evaluation.unscored.push_back(name);
      return;
    }
    evaluation.frames.push_back({name, tally.compute_figures()});
    total += tally;
    for (std::size_t i = 0; i < frames.size(); ++i)
      if (tally.origins[i].pixels > 0) frames[i].push_back(tally.origins[i]);
  }

  Evaluation finish() {
    evaluation.total = total.compute_figures();
    evaluation.whole_frame = compute_figures(total.whole_frame);
    for (std::size_t i = 0; i < frames.size(); ++i) {
      evaluation.intervals[i] = estimate_intervals(frames[i]);
      evaluation.confidence[i] = total.confidence[i].compute_calibration();
    }
    if (total.pixels(Origin::all) == 0)
      evaluation.warnings.emplace_back("nothing is scored: every mask is empty or completely ignored");
    warn_of_unknown_origin();
    return evaluation;
  }

  void warn_of_unknown_origin() {
    std::size_t known = 0;
    for (const Origin origin : kOrigins)
      if (origin != Origin::all) known += total.pixels(origin);
    const std::size_t unknown = total.pixels(Origin::all) - known;
    if (unknown > 0)
      evaluation.warnings.push_back(std::to_string(unknown) + " scored pixels have kind 0 and count only under `all`");
  }
};

Evaluation score(const EvaluationFolders& folders, const ExternalFrames* external, const std::vector<std::string>& names,
                 const Tick& tick) {
  Collector collector;
  const FrameImages truth(folders.truth, names);
  const std::vector<std::string> missing = subtract(truth.list(), names);
  if (!missing.empty())
    collector.evaluation.warnings.push_back(std::to_string(missing.size()) +
                                            " frames of the truth are not in the result: " + join_first(missing));

  ScoredFrame previous;
  for_blocks(names.size(), [&](std::size_t first, std::size_t last) {
    const std::size_t count = last - first;
    std::vector<ScoredFrame> frames(count);
    parallel_for(count, [&](std::size_t i) { frames[i] = load(folders, truth, external, names[first + i]); });
    std::vector<Tally> tallies(count);
    parallel_for(count, [&](std::size_t i) {
      const ScoredFrame* before = i > 0 ? &frames[i - 1] : &previous;
      const bool comparable = before->result.size() == frames[i].result.size() &&
                              (first + i == 0 || camera_of_frame(names[first + i]) == camera_of_frame(names[first + i - 1]));
      tallies[i] = make_tally(frames[i], comparable ? before : nullptr);
    });
    for (std::size_t i = 0; i < count; ++i) {
      collector.add(names[first + i], tallies[i]);
      tick();
    }
    previous = frames.back();
  });
  std::function<fs::path(const std::string&)> filled;
  if (external) filled = [&](const std::string& name) { return find_frame(*external, name); };
  collector.evaluation.artifacts = count_artifacts(folders.out, names, [] {}, filled);  // ignored pixels, too
  collector.evaluation.look = measure_look(folders.out, names, [] {}, filled);
  return collector.finish();
}

}  // namespace

std::vector<ExternalFrames> parse_external(const std::vector<std::string>& arguments) {
  std::vector<ExternalFrames> out;
  std::set<std::string> names;
  for (const std::string& argument : arguments) {
    const std::size_t equals = argument.find('=');
    if (equals == std::string::npos || equals == 0 || equals + 1 == argument.size())
      throw UsageError("--external " + argument + ": give NAME=DIR");
    out.push_back({argument.substr(0, equals), argument.substr(equals + 1)});
    if (!names.insert(out.back().name).second)
      throw UsageError("--external " + out.back().name + " is given twice; give each name once");
  }
  return out;
}

Evaluation evaluate(const EvaluationFolders& folders, const BeginPart& begin) {
  if (folders.truth.empty() && !(folders.ignore.empty() && folders.masks.empty() && folders.external.empty()))
    throw UsageError("--ignore, --masks, and --external compare a result with the truth: give --truth DIR");
  const std::vector<std::string> names = check_folders(folders);
  if (folders.truth.empty()) {
    Evaluation evaluation;
    evaluation.has_truth = false;
    evaluation.artifacts = count_artifacts(folders.out, names, begin("eval", names.size()));
    evaluation.look = measure_look(folders.out, names, begin("look", names.size()));
    return evaluation;
  }
  const Tick tick = begin("eval", names.size() * (1 + folders.external.size()));
  Evaluation evaluation = score(folders, nullptr, names, tick);
  for (const ExternalFrames& external : folders.external)
    evaluation.external.push_back({external.name, score(folders, &external, names, tick)});
  return evaluation;
}

}  // namespace dvi::metrics
