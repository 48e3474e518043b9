#include "dvi/commands/external_images.h"

#include <algorithm>
#include <cstdlib>
#include <map>
#include <set>

#include <fmt/format.h>

#include "dvi/core/error.h"
#include "dvi/media/image_file.h"

namespace dvi::commands {
namespace {

/// The limits of the differences at observed pixels, in gray levels. Compression and the networks of other programs change
/// observed pixels by up to about 5 levels; another frame of the same drive differs by more than 10.
struct ImageCheckParams {
  double max_difference = 25;
  double swapped_share = 0.5;   ///< colors are swapped if swapping them reduces the difference to this share...
  double min_difference = 0.5;  ///< ...and it is at least this large
};
constexpr ImageCheckParams kImageCheck;

constexpr const char* kFolderRemedy = "give the folder of the images that the other program wrote, one per frame";

/// Returns the name of the frame that an image of LaMa belongs to: its masks are NAME_mask.png or NAME_mask001.png, and it
/// gives its images the names of the masks.
std::string remove_mask_ending(const std::string& stem) {
  const std::size_t at = stem.rfind("_mask");
  if (at == std::string::npos) return stem;
  return stem.find_first_not_of("0123456789", at + 5) == std::string::npos ? stem.substr(0, at) : stem;
}

std::vector<fs::path> list_images(const fs::path& folder) {
  if (!fs::is_directory(folder)) throw InputError(folder, "is not a folder", kFolderRemedy);
  std::vector<fs::path> files = list_files(folder, {".png", ".jpg", ".jpeg"});
  if (files.empty()) throw InputError(folder, "has no PNG or JPEG images", kFolderRemedy);
  return files;
}

/// Returns the image of each name; an exact name precedes that of a mask.
std::map<std::string, fs::path> map_names(const std::vector<fs::path>& files, const std::vector<std::string>& names) {
  std::map<std::string, fs::path> exact, of_masks;
  for (const fs::path& file : files) {
    const std::string stem = file.stem().string();
    if (const auto [other, is_new] = exact.try_emplace(stem, file); !is_new)
      throw InputError(file, "has the same name as " + other->second.filename().string(), "keep one image per frame");
    if (const std::string name = remove_mask_ending(stem); name != stem) of_masks.try_emplace(name, file);
  }
  std::map<std::string, fs::path> images;
  for (const std::string& name : names)
    for (const std::map<std::string, fs::path>* found : {&exact, &of_masks})
      if (const auto it = found->find(name); it != found->end()) images.try_emplace(name, it->second);
  return images;
}

std::vector<std::optional<fs::path>> assign_by_order(const fs::path& folder, const std::vector<fs::path>& files,
                                                     const std::vector<std::string>& names) {
  if (files.size() != names.size())
    throw InputError(
        folder,
        fmt::format("has {} images, but the result has {} frames, and no image has the name of a frame, such as {}",
                    files.size(), names.size(), names.front()),
        kFolderRemedy);
  return {files.begin(), files.end()};
}

/// Throws InputError if an image does not belong to a frame, although others do: a program may count its images from 0, and
/// some of its numbers may be names of other frames.
void require_names_of_frames(const std::vector<fs::path>& files, const std::vector<std::string>& names) {
  const std::set<std::string> known(names.begin(), names.end());
  for (const fs::path& file : files)
    if (const std::string stem = file.stem().string(); !known.contains(stem) && !known.contains(remove_mask_ending(stem)))
      throw InputError(file, "does not have the name of a frame, but other images have",
                       fmt::format("give all images the names of their frames, {} to {}", names.front(), names.back()));
}

}  // namespace

std::vector<std::optional<fs::path>> assign_images(const fs::path& folder, const std::vector<std::string>& names,
                                                   const std::vector<char>& needed) {
  const std::vector<fs::path> files = list_images(folder);
  const std::map<std::string, fs::path> images = map_names(files, names);
  if (images.empty()) return assign_by_order(folder, files, names);
  require_names_of_frames(files, names);
  std::vector<std::optional<fs::path>> assigned(names.size());
  for (std::size_t i = 0; i < names.size(); ++i) {
    if (needed[i] == 0) continue;
    const auto it = images.find(names[i]);
    if (it == images.end())
      throw InputError(folder,
                       fmt::format("has no image of frame {}, but of {} of {} frames", names[i], images.size(), names.size()),
                       kFolderRemedy);
    assigned[i] = it->second;
  }
  return assigned;
}

void require_color_image(const fs::path& file, cv::Size size) {
  if (const cv::Size found = media::image_size(file); found != size)
    throw InputError(file, fmt::format("is {}x{} pixels instead of {}x{}", found.width, found.height, size.width, size.height),
                     "let the program write images of the size of the frames");
  const cv::Mat image = media::read_unchanged(file, size);
  if (image.empty()) throw InputError(file, "is not a complete PNG or JPEG", "let the program write it again");
  if (image.type() != CV_8UC3)
    throw InputError(file,
                     fmt::format("has {} channel{} of {} bits instead of 3 of 8", image.channels(),
                                 image.channels() == 1 ? "" : "s", 8 * image.elemSize1()),
                     "let the program write 8-bit color images without transparency");
}

ObservedDifference compare_observed(const cv::Mat3b& image, const cv::Mat3b& frame, const cv::Mat1b& hole) {
  std::size_t same = 0, swapped = 0, count = 0;
  for (int y = 0; y < frame.rows; ++y)
    for (int x = 0; x < frame.cols; ++x) {
      if (hole(y, x) != 0) continue;
      const cv::Vec3b &a = image(y, x), &b = frame(y, x);
      for (int c = 0; c < 3; ++c) {
        same += static_cast<std::size_t>(std::abs(a[c] - b[c]));
        swapped += static_cast<std::size_t>(std::abs(a[2 - c] - b[c]));
      }
      count += 3;
    }
  const double n = static_cast<double>(std::max<std::size_t>(count, 1));
  return {static_cast<double>(same) / n, static_cast<double>(swapped) / n};
}

void require_same_scene(const fs::path& file, const ObservedDifference& difference) {
  if (std::min(difference.same, difference.swapped) > kImageCheck.max_difference)
    throw InputError(
        file, fmt::format("does not show its frame: outside the holes, it differs by {:.0f} gray levels", difference.same),
        "give the images that were made from this result, in the order of its frames");
}

void require_color_order(const fs::path& folder, const std::vector<ObservedDifference>& differences) {
  ObservedDifference mean;
  for (const ObservedDifference& d : differences) {
    mean.same += d.same / static_cast<double>(differences.size());
    mean.swapped += d.swapped / static_cast<double>(differences.size());
  }
  if (mean.same > kImageCheck.min_difference && mean.swapped < kImageCheck.swapped_share * mean.same)
    throw InputError(
        folder,
        fmt::format("has images with red and blue swapped: outside the holes, they differ from the result by {:.1f} "
                    "gray levels, and by {:.1f} if the channels are swapped",
                    mean.same, mean.swapped),
        "let the program write RGB images (OpenCV's imwrite expects BGR)");
}

}  // namespace dvi::commands
