#pragma once

#include <memory>
#include <string>
#include <vector>

#include <opencv2/core/mat.hpp>

#include "dvi/objects/detect/onnx_file.h"
#include "dvi/objects/detect/tensor.h"

namespace dvi::objects {

/// A network that an engine runs on the CPU.
class Network {
 public:
  virtual ~Network() = default;

  /// Returns the name and the version of the engine.
  virtual std::string engine() const = 0;
  /// Whether calls of run() from several threads run at the same time, each on one thread. Otherwise they wait for each other,
  /// and each uses all threads.
  virtual bool runs_in_parallel() const = 0;
  /// Returns the outputs for an image of 1 x 3 x height x width, float. Throws InputError if the network cannot be run on it.
  virtual std::vector<Tensor> run(const cv::Mat& image) const = 0;
};

/// Opens a network with ONNX Runtime where a library of it is found, else with OpenCV's dnn module. `outputs` are the names of
/// the outputs that run() returns, in that order; empty: all outputs. Throws InputError if the network lacks an output, or
/// cannot be run. The message names the first node that fails.
std::unique_ptr<Network> open_network(const OnnxFile& file, const std::vector<std::string>& outputs);

/// Opens a network with OpenCV. Throws as open_network() does.
std::unique_ptr<Network> open_with_opencv(const OnnxFile& file, const std::vector<std::string>& outputs);

/// Shortens the text of an exception of OpenCV's importer: "node 'head/topk' (TopK): Can't create layer". Other text is
/// returned without the position in OpenCV's source.
std::string summarize_importer_error(const std::string& what);

}  // namespace dvi::objects
