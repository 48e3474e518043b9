#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include <opencv2/core/mat.hpp>
#include <opencv2/core/types.hpp>

#include "dvi/core/files.h"
#include "dvi/core/interrupt.h"

namespace dvi::metrics {

/// Parameters of the look of unobserved pixels.
struct LookParams {
  int band_px = 40;              ///< width of the surroundings
  int step_band_px = 8;          ///< width of the surroundings whose steps are compared with those at the boundary
  int margin_px = 2;             ///< on both sides of the boundary, whose gradients belong to neither side
  double radius_px = 120;        ///< of the surroundings of a cell
  std::size_t min_cells = 5;     ///< of the surroundings
  double tail_share = 0.1;       ///< share of the surroundings outside their range, at each end
  double blank_octaves = 1;      ///< below the range of the surroundings
  double step_noise = 1;         ///< gray levels, added to both mean steps
  double max_overlap = 0.3;      ///< of listed parts, intersection over union of their boxes, in any two frames
  std::size_t worst_parts = 6;   ///< listed parts
  std::size_t worst_frames = 5;  ///< listed frames
};
inline constexpr LookParams kLook;

/// Sums over unobserved pixels that are filled. The figures are nothing where there are no such pixels, or no surroundings.
struct LookSums {
  std::size_t pixels = 0;        ///< filled without an observation
  std::size_t image_pixels = 0;  ///< of the frames, also those without such pixels
  std::size_t judged = 0;        ///< pixels in cells with surroundings
  double texture_sum = 0;        ///< octaves times pixels
  double color_sum = 0;          ///< gray levels times pixels
  std::size_t blank_pixels = 0;
  std::size_t steps = 0, known_steps = 0;  ///< pairs of adjacent pixels across the boundary, and in the surroundings
  double step_sum = 0, known_step_sum = 0;

  LookSums& operator+=(const LookSums& other);

  std::optional<double> texture() const;   ///< octaves outside of the range of the surroundings' gradients
  std::optional<double> boundary() const;  ///< octaves by which steps across the boundary exceed those beside it; at least 0
  std::optional<double> color() const;     ///< gray levels outside of the range of the surroundings' colors
  std::optional<double> blank() const;     ///< share of the pixels without texture, 0 to 1
  std::optional<double> look() const;      ///< texture() + boundary(): 0 = as the surroundings, larger = worse
  std::optional<double> impact() const;    ///< look() times the percentage of the images that is unobserved
};

/// A connected part of the unobserved pixels of a frame.
struct LookPart {
  std::string frame;
  cv::Rect box;
  LookSums sums;
};

struct LookFrame {
  std::string name;
  LookSums sums;
  std::vector<LookPart> parts;
};

/// How different the unobserved pixels of a result look from their surroundings.
struct Look {
  LookSums total;
  std::vector<LookFrame> frames;  ///< in order

  /// Returns the frames with the largest impact, at most kLook.worst_frames.
  std::vector<LookFrame> find_worst_frames() const;

  /// Returns the parts with the largest impact, at most kLook.worst_parts. Parts that overlap a listed part are left out,
  /// because they are often the same surface in another frame.
  std::vector<LookPart> find_worst_parts() const;
};

/// A frame of a result.
struct LookImages {
  cv::Mat3b frame;
  cv::Mat1b kind;    ///< values of harmonize::Kind
  cv::Mat1b ground;  ///< 255 on the ground; empty if unknown
};

/// Measures the look of a frame without a name. Unobserved pixels that are left empty are not judged.
LookFrame measure_look(const LookImages& images);

/// Measures the look of the frames of a result (frames/, kind/; depth/ separates the ground from other surfaces if there is
/// one). Calls `tick` once per frame. With `filled`, the holes show another program's frames, whose file it returns for a name.
/// Returns nothing if no frame has unobserved pixels. Throws InputError if an image is missing or their sizes differ.
std::optional<Look> measure_look(
    const fs::path& out, const std::vector<std::string>& names, const Tick& tick = [] {},
    const std::function<fs::path(const std::string& name)>& filled = {});

}  // namespace dvi::metrics
