#include <cmath>
#include <cstdint>
#include <stdexcept>
#include <string_view>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "dvi/core/error.h"
#include "dvi/core/json_text.h"
#include "dvi/core/text.h"
#include "dvi/core/text_file.h"
#include "dvi/labels/image_labels.h"
#include "dvi/labels/labels.h"
#include "dvi/media/image_file.h"

namespace dvi::labels {
namespace {

using nlohmann::json;

cv::Point2d read_corner(const json& point) {
  const cv::Point2d corner(point.at(0).get<double>(), point.at(1).get<double>());
  if (!(std::abs(corner.x) <= kMaxCoordinatePx && std::abs(corner.y) <= kMaxCoordinatePx))
    throw std::invalid_argument("a corner lies far outside the image");
  return corner;
}

Polygon read_corners(const json& points) {
  if (points.size() > kMaxCorners) throw std::invalid_argument("a polygon has too many corners");
  Polygon corners;
  for (const json& point : points) corners.push_back(read_corner(point));
  return corners;
}

// A circle is given by its center and a point on its boundary.
Polygon make_circle(const cv::Point2d& center, const cv::Point2d& on_rim) {
  constexpr int kCircleSides = 64;
  const double radius = std::hypot(on_rim.x - center.x, on_rim.y - center.y) / std::cos(CV_PI / kCircleSides);
  Polygon corners;
  for (int i = 0; i < kCircleSides; ++i)
    corners.push_back(center +
                      radius * cv::Point2d(std::cos(2 * CV_PI * i / kCircleSides), std::sin(2 * CV_PI * i / kCircleSides)));
  return corners;
}

// Decodes base64. Throws std::invalid_argument if the text has other characters.
std::string decode_base64(std::string_view text) {
  constexpr std::string_view kDigits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string bytes;
  std::uint32_t bits = 0;
  int count = 0;
  for (const char c : text.substr(0, text.find('='))) {
    const std::size_t digit = kDigits.find(c);
    if (digit == std::string_view::npos) throw std::invalid_argument("a mask is not in base64");
    bits = bits << 6 | static_cast<std::uint32_t>(digit);
    count += 6;
    if (count < 8) continue;
    count -= 8;
    bytes += static_cast<char>(bits >> count & 0xFF);
  }
  return bytes;
}

// Reads a mask: a PNG file in base64, whose first pixel is at the first corner of its rectangle.
Instance read_mask(const json& shape, const cv::Point2d& corner, cv::Size size) {
  const std::string png = decode_base64(shape.at("mask").get<std::string>());
  const cv::Size part = media::image_size("the mask", png);
  const cv::Rect place(cv::Point(cvRound(corner.x), cvRound(corner.y)), part), image({0, 0}, size);
  cv::Mat1b mask = media::to_mask(media::decode_image("the mask", png, part));
  const cv::Rect shown = place & image;
  if (shown.empty()) return to_outline(cv::Mat1b(size, uchar{0}));
  return to_outline(mask(shown - place.tl()), shown.tl(), size);
}

class LabelMe {
 public:
  LabelMe(const fs::path& source, const Drive& drive) : labels_(source, drive) {}

  void read_shapes(const json& document, const std::string& frame) {
    labels_.know(frame);
    const bool wanted = labels_.wanted(frame);
    if (wanted && document.contains("imageWidth") && document.contains("imageHeight")) {
      constexpr int kMaxSidePx = 1 << 20;
      labels_.require_size(frame,
                           {static_cast<int>(to_whole_number(document.at("imageWidth"), "imageWidth", 0, kMaxSidePx)),
                            static_cast<int>(to_whole_number(document.at("imageHeight"), "imageHeight", 0, kMaxSidePx))});
    }
    for (const json& shape : document.at("shapes")) {
      if (!wanted)
        labels_.note(frame);
      else
        read_shape(shape, frame);
    }
  }

  NamedLabels take(const std::string& name) {
    if (left_out_ > 0)
      labels_.warn(fmt::format(
          "{}: {} points and lines are ignored: only polygons, rectangles, circles and masks are supported", name, left_out_));
    if (boxes_of_masks_ > 0)
      labels_.warn(fmt::format("{}: {} masks have no image; their rectangles are used", name, boxes_of_masks_));
    return labels_.take();
  }

 private:
  void read_shape(const json& shape, const std::string& frame) {
    const std::string type = shape.value("shape_type", "polygon");
    const Polygon corners = read_corners(shape.at("points"));
    Label label;
    label.type = to_lower_case(shape.at("label").get<std::string>());
    if (type == "polygon" && corners.size() > 2) return labels_.add_polygons(frame, std::move(label), {corners});
    if (type == "circle" && corners.size() == 2)
      return labels_.add_polygons(frame, std::move(label), {make_circle(corners[0], corners[1])});
    if (type == "oriented_rectangle" && corners.size() == 4) return labels_.add_polygons(frame, std::move(label), {corners});
    const bool has_mask = type == "mask" && shape.value("mask", json()).is_string();
    if (has_mask && corners.size() == 2)
      return labels_.add_outline(frame, std::move(label), read_mask(shape, corners[0], labels_.size()));
    if ((type == "rectangle" || type == "mask") && corners.size() >= 2) {
      boxes_of_masks_ += type == "mask" ? 1 : 0;
      const cv::Point2d &a = corners[0], &b = corners[corners.size() == 4 ? 2 : 1];  // LabelMe 5.6 and later write four corners
      return labels_.add_box(frame, std::move(label), {std::min(a.x, b.x), std::min(a.y, b.y)},
                             {std::max(a.x, b.x), std::max(a.y, b.y)});
    }
    ++left_out_;
  }

  ImageLabels labels_;
  std::size_t left_out_ = 0, boxes_of_masks_ = 0;
};

}  // namespace

NamedLabels read_labelme(const fs::path& source, const std::vector<fs::path>& files, const Drive& drive) {
  LabelMe labels(source, drive);
  std::vector<std::string> images;
  std::vector<json> documents;
  const auto read = [](const fs::path& file, const auto& parse) {
    try {
      parse();
    } catch (const json::exception& e) {
      throw InputError(file, e.what(), "see docs/masks.md for the supported parts of LabelMe");
    } catch (const std::invalid_argument& e) {
      throw InputError(file, e.what(), "see docs/masks.md for the supported parts of LabelMe");
    } catch (const InputError& e) {
      throw InputError(file, e.what());  // the error concerns a mask within the file
    }
  };
  for (const fs::path& file : files)
    read(file, [&] {
      json document = json::parse(read_text(file));
      document.erase("imageData");  // removes the embedded image to save memory
      const json name = document.value("imagePath", json());
      images.push_back(name.is_string() ? name.get<std::string>() : file.stem().string());
      documents.push_back(std::move(document));
    });
  const ImageFrames frames = find_image_frames(source, images, drive);
  for (std::size_t i = 0; i < files.size(); ++i)
    if (frames.frames[i]) read(files[i], [&] { labels.read_shapes(documents[i], *frames.frames[i]); });
  NamedLabels out = labels.take(source.filename().string());
  if (frames.warning) out.warnings.push_back(*frames.warning);
  return out;
}

}  // namespace dvi::labels
