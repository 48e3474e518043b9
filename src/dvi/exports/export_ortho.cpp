#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include <opencv2/core.hpp>

#include "dvi/core/error.h"
#include "dvi/core/threads.h"
#include "dvi/exports/exporter.h"
#include "dvi/exports/geotiff.h"
#include "dvi/exports/ground_raster.h"
#include "dvi/exports/map_cloud.h"
#include "dvi/media/write_image.h"

namespace dvi::exports {
namespace {

constexpr float kNoValue = std::numeric_limits<float>::quiet_NaN();

// The image from above.
struct Ortho {
  cv::Mat3b color;
  cv::Mat1f source, age_s, confidence;
  cv::Mat1f distance;  // distance in meters of the camera whose pixel is used

  cv::Mat1b seen() const { return cv::Mat1b(distance < std::numeric_limits<float>::max()); }

  explicit Ortho(cv::Size size)
      : color(size, cv::Vec3b()),
        source(size, kNoValue),
        age_s(size, kNoValue),
        confidence(size, kNoValue),
        distance(size, std::numeric_limits<float>::max()) {}
};

// A frame with its provenance and confidence.
struct SeenFrame {
  cv::Mat3b image;
  cv::Mat1b evidence, kind, confidence;
  cv::Mat1f depth;
  cv::Mat_<cv::Vec3w> provenance;

  SeenFrame(const Result& result, std::size_t i)
      : image(result.image(i)),
        evidence(result.evidence(i)),
        kind(result.kind(i)),
        confidence(result.confidence(i)),
        depth(result.depth(i)),
        provenance(media::read_png_triples(result.picture("provenance", i), result.size(i))) {}

  // Returns the source frame of a pixel: the frame itself, or the one from which the pixel was copied.
  std::size_t source_at(cv::Point p, std::size_t own) const {
    return kind(p) == 0 || provenance(p)[0] == 0 ? own : std::size_t{provenance(p)[0]} - 1;
  }
  // Returns the confidence of a pixel; 1 for original pixels.
  float confidence_at(cv::Point p) const { return kind(p) == 0 ? 1.0F : static_cast<float>(confidence(p)) / 255; }
};

// Adds the cells that a frame observes and that no nearer frame observes, since a nearer camera has a higher resolution.
void add_frame(const Result& result, std::size_t number, const GroundRaster& ground, Ortho& ortho) {
  constexpr double kMinDepthM = 0.5, kMaxDistanceM = 40, kMaxDepthError = 0.03;  // the latter relative to the depth
  const ResultFrame& frame = result.frames()[number];
  const SeenFrame seen(result, number);
  const Camera& camera = result.camera(number);
  const SE3 camera_from_world = frame.world_from_camera.inverse();
  const Eigen::Vector3d& eye = frame.world_from_camera.t;
  const std::int64_t end_ns = result.frames().back().time_ns;
  const auto age_of = [&](std::size_t source) {  // other drives and cameras: only the age of the copy is known
    const std::int64_t time = source < result.frames().size() ? result.frames()[source].time_ns : frame.time_ns;
    return static_cast<float>(1e-9 * static_cast<double>(end_ns - time));
  };
  const auto bound = [&](double meters, int most) { return std::clamp(static_cast<int>(meters / ground.cell_m), 0, most); };
  const int top = bound(ground.north_m - eye.y() - kMaxDistanceM, ground.height.rows);
  const int bottom = bound(ground.north_m - eye.y() + kMaxDistanceM, ground.height.rows);
  const int left = bound(eye.x() - kMaxDistanceM - ground.west_m, ground.height.cols);
  const int right = bound(eye.x() + kMaxDistanceM - ground.west_m, ground.height.cols);
  parallel_for(static_cast<std::size_t>(std::max(0, bottom - top)), [&](std::size_t line) {
    const int row = top + static_cast<int>(line);
    for (int column = left; column < right; ++column) {
      if (std::isnan(ground.height(row, column))) continue;
      const Eigen::Vector3d world = ground.middle(row, column), x = camera_from_world * world;
      const auto distance = static_cast<float>((world - eye).norm());
      const double depth_m = camera.depth(x);
      if (depth_m < kMinDepthM || distance >= ortho.distance(row, column) || !camera.in_front(x)) continue;
      const Eigen::Vector2d pixel = camera.project(x);
      if (!camera.contains(pixel)) continue;
      const cv::Point nearest(cvRound(pixel.x()), cvRound(pixel.y()));
      if (seen.evidence(nearest) == 0 || std::abs(seen.depth(nearest) - depth_m) > kMaxDepthError * depth_m) continue;
      ortho.distance(row, column) = distance;
      ortho.color(row, column) = seen.image(nearest);
      const std::size_t source = seen.source_at(nearest, number);
      ortho.source(row, column) = static_cast<float>(source);
      ortho.age_s(row, column) = age_of(source);
      ortho.confidence(row, column) = seen.confidence_at(nearest);
    }
  });
}

std::optional<EarthPlace> find_origin(const Result& result, const std::string& wish) {
  if (wish == "local") return std::nullopt;
  return wish.empty() ? result.place() : parse_origin(wish);
}

std::vector<GeoBand> make_color_bands(const Ortho& ortho) {
  std::vector<cv::Mat> bgr;
  cv::split(ortho.color, bgr);
  return {{bgr[2], "red"}, {bgr[1], "green"}, {bgr[0], "blue"}, {ortho.seen(), "seen"}};
}

ExportReport write_ortho(const Result& result, const fs::path& folder, const ExportOptions& options, Progress& progress) {
  if (!can_write_geotiff()) throw UsageError("dvi export ortho: this build has no GDAL; install libgdal-dev and build again");
  const std::optional<EarthPlace> origin = find_origin(result, options.origin);
  const std::vector<CloudPoint> cloud = read_map_cloud(result.folder() / "map/map.ply");
  const GroundRaster ground = ground_of(cloud, options.cell_m);
  Ortho ortho(ground.height.size());
  for (std::size_t i = 0; i < result.frames().size(); ++i) {
    add_frame(result, i, ground, ortho);
    progress.advance();
  }
  const GeoPlace place{ground.cell_m, ground.west_m, ground.north_m, origin};
  write_geotiff(folder / "ortho.tif", place, make_color_bands(ortho), true);
  write_geotiff(folder / "evidence.tif", place,
                {{ortho.source, "number in sources.json of the frame it was taken from"},
                 {ortho.age_s, "seconds from that frame to the last one"},
                 {ortho.confidence, "probability of being right: 1 where the camera saw it itself"},
                 {ground.height, "meters above the drive's first LiDAR position"}},
                false);
  return {{"ortho.tif", "evidence.tif"},
          {{"columns", ground.height.cols},
           {"rows", ground.height.rows},
           {"pixels_seen", static_cast<double>(cv::countNonZero(ortho.seen()))}}};
}

}  // namespace

ExportFormat ortho_format() {
  return {"ortho",
          "GeoTIFFs from above: color; source frame, age, confidence and height (QGIS, GDAL)",
          write_ortho,
          {},
          {"export.cell_m", "export.origin"}};
}

}  // namespace dvi::exports
