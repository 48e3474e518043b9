#include "dvi/pipeline/make_map.h"

#include <nlohmann/json.hpp>

#include "dvi/pipeline/map_files.h"
#include "dvi/pipeline/open.h"
#include "dvi/pipeline/report.h"

namespace dvi {

std::string make_map(const Job& job, Progress& progress) {
  const std::vector<OpenDrive> drives = open_drives(job, MaskNeed::optional, progress);
  verify(drives, progress);
  progress.begin("map", scan_count(map_inputs(drives)));
  const StaticMap map = build_map(map_inputs(drives), job.options.map, progress.tick());
  const Views views = make_views(drives, progress);
  progress.begin("write", 0);
  const nlohmann::json report = map_report(map);
  write_map_files(job.out, map, views, drives.front().drive, report);
  return report.dump(1);
}

}  // namespace dvi
