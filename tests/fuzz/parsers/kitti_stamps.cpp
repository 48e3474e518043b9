#include "kitti.h"

void dvi::fuzz::parse(const fs::path& folder, const std::string& bytes) { parse_kitti(folder, "49 8.4 115 0 0 0", bytes); }
