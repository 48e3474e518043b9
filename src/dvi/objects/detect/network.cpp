#include "dvi/objects/detect/network.h"

#include <algorithm>
#include <mutex>
#include <optional>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <opencv2/core/utils/logger.hpp>
#include <opencv2/dnn.hpp>

#include "dvi/core/error.h"

namespace dvi::objects {
namespace {

constexpr const char* kRemedy =
    "docs/detector.md lists the supported nodes, and how to remove others from the end of a network";

// Silences OpenCV's log, which repeats the text of its exceptions.
class QuietOpenCv {
 public:
  QuietOpenCv() : before_(cv::utils::logging::setLogLevel(cv::utils::logging::LOG_LEVEL_SILENT)) {}
  ~QuietOpenCv() { cv::utils::logging::setLogLevel(before_); }
  QuietOpenCv(const QuietOpenCv&) = delete;
  QuietOpenCv& operator=(const QuietOpenCv&) = delete;

 private:
  cv::utils::logging::LogLevel before_;
};

// Returns the text between two words, or an empty text if they are missing.
std::string extract_between(const std::string& text, const std::string& left, const std::string& right) {
  const std::size_t at = text.find(left);
  if (at == std::string::npos) return {};
  const std::size_t begin = at + left.size(), end = text.find(right, begin);
  return end == std::string::npos ? std::string() : text.substr(begin, end - begin);
}

// Returns the name of a layer's node. The importer names layers "onnx_node!NAME" or, for a node without name,
// "onnx_node_output_0!OUTPUT".
std::string find_node_name(const std::string& layer) {
  const std::size_t mark = layer.find('!');
  return layer.starts_with("onnx_node") && mark != std::string::npos ? layer.substr(mark + 1) : layer;
}

// Returns the message of the last error in a text: "OpenCV(4.6.0) FILE:LINE: error: (-2:Unspecified error) MESSAGE in function
// 'F'\n".
std::string extract_message(const std::string& what) {
  std::string text = what;
  if (const std::size_t error = text.rfind(" error: ("); error != std::string::npos)
    if (const std::size_t close = text.find(')', error); close != std::string::npos)
      text.erase(0, std::min(text.find_first_not_of(" \n>", close + 1), text.size()));
  text.resize(std::min(text.rfind(" in function"), text.size()));
  for (std::size_t at; (at = text.find("onnx_node!")) != std::string::npos;) text.erase(at, 10);
  std::replace(text.begin(), text.end(), '\n', ' ');
  text.resize(text.find_last_not_of(" >") + 1);
  return text;
}

InputError make_run_error(const fs::path& model, const std::string& why) {
  return {model, fmt::format("OpenCV's dnn {} cannot run {}", CV_VERSION, why), kRemedy};
}

}  // namespace

std::string summarize_importer_error(const std::string& what) {
  const std::string node = extract_between(what, "> Node [", " parse error:");
  const std::string type = node.substr(0, node.find_first_of("@]")), name = extract_between(node + "\n", "]:(", ")\n");
  const std::string message = extract_message(what);
  return name.empty() ? message : fmt::format("node '{}' ({}): {}", find_node_name(name), type, message);
}

std::string format_shapes(const std::vector<cv::Mat>& blobs) {
  std::vector<std::string> shapes;
  for (const cv::Mat& blob : blobs) {
    const std::vector<int> sizes(blob.size.p, blob.size.p + blob.dims);
    shapes.push_back(fmt::format("{}", fmt::join(sizes, "x")));
  }
  return fmt::format("{}", fmt::join(shapes, ", "));
}

struct Network::Impl {
  fs::path model;
  cv::dnn::Net net;
  std::vector<std::string> outputs;
  std::mutex mutex;

  // Describes the first layer whose shapes cannot be inferred. Exceptions of a run do not name it.
  std::optional<std::string> find_failing_layer(const cv::Mat& blob) {
    const std::vector<int> shape(blob.size.p, blob.size.p + blob.dims);
    for (const std::string& name : net.getLayerNames()) {
      const int id = net.getLayerId(name);
      std::vector<cv::dnn::MatShape> in, out;
      try {
        net.getLayerShapes(shape, id, in, out);
      } catch (const cv::Exception& e) {
        return fmt::format("node '{}' ({}) on an input of {}: {}", find_node_name(name), net.getLayer(id)->type,
                           format_shapes({blob}), extract_message(e.what()));
      }
    }
    return std::nullopt;
  }
};

Network::Network(const fs::path& model, const std::vector<std::string>& outputs) : impl_(std::make_unique<Impl>()) {
  require_regular_file(model);
  const QuietOpenCv quiet;
  impl_->model = model;
  try {
    impl_->net = cv::dnn::readNetFromONNX(model.string());
  } catch (const cv::Exception& e) {
    const std::string what = e.what();
    if (what.find("Failed to parse ONNX model") != std::string::npos || what.find("has_graph()") != std::string::npos)
      throw InputError(model, "is not an ONNX file, or is damaged", "--detector takes a network exported to ONNX");
    throw make_run_error(model, summarize_importer_error(what));
  }
  impl_->net.setPreferableBackend(cv::dnn::DNN_BACKEND_OPENCV);
  impl_->net.setPreferableTarget(cv::dnn::DNN_TARGET_CPU);
  const std::vector<std::string> names = impl_->net.getUnconnectedOutLayersNames();
  for (const std::string& name : outputs)
    if (std::find(names.begin(), names.end(), name) == names.end())
      throw InputError(model, fmt::format("has no output '{}'", name), fmt::format("it has {}", fmt::join(names, ", ")));
  impl_->outputs = outputs.empty() ? names : outputs;
}

Network::~Network() = default;

std::vector<cv::Mat> Network::run(const cv::Mat& blob) const {
  const std::lock_guard lock(impl_->mutex);
  const QuietOpenCv quiet;
  std::vector<cv::Mat> own;
  try {
    std::vector<cv::Mat> blobs;
    impl_->net.setInput(blob);
    impl_->net.forward(blobs, impl_->outputs);
    for (const cv::Mat& output : blobs) {  // the net reuses its memory in the next call
      own.emplace_back();
      output.convertTo(own.back(), CV_32F);
    }
  } catch (const cv::Exception& e) {
    throw make_run_error(impl_->model, impl_->find_failing_layer(blob).value_or("it: " + extract_message(e.what())));
  }
  return own;
}

}  // namespace dvi::objects
