#pragma once

#include <string>
#include <vector>

namespace dvi {

/// The word of `words` that `typed` was probably meant to be: the one it begins, else the one at the fewest typing errors (a
/// letter too many, too few, wrong, or two swapped), at most one for every three letters. Empty if there is none.
std::string nearest_word(const std::string& typed, const std::vector<std::string>& words);

}  // namespace dvi
