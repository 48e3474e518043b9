#include "dvi/report/report.h"

#include <algorithm>
#include <array>
#include <cstdlib>
#include <optional>

#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <opencv2/core.hpp>

#include "dvi/core/error.h"
#include "dvi/core/frame_name.h"
#include "dvi/core/json_file.h"
#include "dvi/core/json_text.h"
#include "dvi/core/threads.h"
#include "dvi/media/image_file.h"
#include "dvi/media/image_memory.h"
#include "dvi/media/write_image.h"
#include "dvi/report/frame_block.h"
#include "dvi/report/frame_pictures.h"
#include "dvi/report/page_files.h"
#include "dvi/report/uncertainty.h"
#include "dvi/report/unobserved_cells.h"

namespace dvi::report {
namespace {

using nlohmann::json;

constexpr const char* kIndexSchema = "dvi-page/1";
constexpr std::array<const char*, 4> kFolders{"report", "report/before", "report/truth", "report/sources"};
constexpr int kJpegQuality = 85;
constexpr std::size_t kReportBytesPerPixel = 40;  // memory of a frame while its entry is written

std::string make_path(const char* folder, std::size_t number, const char* ending) {
  return fmt::format("report/{}{:06d}{}", folder, number, ending);
}

/// Converts the path of a file of the result to a URL relative to the page.
std::string to_url(const std::string& path) {
  std::string out;
  for (const char c : path) {
    const bool is_plain = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '-' || c == '_' ||
                          c == '.' || c == '/';
    out += is_plain ? std::string(1, c) : fmt::format("%{:02X}", static_cast<unsigned char>(c));
  }
  return out;
}

/// Reads a JSON document of the result; returns null and adds the reason to `problems` if it is missing or damaged.
json read_document(const fs::path& out, const char* file, std::vector<std::string>& problems) {
  if (!fs::exists(out / file)) {
    problems.push_back(fmt::format("{} is missing", file));
    return {};
  }
  json read = read_json(out / file, DamagedJson::is_discarded);
  if (read.is_object()) return read;
  problems.push_back(fmt::format("{} is damaged", file));
  return {};
}

/// Returns the pixels of the hole; all others are transparent.
cv::Mat4b cut_hole(const cv::Mat3b& image, const cv::Mat1b& kind) {
  cv::Mat4b out(image.size(), cv::Vec4b(0, 0, 0, 0));
  for (int y = 0; y < image.rows; ++y)
    for (int x = 0; x < image.cols; ++x)
      if (const cv::Vec3b& pixel = image(y, x); kind(y, x) != 0) out(y, x) = {pixel[0], pixel[1], pixel[2], 255};
  return out;
}

cv::Mat1b compute_largest_difference(const cv::Mat3b& a, const cv::Mat3b& b) {
  cv::Mat3b difference;
  cv::absdiff(a, b, difference);
  cv::Mat1b out(a.size());
  std::transform(difference.begin(), difference.end(), out.begin(),
                 [](const cv::Vec3b& d) { return std::max({d[0], d[1], d[2]}); });
  return out;
}

/// Writes nothing if there is no image.
void write_patch(const fs::path& file, const cv::Mat3b& image, const cv::Mat1b& kind) {
  if (!image.empty()) media::write_png(file, cut_hole(image, kind));
}

void write_block(const fs::path& out, std::size_t number, const FramePictures& pictures, const cv::Mat1b& error) {
  write_file(out / make_path("data_", number, ".js"), format_frame_block(number, pictures, error));
}

/// The entry of one frame in index.js, and its unobserved cells.
struct FrameEntry {
  json entry;
  UnobservedCells unobserved;
};

class ReportWriter {
 public:
  explicit ReportWriter(const ReportInput& input)
      : in_(input), out_(input.out), truth_(input.truth, input.names), problems_(input.problems), names_(input.names) {
    const json listed = read_document(out_, "sources.json", problems_);
    const auto is_source = [](const json& source) { return source.is_object(); };
    if (listed.is_object() && listed.contains("sources") &&
        std::all_of(listed["sources"].begin(), listed["sources"].end(), is_source))
      list_ = listed.at("sources");
    own_ = count_own_sources();
    read_objects();
    if (fs::exists(out_ / "map/above.json")) above_ = read_document(out_, "map/above.json", problems_);
  }

