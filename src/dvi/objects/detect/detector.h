#pragma once

#include <memory>
#include <vector>

#include <opencv2/core/mat.hpp>

#include "dvi/core/files.h"
#include "dvi/core/interrupt.h"
#include "dvi/drive/drive.h"
#include "dvi/objects/detect/detection.h"

namespace dvi::objects {

/// A network that the user brings, with its description: what it sees in images of what is to be removed.
class Detector {
 public:
  /// Loads MODEL.onnx and MODEL.toml beside it, and runs the network once. InputError where one is missing or malformed, the
  /// network cannot be run, or its outputs are not as described.
  explicit Detector(const fs::path& model);
  ~Detector();
  Detector(const Detector&) = delete;
  Detector& operator=(const Detector&) = delete;

  std::vector<fs::path> files() const;  ///< the network and its description
  /// The names of the classes, lower case.
  const std::vector<std::string>& classes() const;

  /// The objects of the classes that are removed in each image. Images are prepared and read out in parallel; the network takes
  /// one after the other.
  std::vector<Detections> detect(const std::vector<cv::Mat3b>& images) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// The objects in each frame of a drive, tracked over time; where the network missed one for a moment, it is filled in. One
/// tick a frame.
FrameLabels detect_objects(const Drive& drive, const Detector& detector, const Tick& tick);

}  // namespace dvi::objects
