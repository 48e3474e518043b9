#include "dvi/datasets/drive_config.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string_view>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <toml++/toml.h>

#include "dvi/core/error.h"
#include "dvi/core/text.h"
#include "dvi/core/toml_file.h"
#include "dvi/geometry/angles.h"
#include "dvi/geometry/plausible.h"
#include "dvi/geometry/rigid.h"
#include "dvi/media/image_file.h"

namespace dvi::datasets {
namespace {

constexpr int kVersion = 1;
constexpr double kMaxXi = 10;

// Returns the numbers of a list, or of a list of rows, in order; nothing if it holds anything else.
std::vector<double> finite_numbers(const toml::node& node) {
  std::vector<double> out;
  if (const toml::array* list = node.as_array()) {
    for (const toml::node& item : *list) {
      const std::vector<double> row = finite_numbers(item);
      if (row.empty()) return {};
      out.insert(out.end(), row.begin(), row.end());
    }
  } else if (const auto value = node.value<double>(); value && std::isfinite(*value)) {
    out.push_back(*value);
  }
  return out;
}

// Returns the table of a key, which is empty if the key is missing.
const toml::table& to_table(const fs::path& file, const toml::node* node, std::string_view name) {
  static const toml::table none;
  if (node && !node->is_table())
    throw InputError(fmt::format("{}:{}", file.string(), node->source().begin.line), fmt::format("'{}' is not a table", name),
                     fmt::format("write [{}]", name));
  return node ? *node->as_table() : none;
}

// One table of the file, which is empty if its key is missing. Its errors name file and line.
class Table {
 public:
  Table(const fs::path& file, std::string name, const toml::node* table, std::vector<std::string> keys)
      : file_(file), name_(std::move(name)), table_(&to_table(file, table, name_)) {
    for (const auto& [key, node] : *table_)
      if (std::find(keys.begin(), keys.end(), key.str()) == keys.end())
        fail(node, fmt::format("{} has no key '{}'", name_.empty() ? "the file" : "[" + name_ + "]", key.str()),
             fmt::format("it has {}", fmt::join(keys, ", ")));
  }

  std::optional<double> number(const char* key) const {
    const toml::node* node = table_->get(key);
    if (!node) return std::nullopt;
    const auto value = node->value<double>();
    if (!value || !std::isfinite(*value)) fail(*node, fmt::format("'{}' is not a number", key));
    return value;
  }
  template <std::size_t N>
  std::optional<std::array<double, N>> numbers(const char* key) const {
    const toml::node* node = table_->get(key);
    if (!node) return std::nullopt;
    const std::vector<double> list = finite_numbers(*node);
    if (list.size() != N) fail(*node, fmt::format("'{}' is not a list of {} numbers", key, N));
    std::array<double, N> out{};
    std::copy(list.begin(), list.end(), out.begin());
    return out;
  }
  /// Returns a matrix of 3 rows and 4 columns, which may have a fourth row of 0 0 0 1.
  std::optional<std::array<double, 12>> rows_of_four(const char* key) const {
    const toml::node* node = table_->get(key);
    if (node && finite_numbers(*node).size() == 16) {
      const auto all = *numbers<16>(key);
      if (all[12] != 0 || all[13] != 0 || all[14] != 0 || all[15] != 1)
        fail(*node, fmt::format("the fourth row of '{}' is not 0, 0, 0, 1; the matrix may be transposed", key));
      std::array<double, 12> out;
      std::copy_n(all.begin(), 12, out.begin());
      return out;
    }
    return numbers<12>(key);
  }
  /// Returns the index of a word among `words`.
  std::optional<std::size_t> choice(const char* key, const std::vector<std::string>& words) const {
    const toml::node* node = table_->get(key);
    if (!node) return std::nullopt;
    const auto word = std::find(words.begin(), words.end(), node->value_or(std::string()));
    if (word == words.end()) fail(*node, fmt::format("'{}' is not one of {}", key, fmt::join(words, ", ")));
    return static_cast<std::size_t>(word - words.begin());
  }
  std::optional<std::string> text(const char* key) const {
    const toml::node* node = table_->get(key);
    if (!node) return std::nullopt;
    if (!node->is_string()) fail(*node, fmt::format("'{}' is not a text", key));
    return node->as_string()->get();
  }
  bool has(const char* key) const { return table_->contains(key); }
  /// Returns the key of the camera model, which has two names.
  const char* model_key() const { return has("model") ? "model" : "distortion_model"; }
  /// Returns a list of numbers; an empty list if there is none.
  std::vector<double> list(const char* key) const {
    const toml::node* node = table_->get(key);
    if (!node) return {};
    std::vector<double> out = finite_numbers(*node);
    if (!node->is_array() || (out.empty() && !node->as_array()->empty()))
      fail(*node, fmt::format("'{}' is not a list of numbers", key));
    return out;
  }
  /// Returns a list of words; an empty list if there is none.
  std::vector<std::string> words(const char* key) const {
    const toml::node* node = table_->get(key);
    if (!node) return {};
    std::vector<std::string> out;
    if (const toml::array* list = node->as_array())
      for (const toml::node& word : *list) out.push_back(word.value_or(std::string()));
    if (out.empty() || std::find(out.begin(), out.end(), "") != out.end())
      fail(*node, fmt::format("'{}' is not a list of names", key));
    return out;
  }
  [[noreturn]] void fail(const char* key, const std::string& problem, const std::string& remedy = {}) const {
    fail(*table_->get(key), fmt::format("'{}' {}", key, problem), remedy);
  }

