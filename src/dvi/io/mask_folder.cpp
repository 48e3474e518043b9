#include "dvi/io/mask_folder.h"

#include <algorithm>
#include <map>

#include <fmt/format.h>

#include "dvi/core/error.h"
#include "dvi/core/natural_order.h"
#include "dvi/io/image_file.h"
#include "dvi/io/text.h"

namespace dvi::io {
namespace {

using MaskFiles = std::map<std::string, fs::path>;  // by name

// COLMAP's masks keep the ending of their image: NAME.jpg.png. NAME.png comes before them.
MaskFiles masks_by_name(const std::vector<fs::path>& folders) {
  MaskFiles masks, longer;
  for (const fs::path& folder : folders)
    for (const fs::path& file : list_files(folder, {".png"})) {
      const std::string ending = lower_case(file.stem().extension().string());
      const bool of_image = ending == ".jpg" || ending == ".jpeg" || ending == ".png";
      (of_image ? longer[file.stem().stem().string()] : masks[file.stem().string()]) = file;
    }
  masks.merge(longer);
  return masks;
}

// Takes what it uses out of `masks`.
std::vector<fs::path> as_frames(const std::vector<Frame>& frames, MaskFiles& masks) {
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
  const auto by_name = [](const Frame& a, const Frame& b) { return natural_less(a.name, b.name); };
  const auto [first, last] = std::minmax_element(frames.begin(), frames.end(), by_name);
  return first != frames.end() && natural_less(first->name, name) && natural_less(name, last->name);
}

// A folder above or directly below that holds masks of the drive's frames.
std::optional<fs::path> masks_nearby(const fs::path& folder, const std::vector<Frame>& frames) {
  std::vector<fs::path> near = {folder.parent_path()};
  if (fs::is_directory(folder))
    for (const auto& entry : fs::directory_iterator(folder))
      if (entry.is_directory()) near.push_back(entry.path());
  std::sort(near.begin() + 1, near.end());
  for (const fs::path& other : near) {
    const MaskFiles masks = masks_by_name({other});
    const auto has_mask = [&](const Frame& frame) {
      const auto mask = masks.find(frame.name);
      return mask != masks.end() && mask->second != frame.file;
    };
    if (std::any_of(frames.begin(), frames.end(), has_mask)) return other;
  }
  return std::nullopt;
}

void warn_of_strays(Drive& drive, const MaskFiles& strays) {
  if (strays.empty()) return;
  drive.warnings.push_back(
      fmt::format("{} mask file{} of no image of the drive, the first is {}; masks are named like the images", strays.size(),
                  strays.size() == 1 ? " is" : "s are", strays.begin()->second.string()));
}

void require_any(const Drive& drive, const fs::path& file) {
  if (std::all_of(drive.mask_files.begin(), drive.mask_files.end(), [](const fs::path& mask) { return mask.empty(); }))
    throw InputError(file, "is a mask for no image of the drive, as are all others",
                     "name a mask like its image, or remove it");
}

}  // namespace

fs::path camera_masks(const fs::path& folder, const std::string& camera) { return folder / "masks" / camera; }

void match_masks(Drive& drive, const std::vector<fs::path>& folders) {
  MaskFiles masks = masks_by_name(folders);
  if (masks.empty()) {
    for (const fs::path& folder : folders)
      if (const auto other = masks_nearby(folder, drive.frames))
        drive.warnings.push_back(
            fmt::format("the masks in {} are not used: they belong into {}", other->string(), folder.string()));
    return;
  }
  drive.mask_files = as_frames(drive.frames, masks);
  std::erase_if(masks, [&](const auto& mask) { return in_a_gap(mask.first, drive.frames); });
  if (!masks.empty()) require_any(drive, masks.begin()->second);
  warn_of_strays(drive, masks);
}

void attach_masks(Drive& drive, const fs::path& given) {
  const fs::path of_camera = camera_masks(given, drive.camera_name);
  const fs::path folder = fs::is_directory(of_camera) ? of_camera : given;
  MaskFiles masks = masks_by_name({folder});
  if (masks.empty()) {
    const auto other = masks_nearby(folder, drive.frames);
    throw InputError(folder, "holds no masks",
                     other ? "did you mean " + other->string() + "?" : "masks are PNG files named like the images");
  }
  const fs::path any = masks.begin()->second;
  drive.mask_files = as_frames(drive.frames, masks);
  require_any(drive, any);
  const std::set<std::string> recorded = recorded_names(drive);
  std::erase_if(masks, [&](const auto& mask) { return recorded.contains(mask.first) || in_a_gap(mask.first, drive.frames); });
  warn_of_strays(drive, masks);
  attach_mask_files(drive);
}

void attach_mask_files(Drive& drive) {
  const cv::Size size(drive.camera.width, drive.camera.height);
  drive.masks = Lazy<cv::Mat1b>(drive.frames.size(), [files = drive.mask_files, size](std::size_t i) {
    return files[i].empty() ? cv::Mat1b(size, uchar{0}) : read_mask(files[i], size);
  });
}

std::optional<std::string> frames_without_mask(const Drive& drive) {
  std::vector<int> bare;
  for (std::size_t i = 0; i < drive.mask_files.size(); ++i)
    if (drive.mask_files[i].empty()) bare.push_back(drive.frames[i].number);
  if (bare.empty()) return std::nullopt;
  return fmt::format("{} of {} frames have no mask file and keep their traffic: {}", bare.size(), drive.frames.size(),
                     ranges(bare));
}

std::set<std::string> recorded_names(const Drive& drive) {
  std::set<fs::path> folders;
  for (const Frame& frame : drive.frames) folders.insert(frame.file.parent_path());
  std::set<std::string> names;
  for (const fs::path& folder : folders)
    for (const fs::path& file : list_files(folder, {".png", ".jpg", ".jpeg"})) names.insert(file.stem().string());
  return names;
}

}  // namespace dvi::io
