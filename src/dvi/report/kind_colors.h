#pragma once

#include <array>

#include <opencv2/core/matx.hpp>

namespace dvi::report {

/// The name of a kind of pixel (harmonize::Kind) and its color (BGR) in images. The colors are those of Okabe and Ito, which
/// color-blind people can distinguish. page/texts.js has the same colors.
struct KindColor {
  const char* name;
  cv::Vec3b color;
};
inline const std::array<KindColor, 7> kKindColors{{{"original", {0, 0, 0}},
                                                   {"copied", {178, 114, 0}},
                                                   {"from elsewhere", {233, 180, 86}},
                                                   {"interpolated", {0, 159, 230}},
                                                   {"synthesized", {167, 121, 204}},
                                                   {"left empty", {153, 153, 153}},
                                                   {"imported", {115, 158, 0}}}};

}  // namespace dvi::report
