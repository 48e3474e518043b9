#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
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

/// The files of frames and masks of the format holes: frames/NAME.png and masks/NAME.png, or pairs/NAME.png and
/// pairs/NAME_mask.png.
enum class HoleLayout : std::uint8_t { folders, pairs };
constexpr auto names_of(HoleLayout) {
  return std::array{std::pair{HoleLayout::folders, "folders"}, std::pair{HoleLayout::pairs, "pairs"}};
}

/// The options of all formats; each format uses those that concern it.
struct ExportOptions {
  int max_points = 500'000;
  double cell_m = 0.05;
  std::string origin;
  bool beside = false;
  int grow_px = 2;
  HoleLayout layout = HoleLayout::folders;
  int quality = 95;
  std::string input;
  bool points = false;
  media::VideoOptions video;

  void describe(OptionTable& table) {
    table.section("export");
    table.flags(true);
    table.add("max_points", max_points, {0, 2e9},
              "colmap, nerfstudio, mcap: maximum number of points, to which the map is thinned evenly; 0: all.");
    table.add("cell_m", cell_m, {0.005, 10}, "ortho: meters per pixel.");
    table.add(
        "origin", origin, {},
        "ortho: LAT,LON,HEADING of the world's origin and x axis (degrees, heading clockwise from north), or local for the "
        "world's own meters; by default from the drive's GPS, or local if it has none.");
    table.add("beside", beside, "video: the input on the left, the result on the right.");
    table.add("grow_px", grow_px, {0, 200}, "holes: pixels by which the masks extend beyond the unobserved pixels.");
    table.add("layout", layout,
              "holes: folders (frames/NAME.png and masks/NAME.png: ProPainter, IOPaint, ComfyUI) or pairs (pairs/NAME.png and "
              "NAME_mask.png of frames with holes: LaMa).");
    table.add("quality", quality, {1, 100}, "bag, folder: quality of the JPEG images that contain filled pixels.");
    table.add("input", input, {},
              "bag, folder: the recording, if it is not where the run read it, or if it is an export of another camera of it.");
    table.add("points", points, "bag, folder: remove the returns of removed objects from the scans, too.");
    video.describe(table);
  }
  void check() const { check_ranges(*this); }
};

/// The files and counts of an export.
struct ExportReport {
  std::vector<std::string> files;                           ///< relative to the folder; those that a user opens first
  std::vector<std::pair<std::string, double>> counts = {};  ///< counts by name, such as images and points
  fs::path folder = {};                                     ///< of `files`; set by export_result()
  std::vector<std::string> warnings = {};                   ///< set by export_result()
};

/// An export format for other tools.
struct ExportFormat {
  std::string name;
  std::string summary;  ///< one line: the files, and the tools that read them
  /// Writes into an existing, empty folder, or the file if the export is one. Ticks once per frame.
  std::function<ExportReport(const Result& result, const fs::path& folder, const ExportOptions& options, Progress& progress)>
      write;
  /// Checks the place of the export before anything is written, and returns whether it is a file. None: it is a folder.
  std::function<bool(const Result& result, const ExportOptions& options, const fs::path& place)> is_file = {};
  std::vector<std::string> options = {};  ///< names (section.key) of the options that it uses

  bool uses(const std::string& option) const { return std::find(options.begin(), options.end(), option) != options.end(); }
};

ExportFormat colmap_format();
ExportFormat nerfstudio_format();
ExportFormat ply_format();
ExportFormat las_format();
ExportFormat ortho_format();
ExportFormat video_format();
ExportFormat mcap_format();
ExportFormat holes_format();
ExportFormat labels_format();
ExportFormat bag_format();
ExportFormat folder_format();

/// Returns all formats. A new format is one file, its declaration above, and one line here.
const std::vector<ExportFormat>& export_formats();

/// Returns the format of a name. Throws UsageError with all names if there is none.
const ExportFormat& find_export_format(const std::string& name);

/// Throws UsageError if a format does not use one of the given options of ExportOptions.
void require_used(const std::vector<Assignment>& given, const OptionTable& table, const ExportFormat& format);

/// A finished result of `dvi run` to export, and the new or empty folder, or the new file, to which it is exported.
struct ExportTask {
  fs::path out, place;
  ResultSources from = {};
};

/// Exports a result, completely or not at all. Throws InputError if the result lacks data that the format needs.
ExportReport export_result(const ExportTask& task, const ExportFormat& format, const ExportOptions& options,
                           Progress& progress);

/// Format a report as a JSON document, and as lines for the user.
std::string to_json(const ExportReport& report, const std::string& format);
std::string brief(const ExportReport& report);

}  // namespace dvi::exports
