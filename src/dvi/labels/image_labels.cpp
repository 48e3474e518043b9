#include "dvi/labels/image_labels.h"

#include <algorithm>
#include <cmath>
#include <set>
#include <utility>

#include <fmt/format.h>

#include "dvi/core/error.h"
#include "dvi/core/text.h"
#include "dvi/labels/image_names.h"
#include "dvi/labels/mask_folder.h"

namespace dvi::labels {
namespace {

// A limit on the memory, since few bytes of a file can describe labels of many frames.
constexpr std::size_t kMaxLabels = 10'000'000;

fs::path to_path(std::string image) {
  std::replace(image.begin(), image.end(), '\\', '/');
  return image;
}

bool has_folder(const fs::path& image, const std::string& camera) {
  const fs::path folder = image.parent_path();
  return std::find(folder.begin(), folder.end(), fs::path(camera)) != folder.end();
}

bool shows_something(const Instance& outline) {
  for (std::size_t i = 1; i < outline.runs.size(); i += 2)
    if (outline.runs[i] > 0) return true;
  return false;
}

}  // namespace

std::vector<std::string> list_names_in_order(const Drive& drive) {
  std::set<std::string> all = list_recorded_names(drive);
  for (const Frame& frame : drive.frames) all.insert(frame.name);
  std::vector<std::string> names(all.begin(), all.end());
  const auto is_number = [](const std::string& name) { return is_all_digits(name) && to_integer(name).has_value(); };
  if (std::all_of(names.begin(), names.end(), is_number))
    std::stable_sort(names.begin(), names.end(),
                     [](const std::string& a, const std::string& b) { return *to_integer(a) < *to_integer(b); });
  return names;
}

ImageFrames find_image_frames(const fs::path& file, const std::vector<std::string>& images, const Drive& drive) {
  std::vector<fs::path> paths;
  for (const std::string& image : images) paths.push_back(to_path(image));
  const auto of_camera = [&](const fs::path& path) { return has_folder(path, drive.camera_name); };
  const bool several_cameras = std::any_of(paths.begin(), paths.end(), of_camera);
  std::vector<std::string> names;
  for (const fs::path& path : paths)
    if (!several_cameras || of_camera(path)) names.push_back(path.stem().string());
  const std::vector<std::string> order = list_names_in_order(drive);
  const MatchedNames matched = match_names(file, names, {order.begin(), order.end()});
  const bool any =
      std::any_of(matched.images.begin(), matched.images.end(), [](const auto& image) { return image.has_value(); });
  ImageFrames out{.frames = std::vector<std::optional<std::string>>(paths.size()), .warning = matched.warning};
  std::set<std::string> seen;
  for (std::size_t i = 0, used = 0; i < paths.size(); ++i) {
    if (several_cameras && !of_camera(paths[i])) continue;
    out.frames[i] = matched.images[used].value_or(names[used]);
    ++used;
    if (!seen.insert(*out.frames[i]).second)
      throw InputError(file, "has two images called " + *out.frames[i] + ", the second is " + images[i],
                       "keep the images of one camera only, or put those of each camera into a folder with the camera's name");
  }
  if (!images.empty() && !any)
    throw InputError(
        file,
        fmt::format("has no image of the drive: its first image is {}, that of the drive is {}", images.front(), order.at(0)),
        "labels belong to the image with the same name; folders and endings are ignored");
  return out;
}

ImageLabels::ImageLabels(const fs::path& file, const Drive& drive)
    : file_(file), size_(drive.camera.width, drive.camera.height) {
  for (const Frame& frame : drive.frames) wanted_.insert(frame.name);
}

void ImageLabels::require_size(const std::string& image, cv::Size size) const {
  if (size != size_)
    throw InputError(file_,
                     fmt::format("{} is {}x{} pixels, but the drive's images are {}x{}", image, size.width, size.height,
                                 size_.width, size_.height),
                     "label the images of this camera at their original size");
}

void ImageLabels::add(const std::string& frame, Label label, bool shows) {
  if (!shows && unobserved_++ == 0) first_unobserved_ = frame;
  if (!shows || label.type == "dontcare") return know(frame);
  if (++labels_ > kMaxLabels) throw InputError(file_, fmt::format("has more than {} labels", kMaxLabels));
  out_.frames[frame].push_back(std::move(label));
}

void ImageLabels::add_box(const std::string& frame, Label label, cv::Point2d low, cv::Point2d high) {
  const cv::Point2d first(std::max(low.x, 0.0), std::max(low.y, 0.0));
  const cv::Point2d last(std::min<double>(high.x, size_.width), std::min<double>(high.y, size_.height));
  label.rect = cv::Rect2d(first, last);
  add(frame, std::move(label), first.x < last.x && first.y < last.y);
}

void ImageLabels::add_polygons(const std::string& frame, Label label, const std::vector<Polygon>& polygons) {
  add_outline(frame, std::move(label), to_outline(polygons, size_));
}

void ImageLabels::add_outline(const std::string& frame, Label label, Instance outline) {
  const bool shows = shows_something(outline);
  label.instance = std::move(outline);
  add(frame, std::move(label), shows);
}

NamedLabels ImageLabels::take() {
  if (unobserved_ > 0)
    warn(fmt::format("{} has {} object{} outside the image, the first in frame {}", file_.filename().string(), unobserved_,
                     unobserved_ == 1 ? "" : "s", first_unobserved_));
  return std::move(out_);
}

}  // namespace dvi::labels
