#include "bag.h"

void dvi::fuzz::parse(const fs::path& folder, const std::string& bytes) { read_all(put(folder / "0.bag", bytes)); }