 private:
  [[noreturn]] void fail(const toml::node& node, const std::string& problem, const std::string& remedy = {}) const {
    throw InputError(fmt::format("{}:{}", file_.string(), node.source().begin.line), problem, remedy);
  }

  fs::path file_;
  std::string name_;
  const toml::table* table_;
};

std::int64_t read_offset_ns(const Table& table) {
  const double seconds = table.number("offset_s").value_or(0);
  if (!(std::abs(seconds) < kMaxOffsetS)) table.fail("offset_s", "is not an offset in seconds");
  return std::llround(seconds * 1e9);
}

std::optional<cv::Size> read_size(const Table& table) {
  const auto size = table.numbers<2>("size");
  if (!size) return std::nullopt;
  constexpr double kMaxSidePx = 1 << 20;
  for (const double side : *size)
    if (!(side >= 1 && side <= kMaxSidePx && side == std::floor(side)))
      table.fail("size", "is not [width, height] in whole pixels");
  if ((*size)[0] * (*size)[1] > static_cast<double>(kMaxPixels))
    table.fail("size", fmt::format("is {:.0f}x{:.0f}, above the limit of 2^28 pixels", (*size)[0], (*size)[1]));
  return cv::Size(static_cast<int>((*size)[0]), static_cast<int>((*size)[1]));
}

std::optional<std::array<double, 9>> read_intrinsics(const Table& table) {
  const auto K = table.numbers<9>("K");
  if (K)
    if (const std::string problem = describe_camera_matrix_problem(*K); !problem.empty()) table.fail("K", problem);
  return K;
}

std::optional<SE3> read_rigid(const Table& table, const char* key) {
  const auto m = table.rows_of_four(key);
  if (!m) return std::nullopt;
  const std::optional<SE3> motion = to_rigid(*m);
  if (!motion)
    table.fail(key, describe_rotation_problem(get_left_part(*m)) + "; it is a 3x4 matrix, row by row, each row r r r t");
  return motion;
}

constexpr const char* kModels = "models are pinhole, fisheye, unified, equirectangular, and cylindrical";

// Reads the model. Kalibr states a fisheye lens by the model of its distortion, and other cameras by the camera's.
std::optional<CameraModel> read_camera_model(const Table& table) {
  std::optional<CameraModel> out;
  for (const char* key : {"model", "distortion_model"}) {
    const std::optional<std::string> name = table.text(key);
    if (!name) continue;
    const std::optional<CameraModel> model = find_camera_model(*name);
    if (!model)
      table.fail(key, fmt::format("is '{}', which is not a known camera model", *name),
                 std::string(kModels) + "; undistort the images of other cameras first");
    if (!out || *model != CameraModel::pinhole) out = model;
  }
  return out;
}

std::optional<Lens> read_lens(const Table& table) {
  const std::optional<CameraModel> model = read_camera_model(table);
  const std::optional<double> xi = table.number("xi");
  const std::vector<double> coefficients = table.list("distortion");
  if (!model && coefficients.size() == 4)
    table.fail("distortion", "has 4 numbers, of a pinhole camera (k1, k2, p1, p2) or of a fisheye lens (k1 to k4)",
               "add model = \"pinhole\" or model = \"fisheye\"");
  const CameraModel known = model.value_or(CameraModel::pinhole);
  if (const std::string problem = describe_lens_problem(known, coefficients); !problem.empty())
    table.fail("distortion", problem, "undistort the images first if the camera has another model");
  if (xi && known != CameraModel::unified) table.fail("xi", "is given, but the model is not \"unified\"");
  if (known == CameraModel::unified && !(xi && *xi >= 0 && *xi <= kMaxXi))
    table.fail(xi ? "xi" : table.model_key(), "needs xi, between 0 and 10", "copy xi of the calibration, such as xi = 2.2");
  if (!model && !table.has("distortion")) return std::nullopt;
  return make_lens(known, coefficients, xi.value_or(0));
}

// Returns the matrix of a panorama of the whole sphere, unless K is given.
std::optional<std::array<double, 9>> read_camera_matrix(const Table& table, const std::optional<Lens>& lens,
                                                        const std::optional<cv::Size>& size) {
  const auto K = read_intrinsics(table);
  if (K || !lens || lens->model != CameraModel::equirectangular) return K;
  if (!size || size->width != 2 * size->height)
    table.fail(table.model_key(),
               "needs K (pixels per radian), unless size is [width, height] of a panorama of the whole sphere",
               "a panorama of the whole sphere is twice as wide as high");
  const double f = size->width / (2 * std::numbers::pi);
  return std::array<double, 9>{f, 0, 0.5 * (size->width - 1), 0, f, 0.5 * (size->height - 1), 0, 0, 1};
}

CameraConfig read_camera(const Table& table) {
  const std::optional<cv::Size> size = read_size(table);
  const std::optional<Lens> lens = read_lens(table);
  return {size, read_camera_matrix(table, lens, size), lens, read_rigid(table, "camera_from_lidar"), read_offset_ns(table)};
}

std::optional<double> read_units(const Table& table) {
  const auto units = table.number("units_per_meter");
  if (units && !(*units >= 1 && *units <= 1e6))
    table.fail("units_per_meter", "is not between 1 and 1000000, such as 1000 for millimeters");
  return units;
}

DepthConfig read_depth(const Table& table) {
  DepthConfig depth{read_intrinsics(table), read_lens(table), read_rigid(table, "depth_from_color"), read_units(table)};
  if (depth.lens && depth.lens->model != CameraModel::pinhole)
    table.fail(table.model_key(), "is not pinhole, but depth images are of pinhole cameras");
  if (table.has("distortion") && !depth.K)
    table.fail("distortion", "needs K, because it means that the depth images have their own camera");
  return depth;
}

std::vector<std::string> read_columns(const Table& table) {
  constexpr std::size_t kMaxNames = 64;
  std::vector<std::string> columns = table.words("columns");
  if (columns.size() > kMaxNames) table.fail("columns", "has more than 64 names");
  for (const char* axis : {"x", "y", "z"})
    if (!columns.empty() && std::count(columns.begin(), columns.end(), axis) != 1)
      table.fail(
          "columns",
          fmt::format("does not have '{}' exactly once; an example is [\"x\", \"y\", \"z\", \"intensity\", \"ring\"]", axis));
  return columns;
}

LidarConfig read_lidar(const Table& table) {
  LidarConfig lidar;
  lidar.rate = table.number("rate").value_or(lidar.rate);
  if (!(lidar.rate >= 0.1 && lidar.rate <= 1000)) table.fail("rate", "is not a rate between 0.1 and 1000 scans per second");
  if (const auto sensor = table.choice("sensor", {"lidar", "depth_camera"})) lidar.sensor = Sensor(*sensor);
  if (const auto stamp = table.choice("stamp", {"start", "middle", "end"})) lidar.stamp = LidarConfig::Stamp(*stamp);
  if (const auto turn = table.choice("rotation", {"clockwise", "counterclockwise", "none"})) lidar.turn = Turn(*turn);
  if (const auto azimuth = table.number("first_azimuth_deg")) lidar.first_azimuth = *azimuth * kRadPerDegree;
  lidar.offset_ns = read_offset_ns(table);
  lidar.columns = read_columns(table);
  lidar.units_per_meter = read_units(table).value_or(lidar.units_per_meter);
  return lidar;
}

}  // namespace

std::optional<DriveConfig> read_drive_config(const fs::path& drive) {
  DriveConfig config;
  config.file = drive / "dvi.toml";
  if (!fs::exists(config.file)) return std::nullopt;
  const toml::table root = read_toml(config.file);
  const Table whole(config.file, "", &root, {"drive", "camera", "lidar", "depth"});
  const Table head(config.file, "drive", root.get("drive"), {"version", "camera"});
  if (const auto version = head.number("version"); version && *version != kVersion)
    head.fail("version", fmt::format("is {}, but this program reads version {}", *version, kVersion));
  for (const auto& [name, node] : to_table(config.file, root.get("camera"), "camera")) {
    require_plain_name(std::string(name.str()), config.file, "a camera");
    config.cameras[std::string(name.str())] =
        read_camera(Table(config.file, fmt::format("camera.{}", name.str()), &node,
                          {"size", "K", "distortion", "model", "distortion_model", "xi", "camera_from_lidar", "offset_s"}));
  }
  std::vector<std::string> names;
  for (const auto& [name, camera] : config.cameras) names.push_back(name);
  if (const auto place = head.choice("camera", names)) config.usual_camera = names[*place];
  config.lidar = read_lidar(
      Table(config.file, "lidar", root.get("lidar"),
            {"rate", "sensor", "beams", "stamp", "rotation", "first_azimuth_deg", "offset_s", "columns", "units_per_meter"}));
  config.depth = read_depth(Table(config.file, "depth", root.get("depth"),
                                  {"K", "distortion", "model", "distortion_model", "depth_from_color", "units_per_meter"}));
  return config;
}

void DepthConfig::apply(DepthCamera& depth) const {
  if (K) {
    depth.camera = Camera{.fx = (*K)[0], .fy = (*K)[4], .cx = (*K)[2], .cy = (*K)[5]};
    if (lens) depth.camera->set_lens(*lens);
  }
  if (depth_from_color) depth.depth_from_color = depth_from_color;
  if (units_per_meter) depth.units_per_meter = *units_per_meter;
}

void CameraConfig::apply(Drive& drive) const {
  Camera& camera = drive.camera;
  if (size) camera.width = size->width, camera.height = size->height;
  if (K) camera.fx = (*K)[0], camera.cx = (*K)[2], camera.fy = (*K)[4], camera.cy = (*K)[5];
  if (lens) camera.set_lens(*lens);
  if (camera_from_lidar) drive.camera_from_lidar = *camera_from_lidar;
  for (Frame& frame : drive.frames) frame.time_ns += offset_ns;
}

void LidarConfig::apply(Drive& drive) const {
  if (sensor) drive.sensor = *sensor;
  for (ScanHeader& header : drive.scan_headers)
    header.time_ns += offset_ns, header.start_ns += offset_ns, header.end_ns += offset_ns;
}

void DriveConfig::require_plausible(const Drive& drive) const {
  const CameraConfig ours = camera(drive.camera_name);
  if (ours.K || ours.size) dvi::require_plausible(drive.camera, file, fmt::format("[camera.{}]", drive.camera_name));
}

CameraConfig DriveConfig::camera(const std::string& name) const {
  const auto found = cameras.find(name);
  return found == cameras.end() ? CameraConfig{} : found->second;
}

void DriveConfig::apply(Drive& drive) const {
  if (!usual_camera.empty())
    throw InputError(file, "[drive] camera is supported in the plain layout only", "name the camera with --camera");
  for (const auto& [name, config] : cameras)
    if (std::find(drive.camera_names.begin(), drive.camera_names.end(), name) == drive.camera_names.end())
      throw InputError(file, fmt::format("[camera.{}] is not a camera of this drive", name),
                       fmt::format("it has {}", fmt::join(drive.camera_names, ", ")));
  camera(drive.camera_name).apply(drive);
  require_plausible(drive);
  lidar.apply(drive);
  drive.other_files.push_back(file);
}

}  // namespace dvi::datasets
