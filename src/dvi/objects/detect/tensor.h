#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include <opencv2/core/mat.hpp>

namespace dvi::objects {

/// An output of a network, converted to float.
struct Tensor {
  std::string name;
  std::vector<int> shape;
  std::vector<float> values;       ///< in row-major order
  bool has_whole_numbers = false;  ///< whether the network declares it as integers

  int rank() const { return static_cast<int>(shape.size()); }
  /// Returns the size of an axis, counted from the last one, which is 0; 1 for further axes.
  int size_from_end(int axis) const { return axis < rank() ? shape[shape.size() - 1 - static_cast<std::size_t>(axis)] : 1; }
  int rows() const { return size_from_end(1); }
  int cols() const { return size_from_end(0); }
  /// Returns the number of planes of rows x cols.
  int planes() const { return rows() * cols() == 0 ? 0 : static_cast<int>(values.size()) / (rows() * cols()); }
  const float* row(int row) const { return values.data() + static_cast<std::ptrdiff_t>(row) * cols(); }
  /// Returns a view of a plane. It is valid as long as this tensor.
  cv::Mat1f plane(int plane) const {
    const std::ptrdiff_t offset = static_cast<std::ptrdiff_t>(plane) * rows() * cols();
    return {rows(), cols(), const_cast<float*>(values.data()) + offset};
  }
};

/// Formats shapes, with names where there are any: "boxes 100x4, labels 100".
std::string format_shapes(const std::vector<Tensor>& tensors);

}  // namespace dvi::objects
