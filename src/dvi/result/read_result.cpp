#include "dvi/result/read_result.h"

#include <cstddef>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include <opencv2/core.hpp>

#include "dvi/core/frame_name.h"
#include "dvi/depth/depth_map.h"
#include "dvi/depth/occluders.h"
#include "dvi/media/image_file.h"

namespace dvi::result {
namespace {

/// Finds the things in front of the static scene in a frame of the result; empty without returns.
cv::Mat1b find_things(const fs::path& out, const std::string& name, cv::Size size, const std::vector<ImageReturn>& returns) {
  if (returns.empty()) return {};
  depth::DepthMap depth;
  media::read_indices(out / picture_file("depth", name), size).convertTo(depth.z, CV_32F, 1.0 / 256);
  depth.z.setTo(depth::DepthMap::kSky, depth.z == 0);  // the file does not distinguish it from unknown depth
  return depth::find_occluders(depth, returns);
}

}  // namespace

objects::ReadResult make_result_reader(const ResultOfCamera& result, const Drive& drive, const Views& views) {
  std::map<std::size_t, std::size_t> view_of_frame;
  const auto [first, last] = views.of_sequence(result.sequence);
  for (std::size_t i = first; i < last; ++i) view_of_frame[views[i].frame] = i;
  return [&drive, &views, result, view_of_frame](std::size_t frame) -> std::optional<objects::ResultImages> {
    const auto view = view_of_frame.find(frame);
    if (view == view_of_frame.end()) return std::nullopt;
    const fs::path& out = result.out;
    const std::string name = join_frame_name(result.camera, drive.frames[frame].name);
    const cv::Mat3b input = *views.images[view->second];
    const cv::Mat1b kind = media::read_indices(out / picture_file("kind", name), input.size());
    const auto returns = views.returns.empty() ? nullptr : views.returns[view->second];
    return objects::ResultImages{input, media::read_image(out / picture_file("frames", name), input.size()),
                                 cv::Mat1b(kind != 0), cv::Mat1b((kind == 1) | (kind == 2)),
                                 returns ? find_things(out, name, input.size(), *returns) : cv::Mat1b()};
  };
}

}  // namespace dvi::result
