#include "dvi/objects/merge_labels.h"

#include <algorithm>
#include <utility>

namespace dvi::objects {

void set_source(FrameLabels& labels, MaskSource source) {
  for (std::vector<Label>& frame : labels)
    for (Label& label : frame) label.source = source;
}

int next_track(const FrameLabels& labels) {
  int next = 0;
  for (const std::vector<Label>& frame : labels)
    for (const Label& label : frame) next = std::max(next, label.track + 1);
  return next;
}

void append(FrameLabels& labels, FrameLabels more, int first_track) {
  for (std::size_t i = 0; i < labels.size(); ++i)
    for (Label& label : more[i]) {
      if (label.track >= 0) label.track += first_track;
      labels[i].push_back(std::move(label));
    }
}

}  // namespace dvi::objects
