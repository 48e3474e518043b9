#pragma once

#include <functional>
#include <string>
#include <vector>

#include "dvi/core/files.h"
#include "dvi/core/interrupt.h"

namespace dvi::report {

/// What a report is made of besides the pictures in OUT.
struct Sources {
  fs::path out;
  std::vector<std::string> names;  ///< of the frames
  std::function<std::string()> run;  ///< report.json, or what is known of it; asked for once the frames' files are written
  std::string options;     ///< JSON, those that differ from the default: name, value, default, doc
  std::string evaluation;  ///< JSON, as `dvi eval` gives it; null: there is no truth
  fs::path truth = {};     ///< NAME.png; empty: none
  std::vector<std::string> problems = {};  ///< why the result is not whole, for a person
};

/// OUT/report.html and what it loads, OUT/report/: the page, index.js with all figures, one data_NNNNNN.js a frame
/// (frame_block.h), before/ and truth/ (the hole's pixels as they were and as they should be), sources/ (images of other
/// cameras and drives that were copied from). Images are read where OUT/sources.json says; where they are gone, pictures of an
/// earlier report stay. Reads everything else from OUT, whatever is missing there. One tick a frame. InputError where OUT
/// cannot be written.
void write_report(const Sources& sources, const Tick& tick = [] {});

/// The files of a report, relative to OUT.
std::vector<std::string> report_files(const fs::path& out);

}  // namespace dvi::report
