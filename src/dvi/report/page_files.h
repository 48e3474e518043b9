#pragma once

#include <string_view>
#include <vector>

namespace dvi::report {

/// A file of the page, embedded when the program was built.
struct PageFile {
  std::string_view name, bytes;
};

/// Returns report.html and the files that it loads, including the licenses of libraries.
const std::vector<PageFile>& get_page_files();

}  // namespace dvi::report
