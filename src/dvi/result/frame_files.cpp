#include "dvi/result/frame_files.h"

#include "dvi/depth/depth_map.h"
#include "dvi/harmonize/provenance.h"
#include "dvi/media/write_image.h"
#include "dvi/report/report.h"

namespace dvi::result {
namespace {

// KITTI's convention: meters x 256, 0 where there is none.
cv::Mat1w depth_image(const cv::Mat1f& z) {
  cv::Mat1w out(z.size(), ushort{0});
  for (int y = 0; y < z.rows; ++y)
    for (int x = 0; x < z.cols; ++x)
      if (depth::DepthMap::is_solid(z(y, x))) out(y, x) = cv::saturate_cast<ushort>(z(y, x) * 256);
  return out;
}

}  // namespace

void write_pictures(const fs::path& out, const std::string& name, const harmonize::FilledFrame& frame, const Views& views,
                    std::size_t view) {
  cv::Mat3b color;
  frame.color.convertTo(color, CV_8U);
  const std::string png = name + ".png";
  const report::FramePictures receipts{.kind = frame.kind,
                                       .confidence = frame.confidence,
                                       .depth = depth_image(frame.depth),
                                       .provenance = frame.provenance,
                                       .harmonization = harmonize::compute_harmonization(views, view, color, frame),
                                       .used = frame.used,
                                       .missing = {}};
  media::write_png(out / "masks" / png, frame.mask);
  media::write_png(out / "kind" / png, receipts.kind);
  media::write_png(out / "provenance" / png, receipts.provenance);
  media::write_png(out / "sources_used" / png, receipts.used);
  media::write_png(out / "harmonization" / png, receipts.harmonization);
  media::write_png(out / "confidence" / png, receipts.confidence);
  media::write_png(out / "depth" / png, receipts.depth);
  media::write_png(out / "frames" / png, color);
  report::write_frame(out, view, receipts, *views.images[view]);  // at hand here: reading all again takes twice as long
}

}  // namespace dvi::result
