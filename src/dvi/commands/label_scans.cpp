#include "dvi/commands/label_scans.h"

#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "dvi/core/error.h"
#include "dvi/core/threads.h"
#include "dvi/drive/deskew.h"
#include "dvi/drive/nearest_in_time.h"
#include "dvi/inputs/collect_evidence.h"
#include "dvi/inputs/rig.h"
#include "dvi/labels/scan_labels.h"
#include "dvi/objects/find_objects.h"

namespace dvi::commands {
namespace {

// Reads the job of a result that has poses.
job::Job read_job(const fs::path& out) {
  if (!fs::exists(out / "dvi.toml") || !fs::exists(out / "report.json"))
    throw InputError(out, "is not a finished result of dvi run", "give the OUT of a dvi run that has ended");
  job::Job job;
  job.table().load_toml(out / "dvi.toml");
  job.out = out.string();
  if (job::is_baseline(job.method))
    throw InputError(out,
                     fmt::format("is a result of --method {}, which has no poses and labels no points", to_string(job.method)),
                     "give a result of --method dvi or paper");
  return job;
}

inputs::Recordings open_drives(const job::Job& job, Progress& progress) {
  inputs::Recordings drives = inputs::open_recordings(job, inputs::MaskNeed::required, progress);
  if (drives.front().drive.scan_headers.empty())
    throw InputError(drives.front().drive.path, "has no scans, so there are no points to label",
                     "give a result of a drive with a LiDAR");
  return inputs::add_other_cameras(std::move(drives), job, progress);
}

// Returns the evidence of the cameras of the target's drive.
objects::Evidence collect_target_evidence(const inputs::Recordings& drives, const inputs::Poses& poses) {
  const objects::Evidence all = inputs::collect_evidence(drives, poses);
  std::vector<objects::CameraEvidence> cameras;
  for (std::size_t i = 0; i < all.size(); ++i)
    if (all.own_camera(i) == 0) cameras.push_back(all[i]);
  return objects::Evidence(std::move(cameras));
}

// The target drive of a result and the objects in its scans.
class ResultScans {
 public:
  ResultScans(const fs::path& out, Progress& progress)
      : job_(read_job(out)),
        drives_(open_drives(job_, progress)),
        poses_(inputs::estimate_poses(drives_, job_, progress)),
        evidence_(collect_target_evidence(drives_, poses_)),
        returns_(objects::find_scanned_objects(evidence_, job_.removal(), progress)) {}
  ResultScans(const ResultScans&) = delete;
  ResultScans& operator=(const ResultScans&) = delete;

  std::size_t size() const { return drive().scan_headers.size(); }
  const std::string& name(std::size_t scan) const { return drive().scan_headers[scan].name; }

  // Labels the points of a scan's file.
  PointLabels label(std::size_t scan) const {
    const auto returns = drive().scans[scan];
    const PointLabels labels = returns_.label(scan);
    PointLabels out{std::vector<std::uint32_t>(returns->size_in_file(), 0)};
    for (std::size_t i = 0; i < labels.values.size(); ++i) out.values[returns->index_in_file(i)] = labels.values[i];
    return out;
  }

  // Returns, per point of a scan's file, whether the camera's frame nearest in time shows its position.
  std::vector<bool> find_in_view(std::size_t scan) const {
    const ScanHeader& header = drive().scan_headers[scan];
    const auto returns = drive().scans[scan];
    std::vector<bool> out(returns->size_in_file(), false);
    const Trajectory& world_from_lidar = poses_.front().world_from_lidar;
    const Frame* const frame = nearest_in_time(drive().frames, header.time_ns, kMaxFrameToScanNs);
    const std::optional<SE3> pose = frame ? world_from_lidar.at(frame->time_ns) : std::nullopt;
    if (!pose) return out;
    const SE3 camera_from_world = drive().camera_from_lidar * pose->inverse();
    const std::vector<Eigen::Vector3d> world = to_world(*returns, header, world_from_lidar);
    for (std::size_t i = 0; i < world.size(); ++i) {
      const Eigen::Vector3d in_camera = camera_from_world * world[i];
      out[returns->index_in_file(i)] =
          drive().camera.in_front(in_camera) && drive().camera.contains(drive().camera.project(in_camera));
    }
    return out;
  }

 private:
  const Drive& drive() const { return drives_.front().drive; }

  job::Job job_;
  inputs::Recordings drives_;
  inputs::Poses poses_;
  objects::Evidence evidence_;
  objects::ObjectReturns returns_;
};

// Returns the folder of the true labels. Throws InputError if there are none.
fs::path find_truth(const fs::path& truth) {
  if (!fs::is_directory(truth)) throw InputError(truth, "is not a folder", "give the folder of the true labels, NAME.label");
  const std::optional<fs::path> folder = labels::find_point_label_folder(truth);
  if (!folder) throw InputError(truth, "has no .label files", "give the folder of the true labels, NAME.label per scan");
  return *folder;
}

std::vector<std::uint32_t> read_truth(const fs::path& file, std::size_t points) {
  if (!fs::exists(file)) throw InputError(file, "is missing", "every scan of the drive requires its true labels");
  std::vector<std::uint32_t> truth = labels::read_point_labels(file);
  if (truth.size() != points)
    throw InputError(file, fmt::format("has {} labels, but its scan has {} points", truth.size(), points),
                     "give the labels of these scans, one per point");
  return truth;
}

}  // namespace

exports::LabeledScans label_scans(const fs::path& out, Progress& progress) {
  const auto scans = std::make_shared<const ResultScans>(out, progress);
  exports::LabeledScans labeled;
  for (std::size_t i = 0; i < scans->size(); ++i) labeled.names.push_back(scans->name(i));
  labeled.labels = {scans->size(), [scans](std::size_t i) { return scans->label(i); }};
  return labeled;
}

metrics::PointScores score_points(const fs::path& out, const fs::path& truth, Progress& progress) {
  const fs::path folder = find_truth(truth);
  const ResultScans scans(out, progress);
  std::vector<metrics::PointScores> scores(scans.size());
  progress.begin("points", scans.size());
  parallel_for(scans.size(), [&](std::size_t i) {
    const PointLabels labels = scans.label(i);
    scores[i] = metrics::score_labels(read_truth(folder / (scans.name(i) + ".label"), labels.values.size()), labels.values,
                                      scans.find_in_view(i));
    progress.advance();
  });
  progress.end();
  metrics::PointScores total;
  for (const metrics::PointScores& score : scores) total += score;
  return total;
}

}  // namespace dvi::commands
