#include "dvi/datasets/camera_choice.h"

#include <algorithm>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "dvi/core/error.h"

namespace dvi::datasets {

std::string choose_camera(const Drive& drive, const std::string& asked, const std::string& usual) {
  const auto& names = drive.camera_names;
  const auto has = [&](const std::string& name) { return std::find(names.begin(), names.end(), name) != names.end(); };
  if (asked.empty()) return has(usual) ? usual : names.front();
  if (!has(asked))
    throw InputError(drive.path, "has no images of camera '" + asked + "'", fmt::format("it has {}", fmt::join(names, ", ")));
  return asked;
}

}  // namespace dvi::datasets
