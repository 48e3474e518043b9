#pragma once

#include <string>
#include <vector>

namespace dvi {

/// Data that some frames of a drive lack.
struct Gap {
  std::string what;         ///< The words before the frame numbers, such as "no scan for frames".
  std::vector<int> frames;  ///< The numbers of the frames, ascending.
};

}  // namespace dvi
