#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>
#include <string_view>

#include <fmt/format.h>
#include <pugixml.hpp>

#include "dvi/core/error.h"
#include "dvi/core/text.h"
#include "dvi/geometry/angles.h"
#include "dvi/labels/image_labels.h"
#include "dvi/labels/labels.h"

namespace dvi::labels {
namespace {

/// A <box>, <polygon> or <mask>.
struct Shape {
  int frame = 0;
  bool outside = false;
  double turn_deg = 0;  ///< clockwise rotation of a box about its center
  Polygon corners;      ///< of a box, the first and the last corner
  Instance mask;
  enum class Kind { box, polygon, mask } kind = Kind::box;
};

/// An element and its file, for messages.
class Element {
 public:
  Element(const fs::path& file, const pugi::xml_node& node) : file_(file), node_(node) {}

  [[noreturn]] void fail(const std::string& problem) const {
    throw InputError(file_, fmt::format("<{}> at byte {}: {}", node_.name(), node_.offset_debug(), problem),
                     "see docs/masks.md for the supported parts of CVAT");
  }
  std::string text(const char* name) const {
    if (!node_.attribute(name)) fail(fmt::format("has no attribute {}", name));
    return node_.attribute(name).value();
  }
  int whole(const char* name) const {
    const auto value = to_integer(text(name));
    if (!value || *value < 0) fail(fmt::format("{}=\"{}\" is not a whole number of at least 0", name, text(name)));
    return *value;
  }
  double place(const char* name) const { return coordinate(text(name)); }
  bool is_set(const char* name) const {
    const std::string value = node_.attribute(name) ? text(name) : "0";
    if (value != "0" && value != "1") fail(fmt::format("{}=\"{}\" is neither 0 nor 1", name, value));
    return value == "1";
  }
  double angle(const char* name) const {
    const auto value = node_.attribute(name) ? to_number(text(name)) : 0.0;
    if (!value) fail(fmt::format("{}=\"{}\" is not a number", name, text(name)));
    return std::remainder(*value, 360.0);
  }
  /// Reads corners "x,y;x,y;...".
  Polygon points() const {
    const std::string all = text("points");
    Polygon out;
    for (std::size_t at = 0; at < all.size();) {
      const std::size_t end = std::min(all.find(';', at), all.size()), comma = all.find(',', at);
      if (comma >= end) fail("its points are not x,y;x,y;...");
      out.emplace_back(coordinate(std::string_view(all).substr(at, comma - at)),
                       coordinate(std::string_view(all).substr(comma + 1, end - comma - 1)));
      if (out.size() > kMaxCorners) fail("has too many points");
      at = end + 1;
    }
    if (out.size() < 3) fail("has fewer than three points");
    return out;
  }
  /// Reads run lengths along the rows of a part of the image, beginning with background: "3, 5, 3".
  Instance outline(cv::Size size) const {
    const cv::Rect part(whole("left"), whole("top"), whole("width"), whole("height"));
    const auto within = [](int first, int length, int end) { return std::int64_t{first} + length <= end; };
    if (!within(part.x, part.width, size.width) || !within(part.y, part.height, size.height)) fail("extends beyond the image");
    cv::Mat1b mask(part.size(), uchar{0});
    const std::string all = text("rle");
    uchar value = 0;
    std::int64_t at = 0;
    for (const char *from = all.data(), *end = from + all.size(); from != end; value = value ? 0 : 255) {
      std::uint32_t run = 0;
      const auto [after, error] = std::from_chars(from, end, run);
      if (error != std::errc() || at + run > part.area()) fail("its rle is not the lengths of runs that fill width x height");
      std::fill_n(mask.data + at, run, value);
      at += run;
      for (from = after; from != end && (*from == ',' || *from == ' ');) ++from;
    }
    if (at != part.area()) fail("its rle is not the lengths of runs that fill width x height");
    return to_outline(mask, part.tl(), size);
  }

