#include "dvi/report/frame_pictures.h"

#include <exception>

#include "dvi/core/error.h"
#include "dvi/core/frame_name.h"
#include "dvi/media/image_file.h"
#include "dvi/media/write_image.h"

namespace dvi::report {

FramePictures read_pictures(const fs::path& out, const std::string& name, bool all) {
  FramePictures pictures;
  cv::Size size;
  const auto read = [&](const char* folder, auto& picture, const auto& reader) {
    const std::string file = picture_file(folder, name);
    try {
      if (size.empty()) size = media::image_size(out / file);
      picture = reader(out / file, size);
    } catch (const InputError&) {  // the page shows what is missing
      pictures.missing.push_back(file);
    }
  };
  read("kind", pictures.kind, media::read_png_gray);
  if (pictures.kind.empty()) return pictures;  // the other images depend on it
  read("confidence", pictures.confidence, media::read_png_gray);
  read("depth", pictures.depth, media::read_png_depth);
  if (!all) return pictures;
  read("provenance", pictures.provenance, media::read_png_triples);
  read("harmonization", pictures.harmonization, media::read_png_triples);
  read("sources_used", pictures.used, media::read_image);
  return pictures;
}

cv::Mat3b read_frame(const fs::path& file, cv::Size size) {
  try {
    return media::read_image(file, size);
  } catch (const InputError&) {  // the page shows what is missing
    return {};
  }
}

}  // namespace dvi::report
