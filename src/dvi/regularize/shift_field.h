#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "dvi/depth/target.h"
#include "dvi/drive/view.h"
#include "dvi/sample/candidates.h"

namespace dvi::regularize {

/// Offsets to the neighbors of a pixel: left, up, right, down. The opposite of direction d is d ^ 2.
inline constexpr std::array<std::array<int, 2>, 4> kDirections{{{-1, 0}, {0, -1}, {1, 0}, {0, 1}}};

/// The MRF of eqs. 2-4 with sampled colors. A node is a hole pixel with a candidate; a label is a shift of that candidate.
struct ShiftField {
  std::vector<cv::Point> shifts;             ///< The shift of each label, shortest first; label 0 is the zero shift.
  int stride = 0;                            ///< Number of labels, padded to whole blocks of kLanes.
  std::vector<int> pixel;                    ///< The index of each node's pixel in the hole, ascending.
  std::vector<std::array<int, 4>> neighbor;  ///< The neighbor of each node in each direction; -1: none.
  std::vector<std::uint8_t> colors;          ///< Rows of 3 x stride, one color per label; row i has the colors of node i.
  std::vector<std::array<int, 4>>
      expected;                    ///< The row with the colors of a neighbor in the source of the node; -1: not shown.
  std::vector<std::int16_t> data;  ///< Data costs (eq. 3): `stride` values per node.

  int labels() const { return static_cast<int>(shifts.size()); }
  std::size_t nodes() const { return pixel.size(); }
  const std::uint8_t* row(int i) const { return &colors[static_cast<std::size_t>(i) * 3 * stride]; }
  const std::int16_t* data_of(std::size_t node) const { return &data[node * stride]; }
};

/// The data cost of shifts to positions outside the source's image or inside its mask; larger than the sum of all other costs.
inline constexpr int kForbiddenCost = 8192;

/// Lists the integer shifts of a window x window neighborhood, shortest first.
std::vector<cv::Point> list_shifts(int window);

/// Samples all colors, one source image at a time. `alpha` is the data cost of pixels that are not at the boundary.
ShiftField make_shift_field(const sample::Candidates& candidates, const depth::Target& target, int window, double alpha);

}  // namespace dvi::regularize
