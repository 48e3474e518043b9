#include <stdexcept>

#include "dvi/core/text.h"
#include "dvi/labels/coco_runs.h"
#include "dvi/labels/labels.h"

namespace dvi::labels {
namespace {

constexpr int kCarClass = 1, kPedestrianClass = 2, kIgnoreClass = 10;
constexpr int kTracksPerClass = 1000;  // an id is class * 1000 + the number of the track

}  // namespace

LabelsByNumber read_mots(const fs::path& file, cv::Size size) {
  LabelsByNumber labels;
  for (const TextLine& line : read_text_lines(file)) {
    if (line.size() != 6)
      line.fail("has " + std::to_string(line.size()) + " entries instead of 6", "lines are: frame id class height width rle");
    const int type = line.integer(2);
    std::vector<Label>& frame_labels = labels[line.integer(0)];
    if (type == kIgnoreClass) continue;
    const cv::Size own(line.integer(4), line.integer(3));
    if (own != size)
      line.fail("is of an image of " + std::to_string(own.width) + "x" + std::to_string(own.height) +
                " pixels, but the drive's images are " + std::to_string(size.width) + "x" + std::to_string(size.height));
    Label label;
    label.track = line.integer(1) % kTracksPerClass;
    label.type = type == kCarClass ? "car" : type == kPedestrianClass ? "pedestrian" : "class " + std::to_string(type);
    try {
      label.instance = Instance{own, decode_runs(line.word(5))};
      require_filled(label.instance->runs, own);
    } catch (const std::invalid_argument& e) {
      line.fail(e.what());
    }
    frame_labels.push_back(std::move(label));
  }
  return labels;
}

}  // namespace dvi::labels
