#include "dvi/result/frame_files.h"

#include "dvi/core/frame_name.h"
#include "dvi/depth/depth_map.h"
#include "dvi/harmonize/provenance.h"
#include "dvi/media/write_image.h"
#include "dvi/report/report.h"

namespace dvi::result {
namespace {

/// Converts depth to KITTI's format: meters times 256, 0 without depth.
cv::Mat1w encode_depth(const cv::Mat1f& z) {
  cv::Mat1w out(z.size(), ushort{0});
  for (int y = 0; y < z.rows; ++y)
    for (int x = 0; x < z.cols; ++x)
      if (depth::DepthMap::is_solid(z(y, x))) out(y, x) = cv::saturate_cast<ushort>(z(y, x) * 256);
  return out;
}

}  // namespace

void write_pictures(const OutputFrame& to, const harmonize::FilledFrame& frame, const Views& views) {
  const auto& [out, name, view] = to;
  cv::Mat3b color;
  frame.color.convertTo(color, CV_8U);
  const report::FramePictures pictures{.kind = frame.kind,
                                       .confidence = frame.confidence,
                                       .depth = encode_depth(frame.depth),
                                       .provenance = frame.provenance,
                                       .harmonization = harmonize::compute_harmonization(views, view, color, frame),
                                       .used = frame.used,
                                       .missing = {}};
  media::write_png(out / picture_file("masks", name), frame.mask);
  media::write_png(out / picture_file("kind", name), pictures.kind);
  media::write_png(out / picture_file("provenance", name), pictures.provenance);
  media::write_png(out / picture_file("sources_used", name), pictures.used);
  media::write_png(out / picture_file("harmonization", name), pictures.harmonization);
  media::write_png(out / picture_file("confidence", name), pictures.confidence);
  media::write_png(out / picture_file("depth", name), pictures.depth);
  media::write_png(out / picture_file("frames", name), color);
  report::write_frame(out, view, pictures, *views.images[view]);  // reading the pictures again would double the time
}

}  // namespace dvi::result