  void write(const Tick& tick) {
    for (const char* folder : kFolders) make_folder(out_ / folder);
    std::vector<json> entries(names_.size());
    UnobservedCells unobserved;
    make_and_use(
        names_.size(), [&](std::size_t i) { return write_frame(i); },
        [&](std::size_t i, FrameEntry frame) {
          entries[i] = std::move(frame.entry);
          add(frame.unobserved, unobserved);
          tick();
        },
        media::estimate_image_bytes(out_, "kind", names_, kReportBytesPerPixel));
    write_sources();
    for (const PageFile& file : get_page_files())
      if (file.name != "report.html") write(std::string("report/") + std::string(file.name), std::string(file.bytes));
    write("report/index.js", "dvi.index(" + json_text(make_index(entries, unobserved), -1) + ");\n");
    remove_stale_files();
    for (const PageFile& file : get_page_files())
      if (file.name == "report.html") write("report.html", std::string(file.bytes));  // last, after the files that it loads
  }

 private:
  void write(const std::string& file, const std::string& bytes) { write_file(out_ / file, bytes); }

  FrameEntry write_frame(std::size_t i) const {
    const std::string& name = names_[i];
    const bool is_written = !in_.written.empty() && in_.written[i] != 0;
    const FramePictures pictures = read_pictures(out_, name, !is_written);
    FrameEntry frame{{{"picture", to_url(picture_file("frames", name))}, {"missing", pictures.missing}, {"truth", false}}, {}};
    if (!fs::exists(out_ / picture_file("frames", name))) frame.entry["missing"].push_back(picture_file("frames", name));
    if (pictures.kind.empty()) return frame;
    const Uncertainty uncertainty = estimate_uncertainty(pictures.kind, pictures.confidence);
    const cv::Rect& worst = uncertainty.worst;
    frame.entry["size"] = {pictures.kind.cols, pictures.kind.rows};
    frame.entry["within"] = uncertainty.within;
    frame.entry["doubtful"] = uncertainty.pixels;
    frame.entry["worst"] = {worst.x, worst.y, worst.width, worst.height};
    frame.entry["in_worst"] = uncertainty.in_worst;
    if (!is_written) {
      const cv::Mat1b error = compute_error(i, pictures);
      frame.entry["truth"] = !error.empty();
      write_block(out_, i, pictures, error);
      if (const fs::path input = find_input(name, i); !input.empty())
        write_patch(out_ / make_path("before/", i, ".png"), read_frame(input, pictures.kind.size()), pictures.kind);
    }
    frame.entry["before"] = fs::exists(out_ / make_path("before/", i, ".png"));
    if (above_.is_object()) frame.unobserved = find_unobserved_cells(pictures, i, above_);
    return frame;
  }

  /// Counts the first sources, which are the frames of the cleaned cameras.
  std::size_t count_own_sources() const {
    if (list_.empty()) return 0;
    std::vector<std::string> cameras = list_cameras(names_);
    cameras.push_back(list_[0].value("camera", ""));
    const auto is_own = [&](const json& source) {
      return source.value("drive", "") == list_[0].value("drive", "") &&
             std::find(cameras.begin(), cameras.end(), source.value("camera", "")) != cameras.end();
    };
    return static_cast<std::size_t>(std::find_if_not(list_.begin(), list_.end(), is_own) - list_.begin());
  }
  bool is_frame(const json& source, const std::string& name) const {
    const std::string camera = camera_of_frame(name);
    return source.value("frame", "") == image_of_frame(name) && (camera.empty() || source.value("camera", "") == camera);
  }

  fs::path find_input(std::size_t number) const {
    return number < list_.size() ? fs::path(list_[number].value("file", "")) : fs::path();
  }
  /// Sources have the numbers of the frames, unless frames of the result are missing.
  fs::path find_input(const std::string& name, std::size_t i) const {
    if (i < own_ && is_frame(list_[i], name)) return find_input(i);
    for (std::size_t k = 0; k < own_; ++k)
      if (is_frame(list_[k], name)) return find_input(k);
    return {};
  }

  /// Computes the error of each pixel if there is a truth, and writes the truth beside the page.
  cv::Mat1b compute_error(std::size_t i, const FramePictures& pictures) const {
    if (in_.truth.empty()) return {};
    const cv::Size size = pictures.kind.size();
    const cv::Mat3b truth = read_frame(truth_.file(names_[i]), size);
    const cv::Mat3b frame = read_frame(out_ / picture_file("frames", names_[i]), size);
    if (truth.empty() || frame.empty()) return {};
    write_patch(out_ / make_path("truth/", i, ".png"), truth, pictures.kind);
    return compute_largest_difference(truth, frame);
  }

