#pragma once

#include <memory>
#include <string>
#include <vector>

#include <opencv2/core/mat.hpp>

#include "dvi/core/files.h"

namespace dvi::objects {

/// A network of an ONNX file, run by OpenCV's dnn on the CPU.
class Network {
 public:
  /// `outputs`: names of the outputs that run() gives, in that order; none: all of them. InputError where there is no such
  /// file, it is no ONNX, it has no such output, or OpenCV cannot run it: this names the first node that fails.
  Network(const fs::path& model, const std::vector<std::string>& outputs);
  ~Network();
  Network(const Network&) = delete;
  Network& operator=(const Network&) = delete;

  /// The outputs, float. Calls from several threads wait for each other: a call uses all threads itself. InputError where
  /// OpenCV cannot run the network on this input.
  std::vector<cv::Mat> run(const cv::Mat& blob) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// What an exception of OpenCV's importer says, in short: "node 'head/topk' (TopK): Can't create layer". Other text as it is,
/// without the place in OpenCV's source.
std::string importer_complaint(const std::string& what);

/// "1x3x32x48, 1x100".
std::string shapes_of(const std::vector<cv::Mat>& blobs);

}  // namespace dvi::objects
