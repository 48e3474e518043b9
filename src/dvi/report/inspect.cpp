#include "dvi/report/inspect.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <opencv2/imgproc.hpp>

#include "dvi/core/error.h"
#include "dvi/core/frame_name.h"
#include "dvi/core/json_file.h"
#include "dvi/core/json_text.h"
#include "dvi/harmonize/filled_frame.h"
#include "dvi/harmonize/provenance.h"
#include "dvi/media/image_file.h"
#include "dvi/media/write_image.h"

namespace dvi::report {
namespace {

using nlohmann::json;

constexpr std::array<const char*, 7> kKinds{"original",   "copied",  "copied from elsewhere", "interpolated", "synthesized",
                                            "left empty", "imported"};
constexpr int kCropPx = 120, kZoom = 3;

json read_document(const fs::path& file) {
  if (!fs::exists(file))
    throw InputError(file.parent_path(), "has no " + file.filename().string(), "give the result of a finished dvi run");
  json read = read_json(file, DamagedJson::is_discarded);
  if (!read.is_object()) throw InputError(file, "is not a JSON document", "run dvi again");
  return read;
}

/// Returns the name of a frame that is given by its name or by its number in the drive.
std::string find_name(const fs::path& out, const std::string& frame) {
  if (fs::exists(out / picture_file("frames", frame))) return frame;
  const json run = read_document(out / "report.json");
  std::string first, last;
  for (const json& entry : run.value("frames", json::array())) {
    last = join_frame_name(entry.value("camera", ""), entry.value("name", ""));
    if (first.empty()) first = last;
    if (std::to_string(entry.value("number", -1)) == frame) return last;
  }
  throw InputError(out, fmt::format("has no frame {}", frame),
                   first.empty() ? "" : fmt::format("its frames are {} to {}", first, last));
}

/// Returns the number of frames from a frame of the result to a source of its own camera; none for other sources.
std::optional<int> compute_frames_apart(const json& sources, std::size_t number, const std::string& frame) {
  const json& source = sources.at(number);
  const std::string camera =
      camera_of_frame(frame).empty() ? sources[0].at("camera").get<std::string>() : camera_of_frame(frame);
  if (source.at("drive") != sources[0].at("drive") || source.at("camera") != camera) return std::nullopt;
  for (std::size_t i = 0; i < sources.size(); ++i)
    if (sources[i].at("frame") == image_of_frame(frame) && sources[i].at("drive") == source.at("drive") &&
        sources[i].at("camera") == camera)
      return static_cast<int>(number) - static_cast<int>(i);
  return std::nullopt;
}

/// Returns the external file of a frame by report.json.
std::optional<ExternalSource> find_external(const fs::path& out, const std::string& name) {
  for (const json& entry : read_document(out / "report.json").value("frames", json::array()))
    if (join_frame_name(entry.value("camera", ""), entry.value("name", "")) == name && entry.contains("external"))
      return ExternalSource{entry.at("external").at("file"), entry.at("external").at("xxh3")};
  return std::nullopt;
}

/// Enlarges the part of an image around a position and marks the position.
cv::Mat3b crop(const cv::Mat3b& image, cv::Point2f at) {
  const int width = std::min(kCropPx, image.cols), height = std::min(kCropPx, image.rows);
  const cv::Point corner(std::clamp(cvRound(at.x) - width / 2, 0, image.cols - width),
                         std::clamp(cvRound(at.y) - height / 2, 0, image.rows - height));
  cv::Mat3b out;
  cv::resize(image(cv::Rect(corner, cv::Size(width, height))), out, {}, kZoom, kZoom, cv::INTER_NEAREST);
  const cv::Point middle(cvRound((at.x - static_cast<float>(corner.x) + 0.5F) * kZoom),
                         cvRound((at.y - static_cast<float>(corner.y) + 0.5F) * kZoom));
  constexpr int kGapPx = 6, kArmPx = 22;
  for (const auto& [color, thickness] : {std::pair(cv::Scalar(0, 0, 0), 3), std::pair(cv::Scalar(255, 255, 255), 1)})
    for (const cv::Point arm : {cv::Point(1, 0), cv::Point(-1, 0), cv::Point(0, 1), cv::Point(0, -1)})
      cv::line(out, middle + kGapPx * arm, middle + kArmPx * arm, color, thickness);
  return out;
}

PixelRecord read_record(const fs::path& out, const std::string& frame, cv::Point pixel) {
  PixelRecord record;
  record.frame = find_name(out, frame);
  record.pixel = pixel;
  const cv::Size size = media::image_size(out / picture_file("kind", record.frame));
  if (!cv::Rect({}, size).contains(pixel))
    throw InputError(out, fmt::format("has no pixel {}, {} in frame {}", pixel.x, pixel.y, record.frame),
                     fmt::format("X is 0 to {}, Y 0 to {}", size.width - 1, size.height - 1));
  const auto kind = static_cast<std::size_t>(media::read_png_gray(out / picture_file("kind", record.frame), size)(pixel));
  if (kind >= kKinds.size())
    throw InputError(out / picture_file("kind", record.frame), fmt::format("has the unknown kind {}", kind), "run dvi again");
  record.kind = kKinds[kind];
  const cv::Vec3b color = media::read_image(out / picture_file("frames", record.frame), size)(pixel);
  record.color = {color[2], color[1], color[0]};
  if (const ushort depth = media::read_png_depth(out / picture_file("depth", record.frame), size)(pixel); depth > 0)
    record.depth_m = depth / 256.0;
  if (kind > 0) record.confidence = media::read_png_gray(out / picture_file("confidence", record.frame), size)(pixel) / 255.0;
  const cv::Vec3w triple = media::read_png_triples(out / picture_file("provenance", record.frame), size)(pixel);
  if (kind == static_cast<std::size_t>(harmonize::Kind::imported)) record.external = find_external(out, record.frame);
  if (triple[0] == 0) return record;

  const cv::Vec3b used = media::read_image(out / picture_file("sources_used", record.frame), size)(pixel);
  const cv::Vec3w change = media::read_png_triples(out / picture_file("harmonization", record.frame), size)(pixel);
  const harmonize::Provenance from = harmonize::Provenance::decode(triple, used);
  const json sources = read_document(out / "sources.json").value("sources", json::array());
  if (static_cast<std::size_t>(from.view) >= sources.size())
    throw InputError(out / "sources.json", fmt::format("has no source {}, from which the pixel was copied", from.view),
                     "run dvi again");
  const json& source = sources[static_cast<std::size_t>(from.view)];
  PixelSource& to = record.source.emplace();
  to.number = static_cast<std::size_t>(from.view);
  to.drive = source.value("drive", "");
  to.camera = source.value("camera", "");
  to.frame = source.value("frame", "");
  to.file = source.value("file", "");
  to.position = from.position;
  to.footprint = {from.footprint[0], from.footprint[1]};
  to.averaged = used[2];
  for (int c = 0; c < 3; ++c) to.change[c] = change[c] - harmonize::kNoChange;
  to.frames_apart = compute_frames_apart(sources, to.number, record.frame);
  return record;
}

}  // namespace

PixelRecord read_pixel_record(const fs::path& out, const std::string& frame, cv::Point pixel) {
  try {
    return read_record(out, frame, pixel);
  } catch (const nlohmann::json::exception& e) {
    throw InputError(out, fmt::format("report.json or sources.json was not written by dvi run ({})", e.what()),
                     "run dvi again");
  }
}

std::string to_text(const PixelRecord& record) {
  const auto& [red, green, blue] = record.color;
  std::string text = fmt::format("frame {}, pixel {}, {}: {}\n  color      {} {} {} (red, green, blue)\n", record.frame,
                                 record.pixel.x, record.pixel.y, record.kind, red, green, blue);
  text += record.depth_m ? fmt::format("  depth       {:.2f} m\n", *record.depth_m) : "  depth       unknown\n";
  if (record.confidence)
    text +=
        fmt::format("  confidence  {:.0f} %: probability of an error of at most 10 gray levels\n", 100 * *record.confidence);
  if (record.external)
    text += fmt::format("  from        another program (external): {}\n              XXH3 {}\n", record.external->file,
                        record.external->hash);
  if (record.source) {
    const PixelSource& s = *record.source;
    text +=
        fmt::format("  from        frame {} of camera {}, at {:.2f}, {:.2f}", s.frame, s.camera, s.position.x, s.position.y);
    if (s.frames_apart)
      text += fmt::format(", {} frames {}", std::abs(*s.frames_apart), *s.frames_apart < 0 ? "earlier" : "later");
    text += fmt::format("\n              {}\n  averaged    {} source(s), over {} x {} px each\n", s.file.string(), s.averaged,
                        s.footprint[0], s.footprint[1]);
    text += fmt::format("  blending    {:+d} {:+d} {:+d} gray levels\n", s.change[0], s.change[1], s.change[2]);
  }
  text.pop_back();
  return text;
}

std::string to_json(const PixelRecord& record) {
  json out{{"schema", "dvi-receipt/1"}, {"frame", record.frame}, {"x", record.pixel.x}, {"y", record.pixel.y},
           {"kind", record.kind},       {"color", record.color}, {"depth_m", nullptr},  {"confidence", nullptr},
           {"source", nullptr},         {"external", nullptr}};
  if (record.depth_m) out["depth_m"] = *record.depth_m;
  if (record.confidence) out["confidence"] = *record.confidence;
  if (record.external) out["external"] = {{"file", record.external->file}, {"xxh3", record.external->hash}};
  if (record.source) {
    const PixelSource& s = *record.source;
    out["source"] = {{"number", s.number},      {"drive", s.drive},
                     {"camera", s.camera},      {"frame", s.frame},
                     {"file", s.file.string()}, {"x", s.position.x},
                     {"y", s.position.y},       {"footprint", {s.footprint[0], s.footprint[1]}},
                     {"averaged", s.averaged},  {"change", s.change},
                     {"frames_apart", nullptr}};
    if (s.frames_apart) out["source"]["frames_apart"] = *s.frames_apart;
  }
  return json_text(out);
}

void write_crops(const fs::path& folder, const fs::path& out, const PixelRecord& record) {
  make_folder(folder);
  const fs::path frame = out / picture_file("frames", record.frame);
  media::write_png(folder / "result.png", crop(media::read_image(frame, media::image_size(frame)), record.pixel));
  if (!record.source || !fs::exists(record.source->file)) return;
  const fs::path& file = record.source->file;
  media::write_png(folder / "source.png", crop(media::read_image(file, media::image_size(file)), record.source->position));
}

}  // namespace dvi::report
