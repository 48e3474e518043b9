#include "dvi/sections/planned_section.h"

namespace dvi::sections {
std::optional<std::size_t> find_recording(const inputs::Recordings& drives, const inputs::Recording& wanted) {
  for (std::size_t i = 0; i < drives.size(); ++i)
    if (drives[i].drive.path == wanted.drive.path && drives[i].drive.camera_name == wanted.drive.camera_name) return i;
  return std::nullopt;
}

}  // namespace dvi::sections
