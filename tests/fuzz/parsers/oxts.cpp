#include "kitti.h"

void dvi::fuzz::parse(const fs::path& folder, const std::string& bytes) {
  parse_kitti(folder, bytes, "\n2011-09-26 13:00:10.1\n2011-09-26 13:00:10.2\n");
}
