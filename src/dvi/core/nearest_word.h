#pragma once

#include <string>
#include <vector>

namespace dvi {

/// Returns the word of `words` that `typed` probably means: the one that begins with it, or else the one with the fewest typing
/// errors (an additional, missing, wrong, or swapped letter), with at most one error per three letters. Returns an empty text
/// if there is none.
std::string nearest_word(const std::string& typed, const std::vector<std::string>& words);

}  // namespace dvi
