#include "dvi/result/fill_import.h"

#include <algorithm>
#include <array>

#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <opencv2/core.hpp>

#include "dvi/core/error.h"
#include "dvi/core/frame_name.h"
#include "dvi/core/hash.h"
#include "dvi/core/json_optional.h"
#include "dvi/core/json_text.h"
#include "dvi/core/threads.h"
#include "dvi/media/image_file.h"
#include "dvi/media/write_image.h"
#include "dvi/metrics/evaluation.h"
#include "dvi/metrics/without_truth.h"
#include "dvi/report/report.h"
#include "dvi/result/manifest.h"
#include "dvi/result/result_folder.h"
#include "dvi/result/result_layout.h"
#include "dvi/result/result_media.h"
#include "dvi/result/run_report.h"
#include "dvi/result/write_report.h"

namespace dvi::result {
namespace {

using nlohmann::json;

constexpr const char* kRunAgain = "run the same dvi run again, which makes damaged parts again";
constexpr std::array<const char*, 2> kChangedPictures{"frames", "kind"};

/// Returns whether a file is a video or contact sheet of a camera, which an import writes again.
bool is_media(const std::string& file) {
  const std::string name = fs::path(file).filename().string();
  return name == "video.mp4" || name == "compare.mp4" || name == "contact.png";
}

Manifest read_frame(const fs::path& out, const std::string& name) {
  const std::optional<Manifest> manifest = read_manifest(frame_manifest(out, name));
  if (!manifest || !manifest->content) throw InputError(out, "lacks frame " + name, kRunAgain);
  return *manifest;
}

bool has_hash(const fs::path& file, const std::string& hash) { return fs::exists(file) && compute_file_hash(file) == hash; }

bool is_before_import(const ListedFile& listed) { return listed.file.starts_with(file_before_import("")); }

/// Returns the hash of an image when the run wrote it.
std::optional<std::string> find_run_hash(const Manifest& manifest, const std::string& picture) {
  std::optional<std::string> hash;
  for (const ListedFile& listed : manifest.files) {
    if (listed.file == file_before_import(picture)) return listed.hash;
    if (listed.file == picture) hash = listed.hash;
  }
  return hash;
}

/// Locks a folder that has the parts of a result, so that others are left untouched.
fs::path require_result(const fs::path& out) {
  if (!fs::is_directory(out)) throw InputError(out, "is not a folder", "give the OUT of a dvi run");
  if (!fs::is_directory(out / ".dvi") || !fs::exists(out / "report.json"))
    throw InputError(out, "is not a finished result of dvi run", "run the same dvi run again, which completes the result");
  return out;
}

}  // namespace

void to_json(json& j, const ExternalFile& external) { j = {{"file", external.file}, {"xxh3", external.hash}}; }

std::optional<ExternalFile> read_external_file(const fs::path& out, const std::string& name) {
  const std::optional<Manifest> manifest = read_manifest(frame_manifest(out, name));
  if (!manifest || !manifest->content || !manifest->content->contains("external")) return std::nullopt;
  const json& external = manifest->content->at("external");
  return ExternalFile{external.at("file"), external.at("xxh3")};
}

FillImport::FillImport(const fs::path& out) : out_(require_result(out)), lock_(out, out / ".dvi/lock") {
  const std::optional<RunReport> report = read_run_report(out / "report.json");
  if (!report) throw InputError(out / "report.json", "is damaged", kRunAgain);
  job_.table().load_toml(out / "dvi.toml");
  job_.out = out.string();
  names_ = report->frame_names();
  if (names_.empty()) throw InputError(out, "has no frames");
  fingerprint_ = read_frame(out, names_.front()).fingerprint;
  for (const std::string& name : names_)
    if (read_frame(out, name).fingerprint != fingerprint_)
      throw InputError(out, "has frames of different runs, such as " + names_.front() + " and " + name, kRunAgain);
  for (const std::string& name : names_) sizes_.push_back(media::image_size(out / picture_file("masks", name)));
  require_other_files();
  require_inputs();
}

void FillImport::require_other_files() const {
  const std::optional<Manifest> manifest = read_manifest(result_manifest(out_));
  if (!manifest) throw InputError(out_, "is not a finished result of dvi run", kRunAgain);
  for (const ListedFile& listed : manifest->files)
    if (!is_media(listed.file) && !has_hash(out_ / listed.file, listed.hash))
      throw InputError(out_ / listed.file, "differs from the file that the run wrote", kRunAgain);
}

void FillImport::require_inputs() const {
  for (std::size_t i = 0; i < names_.size(); ++i)
    if (const fs::path file = out_ / report::before_file(i); !fs::exists(file))
      throw InputError(file, "is missing: it has the input of the holes", "dvi report OUT writes it again");
}

fs::path FillImport::find_run_file(std::size_t frame, const std::string& folder) const {
  const std::string file = picture_file(folder, names_[frame]);
  const std::optional<std::string> hash = find_run_hash(read_frame(out_, names_[frame]), file);
  // An interrupted import has replaced the image, but not its hash in the manifest.
  for (const fs::path& path : {out_ / file_before_import(file), out_ / file})
    if (hash && has_hash(path, *hash)) return path;
  throw InputError(out_ / file, "differs from the image that the run wrote", kRunAgain);
}

FillImages FillImport::read_run_images(std::size_t frame) const {
  return {media::read_image(find_run_file(frame, "frames"), sizes_[frame]),
          media::read_png_gray(find_run_file(frame, "kind"), sizes_[frame])};
}

void FillImport::begin() {
  const std::vector<std::string> cameras = list_cameras(names_);
  for (const std::string& camera : cameras)
    for (const char* folder : kChangedPictures) make_folder(out_ / file_before_import(join_frame_name(camera, folder)));
  for (const fs::path& folder : list_own_folders(out_, cameras))
    if (fs::exists(folder)) remove_temporaries(folder);  // an interrupted import leaves some
  Manifest manifest = *read_manifest(result_manifest(out_));
  manifest.fingerprint.clear();
  write_manifest(result_manifest(out_), manifest);
}

void FillImport::keep_run_file(std::size_t frame, const std::string& folder) {
  const fs::path kept = out_ / file_before_import(picture_file(folder, names_[frame]));
  if (const fs::path file = find_run_file(frame, folder); file != kept) write_file(kept, read_file(file));
}

void FillImport::write_frame_manifest(std::size_t frame, const std::optional<ExternalFile>& external) {
  const std::string& name = names_[frame];
  Manifest manifest = read_frame(out_, name);
  std::erase_if(manifest.files, is_before_import);
  std::vector<std::string> changed;
  for (const char* folder : kChangedPictures) {
    changed.push_back(picture_file(folder, name));
    if (external) changed.push_back(file_before_import(picture_file(folder, name)));
  }
  for (const ListedFile& listed : list_contents(out_, changed)) {
    const auto old =
        std::find_if(manifest.files.begin(), manifest.files.end(), [&](const ListedFile& l) { return l.file == listed.file; });
    old != manifest.files.end() ? * old = listed : manifest.files.emplace_back(listed);
  }
  json content = *manifest.content;
  content["hole"] = count_hole(media::read_png_gray(out_ / picture_file("kind", name), sizes_[frame]));
  content.erase("external");
  if (external) content["external"] = *external;
  manifest.content = std::make_shared<const json>(std::move(content));
  write_manifest(frame_manifest(out_, name), manifest);
}

void FillImport::write(std::size_t frame, const FillImages& images, const ExternalFile& external) {
  const std::string& name = names_[frame];
  for (const char* folder : kChangedPictures) keep_run_file(frame, folder);
  remove_report_frame_manifest(out_, name);
  media::write_png(out_ / picture_file("kind", name), images.kind);
  media::write_png(out_ / picture_file("frames", name), images.color);
  write_frame_manifest(frame, external);
}

void FillImport::remove(std::size_t frame) {
  const std::string& name = names_[frame];
  // An interrupted import may have replaced an image of a frame that is not marked as imported.
  for (const char* folder : kChangedPictures) {
    const fs::path file = find_run_file(frame, folder), current = out_ / picture_file(folder, name);
    if (file == current) continue;
    remove_report_frame_manifest(out_, name);
    write_file(current, read_file(file));
  }
  if (is_imported(frame)) write_frame_manifest(frame, std::nullopt);
  for (const char* folder : kChangedPictures) fs::remove(out_ / file_before_import(picture_file(folder, name)));
}

cv::Mat3b FillImport::read_input(std::size_t frame) const {
  const fs::path file = out_ / report::before_file(frame);
  const cv::Mat hole = media::read_unchanged(file, sizes_[frame]);
  if (hole.type() != CV_8UC4) throw InputError(file, "is not as written by dvi", "dvi report OUT writes it again");
  cv::Mat3b input = media::read_image(out_ / picture_file("frames", names_[frame]), sizes_[frame]);
  for (int y = 0; y < input.rows; ++y)
    for (int x = 0; x < input.cols; ++x)
      if (const auto& pixel = hole.at<cv::Vec4b>(y, x); pixel[3] != 0) input(y, x) = {pixel[0], pixel[1], pixel[2]};
  return input;
}

void FillImport::write_reports(Progress& progress) const {
  const metrics::FiguresWithoutTruth figures = metrics::measure_without_truth(out_, names_, progress.parts());
  progress.begin("report", names_.size());
  json document = read_run_report(out_ / "report.json")->document();
  HoleReport hole;
  document["frames"] = json::array();
  for (const std::string& name : names_) {
    document["frames"].push_back(*read_frame(out_, name).content);
    hole += document["frames"].back().at("hole").get<HoleReport>();
  }
  document["hole"] = hole;
  document["artifacts"] = figures.artifacts;
  document["look"] = figures.look;
  const std::string text = json_text(document);
  write_report(
      job_, {names_, fingerprint_},
      [&] {
        write_file(out_ / "report.json", text + "\n");
        return text;
      },
      progress.tick());
  for (std::size_t i = 0; i < names_.size(); ++i) write_report_frame_manifest(out_, names_[i], i, fingerprint_);
}

void FillImport::write_videos(Progress& progress) const {
  progress.begin("video", names_.size());
  std::size_t first = 0;
  for (const std::string& camera : list_cameras(names_)) {
    FinishedFrames frames{.out = out_,
                          .names = {},
                          .size = sizes_[first],
                          .read_input = [this, first](std::size_t i) { return read_input(first + i); },
                          .options = job_.options.video};
    for (std::size_t i = first; i < names_.size() && camera_of_frame(names_[i]) == camera; ++i)
      frames.names.push_back(names_[i]);
    write_media(frames, progress.tick());
    first += frames.names.size();
  }
  progress.end();
}

void FillImport::finish(Progress& progress) {
  write_videos(progress);
  write_reports(progress);
  std::error_code in_use;  // folders of other imported frames remain
  for (const std::string& camera : list_cameras(names_)) {
    for (const char* folder : kChangedPictures) fs::remove(out_ / file_before_import(join_frame_name(camera, folder)), in_use);
    if (!camera.empty()) fs::remove(out_ / file_before_import(camera), in_use);
  }
  fs::remove(out_ / file_before_import(""), in_use);
  Manifest manifest = *read_manifest(result_manifest(out_));
  for (ListedFile& listed : manifest.files)
    if (is_media(listed.file)) listed = list_contents(out_, {listed.file}).front();
  manifest.fingerprint = fingerprint_;
  write_manifest(result_manifest(out_), manifest);
}

}  // namespace dvi::result
