#include "dvi/bags/bag_camera.h"

#include <algorithm>
#include <sstream>

#include <fmt/format.h>

#include "dvi/bags/ros_image.h"
#include "dvi/core/error.h"
#include "dvi/media/image_file.h"

namespace dvi::bags {
namespace {

// Returns whether a part of the topic's name states rectified images: image_rect, image_rect_color, rectified; but not
// "correct".
bool is_rectified(const std::string& topic) {
  std::istringstream parts(topic);
  for (std::string part; std::getline(parts, part, '/');)
    if (part.starts_with("rect") || part.find("_rect") != std::string::npos || part.find("-rect") != std::string::npos ||
        part.find("rectified") != std::string::npos)
      return true;
  return false;
}

// Sets the model and its coefficients, after xi of the unified model. Bags state none for images without distortion.
void set_distortion(Camera& camera, const RosCameraInfo& info, const fs::path& path, const std::string& topic) {
  const std::optional<CameraModel> model = info.model.empty() ? CameraModel::pinhole : find_camera_model(info.model);
  if (!model)
    throw InputError(path, fmt::format("{} has the camera model '{}', which is not supported", topic, info.model),
                     "undistort the images first (image_proc), and set the K of the undistorted images in dvi.toml; or set the "
                     "model there, if it has another name");
  const bool has_xi = model == CameraModel::unified && !info.D.empty();
  const std::span<const double> coefficients = std::span(info.D).subspan(has_xi ? 1 : 0);
  if (const std::string problem = describe_lens_problem(*model, coefficients); !problem.empty())
    throw InputError(path, fmt::format("the distortion '{}' of {} {}", info.model, topic, problem),
                     "undistort the images first (image_proc), or set K, model, and distortion in dvi.toml");
  camera.set_lens(make_lens(*model, coefficients, has_xi ? info.D[0] : 0));
}

void warn_of_other_frame(const BagMessages& messages, const BagCamera& camera, const RosCameraInfo& info,
                         std::vector<std::string>& warnings) {
  const RosHeader image =
      messages.decode(*camera.images, 0, [](std::string_view m, BagEncoding e) { return read_header(m, e); });
  if (info.header.frame.empty() || image.frame.empty() || info.header.frame == image.frame) return;
  const std::string folder = camera.info->name.substr(0, camera.info->name.rfind('/') + 1);
  std::string rest = camera.images->name.substr(std::min(folder.size(), camera.images->name.size()));
  if (rest.ends_with("/compressed")) rest.erase(rest.rfind('/'));
  const bool side_by_side = camera.images->name.starts_with(folder) && rest.find('/') == std::string::npos;
  if (side_by_side) return;
  warnings.push_back(fmt::format(
      "the calibration {} is of the frame {}, but the images of {} are of the frame {}; if it is of another camera, select "
      "the right one by --topic info=TOPIC",
      camera.info->name, info.header.frame, camera.images->name, image.frame));
}

// Returns the size of the first image.
cv::Size read_image_size(const BagMessages& messages, const BagTopic& images) {
  const auto size = [&](std::string_view m, BagEncoding e) {
    if (is_compressed(images)) return media::image_size(images.name, parse_image_file(m, e).file);
    const RosImage image = parse_image(m, e);
    return cv::Size(static_cast<int>(image.width), static_cast<int>(image.height));
  };
  return messages.decode(images, 0, size);
}

}  // namespace

Camera read_bag_camera(const BagMessages& messages, const BagCamera& camera, std::vector<std::string>& warnings) {
  const std::string& topic = camera.info->name;
  const RosCameraInfo info =
      messages.decode(*camera.info, 0, [](std::string_view m, BagEncoding e) { return parse_camera_info(m, e); });
  const bool rectified = is_rectified(camera.images->name);
  if ((rectified ? info.P[0] : info.K[0]) == 0)
    throw InputError(
        messages.path(),
        fmt::format("the camera of {} is not calibrated: {} of {} is zero", camera.images->name, rectified ? "P" : "K", topic),
        fmt::format("set [camera.{}] K and size in dvi.toml, or give --topic info=TOPIC", camera.name));
  warn_of_other_frame(messages, camera, info, warnings);
  Camera out;
  const bool has_size = info.width > 0 && info.height > 0;
  const cv::Size size = has_size ? cv::Size(info.width, info.height) : read_image_size(messages, *camera.images);
  out.width = size.width, out.height = size.height;
  const auto set = [&](double fx, double fy, double cx, double cy) { out.fx = fx, out.fy = fy, out.cx = cx, out.cy = cy; };
  if (rectified) {
    set(info.P[0], info.P[5], info.P[2], info.P[6]);
  } else {
    set(info.K[0], info.K[4], info.K[2], info.K[5]);
    set_distortion(out, info, messages.path(), topic);
  }
  return out;
}

}  // namespace dvi::bags
