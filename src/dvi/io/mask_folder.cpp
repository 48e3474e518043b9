#include "dvi/io/mask_folder.h"

#include <algorithm>
#include <map>

#include "dvi/core/error.h"
#include "dvi/io/image_file.h"

namespace dvi::io {
namespace {

std::map<std::string, fs::path> masks_by_name(const std::vector<fs::path>& folders) {
  std::map<std::string, fs::path> masks;
  for (const fs::path& folder : folders)
    for (const fs::path& file : list_files(folder, {".png"})) masks[file.stem().string()] = file;
  return masks;
}

// Takes what it uses out of `masks`.
std::vector<fs::path> as_frames(const std::vector<Frame>& frames, std::map<std::string, fs::path>& masks) {
  std::vector<fs::path> files;
  for (const Frame& frame : frames) {
    const auto found = masks.find(frame.name);
    files.push_back(found == masks.end() ? fs::path() : found->second);
    if (found != masks.end()) masks.erase(found);
  }
  return files;
}

// A name between those of the first and the last frame is that of an image that is missing, which is said elsewhere.
bool in_a_gap(const std::string& name, const std::vector<Frame>& frames) {
  const auto by_name = [](const Frame& a, const Frame& b) { return a.name < b.name; };
  const auto [first, last] = std::minmax_element(frames.begin(), frames.end(), by_name);
  return first != frames.end() && first->name < name && name < last->name;
}

}  // namespace

std::vector<fs::path> match_masks(const std::vector<Frame>& frames, const std::vector<fs::path>& folders) {
  std::map<std::string, fs::path> masks = masks_by_name(folders);
  if (masks.empty()) return {};
  std::vector<fs::path> files = as_frames(frames, masks);
  std::erase_if(masks, [&](const auto& mask) { return in_a_gap(mask.first, frames); });
  if (!masks.empty())
    throw InputError(masks.begin()->second, "is a mask for no image of the drive", "name a mask like its image, or remove it");
  return files;
}

void attach_masks(Drive& drive, const fs::path& folder) {
  std::map<std::string, fs::path> masks = masks_by_name({folder});
  if (masks.empty()) throw InputError(folder, "holds no masks", "masks are PNG files named like the images");
  const fs::path any = masks.begin()->second;
  drive.mask_files = as_frames(drive.frames, masks);
  if (std::all_of(drive.mask_files.begin(), drive.mask_files.end(), [](const fs::path& file) { return file.empty(); }))
    throw InputError(any, "is a mask for no image of the drive", "name masks like the images");
  const cv::Size size(drive.camera.width, drive.camera.height);
  drive.masks = Lazy<cv::Mat1b>(drive.frames.size(), [files = drive.mask_files, size](std::size_t i) {
    return files[i].empty() ? cv::Mat1b(size, uchar{0}) : read_mask(files[i], size);
  });
}

}  // namespace dvi::io
