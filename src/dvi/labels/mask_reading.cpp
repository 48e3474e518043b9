#include "dvi/labels/mask_reading.h"

#include <algorithm>
#include <array>
#include <cmath>
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
#include "dvi/labels/mask_folder.h"
#include "dvi/labels/mask_video.h"
#include "dvi/media/image_file.h"
#include "dvi/media/image_storage.h"

namespace dvi::labels {
namespace {

// The sample that decides the meaning of masks, and its thresholds.
struct MaskReadingParams {
  std::size_t max_sampled_files = 25;  // each file takes about ten milliseconds
  std::size_t min_deciding_files = 3;  // a single truck may fill one image
  double max_removed_share = 0.5;      // fraction of the image, in the median
  double min_value_share = 1e-3;       // fraction of the image; rarer values are soft edges
  std::size_t min_id_values = 3;       // values other than 0 in an image of ids
};
constexpr MaskReadingParams kReadingParams;

cv::Size get_size(const Drive& drive) { return {drive.camera.width, drive.camera.height}; }

// Samples the folders of the masks evenly, independently of --frames.
std::vector<fs::path> sample_files(const Drive& drive) {
  std::set<fs::path> folders, images;
  for (const fs::path& file : drive.mask_files)
    if (!file.empty()) folders.insert(file.parent_path());
  for (const Frame& frame : drive.frames) images.insert(frame.file);
  std::vector<fs::path> files;
  for (const fs::path& folder : folders)
    for (const fs::path& file : list_files(folder, kMaskEndings))
      if (!images.contains(file)) files.push_back(file);
  std::vector<fs::path> sample;
  const std::size_t count = std::min(files.size(), kReadingParams.max_sampled_files);
  for (std::size_t i = 0; i < count; ++i) sample.push_back(files[i * files.size() / count]);
  return sample;
}

// Returns whether the masks were written by dvi mask; these may cover most of the image.
bool is_of_dvi_mask(const Drive& drive) {
  for (const fs::path& file : drive.mask_files) {
    const fs::path said = file.parent_path().parent_path().parent_path() / "masks.json";
    if (!file.empty()) return fs::is_regular_file(said) && read_file(said).find("dvi-masks/") != std::string::npos;
  }
  return false;
}

// Returns the values of an image other than 0 that are not soft edges; for colors, a number for each.
std::set<int> find_values(const cv::Mat& picture) {
  std::vector<cv::Mat> channels;
  cv::split(picture, channels);
  constexpr std::size_t kMaxValues = 10'000;  // a photograph has more
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
      if (counts.size() > kMaxValues) return {};
    }
  std::set<int> values;
  for (const auto& [value, count] : counts)
    if (value != 0 && static_cast<double>(count) >= kReadingParams.min_value_share * static_cast<double>(picture.total()))
      values.insert(value);
  return values;
}

/// The properties of a sample that indicate the meaning of masks.
struct MaskStatistics {
  fs::path first;              // the first file
  std::vector<double> shares;  // share of pixels that are not 0 per file
  std::set<int> values;        // other than 0
};

MaskStatistics measure_masks(const std::vector<fs::path>& sample, cv::Size size) {
  MaskStatistics looks;
  for (const fs::path& file : sample) {
    const cv::Mat picture = media::read_unchanged(file, size);
    if (picture.empty()) continue;  // reading it for its frame reports the error
    if (looks.shares.empty()) looks.first = file;
    looks.shares.push_back(cv::countNonZero(media::read_mask(file, size)) / static_cast<double>(picture.total()));
    looks.values.merge(find_values(picture));
  }
  return looks;
}

Polarity judge_masks(Drive& drive, const MaskStatistics& looks) {
  if (looks.shares.empty()) return Polarity::white;
  const double share = median(looks.shares);
  const std::string folder = looks.first.parent_path().string();
  if (share > kReadingParams.max_removed_share && looks.values.size() >= kReadingParams.min_id_values)
    throw InputError(
        looks.first,
        fmt::format("looks like an image of class ids: {:.0f} % of the masks in its folder are not 0, with {} values",
                    100 * share, looks.values.size()),
        "select the classes to remove by --classes car,truck,person, or remove all values other than 0 by --polarity white; "
        "masks "
        "of probabilities must be 0 where nothing is removed");
  if (looks.values.size() >= kReadingParams.min_id_values)
    drive.warnings.push_back(
        fmt::format("the masks in {} have {} values other than 0, and all of them are removed; if they are "
                    "class ids, select the classes to remove by --classes",
                    folder, looks.values.size()));
  return decide_polarity(drive, PaintedShare{.share = share, .masks = looks.shares.size(), .where = folder});
}

/// The representation of ids in the images of a folder.
enum class IdEncoding { values, colors, nothing };

bool is_gray(const cv::Mat3b& picture) {
  return std::all_of(picture.begin(), picture.end(), [](const cv::Vec3b& p) { return p[0] == p[1] && p[1] == p[2]; });
}

// Converts an image to one channel of values, or to BGR.
cv::Mat to_ids(cv::Mat picture, IdEncoding how) {
  if (picture.channels() == 1) return picture;
  if (picture.depth() == CV_16U || how == IdEncoding::values) cv::extractChannel(picture, picture, 0);
  if (picture.channels() == 4) {
    cv::Mat3b colors(picture.size());
    const std::array<int, 6> kept{0, 0, 1, 1, 2, 2};
    cv::mixChannels(&picture, 1, &colors, 1, kept.data(), 3);
    return colors;
  }
  return picture;
}

IdEncoding find_id_encoding(const std::vector<fs::path>& sample, cv::Size size) {
  bool colors = true, plain = true, any = false;
  for (const fs::path& file : sample) {
    const cv::Mat picture = media::read_unchanged(file, size);
    if (picture.empty()) continue;
    any = true;
    const cv::Mat values = media::read_indices(file, size);
    const bool colored = picture.channels() > 1 && picture.depth() == CV_8U;
    colors &= colored && has_class_colors(to_ids(picture, IdEncoding::colors));
    if (colored && values.channels() > 1 && !colors && !is_gray(to_ids(picture, IdEncoding::colors)))
      throw InputError(file, "holds colors that are not those of the Cityscapes palette",
                       "--classes requires images of ids, with or without a palette, or these colors");
    double low = 0, high = 0;
    cv::minMaxLoc(to_ids(values, IdEncoding::values), &low, &high);
    plain &= (high == 0 || high == 255) && find_values(to_ids(values, IdEncoding::values)).size() <= 1;
  }
  return colors && any ? IdEncoding::colors : plain ? IdEncoding::nothing : IdEncoding::values;
}

// Cityscapes and KITTI number the instances of a class differently.
void find_instance_factor(Drive& drive, const std::vector<fs::path>& sample, ChosenClasses& chosen) {
  std::vector<cv::Mat> pictures;
  for (const fs::path& file : sample)
    if (!media::read_unchanged(file, get_size(drive)).empty())  // reading it for its frame reports the error
      pictures.push_back(to_ids(media::read_indices(file, get_size(drive)), IdEncoding::values));
  if (!are_kitti_ids(pictures)) return;
  chosen.instances_per_class = kKittiInstancesPerClass;
  drive.warnings.emplace_back("the values of the masks are read as KITTI's ids: class * 256 + instance");
}

cv::Mat1b read_class_mask(const fs::path& file, cv::Size size, const ChosenClasses& chosen, IdEncoding how) {
  if (how == IdEncoding::values) return make_class_mask(to_ids(media::read_indices(file, size), how), chosen);
  media::read_mask(file, size);  // throws the error
  return make_class_mask(to_ids(media::read_unchanged(file, size), how), chosen);
}

using ReadMask = std::function<cv::Mat1b(const fs::path&)>;

ReadMask make_plain_reader(Drive& drive, const std::vector<fs::path>& sample, Polarity polarity) {
  const cv::Size size = get_size(drive);
  if (polarity == Polarity::automatic)
    polarity = is_of_dvi_mask(drive) ? Polarity::white : judge_masks(drive, measure_masks(sample, size));
  if (polarity == Polarity::black) return [size](const fs::path& file) { return cv::Mat1b(~media::read_mask(file, size)); };
  return [size](const fs::path& file) { return media::read_mask(file, size); };
}

ReadMask make_reader(Drive& drive, const std::vector<fs::path>& sample, const MaskReading& reading) {
  if (reading.classes.empty()) return make_plain_reader(drive, sample, reading.polarity);
  ChosenClasses chosen = parse_classes(reading.classes);
  const cv::Size size = get_size(drive);
  const IdEncoding how = find_id_encoding(sample, size);
  if (how == IdEncoding::nothing) {
    drive.warnings.emplace_back("the masks hold no class ids, only 0 and 255: --classes is not applied to them");
    return make_plain_reader(drive, sample, reading.polarity);
  }
  if (how == IdEncoding::values) find_instance_factor(drive, sample, chosen);
  const auto shows = [&](const fs::path& file) {
    return !media::read_unchanged(file, size).empty() && cv::countNonZero(read_class_mask(file, size, chosen, how)) > 0;
  };
  if (std::none_of(sample.begin(), sample.end(), shows))
    drive.warnings.push_back(
        fmt::format("none of the {} inspected images of ids has the classes of --classes {}; the first is {}", sample.size(),
                    reading.classes, sample.empty() ? "" : sample.front().string()));
  return [size, chosen, how](const fs::path& file) { return read_class_mask(file, size, chosen, how); };
}

}  // namespace

