#include "dvi/pipeline/frame_files.h"

#include "dvi/depth/depth_map.h"
#include "dvi/harmonize/receipt.h"
#include "dvi/io/write_image.h"

namespace dvi::pipeline {
namespace {

// KITTI's convention: metres x 256, 0 where there is none.
cv::Mat1w depth_image(const cv::Mat1f& z) {
  cv::Mat1w out(z.size(), ushort{0});
  for (int y = 0; y < z.rows; ++y)
    for (int x = 0; x < z.cols; ++x)
      if (depth::DepthMap::is_surface(z(y, x)) && z(y, x) < depth::DepthMap::kInfinity)
        out(y, x) = cv::saturate_cast<ushort>(z(y, x) * 256);
  return out;
}

}  // namespace

void write_pictures(const fs::path& out, const std::string& name, const harmonize::FilledFrame& frame, const Views& views,
                    std::size_t view) {
  cv::Mat3b colour;
  frame.colour.convertTo(colour, CV_8U);
  const std::string png = name + ".png";
  io::write_png(out / "masks" / png, frame.mask);
  io::write_png(out / "kind" / png, frame.kind);
  io::write_png(out / "provenance" / png, frame.provenance);
  io::write_png(out / "sources_used" / png, frame.used);
  io::write_png(out / "harmonisation" / png, harmonize::harmonisation(views, view, colour, frame.provenance, frame.used));
  io::write_png(out / "confidence" / png, frame.confidence);
  io::write_png(out / "depth" / png, depth_image(frame.depth));
  io::write_png(out / "frames" / png, colour);
}

}  // namespace dvi::pipeline
