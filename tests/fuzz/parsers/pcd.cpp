#include "scan.h"

void dvi::fuzz::parse(const fs::path& folder, const std::string& bytes) { parse_scan(put(folder / "0.pcd", bytes)); }
