#include "dvi/objects/upper_edges.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <optional>
#include <utility>

#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "dvi/core/median.h"
#include "dvi/core/threads.h"
#include "dvi/image/gray.h"
#include "dvi/objects/seconds.h"

namespace dvi::objects {
namespace {

struct UpperEdgeParams {
  double min_cut_share = 0.3;    ///< share of observations that reach the highest ray
  double low_m = 0.5;            ///< above ground: lowest row of a face, above wheels and shadows
  double high_m = 5.2;           ///< highest row: the highest trucks and buses have 4.0 to 4.6 m
  double row_m = 0.05;           ///< height of a row
  int face_columns = 48;         ///< columns between the sides of an object
  int beside_columns = 16;       ///< columns on each side of them
  std::size_t min_frames = 3;    ///< the median of fewer does not exclude what passes behind the object
  std::size_t max_frames = 24;   ///< more show nothing new
  double max_gap_s = 0.06;       ///< time to the scan: half a scan period of 10 Hz
  double end_share = 0.1;        ///< share of returns that locate a side
  double min_width_px = 16;      ///< narrower faces show no edges
  double min_height_px = 8;      ///< of the part above the scans
  double blur_px = 0.8;          ///< of images before they are resampled
  int max_shift = 3;             ///< cells by which faces are shifted for the best agreement, for errors of the returns
  int side_search = 4;           ///< columns around the expected side in which an edge is searched
  float min_edge_levels = 6;     ///< gray levels of an edge
  double min_edge_share = 0.35;  ///< the same, relative to the edges of the part that the scans show
  double max_change = 3;         ///< deviation between frames, relative to that of the scanned part, ...
  double max_change_levels = 4;  ///< ... plus this, beyond which a row shows the background
  double edge_rows = 8;          ///< an edge over the whole width counts as much as so many rows with sides
  int snap_rows = 3;             ///< rows in which the strongest edge is searched at last
};
constexpr UpperEdgeParams kUpperEdge{};

const int kRows = cvRound((kUpperEdge.high_m - kUpperEdge.low_m) / kUpperEdge.row_m) + 1;
constexpr int kColumns = kUpperEdge.face_columns + 2 * kUpperEdge.beside_columns;
constexpr float kOutside = -1000;  // gray level outside the image

int row_at(double height_m) { return std::clamp(cvRound((height_m - kUpperEdge.low_m) / kUpperEdge.row_m), 0, kRows - 1); }
double height_at(int row) { return kUpperEdge.low_m + row * kUpperEdge.row_m; }

// Returns whether the highest return of an observation is on the highest ray of its scan.
bool is_cut(const Cluster& cluster, const FreeSpace& scan) {
  ClusterReturn top = cluster.returns.front();
  for (const ClusterReturn& r : cluster.returns)
    if (r.point.z() > top.point.z()) top = r;
  return scan.is_above(top.point + Eigen::Vector3d(0, 0, 0.5 * top.ray_spacing_m));
}

// The image of the side of an object that faces the camera, as gray levels by height and position from left to right.
struct Face {
  cv::Mat1f gray;        // row 0 is the lowest
  double scanned_m = 0;  // height up to which the scan shows the object
  int width_px = 0;
};

// The upper edge of an object between its sides, seen from a camera.
struct ScannedTop {
  Eigen::Vector2d left, right;  // positions of the sides, world axes
  double height_m = 0, ground_m = 0;
  double width_px = 0;
};

std::optional<ScannedTop> find_scanned_top(const Track& track, std::int64_t time_ns, const Camera& camera,
                                           const SE3& camera_from_world) {
  const std::size_t nearest = track.nearest(time_ns);
  const Cluster& cluster = track.observations[nearest];
  const Eigen::Vector2d velocity = track.velocity(nearest);
  const double top_m = top_of(cluster);
  std::vector<std::pair<double, Eigen::Vector2d>> at;  // column of the image, and position
  for (const ClusterReturn& r : cluster.returns) {
    if (!is_near_top(r, top_m)) continue;
    Eigen::Vector3d x = r.point;
    x.head<2>() += velocity * seconds_between(r.time_ns, time_ns);
    const Eigen::Vector3d in_camera = camera_from_world * x;
    if (!camera.in_front(in_camera)) return std::nullopt;
    at.emplace_back(camera.project(in_camera).x(), x.head<2>());
  }
  std::sort(at.begin(), at.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
  ScannedTop out;
  out.width_px = at.back().first - at.front().first;
  const auto count = static_cast<std::size_t>(std::ceil(kUpperEdge.end_share * static_cast<double>(at.size())));
  out.left = out.right = Eigen::Vector2d::Zero();
  for (std::size_t i = 0; i < count; ++i) {
    out.left += at[i].second / static_cast<double>(count);
    out.right += at[at.size() - 1 - i].second / static_cast<double>(count);
  }
  out.ground_m = cluster.returns.median_ground();
  out.height_m = top_m - out.ground_m;
  return out;
}

std::optional<Face> sample_face(const Track& track, std::size_t frame, const CameraEvidence& evidence) {
  const Drive& drive = evidence.drive;
  const std::int64_t time_ns = drive.frames[frame].time_ns;
  const std::optional<SE3> pose = evidence.world_from_lidar.at(time_ns);
  if (!pose) return std::nullopt;
  const SE3 camera_from_world = drive.camera_from_lidar * pose->inverse();
  const auto top = find_scanned_top(track, time_ns, drive.camera, camera_from_world);
  if (!top || top->width_px < kUpperEdge.min_width_px) return std::nullopt;
  cv::Mat1f map_x(kRows, kColumns), map_y(kRows, kColumns);
  for (int row = 0; row < kRows; ++row)
    for (int column = 0; column < kColumns; ++column) {
      const double share = (column - kUpperEdge.beside_columns + 0.5) / kUpperEdge.face_columns;
      const Eigen::Vector2d at = top->left + share * (top->right - top->left);
      const Eigen::Vector3d x = camera_from_world * Eigen::Vector3d(at.x(), at.y(), top->ground_m + height_at(row));
      const Eigen::Vector2d pixel = drive.camera.in_front(x) ? drive.camera.project(x) : Eigen::Vector2d(-2, -2);
      map_x(row, column) = static_cast<float>(pixel.x());
      map_y(row, column) = static_cast<float>(pixel.y());
    }
  const int middle = kColumns / 2;
  if (map_y(row_at(top->height_m), middle) - map_y(kRows - 1, middle) < kUpperEdge.min_height_px) return std::nullopt;
  cv::Mat1f gray;
  gray_8bit(*drive.images[frame]).convertTo(gray, CV_32F);
  cv::GaussianBlur(gray, gray, {}, kUpperEdge.blur_px);
  Face out{{}, top->height_m, cvRound(top->width_px)};
  cv::remap(gray, out.gray, map_x, map_y, cv::INTER_LINEAR, cv::BORDER_CONSTANT, cv::Scalar(kOutside));
  for (float& level : out.gray)
    if (level < 0) level = kOutside;
  return out;
}

// Returns the median difference of gray levels of two faces in the rows that both scans show, the second one shifted, and the
// mean absolute deviation from it.
std::pair<float, double> compare(const cv::Mat1f& a, const cv::Mat1f& b, int rows, cv::Point shift) {
  std::vector<float> differences;
  for (int row = kUpperEdge.max_shift; row < rows - kUpperEdge.max_shift; ++row)
    for (int column = kUpperEdge.beside_columns; column < kColumns - kUpperEdge.beside_columns; ++column) {
      const float from = a(row, column), to = b(row + shift.y, column + shift.x);
      if (from >= 0 && to >= 0) differences.push_back(to - from);
    }
  if (differences.empty()) return {0.F, 1e9};
  const float exposure = median(differences);
  double sum = 0;
  for (const float difference : differences) sum += std::abs(static_cast<double>(difference - exposure));
  return {exposure, sum / static_cast<double>(differences.size())};
}

// Shifts a face such that it agrees best with another one in the part that both scans show, and equalizes the exposure.
cv::Mat1f align(const cv::Mat1f& reference, const cv::Mat1f& face, int rows) {
  cv::Point best;
  auto [exposure, least] = compare(reference, face, rows, best);
  for (int y = -kUpperEdge.max_shift; y <= kUpperEdge.max_shift; ++y)
    for (int x = -kUpperEdge.max_shift; x <= kUpperEdge.max_shift; ++x)
      if (const auto [level, error] = compare(reference, face, rows, {x, y}); error < least)
        best = {x, y}, exposure = level, least = error;
  cv::Mat1f out(face.size(), kOutside);
  for (int row = 0; row < kRows; ++row)
    for (int column = 0; column < kColumns; ++column) {
      const cv::Point from(column + best.x, row + best.y);
      if (cv::Rect({}, face.size()).contains(from) && face(from) >= 0) out(row, column) = face(from) - exposure;
    }
  return out;
}

// The median of the faces of an object, and their deviation from it, per cell; kOutside where fewer than half of the images
// show it.
struct MeanFace {
  cv::Mat1f gray, deviation;
  int scanned_rows = 0;
};

MeanFace average(const std::vector<Face>& faces) {
  MeanFace out{cv::Mat1f(kRows, kColumns, kOutside), cv::Mat1f(kRows, kColumns, 0.F), kRows};
  for (const Face& face : faces) out.scanned_rows = std::min(out.scanned_rows, row_at(face.scanned_m));
  const auto widest =
      std::max_element(faces.begin(), faces.end(), [](const Face& a, const Face& b) { return a.width_px < b.width_px; });
  std::vector<cv::Mat1f> aligned;
  for (const Face& face : faces) aligned.push_back(align(widest->gray, face.gray, out.scanned_rows));
  for (int row = 0; row < kRows; ++row)
    for (int column = 0; column < kColumns; ++column) {
      std::vector<float> levels;
      for (const cv::Mat1f& face : aligned)
        if (face(row, column) != kOutside) levels.push_back(face(row, column));
      if (2 * levels.size() < faces.size() || levels.empty()) continue;
      const float middle = median(levels);
      for (float& level : levels) level = std::abs(level - middle);
      out.gray(row, column) = middle;
      out.deviation(row, column) = median(levels);
    }
  return out;
}

// The rows of an object in its mean face.
class FaceRows {
 public:
  explicit FaceRows(const MeanFace& face) : face_(face) {
    std::vector<float> deviations, sides;
    for (int row = 0; row < face.scanned_rows; ++row) {
      deviations.push_back(measure_deviation(row));
      sides.push_back(measure_sides(row));
    }
    max_deviation_ =
        static_cast<float>(kUpperEdge.max_change * static_cast<double>(median(deviations)) + kUpperEdge.max_change_levels);
    min_side_ = std::max(kUpperEdge.min_edge_levels, static_cast<float>(kUpperEdge.min_edge_share) * median(sides));
  }

  // Returns the highest row of the object; nothing if it is not above the scanned ones.
  std::optional<int> find_top() const {
    double sum = 0, most = 0;
    std::optional<int> best;
    for (int row = face_.scanned_rows; row + 1 < kRows && is_inside(row + 1); ++row) {
      sum += measure_deviation(row) <= max_deviation_ && measure_sides(row) >= min_side_ ? 1 : -1;
      const double score = sum + kUpperEdge.edge_rows * share_of_edge(row);
      if (score > most) most = score, best = row;
    }
    return best ? std::optional(snap(*best)) : best;
  }

 private:
  static constexpr int kFirst = kUpperEdge.beside_columns, kEnd = kColumns - kUpperEdge.beside_columns;

  bool is_inside(int row) const {
    for (int column = kFirst; column < kEnd; ++column)
      if (face_.gray(row, column) == kOutside) return false;
    return true;
  }

  float measure_deviation(int row) const {
    std::vector<float> all;
    for (int column = kFirst; column < kEnd; ++column) all.push_back(face_.deviation(row, column));
    return median(all);
  }

  // Returns the contrast at the left and right side, in gray levels.
  float measure_sides(int row) const {
    const auto strongest = [&](int side) {
      float most = 0;
      for (int column = side - kUpperEdge.side_search; column <= side + kUpperEdge.side_search; ++column) {
        const float left = face_.gray(row, column - 1), right = face_.gray(row, column + 1);
        if (left != kOutside && right != kOutside) most = std::max(most, std::abs(right - left));
      }
      return most;
    };
    return 0.5F * (strongest(kFirst) + strongest(kEnd - 1));
  }

  float edge(int row, int column) const {
    return face_.gray(std::min(row + 1, kRows - 1), column) - face_.gray(std::max(row - 1, 0), column);
  }

  // Returns the share of the columns that have an edge at a row, all of them brighter or all of them darker above.
  double share_of_edge(int row) const {
    int brighter = 0, darker = 0;
    for (int column = kFirst; column < kEnd; ++column) {
      brighter += edge(row, column) > kUpperEdge.min_edge_levels;
      darker += edge(row, column) < -kUpperEdge.min_edge_levels;
    }
    return static_cast<double>(std::max(brighter, darker)) / (kEnd - kFirst);
  }

  // Returns the row with the strongest edge near a row.
  int snap(int row) const {
    int best = row;
    double most = -1;
    for (int near = std::max(0, row - kUpperEdge.snap_rows); near <= std::min(row + kUpperEdge.snap_rows, kRows - 2); ++near)
      if (const double share = share_of_edge(near); share > most && is_inside(near + 1)) most = share, best = near;
    return best;
  }

  const MeanFace& face_;
  float max_deviation_ = 0, min_side_ = 0;
};

std::vector<Face> sample_faces(const Track& track, const CameraEvidence& camera) {
  std::vector<std::size_t> frames;
  for (std::size_t i = 0; i < camera.drive.frames.size(); ++i) {
    const std::int64_t time_ns = camera.drive.frames[i].time_ns;
    const Cluster& nearest = track.observations[track.nearest(time_ns)];
    if (std::abs(seconds_between(nearest.mean_time_ns, time_ns)) <= kUpperEdge.max_gap_s) frames.push_back(i);
  }
  const std::size_t step = frames.size() / (kUpperEdge.max_frames + 1) + 1;
  std::vector<Face> out;
  for (std::size_t k = 0; k < frames.size(); k += step)
    if (auto face = sample_face(track, frames[k], camera)) out.push_back(std::move(*face));
  return out;
}

bool reaches_above(const Track& track, const MovingReturns& returns) {
  const auto cut = std::count_if(track.observations.begin(), track.observations.end(),
                                 [&](const Cluster& o) { return is_cut(o, *returns.free_space(o.scan)); });
  return !track.observations.empty() &&
         static_cast<double>(cut) >= kUpperEdge.min_cut_share * static_cast<double>(track.observations.size());
}

}  // namespace

void find_upper_edges(const CameraEvidence& camera, const MovingReturns& returns, std::span<Track> tracks) {
  parallel_for(tracks.size(), [&](std::size_t k) {
    Track& track = tracks[k];
    if (!reaches_above(track, returns)) return;
    const std::vector<Face> faces = sample_faces(track, camera);
    if (faces.size() < kUpperEdge.min_frames) return;
    const std::optional<int> top = FaceRows(average(faces)).find_top();
    if (!top || height_at(*top) <= track.height_m) return;
    track.height_m = height_at(*top);
    track.reaches_above_scans = true;
  });
}

}  // namespace dvi::objects
