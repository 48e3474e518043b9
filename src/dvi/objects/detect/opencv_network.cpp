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
    "install ONNX Runtime, or give its library with DVI_ONNXRUNTIME=FILE; or export the network without this node "
    "(docs/detector.md); or give the masks that its own tool writes with --masks";

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

Tensor to_tensor(const cv::Mat& blob, const TensorInfo& info) {
  cv::Mat values;
  blob.convertTo(values, CV_32F);
  Tensor out{info.name, {blob.size.p, blob.size.p + blob.dims}, {}, info.type == ElementType::int64};
  out.values.assign(values.ptr<float>(), values.ptr<float>() + values.total());
  return out;
}

// Returns the text of a shape: "1x3x32x48".
std::string format_shape(const cv::Mat& blob) {
  return fmt::format("{}", fmt::join(std::vector<int>(blob.size.p, blob.size.p + blob.dims), "x"));
}

class OpenCvNetwork : public Network {
 public:
  OpenCvNetwork(const OnnxFile& file, const std::vector<std::string>& outputs) : model_(file.path) {
    if (!file.weight_files.empty())
      throw make_run_error(model_, fmt::format("it: its weights are in another file, {}", file.weight_files.front().string()));
    const QuietOpenCv quiet;
    try {
      net_ = cv::dnn::readNetFromONNX(model_.string());
    } catch (const cv::Exception& e) {
      throw make_run_error(model_, summarize_importer_error(e.what()));
    }
    net_.setPreferableBackend(cv::dnn::DNN_BACKEND_OPENCV);
    net_.setPreferableTarget(cv::dnn::DNN_TARGET_CPU);
    for (const std::string& name : outputs)
      outputs_.push_back(*std::find_if(file.outputs.begin(), file.outputs.end(),
                                       [&](const TensorInfo& output) { return output.name == name; }));
    names_ = outputs;
    const std::vector<std::string> known = net_.getUnconnectedOutLayersNames();
    for (const std::string& name : names_)
      if (std::find(known.begin(), known.end(), name) == known.end())
        throw make_run_error(model_, fmt::format("it: it does not find the output '{}'", name));
  }

  std::string engine() const override { return "OpenCV " CV_VERSION; }
  bool runs_in_parallel() const override { return false; }
  std::vector<Tensor> run(const cv::Mat& image) const override {
    const std::scoped_lock lock(mutex_);
    const QuietOpenCv quiet;
    std::vector<Tensor> out;
    try {
      std::vector<cv::Mat> blobs;
      net_.setInput(image);
      net_.forward(blobs, names_);
      for (std::size_t i = 0; i < blobs.size(); ++i) out.push_back(to_tensor(blobs[i], outputs_[i]));
    } catch (const cv::Exception& e) {
      throw make_run_error(model_, find_failing_layer(image).value_or("it: " + extract_message(e.what())));
    }
    return out;
  }

 private:
  // Describes the first layer whose shapes cannot be inferred. Exceptions of a run do not name it.
  std::optional<std::string> find_failing_layer(const cv::Mat& image) const {
    const std::vector<int> shape(image.size.p, image.size.p + image.dims);
    for (const std::string& name : net_.getLayerNames()) {
      const int id = net_.getLayerId(name);
      std::vector<cv::dnn::MatShape> in, out;
      try {
        net_.getLayerShapes(shape, id, in, out);
      } catch (const cv::Exception& e) {
        return fmt::format("node '{}' ({}) on an input of {}: {}", find_node_name(name), net_.getLayer(id)->type,
                           format_shape(image), extract_message(e.what()));
      }
    }
    return std::nullopt;
  }

  fs::path model_;
  mutable cv::dnn::Net net_;
  std::vector<TensorInfo> outputs_;
  std::vector<std::string> names_;
  mutable std::mutex mutex_;
};

}  // namespace

std::string summarize_importer_error(const std::string& what) {
  const std::string node = extract_between(what, "> Node [", " parse error:");
  const std::string type = node.substr(0, node.find_first_of("@]")), name = extract_between(node + "\n", "]:(", ")\n");
  const std::string message = extract_message(what);
  return name.empty() ? message : fmt::format("node '{}' ({}): {}", find_node_name(name), type, message);
}

std::unique_ptr<Network> open_with_opencv(const OnnxFile& file, const std::vector<std::string>& outputs) {
  return std::make_unique<OpenCvNetwork>(file, outputs);
}

}  // namespace dvi::objects
