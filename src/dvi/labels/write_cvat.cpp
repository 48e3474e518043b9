#include <map>
#include <set>
#include <sstream>
#include <utility>

#include <fmt/format.h>
#include <pugixml.hpp>

#include "dvi/labels/write_labels.h"

namespace dvi::labels {
namespace {

/// The polygons of one part of an object by the index of the image.
struct PartTrack {
  std::string type;
  std::map<int, const Polygon*> shapes;
};

// Collects the tracks by object and rank of the part.
std::map<std::pair<int, std::size_t>, PartTrack> collect_tracks(const DrawnLabels& labels) {
  std::map<std::pair<int, std::size_t>, PartTrack> tracks;
  for (const DrawnImage& image : labels.images)
    for (const DrawnObject& object : image.objects)
      for (std::size_t i = 0; i < object.parts.size(); ++i) {
        PartTrack& track = tracks[{object.track, i}];
        track.type = object.type;
        track.shapes[image.index] = &object.parts[i];
      }
  return tracks;
}

void add_value(pugi::xml_node& node, const char* name, const std::string& value) {
  node.append_child(name).text().set(value.c_str());
}

void add_polygon(pugi::xml_node& track, int frame, const Polygon& corners, bool is_outside) {
  std::string points;
  for (const cv::Point2d& corner : corners)
    points += fmt::format("{}{:.2f},{:.2f}", points.empty() ? "" : ";", corner.x, corner.y);
  pugi::xml_node polygon = track.append_child("polygon");
  polygon.append_attribute("frame").set_value(frame);
  polygon.append_attribute("keyframe").set_value(1);
  polygon.append_attribute("outside").set_value(is_outside ? 1 : 0);
  polygon.append_attribute("occluded").set_value(0);
  polygon.append_attribute("points").set_value(points.c_str());
  polygon.append_attribute("z_order").set_value(0);
}

void add_meta(pugi::xml_node& annotations, const DrawnLabels& labels, const std::set<std::string>& types) {
  pugi::xml_node task = annotations.append_child("meta").append_child("task");
  add_value(task, "name", "masks of dvi");
  add_value(task, "size", std::to_string(labels.recorded_images));
  add_value(task, "mode", "interpolation");
  add_value(task, "start_frame", "0");
  add_value(task, "stop_frame", std::to_string(labels.recorded_images - 1));
  pugi::xml_node names = task.append_child("labels");
  for (const std::string& type : types) {
    pugi::xml_node label = names.append_child("label");
    add_value(label, "name", type);
  }
  pugi::xml_node size = task.append_child("original_size");
  add_value(size, "width", std::to_string(labels.size.width));
  add_value(size, "height", std::to_string(labels.size.height));
}

void add_track(pugi::xml_node& annotations, int id, const PartTrack& part, int recorded_images) {
  pugi::xml_node track = annotations.append_child("track");
  track.append_attribute("id").set_value(id);
  track.append_attribute("label").set_value(part.type.c_str());
  track.append_attribute("source").set_value("auto");
  for (const auto& [frame, corners] : part.shapes) {
    add_polygon(track, frame, *corners, false);
    // Without this, the shape would remain until the next one.
    if (!part.shapes.contains(frame + 1) && frame + 1 < recorded_images) add_polygon(track, frame + 1, *corners, true);
  }
}

}  // namespace

void write_cvat(const fs::path& file, const DrawnLabels& labels) {
  const auto tracks = collect_tracks(labels);
  std::set<std::string> types;
  for (const auto& [key, track] : tracks) types.insert(track.type);
  pugi::xml_document document;
  pugi::xml_node annotations = document.append_child("annotations");
  add_value(annotations, "version", "1.1");
  add_meta(annotations, labels, types);
  for (int id = 0; const auto& [key, track] : tracks) add_track(annotations, id++, track, labels.recorded_images);
  std::ostringstream text;
  document.save(text, " ");
  write_file(file, text.str());
}

}  // namespace dvi::labels
