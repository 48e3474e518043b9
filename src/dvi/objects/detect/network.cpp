#include "dvi/objects/detect/network.h"

#include <algorithm>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "dvi/core/error.h"
#include "dvi/objects/detect/onnx_runtime.h"

namespace dvi::objects {

std::string format_shapes(const std::vector<Tensor>& tensors) {
  std::vector<std::string> texts;
  for (const Tensor& tensor : tensors) texts.push_back(fmt::format("{} {}", tensor.name, fmt::join(tensor.shape, "x")));
  return fmt::format("{}", fmt::join(texts, ", "));
}

std::unique_ptr<Network> open_network(const OnnxFile& file, const std::vector<std::string>& outputs) {
  std::vector<std::string> names;
  for (const TensorInfo& output : file.outputs) names.push_back(output.name);
  for (const std::string& name : outputs)
    if (std::find(names.begin(), names.end(), name) == names.end())
      throw InputError(file.path, fmt::format("has no output '{}'", name), fmt::format("it has {}", fmt::join(names, ", ")));
  const std::vector<std::string>& used = outputs.empty() ? names : outputs;
  if (const std::shared_ptr<const OnnxRuntime> runtime = OnnxRuntime::of_process()) return runtime->open(file, used);
  return open_with_opencv(file, used);
}

}  // namespace dvi::objects
