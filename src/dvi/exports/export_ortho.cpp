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

constexpr float kNone = std::numeric_limits<float>::quiet_NaN();

// What the picture from above shows.
struct Ortho {
  cv::Mat3b color;
  cv::Mat1f source, age_s, confidence;
  cv::Mat1f distance;  // meters to the camera whose pixel this is

  cv::Mat1b seen() const { return cv::Mat1b(distance < std::numeric_limits<float>::max()); }

  explicit Ortho(cv::Size size)
      : color(size, cv::Vec3b()),
        source(size, kNone),
        age_s(size, kNone),
        confidence(size, kNone),
        distance(size, std::numeric_limits<float>::max()) {}
};

// One frame with all that says what its pixels are worth.
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
        provenance(media::read_png_triples(result.picture("provenance", i), result.size())) {}

  // The source frame that a pixel shows: where it was copied, the one it was copied from.
  std::size_t source_at(cv::Point p, std::size_t own) const {
    return kind(p) == 0 || provenance(p)[0] == 0 ? own : std::size_t{provenance(p)[0]} - 1;
  }
  // 1 where the camera saw the pixel itself.
  float confidence_at(cv::Point p) const { return kind(p) == 0 ? 1.0F : static_cast<float>(confidence(p)) / 255; }
};

// The cells that a frame sees, as long as no nearer frame saw them: the nearer camera resolves more.
void add_frame(const Result& result, std::size_t number, const GroundRaster& ground, Ortho& ortho) {
  constexpr double kNearest = 0.5, kFarthest = 40, kTolerance = 0.03;  // meters; part of the depth
  const ResultFrame& frame = result.frames()[number];
  const SeenFrame seen(result, number);
  const Camera& camera = result.camera();
  const SE3 camera_from_world = frame.world_from_camera.inverse();
  const Eigen::Vector3d& eye = frame.world_from_camera.t;
  const auto age_of = [&](std::size_t source) {  // of frames of other drives and cameras, only the copy's is known
    const std::int64_t time = source < result.frames().size() ? result.frames()[source].time_ns : frame.time_ns;
    return static_cast<float>(1e-9 * static_cast<double>(result.frames().back().time_ns - time));
  };
  const auto bound = [&](double meters, int most) { return std::clamp(static_cast<int>(meters / ground.cell_m), 0, most); };
  const int top = bound(ground.north_m - eye.y() - kFarthest, ground.height.rows);
  const int bottom = bound(ground.north_m - eye.y() + kFarthest, ground.height.rows);
  const int left = bound(eye.x() - kFarthest - ground.west_m, ground.height.cols);
  const int right = bound(eye.x() + kFarthest - ground.west_m, ground.height.cols);
  parallel_for(static_cast<std::size_t>(std::max(0, bottom - top)), [&](std::size_t line) {
    const int row = top + static_cast<int>(line);
    for (int column = left; column < right; ++column) {
      if (std::isnan(ground.height(row, column))) continue;
      const Eigen::Vector3d world = ground.middle(row, column), x = camera_from_world * world;
      const auto distance = static_cast<float>((world - eye).norm());
      if (x.z() < kNearest || distance >= ortho.distance(row, column) || !camera.in_front(x)) continue;
      const Eigen::Vector2d pixel = camera.project(x);
      if (!camera.contains(pixel)) continue;
      const cv::Point nearest(cvRound(pixel.x()), cvRound(pixel.y()));
      if (seen.evidence(nearest) == 0 || std::abs(seen.depth(nearest) - x.z()) > kTolerance * x.z()) continue;
      ortho.distance(row, column) = distance;
      ortho.color(row, column) = seen.image(nearest);
      const std::size_t source = seen.source_at(nearest, number);
      ortho.source(row, column) = static_cast<float>(source);
      ortho.age_s(row, column) = age_of(source);
      ortho.confidence(row, column) = seen.confidence_at(nearest);
    }
  });
}

std::optional<EarthPlace> origin_of(const Result& result, const std::string& wish) {
  if (wish == "local") return std::nullopt;
  return wish.empty() ? result.place() : parse_origin(wish);
}

std::vector<GeoBand> color_bands(const Ortho& ortho) {
  std::vector<cv::Mat> bgr;
  cv::split(ortho.color, bgr);
  return {{bgr[2], "red"}, {bgr[1], "green"}, {bgr[0], "blue"}, {ortho.seen(), "seen"}};
}

ExportReport write_ortho(const Result& result, const fs::path& folder, const ExportOptions& options, Progress& progress) {
  if (!can_write_geotiff()) throw UsageError("dvi export ortho: this build has no GDAL; install libgdal-dev and build again");
  const std::optional<EarthPlace> origin = origin_of(result, options.origin);
  const std::vector<CloudPoint> cloud = read_map_cloud(result.folder() / "map/map.ply");
  const GroundRaster ground = ground_of(cloud, options.cell_m);
  Ortho ortho(ground.height.size());
  for (std::size_t i = 0; i < result.frames().size(); ++i) {
    add_frame(result, i, ground, ortho);
    progress.advance();
  }
  const GeoPlace place{ground.cell_m, ground.west_m, ground.north_m, origin};
  write_geotiff(folder / "ortho.tif", place, color_bands(ortho), true);
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
  return {"ortho", "GeoTIFFs from above: color; source frame, age, confidence and height (QGIS, GDAL)", write_ortho};
}

}  // namespace dvi::exports
