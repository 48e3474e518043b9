#include "dvi/media/write_ply.h"

#include <bit>
#include <cstring>
#include <filesystem>
#include <ios>
#include <ostream>
#include <stdexcept>
#include <string>

#include "dvi/core/files.h"
#include "dvi/core/scratch.h"

namespace dvi::media {
namespace {

static_assert(std::endian::native == std::endian::little, "points are written as they lie in memory");

std::string make_header(const PlyCloud& cloud) {
  std::string text = "ply\nformat binary_little_endian 1.0\n";
  if (!cloud.comment.empty()) text += "comment " + cloud.comment + "\n";
  text += "element vertex " + std::to_string(cloud.points.size()) + "\n";
  for (const char* axis : {"x", "y", "z"})
    text += std::string("property ") + (cloud.origin.isZero() ? "float " : "double ") + axis + "\n";
  if (!cloud.colors.empty())
    for (const char* channel : {"red", "green", "blue"}) text += std::string("property uchar ") + channel + "\n";
  for (const PlyScalar& scalar : cloud.scalars) text += "property float " + scalar.name + "\n";
  return text + "end_header\n";
}

void append(std::string& bytes, const void* data, std::size_t size) { bytes.append(static_cast<const char*>(data), size); }

void append_point(std::string& bytes, const PlyCloud& cloud, std::size_t i) {
  if (cloud.origin.isZero()) {
    append(bytes, cloud.points[i].data(), 3 * sizeof(float));
  } else {
    const Eigen::Vector3d position = cloud.origin + cloud.points[i].cast<double>();
    append(bytes, position.data(), 3 * sizeof(double));
  }
  if (!cloud.colors.empty()) {
    const cv::Vec3b& c = cloud.colors[i];
    const cv::Vec3b rgb(c[2], c[1], c[0]);
    append(bytes, rgb.val, 3);
  }
  for (const PlyScalar& scalar : cloud.scalars) append(bytes, &scalar.values[i], sizeof(float));
}

void require_one_per_point(const PlyCloud& cloud) {
  const std::size_t count = cloud.points.size();
  bool fits = cloud.colors.empty() || cloud.colors.size() == count;
  for (const PlyScalar& scalar : cloud.scalars) fits = fits && scalar.values.size() == count;
  if (!fits) throw std::logic_error("the properties of a PLY need one value per point");
}

}  // namespace

void write_ply(const fs::path& path, const PlyCloud& cloud) {
  require_one_per_point(cloud);
  constexpr std::size_t kChunkBytes = std::size_t{1} << 20;
  write_stream(path, [&](std::ostream& out) {
    std::string bytes = make_header(cloud);
    const auto flush = [&] {
      out.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
      bytes.clear();
    };
    for (std::size_t i = 0; i < cloud.points.size(); ++i) {
      page_out_sometimes(i);
      append_point(bytes, cloud, i);
      if (bytes.size() >= kChunkBytes) flush();
    }
    flush();
  });
}

}  // namespace dvi::media
