#include "dvi/labels/labels.h"
#include "parser.h"

void dvi::fuzz::parse(const fs::path& folder, const std::string& bytes) {
  for (const auto& [name, labels] : labels::read_boxes_json(put(folder / "boxes.json", bytes)).frames)
    for (const Label& label : labels) require(!label.box || (label.box->size.array() > 0).all(), "a box has a size");
}