Polarity decide_polarity(Drive& drive, const PaintedShare& painted) {
  const int percent = static_cast<int>(std::lround(100 * painted.share));
  if (painted.share <= kReadingParams.max_removed_share) return Polarity::white;
  if (painted.masks < kReadingParams.min_deciding_files) {
    drive.warnings.push_back(
        fmt::format("{} % of the masks in {} are not black and are removed; if black means remove, give --polarity black",
                    percent, painted.where));
    return Polarity::white;
  }
  drive.warnings.push_back(
      fmt::format("in the masks in {} black means remove, because {} % of them are not black; if white means remove, give "
                  "--polarity white",
                  painted.where, percent));
  return Polarity::black;
}

void read_masks(Drive& drive, const MaskReading& reading) {
  if (!drive.mask_video.empty()) return read_mask_video(drive, reading);
  const std::vector<fs::path> sample = sample_files(drive);
  media::warn_of_mask_orientation(drive, sample);
  const ReadMask read = make_reader(drive, sample, reading);
  drive.other_files.insert(drive.other_files.end(), sample.begin(), sample.end());
  drive.masks = Lazy<cv::Mat1b>(drive.frames.size(), [files = drive.mask_files, size = get_size(drive), read](std::size_t i) {
    return files[i].empty() ? cv::Mat1b(size, uchar{0}) : read(files[i]);
  });
}

cv::Mat1b read_static_mask(Drive& drive, const fs::path& file, Polarity polarity) {
  cv::Mat1b mask = media::read_mask(file, get_size(drive));
  drive.other_files.push_back(file);
  const bool mostly_white = cv::countNonZero(mask) > kReadingParams.max_removed_share * static_cast<double>(mask.total());
  if (polarity == Polarity::black || (polarity == Polarity::automatic && mostly_white)) mask = cv::Mat1b(~mask);
  if (polarity == Polarity::automatic && mostly_white)
    drive.warnings.push_back(
        fmt::format("in {} black means remove, because most of it is not black; if white means remove, give "
                    "--polarity white",
                    file.string()));
  return mask;
}

}  // namespace dvi::labels
