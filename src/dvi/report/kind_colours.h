#pragma once

#include <array>

#include <opencv2/core/matx.hpp>

namespace dvi::report {

/// A kind of pixel (harmonize::Kind) in pictures: its name, and a colour (BGR) by Okabe and Ito, which colour-blind people can
/// tell from the others. page/texts.js has the same.
struct KindColour {
  const char* name;
  cv::Vec3b colour;
};
inline const std::array<KindColour, 6> kKindColours{{{"original", {0, 0, 0}},
                                                     {"copied", {178, 114, 0}},
                                                     {"from elsewhere", {233, 180, 86}},
                                                     {"interpolated", {0, 159, 230}},
                                                     {"synthesised", {167, 121, 204}},
                                                     {"left empty", {153, 153, 153}}}};

}  // namespace dvi::report
