#include "dvi/labels/mask_reading.h"

#include <algorithm>
#include <array>
#include <functional>
#include <map>
#include <set>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <opencv2/core.hpp>

#include "dvi/core/error.h"
#include "dvi/core/median.h"
#include "dvi/labels/class_ids.h"
#include "dvi/media/image_file.h"
#include "dvi/media/image_storage.h"

namespace dvi::labels {
namespace {

constexpr std::size_t kSample = 25;  // files; each takes some ten milliseconds
constexpr std::size_t kFewest = 3;   // files that decide: one truck fills one picture
constexpr double kMost = 0.5;        // share of the picture that traffic leaves free in the median
constexpr double kShown = 1e-3;      // share of the picture from which on a value is no soft edge
constexpr std::size_t kIds = 3;      // values besides 0 that make a picture of ids

cv::Size size_of(const Drive& drive) { return {drive.camera.width, drive.camera.height}; }

// Evenly from the folders of the masks, whatever --frames leaves of the drive.
std::vector<fs::path> sample_of(const Drive& drive) {
  std::set<fs::path> folders, images;
  for (const fs::path& file : drive.mask_files)
    if (!file.empty()) folders.insert(file.parent_path());
  for (const Frame& frame : drive.frames) images.insert(frame.file);
  std::vector<fs::path> files;
  for (const fs::path& folder : folders)
    for (const fs::path& file : list_files(folder, {".png"}))
      if (!images.contains(file)) files.push_back(file);
  std::vector<fs::path> sample;
  const std::size_t count = std::min(files.size(), kSample);
  for (std::size_t i = 0; i < count; ++i) sample.push_back(files[i * files.size() / count]);
  return sample;
}

// Masks that dvi mask wrote: they may cover most of the picture.
bool of_dvi_mask(const Drive& drive) {
  for (const fs::path& file : drive.mask_files) {
    const fs::path said = file.parent_path().parent_path().parent_path() / "masks.json";
    if (!file.empty()) return fs::is_regular_file(said) && read_file(said).find("dvi-masks/") != std::string::npos;
  }
  return false;
}

// The values of a picture besides 0 that take more than soft edges; of colors a number for each.
std::set<int> values_of(const cv::Mat& picture) {
  std::vector<cv::Mat> channels;
  cv::split(picture, channels);
  constexpr std::size_t kNoise = 10'000;  // values: a photograph
  std::map<int, std::size_t> counts;
  std::size_t* run = nullptr;
  int last = 0;
  for (int y = 0; y < picture.rows; ++y)
    for (int x = 0; x < picture.cols; ++x) {
      int value = 0;
      for (std::size_t c = 0; c < std::min<std::size_t>(channels.size(), 3); ++c)
        value = value << 8 ^ (picture.depth() == CV_16U ? channels[c].at<ushort>(y, x) : channels[c].at<uchar>(y, x));
      if (run == nullptr || value != last) run = &counts[last = value];
      ++*run;
      if (counts.size() > kNoise) return {};
    }
  std::set<int> values;
  for (const auto& [value, count] : counts)
    if (value != 0 && static_cast<double>(count) >= kShown * static_cast<double>(picture.total())) values.insert(value);
  return values;
}

/// What a sample shows of how the masks are meant.
struct Looks {
  fs::path first;              // file
  std::vector<double> shares;  // of pixels that are not 0, one for each file
  std::set<int> values;        // besides 0
};

Looks looks_of(const std::vector<fs::path>& sample, cv::Size size) {
  Looks looks;
  for (const fs::path& file : sample) {
    const cv::Mat picture = media::read_unchanged(file, size);
    if (picture.empty()) continue;  // whoever reads it for its frame says what is wrong
    if (looks.shares.empty()) looks.first = file;
    looks.shares.push_back(cv::countNonZero(media::mask_of(picture)) / static_cast<double>(picture.total()));
    looks.values.merge(values_of(picture));
  }
  return looks;
}

Polarity decide(Drive& drive, const Looks& looks) {
  if (looks.shares.empty()) return Polarity::white;
  const double share = median(looks.shares);
  const std::string folder = looks.first.parent_path().string();
  if (share > kMost && looks.values.size() >= kIds)
    throw InputError(
        looks.first,
        fmt::format("looks like a picture of class ids: {:.0f} % of the masks beside it are not 0, with {} values", 100 * share,
                    looks.values.size()),
        "name what to remove, such as --classes car,truck,person; --polarity white removes all that is not 0; masks "
        "of probabilities have to be 0 where nothing is removed");
  if (looks.values.size() >= kIds)
    drive.warnings.push_back(
        fmt::format("the masks in {} have {} values besides 0, and all of them are removed; where they are "
                    "class ids, name what to remove with --classes",
                    folder, looks.values.size()));
  if (share <= kMost) return Polarity::white;
  if (looks.shares.size() < kFewest) {
    drive.warnings.push_back(
        fmt::format("{:.0f} % of the masks in {} are not black, and are removed; if black means remove, give "
                    "--polarity black",
                    100 * share, folder));
    return Polarity::white;
  }
  drive.warnings.push_back(
      fmt::format("in the masks in {} black means remove, because {:.0f} % of them are not black; if white "
                  "means remove, give --polarity white",
                  folder, 100 * share));
  return Polarity::black;
}

/// How a folder's pictures hold ids.
enum class IdsAs { values, colors, nothing };

bool is_gray(const cv::Mat3b& picture) {
  return std::all_of(picture.begin(), picture.end(), [](const cv::Vec3b& p) { return p[0] == p[1] && p[1] == p[2]; });
}

// As `how` says: one channel of values, or BGR.
cv::Mat as_ids(cv::Mat picture, IdsAs how) {
  if (picture.channels() == 1) return picture;
  if (picture.depth() == CV_16U || how == IdsAs::values) cv::extractChannel(picture, picture, 0);
  if (picture.channels() == 4) {
    cv::Mat3b colors(picture.size());
    const std::array<int, 6> kept{0, 0, 1, 1, 2, 2};
    cv::mixChannels(&picture, 1, &colors, 1, kept.data(), 3);
    return colors;
  }
  return picture;
}

IdsAs how_ids_are_held(const std::vector<fs::path>& sample, cv::Size size) {
  bool colors = true, plain = true, any = false;
  for (const fs::path& file : sample) {
    const cv::Mat picture = media::read_unchanged(file, size);
    if (picture.empty()) continue;
    any = true;
    const cv::Mat values = media::read_indices(file, size);
    const bool colored = picture.channels() > 1 && picture.depth() == CV_8U;
    colors &= colored && has_class_colors(as_ids(picture, IdsAs::colors));
    if (colored && values.channels() > 1 && !colors && !is_gray(as_ids(picture, IdsAs::colors)))
      throw InputError(file, "holds colors that are not those of the Cityscapes palette",
                       "--classes takes pictures of ids, with a palette or without, or these colors");
    double low = 0, high = 0;
    cv::minMaxLoc(as_ids(values, IdsAs::values), &low, &high);
    plain &= (high == 0 || high == 255) && values_of(as_ids(values, IdsAs::values)).size() <= 1;
  }
  return colors && any ? IdsAs::colors : plain ? IdsAs::nothing : IdsAs::values;
}

// Cityscapes and KITTI number the instances of a class differently.
void find_instance_factor(Drive& drive, const std::vector<fs::path>& sample, ChosenClasses& chosen) {
  std::vector<cv::Mat> pictures;
  for (const fs::path& file : sample)
    if (!media::read_unchanged(file, size_of(drive)).empty())  // whoever reads it for its frame says what is wrong
      pictures.push_back(as_ids(media::read_indices(file, size_of(drive)), IdsAs::values));
  if (!are_kitti_ids(pictures)) return;
  chosen.ids_of_a_class = kKittiIdsOfAClass;
  drive.warnings.emplace_back("the values of its masks are taken as ids * 256 + the number of the instance, as KITTI has them");
}

cv::Mat1b read_class_mask(const fs::path& file, cv::Size size, const ChosenClasses& chosen, IdsAs how) {
  if (how == IdsAs::values) return mask_of_classes(as_ids(media::read_indices(file, size), how), chosen);
  media::read_mask(file, size);  // says what is wrong with it
  return mask_of_classes(as_ids(media::read_unchanged(file, size), how), chosen);
}

using ReadMask = std::function<cv::Mat1b(const fs::path&)>;

ReadMask plain_reader(Drive& drive, const std::vector<fs::path>& sample, Polarity polarity) {
  const cv::Size size = size_of(drive);
  if (polarity == Polarity::automatic) polarity = of_dvi_mask(drive) ? Polarity::white : decide(drive, looks_of(sample, size));
  if (polarity == Polarity::black) return [size](const fs::path& file) { return cv::Mat1b(~media::read_mask(file, size)); };
  return [size](const fs::path& file) { return media::read_mask(file, size); };
}

ReadMask reader(Drive& drive, const std::vector<fs::path>& sample, const MaskReading& reading) {
  if (reading.classes.empty()) return plain_reader(drive, sample, reading.polarity);
  ChosenClasses chosen = parse_classes(reading.classes);
  const cv::Size size = size_of(drive);
  const IdsAs how = how_ids_are_held(sample, size);
  if (how == IdsAs::nothing) {
    drive.warnings.emplace_back("its masks hold no class ids, only 0 and 255: --classes is not applied to them");
    return plain_reader(drive, sample, reading.polarity);
  }
  if (how == IdsAs::values) find_instance_factor(drive, sample, chosen);
  const auto shows = [&](const fs::path& file) {
    return !media::read_unchanged(file, size).empty() && cv::countNonZero(read_class_mask(file, size, chosen, how)) > 0;
  };
  if (std::none_of(sample.begin(), sample.end(), shows))
    drive.warnings.push_back(
        fmt::format("none of the {} pictures of ids that were looked at shows --classes {}; the first is {}", sample.size(),
                    reading.classes, sample.empty() ? "" : sample.front().string()));
  return [size, chosen, how](const fs::path& file) { return read_class_mask(file, size, chosen, how); };
}

}  // namespace

void read_masks(Drive& drive, const MaskReading& reading) {
  const std::vector<fs::path> sample = sample_of(drive);
  media::warn_of_mask_orientation(drive, sample);
  const ReadMask read = reader(drive, sample, reading);
  drive.other_files.insert(drive.other_files.end(), sample.begin(), sample.end());
  drive.masks = Lazy<cv::Mat1b>(drive.frames.size(), [files = drive.mask_files, size = size_of(drive), read](std::size_t i) {
    return files[i].empty() ? cv::Mat1b(size, uchar{0}) : read(files[i]);
  });
}

cv::Mat1b read_static_mask(Drive& drive, const fs::path& file, Polarity polarity) {
  cv::Mat1b mask = media::read_mask(file, size_of(drive));
  drive.other_files.push_back(file);
  const bool mostly_white = cv::countNonZero(mask) > kMost * static_cast<double>(mask.total());
  if (polarity == Polarity::black || (polarity == Polarity::automatic && mostly_white)) mask = cv::Mat1b(~mask);
  if (polarity == Polarity::automatic && mostly_white)
    drive.warnings.push_back(
        fmt::format("in {} black means remove, because most of it is not black; if white means remove, give "
                    "--polarity white",
                    file.string()));
  return mask;
}

}  // namespace dvi::labels
