#include "dvi/pipeline/frame_files.h"

#include "dvi/depth/depth_map.h"
#include "dvi/harmonize/receipt.h"
#include "dvi/io/write_image.h"
#include "dvi/report/report.h"

namespace dvi::pipeline {
namespace {

// KITTI's convention: metres x 256, 0 where there is none.
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
  cv::Mat3b colour;
  frame.colour.convertTo(colour, CV_8U);
  const std::string png = name + ".png";
  const report::FramePictures receipts{
      .kind = frame.kind,
      .confidence = frame.confidence,
      .depth = depth_image(frame.depth),
      .provenance = frame.provenance,
      .harmonisation = harmonize::harmonisation(views, view, colour, frame.provenance, frame.used),
      .used = frame.used,
      .missing = {}};
  io::write_png(out / "masks" / png, frame.mask);
  io::write_png(out / "kind" / png, receipts.kind);
  io::write_png(out / "provenance" / png, receipts.provenance);
  io::write_png(out / "sources_used" / png, receipts.used);
  io::write_png(out / "harmonisation" / png, receipts.harmonisation);
  io::write_png(out / "confidence" / png, receipts.confidence);
  io::write_png(out / "depth" / png, receipts.depth);
  io::write_png(out / "frames" / png, colour);
  report::write_frame(out, view, receipts, *views.images[view]);  // at hand here: reading all again takes twice as long
}

}  // namespace dvi::pipeline
