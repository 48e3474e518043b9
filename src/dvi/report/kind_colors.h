#pragma once

#include <array>

#include <opencv2/core/matx.hpp>

namespace dvi::report {

/// A kind of pixel (harmonize::Kind) in pictures: its name, and a color (BGR) by Okabe and Ito, which color-blind people can
/// tell from the others. page/texts.js has the same.
struct KindColor {
  const char* name;
  cv::Vec3b color;
};
inline const std::array<KindColor, 6> kKindColors{{{"original", {0, 0, 0}},
                                                   {"copied", {178, 114, 0}},
                                                   {"from elsewhere", {233, 180, 86}},
                                                   {"interpolated", {0, 159, 230}},
                                                   {"synthesized", {167, 121, 204}},
                                                   {"left empty", {153, 153, 153}}}};

}  // namespace dvi::report
