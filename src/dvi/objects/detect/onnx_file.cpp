#include "dvi/objects/detect/onnx_file.h"

#include <fstream>
#include <set>

#include <fmt/format.h>
#include <fmt/ranges.h>

// The messages of Debian's library have its namespace and the types of ONNX-ML.
#define ONNX_ML 1
#define ONNX_NAMESPACE onnx
#include <onnx/onnx_pb.h>

#include "dvi/core/error.h"

namespace dvi::objects {
namespace {

ElementType to_element_type(int type) {
  switch (type) {
    case onnx::TensorProto::FLOAT:
      return ElementType::float32;
    case onnx::TensorProto::FLOAT16:
      return ElementType::float16;
    case onnx::TensorProto::DOUBLE:
      return ElementType::float64;
    case onnx::TensorProto::UINT8:
      return ElementType::uint8;
    case onnx::TensorProto::INT32:
      return ElementType::int32;
    case onnx::TensorProto::INT64:
      return ElementType::int64;
    case onnx::TensorProto::BOOL:
      return ElementType::boolean;
    default:
      return ElementType::other;
  }
}

TensorInfo to_info(const onnx::ValueInfoProto& value) {
  TensorInfo info{value.name(), to_element_type(value.type().tensor_type().elem_type()), {}};
  for (const auto& axis : value.type().tensor_type().shape().dim())
    info.shape.push_back(axis.has_dim_value() && axis.dim_value() > 0 ? axis.dim_value() : -1);
  return info;
}

// Returns the names of the files beside the network that have its weights.
std::set<std::string> list_weight_files(const onnx::GraphProto& graph) {
  std::set<std::string> files;
  for (const onnx::TensorProto& weights : graph.initializer()) {
    if (weights.data_location() != onnx::TensorProto::EXTERNAL) continue;
    for (const auto& entry : weights.external_data())
      if (entry.key() == "location") files.insert(entry.value());
  }
  return files;
}

onnx::ModelProto parse(const fs::path& path) {
  onnx::ModelProto model;
  std::ifstream in(path, std::ios::binary);
  if (!in || !model.ParseFromIstream(&in) || model.graph().node_size() == 0)
    throw InputError(path, "is not an ONNX file, or is damaged", "--detector takes a network exported to ONNX");
  return model;
}

}  // namespace

OnnxFile read_onnx_file(const fs::path& path) {
  require_regular_file(path);
  const onnx::ModelProto model = parse(path);
  OnnxFile out;
  out.path = path;
  std::set<std::string> constants;
  for (const onnx::TensorProto& weights : model.graph().initializer()) constants.insert(weights.name());
  for (const onnx::ValueInfoProto& input : model.graph().input())
    if (!constants.contains(input.name())) out.inputs.push_back(to_info(input));
  for (const onnx::ValueInfoProto& output : model.graph().output()) out.outputs.push_back(to_info(output));
  for (const auto& property : model.metadata_props()) out.metadata[property.key()] = property.value();
  for (const std::string& name : list_weight_files(model.graph())) {
    const fs::path file = path.parent_path() / name;
    if (!fs::is_regular_file(file))
      throw InputError(path, fmt::format("has its weights in {}, which does not exist", file.string()),
                       "copy this file beside the network, or export the network into one file");
    out.weight_files.push_back(file);
  }
  return out;
}

std::string format_shapes(const std::vector<TensorInfo>& tensors) {
  std::vector<std::string> texts;
  for (const TensorInfo& tensor : tensors) {
    std::vector<std::string> axes;
    for (const std::int64_t size : tensor.shape) axes.push_back(size < 0 ? "?" : std::to_string(size));
    texts.push_back(fmt::format("{} {} {}", tensor.name, dvi::to_string(tensor.type), fmt::join(axes, "x")));
  }
  return fmt::format("{}", fmt::join(texts, ", "));
}

}  // namespace dvi::objects
