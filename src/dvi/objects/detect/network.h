#pragma once

#include <memory>
#include <string>
#include <vector>

#include <opencv2/core/mat.hpp>

#include "dvi/core/files.h"

namespace dvi::objects {

/// A network of an ONNX file, which OpenCV's dnn module runs on the CPU.
class Network {
 public:
  /// `outputs` are the names of the outputs that run() returns, in that order; empty: all outputs. Throws InputError if the
  /// file does not exist, is not an ONNX file, lacks an output, or cannot be run by OpenCV. The message names the first node
  /// that fails.
  Network(const fs::path& model, const std::vector<std::string>& outputs);
  ~Network();
  Network(const Network&) = delete;
  Network& operator=(const Network&) = delete;

  /// Returns the outputs, float. Calls from several threads wait for each other, because one call uses all threads. Throws
  /// InputError if OpenCV cannot run the network on this input.
  std::vector<cv::Mat> run(const cv::Mat& blob) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// Shortens the text of an exception of OpenCV's importer: "node 'head/topk' (TopK): Can't create layer". Other text is
/// returned without the position in OpenCV's source.
std::string summarize_importer_error(const std::string& what);

/// Formats shapes: "1x3x32x48, 1x100".
std::string format_shapes(const std::vector<cv::Mat>& blobs);

}  // namespace dvi::objects
