#include "dvi/media/point_cloud.h"
#include "parser.h"

void dvi::fuzz::parse(const fs::path& folder, const std::string& bytes) {
  dvi::media::read_map_cloud(put(folder / "map.las", bytes));
}
