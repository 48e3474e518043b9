#include "bag.h"

void dvi::fuzz::parse(const fs::path& folder, const std::string& bytes) {
  const fs::path file = put(folder / "0.mcap", bytes);
  read_all(file);
  copy_all(file);
}
