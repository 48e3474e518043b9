#include "dvi/result/frame_files.h"

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
  const std::string png = name + ".png";
  const report::FramePictures pictures{.kind = frame.kind,
                                       .confidence = frame.confidence,
                                       .depth = encode_depth(frame.depth),
                                       .provenance = frame.provenance,
                                       .harmonization = harmonize::compute_harmonization(views, view, color, frame),
                                       .used = frame.used,
                                       .missing = {}};
  media::write_png(out / "masks" / png, frame.mask);
  media::write_png(out / "kind" / png, pictures.kind);
  media::write_png(out / "provenance" / png, pictures.provenance);
  media::write_png(out / "sources_used" / png, pictures.used);
  media::write_png(out / "harmonization" / png, pictures.harmonization);
  media::write_png(out / "confidence" / png, pictures.confidence);
  media::write_png(out / "depth" / png, pictures.depth);
  media::write_png(out / "frames" / png, color);
  report::write_frame(out, view, pictures, *views.images[view]);  // reading the pictures again would double the time
}

}  // namespace dvi::result
