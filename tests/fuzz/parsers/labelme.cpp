#include "labels.h"

void dvi::fuzz::parse(const fs::path& folder, const std::string& bytes) {
  const fs::path file = put(folder / "0.json", bytes);
  require_in_images(labels::read_labelme(file, {file}, small_drive()));
}
