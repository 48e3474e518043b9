#include "dvi/datasets/draft_config.h"

#include <algorithm>
#include <optional>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "dvi/core/error.h"
#include "dvi/core/median.h"
#include "dvi/core/text.h"
#include "dvi/datasets/drive_config.h"
#include "dvi/datasets/file_names.h"
#include "dvi/datasets/reader.h"
#include "dvi/media/image_file.h"
#include "dvi/media/point_cloud.h"

namespace dvi::datasets {
namespace {

const std::vector<std::string> kScanEndings = {".bin", ".ply", ".pcd"};

std::vector<fs::path> list_folders(const fs::path& folder) {
  std::vector<fs::path> out;
  if (!fs::is_directory(folder)) return out;
  for (const auto& entry : fs::directory_iterator(folder))
    if (entry.is_directory()) out.push_back(entry.path());
  std::sort(out.begin(), out.end());
  return out;
}

// Returns the rate by the median step of lines "NAME seconds". Returns nothing if there is no such file or if its times do not
// increase.
std::optional<double> find_rate(const fs::path& file) {
  if (!fs::exists(file)) return std::nullopt;
  std::vector<std::int64_t> times;
  std::vector<double> steps;
  for (const TextLine& line : read_text_lines(file)) times.push_back(line.nanoseconds(1));
  std::sort(times.begin(), times.end());
  for (std::size_t i = 1; i < times.size(); ++i) steps.push_back(1e-9 * static_cast<double>(times[i] - times[i - 1]));
  const double step = median(std::move(steps));
  return step > 0 ? std::optional(1 / step) : std::nullopt;
}

// Returns the remedy for images that lie where the layout does not expect them.
std::string describe_image_remedy(const fs::path& folder) {
  for (const fs::path& place : list_folders(folder)) {
    if (!list_files(place, kImageEndings).empty())
      return place.filename() == "images"
                 ? "move them into images/CAMERA, such as images/front"
                 : fmt::format("move those of {} into images/CAMERA, such as images/front", place.string());
    for (const fs::path& below : list_folders(place))
      if (!list_files(below, kImageEndings).empty())
        return fmt::format("move those of {} into images/CAMERA, such as images/front", below.string());
  }
  return list_files(folder, kImageEndings).empty() ? "put the images into images/CAMERA, such as images/front"
                                                   : "move its images into images/CAMERA, such as images/front";
}

std::string format_camera_table(const fs::path& images, bool depth, DraftConfig& out) {
  const std::string camera = images.filename().string();
  const std::vector<fs::path> files = list_files(images, kImageEndings);
  const cv::Size size = media::image_size(files.front());
  const auto rate = find_rate(images.parent_path().parent_path() / "times" / (camera + ".txt"));
  out.open.push_back(fmt::format("[camera.{}] K: take it from the calibration, in pixels of the {}x{} images", camera,
                                 size.width, size.height));
  if (!depth) out.open.push_back(fmt::format("[camera.{}] camera_from_lidar: take it from the calibration", camera));
  std::string text = fmt::format("[camera.\"{}\"]                # {} images", camera, files.size());
  if (rate) text += fmt::format(", {:.4g} Hz by times/{}.txt", *rate, camera);
  text += fmt::format("\nsize = [{}, {}]\n# K = [fx, 0, {:g}, 0, fy, {:g}, 0, 0, 1]      # fill in: pixels, row by row\n",
                      size.width, size.height, 0.5 * (size.width - 1), 0.5 * (size.height - 1));
  text +=
      "# distortion = [0, 0, 0, 0, 0]  # k1, k2, p1, p2, k3 as in OpenCV, if the images are distorted\n"
      "# model = \"fisheye\"            # with k1 to k4 as its distortion; or unified, equirectangular, cylindrical\n";
  if (!depth)
    text +=
        "# fill in: x_camera = R x_lidar + t, meters; this example is a camera that looks ahead from the LiDAR's position\n"
        "# camera_from_lidar = [0, -1, 0, 0,   0, 0, -1, 0,   1, 0, 0, 0]\n";
  return text + "# offset_s = 0.0                # added to this camera's times, if its clock is off\n\n";
}

std::string format_lidar_table(const fs::path& folder, const std::vector<fs::path>& scans, DraftConfig& out) {
  const auto rate = find_rate(folder / "times/lidar.txt");
  std::vector<fs::path> bins = scans;
  std::erase_if(bins, [](const fs::path& file) { return !media::is_bin(file); });
  const media::BinLayout layout = media::infer_bin_layout(bins, {.period_s = 1 / rate.value_or(LidarConfig().rate)});
  const media::PointCloud cloud = media::read_point_cloud(scans.front(), layout);
  const bool intensity = std::any_of(cloud.intensity.begin(), cloud.intensity.end(), [](float i) { return i != 0; });
  std::string text = fmt::format("[lidar]                         # {} scans {}; the first has {} points{}{}{}\n", scans.size(),
                                 scans.front().extension().string(), cloud.points.size(), intensity ? ", intensity" : "",
                                 cloud.ring.empty() ? "" : ", ring", cloud.t.empty() ? "" : ", times t");
  text += rate ? fmt::format("rate = {:.4g}\n", *rate) : "rate = 10.0                     # assumed: scans per second\n";
  if (!rate) out.open.emplace_back("[lidar] rate: 10 scans per second are assumed");
  if (layout.shape() != media::BinShape())
    text += fmt::format("columns = [\"{}\"]      # inferred from the values of {}\n", fmt::join(layout.columns, "\", \""),
                        layout.text());
  text += "stamp = \"middle\"              # assumed: the time of a scan is its start, middle or end\n";
  if (!cloud.t.empty()) return text;
  out.open.emplace_back("[lidar] rotation: clockwise is assumed; none if the scans are compensated for motion already");
  return text +
         "rotation = \"clockwise\"        # assumed, seen from above: clockwise, counterclockwise, or none if already "
         "compensated\n"
         "first_azimuth_deg = 180.0       # assumed: atan2(y, x) of a scan's first firing\n";
}

void require_none_yet(const fs::path& folder) {
  if (!fs::is_directory(folder)) throw InputError(folder, "is not a folder", "name a folder with images/CAMERA and lidar/");
  if (fs::exists(folder / "dvi.toml")) throw InputError(folder / "dvi.toml", "exists already", "edit it, or move it away");
  for (const DriveFormat& format : drive_formats())
    if (format.name != "folder" && format.recognize(folder))
      throw InputError(folder, "is a " + format.name + " recording, which needs no dvi.toml", "see dvi check");
}

}  // namespace

DraftConfig draft_config(const fs::path& given) {
  const fs::path folder = (fs::absolute(given).lexically_normal() / "").parent_path();
  require_none_yet(folder);
  std::vector<fs::path> cameras = list_folders(folder / "images");
  std::erase_if(cameras, [](const fs::path& camera) { return list_files(camera, kImageEndings).empty(); });
  if (cameras.empty()) {
    for (const fs::path& camera : list_folders(folder / "images"))
      if (describe_unread_images(camera)) fail_without_images(camera, "holds no images in a supported format", {});
    throw InputError(folder, "has no folder images/CAMERA with images", describe_image_remedy(folder));
  }
  const std::vector<fs::path> scans = list_files(folder / "lidar", kScanEndings);
  const bool depth = scans.empty() && !list_folders(folder / "depth").empty();
  DraftConfig out;
  if (scans.empty() && !depth)
    out.open.emplace_back("scans: put .bin, .ply or .pcd files into lidar/, or depth images into depth/CAMERA");
  out.text = fmt::format(
      "# docs/formats.md explains each line. Lines to fill in are commented out.\n[drive]\nversion = 1\n"
      "camera = \"{}\"                # used if --camera is not given\n\n",
      cameras.front().filename().string());
  for (const fs::path& camera : cameras) out.text += format_camera_table(camera, depth, out);
  if (!scans.empty()) out.text += format_lidar_table(folder, scans, out);
  if (depth) out.text += "[depth]\nunits_per_meter = 1000          # assumed; 1000 means millimeters\n";
  if (!fs::exists(folder / "times"))
    out.open.emplace_back(
        "times: without times/, an image and a scan with the same name belong together, and the names count scans");
  return out;
}

}  // namespace dvi::datasets
