#include "dvi/datasets/colmap_model.h"

#include <algorithm>
#include <array>
#include <fstream>
#include <limits>
#include <stdexcept>

#include <fmt/format.h>
#include <opencv2/core/types.hpp>

#include "dvi/bags/bag_bytes.h"
#include "dvi/core/error.h"
#include "dvi/core/natural_order.h"
#include "dvi/core/text.h"
#include "dvi/geometry/plausible.h"

namespace dvi::datasets {
namespace {

constexpr double kPixelCenterPx = 0.5;

struct Model {
  const char* name;
  std::size_t focals, distortions;  // parameters: focal lengths, cx, cy, distortions
  CameraModel model = CameraModel::pinhole;
};
// The index of a model is its number in binary files. A model with 0 focal lengths has a distortion that dvi does not support.
constexpr std::array<Model, 10> kCameraModels{{{"SIMPLE_PINHOLE", 1, 0},
                                               {"PINHOLE", 2, 0},
                                               {"SIMPLE_RADIAL", 1, 1},
                                               {"RADIAL", 1, 2},
                                               {"OPENCV", 2, 4},
                                               {"OPENCV_FISHEYE", 2, 4, CameraModel::fisheye},
                                               {"FULL_OPENCV", 2, 8},
                                               {"FOV", 0, 0},
                                               {"SIMPLE_RADIAL_FISHEYE", 1, 1, CameraModel::fisheye},
                                               {"RADIAL_FISHEYE", 1, 2, CameraModel::fisheye}}};

[[noreturn]] void fail_camera(const fs::path& file, const std::string& model) {
  throw InputError(file, "has a camera of model " + model, "undistort the images with colmap image_undistorter");
}

const Model& find_model(const fs::path& file, const std::string& name) {
  for (const Model& model : kCameraModels)
    if (model.focals > 0 && name == model.name) return model;
  fail_camera(file, name);
}

const Model& find_model_by_id(const fs::path& file, std::int32_t number) {
  if (number < 0 || number >= static_cast<std::int32_t>(kCameraModels.size()) ||
      kCameraModels[static_cast<std::size_t>(number)].focals == 0)
    fail_camera(file, std::to_string(number));
  return kCameraModels[static_cast<std::size_t>(number)];
}

std::size_t count_parameters(const Model& model) { return model.focals + 2 + model.distortions; }

Camera to_camera(const fs::path& file, const Model& model, cv::Size2d size, const std::vector<double>& p) {
  if (!(size.width >= 1 && size.height >= 1 && size.area() <= 1 << 28))
    throw InputError(file, fmt::format("has a camera of {:g}x{:g} pixels", size.width, size.height));
  Camera camera{.width = static_cast<int>(size.width), .height = static_cast<int>(size.height)};
  const std::size_t f = model.focals;
  camera.fx = p[0], camera.fy = p[f - 1], camera.cx = p[f] - kPixelCenterPx, camera.cy = p[f + 1] - kPixelCenterPx;
  camera.set_lens(make_lens(model.model, std::span(p).subspan(f + 2, model.distortions)));
  require_plausible(camera, file, "a camera");
  return camera;
}

SE3 to_pose(const fs::path& file, const std::string& name, const std::array<double, 7>& v) {
  const Eigen::Quaterniond q(v[0], v[1], v[2], v[3]);
  const Eigen::Vector3d t(v[4], v[5], v[6]);
  if (!(std::abs(q.norm() - 1) <= kMaxRotationError) || !t.allFinite())
    throw InputError(file, fmt::format("the quaternion of {} has length {:.4g} instead of 1", name, q.norm()));
  const SE3 pose{q.normalized().toRotationMatrix(), t};
  require_near(pose.inverse().t, file, "the pose of " + name);
  return pose;
}

void read_text_cameras(const fs::path& file, ColmapModel& out) {
  for (const TextLine& line : read_text_lines(file)) {
    if (line.size() < 4) line.fail("is not a camera", "CAMERA_ID MODEL WIDTH HEIGHT PARAMS...");
    const Model& model = find_model(file, line.word(1));
    if (line.size() != 4 + count_parameters(model))
      line.fail(fmt::format("has {} parameters instead of {}", line.size() - 4, count_parameters(model)));
    std::vector<double> values;
    for (std::size_t i = 4; i < line.size(); ++i) values.push_back(line.number(i));
    const Camera camera = to_camera(file, model, {line.number(2), line.number(3)}, values);
    if (line.integer(0) < 0 || !out.cameras.emplace(line.integer(0), camera).second)
      line.fail("has the number of another camera");
  }
}

// A name may hold blanks, so lines are not split there. The line after each image holds observations and may be empty.
void read_text_images(const fs::path& file, ColmapModel& out) {
  bool pose = true;
  std::size_t number = 0;
  for (const std::string& text : read_lines(file)) {
    ++number;
    if (text.starts_with('#')) continue;
    if (!pose) {
      pose = true;
      continue;
    }
    if (split_words(text).empty()) continue;
    const TextLine line(file, number, text);
    if (line.size() < 10) line.fail("is not an image", "IMAGE_ID QW QX QY QZ TX TY TZ CAMERA_ID NAME");
    std::array<double, 7> values{};
    for (std::size_t i = 0; i < 7; ++i) values[i] = line.number(1 + i);
    std::string name = line.word(9);
    for (std::size_t i = 10; i < line.size(); ++i) name += " " + line.word(i);
    if (line.integer(8) < 0) line.fail("has no camera");
    out.images.push_back({name, static_cast<std::uint32_t>(line.integer(8)), to_pose(file, name, values)});
    pose = false;
  }
}

// Passes a cursor over the bytes of a binary file to `read`; throws InputError if the file is truncated.
template <class Read>
void read_binary(const fs::path& file, const Read& read) {
  const std::string bytes = read_file(file);
  bags::ByteCursor cursor(bytes);
  try {
    read(cursor);
  } catch (const std::out_of_range&) {
    throw InputError(file, "is truncated", "write the file again");
  }
}

template <std::size_t N>
std::array<double, N> take_numbers(bags::ByteCursor& cursor) {
  std::array<double, N> out;
  for (double& value : out) value = cursor.take<double>();
  return out;
}

void read_binary_cameras(const fs::path& file, ColmapModel& out) {
  read_binary(file, [&](bags::ByteCursor& cursor) {
    for (auto left = cursor.take<std::uint64_t>(); left > 0; --left) {
      const auto id = cursor.take<std::uint32_t>();
      const Model& model = find_model_by_id(file, cursor.take<std::int32_t>());
      const auto width = cursor.take<std::uint64_t>(), height = cursor.take<std::uint64_t>();
      std::vector<double> values(count_parameters(model));
      for (double& value : values) value = cursor.take<double>();
      out.cameras.emplace(id,
                          to_camera(file, model, cv::Size2d(static_cast<double>(width), static_cast<double>(height)), values));
    }
  });
}

void read_binary_images(const fs::path& file, ColmapModel& out) {
  constexpr std::uint64_t kObservationBytes = 24;
  read_binary(file, [&](bags::ByteCursor& cursor) {
    for (auto left = cursor.take<std::uint64_t>(); left > 0; --left) {
      cursor.take<std::uint32_t>();
      const auto values = take_numbers<7>(cursor);
      const auto camera = cursor.take<std::uint32_t>();
      std::string name;
      for (char c = cursor.take<char>(); c != '\0'; c = cursor.take<char>()) name += c;
      const auto observations = cursor.take<std::uint64_t>();
      if (observations > cursor.left() / kObservationBytes) throw std::out_of_range("observations");
      cursor.take(observations * kObservationBytes);
      out.images.push_back({name, camera, to_pose(file, name, values)});
    }
  });
}

fs::path find_file(const fs::path& folder, const char* name) {
  for (const char* ending : {".bin", ".txt"})
    if (const fs::path file = folder / (std::string(name) + ending); fs::exists(file)) return file;
  return {};
}

bool is_model(const fs::path& folder) { return !find_file(folder, "cameras").empty() && !find_file(folder, "images").empty(); }

// COLMAP names the folders of its models by numbers.
std::vector<fs::path> list_models(const fs::path& folder) {
  std::vector<fs::path> models;
  if (!fs::is_directory(folder)) return models;
  for (const auto& entry : fs::directory_iterator(folder))
    if (is_all_digits(entry.path().filename().string()) && is_model(entry.path())) models.push_back(entry.path());
  std::sort(models.begin(), models.end(),
            [](const fs::path& a, const fs::path& b) { return natural_less(a.filename().string(), b.filename().string()); });
  return models;
}

// A text file has two lines per image; a binary file begins with the number of images.
std::uint64_t count_images(const fs::path& folder) {
  const fs::path file = find_file(folder, "images");
  if (file.extension() == ".txt") return read_text_lines(file).size() / 2;
  std::uint64_t count = 0;
  require_regular_file(file, std::numeric_limits<std::uintmax_t>::max());
  std::ifstream(file, std::ios::binary).read(reinterpret_cast<char*>(&count), sizeof count);
  return count;
}

}  // namespace

std::vector<fs::path> list_colmap_models(const fs::path& workspace) {
  for (const fs::path& place : {workspace / "sparse", workspace}) {
    std::vector<fs::path> models = list_models(place);
    if (models.empty() && is_model(place)) models = {place};
    if (!models.empty()) return models;
  }
  return {};
}

fs::path find_colmap_model(const fs::path& workspace) {
  const std::vector<fs::path> models = list_colmap_models(workspace);
  if (models.size() < 2) return models.empty() ? fs::path() : models.front();
  std::vector<std::uint64_t> counts;
  for (const fs::path& model : models) counts.push_back(count_images(model));
  return models[static_cast<std::size_t>(std::max_element(counts.begin(), counts.end()) - counts.begin())];
}

ColmapModel read_colmap_model(const fs::path& folder) {
  ColmapModel out;
  const fs::path cameras = find_file(folder, "cameras"), images = find_file(folder, "images");
  cameras.extension() == ".bin" ? read_binary_cameras(cameras, out) : read_text_cameras(cameras, out);
  images.extension() == ".bin" ? read_binary_images(images, out) : read_text_images(images, out);
  if (out.images.empty()) throw InputError(images, "holds no images");
  std::sort(out.images.begin(), out.images.end(), [](const auto& a, const auto& b) { return a.name < b.name; });
  for (std::size_t i = 0; i < out.images.size(); ++i) {
    const ColmapImage& image = out.images[i];
    if (!out.cameras.contains(image.camera))
      throw InputError(images, fmt::format("{} is of camera {}, which {} does not have", image.name, image.camera,
                                           cameras.filename().string()));
    if (i > 0 && image.name == out.images[i - 1].name) throw InputError(images, "names " + image.name + " twice");
  }
  out.files = {cameras, images};
  return out;
}

fs::path find_colmap_points_file(const fs::path& folder) { return find_file(folder, "points3D"); }

media::PointCloud read_colmap_points(const fs::path& file) {
  media::PointCloud cloud;
  if (file.extension() == ".bin") {
    constexpr std::uint64_t kColorAndErrorBytes = 3 + 8, kTrackElementBytes = 8;
    read_binary(file, [&](bags::ByteCursor& cursor) {
      for (auto left = cursor.take<std::uint64_t>(); left > 0; --left) {
        cursor.take<std::uint64_t>();
        cloud.add(Eigen::Vector3d(take_numbers<3>(cursor).data()), 0);
        cursor.take(kColorAndErrorBytes);
        const auto track = cursor.take<std::uint64_t>();
        if (track > cursor.left() / kTrackElementBytes) throw std::out_of_range("track");
        cursor.take(track * kTrackElementBytes);
      }
    });
  } else {
    for (const TextLine& line : read_text_lines(file)) {
      if (line.size() < 8) line.fail("is not a point", "POINT3D_ID X Y Z R G B ERROR TRACK...");
      cloud.add({line.number(1), line.number(2), line.number(3)}, 0);
    }
  }
  if (cloud.points.empty()) throw InputError(file, "holds no points");
  if (std::any_of(cloud.points.begin(), cloud.points.end(), [](const auto& p) { return !p.allFinite(); }))
    throw InputError(file, "holds points with coordinates that are not finite", "remove these points");
  return cloud;
}

}  // namespace dvi::datasets