 private:
  double coordinate(std::string_view text) const {
    const auto value = to_number(text);
    if (!value || std::abs(*value) > kMaxCoordinatePx) fail(fmt::format("'{}' is not a position in an image", text));
    return *value;
  }

  const fs::path& file_;
  pugi::xml_node node_;
};

// Reads a shape. Returns nothing for an element that encloses no area.
std::optional<Shape> read_shape(const fs::path& file, const pugi::xml_node& node, cv::Size size) {
  const std::string_view name = node.name();
  const Element element(file, node);
  Shape shape;
  if (name == "box") {
    shape.corners = {{element.place("xtl"), element.place("ytl")}, {element.place("xbr"), element.place("ybr")}};
    if (shape.corners[1].x < shape.corners[0].x || shape.corners[1].y < shape.corners[0].y)
      element.fail("its second corner is left of or above the first");
    shape.turn_deg = element.angle("rotation");
  } else if (name == "polygon") {
    shape.kind = Shape::Kind::polygon;
    shape.corners = element.points();
  } else if (name == "mask") {
    shape.kind = Shape::Kind::mask;
    shape.mask = element.outline(size);
  } else {
    return std::nullopt;
  }
  return shape;
}

// Interpolates between two keyframes like CVAT.
Shape interpolate(const Shape& a, const Shape& b, int frame) {
  const double t = (static_cast<double>(frame) - a.frame) / (static_cast<double>(b.frame) - a.frame);
  if (a.kind != b.kind || a.kind == Shape::Kind::mask || a.corners.size() != b.corners.size()) return t < 0.5 ? a : b;
  Shape out = a;
  for (std::size_t i = 0; i < out.corners.size(); ++i) out.corners[i] += t * (b.corners[i] - a.corners[i]);
  out.turn_deg += t * std::remainder(b.turn_deg - a.turn_deg, 360.0);
  return out;
}

Polygon rotate_box(const cv::Point2d& low, const cv::Point2d& high, double degrees) {
  const double angle = to_radians(degrees), c = std::cos(angle), s = std::sin(angle);
  const cv::Point2d middle = 0.5 * (low + high);
  Polygon out{low, {high.x, low.y}, high, {low.x, high.y}};
  for (cv::Point2d& p : out) {
    const cv::Point2d d = p - middle;
    p = middle + cv::Point2d(c * d.x - s * d.y, s * d.x + c * d.y);
  }
  return out;
}

/// The frames of a video that a task has. CVAT numbers them as in the video.
struct Task {
  int start = 0, stop = std::numeric_limits<int>::max(), step = 1;
  bool is_drive = false;  ///< whether the drive's images are those of the task, which is a part of a video

  std::int64_t frames() const { return (std::int64_t{stop} - start) / step + 1; }
  bool has(int frame) const { return (frame - start) % step == 0; }
  int index_of(int frame) const { return is_drive ? (frame - start) / step : frame; }
};

class Cvat {
 public:
  Cvat(const fs::path& file, const Drive& drive)
      : file_(file), drive_(drive), labels_(file, drive), order_(list_names_in_order(drive)) {}

  NamedLabels read(const pugi::xml_node& annotations) {
    read_task(annotations.child("meta"));
    read_images(annotations);
    if (annotations.child("track")) place_task();
    if (annotations.child("track"))
      for (int i = 0; i < last_frame(); ++i) labels_.know(order_[static_cast<std::size_t>(i)]);
    for (const pugi::xml_node& track : annotations.children("track")) read_track(track);
    if (strays_ > 0 && within_ == 0)
      throw InputError(
          file_,
          fmt::format(
              "has no shape in a frame of the drive: its shapes are in frames {} to {}, but the drive's images are 0 to {}",
              first_stray_, last_stray_, order_.size() - 1),
          "frame n of a track must be the n-th image of the drive, from 0");
    say_left_out();
    return labels_.take();
  }

