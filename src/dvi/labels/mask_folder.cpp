#include "dvi/labels/mask_folder.h"

#include <algorithm>
#include <map>
#include <utility>

#include <fmt/format.h>

#include "dvi/core/error.h"
#include "dvi/core/natural_order.h"
#include "dvi/core/text.h"
#include "dvi/labels/image_names.h"
#include "dvi/labels/labels.h"
#include "dvi/labels/mask_video.h"
#include "dvi/media/image_file.h"
#include "dvi/media/video_reader.h"

namespace dvi::labels {
namespace {

using MaskFiles = std::map<std::string, fs::path>;  // by name

// COLMAP's masks keep the ending of their image: NAME.jpg.png. NAME.png takes precedence.
MaskFiles list_masks_by_name(const std::vector<fs::path>& folders) {
  MaskFiles masks, longer;
  for (const fs::path& folder : folders)
    for (const fs::path& file : list_files(folder, kMaskEndings)) {
      const std::string ending = to_lower_case(file.stem().extension().string());
      const bool of_image = ending == ".jpg" || ending == ".jpeg" || ending == ".png";
      (of_image ? longer[file.stem().stem().string()] : masks[file.stem().string()]) = file;
    }
  masks.merge(longer);
  return masks;
}

// Renames the keys of masks to the images that they belong to.
void match_to_images(Drive& drive, const fs::path& folder, const std::set<std::string>& recorded, MaskFiles& masks) {
  std::vector<std::string> names;
  for (const auto& [name, file] : masks) names.push_back(name);
  const MatchedNames matched = match_names(folder, names, recorded);
  if (matched.warning) drive.warnings.push_back("masks in " + *matched.warning);
  for (std::size_t i = 0; i < names.size(); ++i)
    if (matched.images[i] && *matched.images[i] != names[i]) {
      auto mask = masks.extract(names[i]);
      mask.key() = *matched.images[i];
      masks.insert(std::move(mask));
    }
}

// Removes the masks that it uses from `masks`.
std::vector<fs::path> assign_to_frames(const std::vector<Frame>& frames, MaskFiles& masks) {
  std::vector<fs::path> files;
  for (const Frame& frame : frames) {
    const auto found = masks.find(frame.name);
    files.push_back(found == masks.end() ? fs::path() : found->second);
    if (found != masks.end()) masks.erase(found);
  }
  return files;
}

// Returns whether a name lies between those of the first and the last frame. Its image is missing, which is reported elsewhere.
bool is_in_gap(const std::string& name, const std::vector<Frame>& frames) {
  const auto by_name = [](const Frame& a, const Frame& b) { return natural_less(a.name, b.name); };
  const auto [first, last] = std::minmax_element(frames.begin(), frames.end(), by_name);
  return first != frames.end() && natural_less(first->name, name) && natural_less(name, last->name);
}

// Finds a folder above or directly below that holds masks of the drive's frames.
std::optional<fs::path> find_masks_nearby(const fs::path& folder, const std::vector<Frame>& frames) {
  std::vector<fs::path> near = {folder.parent_path()};
  if (fs::is_directory(folder))
    for (const auto& entry : fs::directory_iterator(folder))
      if (entry.is_directory()) near.push_back(entry.path());
  std::sort(near.begin() + 1, near.end());
  for (const fs::path& other : near) {
    const MaskFiles masks = list_masks_by_name({other});
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
  drive.warnings.push_back(fmt::format("{} mask file{} no image in the drive, the first is {}; name masks like the images",
                                       strays.size(), strays.size() == 1 ? " has" : "s have", strays.begin()->second.string()));
}

void require_any(const Drive& drive, const MaskFiles& masks, const std::set<std::string>& recorded) {
  if (!std::all_of(drive.mask_files.begin(), drive.mask_files.end(), [](const fs::path& mask) { return mask.empty(); })) return;
  std::set<std::string> names;
  for (const auto& [name, file] : masks) names.insert(name);
  throw InputError(masks.begin()->second,
                   fmt::format("is not a mask of an image of the drive, nor is any other: masks are named {}, but images {}",
                               span_of(names), span_of(recorded)),
                   "name each mask like its image, or remove it");
}

std::set<std::string> list_names(const std::vector<Frame>& frames) {
  std::set<std::string> names;
  for (const Frame& frame : frames) names.insert(frame.name);
  return names;
}

// Throws an InputError that describes the content of a folder without PNG files.
[[noreturn]] void refuse_without_masks(const Drive& drive, const fs::path& folder) {
  if (const auto other = find_masks_nearby(folder, drive.frames))
    throw InputError(folder, "holds no masks", "did you mean " + other->string() + "?");
  refuse_unread_labels(folder);
  if (const std::size_t jpegs = list_files(folder, {".jpg", ".jpeg"}).size(); jpegs > 0)
    throw InputError(folder, fmt::format("holds no PNG masks, but {} JPEG files", jpegs),
                     "write masks as PNG files named like the images, because JPEG blurs their boundary");
  throw InputError(folder, "holds no masks", "add masks as PNG files named like the images");
}

}  // namespace

fs::path camera_masks(const fs::path& folder, const std::string& camera) { return folder / "masks" / camera; }

std::optional<fs::path> find_camera_folder(const fs::path& given, const std::string& camera) {
  for (const fs::path& folder : {camera_masks(given, camera), given / camera})
    if (fs::is_directory(folder)) return folder;
  return std::nullopt;
}

void match_masks(Drive& drive, const std::vector<fs::path>& folders) {
  MaskFiles masks = list_masks_by_name(folders);
  if (masks.empty()) {
    for (const fs::path& folder : folders)
      if (const auto other = find_masks_nearby(folder, drive.frames))
        drive.warnings.push_back(
            fmt::format("the masks in {} are not used; move them into {}", other->string(), folder.string()));
    return;
  }
  const std::set<std::string> recorded = list_names(drive.frames);
  match_to_images(drive, folders.front(), recorded, masks);
  drive.mask_files = assign_to_frames(drive.frames, masks);
  std::erase_if(masks, [&](const auto& mask) { return is_in_gap(mask.first, drive.frames); });
  if (!masks.empty()) require_any(drive, masks, recorded);
  warn_of_strays(drive, masks);
}

void attach_masks(Drive& drive, const fs::path& given) {
  if (media::is_video(given)) return attach_mask_video(drive, given);
  drive.mask_video.clear();
  const fs::path folder = find_camera_folder(given, drive.camera_name).value_or(given);
  MaskFiles masks = list_masks_by_name({folder});
  if (masks.empty()) refuse_without_masks(drive, folder);
  std::set<std::string> recorded = list_recorded_names(drive);
  recorded.merge(list_names(drive.frames));
  match_to_images(drive, folder, recorded, masks);
  const MaskFiles all = masks;
  drive.mask_files = assign_to_frames(drive.frames, masks);
  require_any(drive, all, recorded);
  std::erase_if(masks, [&](const auto& mask) { return recorded.contains(mask.first) || is_in_gap(mask.first, drive.frames); });
  warn_of_strays(drive, masks);
  attach_mask_files(drive);
}

void attach_mask_files(Drive& drive) {
  const cv::Size size(drive.camera.width, drive.camera.height);
  drive.masks = Lazy<cv::Mat1b>(drive.frames.size(), [files = drive.mask_files, size](std::size_t i) {
    return files[i].empty() ? cv::Mat1b(size, uchar{0}) : media::read_mask(files[i], size);
  });
}

std::optional<std::string> describe_frames_without_mask(const Drive& drive) {
  std::vector<int> bare;
  for (std::size_t i = 0; i < drive.mask_files.size(); ++i)
    if (drive.mask_files[i].empty()) bare.push_back(drive.frames[i].number);
  if (bare.empty()) return std::nullopt;
  return fmt::format("{} of {} frames have no mask file, and nothing is removed in them: {}", bare.size(), drive.frames.size(),
                     format_ranges(bare));
}

std::set<std::string> list_recorded_names(const Drive& drive) {
  std::set<fs::path> folders;
  for (const Frame& frame : drive.frames) folders.insert(frame.file.parent_path());
  std::set<std::string> names;
  for (const fs::path& folder : folders)
    for (const fs::path& file : list_files(folder, {".png", ".jpg", ".jpeg"})) names.insert(file.stem().string());
  return names;
}

}  // namespace dvi::labels
