#include "dvi/commands/import_fill.h"

#include <algorithm>
#include <optional>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <opencv2/core.hpp>

#include "dvi/commands/external_images.h"
#include "dvi/core/error.h"
#include "dvi/core/frame_name.h"
#include "dvi/core/hash.h"
#include "dvi/core/json_text.h"
#include "dvi/core/threads.h"
#include "dvi/harmonize/adapt_fill.h"
#include "dvi/harmonize/filled_frame.h"
#include "dvi/media/image_file.h"
#include "dvi/result/fill_import.h"

namespace dvi::commands {
namespace {

using Images = std::vector<std::optional<fs::path>>;

cv::Mat1b find_unobserved(const cv::Mat1b& kind) { return cv::Mat1b(kind >= static_cast<int>(harmonize::Kind::interpolated)); }

bool are_equal_in(const cv::Mat1b& hole, const cv::Mat3b& a, const cv::Mat3b& b) {
  for (int y = 0; y < hole.rows; ++y)
    for (int x = 0; x < hole.cols; ++x)
      if (hole(y, x) != 0 && a(y, x) != b(y, x)) return false;
  return true;
}

std::vector<char> find_frames_with_holes(const result::FillImport& target) {
  std::vector<char> needed(target.names().size());
  parallel_for(needed.size(), [&](std::size_t i) {
    needed[i] = cv::countNonZero(find_unobserved(target.read_run_images(i).kind)) > 0 ? 1 : 0;
  });
  return needed;
}

/// Returns the image of each frame: from the folder itself, or its folder CAMERA if the result has several.
Images find_images(const fs::path& folder, const result::FillImport& target, const std::vector<char>& needed) {
  Images out(needed.size());
  for (const std::string& camera : list_cameras(target.names())) {
    std::vector<std::size_t> frames;
    std::vector<std::string> names;
    std::vector<char> needed_here;
    for (std::size_t i = 0; i < needed.size(); ++i)
      if (camera_of_frame(target.names()[i]) == camera) {
        frames.push_back(i);
        names.push_back(image_of_frame(target.names()[i]));
        needed_here.push_back(needed[i]);
      }
    if (!camera.empty() && std::count(needed_here.begin(), needed_here.end(), 1) == 0) continue;
    const Images found = assign_images(camera.empty() ? folder : folder / camera, names, needed_here);
    for (std::size_t k = 0; k < frames.size(); ++k) out[frames[k]] = found[k];
  }
  return out;
}

/// Checks all images, which are not used yet.
void require_usable_images(const fs::path& folder, const result::FillImport& target, const Images& images, Progress& progress) {
  std::vector<ObservedDifference> differences(images.size());
  std::vector<char> changed(images.size());
  progress.begin("check", images.size());
  parallel_for(images.size(), [&](std::size_t i) {
    progress.advance();
    if (!images[i]) return;
    require_color_image(*images[i], target.size(i));
    const cv::Mat3b image = media::read_image(*images[i], target.size(i));
    const result::FillImages run = target.read_run_images(i);
    const cv::Mat1b hole = find_unobserved(run.kind);
    differences[i] = compare_observed(image, run.color, hole);
    require_same_scene(*images[i], differences[i]);
    changed[i] = are_equal_in(hole, image, run.color) ? 0 : 1;
  });
  require_color_order(folder, differences);
  if (std::count(changed.begin(), changed.end(), 1) == 0)
    throw InputError(folder, "has the frames of the result itself: no unobserved pixel differs",
                     "give the folder of the images that the other program wrote");
}

ImportReport import_frame(result::FillImport& target, std::size_t i, const fs::path& file) {
  const std::string bytes = read_file(file);
  const cv::Mat3b image = media::decode_image(file, bytes, target.size(i));
  result::FillImages images = target.read_run_images(i);
  const cv::Mat1b hole = find_unobserved(images.kind);
  ImportReport report{1, static_cast<std::size_t>(cv::countNonZero(hole)), 0};
  if (report.pixels == 0) return {};
  images.color = harmonize::adapt_fill(images.color, image, hole);
  images.kind.setTo(static_cast<int>(harmonize::Kind::imported), hole);
  report.change = cv::norm(images.color, image, cv::NORM_L1, hole) / 3;  // a sum until all frames are written
  target.write(i, images, {fs::absolute(file).lexically_normal().string(), compute_hash(bytes)});
  return report;
}

}  // namespace

ImportReport import_fill(const fs::path& out, const fs::path& frames, Progress& progress) {
  result::FillImport target(out);
  const std::vector<char> needed = find_frames_with_holes(target);
  if (std::count(needed.begin(), needed.end(), 1) == 0)
    throw InputError(out, "has no unobserved pixels", "there is nothing to fill");
  const Images images = find_images(frames, target, needed);
  require_usable_images(frames, target, images, progress);
  target.begin();
  std::vector<ImportReport> parts(images.size());
  progress.begin("import", images.size());
  parallel_for(images.size(), [&](std::size_t i) {
    if (images[i]) parts[i] = import_frame(target, i, *images[i]);
    progress.advance();
  });
  target.finish(progress);
  ImportReport report;
  for (const ImportReport& part : parts) {
    report.frames += part.frames;
    report.pixels += part.pixels;
    report.change += part.change;
  }
  report.change /= static_cast<double>(report.pixels);
  return report;
}

ImportReport undo_import(const fs::path& out, Progress& progress) {
  result::FillImport target(out);
  const std::size_t count = target.names().size();
  std::vector<char> imported(count);
  for (std::size_t i = 0; i < count; ++i) imported[i] = target.is_imported(i) ? 1 : 0;
  target.begin();
  progress.begin("restore", count);
  parallel_for(count, [&](std::size_t i) {
    target.remove(i);
    progress.advance();
  });
  target.finish(progress);
  return {static_cast<std::size_t>(std::count(imported.begin(), imported.end(), 1)), 0, 0};
}

std::string to_json(const ImportReport& report, const fs::path& out) {
  return json_text({{"schema", "dvi-import/1"},
                    {"path", fs::absolute(out).lexically_normal().string()},
                    {"frames", report.frames},
                    {"pixels", report.pixels},
                    {"harmonization", report.change}});
}

std::string brief(const ImportReport& report, const fs::path& out) {
  if (report.pixels == 0) return fmt::format("{} frames are as the run wrote them", report.frames);
  return fmt::format(
      "{} unobserved pixels of {} frames filled; harmonization changed the fill by {:.1f} gray levels on average\n"
      "  {}/report.html  open it in a browser\n"
      "  dvi import-fill {} --undo  restores the frames of the run",
      report.pixels, report.frames, report.change, out.string(), out.string());
}

}  // namespace dvi::commands
