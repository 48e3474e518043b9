#include <set>

#include <nlohmann/json.hpp>
#include <opencv2/imgproc.hpp>

#include "dvi/core/json_text.h"
#include "dvi/labels/write_labels.h"

namespace dvi::labels {
namespace {

using nlohmann::json;

json to_segmentation(const std::vector<Polygon>& parts) {
  json out = json::array();
  for (const Polygon& part : parts) {
    json polygon = json::array();
    for (const cv::Point2d& corner : part) polygon.push_back(corner.x), polygon.push_back(corner.y);
    out.push_back(std::move(polygon));
  }
  return out;
}

json to_bbox(const std::vector<Polygon>& parts) {
  cv::Point2d low = parts.front().front(), high = low;
  for (const Polygon& part : parts)
    for (const cv::Point2d& p : part) {
      low = {std::min(low.x, p.x), std::min(low.y, p.y)};
      high = {std::max(high.x, p.x), std::max(high.y, p.y)};
    }
  return json::array({low.x, low.y, high.x - low.x, high.y - low.y});
}

}  // namespace

void write_coco(const fs::path& file, const DrawnLabels& labels) {
  std::set<std::string> types;
  for (const DrawnImage& image : labels.images)
    for (const DrawnObject& object : image.objects) types.insert(object.type);
  json images = json::array(), annotations = json::array(), categories = json::array();
  for (const std::string& type : types)
    categories.push_back({{"id", categories.size() + 1}, {"name", type}, {"supercategory", ""}});
  for (const DrawnImage& image : labels.images) {
    const std::size_t image_id = images.size() + 1;
    images.push_back(
        {{"id", image_id}, {"file_name", image.file_name}, {"width", labels.size.width}, {"height", labels.size.height}});
    for (const DrawnObject& object : image.objects)
      annotations.push_back({{"id", annotations.size() + 1},
                             {"image_id", image_id},
                             {"category_id", std::distance(types.begin(), types.find(object.type)) + 1},
                             {"segmentation", to_segmentation(object.parts)},
                             {"area", object.pixels},
                             {"bbox", to_bbox(object.parts)},
                             {"iscrowd", 0},
                             {"attributes", {{"track_id", object.track}}}});
  }
  const json document = {{"info", {{"description", "masks of dvi"}}},
                         {"licenses", json::array()},
                         {"images", images},
                         {"annotations", annotations},
                         {"categories", categories}};
  write_file(file, json_text(document, -1) + "\n");
}

}  // namespace dvi::labels
