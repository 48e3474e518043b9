#pragma once

#include <string_view>
#include <vector>

namespace dvi::report {

/// A file of the page, as it was when the program was built.
struct PageFile {
  std::string_view name, bytes;
};

/// report.html and what it loads, with the licenses of the libraries among it.
const std::vector<PageFile>& page_files();

}  // namespace dvi::report
