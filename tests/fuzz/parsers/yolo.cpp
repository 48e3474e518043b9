#include "dvi/labels/label_folder.h"
#include "labels.h"

// The first line of the bytes is the names of classes, the others are the labels of an image.
void dvi::fuzz::parse(const fs::path& folder, const std::string& bytes) {
  const std::size_t end = std::min(bytes.find('\n'), bytes.size());
  put(folder / "data.yaml", "names: " + bytes.substr(0, end) + "\n");
  put(folder / "0.txt", bytes.substr(std::min(end + 1, bytes.size())));
  if (const auto found = labels::find_yolo(folder)) require_in_images(labels::read_yolo(*found, small_drive()));
}
