#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <opencv2/core/mat.hpp>

#include "dvi/core/files.h"
#include "dvi/core/interrupt.h"
#include "dvi/drive/drive.h"
#include "dvi/holdout/painted_box.h"
#include "dvi/holdout/virtual_vehicle.h"

namespace dvi::holdout {

struct HoldoutOptions {
  Scenario scenario = Scenario::lead;
  int seed = 1;
  int margin_px = 3;         ///< masks reach this far beyond the virtual vehicle
  int ignore_margin_px = 5;  ///< and this far beyond the masks of real traffic nothing is scored
};

/// One frame of a case.
struct HoldoutFrame {
  cv::Mat3b image;     ///< every pixel of `held_out` painted, all others as in the drive
  cv::Mat1b held_out;  ///< 255: the virtual vehicle and its margin
  cv::Mat1b mask;      ///< held_out and the drive's own traffic
  cv::Mat1b ignore;    ///< 255: not to be scored, for its truth shows real traffic
};

/// What one camera of the drive saw, and where its real traffic is.
struct HoldoutCamera {
  Drive drive;
  Lazy<cv::Mat1b> traffic;  ///< as the drive's frames
};

/// A real drive with virtual traffic (docs/holdout.md), in memory: frames and scans are made when asked for, the same at each
/// call. Safe to use from many threads.
class Holdout {
 public:
  /// `cameras`: the drive as each of its cameras saw it, that of the target first. Frames and scans without a pose are left out
  /// of the case. InputError where no scan shows the ground, or the vehicle enters no image of the target.
  Holdout(const std::vector<HoldoutCamera>& cameras, const Trajectory& world_from_lidar, const HoldoutOptions& options);

  /// The case as a drive of its own: poses at the middle of its scans, boxes of traffic real and virtual. Its lazy images,
  /// masks and scans are not there: see frame() and scan().
  const Drive& drive() const { return drive_; }
  /// The same, of the cameras behind the target's.
  const std::vector<Drive>& more_cameras() const { return more_drives_; }
  const HoldoutOptions& options() const { return options_; }
  const std::optional<VirtualVehicle>& vehicle() const { return vehicle_; }  ///< none is a banner
  int track() const { return track_; }                                       ///< of the virtual vehicle among the labels
  double sensor_height() const { return road_ ? road_->sensor_height() : 0; }
  const std::vector<bool>& visible() const { return visible_; }  ///< a frame: whether anything is held out

  HoldoutFrame frame(std::size_t i) const { return frame_of(drive_, target_, i); }
  HoldoutFrame frame_of_camera(std::size_t camera, std::size_t i) const {
    return frame_of(more_drives_[camera], more_[camera], i);
  }
  cv::Mat3b truth(std::size_t i) const { return *target_.images[target_.frames[i]]; }
  Scan scan(std::size_t i) const;

 private:
  struct Pictures {
    Lazy<cv::Mat3b> images;
    Lazy<cv::Mat1b> traffic;
    std::vector<std::size_t> frames;  // of the case, in the drive
  };

  Pictures take_pictures(const HoldoutCamera& camera, Drive& drive) const;
  void add_labels();
  Painting paint(const Drive& drive, std::size_t frame) const;
  HoldoutFrame frame_of(const Drive& drive, const Pictures& pictures, std::size_t i) const;

  Drive drive_;
  HoldoutOptions options_;
  Lazy<Scan> scans_;
  std::vector<std::size_t> scan_numbers_;  // of the case, in the drive
  Pictures target_;
  std::vector<Drive> more_drives_;
  std::vector<Pictures> more_;  // as more_drives_
  std::shared_ptr<const DrivenPath> road_;
  std::optional<VirtualVehicle> vehicle_;
  std::vector<bool> visible_;
  int track_ = 0;
};

/// Writes the case: drive/ in the folder layout, truth/NAME.png, ignore/NAME.png and holdout.json, in which `recipe` says what
/// the case was made from. Everything is written beside CASE and renamed. `tick` is called once a frame and once a scan.
/// InputError where the folder is not empty or cannot be written.
void write_holdout(const Holdout& holdout, const fs::path& case_folder, const std::string& recipe, const Tick& tick = {});

/// The recipe of a whole case; empty where there is none.
std::string holdout_recipe(const fs::path& case_folder);

}  // namespace dvi::holdout
