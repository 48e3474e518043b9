#include <algorithm>
#include <cmath>
#include <ostream>
#include <span>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "dvi/core/error.h"
#include "dvi/core/threads.h"
#include "dvi/exports/colmap_rigs.h"
#include "dvi/exports/exporter.h"
#include "dvi/exports/map_cloud.h"
#include "dvi/exports/scene_files.h"

namespace dvi::exports {
namespace {

// COLMAP's center of the first pixel is at (0.5, 0.5).
constexpr double kPixelCenterPx = 0.5;
// The number of points with a track, the list of images that observe them, from which dense reconstruction selects its images.
// Tracks of all points would make gigabytes of text.
constexpr std::size_t kMaxTracks = 20'000;

void require_known_model(const Result& result) {
  for (const ResultCamera& camera : result.cameras())
    if (const CameraModel model = camera.camera.model; model != CameraModel::pinhole && model != CameraModel::fisheye)
      throw InputError(result.folder(), fmt::format("COLMAP has no {} cameras, as {} is", to_string(model), camera.name),
                       "export the format mcap, ply, or las, which state the model or need none");
}

std::string format_camera(std::size_t id, const Camera& c) {
  const std::string pinhole = fmt::format("{} {} {:.12g} {:.12g} {:.12g} {:.12g}", c.width, c.height, c.fx, c.fy,
                                          c.cx + kPixelCenterPx, c.cy + kPixelCenterPx);
  if (!c.is_distorted()) return fmt::format("{} PINHOLE {}\n", id, pinhole);
  const std::span<const double> k(c.distortion);
  const auto with = [&](const char* model, std::size_t count) {
    return fmt::format("{} {} {} {:.12g}\n", id, model, pinhole, fmt::join(k.first(count), " "));
  };
  if (c.model == CameraModel::fisheye) return with("OPENCV_FISHEYE", 4);
  const auto others = k.subspan(4);
  const bool is_short = std::all_of(others.begin(), others.end(), [](double value) { return value == 0; });
  return is_short ? with("OPENCV", 4) : with("FULL_OPENCV", 8);
}

// The observation of a point in an image.
struct Observation {
  std::size_t point = 0;
  Eigen::Vector2d pixel;
};

// Returns the observations of every n-th point: those in the image whose depth agrees with that of their pixel.
std::vector<Observation> find_observations(const Result& result, std::size_t frame, const std::vector<CloudPoint>& cloud,
                                           std::size_t every) {
  constexpr double kMaxDepthError = 0.02, kMinDepthM = 0.5;  // the former relative to the depth
  const Camera& camera = result.camera(frame);
  const SE3 camera_from_world = result.frames()[frame].world_from_camera.inverse();
  const cv::Mat1f depth = result.depth(frame);
  const cv::Mat1b evidence = result.evidence(frame);
  std::vector<Observation> seen;
  for (std::size_t i = 0; i < cloud.size(); i += every) {
    const Eigen::Vector3d x = camera_from_world * cloud[i].position.cast<double>();
    const double depth_m = camera.depth(x);
    if (depth_m < kMinDepthM || !camera.in_front(x)) continue;
    const Eigen::Vector2d pixel = camera.project(x);
    if (!camera.contains(pixel)) continue;
    const cv::Point nearest(cvRound(pixel.x()), cvRound(pixel.y()));
    if (evidence(nearest) != 0 && std::abs(depth(nearest) - depth_m) <= kMaxDepthError * depth_m) seen.push_back({i, pixel});
  }
  return seen;
}

std::string format_image(const ResultFrame& frame, std::size_t id, const std::vector<Observation>& seen) {
  const SE3 pose = frame.world_from_camera.inverse();
  const Eigen::Quaterniond q(pose.R);
  std::string text = fmt::format("{} {:.12g} {:.12g} {:.12g} {:.12g} {:.12g} {:.12g} {:.12g} {} {}.png\n", id, q.w(), q.x(),
                                 q.y(), q.z(), pose.t.x(), pose.t.y(), pose.t.z(), frame.camera + 1, frame.name);
  for (std::size_t i = 0; i < seen.size(); ++i)
    text += fmt::format("{}{:.2f} {:.2f} {}", i == 0 ? "" : " ", seen[i].pixel.x() + kPixelCenterPx,
                        seen[i].pixel.y() + kPixelCenterPx, seen[i].point + 1);
  return text + "\n";
}

void write_points(const fs::path& file, const std::vector<CloudPoint>& cloud, const std::vector<std::string>& tracks) {
  write_stream(file, [&](std::ostream& out) {
    out << "# POINT3D_ID, X, Y, Z, R, G, B, ERROR, TRACK[] as (IMAGE_ID, POINT2D_IDX)\n";
    for (std::size_t i = 0; i < cloud.size(); ++i) {
      const CloudPoint& p = cloud[i];
      out << fmt::format("{} {:.4f} {:.4f} {:.4f} {} {} {} 0{}\n", i + 1, p.position.x(), p.position.y(), p.position.z(),
                         p.color[2], p.color[1], p.color[0], tracks[i]);
    }
  });
}

ExportReport write_colmap(const Result& result, const fs::path& folder, const ExportOptions& options, Progress& progress) {
  require_known_model(result);
  write_images_and_masks(result, folder, ".png.png", progress);
  std::vector<CloudPoint> cloud = read_map_cloud(result.folder() / "map/map.ply");
  std::erase_if(cloud, [](const CloudPoint& p) { return !p.colored(); });
  cloud = thin_cloud(cloud, static_cast<std::size_t>(options.max_points));

  const std::size_t every = cloud.size() / kMaxTracks + 1;
  std::vector<std::vector<Observation>> seen(result.frames().size());
  parallel_for(seen.size(), [&](std::size_t i) { seen[i] = find_observations(result, i, cloud, every); });
  std::string images = "# IMAGE_ID, QW, QX, QY, QZ, TX, TY, TZ, CAMERA_ID, NAME; then POINTS2D[] as (X, Y, POINT3D_ID)\n";
  std::vector<std::string> tracks(cloud.size());
  std::size_t observed = 0;
  for (std::size_t i = 0; i < seen.size(); ++i) {
    images += format_image(result.frames()[i], i + 1, seen[i]);
    observed += seen[i].size();
    for (std::size_t k = 0; k < seen[i].size(); ++k) tracks[seen[i][k].point] += fmt::format(" {} {}", i + 1, k);
  }

  const fs::path model = folder / "sparse/0";
  make_folder(model);
  std::string cameras = "# CAMERA_ID, MODEL, WIDTH, HEIGHT, PARAMS[]\n";
  for (std::size_t k = 0; k < result.cameras().size(); ++k) cameras += format_camera(k + 1, result.cameras()[k].camera);
  write_file(model / "cameras.txt", cameras);
  write_file(model / "images.txt", images);
  const ColmapRigs rigs = describe_rigs(result);
  write_file(model / "rigs.txt", rigs.rigs);
  write_file(model / "frames.txt", rigs.frames);
  write_points(model / "points3D.txt", cloud, tracks);
  return {{"sparse/0", "images", "masks"},
          {{"images", static_cast<double>(seen.size())},
           {"points", static_cast<double>(cloud.size())},
           {"observations", static_cast<double>(observed)}}};
}

}  // namespace

ExportFormat colmap_format() {
  return {"colmap",
          "text model in sparse/0 with the map as points, clean images, masks of unobserved pixels (COLMAP, gsplat)",
          write_colmap,
          {},
          {"export.max_points"}};
}

}  // namespace dvi::exports
