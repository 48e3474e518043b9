#include <algorithm>
#include <fstream>
#include <functional>
#include <map>
#include <optional>
#include <set>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include "dvi/core/error.h"
#include "dvi/core/text.h"
#include "dvi/datasets/box_track.h"
#include "dvi/datasets/camera_choice.h"
#include "dvi/datasets/drive_config.h"
#include "dvi/datasets/reader.h"
#include "dvi/geometry/plausible.h"
#include "dvi/media/point_cloud.h"

namespace dvi::datasets {
namespace {

using nlohmann::json;

constexpr std::int64_t kNsPerMicrosecond = 1000, kRevolutionNs = 50'000'000;  // 20 scans per second

// The axes of the data set's LiDAR are x right, y forward; those of dvi are x forward, y left.
SE3 lidar_from_theirs() { return {(Eigen::Matrix3d() << 0, 1, 0, -1, 0, 0, 0, 0, 1).finished(), {0, 0, 0}}; }

// The tables of one version of the data set.
class NuscenesTables {
 public:
  explicit NuscenesTables(fs::path folder) : folder_(std::move(folder)) {}

  fs::path file(const std::string& table) const { return folder_ / (table + ".json"); }

  // Passes each row to `take`. The file is never held as a whole, since sample_data of all scenes has more than a gigabyte.
  void for_each(const std::string& table, const std::function<void(const json&)>& take) const {
    const fs::path path = file(table);
    require_regular_file(path, std::numeric_limits<std::uintmax_t>::max());
    std::ifstream stream(path, std::ios::binary);
    std::size_t row = 0;
    const auto on_event = [&](int depth, json::parse_event_t event, json& value) {
      if (depth != 1 || event != json::parse_event_t::object_end) return true;
      ++row;
      take(value);
      return false;
    };
    try {
      if (!json::parse(stream, on_event).is_array()) throw std::invalid_argument("it is not a list of rows");
    } catch (const InputError&) {
      throw;
    } catch (const std::exception& e) {  // the JSON library throws several types
      throw InputError(path, fmt::format("row {}: {}", row, e.what()), "use the file as published by nuScenes");
    }
  }

  // Returns the rows of the given tokens. Throws InputError if one is missing, with the table `from` that refers to it.
  std::map<std::string, json> rows(const std::string& table, const std::set<std::string>& tokens,
                                   const std::string& from) const {
    std::map<std::string, json> out;
    for_each(table, [&](const json& row) {
      if (const auto token = row.at("token").get<std::string>(); tokens.contains(token)) out[token] = row;
    });
    for (const std::string& token : tokens)
      if (!out.contains(token))
        throw InputError(file(from), fmt::format("refers to token '{}', which {}.json does not have", token, table),
                         "use all tables of the same version of nuScenes");
    return out;
  }

