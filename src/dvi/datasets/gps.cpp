#include "dvi/datasets/gps.h"

#include <cmath>

#include <fmt/format.h>

#include "dvi/core/text.h"

namespace dvi::datasets {

std::vector<GeoFix> read_fixes(const fs::path& file) {
  std::vector<GeoFix> fixes;
  for (const TextLine& line : read_text_lines(file)) {
    if (line.size() != 3 && line.size() != 6)
      line.fail("has " + std::to_string(line.size()) + " entries",
                "lines are: seconds latitude longitude, and optionally x y z of the antenna");
    GeoFix fix{line.nanoseconds(0), line.number(1), line.number(2)};
    if (std::abs(fix.latitude_deg) > 90 || std::abs(fix.longitude_deg) > 360)
      line.fail("is not a position on Earth", "write latitude before longitude, in degrees");
    if (line.size() == 6) fix.antenna = {line.number(3), line.number(4), line.number(5)};
    fixes.push_back(fix);
  }
  return fixes;
}

std::string format_fixes(const std::vector<GeoFix>& fixes) {
  std::string text = "# seconds latitude longitude, and the antenna in the LiDAR's axes\n";
  for (const GeoFix& fix : fixes)
    text += fmt::format("{} {:.10f} {:.10f} {} {} {}\n", to_seconds(fix.time_ns), fix.latitude_deg, fix.longitude_deg,
                        fix.antenna.x(), fix.antenna.y(), fix.antenna.z());
  return text;
}

}  // namespace dvi::datasets
