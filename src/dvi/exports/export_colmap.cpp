#include <cmath>
#include <fstream>

#include <fmt/format.h>

#include "dvi/core/threads.h"
#include "dvi/exports/exporter.h"
#include "dvi/exports/map_cloud.h"
#include "dvi/exports/scene_files.h"

namespace dvi::exports {
namespace {

// COLMAP puts the center of the first pixel at (0.5, 0.5).
constexpr double kPixelCenter = 0.5;
// Points that get a track, the list of images that see them, which dense reconstruction chooses its images by. All points would
// make text of gigabytes.
constexpr std::size_t kTracked = 20'000;

std::string camera_line(const Camera& c) {
  const std::string pinhole = fmt::format("{} {} {:.12g} {:.12g} {:.12g} {:.12g}", c.width, c.height, c.fx, c.fy,
                                          c.cx + kPixelCenter, c.cy + kPixelCenter);
  if (!c.distorted()) return fmt::format("1 PINHOLE {}\n", pinhole);
  const auto& [k1, k2, p1, p2, k3] = c.distortion;
  if (k3 == 0) return fmt::format("1 OPENCV {} {:.12g} {:.12g} {:.12g} {:.12g}\n", pinhole, k1, k2, p1, p2);
  return fmt::format("1 FULL_OPENCV {} {:.12g} {:.12g} {:.12g} {:.12g} {:.12g} 0 0 0\n", pinhole, k1, k2, p1, p2, k3);
}

// Where an image sees a point.
struct Observation {
  std::size_t point = 0;
  Eigen::Vector2d pixel;
};

// Of every nth point: those that the image shows where the depth of its pixel agrees.
std::vector<Observation> observations(const Result& result, std::size_t frame, const std::vector<CloudPoint>& cloud,
                                      std::size_t every) {
  constexpr double kTolerance = 0.02, kNearest = 0.5;  // part of the depth; meters
  const Camera& camera = result.camera();
  const SE3 camera_from_world = result.frames()[frame].world_from_camera.inverse();
  const cv::Mat1f depth = result.depth(frame);
  const cv::Mat1b evidence = result.evidence(frame);
  std::vector<Observation> seen;
  for (std::size_t i = 0; i < cloud.size(); i += every) {
    const Eigen::Vector3d x = camera_from_world * cloud[i].position.cast<double>();
    if (x.z() < kNearest || !camera.in_front(x)) continue;
    const Eigen::Vector2d pixel = camera.project(x);
    if (!camera.contains(pixel)) continue;
    const cv::Point nearest(cvRound(pixel.x()), cvRound(pixel.y()));
    if (evidence(nearest) != 0 && std::abs(depth(nearest) - x.z()) <= kTolerance * x.z()) seen.push_back({i, pixel});
  }
  return seen;
}

std::string image_lines(const ResultFrame& frame, std::size_t id, const std::vector<Observation>& seen) {
  const SE3 pose = frame.world_from_camera.inverse();
  const Eigen::Quaterniond q(pose.R);
  std::string text = fmt::format("{} {:.12g} {:.12g} {:.12g} {:.12g} {:.12g} {:.12g} {:.12g} 1 {}.png\n", id, q.w(), q.x(),
                                 q.y(), q.z(), pose.t.x(), pose.t.y(), pose.t.z(), frame.name);
  for (std::size_t i = 0; i < seen.size(); ++i)
    text += fmt::format("{}{:.2f} {:.2f} {}", i == 0 ? "" : " ", seen[i].pixel.x() + kPixelCenter,
                        seen[i].pixel.y() + kPixelCenter, seen[i].point + 1);
  return text + "\n";
}

void write_points(const fs::path& file, const std::vector<CloudPoint>& cloud, const std::vector<std::string>& tracks) {
  write_beside(file, [&](const fs::path& part) {
    std::ofstream out(part);
    out.exceptions(std::ios::failbit | std::ios::badbit);
    out << "# POINT3D_ID, X, Y, Z, R, G, B, ERROR, TRACK[] as (IMAGE_ID, POINT2D_IDX)\n";
    for (std::size_t i = 0; i < cloud.size(); ++i) {
      const CloudPoint& p = cloud[i];
      out << fmt::format("{} {:.4f} {:.4f} {:.4f} {} {} {} 0{}\n", i + 1, p.position.x(), p.position.y(), p.position.z(),
                         p.color[2], p.color[1], p.color[0], tracks[i]);
    }
  });
}

ExportReport write_colmap(const Result& result, const fs::path& folder, const ExportOptions& options, Progress& progress) {
  write_images_and_masks(result, folder, ".png.png", progress);
  std::vector<CloudPoint> cloud = read_map_cloud(result.folder() / "map/map.ply");
  std::erase_if(cloud, [](const CloudPoint& p) { return !p.colored(); });
  cloud = thinned(cloud, static_cast<std::size_t>(options.max_points));

  const std::size_t every = cloud.size() / kTracked + 1;
  std::vector<std::vector<Observation>> seen(result.frames().size());
  parallel_for(seen.size(), [&](std::size_t i) { seen[i] = observations(result, i, cloud, every); });
  std::string images = "# IMAGE_ID, QW, QX, QY, QZ, TX, TY, TZ, CAMERA_ID, NAME; then POINTS2D[] as (X, Y, POINT3D_ID)\n";
  std::vector<std::string> tracks(cloud.size());
  std::size_t observed = 0;
  for (std::size_t i = 0; i < seen.size(); ++i) {
    images += image_lines(result.frames()[i], i + 1, seen[i]);
    observed += seen[i].size();
    for (std::size_t k = 0; k < seen[i].size(); ++k) tracks[seen[i][k].point] += fmt::format(" {} {}", i + 1, k);
  }

  const fs::path model = folder / "sparse/0";
  make_folder(model);
  write_file(model / "cameras.txt", "# CAMERA_ID, MODEL, WIDTH, HEIGHT, PARAMS[]\n" + camera_line(result.camera()));
  write_file(model / "images.txt", images);
  write_points(model / "points3D.txt", cloud, tracks);
  return {{"sparse/0", "images", "masks"},
          {{"images", static_cast<double>(seen.size())},
           {"points", static_cast<double>(cloud.size())},
           {"observations", static_cast<double>(observed)}}};
}

}  // namespace

ExportFormat colmap_format() {
  return {"colmap", "text model in sparse/0 with the map as points, clean images, masks of unobserved pixels (COLMAP, gsplat)",
          write_colmap};
}

}  // namespace dvi::exports
