#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "dvi/core/files.h"
#include "dvi/core/named.h"

namespace dvi::objects {

/// The types of numbers that inputs and outputs of a network may have.
enum class ElementType { float32, float16, float64, uint8, int32, int64, boolean, other };
constexpr auto names_of(ElementType) {
  return std::array{std::pair{ElementType::float32, "float32"}, std::pair{ElementType::float16, "float16"},
                    std::pair{ElementType::float64, "float64"}, std::pair{ElementType::uint8, "uint8"},
                    std::pair{ElementType::int32, "int32"},     std::pair{ElementType::int64, "int64"},
                    std::pair{ElementType::boolean, "bool"},    std::pair{ElementType::other, "another type"}};
}

/// An input or output that an ONNX file declares.
struct TensorInfo {
  std::string name;
  ElementType type = ElementType::float32;
  std::vector<std::int64_t> shape;  ///< -1 for an axis of any size; empty if no shape is declared
};

/// The declarations of an ONNX file, without its nodes and weights.
struct OnnxFile {
  fs::path path;
  std::vector<TensorInfo> inputs;  ///< those without a constant value
  std::vector<TensorInfo> outputs;
  std::map<std::string, std::string> metadata;  ///< properties that the exporter wrote
  std::vector<fs::path> weight_files;           ///< files with weights, beside the network
};

/// Reads an ONNX file. Throws InputError if it does not exist, is not an ONNX file or damaged, or if a file with its weights is
/// missing.
OnnxFile read_onnx_file(const fs::path& path);

/// Formats the declarations: "images float32 1x3x?x?".
std::string format_shapes(const std::vector<TensorInfo>& tensors);

}  // namespace dvi::objects
