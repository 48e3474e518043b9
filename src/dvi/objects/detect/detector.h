#pragma once

#include <functional>
#include <memory>
#include <set>
#include <string>
#include <vector>

#include <opencv2/core/mat.hpp>

#include "dvi/core/files.h"
#include "dvi/core/interrupt.h"
#include "dvi/drive/drive.h"
#include "dvi/objects/detect/description.h"
#include "dvi/objects/detect/detection.h"

namespace dvi::objects {

/// A network of the user that detects the objects to remove in images.
class Detector {
 public:
  /// Loads a network, with its description (describe_network()), and runs it once. Throws InputError if a file is missing or
  /// malformed, the network cannot be run, or its outputs are unknown.
  explicit Detector(const fs::path& model);
  ~Detector();
  Detector(const Detector&) = delete;
  Detector& operator=(const Detector&) = delete;

  /// Returns the paths of the network and of all files that describe it.
  std::vector<fs::path> files() const;
  /// Returns the name and version of the engine that runs the network. Results of two engines may differ at edges.
  std::string engine() const;
  /// Returns the names of the classes, lower case.
  const std::vector<std::string>& classes() const;
  /// Removes the classes of these names, in lower case. Throws InputError if the network has none of them.
  void choose(const std::set<std::string, std::less<>>& names);

  /// Detects the objects of the removed classes, per image. Several images are processed in parallel if the engine can.
  std::vector<Detections> detect(const std::vector<cv::Mat3b>& images) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// Detects the objects in each frame of a drive, and tracks them over time. Short gaps in which the network missed an object
/// are filled. Calls `tick` once per frame.
FrameLabels detect_objects(const Drive& drive, const Detector& detector, const Tick& tick);

}  // namespace dvi::objects
