#pragma once

#include <memory>
#include <vector>

#include <opencv2/core/mat.hpp>

#include "dvi/core/files.h"
#include "dvi/core/interrupt.h"
#include "dvi/drive/drive.h"
#include "dvi/objects/detect/detection.h"

namespace dvi::objects {

/// A network of the user, with its description, that detects the objects to remove in images.
class Detector {
 public:
  /// Loads MODEL.onnx and MODEL.toml beside it, and runs the network once. Throws InputError if a file is missing or malformed,
  /// the network cannot be run, or its outputs differ from the description.
  explicit Detector(const fs::path& model);
  ~Detector();
  Detector(const Detector&) = delete;
  Detector& operator=(const Detector&) = delete;

  /// Returns the paths of the network and of its description.
  std::vector<fs::path> files() const;
  /// Returns the names of the classes, lower case.
  const std::vector<std::string>& classes() const;

  /// Detects the objects of the removed classes, per image. Images are prepared and outputs are decoded in parallel; the
  /// network runs on one image at a time.
  std::vector<Detections> detect(const std::vector<cv::Mat3b>& images) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// Detects the objects in each frame of a drive, and tracks them over time. Short gaps in which the network missed an object
/// are filled. Calls `tick` once per frame.
FrameLabels detect_objects(const Drive& drive, const Detector& detector, const Tick& tick);

}  // namespace dvi::objects
