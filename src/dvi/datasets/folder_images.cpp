#include "dvi/datasets/folder_images.h"

#include <algorithm>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "dvi/core/error.h"
#include "dvi/datasets/file_names.h"
#include "dvi/media/image_file.h"

namespace dvi::datasets {
namespace {

/// Finds the video of a camera, such as images/CAMERA.mp4. Returns an empty path if there is none.
fs::path find_video(const fs::path& drive, const std::string& camera) {
  for (const fs::path& file : list_files(drive / "images", media::kVideoEndings))
    if (file.stem() == camera) return file;
  return {};
}

}  // namespace

std::vector<NamedFile> name_files(const std::vector<fs::path>& files) {
  require_one_file_per_name(files);
  std::vector<NamedFile> out;
  for (const fs::path& file : files) out.push_back({file.stem().string(), file});
  return out;
}

FolderImages find_images(const fs::path& drive, const std::string& camera) {
  FolderImages out{name_files(list_files(drive / "images" / camera, kImageEndings)), nullptr};
  const fs::path video = find_video(drive, camera);
  if (video.empty()) return out;
  if (!out.files.empty()) throw InputError(video, "lies beside a folder of images of that camera", "remove one of the two");
  out.video = std::make_shared<const media::VideoReader>(video);
  for (std::size_t i = 0; i < out.video->times_ns().size(); ++i) out.files.push_back({fmt::format("{:06}", i), video});
  return out;
}

bool has_images(const fs::path& drive, const std::string& camera) {
  return !list_files(drive / "images" / camera, kImageEndings).empty() || !find_video(drive, camera).empty();
}

std::optional<std::string> describe_uncalibrated_cameras(const fs::path& drive, const DriveConfig& config) {
  std::vector<std::string> names;
  for (const fs::directory_entry& entry : fs::directory_iterator(drive / "images"))
    if (const std::string name = entry.path().filename().string();
        entry.is_directory() && !config.cameras.contains(name) && has_images(drive, name))
      names.push_back(name);
  if (names.empty()) return std::nullopt;
  std::sort(names.begin(), names.end());
  return fmt::format("the images of {} are not used, because dvi.toml has no table [camera.{}]", fmt::join(names, ", "),
                     names.front());
}

}  // namespace dvi::datasets
