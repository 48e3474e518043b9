#pragma once

#include <string>
#include <vector>

#include "dvi/core/files.h"
#include "dvi/harmonize/filled_frame.h"

namespace dvi::pipeline {

/// The output folder of a run: which frames in it are finished, and how a frame is written.
///
/// OUT/.dvi/job.json says what the folder was made from; OUT/.dvi/frames/NAME.json is written after a frame's images and so
/// marks it as finished. A folder of other drives, or of anything else, is refused unless forced; frames made from other
/// options or from files that have changed are made again.
class ResultFolder {
 public:
  /// `identity`: which drives and camera; `fingerprint`: all that the frames depend on. InputError where the folder is
  /// refused or cannot be written.
  ResultFolder(const fs::path& out, const std::string& identity, const std::string& fingerprint, bool force);
  ~ResultFolder();  ///< removes the folder again if it was made here and nothing was written
  ResultFolder(const ResultFolder&) = delete;
  ResultFolder& operator=(const ResultFolder&) = delete;

  const fs::path& path() const { return out_; }
  bool is_finished(const std::string& name) const { return fs::exists(record(name)); }
  /// The JSON that write_frame was given for a finished frame.
  std::string frame_record(const std::string& name) const { return read_file(record(name)); }

  /// Everything of the frame, what harmonisation() says of it, then its record. Safe to call from several threads.
  void write_frame(const std::string& name, const harmonize::FilledFrame& frame, const cv::Mat_<cv::Vec3w>& harmonisation,
                   const std::string& record_json);

  /// Removes what a run with other frames left behind; `names` are those of this run.
  void remove_others(const std::vector<std::string>& names);

  /// The pictures of a frame: `frames/NAME.png` and so on.
  static const std::vector<std::string>& picture_folders();

 private:
  fs::path record(const std::string& name) const { return out_ / ".dvi/frames" / (name + ".json"); }
  void claim(const std::string& identity, const std::string& fingerprint, bool force);

  fs::path out_;
  bool created_ = false;
};

/// 8-bit image of a filled frame, rounded.
cv::Mat3b to_8bit(const harmonize::FilledFrame& frame);

}  // namespace dvi::pipeline
