#pragma once

#include <cstddef>
#include <functional>
#include <string>
#include <vector>

#include <opencv2/core/mat.hpp>

#include "dvi/core/files.h"
#include "dvi/core/interrupt.h"
#include "dvi/report/frame_pictures.h"

namespace dvi::report {

/// The input of a report besides the images in OUT.
struct ReportInput {
  fs::path out;
  std::vector<std::string> names;    ///< names of the frames
  std::function<std::string()> run;  ///< report.json, or its known part; called after the frames' files are written
  std::string options;               ///< JSON of the options that differ from the default: name, value, default, doc
  std::string evaluation;            ///< JSON as written by `dvi eval`; null if there is no truth
  fs::path truth = {};               ///< folder of NAME.png; may be empty
  /// Per frame: whether its files were written by write_frame() and are kept; empty if none were.
  std::vector<char> written = {};
  std::vector<std::string> problems = {};  ///< reasons why the result is incomplete
};

/// Writes the data of frame `number` of the result: its provenance (frame_block.h) and the pixels of the hole in `input`. Saves
/// reading the images again: write_report() makes the files that are missing. Thread-safe.
void write_frame(const fs::path& out, std::size_t number, const FramePictures& pictures, const cv::Mat3b& input);

/// Returns the file of the hole's pixels in the input of frame `number`, relative to the result; other pixels are transparent.
std::string before_file(std::size_t number);

/// Lists the existing files of write_frame(), relative to the result.
std::vector<std::string> list_frame_files(const fs::path& out, std::size_t number);

/// Writes OUT/report.html and its files in OUT/report/: the page, index.js with all figures, one data_NNNNNN.js per frame
/// (frame_block.h), before/ and truth/ (the original and the true pixels of the holes), and sources/ (images of other cameras
/// and drives from which pixels were copied). Images are read from the paths in OUT/sources.json; if they are missing, images
/// of an earlier report are kept. Everything else is read from OUT; missing files are reported on the page. Calls `tick` once
/// per frame. Throws InputError if OUT cannot be written.
void write_report(const ReportInput& input, const Tick& tick = [] {});

}  // namespace dvi::report
