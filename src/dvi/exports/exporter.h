#pragma once

#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "dvi/core/files.h"
#include "dvi/core/options.h"
#include "dvi/core/progress.h"
#include "dvi/exports/result.h"
#include "dvi/media/video.h"

namespace dvi::exports {

/// What a person may choose. Each format takes what concerns it.
struct ExportOptions {
  int max_points = 500'000;
  double cell_m = 0.05;
  std::string origin;
  bool beside = false;
  media::VideoOptions video;

  void describe(OptionTable& table) {
    table.section("export");
    table.flags(true);
    table.add("max_points", max_points, {0, 2e9},
              "colmap, nerfstudio, mcap: the map is evenly thinned to so many points; 0: all are written.");
    table.add("cell_m", cell_m, {0.005, 10}, "ortho: meters a pixel.");
    table.add(
        "origin", origin, {},
        "ortho: LAT,LON,HEADING of the world's origin and x axis (degrees, heading clockwise from north), or local for the "
        "world's own meters; without it, by the drive's GPS, and local where it has none.");
    table.add("beside", beside, "video: the input on the left, the result on the right.");
    video.describe(table);
  }
  void check() const { check_ranges(*this); }
};

/// What an export wrote.
struct ExportReport {
  std::vector<std::string> files;                           ///< relative to the folder, what a person opens first
  std::vector<std::pair<std::string, double>> counts = {};  ///< by name: images, points and so on
};

/// A form that other tools read.
struct ExportFormat {
  std::string name;
  std::string summary;  ///< one line: what is written, for which tools
  /// Writes into a folder that is there and empty. Ticks once a frame.
  std::function<ExportReport(const Result& result, const fs::path& folder, const ExportOptions& options, Progress& progress)>
      write;
};

ExportFormat colmap_format();
ExportFormat nerfstudio_format();
ExportFormat ply_format();
ExportFormat las_format();
ExportFormat ortho_format();
ExportFormat video_format();
ExportFormat mcap_format();

/// All of them; a new one is one file and one line here.
const std::vector<ExportFormat>& export_formats();

/// The format of that name. UsageError with all names if there is none.
const ExportFormat& export_format(const std::string& name);

/// Writes a finished result of `dvi run` into a new or empty folder, all of it or nothing. InputError where the result lacks
/// what the format needs.
ExportReport export_result(const ExportFormat& format, const fs::path& out, const fs::path& folder,
                           const ExportOptions& options, Progress& progress);

/// One JSON document, and some lines for a person.
std::string to_json(const ExportReport& report, const std::string& format, const fs::path& folder);
std::string brief(const ExportReport& report, const fs::path& folder);

}  // namespace dvi::exports
