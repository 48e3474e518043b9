#include "dvi/exports/result.h"

#include <algorithm>
#include <array>
#include <optional>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include "dvi/core/error.h"
#include "dvi/core/json_file.h"
#include "dvi/core/text.h"
#include "dvi/geometry/camera_json.h"
#include "dvi/geometry/rigid.h"
#include "dvi/harmonize/filled_frame.h"
#include "dvi/media/image_file.h"
#include "dvi/media/write_image.h"

namespace dvi::exports {
namespace {

constexpr const char* kRunAgain = "run the same dvi run again, which completes the result";

// Passes a JSON document of a result to `take`.
template <class Take>
void read_table(const fs::path& file, const Take& take) {
  try {
    take(read_json(file));
  } catch (const nlohmann::json::exception& e) {
    throw InputError(file, fmt::format("is not as written by dvi ({})", e.what()), kRunAgain);
  }
}

// Throws InputError about a table unless a name in it can be the name of a file.
void require_file_name(const fs::path& table, const char* what, const std::string& name) {
  if (name.empty() || name.find('/') != std::string::npos || name == "." || name == "..")
    throw InputError(table, fmt::format("has a {} '{}', which is not a valid name of a file", what, name), kRunAgain);
}

// Returns the names of the cleaned cameras; none in results of earlier versions.
std::vector<std::string> read_cameras(const fs::path& report) {
  std::vector<std::string> names;
  read_table(report, [&](const nlohmann::json& document) {
    for (const nlohmann::json& name : document.value("cameras", nlohmann::json::array())) names.push_back(name);
  });
  for (const std::string& name : names) require_file_name(report, "camera", name);
  return names;
}

}  // namespace

Result::Result(const fs::path& out, ResultSources from) : folder_(out), from_(std::move(from)) {
  if (!fs::is_directory(out)) throw InputError(out, "is not a folder", "give the OUT of a dvi run");
  if (!fs::exists(out / "sources.json") || !fs::exists(out / "report.json"))
    throw InputError(out, "is not a finished result of dvi run", kRunAgain);
  if (!fs::exists(out / "map/poses.txt"))
    throw InputError(out, "has no poses and no map", "export a result of --method dvi or paper, since the others have none");
  const std::vector<std::string> cameras = read_cameras(out / "report.json");
  if (cameras.size() < 2)
    read_poses("map", 0);
  else
    for (std::size_t k = 0; k < cameras.size(); ++k) read_poses(fs::path("map") / cameras[k], k);
  read_sources(std::max<std::size_t>(1, cameras.size()));
  read_place();
}

std::size_t Result::count_frames(std::size_t camera) const {
  return static_cast<std::size_t>(
      std::count_if(frames_.begin(), frames_.end(), [&](const ResultFrame& frame) { return frame.camera == camera; }));
}

void Result::read_poses(const fs::path& folder, std::size_t camera) {
  const std::vector<TextLine> poses = read_text_lines(folder_ / folder / "poses.txt");
  const std::vector<TextLine> times = read_text_lines(folder_ / folder / "times.txt");
  if (poses.size() != times.size())
    throw InputError(folder_ / folder / "times.txt",
                     fmt::format("has {} lines, but poses.txt has {}", times.size(), poses.size()), kRunAgain);
  for (std::size_t i = 0; i < poses.size(); ++i) {
    const std::optional<SE3> pose = to_rigid(poses[i].numbers<12>(0));
    if (!pose) poses[i].fail("is not a rigid motion", kRunAgain);
    frames_.push_back({{}, camera, {}, times[i].nanoseconds(0), *pose});
  }
}

void Result::read_place() {
  read_table(folder_ / "report.json", [&](const nlohmann::json& report) {
    const nlohmann::json place = report.at("drives").at(0).value("place", nlohmann::json());
    if (!place.is_null()) place_ = EarthPlace{place.at("latitude_deg"), place.at("longitude_deg"), place.at("heading_deg")};
  });
}

void Result::read_sources(std::size_t cameras) {
  const fs::path file = folder_ / "sources.json";
  read_table(file, [&](const nlohmann::json& table) {
    if (!table.contains("cameras"))
      throw InputError(file, "does not state the cameras: it was written by an earlier version of dvi", kRunAgain);
    for (std::size_t k = 0; k < cameras; ++k) {
      const nlohmann::json& camera = table.at("cameras").at(k);
      cameras_.push_back({camera.at("camera").get<std::string>(), camera_from_json(camera)});
    }
    for (std::size_t i = 0; i < frames_.size(); ++i) {  // the frames of the target are the first sources
      const nlohmann::json& source = table.at("sources").at(i);
      const auto name = source.at("frame").get<std::string>();
      require_file_name(file, "frame", name);
      frames_[i].name = join_frame_name(cameras > 1 ? source.at("camera").get<std::string>() : "", name);
      frames_[i].input = source.at("file").get<std::string>();
    }
  });
}

cv::Mat3b Result::image(std::size_t frame) const { return media::read_image(picture("frames", frame), size(frame)); }
cv::Mat1b Result::kind(std::size_t frame) const { return media::read_png_gray(picture("kind", frame), size(frame)); }
cv::Mat1b Result::confidence(std::size_t frame) const {
  return media::read_png_gray(picture("confidence", frame), size(frame));
}

cv::Mat1f Result::depth(std::size_t frame) const {
  cv::Mat1f meters;
  media::read_png_depth(picture("depth", frame), size(frame)).convertTo(meters, CV_32F, 1.0 / 256);
  return meters;
}

media::ImageEdit Result::edit(std::size_t frame) const {
  return {image(frame), cv::Mat1b(kind(frame) != static_cast<int>(harmonize::Kind::original))};
}

cv::Mat1b Result::evidence(std::size_t frame) const {
  return cv::Mat1b(kind(frame) <= static_cast<int>(harmonize::Kind::copied_elsewhere));
}

}  // namespace dvi::exports
