#include "dvi/labels/scan_labels.h"
#include "parser.h"

// The labels of a scan whose file has a point that is not a return before each return.
void dvi::fuzz::parse(const fs::path& folder, const std::string& bytes) {
  const std::size_t points = labels::read_point_labels(put(folder / "0.label", bytes)).size();
  require(points * sizeof(std::uint32_t) == bytes.size(), "each label has four bytes");
  Drive drive;
  drive.scan_headers.push_back({"0", 0, 0, 0, {}});
  drive.scans = {1, 1, [points](std::size_t) {
                   Scan scan;
                   scan.file_points = points;
                   for (std::size_t i = 1; i < points; i += 2) scan.file_index.push_back(static_cast<std::uint32_t>(i));
                   scan.points.resize(scan.file_index.size());
                   return scan;
                 }};
  const std::set<int> classes = labels::select_point_classes("", false);
  labels::attach_point_labels(drive, {folder}, classes);
  for (const std::uint32_t value : drive.point_labels[0]->values)
    require(value == 0 || classes.contains(class_of_point(value)), "only removed classes are kept");
}
