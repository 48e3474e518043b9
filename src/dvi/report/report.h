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

/// What a report is made of besides the pictures in OUT.
struct Sources {
  fs::path out;
  std::vector<std::string> names;    ///< of the frames
  std::function<std::string()> run;  ///< report.json, or what is known of it; asked for once the frames' files are written
  std::string options;               ///< JSON, those that differ from the default: name, value, default, doc
  std::string evaluation;            ///< JSON, as `dvi eval` gives it; null: there is no truth
  fs::path truth = {};               ///< NAME.png; empty: none
  /// Of each frame whether its files are as write_frame() wrote them, and are kept; empty: of none.
  std::vector<char> written = {};
  std::vector<std::string> problems = {};  ///< why the result is not whole, for a person
};

/// What the report shows of frame `number` of the result: its receipts (frame_block.h) and the hole's pixels as they were in
/// `input`. For who has them at hand; write_report() makes from the pictures what is missing. Safe to call from several
/// threads.
void write_frame(const fs::path& out, std::size_t number, const FramePictures& pictures, const cv::Mat3b& input);

/// The files that write_frame() writes, as far as they are there, relative to the result.
std::vector<std::string> frame_files(const fs::path& out, std::size_t number);

/// OUT/report.html and what it loads, OUT/report/: the page, index.js with all figures, one data_NNNNNN.js a frame
/// (frame_block.h), before/ and truth/ (the hole's pixels as they were and as they should be), sources/ (images of other
/// cameras and drives that were copied from). Images are read where OUT/sources.json says; where they are gone, pictures of an
/// earlier report stay. Reads everything else from OUT, whatever is missing there. One tick a frame. InputError where OUT
/// cannot be written.
void write_report(const Sources& sources, const Tick& tick = [] {});

}  // namespace dvi::report