 private:
  // Tasks and jobs have the same description.
  void read_task(const pugi::xml_node& meta) {
    for (const char* kind : {"task", "job"}) {
      const pugi::xml_node task = meta.child(kind);
      const auto number = [&](const char* name) { return to_integer(task.child_value(name)); };
      if (const auto start = number("start_frame"); start && *start >= 0) task_.start = *start;
      const std::string_view filter = task.child_value("frame_filter");
      if (filter.starts_with("step="))
        if (const auto step = to_integer(filter.substr(5)); step && *step > 0) task_.step = *step;
      if (const auto stop = number("stop_frame"))
        task_.stop = *stop;
      else if (const auto size = number("size"); size && *size > 0)
        task_.stop = *size - 1;
      const pugi::xml_node size = task.child("original_size");
      const auto width = to_integer(size.child_value("width")), height = to_integer(size.child_value("height"));
      if (width && height) labels_.require_size("the task", {*width, *height});
    }
  }

  // Maps the frames of a task that is a part of a video to the drive's images.
  void place_task() {
    if (task_.start == 0 && task_.step == 1) return;
    const std::string name = file_.filename().string();
    task_.is_drive = task_.stop >= task_.start && task_.frames() == static_cast<std::int64_t>(order_.size());
    const std::string every = task_.step > 1 ? fmt::format("one in {} of ", task_.step) : "";
    if (task_.is_drive)
      labels_.warn(
          fmt::format("{}: its task has {}the frames {} to {} of a video: these are mapped to the drive's {} images in order",
                      name, every, task_.start, task_.stop, order_.size()));
    else if (task_.step > 1)
      labels_.warn(fmt::format(
          "{}: its task has only one in {} frames of a video: shapes between them are interpolated, and the last shape "
          "of a track is kept",
          name, task_.step));
  }

  // Returns the number after the last frame of the recording that the task has.
  int last_frame() const {
    const std::int64_t all = static_cast<std::int64_t>(order_.size());
    return static_cast<int>(task_.is_drive ? all : std::clamp<std::int64_t>(std::int64_t{task_.stop} + 1, 0, all));
  }

  void read_images(const pugi::xml_node& annotations) {
    std::vector<std::string> names;
    for (const pugi::xml_node& image : annotations.children("image")) names.push_back(Element(file_, image).text("name"));
    const auto [frames, warning] = find_image_frames(file_, names, drive_);
    if (warning) labels_.warn(*warning);
    std::size_t i = 0;
    for (const pugi::xml_node& image : annotations.children("image"))
      if (const auto& frame = frames[i++]) read_image(image, *frame);
  }

  void read_image(const pugi::xml_node& image, const std::string& frame) {
    labels_.know(frame);
    const bool wanted = labels_.wanted(frame);
    const Element element(file_, image);
    if (wanted) labels_.require_size(element.text("name"), {element.whole("width"), element.whole("height")});
    for (const pugi::xml_node& node : image.children()) {
      if (!wanted) {
        labels_.note(frame);
      } else if (const auto shape = read_shape(file_, node, labels_.size())) {
        Label label;
        label.type = type_of(node);
        add(frame, std::move(label), *shape);
      } else {
        leave_out(node);
      }
    }
  }

  void read_track(const pugi::xml_node& track) {
    Label label;
    label.track = Element(file_, track).whole("id");
    label.type = type_of(track);
    std::vector<Shape> shapes;
    for (const pugi::xml_node& node : track.children()) {
      auto shape = read_shape(file_, node, labels_.size());
      if (!shape) {
        leave_out(node);
        continue;
      }
      const Element element(file_, node);
      const int frame = element.whole("frame");
      if (!task_.has(frame))
        element.fail(fmt::format("frame {} is not in the task, which has one in {} frames from {} on; its image is unknown",
                                 frame, task_.step, task_.start));
      shape->frame = task_.index_of(frame);
      shape->outside = element.is_set("outside");
      if (!shape->outside) count(frame, shape->frame);
      shapes.push_back(std::move(*shape));
    }
    std::stable_sort(shapes.begin(), shapes.end(), [](const Shape& a, const Shape& b) { return a.frame < b.frame; });
    for (std::size_t i = 0; i < shapes.size(); ++i) {
      if (i + 1 < shapes.size() && shapes[i].frame == shapes[i + 1].frame)
        Element(file_, track).fail(fmt::format("track {} has two shapes in frame {}", label.track, shapes[i].frame));
      follow(label, shapes[i], i + 1 < shapes.size() ? &shapes[i + 1] : nullptr);
    }
  }

