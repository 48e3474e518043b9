#include "dvi/result/usable_folder.h"

#include <vector>

#include <fmt/format.h>

#include "dvi/core/error.h"
#include "dvi/core/files.h"
#include "dvi/core/path_inside.h"

namespace dvi::result {
namespace {

/// Lists the paths of all inputs, as given by the user.
std::vector<fs::path> list_inputs(const job::Job& job) {
  std::vector<fs::path> inputs{job.target};
  inputs.insert(inputs.end(), job.sources.begin(), job.sources.end());
  for (const job::MasksFrom& from : job.read.masks)
    if (from.kind == job::MasksFrom::Kind::path) inputs.emplace_back(from.path);
  if (!job.read.detector.empty()) inputs.emplace_back(job.read.detector);
  if (!job.read.ego_mask.empty()) inputs.emplace_back(job.read.ego_mask);
  if (job.read.poses.kind == job::PosesFrom::Kind::file) inputs.emplace_back(job.read.poses.file);
  return inputs;
}

void require_apart_from(const fs::path& input, const fs::path& out) {
  if (is_inside(input, out) || is_inside(out, input))
    throw InputError(out, fmt::format("is, contains, or is inside of an input of the run ({})", input.string()),
                     "choose another folder");
}

}  // namespace

void require_apart(const job::Job& job) {
  for (const fs::path& input : list_inputs(job)) require_apart_from(input, job.out);
}

void require_usable_folder(const job::Job& job) {
  const fs::path out = job.out;
  if (fs::exists(out) && !fs::is_directory(out)) throw InputError(out, "is a file", "give a folder for the result");
  if (job.force || !fs::exists(out) || fs::is_empty(out)) return;
  // This test is last because a run that begins at the same time creates .dvi before anything else.
  if (!fs::is_directory(out / ".dvi"))
    throw InputError(out, "exists and is not a result of dvi", "choose another folder, or --force to write into it");
}

}  // namespace dvi::result