  /// Writes the images of other cameras and drives from which pixels were copied: those whose masks are in the result.
  void write_sources() const {
    const std::vector<fs::path> masks = list_files(out_ / ".dvi/masks", {".png"});
    parallel_for(masks.size(), [&](std::size_t i) {
      const std::size_t number = std::strtoul(masks[i].stem().c_str(), nullptr, 10);
      const fs::path file = find_input(number);
      try {
        if (!file.empty())
          media::write_jpeg(out_ / make_path("sources/", number, ".jpg"), media::read_image(file, media::image_size(file)),
                            kJpegQuality);
      } catch (const InputError&) {  // answered: the page shows no crop of it
      }
    });
  }

  json make_index(const std::vector<json>& entries, const UnobservedCells& unobserved) {
    json run = json::parse(in_.run());
    const json::json_pointer odometry("/poses/odometry");
    if (run.contains("drives"))
      for (json& drive : run["drives"])  // one entry per scan, which the page does not show
        if (drive.contains(odometry) && drive[odometry].is_object()) drive[odometry].erase("scans");
    json sources = json::array(), cells = json::array();
    for (const json& source : list_)
      sources.push_back({source.value("drive", ""), source.value("camera", ""), source.value("frame", "")});
    for (const auto& [place, cell] : unobserved) cells.push_back({place.first, place.second, cell.frame, cell.pixels});
    std::size_t missing = 0;
    for (const json& entry : entries) missing += entry.at("missing").empty() ? 0 : 1;
    if (missing > 0) problems_.push_back(fmt::format("pictures of {} of {} frames are missing", missing, entries.size()));
    return {{"schema", kIndexSchema},
            {"title", fs::absolute(out_).lexically_normal().filename().string()},
            {"run", run},
            {"frames", entries},
            {"sources", sources},
            {"objects", objects_},
            {"above", above_},
            {"times", read_times()},
            {"unseen", {{"cell_m", kUnobservedCellM}, {"cells", cells}}},
            {"options", json::parse(in_.options)},
            {"evaluation", json::parse(in_.evaluation)},
            {"problems", problems_}};
  }

  /// Reads the removed objects; results of earlier versions have none.
  void read_objects() {
    if (!fs::exists(out_ / "objects.json")) return;
    const json read = read_document(out_, "objects.json", problems_);
    if (read.is_object() && read.contains("objects") && read["objects"].is_array()) objects_ = read["objects"];
  }

  /// Reads the times of the frames in seconds.
  json read_times() const {
    json seconds = json::array();
    if (!fs::exists(out_ / "map/times.txt")) return seconds;
    for (const std::string& line : read_lines(out_ / "map/times.txt")) seconds.push_back(std::strtod(line.c_str(), nullptr));
    return seconds;
  }

  /// Removes the files of earlier reports with more frames or with a truth.
  void remove_stale_files() const {
    for (const char* folder : kFolders)
      for (const fs::path& file : list_files(out_ / folder, {".js", ".png", ".jpg"})) {
        const std::string name = file.lexically_relative(out_).string();
        const std::string digits = name.substr(0, name.rfind('.')).substr(name.find_last_of("/_") + 1);
        if (digits.size() != 6 || digits.find_first_not_of("0123456789") != std::string::npos) continue;
        const std::size_t number = std::stoul(digits);
        const bool is_source = name.starts_with("report/sources/");
        const bool is_stale = name.starts_with("report/truth/") && in_.truth.empty();
        if (is_stale || number >= (is_source ? list_.size() : names_.size())) fs::remove(file);
      }
  }

  const ReportInput& in_;
  const fs::path out_;
  const FrameImages truth_;
  std::vector<std::string> problems_, names_;
  json list_ = json::array(), objects_, above_;
  std::size_t own_ = 0;  // number of sources that are frames of the target
};

}  // namespace

void write_frame(const fs::path& out, std::size_t number, const FramePictures& pictures, const cv::Mat3b& input) {
  make_folder(out / "report/before");
  write_block(out, number, pictures, {});
  write_patch(out / make_path("before/", number, ".png"), input, pictures.kind);
}

std::string before_file(std::size_t number) { return make_path("before/", number, ".png"); }

std::vector<std::string> list_frame_files(const fs::path& out, std::size_t number) {
  std::vector<std::string> files{make_path("data_", number, ".js"), before_file(number)};
  std::erase_if(files, [&](const std::string& file) { return !fs::exists(out / file); });
  return files;
}

void write_report(const ReportInput& input, const Tick& tick) { ReportWriter(input).write(tick); }

}  // namespace dvi::report