  void count(int frame, int index) {
    if (index >= 0 && index < static_cast<int>(order_.size())) {
      ++within_;
      return;
    }
    if (strays_++ == 0) first_stray_ = last_stray_ = frame;
    first_stray_ = std::min(first_stray_, frame);
    last_stray_ = std::max(last_stray_, frame);
  }

  // Adds a track from one of its shapes to the next one, or to the end of the task.
  void follow(const Label& label, const Shape& shape, const Shape* next) {
    if (shape.outside) return;
    for (int frame = std::max(shape.frame, 0);
         frame < (next ? std::min(next->frame, static_cast<int>(order_.size())) : end_of(shape)); ++frame)
      if (const std::string& name = order_[static_cast<std::size_t>(frame)]; labels_.wanted(name))
        add(name, label, next ? interpolate(shape, *next, frame) : shape);
  }

  int end_of(const Shape& last) const {
    return std::min(std::max(last_frame(), last.frame + 1), static_cast<int>(order_.size()));
  }

  void add(const std::string& frame, Label label, const Shape& shape) {
    if (shape.kind == Shape::Kind::mask)
      labels_.add_outline(frame, std::move(label), shape.mask);
    else if (shape.kind == Shape::Kind::polygon)
      labels_.add_polygons(frame, std::move(label), {shape.corners});
    else if (shape.turn_deg != 0)
      labels_.add_polygons(frame, std::move(label), {rotate_box(shape.corners[0], shape.corners[1], shape.turn_deg)});
    else
      labels_.add_box(frame, std::move(label), shape.corners[0], shape.corners[1]);
  }

  std::string type_of(const pugi::xml_node& node) const { return to_lower_case(Element(file_, node).text("label")); }

  void leave_out(const pugi::xml_node& node) {
    for (const char* known : {"polyline", "points", "cuboid", "skeleton", "ellipse"})
      if (std::string_view(node.name()) == known) ++left_out_[known];
  }

  void say_left_out() {
    for (const auto& [name, count] : left_out_)
      labels_.warn(fmt::format("{}: {} <{}> ignored: only boxes, polygons and masks are supported", file_.filename().string(),
                               count, name));
    if (strays_ > 0)
      labels_.warn(
          fmt::format("{} has {} shapes in frames that the drive does not have, first {}; frame n of a track is "
                      "the n-th of the drive's {} images, from 0",
                      file_.filename().string(), strays_, first_stray_, order_.size()));
  }

  const fs::path& file_;
  const Drive& drive_;
  ImageLabels labels_;
  std::vector<std::string> order_;  // names of the recording's images
  Task task_;
  std::map<std::string, int> left_out_;
  std::size_t strays_ = 0, within_ = 0;  // shapes in frames that the drive does not have, and in those that it has
  int first_stray_ = 0, last_stray_ = 0;
};

}  // namespace

NamedLabels read_cvat(const fs::path& file, const Drive& drive) {
  const std::string text = read_file(file);
  pugi::xml_document document;
  const pugi::xml_parse_result parsed = document.load_buffer(text.data(), text.size());
  if (!parsed) throw InputError(file, fmt::format("is malformed XML: {} at byte {}", parsed.description(), parsed.offset));
  const pugi::xml_node annotations = document.child("annotations");
  if (!annotations) throw InputError(file, "has no <annotations>");
  return Cvat(file, drive).read(annotations);
}

}  // namespace dvi::labels
