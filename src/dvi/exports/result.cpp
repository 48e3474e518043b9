#include "dvi/exports/result.h"

#include <array>
#include <optional>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include "dvi/core/error.h"
#include "dvi/core/frame_name.h"
#include "dvi/core/json_file.h"
#include "dvi/core/text.h"
#include "dvi/geometry/rigid.h"
#include "dvi/harmonize/filled_frame.h"
#include "dvi/media/image_file.h"
#include "dvi/media/write_image.h"

namespace dvi::exports {
namespace {

constexpr const char* kRunAgain = "run the same dvi run again, which completes the result";

Camera to_camera(const nlohmann::json& entry) {
  const auto size = entry.at("size").get<std::array<int, 2>>();
  const auto K = entry.at("K").get<std::array<double, 9>>();
  return {size[0], size[1], K[0], K[4], K[2], K[5], entry.at("distortion").get<std::array<double, 5>>()};
}

// Passes a JSON document of a result to `take`.
template <class Take>
void read_table(const fs::path& file, const Take& take) {
  try {
    take(read_json(file));
  } catch (const nlohmann::json::exception& e) {
    throw InputError(file, fmt::format("is not as written by dvi ({})", e.what()), kRunAgain);
  }
}

}  // namespace

Result::Result(const fs::path& out, ResultSources from) : folder_(out), from_(std::move(from)) {
  if (!fs::is_directory(out)) throw InputError(out, "is not a folder", "give the OUT of a dvi run");
  if (!fs::exists(out / "sources.json") || !fs::exists(out / "report.json"))
    throw InputError(out, "is not a finished result of dvi run", kRunAgain);
  if (const std::vector<std::string> cameras = list_cameras(list_frames(out)); cameras.size() > 1)
    throw InputError(out, fmt::format("has several cameras: {}", fmt::join(cameras, ", ")),
                     "export a result of one camera (dvi run --camera NAME)");
  if (!fs::exists(out / "map/poses.txt"))
    throw InputError(out, "has no poses and no map", "export a result of --method dvi or paper, since the others have none");
  read_poses();
  read_sources();
  read_place();
}

void Result::read_poses() {
  const std::vector<TextLine> poses = read_text_lines(folder_ / "map/poses.txt");
  const std::vector<TextLine> times = read_text_lines(folder_ / "map/times.txt");
  if (poses.size() != times.size())
    throw InputError(folder_ / "map/times.txt", fmt::format("has {} lines, but poses.txt has {}", times.size(), poses.size()),
                     kRunAgain);
  for (std::size_t i = 0; i < poses.size(); ++i) {
    const std::optional<SE3> pose = to_rigid(poses[i].numbers<12>(0));
    if (!pose) poses[i].fail("is not a rigid motion", kRunAgain);
    frames_.push_back({{}, {}, times[i].nanoseconds(0), *pose});
  }
}

void Result::read_place() {
  read_table(folder_ / "report.json", [&](const nlohmann::json& report) {
    const nlohmann::json place = report.at("drives").at(0).value("place", nlohmann::json());
    if (!place.is_null()) place_ = EarthPlace{place.at("latitude_deg"), place.at("longitude_deg"), place.at("heading_deg")};
  });
}

void Result::read_sources() {
  const fs::path file = folder_ / "sources.json";
  read_table(file, [&](const nlohmann::json& table) {
    if (!table.contains("cameras"))
      throw InputError(file, "does not state the cameras: it was written by an earlier version of dvi", kRunAgain);
    const nlohmann::json& camera = table.at("cameras").at(0);
    camera_ = to_camera(camera);
    camera_name_ = camera.at("camera").get<std::string>();
    for (std::size_t i = 0; i < frames_.size(); ++i) {  // the frames of the target are the first sources
      const nlohmann::json& source = table.at("sources").at(i);
      frames_[i].name = source.at("frame").get<std::string>();
      frames_[i].input = source.at("file").get<std::string>();
    }
  });
  for (const ResultFrame& frame : frames_)
    if (frame.name.empty() || frame.name.find('/') != std::string::npos || frame.name == "." || frame.name == "..")
      throw InputError(file, "has a frame '" + frame.name + "', which is not a valid name of a file", kRunAgain);
}

cv::Mat3b Result::image(std::size_t frame) const { return media::read_image(picture("frames", frame), size()); }
cv::Mat1b Result::kind(std::size_t frame) const { return media::read_png_gray(picture("kind", frame), size()); }
cv::Mat1b Result::confidence(std::size_t frame) const { return media::read_png_gray(picture("confidence", frame), size()); }

cv::Mat1f Result::depth(std::size_t frame) const {
  cv::Mat1f meters;
  media::read_png_depth(picture("depth", frame), size()).convertTo(meters, CV_32F, 1.0 / 256);
  return meters;
}

media::ImageEdit Result::edit(std::size_t frame) const {
  return {image(frame), cv::Mat1b(kind(frame) != static_cast<int>(harmonize::Kind::original))};
}

cv::Mat1b Result::evidence(std::size_t frame) const {
  return cv::Mat1b(kind(frame) <= static_cast<int>(harmonize::Kind::copied_elsewhere));
}

}  // namespace dvi::exports
