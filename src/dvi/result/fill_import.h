#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>
#include <opencv2/core/mat.hpp>

#include "dvi/core/files.h"
#include "dvi/core/folder_lock.h"
#include "dvi/core/progress.h"
#include "dvi/job/job.h"

namespace dvi::result {

/// An image of another program that the unobserved pixels of a frame were filled from.
struct ExternalFile {
  std::string file;  ///< its absolute path
  std::string hash;  ///< XXH3 of its bytes
};
void to_json(nlohmann::json& json, const ExternalFile& external);

/// Returns the external file of a frame of a result; none if its fill was not imported.
std::optional<ExternalFile> read_external_file(const fs::path& out, const std::string& name);

/// The images of a frame that an import changes.
struct FillImages {
  cv::Mat3b color;
  cv::Mat1b kind;  ///< values of harmonize::Kind
};

/// A finished result, while the fill of another program is written into it or removed from it. It keeps the images that it
/// replaces, byte for byte, in OUT/.dvi/before_import, so that each import starts from the images of the run and remove()
/// restores them. The manifest of a frame lists these files, and has the external file in its content. An interrupted import
/// leaves a folder that `dvi import-fill` and `dvi run` both complete: the manifest of the result is invalid until finish() has
/// written the videos and reports, and the manifest of a frame confirms its images only if all are written.
class FillImport {
 public:
  /// Locks the result. Changes no other file. Throws InputError if `out` is not a finished result of dvi, if a file that was
  /// not imported differs from the one that the run wrote, or if another process writes to the folder.
  explicit FillImport(const fs::path& out);

  const std::vector<std::string>& names() const { return names_; }  ///< of the frames, camera by camera, in order of time
  cv::Size size(std::size_t frame) const { return sizes_[frame]; }
  /// Returns whether the fill of a frame was imported.
  bool is_imported(std::size_t frame) const { return read_external_file(out_, names_[frame]).has_value(); }

  /// Returns the images of a frame as the run wrote them. Throws InputError if they are damaged. Thread-safe.
  FillImages read_run_images(std::size_t frame) const;

  /// Marks the result as unfinished, before the first frame is changed.
  void begin();
  /// Writes the images of a frame with the fill of an external file. Thread-safe for different frames.
  void write(std::size_t frame, const FillImages& images, const ExternalFile& external);
  /// Restores the images that the run wrote, if the frame was imported. Thread-safe for different frames.
  void remove(std::size_t frame);
  /// Writes the videos, the contact sheet, and the reports again, and marks the result as finished.
  void finish(Progress& progress);

 private:
  fs::path find_run_file(std::size_t frame, const std::string& folder) const;
  void keep_run_file(std::size_t frame, const std::string& folder);
  void write_frame_manifest(std::size_t frame, const std::optional<ExternalFile>& external);
  void require_inputs() const;
  void require_other_files() const;
  cv::Mat3b read_input(std::size_t frame) const;
  void write_videos(Progress& progress) const;
  void write_reports(Progress& progress) const;

  fs::path out_;
  FolderLock lock_;
  std::vector<std::string> names_;
  std::vector<cv::Size> sizes_;  // by frame: that of its camera
  job::Job job_;                 // the options in OUT/dvi.toml
  std::string fingerprint_;      // the run's
};

}  // namespace dvi::result
