#include "labels.h"

void dvi::fuzz::parse(const fs::path& folder, const std::string& bytes) {
  require_in_images(labels::read_cvat(put(folder / "annotations.xml", bytes), small_drive()));
}
