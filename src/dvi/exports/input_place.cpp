#include "dvi/exports/input_place.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "dvi/core/error.h"
#include "dvi/core/path_inside.h"

namespace dvi::exports {

RecordedInput find_input(const Result& result, const ExportOptions& options) {
  RecordedInput input = result.input();
  if (!options.input.empty()) input.path = options.input;
  input.path = (fs::absolute(input.path).lexically_normal() / "").parent_path();
  return input;
}

void require_outside(const fs::path& place, const fs::path& recording) {
  if (fs::is_directory(recording) && is_inside(place, recording))
    throw InputError(place, "is in the folder of the recording", "choose a folder outside of it");
}

std::size_t warn_of_traffic(const std::vector<RecordedPart>& images, const std::vector<std::string>& others,
                            Progress& progress) {
  std::size_t unchanged = 0;
  for (const auto& [name, all, cleaned] : images) {
    unchanged += all - cleaned;
    if (cleaned < all)
      progress.warn(
          fmt::format("{} of {} images of {} are not frames of the result: they are unchanged, with the traffic that they show",
                      all - cleaned, all, name));
  }
  if (!others.empty())
    progress.warn(fmt::format("the images of {} are unchanged, with the traffic that they show", fmt::join(others, ", ")));
  return unchanged;
}

void warn_of_returns(const RecordedPart& scans, const std::vector<std::string>& others, Progress& progress) {
  if (scans.cleaned < scans.all)
    progress.warn(
        fmt::format("{} of {} scans of {} were not read by the run: they are unchanged, with the returns of the traffic",
                    scans.all - scans.cleaned, scans.all, scans.name));
  if (!others.empty())
    progress.warn(fmt::format("the scans of {} are unchanged, with the returns of the traffic", fmt::join(others, ", ")));
}

}  // namespace dvi::exports
