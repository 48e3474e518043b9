#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "dvi/depth/target.h"
#include "dvi/drive/view.h"
#include "dvi/sample/candidates.h"

namespace dvi::regularize {

/// The neighbors of a pixel: left, up, right, down. The opposite of direction d is d ^ 2.
inline constexpr std::array<std::array<int, 2>, 4> kDirections{{{-1, 0}, {0, -1}, {1, 0}, {0, 1}}};

/// Eqs. 2-4 once all colors are sampled: a node a hole pixel with a candidate, a label a shift of that candidate.
struct ShiftField {
  std::vector<cv::Point> shifts;             ///< of each label, shortest first; label 0 is no shift
  int stride = 0;                            ///< labels, padded to whole blocks of kLanes
  std::vector<int> pixel;                    ///< of each node, its number in the hole; ascending
  std::vector<std::array<int, 4>> neighbor;  ///< of each node and direction: a node, or -1
  std::vector<std::uint8_t> colors;          ///< rows of 3 x stride: a color a label; row i is what node i copies
  std::vector<std::array<int, 4>> expected;  ///< row with the colors a node's source expects of its neighbor, or -1
  std::vector<std::int16_t> data;            ///< eq. 3: stride a node

  int labels() const { return static_cast<int>(shifts.size()); }
  std::size_t nodes() const { return pixel.size(); }
  const std::uint8_t* row(int i) const { return &colors[static_cast<std::size_t>(i) * 3 * stride]; }
  const std::int16_t* data_of(std::size_t node) const { return &data[node * stride]; }
};

/// Added to the data cost of shifts that leave the source's image or enter its mask: more than all else can add up to.
inline constexpr int kForbidden = 8192;

/// The integer shifts of a window x window neighborhood, shortest first.
std::vector<cv::Point> window_shifts(int window);

/// Samples all colors, one source image at a time.
ShiftField shift_field(const sample::Candidates& candidates, const depth::Target& target, int window, double alpha);

}  // namespace dvi::regularize