 private:
  fs::path folder_;
};

SE3 parse_rigid(const json& row) {
  const auto q = row.at("rotation").get<std::array<double, 4>>();
  const auto t = row.at("translation").get<std::array<double, 3>>();
  const Eigen::Quaterniond rotation(q[0], q[1], q[2], q[3]);
  if (!(std::abs(rotation.norm() - 1) <= kMaxRotationError))
    throw std::invalid_argument(fmt::format("the quaternion of a rotation has length {:.4g} instead of 1", rotation.norm()));
  return {rotation.normalized().toRotationMatrix(), {t[0], t[1], t[2]}};
}

std::int64_t read_time_ns(const json& row) {
  const auto time_us = row.at("timestamp").get<std::int64_t>();
  if (time_us < 0 || time_us > kLatestSecond * 1'000'000)
    throw std::invalid_argument(fmt::format("the timestamp {} is not a time in microseconds", time_us));
  return time_us * kNsPerMicrosecond;
}

// One image or scan.
struct SensorData {
  std::string file, ego_pose, calibration;
  std::int64_t time_ns = 0;
  cv::Size size;
};

// The contents of one scene of the data set.
struct NuscenesScene {
  std::map<std::string, std::vector<SensorData>> channels;  // in order of time
  std::map<std::string, SE3> ego_from_sensor;               // by channel
  std::map<std::string, std::array<double, 9>> K;
  std::map<std::string, SE3> world_from_ego;      // by token of the ego pose
  std::map<std::string, std::int64_t> key_times;  // by token of the sample, ns
};

std::set<std::string> collect_tokens(const NuscenesScene& scene, std::string SensorData::* member) {
  std::set<std::string> out;
  for (const auto& [channel, list] : scene.channels)
    for (const SensorData& data : list) out.insert(data.*member);
  return out;
}

void read_samples(const NuscenesTables& tables, const std::string& scene_token, NuscenesScene& scene) {
  tables.for_each("sample", [&](const json& row) {
    if (row.at("scene_token") == scene_token) scene.key_times[row.at("token").get<std::string>()] = read_time_ns(row);
  });
}

// Reads key frames and the data between them.
void read_sample_data(const NuscenesTables& tables, NuscenesScene& scene) {
  std::map<std::string, std::vector<SensorData>> by_calibration;
  tables.for_each("sample_data", [&](const json& row) {
    if (!scene.key_times.contains(row.at("sample_token").get<std::string>())) return;
    const auto calibration = row.at("calibrated_sensor_token").get<std::string>();
    by_calibration[calibration].push_back({row.at("filename").get<std::string>(), row.at("ego_pose_token").get<std::string>(),
                                           calibration, read_time_ns(row),
                                           cv::Size(row.value("width", 0), row.value("height", 0))});
  });
  std::set<std::string> calibrations, sensors;
  for (const auto& [token, list] : by_calibration) calibrations.insert(token);
  const auto calibrated = tables.rows("calibrated_sensor", calibrations, "sample_data");
  for (const auto& [token, row] : calibrated) sensors.insert(row.at("sensor_token").get<std::string>());
  const auto sensor_rows = tables.rows("sensor", sensors, "calibrated_sensor");
  for (auto& [token, list] : by_calibration) {
    const json& row = calibrated.at(token);
    const auto channel = sensor_rows.at(row.at("sensor_token").get<std::string>()).at("channel").get<std::string>();
    if (channel != "LIDAR_TOP" && !channel.starts_with("CAM_")) continue;
    try {
      scene.ego_from_sensor[channel] = parse_rigid(row);
      if (channel.starts_with("CAM_")) {
        const auto K = row.at("camera_intrinsic").get<std::array<std::array<double, 3>, 3>>();
        for (std::size_t i = 0; i < 9; ++i) scene.K[channel][i] = K[i / 3][i % 3];
        if (const std::string problem = describe_camera_matrix_problem(scene.K[channel]); !problem.empty())
          throw std::invalid_argument("camera_intrinsic " + problem);
      }
    } catch (const std::exception& e) {
      throw InputError(tables.file("calibrated_sensor"), fmt::format("token '{}' of {}: {}", token, channel, e.what()));
    }
    std::sort(list.begin(), list.end(), [](const SensorData& a, const SensorData& b) { return a.time_ns < b.time_ns; });
    scene.channels[channel] = std::move(list);
  }
}

void read_ego_poses(const NuscenesTables& tables, NuscenesScene& scene) {
  for (const auto& [token, row] : tables.rows("ego_pose", collect_tokens(scene, &SensorData::ego_pose), "sample_data")) try {
      scene.world_from_ego[token] = parse_rigid(row);
    } catch (const std::exception& e) {
      throw InputError(tables.file("ego_pose"), fmt::format("token '{}': {}", token, e.what()));
    }
}

// Converts "vehicle.bus.rigid" to bus and "human.pedestrian.adult" to pedestrian; returns nothing for permanent objects.
std::optional<std::string> find_traffic_type(const std::string& category) {
  if (category == "animal") return category;
  if (!category.starts_with("vehicle.") && !category.starts_with("human.")) return std::nullopt;
  const std::size_t first = category.find('.') + 1;
  return category.substr(first, category.find('.', first) - first);
}

std::vector<BoxTrack> read_tracks(const NuscenesTables& tables, const NuscenesScene& scene) {
  std::map<std::string, std::map<std::int64_t, Box>> by_instance;
  tables.for_each("sample_annotation", [&](const json& row) {
    const auto sample = scene.key_times.find(row.at("sample_token").get<std::string>());
    if (sample == scene.key_times.end()) return;
    const auto size = row.at("size").get<std::array<double, 3>>();  // width, length, height
    by_instance[row.at("instance_token").get<std::string>()][sample->second] = {parse_rigid(row), {size[1], size[0], size[2]}};
  });
  std::set<std::string> instances, categories;
  for (const auto& [token, boxes] : by_instance) instances.insert(token);
  const auto instance_rows = tables.rows("instance", instances, "sample_annotation");
  for (const auto& [token, row] : instance_rows) categories.insert(row.at("category_token").get<std::string>());
  const auto category_rows = tables.rows("category", categories, "instance");
  std::vector<BoxTrack> tracks;
  for (auto& [token, boxes] : by_instance) {
    const std::string category = instance_rows.at(token).at("category_token").get<std::string>();
    if (const auto type = find_traffic_type(category_rows.at(category).at("name").get<std::string>()))
      tracks.push_back({static_cast<int>(tracks.size()), *type, std::move(boxes)});
  }
  return tracks;
}

void add_labels(const std::vector<BoxTrack>& tracks, Drive& drive) {
  for (Frame& frame : drive.frames) {
    const auto world_from_lidar = drive.poses.at(frame.time_ns);
    if (!world_from_lidar) continue;
    for (const BoxTrack& track : tracks)
      if (const auto box = track.at(frame.time_ns))
        frame.labels.push_back({.track = track.number,
                                .type = track.type,
                                .box = Box{world_from_lidar->inverse() * box->frame_from_box, box->size},
                                .rect = {},
                                .instance = {}});
  }
  if (const auto gaps = describe_gaps(tracks, drive)) drive.warnings.push_back(*gaps);
  drive.labeled = drive.labeled_around = true;
}

const media::BinLayout& nuscenes_layout() {
  static const media::BinLayout layout{.columns = {"x", "y", "z", "intensity", "ring"}, .stated = true};
  return layout;
}

// Reads a scan that is compensated for motion to its time, the end of its revolution.
Scan read_compensated_scan(const ScanHeader& header) {
  media::PointCloud cloud = media::read_point_cloud(header.file, nuscenes_layout());
  Scan scan;
  for (const Eigen::Vector3f& p : cloud.points) scan.points.emplace_back(p.y(), -p.x(), p.z());
  scan.intensity = std::move(cloud.intensity);
  scan.ring = std::move(cloud.ring);
  scan.file_points = cloud.file_points;
  scan.file_index = std::move(cloud.file_index);
  scan.time.assign(scan.size(), 0.0F);
  return scan;
}

// Adds the scans whose files exist, and a warning about the others.
void add_scan_headers(Drive& drive, const std::vector<SensorData>& scans, const fs::path& root, const fs::path& table) {
  std::vector<std::string> missing;
  for (const SensorData& scan : scans) {
    const fs::path file = root / scan.file;
    if (fs::exists(file))
      drive.scan_headers.push_back(
          {file.stem().stem().string(), scan.time_ns, scan.time_ns - kRevolutionNs, scan.time_ns, file});
    else
      missing.push_back(scan.file);
  }
  if (missing.empty()) return;
  const std::string first = fmt::format("{} of {} scans that it refers to are missing; the first is {}", missing.size(),
                                        scans.size(), missing.front());
  if (drive.scan_headers.empty()) throw InputError(table, first, "unpack the samples and sweeps of this scene");
  drive.warnings.push_back(fmt::format("{}: {}", table.filename().string(), first));
}

std::optional<fs::path> find_version_folder(const fs::path& root) {
  if (fs::exists(root / "sample_data.json") && fs::exists(root / "scene.json")) return root;
  std::vector<fs::path> found;
  if (!fs::is_directory(root)) return std::nullopt;
  for (const auto& entry : fs::directory_iterator(root, fs::directory_options::skip_permission_denied))
    if (entry.path().filename().string().starts_with("v1.0-") && fs::exists(entry.path() / "sample_data.json"))
      found.push_back(entry.path());
  std::sort(found.begin(), found.end());
  return found.empty() ? std::nullopt : std::optional(found.front());
}

// The scene that a path selects. ROOT/scene-0061 is not a folder, since the scenes of the data set share its folders.
struct SceneChoice {
  fs::path version, root;
  std::string scene;  // empty: the only scene
};

std::optional<SceneChoice> choose_scene(const fs::path& path) {
  const bool whole = fs::is_directory(path);
  const fs::path place = whole ? path : path.parent_path();
  const auto version = find_version_folder(place);
  if (!version) return std::nullopt;
  return SceneChoice{*version, version->parent_path(), whole ? "" : path.filename().string()};
}

std::string find_scene_token(const NuscenesTables& tables, const SceneChoice& choice) {
  std::map<std::string, std::string> scenes;
  tables.for_each("scene",
                  [&](const json& row) { scenes[row.at("name").get<std::string>()] = row.at("token").get<std::string>(); });
  if (choice.scene.empty() && scenes.size() == 1) return scenes.begin()->second;
  if (const auto scene = scenes.find(choice.scene); scene != scenes.end()) return scene->second;
  std::vector<std::string> names;
  for (const auto& [name, token] : scenes)
    if (names.size() < 20) names.push_back(name);
  throw InputError(tables.file("scene"),
                   choice.scene.empty() ? fmt::format("holds {} scenes", scenes.size()) : "has no scene " + choice.scene,
                   fmt::format("select a scene, such as {}/{}; the data set has {}{}", choice.root.string(),
                               names.empty() ? "SCENE" : names.front(), fmt::join(names, ", "),
                               names.size() < scenes.size() ? " and more" : ""));
}

DriveContents read_nuscenes(const fs::path& path, const ReadOptions& options) {
  const SceneChoice choice = *choose_scene(path);
  const NuscenesTables tables(choice.version);
  NuscenesScene scene;
  read_samples(tables, find_scene_token(tables, choice), scene);
  if (scene.key_times.empty()) throw InputError(tables.file("sample"), "has no sample of the scene");
  read_sample_data(tables, scene);
  read_ego_poses(tables, scene);

  DriveContents recording;
  Drive& drive = recording.drive;
  drive.path = path;
  for (const auto& [channel, list] : scene.channels)
    if (channel.starts_with("CAM_")) drive.camera_names.push_back(channel);
  if (drive.camera_names.empty()) throw InputError(tables.file("sample_data"), "has no images of the scene");
  drive.camera_name = choose_camera(drive, options.camera, "CAM_FRONT");
  if (!scene.channels.contains("LIDAR_TOP"))
    throw InputError(tables.file("sample_data"), "has no LIDAR_TOP scans of the scene");

  const SE3 ego_from_lidar = scene.ego_from_sensor.at("LIDAR_TOP") * lidar_from_theirs().inverse();
  const std::array<double, 9>& K = scene.K.at(drive.camera_name);
  const std::vector<SensorData>& images = scene.channels.at(drive.camera_name);
  drive.camera = {
      .width = images.front().size.width, .height = images.front().size.height, .fx = K[0], .fy = K[4], .cx = K[2], .cy = K[5]};
  require_plausible(drive.camera, tables.file("calibrated_sensor"), drive.camera_name);
  drive.camera_from_lidar = scene.ego_from_sensor.at(drive.camera_name).inverse() * ego_from_lidar;
  for (const SensorData& image : images)
    drive.frames.push_back({static_cast<int>(drive.frames.size()),
                            fs::path(image.file).stem().string(),
                            image.time_ns,
                            choice.root / image.file,
                            {}});
  add_scan_headers(drive, scene.channels.at("LIDAR_TOP"), choice.root, tables.file("sample_data"));
  std::vector<StampedPose> poses;
  for (const auto& [channel, list] : scene.channels)
    for (const SensorData& data : list)
      poses.push_back({data.time_ns, scene.world_from_ego.at(data.ego_pose) * ego_from_lidar});
  drive.poses = Trajectory(std::move(poses));
  for (const char* table : {"scene", "sample", "sample_data", "calibrated_sensor", "sensor", "ego_pose"})
    drive.other_files.push_back(tables.file(table));
  if (const auto config = read_drive_config(choice.root)) config->apply(drive);
  if (fs::exists(tables.file("sample_annotation"))) {
    add_labels(read_tracks(tables, scene), drive);
    for (const char* table : {"sample_annotation", "instance", "category"}) drive.other_files.push_back(tables.file(table));
  }
  for (const Frame& frame : drive.frames)
    if (!fs::exists(frame.file))
      throw InputError(tables.file("sample_data"), "refers to " + frame.file.string() + ", which does not exist",
                       "unpack the samples and sweeps of this scene");
  recording.point_bytes = nuscenes_layout().shape().point_bytes();
  recording.read_scan = read_compensated_scan;
  return recording;
}

}  // namespace

DriveFormat nuscenes_format() {
  return {"nuscenes",
          "a folder with v1.0-*/sample_data.json, samples and sweeps; FOLDER/scene-0061 names one of its scenes",
          [](const fs::path& path) { return choose_scene(path).has_value(); },
          read_nuscenes,
          {"samples", "sweeps", "v1.0-mini/sample_data.json|v1.0-trainval/sample_data.json|v1.0-test/sample_data.json"}};
}

}  // namespace dvi::datasets
