#include "dvi/harmonize/provenance.h"

#include <cmath>
#include <cstdint>
#include <map>
#include <vector>

#include "dvi/image/interpolate.h"

namespace dvi::harmonize {

cv::Vec3w Provenance::encode(int view, cv::Point2f position) {
  const auto to_sixteenths = [](float v) { return static_cast<std::uint16_t>(std::lround(v * kSubpixel)); };
  return {static_cast<std::uint16_t>(view + 1), to_sixteenths(position.x), to_sixteenths(position.y)};
}

Provenance Provenance::decode(const cv::Vec3w& triple, const cv::Vec3b& used) {
  return {static_cast<int>(triple[0]) - 1,
          {static_cast<float>(triple[1]) / kSubpixel, static_cast<float>(triple[2]) / kSubpixel},
          {used[1], used[0]}};
}

cv::Vec3i copy_color(const Views& views, std::size_t target, const cv::Mat3b& source_image, const Provenance& from) {
  const cv::Vec3f color = box_mean(source_image, from.position, from.footprint);
  const cv::Vec3f gain = gain_to(views[target], views[static_cast<std::size_t>(from.view)]);
  cv::Vec3i out;
  for (int c = 0; c < 3; ++c) out[c] = static_cast<int>(std::lround(color[c] * gain[c]));
  return out;
}

cv::Mat_<cv::Vec3w> compute_harmonization(const Views& views, std::size_t target, const cv::Mat3b& written,
                                          const FilledFrame& frame) {
  const cv::Mat_<cv::Vec3w>& provenance = frame.provenance;
  cv::Mat_<cv::Vec3w> out(written.size(), cv::Vec3w());
  std::map<int, std::vector<cv::Point>> of_view;  // each source is decoded once
  for (int y = 0; y < written.rows; ++y)
    for (int x = 0; x < written.cols; ++x)
      if (provenance(y, x)[0] > 0) of_view[provenance(y, x)[0] - 1].emplace_back(x, y);
  for (const auto& [view, pixels] : of_view) {
    const auto image = views.images[static_cast<std::size_t>(view)];
    for (const cv::Point p : pixels) {
      const Provenance from = Provenance::decode(provenance(p), frame.used(p));
      const cv::Vec3i change = cv::Vec3i(written(p)) - copy_color(views, target, *image, from);
      for (int c = 0; c < 3; ++c) out(p)[2 - c] = cv::saturate_cast<ushort>(change[c] + kNoChange);
    }
  }
  return out;
}

}  // namespace dvi::harmonize
